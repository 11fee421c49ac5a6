"""What holds for the time response of any train."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.case.case import Case
from engine.start.time_response import (
    TimeResponse,
    linear,
    time_response,
)
from tests.prescribed import held, modal_speed, torque_from_function
from tests.strategies import cases, example_count
from tests.trains import prepared

#: Rounding of the phase ω t of a mode of 1e8 rad/s over the times below.
PHASE = 1e-6
seeds = st.integers(0, 2**32 - 1)


def consistent(train: Any, rng: np.random.Generator) -> np.ndarray:
    """Random speeds of the stations that no rigid mesh contradicts."""
    n = train.n_stations
    return train.node_scale[:n] * rng.normal(size=train.n_dof)[train.node_dof[:n]]


def energy(train: Any, case: Case, r: TimeResponse) -> np.ndarray:
    inertia = np.array([s.inertia for s in case.stations])
    elastic = len(train.stiffness)
    stored = 0.5 * np.sum(r.torque[:elastic] ** 2 / train.stiffness[:, None], axis=0)
    return 0.5 * inertia @ r.station_speed**2 + stored


@pytest.mark.slow
@example_count(60)
@given(case=cases(grounded=None), seed=seeds)
def test_energy_and_momentum_are_kept_without_damping(case: Case, seed: int) -> None:
    train, modes, _ = prepared(case)
    speed = consistent(train, np.random.default_rng(seed))
    t = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 40)])
    r = time_response(train, modes, [], t, initial_speed=modal_speed(train, modes, speed))
    total = energy(train, case, r)
    np.testing.assert_allclose(total, total[0], rtol=1e-9)
    if modes.n_rigid:
        weight = np.array([s.inertia for s in case.stations]) * train.speed_ratio[: len(speed)]
        size = np.abs(weight) @ np.abs(speed)
        np.testing.assert_allclose(weight @ r.station_speed, weight @ speed, atol=1e-9 * size)


@pytest.mark.slow
@example_count(15)
@given(case=cases(stations=(2, 40), grounded=None, dampers=True), seed=seeds)
def test_dampers_and_modal_damping_only_take_energy(case: Case, seed: int) -> None:
    train, modes, _ = prepared(case)
    speed = consistent(train, np.random.default_rng(seed))
    t = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 25)])
    ratio = np.where(modes.omega > 0.0, 0.01, 0.0)
    r = time_response(
        train, modes, [], t, initial_speed=modal_speed(train, modes, speed), damping_ratio=ratio
    )
    total = energy(train, case, r)
    assert np.all(np.diff(total) <= 1e-7 * total[0])


@example_count(40)
@given(case=cases(), seed=seeds)
def test_order_of_stations_and_elements_is_irrelevant(case: Case, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m = len(case.stations), len(case.elements)
    at, order, rows = int(rng.integers(n)), rng.permutation(n), rng.permutation(m)
    mixed = replace(
        case,
        stations=tuple(case.stations[i] for i in order),
        elements=tuple(case.elements[i] for i in rows),
    )
    t = np.linspace(0.0, 0.1, 11)
    got = []
    for c in (case, mixed):
        train, modes, _ = prepared(c)
        where = train.stations.index(str(case.stations[at].station))
        r = time_response(train, modes, [held(where, t[:1], np.array([1000.0]))], t)
        speed = {s: r.station_speed[i] for i, s in enumerate(train.stations)}
        # which side of an element counts as the driven one may follow the order: size alone
        torque = {
            train.elements[e]: np.abs(y) for e, y in zip(r.output_element, r.torque, strict=True)
        }
        got.append((speed, torque))
    for a, b in zip(*got, strict=True):
        for name, value in a.items():
            np.testing.assert_allclose(
                b[name], value, atol=PHASE * max(np.max(np.abs(v)) for v in a.values())
            )


def referred(case: Case) -> Case:
    """The same train at one speed: J n², k n² of the side the element is seen from."""
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    return replace(
        case,
        stations=tuple(
            replace(s, inertia=s.inertia * ratio[s.station] ** 2, speed_ratio=1.0)
            for s in case.stations
        ),
        elements=tuple(
            replace(e, stiffness=e.stiffness * ratio[e.from_] ** 2 if e.stiffness else None)
            for e in case.elements
        ),
    )


@example_count(40)
@given(case=cases(), seed=seeds)
def test_referring_through_gears_changes_nothing_physical(case: Case, seed: int) -> None:
    at = int(np.random.default_rng(seed).integers(len(case.stations)))
    ratio = np.array([s.speed_ratio or 1.0 for s in case.stations])
    t = np.linspace(0.0, 0.1, 11)
    train, modes, _ = prepared(case)
    own = time_response(train, modes, [held(at, t[:1], np.array([1000.0]))], t)
    flat_train, flat_modes, _ = prepared(referred(case))
    push = held(at, t[:1], np.array([1000.0 * ratio[at]]))
    flat = time_response(flat_train, flat_modes, [push], t)
    speed = own.station_speed / ratio[:, None]
    np.testing.assert_allclose(
        flat.station_speed, speed, atol=PHASE * np.max(np.abs(flat.station_speed))
    )
    first = {e.element: ratio[train.stations.index(str(e.from_))] for e in case.elements}
    scale = np.array([first[train.elements[e]] for e in own.output_element])
    np.testing.assert_allclose(
        flat.torque, own.torque * scale[:, None], atol=PHASE * np.max(np.abs(flat.torque))
    )


@example_count(30)
@given(case=cases(stations=(2, 12), grounded=None, dampers=True), seed=seeds)
def test_held_and_linear_torques_are_exact(case: Case, seed: int) -> None:
    """Dividing the steps further changes nothing, coupled by dampers or not."""
    rng = np.random.default_rng(seed)
    train, modes, _ = prepared(case)
    n = len(case.stations)
    knots = np.sort(rng.uniform(0.0, 0.1, 6))
    torques = [
        held(int(rng.integers(n)), knots, rng.normal(size=6)),
        linear(int(rng.integers(n)), knots + 0.003, rng.normal(size=6)),
    ]
    coarse, fine = np.linspace(0.0, 0.12, 5), np.linspace(0.0, 0.12, 33)
    a = time_response(train, modes, torques, coarse)
    b = time_response(train, modes, torques, fine)
    for name in ("torque", "station_speed", "station_angle"):
        one, two = getattr(a, name), getattr(b, name)[:, ::8]
        np.testing.assert_allclose(
            one, two, atol=1e-6 * max(np.max(np.abs(getattr(b, name))), 1e-30)
        )


@example_count(30)
@given(
    case=cases(stations=(2, 20), decades=4.0, grounded=None),
    seed=seeds,
    ratio=st.sampled_from([0.0, 0.01, 0.3]),
)
def test_callables_converge_with_the_fourth_power(case: Case, seed: int, ratio: float) -> None:
    """Where the steps resolve the modes."""
    rng = np.random.default_rng(seed)
    fastest = float(prepared(case)[1].omega[-1])
    slower = (1000.0 / fastest) ** 2 if fastest > 0.0 else 1.0
    case = replace(
        case,
        elements=tuple(
            replace(e, stiffness=slower * e.stiffness if e.stiffness else None)
            for e in case.elements
        ),
    )
    train, modes, _ = prepared(case)
    omega, phase = rng.uniform(50.0, 500.0), rng.uniform(0.0, 6.0)
    push = torque_from_function(
        int(rng.integers(len(case.stations))), lambda t: np.sin(omega * t + phase)
    )
    damping = np.where(modes.omega > 0.0, ratio, 0.0)

    def at(n: int) -> np.ndarray:
        t = np.linspace(0.0, 0.05, n + 1)
        r = time_response(train, modes, [push], t, damping_ratio=damping)
        return r.station_angle[:, :: n // 10]

    true = at(3200)
    size = np.max(np.abs(true))
    errors = [np.max(np.abs(at(n) - true)) / size for n in (50, 100, 200)]
    for coarse, fine in zip(errors[:-1], errors[1:], strict=True):
        assert fine < 1e-9 or coarse / fine > 10.0, errors
