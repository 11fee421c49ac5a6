"""Cheap evidence for the plan: modes with and without bearings, damping, run-up, a linear start."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from engine.arrays import Floats
from engine.case.choices import ElementKind
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS, LONGEST_START
from engine.case.effects import choice_of
from engine.case.effects.motor_transient import has_only_motors_from_data
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.modes import Modes
from engine.model.motor import Motor, motors_of
from engine.model.rigid_runup import RigidRunup, rigid_runup
from engine.model.train import Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import product, total
from engine.start.closing import closing_torques
from engine.start.electrical_damping import ElectricalDamping, electrical_damping_of
from engine.start.settings import NEGLIGIBLE, has_start, settings_of
from engine.start.start import Start
from engine.start.start_fatigue import judged_shafts, sn_slope, stress_over_endurance
from engine.start.start_model import LARGEST_AMPLIFICATION
from engine.start.torque_outputs import force_reach, torque_outputs

#: Relative change of an answer per unit of `Evidence.bearing_number`: largest seen 9.
BEARING_GAIN = 50.0
#: Relative change of an answer per depth of a reversal over the largest torque: the lowest torque
#: itself is wrong by that depth; largest seen 2.
BACKLASH_GAIN = 5.0
#: Relative change of an answer per unit of the number of electrical damping: a resonance is in proportion to 1/ζ at
#: the most; largest seen 1.9 (100 trains, both choices of `TorqueFollows`).
DAMPING_GAIN = 5.0
#: Relative change of an answer per unit of the torque that closing adds to an element: largest seen 1.9 (100 random
#: machines and trains, electrical damping as its plan has it).
CLOSING_GAIN = 2.0
#: Electrical damping that changes a peak by more than this is no small change of a mode's damping: the torque of the
#: motors is then needed in time. [1]
LARGEST_SMALL_SIGNAL = 1.0
#: A mode with bearings is the same as one without if they share this much of their shape.
SAME_MODE = 0.9
#: A rigid train that comes this close to the slip of the field, or to the trip speed, may reach it:
#: the pulsation carries it beyond its mean speed. Share of synchronous speed.
NEARLY_REACHED = 0.01
#: Off-diagonal damping below this share of the largest term is rounding.
COUPLING_ROUNDING = 1e-14


@dataclass(frozen=True)
class ElementMinimum:
    """Lowest torque of an element that may have a clearance."""

    element: str  #: Gear mesh or geared coupling.
    minimum: float  #: Lowest torque after rest. [N m]
    error: float  #: Its estimated error. [N m]
    largest: float  #: Largest magnitude of its torque. [N m]
    clearance: bool  #: Whether its clearance is given, and not zero.
    tight: bool = False  #: Whether a clearance of zero is given for it.

    @property
    def lowest(self) -> float:
        """Minimum less its error, over the largest torque. [1]"""
        return (self.minimum - self.error) / self.largest if self.largest > 0.0 else 0.0


@dataclass(frozen=True)
class StartEvidence:
    """Evidence from a calculated start."""

    minima: tuple[ElementMinimum, ...]  #: Of every mesh and geared coupling. [N m]
    truncation_error: float  #: What the modes left out may change. [1]
    kept_modes: int  #: Modes integrated.
    time: float  #: Simulated time. [s]
    outcome: str  #: How it ended.
    #: Largest possible stress amplitude over endurance; None where no shaft is judged. [1]
    stress_ratio: float | None
    must_count: bool  #: Whether any cycle may damage.
    wall_time: float  #: What it cost. [s]
    #: Modes of the train it was calculated with; None = as many as are integrated.
    n_modes: int | None = None
    #: What the limit on contact damping may change though teeth do not part; 0 where it is simulated. [1]
    damping_limit: float = 0.0
    sizes: Mapping[str, float] = field(
        default_factory=dict
    )  #: Largest torque of each element. [N m]


@dataclass(frozen=True)
class ElectricalNumbers:
    """What motors make of the modes that the start crosses."""

    known: bool  #: Whether every motor has a data sheet.
    #: What they damp or drive beyond what the start has, over the mode's damping ratio, times its share of a peak:
    #: the largest; 0 where that is unknown. [1]
    number: float
    rows: tuple[ElectricalDamping, ...]  #: Mode by mode. [SI]


@dataclass(frozen=True)
class Evidence:
    """Cheap numbers a plan is made from."""

    tolerance: float  #: Relative change of an answer that may be neglected. [1]
    start: bool  #: Whether a start or prescribed torque is calculated.
    n_modes: int  #: Modes without and with bearings.
    n_coupled_modes: int  #: Likewise.
    first_frequency: float | None  #: Lowest elastic mode. [Hz]
    line_frequency: float | None  #: Line frequency. [Hz]
    #: How much the bearings change a mode; None without bearing data. [1]
    bearing_number: float | None
    #: Estimated share of an element's torque that dampers bring by coupling modes. [1]
    coupling: float
    #: Rigid-body run-up to the end speed; inf = never; None without motor. [s]
    runup_time: float | None
    longest_time: float  #: Longest simulated time. [s]
    field_slip: float | None  #: Slip the rigid train reaches, where field data are given. [1]
    #: Highest speed of the rigid train, or of its start, over the trip speed. [1]
    trip_share: float | None
    #: Shock of all motors over the least motor torque at standstill, times its largest
    #: amplification; None without shock data or motor. [1]
    shock_share: float | None
    #: What motors make of the modes; None where no mode is crossed with a motor on.
    electrical: ElectricalNumbers | None
    #: Each element with the torque that closing adds to it, and its largest torque as far as modes and curves tell; None
    #: where a motor's curves are typed. [N m]
    closing: tuple[tuple[str, float, float], ...] | None
    judged: int  #: Shafts whose fatigue is judged.
    clearances: tuple[str, ...]  #: Elements with a clearance.
    #: The linear start, and the latest one with events; None before it. [SI]
    linear: StartEvidence | None = None
    event: StartEvidence | None = None  #: Likewise. [SI]
    #: Modes that the start may have at most; None = as many as it needs. [count]
    most_modes: int | None = None

    @property
    def closing_share(self) -> float | None:
        """Torque that closing adds to an element, over its largest in the linear start; None: unknown. [1]"""
        if self.closing is None:
            return None
        sizes = {element: own for element, _, own in self.closing}
        if self.linear is not None:
            sizes |= self.linear.sizes
        least = NEGLIGIBLE * max(sizes.values(), default=0.0)
        shares = (added / max(sizes[e], least, 1e-300) for e, added, _ in self.closing)
        return max(shares, default=0.0)


def collect_evidence(
    case: CaseData,
    modal: ModalTrain,
    coupled: ModalTrain | None = None,
    reported: ModalTrain | None = None,
) -> Evidence:
    """Evidence that needs no start.

    `modal` is without lateral motion of gears, `coupled` with it, where bearing data is given. `reported` is the one
    of them whose modes are reported; default `modal`.
    """
    train, modes = modal.train, modal.modes
    ratings = case.ratings
    elastic = modes.elastic_frequency
    motors = motors_of(case, train) if has_start(case) else ()
    loads = loads_of(case, train) if motors else ()
    runup: RigidRunup | None = None
    field_slip = trip_share = None
    synchronous = ratings.synchronous_speed
    if motors and synchronous:
        end_speed = settings_of(case).end_speed
        runup = rigid_runup(train, motors, loads, end_speed)
        if case.field_slip is not None and case.pull_out_torque:
            target = (1.0 - case.field_slip) * synchronous
            reached = _reached(rigid_runup(train, motors, loads, target), target)
            field_slip = 1.0 - reached / synchronous
        if case.trip_speed:
            highest = _reached(runup, end_speed)
            if field_slip is not None and field_slip <= (case.field_slip or 0.0) + NEARLY_REACHED:
                highest = synchronous
            trip_share = highest / case.trip_speed
    line_omega = 2.0 * math.pi * (ratings.line_frequency or 0.0)
    return Evidence(
        tolerance=_tolerance(case),
        start=bool(motors) or bool(case.torque_time_from_rest),
        n_modes=modes.n_modes,
        n_coupled_modes=modes.n_modes if coupled is None else coupled.modes.n_modes,
        first_frequency=float(elastic[0]) if len(elastic) else None,
        line_frequency=ratings.line_frequency,
        bearing_number=None if coupled is None else _bearing_number(modal, coupled),
        coupling=max(
            _coupling_number(model, motors, synchronous or 0.0)
            for model in (modal, coupled)
            if model is not None
        ),
        runup_time=None if runup is None else float(runup.time[-1]),
        longest_time=case.maximum_time or LONGEST_START,
        field_slip=field_slip,
        trip_share=trip_share,
        shock_share=_shock_share(case, line_omega, motors),
        electrical=_electrical_numbers(case, reported or modal, motors) if motors else None,
        closing=_closing(case, modal, motors),
        judged=len(judged_shafts(case)),
        clearances=tuple(train.elements[f.element] for f in train.flanks if f.gap),
    )


def _tolerance(case: CaseData) -> float:
    """Change of an answer that may be neglected: of a peak, or of a stress that moves a life."""
    peak = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    slope = sn_slope(case)
    starts = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    return min(peak, starts / slope) if slope > 0.0 else peak


def _reached(runup: RigidRunup, target: float) -> float:
    """Highest speed of the rigid train on its way to a target. [rad/s]"""
    return target if runup.equilibrium is None else min(runup.equilibrium, target)


def _shock_share(case: CaseData, line_omega: float, motors: Sequence[Motor]) -> float | None:
    """Largest torque of the shocks over that at standstill.

    A decaying sinusoid drives a mode of frequency ω to at most ω ∫ e^(−t/τ) dt = ωτ times its
    static answer, and no less than twice where it is sudden. Every motor has the stated amplitude
    at its own shaft, and like its curves it goes with the square of the voltage. Where there are
    several, an element may feel all the shocks and only the weakest motor: so they are compared,
    as torques of one shaft.
    """
    if not case.shock_amplitude or not case.shock_time_constant or not motors:
        return None
    amplitude = abs(case.shock_amplitude)
    shock = total(float(m.torque_factor(0.0)) * amplitude * m.synchronous_speed for m in motors)
    drive = min(
        (float(m.average(0.0)) + float(m.pulsating(0.0))) * m.synchronous_speed for m in motors
    )
    grown = 2.0 + line_omega * case.shock_time_constant
    return shock * grown / drive if drive > 0.0 else math.inf


def _bearing_number(modal: ModalTrain, on_bearings: ModalTrain) -> float:
    """Largest relative change that the bearings make to a mode: frequency, shape or damping.

    Modes of any frequency count, since all ring at breaker closing. A mode that is lateral motion
    alone counts with the rotation in it times its resonance. 1 or more where a mode has no
    counterpart.
    """
    train, modes, damping = modal
    coupled_train, coupled, coupled_damping = on_bearings
    if train.n_dof > coupled_train.n_dof:
        return 1.0
    overlap = np.abs(
        product((modes.shape * train.inertia[:, None]).T, coupled.shape[: train.n_dof])
    )
    worst, taken = 0.0, set(range(coupled.n_rigid))
    for r in range(modes.n_rigid, modes.n_modes):
        partner = int(np.argmax(overlap[r]))
        same = float(overlap[r, partner])
        if same < SAME_MODE or partner in taken:
            return 1.0
        taken.add(partner)
        moved = abs(float(coupled.omega[partner] / modes.omega[r]) - 1.0)
        worst = max(worst, moved, 1.0 - same * same)
        worst = max(
            worst, _relative(float(coupled_damping.ratio[partner]), float(damping.ratio[r]))
        )
    for r in range(coupled.n_modes):
        if r in taken:
            continue
        turning = max(1.0 - float(coupled.sideways_share[:, r].sum()), 0.0)
        resonance = 0.5 / max(float(coupled_damping.ratio[r]), 1e-6)
        worst = max(worst, turning * resonance)
    return worst


def _coupling_number(modal: ModalTrain, motors: Sequence[Motor], synchronous: float) -> float:
    """Estimated share of an element's torque that dampers bring by coupling its modes.

    Mode j moves with A_j: its static answer to the motor torque, magnified where the pulsation
    passes it; a rigid mode with its speed at synchronism. Through the off-diagonal damping d_ij it
    drives mode i to |d_ij| ω_j A_j / |ω_i² − ω_j²| (a rigid one to |d_ij| v_j / ω_i²); where both are nearer than
    mode i's own damping lets them be told apart, to |d_ij| A_j / d_ii.
    """
    train, modes, damping = modal
    sprung = np.where(train.stiffness > 0.0, train.viscous, 0.0)  # the others are forces anyway
    matrix = product(modes.row_twist.T * sprung, modes.row_twist)
    matrix += product(modes.shape.T, train.ground_damping[:, None] * modes.shape)
    off = np.abs(matrix - np.diag(np.diag(matrix)))
    off[off <= COUPLING_ROUNDING * float(np.max(np.abs(matrix), initial=0.0))] = 0.0
    if not motors or not np.any(matrix):
        return 0.0
    stations = np.array([m.station for m in motors], dtype=np.int64)
    torque = np.array([_largest_torque(m) for m in motors])
    drive = product(force_reach(train, modes, stations), torque)
    square = modes.omega**2
    elastic = square > 0.0
    static = np.where(elastic, drive / np.where(elastic, square, 1.0), 0.0)
    passed = modes.omega <= 2.0 * motors[0].pole_pairs * motors[0].synchronous_speed
    excess = np.clip(0.5 / np.maximum(damping.ratio, 1e-9), 1.0, LARGEST_AMPLIFICATION)
    moved = np.abs(static) * np.where(passed, excess, 1.0)
    apart = np.abs(square[:, None] - square[None, :])
    apart = np.maximum(apart, np.diag(matrix)[:, None] * modes.omega)
    coupled = elastic[:, None] & elastic[None, :] & (off > 0.0) & (apart > 0.0)
    mixed = np.where(coupled, off * modes.omega * moved / np.where(coupled, apart, 1.0), 0.0)
    turned = np.where(elastic[:, None], off / np.where(elastic, square, 1.0)[:, None], 0.0)
    rigid = _rigid_speed(train, modes, synchronous)
    mixed += turned * rigid
    outputs = torque_outputs(train, modes, stations)
    position = outputs.position
    # rigid meshes and ends of shafts take their torque from equilibrium, in which dampers have a part of their own,
    # be it that of a train that only turns
    whole = torque_outputs(train, modes, stations, damping=matrix).velocity
    taken = product(np.abs(whole - outputs.velocity), modes.omega * moved + rigid)
    own = np.abs(product(position, static)) + np.max(np.abs(position) * moved, axis=1, initial=0.0)
    own = np.where(own > 0.0, own, np.abs(product(outputs.force, torque)))
    brought = product(np.abs(position), mixed.sum(axis=1)) + taken
    own = np.maximum(own, NEGLIGIBLE * float(np.max(own, initial=0.0)))
    return float(np.max(brought / np.where(own > 0.0, own, np.inf), initial=0.0))


def _electrical_numbers(
    case: CaseData, modal: ModalTrain, motors: Sequence[Motor]
) -> ElectricalNumbers | None:
    """Change of each mode's damping by the motors where it is crossed, times its share of an element's torque.

    Its share is that of its resonance in the torque of any element, the static torque of all modes added.
    """
    every_row = electrical_damping_of(case, modal)
    rows = [row for row in every_row if row.speed < 1.0]
    if not rows:
        return None
    modes = modal.modes
    resonant, own = _own_torques(modal, motors)
    share = np.max(resonant / np.where(own > 0.0, own, np.inf)[:, None], axis=0, initial=0.0)
    known = all(row.share is not None for row in rows)
    number = 0.0
    for mode in {row.mode for row in rows} if known else ():
        of_mode = [row for row in rows if row.mode == mode]
        weight = float(share[modes.n_rigid + mode - 1]) / max(of_mode[0].damping_ratio, 1e-9)
        answered = total(row.share or 0.0 for row in of_mode)
        had = total(row.slope_share for row in of_mode) if case.reads_own_speed else 0.0
        number = max(number, weight * abs(answered - had))
    return ElectricalNumbers(known, number, every_row)


def _own_torques(modal: ModalTrain, motors: Sequence[Motor]) -> tuple[Floats, Floats]:
    """Resonance of each mode in the torque of each output, and the largest torque of the output. [N m]"""
    train, modes, damping = modal
    stations = np.array([m.station for m in motors], dtype=np.int64)
    drive = product(
        force_reach(train, modes, stations), np.array([_largest_torque(m) for m in motors])
    )
    static = drive / np.where(modes.omega > 0.0, modes.omega, np.inf) ** 2
    excess = np.clip(0.5 / np.maximum(damping.ratio, 1e-9), 1.0, LARGEST_AMPLIFICATION)
    position = torque_outputs(train, modes, stations).position
    resonant = np.abs(position * (static * excess))
    own = np.abs(product(position, static)) + np.max(resonant, axis=1, initial=0.0)
    return resonant, np.maximum(own, NEGLIGIBLE * float(np.max(own, initial=0.0)))


def _closing(
    case: CaseData, modal: ModalTrain, motors: Sequence[Motor]
) -> tuple[tuple[str, float, float], ...] | None:
    """What closing adds to the torque of each element, where the fluxes of all motors are known."""
    if not motors or not has_only_motors_from_data(case):
        return None
    added, own = closing_torques(case, modal, motors), _own_torques(modal, motors)[1]
    elements, of = modal.train.elements, modal.train.output_element
    return tuple(
        (elements[e], float(np.max(added[of == e])), float(np.max(own[of == e])))
        for e in distinct(of)
    )


def _largest_torque(motor: Motor) -> float:
    """Largest average and pulsating torque together. [N m]"""
    average = float(np.max(np.abs(motor.average.cubic[:, 0])))
    return average + motor.largest_pulsation


def _rigid_speed(train: Train, modes: Modes, synchronous: float) -> Floats:
    """Modal speed of the rigid modes at synchronism, zero for the others, shape (n_modes,)."""
    momentum = product(train.inertia * train.dof_ratio, modes.shape)
    return np.asarray(np.where(modes.omega == 0.0, np.abs(momentum) * synchronous, 0.0))


def _relative(value: float, base: float) -> float:
    """Relative change; of nothing, infinite."""
    if value == base:
        return 0.0
    return abs(value / base - 1.0) if base > 0.0 else math.inf


def _element_minima(case: CaseData, train: Train, start: Start) -> tuple[ElementMinimum, ...]:
    """Lowest torque of every element with two flanks, the moment of rest left out.

    Its error is its own change between the two steps, with what modes left out and pieces may add: near
    rest it is far smaller than that of the peak.
    """
    turning, coarse = start.turning_of_element(), start.coarse_turning_of_element()
    pieces = dict(start.pieces_error)
    toothed = {m.element for m in case.meshes} | {train.elements[f.element] for f in train.flanks}
    toothed |= {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    given = {train.elements[f.element] for f in train.flanks if f.gap}
    zero = {m.element for m in case.meshes if 0.0 in (m.backlash, m.angular_backlash)}
    minima = []
    for i, name in enumerate(train.elements):
        if name in toothed and i in turning:
            value = turning[i][1]
            largest = float(np.max(np.abs(value)))
            lowest = _after_rest(value)
            off = abs(lowest - _after_rest(coarse[i][1]))
            off += (start.truncation_error + pieces.get(name, 0.0)) * largest
            tight = name in zero and name not in given
            minima.append(ElementMinimum(name, lowest, off, largest, name in given, tight))
    return tuple(minima)


def _after_rest(torques: Floats) -> float:
    """Lowest torque after the first. [N m]"""
    return float((torques[1:] if len(torques) > 1 else torques).min())


def start_evidence(
    case: CaseData, model: ModalTrain, start: Start, wall_time: float, damping_limit: float = 0.0
) -> StartEvidence:
    """What a calculated start says: the linear one, or one with events.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    model : ModalTrain
        The train of that start. [SI]
    start : Start
        The start. [SI]
    wall_time : float
        What it cost. [s]
    damping_limit : float, optional
        Bound on what the limit on contact damping changes of a linear start. [1]

    Returns
    -------
    StartEvidence
        For `Evidence.linear` or `Evidence.event`. [SI]
    """
    stress = stress_over_endurance(case, start)
    return StartEvidence(
        minima=_element_minima(case, model.train, start),
        truncation_error=start.truncation_error,
        kept_modes=start.kept_modes,
        time=start.outcome.time,
        outcome=start.outcome.outcome,
        stress_ratio=None if stress is None else stress[0],
        must_count=stress is not None and stress[1],
        wall_time=wall_time,
        n_modes=model.train.n_dof,
        damping_limit=damping_limit,
        sizes={p.element: p.size for p in start.peaks},
    )


def moves_laterally(case: CaseData, evidence: Evidence) -> bool:
    """Whether gears move laterally on their bearings in the start: the decision on bearings."""
    if evidence.bearing_number is None:
        return False
    choice = choice_of(case, "bearings")
    wanted = evidence.bearing_number > evidence.tolerance / BEARING_GAIN
    return choice == "on" or (choice == "auto" and wanted)


def reversing_minima(start: StartEvidence, tolerance: float) -> list[ElementMinimum]:
    """Elements with a clearance whose torque may reverse so far that it matters.

    Parameters
    ----------
    start : StartEvidence
        Evidence from a start. [N m]
    tolerance : float
        Relative change of an answer that may be neglected. [1]

    Returns
    -------
    list of ElementMinimum
        In the order of the start's. [N m]
    """
    return [m for m in start.minima if m.clearance and m.lowest < -tolerance / BACKLASH_GAIN]


def reversing(evidence: Evidence) -> tuple[str, ...]:
    """Elements whose clearance the linear start calls for; none before it."""
    if evidence.linear is None:
        return ()
    return tuple(m.element for m in reversing_minima(evidence.linear, evidence.tolerance))
