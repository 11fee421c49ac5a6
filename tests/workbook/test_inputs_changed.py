"""A sheet that knows when it is old: inputs edited in a spreadsheet program after the calculation."""

from __future__ import annotations

import math
import re
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pint
import pytest
from made_up_run import SOURCE, STAMP, made_up_run
from workbook_checks import rated_torque

from addin.contract.banner import OVERALL_WITHOUT_COPY
from addin.contract.field import Field, TableSpec
from addin.contract.sheets import SHEETS
from addin.contract.studies.registry import STUDIES, printed_parts
from addin.contract.tables import DIMENSIONS, INPUT_TABLES, SCALARS
from addin.reading.workbook import WorkbookInput, read_workbook
from addin.writing.workbook import write_results
from addin.xlsx import Formula, open_workbook
from addin.xlsx.references import cell_name, parse_cell
from tests.calc_session import answers
from tests.opened import opened

CHANGED = "INPUTS CHANGED SINCE CALCULATION"
#: Inputs that belong to the document and change no result.
OF_THE_DOCUMENT = {
    "TemplateVersion", "Title", "Tag", "Client", "Document", "Revision", "PreparedBy", "CheckedBy",
    "KeepHistory", "Description", "Source",
}  # fmt: skip
#: Rows that each table gets; those of the torque curves belong to the stations of the example.
ROWS = 3
STATIONS = ("Motor", "LS coupling hub", "Bull gear")

#: Speed of the stations at synchronism, 1800 rpm times their ratios. [rad/s]
FULL_SPEEDS = tuple(60.0 * math.pi * 0.1 * (k + 1) for k in range(ROWS))
#: Rated torque as sheet Case of the example has it, a number and its unit. [N m]
RATED = rated_torque(SOURCE)
#: Units that are shares: dimension, unit, and what one of them is in SI.
SHARES = {
    ("torque", "pu"): RATED, ("torque", "%"): 0.01 * RATED, ("excitation torque", "pu"): RATED,
    ("running speed", "%"): 0.6 * math.pi, ("ratio", "1"): 1.0, ("ratio", "%"): 0.01,
    ("fraction", "1"): 1.0, ("fraction", "%"): 0.01, ("ratio", "pu"): 1.0, ("fraction", "pu"): 1.0,
}  # fmt: skip
_PINT = pint.UnitRegistry()


def in_si(dimension: str, unit: str) -> list[float]:
    """What a unit is worth in each row, from pint and from the bases above."""
    if dimension == "speed fraction":
        of_speed = unit not in ("%", "1")
        share = {"%": 0.01, "1": 1.0}.get(unit) or in_si("speed", unit)[0]
        return [share / full if of_speed else share for full in FULL_SPEEDS]
    if (dimension, unit) in SHARES:
        return [SHARES[dimension, unit]] * ROWS
    if dimension in ("speed", "running speed") and unit == "Hz":
        return [2.0 * math.pi] * ROWS
    if dimension == "frequency" and unit == "cpm":
        return [1.0 / 60.0] * ROWS
    return [float(_PINT(unit).to(DIMENSIONS[dimension].si.replace("1", "")).magnitude)] * ROWS


def filled(spec: TableSpec, field: Field, row: int) -> Any:
    """Something in every cell: whether it makes sense is of no matter here."""
    if field.choices and (not field.is_number or row == ROWS - 1):
        return field.choices[row % len(field.choices)]
    if not field.is_number:
        return STATIONS[row] if field.name == "Station" else f"{field.name} {row + 1}"
    return 0.1 * (row + 1) * (-1 if field.name == "Torque" and row == 1 else 1)


@pytest.fixture(scope="module")
def calculated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workbook with an entry in every input column and scalar, and results."""
    folder = tmp_path_factory.mktemp("calculated")
    workbook = open_workbook(SOURCE)
    for spec in INPUT_TABLES:
        rows = [[filled(spec, field, k) for field in spec.columns] for k in range(ROWS)]
        blank = [[None] * len(spec.columns)] * 2
        workbook.write_table(spec.name, [*rows, *blank], columns=[f.name for f in spec.columns])
    for field in SCALARS:
        if workbook.shown_value(*scalar_cell(workbook, field.name)) is None:
            value = field.choices[0] if field.choices else 0.25 if field.is_number else "words"
            workbook.set_name(field.name, value)
    workbook.save(folder / "in.xlsx")
    write_results(folder / "in.xlsx", folder / "out.xlsx", made_up_run(), STAMP)
    return folder / "out.xlsx"


def scalar_cell(workbook: Any, name: str) -> tuple[str, str]:
    rect = workbook.defined_names[name].rect
    return workbook.defined_names[name].sheet, cell_name(rect.top, rect.left)


@dataclass(frozen=True)
class Place:
    """An input column, or a scalar, in the workbook."""

    name: str
    field: Field
    sheet: str
    cells: tuple[str, ...]  #: Those that are filled.
    unit: str  #: Cell of the unit; empty where there is none.
    values: tuple[Any, ...]
    shown_unit: str


def places(read: WorkbookInput) -> Iterator[Place]:
    """Every input, from what the reader finds where."""
    book, found = read.workbook, read.locations

    def place(table: str, field: Field, sheet: str, cells: list[str]) -> Place:
        unit = found.units.get((table, field.name), ("", ""))[1] if field.has_unit else ""
        return Place(
            f"{table}.{field.name}", field, sheet, tuple(cells), unit,
            tuple(book.shown_value(sheet, cell) for cell in cells),
            str(book.shown_value(sheet, unit) or "1") if unit else "",
        )  # fmt: skip

    for field in SCALARS:
        sheet, cell = found.scalars[field.name]
        yield place("Case", field, sheet, [cell])
    for spec in INPUT_TABLES:
        table = found.tables[spec.name]
        for field in spec.columns:
            at = found.columns[spec.name, field.name]
            rows = range(table.data.top, table.data.top + ROWS)
            yield place(spec.name, field, table.sheet, [cell_name(row, at) for row in rows])


def typed(sheet: str, cell: str, value: Any) -> tuple[object, ...]:
    if value is None:
        return "clear", sheet, cell
    return (
        ("text", sheet, cell, value)
        if isinstance(value, str)
        else ("number", sheet, cell, repr(value))
    )


BANNER = ("read", "Summary", "B9")


@pytest.fixture(scope="module")
def calc(soffice: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("calc")
    return lambda steps: answers(soffice, folder, steps)


def test_every_input_that_is_edited_turns_the_banner(calculated: Path, calc: Any) -> None:
    steps: list[tuple[object, ...]] = [("open", calculated), BANNER]
    expected = [("as calculated", False)]
    for one in places(read_workbook(calculated)):
        cell, value = one.cells[-1], one.values[-1]
        matters = one.field.name not in OF_THE_DOCUMENT
        if isinstance(value, str):
            # a word in the place of a number is read whatever its capitals
            capitals = not one.field.is_number
            edits = [(value, False), (f"{value}x", True), (value.swapcase(), capitals)]
        else:
            edits = [(value, False), (value * (1 + 1e-11), False), (value * (1 + 1e-8), True),
                     (-value, True), (0.0, True), ("words", True)]  # fmt: skip
        for other, is_change in [*edits, (None, True), (value, False)]:
            steps += [typed(one.sheet, cell, other), BANNER]
            expected.append((f"{one.name}: {value!r} -> {other!r}", is_change and matters))
    seen = calc(steps)
    assert seen[0].startswith("FAIL")
    assert wrong(expected, seen) == []


@pytest.mark.slow
def test_a_unit_exchanged_with_its_values_is_no_change(calculated: Path, calc: Any) -> None:
    steps: list[tuple[object, ...]] = [("open", calculated)]
    expected = []
    for one in places(read_workbook(calculated)):
        if not one.unit or any(isinstance(value, str) for value in one.values):
            continue  # nothing that a unit could change
        dimension = one.field.dimension
        # of the torque transmitted, or of the base of a motor: known to a calculation only
        is_share = dimension in ("excitation torque", "per unit")
        then = None if is_share else in_si(dimension, one.shown_unit)
        for unit in dict.fromkeys(
            [*one.field.units, "1" if dimension == "ratio" else one.shown_unit]
        ):
            if one.name == "Case.RatedTorque" and unit in ("pu", "%"):
                continue  # the base of both
            steps += [("text", one.sheet, one.unit, unit), BANNER]
            if then is None:
                expected.append((f"{one.name} in {unit}", unit != one.shown_unit))
                continue
            now = in_si(dimension, unit)
            same = all(math.isclose(a, b, rel_tol=1e-9) for a, b in zip(then, now, strict=True))
            expected.append((f"{one.name} in {unit}", not same))
            for k, cell in enumerate(one.cells):
                steps.append(typed(one.sheet, cell, one.values[k] * then[k] / now[k]))
            steps.append(BANNER)
            expected.append((f"{one.name} converted to {unit}", False))
            steps += [typed(one.sheet, cell, one.values[k]) for k, cell in enumerate(one.cells)]
        steps += [("text", one.sheet, one.unit, "furlong"), BANNER]
        expected.append((f"{one.name} in furlong", True))
        steps += [("text", one.sheet, one.unit, one.shown_unit), BANNER]
        expected.append((f"{one.name} as before", False))
    assert wrong(expected, calc(steps)) == []


@pytest.mark.slow
def test_rows_added_and_deleted_are_a_change(calculated: Path, calc: Any) -> None:
    steps: list[tuple[object, ...]] = [("open", calculated)]
    expected = []
    found = read_workbook(calculated).locations
    for spec in INPUT_TABLES:
        table = found.tables[spec.name]
        top = table.data.top
        for what, step in (
            ("a blank row added", ("insert", table.sheet, top + 1)),
            ("the first row deleted", ("delete", table.sheet, top)),
            ("the last row deleted", ("delete", table.sheet, table.data.bottom)),
        ):
            steps += [step, BANNER, ("undo",), BANNER]
            expected += [(f"{spec.name}: {what}", True), (f"{spec.name}: undone", False)]
    for name in ("Stations", "EffectChoices"):
        table = found.tables[name]
        deletion = ("delete", table.sheet, table.data.top)
        steps += [("open", calculated), *[deletion] * table.data.height, BANNER]
        expected.append((f"{name}: all rows deleted", True))
    for name, (sheet, cell) in found.scalars.items():
        if name in ("LineFrequency", "PullInDamping"):
            steps += [("open", calculated), ("delete", sheet, parse_cell(cell)[0]), BANNER]
            expected.append((f"row of {name} deleted", True))
    assert wrong(expected, calc(steps)) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "tables", [INPUT_TABLES[::4], pytest.param(INPUT_TABLES, marks=pytest.mark.long)], ids=len
)
def test_a_table_that_grew_is_a_change_until_the_next_calculation(
    calculated: Path, calc: Any, tmp_path: Path, tables: Sequence[TableSpec]
) -> None:
    """As Excel lets a table grow when something is typed below it."""
    steps: list[tuple[object, ...]] = []
    expected = []
    for spec in tables:
        workbook = open_workbook(calculated)
        data = workbook.tables[spec.name].data
        part = workbook.sheet_part(workbook.tables[spec.name].sheet)
        columns = range(data.left, data.right + 1)
        rows = [[part.constant(k, c) for c in columns] for k in range(data.top, data.bottom + 1)]
        workbook.write_table(spec.name, [*rows, rows[0]])
        grown = workbook.save(tmp_path / f"{spec.name}.xlsx").path
        steps += [("open", grown), BANNER]
        expected.append((f"{spec.name} grown", True))
    assert opened(grown)["Summary"]["B9"].value == CHANGED  # without any program
    again = write_results(grown, tmp_path / "again.xlsx", made_up_run(), STAMP).path
    expected.append(("calculated again", False))
    assert wrong(expected, calc([*steps, ("open", again), BANNER])) == []


@pytest.mark.slow
def test_formulas_in_inputs_count_with_what_they_show(calculated: Path, calc: Any) -> None:
    (one,) = (p for p in places(read_workbook(calculated)) if p.name == "Stations.Inertia")
    column, row = one.cells[0].rstrip("0123456789"), int(one.cells[0].strip("ABCDEFGH"))
    below = f"{column}{row + ROWS}"
    steps: list[tuple[object, ...]] = [("open", calculated)]
    expected = []
    for cell, formula, is_change in (
        (below, '=""', False), (below, "=0*1", True), (below, "=1/0", True), (below, '=""', False),
        (one.cells[1], "=0.4/2", False), (one.cells[1], "=0.4/3", True), (one.cells[1], "=1/5", False),
    ):  # fmt: skip
        steps += [("formula", one.sheet, cell, formula), BANNER]
        expected.append((f"{cell} {formula}", is_change))
    assert wrong(expected, calc(steps)) == []


@pytest.mark.slow
def test_columns_whose_headers_are_exchanged_are_a_change(calculated: Path, calc: Any) -> None:
    """The reader of the inputs goes by the headers, the formulas of a program by the columns."""
    at = {p.name: p for p in places(read_workbook(calculated))}
    table = read_workbook(calculated).locations.tables["Elements"]
    cells = [
        re.sub(r"\d+", str(table.header_row), at[f"Elements.{name}"].cells[0])
        for name in ("OD", "ID")
    ]
    steps: list[tuple[object, ...]] = [("open", calculated), BANNER]
    expected = [("as calculated", False)]
    for headers, is_change in ((("ID", "OD"), True), (("OD", "ID"), False), (("OD", "Bore"), True)):
        steps += [("text", table.sheet, cells[0], "other")]
        steps += [
            ("text", table.sheet, cell, text)
            for cell, text in reversed(list(zip(cells, headers, strict=True)))
        ]
        steps.append(BANNER)
        expected.append((f"OD and ID called {headers}", is_change))
    assert wrong(expected, calc(steps)) == []


def test_every_banner_says_so_wherever_names_lead(
    calculated: Path, calc: Any, tmp_path: Path
) -> None:
    """The banners refer to cells, so that there is no name that somebody could lead elsewhere."""
    workbook = open_workbook(calculated)
    strips = [
        (sheet, cell_name(*at))
        for sheet in workbook.sheet_names
        for at in workbook.sheet_part(sheet).formulas
        if getattr(workbook.sheet_part(sheet).value(*at), "text", "") == "Summary!$B$9"
    ]
    visible = set(workbook.sheet_names) - workbook.structure.hidden_sheets.keys()
    assert sorted(sheet for sheet, _ in strips) == sorted(
        part.worksheet for part in SHEETS if part.name != "Summary"
    )
    assert {sheet for sheet, _ in strips} == visible - {"Summary"}
    astray = tmp_path / "astray.xlsx"
    names = rb'(name="(?:OverallVerdict|run_[A-Za-z0-9]+)"[^>]*>)[^<]*'
    with zipfile.ZipFile(calculated) as old, zipfile.ZipFile(astray, "w") as new:
        for entry in old.namelist():
            data = old.read(entry)
            if entry == "xl/workbook.xml":
                data, count = re.subn(names, rb"\g<1>Lists!$Z$50", data)
                assert count > 20
            new.writestr(entry, data)
    reads = [BANNER, *(("read", *strip) for strip in strips)]
    (one,) = (p for p in places(read_workbook(calculated)) if p.name == "Stations.Inertia")
    edit = typed(one.sheet, one.cells[0], 7.0)
    seen = calc([("open", calculated), *reads, edit, *reads, ("open", astray), edit, *reads])
    assert CHANGED not in seen[: len(reads)]
    assert len(seen) == 3 * len(reads)
    assert set(seen[len(reads) :]) == {CHANGED}


def wrong(expected: list[tuple[str, bool]], seen: list[str]) -> list[str]:
    assert len(seen) == len(expected)
    return [
        f"{what}: {banner}"
        for (what, is_change), banner in zip(expected, seen, strict=True)
        if (banner == CHANGED) is not is_change
    ]


@pytest.mark.slow
def test_an_input_of_an_unknown_function_leaves_the_banner_its_value(tmp_path: Path) -> None:
    """Such as one of an add-in: what it showed last is the input."""
    (one,) = (p for p in places(read_workbook(SOURCE)) if p.name == "Stations.Inertia")
    workbook = open_workbook(SOURCE)
    workbook.set_cell(one.sheet, one.cells[0], Formula("COMPANY.INERTIA(3)"))
    part = workbook.structure.worksheet_part(one.sheet)
    workbook.save(tmp_path / "no value.xlsx")
    shown = re.compile(rb'(<c r="%s"[^>]*><f>[^<]*</f>)' % one.cells[0].encode())
    with (
        zipfile.ZipFile(tmp_path / "no value.xlsx") as old,
        zipfile.ZipFile(tmp_path / "in.xlsx", "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for entry in old.namelist():
            data = old.read(entry)
            if entry == part:
                data, count = shown.subn(rb"\g<1><v>%r</v>" % one.values[0], data)
                assert count == 1
            new.writestr(entry, data)
    written = write_results(tmp_path / "in.xlsx", tmp_path / "out.xlsx", made_up_run(), STAMP).path
    assert opened(written)["Summary"]["B9"].value.startswith("FAIL")
    assert opened(written)["Inputs calculated"]["C2"].value is False


def test_a_workbook_of_an_earlier_version_is_written_as_before(tmp_path: Path) -> None:
    """Without the hidden sheet there is no copy, and nobody misses it."""
    with_other_names(tmp_path / "new.xlsx", rb'"(Calculated|InputChecks|InputUnits)')
    workbook = open_workbook(tmp_path / "new.xlsx")
    workbook.set_name("OverallVerdict", Formula(OVERALL_WITHOUT_COPY), replace_formula=True)
    workbook.save(tmp_path / "in.xlsx")
    report = write_results(tmp_path / "in.xlsx", tmp_path / "out.xlsx", made_up_run(), STAMP)
    # the hidden sheet is there, and a formula of it counts the rows of a table that is not
    assert [note for note in report.notes if "Inputs calculated!C2" not in note] == []
    tables = open_workbook(report.path).tables
    assert {table.data.height for name, table in tables.items() if "Calculated" in name} == {1}


def test_a_workbook_that_lost_the_copy_is_told_so(tmp_path: Path) -> None:
    with_other_names(tmp_path / "in.xlsx", rb'"(CalculatedMeshes)')
    report = write_results(tmp_path / "in.xlsx", tmp_path / "out.xlsx", made_up_run(), STAMP)
    assert [note for note in report.notes if "Inputs calculated are missing" in note]
    assert opened(report.path)["Summary"]["B9"].value == CHANGED


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (b'calcMode="manual"', ["manual calculation"]),
        (b'iterate="1" fullPrecision="0"', ["iterative calculation", "precision as displayed"]),
        (b'calcMode="autoNoTable" fullPrecision="1"', []),
    ],
)
def test_settings_that_make_banners_late_are_told_and_left_as_they_are(
    tmp_path: Path, settings: bytes, words: list[str]
) -> None:
    with zipfile.ZipFile(SOURCE) as shipped, zipfile.ZipFile(tmp_path / "in.xlsx", "w") as new:
        for entry in shipped.namelist():
            data = shipped.read(entry)
            if entry == "xl/workbook.xml":
                data = re.sub(rb"<calcPr [^>]*/>", b"<calcPr %s/>" % settings, data)
                assert settings in data
            new.writestr(entry, data)
    report = write_results(tmp_path / "in.xlsx", tmp_path / "out.xlsx", made_up_run(), STAMP)
    assert [note.split(" is set to ")[1].split(":")[0] for note in report.notes] == words
    with zipfile.ZipFile(report.path) as written:
        assert settings in written.read("xl/workbook.xml")


def test_formulas_that_lost_their_tables_are_told(tmp_path: Path) -> None:
    """Saved as .ods and back: Summary went on to say NOT CALCULATED, and `unlimited` where 477 starts were allowable."""
    with zipfile.ZipFile(SOURCE) as shipped, zipfile.ZipFile(tmp_path / "in.xlsx", "w") as new:
        for entry in shipped.namelist():
            data = shipped.read(entry)
            if entry.startswith("xl/worksheets/sheet"):
                data = re.sub(rb"\b(?:Verdicts|Audit)\[\w+\]", b"Summary!$E$28", data)
            new.writestr(entry, data)
    report = write_results(tmp_path / "in.xlsx", tmp_path / "out.xlsx", made_up_run(), STAMP)
    (note,) = [one for one in report.notes if "single cells instead of tables" in one]
    assert "torsionbook new NEW.xlsx --from OLD.xlsx" in note
    report = write_results(SOURCE, tmp_path / "other.xlsx", made_up_run(), STAMP)
    assert not [one for one in report.notes if "single cells" in one]


def with_other_names(path: Path, names: bytes) -> None:
    """The example with other names of tables, and of cells."""
    with (
        zipfile.ZipFile(SOURCE) as shipped,
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for entry in shipped.namelist():
            data = shipped.read(entry)
            if entry.startswith(("xl/tables/", "xl/workbook.xml")):
                data = re.sub(names, rb'"Own\1', data)
            new.writestr(entry, data)


@pytest.mark.slow
def test_lines_of_a_study_say_when_its_inputs_have_changed(
    studied: Path, calc: Any, tmp_path: Path
) -> None:
    (one,) = (p for p in places(read_workbook(studied)) if p.name == "Stations.Inertia")
    parts = [part for study in STUDIES for part in printed_parts(study)]
    lines = [("read", part.worksheet, part.at("B5")) for part in parts]
    seen = calc([("open", studied), *lines, typed(one.sheet, one.cells[0], 7.0), *lines])
    stamps, later = seen[: len(lines)], seen[len(lines) :]
    assert len(list(filter(None, stamps))) >= 4
    assert later == [line and f"{CHANGED}. {line}" for line in stamps]


def test_the_formulas_are_plain_ones_of_excel_2010(calculated: Path) -> None:
    part = open_workbook(calculated).sheet_part("Inputs calculated")
    texts = [part.value(*at).text for at in part.formulas]
    assert len(texts) > 150
    assert not part.arrays
    functions = {word for text in texts for word in re.findall(r"([A-Z][A-Z.0-9]*)\(", text)}
    assert functions <= {
        "AND", "COUNT", "EXACT", "IF", "IFERROR", "INDEX", "NOT", "OR", "ROWS", "SUM", "SUMPRODUCT",
    }  # fmt: skip
    assert max(map(len, texts)) < 1000
