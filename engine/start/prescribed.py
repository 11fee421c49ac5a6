"""The train under prescribed torques alone: those of table `TorqueTime`, or of an event in operation.

The solution is exact at the samples (`engine.start.time_response`, `engine.start.decaying_harmonics`); the sample spacing only has to be
fine enough for the cubic between samples to catch the peaks, as the change on halving it shows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.case.choices import Method
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK
from engine.case.result_words import Outcome
from engine.errors import ModelError
from engine.model.modal_train import ModalTrain
from engine.model.modes import Modes
from engine.model.train import Train
from engine.numerics.same_bits import product
from engine.start.outcome import StartOutcome
from engine.start.peaks import judge_run
from engine.start.start import FALL, Start
from engine.start.time_response import (
    PrescribedTorque,
    TimeResponse,
    prescribed_torques,
    time_response,
)
from engine.start.torque_outputs import force_reach, torque_outputs
from engine.start.trajectory import SingleRun, Trajectory

#: Samples per period of the fastest mode that matters, tried first.
SAMPLES_PER_PERIOD = 16.0
#: A mode matters while its static share of the torque exceeds this share of the tolerance.
MATTERS = 0.1
#: Most samples of one run, and most values (samples × outputs).
MAX_SAMPLES, MAX_VALUES = 2_000_000, 10_000_000


@dataclass(frozen=True, eq=False)
class Drive:
    """Torques that a train is followed under, and what decides how finely."""

    stations: Ints  #: Where they act. [indices] Shape (n_stations,).
    #: How much each mode is driven; modes are compared by their shares. [any] Shape (n_modes,).
    size: Floats
    #: Bound on the modal torque that a mode too fast to be followed rings with. [rad √(kg m²)/s²] Shape
    #: (n_modes,).
    ringing: Floats
    fastest: float  #: Highest frequency of the torques themselves; 0 without one. [Hz]
    #: The response from an untwisted train: (last time [s], steps to there, modes integrated).
    respond: Callable[[float, int, Mask], TimeResponse]


def run_prescribed(case: CaseData, modal: ModalTrain) -> Start:
    """Response to the prescribed torques, from rest; its outcome is ``completed``.

    Raises `ModelError` if neither the table nor MaximumTime says how long to follow the train.
    """
    torques = prescribed_torques(case, modal.train)
    last = max(float(p.time or 0.0) for p in case.torque_time_from_rest)
    end = case.maximum_time or last
    if end <= 0.0:
        raise ModelError(
            "The prescribed torques end at time 0. Type MaximumTime to set the length of the run."
        )
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    return follow(
        modal, tabled_drive(modal, torques), end, tolerance, np.zeros(len(modal.train.elements))
    )


def tabled_drive(modal: ModalTrain, torques: list[PrescribedTorque]) -> Drive:
    """Torques that are linear between the rows of a table.

    A jump sets a fast mode ringing with its static deflection, a change of slope with that of slope/ω.
    """
    train, modes, damping = modal
    stations = np.array([p.station for p in torques], dtype=np.int64)
    omega = np.where(modes.omega > 0.0, modes.omega, np.inf)
    reach = np.abs(force_reach(train, modes, stations))
    jumps, ramps = np.array([p.jump for p in torques]), np.array([p.ramp for p in torques])

    def respond(end: float, count: int, kept: Mask) -> TimeResponse:
        times = np.linspace(0.0, end, count + 1)
        return time_response(
            train, modes, torques, times, damping_ratio=damping.structural, kept=kept
        )

    ringing = product(reach, jumps) + product(reach, ramps) / omega
    return Drive(stations, reach.sum(axis=1), ringing, 0.0, respond)


def follow(modal: ModalTrain, drive: Drive, end: float, tolerance: float, before: Floats) -> Start:
    """A train under prescribed torques, sampled as finely as the peaks between the samples need.

    The torques of the train before they begin stay: its equations are linear, so they add to the response.

    Parameters
    ----------
    modal : ModalTrain
        The train. [SI]
    drive : Drive
        The torques. [N m]
    end : float
        How long it is followed. [s]
    tolerance : float
        Wanted relative error of the peaks. [1]
    before : ndarray, shape (n_elements,)
        Torque of each element before they begin. [N m]

    Returns
    -------
    Start
        With the outcome ``completed``; speeds are what is added to those before. [SI]
    """
    train = modal.train
    step, keep, truncation = first_step(train, modal.modes, drive, tolerance, end)
    most = _most_samples(train)
    offset = before[train.output_element][:, None]

    def at(h: float) -> SingleRun:
        count = min(max(int(np.ceil(end / h)), 2), most)
        r = drive.respond(end, count, keep)
        mean = product(r.to_stations[:1], r.modal[1])[0] / train.speed_ratio[0]
        trajectory = Trajectory(
            r.time, mean, offset + r.torque, r.torque_rate, r.output_element, False, count
        )
        return SingleRun.until(trajectory, end)

    coarse, fine = at(step), at(0.5 * step)
    halvings, least_change = 0, None
    while True:
        judged = judge_run(train, truncation, fine, coarse, least_change=least_change)
        least_change = judged.change / FALL[Method.EXPONENTIAL]
        error, bound = judged.estimated_error, judged.truncation_error
        # the present spacing is step / 2, the next one would be step / 4
        if error <= tolerance or error - bound <= 0.1 * bound or 4.0 * end / step > most:
            break
        halvings, step = halvings + 1, 0.5 * step
        coarse, fine = fine, at(0.5 * step)
    speed = float(fine.trajectory.mean_speed[-1])
    return Start(
        **vars(judged),
        outcome=StartOutcome.with_numbers(Outcome.COMPLETED, end, speed),
        runup=None,
        step=0.5 * step,
        halvings=halvings,
        kept_modes=int(keep.sum()),
        method=Method.EXPONENTIAL,
        met_tolerance=error <= tolerance,
    )


def _most_samples(train: Train) -> int:
    """Most samples that memory allows."""
    return min(MAX_SAMPLES, MAX_VALUES // max(train.n_rows + len(train.rigid_meshes), 1))


def visible_modes(train: Train, modes: Modes, drive: Drive, tolerance: float) -> Mask:
    """Modes with a visible share of the static torque of some element.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]
    drive : Drive
        What drives them. [SI]
    tolerance : float
        Wanted relative error of the peaks. [1]

    Returns
    -------
    ndarray of bool, shape (n_modes,)
        Those that matter. [mask]
    """
    static = _flexibility(train, modes, drive.stations) * drive.size
    total = np.maximum(static.sum(axis=1, keepdims=True), 1e-300)
    return np.asarray(np.max(static / total, axis=0, initial=0.0) > MATTERS * tolerance)


def _flexibility(train: Train, modes: Modes, stations: Ints) -> Floats:
    """Static torque of each output for a unit modal torque, shape (n_outputs, n_modes)."""
    omega = np.where(modes.omega > 0.0, modes.omega, np.inf)
    return np.asarray(np.abs(torque_outputs(train, modes, stations).position) / omega**2)


def first_step(
    train: Train, modes: Modes, drive: Drive, tolerance: float, end: float
) -> tuple[float, Mask, Floats]:
    """Spacing that resolves the torques and every visible mode.

    Modes that no affordable spacing resolves (a link of 1e16 N m/rad) follow statically.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]
    drive : Drive
        What drives them. [SI]
    tolerance : float
        Wanted relative error of the peaks. [1]
    end : float
        How long it is followed. [s]

    Returns
    -------
    step : float
        [s]
    keep : ndarray of bool, shape (n_modes,)
        Modes that are integrated. [mask]
    bound : ndarray, shape (n_outputs,)
        On the ringing of the others. [N m]
    """
    keep = np.ones(modes.n_modes, dtype=np.bool_)
    visible = visible_modes(train, modes, drive, tolerance)
    affordable = modes.frequency * SAMPLES_PER_PERIOD * end <= 0.25 * _most_samples(train)
    keep[visible & ~affordable] = False
    flexible = _flexibility(train, modes, drive.stations)
    bound = (flexible * drive.ringing)[:, ~keep].sum(axis=1)
    fastest = max(float(np.max(modes.frequency[visible & keep], initial=0.0)), drive.fastest)
    step = min(end / 200.0, 1.0 / (SAMPLES_PER_PERIOD * fastest)) if fastest > 0.0 else end / 200.0
    return step, keep, bound
