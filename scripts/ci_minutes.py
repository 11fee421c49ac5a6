"""Minutes of the whole proof by part, and of the tests by room: `ci_minutes.py tests.xml NAME=SECONDS...`.

Some parts run side by side; the last one named is the time of all. Printed as Markdown, and kept beside the
report of the tests as minutes.md. The rooms' minutes are the durations of their tests added up, of all processes;
`make test` is the wall time of them together.
"""

from __future__ import annotations

import os
import platform
import sys
import time
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path


def rooms(report: Path) -> dict[str, tuple[int, float]]:
    """Number and seconds of the tests of each room of `tests/`; empty without a report."""
    if not report.is_file():
        return {}
    count: Counter[str] = Counter()
    seconds: Counter[str] = Counter()
    for case in ET.parse(report).iter("testcase"):
        names = (case.get("classname") or "").split(".")
        room = names[1] if len(names) > 2 and names[0] == "tests" else "(tests/ itself)"
        count[room] += 1
        seconds[room] += float(case.get("time") or 0.0)
    return {room: (count[room], seconds[room]) for room in sorted(count, key=lambda r: -seconds[r])}


def tables(report: Path, parts: list[tuple[str, float]]) -> str:
    """Both tables, under a line that says when and on what they were measured."""
    python = platform.python_version()
    lines = [
        f"Measured on {time.strftime('%Y-%m-%d')} with {os.cpu_count()} cores and Python {python}.",
        "",
        "| part | minutes |",
        "|---|---:|",
        *(f"| {name} | {took / 60:.1f} |" for name, took in parts),
    ]
    measured = rooms(report)
    if measured:
        lines += ["", "| tests | number | minutes, added up |", "|---|---:|---:|"]
        lines += [f"| {room} | {n:,} | {s / 60:.1f} |" for room, (n, s) in measured.items()]
        lines.append(
            f"| together | {sum(n for n, _ in measured.values()):,} "
            f"| {sum(s for _, s in measured.values()) / 60:.1f} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Print both tables and keep them."""
    report = Path(sys.argv[1])
    words = [word.rpartition("=") for word in sys.argv[2:]]
    text = tables(report, [(name, float(took)) for name, _, took in words])
    print(text)
    report.parent.mkdir(parents=True, exist_ok=True)
    report.with_name("minutes.md").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
