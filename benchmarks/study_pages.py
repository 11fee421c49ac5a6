"""What the tolerance study and the benchmarks of effects say: tables, and docs/accuracy-study.md."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import report
from benchmarks.backlash_speed import (
    EVENTS_ALONE,
    OURS,
    THEIRS,
    PairRow,
    StartBeside,
    pair_points,
)
from benchmarks.goals import Goal
from benchmarks.measure import Timing, time_at
from benchmarks.plots import draw_growth, draw_tolerances
from benchmarks.report import Section, Table
from benchmarks.scaling import MEMORY, ClearanceRow, LoopRow, MemoryRow, SizeRow, exponent
from benchmarks.study_answers import ClassSummary, Study, classes_of, sensitive_answers

__all__ = ["draw_effects", "effect_goals", "effect_sections", "study_sections", "write_study"]

STUDY_PICTURE, GROWTH_PICTURE = "accuracy_study.png", "bench_growth.png"
#: What the issue asks for: share within tolerance, median of reported over true error.
SHARE, RATIO = 0.99, 30.0
#: Share of answers that may say that they are sensitive, or have no bound.
SELDOM = 0.15
SPEED_LIMIT, PAIR_ERROR = 10.0, 1e-3
#: Below so many stations the cost of a train hardly depends on them: they would flatter the fit.
LARGE = 50
PERCENTILES = (5, 25, 50, 75, 95)


# --- the tolerance study --------------------------------------------------------------------------


def study_sections(found: Study) -> list[Section]:
    """The study in tables."""
    rows = classes_of(found)
    return [
        Section("Goals and what was reached", _what(found), (_goals(found, rows),)),
        Section(
            "By class",
            "Truth: the same train at a hundredth of the tolerance, or at less where its step would not be finer than that "
            "of the answer, with every effect on that it has data for; in the lines of the integrator one of its own (`tests/hard_cases/reference.py`); for bounds "
            "the same train with the one effect forced on and nothing else changed, less the errors of both runs "
            f"({sum(a.true > 0.0 for a in found.bounds)} changes are larger than those). A statement holds where the "
            "true error is at most `Error` and `Left out` together, or the true starts are between `Starts low` and `Starts high`. "
            "*Ratio* is stated over true error, median. *No bound* counts answers that say so. Trains that "
            "say they are sensitive are left out here and counted below.",
            (_classes(rows),),
            ((STUDY_PICTURE, "True error over tolerance, and reported over true error"),),
        ),
        Section(
            "How careful the estimate is",
            f"Without {sum(not a.resolved for a in found.answers)} answers whose truth could not be "
            "calculated at a finer step than the answer itself: both had refined as far as they may.",
            (_distribution(found),),
        ),
        Section("Sensitive starts", _about_sensitive(found), (_sensitive(found),)),
        Section(
            "Misses, one by one",
            "*True at the same step* means that neither run could be refined further: what is compared is "
            "rounding and ringing that is passed over.",
            (_misses(found),),
        ),
    ]


def _what(found: Study) -> str:
    n = len(found.records)
    own = len({a.number for a in found.independent})
    earlier = sum(r.get("earlier", False) for r in found.records)
    older = (
        f" The truths of {earlier} trains are those of an earlier engine (`--truths`): they stand where every "
        "statement beside them holds; all others are calculated by this one."
    )
    return (
        f"Made by `python -m benchmarks.tolerance_study --write-docs`. {n} random trains, each from "
        f"its number alone; {found.events} of their starts have events (teeth that separate). Tolerance "
        "of peaks 1e-3 and of starts 2e-2, in every tenth train 1e-2 and 1e-1, in another tenth "
        f"1e-4 and 2e-3. {own} trains are also integrated by a Runge-Kutta method of order eight "
        "in twists and speeds that shares no code with the engine." + older * bool(earlier)
    )


def _goals(found: Study, rows: Sequence[ClassSummary]) -> Table:
    everything = rows[0]
    peaks, starts = (sensitive_answers(found.records, kind) for kind in ("peaks", "starts"))
    says, n = len(found.sensitive), len(found.records)
    none = sum(a.stated is None for a in found.answers)
    inside = sum(r.inside for r in found.repeated) / max(len(found.repeated), 1)
    worst = min((c for c in rows if c.answers), key=lambda c: c.share, default=everything)
    finite = (c for c in rows if c.answers and math.isfinite(c.ratio))
    timid = max(finite, key=lambda c: c.ratio, default=everything)
    goals = [
        Goal(
            "in every class at least 99 % of the statements hold",
            f"{100.0 * everything.share:.2f} % of {everything.answers}; least {100.0 * worst.share:.2f} % "
            f"({worst.name})",
            "yes" if worst.share >= SHARE else "no",
        ),
        Goal(
            "in every class the median of stated over true error is at most 30",
            f"{everything.ratio:.0f}; largest {timid.ratio:.0f} ({timid.name})",
            "yes" if timid.ratio <= RATIO else "no",
        ),
        Goal(
            "at least 99 % of repetitions of sensitive starts are in the range told",
            f"{100.0 * inside:.2f} % of {len(found.repeated)}",
            "yes" if inside >= SHARE else "no",
        ),
        Goal(
            "at most 15 % of the answers of a class are sensitive; those that are say so",
            f"{says} of {n} trains ({says / n:.1%}), of those with events {says / max(found.events, 1):.1%} (peaks beyond "
            f"their tolerance {peaks[0]} of {peaks[2]}, starts {starts[0]} of {starts[2]}; {peaks[1]} and {starts[1]} "
            "of them did change by more in the repetitions); "
            f"{len(found.unfelt)} did not say so",
            "yes"
            if max(says - SELDOM * n, peaks[0] - SELDOM * peaks[2]) <= 0 and not found.unfelt
            else "partly",
        ),
        Goal(
            "at most 15 % of the answers have no bound",
            f"{none} of {len(found.answers)}",
            "yes" if none <= SELDOM * len(found.answers) else "no",
        ),
        Goal(
            "every train is calculated",
            f"{len(found.failed)} failed; {len(found.stopped)} were stopped after as much work as a start may take, and "
            f"said so; of {len(found.untold)} more the truth was, so there is none{_listed(found.untold)}",
            _yes(not found.failed),
        ),
    ]
    return report.goals_table(goals)


def _listed(numbers: Sequence[int]) -> str:
    return f" ({', '.join(map(str, numbers))})" if numbers else ""


def _yes(met: bool) -> str:
    return "yes" if met else "no"


def _classes(rows: Sequence[ClassSummary]) -> Table:
    lines = []
    for c in rows:
        worst = "–"
        if c.worst is not None:
            over = c.worst.true / max(c.worst.stated or 0.0, 1e-300)
            worst = f"{over:.2g} (train {c.worst.number})"
        share = f"{100.0 * c.share:.2f} %" if c.answers else "–"
        within = f"{100.0 * c.within / c.answers:.2f} %" if c.answers else "–"
        ratio = f"{c.ratio:.3g}" if math.isfinite(c.ratio) else "–"
        counts = (str(c.trains), str(c.answers))
        lines.append((c.name, *counts, share, within, ratio, str(c.unbounded), worst))
    columns = (
        "Class", "Trains", "Statements", "Hold", "Within tolerance", "Ratio", "No bound",
        "Largest true over stated",
    )  # fmt: skip
    return Table("Statements that hold", columns, tuple(lines))


def _distribution(found: Study) -> Table:
    by_number = {r["number"]: r for r in found.records if "failed" not in r}
    lines = []
    for kind in ("peak", "starts"):
        for events, words in ((False, "linear"), (True, "with events")):
            ratios = [
                a.ratio
                for a in found.answers
                if a.kind == kind
                and a.resolved
                and a.stated is not None
                and by_number[a.number]["asked"]["events"] == events
            ]
            if ratios:
                cells = (f"{x:.3g}" for x in np.percentile(ratios, PERCENTILES, method="nearest"))
                below = sum(r < 1.0 for r in ratios) / len(ratios)
                lines.append((f"{kind}, {words}", *cells, f"{100.0 * below:.1f} %"))
    columns = ("Class", *(f"{p} %" for p in PERCENTILES), "Reported below true")
    return Table("Reported over true error, percentiles", columns, tuple(lines))


def _misses(found: Study) -> Table:
    every = (*found.answers, *found.recontacts, *found.bounds, *found.independent)
    lines = [
        (
            str(a.number),
            a.element,
            a.kind + (" (integrator)" if a in found.independent else ""),
            f"{a.stated:.1e}",
            f"{a.true:.1e}",
            f"{a.tolerance:.0e}" if a.kind != "bound" else "–",
            "" if a.resolved else "true at the same step",
        )
        for a in every
        if a.stated is not None and not a.holds
    ]
    columns = ("Train", "Element or effect", "Statement", "Stated", "True", "Tolerance", "")
    return Table("Statements that do not hold", columns, tuple(lines))


def _about_sensitive(found: Study) -> str:
    sensitive = set(found.sensitive)
    times = [len(r["nudged"]) for r in found.records if r["number"] in sensitive]
    often = f"{min(times, default=0)} to {max(times, default=0)}"
    return (
        "A start with clearances may be chaotic: after many impacts a billionth of a change gives "
        "another, equally right answer. Such a run reports `sensitive` with the spread. Each start "
        f"with events that says so is repeated here {often} times (less often where one run is long) with every inertia changed by a "
        "billionth, one simulation each at its step; every third of the others is repeated once, as a user runs it."
    )


def _sensitive(found: Study) -> Table:
    told = {
        "peak": "range told: peak",
        "extremes": "error told: maximum and minimum",
        "starts": "range told: starts",
    }
    inside = [(kind, [r.inside for r in found.repeated if r.kind == kind]) for kind in told]
    rows = (
        *(
            (f"repetitions within the {told[kind]}", f"{sum(own)} of {len(own)}")
            for kind, own in inside
        ),
        ("starts with events", str(found.events)),
        ("of these say that they are sensitive", str(len(found.sensitive))),
        ("of these did change by more than the tolerance", str(len(found.felt))),
        ("changed by more than the tolerance and did not say so", str(len(found.unfelt))),
    )
    return Table("Changed by a billionth", ("", "Count"), rows)


def write_study(found: Study, sections: Sequence[Section], docs: Path) -> None:
    """docs/accuracy-study.md and its picture."""
    images = docs / "images"
    images.mkdir(parents=True, exist_ok=True)
    by_number = {r["number"]: r for r in found.records if "failed" not in r}
    groups: dict[str, list[tuple[float, float]]] = {}
    for a in found.answers:
        events = by_number[a.number]["asked"]["events"]
        label = f"{a.kind}, {'with events' if events else 'linear'}"
        if a.resolved and a.stated is not None:
            groups.setdefault(label, []).append((a.true / a.tolerance, a.ratio))
    draw_tolerances(images / STUDY_PICTURE, groups)
    report.write_markdown(docs / "accuracy-study.md", "Are stated tolerances honoured?", sections)


# --- benchmarks of effects ------------------------------------------------------------------------


def effect_goals(found: Mapping[str, Any]) -> list[Goal]:
    """Goals of the starts with events."""
    goals = [
        Goal(
            f"a start with {s.what} in ≤ 10 × the linear start's time",
            f"{s.ratio:.1f} × ({1e3 * s.events.seconds:.0f} ms against {1e3 * s.linear.seconds:.1f} ms)",
            _yes(s.ratio <= SPEED_LIMIT),
        )
        for s in found["teeth"]
    ]
    goals.append(_against_ross(found["pair"][1]))
    modes, times = found["loops"]
    basis: Mapping[int, Timing] = found["basis"]
    of_modes = exponent([r.modes for r in modes], [r.timing.seconds for r in modes])
    of_time = exponent([r.simulated for r in times], [r.timing.seconds for r in times])
    large = {n: t.seconds for n, t in basis.items() if n >= LARGE}
    of_basis = exponent(list(large), list(large.values()))
    goals += [
        Goal("time loop linear in modes", f"exponent {of_modes:.2f}", _yes(of_modes <= 1.1)),
        Goal("time loop linear in start time", f"exponent {of_time:.2f}", _yes(of_time <= 1.1)),
        Goal(
            "basis no worse than n² for unbranched trains",
            f"exponent {of_basis:.2f} from {min(large)} to {max(large)} stations",
            _yes(of_basis <= 2.0),
        ),
    ]
    goals += [
        Goal(
            f"a start of 600 s, {m.what}, in under 300 MB",
            f"{m.peak / 1e6:.0f} MB for {m.simulated:.0f} s in {m.steps} steps ({m.before / 1e6:.0f} MB "
            "before it)",
            _yes(m.peak < MEMORY),
        )
        for m in found["memory"]
    ]
    return goals


def _against_ross(rows: Sequence[PairRow]) -> Goal:
    wanted = "a gear pair with backlash: how much faster than ROSS's robust stepping, both 1e-3 from the reference"
    points = pair_points(list(rows))
    if THEIRS not in points:
        why = next((r.failure for r in rows if r.failure), None) or "ROSS is absent"
        return Goal(wanted, why, "–")
    theirs, reached = time_at(PAIR_ERROR, points[THEIRS])
    best = min(points[THEIRS], key=lambda p: p.error)
    if reached == "–":
        ours, _ = time_at(best.error, points[OURS])
        said = f"ROSS did not reach it; at {best.error:.1e}, the best it was run to, {report.ratio(best.seconds / ours)}"
        return Goal(wanted, said, "–")
    ours, how = time_at(PAIR_ERROR, points[OURS])
    alone, _ = time_at(PAIR_ERROR, points[EVENTS_ALONE])
    sign = "≥ " if how == "≤" else ""
    return Goal(
        wanted,
        f"{sign}{report.ratio(theirs / ours)} ({theirs:.3g} s against {1e3 * ours:.0f} ms with the linear start before it; "
        f"{report.ratio(theirs / alone)} without)",
        "–",
    )


def effect_sections(found: Mapping[str, Any]) -> list[Section]:
    """Starts with events, the gear pair, growth, memory."""
    return [
        Section(
            "Starts with backlash and bearings",
            "The shipped example at full voltage with an elastic mesh of 4e9 N/m, backlash 0.4 mm, "
            "with and without bearings. The linear start of the same case takes turns with it; both "
            "are whole starts with their error estimates.",
            (_teeth_table(found["teeth"]),),
        ),
        Section(
            "A gear pair with backlash beside ROSS",
            "Two gears, a shaft with a damper and a disk behind each; 45 Hz of torque, straight between knots of 1 ms, "
            "by which the teeth part and strike both flanks. What both programs can do and nothing else: gears held "
            "laterally (in ROSS by bearings of 1e12 N/m, as its flanks move with the distance of centres), teeth without "
            "a damper (by one, ROSS's flanks may pull and ours never do), and 0.1 s under a mean torque first, after "
            "which it no longer matters that ROSS begins in the middle of the gap. Errors are those of the mesh force in "
            "the second 0.1 s from a third program, which shares no code with either: the four equations of motion by "
            "Dormand-Prince 8(5,3) at 1e-11, from knot to knot "
            f"({report.error(found['pair'][0])} from itself at 1e-9). Peaks are those of the same window. Times are "
            "those of the whole 0.2 s; ours with both simulations, the error estimate and the linear start that "
            "comes first, and without that; ROSS's without building the model and compiling.",
            (_pair_table(found["pair"][1]),),
        ),
        Section(
            "How cost grows",
            "The time loop at a fixed step with all modes kept; train and modes of unbranched "
            "trains; starts of the example with more and more elements that have clearance; "
            "memory of a start of 600 s in a process of its own, libraries included.",
            (
                _loop_table(*found["loops"]),
                _basis_table(found["basis"]),
                _sizes_table(found["sizes"]),
                _clearances_table(found["clearances"]),
                _memory_table(found["memory"]),
            ),
            ((GROWTH_PICTURE, "Time of the basis against stations, of the loop against modes"),),
        ),
    ]


def _teeth_table(rows: Sequence[StartBeside]) -> Table:
    lines = tuple(
        (
            s.what,
            report.milliseconds(s.linear.seconds),
            report.milliseconds(s.events.seconds),
            report.ratio(s.ratio),
            str(s.linear_steps),
            str(s.steps),
            str(s.impacts),
            report.error(s.estimated_error),
        )
        for s in rows
    )
    columns = (
        "Start", "Linear ms", "With events ms", "Ratio", "Steps linear", "Steps", "Impacts",
        "Reported error",
    )  # fmt: skip
    return Table("Whole starts", columns, lines)


def _pair_table(rows: Sequence[PairRow]) -> Table:
    lines = tuple(
        (
            r.label, r.setting, str(r.steps), f"{r.seconds:.3g}", report.error(r.error),
            f"{1e-3 * r.peak:.3f}", f"{1e-3 * r.trough:.3f}",
        )
        if r.failure is None
        else (r.label, f"fails: {r.failure}", *(5 * ("–",)))
        for r in rows
    )  # fmt: skip
    columns = ("Program", "Setting", "Steps", "s", "Error of the mesh force", "Largest kN", "Least kN")  # fmt: skip
    return Table("Time and error", columns, lines)


def _loop_table(modes: Sequence[LoopRow], times: Sequence[LoopRow]) -> Table:
    lines = tuple(
        (
            str(r.modes),
            f"{r.simulated:.1f}",
            str(r.steps),
            report.milliseconds(r.timing.seconds),
            f"{1e6 * r.timing.seconds / r.steps:.2f}",
        )
        for r in (*modes, *times)
    )
    columns = ("Modes kept", "Simulated s", "Steps", "ms", "µs a step")
    return Table("One simulation", columns, lines)


def _basis_table(found: Mapping[int, Timing]) -> Table:
    lines = tuple((str(n), report.milliseconds(t.seconds)) for n, t in found.items())
    return Table("Train and modes", ("Stations", "ms"), lines)


def _sizes_table(rows: Sequence[SizeRow]) -> Table:
    lines = tuple((str(r.stations), f"{r.seconds:.2f}", f"{r.peak / 1e6:.0f}") for r in rows)
    columns = ("Stations", "Processor s", "Resident MB")
    return Table("All modes of long trains, each in a process of its own", columns, lines)


def _clearances_table(rows: Sequence[ClearanceRow]) -> Table:
    base = rows[0].seconds
    lines = tuple(
        (
            str(r.clearances), report.milliseconds(r.seconds), report.ratio(r.seconds / base),
            str(r.steps), str(r.impacts), report.error(r.estimated_error), r.told,
        )
        for r in rows
    )  # fmt: skip
    columns = ("Clearances", "Processor ms", "Over linear", "Steps", "Impacts", "Reported error", "Tolerance")  # fmt: skip
    return Table("A start with clearances in series", columns, lines)


def _memory_table(rows: Sequence[MemoryRow]) -> Table:
    lines = tuple(
        (
            m.what,
            f"{m.simulated:.0f}",
            str(m.steps),
            f"{m.before / 1e6:.0f}",
            f"{m.peak / 1e6:.0f}",
        )
        for m in rows
    )
    return Table("Resident memory, MB", ("Start", "Simulated s", "Steps", "Before", "Peak"), lines)


def draw_effects(images: Path, found: Mapping[str, Any]) -> None:
    """The picture of how cost grows."""
    modes, _ = found["loops"]
    draw_growth(
        images / GROWTH_PICTURE,
        {n: t.seconds for n, t in found["basis"].items()},
        {r.modes: r.timing.seconds / r.steps for r in modes},
    )
