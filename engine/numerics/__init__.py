"""Numerical tools that know nothing of shafts: singular values, curves, statistics.

===================  =============================================================================
module               responsibility
===================  =============================================================================
`distinct`           each number once
`same_bits`          functions, products and factorisations that round alike on every machine
`sample_statistics`  what a sample says of an answer: percentiles, shares and drivers, each with
                     its sampling error
`singular_values`    singular values of the scaled incidence matrix, each to its own rounding
`torque_curve`       a torque against speed, as a smooth curve through the points typed
===================  =============================================================================
"""
