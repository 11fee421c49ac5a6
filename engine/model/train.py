"""The shaft line as arrays: masses, stiffnesses and the incidence matrix.

Every elastic element is one row of an incidence matrix B: its deflection is B θ, its torque
k ∘ (B θ), and K = Bᵀ diag(k) B is never formed, so a rigid link beside a soft coupling costs no
digits. Angles are positive in each station's own running direction, hence B holds speed ratios
and no signs; `Train.sense` gives the physical direction. Rigid gear meshes are merged exactly:
the stations of one rigid group share one degree of freedom.

A gear with bearing data also moves sideways: two more nodes x and y, in metres, after all others.
Their "inertia" is a mass, their speed ratio 0, and the row of each of its meshes has entries on
them. The bearing is a row of its own for each of them, which belongs to no element (−1).

SI and radians; every element is seen at its own shaft's speed, a mesh on its From side.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, ElementRow, MeshRow
from engine.errors import ModelError
from engine.model.gears import FlankNormals, flank_normals, line_of_action

__all__ = [
    "Flank",
    "GearBody",
    "Link",
    "RigidMesh",
    "Train",
    "build_train",
    "has_clearance",
    "line_of_action",
    "link_of",
    "shaft_inertia",
    "shaft_stiffness",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: An entry of a unit vector below this is the rounding of a zero.
ROUNDED_ZERO = 1e-14
#: Element of an incidence row that belongs to none: a bearing.
NO_ELEMENT = -1


@dataclass(frozen=True)
class RigidMesh:
    """A gear mesh without elasticity; its torque comes from the equilibrium of its To side."""

    element: int  #: Index of the element.
    to_side: tuple[int, ...]  #: Nodes of the same rigid group that the mesh drives. [indices]
    from_ratio: float  #: Speed ratio of the From station. [1]


@dataclass(frozen=True)
class GearBody:
    """A gear that moves sideways on its bearings.

    Its x axis lies along the drive flank's line of action in its first mesh, so that the motion
    across it, which no tooth of a single mesh sees, is exactly uncoupled. Bearings are isotropic:
    the choice of axes changes no result.
    """

    station: int  #: The gear.
    node_x: int  #: Its transverse nodes. [indices]
    node_y: int  #: Likewise. [indices]
    row_x: int  #: Incidence rows of its bearing. [indices]
    row_y: int  #: Likewise. [indices]
    mass: float  #: Mass of the body. [kg]
    stiffness: float  #: Bearing stiffness, the same in every direction. [N/m]
    damping: float  #: Bearing damping. [N s/m]
    #: Direction of its x axis, as the angle of a line of centres is measured. [rad]
    axis_angle: float


@dataclass(frozen=True, eq=False)
class Flank:
    """The two sides on which an element can touch: tooth flanks, or the stops of a coupling."""

    element: int  #: Index of the element.
    drive_row: int  #: Its incidence row.
    #: Deflection from the node angles (and displacements), positive where the drive flank is
    #: compressed. [1, 1/m] Shape (n_nodes,).
    drive: Floats
    #: The same of the back flank, before the gap is subtracted. Without bearings it is −drive. [1,
    #: 1/m] Shape (n_nodes,).
    back: Floats
    #: Total clearance as an angle on the From side; None where there is none. [rad]
    gap: float | None
    stiffness: float  #: Of either flank, on the From side. [N m/rad]
    viscous: float  #: Contact damping, on the From side. [N m s/rad]
    #: Base radius of the From gear; None for a coupling, or a mesh without pitch radius. [m]
    base_radius: float | None
    normal_factor: float  #: Normal tooth force over torque / base radius, 1 / cos β_b. [1]


@dataclass(frozen=True, eq=False)
class Train:
    """A train as arrays.

    Nodes are the stations, then the inner points of subdivided shafts, then x and y of each gear
    on bearings: there angle means displacement [m], inertia mass [kg], and speed ratio and ground
    damping are 0.
    """

    stations: tuple[str, ...]  #: Names, in the order of the case.
    elements: tuple[str, ...]  #: Likewise.
    #: Speed of each node over the speed of the reference shaft. [1] Shape (n_nodes,).
    speed_ratio: Floats
    #: +1 or −1: physical direction of rotation against the reference shaft. [1] Shape (n_nodes,).
    sense: Floats
    node_inertia: Floats  #: Inertia at the node's own speed. [kg m²] Shape (n_nodes,).
    #: Viscous damping to ground at the node's own speed. [N m s/rad] Shape (n_nodes,).
    node_damping: Floats
    node_dof: Ints  #: Degree of freedom each node belongs to. Shape (n_nodes,).
    #: Angle of the node over the angle of its degree of freedom. [1] Shape (n_nodes,).
    node_scale: Floats
    inertia: Floats  #: Inertia of each degree of freedom. [kg m²] Shape (n_dof,).
    #: Of each row of the incidence matrix. [N m/rad, N m s/rad, 1] Shape (n_rows,).
    stiffness: Floats
    viscous: Floats  #: Likewise. [N m/rad, N m s/rad, 1] Shape (n_rows,).
    loss_factor: Floats  #: Likewise. [N m/rad, N m s/rad, 1] Shape (n_rows,).
    #: Deflection of each row from the node angles. [1] Shape (n_rows, n_nodes).
    node_incidence: Floats
    incidence: Floats  #: The same from the degrees of freedom. [1] Shape (n_rows, n_dof).
    row_element: Ints  #: Element each row belongs to; −1 for a row of a bearing. Shape (n_rows,).
    rigid_meshes: tuple[RigidMesh, ...]  #: Meshes merged exactly.
    orientation: Floats  #: +1 if From is the drive end, −1 if To is. [1] Shape (n_elements,).
    #: Stations on the driven side of each element. [mask] Shape (n_elements, n_stations).
    beyond: NDArray[np.bool_]
    bodies: tuple[GearBody, ...]  #: Gears on bearings, in the order of the stations.
    flanks: tuple[Flank, ...]  #: Elastic gear meshes, and other elements with a clearance.

    @property
    def n_dof(self) -> int:
        """Number of degrees of freedom after merging rigid meshes. [count]"""
        return len(self.inertia)

    @property
    def n_rows(self) -> int:
        """Number of rows of the incidence matrix. [count]"""
        return len(self.stiffness)

    @property
    def n_stations(self) -> int:
        """Number of stations. [count]"""
        return len(self.stations)

    @property
    def viscous_shown(self) -> NDArray[np.bool_]:
        """Rows whose reported torque includes their viscous part, shape (n_rows,). [mask]

        Dampers without a spring, and elements with a clearance: teeth part when their whole torque
        is zero, and what they pass on must not depend on whether they are simulated as parting.
        """
        shown = self.stiffness <= 0.0
        shown[[f.drive_row for f in self.flanks if f.gap]] = True
        return np.asarray(shown)

    @property
    def element_rows(self) -> Ints:
        """Rows that belong to an element: all but those of the bearings. [indices]"""
        return np.flatnonzero(self.row_element != NO_ELEMENT)

    @property
    def element_loss_factor(self) -> Floats:
        """Loss factor of each element, shape (n_elements,); 0 for a rigid mesh. [1]"""
        loss, rows = np.zeros(len(self.elements)), self.element_rows
        loss[self.row_element[rows]] = self.loss_factor[rows]
        return loss

    @property
    def dof_ratio(self) -> Floats:
        """Speed of each degree of freedom over the reference speed, shape (n_dof,). [1]"""
        ratio = np.zeros(self.n_dof)
        ratio[self.node_dof] = self.speed_ratio / self.node_scale
        return ratio

    @property
    def ground_damping(self) -> Floats:
        """Damping to ground of each degree of freedom, shape (n_dof,). [N m s/rad]"""
        damping = np.zeros(self.n_dof)
        np.add.at(damping, self.node_dof, self.node_damping * self.node_scale**2)
        return damping

    def node_matrix(self) -> Floats:
        """Node angles from degrees of freedom.

        Returns
        -------
        ndarray, shape (n_nodes, n_dof)
            One entry a row. [1]
        """
        s = np.zeros((len(self.node_dof), self.n_dof))
        s[np.arange(len(self.node_dof)), self.node_dof] = self.node_scale
        return s

    def station_index(self, name: str) -> int:
        """Index of a station by its name.

        Parameters
        ----------
        name : str
            Station. [name]

        Returns
        -------
        int
            Index. [index]
        """
        return self.stations.index(name)

    def damping_matrix(self) -> Floats:
        """Physical viscous damping, dampers across elements and to ground.

        Returns
        -------
        ndarray, shape (n_dof, n_dof)
            C. [N m s/rad]
        """
        B = self.incidence
        return np.asarray((B.T * self.viscous) @ B + np.diag(self.ground_damping))


def shaft_stiffness(od: float, bore: float, length: float, shear_modulus: float) -> float:
    """Torsional stiffness of a round shaft, G π (D⁴ − d⁴) / 32 L.

    Parameters
    ----------
    od, bore : float
        Outer and inner diameter. [m]
    length : float
        Length. [m]
    shear_modulus : float
        Shear modulus. [Pa]

    Returns
    -------
    float
        Stiffness. [N m/rad]

    References
    ----------
    Any strength-of-materials text, e.g. Timoshenko, Strength of Materials I, § 56.
    """
    return shear_modulus * math.pi * (od**4 - bore**4) / (32.0 * length)


def shaft_inertia(od: float, bore: float, length: float, density: float) -> float:
    """Polar mass inertia of a round shaft, ρ π (D⁴ − d⁴) L / 32.

    Parameters
    ----------
    od, bore : float
        Outer and inner diameter. [m]
    length : float
        Length. [m]
    density : float
        Density. [kg/m³]

    Returns
    -------
    float
        Inertia. [kg m²]
    """
    return density * math.pi * (od**4 - bore**4) * length / 32.0


@dataclass(frozen=True)
class Link:
    """Stiffness, damping and inertia of one element, whatever they were given by."""

    #: Torsional stiffness, of a mesh on its From side; None = rigid mesh. [N m/rad]
    stiffness: float | None
    viscous: float  #: Viscous damping, likewise. [N m s/rad]
    loss_factor: float  #: Hysteretic loss factor. [1]
    inertia: float  #: Of the element itself. [kg m²]


def link_of(e: ElementRow, mesh: MeshRow | None) -> Link:
    """What an element row and its mesh row mean mechanically.

    Parameters
    ----------
    e : ElementRow
        The element. [SI]
    mesh : MeshRow or None
        Its row of Meshes. [SI]

    Returns
    -------
    Link
        With the stiffness of the geometry where none is typed. [SI]

    Raises
    ------
    ModelError
        If neither stiffness nor geometry is given.
    """
    stiffness, viscous = e.stiffness, e.damping
    shaft = e.kind != ElementKind.GEAR_MESH
    if shaft and stiffness is None and e.od and e.length and e.shear_modulus:
        stiffness = shaft_stiffness(e.od, e.id or 0.0, e.length, e.shear_modulus)
    if not shaft and mesh is not None and mesh.pitch_radius_drive:
        cos_t, share = line_of_action(mesh)
        base = mesh.pitch_radius_drive * cos_t
        if stiffness is None and mesh.mesh_stiffness:
            stiffness = mesh.mesh_stiffness * share * base**2
        if viscous is None and mesh.mesh_damping:
            viscous = mesh.mesh_damping * share * base**2
    inertia = 0.0
    if shaft and e.density and e.od and e.length:
        inertia = shaft_inertia(e.od, e.id or 0.0, e.length, e.density)
    if shaft and stiffness is None:
        raise ModelError(f"Element '{e.element}' has neither a stiffness nor the geometry for one.")
    return Link(stiffness, viscous or 0.0, e.loss_factor or 0.0, inertia)


#: Element, stiffness, viscous damping, loss factor, entries by node.
_Row = tuple[int, float, float, float, dict[int, float]]


class _Assembly:
    """Rows and nodes while a train is put together."""

    def __init__(self, case: CaseData) -> None:
        self.index = {s.station: i for i, s in enumerate(case.stations)}
        self.inertia = [s.inertia or 0.0 for s in case.stations]
        self.damping = [s.damping or 0.0 for s in case.stations]
        self.ratio = [s.speed_ratio or 1.0 for s in case.stations]
        self.rows: list[_Row] = []
        self.edges: list[tuple[int, int, int]] = []  # element, node, node (stations only)
        self.rigid: list[tuple[int, int, int]] = []

    def add(self, element: int, e: ElementRow, link: Link, segments: int) -> None:
        """Add one element as one row, or as `segments` rows in series if it has inertia."""
        ends = [self.index[n] for n in (e.from_, e.to) if n not in (None, GROUND)]
        if len(ends) == 2:
            self.edges.append((element, ends[0], ends[1]))
        if link.stiffness is None:
            self.rigid.append((element, ends[0], ends[1]))
            return
        if e.kind == ElementKind.GEAR_MESH:
            back = self.ratio[ends[0]] / self.ratio[ends[1]]
            self._row(element, link, 1, {ends[0]: 1.0, ends[1]: -back})
            return
        from_ground = e.from_ == GROUND
        chain: list[int | None] = [None] if from_ground else []
        chain += ends if len(ends) == 2 or from_ground else [ends[0], None]
        count = max(1, segments) if link.inertia and link.stiffness else 1
        self._series(element, link, count, chain)

    def _series(self, element: int, link: Link, count: int, chain: list[int | None]) -> None:
        """Segments of equal stiffness, half a segment's inertia lumped at each of its ends."""
        start, end = chain
        ratio = self.ratio[next(n for n in chain if n is not None)]
        nodes: list[int | None] = [start]
        for _ in range(count - 1):
            nodes.append(len(self.inertia))
            self.inertia.append(0.0)
            self.damping.append(0.0)
            self.ratio.append(ratio)
        nodes.append(end)
        for a, b in zip(nodes[:-1], nodes[1:], strict=True):
            entries = {n: sign for n, sign in ((a, 1.0), (b, -1.0)) if n is not None}
            self._row(element, link, count, entries)
            for n in entries:
                self.inertia[n] += 0.5 * link.inertia / count

    def _row(self, element: int, link: Link, count: int, entries: dict[int, float]) -> None:
        assert link.stiffness is not None
        self.rows.append(
            (element, link.stiffness * count, link.viscous * count, link.loss_factor, entries)
        )

    def body(self, station: int, data: _BodyData, axis: Floats) -> GearBody:
        """Add the transverse nodes of a gear and the rows of its bearing."""
        x, row = len(self.inertia), len(self.rows)
        for node in (x, x + 1):
            self.inertia.append(data.mass)
            self.damping.append(0.0)
            self.ratio.append(0.0)
            self.rows.append((NO_ELEMENT, data.stiffness, data.damping, 0.0, {node: 1.0}))
        angle = math.atan2(axis[1], axis[0])
        return GearBody(
            station, x, x + 1, row, row + 1, data.mass, data.stiffness, data.damping, angle
        )


def build_train(
    case: CaseData, segments: Mapping[str, int] | None = None, *, lateral: bool = True
) -> Train:
    """Turn a case into arrays.

    Parameters
    ----------
    case : CaseData
        The case; meant to be a checked `Case`. [SI]
    segments : mapping of str to int, optional
        Number of segments of each shaft that has inertia of its own; default 1. An element with
        a clearance stays one piece: it parts in one place. [count]
    lateral : bool, optional
        Whether gears with bearing data move sideways; False: their bearings are rigid. [flag]

    Returns
    -------
    Train
        Masses, stiffnesses, incidence. [SI]

    Raises
    ------
    ModelError
        For an element without stiffness, a node without inertia, or a gear on bearings whose mesh
        lacks stiffness or pitch radius.
    """
    meshes = {m.element: m for m in case.meshes}
    links = [link_of(e, meshes.get(e.element)) for e in case.elements]
    a = _Assembly(case)
    for i, (e, link) in enumerate(zip(case.elements, links, strict=True)):
        pieces = (segments or {}).get(str(e.element), 1)
        a.add(i, e, link, 1 if has_clearance(meshes.get(e.element)) else pieces)
    orientation, sides, reference = _drive_ends(case, a)
    internal = {m.element for m in case.meshes if m.gear_type == "internal"}
    flips = {
        i: e.kind == ElementKind.GEAR_MESH and e.element not in internal
        for i, e in enumerate(case.elements)
    }
    sense = _senses(a, len(case.stations), reference, flips)
    bodies: tuple[GearBody, ...] = ()
    backs: dict[int, dict[int, float]] = {}
    if lateral and (data := _body_data(case, a)):
        bodies, backs = _add_bodies(case, a, data, orientation, sense)
        sense = np.concatenate([sense, np.ones(2 * len(bodies))])
    ratio = np.array(a.ratio)
    inertia = np.array(a.inertia)
    dof, scale, n_dof = _merge(a.rigid, a.ratio)
    row = np.array([r for r, (*_, entries) in enumerate(a.rows) for _ in entries], dtype=np.int64)
    node = np.array([n for *_, entries in a.rows for n in entries], dtype=np.int64)
    factor = np.array([f for *_, entries in a.rows for f in entries.values()])
    node_incidence = np.zeros((len(a.rows), len(ratio)))
    node_incidence[row, node] = factor
    incidence = np.zeros((len(a.rows), n_dof))
    np.add.at(incidence, (row, dof[node]), factor * scale[node])
    dof_inertia = np.zeros(n_dof)
    np.add.at(dof_inertia, dof, inertia * scale**2)
    if np.any(dof_inertia <= 0.0):
        massless = int(np.flatnonzero(dof == int(np.argmin(dof_inertia)))[0])
        raise ModelError(f"Station '{case.stations[massless].station}' has no inertia.")
    return Train(
        stations=tuple(str(st.station) for st in case.stations),
        elements=tuple(str(e.element) for e in case.elements),
        speed_ratio=ratio,
        sense=sense,
        node_inertia=inertia,
        node_damping=np.array(a.damping),
        node_dof=dof,
        node_scale=scale,
        inertia=dof_inertia,
        stiffness=np.array([row[1] for row in a.rows]),
        viscous=np.array([row[2] for row in a.rows]),
        loss_factor=np.array([row[3] for row in a.rows]),
        node_incidence=node_incidence,
        incidence=incidence,
        row_element=np.array([row[0] for row in a.rows], dtype=np.int64),
        rigid_meshes=_rigid_meshes(a.rigid, ratio),
        orientation=orientation,
        beyond=sides,
        bodies=bodies,
        flanks=_flanks(case, a, node_incidence, orientation, backs),
    )


def _drive_ends(case: CaseData, a: _Assembly) -> tuple[Floats, NDArray[np.bool_], int]:
    """Orientation of each element, its driven side, and a station of the reference shaft."""
    sides = _driven_side(a.edges, len(case.stations), len(case.elements))
    motors = sorted({a.index[m.station] for m in case.motor_torque if m.station in a.index})
    drivers = motors or _drivers(case, a)  # without either, From is the drive end
    orientation = np.ones(len(case.elements))
    if drivers:
        reversed_ = sides[:, drivers].all(axis=1)
        orientation[reversed_] = -1.0
        sides[reversed_] = ~sides[reversed_]
    return orientation, sides, motors[0] if motors else 0


def _drivers(case: CaseData, a: _Assembly) -> list[int]:
    """Stations whose prescribed torque drives, on the average of its rows."""
    total: dict[int, float] = {}
    for p in case.torque_time:
        if p.station in a.index:
            station = a.index[p.station]
            total[station] = total.get(station, 0.0) + float(p.torque or 0.0)
    return sorted(station for station, torque in total.items() if torque > 0.0)


# --- gears on bearings, flanks --------------------------------------------------------------------


def has_clearance(mesh: MeshRow | None) -> bool:
    """Whether an element can part and cross a gap; a clearance of zero is none.

    Parameters
    ----------
    mesh : MeshRow or None
        Its row of Meshes. [SI]

    Returns
    -------
    bool
        True with a backlash or angular backlash. [flag]
    """
    return mesh is not None and bool(mesh.backlash or mesh.angular_backlash)


@dataclass(frozen=True)
class _BodyData:
    """What the Meshes table says of one gear body, in any of its rows."""

    mass: float
    stiffness: float
    damping: float


def _body_data(case: CaseData, a: _Assembly) -> dict[int, _BodyData]:
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
        a.index[name]: _BodyData(
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
    case: CaseData, a: _Assembly, data: Mapping[int, _BodyData], orientation: Floats, sense: Floats
) -> list[_Teeth]:
    """The meshes of the gears on bearings, in the order of the elements."""
    meshes = {m.element: m for m in case.meshes}
    row_of = {element: row for row, (element, *_) in enumerate(a.rows)}
    found = []
    for i, start, end in a.edges:
        e = case.elements[i]
        if e.kind != ElementKind.GEAR_MESH or not {start, end} & data.keys():
            continue
        mesh = meshes.get(e.element)
        if i not in row_of or mesh is None or not mesh.pitch_radius_drive:
            raise ModelError(
                f"A gear of mesh '{e.element}' has bearings, but the mesh has no stiffness or no "
                "pitch radius: the teeth have no line to act along."
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
        found.append(_Teeth(row_of[i], sign, driver, driven, radius, normals))
    return found


def _add_bodies(
    case: CaseData,
    a: _Assembly,
    data: Mapping[int, _BodyData],
    orientation: Floats,
    sense: Floats,
) -> tuple[tuple[GearBody, ...], dict[int, dict[int, float]]]:
    """Gears on bearings, their entries in the rows of their meshes, and the back flanks' rows.

    Compression of the drive flank, as an angle on the From side:
    [r_b θ of the driver − r_b θ of the driven + n_d·(u of the driver − u of the driven)] / r_b,From.
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
                continue  # held fast
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
    part = float(vector @ direction)
    return 0.0 if abs(part) < ROUNDED_ZERO else part


def _flanks(
    case: CaseData,
    a: _Assembly,
    node_incidence: Floats,
    orientation: Floats,
    backs: Mapping[int, Mapping[int, float]],
) -> tuple[Flank, ...]:
    """Flanks of every elastic mesh, and of every other element with a clearance."""
    meshes = {m.element: m for m in case.meshes}
    found = []
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
        found.append(Flank(i, row, drive, back, gap, stiffness, viscous, radius, normal_factor))
    return tuple(found)


def _merge(rigid: list[tuple[int, int, int]], ratio: list[float]) -> tuple[Ints, Floats, int]:
    """Degree of freedom and scale of every node after merging rigid meshes."""
    head = list(range(len(ratio)))

    def find(node: int) -> int:
        while head[node] != node:
            head[node] = head[head[node]]
            node = head[node]
        return node

    for _, a, b in rigid:
        first, second = sorted((find(a), find(b)))
        head[second] = first
    number: dict[int, int] = {}
    heads = [find(node) for node in range(len(ratio))]
    dof = np.array([number.setdefault(h, len(number)) for h in heads], dtype=np.int64)
    scale = np.array([ratio[n] / ratio[h] if n != h else 1.0 for n, h in enumerate(heads)])
    return dof, scale, len(number)


def _rigid_meshes(rigid: list[tuple[int, int, int]], ratio: Floats) -> tuple[RigidMesh, ...]:
    """Each rigid mesh with the nodes of its group that hang on its To side."""
    meshes = []
    for element, a, b in rigid:
        side = {b}
        grown = True
        while grown:
            grown = False
            for other, p, q in rigid:
                if other != element and (p in side) != (q in side):
                    side |= {p, q}
                    grown = True
        meshes.append(RigidMesh(element, tuple(sorted(side)), float(ratio[a])))
    return tuple(meshes)


def _neighbours(edges: list[tuple[int, int, int]], n: int) -> list[list[tuple[int, int]]]:
    """For each station its (element, station) neighbours."""
    near: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for element, a, b in edges:
        near[a].append((element, b))
        near[b].append((element, a))
    return near


def _driven_side(edges: list[tuple[int, int, int]], n: int, n_elements: int) -> NDArray[np.bool_]:
    """Stations on the To side of each element (none for an element to ground).

    In an open train every element cuts off the stations hanging on it: a contiguous stretch of
    the order in which a depth-first walk enters them.
    """
    near = _neighbours(edges, n)
    order: list[int] = []
    parent, start = [-1] * n, [0] * n
    size, whole = [1] * n, [(0, 0)] * n  # stations hanging on each; stretch of its whole train
    entered = [False] * n
    for root in range(n):
        if entered[root]:
            continue
        first, stack = len(order), [(root, -1)]
        while stack:
            node, up = stack.pop()
            if entered[node]:
                continue
            entered[node] = True
            parent[node], start[node] = up, len(order)
            order.append(node)
            stack.extend((other, node) for _, other in near[node] if not entered[other])
        for node in order[:first:-1]:
            size[parent[node]] += size[node]
        for node in order[first:]:
            whole[node] = (first, len(order))
    side = np.zeros((n_elements, n), dtype=np.bool_)
    place = np.array(order, dtype=np.int64)
    for element, a, b in edges:
        if parent[b] == a:
            side[element, place[start[b] : start[b] + size[b]]] = True
        else:
            low, high = whole[b]
            side[element, place[low:high]] = True
            side[element, place[start[a] : start[a] + size[a]]] = False
    return side


def _senses(a: _Assembly, n: int, reference: int, flips: Mapping[int, bool]) -> Floats:
    """Physical direction of rotation of every node; external meshes reverse it."""
    near = _neighbours(a.edges, n)
    sense = np.zeros(len(a.ratio))
    sense[reference] = 1.0
    stack = [reference]
    while stack:
        node = stack.pop()
        for element, other in near[node]:
            if sense[other] == 0.0:
                sense[other] = -sense[node] if flips[element] else sense[node]
                stack.append(other)
    if len(a.ratio) > n:
        for _, _, _, _, entries in a.rows:  # inner nodes turn with the shaft they divide
            known = [node for node in entries if sense[node] != 0.0]
            for node in entries:
                if sense[node] == 0.0 and known:
                    sense[node] = sense[known[0]]
    sense[sense == 0.0] = 1.0
    return sense
