"""Where a mode may not lie: the band of frequencies round every continuous excitation.

The required margin m = |f − f_exc| / f_exc over the speeds of continuous operation, solved for f:
forbidden is f_min (1 − m) < f < f_max (1 + m), with f_min and f_max the frequencies of the excitation
at the lowest and the highest speed. A mode on the edge keeps its margin.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Steady state
torsional analysis".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from engine.case.data import CaseData
from engine.model.excitation import Excitation, operating_range
from engine.operation.margins import required_margin

__all__ = ["Band", "Window", "forbidden_bands", "free_windows", "rows_of_bands"]


@dataclass(frozen=True)
class Band:
    """Frequencies that one excitation forbids to every mode."""

    excitation: str  #: Excitation.
    from_: float  #: Ends of the band; a mode between them has too small a margin. [Hz]
    to: float  #: Likewise. [Hz]
    lowest: float  #: Frequency of the excitation over the speeds of continuous operation. [Hz]
    highest: float  #: Likewise. [Hz]


@dataclass(frozen=True)
class Window:
    """Frequencies that no excitation forbids."""

    from_: float  #: Lower end. [Hz]
    to: float | None  #: Upper end; None above the highest band. [Hz]


def forbidden_bands(case: CaseData, excitations: Sequence[Excitation]) -> tuple[Band, ...]:
    """The band of every excitation whose frequency is known.

    Parameters
    ----------
    case : CaseData
        The case: speeds of continuous operation, required margin. [SI]
    excitations : sequence of Excitation
        What shakes the train, from `excitation.excitations_of`. [SI]

    Returns
    -------
    tuple of Band
        In rising frequency. [Hz]
    """
    required, speeds = required_margin(case), operating_range(case)
    found = []
    for x in excitations:
        if x.frequency is None and speeds is None:
            continue
        low, high = (x.frequency_at(speed) for speed in speeds or (0.0, 0.0))
        found.append(Band(x.name, low * (1.0 - required), high * (1.0 + required), low, high))
    return tuple(sorted(found, key=lambda b: (b.from_, b.to, b.excitation)))


def free_windows(bands: Sequence[Band]) -> tuple[Window, ...]:
    """What the bands leave free: where modes may be placed.

    Parameters
    ----------
    bands : sequence of Band
        Forbidden bands in any order. [Hz]

    Returns
    -------
    tuple of Window
        In rising frequency, the last one open above. [Hz]
    """
    found, reached = [], 0.0
    for band in sorted(bands, key=lambda b: b.from_):
        if band.from_ > reached:
            found.append(Window(reached, band.from_))
        reached = max(reached, band.to)
    return (*found, Window(reached, None))


def rows_of_bands(
    bands: Sequence[Band], too_near: Sequence[tuple[int, str]]
) -> list[dict[str, Any]]:
    """Bands as rows of plain values, with the modes inside each.

    Parameters
    ----------
    bands : sequence of Band
        Forbidden bands. [Hz]
    too_near : sequence of (int, str)
        Modes that do not keep the margin, each with the excitation. [count, name]

    Returns
    -------
    list of dict
        Keys excitation, from, to, lowest, highest [Hz] and modes_inside (None = clear).
    """
    return [
        {
            "excitation": band.excitation,
            "from": band.from_,
            "to": band.to,
            "lowest": band.lowest,
            "highest": band.highest,
            "modes_inside": ", ".join(f"mode {m}" for m, x in too_near if x == band.excitation)
            or None,
        }
        for band in bands
    ]
