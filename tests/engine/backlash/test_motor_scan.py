"""Worst phase, angle and clearing time of an event of a motor."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.backlash.motor_scan import worst_instants
from engine.backlash.operating_events import OperatingEvent, operating_events
from engine.case.case import Case
from engine.case.data import (
    EffectChoiceRow,
    MaterialRow,
    MotorEventRow,
    SNPointRow,
    StationRow,
)
from engine.model.modal_analysis import analyse
from engine.model.modal_train import ModalTrain
from engine.results.tables import result_tables
from engine.run import run
from tests.engine.backlash.test_events_in_start import start
from tests.engine.results.test_motor_events import BASE, CIRCUIT, FAULT, SHEET, event, motor
from tests.engine.results.test_operating_events import rows, train, with_backlash
from tests.trains import RATED

TOGETHER = (EffectChoiceRow("backlash", "off"),)
#: Without resistance, and with equal subtransient reactances.
EQUAL = replace(
    CIRCUIT, rs=1e-6, rf=1e-6, rkd=1e-6, rkq=1e-6, xmq=CIRCUIT.xmd, xlkq=1.0 / (1.0 / 0.16 + 1.0 / 0.2049)
)  # fmt: skip
LL_FAULT = event("line-to-line fault", phase="worst")
FREE = replace(FAULT, clears_after="worst", latest_clearing=0.1)


def heavy(*events: MotorEventRow) -> Case:
    """A train that keeps its speed."""
    stations = tuple(replace(s, inertia=1e6 * s.inertia) for s in train().stations[:-1])
    load = StationRow("Load", None, 4e6, 3.0, running_load=0.9 * RATED / 3.0)
    return motor(*events, motor_circuit=(EQUAL,), stations=(*stations, load), maximum_time=0.05)


def scan(case: Case):
    results = run(replace(case, motor_events=(event("voltage dip", residual_voltage=0.97),)))
    modal = ModalTrain(results.train, results.modes, results.damping)
    return worst_instants(case, modal, case.motor_events[0])


def test_a_closing_is_worst_at_120_degrees():
    """sin δ + 2 sin ½δ is largest there (docs/motor.md)."""
    found = scan(heavy(event("out-of-phase closing", angle="worst"))).of_motor
    assert abs(found.row.angle) == pytest.approx(math.radians(120.0))
    subtransient = 0.12 + 1.0 / (1.0 / 0.73 + 1.0 / 0.2049 + 1.0 / 0.16)
    assert found.largest == pytest.approx(1.5 * math.sqrt(3.0) / subtransient * BASE, rel=2e-3)


def test_a_line_to_line_fault_is_worst_where_its_voltage_crosses_zero():
    """The faulted voltage is in quadrature with that of the healthy phase: its flux is then all offset."""
    found = scan(heavy(LL_FAULT)).of_motor
    beside = (found.row.phase + 0.5 * math.pi) % math.pi - 0.5 * math.pi
    assert abs(beside) <= math.radians(7.5)
    none = max(abs(row["largest"]) for phase in (45.0, 90.0) for row in air_gaps(phase))
    assert found.largest > 1.1 * none


def air_gaps(phase: float):
    case = heavy(replace(LL_FAULT, phase=math.radians(phase)))
    return result_tables(run(case))["AirGapTorque"]


def test_no_clearing_time_is_worse_than_the_worst_one_with_its_error():
    """Beside every event of a finer grid, calculated alone."""
    case = motor(FREE, effect_choices=TOGETHER)
    worst = rows(run(case))
    times = np.linspace(0.0005, 0.1, 161)
    events = [event("three-phase fault", f"{t:.6f}", clears_after=float(t)) for t in times]
    alone = rows(run(replace(case, motor_events=tuple(events))))
    for (_, element), row in worst.items():
        peak = max(abs(row["maximum"]), abs(row["minimum"]))
        sizes = [
            max(abs(r["maximum"]), abs(r["minimum"])) for (_, e), r in alone.items() if e == element
        ]
        assert max(sizes) <= peak * (1.0 + row["error"])
        assert row["error"] < 0.02
        nearest = times[int(np.argmax(sizes))]
        # another maximum may be as high within the error
        assert abs(nearest - row["worst_clearing_time"]) < 2e-3 or (
            max(sizes) == pytest.approx(peak, rel=2.0 * row["error"])
        )


@pytest.mark.parametrize("earliest", [0.0437, 0.07])
def test_no_breaker_opens_before_the_earliest_clearing(earliest):
    """The worst of all is that of a clearing before 0.05 s; beside every event of a finer grid, calculated alone."""
    case = motor(replace(FREE, earliest_clearing=earliest), effect_choices=TOGETHER)
    (found,) = run(case).events
    assert min(found.worst.clearing) == earliest
    assert max(found.worst.clearing) == 0.1
    times = np.linspace(earliest, 0.1, 81)
    events = [event("three-phase fault", f"{t:.6f}", clears_after=float(t)) for t in times]
    alone = rows(run(replace(case, motor_events=tuple(events))))
    for peak in found.response.peaks:
        assert earliest <= found.worst.of_element[peak.element].row.clears_after <= 0.1
        sizes = [
            max(abs(r["maximum"]), abs(r["minimum"]))
            for (_, e), r in alone.items()
            if e == peak.element
        ]
        assert max(sizes) <= peak.size * (1.0 + peak.relative_error)
        assert peak.size <= max(sizes) * 1.02
    unlimited = run(motor(FREE, effect_choices=TOGETHER)).events[0]
    assert found.worst.of_motor.largest <= unlimited.worst.of_motor.largest * 1.001


def test_the_worst_instant_typed_gives_the_same_peaks():
    case = motor(
        replace(LL_FAULT, clears_after="worst", latest_clearing=0.05), effect_choices=TOGETHER
    )
    results = run(case)
    table = rows(results)
    for element in {e for _, e in table}:
        row = table["event", element]
        typed = replace(LL_FAULT, phase=row["worst_phase"], clears_after=row["worst_clearing_time"])
        alone = rows(run(replace(case, motor_events=(typed,))))["event", element]
        for key in ("maximum", "minimum", "time", "damage"):
            assert alone[key] == row[key]
        assert "worst_angle" not in row
        assert "worst_phase" not in alone
    air_gap = result_tables(results)["AirGapTorque"][-1]
    typed = replace(
        LL_FAULT, phase=air_gap["worst_phase"], clears_after=air_gap["worst_clearing_time"]
    )
    alone = result_tables(run(replace(case, motor_events=(typed,))))["AirGapTorque"][-1]
    assert alone["largest"] == air_gap["largest"]
    assert air_gap["error"] > alone["error"]


def test_what_is_drawn_is_the_largest_torque_at_each_clearing_time():
    case = motor(FREE, effect_choices=TOGETHER)
    (found,) = run(case).events
    worst = found.worst
    assert len(worst.clearing) == 48  # eight in each of six periods
    middle = float(worst.clearing[20])
    alone = run(replace(case, motor_events=(replace(FAULT, clears_after=middle),))).events[0]
    assert worst.air_gap[20] == pytest.approx(abs(alone.air_gap.largest), rel=5e-3)
    (peak,) = (p for p in alone.response.peaks if p.element == worst.element)
    assert worst.torque[20] == pytest.approx(peak.size, rel=5e-3)
    (largest,) = (p for p in found.response.peaks if p.element == worst.element)
    assert largest.size == max(p.size for p in found.response.peaks)


def test_where_teeth_separate_the_instants_are_simulated_so():
    """Each as an event of its own, whose peaks no other of them exceeds."""
    loose = with_backlash(
        event_torque=(), motor_torque=(), motor_data=(SHEET,), motor_circuit=(CIRCUIT,),
        motor_events=(replace(FREE, latest_clearing=0.05),),
    )  # fmt: skip
    (found,) = run(loose).events
    shown, worst = {p.element: p for p in found.response.peaks}, found.worst
    assert len(worst.clearing) == 24
    assert found.response.left_out is None
    for i in (0, 7, 13, 22):
        row = replace(FAULT, clears_after=float(worst.clearing[i]))
        (alone,) = run(replace(loose, motor_events=(row,))).events
        assert alone.response.contacts[0].impacts > 0
        peaks = {p.element: p for p in alone.response.peaks}
        for name, peak in peaks.items():
            assert peak.size <= shown[name].size * 1.01 + peak.error
        assert worst.torque[i] == pytest.approx(peaks[worst.element].size, rel=2e-2)
        assert worst.air_gap[i] == pytest.approx(abs(alone.air_gap.largest), rel=2e-2)
    own = worst.of_element["Mesh"].row
    (alone,) = run(replace(loose, motor_events=(own,))).events
    (mesh,) = (p for p in alone.response.peaks if p.element == "Mesh")
    assert mesh.maximum == shown["Mesh"].maximum
    assert mesh.relative_error == shown["Mesh"].relative_error


def test_a_motor_that_cannot_carry_its_load_is_not_scanned():
    (found,) = run(motor(FREE, motor_circuit=(replace(CIRCUIT, rs=0.9),))).events
    assert found.response is None
    assert "does not carry its torque" in found.note


def test_a_worst_instant_with_slipping_poles_has_no_bound() -> None:
    """Torques then change too fast with the instant."""
    long = replace(FREE, latest_clearing=0.8)
    (found,) = run(motor(long, effect_choices=TOGETHER)).events
    assert "slips poles before the largest torque of" in found.note
    assert found.response.left_out is None
    assert any(p.high is None for p in found.response.peaks)
    (bounded,) = run(motor(FREE, effect_choices=TOGETHER)).events
    assert all(p.high is not None for p in bounded.response.peaks)


IN_START = replace(FAULT, clears_after="worst", latest_clearing=0.1, begins=1.5)
JUDGED = {
    "materials": (MaterialRow("steel", 800e6, 500e6, 130e6),),
    "sn_points": (SNPointRow("steel", 1e3, 340e6), SNPointRow("steel", 1e6, 130e6)),
}


def judged_start(*events: MotorEventRow) -> Case:
    """A start whose first shaft is damaged by the event."""
    plain = start(*events, meshes=())
    first = replace(plain.elements[0], stress_diameter=0.11, material="steel", scf=2.0)
    return start(*events, meshes=(), elements=(first, *plain.elements[1:]), **JUDGED)


@pytest.mark.parametrize(
    "case", [judged_start(IN_START), motor(FREE, effect_choices=TOGETHER)], ids=("start", "running")
)
def test_no_clearing_time_damages_more_than_the_worst_one(case: Case) -> None:
    """Beside every event of a finer grid, calculated alone."""
    (row,) = case.motor_events
    (found,) = run(case).events
    worst = {key: r for (_, key), r in rows(run(case)).items()}
    times = np.linspace(0.00125, 0.1, 80)
    alone = run(
        replace(
            case,
            motor_events=tuple(
                replace(row, event=f"{t:.6f}", clears_after=float(t), latest_clearing=None)
                for t in times
            ),
        )
    )
    for name, shown in worst.items():
        peak = max(abs(shown["maximum"]), abs(shown["minimum"]))
        mine = [r for (_, e), r in rows(alone).items() if e == name]
        sizes = [max(abs(r["maximum"]), abs(r["minimum"])) for r in mine]
        assert max(sizes) <= peak * (1.0 + shown["error"])
        assert peak <= max(sizes) * 1.02
        if shown["damage"] is None:
            continue
        damages = [r["damage"] for r in mine]
        assert max(damages) > 1e-4
        assert max(damages) <= shown["damage"] * (1.0 + shown["damage_error"])
        assert shown["damage"] <= max(damages) * 1.1
        own = replace(
            row, clears_after=shown["worst_clearing_time_of_damage"], latest_clearing=None
        )
        again = rows(run(replace(case, motor_events=(own,))))["event", name]
        assert again["damage"] == shown["damage"]
    assert found.worst.of_damage


def test_a_worst_instant_in_a_start_with_teeth_apart_has_no_bound() -> None:
    row = replace(IN_START, latest_clearing=0.02)
    (found,) = run(start(row)).events
    assert "simulated so at some instants" in found.note
    assert found.response.left_out is None
    shown = {p.element: p for p in found.response.peaks}
    for instant in (found.worst.of_motor, found.worst.of_element["Mesh"]):
        (alone,) = run(start(instant.row)).events
        for peak in alone.response.peaks:
            assert peak.size <= shown[peak.element].size * 1.02 + peak.error


BETWEEN = replace(FAULT, kind="line-to-line fault", phase=0.3, begins=1.5)


def alone_of(case: Case) -> OperatingEvent:
    """The only event of a case, without its start."""
    (found,) = operating_events(case, analyse(case))
    return found


def test_no_phase_of_the_pulsation_is_worse_than_the_worst_one() -> None:
    """Beside the event in starts at each 10 degrees from 2 on, calculated alone."""
    case = judged_start(BETWEEN)
    results = run(replace(case, pulsation_phase="worst"))
    (found,) = results.events
    phases = [math.radians(2.0 + 10.0 * k) for k in range(36)]
    alone = [alone_of(replace(case, pulsation_phase=phase)) for phase in phases]
    mine = [{p.element: p for p in one.response.peaks} for one in alone]
    for (_, name), row in rows(results).items():
        size = max(abs(row["maximum"]), abs(row["minimum"]))
        sizes = [peaks[name].size for peaks in mine]
        assert max(sizes) <= size * (1.0 + row["error"])
        assert size <= max(sizes) * 1.002
        assert max(sizes) > min(sizes) * (1.0 + 2.0 * row["error"])  # else it could not fail
        assert "worst_phase" not in row
        typed = alone_of(replace(case, pulsation_phase=row["worst_pulsation_phase"]))
        (own,) = (p for p in typed.response.peaks if p.element == name)
        assert (own.maximum, own.minimum) == (row["maximum"], row["minimum"])
        damages = [s.damage for one in alone for s in one.shafts if s.element == name]
        if damages:
            assert 0.0 < max(damages) <= row["damage"] * (1.0 + row["damage_error"])
            assert row["worst_pulsation_phase_of_damage"] is not None
    gap = result_tables(results)["AirGapTorque"][-1]
    largest = max(abs(one.air_gap.largest) for one in alone)
    assert largest <= abs(gap["largest"]) * (1.0 + gap["error"])
    assert gap["worst_pulsation_phase"] == found.worst.of_motor.instant.pulsation


@pytest.mark.parametrize("scanned", ["phase", pytest.param("clears_after", marks=pytest.mark.slow)])
def test_the_phase_of_the_start_is_looked_for_together_with_that_of_the_event(scanned: str) -> None:
    """Beside combinations by chance, calculated alone."""
    row = replace(BETWEEN, clears_after=0.05)
    latest = 0.05 if scanned == "clears_after" else None
    word = replace(row, **{scanned: "worst"}, latest_clearing=latest)
    found = alone_of(start(word, meshes=(), pulsation_phase="worst"))
    shown, rng = {p.element: p for p in found.response.peaks}, np.random.default_rng(17)
    for _ in range(25):
        chance = (
            0.05 * rng.uniform(0.1, 1.0) if scanned == "clears_after" else math.pi * rng.random()
        )
        typed = replace(row, **{scanned: chance})
        case = start(typed, meshes=(), pulsation_phase=2.0 * math.pi * rng.random())
        alone = alone_of(case)
        for peak in alone.response.peaks:
            assert peak.size <= shown[peak.element].size + shown[peak.element].error
        assert abs(alone.air_gap.largest) <= abs(found.air_gap.largest) * (
            1.0 + found.air_gap.error
        )
    instant = found.worst.of_motor.instant
    again = alone_of(start(instant.row, meshes=(), pulsation_phase=instant.pulsation))
    assert again.air_gap.largest == found.air_gap.largest


@pytest.mark.slow
def test_with_teeth_apart_no_bound_is_known_at_the_worst_phase_of_the_start() -> None:
    row = replace(FAULT, begins=1.5)
    found = alone_of(start(row, pulsation_phase="worst"))
    assert found.response.left_out is None
    assert "simulated so at some instants" in found.note
    shown = {p.element: p for p in found.response.peaks}
    instant = found.worst.of_element["Mesh"].instant
    alone = alone_of(start(instant.row, pulsation_phase=instant.pulsation))
    (mesh,) = (p for p in alone.response.peaks if p.element == "Mesh")
    assert mesh.maximum == shown["Mesh"].maximum


def test_an_event_in_operation_has_no_phase_of_the_pulsation() -> None:
    case = start(replace(FAULT, begins=None), meshes=(), maximum_time=0.3)
    plain, worst = (alone_of(replace(case, pulsation_phase=phase)) for phase in (0.0, "worst"))
    assert plain.response.peaks == worst.response.peaks


def test_an_event_that_slips_poles_says_so_once() -> None:
    """Not once more at every worst instant of an element."""
    long = replace(FREE, latest_clearing=0.8)
    (found,) = run(motor(long, effect_choices=TOGETHER)).events
    assert len({i.row for i in found.worst.of_element.values()}) > 1
    assert found.note.count("out of step") == 1
