"""The one description of inputs and outputs: fields, units, tables, sheets and texts. Data, and look-ups in it.

================  ================================================================================
module            responsibility
================  ================================================================================
`audit_items`     items of table `Audit` that are read again from a workbook or a result JSON
`banner`          the banner: the overall verdict in words, with its counts, as a formula and as
                  a function
`chart_tables`    tables of sheet `ChartData` and the words of charts that only a calculation
                  knows
`charts`          charts as data: what is drawn, from which columns, with which axes and words
`digests`         digests as people see them: the first digits, which tell inputs apart
`fixed_date`      the date that takes the place of the present
`json_formats`    numbers of the forms of JSON: raised when a reader of the form before would go
                  wrong
`json_shapes`     shapes of JSON objects, as fragments of a JSON Schema
`live_formulas`   formulas of columns that a reviewer can click on: the spreadsheet program
                  repeats the result
`number_formats`  number formats of results on sheets, each by what it shows
`field`           what a table of inputs or results is made of: columns with kind, dimension,
                  source and what every room needs of them
`input_tables`    input tables of a case: names, keys, units, choices, sheets and help texts
`palette`         colours of the workbook, the report and the page
`records`         records found in their folder: a new file is a new record, and no list is edited
`run_facts`       facts of the run that stand in the workbook beside the tables: what live
                  formulas need
`scalars`         scalars of sheet `Case`: names, keys, units, choices and help texts
`sheet`           what a sheet of a workbook is made of: banner, widths, tables and charts by
                  their places
`shipped`         where the shipped workbooks are: `templates/` in a checkout, inside the package
                  in a wheel
`sources`         where results come from: papers and standards cited, equations and inputs that
                  many columns share
`result_tables`   result tables of a calculation: each column with its unit, its source, and how
                  workbook, verify, diff and report treat it
`study_spec`      what a study is in workbook and JSON: tables, sheets, and the lines that say
                  what it found
`studies`         one study a file: input tables, result tables, sheets, charts and lines of
                  words; found by the registry
`tables`          every table of inputs and outputs, and look-ups by name
`problems`        problems with the place where an engineer finds them, and the nearest of known
                  words
`texts`           words on the shipped workbooks: captions, one sentence a sheet, and the sheet
                  `Notes`
`sheets`          what stands where on the shipped workbooks, as data: sheets, title block, key
                  numbers
`print_areas`     what of a sheet is printed: the parts of it that have something to show, each
                  on pages of its own
`trace_table`     the rows of sheet `Trace`: what each result is, by which equation, from what
`units`           shown unit ↔ SI: the only home of rpm, psi, lbf*in, degrees, percent and per
                  unit
`input_copy`      the copy of the inputs that a calculation leaves, and the formulas that compare
                  the present inputs with it
`shown_units`     units shown above the columns → what one shown unit is worth in SI
`shown_cell`      what a cell shows of one result: numbers in the shown unit, words, or a blank
`version`         the version of torsionbook, as installed
================  ================================================================================
"""
