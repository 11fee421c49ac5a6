"""Checks of gear meshes: numbers, ratios, the line of action, gears on bearings."""

from __future__ import annotations

import math
from collections.abc import Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    blank_or_positive,
    check_names,
    check_number,
    number_text,
    quote_quantity,
    suggestion,
    wrong_value,
)
from engine.case.checks.train import KINDS
from engine.case.choices import ElementKind, GearType
from engine.case.data import CaseData, ElementRow, MeshRow
from engine.errors import Problem, Quoted

#: Pitch radii must agree with the speed ratios to this share (contract).
RADIUS_TOLERANCE = 1e-3
MESH_LENGTHS = (
    ("Pitch radius drive", "pitch_radius_drive", POSITIVE, "m"),
    ("Pitch radius driven", "pitch_radius_driven", POSITIVE, "m"),
    ("Mesh stiffness", "mesh_stiffness", POSITIVE, "N/m"),
    ("Mesh damping", "mesh_damping", NOT_NEGATIVE, "N s/m"),
    ("Backlash", "backlash", NOT_NEGATIVE, "m"),
    ("Angular backlash", "angular_backlash", NOT_NEGATIVE, "rad"),
    ("Mass drive", "mass_drive", POSITIVE, "kg"),
    ("Mass driven", "mass_driven", POSITIVE, "kg"),
    ("Bearing stiffness drive", "bearing_stiffness_drive", POSITIVE, "N/m"),
    ("Bearing stiffness driven", "bearing_stiffness_driven", POSITIVE, "N/m"),
    ("Bearing damping drive", "bearing_damping_drive", NOT_NEGATIVE, "N s/m"),
    (
        "Bearing damping driven",
        "bearing_damping_driven",
        NOT_NEGATIVE,
        "N s/m",
    ),
)


def check_meshes(case: CaseData) -> Iterator[Problem]:
    """Each row of `Meshes`, then what the rows of one gear say together."""
    table = "Meshes"
    elements = {e.element: (row, e) for row, e in enumerate(case.elements, start=1) if e.element}
    yield from check_names(table, "Element", [m.element for m in case.meshes], "a mesh")
    for row, m in enumerate(case.meshes, start=1):
        yield from _mesh_numbers(row, m)
        if m.element is None:
            continue
        if m.element not in elements:
            yield wrong_value(
                table,
                row,
                "Element",
                m.element,
                "an element of table Elements",
                suggestion(m.element, set(elements)),
            )
            continue
        element_row, e = elements[m.element]
        if e.kind == ElementKind.GEAR_MESH:
            yield from _mesh_ratio(case, row, m, e)
            yield from _mesh_line_of_action(row, m, element_row, e)
        elif e.kind in ("coupling", ElementKind.SPRING_TO_GROUND):
            yield from _angular_clearance(row, m, element_row, e)
        elif e.kind in KINDS:
            yield wrong_value(
                table,
                row,
                "Element",
                m.element,
                "a gear mesh or a geared coupling",
                f"It is a {e.kind} in table Elements, row {element_row}; correct one of the two.",
            )
    yield from _one_body(case)
    yield from _bodies(case)


def _mesh_numbers(row: int, m: MeshRow) -> Iterator[Problem]:
    """Each number of a mesh by itself."""
    table = "Meshes"
    for column, key, allowed, unit in MESH_LENGTHS:
        yield from check_number(table, row, column, getattr(m, key), allowed, unit)
    for column, value, allowed in (
        (
            "Pressure angle",
            m.pressure_angle,
            Allowed(lambda v: 0 <= v < math.pi / 2, "from 0 to 90 degrees"),
        ),
        (
            "Helix angle",
            m.helix_angle,
            Allowed(lambda v: abs(v) < math.pi / 2, "between -90 and 90 degrees"),
        ),
    ):
        action = "Write degrees with the unit deg above the column."
        yield from check_number(table, row, column, value, allowed, "rad", action)
    yield from check_number(table, row, "Orientation", m.orientation, ANY_NUMBER, "rad")
    if m.gear_type not in (None, *GearType):
        yield wrong_value(
            table, row, "Gear type", m.gear_type, "external or internal", "Choose from the list."
        )


def _mesh_ratio(case: CaseData, row: int, m: MeshRow, e: ElementRow) -> Iterator[Problem]:
    """Pitch radii against speed ratios; a ring gear against its pinion."""
    stations = {s.station: (i, s.speed_ratio) for i, s in enumerate(case.stations, start=1)}
    drive, driven = m.pitch_radius_drive, m.pitch_radius_driven
    if not (blank_or_positive(drive) and blank_or_positive(driven)):
        return
    if e.from_ not in stations or e.to not in stations:
        return
    ratios = [1.0 if stations[n][1] is None else stations[n][1] for n in (e.from_, e.to)]
    if not all(blank_or_positive(r) for r in ratios):
        return
    by_speed = float(ratios[1] or 0.0) / float(ratios[0] or 1.0)
    if drive is None and driven is None:
        return  # a ratio and a sense of rotation alone, without size
    by_radii = drive / driven if drive is not None and driven is not None else by_speed
    if m.gear_type == GearType.INTERNAL and abs(by_radii - 1.0) <= RADIUS_TOLERANCE:
        equal = f"its pitch radius is {drive or driven:.6g} m and both stations turn equally fast"
        if drive is not None and driven is not None:
            equal = f"its pitch radii are {drive:.6g} m and {driven:.6g} m"
        yield Problem(
            "Meshes",
            row,
            "Gear type",
            m.gear_type,
            "external for two gears of the same size",
            f"found internal, but {equal}: the pinion of an internal mesh turns inside its ring, "
            "which must be larger. Choose external, or correct the pitch radii and Speed ratios; "
            "a geared coupling is an element of kind coupling.",
            tuple(
                Quoted(number_text(radius, "m"), radius, ("Meshes", row, f"Pitch radius {side}"))
                for side, radius in (("drive", drive), ("driven", driven))
                if radius is not None
            ),
        )
    if drive is None or driven is None:
        return
    if abs(drive / driven / by_speed - 1.0) > RADIUS_TOLERANCE:
        yield Problem(
            "Meshes",
            row,
            "Pitch radius driven",
            driven,
            f"{drive / by_speed:.6g} m",
            f"found {driven:.6g} m: with {drive:.6g} m on the drive side the radii make a speed "
            f"ratio of {drive / driven:.6g}, but the Speed ratios in table Stations ('{e.from_}', "
            f"row {stations[e.from_][0]}, and '{e.to}', row {stations[e.to][0]}) make "
            f"{by_speed:.6g}. They must agree to 0.1 %: correct a pitch radius, or the Speed "
            f"ratio of '{e.to}' and of everything beyond it.",
            quote_quantity(drive, "m", ("Meshes", row, "Pitch radius drive"))
            + quote_quantity(drive / by_speed, "m"),
        )


def _mesh_line_of_action(
    row: int, m: MeshRow, element_row: int, e: ElementRow
) -> Iterator[Problem]:
    """What acts along the line of action needs a radius; what separates or damps needs a stiffness."""
    table = "Meshes"
    if m.angular_backlash is not None:
        yield wrong_value(
            table,
            row,
            "Angular backlash",
            m.angular_backlash,
            "blank for a gear mesh",
            "It belongs to geared couplings; type the normal Backlash of the teeth, a length.",
            "rad",
        )
    for column, value, unit in (
        ("Mesh stiffness", m.mesh_stiffness, "N/m"),
        ("Mesh damping", m.mesh_damping, "N s/m"),
        ("Backlash", m.backlash, "m"),
    ):
        if value and m.pitch_radius_drive is None:
            yield Problem(
                table,
                row,
                "Pitch radius drive",
                None,
                f"positive where {column} is given",
                f"the cell is blank, but {column} is {number_text(value, unit)}, along the line of "
                "action: without a radius it says nothing about the torque. Type the radius.",
                quote_quantity(value, unit, (table, row, column)),
            )
            break
    if e.stiffness is not None and m.mesh_stiffness is not None:
        yield Problem(
            table,
            row,
            "Mesh stiffness",
            m.mesh_stiffness,
            "blank where Stiffness is given",
            f"found {number_text(m.mesh_stiffness, 'N/m')}, but table Elements, row {element_row}, "
            f"gives '{e.element}' a Stiffness of {number_text(e.stiffness, 'N m/rad')} as well. Keep "
            "one of the two.",
            quote_quantity(e.stiffness, "N m/rad", ("Elements", element_row, "Stiffness")),
        )
    rigid = e.stiffness is None and m.mesh_stiffness is None
    blank = (
        f"Stiffness of '{e.element}' (table Elements, row {element_row}) is blank and so is Mesh "
        "stiffness (table Meshes"
    )
    if rigid and m.backlash:
        yield Problem(
            table,
            row,
            "Backlash",
            m.backlash,
            "used with a finite mesh stiffness",
            f"found {number_text(m.backlash, 'm')}, but the mesh is rigid: {blank}, row {row}). Teeth "
            "that separate need a stiffness to re-engage: type one of the two, or clear the backlash.",
        )
    if e.stiffness == 0 and m.backlash:
        yield _clearance_without_stiffness(
            (row, "Backlash"), (m.backlash, "m"), element_row, e, "Teeth"
        )
    if rigid and m.mesh_damping:
        yield Problem(
            table,
            row,
            "Mesh damping",
            m.mesh_damping,
            "used with a finite mesh stiffness",
            f"found {number_text(m.mesh_damping, 'N s/m')}, but the mesh is rigid: {blank}, row "
            f"{row}). Nothing moves in a rigid mesh: type a stiffness, or clear the damping.",
        )


def _angular_clearance(row: int, m: MeshRow, element_row: int, e: ElementRow) -> Iterator[Problem]:
    """A geared coupling or a stop has an angular clearance and nothing else of table Meshes."""
    for column, key, _, unit in MESH_LENGTHS:
        value = getattr(m, key)
        if value is not None and column != "Angular backlash":
            yield wrong_value(
                "Meshes",
                row,
                column,
                value,
                f"blank: '{m.element}' is a {e.kind}",
                "A geared coupling, or a spring to ground with free play, has an Angular "
                "backlash; everything else here is for gear meshes.",
                unit,
            )
    if e.stiffness == 0 and m.angular_backlash:
        clearance = (m.angular_backlash, "rad")
        yield _clearance_without_stiffness(
            (row, "Angular backlash"), clearance, element_row, e, "Ends"
        )


def _clearance_without_stiffness(
    cell: tuple[int, str], clearance: tuple[float, str], element_row: int, e: ElementRow, what: str
) -> Problem:
    """A clearance in an element that has nothing to close with."""
    return Problem(
        "Meshes",
        cell[0],
        cell[1],
        clearance[0],
        "used with a positive stiffness",
        f"found {number_text(*clearance)}, but Stiffness of '{e.element}' (table Elements, row {element_row}) is 0. "
        f"{what} that separate need a stiffness to close again: type it, or clear the "
        f"{cell[1].lower()}.",
    )


#: Data of one gear body, by side of the mesh.
BODY = (
    ("Mass", "mass"),
    ("Bearing stiffness", "bearing_stiffness"),
    ("Bearing damping", "bearing_damping"),
)

BODY_UNITS = {"mass": "kg", "bearing_stiffness": "N/m", "bearing_damping": "N s/m"}


def _one_body(case: CaseData) -> Iterator[Problem]:
    """A gear in several meshes is one body: what is repeated must agree."""
    ends = {e.element: (e.from_, e.to) for e in case.elements}
    first: dict[tuple[str, str], tuple[int, str, float]] = {}
    for row, m in enumerate(case.meshes, start=1):
        for side, station in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for header, key in BODY:
                unit = BODY_UNITS[key]
                value = getattr(m, f"{key}_{side}")
                if value is None or station is None:
                    continue
                column = f"{header} {side}"
                seen = first.setdefault((station, key), (row, column, value))
                if abs(value - seen[2]) > 1e-9 * abs(seen[2]):
                    yield wrong_value(
                        "Meshes",
                        row,
                        column,
                        value,
                        f"{number_text(seen[2], unit)} as in row {seen[0]}, {seen[1]}",
                        f"Both are of the gear '{station}', which is one body; leave one of them "
                        "blank or make them equal.",
                        unit,
                        quote_quantity(seen[2], unit, ("Meshes", seen[0], seen[1])),
                    )


def _bodies(case: CaseData) -> Iterator[Problem]:
    """A gear on bearings has mass and stiffness, in whatever row, and meshes that can push it."""
    ends = {e.element: (e.from_, e.to) for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    gears: dict[str, dict[str, tuple[int, str, float]]] = {}
    for row, m in enumerate(case.meshes, start=1):
        for side, station in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for header, key in BODY:
                value = getattr(m, f"{key}_{side}")
                undamped = key == "bearing_damping" and value == 0.0
                if value is not None and station is not None and not undamped:
                    gear = gears.setdefault(station, {})
                    gear.setdefault(key, (row, f"{header} {side}", value))
    for station, gear in gears.items():
        if all(blank_or_positive(value) for _, _, value in gear.values()):  # else told already
            yield from _whole_body(station, gear)
    meshes: dict[str | None, tuple[int, MeshRow]] = {}
    for row, m in enumerate(case.meshes, start=1):
        meshes.setdefault(m.element, (row, m))
    for element_row, e in enumerate(case.elements, start=1):
        given = [gears[name] for name in (e.from_, e.to) if name in gears]
        if e.kind == ElementKind.GEAR_MESH and given and e.element is not None:
            row, column, _ = next(iter(given[0].values()))
            data = f"{column} of table Meshes, row {row}, puts one of its gears on bearings"
            yield from _pushed_body(element_row, e, meshes.get(e.element), data)


def _whole_body(station: str, gear: dict[str, tuple[int, str, float]]) -> Iterator[Problem]:
    """Mass, bearing stiffness and bearing damping of one gear: which of them need which."""
    for needed, header, action in (
        (
            "bearing_stiffness",
            "Bearing stiffness",
            "A gear moves laterally only on elastic bearings: type their stiffness here or in "
            "another row of this gear",
        ),
        (
            "mass",
            "Mass",
            "A bearing without mass has no motion of its own: type the mass of the gear with its "
            "share of the shaft here or in another row of this gear",
        ),
    ):
        if needed in gear:
            continue
        key, (row, column, value) = next(iter(gear.items()))
        yield Problem(
            "Meshes",
            row,
            f"{header} {column.split()[-1]}",
            None,
            f"positive where {column} is given",
            f"the cell is blank, but {column} of the gear '{station}' is "
            f"{number_text(value, BODY_UNITS[key])}. {action}, or clear the {column}.",
            quote_quantity(value, BODY_UNITS[key], ("Meshes", row, column)),
        )


def _pushed_body(
    element_row: int, e: ElementRow, mesh: tuple[int, MeshRow] | None, data: str
) -> Iterator[Problem]:
    """The mesh of a gear on bearings: it needs a line of action and a finite stiffness."""
    if mesh is None:
        yield Problem(
            "Meshes",
            None,
            "Element",
            None,
            "with a row for every mesh of a gear on bearings",
            f"'{e.element}' (table Elements, row {element_row}) has no row here, but {data}. Add "
            "its row with the Pitch radius drive and the Orientation, or clear the bearing data.",
        )
        return
    row, m = mesh
    if m.pitch_radius_drive is None:
        yield Problem(
            "Meshes",
            row,
            "Pitch radius drive",
            None,
            "positive where a gear has bearings",
            f"the cell is blank, but {data}: without a radius a torque says nothing about the "
            "force. Type the radius, or clear the bearing data.",
        )
    if not e.stiffness and not m.mesh_stiffness:
        rigid = e.stiffness is None
        yield Problem(
            "Meshes",
            row,
            "Mesh stiffness",
            None,
            "positive, or a positive Stiffness, where a gear has bearings",
            f"{data}, but the mesh {'is rigid' if rigid else 'has none'}: Stiffness of "
            f"'{e.element}' (table Elements, row {element_row}) is {'blank' if rigid else '0'} "
            f"and Mesh stiffness (table Meshes, row {row}) is blank. Type one of the two, or "
            "clear the bearing data.",
        )
