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
from engine.stepping.library import address, ffi, library

#: Left vectors, values, right vectors, algorithm: of one train, and of several.
Triplet = tuple[Floats, Floats, Floats, str]
Triplets = tuple[Floats, Floats, Floats, tuple[str, ...]]

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


def singular_triplets(root_k: Floats, B: Floats, root_mass: Floats, count: int) -> Triplets:
    """Singular triplets of D = √k · B · 1/√m of each of some trains, rising, each value to its own rounding.

    A train has the same bits alone.

    Parameters
    ----------
    root_k : ndarray, shape (n_trains, n_rows)
        √k, positive. [√(N m/rad)]
    B : ndarray, shape (n_rows, n_columns)
        Incidence matrix of all of them. [1]
    root_mass : ndarray, shape (n_trains, n_columns)
        √m. [√(kg m²)]
    count : int
        Number of singular values that are not zero, known from the topology. [count]

    Returns
    -------
    left : ndarray, shape (n_trains, n_rows, n_columns)
        Left singular vectors; zero where the value is. [1]
    sigma : ndarray, shape (n_trains, n_columns)
        Singular values; those that are zero come first. [rad/s]
    right : ndarray, shape (n_trains, n_columns, n_columns)
        Right singular vectors; zero where the value is. [1]
    algorithm : tuple of str
        ``svd``, ``jacobi`` or ``chain`` of each. [word]

    Raises
    ------
    InternalError
        If fewer than `count` values differ from zero.
    """
    if max(B.shape) >= LARGE:
        found = [_large(k, B, m, count) for k, m in zip(root_k, root_mass, strict=True)]
        left, values, right, words = zip(*found, strict=True)
        if len(found) == 1:  # without copies: each is large
            return left[0][None], values[0][None], right[0][None], words
        return np.stack(left), np.stack(values), np.stack(right), words
    D = root_k[:, :, None] * B / root_mass[:, None, :]
    u, sigma, v = _rising(*svd(D), count)
    _correct(D, sigma[:, -count:])
    return u, sigma, v, ("jacobi",) * len(D)


def _large(root_k: Floats, B: Floats, root_mass: Floats, count: int) -> Triplet:
    """Of one train with many degrees of freedom."""
    if (triplets := _chain(root_k, B, root_mass, count)) is not None:
        return triplets
    D = root_k[:, None] * B / root_mass
    if (triplets := _plain(D, count)) is not None:
        return triplets
    u, sigma, v = _rising(*_lapack_jacobi(D), count)
    _correct(D[None], sigma[None, -count:])
    return u, sigma, v, "jacobi"


def _correct(D: Floats, elastic: Floats) -> None:
    """Correct singular values of the Jacobi SVD, all that are not zero, where the counts contradict them."""
    least = float(np.min(elastic[:, 0]))
    if not (np.all(np.isfinite(elastic)) and least > 0.0):
        raise InternalError(
            f"expected {elastic.shape[1]} elastic modes, the smallest singular value is {least:.3g}"
        )
    for i in np.flatnonzero(elastic[:, -1] > CONFIDENT_SPAN * elastic[:, 0]):
        if (tree := _leaves_first(D[i])) is not None:
            elastic[i] = _corrected(tree, elastic[i])


def _rising(u: Floats, sigma: Floats, v: Floats, count: int) -> tuple[Floats, Floats, Floats]:
    """Triplets in falling order, in rising order; those behind the `count` largest become zero."""
    n = v.shape[-2]
    left, values, right = (
        np.zeros((*u.shape[:-1], n)),
        np.zeros((*sigma.shape[:-1], n)),
        np.zeros((*v.shape[:-1], n)),
    )
    for to, of in ((left, u), (values, sigma), (right, v)):
        to[..., n - count :] = of[..., :count][..., ::-1]
    return left, values, right


def _plain(D: Floats, count: int) -> Triplet | None:
    """The plain SVD; None where it may have lost digits."""
    u, sigma, vt = np.linalg.svd(D, full_matrices=False)
    loss, smallest = EPS * max(D.shape) * sigma[0], sigma[count - 1]
    close, good = loss <= CONFIRMED_LIMIT * smallest, loss <= SVD_ERROR_LIMIT * smallest
    if good or (close and _confirmed(D, sigma[:count][::-1])):
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


def _confirmed(D: Floats, sigma: Floats) -> bool:
    """True if the counts confirm every singular value (all of them given, rising)."""
    tree = _leaves_first(D)
    return tree is not None and len(_contradictions(tree, sigma)) == 0


def _contradictions(tree: list[_Hanging], sigma: Floats) -> Ints:
    """Indices of singular values (rising, the zeros left out) that the counts contradict."""
    n = len(sigma)
    around = np.concatenate([sigma * (1 - COUNT_TOLERANCE), sigma * (1 + COUNT_TOLERANCE)])
    below = _count_below(tree, around)
    index = np.arange(n)
    return np.flatnonzero((below[:n] > index) | (below[n:] <= index))


def _corrected(tree: list[_Hanging], sigma: Floats) -> Floats:
    """Singular values (rising) that the counts contradict are bisected; the others stay."""
    contradicting = _contradictions(tree, sigma)
    if not len(contradicting):
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
    pivots: dict[int, Floats] = {}  # of columns on which something eliminated hangs
    negative = np.zeros(len(values), dtype=np.int64)
    n_rows = 0
    with np.errstate(over="ignore", divide="ignore"):
        for node in tree:
            d = pivots.pop(node.column, -values)
            for square in node.grounded:
                n_rows += 1
                negative += 1
                d = d + square / values
            d[d == 0.0] = -TINY
            negative += d < 0.0
            if node.parent >= 0:
                n_rows += 1
                e = -values - node.onward[0] / d
                e[e == 0.0] = -TINY
                negative += e < 0.0
                pivots[node.parent] = pivots.get(node.parent, -values) - node.onward[1] / e
    return negative - max(n_rows, len(tree))


# --- unbranched trains ----------------------------------------------------------------------------


def _chain(root_k: Floats, B: Floats, root_mass: Floats, count: int) -> Triplet | None:
    """Triplets where D is bidiagonal in any order of rows and columns; None if it is not.

    Also None where two values are so close that their vectors, each found alone, would not be
    orthogonal. D itself is not formed.
    """
    from scipy.linalg import eigh_tridiagonal

    order = _chain_order(B) if B.shape == (count, count + 1) else None
    if order is None:
        return None
    rows, columns = order
    # Row and column in turn (Golub & Kahan): a tridiagonal matrix without diagonal, values ±σ and 0.
    b = np.empty(2 * count)
    for i, ends in enumerate((columns[:-1], columns[1:])):
        b[i::2] = root_k[rows] * B[rows, ends] / root_mass[ends]
    rough = eigh_tridiagonal(
        np.zeros(2 * count + 1), b, eigvals_only=True, check_finite=False, lapack_driver="sterf"
    )[-count:]
    if not rough[0] > 0.0:
        return None
    sigma = np.sort(np.abs(rough + _vectors(b, rough)))
    squares = (b * b).reshape(-1, 2).tolist()
    tree = [_Hanging(i, i + 1, (own, other), ()) for i, (own, other) in enumerate(squares)]
    sigma = _corrected([*tree, _Hanging(count, -1, (0.0, 0.0), ())], sigma)
    u, v = np.empty((count, count + 1)), np.empty((count + 1, count + 1))
    u[:, 0], v[:, 0] = 0.0, 0.0
    correction = _vectors(b, sigma, (rows, columns, u, v))
    if not np.all(np.abs(correction) <= COUNT_TOLERANCE * sigma):
        return None
    for vectors in (u[:, 1:], v[:, 1:]):
        close = np.abs(np.einsum("ij,ij->j", vectors[:, :-1], vectors[:, 1:]))
        if not np.all(close <= ORTHOGONAL):  # nor if one is not finite
            return None
    return u, np.concatenate([[0.0], sigma + correction]), v, "chain"


def _chain_order(B: Floats) -> tuple[Ints, Ints] | None:
    """Rows and columns from one end to the other; None if B is no chain with two free ends."""
    row, end = np.nonzero(B)
    joins, degree = np.bincount(row, minlength=B.shape[0]), np.bincount(end, minlength=B.shape[1])
    if np.any(joins != 2) or np.any(degree > 2) or np.sum(degree == 1) != 2:
        return None
    near: list[list[tuple[int, int]]] = [[] for _ in range(B.shape[1])]
    for number, (a, b) in enumerate(end.reshape(-1, 2).tolist()):
        near[a].append((number, b))
        near[b].append((number, a))
    column, came = int(np.flatnonzero(degree == 1)[0]), -1
    rows, columns = [], [column]
    while onward := [n for n in near[column] if n[0] != came]:
        came, column = onward[0]
        rows.append(came)
        columns.append(column)
    return (np.array(rows), np.array(columns)) if len(rows) == B.shape[0] else None


def _vectors(
    b: Floats, sigma: Floats, into: tuple[Ints, Ints, Floats, Floats] | None = None
) -> Floats:
    """Corrections of the singular values of a chain; rows, columns, left and right: its vectors as well.

    The vector of a twisted factorisation is in the error of its value over the distance to the next one;
    the correction is the Rayleigh quotient's. The first column of `left` and `right` stays as it is.
    """
    n, correction = len(b) + 1, np.empty(len(sigma))
    place, room = np.zeros(n, dtype=np.int64), np.empty(16 * n)
    matrices = ffi.NULL, ffi.NULL
    if into is not None:
        place[1::2], place[0::2], left, right = into
        matrices = address(right.ravel()[1:]), address(left.ravel()[1:])
    library.chain_vectors(
        n, address(b), len(sigma), address(sigma), address(correction), address(place, "int64_t"),
        len(sigma) + 1, *matrices, address(room),
    )  # fmt: skip
    return correction
