"""Geometry of the notch of a judged shaft: typed in table FatigueFactors, or taken from the sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from engine.case.choices import NotchKind
from engine.case.data import ElementRow, FatigueFactorRow, SectionRow

#: Diameters this near to each other are one, typed in two units. [1]
SAME_DIAMETER = 1e-6


@dataclass(frozen=True)
class NotchGeometry:
    """The notch at the stress diameter of a shaft; None = not known, or of another kind."""

    diameter: float  #: Stress diameter. [m]
    radius: float | None  #: At its bottom. [m]
    shoulder: float | None  #: Larger diameter behind a fillet. [m]
    depth: float | None  #: Of a keyway, where a section has it. [m]
    steps: int  #: Different steps of the sections at the stress diameter. [count]


def notch_geometry(
    element: ElementRow, row: FatigueFactorRow, sections: Sequence[SectionRow]
) -> NotchGeometry:
    """The notch of a row of FatigueFactors; what is blank there is read from the sections.

    A fillet is that of the step whose thinner side has the stress diameter. Of several different steps
    none is taken.

    Parameters
    ----------
    element : ElementRow
        The shaft, with its stress diameter. [m]
    row : FatigueFactorRow
        Its row. [m]
    sections : sequence of SectionRow
        The sections of the element, from From to To. [m]

    Returns
    -------
    NotchGeometry
        What is known of it. [m]
    """
    diameter = element.stress_diameter or 0.0
    radius, shoulder, depth, steps = row.notch_radius, row.shoulder_diameter, None, 0
    if row.notch == NotchKind.FILLET:
        found = list(dict.fromkeys(_steps(diameter, sections)))
        steps = len(found)
        if steps == 1:
            larger, fillet = found[0]
            shoulder = larger if shoulder is None else shoulder
            radius = fillet if radius is None else radius
    if row.notch == NotchKind.KEYWAY:
        depths = [s.keyway_depth for s in sections if s.keyway_depth and _same(s.od, diameter)]
        depth = max(depths, default=None)
    return NotchGeometry(diameter, radius, shoulder, depth, steps)


def _steps(diameter: float, sections: Sequence[SectionRow]) -> list[tuple[float, float | None]]:
    """Larger diameter and fillet of the steps whose thinner side has a diameter."""
    sides = [(a.last_od or 0.0, b.od or 0.0, a.fillet or None) for a, b in pairwise(sections)]
    return [
        (max(a, b), fillet)
        for a, b, fillet in sides
        if not _same(a, b) and _same(min(a, b), diameter)
    ]


def _same(a: float | None, b: float | None) -> bool:
    return bool(a and b and abs(a - b) <= SAME_DIAMETER * b)


def factors_of(rows: Sequence[FatigueFactorRow], element: str | None) -> FatigueFactorRow | None:
    """The row of an element; None where it has none."""
    return next((row for row in rows if row.element == element), None)
