"""The commands ``torsionbook tolerances`` and ``torsionbook sensitivities``."""

from __future__ import annotations

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
from addin.studies.sensitivities import SENSITIVITIES
from addin.studies.tolerances import TOLERANCES

_METHODS = ("lhs", "sobol")


def tolerances(
    file: FileArgument,
    samples: Annotated[
        int, typer.Option("--samples", min=30, max=1_000_000, help="How many trains are drawn.")
    ] = 1000,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="The same seed draws the same trains.")
    ] = 1,
    method: Annotated[
        str, typer.Option("--method", help="lhs (Latin hypercube) or sobol (a power of two).")
    ] = "lhs",
    replan: Annotated[
        bool,
        typer.Option(
            "--replan", help="Plan anew where a torque reverses that does not in the plain run."
        ),
    ] = False,
    out: OutOption = None,
    in_place: InPlaceOption = False,
    json: JsonOption = None,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Show what the scatter of the inputs makes of frequencies, margins, peaks and starts.

    Draws trains by table Scatter and calculates each: percentiles with their intervals, the
    probability that each margin is kept and that the starts suffice, and what drives the starts.

    Example: `torsionbook tolerances train.xlsx --samples 10000`
    """
    if method not in _METHODS:
        raise typer.BadParameter(f"--method is '{method}'; allowed is lhs or sobol.")
    run_study(
        TOLERANCES,
        file,
        {"samples": samples, "seed": seed, "method": method, "replan": replan},
        out=out,
        in_place=in_place,
        json=json,
        jobs=jobs,
        scheduler=scheduler,
        ignore_lock=ignore_lock,
    )


def sensitivities(
    file: FileArgument,
    out: OutOption = None,
    in_place: InPlaceOption = False,
    json: JsonOption = None,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Show what a small change of each quantity does to frequencies, peak stress and starts.

    Derivatives of the frequencies from the energies of the modes; of the start by differences of
    whole starts, checked by the tangent of the start where it is linear.

    Example: `torsionbook sensitivities train.xlsx`
    """
    run_study(
        SENSITIVITIES,
        file,
        {},
        out=out,
        in_place=in_place,
        json=json,
        jobs=jobs,
        scheduler=scheduler,
        ignore_lock=ignore_lock,
    )
