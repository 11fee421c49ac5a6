"""Wrong rows of tables Sections and SectionMaterials are found at their cell, with a sentence to act on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, ElementRow, SectionMaterialRow, SectionRow, StationRow

FIRST = SectionRow(
    "rotor",
    "journal",
    0.4,
    0.1,
    None,
    0.02,
    "bronze",
    0.01,
    0.5,
    keyway_width=0.02,
    keyway_depth=0.01,
)
SECOND = SectionRow("rotor", None, 0.3, 0.15)
BRONZE = SectionMaterialRow("bronze", 45e9, 8800.0, "data sheet")


def case(*rows: SectionRow, materials=(BRONZE,), kind="shaft", **element) -> CaseData:
    return CaseData(
        stations=(StationRow("left", inertia=10.0), StationRow("right", inertia=20.0)),
        elements=(ElementRow("rotor", kind, "left", "right", **element),),
        sections=rows,
        section_materials=materials,
    )


def first(**changes) -> CaseData:
    return case(replace(FIRST, **changes), SECOND)


def test_right_sections_pass() -> None:
    assert find_problems(case(FIRST, SECOND)) == ()
    assert find_problems(case(FIRST, SECOND, stiffness=1e6)) == ()
    massless = replace(case(FIRST, SECOND), stations=(StationRow("left"), StationRow("right")))
    assert find_problems(massless) == ()


@pytest.mark.parametrize(
    ("wrong", "place", "words"),
    [
        (first(element="roter"), ("Sections", 1, "Element"), ["'roter'", "Did you mean 'rotor'?"]),
        (first(element=None), ("Sections", 1, "Element"), ["blank", "table Elements"]),
        (case(SECOND, kind="gear mesh"), ("Sections", 1, "Element"), ["'rotor'", "a shaft, a coupling"]),
        (first(length=None), ("Sections", 1, "Length"), ["blank", "clear the whole row"]),
        (first(length=-1.0), ("Sections", 1, "Length"), ["found -1 m", "positive"]),
        (first(od=None), ("Sections", 1, "OD"), ["blank"]),
        (first(od=1e9), ("Sections", 1, "OD"), ["between 1e-6 and 1e6 m"]),
        (first(id=-0.01), ("Sections", 1, "ID"), ["zero or positive"]),
        (first(id=0.1), ("Sections", 1, "ID"), ["found 0.1 m", "below the outer diameter 0.1 m"]),
        (first(end_od=0.015, keyway_width=None, keyway_depth=None), ("Sections", 1, "ID"), ["found 0.02 m", "0.015 m"]),
        (
            first(end_od=0.31, keyway_width=None, keyway_depth=None, fillet=None),
            ("Sections", 1, "End OD"),
            ["found 0.31 m", "at most 0.5 of the length", "type it as one"],
        ),
        (first(end_od=-0.1), ("Sections", 1, "End OD"), ["found -0.1 m"]),
        (first(end_od=0.12), ("Sections", 1, "Keyway width"), ["tapered", "mean diameters"]),
        (
            first(end_od=0.145, keyway_width=None, keyway_depth=None),
            ("Sections", 1, "Fillet"),
            ["height of the step", "0.0025 m"],
        ),
        (first(material="brass"), ("Sections", 1, "Material"), ["'brass'", "SectionMaterials"]),
        (first(fillet=0.03), ("Sections", 1, "Fillet"), ["0.03 m", "height of the step", "0.025 m", "the diameters beside it"]),
        (first(fillet=-0.03), ("Sections", 1, "Fillet"), ["zero or positive"]),
        (case(FIRST, replace(SECOND, od=0.1)), ("Sections", 1, "Fillet"), ["same diameter", "next row"]),
        (case(SECOND, FIRST), ("Sections", 2, "Fillet"), ["last section", "next row"]),
        (first(penetration=0.0), ("Sections", 1, "Penetration"), ["above 0", "one third"]),
        (first(penetration=33.0), ("Sections", 1, "Penetration"), ["found 33", "at most 1 (100 %)"]),
        (first(keyway_width=None), ("Sections", 1, "Keyway width"), ["blank", "Type both"]),
        (first(keyway_depth=None), ("Sections", 1, "Keyway depth"), ["blank", "clear both"]),
        (first(keyway_width=0.05), ("Sections", 1, "Keyway width"), ["0.35 of the outer diameter", "0.035 m"]),
        (first(keyway_depth=0.03), ("Sections", 1, "Keyway depth"), ["0.2 of the outer diameter", "0.02 m"]),
        (first(id=0.085), ("Sections", 1, "Keyway depth"), ["less than the wall", "0.0075 m"]),
        (first(section="2"), ("Sections", 2, "Section"), ["'2'", "row 1 has it", "Rename"]),
        (case(FIRST, SECOND, od=0.1), ("Elements", 1, "OD"), ["found 0.1 m", "table Sections", "clear it"]),
        (case(FIRST, SECOND, density=7850.0), ("Elements", 1, "Density"), ["7850 kg/m³", "table Sections"]),
        (case(FIRST, SECOND, materials=(BRONZE, BRONZE)), ("SectionMaterials", 2, "Material"), ["row 1"]),
        (
            case(FIRST, SECOND, materials=(replace(BRONZE, density=None),)),
            ("SectionMaterials", 1, "Density"),
            ["blank", "clear the whole row"],
        ),
        (
            case(FIRST, SECOND, materials=(replace(BRONZE, density=-1.0),)),
            ("SectionMaterials", 1, "Density"),
            ["found -1 kg/m³", "no inertia"],
        ),
        (
            case(FIRST, SECOND, materials=(replace(BRONZE, shear_modulus=0.0),)),
            ("SectionMaterials", 1, "Shear modulus"),
            ["found 0 Pa", "positive"],
        ),
        (case(), ("Elements", 1, "Stiffness"), ["table Sections"]),
    ],
)  # fmt: skip
def test_wrong_sections_are_found_at_their_cell(wrong, place, words) -> None:
    problems = find_problems(wrong)
    assert [(p.table, p.row, p.column) for p in problems] == [place]
    for word in words:
        assert word in problems[0].message
