"""Every study, found in this folder, and what is derived from all of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from addin.contract.charts import CHARTS, ChartSpec
from addin.contract.field import IncompleteRecord
from addin.contract.records import find_records
from addin.contract.sheet import NEVER, Sheet, readable, side_by_side
from addin.contract.study_spec import StudySpec

_RECORDS = find_records(__package__, StudySpec)
for _path, _study in _RECORDS.items():
    if not _path.endswith(f"/{_study.key}.py"):
        raise IncompleteRecord(f"{_path} holds study {_study.key}: name the file after the key")
    _study.complete(_path)

#: Every study, in the order of its sheets.
STUDIES: tuple[StudySpec, ...] = tuple(sorted(_RECORDS.values(), key=lambda study: study.order))

#: Their sheets and the parts of them, printed in letters of 8 pt; one that is never printed keeps the usual ones.
STUDY_SHEETS: tuple[Sheet, ...] = side_by_side(
    [sheet if sheet.hidden else readable(sheet) for study in STUDIES for sheet in study.sheets]
)

#: Parts of them that were sheets in earlier releases. [names]
EARLIER_STUDY_SHEETS = frozenset(part.name for part in STUDY_SHEETS if part.on)

#: Rows of table `StudyFacts`: what was found in words, and which inputs it belongs to.
STUDY_FACTS: tuple[tuple[str, str], ...] = tuple(
    (f"{study.key}_{fact}", f"Sheet {study.sheet}: {meaning}")
    for study in STUDIES
    for fact, meaning in (
        ("Sentence", "summary of the result"),
        ("Stamp", "who calculated it, when, from which inputs"),
        ("SHA256", "SHA-256 of the inputs of its case"),
        ("Tables", "SHA-256 of each table as written, shortened"),
    )
)

#: The hidden sheet of that table.
STUDY_FACTS_SHEET = "StudyFacts"

#: Every chart by name, those of the studies last.
EVERY_CHART: Mapping[str, ChartSpec] = {
    **CHARTS,
    **{spec.name: spec for study in STUDIES for spec in study.charts},
}

#: From the least to the most of a map, by rank: starts differ by powers of ten.
COLOUR_SCALE: Mapping[str, str | float] = {
    "type": "3_color_scale",
    "min_color": "#F4B6A6",
    "mid_color": "#FBE9B7",
    "max_color": "#A9D6B2",
    "mid_type": "percentile",
    "mid_value": 50.0,
}


def study_of(key: str) -> StudySpec:
    """The study of a key."""
    return next(study for study in STUDIES if study.key == key)


def printed_parts(study: StudySpec) -> list[Sheet]:
    """Parts of the sheet of its results, at their places, without those that are never printed."""
    return [
        part
        for part in STUDY_SHEETS
        if part.printed_for != NEVER
        and not part.hidden
        and set(part.tables) & set(study.result_names)
    ]


def with_studies(sheets: Sequence[Sheet]) -> list[Sheet]:
    """The sheets of a workbook with those of the studies: inputs behind inputs, results behind results."""
    inputs = max(k for k, sheet in enumerate(sheets) if sheet.kind == "input") + 1
    results = max(k for k, sheet in enumerate(sheets) if sheet.name == "Accuracy") + 1
    return [
        *sheets[:inputs],
        *(sheet for sheet in STUDY_SHEETS if sheet.kind == "input"),
        *sheets[inputs:results],
        *(sheet for sheet in STUDY_SHEETS if sheet.kind == "result"),
        *sheets[results:],
    ]


@dataclass(frozen=True)
class MissingSheets:
    """What a workbook lacks for a study."""

    sheets: tuple[str, ...]  #: Sheets to add. [names]
    inputs: tuple[str, ...]  #: Those of them that hold inputs. [names]
    tables: tuple[str, ...]  #: Tables that are not there. [names]


def missing_sheets(tables: Collection[str], study: StudySpec) -> MissingSheets:
    """The sheets of a study that a workbook has not.

    Parameters
    ----------
    tables : collection of str
        Tables of the workbook. [names]
    study : StudySpec
        The study.

    Returns
    -------
    MissingSheets
    """
    there = {name.casefold() for name in tables}
    needed = (*study.input_names, *study.result_names)
    absent = tuple(name for name in needed if name.casefold() not in there)
    sheets = [
        sheet
        for spec in STUDIES
        for sheet in spec.sheets
        if any(name in absent for name in sheet.tables)
    ]
    facts = (STUDY_FACTS_SHEET,) if sheets and "studyfacts" not in there else ()
    return MissingSheets(
        (*dict.fromkeys(sheet.worksheet for sheet in sheets), *facts),
        tuple(sheet.worksheet for sheet in sheets if sheet.kind == "input"),
        absent,
    )
