"""The copy of a workbook that goes to the calculator: what it refuses or needs not is left out.

formualizer refuses a workbook with a data table, one that states too small an extent of a sheet (some programs do), and one
in which any cell shows a rich value (a picture, a linked data type). And it reads all cells, where histories take longer
than everything else. Hence extents, data tables and links to rich values are taken out, and on sheets without formulas the
last rows that none reads. No table is given to it: its formulas name cells (`plain_formulas`).
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Mapping

from addin.xlsx.dependents import FormulaMap
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.state import WorkbookState
from addin.xlsx.workbook_part import SIGNATURES, relationships_part
from addin.xlsx.xml_part import (
    BYTE_ORDER_MARK,
    RELATIONSHIP_IDS,
    Element,
    main,
    parse_part,
    serialise,
)

# Attributes hold no bracket: a search that passed over one could be led on to the end of the part each time.
_ROW = re.compile(rb'<((?:\w+:)?)row\b[^<>]*?\br="([0-9]{1,7})"')
_DIMENSION = re.compile(rb"<(?:\w+:)?dimension\b[^<>]*/>")
_TABLE_PARTS = re.compile(
    rb"<((?:\w+:)?)tableParts\b[^<>]*(?:/>|>.*?</\1tableParts\s*>)", re.DOTALL
)
# A bracket of another workbook ([1]Sheet!A1, '[1]Sheet'!A1), not of a table.
_EXTERNAL = re.compile(r"(?<![\w.\]\[])\[\d+\]")
_RICH_VALUE = re.compile(rb"""(<(?:\w+:)?c\s[^<>]*?)\svm=["'][^"'<>]*["']""")
_EXTENSIONS = re.compile(rb"<((?:\w+:)?extLst)\b[^>]*>.*?</\1\s*>", re.DOTALL)
# The calculator knows the id of a sheet by its usual prefix alone; .NET's XmlSerializer writes d3p1:id.
_OTHER_PREFIX = re.compile(rb"(<(?:\w+:)?sheet\s[^<>]*?\s)(?!r:)\w+:id=")
_USUAL_PREFIX = rb'\1xmlns:r="%s" r:id=' % RELATIONSHIP_IDS.encode()


def calculator_copy(
    workbook: WorkbookState,
    formulas: FormulaMap,
    read: Mapping[str, int] | None,
    left_out: Collection[str] = (),
    *,
    anew: bool = False,
) -> tuple[dict[str, bytes], set[str]]:
    """Parts of the copy that differ from the file as it was opened, and parts that it lacks.

    Parameters
    ----------
    workbook : WorkbookState
        The workbook, with the cells that were written.
    formulas : FormulaMap
        Its formulas.
    read : mapping of str to int, or None
        The last row of each sheet that formulas read; None when some formula may read anything.
    left_out : collection of str
        Formulas that are not to be calculated, as the map has them; their cells keep their values, as do those of data
        tables, formulas on other workbooks and formulas without text.
    anew : bool
        Whether sheets and shared texts are written anew: the calculator takes no byte order mark, no cell without a name
        and no character data.
    """
    structure = workbook.structure
    parts = workbook.changed_parts()
    rich, parts_without_rich = _without_rich_data(workbook)
    parts |= parts_without_rich
    # The calculator takes no signed package; what is signed is the file, not this copy.
    signed = {name for name in workbook.container.names if name.lower().startswith(SIGNATURES)}
    parts |= structure.without_relationships("", signed)[1]
    dropped = _parts_of_tables(workbook) | rich | signed
    texts: dict[str, dict[tuple[int, int], str]] = defaultdict(dict)
    for (sheet, row, column), text in formulas.rewritten.items():
        texts[sheet][row, column] = text
    for cell in formulas.cells:
        if (
            not cell.text
            or cell.text in left_out
            or cell.is_data_table
            or reads_other_workbook(cell.text)
        ):
            texts[cell.sheet][cell.place[1:]] = ""
    with_formulas = {cell.sheet for cell in formulas.cells}
    for sheet in workbook.sheet_names:
        part = structure.worksheet_part(sheet)
        if part is None:
            continue
        data = parts.get(part) or workbook.container.read(part)
        if read is not None and sheet not in with_formulas:
            data = _without_rows_below(data, read.get(sheet, 0))
        if sheet in texts or anew:
            copy = SheetPart(sheet, part, data, workbook.shared_texts.text)
            copy.exchange_formulas(texts[sheet])
            if anew:
                copy.name_cells()
            data = copy.to_bytes().removeprefix(BYTE_ORDER_MARK)
        parts |= structure.without_relationships(part, dropped)[1]
        stated = _DIMENSION.search(data, 0, data.find(b"sheetData"))
        data = data[: stated.start()] + data[stated.end() :] if stated else data
        parts[part] = _without_rich_values(_without_tables_and_extensions(data))
    shared = structure.related("sharedStrings")
    if anew and shared is not None:
        stored = workbook.container.read(shared)
        parts[shared] = serialise(parse_part(stored, shared), stored).removeprefix(BYTE_ORDER_MARK)
    parts |= structure.as_plain_workbook(without=dropped)
    parts |= _with_plain_names(workbook, formulas)
    book = structure.part
    parts[book] = _OTHER_PREFIX.sub(_USUAL_PREFIX, parts.get(book) or workbook.container.read(book))
    return {name: data for name, data in parts.items() if name not in dropped}, dropped


def _parts_of_tables(workbook: WorkbookState) -> set[str]:
    """Parts of tables and what they lead to, as those of queries do."""
    structure = workbook.structure
    tables = {table.part for table in workbook.tables.values()}
    beyond = {one.part for part in tables for one in structure.relationships(part)}
    holders = (workbook.container.find(relationships_part(part)) for part in tables)
    return tables | beyond | {part for part in holders if part is not None}


def _with_plain_names(workbook: WorkbookState, formulas: FormulaMap) -> dict[str, bytes]:
    """The workbook part with names that need no table; those whose meaning is not certain are left out."""
    if all(text == plain for text, plain in formulas.names.items()):
        return {}
    structure = workbook.structure
    data = workbook.container.read(structure.part)
    root = parse_part(data, structure.part)
    for entry in root.findall(f"{main('definedNames')}/{main('definedName')}"):
        text = (entry.text or "").strip()
        entry.text = formulas.names.get(text, text)
        if not entry.text:
            entry.getparent().remove(entry)
    names = root.find(main("definedNames"))
    if names is not None and not len(names):
        root.remove(names)
    return {structure.part: serialise(root, data)}


def _without_rows_below(data: bytes, last: int) -> bytes:
    for row in _ROW.finditer(data):
        if int(row[2]) > last:
            end = data.rfind(b"</%ssheetData" % row[1])
            return data[: row.start()] + data[end:] if end >= 0 else data
    return data


def _end_of_cells(data: bytes) -> int:
    """Where the cells of a sheet end; -1 in a sheet without any."""
    return max(data.rfind(b"sheetData>"), data.rfind(b"sheetData/>"))


def _without_tables_and_extensions(data: bytes) -> bytes:
    """A sheet without its tables and without what stands in extensions behind its cells: sparklines, rules, lists."""
    cells = _end_of_cells(data)
    if cells < 0:
        return data
    return data[:cells] + _EXTENSIONS.sub(b"", _TABLE_PARTS.sub(b"", data[cells:]))


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
