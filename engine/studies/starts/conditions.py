"""Start conditions as they are typed in `StartConditions`: their checks, and the case each makes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from engine.case.checks.find_problems import find_problems
from engine.case.checks.problem import (
    COUNTS,
    Allowed,
    Cells,
    Limit,
    each_row,
    first_of_each_cell,
    suggestion,
)
from engine.case.data import TABLED_EVENT, CaseData, value_of
from engine.case.study_inputs import DAMPING_RATIO, LOAD_TORQUE, StartConditionRow, StudyInputs
from engine.errors import Problem
from engine.start.settings import has_start
from engine.studies.variation import Change, varied_case

TABLE = "StartConditions"
#: Instants of one period at which a standard trip is tried. [count]
TRIP_INSTANTS = 8
#: Numbers that no column of the case would check; more load is a percent sign forgotten.
_LIMITS = (
    Limit(
        "Load",
        Allowed(lambda share: 0.0 <= share <= 2.0, "from 0 to 2 (200 % of LoadTorque)"),
        action="Write 80 % or 0.8.",
    ),
    Limit("Per year", COUNTS, action="Type the number of such starts."),
    Limit("So far", COUNTS, action="Type the number of such starts."),
)
#: Scalars of the case that a row changes → the column it is typed in.
_COLUMN_OF = {
    "Voltage": "Voltage",
    "DampingRatio": "Damping ratio",
    "ModeDamping": "Damping ratio",
    "TripSpeed": "Trip speed",
}


@dataclass(frozen=True)
class StartCondition:
    """One start condition, blanks filled from the case."""

    name: str  #: Unique in the matrix.
    voltage: float = 1.0  #: Over the voltage of the torque curves. [1]
    #: Of all elastic modes; None = what the case says, which may be blank. [1]
    damping_ratio: float | None = None
    load: float = 1.0  #: Share of LoadTorque. [1]
    #: Where it is aborted, of the reference shaft; None = it is not. [rad/s]
    trip_speed: float | None = None
    #: The speed gained in the period over which the trip is tried; 0 = this one instant. [rad/s]
    trip_span: float = 0.0
    per_year: float = 0.0  #: Duty. [1/year, count]
    so_far: float = 0.0  #: Likewise. [1/year, count]
    event: str = ""  #: Event in operation in the place of a start; empty = a start.
    per_life: float = 0.0  #: How often that happens in the life of the train. [count]
    row: int | None = None  #: Row of `StartConditions`; None = of the standard matrix.
    why: str = ""  #: Why the standard matrix has it; empty for a row.

    @property
    def has_duty(self) -> bool:
        """Whether such starts have happened or will. [flag]"""
        return self.per_year > 0.0 or self.so_far > 0.0 or self.per_life > 0.0

    @property
    def instants(self) -> tuple[StartCondition, ...]:
        """The same with each trip speed that is tried: what is calculated for it. [rad/s]"""
        if self.trip_speed is None or self.trip_span == 0.0:
            return (self,)
        return tuple(
            replace(
                self, trip_speed=self.trip_speed + k / TRIP_INSTANTS * self.trip_span, trip_span=0.0
            )
            for k in range(TRIP_INSTANTS)
        )


# --- what was typed -------------------------------------------------------------------------------


def condition_problems(case: CaseData, studies: StudyInputs) -> tuple[Problem, ...]:
    """Everything wrong with `StartConditions`.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Its rows. [SI]

    Returns
    -------
    tuple of Problem
        Empty if the matrix may be calculated; at most one problem a cell. [count]
    """
    problems = first_of_each_cell(_problems(case, studies.start_conditions), ())
    return tuple(sorted(problems, key=lambda p: p.row or 0))


def _problems(case: CaseData, rows: Sequence[StartConditionRow]) -> Iterator[Problem]:
    if not has_start(case):
        words = (
            "the case has no rows in table MotorTorque, so there is no start whose voltage, load or "
            "trip speed could be changed. Give the motor's torque curve on sheet Torque and motor."
        )
        yield Cells(TABLE).problem("", None, "a case with a motor torque curve", words)
        return
    names: dict[str, int | None] = {}
    for cells, row in each_row(TABLE, rows):
        yield from _name(cells, row, names)
        yield from cells.numbers(row, _LIMITS)
        if row.load not in (None, 1.0) and not case.load_torque:
            words = (
                f"found {row.load:.6g}, but table LoadTorque is empty. Clear the cell, or give the "
                "load curve on sheet Torque and motor."
            )
            yield cells.problem("Load", row.load, "blank", words)
        if row.event:
            yield from _event(case, cells, row)
        yield from _of_the_changed_case(case, cells, replace(row, load=None))


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


def _of_the_changed_case(case: CaseData, cells: Cells, row: StartConditionRow) -> Iterator[Problem]:
    """What the checks of a case say of the changed one, in the column where it was typed."""
    for problem in find_problems(condition_case(case, condition_of_row(case, cells.row, row))):
        column = _COLUMN_OF.get(problem.table) or _COLUMN_OF.get(problem.column)
        if column is None:
            continue  # wrong with the case itself, which is reported elsewhere
        sentence = problem.message
        if problem.table == "ModeDamping":
            sentence = (
                f"found {row.damping_ratio:.6g}: ModeDamping is scaled with DampingRatio, and its row "
                f"{problem.row} becomes {problem.found:.6g}, which must be {problem.allowed}. Lower "
                "the damping ratio."
            )
        content = row.damping_ratio if problem.table == "ModeDamping" else problem.found
        yield cells.problem(column, content, problem.allowed, sentence, problem.quoted)


def condition_of_row(case: CaseData, number: int | None, row: StartConditionRow) -> StartCondition:
    """A row with its blanks filled.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    number : int
        Its row, from 1. [count]
    row : StartConditionRow
        What was typed. [SI]

    Returns
    -------
    StartCondition
        Blanks are those of the case. [SI]
    """
    if row.event:
        return StartCondition(
            name=row.condition or f"row {number}",
            damping_ratio=row.damping_ratio,
            per_year=row.per_year or 0.0,
            so_far=row.so_far or 0.0,
            event=row.event,
            per_life=case.events_per_life.get(row.event, 0.0),
            row=number,
        )
    voltage = case.voltage or 1.0
    return StartCondition(
        name=row.condition or f"row {number}",
        voltage=voltage if row.voltage is None else row.voltage,
        damping_ratio=row.damping_ratio,
        load=1.0 if row.load is None else row.load,
        trip_speed=case.trip_speed if row.trip_speed is None else row.trip_speed,
        per_year=row.per_year or 0.0,
        so_far=row.so_far or 0.0,
        row=number,
    )


# --- one start ------------------------------------------------------------------------------------


def condition_case(case: CaseData, condition: StartCondition) -> CaseData:
    """The case as a start condition changes it.

    A damping ratio stands in the place of DampingRatio, and `ModeDamping` is scaled in the same
    proportion: hot or cold oil changes all modes alike. Where the case states no DampingRatio there
    is no proportion, and `ModeDamping` stays. Dampers and loss factors stay, too. A trip speed is
    asked for: an effect choice that forces aborted starts off is not kept beside it. Of the events in operation
    only that of the condition is left.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    condition : StartCondition
        The start condition. [SI]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    new = _without_other_events(CaseData(**vars(case)), condition.event)
    if not condition.event:
        new = replace(new, voltage=condition.voltage, trip_speed=condition.trip_speed)
    if condition.trip_speed is not None:
        choices = tuple(
            c for c in new.effect_choices if (c.effect, c.choice) != ("aborted start", "off")
        )
        new = replace(new, effect_choices=choices)
    changes = []
    if condition.load != 1.0:
        stations = dict.fromkeys(str(p.station) for p in case.load_torque)
        changes = [Change(LOAD_TORQUE, name, condition.load) for name in stations]
    ratio = condition.damping_ratio
    if ratio is not None and case.damping_ratio:
        changes.append(Change(DAMPING_RATIO, "", ratio / case.damping_ratio))
    new = varied_case(new, changes) if changes else new
    return new if ratio is None else replace(new, damping_ratio=ratio)


def _without_other_events(case: CaseData, event: str) -> CaseData:
    tabled = case.torque_time if event == TABLED_EVENT else case.torque_time_from_rest
    return replace(
        case,
        event_torque=tuple(row for row in case.event_torque if row.event == event),
        motor_events=tuple(row for row in case.motor_events if row.event == event),
        torque_time=tabled,
    )
