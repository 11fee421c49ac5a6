"""Does the falling 2 × slip frequency cross a mode?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence
from engine.start.crossings import INITIAL_SHOCK_ZONE


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The lowest mode, over twice the line frequency."""
    if e.first_frequency is None or not e.line_frequency:
        return Finding.impossible("No elastic mode, or the line frequency is unknown.")
    number, limit = e.first_frequency / (2.0 * e.line_frequency), 1.0 + INITIAL_SHOCK_ZONE
    wanted = number <= limit and e.runup_time is not None
    why = (
        f"The lowest mode is at {number:.3g} × (2 × line frequency), "
        f"{'within' if number <= limit else 'above'} reach of the falling 2 × slip frequency."
    )
    return Finding(wanted, e.runup_time is not None, number, limit, 0.0, why)
