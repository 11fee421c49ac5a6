"""What stands where on the sheets of tolerances and sensitivities; part of `addin.contract.studies.registry`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.chart_rows import ROOMS
from addin.contract.sheets import ChartAt, Sheet

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
        {"A": 1.5, "B": 27, "C": 8, "D:G": 7.5, "H:I": 9, "J:L": 7.5, "M:N": 9, "O:Q": 9.3, "R": 8.5},
        "R",
        {"ToleranceStarts": "B7", "ToleranceDrivers": f"B{_BELOW_STARTS + 22}"},
        (
            ChartAt("tornado", f"B{_BELOW_STARTS}", 610, 420),
            ChartAt("starts_histogram", f"J{_BELOW_STARTS}", 570, 208),
            ChartAt("starts_distribution", f"J{_BELOW_STARTS + 10}", 570, 220),
        ),
        freeze="A6",
        side=0.25,
    ),
    Sheet(
        "Tolerance tables",
        "result",
        {"A": 1.5, "B": 7, "C": 22, "D:Q": 9},
        "Q",
        {"ToleranceFrequencies": "B5", "ToleranceMargins": f"B{_BELOW_FREQUENCIES}"},
        freeze="A4",
        side=0.25,
    ),
    Sheet(
        "Tolerance peaks",
        "result",
        {"A": 1.5, "B": 24, "C:V": 11},
        "V",
        {"TolerancePeaks": "B5"},
        freeze="C8",
        header_rows=7,
        breaks=("M",),
        repeated="B:B",
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
        {"A": 1.5, "B": 15, "C": 22, "D:K": 8.5, "L": 16, "M": 37},
        "M",
        {"Sensitivities": "B7"},
        freeze="A10",
        side=0.25,
    ),
    Sheet(
        "Frequency sensitivities",
        "result",
        {"A": 1.5, "B": 16, "C": 23, "D:P": 8.8},
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
    "ToleranceTornado",
)

#: One sentence below the strip of each sheet.
TOLERANCE_INTROS: Mapping[str, str] = {
    "Tolerance results": "What the scatter on sheet Tolerances makes of the allowable starts, and what "
    "drives them. Written by torsionbook tolerances FILE.",
    "Tolerance tables": "The same of frequencies and margins: P10, P50 and P90 of the samples and the "
    "probability that each margin is kept, all with the ends of their 95 % intervals.",
    "Tolerance peaks": "The same of the largest torques and nominal stresses of the start, zero-to-peak.",
    "Tolerance data": "What the charts of sheet Tolerance results show.",
    "Sensitivities": "What a small change of each quantity does. Written by torsionbook sensitivities "
    "FILE.",
    "Frequency sensitivities": "How each frequency follows each stiffness and inertia; the green shifts "
    "follow the change typed on sheet Frequencies. Written by torsionbook sensitivities FILE.",
}
