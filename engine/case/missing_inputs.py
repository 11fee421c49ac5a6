"""What a case cannot answer yet, and which input is missing for it.

A case without errors may still say little: without a torque curve there is no start, without S-N
points there are no starts to count. Nothing is calculated here; the conditions are those of the
analyses.
"""

from __future__ import annotations

from collections.abc import Iterator

from engine.case.choices import ElementKind
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
    elif missing := _missing_for_stress(case, "UTS"):
        yield f"No stress judged in continuous operation: {missing}."


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


def _missing_for_stress(case: CaseData, what: str) -> str:
    """Which input keeps every element from being judged; empty if one can be."""
    if what == "UTS":
        with_data = {row.material for row in case.materials if row.uts}
        needed = "the UTS of its Material in table Materials"
    else:
        with_data = {row.material for row in case.sn_points}
        needed = "points of its Material in table SNPoints"
    with_diameter = [row for row in case.elements if row.stress_diameter]
    if any(row.material in with_data for row in with_diameter):
        return ""
    if not with_diameter:
        return "no element has a Stress diameter"
    if all(row.material is None for row in with_diameter):
        return "no element with a Stress diameter has a Material"
    return f"no element with a Stress diameter has {needed}"


def _start(case: CaseData) -> Iterator[str]:
    """The start, reversals and the number of starts."""
    if not case.motor_torque and not case.torque_time:
        yield (
            "No start: tables MotorTorque and TorqueTime are empty, so there are no start-up peaks, "
            "no torque reversals and no allowable starts."
        )
        return
    meshes = [row for row in case.elements if row.kind == ElementKind.GEAR_MESH]
    if meshes and not any(row.reversal_limit is not None for row in case.elements):
        yield "No verdict on a torque reversal: no element has a Reversal limit."
    if missing := _missing_for_stress(case, "S-N"):
        yield f"No allowable starts: {missing}."
    elif case.starts_required is None:
        yield "No verdict on allowable starts: StartsRequired is blank."
