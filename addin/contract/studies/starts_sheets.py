"""What stands where on the sheets of start matrix, damage ledger and calibration."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.chart_rows import ROOMS
from addin.contract.sheets import ChartAt, Sheet

__all__ = ["STARTS_CAPTIONS", "STARTS_INTROS", "STARTS_SHEETS", "STARTS_VERDICTS"]


def _below(row: int, table: str) -> int:
    """First row below the room of a table whose caption is in a row."""
    return row + 3 + ROOMS[table] + 1


_CHART_ROWS = 17
_LEDGER_BELOW = _below(7, "DamageLedger")
_PEAKS_AT = _below(7, "FrequencyFit")
_FITS_AT = _below(_PEAKS_AT, "PeakFit")
_MODES_AT = _FITS_AT + _CHART_ROWS
_MARGINS_AT = _below(_MODES_AT, "CalibratedFrequencies")
_PARAMETERS_AT = _below(_MARGINS_AT, "CalibratedMargins")

STARTS_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Start matrix",
        "result",
        {"A": 1.5, "B": 30, "C:E": 9.5, "F": 10, "G": 26, "H:J": 9.5, "K:L": 18, "M:Q": 11.5,
         "R": 56},
        "R",
        {"StartsByVoltage": "M7", "StartMatrix": f"B{8 + _CHART_ROWS}"},
        (
            ChartAt("starts-voltage", "C7", 460, 330),
            ChartAt("stress-voltage", "H7", 470, 330),
        ),
        freeze="",
        breaks=("M",),
        repeated="B:B",
    ),
    Sheet(
        "Damage ledger",
        "result",
        {"A": 1.5, "B": 20, "C": 26, "D:J": 10, "K": 10, "L": 32},
        "L",
        {"DamageLedger": "B7", "RemainingStarts": f"B{_LEDGER_BELOW}"},
        freeze="",
        side=0.25,
    ),
    Sheet(
        "Calibration",
        "result",
        {"A": 1.5, "B": 18, "C": 13, "D:E": 12, "F:G": 9, "H:I": 8, "J:L": 9, "M": 22, "N": 12, "O": 8.5,
         "P": 6},
        "P",
        {
            "FrequencyFit": "B7",
            "PeakFit": f"B{_PEAKS_AT}",
            "CalibratedFrequencies": f"B{_MODES_AT}",
            "CalibratedMargins": f"B{_MARGINS_AT}",
            "CalibratedParameters": f"B{_PARAMETERS_AT}",
        },
        (
            ChartAt("fit", f"B{_FITS_AT}", 460, 320),
            ChartAt("change", f"G{_FITS_AT}", 740, 320),
        ),
        freeze="",
        row_breaks=(_FITS_AT - 1, _MARGINS_AT - 1),
        side=0.25,
    ),
)  # fmt: skip

#: Caption above each table.
STARTS_CAPTIONS: Mapping[str, str] = {
    "StartsByVoltage": "By voltage",
    "StartMatrix": "Start matrix",
    "DamageLedger": "Damage ledger",
    "RemainingStarts": "Remaining starts",
    "FrequencyFit": "Measured frequencies",
    "PeakFit": "Measured peak torques",
    "CalibratedFrequencies": "Modes",
    "CalibratedMargins": "Least separation margins",
    "CalibratedParameters": "Uncertain quantities",
}

#: One sentence below the strip of each sheet.
STARTS_INTROS: Mapping[str, str] = {
    "Start matrix": "Each kind of start as a run of its own: torsionbook starts FILE. A start that does "
    "not come to its end is not judged.",
    "Damage ledger": "What the duty of sheet Duty uses of each judged shaft: Palmgren-Miner, the order "
    "of starts ignored; a shaft is used up at 1/StartsFactor.",
    "Calibration": "The least change of the uncertain quantities (sheet Tolerances) that explains what "
    "was measured: torsionbook calibrate FILE.",
}

#: Result tables and the column that is coloured as a verdict.
STARTS_VERDICTS: tuple[tuple[str, str], ...] = (
    ("DamageLedger", "Verdict"),
    ("CalibratedMargins", "Verdict before"),
    ("CalibratedMargins", "Verdict"),
)
