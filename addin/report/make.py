"""One input in, its report out: read, calculate, build, write whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from addin.contract.problems import CellProblem
from addin.xlsx.whole_files import write_whole

if TYPE_CHECKING:
    from addin.calculation.calculation import Calculation
    from addin.diff.changes import Differences
    from addin.reading.typed_case import CaseInput

__all__ = ["Reported", "report"]


@dataclass(frozen=True)
class Reported:
    """What became of a report."""

    #: Everything wrong with the input; empty where the report was written.
    problems: tuple[CellProblem, ...]
    notes: tuple[str, ...]  #: What the user should know.
    written: tuple[Path, ...]  #: Files written.
    wrong: Path | None = None  #: The file the problems are of, where it is not the source itself.


def report(
    source: Path,
    *,
    pdf: Path | None = None,
    docx: Path | None = None,
    against: Path | None = None,
    on_stage: Callable[[str], None] | None = None,
) -> Reported:
    """Calculate an input and write its report.

    Parameters
    ----------
    source : Path
        Workbook or case JSON; it is only read. [path]
    pdf, docx : Path, optional
        Files to write; one that is there is replaced. [path]
    against : Path, optional
        An earlier revision: a workbook, a case JSON or a result JSON. The report says what changed
        since. [path]
    on_stage : callable, optional
        Called with a word on what is being done.

    Raises
    ------
    OSError
        If a file cannot be written; one that was there is as before.
    """
    from addin.writing.recalculate import Unreadable, calculate_read, read_checked

    tell = on_stage or (lambda stage: None)
    tell("reading")
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        return Reported(read.problems, read.warnings, ())
    calculation, problems = calculate_read(read, {}, tell)
    if calculation is None:
        return Reported(problems, read.warnings, ())
    from addin.report.build import build_document

    differences = None
    if against is not None:
        from addin.diff.files import CannotBeCompared

        tell(f"comparing with {against.name}")
        try:
            differences = _compared(against, source, read, calculation)
        except CannotBeCompared as wrong:
            return Reported(wrong.problems, (), (), against)
    tell("drawing")
    alerts = stored_results(read, calculation.case_sha256)
    document = build_document(
        source.name,
        read,
        calculation,
        alerts=alerts,
        vectors=pdf is not None,
        pixels=docx is not None,
        # with a fixed date the same inputs are to give the same bytes; measured times never do
        show_times=not os.environ.get("SOURCE_DATE_EPOCH"),
        against=differences,
    )
    made: list[tuple[Path, bytes]] = []
    if pdf is not None:
        from addin.report.pdf import pdf_of

        tell("setting the PDF")
        made.append((pdf, pdf_of(document)))
    if docx is not None:
        from addin.report.word import docx_of

        tell("setting the DOCX")
        made.append((docx, docx_of(document)))
    for path, content in made:
        write_whole(path, partial(Path.write_bytes, data=content))
    return Reported((), (*calculation.warnings, *alerts), tuple(path for path, _ in made))


def _compared(
    against: Path, source: Path, read: CaseInput, calculation: Calculation
) -> Differences:
    """An earlier revision, calculated again by this version, and this calculation."""
    from addin.diff.compare import compare_sides
    from addin.diff.files import read_side, side_of, with_studies
    from addin.report.units import shown_of

    units = shown_of(read).units
    now = side_of(source, read, calculation, units, "calculated now, for this document")
    return compare_sides(read_side(against, recalculate=True), with_studies(now, read))


def stored_results(read: CaseInput, digest: str) -> tuple[str, ...]:
    """What the workbook's own results belong to, if not to its inputs."""
    from addin.reading.workbook import WorkbookInput
    from addin.recorded.results import recorded_fact

    if not isinstance(read, WorkbookInput):
        return ()
    stored = {
        name: recorded_fact(read.workbook, f"run_{name}") for name in ("SHA256", "Date", "Software")
    }
    if not stored["SHA256"] or stored["SHA256"] == digest:
        return ()
    made = ", ".join(filter(None, (stored["Software"], stored["Date"] and f"{stored['Date']} UTC")))
    return (
        "The results stored in the workbook do not belong to its inputs: they are those of inputs with "
        f"SHA-256 {stored['SHA256'][:12]}…{f' ({made})' if made else ''}. The results in this document "
        f"were calculated from the inputs as they are now, SHA-256 {digest[:12]}…",
    )
