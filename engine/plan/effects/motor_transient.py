"""How much torque do the closing of the breaker and a switch-over bring beyond the curves?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding, percent
from engine.plan.evidence import CLOSING_GAIN, LARGEST_SMALL_SIGNAL, Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The torque that closing or a switch-over adds to an element, over its largest."""
    share = e.closing_share
    if share is None:
        why = "The torque of a motor is typed, or there is no motor: its fluxes are unknown."
        return Finding.impossible(why, None)
    limit = e.tolerance / CLOSING_GAIN
    bound: float | None = CLOSING_GAIN * share
    wanted = share > limit
    what = "Closing or a switch-over adds" if case.switch_over_speeds else "Closing adds"
    why = (
        f"{what} at most {percent(share)} of its largest torque to an element, "
        f"{'above' if wanted else 'at most'} the limit {percent(limit)}."
    )
    if any(row.is_one_way for row in case.motor_data):
        wanted, bound = True, None
        why += (
            " A one-way discharge path fills the field winding with current over many periods of the slip; the curves have it "
            "settled at each speed, and nothing bounds the difference."
        )
    if case.soft_starts:
        wanted, bound = True, None
        why += (
            " A soft starter raises the voltage in time; curves have it against speed, as in the run-up of the rigid train, "
            "and nothing bounds the difference."
        )
    if not wanted and e.electrical and e.electrical.number > LARGEST_SMALL_SIGNAL:
        wanted = True
        why += " What the motors damp of a mode, or drive, is too much for electrical damping, which is of small motions."
    if case.shock_amplitude:
        why += (
            " While it is on the typed ShockAmplitude is not added: the fluxes have the transient."
        )
    return Finding(wanted, True, share, limit, bound, why)
