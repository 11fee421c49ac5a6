"""A workbook to fill in, of the flavour that its program needs."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from addin.contract.shipped import template_path
from addin.template.variants import Flavour

if TYPE_CHECKING:
    from addin.template.examples import Example

__all__ = ["make_workbook"]


def make_workbook(
    path: Path,
    system: str,
    example: str | Example | None,
    flavour: Flavour,
    *,
    studies: bool = False,
) -> None:
    """Make a workbook; a file of that name is replaced, and only by a whole one.

    Parameters
    ----------
    path : Path
        The workbook. [path]
    system : str
        ``us`` or ``si``. [word]
    example : str, Example or None
        Key of `addin.template.examples.EXAMPLES`, or what is filled in; None = to be filled in. [name]
    flavour : Flavour
        What it is for.
    studies : bool, optional
        With the sheets of the studies. [flag]

    Raises
    ------
    OSError
        If it cannot be written.
    ExcelError
        If it needs xlwings and that is not installed.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".torsionbook-") as folder:
        made = Path(folder) / "made.xlsx"
        shipped = not studies and (example is None or isinstance(example, str))
        if flavour.spelled is None and shipped:
            name = f"example_{example}.xlsx" if example else f"blank_{system}.xlsx"
            shutil.copyfile(template_path(name), made)
        else:
            from addin.template.build import build_template

            build_template(made, system, example, flavour, studies=studies)
        if flavour.suffix == ".xlsm":
            from addin.excel.workbook import install

            install(made, made.with_suffix(".xlsm"))
            made = made.with_suffix(".xlsm")
        os.replace(made, path)
