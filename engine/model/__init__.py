"""The train as arrays, its modes, and what drives, brakes and shakes it. All values in SI.

=======================  =========================================================================
module                   responsibility
=======================  =========================================================================
`gears`                  gear teeth as lines: where a flank's force acts, and along which
                         direction
`train`                  the shaft line as arrays: masses, stiffnesses and the incidence matrix
`excitation`             what shakes the train in continuous operation: orders and frequencies,
                         and the torque they bring
`load`                   torque of the driven machines against their own speed
`modes`                  natural frequencies, mode shapes, energy shares, nodes and modal damping
`frequency_derivatives`  how natural frequencies follow stiffnesses and inertias, from the
                         energies of the modes
`motor`                  torque of a synchronous motor while it starts: average and pulsating part
                         against speed
`rigid_runup`            the start of the train as one rigid body: where it settles, and how long
                         it takes
=======================  =========================================================================
"""
