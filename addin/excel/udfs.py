"""What desktop Excel calls: one function per entry of the registry, and the macro `Recalculate`.

The only module of the installation that imports xlwings. Excel hands cells over COM: doubles, texts, flags, dates, None for
a blank; error cells come as their text, since xlwings would make blanks of them. A classic function
cannot return one of Excel's error values: where there is no answer the cell shows the sentence
that says why, so formulas that depend on it test with ISNUMBER, not with ISERROR. Blank cells of an
answer are empty texts, which Excel shows as nothing.

On other systems than Windows the module can be imported, and xlwings' decorators do nothing.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from typing import Any

# As in addin/cli/app.py. The libraries of linear algebra read it when they are loaded, so here it holds for
# scipy's only: xlwings has loaded numpy before.
for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import xlwings as xw  # noqa: E402

from addin.excel.refill import refill  # noqa: E402
from addin.excel.signatures import excel_functions, exported  # noqa: E402
from addin.worksheet.registry import CATEGORY, Function, FunctionError, call  # noqa: E402

__all__ = ["recalculate"]

logger = logging.getLogger(__name__)


def _answer(name: str, cells: tuple[Any, ...]) -> list[list[Any]]:
    """Rows for Excel; where there is no answer, the sentence why."""
    try:
        rows = call(name, cells)
    except FunctionError as wrong:
        return [[wrong.message]]
    except Exception as wrong:  # the last resort: a cell must not show the lines of a program
        logger.exception("%s failed", name)
        return [
            [
                f"{name} failed inside torsionbook ({type(wrong).__name__}: {wrong}). "
                "Please report it with the workbook."
            ]
        ]
    return [["" if value is None else value for value in row] for row in rows]


def _exported(described: Function) -> Callable[..., Any]:
    """A function as xlwings wants it: with its name, signature and help."""

    def function(*cells: Any) -> list[list[Any]]:
        return _answer(described.name, cells)

    function.__name__ = described.name
    return xw.func(category=CATEGORY)(exported(function, described, xw.arg))


for _one in excel_functions():
    globals()[_one.name] = _exported(_one)
    __all__ += [_one.name]  # noqa: PLE0604


def recalculate() -> None:
    """Fill the result cells of the workbook whose macro called; see `addin.excel.refill`."""
    refill(xw.Book.caller())
