"""The accuracy study: errors fall as the methods' orders say, and the sentence says what it found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.data import EffectChoiceRow, MeshRow, TorqueTimeRow
from engine.run import run
from engine.studies.accuracy.accuracy import AccuracyRow, AccuracyStudy, accuracy_study
from engine.studies.accuracy.accuracy import _cost as cost
from tests.sample_case import sample_case
from tests.trains import geared, motor


@pytest.fixture(scope="module")
def study() -> AccuracyStudy:
    return accuracy_study(sample_case("modified"), rounds=3)


def of(study: AccuracyStudy, method: str) -> list[AccuracyRow]:
    return [r for r in study.rows if r.method == method]


def test_at_least_five_settings_of_each_method_from_coarse_to_fine(study):
    assert {r.method for r in study.rows} == {"exponential", "newmark", "chosen", "alternative"}
    for method in ("exponential", "newmark"):
        rows = of(study, method)
        assert len(rows) >= 5
        assert len({r.setting for r in rows}) == len(rows)
        for answer in ("error_peak", "error_starts"):
            errors = [getattr(r, answer) for r in rows]
            assert errors == sorted(errors, reverse=True), (method, answer)
        assert all(r.time > 0.0 for r in rows)


def test_the_exponential_method_is_of_fourth_order_and_newmark_of_second(study):
    exponential = [r.error_peak for r in of(study, "exponential")]
    newmark = [r.error_peak for r in of(study, "newmark")]
    for finer, rate in ((exponential, 16.0), (newmark, 4.0)):
        falls = (finer[-4] / finer[-1]) ** (1.0 / 3.0)
        assert 0.5 * rate < falls < 2.0 * rate


def test_the_reference_is_a_hundred_times_finer_than_the_finest_setting(study):
    """Two references agree, and the other method, with none of its code, converges on the same."""
    next_finest, finest = of(study, "exponential")[-2:]
    assert study.reference_error_peak < 0.2 * finest.error_peak
    # a 9th power magnifies the rounding of stresses: the last halving gains starts little
    assert study.reference_error_starts < 0.1 * next_finest.error_starts
    assert of(study, "newmark")[-1].error_peak < 1e-4
    assert of(study, "newmark")[-1].error_starts < 1e-4
    assert "256 times smaller than that of the finest setting" in study.reference
    assert "medians of 3 runs in this process" in study.reference


def test_the_sentence_quotes_the_cheapest_measured_setting(study):
    text = study.sentence
    assert text.startswith("Wanted accuracy of 2 % on starts: ")
    assert "; 0.2 % would take " in text
    assert "Newmark at 2 % takes " in text


def test_every_other_approximation_has_its_price(study):
    """Modes left out may change a peak by no more than the start says; twice the modes are no other start."""
    (chosen,) = of(study, "chosen")
    prices = {r.setting: r for r in of(study, "alternative")}
    assert prices["all modes"].error_peak <= chosen.error_peak
    assert f"The start as calculated ({chosen.setting}) takes " in study.sentence
    assert "; all modes would take " in study.sentence


def test_the_start_as_calculated_has_an_error_of_starts(study):
    """As sheet Starts states it, with what is left out."""
    (chosen,) = of(study, "chosen")
    results = run(sample_case("modified"))
    errors = dict(results.starts_error)
    assert chosen.error_starts == max(
        errors[s.element] + (s.left_out or 0.0)
        for s in results.starts.shafts
        if errors[s.element] is not None
    )


def test_an_effect_left_out_costs_what_it_is_worth():
    """The same start with coupled damping on and off, each the other's alternative."""
    case = geared(tolerance_peak=1e-3)
    stations = (replace(case.stations[0], damping=5.0), *case.stations[1:])
    on, off = (
        accuracy_study(
            replace(
                case, stations=stations, effect_choices=(EffectChoiceRow("coupled damping", c),)
            ),
            rounds=1,
        )
        for c in ("on", "off")
    )
    worth = {r.setting: r.error_peak for s in (on, off) for r in of(s, "alternative")}
    of_off = worth["coupled damping off"]  # each is relative to its own peak
    assert worth["coupled damping on"] == pytest.approx(of_off / (1.0 + of_off), rel=1e-3)
    assert worth["coupled damping on"] > 0.0


def row(method: str, error: float, time: float) -> AccuracyRow:
    return AccuracyRow(method, "", error, 0.1 * error, time)


def test_the_cost_is_that_of_a_measured_setting():
    rows = [row("a", 1e-2, 0.001), row("a", 1e-4, 0.0143), row("a", 1e-3, 0.02), row("b", 1.0, 0.4)]
    assert cost(rows, "a", 1e-3, False) == "14 ms"
    assert cost(rows, "a", 1e-2, False) == "1 ms"
    assert cost(rows, "a", 1e-3, True) == "1 ms"
    assert cost(rows, "b", 1e-3, False).startswith("more than 400 ms")


def test_without_judged_shafts_the_sentence_is_about_peaks():
    found = accuracy_study(geared(tolerance_peak=1e-3), rounds=1)
    assert all(r.error_starts is None for r in found.rows)
    assert found.reference_error_starts is None
    assert found.sentence.startswith("Wanted accuracy of 0.1 % on peak torques: ")
    assert "of a single run" in found.reference


def test_a_stalled_start_is_studied_over_the_time_it_was_followed():
    stall = motor(curve=((0.0, 0.5, 0.1), (0.5, 0.0, 0.1), (1.0, 0.0, 0.1)))
    found = accuracy_study(geared(motor_torque=stall, maximum_time=3.0), rounds=1)
    assert len(of(found, "exponential")) + len(of(found, "newmark")) == 12
    assert of(found, "exponential")[-1].error_peak < 1e-6


def test_where_no_step_decides_there_is_nothing_to_study():
    case = geared(motor_torque=(), load_torque=())
    none = accuracy_study(case)
    assert none.rows == ()
    assert none.sentence.startswith("Nothing to study")
    prescribed = replace(
        case, torque_time=(TorqueTimeRow("Motor", 0.0, 1e3), TorqueTimeRow("Motor", 1.0, 1e3))
    )
    found = accuracy_study(prescribed)
    assert found.rows == ()
    assert "exact at any time step" in found.sentence
    assert "force backlash on" in found.sentence  # and what would make it worth a study


def test_prescribed_torques_that_part_teeth_are_studied():
    rows = (TorqueTimeRow("Motor", 0.0, 1e4), TorqueTimeRow("Motor", 0.3, -1e4))
    case = replace(
        geared(motor_torque=(), load_torque=(), torque_time=rows),
        elements=tuple(
            replace(e, stiffness=1e8) if e.kind == "gear mesh" else e for e in geared().elements
        ),
        meshes=(MeshRow("Mesh", None, 0.3, 0.1, backlash=5e-4),),
    )
    found = accuracy_study(case, rounds=1)
    events = of(found, "exponential with events")
    assert len(events) == 5
    assert [r.setting for r in of(found, "alternative")] == ["backlash off"]
    assert events[-1].error_peak <= 3e-4
    assert events[-1].error_peak <= events[0].error_peak
    assert found.sentence.startswith("Wanted accuracy of 0.1 % on peak torques: ")
    assert "paper" not in found.sentence
    assert "not studied" in found.reference


def test_progress_is_told():
    words: list[str] = []
    accuracy_study(geared(), rounds=1, on_progress=words.append)
    assert words[0] == "start with the effects of the plan"
    assert sum(w.startswith("reference") for w in words) == 2
    assert sum(w.startswith(("exponential", "newmark")) for w in words) == 12


def test_a_start_with_events_is_studied_by_tolerance_and_newmark_without_them():
    case = geared(trip_speed=0.5 * geared().ratings.synchronous_speed, maximum_time=4.0)
    found = accuracy_study(case, rounds=1)
    events = of(found, "exponential with events")
    assert len(events) == 5
    assert all(r.setting.startswith("tolerance") for r in events)
    assert events[-1].error_peak < 3e-4
    assert len(of(found, "newmark (linear train)")) == 6
    assert "cannot simulate events" in found.reference
    assert "(without clearances and events)." in found.sentence
