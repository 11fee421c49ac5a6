"""The linear start from rest to operating speed, and what is read from it. All values in SI.

================  ================================================================================
module            responsibility
================  ================================================================================
`event_results`   what a start with events found: impacts, forces of bearings, pull-in,
                  repeatability
`pull_in`         pull-in of a synchronous motor, read from a simulated run: did it come into
                  step, and how
`torque_outputs`  element torques as linear functions of modal coordinates and applied torques
`time_response`   any train under prescribed torques, from any initial twist and speed
`trajectory`      sampled histories of a start, their turning points, and how they are kept in
                  bounded memory
`start`           the start: average and pulsating torque against the loads, from rest to the end
                  speed
`crossings`       where the falling 2 × slip line crosses each mode during the start, and what
                  happens there
`prescribed`      A case without a motor: the train under the torques of table `TorqueTime` alone
`reversals`       torque reversals: meshes and geared couplings whose torque falls below zero
                  during a start
`start_fatigue`   from a start to allowable starts: fatigue of the judged shafts, and how sure it
                  is
`warm_up`         loads the compiled routines of a start, so that what is timed afterwards is
                  calculation alone
================  ================================================================================
"""
