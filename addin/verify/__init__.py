"""Whether the results in a file follow from the inputs in it.

Everything is calculated again from the inputs, with the settings that the file says it was
calculated with, and laid out as recalculation would lay it out; then each result in the file is
compared with what would be written. Numbers are compared in the units shown.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`allowances`     the error that this version reports for each result
`findings`       what is found, result by result, and what is said of a whole file
`compare`        one value against another: equal to the bit, in the digits shown, within the
                 error
`charts`         the numbers behind its charts
`structure`      whether the tables of a workbook are tables still, under their headers
`chart_sources`  which cells its charts draw, and the copies of their values
`schematic`      its schematic of the train
`formulas`       its live formulas: typed over, or showing an old value
`input_copy`     the copy of its inputs that the banners are compared with
`key_units`      units beside key numbers
`appearance`     whether results are shown, and shown as they are
`fixed_texts`    texts of sheet Notes, the trace included
`tables`         the rows of one table against those that would be written
`json_file`      a result JSON beside its case
`trace`          what a result is, by which equation, from which inputs
`wording`        a verification in words and as JSON
`workbook`       a workbook
`file`           a file of either kind, whatever is wrong with it
===============  =================================================================================
"""
