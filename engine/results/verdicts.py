"""The checks at a glance: margin, steady-state stress, start, peaks, reversal, yield, starts.

Each verdict is ``pass``, ``accepted by forced response``, ``fail`` or ``not judged``; the worst
of them is the first row.
"""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.case.result_words import Judgement, NoNumber, Outcome
from engine.fatigue.allowable_starts import AllowableStarts
from engine.operation.margins import SeparationMargins
from engine.operation.steady_state import SteadyState
from engine.results.results import Results, Verdict
from engine.start.reversals import Reversal
from engine.start.start import Start
from engine.start.start_fatigue import WHOLE_STARTS


def verdicts_of(results: Results) -> tuple[Verdict, ...]:
    """All checks, the overall one first."""
    case, start, starts = results.case, results.start, results.starts
    checks = [_margin(results.margins), *_steady(results.steady)]
    if start is not None:
        checks += [_outcome(case, start), *_peak_limits(case, start)]
    checks += [_reversal(r) for r in results.reversals]
    checks += [*_yield(case, starts), _starts(case, start, starts)]
    judgements = {c.verdict for c in checks}
    worst = next(
        (v for v in (Judgement.FAIL, Judgement.ACCEPTED, Judgement.PASS) if v in judgements),
        Judgement.NOT_JUDGED,
    )
    failing = ", ".join(c.check for c in checks if c.verdict == Judgement.FAIL)
    where = f"see {failing}" if failing else ""
    return (Verdict("Overall", None, None, "text", worst, where), *checks)


def _within(value: float, limit: float) -> Judgement:
    return Judgement.PASS if value <= limit else Judgement.FAIL


def _margin(margins: SeparationMargins) -> Verdict:
    name = "Separation margin"
    if not margins.rows:
        return Verdict(name, None, None, "fraction", Judgement.NOT_JUDGED, "")
    order: dict[str, int] = {Judgement.FAIL: 0, Judgement.ACCEPTED: 1, Judgement.PASS: 2}
    row = min(margins.rows, key=lambda r: (order.get(r.verdict, 0), r.margin))
    where = f"mode {row.mode} ({row.mode_frequency:.4g} Hz) against {row.excitation}"
    return Verdict(name, row.margin, row.required, "fraction", row.verdict, where)


def _steady(steady: SteadyState) -> Iterator[Verdict]:
    judged = [r for r in steady.rows if r.allowable is not None]
    if any(r.verdict == Judgement.UNBOUNDED for r in steady.rows):
        row = next(r for r in steady.rows if r.verdict == Judgement.UNBOUNDED)
        where = (
            f"{row.excitation} at {row.frequency:.4g} Hz: undamped resonance, response unbounded"
        )
        yield Verdict(
            "Steady-state response", Judgement.UNBOUNDED, None, "text", Judgement.FAIL, where
        )
    finite = [r for r in judged if r.zero_to_peak_stress is not None]
    if finite:
        row = max(finite, key=lambda r: (r.peak_to_peak_stress or 0.0) / (r.allowable or 1.0))
        peak = row.peak_to_peak_stress
        if steady.stress_basis == "zero-to-peak":
            peak = row.zero_to_peak_stress
        where = f"{row.element}, {row.excitation} at {row.frequency:.4g} Hz"
        where += f" ({len({r.element for r in judged})} of {len({r.element for r in steady.rows})} "
        where += "elements have a stress diameter and UTS)"
        name = f"Steady-state stress ({steady.stress_basis})"
        yield Verdict(name, peak, row.allowable, "pressure", row.verdict, where)
    limited = [r for r in steady.rows if r.torque_limit is not None and r.torque is not None]
    if limited:
        row = max(limited, key=lambda r: (r.torque or 0.0) / (r.torque_limit or 1.0))
        where = f"{row.element}, {row.excitation} at {row.frequency:.4g} Hz"
        verdict = _within(row.torque or 0.0, row.torque_limit or 0.0)
        yield Verdict("Vibratory torque", row.torque, row.torque_limit, "torque", verdict, where)


#: Verdict on each outcome of a start, any other is a fail; an asynchronous end is a matter of
#: pull-in, a trip was asked for: neither is judged here.
OUTCOME_VERDICTS = {
    Outcome.REACHED: Judgement.PASS,
    Outcome.SYNCHRONISED: Judgement.PASS,
    Outcome.NOT_SYNCHRONISED: Judgement.FAIL,
    Outcome.TRIPPED: Judgement.NOT_JUDGED,
    Outcome.ASYNCHRONOUS: Judgement.NOT_JUDGED,
    Outcome.COMPLETED: Judgement.NOT_JUDGED,
}


def _outcome(case: CaseData, start: Start) -> Verdict:
    o = start.outcome
    verdict, wanted = OUTCOME_VERDICTS.get(o.outcome, Judgement.FAIL), Outcome.REACHED
    if case.field_slip is not None and choice_of(case, "pull-in") != "off":
        wanted = Outcome.SYNCHRONISED
        if o.outcome in (Outcome.REACHED, Outcome.ASYNCHRONOUS):
            where = f"{o.sentence} The start did not reach the slip for field application."
            return Verdict("Start", o.outcome, wanted, "text", Judgement.FAIL, where)
    return Verdict("Start", o.outcome, wanted, "text", verdict, o.sentence)


def _peak_limits(case: CaseData, start: Start) -> Iterator[Verdict]:
    limits = {e.element: e.peak_torque_limit for e in case.elements if e.peak_torque_limit}
    rows = [(p.size, limits[p.element], p.element) for p in start.peaks if p.element in limits]
    if rows:
        torque, limit, element = max(rows, key=lambda r: r[0] / (r[1] or 1.0))
        verdict = _within(torque, limit or 0.0)
        yield Verdict("Peak torque", torque, limit, "torque", verdict, element)


def _reversal(r: Reversal) -> Verdict:
    lowest = None if r.limit is None else -r.limit
    return Verdict("Torque reversal", r.minimum_torque, lowest, "torque", r.verdict, r.sentence)


def _yield(case: CaseData, starts: AllowableStarts | None) -> Iterator[Verdict]:
    strength = {m.material: m.yield_ for m in case.materials}
    material = {e.element: e.material for e in case.elements}
    rows = []
    for shaft in starts.shafts if starts else ():
        limit = strength.get(material.get(shaft.element))
        if limit:
            rows.append((shaft.peak_nominal_stress, 0.5 * limit, shaft.element))
    if rows:
        stress, limit, element = max(rows, key=lambda r: r[0] / r[1])
        verdict = _within(stress, limit)
        yield Verdict("Shear yield in the start", stress, limit, "pressure", verdict, element)


def _starts(case: CaseData, start: Start | None, starts: AllowableStarts | None) -> Verdict:
    required = case.starts_required
    result: float | str | None = None
    verdict, where = Judgement.NOT_JUDGED, ""
    if start is None or starts is None or not starts.shafts:
        pass
    elif start.outcome.outcome not in WHOLE_STARTS:
        where = f"incomplete start: {start.outcome.outcome}"
    elif starts.judged_starts is None:
        result = NoNumber.UNLIMITED.value
        if required is not None:
            verdict = Judgement.PASS
    else:
        result, where = starts.judged_starts, starts.governing or ""
        if required is not None:
            verdict = _within(required, starts.judged_starts)
        above = [s.element for s in starts.shafts if s.above_first_point]
        if above and verdict == Judgement.PASS:
            verdict = Judgement.NOT_JUDGED
            where = f"{where}; cycles above the first S-N point: {above[0]}"
    return Verdict("Allowable starts", result, required, "count", verdict, where)
