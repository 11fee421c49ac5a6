"""Checks of torque curves and of the excitations in continuous operation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from engine.case.checks.problem import (
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    blank_cell,
    blank_or_positive,
    check_names,
    check_number,
    check_station,
    number_text,
    possible_poles,
    wrong_value,
)
from engine.case.choices import ElementKind
from engine.case.data import GROUND, CaseData
from engine.errors import Problem

#: A torque curve reaches at most this multiple of synchronous speed.
TOP_SPEED = 3.0


def _curve(
    case: CaseData,
    table: str,
    rows: Sequence[Any],
    abscissa: str,
    header: str,
    values: Sequence[tuple[str, str]],
) -> Iterator[Problem]:
    """One curve a station: known stations, no blanks, abscissa strictly rising."""
    last: dict[str, tuple[int, float]] = {}
    for row, point in enumerate(rows, start=1):
        yield from check_station(case, table, row, point.station)
        x = getattr(point, abscissa)
        if x is None:
            yield blank_cell(table, row, header, "a number", "Fill it or clear the whole row.")
        elif not math.isfinite(x) or x < 0:
            yield wrong_value(table, row, header, x, "zero or positive", "Correct the cell.")
        elif point.station in last and x <= last[point.station][1]:
            before, previous = last[point.station]
            yield wrong_value(
                table,
                row,
                header,
                x,
                f"above {previous:.6g} of row {before}",
                f"The rows of '{point.station}' must be in rising order, no value twice"
                + (" (for a step, two rows a microsecond apart)." if header == "Time" else "."),
            )
        elif point.station is not None:
            last[point.station] = (row, x)
        for column, key in values:
            value = getattr(point, key)
            if value is None:
                yield blank_cell(table, row, column, "a number", "Fill it (0 where there is none).")
            elif not math.isfinite(value):
                yield wrong_value(table, row, column, value, "a finite number", "Correct the cell.")


def _single_points(table: str, rows: Sequence[Any], header: str) -> Iterator[Problem]:
    """Stations with one row only, where one point makes no curve."""
    stations = [point.station for point in rows]
    for row, station in enumerate(stations, start=1):
        if station is not None and stations.count(station) == 1:
            yield Problem(
                table,
                row,
                "Station",
                station,
                "on two or more rows",
                f"found one row only for '{station}': a curve needs two points or more. "
                f"Add rows of other {header.lower()}s.",
            )


def check_torques(case: CaseData) -> Iterator[Problem]:
    """Torque curves of motors and loads, torques against time, and what a motor needs."""
    yield from _curve(
        case,
        "MotorTorque",
        case.motor_torque,
        "speed",
        "Speed",
        (("Average", "average"), ("Pulsating", "pulsating")),
    )
    yield from _curve(
        case, "LoadTorque", case.load_torque, "speed", "Speed", (("Torque", "torque"),)
    )
    yield from _curve(case, "TorqueTime", case.torque_time, "time", "Time", (("Torque", "torque"),))
    yield from _single_points("MotorTorque", case.motor_torque, "Speed")
    yield from _single_points("TorqueTime", case.torque_time, "Time")
    speeds = [("MotorTorque", row, p.speed) for row, p in enumerate(case.motor_torque, start=1)]
    speeds += [("LoadTorque", row, p.speed) for row, p in enumerate(case.load_torque, start=1)]
    for table, row, speed in speeds:
        if speed is not None:
            yield from check_number(
                table,
                row,
                "Speed",
                speed,
                Allowed(
                    lambda v: v <= TOP_SPEED,
                    f"at most {TOP_SPEED:g} ({100 * TOP_SPEED:g} %) of synchronous speed",
                ),
                "",
                "Write 50 % or 900 rpm; a plain number in JSON is a fraction of synchronous speed.",
            )
    for row, motor in enumerate(case.motor_torque, start=1):
        yield from check_number(
            "MotorTorque",
            row,
            "Pulsating",
            motor.pulsating,
            NOT_NEGATIVE,
            "N m",
        )
    for row, load in enumerate(case.load_torque, start=1):
        yield from check_number(
            "LoadTorque",
            row,
            "Torque",
            load.torque,
            NOT_NEGATIVE,
            "N m",
            "A load opposes the motion: type its size.",
        )
    yield from _motor_place(case)
    if not (blank_or_positive(case.line_frequency) and blank_or_positive(case.synchronous_speed)):
        return  # reported already
    if not possible_poles(case):
        return
    ratings = case.ratings
    if case.motor_torque and ratings.synchronous_speed is None:
        yield Problem(
            "Case",
            None,
            "SynchronousSpeed",
            None,
            "given where MotorTorque is",
            "torque curves are given, but neither SynchronousSpeed nor LineFrequency with Poles: "
            "the curves have no speed. Type two of LineFrequency, SynchronousSpeed and Poles.",
        )
    elif case.motor_torque and ratings.line_frequency is None:
        yield Problem(
            "Case",
            None,
            "LineFrequency",
            None,
            "given where MotorTorque is",
            "a motor is given, but no LineFrequency (or Poles): the slip frequency is unknown. "
            "Type it.",
        )


def _motor_place(case: CaseData) -> Iterator[Problem]:
    """A motor on the reference shaft, and a train it can turn."""
    motors = {p.station for p in case.motor_torque}
    placed = [(row, s) for row, s in enumerate(case.stations, start=1) if s.station in motors]
    if placed and all(s.speed_ratio not in (None, 1.0) for _, s in placed):
        row, s = placed[0]
        yield Problem(
            "Stations",
            row,
            "Speed ratio",
            s.speed_ratio,
            "1 (or blank) at a motor",
            f"found {number_text(s.speed_ratio)} at '{s.station}', where the motor acts: its shaft is "
            "the reference shaft, to which SynchronousSpeed and all speed ratios refer. Type 1 "
            "there and the other ratios to it.",
        )
    for row, e in enumerate(case.elements, start=1):
        grounded = e.kind == ElementKind.SPRING_TO_GROUND or GROUND in (e.from_, e.to)
        if placed and grounded and (e.stiffness is None or e.stiffness > 0):
            yield Problem(
                "Elements",
                row,
                "From" if e.from_ == GROUND else "To",
                GROUND,
                "a station, where a motor is to start the train",
                f"found ground: '{e.element}' holds the train, so that its motor (table "
                "MotorTorque) cannot start it. Clear the element or the motor's rows; a damper "
                "to ground has Stiffness 0.",
            )


def check_excitations(case: CaseData) -> Iterator[Problem]:
    """What shakes the train in continuous operation."""
    table = "Excitations"
    yield from check_names(table, "Name", [x.name for x in case.excitations], "an excitation")
    for row, x in enumerate(case.excitations, start=1):
        if (x.order is None) == (x.frequency is None):
            typed = "both" if x.order is not None else None
            yield Problem(
                table,
                row,
                "Order",
                typed,
                "either an Order or a Frequency",
                "an excitation needs either an Order (multiple of a shaft speed) or a Frequency, "
                "not both and not "
                "neither. Fill one of the two.",
            )
        yield from check_number(table, row, "Order", x.order, POSITIVE)
        yield from check_number(table, row, "Frequency", x.frequency, POSITIVE, "Hz")
        yield from check_number(table, row, "Torque", x.torque, POSITIVE, "N m")
        yield from check_number(table, row, "Torque", x.torque_share, POSITIVE)
        if x.torque is not None and x.torque_share is not None:
            yield Problem(
                table,
                row,
                "Torque",
                x.torque,
                "a torque or a share of the torque there",
                f"found both {number_text(x.torque, 'N m')} and a share of {number_text(x.torque_share)} "
                "of the transmitted torque. Keep one of the two.",
            )
        for column, name in (("Of station", x.of_station), ("Station", x.station)):
            if name is not None:
                yield from check_station(case, table, row, name, column)
