"""Natural frequencies, mode shapes, energy shares, nodes and modal damping.

Natural frequencies are the singular values of D = √k · B · 1/√m (incidence form): K is never
formed, so neither a rigid link nor a tiny hub costs digits, and the rigid-body modes are exactly
the ones the topology says. `engine.numerics.singular_values` finds them, each to its own rounding.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from engine.arrays import Complexes, Floats, Ints, Mask
from engine.case.data import CaseData
from engine.model.topology import group_heads
from engine.model.train import Train
from engine.numerics.same_bits import eigenvalues, product
from engine.numerics.singular_values import singular_triplets

#: A mode with less strain in the elements than this is lateral motion of gears alone.
SIDEWAYS_ALONE = 1e-9
#: Rotations below this share of the largest of their mode are rounding, not motion.
STANDSTILL = 1e-12


@dataclass(frozen=True)
class Node:
    """A point of a mode that stands still."""

    mode: int  #: Elastic mode, counted from 1.
    element: str  #: Element on which it lies.
    position: float  #: Distance from the From end over the element's length. [1]


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a train, rigid-body modes first, then elastic ones in rising frequency.

    Deflections and shares of energy are calculated when they are asked for.
    """

    train: Train  #: The train. [SI]
    #: Natural angular frequency, exactly 0 for rigid modes. [rad/s] Shape (n_modes,).
    omega: Floats
    n_rigid: int  #: Number of rigid-body modes, counted from the topology.
    #: Mode shapes at unit modal mass, in running direction; of a transverse freedom its
    #: displacement. [rad/√(kg m²), m/√(kg m²)] Shape (n_dof, n_modes).
    shape: Floats
    #: Elastic torque of each incidence row at unit modal coordinate. [N m] Shape (n_rows,
    #: n_modes).
    row_torque: Floats
    #: ``svd``, ``jacobi`` or ``chain``; of several parts the last that is no ``svd``.
    algorithm: str

    @cached_property
    def row_twist(self) -> Floats:
        """Deflection of each row at unit modal coordinate, shape (n_rows, n_modes). [rad]

        Torque over stiffness where there is any: without cancellation.
        """
        soft = self.train.stiffness <= 0.0
        twist = self.row_torque / np.where(soft, 1.0, self.train.stiffness)[:, None]
        if soft.any():
            twist[soft] = product(self.train.incidence[soft], self.shape)
        return np.asarray(twist)

    @cached_property
    def strain_share(self) -> Floats:
        """Share of the strain energy in each element, shape (n_elements, n_modes); zero for rigid modes. [1]"""
        train, share = self.train, self._row_share
        if np.array_equal(train.row_element, np.arange(len(train.elements))):
            return share
        strain, own = np.zeros((len(train.elements), self.n_modes)), train.element_rows
        np.add.at(strain, train.row_element[own], share[own])
        return strain

    @cached_property
    def kinetic_share(self) -> Floats:
        """Share of the kinetic energy in the rotation of each station, shape (n_stations, n_modes). [1]"""
        n, train = self.train.n_stations, self.train
        share = self.shape[train.node_dof[:n]]
        share *= train.node_scale[:n, None]
        share *= share
        share *= train.node_inertia[:n, None]
        return share

    @cached_property
    def bearing_share(self) -> Floats:
        """Share of the strain energy in the bearings of each gear that moves laterally. [1]

        Shape (n_bodies, n_modes).
        """
        share = np.zeros((len(self.train.bodies), self.n_modes))
        for i, body in enumerate(self.train.bodies):
            share[i] = self._row_share[[body.row_x, body.row_y]].sum(axis=0)
        return share

    @cached_property
    def sideways_share(self) -> Floats:
        """Share of the kinetic energy in the lateral motion of that gear, shape (n_bodies, n_modes). [1]"""
        share = np.zeros((len(self.train.bodies), self.n_modes))
        for i, body in enumerate(self.train.bodies):
            displacement = self.shape[self.train.node_dof[[body.node_x, body.node_y]]]
            share[i] = body.mass * np.sum(displacement**2, axis=0)
        return share

    @cached_property
    def _row_share(self) -> Floats:
        """Share of the strain energy in each row; zero without torque: in rigid modes and soft rows."""
        safe = np.where(self.omega > 0.0, self.omega, 1.0)
        share = self.row_torque * self.row_twist
        share /= safe**2
        return share

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, shape (n_modes,). [Hz]"""
        return self.omega / (2.0 * math.pi)

    @property
    def n_modes(self) -> int:
        """Number of modes. [count]"""
        return len(self.omega)

    @property
    def twists(self) -> Mask:
        """Which modes strain an element; the others are lateral motion of gears alone. [mask]"""
        return np.asarray(self.strain_share.sum(axis=0) > SIDEWAYS_ALONE)

    @property
    def elastic_frequency(self) -> Floats:
        """Frequencies of the elastic modes only. [Hz]"""
        return self.frequency[self.n_rigid :]


def modes_of(train: Train) -> Modes:
    """Natural modes of a train.

    Parameters
    ----------
    train : Train
        The train. [SI]

    Returns
    -------
    Modes
        All modes. [SI]

    Raises
    ------
    InternalError
        If the singular values contradict the number of rigid modes of the topology.
    """
    return modes_of_trains([train])[0]


def modes_of_trains(trains: Sequence[Train]) -> list[Modes]:
    """Natural modes of trains; those of one structure are calculated together, each with the bits that it has alone.

    Parameters
    ----------
    trains : sequence of Train
        The trains. [SI]

    Returns
    -------
    list of Modes
        All modes of each. [SI]

    Raises
    ------
    InternalError
        If the singular values contradict the number of rigid modes of the topology.
    """
    if len(trains) == 1:  # without a copy of its incidence matrix, which may be large
        return list(_modes_of_alike(trains))
    alike: dict[object, list[int]] = {}
    for i, train in enumerate(trains):
        springs = (train.stiffness > 0.0).tobytes()
        form = train.incidence.shape, train.incidence.tobytes(), springs, train.dof_ratio.tobytes()
        alike.setdefault(form, []).append(i)
    modes: dict[int, Modes] = {}
    for places in alike.values():
        modes |= zip(places, _modes_of_alike([trains[i] for i in places]), strict=True)
    return [modes[i] for i in range(len(trains))]


def _modes_of_alike(trains: Sequence[Train]) -> Iterator[Modes]:
    """Modes of trains with the same incidence matrix and springs in the same rows."""
    parts = _components(trains[0])
    found = [_modes_of_part(trains, *part) for part in parts]
    n_rigid = sum(not grounded for *_, grounded in parts)
    for i, train in enumerate(trains):
        omega, shape, torque = (array[i] for array in found[0][:3])
        if len(parts) > 1:
            omega = np.concatenate([part[0][i] for part in found])
            order = np.argsort(omega, kind="stable")
            omega = omega[order]
            shape = np.concatenate([part[1][i] for part in found], axis=1)[:, order]
            torque = np.concatenate([part[2][i] for part in found], axis=1)[:, order]
        words = [part[3][i] for part in found]
        algorithm = next((used for used in reversed(words) if used != "svd"), "svd")
        yield Modes(train, omega, n_rigid, shape, torque, algorithm)


def _modes_of_part(
    trains: Sequence[Train], dofs: Ints, rows: Ints, grounded: bool
) -> tuple[Floats, Floats, Floats, tuple[str, ...]]:
    """Angular frequencies of a part of each train, shapes and row torques over the whole of it, and the algorithm."""
    first, many = trains[0], len(trains)
    n, n_rows, count = len(dofs), len(rows), len(dofs) - (0 if grounded else 1)
    whole = n == first.n_dof and n_rows == first.n_rows
    incidence = first.incidence if whole else first.incidence[np.ix_(rows, dofs)]
    inertia = np.stack([train.inertia[dofs] for train in trains])
    root_k = np.sqrt(np.stack([train.stiffness[rows] for train in trains]))
    root_mass = np.sqrt(inertia)
    used: tuple[str, ...] = ("svd",) * many
    torque, omega, shape = np.zeros((many, n_rows, n)), np.zeros((many, n)), np.zeros((many, n, n))
    if count:
        torque, omega, shape, used = singular_triplets(root_k, incidence, root_mass, count)
    torque *= root_k[:, :, None]  # in place: of a long train each is large
    torque *= omega[:, None, :]
    shape /= root_mass[:, :, None]
    if not grounded:
        ratio = first.dof_ratio[dofs]
        mass = np.sum(inertia * ratio**2, axis=1)
        shape[:, :, 0] = ratio / np.sqrt(mass)[:, None]
    if whole:
        return omega, shape, torque, used
    shapes, torques = np.zeros((many, first.n_dof, n)), np.zeros((many, first.n_rows, n))
    shapes[:, dofs], torques[:, rows] = shape, torque
    return omega, shapes, torques, used


def _components(train: Train) -> list[tuple[Ints, Ints, bool]]:
    """Degrees of freedom and stiff rows of every part that only dampers join, and if grounded."""
    ends: list[list[int]] = [[] for _ in range(train.n_rows)]
    for row, dof in zip(*(i.tolist() for i in np.nonzero(train.incidence)), strict=True):
        ends[row].append(dof)
    stiff = [row for row, k in enumerate(train.stiffness.tolist()) if k > 0.0 and ends[row]]
    heads = group_heads(
        train.n_dof, tuple((ends[row][0], other) for row in stiff for other in ends[row][1:])
    )
    dofs: dict[int, list[int]] = {}
    for dof, head in enumerate(heads):
        dofs.setdefault(head, []).append(dof)
    sideways = (train.dof_ratio == 0.0).tolist()  # their bearings hold no shaft
    rows: dict[int, list[int]] = {head: [] for head in dofs}
    for row in stiff:
        rows[heads[ends[row][0]]].append(row)
    return [
        (
            np.array(dofs[h], dtype=np.int64),
            np.array(rows[h], dtype=np.int64),
            sideways[h]
            or any(len(ends[row]) == 1 and not sideways[ends[row][0]] for row in rows[h]),
        )
        for h in sorted(dofs)
    ]


def nodes_of(train: Train, modes: Modes) -> tuple[Node, ...]:
    """Where the mode shapes cross zero in a shaft or coupling.

    A station that stands still is the end (position 0 or 1) of an element beside it.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    tuple of Node
        In the order of modes and elements. [count]
    """
    angle = train.node_scale[:, None] * modes.shape[train.node_dof]
    visible = STANDSTILL * np.max(np.abs(angle), axis=0, initial=0.0)
    own = train.row_element[train.element_rows]
    rows_of = np.bincount(own, minlength=len(train.elements))
    first = np.concatenate([[0], np.cumsum(rows_of)])
    nodes = []
    for row, element in enumerate(train.row_element):
        ends = np.flatnonzero(train.node_incidence[row])
        factors = train.node_incidence[row, ends]
        shaft = sorted(factors) == [-1.0, 1.0] and np.ptp(train.sense[ends]) == 0.0
        if not shaft or train.stiffness[row] <= 0.0:
            continue  # to ground, a mesh, a bearing or a damper: nothing between its ends can stand still
        start, end = ends[np.argsort(-factors)]
        a, b = angle[start], angle[end]
        crossing = ((a >= 0.0) != (b >= 0.0)) & (np.maximum(np.abs(a), np.abs(b)) > visible)
        crossing[: modes.n_rigid] = False
        for mode in np.flatnonzero(crossing):
            place = (row - first[element] + a[mode] / (a[mode] - b[mode])) / rows_of[element]
            nodes.append((int(mode) - modes.n_rigid + 1, int(element), float(place)))
    return tuple(Node(mode, train.elements[e], place) for mode, e, place in sorted(nodes))


@dataclass(frozen=True, eq=False)
class ModalDamping:
    """Damping of each mode, and what the modal form leaves out."""

    ratio: Floats  #: Fraction of critical damping; zero for rigid modes. [1] Shape (n_modes,).
    #: Part of it that is stated or hysteretic, without the dampers. [1] Shape (n_modes,).
    structural: Floats
    #: Coefficient d of q̈ + d q̇ + ω² q, also for rigid modes. [1/s] Shape (n_modes,).
    rate: Floats
    neglected: float  #: Largest off-diagonal term of the modal damping matrix. [1/s]
    #: Largest |d_ij| ω_j / |ω_i² − ω_j²|: the part of one mode that appears in another; small
    #: against one means the modal form is good. [1]
    coupling: float


def stated_damping(case: CaseData, modes: Modes) -> Floats:
    """Damping ratio that DampingRatio and ModeDamping state, without dampers and loss factors.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    ndarray, shape (n_modes,)
        Fraction of critical damping; zero for rigid modes. [1]
    """
    stated = np.full(modes.n_modes, case.damping_ratio or 0.0)
    stated[: modes.n_rigid] = 0.0
    for row in case.mode_damping:
        if row.mode is not None and row.damping_ratio is not None:
            if modes.n_rigid + row.mode - 1 < modes.n_modes:
                stated[modes.n_rigid + row.mode - 1] = row.damping_ratio
    return stated


def modal_damping(case: CaseData, train: Train, modes: Modes) -> ModalDamping:
    """Damping ratio of each mode from everything the case says about damping.

    ζ = DampingRatio or ModeDamping + ½ Σ loss factor × strain-energy share + ½ φᵀCφ/ω (contract).

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    ModalDamping
        Ratios, rates, and the largest neglected term. [SI]
    """
    stated = stated_damping(case, modes)
    physical = modal_damping_matrix(train, modes)
    loss = train.element_loss_factor
    safe = np.where(modes.omega > 0.0, modes.omega, 1.0)
    # without loss factors nobody needs the shares of energy yet
    hysteretic = 0.5 * product(loss, modes.strain_share) if np.any(loss) else 0.0
    structural = np.where(modes.omega > 0.0, stated + hysteretic, 0.0)
    own = physical.diagonal().copy()
    ratio = np.where(modes.omega > 0.0, structural + 0.5 * own / safe, 0.0)
    rate = np.where(modes.omega > 0.0, 2.0 * ratio * modes.omega, own)
    np.fill_diagonal(physical, 0.0)
    i, j = np.nonzero(np.abs(physical) > 1e-12 * np.max(own))
    off, squares = np.abs(physical[i, j]), modes.omega**2
    with np.errstate(divide="ignore", invalid="ignore"):
        part = off * np.maximum(modes.omega[i], modes.omega[j]) / np.abs(squares[i] - squares[j])
    neglected = float(np.max(np.abs(physical)))
    coupling = float(np.fmax.reduce(part, initial=0.0))  # without 0/0: two rigid modes
    return ModalDamping(ratio, structural, rate, neglected, coupling)


def modal_damping_matrix(train: Train, modes: Modes) -> Floats:
    """Physical damping in modal coordinates, ΦᵀCΦ.

    Taken from the rows, so that a stiff row's twist keeps its digits.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    ndarray, shape (n_modes, n_modes)
        Modal damping matrix. [1/s]
    """
    rows, nodes = np.flatnonzero(train.viscous), np.flatnonzero(train.ground_damping)
    twist, shape = modes.row_twist[rows], modes.shape[nodes]
    matrix = product(twist.T * train.viscous[rows], twist)
    return np.asarray(matrix + product(shape.T, train.ground_damping[nodes, None] * shape))


def damped_eigenvalues(train: Train, modes: Modes, structural: Floats | None = None) -> Complexes:
    """Eigenvalues of the damped train, in modal coordinates.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its undamped modes. [SI]
    structural : ndarray, shape (n_modes,), optional
        Damping ratio of each mode besides the dampers, stated or hysteretic. [1]

    Returns
    -------
    ndarray of complex, shape (2 n_modes,)
        Eigenvalues, sorted by magnitude of the imaginary part. [1/s]
    """
    n = modes.n_modes
    damping = modal_damping_matrix(train, modes)
    if structural is not None:
        damping = damping + np.diag(2.0 * structural * modes.omega)
    speed = np.diag(modes.omega)  # state (ω q, q̇): all entries of one size
    values = eigenvalues(np.block([[np.zeros((n, n)), speed], [-speed, -damping]]))
    return np.asarray(values[np.lexsort((values.real, np.abs(values.imag)))], dtype=np.complex128)
