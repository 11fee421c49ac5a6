"""Motors whose torque follows from their fluxes, as the loop with events takes them (`kernels/fluxes.h`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.effect import StartEffects
from engine.model.motor import Motor
from engine.model.train import Train
from engine.motor.circuit import Circuit, line_omega, starting_circuit
from engine.motor.from_case import motors_without_curve
from engine.motor.two_axis import MachineState, flux_system, number_of_fluxes, with_closed_field
from engine.start.machine_motion import Machine, Supply, switched
from engine.stepping.library import struct


@dataclass(frozen=True, eq=False)
class MachineInTime:
    """A motor of the loop as a two-axis machine."""

    machine: Machine  #: The motor. [pu, SI]
    supplies: tuple[Supply, ...]  #: What its stator is connected to, rising in time. [pu, rad]
    flux: Floats  #: Before the first of them. [pu] Shape (n_flux,).
    field_voltage: float = 0.0  #: Of the field, from the beginning. [pu]
    #: Angle of the line ahead of axis d less half the phase of the motor's pulsation in the loop. [rad]
    ahead: float = 0.0
    voltage: int = -1  #: Curve of the line's voltage against speed; -1: always 1. [index]
    #: Circuit once the field is applied, and the voltage of the field then; None: no field is applied. [pu]
    excited: tuple[Circuit, float] | None = None

    def scaled(self, factor: float) -> MachineInTime:
        """The same with so many times the torque. [1]"""
        machine = replace(self.machine, torque_base=factor * self.machine.torque_base)
        return replace(self, machine=machine)


class Machines:
    """Machines of a run in the arrays that the loop reads; they change as things are switched."""

    def __init__(self, machines: Sequence[MachineInTime], frame: float) -> None:
        self._machines = list(machines)
        self._waiting = [list(m.supplies) for m in machines]
        n = len(machines)
        excited = [m.excited[0] if m.excited else m.machine.circuit for m in machines]
        most = max(map(number_of_fluxes, excited), default=1)
        self._arrays: dict[str, Any] = {
            "motor": np.arange(n), "n_flux": np.array([len(m.flux) for m in machines], dtype=np.int64),
            "q": np.zeros(n, dtype=np.int64), "voltage": np.array([m.voltage for m in machines], dtype=np.int64),
            "rate": np.zeros((n, most, most)), "current": np.zeros((n, 2, most)),
            "field": np.zeros((n, most)), "stator": np.zeros(n), "forward": np.zeros((n, 2)),
            "backward": np.zeros((n, 2)), "flux": np.zeros((n, most)),
            "base": np.array([m.machine.torque_base for m in machines], dtype=np.float64),
        }  # fmt: skip
        for k, m in enumerate(machines):
            self._arrays["flux"][k, : len(m.flux)] = m.flux
        line = machines[0].machine.line_omega if machines else 0.0  # one line
        self.struct = struct(
            "machines_t", n=n, most=most, line_omega=line, frame=frame, **self._arrays
        )

    def switch(self, time: float, phase: Floats) -> None:
        """Supplies that begin by then; `phase` is that of the loop's motors."""
        for k, waiting in enumerate(self._waiting):
            while waiting and waiting[0].begins <= time:
                self._connect(k, waiting.pop(0), phase)

    @property
    def next_change(self) -> float:
        """When a supply changes next; infinite where none does. [s]"""
        return min((w[0].begins for w in self._waiting if w), default=math.inf)

    def apply_field(self) -> None:
        """The discharge resistor is taken out of each field, and the exciter put in."""
        for k, m in enumerate(self._machines):
            if m.excited is None:
                continue
            circuit, voltage = m.excited
            flux = with_closed_field(m.machine.circuit, circuit, self._flux(k))
            self._machines[k] = replace(
                m, machine=replace(m.machine, circuit=circuit), field_voltage=voltage, flux=flux
            )
            self._put(k, flux, is_open=False)

    def trip(self, phase: Floats) -> None:
        """The breakers of all motors open."""
        self._waiting = [
            [] for _ in self._machines
        ]  # what happens to the line reaches none any more
        for k in range(len(self._machines)):
            self._connect(k, Supply(0.0, is_open=True), phase)

    def _flux(self, k: int) -> Floats:
        return np.asarray(self._arrays["flux"][k, : self._arrays["n_flux"][k]].copy())

    def _connect(self, k: int, supply: Supply, phase: Floats) -> None:
        arrays, m = self._arrays, self._machines[k]
        axis = -(0.5 * float(phase[k]) + m.ahead)
        flux = self._flux(k)
        state = MachineState(flux, m.field_voltage, axis)
        supply, flux = switched(m.machine, supply, state, flux)
        self._put(k, flux, is_open=supply.is_open)
        arrays["forward"][k] = supply.forward[0], supply.forward[1] + m.ahead
        arrays["backward"][k] = supply.backward[0], supply.backward[1] + m.ahead

    def _put(self, k: int, flux: Floats, *, is_open: bool) -> None:
        """Equations of a rotor at rest, to which the loop adds its motion, and fluxes."""
        arrays, m, n = self._arrays, self._machines[k], len(flux)
        machine = m.machine
        system = flux_system(
            machine.circuit, machine.line_omega, 0.0, m.field_voltage, is_open=is_open
        )
        arrays["n_flux"][k], arrays["q"][k], arrays["stator"][k] = n, system.q, float(not is_open)
        arrays["rate"][k, :n, :n], arrays["current"][k, :, :n] = system.rate, system.stator_current
        arrays["field"][k, :n], arrays["flux"][k, :n] = system.field, flux


def machines_of_start(
    case: CaseData, train: Train, motors: Sequence[Motor], effects: StartEffects, n_curves: int
) -> tuple[MachineInTime, ...]:
    """Every motor of a start as a machine in time, without fluxes when its breaker closes.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    motors : sequence of Motor
        Its motors, all from data sheets. [SI]
    effects : StartEffects
        Whether the field is applied. [flags]
    n_curves : int
        Curves of the loop; voltages against speed are the last of them. [count]

    Returns
    -------
    tuple of MachineInTime
        [pu]
    """
    data = motors_without_curve(case)
    omega = line_omega(case.ratings.line_frequency or 0.0)
    supplied = [m for m in motors if m.supply is not None]
    machines = []
    for motor in motors:
        sheet = data[train.stations[motor.station]]
        machine = Machine(sheet.starting, sheet.torque_base, sheet.synchronous_speed, omega)
        factor = 1.0 if sheet.sheet.start_factor is None else sheet.sheet.start_factor
        running, excited = starting_circuit(sheet.circuit, factor=factor), None
        if effects.pull_in and running.field is not None:
            # PullOutTorque = E V / Xd at rated voltage, E = Xmd if
            xd = running.stator_leakage + running.magnetising_d
            emf = (case.pull_out_torque or 0.0) / sheet.torque_base * xd
            excited = running, running.field.resistance * emf / running.magnetising_d
        voltage = -1
        if motor.supply is not None:
            voltage = (
                n_curves - len(supplied) + next(i for i, m in enumerate(supplied) if m is motor)
            )
        machines.append(
            MachineInTime(
                machine,
                (Supply(0.0, (math.sqrt(motor.scale), 0.0)),),
                np.zeros(number_of_fluxes(sheet.starting)),
                # half the phase is the angle of the line ahead of axis q
                ahead=0.5 * math.pi,
                voltage=voltage,
                excited=excited,
            )
        )
    return tuple(machines)
