"""What holds for every train with clearances, whatever its numbers: without drive, and in its limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.backlash.event_start import clearances_of
from engine.case.data import CaseData, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.model.train import Train
from tests.clearance_response import ClearanceResponse, clearance_response
from tests.random_clearances import Pushed, pushed_train
from tests.strategies import example_count

LAWS = ("limited", "no adhesion")
END = 0.1
pushed = st.builds(
    pushed_train,
    st.integers(0, 2**20),
    st.integers(1, 3),
    damped=st.booleans(),
    bearings=st.booleans(),
    grounded=st.booleans(),
)


def followed(
    p: Pushed, law: str = "limited", samples: int = 11, case: CaseData | None = None, **given: float
) -> tuple[Train, ClearanceResponse]:
    case = case or p.case
    train = build_train(case)
    times = np.linspace(0.0, END, samples)
    return train, clearance_response(
        train, modes_of(train), clearances_of(train), times,
        initial_speed=p.speed, contact_law=law, **given,
    )  # fmt: skip


def energy(train: Train, found: ClearanceResponse) -> np.ndarray:
    """Kinetic energy and that of all springs, flanks and bearings, at every step.

    From the stations' and gears' own motion, and flanks as springs that push only.
    """
    run = found.run
    basis = train.inertia[:, None] * 1.0
    flanks = [f for f in train.flanks if f.gap is not None]
    position, velocity = run.dof_position, run.dof_velocity
    total = 0.5 * (basis * velocity**2).sum(axis=0)
    loaded = np.ones(train.n_rows, dtype=bool)
    loaded[[f.drive_row for f in flanks]] = False
    twist = train.incidence @ position
    total += 0.5 * (train.stiffness[loaded, None] * twist[loaded] ** 2).sum(axis=0)
    to_dof = train.node_matrix()
    for f in flanks:
        for row, gap in ((f.drive, 0.0), (f.back, f.gap)):
            depth = np.maximum((row @ to_dof) @ position - gap, 0.0)
            total += 0.5 * f.stiffness * depth**2
    return total


class Motion:
    """A response with its motion in the train's own freedoms."""

    def __init__(self, train: Train, found: ClearanceResponse, vectors: np.ndarray) -> None:
        self.dof_position = vectors @ found.run.position
        self.dof_velocity = vectors @ found.run.velocity


def with_motion(train: Train, found: ClearanceResponse) -> ClearanceResponse:
    """All modes are kept, so that the common basis is that of the closed train."""
    return replace(found, run=Motion(train, found, modes_of(train).shape))


@pytest.mark.slow
@example_count(30)
@given(pushed, st.sampled_from(LAWS))
def test_energy_never_rises_and_momentum_stays(p: Pushed, law: str) -> None:
    train, found = followed(p, law)
    e = energy(train, with_motion(train, found))
    assert np.max(np.diff(e), initial=0.0) <= 2e-6 * e[0]
    assert e[-1] <= e[0] * (1.0 + 1e-9)
    if not np.any(train.viscous[[f.drive_row for f in train.flanks if f.gap]]) and not np.any(
        train.viscous
    ):
        assert e[-1] == pytest.approx(e[0], rel=1e-8)
    if p.case.elements[-1].to != "ground":
        n = train.n_stations
        weight = train.node_inertia[:n] * train.speed_ratio[:n]
        momentum = weight @ found.station_speed
        scale = weight @ np.abs(p.speed)
        assert np.max(np.abs(momentum - momentum[0])) < 1e-10 * scale


@example_count(30)
@given(pushed, st.sampled_from(LAWS))
def test_flanks_push_within_their_law_and_gaps_carry_nothing(p: Pushed, law: str) -> None:
    """Drive flank: torque of one sign where the back one is free; none in the gap; at most 2 k δ."""
    train, found = followed(p, law)
    trajectory = found.run.trajectory
    position = modes_of(train).shape @ found.run.position
    to_dof = train.node_matrix()
    for f in train.flanks:
        if f.gap is None:
            continue
        row = int(np.flatnonzero(trajectory.output_element == f.element)[0])
        torque = trajectory.torque[row]
        scale = max(float(np.max(np.abs(torque))), 1e-12)
        drive = (f.drive @ to_dof) @ position
        back = (f.back @ to_dof) @ position - f.gap
        noise = 1e-9 * scale / f.stiffness
        assert (
            np.max(np.abs(torque[(drive < -noise) & (back < -noise)]), initial=0.0) <= 1e-9 * scale
        )
        assert np.min(torque[back < -noise], initial=0.0) >= -1e-6 * scale
        assert np.max(torque[drive < -noise], initial=0.0) <= 1e-6 * scale
        if law == "limited":
            limit = 2.0 * f.stiffness * (np.maximum(drive, 0.0) + np.maximum(back, 0.0))
            assert np.all(np.abs(torque) <= limit + 1e-6 * scale)


def linear_peak(p: Pushed, gap: float, end: float = 0.02) -> np.ndarray:
    case = replace(
        p.case,
        meshes=tuple(
            replace(
                m,
                backlash=gap * m.pitch_radius_drive if m.backlash else m.backlash,
                angular_backlash=gap if m.angular_backlash else m.angular_backlash,
            )
            for m in p.case.meshes
        ),
    )
    train = build_train(case)
    times = np.linspace(0.0, end, 21)
    return clearance_response(
        train, modes_of(train), clearances_of(train), times, initial_speed=p.speed
    ).station_speed


@pytest.mark.parametrize("seed", range(4))
def test_a_gap_that_shrinks_to_nothing_gives_the_linear_train(seed: int) -> None:
    """First order in the gap; without contact damping, which would act in compression only."""
    p = pushed_train(seed, 1 + seed % 3, damped=False)
    closed = linear_peak(p, 0.0)
    size = float(np.max(np.abs(closed)))
    errors = [float(np.max(np.abs(linear_peak(p, g) - closed))) / size for g in (1e-7, 1e-8, 1e-9)]
    assert errors[-1] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.3)
    assert errors[1] / errors[2] == pytest.approx(10.0, rel=0.3)


@pytest.mark.parametrize("seed", range(4))
def test_a_gap_wider_than_the_motion_lets_both_parts_go(seed: int) -> None:
    """The two parts, each calculated as a train of its own."""
    p = pushed_train(seed, 1, gap=1e3)
    m = next(m for m in p.case.meshes if m.backlash or m.angular_backlash)
    cut = next(e for e in p.case.elements if e.element == m.element)
    away = {cut.from_: -30.0, cut.to: 0.0}  # parted from the beginning, and moving apart
    near = {cut.from_}
    for _ in p.case.stations:
        for e in p.case.elements:
            if e is not cut and near & {e.from_, e.to}:
                near |= {e.from_, e.to}
    ratio = {s.station: s.speed_ratio or 1.0 for s in p.case.stations}
    names = [s.station for s in p.case.stations]
    speed = p.speed + np.array([away[cut.from_] * ratio[n] if n in near else 0.0 for n in names])
    _, whole = followed(replace(p, speed=speed), samples=21)
    assert not np.any(whole.log[:, 3] > 0)
    for side in (near, set(names) - near):
        kept = tuple(s for s in p.case.stations if s.station in side)
        case = replace(
            p.case,
            stations=kept,
            elements=tuple(e for e in p.case.elements if {e.from_, e.to} <= side),
            meshes=tuple(
                x for x in p.case.meshes
                if any(e.element == x.element and {e.from_, e.to} <= side for e in p.case.elements)
            ),
        )  # fmt: skip
        at = [names.index(s.station) for s in kept]
        part = replace(p, case=case, speed=speed[at])
        if len(kept) == 1:
            np.testing.assert_allclose(whole.station_speed[at], speed[at][:, None] * np.ones(21))
            continue
        _, alone = followed(part, samples=21)
        np.testing.assert_allclose(
            whole.station_speed[at], alone.station_speed, atol=1e-8 * np.max(np.abs(speed))
        )


@example_count(10)
@given(st.integers(0, 2**20), st.integers(1, 3), st.booleans(), st.randoms(use_true_random=False))
def test_order_of_elements_and_their_direction_change_nothing(
    seed: int, clearances: int, bearings: bool, random
) -> None:
    """One element at a time is turned round, its data referred to its other side."""
    p = pushed_train(seed, clearances, bearings=bearings)
    shuffled = list(p.case.elements)
    random.shuffle(shuffled)
    _, first = followed(p, samples=5, step=2e-4)
    _, second = followed(p, samples=5, case=replace(p.case, elements=tuple(shuffled)), step=2e-4)
    late = min(2, len(first.log))
    np.testing.assert_allclose(first.log[:late, 0], second.log[:late, 0], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(
        first.station_speed[:, 1], second.station_speed[:, 1],
        atol=1e-5 * float(np.max(np.abs(p.speed))),
    )  # fmt: skip


@example_count(10)
@given(st.integers(0, 2**20), st.integers(1, 3), st.floats(0.2, 5.0))
def test_speeds_may_be_stated_against_any_shaft(seed: int, clearances: int, factor: float) -> None:
    """All ratios multiplied by one number: the reference shaft is another, nothing else."""
    p = pushed_train(seed, clearances)
    stations = tuple(
        StationRow(s.station, None, s.inertia, factor * (s.speed_ratio or 1.0))
        for s in p.case.stations
    )
    _, first = followed(p, samples=5, step=2e-4)
    _, second = followed(p, samples=5, case=replace(p.case, stations=stations), step=2e-4)
    np.testing.assert_allclose(
        first.station_speed[:, 1], second.station_speed[:, 1],
        atol=1e-5 * float(np.max(np.abs(p.speed))),
    )  # fmt: skip
