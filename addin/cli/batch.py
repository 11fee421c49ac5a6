"""``torsionbook batch``: folders of workbooks, overnight."""

from __future__ import annotations

import datetime as dt
import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from addin.batch.cluster_files import FileCluster
from addin.batch.folder import FolderRefused, OutFolder
from addin.batch.inputs import (
    SUMMARY,
    Input,
    InputsRefused,
    check_places,
    find_inputs,
    summary_files,
)
from addin.batch.own_files import in_the_way, is_summary, is_summary_csv
from addin.batch.records import DONE, Record
from addin.batch.scheduler import Batch, Listener
from addin.batch.summary import NOT_BEGUN, write_summary
from addin.batch.vary import ProgrammeSettings, run_programme
from addin.batch.vary_columns import TableRefused
from addin.batch.watch import Watch
from addin.cli import status
from addin.cli.options import (
    IgnoreLockOption,
    JobsOption,
    MethodOption,
    SchedulerOption,
    StrictOption,
    ToleranceOption,
)
from addin.cli.overrides import case_overrides
from addin.cli.status import INTERRUPTED, WRONG_INPUT, failed, failing_on
from addin.cli.terminal import plain_console, print_written
from addin.contract.version import product_version
from addin.reading.one_file import WORKBOOK_ENDINGS, file_problem
from addin.workers.cluster import ClusterRefused
from addin.workers.pool import Pool, Workers
from addin.workers.stop import Abandoned, Stop, Stopped, cores
from addin.xlsx.places import real_path
from engine.case.result_words import ACCEPTABLE

_AGAIN = "Run again with --resume to continue."
_SEND = ("auto", "files", "bytes")
#: Errors that are listed in the terminal; the summary has all. [count]
_LISTED = 20
#: How often a batch that nobody watches says how far it is. [s]
_SAYS = 30.0
#: When it says so first; from then on it waits twice as long each time, up to that. [s]
_FIRST = 5.0


def batch(
    what: Annotated[
        list[str],
        typer.Argument(
            help="Folders, patterns in quotes, workbooks (.xlsx, .xlsm) or case JSON files.",
            metavar="DIR|GLOB...",
            show_default=False,
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder for the results.", show_default=False)],
    jobs: JobsOption = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an earlier batch in the same folder.")
    ] = False,
    summary: Annotated[
        Path | None,
        typer.Option(
            help="The summary (.xlsx, and .csv beside it); default summary.xlsx in --out."
        ),
    ] = None,
    watch: Annotated[
        bool,
        typer.Option(
            "--watch",
            help="After the batch, recalculate each file when it is saved; stop with Ctrl-C.",
        ),
    ] = False,
    json: Annotated[
        Path | None, typer.Option(help="Also write each file's results as JSON into this folder.")
    ] = None,
    method: MethodOption = None,
    tolerance: ToleranceOption = None,
    vary: Annotated[
        Path | None,
        typer.Option(
            help="Calculate one base case with the values of each row of this CSV or Parquet "
            "table; "
            "results go to results.parquet in --out."
        ),
    ] = None,
    csv: Annotated[
        bool,
        typer.Option(
            "--csv",
            help="With --vary: write results.csv too, for Excel; alone where pyarrow is not installed.",
        ),
    ] = False,
    scheduler: SchedulerOption = None,
    send: Annotated[
        str,
        typer.Option(
            help="How files reach the cluster: files (shared folder), bytes (sent), or auto "
            "(shared folder if possible)."
        ),
    ] = "auto",
    strict: StrictOption = False,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Calculate folders of workbooks on all cores; a file with errors does not stop the others.

    Each input is calculated into a file of the same name below --out; files that state the same case
    are calculated once. Ctrl-C ends it cleanly, and --resume goes on after that, or after a crash,
    without doing anything twice.

    Exit status 0 if every file is done, 1 if one is not (with --strict also if a verdict is neither pass nor accepted by forced response), 2 for
    wrong usage, 130 if it was interrupted: what was done by then is kept and summarised.

    Example: `torsionbook batch trains --out results`
    """
    if send not in _SEND:
        raise typer.BadParameter(f"--send is '{send}'; it must be {', '.join(_SEND)}.")
    overrides = case_overrides(method, tolerance)
    if out.suffix.lower() in WORKBOOK_ENDINGS and not out.exists():
        raise typer.BadParameter(
            f"{out} is the name of a workbook; in a batch --out must name a folder."
        )
    book = _summary_file(summary, out, written=vary is None)

    def find() -> list[Input]:
        try:
            return find_inputs(what, out, summary_files(book), json=json is not None)
        except InputsRefused as wrong:
            if not watch:
                raise failed(str(wrong)) from wrong
            tell_once(str(wrong))
            return []

    def find_later() -> list[Input]:
        """What is there while it is watched; nothing while a new file is in the way of results."""
        inputs_now = find()
        try:
            check_places(inputs_now, out, json, book)
        except InputsRefused as wrong:
            tell_once(str(wrong))
            return []
        return inputs_now

    def tell_once(sentence: str) -> None:
        if sentence not in refusals:
            refusals.add(sentence)
            _tell(sentence)

    refusals: set[str] = set()
    inputs = find()
    if vary is None:
        try:
            check_places(inputs, out, json, book)
        except InputsRefused as wrong:
            raise typer.BadParameter(str(wrong)) from wrong
    if json is not None:
        _check_json_folder(json, vary)
    stop = Stop()
    if vary is not None:
        if watch or len(inputs) != 1:
            raise typer.BadParameter(
                f"--vary needs exactly one base case and cannot run with --watch; {_named(inputs)}."
            )
        programme = ProgrammeSettings(resume, overrides, csv)
        workers = _workers(jobs, scheduler)
        raise typer.Exit(_varied(inputs[0].path, vary, out, workers, programme, stop))
    if csv:
        raise typer.BadParameter("--csv needs --vary; a batch of files writes summary.csv.")
    workers = _workers(jobs, scheduler)
    began = time.monotonic()
    with (
        failing_on(FolderRefused, Stopped),
        _progress() as listener,
        OutFolder(out, json) as folder,
        Batch(
            folder,
            workers,
            ignore_lock=ignore_lock,
            may_be_open=watch,
            resume=resume,
            stop=stop,
            listener=listener,
            overrides=overrides,
            json=json,
        ) as work,
        stop.listening(_tell),
    ):
        for sentence in work.refused:
            _tell(sentence)
        if inputs:
            work.send = _way(work, inputs[0], send)
        ended = _processed(work, inputs, stop)
        records = _rows(work, inputs)
        written = _summarised(book, records, overrides)
        if watch and not ended:
            _say(work, records, ended, began, written)
            _watched(work, find_later, inputs, book, stop)
            raise typer.Exit(status.DONE)
    _say(work, records, ended, began, written)
    raise typer.Exit(_status(records, ended, stop, strict, bool(written)))


def _tell(sentence: str) -> None:
    typer.echo(sentence, err=True)


def _workers(jobs: int | None, scheduler: str | None) -> Workers:
    """Processes of this machine, or a cluster."""
    if scheduler is None:
        return Pool(jobs or cores())
    if jobs is not None:
        raise typer.BadParameter(
            "--jobs applies to this machine only; a cluster uses its own workers."
        )

    with failing_on(ClusterRefused):
        return FileCluster(scheduler)


def _way(work: Batch, first: Input, send: str) -> str:
    """How files reach the workers: as files or as bytes."""
    if isinstance(work.workers, Pool):
        return "files"

    assert isinstance(work.workers, FileCluster)
    shared = send == "files" or (
        send == "auto" and work.workers.shares(work.folder.staging, first.path)
    )
    work.workers.sends_bytes = not shared
    if send == "auto":
        typer.echo(
            f"Files reach the cluster {'through a shared folder' if shared else 'as bytes'}.",
            err=True,
        )
    return "files" if shared else "bytes"


def _varied(
    base: Path,
    table: Path,
    out: Path,
    workers: Workers,
    settings: ProgrammeSettings,
    stop: Stop,
) -> int:
    """A programme of cases; its exit status."""
    try:
        import pyarrow  # noqa: F401  (said in time)
    except ImportError:
        if not settings.as_csv:
            raise failed(
                "Results of --vary are Parquet, and pyarrow is not installed. Add --csv, or run pip install "
                "-r requirements/parquet.txt in the checkout, or install the wheel with its extra [parquet]."
            ) from None
        settings = replace(settings, as_parquet=False)
        _tell("Only results.csv is written: results.parquet needs pyarrow, which is not installed.")
    if real_path(table) in [real_path(out / name) for name in settings.results]:
        raise typer.BadParameter(
            f"Results would overwrite the table {table}. Name another folder with --out."
        )
    if (place := next(in_the_way(out, settings.results), None)) is not None:
        raise typer.BadParameter(
            f"{place} exists and was not written by torsionbook: results of --vary would replace "
            "it. Rename it, or name another folder with --out."
        )
    began = time.monotonic()
    try:
        with (
            failing_on(FolderRefused, Stopped),
            _progress() as listener,
            OutFolder(out) as folder,
            stop.listening(_tell),
        ):
            done = run_programme(
                base, table, folder, workers, settings, stop=stop, listener=listener
            )
    except TableRefused as wrong:
        for sentence in wrong.sentences:
            typer.echo(f"{table}: {sentence}", err=True)
        return WRONG_INPUT
    except Abandoned:
        typer.echo(f"Interrupted. {_AGAIN}", err=True)
        return INTERRUPTED
    finally:
        workers.close()
    reached = sum(done.outcomes.values())
    for reason in done.reasons:
        typer.echo(reason, err=True)
    counts = ", ".join(f"{count:,} {outcome}" for outcome, count in done.outcomes.items())
    counts = counts or "the table has none below its headings"
    kept = f" ({done.kept:,} of them in an earlier run)" if done.kept else ""
    left = f", {done.rows - reached:,} not begun" if reached < done.rows else ""
    typer.echo(
        f"{done.rows:,} row{'' if done.rows == 1 else 's'} in {_duration(time.monotonic() - began)}: {counts}{left}{kept}."
    )
    print_written(filter(None, (done.result, done.csv)))
    if stop.asked and reached < done.rows:
        typer.echo(f"Interrupted. {_AGAIN}", err=True)
        return INTERRUPTED
    return status.DONE if done.outcomes.get(DONE, 0) == done.rows else WRONG_INPUT


def _named(inputs: Sequence[Input]) -> str:
    """How many files were named, and the first of them."""
    if len(inputs) == 1:
        return "--watch is given"
    some = ", ".join(file.name for file in inputs[:3])
    return f"{len(inputs)} files are named ({some}{', ...' if len(inputs) > 3 else ''})"


def _check_json_folder(json: Path, vary: Path | None) -> None:
    """What would keep JSON from being written, said before anything is calculated."""
    if vary is not None:
        raise typer.BadParameter("--json needs a batch of files; results of --vary are Parquet.")
    if json.suffix.lower() == ".json" and not json.is_dir():
        raise typer.BadParameter(f"--json is '{json}'; in a batch it must name a folder.")
    try:
        json.mkdir(parents=True, exist_ok=True)
    except OSError as wrong:
        why = wrong.strerror or wrong
        raise failed(
            f"The folder {json} cannot be created ({why}). Name another with --json."
        ) from wrong
    if not os.access(json, os.W_OK):
        raise failed(f"{json} is not writable. Name another folder with --json.")


def _summary_file(summary: Path | None, out: Path, *, written: bool) -> Path:
    """Where the summary belongs; what is there already and is none is not replaced."""
    book = summary or out / SUMMARY
    if book.suffix.lower() != ".xlsx":
        raise typer.BadParameter(f"--summary is '{book}'; it must end in .xlsx.")

    for place, is_ours in zip(summary_files(book), (is_summary, is_summary_csv), strict=True):
        if written and place.exists() and not is_ours(place):
            raise typer.BadParameter(
                f"{place} exists and is not a batch summary. Choose another name for --summary."
            )
    return book


def _processed(work: Batch, inputs: Sequence[Input], stop: Stop) -> str:
    """Do it; why it ended early, or nothing."""
    try:
        work.process(inputs)
    except Abandoned:
        return f"Interrupted; unfinished calculations were stopped. {_AGAIN}"
    except Stopped as wrong:
        stop.reason = stop.reason or str(wrong)
    if stop.reason:
        return stop.reason
    # Where every file has its outcome, nothing was interrupted.
    left = any(file.name not in work.records for file in inputs)
    return f"Interrupted. {_AGAIN}" if stop.asked and left else ""


def _watched(
    work: Batch, find: Callable[[], list[Input]], inputs: Sequence[Input], book: Path, stop: Stop
) -> None:
    """Calculate what is saved until Ctrl-C."""
    everything = {file.name: file for file in inputs}
    work.listener = Listener()

    def after(ready: Sequence[Input]) -> None:
        everything.update((file.name, file) for file in ready)
        for record in _rows(work, ready):
            verdict = f"verdict {record.verdict}"
            typer.echo(
                f"{record.name}: {record.outcome}: {verdict if record.done else record.sentence}"
            )
        _summarised(book, _rows(work, list(everything.values())), work.overrides)

    typer.echo("Watching for saved files; stop with Ctrl-C.")
    try:
        Watch(work, find, after).run(inputs)
    except Abandoned:
        raise typer.Exit(INTERRUPTED) from None
    typer.echo("Watching has ended.")


def _rows(work: Batch, inputs: Sequence[Input]) -> list[Record]:
    """A record for each file, also for those that were not reached."""
    sentence = "The batch ended before this file was calculated. Run again with --resume."
    return [
        work.records.get(file.name) or Record(file.name, str(file.path), NOT_BEGUN, sentence)
        for file in inputs
    ]


def _counts(records: Sequence[Record]) -> str:
    """How many records have each outcome."""
    outcomes = Counter(record.outcome for record in records)
    return ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())


def _summarised(
    book: Path, records: Sequence[Record], overrides: Mapping[str, Any]
) -> tuple[Path, ...]:
    """Write the summary; nothing if that is impossible, which is said."""
    counts = _counts(records)
    heading = (
        f"{len(records)} file{'' if len(records) == 1 else 's'}: {counts}. torsionbook {product_version()}, "
        f"{dt.datetime.now(dt.UTC):%Y-%m-%d %H:%M} UTC."
    )
    if overrides:
        settings = ", ".join(f"{name} = {value}" for name, value in overrides.items())
        heading += f" Settings of the command line: {settings}."
    try:
        return write_summary(book, records, heading)
    except OSError as wrong:
        sentence = file_problem(book, wrong).message
        typer.echo(f"The summary was not written: {sentence} Run again with --resume.", err=True)
        return ()


def _say(
    work: Batch, records: Sequence[Record], ended: str, began: float, written: Sequence[Path]
) -> None:
    """The end of a batch, in words."""
    failed = [record for record in records if not record.done and record.version]
    for record in failed[:_LISTED]:
        typer.echo(f"{record.name}: {record.outcome}: {record.sentence}", err=True)
    if len(failed) > _LISTED:
        typer.echo(f"... and {len(failed) - _LISTED} more; the summary lists all.", err=True)
    seconds = time.monotonic() - began
    kept = f", {work.kept} of them in an earlier batch" if work.kept else ""
    same = sum(bool(record.same_as) for record in records)
    shared = f", {same} with the same case as another file" if same else ""
    files = "1 file" if len(records) == 1 else f"{len(records):,} files"
    typer.echo(f"{files} in {_duration(seconds)}{kept}{shared}")
    outcomes = Counter(record.outcome for record in records)
    verdicts = Counter(record.verdict for record in records if record.done)
    for outcome, count in outcomes.most_common():
        typer.echo(f"{count:>7,} {outcome}")
        for verdict, some in verdicts.most_common() if outcome == DONE else ():
            typer.echo(f"{some:>14,} × {verdict}")
    if ended:
        typer.echo(ended, err=True)
    print_written(written)


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.1f} s"
    return f"{seconds // 3600:.0f} h {seconds % 3600 // 60:02.0f} min" if seconds >= 3600 else f"{seconds // 60:.0f} min {seconds % 60:02.0f} s"  # fmt: skip


def _status(
    records: Sequence[Record], ended: str, stop: Stop, strict: bool, summarised: bool
) -> int:
    if stop.asked and ended:
        return INTERRUPTED
    if stop.reason or not summarised or any(not record.done for record in records):
        return WRONG_INPUT
    if strict and any(record.results.get("verdict") not in ACCEPTABLE for record in records):
        return WRONG_INPUT
    return status.DONE


class _Lines(Listener):
    """How far a batch is, as lines for a log."""

    def begin(self, stage: str, total: int) -> None:
        self.stage, self.total, self.count = stage, total, 0
        self.began = self.last_line = time.monotonic()
        self.wait = _FIRST

    def note(self, sentence: str) -> None:
        _tell(sentence)

    def advance(self, record: Record | None) -> None:
        self.count += 1
        now = time.monotonic()
        # The last file has a line where others had one, so that the count comes to its end.
        last = self.count == self.total and self.wait > _FIRST
        if now - self.last_line < self.wait and not last:
            return
        self.last_line, self.wait = now, min(2.0 * self.wait, _SAYS)
        rate = self.count / (now - self.began)
        left = _duration((self.total - self.count) / rate)
        typer.echo(
            f"{time.strftime('%H:%M:%S')} {self.stage}: {self.count:,} of {self.total:,}, {rate:.1f}/s, {left} left",
            err=True,
        )


@contextmanager
def _progress() -> Iterator[Listener]:
    """A bar with rate and time left where somebody watches, else a line now and then."""
    if not sys.stderr.isatty():
        yield _Lines()
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("left"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[bad]}", style="red"),
    )
    with Progress(*columns, console=plain_console(stderr=True)) as shown:

        class Bar(Listener):
            def note(self, sentence: str) -> None:
                shown.console.print(sentence)

            def begin(self, stage: str, total: int) -> None:
                self.bad = 0
                self.task = shown.add_task(f"{stage:<11}", total=total, rate="", bad="")

            def advance(self, record: Record | None) -> None:
                self.bad += record is not None and not record.done
                shown.advance(self.task)
                speed = next(task.speed for task in shown.tasks if task.id == self.task)
                rate = f"{speed:.1f}/s" if speed else ""
                shown.update(self.task, rate=rate, bad=f"{self.bad} not done" if self.bad else "")

        yield Bar()
