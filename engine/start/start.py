"""The start: average and pulsating torque against the loads, from rest to the end speed.

The train is integrated in modal coordinates by the exponential step (or, for comparison, by the
paper's average-acceleration method). The accuracy asked for is that of the answers, peak torques
and starts: the start is calculated at two steps, h and h/2, whose difference is the error
estimate, and the step is halved until it is small enough. Turning points come from the dense
output, a cubic between samples, so a peak between two samples is not missed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.case.data import DEFAULT_END_SPEED, LEAST_PEAK_ERROR, CaseData
from engine.case.effects import BearingForce, ContactRecord, PullIn, Sensitivity, StartEffects
from engine.errors import InternalError, ModelError
from engine.model.load import Load, loads_of
from engine.model.modes import ModalDamping, Modes
from engine.model.motor import (
    Motor,
    electrical_arrays,
    has_electrical,
    motors_of,
    through_synchronism,
    voltage_factor,
)
from engine.model.rigid_runup import RigidRunup, rigid_runup
from engine.model.train import Train
from engine.numerics.torque_curve import TorqueCurve
from engine.start.torque_outputs import TorqueOutputs, force_reach, torque_outputs
from engine.start.trajectory import KEPT_VALUES, Recorder, Trajectory, read_turning, turning_of
from engine.stepping import linear_loop as kernels
from engine.stepping.exponential import exponential_step
from engine.stepping.newmark import newmark_step

__all__ = [
    "DEFAULT_TOLERANCE_PEAK",
    "ElementPeak",
    "ForceHistories",
    "NOTABLE_REVERSAL",
    "PreparedStart",
    "SingleRun",
    "Start",
    "StartOutcome",
    "StartSettings",
    "Trajectory",
    "element_peaks",
    "has_start",
    "keeps_history",
    "prepared_start",
    "relative_errors",
    "run_start",
    "settings_of",
    "simulate",
    "start_model",
    "turning_of",
    "worst_outputs",
]

Floats = NDArray[np.float64]

#: No effect beyond the plain start is simulated.
PLAIN_START = StartEffects()
#: Accuracy of peak torques where the case leaves it blank. [1]
DEFAULT_TOLERANCE_PEAK = 1e-3
#: An equilibrium at or above this share of synchronous speed is `asynchronous`, below `stalled`.
ASYNCHRONOUS_ABOVE = 0.95
#: A torque below zero by less than this share of the largest torque is not called a reversal.
NOTABLE_REVERSAL = 1e-3
#: Longest start simulated where MaximumTime is blank. [s]
LONGEST_START = 600.0
#: Time simulated where the motor cannot break the train away. [s]
STANDSTILL_TIME = 2.0
#: Largest and smallest phase of the pulsation per step tried first. [rad]
COARSEST_FIRST, FINEST_FIRST = 2.0, 0.02
#: A ringing mode is followed by steps of at most this phase. [rad]
COARSEST_ANGLE = 1.2
#: Peak error of the exponential start at 1 rad of pulsation phase per step: measured 1e-5 × (phase
#: per step)⁴ (docs/benchmarks.md, the start), taken four times as large. [1]
ERROR_AT_ONE_RADIAN = 4e-5
#: The same for Newmark: error ≈ this × (phase per step)², second order and far larger.
NEWMARK_ERROR_AT_ONE_RADIAN = 0.4
#: Steps are halved at most so often before the best result is reported with its error.
MAX_HALVINGS = 7
#: Steps between two copies of the state out of the compiled loop.
CHUNK = 4096
#: Modes whose ringing decays below this share of the tolerance need no fine steps any more.
FADED = 0.05
#: A mode far above the pulsation that would need more steps than this is not integrated; it
#: follows statically, and its ringing after breaker closing is reported as an error.
MAX_RINGING_STEPS = 500_000
#: Steps in the time a load's station takes through the standstill zone, and how many such times.
BREAKAWAY_POINTS, BREAKAWAY_LENGTH = 6.0, 3.0
#: A transient that dies out faster than the pulsation varies is followed so many time constants.
SHOCK_LENGTH = 12.0
#: Maxima, and minima, of two runs that are compared to estimate the error of the largest.
COMPARED_EXTREMES = 6
#: No element is taken to be more accurate than this share of the worst, nor than `LEAST_PEAK_ERROR`.
SHARED_ERROR = 0.3
#: "Far above the pulsation": this many times its highest frequency.
FAR_ABOVE = 10.0
#: Most values (steps × outputs) of one simulation that is only meant to refine another.
MAX_VALUES = 10_000_000
#: An output below this share of the largest counts as that share: torque that is only rounding.
NEGLIGIBLE = 1e-9
#: Share of its peak torque that a motor is at least taken to switch on when modes are judged.
SWITCHED_SHARE = 0.25
#: The step is at most this over the rate of the fastest damper that acts as a force.
DAMPER_STEP = 0.5
#: Dampers that would need a step below this share of the usual one stay on each mode for itself.
FINEST_DAMPER_STEP = 0.05
#: A damper beside a spring is idle where its torque stays below this share of the tolerance.
IDLE_DAMPER = 0.1
#: Largest amplification of a mode when the force of a damper across it is estimated: what sweeping
#: through a resonance leaves of it in practice.
LARGEST_AMPLIFICATION = 20.0
#: A mode sampled once in this phase shows this share of its ringing as error of the dense output.
SAMPLED_ANGLE = 7.0
#: A simulation that has neither settled nor ended is prolonged this often to twice its length.
MAX_PROLONGATIONS = 6
#: Speed this close to the equilibrium of the rigid train has settled.
SETTLED = 0.01


@dataclass(frozen=True)
class StartSettings:
    """How a start is to be calculated."""

    method: str  #: ``exponential`` or ``newmark``.
    tolerance_peak: float  #: Wanted relative error of peak torques. [1]
    end_speed: float  #: Speed of the reference shaft at which the start ends. [rad/s]
    maximum_time: float | None  #: Longest simulated time; None = from the rigid-body run-up. [s]


@dataclass(frozen=True)
class StartOutcome:
    """How the start ended."""

    #: ``reached``, ``asynchronous``, ``stalled``, ``no breakaway`` or ``time out``; with the field
    #: applied ``synchronised`` or ``not synchronised`` (it went on slipping poles, or the run
    #: ended first); ``tripped``: an aborted start came to its trip speed and coasted down.
    outcome: str
    time: float  #: Simulated time. [s]
    end_speed: float  #: Mean speed of the reference shaft at that time. [rad/s]
    sentence: str  #: The outcome with its numbers.


@dataclass(frozen=True)
class ElementPeak:
    """Extremes of the torque of one element over the whole start."""

    element: str  #: Element.
    maximum: float  #: Largest and smallest torque, at the element's own speed. [N m]
    minimum: float  #: Likewise. [N m]
    time: float  #: When the larger of the two magnitudes occurs. [s]
    speed: float  #: Mean speed of the reference shaft then. [rad/s]
    error: float  #: Estimated absolute error of the extremes. [N m]

    @property
    def peak_to_peak(self) -> float:
        """Maximum minus minimum. [N m]"""
        return self.maximum - self.minimum

    @property
    def relative_error(self) -> float:
        """Error over the larger magnitude of the extremes. [1]"""
        size = max(abs(self.maximum), abs(self.minimum))
        return self.error / size if size > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class ForceHistories:
    """Forces of teeth and bearings at the samples of a trajectory."""

    teeth: tuple[str, ...]  #: Meshes.
    #: Normal tooth force, positive on the drive flank, negative on the back flank. [N] Shape
    #: (n_meshes, n_times).
    tooth_force: Floats
    bearings: tuple[str, ...]  #: Gears that move sideways.
    #: Magnitude of the radial force, without weight. [N] Shape (n_gears, n_times).
    bearing_force: Floats


@dataclass(frozen=True, eq=False)
class Start:
    """A complete start."""

    outcome: StartOutcome  #: How it ended. [mixed]
    peaks: tuple[ElementPeak, ...]  #: One an element. [N m]
    trajectory: Trajectory  #: The finest simulation. [SI]
    #: Per element, times and torques of all turning points from rest to the end. [s, N m]
    turning_points: tuple[tuple[Floats, Floats], ...]
    #: The same at twice the step: what the error of cycle counts is estimated from. [s, N m]
    coarse_turning_points: tuple[tuple[Floats, Floats], ...]
    #: Row of `trajectory.torque` that stands for each element; −1 where there is none. Shape
    #: (n_elements,).
    output_of_element: NDArray[np.int64]
    #: The rigid-body run-up; None for a response to prescribed torques alone. [SI]
    runup: RigidRunup | None
    step: float  #: Largest step used. [s]
    halvings: int  #: How often the step was halved to meet the tolerance.
    estimated_error: float  #: Largest relative error of the peaks. [1]
    truncation_error: float  #: Part of it that the modes left out may cause. [1]
    kept_modes: int  #: Modes integrated.
    method: str  #: ``exponential`` or ``newmark``.
    met_tolerance: bool  #: False if halving stopped before the tolerance was met.
    #: Dampers that stayed on each mode for itself although coupling was asked for.
    uncoupled_dampers: tuple[str, ...] = ()
    #: What happened at each clearance that was modelled. [SI]
    contacts: tuple[ContactRecord, ...] = ()
    #: Largest bearing force of each gear that moves sideways. [N]
    bearing_forces: tuple[BearingForce, ...] = ()
    pull_in: PullIn | None = None  #: Field application and what came of it. [SI]
    #: Asked where the answers did not settle as the step was refined. [1]
    sensitivity: Sensitivity | None = None
    #: Tooth and bearing forces against time, where they were calculated. [N]
    forces: ForceHistories | None = None
    #: Unwrapped load angle at the samples, the motor lagging positive; None without a field. [rad]
    #: Shape (n_times,).
    load_angle: Floats | None = None

    @property
    def is_sensitive(self) -> bool:
        """Whether it was found that a tiny change of the input changes its peaks. [flag]"""
        return self.sensitivity is not None and self.sensitivity.sensitive

    def turning_of_element(self) -> dict[int, tuple[Floats, Floats]]:
        """Turning points by element index: times and torques. [s, N m]"""
        judged = np.flatnonzero(self.output_of_element >= 0)
        return dict(zip((int(e) for e in judged), self.turning_points, strict=True))


@dataclass(frozen=True, eq=False)
class StartModel:
    """A start in arrays: kept modes, force stations, curves."""

    #: ω² and damping coefficient of the kept modes. [1/s², 1/s] Shape (n_modes,).
    stiffness: Floats
    rate: Floats  #: Likewise. [1/s², 1/s] Shape (n_modes,).
    reach: Floats  #: Forces to modes. [rad/√(kg m²)] Shape (n_modes, n_forces).
    #: Rigid-body speed of the reference shaft from modal velocities. [√(1/(kg m²))] Shape
    #: (n_modes,).
    mean_speed: Floats
    outputs: TorqueOutputs  #: Element torques. [SI]
    curves: tuple[Any, ...]  #: Arguments of the compiled loop. [SI]
    motors: tuple[Any, ...]  #: Likewise. [SI]
    loads: tuple[Any, ...]  #: Likewise. [SI]
    timed: tuple[Any, ...]  #: Likewise. [SI]
    dampers: tuple[Any, ...]  #: Likewise. [SI]
    phase: Floats  #: Phase of each pulsation at t = 0. [rad] Shape (n_motors,).
    pulsation_omega: float  #: Highest pulsation frequency, twice line. [rad/s]
    #: (end time, largest angular frequency to be resolved until then). [s, rad/s]
    windows: tuple[tuple[float, float], ...]
    #: Bound on what the modes left out may add to each output. [N m] Shape (n_outputs,).
    truncation: Floats
    largest_step: float  #: Longest step at which dampers that act as forces are followed. [s]
    #: Transient, field and connection of each motor, for the compiled loop. [SI]
    electrical: tuple[Any, ...]
    keep: NDArray[np.bool_]  #: Modes that are integrated. [mask] Shape (n_modes,).
    #: Nodes of the first forces: stations, then dampers to ground. [indices]
    force_nodes: NDArray[np.int64]
    #: Rows of the remaining forces, dampers across elements. [indices]
    damper_rows: NDArray[np.int64]
    #: Dampers so strong for their inertias that following them as forces would need absurdly short
    #: steps: they damp each mode for itself although coupling was asked for.
    uncoupled_dampers: tuple[str, ...] = ()


def keeps_history(case: CaseData) -> bool:
    """Whether the case wants every sample of the start in a file.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    bool
        True if KeepHistory names a kind of file.
    """
    return case.keep_history not in (None, "no")


def has_start(case: CaseData) -> bool:
    """Whether the case describes a start.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    bool
        True if there is a motor torque curve.
    """
    return bool(case.motor_torque)


def settings_of(case: CaseData) -> StartSettings:
    """Settings of the start, blanks filled.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    StartSettings
        Method, tolerance, end speed and maximum time. [SI]

    Raises
    ------
    ModelError
        Without synchronous speed.
    """
    synchronous = case.ratings.synchronous_speed
    if synchronous is None:
        raise ModelError("A start needs the synchronous speed.")
    return StartSettings(
        case.method or "exponential",
        case.tolerance_peak or DEFAULT_TOLERANCE_PEAK,
        case.end_speed or DEFAULT_END_SPEED * synchronous,
        case.maximum_time,
    )


# --- the model ----------------------------------------------------------------------------------


def start_model(
    case: CaseData,
    train: Train,
    modes: Modes,
    damping: ModalDamping,
    motors: tuple[Motor, ...],
    loads: tuple[Load, ...],
    tolerance: float,
    maximum_time: float = 60.0,
    effects: StartEffects = PLAIN_START,
    *,
    implicit_dampers: bool = False,
) -> StartModel:
    """Arrays of a start, with as few modes as the tolerance allows.

    A damper without a spring beside it (a fluid coupling) carries the torque of everything beyond
    it, so it is not spread over the modes but acts as a torque between its two ends. With
    `effects.coupled_damping` all dampers do, those to ground too, which is exact for damping of any
    distribution.

    Parameters
    ----------
    case : CaseData
        The case (for prescribed torques). [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        All its modes. [SI]
    damping : ModalDamping
        Damping of each mode. [SI]
    motors, loads : tuple
        Motors and driven machines. [SI]
    tolerance : float
        Wanted relative error of peak torques; a tenth of it may go to modes left out. [1]
    maximum_time : float, optional
        Longest simulated time: what following a ringing mode costs. [s]
    effects : StartEffects, optional
        Which electrical transients, dampers and modes count. Field, trip and clearances are events
        of the run; here only the sizes of their torques are taken into account. [flags]
    implicit_dampers : bool, optional
        True: the loop solves for the forces of dampers, so none is too strong for it. [flag]

    Returns
    -------
    StartModel
        Arguments of the compiled loop. [SI]
    """
    timed_names = list(dict.fromkeys(p.station for p in case.torque_time))
    timed_stations = [train.station_index(str(n)) for n in timed_names]
    stations = sorted(
        {m.station for m in motors} | {d.station for d in loads} | set(timed_stations)
    )
    column = {s: i for i, s in enumerate(stations)}
    index = np.array(stations, dtype=np.int64)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed
    fastest = 2.0 * line_omega
    shock = _shock(case, effects)
    dampers = _candidate_dampers(train, effects, tolerance, fastest)
    uncoupled: list[str] = []
    while True:
        forces = np.concatenate([index, dampers.nodes])  # stations first, then dampers to ground
        all_reach = np.concatenate(
            [force_reach(train, modes, forces), modes.row_twist[dampers.rows].T], axis=1
        )
        of_stations = _force_sizes(case, train, motors, loads, column, effects)
        sizes = _with_dampers(of_stations, train, modes, damping, dampers, all_reach, fastest)
        outputs = _outputs(train, modes, forces, dampers, uncoupled)
        ringing, slow, scale = _mode_amplitudes(modes, outputs, all_reach, sizes, fastest)
        keep = _kept_modes(modes, ringing, slow, scale, tolerance, fastest, effects)
        windows = _windows(
            modes, damping, ringing, scale, keep, tolerance, fastest, maximum_time, effects
        )
        gains = dampers.viscous * np.sum(all_reach[keep][:, len(index) :] ** 2, axis=0)
        held = _too_strong(dampers, gains, all_reach[keep][:, len(index) :], tolerance, fastest)
        if implicit_dampers or not np.any(held):
            break
        uncoupled += [dampers.names[i] for i in np.flatnonzero(held)]
        dampers = dampers.without(held)
    jump = _last_jump(case)
    own = all_reach[:, len(index) :]
    rate = damping.rate - own**2 @ dampers.viscous  # those act as forces
    left_out = ~keep
    truncation = (ringing + slow)[:, left_out].sum(axis=1)
    reference = modes.shape[train.node_dof[motors[0].station]]
    reference = reference * train.node_scale[motors[0].station]
    mean = np.where(modes.omega == 0.0, reference, 0.0) / train.speed_ratio[motors[0].station]
    if not np.any(mean):
        raise ModelError(
            f"Station '{train.stations[motors[0].station]}' is held to ground by a spring; its "
            "motor cannot start."
        )
    curves: list[TorqueCurve] = []
    return StartModel(
        np.ascontiguousarray(modes.omega[keep] ** 2),
        np.ascontiguousarray(np.maximum(rate[keep], 0.0)),
        np.ascontiguousarray(all_reach[keep]),
        np.ascontiguousarray(mean[keep]),
        _outputs(train, modes, forces, dampers, uncoupled, keep),
        motors=_motor_arrays(motors, column, curves, line_omega, effects),
        loads=_load_arrays(loads, column, curves),
        timed=_timed_arrays(case, timed_names, timed_stations, column),
        curves=_curve_arrays(curves),
        dampers=(np.arange(len(index), all_reach.shape[1]), dampers.viscous),
        phase=np.array([m.phase for m in motors]),
        pulsation_omega=fastest,
        windows=_with_breakaway(windows, train, motors, loads, jump, shock, fastest),
        truncation=truncation,
        largest_step=_damper_step(dampers, own, keep),
        electrical=electrical_arrays(motors, case, effects),
        keep=keep,
        force_nodes=forces,
        damper_rows=dampers.rows,
        uncoupled_dampers=tuple(uncoupled),
    )


@dataclass(frozen=True, eq=False)
class _Dampers:
    """Dampers that act as forces: those at nodes, to ground, then those of rows."""

    nodes: NDArray[np.int64]
    rows: NDArray[np.int64]
    viscous: Floats  # of both [N m s/rad]
    needed: NDArray[np.bool_]  # not to be given back to the modes: there is no spring beside it
    names: tuple[str, ...]

    def without(self, held: NDArray[np.bool_]) -> _Dampers:
        """All but those held."""
        n = len(self.nodes)
        return _Dampers(
            self.nodes[~held[:n]],
            self.rows[~held[n:]],
            self.viscous[~held],
            self.needed[~held],
            tuple(name for name, out in zip(self.names, held, strict=True) if not out),
        )


def _candidate_dampers(
    train: Train, effects: StartEffects, tolerance: float, fastest: float
) -> _Dampers:
    """Dampers without a spring; where coupling is asked for all dampers."""
    loose = (train.stiffness == 0.0) & (train.viscous > 0.0)
    rows, nodes = np.flatnonzero(loose), np.zeros(0, dtype=np.int64)
    if effects.coupled_damping:
        # a damper beside a spring so stiff that it takes no share of the torque couples nothing
        idle = FAR_ABOVE * fastest * train.viscous < IDLE_DAMPER * tolerance * train.stiffness
        rows = np.flatnonzero((train.viscous > 0.0) & ~idle)
        nodes = np.flatnonzero(train.node_damping > 0.0)
    names = [
        f"{train.stations[i]} (to ground)" if i < train.n_stations else f"node {i} (to ground)"
        for i in nodes
    ]
    for row in rows:
        element = int(train.row_element[row])
        names.append(train.elements[element] if element >= 0 else f"bearing (row {row})")
    return _Dampers(
        nodes,
        rows,
        np.concatenate([train.node_damping[nodes], train.viscous[rows]]),
        np.concatenate([np.zeros(len(nodes), dtype=np.bool_), loose[rows]]),
        tuple(names),
    )


def _too_strong(
    dampers: _Dampers, gains: Floats, reach: Floats, tolerance: float, fastest: float
) -> NDArray[np.bool_]:
    """Dampers that would need absurdly short steps: as few as possible, the strongest first."""
    held = np.zeros(len(gains), dtype=np.bool_)
    most = DAMPER_STEP / (FINEST_DAMPER_STEP * _usual_step(tolerance, fastest))
    for i in np.argsort(-gains, kind="stable"):
        if dampers.needed[i]:
            continue
        # the sum bounds the rate of all together; where it is not good enough, the exact norm
        left = ~held & ~dampers.needed
        if gains[left].sum() <= most or _joint_rate(reach[:, left], dampers.viscous[left]) <= most:
            break
        held[i] = True
    return held


def _joint_rate(reach: Floats, viscous: Floats) -> float:
    """Largest rate at which dampers together slow any motion: the norm of R diag(c) Rᵀ. [1/s]"""
    if not len(viscous):
        return 0.0
    return float(np.linalg.norm(reach * np.sqrt(viscous), 2) ** 2)


def _damper_step(dampers: _Dampers, reach: Floats, keep: NDArray[np.bool_]) -> float:
    """Longest step at which the dampers are followed. [s]"""
    loose = dampers.viscous * np.sum(reach**2, axis=0) * dampers.needed
    rate = float(np.max(loose, initial=0.0))
    if not np.all(dampers.needed):
        rate = max(rate, _joint_rate(reach[keep], dampers.viscous))
    return DAMPER_STEP / max(rate, 1e-300)


def _outputs(
    train: Train,
    modes: Modes,
    forces: NDArray[np.int64],
    dampers: _Dampers,
    uncoupled: Sequence[str],
    keep: NDArray[np.bool_] | None = None,
) -> TorqueOutputs:
    """Element torques; a rigid mesh also feels the dampers that act as forces on its To side.

    Those without a spring are in the torque of their row already. A damper too strong to be coupled
    acts on every mode for itself; its torque between its own ends is then not c times their speed.
    """
    outputs = torque_outputs(train, modes, forces, keep, dampers=dampers.rows)
    if uncoupled:
        modal = np.isin(
            outputs.element, [train.elements.index(n) for n in uncoupled if n in train.elements]
        )
        outputs = replace(outputs, velocity=np.where(modal[:, None], 0.0, outputs.velocity))
    if not train.rigid_meshes or np.all(dampers.needed):
        return outputs
    force = outputs.force.copy()
    first = len(forces)
    for mesh in train.rigid_meshes:
        output = int(np.flatnonzero(outputs.element == mesh.element)[0])
        nodes = np.array(mesh.to_side)
        ratio = train.speed_ratio[nodes] / mesh.from_ratio
        drawn = train.node_incidence[dampers.rows][:, nodes] @ ratio
        sprung = ~dampers.needed[len(dampers.nodes) :]
        force[output, first:] -= train.orientation[mesh.element] * np.where(sprung, drawn, 0.0)
    return replace(outputs, force=force)


def _usual_step(tolerance: float, fastest: float) -> float:
    """Step that the pulsation asks for. [s]"""
    angle = float((0.5 * tolerance / ERROR_AT_ONE_RADIAN) ** 0.25)
    return min(max(angle, FINEST_FIRST), COARSEST_FIRST) / fastest


@dataclass(frozen=True)
class _Shock:
    """The transient at breaker closing."""

    amplitude: float
    rate: float


def _shock(case: CaseData, effects: StartEffects) -> _Shock | None:
    """Transient at breaker closing, if it is simulated and stated."""
    if not (effects.breaker_closing and case.shock_amplitude and case.shock_time_constant):
        return None
    return _Shock(voltage_factor(case) * abs(case.shock_amplitude), 1.0 / case.shock_time_constant)


@dataclass(frozen=True, eq=False)
class _ForceSizes:
    """How large each force is: what modes are judged by."""

    step: Floats  # switched on at once
    ramp: Floats  # sum of all changes of slope [N m/s]
    smooth: Floats  # largest value of what varies no faster than the pulsation
    carried: Floats  # what the scale of the outputs is judged by


def _force_sizes(
    case: CaseData,
    train: Train,
    motors: tuple[Motor, ...],
    loads: tuple[Load, ...],
    column: dict[int, int],
    effects: StartEffects,
) -> tuple[_ForceSizes, float]:
    """Sizes of the forces at stations, and the sum of the driving ones at the reference shaft."""
    n = len(column)
    step, ramp, smooth = (np.zeros(n) for _ in range(3))
    reference_torque = 0.0
    shock = _shock(case, effects)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed
    pull_out = voltage_factor(case) * (case.pull_out_torque or 0.0) if effects.pull_in else 0.0
    for m in motors:
        i = column[m.station]
        largest = float(np.max(np.abs(m.average.cubic[:, 0])))
        pulsating = float(np.max(np.abs(m.pulsating.cubic[:, 0])))
        initial = abs(float(m.average(0.0)) + float(m.pulsating(0.0)) * math.sin(m.phase))
        switched_off = largest + pulsating + pull_out if effects.aborted_start else 0.0
        step[i] += max(initial, SWITCHED_SHARE * largest, switched_off)
        smooth[i] += pulsating
        if shock is not None:  # begins with the slope of A sin ωt, then varies no faster than that
            ramp[i] += shock.amplitude * line_omega
            smooth[i] += shock.amplitude
        if pull_out:
            if case.field_time_constant:
                ramp[i] += pull_out / case.field_time_constant
            else:
                step[i] += pull_out
            smooth[i] += pull_out
        reference_torque += (largest + pulsating) * float(train.speed_ratio[m.station])
    for d in loads:
        step[column[d.station]] += float(d.torque(0.0))
    for name in dict.fromkeys(p.station for p in case.torque_time):
        rows = [p for p in case.torque_time if p.station == name]
        times = np.array([p.time for p in rows], dtype=float)
        torques = np.array([p.torque for p in rows], dtype=float)
        i = column[train.station_index(str(name))]
        slope = np.diff(torques) / np.diff(times)
        step[i] += abs(float(torques[0]))
        ramp[i] += float(np.sum(np.abs(np.diff(slope, prepend=0.0, append=0.0))))
        smooth[i] += float(np.max(np.abs(torques)))
        reference_torque += smooth[i] * float(train.speed_ratio[train.station_index(str(name))])
    carried = np.maximum(step, SWITCHED_SHARE * smooth)
    return _ForceSizes(step, ramp, smooth, carried), reference_torque


def _with_dampers(
    of_stations: tuple[_ForceSizes, float],
    train: Train,
    modes: Modes,
    damping: ModalDamping,
    dampers: _Dampers,
    reach: Floats,
    fastest: float,
) -> _ForceSizes:
    """Sizes of all forces, those of the dampers last.

    A damper without a spring carries the whole torque. Any other has its coefficient times the
    speed across it: of the vibration its modes may reach, and to ground that of the shaft itself.
    It loads no element by more than those forces do, so it has no part in the scale.
    """
    sizes, reference_torque = of_stations
    n = len(sizes.step)
    drive = np.abs(reach[:, :n]) @ (sizes.step + sizes.smooth)
    safe = np.where(modes.omega > 0.0, modes.omega, np.inf)
    excess = 1.0 / np.maximum(2.0 * damping.ratio, 1.0 / LARGEST_AMPLIFICATION)
    vibration = np.where(safe <= fastest, np.maximum(excess, 1.0), fastest / safe) * drive / safe
    smooth = dampers.viscous * (np.abs(reach[:, n:]).T @ vibration)
    ramp = dampers.viscous * np.abs(reach[:, n:].T @ (reach[:, :n] @ sizes.step))
    carried = np.zeros(len(smooth))
    grounded = len(dampers.nodes)
    ratio = train.speed_ratio[dampers.nodes]
    smooth[:grounded] += dampers.viscous[:grounded] * 0.5 * fastest * ratio
    for k, row in enumerate(dampers.rows, start=grounded):
        end = float(train.speed_ratio[int(np.argmax(np.abs(train.node_incidence[row])))])
        if dampers.needed[k] and end > 0.0:
            smooth[k], ramp[k] = reference_torque / end, 0.0
            carried[k] = SWITCHED_SHARE * smooth[k]
    return _ForceSizes(
        np.concatenate([sizes.step, np.zeros(len(smooth))]),
        np.concatenate([sizes.ramp, ramp]),
        np.concatenate([sizes.smooth, smooth]),
        np.concatenate([sizes.carried, carried]),
    )


def _last_jump(case: CaseData) -> float:
    """Latest time at which a table of torque against time begins with a jump; else zero."""
    first = {p.station: p for p in reversed(case.torque_time)}
    return max((float(p.time or 0.0) for p in first.values() if p.torque), default=0.0)


def _mode_amplitudes(
    modes: Modes, outputs: TorqueOutputs, reach: Floats, sizes: _ForceSizes, fastest: float
) -> tuple[Floats, Floats, Floats]:
    """Bounds per output and mode on ringing and on slow dynamics, and the torque scale of outputs.

    A step rings with its own static deflection, a change of slope with that of slope/ω; a smooth
    force at ω ≤ `fastest` exceeds its static deflection by (ω/ω_r)² / (1 − (ω/ω_r)²) in a mode
    well above it.
    """
    safe = np.where(modes.omega > 0.0, modes.omega, np.inf)
    flexible = np.abs(outputs.position) / safe**2
    ringing = flexible * (np.abs(reach) @ sizes.step + np.abs(reach) @ sizes.ramp / safe)
    share = (fastest / safe) ** 2
    dynamic = np.where(share < 0.9, share / np.where(share < 0.9, 1.0 - share, 1.0), 1.0)
    slow = flexible * (np.abs(reach) @ sizes.smooth) * dynamic
    torque = sizes.carried
    signed = outputs.position / safe**2 @ (reach * torque)
    scale = np.max(np.abs(signed + outputs.force * torque), axis=1, initial=0.0)
    return ringing, slow, np.maximum(scale, NEGLIGIBLE * np.max(scale, initial=0.0))


def _kept_modes(
    modes: Modes, ringing: Floats, slow: Floats, scale: Floats, tolerance: float, fastest: float,
    effects: StartEffects,
) -> NDArray[np.bool_]:  # fmt: skip
    """Drop modes from the top while their bound stays below a tenth of the tolerance."""
    keep = np.ones(modes.n_modes, dtype=np.bool_)
    if effects.fast_modes:
        return keep
    budget = 0.1 * tolerance * scale
    used = np.zeros(len(scale))
    for r in range(modes.n_modes - 1, -1, -1):
        used = used + ringing[:, r] + slow[:, r]
        if modes.omega[r] < 1.5 * fastest or np.any(used > budget):
            break
        keep[r] = False
    return keep


def _windows(
    modes: Modes, damping: ModalDamping, ringing: Floats, scale: Floats,
    keep: NDArray[np.bool_], tolerance: float, fastest: float, maximum_time: float,
    effects: StartEffects,
) -> tuple[tuple[float, float], ...]:  # fmt: skip
    """Until when each kept fast mode rings visibly after breaker closing.

    Modes that would take an absurd number of steps (a link of 1e16 N m/rad without damping) are
    taken out of `keep`, whatever was chosen. Where all modes were asked for there are some that
    ring by next to nothing but so fast that the cubic between two samples would exaggerate it.
    """
    windows: list[tuple[float, float]] = []
    usual = _usual_step(tolerance, fastest)
    budget = min(MAX_RINGING_STEPS, MAX_VALUES // max(len(scale), 1))
    for r in np.flatnonzero(keep & (modes.omega > fastest))[::-1]:
        with np.errstate(divide="ignore", invalid="ignore"):
            size = np.where(scale > 0.0, ringing[:, r] / scale, 0.0).max(initial=0.0)
        if effects.fast_modes:
            size *= max(1.0, modes.omega[r] * usual / SAMPLED_ANGLE)
        if size <= FADED * tolerance:
            continue
        decay = 0.5 * damping.rate[r]
        until = math.log(size / (FADED * tolerance)) / decay if decay > 0.0 else math.inf
        steps = min(until, maximum_time) * modes.omega[r] / COARSEST_ANGLE
        if steps > budget and modes.omega[r] > FAR_ABOVE * fastest:
            keep[r] = False
        elif not windows or until > windows[-1][0]:
            windows.append((until, float(modes.omega[r])))
    return tuple(windows)


def _with_breakaway(
    windows: tuple[tuple[float, float], ...],
    train: Train,
    motors: tuple[Motor, ...],
    loads: tuple[Load, ...],
    jump: float,
    shock: _Shock | None,
    fastest: float,
) -> tuple[tuple[float, float], ...]:
    """The windows, with those of the loads as their stations begin to turn and of a short shock."""
    inertia = float(train.inertia @ train.dof_ratio**2)
    torque = sum(float(m.average(0.0)) * float(train.speed_ratio[m.station]) for m in motors)
    shifted = [(until + jump, omega) for until, omega in windows]
    if shock is not None and shock.rate > fastest:
        shifted.append((SHOCK_LENGTH / shock.rate, shock.rate))
    for d in loads:
        if torque <= 0.0 or float(d.torque(0.0)) == 0.0:
            continue
        passing = d.soft_speed / float(train.speed_ratio[d.station]) * inertia / torque
        shifted.append((BREAKAWAY_LENGTH * passing, BREAKAWAY_POINTS * COARSEST_ANGLE / passing))
    return _merged(shifted)


def _merged(windows: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """In falling frequency and rising time, without those that others cover."""
    kept: list[tuple[float, float]] = []
    for until, omega in sorted(windows, key=lambda w: -w[1]):
        if not kept or until > kept[-1][0]:
            kept.append((until, omega))
    return tuple(kept)


def _curve_arrays(curves: list[TorqueCurve]) -> tuple[Any, ...]:
    longest = max((len(c.knots) for c in curves), default=1)
    knots = np.zeros((len(curves), longest))
    cubics = np.zeros((len(curves), longest, 4))
    for i, c in enumerate(curves):
        knots[i, : len(c.knots)] = c.knots
        cubics[i, : len(c.knots)] = c.cubic
    return knots, cubics, np.array([len(c.knots) for c in curves], dtype=np.int64)


def _motor_arrays(
    motors: tuple[Motor, ...],
    column: dict[int, int],
    curves: list[TorqueCurve],
    line_omega: float,
    effects: StartEffects,
) -> tuple[Any, ...]:
    first, n = len(curves), len(motors)
    for m in motors:
        curves += [m.average, m.pulsating]
    with_field = np.arange(first, first + 2 * n, 2)
    if effects.pull_in:
        with_field = np.arange(len(curves), len(curves) + n)
        curves += [through_synchronism(m.average) for m in motors]
    return (
        np.array([column[m.station] for m in motors], dtype=np.int64),
        np.arange(first, first + 2 * n, 2),
        np.arange(first + 1, first + 2 * n, 2),
        np.array([m.synchronous_speed for m in motors]),
        np.array([m.pole_pairs for m in motors]),
        line_omega,
        with_field,
    )


def _load_arrays(
    loads: tuple[Load, ...], column: dict[int, int], curves: list[TorqueCurve]
) -> tuple[Any, ...]:
    first = len(curves)
    curves += [d.torque for d in loads]
    return (
        np.array([column[d.station] for d in loads], dtype=np.int64),
        np.arange(first, first + len(loads)),
        np.array([d.synchronous_speed for d in loads]),
        np.array([d.soft_speed for d in loads]),
    )


def _timed_arrays(
    case: CaseData, names: list[str | None], stations: list[int], column: dict[int, int]
) -> tuple[Any, ...]:
    rows = [[p for p in case.torque_time if p.station == n] for n in names]
    longest = max((len(r) for r in rows), default=1)
    times, torques = np.zeros((len(rows), longest)), np.zeros((len(rows), longest))
    for i, points in enumerate(rows):
        times[i, : len(points)] = [p.time for p in points]
        torques[i, : len(points)] = [p.torque for p in points]
    return (
        np.array([column[s] for s in stations], dtype=np.int64),
        times,
        torques,
        np.array([len(r) for r in rows], dtype=np.int64),
    )


# --- one simulation -----------------------------------------------------------------------------


def simulate(
    model: StartModel,
    step: float,
    method: str,
    target_speed: float,
    maximum_time: float,
    *,
    keep_all: bool = False,
) -> Trajectory:
    """One start at a given step.

    Parameters
    ----------
    model : StartModel
        The start in arrays. [SI]
    step : float
        Largest step; shorter ones are used while fast modes ring. [s]
    method : str
        ``exponential`` or ``newmark``. [word]
    target_speed : float
        Mean speed of the reference shaft at which to stop. [rad/s]
    maximum_time : float
        Time at which to stop at the latest. [s]
    keep_all : bool, optional
        True: no sample is left out, however much memory that takes. [flag]

    Returns
    -------
    Trajectory
        Times, mean speed and torques. [SI]
    """
    n, nf = model.reach.shape
    q, v = np.zeros(n), np.zeros(n)
    phase = model.phase.copy()
    force, rate = _forces_at(model, 0.0, 0.0, q, v, phase)
    recorder = Recorder(model.outputs.element, math.inf if keep_all else KEPT_VALUES)
    nothing = np.empty((0, 1))
    first = _torques(model, q[None], v[None], force[None], rate[None])
    recorder.add(np.zeros(1), np.zeros(1), *first, nothing)
    steps = 0
    t, flag = 0.0, kernels.PENDING
    electrical = model.electrical if has_electrical(model.electrical) else None
    coefficients = exponential_step if method == "exponential" else newmark_step
    for left, h in _step_plan(model, step, maximum_time):
        free, forced = (
            np.ascontiguousarray(a.transpose(1, 2, 0))
            for a in coefficients(model.stiffness, model.rate, h)
        )
        reach = np.ascontiguousarray(model.reach.T)
        force, rate = _forces_at(model, t, t + 0.5 * h, q, v, phase)
        while left > 0 and flag == kernels.PENDING:
            count = min(CHUNK, left)
            out = [
                np.empty((count, n)),
                np.empty((count, n)),
                np.empty((count, nf)),
                np.empty((count, nf)),
            ]
            done, flag = kernels.advance_start(
                count, h, t, target_speed, free, forced, model.stiffness, model.rate, reach,
                model.mean_speed, model.curves, model.motors, model.loads, model.timed,
                model.dampers, electrical, q, v, phase, force, rate, *out,
            )  # fmt: skip
            out_q, out_v, out_f, out_r = (a[:done] for a in out)
            torques = _torques(model, out_q, out_v, out_f, out_r)
            if not np.all(np.isfinite(torques[0][:, -1])):
                raise InternalError(
                    f"the start became non-finite before {t + h * done:.4g} s at a step of "
                    f"{step:.3g} s"
                )
            times = np.asarray(t + h * np.arange(1, done + 1), dtype=np.float64)
            recorder.add(times, out_v @ model.mean_speed, *torques, np.empty((0, done)))
            steps += done
            t += h * done
            left -= done
        if flag != kernels.PENDING:
            break
    return recorder.trajectory(flag == kernels.REACHED, steps)[0]


def _forces_at(
    model: StartModel, t: float, inside: float, q: Floats, v: Floats, phase: Floats
) -> tuple[Floats, Floats]:
    """Forces and their rates at one time; the rates depend on the acceleration the forces cause."""
    nf = model.reach.shape[1]
    force, rate = np.zeros(nf), np.zeros(nf)
    speed, acceleration = model.reach.T @ v, np.zeros(nf)
    own = model.rate * v + model.stiffness * q
    for _ in range(2):
        kernels.start_forces(
            t, inside, phase, speed, acceleration, model.curves, model.motors, model.loads,
            model.timed, model.dampers, model.electrical, force, rate,
        )  # fmt: skip
        acceleration = model.reach.T @ (model.reach @ force - own)
    return force, rate


def _step_plan(model: StartModel, step: float, maximum_time: float) -> list[tuple[int, float]]:
    """(number of steps, step) of each stretch.

    Steps are the base step divided by powers of two, shortened so that one ends at every knot of
    a torque against time.
    """
    times, counts = model.timed[1], model.timed[3]
    knots = np.unique(
        np.concatenate([np.zeros(0), *(t[:n] for t, n in zip(times, counts, strict=True))])
    )
    plan: list[tuple[int, float]] = []
    at = 0.0
    # a ringing mode is sampled as finely as the pulsation is
    stretches = [
        (until, step / 2 ** max(math.ceil(math.log2(omega / model.pulsation_omega)), 0))
        for until, omega in model.windows
    ]
    for until, h in [*stretches, (maximum_time, step)]:
        stop = min(until, maximum_time)
        while at < stop * (1.0 - 1e-12):
            count = math.ceil((stop - at) / h * (1.0 - 1e-12))
            ahead = knots[(knots > at + 1e-9 * h) & (knots <= at + count * h)]
            if len(ahead):
                count = math.ceil((ahead[0] - at) / h * (1.0 - 1e-12))
                plan.append((count, float(ahead[0] - at) / count))
                at = float(ahead[0])
            else:
                plan.append((count, h))
                at += count * h
    return plan


def _torques(
    model: StartModel, q: Floats, v: Floats, force: Floats, rate: Floats
) -> tuple[Floats, Floats]:
    """Output torques and rates, shape (n_outputs, n), from states, shape (n, …)."""
    y = model.outputs
    torque = y.position @ q.T + y.force @ force.T
    slope = y.position @ v.T + y.force @ rate.T
    if np.any(y.velocity):
        acceleration = force @ model.reach.T - v * model.rate - q * model.stiffness
        torque += y.velocity @ v.T
        slope += y.velocity @ acceleration.T
    return torque, slope


# --- from a trajectory to answers ---------------------------------------------------------------


def _end_of(trajectory: Trajectory, target_speed: float) -> float:
    """Time at which the target speed was crossed, or the last sample."""
    t, w = trajectory.time, trajectory.mean_speed
    if not trajectory.reached or len(t) < 2:
        return float(t[-1])
    share = (target_speed - w[-2]) / (w[-1] - w[-2])
    return float(t[-2] + min(max(share, 0.0), 1.0) * (t[-1] - t[-2]))


def worst_outputs(
    train: Train, trajectory: Trajectory, turning: list[tuple[Floats, Floats]]
) -> NDArray[np.int64]:
    """For each element the output (segment) with the largest peak-to-peak torque.

    Parameters
    ----------
    train : Train
        The train. [SI]
    trajectory : Trajectory
        A simulated start. [SI]
    turning : list of (ndarray, ndarray)
        Turning points of every output. [s, N m]

    Returns
    -------
    ndarray of int, shape (n_elements,)
        Output; −1 where an element has none. [index]
    """
    span = np.array([float(np.ptp(value)) for _, value in turning])
    chosen = np.full(len(train.elements), -1, dtype=np.int64)
    for output, element in enumerate(trajectory.output_element):
        if element < 0:  # a bearing of a gear, not an element of the train
            continue
        if chosen[element] < 0 or span[output] > span[chosen[element]]:
            chosen[element] = output
    return chosen


def _difference(
    a: tuple[Floats, Floats],
    b: tuple[Floats, Floats],
    until_largest: bool = False,
    guard_share: float = 1.0,
    same_until: float = math.inf,
) -> float:
    """Largest difference of the extremes of two runs, a share of that of the next smaller ones included.

    Two curves that differ may by chance share their largest value; they hardly share six. Those
    after the largest are compared with the nearest of the other run, not rank by rank: where one
    run has a ripple the other has not, all ranks below it would be compared with their neighbours.
    After many impacts two runs go their own ways; with `until_largest` what comes after the largest
    value says nothing about it. The share is all of it where the largest value comes after
    `same_until`.
    """
    worst = 0.0
    for sign in (1.0, -1.0):
        x, y = (_highest(sign * value, until_largest) for _, value in (a, b))
        latest = max(float(when[int(np.argmax(sign * value))]) for when, value in (a, b))
        share = guard_share if latest < same_until else 1.0
        worst = max(
            worst,
            abs(float(x[0] - y[0])),
            share * _distance(x[:COMPARED_EXTREMES], y[: 2 * COMPARED_EXTREMES]),
            share * _distance(y[:COMPARED_EXTREMES], x[: 2 * COMPARED_EXTREMES]),
        )
    return worst


def _highest(value: Floats, until_largest: bool) -> Floats:
    """Values in falling order; on request those up to the largest in time."""
    seen = value[: int(np.argmax(value)) + 1] if until_largest else value
    return np.sort(seen)[::-1]


def _distance(values: Floats, others: Floats) -> float:
    """Largest distance of any of the values from the nearest of the others."""
    return float(np.max(np.min(np.abs(values[:, None] - others[None, :]), axis=1)))


def _first_step(settings: StartSettings, fastest: float) -> float:
    """Step tried first, from the measured order of the method and the tolerance."""
    if settings.method == "newmark":
        angle = math.sqrt(0.5 * settings.tolerance_peak / NEWMARK_ERROR_AT_ONE_RADIAN)
        return min(max(angle, FINEST_FIRST), COARSEST_FIRST) / fastest
    return _usual_step(settings.tolerance_peak, fastest)


def run_length(runup: RigidRunup) -> float:
    """Time to simulate: that of the rigid train with a reserve.

    Parameters
    ----------
    runup : RigidRunup
        The rigid train. [SI]

    Returns
    -------
    float
        Time. [s]
    """
    if runup.equilibrium is None:
        return 1.5 * float(runup.time[-1]) + 1.0
    if runup.equilibrium <= 0.0:
        return STANDSTILL_TIME
    # up to a speed where the net torque is still clearly positive, then the exponential approach
    i = int(np.flatnonzero(runup.speed <= 0.98 * runup.equilibrium)[-1])
    gap = runup.equilibrium - float(runup.speed[i])
    approach = runup.inertia * gap / float(runup.net[i])
    left = max(math.log(gap / (0.002 * runup.equilibrium)), 0.0)
    return 1.1 * (float(runup.time[i]) + approach * left) + 2.0


def _settled(runup: RigidRunup, trajectory: Trajectory, end: float, synchronous: float) -> bool:
    """Whether a start that did not reach its end speed has come to rest at some speed."""
    speed = _late_speed(trajectory, end)
    if runup.equilibrium is not None:
        if runup.equilibrium <= 0.0:
            if speed < 0.01 * synchronous:
                return True
        elif abs(speed - runup.equilibrium) <= SETTLED * runup.equilibrium:
            return True
    before = _late_speed(trajectory, 0.8 * end)
    gained = (speed - before) / (0.2 * end)
    return gained * 10.0 * end < synchronous - speed and end > STANDSTILL_TIME


def _cut_by_itself(settings: StartSettings, end: float) -> bool:
    """Whether a run ended before MaximumTime (or the longest start simulated) ended it."""
    return end < 0.999 * (settings.maximum_time or LONGEST_START)


def _late_speed(trajectory: Trajectory, end: float) -> float:
    """Mean speed over the last tenth of a run, half a second at most."""
    t, w = trajectory.time, trajectory.mean_speed
    inside = (t >= end - min(0.5, 0.1 * end)) & (t <= end)
    return float(np.mean(w[inside])) if np.any(inside) else float(w[-1])


def outcome_of(
    runup: RigidRunup,
    settings: StartSettings,
    trajectory: Trajectory,
    end: float,
    synchronous: float,
) -> StartOutcome:
    """Name the way a start without field or trip ended, with its numbers.

    Parameters
    ----------
    runup : RigidRunup
        The rigid train. [SI]
    settings : StartSettings
        How it was calculated. [SI]
    trajectory : Trajectory
        The start. [SI]
    end : float
        When it ended. [s]
    synchronous : float
        Synchronous speed of the reference shaft. [rad/s]

    Returns
    -------
    StartOutcome
        Word, numbers and sentence. [mixed]
    """
    speed = settings.end_speed if trajectory.reached else _late_speed(trajectory, end)
    share, rpm = speed / synchronous, speed * 30.0 / math.pi
    if trajectory.reached:
        return StartOutcome(
            "reached", end, speed, f"{share:.1%} speed ({rpm:.1f} rpm) reached after {end:.3f} s."
        )
    if runup.equilibrium is not None and runup.equilibrium <= 0.0 and share < 0.01:
        text = (
            f"No breakaway: at standstill the loads take {runup.load[0]:.4g} N m, the motor gives "
            f"{runup.average[0]:.4g} N m (referred to the motor)."
        )
        return StartOutcome("no breakaway", end, speed, text)
    near = runup.equilibrium and abs(speed - runup.equilibrium) <= SETTLED * runup.equilibrium
    if near or (_cut_by_itself(settings, end) and _settled(runup, trajectory, end, synchronous)):
        # judged by where the speed tends to, quoted as simulated
        tends_to = runup.equilibrium / synchronous if near and runup.equilibrium else share
        word = "asynchronous" if tends_to >= ASYNCHRONOUS_ABOVE else "stalled"
        text = (
            f"{word.capitalize()}: torque and load balance at {rpm:.1f} rpm ({share:.1%} speed), "
            f"below the end speed of {settings.end_speed / synchronous:.1%}."
        )
        return StartOutcome(word, end, speed, text)
    text = f"Time out: {rpm:.1f} rpm ({share:.1%} speed) after {end:.3f} s."
    if math.isfinite(float(runup.time[-1])):
        text += f" As a rigid body the train would need {float(runup.time[-1]):.4g} s."
    return StartOutcome("time out", end, speed, text)


@dataclass(frozen=True, eq=False)
class SingleRun:
    """One simulation of a start at one step, and what is read out of it."""

    trajectory: Trajectory  #: The simulation. [SI]
    end: float  #: When it ended. [s]
    #: Times and torques of all turning points of every output, from rest to the end. [s, N m]
    turning: list[tuple[Floats, Floats]]

    @property
    def parts(self) -> tuple[Trajectory, float, list[tuple[Floats, Floats]]]:
        """Trajectory, end and turning points. [SI]"""
        return self.trajectory, self.end, self.turning

    def without_history(self) -> SingleRun:
        """With the turning points alone: the history is most of the memory.

        Returns
        -------
        SingleRun
            Without torques. [SI]
        """
        none = np.empty((0, 0))
        return replace(self, trajectory=replace(self.trajectory, torque=none, torque_rate=none))


@dataclass(frozen=True, eq=False)
class PreparedStart:
    """A start ready to be simulated at one step or another."""

    model: StartModel  #: The start in arrays. [SI]
    settings: StartSettings  #: How it is to be calculated. [mixed]
    runup: RigidRunup  #: The rigid train. [SI]
    maximum_time: float  #: Time to simulate, and the longest it may be prolonged to. [s]
    longest: float  #: Likewise. [s]
    synchronous: float  #: Synchronous speed of the reference shaft. [rad/s]
    keep_all: bool  #: Whether every sample is kept, however much memory that takes.

    def at(self, step: float) -> SingleRun:
        """Simulate at one step.

        Parameters
        ----------
        step : float
            Largest step. [s]

        Returns
        -------
        SingleRun
            From rest to the end. [SI]
        """
        trajectory = simulate(
            self.model,
            step,
            self.settings.method,
            self.settings.end_speed,
            self.maximum_time,
            keep_all=self.keep_all,
        )
        end = _end_of(trajectory, self.settings.end_speed)
        thin, turning = read_turning(trajectory, end)
        return SingleRun(thin, end, turning)

    def to_its_end(self, step: float) -> tuple[PreparedStart, SingleRun]:
        """Simulate at one step, prolonged until the start has ended or settled.

        Parameters
        ----------
        step : float
            Largest step. [s]

        Returns
        -------
        prepared : PreparedStart
            With the time that was needed. [SI]
        run : SingleRun
            From rest to the end. [SI]
        """
        prepared, run = self, self.at(step)
        for _ in range(MAX_PROLONGATIONS):
            if (
                run.trajectory.reached
                or prepared.maximum_time >= self.longest
                or _settled(self.runup, run.trajectory, run.end, self.synchronous)
            ):
                break
            maximum = min(2.0 * prepared.maximum_time, self.longest)
            prepared = replace(prepared, maximum_time=maximum)
            run = prepared.at(step)
        return prepared, run

    def outcome(self, run: SingleRun) -> StartOutcome:
        """How a simulation ended.

        Parameters
        ----------
        run : SingleRun
            A simulation of this start. [SI]

        Returns
        -------
        StartOutcome
            Word, numbers and sentence. [mixed]
        """
        return outcome_of(self.runup, self.settings, run.trajectory, run.end, self.synchronous)


def prepared_start(
    case: CaseData,
    train: Train,
    modes: Modes,
    damping: ModalDamping,
    effects: StartEffects = PLAIN_START,
) -> PreparedStart:
    """Everything of a start that does not depend on the step.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]
    damping : ModalDamping
        Their damping. [SI]
    effects : StartEffects, optional
        What is simulated; default the plain start. [flags]

    Returns
    -------
    PreparedStart
        Ready to be simulated. [SI]

    Raises
    ------
    ModelError
        If the train cannot turn (a spring holds it to ground) or has no motor.
    """
    if modes.n_rigid == 0:
        raise ModelError("A train held to ground by a spring cannot start; no rigid mode is left.")
    settings = settings_of(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    if not motors:
        raise ModelError("A start needs the torque curve of at least one motor.")
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    runup = rigid_runup(train, motors, loads, settings.end_speed)
    longest = LONGEST_START if settings.maximum_time is None else settings.maximum_time
    tabled = max((float(p.time or 0.0) + 1.0 for p in case.torque_time), default=0.0)
    maximum = longest if effects.full_length else min(max(run_length(runup), tabled), longest)
    model = start_model(
        case, train, modes, damping, motors, loads, settings.tolerance_peak, maximum, effects
    )
    return PreparedStart(model, settings, runup, maximum, longest, synchronous, keeps_history(case))


def run_start(
    case: CaseData,
    train: Train,
    modes: Modes,
    damping: ModalDamping,
    effects: StartEffects = PLAIN_START,
) -> Start:
    """Calculate the start of a case to the accuracy it asks for.

    Clearances, field application and a trip are events, which this loop of equal steps does not
    have; the other effects are simulated as chosen.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]
    damping : ModalDamping
        Their damping. [SI]
    effects : StartEffects, optional
        What is simulated; default the plain start. [flags]

    Returns
    -------
    Start
        Outcome, peaks, histories and error estimates. [SI]

    Raises
    ------
    ModelError
        If the train cannot turn (a spring holds it to ground) or has no motor.
    """
    prepared = prepared_start(case, train, modes, damping, effects)
    settings, model = prepared.settings, prepared.model
    step = min(_first_step(settings, model.pulsation_omega), model.largest_step)
    prepared, coarse = prepared.to_its_end(step)
    coarse, fine = coarse.without_history(), prepared.at(0.5 * step)
    halvings = 0
    while True:
        output = worst_outputs(train, fine.trajectory, fine.turning)
        peaks = element_peaks(train, model.truncation, fine.parts, coarse.parts, output)
        bound = model.truncation[output[output >= 0]]
        error, truncation = relative_errors(peaks, bound)
        met = error <= settings.tolerance_peak
        by_step = error - truncation
        values = fine.trajectory.n_steps * len(model.truncation)
        if (
            met
            or halvings >= MAX_HALVINGS
            or 2 * values > MAX_VALUES
            or by_step < min(0.1 * truncation, settings.tolerance_peak)
        ):
            break
        halvings += 1
        step *= 0.5
        coarse, fine = fine.without_history(), prepared.at(0.5 * step)
    return Start(
        outcome=prepared.outcome(fine),
        peaks=peaks,
        trajectory=fine.trajectory,
        turning_points=tuple(fine.turning[i] for i in output if i >= 0),
        coarse_turning_points=tuple(coarse.turning[i] for i in output if i >= 0),
        output_of_element=output,
        runup=prepared.runup,
        step=0.5 * step,
        halvings=halvings,
        estimated_error=error,
        truncation_error=truncation,
        kept_modes=len(model.stiffness),
        method=settings.method,
        met_tolerance=met,
        uncoupled_dampers=model.uncoupled_dampers,
    )


def relative_errors(peaks: tuple[ElementPeak, ...], truncation: Floats) -> tuple[float, float]:
    """Largest relative error of the peaks, and the part of it that modes left out may cause.

    Parameters
    ----------
    peaks : tuple of ElementPeak
        Peaks. [N m]
    truncation : ndarray, shape (n_peaks,)
        Bound on what modes left out may add to each. [N m]

    Returns
    -------
    error : float
        Largest relative error. [1]
    truncation : float
        Largest relative truncation. [1]
    """
    sizes = np.array([max(abs(p.maximum), abs(p.minimum)) for p in peaks])
    floor = np.maximum(sizes, NEGLIGIBLE * np.max(sizes, initial=0.0))
    floor = np.where(floor > 0.0, floor, np.inf)
    errors = np.array([p.error for p in peaks])
    return (
        float(np.max(errors / floor, initial=0.0)),
        float(np.max(truncation / floor, initial=0.0)),
    )


def element_peaks(
    train: Train,
    truncation: Floats,
    fine: tuple[Trajectory, float, list[tuple[Floats, Floats]]],
    coarse: tuple[Trajectory, float, list[tuple[Floats, Floats]]],
    output: NDArray[np.int64],
    *,
    until_largest: bool = False,
    guard_share: float = 1.0,
    same_until: float = math.inf,
) -> tuple[ElementPeak, ...]:
    """Extremes of every element; the error is the change from h to h/2 plus the truncation.

    That change is about fifteen times the error of the finer run at fourth order, three times at
    second. It is taken over several extremes, and not below a share of the worst element's, so
    that an accidental agreement is not taken for accuracy (tests/numerics/test_error_estimate.py).

    Parameters
    ----------
    train : Train
        The train. [SI]
    truncation : ndarray, shape (n_outputs,)
        Bound on what modes left out may add to each output. [N m]
    fine, coarse : tuple
        Trajectory, end time and turning points at h/2 and at h. [SI]
    output : ndarray of int, shape (n_elements,)
        Output that stands for each element; −1 where there is none. [index]
    until_largest : bool, optional
        True: extremes after the largest do not count for the error (runs with impacts). [flag]
    guard_share : float, optional
        How much of the change of the next smaller extremes is taken for the error of the finer run;
        default all of it, as always of the change of the extremes themselves. [1]
    same_until : float, optional
        Time from which the two runs went different ways: where the largest extreme comes later, all of
        that change is taken. [s]

    Returns
    -------
    tuple of ElementPeak
        One an element. [N m]
    """
    trajectory, _, turning = fine
    judged = [(element, int(i)) for element, i in enumerate(output) if i >= 0]
    size = np.array([float(np.max(np.abs(turning[i][1]))) for _, i in judged])
    change = np.array(
        [
            _difference(turning[i], coarse[2][i], until_largest, guard_share, same_until)
            for _, i in judged
        ]
    )
    floor = np.maximum(size, NEGLIGIBLE * np.max(size, initial=0.0))
    relative = change / np.where(floor > 0.0, floor, 1.0)
    least = max(SHARED_ERROR * float(np.max(relative, initial=0.0)), LEAST_PEAK_ERROR)
    peaks = []
    for (element, i), own, scale in zip(judged, relative, floor, strict=True):
        when, value = turning[i]
        time = float(when[int(np.argmax(np.abs(value)))])
        peaks.append(
            ElementPeak(
                train.elements[element],
                float(value.max()),
                float(value.min()),
                time,
                float(np.interp(time, trajectory.time, trajectory.mean_speed)),
                float(max(own, least) * scale + truncation[i]),
            )
        )
    return tuple(peaks)
