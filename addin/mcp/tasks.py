"""What the processes do for the MCP server beyond the tasks of the calculation server."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from addin.reading.case_json import case_to_json
from addin.reading.one_file import Unreadable
from addin.reading.workbook import WorkbookInput
from addin.server import tasks
from addin.server.bounded_reading import bounded_read
from addin.server.tasks import Tell
from addin.studies.check_input import check_input
from addin.verify.file import verify_file
from addin.verify.trace import traced
from addin.verify.wording import as_json
from addin.worksheet.registry import FunctionError
from addin.xlsx.references import cell_name

#: Tables of verdicts: a word of one of their checks stands for its cell.
_VERDICTS = ("Verdicts", "CaseVerdicts")


def _check(path: str, tell: Tell) -> Any:
    """What is to be said of an input before it is calculated, and the inputs as case JSON."""
    tell("reading")
    read = bounded_read(Path(path))
    inputs = None if isinstance(read, Unreadable) or read.problems else case_to_json(read.data)
    return check_input(read), inputs


def _verify(path: str, tell: Tell) -> Any:
    """Whether the results in a workbook follow from its inputs, as JSON."""
    read = bounded_read(Path(path))
    if isinstance(read, Unreadable):
        raise FunctionError(read.problems[0].message)
    return as_json(verify_file(Path(path), on_stage=tell))


def _explain(payload: tuple[str, str, str], tell: Tell) -> Any:
    """Calculate a copy of a workbook, and explain one of its results; problems and lines."""
    source, target, wanted = payload
    problems, _, _ = tasks.TASKS["workbook"]((source, target), tell)
    if problems:
        return problems, []
    try:
        return (), [
            line for each in _cells(Path(target), wanted) for line in traced(Path(target), each)
        ]
    except ValueError as wrong:
        raise FunctionError(str(wrong)) from None


def _cells(path: Path, wanted: str) -> list[str]:
    """Cells of the verdicts whose check begins with these words; else the words themselves."""
    read = bounded_read(path)
    assert isinstance(read, WorkbookInput), path
    found = []
    for name in _VERDICTS:
        table = read.workbook.tables.get(name)
        if table is None or not wanted.strip():
            continue
        check, verdict = (table.ref.left + table.columns.index(c) for c in ("Check", "Verdict"))
        for row in range(table.data.top, table.data.bottom + 1):
            words = read.workbook.shown_value(table.sheet, cell_name(row, check))
            if isinstance(words, str) and words.casefold().startswith(wanted.strip().casefold()):
                found.append(f"{table.sheet}!{cell_name(row, verdict)}")
    return found or [wanted]


#: Tasks of both servers, by name.
TASKS: dict[str, Callable[[Any, Tell], Any]] = {
    **tasks.TASKS,
    "check": _check,
    "verify": _verify,
    "explain": _explain,
}


def answer_of(task: tuple[str, Any], tell: Tell) -> tuple[str, Any]:
    """What becomes of a task; see `addin.server.tasks.answer_of`."""
    return tasks.answer_of(task, tell, TASKS)
