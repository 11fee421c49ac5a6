"""Does what a start says of itself hold? 1,520 random trains: `python -m benchmarks.tolerance_study`.

Every train is run as a user runs it, and again at a hundredth of its tolerances (at less where the step would not be
finer) with every effect on that it has data for: that is the truth. Each effect left out is also forced on by itself. A run that says
it is sensitive is repeated with every inertia changed by a billionth (a hundred times, less often where one run is
long), of the others with events every third. Every twentieth pair is also integrated by tests/hard_cases/reference.py, which shares no code with the
engine. What each
train gave is kept in build/, by the engine that gave it, so an interrupted study goes on where it
was. With `--truths FOLDER` the truths of an earlier engine stand wherever every statement beside them holds;
the answers, repetitions and bounds are always those of this engine.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from unittest.mock import patch

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())  # one thread a process: there is a process a core

import numpy as np  # noqa: E402

import engine.run as conductor  # noqa: E402
from benchmarks import report, study_pages  # noqa: E402
from benchmarks.study_answers import (  # noqa: E402
    NO_FINER,
    SENSITIVE_NUDGES,
    Record,
    all_hold,
    beside_truth,
    summary_of,
)
from benchmarks.study_trains import (  # noqa: E402
    INDEPENDENT,
    LEAVES_EFFECT,
    LEAVES_MODES,
    OTHER_TOLERANCE,
    StudyTrain,
    gaps_of,
    study_train,
)
from engine.backlash import event_start
from engine.case.case import Case
from engine.case.data import EffectChoiceRow  # noqa: E402
from engine.case.defaults import LEAST_TOLERANCE_PEAK, LEAST_TOLERANCE_STARTS
from engine.case.effects import EFFECTS  # noqa: E402
from engine.errors import TorsionError  # noqa: E402
from engine.fatigue.damage import starts_from_damage
from engine.results.results import Results  # noqa: E402
from engine.run import calculate_start, run  # noqa: E402
from engine.start.peaks import sections_of
from engine.start.pieces import analysis_for_start
from engine.start.start import Start
from engine.start.start_fatigue import judged_shafts, largest_damage

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "tolerance-study"
#: Trains of any kind, of those that leave modes out and of those that leave an effect out; of any kind in the
#: short study.
FULL, LEAVING_MODES, LEAVING_EFFECT, QUICK = 1000, 100, 160, 20
#: Up to these numbers those of other tolerances, and those of the independent integrator, are trains of the
#: study, too: each class has a hundred.
OTHER_TOLERANCES, INTEGRATED = 1500, 2600
#: Steps of one mode in all repetitions of one sensitive start together, and repetitions at the least.
REPEATED_WORK, FEWEST_NUDGES = 50_000_000, 20
#: Work of all simulations of one start together where it is the truth (that of `event_start.MOST_WORK`).
TRUTH_WORK = 120_000_000
#: The truth is asked for at this share of the tolerance.
FINER = 0.01
#: Effects that are forced on for the truth, where a train has their data.
ALL_EFFECTS = ("bearings", "coupled damping", "fast modes", "breaker closing", "backlash")
#: What an earlier record gives to a later one of the same train.
TRUTHS = ("truth", "independent", "nudged")
#: Change of the input that a sound answer does not feel.
TINY = 1e-9
#: Of the runs that do not say that they are sensitive, every so many is tried.
NUDGED = 3
#: Step of the independent integrator: phase of the fastest mode, and the longest one. [rad, s]
REFERENCE_ANGLE, REFERENCE_STEP = 0.3, 3e-5


# --- one train ------------------------------------------------------------------------------------


# no train has motor data: with that estimate in `Left out` every statement would hold
@patch.object(conductor, "planned_start", partial(conductor.planned_start, estimated=False))
def record_of(
    train: StudyTrain, nudges: int = SENSITIVE_NUDGES, earlier: Record | None = None
) -> Record:
    """Everything the study calculates of one train; one that is sensitive is repeated `nudges` times at most.

    An `earlier` record of the train gives its truths if every statement beside them holds.
    """
    record: Record = {
        "number": train.number,
        "seed": train.seed,
        "extras": list(train.extras),
        "tolerance": list(train.tolerances),
    }
    began = time.perf_counter()
    asked = run(train.case)
    record["asked"] = _answers(asked, time.perf_counter() - began)
    sensitive = (record["asked"]["sensitivity"] or {}).get("sensitive", False)
    if not sensitive:  # those are counted apart: one of many equally right answers has no truth
        finer = _finer(train.case, FINER)
        with patch.object(event_start, "MOST_WORK", TRUTH_WORK):
            record["bounds"] = _bounds(finer, asked)
            if earlier is not None and "truth" in earlier:
                truths = {name: earlier[name] for name in TRUTHS if name in earlier}
                if all_hold(record | truths):
                    return record | truths | {"earlier": True}
            record["truth"] = _truth(finer, asked)
    if sensitive and asked.start is not None:
        work = asked.start.trajectory.n_steps * asked.start.kept_modes
        times = min(nudges, max(FEWEST_NUDGES, REPEATED_WORK // work))
        record["nudged"] = [_repetition(train, asked, k) for k in range(times)]
    elif record["asked"]["events"] and train.number % (2 * NUDGED) == 1:
        record["nudged"] = [_answers(run(_nudged(train, 0)), 0.0)]
    if train.independent and not sensitive and asked.start is not None:
        record["independent"] = _independent(train, asked.start, asked)
    return record


def _truth(finer: Case, asked: Results) -> Record:
    """The answers with every effect on, asked for more finely until their step is finer than that of the answer."""
    assert asked.start is not None
    while True:
        began = time.perf_counter()
        truth = _answers(run(_with(finer, ALL_EFFECTS)), time.perf_counter() - began)
        before, finer = finer, _finer(finer, 0.1)
        if (
            truth["stopped"]
            or truth["step"] <= NO_FINER * asked.start.step
            or finer.tolerance_peak == before.tolerance_peak
        ):
            return truth


def _finer(case: Case, share: float) -> Case:
    """The case at a share of its tolerances, or at the least that can be asked for."""
    assert case.tolerance_peak is not None
    assert case.tolerance_starts is not None
    return replace(
        case,
        tolerance_peak=max(share * case.tolerance_peak, LEAST_TOLERANCE_PEAK),
        tolerance_starts=max(share * case.tolerance_starts, LEAST_TOLERANCE_STARTS),
    )


def _with(case: Case, names: Iterable[str], choice: str = "on") -> Case:
    """The case with some effects forced on (or off) where it has their data, besides those that it forces."""
    forced = {row.effect for row in case.effect_choices}
    inputs = {name: EFFECTS[name].inputs for name in names if name not in forced}
    given = [name for name, needed in inputs.items() if needed is None or needed.given(case)]
    choices = tuple(EffectChoiceRow(name, choice) for name in given)
    return replace(case, effect_choices=(*case.effect_choices, *choices))


def _bounds(finer: Case, asked: Results) -> dict[str, dict[str, list[float]]]:
    """Each effect left out with a bound: the bound and the change of each peak when it is forced on."""
    plan = asked.plans[-1]
    known = {d.effect: d.bound for d in plan.decisions if d.effect in plan.left_out and d.bound}
    if not known:
        return {}
    found = {}
    for name, bound in known.items():
        without = _answers(run(_with(finer, [name], "off")), 0.0)["peaks"]
        forced = _answers(run(_with(finer, [name])), 0.0)["peaks"]
        found[name] = {
            # both have errors of their own
            element: [bound, max(change - (without[element][2] + forced[element][2]) / size, 0.0)]
            for element, size, change in beside_truth(without, forced)
        }
    return found


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
        "stopped": "stopped after" in start.outcome.sentence.lower(),
        "step": start.step,
        "impacts": sum(c.impacts for c in start.contacts),
        "recontacts": {
            c.element: [c.recontact_speed_angular, c.recontact_error] for c in start.contacts
        },
        "modes_left_out": max(found.modes.n_modes - start.kept_modes, 0),
        "sensitivity": None
        if start.repeatability is None
        else {"spread": start.repeatability.spread, "sensitive": start.is_sensitive},
        "peaks": {
            p.element: [p.maximum, p.minimum, p.error, p.left_out, p.low, p.high]
            for p in start.peaks
        },
        "starts": {
            s.element: [s.allowable_starts, s.left_out, s.starts_low, s.starts_high] for s in shafts
        },
    }


def _repetition(train: StudyTrain, asked: Results, which: int) -> Record:
    """Peaks and starts of one run at the step of a sensitive start, with other inertias by a billionth."""
    case, plan = _nudged(train, which), asked.plans[-1]
    assert asked.start is not None
    analysis = analysis_for_start(case)
    model = analysis.reported if plan.lateral else analysis.torsional
    linear = calculate_start(case, model, replace(plan.effects, clearances=()), None)
    single = event_start.one_run(case, model, plan.effects, linear, asked.start.step)
    names, sections = model.train.elements, sections_of(single)
    return {
        "peaks": {
            names[e]: [
                float(single.turning[high][1].max()),
                float(single.turning[low][1].min()),
            ]
            for e, (high, low, _) in sections.items()
        },
        "starts": {
            str(row.element): [
                starts_from_damage(
                    largest_damage(
                        case,
                        row,
                        [
                            single.turning[int(i)][1]
                            for i in np.flatnonzero(single.trajectory.output_element == e)
                        ],
                    )
                )
            ]
            for e, row in judged_shafts(case)
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
        *(ROOT / "engine").rglob("kernels/*.[ch]"),
        Path(__file__),
        ROOT / "benchmarks/study_trains.py",
    ]
    sources += [ROOT / "tests" / f for f in ("random_starts.py", "random_effects.py")]
    sources.append(ROOT / "tests" / "hard_cases" / "reference.py")
    for path in sorted(sources):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def study(
    numbers: Sequence[int],
    jobs: int,
    kept: Path | None = KEPT,
    nudges: int = SENSITIVE_NUDGES,
    truths: Path | None = None,
) -> list[Record]:
    """Records of some trains, those at hand as they are; `truths` is a folder of an earlier study's records."""
    folder = None if kept is None else kept / f"{engine_print()}-{nudges}"
    done = {} if folder is None else dict(_at_hand(folder, set(numbers)))
    earlier = {} if truths is None else dict(_at_hand(truths, set(numbers)))
    missing = [n for n in numbers if n not in done]
    for record in _calculated(missing, jobs, nudges, earlier):
        done[record["number"]] = record
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            partial = folder / f"{record['number']}.part"
            partial.write_text(json.dumps(record), encoding="utf-8")
            partial.replace(folder / f"{record['number']}.json")
        if len(done) % 50 == 0:
            print(f"… {len(done)} of {len(numbers)} trains", file=sys.stderr, flush=True)
    return [done[n] for n in sorted(done)]


def trains_of_study() -> tuple[int, ...]:
    """Numbers of the trains of the whole study, of every kind in proportion wherever it is cut short."""
    tolerances = [n for n in range(FULL, OTHER_TOLERANCES) if n % 20 in OTHER_TOLERANCE]
    integrated = [n for n in range(FULL, INTEGRATED) if n % 20 in INDEPENDENT]
    leaving = range(LEAVES_MODES, LEAVES_MODES + LEAVING_MODES)
    without = range(LEAVES_EFFECT, LEAVES_EFFECT + LEAVING_EFFECT)
    place = {}
    for numbers in (range(FULL), tolerances, integrated, leaving, without):
        for i, number in enumerate(
            numbers
        ):  # two of a pair, linear and with clearances, stay together
            place.setdefault(number, (i // 2 + 0.5) / (len(numbers) / 2))
    return tuple(sorted(place, key=lambda number: place[number]))


def _at_hand(folder: Path, numbers: Set[int]) -> Iterator[tuple[int, Record]]:
    for path in folder.glob("*.json"):
        record = json.loads(path.read_text(encoding="utf-8"))
        if record["number"] in numbers:
            yield record["number"], record


def _calculated(
    numbers: Sequence[int], jobs: int, nudges: int, earlier: Mapping[int, Record]
) -> Iterator[Record]:
    if jobs <= 1:
        yield from (_safely(n, nudges, earlier.get(n)) for n in numbers)
        return
    with ProcessPoolExecutor(jobs) as pool:
        asked = [pool.submit(_safely, n, nudges, earlier.get(n)) for n in numbers]
        for future in as_completed(asked):
            yield future.result()


def _safely(number: int, nudges: int, earlier: Record | None) -> Record:
    """A record; a run that raises is a finding."""
    train = study_train(number)
    try:
        return record_of(train, nudges, earlier)
    except (TorsionError, ArithmeticError, AssertionError, ValueError) as wrong:
        return {
            "number": number,
            "seed": train.seed,
            "extras": list(train.extras),
            "tolerance": list(train.tolerances),
            "failed": f"{type(wrong).__name__}: {wrong}",
        }


# --- what they say --------------------------------------------------------------------------------


def main() -> None:
    """Run the study, print it, and on request write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tolerance_study")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} trains only")
    parser.add_argument(
        "--trains", type=int, help="so many trains only, of every kind in proportion"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument(
        "--nudges", type=int, default=SENSITIVE_NUDGES, help="most repetitions of a sensitive start"
    )
    parser.add_argument(
        "--truths",
        type=Path,
        metavar="FOLDER",
        help="records of an earlier study, whose truths stand where every statement beside them holds",
    )
    parser.add_argument(
        "--write-docs", action="store_true", help="write docs/accuracy-study.md and its picture"
    )
    args = parser.parse_args()
    few = args.trains or (QUICK if args.quick else 0)
    numbers = trains_of_study()[: few or None]
    found = summary_of(study(numbers, args.jobs, nudges=args.nudges, truths=args.truths))
    sections = study_pages.study_sections(found)
    report.show(sections)
    if args.write_docs:
        study_pages.write_study(found, sections, ROOT / "docs")


if __name__ == "__main__":
    main()
