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
from engine.numerics.same_bits import along_first, inverse, modulus, product, solve, times
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
#: Times a sweep looks for the largest torque between its frequencies. What the last time added is its error.
SWEEP_REFINEMENTS = 3
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


def harmonic_response(
    train: Train,
    modes: Modes,
    omega: Floats,
    torque: Complexes | Floats,
    *,
    damping_ratio: Floats | None = None,
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

    Returns
    -------
    HarmonicResponse
        Angles and torques. [rad, N m]
    """
    w = np.atleast_1d(np.asarray(omega, dtype=float))
    load = np.asarray(torque, dtype=complex)
    columns = load[:, None] if load.ndim == 1 else load
    stated = np.zeros(modes.n_modes) if damping_ratio is None else damping_ratio
    undamped = _undamped(train, modes, stated)
    used = _beside_resonance(modes, undamped, w)
    solution = _solve(train, modes, stated, used, _dof_force(train, columns))
    torques = _element_torque(train, modes, used, solution, columns)
    scale = train.node_scale[: train.n_stations, None, None]
    angles = scale * solution.angle[train.node_dof[: train.n_stations]]
    for i in np.flatnonzero(used != w).tolist():
        _mark_unbounded(train, modes, undamped, w[i], columns, angles[:, :, i], torques[:, :, i])
    if load.ndim == 1:
        return HarmonicResponse(w, angles[:, 0], torques[:, 0])
    return HarmonicResponse(w, angles, torques)


@dataclass(frozen=True, eq=False)
class _Solution:
    """Unknowns of the mixed system, and Φᵀ C θ / iω: each shape (n_…, n_loads, n_freq)."""

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
    train: Train, modes: Modes, stated: Floats, omega: Floats, force: Complexes
) -> _Solution:
    """The mixed system at every frequency, in batches."""
    size = max(1, BATCH // (train.n_dof + train.n_rows) ** 2)
    parts = [
        _solve_batch(train, modes, stated, omega[start : start + size], force)
        for start in range(0, len(omega), size)
    ]
    return _Solution(*(np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)))


def _solve_batch(
    train: Train, modes: Modes, stated: Floats, omega: Floats, force: Complexes
) -> tuple[Complexes, Complexes, Complexes]:
    """One batch of the mixed system, all of it dimensionless.

    Unknowns are w √m θ and τ/(g h) with w = ω, g = √|κ|, κ = k(1+iη) + iωc and h the factor that
    brings the largest entry of a stiff row to one; equations are divided by w √m and by g.
    One step of iterative refinement follows (Skeel, Math. Comp. 35 (1980) 817-832).
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
    x = np.moveaxis(solve(A, b), 0, -1)
    angle = x[:n] / (root_mass[:, None] * w[:, 0])[:, None]
    torque = x[n:] * (g * h).T[:, None]
    twist = times(torque, flexible.T[:, None])
    modal = along_first((damping * modes.row_torque).T, twist)
    return angle, torque, modal


def _element_torque(
    train: Train, modes: Modes, omega: Floats, solution: _Solution, columns: Complexes
) -> Complexes:
    """Torque of each element, shape (n_elements, n_loads, n_freq)."""
    candidates = [solution.torque[train.element_rows]]
    if train.rigid_meshes or train.shaft_ends:
        damping = along_first(modes.shape, solution.damping)
        inertial = -(omega**2) * solution.angle + 1j * omega * damping
        viscous = 1j * omega * solution.angle
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
    torques = np.concatenate(candidates)
    torque = np.zeros((len(train.elements), *torques.shape[1:]), dtype=complex)
    if len(torques) == len(torque):
        torque[train.output_element] = torques
    else:
        for element in np.unique(train.output_element).tolist():
            own = torques[train.output_element == element]
            largest = np.argmax(modulus(own), axis=0)[None]
            torque[element] = np.take_along_axis(own, largest, axis=0)[0]
    return np.asarray(torque * train.orientation[:, None, None], dtype=np.complex128)


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
    return np.asarray(modulus(_element_torque(train, modes, modes.omega, motion, none)[:, 0]))


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
    torques: Complexes,
) -> None:
    """Set what the resonance at `omega` leaves unbounded to infinity, in place."""
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
    mode_torque = _element_torque(train, modes, modes.omega[near][:1], motion, none)[..., 0]
    torques[_takes_part(mode_torque, drive, columns, shape)] = np.inf


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

    def magnitudes(swept: Sequence[Floats]) -> list[Floats]:
        """Torque of each element for 1 N m at each station, at the frequencies of each task."""
        frequency, back = np.unique(np.concatenate(swept), return_inverse=True)
        omega = 2.0 * math.pi * frequency
        response = harmonic_response(train, modes, omega, unit, damping_ratio=damping)
        found = modulus(response.element_torque)[:, :, back]
        return np.split(found, np.cumsum([len(f) for f in swept])[:-1], axis=2)

    limits = tuple(vibratory_limit(case, e) for e in case.elements)
    rows: list[SteadyStateRow] = []
    for sweep in _refined(tasks, places, stations, magnitudes):
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
    return np.unique(np.concatenate([np.linspace(low, high, SWEEP_POINTS), inside]))


@dataclass(frozen=True, eq=False)
class _Sweep:
    """Responses to one excitation: at a resonance, or over the operating range."""

    excitation: Excitation
    mode: int | None
    frequency: Floats  # rising
    torque: Floats  # of each element, place and frequency
    gain: Floats  # by how much the last refinement raised the largest of each element

    @property
    def largest(self) -> Floats:
        return np.asarray(np.max(self.torque, axis=(1, 2)))


def _refined(
    tasks: Sequence[tuple[Excitation, int | None, Floats]],
    places: Mapping[str, Sequence[Place]],
    stations: Sequence[int],
    magnitudes: Callable[[Sequence[Floats]], list[Floats]],
) -> list[_Sweep]:
    """Responses, those of sweeps refined where they are largest.

    Near a resonance 1/T² is a parabola in frequency; its vertex through the largest and its neighbours is
    the next frequency that is calculated.
    """

    def torques(excitation: Excitation, magnitude: Floats) -> Floats:
        at = places[excitation.name]
        applied = np.array([p.torque for p in at])
        return np.asarray(magnitude[:, [stations.index(p.station) for p in at]] * applied[:, None])

    found = magnitudes([f for _, _, f in tasks])
    sweeps = [
        _Sweep(x, mode, f, torque := torques(x, m), np.zeros(len(torque)))
        for (x, mode, f), m in zip(tasks, found, strict=True)
    ]
    for _ in range(SWEEP_REFINEMENTS):
        new = [_vertices(s.frequency, s.torque) for s in sweeps]
        if not any(len(f) for f in new):
            break
        for k, magnitude in enumerate(magnitudes(new)):
            s, before = sweeps[k], sweeps[k].largest
            frequency = np.concatenate([s.frequency, new[k]])
            order = np.argsort(frequency, kind="stable")
            torque = np.concatenate([s.torque, torques(s.excitation, magnitude)], axis=2)
            s = replace(s, frequency=frequency[order], torque=torque[:, :, order])
            with np.errstate(divide="ignore", invalid="ignore"):
                gain = np.nan_to_num(s.largest / before - 1.0, posinf=0.0)
            sweeps[k] = replace(s, gain=gain)
    return sweeps


def _vertices(frequency: Floats, torque: Floats) -> Floats:
    """Where largest torques of each element are between the frequencies of a sweep. [Hz]"""
    if len(frequency) < 3:
        return np.empty(0)
    found = []
    for of_places in torque:
        notable = NEARLY_LARGEST * float(np.max(of_places, initial=0.0))
        inner = of_places[:, 1:-1]
        peak = (inner >= of_places[:, :-2]) & (inner >= of_places[:, 2:]) & (inner >= notable)
        for place, before in zip(*np.nonzero(peak & np.isfinite(inner)), strict=True):
            value, k = of_places[place, before : before + 3], before + 1
            if not np.all(value):
                continue
            x, y = frequency[before : before + 3] - frequency[k], (value[1] / value) ** 2
            left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
            bend = (right - left) / (x[2] - x[0])
            if bend > 0.0:
                vertex = 0.5 * (x[0] + x[1]) - 0.5 * left / bend
                found.append(frequency[k] + float(np.clip(vertex, 0.5 * x[0], 0.5 * x[2])))
    return np.setdiff1d(np.array(found), frequency)


def _rows(
    train: Train, sweep: _Sweep, places: Sequence[Place], limits: Sequence[VibratoryLimit]
) -> list[SteadyStateRow]:
    """One row an element: the worst of the places and frequencies."""
    excitation, mode, frequency = sweep.excitation, sweep.mode, sweep.frequency
    torque = sweep.torque.reshape(len(sweep.torque), len(places) * len(frequency))
    worst = np.argmax(torque, axis=1)
    largest = torque[np.arange(len(torque)), worst]
    rows = []
    for element, (at, value) in enumerate(zip(worst.tolist(), largest.tolist(), strict=True)):
        place = places[at // len(frequency)]
        bounded = value if math.isfinite(value) else None
        limit = limits[element]
        stress = None if bounded is None else limit.stress(bounded)
        rows.append(
            SteadyStateRow(
                element=train.elements[element],
                excitation=excitation.name,
                mode=mode,
                frequency=float(frequency[at % len(frequency)]),
                applied_at=train.stations[place.station],
                applied_torque=place.torque,
                torque=bounded,
                zero_to_peak_stress=stress,
                peak_to_peak_stress=None if stress is None else 2.0 * stress,
                allowable=limit.allowable,
                torque_limit=limit.torque_limit,
                verdict=limit.verdict(bounded),
                error=float(sweep.gain[element]),
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

    The basis of the S-N data (torsion or bending) does not change UTS/25.

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
        per_torque = nominal * (element.scf or 1.0)
    uts = next((m.uts for m in case.materials if m.material == element.material and m.uts), None)
    allowable = uts / STRESS_DIVISOR if uts and per_torque is not None else None
    peaks = 1.0 if case.stress_basis == StressBasis.ZERO_TO_PEAK else 2.0
    return VibratoryLimit(per_torque, allowable, element.vibratory_limit, peaks)
