"""The one description of inputs and outputs: fields, units, tables, sheets and texts. Data, and look-ups in it.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`result_tables`  where each result comes from: equation, source, and the inputs it was calculated
                 from
`field`          what a field and a table of fields are made of: kinds, dimensions, JSON keys
`shipped`        where the shipped workbooks are: `templates/` in a checkout, inside the package
                 in a wheel
`texts`          words on the shipped workbooks: captions, one sentence a sheet, and the sheet
                 `Notes`
`version`        the version of torsionbook, as installed
`problems`       problems with the place where an engineer finds them, and the nearest of known
                 words
`sheets`         what stands where on the shipped workbooks, as data: sheets, title block, key
                 numbers
`studies`        the tables, sheets and captions of each study
`tables`         the one table of inputs and outputs: names, keys, units, choices, sheets and help
                 texts
`chart_rows`     what the template and the writer agree on beside the fields: live formulas,
                 facts, columns
`trace_table`    the page docs/results.md and the rows of sheet `Trace`, made from the table of
                 fields
`units`          shown unit ↔ SI: the only home of rpm, psi, lbf*in, degrees, percent and per unit
`shown_units`    units shown above the columns → what one shown unit is worth in SI
===============  =================================================================================
"""
