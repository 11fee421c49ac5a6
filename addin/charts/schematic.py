"""The train as a line drawing in the manner of the paper's Figure 5: machines, couplings and gears on their shafts.

What is drawn where, for every program that draws it: lengths are shares of the height of the picture.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from addin.contract.chart_tables import GROUPS
from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, StationRow

#: Lengths along the shaft, in heights of a picture with one shaft line. [1]
_MACHINE, _DISC, _GEAR, _SHAFT, _COUPLING, _GAP = 0.85, 0.10, 0.24, 0.22, 0.62, 0.35
#: Half heights of machines, hubs and discs, in distances between shaft lines. [1]
_MACHINE_HALF, _HUB_HALF, _DISC_HALF = 0.27, 0.13, 0.2
#: A station of at least this share of the largest inertia of its shaft line is drawn as a machine. [1]
_MACHINE_INERTIA = 0.2
#: Share of the distance between two shaft lines that a gear takes at the least. [1]
_LEAST_GEAR = 0.22
_RPM = math.pi / 30.0


@dataclass(frozen=True)
class Machine:
    """A motor or a driven machine; or a disc, without words."""

    name: str  #: Its station; empty = a disc or a hub.
    words: str  #: Power and speed, below it.
    left: float  #: [height of the picture]
    width: float  #: Likewise.
    axis: float  #: Of its shaft, from above. [height of the picture]
    half: float  #: Half its height. [height of the picture]
    group: int  #: Which colour of `SPEED_GROUPS`. [count]
    is_motor: bool = False


@dataclass(frozen=True)
class Shaft:
    """A piece of shaft, from left to right."""

    left: float  #: [height of the picture]
    right: float  #: Likewise.
    axis: float  #: From above. [height of the picture]
    group: int  #: Which colour. [count]


@dataclass(frozen=True)
class Coupling:
    """A coupling: two hubs and a spacer."""

    name: str  #: Its element.
    left: float  #: [height of the picture]
    right: float  #: Likewise.
    axis: float  #: From above. [height of the picture]
    half: float  #: Half height of its hubs. [height of the picture]
    group: int  #: Which colour. [count]


@dataclass(frozen=True)
class Gear:
    """A gear in mesh, seen from the side."""

    left: float  #: [height of the picture]
    width: float  #: Likewise.
    axis: float  #: From above. [height of the picture]
    half: float  #: Its radius in the drawing. [height of the picture]
    group: int  #: Which colour. [count]


@dataclass(frozen=True)
class Note:
    """Words beside the mesh: ratio and numbers of teeth."""

    words: str
    left: float  #: Where they begin. [height of the picture]
    axis: float  #: Their middle, from above. [height of the picture]


@dataclass(frozen=True)
class Schematic:
    """The drawing; it is one high and `width` wide."""

    width: float  #: [height of the picture]
    machines: tuple[Machine, ...] = ()
    shafts: tuple[Shaft, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    gears: tuple[Gear, ...] = ()
    notes: tuple[Note, ...] = ()
    pitch: float = 1.0  #: Between two shaft lines. [height of the picture]
    not_drawn: tuple[str, ...] = ()  #: Elements that close a loop of others. [names]

    @property
    def lines(self) -> int:
        """Shaft lines one below the other. [count]"""
        upright: tuple[Machine | Shaft | Coupling | Gear, ...] = (
            *self.machines, *self.shafts, *self.couplings, *self.gears,
        )  # fmt: skip
        return len({round(one.axis, 6) for one in upright})


@dataclass(frozen=True)
class _Item:
    """A station or an element in the row of a shaft line."""

    name: str
    left: float
    width: float


class _Line:
    """One shaft line while it is laid out: what stands on it, from its gear or first station outwards."""

    def __init__(self, level: int, left: float) -> None:
        self.level = level
        self.stations: dict[str, _Item] = {}
        self.elements: dict[str, _Item] = {}
        self.left = self.right = left

    def add(
        self,
        station: str,
        width: float,
        element: str = "",
        length: float = 0.0,
        *,
        before: bool = False,
    ) -> None:
        """A station at an end of the line, behind an element."""
        if before:
            if element:
                self.elements[element] = _Item(element, self.left - length, length)
            self.left -= length + width
            self.stations[station] = _Item(station, self.left, width)
            return
        if element:
            self.elements[element] = _Item(element, self.right, length)
        self.stations[station] = _Item(station, self.right + length, width)
        self.right += length + width


def schematic(case: CaseData) -> Schematic:
    """The drawing of a train.

    Parameters
    ----------
    case : CaseData
        The case; checked or not. [SI]

    Returns
    -------
    Schematic
        Empty where there is no station. Branches of a shaft line beyond its two ends, and elements that close a
        loop, are listed in `not_drawn`.
    """
    return _Layout(case).drawing()


class _Layout:
    def __init__(self, case: CaseData) -> None:
        self.case = case
        self.stations = {row.station: row for row in case.stations if row.station}
        self.elements = [
            row for row in case.elements
            if row.from_ in self.stations and row.to in self.stations and row.from_ != row.to
        ]  # fmt: skip
        self.ratios = case.speed_ratios
        self.motors = set(case.motor_stations)
        self.loads = {row.station for row in case.load_torque} | {
            row.station for row in case.stations if row.running_load
        }
        meshes = [row for row in self.elements if row.kind == ElementKind.GEAR_MESH]
        self.gears = {end for row in meshes for end in (row.from_, row.to)}
        coupled = [row for row in self.elements if row.kind == ElementKind.COUPLING]
        self.hubs = {end for row in coupled for end in (row.from_, row.to)}
        self.lines: list[_Line] = []
        self.line_of: dict[str, _Line] = {}
        self.meshes: list[tuple[ElementRow, _Line, _Line]] = []
        self._meshing: set[int] = set()

    # ---- what stands for what ------------------------------------------------------------------

    def kind(self, name: str) -> str:
        """``motor``, ``machine``, ``gear``, ``hub`` or ``disc``."""
        if name in self.motors:
            return "motor"
        if name in self.loads:
            return "machine"
        if name in self.gears:
            return "gear"
        if name in self.hubs:
            return "hub"
        largest = max((row.inertia or 0.0 for row in self._beside(name)), default=0.0)
        own = self.stations[name].inertia or 0.0
        return "machine" if own and own >= _MACHINE_INERTIA * largest else "disc"

    def _beside(self, name: str) -> Iterator[StationRow]:
        """Stations of the same speed."""
        ratio = self.ratios.get(name)
        return (row for key, row in self.stations.items() if self.ratios.get(key) == ratio)

    def _width(self, name: str) -> float:
        return {"motor": _MACHINE, "machine": _MACHINE, "gear": _GEAR, "hub": 0.0, "disc": _DISC}[
            self.kind(name)
        ]

    # ---- layout --------------------------------------------------------------------------------

    def drawing(self) -> Schematic:
        for name in sorted(self.stations, key=lambda one: one not in self.motors):
            if name not in self.line_of:
                right = max((line.right for line in self.lines), default=-_GAP)
                self._line(name, self._free_level(0, right + _GAP, right + _GAP), right + _GAP)
        if not self.lines:
            return Schematic(1.0)
        return self._placed()

    def _links(self, name: str) -> list[ElementRow]:
        return [row for row in self.elements if name in (row.from_, row.to)]

    def _line(self, first: str, level: int, left: float) -> None:
        """A shaft line from one of its stations to both ends, then the lines that mesh with it."""
        line = _Line(level, left)
        line.add(first, self._width(first))
        self.lines.append(line)
        self.line_of[first] = line
        used: set[str] = set()
        for before in (False, True):
            at = first
            while True:
                rest = [
                    row for row in self._links(at)
                    if row.kind != ElementKind.GEAR_MESH
                    and self._other(row, at) not in self.line_of
                    and row.element not in used
                ]  # fmt: skip
                if not rest:
                    break
                row = rest[0]
                at_next = self._other(row, at)
                used.add(str(row.element))
                length = _COUPLING if row.kind == ElementKind.COUPLING else _SHAFT
                line.add(at_next, self._width(at_next), str(row.element), length, before=before)
                self.line_of[at_next] = line
                at = at_next
        for station in list(line.stations):
            for row in self._links(station):
                if row.kind == ElementKind.GEAR_MESH:
                    self._mesh(row, station, line)
        for station in list(line.stations):  # further branches of this line
            for row in self._links(station):
                other = self._other(row, station)
                if row.kind != ElementKind.GEAR_MESH and other not in self.line_of:
                    self._line(other, self._free_level(level, line.left, line.right), line.left)

    def _mesh(self, row: ElementRow, station: str, line: _Line) -> None:
        other = self._other(row, station)
        if id(row) in self._meshing:
            return
        self._meshing.add(id(row))
        if other in self.line_of:
            if self.line_of[other] is not line:
                self.meshes.append((row, line, self.line_of[other]))
            return
        left = line.stations[station].left + 0.5 * (self._width(station) - self._width(other))
        level = self._free_level(line.level, left, left + 4.0 * _MACHINE)
        at = len(self.lines)
        self._line(other, level, left)
        self.meshes.append((row, line, self.lines[at]))

    def _free_level(self, near: int, left: float, right: float) -> int:
        """The nearest level at which nothing stands between two places: beside it, first below, then above."""
        steps = [near, *(near + sign * k for k in range(1, 99) for sign in (1, -1))]
        beside = steps[1:] if any(line.level == near for line in self.lines) else steps
        for level in beside:
            here = [line for line in self.lines if line.level == level]
            if all(right < line.left or left > line.right for line in here):
                return level
        return near + 99

    @staticmethod
    def _other(row: ElementRow, end: str) -> str:
        return str(row.to if row.from_ == end else row.from_)

    # ---- drawing -------------------------------------------------------------------------------

    def _placed(self) -> Schematic:
        levels = sorted({line.level for line in self.lines})
        pitch = 1.0 / len(levels)
        axis = {level: (k + 0.42) * pitch for k, level in enumerate(levels)}
        origin = min(line.left for line in self.lines)
        width = max(line.right for line in self.lines) - origin
        drawing = Schematic(width, pitch=pitch, not_drawn=self._not_drawn())
        machines: list[Machine] = []
        shafts: list[Shaft] = []
        couplings: list[Coupling] = []
        kinds = {row.element: row.kind for row in self.elements}
        for line in self.lines:
            y = axis[line.level]
            group = self._group(next(iter(line.stations)))
            for item in line.elements.values():
                left, right = item.left - origin, item.left - origin + item.width
                if kinds[item.name] == ElementKind.COUPLING:
                    half = _HUB_HALF * pitch
                    couplings.append(Coupling(item.name, left, right, y, half, group))
                else:
                    shafts.append(Shaft(left, right, y, group))
            for name, item in line.stations.items():
                if self.kind(name) in ("motor", "machine", "disc"):
                    machines.append(self._machine(name, item.left - origin, item.width, y, pitch))
        gears, notes = self._teeth(axis, origin)
        return _fitted(
            replace(
                drawing, machines=tuple(machines), shafts=tuple(shafts), couplings=tuple(couplings),
                gears=tuple(gears), notes=tuple(notes),
            )
        )  # fmt: skip

    def _not_drawn(self) -> tuple[str, ...]:
        """Elements that stand on no shaft line and are no mesh."""
        drawn = {name for line in self.lines for name in line.elements}
        drawn |= {str(row.element) for row, _, _ in self.meshes}
        return tuple(str(row.element) for row in self.elements if row.element not in drawn)

    def _machine(self, name: str, left: float, width: float, axis: float, pitch: float) -> Machine:
        kind = self.kind(name)
        if kind == "disc":
            return Machine("", "", left, width, axis, _DISC_HALF * pitch, self._group(name))
        half = _MACHINE_HALF * pitch
        words = self._words(name)
        return Machine(name, words, left, width, axis, half, self._group(name), kind == "motor")

    def _group(self, name: str) -> int:
        speeds = list(dict.fromkeys(self.ratios.values()))
        return speeds.index(self.ratios[name]) % GROUPS if name in self.ratios else 0

    def _words(self, name: str) -> str:
        """Rated power, where it is that of one motor, and speed."""
        words = []
        ratings = self.case.ratings
        if self.motors == {name} and ratings.rated_power:
            words.append(f"{1e-3 * ratings.rated_power:,.5g} kW")
        if name in self.ratios:
            if ratings.synchronous_speed:
                rpm = self.ratios[name] * ratings.synchronous_speed / _RPM
                words.append(f"{rpm:,.0f} rpm" if rpm >= 100.0 else f"{rpm:.4g} rpm")
            else:
                words.append(f"{self.ratios[name]:.5g} × motor speed")
        return ", ".join(words)

    def _teeth(
        self, axis: Mapping[int, float], origin: float
    ) -> tuple[Sequence[Gear], Sequence[Note]]:
        gears: dict[str, Gear] = {}
        notes = []
        rows = {row.element: row for row in self.case.meshes}
        for element, first, second in self.meshes:
            ends = [str(element.from_), str(element.to)]
            if ends[0] not in first.stations:
                first, second = second, first
            y, z = axis[first.level], axis[second.level]
            ratio = self.ratios.get(ends[1], 1.0) / (self.ratios.get(ends[0]) or 1.0)
            share = min(max(ratio / (1.0 + ratio), _LEAST_GEAR), 1.0 - _LEAST_GEAR)
            for name, line, half in (
                (ends[0], first, share * abs(z - y)), (ends[1], second, (1.0 - share) * abs(z - y)),
            ):  # fmt: skip
                item = line.stations[name]
                middle = item.left - origin + 0.5 * item.width
                made = Gear(middle - 0.5 * _GEAR, _GEAR, axis[line.level], half, self._group(name))
                if name not in gears or gears[name].half < half:
                    gears[name] = made
            item = first.stations[ends[0]]
            row = rows.get(element.element)
            words = f"{ratio:.5g} : 1" if ratio >= 1.0 else f"1 : {1.0 / ratio:.5g}"
            if row is not None and row.teeth_drive and row.teeth_driven:
                words += f" ({row.teeth_drive} / {row.teeth_driven} teeth)"
            left = item.left - origin + 0.5 * item.width + 0.6 * _GEAR
            notes.append(Note(words, left, 0.5 * (y + z)))
        return list(gears.values()), notes


#: Height of the words below machines and couplings. [distance between shaft lines, with one line]
_WORDS = 0.3


def _fitted(drawing: Schematic) -> Schematic:
    """The same drawing from edge to edge of its height, the words below machines and couplings included."""
    upright: list[Machine | Coupling | Gear] = [
        *drawing.machines,
        *drawing.couplings,
        *drawing.gears,
    ]
    if not upright:
        return drawing
    top = min(one.axis - one.half for one in upright)
    words = min(_WORDS, 0.5 * drawing.pitch)
    bottom = max(one.axis + one.half + (0.0 if isinstance(one, Gear) else words) for one in upright)
    scale = 1.0 / (bottom - top)

    def moved(one: Any) -> Any:
        half = {} if isinstance(one, Shaft | Note) else {"half": one.half * scale}
        return replace(one, axis=(one.axis - top) * scale, **half)

    lists = ("machines", "shafts", "couplings", "gears", "notes")
    fitted: dict[str, Any] = {name: tuple(map(moved, getattr(drawing, name))) for name in lists}
    return replace(drawing, pitch=drawing.pitch * scale, **fitted)
