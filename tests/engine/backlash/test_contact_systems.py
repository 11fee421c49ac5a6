"""The linear pieces of a train with clearances: modes, damping and torques of each."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from engine.backlash.contact_systems import ContactSystems, ForceLocations, shared_basis
from engine.backlash.event_start import clearances_of
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.model.train import Train
from engine.stepping.contact_loop import BACK, DRIVE, FREE
from tests.random_clearances import pushed_train


def pieces_of(
    case: CaseData, keep: int | None = None, ratio: float = 0.02
) -> tuple[Train, ContactSystems]:
    """ContactSystems of a train with `keep` modes kept (default all) and a torque at every station."""
    train = build_train(case)
    modes = modes_of(train)
    kept = np.arange(modes.n_modes) < (keep or modes.n_modes)
    stated = np.where(modes.omega > 0.0, ratio, 0.0)
    basis = shared_basis(train, modes, clearances_of(train), kept, stated, ratio)
    stations = np.arange(train.n_stations)
    places = ForceLocations(stations, np.zeros(0, dtype=np.int64), len(stations), np.zeros(0))
    scale = np.ones(len(train.element_rows) + len(train.rigid_meshes))
    m = basis.vectors.shape[1]
    return train, ContactSystems(basis, places, np.zeros(m), np.zeros((0, m)), scale)


def contacts(count: int) -> list[tuple[int, ...]]:
    """Every combination of loaded flanks, drive flanks first."""
    return list(itertools.product(*[(FREE, DRIVE)] * count, *[(FREE, BACK)] * count))


@pytest.mark.parametrize("seed", range(6))
def test_modes_of_every_piece_against_a_dense_eigensolver(seed: int) -> None:
    p = pushed_train(seed, 1 + seed % 2, bearings=seed % 3 == 0)
    train, pieces = pieces_of(p.case)
    flanks = clearances_of(train)
    n, to_dof = len(flanks), train.node_matrix()
    for contact in contacts(n):
        rows = [r for r in range(train.n_rows) if r not in [f.drive_row for f in flanks]]
        K = (train.incidence[rows].T * train.stiffness[rows]) @ train.incidence[rows]
        for i, f in enumerate(flanks):
            for row, state in ((f.drive, contact[i]), (f.back, contact[n + i])):
                if state != FREE:
                    K += f.stiffness * np.outer(row @ to_dof, row @ to_dof)
        truth = eigh(K, np.diag(train.inertia), eigvals_only=True)
        found = pieces.pieces[pieces.index_of(contact)]
        size = truth.max()
        np.testing.assert_allclose(np.sort(found.stiffness), truth, rtol=1e-9, atol=1e-12 * size)
        # rounding has no say in what is free
        assert np.count_nonzero(found.stiffness == 0.0) == np.count_nonzero(truth < 1e-10 * size)
        np.testing.assert_allclose(found.turn @ found.turn.T, np.eye(len(truth)), atol=1e-12)


def test_a_piece_is_made_once_and_limited_damping_is_the_same_piece() -> None:
    _, pieces = pieces_of(pushed_train(3, 2).case)
    first = pieces.index_of((DRIVE, FREE, FREE, FREE))
    assert pieces.index_of((DRIVE + 1, FREE, FREE, FREE)) == first
    assert pieces.index_of((FREE, DRIVE, FREE, FREE)) != first
    assert pieces.index_of((FREE, FREE, BACK, FREE)) != first
    assert len(pieces.pieces) == 3


def test_parts_that_a_clearance_sets_apart_turn_freely_whatever_is_kept() -> None:
    """With few modes kept the basis still holds both rigid motions, exactly."""
    case = chain()
    train, pieces = pieces_of(case, keep=2)
    found = pieces.pieces[pieces.index_of((FREE, FREE))]
    assert np.count_nonzero(found.stiffness == 0.0) == 2
    basis = pieces.basis
    for side in ((0, 1), (2, 3, 4)):
        shape = np.zeros(train.n_dof)
        shape[list(side)] = 1.0
        inside = basis.vectors @ (basis.vectors.T @ (train.inertia * shape))
        np.testing.assert_allclose(inside, shape, atol=1e-10)


def chain(**fields: object) -> CaseData:
    inertia, stiffness = (3.0, 1.0, 2.0, 0.5, 4.0), (4e5, 1e5, 9e5, 2e5)
    given = {
        "stations": tuple(StationRow(f"S{i}", None, j) for i, j in enumerate(inertia)),
        "elements": tuple(
            ElementRow(f"E{i}", "coupling" if i == 1 else "shaft", f"S{i}", f"S{i + 1}", k)
            for i, k in enumerate(stiffness)
        ),
        "meshes": (MeshRow("E1", angular_backlash=0.01),),
    }
    return CaseData(**(given | fields))


def test_stated_damping_acts_on_the_modes_of_each_piece() -> None:
    """Equal ratios everywhere: every elastic mode of every piece has it, free flight none."""
    _, pieces = pieces_of(chain(), ratio=0.03)
    for contact in contacts(1):
        piece = pieces.pieces[pieces.index_of(contact)]
        omega = np.sqrt(piece.stiffness)
        np.testing.assert_allclose(piece.rate, 2.0 * 0.03 * omega, rtol=1e-12, atol=1e-12)


def test_loss_factor_and_damper_of_a_free_flank_do_nothing() -> None:
    elements = tuple(
        replace(e, loss_factor=0.1, damping=300.0) if e.element == "E1" else e
        for e in chain().elements
    )
    _, pieces = pieces_of(chain(elements=elements), ratio=0.0)
    free = pieces.pieces[pieces.index_of((FREE, FREE))]
    assert np.all(free.rate == 0.0)
    drive = pieces.pieces[pieces.index_of((DRIVE, FREE))]
    assert np.any(drive.rate > 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_static_torques_of_a_piece_are_those_of_its_free_body(seed: int) -> None:
    """Accelerated as a whole by one torque: a loaded flank carries what is beyond it."""
    p = pushed_train(seed, 1)
    train, pieces = pieces_of(p.case)
    flank = clearances_of(train)[0]
    for contact in ((DRIVE, FREE), (FREE, BACK)):
        piece = pieces.pieces[pieces.index_of(contact)]
        force = np.zeros(piece.reach.shape[1])
        sign = 1.0 if contact[0] else -1.0
        force[0] = sign * 100.0
        u = piece.reach @ force + piece.constant
        elastic = piece.stiffness > 0.0
        q = np.where(elastic, u / np.where(elastic, piece.stiffness, 1.0), 0.0)
        torque = piece.output_position @ q + piece.output_force @ force + piece.output_constant
        ratio = train.speed_ratio[: train.n_stations]
        inertia = train.node_inertia[: train.n_stations]
        beyond = np.asarray(train.beyond[flank.element][: train.n_stations], dtype=bool)
        rate = ratio * (ratio[0] * force[0]) / np.sum(inertia * ratio**2)
        at = ratio[train.stations.index(p.case.elements[flank.element].from_)]
        side = beyond if not beyond[0] else ~beyond
        carried = np.sum((inertia * rate * ratio)[side]) / at
        assert abs(torque[flank.element]) == pytest.approx(abs(carried), rel=1e-8)


def test_tooth_stiffness_and_gap_are_taken_to_the_line_of_action() -> None:
    """tan α_t = tan α_n / cos β, sin β_b = sin β cos α_n: gap j / (cos β_b r_b), stiffness k cos² β_b r_b²."""
    alpha, beta, r, j, k = 0.35, 0.3, 0.4, 3e-4, 2e9
    case = CaseData(
        stations=(StationRow("a", None, 5.0), StationRow("b", None, 1.0, 2.0)),
        elements=(ElementRow("mesh", "gear mesh", "a", "b"),),
        meshes=(MeshRow("mesh", None, r, 0.5 * r, alpha, beta, None, k, backlash=j),),
    )
    _, pieces = pieces_of(case)
    base = r * math.cos(math.atan(math.tan(alpha) / math.cos(beta)))
    cos_base = math.sqrt(1.0 - (math.sin(beta) * math.cos(alpha)) ** 2)
    gap, stiffness, _, _ = pieces.contacts
    np.testing.assert_allclose(gap, [0.0, j / (cos_base * base)], rtol=1e-12)
    np.testing.assert_allclose(stiffness, k * cos_base**2 * base**2, rtol=1e-12)
