"""One input in, its report out: read, calculate, build, write whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from addin.contract.digests import short_digest
from addin.contract.fixed_date import fixed_date
from addin.contract.problems import CellProblem
from addin.diff.compare import compare_read_files
from addin.diff.files import CannotBeCompared, compared_file, read_compared_file, with_studies
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.recorded.results import recorded_fact
from addin.report.build import build_document
from addin.report.company import Logo
from addin.report.pdf import pdf_of
from addin.report.units import document_units
from addin.report.word import docx_of
from addin.writing.recalculate import recalculate_case
from addin.xlsx.whole_files import write_whole


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
    logo: Logo | None = None,
    word_template: bytes | None = None,
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
    logo : Logo, optional
        Of the company, for the cover.
    word_template : bytes, optional
        The .docx whose styles, page and heads the Word document takes.
    on_stage : callable, optional
        Called with a word on what is being done.

    Raises
    ------
    OSError
        If a file cannot be written; one that was there is as before.
    """
    tell = on_stage or (lambda stage: None)
    tell("reading")
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        return Reported(read.problems, read.warnings, ())
    calculation, problems = recalculate_case(read, {}, tell)
    if calculation is None:
        return Reported(problems, read.warnings, ())
    differences = None
    if against is not None:
        tell(f"comparing with {against.name}")
        units, origin = document_units(read).units, "calculated now, for this document"
        try:
            earlier = read_compared_file(against, recalculate=True)
        except CannotBeCompared as error:
            return Reported(error.problems, (), (), against)
        now = with_studies(compared_file(source, read, calculation, units, origin), read)
        differences = compare_read_files(earlier, now)
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
        show_times=fixed_date() is None,
        against=differences,
    )
    document = replace(document, logo=logo)
    made: dict[Path, bytes] = {}
    word = partial(docx_of, template=word_template)
    for form, path, content in (("PDF", pdf, pdf_of), ("DOCX", docx, word)):
        if path is not None:
            tell(f"typesetting the {form}")
            made[path] = content(document)
    for path, data in made.items():
        write_whole(path, partial(Path.write_bytes, data=data))
    return Reported((), (*calculation.warnings, *alerts), tuple(made))


def stored_results(read: CaseInput, digest: str) -> tuple[str, ...]:
    """What the workbook's own results belong to, if not to its inputs."""
    if not isinstance(read, WorkbookInput):
        return ()
    stored = {
        name: recorded_fact(read.workbook, f"run_{name}") for name in ("SHA256", "Date", "Software")
    }
    if not stored["SHA256"] or stored["SHA256"] == digest:
        return ()
    made = ", ".join(filter(None, (stored["Software"], stored["Date"] and f"{stored['Date']} UTC")))
    return (
        "The results stored in the workbook belong to other inputs, with SHA-256 "
        f"{short_digest(stored['SHA256'])}{f' ({made})' if made else ''}. The results in this "
        f"document were calculated from the present inputs, SHA-256 {short_digest(digest)}",
    )
