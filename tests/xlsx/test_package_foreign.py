"""Workbooks as other programs write them: opened, written and left alone like those of Excel."""

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import openpyxl
import pytest
import xlsxwriter
from rich_workbooks import MODES, changed_parts, parts_of, with_parts

from addin.xlsx import open_workbook
from addin.xlsx.added_sheets import save_with_sheets
from addin.xlsx.xml_part import RELATIONSHIP_IDS


def typed_by_ending(kind: bytes) -> Callable[[bytes], bytes]:
    """Content types in which parts of one kind have it by their ending, and no entry of their own."""

    def change(data: bytes) -> bytes:
        own = re.compile(rb'<Override PartName="[^"]*" ContentType="[^"]*%s\+xml"/>' % kind)
        found = re.search(rb'ContentType="([^"]*%s\+xml)"' % kind, data)
        assert found
        default = b'<Default Extension="XML" ContentType="%s"/>' % found[1]
        data = re.sub(rb'<Default Extension="xml"[^>]*/>', default, data)
        return own.sub(b"", data)

    return change


def two_modes_fewer(path: Path) -> set[str]:
    """Parts that differ once a table is shorter, of which formulas and charts must know."""
    book = open_workbook(path)
    book.write_table("Modes", [[*MODES[0], None]])
    report = book.save(path.with_name("out.xlsx"))
    assert report.caches.method == "recalculated"
    assert report.caches.removed == 0
    assert open_workbook(report.path).shown_value("Summary", "B2") == 1.0
    return changed_parts(path, report.path)


@pytest.mark.parametrize("kind", [rb"sheet\.main", rb"drawingml\.chart"])
def test_a_type_may_be_that_of_the_ending(train: Path, kind: bytes) -> None:
    """ClosedXML gives the main part its type so, others may give it to charts."""
    usual = two_modes_fewer(train)
    with_parts(train, {}, {"[Content_Types].xml": typed_by_ending(kind)})
    assert two_modes_fewer(train) == usual


def test_sheets_without_a_part_are_left_alone(train: Path) -> None:
    """Macro modules of Excel 95 are sheets with an empty id; those behind them keep their numbers."""

    def with_modules(data: bytes) -> bytes:
        module = b'<sheet name="Module%d" sheetId="%d" state="veryHidden" r:id=""/>'
        data = data.replace(b"<sheets>", b"<sheets>" + module % (1, 91) + module % (2, 92))
        return data.replace(b'localSheetId="0"', b'localSheetId="2"')

    usual = two_modes_fewer(train)
    with_parts(train, {}, {"xl/workbook.xml": with_modules})
    assert two_modes_fewer(train) == usual
    assert ("Case", "Local") in open_workbook(train).local_names


def test_ids_of_sheets_may_have_any_prefix(train: Path) -> None:
    """XmlSerializer of .NET declares one of its own at each sheet."""

    def serialised(data: bytes) -> bytes:
        other = rb'd3p1:id=\1 xmlns:d3p1="%s"' % RELATIONSHIP_IDS.encode()
        return re.sub(rb'\br:id=("\w+")', other, data)

    usual = two_modes_fewer(train)
    with_parts(train, {}, {"xl/workbook.xml": serialised})
    assert two_modes_fewer(train) == usual


def test_parts_named_with_backslashes_are_found_and_keep_their_names(train: Path) -> None:
    parts = parts_of(train)
    with zipfile.ZipFile(train, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            entry = zipfile.ZipInfo()
            entry.filename = name.replace("/", "\\")  # Windows changes one that is given at once
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    names = set(parts_of(train))
    assert "xl\\workbook.xml" in names
    assert "xl\\worksheets\\sheet2.xml" in two_modes_fewer(train)
    assert set(parts_of(train.with_name("out.xlsx"))) == names - {"xl\\calcChain.xml"}


@pytest.mark.parametrize("listed", [True, False])
def test_a_workbook_without_styles_takes_sheets_with_theirs(tmp_path: Path, listed: bool) -> None:
    """exceljs has one whose lists name the part that is not there."""
    for name, bold in (("plain", False), ("other", True)):
        with xlsxwriter.Workbook(str(tmp_path / f"{name}.xlsx")) as book:
            sheet = book.add_worksheet(name)
            sheet.write("A1", name, book.add_format({"bold": bold, "num_format": "0.000"}))
    parts = parts_of(tmp_path / "plain.xlsx")
    del parts["xl/styles.xml"]
    if not listed:
        for name in ("[Content_Types].xml", "xl/_rels/workbook.xml.rels"):
            parts[name] = re.sub(rb'<(Override|Relationship) [^>]*styles\.xml"/>', b"", parts[name])
    bare = tmp_path / "bare.xlsx"
    with zipfile.ZipFile(bare, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    both = tmp_path / "both.xlsx"
    save_with_sheets(open_workbook(bare), open_workbook(tmp_path / "other.xlsx"), ["other"], both)
    book = openpyxl.load_workbook(both)
    assert (book["plain"]["A1"].value, book["plain"]["A1"].font.b) == ("plain", False)
    cell = book["other"]["A1"]
    assert (cell.value, cell.font.b, cell.number_format) == ("other", True, "0.000")


@pytest.mark.parametrize(
    "change",
    [
        lambda styles: re.sub(rb'(<cellXfs[^>]*><xf numFmtId=)"0"', rb'\1"14"', styles),
        lambda styles: styles.replace(
            b"<fonts",
            b'<numFmts count="1"><numFmt numFmtId="0" formatCode="dd.mm.yyyy"/></numFmts><fonts',
            1,
        ),
    ],
    ids=["a date", "General redefined as a date"],
)
def test_a_number_without_a_style_stays_one_where_plain_cells_are_dates(
    tmp_path: Path, change: Callable[[bytes], bytes]
) -> None:
    """Other programs give the first style, which cells without one have, any format."""
    for name in ("dates", "other"):
        with xlsxwriter.Workbook(str(tmp_path / f"{name}.xlsx")) as book:
            book.add_worksheet(name).write("A1", 60)
    parts = parts_of(tmp_path / "dates.xlsx")
    before = parts["xl/styles.xml"]
    parts["xl/styles.xml"] = change(before)
    assert parts["xl/styles.xml"] != before
    here, both = tmp_path / "here.xlsx", tmp_path / "both.xlsx"
    with zipfile.ZipFile(here, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    save_with_sheets(open_workbook(here), open_workbook(tmp_path / "other.xlsx"), ["other"], both)
    book = openpyxl.load_workbook(both)
    assert book["dates"]["A1"].is_date
    assert book["other"]["A1"].value == 60


def test_sheets_with_rules_go_into_a_workbook_whose_styles_list_little(tmp_path: Path) -> None:
    """Neither named styles nor those of rules: where the latter belong was looked for behind the former."""
    for name in ("bare", "other"):
        with xlsxwriter.Workbook(str(tmp_path / f"{name}.xlsx")) as book:
            sheet = book.add_worksheet(name)
            sheet.write("A1", 60)
            if name == "other":
                bold = book.add_format({"bold": True})
                rule = {"type": "cell", "criteria": ">", "value": 5, "format": bold}
                sheet.conditional_format("A1", rule)
    parts = parts_of(tmp_path / "bare.xlsx")
    lists = re.compile(rb"<cellStyles.*?</cellStyles>|<dxfs[^>]*/>", re.DOTALL)
    parts["xl/styles.xml"], gone = lists.subn(b"", parts["xl/styles.xml"])
    assert gone == 2
    here, both = tmp_path / "here.xlsx", tmp_path / "both.xlsx"
    with zipfile.ZipFile(here, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    save_with_sheets(open_workbook(here), open_workbook(tmp_path / "other.xlsx"), ["other"], both)
    (rules,) = openpyxl.load_workbook(both)["other"].conditional_formatting
    assert rules.rules[0].dxf.font.b
