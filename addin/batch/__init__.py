"""Many workbooks, one after the other, on all cores, on a cluster, overnight.

Everything is SI but the summary, whose headers carry the units.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`own_files`      whether a file is one that torsionbook wrote: none other is replaced
`inputs`         folders, patterns and files → what is to be calculated, in natural order
`records`        what became of one file, as a journal keeps it
`journal`        records on the disk, each whole or not there, whatever ends the program
`folder`         the folder of results: one batch at a time, results put in place in one step
`summary`        the records as workbook and CSV
`vary_columns`   columns of a programme's table: which input of the base case each header names,
                 and its unit
`vary_rows`      rows of a programme: values put into the base case, calculated, and told as one
                 line of results. Runs in any process
`vary_table`     A programme's table, CSV or Parquet, read as a stream
`work`           one file → its record and its result files; runs in any process
`cluster_files`  how the files of a batch reach a cluster: by a folder that it shares with this
                 machine, or as bytes
`scheduler`      a batch from its inputs to its summary
`vary`           one case, many values: a programme from a table, streamed to Parquet or CSV
`watch`          recalculation when a file is saved
===============  =================================================================================
"""
