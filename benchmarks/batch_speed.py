"""Throughput and memory of batches: `python -m benchmarks.batch_speed`.

Different workbooks are calculated by `torsionbook batch` and, in turn with it, loaded and saved by
openpyxl without any calculation; then where the time of one workbook goes; then the memory of a batch
of 2,000 workbooks.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import statistics
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import active_children, get_context
from pathlib import Path
from typing import Any

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402

__all__ = ["PAGE", "measured"]

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "batch-speed.md"
EXAMPLES = {
    "proposed and modified": ("proposed", "modified"),
    "backlash, pull-in and bearings": ("backlash",),
    "all three in turn": ("proposed", "modified", "backlash"),
}
#: Files between two looks at the memory. [count]
LOOK = 50


def make(
    folder: Path, count: int, examples: tuple[str, ...], templates: Path = ROOT / "templates"
) -> Path:
    """Workbooks that differ in their damping, made by changing that one number in the XML."""
    folder.mkdir(parents=True)
    for number in range(count):
        example = templates / f"example_{examples[number % len(examples)]}.xlsx"
        with (
            zipfile.ZipFile(example) as old,
            zipfile.ZipFile(folder / f"train {number}.xlsx", "w", zipfile.ZIP_DEFLATED) as new,
        ):
            sheet, cell = _damping(old)
            for name in old.namelist():
                data = old.read(name)
                if name == sheet:
                    found = re.compile(rf'(<c r="{cell}"[^>]*><v>)[^<]*'.encode())
                    data, times = found.subn(rf"\g<1>{1.5 + 1e-4 * number:.6g}".encode(), data)
                    assert times == 1
                new.writestr(name, data)
    return folder


def _damping(book: zipfile.ZipFile) -> tuple[str, str]:
    """Part and cell of the damping ratio; sheets of the templates are numbered in their order."""
    text = book.read("xl/workbook.xml").decode()
    place = re.search(r'<definedName name="DampingRatio">([^<]*)<', text)
    assert place is not None
    sheet, cell = place[1].replace("$", "").rsplit("!", 1)
    names = re.findall(r'<sheet [^>]*?name="([^"]*)"', text)
    return f"xl/worksheets/sheet{names.index(sheet.strip(chr(39))) + 1}.xml", cell


# --- throughput -----------------------------------------------------------------------------------


def _cpu() -> float:
    """Processor time of this process and of those it has ended. [s]"""
    return sum(os.times()[:4])


def ours(
    source: Path, out: Path, jobs: int, look: Callable[[int], None] | None = None
) -> tuple[float, float]:
    """Wall and processor time of a batch, with the start of its processes. [s]"""
    from addin.batch.folder import OutFolder
    from addin.batch.inputs import find_inputs
    from addin.batch.scheduler import Batch, Listener
    from addin.workers.pool import Pool

    class Looking(Listener):
        count = 0

        def advance(self, record: Any) -> None:
            if record is not None and look is not None:
                self.count += 1
                look(self.count)

    pool = Pool(jobs)
    inputs = find_inputs([str(source)], out)
    began, used = time.perf_counter(), _cpu()
    with OutFolder(out) as folder, Batch(folder, pool, listener=Looking()) as batch:
        batch.process(inputs)
        assert all(record.done for record in batch.records.values())
        assert len(batch.records) == len(inputs)
    took = time.perf_counter() - began, _cpu() - used
    shutil.rmtree(out)
    return took


def load_and_save(paths: tuple[str, str]) -> None:
    """What openpyxl does, without any calculation."""
    import openpyxl

    openpyxl.load_workbook(paths[0]).save(paths[1])


def theirs(source: Path, out: Path, jobs: int) -> tuple[float, float]:
    """Wall and processor time of openpyxl, with the start of its processes. [s]"""
    out.mkdir()
    pairs = [(str(path), str(out / path.name)) for path in sorted(source.iterdir())]
    began, used = time.perf_counter(), _cpu()
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        list(pool.map(load_and_save, pairs))
    took = time.perf_counter() - began, _cpu() - used
    shutil.rmtree(out)
    return took


@dataclass(frozen=True)
class Throughput:
    """Workbooks per second of both.

    Parameters
    ----------
    what : str
        Which workbooks. [words]
    jobs : int
        Processes. [count]
    ours, theirs : tuple of (float, float)
        Per second of the clock and per second of processor time, in each round. [1/s]
    """

    what: str
    jobs: int
    ours: tuple[tuple[float, float], ...]
    theirs: tuple[tuple[float, float], ...]


def throughput(place: Path, count: int, rounds: int, jobs: int) -> Iterator[Throughput]:
    """Both in turn."""
    for what, examples in EXAMPLES.items():
        source = make(place / what, count, examples)
        for processes in sorted({1, jobs}):
            mine, other = [], []
            for _ in range(rounds):
                mine.append(_rates(count, ours(source, place / "ours", processes)))
                other.append(_rates(count, theirs(source, place / "theirs", processes)))
                _tell(f"{what}, {processes} processes: {mine[-1]} and {other[-1]} 1/s")
            yield Throughput(what, processes, tuple(mine), tuple(other))


def _rates(count: int, took: tuple[float, float]) -> tuple[float, float]:
    return count / took[0], count / took[1]


def _throughput_table(found: list[Throughput]) -> Table:
    rows = []
    for one in found:
        cells = []
        for which in (0, 1):
            mine = [rates[which] for rates in one.ours]
            other = [rates[which] for rates in one.theirs]
            ratios = sorted(a / b for a, b in zip(mine, other, strict=True))
            cells += [
                f"{statistics.median(mine):.2f}",
                f"{statistics.median(other):.2f}",
                f"{statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})",
            ]
        rows.append((one.what, str(one.jobs), *cells))
    columns = ("Workbooks", "Processes", "batch [1/s]", "openpyxl [1/s]", "ratio",
               "batch, per s of a core", "openpyxl, per s of a core", "ratio")  # fmt: skip
    title = "Workbooks per second, and per second of one core"
    return Table(title, columns, tuple(rows), _goal(found))


def _goal(found: list[Throughput]) -> str:
    """Where the batch is the faster one, by the medians of the clock, with every number of processes."""
    words: dict[bool, list[str]] = {True: [], False: []}
    for what in EXAMPLES:
        ratios = [
            statistics.median(a[0] / b[0] for a, b in zip(one.ours, one.theirs, strict=True))
            for one in found
            if one.what == what
        ]
        if ratios:
            spread = " and ".join(f"{ratio:.2f}" for ratio in ratios)
            words[min(ratios) > 1.0].append(f"{what} ({spread} times)")
    said = [f"met for {', '.join(words[True])}"] if words[True] else []
    said += [f"**not met for {', '.join(words[False])}**"] if words[False] else []
    return f"The goal, faster than that load-and-save with the calculation included, is {'; '.join(said)}."


# --- where the time goes --------------------------------------------------------------------------


@contextmanager
def _timed(places: dict[str, tuple[Any, str]]) -> Iterator[dict[str, float]]:
    """Wall time spent in functions, by words."""
    spent = dict.fromkeys(places, 0.0)
    before = {}

    def wrapped(words: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*a: Any, **k: Any) -> Any:
            began = time.perf_counter()
            try:
                return real(*a, **k)
            finally:
                spent[words] += time.perf_counter() - began

        return timed

    for words, (owner, name) in places.items():
        before[words] = getattr(owner, name)
        setattr(owner, name, wrapped(words, before[words]))
    try:
        yield spent
    finally:
        for words, (owner, name) in places.items():
            setattr(owner, name, before[words])


def stages(place: Path, repeats: int) -> Table:
    """Where the time of one workbook goes, in a process that is warm. [ms]"""
    import addin.calculation.calculation
    import addin.writing.recalculate as recalc
    import addin.writing.workbook as write
    import addin.xlsx.workbook as book

    places = {
        "read and check": (recalc, "read_checked"),
        "calculate": (addin.calculation.calculation, "run_with_conditions"),
        "rows of result and chart tables": (book.Workbook, "write_tables"),
        "formulas: values renewed (formualizer)": (book.Workbook, "refresh_formula_caches"),
        "charts: values renewed": (book.Workbook, "refresh_chart_caches"),
        "pack, verify, write, flush": (book, "save_package"),
        "points of charts": (write, "chart_tables"),
    }
    columns, found = ["Milliseconds a workbook"], []
    for example in ("proposed", "modified", "backlash"):
        source = ROOT / "templates" / f"example_{example}.xlsx"
        target = place / "stages" / f"{example}.xlsx"
        recalc.recalculate(source, destination=target)
        laps: list[dict[str, float]] = []
        for _ in range(repeats):
            with _timed(places) as spent:
                began = time.perf_counter()
                recalc.recalculate(source, destination=target)
                spent["whole"] = time.perf_counter() - began
            laps.append(spent)
        columns.append(example)
        found.append({words: statistics.median(lap[words] for lap in laps) for words in laps[0]})
    for one in found:
        one["all else"] = 2 * one["whole"] - sum(one.values())
    words = [*places, "all else", "whole"]
    rows = tuple((name, *(f"{1e3 * one[name]:.0f}" for one in found)) for name in words)
    return Table("Where the time goes", tuple(columns), rows)


# --- memory ---------------------------------------------------------------------------------------


def _resident(pid: int | str) -> float:
    """Memory of a process. [MB]"""
    text = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    found = re.search(r"VmRSS:\s+(\d+) kB", text)
    return int(found[1]) / 1024 if found else 0.0


def memory(place: Path, count: int, jobs: int) -> Table:
    """Memory of a long batch as it goes on."""
    source = make(place / "many", count, EXAMPLES["proposed and modified"])
    seen: list[tuple[int, float, float]] = []

    def look(done: int) -> None:
        if done % LOOK == 0:
            workers = [_resident(process.pid) for process in active_children()]
            seen.append((done, _resident("self"), max(workers)))

    took = ours(source, place / "out", jobs, look)
    _tell(f"{count} workbooks in {took[0]:.0f} s, {took[1]:.0f} s of processor time")
    chosen = [seen[0], *(one for one in seen if one[0] in (count // 4, count // 2, 3 * count // 4)), seen[-1]]  # fmt: skip
    rows = tuple((f"{done:,}", f"{mine:.0f}", f"{most:.0f}") for done, mine, most in chosen)
    columns = ("Workbooks done", "the batch", "its largest process")
    return Table(f"Memory [MB] in a batch of {count:,}, {jobs} processes", columns, rows)


def measured(count: int, rounds: int, many: int) -> list[Section]:
    """Everything, as tables."""
    from addin.workers.stop import cores

    jobs = cores()
    words = (
        f"Made by `python -m benchmarks.batch_speed --write-docs` on {jobs} cores, "
        f"{platform.system()}, Python {platform.python_version()}. {count} different workbooks a batch, "
        f"{rounds} rounds, both in turn; medians, of the ratio also the least and the largest. The "
        "batch reads each file, calculates it, writes results, charts and fresh values of formulas, "
        "verifies and flushes the file, and journals it; openpyxl loads and saves the same files and "
        "calculates nothing (what it loses is not counted). Times include the start of the processes. "
        "Per second of a core: processor time of all processes, which other work on the machine hardly "
        "changes."
    )
    with tempfile.TemporaryDirectory(prefix="torsionbook-speed-") as folder:
        place = Path(folder)
        tables = [_throughput_table(list(throughput(place, count, rounds, jobs)))]
        tables.append(stages(place, 15))
        if Path("/proc/self/status").exists():
            tables.append(memory(place, many, jobs))
    return [Section("Throughput", words, tuple(tables))]


def _tell(words: str) -> None:
    print(f"… {words}", file=sys.stderr, flush=True)


def main() -> None:
    """Measure, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.batch_speed")
    parser.add_argument("--count", type=int, default=60, help="workbooks of a batch")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--many", type=int, default=2000, help="workbooks of the batch for memory")
    parser.add_argument("--write-docs", action="store_true", help=f"write {PAGE.name}")
    args = parser.parse_args()
    sections = measured(args.count, args.rounds, args.many)
    report.show(sections)
    if args.write_docs:
        report.write_markdown(PAGE, "Throughput of batches", sections)


if __name__ == "__main__":
    main()
