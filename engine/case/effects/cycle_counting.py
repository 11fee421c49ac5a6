"""Counting of stress cycles."""

from engine.case.effect import Effect

CYCLE_COUNTING = Effect(
    "cycle counting",
    "rainflow counting of stress cycles and damage",
    order=90,
    cost=0.5,
    analysis="fatigue",
)
