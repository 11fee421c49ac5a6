"""Tables on the terminal, and the same tables in docs/benchmarks.md."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table as RichTable

from benchmarks.goals import Goal
from benchmarks.measure import Point, time_at
from benchmarks.modes import OURS_ALL, ModesRow
from benchmarks.response import ResponseRow
from benchmarks.start import GrowthRow, StartRow, WholeStart
from benchmarks.warm_workbooks import WarmWorkbook
from benchmarks.whole_run import ProgramRun, StageTimes

__all__ = [
    "Section", "Table", "at_equal_error", "goals_table", "growth_table", "machine_line",
    "modes_tables", "program_table", "response_table", "show", "stage_table", "start_table",
    "whole_start_table", "replace_section", "write_markdown",
]  # fmt: skip

NONE = "–"
#: Tables whose cells are words more than numbers: aligned to the left.
WORDS = {"Goals", "Other goals"}


@dataclass(frozen=True)
class Table:
    """Words and numbers already in their final form; the first column is a name."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


@dataclass(frozen=True)
class Section:
    """A heading, what to know, tables and pictures."""

    heading: str
    text: str
    tables: tuple[Table, ...] = ()
    pictures: tuple[tuple[str, str], ...] = ()
    """File name in docs/images, and what it shows."""


def milliseconds(seconds: float | None) -> str:
    """Three digits of a time in ms."""
    if seconds is None or not math.isfinite(seconds):
        return NONE
    ms = 1e3 * seconds
    return f"{ms:.0f}" if ms >= 100 else f"{ms:.3g}"


def error(value: float) -> str:
    """Two digits of a relative error."""
    if not math.isfinite(value):
        return NONE
    if value == 0.0:
        return "0"
    return f"{value:.1e}"


def ratio(value: float) -> str:
    """How many times."""
    if not math.isfinite(value):
        return NONE
    return f"{value:.0f} ×" if value >= 10 else f"{value:.2g} ×"


def goals_table(goals: Sequence[Goal]) -> Table:
    rows = tuple((g.wanted, g.measured, g.verdict) for g in goals)
    return Table("Other goals", ("Goal", "Measured", "Met"), rows)


def modes_tables(rows: Sequence[ModesRow]) -> tuple[Table, ...]:
    """One table a train."""
    tables = []
    for problem in dict.fromkeys(r.problem for r in rows):
        of_it = [r for r in rows if r.problem == problem]
        base = next(r.timing.seconds for r in of_it if r.method == OURS_ALL and r.timing)
        lines = tuple(
            (
                r.method,
                milliseconds(r.timing.seconds if r.timing else None),
                ratio(r.timing.seconds / base) if r.timing else NONE,
                error(r.lowest_error),
                error(r.worst_error),
                f"{r.presented} of {r.wanted}" if r.presented else (r.failure or NONE),
            )
            for r in of_it
        )
        columns = ("Call", "ms", "Time over ours", "Error of first", "Worst error", "Presented")
        tables.append(Table(problem, columns, lines))
    return tuple(tables)


def response_table(rows: Sequence[ResponseRow]) -> Table:
    lines = []
    for label in dict.fromkeys(r.label for r in rows):
        for r in sorted((r for r in rows if r.label == label), key=lambda r: -r.step):
            lines.append(
                (
                    label,
                    f"{1e3 * r.step:g}",
                    milliseconds(r.timing.seconds if r.timing else None),
                    error(r.error) if r.timing else f"fails: {_short(r.failure)}",
                    error(r.sample_error),
                    f"{r.peak_error:+.1e}" if r.timing else NONE,
                )
            )
    columns = ("Method", "Step ms", "ms", "Trajectory error", "At its samples", "Peak torque")
    return Table("Every step", columns, tuple(lines))


def _short(failure: str | None) -> str:
    return (failure or "").split(": ", 1)[-1].split(".")[0]


def at_equal_error(
    points: Mapping[str, Sequence[Point]],
    ours: str,
    targets: Sequence[float],
    beside: str | None = None,
) -> Table:
    """Time of each method at the same error, and how many times ours it is; `beside` is a second base for that."""
    lines = []
    bases = [ours, *([beside] if beside else [])]
    for label, found in points.items():
        cells = []
        for target in targets:
            seconds, how = time_at(target, found)
            if how == "–":
                cells += [f"not reached ({error(min(p.error for p in found))})", *(NONE for _ in bases)]  # fmt: skip
                continue
            cells.append(f"{'≤ ' if how == '≤' else ''}{milliseconds(seconds)}")
            cells += [ratio(seconds / time_at(target, points[base])[0]) for base in bases]
        lines.append((label, *cells))
    columns = ["Method"]
    for target in targets:
        over = ["over ours"] if beside is None else ["over ours alike", "over ours as a function"]
        columns += [f"ms at {target:.0e}".replace("e-0", "e-"), *over]
    note = (
        "Interpolated between steps. ≤: the coarsest step tried is better than that already. "
        "Not reached: with the smallest error of all steps tried."
    )
    return Table("At equal trajectory error", tuple(columns), tuple(lines), note)


def start_table(rows: Sequence[StartRow]) -> Table:
    lines = tuple(
        (
            label,
            f"{1e3 * r.step:g}",
            str(r.steps),
            milliseconds(r.timing.seconds),
            error(r.error),
            error(r.peak_error),
        )
        for label in dict.fromkeys(r.label for r in rows)
        for r in rows
        if r.label == label
    )
    columns = ("Method", "Step ms", "Steps", "ms", "Trajectory error", "Worst peak")
    return Table("Every step", columns, lines)


def whole_start_table(w: WholeStart) -> Table:
    rows = (
        (
            "run_start: two simulations, turning points, estimate",
            f"{1e3 * w.timing.seconds:.1f} ms",
        ),
        ("one simulation at its finer step", f"{1e3 * w.simulation.seconds:.1f} ms"),
        ("simulated", f"{w.seconds_simulated:.2f} s in {w.steps} steps of {1e3 * w.step:.2f} ms"),
        ("modes kept, halvings", f"{w.kept_modes}, {w.halvings}"),
        ("error of peaks it reports (wanted 1e-3)", error(w.estimated_error)),
        ("true error of the worst peak", error(w.peak_error)),
        ("true trajectory error", error(w.trajectory_error)),
    )
    return Table("The start as a case calls for it", ("", "Measured"), rows)


def growth_table(rows: Sequence[GrowthRow]) -> Table:
    lines = tuple(
        (
            str(r.stations),
            str(r.kept_modes),
            f"{r.seconds_simulated:.1f}",
            str(r.steps),
            milliseconds(r.timing.seconds),
            f"{1e6 * r.timing.seconds / r.steps:.2f}",
        )
        for r in rows
    )
    columns = ("Stations", "Modes kept", "Simulated s", "Steps", "ms", "µs a step")
    return Table("One simulation at 0.75 ms", columns, lines)


def stage_table(found: Mapping[str, StageTimes]) -> Table:
    first = next(iter(found.values()))
    lines = [
        (stage, *(milliseconds(dict(f.stages).get(stage)) for f in found.values()))
        for stage, _ in first.stages
    ]
    lines.append(("whole", *(milliseconds(f.whole.seconds) for f in found.values())))
    return Table("One workbook in a running process, ms", ("Stage", *found), tuple(lines))


def warm_table(rows: Sequence[WarmWorkbook]) -> Table:
    lines = tuple(
        (r.label, *(milliseconds(seconds) for seconds in r.seconds.values()), str(r.rounds))
        for r in rows
    )
    columns = ("Workbook", *(f"{name}, ms" for name in rows[0].seconds), "Rounds")
    return Table("Processor time in a running process, one thread", columns, lines)


def program_table(runs: Sequence[ProgramRun]) -> Table:
    lines = tuple((r.label, f"{r.seconds:.2f}", str(r.runs)) for r in runs)
    return Table("As a program, s", ("Command", "Seconds", "Runs"), lines)


def machine_line(facts: Mapping[str, str], busy: float) -> str:
    """The machine in one sentence, without its name."""
    return (
        f"{facts['cores']} cores, {facts['system']}, Python {facts['python']}, numpy "
        f"{facts['numpy']}, scipy {facts['scipy']}, loops by {facts['loops']}; linear algebra on one "
        f"thread. Nine tenths of the medians have at most {busy:.2f} s of wall time a second of "
        f"processor time; where nothing else runs it is 1. The load was {facts['load']}."
    )


def show(sections: Sequence[Section]) -> None:
    """Print everything."""
    console = Console(width=None if Console().is_terminal else 120)
    for section in sections:
        console.rule(section.heading)
        console.print(section.text, highlight=False, markup=False)
        for table in section.tables:
            drawn = RichTable(title=table.title, title_justify="left", caption=table.note or None)
            for i, column in enumerate(table.columns):
                drawn.add_column(column, justify="left" if i == 0 else "right")
            for row in table.rows:
                drawn.add_row(*row)
            console.print(drawn)


def write_markdown(path: Path, title: str, sections: Sequence[Section]) -> None:
    """The same as a page of the documentation."""
    lines = [f"# {title}", "", *(line for section in sections for line in _lines_of(section))]
    path.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def replace_section(path: Path, section: Section) -> None:
    """Write one section of a page anew; the others stay as they are."""
    before, heading, rest = path.read_text(encoding="utf-8").partition(f"## {section.heading}\n")
    if not heading:
        raise ValueError(f"{path} has no section {section.heading}")
    _, following, after = rest.partition("\n## ")
    text = "\n".join(_lines_of(section)).rstrip() + "\n"
    path.write_text(before + text + following + after, encoding="utf-8")


def _lines_of(section: Section) -> list[str]:
    lines = [f"## {section.heading}", "", section.text, ""]
    for name, what in section.pictures:
        lines += [f"![{what}](images/{name})", ""]
    for table in section.tables:
        lines += [f"**{table.title}**", ""]
        words = table.title in WORDS
        lines.append("| " + " | ".join(table.columns) + " |")
        lines.append(
            "|" + "|".join(["---", *["---" if words else "--:"] * (len(table.columns) - 1)]) + "|"
        )
        lines += ["| " + " | ".join(row) + " |" for row in table.rows]
        lines.append("")
        if table.note:
            lines += [table.note, ""]
    return lines
