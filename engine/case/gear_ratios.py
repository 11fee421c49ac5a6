"""Speed ratios of the stations of a train: typed, or carried through shafts and gears to those left blank."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import NamedTuple


class Joint(NamedTuple):
    """Two stations whose speeds have a known ratio."""

    a: str  #: One station.
    b: str  #: The other one.
    ratio: float  #: Speed of b over that of a. [1]
    geared: bool  #: Whether it is a gear mesh.


def station_ratios(
    typed: Mapping[str | None, float | None], joints: Iterable[Joint], reference: str | None
) -> dict[str | None, float]:
    """Speed of each station over that of the reference shaft.

    A blank takes the speed of the nearest typed station on its shaft, else what the gears make of the
    speed of a shaft that is known. What no gear reaches is 1.

    Parameters
    ----------
    typed : mapping of str to (float or None)
        Speed ratio of each station, in the order of their table; None = blank. [1]
    joints : iterable of Joint
        Shafts and couplings, and the meshes whose ratio is stated. [1]
    reference : str or None
        Station of the reference shaft, which is 1 where it is blank. [name]

    Returns
    -------
    dict of str to float
        By station. [1]
    """
    beside: dict[bool, dict[str | None, list[tuple[str, float]]]] = {
        False: defaultdict(list),
        True: defaultdict(list),
    }
    for a, b, ratio, geared in joints:
        beside[geared][a].append((b, ratio))
        beside[geared][b].append((a, 1.0 / ratio))
    ratios: dict[str | None, float] = {}

    def spread(stations: list[str | None], geared: bool) -> list[str | None]:
        """Fill what joins known stations; along shafts as far as they go, through gears once."""
        filled: list[str | None] = []
        for station in stations:
            for other, ratio in beside[geared][station]:
                if other not in ratios and other in typed:
                    ratios[other] = ratios[station] * ratio
                    filled.append(other)
                    if not geared:
                        stations.append(other)
        return filled

    def fill_from(stations: list[str | None]) -> None:
        while stations:  # shafts first: a speed that is typed on a shaft counts for all of it
            spread(stations, False)
            stations = spread(stations, True)

    if reference in typed:
        ratios[reference] = typed[reference] or 1.0
    ratios |= {station: ratio for station, ratio in typed.items() if ratio}
    fill_from(list(ratios))
    for station in typed:
        if station not in ratios:
            ratios[station] = 1.0
            fill_from([station])
    return {station: ratios[station] for station in typed}
