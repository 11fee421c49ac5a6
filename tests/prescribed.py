"""Torques against time and initial speeds that validation needs and no case can state."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from engine.errors import ModelError
from engine.model.modes import Modes
from engine.model.train import Train
from engine.start.time_response import PrescribedTorque

Floats = NDArray[np.float64]


def held(station: int, times: Floats, torques: Floats) -> PrescribedTorque:
    """Torque that keeps each sample until the next (zero before the first).

    Parameters
    ----------
    station : int
        Station. [index]
    times : ndarray, shape (n,)
        Rising. [s]
    torques : ndarray, shape (n,)
        Torque from that time on. [N m]

    Returns
    -------
    PrescribedTorque
        The torque. [N m]
    """
    t, y = np.asarray(times, dtype=float), np.concatenate([[0.0], torques])

    def value(at: Floats, side: str) -> Floats:
        return np.asarray(y[np.searchsorted(t, at, side="left" if side == "left" else "right")])

    return PrescribedTorque(station, t, value)


def torque_from_function(station: int, function: Callable[[Floats], Floats]) -> PrescribedTorque:
    """Torque given by a smooth function of time.

    Parameters
    ----------
    station : int
        Station. [index]
    function : callable
        Torque for an array of times. [N m]

    Returns
    -------
    PrescribedTorque
        The torque. [N m]
    """

    def value(at: Floats, side: str) -> Floats:
        return np.asarray(np.broadcast_to(function(at), np.shape(at)), dtype=float)

    return PrescribedTorque(station, np.empty(0), value)


def modal_speed(train: Train, modes: Modes, station_speed: Floats) -> Floats:
    """Modal velocities of given station speeds: Φᵀ M ω."""
    wanted = np.asarray(station_speed, dtype=float)
    dof_value = np.zeros(train.n_dof)
    inner = np.ones(train.n_dof, dtype=np.bool_)
    for i in range(train.n_stations):
        value = wanted[i] / train.node_scale[i]
        dof = train.node_dof[i]
        if not inner[dof] and abs(value - dof_value[dof]) > 1e-9 * max(1.0, abs(value)):
            raise ModelError(
                f"The initial value of station '{train.stations[i]}' contradicts its rigid mesh."
            )
        dof_value[dof], inner[dof] = value, False
    if np.any(inner):  # inner points of shafts: on the straight line the shaft would take at rest
        dof_value = _fill_inner(train, dof_value, inner)
    return np.asarray(modes.shape.T @ (train.inertia * dof_value))


def _fill_inner(train: Train, value: Floats, inner: NDArray[np.bool_]) -> Floats:
    """Static position of inner points between given ends."""
    B = train.incidence
    K = (B.T * train.stiffness) @ B
    value = value.copy()
    value[inner] = np.linalg.solve(
        K[np.ix_(inner, inner)], -K[np.ix_(inner, ~inner)] @ value[~inner]
    )
    return value
