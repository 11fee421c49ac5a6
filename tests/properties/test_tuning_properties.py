"""What must hold of every tuning study: one point is the unchanged case, no order of rows matters."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.case.case import Case
from engine.case.study_inputs import TUNED, CatalogueRow, StudyInputs, TuningRow
from engine.run import run
from engine.studies.tuning.combinations import plan_tuning
from engine.studies.tuning.evaluate import answers_of
from engine.studies.tuning.ranking import merit
from engine.studies.tuning.tuning import TuningResult, crossing_rows, rank_combinations, ranked_rows
from engine.studies.variation import names_with, nominal_value
from tests.random_effects import elastic_meshes, with_clearances, with_dampers
from tests.random_starts import random_start
from tests.strategies import example_count
from tests.trains import geared
from tests.whole_studies import tune

SLOW = example_count(8)


def _with_a_diameter(case: Case) -> Case:
    """The first shaft with a stiffness that follows from its geometry."""
    i = next((k for k, e in enumerate(case.elements) if e.kind == "shaft"), None)
    if i is None:
        return case
    e = case.elements[i]
    length = 0.5
    od = (32.0 * (e.stiffness or 1.0) * length / (3.141592653589793 * 8e10)) ** 0.25
    new = replace(e, stiffness=None, od=od, length=length, shear_modulus=8e10)
    return replace(case, elements=(*case.elements[:i], new, *case.elements[i + 1 :]))


@pytest.mark.slow
@SLOW
@given(seed=st.integers(0, 10_000), kind=st.sampled_from(("plain", "dampers", "clearances")), relative=st.booleans())  # fmt: skip
def test_a_range_of_one_point_gives_the_plain_run_bit_for_bit(
    seed: int, kind: str, relative: bool
) -> None:
    case = _with_a_diameter(random_start(seed))
    if kind == "dampers":
        case = with_dampers(case, seed, 0.02)
    if kind == "clearances":
        case = with_clearances(elastic_meshes(seed), seed) or case
    rows = []
    for quantity in TUNED:
        for name in names_with(case, quantity)[:1]:
            number = 1.0 if relative else _present(case, name, quantity)
            rows.append(TuningRow(name, quantity, relative, from_=number, to=number))
    rows = [
        r for r in rows if not (r.quantity == "diameter" and _has(rows, r.element, "stiffness"))
    ]
    found = tune(case, StudyInputs(tuple(rows)))
    plain = answers_of(run(case))
    assert {r.tried.combination.as_is for r in found.rows} >= {True}
    for row in found.rows:
        assert row.tried.answers == plain


def _has(rows: list[TuningRow], element: str | None, quantity: str) -> bool:
    return any(r.element == element and r.quantity == quantity for r in rows)


def _present(case: Case, name: str, quantity: str) -> float:
    value = nominal_value(case, name, quantity)
    assert value is not None
    return value


LOW, HIGH = "Low-speed shaft", "High-speed shaft"


@pytest.mark.slow
@example_count(6)
@given(data=st.data())
def test_ranking_does_not_depend_on_the_order_of_rows_or_values(data: st.DataObject) -> None:
    case = geared()
    factors = st.lists(st.sampled_from((0.4, 0.6, 0.8, 1.0, 1.3, 2.0)), min_size=1, max_size=2, unique=True)  # fmt: skip
    tuning = [
        TuningRow("Motor", "inertia", values=tuple(data.draw(factors))),
        TuningRow("Load", "inertia", values=tuple(data.draw(factors))),
    ]
    offers = [
        CatalogueRow(LOW, "A", stiffness=2e6, inertia=1.0),
        CatalogueRow(LOW, "B", stiffness=2e6, inertia=1.0, peak_torque_limit=2e4),
        CatalogueRow(HIGH, "A", stiffness=8e4, inertia=0.2, loss_factor=0.05),
        CatalogueRow(HIGH, "C", fitted="yes", stiffness=1e5, inertia=0.1),
    ]
    other_tuning = [
        replace(r, values=tuple(data.draw(st.permutations(r.values))))
        for r in data.draw(st.permutations(tuning))
    ]
    other_offers = data.draw(st.permutations(offers))
    one = tune(case, StudyInputs(tuple(tuning), tuple(offers)))
    two = tune(case, StudyInputs(tuple(other_tuning), tuple(other_offers)))
    assert _without_names(ranked_rows(one)) == _without_names(ranked_rows(two))
    assert [_parts(r.combination) for r in one.rows] == [_parts(r.combination) for r in two.rows]
    assert [_without_names([r]) for r in crossing_rows(one)] == [
        _without_names([r]) for r in crossing_rows(two)
    ]
    for above, below in pairwise(one.rows):
        assert merit(above.tried) <= merit(below.tried)


def _without_names(rows: list[dict]) -> list[dict]:
    """The words list what was chosen in the order of the rows, which is theirs to choose."""
    return [{k: v for k, v in row.items() if k != "combination"} for row in rows]


def _parts(words: str) -> set[str]:
    return set(words.removesuffix(" (as is)").split("; "))


GEARED = geared()
VALUES = StudyInputs((TuningRow(HIGH, "stiffness", from_=0.5, to=2.0, steps=4),))


@pytest.fixture(scope="module")
def found() -> TuningResult:
    return tune(GEARED, VALUES)


@example_count(10)
@given(order=st.permutations(range(4)))
def test_gathering_does_not_depend_on_the_order_of_the_answers(
    found: TuningResult, order: list[int]
) -> None:
    tried = [r.tried for r in found.rows]
    again = rank_combinations(GEARED, plan_tuning(GEARED, VALUES), [tried[i] for i in order])
    assert ranked_rows(again) == ranked_rows(found)


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_stiffer_shaft_never_lowers_a_frequency(factor: float) -> None:
    """Rayleigh: of one train, more stiffness or less inertia raises every frequency."""
    base, stiffer, heavier = (
        tune(GEARED, StudyInputs((TuningRow(name, quantity, values=(value,)),)))
        for name, quantity, value in (
            (HIGH, "stiffness", 1.0),
            (HIGH, "stiffness", factor),
            ("Load", "inertia", 1.0 / factor),
        )
    )
    modes = [
        next(r for r in x.rows if x is base or not r.tried.combination.as_is).tried.answers.modes
        for x in (base, stiffer, heavier)
    ]
    sign = 1.0 if factor > 1.0 else -1.0
    for other in modes[1:]:
        assert all(sign * (b - a) >= -1e-9 * a for a, b in zip(modes[0], other, strict=True))
