"""Workbooks recalculated by a script, from files and as openpyxl has them in memory."""

import io
import re
import zipfile

import openpyxl
import pytest
from command_line import torsionbook
from openpyxl.chart import LineChart, Reference
from openpyxl.comments import Comment
from openpyxl.formatting.rule import CellIsRule
from openpyxl.styles import Font, PatternFill
from openpyxl.workbook.defined_name import DefinedName
from openpyxl.worksheet.table import Table

import torsionbook as tb
from addin.contract.tables import result_table

EXAMPLES = (
    "example_modified",
    "example_studies",
    pytest.param("example_backlash", marks=pytest.mark.slow),
    pytest.param("example_motor", marks=pytest.mark.slow),
)


def opened(name="example_modified"):
    return openpyxl.load_workbook(tb.template(name))


def cell_of(book, name):
    """The cell of a defined name."""
    sheet, cell = next(book.defined_names[name].destinations)
    return book[sheet][cell.replace("$", "")]


def table_of(book, name):
    """Sheet and rows of a table, header first."""
    sheet = next(sheet for sheet in book.worksheets if name in sheet.tables)
    return sheet, sheet[sheet.tables[name].ref]


def column_of(book, name, header):
    sheet, (head, *rows) = table_of(book, name)
    at = [cell.value for cell in head].index(header)
    return [row[at] for row in rows]


def parts(content, pattern="."):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist() if re.search(pattern, name)}


def sorted_numbers(values):
    return sorted(float(v) for v in values if isinstance(v, (int, float)) and v == v)


def without_results(data):
    """A drawing less what a calculation makes of it: the schematic, and which charts have nothing to draw."""
    data = re.sub(rb"<xdr:grpSp>.*?</xdr:grpSp>", b"", data, flags=re.DOTALL)
    return data.replace(b' hidden="1"', b"")


# --- files ----------------------------------------------------------------------------------------


def test_a_file_keeps_all_that_is_not_a_result(tmp_path):
    source = tb.template("example_modified")
    done = tb.recalculate(source, tmp_path / "train.out.xlsx")
    assert done.path == tmp_path / "train.out.xlsx"
    assert done.path.read_bytes() == done.content
    kept = parts(source.read_bytes(), r"styles\.xml|drawings/|theme")
    assert len(kept) > 10
    written = parts(done.content)
    assert kept.keys() <= written.keys()
    for name, data in kept.items():
        assert without_results(written[name]) == without_results(data), name
    assert [r["frequency"] for r in done.results.rows("NaturalFrequencies")] == [
        r["frequency"] for r in tb.run(source).rows("NaturalFrequencies")
    ]


def test_frames_in_us_units_hold_the_numbers_of_the_sheets():
    """Writer of the workbook and frames go from SI to shown units by ways of their own."""
    done = tb.recalculate(tb.template("example_modified"))
    book, compared = done.workbook(), 0
    for name in done.results.tables:
        frame = done.results.table(name, "us")
        spec = result_table(name)
        for column in spec.columns:
            if column.key not in frame.attrs["units"] or column.wall_time:
                continue
            shown = [cell.value for cell in column_of(book, name, column.name)]
            unit_cell = column_of(book, name, column.name)[0].offset(row=-2)
            assert unit_cell.value == frame.attrs["units"][column.key], (name, column.name)
            pairs = zip(frame[column.key], shown, strict=True)
            if name == "SteadyState":  # the sheet has the rows that decide first
                pairs = zip(*map(sorted_numbers, (frame[column.key], shown)), strict=True)
            for mine, theirs in pairs:
                if isinstance(theirs, (int, float)):
                    assert mine == pytest.approx(theirs, rel=1e-12, abs=1e-300), (name, column.name)
                    compared += 1
    assert compared > 300


def test_without_a_place_the_result_is_in_memory_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = tb.recalculate(tb.template("example_modified"))
    assert done.path is None
    assert list(tmp_path.iterdir()) == []
    shown = [cell.value for cell in column_of(done.workbook(), "NaturalFrequencies", "Frequency")]
    wanted = [row["frequency"] for row in done.results.rows("NaturalFrequencies")]
    assert shown == pytest.approx(wanted, rel=1e-12, abs=1e-12)
    assert done.save("copy.xlsx").read_bytes() == done.content


def test_what_is_no_workbook_is_refused(tmp_path):
    train = tb.read(tb.template("example_modified"))
    with pytest.raises(ValueError, match="is no workbook"):
        tb.recalculate(train.write(tmp_path / "case.json"))
    with pytest.raises(ValueError, match="must end in .xlsx or .xlsm"):
        tb.recalculate(tb.template("example_modified"), tmp_path / "out.json")
    with pytest.raises(ValueError, match="template is for openpyxl workbooks"):
        tb.recalculate(tb.template("example_modified"), template=tb.template("blank_us"))


# --- openpyxl -------------------------------------------------------------------------------------


def test_a_script_types_into_a_template_and_reads_results_back(tmp_path):
    book = opened()
    cell_of(book, "DampingRatio").value = 3.0  # its unit is %
    names = [cell.value for cell in column_of(book, "Elements", "Element")]
    column_of(book, "Elements", "Stiffness")[names.index("LS coupling")].value = 2e8  # lbf*in/rad
    done = tb.recalculate(book, tmp_path / "train.xlsx")
    changed = {"DampingRatio": "3 %", "Elements[LS coupling].Stiffness [lbf*in/rad]": 2e8}
    expected = tb.run(tb.read(tb.template("example_modified")).change(changed))
    for table in ("NaturalFrequencies", "StartupPeaks", "AllowableStarts", "SteadyState"):
        assert done.results.rows(table) == expected.rows(table)
    read_back = done.workbook()
    assert cell_of(read_back, "DampingRatio").value == 3.0
    peaks = [cell.value for cell in column_of(read_back, "StartupPeaks", "Maximum torque")]
    assert len(peaks) == len(expected.rows("StartupPeaks"))
    assert all(isinstance(peak, float) for peak in peaks)


@pytest.mark.parametrize("example", EXAMPLES)
def test_what_comes_back_is_the_shipped_template(tmp_path, example):
    """All parts that openpyxl changes or drops are those of a workbook made by torsionbook."""
    done = tb.recalculate(opened(example))
    shipped = tb.read(tb.template(example)).write(tmp_path / "made.xlsx").read_bytes()
    made = parts(shipped)
    assert parts(done.content).keys() == made.keys()
    for name, data in parts(done.content, r"styles\.xml|drawings/drawing|theme").items():
        if name != "xl/styles.xml":
            assert without_results(data) == without_results(made[name]), name
    assert (
        tb.read(io_path(tmp_path, done.content)).to_json()
        == tb.read(tb.template(example)).to_json()
    )


def io_path(folder, content):
    (path := folder / "again.xlsx").write_bytes(content)
    return path


def test_problems_carry_their_cells_and_nothing_is_written(tmp_path):
    book = opened()
    cell = cell_of(book, "DampingRatio")
    cell.value = -1.0
    with pytest.raises(tb.InputError) as raised:
        tb.recalculate(book, tmp_path / "train.xlsx")
    (problem,) = raised.value.problems
    assert problem.column == "DampingRatio"
    assert problem.cell == cell.coordinate
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def with_sheet():
    """A workbook to which a script has added a sheet with one of everything, recalculated."""
    book = opened()
    sheet = book.create_sheet("Mine")
    sheet["A1"] = "hello"
    sheet["A2"] = "=1+1"
    sheet["A2"].font = Font(bold=True, color="FFFF0000", name="Courier New")
    sheet["A3"] = "=INDEX(NaturalFrequencies[Frequency],2)"
    sheet["A3"].number_format = '0.0000 "Hz"'
    sheet["A4"] = "=2*A3"
    sheet["A5"] = 3.5
    sheet["A5"].comment = Comment("a remark", "me")
    sheet["A6"] = "link"
    sheet["A6"].hyperlink = "https://example.org/"
    sheet["F1"], sheet["G1"], sheet["F2"], sheet["G2"] = "a", "b", 1, 2
    sheet.add_table(Table(displayName="MyTable", ref="F1:G2"))
    yellow = PatternFill(bgColor="FFFFFF00", fill_type="solid")
    sheet.conditional_formatting.add(
        "A2:A5", CellIsRule(operator="greaterThan", formula=["3"], fill=yellow)
    )
    sheet.column_dimensions["A"].width = 31
    sheet.print_area = "A1:G6"
    chart = LineChart()
    chart.add_data(Reference(sheet, min_col=1, min_row=2, max_row=5))
    sheet.add_chart(chart, "C8")
    book.defined_names["MyName"] = DefinedName("MyName", attr_text="Mine!$A$5")
    return tb.recalculate(book)


def test_the_sheets_that_a_script_added_come_along(with_sheet):
    book = openpyxl.load_workbook(io.BytesIO(with_sheet.content))
    assert book.sheetnames[:-1] == opened().sheetnames
    sheet = book["Mine"]
    assert sheet["A1"].value == "hello"
    assert sheet["A4"].value == "=2*A3"
    assert (sheet["A2"].font.bold, sheet["A2"].font.color.rgb, sheet["A2"].font.name) == (
        True, "FFFF0000", "Courier New",
    )  # fmt: skip
    assert sheet["A3"].number_format == '0.0000 "Hz"'
    assert sheet["A5"].comment.text == "a remark"
    assert sheet["A6"].hyperlink.target == "https://example.org/"
    assert sheet.tables["MyTable"].ref == "F1:G2"
    assert sheet.column_dimensions["A"].width == 31
    assert sheet.print_area == "'Mine'!$A$1:$G$6"
    assert book.defined_names["MyName"].attr_text == "Mine!$A$5"
    (rules,) = sheet.conditional_formatting
    assert rules.rules[0].dxf.fill.bgColor.rgb == "FFFFFF00"
    assert len(sheet._charts) == 1


def test_the_other_sheets_keep_their_looks(with_sheet):
    """Styles are added behind those of the template, none is changed."""
    made = openpyxl.load_workbook(tb.template("example_modified"))
    book = openpyxl.load_workbook(io.BytesIO(with_sheet.content))
    for cell in (cell_of(made, "DampingRatio"), *column_of(made, "Elements", "Stiffness")):
        same = book[cell.parent.title][cell.coordinate]
        for look in ("font", "fill", "border", "alignment", "number_format"):
            assert repr(getattr(same, look)) == repr(getattr(cell, look))


def test_formulas_of_added_sheets_have_their_values(with_sheet):
    sheet = with_sheet.workbook()["Mine"]
    frequency = with_sheet.results.rows("NaturalFrequencies")[1]["frequency"]
    assert sheet["A2"].value == 2
    assert sheet["A3"].value == pytest.approx(frequency, rel=1e-12)
    assert sheet["A4"].value == pytest.approx(2.0 * frequency, rel=1e-12)


def test_the_notes_say_what_openpyxl_may_have_lost(with_sheet):
    assert any("Taken from the openpyxl workbook: Mine." in note for note in with_sheet.notes)
    # words on the origin of the example, which the blank template has not, are none of the script's
    assert not any("Cells beside the inputs" in note for note in with_sheet.notes)


def test_what_stays_behind_is_named(tmp_path):
    """Of a workbook that has been calculated nothing but what the script put beside the inputs."""
    path = tb.read(tb.template("example_modified")).write(tmp_path / "train.xlsx")
    calculated = tb.recalculate(path).content
    assert not any(
        "not taken over" in note
        for note in tb.recalculate(openpyxl.load_workbook(io.BytesIO(calculated))).notes
    )
    book = openpyxl.load_workbook(io.BytesIO(calculated))
    sheet = cell_of(book, "DampingRatio").parent
    sheet["Z99"], sheet["Z100"] = "a remark", 3.0
    book["Notes"]["B31"] = "over a note of the product"
    chart = LineChart()
    chart.add_data(Reference(sheet, min_col=26, min_row=99, max_row=100))
    sheet.add_chart(chart, "AA1")
    notes = tb.recalculate(book).notes
    assert any(
        f"not taken over: {sheet.title}!Z99, {sheet.title}!Z100, Notes!B31. Put them" in note
        for note in notes
    )
    assert any(
        f"added to sheets of the product were not taken over: {sheet.title}. Put them" in note
        for note in notes
    )


def test_verify_finds_that_results_follow_from_inputs(with_sheet, tmp_path):
    (path := tmp_path / "train.xlsx").write_bytes(with_sheet.content)
    said = torsionbook("verify", path, cwd=tmp_path)
    assert said.returncode == 0, said.stdout
    assert "follows from its inputs" in said.stdout


def test_the_package_is_whole(with_sheet):
    """Every part has a content type and is led to once; numbers of tables and names of parts are single."""
    content = parts(with_sheet.content)
    assert len(zipfile.ZipFile(io.BytesIO(with_sheet.content)).namelist()) == len(content)
    types = content["[Content_Types].xml"].decode()
    listed = re.findall(r'PartName="/([^"]+)"', types)
    assert len(listed) == len(set(listed))
    assert set(listed) <= content.keys()
    targets = []
    for name, data in content.items():
        if not name.endswith(".rels"):
            continue
        for entry in re.findall(r"<Relationship [^>]*>", data.decode()):
            if 'TargetMode="External"' not in entry:
                target = re.search(r'Target="([^"]+)"', entry)[1]
                folder = name.rpartition("_rels/")[0]
                path = target.lstrip("/") if target.startswith("/") else resolved(folder, target)
                assert path in content, (name, target)
                targets.append(path)
    assert len(targets) == len(set(targets))
    numbers = [
        re.search(rb'<table [^>]*?\bid="(\d+)"', d)[1]
        for n, d in content.items()
        if "/tables/" in n
    ]
    assert len(numbers) == len(set(numbers)) > 10


def resolved(folder, target):
    kept = []
    for word in (folder + target).split("/"):
        kept = kept[:-1] if word == ".." else [*kept, word]
    return "/".join(kept)


@pytest.mark.needs_libreoffice
def test_libreoffice_opens_it_and_calculates_the_same(with_sheet, tmp_path, soffice):
    (path := tmp_path / "train.xlsx").write_bytes(with_sheet.content)
    again = openpyxl.load_workbook(soffice.convert(path), data_only=True)["Mine"]
    for cell in ("A2", "A3", "A4"):
        assert again[cell].value == pytest.approx(
            with_sheet.workbook()["Mine"][cell].value, rel=1e-9
        )


# --- a template of one's own ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def own_template(tmp_path_factory):
    """A workbook as a company styles it: a sheet of its own with a picture that openpyxl loses."""
    folder = tmp_path_factory.mktemp("own")
    book = opened("blank_us")
    sheet = book.create_sheet("Cover")
    sheet["B2"] = "Company"
    sheet["B3"] = "old"
    sheet["B4"] = "=DampingRatio*2"
    sheet["D1"], sheet["D2"] = "a", 1
    sheet.add_table(Table(displayName="Staff", ref="D1:D2"))
    book.defined_names["Author"] = DefinedName("Author", attr_text="Cover!$B$2")
    cell_of(book, "DampingRatio").fill = PatternFill("solid", fgColor="FF00FF00")
    book.save(path := folder / "own.xlsx")
    shape = (
        b'<xdr:wsDr xmlns:xdr="http://schemas.openxmlformats.org/drawingml/2006/spreadsheetDrawing" '
        b'xmlns:a="http://schemas.openxmlformats.org/drawingml/2006/main"><xdr:absoluteAnchor><xdr:pos x="0" y="0"/>'
        b'<xdr:ext cx="900000" cy="300000"/><xdr:sp macro="" textlink=""><xdr:nvSpPr><xdr:cNvPr id="2" name="Logo"/>'
        b'<xdr:cNvSpPr/></xdr:nvSpPr><xdr:spPr><a:prstGeom prst="rect"><a:avLst/></a:prstGeom></xdr:spPr></xdr:sp>'
        b"<xdr:clientData/></xdr:absoluteAnchor></xdr:wsDr>"
    )
    content = parts(path.read_bytes())
    sheet_part = next(
        n for n, d in content.items() if "worksheets/sheet" in n and b">Company<" in d
    )
    rels = sheet_part.replace("worksheets/", "worksheets/_rels/") + ".rels"
    relations = content[rels].decode()
    content["xl/drawings/drawing990.xml"] = shape
    relation = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    content[rels] = relations.replace(
        "</Relationships>",
        f'<Relationship Id="rId99" Type="{relation}/drawing" Target="/xl/drawings/drawing990.xml"/></Relationships>',
    ).encode()
    content[sheet_part] = content[sheet_part].replace(
        b"<tableParts", f'<drawing xmlns:r="{relation}" r:id="rId99"/><tableParts'.encode()
    )
    content["[Content_Types].xml"] = content["[Content_Types].xml"].replace(
        b"</Types>",
        b'<Override PartName="/xl/drawings/drawing990.xml" '
        b'ContentType="application/vnd.openxmlformats-officedocument.drawing+xml"/></Types>',
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    return path


def test_a_template_keeps_its_own_sheets_whole(own_template):
    """What openpyxl loses of them is there again; what the script wrote on them is there, too."""
    book = openpyxl.load_workbook(own_template)
    filled = tb.read(tb.template("example_modified"))
    source = opened()
    for spec in (
        "Stations",
        "Elements",
        "MotorTorque",
        "LoadTorque",
        "Materials",
        "SNPoints",
        "Excitations",
    ):
        _, (head, *rows) = table_of(source, spec)
        sheet, (own_head, *own_rows) = table_of(book, spec)
        used = [
            row for row in rows if any(isinstance(c.value, (int, float)) or c.value for c in row)
        ]
        top, left = own_head[0].row, own_head[0].column
        for i, row in enumerate([head, *used]):
            for j, cell in enumerate(row):
                if not (isinstance(cell.value, str) and cell.value.startswith("=")):
                    sheet.cell(top + i, left + j).value = cell.value
        ref = sheet.tables[spec].ref
        end = re.match(r"[A-Z]+", ref.split(":")[1])[0]
        sheet.tables[
            spec
        ].ref = f"{ref.split(':')[0]}:{end}{max(top + len(used), top + len(own_rows))}"
        for cell in head:  # units stand above
            sheet.cell(top - 1, cell.column).value = cell.parent.cell(
                cell.row - 1, cell.column
            ).value
    for name in filled.scalars:
        if name != "TemplateVersion":
            old, new = cell_of(source, name), cell_of(book, name)
            new.value = old.value
            new.parent.cell(new.row, new.column + 1).value = old.parent.cell(
                old.row, old.column + 1
            ).value
    book["Cover"]["B3"] = "new"
    more = book.create_sheet("More")
    more["A1"] = 1.0
    assert tb.read(book).problems == ()
    done = tb.recalculate(book, template=own_template)
    assert done.results.rows("StartupPeaks") == tb.run(tb.read(book)).rows("StartupPeaks")
    written = parts(done.content)
    assert (
        written["xl/drawings/drawing990.xml"]
        == parts(own_template.read_bytes())["xl/drawings/drawing990.xml"]
    )
    again = openpyxl.load_workbook(io.BytesIO(done.content))
    assert [again["Cover"][cell].value for cell in ("B2", "B3", "B4")] == [
        "Company",
        "new",
        "=DampingRatio*2",
    ]
    assert again["More"]["A1"].value == 1.0
    assert cell_of(again, "DampingRatio").fill.fgColor.rgb == "FF00FF00"
    values = done.workbook()
    assert values["Cover"]["B4"].value == pytest.approx(2.0 * cell_of(values, "DampingRatio").value)


def test_a_table_and_a_name_that_the_template_has_are_named(own_template):
    book = opened()
    sheet = book.create_sheet("Mine")
    sheet["A1"], sheet["A2"] = "a", 1
    sheet.add_table(Table(displayName="Staff", ref="A1:A2"))
    book.defined_names["Author"] = DefinedName("Author", attr_text="Mine!$A$2")
    done = tb.recalculate(book, template=own_template)
    assert any("Table Staff is on a sheet that was added, but" in note for note in done.notes)
    assert any("The name Author leads to sheet Mine, but" in note for note in done.notes)
    again = openpyxl.load_workbook(io.BytesIO(done.content))
    assert list(again["Mine"].tables) == []
    assert again["Cover"].tables["Staff"].ref == "D1:D2"
    assert again["Mine"]["A2"].value == 1
    assert again.defined_names["Author"].attr_text == "Cover!$B$2"


def test_a_template_without_a_place_for_an_input_is_refused(own_template, tmp_path):
    book = openpyxl.load_workbook(own_template)
    sheet, _ = table_of(book, "Materials")
    del sheet.tables["Materials"]
    del book.defined_names["DampingRatio"]
    book.save(path := tmp_path / "less.xlsx")
    with pytest.raises(tb.InputError) as raised:
        tb.recalculate(opened(), template=path)
    assert "the template less.xlsx has no place for DampingRatio, Materials." in str(raised.value)
    with pytest.raises(tb.InputError, match=r"missing\.xlsx"):
        tb.recalculate(opened(), template=tmp_path / "missing.xlsx")
