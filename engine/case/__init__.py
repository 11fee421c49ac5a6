"""What the engineer states: rows, their checks and the checked case. All values in SI.

=================  ===============================================================================
module             responsibility
=================  ===============================================================================
`time_constants`  measured time constants of a motor, short-circuited from open
`choices`          words that inputs are chosen from
`gear_ratios`      speed ratios of the stations: typed, or carried through shafts and gears
`steels`           six steels, with the source of their strengths
`data`             what the engineer states: train, motor, loads, start, material, wanted accuracy
`fatigue_tables`   published numbers of fatigue factors, with their sources and the ranges they hold
                   in
`notches`          geometry of the notch of a judged shaft: typed in table FatigueFactors, or taken
                   from the sections
`conditions`       the scalars of a case that a row of StartConditions changes
`coverage`         which elements a check can judge: those that the train calls for, and those
                   without a limit for it
`defaults`         what a blank cell stands for, and how small a number still counts
`effect`           one effect that a start may call for, and which of them a start simulates
`effects`          the effects a start may call for: one file an effect, found by being in this
                   folder
`checks`           the checks of a case, one file for each input sheet; every problem at once. All
                   values in SI
`case`             the checked case: what every calculation begins from
`missing_inputs`   what a case cannot answer yet, and which input is missing for it
`usual_range`      ranges in which a quantity usually lies, and what is said of one outside
`plausibility`     numbers that look like a slip: a unit, a percent sign, a forgotten row
`practice_limits`  what the literature says of torque reversal, with its sources
`result_words`     words that stand in results, beside numbers or in their place
`study_inputs`     inputs of the studies: couplings, scatter, measurements
=================  ===============================================================================
"""
