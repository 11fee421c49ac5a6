"""Gears on flexible bearings: rows, frequencies and responses against geometry and dense algebra."""

import math
from dataclasses import fields, replace

import mpmath
import numpy as np
import pytest
from scipy.linalg import eigh

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, ElementRow, MeshRow, MotorTorqueRow, StationRow
from engine.errors import ModelError
from engine.model.build_train import build_train
from engine.model.excitation import excitations_of, transmitted_torque
from engine.model.modal_train import ModalTrain
from engine.model.modes import damped_eigenvalues, modal_damping, modes_of, nodes_of
from engine.model.subdivision import natural_modes
from engine.operation.margins import separation_margins
from engine.operation.steady_state import harmonic_response, steady_state
from engine.results.details import modal_details
from engine.results.tables import result_tables
from engine.run import run
from engine.start.time_response import linear, time_response
from engine.start.torque_outputs import torque_outputs

DEG = math.pi / 180.0
RATIO = 2.5  # of the wheel's speed to the pinion's inverse: the pinion is the slower, larger "P"
MASS = {"P": 300.0, "W": 90.0}
BEARING = {"P": 8e8, "W": 3e8}
DAMPER = {"P": 4e4, "W": 9e3}


def motor(name):
    return tuple(MotorTorqueRow(name, x, 1e4, 0.0) for x in (0.0, 1.0))


def pair(  # noqa: PLR0913 - one argument a feature of the mesh
    *,
    orientation=0.0,
    pressure=20 * DEG,
    helix=0.0,
    internal=False,
    swapped=False,
    pinion_drives=False,
    reverse=False,
    bodies=("P", "W"),
    bearing=1.0,
    damped=False,
    **more,
):
    """Motor, reverser (a rigid mesh 1 : 1), gear P, gear W 2.5 times as fast, load.

    `reverse` turns the sense of rotation of everything beyond the reverser. `pinion_drives` lets
    W be 2.5 times as slow instead.
    """
    ratio = 1.0 / RATIO if pinion_drives else RATIO
    radius = 0.2 if pinion_drives else 0.45
    ends = ("W", "P") if swapped else ("P", "W")
    radii = (radius, radius / ratio)
    sides = {
        f"{key}_{side}": values[name]
        for side, name in zip(("drive", "driven"), ends, strict=True)
        if name in bodies
        for key, values in (
            ("mass", MASS),
            ("bearing_stiffness", {k: bearing * v for k, v in BEARING.items()}),
            *([("bearing_damping", DAMPER)] if damped else []),
        )
    }
    mesh = MeshRow(
        "mesh",
        "internal" if internal else "external",
        *(radii[::-1] if swapped else radii),
        pressure_angle=pressure,
        helix_angle=helix,
        orientation=orientation + (math.pi if swapped else 0.0),
        mesh_stiffness=6e8,
        mesh_damping=2e4 if damped else None,
        **sides,
    )
    given = {
        "line_frequency": 60.0,
        "poles": 4,
        "stations": (
            StationRow("motor", None, 60.0),
            StationRow("R", None, 3.0),
            StationRow("P", None, 12.0),
            StationRow("W", None, 1.5, ratio, running_load=500.0),
            StationRow("load", None, 9.0, ratio, running_load=3000.0),
        ),
        "elements": (
            ElementRow("reverser", "gear mesh", "motor", "R"),
            ElementRow("LS", "shaft", "R", "P", 4e6),
            ElementRow("mesh", "gear mesh", *ends),
            ElementRow("HS", "shaft", "W", "load", 7e5),
        ),
        "meshes": (MeshRow("reverser", "external" if reverse else "internal"), mesh),
        "motor_torque": motor("motor"),
    }
    return CaseData(**(given | more))


def rotated(angle, vector):
    """A vector turned by a finite angle."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]]) @ vector


class Dense:
    """The paper's Figure 4c written out: forces on two bodies, their K, C and M, all by hand.

    Coordinates: θ of motor (with the reverser), P, W, load, then x, y of P and of W. P drives.
    """

    def __init__(self, case, *, orientation, pressure, helix, internal=False, sense=1.0):
        m = next(m for m in case.meshes if m.element == "mesh")
        inertia = {s.station: s.inertia for s in case.stations}
        alpha = math.atan2(math.sin(pressure), math.cos(pressure) * math.cos(helix))
        base_helix = math.atan(math.tan(helix) * math.cos(alpha))
        swapped = case.elements[2].from_ == "W"
        radii = (m.pitch_radius_drive, m.pitch_radius_driven)
        self.rp, self.rw = (math.cos(alpha) * r for r in (radii[::-1] if swapped else radii))
        self.k = m.mesh_stiffness * math.cos(base_helix) ** 2
        self.c = (m.mesh_damping or 0.0) * math.cos(base_helix) ** 2
        # From the line of centres P → W the force on W is turned towards the pitch point's motion.
        centres = np.array([math.cos(orientation), math.sin(orientation)])
        quarter = 0.5 * math.pi
        if not internal:
            turn = sense * (quarter - alpha)
        elif self.rp > self.rw:  # the ring drives
            turn = sense * (quarter + alpha)
        else:  # the pinion drives: the pitch point is behind P as seen from W
            turn = -sense * (quarter + alpha)
        self.n = rotated(turn, centres)
        self.mass = np.diag(
            [inertia["motor"] + inertia["R"], inertia["P"], inertia["W"], inertia["load"]]
            + [MASS["P"]] * 2 + [MASS["W"]] * 2
        )  # fmt: skip
        sides = ("driven", "drive") if swapped else ("drive", "driven")
        self.bearing = [getattr(m, f"bearing_stiffness_{s}") for s in sides]
        self.damper = [getattr(m, f"bearing_damping_{s}") or 0.0 for s in sides]
        self.shafts = {e.element: e.stiffness for e in case.elements}
        self.K = np.array([-self.force(q, self.k, self.bearing, self.shafts) for q in np.eye(8)]).T
        no_shafts = dict.fromkeys(self.shafts, 0.0)
        self.C = np.array([-self.force(q, self.c, self.damper, no_shafts) for q in np.eye(8)]).T

    def force(self, q, mesh, bearing, shafts):
        """Torques and forces on the bodies for a displacement (or a velocity)."""
        motor, p, w, load, up, uw = *q[:4], q[4:6], q[6:8]
        tooth = mesh * (self.rp * p - self.rw * w + self.n @ (up - uw))  # compression
        low, high = shafts["LS"] * (motor - p), shafts["HS"] * (w - load)
        return np.concatenate(
            [
                [-low, low - tooth * self.rp, tooth * self.rw - high, high],
                -tooth * self.n - bearing[0] * up,
                tooth * self.n - bearing[1] * uw,
            ]
        )

    def frequencies(self):
        """Elastic ones, rising. [rad/s]"""
        return np.sqrt(eigh(self.K, self.mass, eigvals_only=True)[1:])


GEOMETRY = [
    {"orientation": 0.0, "pressure": 20 * DEG, "helix": 0.0},
    {"orientation": 37 * DEG, "pressure": 25 * DEG, "helix": 15 * DEG},
    {"orientation": -120 * DEG, "pressure": 14.5 * DEG, "helix": -30 * DEG},
    {"orientation": 90 * DEG, "pressure": 0.0, "helix": 10 * DEG},
    {"orientation": 200 * DEG, "pressure": 20 * DEG, "helix": 8 * DEG, "internal": True},
]


def elastic(case, **options):
    modes = natural_modes(case, **options).modes
    return modes.omega[modes.n_rigid :]


# --- against the equations written out ------------------------------------------------------------


@pytest.mark.parametrize("geometry", GEOMETRY)
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("pinion_drives", [False, True])
def test_frequencies_are_those_of_the_forces_written_out(geometry, swapped, reverse, pinion_drives):
    case = pair(swapped=swapped, reverse=reverse, pinion_drives=pinion_drives, **geometry)
    assert find_problems(case) == ()
    dense = Dense(case, sense=-1.0 if reverse else 1.0, **geometry)
    found = natural_modes(case)
    assert found.modes.n_rigid == 1
    assert elastic(case) == pytest.approx(dense.frequencies(), rel=1e-9)
    angle = found.train.node_matrix() @ found.modes.shape
    moved = np.zeros((8, found.modes.n_modes))
    moved[:4] = angle[[0, 2, 3, 4]]
    for row, body in zip((4, 6), found.train.bodies, strict=True):
        for mode in range(found.modes.n_modes):
            u = angle[[body.node_x, body.node_y], mode]
            moved[row : row + 2, mode] = rotated(body.axis_angle, u)
    # Not the frequencies alone: K φ = ω² M φ with the shapes in the physical axes.
    residual = dense.K @ moved - dense.mass @ moved * found.modes.omega**2
    assert np.max(np.abs(residual)) <= 1e-9 * np.max(np.abs(dense.K)) * np.max(np.abs(moved))


@pytest.mark.parametrize("geometry", GEOMETRY)
def test_damped_eigenvalues_include_mesh_and_bearing_damping(geometry):
    case = pair(damped=True, **geometry)
    dense = Dense(case, **geometry)
    found = natural_modes(case)
    values = damped_eigenvalues(found.train, found.modes)
    inverse = np.linalg.inv(dense.mass)
    state = np.block([[np.zeros((8, 8)), np.eye(8)], [-inverse @ dense.K, -inverse @ dense.C]])
    direct = np.linalg.eigvals(state)
    for value in direct[np.abs(direct) > 1.0]:
        assert np.min(np.abs(values - value)) <= 1e-9 * abs(value)
    damping = modal_damping(case, found.train, found.modes)
    assert np.all(damping.ratio[1:] > 0.0)


def test_stated_damping_acts_on_every_elastic_mode_and_bearing_damping_adds():
    case = pair(damping_ratio=0.02)
    found = natural_modes(case)
    assert modal_damping(case, found.train, found.modes).ratio == pytest.approx(
        [0.0] + [0.02] * (found.modes.n_modes - 1)
    )
    damped = replace(pair(damped=True), damping_ratio=0.02)
    # Across the line of action a single gear is a plain oscillator: c / 2√(k m).
    more = modal_damping(damped, natural_modes(damped).train, found.modes)
    for name in MASS:
        omega = math.sqrt(BEARING[name] / MASS[name])
        mode = int(np.argmin(np.abs(found.modes.omega - omega)))
        own = DAMPER[name] / (2.0 * math.sqrt(BEARING[name] * MASS[name]))
        assert more.ratio[mode] == pytest.approx(0.02 + own, rel=1e-12)


@pytest.mark.parametrize("geometry", GEOMETRY)
def test_harmonic_response_is_that_of_the_dense_equations(geometry):
    case = pair(damped=True, **geometry)
    dense = Dense(case, **geometry)
    found = natural_modes(case)
    torque = np.array([100.0, 0.0, 20.0, 0.0, -30.0])
    omega = np.array([50.0, 300.0, *found.modes.omega[1:]])
    response = harmonic_response(found.train, found.modes, omega, torque)
    applied = np.array([100.0, 20.0, 0.0, -30.0, 0, 0, 0, 0])
    for i, w in enumerate(omega):
        q = np.linalg.solve(dense.K + 1j * w * dense.C - w**2 * dense.mass, applied)
        assert response.station_angle[[0, 2, 3, 4], i] == pytest.approx(q[:4], rel=1e-10)
        force = -dense.force(q, dense.k + 1j * w * dense.c, [0, 0], dict.fromkeys(dense.shafts, 0))
        assert response.element_torque[2, i] == pytest.approx(force[1], rel=1e-10)
        low = dense.shafts["LS"] * (q[0] - q[1])
        assert response.element_torque[1, i] == pytest.approx(low, rel=1e-10)
        reverser = 100.0 + 60.0 * w**2 * q[0]  # what is left of the torque behind the motor
        assert response.element_torque[0, i] == pytest.approx(reverser, rel=1e-10)


# --- the flanks as geometry: involutes of two base circles ----------------------------------------


def clearance(q, *, radii, centres, sense, internal):
    """Distance of two flanks along their line of action, exact for any position; mpmath.

    A flank is an involute: seen from where the line of action touches its base circle, it lies a
    length of string r_b (θ − ψ) away, θ its own rotation and ψ the angle of the touching point.
    `q` = θ of driver and driven in running direction, then both displacements; `sense` = −1 with
    negative θ gives the back flank. Up to a constant.
    """
    ra, rb = radii
    one = centres[0][0] + q[2], centres[0][1] + q[3]
    two = centres[1][0] + q[4], centres[1][1] + q[5]
    apart, turn = (two[0] - one[0], two[1] - one[1]), mpmath.mpf(sense)
    distance = mpmath.hypot(*apart)
    line = mpmath.atan2(apart[1], apart[0])
    if not internal:
        alpha = mpmath.acos((ra + rb) / distance)
        string = mpmath.sqrt(distance**2 - (ra + rb) ** 2)
        psi = line - turn * alpha  # of the driver; of the driven half a turn more
        return string - ra * (q[0] - turn * psi) - rb * (-q[1] - turn * psi)
    alpha = mpmath.acos(abs(ra - rb) / distance)
    string = mpmath.sqrt(distance**2 - (ra - rb) ** 2)
    outwards = line if ra > rb else line + mpmath.pi  # from the ring's centre to the pinion's
    side = turn if ra > rb else -turn
    psi = outwards + side * alpha
    return rb * (q[1] - turn * psi) - ra * (q[0] - turn * psi) - string


def _in_physical_axes(train, row, gears):
    """Entries of a flank's row: rotations and displacements of both gears."""
    out = [row[train.stations.index(name)] for name in gears]
    for name in gears:
        body = next(b for b in train.bodies if b.station == train.stations.index(name))
        out += list(rotated(body.axis_angle, row[[body.node_x, body.node_y]]))
    return np.array(out)


@pytest.mark.parametrize("geometry", GEOMETRY)
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("pinion_drives", [False, True])
def test_both_flanks_are_the_gradient_of_the_distance_of_two_involutes(
    geometry, swapped, reverse, pinion_drives
):
    """By virtual work the gradient is also the force: both rows, every coordinate."""
    if geometry["pressure"] == 0.0:
        geometry = geometry | {"pressure": 1 * DEG}  # base circles must not touch
    case = pair(swapped=swapped, reverse=reverse, pinion_drives=pinion_drives, **geometry)
    train = build_train(case)
    (flank,) = train.flanks
    mesh = case.meshes[1]
    internal = geometry.get("internal", False)
    alpha = math.atan(math.tan(geometry["pressure"]) / math.cos(geometry["helix"]))
    pitch = (mesh.pitch_radius_drive, mesh.pitch_radius_driven)[:: -1 if swapped else 1]
    base = [mpmath.mpf(r * math.cos(alpha)) for r in pitch]
    distance = abs(pitch[0] - pitch[1]) if internal else sum(pitch)
    angle = geometry["orientation"]
    centres = ((0, 0), (distance * math.cos(angle), distance * math.sin(angle)))
    sense = -1.0 if reverse else 1.0
    fixed = {"radii": base, "centres": centres, "internal": internal}

    def drive(*q):
        return -clearance(q, sense=sense, **fixed)

    def back(*q):
        return -clearance((-q[0], -q[1], *q[2:]), sense=-sense, **fixed)

    with mpmath.workdps(40):
        for row, compression in ((flank.drive, drive), (flank.back, back)):
            gradient = [
                mpmath.diff(compression, (0,) * 6, tuple(int(i == j) for j in range(6)))
                for i in range(6)
            ]
            expected = np.array([float(g) for g in gradient]) / flank.base_radius
            assert _in_physical_axes(train, row, ("P", "W")) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("geometry", GEOMETRY)
@pytest.mark.parametrize("pinion_drives", [False, True])
def test_action_is_reaction(geometry, pinion_drives):
    """Forces on the two gears, and their moments about one point, add up to nothing."""
    case = pair(pinion_drives=pinion_drives, **geometry)
    train = build_train(case)
    (flank,) = train.flanks
    internal = geometry.get("internal", False)
    pitch = case.meshes[1].pitch_radius_drive, case.meshes[1].pitch_radius_driven
    distance = abs(pitch[0] - pitch[1]) if internal else sum(pitch)
    centre = distance * rotated(geometry["orientation"], np.array([1.0, 0.0]))
    for row in (flank.drive, flank.back):
        p, w, *push = -_in_physical_axes(train, row, ("P", "W"))  # force of a unit tooth torque
        on_p, on_w = np.array(push[:2]), np.array(push[2:])
        assert on_p + on_w == pytest.approx([0.0, 0.0], abs=1e-12)
        assert np.hypot(*on_w) == pytest.approx(1.0 / flank.base_radius, rel=1e-12)
        moment = train.sense[2] * p + train.sense[3] * w + centre[0] * on_w[1] - centre[1] * on_w[0]
        assert moment == pytest.approx(0.0, abs=1e-12)
        away = 1.0 if not internal else -1.0  # external flanks part the gears
        assert math.copysign(1.0, on_w @ centre) == away or geometry["pressure"] == 0.0


# --- what must not depend on names and axes ---------------------------------------------------------


@pytest.mark.parametrize("degrees", [1.0, 30.0, 90.0, 179.0, 301.0])
def test_turning_a_single_mesh_changes_nothing(degrees):
    upright = elastic(pair(helix=0.2))
    assert elastic(pair(helix=0.2, orientation=degrees * DEG)) == pytest.approx(upright, rel=1e-12)
    assert elastic(pair(helix=0.2, reverse=True)) == pytest.approx(upright, rel=1e-12)


def idler(first, second, *, reverse=False):
    """Gear A drives an idler, which drives C; only the idler has bearings."""
    return CaseData(
        line_frequency=60.0,
        poles=4,
        stations=(
            StationRow("motor", None, 40.0),
            StationRow("A", None, 6.0),
            StationRow("idler", None, 2.0, 1.25),
            StationRow("C", None, 4.0, 0.8),
        ),
        elements=(
            ElementRow("reverser", "gear mesh", "motor", "A"),
            ElementRow("m1", "gear mesh", "A", "idler", 3e7),
            ElementRow("m2", "gear mesh", "idler", "C", 2e7),
        ),
        meshes=(
            MeshRow("reverser", "external" if reverse else "internal"),
            MeshRow("m1", None, 0.30, 0.24, orientation=first, mass_driven=70.0),
            MeshRow("m2", None, 0.24, 0.375, orientation=second, bearing_stiffness_drive=5e8),
        ),
        motor_torque=motor("motor"),
    )


def test_of_an_idler_only_the_angle_between_its_lines_of_centres_matters():
    case = idler(0.3, 1.0)
    assert find_problems(case) == ()
    assert len(build_train(case).bodies) == 1
    straight = elastic(case)
    assert elastic(idler(0.3 + 2.0, 1.0 + 2.0)) == pytest.approx(straight, rel=1e-12)
    mirrored = elastic(idler(-0.3, -1.0, reverse=True))
    assert mirrored == pytest.approx(straight, rel=1e-12)
    assert np.max(np.abs(elastic(idler(0.3, 2.0)) / straight - 1.0)) > 1e-3
    # Turning the other way round is another train here: the tooth forces add up differently.
    assert np.max(np.abs(elastic(idler(0.3, 1.0, reverse=True)) / straight - 1.0)) > 1e-3


def test_two_pinions_facing_each_other_leave_the_direction_across_exactly_free():
    """A bull gear with pinions at 0 and 180 degrees: both lines of action are parallel."""
    case = CaseData(
        stations=(
            StationRow("bull", None, 100.0),
            StationRow("p1", None, 1.0, 4.0),
            StationRow("p2", None, 1.5, 4.0),
        ),
        elements=(
            ElementRow("m1", "gear mesh", "bull", "p1", 1e8),
            ElementRow("m2", "gear mesh", "bull", "p2", 2e8),
        ),
        meshes=(
            MeshRow("m1", None, 0.8, 0.2, orientation=0.4, mass_drive=900.0),
            MeshRow("m2", None, 0.8, 0.2, orientation=0.4 + math.pi, bearing_stiffness_drive=7e8),
        ),
    )
    modes = natural_modes(case).modes
    free = int(np.argmin(np.abs(modes.omega - math.sqrt(7e8 / 900.0))))
    assert modes.omega[free] == pytest.approx(math.sqrt(7e8 / 900.0), rel=1e-14)
    assert np.count_nonzero(modes.shape[:, free]) == 1
    assert modes.bearing_share[0, free] == pytest.approx(1.0, rel=1e-14)


def test_one_gear_alone_may_have_bearings():
    for name in ("P", "W"):
        case = pair(bodies=(name,), orientation=0.7)
        train = build_train(case)
        (body,) = train.bodies
        assert train.stations[body.station] == name
        # P fast: the compliance of one bearing along the line of action is in series.
        omega = elastic(case)
        assert len(omega) == len(elastic(case, lateral=False)) + 2
        assert np.sum(np.abs(omega / math.sqrt(BEARING[name] / MASS[name]) - 1) < 1e-13) == 1


def test_bearings_that_do_not_give_leave_the_torsional_frequencies():
    torsional = elastic(pair(), lateral=False)
    errors = []
    for bearing in (1e3, 1e5, 1e7):
        omega = elastic(pair(bearing=bearing))
        errors.append(np.max(np.abs(omega[: len(torsional)] / torsional - 1.0)))
    assert errors[0] < 1e-2
    assert errors[1] == pytest.approx(errors[0] / 100, rel=0.05)  # falls as 1/k: a series spring
    assert errors[2] == pytest.approx(errors[1] / 100, rel=0.05)


# --- without bearings: nothing has changed ----------------------------------------------------------


def same(a, b):
    """Whether two trains are equal to the last bit."""
    for f in fields(a):
        x, y = getattr(a, f.name), getattr(b, f.name)
        if f.name == "flanks":
            assert [(p.element, p.gap, p.stiffness) for p in x] == [
                (p.element, p.gap, p.stiffness) for p in y
            ]
            assert all(np.array_equal(p.drive, q.drive) for p, q in zip(x, y, strict=True))
        elif isinstance(x, np.ndarray):
            assert np.array_equal(x, y), f.name
        else:
            assert x == y, f.name


def test_without_bearing_data_the_train_is_the_torsional_one():
    plain = pair(bodies=())
    same(build_train(plain), build_train(plain, lateral=False))
    same(build_train(pair(damped=True), lateral=False), build_train(pair(damped=True, bodies=())))
    train = build_train(plain)
    assert train.bodies == ()
    assert np.array_equal(train.flanks[0].back, -train.flanks[0].drive)
    assert modes_of(train).bearing_share.shape == (0, train.n_dof)


def test_transverse_freedoms_stand_after_the_others_and_do_not_turn():
    case = pair(damped=True)
    with_shaft = replace(
        case,
        elements=(
            *case.elements[:3],
            ElementRow("HS", "shaft", "W", "load", 7e5, od=0.1, length=1.0, density=7850.0),
        ),
    )
    train, plain = (build_train(with_shaft, {"HS": 5}, lateral=x) for x in (True, False))
    n = len(plain.speed_ratio)
    assert [(b.node_x, b.node_y) for b in train.bodies] == [(n, n + 1), (n + 2, n + 3)]
    assert list(train.row_element[-4:]) == [-1] * 4
    assert [b.row_x for b in train.bodies] == [plain.n_rows, plain.n_rows + 2]
    for values, given in (
        (train.speed_ratio, 0.0),
        (train.sense, 1.0),
        (train.node_scale, 1.0),
        (train.node_damping, 0.0),
    ):
        assert np.all(values[n:] == given)
    assert list(train.node_inertia[n:]) == [300.0, 300.0, 90.0, 90.0]
    assert np.array_equal(train.sense[:n], plain.sense)
    assert np.array_equal(train.node_incidence[: plain.n_rows, :n], plain.node_incidence)
    assert float(train.inertia @ train.dof_ratio**2) == float(plain.inertia @ plain.dof_ratio**2)
    assert np.max(np.abs(train.incidence @ train.dof_ratio)) < 1e-14
    for b, name in zip(train.bodies, "PW", strict=True):
        assert (b.mass, b.stiffness, b.damping) == (MASS[name], BEARING[name], DAMPER[name])
        rows = [b.row_x, b.row_y]
        assert list(train.stiffness[rows]) == [BEARING[name]] * 2
        assert list(train.viscous[rows]) == [DAMPER[name]] * 2


# --- flanks and clearances --------------------------------------------------------------------------


@pytest.mark.parametrize("swapped", [False, True])
def test_flanks_of_a_helical_mesh(swapped):
    """Transverse gap j_n / cos β_b; as an angle over the base radius of From."""
    case = pair(swapped=swapped, helix=20 * DEG, pressure=22 * DEG)
    case = replace(case, meshes=(case.meshes[0], replace(case.meshes[1], backlash=3e-4)))
    train = build_train(case)
    (flank,) = train.flanks
    alpha = math.atan(math.tan(22 * DEG) / math.cos(20 * DEG))
    base_helix = math.atan(math.tan(20 * DEG) * math.cos(alpha))
    base = (0.45 / RATIO if swapped else 0.45) * math.cos(alpha)
    assert flank.base_radius == pytest.approx(base, rel=1e-14)
    assert flank.normal_factor == pytest.approx(1.0 / math.cos(base_helix), rel=1e-14)
    assert flank.gap == pytest.approx(3e-4 / math.cos(base_helix) / base, rel=1e-14)
    assert flank.stiffness == pytest.approx(6e8 * (math.cos(base_helix) * base) ** 2, rel=1e-14)
    assert train.orientation[2] == (-1.0 if swapped else 1.0)
    assert np.array_equal(flank.drive, train.orientation[2] * train.node_incidence[flank.drive_row])
    assert flank.drive[2] > 0.0 > flank.drive[3]  # P drives and pushes forward
    assert (flank.back[2], flank.back[3]) == (-flank.drive[2], -flank.drive[3])


def test_flanks_of_couplings_and_stops_are_those_with_a_clearance():
    case = CaseData(
        stations=(StationRow("a", None, 1.0), StationRow("b", None, 2.0)),
        elements=(
            ElementRow("c", "coupling", "b", "a", 1e5, damping=3.0, od=0.1, length=0.5,
                       density=7850.0),
            ElementRow("stop", "spring to ground", "b", None, 2e5),
            ElementRow("held", "spring to ground", "a", None, 3e5),
        ),
        meshes=(
            MeshRow("c", angular_backlash=0.01),
            MeshRow("stop", angular_backlash=0.5),
            MeshRow("held", angular_backlash=0.0),
        ),
    )  # fmt: skip
    assert find_problems(case) == ()
    train = natural_modes(case).train
    assert [(f.element, f.gap, f.base_radius, f.normal_factor) for f in train.flanks] == [
        (0, 0.01, None, 1.0),
        (1, 0.5, None, 1.0),
    ]
    assert (train.flanks[0].stiffness, train.flanks[0].viscous) == (1e5, 3.0)
    assert list(train.flanks[0].drive) == [-1.0, 1.0]
    assert list(train.flanks[1].drive) == [0.0, 1.0]
    assert train.n_rows == 3  # a coupling that parts is one piece, whatever inertia it has
    assert build_train(case, {"c": 6}).n_rows == 3


# --- what is reported -------------------------------------------------------------------------------


def test_outputs_have_no_bearing_rows_and_a_rigid_mesh_is_unaffected():
    """The reverser's torque is that of the same mesh with a very high stiffness."""
    rigid = pair(damped=True, orientation=0.4)
    stiff = replace(
        rigid, elements=(replace(rigid.elements[0], stiffness=1e14), *rigid.elements[1:])
    )
    tables = []
    for case in (rigid, stiff):
        found = natural_modes(case)
        outputs = torque_outputs(found.train, found.modes, np.array([0, 4]))
        assert sorted(outputs.element) == [0, 1, 2, 3]
        torque = outputs.position[np.argsort(outputs.element)]
        torque *= np.sign(found.modes.shape[found.train.node_dof[0]])
        common = slice(1, len(torque[0]) - (case is stiff))
        turning = np.abs(torque[2, common]) > 0.0  # the others move sideways only
        assert turning.sum() == 5
        tables.append(torque[:, common][:, turning])
    assert tables[0] == pytest.approx(tables[1], rel=1e-6, abs=1e-6 * np.max(np.abs(tables[1])))


def test_the_torque_of_a_rigid_mesh_in_time_is_that_of_a_stiff_one():
    rigid = pair(damped=True, orientation=0.4)
    stiff = replace(
        rigid, elements=(replace(rigid.elements[0], stiffness=1e13), *rigid.elements[1:])
    )
    t = np.linspace(0.0, 0.2, 201)
    push = linear(4, np.array([0.0, 0.05, 1.0]), np.array([0.0, -2000.0, -2000.0]))
    found = []
    for case in (rigid, stiff):
        f = natural_modes(case)
        response = time_response(f.train, f.modes, [push], t)
        found.append(response.torque[np.argsort(response.output_element)])
    assert np.max(np.abs(found[0][0])) > 500.0
    assert found[0] == pytest.approx(found[1], abs=1e-4 * np.max(np.abs(found[1])))


@pytest.mark.slow
def test_energies_name_the_bearing_where_it_holds_most():
    case = pair(damping_ratio=0.02, orientation=0.3)
    found = natural_modes(case)
    train, modes = found.train, found.modes
    total = modes.strain_share.sum(axis=0) + modes.bearing_share.sum(axis=0)
    assert total[1:] == pytest.approx(np.ones(modes.n_modes - 1), abs=1e-12)
    kinetic = modes.kinetic_share.sum(axis=0) + modes.sideways_share.sum(axis=0)
    assert kinetic == pytest.approx(np.ones(modes.n_modes), abs=1e-12)
    results = run(case)
    rows = result_tables(results)["NaturalFrequencies"]
    assert len(rows) == modes.n_modes
    across = math.sqrt(BEARING["W"] / MASS["W"]) / (2 * math.pi)
    (alone,) = [r for r in rows if abs(r["frequency"] / across - 1) < 1e-12]
    assert (alone["largest_strain_energy"], alone["share"]) == ("bearing of W", pytest.approx(1.0))
    assert rows[1]["largest_strain_energy"] in train.elements
    shapes = result_tables(results)["ModeShapes"]
    assert [r["station"] for r in shapes] == list(train.stations)
    assert all(r[f"mode_{alone['mode']}"] == 0.0 for r in shapes)
    details = modal_details(results)["modes"][alone["mode"] - 1]
    assert details["bearing_strain_energy"] == {"P": 0.0, "W": pytest.approx(1.0)}
    assert details["sideways_kinetic_energy"] == {"P": 0.0, "W": pytest.approx(1.0)}
    assert "bearing_strain_energy" not in modal_details(run(pair(bodies=())))["modes"][0]


def test_a_loss_factor_of_the_last_element_is_its_own():
    """Bearing rows (element −1) must not speak for the last element of the table."""
    case = pair()
    lossy = replace(case, elements=(*case.elements[:3], replace(case.elements[3], loss_factor=0.1)))
    found = natural_modes(lossy)
    ratio = modal_damping(lossy, found.train, found.modes).ratio
    assert ratio == pytest.approx(0.05 * found.modes.strain_share[3], rel=1e-12)
    assert np.max(ratio) > 0.01
    assert {n.element for n in nodes_of(found.train, found.modes)} <= {"LS", "HS"}


def test_elements_side_by_side_share_by_their_own_stiffness():
    case = pair()
    beside = ElementRow("HS 2", "shaft", "W", "load", 1.4e6)  # the last element
    case = replace(case, elements=(*case.elements, beside))
    torque = transmitted_torque(case, build_train(case)).element
    assert torque[4] == pytest.approx(2.0 * torque[3], rel=1e-14)
    assert torque[3] + torque[4] == pytest.approx(3000.0, rel=1e-14)


def test_steady_state_judges_elements_and_an_undamped_sideways_mode_is_no_resonance_of_theirs():
    case = pair(orientation=0.3)
    found = natural_modes(case)
    train, modes = found.train, found.modes
    damping = modal_damping(case, train, modes)
    excitations = excitations_of(case, train)
    margins = separation_margins(case, train, modes, excitations)
    # motion across the line of action, without any twist, is judged by no torque
    across_only = [i for i in range(1, modes.n_modes) if modes.strain_share[:, i].sum() < 1e-12]
    assert len(across_only) == 2
    assert {r.mode for r in margins.rows} == set(range(1, modes.n_modes)) - set(across_only)
    steady = steady_state(case, ModalTrain(train, modes, damping), excitations, margins)
    assert {r.element for r in steady.rows} == set(train.elements)
    across = np.array([math.sqrt(BEARING[name] / MASS[name]) for name in "PW"])
    at = harmonic_response(train, modes, across, np.array([1.0, 0, 0, 0, 0]))
    assert np.all(np.isfinite(at.element_torque))
    coupled = modes.omega[modes.strain_share[2] > 1e-6]
    response = harmonic_response(train, modes, coupled, np.eye(5)[0])
    assert np.all(np.isinf(response.element_torque[2]))


# --- wrong input ------------------------------------------------------------------------------------


def told(case):
    return {(p.table, p.row, p.column): p.message for p in find_problems(case)}


def mesh_changed(case, **changes):
    return replace(case, meshes=(case.meshes[0], replace(case.meshes[1], **changes)))


def test_mass_without_bearing_and_bearing_without_mass():
    (message,) = told(mesh_changed(pair(), bearing_stiffness_drive=None)).items()
    assert message[0] == ("Meshes", 2, "Bearing stiffness drive")
    assert "Mass drive of the gear 'P' is 300 kg" in message[1]
    (message,) = told(mesh_changed(pair(), mass_driven=None)).items()
    assert message[0] == ("Meshes", 2, "Mass driven")
    assert "Bearing stiffness driven of the gear 'W' is 3e+08 N/m" in message[1]
    assert "a gear on bearings needs a mass" in message[1].lower()


def test_bearing_damping_alone_misses_both():
    case = mesh_changed(pair(bodies=()), bearing_damping_drive=5.0)
    found = told(case)
    assert set(found) == {("Meshes", 2, "Bearing stiffness drive"), ("Meshes", 2, "Mass drive")}
    assert all("Bearing damping drive of the gear 'P' is 5 N s/m" in m for m in found.values())
    assert told(mesh_changed(pair(bodies=()), bearing_damping_drive=0.0)) == {}


def test_what_another_row_says_of_the_same_gear_counts():
    assert told(idler(0.0, 1.0)) == {}  # mass in one row, stiffness in the other


@pytest.mark.parametrize(("stiffness", "word"), [(None, "is rigid"), (0.0, "has no stiffness")])
def test_bearings_need_a_mesh_stiffness(stiffness, word):
    case = mesh_changed(pair(), mesh_stiffness=None)
    element = replace(
        case.elements[2], stiffness=stiffness, damping=1.0 if stiffness == 0 else None
    )
    case = replace(case, elements=(*case.elements[:2], element, case.elements[3]))
    found = told(case)
    assert set(found) == {("Meshes", 2, "Mesh stiffness")}
    (message,) = found.values()
    for part in (word, "Mass drive of table Meshes, row 2", "Stiffness of 'mesh' (table Elements, "
                 "row 3)", "Mesh stiffness (table Meshes, row 2)"):  # fmt: skip
        assert part in message
    if stiffness is None:
        with pytest.raises(ModelError, match="has bearings"):
            build_train(case)


def test_bearings_need_a_pitch_radius_and_a_row():
    case = mesh_changed(pair(), pitch_radius_drive=None, mesh_stiffness=None)
    elements = (*case.elements[:2], replace(case.elements[2], stiffness=1e8), case.elements[3])
    found = told(replace(case, elements=elements))
    assert set(found) == {("Meshes", 2, "Pitch radius drive")}
    assert "Type the radius" in found["Meshes", 2, "Pitch radius drive"]
    case = idler(0.0, 1.0)
    first = replace(case.meshes[1], bearing_stiffness_driven=1e8)
    found = told(replace(case, meshes=(case.meshes[0], first)))
    assert set(found) == {("Meshes", None, "Element")}
    assert "'m2' (table Elements, row 3) has no row" in found["Meshes", None, "Element"]


def test_a_clearance_needs_something_to_meet_again_with():
    case = pair(bodies=())
    mesh = replace(case.elements[2], stiffness=0.0, damping=1.0)
    case = replace(case, elements=(*case.elements[:2], mesh, case.elements[3]))
    found = told(mesh_changed(case, mesh_stiffness=None, backlash=1e-4))
    assert set(found) == {("Meshes", 2, "Backlash")}
    assert "Stiffness of 'mesh' (table Elements, row 3) is 0" in found["Meshes", 2, "Backlash"]
    damper = CaseData(
        stations=(StationRow("a", None, 1.0), StationRow("b", None, 2.0)),
        elements=(
            ElementRow("c", "coupling", "a", "b", 0.0, damping=3.0),
            ElementRow("s", "coupling", "a", "b", 1e5),
        ),
        meshes=(MeshRow("c", angular_backlash=0.01),),
    )
    assert set(told(damper)) == {("Meshes", 1, "Angular backlash")}
    assert told(replace(damper, meshes=(MeshRow("s", angular_backlash=0.01),))) == {}


def test_a_stop_has_an_angular_backlash_and_nothing_else():
    case = CaseData(
        stations=(StationRow("a", None, 1.0),),
        elements=(ElementRow("stop", "spring to ground", "a", None, 2e5),),
        meshes=(MeshRow("stop", angular_backlash=0.5, backlash=1e-4),),
    )
    found = told(case)
    assert set(found) == {("Meshes", 1, "Backlash")}
    assert "is a spring to ground" in find_problems(case)[0].allowed
