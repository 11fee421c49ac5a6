"""What must hold of every train whose gears move on their bearings."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from state_space import damping_matrix
from strategies import cases, example_count

from engine.case.case import Case
from engine.case.data import MeshRow
from engine.model.build_train import build_train
from engine.model.modes import modal_damping_matrix, modes_of

FEW = example_count(40)


@st.composite
def on_bearings(draw, *, stations=(3, 30), decades=6.0, dampers=False) -> Case:
    """A random train with pitch radii everywhere, and bearings at some gears of elastic meshes."""
    case = draw(cases(stations=stations, decades=decades, grounded=None, dampers=dampers))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1), label="gears"))
    meshes = [e for e in case.elements if e.kind == "gear mesh"]
    rigid = {name for e in meshes if e.stiffness is None for name in (e.from_, e.to)}
    elastic = [e for e in meshes if e.stiffness is not None]
    gears = sorted({name for e in elastic for name in (e.from_, e.to)} - rigid)
    bodies = {name: 10.0 ** rng.uniform(1, 3) for name in gears if rng.random() < 0.7}
    assume(bodies)
    rows = []
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    for e in elastic:
        radius = 10.0 ** rng.uniform(-1, 0)
        kind = str(rng.choice(["external", "internal"]))
        if abs(ratio[e.from_] / ratio[e.to] - 1.0) < 0.01:  # a ring is larger than its pinion
            kind = "external"
        data = {}
        for side, name in (("drive", e.from_), ("driven", e.to)):
            if name in bodies:
                data |= {
                    f"mass_{side}": bodies[name],
                    f"bearing_stiffness_{side}": bodies[name] * 1e6,
                    f"bearing_damping_{side}": bodies[name] * 10.0 if dampers else None,
                }
        rows.append(
            MeshRow(
                e.element,
                kind,
                radius,
                pressure_angle=rng.uniform(0.2, 0.5),
                helix_angle=rng.uniform(-0.5, 0.5),
                orientation=rng.uniform(-math.pi, math.pi),
                **data,
            )
        )
    return replace(case, meshes=tuple(rows))


@FEW
@given(on_bearings())
def test_bearings_hold_no_shaft_and_add_two_modes_a_gear(case):
    train, plain = build_train(case), build_train(case, lateral=False)
    modes = modes_of(train)
    assert modes.n_rigid == modes_of(plain).n_rigid
    assert np.all(modes.omega[: modes.n_rigid] == 0.0)
    assert np.all(modes.omega[modes.n_rigid :] > 0.0)
    assert modes.n_modes == train.n_dof == plain.n_dof + 2 * len(train.bodies)
    if modes.n_rigid:
        angle = (train.node_matrix() @ modes.shape)[:, 0]
        shaft = angle[: len(plain.speed_ratio)] / plain.speed_ratio
        assert shaft == pytest.approx(np.full(len(shaft), shaft[0]), rel=1e-13)
        assert np.all(angle[len(plain.speed_ratio) :] == 0.0)


@FEW
@given(on_bearings(stations=(3, 12), decades=3.0))
def test_frequencies_are_those_of_a_positive_semidefinite_stiffness(case):
    train = build_train(case)
    root = 1.0 / np.sqrt(train.inertia)
    K = root[:, None] * ((train.incidence.T * train.stiffness) @ train.incidence) * root
    values = np.linalg.eigvalsh(K)
    assert values[0] >= -1e-12 * values[-1]
    assert modes_of(train).omega ** 2 == pytest.approx(values, rel=1e-9, abs=1e-11 * values[-1])


@example_count(12)
@given(on_bearings(stations=(3, 8), decades=12.0))
def test_every_frequency_is_right_to_1e_12_also_with_bearings(case):
    """Against the eigenvalues of DᵀD in 60 digits; no count is possible here."""
    train = build_train(case)
    modes = modes_of(train)
    with mpmath.workdps(60):
        root = [1 / mpmath.sqrt(mpmath.mpf(m)) for m in train.inertia]
        scaled = mpmath.matrix(train.n_rows, train.n_dof)
        for row, dof in zip(*np.nonzero(train.incidence), strict=True):
            entry = mpmath.mpf(train.incidence[row, dof]) * root[dof]
            scaled[int(row), int(dof)] = entry * mpmath.sqrt(mpmath.mpf(train.stiffness[row]))
        square = sorted(mpmath.eigsy(scaled.T * scaled, eigvals_only=True))[modes.n_rigid :]
        omega = np.array([float(mpmath.sqrt(value)) for value in square])
    assert modes.omega[modes.n_rigid :] == pytest.approx(omega, rel=1e-12, abs=0.0)


@FEW
@given(on_bearings())
def test_flexible_bearings_lower_every_frequency(case):
    """Rayleigh: rigid bearings are constraints; the frequencies interlace."""
    flexible, rigid = modes_of(build_train(case)), modes_of(build_train(case, lateral=False))
    assert np.all(flexible.omega[: rigid.n_modes] <= rigid.omega * (1.0 + 1e-9))
    assert np.all(flexible.omega[-rigid.n_modes :] >= rigid.omega * (1.0 - 1e-9))


@FEW
@given(on_bearings())
def test_energies_sum_to_one_with_the_bearings(case):
    modes = modes_of(build_train(case))
    for share in (modes.bearing_share, modes.sideways_share):
        assert np.all(share >= 0.0)
        assert np.all(share[:, : modes.n_rigid] == 0.0)
    strain = (modes.strain_share.sum(axis=0) + modes.bearing_share.sum(axis=0))[modes.n_rigid :]
    assert strain == pytest.approx(np.ones(len(strain)), abs=1e-12)
    kinetic = modes.kinetic_share.sum(axis=0) + modes.sideways_share.sum(axis=0)
    assert kinetic == pytest.approx(np.ones(modes.n_modes), abs=1e-12)


@FEW
@given(on_bearings())
def test_torques_and_forces_balance_the_inertias(case):
    train = build_train(case)
    modes = modes_of(train)
    left = train.incidence.T @ modes.row_torque
    right = train.inertia[:, None] * modes.shape * modes.omega**2
    largest = np.max(np.abs(modes.row_torque), axis=0, initial=0.0)
    gain = np.max(np.abs(train.incidence), initial=1.0)
    assert np.all(np.abs(left - right) <= 1e-9 * gain * largest + 1e-300)


@FEW
@given(on_bearings(), st.floats(-10.0, 10.0))
def test_turning_the_whole_machine_changes_nothing(case, angle):
    turned = tuple(replace(m, orientation=m.orientation + angle) for m in case.meshes)
    a, b = modes_of(build_train(case)), modes_of(build_train(replace(case, meshes=turned)))
    assert b.omega == pytest.approx(a.omega, rel=1e-9, abs=0.0)


@FEW
@given(on_bearings())
def test_flanks_push_along_unit_normals_that_mirror_each_other(case):
    """Same rotations with opposite sign; displacements mirrored about the line of centres."""
    train = build_train(case)
    meshes = {m.element: m for m in case.meshes}
    turning = len(train.speed_ratio) - 2 * len(train.bodies)
    for flank in train.flanks:
        mesh = meshes[train.elements[flank.element]]
        assert np.array_equal(flank.back[:turning], -flank.drive[:turning])
        line = complex(math.cos(mesh.orientation), math.sin(mesh.orientation))
        for body in train.bodies:
            nodes = [body.node_x, body.node_y]
            drive, back = (complex(*row[nodes]) for row in (flank.drive, flank.back))
            axis = complex(math.cos(body.axis_angle), math.sin(body.axis_angle)) / line
            # As seen from the line of centres: same along it, opposite across.
            assert abs((back * axis) - (drive * axis).conjugate()) <= 1e-12 / flank.base_radius
            if drive:
                assert abs(drive) * flank.base_radius == pytest.approx(1.0, rel=1e-12)


@example_count(25)
@given(on_bearings(stations=(3, 12), decades=3.0, dampers=True))
def test_modal_damping_holds_the_bearings_dampers(case):
    train = build_train(case)
    modes = modes_of(train)
    direct = modes.shape.T @ damping_matrix(train) @ modes.shape
    found = modal_damping_matrix(train, modes)
    assert found == pytest.approx(direct, rel=1e-6, abs=1e-6 * float(np.max(np.abs(direct))))
    bearings = np.where(train.row_element < 0, train.viscous, 0.0)
    alone = replace(train, viscous=bearings, node_damping=np.zeros_like(train.node_damping))
    assert np.trace(modal_damping_matrix(alone, modes)) == pytest.approx(
        10.0 * 2 * len(train.bodies), rel=1e-6
    )
