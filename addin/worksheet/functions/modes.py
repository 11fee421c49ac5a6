"""Natural frequencies, mode shapes and energies."""

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
from addin.worksheet.registry import Argument, FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 20


@registered(
    "TV_FREQUENCIES",
    MODEL,
    UNITS,
    HEADERS,
    columns=width_of("NaturalFrequencies"),
    example='=TV_FREQUENCIES(A1, "SI")',
)
def tv_frequencies(model: str, units: str | None, headers: bool | None) -> Rows:
    """Natural frequencies with damping, start-up crossing and the element that strains most.

    Rigid-body modes come first with frequency 0.
    """
    found, tables = at_speed_tables(model)
    rows = tables["NaturalFrequencies"]
    return table_cells(result_table("NaturalFrequencies"), rows, system_for(units, found), headers)


@registered(
    "TV_MODE",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode, counted from 1."),
    HEADERS,
    columns=2,
    example="=TV_MODE(A1, 2)",
)
def tv_mode(model: str, mode: int, headers: bool | None) -> Rows:
    """Shape of one mode: relative twist of each station, the largest = 1."""
    _, tables = at_speed_tables(model)
    key = f"mode_{mode}"
    rows = tables["ModeShapes"]
    _existing(mode, len(tables["modes"]))
    found: Rows = [[row["station"], row[key]] for row in rows]
    return found if headers is False else [["Station", f"Mode {mode}"], *found]


@registered(
    "TV_ENERGY",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode; blank = all.", True),
    HEADERS,
    columns=0,
    example="=TV_ENERGY(A1)",
)
def tv_energy(model: str, mode: int | None, headers: bool | None) -> Rows:
    """Energy shares: of each element in the strain and of each station in the kinetic energy."""
    _, tables = at_speed_tables(model)
    modes = tables["modes"]
    if mode is not None:
        _existing(mode, len(modes))
        modes = [modes[mode - 1]]
    if not modes:
        raise FunctionError("The train has no elastic mode: it has one station only.", "#N/A")
    found: Rows = []
    for kind, words in (("strain_energy", "strain"), ("kinetic_energy", "kinetic")):
        for name in modes[0][kind]:
            found.append([name, words, *(m[kind][name] for m in modes)])
    head = ["Name", "Energy", *(f"Mode {m['mode']} [1]" for m in modes)]
    return found if headers is False else [head, *found]


def _existing(mode: int, count: int) -> None:
    if mode > count:
        raise FunctionError(f"Mode: found {mode}; the train has {count} elastic modes.", "#N/A")
