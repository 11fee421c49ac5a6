"""What the charts of a workbook draw, and the copies of cell values that they carry; nothing is changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from addin.xlsx.chart_titles import CHART_TITLE
from addin.xlsx.charts import Area
from addin.xlsx.references import MAX_COLUMN, MAX_ROW, cell_name, whole_number
from addin.xlsx.state import WorkbookState
from addin.xlsx.xml_part import RELATIONSHIP_IDS, Element, chart_tag, drawing_tag, parse_part

_ANCHORS = "http://schemas.openxmlformats.org/drawingml/2006/spreadsheetDrawing"


@dataclass(frozen=True)
class Drawn:
    """Cells that a chart draws or names, and its copy of their values."""

    text: str = ""  #: The reference as written; empty for fixed words.
    areas: tuple[Area, ...] = ()  #: Sheet and cells; empty where the reference cannot be followed.
    numbers: bool = False  #: Whether the copy holds numbers.
    count: int = -1  #: Points that the copy claims; -1 without a copy.
    points: dict[int, str] | None = None  #: Values of the copy by their place.
    words: str = ""  #: Fixed words in place of a reference.


@dataclass(frozen=True)
class DrawnSeries:
    """One series: its name, its categories (or x), its values (or y)."""

    name: Drawn
    categories: Drawn
    values: Drawn


@dataclass(frozen=True)
class DrawnChart:
    """One chart of a worksheet."""

    sheet: str  #: Where it lies: its sheet and the cell under its upper left corner.
    cell: str  #: Likewise.
    title: str  #: Words above it, as the file holds them.
    title_cell: Drawn  #: The cell that gives these words; empty for fixed ones.
    series: tuple[DrawnSeries, ...]  #: In the order of the part.

    def references(self) -> Iterator[Drawn]:
        """Everything in it that refers to cells."""
        yield self.title_cell
        for series in self.series:
            yield from (series.name, series.categories, series.values)


def drawn_charts(workbook: WorkbookState) -> list[DrawnChart]:
    """The charts on the worksheets of a workbook."""
    structure = workbook.structure
    found = []
    for sheet in workbook.sheet_names:
        part = structure.worksheet_part(sheet)
        for drawing in structure.relationships(part) if part else ():
            if drawing.kind != "drawing" or workbook.container.find(drawing.part) is None:
                continue
            charts = {
                relation.id: relation.part
                for relation in structure.relationships(drawing.part)
                if relation.kind == "chart" and workbook.container.find(relation.part) is not None
            }
            root = parse_part(workbook.container.charged(drawing.part), drawing.part)
            for anchor in root:
                for frame in anchor.iter(chart_tag("chart")):
                    chart = charts.get(frame.get(f"{{{RELATIONSHIP_IDS}}}id", ""))
                    if chart is not None:
                        found.append(_chart(workbook, sheet, _cell_of(anchor), chart))
    return found


def _chart(workbook: WorkbookState, sheet: str, cell: str, part: str) -> DrawnChart:
    root = parse_part(workbook.container.charged(part), part)
    words = root.find(f"{CHART_TITLE}/{chart_tag('tx')}")
    title_cell = Drawn() if words is None else _drawn(workbook, words)
    text = "" if words is None else "".join(run.text or "" for run in words.iter(drawing_tag("t")))
    return DrawnChart(
        sheet,
        cell,
        text or (title_cell.points or {}).get(0, ""),
        title_cell,
        tuple(_series(workbook, one) for one in root.iter(chart_tag("ser"))),
    )


def _series(workbook: WorkbookState, series: Element) -> DrawnSeries:
    def of(*tags: str) -> Drawn:
        held = (series.find(chart_tag(tag)) for tag in tags)
        return next((_drawn(workbook, one) for one in held if one is not None), Drawn())

    return DrawnSeries(of("tx"), of("cat", "xVal"), of("val", "yVal"))


def _drawn(workbook: WorkbookState, holder: Element) -> Drawn:
    """The reference in an element, and its copy."""
    for kind in ("num", "str", "multiLvlStr"):
        reference = holder.find(chart_tag(f"{kind}Ref"))
        if reference is None:
            continue
        text = reference.findtext(chart_tag("f")) or ""
        areas = tuple(workbook.chart_areas(text) or ())
        cache = reference.find(chart_tag(f"{kind}Cache"))
        if cache is None or kind == "multiLvlStr":
            return Drawn(text, areas)
        stated = cache.find(chart_tag("ptCount"))
        count = whole_number("" if stated is None else stated.get("val", ""), MAX_ROW)
        points = {}
        for point in cache.iter(chart_tag("pt")):
            at = whole_number(point.get("idx", ""), MAX_ROW - 1)
            if at is not None:
                points[at] = point.findtext(chart_tag("v")) or ""
        return Drawn(text, areas, kind == "num", -1 if count is None else count, points)
    return Drawn(words=holder.findtext(chart_tag("v")) or "")


def _cell_of(anchor: Element) -> str:
    """The cell under the upper left corner; empty where the drawing does not say."""
    corner = anchor.find(f"{{{_ANCHORS}}}from")
    if corner is None:
        return ""
    row = whole_number(corner.findtext(f"{{{_ANCHORS}}}row") or "", MAX_ROW - 1)
    column = whole_number(corner.findtext(f"{{{_ANCHORS}}}col") or "", MAX_COLUMN - 1)
    return "" if row is None or column is None else cell_name(row + 1, column + 1)
