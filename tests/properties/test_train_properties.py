"""What must hold of every train: physics that no choice of reference, order or name can change."""

import math
from dataclasses import replace

import numpy as np
import pytest
from high_precision import ReferredTree
from hypothesis import assume, given
from hypothesis import strategies as st
from state_space import damping_matrix, state_matrix
from strategies import cases, example_count

from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow, case_digest
from engine.model.build_train import build_train
from engine.model.modes import damped_eigenvalues, modal_damping_matrix, modes_of

FEW = example_count(40)


def elastic(case):
    modes = modes_of(build_train(case))
    return modes.omega[modes.n_rigid :]


def speed(case):
    return {s.station: s.speed_ratio or 1.0 for s in case.stations}


# --- rigid modes ----------------------------------------------------------------------------------


@FEW
@given(cases(grounded=None))
def test_one_rigid_mode_unless_tied_to_ground(case):
    train = build_train(case)
    modes = modes_of(train)
    grounded = any(e.kind == "spring to ground" for e in case.elements)
    assert modes.n_rigid == (0 if grounded else 1)
    assert np.all(modes.omega[: modes.n_rigid] == 0.0)
    assert np.all(modes.omega[modes.n_rigid :] > 0.0)
    assert modes.n_modes == train.n_dof


@FEW
@given(cases(stations=(3, 40)), st.data())
def test_parts_joined_by_dampers_alone_have_a_rigid_mode_each(case, data):
    """A damper instead of a shaft parts the train; the topology is counted, not the numbers."""
    stiff = [i for i, e in enumerate(case.elements) if e.stiffness is not None]
    assume(stiff)
    cut = data.draw(st.sets(st.sampled_from(stiff), min_size=1, max_size=4))
    elements = tuple(
        replace(e, stiffness=0.0, damping=1.0, loss_factor=None) if i in cut else e
        for i, e in enumerate(case.elements)
    )
    modes = modes_of(build_train(replace(case, elements=elements)))
    assert modes.n_rigid == 1 + len(cut)
    assert np.all(modes.omega[: modes.n_rigid] == 0.0)


@FEW
@given(cases())
def test_the_rigid_mode_turns_every_station_at_its_own_speed(case):
    train = build_train(case)
    modes = modes_of(train)
    angle = (train.node_matrix() @ modes.shape)[:, 0]
    assert angle / train.speed_ratio == pytest.approx(
        np.full(len(angle), angle[0] / train.speed_ratio[0]), rel=1e-13
    )
    assert np.all(modes.row_torque[:, 0] == 0.0)
    twist = train.incidence @ train.dof_ratio
    assert np.max(np.abs(twist), initial=0.0) <= 1e-14 * np.max(train.speed_ratio) * 10


# --- frequencies ----------------------------------------------------------------------------------


@pytest.mark.slow
@FEW
@given(cases(grounded=None))
def test_every_frequency_is_right_to_1e_12(case):
    modes = modes_of(build_train(case))
    assert ReferredTree(case).wrong(modes.omega, 1e-12) == []


@FEW
@given(cases(grounded=None), st.floats(0.01, 100.0))
def test_another_reference_shaft_changes_nothing(case, factor):
    """All ratios to another reference: frequencies, energies and shaft torques stay."""
    other = replace(
        case,
        stations=tuple(replace(s, speed_ratio=s.speed_ratio * factor) for s in case.stations),
    )
    a, b = modes_of(build_train(case)), modes_of(build_train(other))
    assert b.omega == pytest.approx(a.omega, rel=1e-12, abs=0.0)
    # A mode close to another may mix with it; its own energy sums still hold.
    assert b.strain_share.sum(axis=0) == pytest.approx(a.strain_share.sum(axis=0), abs=1e-10)


@FEW
@given(cases(grounded=None))
def test_referring_through_the_gears_changes_nothing(case):
    """J n², k n² on one shaft, every mesh a plain coupling or a rigid merge: the same train."""
    ratio = speed(case)
    stations = tuple(
        replace(s, inertia=s.inertia * ratio[s.station] ** 2, speed_ratio=1.0)
        for s in case.stations
    )
    elements = tuple(
        e if e.stiffness is None else replace(e, stiffness=e.stiffness * ratio[e.from_] ** 2)
        for e in case.elements
    )
    referred = replace(case, stations=stations, elements=elements)
    assert elastic(referred) == pytest.approx(elastic(case), rel=1e-12, abs=0.0)


@FEW
@given(cases(grounded=None), st.randoms(use_true_random=False))
def test_order_of_rows_is_irrelevant(case, random):
    stations, elements = list(case.stations), list(case.elements)
    random.shuffle(stations)
    random.shuffle(elements)
    shuffled = replace(case, stations=tuple(stations), elements=tuple(elements))
    assert elastic(shuffled) == pytest.approx(elastic(case), rel=1e-12, abs=0.0)


@FEW
@given(cases(grounded=None), st.integers(0, 2**32 - 1))
def test_swapping_from_and_to_is_irrelevant(case, seed):
    """A mesh's stiffness goes with its From side, so it is converted."""
    rng = np.random.default_rng(seed)
    ratio = speed(case) | {"ground": 1.0}

    def swapped(e: ElementRow) -> ElementRow:
        if rng.random() < 0.5 or e.kind == "spring to ground":
            return e
        k = e.stiffness
        if k is not None and e.kind == "gear mesh":
            k *= (ratio[e.from_] / ratio[e.to]) ** 2
        return replace(e, from_=e.to, to=e.from_, stiffness=k)

    other = replace(case, elements=tuple(swapped(e) for e in case.elements))
    assert elastic(other) == pytest.approx(elastic(case), rel=1e-12, abs=0.0)


@FEW
@given(cases(stations=(3, 30), decades=4.0, rigid=False), st.data())
def test_a_stiffer_and_stiffer_mesh_tends_to_the_rigid_one(case, data):
    meshes = [i for i, e in enumerate(case.elements) if e.kind == "gear mesh"]
    assume(meshes)
    chosen = data.draw(st.sampled_from(meshes))

    def with_stiffness(k):
        elements = list(case.elements)
        elements[chosen] = replace(elements[chosen], stiffness=k)
        return elastic(replace(case, elements=tuple(elements)))

    rigid = with_stiffness(None)
    errors = []
    for k in (1e18, 1e20, 1e22):
        found = with_stiffness(k)
        assert len(found) == len(rigid) + 1
        # Rayleigh: a constraint raises frequencies and the stiff link's lie just below.
        errors.append(np.max(np.abs(found[:-1] / rigid - 1), initial=0.0))
    assert errors[2] <= 1e-5
    assert errors[1] <= 0.05 * errors[0] + 1e-12
    assert errors[2] <= 0.05 * errors[1] + 1e-12


@FEW
@given(cases(stations=(2, 30), grounded=None), st.data())
def test_two_shafts_in_series_are_one(case, data):
    """In the limit of no inertia between them: 1/k = 1/k₁ + 1/k₂."""
    shafts = [i for i, e in enumerate(case.elements) if e.kind in ("shaft", "coupling")]
    assume(shafts)
    i = data.draw(st.sampled_from(shafts))
    share = data.draw(st.floats(0.05, 0.95))
    e = case.elements[i]
    between = StationRow("between", None, 1e-30, speed(case)[e.from_])
    halves = (
        replace(e, to="between", stiffness=e.stiffness / share),
        replace(e, element="second half", from_="between", stiffness=e.stiffness / (1 - share)),
    )
    other = replace(
        case,
        stations=(*case.stations, between),
        elements=(*case.elements[:i], *halves, *case.elements[i + 1 :]),
    )
    assert elastic(other)[:-1] == pytest.approx(elastic(case), rel=1e-12, abs=0.0)


@FEW
@given(cases(stations=(2, 30), grounded=None), st.data())
def test_two_elements_side_by_side_are_one(case, data):
    shafts = [i for i, e in enumerate(case.elements) if e.kind in ("shaft", "coupling")]
    assume(shafts)
    i = data.draw(st.sampled_from(shafts))
    share = data.draw(st.floats(0.01, 0.99))
    e = case.elements[i]
    first = replace(e, stiffness=e.stiffness * share)
    second = replace(
        e, element="beside", from_=e.to, to=e.from_, stiffness=e.stiffness * (1 - share)
    )
    other = replace(case, elements=(*case.elements[:i], first, *case.elements[i + 1 :], second))
    a, b = modes_of(build_train(case)), modes_of(build_train(other))
    assert b.omega == pytest.approx(a.omega, rel=1e-12, abs=0.0)
    energy = b.strain_share[i] + b.strain_share[-1]
    assert b.strain_share[i] == pytest.approx(share * energy, rel=1e-6, abs=1e-9)


@FEW
@given(cases(grounded=None), st.integers(0, 2**32 - 1))
def test_sense_of_meshes_changes_signs_only(case, seed):
    rng = np.random.default_rng(seed)
    meshes = tuple(
        MeshRow(e.element, str(rng.choice(["internal", "external"])))
        for e in case.elements
        if e.kind == "gear mesh"
    )
    other = build_train(replace(case, meshes=meshes))
    train = build_train(case)
    assert np.all(np.abs(other.sense) == 1.0)
    assert np.all(modes_of(other).omega == modes_of(train).omega)
    index = {s.station: i for i, s in enumerate(case.stations)}
    external = {m.element for m in meshes if m.gear_type == "external"}
    for e in case.elements:
        if "ground" not in (e.from_, e.to):
            flip = -1.0 if e.element in external else 1.0
            assert other.sense[index[e.to]] == flip * other.sense[index[e.from_]]


# --- shapes and energies --------------------------------------------------------------------------


@FEW
@given(cases(grounded=None))
def test_modal_mass_is_one_and_modes_are_orthogonal(case):
    train = build_train(case)
    modes = modes_of(train)
    scaled = np.sqrt(train.inertia)[:, None] * modes.shape
    assert scaled.T @ scaled == pytest.approx(np.eye(modes.n_modes), abs=1e-11)


@FEW
@given(cases(grounded=None))
def test_energies_sum_to_one(case):
    modes = modes_of(build_train(case))
    assert np.all(modes.strain_share >= 0.0)
    assert np.all(modes.kinetic_share >= 0.0)
    assert modes.kinetic_share.sum(axis=0) == pytest.approx(np.ones(modes.n_modes), abs=1e-12)
    assert np.all(modes.strain_share[:, : modes.n_rigid] == 0.0)
    strain = modes.strain_share[:, modes.n_rigid :].sum(axis=0)
    assert strain == pytest.approx(np.ones(len(strain)), abs=1e-12)


@FEW
@given(cases(stations=(2, 30), decades=4.0, grounded=None))
def test_torques_balance_the_inertias(case):
    """Bᵀ t = ω² M φ for every mode, element by element, and t = k B φ."""
    train = build_train(case)
    modes = modes_of(train)
    left = train.incidence.T @ modes.row_torque
    right = train.inertia[:, None] * modes.shape * modes.omega**2
    largest = np.max(np.abs(modes.row_torque), axis=0, initial=0.0)
    # Rounding of 1e-12 of the largest torque, with the ratio a gear steps it up by.
    gain = np.max(np.abs(train.incidence), initial=1.0)
    assert np.all(np.abs(left - right) <= 1e-9 * gain * largest + 1e-300)
    assert modes.row_twist * train.stiffness[:, None] == pytest.approx(modes.row_torque, rel=1e-12)


# --- damping --------------------------------------------------------------------------------------


@example_count(25)
@given(cases(stations=(2, 12), decades=3.0, dampers=True))
def test_damped_eigenvalues_decay_and_match_the_state_matrix(case):
    train = build_train(case)
    modes = modes_of(train)
    values = damped_eigenvalues(train, modes)
    scale = np.max(np.abs(values))
    assert np.all(values.real <= 1e-12 * scale)
    direct = np.linalg.eigvals(state_matrix(train))
    assert np.sum(values).real == pytest.approx(np.sum(direct).real, rel=1e-9, abs=1e-12 * scale)
    damping = modal_damping_matrix(train, modes)
    assert damping == pytest.approx(modes.shape.T @ damping_matrix(train) @ modes.shape, rel=1e-6,
                                    abs=1e-6 * float(np.max(np.abs(damping), initial=1e-300)))  # fmt: skip


# --- the driven side ------------------------------------------------------------------------------


@FEW
@given(cases(stations=(2, 40)))
def test_each_element_cuts_the_train_in_two(case):
    """`beyond` against a plain walk that does not cross the element."""
    train = build_train(case)
    names = [s.station for s in case.stations]
    for i, e in enumerate(case.elements):
        seen, stack = {e.to}, [e.to]
        while stack:
            node = stack.pop()
            for j, other in enumerate(case.elements):
                if j != i and node in (other.from_, other.to):
                    for end in (other.from_, other.to):
                        if end not in seen:
                            seen.add(end)
                            stack.append(end)
        assert [bool(b) for b in train.beyond[i]] == [name in seen for name in names]


# --- the digest -----------------------------------------------------------------------------------


def with_noise(case: Case, noise: float) -> CaseData:
    def row(r):
        numbers = {
            f: v * (1 + noise)
            for f, v in vars(r).items()
            if isinstance(v, float) and v and math.isfinite(v)
        }
        return replace(r, **numbers)

    return CaseData(
        stations=tuple(row(s) for s in case.stations),
        elements=tuple(row(e) for e in case.elements),
        line_frequency=60.0,
        poles=4,
    )


#: Numbers of at most six digits, as typed: no rounding to 12 digits sits on a boundary.
typed = st.integers(1, 999_999).map(lambda i: i * 10.0**-3)


@example_count(100)
@given(typed, typed, typed, st.floats(-1e-14, 1e-14))
def test_digest_ignores_noise_of_unit_conversion(J, k, ratio, noise):
    case = CaseData(
        stations=(StationRow("a", None, J), StationRow("b", "text", J, ratio)),
        elements=(ElementRow("e", "gear mesh", "a", "b", k),),
    )
    noisy = with_noise(case, noise)
    assert case_digest(replace(noisy, line_frequency=None, poles=None)) == case_digest(case)


@example_count(50)
@given(cases(stations=(2, 8)), st.sampled_from([1e-9, -1e-9]))
def test_digest_sees_a_change_of_1e_9(case, change):
    same = with_noise(case, 0.0)
    assert case_digest(same) == case_digest(case)
    assert case_digest(with_noise(case, change)) != case_digest(case)


def test_digest_leaves_the_title_block_out_and_the_names_in():
    case = CaseData(stations=(StationRow("a", "text", 1.0),))
    digest = case_digest(case)
    assert len(digest) == 64
    assert case_digest(replace(case, title="T", client="C", keep_history="npz")) == digest
    assert case_digest(CaseData(stations=(StationRow("a", "other", 1.0),))) == digest
    assert case_digest(CaseData(stations=(StationRow("b", "text", 1.0),))) != digest
    assert case_digest(replace(case, poles=4)) == case_digest(replace(case, poles=4.0))
    assert case_digest(replace(case, pulsation_phase=-0.0)) == case_digest(
        replace(case, pulsation_phase=0.0)
    )
    assert case_digest(replace(case, pulsation_phase=0.0)) != digest
