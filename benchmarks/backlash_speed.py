"""Starts with backlash: beside the linear start, and beside ROSS's robust stepping."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Point, Timing, interleave, local, timing_of
from benchmarks.peers import PeerFailed, Worker
from benchmarks.problems import long_start
from engine.case.case import Case
from engine.case.data import ElementRow, MeshRow, StationRow, TorqueTimeRow
from engine.case.effect import StartEffects
from engine.model.modal_analysis import analyse
from engine.run import calculate_start
from engine.start.start import Start

__all__ = [
    "EVENTS_ALONE", "OURS", "PAIR", "THEIRS", "PairRow", "StartBeside", "compare_pair",
    "compare_starts_with_events", "pair_case", "pair_points", "pair_reference", "start_with_teeth",
    "with_clearances",
]  # fmt: skip

Floats = NDArray[np.float64]

# --- beside the linear start ----------------------------------------------------------------------

#: Teeth of the example's mesh: normal stiffness, damping, backlash; the gears' bearings. [SI]
MESH_STIFFNESS, MESH_DAMPING, BACKLASH = 4e9, 2e5, 4e-4
PITCH_RADIUS, HELIX_ANGLE, ORIENTATION = 0.6, 0.2, 0.3
ANGULAR_BACKLASH = 1e-3
BEARINGS = {
    "mass_drive": 2500.0, "bearing_stiffness_drive": 3e9, "bearing_damping_drive": 1e6,
    "mass_driven": 400.0, "bearing_stiffness_driven": 1.5e9, "bearing_damping_driven": 8e5,
}  # fmt: skip


@dataclass(frozen=True)
class StartBeside:
    """One start with events beside the linear start of the same case, in one run.

    Parameters
    ----------
    what : str
        What is simulated. [words]
    linear, events : Timing
        Median times of `run_start` and of `run_event_start`. [s]
    linear_steps, steps, impacts : int
        Steps of the finer simulation of each, and impacts. [count]
    seconds_simulated, estimated_error : float
        Of the start with events. [s, 1]
    """

    what: str
    linear: Timing
    events: Timing
    linear_steps: int
    steps: int
    impacts: int
    seconds_simulated: float
    estimated_error: float

    @property
    def ratio(self) -> float:
        """Time with events over time without. [1]"""
        return self.events.seconds / self.linear.seconds


def start_with_teeth(*, bearings: bool, voltage: float = 1.0) -> tuple[Case, str]:
    """The example with an elastic mesh that has backlash, and the name of the mesh."""
    case = replace(long_start(), voltage=voltage)
    mesh = next(e for e in case.elements if e.kind == "gear mesh")
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    row = MeshRow(
        mesh.element,
        pitch_radius_drive=PITCH_RADIUS,
        pitch_radius_driven=PITCH_RADIUS * ratio[mesh.from_] / ratio[mesh.to],
        helix_angle=HELIX_ANGLE,
        orientation=ORIENTATION,
        mesh_stiffness=MESH_STIFFNESS,
        mesh_damping=MESH_DAMPING,
        backlash=BACKLASH,
        **(BEARINGS if bearings else {}),
    )
    elements = tuple(replace(e, stiffness=None) if e is mesh else e for e in case.elements)
    return replace(case, elements=elements, meshes=(row,)), str(mesh.element)


def with_clearances(count: int) -> tuple[Case, tuple[str, ...]]:
    """The example with so many elements that have clearance, one behind another, and their names.

    The first is the mesh, then the couplings, then shafts made couplings.
    """
    case, mesh = start_with_teeth(bearings=False)
    others = [e for e in case.elements if e.element != mesh]
    others.sort(key=lambda e: e.kind != "coupling")
    chosen = [str(e.element) for e in others[: max(count - 1, 0)]]
    elements = tuple(
        replace(e, kind="coupling") if e.element in chosen else e for e in case.elements
    )
    rows = (MeshRow(e, angular_backlash=ANGULAR_BACKLASH) for e in chosen)
    case = replace(case, elements=elements, meshes=(*case.meshes, *rows))
    return case, (mesh, *chosen)[:count]


def compare_starts_with_events(rounds: int) -> Iterator[StartBeside]:
    """Each start with events takes turns with the linear one."""
    for what, bearings in (("backlash", False), ("backlash and bearings", True)):
        case, mesh = start_with_teeth(bearings=bearings)
        model = analyse(case).reported
        linear = calculate_start(case, model, StartEffects(), None)
        effects = StartEffects(clearances=(mesh,))
        done = interleave(
            {
                "linear": local(
                    lambda c=case, m=model: calculate_start(c, m, StartEffects(), None), 0.1, 10
                ),
                "events": local(
                    lambda c=case, m=model, e=effects, s=linear: calculate_start(c, m, e, s),
                    0.1,
                    10,
                ),
            },
            rounds,
        )
        start: Start = done["events"].result
        first, second = done["linear"].timing, done["events"].timing
        assert first is not None
        assert second is not None
        yield StartBeside(
            what,
            first,
            second,
            linear.trajectory.n_steps,
            start.trajectory.n_steps,
            sum(c.impacts for c in start.contacts),
            start.outcome.time,
            start.estimated_error,
        )


# --- beside ROSS ----------------------------------------------------------------------------------

#: A gear pair that both programs and the reference calculate: ratio 1, a shaft with a damper behind each gear, a disk at
#: its end. Gears are held laterally (ROSS: by bearings that stiff), so that its flanks do not move with the distance of
#: centres; the teeth themselves have no damper, as a flank of ROSS may pull by it and one of ours never does. The load
#: holds against a mean torque, by which the teeth are at rest on a flank before the motor swings; where each program
#: begins is then forgotten. [SI]
PAIR: dict[str, float] = {
    "motor_inertia": 4.0, "drive_inertia": 1.0, "driven_inertia": 1.0, "load_inertia": 4.0,
    "shaft_stiffness": 2e6, "shaft_damping_time": 1e-3, "pitch_radius": 0.2,
    "pressure_angle": math.radians(20.0), "mesh_stiffness": 1e8, "mesh_damping_ratio": 0.0,
    "gap": 2e-4, "drive_mass": 100.0, "driven_mass": 100.0, "bearing_stiffness": 1e12,
    "mean_torque": 300.0, "swing_torque": 2000.0, "omega": 2.0 * math.pi * 45.0,
    "settled": 0.1, "speed": 100.0,
}  # fmt: skip
#: The torque is straight between knots this far apart, for all. [s]
KNOTS = 1e-3
#: Every run lasts this long; errors and peaks are those of the window after `settled`, on this grid. [s]
DURATION, GRID = 0.2, 1e-4
ROSS_STEPS = (1e-4, 5e-5, 2e-5, 1e-5)
OUR_TOLERANCES = (1e-1, 1e-3, 1e-5)
OURS, THEIRS = "torsionbook", "ROSS, robust"
EVENTS_ALONE = "torsionbook, the linear start known"


@dataclass(frozen=True)
class PairRow:
    """One setting of one program.

    Parameters
    ----------
    label, setting : str
        Program; step or tolerance. [words]
    steps : int
        Steps taken. [count]
    seconds : float
        Processor time of the run. [s]
    error : float
        Largest difference of the mesh force from the reference in the window, over the largest. [1]
    peak, trough : float
        Largest and smallest mesh force in the window. [N]
    failure : str or None
        Why there is none. [sentence]
    """

    label: str
    setting: str
    steps: int
    seconds: float
    error: float
    peak: float
    trough: float
    failure: str | None = None


def pair_knots() -> tuple[Floats, Floats]:
    """Times of the knots and torque of the motor there."""
    d = PAIR
    time = KNOTS * np.arange(round(DURATION / KNOTS) + 1)
    swing = np.sin(d["omega"] * (time - d["settled"])) * (time > d["settled"])
    return time, d["mean_torque"] + d["swing_torque"] * swing


def _base_radius() -> float:
    return PAIR["pitch_radius"] * math.cos(PAIR["pressure_angle"])


def pair_case() -> Case:
    """The gear pair as we take it."""
    d = PAIR
    time, torque = pair_knots()
    names = ("Motor", "Drive gear", "Driven gear", "Load")
    inertia = [d[f"{n}_inertia"] for n in ("motor", "drive", "driven", "load")]
    k, c = d["shaft_stiffness"], d["shaft_damping_time"] * d["shaft_stiffness"]
    return Case(
        stations=tuple(StationRow(n, None, J) for n, J in zip(names, inertia, strict=True)),
        elements=(
            ElementRow("Motor shaft", "shaft", names[0], names[1], k, damping=c),
            ElementRow("Mesh", "gear mesh", names[1], names[2]),
            ElementRow("Load shaft", "shaft", names[2], names[3], k, damping=c),
        ),
        meshes=(
            MeshRow(
                "Mesh", backlash=d["gap"], pitch_radius_drive=d["pitch_radius"],
                pitch_radius_driven=d["pitch_radius"], pressure_angle=d["pressure_angle"],
                mesh_stiffness=d["mesh_stiffness"],
            ),
        ),
        torque_time=(
            *(TorqueTimeRow(names[0], float(t), float(x)) for t, x in zip(time, torque, strict=True)),
            *(TorqueTimeRow(names[3], t, -d["mean_torque"]) for t in (0.0, DURATION)),
        ),
        maximum_time=DURATION,
    )  # fmt: skip


def pair_grid() -> Floats:
    """Times at which mesh forces are compared."""
    return np.arange(PAIR["settled"], DURATION - 2.0 * GRID, GRID)


def pair_reference(tolerance: float = 1e-11) -> Floats:
    """Mesh force on the grid by Dormand-Prince 8(5,3): the four equations of motion, from knot to knot.

    The contact is that of both programs, `F = k (δ ∓ b)` while flanks overlap; no code is shared with either.
    """
    from scipy.integrate import solve_ivp

    d = PAIR
    base = _base_radius()
    J = np.array([d[f"{n}_inertia"] for n in ("motor", "drive", "driven", "load")])
    k, beta, half = d["shaft_stiffness"], d["shaft_damping_time"], 0.5 * d["gap"]

    def force(y: Floats) -> Floats:
        overlap = base * (y[1] - y[2])
        return np.asarray(d["mesh_stiffness"] * (overlap - np.clip(overlap, -half, half)))

    time, torque = pair_knots()

    def motion(t: float, y: Floats) -> Floats:
        first = k * (y[0] - y[1] + beta * (y[4] - y[5]))
        last = k * (y[2] - y[3] + beta * (y[6] - y[7]))
        mesh = base * force(y)
        driving = np.interp(t, time, torque)
        moments = np.array([driving - first, first - mesh, mesh - last, last - d["mean_torque"]])
        return np.concatenate([y[4:], moments / J])

    y, grid = np.zeros(8), pair_grid()
    found = []
    for a, b in zip(time[:-1], time[1:], strict=True):
        inside = grid[(grid > a - 1e-9) & (grid < b - 1e-9)]
        done = solve_ivp(
            motion, (a, b), y, "DOP853", np.append(inside, b), rtol=tolerance, atol=1e-4 * tolerance
        )
        y = done.y[:, -1]
        found.append(force(done.y[:, :-1]))
    return np.concatenate(found)


def _our_force(start: Start) -> Floats:
    """Mesh force on the grid."""
    t = start.trajectory
    row = int(start.output_of_element[1])
    grid = pair_grid()
    # two samples share the time of an event: the last before a point, the first after it
    i = np.searchsorted(t.time, grid, side="right") - 1
    h, y, rate = t.time[i + 1] - t.time[i], t.torque[row], t.torque_rate[row]
    s = (grid - t.time[i]) / h
    rise, a, b = y[i + 1] - y[i], h * rate[i], h * rate[i + 1]
    force = y[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
    return np.asarray(force / _base_radius())


def compare_pair(
    workers: Sequence[Worker], rounds: int, quick: bool
) -> tuple[float, list[PairRow]]:
    """What the reference is worth, and both programs at rising accuracy against it."""
    reference = pair_reference()
    worth = _off(pair_reference(1e-9), reference)
    rows = list(_our_pair(reference, rounds))
    ross = next((w for w in workers if w.name == "ROSS"), None)
    if ross is not None:
        rows += _ross(ross, reference, quick)
    return worth, rows


def _off(force: Floats, reference: Floats) -> float:
    return float(np.max(np.abs(force - reference)) / np.max(np.abs(reference)))


def _our_pair(reference: Floats, rounds: int) -> Iterator[PairRow]:
    case = pair_case()
    model = analyse(case).reported
    effects = StartEffects(clearances=("Mesh",), coupled_damping=True)
    for tolerance in OUR_TOLERANCES:
        asked = replace(case, tolerance_peak=tolerance)
        linear = calculate_start(asked, model, StartEffects(), None)

        def whole(asked: Case = asked) -> Start:
            return alone(asked, calculate_start(asked, model, StartEffects(), None))

        def alone(asked: Case = asked, linear: Start = linear) -> Start:
            return calculate_start(asked, model, effects, linear)

        turns = {OURS: local(whole, 0.05, 20), EVENTS_ALONE: local(alone, 0.05, 20)}
        for label, done in interleave(turns, rounds).items():
            assert done.timing is not None
            force = _our_force(done.result)
            yield PairRow(
                label, f"tolerance {tolerance:g}", done.result.trajectory.n_steps,
                done.timing.seconds, _off(force, reference), float(force.max()), float(force.min()),
            )  # fmt: skip


def _ross(worker: Worker, reference: Floats, quick: bool) -> Iterator[PairRow]:
    grid = pair_grid()
    time, torque = pair_knots()
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "force.npy")

        def ask(step: float, duration: float) -> tuple[Floats, Floats, float]:
            said = worker.ask(
                "pair", variant="robust", step=step, duration=duration, knots=time.tolist(),
                torque=torque.tolist(), out=out, **PAIR,
            )  # fmt: skip
            at, force = np.load(out)
            return at, force, timing_of(said["laps"]).seconds

        try:
            ask(1e-4, 0.01)  # compiles
            for step in ROSS_STEPS[:2] if quick else ROSS_STEPS:
                at, force, seconds = ask(step, DURATION)
                found = np.interp(grid, at, force)
                yield PairRow(
                    THEIRS, f"step {1e6 * step:g} µs", len(at), seconds, _off(found, reference),
                    float(found.max()), float(found.min()),
                )  # fmt: skip
        except PeerFailed as wrong:
            yield PairRow(THEIRS, "", 0, *(4 * (math.nan,)), str(wrong))


def pair_points(rows: Sequence[PairRow]) -> dict[str, list[Point]]:
    """Error and time by program."""
    found: dict[str, list[Point]] = {}
    for r in rows:
        if r.failure is None:
            step = 1.0 / max(r.steps, 1)
            found.setdefault(r.label, []).append(Point(step, r.error, r.seconds))
    return found
