"""Dampers that couple the modes."""

from engine.case.effect import Effect

COUPLED_DAMPING = Effect(
    "coupled damping",
    "dampers couple the modes in the start (non-proportional damping)",
    order=20,
    flag="coupled_damping",
    cost=0.3,
)
