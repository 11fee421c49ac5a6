"""Work in other processes.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`processes`     processes of our own on this machine, each with a line to it; none outlives the
                program
`pool`          processes of this machine that do tasks: progress, time limit, cancel; one that
                dies is replaced
`stop`          ctrl-C and the system's request to end, what led to an exception, and how many
                cores there are
`cluster`       the work of a batch on an existing Dask cluster
`parallel_map`  units of work in order, with progress, ended by Ctrl-C: what a study asks for
`opened_map`    the same over processes or a cluster, closed at the end
==============  ==================================================================================
"""
