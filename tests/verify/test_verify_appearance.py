"""What a reader sees: results that are hidden or shown otherwise are found, honest restyling is not."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import openpyxl
import pytest
from cells_of_tables import cell_of
from openpyxl.cell.rich_text import CellRichText, TextBlock
from openpyxl.cell.text import InlineFont
from openpyxl.formatting.formatting import ConditionalFormattingList
from openpyxl.formatting.rule import CellIsRule, DataBarRule, FormulaRule, Rule
from openpyxl.styles import Alignment, Font, PatternFill
from openpyxl.styles.differential import DifferentialStyle
from openpyxl.styles.numbers import NumberFormat
from tampered_package import Package

from addin.contract.sheets import VERDICTS_ROW
from addin.contract.shipped import template_path
from addin.contract.texts import NOTES
from addin.contract.trace_table import TRACE_HEADERS
from addin.verify.appearance import compare_appearance
from addin.verify.file import verify_file
from addin.verify.findings import Finding
from addin.verify.fixed_texts import compare_texts
from addin.verify.structure import PlainTexts
from addin.verify.wording import lines
from addin.xlsx import open_workbook

Edit = Callable[[openpyxl.Workbook, openpyxl.cell.Cell], None]


@pytest.fixture(scope="module")
def places(calculated) -> list[tuple[str, str]]:
    """Results above a thousand with decimals, each in a cell of its own."""
    workbook = open_workbook(calculated / "train.xlsx", read_only=True)
    found = []
    for column in (
        "Maximum torque",
        "Minimum torque",
        "Peak-to-peak torque",
        "Peak-to-peak stress",
    ):
        for row in range(1, workbook.table("StartupPeaks").data.height + 1):
            place = cell_of(workbook, "StartupPeaks", row, column)
            held = workbook.shown_value(*place)
            if isinstance(held, float) and held > 1000.0 and held % 1.0:
                found.append(place)
    assert len(found) > 20
    return found


@pytest.fixture(scope="module")
def place(places) -> tuple[str, str]:
    """One of them."""
    return places[0]


@pytest.fixture(scope="module")
def words(calculated) -> list[tuple[str, str]]:
    """Verdicts."""
    workbook = open_workbook(calculated / "train.xlsx", read_only=True)
    count = workbook.table("SeparationMargins").data.height
    return [cell_of(workbook, "SeparationMargins", k, "Verdict") for k in range(1, count + 1)]


@pytest.fixture
def restyled(train, tmp_path) -> Callable[..., list[Finding]]:
    """What is said of the looks of the workbook after edits by openpyxl, each of a cell of its own."""

    def said(edits: Sequence[Edit], places: Sequence[tuple[str, str]]) -> list[Finding]:
        book = openpyxl.load_workbook(train, rich_text=True)
        for edit, (sheet, cell) in zip(edits, places[: len(edits)], strict=True):
            edit(book, book[sheet][cell])
        book.save(tmp_path / "restyled.xlsx")
        found = compare_appearance(open_workbook(tmp_path / "restyled.xlsx", read_only=True))
        return [one for one in found if one.fails]

    return said


def a_format(code: str) -> Edit:
    def edit(book, cell):
        cell.number_format = code

    return edit


def a_rule(rule) -> Edit:
    def edit(book, cell):
        cell.parent.conditional_formatting.add(cell.coordinate, rule)

    return edit


def painted(ink: str, ground: str | None = None, size: float = 9.0, name: str = "Arial") -> Edit:
    def edit(book, cell):
        cell.font = Font(name=name, size=size, color=ink)
        if ground is not None:
            cell.fill = PatternFill("solid", start_color=ground, end_color=ground)

    return edit


def struck(book, cell):
    cell.font = Font(name="Arial", size=9.0, strike=True)


def filled(book, cell):
    cell.alignment = Alignment(horizontal="fill")


def rule_with_format(code: str) -> Rule:
    difference = DifferentialStyle(numFmt=NumberFormat(numFmtId=190, formatCode=code))
    return Rule(type="expression", dxf=difference, formula=["TRUE"])


def test_what_was_written_is_shown(train, examples):
    for path in (train, examples / "proposed.in.xlsx", template_path("blank_us.xlsx")):
        workbook = open_workbook(path, read_only=True)
        assert [one for one in compare_appearance(workbook) if one.fails] == []
        assert list(compare_texts(PlainTexts(workbook), same_version=True)) == []


LYING = (
    '"9"#,##0', '#,##0"0"', "0.0,", "#,##0,,", ";;;", '"pass"', '"12"', "[White]#,##0", "[Color 19]0", "yyyy-mm-dd",
    "# ?/?", "[h]:mm", '0"."00', "0-0", "-0", '"-"0', '0" k"', "\\1#,##0", '[>1]"1.23";0', "0.0,E+0",
)  # fmt: skip
HONEST = (
    "General", "0", "0.0", "0.000000", "#,##0", "#,##0.00", "# ##0.0", "0.00E+00", "##0.0E+0", "0.###", "00000",
    '_-* #,##0.00_-;-* #,##0.00_-;_-* "-"??_-;_-@_-', "#,##0.0;[Red](#,##0.0)", "[Blue]0.0;[Red]-0.0",
    "[>=1000]#,##0;0.000", "@", "0.0_)",
)  # fmt: skip


def found_at(found: Sequence[Finding]) -> list[tuple[str, str]]:
    assert {one.kind for one in found} <= {"hidden", "shown otherwise"}
    return sorted({(one.sheet, one.cell) for one in found})


def test_number_formats_that_show_another_number_are_found(restyled, places):
    found = restyled([a_format(code) for code in LYING], places)
    assert found_at(found) == sorted(places[: len(LYING)])
    assert {one.table for one in found} == {"StartupPeaks"}


@pytest.mark.slow
def test_more_or_fewer_digits_are_no_finding(restyled, places):
    assert restyled([a_format(code) for code in HONEST], places) == []


def test_the_unit_behind_a_number_is_no_finding_but_another_one_is(restyled, places, train):
    workbook = open_workbook(train, read_only=True)
    table = workbook.table("StartupPeaks")
    unit = workbook.sheet_part(table.sheet).constant(
        table.ref.top - 1, table.ref.left + table.column_index("Maximum torque")
    )
    found = restyled([a_format(f'#,##0 "{unit}"'), a_format('#,##0 "MW"'), a_format("0%")], places)
    assert found_at(found) == sorted(places[1:3])


@pytest.mark.slow
def test_formats_that_show_another_verdict_are_found(restyled, words):
    lying = (";;;", ';;;"passed"', '0;0;0;"pass" @', "[White]@")
    honest = ("@", "0.00", "General", "0;0;0;@", "0;0;0;[Red]@")
    found = restyled([a_format(code) for code in (*lying, *honest)], words)
    assert found_at(found) == sorted(words[: len(lying)])


UNSEEN = (
    painted("FFFFFFFF", "FFFFFFFF"), painted("FF203040", "FF203040"), painted("FFF0F0F0", "FFFFFFFF"),
    painted("FF000000", "FF101010"), struck, painted("FF000000", size=1), painted("FF000000", name="Wingdings"),
    a_rule(FormulaRule(["TRUE"], font=Font(color="FFFEFEFE"))),
    a_rule(FormulaRule(["TRUE"], font=Font(color="FF808080"), fill=PatternFill(bgColor="FF808080"))),
    a_rule(CellIsRule(operator="greaterThan", formula=["1000"], font=Font(color="FFFDFDFD"))),
    a_rule(rule_with_format('"OK"')), a_rule(rule_with_format(";;;")), a_rule(rule_with_format("0.0,")),
    a_rule(DataBarRule("min", None, "max", None, "FF00FF00", showValue=False)),
    filled,
)  # fmt: skip
SEEN = (
    painted("FFFFFFFF", "FF203040"), painted("FFC00000"), painted("FF808080", "FFFFFFCC", size=14),
    a_rule(FormulaRule(["TRUE"], fill=PatternFill(bgColor="FFFFC7CE"), font=Font(color="FF9C0006"))),
    a_rule(CellIsRule(operator="lessThan", formula=["0"], font=Font(color="FFFFFFFF"))),
    a_rule(CellIsRule(operator="equal", formula=["0"], font=Font(color="FFFFFFFF"))),
    a_rule(rule_with_format("0.0000")), a_rule(DataBarRule("min", None, "max", None, "FF63C384")),
)  # fmt: skip


def test_what_nobody_can_see_is_found(restyled, places):
    assert found_at(restyled(UNSEEN, places)) == sorted(places[: len(UNSEEN)])


def test_honest_colours_and_rules_are_no_finding(restyled, places):
    assert restyled(SEEN, places) == []


@pytest.mark.slow
def test_two_rules_that_hide_together_are_found(restyled, place):
    def edit(book, cell):
        rules = (
            FormulaRule(["TRUE"], font=Font(color="FF707070")),
            FormulaRule(["TRUE"], fill=PatternFill(bgColor="FF707070")),
        )
        for rule in rules:
            cell.parent.conditional_formatting.add(cell.coordinate, rule)

    [found] = restyled([edit], [place])
    assert "two conditional formats" in found.sentence


def green_rule(rank: int) -> Edit:
    def edit(book, cell):
        rule = FormulaRule(["TRUE"], fill=PatternFill(bgColor="FFC6EFCE"))
        rule.priority = rank
        cell.parent.conditional_formatting.add(cell.coordinate, rule)

    return edit


def fails_in_green(book, cell):
    """The rule for a fail gets the colours of the one for a pass."""
    looks = {rule.text: rule for area in cell.parent.conditional_formatting for rule in area.rules}
    for area in cell.parent.conditional_formatting:
        for rule in area.rules:
            if rule.text == "fail":
                rule.dxf = looks["pass"].dxf


def green_without_rules(book, cell):
    cell.parent.conditional_formatting = ConditionalFormattingList()
    painted("FF00B050")(book, cell)


@pytest.mark.slow
def test_verdicts_in_the_colour_of_a_pass_are_found(restyled, train):
    """But not where the shipped rule for a fail goes before the green one."""
    workbook = open_workbook(train, read_only=True)

    def failing(table: str) -> tuple[str, str]:
        rows = range(1, workbook.table(table).data.height + 1)
        cells = (cell_of(workbook, table, row, "Verdict") for row in rows)
        return next(at for at in cells if str(workbook.shown_value(*at)).startswith("fail"))

    tables = ("SeparationMargins", "Verdicts", "SteadyState")
    wrong = (fails_in_green, green_rule(1), green_without_rules)
    cells = [failing(table) for table in tables]
    found = restyled(wrong, cells)
    assert {sheet for sheet, _ in found_at(found)} == {sheet for sheet, _ in cells}
    assert all("in green" in one.sentence for one in found)
    assert restyled([green_rule(10_000)] * 3, cells) == []


def test_the_rules_of_verdicts_as_libreoffice_writes_them_are_no_finding(train, tmp_path):
    package = Package(train)

    def rewritten(text: str) -> str:
        text = text.replace('<cfRule type="expression"', '<cfRule type="expression" text=""')
        return re.sub(r'(LEFT\([^,]*),\d+\)="([^"]*)"', r'\1,LEN("\2"))="\2"', text)

    for sheet in ("Results", "Summary"):
        package.change(package.part_of_sheet(sheet), rewritten)
    workbook = open_workbook(package.store(tmp_path / "saved.xlsx"), read_only=True)
    assert [one for one in compare_appearance(workbook) if one.fails] == []


_OLD_SHAPE = (
    '<xml xmlns:v="urn:schemas-microsoft-com:vml" xmlns:x="urn:schemas-microsoft-com:office:excel">'
    '<v:shape style="position:absolute;margin-left:20pt;margin-top:30pt;width:90pt;height:14pt">'
    '<x:ClientData ObjectType="Button"/></v:shape></xml>'
)
_SPARKLINE = (
    '<extLst><ext xmlns:x14="http://schemas.microsoft.com/office/spreadsheetml/2009/9/main" uri="{0}">'
    '<x14:sparklineGroups xmlns:xm="http://schemas.microsoft.com/office/excel/2006/main"><x14:sparklineGroup>'
    "<x14:sparklines><x14:sparkline><xm:f>Fatigue!C8:C9</xm:f><xm:sqref>B2</xm:sqref></x14:sparkline>"
    "</x14:sparklines></x14:sparklineGroup></x14:sparklineGroups></ext></extLst>"
)


def test_banners_that_are_covered_hidden_or_cut_are_found(train, tmp_path):
    package = Package(train)
    parts = {
        sheet: package.part_of_sheet(sheet) for sheet in ("Results", "Fatigue", "Audit", "Notes")
    }

    def into(sheet, old, new):
        package.change(parts[sheet], lambda text: text.replace(old, new, 1))

    into("Results", '<row r="2"', '<row r="2" hidden="1"')
    into("Fatigue", "</worksheet>", f"{_SPARKLINE}</worksheet>")
    into("Audit", "<tableParts", '<legacyDrawing r:id="rIdOld"/><tableParts')
    package.parts["xl/drawings/old.vml"] = _OLD_SHAPE.encode()
    relationship = (
        '<Relationship Id="rIdOld" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/'
        'vmlDrawing" Target="../drawings/old.vml"/></Relationships>'
    )
    rels = f"xl/worksheets/_rels/{parts['Audit'].rsplit('/', 1)[1]}.rels"
    package.change(rels, lambda text: text.replace("</Relationships>", relationship))
    low = re.search(r'<row r="2"[^>]*ht="[0-9.]+"', package.parts[parts["Notes"]].decode())[0]
    into("Notes", low, re.sub(r'ht="[0-9.]+"', 'ht="5"', low))
    workbook = open_workbook(package.store(tmp_path / "covered.xlsx"), read_only=True)
    found = [one for one in compare_appearance(workbook) if one.fails]
    said = {(one.sheet, one.cell, one.kind, one.sentence.split(",")[0]) for one in found}
    assert said == {
        ("Results", "B2", "hidden", "row 2 is hidden (and 4 more such cells)"),
        ("Fatigue", "B2", "hidden", "a sparkline lies over the cell"),
        ("Audit", "B2", "hidden", "a control lies over the cell"),
        ("Notes", "B2", "hidden", "the text is 9 points high in a row of 5 points"),
    }


@pytest.mark.slow
def test_white_words_inside_a_text_are_found(restyled, words):
    def edit(book, cell):
        cell.value = CellRichText(TextBlock(InlineFont(color="FFFFFFFF"), "not "), "judged")

    found = restyled([edit], words)
    assert found_at(found) == words[:1]
    assert any("'not '" in one.sentence for one in found)


def hidden_row(book, cell):
    cell.parent.row_dimensions[cell.row].hidden = True


def flat_row(book, cell):
    cell.parent.row_dimensions[cell.row].height = 0.5


def hidden_column(book, cell):
    cell.parent.column_dimensions[cell.column_letter].hidden = True


def narrow_column(book, cell):
    cell.parent.column_dimensions[cell.column_letter].width = 0.2


def hidden_sheet(book, cell):
    cell.parent.sheet_state = "hidden"


def very_hidden_sheet(book, cell):
    cell.parent.sheet_state = "veryHidden"


def merged(book, cell):
    cell.parent.merged_cells.add(f"{cell.offset(-1, 0).coordinate}:{cell.coordinate}")


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "edit",
    [hidden_row, hidden_column, very_hidden_sheet, flat_row, narrow_column, hidden_sheet],
)
def test_a_hidden_place_is_found(restyled, place, edit):
    found = restyled([edit], [place])
    assert len(found) == len({one.sentence.split(" (")[0] for one in found}) > 0
    assert {one.sheet for one in found} == {place[0]}
    assert {one.kind for one in found} <= {"hidden", "shown otherwise"}
    assert all(one.cell for one in found)


def test_a_result_under_a_merged_range_is_found(train, tmp_path, place):
    package = Package(train)
    row = int("".join(filter(str.isdigit, place[1])))
    above = place[1].replace(str(row), str(row - 1))
    entry = f'<mergeCell ref="{above}:{place[1]}"/>'
    part = package.part_of_sheet(place[0])
    before = package.parts[part].decode()
    if "<mergeCells" in before:
        package.change(part, lambda text: text.replace("</mergeCells>", f"{entry}</mergeCells>"))
    else:
        package.change(
            part, lambda text: text.replace("</sheetData>", f"</sheetData><mergeCells>{entry}</mergeCells>")
        )  # fmt: skip
    workbook = open_workbook(package.store(tmp_path / "merged.xlsx"), read_only=True)
    found = [one for one in compare_appearance(workbook) if one.fails]
    assert [(one.sheet, one.cell, one.kind) for one in found] == [(*place, "hidden")]


_ANCHOR = (
    "<xdr:{kind}Anchor><xdr:from><xdr:col>{column}</xdr:col><xdr:colOff>0</xdr:colOff><xdr:row>{row}</xdr:row>"
    "<xdr:rowOff>0</xdr:rowOff></xdr:from>{end}<xdr:sp><xdr:nvSpPr><xdr:cNvPr id='99' name='Box'/>"
    "<xdr:cNvSpPr/></xdr:nvSpPr><xdr:spPr>{ground}</xdr:spPr>{text}</xdr:sp><xdr:clientData/></xdr:{kind}Anchor>"
)
_TEXT = "<xdr:txBody><a:bodyPr/><a:p><a:r><a:t>1,234</a:t></a:r></a:p></xdr:txBody>"
_WHITE = "<a:solidFill><a:srgbClr val='FFFFFF'/></a:solidFill>"


def test_a_wide_line_over_a_result_is_found(train, tmp_path):
    package = Package(train)
    sheet = package.part_of_sheet("Summary")
    rels = package.parts[f"xl/worksheets/_rels/{sheet.rsplit('/', 1)[1]}.rels"].decode()
    drawing = "xl/drawings/" + rels.split("drawings/")[1].split('"')[0]
    row = f"<xdr:row>{VERDICTS_ROW + 4}</xdr:row><xdr:rowOff>0</xdr:rowOff>"
    end = f"<xdr:to><xdr:col>12</xdr:col><xdr:colOff>0</xdr:colOff>{row}</xdr:to>"
    line = f"<a:ln w='1270000'>{_WHITE}</a:ln>"
    anchor = _ANCHOR.format(
        kind="twoCell", column=2, row=VERDICTS_ROW + 1, end=end, ground=line, text=""
    )
    anchor = anchor.replace("<xdr:sp>", "<xdr:cxnSp>").replace("</xdr:sp>", "</xdr:cxnSp>")
    package.change(drawing, lambda text: text.replace("</xdr:wsDr>", f"{anchor}</xdr:wsDr>"))
    workbook = open_workbook(package.store(tmp_path / "line.xlsx"), read_only=True)
    found = [one.sentence for one in compare_appearance(workbook) if one.fails]
    assert found
    assert all("a wide line ('Box') lies over the cell" in one for one in found)


def test_a_palette_of_the_file_that_makes_ink_white_is_found(train, tmp_path):
    package = Package(train)
    white = (
        "<colors><indexedColors>" + '<rgbColor rgb="00FFFFFF"/>' * 64 + "</indexedColors></colors>"
    )
    ink = '<color indexed="8"/>'
    package.change(
        "xl/styles.xml", lambda text: re.sub(r"<color (?:theme|rgb)[^>]*/>(?=<name)", ink, text)
    )
    plain = open_workbook(package.store(tmp_path / "plain.xlsx"), read_only=True)
    package.change(
        "xl/styles.xml", lambda text: text.replace("</styleSheet>", f"{white}</styleSheet>")
    )
    workbook = open_workbook(package.store(tmp_path / "white.xlsx"), read_only=True)
    unread = [
        [one for one in compare_appearance(book) if "nobody can read" in one.sentence]
        for book in (plain, workbook)
    ]
    assert any("#FFFFFF on #FFFFFF" in one.sentence for one in unread[1])
    assert not any("#FFFFFF on #FFFFFF" in one.sentence for one in unread[0])


@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    ("ground", "text", "covers"),
    [
        (_WHITE, "", True),
        ("<a:noFill/>", _TEXT, True),
        ("<a:noFill/>", "", False),
        (f"<a:noFill/><a:ln w='12700'>{_WHITE}</a:ln>", "", False),
        (f"<a:noFill/><a:ln w='1270000'>{_WHITE}</a:ln>", "", True),
        ("<a:grpFill/>", "", True),
    ],
)
@pytest.mark.parametrize("kind", ["twoCell", "oneCell"])
def test_a_shape_over_a_result_is_found_and_a_ring_around_it_is_none(
    train, tmp_path, place, ground, text, covers, kind
):
    package = Package(train)
    sheet = package.part_of_sheet(place[0])
    rels = package.parts[f"xl/worksheets/_rels/{sheet.rsplit('/', 1)[1]}.rels"].decode()
    drawing = "xl/drawings/" + rels.split("drawings/")[1].split('"')[0]
    column = openpyxl.utils.column_index_from_string("".join(filter(str.isalpha, place[1]))) - 1
    row = int("".join(filter(str.isdigit, place[1]))) - 1
    end = (
        f"<xdr:to><xdr:col>{column + 1}</xdr:col><xdr:colOff>0</xdr:colOff><xdr:row>{row + 1}</xdr:row>"
        "<xdr:rowOff>0</xdr:rowOff></xdr:to>"
        if kind == "twoCell"
        else "<xdr:ext cx='300000' cy='150000'/>"
    )
    anchor = _ANCHOR.format(kind=kind, column=column, row=row, end=end, ground=ground, text=text)
    package.change(drawing, lambda text: text.replace("</xdr:wsDr>", f"{anchor}</xdr:wsDr>"))
    workbook = open_workbook(package.store(tmp_path / "covered.xlsx"), read_only=True)
    found = [one for one in compare_appearance(workbook) if one.fails]
    expected = [(*place, "hidden")] if covers else []
    assert [(one.sheet, one.cell, one.kind) for one in found] == expected


def test_hidden_inputs_are_a_note(train, tmp_path):
    book = openpyxl.load_workbook(train)
    book["Train"].column_dimensions["C"].hidden = True
    book.save(tmp_path / "hidden.xlsx")
    found = list(compare_appearance(open_workbook(tmp_path / "hidden.xlsx", read_only=True)))
    hidden = [one for one in found if one.kind == "hidden"]
    assert hidden
    assert not any(one.fails for one in hidden)


@pytest.mark.slow
def test_an_input_that_shows_another_number_is_found(restyled, train):
    workbook = open_workbook(train, read_only=True)
    place = cell_of(workbook, "Stations", 1, "Inertia")
    [found] = restyled([a_format('"9"0.0')], [place])
    assert (found.sheet, found.cell) == place


@pytest.mark.slow
def test_changed_texts_of_notes_and_trace_are_found(train, tmp_path):
    book = openpyxl.load_workbook(train)
    told = NOTES["How to use"][0][1]
    [note] = [cell for row in book["Notes"].iter_rows() for cell in row if cell.value == told]
    places = {cell.value: cell for row in book["Notes"].iter_rows() for cell in row}
    head = places[TRACE_HEADERS[-1]].row
    equation, header = book["Notes"][f"F{head + 4}"], book["Notes"][f"D{head + 7}"]
    for cell in (note, equation, header):
        cell.value = "Another text."
    book.save(tmp_path / "reworded.xlsx")
    workbook = open_workbook(tmp_path / "reworded.xlsx", read_only=True)
    found = list(compare_texts(PlainTexts(workbook), same_version=True))
    assert [(one.sheet, one.cell) for one in found] == [
        ("Notes", note.coordinate), ("Notes", equation.coordinate), ("Notes", "")
    ]  # fmt: skip
    assert all(one.fails for one in found)
    assert not any(one.fails for one in compare_texts(PlainTexts(workbook), same_version=False))


def test_other_titles_and_captions_of_result_sheets_are_notes(train, tmp_path):
    package = Package(train)
    package.put_text("Results", "L1", "Margins: all kept")
    package.put_text("Results", "L5", "All margins are kept")
    package.put_text("Fatigue", "B3", "The shafts may start as often as one likes.")
    workbook = open_workbook(package.store(tmp_path / "titles.xlsx"), read_only=True)
    found = list(compare_texts(PlainTexts(workbook), same_version=True))
    assert [one.sheet for one in found] == ["Fatigue", "Results", "Results"]
    assert all("is missing" in one.sentence and not one.fails for one in found)


def test_verify_says_what_it_looked_at_and_fails_by_a_hidden_result(train, tmp_path, place):
    clean = verify_file(train)
    assert clean.passes
    assert "number formats" in clean.sentence
    assert "hidden rows, columns and sheets" in clean.sentence
    assert any(line.startswith("  not judged") for line in lines(clean))
    package = Package(train)
    row = "".join(filter(str.isdigit, place[1]))
    package.change(
        package.part_of_sheet(place[0]),
        lambda text: text.replace(f'<row r="{row}"', f'<row r="{row}" hidden="1"', 1),
    )
    found = verify_file(package.store(tmp_path / "hidden.xlsx"))
    assert found.outcome == "does not follow"
    assert any(one.kind == "hidden" and one.sheet == place[0] for one in found.findings)
