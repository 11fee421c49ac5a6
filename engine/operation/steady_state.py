"""Harmonic response of the train, and the vibratory torques and stresses of running it.

The response is a direct complex solution of the whole train at each frequency, not a sum of
modes. Angles θ and element torques τ are unknowns together, in the incidence form,

    (−ω² M + iω C) θ + Bᵀ τ = T,      B θ − τ / (k (1 + iη) + iωc) = 0,

scaled by √m, √k and ω, so that a rigid link beside a soft coupling costs no digits: the torque
of a stiff link comes from equilibrium, not from the difference of two nearly equal angles. Element
loss factors η and dampers c enter as they are; only the stated modal damping (DampingRatio,
ModeDamping) enters through the modes, C = M Φ diag(2ζω) Φᵀ M. With the modal coordinates taken
from the twists, ω φᵀ M θ = tᵀ(τ/κ)/ω, t the row torques of the mode, no mode, however stiff, has
an entry above 2ζ.

Torques are zero-to-peak, at the speed of their own element (a mesh: From side), and include the
element's damping torque. Time dependence e^{iωt}.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Steady state
torsional analysis": 1 % zero-to-peak at motor, gear and driven equipment, UTS/25 (Mil-Std-167).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.arrays import Complexes, Floats, Ints, Mask
from engine.case.choices import StressBasis
from engine.case.data import CaseData, ElementRow
from engine.case.result_words import Judgement
from engine.fatigue.shaft_strength import notch_effect
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.excitation import Excitation, Place, excitation_places, transmitted_torque
from engine.model.modal_train import ModalTrain
from engine.model.modes import (
    Modes,
    damped_eigenvalues,
    modal_damping_matrix,
    stated_damping,
)
from engine.model.train import Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import ComplexSystems, along_first, inverse, modulus, product, times
from engine.operation.margins import SeparationMargins

#: Mil-Std-167: allowable vibratory stress is the ultimate tensile strength over this.
STRESS_DIVISOR = 25.0
#: A mode counts as undamped below this fraction of critical damping.
UNDAMPED = 1e-12
#: A frequency this near to an undamped mode is its resonance.
AT_RESONANCE = 1e-9
#: A part of such a mode below this share of its largest takes no part in it.
NO_PART = 1e-10
#: Where only parts outside such a mode are wanted, they are taken this far beside it.
BESIDE_RESONANCE = 1e-7
#: A stress this much above the allowable one is the allowable one, rounded.
STRESS_ROUNDING = 1e-9
#: Speeds of an order line over the operating range, besides its resonances.
SWEEP_POINTS = 31
#: Times a sweep looks for the largest torque between its frequencies.
SWEEP_REFINEMENTS = 3
#: Error of a sweep over what the last time added: all that is left where each time adds two thirds of the time before.
STILL_TO_GAIN = 2.0
#: Torques this near to the largest are as large but for rounding: the flattest of them is at the peak.
EQUAL_TORQUE = 1e-12
#: A frequency is at the peak if its torque is this near to the largest: it is within 1e-9 of the width of the peak.
AT_PEAK = 1e-18
#: Share of the largest torque from which another peak is looked at, too.
NEARLY_LARGEST = 0.8
#: Modes count as coupled by their dampers above this `ModalDamping.coupling`.
COUPLED = 1e-3
#: Largest number of matrix entries solved in one batch.
BATCH = 2_000_000


# --- the response of a train ----------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class HarmonicResponse:
    """Steady response to torques of one frequency. A second axis, n_loads, comes with several."""

    omega: Floats  #: Angular frequencies. [rad/s] Shape (n_freq,).
    #: Angle of each station in its running direction; infinite where unbounded. [rad] Shape
    #: (n_stations, n_freq).
    station_angle: Complexes
    #: Torque of each element, positive where the drive end pushes; of a subdivided shaft the
    #: segment or end with the largest magnitude; infinite where unbounded. [N m] Shape (n_elements,
    #: n_freq).
    element_torque: Complexes
    #: Derivative of that with the angular frequency, where it was wanted. [N m s] Same shape.
    torque_slope: Complexes | None
    #: By how much the largest torque exceeds that of the segment or end, between two segments. [1] Same shape.
    rise_between: Floats


def harmonic_response(
    train: Train,
    modes: Modes,
    omega: Floats,
    torque: Complexes | Floats,
    *,
    damping_ratio: Floats | None = None,
    slopes: bool = False,
) -> HarmonicResponse:
    """Response of a train to harmonic torques, by direct complex solution at each frequency.

    At a frequency within 1e-9 of a mode without any damping, the parts of the train that the
    torque drives in that mode are unbounded (infinite), the others are taken 1e-7 beside it. At
    frequency zero a train not held to ground turns without bound; its torques are those of a
    very low frequency.

    Parameters
    ----------
    train : Train
        The train; its dampers and loss factors act as they are. [SI]
    modes : Modes
        All its modes. [SI]
    omega : ndarray, shape (n_freq,)
        Angular frequencies, zero or positive. [rad/s]
    torque : ndarray, shape (n_stations,) or (n_stations, n_loads)
        Complex amplitude of the torque at each station, at its own speed, positive in its
        running direction; columns are loads that act one at a time. [N m]
    damping_ratio : ndarray, shape (n_modes,), optional
        Stated modal damping, in addition to the train's dampers and loss factors. [1]
    slopes : bool, optional
        Whether derivatives with the frequency are wanted, too. Default no. [1]

    Returns
    -------
    HarmonicResponse
        Angles, torques and derivatives of torques. [rad, N m, N m s]
    """
    w = np.atleast_1d(np.asarray(omega, dtype=float))
    load = np.asarray(torque, dtype=complex)
    columns = load[:, None] if load.ndim == 1 else load
    stated = np.zeros(modes.n_modes) if damping_ratio is None else damping_ratio
    undamped = _undamped(train, modes, stated)
    used = _beside_resonance(modes, undamped, w)
    solution, slope = _solve(train, modes, stated, used, _dof_force(train, columns), slopes)
    found = [_output_torque(train, modes, used, solution, columns)]
    if slope is not None:
        found.append(_output_torque(train, modes, used, slope, np.zeros_like(columns), solution))
    torques, between = _of_elements(train, *found), _rise_between_pieces(train, found[0])
    scale = train.node_scale[: train.n_stations, None, None]
    angles = scale * solution.angle[train.node_dof[: train.n_stations]]
    for i in np.flatnonzero(used != w).tolist():
        at = [a[:, :, i] for a in (angles, *torques)]
        _mark_unbounded(train, modes, undamped, w[i], columns, *at)
    if load.ndim == 1:
        angles, torques, between = angles[:, 0], [a[:, 0] for a in torques], between[:, 0]
    return HarmonicResponse(w, angles, torques[0], torques[1] if slopes else None, between)


@dataclass(frozen=True, eq=False)
class _Solution:
    """Unknowns of the mixed system, and Φᵀ C θ / iω: each shape (n_…, n_loads, n_freq).

    Or the derivatives of the three with the angular frequency.
    """

    angle: Complexes  # of the degrees of freedom
    torque: Complexes  # of the rows
    damping: Complexes  # Σ 2ζω q of the stated damping, of the modes


def _dof_force(train: Train, columns: Complexes) -> Complexes:
    """Torques at stations as forces on the degrees of freedom, shape (n_dof, n_loads)."""
    force = np.zeros((train.n_dof, columns.shape[1]), dtype=complex)
    n = train.n_stations
    np.add.at(force, train.node_dof[:n], train.node_scale[:n, None] * columns)
    return force


def _undamped(train: Train, modes: Modes, stated: Floats) -> Mask:
    """Modes that nothing damps: neither stated damping nor a loss factor nor a damper."""
    loss = train.element_loss_factor
    rate = np.zeros(modes.n_modes)
    if np.any(train.viscous) or np.any(train.node_damping):
        rate = np.diag(modal_damping_matrix(train, modes))
    safe = np.where(modes.omega > 0.0, modes.omega, 1.0)
    ratio = stated + 0.5 * product(loss, modes.strain_share) + 0.5 * rate / safe
    return np.asarray(ratio < UNDAMPED)


def _beside_resonance(modes: Modes, undamped: Mask, omega: Floats) -> Floats:
    """Frequencies moved off undamped resonances and, for a free train, off zero."""
    used = omega.copy()
    resonant = undamped & (modes.omega > 0.0)
    if np.any(resonant):
        near = modes.omega[resonant]
        nearest = near[np.argmin(np.abs(omega[:, None] - near[None, :]), axis=1)]
        at = np.abs(omega / nearest - 1.0) <= AT_RESONANCE
        used[at] = nearest[at] * (1.0 + BESIDE_RESONANCE)
    if modes.n_rigid:
        elastic = modes.omega[modes.n_rigid :]
        used[omega == 0.0] = 1e-6 * (elastic[0] if len(elastic) else 1.0)
    return used


def _solve(
    train: Train, modes: Modes, stated: Floats, omega: Floats, force: Complexes, slopes: bool
) -> tuple[_Solution, _Solution | None]:
    """Solutions of the mixed system at every frequency and, if wanted, their derivatives, in batches."""
    size = max(1, BATCH // (train.n_dof + train.n_rows) ** 2)
    parts = [
        _solve_batch(train, modes, stated, omega[start : start + size], force, slopes)
        for start in range(0, len(omega), size)
    ]
    whole = [np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)]
    return _Solution(*whole[:3]), _Solution(*whole[3:]) if slopes else None


def _solve_batch(
    train: Train, modes: Modes, stated: Floats, omega: Floats, force: Complexes, slopes: bool
) -> tuple[Complexes, ...]:
    """One batch of the mixed system, all of it dimensionless: what one or two `_Solution` hold.

    Unknowns are w √m θ and τ/(g h) with w = ω, g = √|κ|, κ = k(1+iη) + iωc and h the factor that
    brings the largest entry of a stiff row to one; equations are divided by w √m and by g.
    One step of iterative refinement follows (Skeel, Math. Comp. 35 (1980) 817-832).

    Derivatives x' of A x = b solve A x' = −A' x with the same factors of w, g and h:
    (2ωM − iC) θ in the first equations, −τ ic/κ² in the others.
    """
    n, n_rows = train.n_dof, train.n_rows
    root_mass = np.sqrt(train.inertia)
    w = np.where(omega > 0.0, omega, max(float(np.max(modes.omega)), 1.0))[:, None]
    rate = 1j * omega[:, None]
    kappa = train.stiffness * (1.0 + 1j * train.loss_factor) + rate * train.viscous
    size = modulus(kappa)
    g = np.sqrt(size)
    D = (g / w)[:, :, None] * (train.incidence / root_mass)
    h = 1.0 / np.maximum(1.0, np.max(np.abs(D), axis=2, initial=0.0))
    D *= h[:, :, None]
    flexible = np.where(size > 0.0, inverse(np.where(size > 0.0, kappa, 1.0)), 0.0)
    damping = 2.0 * stated / np.where(modes.omega > 0.0, modes.omega, 1.0)
    A = np.zeros((len(omega), n + n_rows, n + n_rows), dtype=complex)
    dof, row = np.arange(n), np.arange(n, n + n_rows)
    A[:, dof, dof] = (rate * (train.ground_damping / train.inertia) - omega[:, None] ** 2) / w**2
    A[:, n:, :n] = D
    A[:, :n, n:] = D.transpose(0, 2, 1)
    A[:, row, row] = np.where(size > 0.0, -(h**2) * size * flexible, -1.0)
    if np.any(stated):
        by_row = product(root_mass[:, None] * modes.shape * damping, modes.row_torque.T)
        A[:, :n, n:] += times((rate / w)[:, :, None] * by_row, (flexible * g * h)[:, None, :])
    b = np.zeros((len(omega), n + n_rows, force.shape[1]), dtype=complex)
    b[:, :n] = force / root_mass[:, None] / w[:, :, None]
    of_angle, of_torque = (root_mass[:, None] * w[:, 0])[:, None], (g * h).T[:, None]
    flexible = flexible.T[:, None]
    row_modes = (damping * modes.row_torque).T
    systems = ComplexSystems(A)
    x = np.moveaxis(systems.solve(b), 0, -1)
    angle, torque = x[:n] / of_angle, x[n:] * of_torque
    twist = times(torque, flexible)
    modal = along_first(row_modes, twist)
    if not slopes:
        return angle, torque, modal
    softer = 1j * train.viscous[:, None, None] * times(twist, flexible)
    right = np.empty_like(x)
    right[:n] = 2.0 * omega * train.inertia[:, None, None] * angle
    right[:n] -= 1j * train.ground_damping[:, None, None] * angle
    right[:n] /= of_angle
    right[n:] = -of_torque * softer
    if np.any(stated):
        right[:n] += along_first(by_row, rate[:, 0] * softer - 1j * twist) / w[:, 0]
    x = np.moveaxis(systems.solve(np.moveaxis(right, -1, 0)), 0, -1)
    angle_slope, torque_slope = x[:n] / of_angle, x[n:] * of_torque
    twist_slope = times(torque_slope, flexible) - softer
    modal_slope = along_first(row_modes, twist_slope)
    return angle, torque, modal, angle_slope, torque_slope, modal_slope


def _output_torque(
    train: Train,
    modes: Modes,
    omega: Floats,
    solution: _Solution,
    columns: Complexes,
    value: _Solution | None = None,
) -> Complexes:
    """Torque of each output, shape (n_outputs, n_loads, n_freq).

    Or its derivative with the angular frequency: `solution` is the derivative of `value` then, and
    `columns` that of the loads, zero.
    """
    candidates = [solution.torque[train.element_rows]]
    if train.rigid_meshes or train.shaft_ends:
        damping = along_first(modes.shape, solution.damping)
        inertial = -(omega**2) * solution.angle + 1j * omega * damping
        viscous = 1j * omega * solution.angle
        if value is not None:
            inertial += 1j * along_first(modes.shape, value.damping) - 2.0 * omega * value.angle
            viscous += 1j * value.angle
        for mesh in train.rigid_meshes:
            nodes = np.array(mesh.to_side)
            candidates.append(
                _mesh_torque(
                    train, mesh.from_ratio, nodes, (inertial, viscous), solution.torque, columns
                )[None]
            )
        for end in train.shaft_ends:
            taken = end.inertia * train.node_scale[end.node] * inertial[train.node_dof[end.node]]
            candidates.append((solution.torque[end.row] + taken)[None])
    return np.concatenate(candidates)


def _of_elements(train: Train, torques: Complexes, *others: Complexes) -> list[Complexes]:
    """Of the outputs of each element the one with the largest torque, shape (n_elements, …); the same of others."""
    by_element = [
        np.zeros((len(train.elements), *torques.shape[1:]), complex) for _ in (torques, *others)
    ]
    if len(torques) == len(train.elements):
        for some, of_outputs in zip(by_element, (torques, *others), strict=True):
            some[train.output_element] = of_outputs
    else:
        for element in distinct(train.output_element).tolist():
            own = train.output_element == element
            largest = np.argmax(modulus(torques[own]), axis=0)[None]
            for some, of_outputs in zip(by_element, (torques, *others), strict=True):
                some[element] = np.take_along_axis(of_outputs[own], largest, axis=0)[0]
    return [np.asarray(some * train.orientation[:, None, None], complex) for some in by_element]


def _rise_between_pieces(train: Train, torques: Complexes) -> Floats:
    """By how much the largest torque of each element exceeds that of its worst piece, relative, shape (n_elements, …).

    The worst section of a shaft may lie between two pieces, which then miss up to an eighth of their second difference;
    a parabola through three in a row finds it. 0 where an end is the worst.
    """
    rise = np.zeros((len(train.elements), *torques.shape[1:]))
    for element in np.flatnonzero(np.bincount(train.output_element) > 2).tolist():
        outputs = np.flatnonzero(train.output_element == element)
        ends = [end.inertia for end in train.shaft_ends if end.element == element]
        n_pieces = len(outputs) - len(ends)
        beyond = [-0.5 if inertia > 0.0 else n_pieces - 0.5 for inertia in ends]  # of half a piece
        along = np.concatenate([np.arange(n_pieces), beyond])
        order = np.argsort(along, kind="stable")
        size, along = modulus(torques[outputs[order]]), along[order]
        largest = np.argmax(size, axis=0)
        at = np.clip(largest, 1, len(along) - 2)
        before, own, after = (np.take_along_axis(size, at[None] + k, axis=0)[0] for k in (-1, 0, 1))
        first, second = along[at] - along[at - 1], along[at + 1] - along[at]
        rises, falls = (own - before) / first, (own - after) / second
        slope = (rises * second - falls * first) / (first + second)
        curvature = (rises + falls) / (first + second)
        inside = (at == largest) & (curvature > 0.0)
        rise[element] = np.where(
            inside, slope * slope / (4.0 * np.where(inside, curvature * own, 1.0)), 0.0
        )
    return rise


def modal_element_torque(train: Train, modes: Modes) -> Floats:
    """Torque of each element in each mode, also of rigid meshes.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        Its modes. [SI]

    Returns
    -------
    ndarray, shape (n_elements, n_modes)
        Magnitude at the element's own speed, at unit modal coordinate. [N m]
    """
    motion = _Solution(
        modes.shape[:, None].astype(complex),
        modes.row_torque[:, None].astype(complex),
        np.zeros((modes.n_modes, 1, modes.n_modes), dtype=complex),
    )
    none = np.zeros((train.n_stations, 1), dtype=complex)
    torques = _output_torque(train, modes, modes.omega, motion, none)
    return np.asarray(modulus(_of_elements(train, torques)[0][:, 0]))


def _mesh_torque(
    train: Train,
    from_ratio: float,
    nodes: Ints,
    motion: tuple[Complexes, Complexes],
    row_torque: Complexes,
    columns: Complexes,
) -> Complexes:
    """Torque of a rigid mesh on its From side: what the stations of its To side need.

    Σ ratio (J θ̈ + c θ̇ + torques leaving by the rows − applied); the stated damping of a node is
    that of its share of the modal inertia, the limit of the same mesh with a very high stiffness.
    """
    inertial, viscous = motion
    ratio = train.speed_ratio[nodes] / from_ratio
    dof = train.node_dof[nodes]
    weight = ratio * train.node_scale[nodes]
    need = along_first(weight * train.node_inertia[nodes], inertial[dof])
    need = need + along_first(weight * train.node_damping[nodes], viscous[dof])
    need = need + along_first(product(train.node_incidence[:, nodes], ratio), row_torque)
    outside = nodes < train.n_stations
    applied = product(ratio[outside], columns[nodes[outside]])
    return np.asarray(need - applied[:, None])


def _mark_unbounded(
    train: Train,
    modes: Modes,
    undamped: Mask,
    omega: float,
    columns: Complexes,
    angles: Complexes,
    *torques: Complexes,
) -> None:
    """Set what the resonance at `omega` leaves unbounded to infinity, in place; torques and, if there, their slopes."""
    safe = np.where(modes.omega > 0.0, modes.omega, 1.0)
    near = undamped & (np.abs(omega / safe - 1.0) <= AT_RESONANCE) & (modes.omega > 0.0)
    if omega == 0.0:
        near = modes.omega == 0.0
    n = train.n_stations
    shape = modes.shape[train.node_dof[:n]][:, near] * train.node_scale[:n, None]
    drive = product(shape.T, columns)  # modal force of each load
    angles[_takes_part(shape, drive, columns, shape)] = np.inf
    if omega == 0.0:
        return  # a rigid mode twists nothing
    # the torques of the modes themselves: as many loads of zero torque
    count = int(near.sum())
    motion = _Solution(
        modes.shape[:, near][..., None].astype(complex),
        modes.row_torque[:, near][..., None].astype(complex),
        np.zeros((modes.n_modes, count, 1), dtype=complex),
    )
    none = np.zeros((n, count), dtype=complex)
    outputs = _output_torque(train, modes, modes.omega[near][:1], motion, none)
    mode_torque = _of_elements(train, outputs)[0][..., 0]
    unbounded = _takes_part(mode_torque, drive, columns, shape)
    for some in torques:
        some[unbounded] = np.inf


def _takes_part(
    part: Complexes | Floats, drive: Complexes, columns: Complexes, shape: Floats
) -> Mask:
    """Which parts (rows) the loads (columns) drive in a group of modes of equal frequency."""
    reach = np.max(np.abs(shape), axis=0)[:, None] * np.sum(modulus(columns), axis=0)[None, :]
    largest = product(np.max(modulus(part), axis=0, initial=0.0)[None, :], reach)
    return np.asarray(modulus(product(part, drive)) > NO_PART * largest)


# --- running ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SteadyStateRow:
    """Vibratory torque and stress of one element under one excitation, at its worst."""

    element: str  #: Element.
    excitation: str  #: Excitation.
    #: Elastic mode at whose resonance the row is evaluated; None = swept over the operating range.
    mode: int | None
    frequency: float  #: Frequency of the excitation; of a sweep the worst one. [Hz]
    applied_at: str  #: Station where the excitation acts, of several the worst one.
    #: Torque of the excitation there, zero-to-peak, at the station's own speed. [N m]
    applied_torque: float
    #: Torque of the element, zero-to-peak, at its own speed; None = unbounded. [N m]
    torque: float | None
    #: Shear stress with SCF; None without a stress diameter, or unbounded. [Pa]
    zero_to_peak_stress: float | None
    peak_to_peak_stress: float | None  #: Likewise. [Pa]
    allowable: float | None  #: UTS/25; None where no stress can be judged. [Pa]
    torque_limit: float | None  #: Vibratory limit of the element, zero-to-peak. [N m]
    verdict: Judgement  #: ``pass``, ``fail``, ``unbounded`` or ``not judged``.
    #: Relative error of torque and stress: by how much a sweep may have missed the largest between its
    #: frequencies, from the pieces of distributed shafts, and by how much torque rises where damping is at the
    #: low end of its range; None where it is not known. [1]
    error: float | None = 0.0


@dataclass(frozen=True)
class SteadyState:
    """Vibratory torques and stresses in continuous operation."""

    #: For each margin that is not kept one row per element at the resonance; then for each excitation
    #: one row per element, swept over the operating range. Where no load is known, the default
    #: excitation acts at the motor alone and nothing passes on it. [rows]
    rows: tuple[SteadyStateRow, ...]
    stress_basis: str  #: ``peak-to-peak`` or ``zero-to-peak``: what is compared with UTS/25.
    warnings: tuple[str, ...]  #: What was assumed, or could not be evaluated.


def steady_state(
    case: CaseData,
    modal: ModalTrain,
    excitations: Sequence[Excitation],
    margins: SeparationMargins,
) -> SteadyState:
    """Response to every excitation: over the operating range, and at resonances not kept clear.

    Where an excitation has several places it acts at one at a time; each element reports the place
    (and the frequency of a sweep) that is worst for it.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        Its train and modes; the damping only decides where a sweep looks closely. [SI]
    excitations : sequence of Excitation
        What shakes the train. [SI]
    margins : SeparationMargins
        Its margins. [1]

    Returns
    -------
    SteadyState
        Rows of torque and stress, with verdicts. [N m, Pa]
    """
    train, modes = modal.train, modal.modes
    transmitted = transmitted_torque(case, train)
    places = {x.name: excitation_places(case, train, transmitted, x) for x in excitations}
    warnings = list(transmitted.warnings) if any(x.torque is None for x in excitations) else []
    silent = [x.name for x in excitations if not places[x.name]]
    if silent:
        warnings.append(
            f"No forced response to {', '.join(silent)}: torque unknown. "
            "Give Torque in table Excitations, or RatedTorque."
        )
    poles = _pole_frequencies(modal)
    tasks: list[tuple[Excitation, int | None, Floats]] = []
    by_name = {x.name: x for x in excitations}
    for row in margins.not_kept:  # what decides stands first
        if places[row.excitation]:
            resonance = np.array([row.mode_frequency])
            tasks.append((by_name[row.excitation], row.mode, resonance))
    for x in excitations:
        frequencies = _swept_frequencies(x, margins.speed_range, poles)
        if places[x.name] and len(frequencies):
            tasks.append((x, None, frequencies))
    stations = sorted({p.station for some in places.values() for p in some})
    basis = case.stress_basis or StressBasis.PEAK_TO_PEAK
    if not tasks:
        return SteadyState((), basis, tuple(warnings))
    unit = np.zeros((train.n_stations, len(stations)))
    unit[stations, np.arange(len(stations))] = 1.0
    damping = stated_damping(case, modes)

    slopes = any(len(frequencies) > 1 for _, _, frequencies in tasks)

    def responses(swept: Sequence[Floats]) -> list[Floats]:
        """Torque of each element for 1 N m at each station and, for sweeps, d ln torque / df of it."""
        frequency, back = np.unique(np.concatenate(swept), return_inverse=True)
        omega = 2.0 * math.pi * frequency
        response = harmonic_response(
            train, modes, omega, unit, damping_ratio=damping, slopes=slopes
        )
        z, dz = response.element_torque, response.torque_slope
        both = (modulus(z) * (1.0 + response.rise_between))[None]
        if dz is not None:
            with np.errstate(divide="ignore", invalid="ignore"):
                rise = (dz.real * z.real + dz.imag * z.imag) / (z.real**2 + z.imag**2)
            both = np.concatenate([both, 2.0 * math.pi * rise[None]])
        both = both[..., back]
        return np.split(both, np.cumsum([len(f) for f in swept])[:-1], axis=3)

    limits = tuple(vibratory_limit(case, e) for e in case.elements)
    rows: list[SteadyStateRow] = []
    for sweep in _refined(tasks, places, stations, responses):
        rows += _rows(train, sweep, places[sweep.excitation.name], limits)
    if not np.any(transmitted.load):  # gears and driven machines could not be excited
        partly = {x.name for x in excitations if x.station is None and x.torque is None}
        rows = [
            replace(r, verdict=Judgement.NOT_JUDGED)
            if r.verdict == Judgement.PASS and r.excitation in partly
            else r
            for r in rows
        ]
    return SteadyState(tuple(rows), basis, tuple(warnings))


def _pole_frequencies(modal: ModalTrain) -> Floats:
    """Frequencies where a response may peak: natural ones, damped ones, coupled ones. [Hz]"""
    train, modes, damping = modal
    omega = modes.omega[modes.n_rigid :]
    zeta = damping.ratio[modes.n_rigid :]
    peak = omega * np.sqrt(np.maximum(0.0, 1.0 - 2.0 * zeta**2))
    poles = [omega, peak[zeta > 1e-6]]
    if damping.coupling > COUPLED:
        poles.append(np.abs(damped_eigenvalues(train, modes, damping.structural).imag))
    return np.concatenate(poles) / (2.0 * math.pi)


def _swept_frequencies(
    excitation: Excitation, speeds: tuple[float, float] | None, poles: Floats
) -> Floats:
    """Frequencies of an excitation over the operating range: ends, grid, resonances inside."""
    if excitation.frequency is not None:
        return np.array([excitation.frequency])
    if speeds is None:
        return np.empty(0)
    low, high = (excitation.frequency_at(speed) for speed in speeds)
    if low == high:
        return np.array([low])
    inside = poles[(poles > low) & (poles < high)]
    return np.asarray(distinct(np.linspace(low, high, SWEEP_POINTS), inside))


@dataclass(frozen=True, eq=False)
class _Sweep:
    """Responses to one excitation: at a resonance, or over the operating range."""

    excitation: Excitation
    mode: int | None
    frequency: Floats  # rising
    #: Torque and, of sweeps, d ln torque / df, of each element, place and frequency: shape (1 or 2, n_elements,
    #: n_places, n_freq).
    response: Floats
    gain: Floats  # by how much the last refinement raised the largest of each element

    @property
    def largest(self) -> Floats:
        return np.asarray(np.max(self.response[0], axis=(1, 2)))


def _refined(
    tasks: Sequence[tuple[Excitation, int | None, Floats]],
    places: Mapping[str, Sequence[Place]],
    stations: Sequence[int],
    responses: Callable[[Sequence[Floats]], list[Floats]],
) -> list[_Sweep]:
    """Responses, those of sweeps refined where they are largest."""

    def at_places(excitation: Excitation, unit: Floats) -> Floats:
        at = places[excitation.name]
        response = unit[:, :, [stations.index(p.station) for p in at]]
        response[0] *= np.array([p.torque for p in at])[:, None]
        return response

    first = responses([f for _, _, f in tasks])
    sweeps = [
        _Sweep(x, mode, f, at_places(x, unit), np.zeros(unit.shape[1]))
        for (x, mode, f), unit in zip(tasks, first, strict=True)
    ]
    for _ in range(SWEEP_REFINEMENTS):
        new = [_peaks(s.frequency, s.response) for s in sweeps]
        if not any(len(f) for f in new):
            return [replace(s, gain=np.zeros_like(s.gain)) for s in sweeps]
        for k, unit in enumerate(responses(new)):
            s, before = sweeps[k], sweeps[k].largest
            frequency = np.concatenate([s.frequency, new[k]])
            order = np.argsort(frequency, kind="stable")
            response = np.concatenate([s.response, at_places(s.excitation, unit)], axis=3)
            s = replace(s, frequency=frequency[order], response=response[..., order])
            with np.errstate(divide="ignore", invalid="ignore"):
                gain = np.nan_to_num(s.largest / before - 1.0, posinf=0.0)
            sweeps[k] = replace(s, gain=gain)
    return sweeps


def _peaks(frequency: Floats, response: Floats) -> Floats:
    """Where the largest torques of each element are between the frequencies of a sweep. [Hz]

    A peak lies where the torque rises at one frequency and falls at the next. Near a resonance 1/T² is a
    parabola in frequency; the cubic through its values and slopes at both gives the peak.
    """
    if len(frequency) < 2:
        return np.empty(0)
    torque, rise = response
    peak = (rise[..., :-1] > 0.0) & (rise[..., 1:] < 0.0)
    if not np.any(peak):
        return np.empty(0)
    before, after = torque[..., :-1], torque[..., 1:]
    largest = np.max(torque, axis=(1, 2), keepdims=True)
    peak &= np.maximum(before, after) >= NEARLY_LARGEST * largest
    at = np.nonzero(peak)[2]
    width = np.diff(frequency)[at]
    # 1/T² from 1 to `end`, and its slopes over the whole width
    end = (before[peak] / after[peak]) ** 2
    first, last = -2.0 * rise[..., :-1][peak] * width, -2.0 * rise[..., 1:][peak] * width * end
    square = 3.0 * (end - 1.0) - 2.0 * first - last
    cube = first + last - 2.0 * (end - 1.0)
    share = -first / (square + np.sqrt(square**2 - 3.0 * cube * first))
    # what the torque would still gain, seen from the nearer end
    gain = 0.25 * np.where(share < 0.5, -first * share, last / end * (1.0 - share))
    peaks = distinct((frequency[at] + share * width)[gain > AT_PEAK])
    return np.asarray(peaks[frequency[np.searchsorted(frequency, peaks)] != peaks])


def _worst(response: Floats) -> tuple[Ints, Ints]:
    """Place and frequency of the largest torque of each element, at a peak where the torque is flattest."""
    torque = response[0]
    n_elements, n_places, n_frequencies = torque.shape
    flat = torque.reshape(n_elements, n_places * n_frequencies)
    place, at = np.divmod(np.argmax(flat, axis=1), n_frequencies)
    if n_frequencies > 1:
        own = np.arange(n_elements), place
        equal = torque[own] >= (1.0 - EQUAL_TORQUE) * np.max(torque[own], axis=1, keepdims=True)
        at = np.argmin(np.where(equal, np.abs(response[1][own]), np.inf), axis=1)
    return place, at


def _rows(
    train: Train, sweep: _Sweep, places: Sequence[Place], limits: Sequence[VibratoryLimit]
) -> list[SteadyStateRow]:
    """One row an element: the worst of the places and frequencies."""
    excitation, mode, frequency = sweep.excitation, sweep.mode, sweep.frequency
    place, peak = _worst(sweep.response)
    largest = sweep.response[0, np.arange(len(place)), place, peak]
    rows = []
    for element, (applied, at, value) in enumerate(
        zip(place.tolist(), peak.tolist(), largest.tolist(), strict=True)
    ):
        bounded = value if math.isfinite(value) else None
        limit = limits[element]
        stress = None if bounded is None else limit.stress(bounded)
        rows.append(
            SteadyStateRow(
                element=train.elements[element],
                excitation=excitation.name,
                mode=mode,
                frequency=float(frequency[at]),
                applied_at=train.stations[places[applied].station],
                applied_torque=places[applied].torque,
                torque=bounded,
                zero_to_peak_stress=stress,
                peak_to_peak_stress=None if stress is None else 2.0 * stress,
                allowable=limit.allowable,
                torque_limit=limit.torque_limit,
                verdict=limit.verdict(bounded),
                error=STILL_TO_GAIN * float(sweep.gain[element]),
            )
        )
    return rows


@dataclass(frozen=True)
class VibratoryLimit:
    """What an element's vibratory torque is judged by."""

    stress_per_torque: float | None  #: With SCF; None without a stress diameter. [Pa/(N m)]
    allowable: float | None  #: UTS/25. [Pa]
    torque_limit: float | None  #: Vibratory limit, zero-to-peak. [N m]
    peaks: float  #: Stress compared with the allowable, over the zero-to-peak stress. [1]

    def stress(self, torque: float) -> float | None:
        """Zero-to-peak stress with SCF. [Pa]"""
        return None if self.stress_per_torque is None else self.stress_per_torque * torque

    def verdict(self, torque: float | None) -> Judgement:
        """Verdict on a zero-to-peak torque; None = unbounded."""
        if torque is None:
            return Judgement.UNBOUNDED
        stress = self.stress(torque)
        held = []
        if stress is not None and self.allowable is not None:
            held.append(self.peaks * stress <= self.allowable * (1.0 + STRESS_ROUNDING))
        if self.torque_limit is not None:
            held.append(torque <= self.torque_limit * (1.0 + STRESS_ROUNDING))
        if not held:
            return Judgement.NOT_JUDGED
        return Judgement.PASS if all(held) else Judgement.FAIL


def vibratory_limit(case: CaseData, element: ElementRow) -> VibratoryLimit:
    """Limits of an element: UTS/25 for its stress, Vibratory limit for its torque, or both.

    The basis of the S-N data (torsion or bending) does not change UTS/25, and notch sensitivity does not lower the
    stress that is compared with it.

    Parameters
    ----------
    case : CaseData
        The case: materials and StressBasis. [SI]
    element : ElementRow
        The element. [SI]

    Returns
    -------
    VibratoryLimit
        Stress per torque, allowable stress and torque. [1/m³, Pa, N m]
    """
    per_torque = None
    if element.stress_diameter:
        nominal = stress_of_unit_torque(element)
        per_torque = nominal * notch_effect(case, element).concentration.value
    uts = next((m.uts for m in case.materials if m.material == element.material and m.uts), None)
    allowable = uts / STRESS_DIVISOR if uts and per_torque is not None else None
    peaks = 1.0 if case.stress_basis == StressBasis.ZERO_TO_PEAK else 2.0
    return VibratoryLimit(per_torque, allowable, element.vibratory_limit, peaks)
