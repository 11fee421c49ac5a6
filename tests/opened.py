"""What another program (openpyxl) finds in a workbook; each file is read once."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import openpyxl
from openpyxl.utils import range_boundaries


@functools.lru_cache(maxsize=4)
def _opened(path: Path, changed: int) -> openpyxl.Workbook:
    return openpyxl.load_workbook(path, data_only=True)


def opened(path: Path) -> openpyxl.Workbook:
    """Its values, those of formulas as they are stored. Tests change nothing in it."""
    return _opened(path, path.stat().st_mtime_ns)


def rows_of(path: Path, name: str) -> list[dict[str, Any]]:
    """Rows of a table by header."""
    for sheet in opened(path).worksheets:
        if name in sheet.tables:
            left, top, right, bottom = range_boundaries(sheet.tables[name].ref)
            header, *lines = sheet.iter_rows(top, bottom, left, right, values_only=True)
            return [dict(zip(header, line, strict=True)) for line in lines]
    raise AssertionError(f"no table {name}")
