"""One change between two files, and all of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeGuard

from addin.diff.files import ComparedFile
from addin.verify.compare import is_number

#: A number in SI, words, a flag, or None for a blank.
Value = None | bool | float | str


@dataclass(frozen=True)
class Change:
    """One thing that differs between two files."""

    kind: str  #: ``changed``, ``row added``, ``row removed`` or ``row renamed``.
    table: str  #: Where; table ``Case`` for a scalar, the column empty for a whole row.
    row: str  #: Likewise.
    column: str  #: Likewise.
    before: Value  #: In the first and in the second file. [SI]
    after: Value  #: Likewise. [SI]
    unit: str = ""  #: Unit in which it is shown; empty where there is none. [unit]
    factor: float = 1.0  #: SI value of one such unit. [SI]
    administrative: bool = False  #: Whether it can change no result: title block and descriptions.

    @property
    def difference(self) -> float | None:
        """Second minus first; None where either is no number. [SI]"""
        if not (_is_finite(self.before) and _is_finite(self.after)):
            return None
        difference = float(self.after) - float(self.before)
        return difference if math.isfinite(difference) else None

    @property
    def relative(self) -> float | None:
        """Difference over the first; None where that is no number or zero. [1]"""
        difference = self.difference
        if difference is None or not self.before:
            return None
        relative = difference / abs(float(self.before))
        return relative if math.isfinite(relative) else None

    def shown(self, value: Value) -> Value:
        """A value in the unit shown.

        Parameters
        ----------
        value : number, text or None
            `before`, `after` or `difference`. [SI]

        Returns
        -------
        number, text or None
            Numbers converted, everything else as it is. [shown unit]
        """
        return float(value) / self.factor if _is_finite(value) else value


@dataclass(frozen=True)
class VerdictChange:
    """One check of either file; its verdict may or may not have changed."""

    table: str  #: Result table, and what is judged.
    row: str  #: Likewise.
    before: str  #: Verdicts; empty where the check is not made.
    after: str  #: Likewise.
    #: The numbers judged, as words with their unit; empty where the table has none.
    result_before: str = ""
    result_after: str = ""  #: Likewise.
    limit: str = ""  #: Likewise.

    @property
    def changed(self) -> bool:
        """Whether the verdict is another one."""
        return self.before != self.after


@dataclass(frozen=True)
class StudyDifferences:
    """What differs in the studies of two files."""

    notes: tuple[str, ...] = ()  #: What is not compared, or only in part, and why.
    #: Rows of the study sheets; results of studies that both files have of their own inputs.
    inputs: tuple[Change, ...] = ()
    results: tuple[Change, ...] = ()  #: Likewise.
    same_inputs: int = 0  #: Quantities that are the same in both.
    same_results: int = 0  #: Likewise.

    @property
    def anything(self) -> bool:
        """Whether there is anything to report."""
        return bool(self.notes or self.inputs or self.results)


@dataclass(frozen=True)
class Differences:
    """Two files side by side."""

    first: ComparedFile  #: The files.
    second: ComparedFile  #: Likewise.
    #: All checks of table `Verdicts`, then those of other tables whose verdict changed.
    verdicts: tuple[VerdictChange, ...]
    inputs: tuple[Change, ...] | None  #: None where a side has no inputs (a result JSON).
    results: tuple[Change, ...]  #: By table.
    same_inputs: int  #: Quantities that are the same in both.
    same_results: int  #: Likewise.
    studies: StudyDifferences  #: What differs on the study sheets.

    @property
    def anything(self) -> bool:
        """Whether anything differs that is more than administrative."""
        if self.studies.inputs or self.studies.results:
            return True
        return bool(self.results) or any(not c.administrative for c in self.inputs or ())


def _is_finite(value: object) -> TypeGuard[float]:
    """A number; what a damaged file states as NaN is none."""
    return is_number(value) and math.isfinite(value)
