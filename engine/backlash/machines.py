"""Motors whose torque follows from their fluxes, as the loop with events takes them (`kernels/fluxes.h`)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.effect import StartEffects
from engine.model.motor import Motor
from engine.model.soft_start import Ramp
from engine.model.train import Train
from engine.motor.circuit import Circuit, line_omega, starting_circuit
from engine.motor.from_case import MotorFromData, motors_without_curve
from engine.motor.supply import Source
from engine.motor.two_axis import (
    MachineState,
    field_flux,
    flux_system,
    number_of_fluxes,
    with_same_currents,
)
from engine.start.machine_motion import Machine, Supply, switched
from engine.stepping.library import struct


@dataclass(frozen=True)
class Connected:
    """A motor behind a source, its impedance part of the stator's."""

    circuit: Circuit  #: As it starts. [pu]
    voltage: float  #: Of the source. [pu]
    #: Circuit once the field is applied, and the voltage of the field then; None: no field is applied. [pu]
    excited: tuple[Circuit, float] | None = None


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
    ramp: Ramp | None = None  #: Voltage of its soft starter in time. [1]
    switched: tuple[Connected, ...] = ()  #: What it is switched over to, one after the other. [pu]

    def scaled(self, factor: float) -> MachineInTime:
        """The same with so many times the torque. [1]"""
        machine = replace(self.machine, torque_base=factor * self.machine.torque_base)
        return replace(self, machine=machine)


class Machines:
    """Machines of a run in the arrays that the loop reads; they change as things are switched."""

    def __init__(self, machines: Sequence[MachineInTime], frame: float) -> None:
        self._machines = list(machines)
        self._waiting = [list(m.supplies) for m in machines]
        self._over = [list(m.switched) for m in machines]
        self._is_excited = False
        #: Whether the current of each field flows against that of operation.
        self._against = [False] * len(machines)
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
            "ramp": np.array([(m.ramp.initial, m.ramp.time) if m.ramp else (1.0, 0.0) for m in machines]).reshape(n, 2),
            "watched": np.zeros(n, dtype=np.int64), "watch": np.zeros((n, most)),
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
        self._is_excited = True
        for k, m in enumerate(self._machines):
            if m.excited is not None:
                circuit, voltage = m.excited
                self._machines[k] = replace(m, field_voltage=voltage)
                self._become(k, circuit)

    def switch_over(self, time: float, opened: Mapping[int, float], phase: Floats) -> None:
        """Each motor to its next source; the currents of its windings go on unless it is off the line first.

        `opened` says how long which motors are. [s]
        """
        for k, waiting in enumerate(self._over):
            to = waiting.pop(0)
            if k in opened:
                self._connect(k, Supply(time, is_open=True), phase)
            self._machines[k] = replace(self._machines[k], excited=to.excited)
            is_excited = self._is_excited and to.excited is not None
            self._become(k, to.excited[0] if is_excited and to.excited else to.circuit)
            supply = Supply(time + opened.get(k, 0.0), (to.voltage, 0.0))
            if k in opened:
                self._waiting[k].append(supply)
            else:
                self._connect(k, supply, phase)

    def turn_field(self, k: int) -> None:
        """The current of a field has changed its sign, and the resistance of its circuit with it."""
        before = self._present(k)
        self._against[k] = not self._against[k]
        flux = with_same_currents(before, self._present(k), self._flux(k))
        self._put(k, flux, is_open=not self._arrays["stator"][k])

    def trip(self, phase: Floats) -> None:
        """The breakers of all motors open for good; what happens to the line reaches none any more."""
        self._waiting = [[] for _ in self._machines]
        for k in range(len(self._machines)):
            self._connect(k, Supply(0.0, is_open=True), phase)

    def _become(self, k: int, circuit: Circuit) -> None:
        """Another circuit from now on."""
        m, before = self._machines[k], self._present(k)
        self._machines[k] = replace(m, machine=replace(m.machine, circuit=circuit))
        flux = with_same_currents(before, self._present(k), self._flux(k))
        self._put(k, flux, is_open=not self._arrays["stator"][k])

    def _present(self, k: int) -> Circuit:
        """The circuit of a motor with the present sign of its field current."""
        return self._machines[k].machine.circuit.polarities[self._against[k]]

    def _flux(self, k: int) -> Floats:
        return np.asarray(self._arrays["flux"][k, : self._arrays["n_flux"][k]].copy())

    def _connect(self, k: int, supply: Supply, phase: Floats) -> None:
        arrays, m = self._arrays, self._machines[k]
        axis = -(0.5 * float(phase[k]) + m.ahead)
        flux = self._flux(k)
        state = MachineState(flux, m.field_voltage, axis)
        machine = replace(m.machine, circuit=self._present(k))
        supply, flux = switched(machine, supply, state, flux)
        self._put(k, flux, is_open=supply.is_open)
        arrays["forward"][k] = supply.forward[0], supply.forward[1] + m.ahead
        arrays["backward"][k] = supply.backward[0], supply.backward[1] + m.ahead

    def _put(self, k: int, flux: Floats, *, is_open: bool) -> None:
        """Equations of a rotor at rest, to which the loop adds its motion, and fluxes."""
        arrays, m, n = self._arrays, self._machines[k], len(flux)
        circuit, line_omega = self._present(k), m.machine.line_omega
        system = flux_system(circuit, line_omega, 0.0, m.field_voltage, is_open=is_open)
        arrays["n_flux"][k], arrays["q"][k], arrays["stator"][k] = n, system.q, float(not is_open)
        arrays["rate"][k, :n, :n], arrays["current"][k, :, :n] = system.rate, system.stator_current
        arrays["field"][k, :n], arrays["flux"][k, :n] = system.field, flux
        if m.machine.circuit.reverse_resistance is None:
            arrays["watched"][k] = 0
        elif circuit.field is not None:  # its current keeps its sign
            arrays["watched"][k] = 1
            arrays["watch"][k, :n] = (-1.0 if self._against[k] else 1.0) * system.current[1]
        else:  # nor does its voltage, the rate of its flux, let a current flow
            arrays["watched"][k] = 2
            arrays["watch"][k, :n] = field_flux(circuit, m.machine.circuit) / line_omega


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
    supplied = [m for m in motors if m.line_voltage is not None]
    untils = {stage.connection.until for sheet in data.values() for stage in sheet.stages}
    above = 0.0, *sorted(untils - {math.inf})
    machines = []
    for motor in motors:
        sheet = data[train.stations[motor.station]]
        first, *others = (_connected(case, motor, sheet, effects, speed) for speed in above)
        voltage = -1
        if motor.line_voltage is not None:
            voltage = n_curves - len(supplied)
            voltage += next(i for i, m in enumerate(supplied) if m is motor)
        machines.append(
            MachineInTime(
                Machine(first.circuit, sheet.torque_base, sheet.synchronous_speed, omega),
                (Supply(0.0, (first.voltage, 0.0)),),
                np.zeros(number_of_fluxes(first.circuit)),
                # half the phase is the angle of the line ahead of axis q
                ahead=0.5 * math.pi,
                voltage=voltage,
                excited=first.excited,
                ramp=None if motor.soft is None else motor.soft.ramp,
                switched=tuple(others),
            )
        )
    return tuple(machines)


def _connected(
    case: CaseData, motor: Motor, sheet: MotorFromData, effects: StartEffects, above: float
) -> Connected:
    """What a motor is connected to from a fraction of synchronous speed on."""
    factor = 1.0 if sheet.sheet.start_factor is None else sheet.sheet.start_factor
    running = starting_circuit(sheet.circuit, factor=factor)
    source = next(s for s in sheet.stages if s.connection.until > above).connection.source
    return Connected(
        source.before(sheet.starting),
        math.sqrt(motor.scale) * source.voltage,
        _excited(case, running, source, sheet.torque_base) if effects.pull_in else None,
    )


def _excited(
    case: CaseData, running: Circuit, source: Source, torque_base: float
) -> tuple[Circuit, float] | None:
    """The circuit with its field applied, and the voltage of the field."""
    if running.field is None:
        return None
    # PullOutTorque = E V / Xd at rated voltage, E = Xmd if
    xd = running.stator_leakage + running.magnetising_d
    emf = (case.pull_out_torque or 0.0) / torque_base * xd
    voltage = running.field.resistance * emf / running.magnetising_d
    return source.before(running), voltage
