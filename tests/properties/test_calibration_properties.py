"""What holds of every calibration: random trains, random measurements."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from engine.case.case import Case
from engine.case.study_inputs import STIFFNESS, MeasuredFrequencyRow, ScatterRow, StudyInputs
from engine.run import at_speed
from engine.studies.calibration.calibration import calibrate
from engine.studies.calibration.least_squares import FrequencyModel, unknowns_of
from engine.studies.calibration.records import Calibration
from engine.studies.scatter import factors_of
from engine.studies.variation import names_with
from tests.strategies import cases, example_count

TRAINS = cases(stations=(2, 8), decades=3, rigid=False)
M = MeasuredFrequencyRow


def of(
    case: Case, frequencies: list[float], uncertainty: float, spread: float, modes: bool = True
) -> Calibration:
    rows = tuple(
        M(i + 1 if modes else None, float(f), uncertainty) for i, f in enumerate(frequencies)
    )
    scatter = (ScatterRow(None, "stiffness", "normal", spread),)
    return calibrate(case, StudyInputs(scatter=scatter, measured_frequencies=rows))


def perturbed(case: Case, spread: float, seed: int) -> np.ndarray:
    """Frequencies of a train drawn from the prior, modes in the order of the case's shapes."""
    factors = factors_of(case, (ScatterRow(None, "stiffness", "normal", spread),))
    model = FrequencyModel(case, unknowns_of(factors))
    z = np.random.default_rng(seed).normal(size=model.unknowns.number)
    return model.at(np.clip(z, -2.0, 2.0)).frequency


def measurable(case: Case, most: int) -> int:
    """Modes that can be told apart: well separated."""
    f = at_speed(case).modes.elastic_frequency[:most]
    assume(len(f) and np.all(np.diff(np.log(f)) > 0.2))
    return len(f)


@example_count(40)
@given(TRAINS, st.integers(1, 7), st.integers(0, 10**6))
def test_synthetic_measurements_are_reproduced(case: Case, count: int, seed: int) -> None:
    """Fewer measurements than stiffnesses or as many: both fine."""
    n, u = measurable(case, count), 1e-3
    true = perturbed(case, 0.02, seed)[:n]
    found = of(case, list(true), u, 0.02)
    for f, wanted in zip(found.frequencies, true, strict=False):
        assert f.after == pytest.approx(wanted, rel=u)
    again = at_speed(Case(**vars(found.calibrated))).modes.elastic_frequency
    assert again[:n] == pytest.approx(list(true), rel=u)
    assert found.explained is not False


@example_count(30)
@given(TRAINS, st.floats(1e-5, 0.1), st.floats(0.01, 0.2), st.booleans())
def test_measuring_the_case_itself_changes_nothing(
    case: Case, uncertainty: float, spread: float, modes: bool
) -> None:
    n = measurable(case, 4)
    f = at_speed(case).modes.elastic_frequency[:n]
    found = of(case, list(f), uncertainty, spread, modes)
    assert all(p.change == pytest.approx(0.0, abs=1e-12) for p in found.parameters)
    assert found.chi_square == pytest.approx(0.0, abs=1e-12)
    # of 512 samples
    assert all(p.posterior_deviation <= 1.1 * p.prior_deviation for p in found.parameters)


@example_count(30)
@given(TRAINS, st.floats(2e-4, 0.05), st.floats(1.0, 20.0))
def test_a_more_precise_measurement_never_widens_a_posterior(
    case: Case, uncertainty: float, times: float
) -> None:
    n = measurable(case, 4)
    f = list(at_speed(case).modes.elastic_frequency[:n])
    rough, fine = of(case, f, uncertainty, 0.1), of(case, f, uncertainty / times, 0.1)
    for a, b in zip(rough.parameters, fine.parameters, strict=True):
        assert b.posterior_deviation <= 1.1 * a.posterior_deviation  # of 512 samples each
    for c, d in zip(rough.frequencies, fine.frequencies, strict=True):
        assert d.posterior_deviation <= 1.1 * c.posterior_deviation


@example_count(12)
@given(TRAINS, st.integers(0, 10**6))
def test_the_order_of_rows_changes_nothing(case: Case, seed: int) -> None:
    n = measurable(case, 4)
    f = [float(x) for x in perturbed(case, 0.05, seed)[:n]]
    rows = [M(None, x, 0.01 * (1 + i)) for i, x in enumerate(f)]
    names = [ScatterRow(name, "stiffness", "normal", 0.05) for name in names_with(case, STIFFNESS)]
    shuffled, other = list(rows), list(names)
    random.Random(seed).shuffle(shuffled)
    random.Random(seed + 1).shuffle(other)

    def told(scatter: list[ScatterRow], measured: list[M]) -> dict[str, float]:  # type: ignore[valid-type]
        found = calibrate(
            case, StudyInputs(scatter=tuple(scatter), measured_frequencies=tuple(measured))
        )
        return {p.name: p.change for p in found.parameters} | {
            f"mode {q.mode}": q.after for q in found.frequencies
        }

    assert told(names, rows) == told(other, shuffled)


@example_count(25)
@given(TRAINS, st.integers(0, 10**6))
def test_more_measurements_than_unknowns(case: Case, seed: int) -> None:
    """One common factor, every mode measured with an error: the mean of ln f, weighted by the prior."""
    n, u, spread = measurable(case, 6), 0.005, 0.1
    f = at_speed(case).modes.elastic_frequency[:n]
    error = u * np.clip(np.random.default_rng(seed).normal(size=n), -2.0, 2.0)
    rows = tuple(M(i + 1, float(x), u) for i, x in enumerate(f * np.exp(error)))
    scatter = (ScatterRow(None, "stiffness", "normal", spread, together="together"),)
    found = calibrate(case, StudyInputs(scatter=scatter, measured_frequencies=rows))
    (p,) = found.parameters
    weight = (0.5 * spread / u) ** 2
    z = weight * np.sum(error) / (0.5 * spread) / (1.0 + n * weight)
    assert math.log1p(p.change) == pytest.approx(spread * z, abs=20 * u**2)
    assert p.posterior_deviation == pytest.approx(spread / math.sqrt(1.0 + n * weight), rel=0.05)
