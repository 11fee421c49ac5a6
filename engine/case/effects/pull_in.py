"""Field application and pull-in of a synchronous motor."""

from engine.case.effect import Effect, EffectInputs

PULL_IN = Effect(
    "pull-in",
    "field application, synchronising torque, pull-in and swing",
    order=50,
    number="Slip that the rigid train reaches; on if it falls to FieldSlip (within 1 % of speed)",
    bound="0",
    flag="pull_in",
    inputs=EffectInputs(
        "FieldSlip and PullOutTorque", "are blank", lambda case: case.field_slip is not None
    ),
    cost=10.0,
    analysis="start with events",
)
