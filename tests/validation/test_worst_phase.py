"""PulsationPhase = worst, against starts at every degree of a turn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.data import EffectChoiceRow, MeshRow
from engine.errors import ModelError
from engine.run import run
from tests.sample_case import sample_case
from tests.trains import geared, started
from tests.validation.test_start_from_motor_data import case_from_data

DEGREES = range(0, 360, 4)


@pytest.mark.parametrize("name", ["modified", "proposed"])
def test_no_phase_is_worse_than_what_is_stated(name: str) -> None:
    """Peaks and damage of 90 phases, each a case of its own: none beyond the worst and its error."""
    case = sample_case(name)
    worst = run(replace(case, pulsation_phase="worst"))
    single = [run(replace(case, pulsation_phase=math.radians(k))) for k in DEGREES]
    assert worst.start is not None
    for i, peak in enumerate(worst.start.peaks):
        maxima, minima = (
            [getattr(r.start.peaks[i], end) for r in single if r.start]
            for end in ("maximum", "minimum")
        )
        assert max(maxima) <= peak.maximum + peak.error
        assert min(minima) >= peak.minimum - peak.error
        # and no more than what some phase gives
        assert peak.maximum <= max(maxima) + peak.error
        assert peak.minimum >= min(minima) - peak.error
        larger = maxima if peak.maximum >= -peak.minimum else minima
        assert peak.phase is not None
        at = round(math.degrees(peak.phase) / 4) % len(DEGREES)
        near = [abs(larger[(at + k) % len(DEGREES)]) for k in (-1, 0, 1)]
        assert max(near) == pytest.approx(peak.size, abs=peak.error)
    assert worst.starts is not None
    for j, shaft in enumerate(worst.starts.shafts):
        damages = [r.starts.shafts[j].damage for r in single if r.starts]
        assert shaft.damage_low <= max(damages) <= shaft.damage_high
        assert shaft.damage >= np.mean(damages)
    assert any(sentence.startswith("PulsationPhase is worst") for sentence in worst.warnings)


def test_the_worst_differs_from_blank() -> None:
    """Else the test above could not fail."""
    case = sample_case("proposed")
    blank, worst = run(case), run(replace(case, pulsation_phase="worst"))
    assert blank.start is not None
    assert worst.start is not None
    mesh = next(i for i, p in enumerate(blank.start.peaks) if p.element == "Mesh")
    assert worst.start.peaks[mesh].minimum < 1.005 * blank.start.peaks[mesh].minimum
    assert worst.case_sha256 != blank.case_sha256


def test_clearances_are_simulated_at_each_phase() -> None:
    """Where teeth part at any phase, its peaks are those of the start with events at that phase."""
    plain = geared()
    elements = tuple(
        replace(e, stiffness=1e8) if e.kind == "gear mesh" else e for e in plain.elements
    )
    mesh = MeshRow("Mesh", None, 0.3, 0.1, backlash=5e-4)
    case = replace(plain, elements=elements, meshes=(mesh,), pulsation_phase=None)
    worst = run(replace(case, pulsation_phase="worst"))
    assert worst.start is not None
    assert worst.start.phase is not None
    own = run(replace(case, pulsation_phase=worst.start.phase))
    assert own.start is not None
    assert worst.plans[-1].events
    assert own.plans[-1].events
    for peak, one in zip(worst.start.peaks, own.start.peaks, strict=True):
        assert peak.maximum >= one.maximum
        assert peak.minimum <= one.minimum


def test_a_field_follows_half_the_phase() -> None:
    """It pulls in another way a whole turn of the phase later, so that two turns are calculated."""
    given = {
        "field_slip": 0.05, "pull_out_torque": 2.5e4, "field_time_constant": 0.2, "end_speed": None, "maximum_time": 12.0,
        "load_torque": (), "damping_ratio": 0.01, "effect_choices": (EffectChoiceRow("motor transient", "on"),),
    }  # fmt: skip
    case = case_from_data(**given)
    assert case.turns_of_phase == 2
    assert case_from_data().turns_of_phase == 1
    once, again, twice = (
        run(replace(case, pulsation_phase=2.0 * math.pi * k)).start for k in range(3)
    )
    assert once is not None
    assert again is not None
    assert twice is not None
    assert once.pull_in is not None
    assert again.pull_in is not None
    assert twice.outcome.time == pytest.approx(once.outcome.time, rel=1e-6)
    assert abs(again.outcome.time - once.outcome.time) > 0.1


def test_one_start_needs_one_phase() -> None:
    with pytest.raises(ModelError, match=r"Type a phase, for example Worst phase"):
        started(geared(pulsation_phase="worst"))
