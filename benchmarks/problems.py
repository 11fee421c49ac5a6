"""The trains, torques and starts that are calculated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from addin.contract.shipped import template_path
from addin.reading.one_file import read_checked
from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, StationRow

__all__ = [
    "MOTOR", "RESPONSE", "RIGID", "Chain", "Sweep", "long_start", "random_chain", "start_of_size",
    "ten",
]  # fmt: skip

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Chain:
    """Stations in a line, as every program under comparison can take them.

    Parameters
    ----------
    name : str
        What it is called in tables. [text]
    inertia : ndarray, shape (n,)
        Of each station. [kg m²]
    stiffness, damping : ndarray, shape (n − 1,)
        Between neighbours. [N m/rad, N m s/rad]
    """

    name: str
    inertia: Floats
    stiffness: Floats
    damping: Floats

    @property
    def n(self) -> int:
        return len(self.inertia)

    def as_lists(self) -> dict[str, list[float]]:
        """As JSON takes it."""
        return {
            "inertia": self.inertia.tolist(),
            "stiffness": self.stiffness.tolist(),
            "damping": self.damping.tolist(),
        }

    def case(self) -> CaseData:
        """As the engine takes it."""
        stations = tuple(StationRow(f"S{i}", None, float(J)) for i, J in enumerate(self.inertia))
        elements = tuple(
            ElementRow(f"E{i}", "shaft", f"S{i}", f"S{i + 1}", float(k), damping=float(c))
            for i, (k, c) in enumerate(zip(self.stiffness, self.damping, strict=True))
        )
        return CaseData(stations=stations, elements=elements)


#: Damper over spring of every element: 0.9 % of critical at 30 Hz. [s]
DAMPING_TIME = 1e-4
#: A geared motor-compressor train referred to one speed: motor (station 1), bull gear (4), mesh
#: (element 4), two impeller groups.
TEN_INERTIAS = (5.0, 250.0, 12.0, 10.0, 180.0, 4.0, 3.0, 3.0, 25.0, 8.0)
TEN_STIFFNESSES = (4e7, 3e7, 6e6, 5e7, 5e8, 2.5e7, 3e6, 3e7, 2e7)
MOTOR, MESH = 1, 4
RIGID = 5e16


def chain(name: str, inertia: object, stiffness: object) -> Chain:
    """A chain with damping in proportion to stiffness."""
    J, k = np.array(inertia, dtype=float), np.array(stiffness, dtype=float)
    return Chain(name, J, k, DAMPING_TIME * k)


def ten(mesh: float | None = None) -> Chain:
    """Ten stations; `mesh` replaces the stiffness of the gear mesh."""
    k = list(TEN_STIFFNESSES)
    if mesh is None:
        return chain("10 stations", TEN_INERTIAS, k)
    k[MESH] = mesh
    return chain("10, one link 5e16 N·m/rad", TEN_INERTIAS, k)


def random_chain(n: int) -> Chain:
    """Machines in a line: bodies of 2 to 250 kg m², shafts of 1e7 to 5e8, every eighth a coupling."""
    rng = np.random.default_rng(n)
    J = np.exp(rng.uniform(np.log(2.0), np.log(250.0), n))
    k = np.exp(rng.uniform(np.log(1e7), np.log(5e8), n - 1))
    k[3::8] = np.exp(rng.uniform(np.log(2e6), np.log(8e6), len(k[3::8])))
    return chain(f"{n} stations", J, k)


@dataclass(frozen=True)
class Sweep:
    """A prescribed air-gap torque: what accelerates, and a pulsation that falls to rest.

    Parameters
    ----------
    average, pulsating : float
        Constant part, and amplitude of the pulsation. [N m]
    first_frequency : float
        Of the pulsation at t = 0; it falls linearly to zero. [Hz]
    duration : float
        How long. [s]
    """

    average: float
    pulsating: float
    first_frequency: float
    duration: float

    def __call__(self, t: Floats) -> Floats:
        """Torque at times. [N m]"""
        turns = self.first_frequency * (t - 0.5 * t * t / self.duration)
        return self.average + self.pulsating * np.sin(2.0 * np.pi * turns)


#: 500 kg m² to 1800 rpm in 15 s, half the rated torque of 4.5 MW pulsating, 120 → 0 Hz.
RESPONSE = Sweep(
    average=sum(TEN_INERTIAS) * (60.0 * np.pi) / 15.0,
    pulsating=0.5 * 4.5e6 / (60.0 * np.pi),
    first_frequency=120.0,
    duration=15.0,
)


#: Voltage at which the shipped example takes 15 s to 97 % speed.
LONG_START_VOLTAGE = 0.77


def long_start() -> Case:
    """The shipped example `proposed` with ten stations, started in 15 s at reduced voltage.

    The hub before the last compressor joins the compressor; both springs in series.
    """
    case = _example()
    hub, last = case.stations[-2:]
    spring, shaft = case.elements[-2:]
    k = 1.0 / (1.0 / (spring.stiffness or 1.0) + 1.0 / (shaft.stiffness or 1.0))
    return replace(
        case,
        voltage=LONG_START_VOLTAGE,
        stations=(
            *case.stations[:-2],
            replace(last, inertia=(last.inertia or 0.0) + (hub.inertia or 0.0)),
        ),
        elements=(*case.elements[:-2], replace(shaft, from_=spring.from_, stiffness=k)),
    )


def start_of_size(n: int, voltage: float = 1.0) -> Case:
    """The example with every station behind the last compressor's split: `n` stations in all.

    The last compressor becomes `n − 10` equal discs on equal springs, soft enough that about half
    of the new modes lie below twice line frequency.
    """
    case = long_start()
    extra = n - case_size(case)
    if extra <= 0:
        return replace(case, voltage=voltage)
    last, shaft = case.stations[-1], case.elements[-1]
    names = [str(last.station), *(f"Disc {i + 1}" for i in range(extra))]
    share = (last.inertia or 0.0) / len(names)
    stations = [replace(last, inertia=share)]
    stations += [StationRow(name, None, share, last.speed_ratio) for name in names[1:]]
    spring = share * (2.0 * np.pi * 120.0) ** 2 / 2.0
    elements = [
        replace(shaft, element=f"Disc shaft {i + 1}", from_=a, to=b, stiffness=spring)
        for i, (a, b) in enumerate(zip(names[:-1], names[1:], strict=True))
    ]
    return replace(
        case,
        voltage=voltage,
        stations=(*case.stations[:-1], *stations),
        elements=(*case.elements, *elements),
    )


def case_size(case: CaseData) -> int:
    """Number of stations."""
    return len(case.stations)


def _example() -> Case:
    read = read_checked(template_path("example_proposed.xlsx"))
    return read.case()
