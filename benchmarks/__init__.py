"""Time against error, side by side with other programs in one run: `python -m benchmarks`.

=================  =============================================================================
module             responsibility
=================  =============================================================================
`problems`         the trains, torques and starts that are calculated
`references`       their right answers, calculated independently of the engine
`ours`             our calls
`peers`            openTorsion and ROSS, each in an environment of its own
`modes`            natural frequencies: time and error
`response`         a prescribed torque of 15 s: time against error
`start`            a start of 15 s: time against error, and how time grows
`hard_cases`       the corpus of tests/hard_cases: our error, and theirs or how they fail
`fronts`           one call of a worksheet function through each front (docs/fronts.md)
`backlash_speed`   a start with backlash beside the linear one, a gear pair beside ROSS
`scaling`          how time and memory grow
`whole_run`        a workbook recalculated, warm and cold, by stage
`measure`          interleaved medians, errors on a common grid, equal-error times, the machine
`study_trains`     a thousand random trains
`tolerance_study`  their true errors against stated tolerances
`goals`            what was aimed at and what was reached
`pages`            what is said about them
`study_pages`      the same of the study, backlash and growth
`report`, `plots`  tables on the terminal, docs/benchmarks.md, docs/images/bench_*.png
`mesh_picture`     docs/images/backlash_start.png; a program of its own
=================  =============================================================================

Nothing here is asserted: times are printed, never tested. SI and seconds.
"""
