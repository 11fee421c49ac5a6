"""Damage ledger: what a duty has used of each shaft's life, and what is left.

Palmgren-Miner over start conditions: Σ nᵢ qᵢ, with qᵢ the damage of one start under condition i from the start
matrix, nᵢ how many. Events in operation are conditions like any other; those that are counted for the whole life are taken from what is
left at once. The order of starts is ignored, as the rule does; residual stress and the
sequence effect of large starts before small ones are not in it.

A shaft may be used up to 1/StartsFactor. That is the same as dividing allowable starts by the factor
before they are judged (contract): with one start condition alone, (1/F − n q)/q = (1/q)/F − n.

A start condition that has a duty and is not judged (it was not completed, or was not calculated)
leaves a gap that no other number fills: the shaft is then not judged, with the reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

from engine.case.result_words import Judgement, NoNumber
from engine.studies.starts.condition_result import ConditionResult, ConditionShaft
from engine.studies.starts.conditions import StartCondition
from engine.studies.starts.matrix import StartMatrix


@dataclass(frozen=True)
class LedgerRow:
    """What a duty does to one judged shaft. Every sum is None where it is not judged."""

    element: str  #: Row of `Elements`.
    used: float | None  #: Damage so far, Σ so far × damage, and the ends of its error. [1]
    used_low: float | None  #: Likewise. [1]
    used_high: float | None  #: Likewise. [1]
    yearly: float | None  #: Damage a year, Σ per year × damage, and the ends of its error. [1/year]
    yearly_low: float | None  #: Likewise. [1/year]
    yearly_high: float | None  #: Likewise. [1/year]
    #: Damage of the events in a life, Σ per life × damage, and the ends of its error. [1]
    events: float | None
    events_low: float | None  #: Likewise. [1]
    events_high: float | None  #: Likewise. [1]
    allowed: float  #: 1/StartsFactor. [1]
    left: float | None  #: Allowed minus used, minus events; negative where it is overdrawn. [1]
    #: Left over yearly, 0 where nothing is left; None = unlimited, or no duty a year. [year]
    remaining_years: float | None
    years_low: float | None  #: Its interval; None = unlimited. [year]
    years_high: float | None  #: Likewise. [year]
    #: There is a duty per year, life is left, and no start condition of the duty causes damage.
    unlimited: bool
    governing: str | None  #: Kind of start that takes most a year, else took most so far.
    verdict: Judgement  #: ``pass``: something is left; ``fail``: nothing is; ``not judged``.
    reason: str  #: Why, with the numbers.


@dataclass(frozen=True)
class RemainingStarts:
    """How many starts of one kind, and no other, are left for one shaft."""

    element: str  #: Row of `Elements`.
    condition: str  #: Kind of start.
    #: Nominal, in one such start; None where it was not calculated. [Pa]
    peak_to_peak_stress: float | None
    #: Of one such start, and the ends of its error; None where it was not calculated. [1]
    damage: float | None
    damage_low: float | None  #: Likewise. [1]
    damage_high: float | None  #: Likewise. [1]
    so_far: float  #: Its duty. [count, 1/year]
    per_year: float  #: Likewise. [count, 1/year]
    per_life: float  #: Of an event. [count]
    share: float | None  #: Of the yearly damage; None where that is not judged or zero. [1]
    #: Left over damage, 0 where nothing is left; None = unlimited or not judged. [1]
    remaining_starts: float | None
    unlimited: bool  #: It does not damage, and something is left.
    judged: bool  #: Whether there is an answer.
    reason: str  #: Why there is none.


@dataclass(frozen=True)
class DamageLedger:
    """The ledger of a train."""

    rows: tuple[LedgerRow, ...]  #: One a judged shaft. [rows]
    remaining: tuple[RemainingStarts, ...]  #: One per judged shaft and start condition. [rows]
    verdict: Judgement  #: The worst of the shafts.
    sentence: str  #: What it comes to.
    assumption: str  #: The rule behind it.


ASSUMPTION = (
    "Palmgren-Miner: damage of all starts is summed regardless of order; the life of a "
    "shaft ends at damage 1/StartsFactor = {allowed:.4g}."
)


#: What of a shaft makes a pass doubtful, by its attribute.
_DOUBTS = {
    "extended": "Cycles above the first S-N point in '{}': life extrapolated, not test data.",
    "yields": "Nominal peak above shear yield in '{}': its damage, from elastic stress, is invalid.",
}
#: Verdicts, the worse the later.
_WORSE = (Judgement.PASS, Judgement.NOT_JUDGED, Judgement.FAIL)


def damage_ledger(matrix: StartMatrix) -> DamageLedger:
    """What the duty of a start matrix has used, uses a year, and leaves.

    Parameters
    ----------
    matrix : StartMatrix
        Its start conditions with their damage and duty. [SI]

    Returns
    -------
    DamageLedger
        One row a judged shaft. [1, year]
    """
    allowed = 1.0 / matrix.starts_factor
    assumption = ASSUMPTION.format(allowed=allowed)
    if not matrix.judged_shafts:
        sentence = (
            "No damage ledger: no shaft has stress diameter, material and S-N points. Type them "
            "on sheets Train and Fatigue."
        )
        return DamageLedger((), (), Judgement.NOT_JUDGED, sentence, assumption)
    rows = tuple(_row(matrix.rows, name, allowed) for name in matrix.judged_shafts)
    remaining = tuple(
        _remaining(result, row, matrix.rows) for row in rows for result in matrix.rows
    )
    verdict = max((r.verdict for r in rows), key=_WORSE.index)
    return DamageLedger(rows, remaining, verdict, " ".join(_words(rows)), assumption)


def _sum(results: Sequence[ConditionResult], name: str, number: str, damage: str) -> float:
    """Σ number × damage over the start conditions that have a number; exact whatever their order."""
    terms = []
    for r in results:
        shaft, times = r.shaft(name), getattr(r.condition, number)
        if times > 0.0 and shaft is not None:
            terms.append(times * getattr(shaft, damage))
    return math.fsum(terms)


def _row(results: Sequence[ConditionResult], name: str, allowed: float) -> LedgerRow:
    duty = [r for r in results if r.condition.has_duty]
    gaps = [why for r in duty if (why := _why_not(r, name))]
    if gaps or not duty:
        reason = " ".join(gaps) or (
            "No duty: type Per year and So far in StartConditions to calculate the life left."
        )
        return LedgerRow(
            name, *(None,) * 9, allowed, *(None,) * 4, False, None, Judgement.NOT_JUDGED, reason
        )  # fmt: skip
    damages = ("damage", "damage_low", "damage_high")
    used, used_low, used_high = (_sum(duty, name, "so_far", damage) for damage in damages)
    yearly, yearly_low, yearly_high = (_sum(duty, name, "per_year", damage) for damage in damages)
    events, events_low, events_high = (_sum(duty, name, "per_life", damage) for damage in damages)
    taken, least, most = used + events, used_low + events_low, used_high + events_high
    life_left = allowed - taken
    years = remaining_life(life_left, yearly)
    starts_yearly = any(r.condition.per_year > 0.0 for r in duty)
    unlimited = starts_yearly and life_left > 0.0 and yearly == 0.0
    verdict, reason = _verdict(duty, name, allowed, taken, (least, most), starts_yearly)
    return LedgerRow(
        element=name,
        used=used,
        used_low=used_low,
        used_high=used_high,
        yearly=yearly,
        yearly_low=yearly_low,
        yearly_high=yearly_high,
        events=events,
        events_low=events_low,
        events_high=events_high,
        allowed=allowed,
        left=life_left,
        remaining_years=years,
        years_low=remaining_life(allowed - most, yearly_high),
        years_high=remaining_life(allowed - least, yearly_low),
        unlimited=unlimited,
        governing=_governing(duty, name, yearly > 0.0),
        verdict=verdict,
        reason=reason,
    )


def remaining_life(left: float, taken: float) -> float | None:
    """How often what is left can be taken: years, or starts of one kind.

    Parameters
    ----------
    left : float
        What is left of 1/StartsFactor. [1]
    taken : float
        Damage a year, or of one start. [1]

    Returns
    -------
    float or None
        Left over taken, 0 where nothing is left; None = unlimited, as nothing is taken. [1]
    """
    if left <= 0.0:
        return 0.0
    if taken == 0.0 or math.isinf(left / taken):
        return None
    return left / taken


def _why_not(result: ConditionResult, name: str) -> str:
    """Why a start condition has no damage that can be counted; empty where it has."""
    shaft = result.shaft(name)
    if shaft is not None and shaft.judged:
        return ""
    kind = f"'{result.condition.name}'"
    if shaft is None:
        return f"{kind} was not calculated. {result.note}".strip()
    return f"{kind} has a duty, but is not judged ({result.words}). {result.note}".strip()


def _verdict(
    duty: Sequence[ConditionResult],
    name: str,
    allowed: float,
    taken: float,
    interval: tuple[float, float],
    starts_yearly: bool,
) -> tuple[Judgement, str]:
    low, high = interval
    reserved = " with the events of a life" if any(r.condition.per_life for r in duty) else ""
    sentences = [f"Used so far{reserved} {taken:.4g} of {allowed:.4g}."]
    verdict = Judgement.PASS if taken < allowed else Judgement.FAIL
    if verdict == Judgement.FAIL:
        sentences.append("No life left: by this calculation the train must not be started again.")
    if (low < allowed) != (high < allowed):
        sentences.append(
            f"Within the error of the calculation the damage is between {low:.4g} and {high:.4g}, "
            "so the verdict is uncertain. Tighten ToleranceStarts."
        )
    for attribute, words in _DOUBTS.items():
        names = [r.condition.name for r in duty if (s := r.shaft(name)) and getattr(s, attribute)]
        if names:
            sentences.append(words.format(names[0]))
            verdict = Judgement.NOT_JUDGED if verdict == Judgement.PASS else verdict
    if not starts_yearly:
        sentences.append("Per year is blank or 0: years left are not calculated.")
    return verdict, " ".join(sentences)


def _governing(duty: Sequence[ConditionResult], name: str, by_year: bool) -> str | None:
    def times(c: StartCondition) -> float:
        return c.per_year if by_year else c.so_far + c.per_life

    shares = {
        r.condition.name: times(r.condition) * s.damage
        for r in duty
        if (s := r.shaft(name)) is not None
    }
    worst = max(shares, key=lambda k: shares[k], default=None)
    return worst if worst is not None and shares[worst] > 0.0 else None


def _remaining(
    result: ConditionResult, row: LedgerRow, results: Sequence[ConditionResult]
) -> RemainingStarts:
    """Starts of one kind; without any duty, of an unused shaft."""
    shaft, condition = result.shaft(row.element), result.condition
    no_duty = not any(r.condition.has_duty for r in results)
    damage_left = row.allowed if no_duty else row.left
    reason = _why_unjudged(result, shaft, damage_left)
    judged = not reason
    damage = None if shaft is None else shaft.damage
    share = None
    if row.yearly and damage is not None:
        share = condition.per_year * damage / row.yearly
    years = remaining_life(damage_left or 0.0, damage or 0.0) if judged else None
    return RemainingStarts(
        element=row.element,
        condition=condition.name,
        peak_to_peak_stress=None if shaft is None else shaft.peak_to_peak_stress,
        damage=damage,
        damage_low=None if shaft is None else shaft.damage_low,
        damage_high=None if shaft is None else shaft.damage_high,
        so_far=condition.so_far,
        per_year=condition.per_year,
        per_life=condition.per_life,
        share=share,
        remaining_starts=years,
        unlimited=judged and years is None,
        judged=judged,
        reason=reason,
    )


def _why_unjudged(result: ConditionResult, shaft: ConditionShaft | None, left: float | None) -> str:
    if shaft is None:
        return result.note or "This start condition was not calculated."
    if not shaft.judged:
        return f"Not judged: {result.words}."
    return "" if left is not None else "The life left is not judged."


def _words(rows: Sequence[LedgerRow]) -> Iterator[str]:
    for row in rows:
        if row.used is None:
            yield f"{row.element}: not judged. {row.reason}"
            continue
        if row.left is not None and row.left <= 0.0:
            yield f"{row.element}: life exhausted. {row.reason}"
        elif row.unlimited:
            yield f"{row.element}: no start condition of this duty causes damage."
        elif row.remaining_years is not None:
            yield (
                f"{row.element}: {_share_used(row)}; the remaining life "
                f"is {_quantity(row.remaining_years)} years{_interval(row)}, consumed mostly by "
                f"'{row.governing}'."
            )
        else:
            yield f"{row.element}: {_share_used(row)}."
        if row.verdict == Judgement.NOT_JUDGED:
            yield f"Not judged: {row.reason}"


def _share_used(row: LedgerRow) -> str:
    words = f"{(row.used or 0.0) / row.allowed:.1%} of its life is used"
    return f"{words}, {row.events / row.allowed:.1%} is kept for events" if row.events else words


def _interval(row: LedgerRow) -> str:
    low = _quantity(row.years_low or 0.0)
    high = NoNumber.UNLIMITED if row.years_high is None else _quantity(row.years_high)
    return "" if low == high else f" ({low} to {high} within the error of the calculation)"


def _quantity(number: float) -> str:
    """Three digits, and no exponent up to a million; no life is rounded up."""
    if number == 0.0:
        return "0"
    digits = 2 - math.floor(math.log10(number))
    down = math.floor(number * 10.0**digits) / 10.0**digits
    return f"{down:,.0f}" if digits <= 0 and down < 1e7 else f"{down:.3g}"


# --- tables ---------------------------------------------------------------------------------------


def ledger_rows(ledger: DamageLedger) -> list[dict[str, object]]:
    """Rows of `DamageLedger`, one a judged shaft.

    Parameters
    ----------
    ledger : DamageLedger
        The ledger. [1, year]

    Returns
    -------
    list of dict
        Under their JSON keys. [1, year]
    """
    return [_said_or_not(asdict(row), row.remaining_years is not None) for row in ledger.rows]


def remaining_rows(ledger: DamageLedger) -> list[dict[str, object]]:
    """Rows of `RemainingStarts`, one per judged shaft and start condition.

    Parameters
    ----------
    ledger : DamageLedger
        The ledger. [1]

    Returns
    -------
    list of dict
        Under their JSON keys. [1]
    """
    return [_said_or_not(asdict(row), row.judged) for row in ledger.remaining]


def _said_or_not(row: dict[str, object], has_answer: bool) -> dict[str, object]:
    """A row that says whether it is unlimited only where there is an answer."""
    if not has_answer and not row["unlimited"]:
        del row["unlimited"]
    return row
