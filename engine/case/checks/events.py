"""Checks of events in operation: table EventTorque, and TorqueTime where the train runs before it."""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    COUNTS,
    NOT_NEGATIVE,
    POSITIVE,
    SCALARS,
    Limit,
    each_row,
    has_possible_ratings,
)
from engine.case.choices import ElementKind, TorqueBase
from engine.case.data import GROUND, TABLED_EVENT, CaseData
from engine.errors import Problem

TABLE = "EventTorque"
PER_LIFE = Limit("Per life", COUNTS, action="Type the number of such events.")
NUMBERS = (
    Limit("Amplitude", ANY_NUMBER),
    Limit(
        "Multiple",
        NOT_NEGATIVE,
        "",
        "It is a multiple of the line frequency, 0 for a torque that does not oscillate; give the "
        "Amplitude its sign instead.",
    ),
    Limit("Phase", ANY_NUMBER, "rad"),
    Limit("Time constant", POSITIVE, "s", "Leave the cell blank if the torque does not decay."),
    PER_LIFE,
)


def check_events(case: CaseData) -> Iterator[Problem]:
    """Terms of each event, what they are shares and multiples of, and a train that runs."""
    stations = {s.station for s in case.stations if s.station}
    motors = {m.station for m in case.motor_data if m.station}
    counted: dict[str | None, int | None] = {}
    for cells, row in each_row(TABLE, case.event_torque):
        if not row.event:
            yield cells.blank("Event", "the name of an event", "Name it: rows of one name add up.")
        elif row.event == TABLED_EVENT and case.torque_time and not case.torque_time_from_rest:
            allowed = "another name (table TorqueTime is the event of this name)"
            yield cells.wrong("Event", row.event, allowed, "Rename the event.")
        yield from cells.name("Station", row.station, stations, "Stations")
        if row.amplitude is None:
            yield cells.blank(
                "Amplitude",
                "a number",
                "Type the torque over RatedTorque, with its sign, or clear the whole row.",
            )
        yield from cells.numbers(row, NUMBERS)
        yield from cells.choice("Base", row.base, TorqueBase)
        if row.base == TorqueBase.APPARENT_POWER and row.station not in motors:
            yield cells.wrong(
                "Base",
                row.base,
                "rated torque where the station has no row in table MotorData",
                "Type the motor's Apparent power there, or Amplitude as a share of the rated torque: it is smaller than "
                "the apparent power by power factor and efficiency.",
            )
        first = counted.setdefault(row.event, cells.row) if row.per_life is not None else cells.row
        if first != cells.row:
            yield cells.wrong(
                "Per life", row.per_life, f"in one row of the event (row {first} has it already)",
                "Clear one of the two cells.",
            )  # fmt: skip
    yield from _missing_base(case)
    if case.event_names:
        yield from _held_train(case)


def _missing_base(case: CaseData) -> Iterator[Problem]:
    """Rated torque, and line frequency, that the terms are shares and multiples of."""
    if not has_possible_ratings(case):
        return
    of_torque = any(row.base != TorqueBase.APPARENT_POWER for row in case.event_torque)
    if of_torque and case.ratings.rated_torque is None:
        yield SCALARS.blank(
            "RatedTorque",
            "given where EventTorque is",
            "Type RatedTorque or RatedPower: Amplitude is a share of it, unless Base says otherwise.",
        )
    if not of_torque and case.event_torque and case.ratings.synchronous_speed is None:
        yield SCALARS.blank(
            "SynchronousSpeed",
            "given where Base of EventTorque is apparent power",
            "Type it, or LineFrequency and Poles: the torque is the apparent power over the speed.",
        )
    if any(row.multiple for row in case.event_torque) and case.ratings.line_frequency is None:
        yield SCALARS.blank(
            "LineFrequency",
            "given where EventTorque has a Multiple",
            "Type LineFrequency: Multiple is a multiple of it.",
        )


def _held_train(case: CaseData) -> Iterator[Problem]:
    """A train that is held to ground does not run."""
    for cells, e in each_row("Elements", case.elements):
        grounded = e.kind == ElementKind.SPRING_TO_GROUND or GROUND in (e.from_, e.to)
        if grounded and (e.stiffness is None or e.stiffness > 0):
            yield cells.problem(
                "From" if e.from_ == GROUND else "To",
                GROUND,
                "a station, where an event in operation is given",
                f"found ground: '{e.element}' holds the train to ground, so it does not run. Clear the "
                "element, or table EventTorque and InitialState.",
            )
