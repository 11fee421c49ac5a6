"""The model: tables of a sheet → a checked case and its handle."""

from __future__ import annotations

from addin.contract import tables as fields
from addin.contract.sheets import range_of
from addin.worksheet.blocks import case_of, problems_in_words
from addin.worksheet.models import MODELS
from addin.worksheet.registry import Argument, Block, FunctionError, registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 10


#: Argument of TV_MODEL → input table.
TABLES = (
    "Stations", "Elements", "Meshes", "ModeDamping", "MotorTorque", "LoadTorque", "TorqueTime",
    "Materials", "SNPoints", "Excitations", "EffectChoices", "EventTorque", "MotorData",
    "MotorCircuit", "MotorEvents", "SupplyVoltage", "Supply", "Sections", "SectionMaterials",
    "StartConditions", "FatigueFactors",
)  # fmt: skip


#: Scalars of a blank workbook, as a formula names them.
CASE = "Case!B5:J31"


@registered(
    "TV_MODEL",
    Argument("Stations", "block", "Table Stations with headers and the row of units above."),
    Argument("Elements", "block", "Table Elements with headers and units."),
    Argument("Case", "block", "Names, values and units of sheet Case, side by side.", True),
    *(
        Argument(name, "block", f"Table {name} with headers and units.", True)
        for name in TABLES[2:]
    ),
    scalar=True,
    example=f"=TV_MODEL({range_of('Stations')}, {range_of('Elements')}, {CASE}, "
    f"{', '.join(map(range_of, TABLES[2:]))})",
)
def tv_model(stations: Block, elements: Block, case: Block | None, *others: Block | None) -> str:
    """Check a case and give its handle, which the other functions take.

    Equal cases have equal handles. If the tables have errors, the cell shows them instead.
    """
    blocks = {"Stations": stations, "Elements": elements}
    if case is not None:
        blocks[fields.SCALAR_TABLE] = case
    for name, block in zip(TABLES[2:], others, strict=True):
        if block is not None:
            blocks[name] = block
    found = case_of(blocks)
    if found.problems:
        raise FunctionError(problems_in_words(found.problems))
    return MODELS.add(found).handle
