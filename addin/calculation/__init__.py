"""One case through `engine.run`; key figures and the audit trail.

==================  ==================================================================================
module              responsibility
==================  ==================================================================================
`audit`             the audit trail: which inputs, which program, which method, how accurate, by which
                    equations
`calculation`       a checked case to everything the sheets, the JSON and the summary show of it
`full_speed_words`  the train at full speed in words
`key_figures`       the few numbers of a calculation that a summary over many cases shows
==================  ==================================================================================
"""
