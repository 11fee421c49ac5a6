"""Which starts a matrix calculates: the conditions that are typed, or the standard matrix.

The standard matrix, for a blank `StartConditions`: the voltages that a stiff and a weak supply give
(`STANDARD_VOLTAGES`), each with the load curve and without, as loads are often started by-passed or
empty; the damping is that of the case, as only the engineer knows it hot and cold; and at full
voltage, loaded, starts aborted where the paper's sweep leaves the most behind (just past each
crossing) and at fixed speeds (`STANDARD_TRIPS`). What a trip does depends on its instant: the average
torque that held the shafts twisted is gone at once, and the ringing it leaves adds to that of the mode
or takes from it. So each standard trip is tried at `TRIP_INSTANTS` instants of one period, and the
worst stands in the row. A trip speed that is typed is one instant, and its note says so. Rows are taken unchanged: nothing
is added to a duty unless it is asked for.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Stress criterion".
Lewis, Vibration during acceleration through a critical speed (1932): the largest response comes
after the crossing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from engine.case.data import CaseData
from engine.model.load import loads_of
from engine.model.modal_analysis import analyse
from engine.model.motor import motors_of
from engine.model.rigid_runup import rigid_runup
from engine.operation.margins import percent_speed
from engine.start.settings import settings_of
from engine.studies.starts.conditions import StartCondition, condition_case, typed_conditions

#: Over the voltage of the torque curves: from the dip of a weak supply under the starting current to
#: a supply 10 % too high. [1]
STANDARD_VOLTAGES = (0.80, 0.85, 0.90, 0.95, 1.00, 1.05, 1.10)
#: Speeds of aborted starts over synchronous: early, late, and just before the end. [1]
STANDARD_TRIPS = (0.50, 0.75, 0.95)
#: A fixed trip speed this near to one behind a crossing is that one. [1 of synchronous speed]
SAME_TRIP = 0.02
#: An undamped mode, swept through at constant rate ḟ, responds most 0.86/√ḟ after the crossing: the
#: largest distance on Cornu's spiral is at 1.217, and u = √(2 ḟ) t. [1]
LATEST_RESPONSE = 0.8606


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
        return tuple(instant for c in self.conditions for instant in c.instants)


# --- the plan -------------------------------------------------------------------------------------


def plan_matrix(case: CaseData, *, with_standard: bool = False) -> MatrixPlan:
    """Which starts are calculated.

    Parameters
    ----------
    case : CaseData
        A checked case with a start; without conditions of kind start, the standard matrix. [SI]
    with_standard : bool, optional
        Add the standard matrix to the rows. [flag]

    Returns
    -------
    MatrixPlan
        The conditions. [SI]
    """
    conditions = [c for c in typed_conditions(case) if not c.steady]
    is_typed = bool(conditions)
    conditions += _counted_events(case, conditions)
    if is_typed and not with_standard:
        return MatrixPlan(tuple(conditions), standard=False)
    taken = {c.name for c in conditions}
    standard, notes = _standard(case)
    for c in standard:
        name = c.name if c.name not in taken else f"{c.name} (standard)"
        conditions.append(replace(c, name=name))
    return MatrixPlan(tuple(conditions), standard=True, notes=notes)


def _counted_events(case: CaseData, rows: Sequence[StartCondition]) -> list[StartCondition]:
    """Events with a number in a life that no row has."""
    taken, events = {c.name for c in rows}, {c.event for c in rows}
    return [
        StartCondition(
            name if name not in taken else f"{name} (event)",
            event=name,
            per_life=times,
            why="Per life",
        )
        for name, times in case.events_per_life.items()
        if name not in events
    ]


def _standard(case: CaseData) -> tuple[list[StartCondition], tuple[str, ...]]:
    """Voltages, loaded and unloaded, then aborted starts."""
    loads = (1.0, 0.0) if case.load_torque else (1.0,)
    words = {1.0: ", loaded", 0.0: ", unloaded"} if case.load_torque else {1.0: ""}
    conditions = [
        StartCondition(
            f"{100.0 * v:.0f} % voltage{words[load]}", v, load=load, why="supply and load"
        )
        for load in loads
        for v in STANDARD_VOLTAGES
    ]
    notes = []
    if not case.load_torque:
        notes.append(
            "The case has no LoadTorque: loaded and unloaded starts are identical and calculated "
            "once."
        )
    trips, left_out = _trips(case)
    synchronous = case.ratings.synchronous_speed or 1.0
    conditions += [
        StartCondition(
            f"aborted at {100.0 * speed / synchronous:.1f} % speed",
            trip_speed=speed,
            trip_span=span,
            why=why,
        )
        for speed, span, why in trips
    ]
    return conditions, (*notes, *left_out)


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
                f"{highest / synchronous:.1%} speed, below the trip speed needed for it, "
                f"{speed / synchronous:.1%}."
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
