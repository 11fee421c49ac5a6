"""A train with one motor in time: modes and fluxes of the motor advance together (`kernels/machine.c`).

The train is in balance with a constant torque of the motor; motion is what its real torque adds. Voltages
turn with the line and against it, and change at given times only: a fault is a line without voltage, one of
two lines a voltage of which half turns against the line, an open breaker a stator without current. Between two
such times the fluxes and the modes are linear but for what couples them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from engine.arrays import Floats
from engine.errors import InternalError
from engine.motor.circuit import Circuit
from engine.motor.supply import STIFF, Source
from engine.motor.two_axis import (
    FluxSystem,
    MachineState,
    air_gap_torque,
    flux_steps,
    flux_system,
    opened,
    residual_voltage,
    torque_rate,
    with_same_currents,
)
from engine.numerics.same_bits import cos, product, sin
from engine.start.time_response import ModalSystem, TimeResponse, coupled_step
from engine.stepping.exponential import polynomial_step
from engine.stepping.library import address, library, struct

#: Modal positions, velocities and fluxes. [SI, pu]
State = tuple[Floats, Floats, Floats]
#: Coefficients of 1, s and s² of the parabola through values at s = 0, 1/2 and 1.
PARABOLA = np.array([[1.0, 0.0, 0.0], [-3.0, 4.0, -1.0], [2.0, -4.0, 2.0]])
#: The same in the middle of a step: s of the step is half of that of its first half.
HALVED = np.array([1.0, 0.5, 0.25])


@dataclass(frozen=True)
class Machine:
    """A motor on its station."""

    circuit: Circuit  #: [pu]
    torque_base: float  #: 1 per unit of torque. [N m]
    synchronous_speed: float  #: Of its station. [rad/s]
    line_omega: float  #: Angular frequency of the line. [rad/s]
    source: Source = STIFF  #: What feeds it; voltages of supplies are over that of it. [pu]

    def behind(self, supply: Supply) -> Circuit:
        """The motor with what stands before all of its stator. [pu]"""
        bare = supply.at_terminals or supply.is_open or supply.axis is not None
        return self.circuit if bare else self.source.before(self.circuit)

    @property
    def pole_pairs(self) -> float:
        """Electrical over mechanical angle. [1]"""
        return self.line_omega / self.synchronous_speed


@dataclass(frozen=True)
class Supply:
    """What the stator is connected to, from some time on."""

    begins: float  #: [s]
    #: Voltage that turns with the line: its magnitude, and its angle ahead of the line before. [pu, rad]
    forward: tuple[float, float] = (1.0, 0.0)
    #: Voltage that turns against the line: its magnitude, and its angle at t = 0. [pu, rad]
    backward: tuple[float, float] = (0.0, 0.0)
    is_open: bool = False  #: No current flows.
    #: Angle at t = 0 of an axis of the stator that is connected unlike the one across it; None: they are alike. [rad]
    axis: float | None = None
    #: Share of the source's voltage and impedance along that axis and across it; 0: that one is shorted. Without `forward`
    #: no current flows along the first. [1]
    shares: tuple[float, float] = (1.0, 0.0)
    at_terminals: bool = (
        False  #: What happens is at the terminals: no impedance of a source is before the stator.
    )
    #: Where it closes an open stator: voltage at the terminals before, and its angle ahead of the line's.
    #: None: the voltage and the angle that the motor has by then. [pu, rad]
    residual: float | None = None
    ahead: float | None = None  #: Likewise. [rad]

    def turned_by(self, angle: float) -> Supply:
        """The same where the line has turned so far by the instant from which its angles count. [rad]"""
        size, against = self.backward
        axis = None if self.axis is None else self.axis + angle
        return replace(self, backward=(size, against + 2.0 * angle), axis=axis)


class Balance(NamedTuple):
    """What the train turns under when nothing happens."""

    torque: float  #: Of the motor. [N m]
    speed: float = 1.0  #: Of the rotor, over synchronous speed. [1]


@dataclass(frozen=True, eq=False)
class MachineMotion:
    """Motion of a train and torque of its motor. Two samples share the time of a change of the supply."""

    time: Floats  #: [s] Shape (n_times,).
    q: Floats  #: Modal positions. [rad √(kg m²)] Shape (n_kept, n_times).
    v: Floats  #: Modal velocities. [rad √(kg m²)/s] Shape (n_kept, n_times).
    rotor: Floats  #: Angle of the rotor beyond that in balance. [rad] Shape (n_times,).
    flux: Floats  #: Of the motor alone, in the order of `FluxSystem`. [pu] Shape (n_flux, n_times).
    torque: Floats  #: Air-gap torque and its rate. [N m, N m/s] Shape (n_times,).
    torque_rate: Floats  #: Likewise. [N m/s] Shape (n_times,).

    def response(self, system: ModalSystem, held: float) -> TimeResponse:
        """What it does to stations and elements; `held` of the torque is balanced before. [N m]"""
        rows = system.room_for(len(self.time))
        rows[: len(self.q), 0], rows[: len(self.v), 1] = self.q, self.v
        return system.response(
            self.time, rows, lambda: (self.torque[None] - held, self.torque_rate[None])
        )


def machine_motion(
    system: ModalSystem,
    machine: Machine,
    supplies: Sequence[Supply],
    state: MachineState,
    end: float,
    step: float,
    *,
    balance: Balance,
    before: tuple[Floats, Floats] | None = None,
) -> MachineMotion:
    """Motion from a given state.

    Parameters
    ----------
    system : ModalSystem
        The train under one force, the torque of the motor. [SI]
    machine : Machine
        The motor. [pu, SI]
    supplies : sequence of Supply
        What it is connected to, rising in time, the first from 0 on. [pu, rad]
    state : MachineState
        Fluxes at t = 0, axis d there, and the voltage of the field. [pu, rad]
    end : float
        Last time. [s]
    step : float
        Longest step. [s]
    balance : Balance
        Torque and speed of the motor with which the train is in balance. [N m, 1]
    before : tuple of ndarray, shape (n_kept,), optional
        Modal positions and velocities at t = 0; default zero. [SI]

    Returns
    -------
    MachineMotion
        At the ends of the steps. [SI]
    """
    n = len(system.omega)
    now = (*(before or (np.zeros(n), np.zeros(n))), state.flux)
    parts: list[MachineMotion] = []
    ends = [*(s.begins for s in supplies[1:]), end]
    for supply, last in zip(supplies, ends, strict=True):
        stretch, now = stretch_of(system, machine, supply, state, now, balance)
        if supply.begins >= min(last, end):  # an open breaker that closes at once
            continue
        parts.append(stretch.motion(now, min(last, end), step))
        now = parts[-1].q[:, -1], parts[-1].v[:, -1], parts[-1].flux[:, -1]
    return MachineMotion(
        *(np.concatenate([getattr(p, name) for p in parts], axis=-1) for name in FIELDS)
    )


def stretch_of(
    system: ModalSystem,
    machine: Machine,
    supply: Supply,
    state: MachineState,
    now: State,
    balance: Balance,
) -> tuple[Stretch, State]:
    """The equations from a change of the supply on, and the state just after it.

    Parameters
    ----------
    system : ModalSystem
        The train under one force, the torque of the motor. [SI]
    machine : Machine
        The motor. [pu, SI]
    supply : Supply
        What it is connected to from now on. [pu, rad]
    state : MachineState
        As for `machine_motion`. [pu, rad]
    now : tuple of ndarray
        Modal positions, velocities and fluxes just before. [SI, pu]
    balance : Balance
        As for `machine_motion`. [N m, 1]

    Returns
    -------
    stretch : Stretch
        [mixed]
    now : tuple of ndarray
        Likewise, just after. [SI, pu]
    """
    held, speed = balance
    turned = machine.pole_pairs * float(product(system.reach[:, 0], now[0]))
    supply, flux = switched(machine, supply, state, now[2], turned=turned, speed=speed)
    voltage = machine.source.voltage
    supply = replace(
        supply,
        forward=(voltage * supply.forward[0], supply.forward[1]),
        backward=(voltage * supply.backward[0], supply.backward[1]),
    )
    fluxes = flux_system(
        machine.behind(supply),
        machine.line_omega,
        speed,
        state.field_voltage,
        is_open=supply.is_open,
    )
    stretch = Stretch(system, machine, fluxes, supply, state.angle, held, speed)
    return stretch, (*now[:2], flux)


def switched(
    machine: Machine,
    supply: Supply,
    state: MachineState,
    flux: Floats,
    *,
    turned: float = 0.0,
    speed: float = 1.0,
) -> tuple[Supply, Floats]:
    """A supply with its angle known, and the fluxes just after the motor is connected to it.

    Parameters
    ----------
    machine : Machine
        The motor. [pu, SI]
    supply : Supply
        What it is connected to from now on. [pu, rad]
    state : MachineState
        As for `machine_motion`. [pu, rad]
    flux : ndarray, shape (n_flux,)
        Fluxes just before. [pu]
    turned : float
        Electrical angle of the rotor beyond that in balance. [rad]
    speed : float
        Of the rotor in balance, over synchronous speed. [1]

    Returns
    -------
    supply : Supply
        [pu, rad]
    flux : ndarray, shape (n_flux,)
        [pu]
    """
    if supply.is_open:
        return supply, opened(machine.circuit, flux)
    if supply.residual is None and supply.ahead is None:
        return supply, flux
    size, angle = residual_voltage(machine.circuit, flux)
    if supply.residual is not None:
        flux = flux * (supply.residual / size)
    if supply.ahead is not None:
        lost = (speed - 1.0) * machine.line_omega * supply.begins
        of_line = angle + state.angle + turned + lost - supply.ahead
        supply = replace(supply, forward=(supply.forward[0], of_line))
    return supply, flux


FIELDS = tuple(MachineMotion.__dataclass_fields__)


@dataclass(frozen=True, eq=False)
class Stretch:
    """Equations between two changes of the supply."""

    system: ModalSystem  #: The train. [SI]
    machine: Machine  #: The motor. [pu, SI]
    fluxes: FluxSystem  #: Fluxes of it with what stands before its stator. [pu]
    supply: Supply  #: What it is connected to, its angle known. [pu, rad]
    angle: float  #: Of axis d at t = 0, the train in balance. [rad]
    held: float  #: Torque with which the train is in balance. [N m]
    speed: float  #: Of the axes, over synchronous speed. [1]

    def motion(self, now: State, end: float, step: float, prepared: Any = None) -> MachineMotion:
        """Motion in equal steps.

        Parameters
        ----------
        now : tuple of ndarray
            Modal positions, velocities and fluxes at its beginning. [SI, pu]
        end : float
            Last time. [s]
        step : float
            Longest step. [s]
        prepared : cdata, optional
            As `prepared` gives it for the step that follows, from a stretch with the same fluxes. [struct]

        Returns
        -------
        MachineMotion
            At the ends of the steps. [SI]
        """
        system, begins = self.system, self.supply.begins
        count = max(math.ceil((end - begins) / step * (1.0 - 1e-9)), 1)
        h = (end - begins) / count
        n, block = len(system.omega), _block(system)
        n_blocks = n // block
        states = np.empty((count + 1, 2 * n))
        flux = np.empty((count + 1, len(now[2])))
        states[0] = np.stack([a.reshape(-1, block) for a in now[:2]], axis=1).ravel()
        circuit, behind = self.machine.circuit, self.machine.behind(self.supply)
        flux[0] = with_same_currents(circuit, behind, now[2])
        described = self.prepared(h) if prepared is None else prepared
        described.angle, described.axis = self.angle, self.supply.axis or 0.0
        described.forward[0:2], described.backward[0:2] = self.supply.forward, self.supply.backward
        room = np.empty(library.machine_room(described))
        made = library.advance_machine(
            count, begins, h, described, *map(address, (states, flux, room))
        )
        if made < count:
            raise InternalError(f"torque and motion of a motor did not settle in a step of {h:g} s")
        time = np.linspace(begins, end, count + 1)
        by_block = states.reshape(count + 1, n_blocks, 2, block)
        q, v = by_block.transpose(2, 1, 3, 0).reshape(2, n, count + 1)
        flux = np.ascontiguousarray(flux.T)
        reach = system.reach[:, 0]
        rotor = product(reach, q)
        slope = self._flux_rate(time, rotor, product(reach, v), flux)
        base = self.machine.torque_base
        torque, rate = air_gap_torque(self.fluxes, flux), torque_rate(self.fluxes, flux, slope)
        flux = with_same_currents(behind, circuit, flux)
        return MachineMotion(time, q, v, rotor, flux, base * torque, base * rate)

    def prepared(self, h: float) -> Any:
        """``machine_t`` for steps of one length, but for angles and voltages of the supply and the angle of the rotor."""
        machine, fluxes, block = self.machine, self.fluxes, _block(self.system)
        (half, pushed), (free, forced) = _train_steps(self.system, block, h)
        rotor = _rotor_rows(self.system, block)
        maps = flux_steps(fluxes, h)
        voltages = np.stack([m.forced for m in maps])
        arrays = {
            "free": free,
            "forced": _at_points(forced),
            "rotor": rotor,
            "rotor_free": np.concatenate([_rows_times(rotor, half), _rows_times(rotor, free)]),
            "rotor_forced": np.concatenate(
                [product(rotor, _at_points(p).reshape(-1, 3)) for p in (pushed, forced)]
            ),
            "flux_free": np.stack([m.free for m in maps]),
            "flux_forced": _at_points(voltages).swapaxes(-1, -2),
            "flux_steady": np.stack([m.steady for m in maps]),
            "current": fluxes.stator_current,
        }
        if self.supply.axis is not None:
            arrays["current_rate"] = fluxes.current_rate
            arrays["rows"] = terminal_rows(self.supply, machine.source, machine.line_omega)
        return struct(
            "machine_t",
            **{name: np.ascontiguousarray(a) for name, a in arrays.items()},
            n_blocks=len(free), block=2 * block, n_flux=len(fluxes.rate), q=fluxes.q,
            line_omega=machine.line_omega, axes_speed=self.speed, pole_pairs=machine.pole_pairs,
            torque_base=machine.torque_base, held=self.held,
        )  # fmt: skip

    def _flux_rate(self, time: Floats, rotor: Floats, speed: Floats, flux: Floats) -> Floats:
        """Rates of the fluxes from their equations; angle and speed of the rotor are those beyond balance."""
        machine, supply, fluxes = self.machine, self.supply, self.fluxes
        turned = self.angle + machine.pole_pairs * rotor
        beyond = speed / machine.synchronous_speed
        line = machine.line_omega * time
        moved = np.stack([beyond * flux[fluxes.q], -beyond * flux[0]])
        ahead = supply.forward[1] + (1.0 - self.speed) * line - turned
        if supply.axis is not None:
            axis = supply.axis - self.speed * line - turned
            u_d, u_q = self._unlike_voltages(axis, ahead, beyond, moved, flux)
        else:
            back = supply.backward[1] - (1.0 + self.speed) * line - turned
            u_d, u_q = np.zeros((2, len(time)))
            for size, angle in ((supply.forward[0], ahead), (supply.backward[0], back)):
                if size:
                    u_d, u_q = u_d + size * cos(angle), u_q + size * sin(angle)
        u_d, u_q = u_d + moved[0], u_q + moved[1]
        slope = product(fluxes.rate, flux) + product(fluxes.voltage, np.stack([u_d, u_q]))
        return np.asarray(slope + fluxes.field[:, None])

    def _unlike_voltages(
        self, axis: Floats, ahead: Floats, beyond: Floats, moved: Floats, flux: Floats
    ) -> Floats:
        """Voltages of both axes where those of the stator are connected unlike, as in `kernels/machine.c`."""
        fluxes, n, machine = self.fluxes, len(flux), self.machine
        c, s = cos(axis), sin(axis)
        along = np.array([[c, s], [-s, c]])
        of, current = fluxes.current_rate, product(fluxes.stator_current, flux)
        rate = product(of[:, :n], flux) + of[:, n : n + 1] + product(of[:, n + 1 :], moved)
        turning = machine.line_omega * (self.speed + beyond)
        rate += turning * np.stack([-current[1], current[0]])
        size, gains = self.supply.forward[0], of[:, n + 1 :]
        source = np.stack([size * cos(ahead), size * sin(ahead)])
        g, left = np.zeros((2, 2, len(axis))), []
        for k, (own, inductance, share, resistance) in enumerate(
            terminal_rows(self.supply, machine.source, machine.line_omega)
        ):
            drop = resistance * current + inductance * rate
            left.append((along[k] * (share * source - drop)).sum(axis=0))
            for j in range(2):
                gain = (along[k] * product(gains, along[j])).sum(axis=0)
                g[k, j] = (own if k == j else 0.0) + inductance * gain
        whole = g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0]
        first = (left[0] * g[1, 1] - g[0, 1] * left[1]) / whole
        second = (g[0, 0] * left[1] - left[0] * g[1, 0]) / whole
        return np.asarray(first * along[0] + second * along[1])


def terminal_rows(supply: Supply, source: Source, line_omega: float) -> Floats:
    """What the terminals of two axes of the stator are connected to, p u + x di/dt = m e − r i along each.

    Parameters
    ----------
    supply : Supply
        With an axis. [pu, rad]
    source : Source
        What is before them. [pu]
    line_omega : float
        Angular frequency of the line. [rad/s]

    Returns
    -------
    ndarray, shape (2, 4)
        p, x, m and r. [1, s, 1, 1]
    """
    reactance = source.reactance / line_omega
    rows = [(1.0, m * reactance, m, m * source.resistance) for m in supply.shares]
    if supply.forward[0] == 0.0:  # no current; one that steps leave decays
        rows[0] = (0.0, 1.0 / line_omega, 0.0, 1.0)
    return np.array(rows)


def _block(system: ModalSystem) -> int:
    """Modes that advance together: all where damping couples them, else each for itself."""
    return max(len(system.omega), 1) if system.coupled else 1


def _at_points(forced: Floats) -> Floats:
    """What coefficients of a parabola do, the last axis, as what its values at the points of a step do."""
    return np.asarray(product(forced.reshape(-1, 3), PARABOLA).reshape(forced.shape))


def _train_steps(system: ModalSystem, block: int, h: float) -> list[tuple[Floats, Floats]]:
    """Exact steps of the modes to the middle and to the end, under a torque that is a parabola over the whole step.

    A block of modes at a time, shapes (n_blocks, 2 block, 2 block) and (n_blocks, 2 block, 3).
    """
    omega, reach = system.omega, system.reach
    if system.coupled:
        coupled = coupled_step(omega, system.damping, reach, h, 3)
        return [(free[None], push[None, :, :, 0]) for free, push in coupled]
    rate = np.ascontiguousarray(np.diag(system.damping))
    steps = [polynomial_step(omega * omega, rate, share * h) for share in (0.5, 1.0)]
    return [
        (free, forced[:, :, :3] * (reach[:, :, None] * shares))
        for (free, forced), shares in zip(steps, (HALVED, np.ones(3)), strict=True)
    ]


def _rotor_rows(system: ModalSystem, block: int) -> Floats:
    """Angle and speed of the rotor from the modes, in the order of their blocks. Shape (2, 2 n)."""
    reach = system.reach[:, 0].reshape(-1, 1, block)
    rows = np.zeros((2, len(reach), 2, block))
    rows[0, :, :1] = rows[1, :, 1:] = reach
    return rows.reshape(2, -1)


def _rows_times(rows: Floats, blocks: Floats) -> Floats:
    """Rows times a matrix of blocks on its diagonal."""
    parts = np.split(rows, max(len(blocks), 1), axis=1)
    if not len(blocks):
        return rows
    return np.concatenate([product(r, b) for r, b in zip(parts, blocks, strict=True)], axis=1)
