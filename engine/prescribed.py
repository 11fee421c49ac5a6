"""A case without a motor: the train under the torques of table `TorqueTime` alone.

The solution is exact at the samples (`engine.time_response`); the sample spacing only has to be
fine enough for the cubic between samples to catch the peaks, which the change on halving it tells.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engine.case import CaseData
from engine.modal import ModalDamping, Modes
from engine.startup import Start, StartOutcome, Trajectory, element_peaks, turning_of, worst_outputs
from engine.time_response import PrescribedTorque, linear, time_response
from engine.train import Train

__all__ = ["run_prescribed"]

Floats = NDArray[np.float64]

#: Samples per period of the fastest mode that matters, tried first.
SAMPLES_PER_PERIOD = 16.0
#: A mode matters while its static share of the torque exceeds this share of the tolerance.
MATTERS = 0.1
#: Most samples of one run.
MAX_SAMPLES = 2_000_000


def run_prescribed(case: CaseData, train: Train, modes: Modes, damping: ModalDamping) -> Start:
    """Response to the prescribed torques, from rest.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]
    damping : ModalDamping
        Their damping; dampers act with their full matrix. [SI]

    Returns
    -------
    Start
        Peaks, histories and error estimates, outcome ``completed``. [SI]
    """
    names = list(dict.fromkeys(p.station for p in case.torque_time))
    torques = []
    for name in names:
        rows = [p for p in case.torque_time if p.station == name]
        torques.append(
            linear(
                train.station_index(str(name)),
                np.array([p.time for p in rows], dtype=float),
                np.array([p.torque for p in rows], dtype=float),
            )
        )
    last = max(float(p.time or 0.0) for p in case.torque_time)
    end = case.maximum_time or last
    tolerance = case.tolerance_peak or 1e-3
    step = _first_step(train, modes, torques, tolerance, end)

    def at(h: float) -> tuple[Trajectory, float, list[tuple[Floats, Floats]]]:
        count = min(max(int(np.ceil(end / h)), 2), MAX_SAMPLES)
        r = time_response(
            train,
            modes,
            torques,
            np.linspace(0.0, end, count + 1),
            damping_ratio=damping.structural,
        )
        mean = r.station_speed[0] / train.speed_ratio[0]
        trajectory = Trajectory(
            r.time, mean, r.torque, r.torque_rate, r.output_element, False, count
        )
        return trajectory, end, turning_of(trajectory, end)

    coarse, fine = at(step), at(0.5 * step)
    halvings = 0
    while True:
        output = worst_outputs(train, fine[0], fine[2])
        peaks = element_peaks(train, np.zeros(len(fine[2])), fine, coarse, output)
        error = max((p.relative_error for p in peaks), default=0.0)
        if error <= tolerance or 2.0 * end / step > MAX_SAMPLES:
            break
        halvings, step = halvings + 1, 0.5 * step
        coarse, fine = fine, at(0.5 * step)
    speed = float(fine[0].mean_speed[-1])
    sentence = f"Prescribed torques followed to {end:.4g} s."
    return Start(
        outcome=StartOutcome("completed", end, speed, sentence),
        peaks=peaks,
        trajectory=fine[0],
        turning_points=tuple(fine[2][i] for i in output if i >= 0),
        coarse_turning_points=tuple(coarse[2][i] for i in output if i >= 0),
        output_of_element=output,
        runup=None,
        step=0.5 * step,
        halvings=halvings,
        estimated_error=error,
        truncation_error=0.0,
        kept_modes=modes.n_modes,
        method="exponential",
        met_tolerance=error <= tolerance,
    )


def _first_step(
    train: Train, modes: Modes, torques: list[PrescribedTorque], tolerance: float, end: float
) -> float:
    """Spacing that resolves every mode with a visible share of some element's torque."""
    elastic = modes.omega > 0.0
    if not np.any(elastic):
        return end / 200.0
    stations = [p.station for p in torques]
    reach = np.abs(modes.shape[train.node_dof[stations]] * train.node_scale[stations][:, None])
    static = np.abs(modes.row_torque[:, elastic]) * reach.sum(axis=0)[elastic]
    static /= modes.omega[elastic] ** 2
    share = np.max(static / np.maximum(static.sum(axis=1, keepdims=True), 1e-300), axis=0)
    fastest = float(np.max(modes.frequency[elastic][share > MATTERS * tolerance], initial=0.0))
    return min(end / 200.0, 1.0 / (SAMPLES_PER_PERIOD * fastest)) if fastest > 0.0 else end / 200.0
