"""Two revisions of a train side by side: what changed in the inputs, and what it did.

Everything is compared in SI, so that the same quantity in another unit is no change, and shown in
the units of the second file.

==========  ======================================================================================
module      responsibility
==========  ======================================================================================
`files`     a file to its inputs and its results, as recorded or calculated again
`units`     the unit in which a quantity is shown
`changes`   one change, and all of them
`rows`      rows of one table side by side, matched by their names
`inputs`    inputs matched by station, element, material: changed, added, removed, renamed
`results`   results matched the same way; verdicts first
`studies`   rows of study sheets, and what studies found where both files hold them
`compare`   two files compared as a whole
`wording`   differences as JSON, and a number in words
`workbook`  differences as a workbook
==========  ======================================================================================
"""
