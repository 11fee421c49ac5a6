"""Motors whose torque follows from their fluxes, as the loop with events takes them (`kernels/fluxes.h`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.motor.two_axis import flux_system
from engine.start.machine_motion import Machine, Supply, switched
from engine.stepping.library import struct


@dataclass(frozen=True, eq=False)
class MachineInTime:
    """A motor of the loop as a two-axis machine."""

    machine: Machine  #: The motor before its field is applied. [pu, SI]
    supplies: tuple[Supply, ...]  #: What its stator is connected to, rising in time. [pu, rad]
    flux: Floats  #: Before the first of them. [pu] Shape (n_flux,).
    field_voltage: float = 0.0  #: Of the field, from the beginning. [pu]
    #: Angle of the line ahead of axis d less half the phase of the motor's pulsation in the loop. [rad]
    ahead: float = 0.0

    def scaled(self, factor: float) -> MachineInTime:
        """The same with so many times the torque. [1]"""
        machine = replace(self.machine, torque_base=factor * self.machine.torque_base)
        return replace(self, machine=machine)


class Machines:
    """Machines of a run in the arrays that the loop reads; they change with their supplies."""

    def __init__(self, machines: Sequence[MachineInTime], frame: float) -> None:
        self.machines = machines
        sizes = [len(m.flux) for m in machines]
        n, most = len(machines), max(sizes, default=1)
        self._waiting = [list(m.supplies) for m in machines]
        self._arrays: dict[str, Any] = {
            "motor": np.arange(n), "n_flux": np.array(sizes, dtype=np.int64),
            "q": np.zeros(n, dtype=np.int64), "voltage": np.full(n, -1, dtype=np.int64),
            "rate": np.zeros((n, most, most)), "current": np.zeros((n, 2, most)),
            "field": np.zeros((n, most)), "stator": np.zeros(n), "forward": np.zeros((n, 2)),
            "backward": np.zeros((n, 2)), "flux": np.zeros((n, most)),
            "base": np.array([m.machine.torque_base for m in machines], dtype=np.float64),
        }  # fmt: skip
        for k, m in enumerate(machines):
            self._arrays["flux"][k, : sizes[k]] = m.flux
        line_omega = machines[0].machine.line_omega if machines else 0.0  # one line
        self.struct = struct(
            "machines_t", n=n, most=most, line_omega=line_omega, frame=frame, **self._arrays
        )

    def switch(self, time: float, phase: Floats) -> None:
        """Supplies that begin by then; `phase` is that of the loop's motors."""
        for k, (m, waiting) in enumerate(zip(self.machines, self._waiting, strict=True)):
            while waiting and waiting[0].begins <= time:
                self._connect(k, m, waiting.pop(0), -(0.5 * float(phase[k]) + m.ahead))

    @property
    def next_change(self) -> float:
        """When a supply changes next; infinite where none does. [s]"""
        return min((w[0].begins for w in self._waiting if w), default=math.inf)

    def _connect(self, k: int, m: MachineInTime, supply: Supply, axis: float) -> None:
        arrays, n, machine = self._arrays, len(m.flux), m.machine
        supply, flux = switched(machine.circuit, supply, arrays["flux"][k, :n], axis)
        # of a rotor at rest: the loop adds its motion
        system = flux_system(
            machine.circuit, machine.line_omega, 0.0, m.field_voltage, is_open=supply.is_open
        )
        arrays["q"][k], arrays["stator"][k] = system.q, 0.0 if supply.is_open else 1.0
        arrays["rate"][k, :n, :n], arrays["current"][k, :, :n] = system.rate, system.stator_current
        arrays["field"][k, :n], arrays["flux"][k, :n] = system.field, flux
        arrays["forward"][k] = supply.forward[0], supply.forward[1] + m.ahead
        arrays["backward"][k] = supply.backward[0], supply.backward[1] + m.ahead
