"""A changed case says exactly what was asked, and nothing else of it has changed."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest

from engine.case.case import Case
from engine.case.data import CaseData
from engine.case.study_inputs import SCATTERED, TUNED
from engine.model.build_train import build_train
from engine.studies.variation import Change, names_with, nominal_value, refusal, varied_case
from tests.sample_case import sample_case


@pytest.fixture(scope="module")
def case() -> CaseData:
    return sample_case("proposed")


def _differing_tables(a: CaseData, b: CaseData) -> set[str]:
    return {f.name for f in fields(CaseData) if getattr(a, f.name) != getattr(b, f.name)}


def test_a_factor_of_one_changes_nothing(case: CaseData) -> None:
    for quantity in dict.fromkeys((*TUNED, *SCATTERED)):
        for name in names_with(case, quantity):
            assert (
                _differing_tables(case, varied_case(case, [Change(quantity, name, 1.0)])) == set()
            )


@pytest.mark.parametrize("relative", [True, False])
def test_stiffness_of_one_coupling(case: CaseData, relative: bool) -> None:
    before = nominal_value(case, "LS coupling", "stiffness")
    assert before is not None
    value = 0.5 if relative else 0.5 * before
    new = varied_case(case, [Change("stiffness", "LS coupling", value, relative)])
    assert _differing_tables(case, new) == {"elements"}
    for old_row, new_row in zip(case.elements, new.elements, strict=True):
        if old_row.element == "LS coupling":
            assert new_row == replace(old_row, stiffness=0.5 * before)
        else:
            assert new_row is old_row


def test_stiffness_from_geometry_keeps_the_distributed_inertia() -> None:
    """A factor on a stiffness that follows from a diameter does not touch OD, so the mass stays."""
    base = sample_case("proposed")
    i = next(k for k, e in enumerate(base.elements) if e.kind == "shaft")
    shaft = replace(
        base.elements[i], stiffness=None, od=0.3, length=1.0, shear_modulus=8e10, density=7850.0
    )
    case = replace(
        CaseData(**vars(base)), elements=(*base.elements[:i], shaft, *base.elements[i + 1 :])
    )
    new = varied_case(case, [Change("stiffness", str(shaft.element), 1.1)])
    old_train, new_train = build_train(case), build_train(new)
    assert new_train.inertia == pytest.approx(old_train.inertia, rel=1e-15)
    ratio = new_train.stiffness / old_train.stiffness
    assert sorted(ratio)[-1] == pytest.approx(1.1, rel=1e-14)
    assert sorted(ratio)[:-1] == pytest.approx([1.0] * (len(ratio) - 1), rel=1e-15)


def test_a_diameter_changes_stiffness_by_its_fourth_power_and_the_judged_section_in_proportion() -> (
    None
):
    base = sample_case("proposed")
    i = next(k for k, e in enumerate(base.elements) if e.kind == "shaft")
    shaft = replace(
        base.elements[i], stiffness=None, od=0.3, length=1.0, shear_modulus=8e10,
        stress_diameter=0.25,
    )  # fmt: skip
    case = replace(
        CaseData(**vars(base)), elements=(*base.elements[:i], shaft, *base.elements[i + 1 :])
    )
    new = varied_case(case, [Change("diameter", str(shaft.element), 1.2)]).elements[i]
    assert new.od == pytest.approx(0.36)
    assert new.stress_diameter == pytest.approx(0.30)
    before = nominal_value(case, str(shaft.element), "stiffness")
    after = nominal_value(replace(case, elements=(new,)), str(shaft.element), "stiffness")
    assert before is not None
    assert after == pytest.approx(before * 1.2**4, rel=1e-12)


def test_the_whole_sn_line_moves(case: CaseData) -> None:
    (name,) = names_with(case, "S-N line")[:1]
    new = varied_case(case, [Change("S-N line", name, 0.9)])
    assert _differing_tables(case, new) == {"sn_points", "materials"}
    for old, row in zip(case.sn_points, new.sn_points, strict=True):
        assert old.stress is not None
        assert row.stress == (0.9 * old.stress if old.material == name else old.stress)


@pytest.mark.parametrize(
    ("name", "quantity", "says"),
    [
        ("LS couplin", "stiffness", "no element 'LS couplin'"),
        ("LS coupling", "backlash", "no Backlash"),
        ("LS coupling", "diameter", "does not follow from its diameter"),
        ("LS coupling", "inertia", "no station 'LS coupling'"),
        ("Bull gear", "pulsating torque", "no rows in table MotorTorque"),
    ],
)
def test_what_cannot_be_changed_is_told(
    case: CaseData, name: str, quantity: str, says: str
) -> None:
    assert says in (refusal(case, name, quantity) or "")


def test_a_changed_case_is_still_a_case(case: CaseData) -> None:
    for quantity in SCATTERED:
        names = names_with(case, quantity)
        Case(**vars(varied_case(case, [Change(quantity, name, 1.05) for name in names])))
