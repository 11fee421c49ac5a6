"""kill -9 at random moments over batches of 200 workbooks: `python -m benchmarks.batch_crash`.

Fifty kills of the batch, of all its processes or of one that calculates; what must hold after each is
in tests/batch/crash_runs.py, which ten kills over 40 workbooks run in the tests. The record is kept in
docs/batch-crashes.md. It takes half an hour on two cores.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / "batch"), str(ROOT / "tests")]

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402

__all__ = ["PAGE", "crashes"]

PAGE = ROOT / "docs" / "batch-crashes.md"


def crashes(kills: int, workbooks: int, seed: int) -> list[Section]:
    """Kill, resume, compare; any difference ends it with an AssertionError."""
    from crash_runs import Crashes

    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="torsionbook-crashes-") as place:
        found = Crashes(Path(place), workbooks, seed, _tell)
        record = found.run(kills)
    took = time.monotonic() - began
    rows = [
        ("Workbooks of a batch", f"{workbooks:,}"),
        ("Kills that hit a running batch", f"{record.kills:,}"),
        *((f"… of which {who}", f"{count:,}") for who, count in sorted(record.who.items())),
        (
            "Results in place at a kill: least, median, most",
            f"{min(record.places)}, {statistics.median(record.places):g}, {max(record.places)}",
        ),
        ("Batches brought to their end", f"{record.batches:,}"),
        ("Results compared with the undisturbed run after kills and at the end", f"{record.checked:,}"),
        ("Torn files", "0"),
        ("Results that differ from those of the undisturbed run", "0"),
        ("Results lost", "0"),
        ("Recorded results written a second time", "0"),
        ("Seed of the random moments", str(seed)),
        ("Time in all [min]", f"{took / 60:.0f}"),
    ]  # fmt: skip
    words = (
        "Made by `python -m benchmarks.batch_crash --write-docs` on "
        f"{platform.system()}, Python {platform.python_version()}. A batch is begun and killed with "
        "kill -9 at a random moment, resumed and killed again, until it comes to its end; then another "
        "is begun. Killed are at random the batch alone, all its processes, or one of those that "
        "calculate, after which the batch goes on by itself. The zeros are checks: the run ends with "
        "an error at the first file that is torn, differs, is lost or is written twice. Compared are all "
        "parts of the workbooks, the times spent taken out, and the summaries."
    )
    return [
        Section("Killed and resumed", words, (Table("Record", ("What", "Found"), tuple(rows)),))
    ]


def _tell(words: str) -> None:
    print(f"… {words}", file=sys.stderr, flush=True)


def main() -> None:
    """Kill, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.batch_crash")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--workbooks", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1978)
    parser.add_argument("--write-docs", action="store_true", help=f"write {PAGE.name}")
    args = parser.parse_args()
    sections = crashes(args.kills, args.workbooks, args.seed)
    report.show(sections)
    if args.write_docs:
        report.write_markdown(PAGE, "Batches that were killed", sections)


if __name__ == "__main__":
    main()
