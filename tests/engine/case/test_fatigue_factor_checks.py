"""Wrong rows of table FatigueFactors are found at their cell, with a sentence to act on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.checks.find_problems import find_problems
from engine.case.data import (
    CaseData,
    ElementRow,
    FatigueFactorRow,
    MaterialRow,
    SectionRow,
    SNPointRow,
    StationRow,
)

STEEL = MaterialRow("steel", uts=700e6, endurance=150e6)
SHAFT = ElementRow(
    "shaft", "shaft", "left", "right", stiffness=1e6, stress_diameter=0.1, material="steel"
)
FILLET = FatigueFactorRow("shaft", "fillet", 0.005, 0.12, "Neuber", "machined", "by diameter", 0.99)
KEYWAY = FatigueFactorRow("shaft", "keyway", 0.002)


def case(*rows: FatigueFactorRow, shaft=SHAFT, steel=STEEL, sections=(), **more) -> CaseData:
    return CaseData(
        stations=(StationRow("left", inertia=10.0), StationRow("right", inertia=20.0)),
        elements=(shaft,),
        materials=(steel,),
        sn_points=(SNPointRow("steel", 1e3, 400e6), SNPointRow("steel", 1e6, 150e6)),
        fatigue_factors=rows,
        sections=sections,
        **more,
    )


def fillet(**changes) -> CaseData:
    return case(replace(FILLET, **changes))


def step(*fillets: float | None) -> tuple[SectionRow, ...]:
    """Sections of 100 and 120 mm in turn."""
    radii = (*fillets, None)
    return tuple(
        SectionRow("shaft", None, 0.2, (0.1, 0.12)[i % 2], fillet=r) for i, r in enumerate(radii)
    )


def stepped(*fillets: float | None) -> CaseData:
    shaft = replace(SHAFT, stiffness=None)
    row = FatigueFactorRow("shaft", "fillet")
    return case(row, shaft=shaft, sections=step(*fillets))


def test_right_rows_pass() -> None:
    assert find_problems(case(FILLET)) == ()
    assert find_problems(case(KEYWAY)) == ()
    assert find_problems(stepped(0.005)) == ()
    assert find_problems(stepped(0.005, 0.005)) == ()  # both steps are the same
    assert find_problems(case(FatigueFactorRow("shaft", surface=0.8, size=1.0))) == ()
    assert find_problems(case(mean_stress="Goodman")) == ()


@pytest.mark.parametrize(
    ("wrong", "column", "words"),
    [
        (fillet(element="shift"), "Element", ["'shift'", "Did you mean 'shaft'?"]),
        (case(FILLET, FILLET), "Element", ["row 1"]),
        (case(FILLET, shaft=replace(SHAFT, stress_diameter=None)), "Element", ["Stress diameter"]),
        (fillet(notch="groove"), "Notch", ["fillet or keyway"]),
        (case(FILLET, shaft=replace(SHAFT, scf=1.5)), "Notch", ["SCF", "clear one of them"]),
        (case(FILLET, shaft=replace(SHAFT, stress_bore=0.02)), "Notch", ["solid shafts", "as SCF"]),
        (fillet(shoulder_diameter=None), "Shoulder diameter", ["blank", "Table Sections has none"]),
        (fillet(shoulder_diameter=0.1), "Shoulder diameter", ["above the Stress diameter 0.1 m"]),
        (fillet(notch_radius=None), "Notch radius", ["blank"]),
        (fillet(notch_radius=0.0024), "Notch radius", ["from 0.0025 m to 0.04 m", "0.25 to 4 of the height"]),
        (fillet(notch_radius=0.041), "Notch radius", ["from 0.0025 m to 0.04 m"]),
        (stepped(0.005, 0.004), "Shoulder diameter", ["2 different steps"]),
        (stepped(None), "Notch radius", ["blank"]),
        (case(replace(KEYWAY, notch_radius=None)), "Notch radius", ["bottom of the keyway"]),
        (case(replace(KEYWAY, notch_radius=0.0004)), "Notch radius", ["from 0.0005 m to 0.007 m"]),
        (case(KEYWAY, shaft=replace(SHAFT, stress_diameter=0.17)), "Notch", ["6.5 in"]),
        (fillet(notch_sensitivity=1.2), "Notch sensitivity", ["from 0 to 1"]),
        (fillet(notch_sensitivity="Heywood"), "Notch sensitivity", ["Neuber, Peterson"]),
        (case(FatigueFactorRow("shaft", notch_sensitivity="Neuber")), "Notch radius", ["depends on it"]),
        (case(FILLET, steel=replace(STEEL, uts=None)), "Notch sensitivity", ["no UTS"]),
        (case(FILLET, steel=replace(STEEL, uts=1600e6)), "Notch sensitivity", ["3.44738e+08 Pa to 1.51685e+09 Pa"]),
        (fillet(surface=1.2), "Surface", ["at most 1"]),
        (fillet(surface="polished"), "Surface", ["ground, machined, hot-rolled, as-forged"]),
        (fillet(size="large"), "Size", ["by diameter"]),
        (case(FatigueFactorRow("shaft", size="by diameter"), shaft=replace(SHAFT, stress_diameter=0.3)), "Size", ["0.254 m", "type one"]),
        (fillet(reliability=0.98), "Reliability", ["50, 90, 95, 99, 99.9"]),
        (fillet(reliability=99.0), "Reliability", ["at most 1 (100 %)", "0.99"]),
    ],
)  # fmt: skip
def test_a_wrong_row_is_named(wrong: CaseData, column: str, words: list[str]) -> None:
    problems = [p for p in find_problems(wrong) if p.table == "FatigueFactors"]
    found = next((p for p in problems if p.column == column), None)
    assert found is not None, problems
    for word in words:
        assert word in f"{found.message} {found.allowed}"


def test_a_keyway_deeper_than_the_charts_is_refused() -> None:
    shaft = replace(SHAFT, stiffness=None)
    for depth, refused in ((0.012, False), (0.014, True)):
        keyed = (SectionRow("shaft", None, 0.2, 0.1, keyway_width=0.028, keyway_depth=depth),)
        problems = find_problems(case(KEYWAY, shaft=shaft, sections=keyed))
        assert [p.column for p in problems] == (["Notch"] if refused else [])


def test_goodman_needs_the_ultimate_strength() -> None:
    (problem,) = find_problems(case(steel=replace(STEEL, uts=None), mean_stress="Goodman"))
    assert (problem.table, problem.column) == ("Materials", "UTS")
    (wrong,) = find_problems(case(mean_stress="Gerber"))
    assert (wrong.table, wrong.column) == ("Case", "MeanStress")
