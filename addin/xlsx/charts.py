"""Charts: ranges that follow a resized table, and the copies of cell values that charts carry.

A chart part stores, beside each range, the values that were in it (``numCache``, ``strCache``). Viewers that do not
calculate show those, so they are renewed with the cells. Only chart parts whose ranges reach changed cells are
rewritten, and of these only the ``c:f`` texts and the caches.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from html import escape, unescape
from math import isclose, isfinite

from addin.xlsx.chart_titles import TitleLink, link_titles
from addin.xlsx.errors import WorkbookRefused
from addin.xlsx.references import (
    Rect,
    parse_range,
    retargeted,
    split_areas,
    split_sheet,
    whole_number,
)
from addin.xlsx.values import Constant, ErrorValue, are_plain_numbers
from addin.xlsx.xml_part import CHART, Element, has_misleading_tags, is_utf8, parse_part, serialise

Area = tuple[str, Rect]


@dataclass(frozen=True)
class Shown:
    """What the cells of a rectangle of a sheet show."""

    values: Callable[[str, Rect], Sequence[Constant]]  #: Their values, row by row.
    #: Texts of a column of numbers, whole ones with ``.0``; None where they are not at hand.
    number_texts: Callable[[str, Rect], list[str | None] | None]


_F, _PT_COUNT, _PT, _LEVEL = (f"{{{CHART}}}{tag}" for tag in ("f", "ptCount", "pt", "lvl"))
_VALUES = frozenset([_PT_COUNT, _PT, _LEVEL])
_EXTENSIONS = f"{{{CHART}}}extLst"
_CACHES = {
    f"{{{CHART}}}{kind}Ref": f"{{{CHART}}}{kind}Cache" for kind in ("num", "str", "multiLvlStr")
}
_MULTI_LEVEL = f"{{{CHART}}}multiLvlStrRef"
_NUMBERS = f"{{{CHART}}}numRef"
# Labels whose words stand in cells ("value from cells"), which Excel 2013 and later keep in an extension.
_C15 = "http://schemas.microsoft.com/office/drawing/2012/chart"
_LABELS, _LABELS_F, _LABELS_CACHE = (
    f"{{{_C15}}}{tag}" for tag in ("datalabelsRange", "f", "dlblRangeCache")
)
# Where points go that are still text: a point with an index that no chart has.
_PLACE_INDEX = "points-"
_PLACE = re.compile(rb"<[^<>]*pt idx=\"points-([0-9]{1,7})\"/>")
# Points, behind their number, as the parser would write them again, to the last byte.
_PLAIN_TEXT = rb"(?:[ -%'-;=?-~]++|&(?:amp|lt|gt);){1,300}+"
_PLAIN_POINTS = re.compile(
    rb'<c:ptCount val="[0-9]{1,7}+"/>(?:<c:pt idx="[0-9]{1,7}+"><c:v>%s</c:v></c:pt>)*+'
    % _PLAIN_TEXT
)
_PLAIN_POINT = re.compile(rb'idx="([0-9]+)"><c:v>([^<]*)<')
_PREFIX = b' xmlns:c="%s"' % CHART.encode()
_NUMERIC = (bool, float)
_MOST_KEPT_POINTS = 4096
# What is kept of earlier charts: so many, none longer.
_MOST_KEPT_CHARTS, _LONG_CHART = 96, 2**18
# Some whole columns; programs draw far fewer points.
MOST_POINTS = 4 * 2**20


class ChartPart:
    """One chart.

    Parameters
    ----------
    part : str
        Name of the part.
    data : bytes
        The part as stored.
    """

    def __init__(self, part: str, data: bytes) -> None:
        self.part = part
        self.changed = False
        self._original = data
        # Points stay text, those that the file has and those of renewed caches: as elements they would cost more than
        # all the rest of it.
        without, points = (_kept_points if len(data) <= _LONG_CHART else _without_points)(data)
        self._points = list(points)
        try:
            self._root = parse_part(without, part)
        except WorkbookRefused:
            # Said of the part as it is stored, with the places in it.
            self._root = parse_part(data, part)
        self._points_left = MOST_POINTS

    def retarget(self, sheet: str, old: Rect, new: Rect) -> None:
        """Let ranges that covered exactly the old rows of a block cover its new rows."""
        for formula in self._by_rows.pop((sheet, old.top, old.bottom), {}):
            areas = split_areas(formula.text)
            moved = [retargeted(area, sheet, old, new) for area in areas]
            if moved != areas:
                formula.text = f"({','.join(moved)})" if len(moved) > 1 else moved[0]
                self.changed = True
            for place in _rows_of_areas(formula.text):
                self._by_rows[place][formula] = None

    def refresh(
        self,
        resolve: Callable[[str], list[Area] | None],
        touched: tuple[Callable[[str, Rect], bool], Callable[[str, Rect], bool]],
        shown: Shown,
        known: dict[tuple[str, str, tuple[Area, ...]], bytes],
    ) -> None:
        """Renew the caches of all ranges that reach changed cells.

        Parameters
        ----------
        resolve : callable
            Areas of a reference text; None when it cannot be followed.
        touched : tuple of callable
            Whether a rectangle of a sheet holds a changed cell; whether it holds one that may have changed: then a
            cache is renewed only if it does not carry the values.
        shown : Shown
            What cells show.
        known : dict
            Points that other charts of the workbook draw, too, by kind, prefix and areas; added to.
        """
        for reference in self._root.iter(*_CACHES, _LABELS):
            text, cache_tag = (
                (_LABELS_F, _LABELS_CACHE)
                if reference.tag == _LABELS
                else (_F, _CACHES[reference.tag])
            )
            cache = reference.find(cache_tag)
            areas = resolve(reference.findtext(text) or "") if cache is not None else None
            if areas is None:
                continue
            changed, perhaps = (any(test(*area) for area in areas) for test in touched)
            if not changed and not (
                perhaps and _is_old(reference.tag, self._held(cache), areas, shown)
            ):
                continue
            self._fill(reference.tag, cache, areas, shown, known)
            self.changed = True

    def link_titles(
        self,
        links: Sequence[TitleLink],
        resolve: Callable[[str], list[Area] | None],
        text: Callable[[str, str], str],
    ) -> None:
        """Link titles that became fixed words to their cells again.

        Parameters
        ----------
        links : sequence of TitleLink
            Cells of the titles, by the cells a chart draws.
        resolve : callable
            Areas of a reference text; None when it cannot be followed.
        text : callable
            Text that a cell of a sheet shows.
        """
        self.changed |= link_titles(self._root, links, resolve, text)

    def to_bytes(self) -> bytes:
        """The part as it shall be stored."""
        data = serialise(self._root, self._original)

        def points(found: re.Match[bytes]) -> bytes:
            number = int(found[1])
            return self._points[number] if number < len(self._points) else found[0]

        return _PLACE.sub(points, data)

    def _held(self, cache: Element) -> dict[str, str | None]:
        """Values that a cache carries, by their index."""
        held: dict[str, str | None] = {}
        for point in cache.iter(_PT):
            index = point.get("idx", "")
            number = whole_number(index.removeprefix(_PLACE_INDEX), len(self._points) - 1)
            if index.startswith(_PLACE_INDEX) and number is not None:
                for at, text in _PLAIN_POINT.findall(self._points[number]):
                    held[at.decode()] = unescape(text.decode())
            else:
                held[index] = point.findtext(f"{{{CHART}}}v")
        return held

    def _fill(
        self,
        kind: str,
        cache: Element,
        areas: list[Area],
        shown: Shown,
        known: dict[tuple[str, str, tuple[Area, ...]], bytes],
    ) -> None:
        for old in [child for child in cache if child.tag in _VALUES]:
            cache.remove(old)
        # The points are of the chart's own namespace, in an extension too.
        short = next((one for one, uri in cache.nsmap.items() if uri == CHART), None)
        prefix = f"{short}:" if short else ""
        self._points_left -= sum(rect.height * rect.width for _, rect in areas)
        place = (kind, prefix, tuple(areas))
        if self._points_left < 0:
            # more than any chart draws: blank beats wrong
            xml = f'<{prefix}ptCount val="0"/>'.encode()
        elif place in known:
            xml = known[place]
        else:
            xml = known[place] = _cache_xml(kind, areas, shown, prefix).encode()
        # The schema wants format code, count and points in this order, extensions last.
        extensions = cache.find(_EXTENSIONS)
        at = len(cache) if extensions is None else cache.index(extensions)
        cache.insert(at, cache.makeelement(_PT, idx=f"{_PLACE_INDEX}{len(self._points)}"))
        self._points.append(xml)

    @cached_property
    def _by_rows(self) -> dict[tuple[str, int, int], dict[Element, None]]:
        """Range texts by the sheet, first and last row of their areas, as every resized table asks for some."""
        index: dict[tuple[str, int, int], dict[Element, None]] = defaultdict(dict)
        for formula in self._root.iter(_F, _LABELS_F):
            for place in _rows_of_areas(formula.text or ""):
                index[place][formula] = None
        return index


def _without_points(data: bytes) -> tuple[bytes, tuple[bytes, ...]]:
    """A chart with places for its plain points, where what looks like a point is one; and these points."""
    points: list[bytes] = []
    declared_once = data.count(b"xmlns:c=") == 1 and _PREFIX in data
    misleading = has_misleading_tags(data) or _PLACE_INDEX.encode() in data
    if not declared_once or misleading or not is_utf8(data):
        return data, ()

    def place(found: re.Match[bytes]) -> bytes:
        points.append(found[0])
        return b'<c:pt idx="%s%d"/>' % (_PLACE_INDEX.encode(), len(points) - 1)

    return _PLAIN_POINTS.sub(place, data), tuple(points)


# Charts of one template, and of a workbook calculated again, are the same.
_kept_points = lru_cache(maxsize=_MOST_KEPT_CHARTS)(_without_points)


def _rows_of_areas(reference: str) -> Iterator[tuple[str, int, int]]:
    for area in split_areas(reference):
        sheet, text = split_sheet(area)
        try:
            rect = parse_range(text)
        except ValueError:
            continue
        yield sheet, rect.top, rect.bottom


def _is_old(kind: str, held: dict[str, str | None], areas: list[Area], shown: Shown) -> bool:
    """Whether a cache carries other values than its cells show; one with several levels is not judged."""
    if kind == _MULTI_LEVEL:
        return False
    values = [value for sheet, rect in areas for value in shown.values(sheet, rect)]
    expected = {
        str(index): text
        for index, value in enumerate(values)
        if (text := _number_of(value) if kind == _NUMBERS else _words_of(value)) is not None
    }
    return held.keys() != expected.keys() or any(
        not _alike(held[index], wanted) for index, wanted in expected.items()
    )


def _alike(held: str | None, wanted: float | str) -> bool:
    if isinstance(wanted, str):
        return held == wanted
    try:
        return isclose(float(held or ""), wanted, rel_tol=1e-14)
    except ValueError:
        return False


def _cache_xml(kind: str, areas: list[Area], shown: Shown, prefix: str) -> str:
    """Count and points of a range."""
    if kind == _MULTI_LEVEL:
        return _levels_xml(areas, shown, prefix)
    if kind == _NUMBERS and len(areas) == 1:
        texts = shown.number_texts(*areas[0])
        if texts is not None:
            return _numbers_xml(texts, prefix)
    values = [value for sheet, rect in areas for value in shown.values(sheet, rect)]
    if kind != _NUMBERS:
        points = [_text_point(value) for value in values]
        return f'<{prefix}ptCount val="{len(points)}"/>{_points_xml(points, prefix)}'
    # Text and errors have none, as a spreadsheet program leaves them out too.
    numbers = values if are_plain_numbers(values) else map(_number_of, values)
    return _numbers_xml([None if one is None else repr(one) for one in numbers], prefix)


def _numbers_xml(numbers: Sequence[str | None], prefix: str) -> str:
    xml = f'<{prefix}ptCount val="{len(numbers)}"/>{_points_xml(numbers, prefix)}'
    # Whole numbers without a point, as `number_text` writes them.
    return xml.replace(f".0</{prefix}v>", f"</{prefix}v>")


def _levels_xml(areas: list[Area], shown: Shown, prefix: str) -> str:
    """Levels of a category axis with several label columns, the innermost (last column) first."""
    sheet, rect = areas[0]
    by_columns = rect.height >= rect.width
    lines = (
        range(rect.right, rect.left - 1, -1) if by_columns else range(rect.bottom, rect.top - 1, -1)
    )
    count = rect.height if by_columns else rect.width
    levels = []
    for line in lines:
        area = (
            Rect(rect.top, line, rect.bottom, line)
            if by_columns
            else Rect(line, rect.left, line, rect.right)
        )
        points = [_text_point(value) for value in shown.values(sheet, area)]
        levels.append(f"<{prefix}lvl>{_points_xml(points, prefix)}</{prefix}lvl>")
    return f'<{prefix}ptCount val="{count}"/>' + "".join(levels)


def _points_xml(points: Sequence[str | None], prefix: str) -> str:
    between = _between(prefix, max(64, 1 << (len(points) - 1).bit_length()))
    texts = [point for point in points if point is not None]
    if len(texts) < len(points):
        pairs = zip(between, points, strict=False)
        between = [start for start, point in pairs if point is not None]
    pieces = [""] * (2 * len(texts))
    pieces[::2], pieces[1::2] = between[: len(texts)], texts
    end = f"</{prefix}v></{prefix}pt>"
    return f"{''.join(pieces).removeprefix(end)}{end}" if pieces else ""


def _all_between(prefix: str, count: int) -> list[str]:
    """What stands between the values of so many points and the points before them."""
    return [
        f'</{prefix}v></{prefix}pt><{prefix}pt idx="{index}"><{prefix}v>' for index in range(count)
    ]


_kept_between = lru_cache(maxsize=8)(_all_between)


def _between(prefix: str, count: int) -> list[str]:
    """The same; that of the charts that are usual is kept."""
    return (_kept_between if count <= _MOST_KEPT_POINTS else _all_between)(prefix, count)


def _number_of(value: Constant) -> float | None:
    return float(value) if isinstance(value, _NUMERIC) and isfinite(value) else None


def _text_point(value: Constant) -> str | None:
    words = _words_of(value)
    return None if words is None else escape(words, quote=False)


def _words_of(value: Constant) -> str | None:
    if value is None or value == "":
        return None
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, float):
        return f"{value:.15g}"
    return value.code if isinstance(value, ErrorValue) else str(value)
