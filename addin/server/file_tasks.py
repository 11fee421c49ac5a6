"""What the page does with a file beside its results: the task, and those that take no time: inputs and edits."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from typing import Any

from addin.contract.problems import CellProblem
from addin.reading.one_file import Unreadable
from addin.reading.typed_case import CaseInput
from addin.server.bounded_reading import WRITING, bounded_read, too_large
from addin.workers.processes import bounded_memory
from addin.worksheet.registry import FunctionError
from addin.writing.edited_inputs import WrongEdit, edit_inputs, typed_inputs

Tell = Callable[[str], None]
Block = dict[str, Any]
#: Problems, warnings, and what the client gets; None where there are problems.
Outcome = tuple[Sequence[CellProblem], Sequence[str], dict[str, Any] | None]
#: Forms of the report: what each is made with, and its media type.
REPORTS = {
    "pdf": (("typst", "matplotlib"), "application/pdf"),
    "docx": (
        ("docx", "matplotlib"),
        "application/vnd.openxmlformats-officedocument.wordprocessingml.document",
    ),
}


@dataclass(frozen=True)
class FileTask:
    """A file of a client and what to do with it."""

    source: Path  #: The file. [path]
    target: Path  #: A name beside it that is free. [path]
    settings: Mapping[str, Any] = field(default_factory=dict)  #: Of the task. [names and values]


def within_memory(
    work: Callable[[FileTask, Tell], Outcome],
) -> Callable[[FileTask, Tell], Outcome]:
    """The task, for which too little memory is something wrong with the file."""

    @wraps(work)
    def bounded(task: FileTask, tell: Tell) -> Outcome:
        try:
            return work(task, tell)
        except MemoryError:
            return too_large(task.source).problems, (), None

    return bounded


def file_block(path: Path, media: str) -> dict[str, str]:
    """A file as a client gets it."""
    content = base64.b64encode(path.read_bytes()).decode("ascii")
    return {"ending": path.suffix, "media": media, "content": content}


@within_memory
def inputs(task: FileTask, tell: Tell) -> Outcome:
    """Everything typed in a file."""
    tell("reading")
    read = bounded_read(task.source)
    if isinstance(read, Unreadable):
        return read.problems, read.warnings, None
    return (), (), typed_inputs(read)


@within_memory
def edited(task: FileTask, tell: Tell) -> Outcome:
    """The file with some inputs typed anew, at the target."""
    tell("reading")
    with bounded_memory(WRITING):
        return typed_anew(bounded_read(task.source), task)


def typed_anew(read: CaseInput | Unreadable, task: FileTask) -> Outcome:
    """What was read, with the changes of the task, at its target."""
    if isinstance(read, Unreadable):
        return read.problems, read.warnings, None
    try:
        edit_inputs(read, task.source, task.settings["changes"], task.target)
    except WrongEdit as wrong:
        raise FunctionError(str(wrong)) from None
    return (), (), {}
