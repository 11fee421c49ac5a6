"""How much torque may the electrical transient at breaker closing bring?"""

from engine.case.data import CaseData
from engine.plan.decision import Finding
from engine.plan.evidence import Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """The transient at resonance, over the motor torque at standstill."""
    if e.shock_share is None and case.shock_amplitude and not case.motor_stations:
        return Finding.impossible("No motor curve, so there is no breaker closing.")
    if case.shock_amplitude == 0.0:
        return Finding.impossible("ShockAmplitude is 0.")
    if e.shock_share is None:
        return Finding.impossible(
            "ShockAmplitude and ShockTimeConstant are not given: the transient is unknown.", None
        )
    wanted = e.shock_share > e.tolerance
    several = len(case.motor_stations) > 1
    compared = "least motor torque" if several else "motor torque"
    why = (
        f"At resonance the transient{'s' if several else ''} could add at most "
        f"{e.shock_share:.2g} times the {compared} at standstill, "
        f"{'above' if wanted else 'at most'} the tolerance {e.tolerance:.2g}."
    )
    return Finding(wanted, True, e.shock_share, e.tolerance, e.shock_share, why)
