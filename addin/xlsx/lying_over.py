"""What lies over the cells of a sheet: pictures, shapes with a text or a ground, charts, controls, open comments."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from addin.xlsx.references import MAX_COLUMN, MAX_ROW, Rect, parse_range, whole_number
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.state import WorkbookState
from addin.xlsx.xml_part import Element, parse_part

_EMU_PER_POINT, _EMU_PER_PIXEL = 12_700, 9_525
_PIXELS_PER_CHARACTER, _PADDING = 7, 5
#: Less of a cell than this hides nothing. [EMU]
_EDGE = 4 * _EMU_PER_PIXEL
#: Lines up to this width hide nothing. [EMU]
_LINE = 6 * _EMU_PER_POINT
#: Place and size of an older shape.
_IN_POINTS = re.compile(r"\b(margin-left|margin-top|width|height):\s*(\d{1,6}(?:\.\d{1,6})?)pt\b")
_KINDS = {"pic": "a picture", "sp": "a text box or shape", "grpSp": "a group of shapes", "cxnSp": "a wide line",
          "graphicFrame": "a chart", "contentPart": "ink"}  # fmt: skip


@dataclass(frozen=True)
class LyingOver:
    """Something that lies over cells."""

    kind: str  #: What it is, with its article.
    name: str  #: Its name; empty where the file has none.
    rect: Rect  #: The cells under it.
    text: str = ""  #: Words in it.


def lying_over(workbook: WorkbookState, sheet: str) -> Iterator[LyingOver]:
    """Everything that lies over the cells of a sheet.

    Thin lines, and shapes that have neither ground nor text, hide nothing and are left out.
    """
    for element in workbook.sheet_part(sheet).around_cells():
        for one in element.iter():
            if _name(one) == "sqref" and (above := one.getparent()) is not None:
                areas = (one.text or "").split() if _name(above) == "sparkline" else ()
                for area in areas:
                    yield LyingOver("a sparkline", "", parse_range(area))
    part = workbook.structure.worksheet_part(sheet)
    for related in workbook.structure.relationships(part) if part else ():
        if workbook.container.find(related.part) is None:
            continue
        if related.kind == "drawing":
            root = parse_part(workbook.container.charged(related.part), related.part)
            yield from _of_drawing(root, workbook.sheet_part(sheet))
        elif related.kind == "vmlDrawing":
            data = workbook.container.read(related.part)
            yield from _of_legacy(data, workbook.sheet_part(sheet))


def _of_drawing(root: Element, cells: SheetPart) -> Iterator[LyingOver]:
    for anchor in root.iter():
        if _name(anchor) not in ("twoCellAnchor", "oneCellAnchor", "absoluteAnchor"):
            continue
        rect = _under(anchor, cells)
        shape = next((one for one in anchor.iter() if _name(one) in _KINDS), None)
        if rect is None or shape is None:
            continue
        parts = [one for one in shape.iter() if _name(one) in _KINDS]
        if not any(_covers(one) for one in parts):
            continue
        about = next((one for one in shape.iter() if _name(one) == "cNvPr"), None)
        if about is not None and about.get("hidden", "0") not in ("0", "false"):
            continue
        text = "".join(one.text or "" for one in shape.iter() if _name(one) == "t")
        name = "" if about is None else about.get("name", "")
        yield LyingOver(_KINDS[_name(shape)], name, rect, text)


def _covers(shape: Element) -> bool:
    """Whether a shape has a ground or a text; pictures and charts have."""
    if _name(shape) not in ("sp", "cxnSp"):
        return _name(shape) != "grpSp"
    lines = (one.get("w", "") for one in shape.iter() if _name(one) == "ln")
    if any((whole_number(width, 10**9) or 0) > _LINE for width in lines):
        return True
    if _name(shape) == "cxnSp":
        return False
    if any((one.text or "").strip() for one in shape.iter() if _name(one) == "t"):
        return True
    if any(one.get("textlink") for one in shape.iter()):
        return True
    looks = next((one for one in shape if _name(one) == "spPr"), None)
    grounds = {_name(one) for one in looks} if looks is not None else set()
    if "noFill" in grounds:
        return False
    by_style = [one for one in shape.iter() if _name(one) == "fillRef"]
    return bool(grounds & {"solidFill", "gradFill", "blipFill", "pattFill", "grpFill"}) or any(
        one.get("idx", "0") != "0" for one in by_style
    )


def _under(anchor: Element, cells: SheetPart) -> Rect | None:
    """The cells under an anchor."""
    held = {_name(one): one for one in anchor}
    start, end, size, at = (held.get(name) for name in ("from", "to", "ext", "pos"))
    rows, columns = (_first(start, at, cells, down) for down in (True, False))
    if rows is None or columns is None:
        return None
    if end is not None:
        bottom, right = _place(end, down=True), _place(end, down=False)
        if bottom is None or right is None:
            return None
        last_row = bottom[0] if bottom[1] > _EDGE else bottom[0] - 1
        last_column = right[0] if right[1] > _EDGE else right[0] - 1
    elif size is not None:
        last_row = _last(rows, size.get("cy"), cells, down=True)
        last_column = _last(columns, size.get("cx"), cells, down=False)
    else:
        return None
    top = rows[0] + (_extent(cells, rows[0], down=True) - rows[1] < _EDGE)
    left = columns[0] + (_extent(cells, columns[0], down=False) - columns[1] < _EDGE)
    if last_row < top or last_column < left:
        return None
    return Rect(top, left, min(last_row, MAX_ROW), min(last_column, MAX_COLUMN))


def _first(
    start: Element | None, at: Element | None, cells: SheetPart, down: bool
) -> tuple[int, int] | None:
    """Row or column, counted from 1, in which an anchor begins, and how far into it. [EMU]"""
    if start is not None:
        return _place(start, down=down)
    if at is None:
        return None
    left = whole_number((at.get("y") if down else at.get("x")) or "", 10**12) or 0
    return _walk(1, left, cells, down)


def _place(corner: Element, *, down: bool) -> tuple[int, int] | None:
    held = {_name(one): one.text or "" for one in corner}
    at = whole_number(held.get("row" if down else "col", ""), MAX_ROW if down else MAX_COLUMN)
    into = held.get("rowOff" if down else "colOff", "0").strip()
    if at is None:
        return None
    return at + 1, int(into) if into.lstrip("-").isdigit() and len(into) < 15 else 0


def _last(first: tuple[int, int], size: str | None, cells: SheetPart, down: bool) -> int:
    """Row or column in which something ends that begins there and has a size. [EMU]"""
    at, into = _walk(first[0], first[1] + (whole_number(size or "", 10**12) or 0), cells, down)
    return at if into > _EDGE else at - 1


def _walk(at: int, left: int, cells: SheetPart, down: bool) -> tuple[int, int]:
    most = MAX_ROW if down else MAX_COLUMN
    for _ in range(20_000):
        extent = _extent(cells, at, down)
        if left < extent or at >= most:
            break
        left -= extent
        at += 1
    return at, left


def _extent(cells: SheetPart, at: int, down: bool) -> int:
    """Height of a row or width of a column. [EMU]"""
    if down:
        return round(cells.row_height(at) * _EMU_PER_POINT)
    width = cells.column_width(at)
    return round((width * _PIXELS_PER_CHARACTER + _PADDING) * _EMU_PER_PIXEL) if width else 0


def _of_legacy(data: bytes, cells: SheetPart) -> Iterator[LyingOver]:
    """Controls and comments that are always open, of the older kind of drawing."""
    try:
        root = parse_part(data, "drawing")
    except Exception:  # noqa: BLE001 - such drawings are often no XML, and programs read them all the same
        return
    for entry in root.iter():
        if _name(entry) != "ClientData":
            continue
        held = {_name(one): one.text or "" for one in entry}
        is_note = entry.get("ObjectType") == "Note"
        if is_note and "Visible" not in held:
            continue
        numbers = [part.strip() for part in held.get("Anchor", "").split(",")]
        if len(numbers) == 8 and all(part.isdigit() for part in numbers):
            left, _, top, _, right, over, bottom, below = map(int, numbers)
            edge = _EDGE // _EMU_PER_PIXEL
            rect = (top + 1, left + 1, bottom + (below > edge), right + (over > edge))
        else:
            rect = _by_style(entry.getparent(), cells)
        if rect[2] >= rect[0] and rect[3] >= rect[1]:
            yield LyingOver("an open comment" if is_note else "a control", "", Rect(*rect))


def _by_style(shape: Element | None, cells: SheetPart) -> tuple[int, int, int, int]:
    """First row and column, last row and column of an older shape that has no anchor, by its style in points."""
    style = "" if shape is None else shape.get("style", "")
    held = {name: float(number) for name, number in _IN_POINTS.findall(style)}
    down, across = (
        _walk(1, round(_EMU_PER_POINT * held.get(f"margin-{side}", 0.0)), cells, side == "top")
        for side in ("top", "left")
    )
    height, width = (
        str(round(_EMU_PER_POINT * held.get(size, 0.0))) for size in ("height", "width")
    )
    return down[0], across[0], _last(down, height, cells, True), _last(across, width, cells, False)


def _name(element: Element) -> str:
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
