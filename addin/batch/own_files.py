"""Whether a file is a result that a programme of cases wrote: none other is ever replaced by one."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

__all__ = [
    "RESULT",
    "RESULT_COLUMNS",
    "RESULT_CSV",
    "in_the_way",
    "is_result",
    "is_result_csv",
    "stated_columns",
]

#: What a programme is written to.
RESULT, RESULT_CSV = "results.parquet", "results.csv"

#: Columns of the result after those of the table. Units are SI and in the names.
RESULT_COLUMNS: tuple[tuple[str, str], ...] = (
    ("outcome", "string"),
    ("reason", "string"),
    ("verdict", "string"),
    ("checks_not_judged", "int64"),
    ("start", "string"),
    ("mode_1_Hz", "double"),
    ("mode_2_Hz", "double"),
    ("mode_3_Hz", "double"),
    ("worst_margin", "double"),
    ("worst_margin_at", "string"),
    ("peak_torque_N_m", "double"),
    ("peak_torque_over_rated", "double"),
    ("peak_torque_at", "string"),
    ("peak_to_peak_stress_Pa", "double"),
    ("peak_to_peak_stress_at", "string"),
    ("torque_reversals", "int64"),
    ("torque_reverses_at", "string"),
    ("allowable_starts", "double"),
    ("starts_unlimited", "bool"),
    ("starts_governed_by", "string"),
    ("warnings", "string"),
    ("case_sha256", "string"),
    ("seconds", "double"),
)

#: Columns of the result before those of the table.
_FIRST = ("row", "name")
#: What the Parquet file says of its columns: one that somebody changed and saved is no longer ours.
_STATED = b"torsionbook.columns"
#: More than the headers of a CSV ever take. [characters]
_MOST = 1_000_000


def stated_columns(names: Sequence[str]) -> dict[bytes, bytes]:
    """What a result in Parquet carries with it, by which it is known again."""
    return {_STATED: json.dumps(list(names)).encode()}


def in_the_way(folder: Path, as_csv: bool) -> Iterator[Path]:
    """Files of somebody else where results would be put."""
    for name, is_ours, is_written in (
        (RESULT, is_result, True),
        (RESULT_CSV, is_result_csv, as_csv),
    ):
        place = folder / name
        if is_written and os.path.lexists(place) and not is_ours(place):
            yield place


def is_result(path: Path) -> bool:
    """Look at the columns of a Parquet file.

    Returns
    -------
    bool
        True for those that it states itself, and for those of this version where it states none. [flag]
    """
    import pyarrow as pa
    from pyarrow.parquet import read_schema

    try:
        schema = read_schema(path) if path.is_file() else None
        if schema is None:
            return False
        stated = (schema.metadata or {}).get(_STATED)
        if stated is not None:
            return bool(json.loads(stated) == schema.names)
    except (OSError, ValueError, RecursionError, pa.ArrowException):
        return False
    ours = tuple(name for name, _ in RESULT_COLUMNS)
    return tuple(schema.names[:2]) == _FIRST and tuple(schema.names[-len(ours) :]) == ours


def is_result_csv(path: Path) -> bool:
    """Look at the headers of a CSV."""
    if not path.is_file():  # such as a device, which has no end
        return False
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            headers = file.readline(_MOST)
    except (OSError, UnicodeDecodeError):
        return False
    first, last = (r"[,;\t]".join(names) for names in (_FIRST, [n for n, _ in RESULT_COLUMNS]))
    return re.match(rf"{first}[,;\t].*{last}\s*$", headers, re.DOTALL) is not None
