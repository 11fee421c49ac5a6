"""What accuracy costs in time, for one case. All values in SI.

==========  ======================================================================================
module      responsibility
==========  ======================================================================================
`accuracy`  what accuracy costs in time, for one case: error of the answers against wall time
==========  ======================================================================================
"""
