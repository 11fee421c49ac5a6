"""Time response under prescribed torques: published trajectories and closed forms.

T01  openTorsion tutorial, five disks, triangular impulse held between samples (recomputed samples)
T03  Modelica Standard Library 4.0.0, Rotational.Examples.First (Dymola, DASSL 1e-6): every row
T05  ANSYS VM182 (Vierck, Vibration Analysis, 1979, sec. 5-8): rectangular pulse
A06  Lewis (1932): linear sweep through resonance, exact values at finite sweep rates
A07  step torque on two masses, closed form;  A08  energy and momentum, closed form
"""

from __future__ import annotations

import csv
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import GROUND, ElementRow, StationRow, TorqueTimeRow
from engine.model.modal_train import ModalTrain
from engine.model.modes import modal_damping
from engine.start.prescribed import run_prescribed
from engine.start.time_response import linear, time_response
from engine.stepping.linear_loop import turning_points
from tests.prescribed import held, modal_speed, torque_from_function
from tests.trains import prepared
from tests.validation.cases import case_path, load_case


def train_of(model: dict[str, Any], **fields: Any) -> Case:
    """A case file's `model` as a case; gears are rigid and from parent to child."""
    ratio = {n["id"]: 1.0 for n in model["nodes"]}
    for g in model["gears"]:
        ratio[g["child"]] = g["ratio"]
    stations = tuple(
        StationRow(n["id"], None, n["J"], ratio[n["id"]], n.get("c_ground")) for n in model["nodes"]
    )
    elements = [
        ElementRow(f"{s['i']}-{s['j']}", "shaft", s["i"], s["j"], s["k"], damping=s.get("c"))
        for s in model["shafts"]
    ]
    elements += [
        ElementRow(f"Mesh {g['child']}", "gear mesh", g["parent"], g["child"])
        for g in model["gears"]
    ]
    elements += [
        ElementRow(f"Spring {n['id']}", "spring to ground", n["id"], GROUND, n["k_ground"])
        for n in model["nodes"]
        if n.get("k_ground")
    ]
    return Case(stations=stations, elements=tuple(elements), **fields)


# --- T01 ------------------------------------------------------------------------------------------


def test_t01_held_torque_five_disks() -> None:
    data = load_case("T01")
    train, modes, _ = prepared(train_of(data["model"]))
    u = data["excitation"]
    t = u["dt"] * np.arange(u["n_samples"])
    r = time_response(train, modes, [held(0, t, np.array(u["torque"]))], t)
    recomputed = data["verification"]["recomputed"]["shaft_torques_all_samples"]
    for i in range(4):
        # the file's torque is k (θ_right − θ_left); ours is positive where the drive end leads
        np.testing.assert_allclose(-r.torque[i], recomputed[f"shaft{i + 1}"], atol=1e-6)
        for when, value in data["published"]["curves"][f"shaft{i + 1}"]:
            k = round(when / u["dt"])
            if abs(when - t[k]) < 1e-6:  # the drawing's polyline leaves samples out
                assert -r.torque[i, k] == pytest.approx(value, abs=data["tolerance"]["abs_Nm"])


def test_t01_ramps_instead_of_steps_are_another_answer() -> None:
    """As the file says: the hold matters, so the two must not be confused."""
    data = load_case("T01")
    train, modes, _ = prepared(train_of(data["model"]))
    u = data["excitation"]
    t = u["dt"] * np.arange(u["n_samples"])
    stepped = time_response(train, modes, [held(0, t, np.array(u["torque"]))], t)
    ramped = time_response(train, modes, [linear(0, t, np.array(u["torque"]))], t)
    assert np.max(np.abs(stepped.torque - ramped.torque)) > 50.0


def test_t01_straight_lines_are_what_a_cubic_through_four_points_of_them_is() -> None:
    data = load_case("T01")
    train, modes, _ = prepared(train_of(data["model"]))
    u = data["excitation"]
    knots = u["dt"] * np.arange(u["n_samples"])
    times = np.linspace(0.0, 1.1 * knots[-1], 3 * len(knots))  # steps between the knots, too
    ramps = linear(0, knots, np.array(u["torque"]))
    line = time_response(train, modes, [ramps], times)
    cubic = time_response(train, modes, [replace(ramps, linear=False)], times)
    for name in ("torque", "station_speed"):
        found, other = getattr(line, name), getattr(cubic, name)
        np.testing.assert_allclose(found, other, rtol=0.0, atol=1e-12 * np.max(np.abs(other)))


# --- T03 ------------------------------------------------------------------------------------------


def test_t03_modelica_first_every_row() -> None:
    data = load_case("T03")
    with case_path("msl_First", ".csv").open(encoding="utf-8") as file:
        rows = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
    table = np.array(rows)
    keep = np.concatenate([[True], np.diff(table[:, 0]) > 0.0])  # event instants come twice
    table = table[keep]
    train, modes, _ = prepared(train_of(data["model"]))
    torque = torque_from_function(0, lambda t: 10.0 * np.sin(2.0 * np.pi * 5.0 * t))
    r = time_response(train, modes, [torque], table[:, 0])
    assert r.coupled  # one damper to ground is not proportional
    allowed = data["tolerance"]["abs"]
    np.testing.assert_allclose(-r.station_angle[1], table[:, 1], atol=allowed["phi"])
    np.testing.assert_allclose(-r.station_speed[1], table[:, 2], atol=allowed["w"])
    np.testing.assert_allclose(r.station_angle[2], table[:, 3], atol=allowed["phi"])
    np.testing.assert_allclose(r.station_speed[2], table[:, 4], atol=allowed["w"])
    for sample in data["verification"]["recomputed"]["samples"]:  # DOP853, rtol 1e-12
        k = int(np.argmin(np.abs(table[:, 0] - sample["t"])))
        assert r.station_angle[1, k] == pytest.approx(sample["th2"], abs=1e-9)
        assert r.station_angle[2, k] == pytest.approx(sample["th_load"], abs=1e-9)
        assert r.station_speed[2, k] == pytest.approx(sample["w_load"], abs=1e-7)


def test_t03_torque_in_the_ideal_gear_is_in_equilibrium() -> None:
    """Motor side: torque − J α = mesh torque; damping must not upset it."""
    data = load_case("T03")
    train, modes, _ = prepared(train_of(data["model"]))
    t = np.linspace(0.0, 1.0, 20_001)
    sine = 10.0 * np.sin(2.0 * np.pi * 5.0 * t)
    r = time_response(
        train, modes, [torque_from_function(0, lambda x: 10.0 * np.sin(2 * np.pi * 5 * x))], t
    )
    mesh = next(i for i, e in enumerate(r.output_element) if train.elements[e].startswith("Mesh"))
    acceleration = np.gradient(r.station_speed[0], t, edge_order=2)
    at_motor = sine - 0.1 * acceleration
    # the mesh torque is on the From side, inertia2, which turns at a tenth of the motor's speed
    np.testing.assert_allclose(np.abs(r.torque[mesh]), np.abs(10.0 * at_motor), atol=2e-3)


# --- T05 ------------------------------------------------------------------------------------------


def test_t05_rectangular_pulse() -> None:
    data = load_case("T05")
    train, modes, _ = prepared(train_of(data["model"]))
    pulse = held(0, np.array([0.0, 1.8]), np.array([50.0, 0.0]))
    t = np.array([0.0, 0.7, 1.3, 2.4])  # the pulse ends between two wanted times
    r = time_response(train, modes, [pulse], t)
    exact = data["verification"]["recomputed"]
    np.testing.assert_allclose(r.station_angle[:, 2], exact["Y(1.3)"], rtol=1e-12)
    np.testing.assert_allclose(r.station_angle[:, 3], exact["Y(2.4)"], rtol=1e-12)
    published = data["published"]
    assert r.station_angle[0, 2] == pytest.approx(published["Y1(1.3)"], abs=0.005)
    assert r.station_angle[1, 2] == pytest.approx(published["Y2(1.3)"], abs=0.005)
    assert r.station_angle[0, 3] == pytest.approx(published["Y1(2.4)"], abs=0.005)


# --- A06 ------------------------------------------------------------------------------------------

CHIRP = load_case("A06")["values"]["finite_q_exact"]


def swept(q: float, ratio: float, t: float) -> complex:
    """Response to exp(½iαt²) at ω₀ = 1 from rest by error functions in 60 digits, Duhamel."""
    mp = mpmath.mp.clone()
    mp.dps = 60
    rate = 1 / (2 * mp.pi * mp.mpf(q))
    damped = mp.sqrt(1 - mp.mpf(ratio) ** 2)

    def part(pole: Any) -> Any:  # ∫ exp(pole (t − s)) exp(½iαs²) ds
        root, middle = mp.sqrt(-0.5j * rate), -1j * pole / rate
        area = mp.erf(root * (mp.mpf(t) - middle)) - mp.erf(-root * middle)
        return mp.sqrt(mp.pi) / (2 * root) * area * mp.exp(1j * pole**2 / (2 * rate) + pole * t)

    first, second = part(mp.mpc(-ratio, damped)), part(mp.mpc(-ratio, -damped))
    return complex((first - second) / (2j * damped))


@pytest.mark.parametrize("row", CHIRP, ids=[f"q{r['q']}-zeta{r['zeta']}" for r in CHIRP])
def test_a06_sweep_through_resonance(row: dict[str, float]) -> None:
    """x″ + 2ζω₀ x′ + ω₀² x = ω₀² cos(½αt²): a mass on a spring to ground."""
    q, ratio = row["q"], row["zeta"]
    w0 = 2.0 * np.pi
    rate = w0 * w0 / (2.0 * np.pi * q)
    case = Case(
        stations=(StationRow("Disk", None, 1.0),),
        elements=(ElementRow("Spring", "spring to ground", "Disk", GROUND, w0 * w0),),
        damping_ratio=ratio,
    )
    train, modes, damping = prepared(case)
    end = w0 / rate * (1.0 + 2.5 / np.sqrt(q))
    highest = rate * end / (2.0 * np.pi)
    t = np.linspace(0.0, end, int(end * highest * 100))

    def response(drive: Any) -> Any:
        return time_response(
            train,
            modes,
            [torque_from_function(0, lambda x: w0 * w0 * drive(0.5 * rate * x * x))],
            t,
            damping_ratio=damping.structural,
        )

    cosine, sine = response(np.cos), response(np.sin)
    _, value = turning_points(t, cosine.station_angle[0], cosine.station_speed[0])
    largest = np.max(np.abs(value))
    # the file's figures are the largest of its samples: from q = 100 on up to 1.8e-4 low, the
    # envelope up to 1.6e-6 at q ≥ 500; error functions tell where the truth lies
    above = 1e-6 if q <= 50 else 2e-4
    assert row["cos_drive_max_abs"] * (1 - 1e-6) < largest < row["cos_drive_max_abs"] * (1 + above)
    if (q, row["zeta"]) in ((5, 0.01), (100, 0.05), (500, 0.0), (1000, 0.0)):
        k = int(np.argmax(np.abs(cosine.station_angle[0])))
        exact = [swept(q, ratio, 2 * np.pi * x).real for x in t[k - 1 : k + 2]]
        np.testing.assert_allclose(
            cosine.station_angle[0, k - 1 : k + 2], exact, atol=3e-7 * largest
        )
    envelope = np.hypot(cosine.station_angle[0], sine.station_angle[0])
    k = int(np.argmax(envelope))
    bow = np.polyfit(t[k - 2 : k + 3] - t[k], envelope[k - 2 : k + 3], 4)
    near = np.linspace(t[1] - t[2], t[2] - t[1], 2001)
    assert np.max(np.polyval(bow, near)) == pytest.approx(
        row["env_max"], rel=1e-6 if q <= 200 else 2e-6
    )
    top = t[k] + near[int(np.argmax(np.polyval(bow, near)))]
    assert rate * top / w0 == pytest.approx(row["freq_ratio_at_env_max"], abs=2e-3)


# --- A07, A08 -------------------------------------------------------------------------------------


def two_mass(data: dict[str, Any], damper: float | None) -> Case:
    return Case(
        stations=(StationRow("J1", None, data["J1"]), StationRow("J2", None, data["J2"])),
        elements=(ElementRow("Shaft", "shaft", "J1", "J2", data["k"], damping=damper),),
        torque_time=(TorqueTimeRow("J1", 0.0, data["T0"]), TorqueTimeRow("J1", 0.1, data["T0"])),
        tolerance_peak=1e-6,
    )


@pytest.mark.parametrize("damped", [False, True])
def test_a07_step_torque(damped: bool) -> None:
    data = load_case("A07")
    case = two_mass(data["input"], data["input"]["c"] if damped else None)
    train, modes, damping = prepared(case)
    peak = data["values"]["peak_damped" if damped else "peak_undamped"]
    # through the table TorqueTime: the answers of a case
    start = run_prescribed(case, ModalTrain(train, modes, damping))
    assert start.outcome.outcome == "completed"
    assert start.peaks[0].maximum == pytest.approx(peak, rel=2e-6)
    assert abs(start.peaks[0].maximum - peak) <= start.peaks[0].error + 1e-9 * peak
    # and the whole history
    t = np.linspace(0.0, 0.1, 501)
    d, wn = data["input"], data["values"]["wn"]
    r = time_response(train, modes, [held(0, np.zeros(1), np.array([d["T0"]]))], t)
    z = d["zeta"] if damped else 0.0
    wd = wn * np.sqrt(1.0 - z * z)
    # elastic torque k·twist, not the torque of the damper beside it
    exact = np.exp(-z * wn * t) * (np.cos(wd * t) + z / np.sqrt(1 - z * z) * np.sin(wd * t))
    np.testing.assert_allclose(r.torque[0], 750.0 * (1.0 - exact), atol=1e-9)


def test_a08_energy_and_momentum() -> None:
    data = load_case("A08")
    J, k = np.array(data["input"]["J"]), data["input"]["k"]
    model = {
        "nodes": [{"id": f"n{i}", "J": j} for i, j in enumerate(J)],
        "shafts": [{"i": f"n{i}", "j": f"n{i + 1}", "k": k} for i in range(4)],
        "gears": [],
    }
    case = train_of(model)
    train, modes, _ = prepared(case)
    t = np.linspace(0.0, 50.0, 5001)
    r = time_response(
        train, modes, [], t, initial_speed=modal_speed(train, modes, data["input"]["w0"])
    )
    kinetic = 0.5 * J @ r.station_speed**2
    elastic = 0.5 * np.sum(r.torque**2 / k, axis=0)
    values = data["values"]
    np.testing.assert_allclose(kinetic + elastic, values["E"], rtol=1e-10)
    np.testing.assert_allclose(J @ r.station_speed, values["H"], rtol=1e-10)
    rigid = values["H"] / J.sum()
    assert rigid == pytest.approx(values["rigid_speed"])
    vibration = kinetic + elastic - 0.5 * values["H"] ** 2 / J.sum()
    np.testing.assert_allclose(vibration, values["vibration_energy"], rtol=1e-10)
    np.testing.assert_allclose(J @ r.station_angle / J.sum(), rigid * t, atol=1e-9)


def test_modal_damping_of_a07_is_the_stated_one() -> None:
    data = load_case("A07")["input"]
    case = two_mass(data, data["c"])
    train, modes, _ = prepared(case)
    assert modal_damping(case, train, modes).ratio[1] == pytest.approx(data["zeta"], rel=1e-12)
