"""Whether the results in a file follow from the inputs in it.

Everything is calculated again from the inputs, with the settings that the file says it was
calculated with, and laid out as recalculation would lay it out; then each result that stands there
is compared with what would be written. Numbers are compared in the units shown.

==============  ==============================================================================
module          responsibility
==============  ==============================================================================
``findings``    what is found, result by result, and what is said of a whole file
``compare``     one value against another: equal to the bit, in the digits shown, within the error
``allowances``  the error that this version reports for each result
``tables``      the rows of one table against those that would be written
``recorded``    what a file says of its own making: digest, software, settings
``again``       the calculation made again
``workbook``    a workbook
``shape``       whether its tables are tables still, under their headers
``formulas``    its live formulas: typed over, or showing an old value
``charts``      the numbers behind its charts
``drawings``    which cells its charts draw, and the copies of their values
``key_units``   units beside key numbers
``json_file``   a result JSON beside its case
``trace``       what a result is, by which equation, from which inputs
``told``        all of it in words and as JSON
``commands``    ``torsionbook verify``
==============  ==============================================================================
"""
