"""`torsionbook import`: a train from a table of text, openTorsion or ROSS as a workbook or case JSON."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.new import make_workbook
from addin.cli.options import ForceOption, check_choice
from addin.cli.status import WRONG_INPUT, failing_on
from addin.cli.terminal import failed, list_problems, refuse_existing, refuse_no_json, writing
from addin.excel.errors import ExcelError
from addin.exchange.foreign import ForeignError, ForeignTrain
from addin.exchange.read_train import checked_train, read_train
from addin.reading.case_json import case_to_json
from addin.reading.one_file import file_problem
from addin.template.filled import example_of
from addin.template.variants import VARIANTS
from addin.xlsx.whole_files import write_json

#: Largest file that is read; a train of 2,000 stations has 1 MB. [B]
_LARGEST_FILE = 20 * 2**20


def import_(
    file: Annotated[
        Path,
        typer.Argument(
            help="Table of text (CSV, tabs), system of openTorsion (TORS, JSON) or rotor saved by ROSS (TOML, JSON); - reads "
            "what comes through a pipe, such as a clipboard.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", help="The workbook or case JSON to write.", show_default=False)
    ],
    units: Annotated[
        str, typer.Option(help="Units of what the file does not have: us or si.")
    ] = "si",
    force: ForceOption = False,
) -> None:
    """Make a workbook from a table of text, or from a model of openTorsion or ROSS.

    What was read, in what units, and what was left out is listed; wrong input is named by its line.

    Examples: `torsionbook import masses.csv --out train.xlsx`; `torsionbook import rotor.toml --out rotor.json`
    """
    check_choice("--units", units, ("us", "si"))
    variant = VARIANTS["excel" if out.suffix.lower() == ".xlsm" else "files"]
    as_json = out.suffix.lower() == ".json"
    if not as_json and out.suffix.lower() != variant.suffix:
        raise typer.BadParameter(f"'{out}' must end in .xlsx, .xlsm or .json.")
    refuse_existing(out, force)
    if as_json:
        refuse_no_json(out, for_case=True)
    train = _read(file)
    for note in train.notes:
        typer.echo(f"  {note}")
    read = checked_train(train)
    if read.problems:
        list_problems(file, read.problems)
        raise typer.Exit(WRONG_INPUT)
    if as_json:
        with writing(out):
            write_json(out, case_to_json(read.data))
        typer.echo(f"{out} is written.")
        return
    with failing_on(ExcelError, about=out), writing(out):
        make_workbook(out, units, example_of(read, units), variant)
    typer.echo(f"{out} is ready. Fill in the yellow cells, then: torsionbook recalc {out}")


def _read(file: Path) -> ForeignTrain:
    """The train of a file or of the standard input; the command ends if there is none."""
    try:
        if str(file) == "-":
            raw = sys.stdin.buffer.read(_LARGEST_FILE + 1)
        else:
            with open(file, "rb") as stream:
                raw = stream.read(_LARGEST_FILE + 1)
    except OSError as error:
        raise failed(file_problem(file, error).message) from error
    if len(raw) > _LARGEST_FILE:
        raise failed(f"{file} is larger than {_LARGEST_FILE // 2**20} MB. It is not one train.")
    if raw[:2] in (b"PK", b"\xd0\xcf"):
        raise failed(f"{file} is a workbook. Use: torsionbook new FILE --from {file}")
    typer.echo(f"{file}:")
    try:
        return read_train(_text(raw))
    except ForeignError as error:
        raise failed(f"{file}: {error}") from error


def _text(raw: bytes) -> str:
    """Text in UTF-8, in UTF-16 with its mark, or as Windows writes it."""
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")
