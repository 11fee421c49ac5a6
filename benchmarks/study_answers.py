"""What the tolerance study found: answers beside true ones, by class of train."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

Record = dict[str, Any]
#: A run that says so is tried until a peak changes by more than the tolerance, so often at the most: such a
#: change may be one in twenty.
MOST_NUDGES = 30
#: A truth whose step is not below this share of the answer's is not finer.
NO_FINER = 0.75
#: Torque below this share of the train's largest is rounding.
NOTHING = 1e-9


@dataclass(frozen=True)
class Answer:
    """One reported answer beside its truth: a peak torque, or the starts of a shaft.

    Parameters
    ----------
    number : int
        Train. [1]
    element, kind : str
        Where; ``peak`` or ``starts``. [words]
    tolerance, stated, true : float
        Relative errors: wanted, reported, found. [1]
    resolved : bool
        False where the truth was calculated at the very step of the answer (both had refined as
        far as they may): nothing is said of the estimate then. [flag]
    """

    number: int
    element: str
    kind: str
    tolerance: float
    stated: float
    true: float
    resolved: bool = True

    @property
    def within(self) -> bool:
        """Whether the tolerance is honoured. [flag]"""
        return self.true <= self.tolerance

    @property
    def ratio(self) -> float:
        """Reported error over the true one; infinite where there is none. [1]"""
        return self.stated / self.true if self.true > 0.0 else math.inf


@dataclass(frozen=True)
class ClassSummary:
    """One class of trains.

    Parameters
    ----------
    name : str
        Class. [words]
    trains, answers, within : int
        How many, and how many answers are within their tolerance. [count]
    ratio : float
        Median of reported over true error. [1]
    worst : Answer or None
        Largest true error over its tolerance. [1]
    """

    name: str
    trains: int
    answers: int
    within: int
    ratio: float
    worst: Answer | None

    @property
    def share(self) -> float:
        """Share of the answers that are within. [1]"""
        return self.within / self.answers if self.answers else 1.0


@dataclass(frozen=True, eq=False)
class Study:
    """What the whole study found.

    Parameters
    ----------
    records : list of dict
        Everything of every train.
    answers, independent : list of Answer
        Against the hundredfold finer run, and against the independent integrator; without trains
        that say they are sensitive.
    sensitive : list of int
        Trains that say so. [numbers]
    felt, unfelt : list of int
        Of those the ones that a billionth did change by more than their tolerance; and trains that
        do not say so although it did. [numbers]
    failed : list of dict
        Trains that raised.
    """

    records: list[Record]
    answers: list[Answer]
    independent: list[Answer]
    sensitive: list[int]
    felt: list[int]
    unfelt: list[int]
    failed: list[Record]

    @property
    def events(self) -> int:
        """Trains whose start has events. [count]"""
        return sum(1 for r in self.records if "failed" not in r and r["asked"]["events"])


def summary_of(records: list[Record]) -> Study:
    """Judge the records."""
    found = Study(records, [], [], [], [], [], [r for r in records if "failed" in r])
    for r in records:
        if "failed" in r:
            continue
        says = bool((r["asked"]["sensitivity"] or {}).get("sensitive", False))
        felt = change_under_nudges(r) > r["tolerance"][0]
        if says:
            found.sensitive.append(r["number"])
            if felt:
                found.felt.append(r["number"])
            continue
        if felt:
            found.unfelt.append(r["number"])
        resolved = r["truth"]["step"] <= NO_FINER * r["asked"]["step"]
        found.answers.extend(replace(a, resolved=resolved) for a in _beside(r, r["truth"]))
        if r.get("independent"):
            found.independent.extend(_peaks(r, r["independent"]["peaks"]))
    return found


def change_under_nudges(record: Record) -> float:
    """Largest relative change of a peak under a billionth."""
    return max(
        (a.true for other in record.get("nudged", []) for a in _peaks(record, other["peaks"])),
        default=0.0,
    )


def _peaks(record: Record, truth: dict[str, Sequence[float]]) -> list[Answer]:
    """Peaks of a record beside true ones. Torques that are only rounding say nothing."""
    largest = max(max(abs(p[0]), abs(p[1])) for p in truth.values())
    found = []
    for element, (high, low, error) in record["asked"]["peaks"].items():
        if element not in truth:
            continue
        size = max(abs(truth[element][0]), abs(truth[element][1]))
        if size <= NOTHING * largest:
            continue
        off = max(abs(high - truth[element][0]), abs(low - truth[element][1]))
        tolerance = record["tolerance"][0]
        found.append(Answer(record["number"], element, "peak", tolerance, error / size, off / size))
    return found


def _beside(record: Record, truth: Record) -> list[Answer]:
    """Every answer of a record beside those of the finer run."""
    found = _peaks(record, truth["peaks"])
    for element, (starts, error) in record["asked"]["starts"].items():
        true = truth["starts"][element][0]
        if starts is None and true is None:
            continue  # unlimited is right, and has no error
        off = abs(starts / true - 1.0) if starts is not None and true is not None else math.inf
        tolerance = record["tolerance"][1]
        found.append(Answer(record["number"], element, "starts", tolerance, error or 0.0, off))
    return found


def classes_of(found: Study) -> list[ClassSummary]:
    """Shares and ratios by class of train, kind of answer and tolerance."""
    by_number = {r["number"]: r for r in found.records if "failed" not in r}

    def of(name: str, chosen: list[Answer]) -> ClassSummary:
        ratios = [a.ratio for a in chosen if a.resolved]
        return ClassSummary(
            name,
            len({a.number for a in chosen}),
            len(chosen),
            sum(a.within for a in chosen),
            float(np.median(ratios)) if ratios else math.nan,
            max(chosen, key=lambda a: a.true / a.tolerance, default=None),
        )

    rows = [of("all", found.answers)]
    for kind in ("peak", "starts"):
        for events, words in ((False, "linear"), (True, "with events")):
            chosen = [
                a
                for a in found.answers
                if a.kind == kind and by_number[a.number]["asked"]["events"] == events
            ]
            rows.append(of(f"{kind}, {words}", chosen))
    for extra in (
        "bearings",
        "dampers",
        "coupled damping",
        "breaker closing",
        "several clearances",
    ):
        chosen = [a for a in found.answers if extra in by_number[a.number]["extras"]]
        rows.append(of(f"with {extra}", chosen))
    for tolerance in (1e-2, 1e-3, 1e-4):
        chosen = [a for a in found.answers if by_number[a.number]["tolerance"][0] == tolerance]
        rows.append(of(f"tolerance of peaks {tolerance:g}", chosen))
    for events, words in ((False, "linear"), (True, "with events")):
        chosen = [a for a in found.independent if by_number[a.number]["asked"]["events"] == events]
        rows.append(of(f"independent integrator, {words}", chosen))
    return rows
