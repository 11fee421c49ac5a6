"""Checks of materials and their S-N points."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from engine.case.checks.problem import MATERIAL_NAME, POSITIVE, Cells, Limit, check_names, each_row
from engine.case.choices import BelowEndurance, SNBasis
from engine.case.data import CaseData, MaterialRow
from engine.errors import Problem

STRENGTHS = tuple(Limit(column, POSITIVE, "Pa") for column in ("UTS", "Yield", "Endurance"))
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
        yield from cells.name("Material", p.material, materials, MATERIAL_NAME)
        for limit, value in zip(POINT_NUMBERS, (p.cycles, p.stress), strict=True):
            if value is None:
                yield cells.blank(limit.column, "positive", "Fill it or clear the whole row.")
            yield from cells.number(value, limit)
        if p.material and p.cycles and p.stress and p.cycles > 0 and p.stress > 0:
            curves.setdefault(p.material, []).append((cells, p.cycles, p.stress))
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
        if len(points) == 1 and sum(p.material == material for p in case.sn_points) == 1:
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
