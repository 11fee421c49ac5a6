"""Files that ROSS wrote and openTorsion reads, with the frequencies those programs themselves calculate of them.

`by_ross.py` and `by_opentorsion.py` ran in environments with ROSS 3.1.0 and openTorsion 0.3.2; `write_exported.py` made what they
loaded of ours. Both programs have the inertia of a shaft at its two ends, consistently (1/3, 1/6), where it is distributed here.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from exchanged import FILES, geared_train, imported, row_of_stations, shaft_of_sections, stored
from scipy.linalg import eigh
from write_exported import EXPORTED

from addin.exchange.foreign import ForeignError
from addin.exchange.opentorsion import opentorsion_of, read_opentorsion
from addin.exchange.read_train import checked_train, read_train
from addin.exchange.ross import ross_of
from engine.case.case import Case
from engine.case.data import SectionRow
from engine.model.build_train import build_train
from engine.model.links import link_of
from engine.model.modes import modes_of
from engine.model.sections import sections_of, series_stiffness

ROSS, OPENTORSION = stored("ross_frequencies.json"), stored("opentorsion_frequencies.json")


def text(name: str) -> str:
    return (FILES / name).read_text(encoding="utf-8")


def own(case: Case) -> np.ndarray:
    """Frequencies as the product calculates them, shafts in 16 pieces. [Hz]"""
    pieces = {str(e.element): 16 for e in case.elements}
    return modes_of(build_train(case, pieces)).omega / (2.0 * math.pi)


def as_finite_elements(case: Case) -> np.ndarray:
    """Frequencies of the same rows with consistent shaft inertias, as both programs have them. [Hz]"""
    index = {s.station: i for i, s in enumerate(case.stations)}
    mass = np.diag([s.inertia or 0.0 for s in case.stations])
    stiffness, constraint = np.zeros_like(mass), np.eye(len(index))
    for e in case.elements:
        ends = [index[e.from_], index[e.to]]
        if e.kind == "gear mesh":
            ratio = case.speed_ratios[e.to] / case.speed_ratios[e.from_]
            behind = [
                i for s, i in index.items() if case.speed_ratios[s] == case.speed_ratios[e.to]
            ]
            constraint[behind] *= ratio
            constraint[:, ends[0]] += constraint[:, ends[1]]
            constraint = np.delete(constraint, ends[1], axis=1)
            continue
        link = link_of(e, None)
        stiffness[np.ix_(ends, ends)] += (link.stiffness or 0.0) * np.array([[1, -1], [-1, 1]])
        mass[np.ix_(ends, ends)] += link.inertia / 6.0 * np.array([[2, 1], [1, 2]])
    m, k = (constraint.T @ matrix @ constraint for matrix in (mass, stiffness))
    return np.sqrt(np.abs(eigh(k, m, eigvals_only=True))) / (2.0 * math.pi)


def elastic(frequencies: np.ndarray | list[float]) -> np.ndarray:
    return np.asarray(frequencies)[1:]


def test_a_rotor_of_ross_has_the_frequencies_that_ross_finds():
    case = imported(text("ross_rotor.toml"))
    expected = elastic(ROSS["ross_rotor"])
    assert elastic(as_finite_elements(case)) == pytest.approx(expected, rel=1e-6)
    # the lowest, where short elements hold nearly no inertia, distributed as well
    assert elastic(own(case))[:1] == pytest.approx(expected[:1], rel=1e-6)


def test_what_is_read_of_a_rotor_and_what_is_not():
    train = read_train(text("ross_rotor.toml"))
    notes = " ".join(train.notes)
    for words in (
        "15 ShaftElement, 1 CouplingElement, 2 DiskElement",
        "4 BearingElement, 1 PointMass",
        "2 shaft elements lie in layers",
        "Not read: masses",
    ):
        assert words in notes
    case = checked_train(train).case()
    inertia = {s.station: s.inertia for s in case.stations}
    assert (inertia["Motor"], inertia["Fan"]) == (35.0, 55.0)
    assert (inertia["Node 8"], inertia["Node 9"], inertia["Node 0"]) == (0.3, 0.2, None)
    (coupling,) = (e for e in case.elements if e.kind == "coupling")
    assert (coupling.from_, coupling.to) == ("Node 8", "Node 9")
    assert (coupling.stiffness, coupling.damping) == (4e5, 12.0)


def test_two_geared_rotors_of_ross_are_joined_by_their_teeth():
    train = read_train(text("ross_geared.toml"))
    case = checked_train(train).case()
    assert any("are taken to mesh, rigidly" in note for note in train.notes)
    (mesh,) = case.meshes
    assert (mesh.teeth_drive, mesh.teeth_driven) == (40, 20)
    assert (mesh.pitch_radius_drive, mesh.pitch_radius_driven) == pytest.approx((0.1, 0.05))
    assert set(case.speed_ratios.values()) == {1.0, 2.0}
    # two discs of 0.33 and the gears on shafts, by the referred two-line train
    assert elastic(as_finite_elements(case))[0] == pytest.approx(elastic(own(case))[0], rel=2e-3)


def test_a_system_of_opentorsion_has_the_frequencies_that_it_finds():
    case = imported(text("tors_system.json"))
    expected = elastic(OPENTORSION["tors_system"])
    assert elastic(as_finite_elements(case)) == pytest.approx(expected, rel=1e-6)
    assert case.speed_ratios["Armature"] == 143 / 29


@pytest.mark.parametrize("name", EXPORTED)
def test_the_stored_files_are_what_is_exported_today(name):
    assert json.loads(json.dumps(EXPORTED[name]())) == stored(name)


def test_the_programs_find_our_frequencies_in_what_they_load():
    line, geared = row_of_stations(), geared_train()
    for case, found in (
        (line, ROSS["exported_to_ross"]),
        (geared, OPENTORSION["exported_to_opentorsion"]),
    ):
        assert elastic(as_finite_elements(case)) == pytest.approx(elastic(found), rel=1e-6)
        # one short shaft has inertia: 2e-6 of it is what its distribution changes
        assert elastic(own(case))[:2] == pytest.approx(elastic(found)[:2], rel=1e-6)


def test_ross_finds_our_frequency_of_a_shaft_of_sections():
    """It has one linear element a cylinder: 6e-5 too much in the first mode."""
    found = elastic(ROSS["exported_sections_to_ross"])[0]
    assert found == pytest.approx(elastic(own(shaft_of_sections()))[0], rel=1e-4)


def test_what_ross_holds_comes_back():
    case = row_of_stations()
    back = imported(json.dumps(ross_of(case)[0]))
    undamped = [s.inertia for s in case.stations]
    assert [s.station for s in back.stations] == [s.station for s in case.stations]
    assert [s.inertia for s in back.stations] == undamped
    assert set(back.elements) == set(case.elements)


def test_what_opentorsion_holds_comes_back():
    case = geared_train()
    content, notes = opentorsion_of(case, "geared")
    back = imported(json.dumps(content))
    assert back.stations == case.stations
    assert back.speed_ratios == case.speed_ratios
    (mesh,) = back.meshes
    assert (mesh.teeth_drive, mesh.teeth_driven) == (143, 29)
    lumped = [e for e in case.elements if e.kind != "gear mesh" and not e.density]
    assert [(e.element, e.stiffness, e.damping) for e in lumped] == [
        (e.element, e.stiffness, e.damping)
        for e in back.elements
        if e.element in {e.element for e in lumped}
    ]
    (shaft,) = (link_of(e, None) for e in back.elements if e.element == "Shaft")
    (typed,) = (link_of(e, None) for e in case.elements if e.element == "Shaft")
    assert (shaft.stiffness, shaft.inertia) == pytest.approx(
        (typed.stiffness, typed.inertia), rel=1e-12
    )
    assert any("'Shaft' is written as a solid cylinder of 80 GPa" in note for note in notes)


def test_what_they_cannot_hold_is_said():
    with pytest.raises(ForeignError, match="'Gear' is a gear mesh"):
        ross_of(geared_train())
    line = row_of_stations()
    branched = Case(
        **vars(line)
        | {
            "stations": (*line.stations, line.stations[0].__class__("Pump", None, 1.0)),
            "elements": (
                *line.elements,
                line.elements[0].__class__("Branch", "shaft", "Hub", "Pump", 1e5),
            ),
        }
    )
    for write in (ross_of, lambda case: opentorsion_of(case, "")):
        with pytest.raises(ForeignError, match="more than two elements meet at 'Hub'"):
            write(branched)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("inertia", None), "component 'Rotor', element 'Hub': inertia is missing"),
        (("type", "Flywheel"), "type Flywheel is not known"),
        (("inertia", -5.0), "component 'Rotor', element 'Hub'"),
    ],
)
def test_a_wrong_element_is_named_by_its_place(change, words):
    content = stored("tors_system.json")
    content["components"][0]["elements"][0][change[0]] = change[1]
    messages = [p.message for p in checked_train(read_opentorsion(content)).problems]
    if change[1] == -5.0:
        assert any(m.startswith("Node 0 (Stations, Inertia): found -5") for m in messages)
    else:
        assert any(words.casefold() in m.casefold() for m in messages)


@pytest.mark.parametrize(
    ("structure", "words"),
    [
        ([["Rotor.Main shaft", "Gearbox.Bull"]], "2 components of the system follow no other"),
        (
            [["Rotor.Main shaft", "Gearbox.Bull"], ["Rotor.Main shaft", "Generator.Disk"]],
            "two components follow element 'Rotor.Main shaft'",
        ),
        ([["Rotor.Main shaft", "Nobody.Bull"], ["Gearbox.Pinion", "Generator.Disk"]], "component"),
        (7 * [["Gearbox.Pinion"]], "no pair"),
    ],
)
def test_a_structure_that_is_no_chain(structure, words):
    with pytest.raises(ForeignError, match=words):
        read_opentorsion(stored("tors_system.json") | {"structure": structure})


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "is not JSON"),
        ('["a"\n', "is not TOML"),
        ("{}", "neither a rotor"),
        ('{"stations": []}', "this is a case JSON"),
        ("hello", "no table of a train"),
    ],
)
def test_a_file_that_is_no_train(content, words):
    with pytest.raises(ForeignError, match=words):
        read_train(content)


def test_sections_are_shafts_of_ross_and_come_back_as_cylinders():
    """Where nothing is stepped, keyed or held, the frequencies stay; else a note says what is missing."""
    line = row_of_stations()
    ends = [s.station for s in line.stations[:2]]
    stations = tuple(s for s in line.stations[:2])
    element = line.elements[0].__class__("Rotor", "shaft", ends[1], ends[0])  # against the row
    taper = SectionRow("Rotor", "cone", 0.4, 0.1, 0.12, 0.02)
    plain = Case(
        stations=stations,
        elements=(element,),
        sections=(taper, SectionRow("Rotor", None, 0.3, 0.12, id=0.02)),
    )
    content, notes = ross_of(plain)
    assert not any("cylinders" in note for note in notes)
    shafts = [e for key, e in content.items() if key.startswith("ShaftElement")]
    # from the first station on: the cylinder, then the cone from its To end
    assert [(e["n"], e["odl"], e["odr"], e["L"]) for e in shafts] == [
        (0, 0.12, 0.12, 0.3),
        (1, 0.12, 0.1, 0.4),
    ]
    back = imported(json.dumps(content))
    found, sections = sections_of(back)["Rotor cone"], sections_of(plain)["Rotor"]
    cylinder = link_of(back.elements[0], None)
    assert 1.0 / cylinder.stiffness + 1.0 / series_stiffness(found) == pytest.approx(
        1.0 / series_stiffness(sections), rel=1e-12
    )
    assert cylinder.inertia + found[0].inertia == pytest.approx(
        sum(s.inertia for s in sections), rel=1e-12
    )
    stepped = replace(plain.sections[1], penetration=1 / 3)
    *_, (first, *_) = ross_of(
        Case(stations=stations, elements=(element,), sections=(taper, stepped))
    )
    assert "'Rotor' are written as cylinders" in first
    assert "softer" in first
