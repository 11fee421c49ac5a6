"""Gears that move laterally on their bearings, and the flanks on which elements touch."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.errors import ModelError
from engine.model.assembly import Assembly, BodyData
from engine.model.gears import FlankNormals, flank_normals, line_of_action
from engine.model.links import has_clearance
from engine.model.train import NO_ELEMENT, Flank, GearBody
from engine.numerics.same_bits import product

#: An entry of a unit vector below this is the rounding of a zero.
ROUNDED_ZERO = 1e-14


def body_data(case: CaseData, a: Assembly) -> dict[int, BodyData]:
    """Gears with mass and bearing stiffness, by station."""
    ends = {e.element: (e.from_, e.to) for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    typed: dict[str, dict[str, float]] = {}
    for m in case.meshes:
        for side, name in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for key in ("mass", "bearing_stiffness", "bearing_damping"):
                value = getattr(m, f"{key}_{side}")
                if value is not None:
                    typed.setdefault(str(name), {}).setdefault(key, value)
    return {
        a.index[name]: BodyData(
            given["mass"], given["bearing_stiffness"], given.get("bearing_damping", 0.0)
        )
        for name, given in sorted(typed.items(), key=lambda item: a.index[item[0]])
        if "mass" in given and "bearing_stiffness" in given
    }


@dataclass(frozen=True, eq=False)
class _Teeth:
    """A mesh of which at least one gear is on bearings."""

    row: int
    orientation: float
    driver: int
    driven: int
    base_radius: float
    normals: FlankNormals


def _teeth(
    case: CaseData, a: Assembly, data: Mapping[int, BodyData], orientation: Floats, sense: Floats
) -> list[_Teeth]:
    """The meshes of the gears on bearings, in the order of the elements."""
    meshes = {m.element: m for m in case.meshes}
    row_of = {element: row for row, (element, *_) in enumerate(a.rows)}
    teeth = []
    for i, start, end in a.edges:
        e = case.elements[i]
        if e.kind != ElementKind.GEAR_MESH or not {start, end} & data.keys():
            continue
        mesh = meshes.get(e.element)
        if i not in row_of or mesh is None or not mesh.pitch_radius_drive:
            raise ModelError(
                f"A gear of mesh '{e.element}' has bearings, but the mesh has no stiffness or no "
                "pitch radius, which the tooth force needs. Type them in table Meshes."
            )
        from_drives = bool(orientation[i] > 0.0)
        driver, driven = (start, end) if from_drives else (end, start)
        normals = flank_normals(
            mesh,
            from_drives=from_drives,
            sense=float(sense[driver]),
            driver_larger=a.ratio[driver] < a.ratio[driven],
        )
        radius = mesh.pitch_radius_drive * line_of_action(mesh)[0]
        sign = 1.0 if from_drives else -1.0
        teeth.append(_Teeth(row_of[i], sign, driver, driven, radius, normals))
    return teeth


def add_bodies(
    case: CaseData,
    a: Assembly,
    data: Mapping[int, BodyData],
    orientation: Floats,
    sense: Floats,
) -> tuple[tuple[GearBody, ...], dict[int, dict[int, float]]]:
    """Gears on bearings, their entries in the rows of their meshes, and the back flanks' rows.

    Compression of the drive flank, as an angle on the From side:
    [r_b θ of the driver − r_b θ of the driven + n_d·(u of the driver − u of the driven)] / r_b,From.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    a : Assembly
        Rows and nodes; the bodies' are added. [SI]
    data : mapping of int to BodyData
        Gears on bearings, by station. [SI]
    orientation, sense : ndarray
        Drive end of each element, direction of rotation of each station. [1]

    Returns
    -------
    bodies : tuple of GearBody
        In the order of the stations. [SI]
    backs : dict of int to dict
        By incidence row, the entries of its back flank by node. [1, 1/m]
    """
    teeth = _teeth(case, a, data, orientation, sense)
    axes: dict[int, Floats] = {}
    for t in teeth:
        for gear in (t.driver, t.driven):
            axes.setdefault(gear, t.normals.drive)
    bodies = {gear: a.body(gear, given, axes[gear]) for gear, given in data.items()}
    backs = {}
    for t in teeth:
        entries = a.rows[t.row][4]
        back = {node: -t.orientation * factor for node, factor in entries.items()}
        for gear, sign in ((t.driver, 1.0), (t.driven, -1.0)):
            if gear not in bodies:
                continue  # fixed laterally
            body, axis = bodies[gear], axes[gear]
            for node, direction in ((body.node_x, axis), (body.node_y, _turned(axis))):
                drive_part = _component(t.normals.drive, direction)
                if drive_part:
                    entries[node] = t.orientation * sign * drive_part / t.base_radius
                back[node] = sign * _component(t.normals.back, direction) / t.base_radius
        backs[t.row] = back
    return tuple(bodies.values()), backs


def _turned(vector: Floats) -> Floats:
    """A vector turned by +90 degrees."""
    return np.array([-vector[1], vector[0]])


def _component(vector: Floats, direction: Floats) -> float:
    """Component of one unit vector along another, without the rounding of a zero."""
    part = float(product(vector, direction))
    return 0.0 if abs(part) < ROUNDED_ZERO else part


def flanks_of(
    case: CaseData,
    a: Assembly,
    node_incidence: Floats,
    orientation: Floats,
    backs: Mapping[int, Mapping[int, float]],
) -> tuple[Flank, ...]:
    """Flanks of every elastic mesh, and of every other element with a clearance.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    a : Assembly
        Its rows. [SI]
    node_incidence : ndarray, shape (n_rows, n_nodes)
        Deflection of each row from the node angles. [1, 1/m]
    orientation : ndarray, shape (n_elements,)
        +1 if From is the drive end, else −1. [1]
    backs : mapping of int to mapping
        Entries of back flanks that differ from the drive flank, by row. [1, 1/m]

    Returns
    -------
    tuple of Flank
        In the order of the rows. [SI]
    """
    meshes = {m.element: m for m in case.meshes}
    flanks = []
    for row, (i, stiffness, viscous, _, _) in enumerate(a.rows):
        if i == NO_ELEMENT or stiffness <= 0.0:
            continue
        e = case.elements[i]
        mesh = meshes.get(e.element)
        if e.kind != ElementKind.GEAR_MESH and not has_clearance(mesh):
            continue
        drive = orientation[i] * node_incidence[row]
        back = -drive
        if row in backs:
            back = np.zeros(len(drive))
            back[list(backs[row])] = list(backs[row].values())
        gap, radius, normal_factor = None, None, 1.0
        if e.kind != ElementKind.GEAR_MESH:
            gap = mesh.angular_backlash if mesh is not None else None
        elif mesh is not None and mesh.pitch_radius_drive:
            cos_t, share = line_of_action(mesh)
            radius, normal_factor = mesh.pitch_radius_drive * cos_t, 1.0 / math.sqrt(share)
            gap = mesh.backlash * normal_factor / radius if mesh.backlash else None
        flanks.append(Flank(i, row, drive, back, gap, stiffness, viscous, radius, normal_factor))
    return tuple(flanks)
