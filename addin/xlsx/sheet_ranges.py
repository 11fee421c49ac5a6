"""Ranges that a sheet states beside its cells: formats, validations and sparklines that follow a resized table."""

from __future__ import annotations

from collections.abc import Iterable

from addin.xlsx.errors import damaged
from addin.xlsx.references import Rect, parse_range, retargeted
from addin.xlsx.xml_part import EXCEL_2010, EXCEL_2010_FORMULA, Element, main

_SQREF = f"{{{EXCEL_2010_FORMULA}}}sqref"
_SPARKLINE = f"{{{EXCEL_2010}}}sparkline"
_SPARKLINE_RANGE = f"{{{EXCEL_2010_FORMULA}}}f"


def resize_ranges(around_cells: Iterable[Element], old: Rect, new: Rect) -> int:
    """Let conditional formats and data validations follow a resized block.

    Only ranges that reach exactly from its first to its last row, within its columns, are changed.
    """
    count = 0
    for around in around_cells:
        for element in around.iter(main("conditionalFormatting"), main("dataValidation")):
            resized = _resized_ranges(element.get("sqref", ""), old, new)
            if resized is not None:
                element.set("sqref", resized)
                count += 1
        for element in around.iter(_SQREF):
            resized = _resized_ranges(element.text or "", old, new)
            if resized is not None:
                element.text = resized
                count += 1
    return count


def retarget_sparklines(around_cells: Iterable[Element], sheet: str, old: Rect, new: Rect) -> int:
    """Let sparklines over a column of a resized block follow it."""
    count = 0
    for around in around_cells:
        for formula in around.iterfind(f".//{_SPARKLINE}/{_SPARKLINE_RANGE}"):
            moved = retargeted(formula.text or "", sheet, old, new)
            if moved != formula.text:
                formula.text = moved
                count += 1
    return count


def read_range(text: str, what: str) -> Rect:
    """A range as it is in the file; an invalid one is refused, naming whose it is."""
    try:
        return parse_range(text)
    except ValueError as problem:
        raise damaged(f"{what} covers {text[:40]!r}, which is not a valid range.") from problem


def _resized_ranges(sqref: str, old: Rect, new: Rect) -> str | None:
    """A list of ranges with those that follow the block changed; None when there is none."""
    resized = [retargeted(area, "", old, new) for area in sqref.split()]
    return " ".join(resized) if resized != sqref.split() else None
