"""Results that no motor train has take the place of a verdict; unusual ones keep theirs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from engine.case.case import Case
from engine.case.data import ExcitationRow, ModeDampingRow
from engine.case.plausibility import implausible
from engine.case.result_words import ACCEPTABLE, Judgement
from engine.model.build_train import build_train
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import impossible_train, unusual_train
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


LOSSY = {"elements": ("LS coupling", {"loss_factor": 5.0})}
VISCOUS = {"elements": ("LS coupling", {"damping": 1e7})}
REVERSAL = {"elements": ("Mesh", {"reversal_limit": 25e6})}
WEAK = tuple(ExcitationRow(f"{k}x", k, "Motor", torque_share=1e-4) for k in (1.0, 2.0))


def with_changes(case: Case, **changes: Any) -> Case:
    """The case with scalars or tables replaced, or with columns of one row of Elements."""
    name, columns = changes.get("elements", (None, {}))
    rows = tuple(replace(e, **columns) if e.element == name else e for e in case.elements)
    return Case(**(vars(case) | changes | {"elements": rows}))


def findings(case: Case) -> list[str]:
    train = build_train(case)
    return [one.finding for one in impossible_train(case, train, full_speed(case, train))]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"margin_required": 0.002}, "MarginRequired 0.2 %"),
        ({"damping_ratio": 0.15}, "DampingRatio 15 %"),
        ({"damping_range": 0.003}, "DampingRange 0.3 %"),
        ({"mode_damping": (ModeDampingRow(1, 0.5),)}, "Damping ratio of 'mode 1' 50 %"),
        ({"field_slip": 0.0003, "pull_out_torque": 1e5}, "FieldSlip 0.03 %"),
        ({"minimum_speed": 1.7, "maximum_speed": 1.9}, "MaximumSpeed 1.008 % of synchronous speed"),
        ({"end_speed": 0.0097 * 60.0 * math.pi}, "EndSpeed 0.97 % of synchronous speed"),
        ({"starts_factor": 0.5}, "StartsFactor 0.5"),
        (LOSSY, "Loss factor of 'LS coupling' 5"),
        (VISCOUS, "Damping of 'LS coupling' 152.2 × Stiffness at line frequency"),
        (REVERSAL, "Reversal limit of 'Mesh' 428 × rated torque"),
        ({"excitations": WEAK}, "every Torque of Excitations at most 0.01 %"),
    ],
    ids=lambda x: next(iter(x)) if isinstance(x, dict) else None,
)
def test_a_percent_sign_or_unit_that_would_pass_a_check_gives_no_verdict(
    changes: dict[str, Any], words: str
) -> None:
    """The damping by hand: 120π/s × 10⁷ N m s/rad over 24.76 MN m/rad."""
    (finding,) = findings(with_changes(with_limits(sample_case("modified")), **changes))
    assert finding.startswith(words)


@pytest.mark.parametrize(
    "changes",
    [
        {"margin_required": 0.01},
        {"margin_required": 0.0},
        {"damping_ratio": 0.1},
        {"damping_range": 0.02},
        {"mode_damping": (ModeDampingRow(1, 0.25),)},
        {"elements": ("LS coupling", {"loss_factor": 1.1})},
        {"excitations": (*WEAK, ExcitationRow("3x", 3.0, "Motor"))},
    ],
    ids=lambda x: next(iter(x)),
)
def test_what_can_be_meant_keeps_its_verdict(changes: dict[str, Any]) -> None:
    """A margin of nothing, a damper coupling, weak harmonics beside one of 1 %."""
    assert findings(with_changes(with_limits(sample_case("modified")), **changes)) == []


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"motor_torque__pulsating": 0.0}, "Pulsating of 'Motor' is zero at every speed"),
        ({"motor_torque__pulsating": 0.01}, "is at most 0.16 % of rated torque at every speed"),
        ({"elements__stiffness": 1e-3}, "twist of 'LS coupling' (and 3 more) 135.1 degrees"),
        (
            {"load_torque__speed": 0.01},
            "LoadTorque of 'LP comp' (and 1 more) ends at 1 % of synchronous speed",
        ),
    ],
    ids=["no pulsation", "pu under %", "kN m under N m", "fractions under %"],
)
def test_a_start_in_which_nothing_can_be_judged_gives_no_verdict(
    factors: dict[str, float], words: str
) -> None:
    """58,400 N m over 24,762 N m/rad are 2.358 rad."""
    assert words in findings(scaled(with_limits(sample_case("modified")), **factors))[0]


def test_with_a_transient_at_breaker_closing_a_motor_need_not_pulsate() -> None:
    """An induction motor has the transient alone."""
    case = scaled(sample_case("modified"), motor_torque__pulsating=0.0)
    assert findings(replace(case, shock_amplitude=3e5, shock_time_constant=0.05)) == []
    assert findings(case) != []


@pytest.mark.parametrize(
    "factors",
    [
        {"elements__stress_diameter": 25.4},
        {"materials__uts": 145.0},
        {"stations__inertia": 30.0},
        {"elements__peak_torque_limit": 1e3},
        {"elements__stiffness": 1e-3},
        {"motor_torque__pulsating": 0.0},
        {"load_torque__speed": 0.01},
    ],
    ids=lambda x: next(iter(x)),
)
def test_one_cause_is_one_note(factors: dict[str, float]) -> None:
    """What is impossible is not said to be unusual as well."""
    case = scaled(with_limits(sample_case("modified")), **factors)
    train = build_train(case)
    facts = full_speed(case, train)
    assert impossible_train(case, train, facts) != ()
    assert (*implausible(case), *unusual_train(case, train, facts)) == ()


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
    blank = replace(case, stations=sample_case("modified").stations)
    assert full_speed(blank, build_train(blank)).running_load == pytest.approx(1.0, rel=1e-12)
    unknown = replace(blank, load_torque=())
    assert full_speed(unknown, build_train(unknown)).running_load is None


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
