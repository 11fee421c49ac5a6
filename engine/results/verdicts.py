"""The checks at a glance: margin, forced response, start, peaks, yield, reversal, starts.

There is a row for every kind of check that the train calls for, also where nothing was entered for it.
Each says what it covers, and names what it does not: a verdict is that of the elements that were
judged. The first row is the worst of all.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from engine.backlash.operating_events import OperatingEvent
from engine.case.coverage import (
    calls_for_start,
    links,
    listed,
    shafts,
    without_peak_limit,
    without_sn_points,
    without_yield,
)
from engine.case.data import CaseData, ElementRow
from engine.case.effects import choice_of
from engine.case.result_words import ACCEPTABLE, Judgement, NoNumber, Outcome
from engine.fatigue.allowable_starts import AllowableStarts
from engine.fatigue.stress import stress_of_unit_torque
from engine.operation.margins import MarginRow, SeparationMargins
from engine.operation.standards import (
    EVENTS,
    MARGIN,
    RESPONSE,
    REVERSAL,
    profile_of,
    short_circuits_missing,
)
from engine.operation.steady_state import STRESS_ROUNDING, SteadyState, SteadyStateRow
from engine.results.implausible_results import implausible_results
from engine.results.results import AtSpeed, CaseVerdict, Results, Verdict
from engine.start.crossings import Crossing
from engine.start.lowest_torque import lowest_torques
from engine.start.peaks import ElementPeak
from engine.start.reversals import Reversal, reversing_elements
from engine.start.start import Start
from engine.start.start_fatigue import WHOLE_STARTS, is_counted

#: Verdicts of checks, the worst first; what is not judged keeps the whole from passing.
_WORST_FIRST = (
    Judgement.FAIL,
    Judgement.UNBOUNDED,
    Judgement.NOT_JUDGED,
    Judgement.INCOMPLETE,
    Judgement.WITHIN_ERROR,
    Judgement.ACCEPTED,
    Judgement.PASS,
)
#: What a check is overall, where it is another word.
_OVERALL = {
    Judgement.UNBOUNDED: Judgement.FAIL,
    Judgement.NOT_JUDGED: Judgement.INCOMPLETE,
}


#: How the checks that decide are introduced.
_DECISIVE = {
    Judgement.FAIL: "see ",
    Judgement.INCOMPLETE: "not judged, or only in part: ",
    Judgement.WITHIN_ERROR: "by less than its error: ",
}


#: Check that takes the worst of the typed conditions into the verdicts of the case.
CONDITIONS = "Other conditions"
#: Check of the damage in a life.
LIFE = "Life of starts and events"
#: Conditions that a sentence names; table `CaseMatrix` has all.
_NAMED = 2


def verdicts_of(results: Results) -> tuple[Verdict, ...]:
    """All checks, the overall one first; of a case with conditions the worst of them as one check."""
    checks = [*checks_of(results), *_conditions(results.case_verdicts)]
    checks += _asked_by_standard(results.case, checks)
    implausible = "; ".join(one.finding for one in implausible_results(results))
    return with_overall(checks, implausible)


def speed_checks(results: AtSpeed) -> list[Verdict]:
    """The checks of continuous operation."""
    return [_margin(results.margins), *_steady(results.case, results.steady)]


def checks_of(results: Results) -> list[Verdict]:
    """The checks of one run, without what a standard asks for beyond them."""
    case, start = results.case, results.start
    checks = speed_checks(results)
    if calls_for_start(case):
        checks += [
            _outcome(case, start, results.crossings),
            *_peak_torque(case, _peaks(start), _unbounded(results)),
            *_yield(case, _peaks(start), _unbounded(results)),
            *_reversal(case, start, results.reversals, _unbounded(results)),
            *_starts(results),
        ]
    return [*checks, *event_checks(case, results.events), *_life(results)]


def with_overall(checks: Sequence[Verdict], implausible: str = "") -> tuple[Verdict, ...]:
    """Checks with the overall verdict before them; `implausible` says what no train has."""
    verdict, where = Judgement.CHECK_INPUTS, implausible
    if not implausible:
        verdict = overall_verdict(c.verdict for c in checks)
        decisive = [c for c in checks if overall_verdict([c.verdict]) == verdict]
        names = [f"{c.check} ({c.where})" if c.check == CONDITIONS else c.check for c in decisive]
        where = "" if verdict in ACCEPTABLE else f"{_DECISIVE[verdict]}{', '.join(names)}"
    overall = Verdict("Overall", None, None, "text", verdict, where)
    return (overall, *map(_completed, checks))


def _conditions(rows: Sequence[CaseVerdict]) -> Iterator[Verdict]:
    """The worst of the typed conditions, with the names of those that govern, of most such checks first."""
    overall = [row for row in rows if row.check == "Overall"]
    if not overall:
        return
    open_ = [
        row.condition
        for row in overall
        if row.verdict in (Judgement.INCOMPLETE, Judgement.CHECK_INPUTS)
    ]
    # results that no train has are no verdict
    judged = {
        row.condition: Judgement.INCOMPLETE if row.condition in open_ else row.verdict
        for row in overall
    }
    worst = overall_verdict(judged.values())
    deciding = Counter(row.condition for row in rows if overall_verdict([row.verdict]) == worst)
    governing = [name for name, verdict in judged.items() if verdict == worst]
    governing.sort(key=lambda name: -deciding[name])
    where = "" if worst in ACCEPTABLE else _some(governing)
    coverage = _share(overall, open_, "conditions")
    yield Verdict(CONDITIONS, None, None, "text", worst, where, coverage, _some(open_))


def _some(names: Sequence[str]) -> str:
    """The first of some names, and how many more there are."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"{', '.join(names[:_NAMED])}{more}"


def _completed(check: Verdict) -> Verdict:
    """A check with its safety factor, and with None for blanks."""
    return replace(
        check,
        coverage=check.coverage or None,
        not_judged=check.not_judged or None,
        safety_factor=_safety_factor(check),
    )


def _safety_factor(check: Verdict) -> float | None:
    """How many times the governing number goes into its limit; None where nothing is judged, and of margins.

    A torque that does not fall below zero has no factor against reversal.
    """
    result, limit = check.result, check.limit
    if isinstance(result, str | None) or isinstance(limit, str | None):
        return None
    if check.verdict == Judgement.NOT_JUDGED:
        return None
    if check.dimension == "count":
        return result / limit if limit > 0.0 else None
    if check.dimension in ("pressure", "torque") or check.check == LIFE:
        return limit / result if limit * result > 0.0 else None
    return None


def overall_verdict(verdicts: Iterable[Judgement]) -> Judgement:
    """The worst of some verdicts: fail, incomplete, pass within its error, accepted, pass."""
    found = set(verdicts)
    worst = next((v for v in _WORST_FIRST if v in found), Judgement.INCOMPLETE)
    return _OVERALL.get(worst, worst)


# --- what a standard asks for ---------------------------------------------------------------------


@dataclass(frozen=True)
class StandardRow:
    """One thing that the standard asks for, and what was found."""

    requirement: str  #: Its name.
    demand: str  #: What is asked.
    source: str  #: Who asks for it.
    #: Whether the text of the source was read for it.
    text_read: bool
    shown_by: str | None  #: The checks that show it; None where there is none.
    verdict: Judgement  #: The worst of theirs; ``not judged`` where there is none.
    missing: str | None  #: What is not there.


def standard_rows(case: CaseData, checks: Sequence[Verdict]) -> tuple[StandardRow, ...]:
    """What the standard of a case asks of its train, each with the verdict of the checks that show it; none without one.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    checks : sequence of Verdict
        All checks. [SI]

    Returns
    -------
    tuple of StandardRow
        In the order of the profile. [words]
    """
    rows: list[StandardRow] = []
    for r in profile_of(case).requirements if case.standard is not None else ():
        shown = [c for c in checks if c.check.startswith(r.checks)]
        if not shown and r.checks in (RESPONSE, REVERSAL):
            continue  # the train has no part that it could be about
        missing = ""
        if r.checks == EVENTS and (faults := short_circuits_missing(case)):
            missing = (
                f"No {' and no '.join(faults)} in table MotorEvents, and no fault in EventTorque."
            )
        elif not shown:
            missing = "No start is calculated: type MotorTorque or MotorData."
        demand = r.demand
        if r.checks == (MARGIN,) and case.margin_required is not None:
            demand = f"{demand} Here {100.0 * case.margin_required:.4g} % is required: MarginRequired is typed."
        verdict = overall_verdict(c.verdict for c in shown) if shown else Judgement.NOT_JUDGED
        if missing and shown:
            verdict = _covered(verdict, missing)
        names = ", ".join(c.check for c in shown)
        rows.append(
            StandardRow(
                r.requirement, demand, r.source, r.read, names or None, verdict, missing or None
            )
        )
    return tuple(rows)


def _asked_by_standard(case: CaseData, checks: Sequence[Verdict]) -> Iterator[Verdict]:
    """Analyses that the standard asks for and that are not there; nothing where none is chosen.

    What is there has a check of its own, so that this one is about what is missing alone.
    """
    rows = standard_rows(case, checks)
    if not rows:
        return
    lacking = [r for r in rows if r.missing]
    coverage = _share(rows, lacking, "requirements")
    named = "; ".join(f"{r.requirement}: {r.missing}" for r in lacking)
    verdict = Judgement.NOT_JUDGED if lacking else Judgement.PASS
    yield Verdict(
        f"Analyses that {case.standard} asks for", None, None, "text", verdict, "", coverage, named
    )


# --- what a verdict covers ------------------------------------------------------------------------


def _covered(judgement: Judgement, open_: str) -> Judgement:
    """A verdict on a part of what is to be judged."""
    passes = (Judgement.PASS, Judgement.WITHIN_ERROR, Judgement.ACCEPTED)
    return Judgement.INCOMPLETE if open_ and judgement in passes else judgement


def _share(of: Sequence[object], open_: Sequence[object], what: str) -> str:
    """How many of some elements are judged, in words; empty where there are none."""
    return f"{len(of) - len(open_)} of {len(of)} {what}" if of else ""


def _within(value: float, limit: float, error: float = 0.0) -> Judgement:
    """Whether a value is at most its limit; `error` is what it may be larger."""
    if value > limit:
        return Judgement.FAIL
    return Judgement.PASS if value + error <= limit else Judgement.WITHIN_ERROR


# --- continuous operation -------------------------------------------------------------------------


def _badness(verdict: Judgement, reach: float) -> tuple[int, float]:
    """Orders answers: by the worst verdict, then by the unfavourable end over the limit."""
    return -_WORST_FIRST.index(verdict), reach


def _margin(margins: SeparationMargins) -> Verdict:
    name, open_ = "Separation margin", " ".join(margins.warnings)
    if not margins.rows:
        none = open_ or "No excitation meets an elastic mode."
        return Verdict(name, None, None, "fraction", Judgement.NOT_JUDGED, "", not_judged=none)

    def badness(row: MarginRow) -> tuple[int, float]:
        return _WORST_FIRST.index(row.verdict), row.margin

    row = min(margins.rows, key=badness)
    n_modes = len({r.mode for r in margins.rows})
    excitations = len({r.excitation for r in margins.rows})
    where = f"mode {row.mode} ({row.mode_frequency:.4g} Hz) against {row.excitation}"
    return Verdict(
        name,
        row.margin,
        row.required,
        "fraction",
        _covered(row.verdict, open_),
        where,
        f"{n_modes} modes, {excitations} excitations",
        row.not_judged or open_,
    )


def _steady(case: CaseData, steady: SteadyState) -> Iterator[Verdict]:
    unbounded = [r for r in steady.rows if r.verdict == Judgement.UNBOUNDED]
    if unbounded:
        row = unbounded[0]
        where = (
            f"{row.excitation} at {row.frequency:.4g} Hz: undamped resonance, response unbounded"
        )
        yield Verdict(
            "Steady-state response", Judgement.UNBOUNDED, None, "text", Judgement.FAIL, where
        )
    yield from _steady_stress(case, steady)
    yield from _steady_torque(case, steady)


def _open_in_operation(elements: Sequence[ElementRow], steady: SteadyState) -> list[str]:
    """Elements of which a response is not judged, those with the largest torques first."""
    without = {r.element for r in steady.rows if r.verdict == Judgement.NOT_JUDGED}
    known = {r.element for r in steady.rows}
    return [str(e.element) for e in elements if e.element in without or e.element not in known]


def _steady_stress(case: CaseData, steady: SteadyState) -> Iterator[Verdict]:
    """Shafts, and other elements with a stress diameter, against UTS/25."""
    is_range = steady.stress_basis != "zero-to-peak"
    judged = [
        (r, (r.peak_to_peak_stress if is_range else r.zero_to_peak_stress) or 0.0, r.allowable)
        for r in steady.rows
        if r.allowable and r.zero_to_peak_stress is not None
    ]
    check = f"Steady-state stress ({steady.stress_basis})", "pressure", "shafts", "Vibratory limits"
    yield from _response(check, shafts(case), steady, judged)


def _steady_torque(case: CaseData, steady: SteadyState) -> Iterator[Verdict]:
    """Couplings and meshes, and other elements with a Vibratory limit, against it."""
    judged = [
        (r, r.torque, r.torque_limit)
        for r in steady.rows
        if r.torque_limit and r.torque is not None
    ]
    check = "Vibratory torque", "torque", "couplings and meshes", "stresses"
    yield from _response(check, links(case), steady, judged)


def _response(
    check: tuple[str, str, str, str],
    members: Sequence[ElementRow],
    steady: SteadyState,
    judged: Sequence[tuple[SteadyStateRow, float, float]],
) -> Iterator[Verdict]:
    """A forced response: the row that is nearest to its limit, of those judged.

    `check` is its name, dimension, the elements it is for, and what else they may be judged by.
    """
    name, dimension, what, instead = check
    if not members and not judged:
        return
    open_ = _open_in_operation(members, steady)
    coverage, named = _share(members, open_, what), listed(open_)
    if not judged:
        verdict = Judgement.NOT_JUDGED if open_ else Judgement.PASS
        where = "" if open_ else f"all {what} are judged by their {instead}"
        yield Verdict(name, None, None, dimension, verdict, where, coverage, named)
        return

    def badness(one: tuple[SteadyStateRow, float, float]) -> tuple[int, float]:
        row, value, limit = one
        return _badness(_of_response(*one), value * (1.0 + (row.error or 0.0)) / limit)

    worst = max(judged, key=badness)
    row, value, limit = worst
    verdict = _of_response(*worst)
    where = f"{row.element}, {row.excitation} at {row.frequency:.4g} Hz"
    yield Verdict(name, value, limit, dimension, _covered(verdict, named), where, coverage, named)


def _of_response(row: SteadyStateRow, value: float, limit: float) -> Judgement:
    """One response beside its limit."""
    return _within(value, limit * (1.0 + STRESS_ROUNDING), value * (row.error or 0.0))


# --- start ----------------------------------------------------------------------------------------


#: Verdict on each outcome of a start, any other is a fail; an asynchronous end is a matter of
#: pull-in, a trip was asked for: neither is judged here.
OUTCOME_VERDICTS = {
    Outcome.REACHED: Judgement.PASS,
    Outcome.SYNCHRONISED: Judgement.PASS,
    Outcome.COMPLETED: Judgement.PASS,
    Outcome.NOT_SYNCHRONISED: Judgement.FAIL,
    Outcome.TRIPPED: Judgement.NOT_JUDGED,
    Outcome.ASYNCHRONOUS: Judgement.NOT_JUDGED,
}


def _outcome(case: CaseData, start: Start | None, crossings: Sequence[Crossing]) -> Verdict:
    """How the start ended; one that ends below a crossing has not shown that mode."""
    if start is None:
        none = "No start was calculated: type MotorTorque, or TorqueTime."
        return Verdict("Start", None, None, "text", Judgement.NOT_JUDGED, "", not_judged=none)
    o = start.outcome
    verdict, wanted = OUTCOME_VERDICTS.get(o.outcome, Judgement.FAIL), Outcome.REACHED
    if o.outcome == Outcome.COMPLETED:
        wanted = Outcome.COMPLETED
    if case.field_slip is not None and choice_of(case, "pull-in") != "off":
        wanted = Outcome.SYNCHRONISED
        if o.outcome in (Outcome.REACHED, Outcome.ASYNCHRONOUS):
            where = f"{o.sentence} The start did not reach the slip for field application."
            return Verdict("Start", o.outcome, wanted, "text", Judgement.FAIL, where)
    modes = [c for c in crossings if c.percent_speed is not None]
    missed = _missed(crossings)
    open_ = listed(
        [f"mode {c.mode} ({c.frequency:.4g} Hz) at {c.percent_speed:.1f} % speed" for c in missed]
    )
    open_ = open_ and f"not crossed, the start ends before: {open_}"
    coverage = _share(modes, missed, "crossings")
    return Verdict(
        "Start", o.outcome, wanted, "text", _covered(verdict, open_), o.sentence, coverage, open_
    )


def _missed(crossings: Sequence[Crossing]) -> list[Crossing]:
    """Modes that the pulsation would cross at a higher speed than the start came to."""
    return [c for c in crossings if c.percent_speed is not None and c.time is None]


#: Peaks by event and element; the event of a start is empty. [N m]
Peaks = Mapping[tuple[str, str], ElementPeak]


def _peaks(start: Start | None, event: str = "") -> dict[tuple[str, str], ElementPeak]:
    return {} if start is None else {(event, p.element): p for p in start.peaks}


def _peak_verdict(size: float, limit: float, peak: ElementPeak) -> Judgement:
    """Whether a peak, in any dimension, keeps its limit up to the unfavourable end of its range."""
    if peak.high is None or peak.size == 0.0:
        return Judgement.FAIL if size > limit else Judgement.PASS
    return _within(size, limit, size * (peak.high / peak.size - 1.0))


def event_verdict(limit: float, peak: ElementPeak) -> Judgement:
    """Verdict on one element in one event in operation.

    Parameters
    ----------
    limit : float
        Least torque that an element is judged by; infinite without one. [N m]
    peak : ElementPeak
        Its peak. [N m]

    Returns
    -------
    Judgement
        fail, pass, pass within its error; incomplete without a bound, not judged without a limit.
    """
    if math.isinf(limit):
        return Judgement.NOT_JUDGED
    return _covered(_peak_verdict(peak.size, limit, peak), "no bound" if peak.high is None else "")


def _unbounded(results: Results) -> str:
    """What a start leaves out with no bound on its effect, in words; empty where all is bounded."""
    start, plan = results.start, results.plans[-1]
    if start is None or start.left_out is not None:
        return ""
    names = [name for name in plan.left_out if plan.decision(name).bound is None]
    return f"no bound on what is left out: {', '.join(names) or 'fast modes'}"


def _and(named: str, unbounded: str) -> str:
    return "; ".join(filter(None, (named, unbounded)))


def _with_peaks(case: CaseData, peaks: Peaks, names: Iterable[str]) -> list[str]:
    """Elements with their peak torque over the rated one where that is known, the largest first."""
    rated, ratios = case.ratings.rated_torque, case.element_speed_ratios
    sizes = dict.fromkeys(names, 0.0)
    known = {element for _, element in peaks}
    for (_, element), peak in peaks.items():
        if element in sizes:
            sizes[element] = max(sizes[element], peak.size * ratios[element])
    ordered = sorted(sizes, key=lambda name: -sizes[name])
    if not rated:
        return ordered
    return [
        f"{name}, peak {sizes[name] / rated:.2f} × rated" if name in known else name
        for name in ordered
    ]


def _peak_torque(
    case: CaseData, peaks: Peaks, unbounded: str, name: str = "Peak torque"
) -> Iterator[Verdict]:
    """Couplings and meshes, and other elements with a Peak torque limit, against it."""
    members = links(case)
    limits = {str(e.element): e.peak_torque_limit for e in case.elements if e.peak_torque_limit}
    sizes = {key: (p.size, limits[key[1]]) for key, p in peaks.items() if key[1] in limits}
    if not members and not sizes:
        return
    open_ = without_peak_limit(case)
    coverage = _share(members, open_, "couplings and meshes")
    named = listed(_with_peaks(case, peaks, open_))
    if not sizes:
        yield Verdict(name, None, None, "torque", Judgement.NOT_JUDGED, "", coverage, named)
        return
    yield _worst_peak(name, "torque", sizes, peaks, coverage, _and(named, unbounded))


def yield_torque(case: CaseData) -> dict[str, tuple[float, float]]:
    """Nominal stress of one newton metre, and half the tensile yield (maximum shear theory).

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    dict of str to (float, float)
        By element with a Stress diameter and a Material with Yield. [Pa/(N m), Pa]
    """
    strength = {m.material: m.yield_ for m in case.materials if m.yield_}
    return {
        str(e.element): (stress_of_unit_torque(e), 0.5 * float(strength[e.material] or 0.0))
        for e in case.elements
        if e.stress_diameter and e.material in strength
    }


def _yield(
    case: CaseData, peaks: Peaks, unbounded: str, name: str = "Shear yield in the start"
) -> Iterator[Verdict]:
    """Nominal stress against half the tensile yield."""
    members, judged = shafts(case), yield_torque(case)
    sizes = {
        key: (judged[key[1]][0] * p.size, judged[key[1]][1])
        for key, p in peaks.items()
        if key[1] in judged
    }
    if not members and not sizes:
        return
    open_ = without_yield(case)
    coverage = _share(members, open_, "shafts")
    named = listed(_with_peaks(case, peaks, open_))
    if not sizes:
        verdict = Judgement.NOT_JUDGED if not peaks or open_ else Judgement.PASS
        where = "every shaft is judged by its Peak torque limit" if verdict == "pass" else ""
        yield Verdict(name, None, None, "pressure", verdict, where, coverage, named)
        return
    yield _worst_peak(name, "pressure", sizes, peaks, coverage, _and(named, unbounded))


def _worst_peak(
    name: str,
    dimension: str,
    sizes: Mapping[tuple[str, str], tuple[float, float]],
    peaks: Peaks,
    coverage: str,
    named: str,
) -> Verdict:
    """The element of the worst verdict, of these the nearest to its limit at the unfavourable end of its range.

    `sizes` has the peak and its limit of each element, in torque or stress.
    """
    found = {key: _peak_verdict(*pair, peaks[key]) for key, pair in sizes.items()}

    def badness(key: tuple[str, str]) -> tuple[int, float]:
        size, limit = sizes[key]
        reach = (peaks[key].high or peaks[key].size) / (peaks[key].size or 1.0)
        return _badness(found[key], reach * size / limit)

    worst = max(found, key=badness)
    size, limit = sizes[worst]
    verdict = _covered(found[worst], named)
    event, element = worst
    where = f"{element} in {event}" if event else element
    return Verdict(name, size, limit, dimension, verdict, where, coverage, named)


def event_checks(case: CaseData, events: Sequence[OperatingEvent]) -> Iterator[Verdict]:
    """Peaks of every event in operation, and the events that were not calculated."""
    if not events:
        return
    missing = [e for e in events if e.response is None]
    if missing:
        yield Verdict(
            "Events in operation", None, None, "text", Judgement.NOT_JUDGED, "",
            _share(events, missing, "events"), " ".join(e.note for e in missing),
        )  # fmt: skip
    if len(missing) == len(events):
        return
    peaks = {key: p for e in events for key, p in _peaks(e.response, e.name).items()}
    unbounded = " ".join(e.note for e in events if e.response and e.response.left_out is None)
    yield from _peak_torque(case, peaks, unbounded, "Peak torque in events")
    yield from _yield(case, peaks, unbounded, "Shear yield in events")


def _reversal(
    case: CaseData, start: Start | None, reversals: Sequence[Reversal], unbounded: str
) -> Iterator[Verdict]:
    """Gear meshes and geared couplings against their Reversal limit, on the unfavourable end of the range."""
    wanted, name = reversing_elements(case), "Torque reversal"
    if not wanted:
        return
    if start is None or not reversals:
        names = [str(case.elements[i].element) for i in wanted]
        coverage = _share(wanted, wanted, "meshes and geared couplings")
        verdict = Judgement.NOT_JUDGED
        yield Verdict(name, None, None, "torque", verdict, "", coverage, listed(names))
        return

    lowest_of = lowest_torques(start)
    judged = {
        r.element: Judgement.WITHIN_ERROR
        if r.verdict == Judgement.PASS and lowest_of[r.element] < -(r.limit or r.hysteresis)
        else r.verdict
        for r in reversals
    }

    def badness(r: Reversal) -> tuple[int, float]:
        return _WORST_FIRST.index(judged[r.element]), r.minimum_torque / (r.limit or 1.0)

    row = min(reversals, key=badness)
    open_ = [r.element for r in reversals if r.verdict == Judgement.NOT_JUDGED]
    lowest = None if row.limit is None else -row.limit
    verdict = judged[row.element]
    if verdict == Judgement.NOT_JUDGED and len(open_) < len(reversals):
        verdict = Judgement.INCOMPLETE
    coverage = _share(reversals, open_, "meshes and geared couplings")
    named = _and(listed(open_), unbounded)
    if unbounded:
        verdict = _covered(verdict, named)
    yield Verdict(
        name, row.minimum_torque, lowest, "torque", verdict, row.sentence, coverage, named
    )


def _starts(results: Results) -> Iterator[Verdict]:
    """Allowable starts of the judged shafts against StartsRequired."""
    case, start, starts = results.case, results.start, results.starts
    members = shafts(case)
    judged = [] if starts is None else [s.element for s in starts.shafts]
    if not members and not judged:
        return
    required = case.starts_required
    open_ = without_sn_points(case)
    coverage = _share(members, open_, "shafts")
    missing = [listed(_with_peaks(case, _peaks(start), open_))] if open_ else []
    result: float | str | None = None
    verdict, where = Judgement.NOT_JUDGED, ""
    if start is None or starts is None or not judged:
        pass
    elif start.outcome.outcome not in WHOLE_STARTS:
        where = f"incomplete start: {start.outcome.outcome}"
    else:
        verdict = Judgement.PASS
        if starts.judged_starts is None:
            result, where = NoNumber.UNLIMITED.value, ""
        else:
            result, where = starts.judged_starts, starts.governing or ""
            if required is not None and result < required:
                verdict = Judgement.FAIL
        fewest = starts.starts_low
        if required is not None and fewest is not None and verdict != Judgement.FAIL:
            least = fewest / starts.starts_factor
            verdict = Judgement.PASS if least >= required else Judgement.WITHIN_ERROR
        where = "; ".join(filter(None, (where, _undamaged(starts))))
        if not starts.bounded:
            missing.append(_unbounded(results))
        if _missed(results.crossings):
            missing.append("modes that the start did not cross")
        if required is None:
            verdict = Judgement.NOT_JUDGED
            missing.append("StartsRequired is blank")
        above = [s.element for s in starts.shafts if s.above_first_point]
        if above and verdict != Judgement.FAIL:
            verdict = Judgement.NOT_JUDGED
            missing.append(f"cycles above the first S-N point: {above[0]}")
        broken = [s.element for s in starts.shafts if s.above_ultimate]
        if broken and verdict != Judgement.FAIL:
            verdict = Judgement.NOT_JUDGED
            missing.append(f"mean stress above the ultimate strength: {broken[0]}")
    named = "; ".join(missing)
    yield Verdict(
        "Allowable starts",
        result,
        required,
        "count",
        _covered(verdict, named),
        where,
        coverage,
        named,
    )


def _life(results: Results) -> Iterator[Verdict]:
    """Damage of the required starts and of all events in a life, where the events are counted (Palmgren-Miner)."""
    case, start, starts = results.case, results.start, results.starts
    counts, members = results.case.events_per_life, shafts(results.case)
    counted = [e for e in results.events if counts.get(e.name)]
    if not counted or not members:
        return
    name, allowed = LIFE, 1.0 / (case.starts_factor or 1.0)
    open_ = without_sn_points(case)
    coverage = _share(members, open_, "shafts")
    missing = [listed(open_)] if open_ else []
    lost = [f"event {e.name} is not calculated" for e in counted if e.response is None]
    unbounded = [e.note for e in counted if e.response and e.response.left_out is None]
    parts = [(e.shafts, dict(e.damage_errors), counts[e.name]) for e in counted]
    if case.starts_required is None:
        missing.append("starts: StartsRequired is blank")
    elif starts is None or not is_counted(start):
        lost.append("the start is not judged")
    else:
        parts.append((starts.shafts, dict(results.starts_error), case.starts_required))
        if not starts.bounded:
            missing.append(_unbounded(results))
    used: dict[str, float] = {}
    most: dict[str, float] = {}  # at the unfavourable end of the errors
    doubtful = []
    for judged, errors, times in parts:
        for s in judged:
            high = max(s.damage_high, s.damage * (1.0 + (errors[s.element] or 0.0)))
            used[s.element] = used.get(s.element, 0.0) + times * s.damage
            most[s.element] = most.get(s.element, 0.0) + times * high
            if s.above_first_point or s.above_shear_yield or s.above_ultimate:
                doubtful.append(s.element)
    if doubtful:
        missing.append(f"beyond the S-N line or shear yield: {listed([*dict.fromkeys(doubtful)])}")
    named = "; ".join((*lost, *missing, *unbounded))
    if lost or not used:
        yield Verdict(name, None, allowed, "fraction", Judgement.NOT_JUDGED, "", coverage, named)
        return
    worst = max(most, key=most.__getitem__)
    verdict = _covered(_within(used[worst], allowed, most[worst] - used[worst]), named)
    yield Verdict(name, used[worst], allowed, "fraction", verdict, worst, coverage, named)


def _undamaged(starts: AllowableStarts) -> str:
    """Shafts without damage, and how near to the endurance limit they come; empty if there are none."""
    without = [s for s in starts.shafts if s.damage == 0.0]
    shares = [s.largest_amplitude / s.endurance for s in without if s.endurance]
    if not without:
        return ""
    names = listed([s.element for s in without])
    reach = f" (amplitude at most {max(shares):.0%} of the endurance limit)" if shares else ""
    return f"no damage: {names}{reach}"
