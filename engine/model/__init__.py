"""The train as arrays, its modes, and what drives, brakes and shakes it. All values in SI.

=======================  =========================================================================
module                   responsibility
=======================  =========================================================================
`gears`                  gear teeth as lines: where a flank's force acts, and along which
                         direction
`sections`               stepped shafts from their sections: steps, hubs and keyways
`links`                  what an element row means mechanically: stiffness, damping and inertia,
                         from numbers or geometry
`train`                  the shaft line as arrays: masses, stiffnesses and the incidence matrix
`assembly`               rows and nodes while a train is put together
`excitation`             what shakes the train in continuous operation: orders and frequencies,
                         and the torque they bring
`gear_bodies`            gears that move laterally on their bearings, and the flanks on which
                         elements touch
`load`                   torque of the driven machines against their own speed
`soft_start`             voltage that rises in time, and what it is against speed in the run-up of
                         the rigid train
`motor`                  torque of a synchronous motor while it starts: average and pulsating part
                         against speed
`rigid_runup`            the start of the train as one rigid body: where it settles, and how long
                         it takes
`topology`               how the stations are joined: rigid groups, driven sides, senses of
                         rotation
`build_train`            from a case to the arrays of its train
`modes`                  natural frequencies, mode shapes, energy shares, nodes and modal damping
`subdivision`            shafts with inertia of their own: in how many pieces they are calculated,
                         and how good that is
`frequency_derivatives`  how natural frequencies follow stiffnesses and inertias, from the
                         energies of the modes
`modal_train`            a train with its modes and their damping: what every response is
                         calculated with
`modal_analysis`         natural modes of a case, with gears held or moving on their bearings
=======================  =========================================================================
"""
