"""The checks of a case, one file for each input sheet; every problem at once. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`find_problems`  every check a case must pass, all of them at once
===============  =================================================================================
"""
