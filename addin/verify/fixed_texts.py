"""Texts of torsionbook: titles of result sheets, and what a reviewer reads on Notes beside the results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from addin.contract.problems import shortened
from addin.contract.sheets import KIND_WORDS, SHEETS
from addin.contract.studies.registry import with_studies
from addin.contract.tables import table
from addin.contract.texts import NOTES
from addin.contract.trace_table import TRACE_HEADERS, trace_groups, trace_rows
from addin.verify.findings import Finding
from addin.verify.structure import PlainTexts, plain, present_sheet, shows_results
from addin.xlsx.references import cell_name

#: Words by which a row of Trace is known: sheet, table, column.
_NAMED_BY = 3


def compare_texts(texts: PlainTexts, same_version: bool) -> Iterator[Finding]:
    """Texts of torsionbook that were changed.

    Parameters
    ----------
    texts : PlainTexts
        Those of the workbook as it was saved.
    same_version : bool
        Whether this version wrote the texts, with the template; those of another one may be other
        texts. [flag]

    Yields
    ------
    Finding
        One a text. A sheet that was removed is no finding, nor is a text that was added. Other titles,
        introductions and captions of result sheets are notes.
    """
    workbook = texts.workbook
    for shipped in with_studies(SHEETS):
        shown = present_sheet(workbook, shipped)
        if shows_results(shipped) and shown is not None:
            for text in (
                shipped.name,
                KIND_WORDS[shipped.kind],
                shipped.intro,
                *map(_caption, shipped.tables),
            ):
                finding = _changed(texts, shown, (text,), 1)
                if finding is not None:
                    yield replace(finding, kind="not shown", fails=False)
    notes = [line for lines in NOTES.values() for line in lines if not line[1].startswith("=")]
    trace = [TRACE_HEADERS, *trace_rows(), *trace_groups()]
    of_studies = [row for row in trace_rows(studies=True) if row not in trace]
    trace_sheet = "Trace" if "Trace" in workbook.sheet_names else "Notes"  # its own in 0.1.0
    for sheet, rows, named_by in (
        ("Notes", notes, 1),
        (trace_sheet, [*trace, *of_studies], _NAMED_BY),
    ):
        if sheet not in workbook.sheet_names or not workbook.sheet_bytes(sheet):
            continue
        for row in rows:
            finding = _changed(texts, sheet, row, min(named_by, len(row) - 1))
            if finding is not None and (finding.cell or row not in of_studies):
                yield replace(finding, fails=same_version)


def _caption(name: str) -> str:
    """What stands above a table."""
    spec = table(name)
    return spec.caption if spec.short_caption else f"{spec.caption} {spec.help}"


def _changed(texts: PlainTexts, sheet: str, row: tuple[str, ...], named_by: int) -> Finding | None:
    """What is said of one row of texts; nothing where it stands as it was written."""
    written = [plain(text) for text in row]
    first: tuple[int, int] | None = None
    for at in texts.places(sheet).get(written[0], ()):
        held = texts.beside(sheet, at, len(row))
        if held == written:
            return None
        if first is None and held[:named_by] == written[:named_by]:
            first = at
    about = " / ".join(row[:named_by] or row)
    if first is None:
        sentence = f"the text '{shortened(about, 60)}' of torsionbook is missing"
        return Finding("edited", sheet, "", sentence, expected=about)
    held = texts.beside(sheet, first, len(row))
    k = next((k for k in range(len(row)) if held[k] != written[k]), len(row) - 1)
    shown = texts.workbook.sheet_part(sheet).constant(first[0], first[1] + k)
    sentence = (
        f"{about}: '{shortened(str(shown or ''), 60)}' stands in place of '{shortened(row[k], 60)}'"
    )
    cell = cell_name(first[0], first[1] + k)
    return Finding("edited", sheet, cell, sentence, found=shown, expected=row[k])
