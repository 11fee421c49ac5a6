"""What do modes change that are left out because they are fast?"""

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The change of the peaks by the modes that the linear start left out."""
    if e.linear is None:
        why = (
            "Modes are added until those left out change peaks by less than a tenth of "
            f"{e.tolerance:.2g}."
        )
        return Finding(False, True, None, e.tolerance, None, why, cost=0.0)
    latest = e.event or e.linear
    number, kept = latest.truncation_error, latest.kept_modes
    n = max(latest.n_modes or 0, kept)
    why = (
        f"{kept} of {n} modes integrated; the others are included statically, with an error "
        f"of at most {number:.2g}."
    )
    if kept == n:
        why = f"All {n} modes integrated."
    elif choice_of(case, "fast modes") == "on":
        why += (
            " All modes were requested, but the others are too fast to integrate: they would "
            "need far too short time steps."
        )
    elif number > e.tolerance:
        why += " Integrating them would need far too short time steps."
    return Finding(False, True, number, e.tolerance, number, why, n / max(kept, 1) - 1.0)
