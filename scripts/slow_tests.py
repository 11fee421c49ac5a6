"""Note which tests are too dear for the default run: `make slow-tests`, or `python scripts/slow_tests.py REPORT.xml`.

`tests/conftest.py` leaves out those that stand in tests/slow_tests.txt unless slow tests are asked for. Tests that a report
does not have keep their line. Reports count the test itself, not what it shares with others (`junit_duration_report=call`).
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "tests" / "slow_tests.txt"
#: Too dear: so long a test in the mean of its parameters, or all of them together. [s]
MEAN, TOGETHER = 0.3, 3.0
#: What guards the rooms and the derived files is run by everybody.
ALWAYS = "tests/boundaries/"


def name_of(case: ET.Element) -> str:
    """The test as pytest names it, without its parameters."""
    parts = (case.get("classname") or "").split(".")
    for n in range(len(parts), 0, -1):
        file = Path(*parts[:n]).with_suffix(".py")
        if (ROOT / file).is_file():
            name = (case.get("name") or "").partition("[")[0]
            return "::".join((file.as_posix(), *parts[n:], name))
    return ""


def main() -> None:
    """Renew the record by each report."""
    lines = RECORD.read_text("utf-8").splitlines() if RECORD.is_file() else []
    slow = {line for line in lines if (ROOT / line.partition("::")[0]).is_file()}
    for report in sys.argv[1:]:
        seconds: dict[str, list[float]] = defaultdict(list)
        for case in ET.parse(report).iter("testcase"):
            seconds[name_of(case)].append(float(case.get("time") or 0.0))
        seconds.pop("", None)
        dear = {n for n, took in seconds.items() if sum(took) >= min(TOGETHER, MEAN * len(took))}
        slow = {n for n in slow - seconds.keys() | dear if not n.startswith(ALWAYS)}
    RECORD.write_text("".join(f"{name}\n" for name in sorted(slow)), encoding="utf-8", newline="\n")
    print(f"{RECORD.relative_to(ROOT)}: {len(slow)} tests")


if __name__ == "__main__":
    main()
