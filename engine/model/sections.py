"""Stepped shafts from their sections: stiffness and inertia of table `Sections`.

Each section twists over its effective length and turns with the inertia of its cylinder. A step to a larger
diameter adds flexibility, because the larger section carries torque over its whole depth only some way behind the
shoulder; a keyway takes stiffness; of a section inside a hub a share of the length twists.

The added length and the loss by a keyway are formulas fitted to solutions of the equation of torsion, the step as a
body of revolution and the keyway as a prismatic bar; `tests/validation/test_torsion_of_steps.py` solves both equations again
and compares. docs/method.md, Shafts from sections.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from engine.case.data import CaseData, SectionMaterialRow, SectionRow
from engine.case.steels import DENSITY, SHEAR_MODULUS
from engine.numerics.same_bits import fourth, power, total

#: What sections are made of unless they name a material.
STEEL = SectionMaterialRow("steel", SHEAR_MODULUS, DENSITY)
#: A taper is calculated in so many slices, each integrated at the points of Gauss with their weights. [1]
TAPER_SLICES = 8
GAUSS = ((0.5 - math.sqrt(0.15), 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + math.sqrt(0.15), 5.0 / 18.0))


def step_length(ratio: float, fillet: float = 0.0, bore: float = 0.0) -> float:
    """Length that a step adds to the thinner shaft while it is taken from the thicker one, over the thinner diameter.

    Parameters
    ----------
    ratio : float
        Thicker over thinner diameter, more than 1. [1]
    fillet : float, optional
        Fillet radius over the thinner diameter, at most half of (ratio − 1). [1]
    bore : float, optional
        Bore over the thinner diameter, up to 0.8. [1]

    Returns
    -------
    float
        λ/d, not negative: a fillet as large as 0.2 d leaves nearly nothing to add. [1]

    Notes
    -----
    Fitted to finite-element solutions of the body of revolution for ratios of 1.1 to 6, fillets up to 0.25 and
    bores up to 0.8: within 0.0006, with bores of 0.5 to 0.8 within 0.005. A shaft on a half-space adds at least
    3π/64 = 0.147 (Reissner and Sagoci, J. Appl. Phys. 15 (1944) 652: T = 16/3 G a³ θ of a rigid disc).
    """
    u = 1.0 / ratio
    sharp = 0.1568 * power(1.0 - u, 0.7576) * (1.0 + 1.0163 * u - 0.2515 * u * u)
    sharp *= 1.0 - 0.75 * power(bore, 3.8)
    return max(0.0, sharp - (0.6957 + 0.5916 * power(u, 4.2)) * power(fillet, 1.294))


def keyway_loss(width: float, depth: float) -> float:
    """Share of the torsional stiffness of a solid round section that one rectangular keyway takes.

    Parameters
    ----------
    width, depth : float
        Width, and depth from the crown of the shaft, over its diameter; up to 0.35 and 0.2. [1]

    Returns
    -------
    float
        Loss of the torsion constant over π D⁴ / 32. [1]

    Notes
    -----
    Fitted to solutions of Poisson's equation for widths of 0.1 to 0.35 and depths of 0.05 to 0.2: within 0.004.
    """
    return 3.365 * power(width, 0.3394) * power(depth, 1.3361)


@dataclass(frozen=True)
class Section:
    """One section of an element, as it twists and turns."""

    element: str  #: Element it belongs to.
    section: str  #: Its name, or its number.
    #: Length of a plain cylinder of its OD and ID that would twist as much. [m]
    effective_length: float
    #: Compliance and polar inertia of its slices, from From to To; a cylinder is one. [rad/(N m), kg m²]
    slices: tuple[tuple[float, float], ...]

    @property
    def stiffness(self) -> float:
        """Torsional stiffness. [N m/rad]"""
        return 1.0 / total(twist for twist, _ in self.slices)

    @property
    def inertia(self) -> float:
        """Polar inertia. [kg m²]"""
        return total(inertia for _, inertia in self.slices)


@dataclass(frozen=True)
class Profile:
    """How stiffness and inertia of an element are spread along it; a plain shaft is one uniform part."""

    #: Share of the twist and of the inertia in each part, from From to To. [1]
    parts: tuple[tuple[float, float], ...] = ((1.0, 1.0),)
    #: Pieces of each part in the coarsest subdivision, so that a wave passes all in about the same time. [count]
    pieces: tuple[int, ...] = field(init=False)

    def __post_init__(self) -> None:
        times = [math.sqrt(twist * inertia) for twist, inertia in self.parts]
        mean = total(times) / len(times)
        # a hair below a whole number is that number: equal sections make one piece each
        pieces = tuple(max(1, math.ceil(t / mean - 1e-9)) if mean else 1 for t in times)
        object.__setattr__(self, "pieces", pieces)


#: A plain shaft.
UNIFORM = Profile()


def sections_of(case: CaseData) -> dict[str, tuple[Section, ...]]:
    """Sections of each element that has rows in table `Sections`, in the order of the rows.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]

    Returns
    -------
    dict of str to tuple of Section
        By element. [SI]
    """
    materials: dict[str | None, SectionMaterialRow] = {
        m.material: m for m in case.section_materials
    }
    rows: dict[str, list[SectionRow]] = {}
    for row in case.sections:
        rows.setdefault(str(row.element), []).append(row)
    return {name: _sections(own, materials) for name, own in rows.items()}


def profile_of(sections: Sequence[Section]) -> Profile:
    """How stiffness and inertia are spread over sections in series.

    Parameters
    ----------
    sections : sequence of Section
        From From to To. [SI]

    Returns
    -------
    Profile
        Shares. [1]
    """
    slices = [one for s in sections for one in s.slices]
    whole, mass = total(t for t, _ in slices), total(j for _, j in slices) or 1.0
    return Profile(tuple((t / whole, j / mass) for t, j in slices))


def series_stiffness(sections: Sequence[Section]) -> float:
    """Stiffness of sections in series.

    Parameters
    ----------
    sections : sequence of Section
        At least one. [SI]

    Returns
    -------
    float
        Stiffness. [N m/rad]
    """
    return 1.0 / total([1.0 / s.stiffness for s in sections])


def _sections(
    rows: Sequence[SectionRow], materials: Mapping[str | None, SectionMaterialRow]
) -> tuple[Section, ...]:
    lengths = [row.length or 0.0 for row in rows]
    found = []
    for i, (row, added) in enumerate(
        zip(rows, _added_lengths(rows, lengths), strict=True), start=1
    ):
        material = materials.get(row.material, STEEL)
        modulus, density = material.shear_modulus or 0.0, material.density or 0.0
        share = 1.0 if row.penetration is None else row.penetration
        pieces = [
            ((share * twist + added / count) / (modulus * torsion_constant(row)), density * second)
            for twist, second, count in _slices(row)
        ]
        found.append(
            Section(
                element=str(row.element),
                section=row.section or str(i),
                effective_length=total(twist for twist, _ in pieces) * modulus * _polar(row),
                slices=tuple(pieces),
            )
        )
    return tuple(found)


def _slices(row: SectionRow) -> list[tuple[float, float, int]]:
    """Length of the plain cylinder that twists as much, ∫ of the polar area, and the number of slices."""
    length, od, end, bore = row.length or 0.0, row.od or 0.0, row.last_od or 0.0, row.id or 0.0
    if end == od:
        return [(length, length * _polar(row), 1)]
    step = length / TAPER_SLICES
    found = []
    for i in range(TAPER_SLICES):
        areas = [
            math.pi * (fourth(od + (end - od) * (i + at) / TAPER_SLICES) - fourth(bore)) / 32.0
            for at, _ in GAUSS
        ]
        weights = [step * weight for _, weight in GAUSS]
        found.append(
            (
                _polar(row) * total(w / area for w, area in zip(weights, areas, strict=True)),
                total(w * area for w, area in zip(weights, areas, strict=True)),
                TAPER_SLICES,
            )
        )
    return found


def plain_twist(row: SectionRow, modulus: float) -> float:
    """Compliance of the cylinder or taper alone, without hub, keyway and steps.

    Parameters
    ----------
    row : SectionRow
        The section. [SI]
    modulus : float
        Shear modulus. [Pa]

    Returns
    -------
    float
        Compliance. [rad/(N m)]
    """
    return total(twist for twist, _, _ in _slices(row)) / (modulus * _polar(row))


def torsion_constant(row: SectionRow) -> float:
    """Torsion constant of the cross-section, keyway included. [m⁴]

    Parameters
    ----------
    row : SectionRow
        The section. [SI]

    Returns
    -------
    float
        π (D⁴ − d⁴) / 32 less what the keyway takes of the solid section; not positive where that is too much. [m⁴]
    """
    od = row.od or 0.0
    if not row.keyway_width or not row.keyway_depth:
        return _polar(row)
    loss = keyway_loss(row.keyway_width / od, row.keyway_depth / od)
    return _polar(row) - loss * math.pi * fourth(od) / 32.0


def _polar(row: SectionRow) -> float:
    """Polar second moment of area. [m⁴]"""
    return math.pi * (fourth(row.od or 0.0) - fourth(row.id or 0.0)) / 32.0


def _added_lengths(rows: Sequence[SectionRow], lengths: Sequence[float]) -> list[float]:
    """What the steps add to the effective length of each section, in lengths of its own diameter. [m]

    A step lets the thicker section twist over λ like the thinner one. At most its whole length does: a thin collar
    is no stiffer than the shaft it sits on.
    """
    steps: list[
        tuple[int, float, float]
    ] = []  # thicker section, λ, twist of the step over torque and 1/G
    for i, (a, b) in enumerate(pairwise(rows)):
        ends = ((a.last_od or 0.0, a.id or 0.0, i), (b.od or 0.0, b.id or 0.0, i + 1))
        (thin, bore, _), (thick, other, at) = sorted(ends)
        if thin == thick:
            continue
        length = thin * step_length(thick / thin, (a.fillet or 0.0) / thin, bore / thin)
        polar = [
            math.pi * (fourth(od) - fourth(d)) / 32.0 for od, d in ((thin, bore), (thick, other))
        ]
        steps.append((at, length, length * max(0.0, 1.0 / polar[0] - 1.0 / polar[1])))
    reach = [0.0] * len(rows)
    for at, length, _ in steps:
        reach[at] += length
    added = [0.0] * len(rows)
    for at, _, twist in steps:
        held = min(1.0, lengths[at] / reach[at]) if reach[at] else 0.0
        added[at] += held * twist * _polar(rows[at])
    return added
