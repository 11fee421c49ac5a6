"""Worksheet functions: written once here, carried to Excel, Calc and HTTP by thin fronts.

| module | responsibility |
|---|---|
| `registry` | what a function is, its arguments, how cells become values and values cells |
| `blocks` | ranges of a sheet (units, headers, rows) → a case |
| `models` | handles of cases, their results calculated once and kept within bounds |
| `functions` | the functions themselves |
| `reference` | their page in the documentation |

Plain values go in and come out: a front hands over what its cells hold, row by row, and shows the
rows it gets back. Nothing here knows a spreadsheet program.
"""
