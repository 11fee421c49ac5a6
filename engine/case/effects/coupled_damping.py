"""Dampers that couple the modes."""

from engine.case.effect import Effect

COUPLED_DAMPING = Effect(
    "coupled damping",
    "dampers couple the modes in the start (non-proportional damping)",
    order=20,
    number=(
        "Estimated change of an element's torque by the coupling of modes, as a share of that "
        "torque; on above tolerance / 50"
    ),
    bound="50 × the number",
    called_for_by="Damping of elements or stations",
    flag="coupled_damping",
    cost=0.3,
)
