"""Counting of stress cycles."""

from engine.case.effect import Effect

CYCLE_COUNTING = Effect(
    "cycle counting",
    "rainflow counting of stress cycles and damage",
    order=90,
    number="Largest possible stress amplitude divided by endurance; on where a cycle may cause damage",
    bound="0",
    called_for_by="Stress diameter, material and S-N points",
    cost=0.5,
    analysis="fatigue",
)
