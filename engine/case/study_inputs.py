"""Inputs of the studies: couplings, scatter, measurements.

A case says what the train is, a study what is asked of it. One row class stands for one input
table of the study sheets; the field names are their JSON keys. Frozen, in SI; None was left blank.
Study inputs do not enter the digest of the case, as no result of the nominal run depends on them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from engine.case.data import canonical

STIFFNESS, DAMPING, INERTIA, DIAMETER = "stiffness", "damping", "inertia", "diameter"
BACKLASH, DAMPING_RATIO = "backlash", "damping ratio"
AVERAGE_TORQUE, PULSATING_TORQUE = "average torque", "pulsating torque"
LOAD_TORQUE, SN_LINE = "load torque", "S-N line"
MEASURED_FREQUENCY, MEASURED_TORQUE = "measured frequency", "measured torque"

#: Quantities that a designer may choose.
TUNED = (STIFFNESS, DAMPING, INERTIA, DIAMETER, BACKLASH)
#: Quantities that are not known exactly. `damping ratio` is that of all elastic modes.
SCATTERED = (
    STIFFNESS,
    INERTIA,
    DAMPING,
    DAMPING_RATIO,
    AVERAGE_TORQUE,
    PULSATING_TORQUE,
    LOAD_TORQUE,
    SN_LINE,
)


@dataclass(frozen=True)
class TuningRow:
    """One row of `Tuning`: a quantity that may be chosen, and what is tried for it."""

    element: str | None = None  #: Element of `Elements`; for an inertia the station of `Stations`.
    quantity: str | None = None  #: One of `TUNED`.
    #: Whether the numbers below multiply what the case says; else they stand in its place.
    relative: bool = True
    values: tuple[float, ...] = ()  #: Values to try; empty = the range. [1 or SI]
    from_: float | None = None  #: Ends of a range. [1 or SI]
    to: float | None = None  #: Likewise. [1 or SI]
    steps: int | None = None  #: How many values the range is given, ends included; blank = 11.


@dataclass(frozen=True)
class CatalogueRow:
    """One row of `Catalogue`: a coupling that a maker offers for an element."""

    element: str | None = None  #: The element that it may replace.
    name: str | None = None  #: The maker's designation.
    #: ``yes`` for the one whose inertia the stations of the case contain; else none is in them.
    fitted: str | None = None
    stiffness: float | None = None  #: Torsional stiffness. [N m/rad]
    #: Of the whole coupling; half of it at each end, instead of the fitted one's. [kg m²]
    inertia: float | None = None
    damping: float | None = None  #: Viscous damping across it; blank = as in the case. [N m s/rad]
    loss_factor: float | None = None  #: Hysteretic loss factor; blank = as in the case. [1]
    rated_torque: float | None = None  #: The maker's limits; blank = not judged. [N m]
    peak_torque_limit: float | None = None  #: Likewise. [N m]
    vibratory_limit: float | None = None  #: Likewise. [N m]


@dataclass(frozen=True)
class ScatterRow:
    """One row of `Scatter`: how sure a quantity is."""

    name: str | None = None  #: Element, station or material; blank = all that have the quantity.
    quantity: str | None = None  #: One of `SCATTERED`.
    #: ``normal`` (default), ``uniform``, ``triangular`` or ``from-to``.
    distribution: str | None = None
    #: Of what the case says: standard deviation (normal) or half width (uniform, triangular). [1]
    spread: float | None = None
    #: Ends of a uniform distribution over what the case says (from-to). [1]
    from_: float | None = None
    to: float | None = None  #: Likewise. [1]
    #: With a blank name: ``each`` (default) scatters for itself, ``together`` all by one factor.
    together: str | None = None


@dataclass(frozen=True)
class MeasuredFrequencyRow:
    """One row of `MeasuredFrequencies`."""

    #: Elastic mode it is taken for, counted from 1; blank = the one that fits best.
    mode: int | None = None
    frequency: float | None = None  #: As measured. [Hz]
    uncertainty: float | None = None  #: Standard deviation over the frequency; blank = 0.01. [1]


@dataclass(frozen=True)
class MeasuredPeakRow:
    """One row of `MeasuredPeaks`: the largest torque of an element in a measured start."""

    element: str | None = None  #: Element of `Elements`.
    maximum_torque: float | None = None  #: As measured, at the element's own speed. [N m]
    uncertainty: float | None = None  #: Standard deviation over the torque; blank = 0.05. [1]


@dataclass(frozen=True)
class DisplayUnit:
    """A unit in which a sentence names a quantity."""

    name: str  #: As it stands in the sentence. [unit]
    size: float  #: What one of it is worth. [SI]

    def format(self, value: float, digits: int = 6) -> str:
        """A number with the unit.

        Parameters
        ----------
        value : float
            The quantity. [SI]
        digits : int, optional
            Significant digits. [count]

        Returns
        -------
        str
            Such as ``2,647,550 lbf in/rad``. [words]
        """
        return f"{float(f'{value / self.size:.{digits}g}'):,.10g} {self.name}".rstrip()


@dataclass(frozen=True)
class StudyInputs:
    """Every table of the study sheets, unchecked."""

    tuning: tuple[TuningRow, ...] = ()  #: Rows of the tables of the same name. [rows]
    catalogue: tuple[CatalogueRow, ...] = ()  #: Likewise. [rows]
    scatter: tuple[ScatterRow, ...] = ()  #: Likewise. [rows]
    measured_frequencies: tuple[MeasuredFrequencyRow, ...] = ()  #: Likewise. [rows]
    measured_peaks: tuple[MeasuredPeakRow, ...] = ()  #: Likewise. [rows]
    #: Rows of input tables that have no class here, by table: of studies that bring their own. [rows]
    others: tuple[tuple[str, tuple[Any, ...]], ...] = ()
    #: What the engineer typed in: element and quantity, or an empty name and the quantity,
    #: ``stress``, ``torque``, ``measured frequency`` or ``measured torque``, → its unit. For words
    #: alone: no number and no digest depends on it. [units]
    units: Mapping[tuple[str, str], DisplayUnit] = field(default_factory=dict, compare=False)

    def rows(self, table: str) -> tuple[Any, ...]:
        """The rows of an input table. [SI]"""
        if table in STUDY_TABLES:
            return tuple(getattr(self, STUDY_TABLES[table][0]))
        return dict(self.others).get(table, ())


#: Input table of the study sheets → (field of `StudyInputs`, row class).
STUDY_TABLES: dict[str, tuple[str, type]] = {
    "Tuning": ("tuning", TuningRow),
    "Catalogue": ("catalogue", CatalogueRow),
    "Scatter": ("scatter", ScatterRow),
    "MeasuredFrequencies": ("measured_frequencies", MeasuredFrequencyRow),
    "MeasuredPeaks": ("measured_peaks", MeasuredPeakRow),
}


def study_digest(*rows: object) -> str:
    """SHA-256 of study inputs: which rows a study was made from.

    Parameters
    ----------
    *rows : dataclass
        Rows of the tables that enter the study, and its settings. [SI]

    Returns
    -------
    str
        64 hexadecimal digits; numbers count to 12 significant digits.
    """

    text = json.dumps([canonical(row) for row in rows], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()
