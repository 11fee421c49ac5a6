"""What shakes the train in continuous operation: orders and frequencies, and the torque they bring.

The table `Excitations` says it; left empty, it is 1× and 2× of every shaft speed and of the line
frequency. Without a torque of its own an excitation is the paper's "approximately 1 percent
zero-peak of the transmitted torque", applied in turn at the motor, at each gear and at each driven
machine, so the torque transmitted in continuous operation is worked out here too.

Torques are at the speed of the station or element they belong to, unless called referred.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Steady state
torsional analysis".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.model.train import Train
from engine.motor.from_case import motors_without_curve
from engine.numerics.same_bits import product

#: The paper's excitation, zero-to-peak, over the transmitted torque. [1]
DEFAULT_SHARE = 0.01
#: Multiples of each shaft speed and of the line frequency where `Excitations` is empty. [1]
DEFAULT_ORDERS = (1, 2)
#: Speed ratios closer than this belong to one shaft.
SAME_RATIO = 1e-9


@dataclass(frozen=True)
class Excitation:
    """One thing that shakes the train: a multiple of a shaft's speed, or a fixed frequency."""

    name: str  #: Name.
    #: Multiple of the speed of `of_station`; None for a fixed frequency. [1]
    order: float | None = None
    ratio: float = 1.0  #: Speed of that station over the speed of the reference shaft. [1]
    of_station: str | None = None  #: Station whose speed counts; None = the reference shaft.
    frequency: float | None = None  #: Fixed frequency; None for an order. [Hz]
    station: str | None = None  #: Where it acts; None = motor, gears and driven machines in turn.
    #: Zero-to-peak torque at the speed of the station where it acts. [N m]
    torque: float | None = None
    torque_share: float | None = None  #: Zero-to-peak torque over the torque transmitted there. [1]

    def frequency_at(self, speed: float) -> float:
        """Frequency of the excitation.

        Parameters
        ----------
        speed : float
            Speed of the reference shaft; any for a fixed frequency. [rad/s]

        Returns
        -------
        float
            Frequency. [Hz]
        """
        if self.frequency is not None:
            return self.frequency
        assert self.order is not None
        return self.order * self.ratio * speed / (2.0 * math.pi)


def operating_range(case: CaseData) -> tuple[float, float] | None:
    """Speeds of continuous operation, MinimumSpeed to MaximumSpeed, blank = synchronous.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    tuple of float, or None
        Lowest and highest speed of the reference shaft; None where it is unknown. [rad/s]
    """
    synchronous = case.ratings.synchronous_speed
    low = case.minimum_speed if case.minimum_speed is not None else synchronous
    high = case.maximum_speed if case.maximum_speed is not None else synchronous
    low = low if low is not None else high
    high = high if high is not None else low
    if low is None or high is None:
        return None
    return low, max(low, high)


def excitations_of(case: CaseData, train: Train) -> tuple[Excitation, ...]:
    """Excitations of a case: its table, or 1× and 2× of every shaft speed and of the line.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    tuple of Excitation
        In the order of the table; the default: shaft speeds, then line frequency. [count]
    """
    if not case.excitations:
        return _shaft_speeds(case, train) + _line_frequencies(case)
    excitations = []
    for number, row in enumerate(case.excitations, start=1):
        ratio = 1.0
        if row.of_station is not None:
            ratio = float(train.speed_ratio[train.stations.index(row.of_station)])
        excitations.append(
            Excitation(
                row.name or f"Excitation {number}",
                row.order,
                ratio,
                row.of_station,
                row.frequency,
                row.station,
                row.torque,
                row.torque_share,
            )
        )
    return tuple(excitations)


def _shaft_speeds(case: CaseData, train: Train) -> tuple[Excitation, ...]:
    """1× and 2× of every distinct shaft speed; a shaft is called after its first gear."""
    gears = {
        name for e in case.elements if e.kind == ElementKind.GEAR_MESH for name in (e.from_, e.to)
    }
    shafts: list[tuple[float, str]] = []
    for name, ratio in zip(train.stations, train.speed_ratio.tolist(), strict=False):
        same = [i for i, (r, _) in enumerate(shafts) if abs(r / ratio - 1.0) <= SAME_RATIO]
        if not same:
            shafts.append((ratio, name))
        elif name in gears and shafts[same[0]][1] not in gears:
            shafts[same[0]] = (shafts[same[0]][0], name)
    shafts.sort(key=lambda shaft: abs(shaft[0] - 1.0) > SAME_RATIO)  # the reference shaft first
    speeds = []
    for ratio, name in shafts:
        reference = abs(ratio - 1.0) <= SAME_RATIO
        for order in DEFAULT_ORDERS:
            title = f"{order}× {'motor' if reference else name} speed"
            of_station = None if reference else name
            speeds.append(Excitation(title, float(order), ratio, of_station))
    return tuple(speeds)


def _line_frequencies(case: CaseData) -> tuple[Excitation, ...]:
    line = case.ratings.line_frequency
    if not line:
        return ()
    return tuple(Excitation(f"{n}× line", frequency=n * line) for n in DEFAULT_ORDERS)


# --- torque transmitted in continuous operation ---------------------------------------------------


@dataclass(frozen=True, eq=False)
class TransmittedTorque:
    """Torque of every part of the train in continuous operation."""

    load: Floats  #: Absorbed by each station, at its own speed. [N m] Shape (n_stations,).
    #: Delivered by each motor in balance with the loads, at its own speed. [N m] Shape
    #: (n_stations,).
    motor: Floats
    #: Transmitted by each element at its own speed (a mesh: on its From side). [N m] Shape
    #: (n_elements,).
    element: Floats
    #: Share of RatedTorque of each motor, at its own speed; 0 if RatedTorque is unknown. [N m]
    #: Shape (n_stations,).
    rated: Floats
    warnings: tuple[str, ...]  #: What was assumed, or could not be known.


def transmitted_torque(case: CaseData, train: Train) -> TransmittedTorque:
    """Torque transmitted in continuous operation: the sum of the Running loads beyond.

    Running load blank everywhere = RatedTorque shared in proportion to the power of LoadTorque at
    its highest speed. Several motors share the total in proportion to the power of their largest
    average torque; those beyond an element are subtracted. Elements side by side share by
    stiffness.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    TransmittedTorque
        Zero, with a warning, where the case states no loads. [N m]
    """
    n = train.n_stations
    ratio = train.speed_ratio[:n]
    warnings: list[str] = []
    referred = _referred_loads(case, train, warnings)
    share = _motor_shares(case, train, warnings)
    motor = share * float(referred.sum())
    beyond = product(train.beyond.astype(float), referred - motor)
    ratios = case.element_speed_ratios
    own_speed = np.array([ratios[e.element] for e in case.elements])
    element = beyond / own_speed * _parallel_shares(case, train)
    rated = case.ratings.rated_torque or 0.0
    if not rated:
        warnings.append(
            "RatedTorque is unknown: the excitation at the motor is a share of the torque that balances "
            "the loads. Type RatedTorque or RatedPower."
        )
    return TransmittedTorque(
        referred / ratio, motor / ratio, element, rated * share / ratio, tuple(warnings)
    )


def _referred_loads(case: CaseData, train: Train, warnings: list[str]) -> Floats:
    """Load of each station in continuous operation, referred to the reference shaft."""
    n = train.n_stations
    ratio = train.speed_ratio[:n]
    if any(s.running_load is not None for s in case.stations):
        return np.array([s.running_load or 0.0 for s in case.stations]) * ratio
    highest = np.zeros(n)
    top = dict.fromkeys(range(n), -math.inf)
    for point in case.load_torque:
        i = train.stations.index(str(point.station))
        if point.speed is not None and point.torque is not None and point.speed > top[i]:
            top[i] = point.speed
            highest[i] = ratio[i] * point.torque
    total = float(highest.sum())
    rated = case.ratings.rated_torque
    if total <= 0.0:
        warnings.append(
            "The transmitted torque is unknown: Running load is blank at every station and there "
            "is no LoadTorque. The start runs without load. The forced response is excited at "
            "the motor only, so no separation margin can be accepted by it. Type Running load or "
            "LoadTorque."
        )
        return np.zeros(n)
    if rated is None:
        warnings.append(
            "Running load is blank at every station and RatedTorque is unknown: LoadTorque "
            "at its highest speed is used as running load."
        )
        return highest
    return highest * (rated / total)


def _motor_shares(case: CaseData, train: Train, warnings: list[str]) -> Floats:
    """Share of each station in the power delivered, summing to one."""
    share = np.zeros(train.n_stations)
    for point in case.motor_torque:
        i = train.stations.index(str(point.station))
        share[i] = max(share[i], abs(point.average or 0.0) * float(train.speed_ratio[i]))
    for name, motor in motors_without_curve(case).items():
        i = train.stations.index(name)
        share[i] = float(np.max(np.abs(motor.stages[-1].curves[0].cubic[:, 0]))) * float(
            train.speed_ratio[i]
        )
    if share.sum() > 0.0:
        return np.asarray(share / share.sum())
    first = train.stations[0]
    if case.motor_stations:
        first = str(case.motor_stations[0])
    else:
        warnings.append(
            f"There is no MotorTorque: '{first}', the first station, is taken as the motor."
        )
    share[train.stations.index(first)] = 1.0
    return share


def _parallel_shares(case: CaseData, train: Train) -> Floats:
    """Share of each element among those side by side; a pure damper transmits nothing steady."""
    compliance = np.zeros(len(case.elements))
    own = train.element_rows
    np.add.at(compliance, train.row_element[own], 1.0 / np.maximum(train.stiffness[own], 1e-300))
    stiffness = np.where(compliance > 0.0, 1.0 / np.where(compliance > 0.0, compliance, 1.0), 0.0)
    pairs: dict[frozenset[str | None], list[int]] = {}
    for i, e in enumerate(case.elements):
        pairs.setdefault(frozenset((e.from_, e.to)), []).append(i)
    share = np.ones(len(case.elements))
    for side_by_side in pairs.values():
        total = float(stiffness[side_by_side].sum())
        if len(side_by_side) > 1 and total > 0.0:
            share[side_by_side] = stiffness[side_by_side] / total
    return share


# --- where it acts --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Place:
    """A station where an excitation acts."""

    station: int  #: Station.
    torque: float  #: Zero-to-peak torque at the station's own speed. [N m]


def excitation_places(
    case: CaseData, train: Train, transmitted: TransmittedTorque, excitation: Excitation
) -> tuple[Place, ...]:
    """Where an excitation acts, and with how much torque at each place.

    A station is given: there. None is given: in turn at each motor, gear and driven machine. A
    torque in N m acts unchanged at each place; a share, or the paper's 1 % where neither is
    given, is of RatedTorque at a motor, of the mesh torque at a gear, of its Running load at a
    driven machine, and of the largest torque of the adjoining elements at any other station.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    transmitted : TransmittedTorque
        Torques in continuous operation. [N m]
    excitation : Excitation
        The excitation. [SI]

    Returns
    -------
    tuple of Place
        Only places with a torque; empty where no torque is known. [count]
    """
    places = _default_places(case, train, transmitted)
    if excitation.station is not None:
        i = train.stations.index(excitation.station)
        places = {i: places.get(i) or _adjoining(case, train, transmitted, i)}
    share = DEFAULT_SHARE if excitation.torque_share is None else excitation.torque_share
    torques = {
        i: share * share_by_station if excitation.torque is None else excitation.torque
        for i, share_by_station in places.items()
    }
    return tuple(Place(i, abs(torque)) for i, torque in torques.items() if torque)


def _default_places(
    case: CaseData, train: Train, transmitted: TransmittedTorque
) -> dict[int, float]:
    """Motors, gears and driven machines with the torque transmitted there, by station."""
    machine_names = {p.station for p in case.load_torque}
    machine_names |= {s.station for s in case.stations if s.running_load}
    share_by_station: dict[int, float] = {}
    for i in np.flatnonzero((transmitted.rated != 0.0) | (transmitted.motor != 0.0)).tolist():
        share_by_station[i] = float(transmitted.rated[i] or transmitted.motor[i])
    for e, torque in zip(case.elements, transmitted.element.tolist(), strict=True):
        if e.kind == ElementKind.GEAR_MESH:
            a, b = train.stations.index(str(e.from_)), train.stations.index(str(e.to))
            back = float(train.speed_ratio[a] / train.speed_ratio[b])
            share_by_station[a] = max(share_by_station.get(a, 0.0), abs(torque))
            share_by_station[b] = max(share_by_station.get(b, 0.0), abs(torque) * back)
    for i, name in enumerate(train.stations):
        if name in machine_names:
            share_by_station[i] = max(share_by_station.get(i, 0.0), abs(float(transmitted.load[i])))
    return share_by_station


def _adjoining(case: CaseData, train: Train, transmitted: TransmittedTorque, station: int) -> float:
    """Largest torque of the shafts that meet at a station, at its speed."""
    name = train.stations[station]
    torques = [
        abs(torque)
        for e, torque in zip(case.elements, transmitted.element.tolist(), strict=True)
        if name in (e.from_, e.to) and e.kind != ElementKind.GEAR_MESH
    ]
    return max(torques, default=0.0)
