"""The command line: the same path on files as in Excel, without Excel.

A command's module is imported when the command is called, so that --help and version answer at once.
"""

from __future__ import annotations

import errno
import gc
import importlib
import io
import keyword
import os
import re
import sys
import traceback
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command, get_group

from addin.cli.status import INTERNAL, INTERRUPTED, WRONG_INPUT
from addin.cli.study_commands import STUDY_COMMANDS
from addin.contract.fixed_date import WrongDate, fixed_date
from addin.contract.version import product_version
from addin.workers.stop import causes

#: Every command and the first line of its own help, by the group it has in --help and in the order there.
GROUPS = {
    "Daily": {
        "new": "Make a workbook: blank, a filled example, or with the inputs of an existing file.",
        "upgrade": "Move the inputs of a workbook, and your own sheets, into a workbook of this version.",
        "import": "Make a workbook from a table of text, or from a model of openTorsion or ROSS.",
        "check": "Read and check inputs without calculating: every error with its sheet and cell.",
        "recalc": "Calculate workbooks or case JSON files and write their results.",
        "batch": "Calculate folders of workbooks on all cores; a file with errors does not stop the others.",
    },
    "Review": {
        "report": "Write the calc sheet as a document: PDF, Word, or both.",
        "verify": "Recalculate from the inputs in a file and compare every result recorded in it.",
        "diff": "Compare inputs and results of two files: changed inputs and their effect on results.",
        "export": "Write the inputs as a case JSON, or the train as a table of text, for openTorsion or ROSS.",
    },
    "Studies": STUDY_COMMANDS,
    "Other programs": {
        "excel": "Worksheet functions in desktop Excel on Windows, through xlwings.",
        "calc": "Worksheet functions in LibreOffice Calc.",
        "serve": "Serve the worksheet functions, the Office add-in and recalculation over HTTP.",
        "mcp": "Read, calculate and explain workbooks for an assistant that speaks MCP.",
    },
    "Program": {"version": "Print the version."},
}
#: Errors of disks and networks, wherever they come up. Windows has not all of them.
_OF_THE_DISK = {
    getattr(errno, name, None)
    for name in ("EIO", "ENOSPC", "EDQUOT", "EACCES", "EROFS", "ESTALE", "ENAMETOOLONG")
} - {None}
#: How `tempfile` says that no folder for temporary files can be written, as in a read-only container.
_NO_TEMPORARY_FOLDER = "No usable temporary directory"
COMMANDS = {name: line for commands in GROUPS.values() for name, line in commands.items()}


def module_of(name: str) -> str:
    """The module of a command, imported when it is called.

    It holds a function, or a `typer.Typer` of subcommands, of the command's name; one module makes the
    commands of all studies from their records.
    """
    return "addin.cli.study" if name in STUDY_COMMANDS else f"addin.cli.{_python_name(name)}"


def _python_name(name: str) -> str:
    """The name of a command's function and module; a word of the language has a line behind it."""
    return f"{name}_" if keyword.iskeyword(name) else name


class CommandWithExample(TyperCommand):
    """A command that shows the example of its help where an argument or option is missing."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments; of one that is missing its help and an example."""
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as wrong:
            if wrong.message or wrong.param is None:  # not missing
                raise
            what = getattr(wrong.param, "help", None) or ""
            example = re.search(r"Examples?: `(.+?)`", self.help or "")
            wrong.message = " ".join([what, f"Example: {example[1]}"] if example else [what])
            raise


class LazyCommands(TyperGroup):
    """The commands of the table; --help lists them without importing any."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        # Stand-ins, for the help, for completion and for what is mistyped.
        for group, commands in GROUPS.items():
            for name, line in commands.items():
                self.commands[name] = TyperCommand(name, help=line, rich_help_panel=group)

    def get_command(self, ctx: typer.Context, cmd_name: str) -> Any:  # type: ignore[override]
        """A command, of which only now the module is imported; None if there is none."""
        if cmd_name not in COMMANDS:
            return None
        gc.disable()  # what modules define stays: nothing to look for, neither now nor later
        module = importlib.import_module(module_of(cmd_name))
        gc.freeze()
        gc.enable()
        if cmd_name in STUDY_COMMANDS:
            command = module.study_command(cmd_name)
        else:
            command = getattr(module, _python_name(cmd_name))
        if isinstance(command, typer.Typer):
            return get_group(command)
        single = typer.Typer(add_completion=False, rich_markup_mode="markdown")
        single.command(cmd_name, cls=CommandWithExample)(command)
        return get_command(single)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """The help, with the commands as the table has them."""
        self._of_stand_ins().format_help(ctx, formatter)

    def shell_complete(self, ctx: Any, incomplete: str) -> Any:
        """Names of commands that begin so, and their lines of help."""
        return self._of_stand_ins().shell_complete(ctx, incomplete)

    def _of_stand_ins(self) -> TyperGroup:
        """The same group, of which no command is imported."""
        return TyperGroup(
            name=self.name,
            help=self.help,
            params=self.params,
            commands=dict(self.commands),
            rich_markup_mode=self.rich_markup_mode,
        )


app = typer.Typer(
    name="torsionbook",
    cls=LazyCommands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help=(
        "Torsional start-up analysis of synchronous-motor trains in Excel workbooks.\n\n"
        "A first run, from an empty folder:\n\n"
        "    torsionbook new train.xlsx --example proposed\n\n"
        "    torsionbook recalc train.xlsx\n\n"
        "Fill in your own train with `torsionbook new mine.xlsx --units us`, check it with "
        "`torsionbook check mine.xlsx`, and calculate it with `torsionbook recalc mine.xlsx`. "
        "Results go to a new file beside it; your workbook is not changed.\n\n"
        "Exit status: 0 done, 1 input error (every error is listed, nothing is written for "
        "that file), 2 wrong usage, 3 an error inside torsionbook, 130 interrupted by Ctrl-C."
    ),
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"torsionbook {product_version()}")
        raise typer.Exit()


@app.callback()
def _program(
    version: Annotated[
        bool,
        typer.Option(
            "--version", "-V", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """See the help of `app`; only --version is added here."""
    try:
        fixed_date()
    except WrongDate as wrong:
        raise typer.BadParameter(str(wrong)) from wrong


def _by_ctrl_c(ended: BaseException) -> bool:
    """Whether a command was cut short; one that ends by itself after Ctrl-C has said why."""
    return any(isinstance(cause, KeyboardInterrupt) for cause in causes(ended))


def _tell_interrupted() -> None:
    typer.echo(
        "Interrupted. Files written earlier are complete; nothing was written for the current "
        "file.",
        err=True,
    )


def _open_closed_streams() -> None:
    """Have the null device where a stream is closed; the first file opened would take its number, and be written into."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))


def _drop_output() -> None:
    """Drop what a full output does not take: Python would try again as it ends, and change the exit status."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _write_utf8() -> None:
    """Where output goes to a file or another program, write UTF-8 unless PYTHONIOENCODING names something else.

    Windows would take the code page of the machine, other systems that of the locale, which may lack half the words.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.isatty() or "PYTHONIOENCODING" in os.environ:
                stream.reconfigure(errors="replace")
            else:
                stream.reconfigure(encoding="utf-8", errors="replace")


def main() -> None:
    """Entry point: run the command line and turn what goes wrong into its exit status."""
    # Matrices here have at most some hundred rows: more threads of the linear algebra would only wait for each other,
    # most of all on a busy machine. It is read when numpy is imported, hence before any command.
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    _open_closed_streams()
    _write_utf8()
    try:
        app(standalone_mode=True)
    except SystemExit as ended:
        if ended.code == INTERRUPTED and _by_ctrl_c(ended):
            _tell_interrupted()
        raise
    except KeyboardInterrupt:
        _tell_interrupted()
        sys.exit(INTERRUPTED)
    except Exception as wrong:
        if isinstance(wrong, OSError) and (
            wrong.errno in _OF_THE_DISK or _NO_TEMPORARY_FOLDER in str(wrong)
        ):
            place = f"{wrong.filename}: " if wrong.filename else ""
            typer.echo(
                f"{place}{wrong.strerror}. Files that were written are complete; nothing else was written. Check the "
                "disk, the names and your rights, and run again.",
                err=True,
            )
            _drop_output()
            sys.exit(WRONG_INPUT)
        # the last resort: anything else is ours, and must not look like input
        traceback.print_exc()
        typer.echo(
            "This is an error inside torsionbook. Nothing was written for the current file. "
            "Please report it with the messages above.",
            err=True,
        )
        sys.exit(INTERNAL)


if __name__ == "__main__":
    main()
