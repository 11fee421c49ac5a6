"""Edits that hide a result, a formula or what it is called: none leaves a clean outcome."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import openpyxl
import pytest
from cells_of_tables import cell_of
from tampered_package import Package

from addin.contract.shipped import template_path
from addin.verify.file import verify_file
from addin.verify.findings import Agreement, Finding, Verification
from addin.verify.formulas import typed_over, verdict_cells
from addin.verify.input_copy import without_copy
from addin.verify.structure import other_sheets, without_banner
from addin.xlsx import Formula, open_workbook
from addin.xlsx.references import cell_name


@pytest.fixture
def tampered(train: Path, tmp_path: Path) -> Callable[[Callable[[Package], None]], Verification]:
    """What is said of the workbook after an edit of its package."""

    def verified(edit: Callable[[Package], None]) -> Verification:
        package = Package(train)
        edit(package)
        return verify_file(package.store(tmp_path / "tampered.xlsx"))

    return verified


def failing(found: Verification) -> list[Finding]:
    return [finding for finding in found.findings if finding.fails]


@pytest.mark.parametrize("table", ["AllowableStarts", "StartCycles"])
def test_a_result_table_that_became_a_range_is_missed(tampered, table):
    found = tampered(lambda package: package.table_to_range(table))
    assert not found.passes
    [missing] = [f for f in failing(found) if f.kind == "table missing"]
    assert (missing.sheet, missing.table) == ("Fatigue", table)


@pytest.mark.slow
def test_a_zero_in_place_of_a_blank_is_seen_and_a_blank_in_place_of_a_zero(train, tmp_path):
    workbook = open_workbook(train)
    table = workbook.table("NaturalFrequencies")
    cells = {"blank": [], "zero": []}
    for row in range(1, table.data.height + 1):
        for column in ("Frequency", "Percent speed"):
            place = cell_of(workbook, "NaturalFrequencies", row, column)
            held = workbook.shown_value(*place)
            if held is None or held == 0.0:
                cells["blank" if held is None else "zero"].append(place)
    assert cells["blank"]
    assert cells["zero"]
    workbook.set_cell(*cells["blank"][0], 0.0)
    workbook.set_cell(*cells["zero"][0], None)
    workbook.save(tmp_path / "edited.xlsx")
    named = {(f.sheet, f.cell) for f in failing(verify_file(tmp_path / "edited.xlsx"))}
    assert {cells["blank"][0], cells["zero"][0]} <= named


@pytest.mark.slow
def test_blanks_in_a_header_change_nothing(tampered):
    """They are seen by nobody, and formulas name the columns of the table, not the words of its header cells."""

    def edit(package):
        package.put_text("Fatigue", header_cell("Paper count"), "Paper  count")

    found = tampered(edit)
    assert found.outcome == "follows"
    assert found.passes
    assert failing(found) == []


@pytest.mark.slow
def test_swapped_headers_are_seen(tampered):
    def edit(package):
        package.put_text("Fatigue", header_cell("Damage"), "Paper count")
        package.put_text("Fatigue", header_cell("Paper count"), "Damage")

    found = tampered(edit)
    assert found.outcome == "does not follow"
    told = {(f.cell, f.found, f.expected) for f in failing(found) if f.kind == "edited"}
    assert told == {
        (header_cell("Damage"), "Paper count", "Damage"),
        (header_cell("Paper count"), "Damage", "Paper count"),
    }


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", ["Paper count ", "Count with margin"])
def test_a_renamed_column_is_missed(tampered, name):
    def edit(package):
        package.put_text("Fatigue", header_cell("Paper count"), name)
        package.change(
            package.part_of_table("AllowableStarts"),
            lambda text: text.replace('name="Paper count"', f'name="{name}"'),
        )

    found = tampered(edit)
    assert found.outcome == "does not follow"
    assert header_cell("Paper count") in {f.cell for f in failing(found) if f.kind == "edited"}


def row_of(label: str) -> int:
    """Row of a key number on Summary, as shipped."""
    workbook = open_workbook(template_path("example_proposed.xlsx"), read_only=True)
    [row] = [r for r in range(1, 99) if workbook.value("Summary", f"B{r}") == label]
    return row


def header_cell(column: str) -> str:
    """Header cell of a column of `AllowableStarts`, as shipped."""
    workbook = open_workbook(template_path("example_proposed.xlsx"), read_only=True)
    table = workbook.table("AllowableStarts")
    return cell_name(table.ref.top, table.ref.left + table.column_index(column))


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("sheet", "cell", "formula", "shows"),
    [
        ("Summary", "B9", '"PASS: all 5 checks"', "PASS: all 5 checks"),
        ("Fatigue", "B4", '"Nothing to judge here"', "Nothing to judge here"),
        ("Start", "B4", '"In order, "&amp;run_Outcome', "In order"),
        ("Summary", "Largest nominal stress, p-p", '"another shaft"&amp;Tag', "another shaft"),
    ],
)
def test_another_formula_in_place_of_ours_is_judged_by_what_it_shows(
    tampered, sheet, cell, formula, shows
):
    cell = cell if len(cell) < 4 else f"E{row_of(cell)}"
    found = tampered(
        lambda package: package.change_cell(sheet, cell, f"<f>{formula}</f><v>{shows}</v>", "str")
    )
    assert found.outcome == "does not follow"
    assert (sheet, cell, "edited") in {(f.sheet, f.cell, f.kind) for f in failing(found)}


@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    ("sheet", "formula"),
    [
        ("Results", '"INCOMPLETE: "&amp;COUNTA(Verdicts[Check])&amp;" checks"'),
        ("Notes", 'IF(COUNTA(Verdicts[Check])&gt;0,"{banner}","")'),
        ("Effects and accuracy", "IF(TRUE,OverallVerdict)"),
        ("Audit", "IF(TRUE,Summary!$B$9)"),
    ],
)
def test_a_verdict_on_another_sheet_that_is_not_the_overall_one_is_seen(
    train, tampered, sheet, formula
):
    """Its value follows from its formula, which nobody reads."""
    banner = open_workbook(train, read_only=True).shown_value("Summary", "B9")
    text = formula.format(banner=banner)
    shown = banner if "COUNTA(Verdicts[Check])&amp;" not in formula else "INCOMPLETE: 9 checks"

    def edit(package):
        package.change(
            package.part_of_sheet(sheet),
            lambda xml: re.sub(
                r"<f>Summary!\$B\$9</f><v>[^<]*</v>", lambda _: f"<f>{text}</f><v>{shown}</v>", xml
            ),
        )

    found = tampered(edit)
    assert not found.passes
    assert (sheet, "B2", "edited") in {(f.sheet, f.cell, f.kind) for f in failing(found)}


def test_verdicts_that_are_typed_are_seen_on_sheets_of_torsionbook_and_of_others(train, tmp_path):
    """A word alone counts beside the results, the words of the banner everywhere."""
    package = Package(train)
    package.put_text("Results", "Y1", "PASSED!")
    package.put_text("Notes", "B2", "PASS: all 8 checks")
    package.put_text("Audit", "B2", "a word")
    own = (
        '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData><row r="1">'
        '<c r="A1" t="inlineStr"><is><t>PASS</t></is></c>'
        '<c r="B1" t="inlineStr"><is><t>PASS: all 8 checks</t></is></c></row></sheetData></worksheet>'
    )
    package.parts["xl/worksheets/own.xml"] = own.encode()
    main = "application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"
    kind = "http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet"
    for part, end, entry in (
        ("[Content_Types].xml", "</Types>", f'<Override PartName="/xl/worksheets/own.xml" ContentType="{main}"/>'),
        ("xl/_rels/workbook.xml.rels", "</Relationships>",
         f'<Relationship Id="rIdOwn" Type="{kind}" Target="worksheets/own.xml"/>'),
        ("xl/workbook.xml", "</sheets>", '<sheet name="Cover" sheetId="900" r:id="rIdOwn"/>'),
    ):  # fmt: skip
        package.change(part, lambda text, end=end, entry=entry: text.replace(end, entry + end))
    workbook = open_workbook(package.store(tmp_path / "typed.xlsx"), read_only=True)
    typed = {(one.sheet, one.cell) for one in typed_over(workbook, True) if one.fails}
    assert typed == {("Results", "Y1"), ("Notes", "B2"), ("Cover", "B1")}
    [cover] = other_sheets(workbook)
    assert "'Cover'" in cover.sentence
    banners = {sheet for sheet, _, _ in verdict_cells(workbook)}
    assert [(one.sheet, one.fails) for one in without_banner(workbook, banners)] == [
        ("Audit", False)
    ]


def test_a_workbook_whose_banner_compares_with_nothing_says_so(train, tmp_path):
    package = Package(train)
    package.change(
        package.part_of_table("InputChecks"), lambda text: text.replace('"InputChecks"', '"Own"')
    )
    workbook = open_workbook(package.store(tmp_path / "no copy.xlsx"), read_only=True)
    [said] = without_copy(workbook)
    assert "InputChecks is missing" in said.sentence
    assert list(without_copy(open_workbook(train, read_only=True))) == []


@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    ("place", "how"),
    [
        (("Summary", "B9"), ("IFERROR('Inputs calculated'!$C$2,1)", "FALSE")),
        (("Summary", "B9"), ("=IF(", '=IF(NOW()>60000,"PASS: all 9 checks",', ")")),
        (("Inputs calculated", "C2"), ("=IFERROR(", "=(NOW()>60000)*IFERROR(")),
    ],
)
def test_a_banner_that_will_say_something_else_after_an_edit_is_seen(edited, place, how):
    """It shows the right verdict now."""

    def edit(workbook):
        held = workbook.value(*place)
        old, new, *end = how
        text = f"={held.text}".replace(old, "=IF(" + new[4:] + "IF(" if end else new, 1)
        assert text != f"={held.text}"
        text = "".join([text.removeprefix("="), *end])
        workbook.set_cell(*place, Formula(text, held.cached), replace_formula=True)

    found = verify_file(edited(edit))
    assert not found.passes
    assert (*place, "edited") in {(f.sheet, f.cell, f.kind) for f in failing(found)}


@pytest.mark.slow
def test_a_formula_of_ours_written_otherwise_with_the_same_value_is_a_note(edited):
    cell = f"C{row_of('Running load / rated')}"

    def edit(workbook):
        held = workbook.value("Summary", cell)
        workbook.set_cell(
            "Summary", cell, Formula(f"({held.text})*1", held.cached), replace_formula=True
        )

    found = verify_file(edited(edit))
    assert found.passes
    assert [(f.kind, f.cell) for f in found.findings] == [("edited", cell)]


def test_a_verdict_typed_where_the_name_leads_no_more_is_seen(tampered):
    def edit(package):
        package.change(
            "xl/workbook.xml",
            lambda text: re.sub(r'(name="OverallVerdict"[^>]*>)[^<]*', r"\1Lists!$Z$50", text),
        )
        package.put_text("Summary", "B9", "PASS: all 5 checks")

    places = {(f.sheet, f.cell) for f in failing(tampered(edit)) if f.kind == "edited"}
    assert {("Lists", "Z50"), ("Summary", "B9")} <= places


@pytest.mark.slow
def test_a_label_with_a_blank_more_still_tells_its_number_and_another_label_is_missed(tampered):
    stress, starts = row_of("Largest nominal stress, p-p"), row_of("Least allowable starts, whole")

    def edit(package):
        package.put_text("Summary", f"B{stress}", "Largest nominal stress, p-p ")
        package.change_cell("Summary", f"C{stress}", "<v>7</v>")
        package.put_text("Summary", f"B{starts}", "Starts, whole")

    said = failing(tampered(edit))
    assert ("Summary", f"C{stress}") in {(f.sheet, f.cell) for f in said}
    assert any("'Least allowable starts, whole' is missing" in f.sentence for f in said)


@pytest.mark.slow
def test_a_version_that_never_was_loosens_nothing_in_words(edited):
    def edit(workbook):
        named = {"Software": "torsionbook 0.0.9"}
        table = workbook.table("Audit")
        for row in range(1, table.data.height + 1):
            item = workbook.shown_value(*cell_of(workbook, "Audit", row, "Item"))
            if item in named:
                workbook.set_cell(*cell_of(workbook, "Audit", row, "Value"), named[item])
        workbook.set_name("run_Software", "torsionbook 0.0.9")
        workbook.set_cell(*cell_of(workbook, "Verdicts", 2, "Where"), "all margins satisfied")

    found = verify_file(edited(edit))
    assert [(f.table, f.column) for f in failing(found)] == [("Verdicts", "Where")]
    assert any("an unknown version" in f.sentence for f in found.findings)


def test_a_coarser_number_format_allows_no_more(tampered):
    """'0' shows 0 of any damage; the format the column is shipped with shows what it is."""
    place = header_cell("Damage")
    cell = f"{place[0]}{int(place[1:]) + 1}"

    def edit(package):
        package.change(
            "xl/styles.xml",
            lambda text: re.sub(
                r"(<cellXfs count=\")(\d+)(\".*?)(</cellXfs>)",
                lambda m: (
                    f'{m[1]}{int(m[2]) + 1}{m[3]}<xf numFmtId="1" applyNumberFormat="1"/>{m[4]}'
                ),
                text,
                flags=re.S,
            ),
        )
        package.change_cell("Fatigue", cell, "<v>0.0001</v>")
        styles = package.parts["xl/styles.xml"].decode()
        last = int(re.search(r'<cellXfs count="(\d+)"', styles)[1]) - 1
        package.change(
            package.part_of_sheet("Fatigue"),
            lambda text: re.sub(rf'<c r="{cell}" s="\d+"', f'<c r="{cell}" s="{last}"', text),
        )

    found = tampered(edit)
    assert ("Fatigue", cell) in {(f.sheet, f.cell) for f in failing(found)}
    assert found.total(Agreement.DIFFERENT) == 1


@pytest.mark.slow
def test_a_workbook_saved_by_openpyxl_still_follows(train, tmp_path):
    openpyxl.load_workbook(train).save(tmp_path / "saved.xlsx")
    found = verify_file(tmp_path / "saved.xlsx")
    assert found.passes
    assert [f.sentence for f in found.findings] == [  # openpyxl keeps charts and drops shapes
        "no schematic of the train is found: it was removed or renamed"
    ]


@pytest.mark.slow
def test_a_number_format_without_digits_hides_the_number(tampered):
    """The header's style is kept; the format that the damage is shown in becomes fixed words."""
    place = header_cell("Damage")
    cell = f"{place[0]}{int(place[1:]) + 1}"

    def edit(package):
        sheet = package.parts[package.part_of_sheet("Fatigue")].decode()
        style = int(re.search(rf'<c r="{cell}" s="(\d+)"', sheet)[1])
        formats = package.parts["xl/styles.xml"].decode()
        cells = re.search(r"<cellXfs.*?</cellXfs>", formats, re.S)[0]
        number = re.findall(r'<xf [^>]*numFmtId="(\d+)"', cells)[style]
        package.change(
            "xl/styles.xml",
            lambda text: re.sub(
                rf'(<numFmt numFmtId="{number}" formatCode=")[^"]*', r"\1&quot;none&quot;", text
            ),
        )

    found = tampered(edit)
    assert {f.kind for f in failing(found)} == {"shown otherwise"}
    assert all("'none'" in f.sentence for f in failing(found))


def with_cells(package: Package, sheet: str, row: int, cells: str) -> None:
    """More cells at the end of a row."""
    package.change(
        package.part_of_sheet(sheet),
        lambda xml: re.sub(
            rf'(<row r="{row}"[^>]*>.*?)(</row>)', rf"\1{cells}\2", xml, count=1, flags=re.DOTALL
        ),
    )


@pytest.mark.slow
def test_an_input_that_is_read_elsewhere_than_beside_its_label_is_seen(train, tampered):
    """The copy of the inputs is led to the same cell; the digest is that of the inputs."""
    workbook = open_workbook(train, read_only=True)
    at = workbook.defined_names["StartsRequired"]
    column, row = cell_name(at.rect.top, at.rect.left)[0], at.rect.top
    value = workbook.shown_value("Case", f"{column}{row}")

    def edit(package):
        with_cells(package, "Case", row, f'<c r="AZ{row}"><v>{value}</v></c>')
        package.change_cell("Case", f"{column}{row}", "<v>99999</v>")
        for part in ("xl/workbook.xml", package.part_of_sheet("Inputs calculated")):
            package.change(
                part, lambda xml: xml.replace(f"Case!${column}${row}", f"Case!$AZ${row}")
            )

    found = tampered(edit)
    assert found.same_inputs
    assert [(f.cell, f.kind) for f in failing(found)] == [(f"AZ{row}", "edited")]


def test_a_scalar_moved_with_its_label_is_no_finding(train, tampered):
    at = open_workbook(train, read_only=True).defined_names["StartsRequired"]
    row, left = at.rect.top, at.rect.left

    def edit(package):
        part = package.part_of_sheet("Case")
        for k in (-1, 0, 1):
            old, new = cell_name(row, left + k), cell_name(row, left + k + 40)
            package.change(part, lambda xml, old=old, new=new: xml.replace(f'"{old}"', f'"{new}"'))
        for name in ("xl/workbook.xml", package.part_of_sheet("Inputs calculated")):
            old, new = (
                f"Case!${cell_name(row, c)[: -len(str(row))]}${row}" for c in (left, left + 40)
            )
            package.change(name, lambda xml, old=old, new=new: xml.replace(old, new))

    assert not [f for f in tampered(edit).findings if "its label" in f.sentence]


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("table", ["Materials", "AllowableStarts"])
def test_a_table_that_is_read_elsewhere_than_where_it_stands_is_seen(train, tampered, table):
    """Its cells again far to the right, where nobody looks; what everybody sees can then be typed over."""
    held = open_workbook(train, read_only=True).table(table)

    def far(row, column):
        return cell_name(row, column + 60)

    def edit(package):
        part = package.part_of_sheet(held.sheet)
        for row in range(held.ref.top - 1, held.data.bottom + 1):
            copies = ""
            for column in range(held.ref.left, held.ref.right + 1):
                cell = cell_name(row, column)
                found = re.search(
                    rf'<c r="{cell}"[^>]*?(?:/>|>.*?</c>)', package.parts[part].decode(), re.DOTALL
                )
                copies += found[0].replace(f'"{cell}"', f'"{far(row, column)}"') if found else ""
            with_cells(package, held.sheet, row, copies)
        place = f"{far(held.ref.top, held.ref.left)}:{far(held.ref.bottom, held.ref.right)}"
        package.change(
            package.part_of_table(table), lambda xml: re.sub('ref="[^"]*"', f'ref="{place}"', xml)
        )

    head = cell_name(held.ref.top, held.ref.left)
    assert (head, "edited") in {(f.cell, f.kind) for f in failing(tampered(edit))}
