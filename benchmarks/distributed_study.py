"""Do errors of trains with distributed shafts hold? `python -m benchmarks.distributed_study`.

Random trains with one to four shafts that have inertia of their own, each run as a user runs it, and
again with every shaft typed as 128 and as 256 massless pieces between stations, extrapolated: frequencies, which
converge with second order, as (4 f₂₅₆ − f₁₂₈) / 3; torques and starts as 2 x₂₅₆ − x₁₂₈, since the
outermost of explicit pieces falls short of the end of its shaft by a first-order term.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())  # one thread a process: there is a process a core

import numpy as np  # noqa: E402

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS  # noqa: E402
from engine.errors import TorsionError  # noqa: E402
from engine.results.results import Results  # noqa: E402
from engine.run import run  # noqa: E402
from tests.distributed_trains import explicit, of_shafts, steady_torques, train  # noqa: E402

#: Trains, shafts of one at the most, and pieces of each shaft of the truth.
TRAINS, MOST_SHAFTS, PIECES = 200, 4, 256


@dataclass(frozen=True)
class Statement:
    """One stated error beside the true one."""

    train: int  #: Train. [1]
    kind: str  #: ``frequency``, ``forced response``, ``peak`` or ``starts``.
    stated: float  #: Relative error that is stated. [1]
    true: float  #: Relative error found. [1]
    tolerance: float | None  #: Tolerance that is said to be met; None = not said. [1]

    @property
    def holds(self) -> bool:
        """Whether the true error is at most the stated one. [flag]"""
        return self.true <= self.stated

    @property
    def keeps(self) -> bool:
        """Whether a tolerance that is said to be met is met. [flag]"""
        return self.tolerance is None or self.true <= self.tolerance


def statements_of(number: int, pieces: int = PIECES) -> list[Statement]:
    """Every statement of one train beside its truth."""
    case = train(number, MOST_SHAFTS)
    found = run(case)
    half, whole = run(explicit(case, pieces // 2)), run(explicit(case, pieces))
    return [
        *_frequencies(number, found, half, whole),
        *_responses(number, found, half, whole),
        *_starts(number, found, half, whole),
    ]


def _frequencies(number: int, found: Results, half: Results, whole: Results) -> Iterator[Statement]:
    own = found.modes.elastic_frequency
    rough, fine = (r.modes.elastic_frequency[: len(own)] for r in (half, whole))
    for f, a, b in zip(own, rough, fine, strict=True):
        if f <= found.accurate_up_to:
            true = abs(float(f) / ((4.0 * b - a) / 3.0) - 1.0)
            yield Statement(number, "frequency", found.frequency_error, true, None)


def _responses(number: int, found: Results, half: Results, whole: Results) -> Iterator[Statement]:
    rough, fine = steady_torques(half), steady_torques(whole)
    for row in found.steady.rows:
        key = row.element, row.excitation, row.mode
        if row.torque and row.error is not None and key in fine and key in rough:
            truth = 2.0 * fine[key] - rough[key]
            true = abs(row.torque / truth - 1.0)
            yield Statement(number, "forced response", row.error, true, None)


def _starts(number: int, found: Results, half: Results, whole: Results) -> Iterator[Statement]:
    assert found.start is not None
    rough, fine = of_shafts(half), of_shafts(whole)
    case, met = found.case, found.start.met_tolerance
    tolerance = (case.tolerance_peak or DEFAULT_TOLERANCE_PEAK) if met else None
    for p in found.start.peaks:
        truth = 2.0 * fine[0][p.element] - rough[0][p.element]
        stated = (p.error + (p.left_out or 0.0)) / p.size
        yield Statement(number, "peak", stated, abs(p.size / truth - 1.0), tolerance)
    errors = dict(found.starts_error)
    wanted = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    for s in found.starts.shafts if found.starts is not None else ():
        truth = 2.0 * fine[1][s.element] - rough[1][s.element]
        error = errors.get(s.element)
        if s.allowable_starts is None or s.starts_low is None or not math.isfinite(truth):
            continue
        true = abs(truth / s.allowable_starts - 1.0)
        high = math.inf if s.starts_high is None else s.starts_high
        end = s.starts_low if truth < s.allowable_starts else high
        said = wanted if error is not None and error <= wanted and met else None
        yield Statement(number, "starts", abs(end / s.allowable_starts - 1.0), true, said)


def _safely(number: int) -> tuple[int, list[Statement], str]:
    try:
        return number, statements_of(number), ""
    except (TorsionError, ArithmeticError, AssertionError, ValueError) as wrong:
        return number, [], f"{type(wrong).__name__}: {wrong}"


def section_of(found: Sequence[Statement], trains: int, failed: Sequence[str]) -> Section:
    """The study in a table."""
    rows = []
    for kind in ("frequency", "forced response", "peak", "starts"):
        own = [s for s in found if s.kind == kind]
        said = [s for s in own if s.tolerance is not None]
        ratio = np.median([s.stated / max(s.true, 1e-300) for s in own]) if own else math.nan
        worst = max(own, key=lambda s: s.true / s.stated, default=None)
        rows.append(
            (
                kind,
                str(len({s.train for s in own})),
                str(len(own)),
                f"{100.0 * sum(s.holds for s in own) / max(len(own), 1):.2f} %",
                f"{ratio:.3g}",
                f"{sum(s.keeps for s in said)} of {len(said)}" if said else "–",
                "–" if worst is None else f"{worst.true / worst.stated:.2g} (train {worst.train})",
            )
        )
    columns = (
        "Statement", "Trains", "Statements", "Hold", "Stated over true, median", "Tolerance met where said",
        "Largest true over stated",
    )  # fmt: skip
    text = (
        f"Made by `python -m benchmarks.distributed_study`: {trains} random trains with one to {MOST_SHAFTS} "
        f"shafts that have a density, {len(failed)} of which failed. Truth: {PIECES // 2} and {PIECES} explicit "
        "pieces a shaft, extrapolated."
    )
    return Section("Distributed shafts", text, (Table("", columns, tuple(rows)),))


def main() -> None:
    """Run the study and print it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.distributed_study")
    parser.add_argument("--trains", type=int, default=TRAINS, help="so many trains")
    parser.add_argument("--first", type=int, default=1000, help="number of the first")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    args = parser.parse_args()
    found: list[Statement] = []
    failed: list[str] = []
    with ProcessPoolExecutor(args.jobs) as pool:
        numbers = range(args.first, args.first + args.trains)
        for future in as_completed([pool.submit(_safely, n) for n in numbers]):
            number, statements, wrong = future.result()
            found += statements
            if wrong:
                failed.append(f"{number}: {wrong}")
                print(failed[-1], file=sys.stderr, flush=True)
            for s in statements:
                if not (s.holds and s.keeps):
                    print(s, file=sys.stderr, flush=True)
    report.show([section_of(found, args.trains, failed)])


if __name__ == "__main__":
    main()
