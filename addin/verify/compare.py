"""One value that stands in a file against the one that follows from the inputs."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TypeGuard

from addin.contract.problems import shortened
from addin.verify.findings import Agreement
from addin.xlsx import ErrorValue
from addin.xlsx.number_text import section_of

#: Relative difference that other processors and other programs' saving make. [1]
ROUNDING = 1e-9

Value = None | bool | int | float | str | ErrorValue


@dataclass(frozen=True)
class RecordedValue:
    """What stands in a cell, or under a key."""

    value: Value  #: Its value; of a formula the one it shows. [as shown]
    place: str = ""  #: Cell, or path. [A1]
    formula: str = ""  #: Text of a formula in it; empty without one.
    number_format: str = ""  #: How it is shown; empty = with all digits.


def plain_value(value: Value) -> None | bool | int | float | str:
    """A value, an error by its code."""
    return value.code if isinstance(value, ErrorValue) else value


def value_in_words(value: Value) -> str:
    """A value as a sentence shows it."""
    if value is None or value == "":
        return "nothing"
    if isinstance(value, float):
        return f"{value:.9g}"
    return shortened(str(plain_value(value)), 90)


def agreement(found: RecordedValue, expected: Value, allowed: float | None = None) -> Agreement:
    """How well a value agrees with the expected one.

    Parameters
    ----------
    found : RecordedValue
        What stands there. [shown unit]
    expected : number or text
        What would be written. [shown unit]
    allowed : float, optional
        The reported error of the expected number. [shown unit]

    Returns
    -------
    Agreement
        The best that holds.
    """
    value = found.value
    if is_number(value) and is_number(expected):
        return _numbers(float(value), float(expected), found.number_format, allowed)
    if _is_same(value, expected):
        return Agreement.BITS
    if isinstance(value, str) and isinstance(expected, str):
        return _words(value, expected, allowed)
    return Agreement.DIFFERENT


def is_rounding(found: Value, expected: Value, scale: float = 0.0) -> bool:
    """Whether two values differ by rounding at most, as no hand does it.

    Parameters
    ----------
    found, expected : number or text
        The two. [shown unit]
    scale : float
        Size of the numbers they are a small difference of. [shown unit]

    Returns
    -------
    bool
    """
    if is_number(found) and is_number(expected):
        smallest = max(ROUNDING * scale, 1e-300)
        return math.isclose(found, expected, rel_tol=ROUNDING, abs_tol=smallest)
    return _is_same(found, expected)


def _is_same(one: Value, other: Value) -> bool:
    """Whether two values are one; a blank is nothing or a text without letters, never a zero."""
    if one in (None, "") or other in (None, ""):
        return one in (None, "") and other in (None, "")
    return one == other and isinstance(one, bool) == isinstance(other, bool)


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a number; a flag is none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _numbers(found: float, expected: float, code: str, allowed: float | None) -> Agreement:
    if found == expected:
        return Agreement.BITS
    apart = abs(found - expected)
    if apart <= ROUNDING * abs(expected) or (code and apart <= 0.5 * shown_step(expected, code)):
        return Agreement.DIGITS
    if allowed is not None and apart <= allowed:
        return Agreement.ERROR
    return Agreement.DIFFERENT


_NUMBER_IN_WORDS = re.compile(r"\d[\d,]*\.?\d*(?:[eE][+-]?\d+)?")


def _words(found: str, expected: str, allowed: float | None) -> Agreement:
    """Sentences with numbers in them agree as well as their numbers do."""
    if _NUMBER_IN_WORDS.sub("#", found) != _NUMBER_IN_WORDS.sub("#", expected) or not allowed:
        return Agreement.DIFFERENT
    pairs = zip(_NUMBER_IN_WORDS.findall(found), _NUMBER_IN_WORDS.findall(expected), strict=True)
    for one, other in pairs:
        a, b = float(one.replace(",", "")), float(other.replace(",", ""))
        if abs(a - b) > allowed * abs(b) + 1.001 * _last_digit(other):
            return Agreement.DIFFERENT
    return Agreement.ERROR


def _last_digit(text: str) -> float:
    """Worth of the last digit of a number as written; of a whole number none is spare."""
    mantissa, _, power = text.lower().partition("e")
    _, point, decimals = mantissa.partition(".")
    return 10.0 ** (int(power or 0) - len(decimals)) if point or power else 0.0


# --- number formats -------------------------------------------------------------------------------

_BRACKETS = re.compile(r"\[[^\]]*\]|\"[^\"]*\"|\\.|_.|\*.")
_GENERAL_DIGITS = 10


def shown_step(value: float, code: str) -> float:
    """Worth of the last digit that a number format shows of a number.

    Parameters
    ----------
    value : float
        The number. [shown unit]
    code : str
        Excel number format. [code]

    Returns
    -------
    float
        Worth of one step of the last digit shown; 0 where the format shows none. [shown unit]
    """
    section = section_of(value, code)
    bare = _BRACKETS.sub("", section)
    if not section or "general" in section.casefold() or "@" in bare:
        return _power_of_ten(value) * 10.0 ** (1 - _GENERAL_DIGITS) if value else 0.0
    mantissa, exponent, _ = bare.upper().partition("E")
    decimals = len(re.findall("[0#?]", mantissa.partition(".")[2]))
    if not re.search("[0#?]", mantissa):
        return 0.0
    if exponent:
        return _power_of_ten(value) * 10.0**-decimals if value else 0.0
    return 10.0**-decimals * (0.01 if "%" in bare else 1.0)


def _power_of_ten(value: float) -> float:
    return 10.0 ** math.floor(math.log10(abs(value)))
