"""Events in operation in a run: rows, verdicts and damage; what is not calculated is said."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from engine.case.case import Case
from engine.case.data import (
    EffectChoiceRow,
    EventTorqueRow,
    MaterialRow,
    MeshRow,
    SNPointRow,
    StationRow,
    TorqueTimeRow,
    case_digest,
)
from engine.case.result_words import Judgement
from engine.results.results import Results, Verdict
from engine.results.tables import Row, result_tables
from engine.run import run
from tests.trains import RATED, geared
from tests.validation.test_start_from_motor_data import SHEET

RATIO = 3.0
#: Half a cycle of line frequency past the peak of a published three-phase fault, decaying.
FAULT = (
    EventTorqueRow("Fault", "Motor", -4.0, 1.0, math.radians(90.0), 0.1),
    EventTorqueRow("Fault", "Motor", -1.0, None, None, 0.1),
)
#: So small that no torque falls to zero.
DIP = (EventTorqueRow("Dip", "Motor", 0.2, 1.0, None, 0.1),)


def train(*events: EventTorqueRow, **fields: object) -> Case:
    """A geared train under load with stress, limits and S-N points at the low-speed shaft."""
    plain = geared()
    stations = tuple(
        replace(s, running_load=0.9 * RATED / RATIO) if s.station == "Load" else s
        for s in plain.stations
    )
    first = replace(plain.elements[0], stress_diameter=0.12, material="steel", scf=2.0)
    given: dict[str, object] = {
        "stations": stations,
        "elements": (first, *plain.elements[1:]),
        "materials": (MaterialRow("steel", 800e6, 500e6, 130e6),),
        "sn_points": (SNPointRow("steel", 1e3, 340e6), SNPointRow("steel", 1e6, 130e6)),
        "meshes": (MeshRow("Mesh", backlash=0.0),),
        "event_torque": events,
    }
    return geared(**(given | fields))


def rows(results: Results) -> dict[tuple[str, str], Row]:
    return {(r["event"], r["element"]): r for r in result_tables(results)["EventPeaks"]}


def check(results: Results, name: str) -> Verdict:
    (found,) = (v for v in results.verdicts if v.check == name)
    return found


def test_a_run_judges_each_event_beside_the_start() -> None:
    results = run(train(*FAULT, *DIP))
    found = rows(results)
    fault, dip = found["Fault", "Low-speed shaft"], found["Dip", "Low-speed shaft"]
    size = max(abs(fault["maximum"]), abs(fault["minimum"]))
    assert fault["times_rated"] == pytest.approx(size / RATED, rel=1e-12)
    assert fault["peak_stress"] == pytest.approx(16.0 * size / (math.pi * 0.12**3), rel=1e-12)
    # shear yield of 250 MPa in a shaft of 120 mm
    assert fault["limit"] == pytest.approx(250e6 * math.pi * 0.12**3 / 16.0, rel=1e-12)
    assert fault["verdict"] == Judgement.PASS
    assert fault["error"] <= 1e-3
    assert fault["left_out"] == 0.0
    assert fault["damage"] > 0.0
    assert dip["damage"] == 0.0
    assert found["Fault", "Mesh"]["verdict"] == Judgement.NOT_JUDGED  # without a limit
    worst = check(results, "Shear yield in events")
    assert worst.where == "Low-speed shaft in Fault"
    assert worst.result == pytest.approx(fault["peak_stress"])
    assert check(results, "Peak torque in events").verdict == Judgement.NOT_JUDGED


def test_an_event_changes_nothing_of_the_start() -> None:
    without, with_event = run(train()), run(train(*FAULT))
    names = ("StartupPeaks", "AllowableStarts", "TorqueReversals", "StartupCrossings")
    a, b = result_tables(without), result_tables(with_event)
    assert a["StartupPeaks"]
    assert [a[n] for n in names] == [b[n] for n in names]
    assert a["EventPeaks"] == []


def test_a_lower_limit_fails() -> None:
    case = train(*FAULT)
    first = replace(case.elements[0], peak_torque_limit=RATED)
    results = run(Case(**(vars(case) | {"elements": (first, *case.elements[1:])})))
    row = rows(results)["Fault", "Low-speed shaft"]
    assert (row["limit"], row["verdict"]) == (RATED, Judgement.FAIL)
    assert check(results, "Peak torque in events").verdict == Judgement.FAIL
    assert check(results, "Overall").verdict == Judgement.FAIL


def test_torque_time_of_a_running_train_is_an_event_and_no_start() -> None:
    table = tuple(TorqueTimeRow("Motor", t, x) for t, x in ((0.0, 0.0), (0.05, -2e4), (0.1, 0.0)))
    case = train(torque_time=table, initial_state="running")
    results, plain = run(case), run(train())
    assert set(rows(results)) == {("TorqueTime", str(e.element)) for e in case.elements}
    tables, others = result_tables(results), result_tables(plain)
    assert tables["StartupPeaks"] == others["StartupPeaks"]  # no part of the start
    alone = run(Case(**(vars(case) | {"motor_torque": (), "load_torque": ()})))
    assert alone.start is None
    assert alone.starts is None
    assert rows(alone)


def test_the_digest_of_a_case_without_events_is_that_of_before() -> None:
    assert case_digest(train()) == case_digest(train(initial_state=None))
    assert case_digest(train(*DIP)) != case_digest(train())


def test_without_a_running_load_the_train_begins_untwisted_and_that_is_said() -> None:
    unloaded = tuple(
        StationRow(s.station, None, s.inertia, s.speed_ratio) for s in train().stations
    )
    results = run(train(*DIP, stations=unloaded, load_torque=(), motor_torque=()))
    assert any("begin with an untwisted train" in note for note in results.warnings)


# --- clearances -----------------------------------------------------------------------------------


def test_a_mesh_of_unknown_clearance_that_reverses_passes_no_check() -> None:
    results = run(train(*FAULT, meshes=()))
    row = rows(results)["Fault", "Low-speed shaft"]
    assert row["left_out"] is None
    assert row["verdict"] == Judgement.INCOMPLETE
    assert check(results, "Shear yield in events").verdict == Judgement.INCOMPLETE
    assert any("no clearance is given" in note for note in results.warnings)
    calm = rows(run(train(*DIP, meshes=())))["Dip", "Low-speed shaft"]
    assert calm["left_out"] == 0.0


def with_backlash(running_load: float = 0.9 * RATED / RATIO, **fields: object) -> Case:
    """An elastic mesh with backlash."""
    case = train(*FAULT)
    mesh = replace(case.elements[1], stiffness=2.0e8)
    stations = tuple(
        replace(s, running_load=running_load) if s.station == "Load" else s for s in case.stations
    )
    given: dict[str, object] = {
        "elements": (case.elements[0], mesh, case.elements[2]),
        "meshes": (MeshRow("Mesh", "external", 0.75, 0.25, backlash=4e-4),),
        "stations": stations,
    }
    return train(*FAULT, **(given | fields))


def test_teeth_that_separate_are_simulated() -> None:
    results = run(with_backlash())
    (event,) = results.events
    assert event.response is not None
    assert event.response.contacts[0].impacts > 0
    tight = rows(
        run(with_backlash(meshes=(MeshRow("Mesh", "external", 0.75, 0.25, backlash=0.0),)))
    )
    loose = rows(results)["Fault", "Mesh"]
    assert loose["left_out"] == 0.0
    assert abs(loose["minimum"] / tight["Fault", "Mesh"]["minimum"] - 1.0) > 0.05


def test_backlash_forced_off_leaves_no_bound_and_passes_nothing() -> None:
    results = run(with_backlash(effect_choices=(EffectChoiceRow("backlash", "off"),)))
    row = rows(results)["Fault", "Low-speed shaft"]
    assert row["left_out"] is None
    assert row["verdict"] == Judgement.INCOMPLETE
    assert any("backlash is forced off" in note for note in results.warnings)


def test_without_driving_torque_no_flank_is_known() -> None:
    results = run(with_backlash(running_load=0.0))
    row = rows(results)["Fault", "Mesh"]
    assert row == {"event": "Fault", "element": "Mesh", "verdict": Judgement.NOT_JUDGED}
    verdict = check(results, "Events in operation")
    assert verdict.verdict == Judgement.NOT_JUDGED
    assert verdict.coverage == "0 of 1 events"
    assert "'Mesh' carries no driving torque" in str(verdict.not_judged)
    assert check(results, "Overall").verdict != Judgement.PASS


def test_amplitude_over_the_apparent_power() -> None:
    """2.2 MVA over 188.5 rad/s; the rated torque is another base."""
    row = EventTorqueRow("Dip", "Motor", 0.2, 1.0, None, 0.1)
    torque = SHEET.apparent_power / (60.0 * math.pi)
    of_torque = replace(row, amplitude=0.2 * torque / RATED)
    ours = rows(run(train(replace(row, base="apparent power"), motor_data=(SHEET,))))
    same = rows(run(train(of_torque, motor_data=(SHEET,))))
    for name, row_of in ours.items():
        assert row_of["maximum"] == pytest.approx(same[name]["maximum"], rel=1e-9)
    assert abs(torque / RATED - 1.0) > 0.05


def counted(times: float, **fields: object) -> Results:
    fault = (replace(FAULT[0], per_life=times), FAULT[1])
    soft = {  # starts damage it, too
        "materials": (MaterialRow("steel", 800e6, 500e6, 60e6),),
        "sn_points": (SNPointRow("steel", 1e3, 340e6), SNPointRow("steel", 1e6, 60e6)),
    }
    return run(train(*fault, **({"starts_required": 100.0} | soft | fields)))


def test_events_in_a_life_take_their_share_of_it() -> None:
    """Palmgren-Miner: required starts and events together."""
    results = counted(5.0)
    row = rows(results)["Fault", "Low-speed shaft"]
    assert row["damage_per_life"] == pytest.approx(5.0 * row["damage"], rel=1e-12)
    (start,) = result_tables(results)["AllowableStarts"]
    life = check(results, "Life of starts and events")
    expected = 5.0 * row["damage"] + 100.0 * start["damage"]
    assert start["damage"] > 0.0
    assert life.result == pytest.approx(expected, rel=1e-12)
    assert (life.limit, life.where) == (1.0, "Low-speed shaft")
    # the limit lies between these two numbers of events
    most = (1.0 - 100.0 * start["damage"]) / row["damage"]
    assert check(counted(0.9 * most), life.check).verdict in (Judgement.PASS, Judgement.INCOMPLETE)
    assert check(counted(1.1 * most), life.check).verdict == Judgement.FAIL
    assert check(counted(0.6 * most, starts_factor=2.0), life.check).verdict == Judgement.FAIL


def test_a_life_is_judged_only_where_events_are_counted() -> None:
    assert "Life of starts and events" not in [v.check for v in run(train(*FAULT)).verdicts]
    without = check(counted(5.0, starts_required=None), "Life of starts and events")
    assert without.verdict == Judgement.INCOMPLETE
    assert "StartsRequired is blank" in without.not_judged
    lost = counted(5.0, damping_ratio=None, starts_required=None)
    life = check(lost, "Life of starts and events")
    assert life.verdict == Judgement.NOT_JUDGED
    assert "event Fault is not calculated" in life.not_judged
