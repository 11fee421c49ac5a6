"""Titles of charts that lost their cell.

A spreadsheet program other than Excel stores a chart title that shows a cell as fixed words. A calculation afterwards
would leave the old words above new curves; hence the titles of charts known by the cells they draw are linked again.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass

from addin.xlsx.references import Rect, absolute_range, parse_range, quoted_sheet
from addin.xlsx.xml_part import Element, chart_tag, drawing_tag

#: The title of a chart in its part.
CHART_TITLE = f"{chart_tag('chart')}/{chart_tag('title')}"


@dataclass(frozen=True)
class TitleLink:
    """Which cells title the chart that draws certain cells as its values, and nothing else."""

    sheet: str  #: Sheet of the values and of the titles.
    values: tuple[Rect, ...]  #: The values of its series.
    title: str  #: Cells of the chart's title and of the title of its vertical value axis.
    value_axis: str  #: Likewise; empty where that axis has fixed words.
    #: Pattern of the words that these cells may have shown; other words are somebody's own and
    #: stay.
    title_words: str
    axis_words: str  #: Likewise.


def link_titles(
    root: Element,
    links: Sequence[TitleLink],
    areas: Callable[[str], list[tuple[str, Rect]] | None],
    shown: Callable[[str, str], str],
) -> bool:
    """Link the titles of one chart to their cells where they are fixed words.

    Parameters
    ----------
    root : Element
        The chart part.
    links : sequence of TitleLink
        The first that fits is used.
    areas : callable
        Areas of a reference text; None when it cannot be followed.
    shown : callable
        Text that a cell of a sheet shows.

    Returns
    -------
    bool
        Whether a title was linked.
    """
    drawn = {area for text in _value_references(root) for area in areas(text) or ()}
    for link in links:
        if drawn != {(link.sheet, rect) for rect in link.values}:
            continue
        lost = [
            (title, cell)
            for title, cell, words in (
                (root.find(CHART_TITLE), link.title, link.title_words),
                (_value_axis_title(root), link.value_axis, link.axis_words),
            )
            if cell and title is not None and _has_words(title, words)
        ]
        for title, cell in lost:
            _link(title, link.sheet, cell, shown(link.sheet, cell))
        return bool(lost)
    return False


def _value_references(root: Element) -> Iterator[str]:
    for kind in ("val", "yVal"):
        for values in root.iter(chart_tag(kind)):
            for formula in values.iter(chart_tag("f")):
                yield formula.text or ""


def _value_axis_title(root: Element) -> Element | None:
    for axis in root.iter(chart_tag("valAx")):
        side = axis.find(chart_tag("axPos"))
        if side is not None and side.get("val") in ("l", "r"):
            found: Element | None = axis.find(chart_tag("title"))
            return found
    return None


def _has_words(title: Element, pattern: str) -> bool:
    """Whether a title shows fixed words that a cell may have given it; False when it shows a cell."""
    words = title.find(chart_tag("tx"))
    if words is None or words.find(chart_tag("strRef")) is not None:
        return False
    text = "".join(run.text or "" for run in words.iter(drawing_tag("t"))).strip()
    return not text or re.fullmatch(pattern, text) is not None


def _link(title: Element, sheet: str, cell: str, text: str) -> None:
    """Replace the fixed words of a title by a reference."""
    words = title.find(chart_tag("tx"))
    rich = words.find(chart_tag("rich"))
    if rich is not None:
        if title.find(chart_tag("txPr")) is None:
            _insert_text_format(title, rich)
        words.remove(rich)
    reference = _child(words, "strRef")
    _child(reference, "f").text = f"{quoted_sheet(sheet)}!{absolute_range(parse_range(cell))}"
    cache = _child(reference, "strCache")
    _child(cache, "ptCount").set("val", "1")
    point = _child(cache, "pt")
    point.set("idx", "0")
    _child(point, "v").text = text


def _insert_text_format(title: Element, rich: Element) -> None:
    """The letters of the fixed words become those of the linked ones."""
    properties = title.makeelement(chart_tag("txPr"))
    for part in rich:
        properties.append(deepcopy(part))
    paragraphs = properties.findall(drawing_tag("p"))
    for extra in paragraphs[1:]:
        properties.remove(extra)
    for paragraph in paragraphs[:1]:
        for run in paragraph.findall(drawing_tag("r")) + paragraph.findall(drawing_tag("br")):
            paragraph.remove(run)
        if paragraph.find(drawing_tag("endParaRPr")) is None:
            end = paragraph.makeelement(drawing_tag("endParaRPr"))
            end.set("lang", "en-US")
            paragraph.append(end)
    [child for child in title if child.tag != chart_tag("extLst")][-1].addnext(properties)


def _child(parent: Element, tag: str) -> Element:
    child = parent.makeelement(chart_tag(tag))
    parent.append(child)
    return child
