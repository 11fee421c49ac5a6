"""The worst phase, angle and clearing time of an event of a motor, and the worst phase of the pulsation of the start in
which it begins: a scan, and a finer one around its worst.

What is looked for is the largest torque of each element and of the motor, and the largest damage of each judged shaft, each by
itself. In operation a combination is one event as it would be calculated alone, with longer steps and followed for a
shorter time. Until it clears it is the same for all clearing times, so that one run to the latest one branches off at
each of them. In a start, and where teeth separate, each combination is simulated by itself. Whatever is found is calculated again as an
event of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import product as every_pair
from typing import Any, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from engine.arrays import Floats
from engine.backlash.motor_events import MOTOR_FOLLOWED, motor_drive, motor_event, number
from engine.case.data import CaseData, MotorEventRow
from engine.case.defaults import DEFAULT_LATEST_CLEARING, DEFAULT_TOLERANCE_PEAK
from engine.model.excitation import transmitted_torque
from engine.model.modal_train import ModalTrain
from engine.model.train import Train
from engine.start.machine_motion import MachineMotion, Stretch, machine_motion, stretch_of
from engine.start.prescribed import first_step
from engine.start.start_fatigue import judged_shafts, largest_damage, sn_slope
from engine.start.time_response import ModalSystem, modal_system
from engine.start.worst_phase import PHASES as PULSATIONS
from engine.stepping.linear_loop import samples_to_end

#: Phases of a whole turn. [count]
PHASES = 24
#: The same of an event in a start, where each combination is a whole start (5 ms with three discs). [count]
PHASES_IN_START = 12
#: Clearing times in a period of the line, and how many there are at the least: the flux that a fault leaves in the
#: stator turns once in a period. [count]
TIMES_PER_PERIOD, FEWEST_TIMES = 8, 20
#: After clearing a combination of many is followed so long, the first swing of the rotor. [s]
FOLLOWED = 0.5
#: Wanted relative error of the peaks that are compared. [1]
TOLERANCE = 0.02
#: Steps are so much longer than those of an event; their error is of fourth order. [1]
LONGER = 2.0
#: Where teeth separate each combination is a simulation by itself (30 ms of the example motor): at most so many. [count]
MOST_APART = 240
#: Around a worst one the spacing is halved until what another one may have is less than this share of the tolerance of
#: peaks, at most so often. [1, count]
SHARE_OF_TOLERANCE, MOST_HALVINGS = 0.25, 4


#: So many local maxima of the grid are looked around, before the largest is followed. [count]
MOST_TOPS = 4


#: Phase of the pulsation of the start, and phase or angle of the event; None: it is not looked for. [rad]
Angles = tuple[float | None, float | None]
#: These, and the clearing time. [rad, s]
Place = tuple[float | None, float | None, float | None]
#: What combinations answer: angles, clearing times, and the share of their spacing of which the times are
#: multiples. One row a clearing time, as `answers_of` has it.
Answers = Callable[[Angles, Sequence[float | None], float], Floats]


class Instant(NamedTuple):
    """One combination."""

    row: MotorEventRow  #: The event with numbers in the place of words. [rad, s]
    #: Phase of the pulsation of the start in which it begins; None: it is not looked for. [rad]
    pulsation: float | None = None


@dataclass(frozen=True)
class WorstInstant:
    """The combination with the largest torque of one element or of the motor, or the largest damage of a shaft."""

    instant: Instant  #: Which one. [rad, s]
    largest: float  #: That torque or damage, as the scan has it. [N m, 1]
    #: What it may be larger at another one: its change when the spacing was halved last, or the top of a
    #: parabola through three of them, relative; None: not known, as teeth separate. [1]
    error: float | None

    @property
    def row(self) -> MotorEventRow:
        """The event with numbers in the place of words. [rad, s]"""
        return self.instant.row


@dataclass(frozen=True, eq=False)
class WorstInstants:
    """What a scan found."""

    of_element: dict[str, WorstInstant]  #: Of the torque, by element. [mixed]
    of_damage: dict[
        str, WorstInstant
    ]  #: Of each judged shaft that has damage at some instant. [mixed]
    of_motor: WorstInstant  #: Of its air-gap torque. [mixed]
    #: Clearing times, and at each the largest torque of any phase: of the motor, and of the element with the largest
    #: of all. Empty where no clearing time is looked for. [s, N m]
    clearing: Floats
    air_gap: Floats  #: Likewise. [N m] Shape (n_times,).
    element: str  #: Which element.
    torque: Floats  #: Likewise. [N m] Shape (n_times,).
    turn: str  #: What was looked for beside the clearing time: ``phase``, ``angle``, or nothing.

    @property
    def instants(self) -> Iterable[Instant]:
        """Every combination that is the worst of something, once."""
        instants = (*self.of_element.values(), *self.of_damage.values(), self.of_motor)
        return dict.fromkeys(i.instant for i in instants)


def worst_instants(case: CaseData, modal: ModalTrain, row: MotorEventRow) -> WorstInstants:
    """The worst combinations of an event in operation, all teeth in contact.

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
    grid = _Grid.of(case, row)
    return _searched(case, modal.train, grid, _Together.of(case, modal, grid).answers)


def worst_instants_of(
    case: CaseData,
    train: Train,
    row: MotorEventRow,
    answers: Callable[[Instant], Floats],
    *,
    apart: bool,
) -> WorstInstants:
    """The worst combinations of an event, each simulated by itself.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    row : MotorEventRow
        An event with a word in the place of a number. [rad, s]
    answers : callable
        What one combination answers, as `answers_of` has it. [N m, 1]
    apart : bool
        Teeth separate. Torques then jump with the instant: some are simulated, and none is looked for between. [flag]

    Returns
    -------
    WorstInstants
        [mixed]
    """
    grid = _Grid.of(case, row)

    def each(angles: Angles, times: Sequence[float | None], share: float) -> Floats:
        return np.stack([answers(grid.instant(*angles, time)) for time in times])

    return _searched(case, train, grid, each, apart=apart)


def answers_of(
    case: CaseData, train: Train, histories: Iterable[tuple[int, Floats]], air_gap: float
) -> Floats:
    """What one combination answers: largest torque of each element and of the motor, damage of each judged shaft.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    histories : iterable of (int, ndarray)
        Element of each output, below 0 of a bearing, and its torques at turning points. [index, N m]
    air_gap : float
        Largest torque of the motor. [N m]

    Returns
    -------
    ndarray, shape (n_elements + 1 + n_shafts,)
        [N m, 1]
    """
    sections: dict[int, list[Floats]] = {}
    for element, torque in histories:
        sections.setdefault(element, []).append(torque)
    n = len(train.elements)
    largest = [
        max((float(np.max(np.abs(h))) for h in sections.get(k, ())), default=0.0) for k in range(n)
    ]
    damage = [largest_damage(case, element, sections[k]) for k, element in judged_shafts(case)]
    return np.array([*largest, air_gap, *damage])


def _searched(
    case: CaseData, train: Train, grid: _Grid, answers: Answers, *, apart: bool = False
) -> WorstInstants:
    """The worst of a grid, then of combinations ever nearer to it unless teeth separate."""
    pulsations, turns, times = grid.pulsations, grid.turns, grid.times
    angles = len(pulsations) * len(turns)
    if apart:
        fewer = np.linspace(0, len(times) - 1, min(len(times), max(MOST_APART // angles, 1)))
        times = tuple(times[int(i)] for i in fewer)
    # pulsation, turn, time, answer
    sizes = np.stack(
        [np.stack([answers((first, turn), times, 0.5) for turn in turns]) for first in pulsations]
    )
    n, tolerance = len(train.elements), case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    finer = cache(lambda place, halvings: grid.around(place, halvings, answers))
    found = []
    for k in range(sizes.shape[-1]):
        tops = _tops(sizes[..., k])
        around = [(pulsations[h], turns[i], times[j]) for h, i, j in tops]
        place, largest, error = around[0], float(sizes[(*tops[0], k)]), None
        enough = SHARE_OF_TOLERANCE * tolerance * (1.0 if k <= n else sn_slope(case))
        for halvings in range(1, 1 if apart or not largest else MOST_HALVINGS + 1):
            found_near = {
                middle: {where: float(every[k]) for where, every in finer(middle, halvings).items()}
                for middle in around
            }
            middle = max(around, key=lambda m: max(found_near[m].values()))
            beside = found_near[middle]
            place = max(beside, key=beside.__getitem__)
            largest = beside[place]
            error, around = _rise(beside, middle) / (largest or 1.0), [place]
            if error <= enough:
                break
        found.append(WorstInstant(grid.instant(*place), largest, error))
    names, looked_for = train.elements, bool(grid.spacing[2])
    largest_of = int(np.argmax(sizes[..., :n].max(axis=(0, 1, 2)))) if names else -1
    over_time = sizes.max(axis=(0, 1)) if looked_for else sizes[0, 0, :0]
    damaged = zip(judged_shafts(case), found[n + 1 :], strict=True)
    return WorstInstants(
        dict(zip(names, found[:n], strict=True)),
        {str(element.element): instant for (_, element), instant in damaged if instant.largest},
        found[n],
        np.array(times if looked_for else (), dtype=float),
        over_time[:, n],
        names[largest_of] if names else "",
        over_time[:, largest_of],
        grid.turn,
    )


def begins_at_worst_phase(case: CaseData, row: MotorEventRow) -> bool:
    """Whether an event begins in a start whose worst phase of the pulsation is looked for.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    row : MotorEventRow
        The event. [rad, s]
    """
    return row.in_start is not None and case.looks_for_worst_phase


def any_instant(case: CaseData, row: MotorEventRow) -> Instant:
    """An event with some number in the place of each word.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    row : MotorEventRow
        The event. [rad, s]

    Returns
    -------
    Instant
        [rad, s]
    """
    latest = row.latest_clearing or DEFAULT_LATEST_CLEARING
    numbers = {"phase": 0.0, "angle": 0.0, "clears_after": latest}
    of_row = replace(row, **{name: numbers[name] for name in row.scanned})  # type: ignore[arg-type]
    return Instant(of_row, 0.0 if begins_at_worst_phase(case, row) else None)


@dataclass(frozen=True)
class _Grid:
    """Combinations of the phase of the pulsation, of phase or angle of the event, and of clearing time."""

    row: MotorEventRow
    turn: str  #: Which angle of the event is scanned, ``phase`` or ``angle``; empty: none.
    #: Of phases of the pulsation, of angles and of clearing times; 0: that is not scanned. [rad, rad, s]
    spacing: tuple[float, float, float]
    #: Turns of the phase of the pulsation after which a start is the same. [count]
    turns_of_phase: int = 1

    @classmethod
    def of(cls, case: CaseData, row: MotorEventRow) -> _Grid:
        """The grid of one event."""
        turn = next((name for name in row.scanned if name != "clears_after"), "")
        range_ = (row.latest_clearing or DEFAULT_LATEST_CLEARING) - (row.earliest_clearing or 0.0)
        periods = (case.ratings.line_frequency or 0.0) * range_
        count = max(math.ceil(TIMES_PER_PERIOD * periods - 1e-9), FEWEST_TIMES)
        phases = PHASES if row.in_start is None else PHASES_IN_START
        pulsations = PHASES_IN_START if row.scanned else PULSATIONS
        spacing = (
            2.0 * math.pi / pulsations if begins_at_worst_phase(case, row) else 0.0,
            2.0 * math.pi / phases if turn else 0.0,
            range_ / count if "clears_after" in row.scanned else 0.0,
        )
        return cls(row, turn, spacing, case.turns_of_phase)

    @property
    def pulsations(self) -> tuple[float | None, ...]:
        """Phases of the pulsation of the scan, from 0 on. [rad]"""
        if not self.spacing[0]:
            return (None,)
        count = self.turns_of_phase * round(2.0 * math.pi / self.spacing[0])
        return tuple(k * self.spacing[0] for k in range(count))

    @property
    def turns(self) -> tuple[float | None, ...]:
        """Angles of the scan: phases from 0 on, angles of closing around 0. [rad]"""
        if not self.turn:
            return (None,)
        count = round(_period(self.row) / self.spacing[1])
        first = 1 - count // 2 if self.turn == "angle" else 0
        return tuple((k + first) * self.spacing[1] for k in range(count))

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
        if not self.spacing[2]:
            return (number(self.row.clears_after),)
        earliest, latest = self.limits
        count = round((latest - earliest) / self.spacing[2])
        first = 0 if earliest else 1
        times = (earliest + k / count * (latest - earliest) for k in range(first, count + 1))
        return tuple(min(time, latest) for time in times)

    def instant(self, pulsation: float | None, turn: float | None, time: float | None) -> Instant:
        """One combination as an event of its own."""
        turned = {self.turn: turn} if self.turn else {}
        row = replace(
            self.row, **turned, clears_after=time, earliest_clearing=None, latest_clearing=None  # type: ignore[arg-type]
        )  # fmt: skip
        return Instant(row, pulsation)

    def around(self, place: Place, halvings: int, answers: Answers) -> dict[Place, Floats]:
        """What a combination and those beside it answer, at a spacing that was halved so often."""
        *angles, time = place
        share = math.ldexp(1.0, -halvings)
        earliest, latest = self.limits
        times = [
            t
            for t in _beside(time, share * self.spacing[2])
            if t is None or (earliest <= t <= latest and t > 0.0)
        ]
        beside = (_beside(angle, share * self.spacing[i]) for i, angle in enumerate(angles))
        return {
            (first, other, when): sizes
            for first, other in every_pair(*beside)
            for when, sizes in zip(times, answers((first, other), times, share), strict=True)
        }


@dataclass(frozen=True, eq=False)
class _Together:
    """An event in operation with all teeth in contact: what its combinations have in common."""

    case: CaseData
    modal: ModalTrain
    grid: _Grid
    system: ModalSystem
    step: float  #: [s]
    offset: Floats  #: Torques of the outputs in operation. [N m]
    #: Of each supply in turn and each step: what the loop takes, but for what differs between instants. [struct]
    prepared: dict[tuple[int, float], Any] = field(default_factory=dict)

    @classmethod
    def of(cls, case: CaseData, modal: ModalTrain, grid: _Grid) -> _Together:
        """The event of a grid."""
        train, modes, damping = modal
        drive = motor_drive(modal, motor_event(case, train, any_instant(case, grid.row).row))
        step, keep, _ = first_step(train, modes, drive, TOLERANCE, grid.limits[1] + FOLLOWED)
        system = modal_system(train, modes, drive.stations, damping.structural, keep)
        offset = transmitted_torque(case, train).element[train.output_element]
        return cls(case, modal, grid, system, LONGER * step, offset)

    def answers(self, angles: Angles, times: Sequence[float | None], share: float) -> Floats:
        """What the combinations with one angle answer. [N m, 1] Shape (n_times, n_answers)."""
        grid = self.grid
        event = motor_event(self.case, self.modal.train, grid.instant(*angles, times[-1]).row)
        system, machine, balance = self.system, event.machine, event.balance
        before, state = event.beginning(system)
        if not grid.spacing[2]:
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
            return self._answers(self._turning(motion, event.held))[None]
        step = share * grid.spacing[2]  # steps end at clearing times
        step /= math.ceil(step / self.step)
        changed, cleared = event.supplies
        stretch, now = stretch_of(system, machine, changed, state, (*before, state.flux), balance)
        earliest, sooner = grid.limits[0], []
        if earliest:
            motion = stretch.motion(now, earliest, self.step)  # its steps are those of no other
            sooner = [self._turning(motion, event.held)]
            now = motion.q[:, -1], motion.v[:, -1], motion.flux[:, -1]
            changed = replace(changed, begins=earliest)
            stretch, now = stretch_of(system, machine, changed, state, now, balance)
        latest = max(float(times[-1] or 0.0), earliest + step)
        motion = stretch.motion(now, latest, step, self._prepared(0, stretch, step))
        until = self._turning(motion, event.held)
        follows, found = math.ceil(FOLLOWED / step) * step, []
        for time in times:
            i = round((float(time or 0.0) - earliest) / step)
            begins = float(motion.time[i])
            reached = motion.q[:, i], motion.v[:, i], motion.flux[:, i]
            supply = replace(cleared, begins=begins)
            stretch, now = stretch_of(system, machine, supply, state, reached, balance)
            after = stretch.motion(now, begins + follows, step, self._prepared(1, stretch, step))
            so_far = [
                (when, value[: np.searchsorted(when, begins, "right")]) for when, value in until
            ]
            found.append(self._answers(*sooner, so_far, self._turning(after, event.held)))
        return np.stack(found)

    def _turning(self, motion: MachineMotion, held: float) -> list[tuple[Floats, Floats]]:
        """Times and values where each output and the torque of the motor turn, their beginning included. [s, N m]"""
        response = motion.response(self.system, held)
        torque = np.concatenate([self.offset[:, None] + response.torque, motion.torque[None]])
        rate = np.concatenate([response.torque_rate, motion.torque_rate[None]])
        turning = samples_to_end(motion.time, torque, rate, float(motion.time[-1]))
        return [(when[:-1], value[:-1]) for when, value in turning]

    def _prepared(self, supply: int, stretch: Stretch, step: float) -> Any:
        key = supply, step
        if key not in self.prepared:
            self.prepared[key] = stretch.prepared(step)
        return self.prepared[key]

    def _answers(self, *parts: Sequence[tuple[Floats, Floats]]) -> Floats:
        """What a combination answers whose parts follow each other."""
        values = [
            np.concatenate([value for _, value in output]) for output in zip(*parts, strict=True)
        ]
        histories = zip(self.modal.train.output_element.tolist(), values[:-1], strict=True)
        return answers_of(self.case, self.modal.train, histories, float(np.max(np.abs(values[-1]))))


def _tops(sizes: Floats) -> list[tuple[int, ...]]:
    """The largest value of a grid, then the next local maxima; between its points another one may be the largest."""
    around = sliding_window_view(np.pad(sizes, 1, constant_values=-math.inf), (3,) * sizes.ndim)
    beside = around.max(axis=tuple(range(-sizes.ndim, 0)))
    tops = sorted(np.argwhere(sizes == beside).tolist(), key=lambda at: -sizes[tuple(at)])
    return [tuple(at) for at in tops[:MOST_TOPS]]


def _rise(beside: Mapping[Place, float], middle: Place) -> float:
    """What a worst one may be above the largest of some: the change from the middle, or to the top of parabolas."""
    worst, own = max(beside.values()), beside[middle]
    top = own
    for axis in range(len(middle)):
        others = [
            v
            for place, v in beside.items()
            if all(place[k] == middle[k] for k in range(len(middle)) if k != axis)
        ]
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
