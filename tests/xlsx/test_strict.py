"""'Strict Open XML Spreadsheet', the dialect of ISO/IEC 29500 in which spreadsheet programs may save, too."""

import shutil
import time
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from rich_workbooks import parts_of
from strict_workbooks import saved_strict
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.xlsx import open_workbook
from addin.xlsx.container import DEFAULT_LIMITS
from addin.xlsx.errors import WorkbookRefused
from addin.xlsx.strict import in_ordinary_dialect, serial_number

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")

OWN = "xl/worksheets/sheet5.xml"
#: Days by Excel's own count: 1 March 1900 is 61, 1 January 2000 is 36526.
DATES = {
    "1900-03-01": 61,
    "2000-01-01": 36526,
    "2000-01-01T06:00:00": 36526.25,
    "2000-01-01T18:00:00Z": 36526.75,
    "12:00:00": 0.5,
    "T12:00:00": 0.5,
}


@pytest.fixture
def strict(train: Path) -> Path:
    """A rich workbook in which a user has noted a date and an address."""
    cells = {
        "A1": b'<c r="A1" s="1" t="d"><v>2000-01-01T06:00:00</v></c>',
        "A2": b'<c r="A2" t="inlineStr"><is><t>="http://purl.oclc.org/ooxml/spreadsheetml/main"</t></is></c>',
        "A3": b'<c r="A3" t="d"><f>TODAY()</f><v>2024-02-29</v></c>',
    }
    return saved_strict(train, train.with_name("strict.xlsx"), {OWN: cells})


@pytest.mark.parametrize("text", DATES)
def test_dates_are_counted_as_in_ordinary_workbooks(text: str) -> None:
    assert serial_number(text, from_1904=False) == DATES[text]


def test_dates_counted_from_1904() -> None:
    assert serial_number("2000-01-01", from_1904=True) == 36526 - 1462
    assert serial_number("12:00", from_1904=True) == 0.5
    assert serial_number("2000-13-01", from_1904=False) is None


def test_every_part_is_that_of_the_ordinary_workbook(tmp_path: Path) -> None:
    for name in ("example_proposed.xlsx", "example_studies.xlsx"):
        ordinary = template_path(name)
        strict = saved_strict(ordinary, tmp_path / name)
        assert b"purl.oclc.org" in parts_of(strict)["xl/workbook.xml"]
        assert any(b'"150%"' in data or b'%"' in data for data in parts_of(strict).values())
        container = open_workbook(strict).container
        assert {n: container.read(n) for n in container.names} == parts_of(ordinary)


def test_dates_are_numbers_and_texts_stay(strict: Path) -> None:
    book = open_workbook(strict)
    assert book.value("Owner's notes", "A1") == 36526.25
    assert book.value("Owner's notes", "A2") == '="http://purl.oclc.org/ooxml/spreadsheetml/main"'
    assert book.shown_value("Owner's notes", "A3") == 45351


def test_what_is_saved_is_ordinary_and_says_so(strict: Path, tmp_path: Path) -> None:
    before = strict.read_bytes()
    book = open_workbook(strict)
    book.set_name("RatedPower", 5000.0)
    report = book.save(tmp_path / "out.xlsx")
    assert "ordinary Excel workbook" in " ".join(report.notes)
    assert strict.read_bytes() == before
    names = b"".join(data for name, data in parts_of(report.path).items() if name != OWN)
    assert b"purl.oclc.org" not in names
    assert openpyxl.load_workbook(report.path)["Case"]["B2"].value == 5000.0


def test_in_place_keeps_the_strict_file_as_it_was(strict: Path) -> None:
    before = strict.read_bytes()
    book = open_workbook(strict)
    book.set_name("RatedPower", 5000.0)
    report = book.save(in_place=True)
    assert report.backup is not None
    assert report.backup.read_bytes() == before
    assert open_workbook(strict).value("Case", "B2") == 5000.0


def test_a_part_in_another_encoding_is_refused(strict: Path) -> None:
    parts = parts_of(strict)
    text = parts[OWN].decode().partition("?>")[2]
    parts[OWN] = b'<?xml version="1.0" encoding="ISO-8859-1"?>' + text.encode("iso-8859-1")
    with zipfile.ZipFile(strict, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    done = CliRunner().invoke(app, ["check", str(strict)])
    assert done.exit_code == 1
    assert "another encoding than UTF-8. Save it as the ordinary" in done.output


def test_more_than_is_read_of_it_is_refused_before_it_is_read(strict: Path) -> None:
    few = replace(DEFAULT_LIMITS, strict=10_000)
    with pytest.raises(WorkbookRefused, match="more than 0 MB of it. Save it as the ordinary"):
        open_workbook(strict, limits=few)


def test_attributes_of_one_tag_do_not_take_long() -> None:
    """120,000 bytes took 5 s, ten times as many a hundred times as long."""
    for end in (b"<", b"/>", b"><v>2000-01-01</v></c>"):
        data = b'<a x="http://purl.oclc.org/ooxml/spreadsheetml/main"><c' + b' t="d"' * 200_000
        began = time.process_time()
        in_ordinary_dialect(data + end, from_1904=False)
        assert time.process_time() - began < 2


def test_a_percentage_of_more_digits_than_a_number_has() -> None:
    name = b'<a x="http://purl.oclc.org/ooxml/drawingml/main"><b val="%s%%"/></a>'
    assert b'val="1500"' in in_ordinary_dialect(name % b"1.5", from_1904=False)
    assert b'val="%s%%"' % (b"1" * 400) in in_ordinary_dialect(name % (b"1" * 400), from_1904=False)


def test_no_text_takes_long() -> None:
    """What never closes is searched once."""
    for mark in (b'x="http://purl.oclc.org/ooxml/a/b" ', b"<c t='d' ", b'<c t="d"> ', b'b="1%" '):
        data = b'<a x="http://purl.oclc.org/ooxml/a/b"><b ' + mark * 20_000 + b"<"
        for whole in (data, data + b"/spreadsheetml/"):
            began = time.process_time()
            in_ordinary_dialect(whole, from_1904=False)
            assert time.process_time() - began < 2


@pytest.mark.slow
def test_results_are_those_of_the_ordinary_workbook(tmp_path: Path) -> None:
    ordinary = Path(
        shutil.copyfile(template_path("example_proposed.xlsx"), tmp_path / "train.xlsx")
    )
    (tmp_path / "strict").mkdir()
    strict = saved_strict(ordinary, tmp_path / "strict" / "train.xlsx")
    for path in (ordinary, strict):
        done = CliRunner().invoke(app, ["recalc", str(path), "--out", str(path.parent / "out")])
        assert done.exit_code == 0
        assert ("Strict Open XML" in done.output) == (path == strict)
    one, other = (parts_of(path.parent / "out" / "train.xlsx") for path in (ordinary, strict))
    assert one.keys() == other.keys()
    unlike = {name for name in one if one[name] != other[name]}
    # the digest of the file, and the note
    assert len(unlike) <= 3, unlike


@pytest.mark.needs_libreoffice
def test_libreoffice_reads_the_same_from_the_strict_file(
    strict: Path, soffice: Any, tmp_path: Path
) -> None:
    theirs = openpyxl.load_workbook(
        soffice.convert(strict, "xlsx", tmp_path / "lo"), data_only=True
    )
    book = open_workbook(strict)
    ours = openpyxl.load_workbook(book.save(tmp_path / "out.xlsx").path, data_only=True)
    compared = 0
    for sheet in theirs:
        for row in sheet.iter_rows():
            for cell in row:
                mine = ours[sheet.title][cell.coordinate]
                if mine.value is None or (sheet.title, cell.coordinate) == ("Owner's notes", "A3"):
                    continue
                assert cell.value == (
                    pytest.approx(mine.value, rel=1e-12)
                    if isinstance(mine.value, float)
                    else mine.value
                ), f"{sheet.title}!{cell.coordinate}"
                compared += 1
    assert compared > 60
