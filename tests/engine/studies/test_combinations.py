"""Rows of Tuning and Catalogue: what is wrong with them is told, all at once; what is right is tried."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from engine.case.case import Case
from engine.case.data import CaseData, MeshRow
from engine.case.study_inputs import CatalogueRow, StudyInputs, TuningRow
from engine.errors import CaseError
from engine.studies.tuning.checks import MAX_COMBINATIONS, tuning_problems
from engine.studies.tuning.combinations import plan_tuning
from engine.studies.tuning.options import DEFAULT_STEPS, with_options
from tests.sample_case import sample_case
from tests.trains import geared

LS, HS = "LS coupling", "HS coupling"


@pytest.fixture(scope="module")
def case() -> Case:
    return sample_case("proposed")


def _tuning(*rows: TuningRow) -> StudyInputs:
    return StudyInputs(tuning=rows)


def _offers(*rows: CatalogueRow) -> StudyInputs:
    return StudyInputs(catalogue=rows)


def _stiffness(**fields: Any) -> TuningRow:
    return TuningRow(**({"element": LS, "quantity": "stiffness"} | fields))


def _offer(**fields: Any) -> CatalogueRow:
    return CatalogueRow(**({"element": LS, "name": "A", "stiffness": 2e7} | fields))


# --- what is wrong --------------------------------------------------------------------------------

WRONG = [
    (StudyInputs(), None, "", "the tables Tuning and Catalogue are empty"),
    (_tuning(_stiffness(element="LS couplin", values=(1.0,))), 1, "Element", "'LS coupling'"),
    (_tuning(_stiffness(element=None, values=(1.0,))), 1, "Element", "Name it"),
    (_tuning(_stiffness(quantity="stifness", values=(1.0,))), 1, "Quantity", "one of stiffness"),
    (_tuning(_stiffness(quantity=None, values=(1.0,))), 1, "Quantity", "the cell is blank"),
    (_tuning(_stiffness(quantity="diameter", values=(1.0,))), 1, "Element", "Clear its Stiffness"),
    (_tuning(_stiffness(quantity="backlash", values=(1.0,))), 1, "Element", "no Backlash"),
    (_tuning(_stiffness(quantity="damping", values=(1.0,))), 1, "Element", "no Damping"),
    (_tuning(TuningRow(LS, "inertia", values=(1.0,))), 1, "Element", "a station"),
    (_tuning(_stiffness()), 1, "Values", "neither Values nor a range"),
    (_tuning(_stiffness(values=(1.0,), to=2.0)), 1, "Values", "Clear Values"),
    (_tuning(_stiffness(from_=0.5)), 1, "To", "the cell is blank"),
    (_tuning(_stiffness(to=0.5)), 1, "From", "the cell is blank"),
    (_tuning(_stiffness(from_=2.0, to=0.5)), 1, "To", "To is less than From"),
    (_tuning(_stiffness(from_=0.5, to=2.0, steps=1)), 1, "Steps", "2 or more"),
    (_tuning(_stiffness(from_=0.5, to=2.0, steps=-3)), 1, "Steps", "2 or more"),
    (_tuning(_stiffness(from_=0.5, to=0.5, steps=4)), 1, "To", "above From"),
    (_tuning(_stiffness(values=(1.0, 0.0))), 1, "Values", "it must be positive"),
    (_tuning(_stiffness(values=(-1.0,))), 1, "Values", "found -1; it must be positive"),
    (_tuning(_stiffness(values=(float("nan"),))), 1, "Values", "it must be positive"),
    (_tuning(_stiffness(values=(1e308,))), 1, "Values", "found 1e+308; it must be at most 1e+30"),
    (_tuning(_stiffness(from_=0.0, to=1.0)), 1, "From", "it must be positive"),
    (_tuning(_stiffness(values=(-2e7,), relative=False)), 1, "Values", "-2e+07 N m/rad"),
    (_tuning(_stiffness(values=(1.0,)), _stiffness(values=(2.0,))), 2, "Element", "row 1 has it"),
    (_offers(_offer(), _offer()), 2, "Name", "row 1 has it already"),
    (_offers(_offer(name=None)), 1, "Name", "the maker's designation"),
    (_offers(_offer(element="HS cupling")), 1, "Element", "'HS coupling'"),
    (_offers(_offer(element="Mesh")), 1, "Element", "not a gear mesh"),
    (_offers(_offer(stiffness=None)), 1, "Stiffness", "the cell is blank"),
    (_offers(_offer(stiffness=0.0)), 1, "Stiffness", "it must be positive"),
    (_offers(_offer(inertia=-1.0)), 1, "Inertia", "zero or positive"),
    (_offers(_offer(rated_torque=0.0)), 1, "Rated torque", "it must be positive"),
    (_offers(_offer(fitted="maybe")), 1, "Fitted", "yes or no"),
    (_offers(_offer(fitted="yes"), _offer(name="B", fitted="yes")), 2, "Fitted", "row 1 has it"),
    (_offers(_offer(inertia=1.0), _offer(name="B")), 2, "Inertia", "in all rows of 'LS coupling'"),
    (
        StudyInputs((_stiffness(values=(1.0,)),), (_offer(),)),
        1,
        "Element",
        "A catalogue coupling has its own data",
    ),
    (
        _offers(_offer(inertia=1.0), _offer(name="B", inertia=14.0, fitted="yes")),
        2,
        "Inertia",
        "half of 14 kg m² is included in station 'LS hub M', which has 6 kg m²",
    ),
]


@pytest.mark.parametrize(
    ("studies", "row", "column", "says"), WRONG, ids=[f"{n} {w[3]}" for n, w in enumerate(WRONG)]
)
def test_what_is_wrong_is_told_at_its_cell(
    case: Case, studies: StudyInputs, row: int | None, column: str, says: str
) -> None:
    (problem,) = tuning_problems(case, studies)
    assert (problem.row, problem.column) == (row, column)
    assert problem.table == ("Catalogue" if studies.catalogue and not studies.tuning else "Tuning")
    assert says in problem.message
    with pytest.raises(CaseError, match="."):
        plan_tuning(case, studies)


def test_all_problems_are_told_at_once(case: Case) -> None:
    studies = StudyInputs(
        (_stiffness(element="X", values=(-1.0,)), _stiffness(element=HS)), (_offer(name=None),)
    )
    told = [(p.table, p.row, p.column) for p in tuning_problems(case, studies)]
    assert told == [
        ("Tuning", 1, "Element"),
        ("Tuning", 1, "Values"),
        ("Tuning", 2, "Values"),
        ("Catalogue", 1, "Name"),
    ]


def test_stiffness_and_diameter_of_one_shaft_exclude_each_other() -> None:
    base = geared()
    shaft = replace(base.elements[0], stiffness=None, od=0.2, length=0.5, shear_modulus=8e10)
    case = replace(base, elements=(shaft, *base.elements[1:]))
    name = str(shaft.element)
    rows = (TuningRow(name, "diameter", values=(1.0,)), TuningRow(name, "stiffness", values=(1.0,)))
    (problem,) = tuning_problems(case, _tuning(*rows))
    assert (problem.row, problem.column) == (2, "Element")
    assert "clear this row or row 1" in problem.message


def test_too_many_combinations_are_told_with_their_number_before_any_is_made(case: Case) -> None:
    steps = 10**12
    (problem,) = tuning_problems(
        case, _tuning(_stiffness(from_=0.5, to=2.0, steps=steps), _stiffness(element=HS, values=(0.5, 1.0)))
    )  # fmt: skip
    assert f"make {2 * steps:,} combinations; the limit is {MAX_COMBINATIONS:,}" in problem.message
    within = _tuning(_stiffness(from_=0.5, to=2.0, steps=MAX_COMBINATIONS))
    assert tuning_problems(case, within) == ()


def test_zero_damping_and_zero_backlash_may_be_tried(case: Case) -> None:
    assert tuning_problems(case, _tuning(_stiffness(quantity="damping", relative=False, values=(0.0, 1e3)))) == ()  # fmt: skip


# --- what is tried --------------------------------------------------------------------------------


def test_every_combination_once_and_the_case_as_it_stands_first(case: Case) -> None:
    plan = plan_tuning(
        case, _tuning(_stiffness(values=(0.5, 2.0, 0.5)), _stiffness(element=HS, from_=0.5, to=1.5))
    )
    assert [len(v.options) for v in plan.variables] == [2, DEFAULT_STEPS]
    assert len(plan.combinations) == 2 * DEFAULT_STEPS + 1
    assert plan.combinations[0].as_is
    assert [c.as_is for c in plan.combinations[1:]] == [False] * (2 * DEFAULT_STEPS)
    assert len({c.picked for c in plan.combinations}) == len(plan.combinations)


def test_a_range_ends_exactly_where_it_was_typed(case: Case) -> None:
    low, high = 0.1 + 0.2, 0.7
    (variable,) = plan_tuning(case, _tuning(_stiffness(from_=low, to=high, steps=7))).variables
    factors = [o.change.value for o in variable.options if o.change]
    assert (factors[0], factors[-1], len(factors)) == (low, high, 7)
    gaps = [b - a for a, b in zip(factors, factors[1:], strict=False)]
    assert gaps == pytest.approx([(high - low) / 6] * 6, rel=1e-12)


def test_a_combination_that_is_the_case_itself_is_calculated_once(case: Case) -> None:
    plan = plan_tuning(case, _tuning(_stiffness(values=(0.5, 1.0)), _stiffness(element=HS, values=(1.0, 2.0))))  # fmt: skip
    assert len(plan.combinations) == 4
    stands = [c for c in plan.combinations if c.as_is]
    assert len(stands) == 1
    assert with_options(case, stands[0].options) == CaseData(**vars(case))


def test_a_catalogue_brings_stiffness_damping_limits_and_half_its_inertia_at_each_end(
    case: Case,
) -> None:
    fitted = _offer(name="fitted", fitted="yes", inertia=5.0, stiffness=28946010.0)
    other = _offer(name="soft", inertia=8.0, damping=7e3, rated_torque=6e4, peak_torque_limit=9e4)
    plan = plan_tuning(case, _offers(fitted, other))
    soft = next(c for c in plan.combinations if c.options and c.options[0].label == "soft")
    new = with_options(case, soft.options)
    before = {s.station: s.inertia for s in case.stations}
    after = {s.station: s.inertia for s in new.stations}
    grown = {name for name in before if after[name] != before[name]}
    assert grown == {"LS hub M", "LS hub G"}
    assert after["LS hub M"] == pytest.approx(6.0 + 0.5 * (8.0 - 5.0))
    old = next(e for e in case.elements if e.element == LS)
    assert next(e for e in new.elements if e.element == LS) == replace(
        old, stiffness=2e7, damping=7e3, rated_torque=6e4, peak_torque_limit=9e4
    )
    assert [e for e in new.elements if e.element != LS] == [
        e for e in case.elements if e.element != LS
    ]
    (as_is,) = [c for c in plan.combinations if c.as_is]
    assert as_is.options[0].label == "fitted"


def test_without_a_fitted_coupling_the_stations_hold_none(case: Case) -> None:
    plan = plan_tuning(case, _offers(_offer(inertia=4.0)))
    new = with_options(case, plan.combinations[-1].options)
    assert next(s.inertia for s in new.stations if s.station == "LS hub G") == pytest.approx(8.0)


def test_limits_of_the_coupling_that_is_taken_out_do_not_judge_the_new_one(case: Case) -> None:
    limited = tuple(
        replace(e, peak_torque_limit=1e5, rated_torque=5e4) if e.element == LS else e
        for e in case.elements
    )
    limited_case = replace(case, elements=limited)
    plan = plan_tuning(limited_case, _offers(_offer()))
    new = with_options(limited_case, plan.combinations[-1].options)
    coupling = next(e for e in new.elements if e.element == LS)
    assert (coupling.peak_torque_limit, coupling.rated_torque) == (None, None)


def test_backlash_by_a_ratio() -> None:
    base = geared()
    mesh = replace(base.elements[1], stiffness=5e8)
    case = replace(
        base,
        elements=(base.elements[0], mesh, base.elements[2]),
        meshes=(MeshRow("Mesh", None, 0.3, 0.1, backlash=2e-4),),
    )
    plan = plan_tuning(case, _tuning(TuningRow("Mesh", "backlash", values=(0.5, 2.0))))
    new = [with_options(case, c.options).meshes[0].backlash for c in plan.combinations]
    assert new == [2e-4, 1e-4, 4e-4]


def test_the_order_of_rows_does_not_change_a_case(case: Case) -> None:
    rows = (
        TuningRow("LS hub M", "inertia", values=(0.9,)),
        _stiffness(element=HS, values=(0.7,)),
        TuningRow("Motor", "inertia", values=(1.1,)),
    )
    offers = (
        _offer(inertia=1.3),
        _offer(element="Motor shaft", inertia=0.7, stiffness=2e8),
    )
    a = plan_tuning(case, StudyInputs(rows, offers))
    b = plan_tuning(case, StudyInputs(rows[::-1], offers[::-1]))
    assert with_options(case, a.combinations[-1].options) == with_options(
        case, b.combinations[-1].options
    )
