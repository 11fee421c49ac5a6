"""Natural frequencies: time of each program's own call, and its error against 50 digits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.measure import Timing, Turn, interleave, local
from benchmarks.ours import build_and_solve
from benchmarks.peers import PeerFailed, Worker
from benchmarks.problems import RIGID, Chain, random_chain, ten
from benchmarks.references import exact_frequencies
from engine.model.build_train import build_train
from engine.model.modes import modes_of

__all__ = ["ModesRow", "compare_modes", "mode_problems"]

OURS, OURS_ALL = "torsionbook modes", "torsionbook train and modes"
#: The calls of each peer that return natural frequencies.
CALLS = {
    "openTorsion": ("undamped_modal_analysis", "modal_analysis", "eigenmodes"),
    "ROSS": ("sparse", "dense"),
}


@dataclass(frozen=True)
class ModesRow:
    """One method on one train.

    Parameters
    ----------
    problem, method, program : str
        What was calculated, by which call, of which program. [text]
    timing : Timing or None
        Time of one call; None if it failed. [s]
    lowest_error, worst_error : float
        Relative error of the first frequency presented, and the largest of all presented. [1]
    presented, wanted : int
        Elastic frequencies presented, and those there are. [count]
    failure : str or None
        Why there is no result. [text]
    """

    problem: str
    method: str
    program: str
    timing: Timing | None
    lowest_error: float
    worst_error: float
    presented: int
    wanted: int
    failure: str | None = None


def mode_problems(quick: bool) -> list[Chain]:
    """10, 50 and 200 stations, and ten with one nearly rigid link."""
    sizes = (50,) if quick else (50, 200)
    return [ten(), *(random_chain(n) for n in sizes), ten(RIGID)]


def compare_modes(
    workers: Sequence[Worker], problems: Sequence[Chain], rounds: int
) -> Iterator[list[ModesRow]]:
    """Rows of one problem after the other."""
    for chain in problems:
        train = build_train(chain.case())
        exact = exact_frequencies(chain, modes_of(train).omega[1:])
        turns: dict[tuple[str, str], Turn] = {
            ("torsionbook", OURS): local(lambda train=train: modes_of(train).omega[1:]),
            ("torsionbook", OURS_ALL): local(lambda c=chain: build_and_solve(c).omega[1:]),
        }
        for worker in workers:
            try:
                built = worker.ask("load", budget=0.2, **chain.as_lists())
            except PeerFailed as wrong:
                yield [_failed(chain, worker.name, "model", str(wrong), len(exact))]
                continue
            turns[worker.name, "building the model"] = _once(built["laps"])
            for call in CALLS[worker.name]:
                turns[worker.name, call] = _asking(worker, call)
        named = {f"{program}|{method}": turn for (program, method), turn in turns.items()}
        rows = []
        for name, measured in interleave(named, rounds).items():
            program, method = name.split("|")
            if measured.failure is not None:
                rows.append(_failed(chain, program, method, measured.failure, len(exact)))
                continue
            found = np.asarray(measured.result if measured.result is not None else [])
            n = min(len(found), len(exact))
            error = np.abs(found[:n] / exact[:n] - 1.0)
            lowest, worst = (float(error[0]), float(error.max())) if n else (np.nan, np.nan)
            rows.append(
                ModesRow(
                    chain.name,
                    _shown(program, method),
                    program,
                    measured.timing,
                    lowest,
                    worst,
                    len(found),
                    len(exact),
                )  # fmt: skip
            )
        yield rows


def _asking(worker: Worker, call: str) -> Turn:
    def turn() -> tuple[object, list[list[float]]]:
        answer = worker.ask("modes", variant=call, budget=0.05)
        return answer["omega"], answer["laps"]

    return turn


def _once(laps: list[list[float]]) -> Turn:
    """Laps already measured; building a model is not repeated in every round."""
    return lambda: (None, laps)


def _shown(program: str, method: str) -> str:
    if program == "torsionbook":
        return method
    if program == "ROSS" and method in CALLS["ROSS"]:
        method = f"run_modal, {method}" + (" (its default)" if method == "sparse" else "")
    return f"{program} {method}"


def _failed(chain: Chain, program: str, method: str, why: str, wanted: int) -> ModesRow:
    return ModesRow(
        chain.name, _shown(program, method), program, None, np.nan, np.nan, 0, wanted, why
    )
