"""What the motor damps of each mode, or drives, while it starts and in operation.

A mode of frequency ω with the mass-normalised angle φ at the motor's station moves that station's speed. The torque
K Δω that the motor answers with (`engine.motor.damping`) changes the mode's damping ratio and frequency by

    ζe = −½ Re K φ² / ω,   Δω = ½ φ² Im K.

A start that reads the torque curve at the station's own speed has the slope of the curve in place of K: right for
oscillations that are slow beside the windings' own rates, and often not even of the right sign at those of shafts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.data import CaseData
from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor, motors_of
from engine.motor.circuit import Circuit
from engine.motor.damping import electrical_damping, running_damping
from engine.motor.from_case import MotorFromData, Stage, motors_from_data
from engine.motor.supply import STIFF
from engine.numerics.same_bits import total
from engine.operation.margins import percent_speed

#: Fractions of synchronous speed at which K is tabulated, straight between: its narrowest features, where an axis of the
#: stator stands still, are as wide as the resistance of the stator in per unit, 1 % of speed and more.
LEVELS = np.linspace(0.0, 1.0, 801)


@dataclass(frozen=True)
class ElectricalDamping:
    """What one motor makes of one mode at one speed; None where the motor has no data sheet."""

    station: str  #: Where the motor acts.
    mode: int  #: Elastic mode, counted from 1.
    speed: float  #: Speed over synchronous speed. [1]
    slope: float  #: Slope of the torque curve that the start uses. [N m s/rad]
    slope_share: float  #: Damping ratio that this slope makes of it. [1]
    real: (
        float | None
    )  #: Torque in phase with a small oscillation of the speed, over it. [N m s/rad]
    imaginary: float | None  #: Torque a quarter of its period ahead, over it. [N m s/rad]
    share: float | None  #: Damping ratio that the motor adds. [1]
    shift: float | None  #: Natural frequency that it adds. [Hz]
    damping_ratio: float  #: Of the mode without motors. [1]
    with_motors: float | None  #: With all of them; None unless each has a data sheet. [1]


@dataclass(frozen=True, eq=False)
class Swings:
    """Motors that answer to small oscillations in a start."""

    motor: Ints  #: Their places among the motors of the compiled loop. Shape (n_swings,).
    force: Ints  #: Their forces. Shape (n_swings,).
    #: Circuits of each, one for each connection, and torque over speed of 1 per unit at each of `LEVELS`, 0 where it
    #: is on another one. [pu, N m s/rad]
    machines: tuple[tuple[tuple[Circuit, Floats], ...], ...]
    line_omega: float  #: Angular frequency of the line. [rad/s]

    def torque_over_velocity(self, omega: Floats, reach: Floats) -> Floats:
        """Torque of each motor over the velocity of each mode, at speeds from rest to synchronous speed.

        The part in phase with the velocity, which damps or drives, of a vibration at the mode's own frequency. The other
        part, which shifts the frequency, is left out: on the slow twist of the mode it would act as a spring.

        Parameters
        ----------
        omega : ndarray, shape (n_modes,)
            Angular frequencies; 0 of rigid modes, which answer nothing. [rad/s]
        reach : ndarray, shape (n_modes, n_forces)
            Forces to modes. [rad/√(kg m²)]

        Returns
        -------
        ndarray, shape (n_swings, n_levels, n_modes)
            Re K φ. [N m s/√(kg m²)]
        """
        if not len(self.motor):
            return np.zeros((0, 0, len(omega)))
        levels = len(LEVELS)
        torque = np.zeros((len(self.motor), levels, len(omega)))
        elastic = np.flatnonzero(omega > 0.0)
        frequency = np.repeat(omega[elastic] / self.line_omega, levels)
        slip = np.tile(1.0 - LEVELS, len(elastic))
        for row, force, circuits in zip(torque, self.force, self.machines, strict=True):
            for circuit, scale in circuits:
                k = electrical_damping(circuit, slip, frequency).real.reshape(len(elastic), levels)
                row[:, elastic] += (scale * reach[elastic, force][:, None] * k).T
        return torque


#: No motor answers.
NO_SWINGS = Swings(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), (), 1.0)


def swings_of(case: CaseData, motors: Sequence[Motor], column: Mapping[int, int]) -> Swings:
    """Motors of a start that answer to small oscillations: all of them.

    Parameters
    ----------
    case : CaseData
        With a data sheet of every motor. [SI]
    motors : sequence of Motor
        As the compiled loop takes them. [SI]
    column : mapping of int to int
        Force of each station. [index]

    Returns
    -------
    Swings
        Their circuits and bases. [SI]
    """
    sheets = {motor.station: motor for motor in motors_from_data(case)}
    own = [sheets[str(name)] for name in case.motor_stations]
    pairs = list(zip(own, motors, strict=False))
    return Swings(
        np.arange(len(own), dtype=np.int64),
        np.array([column[m.station] for _, m in pairs], dtype=np.int64),
        tuple(_circuits_at_levels(data, m) for data, m in pairs),
        motors[0].pole_pairs * motors[0].synchronous_speed,
    )


def _circuits_at_levels(data: MotorFromData, motor: Motor) -> tuple[tuple[Circuit, Floats], ...]:
    """Circuit on each connection, and what its per unit is worth where the motor is on it. [pu, N m s/rad]"""
    base = data.torque_base / data.synchronous_speed
    circuits, above = [], -1.0
    for stage in data.stages:
        on = (above < LEVELS) & (stage.connection.until >= LEVELS)
        above = stage.connection.until
        circuits.append((stage.circuit, on * base * _source_factor(stage, motor, LEVELS)))
    return tuple(circuits)


def _source_factor(stage: Stage, motor: Motor, speed: Floats) -> Floats:
    """Square of the voltage of what feeds a motor, by table `SupplyVoltage` or by its connection. [1]"""
    if stage.connection.source == STIFF:
        return motor.torque_factor(speed)
    voltage = np.full(len(speed), stage.connection.source.voltage)
    if motor.soft is not None:
        voltage = voltage * motor.soft.voltage(speed)
    return np.asarray(motor.scale * voltage * voltage)


def electrical_damping_of(case: CaseData, modal: ModalTrain) -> tuple[ElectricalDamping, ...]:
    """What each motor makes of each mode that the start crosses, there and in operation.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]
    modal : ModalTrain
        Its train, modes and damping. [SI]

    Returns
    -------
    tuple of ElectricalDamping
        By mode, speed and motor. Rows of operation are those of motors with data, a field and a power factor.
        [SI]
    """
    line = case.ratings.line_frequency
    if not line or not case.motor_stations:
        return ()
    motors = motors_of(case, modal.train)
    sheets = {motor.station: motor for motor in motors_from_data(case)}
    rows: list[ElectricalDamping] = []
    for mode in range(modal.modes.n_rigid, modal.modes.n_modes):
        crossed = percent_speed(float(modal.modes.frequency[mode]), line)
        if crossed is None:
            break
        for speed in (0.01 * crossed, 1.0):
            rows += _at_one_speed(case, modal, mode, speed, motors, sheets)
    return tuple(rows)


def _at_one_speed(
    case: CaseData,
    modal: ModalTrain,
    mode: int,
    speed: float,
    motors: tuple[Motor, ...],
    sheets: dict[str, MotorFromData],
) -> Iterator[ElectricalDamping]:
    train, modes, damping = modal
    line, omega = case.ratings.line_frequency or 0.0, float(modes.omega[mode])
    found = []
    for motor in motors:
        name = train.stations[motor.station]
        angle = float(modes.shape[train.node_dof[motor.station], mode])
        angle *= float(train.node_scale[motor.station])
        gain = angle * angle
        slope = motor.average.slope(speed) / motor.synchronous_speed
        frequency = float(modes.frequency[mode]) / line
        k = _torque_over_speed(motor, sheets.get(name), speed, frequency)
        found.append((name, gain, slope, k))
    shares = [None if k is None else -0.5 * k.real * gain / omega for _, gain, _, k in found]
    own = float(damping.ratio[mode])
    known = [share for share in shares if share is not None]
    if speed == 1.0 and not known:
        return
    whole = own + total(known) if len(known) == len(shares) else None
    for (name, gain, slope, k), share in zip(found, shares, strict=True):
        yield ElectricalDamping(
            station=name,
            mode=mode - modes.n_rigid + 1,
            speed=speed,
            slope=slope,
            slope_share=-0.5 * slope * gain / omega,
            real=None if k is None else k.real,
            imaginary=None if k is None else k.imag,
            share=share,
            shift=None if k is None else 0.5 * gain * k.imag / (2.0 * math.pi),
            damping_ratio=own,
            with_motors=whole,
        )


def _torque_over_speed(
    motor: Motor, data: MotorFromData | None, speed: float, frequency: float
) -> complex | None:
    """K of one motor; in operation only where its data say how it is loaded. [N m s/rad]"""
    if data is None:
        return None
    at = np.array([frequency])
    if speed < 1.0:
        stage = data.stage_at(speed)
        if stage.circuit.reverse_resistance is not None:
            return None  # it is no linear circuit
        factor = _source_factor(stage, motor, np.array([speed]))
        k = factor * electrical_damping(stage.circuit, np.array([1.0 - speed]), at)
    else:
        loaded = data.sheet.power_factor
        if loaded is None or data.circuit.field is None:
            return None
        k = running_damping(data.circuit, loaded, at)
    return complex(k[0]) * data.torque_base / data.synchronous_speed
