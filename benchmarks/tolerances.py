"""Ten and a hundred thousand starts of a tolerance sample: `python -m benchmarks.tolerances`.

The paper's two designs with every stiffness, inertia, damping, torque and the S-N line scattered. First
one process: a sample beside the nominal run it is measured against, in turn. Then the whole study
through the processes of `torsionbook tolerances`, with the wall time a user waits.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402
from engine.case.case import Case
from engine.case.study_inputs import ScatterRow  # noqa: E402
from engine.run import run  # noqa: E402
from engine.studies.tolerances.sample import (  # noqa: E402
    ToleranceSettings,
    Unit,
    evaluate,
    plan_tolerances,
    units_of,
)
from engine.studies.tolerances.tolerances import Tolerances, summarise_sample  # noqa: E402
from tests.sample_case import sample_case  # noqa: E402

__all__ = ["PAGE", "measured"]

PAGE = Path(__file__).resolve().parents[1] / "docs" / "tolerance-speed.md"
DESIGNS = ("proposed", "modified")
#: What scatters in the benchmark: 26 factors.
ROWS = (
    ScatterRow(quantity="stiffness", spread=0.05),
    ScatterRow(quantity="inertia", spread=0.02),
    ScatterRow(quantity="damping ratio", distribution="uniform", spread=0.3),
    ScatterRow(quantity="average torque", spread=0.05),
    ScatterRow(quantity="pulsating torque", distribution="triangular", spread=0.1),
    ScatterRow(quantity="load torque", spread=0.05, together="together"),
    ScatterRow(quantity="S-N line", from_=0.9, to=1.1),
)


@dataclass(frozen=True)
class Cost:
    """Processor time of a sample and of a nominal run. [s]"""

    design: str
    sample: float
    plain: float
    ratios: tuple[float, ...]


def costs(rounds: int) -> Iterator[Cost]:
    """A sample beside the nominal run, in turn, in this process."""
    for design in DESIGNS:
        case = sample_case(design)
        unit = units_of(plan_tolerances(case, ROWS, ToleranceSettings(30)), 20)[0]
        pairs = []
        for turn in range(rounds + 1):
            mine = _cpu(lambda u=unit: evaluate(u)) / len(unit.values)
            plain = _cpu(lambda c=case: [run(c) for _ in range(5)]) / 5.0
            if turn:
                pairs.append((mine, plain))
        samples, plains = zip(*pairs, strict=True)
        yield Cost(
            design,
            statistics.median(samples),
            statistics.median(plains),
            tuple(p / s for s, p in pairs),
        )


def _cpu(call: Callable[[], object]) -> float:
    began = time.process_time()
    call()
    return time.process_time() - began


@dataclass(frozen=True)
class Whole:
    """One study as a user runs it."""

    design: str
    wall: float
    cpu: float
    parent: float  #: Most memory that this process, and any of the others, has had so far. [MB]
    worker: float  #: Likewise.
    found: Tolerances


def whole(design: str, samples: int, jobs: int) -> Whole:
    """Plan, samples and result over processes; their time is that of their own clocks."""
    from addin.contract.version import product_version
    from addin.workers.opened_map import open_parallel_map

    case: Case = sample_case(design)
    began, own = time.perf_counter(), time.process_time()
    plan = plan_tolerances(case, ROWS, ToleranceSettings(samples))
    with open_parallel_map(jobs, None, product_version, lambda: False) as spread:
        answers = spread(_timed, units_of(plan), _tell_done(plan.n_runs))
    found = summarise_sample(plan, [answer for answer, _ in answers])
    cpu = time.process_time() - own + sum(spent for _, spent in answers)
    parent, worker = (
        resource.getrusage(who).ru_maxrss / 1024.0
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return Whole(design, time.perf_counter() - began, cpu, parent, worker, found)


def _timed(unit: Unit) -> tuple[object, float]:
    """A unit and its processor time in the process that did it."""
    began = time.process_time()
    done = evaluate(unit)
    return done, time.process_time() - began


def _tell_done(runs: int) -> Callable[[int], None]:
    def tell(count: int) -> None:
        if count % 40 == 0:
            print(f"… {min(count * 50, runs):,} of {runs:,}", file=sys.stderr, flush=True)

    return tell


def measured(samples: int, soak: int, rounds: int, jobs: int) -> list[Section]:
    """Everything, as tables."""
    one = Table(
        "Processor time of a start [ms], in one process",
        ("Design", "a sample", "the nominal run", "nominal run over sample (least to largest)"),
        tuple(
            (
                c.design,
                f"{1e3 * c.sample:.1f}",
                f"{1e3 * c.plain:.1f}",
                f"{statistics.median(c.ratios):.2f} ({min(c.ratios):.2f} to {max(c.ratios):.2f})",
            )
            for c in costs(rounds)
        ),
    )
    rows = []
    for design, size in (*((one, samples) for one in DESIGNS), (DESIGNS[0], soak)):
        w = whole(design, size, jobs)
        runs = size + 2 * len(w.found.drivers)
        answer = ("allowable starts", "HP compressor shaft")
        starts = next(r for r in w.found.percentiles if (r.quantity, r.of) == answer)
        p10 = starts.percentiles[0]
        assert p10.low is not None
        assert p10.high is not None
        reach = max(p10.high - p10.value, p10.value - p10.low) / p10.value
        rows.append(
            (
                design,
                f"{runs:,}",
                f"{w.wall:.0f}",
                f"{w.cpu:.0f}",
                f"{1e3 * w.cpu / runs:.1f}",
                f"{w.parent:.0f}, {w.worker:.0f}",
                f"{100.0 * reach:.1f} %",
                "yes" if w.found.converged else "no",
            )
        )
    many = Table(
        f"{samples:,} and {soak:,} samples, {jobs} processes",
        (
            "Design",
            "starts",
            "wall [s]",
            "processor [s]",
            "each [ms]",
            "most memory so far of parent and of a process [MB]",
            "P10 ±",
            "converged",
        ),  # fmt: skip
        tuple(rows),
        "Goal: 10,000 starts within 120 s of wall time on two cores that do nothing else.",
    )
    words = (
        f"Made by `python -m benchmarks.tolerances --write-docs` on {platform.system()}, Python "
        f"{platform.python_version()}. 26 factors, Latin hypercube. Wall time includes the start of "
        "the processes and everything from the nominal run to the result; processor time is that of the "
        "samples and the parent, which other work on the machine hardly changes. "
        f"{rounds} rounds in turn for the first table; medians."
    )
    return [Section("Ten thousand starts", words, (one, many))]


def main() -> None:
    """Measure, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tolerances")
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--soak", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write-docs", action="store_true", help=f"write {PAGE.name}")
    args = parser.parse_args()
    sections = measured(args.samples, args.soak, args.rounds, args.jobs)
    report.show(sections)
    if args.write_docs:
        report.write_markdown(PAGE, "Ten thousand starts", sections)


if __name__ == "__main__":
    from benchmarks import tolerances  # its functions have a name that the other processes find

    tolerances.main()
