"""A motor and its train integrated by scipy's DOP853 in angles, speeds and fluxes, without modes.

An element with a clearance is a spring of each flank, without damping: its torque is continuous, and where it bends the
steps become as short as the tolerance wants.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import block_diag

from engine.backlash.operating_events import operating_events
from engine.case.case import Case
from engine.case.choices import Clearing
from engine.case.choices import MotorEventKind as Kind
from engine.case.data import (
    ElementRow,
    MeshRow,
    MotorCircuitRow,
    MotorDataRow,
    MotorEventRow,
    StationRow,
)
from engine.model.modal_analysis import analyse
from engine.stepping.linear_loop import turning_points

LENGTH = 0.2
#: Name of the motor's torque among those of elements.
AIR_GAP = "air gap"
KINDS = (
    Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT, Kind.OUT_OF_PHASE_CLOSING, Kind.VOLTAGE_DIP,
    Kind.VOLTAGE_UNBALANCE,
)  # fmt: skip


def random_case(seed: int) -> Case:
    """A machine of Xd'' 0.1 to 0.35, H 0.5 to 8 s, 2 to 40 poles, on a chain of two to five discs, in an event."""
    rng = np.random.default_rng(seed)
    line = float(rng.choice([50.0, 60.0, 16.7]))
    poles = 2 * int(rng.integers(1, 21))
    speed = 4.0 * math.pi * line / poles
    power = 10.0 ** rng.uniform(5.0, 7.5)
    base = power / speed
    n = int(rng.integers(2, 6))
    whole = 2.0 * 10.0 ** rng.uniform(math.log10(0.5), math.log10(8.0)) * power / speed**2
    share = 10.0 ** rng.uniform(-1.5, 0.0, n)
    inertia = whole * share / share.sum()
    # elements alone between their two discs at 8 to 150 Hz
    between = 1.0 / (1.0 / inertia[1:] + 1.0 / inertia[:-1])
    own = 2.0 * math.pi * 10.0 ** rng.uniform(math.log10(8.0), math.log10(150.0), n - 1)
    stiffness = between * own**2
    damping = 2.0 * rng.uniform(0.0, 0.03, n - 1) * between * own
    subtransient = rng.uniform(0.1, 0.35)
    leakage = rng.uniform(0.4, 0.8) * subtransient
    xmd, inner = rng.uniform(0.7, 1.8), subtransient - leakage
    xmq = xmd * rng.uniform(0.45, 1.0)
    xlf = inner * rng.uniform(1.5, 4.0)
    xlkd = 1.0 / (1.0 / inner - 1.0 / xmd - 1.0 / xlf)
    xlkq = min(xlkd * rng.uniform(0.7, 2.0), 2.0)  # what a data sheet may have
    circuit = MotorCircuitRow(
        "M0", rng.uniform(0.002, 0.03), leakage, xmd, xmq, 10.0 ** rng.uniform(-3.4, -2.5), xlf,
        10.0 ** rng.uniform(-2.0, -1.0), xlkd, 10.0 ** rng.uniform(-2.0, -1.0), xlkq,
    )  # fmt: skip
    kind = KINDS[seed % len(KINDS)]
    event = MotorEventRow(
        "event", "M0", kind,
        phase=rng.uniform(-3.0, 3.0) if kind in (Kind.LINE_TO_LINE_FAULT, Kind.VOLTAGE_UNBALANCE) else None,
        angle=rng.uniform(-3.0, 3.0) if kind == Kind.OUT_OF_PHASE_CLOSING else None,
        residual_voltage=None if "fault" in kind else rng.uniform(0.3, 0.95),
        clears_after=None if kind == Kind.OUT_OF_PHASE_CLOSING else rng.uniform(0.02, 0.15),
    )  # fmt: skip
    return Case(
        line_frequency=line, poles=poles, rated_torque=base, maximum_time=LENGTH,
        stations=tuple(
            StationRow(f"M{i}", None, float(inertia[i]), running_load=0.8 * base if i == n - 1 else None)
            for i in range(n)
        ),
        elements=tuple(
            ElementRow(f"E{i}", "shaft", f"M{i}", f"M{i + 1}", float(stiffness[i]), damping=float(damping[i]))
            for i in range(n - 1)
        ),
        motor_data=(MotorDataRow("M0", apparent_power=power, power_factor=rng.uniform(0.8, 1.0)),),
        motor_circuit=(circuit,), motor_events=(event,),
    )  # fmt: skip


def varied_case(seed: int) -> Case:
    """The same with one of four rotors: laminated or solid poles, with or without a field.

    Solid poles are a second damper of each axis, every other one with a leakage that field and dampers have in common.
    Xd'' is that of `random_case`.
    """
    case, rng = random_case(seed), np.random.default_rng(50_000 + seed)
    c = case.motor_circuit[0]
    solid, field = seed % 2 == 1, seed % 4 < 2
    beside = 1.0 / (1.0 / c.xlf + 1.0 / c.xlkd)  # field and dampers together
    xc = rng.uniform(0.1, 0.4) * beside if solid and seed % 8 > 3 else 0.0
    shares = rng.uniform(0.5, 1.0, field + 1 + solid)
    xlf, xlkd, xlkd_2 = (*([None] * (not field)), *((beside - xc) * shares.sum() / shares), None)[
        :3
    ]
    second = rng.uniform(0.5, 1.0) if solid else None
    return replace(
        case, motor_events=case.motor_events if field else (),  # without one it is never in step
        motor_circuit=(replace(
            c, rf=c.rf if field else None, xlf=xlf, xlkd=xlkd, xlkd_2=xlkd_2, xc=xc or None,
            rkd_2=c.rkd * rng.uniform(2.0, 10.0) if solid else None,
            rkq_2=c.rkq * rng.uniform(2.0, 10.0) if solid else None,
            xlkq_2=c.xlkq * second if second else None,
        ),),
    )  # fmt: skip


def with_clearance(seed: int) -> Case:
    """The same in an event after which the teeth of one element separate."""
    case, rng = random_case(seed), np.random.default_rng(10_000 + seed)
    i = int(rng.integers(len(case.elements)))
    loose = replace(case.elements[i], kind="coupling", damping=0.0)
    twist = case.stations[-1].running_load / loose.stiffness
    gap = float(twist * 10.0 ** rng.uniform(-1.0, 1.0))
    return replace(
        case,
        elements=(*case.elements[:i], loose, *case.elements[i + 1 :]),
        meshes=(MeshRow(loose.element, angular_backlash=gap),),
    )


def springs(twist: np.ndarray, k: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Torques of elements; one with a clearance is a spring of each flank."""
    pressed = np.maximum(twist.T, 0.0) + np.minimum(twist.T + gap, 0.0)
    return (k * np.where(np.isfinite(gap), pressed, twist.T)).T


def turning_of_springs(
    t: np.ndarray, twist: np.ndarray, growth: np.ndarray, k: np.ndarray, gap: np.ndarray
) -> list[np.ndarray]:
    """Torques of each spring where it turns, and at ends; no cubic goes across the bends."""
    torques, found = springs(twist, k, gap), []
    loaded = np.isinf(gap) | (twist.T > 0.0) | (twist.T < -gap)
    for torque, rate, on in zip(torques, (k * growth.T * loaded).T, loaded.T, strict=True):
        parts = np.split(np.arange(len(t)), np.flatnonzero(np.diff(on)) + 1)
        values = [turning_points(t[part], torque[part], rate[part])[1] for part in parts]
        found.append(np.concatenate([*values, *(torque[part[[0, -1]]] for part in parts)]))
    return found


def gaps(case: Case) -> np.ndarray:
    """Clearance of each element; infinite: none."""
    gap = np.full(len(case.elements), math.inf)
    for mesh in case.meshes:
        gap[[e.element for e in case.elements].index(mesh.element)] = mesh.angular_backlash
    return gap


def windings_of(c: MotorCircuitRow, discharge: float = 0.0) -> tuple[np.ndarray, np.ndarray, int]:
    """Reactances and resistances of all windings, and which is the stator's of axis q: stator, field, dampers of axis d, then q."""
    field = (None if c.rf is None else (1.0 + discharge) * c.rf, c.xlf)
    axes = (
        (c.xmd, c.xc or 0.0, (field, (c.rkd, c.xlkd), (c.rkd_2, c.xlkd_2))),
        (c.xmq, 0.0, ((c.rkq, c.xlkq), (c.rkq_2, c.xlkq_2))),
    )
    blocks, resistances = [], []
    for magnetising, common, pairs in axes:
        r, leakages = zip(
            (c.rs, c.xl), *(pair for pair in pairs if pair[0] is not None), strict=True
        )
        x = np.diag(leakages) + magnetising
        x[1:, 1:] += common
        blocks.append(x)
        resistances.append(r)
    x = block_diag(*blocks)
    return x, np.concatenate(resistances), len(resistances[0])


def voltage_of(row: MotorEventRow, omega: float, t: float, cleared: Collection[int]) -> complex:
    """Voltage of the line in the stator's axes, of phases and not of sequences; `cleared`: phases that are whole."""
    phase = row.phase or 0.0
    if len(cleared) == 3 or row.kind == Kind.OUT_OF_PHASE_CLOSING:
        return complex(np.exp(1j * omega * t))
    if row.kind == Kind.VOLTAGE_DIP:
        return complex(row.residual_voltage * np.exp(1j * omega * t))
    thirds = 2.0 * math.pi / 3.0 * np.arange(3)
    phases = np.cos(omega * t + phase - thirds)
    if row.kind == Kind.THREE_PHASE_FAULT:
        phases[[k for k in range(3) if k not in cleared]] = 0.0
    elif row.kind == Kind.VOLTAGE_UNBALANCE:
        phases[0] *= row.residual_voltage
    else:  # the other two are one point
        phases[1:] = phases[1:].mean()
    return complex(2.0 / 3.0 * np.sum(phases * np.exp(1j * thirds)) * np.exp(-1j * phase))


def reference(case: Case, rtol: float = 1e-11) -> tuple[dict[str, tuple[float, float]], float]:
    """Maximum and minimum of the torque of each element, and the largest torque of the motor in magnitude. [N m]"""
    row, sheet, c = case.motor_events[0], case.motor_data[0], case.motor_circuit[0]
    omega = 2.0 * math.pi * case.line_frequency
    pairs = case.poles / 2.0
    base = sheet.apparent_power * pairs / omega
    j = np.array([s.inertia for s in case.stations])
    k = np.array([e.stiffness for e in case.elements])
    d = np.array([e.damping for e in case.elements])
    n, load = len(j), case.stations[-1].running_load
    x, r, q = windings_of(c)
    y, m = np.linalg.inv(x), len(r)

    def torque_of(flux: np.ndarray) -> np.ndarray:
        i = y @ flux
        return base * (flux[0] * i[q] - flux[q] * i[0])

    off = row.kind == Kind.THREE_PHASE_FAULT and row.residual_voltage is not None
    if off or row.kind == Kind.OUT_OF_PHASE_CLOSING:
        i_f, axis = row.residual_voltage / c.xmd, (row.angle or 0.0) - 0.5 * math.pi
        flux = x[:, 1] * i_f
        accelerations = np.full(n, -load / j.sum())
        inertial = np.cumsum((j * accelerations)[:-1])  # what the discs before an element give up
        twist = -inertial / k
    else:
        p, pf = load / base, sheet.power_factor
        active = (pf - math.sqrt(pf * pf - 4.0 * c.rs * p)) / (2.0 * c.rs) * pf
        i = active * complex(1.0, math.sqrt(1.0 - pf * pf) / pf)
        axis = float(np.angle(1.0 - (c.rs + 1j * (c.xl + c.xmq)) * i)) - 0.5 * math.pi
        i, u = i * np.exp(-1j * axis), np.exp(-1j * axis)
        i_f = (u.imag - c.rs * i.imag - (c.xl + c.xmd) * i.real) / c.xmd
        flux = x[:, 0] * i.real + x[:, 1] * i_f + x[:, q] * i.imag
        twist = load / k
    e_f = c.rf * i_f
    theta = -np.concatenate([[0.0], np.cumsum(twist)])

    gap = gaps(case)

    def rates(t: float, s: np.ndarray, cleared: Collection[int]) -> np.ndarray:
        th, v, psi = s[:n], s[n : 2 * n], s[2 * n :]
        through = springs(th[:-1] - th[1:], k, gap) + d * (v[:-1] - v[1:])
        force = np.zeros(n)
        force[0] = torque_of(psi)
        force[-1] -= load
        force[:-1] -= through
        force[1:] += through
        angle = axis + omega * t + pairs * th[0]
        u = voltage_of(row, omega, t, cleared) * np.exp(-1j * angle)
        w = 1.0 + pairs * v[0] / omega
        out = -r * (y @ psi)
        out[0] += u.real + w * psi[q]
        out[q] += u.imag - w * psi[0]
        out[1] += e_f
        return np.concatenate([v, force / j, omega * out])

    state = np.concatenate([theta, np.zeros(n), flux])
    scale = np.concatenate([np.full(n, 1e-3), np.full(n, 0.1), np.ones(m)])
    found: dict[str, list[np.ndarray]] = {e.element: [] for e in case.elements}
    air_gap: list[float] = []

    def current_of(t: float, s: np.ndarray) -> np.ndarray:
        """Of the three phases."""
        i = y @ s[2 * n :]
        angle = axis + omega * t + pairs * s[0]
        turned = complex(i[0], i[q]) * np.exp(1j * (angle + (row.phase or 0.0)))
        return np.real(turned * np.exp(-2j * math.pi / 3.0 * np.arange(3)))

    def zero_of(waiting: tuple[int, ...]) -> Any:
        """Of the current of one phase, or of that between two."""

        def passes(t: float, s: np.ndarray, _: Collection[int]) -> float:
            i = current_of(t, s)
            return float(i[waiting[0]] - (i[waiting[1]] if len(waiting) > 1 else 0.0))

        passes.terminal = True  # type: ignore[attr-defined]
        return passes

    poles: list[tuple[int, ...]] = (
        [(1, 2)] if row.kind == Kind.LINE_TO_LINE_FAULT else [(0,), (1,), (2,)]
    )
    begin, cleared = 0.0, set[int]()
    while begin < LENGTH:
        opens = row.clears_after is not None and begin < row.clears_after
        zeros = row.clearing == Clearing.ZEROS and len(cleared) < 3 and not opens
        end = row.clears_after if opens else LENGTH
        t = np.linspace(begin, end, max(int((end - begin) * omega / 0.03), 2))
        events = [zero_of(pole) for pole in poles] if zeros else None
        solution = solve_ivp(
            rates,
            (begin, end),
            state,
            "DOP853",
            t,
            rtol=rtol,
            atol=rtol * scale,
            args=(cleared,),
            events=events,
            dense_output=zeros,
        )
        assert solution.success
        if solution.status == 1:  # a zero: the samples until then
            (first,) = (k for k, times in enumerate(solution.t_events) if len(times))
            end = float(solution.t_events[first][0])
            t = np.linspace(begin, end, max(int((end - begin) * omega / 0.03), 2))
            s = solution.sol(t)
        else:
            s = solution.y
        slopes = np.array([rates(a, b, cleared) for a, b in zip(t, s.T, strict=True)]).T
        state = s[:, -1]
        twists, growth = s[: n - 1] - s[1:n], slopes[: n - 1] - slopes[1:n]
        for element, values in zip(
            case.elements, turning_of_springs(t, twists, growth, k, gap), strict=True
        ):
            found[element.element].append(values)  # of the spring, as reported
        psi, dpsi = s[2 * n :], slopes[2 * n :]
        i, di = y @ psi, y @ dpsi
        rate = base * (dpsi[0] * i[q] + psi[0] * di[q] - dpsi[q] * i[0] - psi[q] * di[0])
        torque = torque_of(psi)
        values = np.concatenate([turning_points(t, torque, rate)[1], torque[[0, -1]]])
        air_gap.append(float(np.max(np.abs(values))))
        if solution.status == 1:
            cleared = cleared | set(poles.pop(first)) | ({0} if len(poles) == 0 else set())
        elif opens and row.clearing != Clearing.ZEROS:
            cleared = {0, 1, 2}
        begin = end
    peaks = {e: np.concatenate(v) for e, v in found.items()}
    return {e: (float(v.max()), float(v.min())) for e, v in peaks.items()}, max(air_gap)


#: A loop of stator and line: its axis in the stator, impedance of the line in it, and voltage.
Loop = tuple[float, complex, Callable[[float], complex]]


class Network:
    """A motor behind a line, in fluxes of the loops that stator and line make, and of the rotor's windings."""

    def __init__(self, case: Case, discharge: float = 0.0, size: float = 1.0) -> None:
        sheet, c = case.motor_data[0], case.motor_circuit[0]
        self.omega, self.pairs = 2.0 * math.pi * case.line_frequency, case.poles / 2.0
        self.base = sheet.apparent_power * self.pairs / self.omega
        self.x, self.r, self.q = windings_of(c, discharge)
        self.rotor = [k for k in range(len(self.r)) if k not in (0, self.q)]
        self.line, self.size = 0.0j, size
        if case.supply:
            impedance = sheet.apparent_power / case.supply[0].short_circuit_power
            along = complex(1.0, case.supply[0].x_r)
            self.line = impedance * along / abs(along)

    def whole(self, t: float) -> complex:
        return complex(self.size * np.exp(1j * self.omega * t))

    def healthy(self) -> list[Loop]:
        return [(0.0, self.line, self.whole), (0.5 * math.pi, self.line, self.whole)]

    def loops(self, row: MotorEventRow, since: float = 0.0) -> list[Loop]:
        """Of an event that begins at some time."""
        quarter, turned = 0.5 * math.pi, self.omega * since - (row.phase or 0.0)
        if row.kind == Kind.THREE_PHASE_FAULT:
            return [(0.0, 0.0j, lambda t: 0.0j), (quarter, 0.0j, lambda t: 0.0j)]
        if row.kind == Kind.LINE_TO_LINE_FAULT:
            off = row.residual_voltage is not None
            shorted = (turned + quarter, 0.0j, lambda t: 0.0j)
            return [shorted] if off else [(turned, self.line, self.whole), shorted]
        start = complex(self.size * np.exp(1j * self.omega * since))

        def changed(t: float) -> complex:
            return start * voltage_of(row, self.omega, t - since, ())

        return [(0.0, self.line, changed), (quarter, self.line, changed)]

    def phases(self, row: MotorEventRow, since: float = 0.0) -> np.ndarray:
        """Axes of the phases in the stator."""
        first = self.omega * since - (row.phase or 0.0)
        return first + 2.0 * math.pi / 3.0 * np.arange(3)

    def partly(self, axes: np.ndarray, cleared: Collection[int]) -> list[Loop]:
        """Phases behind the line where they have cleared, and shorted at the terminals where not; no current in the neutral."""
        of = np.array([[math.cos(axes[k]), math.sin(axes[k])] for k in cleared])
        shares, directions = np.linalg.eigh(2.0 / 3.0 * of.T @ of)
        return [
            (math.atan2(way[1], way[0]), share * self.line, lambda t, m=share: m * self.whole(t))
            for share, way in zip(shares.tolist(), directions.T, strict=True)
        ]

    def windings(self, angle: float, loops: list[Loop]) -> tuple[np.ndarray, np.ndarray]:
        """Currents of all windings per current of loops and rotor, and what these link."""
        m = len(loops)
        of = np.zeros((len(self.r), m + len(self.rotor)))
        for col, (along, _, _) in enumerate(loops):
            of[[0, self.q], col] = math.cos(along - angle), math.sin(along - angle)
        of[self.rotor, range(m, m + len(self.rotor))] = 1.0
        own = np.zeros(m + len(self.rotor))
        own[:m] = [z.imag for _, z, _ in loops]
        return of, of.T @ self.x @ of + np.diag(own)

    def currents(
        self, angle: float, linked: np.ndarray, loops: list[Loop]
    ) -> tuple[np.ndarray, np.ndarray]:
        of, links = self.windings(angle, loops)
        i = np.linalg.solve(links, linked)
        return of @ i, i

    def linked(self, angle: float, i: np.ndarray, loops: list[Loop]) -> np.ndarray:
        """Fluxes from currents of all windings."""
        of, links = self.windings(angle, loops)
        return links @ (np.linalg.pinv(of) @ i)

    def torque(self, i: np.ndarray) -> float:
        psi = self.x @ i
        return float(self.base * (psi[0] * i[self.q] - psi[self.q] * i[0]))

    def change(self, t: float, i: np.ndarray, loops: list[Loop], excited: float) -> np.ndarray:
        """Rates of the fluxes; the field's voltage is the first of the rotor's."""
        m, out = len(loops), np.empty(len(i))
        for col, (along, z, e) in enumerate(loops):
            out[col] = (e(t) * np.exp(-1j * along)).real - (self.r[0] + z.real) * i[col]
        out[m:] = -self.r[self.rotor] * i[m:]
        out[m] += excited
        return self.omega * out


def network_reference(
    case: Case, rtol: float = 1e-11
) -> tuple[dict[str, tuple[float, float]], float]:
    """As `reference`, of a motor behind a line, or of a line-to-line fault off it; the currents of the motor do not jump."""
    row, sheet, c = case.motor_events[0], case.motor_data[0], case.motor_circuit[0]
    net = Network(case)
    omega, pairs, base, q = net.omega, net.pairs, net.base, net.q
    j = np.array([s.inertia for s in case.stations])
    k = np.array([e.stiffness for e in case.elements])
    d = np.array([e.damping for e in case.elements])
    n, load, gap = len(j), case.stations[-1].running_load, gaps(case)
    if row.kind == Kind.LINE_TO_LINE_FAULT and row.residual_voltage is not None:
        i_f, axis = row.residual_voltage / c.xmd, -0.5 * math.pi
        first = i_f * np.eye(len(net.r))[1]
        through = -np.cumsum((j * np.full(n, -load / j.sum()))[:-1])
    else:
        p, pf = load / base, sheet.power_factor
        active = (pf - math.sqrt(pf * pf - 4.0 * c.rs * p)) / (2.0 * c.rs) * pf
        i = active * complex(1.0, math.sqrt(1.0 - pf * pf) / pf)
        axis = float(np.angle(1.0 - (c.rs + 1j * (c.xl + c.xmq)) * i)) - 0.5 * math.pi
        source = 1.0 + net.line * i
        i, u = i * np.exp(-1j * axis), np.exp(-1j * axis)
        i_f = (u.imag - c.rs * i.imag - (c.xl + c.xmd) * i.real) / c.xmd
        first = np.zeros(len(net.r))
        first[[0, 1, q]] = i.real, i_f, i.imag
        net.size, axis = abs(source), axis - float(np.angle(source))
        through = np.full(n - 1, load)

    def angle_of(t: float, s: np.ndarray) -> float:
        return float(axis + omega * t + pairs * s[0])

    def rates(t: float, s: np.ndarray, loops: list[Loop]) -> np.ndarray:
        th, v = s[:n], s[n : 2 * n]
        all_, i = net.currents(angle_of(t, s), s[2 * n :], loops)
        pushed = springs(th[:-1] - th[1:], k, gap) + d * (v[:-1] - v[1:])
        force = np.zeros(n)
        force[0] = net.torque(all_)
        force[-1] -= load
        force[:-1] -= pushed
        force[1:] += pushed
        return np.concatenate([v, force / j, net.change(t, i, loops, c.rf * i_f)])

    theta = -np.concatenate([[0.0], np.cumsum(through / k)])
    state, peaks, air_gap = np.concatenate([theta, np.zeros(n)]), {}, []
    for t, s, loops in _spans(net, row, 0.0, LENGTH, (rates, angle_of), state, first, rtol):
        twists, growth = s[: n - 1] - s[1:n], s[n : 2 * n - 1] - s[n + 1 : 2 * n]
        for element, values in zip(
            case.elements, turning_of_springs(t, twists, growth, k, gap), strict=True
        ):
            peaks.setdefault(element.element, []).append(values)
        all_ = [
            net.currents(angle_of(a, b), b[2 * n :], loops)[0] for a, b in zip(t, s.T, strict=True)
        ]
        air_gap.append(np.max(np.abs(tops_of(t, np.array([net.torque(i) for i in all_])))))
    found = {e: np.concatenate(v) for e, v in peaks.items()}
    return {e: (float(v.max()), float(v.min())) for e, v in found.items()}, float(max(air_gap))


def tops_of(t: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Values of a torque where it turns, and its ends."""
    spline = CubicSpline(t, torque)
    tops = spline.derivative().roots(extrapolate=False)
    return np.asarray(spline(np.append(tops[np.isfinite(tops)], t[[0, -1]])))


def _spans(
    net: Network, row: MotorEventRow, since: float, end: float, motion: Any, state: np.ndarray, now: np.ndarray,
    rtol: float, first: list[Loop] | None = None,
) -> Any:  # fmt: skip
    """Times, states and loops between two changes of what the stator is connected to, from an event on.

    `motion`: rates of a state and the angle of the rotor; `state` has no fluxes yet, `now` are the currents of all windings.
    """
    rates, angle_of = motion
    clears = math.inf if row.clears_after is None else since + row.clears_after
    loops, axes, cleared = first or net.loops(row, since), net.phases(row, since), set[int]()
    poles = [(1, 2)] if row.kind == Kind.LINE_TO_LINE_FAULT else [(0,), (1,), (2,)]
    begin, n = since, len(state)

    def zero_of(pole: tuple[int, ...]) -> Any:
        """Of the current of one phase, or of that between two."""

        def passes(t: float, s: np.ndarray, loops: list[Loop]) -> float:
            angle = angle_of(t, s)
            i = net.currents(angle, s[n:], loops)[0]
            of = np.real(complex(i[0], i[net.q]) * np.exp(1j * (angle - axes)))
            return float(of[pole[0]] - (of[pole[1]] if len(pole) > 1 else 0.0))

        passes.terminal = True  # type: ignore[attr-defined]
        return passes

    while begin < end:
        waits = row.clearing == Clearing.ZEROS and begin >= clears and len(poles) > 0
        last = min(clears, end) if begin < clears else end

        whole = np.concatenate([state, net.linked(angle_of(begin, state), now, loops)])
        scale = np.concatenate(
            [np.full(n // 2, 1e-3), np.full(n // 2, 0.1), np.ones(len(whole) - n)]
        )
        solution = solve_ivp(
            rates, (begin, last), whole, "DOP853", args=(loops,), rtol=rtol, atol=rtol * scale, dense_output=True,
            events=[zero_of(pole) for pole in poles] if waits else None,
            max_step=0.2 / net.omega if waits else math.inf,  # two zeros in a step would be none
        )  # fmt: skip
        assert solution.success
        ends = float(solution.t[-1])
        t = np.linspace(begin, ends, max(int((ends - begin) * net.omega / 0.03), 4))
        yield t, solution.sol(t), loops
        begin, whole = ends, solution.y[:, -1]
        state, now = whole[:n], net.currents(angle_of(ends, whole), whole[n:], loops)[0]
        if solution.status == 1:  # a zero
            (met,) = (k for k, times in enumerate(solution.t_events) if len(times))
            cleared |= set(poles.pop(met))
            loops = net.partly(axes, cleared) if poles else net.healthy()
        elif row.clearing != Clearing.ZEROS:
            loops = net.healthy()


def start_network_reference(
    case: Case, angle: float, end: float, rtol: float = 1e-9
) -> dict[str, tuple[float, float]]:
    """As `start_reference`, of a motor behind a line, in fluxes of loops."""
    row, sheet = case.motor_events[0], case.motor_data[0]
    net = Network(case, sheet.discharge_resistance or 0.0)
    j = np.array([s.inertia for s in case.stations])
    k = np.array([e.stiffness for e in case.elements])
    d = np.array([e.damping for e in case.elements])
    n, since = len(j), float(row.begins)

    def angle_of(t: float, s: np.ndarray) -> float:
        return float(net.pairs * s[0] - angle)

    def rates(t: float, s: np.ndarray, loops: list[Loop]) -> np.ndarray:
        """Of the motor's angle, the twists, speeds and fluxes."""
        v = s[n : 2 * n]
        all_, i = net.currents(angle_of(t, s), s[2 * n :], loops)
        through = k * s[1:n] + d * (v[:-1] - v[1:])
        force = np.zeros(n)
        force[0] = net.torque(all_)
        force[:-1] -= through
        force[1:] += through
        return np.concatenate([v[:1], v[:-1] - v[1:], force / j, net.change(t, i, loops, 0.0)])

    motion, found = (rates, angle_of), {e.element: [] for e in case.elements} | {AIR_GAP: []}
    before = replace(row, clears_after=None)
    state, now = np.zeros(2 * n), np.zeros(len(net.r))
    ((_, s, _),) = _spans(net, before, 0.0, since, motion, state, now, rtol, net.healthy())
    state = s[: 2 * n, -1]
    now = net.currents(angle_of(since, state), s[2 * n :, -1], net.healthy())[0]
    for t, s, loops in _spans(net, row, since, end, motion, state, now, rtol):
        for i, element in enumerate(case.elements):
            torque, rate = k[i] * s[1 + i], k[i] * (s[n + i] - s[n + i + 1])
            found[element.element] += [turning_points(t, torque, rate)[1], torque[[0, -1]]]
        all_ = [
            net.currents(angle_of(a, b), b[2 * n :], loops)[0] for a, b in zip(t, s.T, strict=True)
        ]
        found[AIR_GAP].append(tops_of(t, np.array([net.torque(i) for i in all_])))
    return {
        name: (float(np.concatenate(values).max()), float(np.concatenate(values).min()))
        for name, values in found.items()
    }


def start_case(
    seed: int, tolerance: float = 1e-3, make: Callable[[int], Case] = random_case
) -> Case:
    """A machine and its train from rest, without a load."""
    case, rng = make(seed), np.random.default_rng(20_000 + seed)
    synchronous = 4.0 * math.pi * case.line_frequency / case.poles
    discharge = float(rng.choice([0.0, 5.0, 10.0]))
    has_field = case.motor_circuit[0].rf is not None
    sheet = replace(case.motor_data[0], discharge_resistance=discharge if has_field else None)
    return replace(
        case, motor_events=(), motor_data=(sheet,), maximum_time=None, end_speed=0.85 * synchronous,
        tolerance_peak=tolerance, pulsation_phase=float(rng.uniform(-3.0, 3.0)),
        stations=tuple(replace(s, running_load=None) for s in case.stations),
    )  # fmt: skip


#: What happens to the motor of `event_in_start`.
IN_START = (*(kind for kind in KINDS if kind != Kind.OUT_OF_PHASE_CLOSING), Kind.RECLOSING)


def event_in_start(seed: int, make: Callable[[int], Case] = random_case) -> Case:
    """A start with an event at some time before its end, as it would be without one."""
    case, rng = start_case(seed, make=make), np.random.default_rng(30_000 + seed)
    kind = IN_START[seed % len(IN_START)]
    row = MotorEventRow(
        "event", "M0", kind,
        phase=rng.uniform(-3.0, 3.0) if kind in (Kind.LINE_TO_LINE_FAULT, Kind.VOLTAGE_UNBALANCE) else None,
        residual_voltage=rng.uniform(0.3, 0.95) if kind in (Kind.VOLTAGE_DIP, Kind.VOLTAGE_UNBALANCE) else None,
        clears_after=rng.uniform(0.02, 0.15), begins=rng.uniform(0.05, 0.5),
    )  # fmt: skip
    return replace(case, motor_events=(row,), maximum_time=1.5)


def start_reference(
    case: Case, angle: float, end: float, rtol: float = 1e-9
) -> dict[str, tuple[float, float]]:
    """Maximum and minimum of the torque of each element, and of the air gap, from closing to a time.

    `angle`: of the line ahead of axis d. Where the case has an event in the start they are those from the event on.
    """
    sheet, c = case.motor_data[0], case.motor_circuit[0]
    omega, pairs = 2.0 * math.pi * case.line_frequency, case.poles / 2.0
    base = sheet.apparent_power * pairs / omega
    j = np.array([s.inertia for s in case.stations])
    k = np.array([e.stiffness for e in case.elements])
    d = np.array([e.damping for e in case.elements])
    n = len(j)
    x, r, q = windings_of(c, sheet.discharge_resistance or 0.0)
    y, m = np.linalg.inv(x), len(r)
    rotor = [k for k in range(m) if k not in (0, q)]
    of_rotor = np.zeros((m, m))  # currents with an open stator
    of_rotor[np.ix_(rotor, rotor)] = np.linalg.inv(x[np.ix_(rotor, rotor)])

    def torque_of(flux: np.ndarray, currents: np.ndarray) -> np.ndarray:
        i = currents @ flux
        return base * (flux[0] * i[q] - flux[q] * i[0])

    def rates(
        t: float, s: np.ndarray, line: Callable[[float], complex], currents: np.ndarray
    ) -> np.ndarray:
        """Of the motor's angle, the twists, which stay small, speeds and fluxes; an open stator has none."""
        v, psi = s[n : 2 * n], s[2 * n :]
        through = k * s[1:n] + d * (v[:-1] - v[1:])
        force = np.zeros(n)
        force[0] = torque_of(psi, currents)
        force[:-1] -= through
        force[1:] += through
        u, w = line(t) * np.exp(1j * (angle - pairs * s[0])), pairs * v[0] / omega
        out = -r * (currents @ psi)
        out[0] += u.real + w * psi[q]
        out[q] += u.imag - w * psi[0]
        if currents is of_rotor:
            out[[0, q]] = 0.0
        return np.concatenate([v[:1], v[:-1] - v[1:], force / j, omega * out])

    def whole(t: float) -> complex:
        return complex(np.exp(1j * omega * t))

    spans, since = [(0.0, end, whole, y)], 0.0
    cleared, poles = set[int](), list[tuple[int, ...]]()
    if case.motor_events:
        row = case.motor_events[0]
        since = row.begins
        clears = since + row.clears_after
        stator = of_rotor if row.kind == Kind.RECLOSING else y

        def changed(t: float) -> complex:
            if row.kind == Kind.RECLOSING:
                return 0.0
            turned = complex(np.exp(1j * omega * since))
            return voltage_of(row, omega, t - since, cleared) * turned

        spans = [(0.0, since, whole, y), (since, clears, changed, stator)]
        if row.clearing == Clearing.ZEROS:
            poles = [(1, 2)] if row.kind == Kind.LINE_TO_LINE_FAULT else [(0,), (1,), (2,)]
            spans += [(clears, end, changed, y)]
        else:
            spans += [(clears, end, whole, y)]

    def zero_of(pole: tuple[int, ...]) -> Any:
        """Of the current of one phase, or of that between two."""

        def passes(t: float, s: np.ndarray, *_: Any) -> float:
            i = y @ s[2 * n :]
            turned = pairs * s[0] - angle - omega * since + (row.phase or 0.0)
            thirds = 2.0 * math.pi / 3.0 * np.arange(3)
            of_phases = np.real(complex(i[0], i[q]) * np.exp(1j * (turned - thirds)))
            return float(of_phases[pole[0]] - (of_phases[pole[1]] if len(pole) > 1 else 0.0))

        passes.terminal = True  # type: ignore[attr-defined]
        return passes

    state = np.zeros(2 * n + m)
    scale = np.concatenate([[1e-2], base / k, np.ones(n), np.ones(m)])
    found: dict[str, list[np.ndarray]] = {e.element: [] for e in case.elements} | {AIR_GAP: []}
    while spans:
        first, last, line, currents = spans.pop(0)
        state[2 * n :] = x @ (of_rotor if currents is of_rotor else y) @ state[2 * n :]
        events = [zero_of(pole) for pole in poles] if not spans and poles else None
        solution = solve_ivp(
            rates, (first, last), state, "DOP853", args=(line, currents), rtol=rtol, atol=rtol * scale,
            events=events, dense_output=True,
        )  # fmt: skip
        if solution.status == 1:  # a zero: what follows is another span
            spans = [(float(solution.t[-1]), last, line, currents)]
            (met,) = (j for j, times in enumerate(solution.t_events) if len(times))
            cleared |= set(poles.pop(met))
            cleared |= set() if poles else {0, 1, 2}
        t = np.linspace(first, solution.t[-1], max(int((solution.t[-1] - first) * omega / 0.05), 2))
        s = solution.sol(t)
        state = solution.y[:, -1].copy()
        if currents is of_rotor:
            state[2 * n :] = x @ of_rotor @ state[2 * n :]
        if first < since:  # the event begins with the torque before it, which an open stator ends
            found[AIR_GAP].append(torque_of(s[2 * n :, -1:], currents))
            continue
        for i, element in enumerate(case.elements):
            torque, rate = k[i] * s[1 + i], k[i] * (s[n + i] - s[n + i + 1])
            found[element.element] += [turning_points(t, torque, rate)[1], torque[[0, -1]]]
        air_gap = CubicSpline(t, torque_of(s[2 * n :], currents))
        tops = air_gap.derivative().roots(extrapolate=False)
        found[AIR_GAP] += [air_gap(np.append(tops[np.isfinite(tops)], t[[0, -1]]))]
    return {
        name: (float(np.concatenate(values).max()), float(np.concatenate(values).min()))
        for name, values in found.items()
    }


def misses(case: Case, event: Any, truth: Callable[[Case], Any] = reference) -> list[str]:
    """What lies outside its stated error, and by how much."""
    peaks, air_gap = truth(case)
    out = []
    for p in event.response.peaks:
        most, least = peaks[p.element]
        true = max(abs(p.maximum - most), abs(p.minimum - least)) / p.size
        if true > p.relative_error:
            out.append(f"{p.element}: {true:.2e} > {p.relative_error:.2e}")
    size = abs(event.air_gap.largest)
    if abs(size - air_gap) > event.air_gap.error * size:
        out.append(f"air gap: {abs(size - air_gap) / size:.2e} > {event.air_gap.error:.2e}")
    return out


def errors_hold(
    seeds: Collection[int], make: Callable[[int], Case], truth: Callable[[Case], Any] = reference
) -> int:
    """Checks the stated errors of one event each in 99 % of the cases; how many of the trains came apart."""
    missed, apart = {}, 0
    for seed in seeds:
        case = make(seed)
        (event,) = operating_events(case, analyse(case))
        assert event.response is not None, event.note
        apart += bool(event.response.contacts)
        if found := misses(case, event, truth):
            missed[seed] = found
    assert len(missed) <= 0.01 * len(seeds), missed
    return apart
