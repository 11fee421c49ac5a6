"""Charts: ranges that follow a resized table, and the copies of cell values that charts carry.

A chart part stores, beside each range, the values that were in it (``numCache``, ``strCache``). Viewers that do not
calculate show those, so they are renewed with the cells. Only chart parts whose ranges reach changed cells are
rewritten, and of these only the ``c:f`` texts and the caches.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from xml.sax.saxutils import escape

from lxml import etree

from .references import Rect, parse_range, retargeted, split_areas, split_sheet
from .values import Constant, ErrorValue, number_text
from .xml_part import CHART, Element, parse_part, serialise

Area = tuple[str, Rect]
Shown = Callable[[str, Rect], Sequence[Constant]]

_F, _PT_COUNT, _PT, _LEVEL = (f"{{{CHART}}}{tag}" for tag in ("f", "ptCount", "pt", "lvl"))
_EXTENSIONS = f"{{{CHART}}}extLst"
_CACHES = {
    f"{{{CHART}}}{kind}Ref": f"{{{CHART}}}{kind}Cache" for kind in ("num", "str", "multiLvlStr")
}
_MULTI_LEVEL = f"{{{CHART}}}multiLvlStrRef"
_NUMBERS = f"{{{CHART}}}numRef"


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
        self._root = parse_part(data, part)

    def retarget(self, sheet: str, old: Rect, new: Rect) -> int:
        """Let ranges that covered exactly the old rows of a block cover its new rows.

        Parameters
        ----------
        sheet : str
            Sheet of the block.
        old, new : Rect
            The block before and after; same columns, same first row.

        Returns
        -------
        int
            Number of ranges changed.
        """
        count = 0
        for formula in self._by_rows.pop((sheet, old.top, old.bottom), {}):
            areas = split_areas(formula.text)
            moved = [retargeted(area, sheet, old, new) for area in areas]
            if moved != areas:
                formula.text = f"({','.join(moved)})" if len(moved) > 1 else moved[0]
                count += 1
            for place in _rows_of_areas(formula.text):
                self._by_rows[place][formula] = None
        self.changed = self.changed or count > 0
        return count

    def refresh(
        self,
        resolve: Callable[[str], list[Area] | None],
        touched: Callable[[str, Rect], bool],
        shown: Shown,
    ) -> int:
        """Renew the caches of all ranges that reach changed cells.

        Parameters
        ----------
        resolve : callable
            Areas of a reference text; None when it cannot be followed.
        touched : callable
            Whether a rectangle of a sheet holds a changed cell.
        shown : callable
            Values that the cells of a rectangle of a sheet show, row by row.

        Returns
        -------
        int
            Number of caches renewed.
        """
        count = 0
        for reference in self._root.iter(*_CACHES):
            cache = reference.find(_CACHES[reference.tag])
            areas = resolve(reference.findtext(_F) or "") if cache is not None else None
            if areas is None or not any(touched(*area) for area in areas):
                continue
            _fill_cache(reference.tag, cache, areas, shown)
            count += 1
        self.changed = self.changed or count > 0
        return count

    def to_bytes(self) -> bytes:
        """The part as it shall be stored."""
        return serialise(self._root, self._original)

    @cached_property
    def _by_rows(self) -> dict[tuple[str, int, int], dict[Element, None]]:
        """Range texts by the sheet, first and last row of their areas, as every resized table asks for some."""
        index: dict[tuple[str, int, int], dict[Element, None]] = defaultdict(dict)
        for formula in self._root.iter(_F):
            for place in _rows_of_areas(formula.text or ""):
                index[place][formula] = None
        return index


def _rows_of_areas(reference: str) -> Iterator[tuple[str, int, int]]:
    for area in split_areas(reference):
        sheet, text = split_sheet(area)
        try:
            rect = parse_range(text)
        except ValueError:
            continue
        yield sheet, rect.top, rect.bottom


def _fill_cache(kind: str, cache: Element, areas: list[Area], shown: Shown) -> None:
    for old in cache.findall(_PT_COUNT) + cache.findall(_PT) + cache.findall(_LEVEL):
        cache.remove(old)
    if kind == _MULTI_LEVEL:
        xml = _levels_xml(areas, shown)
    else:
        text = _number_point if kind == _NUMBERS else _text_point
        points = [text(value) for sheet, rect in areas for value in shown(sheet, rect)]
        xml = _points_xml(points, with_count=True)
    new = list(etree.fromstring(f'<d xmlns="{CHART}">{xml}</d>'))
    # The schema wants format code, count and points in this order, extensions last.
    extensions = cache.find(_EXTENSIONS)
    at = len(cache) if extensions is None else cache.index(extensions)
    cache[at:at] = new


def _levels_xml(areas: list[Area], shown: Shown) -> str:
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
        points = [_text_point(value) for value in shown(sheet, area)]
        levels.append(f"<lvl>{_points_xml(points, with_count=False)}</lvl>")
    return f'<ptCount val="{count}"/>' + "".join(levels)


def _points_xml(points: list[str | None], *, with_count: bool) -> str:
    written = "".join(
        f'<pt idx="{index}"><v>{point}</v></pt>'
        for index, point in enumerate(points)
        if point is not None
    )
    return (f'<ptCount val="{len(points)}"/>' if with_count else "") + written


def _number_point(value: Constant) -> str | None:
    """Number of a point; text and errors have none, as a spreadsheet program leaves them out too."""
    if type(value) is float:
        return number_text(value)
    if isinstance(value, bool):
        return "1" if value else "0"
    return None


def _text_point(value: Constant) -> str | None:
    if value is None or value == "":
        return None
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, float):
        return f"{value:.15g}"
    return escape(value.code if isinstance(value, ErrorValue) else str(value))
