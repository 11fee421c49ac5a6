"""Does the torque reverse so far that teeth separate?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding, percent, quoted
from engine.plan.evidence import BACKLASH_GAIN, Evidence, moves_laterally, reversing


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The lowest torque of an element with two flanks, less its error."""
    possible = bool(e.clearances)
    if e.linear is None:
        why = "Depends on the lowest torques of the linear start."
        return Finding(False, possible, None, 0.0, None, why)
    minima = e.linear.minima
    if not minima:
        return Finding.impossible("No gear mesh and no geared coupling.")
    worst, limit = min(minima, key=lambda m: m.lowest), -e.tolerance / BACKLASH_GAIN
    bound: float | None
    # without any gap the linear train is the answer
    depth = max((-m.lowest for m in minima if not m.tight), default=0.0)
    number, bound = worst.lowest, BACKLASH_GAIN * max(depth, 0.0)
    why = f"Lowest torque minus its error: {number:.3g} of the largest torque, at '{worst.element}'"
    names = reversing(e) or modelled
    if names:
        why += f"; teeth separate at {quoted(names)}."
        return Finding(True, possible, number, limit, None, why)
    limited = e.linear.damping_limit
    if possible and limited > e.tolerance:
        why += (
            f"; but near zero torque the limit on contact damping may change a torque by {percent(limited)}, "
            f"more than the {percent(e.tolerance)} allowed."
        )
        return Finding(True, possible, number, limit, None, why)
    if bound is not None:
        bound += limited
    if possible and moves_laterally(case, e):
        why += (
            "; teeth need not separate, but gears move on their bearings: that is simulated event by "
            "event anyway, with every clearance."
        )
        return Finding(True, possible, number, limit, None, why)
    if number >= 0.0:
        why += ": no reversal, so the linear solution holds whatever the clearance."
        if limited:
            why += f" Near zero torque the limit on contact damping changes at most {percent(limited)}."
    elif number >= limit:
        why += f", not below the limit {limit:.2g}: any separation is too short to matter."
    else:
        deep = [m for m in minima if m.lowest < limit]
        tight = [m.element for m in deep if m.tight]
        blank = [m.element for m in deep if not m.tight]
        if tight and moves_laterally(
            case, e
        ):  # the back flank pushes along a line of its own, whatever the gap
            bound = None
            why += (
                f"; the clearance given for {quoted(tight)} is 0, so the teeth cannot separate and a "
                "negative torque pulls on the drive flank; with gears on bearings the force then has "
                "the wrong direction: type a small clearance"
            )
        elif tight:
            why += f"; the clearance given for {quoted(tight)} is 0, so the linear solution applies there"
        if blank:
            bound = None
            why += (
                f"; no clearance is given for {quoted(blank)}: type Backlash (or Angular backlash) "
                "and a mesh stiffness to model it"
            )
        why += "."
    return Finding(False, possible, number, limit, bound, why)
