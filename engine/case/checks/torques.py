"""Checks of torque curves and of the excitations in continuous operation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from engine.case.checks.problem import (
    ANY_NUMBER,
    NOT_NEGATIVE,
    POSITIVE,
    SCALARS,
    VOLTAGE,
    Allowed,
    Cells,
    Limit,
    blank_or_positive,
    check_names,
    each_row,
    number_text,
    possible_poles,
    probably_meant,
    quote_quantity,
)
from engine.case.choices import ElementKind
from engine.case.data import GROUND, TABLES, CaseData, value_of
from engine.errors import Problem

#: Pole pairs nearer to a whole number than this share are whole: the ratio of a gear is rounded. [1]
WHOLE_PAIRS = 2e-3
#: A torque curve reaches at most this multiple of synchronous speed.
TOP_SPEED = 3.0
CURVE_SPEED = Limit(
    "Speed",
    Allowed(
        lambda v: v <= TOP_SPEED,
        f"at most {TOP_SPEED:g} ({100 * TOP_SPEED:g} %) of synchronous speed",
    ),
    "",
    "Write 50 % or 900 rpm (in a workbook the unit stands above the header); a plain number in JSON is a fraction of "
    "synchronous speed.",
)
PULSATING = Limit("Pulsating", NOT_NEGATIVE, "N m")
PULSATION1 = Limit("Pulsation1", NOT_NEGATIVE, "N m")
PHASE = Limit(
    "Phase",
    Allowed(lambda v: abs(v) <= 4.0 * math.pi, "between -720 and 720 degrees"),
    "rad",
    "It is an angle; degrees typed as radians?",
)
LOAD = Limit(
    "Torque", NOT_NEGATIVE, "N m", "Load torque opposes the motion: type a positive value."
)
EXCITATION_NUMBERS = (
    Limit("Order", POSITIVE),
    Limit("Frequency", POSITIVE, "Hz"),
    Limit("Torque", POSITIVE, "N m"),
)


def _curve(case: CaseData, table: str, abscissa: str, columns: Sequence[str]) -> Iterator[Problem]:
    """One curve a station: known stations, no blanks, abscissa strictly rising."""
    stations = {s.station for s in case.stations if s.station}
    last: dict[str, tuple[Cells, float]] = {}
    for cells, point in each_row(table, getattr(case, TABLES[table][0])):
        yield from cells.name("Station", point.station, stations, "Stations")
        x = value_of(point, abscissa)
        if x is None:
            yield cells.blank(abscissa, "a number", "Fill it or clear the whole row.")
        elif not math.isfinite(x) or x < 0:
            yield cells.wrong(abscissa, x, "zero or positive", "Correct the cell.")
        elif point.station in last and x <= last[point.station][1]:
            before, previous = last[point.station]
            yield cells.wrong(
                abscissa,
                x,
                f"above {previous:.6g} of row {before.row}",
                f"The rows of '{point.station}' must be in rising order, without repeated values"
                + (" (for a step, two rows a microsecond apart)." if abscissa == "Time" else "."),
                quoted=quote_quantity(previous, "", (*before, abscissa)),
            )
        elif point.station is not None:
            last[point.station] = (cells, x)
        for column in columns:
            value = value_of(point, column)
            if value is None:
                yield cells.blank(column, "a number", "Fill it (0 where there is none).")
            yield from cells.number(value, Limit(column, ANY_NUMBER))


def _single_points(case: CaseData, table: str, abscissa: str) -> Iterator[Problem]:
    """Stations with one row only, where one point makes no curve."""
    rows = getattr(case, TABLES[table][0])
    stations = [point.station for point in rows]
    misspelt = probably_meant(stations, {s.station for s in case.stations if s.station})
    for cells, point in each_row(table, rows):
        name = point.station
        if name is not None and stations.count(name) == 1 and name not in misspelt:
            yield cells.problem(
                "Station",
                point.station,
                "on two or more rows",
                f"found one row only for '{point.station}': a curve needs two points or more. "
                f"Add rows of other {abscissa.lower()}s.",
            )


def _every_row_or_none(case: CaseData, column: str) -> Iterator[Problem]:
    """A column of MotorTorque that is optional, but for a whole station."""
    values = [value_of(point, column) for point in case.motor_torque]
    given = {p.station for p, v in zip(case.motor_torque, values, strict=True) if v is not None}
    for cells, point in each_row("MotorTorque", case.motor_torque):
        if point.station in given and value_of(point, column) is None:
            given.remove(point.station)  # told once
            yield cells.blank(
                column,
                f"given in every row of '{point.station}', or in none",
                "Type it, or clear the column.",
            )


def _phases(case: CaseData) -> Iterator[Problem]:
    """Phases without jumps of a whole turn."""
    before: dict[str | None, tuple[Cells, float]] = {}
    for cells, point in each_row("MotorTorque", case.motor_torque):
        phase = point.phase
        if phase is None or not math.isfinite(phase):
            continue  # reported already
        if point.station in before and abs(phase - before[point.station][1]) > math.pi:
            above, last = before[point.station]
            yield cells.wrong(
                "Phase",
                phase,
                f"within 180 degrees of {number_text(last, 'rad')} of row {above.row}",
                "Between rows it is interpolated: add or take away 360 degrees, or type the speeds between.",
                "rad",
                quote_quantity(last, "rad", (*above, "Phase")),
            )
        before[point.station] = cells, phase


def check_torques(case: CaseData) -> Iterator[Problem]:
    """Torque curves of motors and loads, torques against time, and what a motor needs."""
    yield from _curve(case, "MotorTorque", "Speed", ("Average", "Pulsating"))
    yield from _curve(case, "LoadTorque", "Speed", ("Torque",))
    yield from _curve(case, "TorqueTime", "Time", ("Torque",))
    yield from _single_points(case, "MotorTorque", "Speed")
    yield from _single_points(case, "TorqueTime", "Time")
    yield from _supply(case)
    for cells, motor in each_row("MotorTorque", case.motor_torque):
        yield from cells.numbers(motor, (CURVE_SPEED, PULSATING, PHASE, PULSATION1))
    for column in ("Phase", "Pulsation1"):
        yield from _every_row_or_none(case, column)
    yield from _phases(case)
    for cells, load in each_row("LoadTorque", case.load_torque):
        yield from cells.numbers(load, (CURVE_SPEED, LOAD))
    yield from _motor_place(case)
    if not (blank_or_positive(case.line_frequency) and blank_or_positive(case.synchronous_speed)):
        return  # reported already
    if not possible_poles(case):
        return
    ratings = case.ratings
    if case.motor_stations and ratings.synchronous_speed is None:
        yield SCALARS.problem(
            "SynchronousSpeed",
            None,
            f"given where {_motor_table(case)} is",
            f"{'torque curves are' if case.motor_torque else 'a data sheet of a motor is'} given, but neither SynchronousSpeed nor LineFrequency with Poles, "
            "so that the speed scale of the curves is unknown. Type two of LineFrequency, "
            "SynchronousSpeed and Poles.",
        )
    elif case.motor_stations and ratings.line_frequency is None:
        yield SCALARS.problem(
            "LineFrequency",
            None,
            f"given where {_motor_table(case)} is",
            "a motor is given, but no LineFrequency (or Poles): the slip frequency is unknown. "
            "Type LineFrequency.",
        )
    yield from _pole_pairs(case)


def _supply(case: CaseData) -> Iterator[Problem]:
    """Voltage against speed, of stations with a motor."""
    table = "SupplyVoltage"
    yield from _curve(case, table, "Speed", ("Voltage",))
    yield from _single_points(case, table, "Speed")
    without_motor = {s.station for s in case.stations} - set(case.motor_stations)
    for cells, row in each_row(table, case.supply_voltage):
        yield from cells.numbers(row, (CURVE_SPEED, VOLTAGE))
        if row.station in without_motor:
            without_motor.remove(row.station)  # told once
            yield cells.wrong(
                "Station",
                row.station,
                "a station with a motor",
                "Give its torque curve in MotorTorque or its data sheet in MotorData, or clear the row.",
            )


def _motor_table(case: CaseData) -> str:
    """The table that says that there is a motor."""
    return "MotorTorque" if case.motor_torque else "MotorData"


def _pole_pairs(case: CaseData) -> Iterator[Problem]:
    """Every motor turns with whole pole pairs at its own synchronous speed."""
    line, synchronous = case.ratings.line_frequency, case.ratings.synchronous_speed
    if not line or not synchronous:
        return
    motors, ratios = case.motor_stations, case.speed_ratios
    for cells, s in each_row("Stations", case.stations):
        ratio = ratios[s.station]
        if s.station not in motors or ratio <= 0.0:
            continue
        if ratio == 1.0:  # as Poles say; their disagreement is reported by the ratings
            continue
        pairs = 2.0 * math.pi * line / (synchronous * ratio)
        if abs(pairs - max(round(pairs), 1)) > WHOLE_PAIRS * pairs:
            rpm = 30.0 * synchronous * ratio / math.pi
            yield cells.problem(
                "Speed ratio",
                s.speed_ratio,
                "such that the motor has whole pole pairs",
                f"found {number_text(ratio)} at '{s.station}', which has a motor: at "
                f"{rpm:.6g} rpm and {line:.6g} Hz it would have {pairs:.4g} pole pairs. Correct the "
                f"ratio, or the station in table {_motor_table(case)}.",
            )


def _motor_place(case: CaseData) -> Iterator[Problem]:
    """A motor on the reference shaft, and a train it can turn."""
    motors = case.motor_stations
    placed = [place for place in each_row("Stations", case.stations) if place[1].station in motors]
    if placed and all(s.speed_ratio not in (None, 1.0) for _, s in placed):
        cells, s = placed[0]
        yield cells.problem(
            "Speed ratio",
            s.speed_ratio,
            "1 (or blank) at a motor",
            f"found {number_text(s.speed_ratio)} at '{s.station}', the station of the motor. The "
            "motor shaft is the reference of SynchronousSpeed and of all speed ratios: type 1 "
            "there and refer the other ratios to it.",
        )
    for cells, e in each_row("Elements", case.elements):
        grounded = e.kind == ElementKind.SPRING_TO_GROUND or GROUND in (e.from_, e.to)
        if placed and grounded and (e.stiffness is None or e.stiffness > 0):
            yield cells.problem(
                "From" if e.from_ == GROUND else "To",
                GROUND,
                "a station, where a motor is to start the train",
                f"found ground: '{e.element}' holds the train to ground, so its motor (table "
                f"{_motor_table(case)}) cannot start it. Clear the element or the motor's rows; a damper "
                "to ground has Stiffness 0.",
            )


def check_excitations(case: CaseData) -> Iterator[Problem]:
    """What shakes the train in continuous operation."""
    table = "Excitations"
    yield from check_names(table, "Name", [x.name for x in case.excitations], "an excitation")
    stations = {s.station for s in case.stations if s.station}
    for cells, x in each_row(table, case.excitations):
        if (x.order is None) == (x.frequency is None):
            yield cells.problem(
                "Order",
                "both" if x.order is not None else None,
                "either an Order or a Frequency",
                "an excitation needs either an Order (multiple of a shaft speed) or a "
                "Frequency. Fill exactly one of the two.",
            )
        yield from cells.numbers(x, EXCITATION_NUMBERS)
        yield from cells.number(x.torque_share, Limit("Torque", POSITIVE))
        if x.torque is not None and x.torque_share is not None:
            yield cells.problem(
                "Torque",
                x.torque,
                "a torque or a share of the torque there",
                f"found both {number_text(x.torque, 'N m')} and a share of {number_text(x.torque_share)} "
                "of the transmitted torque. Keep one of the two.",
            )
        for column, name in (("Of station", x.of_station), ("Station", x.station)):
            if name is not None:
                yield from cells.name(column, name, stations, "Stations")
