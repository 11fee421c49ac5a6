"""A new workbook, made with XlsxWriter."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xlsxwriter

#: The number of the calculation of Excel 2019 and later. With that of an earlier Excel, it calculates all of a workbook
#: on opening, and asks whether to save it on closing.
_CALCULATION = 191029


def new_book(made: io.BytesIO, options: Mapping[str, Any] | None = None) -> xlsxwriter.Workbook:
    """A workbook to fill and to close, with the same line ends on every system, whose values Excel takes as they are."""
    import xlsxwriter  # which a batch without a summary does not need

    book = xlsxwriter.Workbook(made, {"in_memory": True, **(options or {})})
    book.set_calc_mode("auto", _CALCULATION)
    book.calc_on_load = False
    return book
