"""Starts under every combination of conditions, and the damage they add up to. All values in SI.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`conditions`        start conditions as they are typed in `StartConditions`: their checks, and the
                    case each makes
`condition_result`  one start of a matrix, calculated: outcome, largest torque, damage and starts
                    of each judged shaft
`case_verdicts`     the case with every condition of `StartConditions`: the checks of each, and the
                    worst over all
`plan`              which starts a matrix calculates: the conditions that are typed, or the
                    standard matrix
`matrix`            starts at every voltage, hot and cold, loaded and unloaded, whole and aborted
`damage_ledger`     damage ledger: what a duty has used of each shaft's life, and what is left
==================  ==============================================================================
"""
