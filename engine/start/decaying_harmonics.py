"""Any train under torques A e^(−t/τ) cos(m ω t + φ), untwisted at the beginning: exact, whatever the step.

Such a torque is itself the free motion of a linear system, e^(st) with s = −1/τ + jmω. Beside the modes it
makes one linear system without any torque, whose step is one matrix exponential. Terms that do not decay or
do not oscillate, that meet a mode's own frequency and decay, and modes without damping are therefore no
special cases, as they would be with the formula of each response, which divides by the distance of s from the
eigenvalues of the train.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from engine.arrays import Complexes, Floats, Ints, Mask
from engine.model.modes import Modes
from engine.model.train import Train
from engine.numerics.same_bits import cos, exp, matrix_exponential, product, sin
from engine.start.time_response import ModalSystem, TimeResponse, modal_system
from engine.start.torque_outputs import force_reach


@dataclass(frozen=True)
class DecayingHarmonic:
    """One torque A e^(−t/τ) cos(ω t + φ) at a station."""

    station: int  #: Station. [index]
    amplitude: float  #: A, in the running direction. [N m]
    phase: float = 0.0  #: φ. [rad]
    omega: float = 0.0  #: Angular frequency. [rad/s]
    decay: float = 0.0  #: 1/τ. [1/s]


def as_the_loop_takes_them(
    terms: Sequence[DecayingHarmonic], stations: Sequence[int]
) -> dict[str, Any]:
    """Decaying harmonics as fields of ``drive_t``; `stations` names the station of each force."""
    columns = list(stations)
    return {
        "n_tones": len(terms),
        "tone_force": np.array([columns.index(t.station) for t in terms], dtype=np.int64),
        "tone_size": np.array([t.amplitude for t in terms], dtype=np.float64),
        "tone_decay": np.array([t.decay for t in terms], dtype=np.float64),
        "tone_omega": np.array([t.omega for t in terms], dtype=np.float64),
        "tone_phase": np.array([t.phase for t in terms], dtype=np.float64),
    }


@dataclass(frozen=True, eq=False)
class Tones:
    """Torques that share frequency and decay, together."""

    stations: Ints  #: Where they act. [indices] Shape (n_stations,).
    exponent: Complexes  #: s = −1/τ + jω of each tone. [1/s] Shape (n_tones,).
    #: Σ A e^(jφ) of each station and tone: the torque is the real part of it times e^(st). [N m] Shape
    #: (n_stations, n_tones).
    amplitude: Complexes

    @classmethod
    def of(cls, terms: Sequence[DecayingHarmonic]) -> Tones:
        """Terms put together."""
        stations = sorted({t.station for t in terms})
        exponents = list(dict.fromkeys(complex(-t.decay, t.omega) for t in terms))
        amplitude = np.zeros((len(stations), len(exponents)), dtype=np.complex128)
        for t in terms:
            at = stations.index(t.station), exponents.index(complex(-t.decay, t.omega))
            amplitude[at] += complex(t.amplitude * cos(t.phase), t.amplitude * sin(t.phase))
        return cls(np.array(stations, dtype=np.int64), np.array(exponents), amplitude)

    def torques(self, time: Floats) -> tuple[Floats, Floats]:
        """Torques and their rates.

        Parameters
        ----------
        time : ndarray, shape (n_times,)
            Times. [s]

        Returns
        -------
        torque, rate : ndarray, shape (n_stations, n_times)
            At each station. [N m, N m/s]
        """
        size = exp(self.exponent.real[:, None] * time)
        angle = self.exponent.imag[:, None] * time
        both = np.concatenate([size * cos(angle), size * sin(angle)])
        slope = product(_generator(self.exponent), both)
        real = _real_part_of(self.amplitude)
        return product(real, both), product(real, slope)

    def on_modes(self, train: Train, modes: Modes) -> Complexes:
        """What each tone does to each mode, shape (n_modes, n_tones). [rad √(kg m²)/s²]"""
        return np.asarray(product(force_reach(train, modes, self.stations), self.amplitude))


def _real_part_of(amplitude: Complexes) -> Floats:
    """What takes real and imaginary parts of e^(st), one below the other, to the real part of their products."""
    return np.concatenate([amplitude.real, -amplitude.imag], axis=1)


def _generator(exponent: Complexes) -> Floats:
    """d/dt of real and imaginary parts of e^(st), those of all tones first, shape (2 n_tones, 2 n_tones)."""
    decay, omega = np.diag(exponent.real), np.diag(exponent.imag)
    return np.block([[decay, -omega], [omega, decay]])


def decaying_response(
    train: Train,
    modes: Modes,
    tones: Tones,
    end: float,
    count: int,
    *,
    damping_ratio: Floats | None = None,
    kept: Mask | None = None,
) -> TimeResponse:
    """Response of a train to decaying harmonic torques at equally spaced times.

    Parameters
    ----------
    train : Train
        The train; its dampers act with their full matrix. [SI]
    modes : Modes
        All its modes. [SI]
    tones : Tones
        The torques. [N m]
    end : float
        Last time. [s]
    count : int
        Steps from 0 to there. [count]
    damping_ratio : ndarray, shape (n_modes,), optional
        Stated modal damping, in addition to the train's dampers. [1]
    kept : ndarray of bool, shape (n_modes,), optional
        Modes that are integrated; elastic modes left out follow statically. Default all. [mask]

    Returns
    -------
    TimeResponse
        Exact at those times. [SI]
    """
    system = modal_system(train, modes, tones.stations, damping_ratio, kept)
    time = np.linspace(0.0, end, count + 1)
    n = len(system.omega)
    rows = system.room_for(count + 1)
    # modes that damping does not couple are systems of their own
    together = [list(range(n))] if system.coupled else [[i] for i in range(n)]
    for modes_of in together:
        rows[modes_of, 0], rows[modes_of, 1] = _motion(system, tones, modes_of, end / count, count)
    return system.response(time, rows, lambda: tones.torques(time))


def _motion(
    system: ModalSystem, tones: Tones, modes_of: list[int], h: float, count: int
) -> tuple[Floats, Floats]:
    """Positions and velocities of some modes, from rest, shape (n, count + 1)."""
    n, omega, m = len(modes_of), system.omega[modes_of], 2 * len(tones.exponent)
    drive = h * h * _real_part_of(product(system.reach[modes_of], tones.amplitude))
    scale = float(np.max(np.abs(drive), initial=0.0)) or 1.0
    # state (size · q, h q̇, scale × tones), so that no entry exceeds ωh: rounding is that of the motion
    size = np.maximum(omega * h, 1.0)
    a = np.zeros((2 * n + m, 2 * n + m))
    a[:n, n : 2 * n] = np.diag(size)
    a[n : 2 * n, :n] = -np.diag((omega * h) ** 2 / size)
    a[n : 2 * n, n : 2 * n] = -h * system.damping[np.ix_(modes_of, modes_of)]
    a[n : 2 * n, 2 * n :] = drive / scale
    a[2 * n :, 2 * n :] = h * _generator(tones.exponent)
    state = np.zeros(2 * n + m)
    state[2 * n : 2 * n + m // 2] = scale  # e^(st) is 1 at t = 0
    motion = _powers(matrix_exponential(a), state, count)
    return motion[:n] / size[:, None], motion[n : 2 * n] / h


def _powers(step: Floats, state: Floats, count: int) -> Floats:
    """States after 0, 1, …, count equal steps, each time twice as many from those known, as columns."""
    states = np.empty((len(state), count + 1))
    states[:, 0], known = state, 1
    while known <= count:
        more = min(known, count + 1 - known)
        states[:, known : known + more] = product(step, np.ascontiguousarray(states[:, :more]))
        step, known = product(step, step), known + more
    return states
