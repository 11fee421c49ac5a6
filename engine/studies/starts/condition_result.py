"""One start of a matrix, calculated: outcome, largest torque, damage and starts of each judged shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from engine.backlash.operating_events import OperatingEvent, operating_events
from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.result_words import Outcome
from engine.errors import TorsionError
from engine.fatigue.allowable_starts import ShaftFatigue
from engine.fatigue.stress import stress_of_unit_torque
from engine.results.results import Results
from engine.run import run
from engine.start.pieces import analysis_for_start
from engine.start.start import Start
from engine.start.start_fatigue import is_counted, judged_shafts
from engine.studies.starts.conditions import StartCondition, condition_case, couplings_of

#: Outcome of a condition whose run raised an error, or that was not begun.
NOT_CALCULATED = "not calculated"
#: That of an event, which is no start of its own: in operation, or while the motor starts.
EVENT, EVENT_IN_START = "event in operation", "event in the start"


@dataclass(frozen=True)
class ConditionShaft:
    """What one start of a kind does to one judged shaft."""

    element: str  #: Row of `Elements`.
    peak_to_peak_stress: float  #: Nominal, without SCF, from rest to the end. [Pa]
    damage: float  #: Miner sum of one such start, or of the part of it that was calculated. [1]
    #: The same at the ends of its error: that of the history, and the change between two steps.
    #: [1]
    damage_low: float
    damage_high: float  #: Likewise. [1]
    #: Of this start condition alone, 1/damage; None = unlimited or not judged. [1]
    allowable_starts: float | None
    unlimited: bool  #: No damage.
    judged: bool  #: Whether the damage says how many such starts are allowed.
    #: Cycles above the first S-N point: their life is its slope extended, not test data.
    extended: bool
    #: Nominal peak above shear yield: elastic stress and its count do not hold.
    yields: bool = False


@dataclass(frozen=True)
class ConditionResult:
    """One row of the matrix."""

    condition: StartCondition  #: What was asked. [SI]
    outcome: str  #: That of the start, or ``not calculated``.
    words: str  #: The outcome with the speed where it ended.
    time: float | None = None  #: Simulated time, of an aborted start with the coast-down. [s]
    end_speed: float | None = None  #: Of the reference shaft. [rad/s]
    percent_speed: float | None = None  #: The same over synchronous speed. [1]
    #: Largest torque of any element, referred to the reference shaft. [N m]
    peak_torque: float | None = None
    #: The same over RatedTorque; None where that is unknown. [1]
    peak_over_rated: float | None = None
    peak_element: str | None = None  #: Where it is.
    peak_to_peak_stress: float | None = None  #: Nominal, of the governing shaft. [Pa]
    #: Lowest torque of any gear mesh, on its From side. [N m]
    mesh_minimum_torque: float | None = None
    mesh: str | None = None  #: Which one.
    impacts: int | None = None  #: Recontacts of all clearances; None where none was modelled.
    shafts: tuple[ConditionShaft, ...] = ()  #: Every judged shaft. [rows]
    #: Judged shaft with the fewest starts, else with the largest stress.
    governing: str | None = None
    #: Of this start condition alone, of the governing shaft; None = unlimited or not judged. [1]
    allowable_starts: float | None = None
    unlimited: bool = False  #: Shafts are judged and none is damaged.
    judged: bool = False  #: Whether there is a number of allowable starts, or unlimited.
    #: What a reader must know of the run, and of its accuracy; the shafts tell their limits.
    remarks: tuple[str, ...] = ()
    accuracy: str = ""  #: Likewise.

    def shaft(self, name: str | None) -> ConditionShaft | None:
        """One of the judged shafts; None where it was not calculated. [mixed]"""
        return next((s for s in self.shafts if s.element == name), None)

    @property
    def note(self) -> str:
        """What a reader must know of this start. [sentences]"""
        sentences = (*self.remarks, *_limits_passed(self.shafts), self.accuracy)
        return " ".join(sentence for sentence in sentences if sentence)


def calculate_condition(case: CaseData, condition: StartCondition) -> ConditionResult:
    """One start of the matrix: one unit of work.

    Parameters
    ----------
    case : CaseData
        The checked case. [SI]
    condition : StartCondition
        One of the units of the plan. [SI]

    Returns
    -------
    ConditionResult
        Its row; where the run raises an error, the row says why. [SI]
    """
    try:
        changed = Case(**vars(condition_case(case, condition)))
        if condition.event:
            (event,) = operating_events(changed, analysis_for_start(changed))
            return event_row(case, condition, event)
        results = run(changed)
    except TorsionError as error:
        return ConditionResult(condition, NOT_CALCULATED, NOT_CALCULATED, remarks=(str(error),))
    return start_row(case, condition, results)


def event_row(case: CaseData, condition: StartCondition, event: OperatingEvent) -> ConditionResult:
    """The row of an event that was calculated as the condition asks.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    condition : StartCondition
        The condition. [SI]
    event : OperatingEvent
        Its event. [SI]

    Returns
    -------
    ConditionResult
        Its row. [SI]
    """
    response = event.response
    begins = {row.event: row.in_start for row in case.motor_events}
    outcome = EVENT if begins.get(event.name) is None else EVENT_IN_START
    if response is None:
        return ConditionResult(condition, NOT_CALCULATED, NOT_CALCULATED, remarks=(event.note,))
    largest, torque = response.largest_peak(case.element_speed_ratios)
    rated, errors = case.ratings.rated_torque, dict(event.damage_errors)
    counted = {s.element: s for s in event.shafts}
    span = {p.element: p.peak_to_peak for p in response.peaks}
    shafts = tuple(
        _shaft(
            counted[str(e.element)], span[str(e.element)] * stress_of_unit_torque(e), errors, True
        )
        for _, e in judged_shafts(case)
    )
    governing = _governing(shafts)
    return ConditionResult(
        condition=condition,
        outcome=outcome,
        words=outcome,
        time=response.outcome.time,
        peak_torque=torque,
        peak_over_rated=torque / rated if rated else None,
        peak_element=None if largest is None else largest.element,
        peak_to_peak_stress=None if governing is None else governing.peak_to_peak_stress,
        shafts=shafts,
        governing=None if governing is None else governing.element,
        allowable_starts=None if governing is None else governing.allowable_starts,
        unlimited=bool(shafts) and all(s.unlimited for s in shafts),
        judged=bool(shafts),
        remarks=(event.note,),
        accuracy=_accuracy(response),
    )


def start_row(case: CaseData, condition: StartCondition, results: Results) -> ConditionResult:
    """The row of a start that was calculated as the condition asks.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    condition : StartCondition
        The condition. [SI]
    results : Results
        The run of the changed case. [SI]

    Returns
    -------
    ConditionResult
        Its row. [SI]
    """
    start = results.start
    assert start is not None
    outcome, synchronous = start.outcome, case.ratings.synchronous_speed
    share = outcome.end_speed / synchronous if synchronous else None
    largest, torque = start.largest_peak(case.element_speed_ratios)
    peak = None if largest is None else torque
    rated = case.ratings.rated_torque
    meshes = {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    lowest = min(((p.minimum, p.element) for p in start.peaks if p.element in meshes), default=None)
    impacts = [r.impacts for r in results.reversals if r.impacts is not None]
    shafts = _shafts(case, results)
    governing = _governing(shafts)
    judged = bool(shafts) and all(s.judged for s in shafts)
    return ConditionResult(
        condition=condition,
        outcome=outcome.outcome,
        words=_outcome_words(results, condition, synchronous, share),
        time=outcome.time,
        end_speed=outcome.end_speed,
        percent_speed=share,
        peak_torque=peak,
        peak_over_rated=peak / rated if rated and peak is not None else None,
        peak_element=None if largest is None else largest.element,
        peak_to_peak_stress=None if governing is None else governing.peak_to_peak_stress,
        mesh_minimum_torque=None if lowest is None else lowest[0],
        mesh=None if lowest is None else lowest[1],
        impacts=sum(impacts) if impacts else None,
        shafts=shafts,
        governing=None if governing is None else governing.element,
        allowable_starts=governing.allowable_starts if judged and governing else None,
        unlimited=judged and all(s.unlimited for s in shafts),
        judged=judged,
        remarks=tuple(_remarks(case, condition, results, shafts)),
        accuracy=_accuracy(start),
    )


def _outcome_words(
    results: Results, condition: StartCondition, synchronous: float | None, share: float | None
) -> str:
    assert results.start is not None
    word = results.start.outcome.outcome
    if word == Outcome.TRIPPED and condition.trip_speed and synchronous:
        return f"tripped at {100.0 * condition.trip_speed / synchronous:.1f} % speed"
    if share is None or word in (Outcome.NO_BREAKAWAY, Outcome.SYNCHRONISED):
        return word
    return f"{word} at {100.0 * share:.1f} % speed"


def _shafts(case: CaseData, results: Results) -> tuple[ConditionShaft, ...]:
    """Every judged shaft; where counting is forced off, with its stress alone and not judged."""
    counted = {} if results.starts is None else {s.element: s for s in results.starts.shafts}
    errors = dict(results.starts_error)
    whole = is_counted(results.start)
    assert results.start is not None
    span = {p.element: p.peak_to_peak for p in results.start.peaks}
    shafts = []
    for _, e in judged_shafts(case):
        name = str(e.element)
        shaft: ShaftFatigue | None = counted.get(name)
        stress = span[name] * stress_of_unit_torque(e)
        if shaft is None:
            shafts.append(ConditionShaft(name, stress, 0.0, 0.0, 0.0, None, False, False, False))
            continue
        shafts.append(_shaft(shaft, stress, errors, whole))
    return tuple(shafts)


def _shaft(
    shaft: ShaftFatigue, stress: float, errors: Mapping[str, float | None], whole: bool
) -> ConditionShaft:
    error = errors.get(shaft.element) or 0.0
    return ConditionShaft(
        element=shaft.element,
        peak_to_peak_stress=stress,
        damage=shaft.damage,
        damage_low=min(shaft.damage_low, shaft.damage * max(1.0 - error, 0.0)),
        damage_high=max(shaft.damage_high, shaft.damage * (1.0 + error)),
        allowable_starts=shaft.allowable_starts if whole else None,
        unlimited=whole and shaft.unlimited,
        judged=whole,
        extended=shaft.above_first_point > 0.0,
        yields=bool(shaft.above_shear_yield),
    )


def _governing(shafts: Sequence[ConditionShaft]) -> ConditionShaft | None:
    return max(shafts, key=lambda s: (s.damage, s.peak_to_peak_stress), default=None)


def _remarks(
    case: CaseData, condition: StartCondition, results: Results, shafts: Sequence[ConditionShaft]
) -> Iterator[str]:
    start = results.start
    assert start is not None
    outcome, name = start.outcome, start.outcome.outcome
    if not is_counted(start):
        yield f"Incomplete start: {outcome.sentence}"
        if any(s.damage > 0.0 for s in shafts):
            yield (
                f"Damage of one attempt is counted up to {outcome.time:.1f} s; allowable starts are "
                "not judged, because the attempt continues."
            )
        elif shafts:
            yield "Allowable starts are not judged."
    elif name == Outcome.TRIPPED:
        yield f"{outcome.sentence} The coast-down is counted."
        if condition.row is not None:
            yield (
                "Trip at one instant; another instant within the same period of the torsional "
                "vibration may cause more or less damage."
            )
    elif condition.trip_speed is not None:
        yield f"It does not reach its trip speed. {outcome.sentence}"
    elif name == Outcome.ASYNCHRONOUS:
        yield outcome.sentence
    if results.starts is None and shafts:
        yield "Starts are not judged: cycle counting is forced off in EffectChoices."
    if condition.stiffness_factor != 1.0:
        names = ", ".join(couplings_of(case))
        yield f"Stiffness of couplings ({names}) × {condition.stiffness_factor:.4g}."
    if condition.damping_ratio is not None and case.mode_damping and not case.damping_ratio:
        yield "ModeDamping is unchanged: without DampingRatio in the case it cannot be scaled."
    elif condition.damping_ratio is not None and case.mode_damping:
        factor = condition.damping_ratio / (case.damping_ratio or 1.0)
        yield f"ModeDamping is scaled by {factor:.4g}, as DampingRatio is."


def _accuracy(start: Start) -> str:
    """A sentence where the answers are less sure than wanted."""
    if start.is_sensitive:
        return "Sensitive to tiny input changes: the result is one sample of possible values."
    if not start.met_tolerance:
        return f"Wanted accuracy not reached: estimated error of peaks {start.estimated_error:.2g}."
    return ""


def _limits_passed(shafts: Sequence[ConditionShaft]) -> Iterator[str]:
    """A sentence for each limit that shafts have passed."""
    extended = [s.element for s in shafts if s.extended]
    if extended:
        yield f"Cycles above the first S-N point ({', '.join(extended)}): life extrapolated."
    yielding = [s.element for s in shafts if s.yields]
    if yielding:
        yield f"Nominal peak above shear yield ({', '.join(yielding)}): allowable starts invalid."
