"""The shaft line as arrays: masses, stiffnesses and the incidence matrix.

Every elastic element is one row of an incidence matrix B: its deflection is B θ, its torque
k ∘ (B θ), and K = Bᵀ diag(k) B is never formed, so a rigid link beside a soft coupling costs no
digits. Angles are positive in each station's own running direction, hence B holds speed ratios
and no signs; `Train.sense` gives the physical direction. Rigid gear meshes are merged exactly:
the stations of one rigid group share one degree of freedom.

A gear with bearing data also moves laterally: two more nodes x and y, in metres, after all others.
Their "inertia" is a mass, their speed ratio 0, and the row of each of its meshes has entries on
them. The bearing is a row of its own for each of them, which belongs to no element (−1).

SI and radians; every element is seen at its own shaft's speed, a mesh on its From side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from engine.arrays import Floats, Ints, Mask

#: Element of an incidence row that belongs to none: a bearing.
NO_ELEMENT = -1


@dataclass(frozen=True)
class RigidMesh:
    """A gear mesh without elasticity; its torque comes from the equilibrium of its To side."""

    element: int  #: Index of the element.
    to_side: tuple[int, ...]  #: Nodes of the same rigid group that the mesh drives. [indices]
    from_ratio: float  #: Speed ratio of the From station. [1]


@dataclass(frozen=True)
class ShaftEnd:
    """An end of a shaft with inertia of its own: half a piece beyond the middle of its last piece.

    The torque of a piece is that of its middle. At the end it is that and what the half piece takes:
    torque of the row + inertia × acceleration of the node.
    """

    element: int  #: Index of the element.
    row: int  #: Row of the piece at that end. [index]
    node: int  #: Node of that end. [index]
    inertia: float  #: Of half a piece; negative at the To end. [kg m²]


@dataclass(frozen=True)
class GearBody:
    """A gear that moves laterally on its bearings.

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
    shaft_ends: tuple[ShaftEnd, ...]  #: Ends of shafts with inertia of their own that can turn.
    orientation: Floats  #: +1 if From is the drive end, −1 if To is. [1] Shape (n_elements,).
    #: Stations on the driven side of each element. [mask] Shape (n_elements, n_stations).
    beyond: Mask
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

    @cached_property
    def viscous_shown(self) -> Mask:
        """Rows whose reported torque includes their viscous part, shape (n_rows,). [mask]

        Dampers without a spring, and elements with a clearance: teeth separate when their whole torque
        is zero, and what they pass on must not depend on whether that is simulated.
        """
        included = self.stiffness <= 0.0
        included[[f.drive_row for f in self.flanks if f.gap]] = True
        return np.asarray(included)

    @cached_property
    def element_rows(self) -> Ints:
        """Rows that belong to an element: all but those of the bearings. [indices]"""
        return np.flatnonzero(self.row_element != NO_ELEMENT)

    @cached_property
    def output_element(self) -> Ints:
        """Element of each torque that is known: rows of elements, rigid meshes, ends of shafts. [index]"""
        rows = self.row_element[self.element_rows]
        others = [m.element for m in self.rigid_meshes] + [e.element for e in self.shaft_ends]
        return np.concatenate([rows, np.array(others, dtype=np.int64)])

    @cached_property
    def element_loss_factor(self) -> Floats:
        """Loss factor of each element, shape (n_elements,); 0 for a rigid mesh. [1]"""
        loss, rows = np.zeros(len(self.elements)), self.element_rows
        loss[self.row_element[rows]] = self.loss_factor[rows]
        return loss

    @cached_property
    def dof_ratio(self) -> Floats:
        """Speed of each degree of freedom over the reference speed, shape (n_dof,). [1]"""
        ratio = np.zeros(self.n_dof)
        ratio[self.node_dof] = self.speed_ratio / self.node_scale
        return ratio

    @property
    def ground_damping(self) -> Floats:
        """Damping to ground of each degree of freedom, shape (n_dof,). [N m s/rad]"""
        own = self.node_damping * self.node_scale**2
        return np.asarray(np.bincount(self.node_dof, own, self.n_dof), dtype=np.float64)

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
