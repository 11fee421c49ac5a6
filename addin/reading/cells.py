"""One cell of a workbook → a number, words, nothing, or `CellFault` with what is wrong with it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from addin.contract.problems import as_seen, shortened
from addin.contract.tables import Field
from addin.contract.units import UnitError, parse_unit
from addin.xlsx import ErrorValue

Constant = None | bool | int | float | str | ErrorValue


@dataclass(frozen=True)
class Cell:
    """What a cell shows."""

    value: Constant  #: Its value; of a formula the value of the last calculation. [as typed]
    is_formula: bool = False  #: Whether a formula stands in it.
    number_format: str = "General"  #: Format code, such as ``0.00`` or ``dd/mm/yyyy``.

    @property
    def is_blank(self) -> bool:
        """Whether it holds nothing, or a formula that shows nothing."""
        blank_text = isinstance(self.value, str) and not as_seen(self.value)
        return blank_text or (self.value is None and not self.is_formula)


class CellFault(Exception):
    """A cell that cannot be taken as it is.

    Parameters
    ----------
    found : str or None
        What it shows. [as shown]
    allowed : str
        What would be accepted. [words]
    message : str
        What is wrong and what to do. [sentence]
    """

    def __init__(self, found: str | None, allowed: str, message: str) -> None:
        super().__init__(message)
        self.found, self.allowed, self.message = found, allowed, message


_NUMBER = "a number"


def read_number(cell: Cell, spec: Field, unit_place: str) -> float | None:
    """The number in a cell.

    Parameters
    ----------
    cell : Cell
        Not merged away. [cell]
    spec : Field
        Its field. [field]
    unit_place : str
        Where its unit belongs, in words. [words]

    Returns
    -------
    float or None
        None for a blank. [shown unit]

    Raises
    ------
    CellFault
        If it is none.
    """
    value = _plain(cell, _NUMBER, lambda shown: f"found {shown}; type a number.")
    if value is None:
        return None
    if isinstance(value, str):
        raise _text_fault(value, spec, unit_place)
    if not math.isfinite(value):
        raise CellFault(str(value), "a finite number", f"found {value}; type a finite number.")
    if is_date_format(cell.number_format):
        raise _date_fault(value, _NUMBER, "Number")
    return float(value)


def read_text(cell: Cell, spec: Field) -> str | None:
    """The words in a cell; a number stands for its digits.

    Returns
    -------
    str or None
        None for a blank. [text]

    Raises
    ------
    CellFault
        If it holds none.
    """
    allowed = "one of " + ", ".join(spec.choices) if spec.choices else "text"
    value = _plain(
        cell, allowed, lambda shown: f"found {shown}; it must be {allowed}. Type it as text."
    )
    if isinstance(value, float) and is_date_format(cell.number_format):
        raise _date_fault(value, allowed, "Text")
    return f"{value:.15g}" if isinstance(value, (int, float)) else value


def read_unit(cell: Cell) -> str:
    """The unit in a cell; the number 1 is a unit too.

    A unit that cannot be read does not count as blank: per cent would be read as a ratio.

    Returns
    -------
    str
        Empty for a blank. [text]

    Raises
    ------
    CellFault
        If it cannot be told.
    """
    value = _plain(cell, "a unit", lambda shown: f"found {shown}; type a unit.")
    return f"{value:.15g}" if isinstance(value, (int, float)) else (value or "").strip()


def _plain(cell: Cell, allowed: str, sentence: Callable[[str], str]) -> int | float | str | None:
    """The number or text of a cell, None for a blank; `sentence` is said of a truth value.

    Raises
    ------
    CellFault
        Of an error value, a formula nobody has calculated, and a truth value.
    """
    value = cell.value
    if cell.is_blank:
        return None
    if isinstance(value, bool):
        shown = "TRUE" if value else "FALSE"
        raise CellFault(shown, allowed, sentence(shown))
    if isinstance(value, ErrorValue) or (isinstance(value, str) and re.match(r"#[A-Z/0]", value)):
        code = value.code if isinstance(value, ErrorValue) else shortened(value)
        if cell.is_formula:
            action = "Correct the formula or the cells it reads"
        else:
            action = "Type the value, or leave the cell blank"
        raise CellFault(code, "a value", f"found the error {code}. {action}.")
    if value is None:
        raise CellFault(
            "a formula without value",
            "a calculated value",
            "the formula has no stored value. Open the workbook in Excel or LibreOffice, let it "
            "calculate, and save it.",
        )
    return value


def _date_fault(value: float, allowed: str, number_format: str) -> CellFault:
    """Of a date or time, which Excel may have made of something else."""
    return CellFault(
        f"a date or time ({value:.10g})",
        allowed,
        f"the cell is formatted as a date or time; Excel stores {value:.10g}. Excel converts entries such as 1-2 or "
        f"3/4 to dates: format the cell as {number_format} and type it again.",
    )


# --- text where a number belongs ------------------------------------------------------------------

_DIGITS = re.compile(r"[+\-−]?(\d+\.?\d*|\.\d+)([eE][+\-−]?\d+)?")
_COMMA = re.compile(r"[+\-−]?\d+,\d+([eE][+\-−]?\d+)?")
_GROUPED = re.compile(r"[+\-−]?\d{1,3}([ .,'’]\d{3})+([.,]\d*)?")
_WITH_UNIT = re.compile(r"([+\-−]?(?:\d[\d.,]*|\.\d+)(?:[eE][+\-−]?\d+)?)\s*([A-Za-z%°µ\"'].*)")


def number_in_text(text: str) -> str:
    """Why a text is not the number it looks like, where no unit belongs.

    Returns
    -------
    str
        What is wrong and what to do; empty if it does not look like a number. [sentence]
    """
    text = shortened(text)
    why = _why_no_number(as_seen(text), "")
    return f"found '{text}', which {why}" if why else ""


def _text_fault(text: str, spec: Field, unit_place: str) -> CellFault:
    """Why a text is not the number it may look like."""
    text = shortened(text)
    why = _why_no_number(as_seen(text), unit_place if spec.has_unit else "", spec.dimension)
    words = f" or {' or '.join(spec.choices)}," if spec.choices else ""
    why = why or f"is not a number. Type a number{words} or leave the cell blank."
    return CellFault(text, _NUMBER, f"found '{text}', which {why}")


def _why_no_number(trimmed: str, unit_place: str, dimension: str = "") -> str:
    """What is wrong with a text that looks like a number; `unit_place` where it may have a unit of a dimension."""
    if _DIGITS.fullmatch(trimmed):
        return (
            "looks like a number but is text. Type it again, or use Data > Text to Columns; "
            "remove a leading apostrophe, and spaces, which may be without width."
        )
    if _GROUPED.fullmatch(trimmed):
        return (
            "is text, with a thousands separator or a decimal comma. Type it again without thousands "
            "separators, with the decimal separator of your Excel."
        )
    if _COMMA.fullmatch(trimmed):
        return (
            "has a decimal comma and is text. Type it again with the decimal separator of your "
            f"Excel ({trimmed.replace(',', '.')} here)."
        )
    with_unit = _WITH_UNIT.fullmatch(trimmed)
    if with_unit is None:
        return ""
    number, unit = with_unit.groups()
    if unit_place:
        try:
            parse_unit(unit, dimension)
        except UnitError as error:
            return f"has a unit that does not fit: {error.message}"
        return (
            f"contains its unit. Leave only the number {number} and put the unit {unit} "
            f"{unit_place}."
        )
    return f"is not a plain number. Type {number}."


# --- number formats -------------------------------------------------------------------------------

_BUILT_IN_DATES = frozenset([*range(14, 23), *range(27, 37), *range(45, 48), *range(50, 59)])
_LITERAL = re.compile(r'"[^"]*"|\\.|_.|\*.|\[(?!h+\]|m+\]|s+\])[^\]]*\]', re.IGNORECASE)


def is_date_format(code: str) -> bool:
    """Whether a number format shows a date or a time."""
    bare = _LITERAL.sub("", code).split(";")[0]
    return bare.casefold() != "general" and bool(re.search("[dmyhs]", bare, re.IGNORECASE))


def is_percent_format(code: str) -> bool:
    """Whether a number format shows a hundred times the value and a percent sign."""
    return "%" in _LITERAL.sub("", code)


def built_in_format(number: int) -> str:
    """A code that stands for a built-in number format: date, percent, or any other."""
    if number in _BUILT_IN_DATES:
        return "yyyy-mm-dd"
    return "0%" if number in (9, 10) else "General"
