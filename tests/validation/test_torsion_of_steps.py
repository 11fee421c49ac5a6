"""Torsion of steps and keyways, solved by finite elements, against the formulas of `engine/model/sections.py`.

Step: the body of revolution under torque, rotation φ(r, z) of its rings, ∇·(r³ ∇φ) = 0 with free surfaces
(J. H. Michell 1899; Timoshenko and Goodier, Theory of Elasticity, § 119). A displacement solution is too stiff, so
the added length grows with refinement; two meshes give the limit. Bound: a rigid disc on a half-space turns by
T = 16/3 G a³ θ (E. Reissner and H. F. Sagoci, J. Appl. Phys. 15 (1944) 652), so a shaft on a half-space adds at
least 3π/64 of its diameter.

Keyway: Prandtl's stress function, ∇²ψ = −2, torsion constant 2 ∫ψ dA (the same, § 104). A shaft with a round groove
has a closed solution (the same, § 108: ψ = ½ (b² − r²) (1 − 2 a cos θ / r) of a groove of radius b centred on the rim
of a shaft of radius a), which the solver of the keyway is tried on.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from engine.arrays import Floats
from engine.model.sections import keyway_loss, step_length

GAUSS = ((-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9))


def towards(a: float, b: float, n: int, *, start: bool = False, end: bool = False) -> Floats:
    """Points from a to b, denser at the ends named."""
    t = np.linspace(0.0, 1.0, n + 1)
    if start and end:
        s = np.where(t < 0.5, 2.0 * t**2, 1.0 - 2.0 * (1.0 - t) ** 2)
    elif start:
        s = t**2
    elif end:
        s = 1.0 - (1.0 - t) ** 2
    else:
        s = t
    return a + (b - a) * s


def matrix(values: Floats, cells: Floats, n: int) -> csr_matrix:
    """Sum of element matrices."""
    k = cells.shape[1]
    rows, columns = np.repeat(cells, k, axis=1).ravel(), np.tile(cells, (1, k)).ravel()
    return csr_matrix((values.ravel(), (rows, columns)), shape=(n, n))


class Mesh:
    """Quadrilaterals between rows of points."""

    def __init__(self) -> None:
        self.x: list[float] = []
        self.y: list[float] = []
        self.cells: list[Floats] = []

    def row(self, x: Floats, y: Floats) -> Floats:
        """Numbers of new points."""
        first = len(self.x)
        self.x += list(x)
        self.y += list(y)
        return np.arange(first, first + len(x))

    def between(self, a: Floats, b: Floats) -> None:
        """Cells between two rows, as far as the shorter reaches."""
        n = min(len(a), len(b))
        a, b = a[:n], b[:n]
        self.cells.append(np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1))


def revolution_stiffness(mesh: Mesh, fixed: Floats, turned: Floats) -> float:
    """Torque over G for one radian between two rows of points."""
    return revolution_twist(mesh, fixed, turned)[0]


def revolution_twist(mesh: Mesh, fixed: Floats, turned: Floats) -> tuple[float, Floats]:
    """Torque over G for one radian between two rows of points, and the rotation of every point."""
    r, z, cells = np.array(mesh.x), np.array(mesh.y), np.concatenate(mesh.cells)
    x, y = r[cells], z[cells]
    values = np.zeros((len(cells), 4, 4))
    for a, wa in GAUSS:
        for b, wb in GAUSS:
            shape = (
                np.array(
                    [(1 - a) * (1 - b), (1 + a) * (1 - b), (1 + a) * (1 + b), (1 - a) * (1 + b)]
                )
                / 4
            )
            da = np.array([b - 1, 1 - b, 1 + b, -1 - b]) / 4
            db = np.array([a - 1, -1 - a, 1 + a, 1 - a]) / 4
            xa, xb, ya, yb = x @ da, x @ db, y @ da, y @ db
            det = xa * yb - xb * ya
            gx = (np.outer(yb, da) - np.outer(ya, db)) / det[:, None]
            gy = (np.outer(xa, db) - np.outer(xb, da)) / det[:, None]
            weight = wa * wb * np.abs(det) * (x @ shape) ** 3
            values += weight[:, None, None] * (
                gx[:, :, None] * gx[:, None, :] + gy[:, :, None] * gy[:, None, :]
            )
    K = matrix(values, cells, len(r))
    angle = np.zeros(len(r))
    angle[turned] = 1.0
    free = np.ones(len(r), dtype=bool)
    free[fixed] = free[turned] = False
    angle[free] = spsolve(K[free][:, free].tocsc(), -(K @ angle)[free])
    return float(2.0 * math.pi * angle @ (K @ angle)), angle


def step_mesh(
    ratio: float, fillet: float, bore: float, n: int
) -> tuple[Mesh, list[Floats], list[Floats]]:
    """Mesh of a step, its rows of points in the thinner and in the thicker shaft; lengths are in thinner diameters."""
    a, A, c, f = 0.5, 0.5 * ratio, 0.5 * bore, fillet
    before, behind = 1.5, 1.5 * ratio
    share = (towards(c, a, n, end=f == 0.0) - c) / (a - c)
    at = [(z, a) for z in towards(-before - f, -f, 2 * n, end=True)]
    if f > 0.0:
        arc = np.linspace(0.0, 0.5 * math.pi, 2 * n + 1)[1:]
        at += [(-f + f * math.sin(t), a + f - f * math.cos(t)) for t in arc]
    mesh = Mesh()
    rows = [mesh.row(c + share * (R - c), np.full(len(share), z)) for z, R in at]
    beyond = towards(a + f, A, n, start=True, end=True)[1:]
    across = np.concatenate([c + share * (a + f - c), beyond])
    shoulder = np.concatenate([rows[-1], mesh.row(beyond, np.zeros(len(beyond)))])
    thick = [shoulder]
    thick += [
        mesh.row(across, np.full(len(across), z))
        for z in towards(0.0, behind, 2 * n, start=True)[1:]
    ]
    for chain in (rows, thick):
        for p, q in zip(chain[:-1], chain[1:], strict=True):
            mesh.between(p, q)
    return mesh, rows, thick


def coarse_step(ratio: float, fillet: float, bore: float, n: int) -> float:
    """Added length over the thinner diameter, on one mesh; lengths are in thinner diameters."""
    a, A, c, f = 0.5, 0.5 * ratio, 0.5 * bore, fillet
    before, behind = 1.5, 1.5 * ratio
    mesh, rows, thick = step_mesh(ratio, fillet, bore, n)
    polar, wide = (0.5 * math.pi * (R**4 - c**4) for R in (a, A))
    twist = (
        1.0 / revolution_stiffness(mesh, rows[0], thick[-1]) - (before + f) / polar - behind / wide
    )
    return twist * polar / (1.0 - polar / wide)


def solved_step(ratio: float, fillet: float = 0.0, bore: float = 0.0) -> float:
    """Its limit: errors fall with the square of the mesh."""
    coarse, fine = (coarse_step(ratio, fillet, bore, n) for n in (16, 32))
    return fine + (fine - coarse) / 3.0


def groove_ratio(bottom: Floats, across: Floats, n: int) -> float:
    """Torsion constant over that of the full circle of radius 0.5, from a slot or groove at the top.

    `bottom` is the depth of the slot below the crown at each of `across`, from its middle to its edge.
    """
    R, edge = 0.5, float(across[-1])
    rim = math.sqrt(R * R - edge * edge)
    below, above = towards(0.0, 1.0, 2 * n, end=True), towards(0.0, 1.0, n, start=True)[1:]
    mesh, columns, fixed = Mesh(), [], []
    for x, depth in zip(across, bottom, strict=True):
        s, top = math.sqrt(R * R - x * x), R - depth
        y = -s + (top + s) * below
        if x == edge and top < rim - 1e-12:
            y = np.concatenate([y, top + (rim - top) * above])
            columns.append(mesh.row(np.full(len(y), x), y))
            fixed += [columns[-1][0], *columns[-1][2 * n :]]
        else:
            columns.append(mesh.row(np.full(len(y), x), y))
            fixed += [columns[-1][0], columns[-1][-1]]
    last = R - bottom[-1]
    for angle in towards(math.asin(edge / R), 0.5 * math.pi, 2 * n, start=True)[1:]:
        x, s = R * math.sin(angle), R * math.cos(angle)
        middle = last * s / rim
        y = np.concatenate([-s + (middle + s) * below, middle + (s - middle) * above])
        y = y[: len(columns[-1])]
        columns.append(mesh.row(np.full(len(y), x), y))
        fixed += [columns[-1][0], columns[-1][-1]]
    for p, q in zip(columns[:-1], columns[1:], strict=True):
        mesh.between(p, q)
    x, y, quads = np.array(mesh.x), np.array(mesh.y), np.concatenate(mesh.cells)
    cells = np.concatenate([quads[:, [0, 3, 2]], quads[:, [0, 2, 1]]])
    X, Y = x[cells], y[cells]
    dx = np.stack([Y[:, 1] - Y[:, 2], Y[:, 2] - Y[:, 0], Y[:, 0] - Y[:, 1]], axis=1)
    dy = np.stack([X[:, 2] - X[:, 1], X[:, 0] - X[:, 2], X[:, 1] - X[:, 0]], axis=1)
    area = 0.5 * (dx[:, 0] * dy[:, 1] - dx[:, 1] * dy[:, 0])
    real = area > 1e-16  # cells at the right end of the circle have no area
    cells, dx, dy, area = cells[real], dx[real], dy[real], area[real]
    values = (dx[:, :, None] * dx[:, None, :] + dy[:, :, None] * dy[:, None, :]) / (4.0 * area)[
        :, None, None
    ]
    K = matrix(values, cells, len(x))
    load = np.bincount(cells.ravel(), np.repeat(2.0 * area / 3.0, 3), len(x))
    free = np.ones(len(x), dtype=bool)
    free[fixed] = False
    psi = np.zeros(len(x))
    psi[free] = spsolve(K[free][:, free].tocsc(), load[free])
    return float(2.0 * load @ psi / (math.pi * R**4 / 2.0))  # both halves of the section


def limit(ratios: list[float]) -> float:
    return ratios[1] + (ratios[1] - ratios[0]) / 3.0


def solved_keyway(width: float, depth: float) -> float:
    """Loss of a rectangular keyway, width and depth over the diameter."""
    meshes = ((n, towards(0.0, 0.5 * width, n, end=True)) for n in (16, 32))
    return 1.0 - limit([groove_ratio(np.full(n + 1, depth), across, n) for n, across in meshes])


# --- steps ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [1.05, 1.25, 1.6, 2.2, 5.0])
def test_added_length_of_a_sharp_step(ratio: float) -> None:
    assert step_length(ratio) == pytest.approx(solved_step(ratio), abs=6e-4)


@pytest.mark.parametrize(
    ("ratio", "fillet"), [(1.2, 0.04), (1.4, 0.15), (1.6, 0.08), (2.2, 0.22), (4.0, 0.05)]
)
def test_added_length_with_a_fillet(ratio: float, fillet: float) -> None:
    assert step_length(ratio, fillet) == pytest.approx(solved_step(ratio, fillet), abs=6e-4)


@pytest.mark.parametrize(("bore", "within"), [(0.3, 6e-4), (0.5, 8e-4), (0.7, 2e-3), (0.8, 5e-3)])
@pytest.mark.parametrize("fillet", [0.0, 0.1])
@pytest.mark.parametrize("ratio", [1.3, 2.0])
def test_added_length_of_hollow_shafts(
    ratio: float, fillet: float, bore: float, within: float
) -> None:
    assert step_length(ratio, fillet, bore) == pytest.approx(
        solved_step(ratio, fillet, bore), abs=within
    )


def test_solution_keeps_the_bound_of_reissner_and_sagoci() -> None:
    bound = 3.0 * math.pi / 64.0
    large = solved_step(12.0)
    assert bound < large < 1.15 * bound
    assert step_length(1e6) > bound


def test_large_fillets_leave_nothing_to_add() -> None:
    assert step_length(1.75, 0.3) == 0.0


# --- keyways ----------------------------------------------------------------------------------------


def test_solver_agrees_with_the_closed_solution_of_a_round_groove() -> None:
    a, b = 0.5, 0.08  # shaft, groove
    # polar coordinates from the centre of the groove on the rim: the section is b < r < 2 a cos θ
    exact, _ = dblquad(
        lambda r, t: 0.5 * (b * b - r * r) * (1.0 - 2.0 * a * math.cos(t) / r) * r,
        0.0,
        math.acos(b / (2.0 * a)),
        lambda t: b,
        lambda t: 2.0 * a * math.cos(t),
    )
    exact = 2.0 * 2.0 * exact / (math.pi * a**4 / 2.0)
    edge = b * math.sqrt(1.0 - (b / (2.0 * a)) ** 2)  # where the groove meets the rim
    ratios = []
    for n in (16, 32):
        across = edge * np.sin(towards(0.0, 0.5 * math.pi, n))
        across[-1] = edge
        bottom = np.sqrt(b * b - across**2)
        ratios.append(groove_ratio(bottom, across, n))
    assert limit(ratios) == pytest.approx(exact, abs=1e-3)


@pytest.mark.parametrize(
    ("width", "depth"),
    [(0.12, 0.06), (0.1, 0.19), (0.2, 0.1), (0.25, 0.12), (0.33, 0.06), (0.33, 0.19)],
)
def test_loss_of_stiffness_by_a_keyway(width: float, depth: float) -> None:
    assert keyway_loss(width, depth) == pytest.approx(solved_keyway(width, depth), abs=5e-3)


# --- tapers -----------------------------------------------------------------------------------------


def solved_taper(ratio: float, length: float) -> float:
    """Compliance of a solid taper over that of its cylindrical slices in series; lengths over the thinner diameter."""
    twists = []
    for n in (16, 32):
        share, mesh = np.linspace(0.0, 1.0, n + 1), Mesh()
        rows = [
            mesh.row(share * (0.5 + 0.5 * (ratio - 1.0) * z), np.full(n + 1, length * z))
            for z in np.linspace(0.0, 1.0, 4 * n + 1)
        ]
        for p, q in zip(rows[:-1], rows[1:], strict=True):
            mesh.between(p, q)
        twists.append(1.0 / revolution_stiffness(mesh, rows[0], rows[-1]))
    slices = 32.0 * length * (1.0 - ratio**-3) / (3.0 * math.pi * (ratio - 1.0))
    return limit(twists) / slices


@pytest.mark.parametrize(
    ("ratio", "length", "within"), [(1.1, 1.0, 0.002), (1.5, 2.0, 0.01), (1.5, 1.0, 0.04)]
)
def test_a_taper_twists_like_its_slices(ratio: float, length: float, within: float) -> None:
    """Softer, the larger the angle: 14° of half angle in the last, the steepest that is read."""
    assert solved_taper(ratio, length) == pytest.approx(1.0, abs=within)
