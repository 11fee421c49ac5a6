"""What a motor damps of each mode, or drives."""

from engine.case.data import CaseData
from engine.case.effect import Effect, EffectInputs


def has_data_of_every_motor(case: CaseData) -> bool:
    """Whether every motor has a data sheet, from which its electrical damping follows; not with a one-way discharge path."""
    sheets = {row.station for row in case.motor_data if not row.is_one_way}
    return bool(case.motor_stations) and all(name in sheets for name in case.motor_stations)


ELECTRICAL_DAMPING = Effect(
    "electrical damping",
    "torque that motors answer to the vibration of each mode (small-signal torque)",
    order=45,
    number=(
        "Largest difference between the damping ratio that the motors give a mode where the start crosses it and the "
        "one that the start has by the slope of its curves, divided by the mode's own, times the mode's share of a "
        "peak; on above tolerance / 5, and with TorqueFollows = machine"
    ),
    bound="5 × the number; without MotorData an estimate: the change of a peak with curves read at the other speed",
    flag="electrical_damping",
    inputs=EffectInputs(
        "a row of every motor in table MotorData, without Discharge resistance reverse",
        "are not so",
        has_data_of_every_motor,
    ),
    cost=0.3,
)
