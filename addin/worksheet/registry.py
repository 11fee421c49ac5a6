"""What a worksheet function is: name, arguments, help; cells in, rows of cells out."""

from __future__ import annotations

import datetime as dt
import json
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.field import IncompleteRecord
from addin.contract.problems import shortened
from addin.reading.cells import number_in_text
from addin.xlsx.values import ERROR_CODES, ErrorValue

#: Category in the function wizard of a spreadsheet program.
CATEGORY = "torsionbook"
#: Kinds of argument.
KINDS = ("block", "model", "number", "numbers", "text", "flag", "count")
#: Most cells one argument may hold: a whole column by mistake is refused in time.
MOST_CELLS = 250_000
#: Half of a character, which no file and no digest can hold.
_HALF = re.compile("[\ud800-\udfff]")
#: Longest text a cell holds.
LONGEST_TEXT = 32_000

Value = None | bool | float | str


Cell = Value | ErrorValue
Block = list[list[Cell]]


class FunctionError(Exception):
    """Why a function has no answer, told to the user.

    Parameters
    ----------
    message : str
        What is wrong and what to do. [sentence]
    code : str
        What a cell shows that can only show codes. [code]
    """

    def __init__(self, message: str, code: str = "#VALUE!") -> None:
        super().__init__(message)
        self.message = message
        self.code = code


class ModelForgotten(FunctionError):
    """A handle whose model is not in memory: a front that knows what made it sends that again."""


@dataclass(frozen=True)
class Argument:
    """One argument of a function."""

    name: str  #: As the wizard shows it.
    #: One of `KINDS`: a range with headers, a handle of `TV_MODEL`, one number, a range of
    #: numbers, a text, TRUE or FALSE, a whole number.
    kind: str
    help: str  #: What to give, so that it reads well after "give".
    optional: bool = False  #: Whether it may be left out or blank: the function then gets None.
    blank: bool = False  #: Whether the cell given may be blank although others follow.
    least: int = 1  #: Smallest whole number it may be.

    def __post_init__(self) -> None:
        assert self.kind in KINDS, self.kind


@dataclass(frozen=True)
class Function:
    """One worksheet function."""

    name: str  #: In capitals, as in the contract.
    help: str  #: First sentence of its documentation.
    arguments: tuple[Argument, ...]  #: In order; the optional ones last.
    #: Takes the values of the arguments, gives a value or rows. [SI inside, shown units outside]
    answer: Callable[..., Any]
    scalar: bool = False  #: Whether the answer is one cell.
    #: Whether its arguments may be ranges, which have one answer a cell.
    by_cell: bool = False
    long: bool = False  #: Whether it may have to calculate a start.
    example: str = ""  #: A formula.
    #: Columns of its table, 0 where they depend on the model; None for an answer that is no table. A
    #: table takes `ROW_COUNT` as its last argument, which `answer` does not see.
    columns: int | None = None


#: Last argument of every table: an array formula of fixed size shows #N/A where the answer ends.
ROW_COUNT = Argument(
    "Row count",
    "count",
    "Number of rows of the result, including header: unused rows are blank, and the last row "
    "counts rows that do not fit. For array formulas of fixed size.",
    True,
)


#: Every function by name, in the order of the contract.
FUNCTIONS: dict[str, Function] = {}


def registered(
    name: str,
    *arguments: Argument,
    scalar: bool = False,
    by_cell: bool = False,
    long: bool = False,
    example: str = "",
    columns: int | None = None,
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Enter a function into the registry."""

    def enter(answer: Callable[..., Any]) -> Callable[..., Any]:
        optional = [a.optional for a in arguments]
        assert optional == sorted(optional), f"{name}: optional arguments come last"
        text = " ".join((answer.__doc__ or "").split("\n\n")[0].split())
        assert text, f"{name} has no documentation"
        if name in FUNCTIONS:
            raise IncompleteRecord(
                f"two functions are called {name}, {FUNCTIONS[name].answer.__name__} and "
                f"{answer.__name__}: rename one in addin/worksheet/functions"
            )
        all_arguments = arguments if columns is None else (*arguments, ROW_COUNT)
        FUNCTIONS[name] = Function(
            name, text, all_arguments, answer, scalar, by_cell, long, example, columns
        )
        return answer

    return enter


# --- cells in -------------------------------------------------------------------------------------


def rows_of(raw: Any) -> Block:
    """Whatever a front hands over, as rows of cells.

    Blanks are None, whatever the front takes for one (None, an empty text, NaN); numbers are
    doubles; error values stay errors.

    Parameters
    ----------
    raw : object
        One value, a list (one row) or a list of rows; of the Office.js host also objects of type
        ``Error``, ``Double``, ``String``, ``Boolean`` and ``Empty``. [as typed]

    Returns
    -------
    list of list
        All rows equally long.
    """
    rows = raw if isinstance(raw, (list, tuple)) else [[raw]]
    if not rows or not isinstance(rows[0], (list, tuple)):
        rows = [rows]
    # the widest row counts, since all are filled up to it
    width = max((len(row) if isinstance(row, (list, tuple)) else 1 for row in rows), default=0)
    if len(rows) * width > MOST_CELLS:
        raise FunctionError(
            f"found more than {MOST_CELLS:,} cells. Select the table, not whole columns."
        )
    found = [
        [_cell(value) for value in (row if isinstance(row, (list, tuple)) else [row])]
        for row in rows
    ]
    return [row + [None] * (width - len(row)) for row in found]


def _cell(value: Any) -> Cell:
    """One cell as handed over."""
    if isinstance(value, dict):
        kind = value.get("type")
        if not isinstance(kind, str) or not ("basicValue" in value or kind == "Empty"):
            shown = _object_shown(value)
            raise FunctionError(
                f"found the object {shown}; a cell is a number, a text, true or false, or null "
                "for a blank."
            )
        if kind == "Error":
            code = value.get("basicValue")
            return _error(code if isinstance(code, str) else "")
        value = value.get("basicValue")
    if isinstance(value, (list, tuple, dict)):
        raise FunctionError(
            "found a list or an object inside a row; a cell is a number, a text, true or false, or "
            "null for a blank."
        )
    if value is None or isinstance(value, ErrorValue):
        return value
    if isinstance(value, bool):
        return value
    if isinstance(value, (dt.datetime, dt.date, dt.time)):
        return f"date {value.isoformat()}"
    if isinstance(value, str):
        text = value.strip()
        if _HALF.search(text):
            raise FunctionError(
                f"found the text {shortened(ascii(text))}, which contains an invalid character (a "
                "lone surrogate). Type it again."
            )
        if text in ERROR_CODES:
            return ErrorValue(text)
        return text[:LONGEST_TEXT] or None
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        return str(value)[:LONGEST_TEXT]
    return None if math.isnan(number) else number


def _object_shown(value: dict[Any, Any]) -> str:
    try:
        return shortened(json.dumps(value, default=str))
    except (RecursionError, ValueError):
        return "{...}"


def _error(code: str) -> ErrorValue:
    """An error value; one that is not known shows as the commonest."""
    return ErrorValue(code if code in ERROR_CODES else "#VALUE!")


def _cells_of(argument: Argument, raw: Any) -> Block:
    try:
        return rows_of(raw)
    except FunctionError as wrong:
        raise FunctionError(f"{argument.name}: {wrong.message}", wrong.code) from None


def _bound(argument: Argument, raw: Any) -> Any:
    """The value of one argument."""
    rows = _cells_of(argument, raw)
    if argument.kind == "block":
        filled = any(cell is not None for row in rows for cell in row)
        if filled:
            return rows
        return _absent(argument)
    if argument.kind == "numbers":
        return [[_number(argument, c, i, j) for j, c in enumerate(r)] for i, r in enumerate(rows)]
    if sum(len(row) for row in rows) != 1:
        raise FunctionError(f"{argument.name}: give one cell, not a range: {_within(argument)}")
    cell = rows[0][0]
    if cell is None:
        return _absent(argument)
    if isinstance(cell, ErrorValue):
        raise FunctionError(f"{argument.name}: the cell shows {cell.code}. Correct it.", cell.code)
    if argument.kind in ("model", "text"):
        if isinstance(cell, bool):
            raise _unfit(argument, "TRUE" if cell else "FALSE", "a text")
        return cell if isinstance(cell, str) else f"{cell:.15g}"
    if argument.kind == "flag":
        return _flag(argument, cell)
    number = _number(argument, cell, 0, 0)
    if argument.kind == "count":
        if number is None or number < argument.least or number != math.floor(number):
            raise _unfit(argument, cell, f"a whole number, {argument.least} or more")
        return int(number)
    return number


def _absent(argument: Argument) -> None:
    if not (argument.optional or argument.blank):
        raise FunctionError(f"{argument.name} is blank. Give {_within(argument)}")


def _within(argument: Argument) -> str:
    """The help of an argument as the end of a sentence; SI, FALSE and the like stay as they are."""
    first, rest = argument.help[0], argument.help[1:]
    return argument.help if rest[:1].isupper() else first.lower() + rest


def _number(argument: Argument, cell: Cell, row: int, column: int) -> float | None:
    """A number of a range; None for a blank, which never becomes zero."""
    where = "" if row == column == 0 else f", row {row + 1}, column {column + 1}"
    if cell is None:
        return None
    if isinstance(cell, ErrorValue):
        raise FunctionError(
            f"{argument.name}{where}: the cell shows {cell.code}. Correct it.", cell.code
        )
    if isinstance(cell, float) and math.isfinite(cell):
        return cell
    if isinstance(cell, str) and (why := number_in_text(cell)):
        raise FunctionError(f"{argument.name}{where}: {why}")
    shown = {True: "TRUE", False: "FALSE"}.get(cell, cell) if isinstance(cell, bool) else cell
    raise _unfit(argument, shown, "a number", where)


def _flag(argument: Argument, cell: Value) -> bool:
    if isinstance(cell, bool):
        return cell
    if cell in (0.0, 1.0):
        return bool(cell)
    word = str(cell).casefold()
    if word in ("true", "yes", "false", "no"):
        return word in ("true", "yes")
    raise _unfit(argument, cell, "TRUE or FALSE")


def _unfit(argument: Argument, found: object, wanted: str, where: str = "") -> FunctionError:
    shown = f"{found:.10g}" if isinstance(found, float) else str(found)[:60]
    return FunctionError(
        f"{argument.name}{where}: found '{shown}'; give {wanted}: {_within(argument)}"
    )


# --- one call -------------------------------------------------------------------------------------


def call(name: str, raw: Sequence[Any]) -> list[list[Value]]:
    """Call a function with what a front hands over.

    Parameters
    ----------
    name : str
        Name of the function. [name]
    raw : sequence
        Its arguments, missing ones at the end left out or None. [as typed]

    Returns
    -------
    list of list
        Rows of cells: doubles, texts, flags, None for a blank. [shown units]

    Raises
    ------
    FunctionError
        With the sentence for the user.
    """
    function = FUNCTIONS.get(name.upper())
    if function is None:
        raise FunctionError(f"Unknown function {name[:60]}.", "#NAME?")
    if len(raw) > len(function.arguments):
        raise FunctionError(
            f"{function.name} takes at most {len(function.arguments)} arguments, not {len(raw)}."
        )
    given = list(raw) + [None] * (len(function.arguments) - len(raw))
    if function.by_cell:
        return _cell_by_cell(function, given)
    values = [_bound(a, v) for a, v in zip(function.arguments, given, strict=True)]
    if function.columns is None:
        return _shown(function.answer(*values))
    *values, count = values
    if count is None:
        return _shown(function.answer(*values))
    return _fixed(function, values, count)


def _cell_by_cell(function: Function, given: Sequence[Any]) -> list[list[Value]]:
    """One answer for each cell of the ranges; a single cell, row or column counts for all, as in a formula."""
    blocks = [_cells_of(a, raw) for a, raw in zip(function.arguments, given, strict=True)]
    height, width = max(len(rows) for rows in blocks), max(len(rows[0]) for rows in blocks)
    for argument, rows in zip(function.arguments, blocks, strict=True):
        if len(rows) not in (1, height) or len(rows[0]) not in (1, width):
            raise FunctionError(
                f"{argument.name}: found a range of {len(rows)} × {len(rows[0])} cells beside one of {height} × {width}. "
                "Give ranges of one size, or one cell for all."
            )
    ranges = [rows for rows in blocks if len(rows) * len(rows[0]) > 1]

    def at(rows: Block, i: int, j: int) -> Cell:
        return rows[i % len(rows)][j % len(rows[0])]

    def answer(i: int, j: int) -> Value:
        if ranges and all(at(rows, i, j) is None for rows in ranges):
            return None  # a blank row of a table
        try:
            cells = zip(function.arguments, (at(rows, i, j) for rows in blocks), strict=True)
            return _plain(function.answer(*(_bound(argument, cell) for argument, cell in cells)))
        except FunctionError as wrong:
            where = f"Row {i + 1}, column {j + 1} of the ranges: " if ranges else ""
            raise FunctionError(where + wrong.message, wrong.code) from None

    return [[answer(i, j) for j in range(width)] for i in range(height)]


def _fixed(function: Function, values: Sequence[Any], count: int) -> list[list[Value]]:
    """The table in as many rows as asked for; that it has none is said in its first cell."""
    most = MOST_CELLS // max(function.columns or 1, 1)
    if count > most:
        raise FunctionError(f"{ROW_COUNT.name}: found {count}; give at most {most}.", "#NUM!")
    try:
        rows = _shown(function.answer(*values))
    except FunctionError as none:
        if isinstance(none, ModelForgotten) or none.code != "#N/A" or not function.columns:
            raise
        rows = [[none.message] + [None] * (function.columns - 1)]
    width = len(rows[0])
    left_out = len(rows) - count
    if left_out > 0:
        rows = [*rows[: count - 1], [f"{left_out + 1} more rows"] + [None] * (width - 1)]
    return rows + [[None] * width] * (count - len(rows))


def _shown(answer: Any) -> list[list[Value]]:
    """Rows of plain cells."""
    rows = answer if isinstance(answer, list) else [[answer]]
    if not rows:
        return [[None]]
    return [[_plain(value) for value in row] for row in rows]


def _plain(value: Any) -> Value:
    if isinstance(value, str):
        return str(value)  # a word of the contract is a StrEnum; a cell holds its text
    if value is None or isinstance(value, bool):
        return value
    number = float(value)
    if not math.isfinite(number):
        raise FunctionError("The result is too large for a number. Check the units.", "#NUM!")
    return number
