"""Two engines beside one another: `python scripts/side_by_side.py OTHER_CHECKOUT`.

Each calculates the linear start of every train of the accuracy study, and the first second with clearances of those
that have them, at one step. Prints how far peaks and ends differ, and whether the same events come in the same order.
Where they do not, this engine is asked again with every inertia changed by rounding, up and down: events that part then,
too, are chaotic.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
CODE = """
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from benchmarks.study_trains import gaps_of, study_train
from engine.backlash import event_start
from engine.case.data import EffectChoiceRow
from engine.run import calculate_start, run
from engine.start.pieces import analysis_for_start

def of(number, nudged=0):
    case = study_train(number).case
    off = replace(case, effect_choices=(*case.effect_choices, EffectChoiceRow("backlash", "off"),
                                        EffectChoiceRow("bearings", "off")))
    results = run(off)
    start = results.start
    found = {"peaks": [[p.maximum, p.minimum] for p in start.peaks], "end": start.outcome.time,
             "steps": start.trajectory.n_steps, "events": None}
    gaps = tuple(gaps_of(case)) if number % 2 else ()
    if gaps:
        first, model = replace(off, maximum_time=SECONDS), analysis_for_start(off).torsional
        if nudged:
            stations = tuple(replace(s, inertia=(s.inertia or 0.0) * (1.0 + nudged * ROUNDING * (-1) ** i))
                             for i, s in enumerate(first.stations))
            first = replace(first, stations=stations)
            model = analysis_for_start(first).torsional
        effects = results.plans[-1].effects
        linear = calculate_start(first, model, replace(effects, clearances=()), None)
        effects = replace(effects, clearances=gaps)
        single = event_start.one_run(first, model, effects, linear, linear.step)
        found["events"] = single.events.log[:, :4].tolist()
    return found

if __name__ == "__main__":
    with ProcessPoolExecutor() as pool:
        print(json.dumps(list(pool.map(of, NUMBERS, NUDGED))))
"""
#: Change of every inertia that is rounding.
ROUNDING = 4e-16
#: Linear peaks and ends differ by no more; torques below the other share of the largest are rounding.
LINEAR, NOTHING = 1e-9, 1e-9


def answers(
    root: Path, numbers: Sequence[int], seconds: float, nudged: int = 0
) -> list[dict[str, Any]]:
    """What the engine of one checkout finds."""
    values = {
        "NUMBERS": list(numbers),
        "NUDGED": [nudged] * len(numbers),
        "SECONDS": seconds,
        "ROUNDING": ROUNDING,
    }
    code = CODE
    for name, value in values.items():
        code = code.replace(name, repr(value))
    environment = os.environ | {"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1"}
    words = [sys.executable, "-c", code]
    done = subprocess.run(
        words, env=environment, cwd=root, stdout=subprocess.PIPE, text=True, check=True
    )
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


def main() -> int:
    """Compare; 1 where linear peaks differ by more than `LINEAR` or other events are not chaotic."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("other", type=Path, help="a checkout of the other engine")
    parser.add_argument("--trains", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=1.0, help="of a start with events")
    args = parser.parse_args()
    numbers = range(args.trains)
    own = answers(ROOT, numbers, args.seconds)
    other = answers(args.other.resolve(), numbers, args.seconds)
    far = [(_apart(a, b), n) for n, a, b in zip(numbers, own, other, strict=True)]
    steps = [n for n, a, b in zip(numbers, own, other, strict=True) if a["steps"] != b["steps"]]
    with_events = [n for n in numbers if own[n]["events"] is not None]
    parted = [n for n in with_events if not _same(own[n]["events"], other[n]["events"])]
    up, down = (answers(ROOT, parted, args.seconds, sign) for sign in (1, -1))
    told = [
        n
        for n, a, b in zip(parted, up, down, strict=True)
        if all(_same(own[n]["events"], nudged["events"]) for nudged in (a, b))
    ]
    count = sum(len(own[n]["events"]) for n in with_events)
    together = [
        _later(own[n]["events"], other[n]["events"]) for n in with_events if n not in parted
    ]
    print(
        f"{len(far)} linear starts: peaks and ends differ by at most {max(far)[0]:.1e} (train {max(far)[1]})"
    )
    print(f"beyond {LINEAR:g}: {[n for x, n in far if x > LINEAR]}; other number of steps: {steps}")
    print(
        f"{len(with_events)} starts with events, {args.seconds:g} s, {count} events: others in {parted}"
    )
    print(f"of these not parted by rounding: {told}")
    print(
        f"instants of the same events: median {np.median(together):.1e} s, largest {max(together):.1e} s"
    )
    return 1 if told or max(far)[0] > LINEAR else 0


def _apart(a: dict[str, Any], b: dict[str, Any]) -> float:
    """Largest relative difference of peaks and end."""
    own, other = np.array(a["peaks"]), np.array(b["peaks"])
    size = np.maximum(np.abs(other).max(axis=1), NOTHING * np.abs(other).max())
    peaks = float((np.abs(own - other).max(axis=1) / size).max())
    return float(max(peaks, abs(a["end"] / b["end"] - 1.0)))


def _same(one: list[list[float]], two: list[list[float]]) -> bool:
    """Whether the same flanks meet and part in the same order."""
    return [row[1:] for row in one] == [row[1:] for row in two]


def _later(one: list[list[float]], two: list[list[float]]) -> float:
    """Largest difference of the instants of two equal sequences. [s]"""
    return max((abs(a[0] - b[0]) for a, b in zip(one, two, strict=True)), default=0.0)


if __name__ == "__main__":
    sys.exit(main())
