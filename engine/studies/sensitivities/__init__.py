"""How the answers change with each input. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`linear_start`   derivatives of a linear start by its tangent: the same motion, and its change
                 with each parameter
`plan`           what is changed to learn the sensitivities: one unit of work for each input
`differences`    sensitivities by differences: the answers of trains changed up and down by a
                 little
`tangent`        sensitivities of the linear start by its tangent: all inputs in one run
`sensitivities`  how frequencies, peak torques and allowable starts follow each quantity of a case
`tables`         rows of the tables of a sensitivity study
===============  =================================================================================
"""
