"""Torsional start-up analysis of synchronous-motor trains: physics and numerics, no spreadsheet.

Everything is in SI and radians. See docs/nomenclature.md for names, signs and referred speeds, and
docs/method.md for how each number is calculated. Data goes one way, from the top down:

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`errors`            the error tree
`case`              what the engineer states, frozen
`validation`        every check of a case, all problems at once
`plausibility`      possible numbers that look like a slip
`unanswered`        what a case cannot answer yet, and which input is missing
`train`             shaft line, gears and branches as masses, stiffnesses and incidence
`modal`             natural frequencies, mode shapes, energies, modal damping
`torque_curve`      a smooth curve through torque-speed points
`motor`, `load`     torque of the motor and of the driven machines against speed
`excitation`        what shakes the train in continuous operation, and the transmitted torque
`margins`           separation margins and the interference diagram
`steady_state`      harmonic response at running speed
`stepping`          time steppers and compiled loops; they know nothing of shafts
`outputs`           element torques as linear functions of modal motion
`time_response`     any train under prescribed torques
`rigid_runup`       the start of the train as one rigid body
`startup`           the start: steps, error estimate, peaks, outcome
`prescribed`        a case with prescribed torques only
`crossings`         where 2 × slip crosses each mode, and why it matters
`fatigue`           torque history, cycles, damage, allowable starts
`verdicts`          the checks at a glance
`results`           the frozen results of one run
`report`            results as the tables of the contract
`run`               the conductor: a case in, results out
==================  ==============================================================================
"""
