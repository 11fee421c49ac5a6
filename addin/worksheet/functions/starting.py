"""The start: speed, peaks, histories and torque reversals."""

from __future__ import annotations

import math
from typing import Any

from addin.charts.rows import decimate, thinned
from addin.worksheet.answers import (
    HEADERS,
    MODEL,
    NO_START,
    UNITS,
    Rows,
    name_in_case,
    run_of,
    shows_table,
    system_for,
    units_of,
)
from addin.worksheet.registry import Argument, FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 50


#: Points of a decimated curve, unless asked otherwise; and the most. [count]
USUAL_POINTS, MOST_POINTS = 501, 20_001
POINTS = Argument(
    "Points", "count", f"Maximum number of rows without header; default {USUAL_POINTS}.", True
)


def _points(points: int | None) -> int:
    if points is not None and not 3 <= points <= MOST_POINTS:
        raise FunctionError(f"Points: found {points}; give 3 to {MOST_POINTS}.", "#NUM!")
    return USUAL_POINTS if points is None else points


@registered(
    "TV_SPEED_TIME",
    MODEL,
    POINTS,
    HEADERS,
    long=True,
    columns=3,
    example="=TV_SPEED_TIME(A1, 200)",
)
def tv_speed_time(handle: str, points: int | None, headers: bool | None) -> Rows:
    """Mean speed of the motor against time during the start."""
    limit = _points(points)
    _, run = run_of(handle)
    if run.view.speed_time is None or not run.case.ratings.synchronous_speed:
        raise FunctionError(NO_START, "#N/A")
    time, speed = run.view.speed_time
    kept = thinned(time, speed, limit)
    share = speed / run.case.ratings.synchronous_speed
    found: Rows = [
        [float(time[i]), float(speed[i]) * 30.0 / math.pi, 100.0 * float(share[i])] for i in kept
    ]
    return found if headers is False else [["Time [s]", "Speed [rpm]", "Speed [%]"], *found]


@shows_table("TV_PEAKS", "StartupPeaks", run_of)
def tv_peaks(run: Any) -> Any:
    """Largest and least torque of every element in the start, with the estimated error."""
    return run.tables.get("StartupPeaks")


@registered(
    "TV_HISTORY",
    MODEL,
    Argument("Element", "text", "The name of the element."),
    POINTS,
    UNITS,
    HEADERS,
    long=True,
    columns=2,
    example='=TV_HISTORY(A1, "LS coupling", 1000)',
)
def tv_history(
    handle: str, element: str, points: int | None, units: str | None, headers: bool | None
) -> Rows:
    """Torque of an element against time; thinned so that every interval keeps its extremes."""
    limit = _points(points)
    model, run = run_of(handle)
    histories = run.view.histories or {}
    if not histories:
        raise FunctionError(NO_START, "#N/A")
    name = name_in_case("Element", element, list(histories))
    shown, place = units_of(system_for(units, model)), ("StartupPeaks", "Maximum torque")
    unit, factor = shown.name(*place), shown.factor(*place)
    time, torque = histories[name]
    kept = decimate(time, torque, limit)
    rows: Rows = [[float(time[i]), float(torque[i]) / factor] for i in kept]
    return rows if headers is False else [["Time [s]", f"Torque [{unit}]"], *rows]


@shows_table(
    "TV_REVERSALS",
    "TorqueReversals",
    run_of,
    "The train has no gear mesh and no geared coupling.",
)
def tv_reversals(run: Any) -> Any:
    """Torque reversals, impacts and tooth force of meshes and geared couplings."""
    return run.tables.get("TorqueReversals")
