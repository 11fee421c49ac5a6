"""Checks of gear meshes: numbers, ratios, the line of action, gears on bearings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    Cells,
    Limit,
    blank_or_positive,
    check_names,
    each_row,
    number_text,
    quote_quantity,
)
from engine.case.choices import ElementKind, GearType
from engine.case.data import CaseData, ElementRow, MeshRow, value_of
from engine.errors import Problem, Quoted

#: What states the ratio of a mesh must agree with the speed ratios to this share (contract).
RATIO_TOLERANCE = 1e-3
TEETH = Allowed(lambda v: v >= 1 and v % 1 == 0, "a whole number, 1 or more")
MESH_NUMBERS = (
    Limit("Pitch radius drive", POSITIVE, "m"),
    Limit("Pitch radius driven", POSITIVE, "m"),
    Limit("Mesh stiffness", POSITIVE, "N/m"),
    Limit("Mesh damping", NOT_NEGATIVE, "N s/m"),
    Limit("Backlash", NOT_NEGATIVE, "m"),
    Limit("Angular backlash", NOT_NEGATIVE, "rad"),
    Limit("Mass drive", POSITIVE, "kg"),
    Limit("Mass driven", POSITIVE, "kg"),
    Limit("Bearing stiffness drive", POSITIVE, "N/m"),
    Limit("Bearing stiffness driven", POSITIVE, "N/m"),
    Limit("Bearing damping drive", NOT_NEGATIVE, "N s/m"),
    Limit("Bearing damping driven", NOT_NEGATIVE, "N s/m"),
    Limit("Teeth drive", TEETH),
    Limit("Teeth driven", TEETH),
    Limit("Speed ratio", POSITIVE),
)
_DEGREES = "Write degrees with the unit deg above the column."
MESH_ANGLES = (
    Limit(
        "Pressure angle",
        Allowed(lambda v: 0 <= v < math.pi / 2, "from 0 to 90 degrees"),
        "rad",
        _DEGREES,
    ),
    Limit(
        "Helix angle",
        Allowed(lambda v: abs(v) < math.pi / 2, "between -90 and 90 degrees"),
        "rad",
        _DEGREES,
    ),
    Limit("Orientation", ANY_NUMBER, "rad"),
)


def check_meshes(case: CaseData) -> Iterator[Problem]:
    """Each row of `Meshes`, then what the rows of one gear say together."""
    table = "Meshes"
    elements = {
        e.element: (place, e) for place, e in each_row("Elements", case.elements) if e.element
    }
    yield from check_names(table, "Element", [m.element for m in case.meshes], "a mesh")
    for cells, m in each_row(table, case.meshes):
        yield from cells.numbers(m, (*MESH_NUMBERS, *MESH_ANGLES))
        yield from cells.choice("Gear type", m.gear_type, GearType, "external or internal")
        if m.element is None:
            continue
        if m.element not in elements:
            names = [name for name in elements if name]
            yield from cells.name("Element", m.element, names, "Elements")
            continue
        element_cells, e = elements[m.element]
        if e.kind == ElementKind.GEAR_MESH:
            yield from _mesh_ratio(case, cells, m, e)
            yield from _mesh_line_of_action(cells, m, element_cells, e)
        elif e.kind in (ElementKind.COUPLING, ElementKind.SPRING_TO_GROUND):
            yield from _angular_clearance(cells, m, element_cells, e)
        elif e.kind == ElementKind.SHAFT:
            yield cells.wrong(
                "Element",
                m.element,
                "a gear mesh or a geared coupling",
                f"It is a {e.kind} in {_place(element_cells)}; correct one of the two.",
            )
    yield from _one_body(case)
    yield from _bodies(case)


def _place(cells: Cells) -> str:
    """A row as a sentence names it."""
    return f"table {cells.table}, row {cells.row}"


def _mesh_ratio(case: CaseData, cells: Cells, m: MeshRow, e: ElementRow) -> Iterator[Problem]:
    """Teeth, pitch radii and ratio against each other and the stations; a ring gear against its pinion."""
    drive, driven = m.pitch_radius_drive, m.pitch_radius_driven
    typed = (drive, driven, m.teeth_drive, m.teeth_driven, m.speed_ratio)
    ratios = case.speed_ratios
    ends = (ratios.get(e.from_), ratios.get(e.to))
    if not all(map(blank_or_positive, (*typed, *ends))) or None in ends:
        return
    by_speed = float(ends[1] or 0.0) / float(ends[0] or 1.0)
    yield from _one_ratio(case, cells, m, e, by_speed)
    if drive is None and driven is None:
        return  # a ratio and a sense of rotation alone, without size
    by_radii = drive / driven if drive is not None and driven is not None else by_speed
    if m.gear_type == GearType.INTERNAL and abs(by_radii - 1.0) <= RATIO_TOLERANCE:
        equal = f"its pitch radius is {drive or driven:.6g} m and both stations have the same speed"
        if drive is not None and driven is not None:
            equal = f"its pitch radii are {drive:.6g} m and {driven:.6g} m"
        radii = {"Pitch radius drive": drive, "Pitch radius driven": driven}
        yield cells.problem(
            "Gear type",
            m.gear_type,
            "external for two gears of the same size",
            f"found internal, but {equal}: in an internal mesh the ring gear is larger "
            "than the pinion. Choose external, or correct the pitch radii and Speed ratios. For a "
            "geared coupling, choose kind coupling in table Elements.",
            tuple(
                quoted
                for column, radius in radii.items()
                if radius is not None
                for quoted in quote_quantity(radius, "m", (*cells, column))
            ),
        )


#: What states a ratio, by the column in which it is corrected, and its two cells.
_SAID_BY = {
    "Teeth driven": ("the teeth", "Teeth drive", "Teeth driven"),
    "Speed ratio": ("the cell", "Speed ratio"),
    "Pitch radius driven": ("the pitch radii", "Pitch radius drive", "Pitch radius driven"),
}


def _one_ratio(
    case: CaseData, cells: Cells, m: MeshRow, e: ElementRow, by_speed: float
) -> Iterator[Problem]:
    """One ratio of a mesh: of teeth, Speed ratio and pitch radii, and of the stations on both sides."""
    for one, other in (("Teeth drive", "Teeth driven"), ("Teeth driven", "Teeth drive")):
        if value_of(m, one) is None and value_of(m, other) is not None:
            yield cells.blank(
                one,
                f"the number of teeth where {other} is given",
                "Type both, or clear both.",
            )
    stated = m.stated_ratios
    if not stated or not all(n is None or TEETH.holds(n) for n in (m.teeth_drive, m.teeth_driven)):
        return
    first, exact = next(iter(stated.items()))
    others = [column for column, r in stated.items() if abs(r / exact - 1.0) > RATIO_TOLERANCE]
    for column in others:
        yield cells.problem(
            column,
            value_of(m, column),
            f"such that the speed ratio is {exact:.6g}",
            f"{_SAID_BY[column][0]} {_gives(column)} a speed ratio of {stated[column]:.6g}, but "
            f"{' and '.join(_SAID_BY[first][1:])} {_gives(first)} {exact:.6g}. They must agree to "
            "0.1 %: correct one of them, or clear it.",
        )
    if not others and abs(exact / by_speed - 1.0) > RATIO_TOLERANCE:
        yield _other_speeds(case, cells, m, e, first, by_speed)


def _gives(column: str) -> str:
    return "gives" if column == "Speed ratio" else "give"


def _other_speeds(
    case: CaseData, cells: Cells, m: MeshRow, e: ElementRow, column: str, by_speed: float
) -> Problem:
    """The ratio of a mesh, and another one of the stations on both sides."""
    ratio, found = m.stated_ratios[column], value_of(m, column)
    allowed, drive = f"{by_speed:.6g}", ""
    quoted: tuple[Quoted, ...] = ()
    if column == "Teeth driven":
        allowed = f"such that the teeth give {by_speed:.6g}"
        drive = f" with {m.teeth_drive} teeth on the drive side"
    if column == "Pitch radius driven" and m.pitch_radius_drive is not None:
        radius = m.pitch_radius_drive
        allowed = f"{radius / by_speed:.6g} m"
        drive = f" with {radius:.6g} m on the drive side"
        quoted = quote_quantity(radius, "m", (*cells, "Pitch radius drive")) + quote_quantity(
            radius / by_speed, "m"
        )
    unit = " m" if column == "Pitch radius driven" else ""
    rows = {s.station: i for i, s in enumerate(case.stations, start=1)}
    return cells.problem(
        column,
        found,
        allowed,
        f"found {found:.6g}{unit}:{drive} {_SAID_BY[column][0]} {_gives(column)} a speed ratio of "
        f"{ratio:.6g}, but the Speed ratios in table Stations ('{e.from_}', row {rows[e.from_]}, and "
        f"'{e.to}', row {rows[e.to]}) make {by_speed:.6g}. They must agree to 0.1 %: correct "
        f"{_SAID_BY[column][0]}, or the Speed ratio of '{e.to}' and of all stations beyond it; blank "
        "ones follow from the gear.",
        quoted,
    )


def _mesh_line_of_action(
    cells: Cells, m: MeshRow, element_cells: Cells, e: ElementRow
) -> Iterator[Problem]:
    """What acts along the line of action needs a radius; what separates or damps needs a stiffness."""
    if m.angular_backlash is not None:
        yield cells.wrong(
            "Angular backlash",
            m.angular_backlash,
            "blank for a gear mesh",
            "Angular backlash is for geared couplings; type the Backlash of the teeth, a length "
            "normal to the flanks.",
            "rad",
        )
    for column, value, unit in (
        ("Mesh stiffness", m.mesh_stiffness, "N/m"),
        ("Mesh damping", m.mesh_damping, "N s/m"),
        ("Backlash", m.backlash, "m"),
    ):
        if value and m.pitch_radius_drive is None:
            yield cells.problem(
                "Pitch radius drive",
                None,
                f"positive where {column} is given",
                f"the cell is blank, but {column} is {number_text(value, unit)} along the line "
                "of action and needs a radius to act on the torque. Type the radius.",
                quote_quantity(value, unit, (*cells, column)),
            )
            break
    if e.stiffness is not None and m.mesh_stiffness is not None:
        yield cells.problem(
            "Mesh stiffness",
            m.mesh_stiffness,
            "blank where Stiffness is given",
            f"found {number_text(m.mesh_stiffness, 'N/m')}, but {_place(element_cells)}, "
            f"gives '{e.element}' a Stiffness of {number_text(e.stiffness, 'N m/rad')} as well. Keep "
            "one of the two.",
            quote_quantity(e.stiffness, "N m/rad", (*element_cells, "Stiffness")),
        )
    rigid = e.stiffness is None and m.mesh_stiffness is None
    blank = (
        f"Stiffness of '{e.element}' ({_place(element_cells)}) is blank and so is Mesh "
        f"stiffness (table Meshes, row {cells.row})"
    )
    if rigid and m.backlash:
        yield cells.problem(
            "Backlash",
            m.backlash,
            "used with a finite mesh stiffness",
            f"found {number_text(m.backlash, 'm')}, but the mesh is rigid: {blank}. Teeth "
            "that separate need a stiffness to re-engage: type one of the two, or clear the backlash.",
        )
    if e.stiffness == 0 and m.backlash:
        yield _without_stiffness(cells, "Backlash", m.backlash, element_cells, e)
    if rigid and m.mesh_damping:
        yield cells.problem(
            "Mesh damping",
            m.mesh_damping,
            "used with a finite mesh stiffness",
            f"found {number_text(m.mesh_damping, 'N s/m')}, but the mesh is rigid: {blank}. "
            "Damping has no effect in a rigid mesh: type a stiffness, or clear the damping.",
        )


def _angular_clearance(
    cells: Cells, m: MeshRow, element_cells: Cells, e: ElementRow
) -> Iterator[Problem]:
    """A geared coupling or a stop has an angular clearance and nothing else of table Meshes."""
    for limit in MESH_NUMBERS:
        value = value_of(m, limit.column)
        if value is not None and limit.column != "Angular backlash":
            yield cells.wrong(
                limit.column,
                value,
                f"blank: '{m.element}' is a {e.kind}",
                "Angular backlash is for geared couplings and for springs to ground with "
                "free play; the other columns are for gear meshes. Clear the cell.",
                limit.unit,
            )
    if e.stiffness == 0 and m.angular_backlash:
        yield _without_stiffness(cells, "Angular backlash", m.angular_backlash, element_cells, e)


def _without_stiffness(
    cells: Cells, column: str, clearance: float, element_cells: Cells, e: ElementRow
) -> Problem:
    """A clearance in an element that has nothing to close with."""
    unit, ends = ("m", "Teeth") if column == "Backlash" else ("rad", "Ends")
    return cells.problem(
        column,
        clearance,
        "used with a positive stiffness",
        f"found {number_text(clearance, unit)}, but Stiffness of '{e.element}' "
        f"({_place(element_cells)}) is 0. {ends} that separate need a stiffness to "
        f"re-engage: type it, or clear the {column.lower()}.",
    )


#: Data of one gear body, for either side of the mesh, with its unit.
BODY = {"Mass": "kg", "Bearing stiffness": "N/m", "Bearing damping": "N s/m"}
#: A number of a gear body: its cell, and what stands there.
BodyCell = tuple[Cells, str, float]


def _body_cells(
    case: CaseData, elements: Iterable[ElementRow]
) -> Iterator[tuple[str, str, BodyCell]]:
    """Station, header and cell of everything typed of the gears of some elements."""
    ends = {e.element: (e.from_, e.to) for e in elements}
    for cells, m in each_row("Meshes", case.meshes):
        for side, station in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for header in BODY:
                value = value_of(m, f"{header} {side}")
                if value is not None and station is not None:
                    yield station, header, (cells, f"{header} {side}", value)


def _one_body(case: CaseData) -> Iterator[Problem]:
    """A gear in several meshes is one body: what is repeated must agree."""
    first: dict[tuple[str, str], BodyCell] = {}
    for station, header, typed in _body_cells(case, case.elements):
        cells, column, value = typed
        other_cells, other_column, other = first.setdefault((station, header), typed)
        if abs(value - other) > 1e-9 * abs(other):
            unit = BODY[header]
            yield cells.wrong(
                column,
                value,
                f"{number_text(other, unit)} as in row {other_cells.row}, {other_column}",
                f"Both rows describe the gear '{station}', which is one body; leave one of them "
                "blank or make them equal.",
                unit,
                quote_quantity(other, unit, (*other_cells, other_column)),
            )


def _bodies(case: CaseData) -> Iterator[Problem]:
    """A gear on bearings has mass and stiffness, in whatever row, and meshes that can push it."""
    geared = [e for e in case.elements if e.kind == ElementKind.GEAR_MESH]
    gears: dict[str, dict[str, BodyCell]] = {}
    for station, header, typed in _body_cells(case, geared):
        if header != "Bearing damping" or typed[2] != 0.0:
            gears.setdefault(station, {}).setdefault(header, typed)
    for station, gear in gears.items():
        if all(blank_or_positive(value) for _, _, value in gear.values()):  # else told already
            yield from _whole_body(station, gear)
    meshes: dict[str | None, tuple[Cells, MeshRow]] = {}
    for place in each_row("Meshes", case.meshes):
        meshes.setdefault(place[1].element, place)
    for element_cells, e in each_row("Elements", case.elements):
        given = [gears[name] for name in (e.from_, e.to) if name in gears]
        if e.kind == ElementKind.GEAR_MESH and given and e.element is not None:
            cells, column, _ = next(iter(given[0].values()))
            data = f"{column} of table Meshes, row {cells.row}, puts one of its gears on bearings"
            yield from _pushed_body(element_cells, e, meshes.get(e.element), data)


def _whole_body(station: str, gear: dict[str, BodyCell]) -> Iterator[Problem]:
    """Mass, bearing stiffness and bearing damping of one gear: which of them need which."""
    for needed, action in (
        (
            "Bearing stiffness",
            "A gear moves laterally only on elastic bearings: type their stiffness here or in "
            "another row of this gear",
        ),
        (
            "Mass",
            "A gear on bearings needs a mass: type the mass of the gear with its "
            "share of the shaft here or in another row of this gear",
        ),
    ):
        if needed in gear:
            continue
        header, (cells, column, value) = next(iter(gear.items()))
        yield cells.problem(
            f"{needed} {column.split()[-1]}",
            None,
            f"positive where {column} is given",
            f"the cell is blank, but {column} of the gear '{station}' is "
            f"{number_text(value, BODY[header])}. {action}, or clear the {column}.",
            quote_quantity(value, BODY[header], (*cells, column)),
        )


def _pushed_body(
    element_cells: Cells, e: ElementRow, mesh: tuple[Cells, MeshRow] | None, data: str
) -> Iterator[Problem]:
    """The mesh of a gear on bearings: it needs a line of action and a finite stiffness."""
    if mesh is None:
        yield Cells("Meshes").problem(
            "Element",
            None,
            "with a row for every mesh of a gear on bearings",
            f"'{e.element}' ({_place(element_cells)}) has no row in table Meshes, but {data}. Add "
            "its row with the Pitch radius drive and the Orientation, or clear the bearing data.",
        )
        return
    cells, m = mesh
    if m.pitch_radius_drive is None:
        yield cells.problem(
            "Pitch radius drive",
            None,
            "positive where a gear has bearings",
            f"the cell is blank, but {data}: the tooth force follows from torque "
            "and radius. Type the radius, or clear the bearing data.",
        )
    if not e.stiffness and not m.mesh_stiffness:
        rigid = e.stiffness is None
        yield cells.problem(
            "Mesh stiffness",
            None,
            "positive, or a positive Stiffness, where a gear has bearings",
            f"{data}, but the mesh {'is rigid' if rigid else 'has no stiffness'}: Stiffness of "
            f"'{e.element}' ({_place(element_cells)}) is {'blank' if rigid else '0'} "
            f"and Mesh stiffness (table Meshes, row {cells.row}) is blank. Type one of the two, or "
            "clear the bearing data.",
        )
