"""Stepped shafts in cells: stiffness and inertia from a range with the rows of table Sections."""

from __future__ import annotations

import math

import pytest

from addin.worksheet.registry import FunctionError, call
from engine.model.sections import step_length

HEADERS = ["Element", "Section", "Length", "OD", "Fillet", "Penetration"]
UNITS = [None, None, "mm", "mm", "mm", "%"]
ROWS = [
    ["rotor", "hub", 90.0, 100.0, None, 100.0 / 3.0],
    ["rotor", None, 500.0, 100.0, None, None],
    ["Rotor 2", None, 0.5e3, 150.0, None, None],
]


def test_stiffness_and_inertia_of_each_section() -> None:
    found = call("TV_SECTIONS", [[UNITS, HEADERS, *ROWS]])
    assert found[0] == [
        "Element", "Section", "Effective length [mm]", "Stiffness [N*m/rad]", "Inertia [kg*m^2]",
    ]  # fmt: skip
    area = math.pi * 0.1**4 / 32.0
    hub, shaft, whole, other, _ = found[1:]
    assert hub[:2] == ["rotor", "hub"]
    assert hub[2:] == pytest.approx([30.0, 79.3e9 * area / 0.03, 7850.0 * area * 0.09], rel=1e-12)
    assert shaft[2:] == pytest.approx([500.0, 79.3e9 * area / 0.5, 7850.0 * area * 0.5], rel=1e-12)
    assert whole[:3] == ["rotor", "whole", None]
    assert 1.0 / whole[3] == pytest.approx(1.0 / hub[3] + 1.0 / shaft[3], rel=1e-12)
    assert other[:2] == ["Rotor 2", "1"]


def test_a_step_and_a_material_in_other_units() -> None:
    rows = [["rotor", 10.0, 4.0, "bronze"], ["rotor", 12.0, 6.0, "bronze"]]
    block = [[None, "in", "in", None], ["Element", "Length", "OD", "Material"], *rows]
    bronze = [
        [None, "psi", "lb/in^3"],
        ["Material", "Shear modulus", "Density"],
        ["bronze", 6.5e6, 0.32],
    ]
    *_, whole = call("TV_SECTIONS", [block, bronze, "US"])
    added = 4.0 * step_length(1.5)
    twist = (10.0 + added) / (math.pi * 4.0**4 / 32.0) + (12.0 - added) / (math.pi * 6.0**4 / 32.0)
    assert whole[3] == pytest.approx(6.5e6 / twist, rel=1e-9)
    weight = 0.32 * math.pi / 32.0 * (10.0 * 4.0**4 + 12.0 * 6.0**4)  # lb in²
    assert whole[4] == pytest.approx(weight / 144.0, rel=1e-9)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (["rotor", None, 90.0, -1.0, None, None], ["OD", "found -1 mm"]),
        (["rotor", None, None, 100.0, None, None], ["Length", "blank"]),
        (["rotor", None, 90.0, 100.0, 60.0, None], ["Fillet", "last section"]),
    ],
)
def test_wrong_rows_give_their_sentence(row, words) -> None:
    with pytest.raises(FunctionError) as caught:
        call("TV_SECTIONS", [[UNITS, HEADERS, row]])
    for word in words:
        assert word in str(caught.value)
