"""The torque of a rigid mesh is the limit of stiffer and stiffer elastic meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import ElementRow, StationRow, TorqueTimeRow
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.motor import motors_of
from engine.start.simulation import simulate
from engine.start.start_model import start_model
from engine.start.time_response import TimeResponse, time_response
from engine.start.trajectory import Trajectory
from tests.prescribed import held, torque_from_function
from tests.trains import RATED, geared, load, prepared

END = 0.5


def idler() -> Case:
    """Motor – shaft – gear, idler, pinion (all rigid) – shaft – load; loads on both sides."""
    return geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Gear", None, 10.0),
            StationRow("Idler", None, 2.0, 2.0),
            StationRow("Pinion", None, 1.0, 4.0),
            StationRow("Load", None, 3.0, 4.0),
        ),
        elements=(
            ElementRow("Shaft", "shaft", "Motor", "Gear", 3e6),
            ElementRow("First mesh", "gear mesh", "Gear", "Idler"),
            ElementRow("Second mesh", "gear mesh", "Idler", "Pinion"),
            ElementRow("Load shaft", "shaft", "Pinion", "Load", 2e5),
        ),
        load_torque=load(rated=RATED / 4.0)
        + load("Idler", rated=0.2 * RATED, curve=((0.0, 0.0), (1.0, 0.25))),
    )


def two_in_series() -> Case:
    """Two rigid meshes with a shaft between them, a branch on the middle shaft."""
    return geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Gear 1", None, 1.0, 2.0),
            StationRow("Gear 2", None, 4.0, 2.0),
            StationRow("Load", None, 2.0, 5.0),
            StationRow("Pump", None, 0.5, 5.0),
            StationRow("Fan", None, 3.0, 2.0),
        ),
        elements=(
            ElementRow("Mesh 1", "gear mesh", "Motor", "Gear 1"),
            ElementRow("Shaft", "shaft", "Gear 1", "Gear 2", 4e5),
            ElementRow("Mesh 2", "gear mesh", "Gear 2", "Load"),
            ElementRow("Pump shaft", "shaft", "Load", "Pump", 3e4),
            ElementRow("Fan shaft", "shaft", "Gear 2", "Fan", 1e5),
        ),
        load_torque=load(rated=RATED / 5.0) + load("Fan", rated=0.1 * RATED),
    )


TRAINS = {"geared": geared, "idler chain": idler, "two in series": two_in_series}
each_train = pytest.mark.parametrize("make", TRAINS.values(), ids=TRAINS.keys())


def with_meshes(case: Case, stiffness: float | None) -> Case:
    elements = tuple(
        replace(e, stiffness=stiffness) if e.kind == "gear mesh" else e for e in case.elements
    )
    return replace(case, elements=elements)


def damped(case: Case) -> Case:
    """Dampers on stations and beside shafts, so that the modes are coupled."""
    stations = tuple(
        replace(s, damping=c)
        for s, c in zip(case.stations, (3.0, 20.0, 1.0, 7.0, 2.0, 9.0), strict=False)
    )
    elements = tuple(
        replace(e, damping=2e-4 * e.stiffness) if e.kind == "shaft" else e for e in case.elements
    )
    return replace(case, stations=stations, elements=elements)


def by_element(case: Case, response: Trajectory | TimeResponse) -> np.ndarray:
    """Torques in the order of the elements (rigid meshes come last in a response)."""
    train = prepared(case)[0]
    assert sorted(response.output_element.tolist()) == list(range(len(train.elements)))
    return response.torque[np.argsort(response.output_element)]


def start_torque(case: Case) -> tuple[np.ndarray, np.ndarray]:
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = replace(
        start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-9, END), windows=()
    )
    run = simulate(model, 2.5e-4, "exponential", 1e9, END)
    return run.time, by_element(case, run)


@each_train
@pytest.mark.parametrize("with_dampers", [False, True])
def test_in_a_start(make, with_dampers: bool) -> None:
    """At rest the elastic mesh still rings; once that has faded the torques are the same."""
    case = damped(make()) if with_dampers else make()
    t, rigid = start_torque(case)
    late = t > 0.2
    size = np.max(np.abs(rigid), axis=1, keepdims=True)
    errors = []
    for k in (1e9, 1e11, 1e13):
        stiff = with_meshes(case, k)
        _, elastic = start_torque(stiff)
        errors.append(np.max(np.abs(elastic - rigid)[:, late] / size))
    assert errors[0] > 50.0 * errors[1] > 0.0
    assert errors[2] < 2e-5, errors


@each_train
@pytest.mark.parametrize("with_dampers", [False, True])
def test_under_a_smooth_prescribed_torque(make, with_dampers: bool) -> None:
    """Started gently, so that nothing rings: torque 1 − cos."""
    case = damped(make()) if with_dampers else make()
    t = np.linspace(0.0, 0.4, 1601)

    def response(c: Case) -> np.ndarray:
        train, modes, _ = prepared(c)
        gentle = torque_from_function(0, lambda x: 500.0 * (1.0 - np.cos(2.0 * np.pi * 20.0 * x)))
        r = time_response(train, modes, [gentle], t)
        assert r.coupled is with_dampers
        return by_element(c, r)

    rigid = response(case)
    size = np.max(np.abs(rigid), axis=1, keepdims=True)
    errors = [
        np.max(np.abs(response(with_meshes(case, k)) - rigid) / size) for k in (1e9, 1e10, 1e11)
    ]
    assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2] > 0.0
    assert errors[2] < 5e-4, errors


def test_held_torque_reaches_a_rigid_mesh_at_once() -> None:
    """At t = 0+ a rigid mesh passes on the inertia torque of its far side, before anything twists."""
    case = geared()
    train, modes, _ = prepared(case)
    r = time_response(
        train, modes, [held(1, np.zeros(1), np.array([900.0]))], np.array([0.0, 1e-6])
    )
    mesh = int(np.flatnonzero(r.output_element == 1)[0])
    far = 1.0 * 3.0**2  # pinion, referred to the gear
    assert r.torque[mesh, 0] == pytest.approx(900.0 * far / (20.0 + far), rel=1e-12)


def test_rate_of_the_recovered_torque() -> None:
    case = damped(
        geared(
            motor_torque=(),
            load_torque=(),
            torque_time=(TorqueTimeRow("Motor", 0.0, 1.0), TorqueTimeRow("Motor", 1.0, 1.0)),
        )
    )
    train, modes, _ = prepared(case)
    t = np.linspace(0.0, 0.1, 2001)
    wave = torque_from_function(1, lambda x: 300.0 * np.sin(150.0 * x))
    r = time_response(train, modes, [wave], t)
    slope = np.gradient(r.torque, t, axis=1, edge_order=2)
    np.testing.assert_allclose(
        r.torque_rate[:, 2:-2], slope[:, 2:-2], atol=2e-3 * np.max(np.abs(slope))
    )
