"""What the fatigue of one shaft is judged with: its notch, the factors on its strength, its S-N line and mean stress.

Without a row in table FatigueFactors, and with MeanStress blank, all of it is that of `SCF` and the data to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from engine.case.choices import MeanStress, NotchKind, NotchSensitivity, SizeRule, SurfaceFinish
from engine.case.data import CaseData, ElementRow, FatigueFactorRow, MaterialRow, SNPointRow
from engine.case.fatigue_tables import RELIABILITIES, tabled_reliability
from engine.case.notches import factors_of, notch_geometry
from engine.errors import InternalError, ModelError
from engine.fatigue.mean_stress import SHEAR_ULTIMATE_RATIO
from engine.fatigue.notches import (
    fatigue_concentration,
    fillet_concentration,
    keyway_concentration,
    neuber_sensitivity,
    peterson_sensitivity,
)
from engine.fatigue.sn_curve import SNCurve, sn_curve_for
from engine.fatigue.strength_factors import lowered_line, size_factor, surface_factor
from engine.fatigue.stress import stress_of_unit_torque


@dataclass(frozen=True)
class Factor:
    """One factor, and where it comes from."""

    value: float = 1.0  #: Its value. [1]
    source: str = ""  #: Empty where nothing is typed, and it is 1.


@dataclass(frozen=True)
class NotchEffect:
    """What the notch of a shaft does to its stress."""

    concentration: Factor  #: Kt. [1]
    sensitivity: Factor  #: q. [1]

    @property
    def fatigue(self) -> float:
        """Kf. [1]"""
        return fatigue_concentration(self.concentration.value, self.sensitivity.value)


@dataclass(frozen=True, eq=False)
class ShaftStrength:
    """What the fatigue of one shaft is judged with."""

    notch: NotchEffect  #: Kt, q and Kf. [1]
    surface: Factor  #: Surface factor. [1]
    size: Factor  #: Size factor. [1]
    reliability: Factor  #: Reliability factor. [1]
    curve: SNCurve  #: S-N line in torsion, lowered by the three. [Pa]
    data_endurance: float  #: Endurance limit in torsion of the data. [Pa]
    #: Ultimate strength in torsion for Goodman; None: the mean is ignored. [Pa]
    ultimate: float | None
    unit_stress: float  #: Nominal stress of 1 N m. [Pa/(N m)]

    @property
    def factor(self) -> float:
        """Product of the factors on the endurance limit. [1]"""
        return self.surface.value * self.size.value * self.reliability.value

    @property
    def local(self) -> float:
        """Stress of 1 N m with Kf. [Pa/(N m)]"""
        return self.notch.fatigue * self.unit_stress

    @property
    def sources(self) -> str:
        """What is typed, and which formula or geometry gives the rest, in words.

        Where the formulas are published stands in docs/theory-fatigue.md and in the trace of each column.
        """
        factors = (
            ("Kt", self.notch.concentration),
            ("q", self.notch.sensitivity),
            ("surface", self.surface),
            ("size", self.size),
        )
        named = [f"{name}: {factor.source}" for name, factor in factors if factor.source]
        return "; ".join((*named, *filter(None, (self.reliability.source,))))


def notch_effect(case: CaseData, element: ElementRow) -> NotchEffect:
    """Kt and q of the notch of an element; without a row of FatigueFactors its SCF and 1.

    Parameters
    ----------
    case : CaseData
        A case that has passed its checks. [SI]
    element : ElementRow
        The element. [m, 1]

    Returns
    -------
    NotchEffect
        Kt also of the stresses that are no matter of fatigue. [1]
    """
    row = factors_of(case.fatigue_factors, element.element)
    if row is None:
        return _typed_notch(element)
    sections = tuple(s for s in case.sections if s.element == element.element)
    geometry = notch_geometry(element, row, sections)
    kt, radius = Factor(element.scf or 1.0, "SCF" if element.scf else ""), geometry.radius
    if row.notch == NotchKind.FILLET:
        if radius is None or geometry.shoulder is None:
            raise InternalError(f"the fillet of '{element.element}' has no geometry")
        value = fillet_concentration(geometry.shoulder, geometry.diameter, radius)
        kt = Factor(
            value,
            f"fillet {1e3 * geometry.diameter:.4g}/{1e3 * geometry.shoulder:.4g}, r {1e3 * radius:.4g} mm",
        )
    elif row.notch == NotchKind.KEYWAY:
        if radius is None:
            raise InternalError(f"the keyway of '{element.element}' has no radius")
        value = keyway_concentration(geometry.diameter, radius)
        kt = Factor(
            value,
            f"keyway r {1e3 * radius:.4g} mm",
        )
    return NotchEffect(kt, _sensitivity(row, radius, _uts(case.materials, element)))


@lru_cache(maxsize=64)
def _without_row(scf: float | None) -> NotchEffect:
    return NotchEffect(Factor(scf or 1.0, "SCF" if scf else ""), Factor())


def _typed_notch(element: ElementRow) -> NotchEffect:
    return _without_row(element.scf)


def _uts(materials: Sequence[MaterialRow], element: ElementRow) -> float | None:
    return next((m.uts for m in materials if m.material == element.material), None)


def _needed(uts: float | None) -> float:
    if uts is None:
        raise InternalError("a fatigue factor needs UTS")
    return uts


def _sensitivity(row: FatigueFactorRow, radius: float | None, uts: float | None) -> Factor:
    """Notch sensitivity, typed or by a formula."""
    if row.notch_sensitivity is None:
        return Factor()
    if not isinstance(row.notch_sensitivity, str):
        return Factor(row.notch_sensitivity, "typed")
    if radius is None:
        raise InternalError("a notch sensitivity needs a radius")
    is_neuber = row.notch_sensitivity == NotchSensitivity.NEUBER
    formula = neuber_sensitivity if is_neuber else peterson_sensitivity
    beside = "" if row.notch else f", r {1e3 * radius:.4g} mm"
    return Factor(formula(radius, _needed(uts)), row.notch_sensitivity + beside)


def _surface(row: FatigueFactorRow, uts: float | None) -> Factor:
    if row.surface is None:
        return Factor()
    if not isinstance(row.surface, str):
        return Factor(row.surface, "typed")
    value = surface_factor(SurfaceFinish(row.surface), _needed(uts))
    return Factor(value, row.surface)


def _size(row: FatigueFactorRow, diameter: float) -> Factor:
    if row.size is None:
        return Factor()
    if row.size != SizeRule.BY_DIAMETER:
        return Factor(float(row.size), "typed")
    return Factor(size_factor(diameter), f"{1e3 * diameter:.4g} mm")


def _reliability(row: FatigueFactorRow) -> Factor:
    if row.reliability is None:
        return Factor()
    tabled = tabled_reliability(row.reliability)
    if tabled is None:
        raise InternalError(f"reliability {row.reliability} is not in the table")
    return Factor(RELIABILITIES[tabled], f"{100.0 * tabled:.6g} % endure")


def shaft_strength(case: CaseData, element: ElementRow) -> ShaftStrength:
    """What the fatigue of a judged shaft of a case is judged with.

    Parameters
    ----------
    case : CaseData
        A case that has passed its checks. [SI]
    element : ElementRow
        A shaft with stress diameter, material and S-N points. [m, 1]

    Returns
    -------
    ShaftStrength
        Factors, S-N line and ultimate strength. [1, Pa]

    Raises
    ------
    ModelError
        When the S-N points do not make a line.
    """
    material = next(m for m in case.materials if m.material == element.material)
    row = factors_of(case.fatigue_factors, element.element) or FatigueFactorRow()
    surface, size = _surface(row, material.uts), _size(row, element.stress_diameter or 0.0)
    reliability = _reliability(row)
    points = tuple(p for p in case.sn_points if p.material == element.material)
    data = sn_line(material, points)
    factor = surface.value * size.value * reliability.value
    goodman = case.mean_stress == MeanStress.GOODMAN
    return ShaftStrength(
        notch=notch_effect(case, element),
        surface=surface,
        size=size,
        reliability=reliability,
        curve=_lowered(material, points, factor),
        data_endurance=data.endurance,
        ultimate=SHEAR_ULTIMATE_RATIO * _needed(material.uts) if goodman else None,
        unit_stress=stress_of_unit_torque(element),
    )


@lru_cache(maxsize=64)
def sn_line(material: MaterialRow, points: tuple[SNPointRow, ...]) -> SNCurve:
    """S-N line of the data, made once for all cases that share the rows, as those of a study do.

    Parameters
    ----------
    material : MaterialRow
        The material. [Pa]
    points : tuple of SNPointRow
        Its points. [1, Pa]

    Returns
    -------
    SNCurve
        The line in torsion. [Pa]
    """
    return sn_curve_for(material, points)


@lru_cache(maxsize=64)
def _lowered(material: MaterialRow, points: tuple[SNPointRow, ...], factor: float) -> SNCurve:
    try:
        return lowered_line(sn_line(material, points), factor)
    except ModelError as problem:
        raise ModelError(
            f"Material '{material.material}', lowered by {factor:.3g}: {problem}"
        ) from None
