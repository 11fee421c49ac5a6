"""Numbers and units as a reader sees them: few digits, thousands apart, powers of ten in words of print.

No result is rounded anywhere but here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from engine.case.defaults import WHOLE_STARTS
from engine.case.result_words import NoNumber
from engine.fatigue.damage import MANY_STARTS

_UP = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
#: From here on a number is written with a power of ten.
_LARGE, _SMALL = 1e7, 1e-6
#: Shares that are compared with each other and need no digits below a hundredth of a percent.
_PLAIN_SHARES = frozenset({"Margin", "Required", "Percent speed", "Share", "Damping ratio"})


def number_in(row: Mapping[str, object], column: str) -> float | None:
    """The number in a cell of a row; None where words, a flag or nothing stands there."""
    value = row.get(column)
    return float(value) if isinstance(value, float | int) and not isinstance(value, bool) else None


def clean(text: str) -> str:
    """A typed text without signs that no page can show.

    Returns
    -------
    str
        The same with control characters as blanks. [text]
    """
    # surrogates and the two non-characters cannot stand in XML, the others have no picture
    kept = (
        " "
        if ord(c) < 32
        or 127 <= ord(c) < 160
        or 0xD800 <= ord(c) < 0xE000
        or ord(c) & 0xFFFE == 0xFFFE
        else c
        for c in text
    )
    return " ".join("".join(kept).split())


def engineering(value: float, digits: int = 4) -> str:
    """A number with a power of ten that is a multiple of three."""
    rounded = float(f"{value:.{digits - 1}e}")
    power = 3 * math.floor(math.log10(abs(rounded)) / 3.0 + 1e-12) if rounded else 0
    mantissa = rounded / 10.0**power
    before = len(str(int(abs(mantissa))))
    return f"{_signed(f'{mantissa:.{max(digits - before, 0)}f}')}×10{raised(power)}"


def significant(value: float, digits: int = 4) -> str:
    """A number with so many significant digits; whole numbers keep all of theirs."""
    if value == 0.0:
        return "0"
    size = abs(value)
    if size >= _LARGE or size < _SMALL:
        return engineering(value, digits)
    decimals = max(0, digits - 1 - math.floor(math.log10(float(f"{size:.{digits - 1}e}"))))
    return fixed(value, decimals)


def fixed(value: float, decimals: int) -> str:
    """A number with so many decimals."""
    return _signed(f"{value:,.{decimals}f}")


def raised(power: int) -> str:
    """A whole number as an exponent."""
    return str(power).translate(_UP)


def _signed(text: str) -> str:
    """With a proper minus, and none before a zero."""
    if text.startswith("-"):
        return "−" + text[1:] if any(c in "123456789" for c in text) else text[1:]
    return text


def typed(value: float, digits: int = 10) -> str:
    """An input: all digits that were typed, no more."""
    if value == 0.0:
        return "0"
    text = f"{value:.{digits}g}"
    if "e" not in text:
        whole, _, rest = text.lstrip("-").partition(".")
        grouped = f"{int(whole):,}" + (f".{rest}" if rest else "")
        return _signed(("-" if value < 0.0 else "") + grouped)
    mantissa, _, power = text.partition("e")
    return f"{_signed(mantissa)}×10{raised(int(power))}"


def of_dimension(value: float, name: str, dimension: str, unit: str = "") -> str:
    """A result as shown, by the column it stands in.

    Parameters
    ----------
    value : float
        In the shown unit. [any]
    name : str
        Header of its column. [name]
    dimension : str
        Key of `addin.contract.tables.DIMENSIONS`. [word]
    unit : str
        The shown unit. [unit]

    Returns
    -------
    str
        The number. [text]
    """
    if not math.isfinite(value):
        return NoNumber.UNBOUNDED.value
    if name in ("Damage", "Damage check"):
        return "0" if value == 0.0 else scientific(value)
    if name in ("Allowable starts", "Paper count", "Cycles to failure", "Starts to judge"):
        # starts are rounded down, never up
        return _whole(value) if abs(value) >= 100.0 else significant(value, 4)
    if name == "Cycles":
        return fixed(value, 1)
    if name in _PLAIN_SHARES:
        return fixed(value, 2)
    if dimension in ("fraction", "speed fraction"):
        return _fraction(value)
    if dimension == "none":  # a number among words: whole, or already rounded
        return fixed(value, 0) if float(value).is_integer() else significant(value, 4)
    decimals = _DECIMALS.get((dimension, unit))
    if decimals is not None:
        return fixed(value, decimals)
    if dimension == "count":
        if name == "Safety factor":
            return fixed(value, 2)
        return fixed(value, 0) if float(value).is_integer() else significant(value, 4)
    return significant(value, 3 if dimension in ("deciding number", "calculation time") else 5)


#: Decimals of a dimension in its usual unit.
_DECIMALS = {
    ("frequency", "Hz"): 2,
    ("frequency", "cpm"): 0,
    ("cycles per minute", "cpm"): 0,
    ("time", "s"): 3,
    ("speed", "rpm"): 1,
    ("ratio", "1"): 4,
    ("sweep rate", "Hz/s"): 2,
    ("angular acceleration", "rpm/s"): 1,
    ("approach speed", "m/s"): 3,
    ("approach speed", "in/s"): 2,
    ("angular approach speed", "rad/s"): 3,
}


def _whole(value: float) -> str:
    floor = math.floor(value * (1.0 + WHOLE_STARTS))
    return f"{floor:,}" if floor < MANY_STARTS else engineering(value)


def _fraction(value: float) -> str:
    """Percent with two decimals; smaller ones with two digits."""
    if value == 0.0:
        return "0"
    if abs(value) >= 0.1:
        return fixed(value, 2)
    return "< 0.000001" if 0.0 < value < _SMALL else significant(value, 2)


def scientific(value: float, decimals: int = 3) -> str:
    """A number with a power of ten."""
    mantissa, _, power = f"{value:.{decimals}e}".partition("e")
    return f"{_signed(mantissa)}×10{raised(int(power))}"


def pretty_unit(unit: str) -> str:
    """A unit as printed: ``lbf*in/rad`` → ``lbf·in/rad``.

    Parameters
    ----------
    unit : str
        As typed. [unit]

    Returns
    -------
    str
        With raised powers and middle dots; empty for a pure number. [unit]
    """
    if unit in ("", "1"):
        return ""
    shown = unit.replace("*", "·").replace("deg", "°").replace("um", "µm")
    for digit in "234":
        shown = shown.replace(f"^{digit}", digit.translate(_UP))
    return shown
