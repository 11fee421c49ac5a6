"""Checks of the sections that stepped shafts are made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from engine.case.checks.problem import (
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    Cells,
    Limit,
    check_names,
    each_row,
    quote_quantity,
)
from engine.case.checks.train import DIAMETER, typed_geometry
from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, SectionRow, value_of
from engine.case.steels import steel_named
from engine.errors import Problem

TABLE = "Sections"
#: Up to which the loss of stiffness by a keyway is known, over the diameter; see `keyway_loss`. [1]
WIDEST_KEYWAY, DEEPEST_KEYWAY = 0.35, 0.2
#: Change of diameter over length up to which a taper twists like its slices, within 4 %. [1]
STEEPEST = 0.5
SECTION_NUMBERS = (
    Limit("Length", POSITIVE, "m"),
    Limit("OD", DIAMETER, "m"),
    Limit("End OD", DIAMETER, "m"),
    Limit("ID", NOT_NEGATIVE, "m"),
    Limit("Fillet", NOT_NEGATIVE, "m"),
    Limit("Keyway width", POSITIVE, "m"),
    Limit("Keyway depth", POSITIVE, "m"),
    Limit(
        "Penetration",
        Allowed(lambda v: 0.0 < v <= 1.0, "above 0 and at most 1 (100 %)"),
        "",
        "It is the share of the section's length that twists: one third inside a hub, blank outside.",
    ),
)


MATERIAL_NUMBERS = (
    Limit("Shear modulus", POSITIVE, "Pa"),
    Limit(
        "Density", NOT_NEGATIVE, "kg/m³", "Type 0 for sections that have no inertia of their own."
    ),
)


def check_sections(case: CaseData) -> Iterator[Problem]:
    """Sections of known elements, each with its dimensions, and steps as their fillets say."""
    elements = {e.element: e for e in case.elements if e.element}
    materials = {m.material for m in case.section_materials if m.material}
    yield from _materials(case)
    own: dict[str, list[tuple[Cells, SectionRow]]] = {}
    unusable: set[int | None] = set()
    for cells, row in each_row(TABLE, case.sections):
        yield from _element(cells, row, elements)
        for limit in SECTION_NUMBERS[:2]:
            if value_of(row, limit.column) is None:
                yield cells.blank(limit.column, "positive", "Fill it or clear the whole row.")
        wrong = list(cells.numbers(row, SECTION_NUMBERS))
        yield from wrong
        if row.material and steel_named(row.material) is None:
            yield from cells.name("Material", row.material, materials, "SectionMaterials")
        if row.element in elements:
            own.setdefault(str(row.element), []).append((cells, row))
        if wrong:  # what follows from them is not said as well
            unusable.add(cells.row)
            continue
        thinnest = min(row.od or 0.0, row.last_od or 0.0)
        if thinnest and row.id and row.id >= thinnest:
            yield _larger(
                cells,
                row,
                "ID",
                row.id,
                "below the outer diameter",
                thinnest,
                "Correct one of them.",
            )
        if row.length and abs((row.last_od or 0.0) - (row.od or 0.0)) > STEEPEST * row.length:
            yield cells.wrong(
                "End OD",
                row.end_od,
                f"such that the diameter changes by at most {STEEPEST:g} of the length",
                "A steeper taper twists like a step: type it as one.",
                "m",
            )
        yield from _keyway(cells, row)
    for rows in own.values():
        yield from _names(rows)
        yield from _fillets([(None if c.row in unusable else c, row) for c, row in rows])
    yield from _said_twice(case, set(own))


def _larger(
    cells: Cells, row: SectionRow, column: str, value: float, words: str, limit: float, action: str
) -> Problem:
    """A dimension that another one of the row does not leave room for."""
    quoted = (
        quote_quantity(limit, "m", (*cells, "OD"))
        if limit == row.od
        else quote_quantity(limit, "m")
    )
    return cells.wrong(column, value, f"{words} {limit:.6g} m", action, "m", quoted)


def _materials(case: CaseData) -> Iterator[Problem]:
    table, rows = "SectionMaterials", case.section_materials
    yield from check_names(table, "Material", [m.material for m in rows], "a material")
    for cells, m in each_row(table, rows):
        for limit in MATERIAL_NUMBERS:
            if value_of(m, limit.column) is None:
                yield cells.blank(
                    limit.column, limit.allowed.words, "Fill it or clear the whole row."
                )
        yield from cells.numbers(m, MATERIAL_NUMBERS)


def _element(
    cells: Cells, row: SectionRow, elements: Mapping[str, ElementRow]
) -> Iterator[Problem]:
    yield from cells.name("Element", row.element, elements, "Elements")
    e = elements.get(row.element or "")
    if e is not None and e.kind == ElementKind.GEAR_MESH:
        yield cells.wrong(
            "Element",
            row.element,
            "a shaft, a coupling or a spring to ground",
            "A gear mesh has no shaft sections; give them to the shaft beside it.",
        )


def _keyway(cells: Cells, row: SectionRow) -> Iterator[Problem]:
    width, depth, od = row.keyway_width, row.keyway_depth, row.od
    pair = (("Keyway width", width, depth), ("Keyway depth", depth, width))
    for column, value, other in pair:
        if value is None and other is not None:
            action = "A keyway has a width and a depth. Type both or clear both."
            yield cells.blank(column, "positive", action)
    if not od or not width or not depth:
        return
    if row.last_od != od:
        yield cells.wrong(
            "Keyway width",
            width,
            "blank in a tapered section",
            "Cut the keyed part into cylinders of their mean diameters.",
            "m",
        )
    known = "The stiffness of a shaft with a larger keyway is not known; leave it blank and type the stiffness."
    for (column, value, _), share in zip(pair, (WIDEST_KEYWAY, DEEPEST_KEYWAY), strict=True):
        if value and value > share * od:
            words = f"at most {share:g} of the outer diameter,"
            yield _larger(cells, row, column, value, words, share * od, known)
    wall = 0.5 * (od - (row.id or 0.0))
    if depth >= wall > 0.0:
        yield _larger(
            cells,
            row,
            "Keyway depth",
            depth,
            "less than the wall,",
            wall,
            "Correct the depth or the bore.",
        )


def _names(rows: list[tuple[Cells, SectionRow]]) -> Iterator[Problem]:
    """Sections of an element have different names; a blank one is its number."""
    first: dict[str, int | None] = {}
    for number, (cells, row) in enumerate(rows, start=1):
        name = row.section or str(number)
        if name in first:
            allowed = f"a name used once in an element (row {first[name]} has it already)"
            yield cells.wrong("Section", name, allowed, "Rename one of the two.")
        first.setdefault(name, cells.row)


def _fillets(rows: list[tuple[Cells | None, SectionRow]]) -> Iterator[Problem]:
    """A fillet stands at a step to the next section, and fits it; rows with wrong numbers have no cells."""
    for (cells, row), (beside, after) in pairwise(rows):
        if cells is None or beside is None or not row.fillet or not row.last_od or not after.od:
            continue
        step = 0.5 * abs(after.od - row.last_od)
        if step == 0.0:
            yield cells.wrong(
                "Fillet",
                row.fillet,
                "blank where the next section has the same diameter",
                "The fillet is that of the step to the next row.",
                "m",
            )
        elif row.fillet > step * (1.0 + 1e-9):
            yield _larger(
                cells,
                row,
                "Fillet",
                row.fillet,
                "at most the height of the step to the next row,",
                step,
                "Correct it, or the diameters beside it.",
            )
    cells, last = rows[-1]
    if cells is not None and last.fillet:
        yield cells.wrong(
            "Fillet",
            last.fillet,
            "blank in the last section of an element",
            "The fillet is that of the step to the next row.",
            "m",
        )


def _said_twice(case: CaseData, stepped: set[str]) -> Iterator[Problem]:
    """Elements whose geometry stands in table Elements as well."""
    for cells, e in each_row("Elements", case.elements):
        if e.element not in stepped or e.kind == ElementKind.GEAR_MESH:
            continue
        yield from typed_geometry(
            cells,
            e,
            "blank where table Sections has rows of the element",
            "Its sections state the geometry: clear it, or clear these rows of Sections.",
        )
