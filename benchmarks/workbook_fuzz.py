"""Workbooks spoiled at random, in zip, XML and cells, through open, read, recalculate and save.

`python -m benchmarks.workbook_fuzz` makes 20,000 of them from real workbooks; with `--record` the numbers of several runs add up
(`--first 1000 --count 500`, in stretches that do not overlap).
Nothing of it is random twice: the number of a file decides what is done to it, so any of them can
be made again (`--only NUMBER`), and a run that was stopped goes on where it was.

What is demanded of each (`verdict_on`): no exception, no wait, nothing left half written, the
source as it was, every message a sentence, and what was written opens again, here and in openpyxl.
"""

from __future__ import annotations

import argparse
import faulthandler
import hashlib
import io
import json
import multiprocessing
import random
import re
import signal
import struct
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

__all__ = ["Block", "Outcome", "Seed", "fuzz", "mutated", "seeds", "sentence_fault", "verdict_on"]

ROOT = Path(__file__).resolve().parents[1]
RECORD = Path(__file__).parent / "records" / "workbook_fuzz.json"
#: One mutation may take this long before it counts as hanging [s]; an honest one takes 0.3, or 16 on a machine with ten times as much to do.
PATIENCE = 60.0
#: What openpyxl gets to open a file: it makes an object of each cell of a merged range, be that the whole sheet.
OPENPYXL_PATIENCE, OPENPYXL_MEMORY = 20, 100 * 2**20  # [s of processor time], [byte]
BLOCK = 100


# --- the workbooks ------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Seed:
    """A workbook to be spoiled."""

    name: str
    suffix: str
    data: bytes
    parts: dict[str, bytes]
    share: int


@lru_cache(maxsize=1)
def seeds() -> tuple[Seed, ...]:
    """Real workbooks with a train of two stations and without start, so that each calculates fast."""
    with tempfile.TemporaryDirectory() as folder:
        small, macros = Path(folder, "small.xlsx"), Path(folder, "macros.xlsm")
        _compact_workbook(small)
        _compact_workbook(macros, macros=True)
        return (
            _seed("compact", small, 8),
            _seed("compact with macros", macros, 3),
            _seed("template", _from_template(Path(folder, "template.xlsx")), 1),
        )


def _seed(name: str, path: Path, share: int) -> Seed:
    data = path.read_bytes()
    return Seed(name, path.suffix, data, _parts(data), share)


def _parts(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {entry.filename: archive.read(entry) for entry in archive.infolist()}


_INPUTS: dict[str, list[dict[str, Any]]] = {
    "Stations": [{"Station": "Motor", "Inertia": 1000}, {"Station": "Load", "Inertia": 500}],
    "Elements": [
        {"Element": "Coupling", "Kind": "coupling", "From": "Motor", "To": "Load", "Stiffness": 1e6}
    ],
}
_SCALARS = {
    "TemplateVersion": "1", "Title": "Small train", "LineFrequency": 60,
    "SynchronousSpeed": 1800, "RatedTorque": 1000, "DampingRatio": 1.5,
}  # fmt: skip
_RESULTS = ("NaturalFrequencies", "ModeShapes", "SeparationMargins", "Verdicts", "Checks", "Audit")


def _compact_workbook(path: Path, *, macros: bool = False) -> None:
    """Every input, some result tables, and what people put beside them."""
    import datetime

    import xlsxwriter

    from addin.contract.tables import INPUT_TABLES, RESULT_TABLES, SCALARS

    book = xlsxwriter.Workbook(str(path))
    book.set_properties({"title": "Train", "created": datetime.datetime(2026, 1, 2)})
    case, inputs, results = (book.add_worksheet(name) for name in ("Case", "Train", "Results"))
    own = book.add_worksheet("Owner's notes")
    for row, spec in enumerate(SCALARS, start=3):
        case.write_string(row, 2, spec.name)
        value = _SCALARS.get(spec.name)
        if value is not None:
            case.write(row, 4, value)
        case.write_string(row, 5, spec.unit_us)
        book.define_name(spec.name, f"=Case!$E${row + 1}")
    top = 2
    for table in (*INPUT_TABLES, *(one for one in RESULT_TABLES if one.name in _RESULTS)):
        sheet = inputs if table in INPUT_TABLES else results
        rows = _INPUTS.get(table.name, [])
        for at, column in enumerate(table.columns, start=1):
            sheet.write_string(top, at, column.unit_us)
        sheet.add_table(
            top + 1, 1, top + 2 + len(rows), len(table.columns),
            {
                "name": table.name,
                "columns": [{"header": column.name} for column in table.columns],
                "data": [[row.get(column.name) for column in table.columns] for row in rows],
            },
        )  # fmt: skip
        # Results grow downwards; inputs need room for the row that the engineer adds.
        top += 60 if sheet is results else 8
    own.write_formula("A1", "=MAX(NaturalFrequencies[Frequency])", value=0)
    own.write_formula("A2", "=RatedTorque*2", value=2000)
    own.write_formula("A3", "=A1+A2", value=2000)
    own.write_array_formula("C1:C2", "{=A1:A2*2}", value=0)
    own.write_string("A4", "=cmd|' /C calc'!A0")
    own.merge_range("A6:C6", "ask the vendor about the coupling")
    own.write_comment("A1", "as on the name plate")
    own.data_validation("B2", {"validate": "list", "source": ["hp", "kW"]})
    own.conditional_format("A1:A3", {"type": "cell", "criteria": ">", "value": 5})
    own.add_sparkline("D1", {"range": "'Owner''s notes'!A1:A3"})
    chart = book.add_chart({"type": "line"})
    chart.add_series({"values": "='Owner''s notes'!$A$1:$A$3"})
    own.insert_chart("F2", chart)
    if macros:
        book.add_vba_project(io.BytesIO(bytes.fromhex("D0CF11E0A1B11AE1") + bytes(512)), True)
    book.close()


def _from_template(path: Path) -> Path:
    """The filled example, its curves taken out so that no start is run."""
    from addin.xlsx import open_workbook

    book = open_workbook(ROOT / "templates" / "example_proposed.xlsx")
    book.write_table("MotorTorque", [])
    book.save(path)
    return path


# --- what is done to them -----------------------------------------------------------------------

NASTY_NUMBERS = (
    "1e308", "-1e308", "1e-320", "NaN", "INF", "-INF", "1e400", "0", "-0", "1,5", "0x10", "١٢٣",
    "9" * 400, "", " ", "1e", "--1", "4294967296", "-1", "18446744073709551616", "1_000", "½",
)  # fmt: skip
NASTY_TEXTS = (
    "=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\t=1", "", " ", "\u00a0", "#REF!", "#N/A", "nan",
    "_x0000_", "_xD800_", "_x001B_[2J", "\u202e", "ﬀ", "m**999999999", "1e400*m", "10^99*lbf*in/rad",
    "m" + "*m" * 200, "kg²²²", "(" * 80, "%%", "x" * 40_000, "<a>&amp;", "ground", "Motor",
    "{0}", "%s", "'", '"', "''", "None", "TRUE", "\U0001f600",
)  # fmt: skip
NASTY_REFS = (
    "XFD1048576", "A1:XFD1048576", "A0", "XFE1", "A1048577", "A:A", "1:1", "B5:A1", "", "A", "5",
    "A1:B2:C3", "Sheet!A1", "$A$1", "a1", "A1 B2", "ZZZZ9", "A-1", "٣", "A1:", ":", "A1:A999999",
)  # fmt: skip
NASTY_FORMULAS = (
    "1+", "A1:XFD1048576", "SUM(A:XFD)", "(" * 300 + "1" + ")" * 300, "1" + "+1" * 4_000,
    "[1]Other!A1", "'[../../x.xlsx]S'!A1", "INDIRECT(A1)", "Loop", "Title", "NOW()", "#REF!",
    "Stations[[#This Row],[Inertia]]", "Stations[", "[@Inertia]", "A1:INDEX(A:A,3)", "CALL(\"a\")",
    "'", "\"", "WEBSERVICE(\"http://example.org\")", "cmd|' /C calc'!A0", "A1:A2 A1", "{1,2;3}",
)  # fmt: skip
NASTY_NAMES = (
    "../evil.xml", "/etc/passwd", "C:\\evil.xml", "xl\\workbook.xml", "XL/WORKBOOK.XML",
    "xl/./workbook.xml", "xl//workbook.xml", "con", "a" * 300, "", "xl/", "é.xml", "xl/a\nb.xml",
)  # fmt: skip
DOCTYPES = (
    b'<!DOCTYPE x [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
    b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/hostname">]>',
    b'<!DOCTYPE x SYSTEM "http://127.0.0.1:9/x.dtd">',
)

Change = Callable[[random.Random, Seed], bytes]


def mutated(number: int, run: int = 1) -> tuple[Seed, str, bytes]:
    """The file of one number: the workbook it came from, what was done, and its bytes."""
    chance = random.Random(f"{run}:{number}")
    every = seeds()
    seed = chance.choices(every, [one.share for one in every])[0]
    name, change = chance.choice(LEVELS)
    return seed, name, change(chance, seed)


def _zip_level(chance: random.Random, seed: Seed) -> bytes:
    """The archive spoiled as bytes, or packed anew with other entries."""
    if chance.random() < 0.5:
        data = bytearray(seed.data)
        for _ in range(chance.choice((1, 1, 2, 5))):
            chance.choice(_RAW)(chance, data)
        return bytes(data)
    parts = list(seed.parts.items())
    for _ in range(chance.choice((1, 1, 2))):
        chance.choice(_ENTRIES)(chance, parts)
    return _packed(parts, chance.choice((zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED)))


def _packed(parts: Sequence[tuple[str, bytes]], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name, data in parts:
            entry = zipfile.ZipInfo("x", (1980, 1, 1, 0, 0, 0))
            entry.filename, entry.compress_type = name, method
            archive.writestr(entry, data, compresslevel=1)
    return stream.getvalue()


def _flip(chance: random.Random, data: bytearray) -> None:
    for _ in range(chance.choice((1, 4, 32))):
        data[chance.randrange(len(data))] = chance.randrange(256)


def _cut(chance: random.Random, data: bytearray) -> None:
    del data[chance.randrange(4, len(data)) :]


def _remove_slice(chance: random.Random, data: bytearray) -> None:
    at = chance.randrange(len(data))
    del data[at : at + chance.choice((1, 7, 100, 4000))]


def _insert(chance: random.Random, data: bytearray) -> None:
    at = chance.randrange(len(data))
    data[at:at] = chance.randbytes(chance.choice((1, 7, 100)))


def _repeat_slice(chance: random.Random, data: bytearray) -> None:
    at = chance.randrange(len(data))
    data[at:at] = data[at : at + 500]


def _blank(chance: random.Random, data: bytearray) -> None:
    at = chance.randrange(len(data))
    size = min(chance.choice((4, 64, 1000)), len(data) - at)
    data[at : at + size] = bytes(size)


def _in_directory(chance: random.Random, data: bytearray) -> None:
    """A field of an entry in the directory, or of the local header of one."""
    mark = chance.choice((b"PK\x01\x02", b"PK\x03\x04", b"PK\x05\x06"))
    places = [found.start() for found in re.finditer(re.escape(mark), bytes(data))]
    if not places:
        return
    at = chance.choice(places) + chance.randrange(4, 44)
    size = chance.choice((2, 4))
    if at + size > len(data):
        return
    value = chance.choice((0, 1, 8, 99, 0x7FFF, 0xFFFF, 0xFFFFFFFF, chance.getrandbits(32)))
    data[at : at + size] = struct.pack("<L", value & 0xFFFFFFFF)[:size]


_RAW = (_flip, _cut, _remove_slice, _insert, _repeat_slice, _blank, _in_directory, _in_directory)

Parts = list[tuple[str, bytes]]


def _drop(chance: random.Random, parts: Parts) -> None:
    parts.pop(chance.randrange(len(parts)))


def _twice(chance: random.Random, parts: Parts) -> None:
    name, data = chance.choice(parts)
    parts.append((chance.choice((name, name.upper(), name + " ")), data))


def _rename(chance: random.Random, parts: Parts) -> None:
    at = chance.randrange(len(parts))
    parts[at] = (chance.choice(NASTY_NAMES), parts[at][1])


def _swap(chance: random.Random, parts: Parts) -> None:
    one, two = chance.randrange(len(parts)), chance.randrange(len(parts))
    parts[one], parts[two] = (parts[one][0], parts[two][1]), (parts[two][0], parts[one][1])


def _refill(chance: random.Random, parts: Parts) -> None:
    at = chance.randrange(len(parts))
    content = chance.choice(
        (b"", b"\0", chance.randbytes(200), b"<a/>", bytes(3 * 2**20), b"\xff\xfe")
    )
    parts[at] = (parts[at][0], content)


def _nest(chance: random.Random, parts: Parts) -> None:
    parts.append(("xl/embeddings/book.xlsx", _packed(parts)))


def _shuffle(chance: random.Random, parts: Parts) -> None:
    chance.shuffle(parts)


_ENTRIES = (_drop, _drop, _twice, _rename, _rename, _swap, _refill, _refill, _nest, _shuffle)


_TAG = re.compile(rb"<[^<>]*>")
_ATTRIBUTE = re.compile(rb"""\s[\w:.\-]+=(?:"[^"]*"|'[^']*')""")


def _xml_level(chance: random.Random, seed: Seed) -> bytes:
    """Tags, attributes and texts of one or two parts spoiled, well-formed or not."""
    parts = dict(seed.parts)
    for _ in range(chance.choice((1, 1, 1, 2))):
        name = _some_part(chance, seed)
        data = parts[name]
        for _ in range(chance.choice((1, 1, 2, 6))):
            data = chance.choice(_XML)(chance, data)
        parts[name] = data
    return _packed(list(parts.items()))


def _some_part(chance: random.Random, seed: Seed) -> str:
    """A part that is XML; those that everything hangs on come more often."""
    names = [name for name in seed.parts if name.endswith((".xml", ".rels"))]
    groups = [
        ["[Content_Types].xml"], ["xl/workbook.xml"],
        [n for n in names if "/worksheets/sheet" in n],
        [n for n in names if "/tables/" in n],
        [n for n in names if n.endswith(".rels")],
        ["xl/sharedStrings.xml"], ["xl/styles.xml"],
        [n for n in names if "/charts/" in n], names,
    ]  # fmt: skip
    return chance.choice(
        chance.choice([group for group in groups if group[:1] and group[0] in names])
    )


def _some_match(chance: random.Random, pattern: re.Pattern[bytes], data: bytes) -> tuple[int, int]:
    """A match near a random place; (0, 0) when there is none."""
    found = pattern.search(data, chance.randrange(max(len(data), 1)))
    found = found or pattern.search(data)
    return found.span() if found else (0, 0)


def _without_tag(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, _TAG, data)
    return data[:start] + data[end:]


def _repeated_tag(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, _TAG, data)
    return data[:end] + data[start:end] * chance.choice((1, 3, 400)) + data[end:]


def _element(chance: random.Random, data: bytes) -> tuple[int, int]:
    """A whole small element without children of its own name."""
    start, end = _some_match(chance, _TAG, data)
    tag = re.match(rb"<([\w:]+)", data[start:end])
    if tag is None or data[start:end].endswith(b"/>"):
        return start, end
    close = data.find(b"</" + tag[1] + b">", end)
    return (start, close + len(tag[1]) + 3) if close >= 0 else (start, end)


def _without_element(chance: random.Random, data: bytes) -> bytes:
    start, end = _element(chance, data)
    return data[:start] + data[end:]


def _repeated_element(chance: random.Random, data: bytes) -> bytes:
    start, end = _element(chance, data)
    return data[:end] + data[start:end] * chance.choice((1, 2, 50)) + data[end:]


def _moved_element(chance: random.Random, data: bytes) -> bytes:
    start, end = _element(chance, data)
    moved, rest = data[start:end], data[:start] + data[end:]
    at = _some_match(chance, _TAG, rest)[1]
    return rest[:at] + moved + rest[at:]


def _nasty(chance: random.Random) -> bytes:
    from xml.sax.saxutils import escape

    some = chance.choice((NASTY_NUMBERS, NASTY_TEXTS, NASTY_REFS, NASTY_FORMULAS, NASTY_NAMES))
    return escape(chance.choice(some), {'"': "&quot;"}).encode("utf-8", "replace")


def _other_attribute(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, _ATTRIBUTE, data)
    name = data[start:end].partition(b"=")[0]
    return data[:start] + name + b'="' + _nasty(chance) + b'"' + data[end:]


def _without_attribute(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, _ATTRIBUTE, data)
    return data[:start] + data[end:]


def _other_text(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, re.compile(rb">[^<>]+<"), data)
    return data[: start + 1] + _nasty(chance) + data[max(end - 1, start + 1) :]


def _inserted(chance: random.Random, data: bytes) -> bytes:
    at = _some_match(chance, _TAG, data)[chance.choice((0, 1))]
    piece = chance.choice(
        (b"<!-- a -->", b"<?pi a?>", b"<![CDATA[x]]>", b"&lt;", b"&a;", b"&#0;", b"\0", b"text",
         b"<x>" * 300 + b"</x>" * 300, b'<mc:x xmlns:mc="urn:x"/>', b"<c/>", b"<row/>", b"\xff",
         chance.choice(DOCTYPES))
    )  # fmt: skip
    return data[:at] + piece + data[at:]


def _declared(chance: random.Random, data: bytes) -> bytes:
    head, mark, rest = data.partition(b"?>")
    return head + mark + chance.choice(DOCTYPES) + rest


def _encoded(chance: random.Random, data: bytes) -> bytes:
    text = re.sub(r"\A<\?xml[^>]*\?>", "", data.decode("utf-8", "replace"))
    return text.encode(chance.choice(("utf-16", "utf-16-le", "utf-32", "utf-7", "cp037", "latin-1")),
                       "replace")  # fmt: skip


def _renamed_tag(chance: random.Random, data: bytes) -> bytes:
    start, end = _some_match(chance, _TAG, data)
    tag = re.match(rb"</?([\w:]+)", data[start:end])
    return data.replace(tag[1], b"odd") if tag and len(tag[1]) > 1 else data


def _flipped(chance: random.Random, data: bytes) -> bytes:
    changed = bytearray(data)
    if changed:
        _flip(chance, changed)
    return bytes(changed)


def _shortened(chance: random.Random, data: bytes) -> bytes:
    return data[: chance.randrange(max(len(data), 1))]


_XML = (
    _without_tag, _repeated_tag, _without_element, _without_element, _repeated_element,
    _moved_element, _other_attribute, _other_attribute, _other_attribute, _without_attribute,
    _without_attribute, _other_text, _other_text, _inserted, _declared, _encoded, _renamed_tag,
    _flipped, _shortened,
)  # fmt: skip


def _cell_level(chance: random.Random, seed: Seed) -> bytes:
    """Well-formed parts whose cells, tables, names or merged ranges say something odd."""
    from lxml import etree

    parts = dict(seed.parts)
    for _ in range(chance.choice((1, 1, 2, 4))):
        name = chance.choice(_cell_parts(seed))
        root = etree.fromstring(parts[name])
        kind = name.split("/")[1]
        _CELL_KINDS.get(kind, _odd_workbook)(chance, root)
        parts[name] = etree.tostring(root, xml_declaration=True, encoding="UTF-8", standalone=True)
    return _packed(list(parts.items()))


def _cell_parts(seed: Seed) -> list[str]:
    sheets = [n for n in seed.parts if re.fullmatch(r"xl/worksheets/[^/]*\.xml", n)]
    tables = [n for n in seed.parts if n.startswith("xl/tables/")]
    return [*sheets * 3, *tables, *["xl/workbook.xml"] * 4, *["xl/sharedStrings.xml"] * 4]


def _m(tag: str) -> str:
    return f"{{http://schemas.openxmlformats.org/spreadsheetml/2006/main}}{tag}"


def _odd_sheet(chance: random.Random, root: Any) -> None:
    cells = list(root.iter(_m("c")))
    if not cells or chance.random() < 0.1:
        _odd_layout(chance, root)
        return
    cell = chance.choice(cells)
    what = chance.randrange(8)
    if what == 0:
        cell.set("r", chance.choice(NASTY_REFS))
    elif what == 1:
        cell.set("s", chance.choice(NASTY_NUMBERS))
    elif what == 2:
        cell.set("t", chance.choice(("n", "s", "str", "b", "e", "d", "inlineStr", "odd", "")))
    elif what == 3:
        _fill(cell, chance, "str", chance.choice(NASTY_TEXTS))
    elif what == 4:
        _fill(cell, chance, "n", chance.choice(NASTY_NUMBERS))
    elif what == 5:
        _fill(cell, chance, "e", chance.choice(("#REF!", "#N/A", "#ODD!", "")))
    elif what == 6:
        formula = cell.makeelement(_m("f"))
        formula.text = chance.choice(NASTY_FORMULAS)
        for key, value in (("t", ("shared", "array", "dataTable", "odd")), ("ref", NASTY_REFS),
                           ("si", NASTY_NUMBERS)):  # fmt: skip
            if chance.random() < 0.4:
                formula.set(key, chance.choice(value))
        cell.insert(0, formula)
    else:
        cell.getparent().set("r", chance.choice(NASTY_NUMBERS))


def _fill(cell: Any, chance: random.Random, kind: str, text: str) -> None:
    for child in list(cell):
        cell.remove(child)
    cell.set("t", kind)
    value = cell.makeelement(_m("v"))
    value.text = text
    cell.append(value)


def _odd_layout(chance: random.Random, root: Any) -> None:
    from lxml import etree

    what = chance.randrange(4)
    if what == 0:
        holder = root.find(_m("mergeCells"))
        if holder is None:
            holder = root.makeelement(_m("mergeCells"))
            root.find(_m("sheetData")).addnext(holder)
        for _ in range(chance.choice((1, 2, 3000))):
            etree.SubElement(holder, _m("mergeCell"), ref=chance.choice(NASTY_REFS))
    elif what == 1:
        holder = root.makeelement(_m("cols"))
        root.find(_m("sheetData")).addprevious(holder)
        one = etree.SubElement(holder, _m("col"))
        for key in ("min", "max", "style"):
            one.set(key, chance.choice(NASTY_NUMBERS))
    elif what == 2:
        data = root.find(_m("sheetData"))
        row = etree.SubElement(data, _m("row"), r=chance.choice(("1048576", "1048577", "0", "x")))
        etree.SubElement(row, _m("c"), r=chance.choice(NASTY_REFS))
    else:
        dimension = root.find(_m("dimension"))
        if dimension is not None:
            dimension.set("ref", chance.choice(NASTY_REFS))


def _odd_table(chance: random.Random, root: Any) -> None:
    what = chance.randrange(6)
    columns = root.findall(f"{_m('tableColumns')}/{_m('tableColumn')}")
    if what == 0:
        root.set("ref", chance.choice(NASTY_REFS))
    elif what == 1:
        key = chance.choice(("headerRowCount", "totalsRowCount", "id"))
        root.set(key, chance.choice(NASTY_NUMBERS))
    elif what == 2:
        key = chance.choice(("displayName", "name"))
        root.set(key, chance.choice(("Stations", "Elements", "", "Verdicts", *NASTY_TEXTS)))
    elif what == 3:
        root.attrib.pop(chance.choice(list(root.attrib)))
    elif what == 4:
        chance.choice(columns).set("name", chance.choice(("Station", "From", *NASTY_TEXTS[:12])))
    else:
        one = chance.choice(columns)
        formula = one.makeelement(_m("calculatedColumnFormula"))
        formula.text = chance.choice(NASTY_FORMULAS)
        one.insert(0, formula)


def _odd_strings(chance: random.Random, root: Any) -> None:
    texts = list(root.iter(_m("t")))
    if chance.random() < 0.1:
        root.remove(chance.choice(list(root)))
    elif texts:
        # No XML holds these two; they are in the list for cells.
        chance.choice(texts).text = chance.choice([t for t in NASTY_TEXTS if "\0" not in t])


def _odd_workbook(chance: random.Random, root: Any) -> None:
    from lxml import etree

    names, sheets = root.find(_m("definedNames")), list(root.iter(_m("sheet")))
    what = chance.randrange(7)
    if what == 0:
        chance.choice(sheets).set(
            "name", chance.choice(("Case", "Train", "a!b", *NASTY_TEXTS[:12]))
        )
    elif what == 1:
        chance.choice(sheets).set("sheetId", chance.choice(NASTY_NUMBERS))
    elif what == 2:
        odd = "{http://schemas.openxmlformats.org/officeDocument/2006/relationships}id"
        chance.choice(sheets).set(odd, chance.choice(("rId1", "rId999", "")))
    elif names is None:
        return
    elif what == 3:
        chance.choice(list(names)).text = chance.choice((*NASTY_FORMULAS, *NASTY_REFS))
    elif what == 4:
        key = chance.choice(("name", "localSheetId", "hidden"))
        chance.choice(list(names)).set(key, chance.choice(NASTY_NUMBERS + NASTY_TEXTS[:12]))
    elif what == 5:
        one = chance.choice(list(names))
        one.text = f"Case!$E$5:$E${chance.choice((1, 4, 1048576, 9999999))}"
    else:
        loops = {"Title": "Loop+Loop+Loop", "Loop": "Loup+Loup+Loup", "Loup": "Loop+Loop+Title"}
        for name, text in loops.items():
            etree.SubElement(names, _m("definedName"), name=name).text = text


_CELL_KINDS: dict[str, Callable[[random.Random, Any], None]] = {
    "worksheets": _odd_sheet,
    "tables": _odd_table,
    "sharedStrings.xml": _odd_strings,
}

LEVELS: tuple[tuple[str, Change], ...] = (
    ("zip", _zip_level),
    ("XML", _xml_level),
    ("cell", _cell_level),
)


# --- what is demanded of each -------------------------------------------------------------------


@dataclass(frozen=True)
class Outcome:
    """How one file fared: ``refused``, ``wrong input`` or ``written``, or what is our fault."""

    kind: str
    told: tuple[str, ...] = ()
    fault: str = ""


class _Hangs(BaseException):
    """Raised by the alarm; no handler for ordinary exceptions takes it."""


@contextmanager
def _patience(seconds: float) -> Iterator[list[bool]]:
    """A list that is filled if the alarm rang, even where somebody swallowed it."""
    rang: list[bool] = []
    if sys.platform == "win32":  # no alarm there
        yield rang
        return

    def ring(*_: object) -> None:
        rang.append(True)
        raise _Hangs

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield rang
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


#: Words of Python that no engineer should read.
_PYTHON = re.compile(
    r"Traceback|object at 0x|\b[A-Z]\w*(?:Error|Exception)\b(?!\()|\w+Error\(|NoneType|"
    r"has no attribute|index out of range|not subscriptable|values to unpack|unhashable|"
    r"invalid literal for|could not convert|<class '|<function|(?<!\w)b'|\bin position \d+"
)
LONGEST = 2_000


def sentence_fault(text: str) -> str:
    """Why a message is not a sentence that an engineer can read; empty when it is one."""
    if not re.search(r"[A-Za-z]{2}", text):
        return "says nothing"
    if not text.rstrip().endswith((".", "!", "?", ")")):
        return "ends without a full stop"
    if _PYTHON.search(text):
        return "shows Python"
    if len(text) > LONGEST:
        return f"is {len(text)} characters long"
    odd = [c for c in text if not c.isprintable() and c not in "\n\u00a0"]
    return f"holds {odd[0]!r}" if odd else ""


def verdict_on(data: bytes, suffix: str, folder: Path, patience: float = PATIENCE) -> Outcome:
    """Take one file through the whole path of a recalculation and see that nothing is amiss."""
    from addin.reading.one_file import Unreadable, read_checked
    from addin.writing.recalculate import recalculate

    source, target = folder / f"train{suffix}", folder / f"train.out{suffix}"
    target_json = folder / "train.results.json"
    source.write_bytes(data)
    try:
        with _patience(patience) as rang:
            done = recalculate(source, destination=target, json_file=target_json)
        if rang:
            return Outcome("hang", fault=f"took longer than {patience:g} s")
        fault = _left_behind(source, data, target if done.calculation else None, target_json)
        told = tuple(one.message for one in done.problems)
        for message in (*told, *done.warnings):
            flaw = sentence_fault(message)
            if flaw and not fault:
                fault = f"message {flaw}: {message[:300]!r}"
        if done.calculation is None and not told:
            fault = fault or "nothing was written and nothing was said"
        if done.calculation is not None and not fault:
            with _patience(patience) as rang:
                fault = _reads_back(source, target, suffix)
            fault = "reading back hangs" if rang else fault
        if fault:
            return Outcome("fault", told, fault)
        if done.calculation is not None:
            return Outcome("written", told)
        kind = "refused" if isinstance(read_checked(source), Unreadable) else "wrong input"
        return Outcome(kind, told)
    except _Hangs:
        return Outcome("hang", fault=f"took longer than {patience:g} s")
    except Exception:
        return Outcome("crash", fault=traceback.format_exc(limit=-6))
    finally:
        for path in folder.iterdir():
            path.unlink()


def _left_behind(source: Path, data: bytes, target: Path | None, target_json: Path) -> str:
    """What is in the folder that should not be, or is not as it should be."""
    wanted = {one.name for one in (source, target, target_json) if one is not None}
    there = {path.name for path in source.parent.iterdir()}
    if there != wanted:
        return f"files left or missing: {sorted(there ^ wanted)}"
    if source.read_bytes() != data:
        return "the source was changed"
    try:
        json.loads(target_json.read_text(encoding="utf-8"))
    except ValueError as wrong:
        return f"the JSON is none: {wrong}"
    return ""


def _reads_back(source: Path, target: Path, suffix: str) -> str:
    """Why the written workbook does not open again; empty when it does."""
    from addin.reading.workbook import read_workbook
    from addin.xlsx import PackageError

    try:
        before, after = read_workbook(source), read_workbook(target)
    except PackageError as wrong:
        return f"the written workbook does not open: {wrong}"
    if before.data != after.data and not _calculates_inputs(before):
        return "the written workbook reads otherwise than its source"
    wrong = _openpyxl_says(target)
    # It may stumble over what was odd before; then it stumbled over the source as well.
    return f"openpyxl does not open it: {wrong}" if wrong and not _openpyxl_says(source) else ""


def _calculates_inputs(read: Any) -> bool:
    """Whether an input or its unit is a formula: its value may depend on results, and changes with them."""
    from addin.xlsx.references import Rect, parse_cell

    places = [
        (sheet, Rect(*parse_cell(cell), *parse_cell(cell)))
        for where in (read.locations.scalars, read.locations.units)
        for sheet, cell in where.values()
    ]
    places += [(table.sheet, table.data) for table in read.locations.tables.values()]
    return any(
        rect.has(*formula)
        for sheet, rect in places
        for formula in read.workbook.sheet_part(sheet).formulas
    )


def _openpyxl_says(path: Path) -> str:
    """What openpyxl stumbles over, asked in a process that ends when it takes too much."""
    fork = multiprocessing.get_context("spawn" if sys.platform == "win32" else "fork")
    here, there = fork.Pipe(duplex=False)
    process = fork.Process(target=_open_with_openpyxl, args=(path, there))
    process.start()
    there.close()
    try:
        if not here.poll(30 * OPENPYXL_PATIENCE):  # a busy machine gives it a thirtieth of a core
            return "it waits for ever"
        return str(here.recv())
    except EOFError:
        return "its process ended: it takes too much memory or processor time"
    finally:
        process.kill()
        process.join()
        here.close()


def _open_with_openpyxl(path: Path, answer: Connection) -> None:
    if sys.platform == "linux":
        import resource  # of POSIX

        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + OPENPYXL_MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CPU, (OPENPYXL_PATIENCE, OPENPYXL_PATIENCE))
    answer.send(_stumbles(path))


def _stumbles(path: Path) -> str:
    import openpyxl

    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            openpyxl.load_workbook(path, keep_vba=path.suffix == ".xlsm").close()
    except Exception as wrong:
        return f"{type(wrong).__name__}: {wrong}"
    # A chart that it cannot read it leaves out, and says so.
    return next((str(one.message) for one in told if "Unable to read" in str(one.message)), "")


# --- many of them -------------------------------------------------------------------------------


@dataclass
class Block:
    """What became of a hundred files in a row."""

    first: int
    count: int
    tally: dict[str, int] = field(default_factory=dict)
    faults: list[dict[str, Any]] = field(default_factory=list)
    sha256: str = ""
    seconds: float = 0.0
    slowest: float = 0.0
    most_memory: float = 0.0  # MB, of the process so far


def fuzz(first: int, count: int, run: int = 1) -> Block:
    """Spoil and judge files of consecutive numbers."""
    from addin.workers.processes import most_resident

    block, tally, digest = Block(first, count), Counter[str](), hashlib.sha256()
    began = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        for number in range(first, first + count):
            seed, level, data = mutated(number, run)
            digest.update(data)
            at = time.perf_counter()
            faulthandler.dump_traceback_later(10 * PATIENCE, exit=True)
            found = verdict_on(data, seed.suffix, Path(folder))
            faulthandler.cancel_dump_traceback_later()
            block.slowest = max(block.slowest, time.perf_counter() - at)
            tally[f"{level}: {found.kind}"] += 1
            if found.fault:
                block.faults.append(
                    {"number": number, "seed": seed.name, "level": level, "kind": found.kind,
                     "fault": found.fault}
                )  # fmt: skip
    block.tally = dict(sorted(tally.items()))
    block.sha256 = digest.hexdigest()
    block.seconds = time.perf_counter() - began
    block.most_memory = most_resident() / 2**20
    return block


def _blocks(args: argparse.Namespace) -> list[Block]:
    """All blocks of a run; those of an earlier, stopped run are taken over."""
    args.state.parent.mkdir(parents=True, exist_ok=True)
    done: dict[int, Block] = {}
    if args.state.exists():
        for line in args.state.read_text(encoding="utf-8").splitlines():
            one = Block(**json.loads(line))
            done[one.first] = one
    firsts = list(range(args.first, args.first + args.count, BLOCK))
    left = [first for first in firsts if first not in done]
    with ProcessPoolExecutor(args.jobs) as pool, args.state.open("a", encoding="utf-8") as state:
        ends = args.first + args.count
        sizes = [min(BLOCK, ends - first) for first in left]
        for block in pool.map(fuzz, left, sizes, [args.run] * len(left)):
            done[block.first] = block
            state.write(json.dumps(asdict(block)) + "\n")
            state.flush()
            print(f"… {block.first + block.count}: {block.tally}", file=sys.stderr, flush=True)
            for fault in block.faults:
                print(json.dumps(fault), file=sys.stderr, flush=True)
    return [done[first] for first in firsts]


def _record(blocks: Sequence[Block], args: argparse.Namespace) -> dict[str, Any]:
    from addin.contract.version import product_version

    tally = Counter[str]()
    for block in blocks:
        tally.update(block.tally)
    files = hashlib.sha256("".join(block.sha256 for block in blocks).encode()).hexdigest()
    return {
        "what": "python -m benchmarks.workbook_fuzz",
        "version": product_version(),
        "run": args.run,
        "first": args.first,
        "count": sum(block.count for block in blocks),
        "outcomes": dict(sorted(tally.items())),
        "faults": [fault for block in blocks for fault in block.faults],
        "sha256_of_all_files": files,
        "process_seconds": round(sum(block.seconds for block in blocks), 1),
        "slowest_seconds": round(max(block.slowest for block in blocks), 3),
        "largest_process_mb": round(max(block.most_memory for block in blocks)),
        "seeds": {one.name: hashlib.sha256(one.data).hexdigest() for one in seeds()},
    }


def _only(number: int, run: int) -> None:
    """One file again: keep it and say what becomes of it."""
    seed, level, data = mutated(number, run)
    kept = Path(f"fuzz-{number}{seed.suffix}")
    kept.write_bytes(data)
    with tempfile.TemporaryDirectory() as folder:
        found = verdict_on(data, seed.suffix, Path(folder))
    print(f"{kept}: {seed.name}, {level} level: {found.kind}")
    print("\n".join([*found.told, found.fault]))


def main() -> None:
    """Spoil, judge, keep the record."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.workbook_fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--run", type=int, default=1, help="another run makes other files")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--state", type=Path, default=ROOT / "build" / "fuzz.jsonl")
    parser.add_argument(
        "--record", action="store_true", help=f"add it to {RECORD.name} and docs/safety.md"
    )
    parser.add_argument("--only", type=int, help="one file: keep it and say what becomes of it")
    args = parser.parse_args()
    if args.only is not None:
        _only(args.only, args.run)
        return
    record = _record(_blocks(args), args)
    text = json.dumps(record, indent=1) + "\n"
    print(text)
    if args.record:
        from benchmarks.safety_page import keep_stretch

        keep_stretch(RECORD.name, record)
    sys.exit(1 if record["faults"] else 0)


if __name__ == "__main__":
    main()
