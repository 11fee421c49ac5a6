"""The two-axis machine in time: fluxes against voltages, in axes that turn with the rotor.

    dψ/dt = ω₀ (u − R i + ω W ψ),   i = Y ψ,   T = ψd iq − ψq id

W takes ψq to axis d and −ψd to axis q (Park, Trans. AIEE 48, 1929, 716-727). At one speed ω this is linear with
constant coefficients; what the rotor does beyond that speed acts like voltages. With the stator open its currents
are zero and its fluxes follow those of the rotor's windings.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from engine.arrays import Floats
from engine.errors import ModelError
from engine.motor.circuit import Circuit, Winding
from engine.numerics.same_bits import atan2, cos, half_and_whole, hypot, product, sin, solve


@dataclass(frozen=True, eq=False)
class FluxSystem:
    """dψ/dt = rate ψ + voltage (ud, uq) + field. Fluxes: axis d (stator, field, dampers), then axis q."""

    q: int  #: Which flux is that of the stator's axis q. [index]
    current: Floats  #: Currents of the windings. [1] Shape (n, n).
    rate: Floats  #: [1/s] Shape (n, n).
    voltage: Floats  #: Of the stator's voltages; zero while it is open. [1/s] Shape (n, 2).
    field: Floats  #: From the voltage of the field. [1/s] Shape (n,).

    @cached_property
    def stator_current(self) -> Floats:
        """Currents of the stator's axes from fluxes. [1] Shape (2, n)."""
        return self.current[[0, self.q]]

    @cached_property
    def current_rate(self) -> Floats:
        """Rates of these per flux, from the field, and per voltage. [1/s] Shape (2, n + 3)."""
        drives = np.column_stack([self.rate, self.field, self.voltage])
        return np.asarray(product(self.stator_current, drives))


@dataclass(frozen=True, eq=False)
class MachineState:
    """Fluxes of a machine, and where its rotor stands."""

    flux: Floats  #: In the order of `FluxSystem`. [pu] Shape (n,).
    field_voltage: float  #: [pu]
    angle: float  #: Of axis d ahead of the voltage of the line. [rad]


def _windings(circuit: Circuit) -> tuple[tuple[Winding, ...], tuple[Winding, ...]]:
    """Windings of the rotor on both axes, the field first."""
    field = () if circuit.field is None else (circuit.field,)
    return (*field, *circuit.dampers_d), circuit.dampers_q


@lru_cache(maxsize=64)
def _reactances(circuit: Circuit) -> Floats:
    """Fluxes from currents."""
    axes = []
    of_d, of_q = _windings(circuit)
    for magnetising, common, windings in (
        (circuit.magnetising_d, circuit.common_leakage_d, of_d),
        (circuit.magnetising_q, 0.0, of_q),
    ):
        x = np.full((1 + len(windings),) * 2, magnetising)
        x[1:, 1:] += common
        axes.append(x + np.diag([circuit.stator_leakage, *(w.leakage for w in windings)]))
    n = len(axes[0])
    together = np.zeros((n + len(axes[1]),) * 2)
    together[:n, :n], together[n:, n:] = axes
    return together


def number_of_fluxes(circuit: Circuit) -> int:
    """Fluxes of a machine: of both axes of the stator, and of each winding of the rotor.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]

    Returns
    -------
    int
        [count]
    """
    return 2 + sum(map(len, _windings(circuit)))


def with_same_currents(circuit: Circuit, other: Circuit, flux: Floats) -> Floats:
    """Fluxes just after a circuit has become another: currents stay; a field that is or was open has none.

    Parameters
    ----------
    circuit : Circuit
        The motor so far. [pu]
    other : Circuit
        The same with its field closed, or another impedance before its stator. [pu]
    flux : ndarray, shape (n,) or (n, n_times)
        Fluxes so far. [pu]

    Returns
    -------
    ndarray
        [pu]
    """
    if circuit == other:
        return flux
    before, after = _reactances(circuit), _reactances(other)
    current = solve(before, flux.reshape(len(before), -1))
    if len(after) > len(before):
        current = np.insert(current, 1, 0.0, axis=0)
    elif len(after) < len(before):
        current = np.delete(current, 1, axis=0)
    return np.asarray(product(after, current).reshape(len(after), *flux.shape[1:]))


def field_flux(circuit: Circuit, closed: Circuit) -> Floats:
    """Flux of an open field from the others.

    Parameters
    ----------
    circuit : Circuit
        With the field open. [pu]
    closed : Circuit
        The same with its field. [pu]

    Returns
    -------
    ndarray, shape (n,)
        Row that the fluxes are multiplied by. [1]
    """
    return np.asarray(with_same_currents(circuit, closed, np.eye(number_of_fluxes(circuit)))[1])


@lru_cache(maxsize=64)
def flux_system(
    circuit: Circuit, line_omega: float, speed: float, field_voltage: float, *, is_open: bool
) -> FluxSystem:
    """The equations of the fluxes while the rotor turns with one speed.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    line_omega : float
        Angular frequency of the line. [rad/s]
    speed : float
        Of the rotor over synchronous speed. [1]
    field_voltage : float
        Voltage of the field, referred to the stator. [pu]
    is_open : bool
        No current flows in the stator. [flag]

    Returns
    -------
    FluxSystem
        [1/s]
    """
    of_d, of_q = _windings(circuit)
    x, q = _reactances(circuit), 1 + len(of_d)
    n = len(x)
    stator, rotor = [0, q], [i for i in range(n) if i not in (0, q)]
    field, voltage = np.zeros(n), np.zeros((n, 2))
    if circuit.field is not None:
        field[1] = line_omega * field_voltage
    resistance = np.full(n, circuit.stator_resistance)
    resistance[rotor] = [w.resistance for w in (*of_d, *of_q)]
    current = np.zeros((n, n))
    if is_open:
        if rotor:
            current[np.ix_(rotor, rotor)] = solve(x[np.ix_(rotor, rotor)], np.eye(len(rotor)))
        follows = product(x, current)  # of the stator, from the rotor's fluxes
        follows[rotor] = np.eye(n)[rotor]
        rate = product(follows, -line_omega * resistance[:, None] * current)
        return FluxSystem(q, current, rate, voltage, product(follows, field))
    current = solve(x, np.eye(n))
    voltage[stator, [0, 1]] = line_omega
    rate = -line_omega * resistance[:, None] * current
    rate[0, q] += line_omega * speed
    rate[q, 0] -= line_omega * speed
    return FluxSystem(q, current, rate, voltage, field)


def opened(circuit: Circuit, flux: Floats) -> Floats:
    """Fluxes just after the stator's currents have been cut off: those of the rotor stay.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    flux : ndarray, shape (n,)
        Fluxes just before. [pu]

    Returns
    -------
    ndarray, shape (n,)
        [pu]
    """
    system = flux_system(circuit, 1.0, 0.0, 0.0, is_open=True)
    after = flux.copy()
    after[[0, system.q]] = product(_reactances(circuit), product(system.current, flux))[
        [0, system.q]
    ]
    return after


def running_state(circuit: Circuit, torque: float, power_factor: float) -> MachineState:
    """The machine in step on its line, with constant fluxes.

    Parameters
    ----------
    circuit : Circuit
        The motor, with a field. [pu]
    torque : float
        Air-gap torque; positive drives. [pu]
    power_factor : float
        Of the current, which lags where it is positive and leads where it is negative. [1]

    Returns
    -------
    MachineState
        [pu]

    Raises
    ------
    ModelError
        If the machine has no field, or its torque does not reach so far.
    """
    if circuit.field is None:
        raise ModelError("has no field winding, which keeps it in step")
    resistance, share = circuit.stator_resistance, abs(power_factor)
    room = share * share - 4.0 * resistance * torque  # T = U I cos φ − R I²
    if share == 0.0 or room < 0.0:
        raise ModelError(
            f"does not carry its torque in operation, {torque:.4g} pu, at power factor {share:g}"
        )
    active = 2.0 * torque * share / (share + math.sqrt(room))
    reactive = -math.copysign(abs(active) * math.sqrt(1.0 - share * share) / share, power_factor)
    x, xq = _reactances(circuit), circuit.stator_leakage + circuit.magnetising_q
    # E_Q = U − (R + j Xq) I
    real = 1.0 - resistance * active + xq * reactive
    imag = -resistance * reactive - xq * active
    delta, quarter = atan2(imag, real), 0.5 * math.pi
    angle = delta - quarter
    # voltage and current in the rotor's axes: turned by −angle
    c, s = cos(angle), sin(angle)
    i_d, i_q = active * c + reactive * s, reactive * c - active * s
    u_q = -s
    xd = circuit.stator_leakage + circuit.magnetising_d
    i_f = (u_q - resistance * i_q - xd * i_d) / circuit.magnetising_d
    current = np.zeros(len(x))
    current[0], current[1], current[1 + len(_windings(circuit)[0])] = i_d, i_f, i_q
    return MachineState(product(x, current), circuit.field.resistance * i_f, angle)


def slipping_state(circuit: Circuit, slip: float) -> MachineState:
    """A motor without field that turns steadily with a slip, when the voltage of the line lies along its axis d.

    Its fluxes turn in its axes with slip frequency, j s Ψ = A Ψ + B U; with equal axes its torque is constant.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    slip : float
        0 in step, negative above synchronous speed. [1]

    Returns
    -------
    MachineState
        [pu]
    """
    system = flux_system(circuit, 1.0, 1.0 - slip, 0.0, is_open=False)
    n = len(system.rate)
    # U = (1, −j); real parts above, imaginary ones below
    both = np.zeros((2 * n, 2 * n))
    both[:n, :n] = both[n:, n:] = -system.rate
    both[:n, n:], both[n:, :n] = -slip * np.eye(n), slip * np.eye(n)
    driven = np.concatenate([system.voltage[:, 0], -system.voltage[:, 1]])
    return MachineState(np.asarray(solve(both, driven[:, None])[:n, 0]), 0.0, 0.0)


def open_circuit_state(circuit: Circuit, voltage: float, angle: float) -> MachineState:
    """The machine in step with its stator open.

    Parameters
    ----------
    circuit : Circuit
        The motor, with a field. [pu]
    voltage : float
        At its terminals. [pu]
    angle : float
        Of that voltage ahead of the line's. [rad]

    Returns
    -------
    MachineState
        [pu]

    Raises
    ------
    ModelError
        If the machine has no field.
    """
    if circuit.field is None:
        raise ModelError("has no field winding, which gives it a voltage with an open stator")
    x = _reactances(circuit)
    current = np.zeros(len(x))
    current[1] = voltage / circuit.magnetising_d
    return MachineState(
        product(x, current), circuit.field.resistance * current[1], angle - 0.5 * math.pi
    )


def residual_voltage(circuit: Circuit, flux: Floats) -> tuple[float, float]:
    """Voltage of an open stator that turns at synchronous speed, u = j ψ.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    flux : ndarray, shape (n,)
        Fluxes with an open stator. [pu]

    Returns
    -------
    size, angle : float
        Its magnitude, and its angle ahead of axis d. [pu, rad]
    """
    d, q = float(flux[0]), float(flux[1 + len(_windings(circuit)[0])])
    return hypot(d, q), atan2(d, -q)


def air_gap_torque(system: FluxSystem, flux: Floats) -> Floats:
    """Torque of fluxes, T = ψd iq − ψq id.

    Parameters
    ----------
    system : FluxSystem
        The machine. [pu]
    flux : ndarray, shape (n, n_times)
        Fluxes. [pu]

    Returns
    -------
    ndarray, shape (n_times,)
        [pu]
    """
    i_d, i_q = product(system.stator_current, flux)
    return np.asarray(flux[0] * i_q - flux[system.q] * i_d)


def torque_rate(system: FluxSystem, flux: Floats, slope: Floats) -> Floats:
    """How fast the torque of fluxes changes.

    Parameters
    ----------
    system : FluxSystem
        The machine. [pu]
    flux, slope : ndarray, shape (n, n_times)
        Fluxes and their rates. [pu, pu/s]

    Returns
    -------
    ndarray, shape (n_times,)
        [pu/s]
    """
    (i_d, i_q), (r_d, r_q) = (product(system.stator_current, a) for a in (flux, slope))
    q = system.q
    return np.asarray(slope[0] * i_q + flux[0] * r_q - slope[q] * i_d - flux[q] * r_d)


class FluxStep(NamedTuple):
    """Exact step of the fluxes; voltages are a + b s + c s² over a whole step, 0 ≤ s ≤ 1. [1]"""

    free: Floats  #: From the fluxes before. Shape (n, n).
    forced: Floats  #: From a, b and c of each axis. Shape (n, 2, 3).
    steady: Floats  #: From the field. Shape (n,).


def flux_steps(system: FluxSystem, h: float) -> tuple[FluxStep, FluxStep]:
    """Exact steps of the fluxes under voltages that are parabolas (Van Loan's block exponential).

    Parameters
    ----------
    system : FluxSystem
        The machine. [pu]
    h : float
        Step. [s]

    Returns
    -------
    half, whole : FluxStep
        To the middle of the step, and to its end. [1]
    """
    n = len(system.rate)
    a = np.zeros((n + 7, n + 7))  # fluxes, voltages and their two derivatives, field
    a[:n, :n] = h * system.rate
    a[:n, n : n + 2] = h * system.voltage
    a[n : n + 2, n + 2 : n + 4] = a[n + 2 : n + 4, n + 4 : n + 6] = np.eye(2)
    a[:n, n + 6] = h * system.field
    factor = np.array([1.0, 1.0, 2.0])
    half, whole = (
        FluxStep(
            step[:n, :n],
            step[:n, n : n + 6].reshape(n, 3, 2).swapaxes(1, 2) * factor,
            step[:n, n + 6],
        )
        for step in half_and_whole(a)
    )
    return half, whole
