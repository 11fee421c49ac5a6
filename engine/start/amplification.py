"""How far a mode was built up where 2 × slip (or 1 × slip) crossed it, against what the pulsation does statically.

The modal coordinate follows from the elastic torques: ω² q = Σ row twist × torque, because modes are
orthogonal in strain energy. Demodulated with the phase of the pulsation, θ' = 2 × slip or 1 × slip, it leaves the
amplitude that the pulsation drives; mean torque and other frequencies average out over a window of
whole cycles. Amplification = the largest amplitude over φ T, the modal torque of the pulsation at that
instant (both times 1/ω² as angles).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor
from engine.numerics.same_bits import cos, hypot, interp, product, sin
from engine.start.start import Start
from engine.start.trajectory import hermite_at

#: The amplitude is a mean over so many cycles of the pulsation, weighted by a raised cosine: as few as
#: leave neither mean torque nor twice the frequency. [count]
CYCLES = 2
#: Points of the demodulation in one cycle.
POINTS = 32
#: Fewer samples than these in a cycle do not show it.
LEAST_SAMPLES = 3.0
#: Below this share of the largest modal torque that the motors could have, they stand at a node.
AT_NODE = 1e-6


def modal_torque(
    motors: Sequence[Motor], modal: ModalTrain, mode: int, speed: float, multiple: int = 2
) -> float:
    """Modal torque of the pulsation at a speed of the reference shaft.

    Parameters
    ----------
    motors : sequence of Motor
        Motors, each with its phase. [SI]
    modal : ModalTrain
        The train and its modes. [SI]
    mode : int
        Mode, rigid ones counted. [index]
    speed : float
        Speed of the reference shaft. [rad/s]
    multiple : int, optional
        Of slip frequency: 2, or 1 of one-way discharge paths. [1]

    Returns
    -------
    float
        |Σ φ T e^{iα}|; 0 where the motors stand at a node of the mode. [N m/√(kg m²)]
    """
    train, shape = modal.train, modal.modes.shape
    along, across, largest = 0.0, 0.0, 0.0
    for m in motors:
        x = speed * train.speed_ratio[m.station] / m.synchronous_speed
        at = shape[train.node_dof[m.station]] * train.node_scale[m.station]
        for curve, phase in m.pulsations_at(multiple):
            torque = float(curve(x))
            along += float(at[mode]) * torque * cos(phase)
            across += float(at[mode]) * torque * sin(phase)
            largest += float(np.max(np.abs(at))) * abs(torque)
    size = float(hypot(along, across))
    return size if size > AT_NODE * largest else 0.0


def modal_amplitude(
    start: Start,
    motor: Motor,
    modal: ModalTrain,
    mode: int,
    window: tuple[float, float],
    multiple: int = 2,
) -> tuple[float, float] | None:
    """Largest demodulated amplitude of ω² q of a mode within a window, and when it occurs.

    Parameters
    ----------
    start : Start
        A start without clearances, calculated with `modal`. [SI]
    motor : Motor
        The motor that pulsates. [SI]
    modal : ModalTrain
        The train and its modes. [SI]
    mode : int
        Mode, rigid ones counted. [index]
    window : tuple of float
        When the mode responds. [s]
    multiple : int, optional
        Of slip frequency: 2, or 1 of one-way discharge paths. [1]

    Returns
    -------
    amplitude, time : tuple of float, or None
        None where the window has fewer than `CYCLES` cycles, or too few samples were kept.
        [N m/√(kg m²), s]
    """
    train, history = modal.train, start.trajectory
    inside = (history.time >= window[0]) & (history.time <= window[1])
    inside &= np.diff(history.time, prepend=-1.0) > 0.0  # of two at one time the first
    time = history.time[inside]
    if len(time) < LEAST_SAMPLES * CYCLES:
        return None
    rate = multiple * motor.pole_pairs * motor.synchronous_speed - (
        multiple
        * motor.pole_pairs
        * float(train.speed_ratio[motor.station])
        * history.mean_speed[inside]
    )
    phase = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    cycles = float(phase[-1]) / (2.0 * math.pi)
    if cycles < CYCLES or len(time) < LEAST_SAMPLES * cycles or np.any(rate <= 0.0):
        return None
    rows = train.element_rows
    elastic = train.stiffness[rows] > 0.0
    weight = (
        modal.modes.row_twist[rows, mode] * train.orientation[train.row_element[rows]] * elastic
    )
    coordinate = product(weight, history.torque[: len(rows), inside])
    rate = product(weight, history.torque_rate[: len(rows), inside])
    even = np.arange(0.0, phase[-1], 2.0 * math.pi / POINTS)
    when = interp(even, phase, time)
    n = CYCLES * POINTS + 1
    window_of_mean = 0.5 - 0.5 * cos(np.linspace(0.0, 2.0 * math.pi, n))
    window_of_mean *= 2.0 / window_of_mean.sum()
    seen = hermite_at(time, coordinate, rate, when)
    along, across = (
        product(sliding_window_view(seen * f(even), n), window_of_mean) for f in (cos, sin)
    )
    envelope = hypot(along, across)
    k = int(np.argmax(envelope))
    return float(envelope[k]), float(when[k + CYCLES * POINTS // 2])
