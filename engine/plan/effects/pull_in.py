"""Does the train reach the slip at which the field is applied?"""

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.plan.decision import Finding
from engine.plan.evidence import NEARLY_REACHED, Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The slip that the rigid train reaches, against that of the field."""
    if e.field_slip is None or case.field_slip is None:
        why = "FieldSlip and PullOutTorque are not given: the start ends without field application."
        if case.field_slip is not None and case.pull_out_torque is not None:
            why = "No motor curve, so there is no field to apply."
        return Finding.impossible(why, None)
    limit = case.field_slip
    wanted = e.field_slip <= limit + NEARLY_REACHED
    if wanted and _trips_first(case):
        why = "TripSpeed comes before the speed at which the field is applied."
        return Finding(False, True, e.field_slip, limit, 0.0, why)
    why = (
        f"The rigid-body run-up reaches a slip of {e.field_slip:.2%}; the field is applied at "
        f"{limit:.2%}" + ("." if wanted else ", which is not reached.")
    )
    return Finding(wanted, True, e.field_slip, limit, 0.0, why)


def _trips_first(case: CaseData) -> bool:
    """Whether the motor trips before its field is applied."""
    synchronous = case.ratings.synchronous_speed
    off = choice_of(case, "aborted start") == "off"
    if off or not case.trip_speed or not synchronous or case.field_slip is None:
        return False
    return case.trip_speed <= (1.0 - case.field_slip) * synchronous
