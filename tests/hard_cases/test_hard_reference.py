"""The integrator of the hard cases against scipy's DOP853, with events and restarts."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.case.data import CaseData
from tests.hard_cases.corpus import (
    STARTS,
    ClearanceCase,
    clearance_of_teeth,
    clearance_two,
)
from tests.hard_cases.reference import Clearance, integrate, rates_of, state_size

RTOL = 1e-11


def _sizes(case: CaseData, torque: float = 1e4) -> np.ndarray:
    """What the tolerance is relative to."""
    rows, stations = len(case.elements), len(case.stations)
    size = np.ones(state_size(case))
    size[:rows] = [torque / (e.stiffness or torque) for e in case.elements]
    size[rows : rows + stations] = 10.0
    return RTOL * size


@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    "name", ["modes 1e-9 apart", "stall", "overdamped coupling between shafts", "4 poles, 16.7 Hz"]
)
def test_a_start_as_scipy_integrates_it(name: str) -> None:
    case, end = STARTS[name].truth.case, 0.5
    times = np.linspace(0.0, end, 1001)
    start = np.zeros(state_size(case))
    solved = solve_ivp(
        rates_of(case), (0.0, end), start, "DOP853", t_eval=times, rtol=RTOL, atol=_sizes(case)
    )
    rows = len(case.elements)
    right = np.array([e.stiffness for e in case.elements])[:, None] * solved.y[:rows]
    found = integrate(case, end, 1e-5, sample=end / 1000)
    np.testing.assert_allclose(found.time, times, atol=1e-12)
    scale = np.max(np.abs(right), axis=1)
    assert np.max(np.abs(found.torque - right) / scale[:, None]) < 1e-6  # scipy interpolates
    np.testing.assert_allclose(found.speed, solved.y[rows : rows + len(case.stations), -1], 1e-8)


def _by_events(hard: ClearanceCase, end: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Extremes of the twists, and impacts: DOP853 restarted wherever a contact changes."""
    case, rows = hard.case, len(hard.case.elements)
    names = [s.station for s in case.stations]
    gaps = [e for e in case.elements if e.element in hard.clearances]

    def watch(e: Any, what: str) -> Any:
        i, (a, b) = case.elements.index(e), (names.index(e.from_), names.index(e.to))
        gap = hard.clearances[e.element].gap

        def value(_: float, y: np.ndarray) -> float:
            twist, rate = y[i], y[rows + a] - y[rows + b]
            depth, speed = (twist, rate) if twist >= 0.5 * -gap else (-twist - gap, -rate)
            spring, viscous = e.stiffness * depth, (e.damping or 0.0) * speed
            return float({"flank": depth, "pull": spring + viscous, "push": spring - viscous}[what])

        value.terminal = True  # type: ignore[attr-defined]
        return value

    watches = [watch(e, what) for e in gaps for what in ("flank", "pull", "push")]
    rates, t, y = rates_of(case, hard.clearances), 0.0, np.zeros(state_size(case))
    high, low, impacts = np.zeros(rows), np.zeros(rows), np.zeros(len(gaps), int)
    while t < end:
        done = solve_ivp(
            rates, (t, end), y, "DOP853", events=watches, rtol=RTOL, atol=_sizes(case, 1e2),
            max_step=1e-3, dense_output=True,
        )  # fmt: skip
        fine = done.sol(np.linspace(t, done.t[-1], max(int((done.t[-1] - t) / 2e-6), 2)))
        high, low = np.maximum(high, fine[:rows].max(1)), np.minimum(low, fine[:rows].min(1))
        t, y = float(done.t[-1]), done.y[:, -1]
        if done.status != 1:
            break
        # a hair past the event, so that the next stretch begins on its far side
        slope = rates(t, y)
        before = [_free(hard, y, i) for i in range(len(gaps))]
        t, y = t + 1e-12, y + 1e-12 * slope
        past = rates(t, y)
        t, y = t + 1e-10, y + 1e-10 * past
        after = [_free(hard, y, i) for i in range(len(gaps))]
        flew = [_free(hard, fine[:, len(fine[0]) // 2], i) for i in range(len(gaps))]
        impacts += [int((f or b) and not a) for f, b, a in zip(flew, before, after, strict=True)]
    return high, low, impacts


def _free(hard: ClearanceCase, y: np.ndarray, i: int) -> bool:
    """Whether the i-th clearance touches neither flank."""
    name, clearance = list(hard.clearances.items())[i]
    row = [e.element for e in hard.case.elements].index(name)
    return bool(-clearance.gap <= y[row] < 0.0)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "hard",
    [
        clearance_of_teeth(1e-5, "10 µm"),
        clearance_of_teeth(1e-5, "10 µm, no adhesion", "no adhesion"),
        replace(clearance_two(), name="two", end=0.4),
    ],
    ids=lambda c: c.name,
)
def test_a_clearance_as_scipy_integrates_it(hard: ClearanceCase) -> None:
    end = min(hard.end, 0.4)
    high, low, impacts = _by_events(hard, end)
    found = integrate(hard.case, end, hard.step, clearances=hard.clearances)
    k = np.array([e.stiffness for e in hard.case.elements])
    gap = np.array(
        [hard.clearances.get(e.element or "", Clearance(0.0)).gap for e in hard.case.elements]
    )
    size = np.maximum(np.abs(found.maximum), np.abs(found.minimum))
    below = np.where(gap > 0.0, np.minimum(low + gap, 0.0), low)
    np.testing.assert_allclose(found.maximum / size, k * high / size, atol=2e-6)
    np.testing.assert_allclose(found.minimum / size, k * below / size, atol=2e-6)
    np.testing.assert_array_equal(found.impacts[gap > 0.0], impacts)
    assert np.any(impacts > 0)
