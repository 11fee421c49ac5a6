"""A checked case → everything the sheets, the JSON and the summary show of it.

Between `engine` and the writers: one run of the engine, its tables and curves, and the audit trail.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from addin.calculation.audit import Stamp, audit_rows
from addin.contract.result_tables import SHARE_MODES
from engine.backlash.motor_scan import WorstInstants
from engine.backlash.operating_events import EventHistory
from engine.case.case import Case
from engine.case.data import CaseData
from engine.operation.full_speed import FullSpeed, full_speed
from engine.results.details import (
    energy_rows,
    full_speed_details,
    modal_details,
    plan_details,
    start_summary,
)
from engine.results.results import Results
from engine.results.tables import result_tables
from engine.start.start import ForceHistories
from engine.studies.starts.case_verdicts import run_with_conditions

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
    full_speed: FullSpeed | None = None  #: The train at full speed in a few numbers. [SI]
    #: Name and history of the event of a motor with the largest air-gap torque. [SI]
    motor_event: tuple[str, EventHistory] | None = None
    #: Name and scan of the event with the largest torque of an element, of those whose worst clearing time was looked
    #: for. [SI]
    clearing: tuple[str, WorstInstants] | None = None


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
    start = results.start
    effects = results.plans[-1].effects
    shafts = results.starts.shafts if results.starts is not None else ()
    return RunView(
        case=results.case,
        tables=dict(result_tables(results)) | {"Audit": audit},
        startup=start_summary(results),
        speed_time=None if start is None else (start.trajectory.time, start.trajectory.mean_speed),
        histories=_histories(results),
        interference=results.interference,
        cycles=tuple((s.element, s.amplitudes, s.cycles.count) for s in shafts),
        amplitudes={s.element: (s.largest_amplitude, s.endurance) for s in shafts},
        plans=plan_details(results)["plans"],
        contact_law=effects.contact_law if effects.clearances else None,
        forces=None if start is None else start.forces,
        load_angle=_load_angle(results),
        energies=energy_rows(results, SHARE_MODES),
        full_speed=full_speed(results.case, results.train),
        motor_event=_motor_event(results),
        clearing=_clearing(results),
    )


def _motor_event(results: Results) -> tuple[str, EventHistory] | None:
    drawn = [e for e in results.events if e.history is not None and e.air_gap is not None]
    largest = max(drawn, key=lambda e: abs(e.air_gap.largest) if e.air_gap else 0.0, default=None)
    return None if largest is None or largest.history is None else (largest.name, largest.history)


def _clearing(results: Results) -> tuple[str, WorstInstants] | None:
    scans = [(e.name, e.worst) for e in results.events if e.worst and len(e.worst.clearing)]
    return max(scans, key=lambda scan: float(np.max(scan[1].torque)), default=None)


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


@dataclass(frozen=True, eq=False)
class Calculation:
    """One calculated case, ready to be written."""

    case: Case  #: What was calculated. [SI]
    case_sha256: str  #: Digest of the inputs as typed, before settings of the command line. [hex]
    results: Results  #: The engine's results. [SI]
    #: Result tables of the contract, rows under JSON keys. [SI]
    tables: Mapping[str, Sequence[Mapping[str, Any]]]
    startup: Mapping[str, Any] | None  #: Outcome, time, end speed and sentence. [SI]
    view: RunView  #: Tables and curves as the workbook shows them. [SI]
    warnings: tuple[str, ...]  #: Of the reader and of the engine.
    outcome: str  #: How the run ended.
    #: Energy shares, nodes, damped eigenvalues, plans and sensitivity, for the JSON. [SI]
    details: Mapping[str, Any]
    stamp: Stamp  #: Version and date.


def calculate(
    case: Case,
    *,
    input_warnings: Sequence[str] = (),
    case_sha256: str | None = None,
    overrides: Mapping[str, object] | None = None,
    on_stage: Callable[[str], None] | None = None,
) -> Calculation:
    """Run the engine on a case and gather what is to be shown.

    Parameters
    ----------
    case : Case
        The case. [SI]
    input_warnings : sequence of str
        What the reader found worth saying. [sentences]
    case_sha256 : str, optional
        Digest of the inputs as typed, where `overrides` changed the case. [hex]
    overrides : mapping, optional
        Settings of the command line that differ from the workbook's. [names and values]
    on_stage : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Calculation
        Complete. [SI]

    Raises
    ------
    ModelError
        If the train as a whole cannot be calculated.
    """
    results = run_with_conditions(case, on_stage)
    digest = case_sha256 or results.case_sha256
    return present_results(results, case, input_warnings, digest, overrides or {})


def present_results(
    results: Results,
    case: Case,
    input_warnings: Sequence[str],
    case_sha256: str,
    overrides: Mapping[str, object],
) -> Calculation:
    """Results of the engine with everything that is shown of them.

    Parameters
    ----------
    results : Results
        Of this case, or of one that differs from it in its title block only. [SI]
    case : Case
        The case. [SI]
    input_warnings : sequence of str
        What the reader found worth saying. [sentences]
    case_sha256 : str
        Digest of the inputs as typed. [hex]
    overrides : mapping
        Settings of the command line that differ from the workbook's. [names and values]

    Returns
    -------
    Calculation
        Complete. [SI]
    """
    warnings = tuple(dict.fromkeys([*input_warnings, *results.warnings]))
    stamp = Stamp.now()
    audit = audit_rows(results, stamp, case_sha256, warnings, overrides)
    view = view_of(results, audit)
    return Calculation(
        case=case,
        case_sha256=case_sha256,
        results=results,
        tables=view.tables,
        startup=view.startup,
        view=view,
        warnings=warnings,
        outcome=results.outcome,
        details=modal_details(results) | plan_details(results) | full_speed_details(results),
        stamp=stamp,
    )
