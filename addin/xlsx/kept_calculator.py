"""A workbook that stays open in the calculator, for the next one with the same formulas.

To open a workbook costs the calculator some thirty times as much as to calculate it with other values, and workbooks of
one template have the same formulas. What is kept is tried before it is believed: with the values of the workbook from
which it was made, each formula must give exactly what it gave in a calculation of the whole file.
"""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from threading import Lock
from weakref import WeakSet

from addin.xlsx.calculator_copy import reads_other_workbook
from addin.xlsx.dependents import FormulaMap, Place
from addin.xlsx.formula_text import CHANGES_BY_ITSELF, LOOKS_AT_HIDDEN_ROWS, parse_formula
from addin.xlsx.references import Rect
from addin.xlsx.state import WorkbookState
from addin.xlsx.values import Constant

# Settings that decide what formulas give: the calendar, rounds of calculation, rounding to what is shown.
_SETTINGS = re.compile(rb"""\s(?:date1904|iterate\w*|fullPrecision)\s*=\s*["'][^"']*["']""")
_TRIAL = "Trial"
# What the calculator gives and takes just as it is; the rest is left to calculations of the whole file.
_RESULTS = frozenset([float, str, bool])
_VALUES = _RESULTS | {type(None)}
# Each takes some 6 MB. Formulas that read entire columns would have it look through too many cells.
_MOST_KEPT = 4
_MOST_CELLS_READ = 50_000


class KeptCalculator:
    """A workbook in the calculator.

    Parameters
    ----------
    workbook : WorkbookState
        The workbook, with the values that the package has.
    formulas : FormulaMap
        Its formulas.
    package : bytes
        The file that the calculator was given.
    shown : callable
        What a cell shows after a calculation of that file.

    Raises
    ------
    ValueError
        When it does not give what that calculation gave.
    """

    def __init__(
        self,
        workbook: WorkbookState,
        formulas: FormulaMap,
        package: bytes,
        shown: Callable[[Place], Constant],
    ) -> None:
        import formualizer

        self._homes = [cell.place for cell in formulas.cells]
        self._settings = _settings(workbook)
        self._values: dict[tuple[str, Rect], list[Constant]] = {
            run: [] for run in _runs(formulas, set(self._homes))
        }
        alone = formualizer.EvaluationConfig()
        alone.enable_parallel = False  # a process that is forked from this one lacks its threads
        self._calculator = formualizer.Workbook.from_bytes(
            package, config=formualizer.WorkbookConfig(eval_config=alone)
        )
        # Cells given before the first calculation cost it a time that grows with the square of the formulas.
        self._calculator.evaluate_all()
        results = self.results(workbook)
        if results is None or any(
            _differ([result], [shown(home)]) for home, result in results.items()
        ):
            raise ValueError("a kept calculator does not give what one of the whole file gave")

    def results(self, workbook: WorkbookState) -> Mapping[Place, Constant] | None:
        """What each formula gives with the values of a workbook; None where that is not certain.

        Parameters
        ----------
        workbook : WorkbookState
            A workbook with the same formulas.
        """
        if _settings(workbook) != self._settings:
            return None
        for (sheet, rect), before in self._values.items():
            values = workbook.sheet_part(sheet).constants(rect)
            if not _VALUES.issuperset(map(type, values)):
                return None
            if _differ(before, values):
                self._calculator.set_values_batch(sheet, rect.top, rect.left, [[v] for v in values])
                before[:] = values
        self._calculator.evaluate_all()
        results = {home: self._calculator.get_value(*home) for home in self._homes}
        return results if _RESULTS.issuperset(map(type, results.values())) else None


def _differ(one: list[Constant], other: list[Constant]) -> bool:
    """Whether any value is another one, to the sign of a zero."""
    return one != other or list(map(repr, one)) != list(map(repr, other))


def _settings(workbook: WorkbookState) -> list[bytes]:
    return _SETTINGS.findall(workbook.container.read(workbook.structure.part))


def _runs(formulas: FormulaMap, homes: set[Place]) -> Iterator[tuple[str, Rect]]:
    """Cells without formula that formulas read, in pieces of columns."""
    cells = {
        (sheet, column, row)
        for sheet, rect in formulas.known_areas
        for column in range(rect.left, rect.right + 1)
        for row in range(rect.top, rect.bottom + 1)
        if (sheet, row, column) not in homes
    }
    for sheet, column, row in sorted(cells):
        if (sheet, column, row - 1) not in cells:
            top = row
        if (sheet, column, row + 1) not in cells:
            yield sheet, Rect(top, column, row, column)


def _can_be_kept(workbook: WorkbookState, formulas: FormulaMap) -> bool:
    """Whether each formula shows one value in one cell, which follows from values that it is known to read."""
    return (
        None not in formulas.areas
        and sum(rect.height * rect.width for _, rect in formulas.known_areas) <= _MOST_CELLS_READ
        and all(
            cell.rect.is_single
            and not cell.is_data_table
            and cell.shift == (0, 0)
            and not reads_other_workbook(cell.text)
            and "_xl"
            not in cell.text  # functions of newer programs, known under another name or not
            for cell in formulas.cells
        )
        and _are_known(_functions(workbook, formulas))
    )


def _functions(workbook: WorkbookState, formulas: FormulaMap) -> frozenset[str]:
    """All functions of formulas and of names, also those that no calculation has come to."""
    texts = {cell.text for cell in formulas.cells} | {n.text for n in workbook.structure.names}
    return frozenset[str]().union(*(parse_formula(text).functions for text in texts))


def _are_known(functions: frozenset[str]) -> bool:
    """Whether the calculator knows all functions, and none gives another value at another time."""
    import formualizer

    trial = formualizer.Workbook()
    trial.add_sheet(_TRIAL)
    for row, function in enumerate(functions, 1):
        trial.set_formula(_TRIAL, row, 1, f"={function}()")
    trial.evaluate_all()
    given = [trial.get_value(_TRIAL, row, 1) for row in range(1, len(functions) + 1)]
    unknown = any(isinstance(one, dict) and one.get("kind") == "Name" for one in given)
    return not unknown and functions.isdisjoint(CHANGES_BY_ITSELF | LOOKS_AT_HIDDEN_ROWS)


class Shelf:
    """The calculators that are kept, each for one map of formulas and used by one workbook at a time."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: OrderedDict[FormulaMap, KeptCalculator] = OrderedDict()
        self._seen: WeakSet[FormulaMap] = WeakSet()
        self._refused: WeakSet[FormulaMap] = WeakSet()

    def take(self, formulas: FormulaMap) -> KeptCalculator | None:
        """The calculator for these formulas, if it is there."""
        with self._lock:
            return self._kept.pop(formulas, None)

    def put(self, formulas: FormulaMap, calculator: KeptCalculator) -> None:
        """Keep a calculator; the one that was longest without use goes."""
        with self._lock:
            self._kept[formulas] = calculator
            while len(self._kept) > _MOST_KEPT:
                self._kept.popitem(last=False)

    def wants(self, formulas: FormulaMap) -> bool:
        """Whether a calculator is worth making: the formulas come again, none is kept for them, and it can be made."""
        with self._lock:
            is_first = formulas not in self._seen
            self._seen.add(formulas)
            return not is_first and formulas not in self._refused and formulas not in self._kept

    def make(
        self,
        workbook: WorkbookState,
        formulas: FormulaMap,
        package: bytes,
        shown: Callable[[Place], Constant],
    ) -> None:
        """Make a calculator and keep it; what cannot be kept is not tried again."""
        try:
            if _can_be_kept(workbook, formulas):
                self.put(formulas, KeptCalculator(workbook, formulas, package, shown))
                return
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException:  # noqa: S110  a panic of the Rust side is a BaseException
            pass
        with self._lock:
            self._refused.add(formulas)


SHELF = Shelf()
