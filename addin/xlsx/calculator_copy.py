"""The copy of a workbook that goes to the calculator: what it refuses or needs not is left out.

formualizer refuses a workbook in which a cell of a calculated column holds a value (people type over such cells), one
that states too small an extent of a sheet (some programs do), one with a data table, one in which any cell shows a rich value
(a picture, a linked data type), and one whose tables have more than 256 columns together. And it reads all cells, where histories take longer
than everything else. Hence column formulas, extents, data tables and links to rich values are taken out, and on sheets without formulas
the last rows that none reads; and everywhere the tables that no formula names: for ``A1:B9`` cells are enough. Of a
table that is named it is given the columns from the first to the last that formulas name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from html import unescape

from addin.xlsx.formula_text import parse_formula
from addin.xlsx.references import Rect, absolute_range, quoted_sheet
from addin.xlsx.state import WorkbookState
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import SIGNATURES
from addin.xlsx.xml_part import Element, main, parse_part, serialise

# Attributes hold no bracket: a search that passed over one could be led on to the end of the part each time.
_ROW = re.compile(rb'<((?:\w+:)?)row\b[^<>]*?\br="([0-9]{1,7})"')
_DIMENSION = re.compile(rb"<(?:\w+:)?dimension\b[^<>]*/>")
_TABLE_PARTS = re.compile(
    rb"<((?:\w+:)?)tableParts\b[^<>]*>(.*?)</(?:\w+:)?tableParts\s*>", re.DOTALL
)
_TABLE_PART = re.compile(rb"""<(?:\w+:)?tablePart\b[^<>]*?\bid=["']([^"']*)["'][^<>]*/>""")
_TABLE_FORMULA = re.compile(
    rb"<((?:\w+:)?(?:calculatedColumnFormula|totalsRowFormula))\b[^<>]*(?:/>|>[^<]*</\1>)"
)
# A bracket of a table, not of another workbook ([1]Sheet!A1, '[1]Sheet'!A1).
_STRUCTURED = re.compile(r"[\w.]\[")
_COLUMN_OF_TABLE = re.compile(r"([^\W\d][\w.]*)\[([^\[\]#@']+)\]")
_EXTERNAL = re.compile(r"(?<![\w.\]\[])\[\d+\]")
_BRACKETED = re.compile(rb"\[\d+\]")
_EXTERNAL_BYTES = re.compile(_EXTERNAL.pattern.encode())
_FORMULA = re.compile(rb"<((?:\w+:)?f)\b(?:[^>]*/>|[^>]*>[^<]*</\1\s*>)")
_GROUP = re.compile(rb"""\bsi=["'](\d+)["']""")
_RICH_VALUE = re.compile(rb"""(<(?:\w+:)?c\s[^<>]*?)\svm=["'][^"'<>]*["']""")
_IS_DATA_TABLE = re.compile(rb"""^[^>]*\st=["']dataTable["']""")
_DYNAMIC_VALUE = re.compile(
    rb"""(<(?:\w+:)?c\s[^<>]*?)\scm=["'][^"'<>]*["']([^<>]*>)(?!<(?:\w+:)?f[\s/>])"""
)
_EXTENSIONS = re.compile(rb"<((?:\w+:)?extLst)\b[^>]*>.*?</\1\s*>", re.DOTALL)
_TOTALS_FUNCTION = re.compile(rb"""\stotalsRowFunction=(?:"[^"]*"|'[^']*')""")


def calculator_copy(
    workbook: WorkbookState,
    with_formulas: Collection[str],
    read: Collection[tuple[str, Rect]] | None,
    left_out: Collection[str] = (),
    named: Mapping[str, tuple[int, int]] | None = None,
) -> tuple[dict[str, bytes], set[str]]:
    """Parts of the copy that differ from the file as it was opened.

    Parameters
    ----------
    workbook : WorkbookState
        The workbook, with the cells that were written.
    with_formulas : collection of str
        Sheets that hold formulas.
    read : collection of (str, Rect) or None
        What formulas read; None when some formula may read anything.
    left_out : collection of str
        Formulas that are not to be calculated; their cells keep their values.
    named : mapping of str to (int, int), optional
        Tables that formulas name, with the first and last column of the sheet that they need; by default
        those that they read, whole.
    """
    parts = workbook.changed_parts()
    unread = [] if read is None else _unread_tables(workbook, read, named)
    rich, parts_without_rich = _without_rich_data(workbook)
    parts |= parts_without_rich
    # The calculator takes no signed package; what is signed is the file, not this copy.
    signed = {name for name in workbook.container.names if name.lower().startswith(SIGNATURES)}
    parts |= workbook.structure.without_relationships("", signed)[1]
    dropped = {table.part for table in unread} | rich | signed
    kept = [table for table in workbook.tables.values() if table.part not in dropped]
    for table in kept:
        data = parts.get(table.part) or workbook.container.read(table.part)
        data = _TOTALS_FUNCTION.sub(b"", _TABLE_FORMULA.sub(b"", data))
        columns = (named or {}).get(table.name, (table.ref.left, table.ref.right))
        parts[table.part] = _narrowed(table, data, *columns)
    needed = [*(read or ()), *((table.sheet, table.ref) for table in kept)]
    for sheet in workbook.sheet_names:
        part = workbook.structure.worksheet_part(sheet)
        if part is None:
            continue
        data = parts.get(part) or workbook.container.read(part)
        if read is not None and sheet not in with_formulas:
            last = max((rect.bottom for one, rect in needed if one == sheet), default=0)
            data = _without_rows_below(data, last)
        ids: Collection[str] = ()
        if any(table.sheet == sheet for table in unread):
            ids, relationships = workbook.structure.without_relationships(part, dropped)
            parts |= relationships
        data = _without_table_parts(data, ids)
        stated = _DIMENSION.search(data, 0, data.find(b"sheetData"))
        data = data[: stated.start()] + data[stated.end() :] if stated else data
        data = _without_rich_values(_without_extensions(data))
        parts[part] = _without_formulas(data, left_out)
    parts |= workbook.structure.as_plain_workbook(without=dropped)
    parts |= _with_plain_names(workbook)
    return {name: data for name, data in parts.items() if name not in dropped}, dropped


def _with_plain_names(workbook: WorkbookState) -> dict[str, bytes]:
    """The workbook part with plain ranges for names of parts of tables; other names of that kind are left out."""
    structure = workbook.structure
    if not any(_STRUCTURED.search(name.text) for name in structure.names):
        return {}
    data = workbook.container.read(structure.part)
    root = parse_part(data, structure.part)
    for entry in root.findall(f"{main('definedNames')}/{main('definedName')}"):
        text = entry.text or ""
        if not _STRUCTURED.search(text):
            continue
        plain = _plain_range(workbook, text)
        if plain is None:
            entry.getparent().remove(entry)
        else:
            entry.text = plain
    names = root.find(main("definedNames"))
    if names is not None and not len(names):
        root.remove(names)
    return {structure.part: serialise(root, data)}


def _plain_range(workbook: WorkbookState, text: str) -> str | None:
    """``Table[Column]`` as cells; None for anything less plain."""
    match = _COLUMN_OF_TABLE.fullmatch(text.strip())
    tables = {name.casefold(): table for name, table in workbook.tables.items()}
    table = match and tables.get(match[1].casefold())
    columns = {} if not table else {c.casefold(): k for k, c in enumerate(table.columns)}
    if not match or not table or match[2].strip().casefold() not in columns:
        return None
    at = table.ref.left + columns[match[2].strip().casefold()]
    cells = Rect(table.data.top, at, table.data.bottom, at)
    return f"{quoted_sheet(table.sheet)}!{absolute_range(cells)}"


def _narrowed(table: Table, data: bytes, left: int, right: int) -> bytes:
    """A table from one column of the sheet to another; its filter, which counts columns, goes."""
    if (left, right) == (table.ref.left, table.ref.right):
        return data
    root = parse_part(data, table.part)
    root.set("ref", str(Rect(table.ref.top, left, table.ref.bottom, right)))
    columns = root.find(main("tableColumns"))
    for k, column in enumerate(columns.findall(main("tableColumn")), start=table.ref.left):
        if not left <= k <= right:
            columns.remove(column)
    columns.set("count", str(right - left + 1))
    for name in ("autoFilter", "sortState"):
        for element in root.findall(main(name)):
            root.remove(element)
    return serialise(root, data)


def mentioned_in_names(workbook: WorkbookState) -> Callable[[Table], bool]:
    """Whether a defined name needs a table, or may."""
    # Names of parts of tables become plain ranges, or are left out.
    plain = [one.text for one in workbook.structure.names if not _STRUCTURED.search(one.text)]
    of_names = {name.casefold() for text in plain for name in parse_formula(text).names}
    unclear = [text.casefold() for text in plain if parse_formula(text).unclear]

    def is_mentioned(table: Table) -> bool:
        name = table.name.casefold()
        return name in of_names or any(name in text for text in unclear)

    return is_mentioned


def _unread_tables(
    workbook: WorkbookState, read: Collection[tuple[str, Rect]], named: Collection[str] | None
) -> list[Table]:
    """Tables that no formula needs, those of their own columns included, and no defined name mentions."""
    is_mentioned = mentioned_in_names(workbook)

    def is_needed(table: Table) -> bool:
        if is_mentioned(table):
            return True
        if named is not None:
            return table.name in named
        return any(sheet == table.sheet and rect.meets(table.ref) for sheet, rect in read)

    return [
        table
        for table in workbook.tables.values()
        if not is_needed(table)
        # A table of a query leads to further parts.
        and not workbook.structure.relationships(table.part)
    ]


def _without_rows_below(data: bytes, last: int) -> bytes:
    for row in _ROW.finditer(data):
        if int(row[2]) > last:
            end = data.rfind(b"</%ssheetData" % row[1])
            return data[: row.start()] + data[end:] if end >= 0 else data
    return data


def _end_of_cells(data: bytes) -> int:
    """Where the cells of a sheet end; -1 in a sheet without any."""
    return max(data.rfind(b"sheetData>"), data.rfind(b"sheetData/>"))


def _without_extensions(data: bytes) -> bytes:
    """A sheet without what stands in extensions behind its cells: sparklines, rules, lists."""
    cells = _end_of_cells(data)
    return data[:cells] + _EXTENSIONS.sub(b"", data[cells:]) if cells >= 0 else data


def _without_rich_data(workbook: WorkbookState) -> tuple[set[str], dict[str, bytes]]:
    """Parts left out that hold rich values, and what leads to them without that."""
    structure = workbook.structure
    left_out = {
        name for name in workbook.container.names if name.lower().startswith("xl/richdata/")
    }
    replaced: dict[str, bytes] = {}
    metadata = structure.related("sheetMetadata")
    if metadata is not None:
        data = workbook.container.read(metadata)
        root = parse_part(data, metadata)
        if not _keep_dynamic_arrays(root):
            left_out.add(metadata)
        else:
            replaced[metadata] = serialise(root, data)
    return left_out, replaced | structure.without_relationships(structure.part, left_out)[1]


def _keep_dynamic_arrays(root: Element) -> bool:
    """Take out of the metadata what is said of values, and say whether anything remains."""
    types = root.findall(f"{main('metadataTypes')}/{main('metadataType')}")
    kept = [element.get("name") == "XLDAPR" for element in types]
    numbers = {str(k): str(sum(kept[:k])) for k, keep in enumerate(kept, start=1) if keep}
    for element in [*types, *root.findall(main("futureMetadata"))]:
        if element.get("name") != "XLDAPR":
            element.getparent().remove(element)
    for tag in ("valueMetadata", "mdxMetadata", "metadataStrings"):
        for element in root.findall(main(tag)):
            root.remove(element)
    for record in root.findall(f"{main('cellMetadata')}/{main('bk')}/{main('rc')}"):
        number = numbers.get(record.get("t", ""))
        if number is None:
            record.getparent().remove(record)
        else:
            record.set("t", number)
    holder = root.find(main("metadataTypes"))
    if holder is not None:
        holder.set("count", str(sum(kept)))
    return any(kept)


def _without_rich_values(data: bytes) -> bytes:
    """A sheet whose cells show their fallbacks; what may depend on them is not taken over."""
    return _RICH_VALUE.sub(rb"\1", data) if b"vm=" in data else data


def reads_other_workbook(formula: str) -> bool:
    """Whether a formula reads another workbook, whose cells are not here."""
    return "[" in formula and _EXTERNAL.search(formula) is not None


def _without_formulas(data: bytes, left_out: Collection[str]) -> bytes:
    """A sheet whose data tables, formulas on other workbooks, and some more, are gone; their values stay."""
    # A quick look, as sheets are long.
    if not left_out and b"dataTable" not in data and _BRACKETED.search(data) is None:
        return data

    def is_left_out(formula: re.Match[bytes]) -> bool:
        text = formula[0]
        if _EXTERNAL_BYTES.search(text) or _IS_DATA_TABLE.search(text):
            return True
        inside = text[text.index(b">") + 1 : text.rfind(b"</")] if left_out else b""
        return unescape(inside.decode("utf-8", "replace")) in left_out if inside else False

    groups = {
        group[1]
        for formula in _FORMULA.finditer(data)
        if is_left_out(formula) and (group := _GROUP.search(formula[0]))
    }

    def kept(formula: re.Match[bytes]) -> bytes:
        group = _GROUP.search(formula[0])
        shares = group is not None and group[1] in groups
        return b"" if shares or is_left_out(formula) else formula[0]

    # A cell that is no formula any more is no dynamic array either.
    return _DYNAMIC_VALUE.sub(rb"\1\2", _FORMULA.sub(kept, data))


def _without_table_parts(data: bytes, ids: Collection[str]) -> bytes:
    """A sheet without its links to some tables; the number of the others is stated, as LibreOffice does not."""
    found = _TABLE_PARTS.search(data, max(_end_of_cells(data), 0))
    if found is None:
        return data
    prefix = found[1]
    kept = [one[0] for one in _TABLE_PART.finditer(found[2]) if one[1].decode() not in ids]
    text = b'<%stableParts count="%d">%s</%stableParts>' % (
        prefix,
        len(kept),
        b"".join(kept),
        prefix,
    )
    return data[: found.start()] + (text if kept else b"") + data[found.end() :]
