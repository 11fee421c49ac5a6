"""The frozen record of a run and its tables. All values in SI.

=====================  ===========================================================================
module                 responsibility
=====================  ===========================================================================
`results`              the complete, frozen results of one run
`implausible_results`  results that no motor train has: a unit or a factor is wrong somewhere, and
                       no verdict is given
`verdicts`             the checks at a glance: margin, forced response, start, peaks, yield,
                       reversal, starts
`maker_sheet`          what the makers of couplings, gears and shafts must know
`case_matrix`          the verdicts of every typed condition as a matrix
`tables`               results as the result tables of the contract: rows of plain values under
                       their JSON keys
`details`              what no result table of a run holds: energy shares, nodes, plans, the
                       outcome in full
`times`                what each analysis of a run cost, and how accurate it was
`warnings`             warnings: what a reader must know beside the numbers of a run
=====================  ===========================================================================
"""
