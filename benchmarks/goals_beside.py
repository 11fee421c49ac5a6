"""The goals of the compiled loops, in two checkouts by turns: `python -m benchmarks.goals_beside OTHER_CHECKOUT`.

OTHER_CHECKOUT is one of commit 011f76f, the last that compiled its loops by numba on the user's machine, in which
`make demo` has run. Both programs calculate the examples of that commit, each in workbooks of its own, with torque curves
read as that commit read them. They work in processes of their own, one after the other and again, so that
whatever else the machine does falls on both. Ratios are of processor time, which other work hardly changes; wall time
stands beside it. What is found is printed, kept in build/goals.json, and shown by `python -m benchmarks`.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.peers import PEERS, Worker, single_threaded, start_peer

os.environ.update(single_threaded())

from benchmarks import report  # noqa: E402
from benchmarks.goal_rows import ROWS, Row  # noqa: E402
from benchmarks.installed import installed_lines  # noqa: E402
from benchmarks.loop_share import in_loops  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402

__all__ = ["KEPT", "Line", "goals_section", "kept_lines", "measured_rows"]

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "goals.json"
LAID = ROOT / "build" / "goals-examples"
EXAMPLES = "TORSIONBOOK_EXAMPLES"  #: The environment names the folder to a row.
WORKER = Path(__file__).with_name("row_worker.py")


@dataclass(frozen=True)
class Line:
    """One goal with what was measured.

    Parameters
    ----------
    what, old, new, goal : str
        In words and numbers. [text]
    ratio : float
        Processor time, or whatever else counts, of the new program over that of the old. [1]
    met : bool
        Whether the goal is reached. [flag]
    note : str
        How it was measured, where the line does not say. [text]
    """

    what: str
    old: str
    new: str
    ratio: float
    goal: str
    met: bool
    note: str = ""


# --- the same inputs for both ---------------------------------------------------------------------


def examples_of(root: Path) -> Path:
    """Folder of the examples: of the other checkout as shipped, of this one as `lay_examples` wrote them."""
    return LAID if root == ROOT else root / "templates"


def lay_examples(other: Path) -> None:
    """The other checkout's examples in workbooks of this program, torques read at each motor's own speed as there."""
    import torsionbook

    LAID.mkdir(parents=True, exist_ok=True)
    for name in ("proposed", "modified", "backlash"):
        inputs = torsionbook.read(other / "templates" / f"example_{name}.xlsx")
        inputs.change({"TorqueFollows": "own speed"}).write(LAID / f"example_{name}.xlsx")


# --- rows that both checkouts measure in turn -----------------------------------------------------


class Side:
    """A row in one checkout, prepared in a process of its own, with the examples in a folder."""

    def __init__(self, root: Path, code: str) -> None:
        python = root / ".venv" / "bin" / "python"
        self.process = subprocess.Popen(
            [str(python), str(WORKER)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=root,
            env=os.environ | {"PYTHONPATH": str(root), EXAMPLES: str(examples_of(root))},
        )  # fmt: skip
        self.ask(code)

    def ask(self, what: Any) -> dict[str, Any]:
        """One line of JSON there and back."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(json.dumps(what) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"a row ended with status {self.process.wait()}")
        return dict(json.loads(line))

    def stop(self) -> None:
        """Let it end."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        self.process.wait()


@dataclass(frozen=True)
class Times:
    """Medians of one side of a row: processor and wall time of what the goal counts [s], memory [B]."""

    cpu: float
    wall: float
    memory: float
    told: str


def turns(row: Row, other: Path, rounds: int) -> tuple[Times, Times, float]:
    """Old and new by turns, after one lap that only warms up; the ratio is the median over rounds."""
    sides = [Side(other, row.old), Side(ROOT, row.new)]
    try:
        if row.warm:
            for side in sides:
                side.ask(0.0)
        laps: list[list[dict[str, Any]]] = [[], []]
        for _ in range(row.rounds or rounds):
            for found, side in zip(laps, sides, strict=True):
                found.append(side.ask(row.budget))
    finally:
        for side in sides:
            side.stop()
    old, new = ([median(c for _, c in r["laps"]) for r in found] for found in laps)
    ratio = median(n / o for n, o in zip(new, old, strict=True))
    return _times(laps[0], row.times), _times(laps[1], row.times), ratio


def _times(found: Sequence[Mapping[str, Any]], times: float) -> Times:
    wall, cpu = zip(*(lap for r in found for lap in r["laps"]), strict=True)
    last = found[-1]
    return Times(times * median(cpu), times * median(wall), last["memory"], last["told"])


def measured_rows(rows: Sequence[Row], other: Path, rounds: int) -> Iterator[Line]:
    """A line a row; one more for memory where the row has a goal for it."""
    for row in rows:
        old, new, ratio = turns(row, other, rounds)
        told = row.also(new.told)
        loops = in_loops(row.new + row.alone) if row.warm or row.alone else ""
        notes = ". ".join(filter(None, (row.note, _beside(old, new), loops)))
        yield _told(
            Line(
                row.what, _both(old), _both(new), ratio, f"≤ {row.goal:.2f}",
                ratio <= row.goal and told, notes,
            )
        )  # fmt: skip
        if row.memory:
            ratio = new.memory / old.memory
            sizes = (f"{s.memory / 1e6:.0f} MB" for s in (old, new))
            line = Line(f"{row.what}: memory", *sizes, ratio, f"≤ {row.memory:.2f}", ratio <= row.memory)  # fmt: skip
            yield _told(line)


def _beside(old: Times, new: Times) -> str:
    return f"(before: {old.told}; now: {new.told})" if new.told else ""


def _both(t: Times) -> str:
    return f"{_seconds(t.cpu)} ({_seconds(t.wall)})"


def _seconds(value: float) -> str:
    return f"{value:.3g} s" if value >= 1.0 else f"{1e3 * value:.3g} ms"


# --- beside openpyxl, and beside other programs ---------------------------------------------------


def batch_lines(other: Path, rounds: int, count: int) -> Iterator[Line]:
    """The batch of either checkout beside openpyxl's load and save of the same files, one process."""
    import tempfile

    from benchmarks import batch_speed

    for what, examples, goal in (
        ("linear", ("proposed", "modified"), 3.0),
        ("backlash", ("backlash",), 2.0),
    ):
        with tempfile.TemporaryDirectory(prefix="torsionbook-goals-") as folder:
            place = Path(folder)
            roots, sources = (other, ROOT), (place / "old", place / "new")
            sides: list[Side] = []
            for root, source in zip(roots, sources, strict=True):
                batch_speed.make(source, count, examples, examples_of(root))
                sides.append(Side(root, BATCH.format(source=str(source), out=str(place / "out"))))
            ratios: list[list[tuple[float, float]]] = [[], []]
            for _ in range(rounds):
                for found, side, source in zip(ratios, sides, sources, strict=True):
                    theirs = batch_speed.theirs(source, place / "theirs", 1)
                    wall, cpu = side.ask(0.0)["laps"][0]
                    found.append((theirs[1] / cpu, theirs[0] / wall))
            for side in sides:
                side.stop()
        old, new = (
            [median(r[i] for r in found) for i in (0, 1)] for found in ratios
        )  # processor, wall
        yield _told(
            Line(
                f"batch against openpyxl's load and save, {what}",
                *(f"{cpu:.2g} × ({wall:.2g} ×)" for cpu, wall in (old, new)),
                new[0] / old[0], f"≥ {goal:.0f} ×", new[0] >= goal,
                f"{count} workbooks, one process, its start included",
            )
        )  # fmt: skip


BATCH = """
import os, shutil, subprocess, sys, time
def call():
    began, used = time.perf_counter(), sum(os.times()[:4])
    subprocess.run(
        [sys.executable, "-c", "from addin.cli import main; main()", "batch", {source!r}, "--out", {out!r}, "--jobs", "1"],
        check=True, stdout=sys.stderr, stderr=subprocess.DEVNULL,
    )
    took = time.perf_counter() - began, sum(os.times()[:4]) - used
    shutil.rmtree({out!r})
    return took
"""


def peer_lines(workers: Sequence[Worker], rounds: int, slower: float) -> Iterator[Line]:
    """Like for like at 1e-3; `slower` is the old program's time over the new one's for the same samples."""
    from benchmarks import response
    from benchmarks.measure import time_at

    exact, _ = response.response_reference()
    rows = response.compare_responses(workers, exact, rounds, quick=True, alike=True)
    points = response.points_of(list(rows))
    ours, _ = time_at(1e-3, points[response.OURS_ALIKE])
    for label, goal in ((response.OPENTORSION_ALIKE, 50.0), (response.ROSS_ALIKE, 100.0)):
        if label in points:
            theirs, _ = time_at(1e-3, points[label])
            ratio = theirs / ours
            yield _told(
                Line(
                    f"prescribed torque, like for like, at 1e-3: times {label.split()[0]}",
                    f"{ratio / slower:.3g} ×", f"{ratio:.3g} × ({1e3 * theirs:.3g} / {1e3 * ours:.3g} ms)",
                    slower, f"≥ {goal:.0f} ×", ratio >= goal,
                    "processor time, interpolated between steps; everyone gets the same samples",
                )
            )  # fmt: skip


def _told(line: Line) -> Line:
    print(f"… {line.what}: {line.old} → {line.new}, {line.ratio:.3g}", file=sys.stderr, flush=True)
    return line


# --- the table ------------------------------------------------------------------------------------


def goals_section(kept: Mapping[str, Any]) -> Section:
    """The kept lines as a table."""
    lines = tuple(
        (r["what"], r["old"], r["new"], f"{r['ratio']:.3g}", r["goal"], "yes" if r["met"] else "no")
        for r in kept["lines"]
    )
    notes = " ".join(f"*{r['what']}*: {r['note'].rstrip('.')}." for r in kept["lines"] if r["note"])
    columns = ("What", "011f76f", "Now", "Ratio", "Goal", "Met")
    return Section(
        "Goals and what was reached",
        "Made by `make goals OTHER=…`: commit 011f76f, whose loops numba compiled on the user's machine, and this "
        "program by turns, each in an environment of its own on the same machine, with the inputs of that commit's examples "
        f"({kept['day']}, {kept['cores']} cores, load {kept['load'][0]:.1f} before and {kept['load'][1]:.1f} after). Processor time, in brackets wall time; "
        "medians. The goal is the ratio of the two, except where it is said as times another program. What the goals that are "
        "missed consist of, and what was tried: [floors](floors.md).",
        (Table("Goals", columns, lines, notes),),
    )


def kept_lines() -> dict[str, Any] | None:
    """What the last `make goals` found in this checkout."""
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else None


def main() -> None:
    """Measure, keep and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.goals_beside")
    parser.add_argument("other", type=Path, help="checkout of 011f76f in which make demo has run")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", help="rows whose name holds this; the others stay as kept")
    parser.add_argument("--workbooks", type=int, default=20, help="of each batch")
    parser.add_argument(
        "--full", action="store_true", help="all starts of the studies, not some and scaled"
    )
    parser.add_argument(
        "--write-docs", action="store_true", help="write the table into docs/benchmarks.md, too"
    )
    args = parser.parse_args()
    other = args.other.resolve()
    load = os.getloadavg()[0]
    lay_examples(other)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # each start would compile the program
    os.environ[EXAMPLES] = str(LAID)  # a row's share in the loops is measured by this process
    rows = [r.in_full() if args.full else r for r in ROWS]
    groups: dict[str, Callable[[], Iterator[Line]]] = {
        "installed": lambda: map(_told, _installed(other, args.rounds)),
        **{r.what: lambda r=r: measured_rows([r], other, args.rounds) for r in rows},  # type: ignore[misc]
        "batch": lambda: batch_lines(other, args.rounds, args.workbooks),
        "peers": lambda: _peers(args.rounds, lines),
    }
    kept = kept_lines() or {"lines": []}
    lines = {r["what"]: Line(**r) for r in kept["lines"]} if args.only else {}
    for name, group in groups.items():
        if not args.only or args.only in name:
            found = {line.what: line for line in group()}
            if args.only and (kept := kept_lines()):  # another row may be measured meanwhile
                lines = {r["what"]: Line(**r) for r in kept["lines"]}
            lines |= found
            _keep(list(lines.values()), load)
    section = goals_section(json.loads(KEPT.read_text(encoding="utf-8")))
    report.show([section])
    if args.write_docs:
        report.replace_section(ROOT / "docs" / "benchmarks.md", section)


def _keep(lines: Sequence[Line], load: float) -> None:
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    kept = {
        "lines": [asdict(line) for line in lines],
        "cores": os.cpu_count(),
        "day": time.strftime("%d %B %Y"),
        "load": [load, os.getloadavg()[0]],
    }
    KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def _installed(other: Path, rounds: int) -> Iterator[Line]:
    sides = [(root, examples_of(root)) for root in (other, ROOT)]
    for found in installed_lines(sides, rounds):
        yield Line(**found)


def _peers(rounds: int, lines: Mapping[str, Line]) -> Iterator[Line]:
    same = next((r.ratio for w, r in lines.items() if w.startswith("prescribed torque, 15 s")), 1.0)
    workers = []
    for peer in PEERS:
        if peer.name == "ROSS":
            peer = replace(peer, chosen_python=os.environ.get("ROSS_PYTHON"))
        found = start_peer(peer, ROOT / "build" / "bench-peers", install=True)
        if isinstance(found, Worker):
            workers.append(found)
        else:
            print(f"… {found.name} is absent: {found.reason}", file=sys.stderr)
    try:
        yield from peer_lines(workers, rounds, 1.0 / same)
    finally:
        for worker in workers:
            worker.stop()


if __name__ == "__main__":
    main()
