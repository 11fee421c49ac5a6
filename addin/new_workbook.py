"""A workbook to fill in, of the flavour that its program needs."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

from addin.flavours import Flavour
from addin.template_files import template_path

__all__ = ["make_workbook"]


def make_workbook(path: Path, system: str, example: str | None, flavour: Flavour) -> None:
    """Make a workbook; a file of that name is replaced, and only by a whole one.

    Parameters
    ----------
    path : Path
        The workbook. [path]
    system : str
        ``us`` or ``si``. [word]
    example : str or None
        Key of `addin.examples.EXAMPLES`; None = to be filled in. [name]
    flavour : Flavour
        What it is for.

    Raises
    ------
    OSError
        If it cannot be written.
    ExcelError
        If it needs xlwings and that is not installed.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".torsionbook-") as folder:
        made = Path(folder) / "made.xlsx"
        if flavour.spelled is None:
            name = f"example_{example}.xlsx" if example else f"blank_{system}.xlsx"
            shutil.copyfile(template_path(name), made)
        else:
            from addin.template import build_template

            build_template(made, system, example, flavour)
        if flavour.suffix == ".xlsm":
            from addin.excel.workbook import install

            install(made, made.with_suffix(".xlsm"))
            made = made.with_suffix(".xlsm")
        os.replace(made, path)
