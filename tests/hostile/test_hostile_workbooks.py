"""Workbooks made to do harm: a sentence or an honest result, within bounds that are counted.

Each goes through a whole recalculation in a process of its own. What came out of the archive and
the largest memory are counted there; nothing but the results may be left behind.
"""

import json
import random
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import openpyxl
import pytest
from lxml import etree
from spoiled import (
    MAIN,
    Attended,
    Packed,
    Parts,
    archive,
    changed,
    honest,
    in_cells,
    packed,
    place_of,
    retyped,
    sheet,
)
from strict_workbooks import in_strict_dialect

from addin.xlsx.container import Limits
from benchmarks.workbook_fuzz import seeds, sentence_fault

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")
LIMITS = Limits()
#: The ceiling of the issue [MB]; the process itself, with everything imported, has some 200 of them.
MEMORY = 500.0
PROCESSOR_TIME = 10.0  #: Likewise. [s]


def first_result() -> str:
    part = next(n for n, d in honest().items() if b'displayName="NaturalFrequencies"' in d)
    left, top, _ = own_ref(part)
    return f"Results!{chr(ord(left) + 1)}{int(top) + 1}"


def judged(
    attended: Attended, folder: Path, data: bytes, name: str = "train.xlsx"
) -> dict[str, Any]:
    """What became of a file, after everything that holds for every file was seen to hold."""
    source = folder / name
    source.write_bytes(data)
    said = attended.ask(source)
    assert "crash" not in said, said["crash"]
    assert source.read_bytes() == data
    done = {"done.xlsx"} if said["written"] else set()
    assert {path.name for path in folder.iterdir()} == {name, "done.json"} | done
    for sentence in (*said["told"], *said["warnings"]):
        assert not sentence_fault(sentence), sentence
    assert said["told"] or said["written"]
    assert said["peak_mb"] < MEMORY
    assert said["cpu_s"] < PROCESSOR_TIME
    assert (
        said["inflated"] <= 2 * LIMITS.inflated
    )  # once when read, once when what was written is read back
    return said


def refused(attended: Attended, folder: Path, data: bytes, words: str) -> dict[str, Any]:
    """Refused as a whole, for that reason."""
    said = judged(attended, folder, data)
    assert not said["written"]
    assert re.search(words, " ".join(said["told"])), said["told"]
    return said


def written(attended: Attended, folder: Path, data: bytes) -> dict[str, Any]:
    """Calculated, and the result opens in another program."""
    said = judged(attended, folder, data)
    assert said["written"], said["told"]
    openpyxl.load_workbook(folder / "done.xlsx")
    return said


def test_the_honest_one(attended: Attended, tmp_path: Path) -> None:
    said = written(attended, tmp_path, packed(honest()))
    assert said["inflated"] < 2 * sum(map(len, honest().values()))


def own_ref(part: str) -> tuple[str, str, str]:
    """Left, top and right of a table."""
    found = re.search(r' ref="([A-Z]+)(\d+):([A-Z]+)\d+"', honest()[part].decode())
    assert found
    return found[1], found[2], found[3]


#: A cell that every calculation changes: the first natural frequency.
RESULT = first_result()


# --- the archive --------------------------------------------------------------------------------

ZEROS = bytes(40 * 2**20)


def many_large_parts() -> bytes:
    """Twelve sheets of 20 MB, each packed no better than an ordinary one."""
    parts = [Packed(name.encode(), data) for name, data in honest().items()]
    body = b"".join(b"<!-- %040d -->" % (k * 7919 % 10**9) for k in range(20))
    padded = Packed(b"", body * (20 * 2**20 // len(body)))
    stored = padded.stored()
    workbook = honest()["xl/workbook.xml"]
    links = honest()["xl/_rels/workbook.xml.rels"]
    types = honest()["[Content_Types].xml"]
    for k in range(12):
        name = f"xl/worksheets/big{k}.xml"
        big = Packed(name.encode(), padded.data)
        big.stored = lambda: stored  # type: ignore[method-assign]
        parts.append(big)
        workbook = workbook.replace(
            b"</sheets>",
            b'<sheet name="Big%d" sheetId="%d" r:id="big%d"/></sheets>' % (k, 90 + k, k),
        )
        links = links.replace(
            b"</Relationships>",
            b'<Relationship Id="big%d" Type="http://schemas.openxmlformats.org/officeDocument/2006/'
            b'relationships/worksheet" Target="worksheets/big%d.xml"/></Relationships>' % (k, k),
        )
        types = types.replace(
            b"</Types>",
            b'<Override PartName="/%s" ContentType="application/vnd.openxmlformats-officedocument.'
            b'spreadsheetml.worksheet+xml"/></Types>' % name.encode(),
        )
    new = {
        b"xl/workbook.xml": workbook,
        b"xl/_rels/workbook.xml.rels": links,
        b"[Content_Types].xml": types,
    }
    for one in parts:
        one.data = new.get(one.name, one.data)
    return archive(parts)


def with_entry(*entries: Packed) -> bytes:
    return archive([*(Packed(n.encode(), d) for n, d in honest().items()), *entries])


def sharing_bytes() -> bytes:
    """Two entries of the directory that stand for the same bytes of the file."""
    return with_entry(Packed(b"xl/media/twin.bin", b"", at=0))


ARCHIVES: dict[str, tuple[Callable[[], bytes], str]] = {
    "packed too well": (
        lambda: with_entry(Packed(b"xl/media/a.bin", ZEROS)),
        "as in an attack file",
    ),
    "a size that lies, too small": (
        lambda: archive(
            Packed(
                n.encode(), ZEROS if n == sheet(1) else d, said_size=5000 if n == sheet(1) else None
            )
            for n, d in honest().items()
        ),
        "damaged",
    ),
    "a size that lies, too large": (
        lambda: with_entry(Packed(b"xl/a.bin", b"a", said_size=2**32 - 2)),
        "as in an attack file",
    ),
    "twenty thousand entries": (
        lambda: with_entry(*(Packed(b"a%d" % k, b"") for k in range(20_000))),
        "20[0-9]{3} parts",
    ),
    "entries that share bytes": (sharing_bytes, "inside another one|has two different names"),
    "an entry in the directory only": (
        lambda: with_entry(Packed(b"xl/a.bin", b"a", at=10**8)),
        "at a wrong position in the file",
    ),
    "packed as no workbook is": (
        lambda: with_entry(Packed(b"xl/a.bin", b"a", said_method=12)),
        "uses a compression",
    ),
    "twelve sheets of 20 MB": (many_large_parts, "would unpack to more than"),
}


@pytest.mark.parametrize("name", ARCHIVES)
def test_archives(attended: Attended, tmp_path: Path, name: str) -> None:
    make, words = ARCHIVES[name]
    said = refused(attended, tmp_path, make(), words)
    assert said["inflated"] <= LIMITS.inflated


def test_archives_within_archives_stay_packed(attended: Attended, tmp_path: Path) -> None:
    inner = packed({"x.bin": bytes(1000)})
    for _ in range(20):
        inner = packed(
            {f"{k}.zip": inner for k in range(3)} if len(inner) < 10**5 else {"a.zip": inner}
        )
    data = with_entry(Packed(b"xl/embeddings/inner.zip", inner))
    said = written(attended, tmp_path, data)
    assert said["inflated"] < 2 * sum(map(len, honest().values()))


@pytest.mark.parametrize(
    "name",
    ["../evil.xml", "xl\\..\\..\\evil.xml", "/etc/passwd", "C:\\evil.xml", "\\evil.xml", "xl/a\0b.xml",
     "file:///evil"],
)  # fmt: skip
def test_parts_that_point_elsewhere(attended: Attended, tmp_path: Path, name: str) -> None:
    refused(
        attended,
        tmp_path,
        with_entry(Packed(name.encode(), b"<a/>")),
        "points outside the workbook",
    )


@pytest.mark.parametrize("name", ["xl/workbook.xml", "XL\\Workbook.XML", "[content_types].xml"])
def test_parts_that_are_there_twice(attended: Attended, tmp_path: Path, name: str) -> None:
    refused(attended, tmp_path, with_entry(Packed(name.encode(), b"<a/>")), "twice")


def test_cut_off_anywhere(tmp_path: Path) -> None:
    from addin.reading.one_file import Unreadable, read_checked

    data = packed(honest())
    source = tmp_path / "train.xlsx"
    for size in range(0, len(data), len(data) // 150):
        source.write_bytes(data[:size])
        read = read_checked(source)
        assert isinstance(read, Unreadable), size
        assert not sentence_fault(read.problems[0].message)


# --- XML ----------------------------------------------------------------------------------------


def bomb(canary: Path) -> bytes:
    """Nine levels of ten, and a file of this machine."""
    lines = [b'<!ENTITY l0 "lol">']
    lines += [b'<!ENTITY l%d "%s">' % (k, b"&l%d;" % (k - 1) * 10) for k in range(1, 10)]
    lines += [b'<!ENTITY file SYSTEM "%s">' % canary.as_uri().encode()]
    return b"<!DOCTYPE x [" + b"".join(lines) + b"]>"


PARTS = [name for name in seeds()[0].parts if name.endswith((".xml", ".rels", ".vml"))]


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_entities_in_every_part(attended: Attended, tmp_path: Path, encoding: str) -> None:
    """A part that is read is refused; one that is not stays as it is and nothing of it is followed."""
    canary = tmp_path / "canary.txt"
    canary.write_text("the canary's own words", encoding="utf-8")
    names = PARTS if encoding == "utf-8" else PARTS[:: len(PARTS) // 8]
    untouched = []
    for number, name in enumerate(names):
        parts = honest()
        text = re.sub(rb"\A<\?xml[^>]*\?>\s*", b"", parts[name])
        end = text.rindex(b"</") if b"</" in text else len(text)
        text = bomb(canary) + text[:end] + b"&l9;&file;" + text[end:]
        parts[name] = text.decode().encode(encoding)
        folder = tmp_path / f"{number}"
        folder.mkdir()
        said = judged(attended, folder, packed(parts))
        if said["written"]:
            untouched.append(name)
            with zipfile.ZipFile(folder / "done.xlsx") as done:
                assert done.read(name) == parts[name]
                assert all(b"canary's own" not in done.read(other) for other in done.namelist())
        else:
            assert "document type declaration" in said["told"][0], (name, said["told"])
        assert "canary's own" not in json.dumps(said)
    assert not [
        n
        for n in untouched
        if re.search(r"sheet[1-4]\.xml$|workbook|Content|tables|styles|shared", n)
    ]


DEPTH = 20_000
NESTED = b"<x>" * DEPTH + b"</x>" * DEPTH


@pytest.mark.parametrize("part", ["xl/workbook.xml", sheet(2), "xl/styles.xml", "_rels/.rels"])
def test_deep_nesting(attended: Attended, tmp_path: Path, part: str) -> None:
    parts = changed(
        part, lambda data: data[: data.rindex(b"</")] + NESTED + data[data.rindex(b"</") :]
    )
    refused(attended, tmp_path, packed(parts), "not well-formed XML")


@pytest.mark.parametrize(
    ("part", "piece"),
    [
        (sheet(3), b"<row "),
        (sheet(3), b'<row hidden="1" '),
        (sheet(3), b"<tableParts "),
        ("xl/workbook.xml", b"<calcPr "),
        ("xl/tables/table14.xml", b"<calculatedColumnFormula>"),
    ],
)
def test_tags_in_comments(attended: Attended, tmp_path: Path, part: str, piece: bytes) -> None:
    """A search that followed each of them to the end of the part would take hours."""
    comment = b"<!--" + piece * 100_000 + b"-->"
    parts = changed(part, lambda data: data.replace(b"?>", b"?>" + comment, 1))
    written(attended, tmp_path, packed(parts))
    with zipfile.ZipFile(tmp_path / "done.xlsx") as done:
        root = etree.fromstring(done.read("xl/workbook.xml"))
    assert root.find(f"{{{root.nsmap[None]}}}calcPr").get("fullCalcOnLoad") == "1"


# --- parts that are missing or say what they are not ---------------------------------------------

NEEDED = [
    "[Content_Types].xml", "_rels/.rels", "xl/workbook.xml", "xl/_rels/workbook.xml.rels", sheet(1), sheet(2),
    "xl/sharedStrings.xml", "xl/tables/table1.xml", "xl/tables/table14.xml",
]  # fmt: skip


@pytest.mark.parametrize("name", NEEDED)
def test_needed_parts_that_are_missing(attended: Attended, tmp_path: Path, name: str) -> None:
    parts = honest()
    del parts[name]
    refused(attended, tmp_path, packed(parts), "lacks the part|not an Excel workbook")


@pytest.mark.slow
@pytest.mark.parametrize("name", PARTS)
def test_any_part_that_is_missing(attended: Attended, tmp_path: Path, name: str) -> None:
    parts = honest()
    del parts[name]
    judged(attended, tmp_path, packed(parts))


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "kind", ["worksheet+xml", "table+xml", "sharedStrings+xml", "styles+xml", "drawingml.chart+xml"]
)
@pytest.mark.parametrize(
    "other", ["image/png", "application/vnd.ms-excel.sheet.binary.macroEnabled.main", ""]
)
def test_parts_of_the_wrong_type(attended: Attended, tmp_path: Path, kind: str, other: str) -> None:
    """Parts are found by relationships, as spreadsheet programs do; types of their own do no harm."""
    parts = changed(
        "[Content_Types].xml",
        lambda data: re.sub(
            rb'ContentType="[^"]*' + re.escape(kind).encode() + b'"',
            b'ContentType="%s"' % other.encode(),
            data,
        ),
    )
    judged(attended, tmp_path, packed(parts))


@pytest.mark.parametrize(
    "one", [sheet(1), "xl/styles.xml", "xl/sharedStrings.xml", "xl/tables/table1.xml"]
)
@pytest.mark.parametrize("other", ["xl/theme/theme1.xml", sheet(2), "xl/workbook.xml"])
def test_parts_in_each_others_place(
    attended: Attended, tmp_path: Path, one: str, other: str
) -> None:
    parts = honest()
    parts[one], parts[other] = parts[other], parts[one]
    said = judged(attended, tmp_path, packed(parts))
    assert not said["written"] or one == "xl/styles.xml", said


# --- sizes --------------------------------------------------------------------------------------


def test_a_cell_in_the_last_corner(attended: Attended, tmp_path: Path) -> None:
    for number in (1, 2, 3, 4):
        row = b'<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>'
        folder = tmp_path / f"{number}"
        folder.mkdir()
        said = written(attended, folder, packed(in_cells(row, number)))
        assert said["inflated"] < 2 * sum(map(len, honest().values())) + 1000


LONG = b"x" * (10 * 2**20)
TITLE = place_of("Title")


def long_string(place: str, text: bytes) -> Parts:
    inline = b"<is><t>" + text + b"</t></is>"
    return {
        "shared string": lambda: changed(
            "xl/sharedStrings.xml",
            lambda data: re.sub(rb"<t>Small train</t>", b"<t>" + text + b"</t>", data),
        ),
        "title": lambda: retyped(1, TITLE, inline, "inlineStr"),
        "cell nobody reads": lambda: in_cells(
            b'<row r="99"><c r="A99" t="inlineStr">' + inline + b"</c></row>"
        ),
        "formula": lambda: in_cells(
            b'<row r="99"><c r="A99"><f>"' + text + b'"&amp;A1</f><v>0</v></c></row>'
        ),
        "defined name": lambda: changed(
            "xl/workbook.xml",
            lambda data: data.replace(
                b"</definedNames>",
                b'<definedName name="Long">"' + text + b'"</definedName></definedNames>',
            ),
        ),
        "name of a table": lambda: changed(
            "xl/tables/table1.xml",
            lambda data: re.sub(rb'displayName="[^"]*"', b'displayName="' + text + b'"', data),
        ),
        "name of a sheet": lambda: changed(
            "xl/workbook.xml",
            lambda data: re.sub(rb'<sheet name="Owner[^"]*"', b'<sheet name="' + text + b'"', data),
        ),
    }[place]()


@pytest.mark.parametrize(
    "place",
    ["shared string", "title", "cell nobody reads", "formula", "defined name", "name of a table",
     "name of a sheet"],
)  # fmt: skip
@pytest.mark.parametrize("size", [9 * 2**20, 10 * 2**20])
def test_strings_of_ten_megabytes(
    attended: Attended, tmp_path: Path, place: str, size: int
) -> None:
    """The XML parser takes 10,000,000 bytes in one text: one size below, one above."""
    said = judged(attended, tmp_path, packed(long_string(place, LONG[:size])))
    if said["written"]:
        openpyxl.load_workbook(tmp_path / "done.xlsx")
        assert (tmp_path / "done.json").stat().st_size < 10**6


ROWS = 1_000_000


def million(kind: str) -> Parts:
    numbers = range(100, ROWS + 100)
    if kind == "rows":
        return in_cells(b"".join(b'<row r="%d"/>' % k for k in numbers))
    if kind == "cells":
        return in_cells(
            b"".join(b'<row r="%d"><c><v>%d</v></c></row>' % (k, k) for k in numbers), 2
        )
    if kind == "shared formulas":
        cells = (
            b'<row r="%d"><c r="A%d"><f t="shared" si="0"/></c></row>' % (k, k) for k in numbers
        )
        first = b'<row r="99"><c r="A99"><f t="shared" ref="A99:A%d" si="0">A1+1</f></c></row>' % (
            ROWS + 99
        )
        return in_cells(first + b"".join(cells))
    if kind == "merged ranges":
        merged = b"".join(b'<mergeCell ref="H%d:I%d"/>' % (k, k) for k in numbers)
        return changed(
            sheet(2),
            lambda data: data.replace(
                b"</sheetData>", b"</sheetData><mergeCells>" + merged + b"</mergeCells>"
            ),
        )
    if kind == "styles":
        return changed(
            "xl/styles.xml",
            lambda data: data.replace(b"</cellXfs>", b'<xf numFmtId="14"/>' * ROWS + b"</cellXfs>"),
        )
    if kind == "shared strings":
        return changed(
            "xl/sharedStrings.xml",
            lambda data: data.replace(b"</sst>", b"<si><t>a</t></si>" * ROWS + b"</sst>"),
        )
    assert kind == "defined names"
    names = b"".join(b'<definedName name="n%d">1</definedName>' % k for k in numbers)
    return changed(
        "xl/workbook.xml", lambda data: data.replace(b"</definedNames>", names + b"</definedNames>")
    )


MILLIONS = [
    "rows",
    "cells",
    "shared formulas",
    "merged ranges",
    "styles",
    "shared strings",
    "defined names",
]


@pytest.mark.slow
@pytest.mark.parametrize("kind", MILLIONS)
def test_a_million_of_them(attended: Attended, tmp_path: Path, kind: str) -> None:
    refused(
        attended,
        tmp_path,
        packed(million(kind)),
        "exceeds about [13]00,000 |as in an attack file",
    )


@pytest.mark.parametrize("kind", ["defined names", "merged ranges", "texts"])
def test_what_takes_more_memory_than_cells(
    attended: Attended, tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """600,000 names took 1.3 GB, 800,000 merged ranges 1.0 GB, 48 MB of texts 593 MB."""
    monkeypatch.setitem(globals(), "ROWS", {"defined names": 600_000}.get(kind, 800_000))
    words = "exceeds about 100,000 defined names, merged ranges"
    if kind == "texts":
        texts = b"".join(b"<si><t>%01000d</t></si>" % k for k in range(48_000))
        parts = changed(
            "xl/sharedStrings.xml", lambda data: data.replace(b"</sst>", texts + b"</sst>")
        )
        words = "more than 32 MB of texts"
    said = refused(attended, tmp_path, packed(million(kind) if kind != "texts" else parts), words)
    assert said["peak_mb"] < MEMORY / 2


@pytest.mark.slow
@pytest.mark.parametrize("kind", MILLIONS)
def test_as_many_as_are_taken(
    attended: Attended, tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Somewhat below the limit they are worked through within the same memory."""
    most = {"defined names": 95_000, "merged ranges": 130_000, "shared strings": 600_000}
    most |= {"rows": 300_000, "shared formulas": 90_000}
    monkeypatch.setitem(globals(), "ROWS", most.get(kind, 60_000))
    judged(attended, tmp_path, packed(million(kind)))


def formulas(count: int, text: Callable[[int], str]) -> bytes:
    """Rows with a formula each that adds something to a result."""
    return b"".join(
        f'<row r="{k}"><c r="H{k}"><f>{RESULT}+{text(k)}</f><v>1</v></c></row>'.encode()
        for k in range(300, 300 + count)
    )


def rows_of_ten(count: int) -> bytes:
    """So many cells."""
    rows = range(40_000, 40_000 + count // 10)
    return b"".join(
        b'<row r="%d">' % k
        + b"".join(b'<c r="%c%d"><v>%d</v></c>' % (c, k, k) for c in b"ABCDEFGHIJ")
        + b"</row>"
        for k in rows
    )


def shared_formula() -> Parts:
    """Of 24,000,000 characters in a file of 100 kB."""
    text = f"{RESULT}+" + "+".join(f"A{k}" for k in range(1, 1500))
    first = f'<row r="299"><c r="H299"><f t="shared" ref="H299:H4299" si="0">{text}</f></c></row>'
    others = (
        f'<row r="{k}"><c r="H{k}"><f t="shared" si="0"/><v>1</v></c></row>'
        for k in range(300, 4300)
    )
    return in_cells((first + "".join(others)).encode())


def long_texts(megabytes: int) -> bytes:
    rows = (
        b'<row r="%d"><c r="H%d" t="inlineStr"><is><t>%s</t></is></c></row>'
        % (k, k, b"x%d" % (k * 7919) * 1000)
        for k in range(300, 300 + megabytes * 125)
    )
    return b"".join(rows)


#: How each is made, what is said of it, and how much memory and processor time it took when nothing bounded it. [MB], [s]
COSTLY: dict[str, tuple[Callable[[], Parts], str, int, int]] = {
    "formulas of 430 characters": (
        lambda: in_cells(formulas(48_000, lambda k: "+".join(f"{k * 7919 + j}" for j in range(40)))),
        "too many to follow here", 1004, 13,
    ),
    "formulas of many cells": (
        lambda: in_cells(formulas(20_000, lambda k: "+".join(f"A{k % 9 + j}" for j in range(75)))),
        "too many to follow here", 1023, 10,
    ),
    "a shared formula": (shared_formula, "too many to follow here", 688, 25),
    "formulas of other cells each": (
        lambda: in_cells(formulas(750, lambda k: "+".join(f"A{k * 600 + j}" for j in range(600)))),
        "", 449, 25,
    ),
    "long texts": (
        lambda: in_cells(long_texts(85) + formulas(1, str).replace(b"300", b"99999")),
        "what takes as much memory in long texts", 702, 5,
    ),
    "pictures and rows": (
        lambda: million("rows") | {"xl/media/a.bin": random.Random(1).randbytes(90 * 2**20)},
        "what takes as much memory in long texts", 675, 3,
    ),
    "formulas of other cells and pictures": (
        lambda: in_cells(formulas(750, lambda k: "+".join(f"A{k * 600 + j}" for j in range(600))))
        | {"xl/media/a.bin": random.Random(1).randbytes(95 * 2**20)},
        "too many to follow here", 540, 9,
    ),
    "formulas and cells": (
        lambda: in_cells(formulas(10_000, lambda k: "+".join(f"A{k % 9 + j}" for j in range(75))) + rows_of_ten(150_000)),
        "too many to follow here", 584, 4,
    ),
    "pictures": (
        lambda: honest() | {"xl/media/a.bin": random.Random(1).randbytes(95 * 2**20)}, "", 465, 2,
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", COSTLY)
def test_what_takes_memory_and_time_beside_cells(
    attended: Attended, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(globals(), "ROWS", 290_000)
    make, words, *_ = COSTLY[name]
    said = judged(attended, tmp_path, packed(make()))
    assert words in " ".join((*said["told"], *said["warnings"]))


def filled(piece: bytes, size: int) -> bytes:
    """A piece again and again with other numbers, which no archive packs too well."""
    count = size // len(piece)
    return b"".join(piece.replace(b"##", b"%02d" % (k * 7919 % 100)) for k in range(count))


def strict(parts: Parts) -> Parts:
    return {name: in_strict_dialect(name, data) for name, data in parts.items()}


STRICT_PIECES = {
    "percentages": b'<a a="##%"/>',
    "names": b'<a b="##" x="http://purl.oclc.org/ooxml/a/b"/>',
    "dates": b'<c t="d"><v>2000-01-##</v></c>',
    "dates without value": b'<c t="d" r="##"><v/>',
    "brackets": b"<<<<<<<<##",
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", STRICT_PIECES)
@pytest.mark.parametrize("megabytes", [3, 30])
def test_strict_workbooks_of_one_thing(
    attended: Attended, tmp_path: Path, kind: str, megabytes: int
) -> None:
    """All of such a workbook is gone through; 30 MB of percentages took 1.2 GB and 8 s beside everything else."""
    family = b"drawingml" if kind == "percentages" else b"spreadsheetml"
    start = b'<a x="http://purl.oclc.org/ooxml/%s/main">' % family
    parts = honest() | {"xl/x.xml": start + filled(STRICT_PIECES[kind], megabytes * 2**20)}
    said = judged(attended, tmp_path, packed(strict(parts)))
    assert said["cpu_s"] < PROCESSOR_TIME / 2
    if megabytes == 30:
        assert "more than about 300,000 cells of it. Save it as the ordinary" in said["told"][0]


@pytest.mark.slow
def test_a_large_strict_workbook(attended: Attended, tmp_path: Path) -> None:
    """It is there three times: 560 MB."""
    parts = honest() | {"xl/media/a.bin": random.Random(1).randbytes(95 * 2**20)}
    written(attended, tmp_path, packed(strict(parts)))


# --- tables, names, formulas --------------------------------------------------------------------


def table_ref(ref: str, part: str = "xl/tables/table1.xml") -> Parts:
    return changed(
        part, lambda data: re.sub(rb' ref="[^"]*"', b' ref="%s"' % ref.encode(), data, count=1)
    )


@pytest.mark.parametrize(
    ("ref", "words"),
    [
        ("B4:ZZZ9999999", "not a valid range"),
        ("B4:A1048577", "not a valid range"),
        ("", "not a valid range"),
        ("A1 B2", "not a valid range"),
        ("B4:C6", "columns but covers"),
    ],
)
def test_tables_that_lie_about_their_size(
    attended: Attended, tmp_path: Path, ref: str, words: str
) -> None:
    refused(attended, tmp_path, packed(table_ref(ref)), words)


def test_a_table_without_rows(attended: Attended, tmp_path: Path) -> None:
    left, top, right = own_ref("xl/tables/table1.xml")
    refused(attended, tmp_path, packed(table_ref(f"{left}{top}:{right}{top}")), "has no data row")


def test_a_table_over_its_neighbours(attended: Attended, tmp_path: Path) -> None:
    left, top, right = own_ref("xl/tables/table1.xml")
    refused(attended, tmp_path, packed(table_ref(f"{left}{top}:{right}1048576")), "overlap")


def test_a_result_table_to_the_end_of_the_sheet(attended: Attended, tmp_path: Path) -> None:
    """The last one of its sheet: nobody is in its way, and only rows that are there are gone through."""
    parts = honest()
    last = max(
        (name for name in parts if name.startswith("xl/tables/")),
        key=lambda name: (
            int(own_ref(name)[1]) if b"Audit" in parts[name] or b"Verdicts" in parts[name] else -1
        ),
    )
    left, top, right = own_ref(last)
    written(attended, tmp_path, packed(table_ref(f"{left}{top}:{right}1048576", last)))


def test_two_tables_of_one_name(attended: Attended, tmp_path: Path) -> None:
    parts = changed("xl/tables/table2.xml", lambda data: data.replace(b'"Elements"', b'"STATIONS"'))
    refused(attended, tmp_path, packed(parts), "two tables named")


def names(*pairs: tuple[str, str]) -> Parts:
    text = "".join(f'<definedName name="{name}">{of}</definedName>' for name, of in pairs)
    return changed(
        "xl/workbook.xml",
        lambda data: data.replace(b"</definedNames>", text.encode() + b"</definedNames>"),
    )


def test_names_that_lead_in_circles(attended: Attended, tmp_path: Path) -> None:
    """Two names, each of them eight times the other: followed blindly, 8^20 steps."""
    parts = names(("Loop", "+".join(["Loup"] * 8)), ("Loup", "+".join(["Loop"] * 8)), ("Me", "Me"))
    formulas = f'<row r="99"><c r="A99"><f>Loop+Me+{RESULT}</f><v>1</v></c></row>'.encode()
    parts[sheet(4)] = parts[sheet(4)].replace(b"</sheetData>", formulas + b"</sheetData>")
    written(attended, tmp_path, packed(parts))
    cell = openpyxl.load_workbook(tmp_path / "done.xlsx", data_only=True)["Owner's notes"]["A99"]
    assert cell.value is None  # blank beats wrong


def test_an_input_that_is_a_circle_of_names(attended: Attended, tmp_path: Path) -> None:
    parts = changed(
        "xl/workbook.xml",
        lambda data: re.sub(rb'(name="LineFrequency">)[^<]*', rb"\1SynchronousSpeed", data),
    )
    refused(attended, tmp_path, packed(parts), "refers to no cell")


def test_formulas_in_circles(attended: Attended, tmp_path: Path) -> None:
    rows = (
        f'<row r="98"><c r="A98"><f>A99+{RESULT}</f><v>7</v></c></row>'
        '<row r="99"><c r="A99"><f>A98+1</f><v>7</v></c></row>'
    )
    written(attended, tmp_path, packed(in_cells(rows.encode())))
    notes = openpyxl.load_workbook(tmp_path / "done.xlsx", data_only=True)["Owner's notes"]
    assert notes["A98"].value is None
    assert notes["A99"].value is None


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "formula",
    ["(" * 4000 + "A1" + ")" * 4000, "-" * 8000 + "A1", "A1" + "+A1" * 2000, "[" * 8000, "'" * 8001,
     "IF(" * 1500 + "A1" + ")" * 1500, "{" * 4000, '"' * 4001, "1" * 8000, "SUM(A:XFD)", "A1:XFD1048576*2"],
    ids=lambda text: text[:12] + str(len(text)),
)  # fmt: skip
def test_formulas_that_break_calculators(attended: Attended, tmp_path: Path, formula: str) -> None:
    text = formula.replace("A1", RESULT).replace('"', "&quot;").encode()
    rows = b"".join(
        b'<row r="%d"><c r="A%d"><f>%s</f><v>7</v></c></row>' % (k, k, text) for k in range(99, 119)
    )
    judged(attended, tmp_path, packed(in_cells(rows)))


def test_array_over_the_whole_sheet(attended: Attended, tmp_path: Path) -> None:
    rows = f'<row r="99"><c r="F99"><f t="array" ref="F99:XFD1048576">{RESULT}:{RESULT}*2</f></c></row>'
    written(attended, tmp_path, packed(in_cells(rows.encode())))


def test_charts_of_whole_sheets(attended: Attended, tmp_path: Path) -> None:
    parts = changed(
        "xl/charts/chart1.xml",
        lambda data: re.sub(rb"<c:f>[^<]*</c:f>", b"<c:f>Results!$A$1:$XFD$1048576</c:f>", data),
    )
    said = written(attended, tmp_path, packed(parts))
    assert (tmp_path / "done.xlsx").stat().st_size < 10**6, said


STARTS = ["=cmd|' /C calc'!A0", "+1+1", "-2", "@SUM(1)", "\t=1", '=HYPERLINK("http://x")', "'=1"]


@pytest.mark.parametrize("name", STARTS)
def test_names_that_look_like_formulas_stay_text(
    attended: Attended, tmp_path: Path, name: str
) -> None:
    """A station and an element of such a name, out into result sheets and JSON: never a formula."""
    parts = changed(
        "xl/sharedStrings.xml",
        lambda data: re.sub(
            rb"<t>(Motor|Coupling)</t>",
            lambda found: f'<t xml:space="preserve">{escape(name)}</t>'.encode(),
            data,
        ),
    )
    written(attended, tmp_path, packed(parts))
    done = openpyxl.load_workbook(tmp_path / "done.xlsx")["Results"]
    cells = [cell for line in done.iter_rows() for cell in line if cell.value is not None]
    shown = [cell for cell in cells if str(cell.value) == name.strip()]
    assert shown
    assert not [cell for cell in cells if cell.data_type == "f"]
    assert name.strip() in json.dumps(
        json.loads((tmp_path / "done.json").read_text("utf-8"))
    ).replace('\\"', '"')


# --- other files --------------------------------------------------------------------------------


def test_links_to_other_files_are_not_followed(attended: Attended, tmp_path: Path) -> None:
    canary = tmp_path / "secret.xlsx"
    canary.write_bytes(
        packed(retyped(1, TITLE, b"<is><t>the canary's own words</t></is>", "inlineStr"))
    )
    folder = tmp_path / "here"
    folder.mkdir()
    parts = honest()
    parts["xl/externalLinks/externalLink1.xml"] = (
        f'<externalLink {MAIN}><externalBook xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/'
        'relationships" r:id="rId1"><sheetNames><sheetName val="Case"/></sheetNames></externalBook></externalLink>'
    ).encode()
    parts["xl/externalLinks/_rels/externalLink1.xml.rels"] = (
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" '
        'Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/externalLinkPath" '
        f'Target="{canary.as_uri()}" TargetMode="External"/></Relationships>'
    ).encode()
    parts["xl/_rels/workbook.xml.rels"] = parts["xl/_rels/workbook.xml.rels"].replace(
        b"</Relationships>",
        b'<Relationship Id="ext" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/'
        b'externalLink" Target="externalLinks/externalLink1.xml"/></Relationships>',
    )
    parts["xl/workbook.xml"] = parts["xl/workbook.xml"].replace(
        b"</sheets>",
        b'</sheets><externalReferences><externalReference r:id="ext"/></externalReferences>',
    )
    parts["[Content_Types].xml"] = parts["[Content_Types].xml"].replace(
        b"</Types>",
        b'<Override PartName="/xl/externalLinks/externalLink1.xml" ContentType="application/vnd.openxmlformats-'
        b'officedocument.spreadsheetml.externalLink+xml"/></Types>',
    )
    rows = f'<row r="99"><c r="A99"><f>[1]Case!{TITLE}&amp;{RESULT}</f><v>7</v></c></row>'.encode()
    parts[sheet(4)] = parts[sheet(4)].replace(b"</sheetData>", rows + b"</sheetData>")
    written(attended, folder, packed(parts))
    for path in (folder / "done.xlsx", folder / "done.json"):
        assert b"canary's own" not in path.read_bytes()
    done = openpyxl.load_workbook(folder / "done.xlsx", data_only=True)["Owner's notes"]
    assert done["A99"].value is None


# --- cells --------------------------------------------------------------------------------------

UNITS = [
    "m**999999999", "1e400*m", "m" + "*m" * 5000, "kg^9^9^9", "(" * 5000, "lbf*in/rad" * 500, "١٠^٢*m",
    "10^99*lbf*in/rad", "\U0001d7d9", "__import__('os')", "{0.__class__}", "%s" * 20, "N*m/rad; DROP", "e" * 60,
    "m" * 59, "((((((((((m^9)^9)))))))))", "delta_degC", "dB", "degC",
]  # fmt: skip
NUMBERS = [
    "1e308",
    "-1e308",
    "1e-320",
    "NaN",
    "INF",
    "-INF",
    "1e999",
    "1_000",
    "١٢٣",
    "0x10",
    "1" * 5000,
]


def stiffness_cells() -> tuple[str, str]:
    """Unit and value of the stiffness of the first element."""
    from addin.contract.tables import input_table

    left, top, _ = own_ref("xl/tables/table2.xml")
    at = [column.name for column in input_table("Elements").columns].index("Stiffness")
    letter = openpyxl.utils.get_column_letter(openpyxl.utils.column_index_from_string(left) + at)
    return f"{letter}{int(top) - 1}", f"{letter}{int(top) + 1}"


@pytest.mark.parametrize("unit", UNITS, ids=lambda text: text[:12])
def test_units(attended: Attended, tmp_path: Path, unit: str) -> None:
    inline = f"<is><t>{unit}</t></is>".encode()
    parts = retyped(2, stiffness_cells()[0], inline, "inlineStr")
    said = judged(attended, tmp_path, packed(parts))
    assert said["written"] or "Stiffness" in said["told"][0], said
    # Only this one is a stiffness, of a size no train has.
    assert not said["written"], said


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("kind", ["n", "str", "b", "d", "e"])
@pytest.mark.parametrize("number", NUMBERS, ids=lambda text: text[:12])
def test_numbers(attended: Attended, tmp_path: Path, number: str, kind: str) -> None:
    parts = retyped(2, stiffness_cells()[1], f"<v>{number}</v>".encode(), kind)
    said = judged(attended, tmp_path, packed(parts))
    assert not said["written"], "a stiffness of that kind is none"
    assert any("Stiffness" in one for one in said["told"]), said


# --- what the fuzzer found, one by one ------------------------------------------------------------

DAMAGES = [
    (sheet(2), rb"</sheetData>", b'</sheetData><mergeCells><mergeCell ref="A1 B2"/></mergeCells>', "merged range .* not a valid range"),
    (sheet(2), rb"</sheetData>", b"</sheetData><mergeCells><mergeCell/></mergeCells>", "merged range .* not a valid range"),
    (sheet(4), rb'<f t="array" ref="[^"]*"', b'<f t="array" ref="ZZZZ9"', "array formula .* not a valid range"),
    (sheet(2), rb'<row r="4"', b'<row r="NaN"', "rows of sheet Train after row 3 are out of order"),
    (sheet(2), rb'<row r="4"', "<row r='\u0664'".encode(), "rows of sheet Train after row 3 are out of order"),
    (sheet(2), rb'<row r="4"', b'<row r="1048577"', "rows of sheet Train after row 3 are out of order"),
    (sheet(2), rb'<row r="4"', b'<row r="1"', "rows of sheet Train after row 3 are out of order"),
    (sheet(2), rb'<c r="D5"', b'<c r="A5"', "wrongly placed cell .* in row 5"),
    (sheet(2), rb'<c r="D5"', b'<c r="D6"', "wrongly placed cell .* in row 5"),
    (sheet(2), rb'<c r="D5"', b'<c r="XFE5"', "wrongly placed cell .* in row 5"),
    (sheet(3), rb"<sheetData>", b'<cols><col min="x" max="3"/></cols><sheetData>', "width of columns beyond the end of a sheet"),
    (sheet(2), rb'(<c r="B5"[^>]*t="s"><v>)\d+', rb"\g<1>-1", "shared text '-1'"),
    (sheet(2), rb'(<c r="B5"[^>]*t="s"><v>)\d+', rb"\g<1>99999", "shared text '99999'"),
    ("xl/workbook.xml", rb'<sheet name="Train"', b'<sheet name="CASE"', "two sheets of the same name"),
    ("xl/workbook.xml", rb'<sheet name="Train"', b"<sheet", "two sheets of the same name, or one without"),
    ("xl/tables/table1.xml", rb' (displayName|name)="Stations"', b"", "has no name|no table of this name"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("part", "old", "new", "words"), DAMAGES, ids=lambda value: str(value)[-30:]
)
def test_damages(
    attended: Attended, tmp_path: Path, part: str, old: bytes, new: bytes, words: str
) -> None:
    count = 0 if part.startswith("xl/tables") else 1
    parts = changed(part, lambda data: re.sub(old, new, data, count=count))
    refused(attended, tmp_path, packed(parts), words)


ODDITIES = [
    (
        "xl/workbook.xml",
        rb'<definedName name="Title"',
        b'<definedName localSheetId="-1" name="x">1</definedName>\\g<0>',
    ),
    ("xl/styles.xml", rb'<cellXfs[^>]*><xf numFmtId="0"', b'<cellXfs><xf numFmtId="1e3"'),
    (sheet(4), rb'<c r="A4"', b'<c s="-1" r="A4"'),
    ("xl/charts/chart1.xml", b"<c:numCache>", b'<c:numCache><c:pt idx="points-7"/>'),
]


@pytest.mark.parametrize(("part", "old", "new"), ODDITIES, ids=lambda value: str(value)[-30:])
def test_oddities_that_do_no_harm(
    attended: Attended, tmp_path: Path, part: str, old: bytes, new: bytes
) -> None:
    said = judged(
        attended, tmp_path, packed(changed(part, lambda data: re.sub(old, new, data, count=1)))
    )
    assert said["written"], said


def test_a_style_that_breaks_out_of_its_attribute(attended: Attended, tmp_path: Path) -> None:
    """Styles of result cells are written again; what is no number must not become cells."""
    row, column = RESULT.partition("!")[2][1:], RESULT.partition("!")[2][0]
    evil = b"0&quot;&gt;&lt;f&gt;1+1&lt;/f&gt;&lt;/c&gt;&lt;c s=&quot;0"
    name = column + row
    cell = f'<c r="{name}" s="'.encode() + evil + b'"/>'
    parts = changed(
        sheet(3), lambda data: data.replace(b"</sheetData>", b'<row r="%d">%s</row></sheetData>' % (int(row), cell))
    )  # fmt: skip
    said = judged(attended, tmp_path, packed(parts))
    if said["written"]:
        with zipfile.ZipFile(tmp_path / "done.xlsx") as done:
            assert b"1+1</f>" not in done.read(sheet(3))


@pytest.mark.parametrize("number", [2, 3, 4], ids=["inputs", "results", "the owner's"])
def test_a_sheet_merged_as_a_whole(attended: Attended, tmp_path: Path, number: int) -> None:
    """No object a cell is made of it: fuzzer's number 20,033, where openpyxl does."""
    whole = b'<mergeCell ref="A1:XFD1048576"/><mergeCell ref="XFE1"/>'
    if number < 4:
        whole = b'<mergeCell ref="A1:XFD1048576"/>'
    parts = changed(
        sheet(number),
        lambda data: (
            data.replace(b"</mergeCells>", whole + b"</mergeCells>")
            if b"</mergeCells>" in data
            else data.replace(
                b"</sheetData>", b"</sheetData><mergeCells>" + whole + b"</mergeCells>"
            )
        ),
    )
    said = judged(attended, tmp_path, packed(parts))
    assert said["written"] == (number == 4)
    assert said["peak_mb"] < MEMORY / 2
    told = {2: "the cells A1:XFD1048576 are merged", 3: "a merged range"}
    assert told.get(number, "") in " ".join(said["told"])


def test_inputs_that_cannot_be_calculated_again_are_named(
    attended: Attended, tmp_path: Path
) -> None:
    """Fuzzer's number 20,578: a unit was gone from the written workbook, and nobody told."""
    broken = b"<f>Stations[</f>"
    data = retyped(2, "D3", broken + b"<v>lb*ft^2</v>", "str")[sheet(2)]
    parts = honest() | {sheet(2): data.replace(b'<c r="D5">', b'<c r="D5">' + broken)}
    said = written(attended, tmp_path, packed(parts))
    (warning,) = [one for one in said["warnings"] if one.startswith("Some inputs are formulas")]
    assert "left them without value: Train!D5, Train!D3. " in warning
    done = (tmp_path / "done.xlsx").read_bytes()
    folder = tmp_path / "again"
    folder.mkdir()
    told = refused(attended, folder, done, "no stored value")
    assert [one for one in told["told"] if "D3" in one]


def test_inputs_that_hang_on_results_are_named(attended: Attended, tmp_path: Path) -> None:
    """The results are those of the old inputs: nobody shall take them for those of the new ones."""
    formula = b"<f>100+INT(%s)</f>" % RESULT.encode()
    data = honest()[sheet(2)].replace(b'<c r="D5">', b'<c r="D5">' + formula)
    said = written(attended, tmp_path, packed(honest() | {sheet(2): data}))
    (warning,) = [one for one in said["warnings"] if one.startswith("Some inputs are formulas")]
    assert "have changed: Train!D5. The results belong to the earlier input values." in warning


def test_half_characters_in_cells(attended: Attended, tmp_path: Path) -> None:
    text = b"<is><t>_xD800_ and _x001B_[2J</t></is>"
    written(attended, tmp_path, packed(retyped(1, TITLE, text, "inlineStr")))
    title = json.loads((tmp_path / "done.json").read_text(encoding="utf-8"))
    assert "\x1b" not in json.dumps(title, ensure_ascii=False)


def test_the_unit_of_a_column_that_knows_only_one() -> None:
    from addin.contract.units import UnitError, parse_unit

    for unit in ("m", "rpm", "Hz", "furlong"):
        with pytest.raises(UnitError, match="cycles per minute"):
            parse_unit(unit, "cycles per minute")
    assert parse_unit("cpm", "cycles per minute").factor == 1.0
