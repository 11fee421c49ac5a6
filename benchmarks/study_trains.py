"""The trains of the tolerance study, each from its number alone.

Even numbers are linear, odd ones have clearances. Every twentieth pair has nothing that the
independent integrator lacks: viscous dampers that couple the modes instead of damping ratios, no
rigid meshes, no bearings. The generators are those of the tests. Starts of the numbers from `LEAVES_MODES` on are
linear and leave modes out; those from `LEAVES_EFFECT` on leave out an effect with a bound that is not zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import EffectChoiceRow, ElementRow, MeshRow
from engine.plan.evidence import BACKLASH_GAIN
from engine.run import run
from tests.random_effects import (
    with_bearings,
    with_clearances,
    with_judged_shafts,
    with_shock,
)
from tests.random_starts import random_start

__all__ = ["StudyTrain", "gaps_of", "study_train"]

#: Tolerance of peaks → of starts. The first is the default.
STARTS_TOLERANCE = {1e-3: 2e-2, 1e-2: 1e-1, 1e-4: 2e-3}
#: Numbers modulo 20 of trains that the independent integrator can calculate, and of those of other
#: tolerances of peaks.
INDEPENDENT, OTHER_TOLERANCE = (0, 1), {4: 1e-2, 5: 1e-2, 6: 1e-4, 7: 1e-4}
#: Numbers of one generator are so far apart that two trains share none.
APART = 10_000
#: Clearances of one train, at the most.
MOST_CLEARANCES = 2
#: Draws of one train until it has what it should have.
DRAWS = 400
#: Trains from this number on leave modes out of their start, which is linear; the draw at which each did so.
LEAVES_MODES = 5_000_000
# fmt: off
DRAW_THAT_LEAVES_MODES = (
    3, 1, 21, 13, 7, 2, 11, 15, 78, 41, 26, 4, 4, 4, 1, 0, 6, 0, 8, 29, 56, 16, 20, 34, 2, 14, 16,
    32, 0, 11, 8, 32, 3, 14, 6, 9, 10, 7, 4, 1, 1, 5, 9, 9, 3, 20, 25, 6, 62, 14, 8, 23, 7, 16, 36,
    12, 14, 2, 29, 34, 11, 0, 6, 13, 5, 20, 7, 18, 31, 12, 14, 18, 16, 40, 7, 2, 7, 2, 3, 5, 8, 57,
    2, 29, 5, 1, 89, 0, 43, 21, 11, 5, 29, 34, 12, 17, 60, 8, 0, 4,
)
# fmt: on
#: Trains from this number on leave one of these effects out, in turn, with a bound.
LEAVES_EFFECT = 6_000_000
LEFT_OUT = ("bearings", "coupled damping", "breaker closing", "backlash")
#: What an effect that is left out has of what other trains have, as powers of ten.
LITTLE = (-6.0, -2.0)
#: Lowest torque of a backlash that is left out, over the limit at which it would be simulated: beyond -1 it is not.
NEAR_ZERO = (-1.0, 2.0)
#: Share of the tolerance to which that lowest torque is found, and halvings of its bracket at the most.
NEAR_ENOUGH, HALVINGS = 0.02, 30
#: Share of the trains on bearings whose other meshes have a backlash, too, and that backlash: with none gears on
#: bearings have no bound once their torque reverses. [1, m]
SMALL_GAPS, SMALL_GAP = 0.9, (5e-5, 4e-4)
#: Frequency at which the two ends of a clearance ring on its teeth, at the most. [Hz]
TEETH = (300.0, 3000.0)
#: Damping ratio of one element between its two ends alone. [1]
DAMPED = (0.005, 0.05)
#: Rate at which a damper alone slows its two ends, at the most. [1/s]
FASTEST_DAMPER = 1000.0


@dataclass(frozen=True, eq=False)
class StudyTrain:
    """One train of the study.

    Parameters
    ----------
    number, seed : int
        Of the study, and of the generators. [1]
    case : Case
        The case, its tolerances stated. [SI]
    extras : tuple of str
        What it has beyond a plain train. [words]
    independent : bool
        Whether the independent integrator can calculate it. [flag]
    """

    number: int
    seed: int
    case: Case
    extras: tuple[str, ...]
    independent: bool

    @property
    def clearance(self) -> bool:
        """Whether it has clearances. [flag]"""
        return "clearances" in self.extras

    @property
    def tolerances(self) -> tuple[float, float]:
        """Of peaks and of starts. [1]"""
        peak = self.case.tolerance_peak or 1e-3
        return peak, STARTS_TOLERANCE[peak]


def study_train(number: int) -> StudyTrain:
    """A train of the study; of the seeds that belong to its number the first that will do."""
    at = number - LEAVES_MODES
    stored = 0 <= at < len(DRAW_THAT_LEAVES_MODES)
    for attempt in (DRAW_THAT_LEAVES_MODES[at],) if stored else range(DRAWS):
        seed = number + attempt * APART
        if number >= LEAVES_EFFECT:
            case, extras = _drawn_without(LEFT_OUT[number % len(LEFT_OUT)], number, seed)
        else:
            case, extras = _drawn(number, seed)
        if case is not None:
            independent = number % 20 in INDEPENDENT and number < LEAVES_EFFECT
            return StudyTrain(number, seed, case, extras, independent)
    raise ValueError(f"no seed gives train number {number} what it should have")


def _drawn(number: int, seed: int) -> tuple[Case | None, tuple[str, ...]]:
    """One draw; None if it lacks what it should have."""
    rng = np.random.default_rng((seed, 20))
    case, extras = random_start(seed), []
    independent = number % 20 in INDEPENDENT
    if independent:
        stiffest = max(e.stiffness or 1e6 for e in case.elements)
        elastic = [replace(e, stiffness=e.stiffness or stiffest) for e in case.elements]
        case = replace(case, elements=tuple(elastic), damping_ratio=None)
        case = _from_the_motor(case)
    elif rng.random() < 0.3 and (held := with_bearings(case, seed, 10.0 ** rng.uniform(-1.0, 1.0))):
        case = held
        extras.append("bearings")
    if number % 2 == 1 and number < LEAVES_MODES:
        parting = with_clearances(case, seed)
        if parting is None:
            return None, ()
        case = _with_teeth(_at_most(MOST_CLEARANCES, parting), rng)
        several = sum(1 for m in case.meshes if m.backlash or m.angular_backlash) > 1
        extras += ["clearances", "several clearances"] if several else ["clearances"]
    if independent or rng.random() < 0.4:
        case = _with_dampers(case, rng)
        extras.append("dampers")
        if independent or rng.random() < 0.5:
            case = replace(case, effect_choices=(EffectChoiceRow("coupled damping", "on"),))
            extras.append("coupled damping")
    if not independent and rng.random() < 0.2:
        case = with_shock(case, seed, float(rng.uniform(0.3, 2.0)))
        extras.append("breaker closing")
    if "bearings" in extras and rng.random() < SMALL_GAPS:
        case = _with_small_gaps(case, rng)
    return _judged(case, number, seed, rng), tuple(extras)


def _judged(case: Case, number: int, seed: int, rng: np.random.Generator) -> Case:
    """Its tolerances and its shafts with S-N data, every backlash stated."""
    case = _without_other_gaps(case)
    case = with_judged_shafts(case, seed, float(10.0 ** rng.uniform(-0.3, 0.4)))
    peak = OTHER_TOLERANCE.get(number % 20, 1e-3)
    return replace(case, tolerance_peak=peak, tolerance_starts=STARTS_TOLERANCE[peak])


def _drawn_without(effect: str, number: int, seed: int) -> tuple[Case | None, tuple[str, ...]]:
    """One draw of a train with so little of one effect that it is left out; None if it is not, or without bound."""
    rng = np.random.default_rng((seed, 22))
    little = float(10.0 ** rng.uniform(*LITTLE))
    case: Case | None = random_start(seed)
    assert case is not None
    if effect == "bearings":
        case = with_bearings(case, seed, little)
    elif effect == "coupled damping":
        case = _with_dampers(case, rng, little)
    elif effect == "breaker closing":
        case = with_shock(case, seed, little)
    else:
        case = with_clearances(case, seed)
        case = None if case is None else _with_teeth(case, rng)
    if case is None:
        return None, ()
    case = _judged(case, number, seed, rng)
    if effect == "backlash" and (case := _near_zero(case, rng)) is None:
        return None, ()
    plan = run(case).plans[-1]
    left_out = effect in plan.left_out and plan.decision(effect).bound
    return (case if left_out else None), (effect,)


def _near_zero(case: Case, rng: np.random.Generator) -> Case | None:
    """Its pulsation so large that the lowest torque of a clearance comes near zero; None if it never does."""
    limit = (case.tolerance_peak or 1e-3) / BACKLASH_GAIN
    wanted = float(rng.uniform(*NEAR_ZERO)) * limit
    off = replace(case, effect_choices=(EffectChoiceRow("backlash", "off"),))

    def lowest(share: float) -> float:
        found = run(_pulsating(off, share)).plans[-1].decision("backlash").deciding_number
        return math.inf if found is None else found

    low, high = 0.0, 1.0
    if lowest(low) <= wanted or lowest(high) >= wanted:
        return None
    for _ in range(HALVINGS):
        share = 0.5 * (low + high)
        found = lowest(share)
        if abs(found - wanted) < NEAR_ENOUGH * limit:
            return _pulsating(case, share)
        low, high = (share, high) if found > wanted else (low, share)
    return None


def _pulsating(case: Case, share: float) -> Case:
    """With a share of its pulsating torque."""
    rows = [replace(p, pulsating=share * (p.pulsating or 0.0)) for p in case.motor_torque]
    return replace(case, motor_torque=tuple(rows))


def _at_most(count: int, case: Case) -> Case:
    """The first clearances only: chatter of many at once takes minutes a train."""
    gaps = [m for m in case.meshes if m.backlash or m.angular_backlash]
    dropped = {m.element for m in gaps[count:]}
    closed = [
        replace(m, backlash=None) if m.element in dropped else m
        for m in case.meshes
        if m.element not in dropped or m.backlash
    ]
    return replace(case, meshes=tuple(closed))


def _with_small_gaps(case: Case, rng: np.random.Generator) -> Case:
    """Every mesh on bearings with a backlash."""
    meshes = [
        m
        if m.backlash or m.angular_backlash or not m.bearing_stiffness_drive
        else replace(m, backlash=float(rng.uniform(*SMALL_GAP)))
        for m in case.meshes
    ]
    return replace(case, meshes=tuple(meshes))


def _without_other_gaps(case: Case) -> Case:
    """Every mesh with a stated backlash, none where it has no clearance: without one nothing is bounded."""
    stated = {m.element for m in case.meshes}
    meshes = [
        m if m.backlash or m.angular_backlash else replace(m, backlash=0.0) for m in case.meshes
    ]
    meshes += [
        MeshRow(e.element, backlash=0.0)
        for e in case.elements
        if e.kind == ElementKind.GEAR_MESH and e.element not in stated
    ]
    return replace(case, meshes=tuple(meshes))


def _from_the_motor(case: Case) -> Case:
    """Every element from the motor outwards, as the independent integrator takes its flanks."""
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    reached, turned = {case.motor_torque[0].station}, {}
    while len(turned) < len(case.elements):
        for e in case.elements:
            if e.element in turned:
                continue
            if e.from_ in reached:
                turned[e.element] = e
                reached.add(e.to)
            elif e.to in reached:
                stiffness = (e.stiffness or 0.0) * (ratio[e.from_] / ratio[e.to]) ** 2
                turned[e.element] = replace(e, from_=e.to, to=e.from_, stiffness=stiffness)
                reached.add(e.from_)
    return replace(case, elements=tuple(turned[e.element] for e in case.elements))


def _with_teeth(case: Case, rng: np.random.Generator) -> Case:
    """Teeth as machines have them: they ring at `TEETH` at the most, nine in ten are damped."""
    parting = {m.element for m in case.meshes if m.backlash or m.angular_backlash}
    elements = []
    for e in case.elements:
        ringing, ratio = float(np.exp(rng.uniform(*np.log(TEETH)))), float(rng.uniform(0.02, 0.2))
        if e.element in parting:
            mass = _between(case, e)
            stiffness = min(e.stiffness or math.inf, mass * (2.0 * math.pi * ringing) ** 2)
            damping = 2.0 * ratio * math.sqrt(stiffness * mass) if rng.random() < 0.9 else None
            e = replace(e, stiffness=stiffness, damping=damping)
        elements.append(e)
    return replace(case, elements=tuple(elements))


def _with_dampers(case: Case, rng: np.random.Generator, share: float = 1.0) -> Case:
    """Dampers of half a per cent to five across the other elements, and some stations to ground; or a share of them."""
    elements = []
    for e in case.elements:
        ratio = float(np.exp(rng.uniform(*np.log(DAMPED))))
        if e.stiffness and not e.damping:
            mass = _between(case, e)
            damping = 2.0 * ratio * math.sqrt(e.stiffness * mass)
            e = replace(e, damping=share * min(damping, FASTEST_DAMPER * mass))
        elements.append(e)
    stations = [
        replace(s, damping=share * float(s.inertia or 0.0) * float(rng.uniform(0.0, 0.02)))
        if rng.random() < 0.3
        else s
        for s in case.stations
    ]
    return replace(case, elements=tuple(elements), stations=tuple(stations))


def _between(case: Case, e: ElementRow) -> float:
    """Reduced inertia of the two ends of an element, at its From side. [kg m²]"""
    of = {s.station: s for s in case.stations}
    a, b = of[e.from_], of[e.to]
    own = a.inertia or 0.0
    other = (b.inertia or 0.0) * ((b.speed_ratio or 1.0) / (a.speed_ratio or 1.0)) ** 2
    return own * other / (own + other)


def gaps_of(case: Case) -> dict[str, float]:
    """Total clearance of each element as an angle on its From side, from the table itself. [rad]"""
    gaps = {}
    for m in case.meshes:
        assert not m.helix_angle  # with none, normal and transverse sections are one
        if m.angular_backlash:
            gaps[str(m.element)] = m.angular_backlash
        elif m.backlash:
            assert m.pitch_radius_drive is not None
            assert m.pressure_angle is not None
            base = m.pitch_radius_drive * math.cos(m.pressure_angle)
            gaps[str(m.element)] = m.backlash / base
    return gaps
