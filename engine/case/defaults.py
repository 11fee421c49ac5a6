"""What a blank cell stands for, and how small a number still counts."""

from __future__ import annotations

#: End of a start without field, over synchronous speed (contract).
DEFAULT_END_SPEED = 0.97
#: No peak torque is taken to be more accurate than this share of it, however well two runs agree:
#: what rounding and the reading of an extreme between two samples leave, with a margin. [1]
LEAST_PEAK_ERROR = 1e-7
#: Least `tolerance_peak` that can be met: room for that error and for the tenth of the tolerance that
#: is left to modes not simulated. Asked for less, a start takes every step it may, for nothing. [1]
LEAST_TOLERANCE_PEAK = 2.0 * LEAST_PEAK_ERROR
#: Least `tolerance_starts`: damage goes with a power of the torque (20 at the most), which has that error. [1]
LEAST_TOLERANCE_STARTS = 1e-5
#: Accuracy of peak torques where the case leaves it blank. [1]
DEFAULT_TOLERANCE_PEAK = 1e-3
#: Longest start simulated where MaximumTime is blank. [s]
LONGEST_START = 600.0
#: Accuracy of allowable starts where the case leaves it blank. [1]
DEFAULT_TOLERANCE_STARTS = 0.02
#: A torque below zero by less than this share of the largest torque is not called a reversal.
NOTABLE_REVERSAL = 1e-3
#: Starts are rounded down to whole ones; a count nearer than this to the next one is that one. [1]
WHOLE_STARTS = 1e-9
#: A worst clearing time is looked for until then where nothing is typed: backup protection trips within. [s]
DEFAULT_LATEST_CLEARING = 0.5
