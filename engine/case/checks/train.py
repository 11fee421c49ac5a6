"""Checks of stations, elements and modal damping: names, stiffness, and one open train."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    BELOW_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    blank_cell,
    check_names,
    check_number,
    quote_quantity,
    suggestion,
    wrong_value,
)
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, ElementRow
from engine.errors import Problem

KINDS = tuple(ElementKind)


def check_stations(case: CaseData) -> Iterator[Problem]:
    """Names, inertias and speed ratios of the stations."""
    table = "Stations"
    if not case.stations:
        yield Problem(
            table,
            None,
            "",
            None,
            "at least one station",
            "the table is empty; a train needs at least one station with its inertia.",
        )
    yield from check_names(table, "Station", [s.station for s in case.stations], "a station")
    shafted = {name for e in case.elements if e.density for name in (e.from_, e.to)}
    for row, s in enumerate(case.stations, start=1):
        if s.station and s.station.lower() == GROUND:
            yield wrong_value(
                table,
                row,
                "Station",
                s.station,
                "another word: 'ground' means a fixed end",
                "Rename the station.",
            )
        if s.inertia is None and s.station not in shafted:
            yield blank_cell(
                table,
                row,
                "Inertia",
                "positive",
                "Type it, or give a shaft at this station a Density so that its own inertia "
                "counts.",
            )
        zero_allowed = s.station in shafted
        yield from check_number(
            table,
            row,
            "Inertia",
            s.inertia,
            NOT_NEGATIVE if zero_allowed else POSITIVE,
            "kg m²",
            "Every station needs inertia; join two shafts of a massless point into one stiffness.",
        )
        yield from check_number(table, row, "Running load", s.running_load, ANY_NUMBER, "N m")
        yield from check_number(
            table,
            row,
            "Speed ratio",
            s.speed_ratio,
            Allowed(POSITIVE.holds, "positive (blank = 1)"),
        )
        yield from check_number(table, row, "Damping", s.damping, NOT_NEGATIVE, "N m s/rad")


def _ends(case: CaseData, row: int, e: ElementRow) -> Iterator[Problem]:
    """From and To: present, known, different, at most one of them ground."""
    stations = {s.station for s in case.stations if s.station}
    for column, name in (("From", e.from_), ("To", e.to)):
        if name is None:
            if column == "To" and e.kind == ElementKind.SPRING_TO_GROUND:
                continue
            yield blank_cell("Elements", row, column, "a station of table Stations", "Choose it.")
        elif name != GROUND and name not in stations:
            yield wrong_value(
                "Elements",
                row,
                column,
                name,
                "a station of table Stations or the word ground",
                suggestion(name, stations | {GROUND}),
            )
    if e.from_ is not None and e.from_ == e.to:
        yield wrong_value(
            "Elements",
            row,
            "To",
            e.to,
            "another station than From",
            "An element joins two stations.",
        )
    if (
        e.kind == ElementKind.SPRING_TO_GROUND
        and GROUND not in (e.from_, e.to)
        and e.to is not None
    ):
        yield wrong_value(
            "Elements", row, "To", e.to, "ground", "A spring to ground has ground at one end."
        )
    for column, name in (("From", e.from_), ("To", e.to)):
        if e.kind == ElementKind.GEAR_MESH and name == GROUND:
            yield wrong_value(
                "Elements", row, column, GROUND, "a station", "A gear mesh joins two gears."
            )


def _geometry(row: int, e: ElementRow) -> Iterator[Problem]:
    """Stiffness, or everything it is computed from."""
    table = "Elements"
    for column, value, unit in (
        ("OD", e.od, "m"),
        ("Length", e.length, "m"),
        ("Shear modulus", e.shear_modulus, "Pa"),
        ("Density", e.density, "kg/m³"),
        ("Stress diameter", e.stress_diameter, "m"),
        ("SCF", e.scf, ""),
        ("Rated torque", e.rated_torque, "N m"),
        ("Peak torque limit", e.peak_torque_limit, "N m"),
        ("Vibratory limit", e.vibratory_limit, "N m"),
    ):
        yield from check_number(table, row, column, value, POSITIVE, unit)
    for column, value, unit in (
        ("ID", e.id, "m"),
        ("Stress bore", e.stress_bore, "m"),
        ("Damping", e.damping, "N m s/rad"),
        ("Loss factor", e.loss_factor, ""),
        ("Reversal limit", e.reversal_limit, "N m"),
    ):
        yield from check_number(table, row, column, value, NOT_NEGATIVE, unit)
    if e.scf is not None and 0 < e.scf < 1:
        yield wrong_value(table, row, "SCF", e.scf, "1 or more", "A notch never lowers the stress.")
    for outer, inner, column, outside in (
        (e.od, e.id, "ID", "OD"),
        (e.stress_diameter, e.stress_bore, "Stress bore", "Stress diameter"),
    ):
        if outer and inner and inner >= outer:
            yield wrong_value(
                table,
                row,
                column,
                inner,
                f"below the outer diameter {outer:.6g} m",
                "Correct one of them.",
                "m",
                quote_quantity(outer, "m", (table, row, outside)),
            )
    yield from _stiffness(row, e)


def _stiffness(row: int, e: ElementRow) -> Iterator[Problem]:
    table = "Elements"
    if e.stiffness is not None:
        damped = bool(e.damping)
        yield from check_number(
            table,
            row,
            "Stiffness",
            e.stiffness,
            Allowed(
                (NOT_NEGATIVE if damped else POSITIVE).holds,
                "positive (0 only where Damping is given)",
            ),
            "N m/rad",
            "Correct it, or leave it blank: a shaft is computed from OD, ID and Length, a gear "
            "mesh is rigid.",
        )
    elif e.kind in ("shaft", "coupling", ElementKind.SPRING_TO_GROUND):
        absent = [
            name
            for name, value in (
                ("OD", e.od),
                ("Length", e.length),
                ("Shear modulus", e.shear_modulus),
            )
            if value is None
        ]
        if absent:
            yield Problem(
                table,
                row,
                "Stiffness",
                None,
                "a stiffness, or OD, Length and Shear modulus",
                "the stiffness is blank and cannot be computed: "
                + ", ".join(absent)
                + (" are" if len(absent) > 1 else " is")
                + " blank too. Type a stiffness or the geometry.",
            )
    shaft = e.kind != ElementKind.GEAR_MESH
    if shaft and e.density is not None and (e.od is None or e.length is None):
        yield Problem(
            table,
            row,
            "Density",
            e.density,
            "used with OD and Length",
            "a density is given but OD or Length is blank: the shaft's own inertia cannot be "
            "computed. Type the geometry or clear the density.",
        )


def check_elements(case: CaseData) -> Iterator[Problem]:
    """Kinds, ends, stiffnesses and materials of the elements."""
    table = "Elements"
    yield from check_names(table, "Element", [e.element for e in case.elements], "an element")
    ratios = {s.station: (1.0 if s.speed_ratio is None else s.speed_ratio) for s in case.stations}
    materials = {m.material for m in case.materials if m.material}
    for row, e in enumerate(case.elements, start=1):
        if e.kind is None:
            yield blank_cell(
                table, row, "Kind", "one of " + ", ".join(KINDS), "Choose from the list."
            )
        elif e.kind not in KINDS:
            yield wrong_value(
                table, row, "Kind", e.kind, "one of " + ", ".join(KINDS), "Choose from the list."
            )
        yield from _ends(case, row, e)
        yield from _geometry(row, e)
        a, b = ratios.get(e.from_), ratios.get(e.to)
        if e.kind in ("shaft", "coupling") and a and b and abs(a / b - 1.0) > 1e-9:
            yield Problem(
                table,
                row,
                "To",
                e.to,
                "a station of the same speed ratio as From",
                f"'{e.from_}' has speed ratio {a:.9g} and '{e.to}' {b:.9g}, but a {e.kind} joins "
                "stations of equal speed. Correct the speed ratios in table Stations, or make it "
                "a gear mesh.",
            )
        yield from _rigid_or_shaft(row, e)
        if e.material and e.material not in materials:
            yield wrong_value(
                table,
                row,
                "Material",
                e.material,
                "a material of table Materials",
                suggestion(e.material, materials),
            )
        if e.material and e.stress_diameter is None:
            yield Problem(
                table,
                row,
                "Stress diameter",
                None,
                "positive where a material is named",
                "a material is named but the stress diameter is blank: no stress can be judged. "
                "Type the diameter or clear the material.",
            )


def _rigid_or_shaft(row: int, e: ElementRow) -> Iterator[Problem]:
    """What a gear mesh cannot have."""
    if e.kind != ElementKind.GEAR_MESH:
        return
    for column, value, unit in (
        ("OD", e.od, "m"),
        ("ID", e.id, "m"),
        ("Length", e.length, "m"),
        ("Shear modulus", e.shear_modulus, "Pa"),
        ("Density", e.density, "kg/m³"),
    ):
        if value is not None:
            yield wrong_value(
                "Elements",
                row,
                column,
                value,
                "blank for a gear mesh",
                "A mesh has no shaft geometry: a blank Stiffness means rigid, and the gears' "
                "inertias belong to their stations.",
                unit,
            )


def check_connected(case: CaseData) -> Iterator[Problem]:
    """One train, no closed circuit."""
    names = [s.station for s in case.stations if s.station]
    root = {name: name for name in names}

    def find(name: str) -> str:
        while root[name] != name:
            root[name] = root[root[name]]
            name = root[name]
        return name

    joined: dict[frozenset[str], tuple[int, str | None]] = {}
    for row, e in enumerate(case.elements, start=1):
        if e.from_ not in root or e.to not in root or e.from_ is None or e.to is None:
            continue
        pair = frozenset((e.from_, e.to))
        a, b = find(e.from_), find(e.to)
        if a != b:
            root[a] = b
            joined.setdefault(pair, (row, e.kind))
        elif pair in joined and ElementKind.GEAR_MESH not in (e.kind, joined[pair][1]):
            continue  # side by side between the same two stations, a spring beside a damper
        else:
            yield Problem(
                "Elements",
                row,
                "Element",
                e.element,
                "part of an open train",
                f"'{e.element}' closes a circuit between '{e.from_}' and '{e.to}'. Closed gear "
                "circuits (split torque, double helix as two meshes) are not calculated: how "
                "they share torque depends on assembly. Join the parallel paths into one "
                "equivalent path.",
            )
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(find(name), []).append(name)
    if len(groups) > 1:
        main = max(groups.values(), key=len)
        for group in groups.values():
            if group is main:
                continue
            row = names.index(group[0]) + 1
            yield Problem(
                "Stations",
                row,
                "Station",
                group[0],
                "joined to the rest of the train",
                f"no element joins {', '.join(repr(n) for n in group)} to the rest of the train "
                f"({main[0]!r}, …). Add the missing shaft, coupling or mesh.",
            )


def check_mode_damping(case: CaseData) -> Iterator[Problem]:
    """Modes that are counted from 1, each once, with a damping ratio."""
    seen: dict[int, int] = {}
    for row, m in enumerate(case.mode_damping, start=1):
        if m.mode is None:
            yield blank_cell(
                "ModeDamping", row, "Mode", "the number of an elastic mode", "Count from 1."
            )
        elif m.mode < 1 or m.mode != int(m.mode):
            yield wrong_value(
                "ModeDamping",
                row,
                "Mode",
                m.mode,
                "a whole number, 1 or more",
                "The lowest elastic mode is 1.",
            )
        elif m.mode in seen:
            yield wrong_value(
                "ModeDamping",
                row,
                "Mode",
                m.mode,
                f"given once (row {seen[m.mode]})",
                "Clear one row.",
            )
        else:
            seen[m.mode] = row
        if m.damping_ratio is None:
            yield blank_cell(
                "ModeDamping", row, "Damping ratio", "at least 0 and below 1", "Type it."
            )
        yield from check_number(
            "ModeDamping",
            row,
            "Damping ratio",
            m.damping_ratio,
            BELOW_ONE,
        )
