"""The motor's fluxes in time: transient at closing, and all that curves leave out."""

from engine.case.data import CaseData
from engine.case.effect import Effect, EffectInputs


def has_only_motors_from_data(case: CaseData) -> bool:
    """Whether the torque of every motor follows from its data sheet: no curve is typed."""
    sheets = {row.station for row in case.motor_data} - {p.station for p in case.motor_torque}
    return bool(case.motor_stations) and all(name in sheets for name in case.motor_stations)


MOTOR_TRANSIENT = Effect(
    "motor transient",
    "torque of the motor from its fluxes in time, from breaker closing on, in place of its curves",
    order=35,
    number=(
        "Largest torque that closing or a switch-over adds to an element beyond the curves, exact at one speed, divided "
        "by the largest torque of that element; on above tolerance / 2, where electrical damping changes a peak by "
        "more than itself, and with a one-way discharge path or a soft starter"
    ),
    bound="2 × the number; none with a one-way discharge path or a soft starter",
    called_for_by="MotorData of every motor, none with rows in MotorTorque",
    flag="motor_transient",
    inputs=EffectInputs(
        "a row of every motor in table MotorData, and none in MotorTorque",
        "are not so",
        has_only_motors_from_data,
    ),
    cost=10.0,
    analysis="start with events",
)
