"""Stiffness of a shaft from its sizes, and of a stepped one from its sections."""

from __future__ import annotations

import math

from addin.contract.sheets import range_of
from addin.contract.tables import table
from addin.worksheet.answers import Rows, si_unit, system_for, table_cells
from addin.worksheet.blocks import case_of_sections, problems_in_words
from addin.worksheet.registry import Argument, Block, FunctionError, registered
from engine.model.links import shaft_stiffness
from engine.results.tables import section_results

#: Place of these functions among all, in lists and in the documentation.
ORDER = 30


@registered(
    "TV_STIFFNESS",
    Argument("OD", "number", "The outer diameter [mm or in]."),
    Argument("ID", "number", "The bore [mm or in]; blank = solid.", blank=True),
    Argument("Length", "number", "The length [mm or in]."),
    Argument("Shear modulus", "number", "The shear modulus [MPa or psi]."),
    Argument("Units", "text", "SI (mm, MPa, N*m/rad; default) or US (in, psi, lbf*in/rad).", True),
    by_cell=True,
    example="=TV_STIFFNESS(200, 0, 500, 79300)",
)
def tv_stiffness(
    outer: float, bore: float | None, length: float, modulus: float, units: str | None
) -> float:
    """Torsional stiffness of a round shaft, k = G π (D⁴ − d⁴) / 32 L."""
    system = system_for(units, None)
    _, metre = si_unit("length", system)
    _, pascal = si_unit("pressure", system)
    _, newton_metre = si_unit("torsional stiffness", system)
    for name, value in (("OD", outer), ("Length", length), ("Shear modulus", modulus)):
        if value <= 0.0:
            raise FunctionError(f"{name}: found {value:.10g}; it must be above 0.", "#NUM!")
    inner = 0.0 if bore is None else bore
    if not 0.0 <= inner < outer:
        raise FunctionError(
            f"ID: found {inner:.10g}; it must be at least 0 and below OD {outer:.10g}.", "#NUM!"
        )
    sizes = outer * metre, inner * metre, length * metre, modulus * pascal
    try:
        stiffness = float(shaft_stiffness(*sizes) / newton_metre)
    except (OverflowError, ZeroDivisionError):
        stiffness = math.inf
    if not 0.0 < stiffness < math.inf:
        raise FunctionError(
            "These dimensions give a stiffness outside the number range. Check their units.",
            "#NUM!",
        )
    return stiffness


@registered(
    "TV_SECTIONS",
    Argument("Sections", "block", "Table Sections with headers and units."),
    Argument("Materials", "block", "Table SectionMaterials with headers and units.", True),
    Argument(
        "Units", "text", "SI (mm, N*m/rad, kg*m^2; default) or US (in, lbf*in/rad, lb*ft^2).", True
    ),
    columns=len(table("SectionResults").columns),
    example=f"=TV_SECTIONS({range_of('Sections')}, {range_of('SectionMaterials')})",
)
def tv_sections(sections: Block, materials: Block | None, units: str | None) -> Rows:
    """Effective length, stiffness and inertia of each section, and of each element as a whole.

    As table SectionResults has them, without a calculation; steps, tapers, hubs and keyways included.
    """
    case, problems = case_of_sections(sections, materials)
    if problems:
        raise FunctionError(problems_in_words(problems))
    return table_cells("SectionResults", section_results(case), system_for(units, None), True)
