"""What a case cannot answer yet, and which input is missing for it.

A case without errors may still say little: without a torque curve there is no start, without S-N
points there are no starts to count. Nothing is calculated here; the conditions are those of the
analyses.
"""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.choices import ElementKind
from engine.case.coverage import (
    links,
    listed,
    shafts,
    without_peak_limit,
    without_sn_points,
    without_vibratory_limit,
    without_yield,
)
from engine.case.data import CaseData


def missing_inputs(case: CaseData) -> tuple[str, ...]:
    """Answers that cannot be given, in the order in which they are asked.

    Parameters
    ----------
    case : CaseData
        A case without errors. [SI]

    Returns
    -------
    tuple of str
        A sentence an answer with the input that is missing; empty if all can be given.
    """
    return (*_operation(case), *_start(case))


def _operation(case: CaseData) -> Iterator[str]:
    """Frequencies, margins and forced response."""
    if not case.elements:
        yield (
            "No natural frequencies, no separation margins and no forced response: table Elements is "
            "empty."
        )
    elif not _is_excited(case):
        yield (
            "No separation margins and no forced response: without a speed or a line frequency "
            "nothing excites the train. Type two of LineFrequency, Poles and SynchronousSpeed."
        )
    elif not _has_torque(case):
        yield (
            "No forced response: the transmitted torque is unknown. Give RatedPower or RatedTorque, a Running "
            "load in table Stations, a Torque in table Excitations, or table LoadTorque."
        )
    elif open_ := without_vibratory_limit(case, [*shafts(case), *links(case)]):
        yield (
            f"Not judged in continuous operation: {listed(open_)}. Type a Stress diameter and a Material "
            "with UTS, or a Vibratory limit."
        )


def _is_excited(case: CaseData) -> bool:
    """Whether any excitation has a frequency: its own, or an order of a known speed."""
    speeds = (case.ratings.synchronous_speed, case.minimum_speed, case.maximum_speed)
    turns = any(speed is not None for speed in speeds)
    if not case.excitations:
        return turns or case.ratings.line_frequency is not None
    return any(row.frequency is not None or turns for row in case.excitations)


def _has_torque(case: CaseData) -> bool:
    return bool(
        case.ratings.rated_torque
        or any(row.running_load for row in case.stations)
        or any(row.torque for row in case.excitations)
        or any(row.torque for row in case.load_torque)
    )


def _start(case: CaseData) -> Iterator[str]:
    """The start, reversals and the number of starts."""
    if not case.motor_stations and not case.torque_time_from_rest:
        yield (
            "No start: tables MotorTorque and TorqueTime are empty, so there are no start-up peaks, "
            "no torque reversals and no allowable starts."
        )
        return
    if open_ := without_peak_limit(case):
        yield f"Peak torque not judged: {listed(open_)}. Type a Peak torque limit."
    if open_ := without_yield(case):
        yield (
            f"Shear yield in the start not judged: {listed(open_)}. Type a Stress diameter and a Material "
            "with Yield, or a Peak torque limit."
        )
    in_meshes = {row.element for row in case.meshes}
    toothed = [
        row
        for row in case.elements
        if row.kind == ElementKind.GEAR_MESH or row.element in in_meshes
    ]
    if open_ := [str(row.element) for row in toothed if row.reversal_limit is None]:
        yield f"A torque reversal, if there is one, not judged: {listed(open_)}. Type a Reversal limit."
    given = {
        row.element
        for row in case.meshes
        if row.backlash is not None or row.angular_backlash is not None
    }
    if open_ := [str(row.element) for row in toothed if row.element not in given]:
        yield (
            f"Peaks and starts, if the torque reverses, not judged: {listed(open_)}. Type its Backlash or "
            "Angular backlash."
        )
    if open_ := without_sn_points(case):
        yield (
            f"Allowable starts not judged: {listed(open_)}. Type a Stress diameter and a Material with "
            "S-N points."
        )
    if case.starts_required is None:
        yield "No verdict on allowable starts: StartsRequired is blank."
