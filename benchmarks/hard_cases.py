"""The hard cases of tests/hard_cases, ours beside openTorsion's and ROSS's answers.

Frequencies: each program is given the table of inertias and stiffnesses and asked with its own
calls; the error is the largest of all frequencies it presents, rank by rank. Starts: no peer lets
torque follow speed, so each is given the torques of the reference's motor and load against time,
which is the harder half of the job, and calculates shaft torques from them. Clearances: neither
has a geared coupling or mesh with play in a torsional train driven by torques.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers import Absent, PeerFailed, Worker, start_peer
from benchmarks.problems import Chain
from benchmarks.references import exact_frequencies
from benchmarks.report import Section, Table, error
from tests.hard_cases.answers import (
    clearance_run,
    clearance_truth,
    compared,
    default_start,
    frequencies,
    start_truth,
)
from tests.hard_cases.corpus import (
    CLEARANCES,
    FREQUENCIES,
    STARTS,
    ClearanceCase,
    FrequencyCase,
    StartCase,
)

__all__ = ["HardRow", "hard_case_rows", "hard_case_sections"]

Floats = NDArray[np.float64]

#: Calls that present natural frequencies, the one named first in each program's documents first.
CALLS = {
    "openTorsion": ("undamped_modal_analysis", "modal_analysis", "eigenmodes"),
    "ROSS": ("sparse", "dense"),
}
SHOWN = {"sparse": "run_modal", "dense": "run_modal(sparse=False)"}
#: Interval of the torques that peers are given, and the most samples of one start.
SAMPLE, MOST_SAMPLES = 1e-4, 100_000
#: Longest wait for one answer of a peer. [s]
PATIENCE = 30.0
#: Beyond this a relative error is said as a factor.
WRONG = 0.5


@dataclass(frozen=True)
class HardRow:
    """One hard case.

    Parameters
    ----------
    kind, case : str
        ``frequencies``, ``start`` or ``clearance``, and its name. [text]
    ours, reported : float
        True error of our answer, and the error we reported (nan: none is reported). [1]
    seconds : float
        Wall time of our answer, once. [s]
    peers : dict of str to str
        Of each peer the error or how it fails, in words. [text]
    note : str
        What else our answer says about itself. [text]
    """

    kind: str
    case: str
    ours: float
    reported: float
    seconds: float
    peers: dict[str, str]
    note: str = ""


def hard_case_rows(workers: list[Worker], home: Path, *, quick: bool) -> Iterator[HardRow]:
    """Every case; `quick` leaves out what takes minutes. Stopped workers are replaced in the list."""
    for worker in workers:
        worker.patience = PATIENCE
    for hard in FREQUENCIES.values():
        yield _frequency_row(hard, workers)
        _revive(workers, home)
    with tempfile.TemporaryDirectory() as folder:
        for start in STARTS.values():
            if not (quick and start.costly):
                yield _start_row(start, workers, Path(folder))
                _revive(workers, home)
    for make in CLEARANCES.values():
        yield _clearance_row(make(), workers)


def _revive(workers: list[Worker], home: Path) -> None:
    """New workers for those that were stopped."""
    for i, worker in enumerate(workers):
        if worker.process.poll() is None:
            continue
        new = start_peer(worker.peer, home, install=False)
        if isinstance(new, Absent):
            raise RuntimeError(f"{worker.name} does not start again: {new.reason}")
        new.patience = PATIENCE
        workers[i] = new


# --- natural frequencies --------------------------------------------------------------------------


def _frequency_row(hard: FrequencyCase, workers: Sequence[Worker]) -> HardRow:
    chain = Chain(hard.name, hard.inertia, hard.stiffness, np.zeros(len(hard.stiffness)))
    began = time.perf_counter()
    ours = frequencies(hard)[1:]
    spent = time.perf_counter() - began
    exact = exact_frequencies(chain, ours) if hard.exact is None else hard.exact
    return HardRow(
        "frequencies",
        hard.name,
        float(np.max(np.abs(ours / exact - 1.0))),
        math.nan,
        spent,
        {w.name: _frequencies_of(w, chain, exact) for w in workers},
    )


def _frequencies_of(worker: Worker, chain: Chain, exact: Floats) -> str:
    """The first call's finding; if another call does better, that too."""
    try:
        worker.ask("load", budget=0.0, **chain.as_lists())
    except PeerFailed as wrong:
        return _failure("model", wrong)
    said, least = [], math.inf
    for call in CALLS[worker.name]:
        name = SHOWN.get(call, call)
        try:
            found = np.asarray(worker.ask("modes", variant=call, budget=0.0)["omega"], dtype=float)
        except PeerFailed as wrong:
            if "no longer running" not in str(wrong):
                said.append(_failure(f"`{name}`", wrong))
            continue
        n = min(len(found), len(exact))
        if not n or not np.all(np.isfinite(found[:n])):
            said.append(f"`{name}`: no finite frequency")
            continue
        worst = float(np.max(np.abs(found[:n] / exact[:n] - 1.0)))
        if not said or worst < least:
            few = f", {n} of {len(exact)} presented" if len(found) < len(exact) else ""
            said.append(f"`{name}`: {_wrong(worst)}{few}")
        least = min(least, worst)
    return "; ".join(said)


# --- starts ---------------------------------------------------------------------------------------


def _start_row(hard: StartCase, workers: Sequence[Worker], folder: Path) -> HardRow:
    began = time.perf_counter()
    start = default_start(hard).start
    spent = time.perf_counter() - began
    end = start.outcome.time
    interval = max(SAMPLE, end / MOST_SAMPLES)
    truth = start_truth(hard, end, sample=interval)
    found = compared(start, truth.maximum, truth.minimum)
    peers = {}
    if workers:
        step = float(truth.time[1])
        np.save(folder / "torques.npy", _on_stations(hard, truth.force))
        elastic = np.maximum(np.abs(truth.maximum), np.abs(truth.minimum))
        whole = np.maximum(np.abs(truth.tooth_maximum), np.abs(truth.tooth_minimum))
        peak = {"openTorsion": whole, "ROSS": elastic}
        peers = {w.name: _start_of(w, hard, step, peak[w.name], folder) for w in workers}
    note = start.outcome.outcome + ("" if start.met_tolerance else ", tolerance not met")
    if start.uncoupled_dampers:
        note += f", warns that {', '.join(start.uncoupled_dampers)} is too strong to be coupled"
    return HardRow(
        "start",
        hard.name,
        float(found.error.max()),
        float(found.reported.max()),
        spent,
        peers,
        note,
    )


def _on_stations(hard: StartCase, force: Floats) -> Floats:
    """Torques on the stations of the hard case, shape (n_times, n_stations).

    They act on the motor's and the loads' stations alone; the reference of a limit case has fewer
    stations, but as many of these, in the same order.
    """
    names = [s.station for s in hard.case.stations]
    theirs = [s.station for s in hard.truth.case.stations]

    def driven(case: Any) -> list[Any]:
        rows = (*case.motor_torque, *case.load_torque)
        return list(dict.fromkeys(r.station for r in rows))

    out = np.zeros((force.shape[1], len(names)))
    for mine, other in zip(driven(hard.case), driven(hard.truth.case), strict=True):
        out[:, names.index(mine)] = force[theirs.index(other)]
    return out


def _start_of(worker: Worker, hard: StartCase, step: float, peak: Floats, folder: Path) -> str:
    """Largest error of a peak torque, over all elements with a spring."""
    chain = Chain(
        hard.name,
        np.array([s.inertia for s in hard.case.stations]),
        np.array([e.stiffness for e in hard.case.elements]),
        np.array([e.damping or 0.0 for e in hard.case.elements]),
    )
    out = folder / "answer.npy"
    try:
        worker.ask("load", budget=0.0, **chain.as_lists())
        worker.ask("forced", step=step, torques=str(folder / "torques.npy"), out=str(out))
    except PeerFailed as wrong:
        return _failure("", wrong)
    high, low = np.load(out)
    if not np.all(np.isfinite(high)) or not np.all(np.isfinite(low)):
        return "not finite"
    springs = chain.stiffness > 0.0
    theirs = np.maximum(np.abs(high), np.abs(low))
    return _wrong(float(np.max(np.abs(theirs / peak - 1.0)[springs])))


# --- clearances -----------------------------------------------------------------------------------


def _clearance_row(hard: ClearanceCase, workers: Sequence[Worker]) -> HardRow:
    began = time.perf_counter()
    start, _ = clearance_run(hard)
    spent = time.perf_counter() - began
    truth = clearance_truth(hard)
    found = compared(start, truth.maximum, truth.minimum)
    reasons = {
        "openTorsion": "cannot run: no clearance",
        "ROSS": "cannot run: backlash only between gears of rotors at a prescribed speed",
    }
    counted = ", ".join(f"{c.impacts} impacts" for c in start.contacts)
    return HardRow(
        "clearance",
        hard.name,
        float(found.error.max()),
        float(found.reported.max()),
        spent,
        {w.name: reasons[w.name] for w in workers},
        counted + ("" if start.met_tolerance else ", tolerance not met"),
    )


# --- in words -------------------------------------------------------------------------------------


def _wrong(worst: float) -> str:
    if worst <= WRONG:
        return error(worst)
    return f"wrong by {100 * worst:.0f} %" if worst < 10.0 else f"wrong by a factor {worst:.0e}"


def _failure(what: str, wrong: PeerFailed) -> str:
    """First sentence of an exception, or that there was no answer in time."""
    if "without an answer" in str(wrong):
        return f"{what} no answer in {PATIENCE:g} s".strip()
    text = str(wrong).replace("|", "/").split(". ")[0]
    text = text if len(text) <= 90 else text[:87] + "…"
    return f"{what} fails: {text}".strip()


TITLES = {
    "frequencies": "Natural frequencies",
    "start": "Starts",
    "clearance": "Starts with clearance",
}
TEXTS = {
    "frequencies": "Largest relative error of all frequencies presented, rank by rank, against "
    "closed forms or Sturm counts bisected in 50-digit arithmetic. Of the peers the call their "
    "documents name first; another call is added where it does better. ROSS leaves out what it "
    "finds below 0.1 rad/s, and by default presents the lowest six; it has no table of inertias and "
    "stiffnesses, so the train is put together from its couplings, discs and one shaft without "
    "mass.",
    "start": "Relative error of the worst peak torque of all elements, against Dormand-Prince 8 in "
    "twists and speeds at a step far below every period. A link of 1e18 N·m/rad and hubs without "
    "weight are judged by their limit, which is exact to 1e-12. Ours starts from the tables and "
    "finds speed and torque together, with default settings. The peers know no torque that "
    f"follows speed: they are handed the reference's motor and load torques every {1e3 * SAMPLE:g} "
    f"ms (longer starts {MOST_SAMPLES:,} samples) and calculate shaft torques from them "
    "(openTorsion `dsim`, whose torques include the dampers' and are compared with such; ROSS "
    "`run_time_response`, k·Δθ), so that theirs is the error of the shaft "
    "torques alone.",
    "clearance": "Relative error of the worst peak torque, tooth forces with their damping. The peers "
    "were not called: what is said of them is what their documents offer.",
}


def hard_case_sections(
    rows: Sequence[HardRow], workers: Sequence[Worker], absent: Sequence[Absent]
) -> list[Section]:
    """The page: a section a kind."""
    versions = [
        f"{w.name} {next(iter(w.hello['versions'].values()))} (numpy {w.hello['versions']['numpy']})"
        for w in workers
    ] + [f"{a.name}: absent, {a.reason}" for a in absent]
    sections = [
        Section(
            "What this is",
            "The corpus of `tests/hard_cases`, each case with default settings. Made by `python -m "
            "benchmarks --hard-cases --write-docs`; every number and word of a failure is of that "
            f"run, but for the peers' columns under clearance. Peers: {'; '.join(versions)}.",
        )
    ]
    for kind, title in TITLES.items():
        of_it = [r for r in rows if r.kind == kind]
        if not of_it:
            continue
        reported = ("We report",) if kind != "frequencies" else ()
        columns = ("Case", "Our error", *reported, "s", *(w.name for w in workers), "Note")
        lines = tuple(
            (
                r.case,
                error(r.ours),
                *((error(r.reported),) if reported else ()),
                f"{r.seconds:.2g}",
                *(r.peers[w.name] for w in workers),
                r.note,
            )
            for r in of_it
        )
        if not any(r.note for r in of_it):
            columns, lines = columns[:-1], tuple(line[:-1] for line in lines)
        sections.append(Section(title, TEXTS[kind], (Table(title, columns, lines),)))
    return sections
