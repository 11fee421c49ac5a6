"""Whether a file is one that torsionbook wrote: results, errors, a summary; none other is replaced."""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from addin.xlsx.places import refuse_no_end

#: What a programme is written to.
RESULT, RESULT_CSV = "results.parquet", "results.csv"

#: Columns of the result after those of the table, each with its kind and the field of
#: `addin.calculation.key_figures.KeyFigures` that it shows, if any. Units are SI and in the names.
RESULT_COLUMNS: tuple[tuple[str, str, str], ...] = (
    ("outcome", "string", ""),
    ("reason", "string", ""),
    ("verdict", "string", "verdict"),
    ("checks_not_judged", "int64", "not_judged"),
    ("start", "string", "outcome"),
    ("mode_1_Hz", "double", ""),
    ("mode_2_Hz", "double", ""),
    ("mode_3_Hz", "double", ""),
    ("worst_margin", "double", "margin"),
    ("worst_margin_at", "string", "margin_where"),
    ("peak_torque_N_m", "double", "peak_torque"),
    ("peak_torque_over_rated", "double", "peak_over_rated"),
    ("peak_torque_at", "string", "peak_where"),
    ("peak_to_peak_stress_Pa", "double", "stress"),
    ("peak_to_peak_stress_at", "string", "stress_where"),
    ("torque_reversals", "int64", "reversals"),
    ("torque_reverses_at", "string", "reversals_where"),
    ("allowable_starts", "double", "starts"),
    ("starts_unlimited", "bool", "starts_unlimited"),
    ("starts_governed_by", "string", "starts_where"),
    ("warnings", "string", ""),
    ("case_sha256", "string", ""),
    ("seconds", "double", ""),
)

#: Columns of the result before those of the table.
_FIRST = ("row", "name")
#: What the Parquet file says of its columns: one that somebody changed and saved is no longer ours.
_STATED = b"torsionbook.columns"
#: More than the headers of a CSV ever take. [characters]
_MOST_HEADERS = 1_000_000
#: How results begin, and the errors of an input that has none, as this program writes them.
_JSON_BEGINS = re.compile(
    rb'\s*\{\s*"format"\s*:\s*\d+\s*,\s*(?P<digest>"case_sha256"\s*:\s*"[0-9a-f]{64}"\s*,\s*)?'
    rb'"version"\s*:\s*"[^"]{0,99}"\s*,\s*"(?:outcome|warnings)"\s*:'
)
#: More than that ever takes. [bytes]
_LOOKED_AT = 1000
#: What both hold, in whatever order another program saved them.
_JSON_KEYS = frozenset({"format", "version", "warnings", "errors"})
#: Keys of the JSON that this program writes of results, errors, studies, verifications and differences.
_NO_CASE_HAS = frozenset({"errors", "same_inputs"})
#: Sheets of a summary, and it has no others.
SUMMARY_SHEETS = ("Files", "Errors")
#: More than the list of sheets of a summary ever takes. [bytes]
_MOST_SHEETS = 100_000
#: How the CSV of a summary begins, also where a spreadsheet program saved it with other separators.
_CSV_BEGINS = re.compile(rb'(?:\xef\xbb\xbf)?"?File"?[,;\t]"?Outcome"?[,;\t]"?Verdict"?[,;\t]')


def stated_columns(names: Sequence[str]) -> dict[bytes, bytes]:
    """What a result in Parquet carries with it, by which it is known again."""
    return {_STATED: json.dumps(list(names)).encode()}


def in_the_way(folder: Path, names: Sequence[str]) -> Iterator[Path]:
    """Files of somebody else where results of these names would be put."""
    for name in names:
        place = folder / name
        if os.path.lexists(place) and not IS_OURS[name](place):
            yield place


def is_result(path: Path) -> bool:
    """Look at the columns of a Parquet file.

    Returns
    -------
    bool
        True for those that it states itself, and for those of this version where it states none; False where
        pyarrow, which reads them, is not installed. [flag]
    """
    try:
        import pyarrow as pa
        from pyarrow.parquet import read_schema
    except ImportError:
        return False
    try:
        schema = read_schema(path) if os.path.isfile(path) else None
        if schema is None:
            return False
        stated = (schema.metadata or {}).get(_STATED)
        if stated is not None:
            return bool(json.loads(stated) == schema.names)
    except (OSError, ValueError, RecursionError, pa.ArrowException):
        return False
    ours = tuple(name for name, *_ in RESULT_COLUMNS)
    return tuple(schema.names[:2]) == _FIRST and tuple(schema.names[-len(ours) :]) == ours


def is_result_csv(path: Path) -> bool:
    """Look at the headers of a CSV."""
    if not os.path.isfile(path):  # such as a device, which has no end
        return False
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            headers = file.readline(_MOST_HEADERS)
    except (OSError, UnicodeDecodeError):
        return False
    first, last = (
        r"[,;\t]".join(names) for names in (_FIRST, [name for name, *_ in RESULT_COLUMNS])
    )
    return re.match(rf"{first}[,;\t].*{last}\s*$", headers, re.DOTALL) is not None


#: How each result of a programme is known to be one that this program wrote.
IS_OURS = {RESULT: is_result, RESULT_CSV: is_result_csv}


def is_result_json(path: Path) -> bool:
    """Look at what a file holds.

    Returns
    -------
    bool
        True for results and for the errors of an input; False also where it cannot be read. [flag]
    """
    return _json_kind(path) != ""


def holds_results(path: Path) -> bool:
    """Whether it holds results, not the errors of an input that has none."""
    return _json_kind(path) == "results"


def _json_kind(path: Path) -> str:
    """``results``, ``errors``, or nothing where it is neither."""
    if not os.path.isfile(path):  # such as a device, which has no end
        return ""
    try:
        with open(path, "rb") as file:
            begins = _JSON_BEGINS.match(file.read(_LOOKED_AT))
        if begins is not None:
            return "results" if begins["digest"] else "errors"
        content: Any = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return ""
    if not isinstance(content, dict) or not content.keys() >= _JSON_KEYS:
        return ""
    return "results" if "case_sha256" in content else "errors"


def is_case(content: object) -> bool:
    """Whether what a JSON holds is a case, not what this program calculates."""
    return isinstance(content, dict) and "format" in content and _NO_CASE_HAS.isdisjoint(content)


def is_summary(path: Path) -> bool:
    """Look at the sheets of a workbook."""
    return sheets_of(path) == SUMMARY_SHEETS


def sheets_of(path: Path) -> tuple[str, ...]:
    """Names of the sheets of a workbook; none where it is no workbook."""
    try:
        refuse_no_end(path)
        with zipfile.ZipFile(path) as package, package.open("xl/workbook.xml") as part:
            text = part.read(_MOST_SHEETS).decode("utf-8", "replace")
    except (OSError, KeyError, zipfile.BadZipFile, NotImplementedError, RuntimeError):
        return ()
    return tuple(re.findall(r'<sheet name="([^"]*)"', text))


def is_summary_csv(path: Path) -> bool:
    """Look at the headers of a CSV."""
    try:
        refuse_no_end(path)
        with open(path, "rb") as file:
            return _CSV_BEGINS.match(file.read(100)) is not None
    except OSError:
        return False
