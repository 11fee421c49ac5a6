"""Starts at every voltage, hot and cold, loaded and unloaded, whole and aborted.

Each kind of start is the case with four things changed: voltage, damping ratio (`ModeDamping` in
proportion), load torque, trip speed. Each goes through the whole `engine.run.run`, effects planned
anew, so that a row of the matrix says what the same case would say alone.

The standard matrix, for a blank `StartConditions`: the voltages that a stiff and a weak supply give
(`STANDARD_VOLTAGES`), each with the load curve and without, as loads are often started by-passed or
empty; the damping is that of the case, as only the engineer knows it hot and cold; and at full
voltage, loaded, starts aborted where the paper's sweep leaves the most behind (just past each
crossing) and at fixed speeds (`STANDARD_TRIPS`). What a trip does hangs on its instant: the average
torque that held the shafts twisted is gone at once, and the ringing it leaves adds to that of the mode
or takes from it. So each standard trip is tried at `TRIP_INSTANTS` instants of one period, and the
worst stands in the row. A trip speed that is typed is one instant, and its note says so. Rows are taken as they stand: nothing is added to
a duty unless it is asked for.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Stress criterion".
Lewis, Vibration during acceleration through a critical speed (1932): the largest response comes
after the crossing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, ElementRow, case_digest
from engine.case.study_inputs import StartConditionRow, StudyInputs, study_digest
from engine.errors import Problem, TorsionError
from engine.fatigue.allowable_starts import ShaftFatigue
from engine.fatigue.stress import shear_stress
from engine.model.load import loads_of
from engine.model.modal_analysis import analyse
from engine.model.motor import motors_of
from engine.model.rigid_runup import rigid_runup
from engine.operation.margins import percent_speed
from engine.results.results import Results
from engine.run import run
from engine.start.outcome import Outcome
from engine.start.settings import has_start, settings_of
from engine.start.start_fatigue import WHOLE_STARTS, is_counted, judged_shafts
from engine.studies.variation import DAMPING_RATIO, LOAD_TORQUE, Change, changed

__all__ = [
    "NOT_CALCULATED",
    "STANDARD_TRIPS",
    "STANDARD_VOLTAGES",
    "TRIP_INSTANTS",
    "ConditionResult",
    "ConditionShaft",
    "MatrixPlan",
    "StartCondition",
    "StartMatrix",
    "calculate_condition",
    "condition_case",
    "condition_problems",
    "gather_matrix",
    "plan_matrix",
    "start_matrix",
    "start_rows",
    "voltage_rows",
]

TABLE = "StartConditions"
#: Over the voltage of the torque curves: from the dip of a weak supply under the starting current to
#: a supply 10 % too high. [1]
STANDARD_VOLTAGES = (0.80, 0.85, 0.90, 0.95, 1.00, 1.05, 1.10)
#: Speeds of aborted starts over synchronous: early, late, and just before the end. [1]
STANDARD_TRIPS = (0.50, 0.75, 0.95)
#: Instants of one period at which a standard trip is tried. [count]
TRIP_INSTANTS = 8
#: A fixed trip speed this near to one behind a crossing is that one. [1 of synchronous speed]
SAME_TRIP = 0.02
#: An undamped mode, swept through at constant rate ḟ, responds most 0.86/√ḟ after the crossing: the
#: largest distance on Cornu's spiral is at 1.217, and u = √(2 ḟ) t. [1]
LATEST_RESPONSE = 0.8606
#: More load than this is a percent sign forgotten. [1]
LARGEST_LOAD = 2.0
#: Outcome of a condition whose run raised an error, or that was not begun.
NOT_CALCULATED = "not calculated"
#: Scalars of the case that a row changes → the column it is typed in.
_COLUMN_OF = {
    "Voltage": "Voltage",
    "DampingRatio": "Damping ratio",
    "ModeDamping": "Damping ratio",
    "TripSpeed": "Trip speed",
}


@dataclass(frozen=True)
class StartCondition:
    """One kind of start, blanks filled from the case."""

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
    row: int | None = None  #: Row of `StartConditions`; None = of the standard matrix.
    why: str = ""  #: Why the standard matrix has it; empty for a row.

    @property
    def has_duty(self) -> bool:
        """Whether such starts have happened or will. [flag]"""
        return self.per_year > 0.0 or self.so_far > 0.0

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


@dataclass(frozen=True)
class MatrixPlan:
    """What will be calculated: one full run a unit."""

    #: In the order of the table, then of the standard matrix. [rows]
    conditions: tuple[StartCondition, ...]
    standard: bool  #: Whether the standard matrix is in it.
    notes: tuple[str, ...] = ()  #: What was left out of it, and why.

    @property
    def units(self) -> tuple[StartCondition, ...]:
        """Every run: one a condition, of a standard trip one an instant. [rows]"""
        return tuple(one for c in self.conditions for one in c.instants)


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
    #: Of this kind alone, 1/damage; None = unlimited or not judged. [1]
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
    #: Of this kind alone, of the governing shaft; None = unlimited or not judged. [1]
    allowable_starts: float | None = None
    unlimited: bool = False  #: Shafts are judged and none is damaged.
    judged: bool = False  #: Whether there is a number of allowable starts, or unlimited.
    note: str = ""  #: What a reader must know.


@dataclass(frozen=True)
class StartMatrix:
    """The whole matrix."""

    rows: tuple[ConditionResult, ...]  #: In the order of the plan. [rows]
    judged_shafts: tuple[str, ...]  #: Shafts whose fatigue can be judged.
    starts_factor: float  #: Allowable starts are divided by it before they are judged. [1]
    standard: bool  #: Whether the standard matrix is in it.
    complete: bool  #: False where it was stopped before the last condition.
    sentence: str  #: What it shows.
    notes: tuple[str, ...]  #: What was left out, and why.
    case_sha256: str  #: Digests of the case and of the rows. [hex]
    study_sha256: str  #: Likewise. [hex]


# --- what was typed -------------------------------------------------------------------------------


def condition_problems(
    case: CaseData,
    studies: StudyInputs,
    bad_cells: frozenset[tuple[str, int | None, str]] = frozenset(),
) -> tuple[Problem, ...]:
    """Everything wrong with `StartConditions`.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Its rows. [SI]
    bad_cells : frozenset of (table, row, column)
        Cells the reader has already reported; nothing is said of them again. [names]

    Returns
    -------
    tuple of Problem
        Empty if the matrix may be calculated; at most one problem a cell. [count]
    """
    found: dict[tuple[str, int | None, str], Problem] = {}
    for problem in _problems(case, studies.start_conditions):
        place = (problem.table, problem.row, problem.column)
        if place not in bad_cells:
            found.setdefault(place, problem)
    return tuple(sorted(found.values(), key=lambda p: p.row or 0))


def _problems(case: CaseData, rows: Sequence[StartConditionRow]) -> Iterator[Problem]:
    if not has_start(case):
        yield Problem(
            TABLE,
            None,
            "",
            None,
            "a case with a motor torque curve",
            "the case has no rows in table MotorTorque, so there is no start whose voltage, load or "
            "trip speed could be changed. Give the motor's torque curve on sheet Torque.",
        )
        return
    names: dict[str, int] = {}
    for number, row in enumerate(rows, start=1):
        yield from _name(number, row, names)
        yield from _numbers(number, row, bool(case.load_torque))
        yield from _of_the_changed_case(case, number, replace(row, load=None))


def _name(number: int, row: StartConditionRow, names: dict[str, int]) -> Iterator[Problem]:
    if not row.condition:
        yield Problem(
            TABLE,
            number,
            "Condition",
            None,
            "a name",
            "the cell is blank; it must be a name. Name this kind of start, such as 'weak supply, "
            "loaded'.",
        )
    elif row.condition in names:
        yield Problem(
            TABLE,
            number,
            "Condition",
            row.condition,
            "a name of its own",
            f"found '{row.condition}', which row {names[row.condition]} has too; it must be a name "
            "of its own. Rename one, or add up their duty in one row.",
        )
    else:
        names[row.condition] = number


def _numbers(number: int, row: StartConditionRow, has_load: bool) -> Iterator[Problem]:
    """Numbers that no column of the case would check."""
    for column, value, allowed, most in (
        ("Load", row.load, "from 0 to 2 (200 % of LoadTorque)", LARGEST_LOAD),
        ("Per year", row.per_year, "zero or more, and finite", math.inf),
        ("So far", row.so_far, "zero or more, and finite", math.inf),
    ):
        if value is not None and not (math.isfinite(value) and 0.0 <= value <= most):
            action = "Write 80 % or 0.8." if column == "Load" else "Count such starts."
            yield Problem(
                TABLE,
                number,
                column,
                value,
                allowed,
                f"found {value:.6g}; it must be {allowed}. {action}",
            )
    if row.load not in (None, 1.0) and not has_load:
        yield Problem(
            TABLE,
            number,
            "Load",
            row.load,
            "blank",
            f"found {row.load:.6g}, but the case has no rows in table LoadTorque that it could be a "
            "share of. Clear the cell, or give the load curve on sheet Torque.",
        )


def _of_the_changed_case(case: CaseData, number: int, row: StartConditionRow) -> Iterator[Problem]:
    """What the checks of a case say of the changed one, in the column where it was typed."""
    for problem in find_problems(condition_case(case, _condition(case, number, row))):
        column = _COLUMN_OF.get(problem.table) or _COLUMN_OF.get(problem.column)
        if column is None:
            continue  # wrong with the case itself, which is told elsewhere
        said = problem.message
        if problem.table == "ModeDamping":
            said = (
                f"found {row.damping_ratio:.6g}: table ModeDamping is scaled with DampingRatio, and "
                f"its row {problem.row} then says {problem.found:.6g}, which must be "
                f"{problem.allowed}. Lower the damping ratio."
            )
        found = row.damping_ratio if problem.table == "ModeDamping" else problem.found
        yield Problem(TABLE, number, column, found, problem.allowed, said, problem.quoted)


def _condition(case: CaseData, number: int, row: StartConditionRow) -> StartCondition:
    """A row with its blanks filled."""
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


# --- the plan -------------------------------------------------------------------------------------


def plan_matrix(case: CaseData, studies: StudyInputs, *, with_standard: bool = False) -> MatrixPlan:
    """Which starts are calculated.

    Parameters
    ----------
    case : CaseData
        A checked case with a start. [SI]
    studies : StudyInputs
        Its checked rows; without any, the standard matrix. [SI]
    with_standard : bool, optional
        Add the standard matrix to the rows. [flag]

    Returns
    -------
    MatrixPlan
        The conditions. [SI]
    """
    rows = studies.start_conditions
    conditions = [_condition(case, number, row) for number, row in enumerate(rows, start=1)]
    if rows and not with_standard:
        return MatrixPlan(tuple(conditions), standard=False)
    taken = {c.name for c in conditions}
    standard, notes = _standard(case)
    for c in standard:
        name = c.name if c.name not in taken else f"{c.name} (standard)"
        conditions.append(replace(c, name=name))
    return MatrixPlan(tuple(conditions), standard=True, notes=notes)


def _standard(case: CaseData) -> tuple[list[StartCondition], tuple[str, ...]]:
    """Voltages, loaded and unloaded, then aborted starts."""
    loads = (1.0, 0.0) if case.load_torque else (1.0,)
    words = {1.0: ", loaded", 0.0: ", unloaded"} if case.load_torque else {1.0: ""}
    found = [
        StartCondition(
            f"{100.0 * v:.0f} % voltage{words[load]}", v, load=load, why="supply and load"
        )
        for load in loads
        for v in STANDARD_VOLTAGES
    ]
    notes = []
    if not case.load_torque:
        notes.append(
            "The case has no LoadTorque: loaded and unloaded are the same start, calculated once."
        )
    trips, left_out = _trips(case)
    synchronous = case.ratings.synchronous_speed or 1.0
    found += [
        StartCondition(
            f"aborted at {100.0 * speed / synchronous:.1f} % speed",
            trip_speed=speed,
            trip_span=span,
            why=why,
        )
        for speed, span, why in trips
    ]
    return found, (*notes, *left_out)


def _trips(case: CaseData) -> tuple[list[tuple[float, float, str]], list[str]]:
    """Trip speeds of the standard matrix, the span of each and its reason; what was left out."""
    synchronous, line = case.ratings.synchronous_speed, case.ratings.line_frequency
    if not synchronous:
        return [], []
    end = synchronous if case.field_slip is not None else settings_of(case).end_speed
    full = condition_case(case, StartCondition("full voltage"))
    model = analyse(full).torsional
    train, modes = model.train, model.modes
    runup = rigid_runup(train, motors_of(full, train), loads_of(full, train), end)
    highest = end if runup.equilibrium is None else runup.equilibrium
    behind: list[tuple[float, float, str]] = []
    notes: list[str] = []
    slowest = 0.0  # lowest frequency that is crossed
    for r in range(modes.n_rigid, modes.n_modes):
        f = float(modes.frequency[r])
        if not line or percent_speed(f, line) is None or not modes.twists[r]:
            continue
        slowest = slowest or f
        crossing = synchronous * (1.0 - f / (2.0 * line))
        acceleration = max(runup.acceleration_at(crossing), 0.0)
        sweep = 2.0 * line * acceleration / synchronous
        late = f - LATEST_RESPONSE * math.sqrt(sweep)
        speed = synchronous * (1.0 - late / (2.0 * line))
        name = f"mode {r - modes.n_rigid + 1} ({f:.4g} Hz)"
        if speed > highest or acceleration == 0.0:
            notes.append(
                f"No aborted start just past {name}: at full voltage the start ends at "
                f"{highest / synchronous:.1%} speed, before {speed / synchronous:.1%}."
            )
        else:
            span = max(runup.acceleration_at(speed), 0.0) / f
            behind.append((speed, min(span, highest - speed), f"just past {name}"))
    fixed = []
    for speed in (share * synchronous for share in STANDARD_TRIPS):
        if speed <= highest and all(abs(speed - s) > SAME_TRIP * synchronous for s, *_ in behind):
            span = max(runup.acceleration_at(speed), 0.0) / slowest if slowest else 0.0
            fixed.append((speed, min(span, highest - speed), "fixed speed"))
    return sorted([*behind, *fixed]), notes


# --- one start ------------------------------------------------------------------------------------


def condition_case(case: CaseData, condition: StartCondition) -> CaseData:
    """The case as a kind of start changes it.

    A damping ratio stands in the place of DampingRatio, and `ModeDamping` is scaled in the same
    proportion: hot or cold oil changes all modes alike. Where the case states no DampingRatio there
    is no proportion, and `ModeDamping` stays. Dampers and loss factors stay, too. A trip speed is
    asked for: an effect choice that forces aborted starts off is not kept beside it.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    condition : StartCondition
        The kind of start. [SI]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    new = replace(
        CaseData(**vars(case)), voltage=condition.voltage, trip_speed=condition.trip_speed
    )
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
    new = changed(new, changes) if changes else new
    return new if ratio is None else replace(new, damping_ratio=ratio)


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
        results = run(Case(**vars(condition_case(case, condition))))
    except TorsionError as wrong:
        return ConditionResult(condition, NOT_CALCULATED, NOT_CALCULATED, note=str(wrong))
    return _row(case, condition, results)


def _row(case: CaseData, condition: StartCondition, results: Results) -> ConditionResult:
    start = results.start
    assert start is not None
    outcome, synchronous = start.outcome, case.ratings.synchronous_speed
    share = outcome.end_speed / synchronous if synchronous else None
    peak, where = _largest_torque(results)
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
        peak_element=where,
        peak_to_peak_stress=None if governing is None else governing.peak_to_peak_stress,
        mesh_minimum_torque=None if lowest is None else lowest[0],
        mesh=None if lowest is None else lowest[1],
        impacts=sum(impacts) if impacts else None,
        shafts=shafts,
        governing=None if governing is None else governing.element,
        allowable_starts=governing.allowable_starts if judged and governing else None,
        unlimited=judged and all(s.unlimited for s in shafts),
        judged=judged,
        note=" ".join(_notes(case, condition, results, shafts)),
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


def _largest_torque(results: Results) -> tuple[float | None, str | None]:
    """Largest torque of any element, referred to the reference shaft, and where. [N m]"""
    assert results.start is not None
    rows = {str(e.element): e for e in results.case.elements}
    ratio = {str(s.station): s.speed_ratio or 1.0 for s in results.case.stations}
    found = [
        (max(abs(p.maximum), abs(p.minimum)) * _ratio(rows[p.element], ratio), p.element)
        for p in results.start.peaks
    ]
    return max(found, default=(None, None))


def _ratio(element: ElementRow, ratio: dict[str, float]) -> float:
    """Speed ratio of the shaft that an element's torque is stated at: that of its From side."""
    end = element.from_ if element.from_ != GROUND else element.to
    return ratio.get(str(end), 1.0)


def _shafts(case: CaseData, results: Results) -> tuple[ConditionShaft, ...]:
    """Every judged shaft; where counting is forced off, with its stress alone and not judged."""
    counted = {} if results.starts is None else {s.element: s for s in results.starts.shafts}
    errors = dict(results.starts_error)
    whole = is_counted(results.start)
    assert results.start is not None
    span = {p.element: p.peak_to_peak for p in results.start.peaks}
    found = []
    for _, e in judged_shafts(case):
        name = str(e.element)
        shaft: ShaftFatigue | None = counted.get(name)
        stress = float(shear_stress(span[name], e.stress_diameter or 0.0, e.stress_bore or 0.0))
        if shaft is None:
            found.append(ConditionShaft(name, stress, 0.0, 0.0, 0.0, None, False, False, False))
            continue
        error = errors.get(name) or 0.0
        found.append(
            ConditionShaft(
                element=name,
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
        )
    return tuple(found)


def _governing(shafts: Sequence[ConditionShaft]) -> ConditionShaft | None:
    return max(shafts, key=lambda s: (s.damage, s.peak_to_peak_stress), default=None)


def _notes(
    case: CaseData, condition: StartCondition, results: Results, shafts: Sequence[ConditionShaft]
) -> Iterator[str]:
    start = results.start
    assert start is not None
    outcome, name = start.outcome, start.outcome.outcome
    if not is_counted(start):
        yield f"Not a start: {outcome.sentence}"
        if any(s.damage > 0.0 for s in shafts):
            yield (
                f"Damage of one attempt is counted up to {outcome.time:.1f} s; how many are allowed "
                "is not judged, as it goes on after that."
            )
        elif shafts:
            yield "How many are allowed is not judged."
    elif name == Outcome.TRIPPED:
        yield f"{outcome.sentence} The coast-down is counted."
        if condition.row is not None:
            yield "One instant of the trip: another within the same period may do more or less."
    elif condition.trip_speed is not None:
        yield f"It does not come to its trip speed. {outcome.sentence}"
    elif name == Outcome.ASYNCHRONOUS:
        yield outcome.sentence
    if results.starts is None and shafts:
        yield "Starts are not judged: cycle counting is forced off in EffectChoices."
    if condition.damping_ratio is not None and case.mode_damping and not case.damping_ratio:
        yield "ModeDamping is kept: without DampingRatio in the case there is no proportion."
    elif condition.damping_ratio is not None and case.mode_damping:
        factor = condition.damping_ratio / (case.damping_ratio or 1.0)
        yield f"ModeDamping is scaled by {factor:.4g}, as DampingRatio is."
    yield from _limits_passed(shafts)
    if start.is_sensitive:
        yield "Sensitive to tiny changes of the input: one of many equally right answers."
    elif not start.met_tolerance:
        yield f"Wanted accuracy not met: estimated error of peaks {start.estimated_error:.2g}."


def _limits_passed(shafts: Sequence[ConditionShaft]) -> Iterator[str]:
    extended = [s.element for s in shafts if s.extended]
    if extended:
        yield f"Cycles above the first S-N point ({', '.join(extended)}): its slope is extended."
    yielding = [s.element for s in shafts if s.yields]
    if yielding:
        yield f"Nominal peak above shear yield ({', '.join(yielding)}): the count does not hold."


# --- all of them ----------------------------------------------------------------------------------


def gather_matrix(
    case: CaseData,
    studies: StudyInputs,
    plan: MatrixPlan,
    rows: Sequence[ConditionResult],
) -> StartMatrix:
    """One result from the units of work.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    studies : StudyInputs
        Its rows. [SI]
    plan : MatrixPlan
        What was to be calculated. [SI]
    rows : sequence of ConditionResult
        What was, in any order. [SI]

    Returns
    -------
    StartMatrix
        In the order of the plan; conditions that are missing say so. [SI]
    """
    of_name: dict[str, list[ConditionResult]] = {}
    for row in rows:
        of_name.setdefault(row.condition.name, []).append(row)
    ordered = tuple(_joined(c, of_name.get(c.name, [])) for c in plan.conditions)
    shafts = tuple(str(e.element) for _, e in judged_shafts(case))
    return StartMatrix(
        rows=ordered,
        judged_shafts=shafts,
        starts_factor=case.starts_factor or 1.0,
        standard=plan.standard,
        complete=len(rows) == len(plan.units),
        sentence=_sentence(ordered, shafts),
        notes=plan.notes,
        case_sha256=case_digest(case),
        study_sha256=study_digest(*studies.start_conditions),
    )


def _joined(condition: StartCondition, rows: Sequence[ConditionResult]) -> ConditionResult:
    """One row of a condition; of a trip that was tried at several instants the worst.

    Damage is that of the most damaging instant; extremes may be those of another.
    """
    if len(rows) < len(condition.instants):
        note = "Stopped before this start."
        return ConditionResult(condition, NOT_CALCULATED, NOT_CALCULATED, note=note)
    if len(rows) == 1:
        return rows[0]
    lost = next((r for r in rows if r.outcome == NOT_CALCULATED), None)
    if lost is not None:
        return replace(lost, condition=condition)
    ranked = sorted(rows, key=lambda r: (_harm(r), -(r.condition.trip_speed or 0.0)))
    worst, least = ranked[-1], ranked[0]
    shafts = tuple(_worst_shaft([r.shafts[k] for r in rows]) for k in range(len(worst.shafts)))
    said = f"Worst of {len(rows)} instants of one period from there."
    if worst.allowable_starts is not None:
        best = "unlimited" if least.unlimited else f"{math.floor(least.allowable_starts or 0.0):,}"
        said = f"{said[:-1]}; the least harmful allows {best} starts."
    before, after = (" ".join(_limits_passed(s)) for s in (worst.shafts, shafts))
    note = worst.note.replace(before, after) if before else f"{worst.note} {after}"
    governing = next((s for s in shafts if s.element == worst.governing), None)
    largest = max(rows, key=lambda r: r.peak_torque or 0.0)
    lowest = min(rows, key=lambda r: math.inf if r.mesh is None else r.mesh_minimum_torque or 0.0)
    return replace(
        worst,
        condition=condition,
        peak_torque=largest.peak_torque,
        peak_over_rated=largest.peak_over_rated,
        peak_element=largest.peak_element,
        peak_to_peak_stress=None if governing is None else governing.peak_to_peak_stress,
        mesh_minimum_torque=lowest.mesh_minimum_torque,
        mesh=lowest.mesh,
        impacts=max((r.impacts for r in rows if r.impacts is not None), default=None),
        shafts=shafts,
        note=f"{said} {note}".strip(),
    )


def _worst_shaft(instants: Sequence[ConditionShaft]) -> ConditionShaft:
    """One shaft after a trip: the most damaging instant, with the extremes of all."""
    worst = max(instants, key=lambda s: (not s.judged, s.damage, s.peak_to_peak_stress))
    return replace(
        worst,
        peak_to_peak_stress=max(s.peak_to_peak_stress for s in instants),
        extended=any(s.extended for s in instants),
        yields=any(s.yields for s in instants),
    )


def _harm(row: ConditionResult) -> tuple[bool, float, float, float]:
    """How bad a start is: not judged, then by damage, stress and torque."""
    damage = max((s.damage for s in row.shafts), default=0.0)
    open_ = bool(row.shafts) and not row.judged
    return open_, damage, row.peak_to_peak_stress or 0.0, row.peak_torque or 0.0


def _sentence(rows: Sequence[ConditionResult], shafts: Sequence[str]) -> str:
    """What the matrix shows, in words."""
    if not shafts:
        return (
            "No shaft has stress diameter, material and S-N points: torques and stresses are "
            "shown, starts are not counted."
        )
    judged = [r for r in rows if r.judged]
    unfinished = [r for r in rows if r.outcome not in (NOT_CALCULATED,) and not r.judged]
    said = []
    limited = [r for r in judged if r.allowable_starts is not None]
    if limited:
        worst = min(limited, key=lambda r: r.allowable_starts or math.inf)
        best = max(limited, key=lambda r: r.allowable_starts or 0.0)
        said.append(
            f"Fewest starts: {math.floor(worst.allowable_starts or 0.0):,} of '{worst.condition.name}' "
            f"({worst.governing})"
            + (
                f"; most, where they are limited: {math.floor(best.allowable_starts or 0.0):,} of "
                f"'{best.condition.name}'."
                if best is not worst
                else "."
            )
        )
    free = [r.condition.name for r in judged if r.unlimited]
    if free:
        said.append(f"Unlimited: {_names(free)}.")
    if unfinished:
        said.append(
            f"Not judged: {_names([f'{r.condition.name} ({r.words})' for r in unfinished])}."
        )
    return " ".join(said)


def _names(names: Sequence[str]) -> str:
    return "; ".join(names)


def start_matrix(
    case: CaseData,
    studies: StudyInputs,
    *,
    with_standard: bool = False,
    on_progress: Callable[[int, int, str], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> StartMatrix:
    """The matrix, one start after the other.

    Parameters
    ----------
    case : CaseData
        A checked case with a start. [SI]
    studies : StudyInputs
        Its checked rows. [SI]
    with_standard : bool, optional
        Add the standard matrix to the rows. [flag]
    on_progress : callable, optional
        Called with the number of starts done, of all, and the name of the next. [count, count, name]
    should_stop : callable, optional
        Asked before each start; what is missing then says so. [flag]

    Returns
    -------
    StartMatrix
        Every condition. [SI]
    """
    plan = plan_matrix(case, studies, with_standard=with_standard)
    rows: list[ConditionResult] = []
    for condition in plan.units:
        if should_stop is not None and should_stop():
            break
        if on_progress is not None:
            on_progress(len(rows), len(plan.units), condition.name)
        rows.append(calculate_condition(case, condition))
    return gather_matrix(case, studies, plan, rows)


# --- tables ---------------------------------------------------------------------------------------


def start_rows(matrix: StartMatrix) -> list[dict[str, object]]:
    """Rows of `StartMatrix`, one a kind of start.

    Parameters
    ----------
    matrix : StartMatrix
        The matrix. [SI]

    Returns
    -------
    list of dict
        Under their JSON keys; percentages as fractions. [SI]
    """
    return [
        {
            "condition": r.condition.name,
            "voltage": r.condition.voltage,
            "damping_ratio": r.condition.damping_ratio,
            "load": r.condition.load,
            "trip_speed": r.condition.trip_speed,
            "outcome": r.words,
            "time": r.time,
            "percent_speed": r.percent_speed,
            "peak_over_rated": r.peak_over_rated,
            "peak_element": r.peak_element,
            "governing": r.governing,
            "peak_to_peak_stress": r.peak_to_peak_stress,
            "mesh_minimum_torque": r.mesh_minimum_torque,
            "impacts": r.impacts,
            "damage": next((s.damage for s in r.shafts if s.element == r.governing), None),
            "allowable_starts": r.allowable_starts,
            "judged": r.judged,
            "note": r.note,
        }
        | ({"unlimited": r.unlimited} if r.judged else {})
        for r in matrix.rows
    ]


def voltage_rows(matrix: StartMatrix) -> list[dict[str, object]]:
    """Rows of `StartsByVoltage`: whole starts that differ in voltage and load alone.

    Parameters
    ----------
    matrix : StartMatrix
        The matrix. [SI]

    Returns
    -------
    list of dict
        One a voltage, rising; blank where there is no such start, or no number of them. [SI]
    """
    found: dict[float, dict[str, object]] = {}
    for r in matrix.rows:
        c = r.condition
        word = {1.0: "loaded", 0.0: "unloaded"}.get(c.load)
        alike = c.trip_speed is None and c.damping_ratio is None
        if word is None or not alike or r.outcome not in WHOLE_STARTS:
            continue
        row = found.setdefault(c.voltage, {"voltage": c.voltage})
        row.setdefault(f"{word}_stress", r.peak_to_peak_stress)
        row.setdefault(f"{word}_starts", r.allowable_starts)
    return [found[voltage] for voltage in sorted(found)]
