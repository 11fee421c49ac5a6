"""Modes too fast to matter."""

from engine.case.effect import Effect

FAST_MODES = Effect(
    "fast modes",
    "modes above those required by the tolerance are integrated",
    order=30,
    flag="fast_modes",
)
