"""The order of a tuning study: each rule decides where those before it are equal."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, permutations

import pytest

from engine.results.results import Verdict
from engine.studies.tuning.evaluate import EvaluatedCombination, KeyAnswers
from engine.studies.tuning.options import Combination, Option, Variable
from engine.studies.tuning.ranking import merit, ranked, reason

KEPT = Verdict(
    "Separation margin", 0.25, 0.2, "fraction", "pass", "mode 1 (24 Hz) against 1× motor"
)
STARTS = Verdict("Allowable starts", 100.0, 2000.0, "count", "fail", "Shaft")
STRESS = Verdict("Steady-state stress (peak-to-peak)", 9e7, 3e7, "pressure", "fail", "Shaft")

GOOD = KeyAnswers(
    modes=(24.0,),
    worst_margin=0.25,
    margin_where="mode 1 against 1× motor",
    margin_verdict="pass",
    too_near=(),
    outcome="reached",
    whole=True,
    sentence="97.0% speed reached after 8 s.",
    crossings=(),
    governing_mode=None,
    peak_stress=2e8,
    peak_stress_scf=6e8,
    peak_stress_where="Shaft",
    peak_torque=1e5,
    peak_over_rated=2.0,
    peak_torque_where="Shaft",
    mesh_minimum_torque=None,
    impacts=None,
    starts=5000.0,
    unlimited=False,
    starts_error=0.01,
    starts_where="Shaft",
    checks=(KEPT,),
    warnings=(),
)

VARIABLES = (Variable("C", "stiffness", 1.0, ()),)


def _tried(
    answers: KeyAnswers | None, value: float = 1.0, as_is: bool = False
) -> EvaluatedCombination:
    combination = Combination((0,), (Option(f"{value:g}", value),), as_is)
    return EvaluatedCombination(combination, answers, "" if answers else "OD is smaller than ID.")


#: From best to worst; each is better than the next by one rule although everything after it is worse.
LADDER = (
    replace(GOOD, unlimited=True, starts=None, worst_margin=0.21, peak_torque=9e5),
    replace(GOOD, starts=6000.0, worst_margin=0.22, peak_torque=8e5),
    replace(GOOD, starts=5000.0, worst_margin=0.30, peak_torque=7e5),
    replace(GOOD, starts=5000.0, worst_margin=0.29, peak_torque=1e5),
    replace(GOOD, starts=5000.0, worst_margin=0.29, peak_torque=2e5),
    replace(GOOD, margin_verdict="accepted by forced response", worst_margin=0.1, starts=9e9),
    replace(GOOD, checks=(KEPT, STARTS), starts=100.0),
    replace(GOOD, checks=(KEPT, STARTS, STRESS), starts=1e9, worst_margin=0.9),
    replace(GOOD, whole=False, outcome="stalled", starts=None),
    None,
)


def test_each_rule_decides_where_those_before_it_are_equal() -> None:
    tried = [_tried(a) for a in LADDER]
    assert list(ranked(reversed(tried), VARIABLES)) == tried
    for better, worse in pairwise(tried):
        assert merit(better) < merit(worse)
        assert merit(worse) > merit(better)


def test_without_counted_starts_the_smaller_torque_comes_first() -> None:
    small = replace(GOOD, starts=None, peak_torque=1e5, worst_margin=0.21)
    large = replace(GOOD, starts=None, peak_torque=2e5, worst_margin=0.50)
    assert merit(_tried(small)) < merit(_tried(large))


def test_a_case_without_start_is_ranked_by_its_margin() -> None:
    none = replace(GOOD, starts=None, peak_torque=None, outcome="calculated")
    wide, narrow = replace(none, worst_margin=0.4), replace(none, worst_margin=0.3)
    assert merit(_tried(wide)) < merit(_tried(narrow))


def test_equals_are_ordered_by_what_was_chosen_whatever_the_order_of_rows() -> None:
    tried = [_tried(GOOD, v, as_is) for v, as_is in ((3.0, False), (1.0, False), (2.0, True))]
    for order in permutations(tried):
        values = [t.combination.options[0].value for t in ranked(order, VARIABLES)]
        assert values == [2.0, 1.0, 3.0]  # the case itself first, as nothing need be bought
    assert merit(tried[0]) >= merit(tried[2])


@pytest.mark.parametrize(
    ("answers", "says"),
    [
        (GOOD, "Meets all limits (least separation margin: mode 1 (24 Hz) against 1× motor: 25 %)."),
        (
            replace(GOOD, checks=(KEPT, replace(STRESS, verdict="not judged"))),
            f"against 1× motor: 25 %). Not wholly judged: {STRESS.check}.",
        ),
        (GOOD, "5,000 starts (2.5 × as is)"),
        (replace(GOOD, starts=436.6), "436 starts"),
        (GOOD, "200 MPa peak-to-peak (50 % less than in the unchanged case)"),
        (replace(GOOD, checks=(KEPT, STARTS)), "Violates 1 limit: Allowable starts."),
        (replace(GOOD, unlimited=True, starts=None), "Unlimited starts"),
        (replace(GOOD, whole=False, sentence="Stalled: at 1500 rpm."), "Stalled: at 1500 rpm."),
        (replace(GOOD, impacts=12), "12 tooth impacts"),
        (None, "Cannot be calculated: OD is smaller than ID."),
    ],
)  # fmt: skip
def test_the_reason_says_what_decided(answers: KeyAnswers | None, says: str) -> None:
    before = _tried(replace(GOOD, starts=2000.0, peak_stress=4e8), as_is=True)
    assert says in reason(_tried(answers), before, 5e4)


def test_the_case_itself_is_not_compared_with_itself() -> None:
    stands = _tried(GOOD, as_is=True)
    assert "as is" not in reason(stands, stands, 5e4)


def test_nothing_is_divided_by_nothing() -> None:
    before = _tried(replace(GOOD, starts=None, unlimited=True, peak_stress=0.0), as_is=True)
    said = reason(_tried(GOOD), before, None)
    assert "nan" not in said
    assert "inf" not in said
