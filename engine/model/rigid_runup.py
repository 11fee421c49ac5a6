"""The start of the train as one rigid body: where it settles, and how long it takes.

Cheap evidence for the simulation: equilibrium below the end speed, run length, acceleration and
sweep rate at each speed (Figure 6 of the paper without the oscillations).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np

from engine.arrays import Floats
from engine.model.load import Load, opposing_torque, rigid_inertia
from engine.model.motor import Motor, through_synchronism
from engine.model.train import Train
from engine.numerics.same_bits import hypot, interp

#: Points of the speed grid between standstill and end speed.
N_GRID = 2001


@dataclass(frozen=True, eq=False)
class RigidRunup:
    """Net torque and run-up of the rigid train, referred to the reference shaft."""

    #: Speed of the reference shaft, from standstill to end speed. [rad/s] Shape (n,).
    speed: Floats
    #: Sum of the motors' average and pulsating torques and of the loads and dampers, referred to
    #: the reference shaft. [N m] Shape (n,).
    average: Floats
    pulsating: Floats  #: Likewise. [N m] Shape (n,).
    pulsating1: Floats  #: Likewise, at the slip frequency itself. [N m] Shape (n,).
    load: Floats  #: Likewise. [N m] Shape (n,).
    inertia: float  #: Inertia of the whole train, referred to the reference shaft. [kg m²]
    #: Lowest speed where the net torque is no longer positive; None if there is none. [rad/s]
    equilibrium: float | None
    time: Floats  #: Time to reach each speed; infinite beyond the equilibrium. [s] Shape (n,).

    @property
    def net(self) -> Floats:
        """Accelerating torque, shape (n,). [N m]"""
        return self.average - self.load

    def acceleration_at(self, speed: float) -> float:
        """Acceleration of the rigid train.

        Parameters
        ----------
        speed : float
            Speed of the reference shaft. [rad/s]

        Returns
        -------
        float
            Acceleration of the reference shaft. [rad/s²]
        """
        return float(interp(speed, self.speed, self.net)) / self.inertia


@lru_cache(maxsize=4)
def _speeds(end_speed: float) -> Floats:
    """Speed grid; all starts of a study share it."""
    speed = np.linspace(0.0, end_speed, N_GRID)
    speed.flags.writeable = False
    return speed


def rigid_runup(
    train: Train,
    motors: Sequence[Motor],
    loads: Sequence[Load],
    end_speed: float,
    *,
    field_slip: float | None = None,
) -> RigidRunup:
    """Rigid-body run-up from standstill to an end speed.

    With a field the average torque of each motor goes on through synchronism from the slip of
    field application, as in the simulation; the torque of the field itself has no mean while the
    motor slips, and is not in it. `PullInDamping` is left to the simulation: it replaces the curve
    only from that slip on, where the time no longer counts.

    Parameters
    ----------
    train : Train
        The train. [SI]
    motors : sequence of Motor
        Motors. [SI]
    loads : sequence of Load
        Driven machines. [SI]
    end_speed : float
        End of the start, of the reference shaft. [rad/s]
    field_slip : float, optional
        Slip at which the field is applied; None = never. [1]

    Returns
    -------
    RigidRunup
        Torques, equilibrium and time against speed. [SI]
    """
    speed = _speeds(end_speed)
    ratio = train.speed_ratio
    average, pulsating, pulsating1 = np.zeros((3, N_GRID))
    for m in motors:
        x = speed * ratio[m.station] / m.synchronous_speed
        torque = m.average(x)
        if field_slip is not None:
            torque = np.where(x > 1.0 - field_slip, through_synchronism(m.average)(x), torque)
        average += ratio[m.station] * torque
        pulsating += ratio[m.station] * m.pulsating(x)
        if m.at_slip:
            pulsating1 += ratio[m.station] * reduce(hypot, [curve(x) for curve in m.at_slip])
    load, inertia = opposing_torque(train, loads, speed), rigid_inertia(train)
    net = average - load
    stuck = np.flatnonzero(net <= 0.0)
    equilibrium = None
    if len(stuck):
        i = int(stuck[0])
        equilibrium = 0.0
        if i > 0:
            share = net[i - 1] / (net[i - 1] - net[i])
            equilibrium = float(speed[i - 1] + share * (speed[i] - speed[i - 1]))
    slowness = np.full(N_GRID, np.inf)
    np.divide(inertia, net, out=slowness, where=net > 0.0)
    if len(stuck):
        slowness[stuck[0] :] = np.inf
    steps = 0.5 * (slowness[1:] + slowness[:-1]) * np.diff(speed)
    time = np.concatenate([[0.0], np.cumsum(steps)])
    return RigidRunup(speed, average, pulsating, pulsating1, load, inertia, equilibrium, time)
