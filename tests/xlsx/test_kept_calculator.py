"""A workbook that stays open in the calculator gives what a calculation of the whole file gives."""

from __future__ import annotations

from multiprocessing import get_all_start_methods, get_context
from pathlib import Path
from typing import Any

import pytest
import xlsxwriter
from rich_workbooks import with_parts

from addin.xlsx import kept_calculator, open_workbook
from addin.xlsx.kept_calculator import KeptCalculator, Shelf

FORMULAS = {
    "A1": "SUM(T[a])*Factor",
    "A2": 'IF(A1>100,"much",IF(ISNUMBER(In!$B$2),In!$B$2,In!$B$2&"!"))',
    "A3": "INDEX(T[b],MATCH(MAX(T[a]),T[a],0))",
    "A4": "A1>A5",
    "A5": 'COUNTIF(T[b],"x*")+COUNT(In!$B$2)',
}
#: Values of column a, of column b and of cell B2 that are written one after the other.
CHANGES: tuple[tuple[tuple[Any, ...], tuple[Any, ...], Any], ...] = (
    ((1.0, 2.0, 3.0), ("x", "y", "xz"), 7.0),
    ((1.0, 2.0, 3.0), ("x", "y", "xz"), 7.0),
    ((50.0, 2.0, 300.0), ("x", "y", "=1+1"), "text"),
    ((0.1, 0.2, -0.0), ("", None, "x"), None),
    ((None, "none", 3e-300), ("x & <y>", "'z", "xx"), True),
    ((1.0, 2.0, 3.0), ("x", "y", "xz"), 7.0),
)


@pytest.fixture(autouse=True)
def shelf(monkeypatch: pytest.MonkeyPatch) -> Shelf:
    empty = Shelf()
    monkeypatch.setattr("addin.xlsx.formulas.SHELF", empty)
    return empty


def _workbook(path: Path, formulas: dict[str, str]) -> Path:
    book = xlsxwriter.Workbook(str(path))
    source, out = book.add_worksheet("In"), book.add_worksheet("Out")
    source.add_table(
        "A5:B8",
        {
            "name": "T",
            "columns": [{"header": "a"}, {"header": "b"}],
            "data": [[1, "x"], [2, "y"], [3, "z"]],
        },
    )
    source.write_number("B1", 2.0)
    source.write_number("B2", 1.0)
    book.define_name("Factor", "=In!$B$1")
    for cell, formula in formulas.items():
        out.write_formula(cell, formula, None, "")
    book.close()
    return path


def _written(path: Path, change: tuple[Any, Any, Any]) -> dict[str, Any]:
    """What sheet Out shows after a change."""
    first, second, single = change
    book = open_workbook(path)
    book.write_table("T", list(zip(first, second, strict=True)))
    book.set_cell("In", "B2", single)
    done = book.save(path.with_name("out.xlsx"))
    assert done.caches.method == "recalculated"
    again = open_workbook(done.path, read_only=True)
    return {cell: again.shown_value("Out", cell) for cell in FORMULAS}


def test_results_are_those_of_the_whole_file(
    tmp_path: Path, shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = _workbook(tmp_path / "book.xlsx", FORMULAS)
    monkeypatch.setattr(shelf, "wants", lambda formulas: False)
    whole = [_written(path, change) for change in CHANGES]
    assert len(set(map(repr, whole))) == 4
    monkeypatch.undo()
    monkeypatch.setattr("addin.xlsx.formulas.SHELF", shelf)
    for _ in range(2):  # the first time nothing is kept, the second time it is made
        assert _written(path, CHANGES[0]) == whole[0]
    assert len(shelf._kept) == 1
    asked = []
    results = KeptCalculator.results
    monkeypatch.setattr(
        KeptCalculator, "results", lambda *a: asked.append(results(*a)) or asked[-1]
    )
    assert list(map(repr, (_written(path, change) for change in CHANGES))) == list(map(repr, whole))
    assert len(asked) == len(CHANGES)
    assert all(one is not None for one in asked)


@pytest.mark.parametrize(
    "formula",
    [
        "NOW()",
        "SUBTOTAL(9,In!B1:B2)",
        "OFFSET(In!B1,0,0)",
        "SUM(In!A:XFD)",
        "1/0",
        'IF(In!B1=2,"",NOSUCH(1))',
        "IFERROR(NOSUCH(1),2)",
        "_xlfn.CONCAT(In!B1)",
    ],
)
def test_other_formulas_are_calculated_with_the_whole_file(
    formula: str, tmp_path: Path, shelf: Shelf
) -> None:
    path = _workbook(tmp_path / "book.xlsx", {"A1": "SUM(T[a])", "A2": formula})
    for _ in range(3):
        assert _written(path, CHANGES[0])["A1"] == 6.0
    assert not shelf._kept


@pytest.mark.skipif("fork" not in get_all_start_methods(), reason="processes are not forked here")
def test_a_forked_process_calculates_with_what_is_kept(tmp_path: Path, shelf: Shelf) -> None:
    path = _workbook(tmp_path / "book.xlsx", FORMULAS)
    for _ in range(2):
        _written(path, CHANGES[0])
    assert shelf._kept
    child = get_context("fork").Process(target=_written, args=(path, CHANGES[2]))
    child.start()
    child.join(60.0)
    is_done = child.exitcode == 0
    child.kill()
    assert is_done


def test_a_calculator_is_kept_for_one_calendar(tmp_path: Path, shelf: Shelf) -> None:
    path = _workbook(tmp_path / "book.xlsx", {"A1": "SUM(T[a])"})
    for _ in range(2):
        _written(path, CHANGES[0])
    (calculator,) = shelf._kept.values()
    book = open_workbook(path)
    assert calculator.results(book) == {("Out", 1, 1): 6.0}
    calculator._settings = [b' date1904="1"']
    assert calculator.results(book) is None


def test_a_calculator_is_made_once_for_values_that_nobody_believes(
    tmp_path: Path, shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where it contradicts what the file shows in cells that did not change, the whole file must tell each time."""
    path = _workbook(tmp_path / "book.xlsx", {"A1": "SUM(T[a])", "A2": "1+1"})

    def wrong(data: bytes) -> bytes:
        return data.replace(b"<f>1+1</f><v></v>", b"<f>1+1</f><v>3</v>")

    with_parts(path, {}, {"xl/worksheets/sheet2.xml": wrong})
    made = []
    make = KeptCalculator.__init__
    monkeypatch.setattr(KeptCalculator, "__init__", lambda *a: made.append(1) or make(*a))
    for _ in range(4):
        shown = _written(path, CHANGES[0])
        assert (shown["A1"], shown["A2"]) == (6.0, 3.0)
    assert len(made) == 1


def test_few_calculators_are_kept(tmp_path: Path, shelf: Shelf) -> None:
    for number in range(kept_calculator._MOST_KEPT + 2):
        path = _workbook(tmp_path / f"{number}.xlsx", {"A1": f"SUM(T[a])+{number}"})
        for _ in range(2):
            assert _written(path, CHANGES[0])["A1"] == 6.0 + number
    assert len(shelf._kept) == kept_calculator._MOST_KEPT
