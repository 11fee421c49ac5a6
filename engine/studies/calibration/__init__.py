"""Which stiffnesses and inertias explain measured frequencies. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`least_squares`  the least change of uncertain quantities that explains what was measured
`optima`         all of them, and samples of the posterior
`inputs`         what a calibration is asked: uncertain quantities and measurements, checked and
                 planned
`records`        what a calibration says of parameters, frequencies and measurements
`calibration`    calibration: the least change of the uncertain quantities that explains what was
                 measured
`tables`         rows of the tables of a calibration
===============  =================================================================================
"""
