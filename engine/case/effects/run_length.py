"""A run to its longest time."""

from engine.case.effect import Effect

RUN_LENGTH = Effect(
    "run length",
    "the run continues to MaximumTime even when the train has settled",
    order=100,
    number="Run-up time of the rigid train. auto never switches it on",
    bound="0; blank where the train settles below its end speed",
    flag="full_length",
)
