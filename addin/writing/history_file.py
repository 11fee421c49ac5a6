"""The full torque histories of a start in a file beside the workbook: Parquet or NPZ."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from addin.calculation.calculation import Calculation
from addin.xlsx.whole_files import write_whole

#: Kinds of files, which are their endings too.
KINDS = ("parquet", "npz")


class HistoryUnavailable(Exception):
    """The history cannot be written here; the sentence says what to do."""


def history_stems(results: Iterable[str]) -> dict[str, str]:
    """Names of the histories of results that are written together, each its own.

    A history is called after its result without the ending; where two results differ in the ending
    only, after the whole name.
    """
    stems = {name: name[: len(name) - len(Path(name).suffix)] for name in results}
    while True:
        # capitals aside, as not every disk tells them apart
        counts = Counter(stem.casefold() for stem in stems.values())
        shared = [n for n, stem in stems.items() if stem != n and counts[stem.casefold()] > 1]
        if not shared:
            return stems
        stems.update((name, name) for name in shared)


def write_history(
    calculation: Calculation, beside: Path, kind: str, stem: str = ""
) -> tuple[Path, str] | None:
    """Write time, speed and the torque of every element, SI, at every step taken.

    Parameters
    ----------
    calculation : Calculation
        A calculated case. [SI]
    beside : Path
        The result workbook or JSON; the file gets its name with another ending. [path]
    kind : str
        ``parquet`` or ``npz``. [word]
    stem : str
        Its name before ``.history``; empty for that of the result without the ending. [name]

    Returns
    -------
    tuple of (Path, str) or None
        The file and its SHA-256; None if there is no start.

    Raises
    ------
    HistoryUnavailable
        If Parquet is wanted and pyarrow is not installed.
    OSError
        If it cannot be written; one that was there is as before.
    """
    start = calculation.results.start
    if start is None:
        return None
    target = beside.with_name(f"{stem or beside.stem}.history.{kind}")
    trajectory = start.trajectory
    inside = trajectory.time <= start.outcome.time
    columns = {"time_s": trajectory.time[inside], "speed_rad_per_s": trajectory.mean_speed[inside]}
    for element, output in zip(
        calculation.results.train.elements, start.output_of_element, strict=True
    ):
        if output >= 0:
            columns[f"torque_N_m: {element}"] = trajectory.torque[output][inside]
    forces = start.forces
    if forces is not None:
        for name, force in zip(forces.teeth, forces.tooth_force, strict=True):
            columns[f"tooth_force_N: {name}"] = force[inside]
        for name, force in zip(forces.bearings, forces.bearing_force, strict=True):
            columns[f"bearing_force_N: {name}"] = force[inside]
    if kind == "npz":
        write_whole(target, lambda made: np.savez_compressed(made, **columns))  # type: ignore[arg-type]
    else:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise HistoryUnavailable(
                "KeepHistory is parquet, but pyarrow is not installed. Choose npz, or run pip install "
                "-r requirements/parquet.txt in the checkout, or install the wheel with its extra "
                "[parquet]."
            ) from None
        table = pyarrow.table(columns)
        write_whole(target, lambda made: parquet.write_table(table, made, compression="zstd"))
    return target, hashlib.sha256(target.read_bytes()).hexdigest()
