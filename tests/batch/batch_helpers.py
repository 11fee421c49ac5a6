"""Folders of workbooks that differ in a number, and workers in this process."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from addin.contract.shipped import template_path
from addin.workers.pool import Task, Workers
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name


def make_train(path: Path, number: float = 0, *, example: str = "proposed", **names: Any) -> Path:
    """A filled example; each number gives another case, `names` are scalars typed in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    book = open_workbook(template_path(f"example_{example}.xlsx"), ignore_lock=True)
    typed = {"DampingRatio": 1.5 + 0.01 * number, "Tag": f"T-{number:g}"} | names
    for name, value in typed.items():
        book.set_name(name, value)
    book.save(path)
    return path


def spoil(path: Path) -> Path:
    """Type a negative stiffness into the second row of the table of elements, words into the third."""
    book = open_workbook(path, ignore_lock=True)
    table = book.table("Elements")
    at = table.ref.left + table.column_index("Stiffness")
    book.set_cell(table.sheet, cell_name(table.data.top + 1, at), -2.0)
    book.set_cell(table.sheet, cell_name(table.data.top + 2, at), "soft")
    book.save(in_place=True)
    Path(f"{path}.bak").unlink()
    return path


class Here(Workers):
    """Workers in this process, so that tests can change what they do."""

    def __init__(self) -> None:
        self.waiting: deque[Task] = deque()

    def add(self, task: Task) -> None:
        self.waiting.append(task)

    def answers(self, stopped: Callable[[], bool]) -> Iterator[tuple[Task, Any]]:
        while self.waiting and not stopped():
            task = self.waiting.popleft()
            yield task, task.do(task.payload)
        if stopped():
            self.waiting.clear()

    def close(self) -> None:
        self.waiting.clear()
