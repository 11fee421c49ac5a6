"""Two revisions of a train side by side: what changed in the inputs, and what it did.

Everything is compared in SI, so that the same quantity in another unit is no change, and shown in
the units of the second file.

============  ================================================================================
module        responsibility
============  ================================================================================
``changes``   one change, and all of them
``sides``     a file → its inputs and its results, as they stand or calculated again
``units``     the unit in which a quantity is shown
``inputs``    inputs matched by station, element, material: changed, added, removed, renamed
``results``   results matched the same way; verdicts first
``studies``   rows of study sheets, and what studies found where both files hold them
``compare``   the conductor
``told``      as JSON, and a number in words
``terminal``  as tables on the terminal
``book``      as a workbook
``commands``  ``torsionbook diff``
============  ================================================================================
"""
