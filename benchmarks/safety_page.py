"""The tables of docs/safety.md that the records give: `python -m benchmarks.safety_page`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PAGE, RECORDS = ROOT / "docs" / "safety.md", ROOT / "benchmarks" / "records"
_MARKS = re.compile(r"(?s)(<!-- made from the records of the file calls -->\n).*?(<!-- end -->)")
_ABOUT = """\
Made by `make kills` from `benchmarks/records/file_calls.json`. A library between the program and the C library counts the calls that
concern the folder of a command, in all its processes, and hinders one of them. *Killed*: kill -9 of all processes before each call that
changes something, and halfway through each write. *Error*: a call, reads too, fails with no space, input/output error, no permission or
quota. *Full disk*: every call that needs room fails from one on. *Power lost*: disks as they may be after each change, without what was
not flushed, without names whose folder was not flushed, or with half of both; equal disks count once. Demanded of each: every input still
there, no file torn, no traceback, and the same command, run again, succeeds and leaves no litter. A dash: not tried. A share is the part
of the calls that was tried.

"""
_WAYS = ("killed", "error", "full disk", "power lost")


def calls_table(record: dict[str, Any]) -> str:
    """What was tried with each command."""
    head = "| Command | calls | that change | killed | error | full disk | power lost | faults |"
    rows = [head, "|---|" + "---:|" * 7]
    total = dict.fromkeys((*_WAYS, "faults"), 0)
    for name, one in record["commands"].items():
        counts = [one[way] for way in _WAYS] + [len(one["faults"])]
        for what, count in zip(total, counts, strict=True):
            total[what] += count
        tried = [_cell(one, way) for way in _WAYS]
        cells = [name, one["calls"], one["changes"], *tried, len(one["faults"])]
        rows.append("| " + " | ".join(map(str, cells)) + " |")
    rows.append("| **all** | | | " + " | ".join(f"{count:,}" for count in total.values()) + " |")
    return "\n".join(rows) + "\n"


def _cell(one: dict[str, Any], way: str) -> str:
    every = one["every"].get(way, 1)
    share = f" (1 of {every})" if every > 1 else ""
    return f"{one[way]}{share}" if one[way] else "–"


def write_page() -> None:
    """Put the tables in their place on the page."""
    record = json.loads((RECORDS / "file_calls.json").read_text("utf-8"))
    text = PAGE.read_text("utf-8")
    made, count = _MARKS.subn(
        lambda found: found[1] + _ABOUT + calls_table(record) + found[2], text
    )
    if count != 1:
        raise SystemExit(f"{PAGE.name} has no place for the table")
    PAGE.write_text(made, encoding="utf-8")


if __name__ == "__main__":
    write_page()
