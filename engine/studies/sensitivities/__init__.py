"""How the answers change with each input. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`linear_start`   derivatives of a linear start by its tangent: the same motion, and its change
                 with each parameter
`sensitivities`  how frequencies, peak torques and allowable starts follow each quantity of a case
===============  =================================================================================
"""
