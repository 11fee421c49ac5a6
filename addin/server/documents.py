"""What is verified, compared and studied for the page, and the inputs of studies. Runs in the processes that are asked for it.

Each task gives problems, warnings and a value. A document is a list of blocks, ``{"text"}`` or ``{"title", "rows"}`` with
cells as people read them, the file that goes with it, and how it ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from addin.contract.studies.registry import missing_sheets
from addin.contract.study_spec import StudySpec
from addin.contract.tables import table
from addin.diff.changes import Change, Differences
from addin.diff.compare import compare_files
from addin.diff.files import CannotBeCompared
from addin.diff.wording import change_in_words, in_words, telling
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.server.bounded_reading import WRITING, bounded_read
from addin.server.file_tasks import (
    Block,
    FileTask,
    Outcome,
    Tell,
    file_block,
    typed_anew,
    within_memory,
)
from addin.server.studies import STUDIES, limited
from addin.studies.run_study import StudyFiles, study_one
from addin.template.study_sheets import with_study_sheets
from addin.verify.file import verify_file
from addin.verify.wording import lines
from addin.workers.parallel_map import serial_map
from addin.workers.processes import bounded_memory
from addin.worksheet.registry import FunctionError
from addin.writing.edited_inputs import typed_inputs
from addin.xlsx import PackageError

#: What the start matrix, which has no tables of its own, is made from.
_CONDITIONS = ("StartConditions",)
#: Media types of files that a study writes.
_MEDIA = {
    ".xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    ".xlsm": "application/vnd.ms-excel.sheet.macroEnabled.12",
    ".json": "application/json",
}


@within_memory
def verified(task: FileTask, tell: Tell) -> Outcome:
    """Whether the results in a workbook follow from its inputs."""
    if task.source.suffix not in WORKBOOK_ENDINGS:
        raise FunctionError("A case JSON has no results to verify. Open a calculated workbook.")
    tell("verifying")
    with bounded_memory(WRITING):
        if isinstance(read := bounded_read(task.source), Unreadable):
            return read.problems, read.warnings, None
        verification = verify_file(task.source, on_stage=tell)
    texts = [{"text": line.strip()} for line in lines(verification)]
    return (), (), {"blocks": texts, "files": [], "passes": verification.passes}


@within_memory
def compared(task: FileTask, tell: Tell) -> Outcome:
    """What differs between an earlier file and this one, calculated anew where need be."""
    earlier = Path(task.settings["earlier"])
    with bounded_memory(WRITING):
        for path in (earlier, task.source):
            if isinstance(read := bounded_read(path), Unreadable):
                return read.problems, read.warnings, None
        try:
            differences = compare_files(earlier, task.source, on_stage=tell)
        except CannotBeCompared as wrong:
            return wrong.problems, (), None
    return (), (), {"blocks": list(_differences(differences)), "files": []}


@within_memory
def study_inputs(task: FileTask, tell: Tell) -> Outcome:
    """What a study of a file reads beside the train: its tables, with the usual rows where the file lacks them, and settings."""
    study = STUDIES[task.settings["study"]]
    with bounded_memory(WRITING):
        read = _with_inputs(task, tell)
        if isinstance(read, Unreadable) or read.problems:
            return read.problems, read.warnings, None
        names = _CONDITIONS if study.command == "starts" else study.spec.input_names
        tables = typed_inputs(read, names)["tables"]
    settings = [
        {
            "name": option.name, "help": option.help, "default": option.default, "words": list(option.words),
            "least": option.least, "most": option.most,
        }
        for option in map(limited, study.options) if option.is_setting
    ]  # fmt: skip
    return (), (), {"tables": tables, "settings": settings}


@within_memory
def study_edited(task: FileTask, tell: Tell) -> Outcome:
    """The file with some inputs of a study typed anew, at the target; sheets it lacks are added."""
    with bounded_memory(WRITING):
        return typed_anew(_with_inputs(task, tell), task)


def _with_inputs(task: FileTask, tell: Tell) -> CaseInput | Unreadable:
    """A file, with the sheets of a study."""
    study = STUDIES[task.settings["study"]].spec
    tell("reading")
    read = bounded_read(task.source)
    if isinstance(read, WorkbookInput) and not read.problems:
        lacking = missing_sheets(read.workbook.tables, study)
        if lacking.sheets:
            (folder := task.target.with_suffix("")).mkdir()
            try:
                return with_study_sheets(read, study, folder)
            except PackageError as wrong:
                raise FunctionError(str(wrong)) from None
    return read


@within_memory
def studied(task: FileTask, tell: Tell) -> Outcome:
    """A study of a file, which comes back with the study in it; sheets it lacks are added with usual rows."""
    study = STUDIES[task.settings["study"]]
    is_json = task.source.suffix == ".json"
    files = StudyFiles(
        None if is_json else task.target, json_file=task.target if is_json else None,
        ignore_lock=True, add=_with_sheets, add_inputs=True,
    )  # fmt: skip
    with bounded_memory(WRITING):
        if isinstance(read := bounded_read(task.source), Unreadable):
            return read.problems, read.warnings, None
        settings = task.settings["settings"]
        outcome = study_one(study, task.source, serial_map(), settings, files, tell)
    made = [file_block(path, _MEDIA[path.suffix]) for path in outcome.written]
    if outcome.result is None:
        if not made:
            return outcome.problems, outcome.warnings, None
        texts = [problem.message for problem in outcome.problems]
        return (), outcome.warnings, {"blocks": [{"text": text} for text in texts], "files": made}
    options = {option.name: option.default for option in study.options} | settings
    blocks: list[Block] = [
        {"text": block.strip(), **({"below": True} if block.startswith("    ") else {})}
        if isinstance(block, str)
        else {"title": "", "rows": [[name for name, _ in block.columns], *map(list, block.rows)]}
        for block in study.terminal(outcome.result, options)
    ]
    blocks += [{"text": text} for text in (outcome.result.sentence, *outcome.result.remarks)]
    return (), outcome.warnings, {"blocks": [b for b in blocks if b != {"text": ""}], "files": made}


def _with_sheets(read: WorkbookInput, study: StudySpec, folder: Path) -> WorkbookInput:
    return with_study_sheets(read, study, folder)


def _differences(differences: Differences) -> Iterator[Block]:
    """Verdicts, inputs and the results that an engineer asks for first."""
    head = ["Check", "Before", "After", "Limit", "Verdict before", "Verdict after"]
    checks = [change for change in differences.verdicts if change.table == "Verdicts"]
    if checks:
        rows = [
            [c.row, c.result_before, c.result_after, c.limit, c.before or "–", c.after or "–"]
            for c in sorted(checks, key=lambda check: not check.changed)
        ]
        yield {"title": "Checks", "rows": [head, *rows]}
    if not differences.inputs:
        yield {"text": f"Inputs: no difference in {differences.same_inputs:,} quantities."}
    else:
        title = f"Inputs that differ ({differences.same_inputs:,} quantities are the same)"
        yield _changes(title, differences.inputs)
    by_table: dict[str, list[Change]] = {}
    for change in differences.results:
        by_table.setdefault(change.table, []).append(change)
    listed = 0
    for name, changes in by_table.items():
        shown = telling(name, changes)
        listed += len(shown)
        if shown:
            yield _changes(
                f"{table(name).caption}: {len(changes):,} differences, {len(shown):,} shown", shown
            )
    further = len(differences.results) - listed
    left = (
        f" {further:,} further differences are not shown; torsionbook diff lists them."
        if further
        else ""
    )
    yield {"text": f"{differences.same_results:,} results are the same.{left}"}


def _changes(title: str, changes: Sequence[Change]) -> Block:
    rows = [
        [c.table, c.row, c.column, in_words(c, c.before), in_words(c, c.after), change_in_words(c)]
        for c in changes
    ]
    return {
        "title": title,
        "rows": [["Table", "Row", "Column", "Before", "After", "Change"], *rows],
    }
