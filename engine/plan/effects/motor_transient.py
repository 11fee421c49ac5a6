"""How much torque does the closing of the breaker bring beyond the curves?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding, percent
from engine.plan.evidence import Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The torque that closing adds to an element, over its largest."""
    share = e.closing_share
    if share is None:
        why = "The torque of a motor is typed, or there is no motor: its fluxes are unknown."
        return Finding.impossible(why, None)
    wanted = share > e.tolerance
    why = (
        f"Closing adds at most {percent(share)} of its largest torque to an element, "
        f"{'above' if wanted else 'at most'} the tolerance {percent(e.tolerance)}."
    )
    if case.shock_amplitude:
        why += (
            " While it is on the typed ShockAmplitude is not added: the fluxes have the transient."
        )
    return Finding(wanted, True, share, e.tolerance, share, why)
