"""The worksheet functions for xlwings Server, for those who hold its licence.

Not part of the default installation, and not needed: `torsionbook serve` brings the same functions
to the same programs without a licence. Who runs xlwings Server for other things imports this in the
``custom_functions`` of its project::

    from addin.excel.xlwings_server import *

The functions are called ``=TV.FREQUENCIES(...)`` as with our own server. Starts calculate in a
thread, so that the server answers others meanwhile. xlwings Server hands over a blank cell as 0
(its documentation says so), which these functions cannot tell from a typed 0: a table that contains a 0 has no
answer but a sentence. Without a licence key xlwings refuses the import.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import xlwings
from xlwings import server as xlwings_server

from addin.excel.signatures import excel_functions, exported
from addin.server.office import NAMESPACE
from addin.worksheet.registry import Function, FunctionError, call

__all__: list[str] = []


def _answer(name: str, cells: tuple[Any, ...]) -> list[list[Any]]:
    """Rows; where there is none, xlwings shows the sentence with an error value."""
    for number, given in enumerate(cells, 1):
        if _is_doubtful(given):
            raise xlwings.XlwingsError(
                f"Argument {number} contains a 0 or a blank cell; xlwings Server gives both as 0. Use the add-in "
                "of torsionbook serve, or a table without them."
            )
    try:
        rows = call(name, cells)
    except FunctionError as wrong:
        raise xlwings.XlwingsError(wrong.message) from None
    return [["" if value is None else value for value in row] for row in rows]


def _is_doubtful(given: Any) -> bool:
    """Whether an argument is a table in which a 0 may have been a blank cell."""
    rows = given if isinstance(given, list) else []
    values = [value for row in rows for value in (row if isinstance(row, list) else [row])]
    return len(values) > 1 and any(value == 0 and value is not False for value in values)


def _exported(described: Function) -> Callable[..., Any]:
    """A function as xlwings Server wants it: with its name, signature and help."""

    async def function(*cells: Any) -> list[list[Any]]:
        return await asyncio.to_thread(_answer, described.name, cells)

    function.__name__ = described.name.lower()
    named = xlwings_server.func(
        name=described.name.removeprefix(f"{NAMESPACE}_"), namespace=NAMESPACE
    )
    return named(exported(function, described, xlwings_server.arg))


for _one in excel_functions():
    globals()[_one.name.lower()] = _exported(_one)
    __all__ += [_one.name.lower()]  # noqa: PLE0604
