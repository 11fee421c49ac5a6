"""How frequencies, peak torques and allowable starts follow each quantity of a case.

Frequencies: from the energies of the modes (`engine.model.frequency_derivatives`).

Starts: every quantity is changed by ± 0.02 % and ± 0.01 %, one at a time, all steps of the calculation
fixed. Richardson's extrapolation of the two central differences is the derivative. Its error is the
difference of the two, and where there is a tangent the difference from that as well: the differences
carry the step's error in the phase, which two of them at one step cannot show. The result of runs at ± 1 % is given beside it: a peak depends on the phase in which
the pulsation meets a mode, which a change of inertia or torque turns by more than a whole cycle per
cent, so a derivative may hold for a small part of that only. A linear start is differentiated a second, independent way, by its tangent
(`engine.studies.sensitivities.linear_start`), and the two are compared. The allowable starts follow from the turning points:
d ln q = Σ (n/N) k d ln S / q over the counted cycles, with the slope k of the S-N line at each.

Derivatives are relative: ∂ln(answer)/∂ln(quantity), the change in per cent for each per cent. A start
that is sensitive has no derivative and is not judged.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from engine.arrays import Floats
from engine.case.defaults import LEAST_PEAK_ERROR
from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.model.frequency_derivatives import FrequencyDerivatives, frequency_derivatives
from engine.start.start_fatigue import judged_shafts, sn_slope
from engine.studies.nearby_start import LINEAR, unit_stress
from engine.studies.sensitivities.differences import Differences
from engine.studies.sensitivities.plan import NARROW, WHOLE, WIDE, DerivativePlan, Parameter
from engine.studies.sensitivities.tangent import TangentDerivatives

#: The two ways agree if they differ by at most this share of the largest derivative of the answer,
#: beside the error of the differences. The differences carry the step's error in the phase, up to
#: 0.6 % on the trains of the tests; the tangent fulfils the homogeneity of torques to 1e-7 there.
AGREED = 0.03
#: A derivative whose error, or whose deviation at ± 1 %, exceeds this share of it (and `AGREED` of
#: the largest) is noted.
DOUBTFUL = 0.1
#: Twice the step and the tangent may both agree with a derivative by chance, as where its error changes
#: sign: either difference counts so often. (Once holds in 98 % of 204 derivatives, twice in 99 %, three
#: times in all.)
BY_CHANCE = 3.0
#: A deviation at ± 1 % smaller than this is not worth a note. [1]
SEEN = 1e-3
#: Modes whose derivatives are listed at least, where the train has so many. [count]
LISTED_MODES = 10
#: Words of the column Method.
ENERGIES = "energies"
BY_DIFFERENCES = "differences"
BOTH = "differences, checked by tangent"


@dataclass(frozen=True)
class DerivativeRow:
    """What one quantity does."""

    quantity: str  #: Quantity, and whose.
    of: str  #: Likewise.
    frequency: tuple[float, ...]  #: ∂ln f/∂ln of it, elastic mode by mode. [1]
    method: str  #: ``energies``, ``differences`` or ``differences, checked by tangent``.
    note: str = ""  #: What must be known of this row.
    peak: float | None = None  #: ∂ln(peak stress of the governing element); None = not judged. [1]
    peak_error: float | None = None  #: Its error. [1]
    #: ∂ln(allowable starts of the governing shaft); None = unlimited or not judged. [1]
    starts: float | None = None
    starts_error: float | None = None  #: Its error. [1]
    #: Relative change of either answer at − 1 % and at + 1 %. [1]
    peak_ends: tuple[float, float] | None = None
    starts_ends: tuple[float, float] | None = None  #: Likewise. [1]


@dataclass(frozen=True, eq=False)
class Derivatives:
    """How the answers of a case follow its quantities."""

    frequencies: tuple[float, ...]  #: Elastic frequencies that are differentiated. [Hz]
    energies: FrequencyDerivatives  #: Derivatives of all frequencies. [1]
    rows: tuple[DerivativeRow, ...]  #: The quantity that matters most first. [1]
    governing: str | None  #: Element whose peak, and shaft whose starts, the rows tell.
    parameters: tuple[Parameter, ...]  #: In the order of the arrays below, as are the next two.
    elements: tuple[str, ...]  #: Elements of the case.
    shafts: tuple[str, ...]  #: Its judged shafts.
    #: ∂ln(largest torque)/∂ln p of every element, and errors. [1] Shape (n_parameters,
    #: n_elements).
    peaks: Floats
    peak_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_elements).
    #: ∂ln(starts)/∂ln p of every judged shaft, and errors. [1] Shape (n_parameters, n_shafts).
    all_starts: Floats
    starts_errors: Floats  #: Likewise. [1] Shape (n_parameters, n_shafts).
    #: What the step adds to the errors of either. [1] Shapes as `peaks`, `all_starts`.
    peak_steps: Floats
    starts_steps: Floats  #: Likewise. [1] Shape (n_parameters, n_shafts).
    tangent: TangentDerivatives | None  #: The second way; None where there is none. [1]
    #: Largest difference of the two ways over the largest derivative of the answer. [1]
    largest_difference: float | None
    sentences: tuple[str, ...]  #: What a reader must know.

    @property
    def stated_peak_errors(self) -> Floats:
        """Errors of peaks as they are reported, those of the step included. [1] Shape as `peaks`."""
        other = None if self.tangent is None else self.tangent.peak
        return _stated(self.peaks, self.peak_errors, other, self.peak_steps)

    @property
    def stated_starts_errors(self) -> Floats:
        """Likewise of starts. [1] Shape as `all_starts`."""
        other = None if self.tangent is None else self.tangent.starts
        return _stated(self.all_starts, self.starts_errors, other, self.starts_steps)


def _stated(own: Floats, error: Floats, other: Floats | None, step: Floats) -> Floats:
    """Error of the differences, with what the step adds and the distance from the tangent."""
    distance = 0.0 if other is None else np.abs(own - other)
    return np.asarray(error + step + BY_CHANCE * distance)


def _of_the_step(own: Floats, change: Floats, relative: float) -> Floats:
    """What the step adds to errors of derivatives, and all else that leaves the answers unsure.

    A relative error of the answers turns the phase a little, which mixes their derivatives: it counts by
    the largest one.
    """
    return np.asarray(BY_CHANCE * change + relative * np.max(np.abs(own), axis=0, initial=0.0))


def _unsure(plan: DerivativePlan, tangent: TangentDerivatives | None) -> tuple[float, float]:
    """Relative errors of peaks and starts that count for those of their derivatives.

    Where twice the step and another integrator show what the step does, they are those of modes left out
    and of pieces alone; no torque is known better than to `LEAST_PEAK_ERROR`.
    """
    start = plan.nominal.start
    if tangent is None or start is None:
        return plan.recipe.step_error, plan.recipe.starts_error or 0.0
    pieces = max((e for _, e in start.pieces_error), default=0.0)
    unshown = max(start.truncation_error + pieces, LEAST_PEAK_ERROR)
    return unshown, sn_slope(plan.case) * unshown


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
    peak_steps, starts_steps = np.zeros(shape), np.zeros_like(starts)
    for i, d in by_index.items():
        peaks[i], peak_errors[i], peak_steps[i] = d.peak, d.peak_error, d.peak_step
        starts[i], starts_errors[i], starts_steps[i] = d.starts, d.starts_error, d.starts_step
    element, shaft = _governing(plan)
    unsure, unsure_starts = _unsure(plan, tangent)
    peak_steps = _of_the_step(peaks, peak_steps, unsure)
    starts_steps = _of_the_step(starts, starts_steps, unsure_starts)
    answers = []
    if element is not None:
        other = None if tangent is None else tangent.peak[:, element]
        ends = {i: d.peak_ends[:, element] for i, d in by_index.items()}
        answers.append(
            _Answer(
                "peak",
                peaks[:, element],
                peak_errors[:, element],
                ends,
                other,
                peak_steps[:, element],
            )
        )
    if shaft is not None and _is_limited(plan, shaft):
        other = None if tangent is None else tangent.starts[:, shaft]
        edge = tangent is not None and bool(tangent.edge[shaft])
        ends = {i: d.starts_ends[:, shaft] for i, d in by_index.items()}
        own, error = starts[:, shaft], starts_errors[:, shaft]
        answers.append(_Answer("starts", own, error, ends, other, starts_steps[:, shaft], edge))
    worst = None
    if tangent is not None and element is not None and found:
        calculated = [i for i, d in by_index.items() if not d.trouble]
        worst = max(answer.largest_difference(calculated) for answer in answers)
    rows = sorted(_rows(plan, energies, by_index, answers), key=lambda r: -_weight(r))
    return Derivatives(
        tuple(nominal.modes.elastic_frequency[: plan.recipe.n_modes].tolist()),
        energies,
        tuple(rows),
        None if element is None else str(case.elements[element].element),
        plan.parameters,
        tuple(str(e.element) for e in case.elements),
        tuple(str(e.element) for _, e in judged),
        peaks,
        peak_errors,
        starts,
        starts_errors,
        peak_steps,
        starts_steps,
        tangent,
        worst,
        tuple(_sentences(plan, energies, tangent, worst)),
    )


def _weight(row: DerivativeRow) -> float:
    """What rows are sorted by: what ± 1 % does to the starts, else to the peak, else frequencies."""
    ends = row.starts_ends or row.peak_ends
    if ends is not None:
        return max(abs(e) for e in ends) + 1e3
    return max((abs(f) for f in row.frequency), default=0.0)


def _governing(plan: DerivativePlan) -> tuple[int | None, int | None]:
    """Element whose peak is reported, and its place among the judged shafts."""
    nominal, case = plan.nominal, plan.case
    if plan.reason or nominal.start is None:
        return None, None
    judged = [i for i, _ in judged_shafts(case)]
    names = [str(e.element) for e in case.elements]
    if nominal.starts is not None and nominal.starts.governing in names:
        element = names.index(str(nominal.starts.governing))
        return element, judged.index(element)
    largest = {p.element: p.size for p in nominal.start.peaks}
    unit = unit_stress(case)
    weight = unit if np.any(unit) else np.ones(len(unit))
    element = int(np.argmax([w * largest.get(n, 0.0) for w, n in zip(weight, names, strict=True)]))
    return element, judged.index(element) if element in judged else None


def _is_limited(plan: DerivativePlan, shaft: int) -> bool:
    """Whether a shaft has a number of starts."""
    starts = plan.nominal.starts
    return starts is not None and starts.shafts[shaft].allowable_starts is not None


@dataclass(frozen=True, eq=False)
class _Answer:
    """Results for each quantity: derivatives of one answer, one number per quantity."""

    name: str  #: ``peak`` or ``starts``.
    own: Floats  #: By differences. [1] Shape (n_parameters,).
    error: Floats  #: Its error. [1] Shape (n_parameters,).
    ends: Mapping[int, Floats]  #: Logarithms of its change at − 1 % and + 1 %, by quantity. [1]
    other: Floats | None  #: By the tangent; None without one. [1] Shape (n_parameters,).
    step: Floats  #: What the step adds to its error. [1] Shape (n_parameters,).
    edge: bool = False  #: Whether cycles come and go at the endurance limit.

    def stated_error(self, i: int) -> float:
        """Error as it is reported."""
        return float(_stated(self.own, self.error, self.other, self.step)[i])

    def is_doubtful(self, i: int) -> bool:
        """Whether the two differences are too far apart to be called a derivative."""
        largest = float(np.max(np.abs(self.own)))
        return bool(self.error[i] > max(DOUBTFUL * abs(self.own[i]), AGREED * largest))

    def notes(self, i: int) -> Iterator[str]:
        """What must be known of the derivative by one quantity."""
        own = self.own[i]
        largest = float(np.max(np.abs(self.own)))
        if self.is_doubtful(i):
            why = "cycles pass the endurance limit" if self.edge else "its two differences disagree"
            yield f"No unique derivative of the {self.name}: {why}."
        straight = WHOLE * own * np.array([-1.0, 1.0])
        bend = float(np.max(np.abs(self.ends[i] - straight)))
        if bend > max(DOUBTFUL * WHOLE * abs(own), AGREED * WHOLE * largest, SEEN):
            # Both changes have columns of their own.
            yield f"The {self.name} {'is' if self.name == 'peak' else 'are'} not linear within ± 1 %."
        if self.other is not None:
            if abs(own - self.other[i]) > AGREED * largest + float(self.error[i]):
                yield f"By the tangent equations {_signed(WHOLE * self.other[i])} for + 1 %."

    def largest_difference(self, calculated: Sequence[int]) -> float:
        """Largest difference of the two ways over the largest derivative."""
        judged = [i for i in calculated if not self.is_doubtful(i)]
        size = float(np.max(np.abs(self.own[judged]), initial=0.0))
        if self.other is None or size == 0.0:
            return 0.0
        return float(np.max(np.abs(self.own[judged] - self.other[judged]))) / size


def _rows(
    plan: DerivativePlan,
    energies: FrequencyDerivatives,
    found: Mapping[int, Differences],
    answers: Sequence[_Answer],
) -> Iterator[DerivativeRow]:
    n_modes = plan.recipe.n_modes
    for i, (quantity, name) in enumerate(plan.parameters):
        by_energies, d = energies.of(quantity, name), found.get(i)
        frequency = (
            (0.0,) * n_modes if by_energies is None else tuple(by_energies[:n_modes].tolist())
        )
        if d is None or not answers or d.trouble:
            method = ENERGIES if quantity in (STIFFNESS, INERTIA) else ""
            yield DerivativeRow(quantity, name, frequency, method, "" if d is None else d.trouble)
            continue
        values: dict[str, Any] = {}
        for a in answers:
            values |= {a.name: float(a.own[i]), f"{a.name}_error": a.stated_error(i)}
            values[f"{a.name}_ends"] = _ends(a.ends[i])
        method = BY_DIFFERENCES if answers[0].other is None else BOTH
        note = " ".join(words for a in answers for words in a.notes(i))
        yield DerivativeRow(quantity, name, frequency, method, note, **values)
    for r in energies.rows:
        if (r.quantity, r.name) not in plan.parameters:
            yield DerivativeRow(r.quantity, r.name, tuple(r.value[:n_modes].tolist()), ENERGIES)


def _ends(logs: Floats) -> tuple[float, float]:
    """Relative changes from their logarithms."""
    return float(np.expm1(logs[0])), float(np.expm1(logs[1]))


def _signed(log: float) -> str:
    return f"{100.0 * math.expm1(log):+.2g} %"


def _sentences(
    plan: DerivativePlan,
    energies: FrequencyDerivatives,
    tangent: TangentDerivatives | None,
    worst: float | None,
) -> Iterator[str]:
    if plan.reason:
        yield plan.reason
    else:
        yield (
            f"{len(plan.parameters)} quantities. Each derivative comes from differences over "
            f"± {100 * WIDE:g} % and ± {100 * NARROW:g} %, and its error is the difference of the "
            f"two, plus that of the step{' and that from the tangent' if tangent is not None else ''}; runs at ± {100 * WHOLE:g} % show how far it holds."
        )
        if tangent is not None and worst is not None:
            yield (
                "The tangent equations of the start, solved by another integrator, differ from these "
                f"differences by at most {100.0 * worst:.2g} % of the largest derivative where a "
                f"derivative exists (allowed {100 * AGREED:g} % plus their error; rows that exceed "
                "this carry a note)."
            )
        elif plan.recipe.start != LINEAR:
            yield (
                "The start has events, so its derivatives come only from differences of complete "
                "starts. Their errors are large where the time of tooth re-engagement changes."
            )
        elif plan.recipe.effects.electrical_damping:
            yield (
                "No tangent check: the motor answers oscillations (effect electrical damping), and its answer changes with "
                "every mode. The derivatives come from differences of complete starts alone."
            )
        else:
            yield "No tangent check: modes are too close and mix or change order."
    yield from energies.notes
    own = float(np.max(energies.unnamed, initial=0.0))
    if own > 1e-6:
        yield (
            f"Up to {100.0 * own:.2g} % of the kinetic energy of a mode is in the shafts' own "
            "inertia, which is not listed because it follows from geometry."
        )
