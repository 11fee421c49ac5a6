"""A case without a motor: the train under the torques of table `TorqueTime` alone.

The solution is exact at the samples (`engine.start.time_response`); the sample spacing only has to be
fine enough for the cubic between samples to catch the peaks, as the change on halving it shows.
"""

from __future__ import annotations

import numpy as np

from engine.arrays import Floats, Mask
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
from engine.start.start import Start
from engine.start.time_response import PrescribedTorque, prescribed_torques, time_response
from engine.start.torque_outputs import force_reach, torque_outputs
from engine.start.trajectory import SingleRun, Trajectory

#: Samples per period of the fastest mode that matters, tried first.
SAMPLES_PER_PERIOD = 16.0
#: A mode matters while its static share of the torque exceeds this share of the tolerance.
MATTERS = 0.1
#: Most samples of one run, and most values (samples × outputs).
MAX_SAMPLES, MAX_VALUES = 2_000_000, 10_000_000


def run_prescribed(case: CaseData, modal: ModalTrain) -> Start:
    """Response to the prescribed torques, from rest; its outcome is ``completed``.

    Raises `ModelError` if neither the table nor MaximumTime says how long to follow the train.
    """
    train, modes, damping = modal
    torques = prescribed_torques(case, train)
    last = max(float(p.time or 0.0) for p in case.torque_time)
    end = case.maximum_time or last
    if end <= 0.0:
        raise ModelError(
            "The prescribed torques end at time 0. Type MaximumTime to set the length of the run."
        )
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    step, keep, truncation = _first_step(train, modes, torques, tolerance, end)
    most = _most_samples(train)

    def at(h: float) -> SingleRun:
        count = min(max(int(np.ceil(end / h)), 2), most)
        r = time_response(
            train,
            modes,
            torques,
            np.linspace(0.0, end, count + 1),
            damping_ratio=damping.structural,
            kept=keep,
        )
        mean = r.station_speed[0] / train.speed_ratio[0]
        trajectory = Trajectory(
            r.time, mean, r.torque, r.torque_rate, r.output_element, False, count
        )
        return SingleRun.until(trajectory, end)

    coarse, fine = at(step), at(0.5 * step)
    halvings = 0
    while True:
        judged = judge_run(train, truncation, fine, coarse)
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


def _first_step(
    train: Train, modes: Modes, torques: list[PrescribedTorque], tolerance: float, end: float
) -> tuple[float, Mask, Floats]:
    """Spacing that resolves every mode with a visible share of some element's torque.

    Modes that no affordable spacing resolves (a link of 1e16 N m/rad) follow statically; the bound
    on their ringing comes back with the mask of the others: a jump rings with its static
    deflection, a change of slope with that of slope/ω.
    """
    keep = np.ones(modes.n_modes, dtype=np.bool_)
    stations = np.array([p.station for p in torques], dtype=np.int64)
    outputs = torque_outputs(train, modes, stations)
    omega = np.where(modes.omega > 0.0, modes.omega, np.inf)
    reach = np.abs(force_reach(train, modes, stations))
    flexible = np.abs(outputs.position) / omega**2
    static = flexible * reach.sum(axis=1)
    total = np.maximum(static.sum(axis=1, keepdims=True), 1e-300)
    visible = np.max(static / total, axis=0, initial=0.0) > MATTERS * tolerance
    affordable = modes.frequency * SAMPLES_PER_PERIOD * end <= 0.25 * _most_samples(train)
    keep[visible & ~affordable] = False
    jumps, ramps = np.array([p.jump for p in torques]), np.array([p.ramp for p in torques])
    bound = (flexible * (product(reach, jumps) + product(reach, ramps) / omega))[:, ~keep].sum(
        axis=1
    )
    fastest = float(np.max(modes.frequency[visible & keep], initial=0.0))
    step = min(end / 200.0, 1.0 / (SAMPLES_PER_PERIOD * fastest)) if fastest > 0.0 else end / 200.0
    return step, keep, bound
