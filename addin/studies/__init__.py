"""Studies: many runs of one case, to answer where the modes should lie.

Each study has a module of its own beside these, which joins its part of the engine to its tables and
its command. Everything is in SI here; sheets have the units that stand above their columns.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`study`          what a study is: its check, its calculation, options and what it shows
`accuracy`       what accuracy costs in time: error against processor time
`calibration`    measured frequencies and peak torques: its starts and its rows
`raw_samples`    raw samples as a file, CSV or Parquet
`registry`       every study, found in this folder, and what is wrong with the rows of all of them
`check_input`    an input checked without calculating
`run_study`      one input through a study: read, check, calculate, write
`sensitivities`  what a small change of each input does
`starts`         start matrix and damage ledger: its units of work and its rows
`tolerances`     what the scatter of the inputs makes of the answers
`tuning_tables`  its maps, and the numbers behind its charts
`tuning`         couplings in every combination: its units of work and its rows
===============  =================================================================================
"""
