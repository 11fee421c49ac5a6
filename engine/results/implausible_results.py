"""Results that no motor train has: a unit or a factor is wrong somewhere, and no verdict is given.

The limits are far outside what is built, so that what is only unusual keeps its verdict; see
`engine.case.plausibility` and `engine.operation.plausible_train` for inputs that look like a slip.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from engine.case.plausibility import LEAST_END_SPEED
from engine.case.result_words import Outcome
from engine.case.usual_range import Implausible, UsualRange
from engine.fatigue.stress import stress_of_unit_torque
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import impossible_train
from engine.results.results import Results

#: A first torsional mode below this is none of a motor train. [Hz]
LOWEST_MODE = 0.5
#: Nor does one that starts have its first mode above this; direct trains of 0.5 MW have 100 to 200 Hz. [Hz]
HIGHEST_FIRST_MODE = 500.0
#: A start from rest to its end takes no less and no longer. [s]
RUN_UP = (0.2, 120.0)
#: Peak torque of a start without events over rated torque; the largest published are about 8. [1]
LARGEST_PEAK = 20.0
STRESS = UsualRange(
    "Elements", "Stress diameter", 0.0, 1.0, "× its shear yield", 1.0, "below 1",
    "Check its unit.", "stress", (0.0, 10.0),
)  # fmt: skip


def implausible_results(results: Results) -> tuple[Implausible, ...]:
    """Everything in a run that no motor train has.

    Parameters
    ----------
    results : Results
        A run; verdicts and warnings are not looked at. [SI]

    Returns
    -------
    tuple of Implausible
        Empty where verdicts can be given.
    """
    return (*_of_the_train(results), *_of_the_start(results), *_of_stresses(results))


def _of_the_train(results: Results) -> Iterator[Implausible]:
    case, train = results.case, results.train
    first = results.modes.elastic_frequency[results.modes.twists[results.modes.n_rigid :]][:1]
    is_too_stiff = results.start is not None and bool(np.any(first > HIGHEST_FIRST_MODE))
    if len(first) and (first[0] < LOWEST_MODE or is_too_stiff):
        yield Implausible(
            f"first torsional mode at {first[0]:.3g} Hz",
            "Check the units of stiffnesses and inertias.",
        )
    yield from impossible_train(case, train, full_speed(case, train))


def _of_the_start(results: Results) -> Iterator[Implausible]:
    case, start = results.case, results.start
    if start is None or start.runup is None:
        return
    outcome, rated = start.outcome, case.ratings.rated_torque
    is_whole = outcome.outcome in (Outcome.REACHED, Outcome.SYNCHRONISED)
    low, high = RUN_UP
    synchronous = case.ratings.synchronous_speed or 0.0
    is_cut = outcome.end_speed < LEAST_END_SPEED * synchronous  # `EndSpeed` is said instead
    if is_whole and not is_cut and not low <= outcome.time <= high:
        yield Implausible(
            f"start of {outcome.time:.3g} s",
            "Check EndSpeed, inertias, speed ratios and torque curves.",
        )
    _, peak = start.largest_peak(case.element_speed_ratios)
    has_events = results.plans[-1].events or bool(case.torque_time_from_rest)
    if rated and not has_events and peak > LARGEST_PEAK * rated:
        yield Implausible(
            f"peak torque of {peak / rated:.3g} × rated torque",
            "Check damping, the pulsating torque and RatedTorque.",
        )


def _of_stresses(results: Results) -> Iterator[Implausible]:
    case, start = results.case, results.start
    strength = {m.material: m.yield_ or m.uts for m in case.materials}
    size = {} if start is None else {p.element: p.size for p in start.peaks}
    yield from STRESS.impossible(
        (e.element, size[e.element] * stress_of_unit_torque(e) / (0.5 * limit))
        for e in case.elements
        if e.stress_diameter and (limit := strength.get(e.material)) and e.element in size
    )
