"""Singular values of the scaled incidence matrix, each to its own rounding.

The one-sided Jacobi SVD of the compiled library is nearly always accurate to the relative rounding of
each entry, and the same to the bit on every machine. From `LARGE` degrees of freedom on it is LAPACK: the
plain SVD where its norm-wise error bound is good enough for the smallest value, else its Jacobi SVD (dgejsv). "Nearly" is then made "always" by counting: the graph of an open
train is acyclic, so eliminating it from its leaves inward tells without cancellation how many values
lie below a given one; a value that the count contradicts is bisected. Both take n³. A long
unbranched train needs only n²: its matrix is bidiagonal, whose every singular value is defined to
high relative accuracy by the entries, and each vector follows from a twisted factorisation.

References
----------
Demmel, Gu, Eisenstat, Slapničar, Veselić, Drmač, "Computing the singular value decomposition with
high relative accuracy", Linear Algebra Appl. 299 (1999) 21-80; Drmač & Veselić, "New fast and
accurate Jacobi SVD algorithm I, II", SIAM J. Matrix Anal. Appl. 29 (2008); Demmel & Gragg, "On
computing accurate singular values and eigenvalues of matrices with acyclic graphs", Linear
Algebra Appl. 185 (1993) 203-217; Demmel & Kahan, "Accurate singular values of bidiagonal matrices",
SIAM J. Sci. Stat. Comput. 11 (1990) 873-912; Parlett & Dhillon, "Fernando's solution to Wilkinson's
problem", Linear Algebra Appl. 267 (1997) 247-279 (twisted factorisation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints
from engine.errors import InternalError
from engine.numerics.same_bits import square, svd

#: Left vectors, values, right vectors, algorithm.
Triplets = tuple[Floats, Floats, Floats, str]

#: From this many degrees of freedom on LAPACK calculates. Its results depend on the processor, in the last digits.
LARGE = 400
#: Above this bound on the relative error of the lowest frequency the Jacobi SVD is used.
SVD_ERROR_LIMIT = 5e-13
#: The plain SVD is also kept where its bound is at most this and the counts confirm every value: the Jacobi SVD
#: takes five times as long.
CONFIRMED_LIMIT = 1e-10
#: A frequency is right if the counts at this relative distance confirm it.
COUNT_TOLERANCE = 2e-13
#: Below this ratio of largest to smallest frequency the Jacobi SVD needs no confirmation.
CONFIDENT_SPAN = 1e6
#: Enough to bisect any bracket of doubles to neighbours.
MAX_BISECTIONS = 120
#: Vectors of neighbouring values of a chain are as orthogonal as this, or the Jacobi SVD is asked.
ORTHOGONAL = 1e-11
TINY, EPS = float(np.finfo(float).tiny), float(np.finfo(float).eps)


def singular_triplets(D: Floats, count: int) -> tuple[Floats, Floats, Floats, str]:
    """The `count` largest singular triplets, rising, each value to its own rounding.

    Parameters
    ----------
    D : ndarray, shape (n_rows, n_columns)
        Scaled incidence matrix √k · B · 1/√m. [rad/s]
    count : int
        Number of singular values that are not zero, known from the topology. [count]

    Returns
    -------
    left : ndarray, shape (n_rows, count)
        Left singular vectors. [1]
    sigma : ndarray, shape (count,)
        Singular values. [rad/s]
    right : ndarray, shape (n_columns, count)
        Right singular vectors. [1]
    algorithm : str
        ``svd``, ``jacobi`` or ``chain``. [word]

    Raises
    ------
    InternalError
        If fewer than `count` values differ from zero.
    """
    large = max(D.shape) >= LARGE
    if large and (triplets := _chain(D, count) or _plain(D, count)) is not None:
        return triplets
    u, sigma, v = _rising(*(_lapack_jacobi(D) if large else svd(D)), count)
    if not (np.all(np.isfinite(sigma)) and sigma[0] > 0.0):
        raise InternalError(
            f"expected {count} elastic modes, the smallest singular value is {sigma[0]:.3g}"
        )
    if sigma[-1] > CONFIDENT_SPAN * sigma[0]:
        sigma = _corrected(D, sigma)
    return u, sigma, v, "jacobi"


def _rising(u: Floats, sigma: Floats, v: Floats, count: int) -> tuple[Floats, Floats, Floats]:
    """The `count` largest of triplets in falling order, in rising order."""
    return u[:, :count][:, ::-1], sigma[:count][::-1], v[:, :count][:, ::-1]


def _plain(D: Floats, count: int) -> Triplets | None:
    """The plain SVD; None where it may have lost digits."""
    u, sigma, vt = np.linalg.svd(D, full_matrices=False)
    loss, smallest = EPS * max(D.shape) * sigma[0], sigma[count - 1]
    close, good = loss <= CONFIRMED_LIMIT * smallest, loss <= SVD_ERROR_LIMIT * smallest
    if good or (close and not _contradicted(D, sigma[:count][::-1])):
        return *_rising(u, sigma, vt.T, count), "svd"
    return None


def _lapack_jacobi(D: Floats) -> tuple[Floats, Floats, Floats]:
    """Jacobi SVD of D in falling order; LAPACK wants at least as many rows as columns.

    joba = G: both sides may be scaled arbitrarily (D1·C·D2 with C well conditioned).
    """
    from scipy.linalg import lapack  # a tenth of a second that only large trains pay

    wide = D.shape[0] < D.shape[1]
    A = np.array(D.T if wide else D, order="F")
    sva, u, v, work, _, info = lapack.dgejsv(A, joba=3, jobu=0, jobv=0, jobr=0, jobt=0, jobp=0)
    if info != 0:
        raise InternalError(f"the Jacobi SVD did not converge (LAPACK info {info})")
    sigma = np.asarray(sva) * (work[0] / work[1])
    u = np.asarray(u)[:, : A.shape[1]]
    return (np.asarray(v), sigma, u) if wide else (u, sigma, np.asarray(v))


def _contradicted(D: Floats, sigma: Floats) -> bool:
    """True if a count contradicts a singular value (all of them given, rising)."""
    tree = _leaves_first(D)
    return tree is None or len(_contradictions(tree, sigma)) > 0


def _contradictions(tree: list[_Hanging], sigma: Floats) -> Ints:
    """Indices of singular values (rising, the zeros left out) that the counts contradict."""
    n = len(sigma)
    around = np.concatenate([sigma * (1 - COUNT_TOLERANCE), sigma * (1 + COUNT_TOLERANCE)])
    below = _count_below(tree, around)
    index = np.arange(n)
    return np.flatnonzero((below[:n] > index) | (below[n:] <= index))


def _corrected(D: Floats, sigma: Floats) -> Floats:
    """Singular values (rising) that the counts contradict are bisected; the others stay."""
    tree = _leaves_first(D)
    contradicting = (
        _contradictions(tree, sigma) if tree is not None else np.zeros(0, dtype=np.int64)
    )
    if tree is None or not len(contradicting):
        return sigma
    low, high = sigma[contradicting], sigma[contradicting]
    for reach in (1e-11, 1e-8, 1e-4, 1e-1, 1e1, 1e4, 1e8):
        low = np.where(_count_below(tree, low) > contradicting, low / (1.0 + reach), low)
        high = np.where(_count_below(tree, high) <= contradicting, high * (1.0 + reach), high)
    for _ in range(MAX_BISECTIONS):
        wide = high > 2.0 * low
        middle = np.where(wide, np.sqrt(low) * np.sqrt(high), low + 0.5 * (high - low))
        if np.all((middle <= low) | (middle >= high)):
            break
        above = _count_below(tree, middle) > contradicting
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    sigma = sigma.copy()
    sigma[contradicting] = 0.5 * (low + high)
    return sigma


@dataclass(frozen=True)
class _Hanging:
    """One column of D in the order of elimination: what is joined to it and already eliminated.

    `onward` is its own entry and the parent's, squared, of the row that leads to the parent;
    `grounded` are the squared entries of rows that have no other.
    """

    column: int
    parent: int
    onward: tuple[float, float]
    grounded: tuple[float, ...]


def _leaves_first(D: Floats) -> list[_Hanging] | None:
    """Order in which the acyclic graph of D is eliminated; None if it has circuits.

    Rows side by side between the same two columns are one row first: their squares add.
    """
    near: list[dict[int, tuple[float, float]]] = [{} for _ in range(D.shape[1])]
    ground: list[list[float]] = [[] for _ in range(D.shape[1])]
    for row in D:
        ends = np.flatnonzero(row).tolist()
        squares = [square(float(row[i])) for i in ends]
        if len(ends) == 1:
            ground[ends[0]].append(squares[0])
        elif len(ends) == 2:
            a, b = ends
            old = near[a].get(b, (0.0, 0.0))
            near[a][b] = (old[0] + squares[0], old[1] + squares[1])
            near[b][a] = near[a][b][::-1]
        else:
            return None
    order: list[_Hanging] = []
    parent = {0: -1}
    stack = [0]
    while stack:
        column = stack.pop()
        up = parent[column]
        onward = near[column][up] if up >= 0 else (0.0, 0.0)
        order.append(_Hanging(column, up, onward, tuple(ground[column])))
        for other in near[column]:
            if other != up:
                if other in parent:
                    return None
                parent[other] = column
                stack.append(other)
    return order[::-1] if len(order) == D.shape[1] else None


def _count_below(tree: list[_Hanging], values: Floats) -> Ints:
    """How many of the singular values that are not zero lie below each of some positive values.

    Negative pivots of [[−s, Dᵀ], [D, −s]], whose eigenvalues are ±σ and zeros. Every rounding
    error is a relative one in s or in an entry of D, so the count is right to a few roundings.
    """
    pivot = np.tile(-values, (len(tree), 1))
    negative = np.zeros(len(values), dtype=np.int64)
    n_rows = 0
    with np.errstate(over="ignore", divide="ignore"):
        for node in tree:
            d = pivot[node.column]
            for square in node.grounded:
                n_rows += 1
                negative += 1
                d += square / values
            d[d == 0.0] = -TINY
            negative += d < 0.0
            if node.parent >= 0:
                n_rows += 1
                e = -values - node.onward[0] / d
                e[e == 0.0] = -TINY
                negative += e < 0.0
                pivot[node.parent] -= node.onward[1] / e
    return negative - max(n_rows, len(tree))


# --- unbranched trains ----------------------------------------------------------------------------


def _chain(D: Floats, count: int) -> Triplets | None:
    """Triplets of a bidiagonal matrix in any order of rows and columns; None if it is not one.

    Also None where two values are so close that their vectors, each found alone, would not be
    orthogonal.
    """
    from scipy.linalg import eigh_tridiagonal

    order = _chain_order(D) if D.shape == (count, count + 1) else None
    if order is None:
        return None
    rows, columns = order
    # Row and column in turn (Golub & Kahan): a tridiagonal matrix without diagonal, values ±σ and 0.
    b = np.empty(2 * count)
    b[0::2], b[1::2] = D[rows, columns[:-1]], D[rows, columns[1:]]
    rough = eigh_tridiagonal(
        np.zeros(2 * count + 1), b, eigvals_only=True, check_finite=False, lapack_driver="sterf"
    )[-count:]
    if not rough[0] > 0.0:
        return None
    correction, _ = _twisted(b, rough)
    sigma = _corrected(D, np.sort(np.abs(rough + correction)))
    correction, z = _twisted(b, sigma)
    if not np.all(np.abs(correction) <= COUNT_TOLERANCE * sigma):
        return None
    sigma = sigma + correction
    u, v = np.empty((count, count)), np.empty((count + 1, count))
    u[rows], v[columns] = z[1::2], z[0::2]
    for vectors in (u, v):
        vectors /= np.sqrt(np.einsum("ij,ij->j", vectors, vectors))
        close = np.abs(np.einsum("ij,ij->j", vectors[:, :-1], vectors[:, 1:]))
        if not np.all(close <= ORTHOGONAL):  # nor if one is not finite
            return None
    return u, sigma, v, "chain"


def _chain_order(D: Floats) -> tuple[Ints, Ints] | None:
    """Rows and columns from one end to the other; None if D is no chain with two free ends."""
    joined = D != 0.0
    degree = joined.sum(axis=0)
    if np.any(joined.sum(axis=1) != 2) or np.any(degree > 2) or np.sum(degree == 1) != 2:
        return None
    near: list[list[tuple[int, int]]] = [[] for _ in range(D.shape[1])]
    for row, (a, b) in enumerate(np.nonzero(joined)[1].reshape(-1, 2).tolist()):
        near[a].append((row, b))
        near[b].append((row, a))
    column, came = int(np.flatnonzero(degree == 1)[0]), -1
    rows, columns = [], [column]
    while onward := [n for n in near[column] if n[0] != came]:
        came, column = onward[0]
        rows.append(came)
        columns.append(column)
    return (np.array(rows), np.array(columns)) if len(rows) == D.shape[0] else None


def _twisted(b: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Corrections of positive eigenvalues, and eigenvectors, of a tridiagonal without diagonal.

    Elimination from both ends meets where the pivot is least: there the vector is large, and both
    ways out from there it is a product of ratios, without cancellation. The vector is in the error
    of its eigenvalue over the distance to the next one; the correction is the Rayleigh quotient's.
    """
    n, every = len(b) + 1, np.arange(len(sigma))
    square = (b * b).tolist()
    nothing = (
        -EPS * EPS * sigma
    )  # for a pivot of zero: far below a rounding of σ, far from overflow
    ahead, behind = np.empty((2, n, len(sigma)))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        ahead[0] = behind[-1] = -sigma
        for i, q in enumerate(square):
            pivot = -sigma - q / ahead[i]
            ahead[i + 1] = np.where(pivot == 0.0, nothing, pivot)
        for i in range(n - 2, -1, -1):
            pivot = -sigma - square[i] / behind[i + 1]
            behind[i] = np.where(pivot == 0.0, nothing, pivot)
        both = ahead + behind
        both += sigma
        meet = np.argmin(np.abs(both), axis=0)
        least = both[meet, every]
        z = both
        z[:] = 0.0
        z[meet, every] = 1.0
        for i in range(n - 2, -1, -1):
            np.multiply(z[i + 1], -b[i] / ahead[i], out=z[i], where=i < meet)
        for i in range(n - 1):
            np.multiply(z[i], -b[i] / behind[i + 1], out=z[i + 1], where=i >= meet)
        return least / np.einsum("ij,ij->j", z, z), z
