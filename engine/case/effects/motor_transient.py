"""The motor's fluxes in time: transient at closing, and all that curves leave out."""

from engine.case.data import CaseData
from engine.case.effect import Effect, EffectInputs


def has_only_motors_from_data(case: CaseData) -> bool:
    """Whether the torque of every motor follows from its data sheet, on a stiff line: no curve is typed.

    Fluxes behind an impedance that is switched while the motor starts are not simulated yet.
    """
    sheets = {row.station for row in case.motor_data} - {p.station for p in case.motor_torque}
    given = bool(case.motor_stations) and not case.supply
    return given and all(name in sheets for name in case.motor_stations)


MOTOR_TRANSIENT = Effect(
    "motor transient",
    "torque of the motor from its fluxes in time, from breaker closing on, in place of its curves",
    order=35,
    number=(
        "Largest torque that closing adds to an element beyond the curves, exact with the rotor at rest, divided by "
        "the largest torque of that element; on above tolerance / 2, and where electrical damping changes a peak by "
        "more than itself"
    ),
    bound="2 × the number",
    called_for_by="MotorData of every motor, none with rows in MotorTorque or Supply",
    flag="motor_transient",
    inputs=EffectInputs(
        "a row of every motor in table MotorData, and none in MotorTorque and Supply",
        "are not so",
        has_only_motors_from_data,
    ),
    cost=10.0,
    analysis="start with events",
)
