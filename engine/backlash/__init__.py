"""Starts in which gear teeth separate, and other events. All values in SI.

The force law of a clearance is in `engine.stepping.contact_loop`.

====================  ============================================================================
module                responsibility
====================  ============================================================================
`current_zeros`       a fault that clears phase by phase, each at a zero of its current
`machines`            motors whose torque follows from their fluxes, in the arrays of the loop with events
`contact_systems`     A train with clearances as pieces: linear systems that share one basis
`event_simulation`    one event-driven simulation: from the arrays of a start to sampled histories
                      and a log of events
`contacts`            teeth and bearings in a run with clearances: impacts, speeds,
                      forces
`event_start`         starts with clearances, lateral motion of gears, field application and
                      trip: the event runs
`motor_events`        faults and switching of a motor in operation, by the two-axis machine in time
`motor_scan`          the worst phase, angle and clearing time of an event of a motor, and of the start it begins in
`operating_events`    events in operation: a fault, or any torque that comes upon a train that runs at
                      synchronous speed
====================  ============================================================================
"""
