"""Tolerances: what the scatter of table `Scatter` makes of frequencies, margins, peaks and starts."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from addin.contract.studies.tolerances import TOLERANCES as TOLERANCES_SPEC
from addin.contract.study_spec import CUT_SHORT
from addin.studies.study import CutShort, Option, Study, StudyResult, StudyTask
from addin.workers.parallel_map import Cancelled
from engine.case.case import Case
from engine.case.study_inputs import StudyInputs
from engine.errors import Problem
from engine.numerics.sample_statistics import FEWEST_SAMPLES
from engine.studies.scatter import scatter_problems
from engine.studies.tolerances.sample import ToleranceSettings, evaluate, plan_tolerances, units_of
from engine.studies.tolerances.tables import tolerance_details, tolerance_tables
from engine.studies.tolerances.tolerances import Tolerances, summarise_sample


def _check(case: Case, inputs: StudyInputs) -> Sequence[Problem]:
    return scatter_problems(case, inputs.scatter)


def _calculate(task: StudyTask) -> StudyResult:
    task.tell("nominal run")
    plan = plan_tolerances(task.case, task.inputs.scatter, ToleranceSettings(**task.settings))
    # the runs of one factor at a time first: without them a study that is cut short has no tornado
    units = sorted(units_of(plan), key=lambda unit: unit.first < plan.n_samples)
    runs = [0, *accumulate(len(unit.values) for unit in units)]
    parts = task.map_until_cancelled(
        evaluate, units, lambda done: f"{runs[done]:,} of {plan.n_runs:,} runs"
    )
    drawn = plan.n_samples - (plan.n_runs - runs[len(parts)])
    cut = None
    if len(parts) < len(units):
        if drawn < FEWEST_SAMPLES:
            raise Cancelled(
                why=f"{max(drawn, 0)} of {plan.n_samples:,} samples were calculated; fewer than "
                f"{FEWEST_SAMPLES} give no bound for P10."
            )
        cut = CutShort(drawn, plan.n_samples, _cut_short(drawn, plan.n_samples))
    tolerances = summarise_sample(plan, parts)
    return StudyResult(
        tolerances,
        tolerance_tables(tolerances),
        _sentence(tolerances),
        plan.digest,
        tolerances.sentences[1:],
        tolerance_details(tolerances),
        cut_short=cut,
    )


def _cut_short(drawn: int, planned: int) -> str:
    return (
        f"{CUT_SHORT}: {drawn:,} of {planned:,} samples were calculated; convergence is "
        "judged from them."
    )


def _sentence(tolerances: Tolerances) -> str:
    """The answer in words: the starts, what drives them, and whether the sample was large enough."""
    sentences = []
    rows = [r for r in tolerances.percentiles if r.quantity == "allowable starts" and r.percentiles]
    if rows:
        least = rows[-1]  # of the train, where there are several shafts
        p10, p50, p90 = (_number(p.value) for p in least.percentiles)
        sentences.append(
            f"Allowable starts of {least.of}: P10 {p10}, P50 {p50}, P90 {p90} of {least.samples} "
            "samples."
        )
    if tolerances.unfinished:
        sentences.append(
            f"{tolerances.unfinished:,} of {tolerances.samples:,} starts were not completed: they "
            "are excluded from percentiles and count as not reaching StartsRequired."
        )
    if tolerances.lost:
        sentences.append(f"{tolerances.lost:,} samples could not be calculated and are excluded.")
    margins = [r for r in tolerances.probabilities if r.check == "all margins"]
    sentences += [
        f"All margins are kept in {100.0 * r.probability:.3g} % of {r.samples:,} samples "
        f"({100.0 * r.low:.3g} to {100.0 * r.high:.3g} %)."
        for r in margins
    ]
    if tolerances.explained is not None and tolerances.drivers:
        strongest = " and ".join(d.factor for d in tolerances.drivers[:2])
        sentences.append(
            f"Main drivers of the {tolerances.driven}: {strongest} (rank regression explains "
            f"{100.0 * tolerances.explained:.0f} %)."
        )
    sentences.append(tolerances.sentences[0])
    return " ".join(sentences)


def _number(value: float) -> str:
    return "unlimited" if value == float("inf") else f"{float(f'{value:.3g}'):,g}"


_HELP = """\
Calculate the scatter of frequencies, margins, peaks and allowable starts from that of the inputs.

Samples trains from table Scatter and calculates each: percentiles with their intervals, the
probability that each margin is kept and that StartsRequired is reached, and the main drivers.

Example: `torsionbook tolerances train.xlsx --samples 10000`"""


#: The study of ``torsionbook tolerances``.
TOLERANCES = Study(
    spec=TOLERANCES_SPEC,
    check=_check,
    calculate=_calculate,
    help=_HELP,
    options=(
        Option("samples", int, 1000, "Number of samples.", least=30, most=1_000_000),
        Option("seed", int, 1, "The same seed gives the same samples.", least=0),
        Option(
            "method", str, "lhs", "lhs (Latin hypercube) or sobol (Sobol sequence; number of samples rounded up to a "
                                  "power of two).",
            words=("lhs", "sobol"),
        ),
        Option(
            "replan", bool, False,
            "Decide anew which effects to simulate for a sample whose torque reverses where that "
            "of the nominal run does not.",
        ),
    ),
)  # fmt: skip
