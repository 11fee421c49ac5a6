"""`torsionbook excel install` and `upgrade`: what comes, what stays, who can read it."""

import re
import shutil
import zipfile

import openpyxl
import pytest
from lxml import etree
from olevba_reader import modules_of
from vba_examples import own_module, saved_by_excel

from addin.contract.sheets import SHEETS
from addin.contract.shipped import template_path
from addin.excel import vba
from addin.excel.errors import VbaProjectError
from addin.excel.vba_project import VbaProject, standard_module
from addin.excel.workbook import SETTINGS_SHEET, install, installed_in, portable
from addin.writing.recalculate import recalculate
from addin.xlsx import open_workbook
from addin.xlsx.errors import SaveRefused, WorkbookRefused
from addin.xlsx.macros import MacroEdit, save_with_macros

#: The parts that list others; all the rest must be the same bytes.
LISTS = {"[Content_Types].xml", "xl/workbook.xml", "xl/_rels/workbook.xml.rels"}
#: The drawing of sheet Summary, which gets the button.
DRAWING = "xl/drawings/drawing1.xml"
#: The settings sheet: the part after those of the sheets shipped, `Lists`, `ChartData` and `Inputs calculated`.
NUMBER = f"sheet{len({part.worksheet for part in SHEETS}) + 4}"
NEW_SHEET = f"xl/worksheets/{NUMBER}.xml"
TEMPLATES = ["blank_si", "blank_us", "example_proposed", "example_backlash"]


def parts(path):
    with zipfile.ZipFile(path) as book:
        return {name: book.read(name) for name in book.namelist()}


def settings(path):
    return installed_in(open_workbook(path, read_only=True)).settings


@pytest.fixture
def macro_book(tmp_path):
    """A workbook with the functions."""
    path = tmp_path / "train.xlsm"
    install(template_path("example_proposed.xlsx"), path)
    return path


def with_project(path, source, project):
    """The .xlsm with another VBA project in it."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            data = project if name == "xl/vbaProject.bin" else old.read(name)
            new.writestr(name, data, zipfile.ZIP_DEFLATED)
    return path


# --- install --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_other_part_stays_byte_for_byte(tmp_path, name):
    source, path = template_path(f"{name}.xlsx"), tmp_path / f"{name}.xlsm"
    report = install(source, path)
    before, after = parts(source), parts(path)
    assert {n for n in before if after[n] != before[n]} == LISTS | {DRAWING}
    assert set(after) - set(before) == {"xl/vbaProject.bin", NEW_SHEET}
    assert set(report.parts) == LISTS | {DRAWING} | (set(after) - set(before))


def test_the_lists_gain_their_entries_and_lose_nothing(macro_book):
    before, after = parts(template_path("example_proposed.xlsx")), parts(macro_book)
    types = after["[Content_Types].xml"].decode()
    assert before["[Content_Types].xml"].decode() == re.sub(
        r'<Override PartName="/xl/(?:vbaProject\.bin|worksheets/' + NUMBER + r'\.xml)"[^>]*/>',
        "",
        types,
    ).replace(
        "vnd.ms-excel.sheet.macroEnabled.main+xml",
        "vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml",
    )
    book = after["xl/workbook.xml"].decode()
    without = re.sub(r'<sheet name="xlwings\.conf"[^>]*/>', "", book)
    assert before["xl/workbook.xml"].decode() == without.replace(' codeName="ThisWorkbook"', "")
    links = after["xl/_rels/workbook.xml.rels"].decode()
    assert before["xl/_rels/workbook.xml.rels"].decode() == re.sub(
        r'<Relationship Id="[^"]*" Type="[^"]*" Target="(?:vbaProject\.bin|worksheets/'
        + NUMBER
        + r'\.xml)"/>',
        "",
        links,
    )
    ids = re.findall(r'\bId="([^"]*)"', links)
    assert len(ids) == len(set(ids))


def test_the_drawing_gains_a_button_and_loses_nothing(macro_book):
    before, after = (
        parts(p)[DRAWING] for p in (template_path("example_proposed.xlsx"), macro_book)
    )
    end = before.rindex(b"</xdr:wsDr>")
    assert after.startswith(before[:end])
    assert after.endswith(before[end:])
    button = after[end : len(after) - len(before) + end]
    assert b'macro="[0]!Recalculate"' in button
    assert b'fPrintsWithSheet="0"' in button
    drawing = etree.fromstring(after)
    names = {child.tag for child in drawing}
    assert names == {etree.QName(drawing.nsmap["xdr"], "twoCellAnchor").text}
    ids = [one.get("id") for one in drawing.iter("{*}cNvPr")]
    others = list(etree.fromstring(before).iter("{*}cNvPr"))
    assert len(ids) == len(set(ids)) == len(others) + 1
    assert "Public Sub Recalculate()" in modules_of(macro_book)[vba.MACROS]


def test_a_button_that_the_user_took_away_stays_away(tmp_path, macro_book):
    source = tmp_path / "without.xlsm"
    plain = parts(template_path("example_proposed.xlsx"))[DRAWING]
    with zipfile.ZipFile(source, "w") as new:
        for name, data in parts(macro_book).items():
            new.writestr(name, plain if name == DRAWING else data, zipfile.ZIP_DEFLATED)
    install(source, None)
    assert parts(source)[DRAWING] == plain


def test_a_workbook_without_a_summary_gets_no_button(tmp_path):
    book = openpyxl.Workbook()
    book.save(tmp_path / "other.xlsx")
    install(tmp_path / "other.xlsx", tmp_path / "other.xlsm")
    before, after = parts(tmp_path / "other.xlsx"), parts(tmp_path / "other.xlsm")
    assert {n for n in before if after[n] != before[n]} == LISTS
    assert modules_of(tmp_path / "other.xlsm")[vba.MACROS]


def test_olevba_finds_the_modules_in_the_workbook(macro_book):
    found = modules_of(macro_book)
    assert list(found) == ["ThisWorkbook", "xlwings", "Dictionary", vba.WRAPPERS, vba.MACROS]
    assert found[vba.WRAPPERS].replace("\r\n", "\n") == vba.wrapper_text()


def test_the_settings_are_very_hidden_and_complete(macro_book):
    book = openpyxl.load_workbook(macro_book)
    assert book.sheetnames[-1] == SETTINGS_SHEET
    assert book[SETTINGS_SHEET].sheet_state == "veryHidden"
    rows = {a.value: b.value for a, b in book[SETTINGS_SHEET]["A1:B7"]}
    assert rows == {
        "Interpreter_Win": r"%LOCALAPPDATA%\torsionbook\venv\Scripts\pythonw.exe",
        "UDF Modules": "addin.excel.udfs",
        "PYTHONPATH": None,
        "ADD_WORKBOOK_TO_PYTHONPATH": "False",
        "Use UDF Server": False,
        "Debug UDFs": False,
        "Show Console": False,
    }
    assert book[SETTINGS_SHEET].max_row == 7


def test_xlwings_reads_the_settings_as_they_are_meant(macro_book, monkeypatch):
    """`ADD_WORKBOOK_TO_PYTHONPATH`: the words VBA hands over, through xlwings' own reader."""
    script_paths: list[str] = []
    from xlwings import utils

    monkeypatch.setattr(utils.sys, "path", script_paths)
    found = settings(macro_book)
    folder = r"C:\Jobs\train.xlsm"
    words = [found["ADD_WORKBOOK_TO_PYTHONPATH"], folder, folder, "", "", "", found["PYTHONPATH"]]
    utils.prepare_sys_path(";".join(words))
    assert script_paths == [""]


def test_openpyxl_keeps_the_project(macro_book, tmp_path):
    book = openpyxl.load_workbook(macro_book, keep_vba=True)
    book.save(tmp_path / "again.xlsm")
    assert (
        parts(tmp_path / "again.xlsm")["xl/vbaProject.bin"]
        == parts(macro_book)["xl/vbaProject.bin"]
    )
    assert modules_of(tmp_path / "again.xlsm") == modules_of(macro_book)


def test_two_installs_are_the_same_bytes(tmp_path):
    source = template_path("blank_si.xlsx")
    for name in ("a.xlsm", "b.xlsm"):
        install(source, tmp_path / name)
    assert (tmp_path / "a.xlsm").read_bytes() == (tmp_path / "b.xlsm").read_bytes()


def test_recalc_goes_on_working_and_keeps_the_macros(macro_book, tmp_path):
    done = recalculate(macro_book, destination=tmp_path / "out" / "train.xlsm")
    assert done.problems == ()
    before, after = parts(macro_book), parts(tmp_path / "out" / "train.xlsm")
    for part in ("xl/vbaProject.bin", NEW_SHEET, "[Content_Types].xml"):
        assert after[part] == before[part]


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(SaveRefused, match=r"must end in \.xlsm"):
        install(template_path("blank_si.xlsx"), tmp_path / "train.xlsx")
    assert list(tmp_path.iterdir()) == []


def test_a_workbook_under_a_name_of_another_language(tmp_path, macro_book):
    """An .xlsx that German Excel saved once with macros names itself so."""
    source = tmp_path / "deutsch.xlsx"
    with zipfile.ZipFile(source, "w") as new:
        for name, data in parts(template_path("blank_si.xlsx")).items():
            if name == "xl/workbook.xml":
                data = data.replace(
                    b"<workbookPr ", b"<workbookPr codeName='DieseArbeitsmappe' ", 1
                )
            new.writestr(name, data, zipfile.ZIP_DEFLATED)
    install(source, tmp_path / "deutsch.xlsm")
    part = parts(tmp_path / "deutsch.xlsm")["xl/workbook.xml"]
    assert b'<workbookPr codeName="ThisWorkbook" defaultThemeVersion="124226"/>' in part


@pytest.mark.slow
@pytest.mark.needs_libreoffice
def test_libreoffice_loads_the_modules(macro_book, soffice):
    made = soffice.convert(macro_book, "ods")
    with zipfile.ZipFile(made) as book:
        names = {n for n in book.namelist() if n.startswith("Basic/VBAProject/")}
        modules = {n.rpartition("/")[2].removesuffix(".xml") for n in names}
        assert {"ThisWorkbook", "xlwings", "Dictionary", vba.WRAPPERS, vba.MACROS} <= modules
        text = book.read(f"Basic/VBAProject/{vba.WRAPPERS}.xml").decode()
        for line in vba.wrapper_text().splitlines()[1:]:
            assert line.replace("&", "&amp;").replace('"', "&quot;").replace("'", "&apos;") in text
        content = book.read("content.xml").decode()
    assert "vnd.sun.star.script:VBAProject.Torsionbook.Recalculate?" in content  # the button


@pytest.mark.slow
@pytest.mark.needs_libreoffice
def test_libreoffice_shows_the_same_first_sheet(macro_book, soffice):
    plain = soffice.convert(template_path("example_proposed.xlsx"), "csv")
    assert soffice.convert(macro_book, "csv").read_bytes() == plain.read_bytes()


# --- upgrade --------------------------------------------------------------------------------------


def older(data):
    """The project as version 0.36.0 of xlwings and another of ours would have left it."""
    project = VbaProject.read(data)
    made = []
    for name, old, new in (
        ("xlwings", vba.XLWINGS_VERSION, "0.36.0"),
        (vba.MACROS, "TORSIONBOOK_VERSION As String = ", "TORSIONBOOK_VERSION As String = 'old "),
        (vba.WRAPPERS, "Function TV_CONVERT(", "Function TV_OLD("),
    ):
        source = project.source(name).replace("\r\n", "\n").replace(old, new)
        made.append(standard_module(name, source))
    return project.with_modules([*made, own_module()]).to_bytes()


def test_an_older_version_is_brought_to_this_one(tmp_path, macro_book):
    old = with_project(
        tmp_path / "old.xlsm", macro_book, older(parts(macro_book)["xl/vbaProject.bin"])
    )
    assert installed_in(open_workbook(old, read_only=True)).xlwings == "0.36.0"
    before = parts(old)
    report = install(old, None)
    after = parts(old)
    assert report.backup is not None
    assert parts(report.backup) == before
    assert report.parts == ("xl/vbaProject.bin", NEW_SHEET)
    assert {n for n in before if before[n] != after[n]} == {"xl/vbaProject.bin"}
    found = installed_in(open_workbook(old, read_only=True))
    assert found.xlwings == vba.XLWINGS_VERSION
    now = modules_of(old)
    assert now["Modul1"] == modules_of(report.backup)["Modul1"]
    assert now[vba.WRAPPERS].replace("\r\n", "\n") == vba.wrapper_text()
    fresh = modules_of(macro_book)
    assert {n: now[n] for n in fresh} == fresh


def test_a_workbook_with_macros_of_its_own_keeps_them(tmp_path, macro_book):
    own = with_project(tmp_path / "own.xlsm", macro_book, saved_by_excel())
    install(own, tmp_path / "both.xlsm")
    found = modules_of(tmp_path / "both.xlsm")
    assert set(found) == {
        "ThisWorkbook", "Modul1", "xlwings", "Dictionary", vba.WRAPPERS, vba.MACROS,
    }  # fmt: skip
    assert found["Modul1"] == modules_of(own)["Modul1"]


def test_the_python_that_the_user_named_stays_unless_another_is_given(tmp_path, macro_book):
    install(macro_book, None, interpreter=r"D:\Python\pythonw.exe")
    assert settings(macro_book)["Interpreter_Win"] == r"D:\Python\pythonw.exe"
    install(macro_book, None)
    assert settings(macro_book)["Interpreter_Win"] == r"D:\Python\pythonw.exe"


def test_settings_that_the_user_added_stay_and_ours_are_put_right(macro_book):
    book = open_workbook(macro_book)
    changed = {"UDF MODULES": "mine", "ONEDRIVE_CONSUMER_WIN": r"D:\One", "Show Console": True}
    project = parts(macro_book)["xl/vbaProject.bin"]
    save_with_macros(book, MacroEdit(project, SETTINGS_SHEET, changed), None, in_place=True)
    assert settings(macro_book) == changed
    install(macro_book, None)
    found = settings(macro_book)
    assert found["ONEDRIVE_CONSUMER_WIN"] == r"D:\One"
    assert found["UDF Modules"] == vba.UDF_MODULE
    assert found["Show Console"] is False
    assert "UDF MODULES" not in found


def test_a_settings_sheet_that_excel_saved_keeps_its_name_in_vba(tmp_path, macro_book):
    source = tmp_path / "saved.xlsm"
    with zipfile.ZipFile(source, "w") as new:
        for name, data in parts(macro_book).items():
            if name == NEW_SHEET:
                data = data.replace(b"<dimension", b'<sheetPr codeName="Tabelle20"/><dimension')
            new.writestr(name, data, zipfile.ZIP_DEFLATED)
    install(source, None)
    assert b'<sheetPr codeName="Tabelle20"/>' in parts(source)[NEW_SHEET]


def test_functions_of_another_module_are_not_lost(tmp_path, macro_book):
    project = VbaProject.read(parts(macro_book)["xl/vbaProject.bin"])
    mixed = vba.wrapper_text().replace(
        f'("{vba.UDF_MODULE}", "TV_MODE"', '("my_functions", "TV_MODE"'
    )
    data = project.with_modules([standard_module(vba.WRAPPERS, mixed)]).to_bytes()
    own = with_project(tmp_path / "own.xlsm", macro_book, data)
    before = own.read_bytes()
    with pytest.raises(VbaProjectError, match="also holds functions of my_functions"):
        install(own, None)
    assert own.read_bytes() == before


@pytest.mark.parametrize("name", ["Torsionbook", "dictionary", "XLWINGS"])
def test_a_module_of_the_user_under_one_of_our_names_is_not_replaced(tmp_path, macro_book, name):
    own = with_project(
        tmp_path / "own.xlsm",
        macro_book,
        saved_by_excel(
            own_module(name, f'Attribute VB_Name = "{name}"\n\' of torsionbook\nSub A()\nEnd Sub\n')
        ),
    )
    with pytest.raises(VbaProjectError, match="already has a VBA module"):
        install(own, None)


def test_a_settings_sheet_in_other_capitals_is_the_same_to_excel(tmp_path):
    path = tmp_path / "train.xlsx"
    book = openpyxl.load_workbook(template_path("blank_si.xlsx"))
    sheet = book.create_sheet("XLWINGS.CONF")
    sheet["A1"], sheet["B1"] = "ONEDRIVE_CONSUMER_WIN", "D:\\One"
    book.save(path)
    install(path, path.with_suffix(".xlsm"))
    names = open_workbook(path.with_suffix(".xlsm"), read_only=True).sheet_names
    assert [name for name in names if name.casefold() == SETTINGS_SHEET] == ["XLWINGS.CONF"]
    found = settings(path.with_suffix(".xlsm"))
    assert found["ONEDRIVE_CONSUMER_WIN"] == "D:\\One"
    assert found["UDF Modules"] == vba.UDF_MODULE


def test_signed_macros_are_not_changed(tmp_path, macro_book):
    signed = tmp_path / "signed.xlsm"
    shutil.copyfile(macro_book, signed)
    with zipfile.ZipFile(signed, "a") as book:
        book.writestr("xl/vbaProjectSignature.bin", b"s")
    with pytest.raises(WorkbookRefused, match="digital signature"):
        install(signed, None)


def test_a_damaged_project_is_named_and_nothing_written(tmp_path, macro_book):
    broken = with_project(tmp_path / "broken.xlsm", macro_book, b"nonsense")
    before = broken.read_bytes()
    with pytest.raises(Exception, match="not a compound file"):
        install(broken, None)
    assert broken.read_bytes() == before
    assert [p.name for p in tmp_path.glob("broken*")] == ["broken.xlsm"]


@pytest.mark.parametrize(
    ("path", "local", "shown"),
    [
        (r"C:\U\me\AppData\Local\t\pythonw.exe", r"C:\U\me\AppData\Local", r"%LOCALAPPDATA%\t\pythonw.exe"),
        (r"c:\u\ME\appdata\local\t\pythonw.exe", r"C:\U\me\AppData\Local", r"%LOCALAPPDATA%\t\pythonw.exe"),
        (r"D:\t\pythonw.exe", r"C:\U\me\AppData\Local", r"D:\t\pythonw.exe"),
        (r"D:\t\pythonw.exe", "", r"D:\t\pythonw.exe"),
    ],
)  # fmt: skip
def test_a_path_in_the_users_folder_serves_other_users(path, local, shown):
    assert portable(path, local) == shown
