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
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow, TorqueTimeRow
from engine.case.effect import StartEffects
from engine.model.modal_analysis import analyse
from engine.run import calculate_start
from engine.start.start import Start

__all__ = [
    "PAIR", "PairRow", "StartBeside", "compare_pair", "compare_starts_with_events", "pair_case",
    "pair_points",
]  # fmt: skip

Floats = NDArray[np.float64]

# --- beside the linear start ----------------------------------------------------------------------

#: Teeth of the example's mesh: normal stiffness, damping, backlash; the gears' bearings. [SI]
MESH_STIFFNESS, MESH_DAMPING, BACKLASH = 4e9, 2e5, 4e-4
PITCH_RADIUS, HELIX_ANGLE, ORIENTATION = 0.6, 0.2, 0.3
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

#: A gear pair that both programs can calculate: ratio 1, a shaft behind each gear, each gear on its
#: bearing. Torque at both ends; that of the motor swings so that the teeth part. [SI]
PAIR: dict[str, float] = {
    "motor_inertia": 20.0, "drive_inertia": 2.0, "driven_inertia": 2.0, "load_inertia": 20.0,
    "shaft_stiffness": 2e6, "pitch_radius": 0.2, "pressure_angle": math.radians(20.0),
    "mesh_stiffness": 5e8, "mesh_damping_ratio": 0.05, "gap": 2e-4,
    "drive_mass": 100.0, "driven_mass": 100.0, "bearing_stiffness": 5e8, "bearing_damping": 2e4,
    "mean_torque": 300.0, "swing_torque": 2000.0, "omega": 2.0 * math.pi * 45.0, "speed": 100.0,
}  # fmt: skip
#: The torque is straight between knots this far apart, for both programs. [s]
KNOTS = 1e-3
#: Errors are taken over the first stretch; ours goes on, since its time goes to setting up else. [s]
DURATION, OUR_DURATION, GRID = 0.1, 1.0, 1e-4
ROSS_STEPS, ROSS_REFERENCE = (1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 1e-6), 2.5e-7
OUR_TOLERANCES, OUR_REFERENCE = (1e-1, 1e-3, 1e-5), 1e-7
OURS, THEIRS = "torsionbook, events", "ROSS, robust"


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
        Wall time of a simulated second. [s]
    error : float
        Largest difference of the mesh force from this program's own finest run, over the largest.
        [1]
    peak : float
        Largest mesh force of the run. [N]
    failure : str or None
        Why there is none. [sentence]
    """

    label: str
    setting: str
    steps: int
    seconds: float
    error: float
    peak: float
    failure: str | None = None


def pair_case() -> Case:
    """The gear pair as we take it."""
    d = PAIR
    time = np.arange(0.0, OUR_DURATION + KNOTS, KNOTS)
    torque = d["mean_torque"] + d["swing_torque"] * np.cos(d["omega"] * time)
    base = d["pitch_radius"] * math.cos(d["pressure_angle"])
    mass = 0.5 * d["drive_inertia"] / base**2
    damping = 2.0 * d["mesh_damping_ratio"] * math.sqrt(d["mesh_stiffness"] * mass)
    names = ("Motor", "Drive gear", "Driven gear", "Load")
    inertia = [d[f"{n}_inertia"] for n in ("motor", "drive", "driven", "load")]
    k, c = d["bearing_stiffness"], d["bearing_damping"]
    return Case(
        stations=tuple(StationRow(n, None, J) for n, J in zip(names, inertia, strict=True)),
        elements=(
            ElementRow("Motor shaft", "shaft", names[0], names[1], d["shaft_stiffness"]),
            ElementRow("Mesh", "gear mesh", names[1], names[2]),
            ElementRow("Load shaft", "shaft", names[2], names[3], d["shaft_stiffness"]),
        ),
        meshes=(
            MeshRow(
                "Mesh", backlash=d["gap"], pitch_radius_drive=d["pitch_radius"],
                pitch_radius_driven=d["pitch_radius"], pressure_angle=d["pressure_angle"],
                mesh_stiffness=d["mesh_stiffness"], mesh_damping=damping,
                mass_drive=d["drive_mass"], mass_driven=d["driven_mass"],
                bearing_stiffness_drive=k, bearing_stiffness_driven=k,
                bearing_damping_drive=c, bearing_damping_driven=c,
            ),
        ),
        torque_time=(
            *(TorqueTimeRow(names[0], float(t), float(x)) for t, x in zip(time, torque, strict=True)),
            *(TorqueTimeRow(names[3], t, -d["mean_torque"]) for t in (0.0, float(time[-1]))),
        ),
        maximum_time=OUR_DURATION,
    )  # fmt: skip


def _our_force(start: Start) -> tuple[Floats, float]:
    """Mesh force on the grid, and its largest value."""
    base = PAIR["pitch_radius"] * math.cos(PAIR["pressure_angle"])
    t = start.trajectory
    row = int(start.output_of_element[1])
    grid = np.arange(0.0, DURATION - 2.0 * GRID, GRID)
    # two samples share the time of an event: the last before a point, the first after it
    i = np.searchsorted(t.time, grid, side="right") - 1
    h, y, rate = t.time[i + 1] - t.time[i], t.torque[row], t.torque_rate[row]
    s = (grid - t.time[i]) / h
    rise, a, b = y[i + 1] - y[i], h * rate[i], h * rate[i + 1]
    force = y[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
    peak = next(p for p in start.peaks if p.element == "Mesh").maximum
    return force / base, peak / base


def compare_pair(workers: Sequence[Worker], rounds: int, quick: bool) -> Iterator[PairRow]:
    """Both programs at rising accuracy, each against its own finest run."""
    case = pair_case()
    model = analyse(case).reported
    effects = StartEffects(clearances=("Mesh",))
    # the reference is finer than what may be typed
    finest = replace(CaseData(**vars(case)), tolerance_peak=OUR_REFERENCE)
    linear = calculate_start(finest, model, StartEffects(), None)
    exact, _ = _our_force(calculate_start(finest, model, effects, linear))
    for tolerance in OUR_TOLERANCES:
        asked = replace(case, tolerance_peak=tolerance)
        linear = calculate_start(asked, model, StartEffects(), None)
        run = local(lambda c=asked, s=linear: calculate_start(c, model, effects, s), 0.05, 20)
        done = interleave({"": run}, rounds)[""]
        assert done.timing is not None
        force, peak = _our_force(done.result)
        error = float(np.max(np.abs(force - exact)) / np.max(np.abs(exact)))
        steps = done.result.trajectory.n_steps
        yield PairRow(
            OURS, f"tolerance {tolerance:g}", steps, done.timing.seconds / OUR_DURATION, error, peak
        )
    ross = next((w for w in workers if w.name == "ROSS"), None)
    if ross is not None:
        yield from _ross(ross, quick)


def _ross(worker: Worker, quick: bool) -> Iterator[PairRow]:
    grid = np.arange(0.0, DURATION - 2.0 * GRID, GRID)
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "force.npy")

        def ask(step: float) -> tuple[Floats, Floats, float]:
            said = worker.ask(
                "pair", variant="robust", step=step, duration=DURATION, knots=KNOTS, out=out, **PAIR
            )
            time, force = np.load(out)
            return time, force, timing_of(said["laps"]).seconds

        try:
            ask(1e-3)  # compiles
            steps = ROSS_STEPS[:2] if quick else ROSS_STEPS
            time, force, _ = ask(1e-5 if quick else ROSS_REFERENCE)
        except PeerFailed as wrong:
            yield PairRow(THEIRS, "", 0, math.nan, math.nan, math.nan, str(wrong))
            return
        exact = np.interp(grid, time, force)
        for step in steps:
            time, force, seconds = ask(step)
            off = float(
                np.max(np.abs(np.interp(grid, time, force) - exact)) / np.max(np.abs(exact))
            )
            yield PairRow(
                THEIRS, f"step {step:g} s", len(time), seconds / DURATION, off, float(force.max())
            )


def pair_points(rows: Sequence[PairRow]) -> dict[str, list[Point]]:
    """Error and time by program."""
    found: dict[str, list[Point]] = {}
    for r in rows:
        if r.failure is None:
            step = 1.0 / max(r.steps, 1)
            found.setdefault(r.label, []).append(Point(step, r.error, r.seconds))
    return found
