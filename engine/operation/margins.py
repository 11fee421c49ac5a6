"""Separation margins, the bands of frequencies they forbid, and the interference diagram.

margin = |f − f_exc| / f_exc, the least over the speeds of continuous operation, and 0 when the
line of the excitation crosses the natural frequency there. Solved for f over the speeds of
continuous operation it forbids the band f_min (1 − m) < f < f_max (1 + m) round each excitation, with
f_min and f_max its frequencies at the lowest and the highest speed; a mode on the edge keeps its margin.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Steady state
torsional analysis" (20 % for calculated, 10 % for measured frequencies) and Table 1 (% speed).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.model.excitation import Excitation, operating_range
from engine.model.modes import Modes
from engine.model.train import Train
from engine.operation.standards import required_margin

#: A margin this much below the required one is the required one, rounded.
MARGIN_ROUNDING = 1e-9
#: The interference diagram reaches this multiple of synchronous speed.
DIAGRAM_REACH = 1.1


@dataclass(frozen=True)
class MarginRow:
    """One natural frequency against one excitation."""

    mode: int  #: Elastic mode, counted from 1.
    mode_frequency: float  #: Natural frequency. [Hz]
    excitation: str  #: Excitation.
    #: Speed of the reference shaft where the margin is least; None for a fixed frequency. [rad/s]
    speed: float | None
    excitation_frequency: float  #: Frequency of the excitation there. [Hz]
    margin: float  #: |f − f_exc| / f_exc. [1]
    required: float  #: Required margin. [1]
    #: ``pass``, ``pass within its error``, ``accepted by forced response``, ``fail`` or ``not
    #: judged``; before the forced response is known, ``pass`` or ``fail``.
    verdict: Judgement
    #: Elements that keep it from being accepted, with their shares of the mode, or why the frequency
    #: is not accurate; None elsewhere.
    not_judged: str | None = None

    @property
    def kept(self) -> bool:
        """Whether the margin itself is kept; one equal to the required to 1e-9 is. [flag]"""
        return self.margin >= self.required - MARGIN_ROUNDING


@dataclass(frozen=True)
class SeparationMargins:
    """Every elastic mode against every excitation."""

    rows: tuple[MarginRow, ...]  #: In the order of modes, then of excitations. [rows]
    required: float  #: Required margin. [1]
    #: Lowest and highest speed of continuous operation, of the reference shaft. [rad/s]
    speed_range: tuple[float, float] | None
    warnings: tuple[str, ...]  #: What could not be judged.

    @property
    def worst(self) -> MarginRow | None:
        """Row with the least margin; None if there is none. [row]"""
        return min(self.rows, key=lambda row: row.margin, default=None)

    @property
    def not_kept(self) -> tuple[MarginRow, ...]:
        """Rows whose margin is too small, whatever the forced response says. [rows]"""
        return tuple(row for row in self.rows if not row.kept)


def separation_margins(
    case: CaseData,
    train: Train,
    modes: Modes,
    excitations: Sequence[Excitation],
    accurate_up_to: float = math.inf,
) -> SeparationMargins:
    """Least margin of every elastic mode from every excitation over the operating range.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]
    excitations : sequence of Excitation
        What shakes it, from `excitation.excitations_of`. [SI]
    accurate_up_to : float, optional
        A mode above is listed only where it may be too near, and not judged: its true frequency is
        higher, as pieces with half their inertia at each end lower it. [Hz]

    Returns
    -------
    SeparationMargins
        With the verdict of the margin alone; `judge` adds the forced response. [1]
    """
    required = required_margin(case)
    speeds = operating_range(case)
    judged = [x for x in excitations if x.frequency is not None or speeds is not None]
    rows = []
    twists = modes.twists[modes.n_rigid :]  # no torque drives a mode of lateral motion alone
    for mode, f in enumerate(modes.elastic_frequency.tolist(), start=1):
        for x in judged if twists[mode - 1] else ():
            f_exc = nearest_frequency(x, f, speeds)
            margin = abs(f - f_exc) / f_exc
            speed = None
            if x.order is not None:
                speed = 2.0 * math.pi * f_exc / (x.order * x.ratio)
            row = MarginRow(mode, f, x.name, speed, f_exc, margin, required, Judgement.PASS)
            if f <= accurate_up_to:
                rows.append(row if row.kept else replace(row, verdict=Judgement.FAIL))
            elif not (row.kept and f > f_exc):
                why = f"frequencies are accurate up to {accurate_up_to:.4g} Hz only"
                rows.append(replace(row, verdict=Judgement.NOT_JUDGED, not_judged=why))
    return SeparationMargins(tuple(rows), required, speeds, _warnings(case, excitations, judged))


def nearest_frequency(
    excitation: Excitation, frequency: float, speeds: tuple[float, float] | None
) -> float:
    """Frequency of an excitation, over a range of speeds, that comes nearest to a given one.

    Parameters
    ----------
    excitation : Excitation
        The excitation. [SI]
    frequency : float
        The given frequency. [Hz]
    speeds : tuple of float, or None
        Lowest and highest speed of the reference shaft; may be None for a fixed frequency. [rad/s]

    Returns
    -------
    float
        The given frequency if it lies in the range, else that of the nearer end, to 14 digits. [Hz]
    """
    low, high = speeds or (0.0, 0.0)
    nearest = min(max(frequency, excitation.frequency_at(low)), excitation.frequency_at(high))
    # 2 × 1800 rpm is 1 × 60 Hz: rounding must not choose the nearer of them.
    return nearest if nearest == frequency else float(f"{nearest:.14g}")


def _warnings(
    case: CaseData, excitations: Sequence[Excitation], judged: Sequence[Excitation]
) -> tuple[str, ...]:
    left_out = [x.name for x in excitations if x not in judged]
    warnings = []
    if left_out:
        warnings.append(
            f"No margin from {', '.join(left_out)}: the operating speed is unknown. Give "
            "SynchronousSpeed, or LineFrequency and Poles, or MinimumSpeed and MaximumSpeed."
        )
    if not case.excitations and case.ratings.line_frequency is None:
        warnings.append("No margin from the line frequency, which is unknown. Give LineFrequency.")
    return tuple(warnings)


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
    bands = []
    for x in excitations:
        if x.frequency is None and speeds is None:
            continue
        low, high = (x.frequency_at(speed) for speed in speeds or (0.0, 0.0))
        bands.append(Band(x.name, low * (1.0 - required), high * (1.0 + required), low, high))
    return tuple(sorted(bands, key=lambda b: (b.from_, b.to, b.excitation)))


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
    windows, reached = [], 0.0
    for band in sorted(bands, key=lambda b: b.from_):
        if band.from_ > reached:
            windows.append(Window(reached, band.from_))
        reached = max(reached, band.to)
    return (*windows, Window(reached, None))


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
    rows = []
    for band in bands:
        inside = [f"mode {mode}" for mode, excitation in too_near if excitation == band.excitation]
        row = {name.rstrip("_"): value for name, value in asdict(band).items()}
        rows.append(row | {"modes_inside": ", ".join(inside) or None})
    return rows


def percent_speed(frequency: float, line_frequency: float) -> float | None:
    """Percent of synchronous speed where the start's pulsation crosses a natural frequency.

    The pulsation has twice the slip frequency, 2 f_line (1 − s) at the speed fraction s.

    Parameters
    ----------
    frequency : float
        Natural frequency. [Hz]
    line_frequency : float
        Line frequency. [Hz]

    Returns
    -------
    float or None
        100 (1 − f / 2 f_line); None above twice the line frequency, never crossed. [%]
    """
    if frequency > 2.0 * line_frequency:
        return None
    return 100.0 * (1.0 - frequency / (2.0 * line_frequency))


@dataclass(frozen=True, eq=False)
class Interference:
    """Lines of the interference (Campbell) diagram: each is straight, from standstill on."""

    #: Speed of the reference shaft to which it reaches; None if no speed is known. [rad/s]
    highest_speed: float | None
    mode_frequency: Floats  #: Natural frequencies, the horizontal lines. [Hz] Shape (n_elastic,).
    #: Excitations that follow the speed, each with its frequency at the highest speed. [Hz]
    orders: tuple[tuple[str, float], ...]
    fixed: tuple[tuple[str, float], ...]  #: Excitations of fixed frequency, each with it. [Hz]


def interference(case: CaseData, modes: Modes, excitations: Sequence[Excitation]) -> Interference:
    """Interference diagram from standstill to 1.1 times synchronous (or the highest) speed.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modes : Modes
        Its modes. [SI]
    excitations : sequence of Excitation
        What shakes it. [SI]

    Returns
    -------
    Interference
        The lines. [Hz]
    """
    speeds = operating_range(case) or (0.0,)
    highest = DIAGRAM_REACH * max(speeds[-1], case.ratings.synchronous_speed or 0.0)
    return Interference(
        highest or None,
        modes.elastic_frequency,
        tuple((x.name, x.frequency_at(1.0) * highest) for x in excitations if x.frequency is None),
        tuple((x.name, x.frequency) for x in excitations if x.frequency is not None),
    )
