"""Many workbooks, one after the other, on all cores, on a cluster, overnight.

Everything is SI but the summary, whose headers carry the units.

======================  ====================================================================================
module                  responsibility
======================  ====================================================================================
``inputs``              folders, patterns and files → what is to be calculated, in natural order
``records``             what became of one file, as a journal keeps it
``work``                one file → its record and its result files; runs in any process
``journal``             records on the disk, each whole or not there, whatever ends the program
``folder``              the folder of results: one batch at a time, results put in place in one step
``pool``                processes of this machine; one that dies loses nothing
``cluster``             the same on an existing Dask cluster
``conductor``           a batch from its inputs to its summary
``summary``             the records as workbook and CSV
``summary_file``        whether a file is such a summary
``json_file``           whether a JSON is results, or errors, that torsionbook wrote
``watch``               recalculation when a file is saved
``vary``                one case, many values: a programme from a table, streamed to Parquet
``result_file``         whether a file is the result of such a programme
``commands``            ``torsionbook batch``
======================  ====================================================================================
"""
