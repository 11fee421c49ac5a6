"""Published forced responses, recomputed with the engine's direct solution.

R03  Code_Aster SDLD313 (docaster V2.01.313; Piranda, MODAN 1990): loss factor, 0.5 %
R04  ANSYS Mechanical APDL Verification Manual VM90 (Thomson, Vibration Theory and Applications,
     1965, § 6.6): two masses, three springs, 5e-5
R05  openTorsion documentation, "Steady-state forced response": five disks, four harmonics; the
     recomputed harmonics, and the published curves drawn from them

Translational and per-unit cases: numbers unchanged, kg as kg m², N/m as N m/rad.
"""

import math

import numpy as np
import pytest
from cases import load_case

from engine.case.case import Case
from engine.case.data import GROUND, ElementRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.operation.steady_state import harmonic_response


def case_of(model):
    """Stations, shafts and springs to ground of a file's model, in its order."""
    elements = [
        ElementRow(
            f"{node['id']} to ground",
            "spring to ground",
            node["id"],
            GROUND,
            node["k_ground"],
            loss_factor=node.get("eta_ground"),
        )
        for node in model["nodes"]
        if "k_ground" in node
    ]
    elements += [
        ElementRow(f"shaft {i}", "shaft", s["i"], s["j"], s["k"])
        for i, s in enumerate(model["shafts"], start=1)
    ]
    stations = tuple(StationRow(node["id"], None, node["J"]) for node in model["nodes"])
    return Case(stations=stations, elements=tuple(elements))


def respond(model, omega, station, amplitude):
    train = build_train(case_of(model))
    torque = np.zeros(train.n_stations)
    torque[train.stations.index(station)] = amplitude
    return train, harmonic_response(train, modes_of(train), np.asarray(omega, float), torque)


def test_r03_hysteretic_damping():
    d = load_case("R03")
    published = d["published"]
    omega = 2.0 * math.pi * np.array(published["frequency_Hz"])
    excitation = d["excitation"]
    train, response = respond(d["model"], omega, excitation["node"], excitation["amplitude"])
    angle = response.station_angle[train.stations.index("C")]
    expected = np.array([complex(*z) for z in published["response_C"]])
    assert np.max(np.abs(angle / expected - 1.0)) < d["tolerance"]["rel"] == 0.005
    recomputed = np.array([complex(*z) for z in d["verification"]["recomputed"]])
    # the frequencies are printed with four decimals, the recomputation used the same
    assert np.max(np.abs(angle / recomputed - 1.0)) < 1e-11


def test_r04_two_masses_three_springs():
    d = load_case("R04")
    frequencies = list(d["published"])
    omega = [2.0 * math.pi * float(f) for f in frequencies]
    excitation = d["excitation"]
    _, response = respond(d["model"], omega, excitation["node"], excitation["amplitude"])
    assert np.max(np.abs(response.station_angle.imag)) < 1e-15
    for i, f in enumerate(frequencies):
        published = [d["published"][f][x] for x in ("X1", "X2")]
        recomputed = d["verification"]["recomputed"][f]
        assert response.station_angle[:, i].real == pytest.approx(published, rel=5e-5)
        assert response.station_angle[:, i].real == pytest.approx(recomputed, rel=1e-12)


@pytest.fixture
def r05():
    d = load_case("R05")
    x = d["excitation"]
    harmonics = np.array(x["harmonics"])
    torques = []
    for h, amplitude in zip(harmonics, x["amplitudes"], strict=True):
        _, response = respond(d["model"], [h * x["omega"]], x["node"], amplitude)
        assert np.max(np.abs(response.element_torque.imag)) < 1e-9
        torques.append(response.element_torque[:, 0].real)
    return d, harmonics, np.array(torques).T


def test_r05_harmonics_of_each_shaft(r05):
    """Same magnitudes; there a shaft's torque is k(θ right − θ left), here the drive end leads."""
    d, _, torque = r05
    expected = d["verification"]["recomputed"]["harmonic_torque_amplitudes_per_shaft"]
    assert -torque == pytest.approx(np.array(expected), rel=1e-9)


def test_r05_published_curves(r05):
    """The vector polylines of the published figure, within what its drawing resolves."""
    d, harmonics, torque = r05
    omega = d["excitation"]["omega"]
    for i in range(4):
        t, published = np.array(d["published"]["curves"][f"shaft{i + 1}"]).T
        curve = -torque[i] @ np.cos(np.outer(harmonics * omega, t))
        assert np.max(np.abs(curve - published)) < d["tolerance"]["abs_Nm"] == 1e-3
