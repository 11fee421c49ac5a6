"""How the stations are joined: rigid groups, driven sides, senses of rotation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.case.data import CaseData
from engine.model.assembly import Assembly
from engine.model.train import RigidMesh


def drive_ends(case: CaseData, a: Assembly) -> tuple[Floats, Mask, int]:
    """Orientation of each element, its driven side, and a station of the reference shaft."""
    sides = driven_side(tuple(a.edges), len(case.stations), len(case.elements))
    motors = sorted({a.index[name] for name in case.motor_stations if name in a.index})
    drivers = motors or _drivers(case, a)  # without either, From is the drive end
    orientation = np.ones(len(case.elements))
    if drivers:
        reversed_ = sides[:, drivers].all(axis=1)
        orientation[reversed_] = -1.0
        sides[reversed_] = ~sides[reversed_]
    return orientation, sides, motors[0] if motors else 0


def _drivers(case: CaseData, a: Assembly) -> list[int]:
    """Stations whose prescribed torque drives, on the average of its rows."""
    total: dict[int, float] = {}
    for p in case.torque_time_from_rest:
        if p.station in a.index:
            station = a.index[p.station]
            total[station] = total.get(station, 0.0) + float(p.torque or 0.0)
    return sorted(station for station, torque in total.items() if torque > 0.0)


@lru_cache(maxsize=16)
def group_heads(count: int, pairs: tuple[tuple[int, int], ...]) -> tuple[int, ...]:
    """Groups of numbers that pairs join. All trains of a study share them.

    Parameters
    ----------
    count : int
        How many numbers, from 0 on. [count]
    pairs : tuple of (int, int)
        Two of one group each. [indices]

    Returns
    -------
    tuple of int
        The least number of the group of each. [indices]
    """
    head = list(range(count))

    def find(number: int) -> int:
        while head[number] != number:
            head[number] = head[head[number]]
            number = head[number]
        return number

    for a, b in pairs:
        first, second = sorted((find(a), find(b)))
        head[second] = first
    return tuple(find(number) for number in range(count))


def merge_rigid(rigid: list[tuple[int, int, int]], ratio: list[float]) -> tuple[Ints, Floats, int]:
    """Degree of freedom and scale of every node after merging rigid meshes.

    Parameters
    ----------
    rigid : list of (int, int, int)
        Element, From and To station of each rigid mesh. [indices]
    ratio : list of float
        Speed ratio of each node. [1]

    Returns
    -------
    dof : ndarray of int, shape (n_nodes,)
        Degree of freedom of each node. [indices]
    scale : ndarray, shape (n_nodes,)
        Angle of the node over that of its degree of freedom. [1]
    n_dof : int
        Number of degrees of freedom. [count]
    """
    heads = group_heads(len(ratio), tuple((a, b) for _, a, b in rigid))
    number: dict[int, int] = {}
    dof = np.array([number.setdefault(h, len(number)) for h in heads], dtype=np.int64)
    scale = np.array([ratio[n] / ratio[h] if n != h else 1.0 for n, h in enumerate(heads)])
    return dof, scale, len(number)


def rigid_meshes(rigid: list[tuple[int, int, int]], ratio: Floats) -> tuple[RigidMesh, ...]:
    """Each rigid mesh with the nodes of its group on its To side.

    Parameters
    ----------
    rigid : list of (int, int, int)
        Element, From and To station of each rigid mesh. [indices]
    ratio : ndarray, shape (n_nodes,)
        Speed ratio of each node. [1]

    Returns
    -------
    tuple of RigidMesh
        One a rigid mesh. [indices]
    """
    if not rigid:
        return ()
    most = 1 + max(element for element, _, _ in rigid)
    sides = driven_side(tuple(rigid), len(ratio), most)
    return tuple(
        RigidMesh(element, tuple(np.flatnonzero(sides[element]).tolist()), float(ratio[a]))
        for element, a, _ in rigid
    )


def _neighbours(edges: Sequence[tuple[int, int, int]], n: int) -> list[list[tuple[int, int]]]:
    """For each station its (element, station) neighbours."""
    near: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for element, a, b in edges:
        near[a].append((element, b))
        near[b].append((element, a))
    return near


def driven_side(edges: tuple[tuple[int, int, int], ...], n: int, n_elements: int) -> Mask:
    """Stations on the To side of each element (none for an element to ground).

    In an open train every element separates the stations beyond it: a contiguous stretch of
    the order in which a depth-first walk enters them.

    Parameters
    ----------
    edges : tuple of (int, int, int)
        Element and its two stations. [indices]
    n, n_elements : int
        Number of stations and of elements. [count]

    Returns
    -------
    ndarray of bool, shape (n_elements, n_stations)
        True on the To side. [mask]
    """
    walk = _walk(edges, n)
    start, size = walk.start, walk.size
    side = np.zeros((n_elements, n), dtype=np.bool_)
    place = np.array(walk.order, dtype=np.int64)
    for element, a, b in edges:
        if walk.parent[b] == a:
            side[element, place[start[b] : start[b] + size[b]]] = True
        else:
            low, high = walk.whole[b]
            side[element, place[low:high]] = True
            side[element, place[start[a] : start[a] + size[a]]] = False
    return side


class _Walk(NamedTuple):
    """Stations in the order in which a depth-first walk enters them; the rest is by station."""

    order: list[int]
    parent: list[int]  # from which it was entered; −1: a root
    start: list[int]  # place in the order
    size: list[int]  # stations entered through it, itself included
    whole: list[tuple[int, int]]  # stretch of the order that is its whole train


@lru_cache(maxsize=16)
def _walk(edges: tuple[tuple[int, int, int], ...], n: int) -> _Walk:
    """All trains of a study share it."""
    near = _neighbours(edges, n)
    order: list[int] = []
    parent, start = [-1] * n, [0] * n
    size, whole = [1] * n, [(0, 0)] * n
    entered = [False] * n
    for root in range(n):
        if entered[root]:
            continue
        first, stack = len(order), [(root, -1)]
        while stack:
            node, up = stack.pop()
            if entered[node]:
                continue
            entered[node] = True
            parent[node], start[node] = up, len(order)
            order.append(node)
            stack.extend((other, node) for _, other in near[node] if not entered[other])
        for node in order[:first:-1]:
            size[parent[node]] += size[node]
        for node in order[first:]:
            whole[node] = (first, len(order))
    return _Walk(order, parent, start, size, whole)


def senses_of_rotation(a: Assembly, n: int, reference: int, flips: Mapping[int, bool]) -> Floats:
    """Physical direction of rotation of every node; external meshes reverse it.

    Parameters
    ----------
    a : Assembly
        Its edges. [indices]
    n : int
        Number of stations. [count]
    reference : int
        A station of the reference shaft. [index]
    flips : mapping of int to bool
        Whether an element reverses the rotation. [flags]

    Returns
    -------
    ndarray, shape (n_nodes,)
        +1 or −1. [1]
    """
    near = _neighbours(a.edges, n)
    sense = np.zeros(len(a.ratio))
    sense[reference] = 1.0
    stack = [reference]
    while stack:
        node = stack.pop()
        for element, other in near[node]:
            if sense[other] == 0.0:
                sense[other] = -sense[node] if flips[element] else sense[node]
                stack.append(other)
    if len(a.ratio) > n:
        for _, _, _, _, entries in a.rows:  # inner nodes turn with the shaft they divide
            turning = [node for node in entries if sense[node] != 0.0]
            for node in entries:
                if sense[node] == 0.0 and turning:
                    sense[node] = sense[turning[0]]
    sense[sense == 0.0] = 1.0
    return sense
