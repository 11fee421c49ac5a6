"""Trains with clearances, integrated by scipy's DOP853 from the equations alone.

No code of the engine's is used. The state is the deflection of every row (spring, bearing, flank),
the speed of every freedom and the phase of the pulsation:

    x' = B w,   J w' = −Bᵀ F + motor + load,   phase' = 2 (ω_line − p w)

A spring has F = k x + c x'. A flank whose compression x is positive presses with k x + min(k x, c x')
(law ``limited``) or k x + c x' (``no adhesion``), and never pulls. Whenever one of these laws takes
over from another the moment is found on the dense output, and the integration begins anew.

Teeth are taken from the plane: with P the pitch point and O a gear's centre, its point at P moves by
u + φ ẑ × (P − O). A flank is compressed by what the driver's point is ahead of the driven one's along
its normal, which lies α_t off the common tangent and pushes the gears apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import DOP853
from scipy.interpolate import PchipInterpolator

from engine.case.data import GROUND, CaseData, MeshRow
from engine.model.load import NEAR_STANDSTILL, STANDSTILL_TIME, STANDSTILL_ZONE, WIDEST_ZONE
from tests.mean_speed import read_weights

#: What a flank does: nothing, spring and damper, spring force twice, or it is still compressed but
#: would pull.
FREE, PRESSES, LIMITED, RECOVERS = 0, 1, 2, 3
#: Places in a step at which the laws are looked at.
LOOKS = 8


@njit(cache=True)
def _force(law, k, c, x, rate):
    if law == FREE or law == RECOVERS:
        return 0.0
    return 2.0 * k * x if law == LIMITED else k * x + c * rate


@njit(cache=True)
def _rates(y, B, inertia, k, c, gap, flank, law, out):
    """Everything but motors and loads."""
    rows, n = B.shape
    force = np.zeros(n)
    for r in range(rows):
        rate = 0.0
        for i in range(n):
            rate += B[r, i] * y[rows + i]
        out[r] = rate
        if flank[r]:
            f = _force(law[r], k[r], c[r], y[r] - gap[r], rate)
        else:
            f = k[r] * y[r] + c[r] * rate
        for i in range(n):
            force[i] -= B[r, i] * f
    for i in range(n):
        out[rows + i] = force[i] / inertia[i]


@njit(cache=True)
def _laws(y, B, k, c, gap, flank, limited, out):
    """The law of every flank at a state."""
    rows, n = B.shape
    for r in range(rows):
        out[r] = FREE
        x = y[r] - gap[r]
        if not flank[r] or x < 0.0:
            continue
        rate = 0.0
        for i in range(n):
            rate += B[r, i] * y[rows + i]
        if k[r] * x + c[r] * rate < 0.0:
            out[r] = RECOVERS
        elif limited and c[r] * rate > k[r] * x:
            out[r] = LIMITED
        else:
            out[r] = PRESSES


@dataclass
class Truth:
    """What the reference found. Rows: see `ClearanceReference.names`."""

    time: np.ndarray
    state: np.ndarray
    force: np.ndarray
    events: list[tuple[float, int, int, int, float]]
    """Time, row, law before and after, rate of compression."""


class ClearanceReference:
    """A case as DOP853 sees it: no modal damping, no rigid mesh."""

    def __init__(
        self,
        case: CaseData,
        law: str = "limited",
        clearances: tuple[str, ...] | None = None,
        one_sided: bool = False,
    ) -> None:
        assert not case.damping_ratio
        self.case, self.limited = case, law == "limited"
        self.stations = [s.station for s in case.stations]
        self.ratio = np.array([s.speed_ratio or 1.0 for s in case.stations])
        self.inertia = [float(s.inertia or 0.0) for s in case.stations]
        self.names: list[tuple[str, str]] = []  # element or station, kind of row
        self.scale: list[float] = []  # torque on the From side over row force
        self._rows: list[tuple[dict[int, float], float, float, float, bool]] = []
        self._bodies: dict[str, tuple[int, int]] = {}
        meshes = {m.element: m for m in case.meshes}
        self._sense = self._senses()
        for m in case.meshes:
            e = next(e for e in case.elements if e.element == m.element)
            if e.kind == "gear mesh":
                self._body(
                    e.from_, m.mass_drive, m.bearing_stiffness_drive, m.bearing_damping_drive
                )
                self._body(
                    e.to, m.mass_driven, m.bearing_stiffness_driven, m.bearing_damping_driven
                )
        for s in case.stations:
            if s.damping:
                i = self.stations.index(s.station)
                self._add(str(s.station), "damper", {i: 1.0}, 0.0, s.damping)
        for e in case.elements:
            mesh = meshes.get(e.element)
            parts = clearances is None or e.element in clearances
            if e.kind == "gear mesh" and mesh is not None and mesh.pitch_radius_drive:
                self._mesh(e, mesh, parts, one_sided)
                continue
            ends, facing = {}, 1.0 if self._drives_from(e) else -1.0
            if e.from_ != GROUND:
                ends[self.stations.index(e.from_)] = facing
            if e.to != GROUND:
                turn = 1.0 if e.from_ == GROUND else self._turn(e)
                ends[self.stations.index(e.to)] = -facing * turn
            k, c = float(e.stiffness or 0.0), float(e.damping or 0.0)
            gap = mesh.angular_backlash if mesh is not None and parts else None
            name = str(e.element)
            if not gap:
                self._add(name, "spring", ends, k, c)
                continue
            self._add(name, "drive", ends, k, c, 0.0)
            if not one_sided:
                self._add(name, "back", {i: -x for i, x in ends.items()}, k, c, gap, -1.0)
        self.B = np.zeros((len(self._rows), len(self.inertia)))
        for r, (entries, *_) in enumerate(self._rows):
            for i, x in entries.items():
                self.B[r, i] = x
        _, k, c, gap, flank = zip(*self._rows, strict=True)
        self.k, self.c, self.gap = np.array(k), np.array(c), np.array(gap)
        self.flank = np.array(flank)
        self.J = np.array(self.inertia)
        self._drives()

    def _turn(self, e: Any) -> float:
        a, b = (self.ratio[self.stations.index(n)] for n in (e.from_, e.to))
        return float(a / b)

    def _add(
        self, name: str, kind: str, entries: dict[int, float], k: float, c: float,
        gap: float | None = None, scale: float = 1.0,
    ) -> None:  # fmt: skip
        self.names.append((name, kind))
        self.scale.append(scale)
        self._rows.append((entries, k, c, gap or 0.0, gap is not None))

    def _body(
        self, name: str, mass: float | None, stiffness: float | None, damping: float | None
    ) -> None:
        if mass is None or name in self._bodies:
            return
        x = len(self.inertia)
        self.inertia += [mass, mass]
        self._bodies[name] = (x, x + 1)
        for i, kind in ((x, "bearing x"), (x + 1, "bearing y")):
            self._add(name, kind, {i: 1.0}, float(stiffness or 0.0), float(damping or 0.0))

    def _senses(self) -> np.ndarray:
        """+1 where a station turns counter-clockwise: the motor does."""
        sense = np.zeros(len(self.stations))
        names = [m.station for m in self.case.motor_torque] or [self.stations[0]]
        sense[self.stations.index(names[0])] = 1.0
        for _ in self.stations:
            for e in self.case.elements:
                if GROUND in (e.from_, e.to):
                    continue
                a, b = self.stations.index(e.from_), self.stations.index(e.to)
                other = -1.0 if e.kind == "gear mesh" else 1.0
                sense[a] = sense[a] or other * sense[b]
                sense[b] = sense[b] or other * sense[a]
        return sense

    def _drives_from(self, e: Any) -> bool:
        """Whether the motor stands on the From side."""
        near, beyond = {e.from_}, True
        while beyond:
            beyond = False
            for other in self.case.elements:
                ends = {other.from_, other.to}
                if other is not e and ends & near and not ends <= near:
                    near |= ends
                    beyond = True
        names = [m.station for m in self.case.motor_torque] or [e.from_]
        return names[0] in near

    def _mesh(self, e: Any, mesh: MeshRow, parts: bool, one_sided: bool) -> None:
        """Both flanks, as lengths along the line of action of the transverse plane."""
        normal = math.radians(20.0) if mesh.pressure_angle is None else mesh.pressure_angle
        helix = mesh.helix_angle or 0.0
        alpha = math.atan(math.tan(normal) / math.cos(helix))
        cos_base = math.cos(math.asin(math.sin(helix) * math.cos(normal)))
        r1 = float(mesh.pitch_radius_drive)
        i, j = self.stations.index(e.from_), self.stations.index(e.to)
        r2 = r1 * self.ratio[i] / self.ratio[j]
        line = np.array([math.cos(mesh.orientation or 0.0), math.sin(mesh.orientation or 0.0)])
        ahead = (i, 1.0, r1 * line, j, -1.0, -r2 * line)  # point − centre, of From and of To
        driver, driven, apart = (ahead[:3], ahead[3:], line)
        if not self._drives_from(e):
            driver, driven, apart = (ahead[3:], ahead[:3], -line)
        moves = self._sense[driver[0]] * np.array([-driver[2][1], driver[2][0]])
        tangent = moves / np.linalg.norm(moves)
        k = mesh.mesh_stiffness * cos_base**2 if mesh.mesh_stiffness else None
        base = r1 * math.cos(alpha)
        k = float(e.stiffness) / base**2 if k is None else k
        c = float(e.damping or 0.0) / base**2
        if mesh.mesh_damping:
            c = mesh.mesh_damping * cos_base**2
        gap = mesh.backlash / cos_base if mesh.backlash and parts else None
        sides = [("drive", 1.0, 0.0), ("back", -1.0, gap)]
        for kind, way, away in sides if gap and not one_sided else sides[:1]:
            n = way * math.cos(alpha) * tangent + math.sin(alpha) * apart
            entries: dict[int, float] = {}
            for (s, _, p), sign in ((driver, 1.0), (driven, -1.0)):
                lever = n[1] * p[0] - n[0] * p[1]
                entries[s] = sign * lever * self._sense[s]
                if self.stations[s] in self._bodies:
                    x, y = self._bodies[self.stations[s]]
                    entries[x], entries[y] = sign * n[0], sign * n[1]
            name = str(e.element)
            if gap is None:
                self._add(name, "spring", entries, k, c, None, base)
            else:
                self._add(name, kind, entries, k, c, away, way * base)

    def _drives(self) -> None:
        c = self.case
        voltage = (1.0 if c.voltage is None else c.voltage) ** 2
        ratings = c.ratings if hasattr(c, "ratings") else None
        synchronous = ratings.synchronous_speed if ratings else None
        self.line = 2.0 * math.pi * (ratings.line_frequency or 0.0) if ratings else 0.0
        self.motors, self.loads, self.read = [], [], []
        turning = np.concatenate([self.ratio, np.zeros(len(self.J) - len(self.ratio))])
        for name in dict.fromkeys(r.station for r in c.motor_torque):
            rows = [r for r in c.motor_torque if r.station == name]
            i = self.stations.index(name)
            x = [r.speed for r in rows]
            self.motors.append(
                (
                    i,
                    PchipInterpolator(x, [voltage * r.average for r in rows]),
                    PchipInterpolator(x, [voltage * r.pulsating for r in rows]),
                    synchronous * self.ratio[i],
                )
            )
            self.read.append(read_weights(c, self.B, self.k, self.J, turning, i))
        for name in dict.fromkeys(r.station for r in c.load_torque):
            rows = [r for r in c.load_torque if r.station == name]
            i = self.stations.index(name)
            curve = PchipInterpolator([r.speed for r in rows], [r.torque for r in rows])
            ends = rows[0].speed, rows[-1].speed
            full = synchronous * self.ratio[i]
            sticking = max(curve(np.clip(np.linspace(0.0, NEAR_STANDSTILL, 11), *ends)))
            soft = max(STANDSTILL_ZONE * full, STANDSTILL_TIME * sticking / self.J[i])
            self.loads.append((i, curve, full, min(soft, WIDEST_ZONE * full), ends))

    def drive(self, t: float, y: np.ndarray) -> np.ndarray:
        """Torque of motors and loads on every freedom."""
        rows, n = self.B.shape
        force = np.zeros(n)
        for m, (i, average, pulsating, full) in enumerate(self.motors):
            speed = float(self.read[m] @ y[rows : rows + n])
            x = min(max(speed / full, average.x[0]), average.x[-1])
            force[i] += float(average(x)) + float(pulsating(x)) * math.sin(y[rows + n + m])
        for i, torque, full, soft, ends in self.loads:
            w = y[rows + i]
            z = min(max(w / soft, -1.0), 1.0)
            at = min(max(abs(w) / full, ends[0]), ends[1])
            force[i] -= float(torque(at)) * z * (1.5 - 0.5 * z * z)
        return force

    def run(
        self,
        times: np.ndarray,
        *,
        angle: np.ndarray | None = None,
        speed: np.ndarray | None = None,
        torque: Any = None,
        rtol: float = 1e-11,
        max_step: float = math.inf,
        target: float | None = None,
    ) -> Truth:
        """From the first to the last of the times; `torque(t)` acts on the stations beside."""
        rows, n = self.B.shape
        y = np.zeros(rows + n + len(self.motors))
        if angle is not None:
            y[:rows] = self.B[:, : len(angle)] @ angle
        if speed is not None:
            y[rows : rows + len(speed)] = speed
        y[rows + n :] = self.case.pulsation_phase or 0.0 if self.motors else 0.0
        law, new = np.zeros(rows, np.int64), np.zeros(rows, np.int64)
        args = (self.B, self.k, self.c, self.gap, self.flank)
        _laws(y, *args, self.limited, law)

        def rates(t: float, y: np.ndarray) -> np.ndarray:
            out = np.empty(len(y))
            _rates(y, self.B, self.J, self.k, self.c, self.gap, self.flank, law, out)
            if self.motors or self.loads:
                out[rows : rows + n] += self.drive(t, y) / self.J
            if torque is not None:
                given = torque(t)
                out[rows : rows + len(given)] += given / self.J[: len(given)]
            for m, (i, *_, full) in enumerate(self.motors):
                out[rows + n + m] = 2.0 * self.line * (1.0 - y[rows + i] / full)
            return out

        size = max([1e-3, *np.abs(y[rows : rows + n])])
        atol = np.concatenate(
            [np.full(rows, 1e-14), np.full(n, 1e-13 * size + 1e-11), y[rows + n :] * 0 + 1e-11]
        )
        kept = np.empty((len(y), len(times)))
        events: list[tuple[float, int, int, int, float]] = []
        self.extreme = np.zeros((rows, 2))
        t, end, place = float(times[0]), float(times[-1]), 0
        kept[:, 0] = y
        place = 1
        while t < end:
            solver = DOP853(rates, t, y, end, rtol=rtol, atol=atol, max_step=max_step)
            while solver.status == "running":
                solver.step()
                dense = solver.dense_output()
                h = solver.t - solver.t_old
                stop = None
                for s in np.linspace(0.0, 1.0, LOOKS + 1)[1:]:
                    at = dense(solver.t_old + s * h) if s < 1.0 else solver.y
                    _laws(at, *args, self.limited, new)
                    if np.any(new != law):
                        stop = self._moment(
                            dense, solver.t_old + (s - 1.0 / LOOKS) * h, solver.t_old + s * h, law
                        )
                        break
                    self._extremes(at, law)
                last = solver.t if stop is None else stop
                while place < len(times) and times[place] <= last + 1e-15:
                    kept[:, place] = dense(times[place])
                    place += 1
                if stop is not None:
                    break
            t = solver.t if stop is None else stop
            y = solver.y.copy() if stop is None else dense(stop)
            if stop is not None:
                self._extremes(y, law)
                _laws(y, *args, self.limited, new)
                for r in np.flatnonzero(new != law):
                    rate = float(self.B[r] @ y[rows : rows + n])
                    events.append((t, int(r), int(law[r]), int(new[r]), rate))
                law[:] = new
                self._extremes(y, law)
            if target is not None:
                break
        return Truth(times, kept, self._forces(kept), events)

    def _moment(self, dense: Any, low: float, high: float, law: np.ndarray) -> float:
        """The first moment at which another law holds, by bisection on the dense output."""
        new = np.empty_like(law)
        for _ in range(60):
            middle = 0.5 * (low + high)
            _laws(dense(middle), self.B, self.k, self.c, self.gap, self.flank, self.limited, new)
            if np.any(new != law):
                high = middle
            else:
                low = middle
        return high

    def _extremes(self, y: np.ndarray, law: np.ndarray) -> None:
        rows, n = self.B.shape
        rate = self.B @ y[rows : rows + n]
        for r in range(rows):
            f = self.k[r] * y[r]  # the engine's torque of a shaft is that of its spring
            if self.flank[r]:
                f = _force(law[r], self.k[r], self.c[r], y[r] - self.gap[r], rate[r])
            self.extreme[r, 0] = max(self.extreme[r, 0], f)
            self.extreme[r, 1] = min(self.extreme[r, 1], f)

    def _forces(self, state: np.ndarray) -> np.ndarray:
        """Force of every row at the samples."""
        rows, n = self.B.shape
        out = np.empty((rows, state.shape[1]))
        law = np.zeros(rows, np.int64)
        for j in range(state.shape[1]):
            y = state[:, j]
            _laws(y, self.B, self.k, self.c, self.gap, self.flank, self.limited, law)
            rate = self.B @ y[rows : rows + n]
            for r in range(rows):
                f = self.k[r] * y[r] + self.c[r] * rate[r]
                if self.flank[r]:
                    f = _force(law[r], self.k[r], self.c[r], y[r] - self.gap[r], rate[r])
                out[r, j] = f
        return out

    def torque(self, truth: Truth, element: str) -> np.ndarray:
        """Torque of an element on its From side, positive where the drive flank presses."""
        total = np.zeros(truth.force.shape[1])
        for r, (name, kind) in enumerate(self.names):
            if name == element and kind in ("spring", "drive", "back"):
                total += self.scale[r] * truth.force[r]
        return total

    def peaks(self, element: str) -> tuple[float, float]:
        """Largest and least torque of an element since the beginning of the last run."""
        high = low = 0.0
        for r, (name, kind) in enumerate(self.names):
            if name == element and kind in ("spring", "drive", "back"):
                found = sorted(self.scale[r] * self.extreme[r])
                low, high = min(low, found[0]), max(high, found[1])
        return high, low
