"""Files that are not opened, each for its own reason, and left as they are."""

import io
import shutil
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from rich_workbooks import parts_of, with_parts
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.xlsx import open_workbook
from addin.xlsx.container import Limits
from addin.xlsx.errors import WorkbookLocked, WorkbookRefused

OLE = bytes.fromhex("D0CF11E0A1B11AE1")
BILLION = (
    b'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
)


def insert_doctype(data: bytes) -> bytes:
    head, _, rest = data.partition(b"?>")
    return BILLION + rest


def retyped(old: bytes, new: bytes) -> Callable[[Path], None]:
    def change(path: Path) -> None:
        with_parts(path, {}, {"[Content_Types].xml": lambda data: data.replace(old, new)})

    return change


def edited(part: str, change: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    def apply(path: Path) -> None:
        with_parts(path, {}, {part: change})

    return apply


def rewritten(names: Callable[[list[str]], list[str]]) -> Callable[[Path], None]:
    """The archive with other names in its directory."""

    def apply(path: Path) -> None:
        parts = parts_of(path)
        with zipfile.ZipFile(path, "w") as archive:
            for old, new in zip(parts, names(list(parts)), strict=True):
                entry = zipfile.ZipInfo(new)
                entry.filename = new
                archive.writestr(entry, parts[old])

    return apply


def without(part: str) -> Callable[[Path], None]:
    def apply(path: Path) -> None:
        parts = parts_of(path)
        with zipfile.ZipFile(path, "w") as archive:
            for name, data in parts.items():
                if name != part:
                    archive.writestr(name, data)

    return apply


def duplicated(path: Path) -> None:
    with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("xl/workbook.xml", b"<other/>")


def bomb(path: Path) -> None:
    with_parts(path, {"xl/media/zeros.bin": bytes(30 * 2**20)})


def encrypted_entry(path: Path) -> None:
    data = bytearray(path.read_bytes())
    at = data.index(b"PK\x01\x02")
    data[at + 8] |= 1
    path.write_bytes(data)


def broken_part(path: Path) -> None:
    """Bytes of the workbook part destroyed."""
    with zipfile.ZipFile(path) as archive:
        entry = archive.getinfo("xl/workbook.xml")
    data = bytearray(path.read_bytes())
    name, extra = struct.unpack_from("<HH", data, entry.header_offset + 26)
    at = entry.header_offset + 30 + name + extra
    data[at : at + 20] = bytes(20)
    path.write_bytes(data)


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-200])


MAIN = b"openxmlformats-officedocument.spreadsheetml"
BAD: list[tuple[str, str, Callable[[Path], None]]] = [
    (
        "encrypted",
        "password",
        lambda p: void(p.write_bytes(OLE + "EncryptedPackage".encode("utf-16-le"))),
    ),
    ("encrypted", "encrypted archive", encrypted_entry),
    ("xls", "old .xls format", lambda p: void(p.write_bytes(OLE + bytes(600)))),
    ("empty", "is empty", lambda p: void(p.write_bytes(b""))),
    (
        "not a workbook",
        "not an Excel workbook",
        lambda p: void(p.write_bytes(b"Station;Inertia\n1;2\n")),
    ),
    ("not a workbook", "zip file but not", without("[Content_Types].xml")),
    ("not a workbook", "zip file but not", without("_rels/.rels")),
    ("not a workbook", "zip file but not", without("xl/workbook.xml")),
    ("not a workbook", "Office file but not", retyped(MAIN + b".sheet.main", b"x.word.main")),
    (
        "xlsb",
        "binary .xlsb",
        retyped(
            b"application/vnd." + MAIN + b".sheet.main+xml",
            b"application/vnd.ms-excel.sheet.binary.macroEnabled.main",
        ),
    ),
    ("template", "Excel template", retyped(MAIN + b".sheet.main", MAIN + b".template.main")),
    (
        "signed",
        "digital signature",
        lambda p: void(with_parts(p, {"_xmlsignatures/sig1.xml": b"<s/>"})),
    ),
    ("dtd", "document type declaration", edited("xl/workbook.xml", insert_doctype)),
    ("dtd", "document type declaration", edited("[Content_Types].xml", insert_doctype)),
    (
        "dtd",
        "document type declaration",
        edited(
            "xl/workbook.xml",
            lambda d: (
                insert_doctype(d).decode().replace('<?xml version="1.0"?>', "").encode("utf-16")
            ),
        ),
    ),
    ("damaged", "not well-formed", edited("xl/workbook.xml", lambda d: d[:-20])),
    ("damaged", "is damaged", broken_part),
    ("damaged", "is damaged", truncated),
    ("damaged", "lacks the part of sheet 'Case'", without("xl/worksheets/sheet1.xml")),
    ("bomb", "as in an attack file", bomb),
    ("duplicate part", "twice", duplicated),
    (
        "duplicate part",
        "twice",
        rewritten(lambda names: ["XL/workbook.xml" if n == "xl/styles.xml" else n for n in names]),
    ),
    (
        "path",
        "points outside",
        rewritten(lambda names: ["../evil.xml" if n == "xl/styles.xml" else n for n in names]),
    ),
    (
        "path",
        "points outside",
        rewritten(lambda names: ["/etc/passwd" if n == "xl/styles.xml" else n for n in names]),
    ),
    (
        "path",
        "points outside",
        rewritten(lambda names: ["C:\\evil.xml" if n == "xl/styles.xml" else n for n in names]),
    ),
]


def void(_: object) -> None:
    return None


@pytest.mark.parametrize("reason", ["encrypted", "xls", "xlsb", "signed"])
def test_recalculation_refuses_them_with_the_reason_and_writes_nothing(
    tmp_path: Path, reason: str
) -> None:
    train = Path(shutil.copyfile(template_path("example_proposed.xlsx"), tmp_path / "train.xlsx"))
    words, spoil = next((words, spoil) for kind, words, spoil in BAD if kind == reason)
    spoil(train)
    before = train.read_bytes()
    done = CliRunner().invoke(app, ["recalc", str(train), "--out", str(tmp_path / "out")])
    assert done.exit_code == 1
    assert words in done.output
    assert train.read_bytes() == before
    assert not list(tmp_path.glob("out/*"))


@pytest.mark.parametrize(
    ("reason", "words", "spoil"), BAD, ids=[f"{i}-{r[0]}" for i, r in enumerate(BAD)]
)
def test_bad_files_are_refused_by_name_and_left_alone(
    train: Path, reason: str, words: str, spoil: Callable[[Path], None]
) -> None:
    spoil(train)
    before = train.read_bytes()
    with pytest.raises(WorkbookRefused, match=words) as caught:
        open_workbook(train)
    assert caught.value.reason == reason
    assert caught.value.message.endswith((".", "again."))
    assert train.read_bytes() == before
    assert list(train.parent.iterdir()) == [train]


@pytest.mark.parametrize(
    "part",
    [
        "xl/worksheets/sheet2.xml",
        "xl/sharedStrings.xml",
        "xl/charts/chart1.xml",
        "xl/tables/table1.xml",
    ],
)
def test_declarations_in_parts_that_are_read_later(train: Path, part: str) -> None:
    with_parts(train, {}, {part: insert_doctype})
    before = train.read_bytes()

    def recalculate() -> None:
        book = open_workbook(train)
        book.value("Case", "A1")
        book.write_table("Modes", [[1, 2, 3, 4]] * 5)
        book.save(train.with_name("out.xlsx"))

    with pytest.raises(WorkbookRefused, match="document type declaration"):
        recalculate()
    assert train.read_bytes() == before


def test_missing_files_and_folders(tmp_path: Path) -> None:
    with pytest.raises(WorkbookRefused, match="does not exist") as caught:
        open_workbook(tmp_path / "none.xlsx")
    assert caught.value.reason == "missing"
    with pytest.raises(WorkbookRefused) as caught:
        open_workbook(tmp_path)
    assert caught.value.reason == "unreadable"


def test_limits(train: Path) -> None:
    for limits, reason in (
        (Limits(file_size=100), "too large"),
        (Limits(total_size=1000), "bomb"),
        (Limits(part_size=1000), "bomb"),
        (Limits(entries=5), "too many parts"),
    ):
        with pytest.raises(WorkbookRefused) as caught:
            open_workbook(train, limits=limits)
        assert caught.value.reason == reason


def test_a_directory_that_lies_about_sizes_is_caught(train: Path) -> None:
    """The stated size is small, the stream inflates to 30 MB: nothing beyond the stated size is produced."""
    with_parts(
        train, {}, {"xl/styles.xml": lambda data: data + b"<!--" + b"x" * (30 * 2**20) + b"-->"}
    )
    data = bytearray(train.read_bytes())
    with zipfile.ZipFile(io.BytesIO(bytes(data))) as archive:
        size = archive.getinfo("xl/styles.xml").file_size
    for at in range(len(data) - 4):
        if data[at : at + 4] == struct.pack("<L", size):
            data[at : at + 4] = struct.pack("<L", 5000)
    train.write_bytes(data)
    book = open_workbook(train)
    with pytest.raises(WorkbookRefused, match="is damaged"):
        book.container.read("xl/styles.xml")


def excel_lock(owner: str) -> bytes:
    ansi = owner.encode("cp1252", "replace")
    wide = owner.encode("utf-16-le")
    return (
        bytes([len(ansi)])
        + ansi.ljust(54)
        + struct.pack("<H", len(owner))
        + wide
        + (" " * (54 - len(owner))).encode("utf-16-le")
    )


@pytest.mark.parametrize("owner", ["A. Szenasi", "Müller, Jürgen", "山田"])
def test_open_in_excel(train: Path, owner: str) -> None:
    lock = train.with_name("~$train.xlsx")
    lock.write_bytes(excel_lock(owner))
    assert len(excel_lock(owner)) == 165
    with pytest.raises(WorkbookLocked, match="open in Excel by " + owner) as caught:
        open_workbook(train)
    assert (caught.value.owner, caught.value.lock_file, caught.value.reason) == (
        owner,
        "~$train.xlsx",
        "locked",
    )
    open_workbook(train, read_only=True)
    book = open_workbook(train, ignore_lock=True)
    book.set_name("Title", "x")
    book.save(in_place=True)


def test_open_in_libreoffice(train: Path) -> None:
    train.with_name(".~lock.train.xlsx#").write_text(
        ",eng,desk7,21.11.2026 07:00,file:///profile;", encoding="utf-8"
    )
    with pytest.raises(WorkbookLocked, match="open in LibreOffice by eng on desk7"):
        open_workbook(train)


@pytest.mark.parametrize("data", [b"", b"\x05", bytes(165), bytes([200]) + b"x" * 20])
def test_odd_lock_files(train: Path, data: bytes) -> None:
    train.with_name("~$train.xlsx").write_bytes(data)
    with pytest.raises(WorkbookLocked, match="open in Excel"):
        open_workbook(train)


def test_signed_workbooks_can_be_read(train: Path) -> None:
    with_parts(train, {"_xmlsignatures/sig1.xml": b"<s/>"})
    book = open_workbook(train, read_only=True)
    assert book.value("Case", "B2") == 4500.0
