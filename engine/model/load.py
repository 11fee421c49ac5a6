"""Torque of the driven machines against their own speed.

A load opposes motion and never drives a station backwards: near standstill its torque goes
smoothly through zero with the direction of rotation, over a speed so small that it matters only
in the first milliseconds. The width of that zone is a property of the case, not of the step, so
results converge with the step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.errors import ModelError
from engine.model.train import Train
from engine.numerics.same_bits import product, square
from engine.numerics.torque_curve import TorqueCurve, torque_curve

#: Width of the standstill zone over synchronous speed. [1]
STANDSTILL_ZONE = 1e-3
#: Up to this speed, over synchronous, a load's torque counts as that at standstill. [1]
NEAR_STANDSTILL = 0.05
_NEAR = np.linspace(0.0, NEAR_STANDSTILL, 11)
#: A load must not change its station's speed by more than the zone within this time. [s]
STANDSTILL_TIME = 2e-3
#: However light its station, a load has its full torque above this share of its speed: a station
#: of a few grams is carried by its shaft and need not be slowed by itself.
WIDEST_ZONE = 0.02


@dataclass(frozen=True, eq=False)
class Load:
    """One driven machine."""

    station: int  #: Station it acts on.
    torque: TorqueCurve  #: Opposing torque against speed, at the station's own speed. [N m]
    synchronous_speed: float  #: Of its own station, with the motor at synchronism. [rad/s]
    soft_speed: float  #: Below this speed the torque goes smoothly through zero. [rad/s]


def loads_of(case: CaseData, train: Train) -> tuple[Load, ...]:
    """Loads of a case.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    tuple of Load
        In the order of the table. [count]

    Raises
    ------
    ModelError
        If the synchronous speed is unknown.
    """
    names = list(dict.fromkeys(p.station for p in case.load_torque))
    if not names:
        return ()
    synchronous = case.ratings.synchronous_speed
    if synchronous is None:
        raise ModelError(
            "A load curve needs the synchronous speed. Type SynchronousSpeed, or LineFrequency "
            "and Poles."
        )
    loads = []
    for name in names:
        points = [p for p in case.load_torque if p.station == name]
        station = train.stations.index(str(name))
        x = np.array([p.speed for p in points], dtype=float)
        y = np.array([p.torque for p in points], dtype=float)
        speed = synchronous * float(train.speed_ratio[station])
        inertia = float(
            train.inertia[train.node_dof[station]] / square(float(train.node_scale[station]))
        )
        curve = torque_curve(x, y)
        sticking = float(np.max(curve(_NEAR)))
        soft = max(STANDSTILL_ZONE * speed, STANDSTILL_TIME * sticking / inertia)
        soft = min(soft, WIDEST_ZONE * speed)
        loads.append(Load(station, curve, speed, soft))
    return tuple(loads)


def opposing_torque(train: Train, loads: Sequence[Load], speed: Floats) -> Floats:
    """Torque of all loads and of dampers at stations, referred to the reference shaft.

    Parameters
    ----------
    train : Train
        The train. [SI]
    loads : sequence of Load
        Its loads. [SI]
    speed : ndarray, shape (n,)
        Speeds of the reference shaft. [rad/s]

    Returns
    -------
    ndarray, shape (n,)
        [N m]
    """
    ratio, torque = train.speed_ratio, np.zeros(len(speed))
    for d in loads:
        torque += ratio[d.station] * d.torque(speed * ratio[d.station] / d.synchronous_speed)
    torque += float(product(train.node_damping, ratio[: len(train.node_damping)] ** 2)) * speed
    return torque


def rigid_inertia(train: Train) -> float:
    """Inertia of the whole train, referred to the reference shaft.

    Parameters
    ----------
    train : Train
        The train. [SI]

    Returns
    -------
    float
        [kg m²]
    """
    return float(product(train.inertia, train.dof_ratio**2))
