"""Tolerances: what the scatter of table `Scatter` makes of frequencies, margins, peaks and starts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from addin.studies.study import Found, Study

if TYPE_CHECKING:
    from addin.studies.spread import Spread
    from engine.case import Case
    from engine.errors import Problem
    from engine.studies import StudyInputs
    from engine.tolerances import Tolerances

__all__ = ["TOLERANCES"]


def _check(case: Case, inputs: StudyInputs, settings: Mapping[str, Any]) -> Sequence[Problem]:
    from engine.scatter import scatter_problems

    return scatter_problems(case, inputs.scatter)


def _calculate(
    case: Case,
    inputs: StudyInputs,
    settings: Mapping[str, Any],
    spread: Spread,
    on_stage: Callable[[str], None],
) -> Found:
    from engine.tolerance_sample import ToleranceSettings, evaluate, plan_tolerances, units_of
    from engine.tolerance_tables import tolerance_details, tolerance_tables
    from engine.tolerances import gather

    on_stage("plain run")
    plan = plan_tolerances(case, inputs.scatter, ToleranceSettings(**settings))
    units = units_of(plan)

    def done(count: int) -> None:
        runs = units[count].first if count < len(units) else plan.n_runs
        on_stage(f"{runs:,} of {plan.n_runs:,} trains")

    found = gather(plan, spread(evaluate, units, done))
    return Found(
        found,
        tolerance_tables(found),
        _sentence(found),
        plan.digest,
        found.sentences[1:],
        tolerance_details(found),
    )


def _sentence(found: Tolerances) -> str:
    """The answer in words: the starts, what drives them, and whether the sample was large enough."""
    said = []
    rows = [r for r in found.percentiles if r.quantity == "allowable starts" and r.percentiles]
    if rows:
        least = rows[-1]  # of the train, where there are several shafts
        p10, p50, p90 = (_number(p.value) for p in least.percentiles)
        said.append(
            f"Allowable starts of {least.of}: P10 {p10}, P50 {p50}, P90 {p90} of {least.samples} "
            "samples."
        )
    margins = [r for r in found.probabilities if r.check == "all margins"]
    said += [
        f"All margins are kept in {100.0 * r.probability:.3g} % of them "
        f"({100.0 * r.low:.3g} to {100.0 * r.high:.3g} %)."
        for r in margins
    ]
    if found.explained is not None and found.drivers:
        strongest = " and ".join(d.factor for d in found.drivers[:2])
        said.append(
            f"What drives the {found.driven} most: {strongest} (ranks explain "
            f"{100.0 * found.explained:.0f} %)."
        )
    said.append(found.sentences[0])
    return " ".join(said)


def _number(value: float) -> str:
    return "unlimited" if value == float("inf") else f"{float(f'{value:.3g}'):,g}"


#: The study of ``torsionbook tolerances``.
TOLERANCES = Study(
    key="tolerances",
    command="tolerances",
    inputs=("Scatter",),
    results=(
        "ToleranceStarts",
        "ToleranceDrivers",
        "ToleranceFrequencies",
        "ToleranceMargins",
        "TolerancePeaks",
        "ToleranceDistribution",
        "ToleranceHistogram",
        "ToleranceTornado",
    ),
    check=_check,
    calculate=_calculate,
)
