"""The plan: each effect's decision with its number, forced choices, and revised plans."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

import engine.run as conductor
from engine.case.case import Case
from engine.case.data import EffectChoiceRow, ElementRow, MeshRow, StationRow, TorqueTimeRow
from engine.case.effect import StartEffects
from engine.case.effects import EFFECTS
from engine.model.modal_analysis import analyse
from engine.plan.evidence import (
    BACKLASH_GAIN,
    ElementMinimum,
    Evidence,
    StartEvidence,
    collect_evidence,
)
from engine.plan.plan import first_plan, revised_plan, with_times
from engine.run import PlannedStart, planned_start, run
from engine.start.peaks import change_of_peaks
from tests.random_effects import with_bearings, with_dampers, with_judged_shafts
from tests.random_starts import random_start
from tests.sample_case import sample_case
from tests.trains import MOTOR, RATED, geared, load, motor, prepared


def chosen(case: Case, **choices: str) -> Case:
    """The case with some effects forced; blanks of a name written as underscores."""
    rows = tuple(EffectChoiceRow(k.replace("_", " "), v) for k, v in choices.items())
    return replace(case, effect_choices=rows)


def planned(case: Case) -> PlannedStart:
    return planned_start(case, analyse(case))


def with_clearance(case: Case) -> Case:
    """The sample or geared train with an elastic mesh that has a backlash."""
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    elements = tuple(
        replace(e, stiffness=e.stiffness or 1e8) if e.kind == "gear mesh" else e
        for e in case.elements
    )
    meshes = tuple(
        MeshRow(e.element, None, 0.3, 0.3 * ratio[e.from_] / ratio[e.to], backlash=5e-4)
        for e in elements
        if e.kind == "gear mesh"
    )
    return replace(case, elements=elements, meshes=meshes)


# --- what each effect is decided by ---------------------------------------------------------------


def test_a_rigid_mesh_carries_the_drag_of_its_far_side() -> None:
    """Two gears and nothing elastic, constant torques: what the mesh carries grows with the drag, in closed form."""
    here, there, ratio, drag, drive, driven, end = 50.0, 1.0, 3.0, 0.5, 6000.0, 100.0, 180.0
    case = Case(
        line_frequency=60.0, poles=4, rated_torque=RATED, damping_ratio=0.01, end_speed=end,
        stations=(StationRow("Bull gear", None, here), StationRow("Pinion", None, there, ratio, drag)),
        elements=(ElementRow("Mesh", "gear mesh", "Bull gear", "Pinion"),),
        motor_torque=motor("Bull gear", curve=((0.0, drive / RATED, 0.0), (1.0, drive / RATED, 0.0))),
        load_torque=load("Pinion", curve=((0.0, driven / RATED), (1.0, driven / RATED))),
    )  # fmt: skip
    whole = here + ratio**2 * there

    def carried(speed: float) -> float:
        return drive - here * (drive - ratio * driven - ratio**2 * drag * speed) / whole

    (peak,) = run(case).start.peaks  # type: ignore[union-attr]
    assert peak.maximum == pytest.approx(carried(end), abs=peak.error)
    assert carried(end) > 1.3 * carried(0.0)


def test_one_decision_an_effect_in_the_order_of_the_sheet():
    plan = planned(sample_case("modified")).plan
    assert [d.effect for d in plan.decisions] == list(EFFECTS)
    assert plan.number == 1
    assert all(d.choice == "auto" and d.why for d in plan.decisions)
    assert all(d.bound is None for d in plan.decisions if d.on)


def test_no_mode_in_reach_of_the_pulsation_switches_the_sweep_off_and_changes_no_number():
    case = geared()
    stiff = replace(
        case,
        elements=tuple(
            replace(e, stiffness=100.0 * e.stiffness if e.stiffness else None)
            for e in case.elements
        ),
    )
    results = run(stiff)
    sweep = results.plans[-1].decision("resonance sweep")
    assert not sweep.on
    assert sweep.bound == 0.0
    first = float(results.modes.elastic_frequency[0])
    assert sweep.deciding_number == pytest.approx(first / 120.0)
    assert sweep.deciding_number > sweep.limit
    forced = run(chosen(stiff, resonance_sweep="on"))
    assert results.crossings == forced.crossings == ()
    assert run(case).plans[-1].decision("resonance sweep").on
    assert run(case).crossings


def test_stress_below_endurance_needs_no_counting():
    case = sample_case("modified")
    thick = [
        replace(e, stress_diameter=1.3 * e.stress_diameter) if e.stress_diameter else e
        for e in case.elements
    ]
    low = replace(case, elements=tuple(thick))
    results = run(low)
    counting = results.plans[-1].decision("cycle counting")
    assert not counting.on
    assert counting.bound == 0.0
    assert counting.deciding_number < counting.limit == 1.0
    assert results.starts.unlimited
    assert not any(s.counted for s in results.starts.shafts)
    forced = run(chosen(low, cycle_counting="on"))
    assert all(s.counted for s in forced.starts.shafts)
    assert forced.starts.unlimited
    # the number is what the fatigue analysis finds, plus the error of the history
    shaft = results.starts.shafts[0]
    ratio = shaft.largest_amplitude / shaft.endurance
    assert ratio < counting.deciding_number < 1.01 * ratio


def test_counting_forced_off_is_warned_of():
    results = run(chosen(sample_case("modified"), cycle_counting="off"))
    counting = results.plans[-1].decision("cycle counting")
    assert (counting.on, counting.bound, results.starts) == (False, None, None)
    assert counting.why.startswith("Forced off although required: ")
    assert any("'cycle counting' is forced off" in w for w in results.warnings)
    assert "cycle counting" not in results.plans[-1].left_out  # counting changes no torque
    assert not any("No shaft has stress diameter" in w for w in results.warnings)


def test_an_effect_that_has_nothing_to_simulate_cannot_be_forced_on():
    results = run(chosen(geared(), cycle_counting="on"))
    d = results.plans[-1].decision("cycle counting")
    assert (d.choice, d.on) == ("on", False)
    assert any("'cycle counting' is forced on, but cannot" in w for w in results.warnings)


def test_damping_that_couples_no_modes_has_a_bound_of_zero():
    d = planned(geared()).plan.decision("coupled damping")
    assert (d.on, d.deciding_number, d.bound) == (False, 0.0, 0.0)


@pytest.mark.parametrize(("strength", "on"), [(1e-9, False), (1e-1, True)])
def test_dampers_that_couple_modes_are_followed_as_they_are(strength, on):
    plan = planned(with_dampers(random_start(21), 21, strength)).plan
    d = plan.decision("coupled damping")
    assert d.on is plan.effects.coupled_damping is on
    assert (d.deciding_number > d.limit) is on
    assert (d.bound is None) is on


def test_modes_of_one_frequency_are_coupled_no_more_than_their_damping_lets_them():
    """Three equal branches have two modes of one frequency: its difference divides nothing."""
    discs = ("Motor", "Load", "Twin")
    branches = tuple(
        ElementRow(f"Shaft {k}", "shaft", disc, "Hub", 3.0e6, damping=100.0 * (k + 1))
        for k, disc in enumerate(discs)
    )
    stations = (*(StationRow(disc, None, 20.0) for disc in discs), StationRow("Hub", None, 10.0))
    case = geared(stations=stations, elements=branches, load_torque=load(rated=RATED))
    d = planned(case).plan.decision("coupled damping")
    assert 0.0 < d.deciding_number < 10.0


@pytest.mark.parametrize(("softness", "on"), [(1e-9, False), (1e-2, True)])
def test_bearings_that_give_are_simulated(softness, on):
    case = with_bearings(geared(), 3, softness)
    found = planned(case)
    d = found.plan.decision("bearings")
    assert found.plan.lateral is d.on is on
    assert (d.deciding_number > d.limit) is on
    assert bool(found.model.train.bodies) is on
    # the reported modes are with bearings either way
    assert analyse(case).reported.train.bodies


@pytest.mark.parametrize("choice", ["auto", "off"])
def test_bearings_left_out_say_why_there_are_no_forces(choice):
    case = with_bearings(geared(), 3, 1e-9)
    out = run(chosen(case, bearings=choice))
    assert out.start.bearing_forces == ()
    why = out.plans[-1].decision("bearings").why
    assert "BearingForces" in why
    assert "EffectChoices" in why
    forced = run(chosen(case, bearings="on"))
    assert {f.station for f in forced.start.bearing_forces} == {"Bull gear", "Pinion"}
    assert "BearingForces" not in forced.plans[-1].decision("bearings").why
    assert "BearingForces" not in run(geared()).plans[-1].decision("bearings").why


def test_a_mode_that_bearings_change_altogether_is_told_in_words():
    d = first_plan(CASE, replace(EVIDENCE, bearing_number=1.0)).decision("bearings")
    assert (d.deciding_number, d.on) == (1.0, True)
    assert d.why.startswith("Bearings change a mode completely (100 %")
    d = first_plan(CASE, replace(EVIDENCE, bearing_number=0.0312)).decision("bearings")
    assert "by up to 3.1 %, above the limit 0.002 %" in d.why
    d = first_plan(CASE, replace(EVIDENCE, bearing_number=math.inf)).decision("bearings")
    assert (d.deciding_number, d.on) == (None, True)
    assert "damp an otherwise undamped mode" in d.why


def pulled(pulsating: float = 1.5, **mesh: Any) -> Case:
    """Gears on bearings and so much pulsation that the torque of the mesh reverses."""
    rows = motor(curve=[(x, a, pulsating) for x, a, _ in MOTOR])
    case = with_bearings(geared(motor_torque=rows), 3, 1e-2)
    return replace(case, meshes=tuple(replace(m, **mesh) for m in case.meshes))


@pytest.mark.parametrize("gap", [None, 0.0])
def test_teeth_that_pull_for_want_of_a_gap_are_told(gap):
    results = run(pulled(backlash=gap))
    note = next(w for w in results.warnings if "cannot separate" in w)
    lowest = min(p.minimum for p in results.start.peaks if p.element == "Mesh")
    assert lowest < 0.0
    assert note.startswith("'Mesh': the torque falls to -")
    told = float(note.split("falls to ")[1].split(" N m")[0].replace(",", ""))
    assert told == pytest.approx(lowest, rel=1e-3)
    assert "with Backlash blank or 0 its teeth cannot separate" in note
    assert "Type its Backlash in table Meshes" in note


def test_teeth_that_do_not_pull_are_not_told_of():
    for case in (
        pulled(backlash=2e-4),  # they part
        chosen(pulled(), bearings="off"),  # nothing moves sideways
        replace(pulled(0.0), damping_ratio=0.1),  # the torque does not reverse
    ):
        results = run(case)
        assert results.start is not None
        assert not any("cannot separate" in w for w in results.warnings)


def test_bearings_forced_off_leave_the_modes_torsional():
    case = chosen(with_bearings(geared(), 3, 1e-2), bearings="off")
    results = run(case)
    assert not results.train.bodies
    assert results.plans[-1].decision("bearings").bound is None
    plain = chosen(with_bearings(geared(), 3, 1e-2), backlash="off")
    assert run(plain).train.bodies


@pytest.mark.slow
def test_the_shock_is_followed_unless_it_is_too_small_to_see():
    case = geared(shock_amplitude=RATED, shock_time_constant=0.05)
    assert planned(case).plan.effects.breaker_closing
    tiny = geared(shock_amplitude=1e-8 * RATED, shock_time_constant=0.05)
    d = planned(tiny).plan.decision("breaker closing")
    assert not d.on
    assert d.bound == d.deciding_number <= d.limit


def test_the_shock_goes_with_the_square_of_the_voltage_like_the_torque_it_is_compared_with():
    """Both sides of the ratio fall alike, so that half the voltage decides nothing else."""
    shock = {"shock_amplitude": 0.3 * RATED, "shock_time_constant": 0.05}
    # 0.6 + 0.25 of rated torque at standstill; 2 + 120 π · 0.05 times as much at resonance
    expected = 0.3 * (2.0 + 120.0 * math.pi * 0.05) / 0.85
    for voltage in (None, 0.5, 1.4):
        share = evidence_of(geared(voltage=voltage, **shock)).shock_share
        assert share == pytest.approx(expected, rel=1e-12), voltage


def test_the_shocks_of_several_motors_add_and_are_compared_with_the_weakest():
    """A second motor of a tenth of the torque, on the shaft that turns three times as fast."""
    shock = {"shock_amplitude": 0.3 * RATED, "shock_time_constant": 0.05}
    rows = (*motor(), *motor("Load", 0.1 * RATED))
    share = evidence_of(geared(poles=12, motor_torque=rows, **shock)).shock_share
    at_motor_shaft = 0.3 * (1.0 + 3.0)  # of RATED: the stated amplitude at each motor's own shaft
    grown = 2.0 + 120.0 * math.pi * 0.05
    assert share == pytest.approx(at_motor_shaft * grown / (0.1 * 3.0 * 0.85), rel=1e-12)


def test_without_a_motor_no_breaker_closes():
    case = geared(
        motor_torque=(),
        load_torque=(),
        torque_time=(TorqueTimeRow("Motor", 0.0, 1e4), TorqueTimeRow("Motor", 0.5, 2e4)),
        shock_amplitude=RATED,
        shock_time_constant=0.05,
    )
    d = run(case).plans[-1].decision("breaker closing")
    assert (d.on, d.bound, d.time) == (False, 0.0, None)
    assert "No motor curve" in d.why


def test_an_effect_without_anything_to_simulate_shows_no_time():
    decisions = run(geared()).plans[-1].decisions
    blank = {d.effect for d in decisions if d.time is None}
    assert blank >= {
        "bearings", "breaker closing", "pull-in", "aborted start", "backlash", "cycle counting"
    }  # fmt: skip
    assert not blank & {"resonance sweep", "coupled damping", "fast modes", "run length"}


def test_fast_modes_forced_on_says_which_it_cannot_follow():
    """A link of 1e14 N m/rad without damping rings at over a million Hz until the end."""
    case = geared(damping_ratio=None)
    elements = tuple(
        replace(e, stiffness=1e14) if e.element == "Low-speed shaft" else e for e in case.elements
    )
    forced = run(chosen(replace(case, elements=elements), fast_modes="on"))
    d = forced.plans[-1].decision("fast modes")
    assert forced.start.kept_modes == forced.modes.n_modes - 1 == 2
    assert d.on
    assert "2 of 3 modes integrated" in d.why
    assert "the others are too fast to integrate" in d.why
    assert f"{d.deciding_number:.2g}" in d.why
    whole = run(chosen(geared(), fast_modes="on")).plans[-1].decision("fast modes")
    assert "All 3 modes" in whole.why


def test_run_length_states_the_rigid_run_up():
    found = planned(geared())
    d = found.plan.decision("run length")
    assert not d.on
    assert d.deciding_number == pytest.approx(found.start.runup.time[-1])
    # no more than the load's share away from what the simulation takes
    assert d.deciding_number == pytest.approx(found.start.outcome.time, rel=0.02)
    assert d.limit == 600.0


def test_a_stalled_start_has_no_run_up_time():
    d = planned(
        geared(motor_torque=motor(curve=((0.0, 0.5, 0.1), (0.5, 0.0, 0.1), (1.0, 0.0, 0.1))))
    )
    decision = d.plan.decision("run length")
    assert decision.deciding_number is None
    assert "never reaches the end speed" in decision.why
    assert decision.bound is None


def test_without_a_start_there_is_nothing_to_simulate():
    case = geared(motor_torque=(), load_torque=())
    plan = run(case).plans[-1]
    assert not any(d.on for d in plan.decisions)
    assert plan.effects == StartEffects()


def test_prescribed_torques_part_teeth_too():
    case = replace(
        with_clearance(geared(motor_torque=(), load_torque=())),
        torque_time=(TorqueTimeRow("Motor", 0.0, 1e4), TorqueTimeRow("Motor", 1.0, -1e4)),
    )
    results = run(case)
    d = results.plans[-1].decision("backlash")
    assert (d.on, d.bound) == (True, None)
    assert results.start.outcome.outcome == "completed"
    assert results.reversals[0].model == "clearance"
    assert results.reversals[0].impacts > 0


# --- field and trip, from the rigid run-up --------------------------------------------------------


def evidence_of(case: Case) -> Evidence:
    return collect_evidence(case, prepared(case))


def test_the_field_is_applied_where_the_rigid_train_comes_to_its_slip():
    case = geared(field_slip=0.05, pull_out_torque=1.5 * RATED)
    plan = first_plan(case, evidence_of(case))
    d = plan.decision("pull-in")
    assert plan.effects.pull_in
    assert plan.events
    assert d.deciding_number == pytest.approx(0.05)
    stall = motor(curve=((0.0, 0.5, 0.1), (0.5, 0.0, 0.1), (1.0, 0.0, 0.1)))
    case = replace(case, motor_torque=stall)
    d = first_plan(case, evidence_of(case)).decision("pull-in")
    assert (d.on, d.bound) == (False, 0.0)
    assert d.deciding_number > 0.5
    assert "which is not reached" in d.why


def test_what_is_left_out_of_a_start_with_events_is_measured_on_one_with_events():
    """The start with every effect was one without field: it ended at the slip where the field comes."""
    shock = {"shock_amplitude": 1e-5, "shock_time_constant": 0.05}
    case = geared(field_slip=0.05, pull_out_torque=1.5 * RATED, **shock)
    found, with_shock = planned(case), planned(chosen(case, breaker_closing="on"))
    assert found.plan.decision("breaker closing").on is False
    change = change_of_peaks(found.start.peaks, with_shock.start.peaks)
    assert change > 0.0
    assert found.plan.decision("breaker closing").bound == pytest.approx(change, rel=1e-3)
    assert found.full is not None
    assert found.full.pull_in is not None


def test_a_trip_speed_on_the_way_aborts_the_start():
    synchronous = geared().ratings.synchronous_speed
    case = geared(trip_speed=0.6 * synchronous)
    plan = first_plan(case, evidence_of(case))
    assert plan.effects.aborted_start
    assert plan.decision("aborted start").deciding_number == pytest.approx(0.97 / 0.6)
    stall = motor(curve=((0.0, 0.5, 0.1), (0.4, 0.0, 0.1), (1.0, 0.0, 0.1)))
    case = replace(case, motor_torque=stall)
    assert not first_plan(case, evidence_of(case)).effects.aborted_start


def test_a_rigid_mesh_without_a_row_in_meshes_is_a_mesh() -> None:
    """It reverses in this start: that its clearance is blank is said, and no bound is claimed."""
    d = run(geared()).plans[-1].decision("backlash")
    assert (d.on, d.bound) == (False, None)
    assert d.deciding_number is not None
    assert d.deciding_number < 0.0
    assert "no clearance is given for 'Mesh'" in d.why


# --- backlash and revised plans -------------------------------------------------------------------


def told(minima: tuple[ElementMinimum, ...], **fields: Any) -> StartEvidence:
    return StartEvidence(minima, 1e-7, 3, 2.0, "reached", 0.5, False, 0.01, **fields)


def minimum(element: str, lowest: float, clearance: bool = True) -> ElementMinimum:
    return ElementMinimum(element, 100.0 * lowest, 0.0, 100.0, clearance)


CASE = with_clearance(geared())
EVIDENCE = replace(evidence_of(CASE), clearances=("Mesh", "Other"))


def test_no_reversal_in_the_linear_run_leaves_the_clearance_out_exactly():
    e = replace(EVIDENCE, linear=told((minimum("Mesh", 0.01), minimum("Other", 0.2))))
    plan = first_plan(CASE, e)
    d = plan.decision("backlash")
    assert (d.on, d.bound, d.deciding_number) == (False, 0.0, 0.01)
    assert d.limit == pytest.approx(-EVIDENCE.tolerance / BACKLASH_GAIN)
    assert plan.effects.clearances == ()


def test_a_reversal_too_shallow_to_matter_is_bounded():
    e = replace(EVIDENCE, linear=told((minimum("Mesh", -1e-4), minimum("Other", 0.2))))
    d = first_plan(CASE, e).decision("backlash")
    assert not d.on
    assert d.bound == pytest.approx(BACKLASH_GAIN * 1e-4)
    assert d.bound < e.tolerance


def test_an_error_that_reaches_below_zero_counts_as_reversal():
    reaching = ElementMinimum("Mesh", 1.0, 2.0, 100.0, True)
    plan = first_plan(CASE, replace(EVIDENCE, linear=told((reaching, minimum("Other", 0.1)))))
    assert plan.decision("backlash").on
    assert plan.decision("backlash").deciding_number == pytest.approx(-0.01)


def test_where_one_element_reverses_all_get_their_clearance():
    """The damping of teeth that only come near parting is limited, too."""
    e = replace(EVIDENCE, linear=told((minimum("Mesh", -0.3), minimum("Other", 0.1))))
    assert first_plan(CASE, e).effects.clearances == ("Mesh", "Other")
    assert first_plan(chosen(CASE, backlash="on"), e).effects.clearances == ("Mesh", "Other")
    assert "'Other'" not in first_plan(CASE, e).decision("backlash").why
    off = first_plan(chosen(CASE, backlash="off"), e)
    assert off.effects.clearances == ()
    assert off.decision("backlash").bound is None
    assert off.warnings


def test_a_reversal_without_a_clearance_names_what_to_fill_in():
    e = replace(EVIDENCE, linear=told((minimum("Mesh", -0.3, clearance=False),)))
    d = first_plan(CASE, e).decision("backlash")
    assert (d.on, d.bound) == (False, None)
    assert "no clearance is given for 'Mesh'" in d.why


def test_a_reversal_with_a_clearance_of_zero_leaves_nothing_out():
    tight = replace(minimum("Mesh", -0.3, clearance=False), tight=True)
    d = first_plan(CASE, replace(EVIDENCE, linear=told((tight,)))).decision("backlash")
    assert (d.on, d.bound) == (False, 0.0)
    assert "the clearance given for 'Mesh' is 0" in d.why
    assert "no clearance is given" not in d.why
    both = (tight, minimum("Other", -0.2, clearance=False))
    d = first_plan(CASE, replace(EVIDENCE, linear=told(both))).decision("backlash")
    assert d.bound is None
    assert "no clearance is given for 'Other'" in d.why
    # typed as 0, not left blank
    rows = motor(curve=[(x, a, 1.5) for x, a, _ in MOTOR])
    zero = tuple(replace(m, backlash=0.0) for m in CASE.meshes)
    typed = run(replace(CASE, meshes=zero, motor_torque=rows)).plans[-1].decision("backlash")
    assert "is 0" in typed.why
    assert typed.bound == 0.0


def test_a_run_that_finds_a_plan_wrong_makes_a_new_one():
    e = replace(EVIDENCE, linear=told((minimum("Mesh", 0.3), minimum("Other", 0.1))))
    old = first_plan(CASE, e)
    found = replace(e, event=told((minimum("Mesh", 0.2), minimum("Other", -0.2))))
    new = revised_plan(CASE, old, found)
    assert new.number == 2
    assert new.effects.clearances == ("Mesh", "Other")
    assert "'Other' (-0.2 of its largest torque)" in new.reason
    assert "'Mesh' (" not in new.reason
    assert "plan 1" in new.reason
    assert old.effects.clearances == ()  # never altered
    again = replace(e, event=told((minimum("Mesh", -0.8), minimum("Other", -0.3))))
    assert revised_plan(CASE, new, again) == new


def test_stress_that_rises_above_endurance_with_clearances_is_counted_after_all():
    judged = with_judged_shafts(CASE, 1, 0.5)
    e = replace(EVIDENCE, judged=1, linear=told((minimum("Mesh", -0.3),)))
    old = first_plan(judged, e)
    assert not old.cycle_counting
    hard = replace(told((minimum("Mesh", -0.8),)), must_count=True, stress_ratio=1.7)
    new = revised_plan(judged, old, replace(e, event=hard))
    assert (new.number, new.cycle_counting) == (2, True)
    assert new.effects == old.effects
    assert new.decision("cycle counting").deciding_number == 1.7


def test_the_stresses_that_are_told_are_those_of_the_last_run():
    """A note on the linear start's stresses would be read as one on those reported."""
    judged = with_judged_shafts(CASE, 1, 0.5)
    e = replace(EVIDENCE, judged=1, linear=told((minimum("Mesh", -0.3),)))
    old = first_plan(judged, e)
    higher = replace(told((minimum("Mesh", -0.8),)), stress_ratio=0.9)
    told_now = revised_plan(judged, old, replace(e, event=higher))
    assert (told_now.number, told_now.effects) == (1, old.effects)
    assert old.decision("cycle counting").deciding_number == 0.5
    assert told_now.decision("cycle counting").deciding_number == 0.9
    assert "0.9 of endurance" in told_now.decision("cycle counting").why


def test_an_effect_without_bound_that_is_forced_off_is_not_said_to_lack_data():
    results = run(chosen(with_clearance(geared()), backlash="off"))
    assert results.start.left_out is None
    note = next(w for w in results.warnings if "they pass no check" in w)
    assert "Take 'off' away from backlash in table EffectChoices." in note
    assert "data that are missing" not in note


def test_measured_times_change_nothing_else():
    e = replace(EVIDENCE, linear=told((minimum("Mesh", -0.3),)))
    plan = first_plan(CASE, e)
    timed = with_times(plan, {"backlash": 0.125})
    assert timed.decision("backlash").time == 0.125
    assert plan.decision("backlash").time == pytest.approx(10.0 * 0.01)
    assert [replace(d, time=None) for d in timed.decisions] == [
        replace(d, time=None) for d in plan.decisions
    ]


def test_every_plan_is_recorded_with_the_reason_of_the_next():
    """The torque of a smooth start reverses after the trip alone."""
    case = with_clearance(sample_case("modified"))
    smooth = tuple(replace(p, pulsating=0.0) for p in case.motor_torque)
    case = replace(case, motor_torque=smooth, trip_speed=100.0, damping_ratio=0.1, mode_damping=())
    found = planned(case)
    assert [p.number for p in found.plans] == [1, 2]
    assert [p.effects.clearances for p in found.plans] == [(), ("Mesh",)]
    assert "In the run of plan 1: torque reversed" in found.plans[1].reason
    assert "'Mesh'" in found.plans[1].reason


# --- what else is said ----------------------------------------------------------------------------


@pytest.mark.parametrize(("bearings", "bound"), [("on", None), ("off", 0.0)])
def test_a_gap_of_zero_is_the_linear_train_only_where_gears_are_held(bearings, bound):
    """With bearings the back flank pushes along a line of its own: then nothing is bounded."""
    case = chosen(pulled(backlash=0.0), bearings=bearings)
    decision = run(case).plans[-1].decision("backlash")
    assert decision.deciding_number < decision.limit
    assert (decision.on, decision.bound) == (False, bound)
    assert ("type a small clearance" in decision.why) == (bound is None)


def test_what_needs_a_motor_says_so_without_one():
    case = replace(
        geared(motor_torque=(), load_torque=()),
        torque_time=(TorqueTimeRow("Motor", 0.0, 1e4), TorqueTimeRow("Motor", 0.5, 2e4)),
        trip_speed=100.0,
        field_slip=0.03,
        pull_out_torque=RATED,
        voltage=0.8,
    )
    results = run(case)
    plan = results.plans[-1]
    assert "no motor to trip" in plan.decision("aborted start").why
    assert "no field to apply" in plan.decision("pull-in").why
    assert any("Voltage has no effect" in w for w in results.warnings)
    quiet = run(geared(shock_amplitude=0.0, shock_time_constant=0.05)).plans[-1]
    shock = quiet.decision("breaker closing")
    assert (shock.on, shock.bound, shock.why) == (False, 0.0, "ShockAmplitude is 0.")


def test_newmark_is_not_replaced_silently_and_does_not_set_the_step():
    """Its tiny steps are no business of a run with events."""
    case = with_clearance(geared())
    case = chosen(case, backlash="on")
    found, papers = run(case), run(replace(case, method="newmark"))
    assert papers.start.method == "exponential"
    assert any("Method newmark cannot simulate clearances" in w for w in papers.warnings)
    assert not any("newmark" in w for w in found.warnings)
    assert papers.start.step >= 0.5 * found.start.step


def test_starts_that_miss_their_accuracy_are_told(monkeypatch):
    case = with_judged_shafts(geared(), 3, 2.0)
    quiet = run(case)
    assert quiet.starts is not None
    assert not any("accuracy of allowable starts" in w for w in quiet.warnings)
    monkeypatch.setattr(conductor, "MAX_STARTS_REFINEMENTS", 0)
    rough = run(replace(case, tolerance_starts=1e-5))
    worst = max((e for _, e in rough.starts_error if e is not None), default=0.0)
    assert worst > 1e-5
    assert any("accuracy of allowable starts" in w for w in rough.warnings)


def test_dampers_of_bearings_and_to_ground_are_damping():
    bare = replace(geared(), damping_ratio=None)
    bare = replace(bare, elements=tuple(replace(e, damping=None) for e in bare.elements))
    said = [any("No damping is stated" in w for w in run(bare).warnings)]
    grounded = tuple(replace(s, damping=1.0) for s in bare.stations)
    said.append(any("No damping" in w for w in run(replace(bare, stations=grounded)).warnings))
    said.append(any("No damping" in w for w in run(with_bearings(bare, 3, 1.0)).warnings))
    assert said == [True, False, False]


def test_run_length_forced_on_goes_on_after_pull_in_where_a_time_is_given():
    case = geared(field_slip=0.05, pull_out_torque=1.5 * RATED)
    settled = run(case).start.outcome
    longer = replace(case, maximum_time=settled.time + 1.5)
    forced = run(chosen(longer, run_length="on")).start.outcome
    assert run(longer).start.outcome.time == pytest.approx(settled.time, rel=1e-9)
    assert forced.time == pytest.approx(settled.time + 1.5, rel=1e-9)
    assert forced.outcome == settled.outcome == "synchronised"


def test_modes_of_a_start_with_events_are_those_that_it_keeps():
    """The linear start leaves modes out, the one with clearances none: sheet Effects and accuracy tells the latter."""
    results = run(with_clearance(sample_case("proposed")))
    assert results.start is not None
    decision = results.plans[-1].decision("fast modes")
    kept = results.start.kept_modes
    assert decision.why == f"All {kept} modes integrated."
    assert decision.bound == results.start.truncation_error == 0.0
