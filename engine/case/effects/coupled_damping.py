"""Dampers that couple the modes."""

from engine.case.effect import Effect

COUPLED_DAMPING = Effect(
    "coupled damping",
    "dampers couple the modes in the start (non-proportional damping)",
    order=20,
    number=(
        "Estimated share of an element's torque that the coupling brings; on above tolerance / 50"
    ),
    bound="50 × the number",
    called_for_by="Damping of elements or stations",
    flag="coupled_damping",
    cost=0.3,
)
