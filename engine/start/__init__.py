"""The linear start from rest to operating speed, and what is read from it. All values in SI.

================  ================================================================================
module            responsibility
================  ================================================================================
`trajectory`      sampled histories of a start, their turning points, and how they are kept in
                  bounded memory
`settings`        how a start is to be calculated: what the case asks for, blanks filled
`peaks`           extremes of the torque of each element, and how sure they are
`event_results`   what a start with events found: teeth that met again, forces of bearings, pull-
                  in, repeatability
`pull_in`         pull-in of a synchronous motor, read from a simulated run: did it come into
                  step, and how
`torque_outputs`  element torques as linear functions of modal coordinates and applied torques
`time_response`   any train under prescribed torques, untwisted at the beginning
`decaying_harmonics`  any train under torques A e^(−t/τ) cos(m ω t + φ), untwisted at the beginning: exact, whatever the step
`electrical_damping`  what the motor damps of each mode, or drives, where the start crosses it and in operation
`closing`         what the closing of the breaker adds to a start from curves, from the motor's data
`machine_motion`  a train with one motor in time: modes and fluxes of the motor advance together
`start_model`     a start in arrays: as few modes as the tolerance allows, forces, dampers and
                  curves
`outcome`         how a start ended: the word, and the sentence with its numbers
`simulation`      simulations of starts, each at one step, side by side in the lanes of one loop; and
                  what is read out of them
`by_turns`        calculations that wait for each other, so that the starts they simulate run side by side
`start`           the start: average and pulsating torque against the loads, from rest to the end
                  speed
`lowest_torque`   the lowest torque of each element, by how much it may be lower, and what may be
                  said of its sign
`amplification`   how far a mode was built up where 2 × slip crossed it, against what the pulsation
                  does statically
`crossings`       where the falling 2 × slip line crosses each mode during the start, and what
                  happens there
`prescribed`      the train under prescribed torques alone: those of table `TorqueTime`, or of an
                  event in operation
`reversals`       torque reversals: meshes and geared couplings whose torque falls below zero
                  during a start
`start_fatigue`   from a start to allowable starts: fatigue of the judged shafts, and how sure it
                  is
`worst_phase`     the worst of starts that differ in the phase of the pulsation alone
`pieces`          what the pieces of distributed shafts do to the torques of a start, and how many
                  it needs
================  ================================================================================
"""
