"""Published and closed-form clearances.

A09  two masses and a gap: free impact oscillation; a gap closed by a step of torque
B01  Modelica Standard Library 4.0, Rotational.Examples.Backlash, and its law without the limiter
B02  Code_Aster V5.01.101 (SDND101): an oscillator against a one-sided elastic stop
"""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from cases import case_path, load_case

from engine.backlash.event_start import clearances_of
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.start.time_response import linear
from engine.start.trajectory import turning_of
from engine.stepping.contact_loop import BACK, DRIVE, FREE
from tests.clearance_response import ClearanceResponse, clearance_response


def torque_peaks(found: ClearanceResponse, row: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of the turning points of one torque."""
    trajectory = found.run.trajectory
    return turning_of(trajectory, float(trajectory.time[-1]))[row]


# --- A09 ------------------------------------------------------------------------------------------

A09 = load_case("A09")


def two_masses(gap: float = A09["input"]["total_backlash"]) -> CaseData:
    i = A09["input"]
    return CaseData(
        stations=(StationRow("near", None, i["J1"]), StationRow("far", None, i["J2"])),
        elements=(ElementRow("gap", "coupling", "near", "far", i["k"]),),
        meshes=(MeshRow("gap", angular_backlash=gap),),
    )


def impact_oscillation(step: float | None = None) -> ClearanceResponse:
    i = A09["input"]
    train = build_train(two_masses())
    # V0 shared so that nothing moves as a whole
    speed = np.array([i["J2"], -i["J1"]]) * i["V0"] / (i["J1"] + i["J2"])
    times = np.linspace(0.0, 1.0, 101)
    return clearance_response(
        train, modes_of(train), clearances_of(train), times, initial_speed=speed, step=step
    )


def test_a09_free_impact_oscillation() -> None:
    i, values = A09["input"], A09["values"]
    found = impact_oscillation()
    omega = math.sqrt(i["k"] * (i["J1"] + i["J2"]) / (i["J1"] * i["J2"]))
    contact, flight = math.pi / omega, i["total_backlash"] / i["V0"]
    n = len(found.log)
    assert n == 2 * int(1.0 / (contact + flight)) + 1
    parted = contact + (contact + flight) * np.arange((n + 1) // 2)
    truth = np.sort(np.concatenate([parted, parted + flight]))[:n]
    assert np.max(np.abs(found.log[:, 0] - truth)) < 1e-12
    onto_drive = found.log[found.log[:, 3] == DRIVE, 0]
    np.testing.assert_allclose(np.diff(onto_drive), values["period"], rtol=1e-10)
    assert np.all(found.log[found.log[:, 2] == FREE, 3][::2] == BACK)
    np.testing.assert_allclose(np.abs(found.log[:, 4]), i["V0"], rtol=1e-11)


def test_a09_peak_of_every_impact() -> None:
    found = impact_oscillation(step=2e-5)  # the peak is read from a cubic between samples
    _, value = torque_peaks(found)
    peaks = value[np.abs(value) > 1.0]
    assert len(peaks) == len(found.log[found.log[:, 3] == FREE]) + (found.log[-1, 3] != FREE)
    np.testing.assert_allclose(np.abs(peaks), A09["values"]["peak_torque_free"], rtol=1e-9)
    assert np.all(peaks[::2] > 0.0)
    assert np.all(peaks[1::2] < 0.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a09_step_of_torque_closes_the_gap(side: float) -> None:
    """From the back flank with +T, or from the drive flank with −T: the same the other way round."""
    i, values = A09["input"], A09["values"]
    train = build_train(two_masses())
    angle = np.array([-i["total_backlash"] if side > 0.0 else 0.0, 0.0])
    torque = linear(0, np.array([0.0, 1.0]), np.full(2, side * i["T_step"]))
    found = clearance_response(
        train, modes_of(train), clearances_of(train), np.linspace(0.0, 0.025, 26),
        torques=(torque,), initial_angle=angle, step=5e-5,
    )  # fmt: skip
    met = found.log[found.log[:, 2] == FREE][0]
    assert met[0] == pytest.approx(values["t_close"], rel=1e-11)
    assert met[4] == pytest.approx(values["V_impact"], rel=1e-11)
    assert met[3] == (DRIVE if side > 0.0 else BACK)
    _, value = torque_peaks(found)
    peak = float(np.max(side * value))
    assert peak == pytest.approx(values["peak_torque_step"], rel=1e-9)
    carried = i["T_step"] * i["J2"] / (i["J1"] + i["J2"])
    assert peak / carried == pytest.approx(values["amplification"], rel=1e-9)


def test_a09_without_a_gap_the_step_doubles_the_torque() -> None:
    i = A09["input"]
    train = build_train(two_masses(1e-12))
    torque = linear(0, np.array([0.0, 1.0]), np.full(2, i["T_step"]))
    found = clearance_response(
        train, modes_of(train), clearances_of(train), np.linspace(0.0, 0.02, 11),
        torques=(torque,), step=5e-5,
    )  # fmt: skip
    carried = i["T_step"] * i["J2"] / (i["J1"] + i["J2"])
    assert float(np.max(torque_peaks(found)[1])) == pytest.approx(2.0 * carried, rel=1e-9)


# --- B01 ------------------------------------------------------------------------------------------

B01 = load_case("B01")


def oscillator(
    law: str, times: np.ndarray, step: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Angle from the middle of the gap, and speed."""
    m = B01["model"]
    half = 0.5 * m["total_backlash_rad"]
    case = CaseData(
        stations=(StationRow("disc", None, m["J"]),),
        elements=(
            ElementRow("stop", "spring to ground", "disc", "ground", m["k"], damping=m["c"]),
        ),
        meshes=(MeshRow("stop", angular_backlash=m["total_backlash_rad"]),),
    )
    train = build_train(case)
    found = clearance_response(
        train, modes_of(train), clearances_of(train), times,
        initial_angle=np.array([B01["initial"]["phi"] - half]), contact_law=law, step=step,
    )  # fmt: skip
    return found.station_angle[0] + half, found.station_speed[0]


def test_b01_whole_published_history() -> None:
    with case_path("msl_Backlash", ".csv").open(encoding="utf-8") as file:
        rows = np.array([[float(x) for x in row[:3]] for row in list(csv.reader(file))[1:]])
    times, first = np.unique(rows[:, 0], return_index=True)
    assert len(times) > 1000
    angle, speed = oscillator("limited", times)
    tolerance = B01["tolerance"]["abs"]
    assert np.max(np.abs(angle - rows[first, 1])) < tolerance["phi"]
    # where two rows share an instant, at an event, either is published
    assert np.max(np.abs(speed - rows[first, 2])) < tolerance["w"]


@pytest.mark.parametrize(
    ("law", "key"),
    [("limited", "samples_backlash"), ("no adhesion", "samples_variant2_no_limiter")],
)
def test_b01_recomputed_samples(law: str, key: str) -> None:
    samples = np.array(B01["verification"]["recomputed"][key])
    angle, speed = oscillator(law, np.concatenate([[0.0], samples[:, 0]]), 2e-4)
    np.testing.assert_allclose(angle[1:], samples[:, 1], rtol=0.0, atol=5e-9)
    np.testing.assert_allclose(speed[1:], samples[:, 2], rtol=0.0, atol=1e-6)


# --- B02 ------------------------------------------------------------------------------------------

B02 = load_case("B02")


@pytest.mark.parametrize("other_flank", ["at infinity", "very far"])
def test_b02_one_sided_stop(other_flank: str) -> None:
    m, recomputed = B02["model"], B02["verification"]["recomputed"]
    case = CaseData(
        stations=(StationRow("mass", None, m["m"]),),
        elements=(
            ElementRow("spring", "spring to ground", "mass", "ground", m["k_ground"]),
            ElementRow("stop", "spring to ground", "mass", "ground", m["k_stop"]),
        ),
        meshes=(MeshRow("stop", angular_backlash=1e6),),
    )
    train = build_train(case)
    flanks = clearances_of(train)
    if other_flank == "at infinity":
        flanks = tuple(replace(f, gap=math.inf) for f in flanks)
    found = clearance_response(
        train, modes_of(train), flanks, np.linspace(0.0, 0.5, 51), step=1e-4,
        initial_speed=np.array([m["v0"]]),
    )  # fmt: skip
    omega = math.sqrt((m["k_ground"] + m["k_stop"]) / m["m"])
    half_swing = math.pi / math.sqrt(m["k_ground"] / m["m"])
    parted, met = (found.log[found.log[:, i] == FREE, 0] for i in (3, 2))
    assert parted[0] == pytest.approx(recomputed["T_choc"], rel=1e-11)
    assert met[0] == pytest.approx(parted[0] + half_swing, rel=1e-11)
    assert 0.5 * parted[0] == pytest.approx(recomputed["t_mid_first"], rel=1e-11)
    assert 0.5 * (met[0] + parted[1]) == pytest.approx(recomputed["t_mid_second"], rel=1e-11)
    stop = found.run.trajectory.torque[1]
    _, value = torque_peaks(found, 1)
    assert float(value.max()) == pytest.approx(recomputed["F_max"], rel=1e-9)
    assert m["k_stop"] * m["v0"] / omega == pytest.approx(recomputed["F_max"], rel=1e-12)
    # impulse of the stop = change of momentum less that of the spring beside it
    time, inside = found.run.trajectory.time, found.run.trajectory.time <= parted[0] + 1e-12
    coarse = np.trapezoid(stop[inside], time[inside])
    assert coarse == pytest.approx(recomputed["impulse"], rel=1e-5)
    reversed_ = 2.0 * m["m"] * m["v0"] * m["k_stop"] / (m["k_ground"] + m["k_stop"])
    assert reversed_ == pytest.approx(recomputed["impulse"], rel=1e-12)
    aster, tolerance = B02["published"]["code_aster"], B02["tolerance"]["rel"]
    assert float(value.max()) == pytest.approx(aster["F_max"], rel=tolerance["F_max"])
    assert coarse == pytest.approx(aster["impulse"], rel=tolerance["impulse"])
    assert np.all(stop[~inside & (time < met[0])] == 0.0)
