"""Torque reversals: against closed forms, against brute force, and what is said of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from engine.case.case import Case
from engine.case.data import ElementRow, MeshRow
from engine.case.defaults import NOTABLE_REVERSAL
from engine.case.practice_limits import PRACTICE_LIMITS
from engine.start.event_results import ContactRecord
from engine.start.reversals import (
    Reversal,
    passages_below,
    reversing_elements,
    torque_reversals,
)
from engine.start.start import Start
from engine.start.trajectory import turning_of
from tests.sample_case import sample_case
from tests.trains import geared, prepared, started

CASE = geared()
MESH = 1


def with_torque(start: Start, t: np.ndarray, torque: np.ndarray, rate: np.ndarray) -> Start:
    """A start whose mesh has this torque; every other element has none."""
    many = np.zeros((len(start.trajectory.output_element), len(t)))
    output = int(start.output_of_element[MESH])
    y, slope = many.copy(), many.copy()
    y[output], slope[output] = torque, rate
    trajectory = replace(
        start.trajectory, time=t, torque=y, torque_rate=slope, mean_speed=30.0 * t / t[-1]
    )
    turning = turning_of(trajectory, float(t[-1]))
    shown = [turning[i] for i in start.output_of_element if i >= 0]
    return replace(start, trajectory=trajectory, turning_points=tuple(shown))


@pytest.fixture(scope="module")
def start() -> Start:
    return started(CASE)


def mesh_reversal(case: Case, start: Start, contacts: tuple[ContactRecord, ...] = ()) -> Reversal:
    found = torque_reversals(case, prepared(case)[0], start, contacts)
    return next(r for r in found if r.element == "Mesh")


def test_the_rounding_of_a_train_at_rest_is_no_torque(start):
    t = np.linspace(0.0, 1.0, 2001)
    wave = with_torque(
        start, t, 1e4 * np.sin(np.pi * t) ** 2 - 1.134e-8, 1e4 * np.pi * np.sin(2.0 * np.pi * t)
    )
    assert mesh_reversal(CASE, wave).minimum_torque == 0.0


def test_a_sine_about_a_mean_reverses_as_the_closed_form_says(start):
    mean, swing, omega = 400.0, 1000.0, 2.0 * np.pi * 10.0
    t = np.linspace(0.0, 1.0, 2001)  # ten periods
    wave = with_torque(
        start, t, mean + swing * np.sin(omega * t), swing * omega * np.cos(omega * t)
    )
    r = mesh_reversal(CASE, wave)
    below = (np.pi - 2.0 * np.arcsin(mean / swing)) / omega
    assert r.reversals == 10
    assert r.longest_reversal == pytest.approx(below, rel=1e-7)
    assert r.time_unloaded == pytest.approx(10 * below, rel=1e-7)
    assert r.first_time == pytest.approx((np.pi + np.arcsin(mean / swing)) / omega, rel=1e-7)
    assert r.minimum_torque == pytest.approx(mean - swing, rel=1e-9)
    assert r.largest_torque == pytest.approx(mean + swing, rel=1e-9)
    # at a quarter before each full period the mean speed is 30 rad/s × t of 60π rad/s, at 60 Hz
    k = round(r.minimum_time * 10.0 - 0.75)
    assert r.minimum_time == pytest.approx((k + 0.75) / 10.0, abs=1e-6)
    slip = 1.0 - 30.0 * r.minimum_time / (60.0 * np.pi)
    assert r.slip_frequency == pytest.approx(2.0 * slip * 60.0, rel=1e-9)


def test_trembling_within_the_hysteresis_is_no_reversal(start):
    t = np.linspace(0.0, 1.0, 2001)
    omega, tremble = 2.0 * np.pi * 30.0, 0.9 * NOTABLE_REVERSAL * 1000.0
    push, fast = np.pi * t / 0.1, omega * (t - 0.1)
    torque = np.where(t < 0.1, 1000.0 * np.sin(push) ** 2, -tremble * np.sin(fast) ** 2)
    rate = np.where(
        t < 0.1, 1e4 * np.pi * np.sin(2.0 * push), -tremble * omega * np.sin(2.0 * fast)
    )
    trembling = with_torque(start, t, torque, rate)
    exact = replace(trembling, peaks=tuple(replace(p, error=0.0) for p in start.peaks))
    r = mesh_reversal(CASE, exact)
    assert r.minimum_torque < 0.0
    assert (r.reversals, r.time_unloaded, r.first_time) == (0, 0.0, None)
    assert r.verdict == "pass"
    assert (
        r.sentence == "Mesh: torque does not reverse (below zero by less than 0.1% of its largest)"
    )
    unsure = replace(trembling, peaks=tuple(replace(p, error=1.0) for p in start.peaks))
    assert mesh_reversal(CASE, unsure).sentence.startswith("Mesh: torque may reverse")


def test_two_dips_without_a_rise_above_zero_are_one_reversal(start):
    t = np.linspace(0.0, 1.0, 4001)
    torque = 1000.0 * np.interp(t, [0, 0.2, 0.4, 0.5, 0.6, 0.8, 1], [0, 1, -0.5, -0.01, -0.5, 1, 1])
    rate = np.gradient(torque, t)
    r = mesh_reversal(CASE, with_torque(start, t, torque, rate))
    assert r.reversals == 1
    # down through zero at 0.2 + 0.2/1.5, up again at 0.6 + 0.2 × 0.5/1.5
    assert r.longest_reversal == pytest.approx(0.4 + 0.2 / 3.0 - 0.2 / 1.5, abs=1e-6)


def test_the_sentence_names_the_longest_of_several_reversals(start):
    """Straight lines through zero at 1/6 and 7/30 s, and at 0.4 and 0.6 s."""
    t = np.linspace(0.0, 1.0, 6001)
    torque = 1000.0 * np.interp(t, [0, 0.1, 0.2, 0.3, 0.5, 0.7, 1], [0, 1, -0.5, 1, -1, 1, 1])
    r = mesh_reversal(CASE, with_torque(start, t, torque, np.gradient(torque, t)))
    assert r.longest_reversal == pytest.approx(0.2, abs=1e-5)
    assert r.time_unloaded == pytest.approx(0.2 + 1.0 / 15.0, abs=1e-5)
    assert "(2 reversals from 0.167 s on, the longest 200 ms" in r.sentence


def test_a_reversal_that_is_still_open_ends_with_the_run(start):
    t = np.linspace(0.0, 1.0, 1001)
    r = mesh_reversal(CASE, with_torque(start, t, 100.0 - 200.0 * t**2, -400.0 * t))
    assert r.reversals == 1
    assert r.longest_reversal == pytest.approx(1.0 - np.sqrt(0.5), rel=1e-9)


def test_a_start_that_falls_below_zero_at_once_counts_from_rest(start):
    t = np.linspace(0.0, 1.0, 1001)
    r = mesh_reversal(CASE, with_torque(start, t, -np.sin(np.pi * t), -np.pi * np.cos(np.pi * t)))
    assert r.first_time == pytest.approx(0.0, abs=1e-12)
    assert r.reversals == 1
    assert r.longest_reversal == pytest.approx(1.0, rel=1e-9)


@settings(max_examples=60)
@given(values=st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=40), seed=st.integers(0, 999))
def test_every_passage_begins_and_ends_at_a_root_of_the_cubics(start, values, seed):
    """Few samples: turning points and several roots lie within one step."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.01, 1.0, len(values)))
    torque, rate = 1e3 * np.array(values), rng.uniform(-4e3, 4e3, len(values))
    wave = with_torque(start, t, torque, rate)
    points = wave.turning_of_element()[MESH]
    began, ended = passages_below(wave, MESH, points)
    curve = CubicHermiteSpline(t, torque, rate)
    roots = np.concatenate([curve.roots(extrapolate=False), t[[0, -1]]])
    span = t[-1] - t[0]
    for one in (*began, *ended):
        # a root of nearly no slope is known only as far as the torque is: by its value then
        near = np.min(np.abs(roots - one)) <= 1e-9 * span
        assert near or abs(float(curve(one))) <= 1e-9 * np.max(np.abs(points[1]))
    assert np.all(began <= ended)
    for first, last in zip(began, ended, strict=True):
        assert np.min(curve(np.linspace(first, last, 4001))) < 0.0


def test_the_sample_train_against_brute_force():
    """The dense output sampled two million times, counted by the definition itself."""
    case = sample_case("modified")
    found, start = prepared(case)[0], started(case)
    r = torque_reversals(case, found, start)[0]
    output = int(start.output_of_element[list(found.elements).index("Mesh")])
    j = start.trajectory
    curve = CubicHermiteSpline(j.time, j.torque[output], j.torque_rate[output])
    t = np.linspace(0.0, start.outcome.time, 2_000_001)
    y = curve(t)
    h = NOTABLE_REVERSAL * np.max(np.abs(y))
    count, below, spent, inside = 0, 0, 0, False
    for value in y:
        if value > 0.0:
            spent += below if inside else 0
            below, inside = 0, False
        elif value < 0.0:
            below += 1
            if value < -h and not inside:
                inside, count = True, count + 1
    assert count == r.reversals == 6
    assert r.time_unloaded == pytest.approx(spent * (t[1] - t[0]), abs=2 * count * (t[1] - t[0]))
    assert r.minimum_torque == pytest.approx(y.min(), rel=1e-7)
    assert r.transmitted_torque == pytest.approx(58_400.0, rel=1e-3)
    assert r.margin == pytest.approx(r.minimum_torque / r.transmitted_torque)


@pytest.mark.parametrize(
    ("limit", "verdict"), [(None, "not judged"), (1.0e4, "fail"), (3.0e4, "pass")]
)
def test_only_the_makers_limit_judges(limit, verdict):
    case = sample_case("modified")
    case = replace(
        case,
        elements=tuple(
            replace(e, reversal_limit=limit) if e.element == "Mesh" else e for e in case.elements
        ),
    )
    r = torque_reversals(case, prepared(case)[0], started(case))[0]
    assert -3.0e4 < r.minimum_torque < -1.0e4
    assert (r.verdict, r.limit) == (verdict, limit)
    assert ("Reversal limit is blank" in r.sentence) == (limit is None)


def test_geared_couplings_and_elements_with_a_limit_are_watched():
    elements = (
        ElementRow("Geared", "coupling", "Motor", "Bull gear", 3.0e6),
        CASE.elements[1],
        ElementRow("Shaft", "shaft", "Pinion", "Load", 1.0e5),
    )
    case = geared(elements=elements, meshes=(MeshRow("Geared", angular_backlash=0.01),))
    assert reversing_elements(case) == (0, 1)
    limited = replace(case, elements=(*elements[:2], replace(elements[2], reversal_limit=5.0)))
    assert reversing_elements(limited) == (0, 1, 2)
    found = torque_reversals(case, prepared(case)[0], started(case))
    assert [(r.element, r.kind) for r in found] == [("Geared", "coupling"), ("Mesh", "gear mesh")]


def test_a_modelled_clearance_tells_its_own_time_without_contact(start):
    contact = ContactRecord("Mesh", 7, 3, 0.0625, 0.125, 2.5, 4.0e5, 1.0e4)
    r = mesh_reversal(CASE, start, (contact,))
    assert (r.time_unloaded, r.impacts, r.recontact_speed) == (0.0625, 7, 0.125)
    assert (r.tooth_force, r.model) == (4.0e5, "clearance")
    assert mesh_reversal(CASE, start).model == "linear"


def test_teeth_that_part_without_reaching_the_back_flank_are_told(start):
    """Torque in the gap is zero but for rounding of either sign: no reversal, yet not a pass."""
    t = np.linspace(0.0, 1.0, 2001)
    push = np.where((t > 0.4) & (t < 0.6), 0.0, 1000.0 * np.sin(5.0 * np.pi * t) ** 2)
    rate = np.where((t > 0.4) & (t < 0.6), 0.0, 5e3 * np.pi * np.sin(10.0 * np.pi * t))
    noise = np.where(push == 0.0, 1e-8 * np.sin(1e3 * t), 0.0)
    apart = with_torque(start, t, push + noise, rate)
    contact = ContactRecord("Mesh", 3, 0, 0.2, 0.1, 1.0, 4.0e5, 1.0e4)
    r = mesh_reversal(CASE, apart, (contact,))
    assert (r.reversals, r.time_unloaded, r.verdict) == (0, 0.2, "not judged")
    assert "falls to zero, teeth re-engage 3 times; Reversal limit is blank" in r.sentence


def test_back_flank_blows_with_a_gap_between_them_are_one_reversal(start):
    t = np.linspace(0.0, 1.0, 2001)
    blown = (t > 0.4) & (t < 0.8) & (np.sin(10.0 * np.pi * t) > 0.0)
    pushed = (t < 0.2) | (t > 0.8)
    torque = np.where(blown, -300.0 * np.sin(10.0 * np.pi * t) ** 2, 1e-8)
    torque = np.where(pushed, 1000.0 * np.sin(5.0 * np.pi * t) ** 2, torque)
    rate = np.where(blown, -3e3 * np.pi * np.sin(20.0 * np.pi * t), 0.0)
    rate = np.where(pushed, 5e3 * np.pi * np.sin(10.0 * np.pi * t), rate)
    r = mesh_reversal(CASE, with_torque(start, t, torque, rate))
    assert r.reversals == 1


def test_no_published_number_judges_a_start():
    assert {p.applies_to for p in PRACTICE_LIMITS} == {"gear mesh", "coupling"}
    assert all(p.share is None for p in PRACTICE_LIMITS if p.service == "start")
    assert all(p.source and p.says for p in PRACTICE_LIMITS)
