"""The macro `Recalculate`: the open workbook ends as the file that a recalculation writes."""

import inspect
import shutil
from pathlib import Path

import openpyxl
import pytest
from open_workbook import OpenBook
from openpyxl.utils import range_boundaries

from addin.contract.sheets import part_named
from addin.contract.shipped import template_path
from addin.contract.tables import INPUT_TABLES
from addin.excel import refill as module
from addin.excel.refill import refill
from addin.excel.workbook import install
from addin.writing.open_workbook import excel_value
from addin.xlsx import ErrorValue, Formula, open_workbook

USUAL = (True, True, "automatic", True)


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """The files that `refill` makes in its own folder, kept to be looked at."""
    folder = tmp_path / "kept"
    folder.mkdir()
    real = module.recalculate

    def watched(copy, *, destination, **more):
        done = real(copy, destination=destination, **more)
        for path in done.written:
            shutil.copyfile(path, folder / path.name)
        return done

    monkeypatch.setattr(module, "recalculate", watched)
    return folder


def open_book(folder: Path, name: str, change=None) -> OpenBook:
    path = folder / "train.xlsm"
    install(template_path(f"{name}.xlsx"), path)
    if change is not None:
        book = openpyxl.load_workbook(path, keep_vba=True)
        change(book)
        book.save(path)
    return OpenBook(path)


@pytest.fixture(scope="module")
def refilled(tmp_path_factory):
    """The proposed example after the macro has run; not to be changed."""
    book = open_book(tmp_path_factory.mktemp("refilled"), "example_proposed")
    refill(book)
    return book


def shown(value):
    value = getattr(value, "text", value)
    return value.replace("_xlfn.", "") if isinstance(value, str) else value


def differences(book: OpenBook, path: Path):
    """Cells of the open workbook that are not as in a file; a blank text is a blank."""
    for sheet in openpyxl.load_workbook(path).worksheets:
        there = {(c.row, c.column): shown(c.value) for row in sheet.iter_rows() for c in row}
        here = {p: shown(v) for p, v in book.sheets[sheet.title].cells.items()}
        for place in {*there, *here}:
            a, b = here.get(place), there.get(place)
            if (a or None) != (b or None) and not (a == b == 0):
                yield sheet.title, place, a, b


@pytest.mark.slow
@pytest.mark.parametrize("name", ["example_proposed", "example_backlash"])
def test_every_cell_ends_as_in_the_recalculated_file(tmp_path, kept, name):
    book = open_book(tmp_path, name)
    before = {n: dict(s.cells) for n, s in book.sheets.items()}
    refill(book)
    assert [text for mode, text in book.alerts if mode == "critical"] == []
    assert list(differences(book, kept / "train.xlsm")) == []
    assert len(list(differences(OpenBook(book.path), kept / "train.xlsm"))) > 300
    tables = {
        t.name: t.ref
        for s in openpyxl.load_workbook(kept / "train.xlsm").worksheets
        for t in s.tables.values()
    }
    ours = {
        n: t.range.address.replace("$", "")
        for s in book.sheets.values()
        for n, t in s.tables.items()
    }
    assert ours == tables
    changed = {n for n, s in book.sheets.items() if s.cells != before[n]}
    assert {"Results", "Start"} <= changed
    assert book.app.state == USUAL


def test_inputs_are_never_written(refilled):
    """Sheets with inputs may hold results beside them: nothing is written into the tables of inputs."""
    book = refilled
    assert book.sheets["xlwings.conf"].written == set()
    workbook = open_workbook(template_path("example_proposed.xlsx"), read_only=True)
    for spec in INPUT_TABLES:
        table = workbook.table(spec.name)
        inside = {at for at in book.sheets[table.sheet].written if table.ref.has(*at)}
        assert inside == set(), spec.name
    assert book.written


@pytest.mark.slow
def test_a_second_time_with_fewer_rows_leaves_nothing_stale(tmp_path, kept):
    """The tables of a larger train shrink to those of a smaller one."""
    book = open_book(tmp_path, "example_backlash")
    refill(book)
    for sheet in book.sheets.values():  # the smaller train's workbook in the larger one's cells
        sheet.written.clear()
    small = tmp_path / "small.xlsm"
    install(template_path("example_proposed.xlsx"), small)
    book.api.SaveCopyAs = lambda place: shutil.copyfile(small, place)
    before = {n: s.tables for n, s in book.sheets.items()}
    rows = {n: t.range.last[0] for s in before.values() for n, t in s.items()}
    refill(book)
    shrunk = {n for s in before.values() for n, t in s.items() if t.range.last[0] < rows[n]}
    assert shrunk
    sheets = {sheet for sheet, _ in book.written}
    assert {"Effects and accuracy", "Start"} <= sheets
    # inputs stay those of the larger train
    inputs = [
        (sheet, range_boundaries(table.ref))
        for sheet, page in ((p.title, p) for p in openpyxl.load_workbook(small))
        for table in page.tables.values()
        if table.name in {spec.name for spec in INPUT_TABLES}
    ]

    def is_input(sheet, row, column):
        if sheet == "Case" and column <= part_named("Case verdicts").shift:
            return True
        return any(
            sheet == where and left <= column <= right and top - 1 <= row <= bottom
            for where, (left, top, right, bottom) in inputs
        )

    assert [
        d
        for d in differences(book, kept / "train.xlsm")
        if d[0] in sheets and not is_input(d[0], *d[1])
    ] == []


def test_new_rows_get_the_formats_of_the_first(refilled):
    book = refilled
    assert book.pasted
    assert book.app.api.CutCopyMode is False


def test_progress_is_told_in_the_status_bar(refilled):
    book = refilled
    assert all(text.startswith("torsionbook: ") for text in book.bar)
    assert "torsionbook: reading" in book.bar
    assert book.bar[-1] == "torsionbook: writing results, 100 %"


@pytest.mark.slow
def test_large_blocks_go_in_portions(tmp_path, kept, monkeypatch):
    monkeypatch.setattr(module, "PORTION", 100)
    book = open_book(tmp_path, "example_proposed")
    refill(book)
    assert list(differences(book, kept / "train.xlsm")) == []
    assert len([text for text in book.bar if "writing results" in text]) > 50


def test_wrong_inputs_are_told_and_nothing_is_written(tmp_path, kept):
    def spoil(book):
        sheet = book["Train"]
        header = next(c for row in sheet.iter_rows() for c in row if c.value == "Inertia")
        sheet.cell(header.row + 1, header.column).value = -1.0

    book = open_book(tmp_path, "example_proposed", spoil)
    refill(book)
    ((mode, text),) = book.alerts
    assert mode == "critical"
    assert text.startswith("Nothing was calculated or written.")
    assert "Train" in text
    assert book.written == set()
    assert book.app.state == USUAL


def test_a_protected_sheet_is_named_before_anything_is_written(tmp_path, kept):
    book = open_book(tmp_path, "example_proposed")
    book.sheets["Results"].api.ProtectContents = True
    refill(book)
    assert [mode for mode, _ in book.alerts] == ["critical"]
    assert "sheet Results is protected" in book.alerts[0][1]
    assert book.written == set()


def test_excel_is_put_back_as_it_was_whatever_happens(tmp_path, kept):
    book = open_book(tmp_path, "example_proposed")

    def fails(*_):
        raise RuntimeError("made up")

    book.sheets["Summary"].set = book.sheets["Results"].set = fails
    with pytest.raises(RuntimeError, match="made up"):
        refill(book)
    assert book.app.state == USUAL


@pytest.mark.slow
def test_histories_are_kept_beside_the_workbook(tmp_path, kept):
    def keep(book):
        place = book.defined_names["KeepHistory"].attr_text
        sheet, cell = place.replace("$", "").split("!")
        book[sheet][cell] = "npz"

    book = open_book(tmp_path, "example_proposed", keep)
    refill(book)
    (made,) = tmp_path.glob("train*.npz")
    assert made.read_bytes() == (kept / made.name).read_bytes()
    made.unlink()
    book.api.FullName = "https://firm.sharepoint.com/Jobs/train.xlsm"
    refill(book)
    assert list(tmp_path.glob("train*.npz")) == []
    assert "were not saved" in book.alerts[-1][1]


def test_the_macro_hands_over_the_workbook_that_called(excel, monkeypatch):
    seen = []
    monkeypatch.setattr(excel.xlwings.Book, "caller", lambda: "the workbook")
    monkeypatch.setattr(excel.module, "refill", seen.append)
    excel.module.recalculate()
    assert seen == ["the workbook"]


def test_the_stand_in_has_no_more_than_xlwings_has(excel):
    """Names that `refill` uses, on the classes of xlwings itself."""
    main = excel.xlwings.main
    for owner, names in (
        (main.App, "status_bar screen_updating enable_events calculation alert api"),
        (main.Book, "name app api sheets caller"),
        (main.Sheet, "range tables api"),
        (main.Table, "range resize"),
        (main.Range, "value address clear_contents api"),
    ):
        assert [n for n in names.split() if not hasattr(owner, n)] == []
    assert {"prompt", "title", "mode"} <= set(inspect.signature(main.App.alert).parameters)


@pytest.mark.parametrize(
    ("value", "handed"),
    [
        (None, None), ("", None), (1, 1.0), (2.5, 2.5), (True, True), ("pass", "pass"),
        ("LS coupling", "LS coupling"), ("3-4", "'3-4"), ("=A1", "'=A1"), ("-", "'-"),
        ("'quoted", "''quoted"), ("TRUE", "'TRUE"), ("Mar 1", "'Mar 1"), ("#N/A", "'#N/A"),
        ("2 × slip", "'2 × slip"), (ErrorValue("#N/A"), "#N/A"),
        (Formula("=A1/2"), "=A1/2"), (Formula("_xlfn.XLOOKUP(1,A:A,B:B)"), "=XLOOKUP(1,A:A,B:B)"),
        (Formula("_xlfn._xlws.FILTER(A:A,B:B)"), "=FILTER(A:A,B:B)"),
    ],
)  # fmt: skip
def test_texts_stay_texts(value, handed):
    assert excel_value(value) == handed
    assert type(excel_value(value)) is type(handed)
