"""Results → JSON, and the errors of an input that could not be calculated.

Rows come from the engine in SI under the JSON keys of `addin.contract.tables`; here they are made plain and
held against that table, so that a key the contract does not know or a number that is not finite
never leaves the program.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from addin.contract.banner import headline
from addin.contract.json_formats import RESULTS_FORMAT
from addin.contract.problems import CellProblem, shortened
from addin.contract.tables import RESULT_TABLES, TableSpec, result_table
from engine.errors import InternalError

if TYPE_CHECKING:  # a schema or an error is written without the engine
    from addin.calculation.calculation import Calculation

_STARTUP = (
    "outcome", "time", "end_speed", "in_step_time", "in_step_slip", "pull_in", "bearing_forces",
)  # fmt: skip


def results_to_json(run: Calculation, version: str) -> dict[str, Any]:
    """Results as JSON object of the contract.

    Parameters
    ----------
    run : Calculation
        What was calculated. [SI]
    version : str
        Version of this program. [text]

    Returns
    -------
    dict
        Ready for `json.dumps`; absent values have no key.

    Raises
    ------
    InternalError
        When a row has an unknown key or a number that is not finite.
    """
    content: dict[str, Any] = {
        "format": RESULTS_FORMAT,
        "case_sha256": run.case_sha256,
        "version": version,
        "outcome": run.outcome,
        **overall_words(run),
        "warnings": list(run.warnings),
        "errors": [],
    }
    unknown = set(run.tables) - {spec.name for spec in RESULT_TABLES}
    if unknown:
        raise InternalError(
            f"results contain tables unknown to addin.contract.tables: {sorted(unknown)}"
        )
    for spec in RESULT_TABLES:
        if spec.name in run.tables:
            content[spec.key] = [_row(row, spec) for row in run.tables[spec.name]]
    if run.startup is not None:
        content["startup"] = {
            key: _nested(run.startup[key], f"startup.{key}")
            for key in _STARTUP
            if run.startup.get(key) is not None
        }
    return {**content, **run.details}


def overall_words(run: Calculation) -> dict[str, str]:
    """The overall verdict, and the banner of sheet Summary."""
    rows = run.tables.get("Verdicts", ())
    if not rows:
        return {}
    overall, *checks = rows
    verdicts = [str(row["verdict"]) for row in checks]
    words = headline(overall, verdicts, len(run.warnings))
    return {"overall": str(overall["verdict"]), "headline": words}


def table_rows(name: str, rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of one result table as plain values.

    Parameters
    ----------
    name : str
        Name of the result table. [name]
    rows : iterable of mapping
        Its rows by JSON key. [SI]

    Returns
    -------
    list of dict
        Ready for `json.dumps`; absent values have no key.
    """
    return [_row(row, result_table(name)) for row in rows]


def errors_to_json(
    problems: Iterable[CellProblem], version: str, warnings: Iterable[str] = ()
) -> dict[str, Any]:
    """The JSON object of an input that could not be calculated."""
    return {
        "format": RESULTS_FORMAT,
        "version": version,
        "warnings": list(warnings),
        "errors": [problem.as_json() for problem in problems],
    }


def storable(value: Any) -> Any:
    """A single value JSON can hold: a damaged file may state numbers that are none, or lists of them."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return shortened(str(value))


def _row(row: Mapping[str, Any], spec: TableSpec) -> dict[str, Any]:
    """One row with plain values; absent ones left out, but for the starts of an unlimited shaft."""
    known = {column.key for column in spec.columns} | {field.key for field in spec.json_only}
    values: dict[str, Any] = {}
    for key, value in row.items():
        if key not in known and not _is_repeated(key, spec):
            raise InternalError(f"a row of {spec.name} has the unknown key {key!r}")
        if value is not None:
            values[key] = _plain(value, f"{spec.key}.{key}")
    if values.get("unlimited") is True and "allowable_starts" in known:
        values["allowable_starts"] = None
    return values


def _is_repeated(key: str, spec: TableSpec) -> bool:
    """Whether a key is one of the repeated columns, such as ``mode_3``."""
    if spec.repeated is None:
        return False
    head, _, number = key.rpartition("_")
    return head == spec.repeated.key and number.isdigit() and number[0] != "0"


def _nested(value: Any, where: str) -> Any:
    """A plain value, or an object or list of them with absent values left out."""
    if isinstance(value, Mapping):
        return {k: _nested(v, f"{where}.{k}") for k, v in value.items() if v is not None}
    if isinstance(value, (list, tuple)):
        return [_nested(v, where) for v in value]
    return _plain(value, where)


def _plain(value: Any, where: str) -> Any:
    """A Python number, text or flag; scalars of numpy are converted."""
    value = value.item() if hasattr(value, "item") else value
    if isinstance(value, float) and not math.isfinite(value):
        raise InternalError(f"the result {where} is {value}, not a finite number")
    if isinstance(value, (bool, int, float, str)):
        return value
    raise InternalError(f"the result {where} is a {type(value).__name__}, not a number or text")
