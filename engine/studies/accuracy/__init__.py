"""What accuracy costs in time, for one case. All values in SI.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`answers`       answers of a start, and how two of them differ
`alternatives`  what every other approximation of a start is worth and costs: effects, modes and
                pieces of shafts
`accuracy`      what accuracy costs in time, for one case: error of the answers against processor
                time
==============  ==================================================================================
"""
