"""Our calls, as a user of the engine writes them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.problems import Chain, Sweep
from engine.case.data import CaseData
from engine.model.build_train import build_train
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.modes import ModalDamping, Modes, modal_damping, modes_of
from engine.model.motor import motors_of
from engine.model.subdivision import natural_modes
from engine.model.train import Train
from engine.start.settings import settings_of
from engine.start.simulation import simulate
from engine.start.start_model import StartModel, start_model
from engine.start.time_response import TimeResponse, linear, time_response
from engine.start.trajectory import Trajectory
from tests.prescribed import torque_from_function

__all__ = ["PreparedStart", "build_and_solve", "prepare_start", "response", "run_steps"]

Floats = NDArray[np.float64]
#: Longest time any of the starts is followed. [s]
LONGEST = 120.0


def build_and_solve(chain: Chain) -> Modes:
    """From the table of stations to frequencies, shapes and torques of elements."""
    return modes_of(build_train(chain.case()))


def response(train: Train, torque: Sweep, station: int, step: float, kind: str) -> TimeResponse:
    """Modes and response; the torque a function of time, or samples joined by straight lines."""
    times = np.linspace(0.0, torque.duration, round(torque.duration / step) + 1)
    if kind == "linear":
        prescribed = linear(station, times, torque(times))
    else:
        prescribed = torque_from_function(station, torque)
    return time_response(train, modes_of(train), [prescribed], times)


@dataclass(frozen=True, eq=False)
class PreparedStart:
    """A start ready to be simulated at any step.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train, modes, damping : Train, Modes, ModalDamping
        Its train. [SI]
    model : StartModel
        Arguments of the compiled loop. [SI]
    stations : ndarray of int
        Stations the forces of the model act on. [index]
    target : float
        Speed at which it ends. [rad/s]
    """

    case: CaseData
    train: Train
    modes: Modes
    damping: ModalDamping
    model: StartModel
    stations: NDArray[np.int64]
    target: float

    def damping_matrix(self) -> Floats:
        """Damping of the degrees of freedom that gives every mode its damping."""
        weighted = self.train.inertia[:, None] * self.modes.shape
        return np.asarray((weighted * self.damping.rate) @ weighted.T)


def prepare_start(case: CaseData, tolerance: float | None = None) -> PreparedStart:
    """Modes, curves and kept modes of a start, as `run_start` prepares them."""
    if tolerance is not None:  # finer than what may be typed, so that every mode is kept
        case = replace(CaseData(**vars(case)), tolerance_peak=tolerance)
    settings = settings_of(case)
    found = natural_modes(case)
    train, modes = found.train, found.modes
    damping = modal_damping(case, train, modes)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = start_model(
        case, ModalTrain(train, modes, damping), motors, loads, settings.tolerance_peak, LONGEST
    )
    stations = np.array(sorted({m.station for m in motors} | {d.station for d in loads}))
    return PreparedStart(case, train, modes, damping, model, stations, settings.end_speed)


def run_steps(start: PreparedStart, step: float, method: str) -> Trajectory:
    """One simulation at one step."""
    return simulate(start.model, step, method, start.target, LONGEST)
