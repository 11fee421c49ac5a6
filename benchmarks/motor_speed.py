"""What the motor from its data costs, and what accuracy costs there: `python -m benchmarks.motor_speed`.

A motor of 4 poles at 60 Hz with the circuit of case SM04 drives a chain of ten discs. Calls take turns;
processor time of one thread, medians. The truth is `tests.machine_reference`: scipy's DOP853 at 1e-11, in angles and
fluxes, without modes.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())

import numpy as np  # noqa: E402

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table, milliseconds  # noqa: E402
from engine.backlash.event_start import run_event_start  # noqa: E402
from engine.backlash.operating_events import OperatingEvent, operating_events  # noqa: E402
from engine.case.case import Case  # noqa: E402
from engine.case.choices import MotorEventKind, Scanned  # noqa: E402
from engine.case.data import (  # noqa: E402
    ElementRow,
    MotorCircuitRow,
    MotorDataRow,
    MotorEventRow,
    StationRow,
)
from engine.case.effect import StartEffects  # noqa: E402
from engine.model.modal_analysis import analyse  # noqa: E402
from engine.motor.curves import slip_curves  # noqa: E402
from engine.motor.from_case import motors_from_data  # noqa: E402
from engine.start.start import run_start  # noqa: E402
from tests.machine_reference import LENGTH, reference  # noqa: E402

__all__ = ["PAGE", "speed_rows", "accuracy_rows"]

PAGE = Path(__file__).resolve().parents[1] / "docs" / "motor-speed.md"
STATIONS = 10
POWER, LINE, POLES = 8e6, 60.0, 4
SPEED = 4.0 * math.pi * LINE / POLES
FAULT = MotorEventRow("fault", "M0", MotorEventKind.THREE_PHASE_FAULT, clears_after=0.1)
#: To half speed, in 3 s.
A_START = {"maximum_time": None, "end_speed": 0.5 * SPEED}
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)


def train(**fields: Any) -> Case:
    """Ten discs with H = 2 s in all, elements between two of them at 12 to 90 Hz."""
    rated = POWER / SPEED
    inertia = 2.0 * 2.0 * POWER / SPEED**2 * np.linspace(1.0, 0.2, STATIONS)
    inertia /= np.linspace(1.0, 0.2, STATIONS).sum()
    own = 2.0 * math.pi * np.geomspace(12.0, 90.0, STATIONS - 1)
    between = 1.0 / (1.0 / inertia[1:] + 1.0 / inertia[:-1])
    stiffness, damping = between * own**2, 0.02 * between * own
    last = STATIONS - 1
    given: dict[str, Any] = {
        "line_frequency": LINE, "poles": POLES, "rated_torque": rated, "maximum_time": 0.5,
        "stations": tuple(
            StationRow(f"M{i}", None, float(inertia[i]), running_load=0.8 * rated if i == last else None)
            for i in range(STATIONS)
        ),
        "elements": tuple(
            ElementRow(f"E{i}", "shaft", f"M{i}", f"M{i + 1}", float(stiffness[i]), damping=float(damping[i]))
            for i in range(last)
        ),
        "motor_data": (MotorDataRow("M0", apparent_power=POWER, power_factor=1.0),),
        "motor_circuit": (
            MotorCircuitRow("M0", 0.012, 0.12, 1.10, 0.62, 0.0022, 0.18, 0.035, 0.09, 0.045, 0.12),
        ),
        "motor_events": (FAULT,),
    }  # fmt: skip
    return Case(**(given | fields))


def event_of(case: Case) -> OperatingEvent:
    """The only event of a case."""
    (event,) = operating_events(case, analyse(case))
    return event


def by_turns(calls: dict[str, Callable[[], Any]], rounds: int) -> dict[str, float]:
    """Median processor time of each call, which take turns. [s]"""
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for turn in range(rounds + 1):
        for name, call in calls.items():
            began = time.process_time()
            call()
            if turn:  # the first warms up
                taken[name].append(time.process_time() - began)
    return {name: median(times) for name, times in taken.items()}


def speed_rows(rounds: int) -> list[tuple[str, ...]]:
    """What is calculated, its processor time and its goal."""
    fault = train()
    (motor,) = motors_from_data(fault)
    slips = np.linspace(0.0, 1.0, 101)
    scan = replace(
        FAULT,
        kind=MotorEventKind.LINE_TO_LINE_FAULT,
        phase=Scanned.WORST,
        clears_after=Scanned.WORST,
    )
    of_twenty = train(motor_events=(replace(scan, latest_clearing=20.0 / (8.0 * LINE)),))
    of_all = train(motor_events=(scan,))
    begins = replace(FAULT, begins=0.5)
    in_start = train(motor_events=(begins,), **A_START)
    worst_in_start = train(motor_events=(replace(begins, clears_after=Scanned.WORST),), **A_START)
    plain, in_time = train(motor_events=(), **A_START), StartEffects(motor_transient=True)
    modal = analyse(plain).reported
    linear = run_start(plain, modal)
    calls: dict[str, tuple[Callable[[], Any], str]] = {
        "curves at 101 slips": (lambda: slip_curves(motor.circuit, slips), "≤ 1 ms"),
        f"three-phase fault, 0.5 s, {STATIONS} stations, with its error": (
            lambda: event_of(fault), "≤ 10 ms",
        ),
        "line-to-line fault, worst of 24 phases and 20 clearing times": (
            lambda: event_of(of_twenty), "≤ 1 s on two cores",
        ),
        "line-to-line fault, worst of 24 phases and 240 clearing times": (lambda: event_of(of_all), "–"),
        "three-phase fault in a start of 3 s, with its error": (lambda: event_of(in_start), "–"),
        "the same, worst of 240 clearing times": (lambda: event_of(worst_in_start), "–"),
        "start of 3 s from curves, with its error": (lambda: run_start(plain, modal), "–"),
        "the same with the motor's fluxes in time": (
            lambda: run_event_start(plain, modal, in_time, linear), "≤ 3 × the start from curves",
        ),
    }  # fmt: skip
    taken = by_turns({name: call for name, (call, _) in calls.items()}, rounds)
    return [
        (name, f"{milliseconds(taken_by)} ms", calls[name][1]) for name, taken_by in taken.items()
    ]


def accuracy_rows(rounds: int) -> list[tuple[str, ...]]:
    """Tolerance asked for, processor time, stated error, and the largest true one of element and motor."""
    base = train(maximum_time=LENGTH)
    elements, motor = reference(base)
    cases = {
        f"{tolerance:.0e}": train(maximum_time=LENGTH, tolerance_peak=tolerance)
        for tolerance in TOLERANCES
    }
    taken = by_turns({name: (lambda c=case: event_of(c)) for name, case in cases.items()}, rounds)
    rows = []
    for name, case in cases.items():
        event = event_of(case)
        response, air_gap = event.response, event.air_gap
        if response is None or air_gap is None:
            raise RuntimeError(event.note)
        largest = {p.element: p.size for p in response.peaks}
        true = max(
            abs(largest[e] / max(abs(high), abs(low)) - 1.0) for e, (high, low) in elements.items()
        )
        stated = max(p.relative_error for p in response.peaks)
        rows.append(
            (
                name, f"{milliseconds(taken[name])} ms", f"{stated:.1e}", f"{true:.1e}",
                f"{air_gap.error:.1e}", f"{abs(abs(air_gap.largest) / motor - 1.0):.1e}",
            )
        )  # fmt: skip
    return rows


def main() -> None:
    """Measure, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.motor_speed", description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--write-docs", action="store_true")
    args = parser.parse_args()
    sections = [
        Section(
            "Time",
            f"Made by `python -m benchmarks.motor_speed --write-docs`: calls by turns, processor time of one thread, medians, on a machine with other work. The train "
            f"has {STATIONS} stations and a motor of 8 MW; events are in operation unless it says otherwise.",
            (Table("Calls", ("What", "Processor time", "Goal"), tuple(speed_rows(args.rounds))),),
        ),
        Section(
            "Accuracy against time",
            "The three-phase fault at several TolerancePeak. True errors are those beside scipy's DOP853 at 1e-11 in angles "
            "and fluxes, without modes; the largest of all elements.",
            (
                Table(
                    "Three-phase fault",
                    ("TolerancePeak", "Time", "Stated error", "True error", "Stated, air-gap torque", "True, air-gap torque"),
                    tuple(accuracy_rows(args.rounds)),
                ),
            ),
        ),
    ]  # fmt: skip
    report.show(sections)
    if args.write_docs:
        report.write_markdown(PAGE, "What the motor from its data costs", sections)


if __name__ == "__main__":
    main()
