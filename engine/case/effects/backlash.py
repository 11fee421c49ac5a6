"""Teeth that separate and re-engage."""

from engine.case.effect import Effect, EffectInputs

BACKLASH = Effect(
    "backlash",
    "teeth that separate, cross their clearance and re-engage",
    order=70,
    number=(
        "Lowest torque of the linear start minus its error, divided by the largest torque of that "
        "element; on below −tolerance / 5"
    ),
    bound="5 × its depth",
    inputs=EffectInputs(
        "Backlash or Angular backlash in table Meshes",
        "is blank or 0",
        lambda case: any(m.backlash or m.angular_backlash for m in case.meshes),
    ),
    cost=10.0,
    analysis="start with events",
)
