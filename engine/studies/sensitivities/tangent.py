"""Sensitivities of the linear start by its tangent: all inputs in one run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.choices import BelowEndurance
from engine.case.study_inputs import SN_LINE
from engine.fatigue.cycle_counting import counted_history, half_cycle_points
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import ShaftStrength, shaft_strength
from engine.fatigue.sn_curve import SNCurve
from engine.start.start import PreparedStart
from engine.start.start_fatigue import judged_shafts
from engine.studies.nearby_start import LINEAR, NearStart, near_start, near_train
from engine.studies.sensitivities.linear_start import (
    OutputSensitivity,
    tangent_model,
    tangent_torques,
)
from engine.studies.sensitivities.plan import (
    WHOLE,
    DerivativePlan,
    Parameter,
    prepared_nearby_start,
)
from engine.studies.variation import Change, varied_case

#: The tangent's models are so far apart: their arrays are smooth, so only rounding is a limit.
APART = 1e-4


@dataclass(frozen=True, eq=False)
class TangentDerivatives:
    """The same derivatives by the tangent of the start, for every parameter."""

    peak: Floats  #: ∂ln(largest torque)/∂ln p. [1] Shape (n_parameters, n_elements).
    starts: Floats  #: ∂ln(allowable starts)/∂ln p. [1] Shape (n_parameters, n_judged).
    #: What cycles within 1 % of the endurance limit, which come and go, make of the damage. [1]
    #: Shape (n_judged,).
    edge: Floats
    off: float  #: Largest relative difference of a peak torque from that of the step itself. [1]


# --- the tangent ----------------------------------------------------------------------------------


def tangent_of(plan: DerivativePlan) -> TangentDerivatives | None:
    """Derivatives of a linear start by its tangent.

    Parameters
    ----------
    plan : DerivativePlan
        The plan. [mixed]

    Returns
    -------
    TangentDerivatives or None
        None where the start has events, the motor answers to oscillations, or modes exchange places too near. [1]
    """
    case, recipe = plan.case, plan.recipe
    answers = recipe.effects.electrical_damping  # K changes with every mode
    if plan.reason or recipe.start != LINEAR or case.torque_time_from_rest or answers:
        return None
    moving = [p for p in plan.parameters if p[0] != SN_LINE]
    nearby = near_train(case, recipe)
    prepared = prepared_nearby_start(case, recipe)
    apart = []
    for quantity, name in moving:
        ends = []
        for factor in (1.0 - APART, 1.0 + APART):
            other = varied_case(case, [Change(quantity, name, factor)])
            near = near_train(other, recipe)
            ends.append((near.model.modes, prepared_nearby_start(other, recipe).model))
        apart.append((ends[0], ends[1]))
    tangent = tangent_model((nearby.model.train, nearby.model.modes, prepared.model), apart, APART)
    if tangent is None:
        return None
    plain = near_start(case, recipe, nearby)
    outputs = _outputs_of(plan, prepared, plain)
    judged = {i for i, _ in judged_shafts(case)}
    wanted = [(e, None if e in judged else _top(plain, e)) for e in outputs]
    watched = tangent_torques(
        tangent,
        [
            (outputs[e], plain.turning[e][0][slice(i, None if i is None else i + 1)])
            for e, i in wanted
        ],
    )
    return _from_tangent(plan, plain, dict(zip(outputs, watched, strict=True)), moving)


def _top(plain: NearStart, element: int) -> int:
    """Turning point with the largest torque of an element."""
    return int(np.argmax(np.abs(plain.turning[element][1])))


def _outputs_of(plan: DerivativePlan, prepared: PreparedStart, plain: NearStart) -> dict[int, int]:
    """Output that stands for each element: of a subdivided shaft the one with these turning points."""
    run_ = prepared.at(min(plan.recipe.step, prepared.model.largest_step))
    outputs = {}
    for output, element in enumerate(run_.trajectory.output_element.tolist()):
        own = plain.turning.get(element)
        if own is not None and np.array_equal(own[1], run_.turning[output][1]):
            outputs[element] = output
    return outputs


def _from_tangent(
    plan: DerivativePlan,
    plain: NearStart,
    watched: Mapping[int, OutputSensitivity],
    moving: Sequence[Parameter],
) -> TangentDerivatives:
    """Relative derivatives of peaks and starts from those of the turning points."""
    case, n = plan.case, len(plan.case.elements)
    place = [plan.parameters.index(p) for p in moving]
    peak = np.zeros((len(plan.parameters), n))
    off = 0.0
    for element, seen in watched.items():
        top = _top(plain, element)
        value = float(plain.turning[element][1][top])
        at = top if len(seen.torque) > 1 else 0  # others are watched at their peak alone
        if value != 0.0:
            peak[place, element] = seen.derivative[at] / value
            off = max(off, abs(float(seen.torque[at]) / value - 1.0))
    judged = judged_shafts(case)
    starts = np.zeros((len(plan.parameters), len(judged)))
    edge = np.zeros(len(judged))
    for j, (element, row) in enumerate(judged):
        strength = shaft_strength(case, row)
        by_stress, by_line, edge[j] = _damage_slope(
            strength, plain.turning[element][1], watched[element].derivative
        )
        starts[place, j] = -by_stress
        for i, (quantity, name) in enumerate(plan.parameters):
            if quantity == SN_LINE and name == row.material:
                starts[i, j] = by_line
    return TangentDerivatives(peak, starts, edge, off)


def _damage_slope(
    strength: ShaftStrength, torque: Floats, change: Floats
) -> tuple[Floats, float, float]:
    """d ln q by each parameter, d ln(starts) by the S-N line itself, share of the damage at the edge."""
    curve, local = strength.curve, strength.local
    history = counted_history(torque)
    # every counted point is one of the history, or the rest at both ends
    values = np.concatenate([[0.0], torque, [0.0]])
    moved = np.concatenate([np.zeros((1, change.shape[1])), change, np.zeros((1, change.shape[1]))])
    index, at = np.zeros(len(history), dtype=np.int64), 0
    for i, value in enumerate(history):
        while values[at] != value:
            at += 1
        index[i], at = at, at + 1
    first, second, count = half_cycle_points(history)
    span = history[first] - history[second]
    mean = 0.5 * local * (history[first] + history[second])
    amplitude = reversed_amplitude(0.5 * local * np.abs(span), mean, strength.ultimate)
    damage = count / curve.cycles_to_failure(amplitude)
    total = float(damage.sum())
    if total == 0.0:
        return np.zeros(change.shape[1]), 0.0, 0.0
    used = damage > 0.0
    slope = _life_slope(curve, amplitude[used])
    relative = (moved[index[first[used]]] - moved[index[second[used]]]) / span[used][:, None]
    if strength.ultimate is not None:  # d ln of 1 / (1 - |mean| / ultimate)
        both = moved[index[first[used]]] + moved[index[second[used]]]
        left = strength.ultimate - np.abs(mean[used])
        relative += (0.5 * local * np.sign(mean[used]) / left)[:, None] * both
    weight = damage[used] * slope / total
    near = np.abs(amplitude / curve.endurance - 1.0) <= WHOLE
    edge = 0.0  # damage of all that may come or go
    if curve.below_endurance == BelowEndurance.NONE:
        edge = float(count[near].sum()) / curve.knee_cycles / total
    return weight @ relative, float(weight.sum()), edge


def _life_slope(curve: SNCurve, amplitude: Floats) -> Floats:
    """−d ln N/d ln S of the line at each amplitude."""
    small = 1e-7
    low, high = (np.log(curve.cycles_to_failure(amplitude * (1.0 + s))) for s in (0.0, small))
    return np.asarray((low - high) / math.log1p(small))
