"""Torque reversals: meshes and geared couplings whose torque falls below zero during a start.

A *reversal* is one passage of the torque below zero that is more than rounding: it counts once the
torque lies below minus the hysteresis h = `NOTABLE_REVERSAL` × the largest torque of that element,
it began where the torque last crossed zero, and it ends where the torque next rises above zero (by
more than the rounding that torque in a gap may have).
Torque that trembles about zero within h, or against the back flank without pushing on the drive
flank in between, is therefore not counted twice. Crossings of zero are roots of the cubic between
samples, found between turning points, where the torque is monotonic.

Positive torque: the drive end pushes. Torques are actual, at the element's own speed; those of a
mesh are on its From side. "The paper" is Szenasi and von Nimitz (1978), section "Torque reversals".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow
from engine.case.defaults import NOTABLE_REVERSAL
from engine.case.result_words import Judgement
from engine.model.excitation import transmitted_torque
from engine.model.train import Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import interp
from engine.start.event_results import ContactRecord
from engine.start.lowest_torque import doubts_of_minima, sign_in_words
from engine.start.start import Start
from engine.start.trajectory import Turning

#: Torque nearer to zero than this share of the largest of its element is rounding: teeth apart, or a train at rest.
ROUNDING = 1e-9

#: Halvings of a step about a zero crossing: down to rounding, were none of them Newton's.
BISECTIONS = 60

#: A crossing is found when it moves by no more than this share of its step. [1]
ROOT_ROUNDING = 1e-12


@dataclass(frozen=True)
class Reversal:
    """Lowest torque of one mesh or coupling during a start, and its passages below zero."""

    # The order of the keys in the JSON of the results.
    element: str  #: Gear mesh, geared coupling, or other element that states a reversal limit.
    kind: str  #: Its kind.
    minimum_torque: float  #: Lowest torque. [N m]
    minimum_time: float  #: When. [s]
    largest_torque: float  #: Largest magnitude of its torque. [N m]
    hysteresis: float  #: Depth below zero from which a passage counts. [N m]
    reversals: int  #: How many.
    #: Without clearance model: total time below zero of the counted reversals. With it: total time
    #: without tooth contact. [s]
    time_unloaded: float
    impacts: int | None  #: Recontacts; None without clearance model.
    #: Largest approach speed of the flanks; None for a coupling and without that model. [m/s]
    recontact_speed: float | None
    #: Largest normal tooth force; None for a coupling and without that model. [N]
    tooth_force: float | None
    longest_reversal: float  #: Duration of the longest. [s]
    first_time: float | None  #: When the first one began; None if there is none. [s]
    #: Twice the slip times line frequency at the lowest torque; None where line or speed is unknown. [Hz]
    slip_frequency: float | None
    transmitted_torque: float  #: Torque it transmits in continuous operation. [N m]
    margin: float | None  #: Minimum over transmitted torque; None where that is zero. [1]
    limit: float | None  #: The maker's `Reversal limit`, a magnitude; None = not stated. [N m]
    verdict: Judgement  #: ``pass``, ``fail`` or ``not judged``.
    #: The approach speed as relative angular speed on the From side. [rad/s]
    recontact_speed_angular: float | None
    recontact_error: float | None  #: Relative error of both. [1]
    model: str  #: ``clearance`` where the teeth may separate, else ``linear``.
    sentence: str  #: The result in words, with its numbers.

    @property
    def reverses(self) -> bool:
        """Whether the torque falls below zero by more than the hysteresis. [flag]"""
        return self.minimum_torque < -self.hysteresis


def reversing_elements(case: CaseData) -> tuple[int, ...]:
    """Indices of the elements whose torque should not reverse.

    Gear meshes, geared couplings (those with a row in Meshes), and every element that states a reversal
    limit.
    """
    toothed = {m.element for m in case.meshes}
    return tuple(
        i
        for i, e in enumerate(case.elements)
        if e.kind == ElementKind.GEAR_MESH or e.element in toothed or e.reversal_limit is not None
    )


def torque_reversals(
    case: CaseData, train: Train, start: Start, contacts: Sequence[ContactRecord] = ()
) -> tuple[Reversal, ...]:
    """Reversals of every mesh, geared coupling and element with a reversal limit, in the order of Elements.

    `contacts` holds what happened at the clearances of that start.
    """
    wanted = reversing_elements(case)
    turning = start.turning_of_element()
    transmitted = transmitted_torque(case, train).element if wanted else np.zeros(0)
    touched, doubts = {c.element: c for c in contacts}, doubts_of_minima(start)
    return tuple(
        _reversal(
            case, start, i, turning[i], float(transmitted[i]), doubts.get(name), touched.get(name)
        )
        for i, name in ((i, train.elements[i]) for i in wanted)
        if i in turning
    )


def _reversal(
    case: CaseData,
    start: Start,
    index: int,
    turning: tuple[Floats, Floats],
    transmitted: float,
    doubt: float | None,
    contact: ContactRecord | None,
) -> Reversal:
    """One element."""
    element = case.elements[index]
    when, torque = turning
    lowest = int(np.argmin(torque))
    minimum, time = float(torque[lowest]), float(when[lowest])
    largest = float(np.max(np.abs(torque)))
    if abs(minimum) <= ROUNDING * largest:
        minimum = 0.0
    hysteresis = NOTABLE_REVERSAL * largest
    began, ended = passages_below(start, index, turning)
    lasted = ended - began
    slip = _slip_frequency(case, start, time)
    verdict, sentence = _verdict(element, minimum, doubt, hysteresis, contact)
    if len(began):
        sentence += f" ({_numbers(len(began), float(began[0]), float(lasted.max()), slip)})"
    if verdict == Judgement.NOT_JUDGED:
        sentence += "; Reversal limit is blank"
    return Reversal(
        element=str(element.element),
        kind=str(element.kind),
        minimum_torque=minimum,
        minimum_time=time,
        slip_frequency=slip,
        largest_torque=largest,
        hysteresis=hysteresis,
        reversals=len(began),
        first_time=float(began[0]) if len(began) else None,
        longest_reversal=float(np.max(lasted, initial=0.0)),
        time_unloaded=float(lasted.sum()) if contact is None else contact.time_unloaded,
        transmitted_torque=transmitted,
        margin=minimum / transmitted if transmitted else None,
        limit=element.reversal_limit,
        verdict=verdict,
        model="linear" if contact is None else "clearance",
        impacts=None if contact is None else contact.impacts,
        recontact_speed=None if contact is None else contact.recontact_speed,
        recontact_speed_angular=None if contact is None else contact.recontact_speed_angular,
        recontact_error=None if contact is None else contact.recontact_error,
        tooth_force=None if contact is None else contact.tooth_force,
        sentence=sentence,
    )


def _verdict(
    element: ElementRow,
    minimum: float,
    doubt: float | None,
    hysteresis: float,
    contact: ContactRecord | None,
) -> tuple[Judgement, str]:
    """The maker's limit judges; without one a reversal is reported, not judged."""
    reverses = minimum < -hysteresis
    parts = contact is not None and contact.impacts > 0
    sentence = f"{element.element}: torque {sign_in_words(minimum, doubt, hysteresis)}"
    if contact is not None and parts:
        reached = "reverses" if reverses else "falls to zero"
        sentence = f"{element.element}: torque {reached}, teeth re-engage {contact.impacts} times"
    if element.reversal_limit is not None:
        return (Judgement.PASS if minimum >= -element.reversal_limit else Judgement.FAIL), sentence
    if reverses or parts:
        return Judgement.NOT_JUDGED, sentence
    return Judgement.PASS, sentence


def _numbers(count: int, first: float, longest: float, slip: float | None) -> str:
    """Count, time and slip frequency in words."""
    sentence = f"{count} reversal{'s' if count > 1 else ''} from {first:.3f} s on, "
    sentence += f"the longest {1e3 * longest:.3g} ms"
    return (
        sentence
        if slip is None
        else f"{sentence}, deepest at a 2 × slip frequency of {slip:.3g} Hz"
    )


def _slip_frequency(case: CaseData, start: Start, time: float) -> float | None:
    """2 (1 − speed share) × line frequency at one time."""
    ratings = case.ratings
    if start.runup is None or not ratings.line_frequency or not ratings.synchronous_speed:
        return None
    speed = float(interp(time, start.trajectory.time, start.trajectory.mean_speed))
    # above synchronism, in the swing after pull-in, the frequency is that of the slip's magnitude
    return 2.0 * abs(1.0 - speed / ratings.synchronous_speed) * ratings.line_frequency


def passages_below(start: Start, index: int, turning: Turning) -> tuple[Floats, Floats]:
    """Times where the counted reversals of any element begin and end.

    One still open at the end of the run ends there. Between turning points the torque is monotonic, so each sign
    change there is one root.

    Parameters
    ----------
    start : Start
        The start. [SI]
    index : int
        The element. [index]
    turning : tuple of ndarray
        Its turning points. [s, N m]

    Returns
    -------
    tuple of ndarray
        Beginnings and ends. [s]
    """
    when, torque = turning
    largest = float(np.max(np.abs(torque)))
    output = int(start.output_of_element[index])
    down, up = _spans(torque, NOTABLE_REVERSAL * largest, ROUNDING * largest)
    t, y = start.trajectory.time, start.trajectory.torque[output]
    slope = start.trajectory.torque_rate[output]
    if start.trajectory.thinned:
        # all turning points are there, most samples are not: instants are on the smooth step
        # between two turning points, which changes durations by some per cent
        t, y, slope = when, torque, np.zeros(len(when))
    closed = up < len(torque)
    began, ends = np.split(
        _roots(t, y, slope, when, torque, np.concatenate([down, up[closed]])), [len(down)]
    )
    ended = np.full(len(up), when[-1])
    ended[closed] = ends
    return began, ended


def passages_beyond(torque: Floats, level: float) -> int:
    """How often a torque goes beyond a level, either way, counted as reversals are beyond zero.

    The level-crossing count of ASTM E1049, 5.1, with the hysteresis of this module: a torque that trembles about
    the level is not counted twice.

    Parameters
    ----------
    torque : ndarray
        Turning points of an element's torque. [N m]
    level : float
        The level, positive. [N m]

    Returns
    -------
    int
        Passages above the level and below minus the level. [count]
    """
    largest = float(np.max(np.abs(torque), initial=0.0))
    limits = NOTABLE_REVERSAL * largest, ROUNDING * largest
    return sum(len(_spans(level - side * torque, *limits)[0]) for side in (1.0, -1.0))


def _spans(torque: Floats, hysteresis: float, rounding: float) -> tuple[Ints, Ints]:
    """First turning point below zero of each reversal, and the first above zero after it.

    The latter is the number of turning points where a reversal is still open.
    """
    positive = np.flatnonzero(torque > rounding)
    deep = np.flatnonzero(torque < -hysteresis)
    negative = np.flatnonzero(torque < 0.0)
    # deep points with the same number of positive ones before them belong to one passage
    passage = distinct(np.searchsorted(positive, deep))
    previous = np.concatenate([[-1], positive])[passage]
    down = negative[np.searchsorted(negative, previous)]
    return down, np.append(positive, len(torque))[passage]


def _roots(
    t: Floats,
    y: Floats,
    slope: Floats,
    when: Floats,
    torque: Floats,
    after: Ints,
) -> Floats:
    """Where the cubic between samples crosses zero between turning points `after` − 1 and `after`."""
    low, high = when[np.maximum(after - 1, 0)], when[after]
    falls = torque[after] < 0.0
    # samples between the two are monotonic too: the first beyond zero ends the step with the crossing
    first, last = np.searchsorted(t, low, side="right"), np.searchsorted(t, high)
    while np.any(first < last):
        middle = (first + last) // 2
        passed = np.where(falls, y[middle] < 0.0, y[middle] > 0.0)
        first = np.where(passed, first, np.minimum(middle + 1, last))
        last = np.where(passed, middle, last)
    i = np.clip(last - 1, 0, len(t) - 2)
    h = t[i + 1] - t[i]
    rise, at_start, at_end = y[i + 1] - y[i], h * slope[i], h * slope[i + 1]
    cubic = y[i], at_start, 3.0 * rise - 2.0 * at_start - at_end, at_start + at_end - 2.0 * rise
    scale = np.where(h > 0.0, h, 1.0)
    low, high = (np.clip((end - t[i]) / scale, 0.0, 1.0) for end in (low, high))
    return np.asarray(t[i] + h * _root(cubic, np.where(falls, -1.0, 1.0), low, high))


def _root(cubic: tuple[Floats, ...], sign: Floats, low: Floats, high: Floats) -> Floats:
    """Root of each cubic, which times `sign` rises from `low` to `high`: Newton's, kept between the two by halving."""
    p, q, r, u = (sign * one for one in cubic)
    root = 0.5 * (low + high)
    for _ in range(BISECTIONS):
        value, slope = p + root * (q + root * (r + root * u)), q + root * (2.0 * r + 3.0 * root * u)
        low, high = np.where(value < 0.0, root, low), np.where(value < 0.0, high, root)
        new = root - value / np.where(slope > 0.0, slope, 1.0)
        new = np.where((slope > 0.0) & (new >= low) & (new <= high), new, 0.5 * (low + high))
        moves = np.abs(new - root) > ROOT_ROUNDING
        root = new
        if not moves.any():
            break
    return np.asarray(root)
