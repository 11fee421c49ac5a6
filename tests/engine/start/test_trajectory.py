"""Histories in bounded memory: turning points from every sample, samples thinned evenly."""

from __future__ import annotations

import numpy as np
import pytest

from engine.model.modal_analysis import analyse
from engine.run import planned_start
from engine.start.reversals import torque_reversals
from engine.start.trajectory import Recorder, turning_of
from tests.sample_case import sample_case

ELEMENT = np.array([0, 1])


def wave(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two torques and their rates."""
    y = np.array([np.sin(7.0 * t) * t, 100.0 * np.cos(3.0 * t)])
    rate = np.array([7.0 * np.cos(7.0 * t) * t + np.sin(7.0 * t), -300.0 * np.sin(3.0 * t)])
    return y, rate


def recorded(t: np.ndarray, block: int, kept: float):
    """A recorder fed block by block."""
    recorder = Recorder(ELEMENT, kept)
    for i in range(0, len(t), block):
        part = t[i : i + block]
        recorder.add(part, 2.0 * part, *wave(part), 3.0 * part[None])
    return recorder.trajectory(True, len(t) - 1)


@pytest.mark.parametrize("block", [1, 7, 100, 5000])
def test_turning_points_do_not_depend_on_thinning(block):
    t = np.linspace(0.0, 20.0, 5001)
    whole, _ = recorded(t, block, np.inf)
    thin, _ = recorded(t, block, 600)
    assert not whole.thinned
    assert thin.thinned
    for (a, x), (b, y) in zip(turning_of(whole, 20.0), turning_of(thin, 20.0), strict=True):
        assert a == pytest.approx(b, abs=1e-12)
        assert x == pytest.approx(y, abs=1e-9)
    # t sin 7t turns where tan 7t = −7t: at 0 and once in each (k − ½)π < 7t < kπ, k = 1 … 45
    assert len(turning_of(thin, 20.0)[0][0]) == 46 + 2


@pytest.mark.parametrize("block", [1, 7, 100, 5000])
@pytest.mark.parametrize("n", [17, 601, 4999, 5000])
def test_what_is_kept_is_bounded_even_and_has_both_ends(block, n):
    t = np.linspace(0.0, 20.0, n)
    thin, further = recorded(t, block, 600)
    assert len(thin.time) <= 300 + 3
    assert np.all(np.isin(thin.time, t))
    assert thin.time[0] == 0.0
    assert list(thin.time[-2:]) == list(t[-2:])
    assert np.all(np.diff(thin.time) > 0.0)
    gaps = np.diff(thin.time)[1:-2]
    if len(gaps):
        assert gaps.max() <= 1.001 * gaps.min()
    assert thin.mean_speed == pytest.approx(2.0 * thin.time)
    assert further[0] == pytest.approx(3.0 * thin.time)
    assert thin.torque == pytest.approx(wave(thin.time)[0])


def test_a_jump_between_two_samples_of_one_time_is_a_turning_point():
    t = np.array([0.0, 1.0, 1.0, 2.0])
    recorder = Recorder(np.array([0]))
    torque = np.array([[0.0, 1.0, 5.0, 6.0]])
    recorder.add(t, t, torque, np.ones((1, 4)), np.empty((0, 4)))
    when, value = turning_of(recorder.trajectory(True, 3)[0], 2.0)[0]
    assert list(when) == [0.0, 1.0, 1.0, 2.0]
    assert list(value) == [0.0, 1.0, 5.0, 6.0]


def test_answers_do_not_depend_on_what_is_kept(monkeypatch):
    case = sample_case("proposed")
    whole = planned_start(case, analyse(case))
    monkeypatch.setattr("engine.start.start.KEPT_VALUES", 20_000)
    monkeypatch.setattr("engine.start.simulation.KEPT_VALUES", 20_000)
    thin = planned_start(case, analyse(case))
    assert thin.start.trajectory.thinned
    assert len(thin.start.trajectory.time) < 0.5 * len(whole.start.trajectory.time)
    for p, q in zip(thin.start.peaks, whole.start.peaks, strict=True):
        assert (p.maximum, p.minimum, p.time, p.error) == (q.maximum, q.minimum, q.time, q.error)
        assert p.speed == pytest.approx(q.speed, rel=1e-4)
    a, b = (torque_reversals(case, p.model.train, p.start)[0] for p in (whole, thin))
    assert a.reversals == b.reversals > 5
    # the instants between two turning points are on the smooth step between them, not on samples
    assert a.time_unloaded == pytest.approx(b.time_unloaded, rel=0.05)
    assert a.minimum_torque == b.minimum_torque


def test_a_wanted_history_is_kept_whole(monkeypatch):
    monkeypatch.setattr("engine.start.start.KEPT_VALUES", 20_000)
    case = sample_case("proposed", keep_history="npz")
    assert not planned_start(case, analyse(case)).start.trajectory.thinned
