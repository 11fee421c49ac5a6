"""An open workbook as xlwings shows it, made of a file: what the macro `Recalculate` talks to.

Texts are taken as Excel takes those that come from a program: as if they were typed.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import openpyxl
from openpyxl.utils import get_column_letter, range_boundaries

#: What Excel would make something else of than the text it is.
_READ_OTHERWISE = re.compile(r"^\s*[=+\-@.\d]|^(true|false)$|\d\s*[-/:.]\s*\d", re.I)


class OpenCells:
    """A range."""

    def __init__(self, sheet: OpenSheet, first: tuple[int, int], last: tuple[int, int]) -> None:
        self.sheet, self.first, self.last = sheet, first, last
        self.api = SimpleNamespace(Copy=self._copy, PasteSpecial=self._paste)

    @property
    def address(self) -> str:
        (top, left), (bottom, right) = self.first, self.last
        return f"${get_column_letter(left)}${top}:${get_column_letter(right)}${bottom}"

    def _set(self, rows: list[list[Any]]) -> None:
        assert len(rows) == self.last[0] - self.first[0] + 1
        for i, row in enumerate(rows):
            assert len(row) == self.last[1] - self.first[1] + 1
            for j, value in enumerate(row):
                self.sheet.set((self.first[0] + i, self.first[1] + j), value)

    value = property(None, _set)

    def clear_contents(self) -> None:
        for row in range(self.first[0], self.last[0] + 1):
            for column in range(self.first[1], self.last[1] + 1):
                self.sheet.set((row, column), None)

    def _copy(self) -> None:
        self.sheet.book.copied = self

    def _paste(self, kind: int) -> None:
        assert kind == -4122, "formats only"
        self.sheet.book.pasted.append((self.sheet.name, self.address))


class OpenTable:
    """A table."""

    def __init__(self, sheet: OpenSheet, ref: str) -> None:
        left, top, right, bottom = range_boundaries(ref)
        self.range = OpenCells(sheet, (top, left), (bottom, right))

    def resize(self, cells: OpenCells) -> None:
        assert cells.first == self.range.first
        self.range = cells


class OpenSheet:
    """A sheet with its cells."""

    def __init__(self, book: OpenBook, sheet: Any) -> None:
        self.book, self.name = book, sheet.title
        self.cells = {
            (c.row, c.column): getattr(c.value, "text", c.value)
            for row in sheet.iter_rows()
            for c in row
            if c.value is not None
        }
        self.tables = {t.name: OpenTable(self, t.ref) for t in sheet.tables.values()}
        self.api = SimpleNamespace(ProtectContents=False)
        self.written: set[tuple[int, int]] = set()

    def range(self, first: tuple[int, int], last: tuple[int, int]) -> OpenCells:
        return OpenCells(self, first, last)

    def set(self, place: tuple[int, int], value: Any) -> None:
        assert not self.book.app.screen_updating, "redrawing must be off"
        assert self.book.app.calculation == "manual"
        assert not any(vars(self.book.app.api.AutoCorrect).values())
        self.written.add(place)
        if isinstance(value, str) and value.startswith("'"):
            value = value[1:]
        elif isinstance(value, str) and not value.startswith(("=", "#")):
            assert not _READ_OTHERWISE.search(value), f"Excel would not keep {value!r}"
        self.cells[place] = value


class OpenBook:
    """The workbook whose macro called."""

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, path.name
        self.copied: OpenCells | None = None
        self.pasted: list[tuple[str, str]] = []
        self.alerts: list[tuple[str, str]] = []
        self.bar: list[str] = []
        self.app = _App(self)
        self.api = SimpleNamespace(
            SaveCopyAs=lambda place: shutil.copyfile(path, place), FullName=str(path)
        )
        found = openpyxl.load_workbook(path)
        self.sheets = {sheet.title: OpenSheet(self, sheet) for sheet in found.worksheets}

    @property
    def written(self) -> set[tuple[str, tuple[int, int]]]:
        return {(name, place) for name, s in self.sheets.items() for place in s.written}


class _App:
    def __init__(self, book: OpenBook) -> None:
        self._book = book
        self.screen_updating = self.enable_events = True
        self.calculation = "automatic"
        self.api = SimpleNamespace(
            AutoCorrect=SimpleNamespace(AutoFillFormulasInLists=True, AutoExpandListRange=True),
            CutCopyMode=True,
        )

    @property
    def state(self) -> tuple[Any, ...]:
        helps = vars(self.api.AutoCorrect).values()
        return self.screen_updating, self.enable_events, self.calculation, all(helps)

    def _bar(self, text: str) -> None:
        self._book.bar.append(text)

    status_bar = property(None, _bar)

    def alert(self, text: str, title: str, mode: str) -> None:
        assert title == "torsionbook"
        self._book.alerts.append((mode, text))
