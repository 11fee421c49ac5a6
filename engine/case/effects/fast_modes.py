"""Modes too fast to matter."""

from engine.case.effect import Effect

FAST_MODES = Effect(
    "fast modes",
    "modes above those required by the tolerance are integrated",
    order=30,
    number=(
        "Largest change of a peak that the modes left out may cause. auto never switches it on: "
        "modes are added until this is below a tenth of the tolerance"
    ),
    bound="the number",
    flag="fast_modes",
)
