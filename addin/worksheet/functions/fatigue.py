"""Fatigue: damaging cycles, allowable starts, life of an S-N line, and what a duty uses up."""

from __future__ import annotations

import math
from typing import Any

from addin.charts.start_cycles import start_cycle_rows
from addin.worksheet.answers import (
    MODEL,
    NO_SHAFT,
    UNITS,
    Rows,
    name_in_case,
    no_rows,
    run_of,
    shows_table,
    si_unit,
    system_for,
)
from addin.worksheet.models import MODELS
from addin.worksheet.registry import Argument, FunctionError, registered
from engine.case.result_words import NoNumber
from engine.errors import ModelError
from engine.fatigue.sn_curve import sn_curve_for
from engine.studies.starts.damage_ledger import remaining_life

#: Place of these functions among all, in lists and in the documentation.
ORDER = 60


#: A stress this little above another is that stress, typed in another unit.
_SAME_STRESS = 1.0 + 1e-9


@shows_table("TV_CYCLES", "StartCycles", run_of)
def tv_cycles(run: Any) -> Any:
    """The most damaging cycles of one start of the governing shaft: n, N and n/N."""
    rows = start_cycle_rows(run.view)
    if not rows:
        judged = run.tables.get("AllowableStarts")
        raise no_rows(run, "The start has no stress cycle." if judged else NO_SHAFT)
    return rows


@shows_table("TV_STARTS", "AllowableStarts", run_of, NO_SHAFT)
def tv_starts(run: Any) -> Any:
    """Damage of one start and allowable starts of every judged shaft."""
    return run.tables.get("AllowableStarts")


@shows_table("TV_FATIGUE_LIMITS", "FatigueLimits", run_of, NO_SHAFT)
def tv_fatigue_limits(run: Any) -> Any:
    """Notch and strength factors, endurance limit and safety factor of every judged shaft."""
    return run.tables.get("FatigueLimits")


@registered(
    "TV_SN_LIFE",
    MODEL,
    Argument("Material", "text", "The name in table Materials."),
    Argument("Stress", "numbers", "The zero-to-peak stress, nominal times SCF [MPa or psi]."),
    UNITS,
    Argument(
        "Remarks",
        "flag",
        "TRUE adds beside each life a remark where the S-N line is extrapolated.",
        True,
    ),
    example='=TV_SN_LIFE(A1, "Alloy steel", 200, "SI")',
)
def tv_sn_life(
    handle: str, material: str, stress: Rows, units: str | None, remarks: bool | None
) -> Rows:
    """Cycles to failure at a stress, on the S-N line of the material in torsion; below endurance 'unlimited'.

    Strength factors of table `FatigueFactors` do not lower this line, and `MeanStress` is left out. Above the first S-N point the line is extrapolated, as for allowable starts: the life is a number,
    but not test data, and such starts are not judged. With Remarks `TRUE` a remark beside each life
    says so. A stress above UTS is refused.
    """
    model = MODELS.of(handle)
    case = model.case
    name = name_in_case("Material", material, [str(m.material) for m in case.materials])
    row = next(m for m in case.materials if str(m.material) == name)
    try:
        curve = sn_curve_for(row, case.sn_points)
    except ModelError as wrong:
        raise FunctionError(str(wrong), "#NUM!") from None
    unit, pascal = si_unit("pressure", system_for(units, model))
    answer: Rows = []
    for i, line in enumerate(stress):
        lives: list[Any] = []
        for j, value in enumerate(line):
            if value is not None:
                _check_stress(value * pascal, value, unit, pascal, row, (i, j))
            life = None if value is None else float(curve.cycles_to_failure(value * pascal))
            lives.append(life if life is None or math.isfinite(life) else NoNumber.UNLIMITED.value)
        places = [None if v is None else _extended(curve, v * pascal) for v in line]
        answer.append([*lives, *places] if remarks else lives)
    return answer


def _check_stress(
    stress: float, value: float, unit: str, pascal: float, material: Any, at: tuple[int, int]
) -> None:
    """Refuse a stress that no S-N line answers for."""
    place = "Stress" if at == (0, 0) else f"Stress, row {at[0] + 1}, column {at[1] + 1}"
    if value < 0.0:
        raise FunctionError(f"{place}: found {value:.10g}; give 0 or more.", "#NUM!")
    strength = material.uts
    if strength is not None and stress > strength * _SAME_STRESS:
        raise FunctionError(
            f"{place}: found {value:.10g} {unit}, above UTS of '{material.material}', "
            f"{strength / pascal:.6g} {unit}, where S-N lines are not valid. Give a lower stress.",
            "#NUM!",
        )


def _extended(curve: Any, stress: float) -> str | None:
    """Where the S-N line is not between its points; nothing is said where it is."""
    if curve.above_first_point(stress / _SAME_STRESS):
        return "above the first S-N point: extrapolated"
    if stress <= curve.endurance:
        rule = curve.below_endurance
        return None if rule == "none" else f"below endurance: {rule}"
    if stress * _SAME_STRESS < curve.stress[-1]:
        return "below the last S-N point: extrapolated to endurance"
    return None


@registered(
    "TV_LIFE",
    Argument(
        "Damage", "numbers", "The damage of one start of each start condition, from TV_STARTS."
    ),
    Argument("Per year", "numbers", "Starts per year of each condition; 0 = none."),
    Argument("So far", "numbers", "Starts so far of each condition.", True),
    Argument("Starts factor", "number", "StartsFactor; blank = 1.", True),
    example="=TV_LIFE(0.002, 24, 60, 2)",
)
def tv_life(damage: Rows, per_year: Rows, so_far: Rows | None, factor: float | None) -> Rows:
    """Damage ledger of a duty: damage so far, damage per year, damage left, and remaining years.

    Palmgren-Miner: damage of all starts is summed regardless of order; the life of a shaft ends at
    damage 1 / Starts factor. One shaft per call; years are `unlimited` without damage per year.
    """
    damages, yearly = _column("Damage", damage), _column("Per year", per_year)
    blank = so_far is None or all(value is None for line in so_far for value in line)
    seen = [0.0] * len(damages) if blank else _column("So far", so_far or [])
    for name, column in (("Per year", yearly), ("So far", seen)):
        if len(column) != len(damages):
            raise FunctionError(
                f"{name}: found {len(column)} cells, but Damage has {len(damages)}; give the same "
                "number."
            )
    if factor is not None and not factor > 0.0:
        raise FunctionError(f"Starts factor: found {factor:.10g}; give more than 0.", "#NUM!")
    used = math.fsum(q * n for q, n in zip(damages, seen, strict=True))
    a_year = math.fsum(q * n for q, n in zip(damages, yearly, strict=True))
    left = 1.0 / (factor or 1.0) - used
    years = remaining_life(left, a_year)
    return [[used, a_year, left, NoNumber.UNLIMITED.value if years is None else years]]


def _column(name: str, cells: Rows) -> list[float]:
    """Numbers of a range, none of them negative; blank = 0."""
    found = [0.0 if value is None else float(value) for line in cells for value in line]
    wrong = next((value for value in found if value < 0.0), None)
    if wrong is not None:
        raise FunctionError(f"{name}: found {wrong:.10g}; give 0 or more.", "#NUM!")
    return found
