"""The Excel side of torsionbook: workbooks, JSON and the command line; no physics.

=============  ===================================================================================
module         responsibility
=============  ===================================================================================
`contract`     the one description of inputs and outputs: fields, units, tables, sheets and texts
`calculation`  one case through `engine.run`; key figures and the audit trail
`charts`       the numbers behind charts, for every renderer, in the units shown on the sheets
`workers`      work in other processes
`xlsx`         edits an .xlsx file part by part and leaves everything else byte for byte as it is
`reading`      workbook or case JSON to `CaseData`, with every problem and its cell
`recorded`     results as a workbook holds them, their provenance and digests
`worksheet`    the worksheet functions: written once here, carried to Excel, Calc and HTTP by thin
               fronts
`libreoffice`  the worksheet functions in LibreOffice Calc: an extension (.oxt) and the process
               behind it
`calc`         kept for installed LibreOffice extensions, which start `python -m
               addin.calc.worker`
`writing`      results into cells, JSON and history files; one file from input to output
`template`     builds the shipped workbooks from the records of `addin.contract`
`batch`        folders of inputs and programmes of cases, on all cores or a cluster
`studies`      one input through a study: check, calculate, write
`reference`    generated reference: JSON Schemas, the pages of results and of functions; written
               by ``make generated``
`verify`       whether the results in a file follow from the inputs in it
`diff`         two revisions of a train side by side: what changed in the inputs, and what it did
`report`       the calc sheet as a document: one model, built once from the results, and two thin
               writers
`server`       the calculation server: the worksheet functions and the recalculation over HTTP
`excel`        desktop Excel on Windows: the worksheet functions through xlwings, without a
               licence
`mcp`          workbooks read, calculated and explained for an assistant that speaks MCP
`exchange`     trains in the files of others: tables of text, openTorsion and ROSS
`cli`          the command line, one module a command; the only room that prints
=============  ===================================================================================

Everything shown carries its unit beside it; everything handed to `engine` is in SI.
"""
