"""Where the falling 2 × slip line crosses each mode during the start, and what happens there.

One row a mode below twice line frequency, with the reasons the paper names: sweep rate, average
against pulsating torque, acceleration ("Philosophy of resonant response location").
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.defaults import NOTABLE_REVERSAL
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.modal_train import ModalTrain
from engine.model.train import Train
from engine.operation.margins import percent_speed
from engine.start.start import Start

Floats = NDArray[np.float64]

#: A mode within this share of twice line frequency is excited by the initial shock (the paper).
INITIAL_SHOCK_ZONE = 0.10
#: Response to a sweep begins to build at this multiple of the natural frequency.
WINDOW_BEGINS = 1.1
#: Lewis' undamped sweep: amplification = 3.68 √(f²/ḟ) (case A06, closed form). [1]
LEWIS_FACTOR = 3.67773


@dataclass(frozen=True)
class Crossing:
    """One mode crossed by the 2 × slip pulsation, or just above where it begins."""

    mode: int  #: Elastic mode, counted from 1.
    frequency: float  #: Natural frequency. [Hz]
    #: Speed of the crossing, 100 (1 − f / 2 f_line); None for a mode just above 2 × line, listed
    #: because the initial shock excites it. [%]
    percent_speed: float | None
    time: float | None  #: When the mean speed passes there; None if the start ends before. [s]
    #: At that speed, referred to the motor; None, like the next two, if it is not reached. [N m]
    average_torque: float | None
    pulsating_torque: float | None  #: Likewise. [N m]
    load_torque: float | None  #: Likewise. [N m]
    acceleration: float | None  #: Of the reference shaft as a rigid train. [rad/s²]
    sweep_rate: float | None  #: Rate at which the pulsation frequency falls. [Hz/s]
    governing_element: str | None  #: Element most stressed while the mode is excited.
    peak_to_peak_torque: float | None  #: Its torque range in that window. [N m]
    #: Its nominal stress range, where it has a stress diameter. [Pa]
    peak_to_peak_stress: float | None
    mesh_minimum_torque: float | None  #: Lowest mesh torque in that window. [N m]
    note: str  #: The reasons, in words.


def start_crossings(
    modal: ModalTrain,
    start: Start,
    line_frequency: float,
    synchronous_speed: float,
    stress_per_torque: Sequence[float | None],
    meshes: Sequence[int],
) -> tuple[Crossing, ...]:
    """All crossings of a start.

    Parameters
    ----------
    modal : ModalTrain
        Its train, modes and damping. [SI]
    start : Start
        The start. [SI]
    line_frequency : float
        Line frequency. [Hz]
    synchronous_speed : float
        Synchronous speed of the reference shaft. [rad/s]
    stress_per_torque : sequence of float or None, shape (n_elements,)
        Nominal shear stress per torque; None without a stress diameter. [Pa/(N m)]
    meshes : sequence of int
        Elements whose torque may not reverse: gear meshes. [indices]

    Returns
    -------
    tuple of Crossing
        In rising frequency. [count]
    """
    train, modes, damping = modal
    runup = start.runup
    if runup is None:
        return ()
    highest = 2.0 * line_frequency * (1.0 + INITIAL_SHOCK_ZONE)
    below = [
        r
        for r in range(modes.n_rigid, modes.n_modes)
        if modes.frequency[r] <= highest and modes.twists[r]
    ]
    frequencies = [float(modes.frequency[r]) for r in below]
    crossings = []
    for i, r in enumerate(below):
        f = frequencies[i]
        percent = percent_speed(f, line_frequency)
        speed = synchronous_speed * max(1.0 - f / (2.0 * line_frequency), 0.0)
        acceleration = runup.acceleration_at(speed)
        crossing = _Point(
            frequency=f,
            time=None if percent is None else _passing(start, speed),
            average=float(np.interp(speed, runup.speed, runup.average)),
            pulsating=float(np.interp(speed, runup.speed, runup.pulsating)),
            load=float(np.interp(speed, runup.speed, runup.load)),
            sweep_rate=2.0 * line_frequency * acceleration / synchronous_speed,
        )
        window = _window(start, frequencies, i, line_frequency, synchronous_speed)
        governing, span, stress, lowest = _response(train, start, window, stress_per_torque, meshes)
        reverses = None if lowest is None else lowest < -NOTABLE_REVERSAL * _largest(start)
        note = _note(crossing, float(damping.ratio[r]), line_frequency, reverses)
        passed = crossing.time is not None
        crossings.append(
            Crossing(
                mode=r - modes.n_rigid + 1,
                frequency=f,
                percent_speed=percent,
                time=crossing.time,
                average_torque=crossing.average if passed else None,
                pulsating_torque=crossing.pulsating if passed else None,
                load_torque=crossing.load if passed else None,
                acceleration=acceleration if passed else None,
                sweep_rate=crossing.sweep_rate if passed else None,
                governing_element=governing,
                peak_to_peak_torque=span,
                peak_to_peak_stress=stress,
                mesh_minimum_torque=lowest,
                note=note,
            )
        )
    return tuple(crossings)


@dataclass(frozen=True)
class _Point:
    """State of the rigid train where a mode is crossed."""

    frequency: float
    time: float | None
    average: float
    pulsating: float
    load: float
    sweep_rate: float


def _passing(start: Start, speed: float) -> float | None:
    """First time the mean speed reaches a value."""
    w = start.trajectory.mean_speed
    above = np.flatnonzero(w >= speed)
    if not len(above):
        return None
    i = int(above[0])
    t = start.trajectory.time
    if i == 0:
        return float(t[0])
    return float(t[i - 1] + (speed - w[i - 1]) / (w[i] - w[i - 1]) * (t[i] - t[i - 1]))


def _window(
    start: Start, frequencies: list[float], i: int, line_frequency: float, synchronous_speed: float
) -> tuple[float, float] | None:
    """Time in which mode i responds: from just above it to half-way to the next mode below."""
    f, twice = frequencies[i], 2.0 * line_frequency
    higher = frequencies[i + 1] if i + 1 < len(frequencies) else math.inf
    begin = (
        min(WINDOW_BEGINS * f, math.sqrt(f * higher))
        if math.isfinite(higher)
        else WINDOW_BEGINS * f
    )
    end = math.sqrt(f * frequencies[i - 1]) if i > 0 else 0.0
    t0 = 0.0 if begin >= twice else _passing(start, synchronous_speed * (1.0 - begin / twice))
    if t0 is None:
        return None
    t1 = _passing(start, synchronous_speed * (1.0 - end / twice))
    return t0, start.outcome.time if t1 is None else t1


def _response(
    train: Train,
    start: Start,
    window: tuple[float, float] | None,
    stress_per_torque: Sequence[float | None],
    meshes: Sequence[int],
) -> tuple[str | None, float | None, float | None, float | None]:
    """Governing element with its torque and stress range, and the lowest mesh torque."""
    if window is None:
        return None, None, None, None
    spans: dict[int, float] = {}
    lowest: float | None = None
    for element, (when, value) in start.turning_of_element().items():
        inside = value[(when >= window[0]) & (when <= window[1])]
        if not len(inside):
            continue
        spans[element] = float(np.ptp(inside))
        if element in meshes:
            lowest = float(inside.min()) if lowest is None else min(lowest, float(inside.min()))
    if not spans:
        return None, None, None, None
    judged = {e: s * k for e, s in spans.items() if (k := stress_per_torque[e]) is not None}
    if judged:
        worst = max(judged, key=lambda e: judged[e])
        return train.elements[worst], spans[worst], judged[worst], lowest
    worst = max(spans, key=lambda e: spans[e] * _power_ratio(train, e))
    return train.elements[worst], spans[worst], None, lowest


def _power_ratio(train: Train, element: int) -> float:
    """Speed of an element over the reference, so that torques on all shafts compare as power."""
    rows = np.flatnonzero(train.row_element == element)
    if not len(rows):
        return next(m.from_ratio for m in train.rigid_meshes if m.element == element)
    node = (
        int(np.flatnonzero(train.node_incidence[rows[0]] > 0.0)[0])
        if np.any(train.node_incidence[rows[0]] > 0.0)
        else int(np.flatnonzero(train.node_incidence[rows[0]])[0])
    )
    return float(train.speed_ratio[node])


def _largest(start: Start) -> float:
    """Largest torque of the whole start."""
    return max((p.size for p in start.peaks), default=0.0)


def _note(p: _Point, ratio: float, line_frequency: float, reverses: bool | None) -> str:
    """The paper's reasons in words."""
    notes = []
    if p.frequency >= 2.0 * line_frequency * (1.0 - INITIAL_SHOCK_ZONE):
        notes.append(
            f"Within 10 % of 2 × line ({2 * line_frequency:.0f} Hz): the initial shock and the first "
            "revolutions excite this mode; move it."
        )
    if p.frequency > 2.0 * line_frequency:
        return " ".join([*notes, "The pulsation itself stays below it."])
    if p.time is None:
        return " ".join([*notes, "Not reached: the start ends before this speed."])
    steady = 1.0 / (2.0 * ratio) if ratio > 0.0 else math.inf
    swept = LEWIS_FACTOR * p.frequency / math.sqrt(p.sweep_rate) if p.sweep_rate > 0.0 else math.inf
    if swept < 0.8 * steady:
        notes.append(
            f"Sweep of {p.sweep_rate:.1f} Hz/s limits the build-up to about {swept:.0f} × static "
            f"(steady resonance {steady:.0f} ×): acceleration helps here."
        )
    elif math.isfinite(steady):
        notes.append(
            f"Sweep of {p.sweep_rate:.1f} Hz/s is slow (undamped limit {swept:.0f} ×): damping sets the "
            f"build-up, near {steady:.0f} × static."
        )
    else:
        notes.append("No damping and no sweep: the build-up is not limited.")
    notes.append(
        f"Pulsating torque is {p.pulsating / p.average:.0%} of the average there."
        if p.average > 0.0
        else "The average torque is not positive there."
    )
    if reverses is not None:
        notes.append("Mesh torque reverses." if reverses else "Mesh torque stays positive.")
    return " ".join(notes)


def crossings_of(case: CaseData, model: ModalTrain, start: Start) -> tuple[Crossing, ...]:
    """Crossings of a start by the falling 2 × slip frequency.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    model : ModalTrain
        Modes that are reported. [SI]
    start : Start
        The start. [SI]

    Returns
    -------
    tuple of Crossing
        Empty where the speed of the motor or of its field is not known. [SI]
    """
    ratings = case.ratings
    if start.runup is None or not ratings.line_frequency or not ratings.synchronous_speed:
        return ()
    stress = [stress_of_unit_torque(e) if e.stress_diameter else None for e in case.elements]
    meshes = [i for i, e in enumerate(case.elements) if e.kind == ElementKind.GEAR_MESH]
    return start_crossings(
        model,
        start,
        ratings.line_frequency,
        ratings.synchronous_speed,
        stress,
        meshes,
    )
