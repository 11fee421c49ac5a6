"""``torsionbook verify``: whether the results in a file follow from the inputs in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import check_choice
from addin.cli.status import WRONG_INPUT, failing_on
from addin.cli.terminal import refuse_no_json
from addin.reading.one_file import file_problem
from addin.verify.file import verify_file
from addin.verify.findings import Agreement
from addin.verify.trace import traced
from addin.verify.wording import as_json, lines
from addin.xlsx.places import real_path
from addin.xlsx.whole_files import write_json

_WITHIN = {"bits": 0, "digits": 1, "error": 2}


def verify(
    files: Annotated[
        list[Path],
        typer.Argument(help="Calculated workbooks, or result JSON files.", show_default=False),
    ],
    case: Annotated[
        Path | None, typer.Option(help="Case JSON or workbook with the inputs of a result JSON.")
    ] = None,
    within: Annotated[
        str,
        typer.Option(
            help="Accepted deviation: bits (identical), digits (equal in the digits shown) or "
            "error (within the reported error of the result)."
        ),
    ] = "error",
    json: Annotated[
        Path | None,
        typer.Option(help="Also write it as JSON: a file, or a folder for several inputs."),
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="List all findings.")] = False,
    trace: Annotated[
        str | None,
        typer.Option(
            help="Instead of verifying, explain a result: its meaning, equation and inputs. Name "
            "a table (SteadyState), a column (SteadyState.Torque) or a cell ('Results!AW9')."
        ),
    ] = None,
) -> None:
    """Recalculate from the inputs in a file and compare every result recorded in it.

    Exit status 0 if everything follows from the inputs, 1 if something does not, was edited, or
    was never calculated. Nothing is written into the file.

    Examples: `torsionbook verify train.out.xlsx`;
    `torsionbook verify train.results.json --case train.json`
    """
    check_choice("--within", within, tuple(_WITHIN))
    if trace is not None:
        _trace(files, trace)
        return

    passed = True
    folder = json is not None and (len(files) > 1 or json.is_dir())
    if json is not None:
        _refuse_clashes(files, case, json, folder)
    for file in files:
        verification = verify_file(file, case=case, within=Agreement(_WITHIN[within]))
        passed = passed and verification.passes
        for line in lines(verification, everything):
            typer.echo(line)
        if json is not None:
            target = json / f"{file.stem}.verify.json" if folder else json
            try:
                write_json(target, as_json(verification))
            except OSError as wrong:
                typer.echo(file_problem(target, wrong).message, err=True)
                passed = False
    if not passed:
        raise typer.Exit(WRONG_INPUT)


def _refuse_clashes(files: list[Path], case: Path | None, json: Path, folder: bool) -> None:
    """Two files with one JSON, or a JSON on top of a file verified, are refused before any work."""
    sources = {real_path(file) for file in (*files, *([case] if case else []))}
    if not folder:
        if real_path(json) in sources:
            raise typer.BadParameter(f"{json} is one of the inputs. Choose another name.")
        refuse_no_json(json)
    seen: dict[str, Path] = {}
    for file in files if folder else ():
        target = json / f"{file.stem}.verify.json"
        other = seen.setdefault(target.name.casefold(), file)
        if real_path(other) != real_path(file):
            raise typer.BadParameter(
                f"{other} and {file} would both be written to {target}. Verify them separately, "
                "or into two folders."
            )
        if real_path(target) in sources:
            raise typer.BadParameter(f"{target} is one of the inputs. Choose another folder.")


def _trace(files: list[Path], wanted: str) -> None:
    for file in files:
        with failing_on(ValueError):
            for line in traced(file, wanted):
                typer.echo(line)
