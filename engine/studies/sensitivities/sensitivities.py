"""How frequencies, peak torques and allowable starts follow each quantity of a case.

Frequencies: from the energies of the modes (`engine.model.frequency_derivatives`).

Starts: every quantity is changed by ± 0.02 % and ± 0.01 %, one at a time, all steps of the calculation
held fast. Richardson's extrapolation of the two central differences is the derivative, the difference
of the two its error. What ± 1 % really does is told beside it: a peak depends on the phase in which
the pulsation meets a mode, which a change of inertia or torque turns by more than a whole cycle per
cent, so a derivative may hold for a small part of that only. A linear start is differentiated a second, independent way, by its tangent
(`engine.studies.sensitivities.linear_start`), and the two are compared. The allowable starts follow from the turning points:
d ln q = Σ (n/N) k d ln S / q over the counted cycles, with the slope k of the S-N line at each.

Derivatives are relative: ∂ln(answer)/∂ln(quantity), the change in per cent for each per cent. A start
that is sensitive has no derivative and is not judged.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.case.choices import BelowEndurance
from engine.case.data import CaseData, case_digest
from engine.errors import ModelError
from engine.fatigue.cycle_counting import counted_history, half_cycle_points
from engine.fatigue.sn_curve import SNCurve
from engine.fatigue.stress import shear_stress
from engine.model.frequency_derivatives import FrequencyDerivatives, frequency_derivatives
from engine.results.results import Results
from engine.run import run
from engine.start.start import PreparedStart, prepared_start
from engine.start.start_fatigue import is_counted, judged_shafts, sn_curve_of
from engine.studies.nearby_start import (
    LINEAR,
    NO_START,
    Held,
    NearStart,
    Recipe,
    near_start,
    near_train,
    recipe_of,
    unit_stress,
)
from engine.studies.sensitivities.linear_start import Watched, tangent_model, tangent_torques
from engine.studies.variation import (
    INERTIA,
    SCATTERED,
    SN_LINE,
    STIFFNESS,
    Change,
    changed,
    names_with,
)

__all__ = [
    "DerivativePlan",
    "DerivativeRow",
    "DerivativeUnit",
    "Derivatives",
    "Differences",
    "derivative_rows",
    "derivative_units",
    "derivatives",
    "differences",
    "element_rows",
    "frequency_rows",
    "gather_derivatives",
    "plan_derivatives",
    "tangent_of",
]

Floats = NDArray[np.float64]
Parameter = tuple[str, str]

#: Changes of a quantity of which the derivative is taken, in proportion: the wide pair, the narrow
#: one. They are small, because the phase in which the pulsation meets a mode turns by some hundred
#: times as many radians.
WIDE, NARROW = 2e-4, 1e-4
#: The change whose effect is told beside the derivative, since a peak may swing within it. [1]
WHOLE = 0.01
#: The tangent's models are so far apart: their arrays are smooth, so only rounding is a limit.
APART = 1e-4
#: The two ways agree if they differ by at most this share of the largest derivative of the answer,
#: beside the error of the differences. The differences carry the step's error in the phase, about
#: 2 % on the paper's sample; the tangent fulfils the homogeneity of torques to 1e-7 there.
AGREED = 0.03
#: A derivative whose error, or whose deviation at ± 1 %, exceeds this share of it (and `AGREED` of
#: the largest) is noted.
DOUBTFUL = 0.1
#: A deviation at ± 1 % smaller than this is not worth a note. [1]
SEEN = 1e-3
#: Modes whose derivatives are listed at least, where the train has so many. [count]
LISTED_MODES = 10
#: Words of the column Method.
ENERGIES = "energies"
BY_DIFFERENCES = "differences"
BOTH = "differences, checked by tangent"


@dataclass(frozen=True, eq=False)
class DerivativePlan:
    """What will be differentiated."""

    case: CaseData  #: The case. [SI]
    nominal: Results  #: Its plain run. [SI]
    recipe: Recipe  #: How changed trains are calculated. [mixed]
    parameters: tuple[Parameter, ...]  #: Quantity and name of each.
    reason: str  #: Why no start is differentiated; empty where one is.

    @property
    def n_starts(self) -> int:
        """Starts that will be calculated. [count]"""
        return 0 if self.reason else 7 * len(self.parameters) + 1


@dataclass(frozen=True)
class DerivativeUnit:
    """One parameter to be differentiated by."""

    case: CaseData  #: The case. [SI]
    recipe: Recipe  #: How changed trains are calculated. [mixed]
    index: int  #: Place in the plan.
    parameter: Parameter  #: Quantity and name.


@dataclass(frozen=True, eq=False)
class Differences:
    """Derivatives with respect to one parameter by differences of whole starts."""

    index: int  #: Place in the plan.
    #: ∂ln(largest torque)/∂ln p of each element, and its error. [1] Shape (n_elements,).
    peak: Floats
    peak_error: Floats  #: Likewise. [1] Shape (n_elements,).
    #: ∂ln(allowable starts)/∂ln p of each judged shaft; 0 where they are unlimited. [1] Shape
    #: (n_judged,).
    starts: Floats
    starts_error: Floats  #: Likewise. [1] Shape (n_judged,).
    #: ln of the largest torque at − 1 % and + 1 %, over the stated one. [1] Shape (2, n_elements).
    peak_ends: Floats
    starts_ends: Floats  #: ln of the starts there, over the stated one. [1] Shape (2, n_judged).
    trouble: str = ""  #: Why there is none; else empty.


@dataclass(frozen=True, eq=False)
class TangentDerivatives:
    """The same derivatives by the tangent of the start, for every parameter."""

    peak: Floats  #: ∂ln(largest torque)/∂ln p. [1] Shape (n_parameters, n_elements).
    starts: Floats  #: ∂ln(allowable starts)/∂ln p. [1] Shape (n_parameters, n_judged).
    #: What cycles within 1 % of the endurance limit, which come and go, make of the damage. [1]
    #: Shape (n_judged,).
    edge: Floats
    off: float  #: Largest relative difference of a peak torque from that of the step itself. [1]


@dataclass(frozen=True)
class DerivativeRow:
    """What one quantity does."""

    quantity: str  #: Quantity, and whose.
    of: str  #: Likewise.
    frequency: tuple[float, ...]  #: ∂ln f/∂ln of it, elastic mode by mode. [1]
    peak: float | None  #: ∂ln(peak stress of the governing element); None = not judged. [1]
    peak_error: float | None  #: Its error. [1]
    #: ∂ln(allowable starts of the governing shaft); None = unlimited or not judged. [1]
    starts: float | None
    starts_error: float | None  #: Its error. [1]
    #: Relative change of either answer at − 1 % and at + 1 %. [1]
    peak_ends: tuple[float, float] | None
    starts_ends: tuple[float, float] | None  #: Likewise. [1]
    method: str  #: ``energies``, ``differences`` or ``differences, checked by tangent``.
    note: str  #: What must be known of this row.


@dataclass(frozen=True, eq=False)
class Derivatives:
    """How the answers of a case follow its quantities."""

    case_sha256: str  #: Of the case. [hash]
    frequencies: tuple[float, ...]  #: Elastic frequencies that are differentiated. [Hz]
    energies: FrequencyDerivatives  #: Derivatives of all frequencies. [1]
    rows: tuple[DerivativeRow, ...]  #: The quantity that matters most first. [1]
    governing: str | None  #: Element whose peak, and shaft whose starts, the rows tell.
    peak: float | None  #: Largest torque of that element. [N m]
    starts: float | None  #: Its allowable starts; None = unlimited or not judged. [1]
    parameters: tuple[Parameter, ...]  #: In the order of the arrays below.
    elements: tuple[str, ...]  #: Likewise.
    shafts: tuple[str, ...]  #: Likewise.
    #: ∂ln(largest torque)/∂ln p of every element, and errors. [1] Shape (n_parameters,
    #: n_elements).
    peaks: Floats
    peak_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_elements).
    #: ∂ln(starts)/∂ln p of every judged shaft, and errors. [1] Shape (n_parameters, n_shafts).
    all_starts: Floats
    starts_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_shafts).
    tangent: TangentDerivatives | None  #: The second way; None where there is none. [1]
    #: Largest difference of the two ways over the largest derivative of the answer. [1]
    largest_difference: float | None
    sentences: tuple[str, ...]  #: What a reader must know.


# --- the plan -------------------------------------------------------------------------------------


def plan_derivatives(case: CaseData, *, nominal: Results | None = None) -> DerivativePlan:
    """What of a case can be differentiated, and how its changed trains are calculated.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    nominal : Results, optional
        Its plain run; calculated if not at hand. [SI]

    Returns
    -------
    DerivativePlan
        Every quantity of the case that has a number. [mixed]

    Raises
    ------
    ModelError
        If the train cannot be calculated.
    """
    nominal = nominal or run(case)
    recipe = recipe_of(case, nominal)
    if recipe.start == LINEAR:
        assert nominal.start is not None
        prepared, _ = _prepared(case, recipe).to_its_end(nominal.start.step)
        held = Held(
            prepared.model.windows, tuple(prepared.model.keep.tolist()), prepared.maximum_time
        )
        # half the step of the plain run: derivatives carry its error in the phase many times over
        recipe = replace(recipe, step=0.5 * nominal.start.step, held=held)
    parameters = tuple((q, name) for q in SCATTERED for name in names_with(case, q))
    return DerivativePlan(case, nominal, recipe, parameters, _why_no_start(nominal, recipe))


def _prepared(case: CaseData, recipe: Recipe) -> PreparedStart:
    model = near_train(case, recipe).model
    return prepared_start(case, model.train, model.modes, model.damping, recipe.effects)


def _why_no_start(nominal: Results, recipe: Recipe) -> str:
    if recipe.start == NO_START or nominal.start is None:
        return (
            "No motor torque curve and no prescribed torque: frequencies alone are differentiated."
        )
    if nominal.start.is_sensitive:
        return (
            "The start is sensitive: a change of its input by 1e-9 changes its peaks, so they have no "
            "derivative. They are not judged; frequencies are."
        )
    if not is_counted(nominal.start):
        return (
            f"The start ended as '{nominal.start.outcome.outcome}': its peaks are not those of a "
            "whole start and are not differentiated."
        )
    return ""


def derivative_units(plan: DerivativePlan) -> tuple[DerivativeUnit, ...]:
    """The work in pieces, one a parameter.

    Parameters
    ----------
    plan : DerivativePlan
        The plan. [mixed]

    Returns
    -------
    tuple of DerivativeUnit
        Empty where no start is differentiated. [mixed]
    """
    if plan.reason:
        return ()
    return tuple(
        DerivativeUnit(plan.case, plan.recipe, i, p) for i, p in enumerate(plan.parameters)
    )


# --- differences ----------------------------------------------------------------------------------


def differences(unit: DerivativeUnit) -> Differences:
    """Derivatives with respect to one parameter by central differences of whole starts.

    Parameters
    ----------
    unit : DerivativeUnit
        Which parameter. [names]

    Returns
    -------
    Differences
        Derivatives with their errors. [1]
    """
    n, judged = len(unit.case.elements), len(judged_shafts(unit.case))
    quantity, name = unit.parameter
    found = []
    try:
        for share in (-WHOLE, -WIDE, -NARROW, 0.0, NARROW, WIDE, WHOLE):
            case = changed(unit.case, [Change(quantity, name, 1.0 + share)])
            found.append(near_start(case, unit.recipe, near_train(case, unit.recipe)))
    except ModelError as wrong:
        e, j = np.zeros((2, n)), np.zeros((2, judged))
        return Differences(unit.index, e[0], e[1], j[0], j[1], e, j, str(wrong))
    trouble = ""
    if not all(s.counted for s in found):
        trouble = "A start with this quantity changed by 1 % does not come to its end."
    elif any(s.sensitive for s in found):
        trouble = "A start with this quantity changed by 1 % is sensitive."
    peak = np.array([_log(s.largest) for s in found])
    starts = np.array([_log(s.damage, -1.0) for s in found])
    return Differences(
        unit.index,
        *_extrapolated(peak),
        *_extrapolated(starts),
        peak[[0, -1]] - peak[3],
        starts[[0, -1]] - starts[3],
        trouble,
    )


def _log(values: Floats, power: float = 1.0) -> Floats:
    """Logarithm of a power; 0 where there is nothing."""
    return power * np.log(np.where(values > 0.0, values, 1.0))


def _extrapolated(found: Floats) -> tuple[Floats, Floats]:
    """Richardson's derivative from two central differences, and their difference."""
    _, low_wide, low, _, high, high_wide, _ = found
    wide = (high_wide - low_wide) / (math.log1p(WIDE) - math.log1p(-WIDE))
    narrow = (high - low) / (math.log1p(NARROW) - math.log1p(-NARROW))
    return narrow + (narrow - wide) / 3.0, np.abs(narrow - wide)


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
        None where the start has events, or modes exchange places too near. [1]
    """
    case, recipe = plan.case, plan.recipe
    if plan.reason or recipe.start != LINEAR or case.torque_time:
        return None
    moving = [p for p in plan.parameters if p[0] != SN_LINE]
    here = near_train(case, recipe)
    prepared = _prepared(case, recipe)
    apart = []
    for quantity, name in moving:
        ends = []
        for factor in (1.0 - APART, 1.0 + APART):
            other = changed(case, [Change(quantity, name, factor)])
            near = near_train(other, recipe)
            ends.append((near.model.modes, _prepared(other, recipe).model))
        apart.append((ends[0], ends[1]))
    tangent = tangent_model((here.model.train, here.model.modes, prepared.model), apart, APART)
    if tangent is None:
        return None
    plain = near_start(case, recipe, here)
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
    found = {}
    for output, element in enumerate(run_.trajectory.output_element.tolist()):
        own = plain.turning.get(element)
        if own is not None and np.array_equal(own[1], run_.turning[output][1]):
            found[element] = output
    return found


def _from_tangent(
    plan: DerivativePlan,
    plain: NearStart,
    watched: Mapping[int, Watched],
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
        curve = sn_curve_of(case, row.material)
        local = (row.scf or 1.0) * float(
            shear_stress(1.0, row.stress_diameter or 0.0, row.stress_bore or 0.0)
        )
        by_stress, by_line, edge[j] = _damage_slope(
            curve, local, plain.turning[element][1], watched[element].derivative
        )
        starts[place, j] = -by_stress
        for i, (quantity, name) in enumerate(plan.parameters):
            if quantity == SN_LINE and name == row.material:
                starts[i, j] = by_line
    return TangentDerivatives(peak, starts, edge, off)


def _damage_slope(
    curve: SNCurve, local: float, torque: Floats, change: Floats
) -> tuple[Floats, float, float]:
    """d ln q by each parameter, d ln(starts) by the S-N line itself, share of the damage at the edge."""
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
    amplitude = 0.5 * local * np.abs(span)
    damage = count / curve.cycles_to_failure(amplitude)
    total = float(damage.sum())
    if total == 0.0:
        return np.zeros(change.shape[1]), 0.0, 0.0
    used = damage > 0.0
    slope = _life_slope(curve, amplitude[used])
    relative = (moved[index[first[used]]] - moved[index[second[used]]]) / span[used][:, None]
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


# --- together -------------------------------------------------------------------------------------


def gather_derivatives(
    plan: DerivativePlan, found: Sequence[Differences], tangent: TangentDerivatives | None
) -> Derivatives:
    """The whole result from whatever parameters were differentiated.

    Parameters
    ----------
    plan : DerivativePlan
        The plan. [mixed]
    found : sequence of Differences
        In any order. [1]
    tangent : TangentDerivatives or None
        The second way. [1]

    Returns
    -------
    Derivatives
        Rows and arrays. [1]
    """
    case, nominal = plan.case, plan.nominal
    energies = frequency_derivatives(case, nominal.train, nominal.modes)
    by_index = {d.index: d for d in found}
    judged = judged_shafts(case)
    shape = len(plan.parameters), len(case.elements)
    peaks, peak_errors = np.zeros(shape), np.zeros(shape)
    starts, starts_errors = (np.zeros((shape[0], len(judged))) for _ in range(2))
    for i, d in by_index.items():
        peaks[i], peak_errors[i] = d.peak, d.peak_error
        starts[i], starts_errors[i] = d.starts, d.starts_error
    element, shaft = _governing(plan)
    rows = _Rows(
        plan, energies, by_index, tangent, element, shaft, peaks, peak_errors, starts, starts_errors
    )
    made = sorted(rows.all(), key=lambda r: -_weight(r))
    worst = rows.largest_difference()
    peak = None
    if element is not None and nominal.start is not None:
        name = case.elements[element].element
        peak = max(
            max(abs(p.maximum), abs(p.minimum)) for p in nominal.start.peaks if p.element == name
        )
    limit = None
    if shaft is not None and nominal.starts is not None:
        limit = nominal.starts.shafts[shaft].allowable_starts
    return Derivatives(
        case_digest(case),
        tuple(nominal.modes.elastic_frequency[: plan.recipe.n_modes].tolist()),
        energies,
        tuple(made),
        None if element is None else str(case.elements[element].element),
        peak,
        limit,
        plan.parameters,
        tuple(str(e.element) for e in case.elements),
        tuple(str(e.element) for _, e in judged),
        peaks,
        peak_errors,
        starts,
        starts_errors,
        tangent,
        worst,
        tuple(_sentences(plan, energies, tangent, worst, rows)),
    )


def _weight(row: DerivativeRow) -> float:
    """What rows are sorted by: what ± 1 % does to the starts, else to the peak, else frequencies."""
    ends = row.starts_ends or row.peak_ends
    if ends is not None:
        return max(abs(e) for e in ends) + 1e3
    return max((abs(f) for f in row.frequency), default=0.0)


def _governing(plan: DerivativePlan) -> tuple[int | None, int | None]:
    """Element whose peak is told, and its place among the judged shafts."""
    nominal, case = plan.nominal, plan.case
    if plan.reason or nominal.start is None:
        return None, None
    judged = [i for i, _ in judged_shafts(case)]
    names = [str(e.element) for e in case.elements]
    if nominal.starts is not None and nominal.starts.governing in names:
        element = names.index(str(nominal.starts.governing))
        return element, judged.index(element)
    largest = {p.element: max(abs(p.maximum), abs(p.minimum)) for p in nominal.start.peaks}
    unit = unit_stress(case)
    weight = unit if np.any(unit) else np.ones(len(unit))
    element = int(np.argmax([w * largest.get(n, 0.0) for w, n in zip(weight, names, strict=True)]))
    return element, judged.index(element) if element in judged else None


@dataclass(frozen=True, eq=False)
class _Rows:
    """Everything rows are made from."""

    plan: DerivativePlan
    energies: FrequencyDerivatives
    found: Mapping[int, Differences]
    tangent: TangentDerivatives | None
    element: int | None
    shaft: int | None
    peaks: Floats
    peak_errors: Floats
    starts: Floats
    starts_errors: Floats

    def all(self) -> Iterator[DerivativeRow]:
        n_modes = self.plan.recipe.n_modes
        still = (0.0,) * n_modes
        done = set()
        for i, (quantity, name) in enumerate(self.plan.parameters):
            own = self.energies.of(quantity, name)
            frequency = still if own is None else tuple(own[:n_modes].tolist())
            done.add((quantity, name))
            yield self._row(i, quantity, name, frequency)
        for r in self.energies.rows:
            if (r.quantity, r.name) not in done:
                yield DerivativeRow(
                    r.quantity, r.name, tuple(r.value[:n_modes].tolist()), None, None, None, None,
                    None, None, ENERGIES, "",
                )  # fmt: skip

    def _row(self, i: int, quantity: str, name: str, frequency: tuple[float, ...]) -> DerivativeRow:
        d = self.found.get(i)
        if d is None or self.element is None or d.trouble:
            return DerivativeRow(
                quantity, name, frequency, None, None, None, None, None, None,
                ENERGIES if quantity in (STIFFNESS, INERTIA) else "",
                "" if d is None else d.trouble,
            )  # fmt: skip
        starts = starts_error = None
        if self.shaft is not None and self._limited():
            starts = float(self.starts[i, self.shaft])
            starts_error = float(self.starts_errors[i, self.shaft])
        return DerivativeRow(
            quantity,
            name,
            frequency,
            float(self.peaks[i, self.element]),
            float(self.peak_errors[i, self.element]),
            starts,
            starts_error,
            _ends(d.peak_ends[:, self.element]),
            None if starts is None or self.shaft is None else _ends(d.starts_ends[:, self.shaft]),
            BY_DIFFERENCES if self.tangent is None else BOTH,
            self._note(i, d, starts),
        )

    def _limited(self) -> bool:
        """Whether the governing shaft has a number of starts."""
        nominal = self.plan.nominal.starts
        return (
            nominal is not None
            and self.shaft is not None
            and nominal.shafts[self.shaft].allowable_starts is not None
        )

    def _note(self, i: int, d: Differences, starts: float | None) -> str:
        said: list[str] = []
        answers = [("peak", self.element, self.peaks, self.peak_errors, d.peak_ends)]
        if starts is not None:
            answers.append(("starts", self.shaft, self.starts, self.starts_errors, d.starts_ends))
        for what, j, own, error, ends in answers:
            assert j is not None
            largest = float(np.max(np.abs(own[:, j])))
            doubtful = _doubtful(own, error, i, j)
            edge = 0.0 if self.tangent is None or what == "peak" else float(self.tangent.edge[j])
            if doubtful:
                why = "cycles come and go at the endurance limit, " if edge else ""
                said.append(f"The two differences of the {what} differ: {why}no one derivative.")
            straight = WHOLE * own[i, j] * np.array([-1.0, 1.0])
            bend = float(np.max(np.abs(ends[:, j] - straight)))
            if bend > max(DOUBTFUL * WHOLE * abs(own[i, j]), AGREED * WHOLE * largest, SEEN):
                said.append(
                    f"Within ± 1 % the {what} do{'es' if what == 'peak' else ''} not follow the "
                    f"derivative: {_signed(ends[0, j])} and {_signed(ends[1, j])}."
                )
            if self.tangent is not None:
                other = self.tangent.peak if what == "peak" else self.tangent.starts
                if abs(own[i, j] - other[i, j]) > allowed_difference(own, error, i, j):
                    said.append(
                        f"Per + 1 % the tangent gives {_signed(WHOLE * other[i, j])} for them."
                    )
        return " ".join(said)

    def largest_difference(self) -> float | None:
        """Largest difference of the two ways over the largest derivative of the answer."""
        if self.tangent is None or self.element is None or not self.found:
            return None
        worst = 0.0
        pairs = [(self.peaks, self.peak_errors, self.tangent.peak, self.element)]
        if self.shaft is not None and self._limited():
            pairs.append((self.starts, self.starts_errors, self.tangent.starts, self.shaft))
        for own, error, other, j in pairs:
            known = [
                i
                for i, d in self.found.items()
                if not d.trouble and not _doubtful(own, error, i, j)
            ]
            size = float(np.max(np.abs(own[known, j]), initial=0.0))
            if size > 0.0:
                worst = max(worst, float(np.max(np.abs(own[known, j] - other[known, j]))) / size)
        return worst


def _ends(logs: Floats) -> tuple[float, float]:
    """Relative changes from their logarithms."""
    return float(np.expm1(logs[0])), float(np.expm1(logs[1]))


def _signed(log: float) -> str:
    return f"{100.0 * math.expm1(log):+.2g} %"


def _doubtful(own: Floats, error: Floats, i: int, j: int) -> bool:
    """Whether the two differences of an answer are too far apart to be called a derivative."""
    largest = float(np.max(np.abs(own[:, j])))
    return bool(error[i, j] > max(DOUBTFUL * abs(own[i, j]), AGREED * largest))


def allowed_difference(own: Floats, error: Floats, i: int, j: int) -> float:
    """How far the two ways may be apart before it is noted.

    Parameters
    ----------
    own, error : ndarray, shape (n_parameters, n)
        Derivatives by differences, and their errors. [1]
    i, j : int
        Parameter and answer. [indices]

    Returns
    -------
    float
        Largest difference allowed. [1]
    """
    return AGREED * float(np.max(np.abs(own[:, j]), initial=0.0)) + float(error[i, j])


def _sentences(
    plan: DerivativePlan,
    energies: FrequencyDerivatives,
    tangent: TangentDerivatives | None,
    worst: float | None,
    rows: _Rows,
) -> Iterator[str]:
    if plan.reason:
        yield plan.reason
    else:
        yield (
            f"{len(plan.parameters)} quantities, each changed by ± {100 * WIDE:g} % and "
            f"± {100 * NARROW:g} % for its derivative, whose error is the difference of the two, and by "
            f"± {100 * WHOLE:g} % to see how far it holds."
        )
        if tangent is not None and worst is not None:
            yield (
                "The tangent of the start, a second way with another integrator, differs by at most "
                f"{100.0 * worst:.2g} % of the largest derivative where the differences tell one "
                f"(allowed {100 * AGREED:g} % beside their error; where it is more, the row says so)."
            )
        elif plan.recipe.start != LINEAR:
            yield (
                "The start has events, so its derivatives are differences of whole starts alone: "
                "where teeth meet again at another moment their errors are large."
            )
        else:
            yield "There is no tangent to check with: modes mix, or change places, too near."
    yield from energies.notes
    own = float(np.max(energies.unnamed, initial=0.0))
    if own > 1e-6:
        yield (
            f"Up to {100.0 * own:.2g} % of the kinetic energy of a mode is in the shafts' own "
            "inertia, which follows from their geometry and has no row."
        )


# --- all in one process; rows ---------------------------------------------------------------------


def derivatives(
    case: CaseData,
    *,
    on_progress: Callable[[int, int], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Derivatives:
    """Differentiate everything in this process.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    on_progress : callable, optional
        Called with the parameters done and the parameters in all. [count]
    should_stop : callable, optional
        Asked between parameters; True ends the study with what is known so far. [flag]

    Returns
    -------
    Derivatives
        The result. [1]

    Raises
    ------
    ModelError
        If the train cannot be calculated.
    """
    plan = plan_derivatives(case)
    units = derivative_units(plan)
    found = []
    for unit in units:
        if should_stop is not None and should_stop():
            break
        found.append(differences(unit))
        if on_progress is not None:
            on_progress(len(found), len(units))
    return gather_derivatives(plan, found, tangent_of(plan) if len(found) == len(units) else None)


def derivative_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Table of sensitivities under its JSON keys; changes are those for + 1 %, as fractions.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, peak_change and peak_error by the derivative, peak_below and peak_above as they really
        are at − 1 % and + 1 %, the same of the starts, method, note. [1]
    """
    return [
        {
            "quantity": r.quantity,
            "of": r.of,
            "peak_change": _hundredth(r.peak),
            "peak_error": _hundredth(r.peak_error),
            "peak_below": None if r.peak_ends is None else r.peak_ends[0],
            "peak_above": None if r.peak_ends is None else r.peak_ends[1],
            "starts_change": _hundredth(r.starts),
            "starts_error": _hundredth(r.starts_error),
            "starts_below": None if r.starts_ends is None else r.starts_ends[0],
            "starts_above": None if r.starts_ends is None else r.starts_ends[1],
            "method": r.method,
            "note": r.note,
        }
        for r in found.rows
        if r.peak is not None or r.note
    ]


def frequency_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Derivatives of the frequencies under their JSON keys, the strongest in the start first.

    The energies tell of every mode, so the rows go on to the tenth, where there are as many.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, mode_1, mode_2, …: ∂ln f/∂ln of the quantity. [1]
    """
    n = len(found.frequencies)
    rows = sorted(
        found.energies.rows, key=lambda r: -float(np.max(np.abs(r.value[:n]), initial=0.0))
    )
    return [
        {
            "quantity": r.quantity,
            "of": r.name,
            **{
                f"mode_{i}": v
                for i, v in enumerate(r.value[: max(n, LISTED_MODES)].tolist(), start=1)
            },
        }
        for r in rows
    ]


def _hundredth(value: float | None) -> float | None:
    return None if value is None else 0.01 * value


def element_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Change of the peak torque of every element, and of the starts of every shaft, for + 1 %.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, element, peak_torque, peak_error, allowable_starts, starts_error. [1]
    """
    rows = []
    for i, (quantity, name) in enumerate(found.parameters):
        for j, element in enumerate(found.elements):
            row: dict[str, Any] = {
                "quantity": quantity,
                "of": name,
                "element": element,
                "peak_torque": 0.01 * float(found.peaks[i, j]),
                "peak_error": 0.01 * float(found.peak_errors[i, j]),
            }
            if element in found.shafts:
                k = found.shafts.index(element)
                row["allowable_starts"] = 0.01 * float(found.all_starts[i, k])
                row["starts_error"] = 0.01 * float(found.starts_errors[i, k])
            rows.append(row)
    return rows
