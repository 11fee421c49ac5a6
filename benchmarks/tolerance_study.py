"""Are stated tolerances honoured? A thousand random trains: `python -m benchmarks.tolerance_study`.

Every train is run as a user runs it, and again at a hundredth of its tolerances: that is the truth.
A run with events is repeated with every inertia changed by a billionth. Every twentieth pair is
also integrated by tests/hard_cases/reference.py, which shares no code with the engine. What each
train gave is kept in build/, by the engine that gave it, so an interrupted study goes on where it
was.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())  # one thread a process: there is a process a core

import numpy as np  # noqa: E402

from benchmarks.study_trains import StudyTrain, gaps_of, study_train  # noqa: E402
from engine.case.case import Case
from engine.errors import TorsionError  # noqa: E402
from engine.results.results import Results  # noqa: E402
from engine.run import run  # noqa: E402
from engine.start.start import Start

__all__ = [
    "FULL", "MOST_NUDGES", "QUICK", "Answer", "ClassSummary", "Study", "classes_of", "record_of", "study",
    "summary_of",
]  # fmt: skip

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "tolerance-study"
#: Trains of the whole study, and of the short one that a test runs.
FULL, QUICK = 1000, 20
#: The truth is asked for at this share of the tolerance.
FINER = 0.01
#: Change of the input that a sound answer does not feel.
TINY = 1e-9
#: Of the runs that do not say that they are sensitive, every so many is tried.
NUDGED = 3
#: A run that says so is tried until a peak changes by more than the tolerance, so often at the most: such a
#: change may be one in twenty.
MOST_NUDGES = 30
#: Step of the independent integrator: phase of the fastest mode, and the longest one. [rad, s]
REFERENCE_ANGLE, REFERENCE_STEP = 0.08, 1e-5
#: A truth whose step is not below this share of the answer's is not finer.
NO_FINER = 0.75
#: Torque below this share of the train's largest is rounding.
NOTHING = 1e-9

Record = dict[str, Any]


# --- one train ------------------------------------------------------------------------------------


def record_of(number: int) -> Record:
    """Everything the study calculates of one train."""
    train = study_train(number)
    record: Record = {
        "number": number,
        "seed": train.seed,
        "extras": list(train.extras),
        "tolerance": list(train.tolerances),
    }
    began = time.perf_counter()
    asked = run(train.case)
    record["asked"] = _answers(asked, time.perf_counter() - began)
    sensitive = (record["asked"]["sensitivity"] or {}).get("sensitive", False)
    if not sensitive:  # those are counted apart: one of many equally right answers has no truth
        peak, starts = train.tolerances
        began = time.perf_counter()
        finer = replace(train.case, tolerance_peak=FINER * peak, tolerance_starts=FINER * starts)
        record["truth"] = _answers(run(finer), time.perf_counter() - began)
    if record["asked"]["events"] and (sensitive or number % (2 * NUDGED) == 1):
        record["nudged"] = []
        for which in range(MOST_NUDGES if sensitive else 1):
            record["nudged"].append(_answers(run(_nudged(train, which)), 0.0))
            if _felt(record) > record["tolerance"][0]:
                break
    if train.independent and not sensitive and asked.start is not None:
        record["independent"] = _independent(train, asked.start, asked)
    return record


def _answers(found: Results, wall: float) -> Record:
    """What a run reports, with the errors it states."""
    start = found.start
    assert start is not None
    shafts = found.starts.shafts if found.starts is not None else ()
    return {
        "wall": wall,
        "outcome": start.outcome.outcome,
        "end": start.outcome.time,
        "events": bool(found.plans[-1].events),
        "met": start.met_tolerance,
        "error": start.estimated_error,
        "halvings": start.halvings,
        "steps": start.trajectory.n_steps,
        "step": start.step,
        "impacts": sum(c.impacts for c in start.contacts),
        "sensitivity": None
        if found.sensitivity is None
        else {"spread": found.sensitivity.spread, "sensitive": found.sensitivity.sensitive},
        "peaks": {p.element: [p.maximum, p.minimum, p.error] for p in start.peaks},
        "starts": {
            s.element: [s.allowable_starts, e]
            for s, (_, e) in zip(shafts, found.starts_error, strict=True)
        },
    }


def _nudged(train: StudyTrain, which: int) -> Case:
    """Every inertia a billionth larger or smaller."""
    signs = np.random.default_rng((train.seed, 21, which)).choice([-1.0, 1.0], 1000)
    stations = [
        replace(s, inertia=(s.inertia or 0.0) * (1.0 + TINY * float(sign)))
        for s, sign in zip(train.case.stations, signs, strict=False)
    ]
    return replace(train.case, stations=tuple(stations))


def _independent(train: StudyTrain, start: Start, found: Results) -> Record | None:
    """Peaks by the independent integrator at two steps; None if a damper was left uncoupled."""
    from tests.hard_cases.reference import Clearance, integrate

    if start.uncoupled_dampers:
        return None
    case, end = train.case, start.outcome.time
    clearances = {e: Clearance(gap) for e, gap in gaps_of(case).items()}
    step = min(REFERENCE_ANGLE / float(found.modes.omega[-1]), REFERENCE_STEP)
    record: Record = {"step": step, "end": end}
    for name, h in (("peaks", step), ("coarser", 2.0 * step)):
        answer = integrate(case, end, h, clearances=clearances)
        record[name] = {}
        for i, e in enumerate(case.elements):
            touching = e.element in clearances  # whole tooth torque, damping included
            high = answer.tooth_maximum if touching else answer.maximum
            low = answer.tooth_minimum if touching else answer.minimum
            record[name][str(e.element)] = [float(high[i]), float(low[i])]
    return record


# --- all of them ----------------------------------------------------------------------------------


def engine_print() -> str:
    """Digest of everything that the records depend on."""
    digest = hashlib.sha256()
    sources = [
        *(ROOT / "engine").rglob("*.py"),
        Path(__file__),
        ROOT / "benchmarks/study_trains.py",
    ]
    sources += [ROOT / "tests" / f for f in ("random_starts.py", "random_effects.py")]
    sources.append(ROOT / "tests" / "hard_cases" / "reference.py")
    for path in sorted(sources):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def study(count: int, jobs: int, kept: Path | None = KEPT) -> list[Record]:
    """Records of the first `count` trains, those at hand as they are."""
    folder = None if kept is None else kept / engine_print()
    done = {} if folder is None else dict(_at_hand(folder, count))
    missing = [n for n in range(count) if n not in done]
    for record in _calculated(missing, jobs):
        done[record["number"]] = record
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            partial = folder / f"{record['number']}.part"
            partial.write_text(json.dumps(record), encoding="utf-8")
            partial.replace(folder / f"{record['number']}.json")
        if len(done) % 50 == 0:
            print(f"… {len(done)} of {count} trains", file=sys.stderr, flush=True)
    return [done[n] for n in sorted(done)]


def _at_hand(folder: Path, count: int) -> Iterator[tuple[int, Record]]:
    for path in folder.glob("*.json"):
        record = json.loads(path.read_text(encoding="utf-8"))
        if record["number"] < count:
            yield record["number"], record


def _calculated(numbers: Sequence[int], jobs: int) -> Iterator[Record]:
    if jobs <= 1:
        yield from map(_safely, numbers)
        return
    with ProcessPoolExecutor(jobs) as pool:
        for future in as_completed([pool.submit(_safely, n) for n in numbers]):
            yield future.result()


def _safely(number: int) -> Record:
    """A record; a run that raises is a finding."""
    try:
        return record_of(number)
    except (TorsionError, ArithmeticError, AssertionError, ValueError) as wrong:
        train = study_train(number)
        return {
            "number": number,
            "seed": train.seed,
            "extras": list(train.extras),
            "tolerance": list(train.tolerances),
            "failed": f"{type(wrong).__name__}: {wrong}",
        }


# --- what they say --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Answer:
    """One reported answer beside its truth: a peak torque, or the starts of a shaft.

    Parameters
    ----------
    number : int
        Train. [1]
    element, kind : str
        Where; ``peak`` or ``starts``. [words]
    tolerance, stated, true : float
        Relative errors: wanted, reported, found. [1]
    resolved : bool
        False where the truth was calculated at the very step of the answer (both had refined as
        far as they may): nothing is said of the estimate then. [flag]
    """

    number: int
    element: str
    kind: str
    tolerance: float
    stated: float
    true: float
    resolved: bool = True

    @property
    def within(self) -> bool:
        """Whether the tolerance is honoured. [flag]"""
        return self.true <= self.tolerance

    @property
    def ratio(self) -> float:
        """Reported error over the true one; infinite where there is none. [1]"""
        return self.stated / self.true if self.true > 0.0 else math.inf


@dataclass(frozen=True)
class ClassSummary:
    """One class of trains.

    Parameters
    ----------
    name : str
        Class. [words]
    trains, answers, within : int
        How many, and how many answers are within their tolerance. [count]
    ratio : float
        Median of reported over true error. [1]
    worst : Answer or None
        Largest true error over its tolerance. [1]
    """

    name: str
    trains: int
    answers: int
    within: int
    ratio: float
    worst: Answer | None

    @property
    def share(self) -> float:
        """Share of the answers that are within. [1]"""
        return self.within / self.answers if self.answers else 1.0


@dataclass(frozen=True, eq=False)
class Study:
    """What the whole study found.

    Parameters
    ----------
    records : list of dict
        Everything of every train.
    answers, independent : list of Answer
        Against the hundredfold finer run, and against the independent integrator; without trains
        that say they are sensitive.
    sensitive : list of int
        Trains that say so. [numbers]
    felt, unfelt : list of int
        Of those the ones that a billionth did change by more than their tolerance; and trains that
        do not say so although it did. [numbers]
    failed : list of dict
        Trains that raised.
    """

    records: list[Record]
    answers: list[Answer]
    independent: list[Answer]
    sensitive: list[int]
    felt: list[int]
    unfelt: list[int]
    failed: list[Record]

    @property
    def events(self) -> int:
        """Trains whose start has events. [count]"""
        return sum(1 for r in self.records if "failed" not in r and r["asked"]["events"])


def summary_of(records: list[Record]) -> Study:
    """Judge the records."""
    found = Study(records, [], [], [], [], [], [r for r in records if "failed" in r])
    for r in records:
        if "failed" in r:
            continue
        says = bool((r["asked"]["sensitivity"] or {}).get("sensitive", False))
        felt = _felt(r) > r["tolerance"][0]
        if says:
            found.sensitive.append(r["number"])
            if felt:
                found.felt.append(r["number"])
            continue
        if felt:
            found.unfelt.append(r["number"])
        resolved = r["truth"]["step"] <= NO_FINER * r["asked"]["step"]
        found.answers.extend(replace(a, resolved=resolved) for a in _beside(r, r["truth"]))
        if r.get("independent"):
            found.independent.extend(_peaks(r, r["independent"]["peaks"]))
    return found


def _felt(record: Record) -> float:
    """Largest relative change of a peak under a billionth."""
    return max(
        (a.true for other in record.get("nudged", []) for a in _peaks(record, other["peaks"])),
        default=0.0,
    )


def _peaks(record: Record, truth: dict[str, Sequence[float]]) -> list[Answer]:
    """Peaks of a record beside true ones. Torques that are only rounding say nothing."""
    largest = max(max(abs(p[0]), abs(p[1])) for p in truth.values())
    found = []
    for element, (high, low, error) in record["asked"]["peaks"].items():
        if element not in truth:
            continue
        size = max(abs(truth[element][0]), abs(truth[element][1]))
        if size <= NOTHING * largest:
            continue
        off = max(abs(high - truth[element][0]), abs(low - truth[element][1]))
        tolerance = record["tolerance"][0]
        found.append(Answer(record["number"], element, "peak", tolerance, error / size, off / size))
    return found


def _beside(record: Record, truth: Record) -> list[Answer]:
    """Every answer of a record beside those of the finer run."""
    found = _peaks(record, truth["peaks"])
    for element, (starts, error) in record["asked"]["starts"].items():
        true = truth["starts"][element][0]
        if starts is None and true is None:
            continue  # unlimited is right, and has no error
        off = abs(starts / true - 1.0) if starts is not None and true is not None else math.inf
        tolerance = record["tolerance"][1]
        found.append(Answer(record["number"], element, "starts", tolerance, error or 0.0, off))
    return found


def classes_of(found: Study) -> list[ClassSummary]:
    """Shares and ratios by class of train, kind of answer and tolerance."""
    by_number = {r["number"]: r for r in found.records if "failed" not in r}

    def of(name: str, chosen: list[Answer]) -> ClassSummary:
        ratios = [a.ratio for a in chosen if a.resolved]
        return ClassSummary(
            name,
            len({a.number for a in chosen}),
            len(chosen),
            sum(a.within for a in chosen),
            float(np.median(ratios)) if ratios else math.nan,
            max(chosen, key=lambda a: a.true / a.tolerance, default=None),
        )

    rows = [of("all", found.answers)]
    for kind in ("peak", "starts"):
        for events, words in ((False, "linear"), (True, "with events")):
            chosen = [
                a
                for a in found.answers
                if a.kind == kind and by_number[a.number]["asked"]["events"] == events
            ]
            rows.append(of(f"{kind}, {words}", chosen))
    for extra in (
        "bearings",
        "dampers",
        "coupled damping",
        "breaker closing",
        "several clearances",
    ):
        chosen = [a for a in found.answers if extra in by_number[a.number]["extras"]]
        rows.append(of(f"with {extra}", chosen))
    for tolerance in (1e-2, 1e-3, 1e-4):
        chosen = [a for a in found.answers if by_number[a.number]["tolerance"][0] == tolerance]
        rows.append(of(f"tolerance of peaks {tolerance:g}", chosen))
    for events, words in ((False, "linear"), (True, "with events")):
        chosen = [a for a in found.independent if by_number[a.number]["asked"]["events"] == events]
        rows.append(of(f"independent integrator, {words}", chosen))
    return rows


def main() -> None:
    """Run the study, print it, and on request write its page."""
    from benchmarks import report, study_pages

    parser = argparse.ArgumentParser(prog="python -m benchmarks.tolerance_study")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} trains instead of {FULL}")
    parser.add_argument("--trains", type=int, help="so many trains")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument(
        "--write-docs", action="store_true", help="write docs/accuracy-study.md and its picture"
    )
    args = parser.parse_args()
    count = args.trains or (QUICK if args.quick else FULL)
    found = summary_of(study(count, args.jobs))
    sections = study_pages.study_sections(found)
    report.show(sections)
    if args.write_docs:
        study_pages.write_study(found, sections, ROOT / "docs")


if __name__ == "__main__":
    main()
