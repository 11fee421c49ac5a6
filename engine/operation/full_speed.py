"""The train at full speed in a few numbers, by which a reader sees a wrong unit before anything else."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from engine.case.data import CaseData
from engine.model.excitation import transmitted_torque
from engine.model.train import Train
from engine.numerics.same_bits import interp, product, total


@dataclass(frozen=True)
class ShaftSpeed:
    """Everything that turns at one speed."""

    station: str  #: The first station of that speed in table Stations.
    speed: float  #: Its speed with the motor at synchronous speed. [rad/s]


@dataclass(frozen=True)
class FullSpeed:
    """A train with its motor at synchronous speed; what is not known is None."""

    line_frequency: float | None  #: Line frequency. [Hz]
    poles: int | None  #: Number of poles. [count]
    rated_power: float | None  #: Rated power. [W]
    rated_torque: float | None  #: Rated torque. [N m]
    shafts: tuple[ShaftSpeed, ...]  #: In the order of the stations; empty without a speed. [rad/s]
    total_ratio: float  #: Speed ratio that is farthest from 1. [1]
    inertia_constant: float | None  #: H = Σ ½ J ω² / P of the train. [s]
    motor_inertia_constant: float | None  #: The same of the Inertia typed at the motors. [s]
    #: LoadTorque at synchronous speed, referred to the motor, over the rated torque. [1]
    load: float | None
    #: The same of column Running load; where it is blank, of the torque that is taken for it. [1]
    running_load: float | None


def full_speed(case: CaseData, train: Train) -> FullSpeed:
    """The train at full speed in a few numbers.

    Parameters
    ----------
    case : CaseData
        A case without errors. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    FullSpeed
        What is known. [SI]
    """
    ratings, n = case.ratings, train.n_stations
    speed, power, torque = ratings.synchronous_speed, ratings.rated_power, ratings.rated_torque
    ratio = train.speed_ratio[:n]
    first: dict[float, str] = {}
    for name, r in zip(train.stations, ratio.tolist(), strict=True):
        first.setdefault(r, name)
    constant = own = None
    if speed and power:
        constant = _finite(
            0.5 * float(product(train.inertia, train.dof_ratio**2)) * speed * speed / power
        )
        motors = set(case.motor_stations)
        typed = total(
            (s.inertia or 0.0) * r * r
            for s, r in zip(case.stations, ratio.tolist(), strict=True)
            if s.station in motors
        )
        own = _finite(0.5 * typed * speed * speed / power) if typed else None
    load = running = None
    if torque:
        if case.load_torque:
            load = _finite(total(_loads_at_full_speed(case)) / torque)
        stated = [(s.running_load, r) for s, r in zip(case.stations, ratio.tolist(), strict=True)]
        if any(t is not None for t, _ in stated):
            running = _finite(total((t or 0.0) * r for t, r in stated) / torque)
        elif case.load_torque:
            running = _finite(float(product(transmitted_torque(case, train).load, ratio)) / torque)
    return FullSpeed(
        line_frequency=ratings.line_frequency,
        poles=2 * ratings.pole_pairs if ratings.pole_pairs else None,
        rated_power=power,
        rated_torque=torque,
        shafts=tuple(ShaftSpeed(name, r * speed) for r, name in first.items()) if speed else (),
        total_ratio=max(ratio.tolist(), key=lambda r: max(r, 1.0 / r), default=1.0),
        inertia_constant=constant,
        motor_inertia_constant=own,
        load=load,
        running_load=running,
    )


def _loads_at_full_speed(case: CaseData) -> Iterator[float]:
    """LoadTorque of each station at its synchronous speed, referred to the motor. [N m]"""
    for station in dict.fromkeys(p.station for p in case.load_torque):
        points = [p for p in case.load_torque if p.station == station]
        speeds = [p.speed or 0.0 for p in points]
        at_full = float(interp(1.0, speeds, [p.torque or 0.0 for p in points]))
        yield at_full * case.speed_ratios.get(station, 1.0)


def _finite(value: float) -> float | None:
    """The value; None where inputs of absurd size make it infinite."""
    return value if math.isfinite(value) else None
