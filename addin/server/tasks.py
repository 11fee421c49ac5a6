"""What the processes of the server do: starts, workbooks, tables, studies; each reports its stages."""

from __future__ import annotations

import importlib
import pickle
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from addin.calculation.calculation import calculate
from addin.reading.one_file import Unreadable
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.server.bounded_reading import WRITING, bounded_read, too_large
from addin.server.file_tasks import edited, inputs
from addin.server.studies import study_of
from addin.server.view import speed_view
from addin.workers.processes import bounded_memory
from addin.worksheet.answers import speed_results
from addin.worksheet.models import Model, system_of
from addin.worksheet.registry import FunctionError
from addin.writing.open_workbook import rectangles, written_results
from addin.writing.recalculate import PreparedInput, recalculate
from addin.xlsx.references import Rect
from engine.errors import InternalError, ModelError

Tell = Callable[[str], None]


class LazyTables(Mapping[str, Any]):
    """Tables of a large train: millions of numbers that are unpacked only where they are asked for.

    Parameters
    ----------
    tables : dict of str to bytes
        Pickled by a process of our own.
    """

    def __init__(self, tables: dict[str, bytes]) -> None:
        self._tables = tables

    def __getitem__(self, name: str) -> Any:
        return pickle.loads(self._tables[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)


def _recalculation(paths: tuple[str, str], tell: Tell, *, is_open: bool) -> Any:
    """Recalculate a workbook, or a copy of an open one; problems, warnings, and what to write into the open one."""
    source, target = map(Path, paths)
    tell("reading")
    try:
        with bounded_memory(WRITING):
            read = bounded_read(source)
            before = _table_sizes(read)
            prepared = PreparedInput(read)
            done = recalculate(
                source, destination=target, on_stage=tell, prepared=prepared, ignore_lock=is_open
            )
            if done.problems or not is_open:
                return done.problems, done.warnings, {}
            assert isinstance(read, WorkbookInput), source
            written = rectangles(written_results(read.workbook), before)
    except MemoryError:
        return too_large(source).problems, (), {}
    histories = [path.suffix for path in done.written if path != target]
    return (), (*done.warnings, *([_NO_HISTORY] if histories else [])), written


#: Where a workbook asks for full histories, which only a folder can hold.
_NO_HISTORY = "The full histories were not saved: run torsionbook recalc for them."


def _table_sizes(read: CaseInput | Unreadable) -> dict[str, Rect]:
    """Size of each table of a workbook."""
    tables = read.workbook.tables.values() if isinstance(read, WorkbookInput) else ()
    return {table.name: table.ref for table in tables}


def _read(path: str, tell: Tell) -> Any:
    """Read a workbook or a case JSON; problems, warnings, the case and its units."""
    tell("reading")
    read = bounded_read(Path(path))
    if isinstance(read, Unreadable) or read.problems:
        return read.problems, read.warnings, None, ""
    return (), read.warnings, read.case(), system_of(read)


def _speed(case: Any, tell: Tell) -> Any:
    """Tables of a case that need no start, each packed by itself."""
    tell("frequencies")
    return LazyTables({name: pickle.dumps(table) for name, table in speed_results(case).items()})


def _view(model: tuple[str, Any, str], tell: Tell) -> Any:
    """What the page draws of a model without its start."""
    tell("frequencies")
    return speed_view(Model(*model))


def _wait(seconds: float, tell: Tell) -> float:
    """Be busy for a while: for measurements and tests of the pool."""
    tell("waiting")
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        sum(range(1000))
    return seconds


#: What the processes can do, by name.
TASKS: dict[str, Callable[[Any, Tell], Any]] = {
    "start": lambda case, tell: calculate(case, on_stage=tell),
    "workbook": partial(_recalculation, is_open=False),
    "rectangles": partial(_recalculation, is_open=True),
    "read": _read,
    "speed": _speed,
    "view": _view,
    "study": study_of,
    "inputs": inputs,
    "edited": edited,
    "wait": _wait,
}
#: Tasks whose module is loaded by the process that does the first of them: what draws and typesets is much.
LATER = {
    "report": "addin.server.reports",
    "verified": "addin.server.documents",
    "compared": "addin.server.documents",
    "studied": "addin.server.documents",
    "study_inputs": "addin.server.documents",
    "study_edited": "addin.server.documents",
}


def load() -> None:
    """Nothing: what most tasks need is loaded with this module."""


def answer_of(
    task: tuple[str, Any], tell: Tell, known: Mapping[str, Callable[[Any, Tell], Any]] = TASKS
) -> tuple[str, Any]:
    """What becomes of a task, by its name and what it works on.

    Parameters
    ----------
    task : tuple
        Its name and what it works on.
    tell : callable
        Called with each stage. [words]
    known : mapping
        Tasks by name.

    Returns
    -------
    kind : str
        ``done``, ``refused`` or ``failed``. [word]
    value : object
        The result; sentence and code of the refusal; what is to be logged of an error of ours.
    """
    name, payload = task
    try:
        do = known.get(name) or getattr(importlib.import_module(LATER[name]), name)
        return "done", do(payload, tell)
    except FunctionError as wrong:
        return "refused", (wrong.message, wrong.code)
    except (ModelError, InternalError) as wrong:
        return "refused", (str(wrong), "#NUM!")
    except Exception:
        return "failed", traceback.format_exc()
