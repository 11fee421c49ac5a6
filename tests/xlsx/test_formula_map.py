"""What formulas read and which depend on which is kept in the process: by content, and not without limit."""

from __future__ import annotations

from dataclasses import replace

from addin.xlsx import dependents
from addin.xlsx.dependents import ChangedCells, FormulaCell, FormulaMap, formula_map
from addin.xlsx.references import Rect, parse_range
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import DefinedName

TABLE = Table("T", "S", parse_range("A1:B9"), ("a", "b"), True, False, (None, None), "t.xml")
NAME = DefinedName("n", "S!$D$1", "", "S", parse_range("D1"))
FORMULAS = {"F1": "SUM(T[a])", "F2": "F1*2", "F3": "n+1", "F4": "F3&F2", "F5": "1+1"}


def _cells(**others: str) -> tuple[FormulaCell, ...]:
    texts = {**FORMULAS, **others}
    return tuple(FormulaCell("S", parse_range(cell), text) for cell, text in texts.items())


def _map(
    cells: tuple[FormulaCell, ...] | None = None, name: DefinedName = NAME, table: Table = TABLE
) -> FormulaMap:
    return formula_map(cells or _cells(), ("S", "R"), (name,), (table,))


def _changed(*cells: str) -> ChangedCells:
    changed = ChangedCells()
    for cell in cells:
        changed.add("S", parse_range(cell))
    return changed


def test_workbooks_with_equal_formulas_share_a_map() -> None:
    assert _map() is _map()


def test_a_map_belongs_to_its_texts_names_and_tables() -> None:
    longer = replace(TABLE, ref=parse_range("A1:B12"))
    other = replace(NAME, text="S!$E$1", rect=parse_range("E1"))
    maps = [_map(), _map(_cells(F2="F1*3")), _map(name=other), _map(table=longer)]
    assert len({id(one) for one in maps}) == len(maps)
    assert maps[0].downstream_of_cells(_changed("D1")) == {2, 3}
    assert maps[2].downstream_of_cells(_changed("D1")) == set()
    assert maps[0].downstream_of_cells(_changed("A12")) == set()
    assert maps[3].downstream_of_cells(_changed("A12")) == {0, 1, 3}


def test_answers_are_those_of_the_graph_whatever_was_asked_before() -> None:
    asked = [("A2",), ("B2",), ("D1",), ("F1", "A2"), ("F1",), ("F3", "D1"), ("A2:B9",), ()]
    for changes in (*asked, *reversed(asked), *(asked * 3)):
        changed = _changed(*changes)
        fresh = FormulaMap(_cells(), ("S", "R"), (NAME,), (TABLE,))
        assert _map().downstream_of_cells(changed) == fresh.graph.downstream_of_cells(changed)
        assert len(_map()._reached) <= dependents._MOST_CHANGES_KEPT


def test_what_is_kept_has_a_limit() -> None:
    first = _map()
    for number in range(dependents._MOST_MAPS + 1):
        _map(_cells(F5=f"2+{number}"))
    assert _map() is not first
    many = tuple(
        FormulaCell("S", Rect(k + 1, 8, k + 1, 8), "1")
        for k in range(dependents._MOST_FORMULAS_KEPT + 1)
    )
    assert _map(many) is not _map(many)
