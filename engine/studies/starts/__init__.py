"""Starts under every combination of conditions, and the damage they add up to. All values in SI.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`matrix`         starts at every voltage, hot and cold, loaded and unloaded, whole and aborted
`damage_ledger`  damage ledger: what a duty has used of each shaft's life, and what is left
===============  =================================================================================
"""
