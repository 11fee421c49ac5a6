"""The calc sheet as a document: one model, built once from the results, and two thin writers.

Numbers are in the units of the workbook (of a case JSON in those it is typed in, else SI). Text that
a user typed is data for both writers, never markup.

===========  =====================================================================================
module       responsibility
===========  =====================================================================================
`formula`    typeset formulas as plain data that either writer sets
`company`    logo and Word template of a company
`document`   the frozen model: sections, paragraphs, facts, tables, figures, equations
`plain`      names of the program in words of a reader
`equations`  the equations of the calculation and where they come from
`layout`     what fits on a page: widths of columns, and blocks that stay together
`pages`      where pages end, so that tables stay whole and no page is half empty
`numbers`    numbers and units as a reader sees them
`figures`    pictures of the chart data of the workbook
`pdf`        the PDF, set by typst with ``report.typ``
`units`      units of one document, inputs as they were typed
`tables`     input and result tables, narrow enough for a page
`subject`    what a report is about: one calculation, the inputs as typed, its units and pictures
`cases`      verdicts under other conditions, and which governs
`changes`    what changed since an earlier revision, and what it did
`inputs`     the input sections
`modes`      natural frequencies, damping, energies, shapes
`actions`    conclusions that name an action: from verdicts, changed couplings, studies
`opening`    cover, summary, scope
`closing`    effects, accuracy, equations, checks, audit
`operation`  margins, steady state
`starting`   start, reversals, fatigue
`studies`    studies recorded in the workbook
`build`      all of it in order, numbered
`word`       the .docx, by python-docx
`make`       one input in, its report out: read, calculate, build, write
===========  =====================================================================================
"""
