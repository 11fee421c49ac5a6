"""Cases spoiled as hands spoil them, calculated: `python -m benchmarks.mutated_cases`.

Each case is one of the examples or a random start, with one to three mutations: a value times 1e±3 or a few per
cent, two rows exchanged, two values of a column exchanged, a column blanked, a row deleted. Every other case is
mutated gently: values within 10 % of the typed ones, so that most of them calculate. A case must end in named
problems or in finite results, within `LONGEST` of processor time; a traceback of another kind is a miss.
With `--claims` every 51st case, gentle and not in turn, is compared with its truth, as `benchmarks.tolerance_study` does.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from typing import Any

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())  # one thread a process: there is a process a core

import numpy as np  # noqa: E402

from benchmarks.study_answers import Record, summary_of  # noqa: E402
from benchmarks.study_trains import StudyTrain, study_train  # noqa: E402
from benchmarks.tolerance_study import record_of  # noqa: E402
from engine.case.case import Case  # noqa: E402
from engine.case.data import CaseData  # noqa: E402
from engine.errors import CaseError, ModelError  # noqa: E402
from engine.results.tables import result_tables  # noqa: E402
from engine.run import run  # noqa: E402
from engine.start.settings import has_start  # noqa: E402

RECORD = "mutated_cases.json"
#: Processor time that one case may take, and after which it is given up. [s]
LONGEST, GIVEN_UP = 20.0, 120
#: Cases of the whole study, and of the sample that a test runs.
FULL, QUICK = 50_000, 80
#: Of the cases, every so many is compared with its truth.
CLAIMS = 51
#: Share of the cases whose train has clearances: they take ten times as long as the others. [1]
WITH_CLEARANCES = 0.1
#: Tables whose rows are mutated.
TABLES = (
    "stations", "elements", "meshes", "motor_torque", "load_torque", "materials", "sn_points", "excitations",
)  # fmt: skip


@dataclass(frozen=True)
class Ended:
    """How one mutated case ended."""

    number: int  #: Case.
    how: str  #: ``calculated``, ``refused``, or what was wrong.
    changes: tuple[str, ...]  #: Mutations, in words.
    seconds: float  #: Processor time. [s]

    @property
    def sound(self) -> bool:
        """Whether it ended as it should. [flag]"""
        return self.how in ("calculated", "refused") and self.seconds <= LONGEST


def mutated(number: int) -> tuple[CaseData, tuple[str, ...]]:
    """A case from its number alone, with its mutations in words."""
    rng = np.random.default_rng((number, 22))
    train = 2 * int(rng.integers(1, 5_000)) + int(rng.random() < WITH_CLEARANCES)
    case: CaseData = CaseData(**vars(study_train(train).case))
    case = replace(case, tolerance_peak=1e-3, tolerance_starts=2e-2)
    said = []
    mutation = _gentle if number % 2 else _mutation
    for _ in range(int(rng.integers(1, 4))):
        case, words = mutation(case, rng)
        said.append(words)
    return case, tuple(said)


def _mutation(case: CaseData, rng: np.random.Generator) -> tuple[CaseData, str]:
    """One more mutation; of a table without rows none."""
    table = str(rng.choice(TABLES))
    rows = list(getattr(case, table))
    if not rows:
        return case, f"{table}: no rows"
    numbers = [f.name for f in fields(rows[0]) if any(_is_number(getattr(r, f.name)) for r in rows)]
    kind = str(rng.choice(["scaled", "exchanged rows", "exchanged values", "blanked", "deleted"]))
    column = str(rng.choice(numbers)) if numbers else ""
    i, j = (int(k) for k in rng.integers(0, len(rows), 2))
    if kind == "scaled" and column:
        factor = float(rng.choice([1e-3, 1e3, 0.9, 1.1, -1.0, 0.0, 10.0, 0.1]))
        whole = bool(rng.random() < 0.3)
        for k in range(len(rows)) if whole else (i,):
            if _is_number(value := getattr(rows[k], column)):
                rows[k] = replace(rows[k], **{column: factor * value})
        kind = f"{column} × {factor:g}{' in every row' if whole else f' in row {i + 1}'}"
    elif kind == "exchanged rows":
        rows[i], rows[j] = rows[j], rows[i]
        kind = f"rows {i + 1} and {j + 1} exchanged"
    elif kind == "exchanged values" and column:
        a, b = getattr(rows[i], column), getattr(rows[j], column)
        rows[i] = replace(rows[i], **{column: b})
        rows[j] = replace(rows[j], **{column: a})
        kind = f"{column} of rows {i + 1} and {j + 1} exchanged"
    elif kind == "blanked" and column:
        rows = [replace(row, **{column: None}) for row in rows]
        kind = f"{column} blank"
    elif kind == "deleted":
        del rows[i]
        kind = f"row {i + 1} deleted"
    return replace(case, **{table: tuple(rows)}), f"{table}: {kind}"


def _gentle(case: CaseData, rng: np.random.Generator) -> tuple[CaseData, str]:
    """One value within 10 % of the typed one; of a table without numbers none."""
    table = str(rng.choice(TABLES))
    rows = list(getattr(case, table))
    places = [
        (i, name)
        for i, row in enumerate(rows)
        for name, value in vars(row).items()
        if _is_number(value)
    ]
    if not places:
        return case, f"{table}: no numbers"
    i, column = places[int(rng.integers(len(places)))]
    factor = float(rng.uniform(0.9, 1.1))
    rows[i] = replace(rows[i], **{column: factor * getattr(rows[i], column)})
    return replace(case, **{table: tuple(rows)}), f"{table}: {column} × {factor:.4f} in row {i + 1}"


def _is_number(value: object) -> bool:
    return isinstance(value, float | int) and not isinstance(value, bool)


def ended(number: int) -> Ended:
    """Calculate one mutated case."""
    data, changes = mutated(number)
    began = time.process_time()
    try:
        results = run(Case(**vars(data)))
        how = "calculated" if all(_finite(result_tables(results))) else "a number is not finite"
    except (CaseError, ModelError):
        how = "refused"
    except TimeoutError:
        how = f"given up after {GIVEN_UP} s"
    except Exception as wrong:  # noqa: BLE001 - every other end is what the study looks for
        how = f"{type(wrong).__name__}: {wrong}"
    return Ended(number, how, changes, time.process_time() - began)


def claims_of(number: int) -> Record | None:
    """What a case says of its own errors, beside its truth; None where it has no start."""
    data, _ = mutated(number)
    try:
        case = Case(**vars(data))
        if not has_start(case):
            return None
        return record_of(StudyTrain(number, number, case, (), independent=False), nudges=1)
    except (CaseError, ModelError):
        return None


def _finite(value: Any) -> Iterator[bool]:
    """Whether each number of some rows is finite."""
    if isinstance(value, dict):
        for one in value.values():
            yield from _finite(one)
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _finite(one)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from _finite(asdict(value))
    elif isinstance(value, float):
        yield math.isfinite(value)


def _alone(number: int) -> Ended:
    def give_up(*_: object) -> None:
        raise TimeoutError

    if hasattr(signal, "SIGPROF"):  # a timer of processor time: other programs do not count
        signal.signal(signal.SIGPROF, give_up)
        signal.setitimer(signal.ITIMER_PROF, GIVEN_UP)
    try:
        return ended(number)
    finally:
        if hasattr(signal, "SIGPROF"):
            signal.setitimer(signal.ITIMER_PROF, 0.0)


def _load() -> None:
    """Load what starts with clearances need: no case's own time."""
    run(study_train(81).case)


def main() -> int:
    """Calculate them all; 1 where one did not end as it should."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutated_cases")
    parser.add_argument("--cases", type=int, default=FULL, help="how many")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument(
        "--record", action="store_true", help=f"add it to {RECORD} and docs/safety.md"
    )
    parser.add_argument(
        "--claims", action="store_true", help=f"compare every {CLAIMS}th with its truth instead"
    )
    args = parser.parse_args()
    if args.claims:
        return _claims(range(args.first, args.first + args.cases, CLAIMS), args.jobs, args.record)
    numbers = range(args.first, args.first + args.cases)
    found: list[Ended] = []
    with ProcessPoolExecutor(args.jobs, initializer=_load) as pool:
        for future in as_completed([pool.submit(_alone, n) for n in numbers]):
            one = future.result()
            found.append(one)
            if not one.sound:
                print(json.dumps(asdict(one)), flush=True)
            if len(found) % 500 == 0:
                print(f"… {len(found)} of {args.cases}", file=sys.stderr, flush=True)
    print(dict(Counter(one.how if one.sound else "missed" for one in found)))
    print(f"longest: {max(one.seconds for one in found):.1f} s of processor time")
    if args.record:
        _keep(args.first, found)
    return 0 if all(one.sound for one in found) else 1


def _claims(numbers: range, jobs: int, record: bool) -> int:
    """Print what holds of what the cases say, and what does not; 1 where nothing could be compared."""
    from addin.contract.version import product_version
    from benchmarks.safety_page import keep, kept

    with ProcessPoolExecutor(jobs) as pool:
        found = summary_of([one for one in pool.map(claims_of, numbers) if one is not None])
    every = [a for a in (*found.answers, *found.bounds) if a.resolved and a.stated is not None]
    missed = [a for a in every if not a.holds]
    for one in missed:
        print(json.dumps(asdict(one)))
    ended = {
        "every": CLAIMS,
        "first": numbers[0],
        "starts": len(found.records),
        "sensitive": len(found.sensitive),
        "statements": len(every),
        "missed": [asdict(one) for one in missed],
        "version": product_version(),
    }
    print({name: len(value) if isinstance(value, list) else value for name, value in ended.items()})
    if record:
        runs = [one for one in kept(RECORD).get("claims", []) if one["first"] != numbers[0]]
        keep(RECORD, {"claims": [*runs, ended]})
    return 0 if every else 1


def _keep(first: int, found: list[Ended]) -> None:
    from addin.contract.version import product_version
    from benchmarks.safety_page import keep_stretch

    outcomes = Counter(one.how if one.sound else "missed" for one in found)
    stretch = {
        "what": "python -m benchmarks.mutated_cases",
        "version": product_version(),
        "run": 1,
        "first": first,
        "count": len(found),
        "outcomes": dict(sorted(outcomes.items())),
        "faults": [asdict(one) for one in found if not one.sound],
        "longest_seconds": round(max(one.seconds for one in found), 1),
    }
    keep_stretch(RECORD, stretch)


if __name__ == "__main__":
    raise SystemExit(main())
