"""The electrical transient when the breaker closes."""

from engine.case.effect import Effect, EffectInputs

BREAKER_CLOSING = Effect(
    "breaker closing",
    "electrical transient at breaker closing",
    order=40,
    number=(
        "Largest torque it could add at a resonance, divided by the motor torque at standstill "
        "(several motors: sum of their transients, divided by the least motor torque); on above "
        "tolerance"
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
