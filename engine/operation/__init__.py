"""Continuous operation: separation margins, forbidden bands, harmonic response. All values in SI.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`margins`       separation margins and the interference diagram
`bands`         where a mode may not lie: the band of frequencies round every continuous
                excitation
`steady_state`  harmonic response of the train, and the vibratory torques and stresses of running
                it
==============  ==================================================================================
"""
