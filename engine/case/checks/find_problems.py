"""Every check a case must pass, all of them at once.

`find_problems` never stops at the first: an engineer corrects a workbook once, not once an error.
Cells the reader has already complained about are passed in, so that a number that could not be
read is not reported a second time as missing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain

from engine.case.checks.effects import check_effect_choices
from engine.case.checks.events import check_events
from engine.case.checks.fatigue import check_fatigue_factors, check_materials, check_sn_points
from engine.case.checks.gears import check_meshes
from engine.case.checks.motor_events import check_motor_events
from engine.case.checks.motors import check_motors
from engine.case.checks.problem import first_of_each_cause, first_of_each_cell
from engine.case.checks.scalars import check_scalars
from engine.case.checks.sections import check_sections
from engine.case.checks.start_conditions import check_start_conditions
from engine.case.checks.supply import check_supply
from engine.case.checks.torques import check_excitations, check_torques
from engine.case.checks.train import (
    check_connected,
    check_elements,
    check_mode_damping,
    check_stations,
)
from engine.case.data import TABLES, CaseData
from engine.errors import Problem

CHECKS: tuple[Callable[[CaseData], Iterator[Problem]], ...] = (
    check_scalars,
    check_stations,
    check_elements,
    check_sections,
    check_meshes,
    check_mode_damping,
    check_torques,
    check_events,
    check_motor_events,
    check_motors,
    check_supply,
    check_materials,
    check_sn_points,
    check_fatigue_factors,
    check_excitations,
    check_effect_choices,
)


def find_problems(
    case: CaseData, bad_cells: frozenset[tuple[str, int | None, str]] = frozenset()
) -> tuple[Problem, ...]:
    """Everything wrong with a case.

    Parameters
    ----------
    case : CaseData
        What was typed. [SI]
    bad_cells : frozenset of (table, row, column)
        Cells the reader has already reported; nothing is said of them again. [names]

    Returns
    -------
    tuple of Problem
        Empty if the case may be calculated; one problem a cell, the first found, and one a missing name. [count]
    """
    found = (p for check in CHECKS for p in check(case))
    of_conditions = check_start_conditions(case, find_problems)
    problems = first_of_each_cell(chain(found, of_conditions), bad_cells)
    unusable = {"Stations", "Elements"} & ({p.table for p in problems} | {b[0] for b in bad_cells})
    if not unusable:
        problems.extend(check_connected(case))
    order = {name: i for i, name in enumerate(("Case", *TABLES))}
    ordered = sorted(problems, key=lambda p: (order.get(p.table, 99), p.row or 0))
    return tuple(first_of_each_cause(ordered))
