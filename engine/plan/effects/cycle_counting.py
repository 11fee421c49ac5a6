"""Can a cycle of the start damage a shaft?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The largest possible stress amplitude, over endurance."""
    if not e.judged:
        return Finding.impossible("No shaft has stress diameter, material and S-N points.")
    latest = e.event or e.linear
    if latest is None or latest.stress_ratio is None:
        why = "Depends on the stresses of the start."
        return Finding(True, True, None, 1.0, None, why)
    number, wanted = latest.stress_ratio, latest.must_count
    why = (
        "The largest possible stress amplitude of the start, including its error, is "
        f"{number:.3g} of endurance"
    )
    if wanted and number <= 1.0:
        why += ", but the material also accumulates damage below endurance."
    else:
        why += ": cycles are counted." if wanted else ": no cycle causes damage."
    return Finding(wanted, True, number, 1.0, 0.0, why)
