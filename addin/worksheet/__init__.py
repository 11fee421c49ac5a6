"""Worksheet functions: written once here, carried to Excel, Calc and HTTP by thin fronts.

===========  =====================================================================================
module       responsibility
===========  =====================================================================================
`registry`   what a function is, its arguments, how cells become values and values cells
`blocks`     ranges of a sheet (units, headers, rows) → a case
`models`     handles of cases, their results calculated once and kept within bounds
`answers`    what the functions share: common arguments, results of a model, tables as cells in
             shown units
`functions`  the worksheet functions, a module a subject; each module is found here and enters its
             functions
===========  =====================================================================================

Plain values go in and come out: a front hands over what its cells hold, row by row, and shows the
rows it gets back. Nothing here knows a spreadsheet program.
"""

from addin.worksheet import functions  # noqa: F401  (enters every function into the registry)
