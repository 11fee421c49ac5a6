"""Derivatives of a linear start by its tangent: the same motion, and its change with each parameter.

The start in modal coordinates, q̈ + d q̇ + ω² q = Φᵀ F, is solved together with its derivative,

    δq̈ + d δq̇ + ω² δq = Φᵀ δF + δΦᵀ F − δd q̇ − δ(ω²) q,

where δF follows the change of speed at every motor, load and damper and the change of phase of every
pulsation. At the time of a turning point of this motion its value changes by δT there: the time itself moves, but
the rate is zero (envelope theorem). Frequencies, shapes, damping and curves change as the difference
of two trains built a little apart says.

The integrator is another than that of `engine.start.start`: between two samples modes are exact under a
force that is the parabola through both ends and the middle (Lobatto collocation, fourth order).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.model.modes import Modes
from engine.model.train import Train
from engine.start.start_model import StartModel
from engine.start.torque_outputs import TorqueOutputs
from engine.stepping.exponential import polynomial_step

#: Largest phase of the pulsation per step. [rad]
PHASE = 0.5
#: Rounds of the collocation in a step that follows none of its length; others take one.
FIRST_ROUNDS = 3
#: A turning point is that of a parabola through torques so far apart, and no farther from that of the start itself,
#: whose time is off by its step error. [steps]
NEAR, FARTHEST = 0.02, 0.25
#: Parabola through s = 0, ½, 1: coefficients of s⁰, s¹, s² from the three values.
_PARABOLA = np.array([[1.0, 0.0, 0.0], [-3.0, 4.0, -1.0], [2.0, -4.0, 2.0]])


@dataclass(frozen=True, eq=False)
class TangentModel:
    """A start in arrays with the derivative of each array with respect to each parameter."""

    model: StartModel  #: The start. [SI]
    stiffness: Floats  #: Derivatives of ω² and d. [1/s², 1/s] Shape (n_parameters, n_modes).
    rate: Floats  #: Likewise. [1/s², 1/s] Shape (n_parameters, n_modes).
    #: Of the shapes at the forces. [rad/√(kg m²)] Shape (n_parameters, n_modes, n_forces).
    reach: Floats
    #: Of the speeds at which curves are read. [√(1/(kg m²))] Shape (n_parameters, n_motors, n_read).
    read_speed: Floats
    position: Floats  #: Of the outputs. [N m, N m s] Shape (n_parameters, n_outputs, n_modes).
    velocity: Floats  #: Likewise. [N m, N m s] Shape (n_parameters, n_outputs, n_modes).
    force: Floats  #: Of the outputs. [1] Shape (n_parameters, n_outputs, n_forces).
    cubics: Floats  #: Of the torque curves. [N m] Shape (n_parameters, n_curves, n_knots, 4).
    #: Of the standstill zones of the loads. [rad/s] Shape (n_parameters, n_loads).
    soft_speed: Floats
    #: Of the dampers that act as forces. [N m s/rad] Shape (n_parameters, n_dampers).
    viscous: Floats


@dataclass(frozen=True, eq=False)
class OutputSensitivity:
    """Torques of one output at given times, and their derivatives."""

    torque: Floats  #: Torque. [N m] Shape (n_times,).
    derivative: Floats  #: Its derivative. [N m] Shape (n_times, n_parameters).


def tangent_model(
    plain: tuple[Train, Modes, StartModel],
    apart: Sequence[tuple[tuple[Modes, StartModel], tuple[Modes, StartModel]]],
    distance: float,
) -> TangentModel | None:
    """Derivatives of the arrays of a start by central differences of the arrays alone.

    Parameters
    ----------
    plain : tuple
        Train, modes and start of the case as stated. [SI]
    apart : sequence of pairs
        Of each parameter, modes and start with it below and above. [SI]
    distance : float
        How far from 1 the factor of the parameter is in either. [1]

    Returns
    -------
    TangentModel or None
        None where a mode or force appears in one of them only. [SI]
    """
    train, modes, model = plain
    slopes: dict[str, list[Floats]] = {}
    for low, high in apart:
        ends = [_aligned(train, modes, model, *end) for end in (low, high)]
        if ends[0] is None or ends[1] is None:
            return None
        for name, (a, b) in {k: (ends[0][k], ends[1][k]) for k in ends[0]}.items():
            slopes.setdefault(name, []).append((b - a) / (2.0 * distance))
    return TangentModel(model, **{name: np.array(rows) for name, rows in slopes.items()})


def _aligned(
    train: Train, modes: Modes, model: StartModel, other_modes: Modes, other: StartModel
) -> dict[str, Floats] | None:
    """Arrays of a neighbouring start, each mode with the sign it has in the first."""
    same = (
        np.array_equal(other.keep, model.keep)
        and other.curves[1].shape == model.curves[1].shape
        and np.array_equal(other.damper_rows, model.damper_rows)
        and np.array_equal(other.force_nodes, model.force_nodes)
    )
    if not same:
        return None
    alike = np.sum(modes.shape * train.inertia[:, None] * other_modes.shape, axis=0)[model.keep]
    if np.any(np.abs(alike) < 0.9):
        return None  # near-equal modes have changed places or mixed
    sign = np.sign(alike)
    y = other.outputs
    return {
        "stiffness": other.stiffness,
        "rate": other.rate,
        "reach": sign[:, None] * other.reach,
        "read_speed": sign[: other.read_speed.shape[1]] * other.read_speed,
        "position": sign * y.position,
        "velocity": sign * y.velocity,
        "force": y.force,
        "cubics": other.curves[1],
        "soft_speed": other.loads[3],
        "viscous": other.dampers[1],
    }


# --- forces ---------------------------------------------------------------------------------------


class _Forces:
    """Forces at one time and their derivatives; column 0 is the force itself, then one a parameter."""

    def __init__(self, tangent: TangentModel) -> None:
        self.t, self.m = tangent, tangent.model
        self.shock = self.m.electrical[:3]

    def at(self, time: float, speed: Floats, read: Floats, phase: Floats) -> Floats:
        """Forces from speeds, shape (n_forces, 1 + P), and of each motor, shape (n_motors, 1 + P), the speed at which
        its curves are read, and the phase."""
        force = np.zeros_like(speed)
        self._motors(time, read, phase, force)
        self._loads(speed, force)
        self._timed(time, force)
        where, viscous = self.m.dampers
        if len(where):
            force[where] -= viscous[:, None] * speed[where]
            force[where, 1:] -= self.t.viscous.T * speed[where, :1]
        return force

    def _curve(self, curve: int, x: float, change: Floats) -> Floats:
        """A torque curve at x, and its change through x and through its own coefficients."""
        knots, cubics, counts = self.m.curves
        n = int(counts[curve])
        at = min(max(x, float(knots[curve, 0])), float(knots[curve, n - 1]))
        i = min(int(np.searchsorted(knots[curve, :n], at, side="right")) - 1, n - 1)
        s = at - float(knots[curve, i])
        powers = np.array([1.0, s, s * s, s**3])
        slope = float(cubics[curve, i] @ [0.0, 1.0, 2.0 * s, 3.0 * s * s]) if at == x else 0.0
        out = np.empty(1 + len(change))
        out[0] = cubics[curve, i] @ powers
        out[1:] = slope * change + self.t.cubics[:, curve, i] @ powers
        return out

    def _motors(self, time: float, read: Floats, phase: Floats, force: Floats) -> None:
        station, average, pulsating, synchronous = self.m.motors[:4]
        for k, f in enumerate(station):
            x, change = read[k, 0] / synchronous[k], read[k, 1:] / synchronous[k]
            steady = self._curve(int(average[k]), x, change)
            swing = self._curve(int(pulsating[k]), x, change)
            s, c = math.sin(phase[k, 0]), math.cos(phase[k, 0])
            force[f] += steady + swing * s
            force[f, 1:] += swing[0] * c * phase[k, 1:]
            size, decay, omega = self.shock[0][k], self.shock[1][k], self.shock[2]
            if size:
                force[f, 0] += size * math.exp(-decay * time) * math.sin(omega * time)

    def _loads(self, speed: Floats, force: Floats) -> None:
        station, curve, synchronous, soft = self.m.loads
        for k, f in enumerate(station):
            x = speed[f, 0] / synchronous[k]
            direction = 1.0 if x >= 0.0 else -1.0
            torque = self._curve(int(curve[k]), abs(x), direction * speed[f, 1:] / synchronous[k])
            z = speed[f, 0] / soft[k]
            if z >= 1.0:
                force[f] -= torque
                continue
            inside = z > -1.0
            z = max(z, -1.0)
            sign = z * (1.5 - 0.5 * z * z)
            force[f] -= torque * sign
            if inside:
                turn = 1.5 * (1.0 - z * z)
                change = speed[f, 1:] / soft[k] - z * self.t.soft_speed[:, k] / soft[k]
                force[f, 1:] -= torque[0] * turn * change

    def _timed(self, time: float, force: Floats) -> None:
        station, times, torques, counts = self.m.timed
        for k, f in enumerate(station):
            n = int(counts[k])
            if time >= times[k, 0]:
                force[f, 0] += np.interp(time, times[k, :n], torques[k, :n])


# --- the motion and its derivative ----------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Step:
    """Maps of one length of step: to the middle and to the end."""

    h: float
    half: tuple[Floats, Floats]
    whole: tuple[Floats, Floats]


class _Motion:
    """State of all modes and phases, columns as in `_Forces`, carried on step by step."""

    def __init__(self, tangent: TangentModel) -> None:
        model = tangent.model
        self.t, self.m = tangent, model
        p, n, nf = len(tangent.stiffness), len(model.stiffness), model.reach.shape[1]
        self.q, self.v = np.zeros((n, 1 + p)), np.zeros((n, 1 + p))
        self.phase = np.zeros((len(model.phase), 1 + p))
        self.phase[:, 0] = model.phase
        self.forces = _Forces(tangent)
        self.time = 0.0
        self.station, self.pairs = model.motors[0], model.motors[4]
        self.line = model.motors[5]
        self.change_of_speed = tangent.reach.transpose(1, 2, 0).reshape(n, nf * p)
        self.change_of_drive = np.ascontiguousarray(tangent.reach.transpose(2, 1, 0)).reshape(
            nf, n * p
        )
        self.rate, self.stiffness = tangent.rate.T.copy(), tangent.stiffness.T.copy()
        self.last: tuple[float, Floats, Floats] | None = None  # parabolas of the step before

    def speeds(self, v: Floats) -> Floats:
        """Speed at each force, shape (n_forces, 1 + P)."""
        speed = self.m.reach.T @ v
        speed[:, 1:] += (v[:, 0] @ self.change_of_speed).reshape(len(speed), -1)
        return np.asarray(speed)

    def read_speeds(self, v: Floats) -> Floats:
        """Speed at which the curves of each motor are read, shape (n_motors, 1 + P)."""
        n = self.m.read_speed.shape[1]
        read = self.m.read_speed @ v[:n]
        read[:, 1:] += (self.t.read_speed @ v[:n, 0]).T
        return np.asarray(read)

    def drive(self, force: Floats, q: Floats, v: Floats) -> Floats:
        """Right-hand side of every mode, shape (n, 1 + P)."""
        g = self.m.reach @ force
        g[:, 1:] += (force[:, 0] @ self.change_of_drive).reshape(len(g), -1)
        g[:, 1:] -= self.rate * v[:, :1] + self.stiffness * q[:, :1]
        return np.asarray(g)

    def slip(self, speed: Floats) -> Floats:
        """Rate of every phase, shape (n_motors, 1 + P)."""
        rate = -2.0 * self.pairs[:, None] * speed[self.station]
        rate[:, 0] += 2.0 * self.line
        return np.asarray(rate)

    def advance(self, step: _Step) -> tuple[Floats, Floats, Floats]:
        """One step; returns the parabolas of drive and force over it, and the state before."""
        h, t = step.h, self.time
        q0, v0, phase0 = self.q, self.v, self.phase
        speed0 = self.speeds(v0)
        read0 = self.read_speeds(v0)
        force = np.stack([self.forces.at(t, speed0, read0, phase0)] * 3)
        drive, slip = self._guess(h, self.drive(force[0], q0, v0), self.slip(speed0))
        rounds = 1 if self.last is not None and self.last[0] == h else FIRST_ROUNDS
        for _ in range(rounds):
            shape, turned = _parabola(drive), _parabola(slip)
            for place, share, maps in ((1, 0.5, step.half), (2, 1.0, step.whole)):
                q, v = _moved(maps, q0, v0, shape, share)
                speed = self.speeds(v)
                phase = phase0 + _integral(turned, share, h)
                read = self.read_speeds(v)
                force[place] = self.forces.at(t + share * h, speed, read, phase)
                drive[place] = self.drive(force[place], q, v)
                slip[place] = self.slip(speed)
        shape, turned = _parabola(drive), _parabola(slip)
        self.q, self.v = _moved(step.whole, q0, v0, shape, 1.0)
        self.phase = phase0 + _integral(turned, 1.0, h)
        self.time, self.last = t + h, (h, shape, turned)
        return shape, _parabola(force), np.stack([q0, v0])

    def _guess(self, h: float, drive: Floats, slip: Floats) -> tuple[Floats, Floats]:
        """Drive and slip at the beginning, and as the parabolas of the step before would go on."""
        drives, slips = np.stack([drive] * 3), np.stack([slip] * 3)
        if self.last is not None and self.last[0] == h:
            for ahead, before in ((drives, self.last[1]), (slips, self.last[2])):
                for place, s in ((1, 1.5), (2, 2.0)):
                    ahead[place] = before[0] + s * (before[1] + s * before[2])
        return drives, slips


def _parabola(values: Floats) -> Floats:
    """Coefficients of s⁰, s¹, s² from values at s = 0, ½, 1, along the first axis."""
    return np.asarray((_PARABOLA @ values.reshape(3, -1)).reshape(values.shape))


def _integral(parabola: Floats, share: float, h: float) -> Floats:
    """Integral of a parabola over a share of a step."""
    a, b, c = parabola
    return np.asarray(h * share * (a + share * (b / 2.0 + share * c / 3.0)))


def _moved(
    maps: tuple[Floats, Floats], q: Floats, v: Floats, drive: Floats, share: float
) -> tuple[Floats, Floats]:
    """State after a share of a step under a parabola of drive over the whole step."""
    free, forced = maps
    a, b, c = drive[0], share * drive[1], share * share * drive[2]
    return tuple(
        free[:, i, :1] * q
        + free[:, i, 1:2] * v
        + forced[:, i, 0:1] * a
        + forced[:, i, 1:2] * b
        + forced[:, i, 2:3] * c
        for i in (0, 1)
    )


def tangent_torques(
    tangent: TangentModel, watched: Sequence[tuple[int, Floats]]
) -> tuple[OutputSensitivity, ...]:
    """Torques of some outputs where they turn near some times, with their derivatives.

    Parameters
    ----------
    tangent : TangentModel
        The start and its derivatives. [SI]
    watched : sequence of (int, ndarray)
        Output, and the times at which it is wanted. [index, s]

    Returns
    -------
    tuple of OutputSensitivity
        In the same order. [N m]
    """
    p = len(tangent.stiffness)
    out = [OutputSensitivity(np.zeros(len(t)), np.zeros((len(t), p))) for _, t in watched]
    wanted = sorted(
        (float(time), k, i) for k, (_, times) in enumerate(watched) for i, time in enumerate(times)
    )
    motion, place = _Motion(tangent), 0
    for step in _steps(tangent.model, wanted[-1][0] if wanted else 0.0):
        began = motion.time
        drive, force, before = motion.advance(step)
        while place < len(wanted) and wanted[place][0] <= motion.time * (1.0 + 1e-12):
            time, k, i = wanted[place]
            within = _Within(tangent, watched[k][0], step.h, before, drive, force)
            found = within.torque(within.turning((time - began) / step.h))
            out[k].torque[i], out[k].derivative[i] = found[0], found[1:]
            place += 1
    return tuple(out)


def _steps(model: StartModel, until: float) -> list[_Step]:
    """Steps from rest: as short as the modes that still ring need, like the start itself."""
    usual = PHASE / model.pulsation_omega
    made: dict[float, _Step] = {}
    plan: list[_Step] = []
    at = 0.0
    stretches = [
        (end, usual / 2 ** max(math.ceil(math.log2(omega / model.pulsation_omega)), 0))
        for end, omega in model.windows
    ]
    for end, h in [*stretches, (until, usual)]:
        if h not in made:
            made[h] = _Step(
                h,
                polynomial_step(model.stiffness, model.rate, 0.5 * h),
                polynomial_step(model.stiffness, model.rate, h),
            )
        while at < min(end, until):
            plan.append(made[h])
            at += h
    return plan


@dataclass(frozen=True, eq=False)
class _Within:
    """Torque of one output within a step that was taken: h, state before it, parabolas of drive and force over it."""

    tangent: TangentModel
    output: int
    h: float
    before: Floats
    drive: Floats
    force: Floats

    def torque(self, share: float) -> Floats:
        """Torque after a share of the step, and its derivatives."""
        tangent, y = self.tangent, self.tangent.model.outputs
        q, v, force = self._motion(share, self.before, self.drive, self.force)
        whole = np.asarray(_along(y, self.output, q, v, force))
        whole[1:] += (
            tangent.position[:, self.output] @ q[:, 0]
            + tangent.velocity[:, self.output] @ v[:, 0]
            + tangent.force[:, self.output] @ force[:, 0]
        )
        return whole

    def turning(self, share: float) -> float:
        """Where this torque turns near a share of the step; there itself if it does not, as at the end of a start.

        Derivatives of a torque late in the start are those of its phase, a thousand turns of the pulsation old. At the
        turning points of another run, off by no more than its step error, they would not vanish as at those of its own.
        """
        middle = min(max(share, NEAR), 1.0 - NEAR)
        alone = (self.before[..., :1], self.drive[..., :1], self.force[..., :1])
        a, b, c = (
            float(_along(self.tangent.model.outputs, self.output, *self._motion(s, *alone))[0])
            for s in (middle - NEAR, middle, middle + NEAR)
        )
        bend = a - 2.0 * b + c
        own = middle + 0.5 * NEAR * (a - c) / bend if bend != 0.0 else share
        return own if abs(own - share) <= FARTHEST else share

    def _motion(
        self, share: float, before: Floats, drive: Floats, force: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Modes, their velocities and forces after a share of the step."""
        model, share = self.tangent.model, max(share, 0.0)
        maps = polynomial_step(model.stiffness, model.rate, max(share, 1e-9) * self.h)
        q, v = _moved(maps, before[0], before[1], drive, share)
        return q, v, force[0] + share * (force[1] + share * force[2])


def _along(y: TorqueOutputs, output: int, q: Floats, v: Floats, force: Floats) -> Floats:
    """Torque of one output, by columns."""
    return np.asarray(y.position[output] @ q + y.velocity[output] @ v + y.force[output] @ force)
