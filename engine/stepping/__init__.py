"""Time steppers for q̈ + d q̇ + λ q = u(t), mode by mode; they know nothing of shafts.

===================  =============================================================================
module               responsibility
===================  =============================================================================
`kernels`            the loops and the cycle count in C, what they take (`kernels.h`), what is built of it
`library`            loads what was built, fills its structs from arrays
`exponential`        coefficients of the step that is exact for a cubic force
`newmark`            coefficients of the average-acceleration step, the paper's eqs (1) to (4)
`linear_loop`        fixed steps of a start, a prescribed force, turning points
`contact_loop`       steps of a start with clearances and events
===================  =============================================================================

All quantities in modal coordinates, SI.
"""
