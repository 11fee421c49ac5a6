"""Starts without events and turning points (`kernels/linear_loop.c`), prescribed torques (`kernels/prescribed.c`).

Arrays are (n_modes,), (n_forces,) or (n_samples, …) and C-contiguous. A *force* is a torque at
one station; `reach` maps forces to modes and modal to station angles alike. Several starts run side by side, one a
lane: what varies by lane then has one more axis, the last one; of curves and tables the first one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.stepping.library import address, check_lengths, library, struct

__all__ = [
    "AT_TIME",
    "LANES",
    "MORE",
    "SPEED",
    "advance_starts",
    "begin_starts",
    "difference_of_extremes",
    "drive_coupled",
    "drive_modes",
    "drive_struct",
    "lane_to_end",
    "prescribed_struct",
    "room_for",
    "samples_to_end",
    "start_forces",
    "system_struct",
    "torques_struct",
    "turning_points",
    "turning_to_end",
]

Floats = NDArray[np.float64]

#: Of each motor: see `engine.model.motor.electrical_arrays`.
Electrical = tuple[Floats, Floats, float, Floats, Floats, Floats, Floats, Floats, Floats]

#: Fields of ``drive_t`` in the order of that tuple.
ELECTRICAL = (
    "shock", "shock_rate", "shock_omega", "field_time", "field_rate", "pull_out", "cage", "polarity",
    "connected",
)  # fmt: skip
#: Why the loop came back: output full, end time, mean speed reached.
MORE, AT_TIME, SPEED = library.MORE, library.AT_TIME, library.SPEED
#: Starts that run side by side.
LANES = int(library.lanes_at_once())


def drive_struct(
    curves: tuple[Floats, Floats, Any],
    motors: tuple[Any, Any, Any, Floats, Floats, float, Any],
    loads: tuple[Any, Any, Floats, Floats],
    timed: tuple[Any, Floats, Floats, Any],
    electrical: Electrical,
    tones: Mapping[str, Any] | None = None,
    machines: Any = None,
) -> Any:
    """Motors, loads and torques against time as the loops take them (``drive_t``).

    Parameters
    ----------
    curves : tuple
        Knots, cubics and counts of all torque curves. [1, N m]
    motors : tuple
        Force, two curves, synchronous speed, pole pairs and line frequency of each, halved of a torque at
        1 × slip frequency; curve of the average torque with the field on. [SI]
    loads : tuple
        Force, curve, synchronous and standstill speed of each. [SI]
    timed : tuple
        Force, times, torques and counts of each table against time. [s, N m]
    electrical : tuple
        Of each motor (`engine.model.motor.electrical_arrays`): amplitude and rate of decay of the
        transient at breaker closing, its angular frequency (one for all), time of field application
        (infinite = none), rate at which the field rises (infinite = at once), pull-out torque,
        torque over slip speed (nan = the average curve), what is added to the load angle, and 1,
        or 0 once the motor is disconnected. [SI]
    tones : mapping, optional
        Fields of the decaying harmonic torques, of the loop with events alone. [SI]
    machines : cdata, optional
        ``machines_t``: motors whose torque follows from their fluxes, of that loop alone. [SI]

    Returns
    -------
    cdata
        Struct; it reads the arrays where they lie, so a change of theirs counts.
    """
    knots, cubics, counts = curves
    of_motors = {
        name: np.atleast_1d(np.asarray(a)) for name, a in zip(ELECTRICAL, electrical, strict=True)
    }
    force, average, pulsating, speed, pole_pairs, line_omega, with_field = motors
    fields = {
        "curves": struct(
            "curves_t", n=knots.shape[-2], longest=knots.shape[-1], knots=knots, cubics=cubics, counts=counts
        ),
        "n_motors": len(force), "motor_force": force, "average": average, "pulsating": pulsating,
        "with_field": with_field, "motor_speed": speed, "pole_pairs": pole_pairs,
        "line_omega": line_omega,
        "n_loads": len(loads[0]), "load_force": loads[0], "load_curve": loads[1],
        "load_speed": loads[2], "soft_speed": loads[3],
        "n_timed": len(timed[0]), "most_timed": timed[1].shape[-1], "timed_force": timed[0],
        "times": timed[1], "torques": timed[2], "timed_count": timed[3],
    }  # fmt: skip
    if machines is not None:
        fields["machines"] = machines
    return struct("drive_t", **fields, **of_motors, **(tones or {}))


def system_struct(
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    mean_speed: Floats,
    read_speed: Floats,
    dampers: tuple[Any, Floats],
    swings: tuple[Any, Floats] | None = None,
) -> Any:
    """Modes of a train as the loops take them (``system_t``).

    Parameters
    ----------
    stiffness, rate : ndarray, shape (n_modes,)
        λ and d of each mode. [1/s², 1/s]
    reach : ndarray, shape (n_forces, n_modes)
        Forces to modes. [rad/√(kg m²)]
    mean_speed : ndarray, shape (n_modes,)
        Mean speed from modal velocities. [√(1/(kg m²))]
    read_speed : ndarray, shape (n_motors, n_read)
        Speed at which the curves of each motor are read, from the first modal velocities. [√(1/(kg m²))]
    dampers : tuple
        Force and coefficient of each damper between parts. [N m s/rad]
    swings : tuple, optional
        Motors that answer to oscillations, and their torque over modal velocity, shape (n_swings, n_levels,
        n_modes). [N m s/√(kg m²)]

    Returns
    -------
    cdata
        Struct.
    """
    answers = {}
    if swings is not None:
        motor, swing = swings
        answers = {
            "n_swings": len(motor), "n_levels": swing.shape[1], "swing_motor": motor, "swing": swing
        }  # fmt: skip
    return struct(
        "system_t", n=reach.shape[1], n_forces=reach.shape[0], stiffness=stiffness, rate=rate,
        reach=reach, mean_speed=mean_speed, n_read=read_speed.shape[1], read_speed=read_speed,
        n_dampers=len(dampers[0]), damper_force=dampers[0], viscous=dampers[1], **answers,
    )  # fmt: skip


def start_forces(
    t: float,
    inside: float,
    phase: Floats,
    speed: Floats,
    acceleration: Floats,
    read: tuple[Floats, Floats],
    drive: Any,
    system: Any,
) -> tuple[Floats, Floats]:
    """Every force and its rate.

    A table against time is read on the segment that holds the time `inside`, a point within the
    step, so that a jump at the end of a step is not seen before it happens. The field is on where
    `inside` is past its time, for the same reason: a step must end when it is applied.

    The load angle is δ = phase/2 + polarity, the motor lagging positive. The tabulated pulsation,
    sin(phase) = sin 2δ, so becomes the saliency torque with unbroken phase and is never added
    twice. A phase must therefore be kept modulo 4π: modulo 2π would turn δ by π.

    Parameters
    ----------
    t, inside : float
        Time, and a time within the step. [s]
    phase : ndarray, shape (n_motors,)
        Phase of each pulsation at that time, modulo 4π. [rad]
    speed, acceleration : ndarray, shape (n_forces,)
        Of the station (or across the damper) of each force. [rad/s, rad/s²]
    read : tuple of ndarray, shape (n_motors,)
        Speed at which the curves of each motor are read, and its rate. [rad/s, rad/s²]
    drive, system : cdata
        From `drive_struct` and `system_struct`. [SI]

    Returns
    -------
    force, force_rate : ndarray, shape (n_forces,)
        The results. [N m, N m/s]
    """
    force, rate = np.empty(len(speed)), np.empty(len(speed))
    room = room_for(1, system, drive, struct("torques_t", n=0))
    library.start_forces(
        t, inside, *map(address, (phase, speed, acceleration, *read)), drive, system,
        address(room), address(force), address(rate),
    )  # fmt: skip
    return force, rate


def torques_struct(position: Floats, velocity: Floats | None, force: Floats) -> Any:
    """Torques of elements as the loops take them (``torques_t``).

    Parameters
    ----------
    position, velocity : ndarray, shape (n_outputs, n_modes)
        Torques from modal coordinates and velocities; None: no output has any of these. [N m, N m s]
    force : ndarray, shape (n_outputs, n_forces)
        Torques from forces. [1]

    Returns
    -------
    cdata
        Struct.
    """
    own = {} if velocity is None else {"velocity": velocity}
    return struct("torques_t", n=len(position), position=position, force=force, **own)


def begin_starts(
    lanes: int, system: Any, drive: Any, torques: Any, state: Any, out: Any, room: Floats
) -> None:
    """Forces in the state, written into it, and the first row of output.

    Parameters
    ----------
    lanes : int
        Starts side by side: 1 or `LANES`. [count]
    system, drive, torques, state, out : cdata
        ``system_t``, ``drive_t``, ``torques_t``, ``state_t`` and ``samples_t`` of `kernels.h`; state and out
        are updated. [SI]
    room : ndarray
        From `room_for`. [none]

    Raises
    ------
    InternalError
        If arrays do not fit to each other.
    """
    n, n_forces, n_motors = system.n, system.n_forces, drive.n_motors
    check_lengths(system, lanes=lanes, n_motors=n_motors)
    check_lengths(drive, lanes=lanes)
    check_lengths(torques, lanes=lanes, modes=n, forces=n_forces)
    check_lengths(state, lanes=lanes, n=n, n_forces=n_forces, n_motors=n_motors)
    check_lengths(out, lanes=lanes, n=torques.n)
    library.begin_starts(lanes, system, drive, torques, state, out, address(room))


def advance_starts(
    lanes: int, plan: Any, system: Any, drive: Any, torques: Any, state: Any, out: Any, room: Floats
) -> None:
    """Steps of every lane until its end or its mean speed is reached, or until the output is full.

    Parameters
    ----------
    lanes : int
        Starts side by side: 1 or `LANES`. [count]
    plan : cdata
        ``stretches_t``, updated: of each lane the rows that were written, and why it ended (MORE: it did
        not). [SI]
    system, drive, torques, state, out, room
        As for `begin_starts`. [SI]
    """
    library.advance_starts(lanes, plan, system, drive, torques, state, out, address(room))


def room_for(lanes: int, system: Any, drive: Any, torques: Any) -> Floats:
    """Room that the loop works in.

    Parameters
    ----------
    lanes : int
        Starts side by side. [count]
    system, drive, torques : cdata
        As for `begin_starts`. [SI]

    Returns
    -------
    ndarray
        Not initialised. [none]
    """
    return np.empty(library.linear_room(lanes, system, drive, torques))


def prescribed_struct(stiffness: Floats, rate: Floats, reach: Floats, terms: int) -> Any:
    """Modes without coupling under prescribed torques (``prescribed_t``).

    Parameters
    ----------
    stiffness, rate : ndarray, shape (n_modes,)
        λ and d of each mode. [1/s², 1/s]
    reach : ndarray, shape (n_modes, n_torques)
        Torques to modes. [rad/√(kg m²)]
    terms : int
        Coefficients of each torque over a step: 2 of a straight line, 4 of a cubic. [count]

    Returns
    -------
    cdata
        Struct.
    """
    n, n_torques = reach.shape
    return struct(
        "prescribed_t", n=n, n_torques=n_torques, terms=terms, stiffness=stiffness, rate=rate, reach=reach
    )  # fmt: skip


def drive_modes(
    system: Any,
    steps: Floats,
    torque: Floats,
    state: tuple[Floats, Floats],
    out: Floats,
    first: int,
) -> None:
    """Uncoupled modes under prescribed torques.

    Parameters
    ----------
    system : cdata
        From `prescribed_struct`. [SI]
    steps : ndarray, shape (n_steps,)
        Length of each step; coefficients are made anew where it changes. [s]
    torque : ndarray, shape (terms, n_torques, n_steps)
        Coefficients of each torque over each step. [N m]
    state : tuple of ndarray, shape (n_modes,)
        Positions and velocities, updated. [SI]
    out : ndarray, shape (n_modes, 2, n_times)
        Written: the same after each step. [SI]
    first : int
        Time in `out` at which the first step ends. [index]
    """
    room = np.empty(library.prescribed_room(system))
    library.drive_modes(
        system, len(steps), *map(address, (steps, torque, *state)), out.shape[2], first,
        address(out), address(room),
    )  # fmt: skip


def drive_coupled(free: Floats, push: Floats, torque: Floats, state: Floats, out: Floats) -> None:
    """A coupled linear system under prescribed torques.

    Parameters
    ----------
    free, push : ndarray, shape (n_state, n_state) and (n_state, terms, n_torques)
        Coefficients of the step: of the state, and of the torques' own. [SI]
    torque : ndarray, shape (terms, n_torques, n_steps)
        Coefficients of each torque over each step. [N m]
    state : ndarray, shape (n_state,)
        State, updated. [SI]
    out : ndarray, shape (n_steps, n_state)
        State after each step. [SI]
    """
    room = np.empty(len(state))
    library.drive_coupled(
        len(out), len(state), push[0].size, *map(address, (free, push, torque, state, out, room))
    )


def turning_points(t: Floats, y: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Times and values of all turning points of a piecewise cubic Hermite curve.

    A turning point within rounding of a sample may come twice, but is never missed. Two samples at
    one time are a corner or a jump: both values count where the curve turns or jumps there.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Rising times. [s]
    y, slope : ndarray, shape (n,)
        Values, of any unit, and their rates. [N m, N m/s]

    Returns
    -------
    when, value : ndarray
        Times and values. [s, N m]
    """
    when, value = np.empty(2 * len(t)), np.empty(2 * len(t))
    arrays = (np.ascontiguousarray(a) for a in (t, y, slope))
    found = library.turning_points(len(t), *map(address, (*arrays, when, value)))
    return when[:found].copy(), value[:found].copy()


def turning_to_end(
    turning: tuple[Floats, Floats], size: float, first: float, end: float, last: Floats
) -> tuple[Floats, Floats]:
    """Turning points of a start from rest to its end, with the values there.

    One that lies on a sample, or at an event, comes twice in the list and counts once.

    Parameters
    ----------
    turning : tuple of ndarray
        Times and values of all of them. [s, N m]
    size : float
        Largest magnitude of a sample. [N m]
    first : float
        Value at rest. [N m]
    end : float
        Time of the end, within the last step. [s]
    last : ndarray, shape (3, 2)
        Times, values and rates of the last two samples. [s, N m, N m/s]

    Returns
    -------
    when, value : ndarray
        Times and values. [s, N m]
    """
    n = len(turning[0])
    when, value = np.empty(n + 2), np.empty(n + 2)
    count = library.turning_to_end(
        n,
        address(turning[0]),
        address(turning[1]),
        size,
        first,
        end,
        address(last),
        address(when),
        address(value),
    )
    return when[:count].copy(), value[:count].copy()


def samples_to_end(
    t: Floats, torque: Floats, rate: Floats, end: float
) -> list[tuple[Floats, Floats]]:
    """Turning points of each torque of a run from rest to its end, with the values there, from its samples.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Rising times. [s]
    torque, rate : ndarray, shape (n_outputs, n)
        Torques and their rates. [N m, N m/s]
    end : float
        Time of the end, within the samples. [s]

    Returns
    -------
    list of (ndarray, ndarray)
        Times and values of each. [s, N m]
    """
    outputs, n = torque.shape
    when, value = np.empty((2, outputs * (2 * n + 2)))
    count, room = np.empty(outputs, dtype=np.int64), np.empty(4 * n)
    samples = (np.ascontiguousarray(a) for a in (t, torque, rate))
    library.samples_to_end(
        outputs, n, *map(address, samples), end, *map(address, (room, when, value)),
        address(count, "int64_t"),
    )  # fmt: skip
    ends = np.cumsum(count).tolist()
    when, value = (a[: int(count.sum())].copy() for a in (when, value))
    return [(when[i:j], value[i:j]) for i, j in zip([0, *ends], ends, strict=False)]


def difference_of_extremes(
    a: tuple[Floats, Floats],
    b: tuple[Floats, Floats],
    *,
    with_impacts: bool = False,
    guard_share: float = 1.0,
    same_until: float = math.inf,
) -> float:
    """Largest difference of the extremes of two runs, a share of that of the next smaller ones included.

    Two curves that differ may by chance share their largest value; they hardly share six. Those
    after the largest are compared with the nearest of the other run, not rank by rank: where one
    run has a ripple the other has not, all ranks below it would be compared with their neighbours.
    After many impacts two runs go their own ways: what comes after both the largest value and `same_until`
    says nothing about it. The share is all of it where the largest value comes after `same_until`. Extremes up to the
    largest are compared by themselves, too, as among many one that differs finds a near one.

    Parameters
    ----------
    a, b : tuple of ndarray
        Times and values of all turning points of each run. [s, N m]
    with_impacts : bool
        Whether to compare those up to the largest by themselves, too. [flag]
    guard_share : float
        That share. [1]
    same_until : float
        Until when the runs are known to go together. [s]

    Returns
    -------
    float
        [N m]
    """
    return float(
        library.difference_of_extremes(
            len(a[0]), *map(address, a), len(b[0]), *map(address, b), with_impacts, guard_share,
            same_until,
        )
    )  # fmt: skip


def lane_to_end(
    lane: int, out: Any, count: Any, first: Floats, time: Floats, end: float
) -> list[tuple[Floats, Floats]]:
    """Turning points of each torque of one of the starts side by side, from rest to its end.

    Parameters
    ----------
    lane : int
        Which start. [index]
    out : cdata
        ``samples_t`` that the loop has filled. [SI]
    count : ndarray of int, shape (n_outputs, lanes)
        Its numbers of turning points. [count]
    first : ndarray, shape (n_outputs, lanes)
        Torques at rest. [N m]
    time : ndarray, shape (2,)
        Times of the last two samples. [s]
    end : float
        Time of the end, within the last step. [s]

    Returns
    -------
    list of (ndarray, ndarray)
        Times and values. [s, N m]
    """
    n, lanes = count.shape
    longest = int(count[:, lane].max(initial=0)) + 2
    when, value = np.empty((2, n, longest))
    found = np.empty(n, dtype=np.int64)
    library.lane_to_end(
        n, lanes, lane, out, address(first), address(time), end, longest, address(when),
        address(value), address(found, "int64_t"),
    )  # fmt: skip
    return [(when[i, :k], value[i, :k]) for i, k in enumerate(found.tolist())]
