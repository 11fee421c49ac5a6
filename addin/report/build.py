"""Results → document: chapters for whoever decides, appendices for whoever checks the calculation."""

from __future__ import annotations

from addin.calculation.calculation import Calculation
from addin.charts.data import accuracy_block, chart_blocks, history_limits
from addin.contract.digests import short_digest
from addin.contract.problems import shortened
from addin.diff.changes import Differences
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.recorded.results import RecordedAccuracy, recorded_accuracy
from addin.recorded.studies import RecordedStudy, recorded_studies
from addin.report import (
    cases,
    changes,
    closing,
    inputs,
    modes,
    opening,
    operation,
    starting,
    studies,
)
from addin.report.document import Document, numbered
from addin.report.figures import Charts, Pictures
from addin.report.layout import fitted
from addin.report.numbers import clean
from addin.report.plain import for_readers
from addin.report.subject import Subject
from addin.report.units import document_units
from addin.writing.workbook import chosen_elements

#: Longest title at the head of a page; a longer one is cut there, never on the cover.
_HEAD = 70


def build_document(
    name: str,
    read: CaseInput,
    calculation: Calculation,
    *,
    alerts: tuple[str, ...] = (),
    vectors: bool = True,
    pixels: bool = True,
    show_times: bool = True,
    against: Differences | None = None,
) -> Document:
    """The report of a calculation.

    Parameters
    ----------
    name : str
        Name of the input file, without its folder. [name]
    read : CaseInput
        The inputs as typed.
    calculation : Calculation
        What was calculated of them. [SI]
    alerts : tuple of str
        What must be known before anything is read. [sentences]
    vectors, pixels : bool
        Forms of the pictures: vectors for the PDF, pixels for the DOCX. [flag]
    show_times : bool
        Whether measured times are shown; they differ from run to run. [flag]
    against : Differences, optional
        An earlier calculation, and this one beside it. [SI]

    Returns
    -------
    Document
        Complete, the same for every writer.
    """
    shown = document_units(read)
    study: RecordedAccuracy | None = None
    recorded: tuple[RecordedStudy, ...] = ()
    chosen: list[str | None] = []
    if isinstance(read, WorkbookInput):
        study = recorded_accuracy(read.workbook, shown.units)
        recorded = recorded_studies(read, shown.units)
        chosen = chosen_elements(read.workbook)
    blocks = chart_blocks(calculation.case, shown.units, calculation.view, chosen)
    if study is not None and study.belongs_to(calculation.case_sha256):
        blocks = {**blocks, "ChartAccuracy": accuracy_block(study.rows)}
    limits = history_limits(calculation.case, shown.units, calculation.view, chosen)
    pictures = Pictures(Charts.of(blocks), vectors, pixels, limits)
    alerts = (*alerts, *(clean(note) for note in shown.notes))
    subject = Subject(
        name, calculation, read, shown, pictures, alerts, show_times, study, recorded, against
    )
    sections = (
        opening.summary(subject),
        opening.scope(subject),
        *(() if against is None else (changes.changes(subject, against),)),
        inputs.inputs(subject),
        modes.frequencies(subject),
        operation.margins(subject),
        operation.steady_state(subject),
        starting.start(subject),
        starting.reversals(subject),
        starting.fatigue(subject),
        *((operation.events(subject),) if calculation.results.events else ()),
        *((starting.makers(subject),) if subject.rows("MakerSheet") else ()),
        *((cases.cases(subject),) if subject.rows("CaseMatrix") else ()),
        *((studies.studies(subject, recorded),) if recorded else ()),
    )
    appendices = (
        closing.effects(subject),
        closing.accuracy(subject),
        closing.equations(subject),
        closing.checks(subject),
        closing.audit(subject),
    )
    cover = opening.cover_of(subject)
    return Document(
        cover=cover,
        sections=numbered(
            fitted([*map(for_readers, sections)]), fitted([*map(for_readers, appendices)])
        ),
        name=shortened(subject.words("document"), 40),
        revision=shortened(subject.words("revision"), 12),
        short_title=shortened(cover.title, _HEAD),
        foot=f"{calculation.stamp.software} · inputs {short_digest(calculation.case_sha256)}",
        paper=shown.paper,
        date=int(calculation.stamp.date.timestamp()),
    )
