"""Teeth and bearings in a run with clearances: impacts, speeds, forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from engine.arrays import Floats
from engine.backlash.event_simulation import EventModel, EventRun
from engine.case.defaults import LEAST_PEAK_ERROR
from engine.model.train import Train
from engine.start.event_results import BearingForce, ContactRecord, prediction_interval
from engine.start.start import ForceHistories
from engine.stepping import contact_loop as events

#: Two runs may share their fastest recontact by chance; they hardly share so many.
COMPARED_SPEEDS = 3
#: Share of their change from h to h/2 that is taken for the error at h/2. An event is found to fourth order between
#: steps that err so; measured, 0.6 of the change covers 99 % (docs/accuracy-study.md).
RECONTACT_SHARE = 2.0 / 3.0


def contact_records(
    model: EventModel,
    run: EventRun,
    turning: Sequence[tuple[Floats, Floats]],
    end: float,
    others: Sequence[EventRun] = (),
) -> tuple[ContactRecord, ...]:
    """What happened at each clearance.

    Parameters
    ----------
    model : EventModel
        The model that was run. [SI]
    run : EventRun
        The run. [SI]
    turning : sequence of (ndarray, ndarray)
        Turning points of every output. [s, N m]
    end : float
        When it ended. [s]
    others : sequence of EventRun, optional
        The run at twice the step, or those of an ensemble: the errors are taken from them. [SI]

    Returns
    -------
    tuple of ContactRecord
        One a clearance. [SI]
    """
    basis = model.pieces.basis
    elements = basis.train.elements
    out = []
    for c, flank in enumerate(basis.flanks):
        log = run.log[run.log[:, 1] == c]
        met = log[(log[:, 2] == events.FREE) & (log[:, 0] >= 0.0)]
        speeds = _recontact_speeds(run, c)
        speed = float(speeds[0])
        rows = np.flatnonzero(run.trajectory.output_element == flank.element)
        torque = max(float(np.max(np.abs(turning[int(i)][1]), initial=0.0)) for i in rows)
        radius, factor = flank.base_radius, flank.normal_factor
        out.append(
            ContactRecord(
                element=elements[flank.element],
                impacts=len(met),
                back_impacts=int(np.count_nonzero(met[:, 3] >= events.BACK)),
                time_unloaded=_time_unloaded(log, end),
                recontact_speed=None if radius is None else speed * radius / factor,
                recontact_speed_angular=speed,
                tooth_force=None if radius is None else torque / radius * factor,
                tooth_torque=torque,
                recontact_error=_recontact_error(
                    speeds, [_recontact_speeds(other, c) for other in others]
                ),
            )
        )
    return tuple(out)


def _recontact_speeds(run: EventRun, clearance: int) -> Floats:
    """The largest approach speeds at recontacts of one clearance, in falling order, zero where there are
    fewer, shape (COMPARED_SPEEDS,). [rad/s]"""
    here = (run.log[:, 1] == clearance) & (run.log[:, 0] >= 0.0)
    met = run.log[here & (run.log[:, 2] == events.FREE), 4]
    found = np.zeros(COMPARED_SPEEDS)
    largest = np.sort(met)[::-1][:COMPARED_SPEEDS]
    found[: len(largest)] = largest
    return found


def _recontact_error(speeds: Floats, others: Sequence[Floats]) -> float:
    """Relative error of the largest speed: a share of its change, and that of the next, to the run at twice the
    step; over an ensemble the distance to the ends of its interval. [1]"""
    largest = max(float(speeds[0]), max((float(o[0]) for o in others), default=0.0))
    if largest <= 0.0 or not others:
        return 0.0
    if len(others) == 1:
        off = RECONTACT_SHARE * float(np.max(np.abs(speeds - others[0])))
    else:
        low, high = prediction_interval(np.array([speeds[0], *(o[0] for o in others)]))
        off = max(high - float(speeds[0]), float(speeds[0]) - max(low, 0.0))
    return max(off / (float(speeds[0]) or largest), LEAST_PEAK_ERROR)


def _time_unloaded(log: Floats, end: float) -> float:
    """Total time during which neither flank of a clearance is loaded, the drive flank being so first.

    A flank that is still compressed but would pull is unloaded, too.
    """
    loaded = {False: True, True: False}  # back flank?
    total, since = 0.0, 0.0
    for time, _, before, after, _ in log:
        before_loaded = any(loaded.values())
        back = (before if after == events.FREE else after) >= events.BACK
        loaded[bool(back)] = after != events.FREE
        if before_loaded and not any(loaded.values()):
            since = max(time, 0.0)
        elif not before_loaded and any(loaded.values()):
            total += max(time - since, 0.0)
    return float(total if any(loaded.values()) else total + end - since)


def bearing_forces(train: Train, run: EventRun) -> tuple[BearingForce, ...]:
    """Largest bearing force of each gear that moves laterally."""
    return tuple(
        BearingForce(train.stations[body.station], float(force), float(time))
        for body, (force, time) in zip(train.bodies, run.largest_bearing, strict=True)
    )


def force_histories(train: Train, run: EventRun) -> ForceHistories:
    """Normal tooth forces of the meshes and radial forces of the bearings at the samples."""
    meshes = [f for f in train.flanks if f.base_radius is not None]
    force = np.zeros((len(meshes), len(run.trajectory.time)))
    for i, f in enumerate(meshes):
        row = int(np.flatnonzero(run.trajectory.output_element == f.element)[0])
        assert f.base_radius is not None
        force[i] = run.trajectory.torque[row] * (f.normal_factor / f.base_radius)
    return ForceHistories(
        tuple(train.elements[f.element] for f in meshes),
        force,
        tuple(train.stations[b.station] for b in train.bodies),
        run.bearing,
    )
