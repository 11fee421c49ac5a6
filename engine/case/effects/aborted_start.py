"""A start that trips."""

from engine.case.effect import Effect, EffectInputs

ABORTED_START = Effect(
    "aborted start",
    "trip at a speed, and coast-down",
    order=60,
    number="Highest speed of the rigid train divided by TripSpeed; on from 0.99",
    bound="0",
    flag="aborted_start",
    inputs=EffectInputs("TripSpeed", "is blank", lambda case: case.trip_speed is not None),
    cost=1.0,
    analysis="start with events",
)
