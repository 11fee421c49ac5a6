"""The commands of the studies, each made from the record of its study; Ctrl-C, and the words at the end."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from addin.cli.options import (
    AddOption,
    FileArgument,
    IgnoreLockOption,
    InPlaceOption,
    JobsOption,
    JsonOption,
    OutOption,
    SchedulerOption,
    check_choice,
)
from addin.cli.status import INTERRUPTED, WRONG_INPUT, failed, failing_on
from addin.cli.terminal import (
    list_problems,
    print_table,
    print_written,
    progress,
    refuse_no_folder,
    refuse_no_json,
    study_targets,
)
from addin.contract.problems import printable
from addin.contract.study_spec import StudySpec
from addin.contract.version import product_version
from addin.reading.one_file import file_problem
from addin.reading.workbook import WorkbookInput
from addin.studies.registry import study_of_command
from addin.studies.run_study import StudyFiles, StudyOutcome, part_of_study, study_one
from addin.studies.study import Option, Study, StudyResult
from addin.workers.cluster import ClusterRefused
from addin.workers.opened_map import open_parallel_map
from addin.workers.parallel_map import Cancelled, UnitLost, serial_map
from addin.workers.stop import Abandoned, Stop, Stopped
from addin.xlsx.places import real_path


def study_command(name: str) -> Callable[..., None]:
    """The function of a study's command, with the parameters that its options make."""
    study = study_of_command(name)

    def command(file: Path, **given: Any) -> None:
        _run(study, file, given)

    parameters: dict[str, tuple[Any, Any]] = {
        "file": (FileArgument, inspect.Parameter.empty),
        "out": (OutOption, None),
        "in_place": (InPlaceOption, False),
        **({"add": (AddOption, False)} if study.inputs else {}),
        "json": (JsonOption, None),
        **{
            option.name: (_annotation(option), None if option.file_endings else option.default)
            for option in study.options
        },
        "ignore_lock": (IgnoreLockOption, False),
    }
    if not study.measures_time:
        parameters |= {"jobs": (JobsOption, None), "scheduler": (SchedulerOption, None)}
    command.__name__, command.__doc__ = name, study.command_help
    command.__annotations__ = {key: annotation for key, (annotation, _) in parameters.items()}
    command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(
                key, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=annotation
            )
            for key, (annotation, default) in parameters.items()
        ]
    )
    return command


def _annotation(option: Option) -> Any:
    """An option as typer takes it."""
    kind: Any = option.kind if option.default is not None else option.kind | None
    if option.file_endings:  # a number and a file, in any order: read by `_number_and_file`
        declared = typer.Option(
            f"--{option.name}", help=f"{option.help} {option.file_help} [default: {option.default}]",
            metavar=option.metavar, show_default=False,
        )  # fmt: skip
        return Annotated[list[str] | None, declared]
    declared = typer.Option(
        f"--{option.name}",
        help=option.help,
        min=option.least,
        max=option.most,
        metavar=option.metavar,
        show_default=option.default is not None,
    )
    return Annotated[kind, declared]


def _run(study: Study, file: Path, given: Mapping[str, Any]) -> None:
    """Run a study and say what became of it.

    Raises
    ------
    typer.Exit
        With 1 for wrong input, 130 after Ctrl-C, whether or not the part that was calculated could be
        written; everything has been said.
    """
    options = {option.name: given[option.name] for option in study.options}
    for option in study.options:
        if option.file_endings:
            options |= _number_and_file(option, given[option.name] or ())
    _check_options(study, file, options)
    settings = {option.name: options[option.name] for option in study.options if option.is_setting}
    destination, json_file = study_targets(
        file, study.command, given["out"], given["json"], given["in_place"]
    )
    _refuse_one_file_twice(study, options, destination, json_file)
    asked = [f"--{name}" for name in study.part_options if options[name] is not None]
    if asked:
        useless = [f"--{o.replace('_', '-')}" for o in ("out", "json", "in_place") if given[o]]
        if useless:
            raise typer.BadParameter(
                f"{asked[0]} calculates a part, not the study that {' and '.join(useless)} would write: leave "
                "out the one or the other."
            )
        _only_part(study, file, settings, options)
        return
    files = StudyFiles(
        destination, given["in_place"], json_file, given["ignore_lock"], _add_sheets,
        given.get("add", False),
    )  # fmt: skip
    outcome = _outcome(study, file, settings, files, given)
    if outcome.lacking and _wants(outcome.lacking, file):
        outcome = _outcome(study, file, settings, replace(files, add_inputs=True), given)
    for sentence in outcome.warnings:
        typer.echo(f"{file}: note: {printable(sentence)}", err=True)
    if outcome.result is None:
        list_problems(file, outcome.problems, bool(outcome.written))
        raise typer.Exit(WRONG_INPUT)
    _show(study, outcome.result, options)
    print_written(outcome.written)
    try:
        print_written(study.save(outcome.result, options, file))
    except OSError as wrong:
        place = Path(wrong.filename) if isinstance(wrong.filename, str) else file
        raise failed(file_problem(place, wrong).message) from wrong
    if outcome.result.cut_short is not None:
        raise typer.Exit(INTERRUPTED)


def _add_sheets(read: WorkbookInput, study: StudySpec, folder: Path) -> WorkbookInput:
    """The builder of sheets is loaded only where some are added."""
    from addin.template.study_sheets import with_study_sheets

    return with_study_sheets(read, study, folder)


def _wants(sheets: Sequence[str], file: Path) -> bool:
    """Ask at a terminal whether input sheets are added."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    names = f"sheet{'s' if len(sheets) > 1 else ''} {' and '.join(sheets)}"
    question = f"{file.name} has no {names}. Add with usual rows and calculate?"
    return typer.confirm(question, default=True, err=True)


def _outcome(
    study: Study,
    file: Path,
    settings: Mapping[str, Any],
    files: StudyFiles,
    given: Mapping[str, Any],
) -> StudyOutcome:
    """The study; after Ctrl-C the command ends."""
    stop = Stop()

    def on_stage(stage: str) -> None:
        stop()  # a second Ctrl-C cancels between units as well
        tell(f"{file.name}: {stage}" + (" (stopping)" if stop.asked else ""))

    try:
        with (
            failing_on(ClusterRefused, Stopped, UnitLost, about=file),
            progress() as tell,
            nullcontext() if study.measures_time else stop.listening(tell),
            open_parallel_map(
                1 if study.measures_time else given["jobs"],
                given.get("scheduler"),
                product_version,
                stop,
            ) as parallel_map,
        ):
            return study_one(study, file, parallel_map, settings, files, on_stage)
    except (Abandoned, Cancelled, KeyboardInterrupt) as ended:
        why = f" {ended.why}" if isinstance(ended, Cancelled) and ended.why else ""
        typer.echo(f"{file}: stopped by Ctrl-C.{why} Nothing was written.", err=True)
        raise typer.Exit(INTERRUPTED) from None


def _only_part(
    study: Study, file: Path, settings: Mapping[str, Any], options: Mapping[str, Any]
) -> None:
    """Calculate, show and write the one part that was asked for."""
    part, problems = part_of_study(study, file, serial_map(), settings, options)
    if part is None:
        list_problems(file, problems, False)
        raise typer.Exit(WRONG_INPUT)
    print_table((("Quantity", "name"), ("Value", "text")), part.rows)
    typer.echo(printable(part.sentence))
    try:
        print_written(part.save())
    except OSError as wrong:
        place = Path(wrong.filename) if isinstance(wrong.filename, str) else file
        raise failed(file_problem(place, wrong).message) from wrong


def _number_and_file(option: Option, words: Sequence[str]) -> dict[str, Any]:
    """What was typed for an option that takes a number, a file, or one of each."""
    found: dict[str, Any] = {}
    for word in words:
        number = word.strip().lstrip("+-").isdigit()
        name = option.name if number else f"{option.name}_file"
        if name in found:
            what = "number" if number else "file"
            raise typer.BadParameter(f"--{option.name} is given two {what}s; give one.")
        found[name] = int(word) if number else Path(word)
    count = found.setdefault(option.name, option.default)
    if not (option.least or 0) <= count <= (option.most or count):
        raise typer.BadParameter(f"--{option.name} is {count}; it must be {option.allowed}.")
    found.setdefault(f"{option.name}_file", None)
    return found


def _check_options(study: Study, file: Path, options: Mapping[str, Any]) -> None:
    """Refuse what no option may be, before the work that would be lost."""
    for option in study.options:
        value, path = options[option.name], options.get(f"{option.name}_file")
        if path is not None:
            if real_path(path) == real_path(file):
                raise typer.BadParameter(f"--{option.name} would overwrite the input.")
            refuse_no_json(path, " or ".join(option.file_endings))
        if option.words:
            check_choice(f"--{option.name}", value, option.words)
        elif option.kind is Path and value is not None:
            if real_path(value) == real_path(file):
                raise typer.BadParameter(f"--{option.name} would overwrite the input.")
            if option.metavar == "FOLDER":
                refuse_no_folder(value)
            else:
                refuse_no_json(value, for_case=True)
    if sentence := study.refusal(options):
        raise typer.BadParameter(sentence)


def _refuse_one_file_twice(
    study: Study, options: Mapping[str, Any], destination: Path | None, json_file: Path | None
) -> None:
    """Two outputs in one file would leave the second alone."""
    targets = {"--out": destination, "--json": json_file}
    for option in study.options:
        path = options.get(f"{option.name}_file")
        value = options[option.name]
        if option.kind is Path and isinstance(value, Path) and option.metavar != "FOLDER":
            path = value
        targets[f"--{option.name}"] = path
    seen: dict[Path, str] = {}
    for name, path in targets.items():
        if path is None:
            continue
        if other := seen.get(real_path(path)):
            raise typer.BadParameter(
                f"{other} and {name} would both be written to {path}: they name the same file; give two."
            )
        seen[real_path(path)] = name


def _show(study: Study, result: StudyResult, options: Mapping[str, Any]) -> None:
    for block in study.terminal(result, options):
        if isinstance(block, str):
            typer.echo(printable(block))
        else:
            print_table(block.columns, block.rows)
    for sentence in (result.sentence, *result.remarks):
        typer.echo(printable(sentence))
