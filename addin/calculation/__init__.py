"""One case through `engine.run`; key figures and the audit trail.

=============  ===================================================================================
module         responsibility
=============  ===================================================================================
`stages`       words on what is being done that several rooms need
`audit`        the audit trail: which inputs, which program, which method, how accurate, by which
               equations
`key_figures`  the few numbers of a calculation that a summary over many cases shows
`run_view`     what the workbook shows of a run, gathered once from the engine's results
`calculation`  A checked case → everything the sheets, the JSON and the summary show of it
=============  ===================================================================================
"""
