"""Natural frequencies and mode shapes of published trains, to the digits printed.

M01   two discs, openTorsion's test_shaft
M02   Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), Example 9.7.1
M03   Sopanen et al., IEEE Trans. Ind. Electron. 58 (2011): recomputed values are the reference, the
      published curves were digitised
M04   IEEE SSR Task Force, First Benchmark Model, IEEE Trans. PAS-96 (1977), with K 2.82 as printed by
      MATLAB-SSR; M04b the paper's 2.822
M05, M07  Kundur, Power System Stability and Control (1994), Figs 15.3 and 15.5 (MATLAB-SSR's output)
M10   Thomson, Theory of Vibration with Applications, Table 12.4-1: Holzer tables, four digits
M11   Rao, Mechanical Vibrations, ch. 7: exact roots
M12   VPCS SDLD02/89, eight equal masses between fixed ends
G01   Friswell et al. (2010), ch. 9, motor and two rotors through a 1:1 gear
G04   Tiwari, Rotor Systems (2018), Exercise 6.9

A tolerance is half a unit of the last digit printed, as each file states; the same frequencies in
15 digits were computed with mpmath independently and are held to 1e-12.
"""

import math

import numpy as np
import pytest
from cases import load_case
from models import case_of, largest_is_one

from engine.model.modes import nodes_of
from engine.model.subdivision import natural_modes

PUBLISHED = [
    "M01",
    "M02",
    "M03",
    "M04_ieee_ssr_first_benchmark",
    "M04b",
    "M05",
    "M07",
    "M12",
    "G01",
]
LUMPED = [*PUBLISHED, "M10", "M11", "G04"]


def solved(case_id):
    data = load_case(case_id)
    r = natural_modes(case_of(data["model"]))
    return data, r.train, r.modes


def sheet_shapes(train, modes):
    """Shapes as the sheet shows them: physical sense of rotation, largest = 1."""
    angle = (train.node_matrix() @ modes.shape) * train.sense[:, None]
    return largest_is_one(angle)


def in_printed_unit(data, modes):
    """Elastic frequencies in the unit of the file."""
    unit = data["tolerance"]["unit"]
    return modes.elastic_frequency * (1.0 if unit == "Hz" else 2.0 * math.pi)


@pytest.mark.parametrize("case_id", PUBLISHED)
def test_printed_frequencies(case_id):
    data, _, modes = solved(case_id)
    printed = np.array(data["published"]["frequencies_Hz"])
    half_digit = data["tolerance"]["abs_half_last_digit"]
    assert len(modes.elastic_frequency) == len(printed)
    if case_id == "M03":  # digitised: a sanity check in units of the reading
        half_digit = 3.0 * np.array(half_digit)
    assert np.all(np.abs(modes.elastic_frequency - printed) <= half_digit)


def test_printed_frequencies_of_g04():
    data, _, modes = solved("G04")
    printed = np.array(data["published"]["frequencies_rad_per_s"])
    w = modes.omega[modes.n_rigid :]
    assert abs(w[0] - printed[0]) <= 0.0005
    assert abs(w[1] - printed[1]) <= 0.005  # printed with two decimals


@pytest.mark.parametrize("case_id", LUMPED)
def test_fifteen_digits(case_id):
    data, _, modes = solved(case_id)
    reference = np.array([float(v) for v in data["verification"]["reference_values_mp"]])
    found = in_printed_unit(data, modes)
    assert found == pytest.approx(reference, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("case_id", LUMPED)
def test_rigid_modes_are_counted_and_exactly_zero(case_id):
    data, _, modes = solved(case_id)
    assert modes.n_rigid == data["verification"]["n_rigid_body_modes"]
    assert np.all(modes.omega[: modes.n_rigid] == 0.0)
    assert np.all(modes.omega[modes.n_rigid :] > 0.0)


@pytest.mark.parametrize("case_id", LUMPED)
def test_recomputed_shapes(case_id):
    """Signs included: behind an external mesh the train turns the other way."""
    data, train, modes = solved(case_id)
    shapes = sheet_shapes(train, modes)
    expected = data["verification"]["mode_shapes_recomputed_max1"]
    assert len(expected) == modes.n_modes
    for i, mode in enumerate(expected):
        want = np.array(mode["shape"])
        found = shapes[:, i] * np.sign(shapes[:, i] @ want)  # equal peaks: either may be the +1
        assert found == pytest.approx(want, abs=1e-9)


@pytest.mark.parametrize("case_id", ["M04_ieee_ssr_first_benchmark", "M05", "M07"])
def test_printed_shapes(case_id):
    data, train, modes = solved(case_id)
    shapes = sheet_shapes(train, modes)
    for printed, want in data["published_mode_shapes"].items():
        i = int(np.argmin(np.abs(modes.frequency - float(printed))))
        assert shapes[:, i] == pytest.approx(np.array(want), abs=5.001e-5)


def test_printed_shapes_of_g04():
    data, train, modes = solved("G04")
    shapes = sheet_shapes(train, modes)[[0, 1, 3]][:, modes.n_rigid :]  # disc A, gear A, disc B
    for i, want in enumerate(data["published_normalised"]):
        assert shapes[:, i] == pytest.approx(np.array(want), abs=5.001e-5)


def test_g01_gear_turns_backwards():
    _, train, modes = solved("G01")
    assert list(train.sense) == [1.0, 1.0, -1.0, -1.0, 1.0]
    rigid = sheet_shapes(train, modes)[:, 0]
    assert rigid == pytest.approx([1.0, 1.0, -1.0, -1.0, 1.0], abs=1e-12)


# --- Holzer's tables ------------------------------------------------------------------------------


def holzer(inertia, stiffness, omega):
    """Angles and summed torques along a chain, from 1 rad at its first disc (Thomson § 12.4)."""
    theta, torque = [1.0], [inertia[0] * omega**2]
    for k, J in zip(stiffness, inertia[1:], strict=True):
        theta.append(theta[-1] - torque[-1] / k)
        torque.append(torque[-1] + J * omega**2 * theta[-1])
    return np.array(theta), np.array(torque)


def chain_of(data):
    model = data["model"]
    return [n["J"] for n in model["nodes"]], [s["k"] for s in model["shafts"]]


def test_m10_holzer_tables():
    data = load_case("M10")
    for table in data["holzer_table"]:
        theta, torque = holzer(*chain_of(data), table["omega"])
        printed = table["published"]
        assert theta == pytest.approx(printed["theta"], rel=1.5e-4)  # four digits
        assert torque == pytest.approx(printed["torque"], rel=1.5e-4)


@pytest.mark.parametrize("case_id", ["M10", "M11"])
def test_the_holzer_residual_vanishes_at_our_frequencies(case_id):
    data, _, modes = solved(case_id)
    inertia, stiffness = chain_of(data)
    for omega in modes.omega[modes.n_rigid :]:
        _, torque = holzer(inertia, stiffness, omega)
        assert abs(torque[-1]) <= 1e-11 * np.max(np.abs(torque))
        below = holzer(inertia, stiffness, omega * (1 - 1e-6))[1][-1]
        above = holzer(inertia, stiffness, omega * (1 + 1e-6))[1][-1]
        assert below * above < 0.0


def test_m11_exact_roots_and_residuals():
    data, train, modes = solved("M11")
    assert modes.omega[1:] == pytest.approx([math.sqrt(2e6 / 4), math.sqrt(1.5e6)], rel=1e-14)
    for table in data["holzer_residual"]:
        _, torque = holzer(*chain_of(data), table["omega"])
        assert torque[-1] == pytest.approx(table["residual_torque"], rel=1e-12)
    # The turbine stands still in the first mode: the node is a station, the end of one element.
    first = [n for n in nodes_of(train, modes) if n.mode == 1]
    assert len(first) == 1
    at_turbine = {"compressor-turbine": 1.0, "turbine-generator": 0.0}
    assert first[0].position == pytest.approx(at_turbine[first[0].element], abs=1e-9)


def test_m12_closed_form_between_fixed_ends():
    _, train, modes = solved("M12")
    n, k, m = 8, 1e5, 10.0
    i = np.arange(1, n + 1)
    exact = math.sqrt(k / m) / math.pi * np.cos((n + 1 - i) / (n + 1) * math.pi / 2)
    assert modes.frequency == pytest.approx(exact, rel=1e-13)
    assert modes.n_rigid == 0
    # One more node a mode; between fixed ends mode i has i − 1 of them inside.
    counts = [sum(node.mode == mode for node in nodes_of(train, modes)) for mode in i]
    assert counts == list(range(n))
