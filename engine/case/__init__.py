"""What the engineer states: rows, their checks and the checked case. All values in SI.

================  ================================================================================
module            responsibility
================  ================================================================================
`study_inputs`    what the engineer wants tried: couplings, scatter, kinds of starts, measurements
`data`            what the engineer states: train, motor, loads, start, material, wanted accuracy
`effect`          one effect that a start may call for, and which of them a start simulates
`effects`         the effects, one file each
`checks`          the checks of a case, one file for each input sheet; every problem at once. All
                  values in SI
`missing_inputs`  what a case cannot answer yet, and which input is missing for it
`plausibility`    numbers that are possible but look like a slip: a unit, a percent sign, a
                  forgotten row
================  ================================================================================
"""
