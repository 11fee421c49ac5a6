"""Time steppers for q̈ + d q̇ + λ q = u(t), mode by mode; they know nothing of shafts.

===================  =============================================================================
module               responsibility
===================  =============================================================================
`exponential`        coefficients of the step that is exact for a cubic force
`newmark`            coefficients of the average-acceleration step, the paper's eqs (1) to (4)
`compiling`          where compiled loops are kept, and whether they are there
`linear_loop`        the compiled loops: a start, a prescribed force, turning points
`contact_loop`       the compiled loop of starts with clearances and events
===================  =============================================================================

All quantities in modal coordinates, SI.
"""
