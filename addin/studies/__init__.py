"""Studies: the plain run again and again, to answer where the modes should lie.

=================== ================================================================================
module              responsibility
=================== ================================================================================
study               what a study is, and one input through it: read, check, calculate, write
spread              units of work over processes or a cluster, with progress and Ctrl-C
commands            what the commands of the studies have in common
tuning              couplings in every combination: its units of work and its rows
tuning_tables       its maps, and the numbers behind its charts
tuning_command      ``torsionbook tune``
tolerances          what the scatter of the inputs makes of the answers
sensitivities       what a small change of each input does
tolerance_commands  ``torsionbook tolerances`` and ``torsionbook sensitivities``
starts              start matrix and damage ledger: its units of work and its rows
starts_command      ``torsionbook starts``
accuracy            what accuracy costs in time: error against wall time of one case
calibration         measured frequencies and peak torques: its starts and its rows
calibration_command ``torsionbook calibrate``
=================== ================================================================================

Each study has a module of its own beside these, which joins its part of the engine to its tables and
its command. Everything is in SI here; sheets have the units that stand above their columns.
"""
