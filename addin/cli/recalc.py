"""`torsionbook recalc`: inputs calculated, results written, and a summary of them."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from addin.calculation.calculation import Calculation
from addin.calculation.key_figures import key_figures
from addin.cli.options import (
    Files,
    IgnoreLockOption,
    InPlaceOption,
    MethodOption,
    StrictOption,
    ToleranceOption,
)
from addin.cli.overrides import case_overrides
from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import (
    TABLE_WIDTH,
    list_problems,
    print_table,
    print_written,
    progress,
    refuse_clashes,
    refuse_no_json,
    result_place,
    stages_of,
)
from addin.contract.problems import printable
from addin.writing.history_file import history_stems
from addin.writing.recalculate import PreparedInput, RecalculationOutcome, beside, recalculate
from engine.case.result_words import ACCEPTABLE, NoNumber
from engine.fatigue.damage import starts_in_words


def recalc(
    files: Files,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the results, or the file for that of one input; default beside each input."
        ),
    ] = None,
    in_place: InPlaceOption = False,
    json: Annotated[
        Path | None,
        typer.Option(help="Also write results as JSON: a file, or a folder for several inputs."),
    ] = None,
    method: MethodOption = None,
    tolerance: ToleranceOption = None,
    strict: StrictOption = False,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Calculate workbooks or case JSON files and write their results.

    Examples: `torsionbook recalc train.xlsx` writes train.out.xlsx;
    `torsionbook recalc *.xlsx --out results --json results` calculates a folder.
    """
    if out is not None and in_place:
        raise typer.BadParameter("Use either --out or --in-place, not both.")
    overrides = case_overrides(method, tolerance)
    targets = [_targets(file, out, json, len(files) > 1) for file in files]
    refuse_clashes(files, targets, in_place)
    for target, json_file in targets:
        for place in (target, json_file):
            if place is not None and (place is json_file or place.suffix.lower() == ".json"):
                refuse_no_json(place)
    histories = _histories(files, targets, in_place)
    with progress() as tell:
        done = [
            recalculate(
                file,
                destination=target,
                in_place=in_place,
                json_file=json_file,
                overrides=overrides,
                ignore_lock=ignore_lock,
                on_stage=stages_of(file, tell),
                prepared=PreparedInput(history=history, keeps_standing=True),
            )
            for file, (target, json_file), history in zip(files, targets, histories, strict=True)
        ]
    for outcome in done:
        list_problems(outcome.source, outcome.problems, bool(outcome.written))
    _summary(done)
    if any(outcome.problems for outcome in done):
        raise typer.Exit(WRONG_INPUT)
    results = [outcome.calculation.results for outcome in done if outcome.calculation is not None]
    if strict and any(result.verdicts[0].verdict not in ACCEPTABLE for result in results):
        raise typer.Exit(WRONG_INPUT)


def _targets(
    file: Path, out: Path | None, json: Path | None, several: bool
) -> tuple[Path | None, Path | None]:
    """Result workbook and JSON of one input; None = the default."""
    ending = ".results.json" if file.suffix.lower() == ".json" else file.suffix
    destination = None
    if out is not None:
        destination = result_place(out, f"{file.stem}{ending}", several)
    if destination is None and ending == ".results.json" and json is None:
        destination = beside(file)
    folder = json is not None and (several or json.is_dir() or json == out)
    json_file = json / f"{file.stem}.results.json" if json is not None and folder else json
    return destination, json_file


def _histories(
    files: Sequence[Path], targets: Sequence[tuple[Path | None, Path | None]], in_place: bool
) -> list[str]:
    """Names of histories before ``.history``; empty for the usual one, which no other result has."""
    results = [
        str(file if in_place else target or beside(file))
        for file, (target, _) in zip(files, targets, strict=True)
    ]
    stems = history_stems(results)
    return [Path(result).name if stems[result] == result else "" for result in results]


def _summary(done: Sequence[RecalculationOutcome]) -> None:
    """The end of a run: first modes, worst margin, peak, start, starts, verdict and notes of each file."""
    headers = ("First modes [Hz]", "Worst margin", "Largest peak", "Start", "Starts", "Verdict")
    calculated = {
        outcome.source: [printable(cell) for cell in _summary_cells(outcome.calculation)]
        for outcome in done
        if outcome.calculation is not None
    }
    as_table = shutil.get_terminal_size().columns >= TABLE_WIDTH
    if calculated and as_table:
        columns = [(header, "text") for header in ("File", *headers)]
        print_table(columns, [[file.name, *cells] for file, cells in calculated.items()])
    for outcome in done:
        if outcome.source in calculated and not as_table:
            typer.echo(outcome.source.name)
            for header, cell in zip(headers, calculated[outcome.source], strict=True):
                typer.echo(f"  {header:<17} {cell}")
        if outcome.calculation is not None:
            overall = outcome.calculation.results.verdicts[0]
            if overall.verdict not in ACCEPTABLE and overall.where:
                place = f"{outcome.source}: {overall.verdict}:" if as_table else f"  {'Why':<17}"
                typer.echo(f"{place} {printable(overall.where)}")
        for sentence in outcome.warnings:
            typer.echo(f"{outcome.source}: note: {printable(sentence)}", err=True)
    print_written(path for outcome in done if outcome.calculation for path in outcome.written)


def _summary_cells(calculation: Calculation) -> list[str]:
    figures = key_figures(calculation.results, calculation.tables.get("StartupPeaks", ()))
    modes = ", ".join(f"{f:.4g}" for f in figures.frequencies)
    margin, peak, starts = "–", "–", "–"
    if figures.margin is not None:
        margin = f"{100 * figures.margin:.1f} % (mode {figures.margin_mode})"
    if figures.peak_over_rated is not None:
        peak = f"{figures.peak_over_rated:.2f} × rated, {figures.peak_where}"
    elif figures.peak_torque is not None:
        peak = f"{figures.peak_torque:.4g} N m {figures.peak_where}"
    if figures.starts_not_judged:
        starts = NoNumber.NOT_JUDGED
    elif figures.starts_unlimited:
        starts = NoNumber.UNLIMITED
    elif figures.starts is not None:
        starts = starts_in_words(figures.starts)
    outcome = "–" if calculation.results.start is None else figures.outcome
    return [modes, margin, peak, outcome, starts, figures.verdict]
