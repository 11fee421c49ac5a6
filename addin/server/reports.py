"""The report of a file for the page. It loads what draws and typesets: only the process that makes one does."""

from __future__ import annotations

from addin.reading.one_file import Unreadable
from addin.report.make import report as make
from addin.server.bounded_reading import WRITING, bounded_read
from addin.server.file_tasks import REPORTS, FileTask, Outcome, Tell, file_block, within_memory
from addin.workers.processes import bounded_memory


@within_memory
def report(task: FileTask, tell: Tell) -> Outcome:
    """The calc sheet as a PDF or a Word document."""
    form = task.settings["form"]
    with bounded_memory(WRITING):
        if isinstance(read := bounded_read(task.source), Unreadable):
            return read.problems, read.warnings, None
        target = task.target.with_suffix(f".{form}")
        pdf, docx = (target if form == name else None for name in ("pdf", "docx"))
        done = make(task.source, pdf=pdf, docx=docx, on_stage=tell)
        if done.problems:
            return done.problems, done.notes, None
    return (), done.notes, {"blocks": [], "files": [file_block(target, REPORTS[form][1])]}
