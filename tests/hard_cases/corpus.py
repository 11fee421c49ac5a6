"""The named corpus of hard cases: trains in a line, so that every program can be asked.

Each case runs with default settings. A frequency case has its exact answer where there is a closed
form; a start says what an independent integrator is to calculate instead (`Truth`), where a rigid
link or a hub without weight would keep it from ever ending.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow
from tests.hard_cases.reference import Clearance, RigidLink
from tests.trains import LOAD, MOTOR, RATED, load, motor

Floats = NDArray[np.float64]

__all__ = [
    "CLEARANCES", "FREQUENCIES", "STARTS", "ClearanceCase", "FrequencyCase", "StartCase", "Truth",
]  # fmt: skip


# --- natural frequencies --------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class FrequencyCase:
    """Stations in a line; `exact` are its elastic frequencies [rad/s] from a closed form."""

    name: str
    inertia: Floats
    stiffness: Floats
    exact: Floats | None = None

    def case(self) -> CaseData:
        stations = tuple(StationRow(f"S{i}", None, float(J)) for i, J in enumerate(self.inertia))
        elements = tuple(
            ElementRow(f"E{i}", "shaft", f"S{i}", f"S{i + 1}", float(k))
            for i, k in enumerate(self.stiffness)
        )
        return CaseData(stations=stations, elements=elements)


def _ordinary(n: int, seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    return 10.0 ** rng.uniform(0.3, 2.3, n), 10.0 ** rng.uniform(6.0, 8.0, n - 1)


def _rigid_links() -> FrequencyCase:
    J, k = _ordinary(10, 1)
    k[[2, 5, 6]] = 1e18, 5e16, 1e18
    return FrequencyCase("rigid links to 1e18 N·m/rad", J, k)


def _inertia_ratio() -> FrequencyCase:
    J, k = _ordinary(10, 2)
    J[[1, 4, 8]] = 1e-12, 1e-6, 100.0
    J[0] = 1e2
    return FrequencyCase("inertia ratios to 1e14", J, k)


def _soft_couplings() -> FrequencyCase:
    J, k = _ordinary(10, 3)
    k[[3, 7]] = 1e-3, 1.0
    return FrequencyCase("soft couplings to 1e-3 N·m/rad", J, k)


def _near_equal(apart: float = 1e-9) -> FrequencyCase:
    """A wheel between two equal small ones: sqrt(k/j), and that times sqrt(1 + 2 j/J)."""
    wheel, spring = 50.0, 1e5
    small = apart * wheel  # of J/j = 1e9, the second is j/J above the first
    first = math.sqrt(spring / small)
    exact = np.array([first, first * math.sqrt(1.0 + 2.0 * small / wheel)])
    return FrequencyCase(
        "two modes 1e-9 apart", np.array([small, wheel, small]), np.full(2, spring), exact
    )


def _uniform(n: int = 1000) -> FrequencyCase:
    """A uniform chain, free at both ends: f_k = (1/π) √(k/J) sin(kπ/2n)."""
    J, k = 0.5, 2e6
    exact = 2.0 * math.sqrt(k / J) * np.sin(np.arange(1, n) * math.pi / (2 * n))
    return FrequencyCase("1,000 stations", np.full(n, J), np.full(n - 1, k), exact)


def _all_at_once() -> FrequencyCase:
    J, k = _ordinary(12, 4)
    k[[1, 5, 9]] = 1e18, 1e-3, 1e12
    J[[3, 8]] = 1e-12, 1e2
    return FrequencyCase("1e18 and 1e-3 N·m/rad, 1e14 in inertia, together", J, k)


FREQUENCIES: dict[str, FrequencyCase] = {
    c.name: c
    for c in (
        _rigid_links(), _inertia_ratio(), _soft_couplings(), _near_equal(), _uniform(),
        _all_at_once(),
    )
}  # fmt: skip


# --- starts ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Truth:
    """What the reference integrates.

    Parameters
    ----------
    case : Case
        The train itself, or its limit. [SI]
    step : float
        Its step; twice that must give the same answer. [s]
    outputs : tuple of int or None
        For each element of the hard case the output of the reference; None = one for one. [index]
    links : tuple of RigidLink
        Outputs beyond the elements. [index]
    breaks : tuple of (float, float)
        Speeds over synchronous between which the motor's curve as good as jumps. [1]
    """

    case: Case
    step: float
    outputs: tuple[int, ...] | None = None
    links: tuple[RigidLink, ...] = ()
    breaks: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, eq=False)
class StartCase:
    """A start with default settings, its outcome, and its truth.

    `costly`: what the test takes, more than a second or two.
    """

    name: str
    case: Case
    truth: Truth
    outcome: str = "reached"
    costly: bool = False


#: Damper over spring of the shafts of these trains: 1 % of critical at 32 Hz. [s]
BETA = 1e-4


def _case(
    inertia: list[float],
    stiffness: list[float],
    damping: list[float],
    *,
    motor_curve: object = MOTOR,
    load_curve: object = LOAD,
    load_at: int | None = None,
    rated: float = RATED,
    line: float = 60.0,
    poles: int = 4,
    **fields: object,
) -> Case:
    """Stations in a line, the motor on the first, the load on the last (or at `load_at`)."""
    n = len(inertia)
    at = n - 1 if load_at is None else load_at
    given: dict[str, object] = {
        "line_frequency": line,
        "poles": poles,
        "rated_torque": rated,
        "stations": tuple(StationRow(f"S{i}", None, float(J)) for i, J in enumerate(inertia)),
        "elements": tuple(
            ElementRow(f"E{i}", "shaft", f"S{i}", f"S{i + 1}", float(k), damping=float(c) or None)
            for i, (k, c) in enumerate(zip(stiffness, damping, strict=True))
        ),
        "motor_torque": motor("S0", rated, motor_curve),
        "load_torque": load(f"S{at}", rated, load_curve),
    }
    return Case(**(given | fields))  # type: ignore[arg-type]


def _chain(inertia: list[float], stiffness: list[float], **fields: object) -> Case:
    """The same with dampers in proportion to the springs."""
    return _case(inertia, stiffness, [BETA * k for k in stiffness], **fields)  # type: ignore[arg-type]


def _as_it_is(name: str, case: Case, step: float = 5e-5, **fields: object) -> StartCase:
    return StartCase(name, case, Truth(case, step), **fields)  # type: ignore[arg-type]


def _link_damping(k: float, before: float, after: float) -> float:
    """1 % of critical of the link's own mode."""
    return 0.02 * math.sqrt(k * before * after / (before + after))


def start_rigid_link() -> StartCase:
    k, link = [3e6, 2e6], 1e18
    hard = _case(
        [50.0, 20.0, 10.0, 60.0],
        [k[0], link, k[1]],
        [BETA * k[0], _link_damping(link, 20.0, 10.0), BETA * k[1]],
    )
    limit = _chain([50.0, 30.0, 60.0], k)
    truth = Truth(limit, 5e-5, (0, 2, 1), (RigidLink(behind=1, body=1, share=10.0 / 30.0),))
    return StartCase("rigid link of 1e18 N·m/rad", hard, truth)


def start_rigid_link_at_motor() -> StartCase:
    k, link = 2e6, 1e18
    hard = _case([50.0, 2.0, 60.0], [link, k], [_link_damping(link, 50.0, 2.0), BETA * k])
    limit = _chain([52.0, 60.0], [k])
    truth = Truth(limit, 5e-5, (1, 0), (RigidLink(behind=0, body=0, share=2.0 / 52.0),))
    return StartCase("rigid link of 1e18 N·m/rad at the motor", hard, truth)


def start_inertia_ratio() -> StartCase:
    """A coupling half of a milligram between two shafts, and an encoder of the same at the end."""
    k, beta = 3e6, 1e-6
    hard = _case([100.0, 1e-12, 80.0, 1e-12], [k, k, k], [beta * k] * 3, load_at=2)
    limit = _case([100.0, 80.0], [0.5 * k], [0.5 * beta * k])
    truth = Truth(limit, 5e-5, (0, 0, 1), (RigidLink(behind=-1, body=1, share=1e-12 / 80.0),))
    return StartCase("inertia ratio of 1e14", hard, truth)


def start_soft_coupling() -> StartCase:
    case = _chain([50.0, 40.0, 1e-4], [3e6, 1e-3], load_at=1)
    return _as_it_is("soft coupling of 1e-3 N·m/rad", case)


def start_near_equal() -> StartCase:
    """Equal encoders at both ends of a train, tuned to 100 Hz: they see each other through 1e-9."""
    small = 5e-8
    spring = small * (2.0 * math.pi * 100.0) ** 2
    J, k = [small, 50.0, 50.0, small], [spring, 3e6, spring]
    case = _chain(J, k, load_at=2, motor_torque=motor("S1"))
    first, *others = case.elements  # it drives its encoder: positive torque is away from the motor
    case = replace(case, elements=(replace(first, from_="S1", to="S0"), *others))
    return _as_it_is("modes 1e-9 apart", case)


def two_modes(inertia: list[float], low: float, high: float) -> list[float]:
    """Stiffnesses of a train of three whose modes are at `low` and `high` [Hz]."""
    a, b, c = inertia
    first, second = (2.0 * math.pi * low) ** 2, (2.0 * math.pi * high) ** 2
    product = first * second * a * b * c / (a + b + c)
    u, v, s = 1.0 / a + 1.0 / b, 1.0 / b + 1.0 / c, first + second
    k = (s + math.sqrt(s * s - 4.0 * u * v * product)) / (2.0 * u)
    return [k, product / k]


def start_two_line() -> StartCase:
    J = [500.0, 100.0, 300.0]
    k = two_modes(J, 0.2, 120.0)
    case = _case(J, k, [1e-5 * k[0], 1e-3 * k[1]])
    return _as_it_is("modes at 2 × line and at 0.2 Hz", case)


def start_undamped() -> StartCase:
    J, k = [2400.0, 720.0, 1200.0], [1e8, 5e7]
    case = _case(J, k, [0.0, 0.0])
    return _as_it_is("120 s without any damping", case, 1.5e-4)


def start_overdamped() -> StartCase:
    """A coupling at fifty times its critical damping, in a train of two."""
    J, k = [50.0, 60.0], 2e5
    critical = 2.0 * math.sqrt(k * J[0] * J[1] / sum(J))
    return _as_it_is("overdamped coupling, 50 × critical", _case(J, [k], [50.0 * critical]))


def start_overdamped_among() -> StartCase:
    """The same between shafts: it couples the modes."""
    J, k = [50.0, 20.0, 60.0], [3e6, 2e5]
    critical = 2.0 * math.sqrt(k[1] * J[1] * J[2] / (J[1] + J[2]))
    case = _case(J, k, [BETA * k[0], 50.0 * critical])
    return _as_it_is("overdamped coupling between shafts", case)


def start_pure_damper() -> StartCase:
    """A fluid coupling: slip and no spring; full torque at 8 rad/s of slip."""
    case = _case([50.0, 20.0, 60.0], [3e6, 0.0], [BETA * 3e6, RATED / 8.0])
    return _as_it_is("pure damper (fluid coupling)", case)


def start_thousand() -> StartCase:
    """A uniform chain of 1,000 stations, first mode at 20 Hz."""
    n, total = 1000, 50.0
    J = total / n
    case = _chain([J] * n, [J * (2.0 * n * 20.0) ** 2] * (n - 1))
    return _as_it_is("1,000 stations", case, 8e-6, costly=True)


def start_stall() -> StartCase:
    brake = ((0.0, 0.06), (0.3, 0.1), (0.7, 1.0), (1.0, 1.2))
    case = _chain([50.0, 20.0, 60.0], [3e6, 2e6], load_curve=brake)
    return _as_it_is("stall", case, outcome="stalled")


def start_barely() -> StartCase:
    """The load takes all but 0.1 % of rated torque at every speed."""
    torque = ((0.0, 0.5), (0.3, 0.55), (0.6, 0.7), (0.9, 0.8), (1.0, 0.5))
    drive = tuple((x, y, 0.05) for x, y in torque)
    brake = tuple((x, y - 1e-3) for x, y in torque)
    case = _chain([2.5, 0.5, 1.25], [7.5e4, 5e4], motor_curve=drive, load_curve=brake)
    # resonance carries the load across the knots of its curve twice a cycle: the truth needs short steps, too
    return _as_it_is("barely accelerating, net torque 0.1 %", case, 5e-5)


def start_step(width: float | None = 1e-9) -> StartCase:
    """Average torque drops from 0.8 to 0.4 of rated at half speed; None = the next number there is."""
    at = 0.5
    next_to = float(np.nextafter(at, 1.0)) if width is None else at + width
    curve = (
        (0.0, 0.6, 0.25), (at, 0.8, 0.25), (next_to, 0.4, 0.1), (0.9, 0.7, 0.2), (1.0, 0.0, 0.2),
    )  # fmt: skip
    case = _chain([50.0, 20.0, 60.0], [3e6, 2e6], motor_curve=curve)
    case = replace(
        case, torque_follows="own speed"
    )  # the reference finds the jump of the motor's own speed
    how = "1e-9 of speed" if width else "no number between"
    truth = Truth(case, 2.5e-5, breaks=((at, next_to),))
    return StartCase(f"vertical step in the curve, {how}", case, truth)


def start_line(line: float, poles: int) -> StartCase:
    """A train for each motor: its modes at 0.4 and 1.2 × line, and run up in about 2 s."""
    speed = 4.0 * math.pi * line / poles
    scale = RATED / speed * 1.2
    J = [0.5 * scale, 0.2 * scale, 0.6 * scale]
    case = _chain(J, two_modes(J, 0.4 * line, 1.2 * line), line=line, poles=poles)
    return _as_it_is(f"{poles} poles, {line:g} Hz", case)


STARTS: dict[str, StartCase] = {
    c.name: c
    for c in (
        start_rigid_link(), start_rigid_link_at_motor(), start_inertia_ratio(),
        start_soft_coupling(), start_near_equal(), start_two_line(), start_undamped(),
        start_overdamped(), start_overdamped_among(), start_pure_damper(), start_thousand(),
        start_stall(), start_barely(), start_step(), start_step(None),
        *(start_line(f, p) for f, p in ((60.0, 2), (60.0, 40), (16.7, 4), (50.0, 4), (60.0, 4))),
    )
}  # fmt: skip


# --- clearances -----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ClearanceCase:
    """A start with clearances.

    Parameters
    ----------
    name : str
        What it is called. [text]
    case : Case
        With its Meshes; stiffness and damping of the contacts are those of table Elements. [SI]
    clearances : dict of str to Clearance
        Element → total gap on its From side, and law. [rad]
    step : float
        Of the reference. [s]
    end : float
        Stretch that is compared, from rest. [s]
    impacts : int
        Each clearance meets at least so often. [count]
    """

    name: str
    case: Case
    clearances: dict[str, Clearance]
    step: float
    end: float
    impacts: int = 1


PITCH_RADIUS, PRESSURE_ANGLE = 0.3, math.radians(20.0)


def _with_gap(case: Case, gaps: dict[str, float], contact_damping: float) -> Case:
    """Elements named become geared couplings of that angular clearance."""
    elements = tuple(
        replace(e, kind="coupling", damping=contact_damping * (e.stiffness or 0.0))
        if e.element in gaps
        else e
        for e in case.elements
    )
    meshes = tuple(MeshRow(name, angular_backlash=gap) for name, gap in gaps.items())
    return replace(case, elements=elements, meshes=meshes)


def _with_teeth(case: Case, name: str, backlash: float, contact_damping: float) -> Case:
    """The element becomes a gear mesh of ratio 1 with a normal backlash [m]."""
    elements = tuple(
        replace(e, kind="gear mesh", damping=contact_damping * (e.stiffness or 0.0))
        if e.element == name
        else e
        for e in case.elements
    )
    mesh = MeshRow(
        name,
        pitch_radius_drive=PITCH_RADIUS,
        pitch_radius_driven=PITCH_RADIUS,
        pressure_angle=PRESSURE_ANGLE,
        backlash=backlash,
    )
    return replace(case, elements=elements, meshes=(mesh,))


#: Strong pulsation and a light load: the torque of the mesh reverses all through the start.
SHAKY = ((0.0, 0.35, 0.9), (0.5, 0.4, 0.9), (0.9, 0.5, 0.8), (1.0, 0.0, 0.4))
IDLE = ((0.0, 0.02), (1.0, 0.05))


def _shaky(damping: float = 1e-3) -> Case:
    return _case(
        [50.0, 20.0, 15.0, 30.0],
        [3e6, 5e7, 4e6],
        [BETA * 3e6, damping * 5e7, BETA * 4e6],
        motor_curve=SHAKY,
        load_curve=IDLE,
    )


def clearance_of_teeth(backlash: float, name: str, law: str = "limited") -> ClearanceCase:
    case = _with_teeth(_shaky(), "E1", backlash, 1e-3)
    gap = backlash / (PITCH_RADIUS * math.cos(PRESSURE_ANGLE))
    return ClearanceCase(name, case, {"E1": Clearance(gap, law)}, 5e-6, 0.6)


def clearance_chatter() -> ClearanceCase:
    """A light wheel behind a coupling with play, far from any resonance, rattles through a start."""
    case = _case(
        [200.0, 1.0],
        [2e5],
        [0.0],
        motor_curve=((0.0, 0.3, 0.9), (0.95, 0.3, 0.9), (1.0, 0.3, 0.9)),
        load_curve=((0.0, 0.0005), (1.0, 0.0005)),
    )
    case = _with_gap(case, {"E0": 1e-4}, 2e-3)
    return ClearanceCase(
        "a mesh that chatters a thousand times", case, {"E0": Clearance(1e-4)}, 1e-5, 9.0, 1000
    )


def clearance_two() -> ClearanceCase:
    case = _case(
        [200.0, 2.0, 1.0],
        [4e5, 2e5],
        [0.0, 0.0],
        motor_curve=((0.0, 0.3, 0.9), (0.95, 0.3, 0.9), (1.0, 0.3, 0.9)),
        load_curve=((0.0, 0.0005), (1.0, 0.0005)),
    )
    gaps = {"E0": 1e-4, "E1": 2e-4}
    return ClearanceCase(
        "two meshes that chatter together",
        _with_gap(case, gaps, 2e-3),
        {name: Clearance(gap) for name, gap in gaps.items()},
        1e-5,
        9.0,
        100,
    )


CLEARANCES: dict[str, Callable[[], ClearanceCase]] = {
    "clearance of 1 µm": lambda: clearance_of_teeth(1e-6, "clearance of 1 µm"),
    "clearance of 50 mm": lambda: clearance_of_teeth(0.05, "clearance of 50 mm"),
    "a mesh that chatters a thousand times": clearance_chatter,
    "two meshes that chatter together": clearance_two,
}
