"""What stands where on the result sheets of a tuning study; part of `addin.contract.studies.registry`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from addin.contract.sheets import ChartAt, Sheet
from addin.contract.studies.tuning import LINES, MAP_ROWS

__all__ = [
    "TUNING_CAPTIONS",
    "TUNING_INTROS",
    "TUNING_SCALES",
    "TUNING_SHEETS",
    "TUNING_VERDICTS",
    "StudyScale",
]


@dataclass(frozen=True)
class StudyScale:
    """Columns of a map that are coloured by their numbers."""

    table: str  #: Result table.
    first: str  #: Its first and last coloured column.
    last: str  #: Likewise.
    limit: str = ""  #: Column with the limit below which a cell is red; empty = from least to most.
    #: Table of the same rows and columns whose cells below their limit are marked in this one.
    over: str = ""


#: Rows from one caption to that of the next map: caption, units, header, rows, two blank.
_STEP = MAP_ROWS + 5
_FIRST_MAP = 10
_STARTS, _MARGINS, _MODES, _BANDS = (_FIRST_MAP + k * _STEP for k in range(4))

TUNING_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Tuning results",
        "result",
        {"A": 1.5, "B": 6, "C": 36, "D:E": 7, "F": 20, "G": 8, "H": 12, "I": 9, "J": 54, "K": 30,
         "L": 9, "M": 22, "N": 28, "O:Q": 9, "R": 8, "S:V": 10.5, "W:X": 10.5, "Y": 22, "Z": 9,
         "AA": 22, "AB": 11, "AC": 9, "AD": 13, "AE": 60},
        "J",
        {"TuningResults": "B7"},
        freeze="D10",
        header_rows=9,
        printed="J",
        side=0.25,
    ),
    Sheet(
        "Tuning map",
        "result",
        {"A": 1.5, "B": 26, "C": 16, "D:I": 13, "J": 11, "K": 2, "L:S": 11},
        "S",
        {
            "TuningAxes": "B5",
            "TuningStarts": f"B{_STARTS}",
            "TuningMargins": f"B{_MARGINS}",
            "TuningModes": f"B{_MODES}",
            "ForbiddenBands": f"B{_BANDS}",
        },
        (
            ChartAt("tuning-starts", f"L{_STARTS}", 640, 350),
            ChartAt("tuning-margins", f"L{_MARGINS}", 640, 350),
            ChartAt("tuning-modes", f"L{_MODES}", 640, 350),
        ),
        breaks=("L",),
        row_breaks=(_MARGINS - 1, _BANDS - 1),
        largest=80,
    ),
    Sheet(
        "Tuning crossings",
        "result",
        {"A": 1.5, "B": 6, "C": 36, "D": 6, "E:G": 9, "H:L": 11, "M": 22, "N:P": 12, "Q": 50},
        "Q",
        {"TuningCrossings": "B5"},
        freeze="D8",
        header_rows=7,
        breaks=("M",),
        repeated="B:D",
    ),
    Sheet(
        "StudyData",
        "result",
        {"A": 1.5, "B:L": 11},
        "L",
        {"TuningLines": "B5", "TuningHatch": "K5"},
        hidden=True,
    ),
)  # fmt: skip

TUNING_CAPTIONS: Mapping[str, str] = {
    "TuningResults": "Combinations",
    "TuningCrossings": "Crossings",
    "TuningAxes": "The maps",
    "TuningStarts": "Allowable starts",
    "TuningMargins": "Worst separation margin",
    "TuningModes": "Modes",
    "ForbiddenBands": "Forbidden bands",
    "TuningLines": "Lines of starts",
    "TuningHatch": "Hatching",
}

TUNING_INTROS: Mapping[str, str] = {
    "Tuning results": "torsionbook tune FILE: every combination of sheet Tuning as a full start, ranked. "
    "The order and its reasons: docs/tuning.md. All combinations are in the JSON.",
    "Tuning map": "Starts and margins over the first two variables of sheet Tuning, each cell with the "
    "best of what is left; no mode may lie in a hatched band.",
    "Tuning crossings": "Where 2 × slip frequency crosses the modes, for the best combinations and for "
    "the case as it stands.",
}

TUNING_VERDICTS: tuple[tuple[str, str], ...] = (("TuningResults", "Verdict"),)

TUNING_SCALES: tuple[StudyScale, ...] = (
    StudyScale("TuningStarts", "Line 1", f"Line {LINES}", "Required", "TuningMargins"),
    StudyScale("TuningMargins", "Line 1", f"Line {LINES}", "Required"),
)
