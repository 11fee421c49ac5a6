"""Steels of the library: strengths as printed in their sources, taken where a row only names the steel."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from addin.calculation.audit import Stamp, audit_rows
from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, MaterialRow, SectionRow
from engine.case.steels import STEELS, steel_named
from engine.model.sections import sections_of
from engine.run import run
from tests.sample_case import sample_case, with_limits

#: UTS and yield as printed. ksi: ASTM A434-04, Table 1; MPa: Saarstahl's and Tata Steel NZ's data sheets.
PRINTED = {
    "AISI 1045 hot rolled": (570.0, 300.0, 1e6),
    "C45 +N": (560.0, 275.0, 1e6),
    "AISI 4140 class BC": (110.0, 85.0, 6894757.293168361),
    "AISI 4340 class BD": (135.0, 105.0, 6894757.293168361),
    "42CrMo4 +QT 160": (800.0, 550.0, 1e6),
    "42CrMo4 +QT 250": (750.0, 500.0, 1e6),
}


def test_the_library_is_what_its_sources_print() -> None:
    assert {s.name for s in STEELS} == PRINTED.keys()
    for steel in STEELS:
        uts, strength, unit = PRINTED[steel.name]
        assert (steel.uts / unit, steel.yield_ / unit) == pytest.approx((uts, strength), rel=1e-12)
        assert steel.source


def test_a_row_that_only_names_a_steel_has_its_strengths() -> None:
    row = MaterialRow(" 42crmo4 +qt  250")
    assert (row.uts, row.yield_) == (750e6, 500e6)
    assert row.library_steel is steel_named("42CrMo4 +QT 250")


@pytest.mark.parametrize(
    "typed", [{"uts": 900e6}, {"yield_": 300e6}, {"uts": 900e6, "yield_": 700e6}]
)
def test_what_is_typed_wins_and_nothing_is_mixed(typed: dict[str, float]) -> None:
    row = MaterialRow("42CrMo4 +QT 250", **typed)
    assert {k: v for k, v in vars(row).items() if v is not None} == {
        "material": row.material,
        **typed,
    }
    assert row.library_steel is None


def test_other_names_stay_blank() -> None:
    assert (MaterialRow("42CrMo4").uts, MaterialRow(None).uts) == (None, None)


def test_the_allowable_stress_is_that_of_the_steel_and_audit_says_whence() -> None:
    case = with_limits(sample_case("modified"))
    steel = replace(MaterialRow("C45 +N"), endurance=case.materials[0].endurance, basis="torsion")
    elements = tuple(replace(e, material="C45 +N" if e.material else None) for e in case.elements)
    points = tuple(replace(p, material="C45 +N") for p in case.sn_points)
    named = Case(
        **(vars(case) | {"materials": (steel,), "elements": elements, "sn_points": points})
    )
    results = run(named)
    (row,) = [v for v in results.verdicts if v.check.startswith("Steady-state stress")]
    assert row.limit == pytest.approx(560e6 / 25.0)
    audit = {r["item"]: r["value"] for r in audit_rows(results, Stamp.now(), "", (), {})}
    assert "UTS 560 MPa (81.22 ksi), yield 275 MPa" in audit["Strength of C45 +N"]
    assert "EN 10083-2" in audit["Strength of C45 +N"]


def test_sections_may_be_of_a_steel_of_the_library() -> None:
    rows = tuple(
        SectionRow(element="Motor shaft", length=1.0, od=0.25, material=name)
        for name in (None, "AISI 4340 class BD")
    )
    case = sample_case("modified")
    elements = tuple(
        replace(e, stiffness=None) if e.element == "Motor shaft" else e for e in case.elements
    )
    both = Case(**(vars(case) | {"sections": rows, "elements": elements}))
    plain, named = sections_of(both)["Motor shaft"]
    assert plain.stiffness == named.stiffness
    unknown = replace(rows[1], material="AISI 4340")
    (problem,) = find_problems(CaseData(**(vars(both) | {"sections": (unknown,)})))
    assert problem.column == "Material"


def test_the_page_lists_the_library() -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "theory-fatigue.md").read_text("utf-8")
    for name, (uts, strength, unit) in PRINTED.items():
        assert f"| {name} | {uts:g}, {strength:g} {'MPa' if unit == 1e6 else 'ksi'} |" in page
