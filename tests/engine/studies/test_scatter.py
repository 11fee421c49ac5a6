"""Table `Scatter`: what it stands for, what is refused, and how its samples are distributed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from engine.case.data import CaseData
from engine.case.study_inputs import SCATTERED, ScatterRow
from engine.errors import CaseError
from engine.studies.scatter import (
    Factor,
    changes_of,
    factors_of,
    sample_size,
    sampled,
    scatter_problems,
)
from engine.studies.variation import names_with, nominal_value, varied_case
from tests.sample_case import sample_case

KINDS = (
    Factor("stiffness", ("a",), "normal", 0.1),
    Factor("stiffness", ("b",), "uniform", 0.2),
    Factor("stiffness", ("c",), "triangular", 0.3),
    Factor("stiffness", ("d",), "from-to", from_=0.8, to=1.5),
)


@pytest.fixture(scope="module")
def case() -> CaseData:
    return sample_case("proposed")


# --- what the table stands for --------------------------------------------------------------------


def test_a_blank_name_stands_for_all_that_have_the_quantity(case: CaseData) -> None:
    each = factors_of(case, [ScatterRow(quantity="stiffness", spread=0.05)])
    assert tuple(f.names for f in each) == tuple((n,) for n in names_with(case, "stiffness"))
    (together,) = factors_of(case, [ScatterRow(None, "stiffness", None, 0.05, together="together")])
    assert together.names == names_with(case, "stiffness")


def test_a_named_row_stands_in_place_of_the_blank_one(case: CaseData) -> None:
    rows = [
        ScatterRow(quantity="stiffness", spread=0.05),
        ScatterRow("LS coupling", "stiffness", "uniform", 0.2),
    ]
    found = factors_of(case, rows)
    own = [f for f in found if "LS coupling" in f.names]
    assert [(f.distribution, f.spread) for f in own] == [("uniform", 0.2)]
    assert sorted(n for f in found for n in f.names) == sorted(names_with(case, "stiffness"))


def test_together_multiplies_every_name_by_one_number(case: CaseData) -> None:
    factors = factors_of(case, [ScatterRow(None, "inertia", None, 0.05, together="together")])
    new = varied_case(case, changes_of(factors, [1.1]))
    for name in names_with(case, "inertia"):
        old = nominal_value(case, name, "inertia")
        assert old is not None
        assert nominal_value(new, name, "inertia") == 1.1 * old


def test_every_quantity_can_scatter(case: CaseData) -> None:
    damped = replace(
        CaseData(**vars(case)),
        elements=tuple(replace(e, damping=10.0) for e in case.elements),
    )
    rows = [ScatterRow(quantity=q, spread=0.05) for q in SCATTERED]
    assert scatter_problems(damped, rows) == []
    assert {f.quantity for f in factors_of(damped, rows)} == set(SCATTERED)


@pytest.mark.parametrize(
    ("row", "column", "says"),
    [
        (ScatterRow(spread=0.1), "Quantity", "Quantity is blank"),
        (ScatterRow(quantity="colour", spread=0.1), "Quantity", "'colour'"),
        (ScatterRow("LS couplin", "stiffness", spread=0.1), "Name", "no element 'LS couplin'"),
        (ScatterRow("LS coupling", "damping ratio", spread=0.1), "Name", "Clear Name"),
        (
            ScatterRow(quantity="damping", spread=0.1),
            "Quantity",
            "the case gives no damping to scale",
        ),
        (ScatterRow(quantity="stiffness"), "Spread", "Spread is blank"),
        (ScatterRow(quantity="stiffness", spread=-0.1), "Spread", "-10 %"),
        (ScatterRow(quantity="stiffness", spread=0.25), "Spread", "or more reaches zero"),
        (ScatterRow(quantity="stiffness", spread=float("nan")), "Spread", "nan %"),
        (ScatterRow(quantity="stiffness", distribution="uniform", spread=1.0), "Spread", "100 %"),
        (
            ScatterRow(quantity="stiffness", distribution="gauss", spread=0.1),
            "Distribution",
            "gauss",
        ),
        (ScatterRow(quantity="stiffness", distribution="from-to", from_=0.9), "To", "To is blank"),
        (
            ScatterRow(quantity="stiffness", distribution="from-to", from_=0.0, to=1.0),
            "From",
            "two positive factors",
        ),
        (ScatterRow(quantity="stiffness", from_=1.2, to=0.9), "To", "Swap them"),
        (
            ScatterRow(quantity="stiffness", distribution="from-to", from_=0.9, to=1.1, spread=0.1),
            "Spread",
            "Clear Spread",
        ),
        (ScatterRow(quantity="stiffness", spread=0.1, to=1.1), "To", "choose from-to"),
        (ScatterRow(quantity="stiffness", spread=0.1, together="both"), "Together", "'both'"),
    ],
)
def test_what_is_refused(case: CaseData, row: ScatterRow, column: str, says: str) -> None:
    (problem,) = scatter_problems(case, [row])
    assert (problem.table, problem.row, problem.column) == ("Scatter", 1, column)
    assert says in problem.message


def test_messages_have_per_cents_as_typed_and_leave_the_place_to_the_reader(
    case: CaseData,
) -> None:
    rows = [
        ScatterRow(quantity="stiffness", from_=1.1, to=0.9),
        ScatterRow(quantity="inertia", spread=-0.02),
        ScatterRow(quantity="damping ratio", distribution="uniform", spread=0.3, to=1.2),
        ScatterRow(quantity="stiffness", spread=0.05),
    ]
    said = [p.message for p in scatter_problems(case, rows)]
    assert said[0] == "To is 90 %, below From, 110 %. Swap them."
    assert said[1].startswith("Spread is -2 %; it must not be negative.")
    assert "standard deviations" not in said[1]
    assert said[2].startswith("To is 120 %, but the distribution is uniform.")
    assert not any("Scatter, row" in one for one in said)


def test_everything_wrong_is_told_at_once(case: CaseData) -> None:
    rows = [
        ScatterRow(quantity="stiffness", spread=0.05),
        ScatterRow(quantity="stiffness", spread=0.05),
        ScatterRow(quantity="inertia", spread=0.3),
    ]
    assert [(p.row, p.column) for p in scatter_problems(case, rows)] == [(3, "Spread"), (2, "Name")]
    assert "Table Scatter is empty" in scatter_problems(case, [])[0].message


# --- samples --------------------------------------------------------------------------------------


def test_ends_are_judged_as_if_they_were_typed(case: CaseData) -> None:
    rows = [
        ScatterRow(quantity="stiffness", spread=0.1),
        ScatterRow(quantity="damping ratio", from_=0.5, to=200.0),
    ]
    (wrong,) = scatter_problems(case, rows)
    with pytest.raises(CaseError) as typed:
        replace(case, damping_ratio=200.0 * (case.damping_ratio or 0.0))
    assert (wrong.table, wrong.row, wrong.column, wrong.found) == ("Scatter", 2, "To", 200.0)
    assert wrong.message.startswith(
        "multiplied by 200, its largest factor, the value is not valid: "
    )
    assert typed.value.problems[0].message in wrong.message
    assert scatter_problems(case, [rows[0], replace(rows[1], to=2.0)]) == []


def test_distributions_are_those_of_the_names() -> None:
    """Against the cumulative distributions of scipy, by Kolmogorov and Smirnov."""
    values = sampled(KINDS, 2000, 3)
    expected = (
        stats.truncnorm(-4.0, 4.0, 1.0, 0.1),
        stats.uniform(0.8, 0.4),
        stats.triang(0.5, 0.7, 0.6),
        stats.uniform(0.8, 0.7),
    )
    for i, distribution in enumerate(expected):
        assert stats.kstest(values[:, i], distribution.cdf).pvalue > 0.01
        assert KINDS[i].deviation == pytest.approx(float(distribution.std()), rel=1e-9)
        assert np.std(values[:, i]) == pytest.approx(KINDS[i].deviation, rel=0.02)


def test_every_layer_of_a_latin_hypercube_holds_one_sample() -> None:
    n = 250
    values = sampled(KINDS, n, 11)
    for i, factor in enumerate(KINDS):
        edges = factor.at(np.linspace(0.0, 1.0, n + 1))
        counts, _ = np.histogram(values[:, i], edges)
        assert np.all(counts == 1)


def test_a_sobol_sequence_takes_the_next_power_of_two_and_fills_halves_evenly() -> None:
    assert [sample_size(n, "sobol") for n in (1, 30, 64, 65)] == [1, 32, 64, 128]
    values = sampled(KINDS, 100, 5, "sobol")
    assert values.shape == (128, 4)
    median = np.array([float(f.at(0.5)) for f in KINDS])
    assert np.all(np.sum(values < median, axis=0) == 64)


@pytest.mark.parametrize("method", ["lhs", "sobol"])
def test_the_seed_decides_the_sample(method: str) -> None:
    assert np.array_equal(sampled(KINDS, 64, 7, method), sampled(KINDS, 64, 7, method))
    assert not np.array_equal(sampled(KINDS, 64, 7, method), sampled(KINDS, 64, 8, method))


def test_no_sample_reaches_zero_at_the_largest_spread() -> None:
    wide = Factor("inertia", ("a",), "normal", 0.2499)
    assert sampled([wide], 20000, 1).min() > 0.0
    assert float(wide.at(0.0)) > 0.0


def test_without_spread_every_factor_is_exactly_one() -> None:
    still = [Factor("inertia", ("a",), d) for d in ("normal", "uniform", "triangular", "from-to")]
    assert np.all(sampled(still, 32, 1) == 1.0)
    assert not any(f.scatters for f in still)
