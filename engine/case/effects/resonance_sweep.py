"""Crossings of the modes by the falling 2 × slip frequency."""

from engine.case.effect import Effect

RESONANCE_SWEEP = Effect(
    "resonance sweep",
    "the falling 2 × slip frequency crosses modes",
    order=80,
    number="Lowest mode divided by 2 × line frequency; on up to 1.1",
    bound="0",
    cost=0.02,
    analysis="crossings",
)
