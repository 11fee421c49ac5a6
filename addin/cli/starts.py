"""`torsionbook starts`: the start matrix and the damage ledger."""

from __future__ import annotations

import math
from typing import Annotated

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
from addin.studies.starts import STARTS
from addin.studies.study import Found

#: The table on the terminal is at least so wide. [characters]
_WIDTH = 110


def starts(
    file: FileArgument,
    out: OutOption = None,
    in_place: InPlaceOption = False,
    json: JsonOption = None,
    standard: Annotated[
        bool,
        typer.Option(
            "--standard",
            help="The standard matrix beside the rows of StartConditions; without rows it is "
            "calculated anyway.",
        ),
    ] = False,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Start matrix and damage ledger: starts at every voltage, and what a duty of them leaves.

    Kinds of starts and how often they happen stand in table StartConditions of sheet Duty; without
    rows: 80 to 110 % voltage, loaded and unloaded, and aborted starts. Writes sheets Start matrix and
    Damage ledger.

    Example: `torsionbook starts train.xlsx` writes train.starts.xlsx.
    """
    run_study(
        STARTS,
        file,
        {"standard": standard},
        out=out,
        in_place=in_place,
        json=json,
        jobs=jobs,
        scheduler=scheduler,
        ignore_lock=ignore_lock,
        show=_show,
    )


def _show(found: Found) -> None:
    from rich.console import Console
    from rich.table import Table

    matrix, _ = found.result
    table = Table(show_edge=False, pad_edge=False)
    table.add_column("Condition", no_wrap=True)
    table.add_column("Outcome", no_wrap=True)
    for header in ("Time (s)", "Peak (× rated)", "Allowable starts", "Governing"):
        table.add_column(header, justify="right")
    for row in matrix.rows:
        starts = "not judged" if not row.judged else "unlimited"
        if row.allowable_starts is not None:
            starts = f"{math.floor(row.allowable_starts * (1.0 + 1e-9)):,}"
        table.add_row(
            row.condition.name,
            row.words,
            "–" if row.time is None else f"{row.time:.2f}",
            "–" if row.peak_over_rated is None else f"{row.peak_over_rated:.2f}",
            starts,
            row.governing or "–",
        )
    Console(width=max(Console().width, _WIDTH)).print(table)
