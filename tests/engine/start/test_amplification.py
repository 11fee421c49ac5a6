"""The amplification of a crossing against one mode integrated by itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, PchipInterpolator

from engine.case.data import MeshRow, MotorTorqueRow
from engine.results.results import Results
from engine.run import run
from engine.start.crossings import Crossing
from tests.sample_case import sample_case

#: Points of a turn of the pulsation at which the mode integrated by itself is read.
POINTS = 40


def damped_by_curves(results: Results, crossing: Crossing) -> Callable[[float], float]:
    """What the slopes of torque curves add to 2ζω, against speed over synchronous: φ² dT/dω of each station.

    Loads are read at the speed of their own station, so that they damp; the motor where its curves are, too.
    """
    case, train, modes = results.case, results.train, results.modes
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    curves = [(r.station, r.speed, r.torque) for r in case.load_torque]
    if case.reads_own_speed:
        curves += [(r.station, r.speed, -(r.average or 0.0)) for r in case.motor_torque]
    parts = []
    for name in {station for station, *_ in curves}:
        rows = [(speed or 0.0, torque) for station, speed, torque in curves if station == name]
        at = train.stations.index(str(name))
        shape = modes.shape[train.node_dof[at], modes.n_rigid + crossing.mode - 1]
        own = float(shape * train.node_scale[at])
        slope = PchipInterpolator(*zip(*sorted(rows), strict=True)).derivative()
        parts.append((own**2 / (synchronous * train.speed_ratio[at]), slope))
    return lambda share: float(sum(gain * slope(share) for gain, slope in parts))


def by_itself(results: Results, crossing: Crossing, damping: float) -> float:
    """x'' + (2ζω + d) x' + ω² x = ω² T(n) sin θ, θ' = 2 (ω_line − p n), by a Runge-Kutta method.

    Largest mean of 2 x exp(−iθ) over two turns of the pulsation, weighted by a raised cosine, over T.
    """
    start = results.start
    assert start is not None
    assert start.runup is not None
    assert crossing.time is not None
    history, runup = start.trajectory, start.runup
    speed = CubicSpline(history.time[::5], history.mean_speed[::5])
    omega, line = 2.0 * math.pi * crossing.frequency, 120.0 * math.pi
    of_curves = damped_by_curves(results, crossing)

    def torque(time: float) -> float:
        return float(np.interp(speed(time), runup.speed, runup.pulsating))

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v, phase = state
        force, n = torque(time) * math.sin(phase), float(speed(time))
        rate = 2.0 * damping * omega + of_curves(2.0 * n / line)
        return [v, omega**2 * (force - x) - rate * v, 2.0 * (line - 2.0 * n)]

    begin, end = crossing.time - 2.0, min(crossing.time + 1.2, float(history.time[-1]))
    step = 0.05 / crossing.frequency
    found = solve_ivp(
        rates, (begin, end), [0.0] * 3, rtol=1e-8, atol=1e-8, max_step=step, dense_output=True
    )
    phase = np.arange(0.0, found.y[2, -1], 2.0 * math.pi / POINTS)
    when = np.interp(phase, found.y[2], found.t)
    weight = np.hanning(2 * POINTS + 1) / POINTS
    swing = found.sol(when)[0] * np.exp(-1j * phase)
    envelope = 2.0 * np.abs(np.convolve(swing, weight, "valid"))
    largest = int(np.argmax(envelope))
    return float(envelope[largest]) / torque(when[largest + POINTS])


@pytest.fixture(
    scope="module",
    params=[
        ("proposed", "mean speed"),
        pytest.param(("proposed", "own speed"), marks=pytest.mark.long),
        pytest.param(("modified", "mean speed"), marks=pytest.mark.long),
        pytest.param(("modified", "own speed"), marks=pytest.mark.long),
    ],
)
def results(request: pytest.FixtureRequest) -> Results:
    design, follows = request.param
    return run(sample_case(design, torque_follows=follows))


@pytest.mark.slow
def test_it_is_that_of_the_mode_integrated_by_itself(results: Results) -> None:
    """C13. A wrong phase, a wrong mode or a mean over more cycles would be far off.

    Without what the curves damp it would be 0.7 % off at the mean speed and 2.1 % at the own speed of the motor.
    """
    assert len(results.crossings) == 3
    for crossing in results.crossings:
        truth = by_itself(results, crossing, 0.015)
        assert crossing.amplification == pytest.approx(truth, rel=2.5e-3)


def test_the_note_says_what_the_start_did(results: Results) -> None:
    """The note names the amplification of this start, and how much less it is than at the resonance."""
    for crossing in results.crossings:
        assert crossing.amplification is not None
        assert crossing.amplification < 1.0 / 0.03
        taken = 1.0 - 0.03 * crossing.amplification
        assert f"acceleration takes off {taken:.0%}." in crossing.note


def test_a_slow_sweep_comes_to_the_resonance() -> None:
    """A tenth of the net torque: the mode dwells long enough, and acceleration makes no difference."""
    case = sample_case("proposed", damping_ratio=0.05)
    load = {p.speed: p for p in case.motor_torque}
    weak = tuple(
        MotorTorqueRow(p.station, p.speed, 0.2 * (p.average or 0.0), p.pulsating)
        for p in load.values()
    )
    slow = replace(
        case,
        motor_torque=weak,
        load_torque=tuple(replace(p, torque=0.0) for p in case.load_torque),
    )
    crossing = run(slow).crossings[-1]
    assert crossing.amplification == pytest.approx(10.0, rel=0.02)
    assert "damping limits it, not acceleration." in crossing.note


def test_without_damping_acceleration_alone_limits_it() -> None:
    crossing = run(sample_case("proposed", damping_ratio=None)).crossings[0]
    assert crossing.note.count("swept undamped") == 1
    assert "dwelling" not in crossing.note
    assert "acceleration alone limits it." in crossing.note


def test_with_clearances_it_is_a_ratio_of_peaks_and_says_so() -> None:
    """Of the governing element: half its torque range over what the pulsation does statically to it."""
    mesh = MeshRow("Mesh", None, 0.42, 0.075, math.radians(20.0), backlash=4e-4)
    crossings = run(sample_case("proposed", meshes=(mesh,))).crossings
    assert crossings
    for crossing in crossings:
        assert crossing.amplification is not None
        assert "here a ratio of peaks." in crossing.note
        assert "acceleration" not in crossing.note


def test_linear_and_with_a_clearance_the_ratios_are_alike_where_teeth_stay_together() -> None:
    """The highest mode of the modified design is crossed before any reversal."""
    mesh = MeshRow("Mesh", None, 0.42, 0.075, math.radians(20.0), backlash=4e-4)
    plain = run(sample_case("modified")).crossings[-1]
    parted = run(sample_case("modified", meshes=(mesh,))).crossings[-1]
    assert parted.mesh_minimum_torque is not None
    assert parted.mesh_minimum_torque > 0.0
    assert plain.amplification is not None
    assert parted.amplification == pytest.approx(plain.amplification, rel=0.25)
