"""Trains whose stations stand in one row, as the formats of other programs have them."""

from __future__ import annotations

from collections.abc import Iterator

from addin.exchange.foreign import ForeignError
from engine.case.case import Case
from engine.case.data import GROUND, ElementRow


def chain_of(case: Case, what: str) -> list[tuple[str | None, ElementRow, bool]]:
    """Stations of a train in a row, each with the element that leads to it and whether that runs From → To.

    Parameters
    ----------
    case : Case
        The train. [SI]
    what : str
        What can hold no other train. [words]

    Returns
    -------
    list of (str, ElementRow, bool)
        The first has a row that leads nowhere.

    Raises
    ------
    ForeignError
        If the train has branches or an end at ground.
    """
    beside: dict[str | None, list[ElementRow]] = {s.station: [] for s in case.stations}
    for e in case.elements:
        if GROUND in (e.from_, e.to) or e.to is None:
            raise ForeignError(
                f"{what} has no ground, but '{e.element}' leads there. Leave it out."
            )
        beside[e.from_].append(e)
        beside[e.to].append(e)
    branch = next((name for name, own in beside.items() if len(own) > 2), None)
    if branch is not None or len(case.elements) >= len(case.stations):
        raise ForeignError(
            f"{what} has one row of stations without branches, but more than two elements meet at "
            f"'{branch or case.stations[0].station}'. Export a table of text (.csv) instead."
        )
    at = next((name for name, own in beside.items() if len(own) < 2), None)
    order: list[tuple[str | None, ElementRow, bool]] = [(at, ElementRow(), True)]
    while onward := [e for e in beside[at] if e is not order[-1][1]]:
        forward = onward[0].from_ == at
        at = onward[0].to if forward else onward[0].from_
        order.append((at, onward[0], forward))
    return order


def not_written(case: Case) -> Iterator[str]:
    """What a file of masses and shafts has no place for.

    Parameters
    ----------
    case : Case
        The train. [SI]

    Returns
    -------
    iterator of str
        Only what this train has. [sentences]
    """
    if any(e.loss_factor for e in case.elements) or case.mode_damping or case.damping_ratio:
        yield "Loss factors and damping ratios of modes are not written."
    if case.motor_stations or case.load_torque or case.excitations:
        yield "Torques, excitations, materials and limits are not written."
