"""Arguments and options that several commands take."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

Files = Annotated[
    list[Path],
    typer.Argument(help="Workbooks (.xlsx, .xlsm) or case JSON files.", show_default=False),
]
FileArgument = Annotated[
    Path, typer.Argument(help="Workbook or case JSON.", show_default=False, metavar="FILE")
]
OutOption = Annotated[
    Path | None,
    typer.Option("--out", help="Folder for the result, or the file; default beside the input."),
]
InPlaceOption = Annotated[
    bool, typer.Option("--in-place", help="Write into the workbook itself; keeps a .bak copy.")
]
AddOption = Annotated[
    bool,
    typer.Option(
        "--add",
        help="Add the input sheets of the study with usual rows, where the workbook has none.",
    ),
]
JsonOption = Annotated[
    Path | None, typer.Option("--json", help="Also write the study as JSON: a file or a folder.")
]
JobsOption = Annotated[
    int | None,
    typer.Option(
        "--jobs", min=1, help="Number of processes; default: one per core.", show_default=False
    ),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Calculate on the Dask cluster with this scheduler, such as tcp://host:8786.",
    ),
]
IgnoreLockOption = Annotated[bool, typer.Option("--ignore-lock", help="Ignore lock files.")]
ForceOption = Annotated[bool, typer.Option("--force", help="Replace an existing file.")]
StrictOption = Annotated[
    bool,
    typer.Option(
        "--strict",
        help="Exit with 1 unless the overall verdict is pass or accepted by forced response.",
    ),
]
MethodOption = Annotated[
    str | None,
    typer.Option("--method", help="exponential (default) or newmark (average acceleration)."),
]
ToleranceOption = Annotated[
    str | None,
    typer.Option(
        "--tolerance", help="Wanted relative error of peak torques, such as 0.001 or 0.1%."
    ),
]


def check_choice(option: str, value: str, words: Sequence[str]) -> None:
    """Refuse a value that is none of the words of an option."""
    if value not in words:
        raise typer.BadParameter(f"{option} is '{value}'; it must be {' or '.join(words)}.")
