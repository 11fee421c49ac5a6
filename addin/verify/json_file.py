"""A result JSON beside its case: its results against those that follow from the case."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from addin.contract.digests import short_digest
from addin.contract.tables import RESULT_TABLES, TableSpec, json_key
from addin.contract.version import product_version
from addin.reading.typed_case import CaseInput
from addin.recorded.provenance import json_provenance, rows_of
from addin.verify.allowances import Allowances
from addin.verify.compare import RecordedValue, agreement, is_number
from addin.verify.findings import (
    Agreement,
    Counts,
    Finding,
    Verification,
    concluded,
    not_calculated,
)
from addin.verify.tables import TablePair, compare_tables
from addin.writing.recalculate import recalculate_case
from addin.writing.results_json import results_to_json
from addin.xlsx.places import refuse_no_end
from engine.case.data import case_digest

#: Keys beside the tables whose values are compared wherever they are nested.
_NESTED = (
    "outcome",
    "overall",
    "headline",
    "startup",
    "modes",
    "damped_eigenvalues",
    "plans",
    "sensitivity",
    "warnings",
)


def read_results_json(path: Path) -> dict[str, Any]:
    """A result JSON as recorded.

    Raises
    ------
    ValueError
        When it is no result JSON; the sentence says why.
    OSError
        When it cannot be read.
    """
    refuse_no_end(path)
    try:
        content = json.loads(
            path.read_text(encoding="utf-8"), parse_int=_bounded, parse_constant=str
        )
    except (UnicodeDecodeError, RecursionError, json.JSONDecodeError) as error:
        raise ValueError(f"{path.name} is not JSON ({error}).") from error
    if not isinstance(content, dict) or "case_sha256" not in content:
        raise ValueError(
            f"{path.name} contains no results (no key case_sha256). Name a file written by "
            "torsionbook recalc --json."
        )
    return content


def _bounded(digits: str) -> int | str:
    """A whole number that a double can hold; any other stays words."""
    return int(digits) if len(digits) < 300 else digits


def header_rows(spec: TableSpec, rows: Any) -> list[dict[str, Any]]:
    """Rows of a JSON table under the headers of the workbook.

    Parameters
    ----------
    spec : TableSpec
        Its table.
    rows : list of dict
        Rows by JSON key. [SI]

    Returns
    -------
    list of dict
        Keys that no column has stay as they are. [SI]
    """
    headers = {field.key: field.name for field in spec.columns}
    if spec.repeated is not None:
        head = f"{spec.repeated.key}_"
        keys = {key for row in rows for key in row if key.startswith(head)}
        headers |= {key: f"{spec.repeated.name} {key.removeprefix(head)}" for key in keys}
    return [{headers.get(key, key): value for key, value in row.items()} for row in rows]


def verify_results_json(
    path: Path,
    content: Mapping[str, Any],
    read: CaseInput,
    *,
    within: Agreement = Agreement.ERROR,
    on_stage: Callable[[str], None] | None = None,
) -> Verification:
    """Calculate a case again and compare a result JSON with it.

    Parameters
    ----------
    path : Path
        The result JSON. [path]
    content : mapping
        What it holds. [SI]
    read : CaseInput
        The case, without problems. [SI]
    within : Agreement
        What is accepted.
    on_stage : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Verification
        Result by result; places are paths such as ``steady_state[3].torque``.
    """
    recorded = json_provenance(content)
    made_by = str(content.get("version") or "")
    about = Verification(
        path, "", "", f"torsionbook {made_by}" if made_by else "",
        f"torsionbook {product_version()}", str(content.get("case_sha256") or ""),
        case_digest(read.data), recorded.settings, within,
    )  # fmt: skip
    findings = [*_on_digests(about, recorded.digest)]
    run, problems = recalculate_case(read, recorded.settings, on_stage)
    if run is None:
        return not_calculated(about, problems)
    expected = results_to_json(run, product_version())
    missing = [
        Finding("row missing", spec.key, "", "the table is missing", spec.name)
        for spec in RESULT_TABLES
        if spec.key in expected and spec.key not in content
    ]
    allowances = Allowances(run.results)
    counts, more = compare_tables(
        _table_pairs(content, expected, about.other_release), allowances, about
    )
    findings += missing + more
    allowed = allowances.of_words()
    rest = Counts("the rest", "")
    counts.append(rest)
    nested = [key for key in _NESTED if key in content or not about.other_release]
    for key in nested:
        found = _nested(key, content.get(key), expected.get(key), allowed, rest)
        findings += [f for f, how in found if how > within or how is Agreement.DIFFERENT]
    return concluded(about, counts, findings)


def _on_digests(about: Verification, of_audit_table: str) -> Iterator[Finding]:
    if not about.same_inputs:
        yield Finding(
            "digest", "", "case_sha256",
            f"the results were calculated from inputs with SHA-256 {short_digest(about.recorded)}, "
            f"but the case has {short_digest(about.inputs)}. Name the case that belongs to the results.",
            found=about.recorded, expected=about.inputs,
        )  # fmt: skip
    if of_audit_table and of_audit_table != about.recorded:
        yield Finding("digest", "", "audit", "case_sha256 and table Audit disagree")


def _table_pairs(
    content: Mapping[str, Any], expected: Mapping[str, Any], other_release: str
) -> Iterator[TablePair]:
    """Tables of both; columns that another release did not have are not compared."""
    for spec in RESULT_TABLES:
        if spec.key not in expected or spec.key not in content:
            continue
        follows = header_rows(spec, expected[spec.key])
        stands = header_rows(spec, rows_of(content, spec.name))
        columns = tuple(dict.fromkeys(column for row in (*follows, *stands) for column in row))
        if other_release:
            known = {column for row in stands for column in row}
            columns = tuple(column for column in columns if column in known)
        keys = {column: json_key(column) for column in columns}
        keys |= {field.name: field.key for field in spec.columns if field.name in keys}
        rows = [
            {
                column: RecordedValue(row.get(column), f"{spec.key}[{k}].{key}")
                for column, key in keys.items()
            }
            for k, row in enumerate(stands)
        ]
        yield TablePair(spec.name, "", columns, follows, rows)


def _nested(
    path: str, found: Any, expected: Any, allowed: float | None, counts: Counts
) -> Iterator[tuple[Finding, Agreement]]:
    """Values inside objects and lists, each under its path."""
    if isinstance(expected, Mapping) or isinstance(found, Mapping):
        computed = expected if isinstance(expected, Mapping) else {}
        other = found if isinstance(found, Mapping) else {}
        for key in dict.fromkeys([*computed, *other]):
            yield from _nested(f"{path}.{key}", other.get(key), computed.get(key), allowed, counts)
        return
    if isinstance(expected, list) or isinstance(found, list):
        many = expected if isinstance(expected, list) else [expected]
        others = found if isinstance(found, list) else [found]
        for k in range(max(len(many), len(others))):
            there, follows = (values[k] if k < len(values) else None for values in (others, many))
            yield from _nested(f"{path}[{k}]", there, follows, allowed, counts)
        return
    share = allowed * abs(expected) if allowed and is_number(expected) else allowed
    how = agreement(RecordedValue(found, path), expected, share)
    counts.of[how] += 1
    if how is not Agreement.BITS:
        sentence = f"{found} is recorded, recalculation gives {expected}"
        yield Finding("different", "", path, sentence, found=found, expected=expected), how
