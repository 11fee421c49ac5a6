"""One study a file: input tables, result tables, sheets, charts and lines of words; found by the registry.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`calibration`    calibration against measurements in workbook and JSON
`registry`       every study, found in this folder, and what is derived from all of them
`sensitivities`  sensitivities to each quantity in workbook and JSON
`starts`         the start matrix and its damage ledger in workbook and JSON
`tolerances`     tolerances, what the scatter of inputs does to the answers, in workbook and JSON
`tuning`         tuning, the search for a better coupling, shaft or inertia, in workbook and JSON
===============  =================================================================================
"""
