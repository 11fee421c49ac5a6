"""Gears that move laterally on their bearings."""

from engine.case.data import CaseData
from engine.case.effect import Effect, EffectInputs


def has_bearings(case: CaseData) -> bool:
    """Whether any gear has bearing data, so that it can move laterally."""
    return any(m.bearing_stiffness_drive or m.bearing_stiffness_driven for m in case.meshes)


BEARINGS = Effect(
    "bearings",
    "lateral motion of gears on their bearings (lateral-torsional coupling at the mesh)",
    order=10,
    number=(
        "Largest change of a mode by the bearings (frequency, shape or damping; 1 = another "
        "mode altogether); on above tolerance / 50"
    ),
    bound="50 × the number",
    inputs=EffectInputs(
        "a bearing stiffness and the mass of its gear in table Meshes", "are blank", has_bearings
    ),
    of_the_start=False,
)
