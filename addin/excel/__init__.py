"""Desktop Excel on Windows: the worksheet functions through xlwings, without a licence.

A workbook gets VBA wrappers that hand the cells to Python over COM. Everything but ``udfs`` works on
any machine, also where there is neither Excel nor Windows. Numbers are in shown units, as in
`addin.worksheet`.

================  ================================================================================
module            responsibility
================  ================================================================================
`errors`          what can go wrong here
`compound_file`   the container of a VBA project (MS-CFB)
`ovba`            compression of VBA sources (MS-OVBA)
`refill`          the macro `Recalculate`: open workbook → results in its result cells
`signatures`      registry → functions with the names VBA and Python allow
`udfs`            what Excel calls; the only module that imports xlwings
`vba_project`     a VBA project: modules read, added, replaced
`vba`             text of the VBA modules, and the VBA project that the xlwings wheel brings
`workbook`        functions into a workbook: `install` and `upgrade`
`doctor`          what is amiss on this machine and in this workbook
`xlwings_server`  the worksheet functions for xlwings Server, for those who hold its licence
================  ================================================================================
"""
