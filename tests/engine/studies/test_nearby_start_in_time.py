"""A start of a near train has the effects of the nominal one: the motor's fluxes in time, too."""

from __future__ import annotations

import pytest

from engine.run import run
from engine.studies.nearby_start import near_start, near_train, recipe_of
from tests.machine_reference import start_case


def test_a_near_start_is_in_time_where_the_nominal_one_is():
    case = start_case(0)
    results = run(case)
    assert results.plans[-1].effects.motor_transient
    recipe = recipe_of(case, results)
    found = near_start(case, recipe, near_train(case, recipe))
    nominal = [p.maximum for p in results.start.peaks]
    assert found.maximum.tolist() == pytest.approx(nominal, rel=1e-3)
