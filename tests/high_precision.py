"""Natural frequencies proven by counting, in 120-digit arithmetic and independently of the engine.

Everything is referred to the reference shaft the textbook way (J n², k n², Thomson § 12.10), rigid
meshes are merged, and the tree that is left is eliminated from its leaves inward: the number of
negative pivots of K − ω² M is the number of natural frequencies below ω (Sylvester's law of
inertia; Sturm sequence of a chain). A claimed i-th frequency is right to δ if at most i − 1
frequencies lie below ω (1 − δ) and at least i below ω (1 + δ): no eigenvalue solver is trusted.
"""

from __future__ import annotations

from collections.abc import Sequence

import mpmath
import numpy as np

from engine.case.data import GROUND, CaseData

#: A context of its own: nobody else's working precision can leak in.
MP = mpmath.mp.clone()
MP.dps = 120


class ReferredTree:
    """Masses and springs of a case without closed circuits, all at the reference speed."""

    def __init__(self, case: CaseData) -> None:
        ratio = {s.station: MP.mpf(s.speed_ratio or 1.0) for s in case.stations}
        body = {s.station: s.station for s in case.stations}

        def head(name: str | None) -> str | None:
            while body[name] != name:
                name = body[name]
            return name

        for e in case.elements:
            if e.kind == "gear mesh" and e.stiffness is None:
                body[head(e.to)] = head(e.from_)
        names = [s.station for s in case.stations if head(s.station) == s.station]
        index = {s.station: names.index(head(s.station)) for s in case.stations}
        self.mass = [MP.mpf(0)] * len(names)
        self.ground = [MP.mpf(0)] * len(names)
        for s in case.stations:
            self.mass[index[s.station]] += MP.mpf(s.inertia) * ratio[s.station] ** 2
        self.near: list[dict[int, MP.mpf]] = [{} for _ in names]
        for e in case.elements:
            if e.stiffness is None:
                continue
            ends = [n for n in (e.from_, e.to) if n not in (None, GROUND)]
            k = MP.mpf(e.stiffness) * ratio[ends[0]] ** 2
            if len(ends) == 1:
                self.ground[index[ends[0]]] += k
                continue
            a, b = (index[n] for n in ends)
            self.near[a][b] = self.near[a].get(b, MP.mpf(0)) + k
            self.near[b][a] = self.near[a][b]
        self._order()

    def _order(self) -> None:
        """Every node after all nodes that hang on it, with its parent."""
        n = len(self.mass)
        parent, seen, order = [-1] * n, [False] * n, []
        for root in range(n):
            if seen[root]:
                continue
            seen[root] = True
            stack = [root]
            while stack:
                node = stack.pop()
                order.append(node)
                for other in self.near[node]:
                    if not seen[other]:
                        seen[other] = True
                        parent[other] = node
                        stack.append(other)
        self.parent, self.order = parent, order[::-1]
        self.total = [
            g + sum(near.values()) for g, near in zip(self.ground, self.near, strict=True)
        ]

    def count_below(self, omega: MP.mpf) -> int:
        """Number of natural frequencies below `omega` [rad/s]."""
        square = omega * omega
        pivot = [t - square * m for t, m in zip(self.total, self.mass, strict=True)]
        below = 0
        for node in self.order:
            below += pivot[node] < 0
            parent = self.parent[node]
            if parent >= 0:
                pivot[parent] -= self.near[node][parent] ** 2 / pivot[node]
        return below

    def wrong(self, omega: Sequence[float], tolerance: float) -> list[int]:
        """Indices of the claimed frequencies (rising, rigid ones first) not right to `tolerance`."""
        delta = MP.mpf(tolerance)
        found = []
        for i, w in enumerate(omega):
            if w == 0.0:
                if self.count_below(MP.mpf(10) ** -20) <= i:
                    found.append(i)
                continue
            low = self.count_below(MP.mpf(float(w)) * (1 - delta))
            high = self.count_below(MP.mpf(float(w)) * (1 + delta))
            if not low <= i < high:
                found.append(i)
        return found

    def largest_error(self, omega: Sequence[float]) -> float:
        """Smallest of 1e-16, 1e-15, … that every claimed frequency keeps."""
        suspects = np.asarray(omega)
        index = list(range(len(suspects)))
        for exponent in range(-16, 3):
            delta = MP.mpf(10) ** exponent
            left = []
            for i in index:
                w = MP.mpf(float(suspects[i]))
                if w == 0:
                    continue
                if not self.count_below(w * (1 - delta)) <= i < self.count_below(w * (1 + delta)):
                    left.append(i)
            index = left
            if not index:
                return 10.0**exponent
        return float("inf")
