"""Studies of two workbooks: what is asked in them, and what they found where both hold."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from addin.contract.studies.registry import STUDIES
from addin.contract.tables import STUDY_INPUT_TABLES, STUDY_RESULT_TABLES, TableSpec
from addin.diff.changes import Change, StudyDifferences
from addin.diff.files import ComparedFile
from addin.diff.inputs import Renamed, compare_table
from addin.diff.results import compare_rows
from addin.diff.units import Units
from addin.recorded.studies import RecordedStudy

#: Words that follow from the numbers beside them.
_WORDS = frozenset({"Reason", "Note", "Why", "Broken"})
#: Result tables that have a name for each row; the others are maps and numbers behind charts.
_COMPARED = tuple(spec for spec in STUDY_RESULT_TABLES if spec.row_name)
#: What a combination is in numbers of its case, behind what was chosen; brackets of a maker's name stay.
_IN_NUMBERS = re.compile(r"(?<=×) \([^()]*\)| \(as is\)$")


def compare_studies(
    first: ComparedFile, second: ComparedFile, units: Units, renamed: Renamed
) -> StudyDifferences:
    """What differs in the studies of two files."""
    inputs: list[Change] = []
    same_inputs = 0
    if first.study_inputs is not None and second.study_inputs is not None:
        for spec in STUDY_INPUT_TABLES:
            more, count = compare_table(
                spec, _rows(first, spec), _rows(second, spec), units, renamed
            )
            inputs += more
            same_inputs += count
    notes: list[str] = []
    results: list[Change] = []
    same_results = 0
    by_key = [{study.key: study for study in side.studies} for side in (first, second)]
    for key, sheet in ((spec.key, spec.sheet) for spec in STUDIES):
        pair = [studies.get(key) for studies in by_key]
        if pair == [None, None]:
            continue
        why = _why_not(sheet, pair)
        if why:
            notes.append(why)
            continue
        old, new = (study for study in pair if study is not None)
        cut = " and ".join(x for x, s in zip("AB", (old, new), strict=True) if s.is_cut_short)
        if cut:
            notes.append(
                f"Sheet {sheet} in {cut} contains an incomplete study, stopped by Ctrl-C, which may "
                "explain some differences."
            )
        for spec in _COMPARED:
            if spec.name in old.tables and spec.name in new.tables:
                before, after = (_plain(study.tables[spec.name]) for study in (old, new))
                more, count = compare_rows(spec, before, after, units, renamed)
                results += more
                same_results += count
    return StudyDifferences(tuple(notes), tuple(inputs), tuple(results), same_inputs, same_results)


def _why_not(sheet: str, pair: Sequence[RecordedStudy | None]) -> str:
    """Why the results of a study are not compared; empty where they are."""
    studies = dict(zip("AB", pair, strict=True))
    for letter, study in studies.items():
        if study is None:
            return f"Sheet {sheet} is not compared: {letter} does not contain the study."
    for letter, study in studies.items():
        if study is not None and study.outdated:
            return f"Sheet {sheet} is not compared: in {letter} {study.outdated}."
    return ""


def _rows(side: ComparedFile, spec: TableSpec) -> list[dict[str, Any]]:
    """Rows of a study sheet by header."""
    inputs = side.study_inputs
    rows = () if inputs is None else inputs.rows(spec.name)
    if spec.name != "Tuning":
        return [{f.name: getattr(row, f.attribute) for f in spec.columns} for row in rows]
    return [
        {
            "Element": row.element,
            "Quantity": row.quantity,
            "Unit": "relative to the value in the case" if row.relative else "SI",
            "Values": "; ".join(f"{value:.6g}" for value in row.values) or None,
            "From": row.from_,
            "To": row.to,
            "Steps": row.steps,
        }
        for row in rows
    ]


def _plain(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows without sentences; a combination is called by what was chosen alone."""
    plain = [{k: v for k, v in row.items() if k not in _WORDS} for row in rows]
    for row in plain:
        if isinstance(row.get("Combination"), str):
            row["Combination"] = _IN_NUMBERS.sub("", row["Combination"])
    return plain
