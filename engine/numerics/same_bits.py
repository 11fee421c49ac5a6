"""Arithmetic that gives the same 64 bits on every machine.

Sums, products, quotients and square roots of doubles are the same everywhere. What is not: sine, exponential and the
like (each C library rounds them in its own way, and numpy has others for vector units), sums of products (BLAS orders
them by the processor; some compilers fuse product and sum), products, quotients and magnitudes of complex numbers
(numpy fuses them where it can), and LAPACK, which is built on those. Here are the same functions from the compiled
library, in one fixed order. A test (`tests/boundaries/test_machine_functions.py`) keeps the others out of the engine.

Of numpy, order and rounding of `sum`, `cumsum`, `mean` and of every elementwise + − × ÷ √ are fixed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Complexes, Floats
from engine.errors import InternalError
from engine.stepping.library import address, ffi, library

__all__ = [
    "ComplexSystems",
    "atan2",
    "cos",
    "eigenvalues",
    "exp",
    "half_and_whole",
    "hypot",
    "interp",
    "log",
    "matrix_exponential",
    "matrix_exponentials",
    "norm",
    "power",
    "product",
    "products",
    "singular_values",
    "sin",
    "solve",
    "svd",
    "times",
    "total",
]

#: A number or an array of them.
Numbers = TypeVar("Numbers", float, Floats)
#: Matrices with more rows, columns and terms of each sum than this go to BLAS: they are not of 64 stations.
LARGE = 512
#: Degree 13 of the Padé approximation of the exponential serves up to this norm.
#: Higham, SIAM J. Matrix Anal. Appl. 26 (2005) 1179-1193, Table 2.3 and (2.3).
PADE_NORM = 5.371920351148152
PADE = (
    64764752532480000.0, 32382376266240000.0, 7771770303897600.0, 1187353796428800.0, 129060195264000.0,
    10559470521600.0, 670442572800.0, 33522128640.0, 1323241920.0, 40840800.0, 960960.0, 16380.0, 182.0, 1.0,
)  # fmt: skip


# --- functions of numbers -------------------------------------------------------------------------


def _values(which: int, x: Any, y: Any = None) -> Any:
    """A function of numbers or of arrays of one shape; a float of a number."""
    if isinstance(x, (float, int)) and (y is None or isinstance(y, (float, int))):
        return float(library.function_of(which, x, 0.0 if y is None else y))
    a = np.asarray(x, dtype=np.float64, order="C")
    b = a if y is None else np.asarray(y, dtype=np.float64, order="C")
    shape = np.shape(x) if y is None else np.broadcast_shapes(np.shape(x), np.shape(y))
    steps = [int(np.size(v) > 1) for v in (a, b)]
    if any(step and v.shape != shape for step, v in zip(steps, (a, b), strict=True)):
        a, b = (np.ascontiguousarray(np.broadcast_to(v, shape)) for v in (a, b))
        steps = [1, 1]
    out = np.empty(shape)
    library.function_values(
        which, out.size, address(a), steps[0], address(b), steps[1], address(out)
    )
    return out if shape else float(out)


def sin(x: Numbers) -> Numbers:
    """Sine, within one unit in the last place."""
    return _values(library.SINE, x)  # type: ignore[no-any-return]


def cos(x: Numbers) -> Numbers:
    """Cosine, within one unit in the last place."""
    return _values(library.COSINE, x)  # type: ignore[no-any-return]


def exp(x: Numbers) -> Numbers:
    """Exponential, within one unit in the last place."""
    return _values(library.EXPONENTIAL, x)  # type: ignore[no-any-return]


def log(x: Numbers) -> Numbers:
    """Natural logarithm, within one unit in the last place."""
    return _values(library.LOGARITHM, x)  # type: ignore[no-any-return]


def power(x: Numbers, y: Any) -> Numbers:
    """x to the power y, for x not negative, within one unit in the last place."""
    return _values(library.POWER, x, y)  # type: ignore[no-any-return]


def atan2(y: Numbers, x: Numbers) -> Numbers:
    """Angle of the point (x, y), within one unit in the last place."""
    return _values(library.ARCTANGENT, y, x)  # type: ignore[no-any-return]


def hypot(x: Numbers, y: Numbers) -> Numbers:
    """√(x² + y²), within one unit in the last place."""
    return _values(library.HYPOTENUSE, x, y)  # type: ignore[no-any-return]


def interp(x: Any, points: ArrayLike, values: ArrayLike) -> Any:
    """Straight lines between points, held outside them; a float of a number.

    Parameters
    ----------
    x : float or ndarray, shape (n,)
        Where. [any]
    points, values : array_like, shape (n_points,)
        Rising points, and the values there. [any]

    Returns
    -------
    float or ndarray, shape (n,)
        The values in between. [any]
    """
    at = np.asarray(x, dtype=np.float64, order="C")
    p, v = (np.asarray(a, dtype=np.float64, order="C") for a in (points, values))
    if not len(p) or len(p) != len(v):
        raise InternalError(f"{len(p)} points and {len(v)} values to interpolate between")
    out = np.empty(at.shape)
    library.interpolate(at.size, address(at), len(p), address(p), address(v), address(out))
    return out if out.shape else float(out)


def total(numbers: Iterable[float]) -> float:
    """Sum in the order given. (The built-in `sum` corrects its rounding from Python 3.12 on.)

    Parameters
    ----------
    numbers : iterable of float
        Numbers. [any]

    Returns
    -------
    float
        Their sum. [any]
    """
    result = 0.0
    for number in numbers:
        result += number
    return result


def times(a: Complexes, b: Complexes) -> Complexes:
    """Product of complex arrays, both with imaginary parts, element by element."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape), dtype=np.complex128)
    out.real = a.real * b.real - a.imag * b.imag
    out.imag = a.real * b.imag + a.imag * b.real
    return out


def inverse(a: Complexes) -> Complexes:
    """1/a of complex numbers, element by element."""
    size = a.real * a.real + a.imag * a.imag
    return np.asarray(a.real / size - 1j * (a.imag / size))


def modulus(a: Any) -> Any:
    """Magnitude of complex or real numbers, element by element."""
    return hypot(a.real, a.imag) if np.iscomplexobj(a) else np.abs(a)


def square(x: float) -> float:
    """x². (`x**2` of a number is a power of the C library; of an array it is this.)

    Parameters
    ----------
    x : float
        Number. [any]

    Returns
    -------
    float
        Its square. [any]
    """
    return x * x


def fourth(x: float) -> float:
    """x⁴.

    Parameters
    ----------
    x : float
        Number. [any]

    Returns
    -------
    float
        Its fourth power. [any]
    """
    return (x * x) * (x * x)


def doublings(x: float) -> int:
    """How often one has to be doubled to reach x: the least k ≥ 0 with 2^k ≥ x.

    Parameters
    ----------
    x : float
        Positive number. [1]

    Returns
    -------
    int
        Doublings. [count]
    """
    mantissa, exponent = math.frexp(x)
    return max(exponent - (mantissa == 0.5), 0)


def fading_sum(values: Floats, share: float) -> Floats:
    """Each value and what is left of those before it.

    Parameters
    ----------
    values : ndarray, shape (n,)
        One after the other. [any]
    share : float
        What is left of a value when the next one comes. [1]

    Returns
    -------
    ndarray, shape (n,)
        Sums. [any]
    """
    out = np.array(values, dtype=np.float64)
    library.fading_sum(len(out), share, address(out))
    return out


# --- matrices -------------------------------------------------------------------------------------


def product(a: Any, b: Any, out: Floats | None = None) -> Any:
    """Matrix product `a @ b` of vectors and matrices, each entry summed in the order of its index.

    Parameters
    ----------
    a, b : ndarray, shapes (m, k) or (k,), and (k, n) or (k,)
        Real or complex. [any]
    out : ndarray, shape (m, n), optional
        Where the product of two real matrices goes; default a new one. [any]

    Returns
    -------
    ndarray or float, shape (m, n)
        Without the axis that a vector lacks. [any]
    """
    if a.dtype.kind == "c" or b.dtype.kind == "c":
        return _complex_product(a, b)
    left = a if a.ndim == 2 else a[None]
    right = b if b.ndim == 2 else b[:, None]
    (m, k), (inner, n) = left.shape, right.shape
    if k != inner:
        raise InternalError(f"a product of shapes {a.shape} and {b.shape}")
    if min(m, n, k) > LARGE:
        return np.matmul(a, b, out=out)
    left = np.ascontiguousarray(left, dtype=np.float64)
    right = np.ascontiguousarray(right, dtype=np.float64)
    if out is None:
        out = np.empty((m, n))
    elif out.shape != (m, n):
        raise InternalError(f"a product of shape {(m, n)} into an array of shape {out.shape}")
    library.product(m, n, k, address(left), address(right), address(out))
    if a.ndim == b.ndim == 2:
        return out
    return out.reshape(a.shape[:-1] + b.shape[1:]) if a.ndim + b.ndim > 2 else float(out[0, 0])


def _complex_product(a: Any, b: Any) -> Any:
    """Of matrices of which at least one is complex, from products of their parts."""
    real = product(a.real, b.real)
    out = np.empty(np.shape(real), dtype=np.complex128)
    if a.dtype.kind != "c" or b.dtype.kind != "c":
        out.real = real
        out.imag = product(a, b.imag) if b.dtype.kind == "c" else product(a.imag, b)
    else:
        out.real = real - product(a.imag, b.imag)
        out.imag = product(a.real, b.imag) + product(a.imag, b.real)
    return out


def along_first(a: Any, b: Any) -> Any:
    """Sum over the last axis of `a`, a matrix or a vector, and the first of `b`, which has any others."""
    flat = b.reshape(len(b), math.prod(b.shape[1:]))
    return product(a, flat).reshape(a.shape[:-1] + b.shape[1:])


def norm(vector: Floats) -> float:
    """Length of a vector.

    Parameters
    ----------
    vector : ndarray, shape (n,)
        Vector. [any]

    Returns
    -------
    float
        Root of the sum of its squares. [any]
    """
    return math.sqrt(product(vector, vector))


#: Of `solve` and of `ComplexSystems`.
SINGULAR = "linear equations without a solution: a pivot is zero"


def solve(a: Floats, b: Floats) -> Floats:
    """Solution x of a x = b by elimination with row pivoting.

    Parameters
    ----------
    a : ndarray, shape (n, n)
        Matrix. [any]
    b : ndarray, shape (n, r)
        Right-hand sides. [any]

    Returns
    -------
    ndarray, shape (n, r)
        Solutions. [any]

    Raises
    ------
    InternalError
        If a pivot is zero.
    """
    x = np.array(b, dtype=np.float64, order="C")
    factors = np.array(a, dtype=np.float64, order="C")
    if not library.solve_real(*x.shape, address(factors), address(x)):
        raise InternalError(SINGULAR)
    return x


class ComplexSystems:
    """Complex linear equations a x = b, factored once by elimination with row pivoting."""

    def __init__(self, a: Complexes) -> None:
        """
        Parameters
        ----------
        a : ndarray, shape (count, n, n)
            Matrices. [any]

        Raises
        ------
        InternalError
            If a pivot is zero.
        """
        self._systems = np.ascontiguousarray(a, dtype=np.complex128)
        count, n, _ = a.shape
        self._factors, self._rows = np.empty((count, 2, n, n)), np.empty((count, n), dtype=np.int64)
        if not library.factor_complex(
            count,
            n,
            ffi.from_buffer("double[]", self._systems),
            address(self._factors),
            address(self._rows, "int64_t"),
        ):
            raise InternalError(SINGULAR)

    def solve(self, b: Complexes) -> Complexes:
        """Solutions, each corrected once by its residual.

        Parameters
        ----------
        b : ndarray, shape (count, n, r)
            Right-hand sides. [any]

        Returns
        -------
        ndarray, shape (count, n, r)
            Solutions. [any]
        """
        x = np.array(b, dtype=np.complex128, order="C")
        count, n, r = x.shape
        room = np.empty(4 * n * r)
        library.solve_complex(
            count, n, r, ffi.from_buffer("double[]", self._systems), address(self._factors), address(self._rows, "int64_t"),
            ffi.from_buffer("double[]", x), address(room),
        )  # fmt: skip
        return x


#: Of `svd`.
NOT_CONVERGED = "the Jacobi SVD did not converge"


def svd(a: Floats) -> tuple[Floats, Floats, Floats]:
    """Singular value decomposition by one-sided Jacobi rotations, values falling.

    Rows sorted by size, QR with column pivoting, then rotations of the rows of R until they are orthogonal:
    accurate to the rounding of each entry also where rows and columns are scaled by many powers of ten.

    Parameters
    ----------
    a : ndarray, shape (m, n) or (count, m, n)
        A matrix, or several: each has the bits that it has alone. [any]

    Returns
    -------
    left : ndarray, shape (m, min(m, n)) or (count, m, min(m, n))
        Left singular vectors. [1]
    sigma : ndarray, shape (min(m, n),) or (count, min(m, n))
        Singular values. [any]
    right : ndarray, shape (n, min(m, n)) or (count, n, min(m, n))
        Right singular vectors. [1]

    Raises
    ------
    InternalError
        If the rotations do not converge.

    References
    ----------
    Demmel & Veselić, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13 (1992) 1204-1245;
    Drmač & Veselić, "New fast and accurate Jacobi SVD algorithm I", SIAM J. Matrix Anal. Appl. 29 (2008) 1322-1342.
    """
    matrices = a if a.ndim == 3 else a[None]
    wide = matrices.shape[1] < matrices.shape[2]
    tall = matrices.transpose(0, 2, 1) if wide else matrices
    count, m, n = tall.shape
    own = np.arange(count)[:, None]
    size = np.max(np.abs(tall), axis=2, initial=0.0)
    unit = np.ldexp(1.0, np.frexp(np.max(size, axis=1, initial=0.0))[1])  # no square overflows
    rows = np.argsort(-size, axis=1, kind="stable")
    columns = np.ascontiguousarray((tall[own, rows] / unit[:, None, None]).transpose(0, 2, 1))
    left, sigma, right = np.empty((count, n, m)), np.empty((count, n)), np.empty((count, n, n))
    order, room = np.empty(n, dtype=np.int64), np.empty(2 * n * (n + 1))
    for parts in zip(columns, left, sigma, right, strict=True):
        if not library.jacobi_svd(
            m, n, *map(address, parts), address(order, "int64_t"), address(room)
        ):
            raise InternalError(NOT_CONVERGED)
    if not np.all(np.isfinite(sigma)):
        raise InternalError(NOT_CONVERGED)
    falling = np.argsort(-sigma, axis=1, kind="stable")
    u = np.empty((count, m, n))
    u[own, rows] = left[own, falling].transpose(0, 2, 1)
    v = np.ascontiguousarray(right[own, falling].transpose(0, 2, 1))
    sigma = sigma[own, falling] * unit[:, None]
    triplets = (v, sigma, u) if wide else (u, sigma, v)
    return triplets if a.ndim == 3 else (triplets[0][0], triplets[1][0], triplets[2][0])


def right_basis(a: Floats, rank: int) -> tuple[Floats, Floats]:
    """All right singular vectors, also those of values that are zero, and the values, falling.

    Parameters
    ----------
    a : ndarray, shape (m, n)
        Matrix. [any]
    rank : int
        Number of its values that are not zero. [count]

    Returns
    -------
    sigma : ndarray, shape (n,)
        Singular values, zero from `rank` on. [any]
    right : ndarray, shape (n, n)
        Orthonormal columns. [1]
    """
    n = a.shape[1]
    _, sigma, right = svd(np.concatenate([a, np.zeros((max(n - len(a), 0), n))]))
    sigma[rank:] = 0.0
    if rank < n:  # what the others leave of the space
        rest = np.eye(n) - product(right[:, :rank], right[:, :rank].T)
        right[:, rank:] = svd(rest)[0][:, : n - rank]
    return sigma, right


def singular_values(a: Floats) -> Floats:
    """Singular values by one-sided Jacobi rotations.

    Parameters
    ----------
    a : ndarray, shape (m, n)
        Matrix. [any]

    Returns
    -------
    ndarray, shape (min(m, n),)
        Values, falling. [any]
    """
    return svd(a)[1]


def eigenvalues(a: Floats) -> Complexes:
    """Eigenvalues of a real matrix by the QR algorithm with double shifts.

    Parameters
    ----------
    a : ndarray, shape (n, n)
        Real matrix. [any]

    Returns
    -------
    ndarray of complex, shape (n,)
        Eigenvalues. [any]

    Raises
    ------
    InternalError
        If it does not converge.
    """
    n = len(a)
    falling = np.argsort(-np.max(np.abs(a), axis=1, initial=0.0), kind="stable")
    matrix = np.ascontiguousarray(a[np.ix_(falling, falling)])  # so small ones keep their digits
    real, imaginary = np.empty((2, n))
    if not library.eigenvalues(n, *map(address, (matrix, real, imaginary))):
        raise InternalError("the QR algorithm did not converge")
    return real + 1j * imaginary


def matrix_exponential(a: Floats) -> Floats:
    """Exponential of a square matrix: Padé approximation of degree 13 of the matrix halved so often, squared again.

    Parameters
    ----------
    a : ndarray, shape (n, n)
        Real matrix. [1]

    Returns
    -------
    ndarray, shape (n, n)
        Its exponential. [1]
    """
    size = float(np.max(np.abs(a).sum(axis=0), initial=0.0))
    halvings = max(math.frexp(size / PADE_NORM)[1], 0)
    odd, even = _pade(a * math.ldexp(1.0, -halvings), product)
    found = solve(even - odd, even + odd)
    for _ in range(halvings):
        found = product(found, found)
    return np.asarray(found)


def half_and_whole(a: Floats) -> tuple[Floats, Floats]:
    """Exponentials of half a square matrix and of all of it.

    Parameters
    ----------
    a : ndarray, shape (n, n)
        Real matrix. [1]

    Returns
    -------
    half, whole : ndarray, shape (n, n)
        [1]
    """
    half = matrix_exponential(0.5 * a)
    return half, product(half, half)


def _pade(a: Floats, multiply: Callable[[Floats, Floats], Floats]) -> tuple[Floats, Floats]:
    """Odd and even part of the numerator of the Padé approximation of an exponential."""
    two = multiply(a, a)
    four = multiply(two, two)
    six = multiply(two, four)
    c, eye = PADE, np.eye(a.shape[-1])
    odd = multiply(six, c[13] * six + c[11] * four + c[9] * two)
    odd = multiply(a, odd + c[7] * six + c[5] * four + c[3] * two + c[1] * eye)
    even = multiply(six, c[12] * six + c[10] * four + c[8] * two)
    return odd, even + c[6] * six + c[4] * four + c[2] * two + c[0] * eye


def products(a: Any, b: Any) -> Any:
    """Matrix products of two stacks, each entry summed in the order of its index.

    Parameters
    ----------
    a, b : ndarray, shapes (count, m, k) and (count, k, n)
        Real. [any]

    Returns
    -------
    ndarray, shape (count, m, n)
        One after the other. [any]
    """
    found = a[..., :, 0, None] * b[..., None, 0, :]
    for k in range(1, a.shape[-1]):
        found += a[..., :, k, None] * b[..., None, k, :]
    return found


def matrix_exponentials(a: Floats) -> Floats:
    """Exponentials of a stack of square matrices, as `matrix_exponential` has them.

    Parameters
    ----------
    a : ndarray, shape (count, n, n)
        Real matrices. [1]

    Returns
    -------
    ndarray, shape (count, n, n)
        Their exponentials. [1]
    """
    size = np.max(np.abs(a).sum(axis=1), axis=1)
    halvings = np.maximum(np.frexp(size / PADE_NORM)[1], 0)
    odd, even = _pade(np.ldexp(a, -halvings[:, None, None]), products)
    numerator, denominator = ((even + s * odd).astype(np.complex128) for s in (1.0, -1.0))
    found = np.ascontiguousarray(ComplexSystems(denominator).solve(numerator).real)
    for k in range(int(np.max(halvings, initial=0))):
        left = halvings > k
        found[left] = products(found[left], found[left])
    return found
