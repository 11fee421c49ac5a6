"""The event-driven loop of starts with clearances and events (`kernels/contact_loop.c`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.stepping.library import address, check_lengths, ffi, library, struct

__all__ = [
    "ANGLE",
    "AT_TIME",
    "BACK",
    "BACK_LIMITED",
    "DIVIDED",
    "DRIVE",
    "DRIVE_LIMITED",
    "FREE",
    "MORE",
    "NEW_PIECE",
    "RECOVERS",
    "SPEED",
    "STUCK",
    "TURNED",
    "UNSETTLED",
    "advance_pieces",
    "check_together",
    "first_fall",
    "pieces_struct",
]

Floats = NDArray[np.float64]

#: Contact of a flank; the last one is a free flank that is still compressed, in the log only, where
#: it takes load again without having left.
FREE, DRIVE, DRIVE_LIMITED, BACK, BACK_LIMITED, RECOVERS = range(6)
#: Why the loop came back: more room wanted, end time, mean speed, load angle, a piece that has to
#: be made first, no progress, forces of dampers that have no solution in double precision,
#: torque and motion of a motor that do not settle in a step, the current of a field that changed its sign.
MORE, AT_TIME, SPEED, ANGLE = library.MORE, library.AT_TIME, library.SPEED, library.ANGLE
NEW_PIECE, STUCK, DIVIDED = library.NEW_PIECE, library.STUCK, library.DIVIDED
UNSETTLED, TURNED = library.UNSETTLED, library.TURNED

#: Tables of the pieces in the order of `pieces_t`.
TABLES = (
    "keys", "stiffness", "rate", "reach", "constant", "mean_speed", "read_speed", "swing", "flank_rows", "viscous", "shows",
    "turns", "position", "velocity", "direct", "offset", "damped", "centres", "free", "forced", "solver", "made",
)  # fmt: skip


def advance_pieces(
    clock: Any, pieces: Any, flanks: Any, drive: Any, state: Any, out: Any, log: Any
) -> tuple[int, int, int]:
    """Steps from one event to the next until something has to be decided outside.

    At an event two rows are written for one instant, one a piece.

    Parameters
    ----------
    clock, pieces, flanks, drive, state, out, log : cdata
        ``clock_t_``, ``pieces_t``, ``flanks_t``, ``drive_t``, ``state_t``, ``output_t`` and ``log_t`` of
        `kernels.h`; clock, flanks, state, out and log are updated. [SI]

    Returns
    -------
    rows, events, reason : int
        Rows written, events logged, why the loop came back. [count]
    """
    room = np.empty(library.contact_room(pieces, drive))
    rows = ffi.new("int64_t *")
    reason = library.advance_pieces(
        clock, pieces, flanks, drive, state, out, log, address(room), rows
    )
    return rows[0], log.n, reason


def pieces_struct(
    tables: Sequence[Any],
    damper_force: NDArray[np.int64],
    n_flanks: int,
    bearings: tuple[Floats, Floats],
    swing_motor: NDArray[np.int64],
) -> Any:
    """The pieces as the loop takes them.

    Parameters
    ----------
    tables : sequence of ndarray
        In the order of `TABLES`. [SI]
    damper_force : ndarray of int, shape (n_dampers,)
        Force of each damper. [index]
    n_flanks : int
        Flanks. [count]
    bearings : tuple of ndarray
        Stiffness and damping of the bearings of each gear that moves laterally. [N/m, N s/m]
    swing_motor : ndarray of int, shape (n_swings,)
        Motors that answer to oscillations. [index]

    Returns
    -------
    cdata
        ``pieces_t`` of `kernels.h`. [SI]
    """
    named = dict(zip(TABLES, tables, strict=True))
    n_pieces, n_forces, n = named["reach"].shape
    return struct(
        "pieces_t", n_pieces=n_pieces, n=n, n_forces=n_forces, n_flanks=n_flanks,
        n_dampers=len(damper_force), levels=named["made"].shape[1], damper_force=damper_force,
        n_outputs=named["offset"].shape[1], n_bodies=len(bearings[0]),
        bearing_stiffness=bearings[0], bearing_damping=bearings[1],
        n_swings=len(swing_motor), n_swing_levels=named["swing"].shape[2], swing_motor=swing_motor, **named,
    )  # fmt: skip


def check_together(pieces: Any, flanks: Any, drive: Any, state: Any, out: Any) -> None:
    """Whether arrays fit to those of the other structs that `advance_pieces` takes.

    Raises `InternalError` where one has another length.
    """
    n, n_motors = pieces.n, drive.n_motors
    check_lengths(pieces, n_motors=n_motors)
    check_lengths(drive, lanes=1)
    check_lengths(flanks, n_flanks=pieces.n_flanks)
    check_lengths(state, lanes=1, n=n, n_forces=pieces.n_forces, n_motors=n_motors)
    check_lengths(
        out, n=n, n_motors=n_motors, n_machines=drive.machines.n, n_outputs=pieces.n_outputs, n_bodies=pieces.n_bodies
    )  # fmt: skip


def first_fall(g0: float, d0: float, g1: float, d1: float) -> float:
    """Where in [0, 1] the Hermite cubic first falls through zero; 2 if it does not.

    A curve that starts at or below zero and rises is not falling.

    Parameters
    ----------
    g0, d0, g1, d1 : float
        Value and rate a step at its beginning and at its end. [1]

    Returns
    -------
    float
        Share of the step. [1]
    """
    return float(library.first_fall(g0, d0, g1, d1))
