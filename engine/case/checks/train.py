"""Checks of stations, elements and modal damping: names, stiffness, and one open train."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    AT_LEAST_ONE,
    BELOW_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    Cells,
    Limit,
    check_names,
    each_row,
    name_of,
    probably_meant,
    quote_quantity,
    suggestion,
)
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, ElementRow, value_of
from engine.errors import Problem

KINDS = tuple(ElementKind)
#: Diameters whose fourth power is a number; no shaft is near either end.
DIAMETER = Allowed(lambda v: 1e-6 <= v <= 1e6, "between 1e-6 and 1e6 m")
STATION_NUMBERS = (
    Limit("Running load", ANY_NUMBER, "N m"),
    Limit("Speed ratio", Allowed(POSITIVE.holds, "positive (blank = 1)")),
    Limit("Damping", NOT_NEGATIVE, "N m s/rad"),
)
ELEMENT_NUMBERS = (
    Limit("OD", DIAMETER, "m"),
    Limit("Length", POSITIVE, "m"),
    Limit("Shear modulus", POSITIVE, "Pa"),
    Limit("Density", POSITIVE, "kg/m³"),
    Limit("Stress diameter", DIAMETER, "m"),
    Limit("SCF", POSITIVE),
    Limit("Service factor", AT_LEAST_ONE),
    Limit("Rated torque", POSITIVE, "N m"),
    Limit("Peak torque limit", POSITIVE, "N m"),
    Limit("Vibratory limit", POSITIVE, "N m"),
    Limit("ID", NOT_NEGATIVE, "m"),
    Limit("Stress bore", NOT_NEGATIVE, "m"),
    Limit("Damping", NOT_NEGATIVE, "N m s/rad"),
    Limit("Loss factor", NOT_NEGATIVE),
    Limit("Reversal limit", NOT_NEGATIVE, "N m"),
)
#: What a shaft is computed from, and a gear mesh has not, with its unit.
SHAFT_GEOMETRY = {"OD": "m", "ID": "m", "Length": "m", "Shear modulus": "Pa", "Density": "kg/m³"}


def _stepped(case: CaseData) -> set[str]:
    """Elements with rows in table Sections, also under a wrong name that is like theirs."""
    names = {row.element for row in case.sections if row.element}
    return names | probably_meant(names, {e.element for e in case.elements if e.element})


def check_stations(case: CaseData) -> Iterator[Problem]:
    """Names, inertias and speed ratios of the stations."""
    table = "Stations"
    if not case.stations:
        yield Cells(table).problem(
            "",
            None,
            "at least one station",
            "the table is empty; a train needs at least one station with its inertia.",
        )
    yield from check_names(table, "Station", [s.station for s in case.stations], "a station")
    stepped = _stepped(case)
    shafted = {
        name for e in case.elements if e.density or e.element in stepped for name in (e.from_, e.to)
    }
    for cells, s in each_row(table, case.stations):
        if s.station and s.station.lower() == GROUND:
            allowed = "another word: 'ground' means a fixed end"
            yield cells.wrong("Station", s.station, allowed, "Rename the station.")
        if s.inertia is None and s.station not in shafted:
            yield cells.blank(
                "Inertia",
                "positive",
                "Type the inertia, or give a shaft at this station a Density or sections.",
            )
        allowed_inertia = NOT_NEGATIVE if s.station in shafted else POSITIVE
        action = (
            "Every station needs inertia; combine the two shafts at a massless station into one "
            "stiffness."
        )
        yield from cells.number(s.inertia, Limit("Inertia", allowed_inertia, "kg m²", action))
        yield from cells.numbers(s, STATION_NUMBERS)


def _ends(stations: set[str], cells: Cells, e: ElementRow) -> Iterator[Problem]:
    """From and To: present, known, different, at most one of them ground."""
    for column, name in (("From", e.from_), ("To", e.to)):
        if name is None:
            if column == "To" and e.kind == ElementKind.SPRING_TO_GROUND:
                continue
            yield cells.blank(column, name_of("Stations"), "Choose it.")
        elif name != GROUND and name not in stations:
            action = suggestion(name, stations | {GROUND})
            allowed = f"{name_of('Stations')} or the word ground"
            yield cells.unknown(column, name, "Stations", action, allowed)
    if e.from_ is not None and e.from_ == e.to:
        yield cells.wrong("To", e.to, "another station than From", "An element joins two stations.")
    grounded = GROUND in (e.from_, e.to)
    if e.kind == ElementKind.SPRING_TO_GROUND and not grounded and e.to is not None:
        yield cells.wrong("To", e.to, "ground", "A spring to ground has ground at one end.")
    for column, name in (("From", e.from_), ("To", e.to)):
        if e.kind == ElementKind.GEAR_MESH and name == GROUND:
            yield cells.wrong(column, GROUND, "a station", "A gear mesh joins two gears.")


def _geometry(cells: Cells, e: ElementRow, stepped: bool) -> Iterator[Problem]:
    """Stiffness, or everything it is computed from."""
    yield from cells.numbers(e, ELEMENT_NUMBERS)
    if e.scf is not None and 0 < e.scf < 1:
        yield cells.wrong("SCF", e.scf, "1 or more", "A notch never lowers the stress.")
    for outer, inner, column, outside in (
        (e.od, e.id, "ID", "OD"),
        (e.stress_diameter, e.stress_bore, "Stress bore", "Stress diameter"),
    ):
        if outer and inner and inner >= outer:
            yield cells.wrong(
                column,
                inner,
                f"below the outer diameter {outer:.6g} m",
                "Correct one of them.",
                "m",
                quote_quantity(outer, "m", (*cells, outside)),
            )
    yield from _stiffness(cells, e, stepped)


def _stiffness(cells: Cells, e: ElementRow, stepped: bool) -> Iterator[Problem]:
    if e.stiffness is not None:
        allowed = Allowed(
            (NOT_NEGATIVE if e.damping else POSITIVE).holds,
            "positive (0 only where Damping is given)",
        )
        action = (
            "Correct it, or leave it blank: a shaft is computed from OD, ID and Length or from its sections, a "
            "gear mesh is rigid."
        )
        yield from cells.number(e.stiffness, Limit("Stiffness", allowed, "N m/rad", action))
    elif e.kind in KINDS and e.kind != ElementKind.GEAR_MESH and not stepped:
        needed = ("OD", "Length", "Shear modulus")
        absent = [column for column in needed if value_of(e, column) is None]
        if absent:
            yield cells.problem(
                "Stiffness",
                None,
                "a stiffness, or OD, Length and Shear modulus, or rows of table Sections",
                "the stiffness is blank and cannot be computed: "
                + ", ".join(absent)
                + (" are" if len(absent) > 1 else " is")
                + " blank too. Type a stiffness or the geometry, or its sections in table Sections.",
            )
    shaft = e.kind != ElementKind.GEAR_MESH
    if shaft and not stepped and e.density is not None and (e.od is None or e.length is None):
        yield cells.problem(
            "Density",
            e.density,
            "used with OD and Length",
            "a density is given but OD or Length is blank, so the inertia of the shaft "
            "cannot be computed. Type the geometry or clear the density.",
        )


def check_elements(case: CaseData) -> Iterator[Problem]:
    """Kinds, ends, stiffnesses and materials of the elements."""
    table = "Elements"
    yield from check_names(table, "Element", [e.element for e in case.elements], "an element")
    stations = {s.station for s in case.stations if s.station}
    ratios = case.speed_ratios
    materials = {m.material for m in case.materials if m.material}
    stepped = _stepped(case)
    for cells, e in each_row(table, case.elements):
        if e.kind is None:
            yield cells.blank("Kind", "one of " + ", ".join(KINDS), "Choose from the list.")
        yield from cells.choice("Kind", e.kind, ElementKind)
        yield from _ends(stations, cells, e)
        yield from _geometry(cells, e, e.element in stepped)
        a, b = ratios.get(e.from_), ratios.get(e.to)
        joins_equals = e.kind in (ElementKind.SHAFT, ElementKind.COUPLING)
        if joins_equals and a and b and abs(a / b - 1.0) > 1e-9:
            yield cells.problem(
                "To",
                e.to,
                "a station of the same speed ratio as From",
                f"'{e.from_}' has speed ratio {a:.9g} and '{e.to}' {b:.9g}, but a {e.kind} joins "
                "stations of equal speed. Correct the speed ratios in table Stations, or "
                "choose kind gear mesh.",
            )
        if e.kind == ElementKind.GEAR_MESH:
            yield from _no_shaft(cells, e)
        if e.material:
            yield from cells.name("Material", e.material, materials, "Materials")
        if e.material and e.stress_diameter is None:
            yield cells.problem(
                "Stress diameter",
                None,
                "positive where a material is named",
                "a material is named but the stress diameter is blank: no stress can be judged. "
                "Type the diameter, of a plain shaft its OD, or clear the material.",
            )


def _no_shaft(cells: Cells, e: ElementRow) -> Iterator[Problem]:
    """What a gear mesh cannot have."""
    return typed_geometry(
        cells,
        e,
        "blank for a gear mesh",
        "A mesh has no shaft geometry: a blank Stiffness means rigid, and the gears' "
        "inertias belong to their stations.",
    )


def typed_geometry(cells: Cells, e: ElementRow, allowed: str, action: str) -> Iterator[Problem]:
    """Geometry of a shaft in the row of an element that may have none, each cell a problem."""
    for column, unit in SHAFT_GEOMETRY.items():
        value = value_of(e, column)
        if value is not None:
            yield cells.wrong(column, value, allowed, action, unit)


def check_connected(case: CaseData) -> Iterator[Problem]:
    """One train, no closed circuit."""
    names = [s.station for s in case.stations if s.station]
    root = {name: name for name in names}

    def find(name: str) -> str:
        while root[name] != name:
            root[name] = root[root[name]]
            name = root[name]
        return name

    joined: dict[frozenset[str], str | None] = {}
    for cells, e in each_row("Elements", case.elements):
        if e.from_ not in root or e.to not in root or e.from_ is None or e.to is None:
            continue
        pair = frozenset((e.from_, e.to))
        a, b = find(e.from_), find(e.to)
        if a != b:
            root[a] = b
            joined.setdefault(pair, e.kind)
        elif pair in joined and ElementKind.GEAR_MESH not in (e.kind, joined[pair]):
            continue  # side by side between the same two stations, a spring beside a damper
        else:
            yield cells.problem(
                "Element",
                e.element,
                "part of an open train",
                f"'{e.element}' closes a circuit between '{e.from_}' and '{e.to}'. Closed gear "
                "circuits (split torque, double helix as two meshes) are not calculated, "
                "because their load sharing depends on assembly. Combine the parallel paths into one "
                "equivalent path.",
            )
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(find(name), []).append(name)
    main = max(groups.values(), key=len, default=[])
    for group in groups.values():
        if group is not main:
            yield Cells("Stations", names.index(group[0]) + 1).problem(
                "Station",
                group[0],
                "joined to the rest of the train",
                f"no element joins {', '.join(repr(n) for n in group)} to the rest of the train "
                f"({main[0]!r}, …). Add the missing shaft, coupling or mesh.",
            )


def check_mode_damping(case: CaseData) -> Iterator[Problem]:
    """Modes that are counted from 1, each once, with a damping ratio."""
    seen: dict[int, int | None] = {}
    for cells, m in each_row("ModeDamping", case.mode_damping):
        if m.mode is None:
            yield cells.blank(
                "Mode", "the number of an elastic mode", "Number elastic modes from 1."
            )
        elif m.mode < 1 or m.mode != int(m.mode):
            action = "The lowest elastic mode is 1."
            yield cells.wrong("Mode", m.mode, "a whole number, 1 or more", action)
        elif m.mode in seen:
            yield cells.wrong("Mode", m.mode, f"given once (row {seen[m.mode]})", "Clear one row.")
        else:
            seen[m.mode] = cells.row
        if m.damping_ratio is None:
            yield cells.blank("Damping ratio", "at least 0 and below 1", "Type it.")
        yield from cells.number(m.damping_ratio, Limit("Damping ratio", BELOW_ONE))
