"""Which combination is better, and why: the order of a tuning study, and its reasons in words.

An engineer lets a limit that is broken outweigh any gain elsewhere, and among designs that keep
their limits places the modes where the start hurts least (the paper, "Philosophy of resonant response
location"). So, one after the other:

1. cases that can be calculated before those that cannot;
2. completed starts before those that stall or run out of time;
3. fewer broken limits (verdicts that fail, and rated torques that are exceeded);
4. separation margins kept by themselves, before those accepted by forced response;
5. more allowable starts, unlimited before any number; where no start is counted, the smaller peak
   torque;
6. the wider of the worst margins;
7. the smaller peak torque;
8. what is left is equal: it is ordered by the names and values chosen, never by the order of rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from engine.case.result_words import Judgement
from engine.case.study_inputs import DisplayUnit
from engine.fatigue.damage import starts_in_words
from engine.start.crossings import Crossing
from engine.studies.tuning.evaluate import EvaluatedCombination, KeyAnswers
from engine.studies.tuning.options import Variable

#: The check of separation margins, as `engine.results.verdicts` names it.
MARGIN_CHECK = "Separation margin"
_MEGAPASCAL, _NEWTON_METRE = DisplayUnit("MPa", 1e6), DisplayUnit("N m", 1.0)
#: Changes smaller than this share are reported as "as is". [1]
SAME = 0.005
#: Margins kept by themselves, or those that are known; accepted; not kept and not wholly judged; not
#: kept. Without excitations all are alike.
_MARGIN_TIERS: dict[str, int] = {
    Judgement.PASS: 0,
    Judgement.WITHIN_ERROR: 0,
    Judgement.INCOMPLETE: 0,
    Judgement.ACCEPTED: 1,
    Judgement.NOT_JUDGED: 2,
    Judgement.FAIL: 3,
}

Merit = tuple[float, ...]


def merit(tried: EvaluatedCombination) -> Merit:
    """What a combination is ranked by, the smaller the better; see the order above.

    Parameters
    ----------
    tried : EvaluatedCombination
        A combination, calculated. [SI]

    Returns
    -------
    tuple of float
        Compared one after the other. [mixed]
    """
    a = tried.answers
    if a is None:
        return (1.0,)
    peak = math.inf if a.peak_torque is None else a.peak_torque
    margin = math.inf if a.worst_margin is None else a.worst_margin
    if a.unlimited:
        starts = -math.inf
    else:
        # a negative number of starts, or a positive torque: a study counts starts or it does not,
        # except where a start was not completed, which rule 2 has set apart
        starts = peak if a.starts is None else -a.starts
    tier = _MARGIN_TIERS[a.margin_verdict]
    return (0.0, float(not a.whole), float(len(a.broken)), float(tier), starts, -margin, peak)


def ranked(
    tried: Iterable[EvaluatedCombination], variables: tuple[Variable, ...]
) -> tuple[EvaluatedCombination, ...]:
    """Combinations in the order of their merit.

    Parameters
    ----------
    tried : iterable of EvaluatedCombination
        Combinations, calculated, in any order. [SI]
    variables : tuple of Variable
        What they chose from. [SI]

    Returns
    -------
    tuple of EvaluatedCombination
        The best first. [SI]
    """

    def key(
        t: EvaluatedCombination,
    ) -> tuple[Merit, bool, tuple[tuple[str, str, float, str], ...]]:
        options = t.combination.options
        picks = (
            (v.name, v.quantity, o.value, o.label) for v, o in zip(variables, options, strict=False)
        )
        return merit(t), not t.combination.as_is, tuple(sorted(picks))

    return tuple(sorted(tried, key=key))


# --- words ----------------------------------------------------------------------------------------


def chosen(tried: EvaluatedCombination, variables: tuple[Variable, ...]) -> str:
    """What a combination is made of.

    Parameters
    ----------
    tried : EvaluatedCombination
        A combination. [SI]
    variables : tuple of Variable
        What it chose from. [SI]

    Returns
    -------
    str
        Such as ``LS coupling stiffness 0.8 × (23,000,000 N m/rad); HS coupling: Type 4``. [words]
    """
    c = tried.combination
    if not c.options:
        return "as is"
    parts = [
        f"{v.title}: {o.label}" if o.offer is not None else f"{v.title} {o.label}"
        for v, o in zip(variables, c.options, strict=True)
    ]
    return "; ".join(parts) + (" (as is)" if c.as_is else "")


def reason(
    tried: EvaluatedCombination,
    as_is: EvaluatedCombination | None,
    rated_torque: float | None,
    units: Mapping[tuple[str, str], DisplayUnit] = MappingProxyType({}),
) -> str:
    """Why a combination stands where it stands, against the case as it is.

    Parameters
    ----------
    tried : EvaluatedCombination
        A combination, calculated. [SI]
    as_is : EvaluatedCombination or None
        The unchanged case; None = nothing to compare with. [SI]
    rated_torque : float or None
        RatedTorque. [N m]
    units : mapping of (str, str) to DisplayUnit, optional
        Of stress and torque, as in `StudyInputs`; default MPa and N m. [units]

    Returns
    -------
    str
        Limits, the crossing that governs, starts, stress. [sentences]
    """
    a = tried.answers
    if a is None:
        return f"Cannot be calculated: {tried.problem}"
    b = None if as_is is None or tried.combination.as_is else as_is.answers
    sentences = [_limits(a)]
    if not a.whole:
        return f"{a.sentence} {sentences[0]}".strip()
    crossing = a.governing
    if crossing is not None:
        torque = units.get(("", "torque"), _NEWTON_METRE)
        sentences.append(
            _crossing(crossing, None if b is None else b.governing, rated_torque, torque)
        )
    sentences.append(_severity(a, b, units.get(("", "stress"), _MEGAPASCAL)))
    return " ".join(s for s in sentences if s)


def _limits(a: KeyAnswers) -> str:
    margin = next((c for c in a.checks if c.check == MARGIN_CHECK), None)
    near = ""
    if margin is not None and isinstance(margin.result, float):
        near = f"{margin.where}: {_percent(margin.result)}"
    if a.broken:
        names = [f"{n} ({near})" if n == MARGIN_CHECK else n for n in dict.fromkeys(a.broken)]
        many = "limit" if len(a.broken) == 1 else "limits"
        return f"Violates {len(a.broken)} {many}: {', '.join(names)}."
    open_ = (Judgement.NOT_JUDGED, Judgement.INCOMPLETE)
    unjudged = dict.fromkeys(c.check for c in a.checks if c.verdict in open_)
    unjudged.pop(MARGIN_CHECK, None)
    unjudged_words = f"Not wholly judged: {', '.join(unjudged)}." if unjudged else ""
    limits_kept = "Meets all judged limits" if unjudged else "Meets all limits"
    if not near:
        limits_kept += "; no separation margin was judged."
    elif a.margin_verdict == Judgement.ACCEPTED:
        limits_kept += f", the separation margin ({near}) accepted by forced response."
    else:
        limits_kept += f" (least separation margin: {near})."
    return f"{limits_kept} {unjudged_words}".strip()


def _percent(share: float) -> str:
    return f"{round(100.0 * share, 1):g} %"


def _crossing(
    c: Crossing, before: Crossing | None, rated: float | None, torque: DisplayUnit
) -> str:
    """Where the worst mode is crossed, and what it meets there."""
    pulsating = c.pulsating_torque or 0.0
    size = f"{_percent(pulsating / rated)} of rated" if rated else torque.format(pulsating, 4)
    text = f"Mode {c.mode} at {c.frequency:.4g} Hz governs the start; it is crossed"
    if c.percent_speed is not None:
        text += f" at {_percent(0.01 * c.percent_speed)} speed"
    text += f", where the pulsating torque is {size}"
    if before is not None:
        text += _against(pulsating, before.pulsating_torque)
    if c.sweep_rate is not None:
        text += f" and {c.multiple_of_slip} × slip frequency falls at {c.sweep_rate:.3g} Hz/s"
        if before is not None:
            text += _against(c.sweep_rate, before.sweep_rate, "slower", "faster")
    return text + "."


def _against(now: float, before: float | None, less: str = "less", more: str = "more") -> str:
    """How much more or less than as is."""
    if not before:
        return ""
    change = now / before - 1.0
    if abs(change) < SAME:
        return " (as is)"
    return f" ({100.0 * abs(change):.2g} % {less if change < 0.0 else more} than in the unchanged case)"


def _severity(a: KeyAnswers, b: KeyAnswers | None, stress: DisplayUnit) -> str:
    """Starts, or without them the peak torque; stress."""
    parts = []
    if a.unlimited:
        parts.append("unlimited starts")
    elif a.starts is not None:
        text = f"{starts_in_words(a.starts)} starts"
        if b is not None and b.starts:
            text += _times(a.starts / b.starts)
        parts.append(text)
    if a.peak_stress is not None:
        text = f"largest stress {stress.format(a.peak_stress, 3)} peak-to-peak"
        parts.append(text + ("" if b is None else _against(a.peak_stress, b.peak_stress)))
    elif a.peak_over_rated is not None:
        text = f"largest torque {a.peak_over_rated:.3g} × rated"
        parts.append(text + ("" if b is None else _against(a.peak_over_rated, b.peak_over_rated)))
    if a.impacts:
        parts.append(f"{a.impacts} tooth impacts")
    if not parts:
        return ""
    text = ", ".join(parts)
    return text[0].upper() + text[1:] + "."


def _times(factor: float) -> str:
    if abs(factor - 1.0) < SAME:
        return " (as is)"
    return f" ({float(f'{factor:.3g}'):,.12g} × as is)"
