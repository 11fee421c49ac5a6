"""What the workbook shows of a run, gathered once from the engine's results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from addin.contract.result_tables import SHARE_MODES
from engine.case.data import CaseData

if TYPE_CHECKING:
    from engine.results.results import Results
    from engine.start.start import ForceHistories

__all__ = ["RunView", "view_of"]

Floats = NDArray[np.float64]
Rows = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, eq=False)
class RunView:
    """Results as tables and curves."""

    case: CaseData  #: The inputs. [SI]
    tables: Mapping[str, Rows]  #: Result tables of the contract, rows by JSON key. [SI]
    #: Outcome, time, end_speed and sentence of the start; pull_in and bearing_forces. [SI]
    startup: Mapping[str, Any] | None = None
    #: Time and mean speed of the reference shaft. [s, rad/s]
    speed_time: tuple[Floats, Floats] | None = None
    #: Time and torque of each element, turning points included. [s, N m]
    histories: Mapping[str, tuple[Floats, Floats]] | None = None
    interference: Any = None  #: Lines of the interference diagram. [rad/s, Hz]
    #: Judged shaft, stress amplitudes with SCF and counts of one start; empty arrays when the
    #: largest amplitude alone shows that nothing is damaged. [Pa, 1]
    cycles: tuple[tuple[str, Floats, Floats], ...] = ()
    #: Largest amplitude with SCF of a start and endurance limit of each judged shaft. [Pa]
    amplitudes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    plans: Rows = ()  #: Number and reason of each plan, the reported one last.
    #: Damping law of teeth in contact; None where no clearance was modelled.
    contact_law: str | None = None
    #: Tooth and bearing forces at the times of `speed_time`, where they were calculated. [N]
    forces: ForceHistories | None = None
    #: Time, unwrapped load angle and slip, where the field was applied. [s, rad, 1]
    load_angle: tuple[Floats, Floats, Floats] | None = None
    energies: Rows = ()  #: Energy shares of every stiffness and inertia in the first modes. [1]


def view_of(results: Results, audit: Rows = ()) -> RunView:
    """The tables and curves of the engine's results.

    Parameters
    ----------
    results : Results
        A complete run. [SI]
    audit : sequence of mapping
        Rows of table `Audit`. [words]

    Returns
    -------
    RunView
        What the workbook shows.
    """
    from engine.results.details import energy_rows, plan_details, start_summary
    from engine.results.tables import result_tables

    start = results.start
    effects = results.plans[-1].effects if results.plans else None
    shafts = results.starts.shafts if results.starts is not None else ()
    return RunView(
        case=results.case,
        tables=dict(result_tables(results)) | {"Audit": audit},
        startup=start_summary(results),
        speed_time=None if start is None else (start.trajectory.time, start.trajectory.mean_speed),
        histories=_histories(results),
        interference=results.interference,
        cycles=tuple((s.element, s.cycles.amplitude, s.cycles.count) for s in shafts),
        amplitudes={s.element: (s.largest_amplitude, s.endurance) for s in shafts},
        plans=plan_details(results)["plans"],
        contact_law=effects.contact_law if effects is not None and effects.clearances else None,
        forces=None if start is None else start.forces,
        load_angle=_load_angle(results),
        energies=energy_rows(results, SHARE_MODES),
    )


def _load_angle(results: Results) -> tuple[Floats, Floats, Floats] | None:
    """Time, load angle and slip of a start in which the field was applied."""
    start, synchronous = results.start, results.case.ratings.synchronous_speed
    if start is None or start.load_angle is None or not synchronous:
        return None
    path = start.trajectory
    return path.time, start.load_angle, 1.0 - path.mean_speed / synchronous


def _histories(results: Results) -> dict[str, tuple[Floats, Floats]]:
    """Sampled torques with the exact turning points put in between."""
    start = results.start
    if start is None:
        return {}
    turning = start.turning_of_element()
    found = {}
    for index, element in enumerate(results.case.elements):
        output = int(start.output_of_element[index])
        if output < 0 or element.element is None:
            continue
        time, torque = start.trajectory.time, start.trajectory.torque[output]
        if index in turning:
            at = np.searchsorted(time, turning[index][0])
            time = np.insert(time, at, turning[index][0])
            torque = np.insert(torque, at, turning[index][1])
        found[element.element] = (time, torque)
    return found
