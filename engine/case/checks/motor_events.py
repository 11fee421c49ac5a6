"""Checks of table MotorEvents: what happens to a motor in operation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from engine.case.checks.events import PER_LIFE
from engine.case.checks.motors import misspelt_motors
from engine.case.checks.problem import (
    SCALARS,
    Allowed,
    Cells,
    Limit,
    each_row,
    has_possible_ratings,
    name_of,
    suggestion,
)
from engine.case.choices import Begins, Clearing, InitialState, MotorKind, Scanned
from engine.case.choices import MotorEventKind as Kind
from engine.case.data import TABLED_EVENT, CaseData, MotorCircuitRow, MotorEventRow, value_of
from engine.case.defaults import DEFAULT_LATEST_CLEARING, LONGEST_START
from engine.case.effects.motor_transient import MOTOR_TRANSIENT, has_only_motors_from_data
from engine.errors import Problem

TABLE = "MotorEvents"
#: An open motor may be excited to more than rated voltage; above, per cent were typed. [1]
LARGEST_VOLTAGE = 1.5
#: Faults are cleared, and supplies return, within; above, milliseconds were typed. [s]
LONGEST = 10.0
#: Backup protection trips within; a worst clearing time is looked for until then at most. [s]
LONGEST_SCANNED = 1.0
_ANGLE = Allowed(lambda v: abs(v) <= 2.0 * math.pi, "between -360 and 360 degrees")
NUMBERS = (
    Limit("Phase", _ANGLE, "rad", "It is an angle at line frequency."),
    Limit("Angle", _ANGLE, "rad", "It is the angle of the motor's voltage ahead of the line's."),
    Limit(
        "Residual voltage",
        Allowed(lambda v: 0.0 <= v <= LARGEST_VOLTAGE, f"0 to {LARGEST_VOLTAGE:g} pu"),
        "pu",
        "Per cent and per unit mixed up? Write 60 % or 0.6 pu.",
    ),
    Limit(
        "Clears after",
        Allowed(lambda v: 0.0 < v <= LONGEST, f"above 0 and at most {LONGEST:g} s"),
        "s",
        "It counts from the event, so that nothing clears before it begins; milliseconds typed as seconds? "
        "Write 120 ms or 0.12 s.",
    ),
    Limit(
        "Latest clearing",
        Allowed(lambda v: 0.0 < v <= LONGEST_SCANNED, f"above 0 and at most {LONGEST_SCANNED:g} s"),
        "s",
        "It counts from the event; milliseconds typed as seconds? Write 300 ms or 0.3 s.",
    ),
    Limit(
        "Earliest clearing",
        Allowed(
            lambda v: 0.0 <= v < LONGEST_SCANNED, f"at least 0 and below {LONGEST_SCANNED:g} s"
        ),
        "s",
        "It counts from the event; milliseconds typed as seconds? Write 50 ms or 0.05 s.",
    ),
    Limit(
        "Begins",
        Allowed(
            lambda v: 0.0 < v < LONGEST_START, f"above 0 and below {LONGEST_START:g} s, or running"
        ),
        "s",
        "It counts from the closing of the breaker; milliseconds typed as seconds?",
    ),
    PER_LIFE,
)

#: Columns of which the worst value is looked for where this word stands.
SCANNED = ("Phase", "Angle", "Clears after")


class Takes(NamedTuple):
    """Which columns an event of a kind must have, and which it may have beside."""

    needs: tuple[str, ...] = ()
    may: tuple[str, ...] = ()


COLUMNS = {
    Kind.THREE_PHASE_FAULT: Takes((), ("Residual voltage", "Clears after")),
    Kind.LINE_TO_LINE_FAULT: Takes((), ("Phase", "Residual voltage", "Clears after")),
    Kind.OUT_OF_PHASE_CLOSING: Takes(("Angle",), ("Residual voltage",)),
    Kind.RECLOSING: Takes((), ("Angle", "Residual voltage", "Clears after")),
    Kind.VOLTAGE_DIP: Takes(("Residual voltage",), ("Clears after",)),
    Kind.VOLTAGE_UNBALANCE: Takes(("Residual voltage",), ("Phase", "Clears after")),
}


def check_motor_events(case: CaseData) -> Iterator[Problem]:
    """Names, motors, and what each kind of event needs."""
    others = {row.event for row in case.event_torque}
    if case.torque_time and not case.torque_time_from_rest:
        others.add(TABLED_EVENT)
    first: dict[str, int | None] = {}
    for cells, row in each_row(TABLE, case.motor_events):
        if not row.event:
            yield cells.blank("Event", "the name of an event", "Name it.")
        elif row.event in others or row.event in first:
            where = f"row {first[row.event]}" if row.event in first else "another table"
            yield cells.wrong(
                "Event",
                row.event,
                f"a name used once ({where} has it already)",
                "Rename the event.",
            )
        else:
            first[row.event] = cells.row
        yield from _motor(case, cells, row)
        if row.kind is None:
            yield cells.blank("Kind", "one of " + ", ".join(Kind), "Choose from the list.")
        yield from cells.choice("Kind", row.kind, Kind)
        yield from cells.numbers(row, NUMBERS)
        if row.kind in tuple(Kind):
            takes = COLUMNS[Kind(row.kind)]
            if row.clearing == Clearing.ZEROS and row.kind == Kind.THREE_PHASE_FAULT:
                takes = Takes(takes.needs, (*takes.may, "Phase"))
            if row.in_start is not None:
                takes = Takes(takes.needs, tuple(c for c in takes.may if c not in _OF_OPERATION))
            yield from _columns(cells, row, takes)
            yield from _clearing(cells, row)
            yield from _off_the_line(cells, row)
            yield from _begins(case, cells, row)
    if case.motor_events and has_possible_ratings(case):
        ratings = case.ratings
        if ratings.line_frequency is None or ratings.synchronous_speed is None:
            yield SCALARS.blank(
                "LineFrequency",
                "given where MotorEvents is",
                "Type two of LineFrequency, Poles and SynchronousSpeed: they give the motor's pole pairs.",
            )


def _motor(case: CaseData, cells: Cells, row: MotorEventRow) -> Iterator[Problem]:
    """An event happens to a motor with data, and with a field or the cages of an induction motor."""
    sheets = {m.station: m for m in case.motor_data if m.station}
    circuits = {c.station: c for c in case.motor_circuit}
    if row.station is None:
        yield cells.blank("Station", name_of("MotorData"), "Choose it.")
    elif row.station in misspelt_motors(case):
        return
    elif row.station not in sheets:
        stations = {s.station for s in case.stations}
        action = (
            f"There is no motor data for '{row.station}': type its row in table MotorData."
            if row.station in stations
            else suggestion(row.station, [str(name) for name in sheets])
        )
        yield cells.unknown("Station", row.station, "MotorData", action)
    else:
        sheet, circuit = sheets[row.station], circuits.get(row.station)
        induction = sheet.kind == MotorKind.INDUCTION and (
            circuit is None or _has_equal_axes(circuit)
        )
        # half a field, or an equivalent circuit of the wrong Kind, is reported at its cells
        of_sheet = sheet.xd_transient, sheet.td_0_transient, sheet.td_transient, sheet.r_1
        windings = of_sheet if circuit is None else (circuit.rf, circuit.xlf)
        bare = all(value is None for value in windings)
        if induction and row.is_off_the_line and row.kind != Kind.OUT_OF_PHASE_CLOSING:
            yield cells.wrong(
                "Residual voltage", row.residual_voltage, "blank where Kind in table MotorData is induction",
                "An induction motor off the line has no voltage that stays: clear the cell, for a fault of the motor on "
                "its line.",
            )  # fmt: skip
        elif induction and row.kind == Kind.OUT_OF_PHASE_CLOSING:
            yield cells.wrong(
                "Kind", row.kind, "an event of a motor on its line, where Kind in table MotorData is induction",
                "An induction motor off the line has no voltage to be out of phase. Choose reclosing for one whose "
                "flux has not yet decayed.",
            )  # fmt: skip
        elif bare and not induction and row.in_start is None:
            yield cells.wrong(
                "Station",
                row.station,
                "a motor with a field winding, which keeps it in step, or an induction motor, alike in both axes",
                "Type Xd transient in its row of table MotorData, or Rf and Xlf in MotorCircuit; of an induction motor "
                "choose Kind induction in table MotorData, and type R1, X1, Xm, R2 and X2 there, or the same windings "
                "in both axes in MotorCircuit.",
            )


def _has_equal_axes(circuit: MotorCircuitRow) -> bool:
    """Whether a motor without a field turns steadily under any load: its torque pulsates otherwise."""
    of_d = circuit.xmd, circuit.rkd, circuit.xlkd, circuit.rkd_2, circuit.xlkd_2
    of_q = circuit.xmq, circuit.rkq, circuit.xlkq, circuit.rkq_2, circuit.xlkq_2
    return circuit.rf is None and not circuit.xc and of_d == of_q


def _clearing(cells: Cells, row: MotorEventRow) -> Iterator[Problem]:
    """Zeros of current are those of a fault that clears at a given time."""
    yield from cells.choice("Clearing", row.clearing, Clearing)
    if row.clearing != Clearing.ZEROS:
        return
    if row.kind not in (Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT):
        yield cells.problem(
            "Clearing", row.clearing, f"blank for a {row.kind}",
            f"no fault is cleared in a {row.kind}. Clear the cell.",
        )  # fmt: skip
    elif row.clears_after is None:
        yield cells.blank(
            "Clears after",
            "given where Clearing is zeros of current",
            "Type when the breaker opens.",
        )
    elif row.clears_after == Scanned.WORST:
        yield cells.wrong(
            "Clears after", row.clears_after, "a number where Clearing is zeros of current",
            "Torques jump with the instant where another zero comes next, so that nothing is known between instants that are "
            "tried: type one a row of this table, some in a period of the line, or choose Clearing at once.",
        )  # fmt: skip


def _off_the_line(cells: Cells, row: MotorEventRow) -> Iterator[Problem]:
    """A fault of a motor off its line has nothing to clear to."""
    if (
        row.kind != Kind.OUT_OF_PHASE_CLOSING
        and row.is_off_the_line
        and row.clears_after is not None
    ):
        yield cells.wrong(
            "Clears after", row.clears_after, "blank for a fault where Residual voltage is given",
            "The motor is off the line then, and no line returns. Clear one of the two cells.",
        )  # fmt: skip


#: What an event in a start does not take: rotor and line turn with unlike frequencies, and the motor is on the line.
_OF_OPERATION = ("Angle", "Residual voltage")
#: Kinds of which the residual voltage is that of the motor off the line.
_OF_THE_MOTOR = (Kind.RECLOSING, Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT)


def _begins(case: CaseData, cells: Cells, row: MotorEventRow) -> Iterator[Problem]:
    """An event in the start needs one with the motor's fluxes in time."""
    yield from cells.choice("Begins", _word(row, "Begins"), Begins, "a number, or running")
    if row.in_start is None:
        return
    if row.kind == Kind.OUT_OF_PHASE_CLOSING:
        yield cells.wrong(
            "Begins", row.begins, f"blank or running for a {row.kind}",
            "The motor of a start is closed already: choose reclosing, or clear the cell.",
        )  # fmt: skip
    elif case.initial_state == InitialState.RUNNING:
        yield cells.wrong(
            "Begins", row.begins, "blank or running where InitialState is running",
            "There is no start in which it could begin: clear the cell, or InitialState.",
        )  # fmt: skip
    elif not has_only_motors_from_data(case):
        assert MOTOR_TRANSIENT.inputs is not None
        yield cells.wrong(
            "Begins", row.begins, "blank or running without the fluxes of every motor in the start",
            f"It needs {MOTOR_TRANSIENT.inputs.cells}. Fill and clear these, or clear the cell.",
        )  # fmt: skip
    elif case.looks_for_worst_phase and len(row.scanned) > 1:
        yield cells.wrong(
            "Phase", row.phase, "a number where Clears after and PulsationPhase are worst",
            "Each combination is a start of its own, and those of all three are too many: type a number in one of the three "
            "cells, such as Worst phase of table EventPeaks with the other two.",
        )  # fmt: skip
    elif case.maximum_time is not None and row.in_start >= case.maximum_time:
        yield cells.wrong(
            "Begins", row.begins, f"below MaximumTime, {case.maximum_time:g} s",
            "The start is followed no longer: raise MaximumTime, or type a shorter time.",
        )  # fmt: skip


def _word(row: MotorEventRow, column: str) -> str | None:
    value = value_of(row, column)
    return value if isinstance(value, str) else None


def _columns(cells: Cells, row: MotorEventRow, takes: Takes) -> Iterator[Problem]:
    for column in ("Phase", "Angle", "Residual voltage", "Clears after"):
        value = value_of(row, column)
        if value is None and column in takes.needs:
            yield cells.blank(column, f"given for a {row.kind}", "Type it.")
        elif value is not None and column not in (*takes.needs, *takes.may):
            yield cells.problem(
                column,
                value,
                f"blank for a {row.kind}",
                f"it has no effect on a {row.kind}. Clear the cell.",
            )
    for column in SCANNED:
        yield from cells.choice(column, _word(row, column), Scanned, "a number, or worst")
    if row.clears_after != Scanned.WORST:
        for column in ("Earliest clearing", "Latest clearing"):
            value = value_of(row, column)
            if value is not None:
                yield cells.problem(
                    column,
                    value,
                    "blank where Clears after is not worst",
                    "it has no effect unless Clears after is worst. Type worst there, or clear the cell.",
                )
    elif (row.earliest_clearing or 0.0) >= (row.latest_clearing or DEFAULT_LATEST_CLEARING):
        latest = row.latest_clearing or DEFAULT_LATEST_CLEARING
        yield cells.wrong(
            "Earliest clearing",
            row.earliest_clearing,
            f"below Latest clearing, {latest:g} s",
            "The worst Clears after is looked for between the two. Correct one of them.",
        )
    if row.residual_voltage == 0.0 and row.kind in (*_OF_THE_MOTOR, Kind.OUT_OF_PHASE_CLOSING):
        action = "Without voltage there is no angle: type a small one."
        if row.kind not in (Kind.RECLOSING, Kind.OUT_OF_PHASE_CLOSING):
            action = "It is the motor's own before the fault, off the line: clear the cell for a motor on its line."
        yield cells.wrong("Residual voltage", 0.0, "above 0 pu", action)
