"""Continuous operation: separation margins, forbidden bands, harmonic response. All values in SI.

=================  ==================================================================================
module             responsibility
=================  ==================================================================================
`standards`        what a standard asks of a train: margins, analyses, and their sources
`margins`          separation margins, the bands of frequencies they forbid, and the interference
                   diagram
`steady_state`     harmonic response of the train, and the vibratory torques and stresses of running
                   it
`forced_response`  the same with its errors: pieces of distributed shafts, range of damping
`acceptance`       margins that are not kept, and what a forced response at the resonance makes of
                   them
`full_speed`       the train at full speed in a few numbers
`plausible_train`  what only the whole train can tell of a slip: stress, twist and limits by the torque
                   transmitted
=================  ==================================================================================
"""
