"""Draw the figures of the theory pages: `python scripts/theory_figures.py`.

The pictures are kept in docs/images, so that the pages need no drawing; this file is run again where one changes.
Curves are calculated here, from the equation beside which the figure stands.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
INK, BLUE, ORANGE, GREEN, GREY = "#22303c", "#2f5fa8", "#c8641b", "#3a7d44", "#8a949e"

matplotlib.rcParams.update(
    {
        "svg.fonttype": "path",  # roots and bars of equations need the font they were laid out with
        "svg.hashsalt": "torsionbook",  # the same file from the same drawing
        "font.family": "sans-serif",
        "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib: the same on every machine
        "font.size": 10,
        "text.color": INK,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "xtick.color": INK,
        "ytick.color": INK,
        "lines.linewidth": 1.6,
    }
)


def _drawing(width: float, height: float) -> tuple[Figure, Axes]:
    """A sheet without axes, in units of its own width and height. [in]"""
    figure = Figure(figsize=(width, height))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(0, height), aspect="equal")
    axes.set_axis_off()
    return figure, axes


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=12, color=color))


def incidence() -> Figure:
    """Four stations, two shafts and a mesh, with the matrix that gives the twists."""
    figure, axes = _drawing(7.4, 2.6)
    stations = {"motor": (0.6, 1.7), "gear": (2.2, 1.7), "pinion": (2.2, 0.95), "load": (3.8, 0.95)}
    heights = {"motor": 1.1, "gear": 0.9, "pinion": 0.5, "load": 0.9}
    for number, (name, (x, y)) in enumerate(stations.items(), 1):
        size = heights[name]
        axes.add_patch(
            Rectangle((x - 0.14, y - size / 2), 0.28, size, fc="#dfe7f2", ec=INK, zorder=2)
        )
        above = name in ("motor", "gear")
        axes.text(
            x, y + (size / 2 + 0.1 if above else -size / 2 - 0.1), f"{number} {name}",
            ha="center", va="bottom" if above else "top",
        )  # fmt: skip
    for (x1, x2, y), name in (((0.74, 2.06, 1.7), "shaft a"), ((2.34, 3.66, 0.95), "shaft b")):
        axes.plot([x1, x2], [y, y], color=BLUE, lw=3)
        axes.text((x1 + x2) / 2, y + 0.08, name, ha="center", va="bottom", color=BLUE)
    axes.text(1.98, 1.22, "mesh", ha="right", va="center", color=ORANGE)
    axes.plot([2.06, 2.34], [1.22, 1.22], color=ORANGE, lw=3, zorder=3)
    axes.text(4.5, 1.35, "B  =", ha="left", va="center", size=12)
    rows = (
        ("shaft a", BLUE, "+1", "−1", "0", "0"),
        ("mesh", ORANGE, "0", "+1", "−n₂/n₃", "0"),
        ("shaft b", BLUE, "0", "0", "+1", "−1"),
    )
    columns = (5.25, 5.65, 6.1, 6.6)
    for x, number in zip(columns, "1234", strict=True):
        axes.text(x, 2.05, number, ha="center", color=GREY)
    for k, (name, color, *entries) in enumerate(rows):
        y = 1.7 - 0.35 * k
        axes.text(7.35, y, name, ha="right", va="center", color=color, size=8)
        for x, entry in zip(columns, entries, strict=True):
            axes.text(x, y, entry, ha="center", va="center")
    for x, turn in ((5.0, 0.08), (6.76, -0.08)):
        axes.plot([x + turn, x, x, x + turn], [1.92, 1.92, 0.78, 0.78], color=INK, lw=1)
    axes.text(5.9, 0.5, "twist = B θ", ha="center", va="top")
    return figure


def mesh() -> Figure:
    """Both gears of an external mesh, cut free."""
    figure, axes = _drawing(6.4, 3.0)
    slope = np.radians(20.0)
    gears = (
        ((1.5, 1.5), 1.0, BLUE, "driver", "r_{b1}", "θ_1", -1.0),
        ((4.7, 1.5), 0.75, ORANGE, "driven", "r_{b2}", "θ_2", 1.0),
    )
    for (x, y), radius, color, name, base, angle, sign in gears:
        axes.add_patch(Circle((x, y), radius, fc="none", ec=color, lw=1.6))
        axes.add_patch(Circle((x, y), radius * np.cos(slope), fc="none", ec=color, lw=0.8, ls="--"))
        axes.add_patch(Circle((x, y), 0.05, color=color))
        axes.text(x, y + radius + 0.12, name, ha="center", color=color)
        base_radius = radius * np.cos(slope)
        axes.plot(
            [x, x + base_radius * np.sin(0.3)], [y, y + base_radius * np.cos(0.3)],
            color=color, lw=0.8,
        )  # fmt: skip
        axes.text(x - 0.05, y + 0.35, f"${base}$", color=color, ha="right")
        axes.text(
            x + 0.1, y - 0.22, f"${angle}$, ${angle.replace('θ', 'u')}$", color=color, va="top"
        )
        start, end = np.radians((250.0, 290.0))[:: int(-sign)]
        _arrow(
            axes,
            (x + 0.8 * radius * np.cos(start), y + 0.8 * radius * np.sin(start)),
            (x + 0.8 * radius * np.cos(end), y + 0.8 * radius * np.sin(end)),
            color,
        )
    # the flank of the driver pushes the driven gear along n_d, and is pushed back
    for (x, y), way in (((3.95, 1.5), 1.0), ((2.5, 1.5), -1.0)):
        tip = x + way * 0.7 * np.sin(slope), y + way * 0.7 * np.cos(slope)
        _arrow(axes, (x, y), tip, INK)
        axes.text(
            tip[0] - 0.25 * (way > 0) + 0.1 * (way < 0), tip[1] + 0.05 * way,
            "$F\\,n_d$" if way > 0 else "$-F\\,n_d$", va="center", ha="right" if way > 0 else "left",
        )  # fmt: skip
    for x, radius, number in ((1.5, 1.0, 1), (4.7, 0.75, 2)):
        y = 1.5 - radius - 0.08
        _arrow(axes, (x, y - 0.32), (x, y), GREEN)
        axes.text(
            x + 0.1, y - 0.2, f"$-(k_b u_{number} + c_b \\dot u_{number})$",
            color=GREEN, va="center",
        )  # fmt: skip
    axes.text(6.3, 2.75, "– – base circles", ha="right", color=GREY, size=9)
    return figure


def crossings() -> Figure:
    """The paper's three modes crossed by twice the slip frequency and by the slip frequency."""
    figure = Figure(figsize=(6.4, 3.4), layout="constrained")
    axes = figure.subplots()
    line = 60.0
    speed = np.array([0.0, 100.0])
    axes.plot(speed, 2 * line * (1 - speed / 100), color=BLUE)
    axes.plot(speed, line * (1 - speed / 100), color=GREY, ls="--")
    axes.annotate(
        "2 × slip", (22, 93.6), (4, 4), textcoords="offset points", color=BLUE, va="bottom"
    )
    axes.annotate(
        "1 × slip (Pulsation1)", (1, 57.6), (2, -24), textcoords="offset points",
        color=GREY, va="top",
    )  # fmt: skip
    for number, mode in enumerate((30.0, 53.0, 86.0), 1):
        at = 100 * (1 - mode / (2 * line))
        axes.axhline(mode, color=INK, lw=0.8)
        axes.plot([at, at], [0, mode], color=ORANGE, lw=0.8, ls=":")
        axes.plot(at, mode, "o", color=ORANGE)
        axes.text(99, mode + 1.5, f"mode {number}, {mode:.0f} Hz", ha="right")
        axes.text(at + 1, 3, f"{at:.1f} %", color=ORANGE)
    axes.set(
        xlim=(0, 100), ylim=(0, 125), xlabel="speed [% of synchronous]", ylabel="frequency [Hz]"
    )
    return figure


def contact() -> Figure:
    """One impact on a flank, whose damping stops a mass: force against time by both laws."""
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = figure.subplots()
    damping = 2 * 0.15  # c / √(k m) of 15 % of critical
    step = 1e-4
    for name, color, style in (("no adhesion", ORANGE, "--"), ("limited", BLUE, "-")):
        gap, rate, times, forces = 0.0, 1.0, [0.0], [0.0]
        for k in range(int(4 / step)):
            pushed = damping * rate
            force = gap + (pushed if name == "no adhesion" else min(pushed, gap))
            if force < 0:
                break
            times.append(k * step)
            forces.append(force)
            rate -= force * step
            gap += rate * step
        axes.plot([*times, times[-1]], [*forces, 0.0], color=color, ls=style, label=name)
    axes.legend(frameon=False)
    axes.set(
        xlim=(0, 3.6), ylim=(0, 1.0), xlabel="time since touching, $t\\sqrt{k/m}$",
        ylabel="force, $F / (v\\sqrt{k m})$",
    )  # fmt: skip
    return figure


def rainflow() -> Figure:
    """A start's decaying torque: turning points, closed cycles, residue."""
    figure = Figure(figsize=(6.8, 3.2), layout="constrained")
    axes = figure.subplots()
    points = np.array([0.0, 3.0, -1.0, 2.0, 0.6, 1.6, -0.4, 1.2, 0.0])
    time = np.arange(points.size, dtype=float)
    axes.plot(time, points, color=GREY, lw=1)
    axes.plot(time, points, "o", color=INK, ms=4)
    stack: list[int] = []
    for k in range(points.size):
        stack.append(k)
        while len(stack) >= 4:
            a, b, c, d = (points[i] for i in stack[-4:])
            if abs(c - b) > abs(b - a) or abs(c - b) > abs(d - c):
                break
            first, second = stack[-3], stack[-2]
            axes.plot(time[[first, second]], points[[first, second]], color=ORANGE, lw=3)
            axes.annotate(
                "closed cycle", (time[second], points[second]),
                (2, 8), textcoords="offset points", color=ORANGE,
            )  # fmt: skip
            del stack[-3:-1]
    axes.plot(time[stack], points[stack], color=BLUE, lw=1.4, ls="--")
    axes.text(1.3, 2.7, "residue: half cycles", color=BLUE, ha="left", va="bottom")
    axes.axhline(0, color=INK, lw=0.6)
    axes.set(xlabel="turning points of the start, in order", ylabel="stress", xticks=[], yticks=[])
    return figure


def _branch(axes: Axes, x: float, names: tuple[str, ...], color: str) -> None:
    """Elements in series between the upper and the lower rail."""
    parts = len(names)
    axes.plot([x, x], [0.35, 1.85], color=color, lw=1, zorder=1)
    for k, name in enumerate(names):
        y = 1.85 - 1.5 * (k + 1) / (parts + 1)
        axes.add_patch(Rectangle((x - 0.09, y - 0.16), 0.18, 0.32, fc="white", ec=color, zorder=2))
        axes.text(x + 0.14, y, f"${name}$", ha="left", va="center", color=color, size=9)


def circuit() -> Figure:
    """Equivalent circuits of both axes, as the tables name their elements."""
    figure, axes = _drawing(7.4, 2.5)
    axis_d = ((1.2, ("X_{md}",), INK), (1.85, ("X_{lkd}", "R_{kd}"), BLUE),
              (2.65, ("X_{lf}", "R_f", "R_D"), ORANGE))  # fmt: skip
    axis_q = ((5.2, ("X_{mq}",), INK), (5.95, ("X_{lkq}", "R_{kq}"), BLUE))
    for left, branches, title in ((0.2, axis_d, "axis d"), (4.2, axis_q, "axis q")):
        right = branches[-1][0]
        for y in (0.35, 1.85):
            axes.plot([left, right], [y, y], color=INK, lw=1, zorder=1)
        for x, name in ((left + 0.25, "R_s"), (left + 0.68, "X_l")):
            axes.add_patch(Rectangle((x - 0.15, 1.77), 0.3, 0.16, fc="white", ec=INK, zorder=2))
            axes.text(x, 2.0, f"${name}$", ha="center", va="bottom", size=9)
        for x, names, color in branches:
            _branch(axes, x, names, color)
        axes.text(left, 1.1, title, ha="left", va="center", weight="bold")
    axes.add_patch(Rectangle((1.4, 1.77), 0.3, 0.16, fc="white", ec=INK, zorder=2))
    axes.text(1.55, 2.0, "$X_c$", ha="center", va="bottom", size=9)
    for x, name, color in (
        (1.85, "damper", BLUE),
        (2.65, "field and\ndischarge", ORANGE),
        (5.95, "damper", BLUE),
    ):
        axes.text(x, 0.28, name, ha="center", va="top", color=color, size=8)
    return figure


FIGURES = {
    "theory_incidence": incidence,
    "theory_mesh": mesh,
    "theory_crossings": crossings,
    "theory_contact": contact,
    "theory_rainflow": rainflow,
    "theory_circuit": circuit,
}


if __name__ == "__main__":
    for name, draw in FIGURES.items():
        draw().savefig(
            IMAGES / f"{name}.svg", metadata={"Date": None, "Creator": None}, facecolor="white"
        )
        print(f"docs/images/{name}.svg")
