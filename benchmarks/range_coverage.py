"""Do ranges of starts that are repeated hold what a repetition gives? `python -m benchmarks.range_coverage`.

Short random starts with clearances. Each that makes an ensemble is simulated a hundred times more with every inertia
changed by a billionth, at its step; counted are the repetitions within what is stated of each peak and each number of
starts. What each train gave is kept in build/, so that an interrupted measurement goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import report
from benchmarks.report import Section, Table
from benchmarks.study_answers import ROUNDING
from engine.backlash.event_start import one_run, run_event_start
from engine.case.case import Case
from engine.fatigue.damage import starts_from_damage
from engine.start.peaks import sections_of
from engine.start.start import Start, run_start
from engine.start.start_fatigue import judged_shafts, largest_damage, starts_of
from tests.random_clearances import start_with_clearances
from tests.random_effects import with_judged_shafts
from tests.trains import prepared

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "range-coverage"
#: First train, and how many repeated starts are wanted.
FIRST, TRAINS = 1020, 30
#: Share of the elements with a clearance, and end of the start. [1, s]
CLEARANCES, END = 0.15, 0.35
#: Repetitions of one start; no further one is begun after so much processor time. [count, s]
REPETITIONS, LONGEST = 100, 6.0
#: Starts that take longer are passed over. [s]
PATIENCE = 1.5
TINY = 1e-9
#: Kinds of statements: key in a record, and words.
KINDS = {
    "peak": "`Peak low` to `Peak high`",
    "maximum": "`Maximum torque` ± `Error`",
    "minimum": "`Minimum torque` ± `Error`",
    "range of the minimum": "`Minimum low` to `Minimum high`",
    "peak-to-peak": "`Peak-to-peak torque` ± `Error`",
    "starts": "`Starts low` to `Starts high`",
}


def record_of(seed: int) -> dict[str, Any]:
    """Repetitions of one start, and how many of them are within each statement."""
    case, effects = start_with_clearances(seed, bearings=bool(seed % 2), end=END, share=CLEARANCES)
    case = with_judged_shafts(case, seed, 1.0)
    modal = prepared(case)
    linear = run_start(case, modal, replace(effects, clearances=()))
    began = time.process_time()
    start = run_event_start(case, modal, effects, linear)
    took = time.process_time() - began
    record: dict[str, Any] = {"seed": seed, "seconds": took}
    if start.repeatability is None or took > PATIENCE:
        return record
    record |= {"runs": start.repeatability.runs, "sensitive": start.is_sensitive}
    held: dict[str, list[list[bool]]] = {kind: [] for kind in KINDS}
    began = time.process_time()
    for which in range(REPETITIONS):
        changed = _nudged(case, seed, which)
        single = one_run(changed, prepared(changed), effects, linear, start.step)
        extremes = {
            modal.train.elements[e]: (
                float(single.turning[high][1].max()),
                float(single.turning[low][1].min()),
                float(np.ptp(single.turning[widest][1])),
            )
            for e, (high, low, widest) in sections_of(single).items()
        }
        for kind, within in _within(start, extremes).items():
            held[kind].append(within)
        own = single.trajectory.output_element
        damage = {
            str(row.element): largest_damage(
                case, row, [single.turning[int(i)][1] for i in np.flatnonzero(own == e)]
            )
            for e, row in judged_shafts(case)
        }
        held["starts"].append(list(_starts_within(case, start, damage)))
        if time.process_time() - began > LONGEST:
            break
    return record | {"held": held}


def _nudged(case: Case, seed: int, which: int) -> Case:
    """Every inertia a billionth larger or smaller."""
    signs = np.random.default_rng((seed, 21, which)).choice([-1.0, 1.0], len(case.stations))
    stations = [
        replace(s, inertia=(s.inertia or 0.0) * (1.0 + TINY * float(sign)))
        for s, sign in zip(case.stations, signs, strict=True)
    ]
    return replace(case, stations=tuple(stations))


def _within(start: Start, extremes: dict[str, tuple[float, float, float]]) -> dict[str, list[bool]]:
    """Whether a repetition is within what is stated of each peak."""
    held: dict[str, list[bool]] = {kind: [] for kind in KINDS if kind != "starts"}
    for p in start.peaks:
        high, low, span = extremes[p.element]
        rounding, share = ROUNDING * p.size, p.relative_error
        (least, most), ends = (p.low, p.high), p.minimum_range
        assert least is not None
        assert most is not None
        assert ends is not None
        held["peak"].append(least - rounding <= max(high, -low) <= most + rounding)
        held["maximum"].append(abs(high - p.maximum) <= p.error + rounding)
        held["minimum"].append(abs(low - p.minimum) <= p.error + rounding)
        held["range of the minimum"].append(ends[0] - rounding <= low <= ends[1] + rounding)
        held["peak-to-peak"].append(abs(span - p.peak_to_peak) <= share * p.peak_to_peak + rounding)
    return held


def _starts_within(case: Case, start: Start, damage: dict[str, float]) -> Iterator[bool]:
    """Whether a repetition is within the range of each number of starts."""
    starts, _ = starts_of(case, start)
    for shaft in () if starts is None else starts.shafts:
        found = starts_from_damage(damage[str(shaft.element)])
        value = math.inf if found is None else found
        low, high = shaft.starts_low, shaft.starts_high
        least, most = low or 0.0, math.inf if high is None else high
        yield least * (1.0 - ROUNDING) <= value <= most * (1.0 + ROUNDING)


def measured(wanted: int, kept: Path = KEPT) -> list[dict[str, Any]]:
    """Records of the first repeated starts, those at hand as they are."""
    kept.mkdir(parents=True, exist_ok=True)
    found: list[dict[str, Any]] = []
    seed = FIRST
    while len(found) < wanted:
        path = kept / f"{seed}.json"
        if not path.exists():
            path.write_text(json.dumps(record_of(seed)), encoding="utf-8")
        record = json.loads(path.read_text(encoding="utf-8"))
        if "held" in record:
            found.append(record)
        seed += 1
    return found


def coverage_sections(records: Sequence[dict[str, Any]]) -> list[Section]:
    """The measurement in tables."""
    lines = []
    for kind, words in KINDS.items():
        for sensitive in (True, False):
            chosen = [r for r in records if r["sensitive"] is sensitive]
            held = [np.array(r["held"][kind]) for r in chosen]
            held = [h for h in held if h.size]
            if not held:
                continue
            answers, inside = sum(h.size for h in held), sum(int(h.sum()) for h in held)
            narrow = sum(int(np.sum(h.mean(axis=0) < 0.97)) for h in held)
            lines.append(
                (
                    words, "yes" if sensitive else "no", str(len(held)), f"{inside} of {answers}",
                    f"{100.0 * inside / answers:.2f} %", f"{narrow} of {sum(h.shape[1] for h in held)}",
                )
            )  # fmt: skip
    columns = (
        "Statement", "Sensitive", "Trains", "Repetitions within", "Share",
        "Statements that hold less than 97 %",
    )  # fmt: skip
    counts = [len(r["held"]["peak"]) for r in records]
    return [
        Section(
            "Repetitions within what is stated",
            f"Made by `python -m benchmarks.range_coverage --trains {len(records)} --write-docs`. {len(records)} short random "
            f"starts with clearances that make an ensemble ({min(r['runs'] for r in records)} to "
            f"{max(r['runs'] for r in records)} runs), each simulated {min(counts)} to {max(counts)} times more at its step, "
            "every inertia changed by a billionth. *Sensitive* starts have a range wider than their tolerance.",
            (Table("Ranges of repeated starts", columns, tuple(lines)),),
        )
    ]


def main() -> None:
    """Measure, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.range_coverage")
    parser.add_argument("--trains", type=int, default=TRAINS, help="repeated starts")
    parser.add_argument("--write-docs", action="store_true", help="write docs/range-coverage.md")
    args = parser.parse_args()
    sections = coverage_sections(measured(args.trains))
    report.show(sections)
    if args.write_docs:
        report.write_markdown(
            ROOT / "docs" / "range-coverage.md", "Do ranges of repeated starts hold?", sections
        )


if __name__ == "__main__":
    main()
