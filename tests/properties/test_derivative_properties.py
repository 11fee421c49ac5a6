"""What must hold of the derivatives of every train, whatever its shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, example, given
from strategies import cases, example_count

from engine.case.case import Case
from engine.case.data import ElementRow, StationRow
from engine.model.build_train import build_train
from engine.model.frequency_derivatives import frequency_derivatives
from engine.model.modes import modes_of
from engine.studies.variation import Change, varied_case

FEW = example_count(25)


#: Two stations that a rigid mesh makes one.
LONE_RIGID_MESH = Case(
    stations=(StationRow("S0", None, 1.0), StationRow("S1", None, 2.0, 3.0)),
    elements=(ElementRow("E1", "gear mesh", "S0", "S1"),),
    line_frequency=60.0,
    poles=4,
)


@FEW
@given(cases(stations=(2, 30), grounded=None))
@example(LONE_RIGID_MESH)
def test_derivatives_by_all_stiffnesses_add_up_to_a_half_and_by_all_inertias_to_minus_a_half(case):
    """f is of degree ½ in all stiffnesses together, and −½ in all inertias (Euler).

    A train whose stations rigid meshes tie together has no elastic mode, so no frequency to change.
    """
    train = build_train(case)
    modes = modes_of(train)
    got = frequency_derivatives(case, train, modes)
    assume(not got.clusters)
    if not len(modes.elastic_frequency):
        assert not any(row.value.size for row in got.rows)
        return
    total = {q: sum(r.value for r in got.rows if r.quantity == q) for q in ("stiffness", "inertia")}
    assert total["stiffness"] == pytest.approx(0.5, abs=1e-9)
    assert total["inertia"] == pytest.approx(-0.5, abs=1e-9)
    for row in got.rows:
        assert np.all(row.value >= 0.0 if row.quantity == "stiffness" else row.value <= 0.0)


@FEW
@given(cases(stations=(2, 10), decades=4, grounded=None))
def test_derivatives_are_those_of_the_frequencies(case):
    """Every row against a central difference of the frequencies themselves."""
    train = build_train(case)
    modes = modes_of(train)
    assume(np.all(np.diff(np.log(modes.elastic_frequency)) > 0.01))
    small = 1e-5
    for row in frequency_derivatives(case, train, modes).rows:
        low, high = (
            modes_of(build_train(varied_case(case, [Change(row.quantity, row.name, 1.0 + s)])))
            for s in (-small, small)
        )
        slope = np.log(high.elastic_frequency / low.elastic_frequency) / (2.0 * small)
        assert slope == pytest.approx(row.value, abs=1e-6)
