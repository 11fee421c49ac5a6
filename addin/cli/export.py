"""`torsionbook export`: inputs as a case JSON, or the train as others read it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import check_choice
from addin.cli.status import WRONG_INPUT, failing_on
from addin.cli.terminal import list_problems, read_or_stop, refuse_no_json, writing
from addin.contract.tables import STUDY_INPUT_TABLES
from addin.exchange.foreign import ForeignError
from addin.exchange.opentorsion import opentorsion_of
from addin.exchange.ross import ross_of
from addin.exchange.text_tables import table_text
from addin.reading.case_json import case_to_json
from addin.reading.typed_case import CaseInput
from addin.template.filled import MixedUnits, example_of
from addin.xlsx.places import real_path
from addin.xlsx.whole_files import write_json, write_text

#: Ending of a table of text → what stands between its cells.
_DELIMITERS = {".csv": ",", ".tsv": "\t"}
_FORMATS = ("case", "table", "opentorsion", "ross")


def export(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    out: Annotated[
        Path,
        typer.Argument(
            help="The file to write: .json, or .csv or .tsv for tables.", show_default=False
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            help="case: all inputs as a case JSON, in SI, with those of the studies (default of .json); table: stations, "
            "elements, sections and meshes as text in the units of the file (default of .csv and .tsv); opentorsion: a "
            "system (TORS) of a train without branches; ross: a rotor of one shaft line.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Write the inputs as a case JSON, or the train as a table of text, for openTorsion or ROSS.

    Examples: `torsionbook export train.xlsx case.json`; `torsionbook export train.xlsx train.csv`;
    `torsionbook export train.xlsx tors.json --to opentorsion`
    """
    ending = out.suffix.lower()
    form = to or ("table" if ending in _DELIMITERS else "case")
    check_choice("--to", form, _FORMATS)
    if real_path(out) == real_path(file):
        raise typer.BadParameter(f"{out} is the input. Choose another name.")
    if form == "table" and ending not in _DELIMITERS:
        raise typer.BadParameter(f"'{out}' must end in {', '.join(_DELIMITERS)}.")
    refuse_no_json(out, ending if form == "table" else ".json", for_case=True)
    read = read_or_stop(file)
    if form == "case":
        _export_case(file, read, out)
    elif form == "table":
        with failing_on(MixedUnits, about=file):
            example = example_of(read, "si")
        with writing(out):
            write_text(out, table_text(example.tables, example.units, _DELIMITERS[ending]))
        typer.echo(f"{out} is written.")
    else:
        _export_model(file, read, out, form)


def _export_case(file: Path, read: CaseInput, out: Path) -> None:
    studies = read.studies
    wrong = () if studies is None else studies.problems_of(studies.tables)
    if wrong:
        list_problems(file, wrong)
        raise typer.Exit(WRONG_INPUT)
    content = case_to_json(read.data, studies)
    with writing(out):
        write_json(out, content)
    taken = [spec.name for spec in STUDY_INPUT_TABLES if spec.key in content]
    tables = f", with the study tables {', '.join(taken)}" if taken else ""
    typer.echo(f"{out} is written{tables}.")


def _export_model(file: Path, read: CaseInput, out: Path, form: str) -> None:
    with failing_on(ForeignError, about=file):
        if form == "ross":
            content, notes = ross_of(read.case())
        else:
            content, notes = opentorsion_of(read.case(), file.stem)
    with writing(out):
        write_json(out, content)
    typer.echo(f"{out} is written.")
    for note in notes:
        typer.echo(f"  {note}")
