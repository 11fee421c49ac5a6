"""`torsionbook verify` on workbooks: what follows, what was edited, what belongs to other inputs."""

from __future__ import annotations

import random
import re
import shutil
import zipfile
from pathlib import Path

import pytest
from cells_of_tables import cell_of, unit_cell_of

from addin.contract.shipped import template_path
from addin.contract.tables import RESULT_TABLES, WORKBOOK_TABLES
from addin.recorded.provenance import is_own_of_each_run
from addin.studies.accuracy import ACCURACY
from addin.studies.run_study import StudyFiles, study_one
from addin.verify.file import verify_file
from addin.verify.findings import Agreement, Finding, Verification
from addin.workers.parallel_map import serial_map
from addin.writing.recalculate import recalculate
from addin.xlsx import Formula, Workbook, open_workbook
from addin.xlsx.references import cell_name


def failing(found: Verification) -> list[Finding]:
    return [finding for finding in found.findings if finding.fails]


def value(workbook: Workbook, place: tuple[str, str]) -> float:
    shown = workbook.shown_value(*place)
    assert isinstance(shown, float)
    return shown


def test_what_was_written_follows_to_the_bit(train):
    before = train.read_bytes()
    found = verify_file(train)
    assert found.outcome == "follows"
    assert found.made_by == found.this
    assert found.recorded == found.inputs
    assert found.total(Agreement.BITS) == sum(sum(one.of) for one in found.counts) > 10_000
    assert not found.findings
    assert train.read_bytes() == before


def test_an_edited_number_is_named_with_its_cell(edited):
    places = []

    def edit(workbook):
        place = cell_of(workbook, "SteadyState", 3, "Torque")
        places.append(place)
        workbook.set_cell(*place, 0.9 * value(workbook, place))

    found = verify_file(edited(edit))
    assert found.outcome == "does not follow"
    [finding] = failing(found)
    assert finding.kind == "edited"
    assert [(finding.sheet, finding.cell)] == places
    assert finding.found == pytest.approx(0.9 * finding.expected)


@pytest.mark.slow
def test_an_edit_within_the_reported_error_is_an_edit_all_the_same(edited):
    def edit(workbook):
        place = cell_of(workbook, "StartupPeaks", 1, "Maximum torque")
        error = value(workbook, cell_of(workbook, "StartupPeaks", 1, "Error")) / 100
        workbook.set_cell(*place, value(workbook, place) * (1 + 0.1 * error))

    found = verify_file(edited(edit))
    assert [f.kind for f in failing(found)] == ["edited"]
    assert found.total(Agreement.DIFFERENT) == 0


@pytest.mark.slow
@pytest.mark.parametrize("put", ["12,345", Formula("=1+1", 2.0), None, 77.0])
def test_whatever_stands_in_place_of_a_number_is_seen(edited, put):
    places = []

    def edit(workbook):
        places.append(cell_of(workbook, "StartupPeaks", 2, "Minimum torque"))
        workbook.set_cell(*places[0], put)

    found = verify_file(edited(edit))
    assert ("edited", *places[0]) in {(f.kind, f.sheet, f.cell) for f in failing(found)}
    assert {f.sheet for f in failing(found)} == {"Start"}


@pytest.mark.slow
def test_a_verdict_typed_over_is_seen_with_the_formulas_that_hang_on_it(edited):
    def edit(workbook):
        for row in (1, 2, 3):
            place = cell_of(workbook, "Verdicts", row, "Verdict")
            if workbook.shown_value(*place) == "fail":
                workbook.set_cell(*place, "pass")

    found = verify_file(edited(edit))
    assert {(f.sheet, f.table) for f in failing(found)} >= {
        ("Summary", "Verdicts"),
        ("Summary", ""),
    }


@pytest.mark.slow
def test_a_live_formula_typed_over_is_seen(edited):
    places = []

    def edit(workbook):
        place = cell_of(workbook, "SeparationMargins", 1, "Margin check")
        places.append(place[1])
        workbook.set_cell(*place, 25.0, replace_formula=True)
        workbook.set_name("OverallVerdict", "PASS: all 5 checks", replace_formula=True)

    found = verify_file(edited(edit))
    typed = {f.cell: f for f in failing(found) if f.kind == "edited"}
    assert set(typed) == {*places, "B9"}
    assert typed["B9"].sheet == "Summary"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sheet", "label", "put"),
    [("Summary", "Least separation margin", 31.4), ("Fatigue", "1 / sum = allowable starts", 9e6)],
)
def test_a_key_number_typed_over_is_found_beside_its_label(edited, sheet, label, put):
    def edit(workbook):
        part = workbook.sheet_part(sheet)
        cells = [(r, c) for r in range(1, 80) for c in range(1, 20) if part.constant(r, c) == label]
        [(row, column)] = cells
        beside = next(c for c in range(column + 1, column + 5) if (row, c) in part.formulas)
        workbook.set_cell(sheet, cell_name(row, beside), put, replace_formula=True)

    [finding] = failing(verify_file(edited(edit)))
    assert finding.sheet == sheet
    assert label in finding.sentence


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
def test_no_result_anywhere_can_be_edited_unseen(edited, seed):
    """A few cells of every result table, by a hundredth or by a letter: each is named."""
    rng = random.Random(seed)
    touched: set[tuple[str, str]] = set()

    def edit(workbook):
        for spec in (*RESULT_TABLES, *WORKBOOK_TABLES):
            table = workbook.table(spec.name)
            owned = [f.name for f in spec.workbook_columns if f not in spec.extra_columns]
            cells = [
                cell_of(workbook, spec.name, row, column)
                for row in range(1, table.data.height + 1)
                for column in owned
                if column not in spec.row_name
                and (spec.name, column) not in {("Effects", "Time"), ("AccuracyCost", "Time")}
                and not (
                    spec.name == "Audit"
                    and is_own_of_each_run(
                        str(workbook.shown_value(*cell_of(workbook, "Audit", row, "Item")))
                    )
                )
            ]
            held = [c for c in cells if workbook.shown_value(*c) not in (None, "")]
            for place in rng.sample(held, min(4, len(held))):
                was = workbook.shown_value(*place)
                workbook.set_cell(
                    *place, 1.01 * was + 0.01 if isinstance(was, float) else f"{was}x"
                )
                touched.add(place)

    found = verify_file(edited(edit))
    named = {(f.sheet, f.cell) for f in failing(found)}
    assert len(touched) > 40
    assert touched - named == set()


@pytest.mark.slow
def test_changed_inputs_are_told_from_changed_results(edited):
    def edit(workbook):
        place = cell_of(workbook, "Elements", 2, "Stiffness")
        workbook.set_cell(*place, 1.05 * value(workbook, place))

    found = verify_file(edited(edit))
    assert found.sentence.startswith("The results belong to other inputs.")
    assert found.recorded != found.inputs
    kinds = {f.kind for f in failing(found)}
    assert "digest" in kinds
    assert "edited" not in kinds  # nobody can tell


def test_the_same_input_in_another_unit_changes_nothing(edited):
    def edit(workbook):
        unit = unit_cell_of(workbook, "Elements", "Stiffness")
        assert workbook.shown_value(*unit) == "lbf*in/rad"
        workbook.set_cell(*unit, "lbf*ft/rad")
        table = workbook.table("Elements")
        for row in range(1, table.data.height + 1):
            place = cell_of(workbook, "Elements", row, "Stiffness")
            if workbook.shown_value(*place) is not None:
                workbook.set_cell(*place, value(workbook, place) / 12)

    found = verify_file(edited(edit))
    assert found.recorded == found.inputs
    assert found.passes


@pytest.mark.slow
def test_results_are_compared_in_the_unit_the_engineer_chose(edited, tmp_path):
    def edit(workbook):
        workbook.set_cell(*unit_cell_of(workbook, "StartupPeaks", "Maximum torque"), "kN*m")

    changed = edited(edit)
    columns = [f for f in failing(verify_file(changed)) if f.table == "StartupPeaks"]
    assert ["unit was changed after the calculation" in f.sentence for f in columns] == [True]
    recalculate(changed, destination=tmp_path / "again.xlsx")
    assert verify_file(tmp_path / "again.xlsx").passes


@pytest.mark.slow
def test_rows_may_be_sorted_but_not_removed_or_added(edited):
    def rows_of(workbook):
        table = workbook.table("SteadyState")
        names = [c for c in table.columns if c != "UTS/25 check"]
        rows = [
            [workbook.shown_value(*cell_of(workbook, "SteadyState", k, c)) for c in names]
            for k in range(1, table.data.height + 1)
        ]
        return names, rows

    def sort(workbook):
        names, rows = rows_of(workbook)
        workbook.write_table("SteadyState", rows[::-1], columns=names)

    def remove(workbook):
        names, rows = rows_of(workbook)
        workbook.write_table("SteadyState", [*rows[:4], *rows[5:]], columns=names)

    def add(workbook):
        names, rows = rows_of(workbook)
        more = ["New coupling", *rows[0][1:]]
        workbook.write_table("SteadyState", [*rows, more], columns=names)

    assert [f for f in failing(verify_file(edited(sort))) if f.kind != "old value"] == []
    for edit, kind in ((remove, "row missing"), (add, "row added")):
        found = [f for f in failing(verify_file(edited(edit))) if f.table == "SteadyState"]
        assert [f.kind for f in found] == [kind]


def test_a_digest_typed_over_is_seen(edited):
    def edit(workbook):
        workbook.set_name("run_SHA256", "ab" * 32)

    found = verify_file(edited(edit))
    assert "digest" in {f.kind for f in failing(found)}


@pytest.mark.slow
def test_a_name_led_to_another_cell_is_seen(train, tmp_path):
    target = rewritten(
        train,
        tmp_path / "led.xlsx",
        "xl/workbook.xml",
        lambda text: re.sub(r'(name="run_StartsFactor"[^>]*>)[^<]*', r"\g<1>Notes!$B$90", text),
    )
    assert any(
        "run_StartsFactor refers to this cell" in f.sentence for f in failing(verify_file(target))
    )


def test_an_old_value_of_a_formula_is_seen(train, tmp_path):
    """Results as calculated, but the overall verdict shows what it showed before."""
    with zipfile.ZipFile(train) as archive:
        sheet = archive.read("xl/worksheets/sheet1.xml").decode()
    cell = re.search(r'<c r="B9".*?</c>', sheet).group()
    shown = re.search(r"<v>(.*?)</v>", cell).group(1)
    assert shown.startswith("FAIL")
    target = rewritten(
        train,
        tmp_path / "old.xlsx",
        "xl/worksheets/sheet1.xml",
        lambda text: text.replace(cell, cell.replace(shown, "PASS: all 5 checks")),
    )
    assert ("old value", "Summary", "B9") in {
        (f.kind, f.sheet, f.cell) for f in failing(verify_file(target))
    }


def test_drawn_data_are_compared_too(edited):
    def edit(workbook):
        sheet, cell = cell_of(workbook, "ChartHistory", 100, "Value 1")
        workbook.set_cell(sheet, cell, 0.0)

    [finding] = failing(verify_file(edited(edit)))
    assert (finding.kind, finding.table) == ("chart", "ChartHistory")


def test_another_element_chosen_to_be_drawn_is_a_note(edited):
    def edit(workbook):
        workbook.set_name("PlotElement1", "LS coupling")

    found = verify_file(edited(edit))
    assert found.passes
    assert any("LS coupling was selected afterwards" in f.sentence for f in found.findings)


@pytest.mark.slow
def test_settings_of_the_command_line_are_part_of_the_recomputation(calculated, tmp_path):
    target = tmp_path / "newmark.xlsx"
    settings = {"method": "newmark", "tolerance_peak": 0.005}
    recalculate(calculated / "case.xlsx", destination=target, overrides=settings)
    found = verify_file(target)
    assert found.passes
    assert found.settings == settings

    workbook = open_workbook(target)
    table = workbook.table("Audit")
    row = next(
        r
        for r in range(1, table.data.height + 1)
        if "tolerance_peak" in str(workbook.shown_value(*cell_of(workbook, "Audit", r, "Item")))
    )
    workbook.set_cell(*cell_of(workbook, "Audit", row, "Value"), "as agreed")
    workbook.save(tmp_path / "hidden.xlsx")
    found = verify_file(tmp_path / "hidden.xlsx")
    assert "settings" in {f.kind for f in failing(found)}


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("share", [3.0, 0.5])
def test_a_result_of_another_version_is_judged_by_the_reported_error(edited, share):
    """Half of it is accepted, three times as much is not."""

    def edit(workbook):
        workbook.set_name("run_Software", "torsionbook 0.0.1")
        table = workbook.table("Audit")
        for row in range(1, table.data.height + 1):
            if workbook.shown_value(*cell_of(workbook, "Audit", row, "Item")) == "Software":
                place = cell_of(workbook, "Audit", row, "Value")
                workbook.set_cell(*place, "torsionbook 0.0.1")
        place = cell_of(workbook, "StartupPeaks", 1, "Maximum torque")
        error = value(workbook, cell_of(workbook, "StartupPeaks", 1, "Error")) / 100
        workbook.set_cell(*place, value(workbook, place) + share * error * _range(workbook))

    source = edited(edit)
    found = verify_file(source)
    assert found.made_by == "torsionbook 0.0.1"
    if share > 1.0:
        assert not found.passes
        [told] = failing(found)
        assert (told.table, told.column) == ("StartupPeaks", "Maximum torque")
        return
    assert found.passes
    assert found.total(Agreement.ERROR) == 1
    assert not verify_file(source, within=Agreement.DIGITS).passes


def _range(workbook: Workbook) -> float:
    """What an error of the first row of `StartupPeaks` is a share of."""
    return value(workbook, cell_of(workbook, "StartupPeaks", 1, "Peak-to-peak torque"))


@pytest.mark.slow
def test_a_signed_workbook_can_be_verified(train, tmp_path):
    signed = tmp_path / "signed.xlsx"
    shutil.copyfile(train, signed)
    with zipfile.ZipFile(signed, "a") as archive:
        archive.writestr("_xmlsignatures/sig1.xml", b"<s/>")
    assert verify_file(signed).passes


def test_a_template_was_never_calculated(tmp_path):
    source = Path(shutil.copyfile(template_path("example_proposed.xlsx"), tmp_path / "new.xlsx"))
    assert verify_file(source).outcome == "never calculated"


def test_wrong_inputs_are_listed_and_nothing_is_judged(edited):
    def edit(workbook):
        workbook.set_cell(*cell_of(workbook, "Elements", 2, "Stiffness"), "stiff")

    found = verify_file(edited(edit))
    assert found.outcome == "not verified"
    assert [p.cell for p in found.problems] == ["F28"]


@pytest.mark.slow
def test_an_accuracy_study_stays_and_is_held_against_its_inputs(train, tmp_path):
    studied = tmp_path / "studied.xlsx"
    done = study_one(ACCURACY, train, serial_map(), {"quick": True}, StudyFiles(studied))
    assert done.result is not None
    assert verify_file(studied).passes
    workbook = open_workbook(studied)
    workbook.set_name("run_AccuracyInputs", "Study of the inputs with SHA-256 0123456789ab…")
    workbook.save(tmp_path / "other.xlsx")
    found = verify_file(tmp_path / "other.xlsx")
    assert ["study belongs" in f.sentence for f in failing(found) if f.kind == "digest"] == [True]


@pytest.mark.slow
def test_a_workbook_saved_by_another_program_still_follows(train, soffice, tmp_path):
    saved = soffice.convert(train, "xlsx", tmp_path / "saved")
    found = verify_file(saved)
    assert found.passes
    assert found.total(Agreement.DIGITS) > 0  # written with fifteen digits there
    assert found.total(Agreement.ERROR) == found.total(Agreement.DIFFERENT) == 0
    assert not found.findings  # its formulas too can be judged


def rewritten(source: Path, target: Path, part: str, change) -> Path:
    """A copy with the text of one part changed, as no program would."""
    with zipfile.ZipFile(source) as archive, zipfile.ZipFile(target, "w") as copy:
        for entry in archive.infolist():
            data = archive.read(entry)
            if entry.filename == part:
                text = change(data.decode("utf-8"))
                assert text != data.decode("utf-8")
                data = text.encode("utf-8")
            copy.writestr(entry, data)
    return target


def test_what_engineers_ask_first_is_told_first(edited):
    """Of a changed input: verdicts and key numbers, then frequencies ... starts; charts and cycles last."""

    def edit(workbook):
        place = cell_of(workbook, "Elements", 2, "Stiffness")
        workbook.set_cell(*place, 1.3 * value(workbook, place))

    told = failing(verify_file(edited(edit)))
    assert told[0].kind == "digest"
    tables = list(dict.fromkeys(f.table for f in told[1:] if f.table and f.kind != "old value"))
    order = [
        "Verdicts", "NaturalFrequencies", "ModeShapes", "SeparationMargins", "SteadyState",
        "StartupPeaks", "StartupCrossings", "TorqueReversals", "AllowableStarts",
    ]  # fmt: skip
    asked = [table for table in tables if table in order]
    assert set(asked) >= {"Verdicts", "NaturalFrequencies", "StartupPeaks", "AllowableStarts"}
    assert [order.index(table) for table in asked if table != "ModeShapes"] == sorted(
        order.index(table) for table in asked if table != "ModeShapes"
    )
    first = [f for f in told if f.table == "StartCycles" or f.table.startswith("Chart")][0]
    after = told[told.index(first) :]
    assert {f.table for f in after} <= {"StartCycles", ""} | {f.table for f in after if f.table.startswith("Chart")}  # fmt: skip
    assert told.index(first) > max(told.index(f) for f in told if f.table in order)
