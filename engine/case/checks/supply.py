"""Checks of table Supply: the line of a motor, and what stands between them at first."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.problem import (
    POSITIVE,
    Allowed,
    Cells,
    Limit,
    blank_or_positive,
    check_names,
    each_row,
    quote_quantity,
)
from engine.case.choices import Starting
from engine.case.data import CaseData, MotorDataRow, SupplyRow, value_of
from engine.errors import Problem

TABLE = "Supply"
#: Reactance over resistance of lines is 1 (cables) to 50 (at a power station's bus); above, something else was typed. [1]
LARGEST_RATIO = 200.0
NUMBERS = (
    Limit("Short-circuit power", POSITIVE, "V A", "It is in kVA or MVA, not a current in kA."),
    Limit(
        "X/R",
        Allowed(lambda v: 0.0 < v <= LARGEST_RATIO, f"positive and at most {LARGEST_RATIO:g}"),
    ),
    Limit(
        "Tap",
        Allowed(lambda v: 0.1 <= v < 1.0, "at least 0.1 (10 %) and below 1 (100 %)"),
        "",
        "It is the share of the voltage that the tap gives: write 65 % or 0.65.",
    ),
    Limit(
        "Switch-over speed",
        Allowed(
            lambda v: 0.05 <= v <= 0.98, "between 0.05 (5 %) and 0.98 (98 %) of synchronous speed"
        ),
        "",
        "Write 90 % or the speed in rpm.",
    ),
)


def check_supply(case: CaseData) -> Iterator[Problem]:
    """A line for each motor at most, with what its starter needs."""
    sheets = {m.station: m for m in case.motor_data if m.station}
    given = {row.station for row in case.supply_voltage}
    yield from check_names(TABLE, "Station", [row.station for row in case.supply], "a motor")
    for cells, row in each_row(TABLE, case.supply):
        yield from cells.numbers(row, NUMBERS)
        yield from cells.choice("Starting", row.starting, Starting)
        if row.station is not None and row.station not in sheets:
            yield cells.wrong(
                "Station",
                row.station,
                "a station of table MotorData",
                "What the motor draws from the line follows from its data sheet: type its row there, or the voltage "
                "that the line leaves it in table SupplyVoltage.",
            )
        elif row.station in given:
            yield cells.wrong(
                "Station",
                row.station,
                "a station without rows in table SupplyVoltage",
                "Its voltage is either typed there or follows from the line. Clear one of the two.",
            )
        elif row.station is not None:
            yield from _weakest(case, cells, row, sheets[row.station])
        yield from _starter(cells, row)


def _weakest(
    case: CaseData, cells: Cells, row: SupplyRow, motor: MotorDataRow
) -> Iterator[Problem]:
    """A line that is no weaker than the motor: else kVA and MVA were mixed up."""
    power, rated = row.short_circuit_power, motor.base_power(case.ratings.rated_power)
    if power is None or rated is None or not all(map(blank_or_positive, (power, rated))):
        return
    if power < rated:
        yield cells.wrong(
            "Short-circuit power",
            power,
            f"at least the apparent power of the motor, {rated:.6g} V A",
            "kVA typed as MVA, or the reverse? A line for starting it has ten times as much or more.",
            "V A",
            quote_quantity(rated, "V A", ("MotorData", None, "Apparent power")),
        )


def _starter(cells: Cells, row: SupplyRow) -> Iterator[Problem]:
    """Tap and switch-over speed of an autotransformer or a reactor, and of nothing else."""
    if row.starting not in (None, *Starting):
        return  # reported already
    reduced = row.starting in (Starting.AUTOTRANSFORMER, Starting.REACTOR)
    for column in ("Tap", "Switch-over speed"):
        value = value_of(row, column)
        if reduced and value is None:
            yield cells.blank(
                column, f"given for Starting {row.starting}", "Type it from the starter's data."
            )
        elif not reduced and value is not None:
            yield cells.wrong(
                column,
                value,
                "blank where Starting is direct",
                "Choose autotransformer or reactor in Starting, or clear the cell.",
            )
