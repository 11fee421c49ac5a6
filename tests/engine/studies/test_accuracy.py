"""The accuracy study: errors fall as the methods' orders say, and the sentence says what it found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.backlash.event_start import run_again
from engine.case.case import Case
from engine.case.data import EffectChoiceRow, MeshRow, TorqueTimeRow
from engine.model.modal_analysis import analyse
from engine.run import planned_start, run
from engine.start.pieces import analysis_for_start
from engine.studies.accuracy import alternatives as priced
from engine.studies.accuracy.accuracy import AccuracyRow, AccuracyStudy, accuracy_study
from engine.studies.accuracy.accuracy import _cost as cost
from engine.studies.accuracy.alternatives import price_sentence
from engine.studies.accuracy.answers import answers_of, errors_between
from tests.sample_case import sample_case
from tests.trains import geared, motor


@pytest.fixture(scope="module")
def study() -> AccuracyStudy:
    return accuracy_study(sample_case("modified"), rounds=3)


def chattering() -> Case:
    """Teeth that part again and again: runs with torques a billionth apart take other courses."""
    mesh = MeshRow(
        "Mesh",
        pitch_radius_drive=0.3,
        pitch_radius_driven=0.1,
        helix_angle=0.2,
        mesh_stiffness=8e8,
        orientation=0.4,
        backlash=4e-4,
    )
    curve = geared().motor_torque
    return geared(
        meshes=(mesh,),
        damping_ratio=0.001,
        tolerance_peak=1e-3,
        maximum_time=1.0,
        motor_torque=tuple(
            replace(r, average=0.5 * r.average, pulsating=3.0 * r.pulsating) for r in curve
        ),
    )


def with_shaft_inertia() -> Case:
    """The geared train with one shaft whose inertia is its own."""
    shaft = replace(geared().elements[0], od=0.1, length=1.0, density=7850.0)
    return geared(elements=(shaft, *geared().elements[1:]))


def of(study: AccuracyStudy, method: str) -> list[AccuracyRow]:
    return [r for r in study.rows if r.method == method]


@pytest.mark.slow
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


def test_where_all_modes_are_kept_fewer_have_their_price():
    """A third of the elastic modes fewer; the change is that of the two starts, each calculated by itself."""
    case = sample_case("modified")
    case = replace(case, effect_choices=(EffectChoiceRow("fast modes", "on"),))
    found = accuracy_study(case, rounds=1)
    (chosen,) = of(found, "chosen")
    all_modes = int(chosen.setting.split(" ")[0])
    (fewer,) = (r for r in of(found, "alternative") if "modes" in r.setting)
    left = all_modes - round((all_modes - 1) / 3)
    assert fewer.setting == f"{left} modes instead of {all_modes}"
    planned = planned_start(case, analysis_for_start(case))
    other = planned_start(case, analysis_for_start(case), most_modes=left)
    assert other.start.kept_modes == left
    assert fewer.error_peak == pytest.approx(
        errors_between(
            answers_of(case, other.start.turning_of_element()),
            answers_of(case, planned.start.turning_of_element()),
        )[0]
    )
    assert f"; {fewer.setting} would take " in found.sentence


def test_what_fewer_modes_leave_out_is_static_and_found_by_comparison():
    """The highest mode follows statically; no error is estimated for it, so no step is refined because of it."""
    case = sample_case("modified")
    planned = planned_start(case, analysis_for_start(case))
    few = planned_start(case, analysis_for_start(case), most_modes=planned.start.kept_modes - 1)
    assert few.start.kept_modes == planned.start.kept_modes - 1
    assert few.start.halvings <= planned.start.halvings  # no finer step could mend it
    for a, b in zip(planned.start.peaks, few.start.peaks, strict=True):
        assert b.size == pytest.approx(a.size, rel=0.3)


def test_the_start_as_calculated_has_an_error_of_starts(study):
    """As sheet Fatigue states it, with what is left out."""
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


def test_the_ensemble_of_a_sensitive_start_has_its_row():
    """Its runs beyond the two of any start, what they cost, and the spread that they tell."""
    case = chattering()
    start = planned_start(case, analysis_for_start(case)).start
    found = accuracy_study(case, rounds=1)
    (row,) = of(found, "ensemble")
    assert start.repeatability.sensitive
    assert len(start.repeatability.further) == start.repeatability.runs - 2
    assert row.setting == f"{start.repeatability.runs - 2} further runs"
    assert row.error_peak == start.repeatability.spread
    assert row.time > 0.0
    assert f" of it for the {row.setting}" in found.sentence
    assert found.sentence.startswith("This start is sensitive: ")
    assert found.sentence.count(". ") == 2


def test_a_start_that_is_repeatable_has_no_row_of_an_ensemble(study):
    assert of(study, "ensemble") == []


def test_the_further_runs_of_the_ensemble_are_made_again():
    """Each at its own step: as many steps as their lengths take at least."""
    case = chattering()
    planned = planned_start(case, analysis_for_start(case))
    further = planned.start.repeatability.further
    inputs = case, planned.model, planned.plan.effects, planned.linear
    least = [0.9 * case.maximum_time / step for _, step in further]
    for one, steps in zip(further, least, strict=True):
        assert run_again(*inputs, (one,)) >= steps
    assert run_again(*inputs, further) >= sum(least)


def test_the_price_of_more_pieces_includes_their_modes(monkeypatch):
    """Modes are found within what is timed: for the start as calculated in its pieces, then in twice as many."""
    within: list[bool] = []
    found: list[tuple[bool, int]] = []

    def timed(once, rounds):
        within.append(True)
        result = once()
        within.pop()
        return result, 1.0

    def analysed(case, least_pieces):
        found.append((bool(within), least_pieces))
        return analyse(case, least_pieces=least_pieces)

    monkeypatch.setattr(priced, "timed_runs", timed)
    monkeypatch.setattr(priced, "analyse", analysed)
    case = with_shaft_inertia()
    analysis = analysis_for_start(case)
    most = max(pieces for _, pieces in analysis.subdivided.segments)
    rows = priced.alternatives(case, analysis, planned_start(case, analysis), 1, lambda words: None)
    assert rows[-1].setting == "shafts in twice the pieces"
    assert all(timed for timed, _ in found)
    assert [pieces for _, pieces in found] == [most] * (len(rows) - 1) + [2 * most]


def test_the_sentence_has_what_changes_most_and_the_modes_alone():
    rows = (
        AccuracyRow("chosen", "12 modes", 1e-3, None, 0.005),
        AccuracyRow("ensemble", "10 further runs", 0.1, None, 0.003),
        AccuracyRow("alternative", "bearings off", 0.25, 0.02, 0.004),
        AccuracyRow("alternative", "backlash on", 0.0, None, 0.09),
        AccuracyRow("alternative", "8 modes instead of 12", 0.09, None, 0.003),
    )
    assert price_sentence(geared(), rows) == (
        "The start as calculated (12 modes) takes 5 ms, 3 ms of it for the 10 further runs; "
        "bearings off would take 4 ms and change a peak by 25 % and the starts by 2 %; "
        "8 modes instead of 12 would take 3 ms and change a peak by 9 %."
    )


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
    off, fewer = of(found, "alternative")
    assert off.setting == "backlash off"
    assert fewer.setting.endswith(" modes instead of 4")
    assert fewer.error_peak > 0.0
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
