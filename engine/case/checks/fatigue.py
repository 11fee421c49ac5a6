"""Checks of materials and their S-N points."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from engine.case.checks.problem import (
    POSITIVE,
    blank_cell,
    check_names,
    check_number,
    suggestion,
    wrong_value,
)
from engine.case.choices import BelowEndurance, SNBasis
from engine.case.data import CaseData
from engine.errors import Problem


def check_materials(case: CaseData) -> Iterator[Problem]:
    """Strengths and words of each material."""
    table = "Materials"
    yield from check_names(table, "Material", [m.material for m in case.materials], "a material")
    for row, m in enumerate(case.materials, start=1):
        for column, value in (("UTS", m.uts), ("Yield", m.yield_), ("Endurance", m.endurance)):
            yield from check_number(table, row, column, value, POSITIVE, "Pa")
        if m.uts and m.yield_ and m.yield_ > m.uts > 0:
            yield wrong_value(
                table, row, "Yield", m.yield_, "at most UTS", "Correct one of them.", "Pa"
            )
        if m.basis not in (None, *SNBasis):
            yield wrong_value(
                table, row, "Basis", m.basis, "torsion or bending", "Choose from the list."
            )
        if m.below_endurance not in (None, *BelowEndurance):
            yield wrong_value(
                table,
                row,
                "Below endurance",
                m.below_endurance,
                "none, same slope or 2k-1",
                "Choose from the list.",
            )


def check_sn_points(case: CaseData) -> Iterator[Problem]:
    """S-N points: known materials, lines that fall, endurance at or below the lowest stress."""
    table = "SNPoints"
    materials = {m.material for m in case.materials if m.material}
    curves: dict[str, list[tuple[int, float, float]]] = {}
    for row, p in enumerate(case.sn_points, start=1):
        if p.material is None:
            yield blank_cell(table, row, "Material", "a material of table Materials", "Choose it.")
        elif p.material not in materials:
            yield wrong_value(
                table,
                row,
                "Material",
                p.material,
                "a material of table Materials",
                suggestion(p.material, materials),
            )
        for column, value, unit in (("Cycles", p.cycles, ""), ("Stress", p.stress, "Pa")):
            if value is None:
                yield blank_cell(table, row, column, "positive", "Fill it or clear the whole row.")
            yield from check_number(table, row, column, value, POSITIVE, unit)
        if p.material and p.cycles and p.stress and p.cycles > 0 and p.stress > 0:
            curves.setdefault(p.material, []).append((row, p.cycles, p.stress))
    for material, points in curves.items():
        for (_, n0, s0), (row, n1, s1) in pairwise(points):
            if n1 <= n0 or s1 >= s0:
                column = "Cycles" if n1 <= n0 else "Stress"
                yield wrong_value(
                    table,
                    row,
                    column,
                    n1 if n1 <= n0 else s1,
                    "such that cycles rise and stress falls from row to row",
                    f"The S-N line of '{material}' must fall; order its rows from few cycles to "
                    "many.",
                )
        if len(points) == 1 and sum(p.material == material for p in case.sn_points) == 1:
            yield Problem(
                table,
                points[0][0],
                "Material",
                material,
                "two or more points",
                f"'{material}' has one S-N point only; a line needs two. Add a point or clear the "
                "row.",
            )
        endurance = next((m.endurance for m in case.materials if m.material == material), None)
        row = next((i for i, m in enumerate(case.materials, start=1) if m.material == material), 1)
        if endurance and endurance > points[-1][2] * (1 + 1e-9) and len(points) > 1:
            yield wrong_value(
                "Materials",
                row,
                "Endurance",
                endurance,
                f"at most the lowest S-N stress of '{material}' ({points[-1][2]:.6g} Pa)",
                "Correct it, or drop the S-N points below the endurance limit.",
                "Pa",
            )
