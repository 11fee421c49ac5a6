"""`python -m benchmarks`: time against error, beside other programs, in one run."""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from benchmarks.peers import PEERS, Absent, Worker, single_threaded, start_peer

os.environ.update(single_threaded())  # before numpy is imported, so that every program has one

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build"
PAGE, IMAGES = ROOT / "docs" / "benchmarks.md", ROOT / "docs" / "images"
HARD_PAGE = ROOT / "docs" / "hard-cases.md"


def main() -> None:
    """Measure, print, and on request write the page of the documentation."""
    args = _arguments()
    workers, absent = _peers(args)
    try:
        (_hard_cases if args.hard_cases else _measure)(args, workers, absent)
    finally:
        for worker in workers:
            worker.stop()


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="less of everything; peers only if installed already"
    )
    parser.add_argument("--no-peers", action="store_true", help="leave the other programs out")
    parser.add_argument(
        "--hard-cases", action="store_true", help="the hard cases only (docs/hard-cases.md)"
    )
    parser.add_argument(
        "--write-docs",
        action="store_true",
        help="write the page of the documentation, with pictures",
    )
    parser.add_argument("--rounds", type=int, help="turns of every method (default 7; quick 2)")
    parser.add_argument(
        "--ross-python", metavar="PYTHON", help="the Python (3.13 or later) to install ROSS with"
    )
    return parser.parse_args()


def _tell(words: str) -> None:
    print(f"… {words}", file=sys.stderr, flush=True)


def _peers(args: argparse.Namespace) -> tuple[list[Worker], list[Absent]]:
    workers: list[Worker] = []
    absent: list[Absent] = []
    for peer in PEERS:
        if args.no_peers:
            absent.append(Absent(peer.name, "left out as asked"))
            continue
        _tell(f"{peer.name} (installed on first use)")
        if peer.name == "ROSS" and args.ross_python:
            peer = replace(peer, chosen_python=args.ross_python)
        found = start_peer(peer, BUILD / "bench-peers", install=not args.quick)
        if isinstance(found, Worker):
            workers.append(found)
        else:
            absent.append(found)
    return workers, absent


def _measure(args: argparse.Namespace, workers: list[Worker], absent: list[Absent]) -> None:
    from benchmarks import (
        backlash_speed,
        measure,
        modes,
        pages,
        problems,
        response,
        scaling,
        start,
        warm_workbooks,
        whole_run,
    )

    rounds = args.rounds or (2 if args.quick else 7)
    found: dict[str, Any] = {"machine": measure.machine()}
    _tell("natural frequencies")
    found["modes"] = [
        row
        for rows in modes.compare_modes(workers, modes.mode_problems(args.quick), rounds)
        for row in rows
    ]
    _tell("response to a prescribed torque")
    exact, consistency = response.response_reference()
    found["response_consistency"] = consistency
    found["responses"] = list(response.compare_responses(workers, exact, rounds, args.quick))
    _tell("start: the reference")
    prepared = start.prepare_start(problems.long_start(), start.KEEP_ALL)
    exact, agreement = start.start_reference(prepared, quick=args.quick)
    found["start_agreement"] = agreement
    _tell("start")
    found["starts"] = list(start.compare_starts(prepared, exact, rounds, args.quick))
    found["whole_start"] = start.whole_start(exact, rounds)
    found["growth"] = list(start.growth(rounds, args.quick))
    _tell("starts with backlash, alone and beside ROSS")
    found["teeth"] = list(backlash_speed.compare_starts_with_events(rounds))
    found["pair"] = backlash_speed.compare_pair(workers, rounds, args.quick)
    _tell("how cost grows")
    found["loops"] = scaling.loop_times(rounds, args.quick)
    found["basis"] = scaling.basis_times(rounds, args.quick)
    found["sizes"] = scaling.size_rows(args.quick)
    found["clearances"] = scaling.clearance_rows(args.quick)
    found["memory"] = scaling.memory_of_long_starts()
    _tell("whole recalculation")
    repeats = 3 if args.quick else 15
    found["stages"] = {
        "threads as found": whole_run.running_process(repeats, one_thread=False),
        "one thread": whole_run.running_process(repeats, one_thread=True),
    }
    found["warm"] = warm_workbooks.warm_workbooks(repeats)
    found["programs"] = list(whole_run.program_runs(1 if args.quick else 5))
    timings = [r.timing for r in (*found["modes"], *found["responses"], *found["starts"])]
    busy = sorted(t.busy for t in timings if t is not None)
    found["busy"] = busy[len(busy) * 9 // 10]
    _keep(found, workers, absent)
    pages.publish(found, workers, absent, page=PAGE if args.write_docs else None, images=IMAGES)


def _hard_cases(args: argparse.Namespace, workers: list[Worker], absent: list[Absent]) -> None:
    from benchmarks import hard_cases, report

    rows = []
    for row in hard_cases.hard_case_rows(workers, BUILD / "bench-peers", quick=args.quick):
        _tell(f"{row.case}: {row.ours:.1e}; {row.peers}")
        rows.append(row)
    sections = hard_cases.hard_case_sections(rows, workers, absent)
    report.show(sections)
    if args.write_docs:
        report.write_markdown(HARD_PAGE, "Hard cases", sections)


def _keep(found: dict[str, Any], workers: list[Worker], absent: list[Absent]) -> None:
    """All figures of the run as JSON, for whoever wants to look closer."""
    folder = BUILD / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    peers: dict[str, Any] = {w.name: w.hello for w in workers}
    peers |= {a.name: {"absent": a.reason} for a in absent}
    text = json.dumps(found | {"peers": peers}, default=asdict, indent=1)
    (folder / "results.json").write_text(text + "\n", encoding="utf-8")
    _tell(f"all figures are in {folder / 'results.json'}")


if __name__ == "__main__":
    main()
