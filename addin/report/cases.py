"""The case under other conditions: what was asked, the verdicts of each, and which governs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from addin.report.document import Listing, Paragraph, Section, section
from addin.report.numbers import clean, significant
from addin.report.subject import Subject
from addin.report.tables import input_table
from engine.case.result_words import Judgement
from engine.results.verdicts import CONDITIONS

Row = Mapping[str, Any]

#: The case itself, beside its conditions.
TYPED = "the case as typed"
_FAILED = (Judgement.FAIL, Judgement.UNBOUNDED)
_OPEN = (Judgement.NOT_JUDGED, Judgement.INCOMPLETE)
#: Sums of checks, which have no number of their own.
_SUMS = ("Overall", CONDITIONS)
#: Checks whose result must not be below its limit.
_AT_LEAST = ("Separation margin", "Allowable starts")


def cases(subject: Subject) -> Section:
    """The conditions as typed, their verdicts, and what decides under each."""
    typed = input_table(
        "StartConditions",
        subject.read.typed.tables.get("StartConditions", []),
        subject.shown,
        "Conditions; blank = as the case",
    )
    columns = ("Condition", "Changed", "Margin", "Response", "Start", "Verdict")
    note = (
        "The worst verdict of the checks of each kind: separation margin, forced response, start or event, and all "
        "of them."
    )
    matrix = subject.table("CaseMatrix", "Verdicts under each condition", columns, note=note)
    deciding = [row for row in map(_decides, _conditions(subject).values()) if row is not None]
    shown = ("Condition", "Check", "Result", "Limit", "Verdict", "Where")
    found = subject.table(
        "CaseVerdicts", "What decides under each condition", shown,
        note="The check farthest beyond its limit, by their ratio; where all are kept, the one nearest to it.", rows=deciding,
    )  # fmt: skip
    return section(
        "Cases", Paragraph(governing(subject), "lead"), typed, matrix, found if deciding else None, _open(subject)
    )  # fmt: skip


def governing(subject: Subject) -> str:
    """Which of the case and its conditions governs, and by which number.

    Returns
    -------
    str
        A sentence; empty where no conditions are typed. [text]
    """
    conditions = _conditions(subject)
    if not conditions:
        return ""
    own = [dict(row) | {"condition": TYPED} for row in subject.rows("Verdicts")]
    worst = _decides([*own, *(row for rows in conditions.values() for row in rows)])
    if worst is None:
        return "Under no condition is a result judged."
    cells = subject.cells("CaseVerdicts", worst, ("Condition", "Result", "Limit"))
    name, check = clean(str(worst["condition"])), clean(str(worst["check"]))
    who = f"condition {name}" if name != TYPED else name
    words = f"{check} {cells.get('Result', '')}"
    if cells.get("Limit"):
        words += f", {'limit' if _is_number(worst['result']) else 'required:'} {cells['Limit']}"
    where = re.split("[:;]", clean(str(worst.get("where") or "")))[0]
    if where and _is_number(worst["result"]):
        words += f" ({where})"
    if worst["verdict"] not in _FAILED:
        return f"No judged check fails under any condition. Nearest to its limit: {who}. {words}."
    share = _share(worst)
    if 1.0 < share < math.inf:
        words += f", by a factor of {significant(share, 3)}"
    return f"{who[0].upper()}{who[1:]} governs: {words}."


def _conditions(subject: Subject) -> dict[str, list[Row]]:
    """Checks by condition, in the order typed."""
    found: dict[str, list[Row]] = {}
    for row in subject.rows("CaseVerdicts"):
        found.setdefault(str(row["condition"]), []).append(row)
    return found


def _decides(rows: list[Any]) -> Row | None:
    """The check that fails by most; where none fails the one nearest to its limit; None where none is judged."""
    checks = [row for row in rows if row["check"] not in _SUMS and row["verdict"] not in _OPEN]
    failed = [row for row in checks if row["verdict"] in _FAILED]
    return max(failed or checks, key=_share, default=None)


def _share(row: Row) -> float:
    """The result over its limit, or the limit over a result that must not be below it; above 1 it is not kept. [1]"""
    result, limit = row["result"], row["limit"]
    if not _is_number(result) or not _is_number(limit):
        # an outcome in words, or no limit to compare with
        return math.inf if row["verdict"] in _FAILED else 0.0
    if row["check"] in _AT_LEAST:
        return limit / result if result > 0.0 else math.inf
    if limit < 0.0:  # a torque that may fall so far below zero
        return max(result / limit, 0.0)
    if limit == 0.0:
        return math.inf if result else 0.0
    return abs(result) / limit


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _open(subject: Subject) -> Listing | None:
    """Conditions under which a check is not judged, or only in part."""
    items = tuple(_open_checks(subject))
    return Listing(items) if items else None


def _open_checks(subject: Subject) -> Iterator[str]:
    for name, rows in _conditions(subject).items():
        names = [
            clean(str(row["check"]))
            for row in rows
            if row["check"] not in _SUMS and row["verdict"] in _OPEN
        ]
        if names:
            yield f"{clean(name)}: not judged, or only in part: {', '.join(names)}."
        elif len(rows) == 1 and rows[0]["verdict"] in _OPEN:
            yield f"{clean(name)}: {clean(str(rows[0].get('where') or 'not judged'))}."
