"""Writing touches owned cells and nothing else."""

import zipfile
from pathlib import Path

import openpyxl
import pytest
from rich_workbooks import FAKE_VBA, MODES, changed_parts, parts_of, with_parts

from addin.xlsx import open_workbook

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")


def test_nothing_written_nothing_changed(train: Path) -> None:
    report = open_workbook(train).save(train.with_name("out.xlsx"))
    assert changed_parts(train, report.path) == set()
    assert report.parts == ()


def test_one_cell_on_a_sheet_nobody_reads_changes_that_part_alone(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Owner's notes", "F5", 3.5)
    report = book.save(train.with_name("out.xlsx"))
    assert changed_parts(train, report.path) == {"xl/worksheets/sheet5.xml"}
    assert report.caches.method == "not needed"


def test_only_the_value_of_the_cell_changes_in_the_part(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Start-up", "B5", 77.5)
    report = book.save(train.with_name("out.xlsx"))
    before, after = (parts_of(path)["xl/worksheets/sheet4.xml"] for path in (train, report.path))
    assert (
        after.replace(b"<v>77.5</v>", b"<v>500</v>").replace(
            b'<row r="5"', b'<row r="5" spans="1:2"'
        )
        == before
    )


@pytest.mark.parametrize("kind", ["train", "macro_train"])
def test_parts_without_owned_cells_stay_byte_identical(
    kind: str, request: pytest.FixtureRequest
) -> None:
    path: Path = request.getfixturevalue(kind)
    book = open_workbook(path)
    book.set_name("RatedPower", 5000.0)
    book.write_table("Modes", [[i, 10.0 * i, 600.0 * i, i / 6] for i in range(1, 8)])
    report = book.save(path.with_name("out" + path.suffix))
    changed = changed_parts(path, report.path)
    assert changed == set(report.parts) | set(report.dropped)
    # Case, Frequencies and Summary hold changed cells or formulas on them; two charts show such cells.
    assert {name for name in changed if "sheets/" in name} == {
        f"xl/worksheets/sheet{number}.xml" for number in (1, 2, 3)
    }
    assert {name for name in changed if "charts/" in name} == {
        "xl/charts/chart1.xml",
        "xl/charts/chart2.xml",
    }
    for kept in (
        "xl/styles.xml",
        "xl/sharedStrings.xml",
        "customXml/item1.xml",
        "xl/theme/theme1.xml",
    ):
        assert kept not in changed


def test_macros_stay_as_they_are(macro_train: Path) -> None:
    book = open_workbook(macro_train)
    book.set_name("Title", "new")
    out = book.save(macro_train.with_name("out.xlsm")).path
    parts = parts_of(out)
    assert parts["xl/vbaProject.bin"] == FAKE_VBA
    assert b"macroEnabled.main" in parts["[Content_Types].xml"]


def test_two_runs_give_identical_bytes(train: Path) -> None:
    outs = []
    for number in range(2):
        book = open_workbook(train)
        book.set_name("RatedPower", 1234.5)
        book.write_table("Modes", [[1, 2.0, 3.0, 4.0]])
        outs.append(book.save(train.with_name(f"out{number}.xlsx")).path.read_bytes())
    assert outs[0] == outs[1]


def test_writing_the_same_again_changes_nothing_more(train: Path) -> None:
    def recalculate(source: Path, name: str) -> Path:
        book = open_workbook(source)
        book.set_name("RatedPower", 1234.5)
        book.write_table("Modes", [[i, 2.0 * i, 3.0, 4.0] for i in range(9)])
        return book.save(train.with_name(name)).path

    first = recalculate(train, "first.xlsx")
    assert changed_parts(first, recalculate(first, "second.xlsx")) == set()


def test_notes_beside_and_below_a_table_stay(train: Path) -> None:
    for rows in (1, 3, 30):
        book = open_workbook(train)
        book.write_table("Modes", [[i, 1.0, 2.0, 3.0] for i in range(rows)])
        out = book.save(train.with_name(f"out{rows}.xlsx")).path
        sheet = openpyxl.load_workbook(out)["Frequencies"]
        assert sheet["G6"].value == "a note beside the table"
        assert sheet["B40"].value == "a note far below"
        assert sheet["B2"].value == "Natural frequencies"


def test_every_other_cell_reads_as_before(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", [[i, 1.0, 2.0, 3.0] for i in range(20)])
    out = book.save(train.with_name("out.xlsx")).path
    before, after = openpyxl.load_workbook(train), openpyxl.load_workbook(out)
    for sheet in before:
        for row in sheet.iter_rows():
            for cell in row:
                if sheet.title == "Frequencies" and 6 <= cell.row <= 25 and 2 <= cell.column <= 5:
                    continue
                if (sheet.title, cell.column) == ("Summary", 4):
                    continue  # results of an array formula on the table
                other = after[sheet.title][cell.coordinate]
                assert other.value == cell.value, f"{sheet.title}!{cell.coordinate}"
                assert other.style_id == cell.style_id
    assert len(MODES) == 3


def test_entries_with_data_descriptors_and_odd_names_are_copied(train: Path) -> None:
    """Java programs write sizes behind the data; names may be in any language."""
    source = train.with_name("java.xlsx")
    with zipfile.ZipFile(train) as old, open(source, "wb") as raw:

        class Unseekable:
            def write(self, data: bytes) -> int:
                return raw.write(data)

            def flush(self) -> None:
                raw.flush()

        with zipfile.ZipFile(Unseekable(), "w", zipfile.ZIP_DEFLATED) as new:  # type: ignore[call-overload]
            for entry in old.infolist():
                new.writestr(entry.filename, old.read(entry))
            new.writestr("customXml/prüfung.xml", b"<a/>")
    book = open_workbook(source)
    book.set_name("Title", "x")
    out = book.save(train.with_name("out.xlsx")).path
    assert changed_parts(source, out) <= {
        "xl/worksheets/sheet1.xml",
        "xl/worksheets/sheet3.xml",
        "xl/workbook.xml",
    }
    assert zipfile.ZipFile(out).testzip() is None


def test_prefixed_namespaces_are_kept(train: Path) -> None:
    def prefixed(data: bytes) -> bytes:
        head, _, rest = data.partition(b"<worksheet ")
        text = (b"<worksheet " + rest).decode()
        import re

        text = re.sub(r"<(/?)(?!x14|xm|mc|x:)(\w+)(?=[\s>/])", r"<\1x:\2", text)
        return head + text.replace(' xmlns="', ' xmlns:x="', 1).encode()

    with_parts(train, {}, {"xl/worksheets/sheet4.xml": prefixed})
    book = open_workbook(train)
    book.set_cell("Start-up", "B5", 7.25)
    book.set_cell("Start-up", "C50", "new row")
    out = book.save(train.with_name("out.xlsx")).path
    data = parts_of(out)["xl/worksheets/sheet4.xml"]
    assert b"<x:v>7.25</x:v>" in data
    assert b"<v>" not in data
    sheet = openpyxl.load_workbook(out)["Start-up"]
    assert (sheet["B5"].value, sheet["C50"].value) == (7.25, "new row")


def test_rows_and_cells_without_names_are_understood(train: Path) -> None:
    import re

    with_parts(
        train,
        {},
        {
            "xl/worksheets/sheet4.xml": lambda data: re.sub(
                rb'<c r="[A-Z]+(?:5|6)"', b"<c", data.replace(b'<row r="5"', b"<row")
            )
        },
    )
    book = open_workbook(train)
    assert book.value("Start-up", "B5") == 500.0
    book.set_cell("Start-up", "A6", None)
    assert book.value("Start-up", "B6") == 600.0
    out = book.save(train.with_name("out.xlsx")).path
    assert openpyxl.load_workbook(out)["Start-up"]["B6"].value == 600
