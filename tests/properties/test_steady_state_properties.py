"""What must hold of the harmonic response of every train."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from strategies import cases, example_count

from engine.case.case import Case
from engine.case.data import GROUND
from engine.model.build_train import build_train
from engine.model.excitation import transmitted_torque
from engine.model.modes import modes_of, stated_damping
from engine.operation.steady_state import harmonic_response

#: Frequencies of a running train, not near anything in particular. [rad/s]
OMEGA = np.array([3.1, 31.7, 188.5, 377.3, 1055.6, 6283.1])

DAMPED = st.sampled_from([None, 0.005, 0.05])
EVERYTHING = st.builds(
    lambda **kw: kw,
    grounded=st.booleans(),
    damping_ratio=DAMPED,
    dampers=st.booleans(),
    loss_factors=st.booleans(),
).flatmap(lambda kw: cases(**kw))


def loaded(case, seed):
    """Complex torques at a few stations, at their own speed."""
    rng = np.random.default_rng(seed)
    n = len(case.stations)
    torque = np.zeros(n, dtype=complex)
    for i in rng.integers(n, size=3):
        torque[i] += rng.uniform(1.0, 10.0) * np.exp(2j * np.pi * rng.random())
    return torque


def respond(case, torque, omega=OMEGA):
    train = build_train(case)
    modes = modes_of(train)
    return train, harmonic_response(
        train, modes, omega, torque, damping_ratio=stated_damping(case, modes)
    )


def largest(values):
    return np.max(np.abs(values), axis=0, initial=0.0)


def assert_same(values, expected, relative, floor=0.0):
    """Equal to a share of the largest at the same frequency (not of each: some nearly vanish)."""
    scale = np.maximum(largest(expected), floor)
    assert np.all(np.abs(values - expected) <= relative * scale)


@given(
    case=st.booleans().flatmap(lambda g: cases(grounded=g, damping_ratio=0.02)),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_modal_sum_equals_the_direct_solution(case, seed):
    """With stated damping only, which leaves the modes uncoupled: the textbook superposition."""
    train = build_train(case)
    modes = modes_of(train)
    torque = loaded(case, seed)
    zeta = stated_damping(case, modes)
    response = harmonic_response(train, modes, OMEGA, torque, damping_ratio=zeta)
    shape = modes.shape[train.node_dof[: train.n_stations]]
    shape = shape * train.node_scale[: train.n_stations, None]
    w = modes.omega[:, None]
    modal = (shape.T @ torque)[:, None] / (w**2 - OMEGA**2 + 2j * zeta[:, None] * w * OMEGA)
    assert_same(response.station_angle, shape @ modal, 1e-8)
    rows = modes.row_torque @ modal
    elements = np.zeros_like(response.element_torque)
    elements[train.row_element] = rows
    elements *= train.orientation[:, None]
    elastic = np.unique(train.row_element)
    assert_same(
        response.element_torque[elastic], elements[elastic], 1e-8, floor=np.max(np.abs(torque))
    )


@given(case=EVERYTHING, seed=st.integers(0, 2**32 - 1))
def test_referring_through_the_gears_changes_nothing_physical(case, seed):
    """The same train with every inertia, stiffness, damping and torque at the reference speed."""
    torque = loaded(case, seed)
    train, response = respond(case, torque)
    ratio = {s.station: s.speed_ratio for s in case.stations}
    stations = tuple(
        replace(
            s,
            inertia=s.inertia * s.speed_ratio**2,
            damping=None if s.damping is None else s.damping * s.speed_ratio**2,
            speed_ratio=1.0,
        )
        for s in case.stations
    )

    def referred(e):
        n2 = ratio[e.from_] ** 2
        return replace(
            e,
            stiffness=None if e.stiffness is None else e.stiffness * n2,
            damping=None if e.damping is None else e.damping * n2,
        )

    other = replace(case, stations=stations, elements=tuple(map(referred, case.elements)))
    n = np.array([s.speed_ratio for s in case.stations])
    m = np.array([ratio[e.from_] for e in case.elements])
    _, at_reference = respond(other, torque * n)
    assert_same(response.station_angle / n[:, None], at_reference.station_angle, 1e-8)
    assert_same(response.element_torque * m[:, None], at_reference.element_torque, 1e-8)


@given(case=EVERYTHING, seed=st.integers(0, 2**32 - 1))
def test_the_order_of_rows_is_irrelevant(case, seed):
    torque = loaded(case, seed)
    _, response = respond(case, torque)
    rng = np.random.default_rng(seed)
    s, e = rng.permutation(len(case.stations)), rng.permutation(len(case.elements))
    shuffled = replace(
        case,
        stations=tuple(case.stations[i] for i in s),
        elements=tuple(case.elements[i] for i in e),
    )
    _, other = respond(shuffled, torque[s])
    assert_same(other.station_angle, response.station_angle[s], 1e-8)
    assert_same(other.element_torque, response.element_torque[e], 1e-8)


@given(
    case=cases(stations=(3, 60), decades=6, rigid=True, damping_ratio=None, loss_factors=True),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_stiffer_and_stiffer_mesh_tends_to_the_rigid_merge(case, seed):
    """Rigid meshes given 1e4, 1e6 … times the stiffest element; the mesh torques included."""
    torque = loaded(case, seed)
    _, rigid = respond(case, torque)
    ratio = {s.station: s.speed_ratio for s in case.stations}
    # stiff against both the springs and the inertias at the highest frequency
    stiff = max(
        *(e.stiffness * ratio[e.from_] ** 2 for e in case.elements if e.stiffness is not None),
        *(s.inertia * s.speed_ratio**2 * OMEGA[-1] ** 2 for s in case.stations),
    )
    off = []
    for factor in (1e4, 1e6, 1e8):
        elements = tuple(
            replace(e, stiffness=factor * stiff / ratio[e.from_] ** 2) if e.stiffness is None else e
            for e in case.elements
        )
        _, elastic = respond(replace(case, elements=elements), torque)
        scale = largest(rigid.element_torque) + np.max(np.abs(torque))
        off.append(np.max(np.abs(elastic.element_torque - rigid.element_torque) / scale, axis=0))
    # as 1/k; the sharper the resonance nearby, the later
    near = off[0] < 1e-2
    assert np.all(off[1][near] <= 0.02 * off[0][near] + 1e-9)
    assert np.all(off[2][near] <= 0.02 * off[1][near] + 1e-9)


@given(
    case=st.booleans().flatmap(lambda g: cases(grounded=g, dampers=True, loss_factors=True)),
    seed=st.integers(0, 2**32 - 1),
)
def test_every_element_carries_what_the_stations_beyond_it_need(case, seed):
    """Equilibrium of one side of each element, inertia and dampers to ground included."""
    torque = loaded(case, seed)
    train, response = respond(case, torque)
    n = train.n_stations
    J = train.node_inertia[:n, None]
    c = train.node_damping[:n, None]
    motion = (-(OMEGA**2) * J + 1j * OMEGA * c) * response.station_angle
    need = motion - torque[:, None]
    for i, e in enumerate(case.elements):
        if e.to == GROUND:  # its spring takes a part of what its station needs
            need[train.stations.index(e.from_)] += response.element_torque[i]
    need *= train.speed_ratio[:n, None]  # power: at the reference speed
    size = np.abs(motion) + np.abs(torque)[:, None]
    scale = np.sum(size * train.speed_ratio[:n, None], axis=0)
    assert np.all(np.abs(need.sum(axis=0)) <= 1e-8 * scale)
    for i, e in enumerate(case.elements):
        if e.to != GROUND:
            carried = response.element_torque[i] * train.speed_ratio[train.stations.index(e.from_)]
            beyond = need[train.beyond[i]].sum(axis=0)
            assert np.all(np.abs(carried - beyond) <= 1e-8 * scale)


@given(case=EVERYTHING, seed=st.integers(0, 2**32 - 1))
@example_count(50)
def test_the_answer_at_one_place_equals_the_torque_at_the_other(case, seed):
    """Reciprocity: θ_b for a torque at a is θ_a for the same torque at b."""
    rng = np.random.default_rng(seed)
    a, b = rng.integers(len(case.stations), size=2)
    unit = np.eye(len(case.stations))
    _, from_a = respond(case, unit[a])
    _, from_b = respond(case, unit[b])
    scale = np.sqrt(np.abs(from_a.station_angle[a] * from_b.station_angle[b]))
    assert np.all(np.abs(from_a.station_angle[b] - from_b.station_angle[a]) <= 1e-8 * scale)


@given(case=cases(), seed=st.integers(0, 2**32 - 1))
def test_the_transmitted_torque_is_the_sum_of_the_loads_beyond(case, seed):
    """One motor at the first station: walk the tree outwards and add up."""
    rng = np.random.default_rng(seed)
    load = rng.uniform(0.0, 100.0, len(case.stations))
    stations = tuple(
        replace(s, running_load=float(x)) for s, x in zip(case.stations, load, strict=True)
    )
    case: Case = replace(case, stations=stations)
    train = build_train(case)
    referred = dict(zip(train.stations, load * train.speed_ratio, strict=True))
    ratio = {s.station: s.speed_ratio for s in case.stations}
    told = np.abs(transmitted_torque(case, train).element)
    for e, torque in zip(case.elements, told, strict=True):
        near, far = sorted((e.from_, e.to), key=lambda name: int(name[1:]))
        side, grown = {far}, True
        while grown:
            more = {
                x
                for other in case.elements
                if other is not e and {other.from_, other.to} & side
                for x in (other.from_, other.to)
            }
            grown = not more <= side
            side |= more
        assert near not in side
        total = sum(referred[name] for name in side)
        assert (
            abs(torque - total / ratio[e.from_]) <= 1e-9 * sum(referred.values()) / ratio[e.from_]
        )
