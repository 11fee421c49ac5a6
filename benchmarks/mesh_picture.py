"""Mesh torque of the example `backlash` about its lowest mode: docs/images/backlash_start.png.

`python -m benchmarks.mesh_picture` calculates the shipped workbook with default settings and
draws the torque with the clearance and that of the linear start. A second panel enlarges a part, so
that drive flank, gap and back flank can be told apart.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from addin.contract.shipped import template_path
from addin.reading.one_file import read_checked
from benchmarks.plots import INK, plt
from engine.model.modal_analysis import analyse
from engine.run import planned_start
from engine.start.start import Start

__all__ = ["draw_backlash_start"]

Floats = NDArray[np.float64]

PICTURE = Path(__file__).resolve().parents[1] / "docs" / "images" / "backlash_start.png"
EXAMPLE, MESH = "example_backlash.xlsx", "Mesh"
#: The lowest mode is crossed within this time (sheet Start), and a part of it. [s]
SHOWN, ENLARGED = (5.2, 6.4), (5.68, 5.76)
POINTS = 20_000
#: Torque below this share of the largest is none: the teeth are in the gap.
NONE = 1e-9
CLEARANCE, LINEAR, GAP, PART = "#0b6e4f", "#c2571a", "#bcd0ea", "#f3efe3"


def mesh_torque(start: Start, times: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Torque of the mesh by the cubic between samples, and whether the teeth are in the gap."""
    names = [p.element for p in start.peaks]
    output = start.output_of_element[start.output_of_element >= 0][names.index(MESH)]
    t, y = start.trajectory.time, start.trajectory.torque[output]
    slope = start.trajectory.torque_rate[output]
    i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    h = t[i + 1] - t[i]
    s, rise, a, b = (times - t[i]) / h, y[i + 1] - y[i], h * slope[i], h * slope[i + 1]
    torque = y[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
    return torque, np.abs(torque) <= NONE * float(np.max(np.abs(y)))


def draw_backlash_start(path: Path = PICTURE) -> None:
    """Calculate the example and draw the torque of its mesh about the lowest mode."""
    case = read_checked(template_path(EXAMPLE)).case()
    rated = case.ratings.rated_torque or 1.0
    planned = planned_start(case, analyse(case))
    figure, places = plt.subplots(2, 1, figsize=(9.0, 6.6), dpi=150, layout="constrained")
    for axes, span in zip(places, (SHOWN, ENLARGED), strict=True):
        _draw(axes, planned.start, planned.linear, span, rated)
    places[0].axvspan(*ENLARGED, color=PART, zorder=0)
    places[0].set_title(
        "Example backlash: torque of the mesh as 2 × slip frequency passes the lowest mode",
        loc="left", fontsize=11, color=INK,
    )  # fmt: skip
    places[1].set_title("The shaded part, enlarged", loc="left", fontsize=11, color=INK)
    places[1].set_xlabel("Time after breaker closing [s]", color=INK)
    figure.legend(
        *places[1].get_legend_handles_labels(),
        loc="outside lower center", ncols=3, frameon=False, fontsize=9,
    )  # fmt: skip
    figure.savefig(path)
    plt.close(figure)


def _draw(axes: Axes, start: Start, linear: Start, span: tuple[float, float], rated: float) -> None:
    """One stretch of time."""
    times = np.linspace(*span, POINTS)
    torque, in_gap = mesh_torque(start, times)
    axes.plot(
        times, mesh_torque(linear, times)[0] / rated, "--", color=LINEAR, linewidth=1.0,
        label="linear start: teeth never part",
    )  # fmt: skip
    axes.plot(times, torque / rated, color=CLEARANCE, linewidth=1.2, label="with the clearance")
    low, high = axes.get_ylim()
    axes.fill_between(
        times, low, high, where=in_gap, color=GAP, linewidth=0.0, zorder=0.5,
        label="in the gap: no tooth carries load",
    )  # fmt: skip
    axes.set_ylim(low, high)
    axes.set_xlim(*span)
    for place, words in ((0.97, "drive flank ↑"), (0.03, "back flank ↓")):
        axes.text(
            0.01, place, words, transform=axes.transAxes, fontsize=8.5, color=INK,
            va="top" if place > 0.5 else "bottom",
        )  # fmt: skip
    axes.set_ylabel("Torque / rated", color=INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK)


if __name__ == "__main__":
    draw_backlash_start()
