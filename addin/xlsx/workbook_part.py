"""The workbook part and what it leads to: content types, relationships, sheets, defined names.

Edits of these parts are made on bytes, so that everything else in them stays as it was.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from html import escape
from urllib.parse import unquote

from addin.xlsx.container import Container, shown_name
from addin.xlsx.errors import WorkbookRefused, damaged
from addin.xlsx.references import Rect, parse_range, split_sheet, whole_number
from addin.xlsx.strict import STRICT_HOST
from addin.xlsx.xml_part import (
    CONTENT_TYPES,
    RELATIONSHIP_IDS,
    Element,
    has_misleading_tags,
    main,
    parse_part,
)

CONTENT_TYPES_PART = "[Content_Types].xml"
XLSX_TYPE = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"
XLSM_TYPE = "application/vnd.ms-excel.sheet.macroEnabled.main+xml"
_BINARY_TYPE = "application/vnd.ms-excel.sheet.binary.macroEnabled.main"
_TEMPLATE_TYPES = (
    "application/vnd.openxmlformats-officedocument.spreadsheetml.template.main+xml",
    "application/vnd.ms-excel.template.macroEnabled.main+xml",
)
_CALC_PR = re.compile(rb"<((?:\w+:)?)calcPr\b([^<>]*?)(/?)>")
_NO_TAGS = re.compile(rb"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>", re.DOTALL)
#: Attributes and text of the name of a print area.
_PRINT_AREA = re.compile(
    rb"""<(?:\w+:)?definedName\b([^<>]*\bname\s*=\s*["']_xlnm\.Print_Area["'][^<>]*)>([^<]*)<"""
)
_LOCAL_SHEET = re.compile(rb"""\blocalSheetId\s*=\s*["'](\d+)["']""")
_FULL_CALC = re.compile(rb"""\s*fullCalcOnLoad\s*=\s*(?:"[^"]*"|'[^']*')""")


#: Folder of digital signatures in a package.
SIGNATURES = "_xmlsignatures/"


@dataclass(frozen=True)
class Relationship:
    """A relationship inside the package: its id, the last word of its type, and the part it leads to."""

    id: str
    kind: str
    part: str


@dataclass(frozen=True)
class DefinedName:
    """A defined name."""

    name: str  #: The name.
    text: str  #: What it stands for, as written.
    local_sheet: str = ""  #: Sheet to which it is confined; empty for the whole workbook.
    #: Sheet of the cells it stands for; None when it stands for a formula, a constant or several
    #: areas.
    sheet: str | None = None
    rect: Rect | None = None  #: These cells.

    @property
    def ref(self) -> str | None:
        """The cells as ``"B4"`` or ``"B4:D9"``."""
        return None if self.rect is None else str(self.rect)


class WorkbookPart:
    """Structure of a workbook.

    Parameters
    ----------
    container : Container
        The package.

    Raises
    ------
    WorkbookRefused
        For packages that are not .xlsx or .xlsm workbooks.
    """

    def __init__(self, container: Container) -> None:
        self._container = container
        self._related: dict[str, list[Relationship]] = {}
        if container.find(CONTENT_TYPES_PART) is None:
            raise self._refused(
                "not a workbook", "is a zip file but not an Excel workbook (.xlsx or .xlsm)"
            )
        types = container.tree(container.find(CONTENT_TYPES_PART) or CONTENT_TYPES_PART)
        self._types = {
            entry.get("PartName", "").lstrip("/").lower(): entry.get("ContentType", "")
            for entry in types.iter(f"{{{CONTENT_TYPES}}}Override")
        }
        self._types_of_endings = {
            entry.get("Extension", "").lower(): entry.get("ContentType", "")
            for entry in types.iter(f"{{{CONTENT_TYPES}}}Default")
        }
        self.part = self._main_part()
        self.content_type = self.type_of(self.part)
        self._check_kind()
        self._relationships = {one.id: one for one in self.relationships(self.part)}
        root = parse_part(container.charged_beside_cells(self.part), self.part)
        if root.tag != main("workbook"):
            raise self._refused("not a workbook", "has an invalid workbook part")
        #: Sheets that nobody sees until they are unhidden, and how they are hidden: ``hidden`` or ``veryHidden``.
        self.hidden_sheets: dict[str, str] = {
            entry.get("name", ""): state
            for entry in root.iterfind(f"{main('sheets')}/{main('sheet')}")
            if (state := entry.get("state", "visible")) != "visible"
        }
        settings = root.find(main("calcPr"))
        #: How its program calculates: attributes of the file, such as ``calcMode``.
        self.calculation: dict[str, str] = {} if settings is None else dict(settings.attrib)
        self._sheet_parts = self._find_sheets(root)
        self.names = self._find_names(root)

    @property
    def sheet_names(self) -> list[str]:
        """Names of all sheets in order, chart sheets included."""
        return list(self._sheet_parts)

    def type_of(self, part: str) -> str:
        """Content type of a part: its own, else that of its ending; empty where the package states neither."""
        own = self._types.get(part.lower())
        ending = posixpath.splitext(part)[1].lstrip(".").lower()
        return self._types_of_endings.get(ending, "") if own is None else own

    def worksheet_part(self, sheet: str) -> str | None:
        """Part of a worksheet; None for chart sheets, sheets of modules and others without cells."""
        relationship = self._sheet_parts[sheet]
        return relationship.part if relationship.kind == "worksheet" else None

    def related(self, kind: str) -> str | None:
        """Part to which the workbook part leads by a relationship of that kind."""
        return next((one.part for one in self._relationships.values() if one.kind == kind), None)

    def relationships(self, part: str) -> list[Relationship]:
        """Relationships of a part that stay inside the package."""
        if part not in self._related:
            self._related[part] = self._read_relationships(part)
        return self._related[part]

    def _read_relationships(self, part: str) -> list[Relationship]:
        holder = relationships_part(part)
        stored = self._container.find(holder)
        if stored is None:
            return []
        found = []
        for entry in self._container.tree(stored):
            if not isinstance(entry.tag, str) or entry.get("TargetMode") == "External":
                continue
            target = unquote(entry.get("Target", ""))
            folder = "" if target.startswith("/") else posixpath.dirname(part)
            name = posixpath.normpath(posixpath.join(folder, target.lstrip("/")))
            kind = entry.get("Type", "").rpartition("/")[2]
            found.append(
                Relationship(entry.get("Id", ""), kind, self._container.find(name) or name)
            )
        return found

    def chart_parts(self) -> list[str]:
        """All chart parts, wherever they hang."""
        wanted = "application/vnd.openxmlformats-officedocument.drawingml.chart+xml"
        stated = [
            self._container.find(part) for part, kind in self._types.items() if kind == wanted
        ]
        found = [part for part in stated if part is not None]
        if wanted in self._types_of_endings.values():
            found += [
                part
                for part in self._container.names
                if part not in found and self.type_of(part) == wanted
            ]
        return found

    def is_signed(self) -> bool:
        """Whether the package carries a digital signature, which any edit would break."""
        return any(name.lower().startswith(SIGNATURES) for name in self._container.names)

    def with_print_areas(self, areas: Mapping[str, str]) -> bytes:
        """The workbook part with other print areas of sheets that have one, by the names of the sheets."""
        data = self._container.read(self.part)
        numbers = {str(self.sheet_names.index(sheet)): text for sheet, text in areas.items()}
        kept, position = bytearray(), 0
        for found in _PRINT_AREA.finditer(_masked(data)):
            local = _LOCAL_SHEET.search(found[1])
            text = numbers.get(local[1].decode()) if local else None
            if text is not None:
                kept += data[position : found.start(2)] + escape(text, quote=False).encode()
                position = found.end(2)
        return bytes(kept) + data[position:]

    def with_full_calculation(self, data: bytes) -> bytes:
        """The workbook part asking for a full calculation when it is opened."""
        found = _CALC_PR.search(_masked(data))
        if found is not None:
            attributes = _FULL_CALC.sub(b"", found[2]).rstrip()
            start = b'<%scalcPr%s fullCalcOnLoad="1"%s>' % (found[1], attributes, found[3])
            return data[: found.start()] + start + data[found.end() :]
        # calcPr follows these in the schema; the last one present tells the place.
        for tag in (rb"definedNames", rb"externalReferences", rb"functionGroups", rb"sheets"):
            last = _end_of_element(data, tag)
            if last is not None:
                position, prefix = last
                return (
                    data[:position] + b'<%scalcPr fullCalcOnLoad="1"/>' % prefix + data[position:]
                )
        raise self._refused("damaged", "has a workbook part without sheets")

    def without_calc_chain(self) -> tuple[dict[str, bytes], set[str]]:
        """Parts to replace and to drop so that the package has no calculation chain."""
        chain = self.related("calcChain")
        if chain is None:
            return {}, set()
        holder = self._container.find(relationships_part(self.part)) or ""
        types = self._container.find(CONTENT_TYPES_PART) or CONTENT_TYPES_PART
        replaced = {
            holder: _without_element(
                self._container.read(holder), rb"Relationship", rb"/calcChain[\"']"
            ),
            types: _without_element(
                self._container.read(types),
                rb"Override",
                rb"[\"']/?" + re.escape(chain).encode() + rb"[\"']",
            ),
        }
        return replaced, {chain}

    def without_relationships(
        self, part: str, targets: Collection[str]
    ) -> tuple[set[str], dict[str, bytes]]:
        """The relationships of a part that do not lead to some other parts."""
        ids = {one.id for one in self.relationships(part) if one.part in targets}
        holder = self._container.find(relationships_part(part))
        if holder is None or not ids:
            return ids, {}
        data = self._container.read(holder)
        return ids, {holder: _without_element(data, rb"Relationship", rb"\bId=" + _quoted(ids))}

    def as_plain_workbook(self, *, without: Collection[str] = ()) -> dict[str, bytes]:
        """Content types of the package declared as .xlsx, for readers that know no macros, without some parts."""
        part = self._container.find(CONTENT_TYPES_PART) or CONTENT_TYPES_PART
        data = self._container.read(part)
        if without:
            data = _without_element(data, rb"Override", rb"PartName=" + _quoted(without, rb"/?"))
        return {part: data.replace(XLSM_TYPE.encode(), XLSX_TYPE.encode())}

    def _main_part(self) -> str:
        for relationship in self.relationships(""):
            if relationship.kind == "officeDocument":
                if self._container.find(relationship.part) is None:
                    break
                return relationship.part
        raise self._refused(
            "not a workbook", "is a zip file but not an Excel workbook (.xlsx or .xlsm)"
        )

    def _check_kind(self) -> None:
        if self.content_type == _BINARY_TYPE or self.part.lower().endswith(".bin"):
            raise self._refused(
                "xlsb",
                "is in the binary .xlsb format. Save it as Excel workbook (.xlsx or .xlsm) and run again",
            )
        if self.content_type in _TEMPLATE_TYPES:
            raise self._refused(
                "template",
                "is an Excel template. Save it as Excel workbook (.xlsx or .xlsm) and run again",
            )
        if STRICT_HOST in self._container.read(self.part)[:4000]:
            self._container.take_ordinary_dialect(self.part)
        if self.content_type not in (XLSX_TYPE, XLSM_TYPE):
            raise self._refused(
                "not a workbook", "is an Office file but not an Excel workbook (.xlsx or .xlsm)"
            )

    def _find_sheets(self, root: Element) -> dict[str, Relationship]:
        sheets: dict[str, Relationship] = {}
        seen: set[str] = set()
        for entry in root.iterfind(f"{main('sheets')}/{main('sheet')}"):
            name = entry.get("name", "")
            named = entry.get(f"{{{RELATIONSHIP_IDS}}}id")
            # Macro modules of Excel 95 are sheets without a part.
            relationship = self._relationships.get(named) if named else _no_part(name)
            if relationship is None or (named and self._container.find(relationship.part) is None):
                raise self._refused("damaged", f"lacks the part of sheet {shown_name(name)}")
            if not name or name.casefold() in seen or relationship.part in seen:
                raise damaged(
                    f"{self._container.path.name} has two sheets of the same name, or one without a name "
                    f"({shown_name(name)})."
                )
            seen.update((name.casefold(), relationship.part))
            sheets[name] = relationship
        return sheets

    def _find_names(self, root: Element) -> list[DefinedName]:
        names = []
        sheets = self.sheet_names
        for entry in root.iterfind(f"{main('definedNames')}/{main('definedName')}"):
            local = whole_number(entry.get("localSheetId"), len(sheets) - 1)
            if local is None and entry.get("localSheetId") is not None:
                continue  # a sheet that is not there: no formula can mean this name
            confined = "" if local is None else sheets[local]
            names.append(
                _defined_name(entry.get("name", ""), (entry.text or "").strip(), confined, sheets)
            )
        return names

    def _refused(self, reason: str, what: str) -> WorkbookRefused:
        return WorkbookRefused(reason, f"{self._container.path.name} {what}.")


def _no_part(sheet: str) -> Relationship:
    # A name that no part can have: each sheet has its own, and none is found under it.
    return Relationship("", "none", f"//{sheet}")


def relationships_part(part: str) -> str:
    """Name of the part that holds the relationships of a part."""
    folder, name = posixpath.split(part)
    return posixpath.join(folder, "_rels", f"{name}.rels")


def _defined_name(name: str, text: str, local_sheet: str, sheets: list[str]) -> DefinedName:
    sheet, rest = split_sheet(text)
    if sheet in sheets:
        try:
            return DefinedName(name, text, local_sheet, sheet, parse_range(rest))
        except ValueError:
            pass
    return DefinedName(name, text, local_sheet)


def _masked(data: bytes) -> bytes:
    """The part with blanks for its comments and the like, in which tags are no tags; places stay the same."""
    if not has_misleading_tags(data):
        return data
    return _NO_TAGS.sub(lambda found: b" " * len(found[0]), data)


def _end_of_element(data: bytes, tag: bytes) -> tuple[int, bytes] | None:
    """Position behind the last such element and its namespace prefix."""
    pattern = rb"</((?:\w+:)?)" + tag + rb"\s*>|<((?:\w+:)?)" + tag + rb"\b[^<>]*/>"
    found = list(re.finditer(pattern, _masked(data)))
    return (found[-1].end(), found[-1][1] or found[-1][2] or b"") if found else None


def _quoted(words: Collection[str], before: bytes = b"") -> bytes:
    """Pattern of an attribute that is one of some words."""
    either = b"|".join(re.escape(word).encode() for word in sorted(words))
    return rb"[\"']" + before + b"(?:" + either + rb")[\"']"


def _without_element(data: bytes, tag: bytes, mark: bytes) -> bytes:
    """The part without its empty element of that tag whose attributes match the mark."""
    pattern = re.compile(
        rb"<(?:\w+:)?"
        + tag
        + rb"\b[^<>]*?"
        + mark
        + rb"[^<>]*?(?:/>|>\s*</(?:\w+:)?"
        + tag
        + rb"\s*>)",
        re.IGNORECASE,
    )
    kept, position = bytearray(), 0
    for found in pattern.finditer(_masked(data)):
        kept += data[position : found.start()]
        position = found.end()
    return bytes(kept) + data[position:]
