"""The limit on contact damping where teeth come near parting, and what rigid meshes feel of dampers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.study_trains import study_train
from engine.case.choices import ContactLaw
from engine.case.data import EffectChoiceRow
from engine.plan.contact_damping import _excess
from engine.results.results import Results
from engine.run import run


def changes(found: Results, other: Results) -> dict[str, float]:
    """Relative change of the extremes of each element."""
    assert found.start is not None
    assert other.start is not None
    return {
        a.element: max(abs(a.maximum - b.maximum), abs(a.minimum - b.minimum)) / b.size
        for a, b in zip(found.start.peaks, other.start.peaks, strict=True)
    }


def test_what_exceeds_the_spring_force_of_a_ramp_in_closed_form() -> None:
    """T = t: S = t − τ (1 − exp(−t/τ)), and T − 2 S is positive until about 1.59 τ."""
    lag = 0.01
    time = np.linspace(0.0, 0.1, 11)
    trajectory = SimpleNamespace(
        time=time, torque=time[None], torque_rate=np.ones((1, 11)), output_element=np.array([0])
    )
    start: Any = SimpleNamespace(trajectory=trajectory)
    flank: Any = SimpleNamespace(element=0, viscous=lag * 1e6, stiffness=1e6)
    at, excess = _excess(start, flank)
    exact = np.maximum(at - 2.0 * (at - lag * (1.0 - np.exp(-at / lag))), 0.0)
    np.testing.assert_allclose(excess, exact, atol=1e-12)
    assert at[-1] == pytest.approx(1.5936 * lag, abs=(at[1] - at[0]))


@pytest.mark.parametrize("number", [411, 467])
def test_a_limit_that_matters_is_simulated_though_no_tooth_parts(number: int) -> None:
    """It changes a peak by 0.2 and 0.05 %; without it the tolerance was said to be met."""
    case = study_train(number).case
    found = run(case)
    decision = found.plans[-1].decision("backlash")
    assert decision.on
    assert "limit on contact damping" in decision.why
    linear = run(replace(case, effect_choices=(EffectChoiceRow("backlash", "off"),)))
    finer = run(replace(case, tolerance_peak=0.1 * (case.tolerance_peak or 1e-3)))
    tolerance = case.tolerance_peak or 1e-3
    assert max(changes(linear, finer).values()) > tolerance
    assert max(changes(found, finer).values()) < tolerance


def test_a_limit_that_does_not_matter_is_bounded() -> None:
    case = study_train(273).case
    found = run(case)
    decision = found.plans[-1].decision("backlash")
    assert not decision.on
    on = (*case.effect_choices, EffectChoiceRow("backlash", "on"))
    true = max(changes(found, run(replace(case, effect_choices=on))).values())
    assert decision.bound is not None
    assert 1e-4 < true < decision.bound < 1e-3
    free = run(replace(case, contact_law=ContactLaw.NO_ADHESION)).plans[-1].decision("backlash")
    assert free.bound == pytest.approx(0.0, abs=1e-20)  # no limit, no change


@pytest.mark.parametrize("number", [251, 1121])
def test_a_limit_that_acts_at_the_beginning_shifts_the_start(number: int) -> None:
    """Its ringing has long faded at the peak; the train comes to each speed some microseconds later."""
    case = study_train(number).case
    decision = run(case).plans[-1].decision("backlash")
    finer = replace(case, tolerance_peak=0.01 * (case.tolerance_peak or 1e-3))
    off, on = (
        run(replace(finer, effect_choices=(*case.effect_choices, EffectChoiceRow("backlash", how))))
        for how in ("off", "on")
    )
    true = max(changes(off, on).values())
    assert not decision.on
    assert decision.bound is not None
    assert 1e-5 < true < decision.bound < 10.0 * true


def test_dampers_enter_the_torque_of_a_rigid_mesh_though_they_couple_no_modes() -> None:
    """One elastic mode: nothing to couple, yet the mesh takes its torque from equilibrium."""
    case = replace(study_train(467).case, contact_law=ContactLaw.NO_ADHESION)
    found = run(case)
    assert found.plans[-1].decision("coupled damping").on
    off = replace(case, effect_choices=(EffectChoiceRow("coupled damping", "off"),))
    assert changes(run(off), found)["E2"] > 1e-3
