"""The worksheet functions, a module a subject; each module is found here and enters its functions.

A function is one decorated function of any module here, and needs no other entry.

=============  ===================================================================================
module         responsibility
=============  ===================================================================================
`calibration`  stiffnesses that explain measured frequencies
`effects`      what was simulated and why, and the verdicts
`fatigue`      fatigue: damaging cycles, allowable starts, life of an S-N line, and what a duty
               uses up
`model`        the model: tables of a sheet → a checked case and its handle
`modes`        natural frequencies, mode shapes and energies
`motors`       motors from their data sheets: the circuit, and torques and current against slip
`running`      continuous operation: separation margins, forbidden bands, steady state
`shafts`       stiffness of a shaft from its sizes
`starting`     the start: speed, peaks, histories and torque reversals
`studies`      the studies as worksheet functions: few combinations, few samples, and an end to
               their time
`units`        conversion between units
=============  ===================================================================================
"""

import importlib
import pkgutil
import sys

from addin.worksheet.registry import FUNCTIONS

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

# In the order of the documentation: by the `ORDER` of their modules, last where one states none.
_ordered = sorted(
    FUNCTIONS.items(),
    key=lambda item: getattr(sys.modules[item[1].answer.__module__], "ORDER", 999),
)
FUNCTIONS.clear()
FUNCTIONS.update(_ordered)
