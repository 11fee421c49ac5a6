"""A start in arrays: as few modes as the tolerance allows, forces, dampers and curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.case.data import CaseData
from engine.case.effect import StartEffects
from engine.errors import ModelError
from engine.model.load import Load
from engine.model.modal_train import ModalTrain
from engine.model.modes import Modes
from engine.model.motor import (
    Motor,
    drives_of,
    electrical_arrays,
    through_synchronism,
    without_torque,
)
from engine.model.train import Train
from engine.numerics.same_bits import log, product, sin, singular_values, total
from engine.start.electrical_damping import NO_SWINGS, Swings, swings_of
from engine.start.settings import NEGLIGIBLE, PLAIN_START
from engine.start.time_response import PrescribedTorque, prescribed_torques, torque_tables
from engine.start.torque_outputs import TorqueOutputs, force_reach, torque_outputs

#: Largest and smallest phase of the pulsation per step tried first. [rad]
COARSEST_FIRST, FINEST_FIRST = 2.0, 0.02
#: A ringing mode is followed by steps of at most this phase. [rad]
COARSEST_ANGLE = 1.2
#: Peak error of the exponential start at 1 rad of pulsation phase per step: measured 1e-5 × (phase
#: per step)⁴ (docs/benchmarks.md, the start), taken four times as large. [1]
ERROR_AT_ONE_RADIAN = 4e-5
#: Share of the tolerance that modes left out may take. Their bound is several times what they do, so a larger
#: share would be most of the stated error; another mode costs next to nothing.
DROPPED = 0.01
#: Modes whose ringing decays below this share of the tolerance need no fine steps any more.
FADED = 0.05
#: A mode far above the pulsation that would need more steps than this is not integrated; it
#: follows statically, and its ringing after breaker closing is reported as an error.
MAX_RINGING_STEPS = 500_000
#: Steps in the time a load's station takes through the standstill zone, and how many such times.
BREAKAWAY_POINTS, BREAKAWAY_LENGTH = 6.0, 3.0
#: A transient that dies out faster than the pulsation varies is followed so many time constants.
SHOCK_LENGTH = 12.0
#: "Far above the pulsation": this many times its highest frequency.
FAR_ABOVE = 10.0
#: Most values (steps × outputs) of one simulation that is only meant to refine another.
MAX_VALUES = 10_000_000
#: Share of its peak torque that a motor is at least taken to switch on when modes are judged.
SWITCHED_SHARE = 0.25
#: The step is at most this over the rate of the fastest damper that acts as a force.
DAMPER_STEP = 0.5
#: Dampers that would need a step below this share of the usual one stay on each mode for itself.
FINEST_DAMPER_STEP = 0.05
#: A damper beside a spring is idle where its share of the torque at `FAR_ABOVE` is less. Left on each mode for itself it
#: changes a peak by a fifth of that (train 1465 of the study: 2e-4 at 1e-3). As forces the dampers of rigid links from
#: 1e15 N m/rad on do not converge.
IDLE_DAMPER = 1e-5
#: Largest amplification of a mode when the force of a damper across it is estimated: what sweeping
#: through a resonance leaves of it in practice.
LARGEST_AMPLIFICATION = 20.0
#: A mode sampled once in this phase shows this share of its ringing as error of the dense output.
SAMPLED_ANGLE = 7.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Machines:
    """Torques of motors, loads and tables against time, as arguments of the compiled loop."""

    curves: tuple[Any, ...]  #: Knots, cubics and counts of all curves of torque against speed. [SI]
    motors: tuple[Any, ...]  #: Force, curves, speed, pole pairs and line frequency of each. [SI]
    loads: tuple[Any, ...]  #: Force, curve and speeds of each. [SI]
    timed: tuple[Any, ...]  #: As `torque_tables` gives them. [SI]
    #: Transient, field and connection of each motor, before anything was switched. [SI]
    electrical: tuple[Any, ...]
    phase: Floats  #: Phase of each pulsation at t = 0. [rad] Shape (n_motors,).
    #: Those of a one-way discharge path, which end when the field is applied. [mask] Shape (n_motors,).
    of_discharge: Mask
    #: Curves of average and pulsating torque of each motor before any and after each switch-over; empty: none.
    switched: tuple[tuple[Ints, Ints], ...]
    swings: Swings  #: Motors that answer to small oscillations of each mode. [SI]


@dataclass(frozen=True, eq=False, kw_only=True)
class StartModel(Machines):
    """A start in arrays: kept modes, force stations, curves."""

    #: ω² and damping coefficient of the kept modes. [1/s², 1/s] Shape (n_modes,).
    stiffness: Floats
    rate: Floats  #: Likewise. [1/s², 1/s] Shape (n_modes,).
    reach: Floats  #: Forces to modes. [rad/√(kg m²)] Shape (n_modes, n_forces).
    #: Rigid-body speed of the reference shaft from modal velocities. [√(1/(kg m²))] Shape
    #: (n_modes,).
    mean_speed: Floats
    #: Speed at which the curves of each motor are read, from the velocities of the first modes. [√(1/(kg m²))]
    #: Shape (n_motors, n_read).
    read_speed: Floats
    #: Torque of those motors over the velocity of each mode, against speed. [N m s/√(kg m²)] Shape (n_swings,
    #: n_levels, n_modes).
    swing: Floats
    outputs: TorqueOutputs  #: Element torques. [SI]
    dampers: tuple[Any, ...]  #: Force and coefficient of each, for the compiled loop. [SI]
    pulsation_omega: float  #: Highest pulsation frequency, twice line. [rad/s]
    #: (end time, largest angular frequency to be resolved until then). [s, rad/s]
    windows: tuple[tuple[float, float], ...]
    #: Bound on what the modes left out may add to each output. [N m] Shape (n_outputs,).
    truncation: Floats
    largest_step: float  #: Longest step at which dampers that act as forces are followed. [s]
    keep: Mask  #: Modes that are integrated. [mask] Shape (n_modes,).
    #: Nodes of the first forces: stations, then dampers to ground. [indices]
    force_nodes: Ints
    #: Rows of the remaining forces, dampers across elements. [indices]
    damper_rows: Ints
    #: Dampers so strong for their inertias that following them as forces would need absurdly short
    #: steps: they damp each mode for itself although coupling was asked for.
    uncoupled_dampers: tuple[str, ...] = ()


def start_model(
    case: CaseData,
    modal: ModalTrain,
    motors: tuple[Motor, ...],
    loads: tuple[Load, ...],
    tolerance: float,
    maximum_time: float = 60.0,
    effects: StartEffects = PLAIN_START,
    *,
    events: bool = False,
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
    modal : ModalTrain
        Its train, modes and damping. [SI]
    motors, loads : tuple
        Motors and driven machines. [SI]
    tolerance : float
        Wanted relative error of peak torques; a hundredth of it may go to modes left out. [1]
    maximum_time : float, optional
        Longest simulated time: what following a ringing mode costs. [s]
    effects : StartEffects, optional
        Which electrical transients, dampers and modes count. Field, trip and clearances are events
        of the run; here only the sizes of their torques are taken into account. [flags]
    events : bool, optional
        True: for the loop with events. It solves for the forces of dampers, so none is too strong for
        it; and every mode is kept that can be followed, since no bound is known on what impacts make
        of one left out. [flag]

    Returns
    -------
    StartModel
        Arguments of the compiled loop. [SI]
    """
    train, modes, damping = modal
    torques = prescribed_torques(case, train)
    stations = sorted(
        {m.station for m in motors} | {d.station for d in loads} | {p.station for p in torques}
    )
    column = {s: i for i, s in enumerate(stations)}
    index = np.array(stations, dtype=np.int64)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed
    fastest = 2.0 * line_omega
    shock = _shock(case, effects)
    dampers = _candidate_dampers(train, effects, fastest)
    uncoupled: list[str] = []
    while True:
        forces = np.concatenate([index, dampers.nodes])  # stations first, then dampers to ground
        all_reach = np.concatenate(
            [force_reach(train, modes, forces), modes.row_twist[dampers.rows].T], axis=1
        )
        of_stations = _force_sizes(case, train, motors, loads, torques, column, effects)
        sizes = _with_dampers(of_stations, modal, dampers, all_reach, fastest)
        elastic = torque_outputs(train, modes, forces, dampers=dampers.rows)
        outputs = _outputs(train, elastic, forces, dampers, uncoupled)
        ringing, slow, scale = _mode_amplitudes(modes, outputs, all_reach, sizes, fastest)
        every = effects.fast_modes or events
        keep = _kept_modes(modes, ringing, slow, scale, tolerance, fastest, every)
        keep &= allowed_modes(modes, effects)
        windows = _windows(modal, ringing, scale, keep, tolerance, fastest, maximum_time, effects)
        gains = dampers.viscous * np.sum(all_reach[keep][:, len(index) :] ** 2, axis=0)
        held = _too_strong(dampers, gains, all_reach[keep][:, len(index) :], tolerance, fastest)
        if events or not np.any(held):
            break
        uncoupled += [dampers.names[i] for i in np.flatnonzero(held)]
        dampers = dampers.without(held)
    jump = max((float(p.knots[0]) for p in torques if p.jump), default=0.0)
    own = all_reach[:, len(index) :]
    rate = damping.rate - product(own**2, dampers.viscous)  # those act as forces
    left_out = ~keep & allowed_modes(modes, effects)
    truncation = (ringing + slow)[:, left_out].sum(axis=1)
    reference = modes.shape[train.node_dof[motors[0].station]]
    reference = reference * train.node_scale[motors[0].station]
    mean = np.where(modes.omega == 0.0, reference, 0.0) / train.speed_ratio[motors[0].station]
    if not np.any(mean):
        raise ModelError(
            f"Station '{train.stations[motors[0].station]}' is held to ground by a spring; its "
            "motor cannot start. Remove the spring, or its rows in table MotorTorque."
        )
    machines = machine_arrays(case, motors, loads, torques, stations, effects)
    return StartModel(
        **machines,
        stiffness=np.ascontiguousarray(modes.omega[keep] ** 2),
        rate=np.ascontiguousarray(np.maximum(rate[keep], 0.0)),
        reach=np.ascontiguousarray(all_reach[keep]),
        mean_speed=np.ascontiguousarray(mean[keep]),
        read_speed=read_speed(case, effects, all_reach[keep], machines["motors"][0], modes.n_rigid),
        swing=machines["swings"].torque_over_velocity(modes.omega[keep], all_reach[keep]),
        outputs=_outputs(
            train, elastic.of_modes(keep, modes.omega, all_reach), forces, dampers, uncoupled
        ),
        dampers=(np.arange(len(index), all_reach.shape[1]), dampers.viscous),
        pulsation_omega=fastest,
        windows=_with_breakaway(windows, train, motors, loads, jump, shock, fastest),
        truncation=truncation,
        largest_step=_damper_step(dampers, own, keep),
        keep=keep,
        force_nodes=forces,
        damper_rows=dampers.rows,
        uncoupled_dampers=tuple(uncoupled),
    )


def shifted(model: StartModel, shift: Floats) -> StartModel:
    """The start with other natural frequencies, as an inertia that moves with each mode alone makes them.

    A torque a quarter of the period ahead of the mode's velocity is in phase with its acceleration. Written so it adds
    nothing to the slow twist, as a spring would.

    Parameters
    ----------
    model : StartModel
        The start. [SI]
    shift : ndarray, shape (n_all_modes,)
        What each natural frequency rises by. [rad/s]

    Returns
    -------
    StartModel
        Its modes have unit modal mass again. [SI]
    """
    omega = np.sqrt(model.stiffness)
    share = shift[model.keep] / np.where(omega > 0.0, omega, np.inf)
    scale = np.where(omega > 0.0, 1.0 + share, 1.0)  # 1/√mass
    outputs = model.outputs
    return replace(
        model,
        stiffness=model.stiffness * scale**2,
        rate=model.rate * scale**2,
        reach=np.ascontiguousarray(model.reach * scale[:, None]),
        swing=np.ascontiguousarray(model.swing * scale),
        outputs=replace(
            outputs, position=outputs.position * scale, velocity=outputs.velocity * scale
        ),
    )


def read_speed(
    case: CaseData, effects: StartEffects, reach: Floats, force: Ints, n_rigid: int
) -> Floats:
    """Speed at which the curves of each motor are read, from modal velocities.

    The mean speed of a shaft line is that of its rigid mode: its momentum, referred to the motor's station, over its
    inertia. Elastic modes have no part in it.

    Parameters
    ----------
    case : CaseData
        The case, for `TorqueFollows`. [SI]
    effects : StartEffects
        Where motors answer to vibration, or are in time, their curves are read at the mean speed: of the latter those
        of the line's voltage. [flags]
    reach : ndarray, shape (n_modes, n_forces)
        Forces to modes, the rigid ones first. [rad/√(kg m²)]
    force : ndarray of int, shape (n_motors,)
        Force of each motor. [indices]
    n_rigid : int
        Rigid modes. [count]

    Returns
    -------
    ndarray, shape (n_motors, n_read)
        Of the modes on which it depends. [√(1/(kg m²))]
    """
    in_time = effects.electrical_damping or effects.motor_transient
    mean = in_time or not case.reads_own_speed
    return np.ascontiguousarray(reach.T[force, : n_rigid if mean else len(reach)])


def machine_arrays(
    case: CaseData,
    motors: Sequence[Motor],
    loads: Sequence[Load],
    torques: Sequence[PrescribedTorque],
    stations: Sequence[int],
    effects: StartEffects = PLAIN_START,
) -> dict[str, Any]:
    """Fields of `Machines` by name; `stations` names the station of each force.

    The case says what happens at breaker closing, field application and trip, the effects which of it
    counts.
    """
    column = {station: i for i, station in enumerate(stations)}
    whole = motors

    def drives(share: float | None = None) -> tuple[Motor, ...]:
        connected = [m if share is None else m.above(share) for m in whole]
        return drives_of(
            list(map(without_torque, connected)) if effects.motor_transient else connected
        )

    motors = drives()
    n = len(motors)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed if motors else 0.0
    curves = [curve for m in motors for curve in (m.average, m.pulsating)]
    with_field = np.arange(0, 2 * n, 2)
    if effects.pull_in:
        with_field = np.arange(2 * n, 3 * n)
        curves += [through_synchronism(m.average) for m in motors]
    of_loads = np.arange(len(curves), len(curves) + len(loads))
    curves += [d.torque for d in loads]
    switched = []
    shares = [until for m in whole for until, _ in m.stages if until < math.inf]
    for share in (0.0, *sorted(set(shares))) if shares else ():
        first = len(curves)
        curves += [c for m in drives(share) for c in (m.average, m.pulsating)]
        switched.append(
            (np.arange(first, first + 2 * n, 2), np.arange(first + 1, first + 2 * n, 2))
        )
    if effects.motor_transient:
        curves += [m.line_voltage for m in whole if m.line_voltage is not None]
    longest = max((len(c.knots) for c in curves), default=1)
    knots = np.zeros((len(curves), longest))
    cubics = np.zeros((len(curves), longest, 4))
    for i, c in enumerate(curves):
        knots[i, : len(c.knots)] = c.knots
        cubics[i, : len(c.knots)] = c.cubic
    return {
        "curves": (knots, cubics, np.array([len(c.knots) for c in curves], dtype=np.int64)),
        "motors": (
            np.array([column[m.station] for m in motors], dtype=np.int64),
            np.arange(0, 2 * n, 2),
            np.arange(1, 1 + 2 * n, 2),
            np.array([m.synchronous_speed for m in motors]),
            # the loop turns a phase by twice the slip of line and rotor
            np.array([0.5 * m.multiple * m.pole_pairs for m in motors]),
            np.array([0.5 * m.multiple * line_omega for m in motors]),
            with_field,
        ),
        "loads": (
            np.array([column[d.station] for d in loads], dtype=np.int64),
            of_loads,
            np.array([d.synchronous_speed for d in loads]),
            np.array([d.soft_speed for d in loads]),
        ),
        "timed": torque_tables(torques, stations),
        "electrical": electrical_arrays(motors, case, effects),
        "phase": np.array([m.phase for m in motors]),
        "of_discharge": np.array([m.multiple == 1 for m in motors], dtype=np.bool_),
        "switched": tuple(switched),
        "swings": swings_of(case, motors, column)
        if effects.electrical_damping and not effects.motor_transient
        else NO_SWINGS,
    }


@dataclass(frozen=True, eq=False)
class _Dampers:
    """Dampers that act as forces: those at nodes, to ground, then those of rows."""

    nodes: Ints
    rows: Ints
    viscous: Floats  # of both [N m s/rad]
    needed: Mask  # not to be given back to the modes: there is no spring beside it
    names: tuple[str, ...]

    def without(self, held: Mask) -> _Dampers:
        """All but those held."""
        n = len(self.nodes)
        return _Dampers(
            self.nodes[~held[:n]],
            self.rows[~held[n:]],
            self.viscous[~held],
            self.needed[~held],
            tuple(name for name, out in zip(self.names, held, strict=True) if not out),
        )


def _candidate_dampers(train: Train, effects: StartEffects, fastest: float) -> _Dampers:
    """Dampers without a spring; where coupling is asked for all dampers."""
    loose = (train.stiffness == 0.0) & (train.viscous > 0.0)
    rows, nodes = np.flatnonzero(loose), np.zeros(0, dtype=np.int64)
    if effects.coupled_damping:
        idle = FAR_ABOVE * fastest * train.viscous < IDLE_DAMPER * train.stiffness
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
) -> Mask:
    """Dampers that would need absurdly short steps: as few as possible, the strongest first."""
    held = np.zeros(len(gains), dtype=np.bool_)
    most = DAMPER_STEP / (FINEST_DAMPER_STEP * usual_step(tolerance, fastest))
    for i in np.argsort(-gains, kind="stable"):
        if dampers.needed[i]:
            continue
        # the sum bounds the rate of all together; where it is not good enough, the exact norm
        explicit = ~held & ~dampers.needed
        if (
            gains[explicit].sum() <= most
            or _joint_rate(reach[:, explicit], dampers.viscous[explicit]) <= most
        ):
            break
        held[i] = True
    return held


def _joint_rate(reach: Floats, viscous: Floats) -> float:
    """Largest rate at which dampers together slow any motion: the norm of R diag(c) Rᵀ. [1/s]"""
    if not len(viscous):
        return 0.0
    return float(np.max(np.square(singular_values(reach * np.sqrt(viscous))), initial=0.0))


def _damper_step(dampers: _Dampers, reach: Floats, keep: Mask) -> float:
    """Longest step at which the dampers are followed. [s]"""
    loose = dampers.viscous * np.sum(reach**2, axis=0) * dampers.needed
    rate = float(np.max(loose, initial=0.0))
    if not np.all(dampers.needed):
        rate = max(rate, _joint_rate(reach[keep], dampers.viscous))
    return DAMPER_STEP / max(rate, 1e-300)


def _outputs(
    train: Train,
    outputs: TorqueOutputs,
    forces: Ints,
    dampers: _Dampers,
    uncoupled: Sequence[str],
) -> TorqueOutputs:
    """Element torques; a rigid mesh also feels the dampers that act as forces on its To side.

    Those without a spring are in the torque of their row already. A damper too strong to be coupled
    acts on every mode for itself; its torque between its own ends is then not c times their speed.
    """
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
        drawn = product(train.node_incidence[dampers.rows][:, nodes], ratio)
        sprung = ~dampers.needed[len(dampers.nodes) :]
        force[output, first:] -= train.orientation[mesh.element] * np.where(sprung, drawn, 0.0)
    return replace(outputs, force=force)


def usual_step(tolerance: float, fastest: float) -> float:
    """Step that the pulsation asks for.

    Parameters
    ----------
    tolerance : float
        Wanted relative error of peak torques. [1]
    fastest : float
        Highest pulsation frequency. [rad/s]

    Returns
    -------
    float
        Step. [s]
    """
    angle = math.sqrt(math.sqrt(0.5 * tolerance / ERROR_AT_ONE_RADIAN))
    return min(max(angle, FINEST_FIRST), COARSEST_FIRST) / fastest


@dataclass(frozen=True)
class _Shock:
    """The transient at breaker closing."""

    amplitude: float  # at full voltage
    rate: float


def _shock(case: CaseData, effects: StartEffects) -> _Shock | None:
    """Transient at breaker closing, if it is simulated and stated."""
    if not (effects.breaker_closing and case.shock_amplitude and case.shock_time_constant):
        return None
    return _Shock(abs(case.shock_amplitude), 1.0 / case.shock_time_constant)


@dataclass(frozen=True, eq=False)
class _ForceSizes:
    """How large each force is: what modes are judged by."""

    step: Floats  # switched on at once
    ramp: Floats  # sum of all changes of slope [N m/s]
    smooth: Floats  # largest value of what varies no faster than the pulsation
    carried: Floats  # what the scale of the outputs is judged by
    slope: Floats  # what it changes with the speed of its station, as that vibrates [N m s/rad]
    range: Floats  # and the most by which it can


def _force_sizes(
    case: CaseData,
    train: Train,
    motors: tuple[Motor, ...],
    loads: tuple[Load, ...],
    torques: Sequence[PrescribedTorque],
    column: dict[int, int],
    effects: StartEffects,
) -> tuple[_ForceSizes, float]:
    """Sizes of the forces at stations, and the sum of the driving ones at the reference shaft."""
    n = len(column)
    step, ramp, smooth, slope, span = (np.zeros(n) for _ in range(5))
    reference_torque = 0.0
    shock = _shock(case, effects)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed
    full_pull_out = (case.pull_out_torque or 0.0) if effects.pull_in else 0.0
    for m in motors:
        i, pull_out = column[m.station], float(m.torque_factor(1.0)) * full_pull_out
        largest = float(np.max(np.abs(m.average.cubic[:, 0])))
        pulsating = m.largest_pulsation
        initial = float(m.average(0.0))
        for curve, phase in (*m.pulsations, *m.pulsations_at(1)):
            initial += float(curve(0.0)) * sin(phase)
        switched = effects.aborted_start or bool(m.stages)
        switched_off = largest + pulsating + pull_out if switched else 0.0
        step[i] += max(abs(initial), SWITCHED_SHARE * largest, switched_off)
        smooth[i] += pulsating
        for curve in m.curves:
            slope[i] += curve.steepest / m.synchronous_speed
            span[i] += curve.range
        if shock is not None:  # begins with the slope of A sin ωt, then varies no faster than that
            amplitude = float(m.torque_factor(0.0)) * shock.amplitude
            ramp[i] += amplitude * line_omega
            smooth[i] += amplitude
        if pull_out:
            if case.field_time_constant:
                ramp[i] += pull_out / case.field_time_constant
            else:
                step[i] += pull_out
            smooth[i] += pull_out
        reference_torque += (largest + pulsating) * float(train.speed_ratio[m.station])
    for d in loads:
        i = column[d.station]
        step[i] += float(d.torque(0.0))
        slope[i] += d.torque.steepest / d.synchronous_speed
        span[i] += d.torque.range
    for p in torques:
        i = column[p.station]
        step[i] += p.jump
        ramp[i] += p.ramp
        smooth[i] += float(np.max(np.abs(p.samples)))
        reference_torque += smooth[i] * float(train.speed_ratio[p.station])
    carried = np.maximum(step, SWITCHED_SHARE * smooth)
    return _ForceSizes(step, ramp, smooth, carried, slope, span), reference_torque


def _with_dampers(
    of_stations: tuple[_ForceSizes, float],
    modal: ModalTrain,
    dampers: _Dampers,
    reach: Floats,
    fastest: float,
) -> _ForceSizes:
    """Sizes of all forces, those of the dampers last.

    A damper without a spring carries the whole torque. Any other has its coefficient times the
    speed across it: of the vibration its modes may reach, and to ground that of the shaft itself.
    It loads no element by more than those forces do, so it has no part in the scale. Curves of torque
    against speed act as dampers to ground on a station that vibrates.
    """
    train, modes, damping = modal
    sizes, reference_torque = of_stations
    n = len(sizes.step)
    drive = product(np.abs(reach[:, :n]), sizes.step + sizes.smooth)
    safe = np.where(modes.omega > 0.0, modes.omega, np.inf)
    excess = 1.0 / np.maximum(2.0 * damping.ratio, 1.0 / LARGEST_AMPLIFICATION)
    vibration = np.where(safe <= fastest, np.maximum(excess, 1.0), fastest / safe) * drive / safe
    smooth = dampers.viscous * product(np.abs(reach[:, n:]).T, vibration)
    ramp = dampers.viscous * np.abs(product(reach[:, n:].T, product(reach[:, :n], sizes.step)))
    carried = np.zeros(len(smooth))
    grounded = len(dampers.nodes)
    follows = np.minimum(sizes.slope * product(np.abs(reach[:, :n]).T, vibration), sizes.range)
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
        np.concatenate([sizes.smooth + follows, smooth]),
        np.concatenate([sizes.carried, carried]),
        sizes.slope,
        sizes.range,
    )


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
    ringing = flexible * (
        product(np.abs(reach), sizes.step) + product(np.abs(reach), sizes.ramp) / safe
    )
    share = (fastest / safe) ** 2
    dynamic = np.where(share < 0.9, share / np.where(share < 0.9, 1.0 - share, 1.0), 1.0)
    slow = flexible * product(np.abs(reach), sizes.smooth) * dynamic
    torque = sizes.carried
    signed = product(outputs.position / safe**2, reach * torque)
    scale = np.max(np.abs(signed + outputs.force * torque), axis=1, initial=0.0)
    return ringing, slow, np.maximum(scale, NEGLIGIBLE * np.max(scale, initial=0.0))


def allowed_modes(modes: Modes, effects: StartEffects) -> Mask:
    """Modes that may be integrated: the lowest, as many as the effects allow.

    Parameters
    ----------
    modes : Modes
        Modes of the train. [SI]
    effects : StartEffects
        What is simulated. [flags]

    Returns
    -------
    ndarray of bool, shape (n_modes,)
        All of them where the effects set no limit. What the others change is not estimated. [mask]
    """
    most = modes.n_modes if effects.most_modes is None else effects.most_modes
    return np.asarray(np.arange(modes.n_modes) < most)


def _kept_modes(
    modes: Modes, ringing: Floats, slow: Floats, scale: Floats, tolerance: float, fastest: float,
    every: bool,
) -> Mask:  # fmt: skip
    """Drop modes from the top while their bound stays below a share of the tolerance; or keep all."""
    keep = np.ones(modes.n_modes, dtype=np.bool_)
    if every:
        return keep
    budget = DROPPED * tolerance * scale
    used = np.zeros(len(scale))
    for r in range(modes.n_modes - 1, -1, -1):
        used = used + ringing[:, r] + slow[:, r]
        if modes.omega[r] < 1.5 * fastest or np.any(used > budget):
            break
        keep[r] = False
    return keep


def _windows(
    modal: ModalTrain, ringing: Floats, scale: Floats,
    keep: Mask, tolerance: float, fastest: float, maximum_time: float,
    effects: StartEffects,
) -> tuple[tuple[float, float], ...]:  # fmt: skip
    """Until when each kept fast mode rings visibly after breaker closing.

    Modes that would take an absurd number of steps (a link of 1e16 N m/rad without damping) are
    taken out of `keep`, whatever was chosen. Where all modes were asked for there are some that
    ring by next to nothing but so fast that the cubic between two samples would exaggerate it.
    """
    modes, damping = modal.modes, modal.damping
    windows: list[tuple[float, float]] = []
    usual = usual_step(tolerance, fastest)
    budget = min(MAX_RINGING_STEPS, MAX_VALUES // max(len(scale), 1))
    known = scale > 0.0
    sizes = np.max(ringing[known] / scale[known, None], axis=0, initial=0.0).tolist()
    for r in np.flatnonzero(keep & (modes.omega > fastest))[::-1].tolist():
        size = sizes[r]
        if effects.fast_modes:
            size *= max(1.0, modes.omega[r] * usual / SAMPLED_ANGLE)
        if size <= FADED * tolerance:
            continue
        decay = 0.5 * damping.rate[r]
        until = log(size / (FADED * tolerance)) / decay if decay > 0.0 else math.inf
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
    inertia = float(product(train.inertia, train.dof_ratio**2))
    torque = total(float(m.average(0.0)) * float(train.speed_ratio[m.station]) for m in motors)
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
    merged: list[tuple[float, float]] = []
    for until, omega in sorted(windows, key=lambda w: -w[1]):
        if not merged or until > merged[-1][0]:
            merged.append((until, omega))
    return tuple(merged)
