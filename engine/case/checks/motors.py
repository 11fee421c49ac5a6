"""Checks of the data sheets and circuits of motors.

The circuit of a data sheet has positive leakages and resistances exactly where the reactances fall from
winding to winding, Xd > Xd' > Xd'' > Xl and Xq > Xq'' > Xl, so that is what is checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from engine.case.checks.problem import (
    NOT_NEGATIVE,
    POSITIVE,
    SCALARS,
    Allowed,
    Cells,
    Limit,
    blank_or_positive,
    check_names,
    each_row,
    number_text,
    probably_meant,
    quote_quantity,
)
from engine.case.choices import (
    DischargePath,
    FieldCircuit,
    MotorKind,
    TimeConstantKind,
    TorqueFollows,
)
from engine.case.data import CaseData, MotorCircuitRow, MotorDataRow, value_of
from engine.case.time_constants import short_circuit_times
from engine.errors import Problem

#: Reactances of real motors are within, in per unit; beyond, per cent and per unit were mixed up. [1]
LEAST_REACTANCE = 0.005  #: Leakages are at least 0.03.
LARGEST_MAGNETISING = 20.0  #: Xd is at most 3; magnetising reactances of induction motors reach 6.
LARGEST_LEAKAGE = 2.0  #: Transient and subtransient reactances, too, are at most 0.6.
LARGEST_RESISTANCE = 1.0  #: Of a winding; a second cage may have 0.3.
#: Time constants of real motors are far below; above, milliseconds were typed. [s]
LONGEST_TRANSIENT = 60.0  #: Td0' of the largest machines is 15 s.
LONGEST_SUBTRANSIENT = 4.0  #: Tq0'' of solid poles reaches 1 s.

_PER_CENT = "Per cent and per unit mixed up? Write 18 % or 0.18 pu."
_MILLISECONDS = "Milliseconds typed as seconds? Write 35 ms or 0.035 s."


def _at_most(most: float, unit: str) -> Allowed:
    return Allowed(lambda v: 0.0 < v <= most, f"positive and at most {most:g} {unit}")


def _reactances(most: float, *columns: str) -> tuple[Limit, ...]:
    words = f"between {LEAST_REACTANCE:g} and {most:g} pu"
    allowed = Allowed(lambda v: LEAST_REACTANCE <= v <= most, words)
    return tuple(Limit(column, allowed, "pu", _PER_CENT) for column in columns)


def _times(longest: float, *columns: str) -> tuple[Limit, ...]:
    return tuple(Limit(column, _at_most(longest, "s"), "s", _MILLISECONDS) for column in columns)


_SHARE = Allowed(lambda v: 0.0 < v <= 1.0, "positive and at most 1 (100 %)")
_RESISTANCE = Allowed(
    lambda v: 0.0 <= v <= LARGEST_RESISTANCE,
    f"zero or positive and at most {LARGEST_RESISTANCE:g} pu",
)
_LEAKAGE = Allowed(
    lambda v: 0.0 <= v <= LARGEST_LEAKAGE, f"zero or positive and at most {LARGEST_LEAKAGE:g} pu"
)
DATA_NUMBERS = (
    Limit("Apparent power", POSITIVE, "V A"),
    Limit("Voltage", POSITIVE, "V"),
    Limit(
        "Power factor",
        Allowed(lambda v: 0.0 < abs(v) <= 1.0, "at most 1 (100 %), and below 0 only where it lags"),
    ),
    Limit("Efficiency", _SHARE),
    *_reactances(LARGEST_MAGNETISING, "Xd", "Xq"),
    *_reactances(LARGEST_LEAKAGE, "Xd transient", "Xd subtransient", "Xq subtransient", "Xl"),
    *_times(LONGEST_TRANSIENT, "Td0 transient", "Td transient"),
    *_times(
        LONGEST_SUBTRANSIENT,
        "Td0 subtransient", "Tq0 subtransient", "Td subtransient", "Tq subtransient", "Ta",
    ),
    Limit("Ra", _RESISTANCE, "pu", _PER_CENT),
    Limit("R1", _RESISTANCE, "pu", _PER_CENT),
    *_reactances(LARGEST_MAGNETISING, "Xm"),
    *_reactances(LARGEST_LEAKAGE, "X1"),
    *(Limit(column, _at_most(LARGEST_RESISTANCE, "pu"), "pu", _PER_CENT) for column in ("R2", "R3")),
    *(Limit(column, _LEAKAGE, "pu", _PER_CENT) for column in ("X2", "X3")),
    Limit(
        "Discharge resistance", NOT_NEGATIVE, "",
        "It is a multiple of the resistance of the field winding, often 5 to 15.",
    ),
    Limit(
        "Discharge resistance reverse", NOT_NEGATIVE, "",
        "It is a multiple of the resistance of the field winding; open where no current flows that way.",
    ),
    Limit(
        "Start factor", Allowed(lambda v: 0.0 < v <= 2.0, "positive and at most 2"), "",
        "It multiplies leakage reactances, usually by 0.7 to 1.",
    ),
)  # fmt: skip
CIRCUIT_NUMBERS = (
    Limit("Rs", _RESISTANCE, "pu", _PER_CENT),
    *_reactances(LARGEST_LEAKAGE, "Xl"),
    *_reactances(LARGEST_MAGNETISING, "Xmd", "Xmq"),
    *(
        limit
        for winding in ("f", "kd", "kq", "kd2", "kq2")
        for limit in (
            Limit(f"R{winding}", _at_most(LARGEST_RESISTANCE, "pu"), "pu", _PER_CENT),
            Limit(f"Xl{winding}", _LEAKAGE, "pu", _PER_CENT),
        )
    ),
    Limit("Xc", _LEAKAGE, "pu", _PER_CENT),
)

#: Reactances that a data sheet must have.
REACTANCES = ("Xd", "Xq", "Xd subtransient", "Xq subtransient", "Xl")
#: Time constants of field, damper of the poles and damper between them: stator open, and short-circuited.
OPEN_TIMES = ("Td0 transient", "Td0 subtransient", "Tq0 subtransient")
SHORT_TIMES = ("Td transient", "Td subtransient", "Tq subtransient")
#: Equivalent circuit of an induction motor, and its second cage.
INDUCTION = ("R1", "X1", "Xm", "R2", "X2")
SECOND_CAGE = ("R3", "X3")
#: What the field winding is closed by in the start.
DISCHARGE = ("Discharge resistance", "Discharge resistance reverse")
#: What only a synchronous motor has.
SYNCHRONOUS = (*REACTANCES, "Xd transient", *OPEN_TIMES, *SHORT_TIMES, "Ta", "Ra")
#: What a circuit in table MotorCircuit stands in place of.
OF_THE_SHEET = (*SYNCHRONOUS, *INDUCTION, *SECOND_CAGE, "Time constants")
#: Reactances of each axis, from the largest to the smallest.
FALLING = (
    ("Xd", "Xd transient", "Xd subtransient", "Xl"),
    ("Xq", "Xq subtransient", "Xl"),
)


def check_motors(case: CaseData) -> Iterator[Problem]:
    """Data sheets of motors, each with reactances and time constants or with a circuit."""
    stations = {s.station for s in case.stations if s.station}
    circuits = {row.station: cells for cells, row in each_row("MotorCircuit", case.motor_circuit)}
    fields = {row.station: row.rf for row in case.motor_circuit}
    yield from check_names("MotorData", "Station", [m.station for m in case.motor_data], "a motor")
    for cells, motor in each_row("MotorData", case.motor_data):
        if motor.station is not None:
            yield from cells.name("Station", motor.station, stations, "Stations")
        is_open = motor.discharge_resistance_reverse == DischargePath.OPEN
        numbers = replace(motor, discharge_resistance_reverse=None) if is_open else motor
        yield from cells.numbers(numbers, DATA_NUMBERS)
        yield from cells.choice("Kind", motor.kind, MotorKind)
        yield from cells.choice("Field circuit", motor.field_circuit, FieldCircuit)
        yield from cells.choice("Time constants", motor.time_constants, TimeConstantKind)
        yield from _base(case, cells, motor)
        if motor.station in circuits:
            yield from _nothing_else(cells, motor, circuits[motor.station])
        elif motor.kind == MotorKind.INDUCTION:
            yield from _induction(cells, motor)
        else:
            of_induction = list(
                _only(cells, motor, (*INDUCTION, *SECOND_CAGE), "Kind is induction")
            )
            yield from of_induction
            if of_induction and all(value_of(motor, c) is None for c in SYNCHRONOUS):
                continue  # it is the Kind that is wrong
            yield from _sheet(cells, motor)
            yield from _measured(cells, motor)
        yield from _field_in_the_start(cells, motor, fields.get(motor.station))
    yield from _circuits(case)
    yield from _machine_without_data(case)


def _base(case: CaseData, cells: Cells, motor: MotorDataRow) -> Iterator[Problem]:
    """What one per unit is: the motor's own apparent power, typed or from its rated power."""
    shared = len(case.motor_data) > 1  # then the rated power is not that of one motor
    if motor.apparent_power is None and (
        shared or motor.base_power(case.ratings.rated_power) is None
    ):
        yield cells.blank(
            "Apparent power",
            "the rated apparent power, to which per unit refers",
            "Type it in kVA from the name plate"
            + ("." if shared else ", or RatedPower with Power factor and Efficiency."),
        )


def _nothing_else(cells: Cells, motor: MotorDataRow, circuit: Cells) -> Iterator[Problem]:
    """A circuit leaves nothing for reactances and time constants to say."""
    for column in OF_THE_SHEET:
        value = value_of(motor, column)
        if value is not None:
            yield cells.problem(
                column,
                value,
                "blank where table MotorCircuit has the motor",
                f"found {number_text(value)}, but row {circuit.row} of table MotorCircuit gives the "
                f"circuit of '{motor.station}'. Clear the reactances and time constants, or that row.",
            )
            return


def _only(
    cells: Cells, motor: MotorDataRow, columns: Sequence[str], where: str
) -> Iterator[Problem]:
    """Columns of the other kind of motor are blank; the first that is filled is reported."""
    typed = [(c, v) for c in columns if (v := value_of(motor, c)) is not None]
    for column, value in typed[:1]:
        yield cells.wrong(
            column, value, f"blank unless {where}", "Correct Kind, or clear the cell.", "pu"
        )


def _induction(cells: Cells, motor: MotorDataRow) -> Iterator[Problem]:
    """The equivalent circuit of an induction motor."""
    of_field = (*DISCHARGE, "Field circuit", "Time constants")
    if motor.power_factor is not None and motor.power_factor < 0.0:
        yield cells.wrong(
            "Power factor", motor.power_factor, "positive where Kind is induction",
            "The current of an induction motor always lags: type it without sign.",
        )  # fmt: skip
    yield from _only(cells, motor, (*SYNCHRONOUS, *of_field), "Kind is synchronous")
    for column in INDUCTION:
        if value_of(motor, column) is None:
            yield cells.blank(
                column, "a number", "Type it from the equivalent circuit of the motor."
            )
    yield from _pair(cells, motor, SECOND_CAGE)
    yield from _above_leakage(cells, motor, "X1", ("Xm",))


def _above_leakage(
    cells: Cells, row: MotorDataRow | MotorCircuitRow, leakage: str, magnetising: Sequence[str]
) -> Iterator[Problem]:
    """The main flux of a motor is many times the leakage flux of its stator."""
    least = value_of(row, leakage)
    for column in magnetising:
        value = value_of(row, column)
        given = value is not None and least is not None
        if given and blank_or_positive(value) and blank_or_positive(least) and value <= least:
            yield cells.wrong(
                column,
                value,
                f"above {leakage}, {number_text(least, 'pu')}",
                f"A magnetising reactance is 0.5 pu to 6 pu, a leakage of the stator 0.05 pu to 0.25 pu. Are {column} and "
                f"{leakage} interchanged, or in different units?",
                "pu",
                quote_quantity(least, "pu", (*cells, leakage)),
            )


def _pair(
    cells: Cells, row: MotorDataRow | MotorCircuitRow, pair: tuple[str, str]
) -> Iterator[Problem]:
    """A winding has a resistance and a leakage."""
    resistance, leakage = (value_of(row, column) for column in pair)
    if (resistance is None) != (leakage is None):
        missing, present = pair if resistance is None else pair[::-1]
        yield cells.blank(
            missing,
            f"given where {present} is",
            f"Type it, or clear {present} where there is no such winding.",
        )


def _sheet(cells: Cells, motor: MotorDataRow) -> Iterator[Problem]:
    """Reactances and time constants that make a circuit."""
    for column in REACTANCES:
        if value_of(motor, column) is None:
            yield cells.blank(
                column,
                "a reactance",
                "Type it from the data sheet, or give the circuit of the motor in table MotorCircuit.",
            )
    for columns in FALLING:
        yield from _falling(cells, motor, columns)
    yield from _time_constants(cells, motor)
    if (motor.ta is None) == (motor.ra is None):
        both = motor.ta is not None
        yield cells.problem(
            "Ta",
            motor.ta,
            "given, or Ra instead",
            "the resistance of the stator follows from Ta, or is Ra: "
            + (
                "both are given. Clear one of the two."
                if both
                else "both are blank. Type one of the two."
            ),
        )


def _falling(cells: Cells, motor: MotorDataRow, columns: Sequence[str]) -> Iterator[Problem]:
    """Each further winding makes the reactance smaller, else its leakage would be negative."""
    values = [(column, value_of(motor, column)) for column in columns]
    given = [(column, value) for column, value in values if value is not None]
    if not all(blank_or_positive(value) for _, value in given):
        return  # reported already
    for (larger, above), (column, value) in zip(given, given[1:], strict=False):
        if value >= above:
            yield cells.wrong(
                column,
                value,
                f"below {larger}, {number_text(above, 'pu')}",
                "Otherwise a winding would have a negative leakage. Check both numbers, and that they "
                "are of one motor and in the right columns.",
                "pu",
                quote_quantity(above, "pu", (*cells, larger)),
            )


def _time_constants(cells: Cells, motor: MotorDataRow) -> Iterator[Problem]:
    """One set of time constants, one for each winding, the damper faster than the field."""
    open_, short = (
        [column for column in columns if value_of(motor, column) is not None]
        for columns in (OPEN_TIMES, SHORT_TIMES)
    )
    if open_ and short:
        value = value_of(motor, short[0])
        yield cells.problem(
            short[0],
            value,
            "blank where a time constant with open stator is given",
            f"found {number_text(value, 's')}, but {open_[0]} is given, too: there are two sets of time "
            "constants, with the stator open (Td0) and short-circuited (Td). Clear one set.",
        )
        return
    field, *dampers = SHORT_TIMES if short else OPEN_TIMES
    for column in dampers:
        if value_of(motor, column) is None:
            yield cells.blank(column, "a time constant", "Type it from the data sheet.")
    slow, fast = value_of(motor, field), value_of(motor, dampers[0])
    if (slow is None) != (motor.xd_transient is None):
        missing, present = (field, "Xd transient") if slow is None else ("Xd transient", field)
        yield cells.blank(
            missing,
            f"given where {present} is",
            f"A field winding has both. Type it, or clear {present} where there is no field winding.",
        )
    elif slow is not None and fast is not None and blank_or_positive(slow) and fast >= slow:
        yield cells.wrong(
            dampers[0],
            fast,
            f"below {field}, {number_text(slow, 's')}",
            "The damper is faster than the field, as a rule a hundred times. Check units and columns.",
            "s",
            quote_quantity(slow, "s", (*cells, field)),
        )


def _measured(cells: Cells, motor: MotorDataRow) -> Iterator[Problem]:
    """Measured time constants are those of some circuit, and there is a field beside the damper."""
    if motor.time_constants != TimeConstantKind.MEASURED:
        return
    given = (
        motor.xd,
        motor.xd_transient,
        motor.xd_subtransient,
        motor.td_0_transient,
        motor.td_0_subtransient,
    )
    numbers = [v for v in given if v is not None and math.isfinite(v) and v > 0.0]
    if len(numbers) < len(given):
        return  # reported already, or short-circuited ones: these are always those of a circuit
    xd, transient, subtransient, slow, fast = numbers
    falling = xd > transient > subtransient and slow > fast  # else reported already
    if falling and short_circuit_times((xd, transient, subtransient), (slow, fast)) is None:
        yield cells.wrong(
            "Td0 subtransient",
            fast,
            "such that a circuit has it beside Td0 transient, where Time constants is measured",
            "The two are too near to each other for Xd transient and Xd subtransient. Check them, or type the "
            "short-circuit time constants Td transient and Td subtransient instead.",
            "s",
        )


def _field_in_the_start(
    cells: Cells, motor: MotorDataRow, of_circuit: float | None
) -> Iterator[Problem]:
    """An open field has no resistor across it, and what is not there no polarity."""
    for column in DISCHARGE:
        value = value_of(motor, column)
        if motor.field_circuit == FieldCircuit.OPEN and value is not None:
            yield cells.wrong(
                column, value, "blank where Field circuit is open", "Clear one of the two."
            )
            return
    reverse = motor.discharge_resistance_reverse
    if reverse is None or motor.kind == MotorKind.INDUCTION:
        return
    if motor.xd_transient is None and of_circuit is None:
        yield cells.wrong(
            "Discharge resistance reverse", reverse, "blank without a field winding",
            "Type Xd transient with its time constant, or Rf and Xlf in table MotorCircuit, or clear the cell.",
        )  # fmt: skip


def _machine_without_data(case: CaseData) -> Iterator[Problem]:
    """What a motor answers to oscillations follows from its data sheet."""
    if case.torque_follows != TorqueFollows.MACHINE:
        return
    for cells, motor in each_row("MotorData", case.motor_data):
        if motor.is_one_way:
            yield cells.wrong(
                "Discharge resistance reverse", motor.discharge_resistance_reverse,
                "blank where TorqueFollows is machine",
                "What the motor answers to small oscillations is not known while its field circuit changes with the sign of "
                "the current. Choose mean speed in TorqueFollows.",
            )  # fmt: skip
            return
    sheets = {m.station for m in case.motor_data}
    missing = [str(name) for name in case.motor_stations if name not in sheets]
    if missing or not case.motor_stations:
        names = ", ".join(f"'{name}'" for name in missing) or "a motor"
        yield SCALARS.wrong(
            "TorqueFollows",
            case.torque_follows,
            "own speed or mean speed where a motor has no data sheet",
            f"Give {names} a row in table MotorData, or choose mean speed.",
        )


def misspelt_motors(case: CaseData) -> set[str]:
    """Stations whose row of table MotorData has probably a wrong name, which is reported there."""
    stations = {s.station for s in case.stations if s.station}
    return probably_meant((m.station for m in case.motor_data), stations)


def _circuits(case: CaseData) -> Iterator[Problem]:
    """Circuits, each of a motor of table MotorData."""
    table = "MotorCircuit"
    motors = {m.station for m in case.motor_data if m.station}
    misspelt = misspelt_motors(case)
    yield from check_names(table, "Station", [c.station for c in case.motor_circuit], "a motor")
    for cells, circuit in each_row(table, case.motor_circuit):
        if circuit.station is not None and circuit.station not in motors | misspelt:
            yield cells.unknown(
                "Station",
                circuit.station,
                "MotorData",
                "Give the motor a row there too, with its Apparent power: it is the base of per unit.",
            )
        yield from cells.numbers(circuit, CIRCUIT_NUMBERS)
        for column in ("Rs", "Xl", "Xmd", "Xmq"):
            if value_of(circuit, column) is None:
                yield cells.blank(column, "a number", "Type it from the maker's circuit.")
        yield from _above_leakage(cells, circuit, "Xl", ("Xmd", "Xmq"))
        for winding in ("f", "kd", "kq", "kd2", "kq2"):
            yield from _pair(cells, circuit, (f"R{winding}", f"Xl{winding}"))
