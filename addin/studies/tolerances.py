"""Tolerances: what the scatter of table `Scatter` makes of frequencies, margins, peaks and starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

from addin.contract.studies.tolerances import TOLERANCES as TOLERANCES_SPEC
from addin.contract.study_spec import CUT_SHORT
from addin.reading.case_json import case_to_json
from addin.studies.raw_samples import SAMPLE_ENDINGS, samples_refusal, write_samples
from addin.studies.study import CutShort, Option, Study, StudyPart, StudyResult, StudyTask
from addin.workers.parallel_map import Cancelled
from addin.xlsx.whole_files import write_json
from engine.case.case import Case
from engine.case.study_inputs import StudyInputs
from engine.errors import Problem
from engine.numerics.sample_statistics import FEWEST_SAMPLES
from engine.studies.scatter import sample_size, scatter_problems
from engine.studies.tolerances.raw_samples import raw_samples, sample_again
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


def _refusal(options: Mapping[str, Any]) -> str:
    """Why a file of samples, or one sample, cannot be."""
    path, only, case = options["samples_file"], options["only"], options["case"]
    drawn = sample_size(options["samples"], options["method"])
    if only is not None and only > drawn:
        return (
            f"--only is {only}, but {drawn:,} samples are drawn. Give a number from 1 to {drawn:,}."
        )
    if case is not None and only is None:
        return "--case writes the case of one sample; say which with --only."
    return "" if path is None else samples_refusal(path)


def _part(task: StudyTask, options: Mapping[str, Any]) -> StudyPart | None:
    """One sample again, to the same bits."""
    number = options["only"]
    if number is None:
        return None
    settings = ToleranceSettings(**task.settings)
    samples, case = sample_again(task.case, task.inputs.scatter, settings, number)
    values = (
        "–" if v is None else repr(v) if isinstance(v, float) else str(v) for v in samples.rows[0]
    )

    def save() -> Iterator[Path]:
        if (path := options["samples_file"]) is not None:
            write_samples(path, samples)
            yield path
        if (path := options["case"]) is not None:
            write_json(path, case_to_json(case))
            yield path

    return StudyPart(
        f"Sample {number} of {sample_size(settings.samples, settings.method):,}, calculated alone as in "
        "the study.",
        tuple(zip(samples.columns, values, strict=True)),
        save,
    )


def _save(study: StudyResult, options: Mapping[str, Any], source: Path) -> Iterator[Path]:
    """The raw samples."""
    if (path := options["samples_file"]) is not None:
        write_samples(path, raw_samples(study.result.plan, study.result.answers))
        yield path


_HELP = """\
Calculate the scatter of frequencies, margins, peaks and allowable starts from that of the inputs.

Samples trains from table Scatter and calculates each: percentiles with their intervals, the
probability that each margin is kept and that StartsRequired is reached, and the main drivers.
`--samples samples.csv` also writes every sample; `--only 17` calculates one of them again, to the
same bits.

Example: `torsionbook tolerances train.xlsx --samples 10000 --samples samples.csv`"""


#: The study of ``torsionbook tolerances``.
TOLERANCES = Study(
    spec=TOLERANCES_SPEC,
    check=_check,
    calculate=_calculate,
    help=_HELP,
    options=(
        Option(
            "samples", int, 1000,
            "Number of samples.",
            least=30, most=1_000_000, metavar="N|FILE", file_endings=SAMPLE_ENDINGS,
            file_help="Likewise a file for the raw samples (.csv or .parquet); may be given twice.",
        ),
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
        Option(
            "only", int, None, "Calculate this one of the samples again, and nothing else: not with --out, --in-place or --json.", least=1,
            is_setting=False,
        ),
        Option(
            "case", Path, None, "With --only: write the case of the sample as JSON, for recalc.",
            is_setting=False,
        ),
    ),
    save=_save,
    refusal=_refusal,
    part=_part,
    part_options=("only",),
)  # fmt: skip
