"""`torsionbook accuracy`: what accuracy costs in time."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import list_problems, progress, study_targets
from addin.contract.problems import printable
from addin.studies.accuracy import ACCURACY, QUICK_ROUNDS, ROUNDS
from addin.studies.study import study_one
from addin.workers.parallel_map import alone
from engine.studies.accuracy.accuracy import AccuracyStudy

#: The table on the terminal is at least so wide. [characters]
TABLE_WIDTH = 110


def accuracy(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the result; default beside the input.")
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Write into the workbook itself; keeps a .bak copy.")
    ] = False,
    json: Annotated[
        Path | None, typer.Option(help="Also write the study as JSON: a file or a folder.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Time each setting once instead of five times.")
    ] = False,
    ignore_lock: Annotated[
        bool, typer.Option("--ignore-lock", help="Go on although a lock file is there.")
    ] = False,
) -> None:
    """Show what accuracy costs in time: error against wall time of this very case.

    Calculates the start by both methods at several tolerances, compares with a reference a hundred
    times finer, and writes sheet Accuracy; no other result is touched.

    Example: `torsionbook accuracy train.xlsx` writes train.accuracy.xlsx.
    """
    destination, json = study_targets(file, "accuracy", out, json, in_place)
    with progress() as tell:
        done = study_one(
            ACCURACY,
            file,
            alone(),
            {"rounds": QUICK_ROUNDS if quick else ROUNDS},
            destination=destination,
            in_place=in_place,
            json_file=json,
            ignore_lock=ignore_lock,
            on_stage=lambda stage: tell(f"{file.name}: {stage}"),
        )
    for sentence in done.warnings:
        typer.echo(f"{file}: note: {printable(sentence)}", err=True)
    if done.found is None:
        list_problems(file, done.problems, bool(done.written))
        raise typer.Exit(WRONG_INPUT)
    _show_study(done.found.result)
    for path in done.written:
        typer.echo(f"written: {path}")


def _show_study(found: AccuracyStudy) -> None:
    """Table and sentences of an accuracy study."""
    from rich.console import Console
    from rich.table import Table

    table = Table(show_edge=False, pad_edge=False)
    for header in ("Method", "Setting"):
        table.add_column(header, no_wrap=True)
    for header in ("Error peak (%)", "Error starts (%)", "Time (ms)"):
        table.add_column(header, justify="right")
    for row in found.rows:
        errors = [
            "–" if e is None else _decimal(100.0 * e) for e in (row.error_peak, row.error_starts)
        ]
        took = "–" if row.time is None else f"{1e3 * row.time:.3g}"
        table.add_row(row.method, str(row.setting), *errors, took)
    Console(width=max(Console().width, TABLE_WIDTH)).print(table)
    typer.echo(found.sentence)
    typer.echo(f"Reference: {found.reference}")


def _decimal(value: float) -> str:
    """Two digits without powers of ten; what is smaller than a chart can show is a bound."""
    if 0.0 < value < 1e-7:
        return "< 0.0000001"
    digits = 1 if value == 0.0 else max(0, 1 - math.floor(math.log10(value)))
    return f"{value:.{digits}f}"
