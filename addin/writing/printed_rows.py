"""Rows of long result tables that decide something: these are printed, the others stand below them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from engine.case.result_words import Judgement

Row = Mapping[str, Any]
#: Modes are printed up to this multiple of the highest excitation; those above are far from every one.
_ABOVE_EXCITATION = 2.0
#: Cycles that fill the page on which they are printed; the largest damage stands first.
_CYCLES = 10


@dataclass(frozen=True)
class PrintedRows:
    """What of the long tables is printed."""

    counts: Mapping[str, int]  #: Table → how many of its first rows are printed. [count]
    response: Sequence[Row]  #: Rows of `SteadyState`, the printed ones first. [SI]
    on_modes: str = (
        ""  #: What is said of modes and margins that are not; empty = all are. [sentence]
    )
    on_response: str = ""  #: Likewise of steady-state responses. [sentence]


def printed_rows(tables: Mapping[str, Sequence[Row]]) -> PrintedRows:
    """The rows of `NaturalFrequencies`, `SeparationMargins` and `SteadyState` that are printed.

    Parameters
    ----------
    tables : mapping of str to sequence of mapping
        Rows of the result tables. [SI]

    Returns
    -------
    PrintedRows
        Modes up to twice the highest excitation, those that the start crosses and those with a margin that is no
        pass, with all below them; of each element the largest steady-state response and those over its limit.
    """
    modes, margins = tables.get("NaturalFrequencies", ()), tables.get("SeparationMargins", ())
    last = _last_mode(modes, margins)
    few_modes = sum(row["mode"] <= last for row in modes)
    few_margins = sum(row["mode"] <= last for row in margins)
    every = tables.get("SteadyState", ())
    few = _deciding(every)
    chosen = set(map(id, few))
    return PrintedRows(
        {
            "NaturalFrequencies": few_modes,
            "SeparationMargins": few_margins,
            "SteadyState": len(few),
            "StartCycles": _CYCLES,
        },
        [*few, *(row for row in every if id(row) not in chosen)],
        _on_modes(len(modes) - few_modes, len(margins) - few_margins),
        _on_response(len(every) - len(few)),
    )


def _last_mode(modes: Sequence[Row], margins: Sequence[Row]) -> int:
    """The highest mode that is printed; all of them where nothing excites the train."""
    if not margins:
        return max((row["mode"] for row in modes), default=0)
    highest = _ABOVE_EXCITATION * max(row["excitation_frequency"] for row in margins)
    failed = {row["mode"] for row in margins if row["verdict"] != Judgement.PASS}
    return max(
        row["mode"]
        for row in modes
        if row["frequency"] <= highest
        or row.get("percent_speed") is not None
        or row["mode"] in failed
    )


def _deciding(rows: Sequence[Row]) -> list[Row]:
    """Of each element the largest response, and those that are judged and no pass."""
    largest: dict[str, Row] = {}
    for row in rows:
        element = row["element"]
        if element not in largest or (row["torque"] or 0.0) > (largest[element]["torque"] or 0.0):
            largest[element] = row
    no_limit = (Judgement.PASS, Judgement.NOT_JUDGED)
    return [row for row in rows if row is largest[row["element"]] or row["verdict"] not in no_limit]


def _on_modes(modes: int, margins: int) -> str:
    if not modes:
        return ""
    many = "1 higher mode" if modes == 1 else f"{modes} higher modes"
    return f"Printed: modes up to twice the highest excitation. {many} with {margins} margins, each kept, below them: not printed."


def _on_response(count: int) -> str:
    if not count:
        return ""
    rest = "1 other stands" if count == 1 else f"{count} others stand"
    return f"Printed: the largest response of each element and each one over its limit. {rest} below: not printed."
