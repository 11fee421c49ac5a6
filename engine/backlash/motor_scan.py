"""The worst phase, angle and clearing time of an event of a motor: a scan, and a finer one around its worst.

Each combination is one event as it would be calculated alone, with longer steps and followed for a shorter time. Until it
clears it is the same for all clearing times, so that one run to the latest one branches off at each of them. Whatever
is found is calculated again as an event of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from engine.arrays import Floats
from engine.backlash.motor_events import MOTOR_FOLLOWED, motor_drive, motor_event, number
from engine.case.data import CaseData, MotorEventRow
from engine.case.defaults import DEFAULT_LATEST_CLEARING, DEFAULT_TOLERANCE_PEAK
from engine.model.excitation import transmitted_torque
from engine.model.modal_train import ModalTrain
from engine.start.machine_motion import MachineMotion, machine_motion, stretch_of
from engine.start.prescribed import first_step
from engine.start.time_response import ModalSystem, modal_system
from engine.stepping.linear_loop import turning_points

#: Phases of a whole turn. [count]
PHASES = 24
#: Clearing times in a period of the line, and how many there are at the least: the flux that a fault leaves in the
#: stator turns once in a period. [count]
TIMES_PER_PERIOD, FEWEST_TIMES = 8, 20
#: After clearing a combination of many is followed so long, the first swing of the rotor. [s]
FOLLOWED = 0.5
#: Wanted relative error of the peaks that are compared. [1]
TOLERANCE = 0.02
#: Steps are so much longer than those of an event; their error is of fourth order. [1]
LONGER = 2.0
#: Around a worst one the spacing is halved until what another one may have is less than this share of the tolerance of
#: peaks, at most so often. [1, count]
SHARE_OF_TOLERANCE, MOST_HALVINGS = 0.25, 4


#: Phase or angle, and clearing time; None: it is not looked for. [rad, s]
Place = tuple[float | None, float | None]


@dataclass(frozen=True)
class WorstInstant:
    """The combination with the largest torque of one element, or of the motor."""

    row: MotorEventRow  #: The event with numbers in the place of words. [rad, s]
    largest: float  #: That torque, as the scan has it. [N m]
    #: What that torque may be larger at another one: its change when the spacing was halved last, or the top of a
    #: parabola through three of them, relative. [1]
    error: float


@dataclass(frozen=True, eq=False)
class WorstInstants:
    """What a scan found."""

    of_element: dict[str, WorstInstant]  #: By element. [mixed]
    of_motor: WorstInstant  #: Of its air-gap torque. [mixed]
    #: Clearing times, and at each the largest torque of any phase: of the motor, and of the element with the largest
    #: of all. Empty where no clearing time is looked for. [s, N m]
    clearing: Floats
    air_gap: Floats  #: Likewise. [N m] Shape (n_times,).
    element: str  #: Which element.
    torque: Floats  #: Likewise. [N m] Shape (n_times,).


def worst_instants(case: CaseData, modal: ModalTrain, row: MotorEventRow) -> WorstInstants:
    """The worst combination for every element and for the motor.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        Its train. [SI]
    row : MotorEventRow
        An event with a word in the place of a number. [rad, s]

    Returns
    -------
    WorstInstants
        [mixed]
    """
    scan, tolerance = _Scan.of(case, modal, row), case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    turns, times = scan.turns, scan.times
    sizes = np.stack([scan.sizes(turn, times) for turn in turns])  # turn, time, element
    best = sizes.reshape(-1, sizes.shape[-1]).argmax(axis=0)
    finer = cache(scan.around)
    found = []
    for k, at in enumerate(best.tolist()):
        i, j = divmod(at, len(times))
        place, error = (turns[i], times[j]), math.inf
        for halvings in range(1, MOST_HALVINGS + 1):
            beside = {
                where: float(all_sizes[k]) for where, all_sizes in finer(place, halvings).items()
            }
            worst = max(beside, key=beside.__getitem__)
            error = _rise(beside, place) / (beside[worst] or 1.0)
            place = worst
            if error <= SHARE_OF_TOLERANCE * tolerance:
                break
        found.append(WorstInstant(scan.row_of(*place), beside[place], error))
    names = modal.train.elements
    largest_of = int(np.argmax(sizes[..., :-1].max(axis=(0, 1)))) if names else -1
    over_time = sizes.max(axis=0) if scan.spacing[1] else sizes[0, :0]
    return WorstInstants(
        dict(zip(names, found[:-1], strict=True)),
        found[-1],
        np.array(times if scan.spacing[1] else (), dtype=float),
        over_time[:, -1],
        names[largest_of] if names else "",
        over_time[:, largest_of],
    )


def any_instant(row: MotorEventRow) -> MotorEventRow:
    """An event with some number in the place of each word.

    Parameters
    ----------
    row : MotorEventRow
        The event. [rad, s]

    Returns
    -------
    MotorEventRow
        [rad, s]
    """
    latest = row.latest_clearing or DEFAULT_LATEST_CLEARING
    numbers = {"phase": 0.0, "angle": 0.0, "clears_after": latest}
    return replace(row, **{name: numbers[name] for name in row.scanned})  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class _Scan:
    """What the combinations of an event have in common."""

    case: CaseData
    modal: ModalTrain
    row: MotorEventRow
    turn: str  #: Which angle is scanned; empty: none.
    spacing: tuple[
        float, float
    ]  #: Of angles and of clearing times; 0: that is not scanned. [rad, s]
    system: ModalSystem
    step: float  #: [s]
    offset: Floats  #: Torques of the outputs in operation. [N m]

    @classmethod
    def of(cls, case: CaseData, modal: ModalTrain, row: MotorEventRow) -> _Scan:
        """The scan of one event."""
        train, modes, damping = modal
        turn = next((name for name in row.scanned if name != "clears_after"), "")
        latest = row.latest_clearing or DEFAULT_LATEST_CLEARING
        range_ = latest - (row.earliest_clearing or 0.0)
        periods = (case.ratings.line_frequency or 0.0) * range_
        count = max(math.ceil(TIMES_PER_PERIOD * periods - 1e-9), FEWEST_TIMES)
        spacing = (
            2.0 * math.pi / PHASES if turn else 0.0,
            range_ / count if "clears_after" in row.scanned else 0.0,
        )
        drive = motor_drive(modal, motor_event(case, train, any_instant(row)))
        step, keep, _ = first_step(train, modes, drive, TOLERANCE, latest + FOLLOWED)
        system = modal_system(train, modes, drive.stations, damping.structural, keep)
        offset = transmitted_torque(case, train).element[train.output_element]
        return cls(case, modal, row, turn, spacing, system, LONGER * step, offset)

    @property
    def turns(self) -> tuple[float | None, ...]:
        """Angles of the scan: phases from 0 on, angles of closing around 0. [rad]"""
        if not self.turn:
            return (None,)
        count = round(_period(self.row) / self.spacing[0])
        first = 1 - count // 2 if self.turn == "angle" else 0
        return tuple((k + first) * self.spacing[0] for k in range(count))

    @property
    def limits(self) -> tuple[float, float]:
        """Earliest and latest clearing time of the scan. [s]"""
        return (
            self.row.earliest_clearing or 0.0,
            self.row.latest_clearing or DEFAULT_LATEST_CLEARING,
        )

    @property
    def times(self) -> tuple[float | None, ...]:
        """Clearing times of the scan; nothing clears before it begins. [s]"""
        if not self.spacing[1]:
            return (number(self.row.clears_after),)
        earliest, latest = self.limits
        count = round((latest - earliest) / self.spacing[1])
        first = 0 if earliest else 1
        times = (earliest + k / count * (latest - earliest) for k in range(first, count + 1))
        return tuple(min(time, latest) for time in times)

    def row_of(self, turn: float | None, time: float | None) -> MotorEventRow:
        """One combination as an event of its own."""
        turned = {self.turn: turn} if self.turn else {}
        return replace(
            self.row, **turned, clears_after=time, earliest_clearing=None, latest_clearing=None  # type: ignore[arg-type]
        )  # fmt: skip

    def around(self, place: Place, halvings: int) -> dict[Place, Floats]:
        """Largest torques of a combination and of those beside it, at a spacing that was halved so often."""
        (turn, time), share = place, math.ldexp(1.0, -halvings)
        earliest, latest = self.limits
        times = [
            t
            for t in _beside(time, share * self.spacing[1])
            if t is None or earliest <= t <= latest
        ]
        return {
            (other, when): sizes
            for other in _beside(turn, share * self.spacing[0])
            for when, sizes in zip(times, self.sizes(other, times, share), strict=True)
        }

    def sizes(
        self, turn: float | None, times: Sequence[float | None], share: float = 0.5
    ) -> Floats:
        """Largest torque of each element and of the motor. [N m] Shape (n_times, n_elements + 1).

        Clearing times are multiples of that share of their spacing from the earliest on.
        """
        event = motor_event(self.case, self.modal.train, self.row_of(turn, times[-1]))
        system, machine, balance = self.system, event.machine, event.balance
        before, state = event.beginning(system)
        if not self.spacing[1]:
            end = min(event.last_change + MOTOR_FOLLOWED, self.case.maximum_time or math.inf)
            motion = machine_motion(
                system,
                machine,
                event.supplies,
                state,
                end,
                self.step,
                balance=balance,
                before=before,
            )
            return self._largest(motion, event.held, [math.inf])
        step = share * self.spacing[1]  # steps end at clearing times
        step /= math.ceil(step / self.step)
        changed, cleared = event.supplies
        stretch, now = stretch_of(system, machine, changed, state, (*before, state.flux), balance)
        earliest, sooner = self.limits[0], np.zeros(1)
        if earliest:
            motion = stretch.motion(now, earliest, self.step)
            sooner = self._largest(motion, event.held, [math.inf])
            now = motion.q[:, -1], motion.v[:, -1], motion.flux[:, -1]
            changed = replace(changed, begins=earliest)
            stretch, now = stretch_of(system, machine, changed, state, now, balance)
        motion = stretch.motion(now, max(float(times[-1] or 0.0), earliest + step), step)
        at = [round((float(t or 0.0) - earliest) / step) for t in times]
        until = self._largest(motion, event.held, [float(motion.time[i]) for i in at])
        until = np.maximum(until, sooner)
        follows, prepared, after = math.ceil(FOLLOWED / step) * step, None, []
        for i in at:
            begins = float(motion.time[i])
            reached = motion.q[:, i], motion.v[:, i], motion.flux[:, i]
            supply = replace(cleared, begins=begins)
            stretch, now = stretch_of(system, machine, supply, state, reached, balance)
            prepared = stretch.prepared(step) if prepared is None else prepared
            cleared_motion = stretch.motion(now, begins + follows, step, prepared)
            after.append(self._largest(cleared_motion, event.held, [math.inf])[0])
        return np.asarray(np.maximum(until, np.stack(after)))

    def _largest(self, motion: MachineMotion, held: float, until: Sequence[float]) -> Floats:
        """Largest torque of each element and of the motor until some times. [N m] Shape (n_until, n_elements + 1)."""
        train = self.modal.train
        response = motion.response(self.system, held)
        torque = [*(self.offset[:, None] + response.torque), motion.torque]
        rate = [*response.torque_rate, motion.torque_rate]
        largest = np.zeros((len(until), len(train.elements) + 1))
        for column, y, slope in zip([*response.output_element, -1], torque, rate, strict=True):
            when, value = turning_points(motion.time, y, slope)
            rising = np.maximum.accumulate(np.abs([y[0], *value]))
            size = rising[np.searchsorted(when, until, "right")]
            if column >= 0 or y is motion.torque:  # a bearing is no element
                largest[:, column] = np.maximum(largest[:, column], size)
        return largest


def _rise(beside: Mapping[Place, float], middle: Place) -> float:
    """What a worst one may be above the largest of some: the change from the middle, or to the top of parabolas."""
    worst, own = max(beside.values()), beside[middle]
    top = own
    for axis in (0, 1):
        others = [v for place, v in beside.items() if place[1 - axis] == middle[1 - axis]]
        if len(others) == 3:
            before, _, after = others
            curved = 2.0 * own - before - after
            top += (after - before) ** 2 / (8.0 * curved) if curved > 0.0 else 0.0
    return max(worst - own, top - worst)


def _period(row: MotorEventRow) -> float:
    """Angle after which everything repeats: a phase counts twice in what turns against the line. [rad]"""
    return 2.0 * math.pi if "angle" in row.scanned else math.pi


def _beside(value: float | None, spacing: float) -> tuple[float | None, ...]:
    """A value of a scan with those a spacing before and after it."""
    if value is None or not spacing:
        return (value,)
    return value - spacing, value, value + spacing
