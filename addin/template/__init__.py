"""Builds the shipped workbooks from the records of `addin.contract`.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`cell_rules`        what a cell says of itself: prompts, drop-downs and rules of typed values
`examples`          the filled examples: the sample case of Szenasi and von Nimitz (1978), US
                    customary units
`filled`            the inputs of a case as they are typed, to be filled into a new workbook
`styles`            how the shipped workbooks look: one palette, one table of cell formats, number
                    formats by dimension
`charts`            draws the charts of `addin.contract.charts` with XlsxWriter
`variants`          the variants of the shipped workbooks: how each front's program spells a
                    worksheet function
`frames`            frame of every sheet: widths, banner, strip, print set-up; and the colours of
                    verdicts
`table_cells`       tables on the sheets: caption, units, headers, typed rows, formulas beside
                    results
`front_sheets`      sheets that engineers open first: the scalars of `Case`, the summary, the
                    element of each history chart
`result_sheets`     what result sheets show besides tables: facts, notes, colours, results of
                    studies
`reference_sheets`  sheets of words and hidden sheets: notes, trace, lists behind drop-downs,
                    chart data
`live_sheet`        sheet `Live`: frequencies, margins and shaft stiffness by worksheet functions,
                    as inputs are typed
`build`             builds the shipped workbooks from the one table of fields: ``python -m
                    addin.template.build FOLDER``
`study_sheets`      the sheets of a study, added to a workbook that has none, with rows to begin with
`rebuilt`           a workbook that openpyxl or an earlier release wrote, made whole again: its
                    inputs in a template, and other sheets
`upgraded`          a workbook of an earlier release as one of this version
==================  ==============================================================================
"""
