"""Minutes of the whole proof by part, and of the tests by room: `ci_minutes.py tests.xml NAME=SECONDS...`.

Printed as Markdown, as it stands in docs/ci.md. The rooms' minutes are the durations of their tests
added up, of all processes; `make test` is the wall time of them together.
"""

from __future__ import annotations

import sys
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


def main() -> None:
    """Print both tables."""
    report, parts = Path(sys.argv[1]), [word.rpartition("=") for word in sys.argv[2:]]
    print("| part | minutes |\n|---|---:|")
    for name, _, took in parts:
        print(f"| {name} | {float(took) / 60:.1f} |")
    print(f"| together | {sum(float(took) for _, _, took in parts) / 60:.1f} |")
    found = rooms(report)
    if found:
        print("\n| tests | number | minutes, added up |\n|---|---:|---:|")
        for room, (count, seconds) in found.items():
            print(f"| {room} | {count:,} | {seconds / 60:.1f} |")


if __name__ == "__main__":
    main()
