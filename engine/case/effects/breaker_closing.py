"""The electrical transient when the breaker closes."""

from engine.case.effect import Effect, EffectInputs

BREAKER_CLOSING = Effect(
    "breaker closing",
    "electrical transient at breaker closing",
    order=40,
    number=(
        "Largest torque it could bring at a resonance, over the motor's at standstill (of "
        "several motors: all transients over the least of their torques); on above tolerance"
    ),
    bound="the number",
    flag="breaker_closing",
    inputs=EffectInputs(
        "ShockAmplitude and ShockTimeConstant",
        "are blank",
        lambda case: case.shock_amplitude is not None,
    ),
    cost=0.2,
)
