"""How often the stated error of a sensitivity holds: `make sensitivity-study`.

Random trains with a linear start. Every derivative that is reported, of the peak and of the allowable
starts of the governing element, is compared with one found another way: the same quantity changed
by half as much, in starts planned anew at a hundredth of the tolerance, at a quarter of their step.

    python -m benchmarks.sensitivity_errors --trains 100
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
from dataclasses import replace
from typing import Any

import numpy as np

from engine.case.case import Case
from engine.case.data import CaseData
from engine.errors import ModelError
from engine.start.start_fatigue import judged_shafts
from engine.studies.nearby_start import LINEAR, near_start, near_train
from engine.studies.sensitivities.differences import differences
from engine.studies.sensitivities.plan import NARROW, derivative_units, plan_derivatives
from engine.studies.sensitivities.sensitivities import gather_derivatives
from engine.studies.sensitivities.tangent import tangent_of
from engine.studies.variation import Change, varied_case
from tests.random_effects import with_judged_shafts
from tests.random_starts import random_start

#: Tolerances of the true starts. [1]
TIGHT_PEAK, TIGHT_STARTS = 1e-5, 2e-4
#: Quantities of one train that are compared, at the most. [count]
MOST = 6


def compared(seed: int) -> list[dict[str, Any]]:
    """Stated and true derivatives of one train."""
    level = 1.3 + 0.1 * (seed % 15)
    case = with_judged_shafts(random_start(seed), seed, level)
    plan = plan_derivatives(case)
    if plan.reason or plan.recipe.start != LINEAR:
        return []
    units = derivative_units(plan)
    if len(units) > MOST:
        chosen = np.random.default_rng(seed).choice(len(units), MOST, replace=False)
        units = tuple(units[int(i)] for i in sorted(chosen))
    found = gather_derivatives(plan, [differences(u) for u in units], tangent_of(plan))
    tight = plan_derivatives(
        Case(**(vars(case) | {"tolerance_peak": TIGHT_PEAK, "tolerance_starts": TIGHT_STARTS}))
    )
    if tight.reason:
        return []
    recipe = replace(tight.recipe, step=0.5 * tight.recipe.step)
    names = [str(e.element) for e in case.elements]
    element = names.index(str(found.governing))
    judged = [i for i, _ in judged_shafts(case)]
    shaft = judged.index(element) if element in judged else None
    rows = []
    for r in found.rows:
        if r.peak is None:
            continue
        try:
            true = _true(tight.case, recipe, (r.quantity, r.of))
        except ModelError:
            continue
        for name, stated, error, values in (
            ("peak", r.peak, r.peak_error, true[0][:, element]),
            ("starts", r.starts, r.starts_error, None if shaft is None else true[1][:, shaft]),
        ):
            if stated is None or error is None or values is None:
                continue
            value, doubt = _richardson(values)
            rows.append(
                {
                    "seed": seed, "answer": name, "of": f"{r.quantity} {r.of}", "stated": stated,
                    "error": error, "true": value, "doubt": doubt, "note": r.note,
                    "size": max(abs(x.peak if name == "peak" else x.starts or 0.0) for x in found.rows if x.peak is not None),
                }
            )  # fmt: skip
    return rows


def _true(case: CaseData, recipe: Any, parameter: tuple[str, str]) -> tuple[Any, Any]:
    """Logarithms of peaks and starts at four changes."""
    peaks, starts = [], []
    for share in (-NARROW, -0.5 * NARROW, 0.5 * NARROW, NARROW):
        changed = varied_case(case, [Change(*parameter, 1.0 + share)])
        answer = near_start(changed, recipe, near_train(changed, recipe))
        peaks.append(np.log(np.maximum(answer.largest, 1e-300)))
        starts.append(-np.log(np.where(answer.damage > 0.0, answer.damage, 1.0)))
    return np.array(peaks), np.array(starts)


def _richardson(logs: Any) -> tuple[float, float]:
    wide = (logs[3] - logs[0]) / (2.0 * NARROW)
    narrow = (logs[2] - logs[1]) / NARROW
    return float(narrow + (narrow - wide) / 3.0), float(abs(narrow - wide))


def main() -> None:
    """Measure and print the record."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trains", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--misses", action="store_true", help="list every miss")
    asked = parser.parse_args()
    with multiprocessing.get_context("fork").Pool(asked.processes) as pool:
        numbers = range(asked.first, asked.first + asked.trains)
        trains = []
        for train in pool.imap(compared, numbers, chunksize=1):
            trains.append(train)
            off = sum(abs(r["stated"] - r["true"]) > r["error"] + r["doubt"] for r in train)
            print(f"train {len(trains)}: {off} of {len(train)} missed", file=sys.stderr, flush=True)
    rows = [row for train in trains for row in train]
    print(
        "| answer | trains | derivatives | within their error | median of error over difference |"
    )
    print("|---|---|---|---|---|")
    for name in ("peak", "starts"):
        mine = [r for r in rows if r["answer"] == name]
        off = np.array([abs(r["stated"] - r["true"]) for r in mine])
        error, doubt = (np.array([r[k] for r in mine]) for k in ("error", "doubt"))
        held = off <= error + doubt
        ratio = np.median(error / np.maximum(off, 1e-300)) if len(mine) else 0.0
        print(
            f"| {name} | {len({r['seed'] for r in mine})} | {len(mine)} | "
            f"{held.mean():.1%} | {ratio:.1f} |"
        )
        if asked.misses:
            for r, ok in zip(mine, held, strict=True):
                if not ok:
                    print({k: (f"{v:.4g}" if isinstance(v, float) else v) for k, v in r.items()})


if __name__ == "__main__":
    main()
