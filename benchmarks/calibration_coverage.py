"""How often the intervals of a calibration hold the truth: `make calibration-study`.

A random train is what the engineer typed. A second one, drawn from the spreads that table `Scatter`
states, is the machine: its lowest natural frequencies, with an error drawn from the stated
uncertainty, are what was measured. The intervals of the calibration must then hold the machine's
quantities in 95 % of all cases. Every case is drawn from its own number.

    python -m benchmarks.calibration_coverage --cases 1000
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.case.case import Case
from engine.case.data import ElementRow, StationRow
from engine.case.study_inputs import MeasuredFrequencyRow, ScatterRow, StudyInputs
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.studies.calibration.calibration import calibrate
from engine.studies.calibration.inputs import plan_calibration
from engine.studies.scatter import DISTRIBUTIONS, FROM_TO, changes_of
from engine.studies.variation import varied_case

#: Modes measured and their uncertainty, of each class. [count, 1]
CLASSES = {
    "few modes, small noise": (3, 0.002),
    "few modes, large noise": (3, 0.02),
    "many modes, small noise": (10, 0.002),
    "many modes, large noise": (10, 0.02),
}
#: A wrong measurement is wrong by so many of its standard deviations, uncertain quantities included.
WRONG = (8.0, 20.0)


@dataclass(frozen=True)
class Trial:
    """One machine, what was typed of it and what was measured."""

    case: Case  #: As typed. [SI]
    inputs: StudyInputs  #: Scatter and measurements. [SI]
    truth: dict[tuple[str, str], float]  #: Quantity and name → its factor in the machine. [1]


def trial(
    name: str, number: int, *, noise: float = 1.0, alike: bool = False, stated: bool | None = None
) -> Trial:
    """One trial of a class, drawn from its number alone.

    Parameters
    ----------
    name : str
        One of `CLASSES`. [word]
    number : int
        Seed. [count]
    noise : float, optional
        Actual noise over the stated one. [1]
    alike : bool, optional
        A chain that is its own mirror image. [flag]
    stated : bool, optional
        Whether the modes are stated; default in half of the trials. [flag]

    Returns
    -------
    Trial
        What the engineer has, and the truth. [SI]
    """
    modes, uncertainty = CLASSES[name]
    rng = np.random.default_rng([list(CLASSES).index(name), number, int(alike)])
    stations = modes + 1 + int(rng.integers(0, 3))
    case = _mirrored(rng, stations) if alike else _train(rng, stations)
    inputs = StudyInputs(scatter=_scatter(rng, case, alike))
    factors = plan_calibration(case, inputs).factors
    values = [float(f.at(rng.random())) for f in factors]
    machine = varied_case(case, changes_of(factors, values))
    frequency = _elastic(machine)[:modes]
    measured = frequency * (1.0 + noise * uncertainty * rng.normal(size=len(frequency)))
    said = rng.random() < 0.5
    stated = said if stated is None else stated
    rows = tuple(
        MeasuredFrequencyRow(i + 1 if stated else None, float(f), uncertainty)
        for i, f in enumerate(measured)
    )
    truth = {(f.quantity, ", ".join(f.names)): v for f, v in zip(factors, values, strict=True)}
    return Trial(case, replace(inputs, measured_frequencies=rows), truth)


def _elastic(case: Any) -> Any:
    train = build_train(case, {}, lateral=False)
    return modes_of(train).elastic_frequency


def _train(rng: np.random.Generator, n: int) -> Case:
    """A chain, in a third of the trains with branches; shafts and couplings of two decades."""
    branched = rng.random() < 0.3
    parents = [
        i - 1 if not branched or rng.random() < 0.8 else int(rng.integers(0, i))
        for i in range(1, n)
    ]
    inertia = 10.0 ** rng.uniform(0.0, 1.3, n)
    stiffness = 10.0 ** rng.uniform(5.5, 7.5, n - 1)
    return _case(inertia, stiffness, parents)


def _mirrored(rng: np.random.Generator, n: int) -> Case:
    inertia = 10.0 ** rng.uniform(0.0, 1.3, n)
    stiffness = 10.0 ** rng.uniform(5.5, 7.5, n - 1)
    return _case(
        np.sqrt(inertia * inertia[::-1]),
        np.sqrt(stiffness * stiffness[::-1]),
        list(range(n - 1)),
    )


def _case(inertia: Any, stiffness: Any, parents: list[int]) -> Case:
    return Case(
        stations=tuple(StationRow(f"S{i + 1}", None, float(j)) for i, j in enumerate(inertia)),
        elements=tuple(
            ElementRow(f"K{i + 1}", "coupling", f"S{p + 1}", f"S{i + 2}", float(k))
            for i, (p, k) in enumerate(zip(parents, stiffness, strict=True))
        ),
        line_frequency=60.0,
        poles=4,
    )


def _scatter(rng: np.random.Generator, case: Case, alike: bool) -> tuple[ScatterRow, ...]:
    """Blank, or every stiffness by 3 to 10 %, some by more, and some inertias by 1 to 3 %."""
    if rng.random() < 0.3:
        return ()
    rows = [ScatterRow(None, "stiffness", "normal", float(rng.uniform(0.03, 0.10)))]
    for e in case.elements:
        if rng.random() < 0.25 and not alike:
            rows.append(_row(rng, str(e.element), "stiffness", float(rng.uniform(0.05, 0.20))))
    if rng.random() < 0.33:
        rows.append(ScatterRow(None, "inertia", "normal", float(rng.uniform(0.01, 0.03))))
    return tuple(rows)


def _row(rng: np.random.Generator, name: str, quantity: str, spread: float) -> ScatterRow:
    kind = str(rng.choice(DISTRIBUTIONS))
    if kind == FROM_TO:
        return ScatterRow(name, quantity, kind, None, 1.0 - spread, 1.0 + 1.5 * spread)
    return ScatterRow(name, quantity, kind, spread)


# --- what became of a trial -----------------------------------------------------------------------


def coverage(name: str, number: int, *, alike: bool = False) -> dict[str, float]:
    """How many intervals of one trial hold the truth, of those that are given."""
    one = trial(name, number, alike=alike)
    began = time.process_time()
    found = calibrate(one.case, one.inputs)
    seconds = time.process_time() - began
    held = [
        p.change_low <= one.truth[p.quantity, p.name] - 1.0 <= p.change_high
        for p in (found.parameters if found.intervals_hold else ())
    ]
    return {
        "held": sum(held),
        "rows": len(held),
        "more unknowns": len(found.parameters) > len(found.measurements),
        "determined": sum(p.determined == "determined" for p in found.parameters),
        "explained": found.explained is True,
        "contradicted": found.explained is False,
        "solutions": max((s.solution for s in found.solutions), default=1),
        "mirror": "Mirror solution" in found.sentence,
        "seconds": seconds,
    }


def mirrored(name: str, number: int) -> dict[str, float]:
    """A train that is its own mirror image."""
    return coverage(name, number, alike=True)


def wrong(name: str, number: int) -> dict[str, float]:
    """One measurement of a stated mode is wrong: whether that is said, and of which one."""
    one = trial(name, number, stated=True)
    rows = list(one.inputs.measured_frequencies)
    rng = np.random.default_rng([99, number])
    i = int(rng.integers(len(rows)))
    others = replace(one.inputs, measured_frequencies=(*rows[:i], *rows[i + 1 :]))
    expected = next(f for f in calibrate(one.case, others).frequencies if f.mode == i + 1)
    deviation = math.hypot(expected.posterior_deviation, rows[i].uncertainty or 0.0)
    error = deviation * float(rng.uniform(*WRONG)) * float(rng.choice([-1.0, 1.0]))
    rows[i] = replace(rows[i], frequency=expected.after * math.exp(error))
    found = calibrate(one.case, replace(one.inputs, measured_frequencies=tuple(rows)))
    row = found.measurements[i]
    return {
        "named": not row.used or row.explained is False,
        "explained": row.explained is True or found.explained is True,
        "contradicted": found.explained is False,
    }


def noisy(name: str, number: int) -> dict[str, float]:
    """Noise of ten times the stated one."""
    one = trial(name, number, noise=10.0)
    found = calibrate(one.case, one.inputs)
    return {
        "more unknowns": len(found.parameters) > len(found.measurements),
        "said": "The misfit cannot be judged" in found.sentence,
        "explained": found.explained is True,
        "contradicted": found.explained is False,
    }


#: What is measured; the first is the coverage.
STUDIES = {"coverage": coverage, "mirrored": mirrored, "wrong": wrong, "noisy": noisy}


def answer(task: tuple[str, str, int]) -> dict[str, float]:
    """One trial of a study and class."""
    study, name, number = task
    return {k: float(v) for k, v in STUDIES[study](name, number).items()}


def results(
    study: str, classes: Iterable[str], numbers: Iterable[int], processes: int
) -> Iterator[tuple[str, Any]]:
    """Class by class, what was counted in each trial."""
    with multiprocessing.get_context("fork").Pool(processes) as pool:
        for name in classes:
            rows = pool.map(answer, [(study, name, number) for number in numbers], chunksize=4)
            yield name, {key: np.array([row[key] for row in rows]) for key in rows[0]}


def line(study: str, name: str, found: Any) -> str:
    """A row of the record."""
    n = len(next(iter(found.values())))
    if study in ("coverage", "mirrored"):
        held, rows = found["held"].sum(), found["rows"].sum()
        spread = np.std(found["held"] - held / rows * found["rows"]) * math.sqrt(n) / rows
        short = found["more unknowns"] > 0.0
        last = (
            f"{found['mirror'].sum():.0f}"
            if study == "mirrored"
            else f"{found['determined'][short].sum():.0f} of {found['rows'][short].sum():.0f}"
        )
        return (
            f"| {name} | {n} | {rows:.0f} | {held / rows:.1%} ± {spread:.1%} | "
            f"{(found['solutions'] > 1).sum()} | {last} | {found['contradicted'].sum():.0f} | "
            f"{np.median(found['seconds']):.2f} s |"
        )
    if study == "wrong":
        return (
            f"| {name} | {n} | {found['named'].sum() / n:.1%} | "
            f"{found['contradicted'].sum() / n:.1%} | {found['explained'].sum():.0f} |"
        )
    short = found["more unknowns"] > 0.0
    said = (found["said"] + found["contradicted"])[short]
    return (
        f"| {name} | {short.sum()} | {found['said'][short].sum():.0f} | "
        f"{found['contradicted'][short].sum():.0f} | {found['explained'][short].sum():.0f} | "
        f"{(said == 0).sum()} |"
    )


HEADINGS = {
    "coverage": "| class | trials | intervals | hold the truth | several solutions | determined where unknowns outnumber measurements | contradicted | processor time |",
    "mirrored": "| class | trials | intervals | hold the truth | several solutions | mirror named | contradicted | processor time |",
    "wrong": "| class | trials | named | contradicted | explained |",
    "noisy": "| class | trials | misfit cannot be judged | not explained | explained | neither |",
}


def main() -> None:
    """Measure, and print the tables of the record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--study", choices=STUDIES, action="append")
    parser.add_argument("--class", dest="classes", choices=CLASSES, action="append")
    asked = parser.parse_args()
    for study in asked.study or STUDIES:
        cases = asked.cases if study == "coverage" else max(asked.cases // 5, 1)
        heading = HEADINGS[study]
        print(f"\n{heading}\n|{'---|' * (heading.count('|') - 1)}", flush=True)
        numbers, classes = range(asked.first, asked.first + cases), asked.classes or CLASSES
        for name, found in results(study, classes, numbers, asked.processes):
            print(line(study, name, found), flush=True)


if __name__ == "__main__":
    main()
