"""How much of a peak is what the motors damp of a mode, or drive?"""

from engine.case.choices import EffectChoice, TorqueFollows
from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.case.effects.motor_transient import MOTOR_TRANSIENT, has_only_motors_from_data
from engine.plan.decision import Finding, percent
from engine.plan.evidence import DAMPING_GAIN, Evidence


def finding(case: CaseData, e: Evidence, modelled: tuple[str, ...]) -> Finding:
    """What the motors change of a mode's damping ratio, over it, times its share of a peak."""
    if e.electrical is None:
        return Finding.impossible("No mode is crossed with a motor on.")
    if not e.electrical.known:
        why = "Not every motor has a row in table MotorData: what it damps of a mode is unknown."
        if any(row.is_one_way for row in case.motor_data):
            why = "A motor has a one-way discharge path: what it damps of a mode is unknown."
            off = choice_of(case, MOTOR_TRANSIENT.name) == EffectChoice.OFF
            if has_only_motors_from_data(case) and not off:
                return Finding.impossible(f"{why} The start in time has it.")
        return Finding.impossible(why, None)
    number, limit = e.electrical.number, e.tolerance / DAMPING_GAIN
    bound = DAMPING_GAIN * number
    if case.torque_follows == TorqueFollows.MACHINE:
        why = f"TorqueFollows is machine. Without it a peak changes by about {percent(number)}."
        return Finding(True, True, number, limit, bound, why)
    wanted = number > limit
    why = (
        f"What the motors damp of a mode, or drive, beyond what the start has changes a peak by about "
        f"{percent(number)}, {'above' if wanted else 'at most'} the limit {percent(limit)}."
    )
    return Finding(wanted, True, number, limit, bound, why)
