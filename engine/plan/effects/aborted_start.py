"""Does the train reach the speed at which the motor trips?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding
from engine.plan.evidence import NEARLY_REACHED, Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The highest speed of the rigid train, over the trip speed."""
    if e.trip_share is None and case.trip_speed:
        return Finding.impossible("No motor curve, so there is no motor to trip.")
    if e.trip_share is None:
        return Finding.impossible("TripSpeed is blank.")
    wanted = e.trip_share >= 1.0 - NEARLY_REACHED
    why = f"The rigid-body run-up reaches {e.trip_share:.3f} of the trip speed" + (
        "." if wanted else ", so there is no trip."
    )
    return Finding(wanted, True, e.trip_share, 1.0, 0.0, why)
