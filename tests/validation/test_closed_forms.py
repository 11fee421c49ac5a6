"""Closed forms every torsional program must give.

A01  uniform free shaft: f = n c / 2L; lumped segments 2 (c/le) sin(nπ/2N) exactly
A02  N equal discs and springs: free, fixed-free, fixed-fixed
A03  two and three discs, and the node of the two-disc mode
A04  gears: everything referred by n² (Thomson, Theory of Vibration with Applications, § 12.10)
A05  speed at which twice slip frequency meets a mode (Szenasi & von Nimitz 1978, Table 1)
"""

import math

import numpy as np
import pytest
from cases import load_case

from engine.case.case import Case
from engine.case.data import ElementRow, StationRow
from engine.model.build_train import build_train
from engine.model.links import shaft_inertia, shaft_stiffness
from engine.model.modes import modes_of, nodes_of
from engine.model.subdivision import natural_modes
from engine.operation.margins import percent_speed


def chain(inertia, stiffness, fixed_start=None, fixed_end=None):
    """Discs in a row; `fixed_start` and `fixed_end` are stiffnesses to ground."""
    names = [f"disc {i + 1}" for i in range(len(inertia))]
    elements = [
        ElementRow(f"shaft {i + 1}", "shaft", names[i], names[i + 1], k)
        for i, k in enumerate(stiffness)
    ]
    if fixed_start:
        elements.append(ElementRow("first end", "shaft", "ground", names[0], fixed_start))
    if fixed_end:
        elements.append(ElementRow("last end", "shaft", names[-1], "ground", fixed_end))
    return Case(
        stations=tuple(StationRow(n, None, J) for n, J in zip(names, inertia, strict=True)),
        elements=tuple(elements),
    )


# --- A01 ------------------------------------------------------------------------------------------


def free_shaft():
    i = load_case("A01")["input"]
    return Case(
        stations=(StationRow("left"), StationRow("right")),
        elements=(
            ElementRow(
                "shaft",
                "shaft",
                "left",
                "right",
                od=i["d"],
                length=i["L"],
                shear_modulus=i["G"],
                density=i["rho"],
            ),
        ),
    )


def test_a01_twenty_segments():
    values = load_case("A01")["values"]
    modes = modes_of(build_train(free_shaft(), {"shaft": 20}))
    assert modes.n_rigid == 1
    assert modes.elastic_frequency[:6] == pytest.approx(values["lumped_N20"], rel=1e-12)


def test_a01_converges_with_the_square_of_the_segments():
    exact = np.array(load_case("A01")["values"]["f_Hz"])[:4]
    segments = np.array([16, 32, 64, 128])
    error = np.array(
        [
            1 - modes_of(build_train(free_shaft(), {"shaft": int(n)})).elastic_frequency[:4] / exact
            for n in segments
        ]
    )
    order = np.log2(error[:-1] / error[1:])
    assert np.all(error > 0)  # lumping is always on the low side here
    assert order == pytest.approx(2.0, abs=0.05)


def test_a01_shape_is_a_cosine():
    train = build_train(free_shaft(), {"shaft": 20})
    modes = modes_of(train)
    along = [0, *range(2, 21), 1]  # left end, inner points, right end
    x = np.arange(21) / 20
    for n in range(1, 6):
        shape = modes.shape[along, n] / modes.shape[0, n]
        assert shape == pytest.approx(np.cos(n * math.pi * x), abs=1e-12)
        places = [node.position for node in nodes_of(train, modes) if node.mode == n]
        assert places == pytest.approx((np.arange(n) + 0.5) / n, abs=2e-3)


def test_a01_subdivides_by_itself():
    exact = np.array(load_case("A01")["values"]["f_Hz"])
    r = natural_modes(free_shaft(), 2000.0, 1e-4)
    wanted = r.modes.elastic_frequency[:2]
    error = np.max(np.abs(wanted / exact[:2] - 1))
    assert error <= r.frequency_error <= 1e-4


# --- A02 ------------------------------------------------------------------------------------------


def test_a02_equal_discs():
    data = load_case("A02")
    N, J, k = (data["input"][key] for key in ("N", "J", "k"))
    modes = modes_of(build_train(chain([J] * N, [k] * (N - 1))))
    assert modes.frequency == pytest.approx(data["values"]["f_Hz"], rel=1e-13, abs=0.0)
    j = np.arange(1, N + 1)
    for n in range(1, N):
        want = np.cos(n * math.pi * (j - 0.5) / N)
        found = modes.shape[:, n] / np.linalg.norm(modes.shape[:, n])
        assert abs(found @ want) / np.linalg.norm(want) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("both", [False, True])
def test_a02_with_fixed_ends(both):
    data = load_case("A02")
    N, J, k = (data["input"][key] for key in ("N", "J", "k"))
    n = np.arange(1, N + 1)
    angle = n * math.pi / (2 * (N + 1)) if both else (2 * n - 1) * math.pi / (2 * (2 * N + 1))
    modes = modes_of(build_train(chain([J] * N, [k] * (N - 1), k, k if both else None)))
    assert modes.n_rigid == 0
    assert modes.omega == pytest.approx(2 * math.sqrt(k / J) * np.sin(angle), rel=1e-13)


# --- A03 ------------------------------------------------------------------------------------------


def test_a03_two_discs_and_their_node():
    data = load_case("A03")
    (J1, J2, _), (k1, _) = data["input"]["J"], data["input"]["k"]
    train = build_train(chain([J1, J2], [k1]))
    modes = modes_of(train)
    assert modes.omega[1] == pytest.approx(data["values"]["two_disk_rad_s"], rel=1e-15)
    (node,) = nodes_of(train, modes)
    assert (node.mode, node.element) == (1, "shaft 1")
    assert node.position == pytest.approx(J2 / (J1 + J2), rel=1e-14)


def test_a03_three_discs():
    data = load_case("A03")
    modes = modes_of(build_train(chain(data["input"]["J"], data["input"]["k"])))
    assert modes.omega[1:] == pytest.approx(data["values"]["three_disk_rad_s"], rel=1e-14)


# --- A04 ------------------------------------------------------------------------------------------


def geared(pinion, gear, mesh_stiffness=None):
    i = load_case("A04")["input"]
    n = i["speed_ratio_load_over_motor"]
    return Case(
        stations=(
            StationRow("motor", None, i["J_motor"]),
            StationRow("pinion", None, pinion),
            StationRow("gear", None, gear, n),
            StationRow("load", None, i["J_load"], n),
        ),
        elements=(
            ElementRow("motor shaft", "shaft", "motor", "pinion", i["k_motor_shaft"]),
            ElementRow("mesh", "gear mesh", "pinion", "gear", mesh_stiffness),
            ElementRow("load shaft", "shaft", "gear", "load", i["k_load_shaft"]),
        ),
    )


def test_a04_referred_to_the_motor_shaft():
    data = load_case("A04")
    i, values = data["input"], data["values"]
    modes = modes_of(build_train(geared(i["J_pinion"], i["J_gear"])))
    assert modes.omega[1:] == pytest.approx(values["with_gear_inertia_rad_s"], rel=1e-14)


def test_a04_massless_gears_are_the_limit_of_tiny_ones():
    data = load_case("A04")
    i, massless = data["input"], data["values"]["massless_gears_rad_s"]
    share = np.array([1e-2, 1e-4, 1e-6, 1e-10])
    error = [
        1 - modes_of(build_train(geared(s * i["J_pinion"], s * i["J_gear"]))).omega[1] / massless
        for s in share
    ]
    assert np.array(error[:3]) / share[:3] == pytest.approx(error[1] / share[1], rel=0.01)
    assert abs(error[3]) < 1e-11


def test_a04_a_stiff_mesh_tends_to_the_rigid_one():
    i = load_case("A04")["input"]
    rigid = modes_of(build_train(geared(i["J_pinion"], i["J_gear"]))).omega[1:]
    for stiffness in (1e9, 1e12, 1e16):
        elastic = modes_of(build_train(geared(i["J_pinion"], i["J_gear"], stiffness))).omega[1:3]
        error = np.abs(elastic / rigid - 1)
        assert np.all(error < 10 * i["k_motor_shaft"] / stiffness + 1e-14)


# --- A05 ------------------------------------------------------------------------------------------


def test_a05_percent_speed_of_the_start_up_crossing():
    data = load_case("A05")
    for frequency, exact in data["values"].items():
        percent = percent_speed(float(frequency), 60.0)
        assert percent == pytest.approx(exact, rel=1e-14)
        rounded = math.floor(percent + 0.5)  # half up: 82.5 → 83, as the paper's Table 1
        assert rounded == data["published"]["percent_speed_rounded"][frequency]


# --- shaft formulas -------------------------------------------------------------------------------


def test_shaft_formulas():
    """Solid and hollow round shaft (Timoshenko, Strength of Materials I, § 56)."""
    assert shaft_stiffness(0.1, 0.0, 2.0, 8e10) == pytest.approx(
        8e10 * math.pi * 0.1**4 / 32 / 2.0, rel=1e-15
    )
    hollow = shaft_stiffness(0.78, 0.65, 160.0, 7.5e10)
    assert hollow == pytest.approx(8819360.689428004, rel=1e-14)  # F01
    inertia = shaft_inertia(0.78, 0.65, 160.0, 8000.0)
    assert inertia == pytest.approx(24082.7342559314, rel=1e-14)  # F01
    area = math.pi / 4 * (0.2**2 - 0.1**2)
    solid_mass = 7850 * area * 3.0
    assert shaft_inertia(0.2, 0.1, 3.0, 7850) == pytest.approx(
        solid_mass * (0.2**2 + 0.1**2) / 8, rel=1e-14
    )
