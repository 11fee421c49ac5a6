"""Modes too fast to matter."""

from engine.case.effect import Effect

FAST_MODES = Effect(
    "fast modes",
    "modes above those that the tolerance asks for are integrated",
    order=30,
    flag="fast_modes",
)
