"""Whole sheets of another workbook behind those of a workbook, with their looks, drawings, tables and names.

For sheets that a script made with openpyxl, and for those of a study. Only the parts that list sheets, parts, names and
styles change; all others stay byte for byte. Cells keep their looks through styles that are added to those of the
workbook; shared texts become texts of the cells; formulas stay as they are written.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from functools import cached_property
from itertools import chain, count
from pathlib import Path

from lxml import etree

from addin.xlsx.cell_looks import BUILT_IN
from addin.xlsx.errors import damaged
from addin.xlsx.formula_text import Span, TableReference, parse_formula
from addin.xlsx.formulas import CacheReport
from addin.xlsx.references import split_sheet, whole_number
from addin.xlsx.save import Destination, PackageChange, SaveReport, save_package
from addin.xlsx.state import WorkbookState
from addin.xlsx.workbook_part import CONTENT_TYPES_PART, relationships_part
from addin.xlsx.xml_part import (
    CONTENT_TYPES,
    RELATIONSHIP_IDS,
    RELATIONSHIPS,
    Element,
    main,
    parse_part,
    serialise,
)

#: First number of a number format that a workbook brings itself; smaller ones are built in.
_OWN_FORMATS = 164
_STYLES_KIND = "application/vnd.openxmlformats-officedocument.spreadsheetml.styles+xml"
#: What Excel begins with, for a workbook that has none.
_NO_STYLES = (
    b'<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
    b'<styleSheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">'
    b'<fonts count="1"><font><sz val="11"/><name val="Calibri"/><family val="2"/></font></fonts>'
    b'<fills count="2"><fill><patternFill patternType="none"/></fill>'
    b'<fill><patternFill patternType="gray125"/></fill></fills>'
    b'<borders count="1"><border><left/><right/><top/><bottom/><diagonal/></border></borders>'
    b'<cellStyleXfs count="1"><xf numFmtId="0" fontId="0" fillId="0" borderId="0"/></cellStyleXfs>'
    b'<cellXfs count="1"><xf numFmtId="0" fontId="0" fillId="0" borderId="0" xfId="0"/></cellXfs>'
    b'<cellStyles count="1"><cellStyle name="Normal" xfId="0" builtinId="0"/></cellStyles>'
    b'<dxfs count="1"><dxf/></dxfs></styleSheet>'
)
_STYLE_NUMBERS = re.compile(rb'\s(?:s|style)="(\d{1,5})"')
_RULE_NUMBERS = re.compile(rb'\sdxfId="(\d{1,5})"')
_MOST_STYLES = 65_430  # of Excel
_ID = f"{{{RELATIONSHIP_IDS}}}id"
#: Lists of a workbook in their order.
_LISTS = (
    "sheets", "functionGroups", "externalReferences", "definedNames", "calcPr", "oleSize", "customWorkbookViews",
    "pivotCaches", "smartTagPr", "smartTagTypes", "webPublishing", "fileRecoveryPr", "webPublishObjects", "extLst",
)  # fmt: skip
#: Beginnings of the kinds of relationships by which a workbook has what its cells and comments refer to by number:
#: dynamic arrays, pictures in cells, linked data types, and persons.
_REFERRED_TO = ("sheetMetadata", "rd", "rich", "person")
_REFERS_TO_METADATA = re.compile(rb"""<(?:\w+:)?c\s[^>]*\b[cv]m=["']""")
#: Where the parts of a style are listed, and the attribute by which a style refers to each.
_STYLE_LISTS = {"fonts": "fontId", "fills": "fillId", "borders": "borderId"}


#: A cell of another sheet in a formula: the sheet as it is written there, and the cell.
_CELL_ELSEWHERE = re.compile(r"('(?:[^']|'')+'|[A-Za-z_][\w.]*)!(\$[A-Z]{1,3}\$\d+)(?![\d:])")


def what_is_in_the_way(
    workbook: WorkbookState, source: WorkbookState, sheets: Sequence[str]
) -> Iterator[str]:
    """Why sheets of another workbook cannot stand in a workbook as they are.

    Parameters
    ----------
    workbook : WorkbookState
        The workbook.
    source : WorkbookState
        Where the sheets come from.
    sheets : sequence of str
        Their names. [names]

    Yields
    ------
    str
        A sentence for each thing to do first.
    """
    root = workbook.container.tree(workbook.structure.part)
    protection = root.find(main("workbookProtection"))
    if protection is not None and protection.get("lockStructure") in ("1", "true"):
        yield (
            f"the structure of {workbook.path.name} is protected, so no sheet can be added. Take the protection away "
            "(Review, Protect Workbook)"
        )
    here = {name.casefold() for name in workbook.structure.sheet_names}
    for sheet in sheets:
        if sheet.casefold() in here:
            yield f"there is a sheet {sheet} of your own. Give it another name"
    tables = {name.casefold() for name in workbook.tables}
    names = {one.name.casefold() for one in workbook.structure.names if not one.local_sheet}
    for table in source.tables.values():
        if table.sheet not in sheets:
            continue
        if table.name.casefold() in tables:
            yield f"there is a table {table.name} of your own. Give it another name"
        elif table.name.casefold() in names:
            yield f"there is a defined name {table.name} of your own. Give it another name"
    for one in source.structure.names:
        if one.local_sheet or one.sheet not in sheets:
            continue
        if one.name.casefold() in names or one.name.casefold() in tables:
            yield f"there is a name {one.name} of your own. Give it another name"


def save_with_sheets(
    workbook: WorkbookState,
    source: WorkbookState,
    sheets: Sequence[str],
    destination: Path,
    references: Mapping[tuple[str, str], str] | None = None,
) -> SaveReport:
    """Write a workbook with sheets of another one behind its own.

    Parameters
    ----------
    workbook : WorkbookState
        As opened; changes of its cells are not written by this.
    source : WorkbookState
        Where the sheets come from.
    sheets : sequence of str
        Their names, none of which the workbook has. [names]
    destination : Path
        The new file. [path]
    references : mapping, optional
        What stands in formulas for a cell of a sheet that is not taken over, by sheet and cell (``$B$9``); any
        other reference stays as it is. [text of formulas]

    Returns
    -------
    SaveReport
        Its notes say what could not be taken over.
    """
    merger = _Merger(workbook, source, references or {})
    for name in sheets:
        merger.add(name)
    merger.add_names(sheets)
    merger.add_what_sheets_refer_to(sheets)
    return save_package(
        workbook.container,
        PackageChange(merger.replaced(), merger.dropped, merger.added),
        Destination(destination, False),
        check=lambda parts: [],
        caches=CacheReport("not needed"),
        notes=tuple(merger.notes),
    )


class _Merger:
    """Parts of the new file as they come about."""

    def __init__(
        self,
        workbook: WorkbookState,
        source: WorkbookState,
        references: Mapping[tuple[str, str], str],
    ) -> None:
        self._book, self._from = workbook, source
        self._references = references
        self.notes: list[str] = []
        self.added: dict[str, bytes] = {}
        self._copied: dict[str, str] = {}
        self._taken = {name.lower() for name in workbook.container.names}
        structure = workbook.structure
        self._roots = {
            part: parse_part(workbook.container.read(part), part)
            for part in (structure.part, self._types, self._relations)
        }
        styles = structure.related("styles")
        if styles is None or workbook.container.find(styles) is None:
            styles = self._new_styles(styles)  # a workbook whose cells have no looks needs none
        else:
            self._roots[styles] = parse_part(workbook.container.read(styles), styles)
        self._looks = _Looks(self._roots[styles], self._styles_of_source())
        self.dropped = self._without_calc_chain()
        self._tables = {name.casefold() for name in workbook.tables}
        self._table_numbers = count(
            1
            + max((self._table_number(table.part) for table in workbook.tables.values()), default=0)
        )

    @property
    def _types(self) -> str:
        return self._book.container.find(CONTENT_TYPES_PART) or CONTENT_TYPES_PART

    @property
    def _relations(self) -> str:
        name = relationships_part(self._book.structure.part)
        return self._book.container.find(name) or name

    def _new_styles(self, named: str | None) -> str:
        """Styles for a workbook without; its lists may name a part that is not there."""
        usual = "xl/styles.xml"  # some readers look nowhere else
        part = named or (self._free(usual) if usual in self._taken else usual)
        self._roots[part] = root = parse_part(_NO_STYLES, part)
        # Cells and rules may still give numbers of looks that are lost; none may become that of a new cell.
        for listed, numbers in (
            (root.find(main("cellXfs")), _STYLE_NUMBERS),
            (root.find(main("dxfs")), _RULE_NUMBERS),
        ):
            for _ in range(len(listed), 1 + self._highest(numbers)):
                listed.append(deepcopy(listed[0]))
            listed.set("count", str(len(listed)))
        if named is None:
            self._relate(part, "styles")
        if self._book.structure.type_of(part) != _STYLES_KIND:
            self._state_kind(part, _STYLES_KIND)
        return part

    def _highest(self, numbers: re.Pattern[bytes]) -> int:
        """The highest number that the sheets of the workbook give in some attributes."""
        structure = self._book.structure
        parts = [structure.worksheet_part(sheet) for sheet in structure.sheet_names]
        texts = (self._book.container.read(part) for part in parts if part is not None)
        found = (int(number) for text in texts for number in numbers.findall(text))
        return max((number for number in found if number < _MOST_STYLES), default=0)

    def _state_kind(self, part: str, kind: str) -> None:
        """Say in the list of contents what a part is."""
        etree.SubElement(
            self._roots[self._types],
            f"{{{CONTENT_TYPES}}}Override",
            {"PartName": f"/{part}", "ContentType": kind},
        )

    def _styles_of_source(self) -> Element:
        part = self._from.structure.related("styles")
        if part is None:
            raise damaged(f"{self._from.path.name} has no styles.")
        return self._from.container.tree(part)

    def _table_number(self, part: str) -> int:
        return whole_number(self._book.container.tree(part).get("id")) or 0

    def _without_calc_chain(self) -> set[str]:
        """Take the order of calculation out of the lists: it knows no formula of the new sheets."""
        chain = self._book.structure.related("calcChain")
        if chain is None:
            return set()
        for entry in list(self._roots[self._relations]):
            if isinstance(entry.tag, str) and entry.get("Type", "").endswith("/calcChain"):
                self._roots[self._relations].remove(entry)
        for entry in list(self._roots[self._types]):
            if isinstance(entry.tag, str) and entry.get("PartName", "").lstrip("/") == chain:
                self._roots[self._types].remove(entry)
        return {chain}

    def replaced(self) -> dict[str, bytes]:
        """The parts of the workbook that list its sheets, parts and styles."""
        there = self._book.container
        replaced = {}
        for part, root in self._roots.items():
            if there.find(part):
                replaced[part] = serialise(root, there.read(part))
            else:
                self.added[part] = serialise(root, _NO_STYLES)
        return replaced

    # ---- sheets --------------------------------------------------------------------------------

    def add(self, name: str) -> None:
        """Put a sheet behind the others."""
        part = self._from.structure.worksheet_part(name)
        if part is None:
            self.notes.append(f"Sheet {name} is a chart or a macro module and is not taken over.")
            return
        book = self._roots[self._book.structure.part]
        sheets = book.find(main("sheets"))
        numbers = [whole_number(entry.get("sheetId")) or 0 for entry in sheets]
        relation = self._relate(self._copy(part), "worksheet")
        attributes = {"name": name, "sheetId": str(max(numbers, default=0) + 1)}
        if name in self._from.structure.hidden_sheets:
            attributes["state"] = self._from.structure.hidden_sheets[name]
        entry = etree.SubElement(sheets, main("sheet"), attributes)
        entry.set(_ID, relation)

    def _relate(self, part: str, kind: str, family: str = RELATIONSHIP_IDS) -> str:
        root = self._roots[self._relations]
        used = {entry.get("Id") for entry in root}
        relation = next(name for n in count(1) if (name := f"rId{n}") not in used)
        etree.SubElement(
            root,
            f"{{{RELATIONSHIPS}}}Relationship",
            {"Id": relation, "Type": f"{family}/{kind}", "Target": f"/{part}"},
        )
        return relation

    def _copy(self, part: str) -> str:
        """A part of the source, with all that it leads to, under a name that is free."""
        if part in self._copied:
            return self._copied[part]
        new = self._copied[part] = self._free(part)
        data = self._from.container.read(part)
        kind = self._kind(part)
        dropped: set[str] = set()
        relations = self._copied_relations(part, dropped)
        if kind.endswith("spreadsheetml.worksheet+xml"):
            data = self._sheet(part, dropped)
        elif kind.endswith("spreadsheetml.table+xml"):
            data = self._table(part)
        self.added[new] = data
        self._state_kind(new, kind)
        if relations is not None:
            self.added[relationships_part(new)] = relations
        return new

    def _free(self, part: str) -> str:
        stem, ending = posixpath.splitext(part)
        stem = stem.rstrip("0123456789")
        names = (f"{stem}{number}{ending}" for number in count(1))
        new = next(name for name in names if name.lower() not in self._taken)
        self._taken.add(new.lower())
        return new

    def _kind(self, part: str) -> str:
        """Content type of a part of the source, its own or that of its ending."""
        if kind := self._from.structure.type_of(part):
            return kind
        raise damaged(f"{self._from.path.name} does not say what its part {part} is.")

    def _copied_relations(self, part: str, dropped: set[str]) -> bytes | None:
        """The relationships of a part, led to the copies; None where it has none."""
        stored = self._from.container.find(relationships_part(part))
        if stored is None:
            return None
        root = deepcopy(self._from.container.tree(stored))
        inside = {one.id: one for one in self._from.structure.relationships(part)}
        for entry in list(root):
            related = inside.get(entry.get("Id"))
            if related is None:
                continue  # it leads out of the workbook
            if related.kind == "table" and not self._may_take(related.part):
                dropped.add(related.id)
                root.remove(entry)
            else:
                entry.set("Target", f"/{self._copy(related.part)}")
        return etree.tostring(root, xml_declaration=True, encoding="UTF-8", standalone=True)

    def _may_take(self, part: str) -> bool:
        """Whether a table has a name that the workbook has not."""
        name = str(self._from.container.tree(part).get("displayName"))
        if name.casefold() not in self._tables:
            self._tables.add(name.casefold())
            return True
        self.notes.append(
            f"Table {name} is on a sheet that was added, but the workbook has a table of that name: its cells were "
            "taken over without it. Give it another name."
        )
        return False

    def _table(self, part: str) -> bytes:
        root = deepcopy(self._from.container.tree(part))
        root.set("id", str(next(self._table_numbers)))
        for entry in root.iter():
            for name in ("dataDxfId", "headerRowDxfId", "totalsRowDxfId"):
                if entry.get(name):
                    entry.set(name, self._looks.difference(entry.get(name)))
        return etree.tostring(root, xml_declaration=True, encoding="UTF-8", standalone=True)

    def _sheet(self, part: str, dropped: set[str]) -> bytes:
        """A sheet with the numbers of the styles here, and with its texts in its cells."""
        root = deepcopy(self._from.container.tree(part))
        for view in root.iter(main("sheetView")):
            view.attrib.pop("tabSelected", None)
        for tag, attribute in (("c", "s"), ("row", "s"), ("col", "style")):
            for entry in root.iter(main(tag)):
                if entry.get(attribute):
                    entry.set(attribute, self._looks.style(entry.get(attribute)))
                elif tag == "c" and self._looks.plain_is_other:
                    entry.set(attribute, self._looks.style("0"))
        for rule in root.iter(main("cfRule")):
            if rule.get("dxfId"):
                rule.set("dxfId", self._looks.difference(rule.get("dxfId")))
        for cell in root.iter(main("c")):
            if cell.get("t") == "s":
                self._put_text(cell)
        if not self._takes_metadata:
            for cell in root.iter(main("c")):
                cell.attrib.pop("cm", None)
                cell.attrib.pop("vm", None)
        if self._references:
            for tag in ("f", "formula", "formula1", "formula2"):
                for formula in root.iter(main(tag)):
                    formula.text = self._led(formula.text)
            for link in root.iter(main("hyperlink")):
                if link.get("location"):
                    link.set("location", self._led(link.get("location")))
        for table in list(root.iter(main("tablePart"))):
            if table.get(_ID) in dropped:
                table.getparent().remove(table)
        return etree.tostring(root, xml_declaration=True, encoding="UTF-8", standalone=True)

    def _led(self, formula: str | None) -> str | None:
        """A formula with its references to cells elsewhere as they are in this workbook."""

        def reference(found: re.Match[str]) -> str:
            sheet = found[1].strip("'").replace("''", "'")
            return self._references.get((sheet, found[2]), found[0])

        return formula and _CELL_ELSEWHERE.sub(reference, formula)

    def _put_text(self, cell: Element) -> None:
        value = cell.find(main("v"))
        text = self._from.shared_texts.text(value.text or "")
        runs = self._from.shared_texts.runs(value.text or "")
        cell.remove(value)
        cell.set("t", "inlineStr")
        inside = etree.SubElement(cell, main("is"))
        if runs is not None:
            inside.extend(deepcopy(list(runs)))
        else:
            etree.SubElement(inside, main("t")).text = text

    # ---- names ---------------------------------------------------------------------------------

    def add_names(self, sheets: Sequence[str]) -> None:
        """Take over the names of the sheets, and those of the workbook that lead to them or to no other sheet."""
        root = self._roots[self._book.structure.part]
        listed = [entry.get("name") for entry in root.find(main("sheets"))]
        there = {name.casefold() for name in self._book.defined_names}
        for name in self._from.structure.names:
            local = name.local_sheet
            if local in sheets and local in listed:
                self._name(root, name.name, name.text, listed.index(local))
            elif not local and name.sheet in sheets:
                if name.name.casefold() in there:
                    self.notes.append(
                        f"The name {name.name} leads to sheet {name.sheet}, but the workbook has a name like it: it "
                        "was not taken over. Choose another one."
                    )
                else:
                    self._name(root, name.name, name.text, None)
            elif not local and name.sheet is None and name.name.casefold() not in there:
                if self._stands_alone(name.text, sheets):
                    self._name(root, name.name, name.text, None)

    def _stands_alone(self, text: str, sheets: Sequence[str]) -> bool:
        """Whether a formula or constant reads no other sheet than some."""
        read = parse_formula(text)
        cells = [one for one in read.references if not isinstance(one, TableReference)]
        spans = [one.start if isinstance(one, Span) else one for one in cells]
        named = {split_sheet(f"{one.sheet}A1")[0] for one in spans}
        return not read.unclear and named <= {*sheets, ""}

    def _name(self, root: Element, name: str, text: str, local: int | None) -> None:
        entry = etree.SubElement(_listed(root, "definedNames"), main("definedName"), {"name": name})
        entry.text = text
        if local is not None:
            entry.set("localSheetId", str(local))

    # ---- what sheets refer to by number --------------------------------------------------------

    def add_what_sheets_refer_to(self, sheets: Sequence[str]) -> None:
        """Take over the other workbooks that formulas read, what pivot tables have stored, and metadata of cells."""
        from_part, root = self._from.structure.part, self._roots[self._book.structure.part]
        source = self._from.container.tree(from_part)
        parts = {one.id: one.part for one in self._from.structure.relationships(from_part)}
        others = [parts[entry.get(_ID)] for entry in source.iter(main("externalReference"))]
        if others and root.find(main("externalReferences")) is not None:
            self.notes.append(
                "Formulas of added sheets may read other workbooks, and so do those of the workbook: look at what they read."
            )
        elif others:
            listed = _listed(root, "externalReferences")
            for part in others:
                entry = etree.SubElement(listed, main("externalReference"))
                entry.set(_ID, self._relate(self._copy(part), "externalLink"))
        for entry in source.iter(main("pivotCache")):
            if (part := parts.get(entry.get(_ID), "")) in self._copied:
                self._add_pivot_cache(root, part, entry.get("cacheId"))
        if self._takes_metadata:
            self._add_metadata(sheets)

    def _add_pivot_cache(self, root: Element, part: str, number: str) -> None:
        """List what pivot tables have stored, under a number that is free."""
        listed = _listed(root, "pivotCaches")
        used = {entry.get("cacheId") for entry in listed}
        free = next(one for one in chain((number,), map(str, count(1))) if one not in used)
        for table, copy in self._copied.items():
            if free != number and part in (
                one.part for one in self._from.structure.relationships(table)
            ):
                pivot = parse_part(self.added[copy], copy)
                pivot.set("cacheId", free)
                self.added[copy] = serialise(pivot, self.added[copy])
        entry = etree.SubElement(listed, main("pivotCache"), {"cacheId": free})
        entry.set(_ID, self._relate(self._copied[part], "pivotCacheDefinition"))

    @cached_property
    def _takes_metadata(self) -> bool:
        """Whether the workbook has no metadata, so that those of the sheets keep their numbers."""
        return self._book.structure.related("sheetMetadata") is None

    def _add_metadata(self, sheets: Sequence[str]) -> None:
        structure = self._from.structure
        parts = [part for sheet in sheets if (part := structure.worksheet_part(sheet))]
        refers = any(_REFERS_TO_METADATA.search(self._from.container.read(part)) for part in parts)
        comments = any(
            one.kind == "threadedComment" for part in parts for one in structure.relationships(part)
        )
        stored = self._from.container.find(relationships_part(structure.part))
        inside = {one.id: one.part for one in structure.relationships(structure.part)}
        for entry in self._from.container.tree(stored) if stored else ():
            family, _, kind = str(entry.get("Type", "")).rpartition("/")
            wanted = comments if kind == "person" else refers
            if wanted and kind.startswith(_REFERRED_TO) and entry.get("Id") in inside:
                self._relate(self._copy(inside[entry.get("Id")]), kind, family)


def _listed(root: Element, tag: str) -> Element:
    """A list of the workbook part, made in its place where it has none."""
    found = root.find(main(tag))
    if found is None:
        found = etree.Element(main(tag))
        before = _LISTS[: _LISTS.index(tag)]
        [*(one for name in before for one in root.iterfind(main(name)))][-1].addnext(found)
    return found


class _Looks:
    """Styles of the source that are added to those of the workbook, each when it is first needed."""

    def __init__(self, here: Element, there: Element) -> None:
        self._here, self._there = here, there
        self._known: dict[tuple[str, int], int] = {}
        self._formats: dict[str, str] = {}

    @cached_property
    def plain_is_other(self) -> bool:
        """Whether a cell without a style shows its number otherwise here, as a date perhaps, than there."""
        here, there = (
            root.find(f"{main('cellXfs')}/{main('xf')}") for root in (self._here, self._there)
        )
        return (
            here is not None
            and there is not None
            and (
                here.get("numFmtId", "0") != there.get("numFmtId", "0")
                or self._is_redefined(here.get("numFmtId", "0"))
            )
        )

    def _is_redefined(self, number: str) -> bool:
        """Whether a format that is built in means something else here, as some programs let it."""
        return any(entry.get("numFmtId") == number for entry in self._codes(self._here))

    def style(self, index: str) -> str:
        """The number here of a style of a cell there."""
        return str(self._taken("cellXfs", index))

    def difference(self, index: str) -> str:
        """The number here of what a rule or a table changes of a style."""
        return str(self._taken("dxfs", index))

    def _taken(self, listed: str, index: str | None) -> int:
        there = list(
            self._there.find(main(listed)) if self._there.find(main(listed)) is not None else ()
        )
        number = whole_number(index, len(there) - 1)
        if number is None:
            return 0
        if (listed, number) not in self._known:
            entry = deepcopy(there[number])
            if listed == "cellXfs":
                for name, attribute in _STYLE_LISTS.items():
                    entry.set(attribute, str(self._taken(name, entry.get(attribute))))
                entry.set("numFmtId", self._format(entry.get("numFmtId", "0")))
                entry.set(
                    "xfId", "0"
                )  # named styles are not taken over; the look does not need them
                for what in ("Font", "Fill", "Border", "NumberFormat", "Alignment", "Protection"):
                    entry.set(f"apply{what}", "1")
            self._known[listed, number] = self._append(listed, entry)
        return self._known[listed, number]

    def _append(self, listed: str, entry: Element) -> int:
        entries = self._here.find(main(listed))
        if entries is None:  # of the lists used here only this one may be missing
            entries = etree.Element(main("dxfs"))
            before = [self._here.find(main(tag)) for tag in ("cellStyles", "cellXfs")]
            next(one for one in before if one is not None).addnext(entries)
        entries.append(entry)
        entries.set("count", str(len(entries)))
        return len(entries) - 1

    def _format(self, number: str) -> str:
        """The number here of a number format there."""
        built_in = whole_number(number) or 0
        if built_in < _OWN_FORMATS and not self._is_redefined(number):
            return number
        if number not in self._formats:
            code = next(
                (
                    e.get("formatCode")
                    for e in self._codes(self._there)
                    if e.get("numFmtId") == number
                ),
                BUILT_IN.get(built_in, "General"),
            )
            same = [
                e.get("numFmtId") for e in self._codes(self._here) if e.get("formatCode") == code
            ]
            self._formats[number] = same[0] if same else self._new_format(code)
        return self._formats[number]

    def _new_format(self, code: str) -> str:
        formats = self._here.find(main("numFmts"))
        if formats is None:
            formats = etree.Element(main("numFmts"))
            self._here.insert(0, formats)
        used = [whole_number(entry.get("numFmtId")) or 0 for entry in formats]
        number = str(max([_OWN_FORMATS - 1, *used]) + 1)
        etree.SubElement(formats, main("numFmt"), {"numFmtId": number, "formatCode": code})
        formats.set("count", str(len(formats)))
        return number

    @staticmethod
    def _codes(styles: Element) -> Iterator[Element]:
        yield from styles.iterfind(f"{main('numFmts')}/{main('numFmt')}")
