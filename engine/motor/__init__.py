"""A motor from its data sheet: its two-axis circuit, and the torques that follow while it slips.

Inside this room quantities are per unit of the machine: apparent power S, rated voltage, and the torque
S/ω_s at its mechanical synchronous speed ω_s; time is in seconds. Motor sign: torque that drives is positive.
`from_case` turns rows of a case into SI torques.

============  =====================================================================================
module        responsibility
============  =====================================================================================
`circuit`     reactances and time constants of a data sheet → resistances and leakages of the windings
`two_axis`    the equations of the fluxes in time, and states in which they stay
`one_way`     torque of a field circuit whose resistance changes with the sign of its current
`curves`      average and pulsating torques, their phases, current and power factor against slip
`supply`      the line, an autotransformer or a reactor before the stator, as part of the motor
`fault_torques`  torques of faults with constant flux linkages
`damping`     torque that a small oscillation of the speed brings
`from_case`   rows of `MotorData` and `MotorCircuit` → circuits and curves in SI
============  =====================================================================================
"""
