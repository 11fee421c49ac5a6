"""Results that no motor train has take the place of a verdict; unusual ones keep theirs."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from engine.case.case import Case
from engine.case.result_words import ACCEPTABLE, Judgement
from engine.model.build_train import build_train
from engine.operation.full_speed import full_speed
from engine.results.implausible_results import implausible_results
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
        ({"load_torque__torque": 5.6, "motor_torque__average": 2.0}, "× rated torque at full speed"),
        ({"motor_torque__pulsating": 60.0}, "peak torque of "),
        ({"elements__stress_diameter": 0.25}, "stress of 'HP compressor shaft' "),
        ({"elements__stiffness": 1e6}, "first torsional mode at "),
        ({"elements__stiffness": 1e3}, "first torsional mode at "),
        ({"elements__stress_diameter": 25.4}, "nominal stress of 'Motor shaft' "),
        ({"materials__uts": 145.0, "materials__yield_": 145.0}, "UTS of 'alloy steel' "),
        ({"materials__endurance": 145.0, "sn_points__stress": 145.0}, "Endurance of 'alloy steel' "),
        ({"sn_points__stress": 145.0}, "S-N stress of 'alloy steel' "),
        ({"elements__peak_torque_limit": 1e3}, "Peak torque limit of 'LS coupling' "),
    ],
    ids=["MN as N", "GD² and more", "inertias in t m²", "long start", "load at motor speed",
         "pulsating", "m under mm", "N under MN", "N under kN", "mm under in", "psi under MPa",
         "endurance in psi under MPa", "S-N points in psi under MPa", "N m under kN m"],
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
    facts = full_speed(results.case, results.train)
    found = facts.inertia_constant
    assert found == pytest.approx(0.5 * referred * speed**2 / (58400.0 * speed), rel=1e-12)
    assert found == pytest.approx(2.46, abs=0.005)
    motor = 0.5 * 460.76 * speed**2 / (58400.0 * speed)
    assert facts.motor_inertia_constant == pytest.approx(motor, rel=1e-12)


def test_full_speed_by_hand() -> None:
    """1,800 and 10,080 rpm; loads of 0.25 × rated; running loads as typed, 0.9 × rated."""
    case = sample_case("modified")
    loaded = tuple(
        replace(s, running_load=0.9 * 58400.0 / 5.6) if s.station == "HP comp" else s
        for s in case.stations
    )
    facts = full_speed(case := replace(case, stations=loaded), build_train(case))
    assert (facts.poles, facts.line_frequency, facts.total_ratio) == (4, 60.0, 5.6)
    rpm = [(s.station, s.speed * 30.0 / math.pi) for s in facts.shafts]
    assert rpm == [("Motor", pytest.approx(1800.0)), ("Pinion", pytest.approx(10080.0))]
    assert facts.load == pytest.approx(0.25, rel=1e-9)
    assert facts.running_load == pytest.approx(0.9, rel=1e-12)
    assert facts.rated_power == pytest.approx(58400.0 * 60.0 * math.pi)


def test_without_speed_and_torque_only_the_ratio_is_known() -> None:
    blank = {"line_frequency": None, "poles": None, "rated_torque": None}
    case = sample_case("modified", **blank, motor_torque=(), load_torque=())
    facts = full_speed(case, build_train(case))
    assert facts.total_ratio == 5.6
    assert facts.shafts == ()
    assert facts.inertia_constant is facts.load is facts.running_load is None


def test_a_large_inertia_constant_is_a_note_and_keeps_its_verdict() -> None:
    """H of 12 s: a heavy fan, and a start of some 40 s."""
    results = run(scaled(with_limits(sample_case("modified")), stations__inertia=5.0))
    assert implausible_results(results) == ()
    assert any("inertia constant H = 12.3 s is unusual" in note for note in results.warnings)
    assert results.verdicts[0].verdict != Judgement.CHECK_INPUTS
