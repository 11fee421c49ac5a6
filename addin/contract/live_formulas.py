"""Formulas of columns that a reviewer can click on: the spreadsheet program repeats the result."""

from __future__ import annotations

from engine.case.defaults import WHOLE_STARTS

#: Defined name of the cell with the change whose shifts of frequency are shown as live formulas.
CHANGE_NAME = "SensitivityChange"


def _row(table: str, column: str) -> str:
    return f"{table}[[#This Row],[{column}]]"


_FREQUENCY = f"N({_row('NaturalFrequencies', 'Frequency')})*N(run_HzPerFrequency)"
_OF_MODE = (
    "INDEX(NaturalFrequencies[Frequency],"
    f"MATCH({_row('SeparationMargins', 'Mode')},NaturalFrequencies[Mode],0))"
)
_EXCITATION = f"({_row('SeparationMargins', 'Excitation frequency')}*run_HzPerExcitation)"
_MATERIAL = f"INDEX(Elements[Material],MATCH({_row('SteadyState', 'Element')},Elements[Element],0))"
_DAMAGE = f"N({_row('AllowableStarts', 'Damage')})"
_COUNTED = f"ISNUMBER({_row('AllowableStarts', 'Allowable starts')})"
_TRANSMITTED = f"({_row('TorqueReversals', 'Transmitted torque')}*run_NmPerTransmitted)"

PERCENT_SPEED_CHECK = (
    f"=IF(AND({_FREQUENCY}>0,{_FREQUENCY}<2*N(run_LineFrequency)),"
    f'100*(1-{_FREQUENCY}/(2*run_LineFrequency)),"")'
)
MARGIN_CHECK = f'=IFERROR(100*ABS({_OF_MODE}*run_HzPerFrequency-{_EXCITATION})/{_EXCITATION},"")'
UTS_CHECK = (
    f"=IFERROR(IF(INDEX(Materials[UTS],MATCH({_MATERIAL},Materials[Material],0))>0,"
    f"INDEX(Materials[UTS],MATCH({_MATERIAL},Materials[Material],0))"
    '*run_PaPerUTS/25/run_PaPerAllowable,""),"")'
)
REVERSAL_MARGIN_CHECK = (
    f"=IF(N({_row('TorqueReversals', 'Transmitted torque')})<>0,IFERROR("
    f"100*{_row('TorqueReversals', 'Minimum torque')}*run_NmPerMinimum/{_TRANSMITTED},"
    '""),"")'
)
CYCLE_DAMAGE_CHECK = (
    f"=IF(N({_row('StartCycles', 'Cycles to failure')})>0,"
    f'{_row("StartCycles", "Cycles")}/{_row("StartCycles", "Cycles to failure")},"")'
)
STARTS_CHECK = f'=IF({_COUNTED},1/{_DAMAGE},"")'
STARTS_TO_JUDGE = (
    f"=IF(AND({_COUNTED},N(run_StartsFactor)>0),"
    f'ROUNDDOWN({1 + WHOLE_STARTS!r}/{_DAMAGE}/run_StartsFactor,0),"")'
)


def sensitivity_shift(mode: int) -> str:
    """Shift of a mode by the change typed on sheet `Frequencies`, from its sensitivity."""
    return (
        f"=IFERROR({_row('FrequencySensitivities', f'Mode {mode}')}*N({CHANGE_NAME})*"
        "INDEX(NaturalFrequencies[Frequency],"
        f'MATCH({mode},NaturalFrequencies[Mode],0)),"")'
    )


def energy_shift(mode: int) -> str:
    """Shift of a mode by that change, from the share of the energy. [Hz]"""
    return (
        f"=IF(ISNUMBER({_row('EnergyShares', f'Share {mode}')}),"
        f'IFERROR(IF(RIGHT({_row("EnergyShares", "Quantity")},9)="stiffness",0.5,-0.5)*'
        f"{_row('EnergyShares', f'Share {mode}')}*N({CHANGE_NAME})*"
        "INDEX(NaturalFrequencies[Frequency],"
        f'MATCH({mode},NaturalFrequencies[Mode],0))*run_HzPerFrequency,""),"")'
    )
