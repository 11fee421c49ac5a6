"""Error against time, and time against size: docs/images/bench_*.png."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.ticker import FuncFormatter, NullFormatter  # noqa: E402

from benchmarks.measure import Point  # noqa: E402
from benchmarks.modes import ModesRow  # noqa: E402

__all__ = ["draw_error_against_time", "draw_growth", "draw_modes", "draw_tolerances"]

#: Colour and marker by the program a label begins with; the variants differ by line style.
LOOK = {
    "torsionbook": ("#0b6e4f", "o"),
    "torsionbook Newmark": ("#c2571a", "D"),
    "openTorsion": ("#7a3e9d", "s"),
    "ROSS": ("#1f5fa8", "^"),
}
STYLES = ("-", "--", ":", "-.")
INK = "#333333"


def _look(label: str) -> tuple[str, str]:
    return LOOK[max((name for name in LOOK if label.startswith(name)), key=len)]


def _times(seconds: float, _: object = None) -> str:
    """1 µs, 20 ms, 3 s."""
    for factor, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= 0.9995 * factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds:.3g} s"


def _plain(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, which="both")


def draw_error_against_time(
    path: Path,
    title: str,
    points: Mapping[str, Sequence[Point]],
    notes: Mapping[str, str] | None = None,
) -> None:
    """One line a method, one marker a step; lower left is better."""
    figure, axes = plt.subplots(figsize=(8.4, 5.4), dpi=150)
    seen: dict[str, int] = {}
    for label, found in points.items():
        colour, marker = _look(label)
        style = STYLES[seen.get(colour, 0) % len(STYLES)]
        filled = seen.get(colour, 0) == 0
        seen[colour] = seen.get(colour, 0) + 1
        ordered = sorted(found, key=lambda p: -p.step)
        axes.plot(
            [p.seconds for p in ordered],
            [p.error for p in ordered],
            style,
            color=colour,
            marker=marker,
            markersize=6,
            markerfacecolor=colour if filled else "white",
            linewidth=1.6,
            label=label + (notes or {}).get(label, ""),
        )
        for p, side in ((ordered[0], -1), (ordered[-1], 1)):
            axes.annotate(
                f"{1e3 * p.step:g} ms",
                (p.seconds, p.error),
                textcoords="offset points",
                xytext=(7 * side, -3),
                ha="left" if side > 0 else "right",
                fontsize=7.5,
                color=colour,
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    for target in (1e-3, 1e-4):
        axes.axhline(target, color="#999999", linewidth=0.8, linestyle=(0, (1, 3)))
    axes.xaxis.set_major_formatter(FuncFormatter(_times))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.margins(x=0.12)
    axes.set_xlabel("Time of one call (median)", color=INK)
    axes.set_ylabel("Trajectory error: max |T − T_ref| / max |T_ref|", color=INK)
    axes.set_title(title, loc="left", fontsize=11, color=INK)
    _plain(axes)
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False, fontsize=8.5
    )
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)


def draw_modes(path: Path, rows: Sequence[ModesRow], calls: Sequence[str]) -> None:
    """Left: time against stations. Right: error of the first frequency, plain and hard train."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.8, 4.8), dpi=150, layout="constrained")
    seen: dict[str, int] = {}
    problems = list(dict.fromkeys(r.problem for r in rows))
    ordinary = [p for p in problems if p.endswith("stations")]
    hard = [p for p in problems if p not in ordinary]
    shown = [c for c in calls if any(r.method == c and r.timing for r in rows)]
    for place, call in enumerate(shown):
        colour, marker = _look(call)
        count = seen.get(colour, 0)
        seen[colour] = count + 1
        of_it = {r.problem: r for r in rows if r.method == call and r.timing}
        sizes = [(int(p.split()[0]), of_it[p].timing.seconds) for p in ordinary if p in of_it]  # type: ignore[union-attr]
        left.plot(
            *zip(*sizes, strict=True),
            STYLES[count % len(STYLES)],
            color=colour,
            marker=marker,
            markerfacecolor=colour if count == 0 else "white",
            label=call,
        )
        for problem, face in ((ordinary[0], "white"), *((h, colour) for h in hard)):
            if problem in of_it:
                value = max(of_it[problem].lowest_error, 1e-17)
                right.plot(value, place, marker, color=colour, markerfacecolor=face, markersize=8)
    left.set_xscale("log")
    left.set_yscale("log")
    left.set_xticks([int(p.split()[0]) for p in ordinary], [p.split()[0] for p in ordinary])
    left.xaxis.set_minor_formatter(NullFormatter())
    left.yaxis.set_major_formatter(FuncFormatter(_times))
    left.set_xlabel("Stations", color=INK)
    left.set_title("Time of one call (median)", loc="left", fontsize=11, color=INK)
    right.set_xscale("log")
    right.set_yticks(range(len(shown)), shown, fontsize=8.5)
    right.invert_yaxis()
    right.set_xlim(3e-18, 30.0)
    right.set_xlabel(
        "open: plain train   filled: one link of 5e16 N·m/rad",
        color=INK,
        fontsize=8.5,
    )
    right.set_title("Error of the first frequency presented", loc="left", fontsize=11, color=INK)
    for axes in (left, right):
        _plain(axes)
    figure.legend(
        *left.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=3,
        frameon=False,
        fontsize=8.5,
    )
    figure.savefig(path)
    plt.close(figure)


def draw_tolerances(path: Path, groups: Mapping[str, Sequence[tuple[float, float]]]) -> None:
    """Left: share of answers below an error over tolerance. Right: reported over true error."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.8, 4.6), dpi=150, layout="constrained")
    colours = ("#0b6e4f", "#1f5fa8", "#7a3e9d", "#c2571a")
    for (label, pairs), colour in zip(groups.items(), colours, strict=False):
        for axes, place in ((left, 0), (right, 1)):
            values = sorted(max(p[place], 1e-12) for p in pairs if p[place] < float("inf"))
            share = [(i + 1) / len(pairs) for i in range(len(values))]
            axes.step(values, share, where="post", color=colour, linewidth=1.6, label=label)
    left.axvline(1.0, color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
    right.axvline(1.0, color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
    right.axvline(30.0, color="#999999", linewidth=0.9, linestyle=(0, (1, 3)))
    left.set_xlim(1e-7, 30.0)
    right.set_xlim(0.1, 1e5)
    for axes, title in (
        (left, "True error over tolerance"),
        (right, "Reported error over true error"),
    ):
        axes.set_xscale("log")
        axes.set_ylim(0.0, 1.02)
        axes.set_title(title, loc="left", fontsize=11, color=INK)
        axes.set_ylabel("Share of the answers", color=INK)
        _plain(axes)
    figure.legend(
        *left.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=4,
        frameon=False,
        fontsize=8.5,
    )
    figure.savefig(path)
    plt.close(figure)


def draw_growth(path: Path, basis: Mapping[int, float], loop: Mapping[int, float]) -> None:
    """Left: train and modes against stations. Right: one step against modes kept."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.8, 4.4), dpi=150, layout="constrained")
    for axes, found, power in ((left, basis, 2), (right, loop, 1)):
        size, seconds = list(found), list(found.values())
        axes.plot(size, seconds, "-o", color="#0b6e4f", linewidth=1.6, label="torsionbook")
        guide = [seconds[-1] * (n / size[-1]) ** power for n in size]
        label = "n²" if power == 2 else "n"
        axes.plot(size, guide, linestyle=(0, (4, 3)), color="#999999", linewidth=1.0, label=label)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(size, [str(n) for n in size], fontsize=8.5)
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_formatter(FuncFormatter(_times))
        axes.legend(frameon=False, fontsize=8.5)
        _plain(axes)
    left.set_xlabel("Stations of an unbranched train", color=INK)
    left.set_title("Train and all its modes", loc="left", fontsize=11, color=INK)
    right.set_xlabel("Modes kept", color=INK)
    right.set_title("One step of the time loop", loc="left", fontsize=11, color=INK)
    figure.savefig(path)
    plt.close(figure)
