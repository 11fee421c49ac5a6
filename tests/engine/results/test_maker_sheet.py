"""The sheet to the makers: by hand, by the definitions of others, and what it says where a number is missing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import rainflow
from scipy.interpolate import CubicHermiteSpline

from engine.case.case import Case
from engine.case.data import EventTorqueRow, MeshRow
from engine.case.defaults import NOTABLE_REVERSAL
from engine.results.maker_sheet import MakerRow, maker_sheet
from engine.results.results import Results
from engine.run import run
from engine.start.reversals import passages_beyond
from tests.sample_case import sample_case
from tests.trains import RATED, geared

#: A lubricated helical mesh of the usual angles.
MESH = MeshRow(
    "Mesh",
    pitch_radius_drive=0.6,
    pitch_radius_driven=0.2,
    pressure_angle=math.radians(20.0),
    helix_angle=math.radians(25.0),
)


def rows_of(results: Results) -> dict[str, MakerRow]:
    return {row.element: row for row in maker_sheet(results)}


@pytest.fixture(scope="module")
def sample() -> Results:
    return run(sample_case("proposed"))


def test_the_torques_of_a_geared_train_by_hand():
    load = 0.8 * RATED / 3.0
    plain = geared(meshes=(MESH,))
    stations = (*plain.stations[:3], replace(plain.stations[3], running_load=load))
    offered = replace(plain.elements[1], rated_torque=1.2 * RATED, service_factor=1.4)
    elements = (plain.elements[0], offered, plain.elements[2])
    results = run(geared(meshes=(MESH,), stations=stations, elements=elements))
    shaft, mesh, fast = maker_sheet(results)
    assert mesh.continuous_torque == pytest.approx(0.8 * RATED)
    assert fast.continuous_torque == pytest.approx(load)
    assert mesh.required_rating == pytest.approx(1.4 * 0.8 * RATED)
    assert mesh.offered_factor == pytest.approx(1.2 / 0.8)
    assert (shaft.service_factor, shaft.offered_rating, shaft.offered_factor) == (1.0, None, None)
    assert shaft.required_rating == shaft.continuous_torque
    # four poles at 60 Hz: 1800 rpm, and three times that behind the gear
    assert (mesh.speed, mesh.speed_driven) == pytest.approx((60.0 * math.pi, 180.0 * math.pi))
    assert (fast.speed, fast.speed_driven) == (pytest.approx(180.0 * math.pi), None)
    # of a linear start, too: cos α_t cos β_b = cos α_n cos β
    tangential = mesh.peak_torque / 0.6
    normal = tangential / (math.cos(math.radians(20.0)) * math.cos(math.radians(25.0)))
    assert mesh.tooth_force == pytest.approx(normal, rel=1e-12)
    assert shaft.tooth_force is None
    assert {row.note for row in (shaft, mesh, fast)} == {None}


def test_every_number_is_that_of_the_table_it_is_read_from(sample):
    assert sample.start is not None
    found = rows_of(sample)
    peaks = {p.element: p for p in sample.start.peaks}
    assert list(found) == [e.element for e in sample.case.elements] == list(peaks)
    for name, row in found.items():
        peak = peaks[name]
        assert row.peak_torque == max(peak.maximum, -peak.minimum)
        assert row.reversing_torque == max(0.0, -peak.minimum)
        vibratory = [r.torque for r in sample.steady.rows if r.element == name]
        assert row.vibratory_torque == max(vibratory)
    for reversal in sample.reversals:
        row = found[reversal.element]
        assert (row.reversals, row.longest_reversal) == (
            reversal.reversals, reversal.longest_reversal,
        )  # fmt: skip


def test_the_reversals_of_a_shaft_are_those_of_its_history(sample):
    """Counted on a thousandfold finer history, without turning points and without roots."""
    start, name = sample.start, "HP compressor shaft"
    assert start is not None
    index = [e.element for e in sample.case.elements].index(name)
    assert name not in {r.element for r in sample.reversals}
    run_, output = start.trajectory, int(start.output_of_element[index])
    assert not run_.thinned
    cubic = CubicHermiteSpline(run_.time, run_.torque[output], run_.torque_rate[output])
    t = np.linspace(0.0, float(run_.time[-1]), 2_000_001)
    torque = cubic(t)
    h = NOTABLE_REVERSAL * float(np.max(np.abs(torque)))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], (torque < 0.0).astype(int), [0]])))
    spans = [(a, b) for a, b in edges.reshape(-1, 2) if torque[a:b].min() < -h]
    row = rows_of(sample)[name]
    assert row.reversals == len(spans) > 10
    assert row.longest_reversal == pytest.approx(
        max(b - a for a, b in spans) * (t[1] - t[0]), abs=2.0 * (t[1] - t[0])
    )


@pytest.mark.parametrize("level", [0.3, 0.7, 1.0, 1.3])
def test_cycles_above_a_rating_are_rainflow_cycles_that_span_it(sample, level):
    """A history that begins and ends at rest passes a level as often as rainflow cycles span it, half ones half."""
    assert sample.start is not None
    rated = sample.case.ratings.rated_torque
    ratios = sample.case.element_speed_ratios
    for index, element in enumerate(sample.case.elements):
        torque = sample.start.turning_of_element()[index][1]
        rating = level * rated / ratios[element.element]
        h = NOTABLE_REVERSAL * float(np.max(np.abs(torque)))
        closed = [0.0, *torque.tolist(), 0.0]
        expected = 0.0
        for size, mean, count, *_ in rainflow.extract_cycles(closed):
            low, high = mean - 0.5 * size, mean + 0.5 * size
            expected += count * ((low <= rating) & (high > rating + h))
            expected += count * ((high >= -rating) & (low < -rating - h))
        assert passages_beyond(torque, rating) == round(expected)
        assert expected == round(expected)


def test_trembling_about_the_rating_is_one_passage():
    tremble = 100.0 + 0.05 * np.array([1.0, -1.0] * 20)  # less than 0.1 % of the largest
    assert passages_beyond(np.array([0.0, *tremble, 120.0, *tremble, 0.0]), 100.0) == 1
    assert passages_beyond(np.array([0.0, 120.0, 90.0, 120.0, -130.0, 0.0]), 100.0) == 3
    assert passages_beyond(np.array([0.0, 99.0, -99.0, 0.0]), 100.0) == 0


def test_without_a_rating_cycles_are_counted_beyond_the_required_one(sample):
    assert sample.start is not None
    turning = sample.start.turning_of_element()
    for index, row in enumerate(maker_sheet(sample)):
        level = row.offered_rating or row.required_rating
        assert row.cycles_above_rated == passages_beyond(turning[index][1], level)


def test_a_peak_in_an_event_is_the_peak_and_named():
    fault = (EventTorqueRow("Fault", "Motor", -8.0, 1.0, math.radians(90.0), 0.1),)
    results = run(geared(event_torque=fault))
    (event,) = results.events
    assert event.response is not None
    assert results.start is not None
    of_start = {p.element: p for p in results.start.peaks}
    for peak in event.response.peaks:
        row = rows_of(results)[peak.element]
        assert row.peak_torque == peak.size > of_start[peak.element].size
        assert row.reversing_torque == -peak.minimum
        assert row.note == "peak in 'Fault'"


def test_without_a_start_what_runs_is_there_and_nothing_else():
    plain = geared()
    stations = tuple(
        replace(s, running_load=100.0) if s.station == "Load" else s for s in plain.stations
    )
    for row in maker_sheet(run(geared(motor_torque=(), load_torque=(), stations=stations))):
        assert row.continuous_torque == pytest.approx(
            300.0 if row.element != "High-speed shaft" else 100.0
        )
        assert row.vibratory_torque > 0.0
        of_start = (row.peak_torque, row.reversing_torque, row.reversals, row.cycles_above_rated)
        assert of_start == (None,) * 4


def test_an_unknown_load_is_no_torque_of_zero():
    rows = maker_sheet(run(geared(load_torque=())))
    assert {(r.continuous_torque, r.required_rating, r.offered_factor) for r in rows} == {
        (None,) * 3
    }


def test_an_unbounded_vibration_has_no_number():
    plain: Case = geared(damping_ratio=0.0, minimum_speed=120.0, maximum_speed=200.0)
    rows = rows_of(run(plain))
    for row in rows.values():
        assert row.vibratory_torque is None
        assert row.note is not None
        assert row.note.startswith("vibratory torque unbounded at ")
