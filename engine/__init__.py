"""Torsional start-up analysis of synchronous-motor trains: physics and numerics, no spreadsheet.

Everything is in SI and radians. See docs/nomenclature.md for names, signs and referred speeds.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`case`              what the engineer states, frozen
`validation`        every check of a case, all problems at once
`train`             shaft line, gears and branches as masses, stiffnesses and incidence
`modal`             natural frequencies, mode shapes, energies, modal damping
`motor`, `load`     torque of the motor and of the driven machines against speed
`excitation`        what shakes the train in continuous operation
`margins`           separation margins and the interference diagram
`steady_state`      harmonic response at running speed
`stepping`          time steppers; they know nothing of shafts
`time_response`     any train under prescribed torques
`startup`           the start: average and pulsating torque, loads, outcome, peaks, crossings
`fatigue`           torque history, cycles, damage, allowable starts
`results`           the frozen results of one run
`report`            results as the tables of the contract
`run`               the conductor
`errors`            the error tree
==================  ==============================================================================
"""
