"""Studies: many runs of one case with changed inputs. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`accuracy`       what accuracy costs in time, for one case: error of the answers against wall time
`nearby_start`   trains near to one that was planned: many of them, each as cheap as its answers
                 allow
`variation`      the same train with one quantity changed: what tuning, scatter and calibration
                 have in common
`scatter`        how sure a quantity is: table `Scatter` as independent factors, and samples of
                 them
`calibration`    which stiffnesses and inertias explain measured frequencies. All values in SI
`sensitivities`  how the answers change with each input. All values in SI
`starts`         starts under every combination of conditions, and the damage they add up to. All
                 values in SI
`tolerances`     what the answers become when inputs scatter. All values in SI
`tuning`         which couplings and stiffnesses put the modes where they should be. All values in
                 SI
===============  =================================================================================
"""
