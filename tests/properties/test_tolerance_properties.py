"""What must hold of every scattered train, whatever its shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from strategies import cases, example_count

from engine.case.study_inputs import ScatterRow
from engine.run import run
from engine.studies.nearby_start import near_train, recipe_of
from engine.studies.scatter import changes_of, factors_of, sampled
from engine.studies.variation import varied_case

FEW = example_count(15)
ROWS = (ScatterRow(quantity="stiffness", spread=0.0), ScatterRow(quantity="inertia", spread=0.0))


@FEW
@given(cases(stations=(2, 12), grounded=None, damping_ratio=0.01))
def test_factors_of_one_give_the_plain_run_bit_for_bit(case):
    plain = run(case)
    recipe = recipe_of(case, plain)
    factors = factors_of(case, ROWS)
    near = near_train(varied_case(case, changes_of(factors, np.ones(len(factors)))), recipe)
    assert np.array_equal(near.model.modes.omega, plain.modes.omega)
    assert np.array_equal(near.model.damping.ratio, plain.damping.ratio)
    kept = [r.margin for r in plain.margins.rows if (r.mode, r.excitation) in recipe.margins]
    assert list(near.margin) == kept


@pytest.mark.slow
@example_count(6)
@given(cases(stations=(2, 8), decades=4, grounded=None), st.integers(0, 1000))
def test_small_scatter_of_a_frequency_is_that_of_the_linear_formula(case, seed):
    """Variance of ln f = Σ (½ energy share × spread)², over stiffnesses and inertias.

    Shares of the stations merged by a rigid mesh are those of each station for itself.
    """
    plain = run(case)
    modes = plain.modes
    elastic = modes.omega[modes.n_rigid :]
    gap = np.diff(np.log(elastic))
    assume(np.all(gap > 0.05))  # near-equal modes exchange places: no linear formula
    spread = 1e-4
    rows = [ScatterRow(quantity=q, spread=spread) for q in ("stiffness", "inertia")]
    factors = factors_of(case, rows)
    recipe = recipe_of(case, plain)
    n = 300
    values = sampled(factors, n, seed)
    frequency = np.array(
        [near_train(varied_case(case, changes_of(factors, v)), recipe).frequency for v in values]
    )
    wanted = slice(modes.n_rigid, modes.n_rigid + recipe.n_modes)
    strain = {e.element: modes.strain_share[i, wanted] for i, e in enumerate(case.elements)}
    kinetic = {s.station: modes.kinetic_share[i, wanted] for i, s in enumerate(case.stations)}
    variance = np.zeros(recipe.n_modes)
    for f in factors:
        own = strain if f.quantity == "stiffness" else kinetic
        variance += (0.5 * own[f.names[0]] * f.deviation) ** 2
    measured = np.std(np.log(frequency), axis=0)
    # the sampling error of a standard deviation of 300 samples is 4 %; four times that
    assert measured == pytest.approx(np.sqrt(variance), rel=0.16)
