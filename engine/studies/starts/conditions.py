"""Start conditions as they are typed in `StartConditions`: the case each makes."""

from __future__ import annotations

from dataclasses import dataclass, replace

from engine.case.choices import ConditionKind, ElementKind
from engine.case.conditions import with_damping, with_start
from engine.case.data import TABLED_EVENT, CaseData, StartConditionRow
from engine.case.study_inputs import LOAD_TORQUE, STIFFNESS
from engine.studies.variation import Change, refusal, varied_case

#: Instants of one period at which a standard trip is tried. [count]
TRIP_INSTANTS = 8


@dataclass(frozen=True)
class StartCondition:
    """One start condition, blanks filled from the case."""

    name: str  #: Unique in the matrix.
    voltage: float = 1.0  #: Over the voltage of the torque curves. [1]
    #: Of all elastic modes; None = what the case says, which may be blank. [1]
    damping_ratio: float | None = None
    stiffness_factor: float = 1.0  #: On the stiffness of every coupling. [1]
    load: float = 1.0  #: Share of LoadTorque. [1]
    #: Where it is aborted, of the reference shaft; None = it is not. [rad/s]
    trip_speed: float | None = None
    #: The speed gained in the period over which the trip is tried; 0 = this one instant. [rad/s]
    trip_span: float = 0.0
    per_year: float = 0.0  #: Duty. [1/year, count]
    so_far: float = 0.0  #: Likewise. [1/year, count]
    event: str = ""  #: Event in operation in the place of a start; empty = a start.
    steady: bool = False  #: Continuous operation alone, without a start.
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
            stiffness_factor=row.stiffness_factor or 1.0,
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
        stiffness_factor=row.stiffness_factor or 1.0,
        load=1.0 if row.load is None else row.load,
        trip_speed=case.trip_speed if row.trip_speed is None else row.trip_speed,
        per_year=row.per_year or 0.0,
        so_far=row.so_far or 0.0,
        steady=row.kind == ConditionKind.STEADY,
        row=number,
    )


def typed_conditions(case: CaseData) -> tuple[StartCondition, ...]:
    """Every row of `StartConditions` with its blanks filled, in their order. [SI]"""
    rows = enumerate(case.start_conditions, start=1)
    return tuple(condition_of_row(case, number, row) for number, row in rows)


# --- one start ------------------------------------------------------------------------------------


def condition_case(case: CaseData, condition: StartCondition) -> CaseData:
    """The case as a condition changes it; see `with_start` and `with_damping`.

    Of the events in operation only that of the condition is left, and no other condition.

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
    new = replace(CaseData(**vars(case)), start_conditions=())
    new = _without_other_events(new, condition.event)
    if not (condition.event or condition.steady):
        new = with_start(new, condition.voltage, condition.trip_speed)
    changes = []
    if condition.load != 1.0:
        stations = dict.fromkeys(str(p.station) for p in case.load_torque)
        changes = [Change(LOAD_TORQUE, name, condition.load) for name in stations]
    if condition.stiffness_factor != 1.0:
        changes += [Change(STIFFNESS, n, condition.stiffness_factor) for n in couplings_of(case)]
    return with_damping(varied_case(new, changes) if changes else new, condition.damping_ratio)


def couplings_of(case: CaseData) -> tuple[str, ...]:
    """Couplings that have a stiffness, which Stiffness factor changes. [names]"""
    names = (str(e.element) for e in case.elements if e.kind == ElementKind.COUPLING)
    return tuple(name for name in names if refusal(case, name, STIFFNESS) is None)


def _without_other_events(case: CaseData, event: str) -> CaseData:
    tabled = case.torque_time if event == TABLED_EVENT else case.torque_time_from_rest
    return replace(
        case,
        event_torque=tuple(row for row in case.event_torque if row.event == event),
        motor_events=tuple(row for row in case.motor_events if row.event == event),
        torque_time=tabled,
    )
