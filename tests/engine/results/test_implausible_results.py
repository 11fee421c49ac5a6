"""Results that no motor train has take the place of a verdict; unusual ones keep theirs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.case import Case
from engine.case.result_words import ACCEPTABLE, Judgement
from engine.results.implausible_results import implausible_results, inertia_constant
from engine.run import run
from tests.random_starts import random_start
from tests.sample_case import sample_case, with_limits


def scaled(case: Case, **factors: float) -> Case:
    """The case with columns of all rows, or scalars, multiplied."""
    changed = dict(vars(case))
    for name, factor in factors.items():
        table, _, column = name.partition("__")
        if column:
            changed[table] = tuple(
                replace(row, **{column: factor * getattr(row, column)})
                if getattr(row, column) is not None
                else row
                for row in changed[table]
            )
        else:
            changed[table] *= factor
    return Case(**changed)


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"elements__stiffness": 1e-6}, "first torsional mode at 0.021 Hz"),
        ({"stations__inertia": 30.0}, "inertia constant H = "),
        ({"stations__inertia": 0.05}, "inertia constant H = "),
        ({"stations__inertia": 25.0}, "start of "),
        ({"load_torque__torque": 5.6, "motor_torque__average": 2.0}, "× rated torque at the end"),
        ({"motor_torque__pulsating": 60.0}, "peak torque of "),
        ({"elements__stress_diameter": 0.25}, "stress of 'HP compressor shaft' "),
    ],
    ids=["MN as N", "GD² and more", "inertias in t m²", "long start", "load at motor speed",
         "pulsating", "m under mm"],
)  # fmt: skip
def test_a_gross_mistake_takes_the_place_of_the_verdict(
    factors: dict[str, float], words: str
) -> None:
    """V4 and its like: never a green banner."""
    results = run(scaled(with_limits(sample_case("modified")), **factors))
    overall = results.verdicts[0]
    assert overall.verdict == Judgement.CHECK_INPUTS
    assert overall.verdict not in ACCEPTABLE
    assert words in overall.where
    finding = next(x for x in overall.where.split("; ") if words in x)
    (note,) = (w for w in results.warnings if w.lower().startswith(finding.lower()))
    assert "no verdict is given. " in note


@pytest.mark.parametrize("design", ["proposed", "modified"])
def test_the_paper_is_plausible(design: str) -> None:
    results = run(sample_case(design))
    assert implausible_results(results) == ()


@pytest.mark.parametrize("seed", range(6))
def test_sensible_trains_are_plausible(seed: int) -> None:
    assert implausible_results(run(random_start(seed))) == ()


def test_the_inertia_constant_by_hand() -> None:
    """Motor side 640.59 kg m² and 28.196 kg m² at 5.6 times its speed; 58,400 N m at 60π rad/s."""
    results = run(sample_case("proposed"))
    referred = (
        460.76
        + 6.0
        + 6.0
        + 167.83
        + 5.6**2 * (0.6835 + 0.15 + 0.15 + 18.631 + 0.12 + 0.12 + 8.3399)
    )
    speed = 188.49555921538757
    found = inertia_constant(results.case, results.train)
    assert found == pytest.approx(0.5 * referred * speed**2 / (58400.0 * speed), rel=1e-12)
    assert found == pytest.approx(2.46, abs=0.005)


def test_a_large_inertia_constant_is_a_note_and_keeps_its_verdict() -> None:
    """H of 12 s: a heavy fan, and a start of some 40 s."""
    results = run(scaled(with_limits(sample_case("modified")), stations__inertia=5.0))
    assert implausible_results(results) == ()
    assert any("inertia constant H = 12.3 s is unusual" in note for note in results.warnings)
    assert results.verdicts[0].verdict != Judgement.CHECK_INPUTS
