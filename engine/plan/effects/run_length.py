"""How long would the run go on?"""

import math

from engine.case.data import CaseData
from engine.case.result_words import Outcome
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The time of the rigid run-up, against the longest time."""
    number = e.runup_time
    if number is None:
        return Finding.impossible("Prescribed torques are followed to their end.")
    finite = number if math.isfinite(number) else None
    taken = f"needs {number:.3g} s" if finite is not None else "never reaches the end speed"
    why = f"The rigid-body run-up {taken}; the run ends when it reaches the end speed or settles"
    settled = e.linear is not None and e.linear.outcome != Outcome.REACHED
    why += "." if not settled else ", and cycles are counted up to that time."
    if not settled:
        why += " If forced on, it has no effect on a start that reaches its end speed."
    cost = max(e.longest_time / e.linear.time - 1.0, 0.0) if e.linear and e.linear.time else 0.0
    return Finding(False, True, finite, e.longest_time, None if settled else 0.0, why, cost)
