"""The calc sheet as a document: one model, built once from the results, and two thin writers.

=================  ===========================================================================
module             responsibility
=================  ===========================================================================
``document``       the frozen model: sections, paragraphs, facts, tables, figures, equations
``formula``        typeset formulas as plain data that either writer sets
``equations``      the equations of the calculation and where they come from
``numbers``        numbers and units as a reader sees them
``shown``          units of one document, inputs as they were typed
``tables``         input and result tables, narrow enough for a page
``figures``        pictures of the chart data of the workbook
``opening``        cover, summary, scope
``changes``        what changed since an earlier revision, and what it did
``inputs``         the input sections
``modes``          natural frequencies, damping, energies, shapes
``operation``      margins, steady state
``starting``       start, reversals, fatigue
``studies``        studies that stand in the workbook
``closing``        effects, accuracy, equations, checks, audit
``build``          all of it in order, numbered
``pdf``            the PDF, set by typst with ``report.typ``
``word``           the .docx, by python-docx
``make``           read, calculate, build, write
``commands``       ``torsionbook report``
=================  ===========================================================================

Numbers are in the units of the workbook (of a case JSON in those it is typed in, else SI). Text that
a user typed is data for both writers, never markup.
"""
