"""Rows and nodes while a train is put together."""

from __future__ import annotations

from dataclasses import dataclass

from engine.arrays import Floats
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData, ElementRow
from engine.model.links import Link
from engine.model.train import NO_ELEMENT, GearBody, ShaftEnd
from engine.numerics.same_bits import atan2

#: Element, stiffness, viscous damping, loss factor, entries by node.
Row = tuple[int, float, float, float, dict[int, float]]


class Assembly:
    """Rows and nodes while a train is put together."""

    def __init__(self, case: CaseData) -> None:
        self.index = {s.station: i for i, s in enumerate(case.stations)}
        self.inertia = [s.inertia or 0.0 for s in case.stations]
        self.damping = [s.damping or 0.0 for s in case.stations]
        self.ratio = list(case.speed_ratios.values())
        self.rows: list[Row] = []
        self.edges: list[tuple[int, int, int]] = []  # element, node, node (stations only)
        self.rigid: list[tuple[int, int, int]] = []
        self.ends: list[ShaftEnd] = []

    def add(self, element: int, e: ElementRow, link: Link, segments: int) -> None:
        """Add one element as one row, or in about `segments` rows in series if it has inertia."""
        ends = [self.index[n] for n in (e.from_, e.to) if n not in (None, GROUND)]
        if len(ends) == 2:
            self.edges.append((element, ends[0], ends[1]))
        if link.stiffness is None:
            self.rigid.append((element, ends[0], ends[1]))
            return
        if e.kind == ElementKind.GEAR_MESH:
            back = self.ratio[ends[0]] / self.ratio[ends[1]]
            self._row(element, link, 1.0, {ends[0]: 1.0, ends[1]: -back})
            return
        from_ground = e.from_ == GROUND
        chain: list[int | None] = [None] if from_ground else []
        chain += ends if len(ends) == 2 or from_ground else [ends[0], None]
        self._series(element, link, _pieces(link, segments), chain)

    def _series(
        self, element: int, link: Link, pieces: list[tuple[float, float]], chain: list[int | None]
    ) -> None:
        """Pieces in series: how many times stiffer each is than the whole, and the inertia at each of its ends."""
        start, end = chain
        ratio = self.ratio[next(n for n in chain if n is not None)]
        nodes: list[int | None] = [start]
        for _ in pieces[1:]:
            nodes.append(len(self.inertia))
            self.inertia.append(0.0)
            self.damping.append(0.0)
            self.ratio.append(ratio)
        nodes.append(end)
        first = len(self.rows)
        for (stiffer, half), a, b in zip(pieces, nodes[:-1], nodes[1:], strict=True):
            entries = {n: sign for n, sign in ((a, 1.0), (b, -1.0)) if n is not None}
            self._row(element, link, stiffer, entries)
            for n in entries:
                self.inertia[n] += half
        ends = ((first, start, pieces[0][1]), (len(self.rows) - 1, end, -pieces[-1][1]))
        for row, node, inertia in ends:
            if inertia != 0.0 and node is not None:
                self.ends.append(ShaftEnd(element, row, node, inertia))

    def _row(self, element: int, link: Link, stiffer: float, entries: dict[int, float]) -> None:
        assert link.stiffness is not None
        self.rows.append(
            (element, link.stiffness * stiffer, link.viscous * stiffer, link.loss_factor, entries)
        )

    def body(self, station: int, data: BodyData, axis: Floats) -> GearBody:
        """Add the transverse nodes of a gear and the rows of its bearing."""
        x, row = len(self.inertia), len(self.rows)
        for node in (x, x + 1):
            self.inertia.append(data.mass)
            self.damping.append(0.0)
            self.ratio.append(0.0)
            self.rows.append((NO_ELEMENT, data.stiffness, data.damping, 0.0, {node: 1.0}))
        angle = atan2(float(axis[1]), float(axis[0]))
        return GearBody(
            station, x, x + 1, row, row + 1, data.mass, data.stiffness, data.damping, angle
        )


def _pieces(link: Link, segments: int) -> list[tuple[float, float]]:
    """Pieces of an element as `_series` takes them; one where it has no inertia."""
    profile = link.profile
    if not link.inertia or not link.stiffness:
        return [(1.0, 0.5 * link.inertia)]
    finer = max(1, segments // sum(profile.pieces))
    counts = [finer * n for n in profile.pieces]
    return [
        (n / twist, 0.5 * link.inertia * inertia / n)
        for (twist, inertia), n in zip(profile.parts, counts, strict=True)
        for _ in range(n)
    ]


@dataclass(frozen=True)
class BodyData:
    """What the Meshes table says of one gear body, in any of its rows."""

    mass: float  #: Mass of the gear body. [kg]
    stiffness: float  #: Bearing stiffness. [N/m]
    damping: float  #: Bearing damping. [N s/m]
