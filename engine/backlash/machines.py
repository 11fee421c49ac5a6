"""Motors whose torque follows from their fluxes, as the loop with events takes them (`kernels/fluxes.h`)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.backlash.current_zeros import LONGEST_ARC, cleared_supply
from engine.case.data import CaseData
from engine.case.effect import StartEffects
from engine.model.motor import Motor
from engine.model.soft_start import Ramp
from engine.model.train import Train
from engine.motor.circuit import Circuit, line_omega, starting_circuit
from engine.motor.from_case import MotorFromData, motors_without_curve
from engine.motor.supply import STIFF, Source
from engine.motor.two_axis import (
    MachineState,
    field_flux,
    flux_system,
    number_of_fluxes,
    with_same_currents,
)
from engine.numerics.same_bits import cos, product, sin
from engine.start.machine_motion import Machine, Supply, switched, terminal_rows
from engine.stepping.library import struct

#: Steps while a zero of a current is awaited, the first of them, where a current is taken to be zero, and from where on
#: the last leap goes to the expected zero; before it goes so much of the way, lest it is passed. [periods of the line; 1]
CHUNK, FIRST, NEAR_ZERO, LAST_LEAP, SHORT = 0.01, 1e-5, 1e-8, 1e-5, 0.9


@dataclass(frozen=True, eq=False)
class MachineInTime:
    """A motor of the loop as a two-axis machine."""

    machine: Machine  #: The motor alone. [pu, SI]
    #: What its stator is connected to, rising in time; voltages over that of the source. [pu, rad]
    supplies: tuple[Supply, ...]
    flux: Floats  #: Before the first of them. [pu] Shape (n_flux,).
    field_voltage: float = 0.0  #: Of the field, from the beginning. [pu]
    #: Angle of the line ahead of axis d less half the phase of the motor's pulsation in the loop. [rad]
    ahead: float = 0.0
    voltage: int = -1  #: Curve of the line's voltage against speed; -1: always 1. [index]
    #: Circuit once the field is applied, and the voltage of the field then; None: no field is applied. [pu]
    excited: tuple[Circuit, float] | None = None
    ramp: Ramp | None = None  #: Voltage of its soft starter in time. [1]
    #: What feeds it, and what it is switched over to, one after the other. [pu]
    sources: tuple[Source, ...] = (STIFF,)
    #: Axes of the currents that must pass zero before a phase clears, at the last of the supplies; empty: all clear
    #: at once. Angles count from the line's at the supply before it. [rad]
    poles: tuple[float, ...] = ()

    def scaled(self, factor: float) -> MachineInTime:
        """The same with so many times the torque. [1]"""
        machine = replace(self.machine, torque_base=factor * self.machine.torque_base)
        return replace(self, machine=machine)


class _Clearing:
    """Zeros of the currents of a fault, met from one step to the next.

    A step is made to end near each expected zero, ever nearer, so that a run need not go back.
    """

    def __init__(self, time: float, poles: Sequence[float], period: float) -> None:
        self.waiting, self.cleared = list(poles), list[float]()
        self.next, self.latest = time, time + LONGEST_ARC * period
        self._period = period
        self._last: tuple[float, dict[float, float]] = (time, {})

    def met(self, time: float, currents: Mapping[float, float]) -> bool:
        """Whether a current is zero; its phase has then cleared. Otherwise `next` is when to look again. [s, pu]"""
        before, values = self._last
        away = CHUNK * self._period
        for pole, value in currents.items():
            if pole not in values:  # how fast it falls is not known yet
                away = min(away, FIRST * self._period)
                continue
            passed = values[pole] * value <= 0.0
            falls = (values[pole] - value) / (time - before)
            left = value / falls if falls * value > 0.0 else math.inf
            if passed or left <= NEAR_ZERO * self._period:
                self.waiting.remove(pole)
                self.cleared.append(pole)
                self._last, self.next = (time, {}), time
                return True
            short = 1.0 if left <= LAST_LEAP * self._period else SHORT
            away = min(away, short * left)
        self._last, self.next = (time, dict(currents)), time + away
        return False


class Machines:
    """Machines of a run in the arrays that the loop reads; they change as things are switched."""

    def __init__(self, machines: Sequence[MachineInTime], frame: float) -> None:
        self._machines = list(machines)
        self._present = [m.supplies[0] for m in machines]
        self._waiting = [list(m.supplies) for m in machines]
        self._sources = [list(m.sources) for m in machines]
        self._off_until: list[float | None] = [None] * len(machines)  # of a switch-over
        self._clearings: list[_Clearing | None] = [None] * len(machines)
        #: Whether the current of each field flows against that of operation.
        self._against = [False] * len(machines)
        self._circuits = [m.machine.circuit for m in machines]  # with what stands before the stator
        n = len(machines)
        excited = [m.excited[0] if m.excited else m.machine.circuit for m in machines]
        most = max(map(number_of_fluxes, excited), default=1)
        self._arrays: dict[str, Any] = {
            "motor": np.arange(n), "n_flux": np.array([len(m.flux) for m in machines], dtype=np.int64),
            "q": np.zeros(n, dtype=np.int64), "voltage": np.array([m.voltage for m in machines], dtype=np.int64),
            "rate": np.zeros((n, most, most)), "current": np.zeros((n, 2, most)),
            "field": np.zeros((n, most)), "stator": np.zeros(n), "forward": np.zeros((n, 2)),
            "backward": np.zeros((n, 2)), "unlike": np.zeros(n, dtype=np.int64), "axis": np.zeros(n),
            "rows": np.zeros((n, 2, 4)), "flux": np.zeros((n, most)),
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
                supply = waiting.pop(0)
                if self._machines[k].poles and not waiting:
                    period = 2.0 * math.pi / self._machines[k].machine.line_omega
                    self._clearings[k] = _Clearing(time, self._machines[k].poles, period)
                else:
                    self._present[k] = supply
                    self._connect(k, phase)
            self._clear(k, time, phase)
            off_until = self._off_until[k]
            if off_until is not None and off_until <= time:
                self._off_until[k] = None
                self._connect(k, phase)

    @property
    def next_change(self) -> float:
        """When a supply changes next; infinite where none does. [s]"""
        begins = (w[0].begins for w in self._waiting if w)
        looks = (c.next for c in self._clearings if c is not None)
        off = (t for t in self._off_until if t is not None)
        return min([*begins, *looks, *off], default=math.inf)

    def apply_field(self, phase: Floats) -> None:
        """The discharge resistor is taken out of each field, and the exciter put in."""
        for k, m in enumerate(self._machines):
            if m.excited is not None:
                circuit, voltage = m.excited
                machine = replace(m.machine, circuit=circuit)
                self._machines[k] = replace(m, machine=machine, field_voltage=voltage)
                self._connect(k, phase)

    def switch_over(self, time: float, opened: Mapping[int, float], phase: Floats) -> None:
        """Each motor to its next source; the currents of its windings go on unless it is off the line first.

        `opened` says how long which motors are. [s]
        """
        for k, sources in enumerate(self._sources):
            if k in opened:
                self._off_until[k] = time + opened[k]
            sources.pop(0)
            self._connect(k, phase)

    def turn_field(self, k: int, phase: Floats) -> None:
        """The current of a field has changed its sign, and the resistance of its circuit with it."""
        self._against[k] = not self._against[k]
        self._connect(k, phase)

    def trip(self, phase: Floats) -> None:
        """The breakers of all motors open for good; what happens to the line reaches none any more."""
        for k, waiting in enumerate(self._waiting):
            waiting.clear()
            self._clearings[k] = None
            self._off_until[k] = math.inf
            self._connect(k, phase)

    def _clear(self, k: int, time: float, phase: Floats) -> None:
        """Phases whose currents are zero by then."""
        m, clearing = self._machines[k], self._clearings[k]
        while clearing is not None and clearing.next <= time:
            begins = m.supplies[-2].begins
            currents = {p: self._current(k, p, time - begins, phase) for p in clearing.waiting}
            if time >= clearing.latest:  # then the breaker interrupts what flows
                clearing.cleared = list(m.poles)
            elif not clearing.met(time, currents):
                continue
            has_impedance = any(source.has_impedance for source in m.sources)
            supply = cleared_supply(time, clearing.cleared, m.poles, has_impedance=has_impedance)
            self._present[k] = supply.turned_by(m.machine.line_omega * begins)
            self._connect(k, phase)
            if len(clearing.cleared) == len(m.poles):
                self._clearings[k] = clearing = None

    def _current(self, k: int, axis: float, since: float, phase: Floats) -> float:
        """Along an axis of the stator, which the voltage of the line had at the event, so long ago. [pu, s]"""
        m = self._machines[k]
        i_d, i_q = (
            float(x)
            for x in product(self._arrays["current"][k][:, : len(self._flux(k))], self._flux(k))
        )
        angle = m.machine.line_omega * since - (0.5 * float(phase[k]) + m.ahead) - axis
        return float(i_d * cos(angle) - i_q * sin(angle))

    def _flux(self, k: int) -> Floats:
        return np.asarray(self._arrays["flux"][k, : self._arrays["n_flux"][k]].copy())

    def _connect(self, k: int, phase: Floats) -> None:
        """The stator to what feeds it now; the currents of all windings go on where it stays closed."""
        arrays, m, source = self._arrays, self._machines[k], self._sources[k][0]
        off = self._off_until[k] is not None
        supply = Supply(0.0, is_open=True) if off else self._present[k]
        bare = supply.at_terminals or supply.axis is not None
        whole = m.machine.circuit if bare else source.before(m.machine.circuit)
        circuit = whole.polarities[self._against[k]]
        flux = with_same_currents(self._circuits[k], circuit, self._flux(k))
        self._circuits[k] = circuit
        machine = replace(m.machine, circuit=circuit)
        axis = -(0.5 * float(phase[k]) + m.ahead)
        supply, flux = switched(machine, supply, MachineState(flux, m.field_voltage, axis), flux)
        # equations of a rotor at rest, to which the loop adds its motion
        system = flux_system(
            circuit, machine.line_omega, 0.0, m.field_voltage, is_open=supply.is_open
        )
        n = len(flux)
        arrays["n_flux"][k], arrays["q"][k], arrays["stator"][k] = n, system.q, not supply.is_open
        arrays["rate"][k, :n, :n], arrays["current"][k, :, :n] = system.rate, system.stator_current
        arrays["field"][k, :n], arrays["flux"][k, :n] = system.field, flux
        for name, (size, angle) in (("forward", supply.forward), ("backward", supply.backward)):
            arrays[name][k] = source.voltage * size, angle + m.ahead
        arrays["unlike"][k] = supply.axis is not None
        if supply.axis is not None:
            arrays["axis"][k] = supply.axis + m.ahead
            arrays["rows"][k] = terminal_rows(supply, source, machine.line_omega)
        if whole.reverse_resistance is None:
            arrays["watched"][k] = 0
        elif circuit.field is not None:  # its current keeps its sign
            arrays["watched"][k] = 1
            arrays["watch"][k, :n] = (-1.0 if self._against[k] else 1.0) * system.current[1]
        else:  # nor does its voltage, the rate of its flux, let a current flow
            arrays["watched"][k] = 2
            arrays["watch"][k, :n] = field_flux(circuit, whole) / machine.line_omega


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
        stages = [
            next(s for s in sheet.stages if s.connection.until > speed).connection.source
            for speed in above
        ]
        voltage = -1
        if motor.line_voltage is not None:
            voltage = n_curves - len(supplied)
            voltage += next(i for i, m in enumerate(supplied) if m is motor)
        scale = math.sqrt(motor.scale)
        machines.append(
            MachineInTime(
                Machine(sheet.starting, sheet.torque_base, sheet.synchronous_speed, omega),
                (Supply(0.0),),
                np.zeros(number_of_fluxes(sheet.starting)),
                # half the phase is the angle of the line ahead of axis q
                ahead=0.5 * math.pi,
                voltage=voltage,
                ramp=None if motor.soft is None else motor.soft.ramp,
                excited=_excited(case, sheet) if effects.pull_in else None,
                sources=tuple(replace(s, voltage=scale * s.voltage) for s in stages),
            )
        )
    return tuple(machines)


def _excited(case: CaseData, sheet: MotorFromData) -> tuple[Circuit, float] | None:
    """The circuit with its field applied, and the voltage of the field."""
    factor = 1.0 if sheet.sheet.start_factor is None else sheet.sheet.start_factor
    running = starting_circuit(sheet.circuit, factor=factor)
    if running.field is None:
        return None
    # PullOutTorque = E V / Xd at rated voltage, E = Xmd if
    xd = running.stator_leakage + running.magnetising_d
    emf = (case.pull_out_torque or 0.0) / sheet.torque_base * xd
    return running, running.field.resistance * emf / running.magnetising_d
