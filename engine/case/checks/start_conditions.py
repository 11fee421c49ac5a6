"""Checks of table StartConditions: names, what each kind of row may state, and the case it makes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from engine.case.checks.problem import COUNTS, POSITIVE, Allowed, Cells, Limit, each_row, suggestion
from engine.case.choices import ConditionKind, ElementKind
from engine.case.conditions import with_damping, with_start
from engine.case.data import CaseData, StartConditionRow, value_of
from engine.errors import Problem

TABLE = "StartConditions"
#: Numbers that no column of the case would check; more load is a percent sign forgotten.
_LIMITS = (
    Limit(
        "Load",
        Allowed(lambda share: 0.0 <= share <= 2.0, "from 0 to 2 (200 % of LoadTorque)"),
        action="Write 80 % or 0.8.",
    ),
    Limit("Stiffness factor", POSITIVE, action="Type the factor, such as 0.8 for a hot coupling."),
    Limit("Per year", COUNTS, action="Type the number of such starts."),
    Limit("So far", COUNTS, action="Type the number of such starts."),
)
#: Scalars and tables of the case that a row changes → the column it is typed in.
_COLUMN_OF = {
    "Voltage": "Voltage",
    "DampingRatio": "Damping ratio",
    "ModeDamping": "Damping ratio",
    "TripSpeed": "Trip speed",
}
#: Columns without effect on continuous operation.
_OF_A_START = ("Voltage", "Load", "Trip speed", "Per year", "So far", "Event")


def check_start_conditions(
    case: CaseData, find_problems: Callable[[CaseData], Sequence[Problem]]
) -> Iterator[Problem]:
    """Everything wrong with the rows; `find_problems` is what the case of a row must pass."""
    names: dict[str, int | None] = {}
    for cells, row in each_row(TABLE, case.start_conditions):
        yield from _name(cells, row, names)
        yield from cells.choice("Kind", row.kind, ConditionKind)
        yield from cells.numbers(row, _LIMITS)
        if row.load not in (None, 1.0) and not case.load_torque:
            words = (
                f"found {row.load:.6g}, but table LoadTorque is empty. Clear the cell, or give the "
                "load curve on sheet Torque and motor."
            )
            yield cells.problem("Load", row.load, "blank", words)
        couplings = any(e.kind == ElementKind.COUPLING for e in case.elements)
        if row.stiffness_factor not in (None, 1.0) and not couplings:
            words = (
                f"found {row.stiffness_factor:.6g}, but no element of table Elements is a coupling, and the factor "
                "is that of couplings. Clear the cell, or correct Kind on sheet Train."
            )
            yield cells.problem("Stiffness factor", row.stiffness_factor, "blank", words)
        if row.kind == ConditionKind.STEADY:
            yield from _steady(cells, row)
            row = replace(row, voltage=None, trip_speed=None)
        elif row.event:
            yield from _event(case, cells, row)
        elif not case.motor_stations:
            words = (
                "a start needs a motor, and table MotorTorque is empty. Give the motor's torque curve on sheet "
                "Torque and motor, or choose steady."
            )
            yield cells.problem("Kind", row.kind, ConditionKind.STEADY, words)
        yield from _of_the_changed_case(case, cells, row, find_problems)


def _name(cells: Cells, row: StartConditionRow, names: dict[str, int | None]) -> Iterator[Problem]:
    if not row.condition:
        action = "Name this start condition, such as 'weak supply, loaded'."
        yield cells.blank("Condition", "a name", action)
    elif row.condition in names:
        words = (
            f"found '{row.condition}', also in row {names[row.condition]}; it must be a unique "
            "name. Rename one, or combine both in one row."
        )
        yield cells.problem("Condition", row.condition, "a name of its own", words)
    else:
        names[row.condition] = cells.row


def _steady(cells: Cells, row: StartConditionRow) -> Iterator[Problem]:
    """Continuous operation: nothing of a start is typed."""
    for column in _OF_A_START:
        value = value_of(row, column)
        if value is not None:
            yield cells.problem(
                column,
                value,
                "blank where Kind is steady",
                "it has no effect on continuous operation, which Kind steady asks for. Clear the cell, or choose start.",
            )


def _event(case: CaseData, cells: Cells, row: StartConditionRow) -> Iterator[Problem]:
    """An event in operation: it is there, nothing of a start is typed, and it is counted once."""
    if row.event not in case.event_names:
        allowed = "an event of table EventTorque or MotorEvents"
        yield cells.wrong("Event", row.event, allowed, suggestion(str(row.event), case.event_names))
    for column in ("Voltage", "Load", "Trip speed"):
        value = value_of(row, column)
        if value is not None:
            yield cells.problem(
                column,
                value,
                "blank where Event is given",
                f"it has no effect on event '{row.event}', which is calculated as the other sheets have it. Clear the cell.",
            )
    if row.event in case.events_per_life:
        for column in ("Per year", "So far"):
            value = value_of(row, column)
            if value is not None:
                yield cells.problem(
                    column,
                    value,
                    "blank where the event has Per life",
                    f"event '{row.event}' would be counted twice: its Per life is given on sheet Torque and motor. Clear one of "
                    "the two cells.",
                )


def _of_the_changed_case(
    case: CaseData,
    cells: Cells,
    row: StartConditionRow,
    find_problems: Callable[[CaseData], Sequence[Problem]],
) -> Iterator[Problem]:
    """What the checks of a case say of the changed one, in the column where it was typed."""
    if row.voltage is None and row.damping_ratio is None and row.trip_speed is None:
        return
    changed = replace(CaseData(**vars(case)), start_conditions=())
    voltage = case.voltage if row.voltage is None else row.voltage
    trip_speed = case.trip_speed if row.trip_speed is None else row.trip_speed
    changed = with_damping(with_start(changed, voltage, trip_speed), row.damping_ratio)
    for problem in find_problems(changed):
        column = _COLUMN_OF.get(problem.table) or _COLUMN_OF.get(problem.column)
        if column is None or value_of(row, column) is None:
            continue  # wrong with the case itself, which is reported elsewhere
        sentence = problem.message
        if problem.table == "ModeDamping" and isinstance(problem.found, (int, float)):
            sentence = (
                f"found {row.damping_ratio:.6g}: ModeDamping is scaled with DampingRatio, and its row "
                f"{problem.row} becomes {problem.found:.6g}, which must be {problem.allowed}. Lower "
                "the damping ratio."
            )
        content = row.damping_ratio if problem.table == "ModeDamping" else problem.found
        yield cells.problem(column, content, problem.allowed, sentence, problem.quoted)
