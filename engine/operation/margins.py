"""Separation margins and the interference diagram.

margin = |f − f_exc| / f_exc, the least over the speeds of continuous operation, and 0 when the
line of the excitation crosses the natural frequency there.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains (1978), "Steady state
torsional analysis" (20 % for calculated, 10 % for measured frequencies) and Table 1 (% speed).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from engine.case.data import CaseData
from engine.model.excitation import Excitation, operating_range
from engine.model.modes import Modes
from engine.model.train import Train

__all__ = [
    "ACCEPTED",
    "FAIL",
    "Interference",
    "JudgedResponse",
    "MARGIN_BY_BASIS",
    "MarginRow",
    "NOT_JUDGED",
    "PASS",
    "SeparationMargins",
    "UNBOUNDED",
    "interference",
    "judge",
    "percent_speed",
    "required_margin",
    "separation_margins",
]

Floats = NDArray[np.float64]

PASS, FAIL = "pass", "fail"
ACCEPTED = "accepted by forced response"
NOT_JUDGED = "not judged"
UNBOUNDED = "unbounded"

#: The paper: 20 percent for calculated, 10 percent for measured natural frequencies.
MARGIN_BY_BASIS = {"calculated": 0.20, "measured": 0.10}
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
    #: ``pass``, ``accepted by forced response`` or ``fail``; before the forced response is known,
    #: ``pass`` or ``fail``.
    verdict: str

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


def required_margin(case: CaseData) -> float:
    """Required margin: MarginRequired, else by MarginBasis.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    float
        Required margin. [1]
    """
    if case.margin_required is not None:
        return case.margin_required
    return MARGIN_BY_BASIS[case.margin_basis or "calculated"]


def separation_margins(
    case: CaseData, train: Train, modes: Modes, excitations: Sequence[Excitation]
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

    Returns
    -------
    SeparationMargins
        With the verdict of the margin alone; `judge` adds the forced response. [1]
    """
    required = required_margin(case)
    speeds = operating_range(case)
    known = [x for x in excitations if x.frequency is not None or speeds is not None]
    rows = []
    twists = modes.twists[modes.n_rigid :]  # no torque drives a mode of sideways motion alone
    for mode, f in enumerate(modes.elastic_frequency.tolist(), start=1):
        for x in known if twists[mode - 1] else ():
            f_exc = nearest_frequency(x, f, speeds)
            margin = abs(f - f_exc) / f_exc
            speed = None
            if x.order is not None:
                speed = 2.0 * math.pi * f_exc / (x.order * x.ratio)
            row = MarginRow(mode, f, x.name, speed, f_exc, margin, required, PASS)
            rows.append(row if row.kept else replace(row, verdict=FAIL))
    return SeparationMargins(tuple(rows), required, speeds, _warnings(case, excitations, known))


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
    case: CaseData, excitations: Sequence[Excitation], known: Sequence[Excitation]
) -> tuple[str, ...]:
    left_out = [x.name for x in excitations if x not in known]
    found = []
    if left_out:
        found.append(
            f"No margin from {', '.join(left_out)}: the operating speed is unknown. Give "
            "SynchronousSpeed, or LineFrequency and Poles, or MinimumSpeed and MaximumSpeed."
        )
    if not case.excitations and case.ratings.line_frequency is None:
        found.append("No margin from the line frequency: it is unknown. Give LineFrequency.")
    return tuple(found)


class JudgedResponse(Protocol):
    """What `judge` asks of a row of the steady-state response: mode, excitation, verdict."""

    @property
    def mode(self) -> int | None:
        """Elastic mode whose resonance the row is evaluated at; None for a sweep. [count]"""

    @property
    def excitation(self) -> str:
        """Excitation. [name]"""

    @property
    def verdict(self) -> str:
        """``pass``, ``fail``, ``unbounded`` or ``not judged``. [word]"""


def judge(margins: SeparationMargins, responses: Sequence[JudgedResponse]) -> SeparationMargins:
    """Margins with their final verdicts.

    ``pass``: the margin is kept, or equal to the required one to 1e-9. ``accepted by forced
    response``: it is not, but at the resonance with this excitation at least one element could
    be judged and every judged one is within its limit. ``fail``: the rest.

    Parameters
    ----------
    margins : SeparationMargins
        Margins. [1]
    responses : sequence of JudgedResponse
        Rows of the steady-state response. [rows]

    Returns
    -------
    SeparationMargins
        The same rows with their verdicts. [1]
    """
    verdicts: dict[tuple[int, str], set[str]] = {}
    for r in responses:
        if r.mode is not None and r.verdict != NOT_JUDGED:
            verdicts.setdefault((r.mode, r.excitation), set()).add(r.verdict)
    rows = []
    for row in margins.rows:
        verdict = PASS
        if not row.kept:
            accepted = verdicts.get((row.mode, row.excitation)) == {PASS}
            verdict = ACCEPTED if accepted else FAIL
        rows.append(replace(row, verdict=verdict))
    return replace(margins, rows=tuple(rows))


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
    """Lines of the interference (Campbell) diagram."""

    #: Speed of the reference shaft, from 0; empty if no speed is known. [rad/s] Shape (n_speeds,).
    speed: Floats
    mode_frequency: Floats  #: Natural frequencies, the horizontal lines. [Hz] Shape (n_elastic,).
    order_names: tuple[str, ...]  #: Excitations that follow the speed.
    order_frequency: Floats  #: Their frequencies. [Hz] Shape (n_orders, n_speeds).
    fixed_names: tuple[str, ...]  #: Excitations of fixed frequency.
    fixed_frequency: Floats  #: Their frequencies. [Hz] Shape (n_fixed,).
    #: Twice the slip frequency during the start; NaN above synchronous speed or if the line
    #: frequency is unknown. [Hz] Shape (n_speeds,).
    slip_frequency: Floats
    #: Percent speed where it crosses each mode; None where it never does. [%]
    crossing_percent: tuple[float | None, ...]
    speed_range: tuple[float, float] | None  #: Speeds of continuous operation. [rad/s]


def interference(
    case: CaseData,
    train: Train,
    modes: Modes,
    excitations: Sequence[Excitation],
    *,
    n_speeds: int = 111,
) -> Interference:
    """Interference diagram from standstill to 1.1 times synchronous (or the highest) speed.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    modes : Modes
        Its modes. [SI]
    excitations : sequence of Excitation
        What shakes it. [SI]
    n_speeds : int
        Number of speeds; 111 puts every percent of synchronous speed on the grid. [count]

    Returns
    -------
    Interference
        The lines. [Hz]
    """
    speeds, ratings = operating_range(case), case.ratings
    top = max((speeds or (0.0,))[-1], ratings.synchronous_speed or 0.0)
    speed = np.linspace(0.0, DIAGRAM_REACH * top, n_speeds) if top > 0.0 else np.empty(0)
    orders = [x for x in excitations if x.frequency is None]
    fixed = [x for x in excitations if x.frequency is not None]
    slope = np.array([x.frequency_at(1.0) for x in orders])
    line = ratings.line_frequency
    slip = np.full(len(speed), np.nan)
    crossing: list[float | None] = [None] * len(modes.elastic_frequency)
    if line:
        crossing = [percent_speed(f, line) for f in modes.elastic_frequency.tolist()]
        if ratings.synchronous_speed:
            fraction = speed / ratings.synchronous_speed
            below = fraction <= 1.0 + 1e-12
            slip[below] = 2.0 * line * np.maximum(0.0, 1.0 - fraction[below])
    return Interference(
        speed,
        modes.elastic_frequency,
        tuple(x.name for x in orders),
        slope[:, None] * speed[None, :],
        tuple(x.name for x in fixed),
        np.array([x.frequency for x in fixed], dtype=float),
        slip,
        tuple(crossing),
        speeds,
    )
