"""The tolerance study as the result tables of its sheets: rows of plain values under their JSON keys.

SI throughout, shares as fractions. Unlimited starts are the word ``unlimited``; None is a blank.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from engine.case.result_words import NoNumber
from engine.numerics.sample_statistics import Percentile
from engine.studies.tolerances.tolerances import (
    MARGIN,
    STARTS,
    STRESS,
    PercentileRow,
    ProbabilityRow,
    Tolerances,
)

Row = dict[str, Any]

#: What a driven answer is, for the units of its sheet.
_DIMENSION = {STARTS: "count", STRESS: "pressure", MARGIN: "fraction"}
#: Bars of the histogram of the starts.
BARS = 16
#: Factors in the tornado chart.
TORNADO = 14
#: Points of the distribution. [1]
POINTS = tuple(0.01 * k for k in range(1, 100))
UNLIMITED, NOT_JUDGED = NoNumber.UNLIMITED.value, NoNumber.NOT_JUDGED.value


def tolerance_tables(tolerances: Tolerances) -> Mapping[str, list[Row]]:
    """Every result table of the study.

    Parameters
    ----------
    tolerances : Tolerances
        The study. [SI]

    Returns
    -------
    mapping of str to list of dict
        Table name → rows with JSON keys. [SI]
    """
    return {
        "StartsOfSample": list(_starts(tolerances)),
        "ToleranceDrivers": list(_drivers(tolerances)),
        "ToleranceTornado": _tornado(tolerances),
        "ToleranceHistogram": list(_histogram(tolerances)),
        "ToleranceDistribution": list(_distribution(tolerances)),
        "ToleranceFrequencies": list(_frequencies(tolerances)),
        "ToleranceMargins": list(_margins(tolerances)),
        "TolerancePeaks": list(_peaks(tolerances)),
    }


def tolerance_details(tolerances: Tolerances) -> Mapping[str, Any]:
    """What only the JSON contains: settings, sentences, every interval.

    Parameters
    ----------
    tolerances : Tolerances
        The study. [SI]

    Returns
    -------
    mapping of str to object
        Key ``tolerances``. [SI]
    """
    percentiles = [
        {
            "quantity": r.quantity,
            "of": r.of,
            "nominal": _plain(r.nominal),
            "unlimited": r.unlimited,
            "samples": r.samples,
            "percentiles": [{k: _plain(v) for k, v in asdict(p).items()} for p in r.percentiles],
        }
        for r in tolerances.percentiles
    ]
    return {
        "tolerances": {
            **asdict(tolerances.settings),
            "samples_planned": tolerances.wanted,
            "samples_calculated": tolerances.samples,
            "converged": tolerances.converged,
            "driven": tolerances.driven,
            "explained": tolerances.explained,
            "sentences": list(tolerances.sentences),
            "percentiles": percentiles,
            "probabilities": [
                {k: _plain(v) for k, v in asdict(r).items()} for r in tolerances.probabilities
            ],
        }
    }


def _plain(value: Any) -> Any:
    """Infinite numbers as a word."""
    return UNLIMITED if isinstance(value, float) and math.isinf(value) else value


def _percentiles(percentiles: tuple[Percentile, ...], head: str = "") -> Row:
    row: Row = {}
    for p in percentiles:
        key = f"{head}p_{100.0 * p.probability:.0f}"
        row |= {
            key: _plain(p.value),
            f"{key}_low": _plain(p.low),
            f"{key}_high": _plain(p.high),
        }
    return row


def _probability(tolerances: Tolerances, check: str, of: str) -> ProbabilityRow | None:
    return next((r for r in tolerances.probabilities if (r.check, r.of) == (check, of)), None)


def _met(row: ProbabilityRow | None) -> Row:
    if row is None:
        return {}
    return {
        "required": row.required,
        "probability": row.probability,
        "probability_low": row.low,
        "probability_high": row.high,
    }


def _of(tolerances: Tolerances, quantity: str) -> Iterator[PercentileRow]:
    return (r for r in tolerances.percentiles if r.quantity == quantity)


def _starts(tolerances: Tolerances) -> Iterator[Row]:
    for r in _of(tolerances, STARTS):
        nominal = NOT_JUDGED if r.nominal is None else _plain(r.nominal)
        yield {
            "element": r.of,
            "nominal": nominal,
            **_percentiles(r.percentiles),
            "unlimited": r.unlimited,
            **_met(_probability(tolerances, "starts", r.of)),
            "samples": r.samples,
        }


def _drivers(tolerances: Tolerances) -> Iterator[Row]:
    nominal = _nominal(tolerances)
    for d in tolerances.drivers:
        row: Row = (
            {"dimension": _DIMENSION[tolerances.driven]} if tolerances.driven != STARTS else {}
        )
        row |= {
            "factor": d.factor,
            "deviation": d.deviation,
            "at_p_10": NOT_JUDGED if d.at_low is None else _plain(d.at_low),
            "at_p_90": NOT_JUDGED if d.at_high is None else _plain(d.at_high),
            "change_at_p_10": _change(d.at_low, nominal),
            "change_at_p_90": _change(d.at_high, nominal),
            "rank_coefficient": d.rank_coefficient,
            "partial_correlation": d.partial,
            "share": d.share,
        }
        yield row


def _tornado(tolerances: Tolerances) -> list[Row]:
    """The factors whose own runs move the answer most."""
    rows = [
        {"factor": r["factor"], "at_p_10": r["change_at_p_10"], "at_p_90": r["change_at_p_90"]}
        for r in _drivers(tolerances)
        if r["change_at_p_10"] is not None and r["change_at_p_90"] is not None
    ]
    rows.sort(key=lambda r: -abs(r["at_p_90"] - r["at_p_10"]))
    return rows[:TORNADO]


def _nominal(tolerances: Tolerances) -> float | None:
    """The answer that is driven, as it is without scatter in the sample's own step."""
    rows = list(_of(tolerances, "margin" if tolerances.driven == MARGIN else tolerances.driven))
    nominals = [r.nominal for r in rows if r.nominal is not None]
    if not nominals:
        return None
    return max(nominals) if tolerances.driven == STRESS else min(nominals)


def _change(value: float | None, nominal: float | None) -> float | None:
    """Relative to the nominal answer; None where either is unlimited."""
    if value is None or nominal is None or not nominal or math.isinf(value) or math.isinf(nominal):
        return None
    return value / nominal - 1.0


def _histogram(tolerances: Tolerances) -> Iterator[Row]:
    """Share of the samples in bars of equal width in the logarithm, and of the unlimited ones."""
    n = len(tolerances.starts)
    limited = tolerances.starts[np.isfinite(tolerances.starts)]
    if not n:
        return
    if len(limited):
        low, high = float(limited.min()), float(limited.max())
        edges = np.geomspace(low, high, BARS + 1) if high > low else np.array([low, low * 1.001])
        counts, _ = np.histogram(np.clip(limited, edges[0], edges[-1]), edges)
        for count, a, b in zip(counts.tolist(), edges[:-1], edges[1:], strict=True):
            yield {"starts": f"{_rounded(a)} – {_rounded(b)}", "share": count / n}
    if len(limited) < n:
        yield {"starts": UNLIMITED, "share": 1.0 - len(limited) / n}


def _rounded(value: float) -> str:
    return f"{float(f'{value:.2g}'):,g}"


def _distribution(tolerances: Tolerances) -> Iterator[Row]:
    starts, frequency = np.sort(tolerances.starts), np.sort(tolerances.first_frequency)
    for p in POINTS:
        row: Row = {"probability": p}
        if len(starts):
            at = float(starts[max(math.ceil(len(starts) * p - 1e-9), 1) - 1])
            row["starts"] = None if math.isinf(at) else at
        if len(frequency):
            place = max(math.ceil(len(frequency) * p - 1e-9), 1) - 1
            row["first_frequency"] = float(frequency[place])
        yield row


def _frequencies(tolerances: Tolerances) -> Iterator[Row]:
    for mode, r in enumerate(_of(tolerances, "frequency"), start=1):
        yield {
            "mode": mode,
            "nominal": r.nominal,
            **_percentiles(r.percentiles),
            "samples": r.samples,
        }


def _margins(tolerances: Tolerances) -> Iterator[Row]:
    for r in _of(tolerances, "margin"):
        mode, _, excitation = r.of.partition(", ")
        yield {
            "mode": int(mode.removeprefix("mode ")),
            "excitation": excitation,
            "nominal": r.nominal,
            **_percentiles(r.percentiles),
            **_met(_probability(tolerances, "margin", r.of)),
        }
    every = _probability(tolerances, "all margins", "train")
    if every is not None:
        yield {"excitation": "all of them", "nominal": every.nominal, **_met(every)}


def _peaks(tolerances: Tolerances) -> Iterator[Row]:
    stress = {r.of: r for r in _of(tolerances, STRESS)}
    for r in _of(tolerances, "peak torque"):
        row: Row = {"element": r.of, "nominal_torque": r.nominal}
        row |= _percentiles(r.percentiles, "torque_")
        if r.of in stress:
            own = stress[r.of]
            row |= {"nominal_stress": own.nominal}
            row |= _percentiles(own.percentiles, "stress_")
        yield row
