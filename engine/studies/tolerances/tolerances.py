"""Tolerances: what the scatter of its data makes of a train's frequencies, margins and starts.

A sample gives every scattered quantity a value (`engine.studies.scatter`); its train is calculated as
`engine.studies.tolerances.sample` says. From all samples: percentiles, the probability that each demand is met,
both with their own sampling errors, and what drives the allowable starts: rank regression over the
sample, beside real runs with one factor at a time at its P10 and P90.

Intervals are those of independent samples. Latin hypercubes and Sobol sequences fill the space more
evenly, so for answers that rise or fall with each factor they are closer than the intervals say.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.arrays import Floats, Mask
from engine.errors import ModelError
from engine.numerics.sample_statistics import (
    CONFIDENCE,
    Percentile,
    convergence,
    percentile_interval,
    rank_regression,
    share_interval,
)
from engine.operation.margins import MARGIN_ROUNDING
from engine.operation.standards import required_margin
from engine.start.start_fatigue import is_counted, judged_shafts
from engine.studies.nearby_start import LINEAR, NO_START, NearbyStartPlan, unit_stress
from engine.studies.scatter import METHODS, sample_size
from engine.studies.tolerances.sample import (
    MASKS,
    NUMBERS,
    Evaluated,
    TolerancePlan,
    ToleranceSettings,
)

#: Percentiles that are reported. [1]
PERCENTILES = (0.1, 0.5, 0.9)
#: What the drivers may be drivers of.
STARTS, STRESS, MARGIN = "allowable starts", "peak stress", "least margin"


@dataclass(frozen=True)
class PercentileRow:
    """How one answer scatters."""

    #: ``frequency`` [Hz], ``margin``, ``peak torque`` [N m], ``peak stress`` [Pa] (zero-to-peak,
    #: nominal) or ``allowable starts``.
    quantity: str
    of: str  #: Mode, mode and excitation, or element; ``train`` for the worst of all shafts.
    #: Answer of the nominal run; infinite = unlimited, None = not judged. [as the quantity]
    nominal: float | None
    percentiles: tuple[Percentile, ...]  #: P10, P50, P90. [as the quantity]
    unlimited: float  #: Share of the samples without any damage. [1]
    samples: int  #: Samples it is taken from.


@dataclass(frozen=True)
class ProbabilityRow:
    """How probable it is that a demand is met."""

    check: str  #: ``margin``, ``all margins``, ``start completed`` or ``starts``.
    of: str  #: Mode and excitation, or shaft.
    required: float | None  #: Demand. [1]
    nominal: float | None  #: What the nominal run has. [1]
    probability: float  #: Share of the samples that meet it. [1]
    low: float  #: Its interval. [1]
    high: float  #: Likewise. [1]
    samples: int  #: Samples it is taken from.


@dataclass(frozen=True)
class DriverRow:
    """What one factor does to the answer that is looked at."""

    factor: str  #: What scatters.
    deviation: float  #: Its standard deviation. [1]
    #: The answer of a run with this factor at its P10 and P90, all else as stated; infinite =
    #: unlimited, None = not judged. [as the answer]
    at_low: float | None
    at_high: float | None  #: Likewise. [as the answer]
    #: Standardized coefficient of the rank regression; None = not enough samples. [1]
    rank_coefficient: float | None
    partial: float | None  #: Partial rank correlation. [1]
    #: Part of the scatter of the ranks it explains; the shares add up to R². [1]
    share: float | None


@dataclass(frozen=True, eq=False)
class Tolerances:
    """What the scatter makes of the answers."""

    settings: ToleranceSettings  #: How the sample was drawn. [mixed]
    wanted: int  #: Samples planned and calculated.
    samples: int  #: Likewise.
    #: Frequencies, margins, torques, stresses, starts. [rows]
    percentiles: tuple[PercentileRow, ...]
    probabilities: tuple[ProbabilityRow, ...]  #: Of every demand. [rows]
    drivers: tuple[DriverRow, ...]  #: The strongest first. [rows]
    #: What they drive: ``allowable starts``, or where these do not vary ``peak stress`` or ``least
    #: margin``.
    driven: str
    #: R² of the rank regression; the rest is interaction, bending and chance. [1]
    explained: float | None
    converged: bool  #: Whether the sample was large enough.
    sentences: tuple[str, ...]  #: What a reader must know, the judgement on convergence first.
    #: Samples whose start was not completed: they are in no percentile of it.
    unfinished: int
    lost: int  #: Samples that could not be calculated: they are in no number.
    #: Allowable starts of the train in every judged sample; infinite = unlimited. [1] Shape (n,).
    starts: Floats = field(repr=False)
    #: First elastic frequency of every sample. [Hz] Shape (n,).
    first_frequency: Floats = field(repr=False)
    plan: TolerancePlan = field(repr=False)  #: What was drawn. [mixed]
    answers: Evaluated = field(repr=False)  #: Of every sample. [SI]


# --- from samples to answers ----------------------------------------------------------------------


def summarise_sample(plan: TolerancePlan, evaluated: Sequence[Evaluated]) -> Tolerances:
    """The whole result from whatever units were calculated, in any order.

    Parameters
    ----------
    plan : TolerancePlan
        The plan. [mixed]
    evaluated : sequence of Evaluated
        Answers of its units; samples that are missing are left out. [SI]

    Returns
    -------
    Tolerances
        Percentiles, probabilities, drivers. [SI]

    Raises
    ------
    ModelError
        If no sample could be calculated.
    """
    whole = _joined(plan, evaluated)
    sample, swings = (
        _part(whole, slice(0, plan.n_samples)),
        _part(whole, slice(plan.n_samples, None)),
    )
    if not np.any(sample.known):
        reason = next((t for e in evaluated for t in e.troubles), "no reason was recorded")
        raise ModelError(f"No sample could be calculated: {reason}")
    percentiles = tuple(_percentile_rows(plan, sample))
    driven, answer, usable = _driven(plan, sample)
    drivers, explained = _drivers(plan, sample, swings, driven, answer, usable)
    has_starts = plan.recipe.start != NO_START and whole.starts.shape[1] > 0
    judged = sample.known & sample.counted
    least = np.min(sample.starts[judged], axis=1) if has_starts else np.zeros(0)
    settled = convergence(*_settling(plan, sample, driven, answer, usable))
    return Tolerances(
        plan.settings,
        plan.n_samples,
        int(np.sum(sample.known)),
        percentiles,
        tuple(_probability_rows(plan, sample)),
        drivers,
        driven,
        explained,
        settled.reached,
        (settled.sentence, *_sentences(plan, sample, evaluated, percentiles)),
        int(np.sum(sample.known & ~sample.counted)) if plan.recipe.start != NO_START else 0,
        sum(len(e.troubles) for e in evaluated if e.first < plan.n_samples),
        least,
        sample.frequency[sample.known][:, 0] if plan.recipe.n_modes else np.zeros(0),
        plan,
        sample,
    )


def _joined(plan: TolerancePlan, evaluated: Sequence[Evaluated]) -> Evaluated:
    """All rows in their places; those that are missing are not known."""
    n, some = plan.n_runs, evaluated[0] if evaluated else None
    if some is None:
        raise ModelError("No sample was calculated: the study stopped before the first.")

    def put(name: str) -> NDArray[Any]:
        like = getattr(some, name)
        out = np.zeros((n, *like.shape[1:]), dtype=like.dtype)
        for part in evaluated:
            rows = getattr(part, name)
            out[part.first : part.first + len(rows)] = rows
        return out

    arrays: dict[str, Any] = {name: put(name) for name in (*MASKS, *NUMBERS)}
    return Evaluated(0, **arrays)


def _part(whole: Evaluated, rows: slice) -> Evaluated:
    arrays: dict[str, Any] = {name: getattr(whole, name)[rows] for name in (*MASKS, *NUMBERS)}
    return Evaluated(rows.start, **arrays)


# --- percentiles ----------------------------------------------------------------------------------


def _percentile_row(quantity: str, of: str, nominal: float | None, values: Floats) -> PercentileRow:
    ordered = np.sort(values)
    return PercentileRow(
        quantity,
        of,
        nominal,
        tuple(percentile_interval(ordered, p) for p in PERCENTILES) if len(ordered) else (),
        float(np.mean(np.isinf(ordered))) if len(ordered) else 0.0,
        len(ordered),
    )


def _percentile_rows(plan: TolerancePlan, sample: Evaluated) -> Iterator[PercentileRow]:
    nominal, recipe, known = plan.nominal, plan.recipe, sample.known
    elastic = nominal.modes.elastic_frequency
    for i in range(recipe.n_modes):
        yield _percentile_row(
            "frequency", f"mode {i + 1}", float(elastic[i]), sample.frequency[known, i]
        )
    stated = {(r.mode, r.excitation): r.margin for r in nominal.margins.rows}
    for i, (mode, excitation) in enumerate(recipe.margins):
        yield _percentile_row(
            "margin",
            f"mode {mode}, {excitation}",
            stated[mode, excitation],
            sample.margin[known, i],
        )
    if recipe.start == NO_START or nominal.start is None:
        return
    whole, unit = known & sample.counted, unit_stress(plan.case)
    peaks = {p.element: p.size for p in nominal.start.peaks}
    stands = is_counted(nominal.start)  # else its peaks are those of a part of a start
    for quantity, factor in (("peak torque", np.ones(len(unit))), (STRESS, unit)):
        for i, e in enumerate(plan.case.elements):
            if factor[i] > 0.0 and e.element in peaks:
                at = factor[i]
                peak = at * peaks[e.element] if stands else None
                yield _percentile_row(quantity, str(e.element), peak, at * sample.torque[whole, i])
    yield from _start_rows(plan, sample, whole)


def _start_rows(plan: TolerancePlan, sample: Evaluated, whole: Mask) -> Iterator[PercentileRow]:
    """Allowable starts of each judged shaft, and of the train."""
    judged = judged_shafts(plan.case)
    stated = _nominal_starts(plan)
    for i, (_, e) in enumerate(judged):
        yield _percentile_row(
            STARTS, str(e.element), stated.get(str(e.element)), sample.starts[whole, i]
        )
    if len(judged) > 1 and np.any(whole):
        least = min(stated.values()) if len(stated) == len(judged) else None
        yield _percentile_row(STARTS, "train", least, np.min(sample.starts[whole], axis=1))


def _nominal_starts(plan: TolerancePlan) -> dict[str, float]:
    """Allowable starts of the nominal run; infinite = unlimited, none where it is not judged."""
    starts = plan.nominal.starts
    if starts is None or not is_counted(plan.nominal.start):
        return {}
    return {
        s.element: math.inf if s.allowable_starts is None else s.allowable_starts
        for s in starts.shafts
    }


# --- probabilities --------------------------------------------------------------------------------


def _probability(
    check: str, of: str, required: float | None, nominal: float | None, met: Mask
) -> ProbabilityRow:
    n, n_met = len(met), int(np.sum(met))
    low, high = share_interval(n_met, n)
    return ProbabilityRow(check, of, required, nominal, n_met / n, low, high, n)


def _probability_rows(plan: TolerancePlan, sample: Evaluated) -> Iterator[ProbabilityRow]:
    case, recipe, known = plan.case, plan.recipe, sample.known
    required = required_margin(case)
    stated = {(r.mode, r.excitation): r.margin for r in plan.nominal.margins.rows}
    margin_met = sample.margin[known] >= required - MARGIN_ROUNDING
    for i, (mode, excitation) in enumerate(recipe.margins):
        yield _probability(
            "margin",
            f"mode {mode}, {excitation}",
            required,
            stated[mode, excitation],
            margin_met[:, i],
        )
    if recipe.margins:
        least = min(stated[row] for row in recipe.margins)
        yield _probability("all margins", "train", required, least, np.all(margin_met, axis=1))
    if recipe.start == NO_START:
        return
    yield _probability("start completed", "train", None, None, sample.counted[known])
    wanted, factor = case.starts_required, case.starts_factor or 1.0
    if wanted is None or not sample.starts.shape[1]:
        return
    # a start that never ends allows no number of starts
    enough = (sample.starts[known] / factor >= wanted) & sample.counted[known][:, None]
    nominal = _nominal_starts(plan)
    for i, (_, e) in enumerate(judged_shafts(case)):
        own = nominal.get(str(e.element))
        yield _probability(
            "starts",
            str(e.element),
            wanted,
            None if own is None else own / factor,
            enough[:, i],
        )
    if enough.shape[1] > 1:
        least_starts = min(nominal.values()) / factor if nominal else None
        yield _probability("starts", "train", wanted, least_starts, np.all(enough, axis=1))


# --- drivers --------------------------------------------------------------------------------------


def _answers(plan: TolerancePlan, part: Evaluated, driven: str) -> tuple[Floats, Mask]:
    """The answer that is driven in each sample, and where it is known."""
    if driven == STARTS:
        return np.min(part.starts, axis=1, initial=math.inf), part.known & part.counted
    if driven == STRESS:
        worst = _worst_stress(plan)
        unit = unit_stress(plan.case)[worst]
        return unit * part.torque[:, worst], part.known & part.counted
    return np.min(part.margin, axis=1, initial=math.inf), part.known


def _settling(
    plan: TolerancePlan, sample: Evaluated, driven: str, answer: Floats, usable: Mask
) -> tuple[Floats, str, float]:
    """By which answer and percentile the sample is judged: the P10 of the starts wherever there are any.

    Of the stress that stands in for them its P90: its P10 is the harmless end.
    """
    if plan.recipe.start != NO_START and sample.starts.shape[1]:
        starts, judged = _answers(plan, sample, STARTS)
        return starts[judged], STARTS, PERCENTILES[0]
    return answer[usable], driven, PERCENTILES[-1] if driven == STRESS else PERCENTILES[0]


def _worst_stress(plan: TolerancePlan) -> int:
    """Element with the largest nominal stress in the nominal run."""
    assert plan.nominal.start is not None
    peaks = {p.element: p.size for p in plan.nominal.start.peaks}
    unit = unit_stress(plan.case)
    stress = [unit[i] * peaks.get(str(e.element), 0.0) for i, e in enumerate(plan.case.elements)]
    return int(np.argmax(stress))


def _driven(plan: TolerancePlan, sample: Evaluated) -> tuple[str, Floats, Mask]:
    """The answer whose drivers are looked for: starts where they vary, else what does."""
    choices = []
    if plan.recipe.start != NO_START:
        choices += [STARTS] if sample.starts.shape[1] else []
        choices += [STRESS] if np.any(unit_stress(plan.case)) else []
    choices += [MARGIN] if plan.recipe.margins else []
    if not choices:
        return MARGIN, np.zeros(len(sample.known)), sample.known
    for word in choices:
        answer, usable = _answers(plan, sample, word)
        # where half of all starts are unlimited there is little to explain; stress says more
        if np.any(usable) and (word != STARTS or np.mean(np.isinf(answer[usable])) < 0.5):
            return word, answer, usable
    answer, usable = _answers(plan, sample, choices[-1])
    return choices[-1], answer, usable


def _drivers(
    plan: TolerancePlan,
    sample: Evaluated,
    swings: Evaluated,
    driven: str,
    answer: Floats,
    usable: Mask,
) -> tuple[tuple[DriverRow, ...], float | None]:
    """Every factor's part, the strongest first, and R²."""
    d = len(plan.factors)
    values = plan.values[: plan.n_samples][usable]
    ranks = rank_regression(values, answer[usable])
    at, known = _answers(plan, swings, driven)
    rows = []
    for i, factor in enumerate(plan.factors):
        rows.append(
            DriverRow(
                factor.label,
                factor.deviation,
                float(at[i]) if known[i] else None,
                float(at[d + i]) if known[d + i] else None,
                None if ranks is None else float(ranks.coefficient[i]),
                None if ranks is None else float(ranks.partial[i]),
                None if ranks is None else float(ranks.share[i]),
            )
        )
    rows.sort(key=lambda r: -_swing(r) if r.share is None else -abs(r.share))
    return tuple(rows), None if ranks is None else ranks.explained


def _swing(row: DriverRow) -> float:
    """How far apart the two runs of one factor are, in the logarithm."""
    if row.at_low is None or row.at_high is None:
        return math.inf
    low, high = sorted((row.at_low, row.at_high))
    if low == high:
        return 0.0
    return math.inf if math.isinf(high) or low <= 0.0 else math.log(high / low)


# --- words ----------------------------------------------------------------------------------------


def _percent(share: float) -> str:
    return f"{float(f'{100.0 * share:.2g}'):g} %"


def _sentences(
    plan: TolerancePlan,
    sample: Evaluated,
    evaluated: Sequence[Evaluated],
    percentiles: Sequence[PercentileRow],
) -> Iterator[str]:
    """What a reader must know beside the numbers."""
    n = int(np.sum(sample.known))
    asked, drawn = plan.settings.samples, plan.n_samples
    kind = "Latin hypercube" if plan.settings.method == METHODS[0] else "scrambled Sobol sequence"
    missing = drawn - n - sum(len(e.troubles) for e in evaluated if e.first < drawn)
    yield (
        f"{n} samples of {len(plan.factors)} factors, {kind}, seed {plan.settings.seed}. Intervals "
        f"hold with {100.0 * CONFIDENCE:.0f} % confidence for independent samples"
        + (
            "."
            if missing > 0
            else "; for these more evenly distributed samples they are conservative."
        )
    )
    if sample_size(asked, plan.settings.method) != asked:
        yield (
            f"{asked} samples were requested; a Sobol sequence is balanced only at powers of two, so "
            f"the number was raised to {drawn}."
        )
    if missing > 0:
        yield _about_the_part(plan.settings.method, n, drawn)
    troubles = [t for e in evaluated for t in e.troubles]
    if troubles:
        yield (
            f"{len(troubles)} runs could not be calculated and are excluded; first reason: "
            f"{troubles[0]}"
        )
    yield from _about_the_starts(plan, sample, evaluated, percentiles)


def _about_the_part(method: str, n: int, drawn: int) -> str:
    """What the first samples are worth without the rest.

    Rows of a Latin hypercube are exchangeable (the columns are permuted each for itself), so its
    first rows are a random part of it: each is drawn from the distribution that is stated, and any two
    differ rather more than independent ones. A Sobol sequence fills the space from its first point on.
    """
    if method == METHODS[0]:
        return (
            f"Stopped after {n} of {drawn} samples. An incomplete Latin hypercube is treated as a "
            "random sample of independent trains, as the intervals assume."
        )
    return (
        f"Stopped after {n} of {drawn} samples of the sequence, which is balanced only at "
        "powers of two; the intervals hold as for independent samples."
    )


def _about_the_starts(
    plan: TolerancePlan,
    sample: Evaluated,
    evaluated: Sequence[Evaluated],
    percentiles: Sequence[PercentileRow],
) -> Iterator[str]:
    recipe, known = plan.recipe, sample.known
    if recipe.start == NO_START:
        yield "No motor torque curve and no prescribed torque: no start was calculated."
        return
    n = int(np.sum(known))
    if recipe.start == LINEAR:
        yield _step_sentence(recipe, sample, percentiles)
    else:
        what = ", ".join(f"'{name}'" for name in recipe.effects.clearances)
        yield (
            "Each start was calculated like the nominal run, with the same plan"
            + (f" (clearances of {what})" if what else "")
            + " and its own step refinement."
        )
    unfinished = n - int(np.sum(sample.counted[known]))
    if unfinished:
        counts: dict[str, int] = {}
        for word, times in (o for e in evaluated for o in e.outcomes):
            counts[word] = counts.get(word, 0) + times
        outcomes = ", ".join(f"{times} {word}" for word, times in sorted(counts.items()))
        yield (
            f"{unfinished} of {n} starts were not completed: their torques and allowable starts "
            f"are not judged and are excluded from the percentiles (outcomes of all runs: {outcomes})."
        )
    reversed_ = int(np.sum(sample.reversed[known]))
    if reversed_:
        names = ", ".join(f"'{name}'" for name in recipe.gaps)
        yield (
            f"In {reversed_} of {n} samples the torque of an element with a clearance reverses where "
            f"the plan of the nominal run models no clearance ({names}): "
            + (
                "each was recalculated with its own plan."
                if plan.settings.replan
                else "the calculation does not let their teeth separate. Request replanning "
                "(--replan), or force backlash on."
            )
        )
    sensitive = int(np.sum(sample.sensitive[known]))
    if sensitive:
        yield (
            f"{sensitive} of {n} starts are sensitive (a change of 1e-9 changes their peaks): "
            "each is one sample of possible values, and their scatter is included in the "
            "percentiles."
        )


def _step_sentence(
    recipe: NearbyStartPlan, sample: Evaluated, percentiles: Sequence[PercentileRow]
) -> str:
    """Step error of each start beside the sampling error of the percentiles."""
    widths = [
        max(p.high - p.value, p.value - p.low) / abs(p.value)
        for row in percentiles
        if row.quantity == STARTS
        for p in row.percentiles[:1]
        if p.low is not None and p.high is not None and math.isfinite(p.high) and p.value
    ]
    text = (
        f"Each start was calculated once, at a step of {recipe.step:.3g} s, where the nominal "
        f"run has an error of {_percent(recipe.step_error)} of the peak torques"
    )
    counts_starts = recipe.starts_error is not None
    error = recipe.starts_error or 0.0
    if counts_starts:
        text += f" and {_percent(error)} of the allowable starts"
    checked = sample.checked & sample.known
    if np.any(checked):
        torque, starts = np.max(sample.by_step[checked], axis=0)
        times = int(np.sum(checked))
        text += (
            f"; half that step, checked in {times} samples, changes peak torques by at most "
            f"{_percent(float(torque))}"
        )
        if counts_starts:
            text += f", starts by {_percent(float(starts))}"
            error = max(error, float(starts))
    if not counts_starts or not widths:
        return text + "."
    sampling = max(widths)
    if sampling > 3.0 * error:
        return (
            f"{text}. The sampling error of the P10 of the allowable starts, {_percent(sampling)}, "
            "is much larger."
        )
    return (
        f"{text}. The sampling error of the P10 of the allowable starts, {_percent(sampling)}, "
        "is not much larger: tighten TolerancePeak and ToleranceStarts."
    )
