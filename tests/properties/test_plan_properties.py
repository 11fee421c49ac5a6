"""Leaving an effect out by plan changes no reported answer by more than the tolerance.

Random trains are calculated both ways: as the plan says, and with the effect forced on. Answers are
the peak torques of every element, over the larger of maximum and minimum, and the allowable starts
of every judged shaft. Where the plan leaves an effect out, its change must lie within the bound the
plan states (besides the errors both calculations estimate for themselves), and that bound within
the tolerance. Strengths of the effects are drawn about the limits of the plan, so that it decides
either way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import EffectChoiceRow, MeshRow
from engine.model.modal_analysis import analyse
from engine.plan.evidence import DAMPING_GAIN
from engine.run import PlannedStart, judged_starts, planned_start
from tests.random_effects import (
    elastic_meshes,
    with_bearings,
    with_clearances,
    with_dampers,
    with_judged_shafts,
    with_motor_data,
    with_shock,
)
from tests.random_starts import random_start

TOLERANCE = 1e-3
#: Calculated so much more accurately than the tolerance, so that the effect is what is seen.
CALCULATED = 2e-5


@dataclass(frozen=True)
class BothWays:
    """One case as planned and with the effect forced on."""

    planned: PlannedStart
    change_peak: float
    change_starts: float
    numerical: float


def with_choices(case: Case, **choices: str) -> Case:
    rows = tuple(EffectChoiceRow(k.replace("_", " "), v) for k, v in choices.items())
    return replace(case, effect_choices=rows, tolerance_peak=CALCULATED)


def peak_change(a: PlannedStart, b: PlannedStart) -> float:
    """Largest change of an extreme over the larger of the two."""
    other = {p.element: p for p in b.start.peaks}
    sizes = [max(abs(p.maximum), abs(p.minimum)) for p in a.start.peaks]
    floor = 1e-9 * max(sizes, default=0.0)
    changes = [
        max(abs(p.maximum - other[p.element].maximum), abs(p.minimum - other[p.element].minimum))
        / max(size, floor)
        for p, size in zip(a.start.peaks, sizes, strict=True)
        if size > 0.0
    ]
    return max(changes, default=0.0)


def starts_change(case: Case, a: PlannedStart, b: PlannedStart) -> float:
    """Largest relative change of the damage of a shaft that has any."""
    first, second = (judged_starts(case, x)[1] for x in (a, b))
    if first is None or second is None:
        return 0.0
    changes = [
        abs(x.damage / y.damage - 1.0) if x.damage > 0.0 and y.damage > 0.0 else 1.0
        for x, y in zip(first.shafts, second.shafts, strict=True)
        if x.damage > 0.0 or y.damage > 0.0
    ]
    return max(changes, default=0.0)


def both_ways(case: Case, effect: str) -> BothWays | None:
    """None where the plan simulates the effect: then both are the same."""
    words = {} if effect == "backlash" else {"backlash": "off"}
    key = effect.replace(" ", "_")
    loose = replace(with_choices(case, **words), tolerance_peak=TOLERANCE)
    decided = planned_start(loose, analyse(loose))
    if decided.plan.decision(effect).on:
        return None
    left_out, simulated = (
        planned_start(c, analyse(replace(c, effect_choices=())))
        for c in (with_choices(case, **words, **{key: choice}) for choice in ("off", "on"))
    )
    assert simulated.plan.decision(effect).on
    return BothWays(
        decided,
        peak_change(left_out, simulated),
        starts_change(case, left_out, simulated),
        left_out.start.estimated_error + simulated.start.estimated_error,
    )


def about(limit: float) -> Callable[[int], float]:
    """A strength within two decades of a limit, rather below it."""

    def draw(seed: int) -> float:
        rng = np.random.default_rng(seed)
        return float(limit * 10.0 ** rng.uniform(-2.0, 0.5))

    return draw


def dampers(seed: int) -> Case | None:
    return with_dampers(random_start(seed), seed, about(1e-4)(seed))


def bearings(seed: int) -> Case | None:
    return with_bearings(elastic_meshes(seed), seed, about(1e-4)(seed))


def shock(seed: int) -> Case | None:
    return with_shock(random_start(seed), seed, about(1e-4)(seed))


def fast_modes(seed: int) -> Case | None:
    return with_judged_shafts(random_start(seed), seed, 1.0)


def clearances(seed: int) -> Case | None:
    """Little pulsation and much damping, so that many trains just do or just do not reverse."""
    case = with_clearances(elastic_meshes(seed), seed)
    if case is None:
        return None
    share = float(np.random.default_rng(seed).uniform(0.0, 0.3))
    rows = tuple(replace(p, pulsating=share * (p.pulsating or 0.0)) for p in case.motor_torque)
    return replace(case, motor_torque=rows, damping_ratio=0.1)


def shocks(seed: int) -> Case | None:
    """Two motors, the second a weaker one at another station, on reduced or raised voltage."""
    case = shock(seed)
    assert case is not None
    rng = np.random.default_rng(seed + 6_000_000)
    # on the motor's shaft or one as fast: elsewhere it would not have whole pole pairs
    others = [
        s
        for s in case.stations
        if s.station != case.motor_torque[0].station and (s.speed_ratio or 1.0) == 1.0
    ]
    if not others:
        return None
    second = others[int(rng.integers(len(others)))]
    share = float(10.0 ** rng.uniform(-1.0, 0.0)) / float(second.speed_ratio or 1.0)
    rows = tuple(
        replace(
            p,
            station=second.station,
            average=share * (p.average or 0.0),
            pulsating=share * (p.pulsating or 0.0),
        )
        for p in case.motor_torque
    )
    voltage = float(rng.uniform(0.8, 1.5))
    return replace(case, motor_torque=(*case.motor_torque, *rows), voltage=voltage)


CASES: dict[str, Callable[[int], Case | None]] = {
    "coupled damping": dampers,
    "bearings": bearings,
    "breaker closing": shock,
    "fast modes": fast_modes,
    "backlash": clearances,
}


def check(
    effect: str, seeds: range, make: Callable[[int], Case | None] | None = None
) -> tuple[int, int]:
    """Every seed both ways; how many cases there were, and in how many the effect was left out."""
    tried = left_out = 0
    for seed in seeds:
        case = (make or CASES[effect])(seed)
        if case is None:
            continue
        tried += 1
        found = both_ways(case, effect)
        if found is None:
            continue
        left_out += 1
        decision = found.planned.plan.decision(effect)
        if decision.bound is None:  # an element reverses whose clearance nobody has stated
            assert "no clearance is given" in decision.why, (effect, seed, decision)
            decision = replace(decision, bound=found.planned.evidence.tolerance)
        if decision.bound > found.planned.evidence.tolerance:  # then the results say so
            assert not found.planned.start.met_tolerance, (effect, seed, decision)
            continue
        reach = decision.bound + found.numerical
        assert found.change_peak <= reach, (effect, seed, found.change_peak, decision)
        assert found.change_peak <= TOLERANCE, (effect, seed, found.change_peak, decision)
        assert found.change_starts <= 0.02, (effect, seed, found.change_starts, decision)
    return tried, left_out


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("effect", CASES)
def test_leaving_an_effect_out_by_plan_changes_nothing_that_counts(effect):
    tried, left_out = check(effect, range(12))
    assert tried >= 6
    assert left_out >= 2  # else nothing was compared


@pytest.mark.slow
def test_leaving_out_the_shocks_of_several_motors_changes_nothing_that_counts():
    tried, left_out = check("breaker closing", range(12), shocks)
    assert tried >= 6
    assert left_out >= 2


@pytest.mark.slow
@pytest.mark.parametrize("effect", CASES)
@pytest.mark.parametrize(
    "first", [1_000, *(pytest.param(k, marks=pytest.mark.long) for k in range(1_050, 1_300, 50))]
)
def test_leaving_an_effect_out_holds_on_hundreds_of_trains(effect, first):
    tried, left_out = check(effect, range(first, first + 50))
    assert tried >= 20
    assert left_out >= 5


def electrical_both_ways(seeds: range) -> int:
    """The bound of electrical damping against what forcing it on and off changes, of both ways to read curves."""
    tried = 0
    for seed in seeds:
        data = with_motor_data(random_start(seed), seed)
        for follows in ("own speed", "mean speed"):
            cases = [
                with_choices(replace(data, torque_follows=follows), electrical_damping=choice)
                for choice in ("on", "off")
            ]
            on, off = (planned_start(case, analyse(case)) for case in cases)
            numbers = off.evidence.electrical
            if numbers is None:  # no mode is crossed
                continue
            tried += 1
            assert on.plan.decision("electrical damping").on
            bound = DAMPING_GAIN * numbers.number
            numerical = on.start.estimated_error + off.start.estimated_error
            assert peak_change(on, off) <= bound + numerical, (seed, follows)
    return tried


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("first", [4, 36])
def test_the_bound_of_electrical_damping_holds(first):
    assert electrical_both_ways(range(first, first + 4)) >= 4


@pytest.mark.slow
@pytest.mark.parametrize("trains", [25, pytest.param(100, marks=pytest.mark.long)])
def test_the_bound_of_electrical_damping_holds_on_many_trains(trains):
    assert electrical_both_ways(range(trains)) >= 1.5 * trains


def both_readings(seed: int) -> tuple[int, int]:
    """Starts and damages within the ranges of the start at the other speed, for both; motors have no data."""
    drawn = with_judged_shafts(random_start(seed), seed, 1.2)
    meshes = [e.element for e in drawn.elements if e.kind == "gear mesh"]
    case = replace(drawn, meshes=tuple(MeshRow(name, backlash=0.0) for name in meshes))
    own, mean = (replace(case, torque_follows=follows) for follows in ("own speed", "mean speed"))
    planned = [planned_start(c, analyse(c)) for c in (own, mean)]
    if planned[0].evidence.electrical is None:  # no mode is crossed
        return 0, 0
    judged = [judged_starts(c, p) for c, p in zip((own, mean), planned, strict=True)]
    damages = 0
    for (start, starts, _), (other, other_starts, _) in (judged, judged[::-1]):
        assert start.estimate > 0.0
        for peak, beside in zip(start.peaks, other.peaks, strict=True):
            off = other.estimated_error * peak.size  # of the other start itself
            assert peak.low - off <= beside.size <= peak.high + off
            low, high = peak.minimum_range
            assert low - off <= beside.minimum <= high + off
        if starts is None:  # no shaft, meshes alone
            continue
        for shaft, beside in zip(starts.shafts, other_starts.shafts, strict=True):
            assert shaft.damage_low / 1.02 <= beside.damage <= 1.02 * shaft.damage_high
            damages += beside.damage > 0.0
    return 2, damages


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("first", [0, 200])
def test_starts_read_at_the_other_speed_are_within_the_ranges(first):
    found = np.sum([both_readings(seed) for seed in range(first, first + 6)], axis=0)
    assert np.all(found >= 4)


@pytest.mark.slow
def test_a_hundred_starts_read_at_the_other_speed_are_within_the_ranges():
    found = np.sum([both_readings(seed) for seed in range(100, 220)], axis=0)
    assert np.all(found >= 100)


# --- effects whose absence is exact ---------------------------------------------------------------


def answers(case: Case) -> tuple[list[tuple[float, float]], list[float]]:
    found = planned_start(case, analyse(case))
    starts = judged_starts(case, found)[1]
    return (
        [(p.maximum, p.minimum) for p in found.start.peaks],
        [s.damage for s in starts.shafts] if starts is not None else [],
    )


@pytest.mark.slow
def test_counting_left_out_by_plan_is_exact():
    left_out = 0
    for seed in range(24):
        case = with_judged_shafts(random_start(seed), seed, 10.0 ** (-0.5 - 0.05 * seed))
        plan = planned_start(case, analyse(case)).plan
        if plan.cycle_counting or not plan.decision("cycle counting").deciding_number:
            continue
        left_out += 1
        assert plan.decision("cycle counting").bound == 0.0
        forced = replace(case, effect_choices=(EffectChoiceRow("cycle counting", "on"),))
        assert answers(case) == answers(forced)
    assert left_out >= 5


def test_the_sweep_left_out_or_not_changes_no_answer():
    for seed in range(4):
        case = with_judged_shafts(random_start(seed), seed, 0.7)
        off = replace(case, effect_choices=(EffectChoiceRow("resonance sweep", "off"),))
        assert answers(case) == answers(off)


def test_a_run_that_ends_when_it_has_arrived_leaves_nothing_out():
    left_out = 0
    for seed in range(6):
        case = replace(with_judged_shafts(random_start(seed), seed, 0.7), maximum_time=6.0)
        on = replace(case, effect_choices=(EffectChoiceRow("run length", "on"),))
        if planned_start(case, analyse(case)).plan.decision("run length").bound == 0.0:
            left_out += 1
            assert answers(case) == answers(on)
    assert left_out >= 2
