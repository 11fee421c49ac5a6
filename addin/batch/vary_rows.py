"""Rows of a programme: values put into the base case, calculated, and returned as one line of results. Runs in any process."""

from __future__ import annotations

import pickle
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from addin.batch.own_files import RESULT_COLUMNS
from addin.batch.records import DONE, FAULT, WRONG_INPUT
from addin.calculation.key_figures import key_figures
from addin.contract.problems import shortened
from addin.contract.tables import SCALAR_TABLE
from addin.contract.units import UnitScale
from addin.reading.input_names import NamedInput, entry_of
from addin.reading.typed_case import (
    Findings,
    Typed,
    TypedCase,
    all_problems,
    in_typed_units,
    to_case_data,
)
from engine.case.case import Case
from engine.case.data import TABLES, CaseData, case_digest
from engine.errors import CaseError, ModelError, Problem
from engine.results.tables import result_tables
from engine.run import run
from engine.start.by_turns import by_turns

_SIGNED = re.compile(r"\s*[+-]?[\d.,]+", re.ASCII)


@dataclass(frozen=True)
class Chunk:
    """The task of calculating some rows."""

    base: bytes  #: Pickled `TypedCase`. [bytes]
    columns: tuple[NamedInput, ...]  #: The table's columns, without the one of names.
    #: Row number, name and values of each row. [as read]
    rows: tuple[tuple[int, str | None, tuple[Any, ...]], ...]
    #: Fields of the case that the command line sets. [SI]
    overrides: Mapping[str, Any] = field(default_factory=dict)
    comma: bool = False  #: The comma is the decimal sign of the table.


def calculate_rows(task: Chunk) -> list[dict[str, Any]]:
    """Calculate the rows of a chunk; one that cannot be calculated is a row with the reason.

    Parameters
    ----------
    task : Chunk

    Returns
    -------
    list of dict
        Of the columns of the result. [SI]
    """
    base: TypedCase = pickle.loads(task.base)
    began = time.perf_counter()
    rows = [
        ({"row": n, "name": name}, _prepared(task, values, base)) for n, name, values in task.rows
    ]
    cases = {made.digest: made.case for _, made in rows if made.case is not None}
    answers = by_turns([partial(_answers, case, digest) for digest, case in cases.items()])
    known = dict(zip(cases, answers, strict=True))
    results = [row | made.inputs | known.get(made.digest, made.refusal) for row, made in rows]
    # of rows that are calculated side by side none has a time of its own
    seconds = (time.perf_counter() - began) / max(len(rows), 1)
    return [row | {"seconds": seconds} for row in results]


@dataclass(frozen=True)
class _Row:
    """One row before it is calculated."""

    inputs: dict[str, Any]  #: What was put in, for the result. [mixed]
    #: Outcome and reason, where there is no case.
    refusal: dict[str, Any] = field(default_factory=dict)
    case: Case | None = None  #: The case. [SI]
    digest: str = ""  #: Its own. [hex]


def _prepared(task: Chunk, values: Sequence[Any], base: TypedCase) -> _Row:
    columns = task.columns
    findings = Findings()
    typed = TypedCase(dict(base.scalars), {name: list(rows) for name, rows in base.tables.items()})
    inputs, relative = _put(task, values, typed, findings)
    if len(values) != len(columns):
        reason = f"the row has {len(values)} values, the table {len(columns)} columns."
        return _Row(inputs, _refused(WRONG_INPUT, reason))
    try:
        data = to_case_data(typed, findings)
        problems = all_problems(data, findings)
        if problems:
            reasons = [_reason(problem, columns, typed) for problem in problems]
            return _Row(inputs, _refused(WRONG_INPUT, "\n".join(reasons)))
        inputs |= {column.name: _in_case(column, data) for column in relative}
        case = Case(**(vars(data) | dict(task.overrides)))
        return _Row(inputs, {}, case, case_digest(data))
    except Exception as wrong:  # one row's fault never ends a programme; the row says what happened
        return _Row(inputs, _outcome_of(wrong))


def _outcome_of(wrong: Exception) -> dict[str, Any]:
    """What a row says that could not be calculated."""
    if isinstance(wrong, CaseError | ModelError):
        return _refused(WRONG_INPUT, str(wrong))
    return _refused(FAULT, f"an error inside torsionbook; please report it: {wrong!r}")


def _refused(outcome: str, reason: str) -> dict[str, Any]:
    return {"outcome": outcome, "reason": reason}


def _put(
    task: Chunk, values: Sequence[Any], typed: TypedCase, findings: Findings
) -> tuple[dict[str, Any], list[NamedInput]]:
    """Put the values of a row into a case.

    Returns what was put, for the result, and the columns of which only the case knows how much that
    is: texts such as ``12 %`` of the rated torque.
    """
    inputs: dict[str, Any] = {}
    relative = []
    for column, value in zip(task.columns, values, strict=False):
        if task.comma and isinstance(value, str) and column.spec.is_number:
            value = _with_point(column, value, findings)
        entry = entry_of(column, value, findings)
        inputs[column.name] = _shown(column, entry)
        if entry is None:
            continue
        if inputs[column.name] is None:
            relative.append(column)
        table, row, name = column.place
        if row is None:
            typed.scalars[name] = entry
        else:
            rows = typed.tables[table]
            rows[row - 1] = {**rows[row - 1], name: entry}
    return inputs, relative


def _in_case(column: NamedInput, data: CaseData) -> float | None:
    """The input of a case in the unit of its column; None where that unit depends on the case, too."""
    table, row, _ = column.place
    holder: Any = data if row is None else getattr(data, TABLES[table][0])[row - 1]
    value = getattr(holder, column.spec.attribute)
    scale = column.scale or UnitScale(1.0)
    return None if value is None or scale.base else scale.from_si(value)


def _with_point(column: NamedInput, value: str, findings: Findings) -> str:
    """A number whose decimal sign is the comma; blank where it has points as well, which is noted."""
    number = _SIGNED.match(value)
    if number is None:
        return value
    if "." in number.group():
        findings.add(
            column.place,
            shortened(value),
            "a number with a decimal comma and no points",
            f"found '{shortened(value)}'; this table uses decimal commas. Write the number "
            "without thousands separators.",
        )
        return ""
    return number.group().replace(",", ".") + value[number.end() :]


def _shown(column: NamedInput, entry: Typed | str | None) -> Any:
    """An input for the result, in the unit of its column; None where that cannot be."""
    if not isinstance(entry, Typed):
        return entry
    own, there = entry.scale, column.scale or UnitScale(1.0)
    if own == there:
        return entry.number
    return None if own.base or there.base else there.from_si(own.to_si(entry.number))


def _reason(problem: Problem, columns: Sequence[NamedInput], typed: TypedCase) -> str:
    """What is wrong in a row, by its column where it is one of the table's."""
    message = in_typed_units(problem, typed).message
    place = (problem.table, problem.row, problem.column)
    for column in columns:
        if column.place == place:
            return f"{column.name}: {message}"
    row = "" if problem.row is None else f"[{problem.row}]"
    where = problem.column if problem.table == SCALAR_TABLE else f"{problem.table}{row}.{problem.column}"  # fmt: skip
    return f"{where.rstrip('.')} (of the base case): {message}"


def _answers(case: Case, digest: str) -> dict[str, Any]:
    """The numbers of one case, or why there are none."""
    try:
        results = run(case)
        figures = key_figures(results, result_tables(results)["StartupPeaks"])
    except Exception as wrong:
        return _outcome_of(wrong)
    return {
        "outcome": DONE,
        **{f"mode_{n}_Hz": f for n, f in enumerate(figures.frequencies, start=1)},
        **{name: getattr(figures, key) for name, _, key in RESULT_COLUMNS if key},
        "warnings": "\n".join(results.warnings) or None,
        "case_sha256": digest,
    }
