"""A train with clearances as pieces: linear systems that share one basis.

Each flank is free or loaded (`engine.stepping.contact_loop`); each combination is a piece with stiffness
rows of its own: a free flank counts nothing, a loaded one with its stiffness; what its damping adds
is a force. The pieces share one
M-orthonormal basis, the kept modes of the train with all teeth in contact, completed by what these
modes cannot do: the free flight of the parts that a clearance sets apart, and the static deflection
under a tooth force. A piece is made when a run first comes to it.

Stated damping ratios act on the modes of each piece; a mode of free flight has none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.model.modes import Modes
from engine.model.topology import group_heads
from engine.model.train import Flank, ShaftEnd, Train
from engine.numerics.same_bits import doublings, norm, product, right_basis, singular_values, solve
from engine.start.electrical_damping import NO_SWINGS, Swings
from engine.stepping.contact_loop import FREE

#: A direction whose part outside the basis is smaller than this is in it already.
INSIDE = 1e-9
#: Normalised rows: singular values below this share of the largest are zero.
RANK = 1e-10


@dataclass(frozen=True, eq=False)
class SharedBasis:
    """The basis that all pieces share, and the train in it."""

    train: Train  #: The train. [SI]
    flanks: tuple[Flank, ...]  #: The clearances that are modelled.
    #: M-orthonormal; rigid modes of the closed train first, exactly. [1/√(kg m²)] Shape (n_dof,
    #: m).
    vectors: Floats
    n_rigid: int  #: Rigid modes of the closed train.
    #: Deflection of each row of the incidence matrix; exactly zero in the rigid modes. [rad] Shape
    #: (n_rows, m).
    rows: Floats
    back_rows: Floats  #: Compression of each back flank. [rad] Shape (n_flanks, m).
    #: Frequencies of the kept modes of the closed train. [rad/s] Shape (n_kept,).
    closed_omega: Floats
    #: Stated damping ratio along each basis vector; zero for the rigid ones. [1] Shape (m,).
    stated: Floats
    #: Shapes (n_dof, n_left) of the modes left out, and row torques (n_rows, n_left). [SI]
    left_shape: Floats
    left_torque: Floats  #: Likewise. [SI]
    #: Their flexibility beyond what the basis covers. [s²] Shape (n_left, n_left).
    left_flexibility: Floats

    @cached_property
    def drive_sign(self) -> Floats:
        """+1 where the row of a clearance is positive with its drive flank loaded. [1]"""
        return np.array([self.train.orientation[f.element] for f in self.flanks], dtype=np.float64)

    @cached_property
    def drive_rows(self) -> Floats:
        """Compression of each drive flank, shape (n_flanks, m). [rad]"""
        places = [f.drive_row for f in self.flanks]
        return np.asarray(self.rows[places] * self.drive_sign[:, None])


@dataclass(frozen=True, eq=False)
class ForceLocations:
    """Where torques act, in the order of the forces; those of the flanks come after them."""

    #: Stations of motors, loads and prescribed torques, then nodes whose dampers to ground act as
    #: forces. [indices] Shape (n_nodes,).
    nodes: Ints
    #: Rows of the incidence matrix whose dampers act as forces. [indices] Shape (n_rows,).
    rows: Ints
    first_damper: int  #: Number of forces before the first damper.
    #: Coefficients of the dampers. [N m s/rad] Shape (n_nodes + n_rows − first_damper,).
    viscous: Floats

    @property
    def n_forces(self) -> int:
        """Number of these forces. [count]"""
        return len(self.nodes) + len(self.rows)


@dataclass(frozen=True, eq=False)
class ContactSystem:
    """One linear system."""

    stiffness: Floats  #: λ and damping coefficient of its modes. [1/s², 1/s] Shape (m,).
    rate: Floats  #: Likewise. [1/s², 1/s] Shape (m,).
    turn: Floats  #: Basis coordinates from its modal coordinates, orthogonal. [1] Shape (m, m).
    reach: Floats  #: Forces to modes. [rad/√(kg m²)] Shape (m, n_forces).
    #: Modal force of the gaps of loaded back flanks. [N m rad/√(kg m²)] Shape (m,).
    constant: Floats
    #: Coefficients of the dampers that act as forces; zero for the flanks. [N m s/rad] Shape
    #: (n_dampers,).
    viscous: Floats
    #: Element torques from modal coordinates and velocities. [N m, N m s] Shape (n_outputs, m).
    output_position: Floats
    output_velocity: Floats  #: Likewise. [N m, N m s] Shape (n_outputs, m).
    output_force: Floats  #: Element torques from forces. [1] Shape (n_outputs, n_forces).
    output_constant: Floats  #: Element torques of the gaps. [N m] Shape (n_outputs,).


def shared_basis(
    train: Train,
    modes: Modes,
    flanks: Sequence[Flank],
    keep: Mask,
    stated: Floats,
    stated_elsewhere: float,
) -> SharedBasis:
    """The basis of all pieces.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        All its modes with the teeth in contact. [SI]
    flanks : sequence of Flank
        Clearances to be modelled. [count]
    keep : ndarray of bool, shape (n_modes,)
        Modes that are integrated. [mask]
    stated : ndarray, shape (n_modes,)
        Stated damping ratio of each mode. [1]
    stated_elsewhere : float
        Damping ratio of what the basis has beyond these modes. [1]

    Returns
    -------
    SharedBasis
        The basis. [SI]
    """
    left_out = ~keep
    outside = modes.shape[:, left_out]
    torque = modes.row_torque[:, left_out]
    omega = modes.omega[left_out]
    added = np.zeros((int(left_out.sum()), 0))
    if len(omega):
        candidates = []
        for flank in flanks:
            flight = _flight(train, flank)
            candidates.append(product(outside.T, train.inertia * flight))
            candidates.append(modes.row_twist[flank.drive_row, left_out] / omega**2)
        added = _orthonormal(candidates, len(omega))
    vectors = np.concatenate([modes.shape[:, keep], product(outside, added)], axis=1)
    rows = np.concatenate(
        [modes.row_twist[:, keep], product(modes.row_twist[:, left_out], added)], axis=1
    )
    n_rigid = modes.n_rigid
    rows[:, :n_rigid] = 0.0
    to_dof = train.node_matrix()
    back = np.array([product(product(f.back, to_dof), vectors) for f in flanks])
    back = back.reshape(len(flanks), vectors.shape[1])
    back[:, :n_rigid] = 0.0
    flexibility = np.diag(1.0 / omega**2) if len(omega) else np.zeros((0, 0))
    if added.shape[1]:
        stiff = product((added * omega[:, None] ** 2).T, added)
        flexibility = flexibility - product(added, solve(stiff, added.T))
    ratio = np.concatenate([stated[keep], np.full(added.shape[1], stated_elsewhere)])
    return SharedBasis(
        train,
        tuple(flanks),
        vectors,
        n_rigid,
        rows,
        back,
        modes.omega[keep],
        ratio,
        outside,
        torque,
        flexibility,
    )


def _flight(train: Train, flank: Flank) -> Floats:
    """Rigid rotation of the part beyond the To side once the flank is free, per degree of freedom."""
    cut = np.ones(train.n_rows, dtype=np.bool_)
    cut[flank.drive_row] = False
    group = _groups(train.incidence[cut])
    driving_row = train.incidence[flank.drive_row]
    turning = train.dof_ratio
    ends = np.flatnonzero((driving_row != 0.0) & (turning != 0.0))
    if len(ends) == 0:
        return np.zeros(train.n_dof)
    return np.where(group == group[ends[-1]], turning, 0.0)


def _groups(rows: Floats) -> Ints:
    """Number of the connected part each degree of freedom belongs to."""
    joined = [np.flatnonzero(row).tolist() for row in rows]
    pairs = tuple((ends[0], other) for ends in joined for other in ends[1:])
    return np.array(group_heads(rows.shape[1], pairs), dtype=np.int64)


def _orthonormal(candidates: Sequence[Floats], n: int) -> Floats:
    """Orthonormal columns that span the candidates, without those that are there already."""
    columns: list[Floats] = []
    for vector in candidates:
        size = norm(vector)
        if size == 0.0:
            continue
        rest = vector / size
        for _ in range(2):  # twice is enough (Kahan)
            for column in columns:
                rest = rest - column * float(product(column, rest))
        length = norm(rest)
        if length > INSIDE:
            columns.append(rest / length)
    return np.array(columns).T if columns else np.zeros((n, 0))


class ContactSystems:
    """The pieces met so far, as growing tables for the compiled loop."""

    def __init__(
        self,
        basis: SharedBasis,
        places: ForceLocations,
        mean_speed: Floats,
        read_speed: Floats,
        shows_scale: Floats,
        swings: Swings = NO_SWINGS,
    ) -> None:
        self.basis = basis
        self.places = places
        self.pieces: list[ContactSystem] = []
        self._keys: list[int] = []
        #: Mean speed from velocities in the common basis, shape (m,). [√(1/(kg m²))]
        self.mean_speed = mean_speed
        #: Speed at which the curves of each motor are read, likewise, shape (n_motors, m). Where teeth are apart
        #: the mean speed is still that of the whole shaft line: no contact changes its momentum, so that no torque
        #: jumps where teeth separate and meet.
        self.read_speed = read_speed
        self.swings = swings
        #: Forces to the common basis, shape (m, n_forces). [rad/√(kg m²)]
        self.common_reach = common_reach(basis, places)
        self._scale = shows_scale
        #: As the loop takes them, with room for more pieces; those in them so far.
        self._tables: tuple[Any, ...] = (np.zeros(0, dtype=np.int64), np.zeros((0, 0)))
        self._filled = 0
        self._fastest = 0.0  # largest λ of these
        self._step = 0.0

    def index_of(self, contact: Sequence[int]) -> int:
        """Place in the tables of the piece with these contacts, made if it is new.

        `contact` is that of each flank: all drive flanks, then all back flanks.
        """
        loaded = tuple(int(c) != FREE for c in contact)
        key = sum(1 << i for i, state in enumerate(loaded) if state)
        if key in self._keys:
            return self._keys.index(key)
        self.pieces.append(_make_piece(self, loaded))
        self._keys.append(key)
        return len(self._keys) - 1

    @cached_property
    def contacts(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Gap, stiffness, damping and torque scale of each flank. [rad, N m/rad, SI, N m]"""
        flanks = self.basis.flanks
        scale = [self._scale_of(f) for f in flanks]
        gap = [math.inf if f.gap is None else f.gap for f in flanks]
        return (
            np.array([0.0] * len(flanks) + gap, dtype=np.float64),
            np.array(2 * [f.stiffness for f in flanks], dtype=np.float64),
            np.array(2 * [f.viscous for f in flanks], dtype=np.float64),
            np.array(2 * scale, dtype=np.float64),
        )

    def tables(self, step: float, sampled: float) -> tuple[Any, ...]:
        """Arguments of the compiled loop; it fills in the coefficients of the steps it takes.

        Parameters
        ----------
        step : float
            Base step. [s]
        sampled : float
            Angular frequency that the base step samples. [rad/s]

        Returns
        -------
        tuple
            As `engine.stepping.contact_loop.advance_pieces` takes it. [SI]
        """
        n = len(self.pieces)
        new = [float(np.max(x.stiffness, initial=0.0)) for x in self.pieces[self._filled :]]
        self._fastest = max([self._fastest, *new])
        levels = 3 + 2 * doublings(self._fastest / sampled)
        if n > len(self._tables[0]) or levels > self._tables[-1].shape[1]:
            self._grow(n, levels)
        for i in range(self._filled, n):
            row = self._row(self.pieces[i])
            for table, values in zip(self._tables, (self._keys[i], *row), strict=False):
                table[i] = values
        self._filled = n
        if step != self._step:
            self._step = step
            self._tables[-1][:] = 0  # coefficients are those of other steps
        return self._tables

    def _row(self, piece: ContactSystem) -> tuple[Any, ...]:
        """Values of one piece, in the order of the tables."""
        flank_rows = product(self._flank_rows, piece.turn)
        return (
            piece.stiffness,
            piece.rate,
            piece.reach.T,
            piece.constant,
            product(self.mean_speed, piece.turn),
            product(self.read_speed, piece.turn),
            self.swings.torque_over_velocity(np.sqrt(piece.stiffness), piece.reach),
            flank_rows.T,
            piece.viscous,
            self._visibility(piece, flank_rows),
            piece.turn,
            piece.output_position.T,
            piece.output_velocity.T,
            piece.output_force.T,
            piece.output_constant,
            np.array(np.any(piece.output_velocity), dtype=np.int64),
            product(self._centres, piece.turn).T,
        )

    def _grow(self, n: int, levels: int) -> None:
        """Room for more pieces and levels; what the pieces are stays, coefficients of steps are made again."""
        old = self._tables
        levels = max(levels, old[-1].shape[1])
        room = n if not self._filled else max(2 * n, len(old[0]))
        solved = 2 * (len(self.places.viscous) + 2 * len(self.basis.flanks))
        m = self.basis.vectors.shape[1]
        of_steps = ((levels, 2, 2, m), (levels, 2, 4, m), (levels, solved, solved), (levels,))
        new: list[Any] = [np.full(room, -1, dtype=np.int64)]
        new += [np.zeros((room, *v.shape), dtype=v.dtype) for v in self._row(self.pieces[0])]
        new += [np.zeros((room, *shape)) for shape in of_steps[:3]]
        new.append(np.zeros((room, levels), dtype=np.int64))
        for table, before in zip(new[: -len(of_steps)], old, strict=False) if self._filled else ():
            table[: self._filled] = before[: self._filled]
        self._tables = tuple(new)

    def _scale_of(self, flank: Flank) -> float:
        """Torque scale of the element of a flank. [N m]"""
        return float(np.max(self._scale[self.output_element == flank.element], initial=0.0))

    def _visibility(self, piece: ContactSystem, flank_rows: Floats) -> Floats:
        """Largest share of an output's scale that one unit of each mode is."""
        position = np.abs(piece.output_position) / self._scale[:, None]
        _, stiffness, _, scale = self.contacts
        known = scale > 0.0
        flank = stiffness[known, None] * np.abs(flank_rows[known]) / scale[known, None]
        return np.asarray(np.max(np.concatenate([position, flank]), axis=0, initial=0.0))

    @cached_property
    def _flank_rows(self) -> Floats:
        """Compression of each flank, shape (n_flanks, m)."""
        return np.concatenate([self.basis.drive_rows, self.basis.back_rows])

    @cached_property
    def output_element(self) -> Ints:
        """Element of each output. [index]"""
        return self.basis.train.output_element

    @cached_property
    def bearings(self) -> tuple[Floats, Floats]:
        """Stiffness and damping of the bearings of each gear that moves laterally. [N/m, N s/m]"""
        bodies = self.basis.train.bodies
        return (
            np.array([body.stiffness for body in bodies], dtype=np.float64),
            np.array([body.damping for body in bodies], dtype=np.float64),
        )

    @cached_property
    def _centres(self) -> Floats:
        """Lateral motion of these gears, x and y of each, shape (2 n_bodies, m)."""
        train = self.basis.train
        nodes = [node for body in train.bodies for node in (body.node_x, body.node_y)]
        return np.asarray(self.basis.vectors[train.node_dof[nodes]])


def common_reach(basis: SharedBasis, places: ForceLocations) -> Floats:
    """Φᵀ of every force in the common basis: at nodes, across rows, on drive and on back flanks.

    Parameters
    ----------
    basis : SharedBasis
        The common basis. [SI]
    places : ForceLocations
        Where the forces act. [indices]

    Returns
    -------
    ndarray, shape (m, n_forces)
        Forces to the basis. [rad/√(kg m²)]
    """
    train = basis.train
    dof, scale = train.node_dof[places.nodes], train.node_scale[places.nodes]
    return np.concatenate(
        [
            (basis.vectors[dof] * scale[:, None]).T,
            basis.rows[places.rows].T,
            basis.drive_rows.T,
            basis.back_rows.T,
        ],
        axis=1,
    )


def _make_piece(pieces: ContactSystems, loaded: tuple[bool, ...]) -> ContactSystem:
    """Modes, damping and outputs of one combination of contacts."""
    basis, places = pieces.basis, pieces.places
    train, flanks = basis.train, basis.flanks
    factor = np.ones(train.n_rows)
    factor[[flank.drive_row for flank in flanks]] = loaded[: len(flanks)]
    back_factor = np.array(loaded[len(flanks) :], dtype=np.float64)
    stiffness = train.stiffness * factor
    back_stiffness = np.array([f.stiffness for f in flanks], dtype=np.float64) * back_factor
    omega, turn = _modes_of_piece(basis, stiffness, back_stiffness)
    rate = _rates(basis, places, stiffness, back_stiffness, omega, turn)
    gap = np.array([f.gap if f.gap is not None else 0.0 for f in flanks], dtype=np.float64)
    hold = back_stiffness * np.where(back_factor > 0.0, gap, 0.0)
    constant = product(basis.back_rows.T, hold)
    constant[: basis.n_rigid] = 0.0
    own = places.viscous.copy()  # a flank damps in contact only, as a force of its own
    on_flank = np.isin(places.rows, [f.drive_row for f in flanks])
    own[len(places.nodes) - places.first_damper :][on_flank] = 0.0
    viscous = np.concatenate([own, np.zeros(2 * len(flanks))])  # the loop knows the contacts
    reach = product(turn.T, pieces.common_reach)
    constant = product(turn.T, constant)
    outputs = _outputs(pieces, stiffness, back_stiffness, hold, omega, turn, reach, constant)
    return ContactSystem(omega**2, rate, turn, reach, constant, viscous, *outputs)


def _modes_of_piece(
    basis: SharedBasis, stiffness: Floats, back_stiffness: Floats
) -> tuple[Floats, Floats]:
    """Frequencies of a piece, rising, and the rotation from its modes to the common basis."""
    m, r = basis.vectors.shape[1], basis.n_rigid
    closed = np.array_equal(stiffness, basis.train.stiffness) and not np.any(back_stiffness)
    if closed and m == len(basis.closed_omega):
        return basis.closed_omega.copy(), np.eye(m)
    strained = np.concatenate(
        [
            np.sqrt(stiffness)[:, None] * basis.rows[:, r:],
            np.sqrt(back_stiffness)[:, None] * basis.back_rows[:, r:],
        ]
    )
    free = max(_nullity(basis, stiffness, back_stiffness) - r, 0)
    sigma, turned = right_basis(strained, m - r - free)
    turn = np.zeros((m, m))
    turn[:r, :r] = np.eye(r)
    turn[r:, r:] = turned[:, ::-1]
    sigma = sigma[::-1]
    return np.concatenate([np.zeros(r), sigma]), turn


def _nullity(basis: SharedBasis, stiffness: Floats, back_stiffness: Floats) -> int:
    """Free motions of a piece, counted on rows of unit size so that no stiffness enters."""
    train = basis.train
    rows = train.incidence[stiffness > 0.0]
    loaded = np.flatnonzero(back_stiffness > 0.0)
    if len(loaded):
        to_dof = train.node_matrix()
        rows = np.concatenate([rows, [product(basis.flanks[i].back, to_dof) for i in loaded]])
    size = np.max(np.abs(rows), axis=1, keepdims=True, initial=0.0)
    rows = rows / np.where(size > 0.0, size, 1.0)
    if len(rows) == 0:
        return train.n_dof
    values = singular_values(rows)
    return train.n_dof - int(np.count_nonzero(values > RANK * values[0]))


def _rates(
    basis: SharedBasis,
    places: ForceLocations,
    stiffness: Floats,
    back_stiffness: Floats,
    omega: Floats,
    turn: Floats,
) -> Floats:
    """Damping coefficient of each mode: stated, hysteretic, and the dampers that act modally."""
    train, r = basis.train, basis.n_rigid
    elastic = omega > 0.0
    share = turn[r:] ** 2
    total = share.sum(axis=0)
    stated = (product(basis.stated[r:], share)) / np.where(total > 0.0, total, 1.0)
    square = np.where(elastic, omega, 1.0) ** 2
    strain = stiffness[:, None] * (product(basis.rows, turn)) ** 2 / square
    loss = product(train.loss_factor, strain)
    back_strain = back_stiffness[:, None] * (product(basis.back_rows, turn)) ** 2 / square
    loss = loss + product(train.loss_factor[[f.drive_row for f in basis.flanks]], back_strain)
    rate = np.where(elastic, 2.0 * (stated + 0.5 * loss) * omega, 0.0)
    viscous = train.viscous.copy()
    viscous[places.rows] = 0.0
    viscous[[f.drive_row for f in basis.flanks]] = 0.0  # a flank damps in contact only
    damping = train.node_damping.copy()
    damping[places.nodes[places.first_damper :]] = 0.0
    ground = np.zeros(train.n_dof)
    np.add.at(ground, train.node_dof, damping * train.node_scale**2)
    modal = product(viscous, (product(basis.rows, turn)) ** 2) + product(
        ground, (product(basis.vectors, turn)) ** 2
    )
    return np.asarray(rate + modal)


def _outputs(
    pieces: ContactSystems,
    stiffness: Floats,
    back_stiffness: Floats,
    hold: Floats,
    omega: Floats,
    turn: Floats,
    reach: Floats,
    constant: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Element torques from the modal state of one piece (signs and meaning as in `outputs`)."""
    basis, places = pieces.basis, pieces.places
    train, flanks = basis.train, basis.flanks
    n_forces = reach.shape[1]
    viscous_shown = train.viscous_shown[:, None]
    rows = product(basis.rows, turn)
    torque_q = stiffness[:, None] * rows
    torque_v = np.where(viscous_shown, train.viscous[:, None] * rows, 0.0)
    torque_f = np.zeros((train.n_rows, n_forces))
    torque_0 = np.zeros(train.n_rows)
    if basis.left_shape.shape[1]:
        n = len(places.nodes)
        dof, scale = train.node_dof[places.nodes], train.node_scale[places.nodes]
        left_reach = (basis.left_shape[dof] * scale[:, None]).T
        torque_f[:, :n] = product(product(basis.left_torque, basis.left_flexibility), left_reach)
    for i, flank in enumerate(flanks):
        row, sign = flank.drive_row, float(basis.drive_sign[i])
        back = product(basis.back_rows[i], turn)
        torque_q[row] -= sign * back_stiffness[i] * back
        torque_f[row] = torque_v[row] = 0.0
        torque_f[row, places.n_forces + i] = -sign  # the damping of the drive flank
        torque_f[row, places.n_forces + len(flanks) + i] = sign
        torque_0[row] = sign * hold[i]
    on_row = [torque_q, torque_v, torque_f, torque_0]
    rows_out = train.element_rows
    facing = train.orientation[train.row_element[rows_out]]
    out = [part[rows_out] * (facing if part.ndim == 1 else facing[:, None]) for part in on_row]
    for mesh in train.rigid_meshes:
        extra = _rigid_mesh(basis, places, mesh, on_row, omega, turn, reach, constant)
        out = [np.concatenate([a, b]) for a, b in zip(out, extra, strict=True)]
    for end in train.shaft_ends:
        extra = _shaft_end(basis, end, on_row, omega, turn, reach, constant)
        out = [np.concatenate([a, b]) for a, b in zip(out, extra, strict=True)]
    return out[0], out[1], out[2], out[3]


def _rigid_mesh(
    basis: SharedBasis,
    places: ForceLocations,
    mesh: Any,
    on_row: list[Floats],
    omega: Floats,
    turn: Floats,
    reach: Floats,
    constant: Floats,
) -> list[Floats]:
    """Torque of a rigid mesh from the power balance of its To side (see `outputs`)."""
    train = basis.train
    nodes = np.array(mesh.to_side)
    ratio = train.speed_ratio[nodes] / mesh.from_ratio
    weight = ratio * train.node_inertia[nodes] * train.node_scale[nodes]
    inertial = product(weight, product(basis.vectors[train.node_dof[nodes]], turn))
    draw = product(train.node_incidence[:, nodes], ratio)
    applied = np.zeros(reach.shape[1])
    applied[: len(places.nodes)] = [float(ratio[nodes == s].sum()) for s in places.nodes]
    # dampers beside a spring draw torque too; those without one are in the torque of their row
    sprung = train.stiffness[places.rows] > 0.0
    applied[len(places.nodes) : places.n_forces] = np.where(sprung, draw[places.rows], 0.0)
    sign = float(train.orientation[mesh.element])
    return [
        (sign * (-inertial * omega**2 + product(draw, on_row[0])))[None],
        (sign * (product(draw, on_row[1])))[None],
        (sign * (product(inertial, reach) - applied + product(draw, on_row[2])))[None],
        np.array([sign * float(product(inertial, constant) + product(draw, on_row[3]))]),
    ]


def _shaft_end(
    basis: SharedBasis,
    end: ShaftEnd,
    on_row: list[Floats],
    omega: Floats,
    turn: Floats,
    reach: Floats,
    constant: Floats,
) -> list[Floats]:
    """Torque at the end of a shaft: that of its last piece and of the half piece beyond its middle."""
    train = basis.train
    weight = end.inertia * train.node_scale[end.node]
    inertial = weight * (product(basis.vectors[train.node_dof[end.node]], turn))
    sign = float(train.orientation[end.element])
    return [
        (sign * (-inertial * omega**2 + on_row[0][end.row]))[None],
        (sign * on_row[1][end.row])[None],
        (sign * (product(inertial, reach) + on_row[2][end.row]))[None],
        np.array([sign * float(product(inertial, constant) + on_row[3][end.row])]),
    ]
