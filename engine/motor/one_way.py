"""A motor that slips steadily while the resistance of its field circuit changes with the sign of the current.

Rotating diodes or a thyristor crowbar let the current of the field pass one way without the discharge resistor, or not at
all the other way. The fluxes then are linear with constant coefficients while the current keeps its sign, and periodic with
the slip. With τ = s ω₀ t, and τ₁ and τ₂ where the current begins to flow as in operation and where it ends,

    ψ(τ) = Re(Ψ± e^{jτ}) + e^{A± (τ − τ₁,₂)} y±,   (j − A±) Ψ± = B U

so that periodicity gives y for any two instants, and Newton's method the instants at which the current is zero. Where the
reverse path is open its current stays zero, the flux of the field follows the others, and the current begins to flow as
soon as its voltage, which is the rate of that flux, changes its sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from engine.arrays import Complexes, Floats
from engine.errors import ModelError
from engine.motor.circuit import Circuit
from engine.motor.two_axis import field_flux, flux_system
from engine.numerics.same_bits import (
    ComplexSystems,
    atan2,
    cos,
    matrix_exponentials,
    products,
    sin,
)

#: The reverse resistance goes from the forward one to its own by such ratios, each solution the first guess of the next. [1]
RATIO = 3.0
#: Where the reverse path is open, up to so many times the forward one before. [1]
NEARLY_OPEN = 1e3
#: Newton's method: rounds that it may take, and change of an instant, times the slip, that ends it: rounding grows as the
#: rates of the fluxes do, and the current of the field falls, with a smaller slip. [count, rad]
ROUNDS, SETTLED = 60, 1e-11
#: Steps of each polarity over which the torque is integrated, a power of two; the error falls with the fourth power. [count]
SAMPLES = 128
#: Current against its polarity that counts as rounding, over the largest one. [1]
AGAINST = 1e-6
TOO_OFTEN = (
    "The current of a field with a one-way discharge path changes its sign more than twice in a period of the slip. "
    "Check Discharge resistance and Discharge resistance reverse in table MotorData."
)


@dataclass(frozen=True, eq=False)
class SlipHarmonics:
    """Torque and currents at slips. All arrays have shape (n,)."""

    average: Floats  #: Mean torque. [pu]
    at_slip: Complexes  #: Torque at slip frequency, as P of Re(P e^{j s ω₀ t}). [pu]
    at_twice: Complexes  #: Torque at twice the slip frequency, likewise. [pu]
    current: Floats  #: True rms. [pu]
    line_current: Complexes  #: Part of line frequency. [pu]


@dataclass(frozen=True, eq=False)
class _Polarity:
    """The fluxes while the current of the field keeps its sign, one matrix a slip, with all fluxes."""

    rate: Floats  #: A. [1] Shape (count, n, n).
    pushed: Complexes  #: B U. [1] Shape (count, n).
    turning: Complexes  #: Fluxes that turn with the voltage. [pu] Shape (count, n).

    def turned(self, at: Floats) -> tuple[Floats, Floats]:
        """Those fluxes at angles, and their rates. [pu] Shapes (count, n, 1)."""
        return _parts(self.turning, at)


def _parts(phasor: Complexes, at: Floats) -> tuple[Floats, Floats]:
    """Re(Ψ e^{jτ}) and its rate, as columns."""
    c, s = cos(at)[:, None], sin(at)[:, None]
    value = phasor.real * c - phasor.imag * s
    rate = -phasor.real * s - phasor.imag * c
    return value[..., None], rate[..., None]


def _polarity(circuit: Circuit, whole: Circuit, slip: Floats) -> _Polarity:
    """Of a circuit that may lack the field of the whole one."""
    still, moving = (flux_system(circuit, 1.0, v, 0.0, is_open=False) for v in (0.0, 1.0))
    turn = moving.rate - still.rate
    rate = still.rate + (1.0 - slip)[:, None, None] * turn
    voltage = still.voltage
    if circuit.field is None:  # the flux of the field follows
        n = len(still.rate)
        keep = np.delete(np.eye(n + 1), 1, axis=0)
        embed = np.insert(np.eye(n), 1, field_flux(circuit, whole), axis=0)
        rate = products(products(embed[None], rate), keep[None])
        voltage = products(embed[None], voltage[None])[0]
    size = np.abs(slip)
    rate = rate / size[:, None, None]
    sense = np.where(slip > 0.0, 1.0, -1.0)
    pushed = (voltage[:, 0] - 1j * sense[:, None] * voltage[:, 1]) / size[:, None]
    matrix = (1j * np.eye(rate.shape[-1]) - rate).astype(np.complex128)
    turning = ComplexSystems(matrix).solve(pushed[..., None])[..., 0]
    return _Polarity(rate, pushed, turning)


@dataclass(frozen=True, eq=False)
class _Cycle:
    """A period: what is left to decay from each change of polarity on, and how the instants come nearer to zero current."""

    decaying: tuple[Floats, Floats]  #: y at τ₁ and at τ₂. [pu] Shapes (count, n, 1).
    step: tuple[Floats, Floats]  #: Newton's correction of τ₁ and τ₂. [rad] Shapes (count,).


def _cycle(
    forward: _Polarity,
    reverse: _Polarity,
    current: Floats,
    at: tuple[Floats, Floats],
    *,
    is_open: bool,
) -> _Cycle:
    """One round of Newton's method; `current` is the row of the field's current."""
    first, second = at
    width = second - first
    e_f = matrix_exponentials(forward.rate * width[:, None, None])
    e_r = matrix_exponentials(reverse.rate * (2.0 * math.pi - width)[:, None, None])
    (f1, of_f1), (f2, of_f2) = (forward.turned(t) for t in at)
    (r1, of_r1), (r2, of_r2) = (reverse.turned(t) for t in at)
    both = products(e_r, e_f)
    n = both.shape[-1]
    closed = ComplexSystems((np.eye(n) - both).astype(np.complex128))

    def solved(b: Floats) -> Floats:
        return np.asarray(closed.solve(b.astype(np.complex128)).real)

    y = solved(products(e_r, f2 - r2) - (f1 - r1))
    end = products(e_f, y)
    rest = f2 - r2 + end
    lost, gained = products(reverse.rate, products(e_r, rest)), products(forward.rate, end)
    by_first = solved(lost - products(e_r, gained) - (of_f1 - of_r1))
    by_second = solved(-lost + products(e_r, gained + (of_f2 - of_r2)))
    row = current[None, None]

    def along(x: Floats) -> Floats:
        return np.asarray(products(row, x)[:, 0, 0])

    here = row
    value_1, rate_1 = along(f1 + y), along(of_f1 + by_first)
    if is_open:  # the voltage of the field, the rate of its flux, changes its sign
        here = reverse.rate[:, 1:2]
        push, of_push = _parts(reverse.pushed[:, 1:2], first)
        value_1 = (products(here, f1 + y) + push)[:, 0, 0]
        rate_1 = (products(here, of_f1 + by_first) + of_push)[:, 0, 0]
    cross_1 = products(here, by_second)[:, 0, 0]
    value_2 = along(f2 + end)
    cross_2 = along(products(e_f, by_first) - gained)
    rate_2 = along(of_f2 + gained + products(e_f, by_second))
    size = rate_1 * rate_2 - cross_1 * cross_2
    step = (
        (cross_1 * value_2 - rate_2 * value_1) / size,
        (cross_2 * value_1 - rate_1 * value_2) / size,
    )
    return _Cycle((y, rest), step)


def slip_harmonics(circuit: Circuit, slip: Floats) -> SlipHarmonics:
    """Torques and currents at rated voltage of a motor with a one-way path of its field current.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts, with a field and a reverse resistance. [pu]
    slip : ndarray, shape (n,)
        Not 0; negative above synchronous speed. [1]

    Returns
    -------
    SlipHarmonics
        At each slip. Harmonics of the torque above twice the slip frequency are left out. [pu]

    Raises
    ------
    ModelError
        If the current of the field changes its sign more than twice a period.
    """
    assert circuit.field is not None
    assert circuit.reverse_resistance is not None
    (one, other), own = circuit.polarities, circuit.field.resistance
    forward = _polarity(one, one, slip)
    current = flux_system(one, 1.0, 0.0, 0.0, is_open=False).current[1]
    is_open = other.field is None
    target = own * NEARLY_OPEN if is_open else circuit.reverse_resistance
    ratio, resistances = RATIO if target > own else 1.0 / RATIO, [own]
    while abs(target - resistances[-1]) > abs(target - ratio * resistances[-1]):
        resistances.append(ratio * resistances[-1])
    resistances = [*resistances[1:], target]
    against = [replace(one, field=circuit.field._replace(resistance=r)) for r in resistances]
    phasor = np.zeros(len(slip), dtype=np.complex128)
    for i, share in enumerate(current.tolist()):
        phasor += share * forward.turning[:, i]
    first = -atan2(phasor.imag, phasor.real) - 0.5 * math.pi  # where it rises through zero
    at = first, first + math.pi
    for step in (*against, *([other] if is_open else [])):
        reverse = _polarity(step, one, slip)
        at, decaying = _settled((forward, reverse), current, at, slip, is_open=step.field is None)
    return _harmonics(one, slip, (forward, reverse), at, decaying)


def _settled(
    polarities: tuple[_Polarity, _Polarity],
    current: Floats,
    at: tuple[Floats, Floats],
    slip: Floats,
    *,
    is_open: bool,
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Instants at which the current of the field is zero, and what is left to decay from them."""
    for _ in range(ROUNDS):
        cycle = _cycle(*polarities, current, at, is_open=is_open)
        (a, b), (da, db) = at, cycle.step
        width = b - a
        # no polarity loses more than three quarters of its length at once, and none turns by more than a quarter of a turn
        shrinks, grows = -(db - da) / (0.75 * width), (db - da) / (0.75 * (2.0 * math.pi - width))
        turns = np.maximum(np.abs(da), np.abs(db)) / (0.5 * math.pi)
        share = 1.0 / np.maximum(np.maximum(shrinks, grows), np.maximum(turns, 1.0))
        at = a + share * da, b + share * db
        if np.all(np.abs(slip) * np.maximum(np.abs(da), np.abs(db)) < SETTLED):
            return at, cycle.decaying
    raise ModelError(TOO_OFTEN)


def _harmonics(
    circuit: Circuit,
    slip: Floats,
    polarities: tuple[_Polarity, _Polarity],
    at: tuple[Floats, Floats],
    decaying: tuple[Floats, Floats],
) -> SlipHarmonics:
    """Harmonics of the torque, from samples of both polarities and their rates at the ends."""
    system = flux_system(circuit, 1.0, 0.0, 0.0, is_open=False)
    sense = np.where(slip > 0.0, 1.0, -1.0)[:, None]
    count = len(slip)
    mean, squares = np.zeros(count), np.zeros(count)
    waves = [np.zeros(count, dtype=np.complex128) for _ in range(3)]
    first, second = at
    widths, field = (second - first, 2.0 * math.pi - (second - first)), system.current[None, 1:2]
    most = np.zeros((count, 1))
    for polarity, begin, width, left, sign in zip(
        polarities, at, widths, decaying, (1.0, -1.0), strict=True
    ):
        h = width / SAMPLES
        power = matrix_exponentials(polarity.rate * h[:, None, None])
        while left.shape[-1] < SAMPLES + 1:  # y at 0, h, 2 h, ...
            left = np.concatenate([left, products(power, left)], axis=2)
            power = products(power, power)
        left = left[..., : SAMPLES + 1]
        angle = begin[:, None] + h[:, None] * np.arange(SAMPLES + 1)
        c, s = cos(angle)[:, None], sin(angle)[:, None]
        real, imag = polarity.turning.real[..., None], polarity.turning.imag[..., None]
        flux = real * c - imag * s + left
        rate = -real * s - imag * c + products(polarity.rate, left)
        flows = sign * products(field, flux)[:, 0]
        most = np.maximum(most, np.max(flows, axis=1, keepdims=True))
        if np.any(flows < -AGAINST * most):
            raise ModelError(TOO_OFTEN)
        (i_d, i_q), (of_d, of_q) = (
            products(system.stator_current[None], x).transpose(1, 0, 2) for x in (flux, rate)
        )
        q = system.q
        torque = flux[:, 0] * i_q - flux[:, q] * i_d
        of_torque = rate[:, 0] * i_q + flux[:, 0] * of_q - rate[:, q] * i_d - flux[:, q] * of_d
        mean += _integral(h, torque, of_torque)
        squares += _integral(h, i_d * i_d + i_q * i_q, 2.0 * (i_d * of_d + i_q * of_q))
        once = c[:, 0], -sense * s[:, 0]  # of e^{−jkτ}, with the sense in which the voltage turns
        twice = once[0] * once[0] - once[1] * once[1], 2.0 * once[0] * once[1]
        for k, wave, (along, across), x, of_x in (
            (1, waves[0], once, torque, of_torque),
            (2, waves[1], twice, torque, of_torque),
            (1, waves[2], once, i_d + 1j * i_q, of_d + 1j * of_q),
        ):
            wave += _integral(h, along * x, along * of_x + k * sense * across * x)
            wave += 1j * _integral(h, across * x, across * of_x - k * sense * along * x)
    turn = 2.0 * math.pi
    return SlipHarmonics(
        mean / turn,
        waves[0] / math.pi,
        waves[1] / math.pi,
        np.sqrt(squares / turn),
        waves[2] / turn,
    )


def _integral(h: Floats, values: Floats, rates: Floats) -> Floats:
    """Of samples h apart, by the trapezoidal rule with the rates at both ends (Euler and Maclaurin). Shape (count,)."""
    inside = values[:, 1:-1].sum(axis=1) + 0.5 * (values[:, 0] + values[:, -1])
    return np.asarray(h * inside + h * h / 12.0 * (rates[:, 0] - rates[:, -1]))
