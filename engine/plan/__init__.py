"""Which effects a case calls for, and the numbers that decide it. All values in SI.

=================  ===============================================================================
module             responsibility
=================  ===============================================================================
`contact_damping`  what the limit on contact damping does where teeth do not part
`evidence`         cheap evidence for the plan: modes with and without bearings, damping, run-up,
                   a linear start
`decision`         what the evidence says of one effect, and what is decided after the user's choice
`effects`          what the evidence says, one file an effect
`plan`             the plan: which effects a case calls for, each with the number that decided it
=================  ===============================================================================
"""
