"""The schematic as shapes of a drawing: rectangles, polygons and words, in pixels."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from addin.charts.schematic import Coupling, Gear, Machine, Schematic, Shaft, schematic
from addin.contract.palette import PALETTE, SPEED_GROUPS
from addin.contract.sheets import SCHEMATIC
from addin.xlsx import Workbook
from addin.xlsx.drawn_shapes import Shape
from engine.case.data import CaseData

#: Height of its letters: 8 pt where the sheet is printed at 70 %. [pt]
LETTERS = 11.5
#: Mean width of a letter of Arial of that height, and height of a line. [pixel]
_LETTER, _LINE = 7.4, 18.0
#: Height of a picture of its own: of all, and more for each shaft line. [pixel]
_HEIGHT, _LINE_HEIGHT = 65.0, 75.0
#: Room at the sides; most that lengths are stretched against heights; depth and length of a tooth. [pixel, 1, pixel]
_SIDE, _STRETCH, _TOOTH, _PITCH = 6.0, 1.9, 4.0, 6.0


@dataclass(frozen=True)
class SchematicPicture:
    """The schematic as a picture of its own, outside a workbook."""

    width: float  #: [pixel]
    height: float  #: Likewise.
    shapes: tuple[Shape, ...]  #: Those behind first.


def schematic_picture(
    case: CaseData, width: float, letter: float = _LETTER
) -> SchematicPicture | None:
    """The schematic of a case; None where it has no stations.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    width : float
        Width of the picture; its height follows from the number of shaft lines. [pixel]
    letter : float
        Mean width of a letter in the font of the picture. [pixel]
    """
    if not case.stations:
        return None
    drawing = schematic(case)
    height = _HEIGHT + _LINE_HEIGHT * drawing.lines
    frame, *rest = schematic_shapes(drawing, width, height - 2.0 * _SIDE, letter)
    moved = (replace(shape, top=shape.top + _SIDE) for shape in rest)
    return SchematicPicture(width, height, (replace(frame, height=height, line=""), *moved))


def schematic_shapes(
    drawing: Schematic, width: float, height: float, letter: float = _LETTER
) -> list[Shape]:
    """The shapes of a schematic, those behind first.

    Parameters
    ----------
    drawing : Schematic
        What is drawn.
    width, height : float
        Size of the picture. [pixel]
    letter : float
        Mean width of a letter. [pixel]

    Returns
    -------
    list of Shape
    """
    return list(_Picture(drawing, width, height, letter).shapes())


class _Picture:
    def __init__(self, drawing: Schematic, width: float, height: float, letter: float) -> None:
        self._letter = letter
        self._drawing = drawing
        self._width, self._height = width, height
        room = width - 2.0 * _SIDE
        self._x = min(room / drawing.width if drawing.width else height, _STRETCH * height)
        self._left = _SIDE + 0.5 * (room - self._x * drawing.width)
        self._y = height

    def shapes(self) -> Iterator[Shape]:
        drawing = self._drawing
        yield Shape(0.0, 0.0, self._width, self._height, fill=PALETTE["white"], line="#D0D0D0")
        for shaft in drawing.shafts:
            yield self._shaft(shaft)
        for coupling in drawing.couplings:
            yield from self._coupling(coupling)
        for gear in drawing.gears:
            yield from self._gear(gear)
        for machine in drawing.machines:
            yield from self._machine(machine)
        for note in drawing.notes:
            yield self._text(note.words, self._at(note.left), self._y * note.axis, "l", bold=True)
        if drawing.not_drawn:
            words = f"Not drawn in place: {', '.join(drawing.not_drawn)}"
            yield self._text(words, self._width - 4.0, 0.5 * _LINE, "r")

    def _at(self, place: float) -> float:
        return self._left + self._x * place

    def _shaft(self, one: Shaft) -> Shape:
        half = 0.035 * self._y * self._drawing.pitch
        left, right = self._at(one.left), self._at(one.right)
        ink, pale = SPEED_GROUPS[one.group]
        top = self._y * one.axis - half
        return Shape(left, top, right - left, 2.0 * half, fill=pale, line=ink)

    def _coupling(self, one: Coupling) -> Iterator[Shape]:
        """Two hubs with flanges and a spacer between them, its name below."""
        left, right, axis = self._at(one.left), self._at(one.right), self._y * one.axis
        half, width = self._y * one.half, 0.22 * (right - left)
        yield self._shaft(Shaft(one.left, one.right, one.axis, one.group))
        ink, pale = SPEED_GROUPS[one.group]
        for hub, flange in ((left, left + width), (right - width, right - width - 4.0)):
            yield Shape(hub, axis - 0.7 * half, width, 1.4 * half, fill=pale, line=ink)
            yield Shape(flange, axis - half, 4.0, 2.0 * half, fill=ink, line=ink)
        room = right - left + 0.9 * self._x * 0.22
        words = self._wrapped(one.name, room)
        if axis + half + 2.0 * _LINE > self._height and "\n" in words:  # no room for two lines
            most = int(1.6 * room / self._letter)
            words = one.name if len(one.name) <= most else f"{one.name[: most - 1]}…"
        yield self._below(words, 0.5 * (left + right), axis + half)

    def _machine(self, one: Machine) -> Iterator[Shape]:
        left, width = self._at(one.left), self._x * one.width
        axis, half = self._y * one.axis, self._y * one.half
        ink, pale = SPEED_GROUPS[one.group]
        if not one.name or width < 3.0 * self._letter + 4.0:  # no room for a name
            yield Shape(left, axis - half, width, 2.0 * half, fill=ink, line=PALETTE["white"])
            return
        lines = max(1, int(2.0 * half / _LINE))
        words = "\n".join(self._wrapped(one.name, width - 4.0).split("\n")[:lines])
        paper, letters = (ink, PALETTE["white"]) if one.is_motor else (pale, "#262626")
        yield Shape(
            left, axis - half, width, 2.0 * half, fill=paper, line=ink, thickness=1.25,
            text=words, size=LETTERS, bold=True, ink=letters,
        )  # fmt: skip
        if one.words:
            words, room = one.words, width + 0.1 * self._x
            if len(words) * self._letter > room and axis + half + 2.0 * _LINE <= self._height:
                words = words.replace(", ", ",\n", 1)
            if self._letter * max(map(len, words.split("\n"))) <= self._to_neighbour(one):
                yield self._below(words, left + 0.5 * width, axis + half)

    def _to_neighbour(self, one: Machine) -> float:
        """From the middle of a machine to that of the nearest on its shaft line. [pixel]"""
        middle = one.left + 0.5 * one.width
        others = (
            abs(other.left + 0.5 * other.width - middle)
            for other in self._drawing.machines
            if other.name and other is not one and other.axis == one.axis
        )
        return self._x * min(others, default=math.inf)

    def _gear(self, one: Gear) -> Iterator[Shape]:
        """A gear from the side: its face with lines of teeth, teeth along both rims."""
        left, width = self._at(one.left), self._x * one.width
        half, axis = self._y * one.half, self._y * one.axis
        ink, pale = SPEED_GROUPS[one.group]
        count = max(3, round(width / _PITCH))
        pitch, depth = width / count, min(_TOOTH, 0.4 * half)
        rim = [
            (pitch * (k + share), depth * low)
            for k in range(count)
            for share, low in ((0.0, 1.0), (0.2, 0.0), (0.55, 0.0), (0.75, 1.0))
        ]
        rim.append((width, depth))
        foot = [(x, 2.0 * half - y) for x, y in reversed(rim)]
        yield Shape(left, axis - half, width, 2.0 * half, fill=pale, line=ink, points=(*rim, *foot))
        yield Shape(left, axis - 1.5, width, 3.0, fill=ink)

    def _below(self, words: str, middle: float, top: float) -> Shape:
        lines = words.count("\n") + 1
        return self._text(words, middle, top + 0.5 * _LINE * lines + 1.0, "ctr")

    def _text(self, words: str, x: float, y: float, side: str, *, bold: bool = False) -> Shape:
        width = self._letter * max(map(len, words.split("\n")))
        height = _LINE * (words.count("\n") + 1)
        left = {"ctr": x - 0.5 * width, "l": x, "r": x - width}[side]
        left = min(max(left, 1.0), max(self._width - width - 1.0, 1.0))
        top = min(max(y - 0.5 * height, 0.0), max(self._height - height, 0.0))
        return Shape(left, top, width, height, text=words, size=LETTERS, bold=bold, side=side)

    def _wrapped(self, words: str, width: float) -> str:
        """Words on at most two lines so wide."""
        most = max(int(width / self._letter), 3)
        if len(words) <= most:
            return words
        first: list[str] = []
        rest = words.split(" ")
        while rest and len(" ".join([*first, rest[0]])) <= most:
            first.append(rest.pop(0))
        if not first:
            first = [rest.pop(0)]
        second = " ".join(rest)
        lines = [" ".join(first), *([second] if second else [])]
        return "\n".join(line if len(line) <= most else f"{line[: most - 1]}…" for line in lines)


def draw_schematic(workbook: Workbook, case: CaseData) -> None:
    """Draw the train of a case where the workbook has a schematic.

    Parameters
    ----------
    workbook : Workbook
        The open workbook.
    case : CaseData
        Its case. [SI]
    """
    drawing = schematic(case)
    workbook.hide_objects({SCHEMATIC: not case.stations})
    workbook.draw(SCHEMATIC, lambda width, height: schematic_shapes(drawing, width, height))
