"""``torsionbook tune``: which couplings place the modes best, and why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from addin.cli.options import (
    FileArgument,
    IgnoreLockOption,
    InPlaceOption,
    JobsOption,
    JsonOption,
    OutOption,
    SchedulerOption,
)
from addin.cli.study import run_study
from addin.cli.terminal import refuse_no_folder
from addin.contract.problems import printable
from addin.reading.case_json import case_to_json
from addin.studies.study import Found
from addin.studies.tuning import TUNING
from addin.xlsx.whole_files import write_json
from engine.studies.tuning.tuning import best_cases


def tune(
    file: FileArgument,
    out: OutOption = None,
    in_place: InPlaceOption = False,
    json: JsonOption = None,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    top: Annotated[
        int,
        typer.Option("--top", min=1, help="How many of the best are listed and saved as cases."),
    ] = 5,
    cases: Annotated[
        Path | None,
        typer.Option(
            "--cases",
            metavar="FOLDER",
            help="Save the best combinations as case JSON files, ready for recalc and new --from.",
        ),
    ] = None,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Try couplings and other quantities in every combination, and rank them with the reasons.

    What is tried stands on sheet Tuning of a workbook made with `torsionbook new --studies`, or in the
    tables tuning and catalogue of a case JSON. Each combination is a full start; results go to a new
    workbook, train.tune.xlsx.
    """
    refuse_no_folder(cases)

    def save(found: Found) -> None:
        if cases is not None:
            _save(found.result, top, cases, file.stem)

    run_study(
        TUNING,
        file,
        {},
        out=out,
        in_place=in_place,
        json=json,
        jobs=jobs,
        scheduler=scheduler,
        ignore_lock=ignore_lock,
        show=lambda one: _show(one, top),
        then=save,
    )


def _show(found: Found, top: int) -> None:
    """The best combinations and the case as it stands, each with its reason."""
    for row in found.tables["TuningResults"]:
        if "rank" not in row or (row["rank"] > top and not row["as_is"]):
            continue
        typer.echo(printable(f"{row['rank']:>3}  {row['combination']}"))
        typer.echo(printable(f"     {row['reason']}"))
    typer.echo("")


def _save(result: tuple[Any, Any], top: int, folder: Path, stem: str) -> None:
    """The best combinations as case JSON files."""
    case, study = result
    folder.mkdir(parents=True, exist_ok=True)
    for ranked, data in best_cases(case, study, top):
        title = ": ".join(part for part in (data.title, ranked.combination) if part)
        path = folder / f"{stem}.rank-{ranked.rank}.json"
        write_json(path, case_to_json(replace(data, title=title)))
        typer.echo(f"written: {path}")
