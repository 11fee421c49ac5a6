"""Builds the shipped workbooks.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`examples`          the filled examples: the sample case of Szenasi and von Nimitz (1978), US
                    customary units
`filled`            the inputs of a case as they are typed, to be filled into a new workbook
`study_examples`    filled study sheets for the sample case of the paper: what an engineer would
                    ask of it
`styles`            how the shipped workbooks look: one palette, one table of cell formats, number
                    formats by dimension
`chart_parts`       what every chart is made of: places of tables, axes, titles, lines
`charts`            which series goes on which chart, and how it is drawn
`starts_charts`     charts of start matrix and calibration; they refer to the columns of the
                    result tables there
`tolerance_charts`  charts of the tolerances; part of `addin.template.study_charts`
`tuning_charts`     charts of a tuning study: starts, margins and modes over the first variable
`study_charts`      charts on the study sheets; they refer to the columns of the result tables
                    there
`variants`          the flavours of the shipped workbooks: how each front's program spells a
                    worksheet function
`live_sheet`        sheet `Live`: frequencies, margins and shaft stiffness by worksheet functions,
                    as is typed
`build`             builds the shipped workbooks from the one table of fields: ``python -m
                    addin.template.build FOLDER``
==================  ==============================================================================
"""
