"""Natural frequencies, mode shapes, energy shares, nodes and modal damping.

Natural frequencies are the singular values of D = √k · B · 1/√m (incidence form): K is never
formed, so neither a rigid link nor a tiny hub costs digits, and the rigid-body modes are exactly
the ones the topology says. The plain SVD is the fast path; where its norm-wise error bound is
not good enough for the smallest frequency, the one-sided Jacobi SVD (LAPACK dgejsv) takes over,
which is accurate to the relative rounding of each entry.

References
----------
Demmel, Gu, Eisenstat, Slapničar, Veselić, Drmač, "Computing the singular value decomposition with
high relative accuracy", Linear Algebra Appl. 299 (1999) 21-80; Drmač & Veselić, "New fast and
accurate Jacobi SVD algorithm I, II", SIAM J. Matrix Anal. Appl. 29 (2008).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from engine.case import CaseData
from engine.errors import InternalError
from engine.train import Train, build_train

__all__ = [
    "ModalDamping",
    "Modes",
    "Node",
    "SubdividedModes",
    "damped_eigenvalues",
    "modal_damping",
    "modal_damping_matrix",
    "modes_of",
    "natural_modes",
    "state_matrix",
]

Floats = NDArray[np.float64]

#: Above this estimated relative error of the lowest frequency the Jacobi SVD is used.
SVD_ERROR_LIMIT = 2e-13
#: Wanted relative accuracy of frequencies where shaft inertia is distributed.
SUBDIVISION_TOLERANCE = 1e-3
#: At most this many modes are refined, and this many segments are used for all shafts together.
SUBDIVISION_MODES, SUBDIVISION_SEGMENTS = 10, 400


@dataclass(frozen=True)
class Node:
    """A point of a mode that stands still.

    Parameters
    ----------
    mode : int
        Elastic mode, counted from 1. [count]
    element : str
        Element on which it lies. [name]
    position : float
        Distance from the From end over the element's length. [1]
    """

    mode: int
    element: str
    position: float


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a train, rigid-body modes first, then elastic ones in rising frequency.

    Parameters
    ----------
    omega : ndarray, shape (n_modes,)
        Natural angular frequency, exactly 0 for rigid modes. [rad/s]
    n_rigid : int
        Number of rigid-body modes, counted from the topology. [count]
    shape : ndarray, shape (n_dof, n_modes)
        Mode shapes at unit modal mass, in running direction. [rad/√(kg m²)]
    row_torque : ndarray, shape (n_rows, n_modes)
        Elastic torque of each incidence row at unit modal coordinate. [N m]
    row_twist : ndarray, shape (n_rows, n_modes)
        Deflection of each row at unit modal coordinate. [rad]
    strain_share : ndarray, shape (n_elements, n_modes)
        Share of the strain energy in each element; zero for rigid modes. [1]
    kinetic_share : ndarray, shape (n_stations, n_modes)
        Share of the kinetic energy at each station. [1]
    algorithm : str
        ``svd`` or ``jacobi``. [word]
    """

    omega: Floats
    n_rigid: int
    shape: Floats
    row_torque: Floats
    row_twist: Floats
    strain_share: Floats
    kinetic_share: Floats
    algorithm: str

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, shape (n_modes,). [Hz]"""
        return self.omega / (2.0 * math.pi)

    @property
    def n_modes(self) -> int:
        """Number of modes. [count]"""
        return len(self.omega)

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
    root_mass = np.sqrt(train.inertia)
    root_k = np.sqrt(train.stiffness)
    n, n_rows = train.n_dof, train.n_rows
    omegas, shapes, torques = [], [], []
    n_rigid, algorithm = 0, "svd"
    for dofs, rows, grounded in _components(train):
        if not grounded:
            n_rigid += 1
            rigid = np.zeros(n)
            ratio = train.dof_ratio[dofs]
            rigid[dofs] = ratio / math.sqrt(float(np.sum(train.inertia[dofs] * ratio**2)))
            omegas.append(np.zeros(1))
            shapes.append(rigid[:, None])
            torques.append(np.zeros((n_rows, 1)))
        count = len(dofs) - (0 if grounded else 1)
        if count == 0:
            continue
        D = root_k[rows, None] * train.incidence[np.ix_(rows, dofs)] / root_mass[dofs]
        u, sigma, v, used = _singular_triplets(D, count)
        algorithm = used if used == "jacobi" else algorithm
        shape, torque = np.zeros((n, count)), np.zeros((n_rows, count))
        shape[dofs] = v / root_mass[dofs, None]
        torque[rows] = root_k[rows, None] * u * sigma
        omegas.append(sigma)
        shapes.append(shape)
        torques.append(torque)
    omega = np.concatenate(omegas)
    order = np.argsort(omega, kind="stable")
    omega = omega[order]
    shape = np.concatenate(shapes, axis=1)[:, order]
    torque = np.concatenate(torques, axis=1)[:, order]
    return _with_energies(train, omega, n_rigid, shape, torque, algorithm)


def _components(train: Train) -> list[tuple[NDArray[np.int64], NDArray[np.int64], bool]]:
    """Degrees of freedom and stiff rows of every part that only dampers join, and if grounded."""
    B = train.incidence
    stiff = train.stiffness > 0.0
    label = np.arange(train.n_dof)
    for row in np.flatnonzero(stiff):
        touched = label[np.flatnonzero(B[row])]
        label[np.isin(label, touched)] = touched.min()
    parts = []
    for head in np.unique(label):
        dofs = np.flatnonzero(label == head)
        rows = np.flatnonzero(stiff & np.any(B[:, dofs] != 0.0, axis=1))
        grounded = bool(np.any(np.count_nonzero(B[rows], axis=1) == 1))
        parts.append((dofs, rows, grounded))
    return parts


def _singular_triplets(D: Floats, count: int) -> tuple[Floats, Floats, Floats, str]:
    """The `count` largest singular triplets of D, ascending, and the algorithm used."""
    u, sigma, vt = np.linalg.svd(D, full_matrices=False)
    loss = np.finfo(float).eps * max(D.shape) * sigma[0]
    if loss <= SVD_ERROR_LIMIT * sigma[count - 1]:
        used = "svd"
        v = vt.T
    else:
        used = "jacobi"
        u, sigma, v = _jacobi(D)
    keep = slice(count - 1, None, -1) if count == len(sigma) else np.arange(count)[::-1]
    u, sigma, v = u[:, keep], sigma[keep], v[:, keep]
    if not (np.all(np.isfinite(sigma)) and sigma[0] > 0.0):
        raise InternalError(
            f"expected {count} elastic modes, the smallest singular value is {sigma[0]:.3g}"
        )
    return u, sigma, v, used


def _jacobi(D: Floats) -> tuple[Floats, Floats, Floats]:
    """Jacobi SVD of D in falling order; LAPACK wants at least as many rows as columns.

    The graded side must be the row side: rows scaled by √k are handled by pivoting, columns by
    the one-sided rotations, hence joba = G (D1·C·D2 with both scalings arbitrary).
    """
    wide = D.shape[0] < D.shape[1]
    A = np.array(D.T if wide else D, order="F")
    sva, u, v, work, _, info = lapack.dgejsv(A, joba=3, jobu=0, jobv=0, jobr=0, jobt=0, jobp=0)
    if info != 0:
        raise InternalError(f"the Jacobi SVD did not converge (LAPACK info {info})")
    sigma = np.asarray(sva) * (work[0] / work[1])
    u = np.asarray(u)[:, : A.shape[1]]
    return (np.asarray(v), sigma, u) if wide else (u, sigma, np.asarray(v))


def _with_energies(
    train: Train, omega: Floats, n_rigid: int, shape: Floats, torque: Floats, algorithm: str
) -> Modes:
    """Energy shares, and twists without cancellation: torque over stiffness."""
    k = train.stiffness[:, None]
    twist = np.where(k > 0.0, torque / np.where(k > 0.0, k, 1.0), train.incidence @ shape)
    safe = np.where(omega > 0.0, omega, 1.0)
    share_of_row = np.where(omega > 0.0, torque * twist / safe**2, 0.0)
    strain = np.zeros((len(train.elements), len(omega)))
    np.add.at(strain, train.row_element, np.where(k > 0.0, share_of_row, 0.0))
    nodes = train.node_matrix() @ shape
    kinetic = train.node_inertia[:, None] * nodes**2
    return Modes(
        omega, n_rigid, shape, torque, twist, strain, kinetic[: train.n_stations], algorithm
    )


@dataclass(frozen=True, eq=False)
class SubdividedModes:
    """Modes of a case whose shafts may carry inertia of their own.

    Parameters
    ----------
    train : Train
        The train, shafts with density subdivided. [SI]
    modes : Modes
        Its modes. [SI]
    segments : tuple of (str, int)
        Number of segments of each subdivided shaft. [count]
    frequency_error : float
        Estimated largest relative error of the wanted frequencies. [1]
    """

    train: Train
    modes: Modes
    segments: tuple[tuple[str, int], ...]
    frequency_error: float


def natural_modes(
    case: CaseData,
    highest_frequency: float | None = None,
    tolerance: float = SUBDIVISION_TOLERANCE,
) -> SubdividedModes:
    """Modes of a case; shafts with density are subdivided until the wanted frequencies are right.

    The error of lumped segments falls with the square of their number; Richardson's estimate
    from two subdivisions is compared with the tolerance.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    highest_frequency : float, optional
        Frequencies up to here are refined, at least one and at most ten; default 1.25 times
        twice the line frequency, or the first ten modes. [Hz]
    tolerance : float, optional
        Wanted relative error. [1]

    Returns
    -------
    SubdividedModes
        Train and modes. [SI]
    """
    heavy = [str(e.element) for e in case.elements if e.density]
    if not heavy:
        train = build_train(case)
        return SubdividedModes(train, modes_of(train), (), 0.0)
    if highest_frequency is None:
        line = case.ratings.line_frequency
        highest_frequency = 2.5 * line if line else math.inf
    count = 2
    train = build_train(case, dict.fromkeys(heavy, 1))
    modes = modes_of(train)
    while True:
        finer_train = build_train(case, dict.fromkeys(heavy, count))
        finer = modes_of(finer_train)
        error = _refinement_error(modes, finer, highest_frequency)
        train, modes = finer_train, finer
        if error <= tolerance or 2 * count * len(heavy) > SUBDIVISION_SEGMENTS:
            return SubdividedModes(train, modes, tuple((name, count) for name in heavy), error)
        count *= 2


def _refinement_error(coarse: Modes, fine: Modes, highest: float) -> float:
    """Largest estimated error of the wanted frequencies; infinite while modes are missing."""
    wanted = fine.elastic_frequency
    wanted = wanted[: max(1, min(SUBDIVISION_MODES, int(np.sum(wanted <= highest))))]
    if len(coarse.elastic_frequency) < len(wanted):
        return math.inf
    change = np.abs(coarse.elastic_frequency[: len(wanted)] / wanted - 1.0)
    return float(np.max(change)) / 3.0 if len(wanted) else 0.0


def nodes_of(train: Train, modes: Modes) -> tuple[Node, ...]:
    """Where the mode shapes cross zero inside an element.

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
    angle = train.node_matrix() @ modes.shape
    found = []
    for mode in range(modes.n_rigid, modes.n_modes):
        for element, name in enumerate(train.elements):
            rows = np.flatnonzero(train.row_element == element)
            for i, row in enumerate(rows):
                ends = np.flatnonzero(train.node_incidence[row])
                if len(ends) != 2 or np.any(np.abs(train.node_incidence[row][ends]) != 1.0):
                    continue
                start, end = sorted(ends, key=lambda n: -train.node_incidence[row][n])
                a, b = angle[start, mode], angle[end, mode]
                if a * b < 0.0:
                    place = (i + a / (a - b)) / len(rows)
                    found.append(Node(mode - modes.n_rigid + 1, name, float(place)))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class ModalDamping:
    """Damping of each mode, and what the modal form leaves out.

    Parameters
    ----------
    ratio : ndarray, shape (n_modes,)
        Fraction of critical damping; zero for rigid modes. [1]
    structural : ndarray, shape (n_modes,)
        Part of it that is stated or hysteretic, without the dampers. [1]
    rate : ndarray, shape (n_modes,)
        Coefficient d of q̈ + d q̇ + ω² q, also for rigid modes. [1/s]
    neglected : float
        Largest off-diagonal term of the modal damping matrix. [1/s]
    neglected_modes : tuple of int
        The pair of modes (counted from 0, rigid first) it couples. [indices]
    coupling : float
        Largest |d_ij| ω_j / |ω_i² − ω_j²|: the part of one mode that appears in another; small
        against one means the modal form is good. [1]
    """

    ratio: Floats
    structural: Floats
    rate: Floats
    neglected: float
    neglected_modes: tuple[int, int]
    coupling: float


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
    n, r = modes.n_modes, modes.n_rigid
    stated = np.full(n, case.damping_ratio or 0.0)
    stated[:r] = 0.0
    for row in case.mode_damping:
        if row.mode is not None and row.damping_ratio is not None and r + row.mode - 1 < n:
            stated[r + row.mode - 1] = row.damping_ratio
    physical = modal_damping_matrix(train, modes)
    loss = np.zeros(len(train.elements))
    loss[train.row_element] = train.loss_factor
    safe = np.where(modes.omega > 0.0, modes.omega, 1.0)
    structural = np.where(modes.omega > 0.0, stated + 0.5 * (loss @ modes.strain_share), 0.0)
    ratio = np.where(modes.omega > 0.0, structural + 0.5 * np.diag(physical) / safe, 0.0)
    rate = np.where(modes.omega > 0.0, 2.0 * ratio * modes.omega, np.diag(physical))
    off = np.abs(physical - np.diag(np.diag(physical)))
    pair = np.unravel_index(int(np.argmax(off)), off.shape)
    gap = np.abs(modes.omega[:, None] ** 2 - modes.omega[None, :] ** 2)
    speed = np.maximum(modes.omega[:, None], modes.omega[None, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        coupling = np.where(off > 1e-12 * np.max(np.diag(physical)), off * speed / gap, 0.0)
    return ModalDamping(
        ratio,
        structural,
        rate,
        float(off[pair]),
        (int(pair[0]), int(pair[1])),
        float(np.nanmax(coupling)),
    )


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
    nodal = train.ground_damping[:, None] * modes.shape
    return np.asarray((modes.row_twist.T * train.viscous) @ modes.row_twist + modes.shape.T @ nodal)


def state_matrix(train: Train) -> Floats:
    """State matrix of the viscously damped train for the state [θ, θ̇].

    Parameters
    ----------
    train : Train
        The train. [SI]

    Returns
    -------
    ndarray, shape (2 n_dof, 2 n_dof)
        A of ẋ = A x. [mixed: 1, 1/s, 1/s²]
    """
    B, m = train.incidence, train.inertia[:, None]
    K = (B.T * train.stiffness) @ B
    n = train.n_dof
    return np.block([[np.zeros((n, n)), np.eye(n)], [-K / m, -train.damping_matrix() / m]])


def damped_eigenvalues(train: Train, modes: Modes) -> NDArray[np.complex128]:
    """Eigenvalues of the viscously damped train, in modal coordinates.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its undamped modes. [SI]

    Returns
    -------
    ndarray of complex, shape (2 n_modes,)
        Eigenvalues, sorted by magnitude of the imaginary part. [1/s]
    """
    n = modes.n_modes
    damping = modal_damping_matrix(train, modes)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(modes.omega**2), -damping]])
    values = np.linalg.eigvals(A)
    return np.asarray(values[np.lexsort((values.real, np.abs(values.imag)))], dtype=np.complex128)
