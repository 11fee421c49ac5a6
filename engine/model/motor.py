"""Torque of a synchronous motor while it starts: average and pulsating part against speed.

The pulsating torque has twice the slip frequency; its phase follows the rotor's own angle,
T(ω) · sin(2 (ω_line t − p θ) + phase), so that a twisting shaft is fed back into the torque
(the paper, "Transient torsional analyses"; Godwin, IEEE Trans. PAS-95 (1976)).

At breaker closing a torque at line frequency dies out beside it, A e^(−t/τ) sin ω_line t. A discharge path that
carries the field's current one way alone adds T₁(ω) · sin(ω_line t − p θ + phase / 2), at the slip frequency itself, until the
field is on. With the field on, the synchronising torque PullOutTorque · (1 − e^(−t/τ_f)) · sin δ joins it, where δ is the
load angle, half the phase of the pulsation; the pulsation goes on as the saliency torque.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData, MotorTorqueRow, SupplyVoltageRow
from engine.case.effect import StartEffects
from engine.errors import ModelError
from engine.model.load import loads_of, opposing_torque, rigid_inertia
from engine.model.soft_start import SPEEDS, Ramp, SoftStart, runup_times, soft_start
from engine.model.train import Train
from engine.motor.from_case import (
    CURVE_ERROR,
    FIRST_POINTS,
    NEARBY,
    MotorFromData,
    Stage,
    motors_from_data,
)
from engine.motor.supply import STIFF
from engine.numerics.same_bits import atan2, cos, hypot, sin, square, total
from engine.numerics.torque_curve import TorqueCurve, fitted_curves, joined, torque_curve

#: A linear start, which has no events, goes over from one connection of a motor to the next within so much of synchronous
#: speed: a jump there would be met in the middle of a step. The start with events switches at once. [1]
SMOOTHED = 0.01
#: Arguments of the compiled loop; see `electrical_arrays`.
Electrical = tuple[Floats, Floats, float, Floats, Floats, Floats, Floats, Floats, Floats]


@dataclass(frozen=True, eq=False)
class Motor:
    """One motor."""

    station: int  #: Station it acts on.
    #: Torque against speed, at the voltage of this start; pulsating zero-to-peak. [N m]
    average: TorqueCurve
    pulsating: TorqueCurve  #: Likewise. [N m]
    synchronous_speed: float  #: Of its own station. [rad/s]
    pole_pairs: float  #: Line angular frequency over its synchronous speed. [1]
    phase: float  #: Of the pulsating torque at t = 0; with `parts`, twice the load angle. [rad]
    #: Where the phase changes with speed, of a data sheet or typed: the parts of the pulsation with sin 2δ
    #: and cos 2δ, δ the load angle, in place of one curve of unchanging phase. [N m]
    parts: tuple[TorqueCurve, TorqueCurve] | None = None
    #: Torque at the slip frequency itself, of a one-way discharge path: its part with the sine of half the phase, and of a data
    #: sheet that with the cosine; none without such a path. [N m]
    at_slip: tuple[TorqueCurve, ...] = ()
    #: Of slip frequency that the pulsation has; 1 of the torque `at_slip` of another motor. [1]
    multiple: int = 2
    #: Whether it stands for a part of another motor's pulsation alone.
    is_part: bool = False
    scale: float = 1.0  #: Voltage of the start, over that of the curves, squared. [1]
    #: Voltage that the line leaves it, against the fraction of synchronous speed; None = all of it. [1]
    supply: TorqueCurve | None = None
    #: Whether that is what its own current leaves it behind an impedance, and not the line's own voltage. [flag]
    is_behind_impedance: bool = False
    soft: SoftStart | None = (
        None  #: Its soft starter; the curves have its voltage against speed. [1]
    )
    #: Where it is switched over: fraction of synchronous speed up to which, and the motor until then; the last
    #: one without end. Its own curves go over from one to the next within `SMOOTHED`. [1]
    stages: tuple[tuple[float, Motor], ...] = ()

    @property
    def line_voltage(self) -> TorqueCurve | None:
        """Voltage of the line itself against the fraction of synchronous speed; None = always all of it. [1]"""
        return None if self.is_behind_impedance or self.soft is not None else self.supply

    def above(self, fraction: float) -> Motor:
        """The motor on the connection that it has from a speed on.

        Parameters
        ----------
        fraction : float
            Fraction of synchronous speed. [1]
        """
        return next((motor for until, motor in self.stages if until > fraction), self)

    def torque_factor(self, fraction: Floats | float) -> Floats:
        """What torques that are stated at full voltage are multiplied by.

        Parameters
        ----------
        fraction : float or ndarray
            Fraction of synchronous speed. [1]

        Returns
        -------
        ndarray
            Voltage squared. [1]
        """
        if self.supply is None:
            return np.full(np.shape(fraction), self.scale)
        voltage = self.supply(fraction)
        return np.asarray(self.scale * (voltage * voltage))

    def pulsations_at(self, multiple: int) -> tuple[tuple[TorqueCurve, float], ...]:
        """Curves of the torque at a multiple of slip frequency, each with its phase at t = 0.

        Parameters
        ----------
        multiple : int
            1 or 2. [1]

        Returns
        -------
        tuple of (TorqueCurve, float)
            None at the slip frequency itself without a one-way discharge path. [N m, rad]
        """
        if multiple == 2:
            return self.pulsations
        return tuple(
            (curve, 0.5 * (self.phase + quarters * math.pi))
            for quarters, curve in enumerate(self.at_slip)
        )

    @property
    def pulsations(self) -> tuple[tuple[TorqueCurve, float], ...]:
        """Curves of pulsating torque, each with its phase at t = 0. [N m, rad]"""
        if self.parts is None:
            return ((self.pulsating, self.phase),)
        sine, cosine = self.parts
        return ((sine, self.phase), (cosine, self.phase + 0.5 * math.pi))

    @property
    def largest_pulsation(self) -> float:
        """Largest pulsating torque at any speed, of both frequencies together. [N m]"""
        return total(
            float(np.max(np.abs(curve.cubic[:, 0]))) for curve in (self.pulsating, *self.at_slip)
        )

    @property
    def curves(self) -> tuple[TorqueCurve, ...]:
        """Average torque, every curve of the pulsation, then that at the slip frequency itself. [N m]"""
        return (self.average, *(c for k in (2, 1) for c, _ in self.pulsations_at(k)))


def drives_of(motors: Sequence[Motor]) -> tuple[Motor, ...]:
    """Motors as the compiled loop takes them: one pulsation each.

    Further parts of a pulsation are motors of their own there, without average torque, behind all
    others, so that the first is always a whole motor.

    Parameters
    ----------
    motors : sequence of Motor
        Motors. [SI]

    Returns
    -------
    tuple of Motor
        Motors with one pulsation. [SI]
    """
    firsts, others = [], []
    nothing = TorqueCurve(np.zeros(1), np.zeros((1, 4)))
    for m in motors:
        (curve, phase), *second = m.pulsations
        firsts.append(replace(m, pulsating=curve, phase=phase, parts=None, at_slip=()))
        part = replace(firsts[-1], average=nothing, scale=1.0, supply=None, stages=(), is_part=True)
        for multiple, parts in ((2, second), (1, m.pulsations_at(1))):
            others += [
                replace(part, pulsating=curve, phase=phase, multiple=multiple)
                for curve, phase in parts
            ]
    return (*firsts, *others)


def without_torque(motor: Motor) -> Motor:
    """The same without curves: its torque follows from its fluxes.

    Parameters
    ----------
    motor : Motor
        A motor. [SI]

    Returns
    -------
    Motor
        With its voltage and the phase of its rotor. [SI]
    """
    nothing = TorqueCurve(np.zeros(1), np.zeros((1, 4)))
    return replace(motor, average=nothing, pulsating=nothing, parts=None, at_slip=())


def motors_of(case: CaseData, train: Train) -> tuple[Motor, ...]:
    """Motors of a case; motor torques scale with the square of the voltage.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    tuple of Motor
        In the order of the table. [count]

    Raises
    ------
    ModelError
        If the line frequency or the synchronous speed is unknown.
    """
    ratings = case.ratings
    if not case.motor_stations:
        return ()
    if ratings.synchronous_speed is None or ratings.line_frequency is None:
        raise ModelError(
            "A motor needs line frequency and synchronous speed. Type two of LineFrequency, "
            "SynchronousSpeed and Poles."
        )
    scale = square(1.0 if case.voltage is None else case.voltage)
    typed = {point.station for point in case.motor_torque}
    sheets = {motor.station: motor for motor in motors_from_data(case)}
    motors = []
    for name in case.motor_stations:
        points = [p for p in case.motor_torque if p.station == name]
        station = train.stations.index(str(name))
        speed = ratings.synchronous_speed * float(train.speed_ratio[station])
        phase = case.one_phase
        pairs = 2.0 * math.pi * ratings.line_frequency / speed
        place = _Place(station, speed, pairs, phase, scale)
        supplied = [row for row in case.supply_voltage if row.station == name]
        sheet = sheets.get(str(name))
        if sheet is not None and name not in typed:
            stages = _stages_of_data(sheet, place)
        else:
            motor = _typed_motor(points, place)
            stages = [(math.inf, motor)]
            if sheet is not None and any(row.station == name for row in case.supply):
                stages = [
                    (stage.connection.until, _on_supply(motor, _terminal_voltage(sheet, stage)))
                    for stage in sheet.stages
                ]
        motor = _switched_over(stages)
        motors.append(_on_supply(motor, _voltage_curve(supplied)) if supplied else motor)
    return _soft_started(case, train, motors) if case.soft_starts else tuple(motors)


def _soft_started(case: CaseData, train: Train, motors: Sequence[Motor]) -> tuple[Motor, ...]:
    """Motors with the voltage of their soft starters against speed, of the run-up of the rigid train with all of them."""
    rows = [case.soft_starts.get(train.stations[motor.station]) for motor in motors]
    ramps = [
        None if row is None else Ramp(row.initial_voltage or 1.0, row.ramp_time or 1.0)
        for row in rows
    ]
    fraction = np.linspace(0.0, 1.0, SPEEDS)
    speed = fraction * (case.ratings.synchronous_speed or 0.0)
    torques = np.stack([float(train.speed_ratio[m.station]) * m.average(fraction) for m in motors])
    load = opposing_torque(train, loads_of(case, train), speed)
    time = runup_times(torques, ramps, load, rigid_inertia(train), speed)
    started = []
    for motor, ramp in zip(motors, ramps, strict=True):
        if ramp is not None:
            soft = soft_start(ramp, fraction, time)
            voltage = soft.voltage
            if (
                motor.supply is not None
            ):  # what its current leaves it is a share of the rising voltage
                voltage = _both_voltages(voltage, motor.supply)
            motor = replace(_on_supply(motor, soft.voltage), soft=soft, supply=voltage)
        started.append(motor)
    return tuple(started)


def _both_voltages(one: TorqueCurve, other: TorqueCurve) -> TorqueCurve:
    """Product of two voltages against speed. [1]"""

    def exact(fraction: Floats, within: Floats) -> tuple[Floats, Floats]:
        (a, of_a), (b, of_b) = (curve.piece(fraction, within) for curve in (one, other))
        return (a * b)[None], (of_a * b + a * of_b)[None]

    (voltage,) = fitted_curves(
        exact, np.unique(np.concatenate([one.knots, other.knots])), CURVE_ERROR
    )
    return voltage


class _Place(NamedTuple):
    """Where a motor acts, and how it is switched on."""

    station: int
    speed: float  # synchronous [rad/s]
    pole_pairs: float
    phase: float  # `PulsationPhase` [rad]
    scale: float  # voltage squared

    def motor(
        self,
        average: TorqueCurve,
        pulsating: TorqueCurve,
        phase: float,
        parts: tuple[TorqueCurve, TorqueCurve] | None,
    ) -> Motor:
        return Motor(
            self.station,
            average,
            pulsating,
            self.speed,
            self.pole_pairs,
            phase,
            parts,
            scale=self.scale,
        )


def _typed_motor(points: Sequence[MotorTorqueRow], place: _Place) -> Motor:
    """A motor with a typed curve."""
    x = np.array([p.speed for p in points], dtype=float)
    average, pulsating = (
        torque_curve(x, place.scale * np.array(torques, dtype=float))
        for torques in ([p.average for p in points], [p.pulsating for p in points])
    )
    parts = None
    if points[0].phase is not None:
        parts = _parts(pulsating, torque_curve(x, np.array([p.phase for p in points], float)))
    motor = place.motor(average, pulsating, place.phase, parts)
    if points[0].pulsation_1 is None:
        return motor
    at_slip = torque_curve(x, place.scale * np.array([p.pulsation_1 for p in points], dtype=float))
    return replace(motor, at_slip=(at_slip,))


def _stages_of_data(sheet: MotorFromData, place: _Place) -> list[tuple[float, Motor]]:
    """A motor from its data sheet on each of its connections."""
    stages = []
    _, sine, cosine, _ = sheet.stages[0].curves
    # PulsationPhase is that at rest
    phase = place.phase - atan2(float(cosine.cubic[0, 0]), float(sine.cubic[0, 0]))
    for stage in sheet.stages:
        average, sine, cosine, at_slip = stage.curves
        sine, cosine = sine.scaled(place.scale), cosine.scaled(place.scale)
        pulsating = torque_curve(sine.knots, hypot(sine.cubic[:, 0], cosine.cubic[:, 0]))
        motor = place.motor(average.scaled(place.scale), pulsating, phase, (sine, cosine))
        motor = replace(motor, at_slip=tuple(c.scaled(place.scale) for c in at_slip))
        if any(s.connection.source != STIFF for s in sheet.stages):
            voltage = _terminal_voltage(sheet, stage)
            motor = replace(motor, supply=voltage, is_behind_impedance=True)
        stages.append((stage.connection.until, motor))
    return stages


def _switched_over(stages: Sequence[tuple[float, Motor]]) -> Motor:
    """A motor that goes over from one connection to the next as its speed rises."""
    if len(stages) == 1:
        return stages[0][1]
    (at, first), (_, second) = stages

    def both(a: TorqueCurve, b: TorqueCurve) -> TorqueCurve:
        return joined(a, b, at, SMOOTHED)

    parts = None
    if first.parts is not None and second.parts is not None:
        parts = both(first.parts[0], second.parts[0]), both(first.parts[1], second.parts[1])
    supply = None
    if first.supply is not None and second.supply is not None:
        supply = both(first.supply, second.supply)
    return replace(
        first,
        average=both(first.average, second.average),
        pulsating=both(first.pulsating, second.pulsating),
        parts=parts,
        at_slip=tuple(map(both, first.at_slip, second.at_slip)),
        supply=supply,
        stages=tuple(stages),
    )


def _terminal_voltage(sheet: MotorFromData, stage: Stage) -> TorqueCurve:
    """Voltage at the terminals of a motor against the fraction of synchronous speed. [1]"""

    def exact(fraction: Floats, _: Floats) -> tuple[Floats, Floats]:
        nearby = np.concatenate([1.0 - fraction, 1.0 - fraction - NEARBY, 1.0 - fraction + NEARBY])
        v = stage.connection.source.terminal_voltage(sheet.starting, nearby).reshape(3, 1, -1)
        return v[0], (v[1] - v[2]) / (2.0 * NEARBY)

    (voltage,) = fitted_curves(exact, np.linspace(0.0, 1.0, FIRST_POINTS), CURVE_ERROR)
    return voltage


def _voltage_curve(supplied: Sequence[SupplyVoltageRow]) -> TorqueCurve:
    """Table `SupplyVoltage` as a curve. [1]"""
    x, v = (np.array([getattr(row, n) for row in supplied], float) for n in ("speed", "voltage"))
    return torque_curve(x, v)


def _parts(pulsating: TorqueCurve, phase: TorqueCurve) -> tuple[TorqueCurve, TorqueCurve]:
    """The parts T cos φ and T sin φ of a pulsation T sin(2δ + φ) of typed phase: with sin 2δ and cos 2δ."""

    def exact(fraction: Floats, within: Floats) -> tuple[Floats, Floats]:
        (torque, of_torque), (angle, of_angle) = (
            curve.piece(fraction, within) for curve in (pulsating, phase)
        )
        along, across = cos(angle), sin(angle)
        sine, cosine = torque * along, torque * across
        return (
            np.stack([sine, cosine]),
            np.stack([of_torque * along - cosine * of_angle, of_torque * across + sine * of_angle]),
        )

    largest = float(np.max(np.abs(pulsating.cubic[:, 0])))
    sine, cosine = fitted_curves(exact, pulsating.knots, CURVE_ERROR * largest)
    return sine, cosine


def _on_supply(motor: Motor, voltage: TorqueCurve) -> Motor:
    """A motor whose voltage changes with its speed; its torques go with the square."""
    curves = motor.curves
    knots = np.unique(np.concatenate([curve.knots for curve in (voltage, *curves)]))
    largest = max(float(np.max(np.abs(curve.cubic[:, 0]))) for curve in curves)

    def exact(fraction: Floats, within: Floats) -> tuple[Floats, Floats]:
        v, of_v = voltage.piece(fraction, within)
        parts = [curve.piece(fraction, within) for curve in curves]
        return (
            np.stack([torque * (v * v) for torque, _ in parts]),
            np.stack([slope * (v * v) + torque * (2.0 * v * of_v) for torque, slope in parts]),
        )

    average, *parts = fitted_curves(exact, knots, CURVE_ERROR * largest)
    of_pulsation = len(parts) - len(motor.at_slip)
    at_slip, pulsating = tuple(parts[of_pulsation:]), parts[0]
    if motor.parts is not None:
        pulsating = torque_curve(pulsating.knots, hypot(*(part.cubic[:, 0] for part in parts[:2])))
    return replace(
        motor,
        average=average,
        pulsating=pulsating,
        parts=None if motor.parts is None else (parts[0], parts[1]),
        at_slip=at_slip,
        supply=voltage,
    )


def electrical_arrays(
    motors: tuple[Motor, ...], case: CaseData, effects: StartEffects | None = None
) -> Electrical:
    """Transient at breaker closing, field and connection of each motor, for the compiled loop.

    Field application and a trip are events of the run: here no motor has its field on yet and all
    are connected. With several motors each has the stated transient, pull-out torque and damping,
    at its own shaft. All of them scale with the square of the voltage, like the curves: the transient with
    that at rest, the others with that in step.

    Parameters
    ----------
    motors : tuple of Motor
        Motors. [SI]
    case : CaseData
        The case. [SI]
    effects : StartEffects, optional
        What is simulated; default nothing of it. [flags]

    Returns
    -------
    shock : ndarray, shape (n_motors,)
        Amplitude of the transient; 0 where it is not simulated. [N m]
    shock_rate : ndarray, shape (n_motors,)
        1 over its time constant. [1/s]
    shock_omega : float
        Its angular frequency, that of the line. [rad/s]
    field_time : ndarray, shape (n_motors,)
        Time of field application; infinite = none yet. [s]
    field_rate : ndarray, shape (n_motors,)
        1 over the time constant of the field; infinite = at once. [1/s]
    pull_out : ndarray, shape (n_motors,)
        Pull-out torque. [N m]
    cage : ndarray, shape (n_motors,)
        Damper torque over slip speed; nan = the average curve. [N m s/rad]
    polarity : ndarray, shape (n_motors,)
        Added to half the phase of the pulsation to give the load angle: 0 or π. [rad]
    connected : ndarray, shape (n_motors,)
        1, or 0 once the motor has tripped. [1]
    """
    n, whole = len(motors), np.array([not m.is_part for m in motors], dtype=bool)
    at_rest, in_step = (
        whole * np.array([float(m.torque_factor(speed)) for m in motors]) for speed in (0.0, 1.0)
    )
    effects = effects or StartEffects()
    shock = case.shock_amplitude if effects.breaker_closing else None
    decay = case.shock_time_constant if effects.breaker_closing else None
    rise = case.field_time_constant if effects.pull_in else None
    pull_out = case.pull_out_torque if effects.pull_in else None
    cage = case.pull_in_damping if effects.pull_in else None
    if (
        effects.motor_transient
    ):  # the fluxes of motors have all of it, but for the rise of the field
        shock = decay = pull_out = cage = None
    return (
        at_rest * (shock or 0.0),
        np.full(n, 1.0 / decay if decay else 0.0),
        motors[0].pole_pairs * motors[0].synchronous_speed if motors else 0.0,
        np.full(n, math.inf),
        np.full(n, 1.0 / rise if rise else math.inf),
        in_step * (pull_out or 0.0),
        np.where(whole, math.nan if cage is None else in_step * cage, math.nan),
        np.zeros(n),
        np.ones(n),
    )


def through_synchronism(curve: TorqueCurve) -> TorqueCurve:
    """Average torque as a curve through 100 % speed: zero there, and odd about it.

    A cage without slip gives no torque. Where the typed curve is zero at 100 % it is used as it
    is; else the torque falls on a straight line from the last point below 100 %. Above 100 % the
    cage brakes as much as it drives at the same slip below.

    Parameters
    ----------
    curve : TorqueCurve
        Average torque against the fraction of synchronous speed. [N m]

    Returns
    -------
    TorqueCurve
        The same below its last point below 100 %, odd about 100 %. [N m]
    """
    below = curve.knots < 1.0
    knots, cubic = curve.knots[below], curve.cubic[below].copy()
    if not len(knots):  # typed above synchronism only: constant below, as any curve
        knots, cubic = np.zeros(1), curve.cubic[:1] * np.array([1.0, 0.0, 0.0, 0.0])
    at_one = curve.cubic[curve.knots == 1.0]
    if not (len(at_one) and at_one[0, 0] == 0.0):
        start = cubic[-1, 0]
        cubic[-1] = (start, -start / (1.0 - knots[-1]), 0.0, 0.0)
    ends = np.append(knots[1:], 1.0)
    return TorqueCurve(
        np.concatenate([knots, (2.0 - ends)[::-1], [2.0 - knots[0]]]),
        np.concatenate([cubic, _mirrored(cubic, ends - knots)[::-1], [[-cubic[0, 0], 0, 0, 0]]]),
    )


def _mirrored(cubic: Floats, width: Floats) -> Floats:
    """−p(width − s) of each cubic p."""
    a, b, c, d = cubic.T
    w = width
    return np.stack(
        [
            -(a + w * (b + w * (c + w * d))),
            b + w * (2.0 * c + 3.0 * w * d),
            -(c + 3.0 * w * d),
            d,
        ],
        axis=1,
    )
