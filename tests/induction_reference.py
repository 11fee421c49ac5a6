"""An induction motor and its train integrated by scipy's DOP853, in axes that stand still: no rotor's axes, no modes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from engine.case.case import Case
from engine.case.choices import MotorEventKind as Kind
from engine.case.data import MotorDataRow, MotorEventRow
from engine.stepping.linear_loop import turning_points
from tests.machine_reference import LENGTH, random_case, voltage_of, with_clearance

KINDS = (
    Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT, Kind.RECLOSING, Kind.VOLTAGE_DIP,
    Kind.VOLTAGE_UNBALANCE, Kind.RECLOSING,
)  # fmt: skip


def induction_case(seed: int, *, clearance: bool = False) -> Case:
    """The train of `random_case`, or of `with_clearance`, on an induction motor of one cage or two."""
    case, rng = (
        (with_clearance if clearance else random_case)(seed),
        np.random.default_rng(40_000 + seed),
    )
    second = (rng.uniform(0.04, 0.1), rng.uniform(0.03, 0.1)) if seed % 2 else (None, None)
    sheet = MotorDataRow(
        "M0", "induction", case.motor_data[0].apparent_power,
        r_1=rng.uniform(0.004, 0.03), x_1=rng.uniform(0.05, 0.12), xm=rng.uniform(2.0, 5.0),
        r_2=10.0 ** rng.uniform(-2.3, -1.4), x_2=rng.uniform(0.06, 0.16), r_3=second[0], x_3=second[1],
    )  # fmt: skip
    kind = KINDS[seed % len(KINDS)]
    typed = kind == Kind.RECLOSING and seed % 12 == 5
    event = MotorEventRow(
        "event", "M0", kind,
        phase=rng.uniform(-3.0, 3.0) if kind in (Kind.LINE_TO_LINE_FAULT, Kind.VOLTAGE_UNBALANCE) else None,
        angle=rng.uniform(-3.0, 3.0) if typed else None,
        residual_voltage=rng.uniform(0.3, 0.95) if typed or "voltage" in kind else None,
        clears_after=rng.uniform(0.02, 0.15),
    )  # fmt: skip
    return replace(case, motor_data=(sheet,), motor_circuit=(), motor_events=(event,))


def induction_reference(
    case: Case, rtol: float = 1e-11
) -> tuple[dict[str, tuple[float, float]], float]:
    """Maximum and minimum of the torque of each element, and the largest torque of the motor in magnitude. [N m]"""
    row, c = case.motor_events[0], case.motor_data[0]
    omega, pairs = 2.0 * math.pi * case.line_frequency, case.poles / 2.0
    base = c.apparent_power * pairs / omega
    j = np.array([s.inertia for s in case.stations])
    k = np.array([e.stiffness for e in case.elements])
    d = np.array([e.damping for e in case.elements])
    n, load = len(j), case.stations[-1].running_load
    cages = [(c.r_2, c.x_2)] + ([(c.r_3, c.x_3)] if c.r_3 else [])
    x = np.full((1 + len(cages),) * 2, c.xm) + np.diag([c.x_1, *(leakage for _, leakage in cages)])
    y, inner = np.linalg.inv(x), np.linalg.inv(x[1:, 1:])
    r = np.array([c.r_1, *(resistance for resistance, _ in cages)])
    m = len(r)

    def torque_of(psi: np.ndarray) -> np.ndarray:
        return base * np.imag(np.conj(psi[0]) * (y @ psi)[0])

    def steady(slip: float) -> np.ndarray:
        """Fluxes where the voltage is 1."""
        turning = np.diag(1j * np.array([1.0, *[slip] * len(cages)]))
        return np.linalg.solve(turning + r[:, None] * y, np.eye(m)[0])

    grid = np.geomspace(1e-5, 1.0, 2000)
    torques = np.array([torque_of(steady(s)) for s in grid])
    top = int(np.argmax(np.diff(torques) < 0.0))
    slip = brentq(lambda s: torque_of(steady(s)) - load, 0.0, grid[top], xtol=1e-15)
    psi = steady(slip)
    gap = np.full(n - 1, math.inf)
    for mesh in case.meshes:
        gap[[e.element for e in case.elements].index(mesh.element)] = mesh.angular_backlash

    def springs(twist: np.ndarray) -> np.ndarray:
        pressed = np.maximum(twist.T, 0.0) + np.minimum(twist.T + gap, 0.0)
        return (k * np.where(np.isfinite(gap), pressed, twist.T)).T

    def rates(t: float, s: np.ndarray, state: str, shift: float) -> np.ndarray:
        th, v = s[:n], s[n : 2 * n]
        psi = s[2 * n : 2 * n + m] + 1j * s[2 * n + m :]
        through = springs(th[:-1] - th[1:]) + d * (v[:-1] - v[1:])
        force = np.zeros(n)
        force[-1] -= load
        force[:-1] -= through
        force[1:] += through
        w = (1.0 - slip) + pairs * v[0] / omega
        if state == "open":
            out = 1j * w * psi
            out[1:] -= r[1:] * (inner @ psi[1:])
            out[0] = c.xm * np.sum(inner @ out[1:])
        else:
            force[0] += torque_of(psi)
            u = np.exp(1j * (omega * t + shift))
            u = u if state == "whole" else voltage_of(row, omega, t, ())
            out = -r * (y @ psi)
            out[1:] += 1j * w * psi[1:]
            out[0] += u
        out = omega * out
        return np.concatenate([v, force / j, out.real, out.imag])

    theta = -np.concatenate([[0.0], np.cumsum(load / k)])
    opens = row.kind == Kind.RECLOSING
    if opens:
        psi[0] = c.xm * np.sum(inner @ psi[1:])
    begin, found, air_gap = 0.0, {e.element: [] for e in case.elements}, [load]
    state = np.concatenate([theta, np.zeros(n), psi.real, psi.imag])
    scale = np.concatenate([np.full(n, 1e-3), np.full(n, 0.1), np.ones(2 * m)])
    shift = 0.0
    for end, name in ((row.clears_after, "open" if opens else "changed"), (LENGTH, "whole")):
        t = np.linspace(begin, end, max(int((end - begin) * omega / 0.03), 2))
        solution = solve_ivp(
            rates,
            (begin, end),
            state,
            "DOP853",
            t,
            rtol=rtol,
            atol=rtol * scale,
            args=(name, shift),
        )
        assert solution.success
        s = solution.y
        slopes = np.array([rates(a, b, name, shift) for a, b in zip(t, s.T, strict=True)]).T
        twists, growth = s[: n - 1] - s[1:n], slopes[: n - 1] - slopes[1:n]
        loaded = np.isinf(gap) | (twists.T > 0.0) | (twists.T < -gap)
        for i, element in enumerate(case.elements):
            torque, rate = springs(twists)[i], k[i] * growth[i] * loaded.T[i]
            for part in np.split(np.arange(len(t)), np.flatnonzero(np.diff(loaded.T[i])) + 1):
                turns = turning_points(t[part], torque[part], rate[part])[1]
                found[element.element] += [turns, torque[part[[0, -1]]]]
        psi, dpsi = (a[2 * n : 2 * n + m] + 1j * a[2 * n + m :] for a in (s, slopes))
        if name != "open":
            torque = torque_of(psi)
            rate = base * np.imag(np.conj(dpsi[0]) * (y @ psi)[0] + np.conj(psi[0]) * (y @ dpsi)[0])
            values = np.concatenate([turning_points(t, torque, rate)[1], torque[[0, -1]]])
            air_gap.append(float(np.max(np.abs(values))))
        state, begin = s[:, -1], end
        if opens and row.angle is not None:
            shift = float(np.angle(1j * psi[0, -1])) - row.angle - omega * end
        if opens and row.residual_voltage is not None:
            state = state.copy()
            state[2 * n :] *= row.residual_voltage / ((1.0 - slip) * abs(psi[0, -1]))
            opens = False
    peaks = {e: np.concatenate(v) for e, v in found.items()}
    return {e: (float(v.max()), float(v.min())) for e, v in peaks.items()}, max(air_gap)
