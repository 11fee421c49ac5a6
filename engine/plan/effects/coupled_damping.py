"""Does the damping couple modes enough to matter?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence

#: Relative change of an answer per unit of `Evidence.coupling`: largest seen 19.
COUPLING_GAIN = 50.0


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The share of an element's torque that dampers bring by coupling modes."""
    number, limit = e.coupling, e.tolerance / COUPLING_GAIN
    wanted = number > limit
    if number == 0.0:
        return Finding(False, True, 0.0, limit, 0.0, "Damping couples no modes.")
    why = (
        f"Damping that couples modes changes an element's torque by a share of about {number:.2g}, "
        f"{'above' if wanted else 'at most'} the limit {limit:.2g}."
    )
    return Finding(wanted, True, number, limit, COUPLING_GAIN * number, why)
