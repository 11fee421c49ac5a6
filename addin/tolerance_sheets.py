"""What stands where on the sheets of tolerances and sensitivities; part of `addin.study_sheets`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.layout import ROOMS
from addin.template_sheets import ChartAt, Sheet

__all__ = [
    "TOLERANCE_CAPTIONS",
    "TOLERANCE_INTROS",
    "TOLERANCE_SHEETS",
    "TOLERANCE_SHORT_CAPTIONS",
]

#: Row of the first thing below table `ToleranceStarts`.
_BELOW_STARTS = 9 + ROOMS["ToleranceStarts"] + 2
#: Row of the captions below table `ToleranceFrequencies`.
_BELOW_FREQUENCIES = 8 + ROOMS["ToleranceFrequencies"] + 2

TOLERANCE_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Tolerance results",
        "result",
        {"A": 1.5, "B": 34, "C:R": 11},
        "R",
        {"ToleranceStarts": "B7", "ToleranceDrivers": f"B{_BELOW_STARTS + 22}"},
        (
            ChartAt("tornado", f"B{_BELOW_STARTS}", 716, 420),
            ChartAt("starts_histogram", f"J{_BELOW_STARTS}", 660, 208),
            ChartAt("starts_distribution", f"J{_BELOW_STARTS + 10}", 660, 220),
        ),
        freeze="A6",
    ),
    Sheet(
        "Tolerance tables",
        "result",
        {"A": 1.5, "B": 7, "C": 22, "D:K": 10, "L": 10, "M": 24, "N:U": 11},
        "U",
        {"ToleranceFrequencies": "B5", "ToleranceMargins": f"B{_BELOW_FREQUENCIES}",
         "TolerancePeaks": f"M{_BELOW_FREQUENCIES}"},
        freeze="A4",
    ),
    Sheet(
        "Tolerance data",
        "result",
        {"A": 1.5, "B:D": 13, "E": 2, "F": 20, "G": 9, "H": 2, "I": 36, "J:K": 11},
        "K",
        {"ToleranceDistribution": "B5", "ToleranceHistogram": "F5", "ToleranceTornado": "I5"},
        freeze="A8",
    ),
    Sheet(
        "Sensitivities",
        "result",
        {"A": 1.5, "B": 17, "C": 24, "D:K": 9, "L": 28, "M": 60},
        "M",
        {"Sensitivities": "B7"},
        freeze="A10",
    ),
    Sheet(
        "Frequency sensitivities",
        "result",
        {"A": 1.5, "B": 22, "C": 24, "D:P": 9},
        "P",
        {"FrequencySensitivities": "B7"},
        freeze="A10",
    ),
)  # fmt: skip

#: Caption above each table.
TOLERANCE_CAPTIONS: Mapping[str, str] = {
    "ToleranceStarts": "Allowable starts",
    "ToleranceDrivers": "What drives it",
    "ToleranceFrequencies": "Natural frequencies",
    "ToleranceMargins": "Margins",
    "TolerancePeaks": "Peaks",
    "ToleranceDistribution": "Distribution",
    "ToleranceHistogram": "Histogram",
    "ToleranceTornado": "Tornado",
    "Sensitivities": "Sensitivities",
    "FrequencySensitivities": "Frequency sensitivities",
}

#: Tables with another table close to their right.
TOLERANCE_SHORT_CAPTIONS = (
    "ToleranceDistribution",
    "ToleranceHistogram",
    "ToleranceMargins",
    "ToleranceTornado",
)

#: One sentence below the strip of each sheet.
TOLERANCE_INTROS: Mapping[str, str] = {
    "Tolerance results": "What the scatter on sheet Tolerances makes of the allowable starts, and what "
    "drives them. Written by torsionbook tolerances FILE.",
    "Tolerance tables": "The same of frequencies, margins and peaks: P10, P50 and P90 of the samples, and "
    "the probability that each margin is kept.",
    "Tolerance data": "What the charts of sheet Tolerance results show.",
    "Sensitivities": "What a small change of each quantity does. Written by torsionbook sensitivities "
    "FILE.",
    "Frequency sensitivities": "How each frequency follows each stiffness and inertia; the green shifts "
    "follow the change typed below. Written by torsionbook sensitivities FILE.",
}
