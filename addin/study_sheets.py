"""What stands where on the study sheets of a workbook made with ``torsionbook new --studies``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from addin.layout import ROOMS
from addin.template_sheets import ChartAt, Sheet
from addin.tuning_sheets import (
    TUNING_CAPTIONS,
    TUNING_INTROS,
    TUNING_SCALES,
    TUNING_SHEETS,
    TUNING_VERDICTS,
    StudyScale,
)

__all__ = [
    "COLOUR_SCALE",
    "STUDIES",
    "STUDY_CAPTIONS",
    "STUDY_FACTS",
    "STUDY_INTROS",
    "STUDY_SCALES",
    "STUDY_SHORT_CAPTIONS",
    "STUDY_VERDICTS",
    "StudyOnSheet",
    "StudyScale",
    "study_lines",
    "with_studies",
]


@dataclass(frozen=True)
class StudyOnSheet:
    """A study and the sheet of its results.

    Parameters
    ----------
    key : str
        Begins the names of its facts: ``tuning`` for ``tuning_SHA256``. [name]
    sheet : str
        Sheet of its results. [name]
    last : str
        Last column of its lines of words. [letters]
    command : str
        What calculates it. [command]
    """

    key: str
    sheet: str
    last: str
    command: str

    @property
    def not_yet(self) -> str:
        """What stands there before the study has been made. [sentence]"""
        return (
            "Not calculated yet. Save and close this workbook, then run: "
            f"torsionbook {self.command} FILE"
        )


#: Every study, in the order of its sheets.
STUDIES: tuple[StudyOnSheet, ...] = (
    StudyOnSheet("tuning", "Tuning results", "J", "tune"),
    StudyOnSheet("tolerances", "Tolerance results", "R", "tolerances"),
    StudyOnSheet("sensitivities", "Sensitivities", "M", "sensitivities"),
)

#: Rows of table `StudyFacts`: what was found in words, and which inputs it belongs to.
STUDY_FACTS: tuple[tuple[str, str], ...] = tuple(
    (f"{study.key}_{fact}", f"Sheet {study.sheet}: {meaning}")
    for study in STUDIES
    for fact, meaning in (
        ("Sentence", "what was found, in words"),
        ("Stamp", "who calculated it, when, from which inputs"),
        ("SHA256", "SHA-256 of the inputs of its case"),
    )
)

_INPUT_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Tuning",
        "input",
        {"A": 1.5, "B": 22, "C": 12, "D": 13, "E": 26, "F:H": 10, "I": 2, "J": 20, "K": 24,
         "L": 8, "M:S": 11},
        "S",
        {"Tuning": "B5", "Catalogue": "J5"},
        freeze="A8",
    ),
    Sheet(
        "Tolerances",
        "input",
        {"A": 1.5, "B": 24, "C": 17, "D": 13, "E:G": 10, "H": 11, "I": 30},
        "I",
        {"Scatter": "B5"},
        freeze="A8",
    ),
    Sheet(
        "Duty",
        "input",
        {"A": 1.5, "B": 34, "C:H": 11, "I": 30},
        "I",
        {"StartConditions": "B5"},
        freeze="A8",
    ),
    Sheet(
        "Measured",
        "input",
        {"A": 1.5, "B": 9, "C:D": 12, "E": 2, "F": 24, "G:H": 13, "I": 40},
        "I",
        {"MeasuredFrequencies": "B5", "MeasuredPeaks": "F5"},
        freeze="A8",
    ),
)  # fmt: skip

#: Row of the first thing below table `ToleranceStarts`.
_BELOW_STARTS = 9 + ROOMS["ToleranceStarts"] + 2
#: Row of the captions below table `ToleranceFrequencies`.
_BELOW_FREQUENCIES = 8 + ROOMS["ToleranceFrequencies"] + 2

_RESULT_SHEETS: tuple[Sheet, ...] = (
    *TUNING_SHEETS,
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
STUDY_CAPTIONS: Mapping[str, str] = {
    "Tuning": "Tuning",
    "Catalogue": "Catalogue",
    "Scatter": "Scatter",
    "StartConditions": "Start conditions",
    "MeasuredFrequencies": "Measured frequencies",
    "MeasuredPeaks": "Measured peaks (optional)",
    **TUNING_CAPTIONS,
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

#: Tables with another table close to their right: the caption stands alone.
STUDY_SHORT_CAPTIONS = frozenset(
    {
        "Tuning",
        "MeasuredFrequencies",
        "ToleranceDistribution",
        "ToleranceHistogram",
        "ToleranceMargins",
        "ToleranceTornado",
    }
)

#: One sentence below the strip of each sheet.
STUDY_INTROS: Mapping[str, str] = {
    "Tuning": "What may be chosen, for torsionbook tune FILE: every combination of the rows of Tuning "
    "and of one catalogue row an element is calculated. Blank tables: nothing is tried.",
    "Tolerances": "How sure the inputs are, for torsionbook tolerances FILE and torsionbook calibrate "
    "FILE. Spreads are relative to what the case says.",
    "Duty": "Kinds of starts and how often each happens, for torsionbook starts FILE: start matrix and "
    "damage ledger.",
    "Measured": "What was measured on the train, for torsionbook calibrate FILE.",
    **TUNING_INTROS,
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

#: Result tables and the column that is coloured as a verdict.
STUDY_VERDICTS: tuple[tuple[str, str], ...] = (*TUNING_VERDICTS,)

#: Maps that are coloured.
STUDY_SCALES: tuple[StudyScale, ...] = (*TUNING_SCALES,)

#: From the least to the most of a map, by rank: starts differ by powers of ten.
COLOUR_SCALE: Mapping[str, str | float] = {
    "type": "3_color_scale",
    "min_color": "#F4B6A6",
    "mid_color": "#FBE9B7",
    "max_color": "#A9D6B2",
    "mid_type": "percentile",
    "mid_value": 50.0,
}


def study_lines(study: StudyOnSheet) -> tuple[tuple[str, str, float], ...]:
    """Formula, style and height of the lines below the strip of a result sheet.

    Parameters
    ----------
    study : StudyOnSheet
        The study.

    Returns
    -------
    tuple of (str, str, float)
        What was found; then the stamp, which says when the plain results are of other inputs. [points]
    """
    key = study.key
    return (
        (f'=IF({key}_Sentence="","{study.not_yet}",{key}_Sentence)', "sentence", 42.0),
        (
            f'=IF({key}_SHA256="","",IF(AND(run_SHA256<>"",run_SHA256<>{key}_SHA256),'
            f'"OTHER INPUTS than those of the plain results: run torsionbook {study.command} again. ",'
            f'"")&{key}_Stamp)',
            "note",
            15.0,
        ),
    )


def with_studies(sheets: Sequence[Sheet]) -> list[Sheet]:
    """The sheets of a workbook with those of the studies: inputs behind inputs, results behind results.

    Parameters
    ----------
    sheets : sequence of Sheet
        Without them.

    Returns
    -------
    list of Sheet
        With them.
    """
    inputs = max(k for k, sheet in enumerate(sheets) if sheet.kind == "input") + 1
    results = max(k for k, sheet in enumerate(sheets) if sheet.name == "Accuracy") + 1
    return [
        *sheets[:inputs],
        *_INPUT_SHEETS,
        *sheets[inputs:results],
        *_RESULT_SHEETS,
        *sheets[results:],
    ]
