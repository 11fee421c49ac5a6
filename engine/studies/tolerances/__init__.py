"""What the answers become when inputs scatter. All values in SI.

=============  ====================================================================================
module         responsibility
=============  ====================================================================================
`sample`       the sample of a tolerance study: what is drawn, how each train of it is calculated,
               the work in pieces
`tolerances`   tolerances: what the scatter of its data makes of a train's frequencies, margins and
               starts
`raw_samples`  the samples one by one: what was drawn, what came of it, one of them again
`tables`       the tolerance study as the result tables of its sheets: rows of plain values under
               their JSON keys
=============  ====================================================================================
"""
