"""Element torques as linear functions of modal coordinates and applied torques.

torque = Y_q q + Y_v q̇ + Y_f f, with q in modal coordinates and f the torques at the force
stations. Elastic elements report their elastic torque k·twist; an element of stiffness 0 its
viscous torque; one with a clearance the sum of both; a rigid mesh what the equilibrium of its To side
demands, inertias included; the end of a shaft with inertia of its own what its last piece and the half
piece beyond its middle demand.
The rows of bearings belong to no element and are left out.
Damping appears in that equilibrium exactly as it does in the equations of motion: with its full
matrix (`damping` given), or only on each mode for itself, as in a start.
Modes left out of q enter by their static deflection (residual flexibility), so that a truncated
set still gives the right slow torque. Positive: the drive end pushes in the running direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.model.modes import Modes
from engine.model.train import RigidMesh, Train
from engine.numerics.same_bits import product


@dataclass(frozen=True, eq=False)
class TorqueOutputs:
    """Element torques from modal coordinates, velocities and forces."""

    #: Element of each output; a subdivided shaft has one a segment, and one an end. Shape (n_outputs,).
    element: Ints
    position: Floats  #: Y_q. [N m] Shape (n_outputs, n_modes).
    velocity: Floats  #: Y_v. [N m s] Shape (n_outputs, n_modes).
    force: Floats  #: Y_f. [1] Shape (n_outputs, n_forces).

    def of_modes(self, keep: Mask, omega: Floats, reach: Floats) -> TorqueOutputs:
        """The same of the modes that are integrated; the others get their static correction.

        Parameters
        ----------
        keep : ndarray of bool, shape (n_modes,)
            Modes that are integrated. [mask]
        omega : ndarray, shape (n_modes,)
            Natural frequencies of all. [rad/s]
        reach : ndarray, shape (n_modes, n_forces)
            What each force does to each mode. [rad/√(kg m²)]

        Returns
        -------
        TorqueOutputs
            Matrices for the kept modes. [SI]
        """
        left_out = ~keep & (omega > 0.0)
        flexible = self.position[:, left_out] / omega[left_out] ** 2
        return TorqueOutputs(
            self.element,
            np.ascontiguousarray(self.position[:, keep]),
            np.ascontiguousarray(self.velocity[:, keep]),
            self.force + product(flexible, reach[left_out]),
        )


def force_reach(train: Train, modes: Modes, stations: Ints) -> Floats:
    """What a unit torque at each force station does to each mode, and its angle in each mode.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]
    stations : ndarray of int, shape (n_forces,)
        Force stations. [indices]

    Returns
    -------
    ndarray, shape (n_modes, n_forces)
        Φᵀ at those stations. [rad/√(kg m²)]
    """
    dof, scale = train.node_dof[stations], train.node_scale[stations]
    return np.ascontiguousarray((modes.shape[dof] * scale[:, None]).T)


def torque_outputs(
    train: Train,
    modes: Modes,
    stations: Ints,
    *,
    dampers: Ints | None = None,
    damping: Floats | None = None,
) -> TorqueOutputs:
    """Output matrices of every element.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        All its modes. [SI]
    stations : ndarray of int, shape (n_forces,)
        Stations where torques act. [indices]
    dampers : ndarray of int, shape (n_dampers,), optional
        Rows of the incidence matrix whose viscous torque enters as one more force each, after
        those of the stations. [indices]
    damping : ndarray, shape (n_modes, n_modes), optional
        ΦᵀCΦ where the dampers act with their full matrix; default: as modal damping. [1/s]

    Returns
    -------
    TorqueOutputs
        Matrices for all modes. [SI]
    """
    rows = np.zeros(0, dtype=np.int64) if dampers is None else dampers
    reach = np.concatenate([force_reach(train, modes, stations), modes.row_twist[rows].T], axis=1)
    own = train.element_rows
    sign = train.orientation[train.row_element[own]][:, None]
    elastic, viscous_included = train.stiffness[own, None] > 0.0, train.viscous_shown[own, None]
    position = sign * np.where(elastic, modes.row_torque[own], 0.0)
    velocity = sign * np.where(
        viscous_included, train.viscous[own, None] * modes.row_twist[own], 0.0
    )
    rows_q, rows_v = [position], [velocity]
    rows_f = [np.zeros((len(own), reach.shape[1]))]
    for mesh in train.rigid_meshes:
        q, v, f = _rigid_mesh_row(train, modes, reach, stations, mesh, damping)
        rows_q.append(q[None])
        rows_v.append(v[None])
        rows_f.append(f[None])
    for end in train.shaft_ends:
        inertial = end.inertia * train.node_scale[end.node] * modes.shape[train.node_dof[end.node]]
        facing = float(train.orientation[end.element])
        q = modes.row_torque[end.row] - inertial * modes.omega**2
        v = np.zeros(modes.n_modes) if damping is None else product(-inertial, damping)
        rows_q.append(facing * q[None])
        rows_v.append(facing * v[None])
        rows_f.append(facing * product(inertial, reach)[None])
    return TorqueOutputs(
        train.output_element,
        np.concatenate(rows_q),
        np.concatenate(rows_v),
        np.concatenate(rows_f),
    )


def _rigid_mesh_row(
    train: Train,
    modes: Modes,
    reach: Floats,
    stations: Ints,
    mesh: RigidMesh,
    damping: Floats | None,
) -> tuple[Floats, Floats, Floats]:
    """Y_q, Y_v, Y_f of a rigid mesh, on its From side, from the power balance of its To side.

    With the full damping matrix the balance holds every torque. With modal damping the
    accelerations are those that the elastic and applied torques alone would give,
    Φ (Φᵀf − ω² q): every damping force then belongs to the inertia it slows, which is what the
    same mesh with a very high stiffness reports.
    """
    nodes = np.array(mesh.to_side)
    ratio = train.speed_ratio[nodes] / mesh.from_ratio
    weight = ratio * train.node_inertia[nodes] * train.node_scale[nodes]
    inertial = product(weight, modes.shape[train.node_dof[nodes]])  # Σ ratio J Φ
    rows = product(train.node_incidence[:, nodes], ratio)  # torque the rows draw from these nodes
    elastic = train.stiffness[:, None] > 0.0
    q = -inertial * modes.omega**2 + product(rows, np.where(elastic, modes.row_torque, 0.0))
    viscous = train.viscous[:, None] * modes.row_twist
    v = product(rows, np.where(elastic, 0.0, viscous) if damping is None else viscous)
    if damping is not None:
        weight = ratio * train.node_damping[nodes] * train.node_scale[nodes]
        v += product(weight, modes.shape[train.node_dof[nodes]]) - product(inertial, damping)
    applied = np.zeros(reach.shape[1])
    applied[: len(stations)] = [float(ratio[nodes == s].sum()) for s in stations]
    sign = float(train.orientation[mesh.element])
    return sign * q, sign * v, sign * (product(inertial, reach) - applied)
