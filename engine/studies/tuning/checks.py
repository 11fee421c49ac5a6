"""Checks of the rows of `Tuning` and `Catalogue`: what is wrong is reported all at once, with what to do."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Sequence

from engine.case.checks.problem import Cells, each_row
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, value_of
from engine.case.study_inputs import (
    BACKLASH,
    DAMPING,
    DIAMETER,
    INERTIA,
    STIFFNESS,
    TUNED,
    CatalogueRow,
    StudyInputs,
    TuningRow,
)
from engine.errors import Problem
from engine.studies.tuning.options import (
    DEFAULT_STEPS,
    UNITS,
    element_of,
    offered,
    offers_by_element,
)
from engine.studies.variation import nominal_value, refusal

#: Combinations of one study; at some 50 ms each this many take a quarter of an hour. [count]
MAX_COMBINATIONS = 20_000
#: Quantities that may become zero: no damping, no clearance.
_ZERO_ALLOWED = frozenset({DAMPING, BACKLASH})
_TUNING, _CATALOGUE = "Tuning", "Catalogue"


def tuning_problems(case: CaseData, studies: StudyInputs) -> tuple[Problem, ...]:
    """Everything wrong with the rows of `Tuning` and `Catalogue`.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        The rows. [SI]

    Returns
    -------
    tuple of Problem
        Empty if the study can be made. [count]
    """
    if not studies.tuning and not studies.catalogue:
        words = (
            "the tables Tuning and Catalogue are empty. Type a coupling with its stiffnesses in "
            "table Tuning, or a maker's couplings in table Catalogue."
        )
        allowed = "at least one row in table Tuning or Catalogue"
        return (Cells(_TUNING).problem("", None, allowed, words),)
    problems: list[Problem] = []
    for cells, row in each_row(_TUNING, studies.tuning):
        problems += _tuning_row(case, cells, row)
    for cells, offer in each_row(_CATALOGUE, studies.catalogue):
        problems += _offer_row(case, cells, offer)
    problems += [*_chosen_twice(studies), *_offers_together(studies)]
    if not problems:
        problems += [*_too_little_inertia(case, studies), *_too_many(studies)]
    return tuple(problems)


#: Larger numbers are slips of the pen; products with what stands in the case must stay finite. [SI]
LARGEST = 1e30


def _wrong(
    cells: Cells, column: str, found: object, allowed: str, action: str, unit: str = ""
) -> Problem:
    """A problem of a cell that may be blank."""
    if found is None:
        return cells.blank(column, allowed, action)
    return cells.wrong(column, found, allowed, action, unit)


def _nearest(name: str, known: Sequence[str]) -> str:
    folded = {k.casefold(): k for k in known}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=1)
    return f"Did you mean '{folded[close[0]]}'?" if close else "Correct the name."


def _tuning_row(case: CaseData, cells: Cells, row: TuningRow) -> Iterator[Problem]:
    quantity, names = row.quantity, _names(case, row.quantity)
    what = "a station of table Stations" if quantity == INERTIA else "an element of table Elements"
    if quantity not in TUNED:
        allowed = "one of " + ", ".join(TUNED)
        yield _wrong(cells, "Quantity", quantity, allowed, "Choose from the list.")
    elif row.element not in names:
        action = "Name it." if row.element is None else _nearest(row.element, names)
        yield _wrong(cells, "Element", row.element, what, action)
    else:
        missing = refusal(case, row.element, quantity, relative=row.relative)
        if (
            missing is None
            and quantity == DAMPING
            and nominal_value(case, row.element, STIFFNESS) is None
        ):
            missing = (
                f"'{row.element}' is a rigid mesh and cannot have damping. Give it a stiffness."
            )
        if missing is not None:
            allowed = f"one whose {quantity} can be changed"
            yield cells.problem("Element", row.element, allowed, missing)
    yield from _range(cells, row)
    unit = "" if row.relative or quantity not in UNITS else UNITS[quantity]
    zero = quantity in _ZERO_ALLOWED
    for column, values in (("Values", row.values), ("From", (row.from_,)), ("To", (row.to,))):
        bad = [v for v in values if v is not None and not _fits(v, zero)]
        if bad:
            yield _wrong(cells, column, bad[0], _allowed(zero, bad[0]), "Correct the cell.", unit)


def _names(case: CaseData, quantity: str | None) -> list[str]:
    if quantity == INERTIA:
        return [str(s.station) for s in case.stations]
    return [str(e.element) for e in case.elements]


def _fits(value: float, zero_allowed: bool) -> bool:
    return value <= LARGEST and (value > 0.0 or (zero_allowed and value == 0.0))


def _allowed(zero_allowed: bool, found: float) -> str:
    if found > LARGEST:
        return f"at most {LARGEST:g}"
    return "zero or positive" if zero_allowed else "positive"


def _range(cells: Cells, row: TuningRow) -> Iterator[Problem]:
    """Values or a range, not both; a range that rises, or is one point."""
    if row.values:
        if row.from_ is not None or row.to is not None:
            words = "both Values and a range are given. Clear Values, or clear From, To and Steps."
            yield cells.problem("Values", row.values[0], "either Values or From and To", words)
    elif row.from_ is None and row.to is None:
        words = (
            "neither Values nor a range is given. Type numbers separated by semicolons into "
            "Values, or fill From and To."
        )
        yield cells.problem("Values", None, "Values, or From and To", words)
    elif row.from_ is None or row.to is None:
        blank, other = ("From", "To") if row.from_ is None else ("To", "From")
        yield cells.blank(blank, f"given where {other} is", "Type the other end of the range.")
    else:
        if row.from_ > row.to:
            words = "To is less than From. Swap them."  # in any unit
            yield cells.problem("To", row.to, "at least From", words)
        if row.from_ == row.to and row.steps not in (None, 1):
            allowed = f"above From, {row.from_:.6g}, where Steps is {row.steps}"
            action = "Type the other end, or clear Steps for a single value."
            yield cells.wrong("To", row.to, allowed, action)
        elif row.steps is not None and row.from_ != row.to and row.steps < 2:
            yield cells.wrong(
                "Steps",
                row.steps,
                "2 or more",
                "Steps includes both ends of the range.",
            )


def _offer_row(case: CaseData, cells: Cells, row: CatalogueRow) -> Iterator[Problem]:
    kinds = {str(e.element): e.kind for e in case.elements}
    if row.element not in kinds:
        action = "Name it." if row.element is None else _nearest(row.element, list(kinds))
        yield _wrong(cells, "Element", row.element, "an element of table Elements", action)
    elif kinds[row.element] == ElementKind.GEAR_MESH:
        yield _wrong(
            cells, "Element", row.element, "a coupling or shaft, not a gear mesh",
            "Vary the stiffness of a mesh in table Tuning.",
        )  # fmt: skip
    if not row.name:
        yield _wrong(cells, "Name", row.name, "the maker's designation", "Name it.")
    if row.fitted not in (None, "yes", "no"):
        yield _wrong(cells, "Fitted", row.fitted, "yes or no", "Choose from the list.")
    if row.stiffness is None:
        yield _wrong(cells, "Stiffness", None, "positive", "Type the maker's stiffness.", "N m/rad")
    for column, unit, zero in _OFFER_NUMBERS:
        value = value_of(row, column)
        if value is not None and not _fits(value, zero):
            yield _wrong(cells, column, value, _allowed(zero, value), "Correct the cell.", unit)


_OFFER_NUMBERS = (
    ("Stiffness", "N m/rad", False),
    ("Inertia", "kg m²", True),
    ("Damping", "N m s/rad", True),
    ("Loss factor", "", True),
    ("Rated torque", "N m", False),
    ("Peak torque limit", "N m", False),
    ("Vibratory limit", "N m", False),
)


def _chosen_twice(studies: StudyInputs) -> Iterator[Problem]:
    """The same quantity in two rows, or by two ways that exclude each other."""
    offered = {row.element for row in studies.catalogue}
    first: dict[tuple[str | None, str | None], int | None] = {}
    for cells, row in each_row(_TUNING, studies.tuning):
        key, quantity = (row.element, row.quantity), row.quantity
        other = {STIFFNESS: DIAMETER, DIAMETER: STIFFNESS}.get(str(quantity))
        if row.element is None:
            continue
        if key in first:
            allowed = f"named once for its {quantity} (row {first[key]} has it)"
            yield cells.wrong("Element", row.element, allowed, "Put all values into one row.")
        elif (row.element, other) in first:
            allowed = f"named for its {quantity} or its {other}, not for both"
            action = (
                "The stiffness follows from the diameter: clear this row or row "
                f"{first[row.element, other]}."
            )
            yield cells.wrong("Element", row.element, allowed, action)
        elif row.element in offered and quantity in (STIFFNESS, DAMPING, DIAMETER):
            allowed = f"in table Catalogue or tuned for its {quantity}, not both"
            action = (
                "A catalogue coupling has its own data: clear this row, or its rows in table "
                "Catalogue."
            )
            yield cells.wrong("Element", row.element, allowed, action)
        first.setdefault(key, cells.row)


def _offers_together(studies: StudyInputs) -> Iterator[Problem]:
    """Names, fitted marks and inertias of the couplings offered for one element."""
    name_of: dict[tuple[str | None, str | None], int | None] = {}
    fitted: dict[str | None, int | None] = {}
    with_inertia = {row.element for row in studies.catalogue if row.inertia is not None}
    for cells, row in each_row(_CATALOGUE, studies.catalogue):
        if row.element is None:
            continue
        key, of = (row.element, row.name), f"'{row.element}'"
        if row.name and key in name_of:
            allowed = f"a name used once for {of} (row {name_of[key]} has it already)"
            action = "Rename one of the two, or clear one row."
            yield cells.wrong("Name", row.name, allowed, action)
        name_of.setdefault(key, cells.row)
        if row.fitted == "yes":
            if row.element in fitted:
                allowed = f"yes in one row of {of} (row {fitted[row.element]} has it already)"
                action = (
                    "The stations include the inertia of one coupling: type yes in one row only."
                )
                yield cells.wrong("Fitted", row.fitted, allowed, action)
            fitted.setdefault(row.element, cells.row)
        if row.inertia is None and row.element in with_inertia:
            allowed = f"given in all rows of {of} or in none"
            yield cells.blank("Inertia", allowed, "Type it, or 0 where negligible.")


def _too_little_inertia(case: CaseData, studies: StudyInputs) -> Iterator[Problem]:
    """A fitted coupling with more inertia than the stations at its ends have."""
    least = {str(s.station): s.inertia or 0.0 for s in case.stations}
    for row in studies.tuning:
        if row.quantity == INERTIA and row.element is not None:
            number = min(row.values) if row.values else row.from_ or 0.0
            least[row.element] = number * least[row.element] if row.relative else number
    held = dict(least)
    offers = offers_by_element(studies.catalogue)
    taken: dict[str, float] = {}
    for name, rows in offers.items():
        taken[name] = 0.5 * min(o.offer.added_inertia for o in offered(case, name, rows).options if o.offer)  # fmt: skip
        for end in {element_of(case, name).from_, element_of(case, name).to} - {GROUND}:
            least[str(end)] += taken[name]
    for name, rows in offers.items():
        ends = (element_of(case, name).from_, element_of(case, name).to)
        short = [str(end) for end in ends if end != GROUND and least[str(end)] <= 0.0]
        fitted = next((r for r in rows if r.fitted == "yes"), None)
        if taken[name] < 0.0 and short and fitted is not None:
            words = (
                f"half of {fitted.inertia:.6g} kg m² is included in station '{short[0]}', which has "
                f"{held[short[0]]:.6g} kg m²: with the lightest catalogue coupling "
                f"{least[short[0]]:.6g} kg m² would remain. Correct the inertia of the fitted "
                "coupling, or of the station."
            )
            cells = Cells(_CATALOGUE, studies.catalogue.index(fitted) + 1)
            allowed = "at most what the stations at its ends hold"
            yield cells.problem("Inertia", fitted.inertia, allowed, words)


def _too_many(studies: StudyInputs) -> Iterator[Problem]:
    counts = [_count(row) for row in studies.tuning]
    counts += [len(rows) for rows in offers_by_element(studies.catalogue).values()]
    total = math.prod(counts)
    if total > MAX_COMBINATIONS:
        product = " × ".join(str(n) for n in counts)
        words = (
            f"{product} values make {total:,} combinations; the limit is {MAX_COMBINATIONS:,}. "
            "Give fewer Values or Steps, or vary the quantities in turn, starting with those "
            "that shift the mode with the least margin."
        )
        cells = Cells(_TUNING if studies.tuning else _CATALOGUE)
        yield cells.problem("", total, f"at most {MAX_COMBINATIONS:,} combinations", words)


def _count(row: TuningRow) -> int:
    """How many values a row has; those of a range are not made for it, they may be millions."""
    if row.values:
        return len(set(row.values))
    return 1 if row.from_ == row.to else row.steps or DEFAULT_STEPS
