"""The tuning study: rows of sheet Tuning, combinations parallel_map over processes, ranked results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from addin.contract.studies.tuning import TUNING as TUNING_SPEC
from addin.contract.study_spec import CUT_SHORT
from addin.reading.case_json import case_to_json
from addin.studies.study import CutShort, Option, Study, StudyResult, StudyTask
from addin.studies.tuning_tables import map_tables
from addin.workers.parallel_map import Cancelled
from addin.writing.results_json import table_rows
from addin.xlsx.whole_files import write_json
from engine.case.case import Case
from engine.start.by_turns import AT_ONCE, in_groups
from engine.studies.tuning.checks import tuning_problems
from engine.studies.tuning.combinations import in_typed_units, plan_tuning
from engine.studies.tuning.evaluate import EvaluatedCombination, calculate_combinations
from engine.studies.tuning.options import Combination
from engine.studies.tuning.tuning import (
    band_rows,
    best_cases,
    crossing_rows,
    map_rows,
    rank_combinations,
    ranked_rows,
    uncalculated_rows,
)

#: Rows of the sheets; the JSON has all of them. [count]
SHOWN, SHOWN_CROSSINGS = 200, 20

#: A case and the combinations that one process calculates.
Batch = tuple[Case, Sequence[Combination]]


def _calculate(task: StudyTask) -> StudyResult:
    case, inputs = task.case, task.inputs
    plan = plan_tuning(case, inputs)
    every = plan.combinations
    batches = [(case, some) for some in in_groups(every)]
    answers = task.map_until_cancelled(
        calculate_batch,
        batches,
        lambda done: f"{min(done * AT_ONCE, len(every)):,} of {len(every):,} combinations",
    )
    tried = [one for batch in answers for one in batch]
    if not tried:
        raise Cancelled(why=f"None of {len(every):,} combinations was calculated.")
    result = rank_combinations(case, plan, tried)
    missing = uncalculated_rows(plan, result)
    ranked, crossings = [*ranked_rows(result), *missing], crossing_rows(result)
    typed_plan = in_typed_units(plan, inputs.units)
    as_typed = rank_combinations(case, typed_plan, tried, inputs.units)
    every_row = [*ranked_rows(as_typed), *uncalculated_rows(typed_plan, as_typed)]
    shown = [row for place, row in enumerate(every_row) if place < SHOWN or row["as_is"]]
    cut = _cut_short(len(tried), len(every)) if missing else None
    in_si = result.sentence if cut is None else f"{cut.sentence} {result.sentence}"
    return StudyResult(
        (case, result),
        {
            "TuningResults": shown,
            "TuningCrossings": crossing_rows(as_typed, SHOWN_CROSSINGS),
            "ForbiddenBands": band_rows(result),
        },
        as_typed.sentence,
        result.study_digest,
        _warnings(len(ranked), len(missing)),
        {
            "sentence": in_si,
            "tuning_results": table_rows("TuningResults", ranked),
            "tuning_crossings": table_rows("TuningCrossings", crossings),
            "variables": [_variable(v) for v in result.variables],
            "choices": _choices(result.rows, result.variables),
            "free_windows": [_without_blanks({"from": w.from_, "to": w.to}) for w in result.windows],
            "tuning_map": [_without_blanks(row) for row in map_rows(result)],
        },
        map_tables(as_typed),
        cut,
    )  # fmt: skip


def calculate_batch(batch: Batch) -> list[EvaluatedCombination]:
    """Some combinations in one process.

    Parameters
    ----------
    batch : tuple of (Case, sequence of Combination)
        What is calculated. [SI]

    Returns
    -------
    list of EvaluatedCombination
        In the same order. [SI]
    """
    case, combinations = batch
    return calculate_combinations(case, combinations)


def _cut_short(calculated: int, planned: int) -> CutShort:
    return CutShort(
        calculated,
        planned,
        f"{CUT_SHORT}: a better combination may be among those not calculated.",
    )


def _warnings(count: int, missing: int) -> tuple[str, ...]:
    if count <= SHOWN:
        return ()
    rest = f", {missing:,} of them not calculated," if missing else ""
    return (
        f"Sheet Tuning results shows the best {SHOWN} of {count:,} combinations{rest} and the unchanged case; "
        "--json writes all of them.",
    )


def _variable(variable: Any) -> dict[str, Any]:
    """What may be chosen, as JSON."""
    return _without_blanks(
        {
            "name": variable.name,
            "quantity": variable.quantity,
            "unit": variable.unit,
            "present": variable.present,
            "options": [{"label": o.label, "value": o.value} for o in variable.options],
        }
    )


def _choices(rows: Sequence[Any], variables: Sequence[Any]) -> list[dict[str, Any]]:
    """What each combination chose, as numbers: the words of the table are rounded."""
    return [
        {
            "rank": row.rank,
            "values": [option.value for option in row.tried.combination.options]
            or [variable.present for variable in variables],
        }
        for row in rows
    ]


def _without_blanks(row: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in row.items() if value is not None}


def _terminal(study: StudyResult, options: Mapping[str, Any]) -> Iterator[str]:
    """The best combinations and the unchanged case, each with its reason."""
    for row in study.tables["TuningResults"]:
        if "rank" in row and (row["rank"] <= options["top"] or row["as_is"]):
            yield f"{row['rank']:>3}  {row['combination']}"
            yield f"     {row['reason']}"
    yield ""


def _save(study: StudyResult, options: Mapping[str, Any], source: Path) -> Iterator[Path]:
    """The best combinations as case JSON files."""
    folder = options["cases"]
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    case, tuning = study.result
    for ranked, data in best_cases(case, tuning, options["top"]):
        title = ": ".join(part for part in (data.title, ranked.combination) if part)
        path = folder / f"{source.stem}.rank-{ranked.rank}.json"
        write_json(path, case_to_json(replace(data, title=title)))
        yield path


_HELP = """\
Calculate couplings and other quantities in every combination, and rank them with reasons.

Quantities to vary are on sheet Tuning, which `--add` adds, or in the tables tuning and catalogue of a
case JSON. Each combination is a full start; results go to the result file, train.out.xlsx."""


TUNING = Study(
    spec=TUNING_SPEC,
    check=tuning_problems,
    takes_worst_phase=True,
    calculate=_calculate,
    help=_HELP,
    options=(
        Option(
            "top", int, 5, "Number of best combinations to list and save as cases.", least=1,
            is_setting=False,
        ),
        Option(
            "cases", Path, None,
            "Save the best combinations as case JSON files, ready for recalc and new --from.",
            metavar="FOLDER", is_setting=False,
        ),
    ),
    terminal=_terminal,
    save=_save,
)  # fmt: skip
