"""The shaft line as arrays, element by element, against hand calculation."""

import math

import numpy as np
import pytest
from state_space import state_matrix

from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, MeshRow, MotorTorqueRow, StationRow
from engine.errors import ModelError
from engine.model.build_train import build_train
from engine.model.gears import line_of_action
from engine.model.modes import modal_damping, modes_of, nodes_of
from engine.model.subdivision import natural_modes

STEEL = {"shear_modulus": 8e10}


def shaft(name, a, b, stiffness=None, **more):
    return ElementRow(name, "shaft", a, b, stiffness, **more)


def mesh(name, a, b, stiffness=None, **more):
    return ElementRow(name, "gear mesh", a, b, stiffness, **more)


def stations(*rows):
    return tuple(StationRow(name, None, J, n) for name, J, n in rows)


def motor(*names):
    return tuple(MotorTorqueRow(name, x, 1.0, 0.0) for name in names for x in (0.0, 1.0))


def case_of(rows, elements, **more):
    more = {"line_frequency": 60.0, "poles": 4} | more
    return Case(stations=stations(*rows), elements=tuple(elements), **more)


# --- shafts ---------------------------------------------------------------------------------------


def test_stiffness_from_geometry_and_a_stepped_shaft():
    """A stepped shaft is several elements; a massless step is one stiffness in series."""
    steps = [(0.10, 0.0, 0.5), (0.14, 0.04, 0.3), (0.12, 0.0, 0.4)]
    names = ["a", "b", "c", "d"]
    elements = [
        shaft(f"step {i}", names[i], names[i + 1], od=od, id=bore, length=L, **STEEL)
        for i, (od, bore, L) in enumerate(steps)
    ]
    train = build_train(
        case_of([("a", 5, 1), ("b", 1e-9, 1), ("c", 1e-9, 1), ("d", 3, 1)], elements)
    )
    k = [8e10 * math.pi * (od**4 - bore**4) / (32 * L) for od, bore, L in steps]
    assert train.stiffness == pytest.approx(k, rel=1e-15)
    series = 1 / sum(1 / x for x in k)
    assert modes_of(train).omega[1] == pytest.approx(math.sqrt(series * (1 / 5 + 1 / 3)), rel=1e-8)


def test_a_typed_stiffness_wins_over_geometry_but_the_density_still_counts():
    e = shaft("s", "a", "b", 1e6, od=0.2, id=0.1, length=2.0, density=7850.0, **STEEL)
    train = build_train(case_of([("a", 1, 1), ("b", 2, 1)], [e]))
    inertia = 7850 * math.pi / 32 * (0.2**4 - 0.1**4) * 2.0
    assert train.stiffness == pytest.approx([1e6])
    assert train.inertia == pytest.approx([1 + inertia / 2, 2 + inertia / 2])


def test_subdivision_keeps_stiffness_inertia_and_damping():
    e = shaft(
        "s", "a", "b", od=0.2, length=2.0, density=7850.0, damping=3.0, loss_factor=0.02, **STEEL
    )
    case = case_of([("a", 1, 1), ("b", 2, 1)], [e])
    one, ten = build_train(case), build_train(case, {"s": 10})
    assert (ten.n_rows, ten.n_dof, ten.n_stations) == (10, 11, 2)
    assert ten.inertia.sum() == pytest.approx(one.inertia.sum(), rel=1e-14)
    assert 1 / np.sum(1 / ten.stiffness) == pytest.approx(one.stiffness[0], rel=1e-14)
    assert 1 / np.sum(1 / ten.viscous) == pytest.approx(3.0, rel=1e-14)
    assert np.all(ten.loss_factor == 0.02)
    assert np.all(ten.row_element == 0)
    assert np.all(ten.sense == 1.0)


def test_inner_points_turn_with_the_shaft_they_divide():
    e = shaft("hs", "pinion", "rotor", od=0.1, length=1.0, density=7850.0, **STEEL)
    case = case_of(
        [("m", 1, 1), ("pinion", 0.1, 3), ("rotor", 0.5, 3)], [mesh("g", "m", "pinion"), e]
    )
    train = build_train(case, {"hs": 4})
    assert list(train.sense) == [1, -1, -1, -1, -1, -1]
    assert list(train.speed_ratio) == [1, 3, 3, 3, 3, 3]


def test_a_light_shaft_without_stiffness_is_not_subdivided():
    e = shaft("s", "a", "b", 0.0, od=0.1, length=1.0, density=7850.0, damping=1.0)
    case = case_of([("a", 1, 1), ("b", 1, 1)], [e])
    assert build_train(case, {"s": 8}).n_rows == 1
    assert natural_modes(case).modes.n_rigid == 2


# --- meshes ---------------------------------------------------------------------------------------


def test_rigid_meshes_in_series_with_an_idler_are_one_degree_of_freedom():
    case = case_of(
        [("motor", 10, 1), ("g1", 4, 1), ("idler", 2, 0.5), ("g2", 1, 2), ("load", 3, 2)],
        [
            shaft("s1", "motor", "g1", 1e5),
            mesh("m1", "g1", "idler"),
            mesh("m2", "idler", "g2"),
            shaft("s2", "g2", "load", 2e5),
        ],
    )
    train = build_train(case)
    assert train.n_dof == 3
    assert train.node_dof[1] == train.node_dof[2] == train.node_dof[3]
    merged = train.inertia[train.node_dof[1]]
    assert merged == pytest.approx(4 + 2 * 0.5**2 + 1 * 2**2, rel=1e-15)
    assert list(train.sense) == [1, 1, -1, 1, 1]  # two external meshes: as the motor again
    assert [m.element for m in train.rigid_meshes] == [1, 2]
    assert train.rigid_meshes[0].to_side == (2, 3)
    assert train.rigid_meshes[1].to_side == (3,)
    assert train.rigid_meshes[1].from_ratio == 0.5
    assert train.incidence @ train.dof_ratio == pytest.approx(np.zeros(2), abs=1e-15)


def test_one_gear_driving_two_pinions():
    case = case_of(
        [("bull", 50, 1), ("p1", 1, 5), ("p2", 2, 4)],
        [mesh("m1", "bull", "p1"), mesh("m2", "p2", "bull")],
    )
    train = build_train(case)
    assert train.n_dof == 1
    assert train.inertia[0] == pytest.approx(50 + 25 + 32)
    assert train.rigid_meshes[0].to_side == (1,)
    assert train.rigid_meshes[1].to_side == (0, 1)
    modes = modes_of(train)
    assert list(modes.omega) == [0.0]


def test_an_elastic_mesh_is_seen_from_its_from_side():
    """k (θ_from − n θ_to)²: referred to the driven side it is k n²."""
    n = 3.0
    rows = [("a", 2.0, 1.0), ("b", 0.5, n)]
    modes = modes_of(build_train(case_of(rows, [mesh("m", "a", "b", 1e6)])))
    equivalent = 0.5 * n**2
    assert modes.omega[1] == pytest.approx(math.sqrt(1e6 * (1 / 2 + 1 / equivalent)), rel=1e-14)
    reverse = modes_of(build_train(case_of(rows, [mesh("m", "b", "a", 1e6 / n**2)])))
    assert reverse.omega[1] == pytest.approx(modes.omega[1], rel=1e-14)


def test_stiffness_and_damping_along_the_line_of_action():
    """Torsional on the From side: k_n cos²β_b r_b², r_b = r cos α_t (ISO 21771)."""
    alpha, beta = math.radians(20), math.radians(25)
    row = MeshRow(
        "m",
        pitch_radius_drive=0.4,
        pitch_radius_driven=0.1,
        pressure_angle=alpha,
        helix_angle=beta,
        mesh_stiffness=3e8,
        mesh_damping=2e3,
    )
    case = case_of([("a", 2, 1), ("b", 0.5, 4)], [mesh("m", "a", "b")], meshes=(row,))
    train = build_train(case)
    alpha_t = math.atan(math.tan(alpha) / math.cos(beta))
    base_helix = math.atan(math.tan(beta) * math.cos(alpha_t))  # the other form of the same angle
    factor = (0.4 * math.cos(alpha_t) * math.cos(base_helix)) ** 2
    assert train.stiffness == pytest.approx([3e8 * factor], rel=1e-14)
    assert train.viscous == pytest.approx([2e3 * factor], rel=1e-14)
    assert train.rigid_meshes == ()


def test_spur_gears_and_the_usual_pressure_angle():
    cos_t, share = line_of_action(MeshRow("m"))
    assert cos_t == pytest.approx(math.cos(math.radians(20)), rel=1e-15)
    assert share == 1.0
    cos_t, share = line_of_action(MeshRow("m", pressure_angle=0.0, helix_angle=math.radians(30)))
    assert cos_t == pytest.approx(1.0)
    assert share == pytest.approx(math.cos(math.radians(30)) ** 2)


def test_shaft_geometry_never_makes_a_mesh_elastic():
    """Unchecked data with an OD in a mesh row stays a rigid mesh without inertia of its own."""
    e = mesh("m", "a", "b", od=0.1, length=0.1, density=7850.0, **STEEL)
    data = CaseData(stations=stations(("a", 1, 1), ("b", 1, 2)), elements=(e,))
    train = build_train(data)
    assert (train.n_dof, len(train.rigid_meshes)) == (1, 1)
    assert list(train.node_inertia) == [1.0, 1.0]


def test_internal_gears_keep_the_sense():
    case = case_of(
        [("sun", 1, 1), ("ring", 4, 0.25)],
        [mesh("m", "sun", "ring")],
        meshes=(MeshRow("m", "internal"),),
    )
    assert list(build_train(case).sense) == [1, 1]


# --- orientation, driven side ---------------------------------------------------------------------

BRANCHED_ROWS = [
    ("motor", 10, 1),
    ("bull", 5, 1),
    ("p1", 1, 3),
    ("c1", 2, 3),
    ("p2", 1, 5),
    ("c2", 2, 5),
]


def branched(motors=("motor",), reverse=()):
    elements = [
        shaft("LS", "motor", "bull", 1e5),
        mesh("m1", "bull", "p1"),
        shaft("HS1", "p1", "c1", 1e5),
        mesh("m2", "bull", "p2", 1e7),
        shaft("HS2", "p2", "c2", 1e5),
    ]
    elements = [
        ElementRow(e.element, e.kind, e.to, e.from_, e.stiffness) if e.element in reverse else e
        for e in elements
    ]
    return build_train(case_of(BRANCHED_ROWS, elements, motor_torque=motor(*motors)))


def names_beyond(train, element):
    i = train.elements.index(element)
    return {name for name, b in zip(train.stations, train.beyond[i], strict=True) if b}


@pytest.mark.parametrize("reverse", [(), ("LS", "HS2"), ("m1", "m2")])
def test_the_driven_side_does_not_depend_on_the_order_of_from_and_to(reverse):
    train = branched(reverse=reverse)
    assert names_beyond(train, "LS") == {"bull", "p1", "c1", "p2", "c2"}
    assert names_beyond(train, "m1") == {"p1", "c1"}
    assert names_beyond(train, "HS1") == {"c1"}
    assert names_beyond(train, "m2") == {"p2", "c2"}
    for name, sign in zip(train.elements, train.orientation, strict=True):
        assert sign == (-1.0 if name in reverse else 1.0)
    assert list(train.sense) == [1, 1, -1, -1, -1, -1]


def test_a_motor_in_the_middle_and_at_a_branch_end():
    middle = branched(("bull",))
    assert names_beyond(middle, "LS") == {"motor"}
    assert middle.orientation[0] == -1.0
    assert list(middle.sense) == [1, 1, -1, -1, -1, -1]


def test_two_motors():
    """Between them no side is the driven one: From stays the drive end."""
    rows = [("m1", 5, 1), ("g", 9, 1), ("m2", 5, 1), ("pump", 1, 1)]
    elements = [
        shaft("a", "m1", "g", 1e5),
        shaft("b", "m2", "g", 1e5),
        shaft("c", "pump", "g", 1e5),
    ]
    train = build_train(case_of(rows, elements, motor_torque=motor("m1", "m2")))
    assert names_beyond(train, "a") == {"g", "m2", "pump"}
    assert names_beyond(train, "b") == {"m1", "g", "pump"}
    assert names_beyond(train, "c") == {"pump"}
    assert list(train.orientation) == [1, 1, -1]


def test_without_a_motor_from_is_the_drive_end():
    train = build_train(case_of([("a", 1, 1), ("b", 1, 1)], [shaft("s", "b", "a", 1e3)]))
    assert names_beyond(train, "s") == {"a"}
    assert list(train.orientation) == [1]


# --- ground ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "end",
    [
        ElementRow("end", "spring to ground", "a", "ground", 4e4),
        ElementRow("end", "spring to ground", "ground", "a", 4e4),
        ElementRow("end", "spring to ground", "a", None, 4e4),
        ElementRow("end", "shaft", "ground", "a", 4e4),
        ElementRow("end", "coupling", "a", "ground", 4e4),
    ],
)
def test_fixed_ends_and_springs_to_ground(end):
    train = build_train(case_of([("a", 2, 1), ("b", 3, 1)], [end, shaft("s", "a", "b", 9e4)]))
    modes = modes_of(train)
    k1, k2, a, b = 4e4, 9e4, 2.0, 3.0
    K = np.array([[k1 + k2, -k2], [-k2, k2]]) / np.array([[a], [b]])
    assert modes.n_rigid == 0
    assert modes.omega == pytest.approx(np.sqrt(np.sort(np.linalg.eigvals(K))), rel=1e-13)
    assert not train.beyond[0].any()
    assert train.orientation[0] == 1.0


def test_a_spring_to_ground_is_seen_at_its_own_shaft():
    case = case_of(
        [("a", 1, 1), ("b", 0.01, 10)],
        [mesh("m", "a", "b"), ElementRow("g", "spring to ground", "b", "ground", 5.0)],
    )
    modes = modes_of(build_train(case))
    assert modes.omega == pytest.approx([math.sqrt(5 * 100 / (1 + 0.01 * 100))], rel=1e-14)


def test_a_cantilever_with_inertia_from_either_end():
    geometry = {"od": 0.03, "length": 3.0, "density": 7800.0, **STEEL}
    found = []
    for ends in (("ground", "disc"), ("disc", "ground")):
        case = case_of([("disc", 0.02, 1)], [shaft("s", *ends, **geometry)])
        found.append(modes_of(build_train(case, {"s": 32})).omega[:3])
    assert found[0] == pytest.approx(found[1], rel=1e-13)
    assert found[0][0] == pytest.approx(320.656, rel=1e-3)  # F03


def test_dampers_to_ground_are_at_the_stations_own_speed():
    rows = (StationRow("a", None, 1.0, 1.0, 2.0), StationRow("b", None, 1.0, 3.0, 5.0))
    train = build_train(Case(stations=rows, elements=(mesh("m", "a", "b"),)))
    assert train.ground_damping == pytest.approx([2 + 5 * 9])


# --- damping --------------------------------------------------------------------------------------


def test_spring_and_damper_side_by_side():
    """Together the same as one element with both."""
    rows = [("a", 2, 1), ("b", 3, 1)]
    apart = case_of(
        rows,
        [
            shaft("spring", "a", "b", 1e4),
            ElementRow("damper", "coupling", "b", "a", 0.0, damping=7.0),
        ],
    )
    together = case_of(rows, [shaft("both", "a", "b", 1e4, damping=7.0)])
    one, two = build_train(together), build_train(apart)
    assert state_matrix(two) == pytest.approx(state_matrix(one), rel=1e-15)
    modes = modes_of(two)
    assert modes.strain_share[:, 1] == pytest.approx([1.0, 0.0])
    ratio = 7.0 / 2 * modes.omega[1] / 1e4  # c ω / 2k
    assert modal_damping(apart, two, modes).ratio[1] == pytest.approx(ratio, rel=1e-13)


def test_a_damper_alone_leaves_two_rigid_modes():
    case = case_of([("a", 2, 1), ("b", 3, 2)], [mesh("d", "a", "b", 0.0, damping=6.0)])
    train = build_train(case)
    modes = modes_of(train)
    assert (modes.n_rigid, list(modes.omega)) == (2, [0.0, 0.0])
    damping = modal_damping(case, train, modes)
    assert np.all(damping.ratio == 0.0)
    assert damping.rate.sum() == pytest.approx(6.0 * (1 / 2 + 1 / (3 * 4)), rel=1e-13)
    assert damping.neglected > 0.0
    assert nodes_of(train, modes) == ()


def test_a_shaft_in_pieces_beside_rigid_meshes_has_all_strain():
    """As many rows as elements, though two of them belong to one element and a mesh has none."""
    case = case_of(
        [("a", 2, 1), ("b", 1, 1), ("c", 3, 2)],
        [shaft("s", "a", "b", od=0.03, length=3.0, density=7800.0, **STEEL), mesh("m", "b", "c")],
    )
    train = build_train(case, {"s": 2})
    assert train.n_rows == len(train.elements)
    modes = modes_of(train)
    assert modes.strain_share[:, modes.n_rigid :] == pytest.approx(np.array([[1, 1], [0, 0]]))


def test_the_parts_of_modal_damping_add_up():
    """Stated + ½ Σ η × strain share + ½ φᵀCφ/ω (contract)."""
    case = case_of(
        [("a", 2, 1), ("b", 1, 1), ("c", 3, 1)],
        [
            shaft("s1", "a", "b", 1e4, loss_factor=0.1),
            shaft("s2", "b", "c", 4e4, damping=2.0),
        ],
        damping_ratio=0.01,
    )
    train = build_train(case)
    modes = modes_of(train)
    damping = modal_damping(case, train, modes)
    for i in (1, 2):
        viscous = 0.5 * 2.0 * (modes.shape[1, i] - modes.shape[2, i]) ** 2 / modes.omega[i]
        hysteretic = 0.5 * 0.1 * modes.strain_share[0, i]
        assert damping.structural[i] == pytest.approx(0.01 + hysteretic, rel=1e-12)
        assert damping.ratio[i] == pytest.approx(0.01 + hysteretic + viscous, rel=1e-12)
        assert damping.rate[i] == pytest.approx(2 * damping.ratio[i] * modes.omega[i], rel=1e-12)
    assert (damping.ratio[0], damping.structural[0]) == (0.0, 0.0)


def test_proportional_damping_neglects_nothing():
    case = case_of(
        [("a", 2, 1), ("b", 1, 1), ("c", 3, 1)],
        [shaft("s1", "a", "b", 1e4, damping=1.0), shaft("s2", "b", "c", 4e4, damping=4.0)],
    )
    train = build_train(case)
    damping = modal_damping(case, train, modes_of(train))
    assert damping.neglected <= 1e-12 * damping.rate.max()
    assert damping.coupling == 0.0


# --- nodes ----------------------------------------------------------------------------------------


def test_meshes_have_no_nodes_inside():
    """Teeth of a 1:1 gear may move against each other, but there is no shaft between them."""
    rows = [("a", 1, 1), ("b", 1, 1)]
    train = build_train(case_of(rows, [mesh("m", "a", "b", 1e5)]))
    assert nodes_of(train, modes_of(train)) == ()
    train = build_train(case_of(rows, [shaft("s", "a", "b", 1e5)]))
    (node,) = nodes_of(train, modes_of(train))
    assert (node.mode, node.element, node.position) == (1, "s", pytest.approx(0.5))


# --- what cannot be ---------------------------------------------------------------------------


def test_an_element_without_stiffness_is_named():
    data = CaseData(
        stations=stations(("a", 1, 1), ("b", 1, 1)), elements=(shaft("weak", "a", "b"),)
    )
    with pytest.raises(ModelError, match="'weak' has neither a stiffness nor the geometry"):
        build_train(data)


def test_a_station_without_inertia_is_named():
    data = CaseData(
        stations=stations(("a", 1, 1), ("empty", None, 1)),
        elements=(shaft("s", "a", "empty", 1e5),),
    )
    with pytest.raises(ModelError, match="Station 'empty' has no inertia"):
        build_train(data)


def test_a_single_station():
    train = build_train(case_of([("flywheel", 7, 1)], []))
    modes = modes_of(train)
    assert (train.n_dof, train.n_rows, modes.n_rigid) == (1, 0, 1)
    assert modes.shape == pytest.approx(np.array([[1 / math.sqrt(7)]]))
    assert modes.kinetic_share == pytest.approx(np.array([[1.0]]))


def test_hundreds_of_stations_build_quickly():
    n = 200
    rows = [(f"s{i}", 1.0 + i % 3, 1) for i in range(n)]
    elements = [shaft(f"e{i}", f"s{i}", f"s{i + 1}", 1e5) for i in range(n - 1)]
    train = build_train(case_of(rows, elements, motor_torque=motor("s0")))
    assert [int(b.sum()) for b in train.beyond] == list(range(n - 1, 0, -1))
