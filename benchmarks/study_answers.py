"""What the tolerance study found: answers beside true ones, by class of train."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

Record = dict[str, Any]
#: A run that says it is sensitive is repeated so often.
SENSITIVE_NUDGES = 100
#: A truth whose step is not below this share of the answer's is not finer.
NO_FINER = 0.75
#: Two answers that differ by no more are the same. [1]
ROUNDING = 1e-9
#: Torque below this share of the train's largest is rounding.
NOTHING = 1e-9


@dataclass(frozen=True)
class Answer:
    """One statement beside its truth.

    Parameters
    ----------
    number : int
        Train. [1]
    element, kind : str
        Where; ``peak``, ``starts``, ``recontact`` speed, or ``bound`` of an effect left out. [words]
    tolerance, true : float
        Relative errors: wanted, found. [1]
    stated : float or None
        What is stated of the error, effects left out included; None = no bound. [1]
    resolved : bool
        False where the truth was calculated at the very step of the answer (both had refined as
        far as they may): nothing is said of the estimate then. [flag]
    """

    number: int
    element: str
    kind: str
    tolerance: float
    stated: float | None
    true: float
    resolved: bool = True

    @property
    def within(self) -> bool:
        """Whether the tolerance is honoured. [flag]"""
        return self.true <= self.tolerance

    @property
    def holds(self) -> bool:
        """Whether the true error is at most the stated one. [flag]"""
        return self.stated is not None and self.true <= self.stated * (1.0 + ROUNDING) + ROUNDING

    @property
    def ratio(self) -> float:
        """Stated error over the true one; infinite where there is none. [1]"""
        return (self.stated or 0.0) / self.true if self.true > 0.0 else math.inf


@dataclass(frozen=True)
class Repeated:
    """One answer of a sensitive start beside one of its repetitions."""

    number: int  #: Train.
    element: str  #: Where.
    kind: str  #: ``peak``, ``extremes`` or ``starts``.
    inside: bool  #: Whether the repetition is within the range, or the error, that was told.


@dataclass(frozen=True)
class ClassSummary:
    """One class of trains.

    Parameters
    ----------
    name : str
        Class. [words]
    trains, answers, hold, within, unbounded : int
        Trains; answers; how many of their statements hold; how many are within their tolerance; how many
        more have no bound. [count]
    ratio : float
        Median of stated over true error. [1]
    worst : Answer or None
        Largest true error over the stated one. [1]
    """

    name: str
    trains: int
    answers: int
    hold: int
    within: int
    unbounded: int
    ratio: float
    worst: Answer | None

    @property
    def share(self) -> float:
        """Share of the statements that hold. [1]"""
        return self.hold / self.answers if self.answers else 1.0


@dataclass(frozen=True, eq=False)
class Study:
    """What the whole study found.

    Parameters
    ----------
    records, failed : list of dict
        Everything of every train, and of those that raised.
    answers, recontacts, independent, bounds : list of Answer
        Against the hundredfold finer run with all effects (peaks and starts; recontact speeds), and against the
        independent integrator, without trains that say they are sensitive; and bounds of effects left out.
    repeated : list of Repeated
        Answers of sensitive trains beside those of their repetitions.
    sensitive : list of int
        Trains that say so. [numbers]
    felt, unfelt : list of int
        Of those the ones that a billionth did change by more than their tolerance; and trains that
        do not say so although it did. [numbers]
    stopped, untold : list of int
        Trains whose run was stopped before its end and said so; and trains of whose truth the same holds, so
        that there is none. [numbers]
    """

    records: list[Record]
    failed: list[Record]
    answers: list[Answer] = field(default_factory=list)
    recontacts: list[Answer] = field(default_factory=list)
    independent: list[Answer] = field(default_factory=list)
    bounds: list[Answer] = field(default_factory=list)
    repeated: list[Repeated] = field(default_factory=list)
    sensitive: list[int] = field(default_factory=list)
    felt: list[int] = field(default_factory=list)
    unfelt: list[int] = field(default_factory=list)
    stopped: list[int] = field(default_factory=list)
    untold: list[int] = field(default_factory=list)

    @property
    def events(self) -> int:
        """Trains whose start has events. [count]"""
        return sum(1 for r in self.records if "failed" not in r and r["asked"]["events"])


def summary_of(records: list[Record]) -> Study:
    """Judge the records."""
    found = Study(records, [r for r in records if "failed" in r])
    for r in records:
        if "failed" in r:
            continue
        if r["asked"]["stopped"]:
            found.stopped.append(r["number"])
            continue
        says = bool((r["asked"]["sensitivity"] or {}).get("sensitive", False))
        felt = change_under_nudges(r) > r["tolerance"][0]
        if says:
            found.sensitive.append(r["number"])
            if felt:
                found.felt.append(r["number"])
            found.repeated.extend(_repeated(r))
            continue
        if felt:
            found.unfelt.append(r["number"])
        if r["truth"]["stopped"]:
            found.untold.append(r["number"])
            continue
        resolved = r["truth"]["step"] <= NO_FINER * r["asked"]["step"]
        found.answers.extend(replace(a, resolved=resolved) for a in _beside(r, r["truth"]))
        found.recontacts.extend(replace(a, resolved=resolved) for a in _recontacts(r))
        for effect, peaks in r.get("bounds", {}).items():
            for element, (bound, change) in peaks.items():
                at = f"{element}: {effect}"
                found.bounds.append(Answer(r["number"], at, "bound", bound, bound, change))
        if r.get("independent"):
            found.independent.extend(_peaks(r, r["independent"]["peaks"]))
    return found


def all_hold(record: Record) -> bool:
    """Whether every statement of one record holds, beside the truths that it has. [flag]"""
    found = summary_of([record])
    every = (*found.answers, *found.recontacts, *found.independent, *found.bounds)
    return not found.unfelt and all(a.holds for a in every if a.stated is not None)


def sensitive_answers(records: Sequence[Record], kind: str) -> tuple[int, int, int]:
    """Answers (``peaks`` or ``starts``) of starts with events whose range reaches beyond the tolerance; that did
    change by more in a repetition of a start that says it is sensitive; all of them.

    A start is sensitive where one answer is: others of it may be told to within the tolerance.
    """
    beyond = changed = count = 0
    for r in records:
        if "failed" in r or not r["asked"]["events"]:
            continue
        tolerance = r["tolerance"][0 if kind == "peaks" else 1]
        says = bool((r["asked"]["sensitivity"] or {}).get("sensitive", False))
        for element, (high, low, *_, least, most) in r["asked"][kind].items():
            count += 1
            told = _told(kind, high, low)
            if not says or not told:
                continue
            if least is not None:
                reach = math.inf if most is None else max(most - told, told - least)
                beyond += reach > tolerance * told
            others = (_told(kind, *o[kind][element][:2]) for o in r.get("nudged", []))
            changed += any(o is None or abs(o - told) > tolerance * told for o in others)
    return beyond, changed, count


def _told(kind: str, first: float | None, second: float | None = None) -> float | None:
    """What an answer tells: the larger of two extremes, or the starts; None = unlimited."""
    if kind == "peaks":
        assert first is not None
        assert second is not None
        return max(abs(first), abs(second))
    return first


def change_under_nudges(record: Record) -> float:
    """Largest relative change of a peak under a billionth."""
    before = record["asked"]["peaks"]
    return max(
        (largest_change(before, other["peaks"]) for other in record.get("nudged", [])), default=0.0
    )


def largest_change(peaks: dict[str, Sequence[float]], truth: dict[str, Sequence[float]]) -> float:
    """Largest relative change of an extreme; torques that are only rounding say nothing."""
    return max((true for _, _, true in beside_truth(peaks, truth)), default=0.0)


def beside_truth(
    peaks: dict[str, Sequence[float]], truth: dict[str, Sequence[float]]
) -> Iterator[tuple[str, float, float]]:
    """Element, size of its true peak and relative error of its extremes."""
    largest = max(max(abs(p[0]), abs(p[1])) for p in truth.values())
    for element, (high, low, *_) in peaks.items():
        if element not in truth:
            continue
        size = max(abs(truth[element][0]), abs(truth[element][1]))
        if size > NOTHING * largest:
            off = max(abs(high - truth[element][0]), abs(low - truth[element][1]))
            yield element, size, off / size


def _peaks(record: Record, truth: dict[str, Sequence[float]]) -> list[Answer]:
    """Peaks of a record beside true ones, their error with what is left out."""
    found, peaks = [], record["asked"]["peaks"]
    for element, size, off in beside_truth(peaks, truth):
        error, left_out = peaks[element][2:4]
        stated = None if left_out is None else (error + left_out) / size
        tolerance = record["tolerance"][0]
        found.append(Answer(record["number"], element, "peak", tolerance, stated, off))
    return found


def _beside(record: Record, truth: Record) -> list[Answer]:
    """Every answer of a record beside those of the finer run."""
    found = _peaks(record, truth["peaks"])
    for element, (starts, left_out, low, high) in record["asked"]["starts"].items():
        true = truth["starts"][element][0]
        if starts is None and true is None:
            continue  # unlimited is right, and has no error
        if starts is None or true is None:
            off = math.inf
            side = low is not None and true is not None and low <= true
            stated = math.inf if side or (starts is not None and high is None) else 0.0
        elif left_out is None:
            off, stated = abs(true / starts - 1.0), 0.0
        else:
            off = abs(true / starts - 1.0)
            end = low if true < starts else (math.inf if high is None else high)
            stated = abs(end / starts - 1.0)
        told = None if left_out is None else stated
        tolerance = record["tolerance"][1]
        found.append(Answer(record["number"], element, "starts", tolerance, told, off))
    return found


def _recontacts(record: Record) -> Iterator[Answer]:
    """Largest recontact speed of each clearance beside that of the finer run."""
    for element, (speed, error) in record["asked"]["recontacts"].items():
        true = record["truth"]["recontacts"].get(element, (0.0, 0.0))[0]
        if speed or true:
            off = abs(true / speed - 1.0) if speed else math.inf
            tolerance = record["tolerance"][0]
            yield Answer(record["number"], element, "recontact", tolerance, error, off)


def _repeated(record: Record) -> Iterator[Repeated]:
    """Each answer of a sensitive train beside each of its repetitions."""
    number, asked = record["number"], record["asked"]
    for other in record.get("nudged", []):
        for element, (maximum, minimum, error, _, low, high) in asked["peaks"].items():
            upper, lower = other["peaks"][element][:2]
            if low is not None:
                yield Repeated(number, element, "peak", low <= max(abs(upper), abs(lower)) <= high)
                off = max(abs(upper - maximum), abs(lower - minimum))
                yield Repeated(number, element, "extremes", off <= error)
        for element, (_, left_out, low, high) in asked["starts"].items():
            starts = other["starts"][element][0]
            least, most = (0.0 if low is None else low), (math.inf if high is None else high)
            if left_out is not None:
                yield Repeated(
                    number,
                    element,
                    "starts",
                    least <= (math.inf if starts is None else starts) <= most,
                )


def classes_of(found: Study) -> list[ClassSummary]:
    """Shares and ratios by class of train, kind of answer and tolerance."""
    by_number = {r["number"]: r for r in found.records if "failed" not in r}

    def of(name: str, chosen: list[Answer]) -> ClassSummary:
        told = [a for a in chosen if a.stated is not None]
        ratios = [a.ratio for a in told if a.resolved]
        return ClassSummary(
            name,
            len({a.number for a in told}),
            len(told),
            sum(a.holds for a in told),
            sum(a.within for a in told),
            len(chosen) - len(told),
            float(np.median(ratios)) if ratios else math.nan,
            max(told, key=lambda a: a.true / max(a.stated or 0.0, 1e-300), default=None),
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
    chosen = [a for a in found.answers if by_number[a.number]["asked"]["modes_left_out"]]
    rows.append(of("with modes left out", chosen))
    for tolerance in (1e-2, 1e-3, 1e-4):
        chosen = [a for a in found.answers if by_number[a.number]["tolerance"][0] == tolerance]
        rows.append(of(f"tolerance of peaks {tolerance:g}", chosen))
    for events, words in ((False, "linear"), (True, "with events")):
        chosen = [a for a in found.independent if by_number[a.number]["asked"]["events"] == events]
        rows.append(of(f"independent integrator, {words}", chosen))
    rows.append(of("recontact speeds", found.recontacts))
    rows.append(of("bounds of effects left out", found.bounds))
    return rows
