"""Cached values of formulas and charts: renewed or removed, never stale."""

import re
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import openpyxl
import pytest
import xlsxwriter
from rich_workbooks import changed_parts, parts_of, tiny_png, with_parts
from whatif_workbooks import (
    HANGING,
    OUT,
    RENEWED,
    UNTOUCHED,
    VARIED,
    circular_workbook,
    whatif_workbook,
)

from addin.xlsx import Formula, Workbook, dependents, open_workbook
from addin.xlsx.calculator_copy import calculator_copy
from addin.xlsx.dependents import (
    DependencyGraph,
    FormulaCell,
    FormulaMap,
    ReferenceResolver,
    formula_map,
)
from addin.xlsx.formula_text import Reference, parse_formula, shifted_formula
from addin.xlsx.formulas import CacheReport, _formula_cells
from addin.xlsx.references import parse_range

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")


def workbook_of(
    path: Path, cells: dict[str, tuple[str, Any]], names: dict[str, str] | None = None
) -> Path:
    """Sheets In (A1:A9 = 1 to 9) and Out with formulas and the values stated for them."""
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    for row in range(9):
        source.write_number(row, 0, row + 1.0)
    for cell, (formula, value) in cells.items():
        sheet.write_formula(cell, formula, None, value)
    for name, text in (names or {}).items():
        book.define_name(name, text)
    book.close()
    return path


def refreshed(path: Path, changes: dict[str, Any]) -> tuple[dict[str, Any], CacheReport]:
    """Values of sheet Out after changes to sheet In."""
    book = open_workbook(path)
    for cell, value in changes.items():
        book.set_cell("In", cell, value)
    report = book.save(path.with_name("out.xlsx"))
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Out"]
    return {cell.coordinate: cell.value for row in sheet for cell in row}, report.caches


BARE = re.compile(rb'(<(?:row|c)) r="\w+"')
IN_DATA = re.compile(rb"<(f|v|t)>([^<&]+)</")


@pytest.mark.parametrize(
    "change",
    [
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: BARE.sub(rb"\1", data),
        lambda data: IN_DATA.sub(rb"<\1><![CDATA[\2]]></", data),
        lambda data: data.decode().partition("?>")[2].encode("utf-16"),
        lambda data: (
            b"\xef\xbb\xbf" + IN_DATA.sub(rb"<\1><![CDATA[\2]]></", BARE.sub(rb"\1", data))
        ),
    ],
    ids=["byte order mark", "cells without names", "character data", "UTF-16", "three of them"],
)
def test_files_that_other_programs_write_are_calculated(
    tmp_path: Path, change: Callable[[bytes], bytes]
) -> None:
    """The calculator refuses such a file, so that values which depend on results were removed."""
    path = tmp_path / "t.xlsx"
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.write_column(0, 0, [1.0, 2.0, 3.0])
    sheet.write_formula("A1", "=SUM(In!A1:A3)", None, 6)
    sheet.write_formula("B1", '=IF(A1>50,C1,"low")', None, "low")
    sheet.write_string("C1", "high")
    book.close()
    parts = parts_of(path)
    for name in parts:
        if name.startswith(("xl/worksheets/sheet", "xl/sharedStrings")):
            parts[name] = change(parts[name])
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    book = open_workbook(path)
    book.set_cell("In", "A1", 100.0)
    report = book.save(tmp_path / "out.xlsx")
    assert (report.caches.changed, report.caches.removed) == (2, 0), report.caches.reason
    done = open_workbook(report.path)
    assert [done.shown_value("Out", cell) for cell in ("A1", "B1", "C1")] == [105, "high", "high"]
    written = parts_of(report.path)
    changed = {name for name in parts if written[name] != parts[name]}
    assert changed == {"xl/worksheets/sheet1.xml", "xl/worksheets/sheet2.xml"}


def test_formulas_of_too_many_characters_lose_their_values(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("addin.xlsx.formulas._MOST_TEXT", 30)
    monkeypatch.setattr("addin.xlsx.formulas._TEXT_OF_MARK", 0.0)
    path = workbook_of(
        tmp_path / "t.xlsx", {"A1": ("=SUM(In!A1:A9)", 45), "A2": ("=2*100+1*100", 300)}
    )
    values, report = refreshed(path, {"A1": 2.0})
    assert values["A1"] is None
    assert values["A2"] == 300  # too many to calculate, but followed
    monkeypatch.setattr("addin.xlsx.formulas._MOST_TEXT", 2000)
    values, report = refreshed(path, {"A1": 2.0})
    assert None not in values.values()
    monkeypatch.setattr("addin.xlsx.formulas._TEXT_OF_MARK", 100.0)  # cells take room, too
    values, report = refreshed(path, {"A1": 2.0})
    assert values == {"A1": None, "A2": None}
    monkeypatch.setattr("addin.xlsx.formulas._MOST_TEXT", 20)
    monkeypatch.setattr("addin.xlsx.formulas._TEXT_OF_MARK", 0.0)
    values, report = refreshed(path, {"A1": 2.0})
    assert values == {"A1": None, "A2": None}
    assert (report.method, report.removed, report.removed_cells) == (
        "removed",
        2,
        ("Out!A1", "Out!A2"),
    )
    assert "more than 20 characters" in report.reason


def test_zero_takes_the_place_of_an_empty_text(tmp_path: Path) -> None:
    path = workbook_of(tmp_path / "t.xlsx", {"A1": ('=IF(In!A1=1,"",0)', "before")})
    refreshed(path, {"A1": 1.0})
    assert b'<c r="A1" t="str">' in parts_of(tmp_path / "out.xlsx")["xl/worksheets/sheet2.xml"]
    values, _ = refreshed((tmp_path / "out.xlsx").replace(path), {"A1": 2.0})
    assert values == {"A1": 0}
    assert type(values["A1"]) is int


def test_values_that_hang_on_changes_are_renewed(train: Path) -> None:
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    book.set_name("Title", "new")
    book.write_table("Modes", [[1, 20.0, 1.0, 2.0], [2, 45.0, 1.0, 2.0]])
    report = book.save(train.with_name("out.xlsx"))
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Summary"]
    assert [sheet[f"B{row}"].value for row in range(1, 10)] == [
        45,
        2,
        90,
        "low",
        2500,
        10000,
        2,
        False,
        "new!",
    ]
    assert [sheet[f"D{row}"].value for row in range(1, 4)] == [40, 90, 0]
    assert openpyxl.load_workbook(report.path, data_only=True)["Case"]["B4"].value == 5000 * 0.7457
    assert report.caches.method == "recalculated"
    assert report.caches.removed == 0


def test_names_that_lead_to_no_cell_cost_no_value(tmp_path: Path) -> None:
    """What a change cannot reach keeps its value; the formulas that lose theirs are named in a note."""
    kept = {
        "A1": ("=Nowhere*2", 5),
        "A2": ("=Out!Nowhere", 5),
        "A3": ("=LET(x,2,x*2)", 4),
        "A4": ("='Gone'!A1", 3),
        "A5": ("=[1]!Other", 3),
    }
    lost = {"B1": ("=Relative+1", 7), "B2": ("=SUM(In:Out!Z9)", 9), "B3": ("='In:Out'!Z9", 9)}
    path = workbook_of(
        tmp_path / "a.xlsx", kept | lost | {"C1": ("=In!A1*2", 2)}, {"Relative": "=In!B1"}
    )
    book = open_workbook(path)
    book.set_cell("In", "A1", 5.0)
    report = book.save(path.with_name("out.xlsx"))
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Out"]
    assert {cell: sheet[cell].value for cell in kept} == {cell: v for cell, (_, v) in kept.items()}
    assert {sheet[cell].value for cell in lost} == {None}
    assert sheet["C1"].value == 10
    (note,) = report.notes
    assert note.startswith("3 formulas have no stored value; they are calculated when you open")
    assert ": Out!B1, Out!B2, Out!B3. " in note


@pytest.mark.parametrize("calculator", [True, False])
def test_recalculation_is_asked_for_where_a_value_is_missing(
    train: Path, monkeypatch: pytest.MonkeyPatch, calculator: bool
) -> None:
    """Else Excel would calculate all of it when it opens the workbook, and ask whether to save when it closes it."""
    if not calculator:
        monkeypatch.setitem(sys.modules, "formualizer", None)
    with_parts(
        train,
        {},
        {"xl/workbook.xml": lambda data: data.replace(b' fullCalcOnLoad="1"', b' iterate="1"')},
    )
    book = open_workbook(train)
    book.set_name("RatedPower", 1.0)
    report = book.save(train.with_name("out.xlsx"))
    assert report.caches.affected
    assert bool(report.caches.removed) is not calculator
    before = parts_of(train)["xl/workbook.xml"]
    asked = before.replace(b' iterate="1"', b' iterate="1" fullCalcOnLoad="1"')
    assert parts_of(report.path)["xl/workbook.xml"] == (before if calculator else asked)


@pytest.mark.parametrize("last", ["definedNames", "sheets"])
def test_recalculation_is_asked_for_where_nothing_was_said(
    train: Path, monkeypatch: pytest.MonkeyPatch, last: str
) -> None:
    monkeypatch.setitem(sys.modules, "formualizer", None)

    def without(data: bytes) -> bytes:
        data = re.sub(rb"<calcPr[^>]*/>", b"", data)
        return re.sub(rb"<definedNames>.*</definedNames>", b"", data) if last == "sheets" else data

    with_parts(train, {}, {"xl/workbook.xml": without})
    book = open_workbook(train)
    book.set_cell("Case", "B2", 1.0)
    data = parts_of(book.save(train.with_name("out.xlsx")).path)["xl/workbook.xml"]
    assert f'</{last}><calcPr fullCalcOnLoad="1"/>'.encode() in data


def test_calculation_chain_goes_only_with_the_set_of_formulas(train: Path) -> None:
    book = open_workbook(train)
    book.set_name("RatedPower", 1.0)
    book.set_cell("Summary", "B7", Formula("2+2", 4.0))
    assert book.save(train.with_name("same.xlsx")).dropped == ()
    book = open_workbook(train)
    book.set_cell("Summary", "F7", Formula("2+2", 4.0))
    out = book.save(train.with_name("more.xlsx"))
    assert out.dropped == ("xl/calcChain.xml",)
    parts = parts_of(out.path)
    assert b"calcChain" not in parts["[Content_Types].xml"] + parts["xl/_rels/workbook.xml.rels"]
    openpyxl.load_workbook(out.path)


def test_sheets_with_unconcerned_formulas_stay_byte_identical(train: Path) -> None:
    """Also the one with TODAY(): its value is as old as the file, and a run must not depend on the day."""
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    out = book.save(train.with_name("out.xlsx")).path
    assert "xl/worksheets/sheet5.xml" not in changed_parts(train, out)


def test_unknown_functions_and_all_that_hangs_on_them_are_removed(tmp_path: Path) -> None:
    """But A5 depends on nothing that was written: its value stays, and A7 is calculated from it."""
    path = workbook_of(
        tmp_path / "t.xlsx",
        {
            "A1": ("=TV_FREQUENCY(In!A1)", 10),
            "A2": ("=IFERROR(A1,3)", 10),
            "A3": ("=A2+In!A9", 19),
            "A4": ("=In!A1*2", 2),
            "A5": ("=TV_FREQUENCY(In!A5)", 50),
            "A6": ("=A5+1", 51),
            "A7": ("=A5+In!A1", 51),
        },
    )
    values, report = refreshed(path, {"A1": 7.0})
    assert values == {"A1": None, "A2": None, "A3": None, "A4": 14, "A5": 50, "A6": 51, "A7": 57}
    assert (report.method, report.affected, report.changed, report.removed) == (
        "recalculated",
        5,
        2,
        3,
    )
    assert report.reason


def test_clock_and_chance_do_not_get_in(tmp_path: Path) -> None:
    path = workbook_of(
        tmp_path / "t.xlsx",
        {
            "A1": ("=TODAY()", 45000),
            "A2": ("=A1+In!A1", 45001),
            "A3": ("=RAND()*In!A1", 0.5),
            "A4": ("=A1+1", 45001),
        },
    )
    values, _ = refreshed(path, {"A1": 2.0})
    assert values == {"A1": 45000, "A2": None, "A3": None, "A4": 45001}


def test_honest_errors_are_written_doubtful_ones_are_not(tmp_path: Path) -> None:
    path = workbook_of(
        tmp_path / "t.xlsx",
        {
            "A1": ("=1/In!A1", 1),
            "A2": ("=MATCH(In!A1,In!A2:A9,0)", "#N/A"),
            "A3": ('=IF(In!A1=0,In!A1+"x",2)', 2),
            "A4": ("=IFERROR(A3,5)", 2),
        },
    )
    values, _ = refreshed(path, {"A1": 0.0})
    assert values == {"A1": "#DIV/0!", "A2": "#N/A", "A3": None, "A4": None}


def test_disagreement_on_an_unchanged_cell_makes_its_dependants_suspect(tmp_path: Path) -> None:
    """Whoever gets another value from unchanged cells is not to be trusted with what hangs on them."""
    path = workbook_of(
        tmp_path / "t.xlsx",
        {"A1": ("=In!A2*2", 999), "A2": ("=A1+In!A1", 1000), "A3": ("=In!A1", 1)},
    )
    values, _ = refreshed(path, {"A1": 5.0})
    assert values == {"A1": 999, "A2": None, "A3": 5}


@pytest.mark.parametrize(
    ("formula", "old", "new"),
    [
        ("=SUM(In!A:A)", 45, 54),
        ("=SUM(In!1:3)", 6, 15),
        ("=SUM(In!$A$1:$A$3)", 6, 15),
        ("=OFFSET(In!A2,-1,0)", 1, 10),
        ('=INDIRECT("In!A1")', 1, 10),
        ("=SUM(In!A2:INDEX(In!A:A,1))", 3, 12),
        ("=SUM(first:third)", 6, 15),
        ("=Twofold", 2, 20),
        ("=SUM(In!A1,In!A2)", 3, 12),
        ('=IF("In!A1"="x",1,In!A1)', 1, 10),
        ("=LOG10(In!A1)", 0, 1),
        ("=SUMPRODUCT((In!A1:A9>5)*1)", 4, 5),
        ("=CHOOSE(1,In!A1,In!A2)", 1, 10),
        ("=-In!A1%", -0.01, -0.1),
        ('=_xlfn.CONCAT(In!A1,"!A2")', "1!A2", "10!A2"),
        ("=VLOOKUP(In!A1,In!A1:A9,1,FALSE)", 1, 10),
    ],
)
def test_dependence_is_found(tmp_path: Path, formula: str, old: Any, new: Any) -> None:
    path = workbook_of(
        tmp_path / "t.xlsx",
        {"B2": (formula, old)},
        {"Twofold": "=In!$A$1*2", "first": "=In!$A$1", "third": "=In!$A$3"},
    )
    values, report = refreshed(path, {"A1": 10.0})
    assert report.affected == 1
    assert values["B2"] in (None, new)
    # What formualizer does not calculate is removed, never left.
    if not any(word in formula for word in ("INDIRECT", "OFFSET", "first:third")):
        assert values["B2"] == new


def test_long_chains_and_cycles_end(tmp_path: Path) -> None:
    cells = {f"A{row}": (f"=A{row - 1}+1" if row > 1 else "=In!A1", row) for row in range(1, 1500)}
    path = workbook_of(tmp_path / "t.xlsx", cells)
    values, report = refreshed(path, {"A1": 2.0})
    assert report.affected == 1499
    assert values["A1499"] in (None, 1500)
    path = workbook_of(tmp_path / "c.xlsx", {"A1": ("=B1+In!A1", 0), "B1": ("=A1", 0)})
    values, report = refreshed(path, {"A1": 2.0})
    assert values == {"A1": None, "B1": None}
    assert report.method in ("removed", "recalculated")


@pytest.mark.parametrize("calculator", [True, False])
def test_data_tables_are_left_blank_where_they_hang_on_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calculator: bool
) -> None:
    if not calculator:
        monkeypatch.setitem(sys.modules, "formualizer", None)
    path = whatif_workbook(tmp_path / "t.xlsx")
    values, report = refreshed(path, {"A1": 5.0})
    assert {name: values[name] for name in (*VARIED, *HANGING)} == dict.fromkeys(
        (*VARIED, *HANGING)
    )
    assert {name: values[name] for name in UNTOUCHED} == UNTOUCHED
    assert [values[name] for name in RENEWED] == [
        v if calculator else None for v in RENEWED.values()
    ]
    assert report.method == ("recalculated" if calculator else "removed")
    before, after = (parts_of(p)[OUT] for p in (path, path.with_name("out.xlsx")))
    tables = re.findall(rb"<f t=.dataTable.[^>]*/>", before)
    assert re.findall(rb"<f t=.dataTable.[^>]*/>", after) == tables
    assert len(tables) == 4


@pytest.mark.parametrize(
    ("cell", "blank"),
    [
        (
            "C1",
            {"B3", "E4", "J3", "N3", "P1", "P4"},
        ),  # the cell that is varied; its own value shows in none of them
        ("C2", {"J3", "K4", "P3"}),
        ("A4", {"B3", "B4", "B5", "P1", "P5"}),
        ("I4", {"J3", "K4", "P3"}),
        ("F3", {"E4", "F4", "G4", "P2"}),
    ],
)
def test_data_tables_hang_on_their_axes_and_on_the_cells_they_vary(
    tmp_path: Path, cell: str, blank: set[str]
) -> None:
    book = open_workbook(whatif_workbook(tmp_path / "t.xlsx"))
    book.set_cell("Out", cell, 9.0)
    out = openpyxl.load_workbook(book.save(tmp_path / "out.xlsx").path, data_only=True)["Out"]
    assert {name for name in blank if out[name].value is not None} == set()
    others = {"B3": "P1", "E4": "P2", "J3": "P3", "N3": "P4"}
    for first, total in others.items():
        assert (out[first].value is None) == (out[total].value is None)
        assert (out[first].value is None) == (first in blank)


@pytest.mark.parametrize("iterated", [True, False])
@pytest.mark.parametrize("calculator", [True, False])
def test_circles_are_left_blank_where_they_hang_on_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, iterated: bool, calculator: bool
) -> None:
    """What a circle ends at hangs on where it began, and on how a program goes round it."""
    if not calculator:
        monkeypatch.setitem(sys.modules, "formualizer", None)
    path = circular_workbook(tmp_path / "t.xlsx", iterated=iterated)
    values, report = refreshed(path, {"A1": 30.0})
    assert [values[name] for name in ("A1", "B1", "C1")] == [None] * 3
    assert [values[name] for name in ("E1", "E2", "E3")] == [2, 2, 6]  # of their own
    renewed = [60, 61, 36] if calculator else [None] * 3
    assert [values[name] for name in ("D1", "D2", "D3")] == renewed
    assert report.method == ("recalculated" if calculator else "removed")
    asked = parts_of(path.with_name("out.xlsx"))["xl/workbook.xml"]
    assert b'fullCalcOnLoad="1"' in asked
    assert (b'iterate="1" iterateCount="200"' in asked) == iterated


def test_circles_of_any_shape_are_found() -> None:
    cells = {
        "A1": "A1+1", "B1": "B2", "B2": "SUM(B3:B9)", "B5": "B1*2", "C1": "A1", "D1": "D2", "D2": "1",
        "E1": "SUM(E1:E3)", "F2": "SUM(F:F)", "G1": "ROW(G2)", "G2": "COLUMN(G1)", "H1": "B5", "I1": "SUM(J:J)",
        "J7": "Out!I1", "K1": "L1", "L1": "M1", "M1": "K1+D1",
    }  # fmt: skip
    formulas = [FormulaCell("Out", parse_range(cell), text) for cell, text in cells.items()]
    formulas.append(
        FormulaCell("Out", parse_range("X1:Y2"), "Y2")
    )  # an array formula on a cell of its own
    resolver = ReferenceResolver(["Out"], [])
    found = DependencyGraph(formulas, resolver.reads).in_circles()
    names = {str(formulas[index].rect) for index in found}
    assert names == {
        "A1", "B1", "B2", "B5", "E1", "F2", "G1", "G2", "I1", "J7", "K1", "L1", "M1", "X1:Y2"
    }  # fmt: skip
    assert DependencyGraph(formulas[4:7], resolver.reads).in_circles() == set()
    assert DependencyGraph([], resolver.reads).in_circles() == set()


def test_a_circle_among_too_many_formulas_costs_all_their_values(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dependents, "_MOST_STEPS", 5)
    values, report = refreshed(circular_workbook(tmp_path / "t.xlsx"), {"A1": 30.0})
    assert [values[name] for name in ("A1", "B1", "C1", "D1", "D2", "D3")] == [None] * 6
    assert (report.method, values["E3"]) == ("removed", 6)
    assert "recalculated" in report.reason


def test_without_formualizer_affected_values_are_removed(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "formualizer", None)
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    report = book.save(train.with_name("out.xlsx"))
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Summary"]
    assert [sheet[f"B{row}"].value for row in (5, 6)] == [None, None]
    assert [sheet[f"B{row}"].value for row in (1, 2, 7)] == [77, 3, 2]
    assert report.caches.method == "removed"
    assert "formualizer" in report.caches.reason


def test_a_recalculation_that_fails_removes_values(
    train: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Panic(BaseException):
        pass

    def panic(*_: Any, **__: Any) -> None:
        raise Panic("the Rust side gave up")

    import formualizer

    monkeypatch.setattr(formualizer, "recalculate_xlsx_bytes", panic)
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    report = book.refresh_formula_caches()
    assert (report.method, report.removed) == ("removed", 3)
    assert "gave up" in report.reason


def test_formulas_without_a_given_value_are_calculated(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Start-up", "D1", Formula("=SUM(B5:B14)"))
    report = book.save(train.with_name("out.xlsx"))
    assert openpyxl.load_workbook(report.path, data_only=True)["Start-up"]["D1"].value == 9500


def test_macro_workbooks_are_recalculated(macro_train: Path) -> None:
    book = open_workbook(macro_train)
    book.set_name("RatedPower", 5000.0)
    report = book.save(macro_train.with_name("out.xlsm"))
    assert report.caches.method == "recalculated"
    assert openpyxl.load_workbook(report.path, data_only=True)["Summary"]["B5"].value == 2500


def test_typed_over_cells_of_calculated_columns_do_not_stop_the_recalculation(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", [[1, 60.0, 1.0, 5.0], [2, 90.0, 1.0, 6.0]])
    report = book.save(train.with_name("out.xlsx"))
    assert report.caches.method == "recalculated"
    assert openpyxl.load_workbook(report.path, data_only=True)["Summary"]["B1"].value == 90


def test_dynamic_arrays_that_grow_are_removed(tmp_path: Path) -> None:
    path = tmp_path / "t.xlsx"
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    for row in range(9):
        source.write_number(row, 0, row + 1.0)
    sheet.write_dynamic_array_formula("A1:A3", "=_xlfn._xlws.SORT(In!A1:A3,1,-1)", None, 3)
    sheet.write_number("A2", 2)
    sheet.write_number("A3", 1)
    sheet.write_dynamic_array_formula("C1:C2", "=_xlfn._xlws.FILTER(In!A1:A9,In!A1:A9>7)", None, 8)
    sheet.write_number("C2", 9)
    sheet.write_formula("E1", "=C2*10", None, 90)
    sheet.write_formula("E2", "=A2*10", None, 20)
    book.close()
    values, _ = refreshed(path, {"A1": 50.0})
    assert [values[name] for name in ("A1", "A2", "A3")] == [50, 3, 2]
    # The filtered list has three entries now: where they go is for the spreadsheet program to say.
    assert [values[name] for name in ("C1", "C2", "E1")] == [None, None, None]


def test_charts_show_what_the_cells_hold(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", [[i, 10.0 * i, 1.0, 2.0] for i in range(1, 6)])
    out = book.save(train.with_name("out.xlsx")).path
    chart = parts_of(out)["xl/charts/chart1.xml"].decode()
    assert "<c:f>Frequencies!$B$6:$B$10</c:f>" in chart
    assert "<c:f>Frequencies!$C$6:$C$10</c:f>" in chart
    points = "".join(f'<c:pt idx="{i}"><c:v>{10 * (i + 1)}</c:v></c:pt>' for i in range(5))
    assert f'<c:ptCount val="5"/>{points}</c:numCache>' in chart
    assert "<c:v>Frequency</c:v>" in chart


def test_labels_from_cells_follow_their_table(train: Path) -> None:
    """Excel's "value from cells": the range and the words kept beside it."""
    c15 = b"http://schemas.microsoft.com/office/drawing/2012/chart"
    labels = (
        b'<c:extLst><c:ext uri="{02D57815-91ED-43cb-92C2-25804820EDAC}" xmlns:c15="%s">'
        b"<c15:datalabelsRange><c15:f>Frequencies!$C$6:$C$8</c15:f><c15:dlblRangeCache>"
        b'<c:ptCount val="3"/><c:pt idx="0"><c:v>OLD</c:v></c:pt></c15:dlblRangeCache>'
        b"</c15:datalabelsRange></c:ext></c:extLst></c:ser>" % c15
    )
    with_parts(train, {}, {"xl/charts/chart1.xml": lambda one: one.replace(b"</c:ser>", labels, 1)})
    book = open_workbook(train)
    book.write_table("Modes", [[i, 10.5 * i, 1.0, 2.0] for i in range(1, 5)])
    out = book.save(train.with_name("out.xlsx")).path
    chart = parts_of(out)["xl/charts/chart1.xml"].decode()
    points = "".join(f'<c:pt idx="{i}"><c:v>{10.5 * (i + 1):g}</c:v></c:pt>' for i in range(4))
    assert "OLD" not in chart
    assert (
        "<c15:f>Frequencies!$C$6:$C$9</c15:f><c15:dlblRangeCache>"
        f'<c:ptCount val="4"/>{points}</c15:dlblRangeCache>'
    ) in chart


def test_untouched_charts_stay_byte_identical(train: Path) -> None:
    book = open_workbook(train)
    for row in range(5, 15):
        book.set_cell("Start-up", f"B{row}", {5: 2.0, 7: "text"}.get(row))
    out = book.save(train.with_name("out.xlsx")).path
    assert {name for name in changed_parts(train, out) if "chart" in name} == {
        "xl/charts/chart3.xml"
    }
    chart = parts_of(out)["xl/charts/chart3.xml"].decode()
    assert '<c:ptCount val="10"/><c:pt idx="0"><c:v>2</c:v></c:pt></c:numCache>' in chart


def test_charts_follow_renewed_formulas(tmp_path: Path) -> None:
    path = tmp_path / "t.xlsx"
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.write_number("A1", 1)
    sheet.write_formula("A1", "=In!A1*2", None, 2)
    sheet.write("B1", "label")
    chart = book.add_chart({"type": "line"})
    chart.add_series(
        {"values": "=Out!$A$1:$A$1", "categories": "=(Out!$B$1,Out!$A$1)", "name": "=Series"}
    )
    sheet.insert_chart("D2", chart)
    book.define_name("Series", "=In!$A$1")
    book.close()
    opened = open_workbook(path)
    opened.set_cell("In", "A1", 21.0)
    text = parts_of(opened.save(tmp_path / "out.xlsx").path)["xl/charts/chart1.xml"].decode()
    assert "<c:v>42</c:v>" in text


def test_references_of_formulas() -> None:
    parsed = parse_formula(
        "SUM('My ''Sheet'!$A$1:B2,Tbl[[#This Row],[a]b']],Name)+LOG10(XFE1)&\"A9\""
    )
    assert [one.text for one in parsed.references if isinstance(one, Reference)] == ["$A$1:B2"]
    assert parsed.references[0].sheet == "'My ''Sheet'!"
    assert parsed.functions == {"SUM", "LOG10"}
    assert parsed.names == ["Name", "XFE1"]
    assert not parse_formula("SUM(A1,{1,2;3,4},#REF!)").unclear
    own = parse_formula('IF(In!A1>0,indirect("$B" & ROW(C7)-1)+1,0)')
    assert [one.text for one in own.references if isinstance(one, Reference)] == [
        "A1",
        "$B:$B",
        "C7",
    ]
    assert not own.unclear
    for unclear in (
        "A1:CHOOSE(1,B1)",
        "A1:INDEX(B:B,2):C3",
        "A1:INDEX((B1,B2),1)",
        "A1:INDEX(B1 B1:B2,1)",
        "INDIRECT(A1)",
        "Sheet1:Sheet3!A1!",
        "Tbl[oops",
    ):
        assert parse_formula(unclear).unclear, unclear
    span = parse_formula("SUM(A1:INDEX(Tbl[#All],ROWS(Tbl[#All]),2))")
    assert not span.unclear
    (around, _) = span.references
    assert (around.start.text, around.within.table) == ("A1", "Tbl")


@pytest.mark.parametrize(
    ("formula", "cell", "reads"),
    [
        ("=SUM(In!A2:INDEX(In!A1:A3,2))", "A3", True),
        ("=SUM(In!A2:INDEX(In!A1:A3,2))", "A4", False),
        ('=INDIRECT("A"&ROW(In!A3)-1)', "A4", False),
        ("=SUM(In!A6:INDEX(first,1))", "A4", True),
        ("=SUM(In!A6:INDEX(first,1))", "A7", False),
    ],
)
def test_a_range_that_ends_in_index_reads_what_lies_between(
    tmp_path: Path, formula: str, cell: str, reads: bool
) -> None:
    path = workbook_of(tmp_path / "t.xlsx", {"B2": (formula, 0)}, {"first": "=In!$A$1:$A$2"})
    assert refreshed(path, {cell: 10.0})[1].affected == int(reads)


@pytest.mark.parametrize(
    ("text", "shift", "moved"),
    [
        ("A1+$A1+A$1+$A$1", (2, 3), "D3+$A3+D$1+$A$1"),
        ('"A1"&S1!A1:B2', (1, 1), '"A1"&S1!B2:C3'),
        ("SUM(A:A,$B:$B,1:1,$2:$2)", (1, 1), "SUM(B:B,$B:$B,2:2,$2:$2)"),
        ("A1", (-1, 0), "#REF!"),
        ("LOG10(A1)+Tbl[A1]", (1, 0), "LOG10(A2)+Tbl[A1]"),
        ("'A1'!A1", (1, 0), "'A1'!A2"),
    ],
)
def test_filling_moves_relative_references(text: str, shift: tuple[int, int], moved: str) -> None:
    assert shifted_formula(text, *shift) == moved


def wide_workbook(path: Path, tables: int, *, named: bool = False, formula: bool = False) -> Path:
    """Out!A1 reads the first of some tables of 60 columns and 50 rows on sheet Data, which may hold a formula."""
    book = xlsxwriter.Workbook(str(path))
    source, sheet, data = (book.add_worksheet(name) for name in ("In", "Out", "Data"))
    source.write_number("A1", 1)
    for number in range(tables):
        top = 60 * number
        headers = [{"header": f"c{column}"} for column in range(60)]
        rows = [[row + 0.5] * 60 for row in range(50)]
        data.add_table(
            top, 0, top + 50, 59, {"name": f"Wide_{number}", "columns": headers, "data": rows}
        )
    sheet.write_formula("A1", "=SUM(Wide_0[c2])+In!A1", None, 1251)
    if formula:
        data.write_formula("BK1", "=In!A1+1", None, 2)
    if named:
        book.define_name("Last", f"=ROWS(Wide_{tables - 1})")
    book.close()
    return path


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("formula", [False, True])
@pytest.mark.parametrize("tables", [1, 4, 5, 9])
def test_tables_that_no_formula_reads_do_not_limit_the_recalculation(
    tmp_path: Path, tables: int, formula: bool
) -> None:
    # The calculator takes 256 columns in all.
    path = wide_workbook(tmp_path / "t.xlsx", tables, formula=formula)
    values, report = refreshed(path, {"A1": 2.0})
    assert report.method == "recalculated"
    assert values["A1"] == 1252
    changed = changed_parts(path, path.with_name("out.xlsx"))
    beside = {"xl/worksheets/sheet3.xml"} if formula else set()
    assert changed == {"xl/worksheets/sheet1.xml", "xl/worksheets/sheet2.xml"} | beside


def test_tables_of_which_cells_are_read_do_not_limit_the_recalculation(tmp_path: Path) -> None:
    """As on a sheet of ours with long tables, beside which somebody adds up what stands in them."""
    path = wide_workbook(tmp_path / "t.xlsx", 9)
    book = open_workbook(path)
    book.set_cell("Out", "B1", Formula("SUM(Data!A1:BH541)+In!A1", 0.0))
    book.set_cell("Data", "BK2", Formula("MAX(A:A)*In!A1", 0.0))
    book.save(tmp_path / "typed.xlsx")
    book = open_workbook(tmp_path / "typed.xlsx")
    book.set_cell("In", "A1", 2.0)
    report = book.refresh_formula_caches()
    assert (report.method, report.removed) == ("recalculated", 0)
    # nine tables of 60 columns with the numbers 0.5 to 49.5
    assert book.value("Out", "B1").cached == 9 * 60 * 1250 + 2
    assert book.value("Data", "BK2").cached == 49.5 * 2


def test_formulas_that_name_many_tables_are_all_renewed(tmp_path: Path) -> None:
    """Nine tables of 60 columns, more than twice as many as the calculator takes."""
    path = wide_workbook(tmp_path / "t.xlsx", 9)
    book = open_workbook(path)
    for number in range(9):
        whole = f"SUM(Wide_{number}[c1])+0*COUNT(Wide_{number})+In!A1"
        book.set_cell("Out", f"B{number + 1}", Formula(whole, 0.5))
        book.set_cell("Out", f"C{number + 1}", Formula(f"B{number + 1}*2", 1.0))
    book.set_cell("Out", "D1", Formula("SUM(Wide_0[[c3]:[c5]])+COUNT(Wide_3)+In!A1", 0.5))
    book.save(tmp_path / "typed.xlsx")
    book = open_workbook(tmp_path / "typed.xlsx")
    book.set_cell("In", "A1", 2.0)
    report = book.refresh_formula_caches()
    assert (report.method, report.removed) == ("recalculated", 0)
    # a column holds the numbers 0.5 to 49.5
    assert [book.value("Out", f"B{n + 1}").cached for n in range(9)] == [1252] * 9
    assert [book.value("Out", f"C{n + 1}").cached for n in range(9)] == [2504] * 9
    assert book.value("Out", "D1").cached == 3 * 1250 + 60 * 50 + 2


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "cell",
    [
        b'<c r="B1"><f>INDIRECT("Data!A1")</f>',
        b'<c r="B1"><f>INDIRECT("Wide_7["&amp;"c1]")</f>',
        b'<c r="B1"><f>IFERROR(SUM(INDIRECT("Wide_7[c1]")),In!A1)</f>',
        b'<c r="B1"><f>COUNT(INDIRECT(In!B1),In!A1)</f>',
        b'<c r="B1"><f>_xlfn.FORMULATEXT(A1)</f>',
        b'<c r="B1"><f>GETPIVOTDATA("Sum",Data!$A$1)</f>',
        b'<c r="B1" cm="1"><f t="array" ref="B1">INDIRECT("Data!A"&amp;A1)</f>',
        b'<c r="B1"><f>In!A1+%s1%s</f>' % (b"(" * 300, b")" * 300),
        b'<c r="B1"><f>In!A1%s</f>' % (b"+1" * 4_200),
        b'<c r="B1"><f>SUM(Wide_0[</f>',
        b'<c r="B1"><f>_xlfn.LAMBDA(_xlpm.x,_xlpm.x+In!A1)(1)</f>',
        b'<c r="B1"><f t="shared" ref="B1:C1" si="7">OFFSET(INDIRECT("Wide_3"),0,0)</f>',
    ],
)
def test_a_formula_that_cannot_be_calculated_costs_itself_alone(
    tmp_path: Path, cell: bytes
) -> None:
    """Of some is not known what they read, some could tell a table from its cells, some the calculator refuses."""
    path = wide_workbook(tmp_path / "t.xlsx", 9)
    out = "xl/worksheets/sheet2.xml"

    def more(data: bytes) -> bytes:
        return data.replace(
            b"</row></sheetData>",
            cell + b'<v>0.5</v></c><c r="C1"><f>B1*2</f><v>1</v></c></row></sheetData>',
        )

    values, report = refreshed(with_parts(path, {}, {out: more}), {"A1": 2.0})
    assert (report.method, report.removed) == ("recalculated", 2)
    assert values == {"A1": 1252, "B1": None, "C1": None}


#: What the calculator refuses whole workbooks for, with no circle and no function that reads anything.
REFUSED = (
    "Data[[#Totals],[Head]]+In!A2",
    "SUM(Data[[#This Row],[Flow]])",
    "SUM(Data[Nope])+In!A2",
    "SUM((In!A2:A3,In!B2))",
    "SUM(In:Out!A2)",
    "In!A2+",
)


@pytest.mark.parametrize("text", REFUSED)
def test_a_formula_that_the_calculator_refuses_costs_itself_alone(
    tmp_path: Path, text: str
) -> None:
    good = {f"C{k}": (f"=In!A2*{k}", float(k)) for k in range(1, 20)}
    formulas = {"B1": ("=SUM(Data[Flow])", 6), "B2": (f"={text}", 7.5), "B3": ("=B2*2", 15)}
    path = with_table(tmp_path / "t.xlsx", {**formulas, **good, "B4": ("=B1+C2", 8)}, {})
    values, report = refreshed(path, {"A2": 10.0})
    assert (report.method, report.removed) == ("recalculated", 2)
    assert (values["B2"], values["B3"]) == (None, None)
    assert (values["B1"], values["B4"]) == (15, 35)
    assert {cell: values[cell] for cell in good} == {f"C{k}": 10 * k for k in range(1, 20)}


def test_several_formulas_that_the_calculator_refuses_cost_themselves_alone(
    tmp_path: Path,
) -> None:
    good = {f"C{k}": (f"=In!A2*{k}", float(k)) for k in range(1, 40)}
    refused = {f"B{k}": (f"={text}", 7.5) for k, text in enumerate(REFUSED, start=1)}
    mixed = dict(sorted({**good, **refused}.items(), key=lambda one: one[0][1:]))
    path = with_table(tmp_path / "t.xlsx", mixed, {})
    values, report = refreshed(path, {"A2": 10.0})
    assert (report.method, report.removed) == ("recalculated", len(REFUSED))
    assert {cell: values[cell] for cell in refused} == dict.fromkeys(refused)
    assert {cell: values[cell] for cell in good} == {f"C{k}": 10 * k for k in range(1, 40)}


@pytest.mark.parametrize("most", [0, 1, 100])
def test_refused_formulas_that_take_long_to_find_cost_their_neighbours_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    good = {f"C{k}": (f"=In!A2*{k}", float(k)) for k in range(1, 40)}
    path = with_table(tmp_path / "t.xlsx", {**good, "D1": ("=SUM((In!A2:A3,In!B2))", 7.5)}, {})
    monkeypatch.setattr("addin.xlsx.formulas._MOST_TRIES", most)
    values, _ = refreshed(path, {"A2": 10.0})
    assert values["D1"] is None
    renewed = {cell: values[cell] for cell in good if values[cell] is not None}
    assert renewed == {cell: 10 * int(cell[1:]) for cell in renewed}
    assert len(renewed) == {0: 0, 1: 20, 100: 39}[most]


def test_a_totals_row_costs_itself_alone(tmp_path: Path) -> None:
    """Its formula names a column of the table that it stands in."""
    path = tmp_path / "t.xlsx"
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.add_table(
        "A1:B5",
        {"name": "Data", "total_row": True, "data": [[1, 4], [2, 5], [3, 6]],
         "columns": [{"header": "Flow", "total_function": "sum", "total_value": 6}, {"header": "Head"}]},
    )  # fmt: skip
    for cell, formula, value in (
        ("A1", "=SUM(Data[Flow])", 6),
        ("A2", "=Data[[#Totals],[Flow]]*2", 12),
        ("A3", "=In!A2*7", 7),
    ):
        sheet.write_formula(cell, formula, None, value)
    book.close()
    values, report = refreshed(path, {"A2": 10.0})
    assert report.method == "recalculated"
    assert (values["A1"], values["A3"]) == (15, 70)
    assert values["A2"] in (None, 30)
    total = openpyxl.load_workbook(path.with_name("out.xlsx"), data_only=True)["In"]["A5"].value
    assert total in (None, 15)


@pytest.mark.parametrize("types", ["both", "pictures alone", "pictures first"])
def test_metadata_of_the_copy_for_the_calculator(tmp_path: Path, types: str) -> None:
    """It takes those of dynamic arrays and refuses all others."""
    path = tmp_path / "t.xlsx"
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    for row in range(3):
        source.write_number(row, 0, row + 1.0)
    source.embed_image("D1", "dot.png", {"image_data": tiny_png()})
    sheet.write_formula("B1", "=In!A1*2", None, 2)
    if types != "pictures alone":
        sheet.write_dynamic_array_formula("A1:A3", "=_xlfn._xlws.SORT(In!A1:A3,1,-1)", None, 3)
        sheet.write_number("A2", 2)
        sheet.write_number("A3", 1)
    book.close()
    if types == "pictures first":

        def turned(data: bytes) -> bytes:
            kinds = re.findall(rb"<metadataType .*?/>", data)
            future = re.findall(rb"<futureMetadata .*?</futureMetadata>", data)
            data = data.replace(b"".join(kinds), b"".join(kinds[::-1]))
            data = data.replace(b"".join(future), b"".join(future[::-1]))
            data = data.replace(
                b'<cellMetadata count="1"><bk><rc t="1"', b'<cellMetadata count="1"><bk><rc t="2"'
            )
            return data.replace(
                b'<valueMetadata count="1"><bk><rc t="2"', b'<valueMetadata count="1"><bk><rc t="1"'
            )

        with_parts(path, {}, {"xl/metadata.xml": turned})
    values, report = refreshed(path, {"A1": 50.0})
    assert (report.method, report.removed) == ("recalculated", 0)
    assert values["B1"] == 100
    if types != "pictures alone":
        assert [values[name] for name in ("A1", "A2", "A3")] == [50, 3, 2]
    assert changed_parts(path, path.with_name("out.xlsx")) == {
        "xl/worksheets/sheet1.xml",
        "xl/worksheets/sheet2.xml",
    }
    assert b' t="e" vm="1"' in parts_of(path.with_name("out.xlsx"))["xl/worksheets/sheet1.xml"]


def map_of(book: Workbook) -> FormulaMap:
    return formula_map(
        tuple(_formula_cells(book)),
        tuple(book.sheet_names),
        tuple(book.structure.names),
        tuple(book.tables.values()),
    )


def test_the_copy_for_the_calculator_has_no_tables(tmp_path: Path) -> None:
    book = open_workbook(wide_workbook(tmp_path / "t.xlsx", 3, named=True))
    book.set_cell("In", "A1", 2.0)
    table = book.table("Wide_0")
    for read in ({"Data": table.data.bottom, "In": 1}, None):
        parts, dropped = calculator_copy(book, map_of(book), read)
        assert dropped == {one.part for one in book.tables.values()}
        assert (b'r="170"' in parts["xl/worksheets/sheet3.xml"]) == (read is None)
        assert b"tablePart" not in parts["xl/worksheets/sheet3.xml"]
        assert b"/table" not in parts["xl/worksheets/_rels/sheet3.xml.rels"]
        assert b"/tables/" not in parts["[Content_Types].xml"]
        assert b"<f>SUM(Data!$C$2:$C$51)+In!A1</f>" in parts["xl/worksheets/sheet2.xml"]
        assert b">ROWS(Data!$A$122:$BH$171)<" in parts["xl/workbook.xml"]


def test_a_table_of_a_query_leaves_the_copy_with_what_it_leads_to(tmp_path: Path) -> None:
    path = with_table(tmp_path / "t.xlsx", {"B2": ("=SUM(Data[Flow])", 6)}, {})
    query, holder = "xl/queryTables/queryTable1.xml", "xl/tables/_rels/table1.xml.rels"
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml.queryTable+xml"
    names = "http://schemas.openxmlformats.org/"
    more = {
        query: f'<queryTable xmlns="{names}spreadsheetml/2006/main" name="q" connectionId="1"/>',
        holder: f'<Relationships xmlns="{names}package/2006/relationships"><Relationship Id="rId1" '
        f'Type="{names}officeDocument/2006/relationships/queryTable" Target="../queryTables/queryTable1.xml"/></Relationships>',
    }
    override = f'<Override PartName="/{query}" ContentType="{kind}"/></Types>'.encode()
    with_parts(
        path,
        {name: text.encode() for name, text in more.items()},
        {"[Content_Types].xml": lambda data: data.replace(b"</Types>", override)},
    )
    book = open_workbook(path)
    parts, dropped = calculator_copy(book, map_of(book), None)
    assert dropped == {query, holder, "xl/tables/table1.xml"}
    assert b"queryTable" not in parts["[Content_Types].xml"]
    values, report = refreshed(path, {"A2": 10.0})
    assert (report.method, report.removed, values["B2"]) == ("recalculated", 0, 15)
    assert parts_of(path.with_name("out.xlsx"))[query] == more[query].encode()


def test_rows_below_those_read_are_left_out_of_the_copy(tmp_path: Path) -> None:
    book = open_workbook(workbook_of(tmp_path / "t.xlsx", {"A1": ("=SUM(In!A1:A3)", 6)}))
    parts, _ = calculator_copy(book, map_of(book), {"In": 3})
    sheet = parts["xl/worksheets/sheet1.xml"]
    assert b'<c r="A3">' in sheet
    assert b'<c r="A4">' not in sheet
    assert b"</row></sheetData>" in sheet


def test_charts_are_renewed_again_after_further_changes(train: Path) -> None:
    book = open_workbook(train)
    for last in (50.0, 60.0):
        book.write_table("Modes", [[1, 10.0, 1.0, 2.0], [2, last, 1.0, 2.0]])
        book.refresh_chart_caches()
    out = book.save(train.with_name("out.xlsx")).path
    chart = parts_of(out)["xl/charts/chart1.xml"].decode()
    points = '<c:pt idx="0"><c:v>10</c:v></c:pt><c:pt idx="1"><c:v>60</c:v></c:pt>'
    assert f'<c:ptCount val="2"/>{points}</c:numCache>' in chart
    assert "points-" not in chart


def test_charts_show_cells_that_were_changed_after_their_block(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", [[1, 2.0, 0.0, 0.0], [2, 4.0, 0.0, 0.0], [3, 6.0, 0.0, 0.0]])
    book.set_cell("Frequencies", "C7", 40.0)
    out = book.save(train.with_name("out.xlsx")).path
    chart = parts_of(out)["xl/charts/chart1.xml"].decode()
    shown = "".join(f'<c:pt idx="{i}"><c:v>{v}</c:v></c:pt>' for i, v in enumerate((2, 40, 6)))
    assert f'<c:ptCount val="3"/>{shown}</c:numCache>' in chart


LIST_OF_ANOTHER_SHEET = (
    b'<extLst><ext xmlns:x14="http://schemas.microsoft.com/office/spreadsheetml/2009/9/main" '
    b'uri="{CCE6A557-97BC-4b89-ADB6-D9C93CAAB3DF}"><x14:dataValidations '
    b'xmlns:xm="http://schemas.microsoft.com/office/excel/2006/main" count="1"><x14:dataValidation '
    b'type="list"><x14:formula1><xm:f>In!$A$1:$A$9</xm:f></x14:formula1><xm:sqref>D1</xm:sqref>'
    b"</x14:dataValidation></x14:dataValidations></ext></extLst></worksheet>"
)


def test_a_drop_down_list_of_another_sheet_does_not_stop_the_recalculation(tmp_path: Path) -> None:
    """As Excel stores it since 2010: an extension with a formula, which formualizer refuses."""
    path = workbook_of(tmp_path / "t.xlsx", {"B2": ("=In!A1*2", 2)})
    sheet = "xl/worksheets/sheet2.xml"
    with_parts(path, {}, {sheet: lambda data: data.replace(b"</worksheet>", LIST_OF_ANOTHER_SHEET)})
    values, report = refreshed(path, {"A1": 10.0})
    assert (report.method, values["B2"]) == ("recalculated", 20)
    assert LIST_OF_ANOTHER_SHEET in parts_of(path.with_name("out.xlsx"))[sheet]


def with_rich_values(path: Path) -> Path:
    """In!A9 is a linked data type, In!A8 a picture; Out!B4 shows one of them, Out!D1 is blocked and cannot spill."""
    out = "xl/worksheets/sheet2.xml"

    def rich(cell: bytes, number: bytes) -> Any:
        pattern = rb'<c r="%s"([^>]*?)( t="e")?>(<f.*?</f>)?<v>[^<]*</v>' % cell
        new = rb'<c r="%s"\1 t="e" vm="%s">\3<v>#VALUE!</v>' % (cell, number)
        return lambda data: re.sub(pattern, new, data)

    for part, cell, number in (
        ("xl/worksheets/sheet1.xml", b"A9", b"1"),
        ("xl/worksheets/sheet1.xml", b"A8", b"2"),
        (out, b"B4", b"1"),
        (out, b"D1", b"3"),
    ):
        with_parts(path, {}, {part: rich(cell, number)})
    return path


def test_what_hangs_on_rich_values_is_removed(tmp_path: Path) -> None:
    """The file has #VALUE! for them, and what they show stands elsewhere."""
    path = with_rich_values(
        workbook_of(
            tmp_path / "t.xlsx",
            {
                "B1": ("=In!A1*2", 2),
                "B2": ("=IF(ISERROR(In!A9),0,In!A1)", 1),  # no error to a spreadsheet program
                "B3": ("=B2+1", 2),
                "B4": ("=IF(In!A1>0,In!A9,In!A8)", "#VALUE!"),
                "B5": ('=_FV(In!A9,"Price")*In!A1', 5),
                "B6": ('=_FV(In!A9,"Price")', 5),
                "B7": ("=IF(ISERROR(In!A9),0,7)", 7),
                "B8": ("=COUNTA(In!A1:A9)", 9),
                "D1": ("=SUM(In!A1:A2)", "#VALUE!"),
            },
        )
    )
    values, report = refreshed(path, {"A1": 10.0})
    assert report.method == "recalculated"
    assert values["B1"] == 20
    assert [values[name] for name in ("B2", "B3", "B4", "B5", "B8", "D1")] == [None] * 6
    assert (values["B6"], values["B7"]) == (5, 7)  # these hang on nothing that changed
    after = parts_of(path.with_name("out.xlsx"))
    assert after["xl/worksheets/sheet2.xml"].count(b"vm=") == 0
    assert after["xl/worksheets/sheet1.xml"].count(b'vm="') == 2


def test_rich_values_that_hang_on_nothing_changed_stay(tmp_path: Path) -> None:
    cells = {
        "B1": ("=In!A1*2", 2),
        "B4": ("=IF(In!A2>0,In!A9,In!A8)", "#VALUE!"),
        "D1": ("=In!A3", 1),
    }
    path = with_rich_values(workbook_of(tmp_path / "t.xlsx", cells))
    values, _ = refreshed(path, {"A1": 10.0})
    assert values["B1"] == 20
    after = parts_of(path.with_name("out.xlsx"))["xl/worksheets/sheet2.xml"]
    assert b'<c r="B4" t="e" vm="1">' in after
    assert b'<c r="D1" t="e" vm="3">' in after


def test_a_number_over_a_picture_takes_its_rich_value_away(tmp_path: Path) -> None:
    path = with_rich_values(workbook_of(tmp_path / "t.xlsx", {"B4": ("=1", 1), "D1": ("=1", 1)}))
    refreshed(path, {"A8": 3.0})
    after = parts_of(path.with_name("out.xlsx"))["xl/worksheets/sheet1.xml"]
    assert b'<c r="A8"><v>3</v></c><' in after.replace(b"</row>", b"<")
    assert after.count(b"vm=") == 1


def with_table(path: Path, formulas: dict[str, tuple[str, Any]], names: dict[str, str]) -> Path:
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.add_table(
        "A1:B4",
        {"name": "Data", "columns": [{"header": "Flow"}, {"header": "Head"}],
         "data": [[1, 4], [2, 5], [3, 6]]},
    )  # fmt: skip
    for cell, (formula, value) in formulas.items():
        sheet.write_formula(cell, formula, None, value)
    for name, text in names.items():
        book.define_name(name, text)
    book.close()
    return path


@pytest.mark.parametrize("text", ["=Data[Flow]", "=data[ flow ]"])
def test_a_name_for_a_column_of_a_table_does_not_stop_the_recalculation(
    tmp_path: Path, text: str
) -> None:
    formulas = {"B2": ("=SUM(Flows)", 6), "B3": ("=SUM(Data[Head])", 15)}
    path = with_table(tmp_path / "t.xlsx", formulas, {"Flows": text})
    values, report = refreshed(path, {"A2": 10.0, "B2": 40.0})
    assert report.method == "recalculated"
    assert (values["B2"], values["B3"]) == (15, 51)
    before, after = (parts_of(p)["xl/workbook.xml"] for p in (path, path.with_name("out.xlsx")))
    assert text[1:].encode() in before
    assert text[1:].encode() in after


def test_a_name_without_certain_meaning_costs_its_own_formulas_alone(tmp_path: Path) -> None:
    """Also those that would hide from the calculator that it is not there."""
    formulas = {
        "B2": ("=SUM(Total)", 21),
        "B3": ("=SUM(Data[Head])", 15),
        "B4": ("=B2+1", 22),
        "B5": ("=IFERROR(Twice,-1)", 42),
        "B6": ("=SUM(Both)", 21),
    }
    names = {
        "Total": "=Data[[#Totals],[Flow]]",
        "Twice": "=2*SUM(total)",
        "Both": "=Data[[#Data],[Flow]:[Head]]",
    }
    path = with_table(tmp_path / "t.xlsx", formulas, names)
    values, report = refreshed(path, {"A2": 10.0, "B2": 40.0})
    assert (report.method, report.removed) == ("recalculated", 3)
    assert (values["B2"], values["B4"], values["B5"]) == (None, None, None)
    assert (values["B3"], values["B6"]) == (51, 66)


def test_formulas_on_other_workbooks_keep_or_lose_their_value_alone(tmp_path: Path) -> None:
    path = workbook_of(
        tmp_path / "t.xlsx",
        {
            "B2": ("=In!A1*2", 2),
            "B3": ("=[1]Limits!$A$1", 7.5),
            "B4": ("='[1]Our limits'!$A$1*In!A1", 3.5),
            "B5": ("=B3+1", 8.5),
            "B6": ("=B4+B2", 5.5),
            "B7": ("=B3+In!A1", 8.5),
        },
    )
    values, report = refreshed(path, {"A1": 10.0})
    assert report.method == "recalculated"
    assert (values["B2"], values["B3"], values["B5"], values["B7"]) == (20, 7.5, 8.5, 17.5)
    assert (values["B4"], values["B6"]) == (
        None,
        None,
    )  # what the other workbook holds is not known
    formulas = openpyxl.load_workbook(path.with_name("out.xlsx"))["Out"]
    assert formulas["B4"].value == "='[1]Our limits'!$A$1*In!A1"


def test_tables_whose_number_is_not_stated_do_not_stop_the_recalculation(tmp_path: Path) -> None:
    """As LibreOffice saves them."""
    path = with_table(tmp_path / "t.xlsx", {"B3": ("=SUM(Data[Head])", 15)}, {})
    sheet = "xl/worksheets/sheet1.xml"
    with_parts(
        path, {}, {sheet: lambda data: data.replace(b'<tableParts count="1">', b"<tableParts>")}
    )
    values, report = refreshed(path, {"B2": 40.0})
    assert (report.method, values["B3"]) == ("recalculated", 51)
    assert b"<tableParts>" in parts_of(path.with_name("out.xlsx"))[sheet]


FILTER = b'<filterColumn colId="0"><filters><filter val="1"/></filters></filterColumn></autoFilter>'


def filtered_workbook(path: Path, also_hidden: int | None = None) -> Path:
    """A filtered table in A1:B6 that shows its first row, ones beside it in D, formulas over those."""
    book = xlsxwriter.Workbook(str(path))
    data, sheet = book.add_worksheet("Data"), book.add_worksheet("Out")
    data.add_table("A1:B6", {"name": "Ours", "columns": [{"header": "A"}, {"header": "B"}]})
    for row in range(1, 11):
        if row < 6:
            data.write_row(row, 0, [float(row), 0.0])
        data.write_number(row, 3, 1.0)
    for row in [*range(2, 6), *([also_hidden] if also_hidden else [])]:
        data.set_row(row, None, None, {"hidden": True})
    book.define_name("Shown", "=SUBTOTAL(109,Data!$D$2:$D$6)")
    for number, (text, value) in enumerate(
        {
            "SUBTOTAL(109,Data!$D$2:$D$6)": 1,
            "AGGREGATE(9,5,Data!$D$2:$D$6)": 1,
            "A1*10": 10,
            "SUM(Data!$D$2:$D$6)": 5,
            "SUBTOTAL(109,Data!$D$7:$D$11)": 4 if also_hidden else 5,
            "Shown+1": 2,
            "SUM(Ours[A])": 15,
        }.items()
    ):
        sheet.write_formula(number, 0, f"={text}", None, value)
    book.close()
    return with_parts(
        path, {}, {"xl/tables/table1.xml": lambda one: one.replace(b"/>", b">" + FILTER, 1)}
    )


@pytest.mark.parametrize("also_hidden", [None, 8])
def test_what_passed_over_rows_that_are_shown_now_is_renewed(
    tmp_path: Path, also_hidden: int | None
) -> None:
    """Rows hidden by somebody else stay so: what passes over them is left to the spreadsheet program."""
    path = filtered_workbook(tmp_path / "t.xlsx", also_hidden)
    book = open_workbook(path)
    book.write_table("Ours", [[10.0 * row, 0.0] for row in range(1, 6)])
    report = book.save(tmp_path / "out.xlsx")
    assert any("filter of table Ours was cleared" in note for note in report.notes)
    assert report.caches.method == "recalculated"
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Out"]
    found = [sheet.cell(row, 1).value for row in range(1, 8)]
    assert found[:5] == [5, 5, 50, 5, 4 if also_hidden else 5]
    assert found[5] is None  # names for such formulas are beyond the calculator
    assert found[6] == 150


def test_what_hangs_on_changes_and_passes_over_hidden_rows_costs_itself_alone(
    tmp_path: Path,
) -> None:
    path = filtered_workbook(tmp_path / "t.xlsx", 8)
    book = open_workbook(path)
    book.set_cell("Data", "D10", 3.0)
    book.set_cell("Data", "A2", 2.0)
    report = book.save(tmp_path / "out.xlsx")
    sheet = openpyxl.load_workbook(report.path, data_only=True)["Out"]
    assert [sheet.cell(row, 1).value for row in (1, 3, 5, 7)] == [1, 10, None, 16]
