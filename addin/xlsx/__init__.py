"""Edits an .xlsx file part by part and leaves everything else byte for byte as it is.

A workbook is a zip file of XML parts. Only the parts that hold written cells are rewritten, all others are copied as they
are stored; values that formulas and charts carry of changed cells are renewed or removed; the file is replaced in one
step. This room knows nothing of torsional vibration; numbers are written as they are given.

=================  ===============================================================================
module             responsibility
=================  ===============================================================================
`errors`           the error tree
`places`           where a path leads, links followed; names that no file can have; a file put
                   into its place
`references`       A1 arithmetic
`locks`            lock files of spreadsheet programs
`temporary`        files and folders that are gone when their process ends, however it ends
`whole_files`      files written whole or not at all
`new_book`         a new workbook, made with XlsxWriter
`xml_part`         parsing without trust, writing with the original's declaration
`strict`           workbooks in the strict dialect of the file format, told in the ordinary one
`chart_titles`     titles of charts that lost their cell
`container`        the zip file: guards before opening, raw copy of untouched parts
`sheet_ranges`     ranges stated beside the cells: formats, validations and sparklines that follow
                   a table
`sheet_row`        one row of a sheet with its cells as elements
`values`           what a cell may hold, and its XML
`text_row`         one row of a sheet that holds nothing but values and plain formulas and stays text
`charts`           chart ranges and the values that charts carry
`formula_text`     references inside a formula
`sheet_part`       rows, cells and styles of one sheet
`tables`           Excel tables and their size
`workbook_part`    sheets, defined names, relationships, content types, calculation settings
`plain_formulas`   formulas with cells in the place of parts of tables
`dependents`       which formulas depend on changed cells
`shared_texts`     texts to which cells refer by number
`written`          what was written, to be checked before the file is put in place
`state`            an open workbook in memory: its parts, the cells changed and written so far
`calculator_copy`  the copy that the calculator of formulas is given
`kept_calculator`  a workbook that stays open in the calculator for the next one with the same formulas
`drawn_shapes`     shapes drawn as one group in the place of an object, and objects hidden or shown
`drawn_charts`     what charts draw and carry, for reading
`number_text`      what a number format shows of a value, and the number a reader takes from it
`cell_looks`       number format, font and ground of cells, conditional formats over them
`lying_over`       pictures, shapes, controls and comments over cells
`formulas`         cached values of formulas: renewed or removed, never stale
`save`             writing whole or not at all
`table_writing`    rows into tables, with all that follows them and all that may be in the way
`workbook`         `open_workbook` and `Workbook`: what the rest of the add-in uses
`added_sheets`     whole sheets of another workbook behind those of a workbook
`macros`           a VBA project and a hidden sheet of settings: .xlsx to .xlsm
=================  ===============================================================================
"""

from addin.xlsx.chart_titles import TitleLink
from addin.xlsx.drawn_charts import Drawn, DrawnChart, drawn_charts
from addin.xlsx.errors import ObstaclesFound, PackageError
from addin.xlsx.save import SaveReport
from addin.xlsx.table_writing import TableData
from addin.xlsx.tables import Table
from addin.xlsx.values import ErrorValue, Formula
from addin.xlsx.workbook import Workbook, open_workbook
from addin.xlsx.workbook_part import DefinedName
