"""The start: average and pulsating torque against the loads, from rest to the end speed.

The train is integrated in modal coordinates by the exponential step (or, for comparison, by the
paper's average-acceleration method). The accuracy asked for is that of the answers, peak torques
and starts: the start is calculated at two steps, h and h/2, whose difference is the error
estimate, and the step is halved until it is small enough. Turning points come from the dense
output, a cubic between samples, so a peak between two samples is not missed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from engine.arrays import Floats
from engine.case.choices import Method
from engine.case.data import CaseData
from engine.case.defaults import LONGEST_START
from engine.case.effect import StartEffects
from engine.errors import ModelError
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.motor import motors_of
from engine.model.rigid_runup import RigidRunup, rigid_runup
from engine.start.by_turns import simulated
from engine.start.event_results import (
    BearingForce,
    ContactRecord,
    MachineTorque,
    PullIn,
    Repeatability,
)
from engine.start.outcome import StartOutcome, outcome_of, run_length, start_settled
from engine.start.peaks import ElementPeak, JudgedRun, judge_run, largest_relative_error
from engine.start.settings import PLAIN_START, StartSettings, keeps_history, settings_of
from engine.start.simulation import Simulation
from engine.start.start_model import (
    COARSEST_FIRST,
    FINEST_FIRST,
    MAX_VALUES,
    StartModel,
    start_model,
    usual_step,
)
from engine.start.trajectory import KEPT_VALUES, SingleRun, Turning

#: The same for Newmark: error ≈ this × (phase per step)², second order and far larger.
NEWMARK_ERROR_AT_ONE_RADIAN = 0.4
#: How many times the error falls when the step is halved: fourth and second order.
FALL = {Method.EXPONENTIAL: 16.0, Method.NEWMARK: 4.0}
#: Steps are halved at most so often before the best result is reported with its error.
MAX_HALVINGS = 7
#: A simulation that has neither settled nor ended is prolonged this often to twice its length.
MAX_PROLONGATIONS = 6


@dataclass(frozen=True, eq=False)
class ForceHistories:
    """Forces of teeth and bearings at the samples of a trajectory."""

    teeth: tuple[str, ...]  #: Meshes.
    #: Normal tooth force, positive on the drive flank, negative on the back flank. [N] Shape
    #: (n_meshes, n_times).
    tooth_force: Floats
    bearings: tuple[str, ...]  #: Gears that move laterally.
    #: Magnitude of the radial force, without weight. [N] Shape (n_gears, n_times).
    bearing_force: Floats


@dataclass(frozen=True, eq=False)
class Start(JudgedRun):
    """A complete start: the finest simulation, and what led to it."""

    outcome: StartOutcome  #: How it ended. [mixed]
    #: The rigid-body run-up; None for a response to prescribed torques alone. [SI]
    runup: RigidRunup | None
    step: float  #: Largest step used. [s]
    halvings: int  #: How often the step was halved to meet the tolerance.
    kept_modes: int  #: Modes integrated.
    method: str  #: ``exponential`` or ``newmark``.
    met_tolerance: bool  #: False if halving stopped before the tolerance was met.
    #: Dampers that stayed on each mode for itself although coupling was asked for.
    uncoupled_dampers: tuple[str, ...] = ()
    #: What happened at each clearance that was modelled. [SI]
    contacts: tuple[ContactRecord, ...] = ()
    #: Largest bearing force of each gear that moves laterally. [N]
    bearing_forces: tuple[BearingForce, ...] = ()
    pull_in: PullIn | None = None  #: Field application and what came of it. [SI]
    machines: tuple[MachineTorque, ...] = ()  #: Of motors in time. [SI]
    #: By element, relative error from the pieces of distributed shafts; part of all errors. [1]
    pieces_error: tuple[tuple[str, float], ...] = ()
    #: Where impacts make runs part however fine the step; None where they stay together. [1]
    repeatability: Repeatability | None = None
    #: Bound on the relative change of the answers by what is left out of the simulation: effects with
    #: data that are off. None = no bound is known. [1]
    left_out: float | None = 0.0
    estimate: float = 0.0  #: Part of it that is no bound but an estimate, as data are lacking. [1]
    #: Tooth and bearing forces against time, where they were calculated. [N]
    forces: ForceHistories | None = None
    #: Unwrapped load angle at the samples, the motor lagging positive; None without a field. [rad]
    #: Shape (n_times,).
    load_angle: Floats | None = None
    #: Whether it was stopped after as much work as a start may take: what follows is missing. [flag]
    gave_up: bool = False
    #: Where its peaks are the worst over many phases of the pulsation: the phase of the rest. [rad]
    phase: float | None = None

    @property
    def is_sensitive(self) -> bool:
        """Whether it was found that a tiny change of the input changes its peaks. [flag]"""
        return self.repeatability is not None and self.repeatability.sensitive

    def largest_peak(
        self, speed_ratios: Mapping[str | None, float]
    ) -> tuple[ElementPeak | None, float]:
        """The peak of the element with the largest torque, compared at motor speed.

        Parameters
        ----------
        speed_ratios : mapping of str to float
            Speed of each element over motor speed. [1]

        Returns
        -------
        peak : ElementPeak or None
            Its peak; None without any. [N m]
        torque : float
            Its larger magnitude, referred to motor speed. [N m]
        """
        peak = max(self.peaks, key=lambda p: p.size * speed_ratios[p.element], default=None)
        return peak, 0.0 if peak is None else float(peak.size * speed_ratios[peak.element])

    def turning_of_element(self) -> dict[int, Turning]:
        """Turning points by element index: times and torques. [s, N m]"""
        return self._by_element(self.turning_points)

    def coarse_turning_of_element(self) -> dict[int, Turning]:
        """The same at twice the step. [s, N m]"""
        return self._by_element(self.coarse_turning_points)

    def _by_element(self, turning: tuple[Turning, ...]) -> dict[int, Turning]:
        judged = np.flatnonzero(self.output_of_element >= 0)
        return dict(zip((int(e) for e in judged), turning, strict=True))


def with_left_out(
    start: Start, bound: float | None, tolerance: float, estimate: float = 0.0
) -> Start:
    """A start beside what its simulation leaves out.

    Parameters
    ----------
    start : Start
        A start. [SI]
    bound : float or None
        Bound on the relative change of the answers by effects that are off; None = none is known. [1]
    tolerance : float
        Wanted relative error of peak torques, of error and bound together. [1]
    estimate : float, optional
        Estimated change by what lacks its data. It is left out, too, but no calculation could meet a tolerance with
        it. [1]

    Returns
    -------
    Start
        The tolerance is met only where there is a bound. [SI]
    """
    known = None if bound is None or start.left_out is None else bound + start.left_out
    met = start.met_tolerance and known is not None and start.estimated_error + known <= tolerance
    whole = None if known is None else known + estimate
    peaks = tuple(
        replace(p, left_out=None if whole is None else whole * p.size) for p in start.peaks
    )
    return replace(start, peaks=peaks, left_out=whole, estimate=estimate, met_tolerance=met)


def with_peaks(
    start: Start,
    peaks: tuple[ElementPeak, ...],
    left_out: float | None,
    phase: float,
    tolerance: float,
) -> Start:
    """A start with the peaks of several.

    Parameters
    ----------
    start : Start
        The one whose histories are kept. [SI]
    peaks : tuple of ElementPeak
        In the order of its own. [N m]
    left_out : float or None
        Bound on the change by effects that are off, of all of them; None = none is known. [1]
    phase : float
        Phase of the pulsation of the start itself. [rad]
    tolerance : float
        Wanted relative error of peak torques. [1]

    Returns
    -------
    Start
        With their errors. [SI]
    """
    error = largest_relative_error(peaks)
    met = left_out is not None and error + left_out <= tolerance
    return replace(
        start, peaks=peaks, left_out=left_out, phase=phase, estimated_error=error,
        met_tolerance=start.met_tolerance and met,
    )  # fmt: skip


def _first_step(settings: StartSettings, fastest: float) -> float:
    """Step tried first, from the measured order of the method and the tolerance."""
    if settings.method == Method.NEWMARK:
        angle = math.sqrt(0.5 * settings.tolerance_peak / NEWMARK_ERROR_AT_ONE_RADIAN)
        return min(max(angle, FINEST_FIRST), COARSEST_FIRST) / fastest
    return usual_step(settings.tolerance_peak, fastest)


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
        """Simulate at one step, with histories.

        Parameters
        ----------
        step : float
            Largest step. [s]

        Returns
        -------
        SingleRun
            From rest to the end. [SI]
        """
        return simulated([self.simulation(step, histories=True)])[0]

    def simulation(self, step: float, *, histories: bool = False) -> Simulation:
        """What is simulated at one step.

        Parameters
        ----------
        step : float
            Largest step. [s]
        histories : bool, optional
            False: turning points are all that is wanted. [flag]

        Returns
        -------
        Simulation
            The start, until its end speed or the time to simulate. [SI]
        """
        method, target = self.settings.method, self.settings.end_speed
        kept = (math.inf if self.keep_all else KEPT_VALUES) if histories else 0.0
        return Simulation(self.model, step, method, target, self.maximum_time, kept)

    def to_its_end(self, step: float, *, histories: bool = True) -> tuple[PreparedStart, SingleRun]:
        """Simulate at one step, prolonged until the start has ended or settled.

        Parameters
        ----------
        step : float
            Largest step. [s]
        histories : bool, optional
            False: turning points are all that is wanted. [flag]

        Returns
        -------
        prepared : PreparedStart
            With the time that was needed. [SI]
        run : SingleRun
            From rest to the end. [SI]
        """
        return starts_to_their_ends([(self, step)], histories=histories)[0]

    def prolonged(self, run: SingleRun) -> PreparedStart | None:
        """The start with more time to simulate.

        Parameters
        ----------
        run : SingleRun
            What it is after the present time. [SI]

        Returns
        -------
        PreparedStart or None
            None where it has ended or settled, or no more time is allowed. [SI]
        """
        if (
            run.trajectory.reached
            or self.maximum_time >= self.longest
            or start_settled(self.runup, run.trajectory, run.end, self.synchronous)
        ):
            return None
        return replace(self, maximum_time=min(2.0 * self.maximum_time, self.longest))

    def outcome(self, run: SingleRun) -> StartOutcome:
        """How a simulation of this start ended."""
        return outcome_of(self.runup, self.settings, run.trajectory, run.end, self.synchronous)


def starts_to_their_ends(
    starts: Sequence[tuple[PreparedStart, float]], *, histories: bool = False
) -> list[tuple[PreparedStart, SingleRun]]:
    """Starts simulated each at its step, prolonged until it has ended or settled.

    Those of one form run side by side in the lanes of one loop; each has the same bits alone.

    Parameters
    ----------
    starts : sequence of tuple
        Starts and their largest steps. [SI, s]
    histories : bool, optional
        False: turning points are all that is wanted. [flag]

    Returns
    -------
    list of tuple
        Each with the time that was needed, and from rest to its end. [SI]

    Raises
    ------
    InternalError
        If one diverges.
    """
    ends: dict[int, tuple[PreparedStart, SingleRun]] = {}
    waiting = {i: prepared for i, (prepared, _) in enumerate(starts)}
    for _ in range(MAX_PROLONGATIONS + 1):
        runs = simulated(
            [p.simulation(starts[i][1], histories=histories) for i, p in waiting.items()]
        )
        ends |= zip(waiting, zip(waiting.values(), runs, strict=True), strict=True)
        longer = {i: ends[i][0].prolonged(ends[i][1]) for i in waiting}
        waiting = {i: prepared for i, prepared in longer.items() if prepared is not None}
        if not waiting:
            break
    return [ends[i] for i in range(len(starts))]


def prepared_start(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects = PLAIN_START,
) -> PreparedStart:
    """Everything of a start that does not depend on the step; by default of the plain start.

    Raises `ModelError` if the train cannot turn (a spring holds it to ground) or has no motor.
    """
    train, modes = modal.train, modal.modes
    if case.looks_for_worst_phase:
        raise ModelError(
            "PulsationPhase is worst, but one start has one phase. Type a phase, for example Worst phase of "
            "table StartupPeaks."
        )
    if modes.n_rigid == 0:
        raise ModelError(
            "A train held to ground by a spring cannot start: it has no rigid-body mode. Remove "
            "the spring to ground."
        )
    settings = settings_of(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    if not motors:
        raise ModelError(
            "A start needs the torque curve of at least one motor. Fill table MotorTorque."
        )
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    runup = rigid_runup(train, motors, loads, settings.end_speed)
    longest = LONGEST_START if settings.maximum_time is None else settings.maximum_time
    tabled = max((float(p.time or 0.0) + 1.0 for p in case.torque_time_from_rest), default=0.0)
    maximum = longest if effects.full_length else min(max(run_length(runup), tabled), longest)
    curves = replace(
        effects, motor_transient=False
    )  # fluxes are stepped by the loop with events alone
    model = start_model(case, modal, motors, loads, settings.tolerance_peak, maximum, curves)
    return PreparedStart(model, settings, runup, maximum, longest, synchronous, keeps_history(case))


def run_start(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects = PLAIN_START,
) -> Start:
    """Calculate the start of a case to the accuracy it asks for; by default the plain start.

    Clearances, field application and a trip are events, which this loop of equal steps does not
    have; the other effects are simulated as chosen. Raises `ModelError` if the train cannot turn (a spring
    holds it to ground) or has no motor.
    """
    prepared = prepared_start(case, modal, effects)
    settings, model = prepared.settings, prepared.model
    step = min(_first_step(settings, model.pulsation_omega), model.largest_step)
    prepared, coarse = prepared.to_its_end(step, histories=False)
    fine = prepared.at(0.5 * step)
    fall = FALL[Method(settings.method)]
    halvings, least_change = 0, None
    while True:
        judged = judge_run(modal.train, model.truncation, fine, coarse, least_change=least_change)
        least_change = judged.change / fall
        error, truncation = judged.estimated_error, judged.truncation_error
        met = error <= settings.tolerance_peak
        values = fine.trajectory.n_steps * len(model.truncation)
        if (
            met
            or halvings >= MAX_HALVINGS
            or 2 * values > MAX_VALUES
            or error - truncation < min(0.1 * truncation, settings.tolerance_peak)
        ):
            break
        halvings += 1
        step *= 0.5
        coarse, fine = fine.without_history(), prepared.at(0.5 * step)
    return Start(
        **vars(judged),
        outcome=prepared.outcome(fine),
        runup=prepared.runup,
        step=0.5 * step,
        halvings=halvings,
        kept_modes=len(model.stiffness),
        method=settings.method,
        met_tolerance=met,
        uncoupled_dampers=model.uncoupled_dampers,
    )
