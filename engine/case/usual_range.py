"""Ranges in which a quantity usually lies, and what is said of one outside."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

#: A value this share beyond a limit is the limit, rounded. [1]
ROUNDING = 1e-9


@dataclass(frozen=True)
class Implausible:
    """One thing that no train has."""

    finding: str  #: In few words, for the banner.
    advice: str  #: What to check.

    @property
    def sentence(self) -> str:
        """Both, as a note."""
        return f"{self.finding[:1].upper()}{self.finding[1:]}: no verdict is given. {self.advice}"


@dataclass(frozen=True)
class UsualRange:
    """The usual range of one column or scalar, and the one that no train leaves."""

    table: str  #: Input table, ``Case`` for a scalar.
    quantity: str  #: Column or scalar, or what is derived from one.
    low: float  #: Least and largest usual value. [SI, or a ratio]
    high: float  #: Likewise. [SI, or a ratio]
    unit: str  #: Unit in which a sentence states the value. [unit]
    scale: float  #: One of that unit. [SI, or a ratio]
    usual: str  #: What is usual, in words.
    advice: str  #: What to check.
    measure: str = ""  #: What is compared, where it is not the cell itself.
    #: Beyond these no verdict is given; zero is never beyond. [SI, or a ratio]
    possible: tuple[float, float] = (-math.inf, math.inf)

    def impossible(
        self, values: Iterable[tuple[str | None, float | None]]
    ) -> Iterator[Implausible]:
        """What takes the place of a verdict.

        Parameters
        ----------
        values : iterable of tuple
            Name of the row, None for a scalar, and its value; a blank one is skipped. [SI, or a ratio]

        Yields
        ------
        Implausible
            At most one; it names the first row and counts the others.
        """
        beyond = [(n, v) for n, v in values if v and _is_out(v, *self.possible)]
        if beyond:
            row, shown = self._words(beyond)
            what = self.measure or self.quantity
            yield Implausible(
                f"{what}{row} {shown}",
                f"Usual: {self.usual}. See {self.table}, {self.quantity}. {self.advice}",
            )

    def notes(self, values: Iterable[tuple[str | None, float | None]]) -> Iterator[str]:
        """One sentence about all values outside.

        Parameters
        ----------
        values : iterable of tuple
            Name of the row, None for a scalar, and its value; a blank one is skipped. [SI, or a ratio]

        Yields
        ------
        str
            At most one sentence; it names the first row and counts the others.
        """
        typed = list(values)
        outside = [(n, v) for n, v in typed if v is not None and _is_out(v, self.low, self.high)]
        if not outside or any(self.impossible(typed)):  # what is impossible says it
            return
        row, shown = self._words(outside)
        measure = f"{self.measure} of " if self.measure else ""
        yield (
            f"{self.table}, {self.quantity}{row}: {measure}{shown} is unusual ({self.usual}). {self.advice}"
        )

    def _words(self, outside: Sequence[tuple[str | None, float]]) -> tuple[str, str]:
        """The first row with the count of the others, and its value with its unit."""
        name, value = outside[0]
        row = f" of '{name}'" if name else ""
        others = f" (and {len(outside) - 1} more)" if len(outside) > 1 else ""
        shown = float(f"{value / self.scale:.4g}")
        return f"{row}{others}", f"{shown:,g} {self.unit}".rstrip()


def _is_out(value: float, low: float, high: float) -> bool:
    inside = low * (1.0 - ROUNDING) <= value <= high * (1.0 + ROUNDING)
    return not inside and not math.isnan(value)


def quotient(value: float, divisor: float) -> float | None:
    """A ratio of two inputs; Python raises where the divisor is zero.

    Parameters
    ----------
    value : float
        What is compared. [SI]
    divisor : float
        With what. [SI]

    Returns
    -------
    float or None
        None where the divisor is so small that it counts as zero. [SI]
    """
    return value / divisor if divisor else None
