"""Results into cells, JSON and history files; one file from input to output.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`history_file`  the full torque histories of a start in a file beside the workbook: Parquet or NPZ
`results_json`  results to JSON, and the errors of an input that could not be calculated
`edited_inputs`  inputs as they are typed, and the same file with some of them typed anew
`input_copy`    the copy of the inputs that a calculation leaves on a hidden sheet, with the
                formulas that compare
`printed_rows`  rows of long result tables that decide something: these are printed
`drawn_schematic`  the schematic as shapes of a drawing
`print_areas`   what a calculated workbook prints: the parts of its sheets that have something to
                show
`workbook`      results into the cells the product owns: result tables, facts for live formulas,
                chart data
`open_workbook`  what was written into a copy, as rectangles for the workbook that is open
`result_file`   the result file of a workbook, when it is there already: whether more can be
                written into it
`recalculate`   one input file in, its results out: the same path for the command line and every
                other front
==============  ==================================================================================
"""
