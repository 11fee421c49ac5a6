"""What the template and the writer agree on beside the fields: live formulas, facts, columns."""

from __future__ import annotations

import math
from collections.abc import Mapping

from addin.contract.studies.tuning import LINES, MAP_ROWS
from addin.contract.tables import SHARE_MODES, Field, TableSpec
from engine.case.effects import EFFECTS

__all__ = [
    "CHANGE_NAME",
    "CHECK_FORMULAS",
    "CROSSING_ROWS",
    "ROOMS",
    "NOTES_WIDTH",
    "RUN_FACTS",
    "SHAPE_COLUMNS",
    "WHOLE_STARTS",
    "WRAPPED",
    "plot_name",
    "text_height",
    "workbook_columns",
]

#: Mode-shape columns of the workbook; further modes are in the JSON only.
SHAPE_COLUMNS = 10

#: Result columns with sentences that wrap, and their width as shipped. [characters]
WRAPPED: Mapping[tuple[str, str], float] = {
    ("Verdicts", "Where"): 46.0,
    ("StartupCrossings", "Note"): 52.0,
    ("Audit", "Value"): 110.0,
    ("TorqueReversals", "Note"): 48.0,
    ("Effects", "Why"): 96.0,
    ("Plans", "Reason"): 96.0,
    ("TuningResults", "Combination"): 36.0,
    ("TuningResults", "Reason"): 54.0,
    ("TuningResults", "Broken"): 30.0,
    ("TuningResults", "Note"): 60.0,
    ("TuningCrossings", "Combination"): 36.0,
    ("TuningCrossings", "Note"): 50.0,
    ("TuningAxes", "First variable"): 22.0,
    ("TuningAxes", "Second variable"): 11.0,
    **{("TuningAxes", f"Line {k}"): 11.0 for k in range(1, LINES + 1)},
    ("Sensitivities", "Method"): 16.0,
    ("Sensitivities", "Note"): 37.0,
    ("StartMatrix", "Note"): 56.0,
    ("DamageLedger", "Reason"): 32.0,
    ("RemainingStarts", "Reason"): 32.0,
    ("FrequencyFit", "Note"): 22.0,
    ("PeakFit", "Note"): 22.0,
    ("CalibratedFrequencies", "Why"): 22.0,
    ("CalibratedParameters", "Note"): 22.0,
}

#: Starts are rounded down to whole ones; a count nearer than this to the next one is that one. [1]
WHOLE_STARTS = 1e-9

#: Rows kept free for the crossings of the start; what stands below them begins there.
CROSSING_ROWS = 8

#: Rows kept free for tables with something below them; what does not fit is in the JSON only.
ROOMS: Mapping[str, int] = {
    "StartupCrossings": CROSSING_ROWS,
    "TorqueReversals": 8,
    "BearingForces": 13,
    "Effects": len(EFFECTS),
    **dict.fromkeys(("TuningStarts", "TuningMargins", "TuningModes"), MAP_ROWS),
    "ToleranceStarts": 4,
    "ToleranceFrequencies": 12,
    "StartsByVoltage": 14,
    "DamageLedger": 8,
    "FrequencyFit": 10,
    "PeakFit": 5,
    "CalibratedFrequencies": 12,
    "CalibratedMargins": 12,
}

#: Width of the text column of sheet `Notes`. [characters]
NOTES_WIDTH = 122.0

#: Rows of table `RunFacts`, in this order: what live formulas need, written by the calculation.
RUN_FACTS: tuple[tuple[str, str], ...] = (
    ("run_Stamp", "Which inputs the results belong to"),
    ("run_Software", "Software and version"),
    ("run_Date", "Date of the calculation, UTC"),
    ("run_SHA256", "SHA-256 of the inputs"),
    ("run_Outcome", "How the start ended"),
    ("run_OutcomeWord", "The same in a word or two"),
    ("run_StartTime", "Duration of the start [s]"),
    ("run_SynchronousSpeed", "Synchronous speed [rpm]"),
    ("run_LineFrequency", "Line frequency [Hz]"),
    ("run_StartsFactor", "Factor on starts"),
    ("run_HzPerFrequency", "Hz per unit of NaturalFrequencies[Frequency]"),
    ("run_HzPerExcitation", "Hz per unit of SeparationMargins[Excitation frequency]"),
    ("run_PaPerUTS", "Pa per unit of Materials[UTS]"),
    ("run_PaPerAllowable", "Pa per unit of SteadyState[Allowable]"),
    ("run_GoverningShaft", "Shaft that table StartCycles belongs to"),
    ("run_SNExponent", "Its S-N exponent k at the endurance limit"),
    ("run_Endurance", "Its endurance limit in torsion, unit of StartCycles[Amplitude]"),
    ("run_NmPerMinimum", "N m per unit of TorqueReversals[Minimum torque]"),
    ("run_NmPerTransmitted", "N m per unit of TorqueReversals[Transmitted torque]"),
    ("run_ContactLaw", "Damping law of teeth in contact"),
    ("run_AccuracySentence", "What the wanted accuracy costs"),
    ("run_AccuracyReference", "What the errors on sheet Accuracy are measured against"),
    ("run_AccuracyInputs", "Which inputs sheet Accuracy belongs to"),
)


#: Defined name of the cell with the change whose shifts of frequency are shown as live formulas.
CHANGE_NAME = "SensitivityChange"


def _row(table: str, column: str) -> str:
    return f"{table}[[#This Row],[{column}]]"


def _check_formulas() -> dict[tuple[str, str], str]:
    frequency = f"N({_row('NaturalFrequencies', 'Frequency')})*N(run_HzPerFrequency)"
    of_mode = (
        "INDEX(NaturalFrequencies[Frequency],"
        f"MATCH({_row('SeparationMargins', 'Mode')},NaturalFrequencies[Mode],0))"
    )
    excitation = f"({_row('SeparationMargins', 'Excitation frequency')}*run_HzPerExcitation)"
    material = (
        f"INDEX(Elements[Material],MATCH({_row('SteadyState', 'Element')},Elements[Element],0))"
    )
    damage = f"N({_row('AllowableStarts', 'Damage')})"
    counted = f"ISNUMBER({_row('AllowableStarts', 'Allowable starts')})"
    transmitted = f"({_row('TorqueReversals', 'Transmitted torque')}*run_NmPerTransmitted)"
    return {
        ("NaturalFrequencies", "Percent speed check"): (
            f"=IF(AND({frequency}>0,{frequency}<2*N(run_LineFrequency)),"
            f'100*(1-{frequency}/(2*run_LineFrequency)),"")'
        ),
        ("SeparationMargins", "Margin check"): (
            f'=IFERROR(100*ABS({of_mode}*run_HzPerFrequency-{excitation})/{excitation},"")'
        ),
        ("SteadyState", "UTS/25 check"): (
            f"=IFERROR(IF(INDEX(Materials[UTS],MATCH({material},Materials[Material],0))>0,"
            f"INDEX(Materials[UTS],MATCH({material},Materials[Material],0))"
            '*run_PaPerUTS/25/run_PaPerAllowable,""),"")'
        ),
        ("TorqueReversals", "Margin check"): (
            f"=IF(N({_row('TorqueReversals', 'Transmitted torque')})<>0,IFERROR("
            f"100*{_row('TorqueReversals', 'Minimum torque')}*run_NmPerMinimum/{transmitted},"
            '""),"")'
        ),
        ("StartCycles", "Damage check"): (
            f"=IF(N({_row('StartCycles', 'Cycles to failure')})>0,"
            f'{_row("StartCycles", "Cycles")}/{_row("StartCycles", "Cycles to failure")},"")'
        ),
        ("AllowableStarts", "Starts check"): f'=IF({counted},1/{damage},"")',
        **{
            ("FrequencySensitivities", f"Shift {mode}"): (
                f"=IFERROR({_row('FrequencySensitivities', f'Mode {mode}')}*N({CHANGE_NAME})*"
                "INDEX(NaturalFrequencies[Frequency],"
                f'MATCH({mode},NaturalFrequencies[Mode],0)),"")'
            )
            for mode in (1, 2, 3)
        },
        **{
            ("EnergyShares", f"Shift {mode}"): (
                f"=IF(ISNUMBER({_row('EnergyShares', f'Share {mode}')}),"
                f'IFERROR(IF(RIGHT({_row("EnergyShares", "Quantity")},9)="stiffness",0.5,-0.5)*'
                f"{_row('EnergyShares', f'Share {mode}')}*N({CHANGE_NAME})*"
                "INDEX(NaturalFrequencies[Frequency],"
                f'MATCH({mode},NaturalFrequencies[Mode],0))*run_HzPerFrequency,""),"")'
            )
            for mode in range(1, SHARE_MODES + 1)
        },
        ("AllowableStarts", "Starts to judge"): (
            f"=IF(AND({counted},N(run_StartsFactor)>0),"
            f'ROUNDDOWN({1 + WHOLE_STARTS!r}/{damage}/run_StartsFactor,0),"")'
        ),
    }


#: Live formulas of the columns that a reviewer can click on, by table and column.
CHECK_FORMULAS: Mapping[tuple[str, str], str] = _check_formulas()


def workbook_columns(spec: TableSpec) -> tuple[Field, ...]:
    """All columns of a table as it stands in the workbook."""
    repeated = () if spec.repeated is None else range(1, SHAPE_COLUMNS + 1)
    return (*spec.columns, *(spec.repeated_column(k) for k in repeated), *spec.extra_columns)


def plot_name(number: int) -> str:
    """Defined name of the cell in which the engineer may name the element of a history chart."""
    return f"PlotElement{number}"


def text_height(text: str, width: float) -> float:
    """Height of a row in which a text wraps.

    Parameters
    ----------
    text : str
        The text, in Arial 9.
    width : float
        Width of its column. [characters of the standard font]

    Returns
    -------
    float
        Height. [point]
    """
    # A letter of Arial 9 takes 5.3 of the 7 pixels a standard character takes, on average.
    lines = sum(max(1, math.ceil(len(part) * 5.3 / (7.0 * width))) for part in text.split("\n"))
    return 15.0 + 12.0 * (lines - 1)
