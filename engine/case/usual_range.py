"""Ranges in which a quantity usually lies, and the sentence about one outside."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

#: A value this share beyond a limit is the limit, rounded. [1]
ROUNDING = 1e-9


@dataclass(frozen=True)
class UsualRange:
    """The usual range of one column or scalar."""

    table: str  #: Input table, ``Case`` for a scalar.
    quantity: str  #: Column or scalar, or what is derived from one.
    low: float  #: Least and largest usual value. [SI, or a ratio]
    high: float  #: Likewise. [SI, or a ratio]
    unit: str  #: Unit in which a sentence states the value. [unit]
    scale: float  #: One of that unit. [SI, or a ratio]
    usual: str  #: What is usual, in words.
    advice: str  #: What to check.
    measure: str = ""  #: What is compared, where it is not the cell itself.

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
        outside = [
            (name, value) for name, value in values if value is not None and self._is_out(value)
        ]
        if not outside:
            return
        name, value = outside[0]
        row = f" of '{name}'" if name else ""
        others = f" (and {len(outside) - 1} more)" if len(outside) > 1 else ""
        measure = f"{self.measure} of " if self.measure else ""
        shown = f"{value / self.scale:.4g} {self.unit}".rstrip()
        yield (
            f"{self.table}, {self.quantity}{row}{others}: {measure}{shown} is unusual ({self.usual}). "
            f"{self.advice}"
        )

    def _is_out(self, value: float) -> bool:
        inside = self.low * (1.0 - ROUNDING) <= value <= self.high * (1.0 + ROUNDING)
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
