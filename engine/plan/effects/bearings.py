"""Do the bearings of the gears change a mode enough to matter?"""

import math

from engine.case.data import CaseData
from engine.plan.decision import Finding, percent
from engine.plan.evidence import BEARING_GAIN, Evidence

#: What a reader of an empty table of bearing forces needs to know.
NO_FORCES = (
    "Table BearingForces stays empty while bearings are off in the start: choose on for "
    "bearings in EffectChoices to calculate them."
)


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The largest relative change that the bearings make to a mode."""
    if e.bearing_number is None:
        why = "No bearing data in Meshes: gears do not move laterally."
        return Finding(False, False, None, None, None, why, cost=0.0)
    number, limit = e.bearing_number, e.tolerance / BEARING_GAIN
    wanted = number > limit
    why = f"{_change_of_a_mode(number)}, {'above' if wanted else 'at most'} the limit {percent(limit)}."
    cost = max(e.n_coupled_modes / max(e.n_modes, 1) - 1.0, 0.0)
    bound = BEARING_GAIN * number
    while_off = NO_FORCES if e.start else ""
    return Finding(
        wanted, True, number, limit, bound if bound < 1.0 else None, why, cost, while_off
    )


def _change_of_a_mode(number: float) -> str:
    """What the bearings do to a mode, from the number that decided."""
    if math.isinf(number):
        return "Bearings damp an otherwise undamped mode (relative change unlimited)"
    if number == 1.0:
        return (
            "Bearings change a mode completely (100 %: it corresponds to no mode without bearings)"
        )
    return f"Bearings change the frequency, shape or damping of a mode by up to {percent(number)}"
