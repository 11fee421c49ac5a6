"""Our own templates as engineers return them: read right, written right, and everything else as it was."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from posixpath import join, normpath
from typing import Any

import openpyxl
import pytest
from engineers_workbook import (
    FIRST_RESULT,
    TORQUE_COLUMN,
    VBA,
    engineers_workbook,
    parts_of,
    sheet_name,
)
from lxml import etree
from office_package import part_of_sheet
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.input_copy import COPY_TABLES
from addin.contract.sheets import SCHEMATIC, part_named
from addin.contract.shipped import template_path
from addin.contract.tables import RESULT_TABLES, WORKBOOK_TABLES
from addin.reading.workbook import read_workbook
from addin.template.examples import Example
from addin.verify.file import verify_file
from addin.writing.recalculate import recalculate
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name, parse_range

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")

MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
#: Parts with nothing of ours in them, whatever is recalculated.
NOBODYS = (
    "xl/styles.xml",
    "xl/sharedStrings.xml",
    "xl/theme/theme1.xml",
    "xl/metadata.xml",
    "xl/threadedComments/threadedComment1.xml",
    "xl/persons/person.xml",
    "xl/printerSettings/printerSettings1.bin",
    "xl/externalLinks/externalLink1.xml",
    "customXml/item1.xml",
    "docProps/custom.xml",
    "xl/pivotTables/pivotTable1.xml",
    "xl/pivotTables/pivotTable2.xml",
    "xl/pivotCache/pivotCacheDefinition1.xml",
    "xl/pivotCache/pivotCacheDefinition2.xml",
    "xl/pivotCache/pivotCacheRecords1.xml",
    "xl/pivotCache/pivotCacheRecords2.xml",
    "xl/slicers/slicer1.xml",
    "xl/slicers/slicer2.xml",
    "xl/slicerCaches/slicerCache1.xml",
    "xl/slicerCaches/slicerCache2.xml",
    "xl/richData/rdrichvalue.xml",
    "xl/richData/rdrichvaluestructure.xml",
    "xl/richData/rdRichValueTypes.xml",
    "xl/richData/richValueRel.xml",
    "xl/richData/_rels/richValueRel.xml.rels",
    "xl/richData/rdarray.xml",
    "xl/richData/rdsupportingpropertybag.xml",
    "xl/richData/rdsupportingpropertybagstructure.xml",
    "xl/richData/richStyles.xml",
)
#: Formulas that are left blank and named: a function of a macro, fields of linked data types, a pivot table.
NOBODY_CAN_TELL = {
    *(f"Our summary!{cell}" for cell in ("B11", "C20", "D20", "E20")), "Our pivots!H3",
}  # fmt: skip
#: Sheets whose cells differ from run to run: date, wall times.
OF_EACH_RUN = ("Lists", "ChartData", "Effects and accuracy", "Audit", "Summary")


@pytest.fixture(scope="module", params=["xlsx", pytest.param("xlsm", marks=pytest.mark.slow)])
def returned(request, tmp_path_factory) -> tuple[Path, Path, Path]:
    """As it came back, recalculated once, recalculated twice."""
    folder = tmp_path_factory.mktemp(request.param)
    source = engineers_workbook(folder / f"train.{request.param}", macros=request.param == "xlsm")
    once, twice = folder / f"once.{request.param}", folder / f"twice.{request.param}"
    for given, written in ((source, once), (once, twice)):
        done = recalculate(
            given, destination=written, json_file=written.with_suffix(".json"), overrides={}
        )
        assert done.problems == ()
        named = [w for w in done.warnings if "formulas have no stored value" in w]
        cells = [w.split("open the workbook: ")[1].split(". ")[0].split(", ") for w in named]
        assert {cell for one in cells for cell in one} == NOBODY_CAN_TELL
    return source, once, twice


#: The sheets of both kinds are the same.
ONE_KIND = pytest.mark.parametrize("returned", ["xlsx"], indirect=True)


def changed(before: Path, after: Path) -> set[str]:
    old, new = parts_of(before), parts_of(after)
    return {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}


# --- (a) everything else stays --------------------------------------------------------------------


@pytest.mark.slow
def test_the_corpus_holds_what_it_should(returned):
    """What would be lost first: if the builder stops making it, these tests prove nothing."""
    names = set(parts_of(returned[0]))
    text = b"".join(data for name, data in parts_of(returned[0]).items() if name.endswith(".xml"))
    assert set(NOBODYS) <= names
    for word in (b"x14:sparkline", b"x14:dataValidation ", b"x14:dataBar", b"<picture r:id",
                 b"legacyDrawingHF", b"textlink=", b"<c:trendline>", b"<c:errBars>", b"sheetProtection",
                 b"workbookProtection", b"externalReference ", b'cm="1"', b'hidden="1"', b"calculatedColumn",
                 b"featurepropertybag", b"<hyperlink ", b"<legacyDrawing ", b'state="hidden"',
                 b"<pivotCache ", b"<x14:slicerCaches>", b"<x15:slicerCaches ", b"<x14:slicerList",
                 b"<sle:slicer ", b"x15:tableSlicerCache", b'vm="1"', b'vm="2"', b'cm="1" vm="3"',
                 b'name="XLDAPR"', b'name="XLRICHVALUE"', b"<cellMetadata ", b"<valueMetadata "):  # fmt: skip
        assert word in text, word
    assert any(name.startswith("xl/media/") for name in names)


@pytest.mark.slow
def test_parts_without_results_stay_byte_identical_twice_over(returned):
    source, once, twice = returned
    parts = parts_of(source)
    for before, after in ((source, once), (once, twice), (source, twice)):
        for name in changed(before, after):
            if re.fullmatch(r"xl/drawings/drawing\d+\.xml", name):
                assert _not_ours(parts_of(before)[name]) == _not_ours(parts_of(after)[name]), name
                continue
            assert re.fullmatch(
                r"xl/(worksheets/sheet\d+|tables/table\d+|charts/chart\d+|workbook)\.xml"
                r"|xl/calcChain\.xml|\[Content_Types\]\.xml|xl/_rels/workbook\.xml\.rels",
                name,
            ), name
            assert name not in NOBODYS
        assert set(parts_of(after)) | {"xl/calcChain.xml"} >= set(parts_of(before))
    if "xl/vbaProject.bin" in parts:
        assert parts_of(twice)["xl/vbaProject.bin"] == VBA


def _not_ours(drawing: bytes) -> list[bytes]:
    """Anchors of a drawing but for that of the schematic, and without what hides a chart that has nothing to draw."""
    anchors = []
    for anchor in etree.fromstring(drawing):
        named = [e for e in anchor.iter() if etree.QName(e).localname == "cNvPr"]
        if any(e.get("descr") == SCHEMATIC for e in named):
            continue
        for element in named:
            element.attrib.pop("hidden", None)
        anchors.append(etree.tostring(anchor))
    return anchors


def test_the_second_time_only_dates_and_times_change(returned):
    _, once, twice = returned
    parts = parts_of(once)
    sheets = {part_of_sheet(parts, sheet_name(s)) for s in OF_EACH_RUN}
    others = {n for n in changed(once, twice) if n not in sheets and "charts/" not in n}
    # every sheet repeats facts of the run by formulas; those that change are dates only
    assert {n for n in others if not n.startswith("xl/worksheets/")} == set()
    for name in others:
        assert _values_apart_from_dates(parts_of(once)[name], parts_of(twice)[name]) == []
    for name in (n for n in changed(once, twice) if "charts/" in n):
        assert b"ChartAccuracy" in parts[name] or b"ChartData" in parts[name]


def _values_apart_from_dates(before: bytes, after: bytes) -> list[str]:
    old, new = ({c.get("r"): c.findtext(f"{MAIN}v") for c in etree.fromstring(d).iter(f"{MAIN}c")}
                for d in (before, after))  # fmt: skip
    date = re.compile(r"\d{4}-\d\d-\d\d")
    return [c for c in old if old[c] != new.get(c) and not date.search(str(old[c]))]


def test_in_a_sheet_with_results_only_owned_cells_and_values_change(returned):
    """Formulas, styles, texts, widths, panes, protection, drawings, links, print set-up: as they were."""
    source, once, _ = returned
    before, after = parts_of(source), parts_of(once)
    owned = _owned_cells(source, once)
    compared = 0
    for name in sorted(n for n in changed(source, once) if n.startswith("xl/worksheets/")):
        old, new = etree.fromstring(before[name]), etree.fromstring(after[name])
        assert _frame(old) == _frame(new), name
        mine = owned.get(name, set()) | _in_arrays(old)
        was, now = dict(_cells(old)), dict(_cells(new))
        for cell in was.keys() | now.keys():
            if cell in mine:
                continue
            style, formula, value = was.get(cell, (None, None, None))
            style_now, formula_now, value_now = now.get(cell, (None, None, None))
            assert (style, formula) == (style_now, formula_now), f"{name} {cell}"
            if formula is None:
                assert value == value_now, f"{name} {cell}"
            compared += 1
    assert compared > 1000


#: What of a sheet follows the size of a table, or is cells.
_FOLLOWS = {"sheetData", "dimension", "conditionalFormatting", "dataValidations", "extLst"}


def _frame(root: Any) -> list[bytes]:
    return [etree.tostring(e) for e in root if etree.QName(e).localname not in _FOLLOWS]


def _cells(root: Any) -> Iterator[tuple[str, tuple]]:
    for c in root.iter(f"{MAIN}c"):
        formula = c.find(f"{MAIN}f")
        text = None if formula is None else etree.tostring(formula).split(b"</v>")[0]
        value = c.findtext(f"{MAIN}v"), c.get("t")
        if len(c):
            yield c.get("r"), (c.get("s"), text, value)


def _in_arrays(root: Any) -> set[str]:
    """Cells that show the results of an array formula in another cell."""
    found: set[str] = set()
    for formula in root.iter(f"{MAIN}f"):
        if formula.get("t") == "array":
            rect = parse_range(formula.get("ref"))
            rows, columns = range(rect.top, rect.bottom + 1), range(rect.left, rect.right + 1)
            found |= {cell_name(r, c) for r in rows for c in columns}
            found.discard(cell_name(rect.top, rect.left))
    return found


def _owned_cells(*paths: Path) -> dict[str, set[str]]:
    """Cells of result, fact and chart tables, and of the copy of the inputs, in any of the workbooks, by sheet part."""
    found: dict[str, set[str]] = {}
    owned = {s.name for s in (*RESULT_TABLES, *WORKBOOK_TABLES)} | {"RunFacts"}
    owned |= {name for name, _ in COPY_TABLES}
    for path in paths:
        workbook = open_workbook(path, read_only=True)
        for name, table in workbook.tables.items():
            if name in owned or name.startswith("Chart"):
                part = workbook.structure.worksheet_part(table.sheet)
                data = table.data
                found.setdefault(part, set()).update(
                    cell_name(r, c)
                    for r in range(data.top, data.bottom + 1)
                    for c in range(data.left, data.right + 1)
                )
    return found


@ONE_KIND
def test_every_part_has_its_kind_and_every_relationship_its_part(returned):
    """Of the workbook as built, else the tests would prove nothing of real ones; and as it was written."""
    for path in returned:
        parts = parts_of(path)
        types = etree.fromstring(parts["[Content_Types].xml"])
        overrides = {e.get("PartName")[1:] for e in types if e.get("PartName")}
        endings = {e.get("Extension") for e in types if e.get("Extension")}
        assert overrides <= set(parts)
        named = set()
        for name, data in parts.items():
            assert (
                name == "[Content_Types].xml"
                or name in overrides
                or name.rpartition(".")[2] in endings
            )
            if not name.endswith(".rels"):
                continue
            folder = name.replace("_rels/", "").rpartition("/")[0]
            for link in etree.fromstring(data):
                if link.get("TargetMode") != "External":
                    target = link.get("Target")
                    full = target[1:] if target[0] == "/" else normpath(join(folder, target))
                    assert full in parts, (name, target)
                    named.add(full)
        loose = set(parts) - named - {n for n in parts if n.endswith(".rels")}
        assert loose <= {"[Content_Types].xml", "customXml/item1.xml"}


@ONE_KIND
def test_cells_keep_what_they_have_of_dynamic_arrays_and_of_rich_values(returned):
    """Both numbers lead into xl/metadata.xml, which stays as it is."""
    was, now = (parts_of(p)[part_of_sheet(parts_of(p), "Our summary")] for p in returned[:2])
    for cell, attributes in (
        ("M60", {"t": "e", "vm": "1"}),
        ("A20", {"t": "e", "vm": "2"}),
        ("A21", {"t": "e", "cm": "1", "vm": "3"}),
    ):
        old, new = (
            next(c for c in etree.fromstring(d).iter(f"{MAIN}c") if c.get("r") == cell)
            for d in (was, now)
        )
        assert dict(new.attrib) == dict(old.attrib)
        assert attributes.items() <= dict(new.attrib).items()
        assert [e.text for e in new] == [e.text for e in old]
    assert b'<c r="B10" cm="1">' in now  # a dynamic array, renewed


@ONE_KIND
def test_what_may_be_old_in_pivot_tables_is_told(returned, tmp_path):
    done = recalculate(returned[0], destination=tmp_path / "out.xlsx")
    assert any("Pivot tables show old values until" in w for w in done.warnings)


@ONE_KIND
def test_rules_and_lists_of_the_engineer_stay(returned):
    source, once, _ = returned
    for sheet in ("Our summary", sheet_name("Results")):
        before = parts_of(source)[part_of_sheet(parts_of(source), sheet)]
        after = parts_of(once)[part_of_sheet(parts_of(once), sheet)]
        for tag in (rb"<x14:dataValidations.*?</x14:dataValidations>",
                    rb"<x14:conditionalFormattings>.*?</x14:conditionalFormattings>"):  # fmt: skip
            assert re.findall(tag, before, re.DOTALL) == re.findall(tag, after, re.DOTALL)


# --- (b) read right and written right --------------------------------------------------------------


@ONE_KIND
def test_inputs_are_read_where_they_stand_now(returned):
    moved, shipped = (
        read_workbook(returned[0]),
        read_workbook(template_path("example_proposed.xlsx")),
    )
    assert moved.problems == ()
    assert moved.data == shipped.data
    assert moved.locations.cell("Stations", 1, "Inertia")[0] == "Mass-elastic"


def test_results_are_those_of_the_shipped_workbook_bit_for_bit(returned, tmp_path):
    recalculate(
        template_path("example_proposed.xlsx"),
        destination=tmp_path / "shipped.xlsx",
        json_file=tmp_path / "shipped.json",
    )
    shipped = json.loads((tmp_path / "shipped.json").read_text(encoding="utf-8"))
    for path in returned[1:]:
        found = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        for key in shipped:
            if key not in ("audit", "accuracy_cost", "effects"):
                assert found[key] == shipped[key], key


def printed_first(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Responses in the order of the workbook: the largest of each element and those over a limit, then the others."""
    by_element: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        by_element.setdefault(row["element"], []).append(row)
    first = {id(max(one, key=lambda row: row["torque"])) for one in by_element.values()}
    first |= {id(row) for row in rows if row["verdict"] not in ("pass", "not judged")}
    return sorted(rows, key=lambda row: id(row) not in first)


@pytest.mark.slow
@ONE_KIND
def test_every_result_stands_where_its_table_stands_now(returned):
    """Read back by another reader, at the places to which the engineer moved the tables."""
    _, once, _ = returned
    results = json.loads(once.with_suffix(".json").read_text(encoding="utf-8"))
    book = openpyxl.load_workbook(once, data_only=True)
    sheet = book["Forced response (2026)"]
    table = sheet.tables["SteadyState"]
    rows = list(sheet[table.ref])
    headers = [cell.value for cell in rows[0]]
    assert rows[0][0].coordinate == part_named("Steady state").at("C13")
    assert len(rows) - 1 == len(results["steady_state"])
    at = headers.index("Frequency")
    for row, expected in zip(rows[1:], printed_first(results["steady_state"]), strict=True):
        assert row[0].value == expected["element"]
        assert row[at].value == pytest.approx(expected["frequency"], rel=1e-12)
    # the engineer hid columns: a reader does not see those numbers
    assert {f.kind for f in verify_file(once).findings if f.fails} == {"hidden"}


@pytest.mark.slow
@ONE_KIND
def test_charts_and_sparklines_of_the_engineer_follow_the_tables(returned):
    """His chart covered the data rows of our tables as shipped, one row; now it covers all of them."""
    _, once, _ = returned
    parts = parts_of(once)
    charts = [
        d.decode() for n, d in parts.items() if n.startswith("xl/charts/") and b"Our own chart" in d
    ]
    assert len(charts) == 1
    book = openpyxl.load_workbook(once)
    for sheet, table, column in (
        ("Forced response (2026)", "SteadyState", TORQUE_COLUMN), ("Owner's start", "StartupPeaks", "C")
    ):  # fmt: skip
        top, bottom = (int(n) for n in re.findall(r"\d+", book[sheet].tables[table].ref))
        quoted = sheet.replace("'", "''")
        assert f"'{quoted}'!${column}${top + 1}:${column}${bottom}" in charts[0]
    own = parts[part_of_sheet(parts, "Our summary")].decode()
    first = rf"\$?{TORQUE_COLUMN}\$?{FIRST_RESULT}"
    last = rf"\$?{TORQUE_COLUMN}\$?\d{{2,}}"
    assert re.search(rf"<xm:f>'Forced response \(2026\)'!{first}:{last}</xm:f>", own)


def more_points(example: Example) -> Example:
    """The motor's curve typed at three times as many points: the table is longer than shipped."""
    rows = example.tables["MotorTorque"]
    longer = []
    for a, b in zip(rows, rows[1:], strict=False):
        for share in (0.0, 1 / 3, 2 / 3):
            mixed = {k: a[k] + share * (b[k] - a[k]) for k in ("Speed", "Average", "Pulsating")}
            longer.append(a | mixed)
    return replace(example, tables={**example.tables, "MotorTorque": [*longer, rows[-1]]})


@pytest.mark.slow
def test_a_table_longer_than_shipped_is_read_to_its_end(tmp_path):
    source = engineers_workbook(tmp_path / "long.xlsx", edit_example=more_points)
    read = read_workbook(source)
    assert read.problems == ()
    assert len(read.data.motor_torque) == 40
    assert recalculate(source, destination=tmp_path / "out.xlsx").problems == ()
    assert {f.kind for f in verify_file(tmp_path / "out.xlsx").findings if f.fails} == {"hidden"}


def test_an_error_is_named_where_it_stands_now(tmp_path):
    def soft(example: Example) -> Example:
        rows = [dict(row) for row in example.tables["Elements"]]
        rows[2]["SCF"] = -5.0
        return replace(example, tables={**example.tables, "Elements": rows})

    source = engineers_workbook(tmp_path / "wrong.xlsx", edit_example=soft)
    done = recalculate(source, destination=tmp_path / "out.xlsx")
    assert [(p.sheet, p.cell) for p in done.problems] == [("Mass-elastic", "Q38")]
    assert not (tmp_path / "out.xlsx").exists()


# --- (c) values of formulas: fresh or absent --------------------------------------------------------


def own_values(path: Path) -> dict[str, Any]:
    sheet = openpyxl.load_workbook(path, data_only=True)["Our summary"]
    return {sheet[f"A{row}"].value: sheet[f"B{row}"].value for row in range(1, 12)}


@pytest.mark.slow
@ONE_KIND
def test_formulas_of_the_engineer_are_fresh_or_blank(returned):
    _, once, _ = returned
    results = json.loads(once.with_suffix(".json").read_text(encoding="utf-8"))
    foot = 0.3048 * 4.4482216152605
    largest = max(row["maximum_torque"] for row in results["startup_peaks"]) / foot
    steady = printed_first(results["steady_state"])
    third = steady[2]["torque"] / foot
    values = own_values(once)
    assert values["largest"] == pytest.approx(largest, rel=1e-12)
    assert values["third torque"] == pytest.approx(third, rel=1e-12)
    assert values["on each other"] == pytest.approx(largest + third, rel=1e-12)
    assert values["by cell"] == pytest.approx(2 * steady[0]["torque"] / foot, rel=1e-12)
    fails = sum(row["verdict"].startswith("fail") for row in results["separation_margins"])
    assert values["fails"] == fails
    assert values["words"].startswith("Verdict: FAIL")
    assert values["sorted"] == pytest.approx(largest, rel=1e-12)
    assert values["today"] == 40000  # hangs on nothing of ours
    assert values["of its own"] == 6
    assert values["unknown"] is None  # a function of a macro, on our results: nobody here can tell
    sheet = openpyxl.load_workbook(once, data_only=True)["Our summary"]
    frequencies = [row["frequency"] for row in results["natural_frequencies"]]
    assert [sheet["D1"].value, sheet["D2"].value] == [2 * frequencies[0], 2 * frequencies[1]] or (
        [sheet["D1"].value, sheet["D2"].value] == [pytest.approx(2 * f) for f in frequencies[:2]]
    )
    assert sheet["I1"].value == 7.5  # another workbook's cell, not ours to change
    # Of a linked data type: what it shows is not in its cell, which no calculator here can tell from an error.
    assert sheet["B20"].value == 103.5
    assert [sheet[name].value for name in ("C20", "D20", "E20")] == [None, None, None]
    assert b'<c r="E20"><f>' in parts_of(once)[part_of_sheet(parts_of(once), "Our summary")]
    # Of a pivot table: nobody here refreshes it.
    assert openpyxl.load_workbook(once, data_only=True)["Our pivots"]["H3"].value is None


@pytest.mark.slow
@ONE_KIND
def test_without_a_calculator_nothing_old_is_left(returned, tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "formualizer", None)
    target = tmp_path / f"blank{returned[0].suffix}"
    done = recalculate(returned[0], destination=target)
    assert any("formulas have no stored value" in w for w in done.warnings)
    values = own_values(target)
    hanging = ("largest", "times rated", "third torque", "by cell", "fails", "words", "on each other",
               "sorted", "unknown")  # fmt: skip
    assert [values[name] for name in hanging] == [None] * len(hanging)
    assert (values["of its own"], values["today"]) == (6, 40000)


@pytest.mark.slow
@ONE_KIND
def test_a_spreadsheet_program_agrees_with_every_value_there_is(returned, soffice, tmp_path):
    """Every cached value of the workbook equals LibreOffice's own; blank is no value."""
    once = returned[1]
    theirs = openpyxl.load_workbook(soffice.convert(once, "xlsx", tmp_path / "lo"), data_only=True)
    ours = openpyxl.load_workbook(once, data_only=True)
    formulas = openpyxl.load_workbook(once)
    # clock, newer functions, macro, other workbook, field of a linked data type
    left_out = {"B7", "B10", "B11", "I1", "A21", "B20"}
    compared = 0
    for sheet in formulas.worksheets:
        if sheet.title == "ChartData":
            continue  # thousands of numbers, no formula
        for row in sheet.iter_rows():
            for cell in row:
                value = ours[sheet.title][cell.coordinate].value
                if cell.data_type != "f" or value is None:
                    continue
                if sheet.title == "Our summary" and cell.coordinate in left_out:
                    continue
                other = theirs[sheet.title][cell.coordinate].value
                where = f"{sheet.title}!{cell.coordinate} {cell.value}"
                if isinstance(value, int | float):
                    assert other == pytest.approx(value, rel=1e-9, abs=1e-12), where
                else:
                    assert (other or "") == (value or ""), where
                compared += 1
    assert compared > 200


# --- (d) upgrade ----------------------------------------------------------------------------------


def test_own_sheets_keep_what_they_refer_to_by_number(tmp_path):
    """Pivot tables without their store, formulas of other workbooks and rich values without theirs are damage to Excel."""
    source = engineers_workbook(tmp_path / "train.xlsx")
    before = parts_of(source)
    done = CliRunner().invoke(app, ["upgrade", str(source)])
    assert done.exit_code == 0, done.output
    after = parts_of(source)
    book = after["xl/workbook.xml"].decode()
    links = after["xl/_rels/workbook.xml.rels"].decode()
    targets = {
        re.search(r'Id="([^"]*)"', one)[1]: re.search(r'Target="/?([^"]*)"', one)[1]
        for one in re.findall(r"<Relationship [^>]*>", links)
    }
    caches = {
        number: after[targets[link]]
        for number, link in re.findall(r'<pivotCache cacheId="(\d+)" r:id="(\w+)"/>', book)
    }
    pivots = [data for name, data in after.items() if name.startswith("xl/pivotTables/pivot")]
    assert {re.search(rb'cacheId="(\d+)"', data)[1].decode() for data in pivots} == set(caches)
    assert len(pivots) == 2
    (other,) = re.findall(r'<externalReference r:id="(\w+)"/>', book)
    assert after[targets[other]] == before["xl/externalLinks/externalLink1.xml"]
    assert b' cm="' in after["xl/worksheets/sheet14.xml"] + after["xl/worksheets/sheet15.xml"]
    for name in ("metadata", "richData/rdrichvalue", "richData/richValueRel"):
        assert before[f"xl/{name}.xml"] in after.values()
    order = [
        book.index(f"<{one}")
        for one in ("sheets", "externalReferences", "definedNames", "calcPr", "pivotCaches")
    ]
    assert order == sorted(order)
    # the array formula in D1:D2 stopped the upgrade; it reads cells that have no place of their own now
    assert "keep their value only: Our summary!D1" in done.output
    own = read_workbook(source).workbook.sheet_part("Our summary")
    assert own.constant(1, 4) is not None
    assert (1, 4) not in own.formulas
