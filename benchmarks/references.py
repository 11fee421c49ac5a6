"""The right answers, calculated without the engine's modes and without its steppers.

- frequencies: Sturm counts and bisection in 50-digit arithmetic;
- a prescribed torque: the matrix exponential in twists and speeds, with Gauss quadrature of the
  torque over each step, so that the only errors are rounding and a quadrature of order 16;
- a start: Dormand-Prince 8(5,3) at a tolerance of 1e-12 in twists and speeds. Only the torques
  themselves are read from the engine's compiled force law: they are the problem, not the method.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from benchmarks.problems import Chain, Sweep
from engine.case.data import CaseData
from engine.model.train import Train
from engine.stepping.linear_loop import drive_struct, start_forces, system_struct
from tests.mean_speed import read_weights

__all__ = ["Curves", "exact_frequencies", "exact_response", "exact_start"]

Floats = NDArray[np.float64]

MP = mpmath.mp.clone()
MP.dps = 50
#: Width to which a frequency is bisected, over the frequency.
WIDTH = MP.mpf(10) ** -20
GAUSS_NODES = 8
#: Of the start: phases grow to thousands of radians, and their errors add up.
RTOL = 1e-12


@dataclass(frozen=True, eq=False)
class Curves:
    """Torques on a grid of times.

    Parameters
    ----------
    time : ndarray, shape (n_times,)
        Times. [s]
    torque, elastic : ndarray, shape (n_elements, n_times)
        Torque of each element with its damper's part, and without. [N m]
    """

    time: Floats
    torque: Floats
    elastic: Floats


def exact_frequencies(chain: Chain, guess: Floats) -> Floats:
    """Elastic natural frequencies of a chain, rising. [rad/s]

    The guesses (rising) only save time: counts decide, and a bracket without its frequency grows.
    """
    J = [MP.mpf(float(x)) for x in chain.inertia]
    k = [MP.mpf(float(x)) for x in chain.stiffness]
    diagonal = [a + b for a, b in zip([MP.mpf(0), *k], [*k, MP.mpf(0)], strict=True)]
    squared = [x * x for x in k]

    def below(square: Any) -> int:
        """How many ω² lie below: negative pivots of K − ω² J."""
        pivot = diagonal[0] - square * J[0]
        count = int(pivot < 0)
        for i in range(1, len(J)):
            pivot = diagonal[i] - square * J[i] - squared[i - 1] / pivot
            count += pivot < 0
        return count

    found = []
    for i, w in enumerate(guess, start=1):
        square, reach = MP.mpf(float(w)) ** 2, MP.mpf(10) ** -12
        low, high = square * (1 - reach), square * (1 + reach)
        while not (below(low) <= i < below(high)):
            reach *= 100
            low = square * max(1 - reach, MP.mpf(10) ** -12)
            high = square * (1 + reach)
        while high - low > WIDTH * low:
            middle = (low + high) / 2
            if below(middle) > i:
                high = middle
            else:
                low = middle
        found.append(float(MP.sqrt((low + high) / 2)))
    return np.array(found)


def _twist_matrices(
    inertia: Floats, stiffness: Floats, B: Floats, damping: Floats
) -> tuple[Floats, Floats]:
    """x' = A x + G T for x = (twists, speeds), T the torques on the stations."""
    n_rows, n = B.shape
    A = np.zeros((n_rows + n, n_rows + n))
    A[:n_rows, n_rows:] = B
    A[n_rows:, :n_rows] = -(B.T * stiffness) / inertia[:, None]
    A[n_rows:, n_rows:] = -damping / inertia[:, None]
    G = np.zeros((n_rows + n, n))
    G[n_rows:] = np.diag(1.0 / inertia)
    return A, G


def exact_response(chain: Chain, station: int, torque: Sweep, step: float, nodes: int) -> Curves:
    """A chain from rest under a smooth torque at one station, at every `step`."""
    B = np.eye(chain.n - 1, chain.n) - np.eye(chain.n - 1, chain.n, 1)
    A, G = _twist_matrices(chain.inertia, chain.stiffness, B, (B.T * chain.damping) @ B)
    scale = np.concatenate([np.sqrt(chain.stiffness), np.sqrt(chain.inertia)])
    A = A * scale[:, None] / scale  # energies, so that the exponential is well conditioned
    gain = scale * G[:, station]
    x, w = np.polynomial.legendre.leggauss(nodes)
    s = 0.5 * (x + 1.0)
    kernel = np.stack(
        [
            0.5 * step * weight * (expm(A * (step * (1.0 - at))) @ gain)
            for at, weight in zip(s, w, strict=True)
        ],
        axis=1,
    )
    count = round(torque.duration / step)
    time = step * np.arange(count + 1)
    forced = torque(time[:-1, None] + step * s) @ kernel.T
    states = _recur(expm(A * step), forced) / scale
    twist, speed = states[:, : chain.n - 1], states[:, chain.n - 1 :]
    elastic = (twist * chain.stiffness).T
    return Curves(time, elastic + ((speed @ B.T) * chain.damping).T, elastic)


@njit(cache=False)
def _recur(free: Floats, forced: Floats) -> Floats:
    """x₊ = free · x + forced, from rest."""
    n = free.shape[0]
    out = np.zeros((forced.shape[0] + 1, n))
    for k in range(forced.shape[0]):
        for i in range(n):
            x = forced[k, i]
            for j in range(n):
                x += free[i, j] * out[k, j]
            out[k + 1, i] = x
    return out


def exact_start(
    case: CaseData,
    train: Train,
    damping: Floats,
    model: Any,
    stations: NDArray[np.int64],
    time: Floats,
) -> Curves:
    """A start from rest, all degrees of freedom, damping with its full matrix.

    `damping` acts on the degrees of freedom, `model` is the engine's `StartModel` for its curves,
    `stations` are those its forces act on, in its order. The curves of motors are read at the speed that the case names.
    """
    B = train.incidence
    pick = np.zeros((len(stations), train.n_dof))
    pick[np.arange(len(stations)), train.node_dof[stations]] = train.node_scale[stations]
    A, G = _twist_matrices(train.inertia, train.stiffness, B, damping)
    n_rows = train.n_rows
    G = np.ascontiguousarray(G @ pick.T)
    reach = np.empty((len(stations), 0))
    none = np.zeros(0)
    nodes = stations[model.motors[0]]
    weights = [
        read_weights(case, B, train.stiffness, train.inertia, train.dof_ratio, dof)
        for dof in train.node_dof[nodes]
    ]
    read = train.node_scale[nodes, None] * np.array(weights).reshape(-1, train.n_dof)
    structs = (
        drive_struct(model.curves, model.motors, model.loads, model.timed, model.electrical),
        system_struct(none, none, reach, none, reach, model.dampers),
    )
    start = np.concatenate([np.zeros(len(A)), model.phase])
    largest = np.concatenate(
        [
            np.full(n_rows, 1e5) / train.stiffness,
            np.full(train.n_dof, 1.0),
            np.ones(len(model.phase)),
        ]
    )
    solved = solve_ivp(
        lambda t, y: _start_slope(t, y, (A, G, pick, read), n_rows, model.motors, structs),
        (0.0, time[-1]),
        start,
        method="DOP853",
        t_eval=time,
        rtol=RTOL,
        atol=RTOL * largest,
    )
    twist, speed = solved.y[:n_rows], solved.y[n_rows : len(A)]
    elastic = twist * train.stiffness[:, None]
    return Curves(time, elastic + train.viscous[:, None] * (B @ speed), elastic)


def _start_slope(
    t: float,
    y: Floats,
    matrices: tuple[Floats, Floats, Floats, Floats],
    n_rows: int,
    motors: Any,
    structs: tuple[Any, Any],
) -> Floats:
    """Rate of change of (twists, speeds, phases of the pulsations)."""
    A, G, pick, read = matrices
    n = len(A)
    speed = pick @ y[n_rows:n]
    mean = read @ y[n_rows:n]
    phase = np.ascontiguousarray(y[n:])
    force, _ = start_forces(
        t, t, phase, speed, np.zeros(len(pick)), (mean, np.zeros(len(mean))), *structs
    )
    turning = 2.0 * (motors[5] - motors[4] * speed[motors[0]])
    return np.concatenate([A @ y[:n] + G @ force, turning])
