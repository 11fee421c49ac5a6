"""Studies: many runs of one case with changed inputs. All values in SI.

Each study is a folder, found by being here; none imports another. What they share stands in the files
of this table.

====================  ============================================================================
module                responsibility
====================  ============================================================================
`nearby_start`        trains near to one that was planned: many of them, each as cheap as its
                      answers allow
`variation`           the same train with one quantity changed: what tuning, scatter and
                      calibration have in common
`scatter`             how sure a quantity is: table `Scatter` as independent factors, and samples
                      of them
`coupling_stiffness`  which stiffness of couplings keeps every separation margin
====================  ============================================================================
"""
