"""The studies as worksheet functions: few combinations, few samples, and an end to their time.

The numbers are those of ``torsionbook tune``, ``tolerances`` and ``sensitivities``: the same plan, the
same units of work, the same rows. A cell must not keep a spreadsheet program waiting, so what asks for
more than the caps below is refused with the command that does it, and so is what takes too long here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from addin.contract.problems import first_of
from addin.contract.tables import result_table
from addin.worksheet.answers import (
    HEADERS,
    MODEL,
    UNITS,
    Rows,
    name_in_case,
    run_of,
    si_unit,
    system_for,
    table_cells,
)
from addin.worksheet.blocks import study_inputs_of
from addin.worksheet.models import MODELS, Model
from addin.worksheet.registry import Argument, Block, FunctionError, registered
from engine.case.study_inputs import DAMPING, DIAMETER, INERTIA, STIFFNESS, DisplayUnit, StudyInputs
from engine.errors import ModelError, Problem
from engine.start.by_turns import in_groups
from engine.studies.sensitivities.differences import differences
from engine.studies.sensitivities.plan import derivative_units, plan_derivatives
from engine.studies.sensitivities.sensitivities import gather_derivatives
from engine.studies.sensitivities.tables import derivative_rows, frequency_rows
from engine.studies.sensitivities.tangent import tangent_of
from engine.studies.tolerances.sample import (
    ToleranceSettings,
    evaluate,
    plan_tolerances,
    tolerance_problems,
    units_of,
)
from engine.studies.tolerances.tables import tolerance_tables
from engine.studies.tolerances.tolerances import summarise_sample
from engine.studies.tuning.checks import tuning_problems
from engine.studies.tuning.combinations import in_typed_units, plan_tuning
from engine.studies.tuning.evaluate import calculate_combinations
from engine.studies.tuning.tuning import TuningResult, rank_combinations, ranked_rows

#: Place of these functions among all, in lists and in the documentation.
ORDER = 100

#: Combinations and samples that a cell calculates. [count]
MOST_COMBINATIONS, MOST_SAMPLES = 100, 500
#: How long a cell may keep its spreadsheet program waiting. [s]
TIME_LIMIT = 30.0
#: Samples and seed unless said otherwise. [count]
USUAL_SAMPLES, USUAL_SEED = 200, 1
#: Columns of `TuningResults` that a formula shows.
TUNED_COLUMNS = (
    "Rank", "Combination", "Better", "Verdict", "Limits broken", "Allowable starts", "Worst margin",
    "Margin where", "Mode 1", "Mode 2", "Mode 3", "Peak-to-peak stress", "Reason",
)  # fmt: skip
#: What `TV_TOLERANCES` is asked for → the table of the study.
ANSWERS = {
    "starts": "StartsOfSample",
    "frequencies": "ToleranceFrequencies",
    "margins": "ToleranceMargins",
    "peaks": "TolerancePeaks",
    "drivers": "ToleranceDrivers",
}
#: What `TV_SENSITIVITIES` is asked for → the table of the study.
FOLLOWING = {"frequencies": "FrequencySensitivities", "start": "Sensitivities"}


def _in_time(
    command: str, work: Iterable[Any], do: Callable[[Any], Any], began: float
) -> list[Any]:
    """One piece of work after the other, as long as the cell has time since `began` [s]."""
    pieces = list(work)
    results: list[Any] = []
    for piece in pieces:
        if time.monotonic() - began > TIME_LIMIT:
            raise FunctionError(
                f"{100 * len(results) // len(pieces)} % was calculated in {TIME_LIMIT:g} s, the time "
                f"limit of a cell. Reduce the task, or run: torsionbook {command} FILE",
                "#N/A",
            )
        results.append(do(piece))
    return results


def _kept(model: Model, key: str, calculate: Callable[[], Any]) -> Any:
    """A study of a model, once; what else is asked of the model meanwhile does not wait for it."""
    found = MODELS.result_of_others(model, key)
    if found is None:
        try:
            found = calculate()
        except ModelError as wrong:
            raise FunctionError(str(wrong), "#NUM!") from None
        MODELS.keep(model, key, found)
    return found


def _refuse(problems: Sequence[Problem]) -> None:
    """Say what is wrong with the rows of a study, three sentences at the most."""
    if not problems:
        return
    sentences = []
    for problem in problems:
        row = f"row {problem.row}" if problem.row else None
        place = ", ".join(filter(None, (problem.table, row, problem.column)))
        sentences.append(f"{place}: {problem.message}")
    raise FunctionError(" ".join(first_of(sentences, 3)))


def _read(model: Model, blocks: Mapping[str, Block | None]) -> StudyInputs:
    """Study inputs of ranges."""
    given = {name: block for name, block in blocks.items() if block is not None}
    inputs, problems = study_inputs_of(model.case, given)
    _refuse(problems)
    return inputs


def _usual_units(system: str) -> dict[tuple[str, str], DisplayUnit]:
    """The units of the template, for words; those that a row is typed in go before."""
    found = {}
    for quantity, dimension in (
        (STIFFNESS, "torsional stiffness"), (DAMPING, "torsional damping"), (INERTIA, "inertia"),
        (DIAMETER, "length"), ("stress", "pressure"), ("torque", "torque"),
    ):  # fmt: skip
        unit, size = si_unit(dimension, system)
        found["", quantity] = DisplayUnit(unit.replace("*", " ").replace("^2", "²"), size)
    return found


@registered(
    "TV_TUNE",
    MODEL,
    Argument("Tuning", "block", "Table Tuning with headers; blank = Catalogue alone.", blank=True),
    Argument("Catalogue", "block", "Table Catalogue with headers and units.", True),
    UNITS,
    HEADERS,
    long=True,
    columns=len(TUNED_COLUMNS),
    example="=TV_TUNE(A1, Tuning!B6:H18)",
)
def tv_tune(
    handle: str,
    tuning: Block | None,
    catalogue: Block | None,
    units: str | None,
    headers: bool | None,
) -> Rows:
    """Every combination of a small table Tuning as a full start, ranked, with the reason of each.

    At most 100 combinations and 30 s: for more use `torsionbook tune`. Order, numbers and texts are
    those of the command and of sheet Tuning results, which has more columns, maps and crossings.
    """
    model = MODELS.of(handle)
    inputs = _read(model, {"Tuning": tuning, "Catalogue": catalogue})
    _refuse(tuning_problems(model.case, inputs))
    plan = plan_tuning(model.case, inputs)
    count = len(plan.combinations)
    if count > MOST_COMBINATIONS:
        raise FunctionError(
            f"Tuning: {count:,} combinations; a cell calculates at most {MOST_COMBINATIONS}. Give "
            "fewer values, or run: torsionbook tune FILE",
            "#NUM!",
        )

    def ranked() -> TuningResult:
        calculate = partial(calculate_combinations, model.case)
        batches = in_groups(plan.combinations)
        tried = _in_time("tune", batches, calculate, time.monotonic())
        return rank_combinations(model.case, plan, [one for some in tried for one in some])

    result = _kept(model, f"tune {plan.study_digest}", ranked)
    words = {**_usual_units(system_for(units, model)), **inputs.units}
    tried = [row.tried for row in result.rows]
    rows = ranked_rows(rank_combinations(model.case, in_typed_units(plan, words), tried, words))
    system = system_for(units, model)
    return table_cells("TuningResults", rows, system, headers, TUNED_COLUMNS)


@registered(
    "TV_TOLERANCES",
    MODEL,
    Argument("Scatter", "block", "Table Scatter with headers and units."),
    Argument(
        "Quantity",
        "text",
        "starts (default), frequencies, margins, peaks, or drivers (inputs that affect the "
        "allowable starts most).",
        True,
    ),
    Argument("Samples", "count", f"30 to {MOST_SAMPLES}; blank = {USUAL_SAMPLES}.", True),
    Argument(
        "Seed",
        "count",
        f"The same seed gives the same samples; blank = {USUAL_SEED}.",
        True,
        least=0,
    ),
    UNITS,
    HEADERS,
    long=True,
    columns=0,
    example='=TV_TOLERANCES(A1, Tolerances!B6:H23, "starts", 100)',
)
def tv_tolerances(
    handle: str,
    scatter: Block,
    quantity: str | None,
    samples: int | None,
    seed: int | None,
    units: str | None,
    headers: bool | None,
) -> Rows:
    """P10, P50 and P90 of starts, frequencies, margins or peaks, from the scatter of the inputs.

    A Latin hypercube of at most 500 samples, in at most 30 s: `torsionbook tolerances` takes any
    number, and shows whether it converged. The same samples and seed give the same numbers there.
    """
    asked = name_in_case("Quantity", quantity or "starts", list(ANSWERS))
    model, plain = run_of(handle)
    if samples is not None and samples > MOST_SAMPLES:
        raise FunctionError(
            f"Samples: found {samples:,}; a cell calculates at most {MOST_SAMPLES}. For more, run: "
            f"torsionbook tolerances FILE --samples {samples}",
            "#NUM!",
        )
    inputs = _read(model, {"Scatter": scatter})
    settings = ToleranceSettings(samples or USUAL_SAMPLES, USUAL_SEED if seed is None else seed)
    _refuse(tolerance_problems(model.case, inputs.scatter, settings))
    plan = plan_tolerances(model.case, inputs.scatter, settings, nominal=plain.results)

    def calculate() -> Mapping[str, Any]:
        began = time.monotonic()
        size = 1 if len(units_of(plan)) == plan.n_runs else 10
        return tolerance_tables(
            summarise_sample(plan, _in_time("tolerances", units_of(plan, size), evaluate, began))
        )

    tables = _kept(model, f"tolerances {plan.digest}", calculate)
    rows = tables[ANSWERS[asked]]
    if not rows:
        raise FunctionError(f"The case has no {asked} to vary.", "#N/A")
    return table_cells(ANSWERS[asked], rows, system_for(units, model), headers)


@registered(
    "TV_SENSITIVITIES",
    MODEL,
    Argument(
        "Of", "text", "frequencies (default), or start (peak stress and allowable starts).", True
    ),
    UNITS,
    HEADERS,
    long=True,
    columns=0,
    example="=TV_SENSITIVITIES(A1)",
)
def tv_sensitivities(handle: str, of: str | None, units: str | None, headers: bool | None) -> Rows:
    """Sensitivity of frequencies, or of peak stress and starts, to every stiffness, inertia and so on.

    Frequencies: relative change / relative change of the quantity, ± half its share of the energy.
    Start: effect of + 1 % of each quantity, by the derivative and in runs at ± 1 %, in at most 30 s.
    """
    asked = name_in_case("Of", of or "frequencies", list(FOLLOWING))
    model, plain = run_of(handle)

    def calculate() -> list[dict[str, Any]]:
        began = time.monotonic()
        plan = plan_derivatives(model.case, nominal=plain.results)
        if asked == "frequencies":
            return frequency_rows(gather_derivatives(plan, [], None))
        parts = _in_time("sensitivities", derivative_units(plan), differences, began)
        return derivative_rows(gather_derivatives(plan, parts, tangent_of(plan)))

    rows = _kept(model, f"sensitivities {asked}", calculate)
    if not rows:
        raise FunctionError(
            "No sensitivities: there are no peaks of a start to differentiate.", "#N/A"
        )
    spec = result_table(FOLLOWING[asked])
    # of the modes those that there are
    columns = [f.name for f in spec.written_columns if f in spec.columns or f.key in rows[0]]
    return table_cells(spec.name, rows, system_for(units, model), headers, columns)
