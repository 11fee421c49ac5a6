"""Writing into somebody's workbook without damaging it.

A workbook is a zip file of XML parts. Only the parts that hold written cells are rewritten, all others are copied as they
are stored; values that formulas and charts carry of changed cells are renewed or removed; the file is replaced in one
step. This package knows nothing of torsional vibration; numbers are written as they are given.

======================  ====================================================================================
module                  responsibility
======================  ====================================================================================
``workbook``            `open_workbook` and `Workbook`: what the rest of the add-in uses
``container``           the zip file: guards before opening, raw copy of untouched parts
``workbook_part``       sheets, defined names, relationships, content types, calculation settings
``sheet_part``          rows, cells and styles of one sheet
``tables``              Excel tables and their size
``table_writing``       rows into tables, with all that follows them and all that may be in the way
``written``             what was written, to be found again before the file is put in place
``charts``              chart ranges and the values that charts carry
``drawn_charts``        what charts draw and carry, for reading
``chart_titles``        titles of charts that lost their cell
``values``              what a cell may hold, and its XML
``formula_text``        references inside a formula
``dependents``          which formulas hang on changed cells
``calculator_copy``     the copy that the calculator of formulas is given
``formulas``            cached values of formulas: renewed or removed, never stale
``macros``              a VBA project and a hidden sheet of settings: .xlsx → .xlsm
``locks``               lock files of spreadsheet programs
``save``                writing whole or not at all
``references``          A1 arithmetic
``xml_part``            parsing without trusting, writing with the original's declaration
``errors``              the error tree
======================  ====================================================================================
"""

from addin.xlsx.chart_titles import TitleLink
from addin.xlsx.container import Limits
from addin.xlsx.drawn_charts import Drawn, DrawnChart, DrawnSeries, drawn_charts
from addin.xlsx.errors import (
    CellRefused,
    Obstacle,
    ObstaclesFound,
    PackageError,
    SaveRefused,
    SourceChanged,
    WorkbookLocked,
    WorkbookMismatch,
    WorkbookRefused,
)
from addin.xlsx.formulas import CacheReport, refresh_formula_caches
from addin.xlsx.save import SaveReport
from addin.xlsx.table_writing import TableData
from addin.xlsx.tables import Table
from addin.xlsx.values import ErrorValue, Formula
from addin.xlsx.workbook import Workbook, open_workbook
from addin.xlsx.workbook_part import DefinedName

__all__ = [
    "CacheReport",
    "CellRefused",
    "DefinedName",
    "Drawn",
    "DrawnChart",
    "DrawnSeries",
    "ErrorValue",
    "Formula",
    "Limits",
    "Obstacle",
    "ObstaclesFound",
    "PackageError",
    "SaveRefused",
    "SaveReport",
    "SourceChanged",
    "Table",
    "TableData",
    "TitleLink",
    "Workbook",
    "WorkbookLocked",
    "WorkbookMismatch",
    "WorkbookRefused",
    "drawn_charts",
    "open_workbook",
    "refresh_formula_caches",
]
