"""Which cells the charts of a workbook draw, and whether they carry the values of those cells."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import isclose
from typing import Any

from addin.contract.chart_tables import LABELS
from addin.contract.charts import FirstCell, Label, Words
from addin.contract.problems import shortened
from addin.contract.sheets import SHEETS
from addin.contract.studies.registry import EVERY_CHART, with_studies
from addin.contract.tables import INPUT_TABLES
from addin.verify.compare import ROUNDING
from addin.verify.findings import Finding
from addin.verify.structure import plain, present_sheet
from addin.xlsx import Drawn, DrawnChart, Workbook
from addin.xlsx.references import Rect, cell_name, quoted_sheet

#: Charts of words above them alone may be anybody's; from so many series on they are known by these.
_TELLING = 2

Area = tuple[str, Rect]
#: Name (its cell, or fixed words), categories and values of a series.
Series = tuple[Area | str, Area | None, Area | None]


@dataclass(frozen=True)
class _Expected:
    """A chart of ours as it is written: its sheet where that is known, title, series."""

    sheet: str | None
    title: str
    title_cell: Area | None
    series: tuple[Series, ...]
    pattern: str = (
        ""  #: Of a title that only a calculation knows; other words are the engineer's own.
    )


def compare_drawings(
    workbook: Workbook, charts: Sequence[DrawnChart], same_version: bool
) -> Iterator[Finding]:
    """Charts of ours that draw other cells than they were written to draw.

    A chart that was taken out is nobody's concern, nor is a chart of the engineer's own or a series
    that he put into one of ours.
    """
    present = [(chart, _series(workbook, chart)) for chart in charts]
    for expected in _expected(workbook):
        here = [pair for pair in present if expected.sheet in (None, pair[0].sheet)]
        whole = [chart for chart, series in here if _is_whole(expected, series)]
        if whole:
            if not any(_is_titled(expected, chart) for chart in whole):
                yield _titled_otherwise(expected, whole[0], same_version)
            continue
        # charts of one sheet may have series of the same names
        for chart, series in sorted(here, key=lambda pair: not _is_titled(expected, pair[0])):
            sentence = _astray(expected, chart, series)
            if sentence:
                yield Finding("chart", chart.sheet, chart.cell, sentence, fails=same_version)
                break


def compare_copies(workbook: Workbook, charts: Sequence[DrawnChart]) -> Iterator[Finding]:
    """Charts that carry other values than the cells they draw, which programs show that do not calculate."""
    for chart in charts:
        points = [point for drawn in chart.references() for point in _wrong_points(workbook, drawn)]
        if points:
            (sheet, cell), carried, held = points[0]
            more = "" if len(points) == 1 else f" (and {len(points) - 1:,} more such)"
            yield Finding(
                "chart", chart.sheet, chart.cell,
                f"{_called(chart)} shows {_shown(carried)} for {quoted_sheet(sheet)}!{cell}, but the "
                f"cell contains {_shown(held)}{more}",
                found=carried, expected=held,
            )  # fmt: skip


# --- what is drawn --------------------------------------------------------------------------------


def _series(workbook: Workbook, chart: DrawnChart) -> list[Series]:
    """The series of a chart as it is in the file."""
    return [
        (
            _first_cell(_only(series.name)) or plain(series.name.words),
            _as_typed(workbook, _only(series.categories)),
            _as_typed(workbook, _only(series.values)),
        )
        for series in chart.series
    ]


def _only(drawn: Drawn) -> Area | None:
    """The cells of a reference; where it has several areas or leads nowhere, its text and no cell of ours."""
    if len(drawn.areas) == 1:
        return drawn.areas[0]
    return (drawn.text, Rect(1, 1, 1, 1)) if drawn.text else None


def _first_cell(area: Area | None) -> Area | None:
    """Where a name begins: its cell grows with a table that had one row."""
    if area is None:
        return None
    sheet, rect = area
    return sheet, Rect(rect.top, rect.left, rect.top, rect.left)


def _as_typed(workbook: Workbook, area: Area | None) -> Area | None:
    """Points of an input table, of which a chart may draw fewer or more rows than it has now."""
    if area is None:
        return None
    sheet, rect = area
    for spec in INPUT_TABLES:
        table = workbook.tables.get(spec.name)
        if table is None or table.sheet != sheet or rect.top != table.data.top:
            continue
        if table.data.left <= rect.left and rect.right <= table.data.right:
            return sheet, Rect(rect.top, rect.left, table.data.bottom, rect.right)
    return area


def _drawn(series: Iterable[Series]) -> set[tuple[Area | None, Area | None]]:
    return {(categories, values) for _, categories, values in series}


def _is_whole(expected: _Expected, series: Sequence[Series]) -> bool:
    """Whether a chart draws all that ours draws, under the names of ours."""
    return _drawn(expected.series) <= _drawn(series) and not _other_names(expected, series)


def _other_names(expected: _Expected, series: Sequence[Series]) -> list[tuple[Area, Area]]:
    """Names that stand in another cell than ours, of series that draw the same; fixed words are anybody's."""
    astray = []
    for name, *drawn in expected.series:
        names = [other for other, *cells in series if cells == drawn]
        if not isinstance(name, str) and names and name not in names:
            astray += [(other, name) for other in names[:1] if not isinstance(other, str)]
    return astray


def _astray(expected: _Expected, chart: DrawnChart, series: Sequence[Series]) -> str:
    """What is said of a chart that is ours and draws other cells; nothing where it is not, or does not."""
    if not _is_ours(expected, chart, series):
        return ""
    ours, there = _drawn(expected.series), _drawn(series)
    missing = ours - there
    if missing and there - ours:
        wanted = next(cells for _, *cells in expected.series if tuple(cells) in missing)
        instead = next(cells for _, *cells in series if tuple(cells) not in ours)
        return (
            f"{_called(chart)} draws {_pair(instead)}, not {_pair(wanted)} as torsionbook wrote it"
        )
    names = [] if missing else _other_names(expected, series)
    if names:
        other, name = names[0]
        return f"{_called(chart)} takes a series name from {_place(other)}, not from {_place(name)}"
    return ""


def _is_titled(expected: _Expected, chart: DrawnChart) -> bool:
    """Whether a chart has the title it was written with, or none."""
    cell = _only(chart.title_cell)
    if cell is not None:
        return cell == expected.title_cell
    return not plain(chart.title) or plain(chart.title) == plain(expected.title)


def _titled_otherwise(expected: _Expected, chart: DrawnChart, same_version: bool) -> Finding:
    """What is said of another title: one in the words of torsionbook was edited, others are the engineer's."""
    in_our_words = bool(expected.pattern and re.fullmatch(expected.pattern, chart.title.strip()))
    wrong_cell = _only(chart.title_cell) is not None
    shown, ours = (shortened(text, 60) for text in (chart.title, expected.title))
    sentence = f"the title of the chart was changed: '{shown}' stands in place of '{ours}'"
    return Finding(
        "chart", chart.sheet, chart.cell, sentence, found=chart.title, expected=expected.title,
        fails=same_version and (in_our_words or wrong_cell),
    )  # fmt: skip


def _is_ours(expected: _Expected, chart: DrawnChart, series: Sequence[Series]) -> bool:
    """Whether a chart is one of ours by its title, by half of what it draws, or by half of its names."""
    if expected.title_cell is not None and _only(chart.title_cell) == expected.title_cell:
        return True
    if expected.title and plain(chart.title) == plain(expected.title):
        return True
    if len(expected.series) < _TELLING:
        return False
    shared = len(_drawn(expected.series) & _drawn(series))
    names = {name for name, *_ in expected.series if name} & {name for name, *_ in series}
    return 2 * max(shared, len(names)) >= len(expected.series)


# --- what would be drawn --------------------------------------------------------------------------


def _expected(workbook: Workbook) -> Iterator[_Expected]:
    """Charts of ours whose tables the workbook has."""
    for sheet in with_studies(SHEETS):
        for at in sheet.charts:
            spec = EVERY_CHART[at.name]
            try:
                title = _words(workbook, spec.title)
                drawn = tuple(
                    (
                        _words(workbook, series.name),
                        _cells(workbook, series.table, series.x, series.row),
                        _cells(workbook, series.table, series.y, series.row),
                    )
                    for series in spec.series
                )
            except KeyError:  # a table or column that is missing, which is a finding by itself
                continue
            in_cell, words = None, title
            if not isinstance(title, str):  # other programs keep the words instead of the cell
                title_sheet, rect = in_cell = title
                words = str(workbook.shown_value(title_sheet, cell_name(rect.top, rect.left)) or "")
            pattern = spec.title.words if isinstance(spec.title, Label) else ""
            yield _Expected(present_sheet(workbook, sheet), str(words), in_cell, drawn, pattern)


def _cells(workbook: Workbook, table: str, column: str, row: int | None = None) -> Area:
    """Data cells of a column of a table where it stands in the workbook, or one row of them."""
    place = workbook.tables[table]
    at = place.ref.left + {name: k for k, name in enumerate(place.columns)}[column]
    top, bottom = place.data.top, place.data.bottom
    if row is not None:
        top = bottom = top + row
    return place.sheet, Rect(top, at, bottom, at)


def _words(workbook: Workbook, words: Words) -> Area | str:
    """Fixed words, or the cell that holds them."""
    if isinstance(words, Label):
        return _cells(workbook, "ChartLabels", "Text", LABELS.index(words.key))
    if isinstance(words, FirstCell):
        return _cells(workbook, words.table, words.column, 0)
    return plain(words)


# --- what is carried ------------------------------------------------------------------------------


def _wrong_points(workbook: Workbook, drawn: Drawn) -> Iterator[tuple[tuple[str, str], Any, Any]]:
    """Points of a copy that are not the value of their cell: the cell, what is carried, what stands there."""
    if not drawn.points or len(drawn.areas) != 1:
        return
    sheet, rect = drawn.areas[0]
    part = workbook.sheet_part(sheet)
    if part.hidden_rows(rect.top, rect.bottom) or (rect.height > 1 and rect.width > 1):
        return  # hidden cells are not drawn, and the others move up
    down = rect.height > 1 or rect.width == 1
    for at, carried in drawn.points.items():
        row, column = (rect.top + at, rect.left) if down else (rect.top, rect.left + at)
        cell = part.constant(row, column) if rect.has(row, column) else None
        number = _number(carried) if drawn.numbers else None
        if drawn.numbers and isinstance(cell, float):
            alike = number is None or isclose(number, cell, rel_tol=ROUNDING, abs_tol=1e-300)
        elif drawn.numbers:
            alike = not number  # texts count as zero
        else:
            alike = not isinstance(cell, str) or plain(carried) == plain(cell)
        if not alike:
            yield (
                (sheet, cell_name(row, column)),
                carried if number is None else number,
                cell if isinstance(cell, str | float) else None,
            )


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


# --- words ----------------------------------------------------------------------------------------


def _called(chart: DrawnChart) -> str:
    return (
        f"the chart '{shortened(chart.title, 60)}'" if chart.title else "the chart without a title"
    )


def _pair(pair: Sequence[Area | None]) -> str:
    categories, values = pair
    return f"{_place(values)} over {_place(categories)}"


def _place(area: Area | None) -> str:
    if area is None:
        return "nothing"
    sheet, rect = area
    return sheet if "!" in sheet else f"{quoted_sheet(sheet)}!{rect}"


def _shown(value: object) -> str:
    if value is None:
        return "nothing"
    return f"{value:.9g}" if isinstance(value, float) else f"'{shortened(str(value), 60)}'"
