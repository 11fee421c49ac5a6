"""What stands where on the study sheets of a workbook made with ``torsionbook new --studies``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from addin.contract.charts import ChartSpec
from addin.contract.sheets import Sheet
from addin.contract.studies import calibration, start_matrix, tolerances, tuning
from addin.contract.studies.starts_sheets import (
    STARTS_CAPTIONS,
    STARTS_INTROS,
    STARTS_SHEETS,
    STARTS_VERDICTS,
)
from addin.contract.studies.tolerance_sheets import (
    TOLERANCE_CAPTIONS,
    TOLERANCE_INTROS,
    TOLERANCE_SHEETS,
    TOLERANCE_SHORT_CAPTIONS,
)
from addin.contract.studies.tuning_sheets import (
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
    """A study and the sheet of its results."""

    key: str  #: Begins the names of its facts: ``tuning`` for ``tuning_SHA256``.
    sheet: str  #: Sheet of its results.
    last: str  #: Last column of its lines of words.
    command: str  #: What calculates it. [command]
    height: float = 42.0  #: Of the line that says what was found. [points]
    #: Further sheets of its results with the last columns of their lines. [names, letters]
    also: tuple[tuple[str, str], ...] = ()
    #: First column of its lines; right of those that are repeated on every printed page.
    first: str = "B"

    @property
    def not_yet(self) -> str:
        """What stands there before the study has been made. [sentence]"""
        return (
            "Not calculated yet. Save and close this workbook, then run: "
            f"torsionbook {self.command} FILE"
        )


#: Every study, in the order of its sheets.
STUDIES: tuple[StudyOnSheet, ...] = (
    StudyOnSheet("tuning", "Tuning results", "J", "tune", 84.0),
    StudyOnSheet("tolerances", "Tolerance results", "R", "tolerances", 56.0),
    StudyOnSheet("sensitivities", "Sensitivities", "M", "sensitivities"),
    StudyOnSheet("starts", "Start matrix", "L", "starts", 70.0, (("Damage ledger", "L"),), "C"),
    StudyOnSheet("calibration", "Calibration", "P", "calibrate", 84.0),
)

#: Rows of table `StudyFacts`: what was found in words, and which inputs it belongs to.
STUDY_FACTS: tuple[tuple[str, str], ...] = tuple(
    (f"{study.key}_{fact}", f"Sheet {study.sheet}: {meaning}")
    for study in STUDIES
    for fact, meaning in (
        ("Sentence", "what was found, in words"),
        ("Stamp", "who calculated it, when, from which inputs"),
        ("SHA256", "SHA-256 of the inputs of its case"),
        ("Tables", "SHA-256 of what was written into each of its tables, shortened"),
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

_RESULT_SHEETS: tuple[Sheet, ...] = (*TUNING_SHEETS, *TOLERANCE_SHEETS, *STARTS_SHEETS)

#: Sheets of studies that stand behind a sheet of the plain run instead.
_BEHIND: Mapping[str, str] = {"Frequencies": "Frequency sensitivities"}

#: Caption above each table.
STUDY_CAPTIONS: Mapping[str, str] = {
    "Tuning": "Tuning",
    "Catalogue": "Catalogue",
    "Scatter": "Scatter",
    "StartConditions": "Start conditions",
    "MeasuredFrequencies": "Measured frequencies",
    "MeasuredPeaks": "Measured peaks (optional)",
    **TUNING_CAPTIONS,
    **TOLERANCE_CAPTIONS,
    **STARTS_CAPTIONS,
}

#: Tables with another table close to their right: the caption stands alone.
STUDY_SHORT_CAPTIONS = frozenset(
    {"Tuning", "MeasuredFrequencies", "StartsByVoltage", *TOLERANCE_SHORT_CAPTIONS}
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
    **TOLERANCE_INTROS,
    **STARTS_INTROS,
}

#: Result tables and the column that is coloured as a verdict.
STUDY_VERDICTS: tuple[tuple[str, str], ...] = (*TUNING_VERDICTS, *STARTS_VERDICTS)

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
        (f'=IF({key}_Sentence="","{study.not_yet}",{key}_Sentence)', "sentence", study.height),
        (
            f'=IF({key}_SHA256="","",IF(AND(run_SHA256<>"",run_SHA256<>{key}_SHA256),'
            f'"OTHER INPUTS than those of the plain results: run torsionbook {study.command} again. ",'
            f'"")&{key}_Stamp)',
            "note",
            15.0,
        ),
    )


def with_studies(sheets: Sequence[Sheet]) -> list[Sheet]:
    """The sheets of a workbook with those of the studies: inputs behind inputs, results behind results."""
    inputs = max(k for k, sheet in enumerate(sheets) if sheet.kind == "input") + 1
    results = max(k for k, sheet in enumerate(sheets) if sheet.name == "Accuracy") + 1
    beside = {sheet.name: sheet for sheet in _RESULT_SHEETS if sheet.name in _BEHIND.values()}
    plain = [
        one
        for sheet in sheets[inputs:results]
        for one in (sheet, beside.get(_BEHIND.get(sheet.name, "")))
        if one is not None
    ]
    return [
        *sheets[:inputs],
        *_INPUT_SHEETS,
        *plain,
        *(sheet for sheet in _RESULT_SHEETS if sheet.name not in beside),
        *sheets[results:],
    ]


#: Every chart of a study by name.
STUDY_CHARTS: Mapping[str, ChartSpec] = {
    spec.name: spec
    for study in (tuning, tolerances, start_matrix, calibration)
    for spec in study.CHARTS
}
