"""The checks of a case, one file for each input sheet; every problem at once. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`problem`        how a problem of a cell is worded, and the checks that every table shares
`effects`        checks of the chosen effects: one that is forced on needs its data
`fatigue`        checks of materials, their S-N points, and the factors on the strength of
                 shafts
`scalars`        checks of the scalars of the case: each by itself, and those that contradict each
                 other
`motors`         checks of the data sheets and circuits of motors
`supply`         checks of table Supply: the line of a motor, and its starter
`torques`        checks of torque curves and of the excitations in continuous operation
`events`         checks of events in operation: table EventTorque, and TorqueTime where the train
                 runs before it
`motor_events`   checks of table MotorEvents: what happens to a motor in operation
`train`          checks of stations, elements and modal damping: names, stiffness, and one open
                 train
`sections`       checks of the sections that stepped shafts are made of
`gears`          checks of gear meshes: numbers, ratios, the line of action, gears on bearings
`start_conditions`  checks of table StartConditions: names, what each kind of row may state, and the
                 case it makes
`find_problems`  every check a case must pass, all of them at once
===============  =================================================================================
"""
