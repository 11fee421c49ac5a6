"""Checks of table Supply: the line of a motor, and what stands between them at first."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.motors import misspelt_motors
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
#: Open transitions take some cycles of the line; above, milliseconds were typed as seconds. [s]
LONGEST_OPEN = 10.0
#: Soft starters allow 30 s to 60 s; above, milliseconds were typed as seconds. [s]
LONGEST_RAMP = 120.0
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
    Limit(
        "Open time",
        Allowed(lambda v: 0.001 <= v <= LONGEST_OPEN, f"between 0.001 s and {LONGEST_OPEN:g} s"),
        "s",
        "It is how long the motor is off the line: 0.05 s to 1 s. Write 80 ms or 0.08 s; blank where the line takes over "
        "without interruption.",
    ),
    Limit(
        "Initial voltage",
        Allowed(lambda v: 0.1 <= v < 1.0, "at least 0.1 (10 %) and below 1 (100 %)"),
        "",
        "It is the share of the voltage that the soft starter begins with: write 40 % or 0.4.",
    ),
    Limit(
        "Ramp time",
        Allowed(lambda v: 0.05 <= v <= LONGEST_RAMP, f"between 0.05 s and {LONGEST_RAMP:g} s"),
        "s",
        "It is how long the voltage rises: 2 s to 30 s. Milliseconds typed as seconds?",
    ),
)
#: What each way of starting needs, and may have.
NEEDED = {
    Starting.DIRECT: (),
    Starting.AUTOTRANSFORMER: ("Tap", "Switch-over speed"),
    Starting.REACTOR: ("Tap", "Switch-over speed"),
    Starting.SOFT_START: ("Initial voltage", "Ramp time"),
}
POSSIBLE = {
    Starting.AUTOTRANSFORMER: ("Open time",),
    Starting.REACTOR: ("Open time",),
}
OF_STARTERS = ("Tap", "Switch-over speed", "Open time", "Initial voltage", "Ramp time")


def check_supply(case: CaseData) -> Iterator[Problem]:
    """A line for each motor at most, with what its starter needs."""
    sheets = {m.station: m for m in case.motor_data if m.station}
    curves = set(case.motor_stations)
    given = {row.station for row in case.supply_voltage}
    misspelt = misspelt_motors(case)
    yield from check_names(TABLE, "Station", [row.station for row in case.supply], "a motor")
    for cells, row in each_row(TABLE, case.supply):
        yield from cells.numbers(row, NUMBERS)
        yield from cells.choice("Starting", row.starting, Starting)
        alone = row.starting == Starting.SOFT_START and (row.short_circuit_power, row.x_r) == (
            None,
            None,
        )
        motors = {*(curves if alone else sheets), *misspelt}
        if row.station is not None and row.station not in motors:
            yield cells.wrong(
                "Station",
                row.station,
                "a station with a motor" if alone else "a station of table MotorData",
                "Give its torque curve in MotorTorque or its data sheet in MotorData."
                if alone
                else "What the motor draws from the line follows from its data sheet: type its row there, or the voltage "
                "that the line leaves it in table SupplyVoltage.",
            )
        elif row.station in given:
            yield cells.wrong(
                "Station",
                row.station,
                "a station without rows in table SupplyVoltage",
                "Its voltage is either typed there or follows from the line. Clear one of the two.",
            )
        elif row.station in sheets:
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
    """What a starter needs, and nothing else."""
    if row.starting not in (None, *Starting):
        return  # reported already
    starting = Starting(row.starting or Starting.DIRECT)
    needed, possible = NEEDED[starting], POSSIBLE.get(starting, ())
    for column in OF_STARTERS:
        value = value_of(row, column)
        if column in needed and value is None:
            yield cells.blank(
                column, f"given for Starting {starting}", "Type it from the starter's data."
            )
        elif column not in (*needed, *possible) and value is not None:
            others = " or ".join(
                s for s in Starting if column in (*NEEDED[s], *POSSIBLE.get(s, ()))
            )
            yield cells.wrong(
                column,
                value,
                f"blank where Starting is {starting}",
                f"Choose {others} in Starting, or clear the cell.",
            )
