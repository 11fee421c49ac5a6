"""A batch from its inputs to its summary.

Files are read first, all of them, so that identical cases are found; then each case is calculated
once and its results are written to every file that states it. What becomes of each file is journalled
before its results are put in place.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from addin.batch.folder import OutFolder, digest_of, digested, stamp_of
from addin.batch.inputs import Input, json_name, result_name
from addin.batch.journal import Journal
from addin.batch.own_files import holds_results
from addin.batch.records import (
    AN_EARLIER,
    CHANGED,
    CRASHED,
    DISK_FULL,
    NOT_RENAMED,
    OUTDATED,
    Output,
    Record,
    Stamp,
    failed,
    outcome_of,
)
from addin.batch.work import Calculated, Examine, Work, calculate, examine
from addin.contract.problems import CellProblem
from addin.contract.version import product_version
from addin.reading.one_file import file_problem
from addin.workers.pool import Crashed, Task, Workers
from addin.workers.stop import Stop, Stopped
from addin.writing.results_json import errors_to_json
from addin.xlsx.whole_files import write_json


class Listener:
    """Told how a batch gets on; does nothing of itself."""

    def begin(self, stage: str, total: int) -> None:
        """A stage begins."""

    def advance(self, record: Record | None) -> None:
        """One more file.

        Parameters
        ----------
        record : Record or None
            What became of it; None where it has only been read.
        """

    def note(self, sentence: str) -> None:
        """Something the user should know now, such as a rare long wait."""


@dataclass
class Batch:
    """Files, their records, and the folder of results."""

    folder: OutFolder  #: Held by this batch.
    workers: Workers  #: Who does the work.
    send: str = "files"  #: ``files`` or ``bytes``: how files reach the workers.
    ignore_lock: bool = False  #: Calculate although a lock file says somebody has a workbook open.
    may_be_open: bool = False  #: The inputs may be open in Excel: they are calculated as saved.
    resume: bool = False  #: Go on with what an earlier batch recorded in this folder.
    stop: Stop = field(default_factory=Stop)  #: Asked all the time.
    listener: Listener = field(default_factory=Listener)  #: Told all the time.
    #: Fields of the case that the command line sets, such as ``method``. [SI]
    overrides: Mapping[str, Any] = field(default_factory=dict)
    json: Path | None = None  #: Folder in which results are wanted as JSON too.
    records: dict[str, Record] = field(default_factory=dict)
    #: Files that needed no work, as an earlier batch did them. [count]
    kept: int = 0
    #: Why records of an earlier batch are not believed. [sentences]
    refused: tuple[str, ...] = ()

    def __enter__(self) -> Batch:
        self._version = product_version()
        self._numbers = 0
        self._retried: set[str] = set()
        self._earlier, self.refused = self.folder.records(self.json)
        if self.resume:
            self.records = dict(self._earlier)
        with _journalling():
            self._journal = Journal(self.folder.journal, keep=self.resume)
        return self

    def __exit__(self, *_: object) -> None:
        self.workers.close()
        self._journal.close()

    def process(self, inputs: Sequence[Input]) -> None:
        """Calculate files that have no valid record yet.

        Raises
        ------
        Abandoned
            At the second Ctrl-C.
        Stopped
            If nothing more can be recorded.
        """
        todo = [file for file in inputs if not self._is_done(file)]
        for file in todo:
            self.records.pop(file.name, None)
        self.kept = len(inputs) - len(todo)
        groups = self._examined(todo)
        if not self.stop():
            self._calculated(groups)

    # ---- what is done already --------------------------------------------------------------------

    def _is_done(self, file: Input) -> bool:
        """Whether the record of a file still holds."""
        record = self.records.get(file.name)
        if record is None or not record.settled or record.version != self._version:
            return False
        if record.settings != self.overrides:
            return False
        if self.json and self._json_of(file.name) not in {output.name for output in record.outputs}:
            return False
        if record.source != str(file.path) or not _unchanged(file.path, record.stamp):
            return False
        if record.done and not record.outputs:  # they are where nobody looks now
            return False
        if not record.done and self._old_results(file.name):
            return False
        return self.folder.holds(record.outputs)

    # ---- reading ---------------------------------------------------------------------------------

    def _examined(self, todo: Sequence[Input]) -> dict[str, list[Input]]:
        """Files by case, those that cannot be calculated recorded."""
        self.listener.begin("reading", len(todo))
        groups: dict[str, list[Input]] = {}
        for file in todo:
            self.workers.add(Task(examine, Examine(file.name, str(file.path)), file))
        for task, answer in self.workers.answers(self.stop):
            if isinstance(answer, Crashed):
                self._settle(self._crashed(task.tag, answer))
            elif answer.record is not None:
                self._settle(answer.record)
            else:
                groups.setdefault(answer.case_sha256, []).append(task.tag)
            self.listener.advance(None)
        order = {file.name: i for i, file in enumerate(todo)}
        for group in groups.values():
            group.sort(key=lambda file: order[file.name])
        return dict(sorted(groups.items(), key=lambda pair: order[pair[1][0].name]))

    # ---- calculating -----------------------------------------------------------------------------

    def _calculated(self, groups: dict[str, list[Input]]) -> None:
        """Each case once, its results to every file that states it."""
        self.listener.begin("calculating", sum(map(len, groups.values())))
        waiting = {digest: list(group[1:]) for digest, group in groups.items()}
        for digest, group in groups.items():
            self._add(group[0], digest, keep=len(group) > 1)
        for task, answer in self.workers.answers(self.stop):
            file: Input = task.tag
            if isinstance(answer, Crashed):
                record = self._crashed(file, answer)
                results = None
            else:
                record, results = self._placed(task.payload, answer), answer.results
            if record.outcome == CHANGED and file.name not in self._retried:
                self._retried.add(file.name)  # it was being saved; it is likely to be whole now
                self._add(file, "", keep=False)
            else:
                record = self._settle(record)
                self.listener.advance(record)
            others = waiting.get(task.payload.case_sha256)
            if others:
                self._share(task.payload.case_sha256, others, file, results)

    def _share(self, digest: str, others: list[Input], file: Input, results: bytes | None) -> None:
        """Give the results of a case to the other files that state it."""
        if results is None:  # it came to nothing: the next file tries by itself
            self._add(others.pop(0), digest, keep=bool(others))
            return
        more: dict[str, Any] = {"known": results}
        if self.send == "files":
            place = self._new_place()
            place.write_bytes(results)
            more = {"known_file": str(place)}
        for other in others:
            self._add(other, digest, same_as=file.name, **more)
        others.clear()

    def _add(self, file: Input, digest: str, **more: Any) -> None:
        """Give a file to the workers."""
        work = Work(
            file.name,
            str(file.path),
            target=str(self.folder.place(result_name(file.name))),
            root=str(self.folder.path),
            case_sha256=digest,
            ignore_lock=self.ignore_lock,
            may_be_open=self.may_be_open,
            overrides=self.overrides,
            json=self._json_of(file.name),
            history=file.history,
            staging=str(self._new_place()) if self.send == "files" else "",
            **more,
        )
        self.workers.add(Task(calculate, work, file))

    def _json_of(self, name: str) -> str:
        """Where the JSON of a file belongs, as the name of an output; empty if none is wanted."""
        if self.json is None:
            return ""
        place = self.json.absolute() / json_name(name)
        return self._inside(place) if place.is_relative_to(self.folder.path) else place.as_posix()

    def _placed(self, work: Work, answer: Calculated) -> Record:
        """The record, its result files on the disk; those that came as bytes are staged here."""
        record = answer.record
        if not answer.files:
            return record
        if not _unchanged(Path(work.source), record.stamp):
            sentence = (
                f"{work.name} changed during the calculation; nothing was written for it. Run again "
                "with --resume."
            )
            return failed(record.name, record.source, CHANGED, sentence)
        folder = self._new_place()
        try:
            folder.mkdir()
            outputs = []
            for output in record.outputs:
                staged = folder / Path(output.name).name
                staged.write_bytes(answer.files[output.name])
                outputs.append(replace(output, staged=self._inside(staged)))
        except OSError as wrong:
            return self._not_written(record, wrong)
        return replace(record, outputs=tuple(outputs))

    def _new_place(self) -> Path:
        """A place in the staging folder that nothing has."""
        self._numbers += 1
        return self.folder.staging / f"{self._numbers}"

    def _inside(self, place: Path) -> str:
        """The name of a place in the folder of results."""
        return place.relative_to(self.folder.path).as_posix()

    # ---- recording -------------------------------------------------------------------------------

    def _settle(self, record: Record) -> Record:
        """Record what became of a file, then put its results in place."""
        record = replace(record, version=record.version or self._version, settings=self.overrides)
        if record.done:
            record = self._without_old_histories(record)
        else:
            if self.json is not None and not self._keeps_json(record):
                record = self._with_errors(record)
            record = self._with_old_results_told(record)
        self._write(record)
        try:
            self.folder.put(record.outputs)
        except OSError as wrong:
            record = replace(
                self._not_written(record, wrong), version=self._version, settings=self.overrides
            )
            record = self._with_old_results_told(record)
            self._write(record)
        self.records[record.name] = record
        if record.done:
            self._earlier[record.name] = record
        if record.outcome == DISK_FULL and not self.stop.reason:
            self.stop.reason = "The disk is full. Free some space, then run again with --resume."
        return record

    def _keeps_json(self, record: Record) -> bool:
        """Whether the JSON of an earlier calculation stays, as the reason passes by itself."""
        place = self.folder.place(self._json_of(record.name))
        return record.outcome not in OUTDATED and holds_results(place)

    def _with_errors(self, record: Record) -> Record:
        """A file without results: its errors as JSON, staged, so that no earlier results stay there."""
        staged = self._new_place()
        problems = [CellProblem(**error) for error in record.errors]
        try:
            write_json(staged, errors_to_json(problems, record.version, record.warnings))
            state = digested(staged)
        except OSError:  # such as a full disk, which the record says already
            return record
        name = self._json_of(record.name)
        output = Output(name, state.size, state.sha256, self._inside(staged))
        return replace(record, outputs=(output,))

    def _old_results(self, name: str) -> list[str]:
        """Results of an earlier calculation of a file that are in place, by their names."""
        earlier = self._earlier.get(name)
        known = earlier.outputs if earlier is not None and earlier.done else ()
        names = dict.fromkeys((result_name(name), *(output.name for output in known)))
        if self.json is not None:
            names[self._json_of(name)] = None
        for output in self.folder.elsewhere.get(name, ()):
            # A journal that somebody made up shall not have files renamed that are none of ours.
            if output.name.endswith(Path(json_name(name)).name) and self.folder.holds((output,)):
                names[output.name] = None
        # a JSON may hold errors
        return [
            name
            for name in filter(self._is_there, names)
            if not name.endswith(".json") or holds_results(self.folder.place(name))
        ]

    def _with_old_results_told(self, record: Record) -> Record:
        """A file without results, whose earlier ones must not be taken for those of what it holds now.

        They are renamed, never deleted, as somebody may have written into them. Where the reason passes
        by itself they stay under their names, and the record says what they are.
        """
        sentences = []
        for name in self._old_results(record.name):
            if record.outcome not in OUTDATED:
                sentences.append(f"{name} is still the result of an earlier calculation.")
                continue
            try:
                aside = self.folder.set_aside(name)
                sentences.append(AN_EARLIER.format(name, aside.name))
            except OSError as wrong:
                sentences.append(NOT_RENAMED.format(name, wrong.strerror or wrong))
        return replace(record, sentence=" ".join([record.sentence, *sentences]).strip())

    def _without_old_histories(self, record: Record) -> Record:
        """A file with results, whose histories of another kind or name are no longer true."""
        earlier = self._earlier.get(record.name)
        outputs = earlier.outputs if earlier else ()
        old = {output.name for output in outputs if ".history." in output.name}
        old -= {output.name for output in record.outputs}
        if not old:
            return record
        others = (other for other in self.records.values() if other.done)
        old -= {output.name for other in others for output in other.outputs}
        sentences = []
        for name in sorted(filter(self._is_there, old)):
            with contextlib.suppress(OSError):  # open elsewhere: the record names the right one
                sentences.append(AN_EARLIER.format(name, self.folder.set_aside(name).name))
        return replace(record, warnings=(*record.warnings, *sentences))

    def _is_there(self, name: str) -> bool:
        return os.path.isfile(self.folder.place(name))

    def _write(self, record: Record) -> None:
        with _journalling():
            self._journal.write(record)

    def _not_written(self, record: Record, wrong: OSError) -> Record:
        place = self.folder.place(result_name(record.name))
        if isinstance(wrong, PermissionError):
            sentence = f"{place} could not be replaced; it is probably open in Excel. Close it there and run again with --resume."
        else:
            sentence = file_problem(place, wrong).message
        return failed(record.name, record.source, outcome_of(wrong), sentence, stamp=record.stamp)

    def _crashed(self, file: Input, answer: Crashed) -> Record:
        sentence = (
            f"{file.name} was stopped twice: {answer.sentence}. Perhaps memory ran out: calculate "
            "it alone with torsionbook recalc; if that fails too, please report it."
        )
        return failed(file.name, str(file.path), CRASHED, sentence)


def _unchanged(path: Path, stamp: Stamp) -> bool:
    """Whether a file is in the state in which it was calculated."""
    try:
        now = stamp_of(path)
        if now.size != stamp.size:
            return False
        return now.modified == stamp.modified or digest_of(path) == stamp.sha256
    except OSError:
        return False


@contextlib.contextmanager
def _journalling() -> Iterator[None]:
    """Stop where the journal cannot be written."""
    try:
        yield
    except OSError as wrong:
        raise Stopped(
            f"The journal of the batch cannot be written ({wrong.strerror or wrong}). Recorded "
            "results are kept; free disk space or close other programs that use the folder, then "
            "run again with --resume."
        ) from wrong
