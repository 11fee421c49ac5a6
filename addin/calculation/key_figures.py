"""The few numbers of a calculation that a summary over many cases shows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from addin.contract.banner import OPEN
from engine.case.result_words import Judgement
from engine.results.results import Results
from engine.start.start_fatigue import is_counted

#: First elastic modes that are shown. [count]
MODES = 3


@dataclass(frozen=True)
class KeyFigures:
    """What one looks at first; None where the case does not call for it."""

    tag: str | None  #: Of the title block.
    title: str | None  #: Likewise.
    frequencies: tuple[float, ...]  #: First elastic modes, `MODES` at most. [Hz]
    margin: float | None  #: Worst separation margin. [1]
    margin_mode: int | None  #: Its mode.
    margin_where: str | None  #: Its mode and excitation.
    #: Largest torque of a start at its element's own speed, a magnitude; the largest is found at
    #: motor speed. [N m]
    peak_torque: float | None
    peak_over_rated: float | None  #: The same at motor speed over the rated torque. [1]
    peak_where: str | None  #: Its element.
    stress: float | None  #: Largest nominal peak-to-peak shear stress of a start. [Pa]
    stress_where: str | None  #: Its element.
    reversals: int | None  #: Most torque reversals of a mesh or geared coupling in a start.
    reversals_where: str | None  #: Its element; None without reversals.
    starts: float | None  #: Allowable starts; None where unlimited or not judged. [1]
    starts_unlimited: bool  #: Shafts are judged and none is damaged.
    starts_not_judged: bool  #: Shafts are judged, but the start was not completed.
    starts_where: str | None  #: Governing shaft.
    outcome: str  #: How the start ended, or ``calculated``.
    verdict: str  #: The overall verdict.
    not_judged: int  #: Checks that are not wholly judged.


def verdict_text(verdict: str, not_judged: int) -> str:
    """An overall verdict with the number of checks that are not wholly judged."""
    return f"{verdict}, {not_judged} {Judgement.NOT_JUDGED}" if not_judged else verdict


def key_figures(results: Results, peaks: Iterable[Mapping[str, Any]]) -> KeyFigures:
    """The few numbers of a calculation.

    Parameters
    ----------
    results : Results
        A complete run. [SI]
    peaks : iterable of mapping
        Rows of table `StartupPeaks`. [SI]

    Returns
    -------
    KeyFigures
        What a summary shows. [SI]
    """
    worst = results.margins.worst
    torque, over_rated, at = _peak(results)
    stress, stressed = _stress(peaks)
    most = max(results.reversals, key=lambda row: row.reversals, default=None)
    starts = results.starts if results.starts is not None and results.starts.shafts else None
    not_judged = starts is not None and not is_counted(results.start)
    if not_judged:
        starts = None
    return KeyFigures(
        tag=results.case.tag,
        title=results.case.title,
        frequencies=tuple(float(f) for f in results.modes.elastic_frequency[:MODES]),
        margin=None if worst is None else float(worst.margin),
        margin_mode=None if worst is None else int(worst.mode),
        margin_where=None if worst is None else f"mode {worst.mode}, {worst.excitation}",
        peak_torque=torque,
        peak_over_rated=over_rated,
        peak_where=at,
        stress=stress,
        stress_where=stressed,
        reversals=None if most is None else int(most.reversals),
        reversals_where=most.element if most is not None and most.reversals else None,
        starts=None if starts is None else starts.judged_starts,
        starts_unlimited=starts is not None and starts.judged_starts is None,
        starts_not_judged=not_judged,
        starts_where=None if starts is None else starts.governing,
        outcome=results.outcome,
        verdict=results.verdicts[0].verdict,
        not_judged=sum(check.verdict in OPEN for check in results.verdicts[1:]),
    )


def _peak(results: Results) -> tuple[float | None, float | None, str | None]:
    """Size, size at motor speed over the rated torque, and element of the largest torque."""
    if results.start is None or not results.start.peaks:
        return None, None, None
    peak, torque = results.start.largest_peak(results.case.element_speed_ratios)
    assert peak is not None
    rated = results.case.ratings.rated_torque
    return float(peak.size), torque / rated if rated else None, peak.element


def _stress(peaks: Iterable[Mapping[str, Any]]) -> tuple[float | None, str | None]:
    """The largest nominal peak-to-peak stress of a start and its element."""
    stressed = [row for row in peaks if row.get("peak_to_peak_stress") is not None]
    top = max(stressed, key=lambda row: row["peak_to_peak_stress"], default=None)
    return (None, None) if top is None else (float(top["peak_to_peak_stress"]), top["element"])
