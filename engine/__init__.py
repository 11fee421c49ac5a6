"""Torsional start-up analysis of synchronous-motor trains: physics and numerics, no spreadsheet.

Everything is in SI and radians. See docs/nomenclature.md for names, signs and referred speeds, and
docs/method.md for how each number is calculated. Data goes one way, from the top down:

==============  ====================================================================================
module          responsibility
==============  ====================================================================================
`arrays`        types of the arrays of numbers
`errors`        the error tree
`stepping`      one-degree-of-freedom steps and the compiled time loops; nothing of shafts
`numerics`      singular values, monotone curves, statistics of samples; nothing of shafts
`case`          what the engineer states, its checks, and the effects a start may call for
`motor`         a motor from its data sheet: circuit, torques against slip, electrical damping
`model`         the train as arrays, its modes, and what drives, brakes and shakes it
`fatigue`       from a stress history to cycles, damage and allowable starts
`operation`     continuous operation: separation margins, forbidden bands, harmonic response
`start`         the linear start: simulation, peaks, outcome, crossings, reversals, pull-in
`backlash`      starts with clearances, lateral motion of gears, field application and trip
`plan`          which effects a case calls for, each with the number that decided it
`results`       the frozen results of a run, verdicts, warnings, rows of the result tables
`run`           the conductor: a case in, results out
`studies`       many runs: tuning, tolerances, sensitivities, starts, calibration, accuracy
==============  ====================================================================================
"""
