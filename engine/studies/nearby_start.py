"""Trains near to one that was planned: many of them, each as cheap as its answers allow.

Scatter and derivatives ask for thousands of starts of trains that differ a little from one that was
calculated in full. Nothing is decided anew for them: segments of shafts, plan, step and modes wanted
are those of the nominal run (a `NearbyStartPlan`). A linear start is simulated once, at the coarser of the two
steps of the nominal run, so its step error is the error that the nominal run states; a start with events
is calculated as in the nominal run, with its own refinement.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from engine.arrays import Floats
from engine.case.choices import RainflowResidue
from engine.case.data import CaseData
from engine.case.defaults import NOTABLE_REVERSAL
from engine.case.effect import StartEffects
from engine.errors import InternalError, ModelError
from engine.fatigue.cycle_counting import count_cycles, counted_history
from engine.fatigue.damage import miner_damage
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import shaft_strength
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.build_train import build_train
from engine.model.excitation import excitations_of, operating_range
from engine.model.links import has_clearance
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of_trains
from engine.model.train import Train
from engine.operation.margins import nearest_frequency
from engine.results.results import Results
from engine.run import calculate_start
from engine.start.outcome import StartOutcome
from engine.start.peaks import sections_of
from engine.start.settings import has_start
from engine.start.start import PreparedStart, Start, prepared_start, starts_to_their_ends
from engine.start.start_fatigue import COUNTED_STARTS, DAMAGE_SHARE, judged_shafts
from engine.start.trajectory import SingleRun

Turning = tuple[Floats, Floats]
Answer = TypeVar("Answer")

#: How the start of a near train is calculated.
LINEAR, PLANNED, NO_START = "linear", "planned", "none"
#: Modes up to this share of twice the line frequency (or of the highest excitation) are wanted.
WANTED_REACH = 1.5
#: At least and at most so many elastic modes are wanted.
FEWEST_MODES, MOST_MODES = 3, 12


@dataclass(frozen=True)
class FixedDiscretisation:
    """What even the length of steps depends on, fixed so that small differences can be taken."""

    #: Until when which frequencies are followed by finer steps. [s, rad/s]
    windows: tuple[tuple[float, float], ...]
    keep: tuple[bool, ...]  #: Modes that are integrated. [mask]
    maximum_time: float  #: Time to simulate. [s]


@dataclass(frozen=True)
class NearbyStartPlan:
    """What the nominal run has decided for all trains near to its own."""

    segments: tuple[tuple[str, int], ...]  #: Segments of each shaft that has inertia of its own.
    lateral: bool  #: Whether the reported modes include gears on their bearings.
    #: ``linear``, ``planned`` (events, prescribed torques or strong dampers) or ``none``.
    start: str
    start_lateral: bool  #: Whether gears move laterally in the start.
    effects: StartEffects  #: What the start simulates.
    step: float  #: Step of a linear start. [s]
    step_error: float  #: Its relative error of peak torques, from the nominal run. [1]
    starts_error: float | None  #: Its relative error of the starts, likewise; None = no starts. [1]
    always_count: bool  #: Whether cycles are counted even below the endurance limit.
    n_modes: int  #: Elastic modes whose frequencies are wanted.
    #: Mode and excitation of each margin that is wanted. [count, name]
    margins: tuple[tuple[int, str], ...]
    gaps: tuple[str, ...]  #: Elements with a clearance that the plan does not simulate.
    #: What is fixed for small differences; None = each start decides for itself. [mixed]
    held: FixedDiscretisation | None = None


@dataclass(frozen=True, eq=False)
class NearTrain:
    """Modes and margins of a train near to the planned one."""

    model: ModalTrain  #: Train, modes and damping that are reported. [SI]
    frequency: Floats  #: Wanted elastic frequencies. [Hz] Shape (n_modes,).
    margin: Floats  #: Wanted margins, in the order of `NearbyStartPlan.margins`. [1] Shape (n_margins,).


@dataclass(frozen=True, eq=False)
class NearStart:
    """A start of a train near to the planned one."""

    outcome: StartOutcome  #: How it ended. [mixed]
    #: Extremes of the torque of each element; 0 where it has none. [N m] Shape (n_elements,).
    maximum: Floats
    minimum: Floats  #: Likewise. [N m] Shape (n_elements,).
    damage: Floats  #: Miner sum of each judged shaft; 0 = none. [1] Shape (n_judged,).
    turning: Mapping[int, Turning]  #: Turning points of each element by its index. [s, N m]
    reversed: tuple[
        str, ...
    ]  #: Elements of `NearbyStartPlan.gaps` whose torque reverses all the same.
    sensitive: bool = False  #: Whether a tiny change of the input was found to change its peaks.

    @property
    def largest(self) -> Floats:
        """Largest magnitude of the torque of each element, shape (n_elements,). [N m]"""
        return np.asarray(np.maximum(np.abs(self.maximum), np.abs(self.minimum)))

    @property
    def counted(self) -> bool:
        """Whether the start came to an end after which its damage counts. [flag]"""
        return self.outcome.outcome in COUNTED_STARTS

    @property
    def starts(self) -> Floats:
        """Allowable starts of each judged shaft, infinite where unlimited, shape (n_judged,). [1]"""
        safe = np.where(self.damage > 0.0, self.damage, 1.0)
        return np.asarray(np.where(self.damage > 0.0, 1.0 / safe, math.inf))


def unit_stress(case: CaseData) -> Floats:
    """Nominal shear stress of each element at unit torque; 0 without a stress diameter.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    ndarray, shape (n_elements,)
        Stress over torque. [Pa/(N m)]
    """
    return np.array([stress_of_unit_torque(e) if e.stress_diameter else 0.0 for e in case.elements])


def recipe_of(case: CaseData, results: Results) -> NearbyStartPlan:
    """What a nominal run has decided for all trains near to its own.

    Parameters
    ----------
    case : CaseData
        The case of that run. [SI]
    results : Results
        The run. [SI]

    Returns
    -------
    NearbyStartPlan
        How near trains are calculated. [mixed]
    """
    plan, start = results.plans[-1], results.start
    n_modes = _wanted_modes(case, results)
    kind = NO_START
    if start is not None:
        whole = plan.events or bool(start.uncoupled_dampers) or not has_start(case)
        kind = PLANNED if whole else LINEAR
    # at twice the step the whole change between the two is the error
    errors = [e / DAMAGE_SHARE for _, e in results.starts_error if e is not None]
    meshes = {m.element: m for m in case.meshes}
    gaps = tuple(
        str(e.element)
        for e in case.elements
        if has_clearance(meshes.get(e.element)) and e.element not in plan.effects.clearances
    )
    return NearbyStartPlan(
        segments=results.segments,
        lateral=bool(results.train.bodies),
        start=kind,
        start_lateral=plan.lateral,
        effects=plan.effects,
        step=0.0 if start is None else 2.0 * start.step,
        step_error=0.0 if start is None else start.estimated_error,
        starts_error=max(errors, default=None),
        always_count=plan.decision("cycle counting").choice == "on",
        n_modes=n_modes,
        margins=tuple((r.mode, r.excitation) for r in results.margins.rows if r.mode <= n_modes),
        gaps=gaps,
    )


def _wanted_modes(case: CaseData, results: Results) -> int:
    """Elastic modes that a start or an excitation can reach."""
    line = case.ratings.line_frequency
    highest = max(
        [2.0 * line if line else 0.0, *(r.excitation_frequency for r in results.margins.rows)]
    )
    elastic = results.modes.elastic_frequency
    reached = int(np.sum(elastic <= WANTED_REACH * highest))
    return min(len(elastic), MOST_MODES, max(FEWEST_MODES, reached))


def calculated(answer: Answer | ModelError) -> Answer:
    """One of the answers for several trains, if there is one.

    Parameters
    ----------
    answer : any or ModelError
        The answer, or why there is none. [SI]

    Returns
    -------
    any
        The answer. [SI]

    Raises
    ------
    ModelError
        If there is none.
    """
    if isinstance(answer, ModelError):
        raise answer
    return answer


def near_train(case: CaseData, recipe: NearbyStartPlan) -> NearTrain:
    """Modes and margins of a train near to the planned one.

    Parameters
    ----------
    case : CaseData
        The case, changed. [SI]
    recipe : NearbyStartPlan
        What the nominal run decided. [mixed]

    Returns
    -------
    NearTrain
        With an unchanged case the numbers of the nominal run, bit for bit. [SI]

    Raises
    ------
    ModelError
        If it is no train.
    """
    return calculated(near_trains([case], recipe)[0])


def near_trains(cases: Sequence[CaseData], recipe: NearbyStartPlan) -> list[NearTrain | ModelError]:
    """Modes and margins of trains near to the planned one; the modes are calculated together.

    Parameters
    ----------
    cases : sequence of CaseData
        The cases, changed. [SI]
    recipe : NearbyStartPlan
        What the nominal run decided. [mixed]

    Returns
    -------
    list of NearTrain or ModelError
        Of each what `near_train` gives; or why it is no train. [SI]
    """
    answers: list[NearTrain | ModelError] = []
    for case, model in zip(cases, _models(cases, recipe, recipe.lateral), strict=True):
        answers.append(model if isinstance(model, ModelError) else _near_train(case, recipe, model))
    return answers


def _near_train(case: CaseData, recipe: NearbyStartPlan, model: ModalTrain) -> NearTrain:
    excitations = {x.name: x for x in excitations_of(case, model.train)}
    speeds, elastic = operating_range(case), model.modes.elastic_frequency
    margins = np.zeros(len(recipe.margins))
    for i, (mode, name) in enumerate(recipe.margins):
        frequency = float(elastic[mode - 1])
        nearest = nearest_frequency(excitations[name], frequency, speeds)
        margins[i] = abs(frequency - nearest) / nearest
    return NearTrain(model, elastic[: recipe.n_modes], margins)


def _models(
    cases: Sequence[CaseData], recipe: NearbyStartPlan, lateral: bool
) -> list[ModalTrain | ModelError]:
    """Trains with their modes and damping, or why one is no train."""
    trains = [_train(case, recipe, lateral) for case in cases]
    modes = iter(modes_of_trains([train for train in trains if isinstance(train, Train)]))
    return [
        ModalTrain.of(case, train, next(modes)) if isinstance(train, Train) else train
        for case, train in zip(cases, trains, strict=True)
    ]


def _train(case: CaseData, recipe: NearbyStartPlan, lateral: bool) -> Train | ModelError:
    try:
        return build_train(case, dict(recipe.segments), lateral=lateral)
    except ModelError as error:
        return error


def near_start(
    case: CaseData, recipe: NearbyStartPlan, near: NearTrain, refined: float = 1.0
) -> NearStart:
    """The start of a train near to the planned one.

    Parameters
    ----------
    case : CaseData
        The case, changed. [SI]
    recipe : NearbyStartPlan
        What the nominal run decided; its start is not ``none``. [mixed]
    near : NearTrain
        Its modes. [SI]
    refined : float, optional
        Share of the usual step that a linear start takes. [1]

    Returns
    -------
    NearStart
        Peaks, damage and turning points. [SI]

    Raises
    ------
    ModelError
        If the changed train cannot start.
    """
    return calculated(near_starts(recipe, [(case, near, refined)])[0])


def near_starts(
    recipe: NearbyStartPlan, trains: Sequence[tuple[CaseData, NearTrain | ModelError, float]]
) -> list[NearStart | ModelError]:
    """Starts of trains near to the planned one; linear ones run side by side in the lanes of one loop.

    Parameters
    ----------
    recipe : NearbyStartPlan
        What the nominal run decided; its start is not ``none``. [mixed]
    trains : sequence of tuple
        Case, modes (or why it is no train), and share of the usual step that a linear start takes. [SI, SI, 1]

    Returns
    -------
    list of NearStart or ModelError
        Of each what `near_start` gives; or why it cannot start. [SI]
    """
    answers: dict[int, NearStart | ModelError] = {}
    prepared: dict[int, tuple[CaseData, ModalTrain, PreparedStart, float]] = {}
    for i, (stated, near, refined) in enumerate(trains):
        case = CaseData(**vars(stated) | {"keep_history": None})
        try:
            model = calculated(near).model
            if recipe.start_lateral != bool(model.train.bodies):
                model = calculated(_models([case], recipe, recipe.start_lateral)[0])
            if recipe.start == LINEAR:
                start = _prepared(case, recipe, model)
                step = refined * min(recipe.step, start.model.largest_step)
                prepared[i] = case, model, start, step
            else:
                answers[i] = _planned_start(case, recipe, model)
        except ModelError as error:
            answers[i] = error
    ends = starts_to_their_ends([(start, step) for *_, start, step in prepared.values()])
    for (i, (case, model, *_)), (start, run) in zip(prepared.items(), ends, strict=True):
        try:
            answers[i] = read_start(case, recipe, model, start.outcome(run), run)
        except ModelError as error:
            answers[i] = error
    return [answers[i] for i in range(len(trains))]


def _prepared(case: CaseData, recipe: NearbyStartPlan, model: ModalTrain) -> PreparedStart:
    """A linear start ready to be simulated."""
    prepared = prepared_start(case, model, recipe.effects)
    return prepared if recipe.held is None else _held(prepared, recipe.held)


def _planned_start(case: CaseData, recipe: NearbyStartPlan, model: ModalTrain) -> NearStart:
    """A start calculated like the nominal one."""
    if recipe.start != PLANNED:
        raise InternalError("a start was requested, but the nominal run has none")
    effects = recipe.effects
    start = calculate_start(case, model, replace(effects, clearances=()), None)
    if effects.need_events or recipe.start_lateral:
        start = calculate_start(case, model, effects, start)
    return read_start(case, recipe, model, start.outcome, start)


def _held(prepared: PreparedStart, held: FixedDiscretisation) -> PreparedStart:
    """The same start with its steps fixed."""
    if tuple(prepared.model.keep.tolist()) != held.keep:
        raise ModelError(
            "The set of significant modes changes with the small input change, so two starts "
            "cannot be differenced."
        )
    return replace(
        prepared,
        model=replace(prepared.model, windows=held.windows),
        maximum_time=held.maximum_time,
        longest=held.maximum_time,
    )


def read_start(
    case: CaseData,
    recipe: NearbyStartPlan,
    model: ModalTrain,
    outcome: StartOutcome,
    run: SingleRun | Start,
) -> NearStart:
    """Peaks, reversals and damage of a start.

    Parameters
    ----------
    case : CaseData
        Its case. [SI]
    recipe : NearbyStartPlan
        What the nominal run decided. [mixed]
    model : ModalTrain
        The train it was calculated with. [SI]
    outcome : StartOutcome
        How it ended. [mixed]
    run : SingleRun or Start
        The start. [SI]

    Returns
    -------
    NearStart
        Peaks, damage and turning points. [SI]
    """
    names = [str(e.element) for e in case.elements]
    maximum, minimum = np.zeros(len(names)), np.zeros(len(names))
    if isinstance(run, Start):
        turning = run.turning_of_element()
        for peak in run.peaks:
            e = names.index(peak.element)
            maximum[e], minimum[e] = peak.maximum, peak.minimum
    else:
        sections = sections_of(run)
        turning = {e: run.turning[widest] for e, (_, _, widest) in sections.items()}
        for e, (high, low, _) in sections.items():
            maximum[e], minimum[e] = run.extremes[0, high], run.extremes[1, low]
    reversed_ = tuple(
        name
        for name, high, low in zip(names, maximum, minimum, strict=True)
        if name in recipe.gaps and low < -NOTABLE_REVERSAL * max(high, -low)
    )
    damage = [
        max(_damage(case, recipe, i, torque) for torque in _histories(run, i, turning[i][1]))
        for i, _ in judged_shafts(case)
    ]
    sensitive = isinstance(run, Start) and run.is_sensitive
    return NearStart(outcome, maximum, minimum, np.array(damage), turning, reversed_, sensitive)


def _histories(run: SingleRun | Start, element: int, worst: Floats) -> list[Floats]:
    """Torques at the turning points of each section of an element. [N m]"""
    if isinstance(run, Start):
        return [fine[1] for fine, _ in run.sections.get(element, ())] or [worst]
    return [run.turning[i][1] for i in np.flatnonzero(run.trajectory.output_element == element)]


def _damage(case: CaseData, recipe: NearbyStartPlan, index: int, torque: Floats) -> float:
    """Miner sum of one shaft, as `engine.fatigue.allowable_starts.shaft_fatigue` counts it."""
    element = case.elements[index]
    strength = shaft_strength(case, element)
    curve, local = strength.curve, strength.local
    history = counted_history(torque)
    if (
        not recipe.always_count
        and strength.ultimate is None
        and curve.below_endurance == "none"
        and 0.5 * local * float(np.ptp(history)) <= curve.endurance
    ):
        return 0.0
    cycles = count_cycles(history, case.rainflow_residue or RainflowResidue.HALF_CYCLES)
    amplitude = reversed_amplitude(local * cycles.amplitude, local * cycles.mean, strength.ultimate)
    return miner_damage(amplitude, cycles.count, curve)
