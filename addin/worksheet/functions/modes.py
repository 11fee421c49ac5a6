"""Natural frequencies, mode shapes and energies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from addin.worksheet.answers import HEADERS, MODEL, Rows, at_speed_tables, shows_table
from addin.worksheet.registry import Argument, FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 20


@shows_table("TV_FREQUENCIES", "NaturalFrequencies", at_speed_tables, example='=%s(A1, "SI")')
def tv_frequencies(tables: Mapping[str, Any]) -> Any:
    """Natural frequencies with damping, start-up crossing and element of largest strain energy.

    Rigid-body modes come first with frequency 0.
    """
    return tables["NaturalFrequencies"]


@registered(
    "TV_MODE",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode, counted from 1."),
    HEADERS,
    columns=2,
    example="=TV_MODE(A1, 2)",
)
def tv_mode(handle: str, mode: int, headers: bool | None) -> Rows:
    """Shape of one mode: relative twist of each station, the largest = 1."""
    _, tables = at_speed_tables(handle)
    _check_mode(mode, len(tables["modes"]))
    rows: Rows = [[row["station"], row[f"mode_{mode}"]] for row in tables["ModeShapes"]]
    return rows if headers is False else [["Station", f"Mode {mode}"], *rows]


@registered(
    "TV_ENERGY",
    MODEL,
    Argument("Mode", "count", "The number of the elastic mode; blank = all.", True),
    HEADERS,
    columns=0,
    example="=TV_ENERGY(A1)",
)
def tv_energy(handle: str, mode: int | None, headers: bool | None) -> Rows:
    """Energy shares: of each element in the strain and of each station in the kinetic energy."""
    _, tables = at_speed_tables(handle)
    modes = tables["modes"]
    if mode is not None:
        _check_mode(mode, len(modes))
        modes = [modes[mode - 1]]
    if not modes:
        raise FunctionError(
            "The train has no elastic mode: no elastic element joins two inertias.", "#N/A"
        )
    rows: Rows = [
        [name, words, *(mode[kind][name] for mode in modes)]
        for kind, words in (("strain_energy", "strain"), ("kinetic_energy", "kinetic"))
        for name in modes[0][kind]
    ]
    head = ["Name", "Energy", *(f"Mode {m['mode']} [1]" for m in modes)]
    return rows if headers is False else [head, *rows]


def _check_mode(mode: int, count: int) -> None:
    if mode > count:
        raise FunctionError(f"Mode: found {mode}; the train has {count} elastic modes.", "#N/A")
