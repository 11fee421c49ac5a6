"""A run to its longest time."""

from engine.case.effect import Effect

RUN_LENGTH = Effect(
    "run length",
    "the run continues to MaximumTime even when the train has settled",
    order=100,
    flag="full_length",
)
