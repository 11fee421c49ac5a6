"""Pull-in against the swing equation of one machine, integrated by DOP853.

With a constant load and a damper torque proportional to slip the equation is that of Tricomi,
δ'' + a δ' + sin δ = b (F. Tricomi, Annali Scuola Norm. Sup. Pisa 2 (1933) 1-20): a motor that runs
asynchronously comes into step if b is below a limit, which tends to 4a/π for small a. The limit
itself is found here by bisection on the scipy solution.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.case.case import Case
from engine.case.data import LoadTorqueRow
from engine.start.pull_in import has_failed, has_settled, judge_pull_in, swing_frequency_linear
from tests.engine.start.test_electrical import (
    FIELD_TIME,
    INERTIA,
    LINE,
    MACHINE,
    SYNCHRONOUS,
    simulated,
)
from tests.trains import motor

PULL_OUT, PAIRS = 20e3, 2.0
OMEGA = math.sqrt(PAIRS * PULL_OUT / INERTIA)
A = 0.15
DAMPER = A * OMEGA * INERTIA
SLIP = 0.08


def tricomi(b: float, end: float, times: np.ndarray | None = None, tolerance: float = 1e-11):
    """δ and slip speed from FIELD_TIME on; before, the machine coasts under its load."""
    load = b * PULL_OUT
    at_field = SLIP * SYNCHRONOUS + load / INERTIA * FIELD_TIME
    angle = LINE * FIELD_TIME - PAIRS * (
        SYNCHRONOUS * (1.0 - SLIP) * FIELD_TIME - 0.5 * load / INERTIA * FIELD_TIME**2
    )

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [PAIRS * y[1], (load - PULL_OUT * math.sin(y[0]) - DAMPER * y[1]) / INERTIA]

    return solve_ivp(
        rates, (FIELD_TIME, end), [angle, at_field], "DOP853", t_eval=times,
        rtol=tolerance, atol=tolerance,
    )  # fmt: skip


def goes_in_step(b: float) -> bool:
    """From the angle after a long time alone: at rest, or gone on turning."""
    found = tricomi(b, 80.0, tolerance=1e-9)
    return bool(abs(found.y[1, -1]) < 1e-3 * SYNCHRONOUS * SLIP)


@pytest.fixture(scope="module")
def limit() -> float:
    low, high = 0.95 * 4.0 * A / math.pi, 1.05 * 4.0 * A / math.pi
    assert goes_in_step(low)
    assert not goes_in_step(high)
    while high - low > 1e-5:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if goes_in_step(middle) else (low, middle)
    return 0.5 * (low + high)


def machine(b: float) -> Case:
    """No torque of its own but that of field and damper."""
    nothing = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    return Case(
        **MACHINE
        | {
            "motor_torque": motor(curve=nothing),
            "load_torque": (LoadTorqueRow("Motor", 1.0, b * PULL_OUT),),
            "pull_out_torque": PULL_OUT,
            "pull_in_damping": DAMPER,
            "field_time_constant": None,
            "shock_amplitude": None,
            "shock_time_constant": None,
            "pulsation_phase": None,
        }
    )


def history(b: float, end: float, h: float = 2e-3):
    """Time, load angle and slip of the engine's own simulation."""
    speed, theta = simulated(machine(b), (1.0 - SLIP) * SYNCHRONOUS, h, end)
    time = h * np.arange(len(speed))
    return time, LINE * time - PAIRS * theta, 1.0 - speed / SYNCHRONOUS


def test_limit_is_that_of_theory(limit: float) -> None:
    assert limit == pytest.approx(4.0 * A / math.pi, rel=0.02)


@pytest.mark.parametrize("share", [0.6, 0.995, 1.005, 1.5])
def test_in_step_below_the_limit_and_slipping_above(limit: float, share: float) -> None:
    b = share * limit
    time, angle, slip = history(b, 60.0)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, float(np.interp(FIELD_TIME, time, slip)))
    assert found.synchronised is (share < 1.0)
    assert found.synchronised is goes_in_step(b)
    frequency = swing_frequency_linear(PULL_OUT, b * PULL_OUT, INERTIA, PAIRS)
    assert frequency is not None
    assert has_settled(time, angle, FIELD_TIME, 1.0 / frequency) is (share < 1.0)
    if share >= 1.5:
        assert has_failed(time, angle, slip, FIELD_TIME)
    if share < 1.0:
        assert not has_failed(time, angle, slip, FIELD_TIME)
        assert found.load_angle == pytest.approx(math.asin(b), abs=1e-4)


@pytest.mark.parametrize("share", [0.3, 0.8, 1.2])
def test_passages_against_scipy(limit: float, share: float) -> None:
    """Pole slips and the time of the last passage of 180 degrees, from scipy's dense samples."""
    b, end = share * limit, 30.0
    time, angle, slip = history(b, end)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, float(np.interp(FIELD_TIME, time, slip)))
    times = np.linspace(FIELD_TIME, end, 200_001)
    truth = tricomi(b, end, times).y[0]
    well = np.floor((truth + math.pi) / (2.0 * math.pi))
    last = int(np.flatnonzero(np.diff(well))[-1])
    assert found.pole_slips == int((truth[last] - truth[0]) / (2.0 * math.pi))
    assert found.pole_slips >= 1
    if share < 1.0:
        assert found.pull_in_time == pytest.approx(times[last], abs=3e-4)


def test_small_swings_have_the_linear_frequency(limit: float) -> None:
    """Late swings of the damped pendulum: √(ω² cos δ − (a ω / 2)²)."""
    b = 0.5 * limit
    time, angle, slip = history(b, 30.0)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, SLIP)
    assert found.pull_in_time is not None
    late = time > found.pull_in_time + 6.0
    small = judge_pull_in(time[late], angle[late], slip[late], float(time[late][0]), SLIP)
    linear = swing_frequency_linear(PULL_OUT, b * PULL_OUT, INERTIA, PAIRS)
    assert linear is not None
    damped = math.sqrt(linear**2 - (0.25 * A * OMEGA / math.pi) ** 2)
    assert small.swing_frequency == pytest.approx(damped, rel=2e-4)
    # the first, large swings are slower
    assert found.swing_frequency is not None
    assert found.swing_frequency < damped
