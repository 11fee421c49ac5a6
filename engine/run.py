"""The conductor: a case in, complete results out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from engine.case import CaseData, ElementRow, case_digest
from engine.crossings import Crossing, start_crossings
from engine.excitation import excitations_of
from engine.fatigue import (
    RESIDUES,
    AllowableStarts,
    ShaftFatigue,
    allowable_starts,
    shaft_fatigue,
    shear_stress,
    sn_curve_for,
)
from engine.margins import interference, judge, separation_margins
from engine.modal import (
    ModalDamping,
    Modes,
    damped_eigenvalues,
    modal_damping,
    natural_modes,
    nodes_of,
)
from engine.motor import motors_of
from engine.plausibility import implausible
from engine.prescribed import run_prescribed
from engine.results import Results
from engine.startup import Start, has_start, run_start
from engine.steady_state import steady_state
from engine.train import Train
from engine.validation import GEAR_MESH
from engine.verdicts import verdicts_of

__all__ = ["run"]

#: Coupling of modes by dampers above which a warning is due. [1]
NOTABLE_COUPLING = 0.02
#: A first mode below this frequency, and a start longer than this, look like a wrong unit. [Hz, s]
LOW_FREQUENCY, LONG_START = 1.0, 60.0
#: How often the start is repeated at half the step where the starts are not accurate enough.
MAX_STARTS_REFINEMENTS = 3
#: Accuracy of allowable starts where the case leaves it blank. [1]
DEFAULT_TOLERANCE_STARTS = 0.02
#: Largest cycles compared between two steps to estimate the error of turning points.
COMPARED_CYCLES = 50


def run(case: CaseData, on_stage: Callable[[str], None] | None = None) -> Results:
    """Calculate everything a case calls for.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    on_stage : callable, optional
        Called with the name of each analysis as it begins. [name]

    Returns
    -------
    Results
        Complete and frozen. [SI]

    Raises
    ------
    ModelError
        If the train as a whole cannot be calculated; the sentence says why.
    """
    spent: list[tuple[str, float]] = []

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        if on_stage is not None:
            on_stage(name)
        began = time.perf_counter()
        yield
        spent.append((name, time.perf_counter() - began))

    with stage("natural frequencies"):
        found = natural_modes(case)
        train, modes = found.train, found.modes
        damping = modal_damping(case, train, modes)
    with stage("separation margins"):
        excitations = excitations_of(case, train)
        margins = separation_margins(case, train, modes, excitations)
        diagram = interference(case, train, modes, excitations)
    with stage("steady state"):
        steady = steady_state(case, train, modes, damping, excitations, margins)
        margins = judge(margins, steady.rows)
    start: Start | None = None
    starts: AllowableStarts | None = None
    crossings: tuple[Crossing, ...] = ()
    errors: tuple[tuple[str, float | None], ...] = ()
    if has_start(case) or case.torque_time:
        with stage("start"):
            start = _start(case, train, modes, damping)
        with stage("fatigue"):
            start, starts, errors = _fatigue(case, train, modes, damping, start)
        crossings = _crossings(case, train, modes, damping, start)
    return Results(
        case=case,
        case_sha256=case_digest(case),
        train=train,
        modes=modes,
        nodes=nodes_of(train, modes),
        segments=found.segments,
        frequency_error=found.frequency_error,
        damping=damping,
        eigenvalues=damped_eigenvalues(train, modes) if damping.neglected > 0.0 else None,
        excitations=excitations,
        margins=margins,
        interference=diagram,
        steady=steady,
        start=start,
        crossings=crossings,
        starts=starts,
        starts_error=errors,
        verdicts=verdicts_of(case, margins, steady, start, starts),
        warnings=tuple(
            dict.fromkeys(
                [
                    *implausible(case),
                    *margins.warnings,
                    *steady.warnings,
                    *_warnings(case, train, modes, damping, start, starts),
                ]
            )
        ),
        spent=tuple(spent),
    )


def _start(case: CaseData, train: Train, modes: Modes, damping: ModalDamping) -> Start:
    if has_start(case):
        return run_start(case, train, modes, damping)
    return run_prescribed(case, train, modes, damping)


def _judged_shafts(case: CaseData) -> list[tuple[int, ElementRow]]:
    """Elements whose fatigue can be judged: diameter, material and S-N points."""
    with_points = {p.material for p in case.sn_points}
    return [
        (i, e)
        for i, e in enumerate(case.elements)
        if e.stress_diameter and e.material in with_points
    ]


def _fatigue(
    case: CaseData, train: Train, modes: Modes, damping: ModalDamping, start: Start
) -> tuple[Start, AllowableStarts | None, tuple[tuple[str, float | None], ...]]:
    """Starts of every judged shaft; the start is refined until they are accurate enough."""
    judged = _judged_shafts(case)
    if not judged:
        return start, None, ()
    tolerance = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    for refinement in range(MAX_STARTS_REFINEMENTS + 1):
        shafts, errors = [], []
        for index, element in judged:
            shaft, error = _shaft(case, element, start, index)
            shafts.append(shaft)
            errors.append((shaft.element, error))
        worst = max((e for _, e in errors if e is not None), default=0.0)
        if worst <= tolerance or refinement == MAX_STARTS_REFINEMENTS or start.runup is None:
            break
        tighter = replace(case, tolerance_peak=max(start.estimated_error / 16.0, 1e-9))
        finer = run_start(tighter, train, modes, damping)
        if finer.step >= start.step:
            break
        start = finer
    return start, allowable_starts(shafts, case.starts_factor), tuple(errors)


def _shaft(
    case: CaseData, element: ElementRow, start: Start, index: int
) -> tuple[ShaftFatigue, float | None]:
    """Fatigue of one shaft, and the relative error of its starts from the two steps."""
    material = next(m for m in case.materials if m.material == element.material)
    points = [p for p in case.sn_points if p.material == element.material]
    curve = sn_curve_for(material, points)
    residue = case.rainflow_residue or RESIDUES[0]
    order = [int(i) for i in np.flatnonzero(start.output_of_element >= 0)]
    place = order.index(index)
    peak = next(p for p in start.peaks if p.element == element.element)
    fine, coarse = start.turning_points[place][1], start.coarse_turning_points[place][1]
    error = max(peak.error, _cycle_difference(fine, coarse))
    shaft = shaft_fatigue(element, fine, curve, material, residue, error)
    if shaft.damage == 0.0:
        return shaft, None
    other = shaft_fatigue(element, coarse, curve, material, residue, always_count=True)
    return shaft, abs(other.damage / shaft.damage - 1.0)


def _cycle_difference(fine: np.ndarray, coarse: np.ndarray) -> float:
    """Largest change of a turning point between two steps, over the largest ranges. [N m]"""
    a = np.sort(np.abs(np.diff(fine)))[::-1][:COMPARED_CYCLES]
    b = np.sort(np.abs(np.diff(coarse)))[::-1][:COMPARED_CYCLES]
    n = min(len(a), len(b))
    return float(np.max(np.abs(a[:n] - b[:n]), initial=0.0))


def _crossings(
    case: CaseData, train: Train, modes: Modes, damping: ModalDamping, start: Start
) -> tuple[Crossing, ...]:
    ratings = case.ratings
    if start.runup is None or not ratings.line_frequency or not ratings.synchronous_speed:
        return ()
    stress = [
        float(shear_stress(1.0, e.stress_diameter, e.stress_bore or 0.0))
        if e.stress_diameter
        else None
        for e in case.elements
    ]
    meshes = [i for i, e in enumerate(case.elements) if e.kind == GEAR_MESH]
    return start_crossings(
        train,
        modes,
        damping,
        start,
        ratings.line_frequency,
        ratings.synchronous_speed,
        stress,
        meshes,
    )


def _unstable_feedback(
    case: CaseData, train: Train, modes: Modes, damping: ModalDamping
) -> Iterator[str]:
    """A torque that rises with speed feeds a mode faster than its damping takes energy away."""
    for motor in motors_of(case, train):
        rise = float(np.max(motor.average.cubic[:, 1])) / motor.synchronous_speed
        dof, scale = train.node_dof[motor.station], train.node_scale[motor.station]
        fed = rise * (modes.shape[dof] * scale) ** 2
        grown = np.flatnonzero((fed > damping.rate) & (modes.omega > 0.0))
        if len(grown):
            mode = int(grown[0])
            yield (
                f"The average torque of '{train.stations[motor.station]}' rises with speed faster "
                f"than the damping of mode {mode - modes.n_rigid + 1} "
                f"({modes.frequency[mode]:.4g} Hz) takes out: with torque following every "
                "oscillation of the rotor that mode may grow by itself. Check its damping ratio."
            )


def _warnings(
    case: CaseData,
    train: Train,
    modes: Modes,
    damping: ModalDamping,
    start: Start | None,
    starts: AllowableStarts | None,
) -> Iterator[str]:
    """What a reader must know beside the numbers."""
    first = modes.elastic_frequency[:1]
    if len(first) and first[0] < LOW_FREQUENCY:
        yield (
            f"The first torsional mode at {first[0]:.3g} Hz is unusually low. Check the units of "
            "stiffnesses and inertias."
        )
    n_elastic = modes.n_modes - modes.n_rigid
    for row in case.mode_damping:
        if row.mode is not None and row.mode > n_elastic:
            yield f"ModeDamping names mode {row.mode}, but the train has {n_elastic} elastic modes."
    if damping.coupling > NOTABLE_COUPLING:
        i, j = damping.neglected_modes
        yield (
            f"Damping couples modes {i - modes.n_rigid + 1} and {j - modes.n_rigid + 1} "
            f"(off-diagonal {damping.neglected:.3g} 1/s, coupling {damping.coupling:.2g}); the "
            "start is calculated with modal damping only."
        )
    if start is None:
        yield "No motor torque curve and no prescribed torque: no start was calculated."
        return
    if start.outcome.time > LONG_START and start.runup is not None:
        yield (
            f"The start takes {start.outcome.time:.0f} s; most take less than {LONG_START:.0f} s. "
            "Check inertias and torques."
        )
    yield from _unstable_feedback(case, train, modes, damping)
    counted = {e.element for _, e in _judged_shafts(case)}
    for e in case.elements:
        if e.stress_diameter and e.material and e.element not in counted:
            yield (
                f"'{e.element}' has a stress diameter, but its material '{e.material}' has no S-N "
                "points: its starts were not counted."
            )
    if not start.met_tolerance:
        yield (
            f"The wanted accuracy of peak torques was not met: estimated error "
            f"{start.estimated_error:.2g} at a step of {start.step:.3g} s."
        )
    if starts is None:
        yield "No shaft has stress diameter, material and S-N points: no starts were counted."
        return
    for shaft in starts.shafts:
        yield from shaft.notes
    if math.isfinite(case.starts_factor or 1.0) and (case.starts_factor or 1.0) != 1.0:
        yield f"Allowable starts are divided by StartsFactor {case.starts_factor:g} when judged."
