"""What the engineer states: rows, their checks and the checked case. All values in SI.

================  ================================================================================
module            responsibility
================  ================================================================================
`effects`         the effects a start may call for: their names, what was chosen, what was found
`study_inputs`    what the engineer wants tried: couplings, scatter, kinds of starts, measurements
`checks`          the checks of a case, one file for each input sheet; every problem at once. All
                  values in SI
`data`            what the engineer states: train, motor, loads, start, material, wanted accuracy
`missing_inputs`  what a case cannot answer yet, and which input is missing for it
`plausibility`    numbers that are possible but look like a slip: a unit, a percent sign, a
                  forgotten row
================  ================================================================================
"""
