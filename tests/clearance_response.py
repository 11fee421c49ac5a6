"""A train with clearances under given torques, from given angles and speeds.

No motor and no start: what free impact oscillations, gaps closed by a step of torque and published
examples of backlash are calculated with. The start with clearances is in `engine.backlash.event_start`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from engine.backlash.contact_systems import (
    ContactSystems,
    ForceLocations,
    SharedBasis,
    shared_basis,
)
from engine.backlash.event_simulation import (
    EventModel,
    EventRun,
    EventSchedule,
    simulate_events,
)
from engine.case.choices import ContactLaw
from engine.case.data import CaseData
from engine.model.modes import Modes
from engine.model.train import Flank, Train
from engine.start.start_model import machine_arrays
from engine.start.time_response import PrescribedTorque
from engine.stepping import contact_loop as events

Floats = NDArray[np.float64]

#: Phase of the fastest visible motion per step in a free or prescribed response. [rad]
RESPONSE_ANGLE = 0.1


@dataclass(frozen=True, eq=False)
class ClearanceResponse:
    """Response of a train with clearances at the requested times."""

    time: Floats  #: Times. [s] Shape (n_times,).
    #: In each station's running direction, at its own speed. [rad, rad/s] Shape (n_stations,
    #: n_times).
    station_angle: Floats
    station_speed: Floats  #: Likewise. [rad, rad/s] Shape (n_stations, n_times).
    torque: Floats  #: Torque of each element. [N m] Shape (n_outputs, n_times).
    #: Time, clearance, contact of a flank before and after, its speed, of each event. [SI] Shape
    #: (n_events, 5).
    log: Floats
    run: EventRun  #: Everything at every step. [SI]


class ResponseOptions(TypedDict, total=False):
    """What may be stated of a response beside its train and its torques."""

    damping_ratio: float  #: Of the elastic modes of every contact system; default 0. [1]
    #: At the first time, in running direction; default zero. [rad] Shape (n_stations,).
    initial_angle: Floats | None
    initial_speed: Floats | None  #: Likewise. [rad/s] Shape (n_stations,).
    contact_law: str  #: One of `engine.case.choices.ContactLaw`; default limited.
    step: float | None  #: Longest step; default from the fastest mode. [s]
    sampled: float  #: Angular frequency that it samples; default that of the fastest mode. [rad/s]
    visible: float  #: Ringing above this share of the largest torque is followed; default 0. [1]


def clearance_response(
    train: Train,
    modes: Modes,
    clearances: Sequence[Flank],
    times: Floats,
    *,
    torques: Sequence[PrescribedTorque] = (),
    **options: Unpack[ResponseOptions],
) -> ClearanceResponse:
    """Follow a train with clearances from given angles and speeds under prescribed torques.

    Parameters
    ----------
    train : Train
        The train. [SI]
    modes : Modes
        All its modes with the drive flanks in contact. [SI]
    clearances : sequence of Flank
        Those that are modelled; at angle zero the drive flanks just touch. [count]
    times : ndarray, shape (n_times,)
        Times wanted, rising; the first is the start. [s]
    torques : sequence of PrescribedTorque, optional
        Torques linear between knots (`engine.start.time_response.linear`), one a station. [N m]
    **options : Any
        Initial state, damping, contact law and step: see `ResponseOptions`. [SI]

    Returns
    -------
    ClearanceResponse
        Angles, speeds and torques at `times`, and every event. [SI]
    """
    damping_ratio = options.get("damping_ratio", 0.0)
    t = np.asarray(times, dtype=float)
    keep = np.ones(modes.n_modes, dtype=np.bool_)
    stated = np.where(modes.omega > 0.0, damping_ratio, 0.0)
    basis = shared_basis(train, modes, clearances, keep, stated, damping_ratio)
    stations = sorted({p.station for p in torques})
    places = ForceLocations(
        np.array(stations, dtype=np.int64), np.zeros(0, dtype=np.int64), len(stations), np.zeros(0)
    )
    m = basis.vectors.shape[1]
    q = _in_basis(basis, options.get("initial_angle"))
    v = _in_basis(basis, options.get("initial_speed"))
    scale = _response_scale(basis, torques, q, v)
    pieces = ContactSystems(
        basis,
        places,
        np.zeros(m),
        np.zeros((0, m)),
        np.full(len(train.element_rows) + len(train.rigid_meshes), scale),
    )
    fastest = max(float(modes.omega.max()), 1.0 / max(float(np.ptp(t)), 1e-12))
    machines = machine_arrays(CaseData(), (), (), torques, stations)
    model = EventModel(
        pieces=pieces,
        **machines | {"timed": _from_first_time(machines["timed"], float(t[0]))},
        sampled=options.get("sampled", fastest),
        visible=options.get("visible", 0.0),
        limited=options.get("contact_law", ContactLaw.LIMITED) == ContactLaw.LIMITED,
    )
    script = EventSchedule(
        maximum_time=float(t[-1] - t[0]), stops=tuple((t - t[0]).tolist()), keep_state=True
    )
    run = simulate_events(
        model,
        options.get("step") or RESPONSE_ANGLE / fastest,
        script,
        (q, v),
        _contacts_at(basis, q, v, model.limited),
    )
    place = np.searchsorted(run.trajectory.time, (t - t[0]) * (1.0 + 1e-14), side="right") - 1
    to_station = train.node_matrix()[: train.n_stations] @ basis.vectors
    return ClearanceResponse(
        t,
        to_station @ run.position[:, place],
        to_station @ run.velocity[:, place],
        run.trajectory.torque[:, place],
        run.log,
        run,
    )


def _from_first_time(timed: tuple[Any, ...], first: float) -> tuple[Any, ...]:
    """The same tables with their times counted from the first time wanted."""
    force, times, values, counts = timed
    return force, times - first, values, counts


def _response_scale(
    basis: SharedBasis, torques: Sequence[PrescribedTorque], q: Floats, v: Floats
) -> float:
    """A torque that this motion is about: what is applied, and what its energy does to a flank.

    A gap is no scale: the other flank may be as good as infinitely far away.
    """
    applied = max((float(np.max(np.abs(p.value(p.knots, "right")))) for p in torques), default=0.0)
    strain = basis.train.stiffness * (basis.rows @ q) ** 2
    for flank in basis.flanks:  # one that stands free is not strained
        strain[flank.drive_row] = 0.0
    stiffest = max((f.stiffness for f in basis.flanks), default=0.0)
    scale = applied + math.sqrt(stiffest * float(v @ v + strain.sum()))
    return scale if scale > 0.0 else 1.0


def _in_basis(basis: SharedBasis, station_values: Floats | None) -> Floats:
    """Coordinates of given station angles or speeds: Vᵀ M θ."""
    train = basis.train
    value = np.zeros(train.n_dof)
    if station_values is not None:
        given = np.asarray(station_values, dtype=float)
        n = train.n_stations
        value[train.node_dof[:n]] = given / train.node_scale[:n]
    return np.asarray(basis.vectors.T @ (train.inertia * value))


def _contacts_at(basis: SharedBasis, q: Floats, v: Floats, limited: bool) -> tuple[int, ...]:
    """Contact of each flank in a given state."""
    gaps = [math.inf if f.gap is None else f.gap for f in basis.flanks]
    drive = zip(basis.flanks, basis.drive_rows, [0.0] * len(gaps), strict=True)
    back = zip(basis.flanks, basis.back_rows, gaps, strict=True)
    return tuple(
        _contact(f.stiffness, f.viscous, float(row @ q) - gap, float(row @ v), loaded, limited)
        for side, loaded in ((drive, events.DRIVE), (back, events.BACK))
        for f, row, gap in side
    )


def _contact(
    stiffness: float, viscous: float, depth: float, speed: float, loaded: int, limited: bool
) -> int:
    """Contact of one flank; the limited one is the next number."""
    spring, damping = stiffness * depth, viscous * speed
    if depth < 0.0 or spring + damping < 0.0 or (depth == 0.0 and speed < 0.0):
        return events.FREE
    return loaded + 1 if limited and damping > spring else loaded
