"""Checks of materials, their S-N points, and the factors on the strength of shafts."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from engine.case.checks.problem import (
    POSITIVE,
    Allowed,
    Cells,
    Limit,
    check_names,
    each_row,
    probably_meant,
    quote_quantity,
)
from engine.case.choices import (
    BelowEndurance,
    MeanStress,
    NotchKind,
    NotchSensitivity,
    SizeRule,
    SNBasis,
    SurfaceFinish,
)
from engine.case.data import CaseData, ElementRow, FatigueFactorRow, MaterialRow
from engine.case.fatigue_tables import (
    FILLET_STEPS,
    KEYWAY_DEPTH,
    KEYWAY_DIAMETER,
    KEYWAY_RADII,
    NEUBER_UTS,
    PETERSON_UTS,
    RELIABILITIES,
    SIZE_DIAMETERS,
    SURFACE_UTS,
    tabled_reliability,
)
from engine.case.notches import NotchGeometry, notch_geometry
from engine.errors import Problem

STRENGTHS = tuple(Limit(column, POSITIVE, "Pa") for column in ("UTS", "Yield", "Endurance"))
SHARE = Allowed(lambda v: 0.0 < v <= 1.0, "above 0 and at most 1 (100 %)")
FACTOR_NUMBERS = (
    Limit("Notch radius", POSITIVE, "m"),
    Limit("Shoulder diameter", POSITIVE, "m"),
    Limit("Notch sensitivity", Allowed(lambda v: 0.0 <= v <= 1.0, "from 0 to 1, or a formula")),
    Limit("Surface", SHARE, "", "A factor lowers the strength; or choose a finish."),
    Limit("Size", SHARE, "", "A factor lowers the strength; or choose by diameter."),
    Limit("Reliability", SHARE, "", "Write 99 % or 0.99."),
)
#: What to do where a published number does not reach.
_TYPE_SCF = "Clear Notch and type the stress concentration as SCF in table Elements."
POINT_NUMBERS = (Limit("Cycles", POSITIVE), Limit("Stress", POSITIVE, "Pa"))


def check_materials(case: CaseData) -> Iterator[Problem]:
    """Strengths and words of each material."""
    table = "Materials"
    yield from check_names(table, "Material", [m.material for m in case.materials], "a material")
    for cells, m in each_row(table, case.materials):
        yield from cells.numbers(m, STRENGTHS)
        if m.uts and m.yield_ and m.yield_ > m.uts > 0:
            yield cells.wrong("Yield", m.yield_, "at most UTS", "Correct one of them.", "Pa")
        yield from cells.choice("Basis", m.basis, SNBasis, "torsion or bending")
        yield from cells.choice(
            "Below endurance", m.below_endurance, BelowEndurance, "none, same slope or 2k-1"
        )


def check_sn_points(case: CaseData) -> Iterator[Problem]:
    """S-N points: known materials, lines that fall, endurance at or below the lowest stress."""
    materials = {m.material for m in case.materials if m.material}
    curves: dict[str, list[tuple[Cells, float, float]]] = {}
    for cells, p in each_row("SNPoints", case.sn_points):
        yield from cells.name("Material", p.material, materials, "Materials")
        for limit, value in zip(POINT_NUMBERS, (p.cycles, p.stress), strict=True):
            if value is None:
                yield cells.blank(limit.column, "positive", "Fill it or clear the whole row.")
            yield from cells.number(value, limit)
        if p.material and p.cycles and p.stress and p.cycles > 0 and p.stress > 0:
            curves.setdefault(p.material, []).append((cells, p.cycles, p.stress))
    misspelt = probably_meant((p.material for p in case.sn_points), materials)
    for material, points in curves.items():
        for (_, n0, s0), (cells, n1, s1) in pairwise(points):
            if n1 <= n0 or s1 >= s0:
                yield cells.wrong(
                    "Cycles" if n1 <= n0 else "Stress",
                    n1 if n1 <= n0 else s1,
                    "such that cycles rise and stress falls from row to row",
                    f"The S-N line of '{material}' must fall with rising cycles; order its rows "
                    "from few cycles to many.",
                )
        alone = len(points) == 1 and sum(p.material == material for p in case.sn_points) == 1
        if alone and material not in misspelt:
            yield points[0][0].problem(
                "Material",
                material,
                "two or more points",
                f"'{material}' has one S-N point only; a line needs two. Add a point or clear the "
                "row.",
            )
        own = (
            pair for pair in each_row("Materials", case.materials) if pair[1].material == material
        )
        cells, m = next(own, (Cells("Materials"), MaterialRow()))
        if m.endurance and m.endurance > points[-1][2] * (1 + 1e-9) and len(points) > 1:
            yield cells.wrong(
                "Endurance",
                m.endurance,
                f"at most the lowest S-N stress of '{material}' ({points[-1][2]:.6g} Pa)",
                "Correct it, or drop the S-N points below the endurance limit.",
                "Pa",
            )


def check_fatigue_factors(case: CaseData) -> Iterator[Problem]:
    """Notches within the range of their formulas, factors of known shafts, and the UTS that they need."""
    table, rows = "FatigueFactors", case.fatigue_factors
    elements = {e.element: e for e in case.elements if e.element}
    materials = {m.material: m for m in case.materials if m.material}
    yield from check_names(table, "Element", [row.element for row in rows], "an element")
    for cells, row in each_row(table, rows):
        if row.element is not None:
            yield from cells.name("Element", row.element, elements, "Elements")
        yield from cells.choice("Notch", row.notch, NotchKind, "fillet or keyway")
        wrong = [*cells.numbers(row, FACTOR_NUMBERS), *_factor_words(cells, row)]
        yield from wrong
        if (
            row.reliability is not None
            and not wrong
            and tabled_reliability(row.reliability) is None
        ):
            entries = ", ".join(f"{100.0 * r:.6g}" for r in RELIABILITIES)
            yield cells.wrong(
                "Reliability", row.reliability, f"one of {entries} %", "The table has no others."
            )
        element = elements.get(row.element or "")
        if element is None or wrong:
            continue
        if not element.stress_diameter:
            yield cells.wrong(
                "Element",
                row.element,
                "an element with Stress diameter",
                "Type its Stress diameter in table Elements, or clear this row.",
            )
            continue
        yield from _notch(cells, row, element, case)
        yield from _strength(cells, row, element, materials.get(element.material or ""))
    yield from _goodman(case)


def _factor_words(cells: Cells, row: FatigueFactorRow) -> Iterator[Problem]:
    """Words in the place of numbers."""
    for column, value, words in (
        ("Notch sensitivity", row.notch_sensitivity, NotchSensitivity),
        ("Surface", row.surface, SurfaceFinish),
        ("Size", row.size, SizeRule),
    ):
        if isinstance(value, str):
            allowed = "a number, or one of " + ", ".join(words)
            yield from cells.choice(column, value, words, allowed)


def _outside(
    cells: Cells, column: str, value: float, limits: tuple[float, float], what: str, action: str
) -> Iterator[Problem]:
    """A length that is outside of the range of a formula."""
    low, high = limits
    rounding = 1e-9
    if low * (1.0 - rounding) <= value <= high * (1.0 + rounding):
        return
    words = f"from {low:.6g} m to {high:.6g} m ({what})"
    quoted = (*quote_quantity(low, "m"), *quote_quantity(high, "m"))
    yield cells.wrong(column, value, words, action, "m", quoted)


def _notch(
    cells: Cells, row: FatigueFactorRow, element: ElementRow, case: CaseData
) -> Iterator[Problem]:
    """Geometry of the notch: there, of a solid shaft, within the range of the formula."""
    sections = [s for s in case.sections if s.element == element.element]
    notch = notch_geometry(element, row, sections)
    if row.notch is None:
        if isinstance(row.notch_sensitivity, str) and row.notch_radius is None:
            yield cells.blank("Notch radius", "positive", "The notch sensitivity depends on it.")
        return
    if row.notch not in tuple(NotchKind):
        return
    if element.scf is not None:
        yield cells.wrong(
            "Notch",
            row.notch,
            "blank where SCF of table Elements is typed",
            "Both state the stress concentration: clear one of them.",
        )
    if element.stress_bore:
        yield cells.wrong(
            "Notch",
            row.notch,
            "blank where Stress bore is typed",
            f"The formulas are of solid shafts. {_TYPE_SCF}",
        )
    yield from _fillet(cells, notch) if row.notch == NotchKind.FILLET else _keyway(cells, notch)


def _fillet(cells: Cells, notch: NotchGeometry) -> Iterator[Problem]:
    steps = (
        f"Table Sections has {notch.steps} different steps at the Stress diameter: type radius and shoulder here."
        if notch.steps > 1
        else "Table Sections has none at the Stress diameter: type it here."
    )
    for column, value in (
        ("Shoulder diameter", notch.shoulder),
        ("Notch radius", notch.radius),
    ):
        if value is None:
            yield cells.blank(column, "positive", steps)
    if notch.shoulder is None:
        return
    if notch.shoulder <= notch.diameter:
        yield cells.wrong(
            "Shoulder diameter",
            notch.shoulder,
            f"above the Stress diameter {notch.diameter:.6g} m",
            "The stress is that of the thinner shaft, beside the fillet.",
            "m",
            quote_quantity(notch.diameter, "m"),
        )
    elif notch.radius is not None:
        height, (low, high) = 0.5 * (notch.shoulder - notch.diameter), FILLET_STEPS
        what = f"{1.0 / high:.4g} to {1.0 / low:.4g} of the height of the step"
        limits = height / high, height / low
        yield from _outside(cells, "Notch radius", notch.radius, limits, what, _TYPE_SCF)


def _keyway(cells: Cells, notch: NotchGeometry) -> Iterator[Problem]:
    d, (low, high) = notch.diameter, KEYWAY_RADII
    if notch.radius is None:
        yield cells.blank("Notch radius", "positive", "It is that at the bottom of the keyway.")
    else:
        what = f"{low:g} to {high:g} of the diameter"
        yield from _outside(
            cells, "Notch radius", notch.radius, (low * d, high * d), what, _TYPE_SCF
        )
    if d > KEYWAY_DIAMETER:
        yield cells.wrong(
            "Notch",
            NotchKind.KEYWAY.value,
            f"blank above a Stress diameter of {KEYWAY_DIAMETER:.6g} m",
            f"The stress concentration of keyways is known up to 6.5 in. {_TYPE_SCF}",
            "",
            quote_quantity(KEYWAY_DIAMETER, "m"),
        )
    if notch.depth is not None and notch.depth > KEYWAY_DEPTH * d:
        yield cells.wrong(
            "Notch",
            NotchKind.KEYWAY.value,
            "blank where Keyway depth of table Sections is more than an eighth of the diameter",
            f"The stress concentration of deeper keyways is not known. {_TYPE_SCF}",
        )


def _strength(
    cells: Cells, row: FatigueFactorRow, element: ElementRow, material: MaterialRow | None
) -> Iterator[Problem]:
    """Diameter and UTS within the range of the factors chosen by word."""
    if row.size == SizeRule.BY_DIAMETER:
        low, high = SIZE_DIAMETERS
        if not low <= (element.stress_diameter or 0.0) <= high:
            yield cells.wrong(
                "Size",
                row.size,
                f"a number for a Stress diameter outside {low:.6g} m to {high:.6g} m",
                "The published size factor ends there; type one.",
                "",
                (*quote_quantity(low, "m"), *quote_quantity(high, "m")),
            )
    ranges: dict[str, tuple[float, float]] = {
        NotchSensitivity.NEUBER: NEUBER_UTS,
        NotchSensitivity.PETERSON: PETERSON_UTS,
        **dict.fromkeys(SurfaceFinish, SURFACE_UTS),
    }
    for column, word in (("Notch sensitivity", row.notch_sensitivity), ("Surface", row.surface)):
        if not isinstance(word, str):
            continue
        low, high = ranges[word]
        uts = None if material is None else material.uts
        if uts is None or not low <= uts <= high:
            found = "its Material has no UTS" if uts is None else f"UTS is {uts:.6g} Pa"
            yield cells.problem(
                column,
                word,
                f"a number, or a word with UTS from {low:.6g} Pa to {high:.6g} Pa",
                f"{found}; '{word}' needs UTS from {low:.6g} Pa to {high:.6g} Pa. Type UTS in table Materials, or a "
                "number here.",
                (
                    *(quote_quantity(uts, "Pa") if uts is not None else ()),
                    *quote_quantity(low, "Pa"),
                    *quote_quantity(high, "Pa"),
                ),
            )


def _goodman(case: CaseData) -> Iterator[Problem]:
    """The ultimate strength that Goodman's line ends at."""
    if case.mean_stress != MeanStress.GOODMAN:
        return
    judged = {e.material for e in case.elements if e.stress_diameter}
    with_points = {p.material for p in case.sn_points} & judged
    for cells, m in each_row("Materials", case.materials):
        if m.material in with_points and m.uts is None:
            yield cells.blank("UTS", "positive", "MeanStress is Goodman, which needs it.")
