"""Shapes drawn on a sheet as one group that takes the place of an object of the same description.

The group keeps the anchor of what it replaces, and so the place and the size that the engineer gave it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from addin.xlsx.references import cell_name
from addin.xlsx.xml_part import Element, parse_part, serialise

#: English Metric Units in a pixel of 96 to the inch.
EMU = 9525
_A = "http://schemas.openxmlformats.org/drawingml/2006/main"
_XDR = "http://schemas.openxmlformats.org/drawingml/2006/spreadsheetDrawing"
_OBJECTS = tuple(f"{{{_XDR}}}{tag}" for tag in ("sp", "grpSp", "graphicFrame", "cxnSp", "pic"))
#: The properties of an object in a drawing, without what follows their last attribute.
_ABOUT = re.compile(rb"<(?:[A-Za-z][\w.-]*:)?cNvPr\b[^<>]*?(?=\s*/?>)")
_DESCRIPTION = re.compile(rb"""\bdescr=(?:"([^"]*)"|'([^']*)')""")
_HIDDEN = re.compile(rb"""\s+hidden=(?:"([^"]*)"|'([^']*)')""")

Point = tuple[float, float]


@dataclass(frozen=True)
class Shape:
    """A rectangle, a polygon or a line, with words in its middle."""

    left: float  #: [pixel]
    top: float  #: Likewise.
    width: float  #: Likewise.
    height: float  #: Likewise.
    fill: str = ""  #: ``#RRGGBB``; empty = none.
    line: str = ""  #: Likewise.
    thickness: float = 0.75  #: Of the line. [pt]
    dash: bool = False
    points: tuple[Point, ...] = ()  #: Corners of a polygon, from its upper left corner. [pixel]
    text: str = ""
    size: float = 11.5  #: Height of the letters. [pt]
    bold: bool = False
    ink: str = "#262626"  #: Colour of the words.
    side: str = "ctr"  #: Where the words stand: ``ctr``, ``l`` or ``r``.


@dataclass(frozen=True)
class Frame:
    """The room of a group: its place on the sheet and its size."""

    left: int  #: [EMU]
    top: int  #: Likewise.
    width: int  #: Likewise.
    height: int  #: Likewise.


@dataclass(frozen=True)
class DrawnGroup:
    """A group of shapes as a drawing holds it."""

    sheet: str  #: Where.
    cell: str  #: Of its upper left corner. [A1]
    width: float  #: Of its own room, before anybody stretched it. [pixel]
    height: float  #: Likewise.
    hidden: bool
    shapes: tuple[Shape, ...]  #: Those behind first; none where nothing was drawn yet.
    turned: bool  #: Whether it or a shape is turned or mirrored.


def with_hidden(data: bytes, hidden: Mapping[str, bool]) -> bytes:
    """A drawing part with objects of some descriptions hidden or shown; of the others no byte changes."""

    def renewed(found: re.Match[bytes]) -> bytes:
        described = _DESCRIPTION.search(found[0])
        if described is None:
            return found[0]
        name = (described[1] or described[2] or b"").decode("utf-8", "replace")
        if name not in hidden:
            return found[0]
        held = _HIDDEN.search(found[0])
        is_hidden = held is not None and (held[1] or held[2]) not in (b"0", b"false")
        if is_hidden == hidden[name]:
            return found[0]
        bare = _HIDDEN.sub(b"", found[0])
        return bare + b' hidden="1"' if hidden[name] else bare

    return _ABOUT.sub(renewed, data)


class ShapeGroup:
    """An object of a drawing part that is drawn anew.

    Parameters
    ----------
    part : str
        Name of the part.
    data : bytes
        The part as stored.
    description : str
        Description of the object.
    """

    def __init__(self, part: str, data: bytes, description: str) -> None:
        self._data = data
        self._description = description
        self._root = parse_part(data, part)
        self._object = next(self._objects(description), None)

    @property
    def frame(self) -> Frame | None:
        """Its room; None where the drawing has no such object."""
        if self._object is None:
            return None
        for xfrm in self._object.iter(f"{{{_A}}}xfrm"):
            at, size = xfrm.find(f"{{{_A}}}off"), xfrm.find(f"{{{_A}}}ext")
            if at is not None and size is not None:
                values = [at.get("x"), at.get("y"), size.get("cx"), size.get("cy")]
                if all(re.fullmatch(r"-?\d{1,10}", value or "") for value in values):
                    return Frame(*(int(value or 0) for value in values))
        return None

    def drawn(self, shapes: Sequence[Shape]) -> bytes:
        """The part with these shapes in the place of the object."""
        frame, old = self.frame, self._object
        if frame is None or old is None:
            return self._data
        about = next(one for one in old.iter(f"{{{_XDR}}}cNvPr"))
        used = {one.get("id") for one in self._root.iter(f"{{{_XDR}}}cNvPr")}
        within = {one.get("id") for one in old.iter(f"{{{_XDR}}}cNvPr")}
        numbers = (str(n) for n in range(2, 10**6) if str(n) not in used - within)
        head = (self._description, self._description, about.get("hidden", ""))
        group = parse_part(_group_xml(frame, shapes, head, numbers).encode(), "group")
        parent = old.getparent()
        parent.replace(old, group)
        return serialise(self._root, self._data)

    def read(self, sheet: str) -> DrawnGroup | None:
        """The group as it is; None where the drawing has no such object."""
        if self._object is None:
            return None
        about = next(one for one in self._object.iter(f"{{{_XDR}}}cNvPr"))
        hidden = about.get("hidden", "0") not in ("0", "false")
        at = next(self._object.getparent().iter(f"{{{_XDR}}}from"), None)
        column, row = (
            0 if at is None else int(at.findtext(f"{{{_XDR}}}{tag}") or 0) for tag in ("col", "row")
        )
        own = self._object.find(f"{{{_XDR}}}grpSpPr/{{{_A}}}xfrm")
        room = None if own is None else _box(own, "chOff", "chExt") or _box(own, "off", "ext")
        left, top, width, height = room or (0.0, 0.0, 0.0, 0.0)
        within = self._object.iter(*_OBJECTS) if room else ()
        shapes = [_read_shape(one, left, top) for one in within if one.tag != f"{{{_XDR}}}grpSp"]
        turned = any(
            one.get(key, "0") not in ("0", "false")
            for one in self._object.iter(f"{{{_A}}}xfrm")
            for key in ("rot", "flipH", "flipV")
        )
        cell = cell_name(row + 1, column + 1)
        return DrawnGroup(sheet, cell, width, height, hidden, tuple(shapes), turned)

    def _objects(self, description: str) -> Iterator[Element]:
        for anchor in self._root:
            for one in anchor:
                if one.tag in _OBJECTS:
                    about = next(iter(one.iter(f"{{{_XDR}}}cNvPr")), None)
                    # LibreOffice drops the description of a group, and keeps its name
                    if about is not None and description in (about.get("descr"), about.get("name")):
                        yield one


def _group_xml(
    frame: Frame, shapes: Sequence[Shape], head: tuple[str, str, str], numbers: Iterator[str]
) -> str:
    name, description, hidden = head
    place = (
        f'<a:off x="{frame.left}" y="{frame.top}"/><a:ext cx="{frame.width}" cy="{frame.height}"/>'
    )
    inner = place.replace("a:off", "a:chOff").replace("a:ext", "a:chExt")
    attributes = f' hidden="{hidden}"' if hidden else ""
    return (
        f'<xdr:grpSp xmlns:xdr="{_XDR}" xmlns:a="{_A}"><xdr:nvGrpSpPr><xdr:cNvPr id="{next(numbers)}" '
        f'name="{escape(name)}" descr="{escape(description)}"{attributes}/><xdr:cNvGrpSpPr/></xdr:nvGrpSpPr>'
        f"<xdr:grpSpPr><a:xfrm>{place}{inner}</a:xfrm></xdr:grpSpPr>"
        + "".join(_shape_xml(one, frame, next(numbers)) for one in shapes)
        + "</xdr:grpSp>"
    )


def _shape_xml(one: Shape, frame: Frame, number: str) -> str:
    x, y = frame.left + _emu(one.left), frame.top + _emu(one.top)
    cx, cy = _emu(one.width), _emu(one.height)
    kind = '<xdr:cNvSpPr txBox="1"/>' if one.text else "<xdr:cNvSpPr/>"
    return (
        f'<xdr:sp macro="" textlink=""><xdr:nvSpPr><xdr:cNvPr id="{number}" name="Shape {number}"/>{kind}</xdr:nvSpPr>'
        f'<xdr:spPr><a:xfrm><a:off x="{x}" y="{y}"/><a:ext cx="{cx}" cy="{cy}"/></a:xfrm>'
        f"{_geometry(one)}{_fill(one.fill)}{_line(one)}</xdr:spPr>{_words(one)}</xdr:sp>"
    )


def _read_shape(one: Element, left: float, top: float) -> Shape:
    """A shape as it stands in a group whose room begins there."""
    settings = one.find(f"{{{_XDR}}}spPr")
    xfrm = None if settings is None else settings.find(f"{{{_A}}}xfrm")
    box = None if xfrm is None else _box(xfrm, "off", "ext")
    x, y, width, height = box or (left, top, 0.0, 0.0)
    look = next(one.iter(f"{{{_A}}}rPr"), None)
    lines = one.iterfind(f"{{{_XDR}}}txBody/{{{_A}}}p")
    return Shape(
        x - left, y - top, width, height,
        fill=_colour(settings), line=_colour(None if settings is None else settings.find(f"{{{_A}}}ln")),
        points=() if settings is None else tuple(_corners(settings, width, height)),
        text="\n".join("".join(run.text or "" for run in line.iter(f"{{{_A}}}t")) for line in lines),
        size=0.0 if look is None else _whole(look.get("sz")) / 100.0,
        ink=_colour(look),
    )  # fmt: skip


def _box(xfrm: Element, at: str, size: str) -> tuple[float, float, float, float] | None:
    """Place and size that a transformation states. [pixel]"""
    first, second = xfrm.find(f"{{{_A}}}{at}"), xfrm.find(f"{{{_A}}}{size}")
    if first is None or second is None:
        return None
    values = (first.get("x"), first.get("y"), second.get("cx"), second.get("cy"))
    x, y, width, height = (_whole(value) / EMU for value in values)
    return x, y, width, height


def _whole(value: str | None) -> int:
    """A whole number; 0 for anything else."""
    return int(value) if value and re.fullmatch(r"-?\d{1,10}", value) else 0


def _colour(holder: Element | None) -> str:
    """Its own solid colour, ``#RRGGBB``; ``?`` for another, empty for none."""
    fill = None if holder is None else holder.find(f"{{{_A}}}solidFill")
    if fill is None:
        return ""
    colour = fill.find(f"{{{_A}}}srgbClr")
    return "?" if colour is None or len(colour) else f"#{colour.get('val', '').upper()}"


def _corners(settings: Element, width: float, height: float) -> Iterator[Point]:
    """Corners of a polygon. [pixel]"""
    for path in settings.iter(f"{{{_A}}}path"):
        across, down = (max(_whole(path.get(key)), 1) for key in ("w", "h"))
        for point in path.iter(f"{{{_A}}}pt"):
            x, y = (_whole(point.get(key)) for key in ("x", "y"))
            yield width * x / across, height * y / down


def _emu(pixels: float) -> int:
    return round(pixels * EMU)


def _geometry(one: Shape) -> str:
    if not one.points:
        return '<a:prstGeom prst="rect"><a:avLst/></a:prstGeom>'
    steps = "".join(
        f'<a:{"lnTo" if k else "moveTo"}><a:pt x="{_emu(x)}" y="{_emu(y)}"/></a:{"lnTo" if k else "moveTo"}>'
        for k, (x, y) in enumerate(one.points)
    )
    close = "<a:close/>" if one.fill else ""
    return (
        "<a:custGeom><a:avLst/><a:gdLst/><a:ahLst/><a:cxnLst/>"
        '<a:rect l="0" t="0" r="r" b="b"/><a:pathLst>'
        f'<a:path w="{_emu(one.width)}" h="{_emu(one.height)}">{steps}{close}</a:path>'
        "</a:pathLst></a:custGeom>"
    )


def _fill(colour: str) -> str:
    if not colour:
        return "<a:noFill/>"
    return f'<a:solidFill><a:srgbClr val="{colour[1:]}"/></a:solidFill>'


def _line(one: Shape) -> str:
    if not one.line:
        return "<a:ln><a:noFill/></a:ln>"
    dash = '<a:prstDash val="lgDashDot"/>' if one.dash else ""
    return f'<a:ln w="{round(one.thickness * 12700)}">{_fill(one.line)}{dash}</a:ln>'


def _words(one: Shape) -> str:
    """The text body; without words there is none."""
    if not one.text:
        return ""
    bold = ' b="1"' if one.bold else ""
    look = (
        f'lang="en-US" sz="{round(100 * one.size)}"{bold}>'
        f'{_fill(one.ink)}<a:latin typeface="Arial"/><a:cs typeface="Arial"/>'
    )
    lines = "".join(
        f'<a:p><a:pPr algn="{one.side}"/><a:r><a:rPr {look}</a:rPr><a:t>{escape(line, quote=False)}</a:t></a:r></a:p>'
        for line in one.text.split("\n")
    )
    return (
        '<xdr:txBody><a:bodyPr vertOverflow="overflow" horzOverflow="overflow" wrap="none" lIns="0" tIns="0" '
        f'rIns="0" bIns="0" anchor="ctr"/><a:lstStyle/>{lines}</xdr:txBody>'
    )
