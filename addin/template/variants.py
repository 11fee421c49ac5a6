"""The variants of the shipped workbooks: how each front's program spells a worksheet function.

A cell shows one name; the file holds another, and a third program none at all. The plain variant
has no functions: it is for calculation without a spreadsheet program, and opens everywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from addin.libreoffice.names import programmatic_name


def _office(function: str) -> str:
    """Custom functions of Office.js stand in the file behind a mark, the point as an underscore."""
    return f"_xldudf_{function}"


@dataclass(frozen=True)
class Variant:
    """One kind of workbook."""

    name: str  #: As the command line names it.
    suffix: str  #: Ending of its files.
    help: str  #: Whom it is for.
    #: Name of a function of the registry → what the file holds; None = no sheet `Live`.
    spelled: Callable[[str], str] | None = None
    dynamic: bool = False  #: Whether its array formulas are dynamic arrays; else of fixed size.
    #: Whether its program takes stored values when it opens a file, also those of models, which it has not in memory then.
    trusts_values: bool = False


#: By name; the first is the usual one.
VARIANTS: Mapping[str, Variant] = {
    one.name: one
    for one in (
        Variant("files", ".xlsx", "without functions: recalculated as a file, opens everywhere"),
        Variant("excel", ".xlsm", "desktop Excel on Windows, functions through xlwings", str),
        Variant(
            "server", ".xlsx", "Excel on Mac, Windows and in the browser, functions from a server",
            _office, dynamic=True,
        ),
        Variant(
            "calc", ".xlsx", "LibreOffice Calc with torsionbook.oxt", programmatic_name,
            trusts_values=True,
        ),
    )
}  # fmt: skip
