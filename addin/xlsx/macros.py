"""A VBA project and a hidden sheet of settings into a workbook.

An .xlsx becomes an .xlsm. Three parts that list others are edited on their bytes (content types,
relationships, workbook); the project and the sheet are new parts, or take the place of those that
are there. Every other part stays as it is stored, the sheets included: Excel makes the modules of
sheets that have none when it loads the project.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from addin.xlsx.errors import WorkbookRefused, damaged
from addin.xlsx.formulas import CacheReport
from addin.xlsx.save import Destination, PackageChange, SaveReport, save_package
from addin.xlsx.state import in_any_capitals
from addin.xlsx.values import rows_xml
from addin.xlsx.workbook import Workbook
from addin.xlsx.workbook_part import CONTENT_TYPES_PART, XLSM_TYPE, XLSX_TYPE, relationships_part
from addin.xlsx.xml_part import DRAWING, MAIN, RELATIONSHIP_IDS

_PROJECT_KIND = "http://schemas.microsoft.com/office/2006/relationships/vbaProject"
_SHEET_KIND = "http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet"
_PROJECT_TYPE = "application/vnd.ms-office.vbaProject"
_SHEET_TYPE = "application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"
_DRAWING = "http://schemas.openxmlformats.org/drawingml/2006/spreadsheetDrawing"
#: Length units of drawings in a point; distance of a button from the edges of its cells.
_EMU, _GAP = 12_700, 38_100
#: Name of the workbook in its VBA project.
_CODE_NAME = "ThisWorkbook"
_DECLARATION = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
_WORKBOOK_PR = re.compile(rb"<((?:\w+:)?)workbookPr\b([^>]*?)(/?)>")
_CODE_NAME_OF = re.compile(rb"""\s*\bcodeName\s*=\s*(?:"[^"]*"|'[^']*')""")
_SHEET_CODE_NAME = re.compile(rb"""<(?:\w+:)?sheetPr\b[^>]*?\bcodeName\s*=\s*["']([^"']*)["']""")

Setting = str | bool


@dataclass(frozen=True)
class Button:
    """A button on a sheet, drawn into the drawing that is there; it is not printed."""

    sheet: str  #: Its sheet.
    macro: str  #: What it runs.
    words: str  #: What stands on it.
    row: int  #: Its row, its first and last column, counted from 1.
    first: int  #: Likewise.
    last: int  #: Likewise.
    height: float  #: From a little below the top of the row. [point]
    colour: str  #: Of words and edge. [RRGGBB]


@dataclass(frozen=True)
class MacroEdit:
    """What a workbook gets."""

    project: bytes  #: The part ``vbaProject.bin``.
    sheet: str  #: Name of the sheet of settings.
    settings: Mapping[str, Setting]  #: Its rows: name and value.
    #: For a macro; a workbook without that sheet, or with no drawing on it, gets none.
    button: Button | None = None


def macro_project(workbook: Workbook) -> bytes | None:
    """The VBA project of a workbook.

    Returns
    -------
    bytes or None
        The part; None if it has none.
    """
    part = _project_part(workbook)
    return None if part is None else workbook.container.read(part)


def settings_of(workbook: Workbook, sheet: str) -> dict[str, Setting] | None:
    """Rows of a sheet of settings.

    Returns
    -------
    dict of str to (str or bool) or None
        From the first row to the first without a name; None if there is no such sheet.
    """
    stored = in_any_capitals({name: name for name in workbook.sheet_names}, sheet)
    if stored is None:
        return None
    settings: dict[str, Setting] = {}
    for row in count(1):
        name, value = (workbook.shown_value(stored, f"{column}{row}") for column in "AB")
        if not (isinstance(name, str) and name):
            break
        settings[name] = value if isinstance(value, bool) else str("" if value is None else value)
    return settings


def save_with_macros(
    workbook: Workbook,
    edit: MacroEdit,
    destination: Path | None,
    *,
    in_place: bool = False,
    ignore_lock: bool = False,
) -> SaveReport:
    """Write the workbook with a VBA project and a very hidden sheet of settings.

    Parameters
    ----------
    workbook : Workbook
        As opened; changes of cells are not written by this.
    edit : MacroEdit
        What it gets.
    destination : Path or None
        The new .xlsm; None with `in_place`.
    in_place : bool
        Replace the file, which must be an .xlsm; its old content stays as ``name.bak``, or as
        ``name.bak2`` and so on where there is one.
    ignore_lock : bool
        Write although a lock file says that somebody has it open.

    Raises
    ------
    WorkbookRefused
        If its macros are signed.
    SaveRefused
        With the reason; nothing was written.
    """
    if any("vbaprojectsignature" in part.lower() for part in workbook.container.names):
        raise WorkbookRefused(
            "signed macros",
            f"The macros of {workbook.path.name} have a digital signature, which any change would "
            "invalidate. Remove it in the VBA editor (Tools, Digital Signature).",
        )
    writer = _Writer(workbook)
    writer.put_project(edit.project)
    writer.put_sheet(edit.sheet, edit.settings)
    if edit.button is not None:
        writer.put_button(edit.button)
    return save_package(
        workbook.container,
        PackageChange(writer.replaced, added=writer.added),
        Destination(
            destination,
            in_place,
            ignore_lock=ignore_lock,
            suffix=".xlsm",
            keep_backups=True,  # the first is the workbook as the user had it
        ),
        check=lambda parts: [],
        caches=CacheReport("not needed"),
    )


class _Writer:
    """Parts as they will be."""

    def __init__(self, workbook: Workbook) -> None:
        self._book = workbook
        self._part = workbook.structure.part
        self._folder = posixpath.dirname(self._part)
        self.replaced: dict[str, bytes] = {}
        self.added: dict[str, bytes] = {}
        self._types = workbook.container.find(CONTENT_TYPES_PART) or CONTENT_TYPES_PART
        self._relations = (
            workbook.container.find(relationships_part(self._part))
            or relationships_part(self._part)
        )  # fmt: skip

    def put_project(self, project: bytes) -> None:
        there = _project_part(self._book)
        if there is not None:
            self.replaced[there] = project
            return
        part = posixpath.join(self._folder, "vbaProject.bin")
        self.added[part] = project
        self._edit(self._types, lambda d: d.replace(XLSX_TYPE.encode(), XLSM_TYPE.encode()))
        self._list(part, _PROJECT_TYPE)
        self._relate(part, _PROJECT_KIND)
        self._edit(self._part, _with_code_name)

    def put_sheet(self, name: str, settings: Mapping[str, Setting]) -> None:
        structure = self._book.structure
        known = in_any_capitals({one: one for one in structure.sheet_names}, name)
        if known is not None:
            there = structure.worksheet_part(known)
            assert there is not None, f"{name} is a chart sheet"
            found = _SHEET_CODE_NAME.search(self._book.container.read(there))
            self.replaced[there] = _sheet(settings, found[1].decode() if found else "")
            return
        part = self._free_part()
        self.added[part] = _sheet(settings, "")
        self._list(part, _SHEET_TYPE)
        relation = self._relate(part, _SHEET_KIND)
        data = self._read(self._part)
        ids = [int(i) for i in re.findall(rb"\bsheetId\s*=\s*[\"'](\d+)", data)]
        entry = (
            f"sheet name={quoteattr(name)} sheetId={quoteattr(str(max(ids) + 1))} "
            f'state="veryHidden" xmlns:r="{RELATIONSHIP_IDS}" r:id={quoteattr(relation)}/>'
        )
        self._edit(self._part, lambda d: _before_end(d, rb"sheets", entry))

    def put_button(self, button: Button) -> None:
        structure = self._book.structure
        there = button.sheet in structure.sheet_names
        sheet = structure.worksheet_part(button.sheet) if there else None
        related = structure.relationships(sheet) if sheet else []
        drawing = next((one.part for one in related if one.kind == "drawing"), None)
        if drawing is not None:
            ids = re.findall(rb"\bcNvPr\b[^>]*?\bid=\"(\d+)\"", self._read(drawing))
            entry = _shape(button, max(map(int, ids), default=1) + 1)
            self._edit(drawing, lambda d: _before_end(d, rb"wsDr", entry, prefix=False))

    # ---- lists ---------------------------------------------------------------------------------

    def _list(self, part: str, kind: str) -> None:
        entry = f'Override PartName="/{part}" ContentType="{kind}"/>'
        self._edit(self._types, lambda d: _before_end(d, rb"Types", entry))

    def _relate(self, part: str, kind: str) -> str:
        used = re.findall(rb"\bId\s*=\s*[\"']([^\"']*)", self._read(self._relations))
        numbered = (f"rId{number}" for number in count(len(used) + 1))
        relation = next(one for one in numbered if one.encode() not in used)
        entry = (
            f'Relationship Id="{relation}" Type="{kind}" '
            f'Target="{posixpath.relpath(part, self._folder)}"/>'
        )
        self._edit(self._relations, lambda d: _before_end(d, rb"Relationships", entry))
        return relation

    def _free_part(self) -> str:
        taken = {name.lower() for name in self._book.container.names}
        folder = posixpath.join(self._folder, "worksheets")
        parts = (f"{folder}/sheet{number}.xml" for number in count(len(self._book.sheet_names) + 1))
        return next(part for part in parts if part.lower() not in taken)

    def _read(self, part: str) -> bytes:
        return self.replaced.get(part) or self._book.container.read(part)

    def _edit(self, part: str, change: Callable[[bytes], bytes]) -> None:
        self.replaced[part] = change(self._read(part))


def _project_part(workbook: Workbook) -> str | None:
    part = workbook.structure.related("vbaProject")
    return None if part is None else workbook.container.find(part)


def _before_end(data: bytes, tag: bytes, entry: str, *, prefix: bool = True) -> bytes:
    """An element put in as the last one of another, under its namespace prefix or its own."""
    ends = list(re.finditer(rb"</((?:\w+:)?)" + tag + rb"\s*>", data))
    if not ends:
        raise damaged(f"The workbook has an empty list of {tag.decode()}.")
    end = ends[-1]
    name = end[1] if prefix else b""
    return data[: end.start()] + b"<" + name + entry.encode() + data[end.start() :]


def _with_code_name(data: bytes) -> bytes:
    """The workbook part under the name that its VBA project gives it."""
    name = b' codeName="' + _CODE_NAME.encode() + b'"'
    found = _WORKBOOK_PR.search(data)
    if found is not None:
        others = _CODE_NAME_OF.sub(b"", found[2])
        new = b"<" + found[1] + b"workbookPr" + name + others + found[3] + b">"
        return data[: found.start()] + new + data[found.end() :]
    # Of what may come behind it in the schema, a workbook has views or sheets at least.
    after = re.search(rb"<((?:\w+:)?)(?:workbookProtection|bookViews|sheets)\b", data)
    assert after is not None, "a workbook part has sheets"
    new = b"<" + after[1] + b"workbookPr" + name + b"/>"
    return data[: after.start()] + new + data[after.start() :]


def _shape(button: Button, number: int) -> str:
    """A rounded rectangle that runs a macro; the first ``<`` is the caller's."""
    name, macro = quoteattr(button.words), quoteattr(f"[0]!{button.macro}")
    fill = '<a:solidFill><a:srgbClr val="{}"/></a:solidFill>'
    row, bottom = button.row - 1, _GAP + round(button.height * _EMU)
    return (
        f'd:twoCellAnchor xmlns:d="{_DRAWING}" xmlns:a="{DRAWING}" editAs="oneCell">'
        f"<d:from><d:col>{button.first - 1}</d:col><d:colOff>{_GAP}</d:colOff>"
        f"<d:row>{row}</d:row><d:rowOff>{_GAP}</d:rowOff></d:from>"
        f"<d:to><d:col>{button.last}</d:col><d:colOff>0</d:colOff>"
        f"<d:row>{row}</d:row><d:rowOff>{bottom}</d:rowOff></d:to>"
        f'<d:sp macro={macro} textlink=""><d:nvSpPr><d:cNvPr id="{number}" name={name}/>'
        '<d:cNvSpPr/></d:nvSpPr><d:spPr><a:xfrm><a:off x="0" y="0"/><a:ext cx="0" cy="0"/></a:xfrm>'
        '<a:prstGeom prst="roundRect"><a:avLst/></a:prstGeom>'
        f'{fill.format("FFFFFF")}<a:ln w="9525">{fill.format(button.colour)}</a:ln></d:spPr>'
        '<d:txBody><a:bodyPr wrap="square" lIns="0" tIns="0" rIns="0" bIns="0" anchor="ctr"/>'
        '<a:lstStyle/><a:p><a:pPr algn="ctr"/><a:r><a:rPr lang="en-US" sz="1000" b="1">'
        f'{fill.format(button.colour)}<a:latin typeface="Arial"/></a:rPr>'
        f"<a:t>{escape(button.words)}</a:t></a:r></a:p>"
        '</d:txBody></d:sp><d:clientData fPrintsWithSheet="0"/></d:twoCellAnchor>'
    )


def _sheet(settings: Mapping[str, Setting], code_name: str) -> bytes:
    """A sheet of names and values, in need of no other part."""
    code = f"<sheetPr codeName={quoteattr(code_name)}/>" if code_name else ""
    starts, no_styles = ('<c r="A', '<c r="B'), (None, None)
    named = [(name, None if value == "" else value) for name, value in settings.items()]
    texts, _ = rows_xml(1, starts, [no_styles] * len(named), named)
    rows = "".join(f'<row r="{i}">{text}</row>' for i, text in enumerate(texts, start=1))
    return (
        f'{_DECLARATION}<worksheet xmlns="{MAIN}">{code}'
        f'<dimension ref="A1:B{len(settings)}"/><sheetData>{rows}</sheetData></worksheet>'
    ).encode()
