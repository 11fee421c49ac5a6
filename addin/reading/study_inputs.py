"""What is typed on the study sheets → `StudyInputs`; wrong cells there spoil no plain calculation.

Numbers of table `Tuning` are in the unit of their row, for each row may be of another quantity.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from dataclasses import make_dataclass, replace
from typing import Any

from addin.contract.problems import CellProblem, shortened
from addin.contract.tables import STUDY_INPUT_TABLES
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.typed_case import (
    Entry,
    Findings,
    PerUnitBases,
    Place,
    StudiesRead,
    Typed,
    TypedCase,
    ratios_of,
    rows_in_si,
    to_case_data,
)
from engine.case.data import CaseData
from engine.case.study_inputs import (
    BACKLASH,
    DAMPING,
    DIAMETER,
    INERTIA,
    MEASURED_FREQUENCY,
    MEASURED_TORQUE,
    STIFFNESS,
    STUDY_TABLES,
    DisplayUnit,
    StudyInputs,
    TuningRow,
)
from engine.errors import Problem

#: Dimensions that a unit of a quantity may have beside a ratio.
_DIMENSIONS = {
    STIFFNESS: ("torsional stiffness",),
    DAMPING: ("torsional damping",),
    INERTIA: ("inertia",),
    DIAMETER: ("length",),
    BACKLASH: ("length", "angle"),
}
_RELATIVE = UnitScale(1.0)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
#: Most values of one row; a range has fewer by its own check. [count]
_MOST_VALUES = 200


#: Classes of the rows of tables that have none in `engine.case.study_inputs`: a field a column, in SI.
_ROW_CLASSES: dict[str, type] = {
    spec.name: make_dataclass(
        f"{spec.name}Row",
        [(column.attribute, Any, None) for column in spec.columns],
        frozen=True,
        namespace={"__module__": __name__},
    )
    for spec in STUDY_INPUT_TABLES
    if spec.name not in STUDY_TABLES
}
globals().update(
    {row.__name__: row for row in _ROW_CLASSES.values()}
)  # so that rows can be pickled


def studies_read(
    tables: Collection[str],
    typed: TypedCase,
    case: TypedCase,
    findings: Findings,
    locate: Callable[[Problem], CellProblem],
    warnings: tuple[str, ...],
) -> StudiesRead:
    """Study inputs in SI, with what cannot be read.

    Parameters
    ----------
    tables : collection of str
        Study tables that the input has. [names]
    typed : TypedCase
        What is typed in them. [as typed]
    case : TypedCase
        The case, for units relative to it. [as typed]
    findings : Findings
        Of the reader. [problems]
    locate : callable
        Gives a problem its cell.
    warnings : tuple of str
        Of the reader. [sentences]

    Returns
    -------
    StudiesRead
    """
    of_reader = findings.without()
    ratings = _ratings(case)
    bases = PerUnitBases(ratings.rated_torque, ratings.synchronous_speed, ratios_of(case))
    return StudiesRead(
        replace(study_rows(typed, bases, findings), units=units_for_words(typed, case)),
        frozenset(tables),
        tuple(findings.problems),
        warnings,
        frozenset(findings.bad),
        locate,
        typed,
        of_reader,
    )


def study_rows(typed: TypedCase, bases: PerUnitBases, findings: Findings) -> StudyInputs:
    """The rows of all study tables in SI.

    Parameters
    ----------
    typed : TypedCase
        What is typed in them. [as typed]
    bases : PerUnitBases
        What relative units refer to. [SI]
    findings : Findings
        Takes what cannot be read. [problems]

    Returns
    -------
    StudyInputs
        The rows. [SI]
    """
    rows: dict[str, Any] = {}
    others: list[tuple[str, tuple[Any, ...]]] = []
    for spec in STUDY_INPUT_TABLES:
        key, row_class = STUDY_TABLES.get(spec.name) or ("", _ROW_CLASSES[spec.name])
        if not key:
            others.append((spec.name, rows_in_si(spec, row_class, typed, bases, findings)))
        elif spec.name == "Tuning":
            rows[key] = tuple(
                _tuning(entries, number, findings)
                for number, entries in enumerate(typed.tables.get(spec.name, ()), start=1)
            )
        else:
            rows[key] = rows_in_si(spec, row_class, typed, bases, findings)
    return StudyInputs(**rows, others=tuple(others))


#: Quantity → tables and columns of the case or study that hold it, and how their rows are called.
_TYPED_IN = {
    STIFFNESS: (("Elements", "Stiffness", "Element"),),
    DAMPING: (("Elements", "Damping", "Element"),),
    INERTIA: (("Stations", "Inertia", "Station"),),
    DIAMETER: (("Elements", "OD", "Element"),),
    BACKLASH: (("Meshes", "Backlash", "Element"), ("Meshes", "Angular backlash", "Element")),
    "stress": (("Materials", "UTS", ""), ("SNPoints", "Stress", "")),
    "torque": (("MotorTorque", "Pulsating", ""), ("MotorTorque", "Average", "")),
    MEASURED_FREQUENCY: (("MeasuredFrequencies", "Frequency", ""),),
    MEASURED_TORQUE: (("MeasuredPeaks", "Maximum torque", ""),),
}


def units_for_words(typed: TypedCase, case: TypedCase) -> dict[tuple[str, str], DisplayUnit]:
    """The units that the engineer typed, for the words of a study.

    Parameters
    ----------
    typed : TypedCase
        The study tables. [as typed]
    case : TypedCase
        The case. [as typed]

    Returns
    -------
    dict of (str, str) to DisplayUnit
        See `StudyInputs`: the unit of a row of `Tuning` first, then that of its cell in the case. [units]
    """
    units: dict[tuple[str, str], DisplayUnit] = {}
    for quantity, places in _TYPED_IN.items():
        for table, column, named in places:
            for row in (*case.tables.get(table, ()), *typed.tables.get(table, ())):
                entry, name = row.get(column), row.get(named)
                if not isinstance(entry, Typed) or entry.scale.base:
                    continue
                unit = _word_unit(entry.unit, entry.scale)
                if isinstance(name, str):
                    units.setdefault((name, quantity), unit)
                if quantity != BACKLASH:  # a gap of teeth is a length, that of a coupling an angle
                    units.setdefault(("", quantity), unit)
    for line in typed.tables.get("Tuning", ()):
        whose, what, unit_text = (line.get(key) for key in ("Element", "Quantity", "Unit"))
        if isinstance(whose, str) and isinstance(what, str) and isinstance(unit_text, str):
            scale, relative = _scale(unit_text, what, 0, Findings())
            if not relative:
                units[whose, what] = _word_unit(unit_text, scale)
    return units


def _word_unit(name: str, scale: UnitScale) -> DisplayUnit:
    return DisplayUnit(name.replace("*", " ").replace("^2", "²"), scale.factor)


def _ratings(case: TypedCase) -> Any:
    """Ratings of a case as far as they can be read; its own problems are reported elsewhere."""
    data: CaseData = to_case_data(
        TypedCase(dict(case.scalars), {"Stations": case.tables.get("Stations", [])}), Findings()
    )
    return data.ratings


# --- table Tuning: each row in its own unit -------------------------------------------------------


def _tuning(entries: dict[str, Entry], number: int, findings: Findings) -> TuningRow:
    """One row of `Tuning`, its numbers in its own unit."""

    def plain(column: str) -> float | None:
        entry = entries.get(column)
        return None if entry is None or isinstance(entry, str) else float(entry.number)

    def words(column: str) -> str | None:
        entry = entries.get(column)
        return entry if isinstance(entry, str) else None

    quantity, steps = words("Quantity"), plain("Steps")
    values, start, end = _listed(words("Values"), number, findings), plain("From"), plain("To")
    if steps is not None and steps != round(steps):
        findings.add(
            ("Tuning", number, "Steps"), steps, "a whole number",
            f"found {steps:g}; it must be a whole number. Correct it.",
        )  # fmt: skip
        steps = None
    scale, relative = _scale(words("Unit"), quantity, number, findings)
    return TuningRow(
        element=words("Element"),
        quantity=quantity,
        relative=relative,
        values=tuple(scale.to_si(value) for value in values),
        from_=None if start is None else scale.to_si(start),
        to=None if end is None else scale.to_si(end),
        steps=None if steps is None else int(steps),
    )


def _scale(
    unit: str | None, quantity: str | None, number: int, findings: Findings
) -> tuple[UnitScale, bool]:
    """What the numbers of a row are worth, and whether they multiply what the case says."""
    if unit is None:
        return _RELATIVE, True
    place: Place = ("Tuning", number, "Unit")
    for dimension in ("ratio", *_DIMENSIONS.get(quantity or "", ())):
        try:
            return parse_unit(unit, dimension), dimension == "ratio"
        except UnitError as error:
            refused = error
    if quantity is not None:  # else the blank Quantity is told
        findings.add(
            place,
            unit,
            refused.allowed,
            f"{refused.message} For multiples of the value in the case write 1 or %, or leave the "
            "cell blank.",
        )
    findings.silence(*(("Tuning", number, column) for column in ("Values", "From", "To")))
    return _RELATIVE, True


def _listed(text: str | None, number: int, findings: Findings) -> tuple[float, ...]:
    """The numbers of a list such as ``0.5; 0.8; 1.2``."""
    if text is None:
        return ()
    place: Place = ("Tuning", number, "Values")
    parts = [part for part in re.split(r"[;\s]+", text.strip()) if part]
    wrong = next((part for part in parts if not _NUMBER.fullmatch(part)), None)
    if wrong is not None:
        hint = " Use a decimal point." if re.search(r"\d,\d", wrong) else ""
        findings.add(
            place, shortened(text), "numbers with semicolons between them",
            f"found '{shortened(text)}'; '{shortened(wrong)}' is not a number. Write numbers "
            f"separated by semicolons, such as 0.5; 0.8; 1.2, and their unit in column Unit.{hint}",
        )  # fmt: skip
        return ()
    if len(parts) > _MOST_VALUES:
        findings.add(
            place, len(parts), f"at most {_MOST_VALUES} values",
            f"found {len(parts)} values; the limit is {_MOST_VALUES}. Delete some.",
        )  # fmt: skip
        return ()
    return tuple(float(part) for part in parts)
