"""The model: tables of a sheet → a checked case and its handle."""

from __future__ import annotations

from addin.contract import tables as fields
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
)  # fmt: skip


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
    example="=TV_MODEL(Train!B6:G22, Train!B26:U42, Case!B5:J43, Train!B46:R51, Train!I6:J17, "
    "Torque!B6:G37, Torque!I6:K47, Torque!M6:O27, Fatigue!B6:G12, Fatigue!I6:K19, "
    "Excitation!B6:G21, Case!B33:C43, Excitation!B25:H46, Motor!B6:AG11, "
    "Motor!B16:Q21, Excitation!B50:H63, Motor!N47:P58, Motor!R47:Z52, "
    "Sections!B21:L52, Sections!B56:E61)",
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
