"""Lengths of steps under torques whose knots interrupt equal steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.problems import random_chain
from engine.case.case import Case
from engine.case.data import ElementRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.start import time_response as responses

CASE = Case(
    stations=(
        StationRow("Motor", None, 50.0),
        StationRow("Hub", None, 5.0),
        StationRow("Fan", None, 30.0),
    ),
    elements=(
        ElementRow("Shaft", "shaft", "Motor", "Hub", 5e5),
        ElementRow("Coupling", "coupling", "Hub", "Fan", 6e5, damping=2000.0),
    ),
)
KNOTS = np.linspace(0.0, 0.5, 31)  # each second one between two of 5000 steps


def torque_at(times):
    train = build_train(CASE)
    push = responses.linear(0, KNOTS, 1e3 * np.sin(40.0 * KNOTS))
    found = responses.time_response(train, modes_of(train), [push], times)
    assert found.coupled
    return found.torque


def test_a_length_that_comes_again_is_calculated_once(monkeypatch):
    calculated = []
    real = responses.coupled_step
    monkeypatch.setattr(
        responses, "coupled_step", lambda *words: calculated.append(words[-2]) or real(*words)
    )
    interrupted = torque_at(np.linspace(0.0, 0.5, 5001))
    assert len(calculated) <= 3, calculated  # the step, a third and two thirds of it
    # the solution is exact on any grid: here all knots lie on one of equal steps
    equal = torque_at(np.linspace(0.0, 0.5, 15001))[:, ::3]
    assert len(calculated) == 4
    assert interrupted == pytest.approx(equal, rel=1e-9, abs=1e-12 * np.max(np.abs(equal)))


def test_lengths_that_differ_by_more_than_rounding_are_not_one():
    """Knots drawn at random: the end is where it should be, and the solution that of another grid."""
    rng = np.random.default_rng(1)
    times = np.sort(np.append(rng.uniform(0.0, 0.5, 300), [0.0, 0.5]))
    equal = torque_at(np.linspace(0.0, 0.5, 15001))[:, -1]
    assert torque_at(times)[:, -1] == pytest.approx(equal, rel=1e-9)


def test_each_mode_has_the_bits_that_it_has_alone():
    """Nineteen modes go through the loop eight at a time, under straight lines and under cubics."""
    train = build_train(random_chain(19).case())
    modes, times = modes_of(train), np.linspace(0.0, 0.3, 1001)
    pushes = [responses.linear(i, KNOTS, 1e3 * np.sin((40.0 + i) * KNOTS)) for i in (0, 7)]
    for torques in (pushes, [replace(p, linear=False) for p in pushes]):
        together = responses.time_response(train, modes, torques, times)
        assert not together.coupled
        for mode in range(modes.n_modes):
            kept = np.arange(modes.n_modes) == mode
            alone = responses.time_response(train, modes, torques, times, kept=kept)
            assert np.array_equal(together.modal[0][mode], alone.modal[0][0])
            assert np.array_equal(together.modal[1][mode], alone.modal[1][0])
