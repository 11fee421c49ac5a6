"""Where the falling 2 × slip line crosses each mode during the start, and what happens there.

A one-way discharge path adds torque at the slip frequency itself, which crosses each mode below line frequency once more.
One row a crossing, with the reasons the paper names: sweep rate, average
against pulsating torque, acceleration ("Philosophy of resonant response location").
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.defaults import NOTABLE_REVERSAL
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor, motors_of
from engine.numerics.same_bits import interp, square
from engine.operation.margins import percent_speed
from engine.operation.steady_state import modal_element_torque
from engine.start.amplification import modal_amplitude, modal_torque
from engine.start.lowest_torque import doubts_of_minima, sign_in_words
from engine.start.start import Start
from engine.start.trajectory import Turning

#: A mode within this share of twice line frequency is excited by the initial shock (the paper).
INITIAL_SHOCK_ZONE = 0.10
#: Response to a sweep begins to build at this multiple of the natural frequency.
WINDOW_BEGINS = 1.1
#: A reduction by less than this share is none. [1]
NOTABLE_REDUCTION = 0.02
#: Lewis' undamped sweep: amplification = 3.68 √(f²/ḟ) (case A06, closed form). [1]
LEWIS_FACTOR = 3.67773


@dataclass(frozen=True)
class Crossing:
    """One mode crossed by a pulsation, or just above where that begins."""

    mode: int  #: Elastic mode, counted from 1.
    frequency: float  #: Natural frequency. [Hz]
    #: Speed of the crossing, 100 (1 − f / k f_line) with k × slip; None for a mode just above k × line, listed
    #: because the initial shock excites it. [%]
    percent_speed: float | None
    time: float | None  #: When the mean speed passes there; None if the start ends before. [s]
    #: At that speed, referred to the motor; None, like the next two, if it is not reached. [N m]
    average_torque: float | None = None
    pulsating_torque: float | None = None  #: Likewise. [N m]
    load_torque: float | None = None  #: Likewise. [N m]
    acceleration: float | None = None  #: Of the reference shaft as a rigid train. [rad/s²]
    sweep_rate: float | None = None  #: Rate at which the pulsation frequency falls. [Hz/s]
    governing_element: str | None = None  #: Element most stressed while the mode is excited.
    peak_to_peak_torque: float | None = None  #: Its torque range in that window. [N m]
    #: Its nominal stress range, where it has a stress diameter. [Pa]
    peak_to_peak_stress: float | None = None
    mesh_minimum_torque: float | None = None  #: Lowest mesh torque in that window. [N m]
    #: Largest amplitude of the mode in that window over the static one of the pulsating torque then;
    #: with clearances the same of the governing element's torque. None where it cannot be seen. [1]
    amplification: float | None = None
    #: Of slip frequency that crosses it: 2, or 1 of one-way discharge paths. [1]
    multiple_of_slip: int = 2
    note: str = ""  #: The reasons, in words.


def crossings_of(
    case: CaseData, modal: ModalTrain, start: Start, model: ModalTrain | None = None
) -> tuple[Crossing, ...]:
    """Crossings of a start by the falling 2 × slip frequency, and by 1 × slip where a motor pulsates so.

    They stand in falling speed.

    Empty where the speed of the motor or of its field is not known.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        The train whose modes are reported. [SI]
    start : Start
        The start. [SI]
    model : ModalTrain, optional
        The train the start was calculated with, where it is another one. [SI]

    Returns
    -------
    tuple of Crossing
        One a mode below twice line frequency, and one below line frequency for 1 × slip. [SI]
    """
    modes, damping = modal.modes, modal.damping
    runup, line_frequency = start.runup, case.ratings.line_frequency
    synchronous_speed = case.ratings.synchronous_speed
    if runup is None or not line_frequency or not synchronous_speed:
        return ()
    highest = 2.0 * line_frequency * (1.0 + INITIAL_SHOCK_ZONE)
    multiples = (2, 1) if np.any(runup.pulsating1) else (2,)
    # 1 × slip crosses a mode where 2 × slip would cross one of twice its frequency
    below = sorted(
        (2.0 / k * float(modes.frequency[r]), r, k)
        for r in range(modes.n_rigid, modes.n_modes)
        for k in multiples
        if modes.twists[r]
    )
    below = [place for place in below if place[0] <= highest]
    frequencies = [twice_slip for twice_slip, _, _ in below]
    # elastic torques are all of a mode only where nothing else holds energy
    is_modal = not start.contacts and not modal.train.bodies and (model is None or model is modal)
    # torques of the elements a unit of each mode, where elements stand for it
    torques = None if is_modal else modal_element_torque(modal.train, modes)
    motors = motors_of(case, modal.train)
    crossings, turning, doubts = [], start.turning_of_element(), doubts_of_minima(start)
    # largest speed so far: rises, where the speed itself may fall
    reached = np.maximum.accumulate(start.trajectory.mean_speed)
    for i, (twice_slip, r, k) in enumerate(below):
        percent = percent_speed(twice_slip, line_frequency)
        speed = synchronous_speed * max(1.0 - twice_slip / (2.0 * line_frequency), 0.0)
        time = None if percent is None else _passing(start, reached, speed)
        window = _window(start, reached, frequencies, i, line_frequency, synchronous_speed)
        crossing = Crossing(
            mode=r - modes.n_rigid + 1,
            frequency=float(modes.frequency[r]),
            multiple_of_slip=k,
            percent_speed=percent,
            time=time,
            **_response(case, turning, window),
        )
        if time is not None:
            acceleration = runup.acceleration_at(speed)
            crossing = replace(
                crossing,
                average_torque=float(interp(speed, runup.speed, runup.average)),
                pulsating_torque=float(
                    interp(speed, runup.speed, runup.pulsating if k == 2 else runup.pulsating1)
                ),
                load_torque=float(interp(speed, runup.speed, runup.load)),
                acceleration=acceleration,
                sweep_rate=k * line_frequency * acceleration / synchronous_speed,
            )
            grown = _amplification(case, modal, start, motors, (crossing, r), window, torques)
            crossing = replace(crossing, amplification=grown)
        mesh = _mesh_torque(case, turning, doubts, window)
        note = _note(crossing, float(damping.ratio[r]), line_frequency, mesh, is_modal)
        crossings.append(replace(crossing, note=note))
    return tuple(crossings)


def _amplification(
    case: CaseData,
    modal: ModalTrain,
    start: Start,
    motors: Sequence[Motor],
    of: tuple[Crossing, int],
    window: tuple[float, float] | None,
    torques: Floats | None,
) -> float | None:
    """Amplification of a crossing, a mode with its index; see `Crossing.amplification`."""
    crossing, mode = of
    if window is None or crossing.time is None or not motors:
        return None
    history, multiple = start.trajectory, crossing.multiple_of_slip

    def speed_at(time: float) -> float:
        return float(interp(time, history.time, history.mean_speed))

    if torques is None:
        now = speed_at(crossing.time)
        driving = max(motors, key=lambda m: modal_torque((m,), modal, mode, now, multiple))
        found = modal_amplitude(start, driving, modal, mode, window, multiple)
        if found is None:
            return None
        static = modal_torque(motors, modal, mode, speed_at(found[1]), multiple)
        return found[0] / static if static > 0.0 else None
    static = modal_torque(motors, modal, mode, speed_at(crossing.time), multiple)
    index = next(
        (i for i, e in enumerate(case.elements) if e.element == crossing.governing_element), None
    )
    if index is None or crossing.peak_to_peak_torque is None or static == 0.0:
        return None
    reference = static * float(torques[index, mode]) / square(float(modal.modes.omega[mode]))
    return 0.5 * crossing.peak_to_peak_torque / reference if reference > 0.0 else None


def _passing(start: Start, reached: Floats, speed: float) -> float | None:
    """First time the mean speed reaches a value."""
    t, w, i = (
        start.trajectory.time,
        start.trajectory.mean_speed,
        int(np.searchsorted(reached, speed)),
    )
    if i == len(t):
        return None
    if i == 0:
        return float(t[0])
    return float(t[i - 1] + (speed - w[i - 1]) / (w[i] - w[i - 1]) * (t[i] - t[i - 1]))


def _window(
    start: Start,
    reached: Floats,
    frequencies: list[float],
    i: int,
    line_frequency: float,
    synchronous_speed: float,
) -> tuple[float, float] | None:
    """Time in which crossing i responds: from just above it to half-way to the next one below, by 2 × slip frequency."""
    f, twice = frequencies[i], 2.0 * line_frequency
    higher = frequencies[i + 1] if i + 1 < len(frequencies) else math.inf
    begin = min(WINDOW_BEGINS * f, math.sqrt(f * higher))
    end = math.sqrt(f * frequencies[i - 1]) if i > 0 else 0.0
    t0 = 0.0
    if begin < twice:
        first = _passing(start, reached, synchronous_speed * (1.0 - begin / twice))
        if first is None:
            return None
        t0 = first
    t1 = _passing(start, reached, synchronous_speed * (1.0 - end / twice))
    return t0, start.outcome.time if t1 is None else t1


def _inside(turning: Turning, window: tuple[float, float]) -> Floats:
    """Turning points of a torque within a time, both ends included. [N m]"""
    when, torque = turning
    first, last = np.searchsorted(when, window[0]), np.searchsorted(when, window[1], side="right")
    return torque[first:last]


def _mesh_torque(
    case: CaseData,
    turning: Mapping[int, Turning],
    doubts: Mapping[str, float | None],
    window: tuple[float, float] | None,
) -> str:
    """What the torque of the mesh that comes nearest to reversal does while the mode responds."""
    if window is None:
        return ""
    found = []
    for index, points in turning.items():
        if case.elements[index].kind != ElementKind.GEAR_MESH:
            continue
        name, torque, inside = str(case.elements[index].element), points[1], _inside(points, window)
        if not len(inside):
            continue
        lowest, doubt = float(inside.min()), doubts.get(name)
        hysteresis = NOTABLE_REVERSAL * float(np.max(np.abs(torque)))
        nearness = (lowest - (doubt or 0.0)) / hysteresis if hysteresis else 0.0
        found.append((nearness, sign_in_words(lowest, doubt, hysteresis)))
    return min(found)[1] if found else ""


def _response(
    case: CaseData, turning: Mapping[int, Turning], window: tuple[float, float] | None
) -> dict[str, Any]:
    """Governing element with its torque and stress range, and the lowest mesh torque."""
    if window is None:
        return {}
    spans: dict[int, float] = {}
    stresses: dict[int, float] = {}
    lowest: list[float] = []
    for index, points in turning.items():
        inside = _inside(points, window)
        if not len(inside):
            continue
        element = case.elements[index]
        spans[index] = float(np.ptp(inside))
        if element.stress_diameter:
            stresses[index] = spans[index] * stress_of_unit_torque(element)
        if element.kind == ElementKind.GEAR_MESH:
            lowest.append(float(inside.min()))
    if not spans:
        return {}
    ratios = case.element_speed_ratios  # so that torques on all shafts compare as power
    sizes = stresses or {i: span * ratios[case.elements[i].element] for i, span in spans.items()}
    worst = max(sizes, key=sizes.__getitem__)
    return {
        "governing_element": case.elements[worst].element,
        "peak_to_peak_torque": spans[worst],
        "peak_to_peak_stress": stresses.get(worst),
        "mesh_minimum_torque": min(lowest, default=None),
    }


def _note(p: Crossing, ratio: float, line_frequency: float, mesh: str, is_modal: bool) -> str:
    """What happened at the crossing, and the paper's reasons in words."""
    notes = []
    if p.multiple_of_slip == 1:
        notes.append("Crossed by 1 × slip frequency.")
    begins = p.multiple_of_slip * line_frequency
    if p.frequency >= begins * (1.0 - INITIAL_SHOCK_ZONE):
        notes.append(
            f"Within 10 % of {p.multiple_of_slip} × line ({begins:.0f} Hz): breaker closing and the "
            "first revolutions excite this mode; shift the mode."
        )
    if p.frequency > begins:
        return " ".join([*notes, "The pulsation frequency stays below this mode."])
    if p.time is None:
        return " ".join([*notes, "Not reached: the start ends before this speed."])
    sweep, average = p.sweep_rate, p.average_torque
    assert sweep is not None
    assert average is not None
    notes.append(_built_up(p, ratio, sweep, is_modal))
    if average <= 0.0:
        notes.append("The average torque is not positive here.")
    if mesh:
        notes.append(f"Mesh torque here {mesh}.")
    return " ".join(notes)


def _built_up(p: Crossing, ratio: float, sweep: float, is_modal: bool) -> str:
    """Amplifications of dwelling and of a sweep without damping, and what limits that of this start."""
    dwelling = 1.0 / (2.0 * ratio) if ratio > 0.0 else math.inf
    undamped = LEWIS_FACTOR * p.frequency / math.sqrt(sweep) if sweep > 0.0 else math.inf
    values = ", ".join(
        f"{value:.3g} × {words}"
        for value, words in ((dwelling, "dwelling"), (undamped, "swept undamped"))
        if math.isfinite(value)
    )
    if p.amplification is None:
        what = "the amplification of this start cannot be seen"
    elif not is_modal:  # clearances or bearings couple the modes
        what = "here a ratio of peaks"
    else:
        what = _what_limits(p.amplification, dwelling)
    sentence = f"{values}: {what}." if values else f"{what}."
    return sentence[0].upper() + sentence[1:]


def _what_limits(amplification: float, dwelling: float) -> str:
    """What keeps the amplification of a mode below that of dwelling at the resonance."""
    if not math.isfinite(dwelling):
        return "acceleration alone limits it"
    taken = 1.0 - amplification / dwelling
    if taken < -NOTABLE_REDUCTION:
        return "more than dwelling, the mode still rings from before"
    if taken < NOTABLE_REDUCTION:
        return "damping limits it, not acceleration"
    return f"acceleration takes off {taken:.0%}"
