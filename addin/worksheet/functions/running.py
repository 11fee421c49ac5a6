"""Continuous operation: separation margins, forbidden bands, steady state."""

from __future__ import annotations

from addin.contract.tables import result_table
from addin.worksheet.answers import (
    HEADERS,
    MODEL,
    UNITS,
    Rows,
    at_speed_tables,
    system_for,
    table_cells,
    width_of,
)
from addin.worksheet.registry import FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 40


@registered(
    "TV_MARGINS",
    MODEL,
    UNITS,
    HEADERS,
    columns=width_of("SeparationMargins"),
    example="=TV_MARGINS(A1)",
)
def tv_margins(model: str, units: str | None, headers: bool | None) -> Rows:
    """Separation margin of every mode from every excitation, with its verdict."""
    found, tables = at_speed_tables(model)
    rows = tables["SeparationMargins"]
    if not rows:
        raise FunctionError("Nothing is judged: the case states no speed and no line.", "#N/A")
    return table_cells(result_table("SeparationMargins"), rows, system_for(units, found), headers)


#: Columns of `ForbiddenBands` that one case has.
BAND_COLUMNS = ("Excitation", "From", "To", "Lowest", "Highest", "Modes inside")


@registered(
    "TV_BANDS",
    MODEL,
    UNITS,
    HEADERS,
    columns=len(BAND_COLUMNS),
    example="=TV_BANDS(A1)",
)
def tv_bands(model: str, units: str | None, headers: bool | None) -> Rows:
    """Where no mode may lie: the band of frequencies round every excitation, and the modes inside.

    From and To are the required margin solved for the frequency: f_min (1 - m) and f_max (1 + m).
    """
    found, tables = at_speed_tables(model)
    rows, spec = tables["ForbiddenBands"], result_table("ForbiddenBands")
    if not rows:
        raise FunctionError("No bands: the case states no speed and no line.", "#N/A")
    columns = [spec.column(name) for name in BAND_COLUMNS]
    return table_cells(spec, rows, system_for(units, found), headers, columns)


@registered(
    "TV_STEADY", MODEL, UNITS, HEADERS, columns=width_of("SteadyState"), example="=TV_STEADY(A1)"
)
def tv_steady(model: str, units: str | None, headers: bool | None) -> Rows:
    """Forced response where a margin is not kept: torque, stress and UTS/25."""
    found, tables = at_speed_tables(model)
    rows = tables["SteadyState"]
    if not rows:
        raise FunctionError("Every margin is kept, so no forced response is needed.", "#N/A")
    return table_cells(result_table("SteadyState"), rows, system_for(units, found), headers)
