"""Cached values of formulas: never stale.

A formula cell stores its last result. When other cells were written into the file, the results that depend on them are
wrong until a spreadsheet program recalculates, and viewers never do. Hence, for every formula that depends on a changed
cell, the result is renewed, and where that cannot be done for certain, removed: blank beats wrong.

Renewed values come from formualizer, when it is installed. It is not trusted blindly: functions it does not know, values
that it gets otherwise than the file has them in cells that did not change, new errors, clock or random functions, and rich
values (pictures in cells, linked data types), which it takes for errors, make everything that depends on them suspect, and
that is removed and not replaced. So are the results of data tables, which it does not calculate.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.xlsx.calculator_copy import calculator_copy, reads_other_workbook
from addin.xlsx.dependents import (
    ChangedCells,
    FormulaCell,
    FormulaMap,
    Place,
    formula_map,
    spill_rect,
)
from addin.xlsx.formula_text import (
    CHANGES_BY_ITSELF,
    LOOKS_AT_HIDDEN_ROWS,
    parse_formula,
)
from addin.xlsx.kept_calculator import SHELF
from addin.xlsx.references import Rect, cell_name
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.state import WorkbookState
from addin.xlsx.text_row import TextFormula
from addin.xlsx.values import MAX_FORMULA, Constant, ErrorValue
from addin.xlsx.xml_part import Element, in_short, main

_F = main("f")
_HAS_FORMULA = re.compile(rb"<(?:\w+:)?f[\s/>]")
_HAS_RICH_VALUE = re.compile(rb"""\svm=["']""")

_PARENTHESES = re.compile(r"[()]")
# What it says of a file that is not written as most programs write it.
_OF_THE_FILE = "Unsupported feature"
# How the calculator calls a structured reference that it does not know.
_NAMED_REFERENCE = re.compile(r"[^\s\[\]]*\[.*\]")
# Spreadsheet programs take 64 levels of functions; a calculator that is given far more may run out of stack.
MAX_DEPTH = 256

# What may be spent on finding formulas that the calculator refuses: calculations, and as below in all of them.
_MOST_TRIES = 50
_MOST_TRIED = 2_000_000
# Characters of formulas, a shared one counted in each cell: so many are followed. Each costs some 100 bytes and a
# microsecond, as do what it refers to and its value; the calculator takes 64 times that for each formula. A mark of the
# container takes some 120, and one beside cells three times that.
_MOST_TEXT, _TEXT_OF_MARK = 4_000_000, 1.2
_CALCULATED_AS = 64

# Cells without a value any more that are named.
_MOST_NAMED = 20

# Results that are due to the data rather than to a calculator's shortcomings.
_HONEST_ERRORS = frozenset(["#DIV/0!", "#N/A", "#NUM!"])
# Two programs evaluate the same formula alike to the last digit or two; a larger difference is a disagreement.
_SAME_VALUE = 1e-14
_SAME_RESULT = 1e-9


@dataclass(frozen=True)
class CacheReport:
    """What was done about the cached values of formulas."""

    #: ``"not needed"`` (no formula depends on a changed cell), ``"recalculated"`` or ``"removed"``.
    method: str
    formulas: int = 0  #: Formula cells of the workbook.
    affected: int = 0  #: Those that depend on changed cells.
    changed: int = 0  #: Those that got a new value.
    #: Those that were left without a value, to be calculated when the workbook is opened.
    removed: int = 0
    removed_cells: tuple[str, ...] = ()  #: The first of these, as ``Sheet!B4``.
    reason: str = ""  #: Why values were removed, in words; empty otherwise.


def refresh_formula_caches(workbook: WorkbookState) -> CacheReport:
    """Renew or remove the cached value of each formula that depends on changed cells.

    Sheets without such a formula stay byte-identical.
    """
    if not workbook.changed:
        return CacheReport("not needed")
    cells = tuple(_formula_cells(workbook))
    if _text_of(cells) > _most_text(workbook):
        return _without_values(workbook, cells)
    formulas = formula_map(
        cells,
        tuple(workbook.sheet_names),
        tuple(workbook.structure.names),
        tuple(workbook.tables.values()),
    )
    everything = formulas.cells
    reached = formulas.downstream_of_cells(workbook.changed)
    reached |= formulas.graph.downstream_of_formulas(_over_shown_rows(workbook, formulas))
    affected = [everything[index] for index in sorted(reached)]
    # And those that we wrote, which nothing else makes us calculate.
    affected += [
        cell
        for index, cell in enumerate(everything)
        if index not in reached and workbook.changed.touch(cell.sheet, cell.home)
    ]
    if not affected:
        return CacheReport("not needed", formulas=len(everything))
    return _Refresh(workbook, formulas, affected).run()


def _most_text(workbook: WorkbookState) -> int:
    """How many characters of formulas are followed beside what else the workbook holds."""
    container = workbook.container
    return _MOST_TEXT - round(_TEXT_OF_MARK * (container.marks + 2 * container.other_marks))


def _text_of(cells: Sequence[FormulaCell]) -> int:
    """Length of all formulas."""
    return sum(len(cell.text) for cell in cells)


def _cost_of(cells: Sequence[FormulaCell]) -> int:
    """What it takes to calculate formulas, in characters."""
    return _text_of(cells) + _CALCULATED_AS * len(cells)


def _without_values(workbook: WorkbookState, cells: Sequence[FormulaCell]) -> CacheReport:
    """Remove the values of all formulas, where it would take too much to find out which of them are old."""
    removed = [_remove(workbook, cell, _places(workbook, cell)) for cell in cells]
    return CacheReport(
        "removed",
        len(cells),
        len(cells),
        0,
        len(cells),
        tuple(removed[:_MOST_NAMED]),
        f"The formulas of the workbook have more than {_most_text(workbook):,} characters, too many to follow here.",
    )


def lacks_values(workbook: WorkbookState) -> bool:
    """Whether some formula of a workbook has no stored value."""
    return any(
        True for sheet in _sheets_with_formulas(workbook) for _ in sheet.formulas_without_value()
    )


def _places(workbook: WorkbookState, cell: FormulaCell) -> Sequence[tuple[int, int]]:
    """Cells that show the result of a formula now."""
    home = (cell.rect.top, cell.rect.left)
    rect = workbook.sheet_part(cell.sheet).arrays.get(home)
    if rect is None:
        return [home]
    # Cells that are not in the file show nothing; a damaged file may state a range of any size.
    return list(workbook.sheet_part(cell.sheet).cells_in(rect))


def _remove(workbook: WorkbookState, cell: FormulaCell, places: Iterable[tuple[int, int]]) -> str:
    """Leave the cells of a formula without a value, and name the first."""
    sheet = workbook.sheet_part(cell.sheet)
    for row, column in places:
        if sheet.constant(row, column) is not None:
            sheet.set_cached(row, column, None)
            workbook.note_changed(cell.sheet, Rect(row, column, row, column))
    return f"{cell.sheet[:40]}!{cell_name(cell.rect.top, cell.rect.left)}"


def _over_shown_rows(workbook: WorkbookState, formulas: FormulaMap) -> list[int]:
    """Formulas that passed over rows which were hidden then, by their index."""
    if not workbook.shown_rows:
        return []
    return [
        index
        for index in _looking_at_hidden_rows(workbook, formulas.cells)
        if any(workbook.shown_rows.touch(*area) for area in formulas.areas[index] or ())
    ]


def _looking_at_hidden_rows(
    workbook: WorkbookState, cells: Sequence[FormulaCell]
) -> dict[int, bool]:
    """Formulas that may pass over hidden rows, by their index, and whether they do through a name."""
    names = _names_looking_at_hidden_rows(workbook)
    found = {}
    for index, cell in enumerate(cells):
        parsed = parse_formula(cell.text)
        by_name = any(name.casefold() in names for name in parsed.names)
        if by_name or not LOOKS_AT_HIDDEN_ROWS.isdisjoint(parsed.functions):
            found[index] = by_name
    return found


def _names_looking_at_hidden_rows(workbook: WorkbookState) -> set[str]:
    """Names for formulas that may pass over hidden rows, also through other names."""
    parsed = [(one.name.casefold(), parse_formula(one.text)) for one in workbook.structure.names]
    found = {name for name, one in parsed if not LOOKS_AT_HIDDEN_ROWS.isdisjoint(one.functions)}
    while more := {
        name
        for name, one in parsed
        if name not in found and any(inner.casefold() in found for inner in one.names)
    }:
        found |= more
    return found


def _has_formula(data: bytes) -> bool:
    # Looked for without pattern first, as sheets are long.
    return (b"<f" in data or b":f" in data) and _HAS_FORMULA.search(data) is not None


def _sheets_with_formulas(workbook: WorkbookState) -> Iterator[SheetPart]:
    for sheet in workbook.sheet_names:
        data = workbook.sheet_bytes(sheet)
        # The quick look spares parsing long sheets of numbers; a sheet already open may have gained formulas.
        if data and (workbook.is_loaded(sheet) or _has_formula(data)):
            yield workbook.sheet_part(sheet)


def _formula_cells(workbook: WorkbookState) -> Iterator[FormulaCell]:
    for sheet in _sheets_with_formulas(workbook):
        yield from _formulas_of(sheet)


def _formulas_of(sheet: SheetPart) -> Iterator[FormulaCell]:
    masters: dict[str, tuple[str, int, int]] = {}
    arrays = sheet.arrays
    for (row, column), cell in sheet.formulas.items():
        here = Rect(row, column, row, column)
        if isinstance(cell, TextFormula):
            yield FormulaCell(sheet.name, here, cell.text)
            continue
        formula = cell.find(_F)
        kind, text = formula.get("t"), formula.text or ""
        if kind == "shared":
            if text:
                masters[formula.get("si")] = (text, row, column)
            text, from_row, from_column = masters.get(formula.get("si"), ("", row, column))
            yield FormulaCell(sheet.name, here, text, (row - from_row, column - from_column))
        elif kind == "dataTable":
            rect = arrays.get((row, column), here)
            text = _read_by_data_table(formula, rect)
            yield FormulaCell(sheet.name, rect, text, is_data_table=True)
        elif cell.get("cm"):
            yield FormulaCell(sheet.name, spill_rect(here), text, spills=True)
        else:
            yield FormulaCell(sheet.name, arrays.get((row, column), here), text)


def _read_by_data_table(formula: Element, rect: Rect) -> str:
    """What a data table reads, as a formula: the cells that it varies, its axes and formulas above and left of it."""
    varied = [formula.get(name) for name in ("r1", "r2") if formula.get(name)]
    if not varied or rect.top == 1 or rect.left == 1:
        return ""
    around = Rect(rect.top - 1, rect.left - 1, rect.bottom, rect.right)
    return f"TABLE({','.join([str(around), *varied])})"


def _rich_values(workbook: WorkbookState) -> ChangedCells:
    """Cells that show rich values, in all sheets."""
    found = ChangedCells()
    for sheet in workbook.sheet_names:
        data = workbook.sheet_bytes(sheet)
        # Looked for without pattern first, as sheets are long.
        if b"vm=" in data and _HAS_RICH_VALUE.search(data):
            for row, column in workbook.sheet_part(sheet).rich_values:
                found.add(sheet, Rect(row, column, row, column))
    return found


class _Refresh:
    """One renewal of cached values: recalculate, judge, replace or remove."""

    def __init__(
        self,
        workbook: WorkbookState,
        formulas: FormulaMap,
        affected: Sequence[FormulaCell],
    ) -> None:
        self.workbook = workbook
        self.formulas = formulas
        self.everything = formulas.cells
        self.affected = affected
        self.reads = formulas.reads
        self.rich_values = _rich_values(workbook)
        self.left_out: Collection[str] = frozenset()
        # Whether the calculator takes its copy only with sheets written anew.
        self.sheets_anew = False
        # Formulas, by the id of their record, whose value came back as it was.
        self.as_before: set[int] = set()
        self.changed = 0
        self.removed: list[str] = []

    def run(self) -> CacheReport:
        given = self._given()
        if given is not None:
            for cell in self.affected:
                self._show(cell.place, given[cell.place])
            count = len(self.affected)
            return CacheReport("recalculated", len(self.everything), count, self.changed)
        recalculated, reason = self._recalculate()
        if recalculated is not None and (kept := self._with_values_to_keep(recalculated)):
            again = self._calculated(self._rows_read(), kept.union(self.left_out))[0]
            if again is not None:
                recalculated, self.left_out = again, kept.union(self.left_out)
        suspects = set(self.affected) if recalculated is None else self._suspects(recalculated)
        for cell in self.affected:
            if recalculated is None or cell in suspects:
                self.removed.append(_remove(self.workbook, cell, _places(self.workbook, cell)))
            elif id(cell) not in self.as_before:
                self._renew(cell, recalculated)
        if recalculated is not None:
            reason = "Some formulas cannot be recalculated reliably." if self.removed else ""
        return CacheReport(
            "removed" if recalculated is None else "recalculated",
            len(self.everything),
            len(self.affected),
            self.changed,
            len(self.removed),
            tuple(self.removed[:_MOST_NAMED]),
            reason,
        )

    def _rows_read(self) -> Mapping[str, int] | None:
        """The last row of each sheet that formulas read; None when some formula may read anything."""
        return None if None in self.formulas.areas else self.formulas.last_rows

    def _with_values_to_keep(self, recalculated: _Recalculated) -> set[str]:
        """Formulas with functions that the calculator does not know and values that no change has made old.

        Their values stay, and what reads them can be calculated from these.
        """
        affected = {cell.text for cell in self.affected}
        return {
            cell.text
            for cell in self.everything
            if cell.text not in affected
            and not parse_formula(cell.text).functions.isdisjoint(recalculated.unknown_functions)
            and all(
                self.workbook.sheet_part(cell.sheet).constant(*place) is not None
                for place in _places(self.workbook, cell)
            )
        }

    def _recalculate(self) -> tuple[_Recalculated | None, str]:
        """A recalculated copy of the whole, or else of the formulas of which is known what they read."""
        areas, known = self.formulas.areas, self.formulas.last_rows
        recalculated, reason = self._calculated(self._rows_read(), keep=True)
        if recalculated is not None:
            return recalculated, reason
        # Formulas that may read anything may be what it refuses; and it refuses circles, which spreadsheet programs leave
        # or calculate round by round. It is not given what would be beyond spreadsheet programs.
        circles = self.formulas.graph.in_circles()
        left_out = {self.everything[index].text for index in circles}
        left_out |= {cell.text for cell in self._over_hidden_rows()}
        left_out |= {
            cell.text
            for cell, area in zip(self.everything, areas, strict=True)
            if area is None
            or _is_beyond_programs(cell.text)
            or "LAMBDA" in parse_formula(cell.text).functions
        }
        if left_out:
            again = self._calculated(known, left_out)
            recalculated, reason = again[0], again[1] or reason
        if recalculated is None:
            refused = self._refused(known, left_out, reason)
            if refused:
                left_out |= refused
                again = self._calculated(known, left_out)
                recalculated, reason = again[0], again[1] or reason
        self.left_out = left_out
        return recalculated, reason

    def _given(self) -> Mapping[Place, Constant] | None:
        """What the calculator gives that an earlier workbook left; None without one, or where a whole file must tell."""
        calculator = None if self.rich_values else SHELF.take(self.formulas)
        if calculator is None:
            return None
        try:
            given = calculator.results(self.workbook)
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException:  # a panic of the Rust side is a BaseException; the calculator is gone
            return None
        SHELF.put(self.formulas, calculator)
        affected = set(self.affected)
        contradicted = given is not None and any(
            old is not None and not _alike(old, given[place], _SAME_RESULT)
            for cell in self.everything
            if cell not in affected
            for place in [cell.place]
            for old in [self.workbook.sheet_part(cell.sheet).constant(*place[1:])]
        )
        return None if contradicted else given

    def _calculated(
        self,
        read: Mapping[str, int] | None,
        left_out: Collection[str] = (),
        *,
        keep: bool = False,
    ) -> tuple[_Recalculated | None, str]:
        """A recalculated copy, or None and the reason; see `calculator_copy` for the arguments."""
        try:
            import formualizer
        except ImportError:
            return (
                None,
                "Formulas were not recalculated because the package formualizer is not installed.",
            )
        cells = self.everything
        if _cost_of(cells) > _most_text(self.workbook):
            return (
                None,
                f"The workbook has {len(cells):,} formulas, too many or too long to calculate here.",
            )
        if any(_is_beyond_programs(cell.text) for cell in cells if cell.text not in left_out):
            return None, "A formula is too long or nested too deeply for a spreadsheet program."
        fed, dropped = calculator_copy(
            self.workbook, self.formulas, read, left_out, anew=self.sheets_anew
        )
        package = io.BytesIO()
        # Not compressed, as it lives for milliseconds.
        self.workbook.container.write(package, fed, dropped, compress=False, slashes=True)
        try:
            result = formualizer.recalculate_xlsx_bytes(package.getvalue())
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException as problem:  # a panic of the Rust side is a BaseException
            if not self.sheets_anew and _OF_THE_FILE in str(problem):
                self.sheets_anew = True
                return self._calculated(read, left_out, keep=keep)
            return None, f"The formulas could not be recalculated ({in_short(problem)})."
        recalculated = _Recalculated(self.workbook, fed, result)
        if keep and not self.rich_values and SHELF.wants(self.formulas):
            SHELF.make(self.workbook, self.formulas, package.getvalue(), recalculated.constant)
        return recalculated, ""

    def _refused(self, read: Mapping[str, int], left_out: set[str], reason: str) -> set[str]:
        """Formulas that the calculator does not take, of which it refuses the whole workbook; found by halving them.

        Those that are not told from their neighbours in the tries allowed are among them.
        """
        texts = dict.fromkeys(cell.text for cell in self.everything)
        given = [text for text in texts if text not in left_out]
        tries = min(_MOST_TRIES, _MOST_TRIED // max(_cost_of(self.everything), 1))

        def refusal(of: Collection[str]) -> str | None:
            calculated, why = self._calculated(read, (texts.keys() - set(of)).union(left_out))
            return why if calculated is None else None

        if not given or not tries or refusal([]) is not None:
            return set()  # it is no formula that it refuses
        refused: set[str] = set()
        doubtful = [(given, reason)]
        while doubtful:
            group, reason = doubtful.pop()
            if len(group) == 1 or tries <= 0:
                refused.update(group)
                continue
            first, second = _parted(group, reason)
            tries -= 2
            why = refusal(first)
            if why is None:
                doubtful.append((second, reason))
                continue
            doubtful.append((first, why))
            if (why := refusal(second)) is not None:
                doubtful.append((second, why))
        return refused

    def _over_hidden_rows(self) -> Iterator[FormulaCell]:
        """Formulas that pass over rows which are hidden, which the calculator cannot."""
        known: dict[tuple[str, Rect], bool] = {}
        for index, by_name in _looking_at_hidden_rows(self.workbook, self.everything).items():
            cell = self.everything[index]
            if by_name:  # it refuses those names altogether
                yield cell
                continue
            for sheet, rect in self.reads(cell) or ():
                if (sheet, rect) not in known:
                    part = self.workbook.sheet_part(sheet)
                    known[sheet, rect] = bool(part.hidden_rows(rect.top, rect.bottom))
                if known[sheet, rect]:
                    yield cell
                    break

    def _suspects(self, recalculated: _Recalculated) -> set[FormulaCell]:
        """Formulas whose recalculated value is not to be trusted."""
        affected = set(self.affected)
        sources = [
            index
            for index, cell in enumerate(self.everything)
            if self._is_doubtful(cell, cell in affected, recalculated)
        ]
        if not sources:
            return set()
        reached = self.formulas.graph.downstream_of_formulas(sources)
        return {self.everything[index] for index in reached}

    def _is_doubtful(self, cell: FormulaCell, affected: bool, recalculated: _Recalculated) -> bool:
        if cell.is_data_table or not cell.text or cell.text in self.left_out:
            return affected  # calculated nowhere: the copy had its old value
        if not parse_formula(cell.text).functions.isdisjoint(recalculated.doubtful_functions):
            return True
        if affected and reads_other_workbook(cell.text):
            return True  # nor is this one
        if affected and self.rich_values and self._meets_rich_value(cell):
            return True  # the calculator sees an error there, spreadsheet programs do not
        sheet = self.workbook.sheet_part(cell.sheet)
        again = recalculated.sheet(cell.sheet)
        if again is sheet:
            self.as_before.add(id(cell))
            return False
        home = (cell.rect.top, cell.rect.left)
        if sheet.arrays.get(home) != again.arrays.get(home):
            return True
        same = True
        for row, column in _places(self.workbook, cell):
            old, new = sheet.constant(row, column), again.constant(row, column)
            if old == new:
                continue
            same = False
            if isinstance(new, ErrorValue) and new.code not in _HONEST_ERRORS:
                return True
            if not affected and old is not None and not _alike(old, new, _SAME_RESULT):
                return True
        if same:
            self.as_before.add(id(cell))
        return False

    def _meets_rich_value(self, cell: FormulaCell) -> bool:
        """Whether a formula reads or shows a rich value."""
        areas = self.reads(cell)
        shown = [(cell.sheet, Rect(*place, *place)) for place in _places(self.workbook, cell)]
        return areas is None or any(self.rich_values.touch(*area) for area in (*areas, *shown))

    def _renew(self, cell: FormulaCell, recalculated: _Recalculated) -> None:
        for place in _places(self.workbook, cell):
            self._show((cell.sheet, *place), recalculated.constant((cell.sheet, *place)))

    def _show(self, place: Place, new: Constant) -> None:
        """Let a cell show the new value of a formula."""
        name, row, column = place
        sheet = self.workbook.sheet_part(name)
        old = sheet.constant(row, column)
        if (old is None) != (new is None) or not _alike(old, new, _SAME_VALUE):
            sheet.set_cached(row, column, new)
            self.workbook.note_changed(name, Rect(row, column, row, column))
            self.changed += 1


class _Recalculated:
    """Values of a recalculated copy of the workbook.

    Parameters
    ----------
    workbook : WorkbookState
        The workbook.
    fed : dict of str to bytes
        Changed parts that went into the copy.
    result : dict
        What formualizer returned.
    """

    def __init__(
        self, workbook: WorkbookState, fed: dict[str, bytes], result: dict[str, Any]
    ) -> None:
        self._workbook = workbook
        self._fed = fed
        self._zip = zipfile.ZipFile(io.BytesIO(result["bytes"]))
        self._sheets: dict[str, SheetPart] = {}
        unknown = result["summary"].get("unknown_functions", ())
        names = {function["name"].upper() for function in unknown}
        bare_names = {name.rpartition(".")[2] for name in names}
        self.unknown_functions = names | bare_names
        self.doubtful_functions = self.unknown_functions | CHANGES_BY_ITSELF

    def sheet(self, name: str) -> SheetPart:
        """Recalculated sheet; the workbook's own when nothing came back differently."""
        if name not in self._sheets:
            own = self._workbook.sheet_part(name)
            data = self._zip.read(own.part)
            before = self._fed.get(own.part) or self._workbook.container.read(own.part)
            again = SheetPart(name, own.part, data, own.shared_strings) if data != before else own
            self._sheets[name] = again
        return self._sheets[name]

    def constant(self, place: Place) -> Constant:
        """What a cell shows."""
        sheet, row, column = place
        return self.sheet(sheet).constant(row, column)


def _parted(texts: Sequence[str], reason: str) -> tuple[list[str], list[str]]:
    """Two groups of formulas, those last that hold the reference which the calculator names as its reason."""
    named = _NAMED_REFERENCE.search(reason)
    holding = [text for text in texts if named and named[0] in text]
    if holding and len(holding) < len(texts):
        return [text for text in texts if text not in set(holding)], holding
    return list(texts[: len(texts) // 2]), list(texts[len(texts) // 2 :])


def _is_beyond_programs(text: str) -> bool:
    """Whether a formula is longer, or its parentheses are deeper, than any program takes."""
    if len(text) > MAX_FORMULA or text.count("(") <= MAX_DEPTH:
        return len(text) > MAX_FORMULA
    depth = deepest = 0
    for mark in _PARENTHESES.findall(text):
        depth += 1 if mark == "(" else -1
        deepest = max(deepest, depth)
    return deepest > MAX_DEPTH


def _alike(old: Constant, new: Constant, tolerance: float) -> bool:
    if isinstance(old, float) and isinstance(new, float):
        return math.isclose(old, new, rel_tol=tolerance, abs_tol=0.0)
    # A text without characters shows what no value shows; zero does not.
    return (None if old == "" else old) == (None if new == "" else new)
