"""What may be chosen: options of the rows of `Tuning` and `Catalogue`, and the case that they make.

A coupling of the catalogue takes the place of the one in the case: its stiffness, damping and loss
factor (blank = as in the case), its limits (blank = not judged, as the limits of another coupling say
nothing of it), and half of its inertia at each end. The stations of the case contain that of the row
marked ``fitted``, which is taken off; without such a row they contain none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.case.data import GROUND, CaseData, ElementRow
from engine.case.study_inputs import (
    BACKLASH,
    DAMPING,
    DIAMETER,
    INERTIA,
    STIFFNESS,
    CatalogueRow,
    DisplayUnit,
    StudyInputs,
    TuningRow,
)
from engine.studies.variation import Change, nominal_value, varied_case

#: What a catalogue changes: the coupling as a whole. [word]
COUPLING = "coupling"
#: Values of a range where `Steps` is blank. [count]
DEFAULT_STEPS = 11
#: SI units of the tuned quantities as shown in a sentence; backlash is m or rad.
UNITS = {STIFFNESS: "N m/rad", DAMPING: "N m s/rad", INERTIA: "kg m²", DIAMETER: "m", BACKLASH: ""}
#: Columns of `Catalogue` that hold a limit of the maker.
_LIMITS = ("rated_torque", "peak_torque_limit", "vibratory_limit")


@dataclass(frozen=True)
class Offer:
    """A coupling of the catalogue, in the place of the one of an element."""

    row: CatalogueRow  #: What the maker states. [SI]
    #: Its inertia less that of the fitted one; half of it goes to each end. [kg m²]
    added_inertia: float


@dataclass(frozen=True)
class Option:
    """One thing that a variable may be."""

    label: str  #: What it is called: a number with its unit, or the maker's designation.
    value: float  #: What the quantity becomes; of a coupling its stiffness. [SI]
    change: Change | None = None  #: The change it makes; None for a coupling of the catalogue. [SI]
    offer: Offer | None = None  #: The coupling of the catalogue; None for a number. [SI]


@dataclass(frozen=True)
class Variable:
    """One thing that may be chosen."""

    name: str  #: Element; of an inertia the station.
    quantity: str  #: One of `engine.studies.variation.TUNED`, or `COUPLING`.
    #: What the case says; of a coupling its stiffness; None where it says nothing. [SI]
    present: float | None
    options: tuple[Option, ...]  #: In rising value. [SI]

    @property
    def title(self) -> str:
        """What it is called on axes and in sentences. [words]"""
        return self.name if self.quantity == COUPLING else f"{self.name} {self.quantity}"

    @property
    def unit(self) -> str:
        """SI unit of its values. [unit]"""
        return UNITS[STIFFNESS if self.quantity == COUPLING else self.quantity]


@dataclass(frozen=True)
class Combination:
    """One option of each variable."""

    #: Option of each variable of the plan; empty where none of them is the case itself. [indices]
    picked: tuple[int, ...]
    options: tuple[Option, ...]  #: The same, as they are. [SI]
    as_is: bool  #: Whether it is the unchanged case.


def variables_of(case: CaseData, studies: StudyInputs) -> tuple[Variable, ...]:
    """What may be chosen, of rows that have passed their checks.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Rows of `Tuning` and `Catalogue`. [SI]

    Returns
    -------
    tuple of Variable
        Rows of `Tuning`, then elements of `Catalogue`, each in the order of its table. [SI]
    """
    return (
        *(_tuned(case, row) for row in studies.tuning),
        *(offered(case, name, rows) for name, rows in offers_by_element(studies.catalogue).items()),
    )


def with_options(case: CaseData, options: Sequence[Option]) -> CaseData:
    """A case with options in place of what it says.

    Numbers first, then couplings, each in the order of names: the order of the rows cannot matter.

    Parameters
    ----------
    case : CaseData
        The unchanged case. [SI]
    options : sequence of Option
        One of each variable, or of some. [SI]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    changes = [o.change for o in options if o.change is not None]
    offers = [o.offer for o in options if o.offer is not None]
    case = varied_case(case, sorted(changes, key=lambda c: (c.quantity, c.name)))
    for offer in sorted(offers, key=lambda o: str(o.row.element)):
        case = _with_offer(case, offer)
    return case


def _with_offer(case: CaseData, offer: Offer) -> CaseData:
    row = offer.row
    limits = {key: getattr(row, key) for key in _LIMITS}
    given = {
        key: getattr(row, key)
        for key in ("stiffness", "damping", "loss_factor")
        if getattr(row, key) is not None
    }
    old = element_of(case, row.element)
    elements = tuple(replace(e, **given, **limits) if e is old else e for e in case.elements)
    half = 0.5 * offer.added_inertia
    stations = case.stations
    if half:
        ends = {old.from_, old.to} - {GROUND}
        stations = tuple(
            replace(s, inertia=(s.inertia or 0.0) + half) if s.station in ends else s
            for s in case.stations
        )
    return replace(case, elements=elements, stations=stations)


def element_of(case: CaseData, name: str | None) -> ElementRow:
    """The row of an element that is known to be there.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    name : str or None
        The element. [name]

    Returns
    -------
    ElementRow
        Its row. [SI]
    """
    return next(e for e in case.elements if e.element == name)


# --- options --------------------------------------------------------------------------------------


def _tuned(case: CaseData, row: TuningRow) -> Variable:
    name, quantity = str(row.element), str(row.quantity)
    stands = nominal_value(case, name, quantity)
    options = []
    for number in dict.fromkeys(_numbers(row)):
        value = number * (stands or 0.0) if row.relative else number
        change = Change(quantity, name, number, row.relative)
        options.append(
            Option(_label(change, value, DisplayUnit(UNITS[quantity], 1.0)), value, change)
        )
    return Variable(name, quantity, stands, _sorted(options))


def _label(change: Change, value: float, unit: DisplayUnit) -> str:
    in_unit = unit.format(value)
    return f"{change.value:.6g} × ({in_unit})" if change.relative else in_unit


def in_units(variable: Variable, units: Mapping[tuple[str, str], DisplayUnit]) -> Variable:
    """A variable whose options are named in the units that the engineer typed.

    Parameters
    ----------
    variable : Variable
        Named in SI. [SI]
    units : mapping of (str, str) to DisplayUnit
        As in `StudyInputs`: that of the variable's row, else the usual one of the workbook. [units]

    Returns
    -------
    Variable
        The same options in the same order. [SI]
    """
    name, quantity = variable.name, variable.quantity
    unit = units.get((name, quantity)) or units.get(("", quantity))
    if unit is None:
        return variable
    options = tuple(
        o if o.change is None else replace(o, label=_label(o.change, o.value, unit))
        for o in variable.options
    )
    return replace(variable, options=options)


def _numbers(row: TuningRow) -> tuple[float, ...]:
    """Values of a row; both ends of a range exactly as typed."""
    if row.values:
        return row.values
    assert row.from_ is not None
    assert row.to is not None
    if row.from_ == row.to:
        return (row.from_,)
    inner = np.linspace(row.from_, row.to, row.steps or DEFAULT_STEPS).tolist()
    return (row.from_, *inner[1:-1], row.to)


def offered(case: CaseData, name: str, rows: Sequence[CatalogueRow]) -> Variable:
    """The couplings on offer for one element.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    name : str
        The element. [name]
    rows : sequence of CatalogueRow
        Its rows. [SI]

    Returns
    -------
    Variable
        With one option a row. [SI]
    """
    fitted = next((r.inertia for r in rows if r.fitted == "yes"), None) or 0.0
    options = [
        Option(str(r.name), r.stiffness or 0.0, offer=Offer(r, (r.inertia or 0.0) - fitted))
        for r in rows
    ]
    return Variable(name, COUPLING, nominal_value(case, name, STIFFNESS), _sorted(options))


def _sorted(options: Sequence[Option]) -> tuple[Option, ...]:
    return tuple(sorted(options, key=lambda o: (o.value, o.label)))


def offers_by_element(rows: Sequence[CatalogueRow]) -> dict[str, list[CatalogueRow]]:
    """Rows of `Catalogue` by the element that they may replace.

    Parameters
    ----------
    rows : sequence of CatalogueRow
        All of them. [SI]

    Returns
    -------
    dict of str to list of CatalogueRow
        In the order of their first rows. [SI]
    """
    found: dict[str, list[CatalogueRow]] = {}
    for row in rows:
        found.setdefault(str(row.element), []).append(row)
    return found
