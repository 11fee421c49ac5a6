"""Pictures of the chart data of the workbook, as vectors and as pixels of one drawing.

What is drawn are the blocks of `addin.charts.data`, the same numbers as in the charts of the
workbook; nothing is calculated here.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from addin.charts.limits import Limit
from addin.contract.chart_tables import CHART_TABLES, GROUPS, HISTORIES
from addin.contract.charts import CHARTS, ChartSpec, FirstCell, Label, Series, Words
from addin.contract.palette import PALETTE, SPEED_GROUPS
from addin.report.document import Figure
from addin.report.numbers import clean, pretty_unit, raised, significant
from addin.writing.drawn_schematic import LETTERS, schematic_picture
from addin.xlsx.drawn_shapes import Shape
from engine.case.data import CaseData

try:
    import matplotlib as mpl
    from matplotlib.figure import Figure as Drawing
    from matplotlib.patches import Patch, Polygon
    from matplotlib.ticker import NullFormatter
except ImportError:  # `torsionbook report` says so before anything is calculated
    pass

#: Width of the text, and of every picture. [mm]
WIDTH = 170.0
_MM = 1.0 / 25.4
#: Longest name in a picture. [characters]
_LONGEST = 30
#: Items in a line of the train drawing, lines in a picture, height of a line [mm]: with names below
#: them, and without where there are more than so many.
_NAMED_LINES, _NAMED_ITEMS, _NAMELESS_LINES = (25, 3, 53.0), 300, (200, 6, 24.0)
#: Pictures that are no chart of a list of series.
_DRAWN_APART = ("schematic", "train", "shapes")
#: Charts that share pictures; the last one is of the workbook alone.
_HISTORIES = tuple(f"history {k}" for k in range(1, HISTORIES + 1))
_REVERSAL = ("reversal", "blow", "forces")
_SHARED = (*_HISTORIES, *_REVERSAL, "governing")
#: Places for items that a line has at least.
_FEWEST_ITEMS = 11
#: Names of so few items stand upright.
_UPRIGHT = 7
#: Least height of letters. [pt]
_SMALLEST = 8.0
#: Height of a name in the interference diagram over that of the diagram. [1]
_NAME_LINE = 0.036
#: Least distance of numbers of per cent speed, and of names of modes, over the width. [1]
_TICK, _MODE_NAME = 0.035, 0.085
#: A limit is drawn where it is at most so many times the largest value. [1]
_FARTHEST = 2.0
#: Size of a pixel of the schematic, so that its letters are of the least height. [mm]
_PIXEL = _SMALLEST / LETTERS * 25.4 / 96.0
#: Mean width of its letters in the font of the report. [pixel]
_SCHEMATIC_LETTER = 9.4
#: Longest title of an axis that stands on end. [characters]
_UP = 20
#: Longest title of a panel. [characters]
_TITLE = 88
#: Height of three panels and more over that of the charts. [1]
_CLOSE = 0.82
#: Characters of a legend in one line.
_LEGEND = 96
#: Stations whose names stand below a picture of mode shapes.
_NAMED_STATIONS = 40
#: Width of a line in a picture over that in the workbook, whose charts are larger. [1]
_LINE = 0.7
_COLOURS = tuple(PALETTE[c] for c in ("navy", "rust", "teal", "gold", "plum"))
_STYLE = Path(__file__).with_name("report.mplstyle")


@dataclass(frozen=True, eq=False)
class Charts:
    """Chart data by table and column, gaps as NaN."""

    columns: Mapping[str, Mapping[str, list[Any]]]  #: By chart table and column. [shown units]
    labels: Mapping[str, str]  #: Words of the charts.

    @classmethod
    def of(cls, blocks: Mapping[str, Sequence[Sequence[Any]]]) -> Charts:
        """The blocks of `chart_blocks` by column.

        Parameters
        ----------
        blocks : mapping
            Rows of every chart table. [shown units]

        Returns
        -------
        Charts
            The same by column.
        """
        columns = {}
        for table in CHART_TABLES:
            values = (list(column) for column in zip(*blocks[table.name], strict=True))
            columns[table.name] = dict(zip(table.columns, values, strict=True))
        labels = {str(key): clean(str(text or "")) for key, text in blocks["ChartLabels"]}
        return cls(columns, labels)

    def numbers(self, table: str, column: str) -> np.ndarray[Any, Any]:
        """A column as numbers, without the blanks at its end."""
        values = list(self.columns[table][column])
        while values and values[-1] is None:
            values.pop()
        return np.array([math.nan if v is None else float(v) for v in values])

    def pair(self, table: str, x: str, y: str) -> tuple[Any, Any]:
        """Two columns of one curve."""
        a, b = self.numbers(table, x), self.numbers(table, y)
        n = min(a.size, b.size)
        return a[:n], b[:n]


@dataclass(frozen=True)
class Pictures:
    """Draws the charts of one calculation."""

    charts: Charts  #: What is drawn. [shown units]
    vectors: bool = (
        True  #: Which forms are wanted: for the PDF, for the DOCX; with neither the drawing itself.
    )
    pixels: bool = False  #: Likewise.
    #: Limit of each history with its name, None where the element has none. [shown units]
    limits: Sequence[Limit | None] = ()

    # ---- the train -----------------------------------------------------------------------------

    def schematic(self, case: CaseData) -> Figure | None:
        """The schematic of Summary: the same shapes, in a picture of the width of the text."""
        picture = schematic_picture(case, WIDTH / _PIXEL, _SCHEMATIC_LETTER)
        if picture is None:
            return None
        with _style():
            drawing = Drawing(figsize=(WIDTH * _MM, picture.height * _PIXEL * _MM))
            ax = drawing.add_axes((0.0, 0.0, 1.0, 1.0))
            ax.set(xlim=(0.0, picture.width), ylim=(picture.height, 0.0))
            ax.set_axis_off()
            for order, shape in enumerate(picture.shapes):
                _draw_shape(ax, shape, order)
            return self._picture(drawing, "Schematic of the train, not to scale")

    def train(self) -> list[Figure]:
        """Discs and shafts along the centre line, a colour a speed; a long train in several pictures."""
        return [self._train_part(part) for part in range(len(self._train_parts()))]

    def _train_names(self) -> list[str]:
        return [clean(str(name or "")) for name in self.charts.columns["ChartTrain"]["Item"]]

    def _train_parts(self) -> list[list[range]]:
        """Of each picture the lines, of each line the items."""
        names = self._train_names()
        if not any(names):
            return []
        per_line, together, _ = _NAMED_LINES if len(names) <= _NAMED_ITEMS else _NAMELESS_LINES
        size = math.ceil(len(names) / math.ceil(len(names) / per_line))
        lines = [range(k, min(k + size, len(names))) for k in range(0, len(names), size)]
        return [lines[k : k + together] for k in range(0, len(lines), together)]

    def _train_part(self, part: int) -> Figure:
        names, parts = self._train_names(), self._train_parts()
        named, some = len(names) <= _NAMED_ITEMS, parts[part]
        *_, height = _NAMED_LINES if named else _NAMELESS_LINES
        with _style():
            drawing, axes = _new(len(some), height * len(some) + 5.0)
            for ax, items in zip(axes, some, strict=True):
                self._train_line(ax, names if named else (), items)
                middle = 0.5 * (items[0] + items[-1])
                half = 0.5 * max(len(parts[0][0]), _FEWEST_ITEMS) + 0.1
                ax.set_xlim(middle - half, middle + half)
            self._speed_legend(drawing)
            which = "" if len(parts) == 1 else f", part {part + 1} of {len(parts)}"
            which += "" if named else " (names are in the tables)"
            return self._picture(drawing, f"Train{which}: {CHARTS['train'].caption}")

    def _train_line(self, ax: Any, names: Sequence[str], items: range) -> None:
        columns = self.charts.columns["ChartTrain"]
        ax.axhline(0.0, color="#808080", linewidth=0.5, linestyle=(0, (12, 3, 2, 3)))
        for at in items:
            for name, values in columns.items():
                if name == "Item" or values[at] is None or not name.split(" ")[1] == "up":
                    continue
                colour = PALETTE["gold"]
                if not name.startswith("Mesh"):
                    group = int(name.rpartition(" ")[2]) - 1
                    colour = SPEED_GROUPS[group][0 if name.startswith("Disc") else 1]
                ax.bar(at, 2.0 * values[at], 0.98, -values[at], color=colour, linewidth=0)
        _name_ticks(ax, items if names else (), names)
        ax.set_ylim(-1.05, 1.05)
        ax.set_yticks([])
        ax.grid(False)
        ax.tick_params(axis="x", length=0)
        for side in ax.spines.values():
            side.set_visible(False)

    def _speed_legend(self, drawing: Drawing) -> None:
        labels = (self.charts.labels[f"Speed group {k + 1}"] for k in range(GROUPS))
        groups = [
            Patch(color=colours[0], label=label)
            for colours, label in zip(SPEED_GROUPS, labels, strict=False)
            if label
        ]
        if groups:
            drawing.legend(handles=groups, loc="outside upper left", ncols=len(groups))

    # ---- charts of the workbook ----------------------------------------------------------------

    def chart(self, name: str) -> Figure | None:
        """A chart of the workbook by its name; None where it has nothing to show."""
        return self.panels((name,), self._words(CHARTS[name].caption or CHARTS[name].title))

    def speed_time(self) -> Figure | None:
        """Motor speed in the start with the crossings and events."""
        crossed = any(v is not None for v in self.charts.columns["ChartCrossings"]["Time"])
        where = ", and where 2 × slip frequency crosses a mode" if crossed else ""
        return self.panels(("speed-time",), f"Motor speed against time{where}")

    def panels(
        self,
        names: Sequence[str],
        caption: str,
        *,
        titled: bool = False,
        same_x: bool = False,
        more: Callable[[Sequence[Any]], None] | None = None,
    ) -> Figure | None:
        """Charts below each other in one picture, with `more` drawn on them; None where none has anything to show."""
        specs = [CHARTS[name] for name in names if self.has_curve(name)]
        if not specs:
            return None
        with _style():
            height = sum(spec.height for spec in specs) * (_CLOSE if len(specs) > 2 else 1.0)
            drawing, axes = _new(len(specs), height, sharex=same_x)
            for ax, spec in zip(axes, specs, strict=True):
                self._draw(drawing, ax, spec)
                across = _axis(self._words(spec.y.title))
                if titled and len(across) > _UP:  # the title says what it is
                    across = across[across.find("[") :]
                ax.set_ylabel(across)
                if titled:
                    ax.set_title(_short(self._words(spec.title), _TITLE))
                    ax.axhline(0.0, color="#808080", linewidth=0.6)
            axes[-1].set_xlabel(self._words(specs[-1].x.title))
            if more is not None:
                more(axes)
            return self._picture(drawing, caption)

    def has_curve(self, name: str) -> bool:
        """Whether the first series of a chart has points, or any other."""
        return any(self._points(series)[0].size for series in CHARTS[name].series)

    def _points(self, series: Series) -> tuple[Any, Any]:
        """The points of a series."""
        if series.row is None:
            return self.charts.pair(series.table, series.x, series.y)
        columns = self.charts.columns[series.table]
        x, y = (columns[name][series.row : series.row + 1] for name in (series.x, series.y))
        there = bool(x) and x[0] is not None and y[0] is not None
        return (np.array(x), np.array(y)) if there else (np.empty(0), np.empty(0))

    def _words(self, words: Words) -> str:
        """Fixed words, or those that a calculation gave."""
        if isinstance(words, Label):
            return self.charts.labels[words.key]
        if isinstance(words, FirstCell):
            return clean(str(self.charts.columns[words.table][words.column][0] or ""))
        return words

    def _draw(self, drawing: Drawing, ax: Any, spec: ChartSpec) -> None:
        """The curves of a chart, its axes and its legend."""
        second: Any = None
        if spec.second is not None:
            second = ax.twinx()
            second.set_ylabel(self._words(spec.second.title))
            second.grid(False)
        end = max((float(np.nanmax(x)) for x, _ in map(self._points, spec.series) if x.size))
        named: list[tuple[Series, tuple[float, float]]] = []
        for series in spec.series:
            x, y = self._points(series)
            if not x.size:
                continue
            if series.name_beside and spec.name != "interference":
                named.append((series, (float(x[0]), float(y[0]))))
            if series.name_beside or series.values_beside:
                continue
            style = {
                "color": PALETTE.get(series.colour, series.colour),
                "linewidth": _LINE * series.width,
                "linestyle": {"solid": "-", "dash": "--"}[series.dash],
                "marker": {"circle": "o", "diamond": "D"}.get(series.marker, ""),
                "markersize": 4.0,
            }
            label = self._words(series.name) if series.in_legend else ""
            ax.plot([], [], **style, label=label or None)
            (second if series.second_axis else ax).plot(x, y, **style)
        for axis, scale, wanted in (("x", ax.set_xscale, spec.x), ("y", ax.set_yscale, spec.y)):
            if wanted.log:
                scale("log")
                _log_numbers(getattr(ax, f"{axis}axis"), wanted.number)
        ax.tick_params(which="minor", labelsize=_SMALLEST)
        ax.margins(x=0.0 if not spec.x.log else None)
        if spec.name == "interference":
            self._interference_names(ax, spec)
        elif not spec.y.log and spec.y.least is not None:
            low = min(float(np.nanmin(y)) for _, y in map(self._points, spec.series) if y.size)
            if low > -0.01 * ax.get_ylim()[1]:
                ax.set_ylim(bottom=spec.y.least)
        if spec.legend:
            _legend_below(drawing, ax, 4 if len(spec.series) > 3 else 3)
        if named:
            self._named_points(ax, named, end)

    def _named_points(
        self, ax: Any, named: Sequence[tuple[Series, tuple[float, float]]], end: float
    ) -> None:
        """Points of a rising curve with their names beside it, none over another."""
        drawing = ax.figure
        drawing.draw_without_rendering()  # so that the axes have their place and range
        points = 72.0 / drawing.dpi
        taken: list[tuple[float, float, float, float]] = []
        for series, at in named:
            colour = PALETTE[series.colour]
            ax.plot(*at, "D", color=colour, markersize=4.5, markeredgecolor="white")
            words = self._words(series.name)
            below = series.name_beside == "below"
            left = at[0] > (0.8 if below else 0.6) * end
            wide = 0.56 * _SMALLEST * len(words)
            x, y = (float(v) * points for v in ax.transData.transform(at))
            # above the curve where the name goes to the left, below it where it goes to the right
            step = 1.2 * _SMALLEST * (1.0 if left and not below else -1.0)
            aside, away = (-6.0 if left else 6.0), 0.6 * step
            while True:
                from_x = x + aside - (wide if left else 0.0)
                box = (
                    from_x,
                    y + away - 0.6 * _SMALLEST,
                    from_x + wide,
                    y + away + 0.6 * _SMALLEST,
                )
                if not any(_overlap(box, other) for other in taken):
                    break
                away += step
            taken.append(box)
            ax.annotate(
                words, at, xytext=(aside, away), textcoords="offset points", bbox=_HALO,
                ha="right" if left else "left", va="center", color=colour, fontsize=_SMALLEST,
            )  # fmt: skip

    # ---- modes ---------------------------------------------------------------------------------

    def shapes(self, rows: Sequence[Mapping[str, Any]]) -> Figure | None:
        """Twist of the stations in the first modes; `rows` of table ModeShapes."""
        spec = CHARTS["shapes"]
        keys = {f"mode_{k}": series for k, series in enumerate(spec.series, start=1)}
        modes = [(series, key) for key, series in keys.items() if rows and key in rows[0]]
        if not modes:
            return None
        names = [clean(str(row["station"])) for row in rows]
        with _style():
            drawing, (ax,) = _new(1, spec.height)
            ax.axhline(0.0, color="#808080", linewidth=0.6)
            dots = len(names) <= _NAMED_STATIONS
            for series, key in modes:
                ax.plot(
                    range(len(names)), [row[key] for row in rows], "o-" if dots else "-",
                    color=PALETTE[series.colour], markersize=3, label=self._words(series.name),
                )  # fmt: skip
            step = math.ceil(len(names) / _NAMED_STATIONS)
            _name_ticks(ax, range(0, len(names), step), names)
            ax.set_ylabel(self._words(spec.y.title))
            ax.set_ylim(-1.08, 1.08)
            handles, labels = ax.get_legend_handles_labels()
            columns = _legend_columns(labels, 3)
            drawing.legend(handles, labels, loc="outside upper left", ncols=columns)
            which = "" if step == 1 else f" (only one station in {step} is labelled)"
            return self._picture(drawing, f"{self._words(spec.title)}{which}")

    def _interference_names(self, ax: Any, spec: ChartSpec) -> None:
        """The interference diagram: names of lines and modes, and the range they need."""
        curves = [self._points(one) for one in spec.series if one.width and one.dash == "solid"]
        modes, *others = [pair for pair in curves if pair[0].size]
        top = max(float(np.nanmax(y)) for _, y in others)
        self._line_names(ax, top)
        self._mode_names(ax, top)
        ax.set_xlim(0.0, max(float(np.nanmax(x)) for x, _ in (modes, *others)))
        ax.set_ylim(0.0, 1.03 * top)

    def _line_names(self, ax: Any, top: float) -> None:
        """Names of the excitations; what would cover another name goes up along its line."""
        x, y = self.charts.columns["ChartNames"].values()
        used: list[tuple[float, float]] = []
        right = max((v for v in x if v is not None), default=1.0)
        for k, (at_x, at_y) in enumerate(zip(x, y, strict=True)):
            name = self.charts.labels.get(f"Line {k + 1}", "")
            if at_x is None or at_y is None or not name.strip():
                continue
            at_y = min(at_y, 0.985 * top)
            while any(
                abs(at_y - v) < _NAME_LINE * top and abs(at_x - u) < 0.25 * right for u, v in used
            ):
                at_y -= _NAME_LINE * top
            used.append((at_x, at_y))
            ax.annotate(_short(name, 34), (at_x, at_y), color="#505050", fontsize=_SMALLEST, ha="center",
                        va="center", bbox=_HALO)  # fmt: skip

    def _mode_names(self, ax: Any, top: float) -> None:
        """Frequencies at the right edge; modes close together share one line."""
        x, y = self.charts.pair("ChartInterference", "Label speed", "Label")
        groups: list[list[float]] = []
        for f in sorted(float(v) for v in y if math.isfinite(v)):
            if groups and f - groups[-1][-1] < 0.9 * _NAME_LINE * top:
                groups[-1].append(f)
            else:
                groups.append([f])
        for group in groups:
            shown = [f"{f:.1f}" for f in group]
            words = ", ".join(shown)
            if len(group) > 3:
                words = f"{shown[0]} to {shown[-1]} ({len(group)})"
            middle = sum(group) / len(group)
            ax.annotate(f"{words} Hz", (float(x[0]), middle), xytext=(4, 0), fontsize=_SMALLEST,
                        textcoords="offset points", va="center", color=PALETTE["navy"])  # fmt: skip

    # ---- histories -----------------------------------------------------------------------------

    def histories(self, synchronous: float | None) -> list[Figure]:
        """Torque, stress or tooth load of the drawn elements, two below each other, as the paper's Figures 7 and 8.

        Parameters
        ----------
        synchronous : float or None
            Synchronous speed, for the axis of per cent speed above. [rad/s]
        """
        pictures = (self._histories(some, synchronous) for some in self._history_groups())
        return [picture for picture in pictures if picture is not None]

    def _history_groups(self, together: int = 2) -> list[list[str]]:
        """Charts of each picture."""
        drawn = [name for name in _HISTORIES if self.has_curve(name)]
        return [drawn[k : k + together] for k in range(0, len(drawn), together)]

    def _histories(self, some: Sequence[str], synchronous: float | None) -> Figure | None:
        def more(axes: Sequence[Any]) -> None:
            self._percent_speed(axes[0], synchronous)
            for ax, name in zip(axes, some, strict=True):
                _limit_lines(ax, self._limit(name))
                self._crossed_modes(ax)

        titles = "; ".join(self._words(CHARTS[name].title) for name in some)
        caption = f"Start against time: {titles}"
        return self.panels(some, caption, titled=True, same_x=True, more=more)

    def _limit(self, name: str) -> Limit | None:
        """The limit of a history by the name of its chart."""
        k = int(name.rpartition(" ")[2]) - 1
        return self.limits[k] if k < len(self.limits) else None

    def _percent_speed(self, ax: Any, synchronous: float | None) -> None:
        """Per cent speed above a picture against time, where the speed first gets there."""
        time, speed = self.charts.pair("ChartSpeedTime", "Time", "Speed")
        if not synchronous or time.size < 2:
            return
        reached = np.maximum.accumulate(speed) / (synchronous * 30.0 / math.pi)
        shares = np.arange(math.ceil(10.0 * reached[0]), math.floor(10.0 * reached[-1]) + 1) / 10.0
        ticks: list[tuple[float, str]] = []
        for share in shares:
            when = float(time[np.searchsorted(reached, share)])
            if not ticks or when - ticks[-1][0] > _TICK * float(time[-1] - time[0]):
                ticks.append((when, f"{100.0 * share:.0f}"))
        above = ax.secondary_xaxis("top")
        above.set_xticks([t for t, _ in ticks], [name for _, name in ticks], fontsize=_SMALLEST)
        above.set_xlabel("Speed [%]", fontsize=_SMALLEST)

    def _crossed_modes(self, ax: Any) -> None:
        """Where 2 × slip frequency crosses a mode."""
        columns = self.charts.columns["ChartCrossings"]
        low, high = ax.get_xlim()
        levels: list[float] = []  # where the last name of each line of names stands
        for k, time in sorted(
            ((k, t) for k, t in enumerate(columns["Time"], start=1) if t is not None),
            key=lambda pair: float(pair[1]),
        ):
            name = self.charts.labels.get(f"Crossing {k}", "")
            if not name.strip():
                continue
            ax.axvline(time, color=PALETTE["rust"], linewidth=0.6, linestyle=":")
            share = (float(time) - low) / (high - low)
            level = next(
                (n for n, last in enumerate(levels) if share - last > _MODE_NAME), len(levels)
            )
            levels[level : level + 1] = [share]
            left = share > _MODE_NAME
            ax.annotate(
                name.partition(":")[0], (time, 1.0), xycoords=("data", "axes fraction"), bbox=_HALO,
                xytext=(-3 if left else 3, -3 - 1.3 * _SMALLEST * level), textcoords="offset points",
                ha="right" if left else "left", va="top", color=PALETTE["rust"], fontsize=_SMALLEST,
            )  # fmt: skip

    def reversal(self) -> Figure | None:
        """Torque around the deepest reversal: all of it, closely, and the forces then."""
        return self.panels(
            _REVERSAL,
            "Tooth torque around its minimum in the start",
            titled=True,
        )

    # ---- by name -------------------------------------------------------------------------------

    def by_name(
        self,
        case: CaseData,
        shapes: Sequence[Mapping[str, Any]],
        synchronous: float | None,
    ) -> dict[str, Callable[[], Figure | None]]:
        """Every picture of a report that has something to show, but those of studies, by a name.

        Parameters
        ----------
        case : CaseData
            What was calculated. [SI]
        shapes : sequence of mapping
            Rows of table ModeShapes. [SI]
        synchronous : float or None
            Synchronous speed. [rad/s]
        """
        trains = [partial(self._train_part, part) for part in range(len(self._train_parts()))]
        groups = self._history_groups()
        charts = (
            name
            for name, spec in CHARTS.items()
            # the report draws no chart with names along its axis
            if name not in (*_DRAWN_APART, *_SHARED)
            and spec.kind != "lines"
            and all(series.table in self.charts.columns for series in spec.series)
            and self.has_curve(name)
        )
        return {
            "schematic": partial(self.schematic, case),
            **{"train" if k == 1 else f"train {k}": one for k, one in enumerate(trains, 1)},
            "shapes": partial(self.shapes, shapes),
            **{name: partial(self.chart, name) for name in charts},
            **{
                f"histories {k}": partial(self._histories, some, synchronous)
                for k, some in enumerate(groups, 1)
            },
            **({"reversal": self.reversal} if any(map(self.has_curve, _REVERSAL)) else {}),
        }

    # ---- studies -------------------------------------------------------------------------------

    def curves(
        self,
        series: Sequence[tuple[str, Sequence[tuple[float, float]]]],
        across: str,
        up: str,
        caption: str,
        *,
        log: bool = False,
        log_x: bool = False,
        markers: bool = True,
    ) -> Figure | None:
        """Some curves of a study, each with its name; None where there is none. [shown units]"""
        if not series:
            return None
        with _style():
            drawing, (ax,) = _new(1, 78.0)
            for k, (name, points) in enumerate(series):
                x, y = zip(*points, strict=True)
                dash = ("-", "--", ":", "-.")[k // len(_COLOURS)]
                ax.plot(
                    x, y, dash, color=_COLOURS[k % len(_COLOURS)], marker="o" if markers else "",
                    markersize=3, label=clean(name),
                )  # fmt: skip
            for axis, scale, is_log in (
                (ax.xaxis, ax.set_xscale, log_x),
                (ax.yaxis, ax.set_yscale, log),
            ):
                if is_log:
                    scale("log")
                    axis.set_major_formatter(_plain_number)
                    axis.set_minor_formatter(_some_plain_numbers)
            ax.tick_params(which="minor", labelsize=_SMALLEST)
            ax.set(xlabel=clean(across), ylabel=clean(up))
            if any(name for name, _ in series):
                _legend_below(drawing, ax, 3)
            return self._picture(drawing, clean(caption))

    def tornado(
        self,
        bars: Sequence[tuple[str, float, float]],
        ends: tuple[str, str],
        across: str,
        caption: str,
    ) -> Figure | None:
        """Two bars a factor, the widest on top; None where there is none. [shown units]"""
        if not bars:
            return None
        with _style():
            drawing, (ax,) = _new(1, 26.0 + 6.0 * len(bars))
            places = range(len(bars) - 1, -1, -1)
            for k, colour in ((1, "rust"), (2, "navy")):
                ax.barh(
                    places, [bar[k] for bar in bars], 0.62, color=PALETTE[colour], linewidth=0,
                    label=ends[k - 1],
                )  # fmt: skip
            ax.axvline(0.0, color="#606060", linewidth=0.6)
            ax.set_yticks(list(places), [_short(clean(bar[0]), 44) for bar in bars])
            ax.grid(False, axis="y")
            ax.set(xlabel=across)
            _legend_below(drawing, ax, 2)
            return self._picture(drawing, caption)

    # ---- files ---------------------------------------------------------------------------------

    def _picture(self, drawing: Drawing, caption: str) -> Figure:
        """A drawing as vectors and as pixels; no date in either."""
        width, height = drawing.get_size_inches()
        size = (width / _MM, height / _MM)
        if not (self.vectors or self.pixels):
            return Figure(caption, b"", b"", *size, drawing=drawing)
        with warnings.catch_warnings():
            # a name in a script that the font lacks is drawn as boxes here; it stands in the tables
            warnings.filterwarnings("ignore", message="Glyph .* missing from")
            svg = self._saved(drawing, "svg") if self.vectors else b""
            png = self._saved(drawing, "png") if self.pixels else b""
        return Figure(caption, svg, png, *size)

    def _saved(self, drawing: Drawing, form: str) -> bytes:
        target = io.BytesIO()
        about = {"Date": None, "Creator": None} if form == "svg" else {"Software": None}
        drawing.savefig(target, format=form, dpi=200, metadata=about)
        return target.getvalue()


_HALO = {"boxstyle": "square,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Whether two boxes (left, bottom, right, top) have a common part."""
    return (
        one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
    )  # fmt: skip


def _style() -> Any:
    """Settings of this module, whatever the user's own are."""
    own = {"axes.titlecolor": PALETTE["navy"], "backend": "agg"}
    style = dict(mpl.rc_params_from_file(_STYLE, use_default_template=False))
    settings: Any = dict(mpl.rcParamsDefault) | style | own
    return mpl.rc_context(settings)


def _new(panels: int, height: float, sharex: bool = False) -> tuple[Drawing, list[Any]]:
    """A drawing of the width of the text with panels below each other. [mm]"""
    drawing = Drawing(figsize=(WIDTH * _MM, height * _MM), layout="constrained")
    axes = drawing.subplots(panels, 1, sharex=sharex, squeeze=False)
    return drawing, list(axes[:, 0])


def _draw_shape(ax: Any, shape: Shape, order: int) -> None:
    """A shape of the schematic, over those before it."""
    left, top, scale = shape.left, shape.top, _SMALLEST / LETTERS
    corners = shape.points or (
        (0.0, 0.0), (shape.width, 0.0), (shape.width, shape.height), (0.0, shape.height)
    )  # fmt: skip
    if shape.fill or shape.line:
        ax.add_patch(
            Polygon(
                [(left + x, top + y) for x, y in corners], facecolor=shape.fill or "none",
                edgecolor=shape.line or "none", linewidth=scale * shape.thickness, zorder=order,
            )
        )  # fmt: skip
    if shape.text:
        words = "\n".join(map(clean, shape.text.split("\n")))
        share, side = {"ctr": (0.5, "center"), "l": (0.0, "left"), "r": (1.0, "right")}[shape.side]
        ax.text(
            left + share * shape.width, top + 0.5 * shape.height, words, ha=side, va="center_baseline",
            fontsize=scale * shape.size, fontweight="bold" if shape.bold else "normal", color=shape.ink,
            zorder=order, linespacing=1.1,
        )  # fmt: skip


def _limit_lines(ax: Any, limit: Limit | None) -> None:
    """Lines at both values of a limit with its name; in words alone where they would flatten the curve."""
    if limit is None:
        return
    name = f"{limit.words[0].upper()}{limit.words[1:]}"
    low, high = ax.get_ylim()
    values = (
        f"±{significant(limit.upper, 4)}"
        if limit.upper == -limit.lower
        else f"{significant(limit.upper, 4)} / {significant(limit.lower, 4)}"
    )
    words = f"{name} {values}"
    if limit.upper > _FARTHEST * max(-low, high):
        words = f"{words} (beyond)"
    else:
        room = 0.08 * limit.upper
        ax.set_ylim(min(low, limit.lower - room), max(high, limit.upper + room))
        for y in (limit.upper, limit.lower):
            ax.axhline(y, color=PALETTE["fail_ink"], linewidth=0.9, linestyle="--")
    room_left = _TITLE - max(42, len(words) + 4)
    ax.set_title(_short(ax.get_title(loc="left"), room_left), loc="left")
    ax.set_title(
        words, loc="right", fontsize=_SMALLEST, fontweight="normal", color=PALETTE["fail_ink"]
    )


def _legend_below(drawing: Drawing, ax: Any, columns: int) -> None:
    """Names of the curves below everything; the layout keeps room for them."""
    handles, names = ax.get_legend_handles_labels()
    names = [_short(name, 70) for name in names]
    columns = _legend_columns(names, columns)
    drawing.legend(handles, names, loc="outside lower center", ncols=columns)


def _legend_columns(names: Sequence[str], most: int) -> int:
    """How many names fit beside each other. [count]"""
    return max(1, min(most, _LEGEND // (max(map(len, names), default=0) + 6)))


def _name_ticks(ax: Any, items: Sequence[int], names: Sequence[str]) -> None:
    """Names below the axis; many stand on end."""
    few = len(items) <= _UPRIGHT
    shown = [_short(names[at], 18 if few else _LONGEST) for at in items]
    ax.set_xticks(list(items), shown, rotation=0 if few else 90, fontsize=_SMALLEST)


def _short(name: str, longest: int) -> str:
    """A name that fits, its middle left out: what parts names often stands at their end."""
    if len(name) <= longest:
        return name
    tail = longest // 3
    return f"{name[: longest - tail - 1].rstrip()}…{name[-tail:].lstrip()}"


def _axis(words: str) -> str:
    """An axis title with its unit as printed."""
    head, bracket, unit = words.partition("[")
    return f"{head}[{pretty_unit(unit.rstrip(']'))}]" if bracket else words


def _power_of_ten(value: float, _: Any = None) -> str:
    return f"10{raised(round(math.log10(value)))}" if value > 0.0 else ""


def _plain_number(value: float, _: Any = None) -> str:
    return f"{value:,.10g}"


def _decimal(value: float, _: Any = None) -> str:
    """A number without a power of ten, however small."""
    return f"{value:,.12f}".rstrip("0").rstrip(".") if value < 1.0 else _plain_number(value)


def _some_decimals(value: float, _: Any = None) -> str:
    return _decimal(value) if _some_plain_numbers(value) else ""


def _log_numbers(axis: Any, number: str) -> None:
    """Numbers of a logarithmic axis: powers of ten, whole numbers or decimals as on the sheet."""
    low, high = axis.get_view_interval()
    if number == "0E+0":
        axis.set_major_formatter(_power_of_ten)
    elif number == "#,##0":
        axis.set_major_formatter(_plain_number)
        axis.set_minor_formatter(_some_plain_numbers if high > 12.0 * low else _plain_number)
    else:
        axis.set_major_formatter(_decimal)
        axis.set_minor_formatter(_some_decimals if high < 300.0 * low else NullFormatter())


def _some_plain_numbers(value: float, _: Any = None) -> str:
    """Between powers of ten only 2 and 5, which never touch."""
    if value <= 0.0:
        return ""
    first = round(value / 10.0 ** math.floor(math.log10(value) + 1e-9))
    return _plain_number(value) if first in (2, 5) else ""
