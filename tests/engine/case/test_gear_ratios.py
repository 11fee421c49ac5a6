"""Speed ratios of stations follow from teeth, pitch radii or one ratio on the mesh where they are blank."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import cases, example_count

from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, ElementRow, MeshRow, MotorTorqueRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of

STATIONS = ("motor", "gear", "pinion", "compressor", "idler", "pump")
ELEMENTS = (
    ElementRow("LS shaft", "shaft", "motor", "gear", 2e6),
    ElementRow("mesh", "gear mesh", "gear", "pinion"),
    ElementRow("HS shaft", "shaft", "pinion", "compressor", 1e5),
    ElementRow("second mesh", "gear mesh", "pinion", "idler"),
    ElementRow("pump shaft", "coupling", "idler", "pump", 1e5),
)


def train(*meshes, **typed):
    """A train of three shafts, whose stations are blank but for those named."""
    rows = tuple(StationRow(name, None, 1.0, typed.get(name)) for name in STATIONS)
    return CaseData(stations=rows, elements=ELEMENTS, meshes=meshes)


@pytest.mark.parametrize(
    ("mesh", "ratio"),
    [
        (MeshRow("mesh", teeth_drive=143, teeth_driven=29), 143 / 29),
        (MeshRow("mesh", pitch_radius_drive=0.42, pitch_radius_driven=0.075), 0.42 / 0.075),
        (MeshRow("mesh", speed_ratio=5.6), 5.6),
        # teeth are exact, radii as the drawing rounds them
        (
            MeshRow("mesh", None, 0.4931, 0.1, teeth_drive=143, teeth_driven=29),
            143 / 29,
        ),
    ],
)
def test_what_a_gear_states_fills_the_stations_behind_it(mesh, ratio):
    case = train(mesh, MeshRow("second mesh", teeth_drive=20, teeth_driven=50))
    assert find_problems(case) == ()
    slow, fast, last = 1.0, ratio, ratio * (20 / 50)
    assert list(case.speed_ratios.values()) == [slow, slow, fast, fast, last, last]


def test_a_typed_ratio_counts_for_its_shaft_and_is_checked():
    mesh = MeshRow("mesh", teeth_drive=143, teeth_driven=29)
    case = train(mesh, compressor=4.931)
    assert find_problems(case) == ()
    assert case.speed_ratios["pinion"] == 4.931
    (problem,) = find_problems(train(mesh, compressor=5.6))
    assert (problem.table, problem.row, problem.column) == ("Meshes", 1, "Teeth driven")
    assert "4.93103" in problem.message
    assert "make 5.6" in problem.message


def test_the_motor_is_the_reference_wherever_it_stands():
    mesh = MeshRow("mesh", speed_ratio=4.0)
    case = replace(train(mesh), motor_torque=(MotorTorqueRow("compressor", 0.0, 1.0),))
    assert case.speed_ratios["pinion"] == 1.0
    assert case.speed_ratios["motor"] == 0.25


def test_without_anything_stated_a_blank_is_one():
    assert set(train().speed_ratios.values()) == {1.0}
    # behind a mesh that states nothing a blank is 1, whatever stands before the mesh
    assert train(gear=2.0).speed_ratios["pinion"] == 1.0


@example_count(50)
@given(cases(stations=(2, 20), decades=4.0), st.data())
def test_filled_and_typed_ratios_make_one_train(case, data):
    """Stations left blank, with the ratio on each mesh, have the frequencies of the typed train."""
    typed = case.speed_ratios
    meshes = tuple(
        MeshRow(e.element, speed_ratio=typed[e.to] / typed[e.from_])
        for e in case.elements
        if e.kind == "gear mesh"
    )
    kept = data.draw(st.sets(st.sampled_from([s.station for s in case.stations])))
    stations = tuple(
        s if s.station in kept else replace(s, speed_ratio=None) for s in case.stations
    )
    blank = Case(**(vars(case) | {"stations": stations, "meshes": meshes}))
    # the first station is the reference, and 1 in the typed train too
    assert np.allclose(
        list(blank.speed_ratios.values()), list(typed.values()), rtol=1e-12, atol=0.0
    )
    one, other = (modes_of(build_train(c)).omega for c in (case, blank))
    assert np.allclose(one, other, rtol=1e-9, atol=1e-9 * max(one.max(), 1.0))
