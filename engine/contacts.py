"""What a run with clearances tells about teeth and bearings: impacts, speeds, forces."""

from __future__ import annotations

import numpy as np

from engine.effects import BearingForce, ContactRecord
from engine.event_run import EventModel, EventRun
from engine.startup import ForceHistories
from engine.stepping import events
from engine.train import Train

__all__ = ["bearing_forces", "contact_records", "force_histories"]


def contact_records(model: EventModel, run: EventRun, end: float) -> tuple[ContactRecord, ...]:
    """What happened at each clearance.

    Parameters
    ----------
    model : EventModel
        The model that was run. [SI]
    run : EventRun
        The run. [SI]
    end : float
        When it ended. [s]

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
        parted, met = log[log[:, 3] == events.FREE], log[log[:, 2] == events.FREE]
        unloaded = float(met[:, 0].sum() - parted[:, 0].sum())
        if len(parted) > len(met):
            unloaded += end
        speed = float(np.max(met[:, 4], initial=0.0))
        rows = run.trajectory.output_element == flank.element
        torque = float(np.max(np.abs(run.trajectory.torque[rows]), initial=0.0))
        radius, factor = flank.base_radius, flank.normal_factor
        out.append(
            ContactRecord(
                element=elements[flank.element],
                impacts=len(met),
                back_impacts=int(np.count_nonzero(met[:, 3] >= events.BACK)),
                time_unloaded=unloaded,
                recontact_speed=None if radius is None else speed * radius / factor,
                recontact_speed_angular=speed,
                tooth_force=None if radius is None else torque / radius * factor,
                tooth_torque=torque,
            )
        )
    return tuple(out)


def bearing_forces(train: Train, run: EventRun) -> tuple[BearingForce, ...]:
    """Largest bearing force of each gear that moves sideways.

    Parameters
    ----------
    train : Train
        The train. [SI]
    run : EventRun
        The run. [SI]

    Returns
    -------
    tuple of BearingForce
        One a gear. [N]
    """
    out = []
    for body, force in zip(train.bodies, run.bearing, strict=True):
        i = int(np.argmax(force))
        out.append(
            BearingForce(
                train.stations[body.station], float(force[i]), float(run.trajectory.time[i])
            )
        )
    return tuple(out)


def force_histories(train: Train, run: EventRun) -> ForceHistories:
    """Tooth and bearing forces at the samples.

    Parameters
    ----------
    train : Train
        The train. [SI]
    run : EventRun
        The run. [SI]

    Returns
    -------
    ForceHistories
        Normal tooth forces of the meshes, radial forces of the bearings. [N]
    """
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
