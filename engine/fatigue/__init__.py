"""From a stress history to allowable starts. Stress in Pa, zero-to-peak unless named otherwise.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`allowable_starts`  stress history → cycles → damage → permitted starts
==================  ==============================================================================
"""
