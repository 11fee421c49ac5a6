"""The page docs/commands.md: every command with its arguments and options, from their own help."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import typer
from typer.main import get_command

from addin.cli.app import GROUPS, app
from addin.cli.study import study_command
from addin.cli.study_commands import STUDY_COMMANDS
from addin.studies.registry import found_studies

HEAD = """# Commands

Made from the help of the commands by `make generated`; do not edit. `torsionbook COMMAND --help` shows the same in the terminal,
`torsionbook --install-completion` makes the shell complete them.

Exit status: 0 done, 1 input error (every error is listed, nothing is written for that file), 2 wrong usage, 3 an error inside torsionbook,
130 interrupted by Ctrl-C.
"""


def commands_page() -> str:
    """The page."""
    program: Any = get_command(app)
    context = program.context_class(program, info_name="torsionbook")
    lines = [HEAD]
    for group, commands in GROUPS.items():
        lines.append(f"\n## {group}\n")
        if commands is STUDY_COMMANDS:  # itself made from the records: a new study is not in it yet
            made = {study.command: _study(study.command) for study in found_studies()}
        else:
            made = {name: program.get_command(context, name) for name in commands}
        for name, command in made.items():
            lines += _command(command, f"torsionbook {name}")
    return "".join(lines)


def _study(name: str) -> Any:
    """The command of a study."""
    single = typer.Typer(add_completion=False, rich_markup_mode="markdown")
    single.command(name)(study_command(name))
    return get_command(single)


def _command(command: Any, name: str) -> Iterator[str]:
    """One command, or each of a group of commands."""
    if hasattr(command, "commands"):
        for part in command.commands.values():
            yield from _command(part, f"{name} {part.name}")
        return
    yield f"\n### {name}\n\n{inspect.cleandoc(command.help or '').strip()}\n"
    shown = [p for p in command.params if not getattr(p, "hidden", False) and p.name != "help"]
    if shown:
        yield "\n| argument, option | what it does |\n|---|---|\n"
    for parameter in shown:
        if parameter.param_type_name == "argument":
            names = (parameter.metavar or parameter.name).upper()
        else:
            names = ", ".join((*parameter.opts, *parameter.secondary_opts))
        text = " ".join((getattr(parameter, "help", None) or "").split()).replace("|", "\\|")
        yield f"| `{names}` | {text} |\n"
