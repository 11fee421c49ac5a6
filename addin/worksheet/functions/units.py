"""Conversion between units."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import lru_cache

from addin.contract import tables as fields
from addin.contract.problems import nearest
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.worksheet.answers import Rows
from addin.worksheet.registry import Argument, FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 90
#: Characters of a unit that are read; none is as long.
_READ = 200


@registered(
    "TV_CONVERT",
    Argument("Value", "numbers", "A number, or a range of them."),
    Argument("From", "text", "The unit of the value, such as lb*ft^2."),
    Argument("To", "text", "The target unit, such as kg*m^2."),
    example='=TV_CONVERT(10900, "lb*ft^2", "kg*m^2")',
)
def tv_convert(value: Rows, given: str, wanted: str) -> Rows:
    """Convert numbers from one unit to another of the same dimension."""
    factor = _factor(_short(given), _short(wanted))
    if isinstance(factor, str):
        raise FunctionError(factor)
    return [[None if v is None else v * factor for v in row] for row in value]


def _short(unit: str) -> str:
    """A unit as typed; of a text too long to be one only the beginning, with a mark that no unit has."""
    unit = unit.strip()
    return unit if len(unit) <= _READ else f"{unit[:_READ]}…"


@lru_cache(maxsize=1024)
def _factor(given: str, wanted: str) -> float | str:
    """What numbers are multiplied with; or why they cannot be converted, which takes longer to find."""
    sizes, others = _sizes(given), _sizes(wanted)
    if not sizes or not others:
        unknown, known = (given, others) if not sizes else (wanted, sizes)
        return f"'{unknown[:40]}' is not a known unit{_meant(unknown, known)}."
    common = [name for name in sizes if name in others]
    for name in common:
        if sizes[name].base == others[name].base:
            return sizes[name].factor / others[name].factor
    if common:
        return f"'{given[:40]}' and '{wanted[:40]}' refer to different quantities."
    return f"'{given[:40]}' is {_named(next(iter(sizes)))}, but '{wanted[:40]}' is not."


def _sizes(unit: str) -> dict[str, UnitScale]:
    """What a unit is worth, by every dimension it is a unit of."""
    found = {}
    for name, dimension in fields.DIMENSIONS.items():
        if dimension.units and name != "cycles per minute":  # frequency holds its unit
            with suppress(UnitError):
                found[name] = parse_unit(unit, name)
    return found


def _meant(unit: str, others: Iterable[str]) -> str:
    """What may have been meant by a unit that is none, first among those of the other's kind."""
    for name in [*others, *(n for n, d in fields.DIMENSIONS.items() if d.units)]:
        try:
            parse_unit(unit, name)
        except UnitError as wrong:
            if wrong.hint:
                return f"; {wrong.hint}"
    usual = dict.fromkeys(u for d in fields.DIMENSIONS.values() for u in d.units)
    meant = nearest(unit, usual)
    return f"; perhaps {meant} is meant" if meant else ""


def _named(dimension: str) -> str:
    return f"{'an' if dimension[0] in 'aeiou' else 'a'} {dimension}"
