"""Notches, strength factors and Goodman against worked examples, and the fillet against the equation of torsion.

Shigley  R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, 9th edition (2011), examples 6-3 and 6-6, Table
         6-5; and problem 7-2 of its solutions manual (8th edition)
Brown    T. H. Brown, Marks' Calculations for Machine Design (2005), chapter 7, example 3, pages 305 to 310
Gere     J. M. Gere, Mechanics of Materials, problems 3.11-3 and 3.11-5, factors read from its Figure 3-48
Michell  the twist of a body of revolution, solved by finite elements (test_torsion_of_steps.py)
"""

from __future__ import annotations

import numpy as np
import pytest
from test_torsion_of_steps import revolution_twist, step_mesh

from engine.case.choices import SurfaceFinish
from engine.case.fatigue_tables import KPSI, RELIABILITIES
from engine.fatigue.mean_stress import SHEAR_ULTIMATE_RATIO, reversed_amplitude
from engine.fatigue.notches import (
    fatigue_concentration,
    fillet_concentration,
    keyway_concentration,
    neuber_sensitivity,
)
from engine.fatigue.sn_curve import SNCurve
from engine.fatigue.strength_factors import lowered_line, size_factor, surface_factor

MPA = 1e6


def test_surface_factors_of_shigley_and_brown():
    assert surface_factor(SurfaceFinish.MACHINED, 520 * MPA) == pytest.approx(0.860, abs=5e-4)
    assert surface_factor(SurfaceFinish.AS_FORGED, 520 * MPA) == pytest.approx(0.540, abs=5e-4)
    assert surface_factor(SurfaceFinish.MACHINED, 1226 * MPA) == pytest.approx(0.685, abs=5e-4)
    assert surface_factor(SurfaceFinish.AS_FORGED, 630 * MPA) == pytest.approx(0.45, abs=5e-3)
    ground = surface_factor(SurfaceFinish.GROUND, 690 * MPA)  # a spreadsheet of example 6-6
    assert ground == pytest.approx(0.906473, abs=5e-7)


def test_the_tables_in_kpsi_and_in_megapascals_agree():
    """Both columns of Table 6-2; they are rounded to three digits."""
    kpsi = {"ground": (1.34, -0.085), "machined": (2.70, -0.265), "hot-rolled": (14.4, -0.718), "as-forged": (39.9, -0.995)}  # fmt: skip
    for finish in SurfaceFinish:
        a, b = kpsi[finish]
        for uts in (80.0, 120.0, 180.0):
            assert surface_factor(finish, uts * KPSI) == pytest.approx(a * uts**b, rel=4e-3)


def test_size_factors_of_shigley():
    assert size_factor(0.022) == pytest.approx(0.893, abs=5e-4)  # problem 7-2
    for inches in (0.5, 1.0, 1.9):
        assert size_factor(0.0254 * inches) == pytest.approx(0.879 * inches**-0.107, rel=1e-3)
    for inches in (2.1, 5.0, 10.0):
        assert size_factor(0.0254 * inches) == pytest.approx(0.91 * inches**-0.157, rel=2e-3)


def test_reliability_factors_are_those_of_eight_per_cent_deviation():
    variate = {0.5: 0.0, 0.9: 1.288, 0.95: 1.645, 0.99: 2.326, 0.999: 3.091, 0.9999: 3.719, 0.99999: 4.265, 0.999999: 4.753}  # fmt: skip
    assert set(variate) == set(RELIABILITIES)
    for share, z in variate.items():
        assert RELIABILITIES[share] == pytest.approx(1.0 - 0.08 * z, abs=5e-4)


def test_notch_sensitivity_in_torsion_of_example_6_6():
    """UTS 690 MPa, r = 3 mm: √a = 0.047211 √inch and q = 0.8792, in a spreadsheet of the example."""
    q = neuber_sensitivity(3e-3, 690 * MPA)
    assert q == pytest.approx(0.8792, abs=1e-4)
    # the Kts of the same sheet, 1.35 by chart A-15-8
    assert fatigue_concentration(1.35, q) == pytest.approx(1.0 + 0.8792 * 0.35, abs=1e-4)


def test_fillet_beside_factors_read_from_charts():
    """Shoulders with D, d, r: within 3 %, a chart read by eye, and never below by more than one."""
    for shoulder, diameter, radius, read in (
        (1.0, 0.7, 0.15, 1.20),
        (1.0, 0.8, 0.10, 1.29),
        (1.0, 0.9, 0.05, 1.41),
        (1.5, 1.30, 0.100, 1.38),
        (1.5, 1.35, 0.075, 1.41),
        (1.5, 1.40, 0.050, 1.46),
        (38.0, 32.0, 3.0, 1.35),
    ):
        found = fillet_concentration(shoulder, diameter, radius)
        assert -0.01 < found / read - 1.0 < 0.03


def solved_fillet(ratio: float, fillet: float, n: int = 32) -> float:
    """Largest shear stress on the fillet over 16 T/π d³; lengths are in thinner diameters."""
    mesh, rows, thick = step_mesh(ratio, fillet, 0.0, n)
    torque, angle = revolution_twist(mesh, rows[0], thick[-1])
    surface = np.array([row[-1] for row in rows])
    r, z, turn = np.array(mesh.x)[surface], np.array(mesh.y)[surface], angle[surface]
    along = np.hypot(np.diff(r), np.diff(z))
    stress = 0.5 * (r[1:] + r[:-1]) * np.abs(np.diff(turn)) / along  # over G
    return float(np.max(stress)) * np.pi / (16.0 * torque)


@pytest.mark.parametrize(
    ("ratio", "fillet"),
    [(1.1, 0.045), (1.15, 0.05), (1.2, 0.05), (1.2, 0.08), (1.33, 0.1), (1.5, 0.1), (1.5, 0.2), (2.0, 0.15), (2.0, 0.3)],
)  # fmt: skip
def test_fillet_against_the_equation_of_torsion(ratio: float, fillet: float):
    """The fit of the chart is up to 4 % above the solution, never below."""
    coarse, fine = solved_fillet(ratio, fillet, 16), solved_fillet(ratio, fillet, 32)
    assert fine == pytest.approx(coarse, rel=0.025)
    assert 1.0 < fillet_concentration(ratio, 1.0, fillet) / fine < 1.04


def test_keyway_is_at_least_the_estimate_of_shigley():
    """Table 7-1: Kts = 3.0 of an end-milled keyseat with r/d = 0.02; ours is the larger value at its end."""
    assert keyway_concentration(0.1, 0.002) == 3.4
    # 1.953 + 0.1434 × 10 − 0.0021 × 100 = 3.177 at r/d = 0.01; 3.981 at 0.005: the bottom decides
    assert keyway_concentration(0.1, 0.0005) == pytest.approx(3.981, abs=5e-4)


def test_goodman_in_torsion_of_brown():
    """Both systems of units: τa/Se + τm/Sus = 1.303 (n = 0.77), and with doubled limits 0.981 and 0.89."""
    for amplitude, endurance, mean, uts, ultimate, total in (
        (27.8, 43.2, 278.0, 630.0, 422.1, 1.303),
        (27.8, 86.4, 278.0, 630.0, 422.1, 0.981),
        (3.6, 12.4, 36.2, 90.0, 60.3, 0.89),
    ):
        assert SHEAR_ULTIMATE_RATIO * uts == pytest.approx(ultimate, abs=0.05)
        left = amplitude / endurance + mean / ultimate
        assert left == pytest.approx(total, abs=5e-3)
        # on the line itself a reversed amplitude is the endurance limit
        on_line = endurance * (1.0 - mean / ultimate)
        assert reversed_amplitude(on_line, mean, ultimate) == pytest.approx(endurance, rel=1e-12)
        found = float(reversed_amplitude(amplitude, mean, ultimate))
        assert (found > endurance) is (left > 1.0)


def test_lowered_line_is_that_of_shigley():
    """From f Sut at 10³ to Se at 10⁶ cycles: S = a N^b, a = (f Sut)²/Se, b = −⅓ log(f Sut/Se) (Eqs. 6-14, 6-15)."""
    high, data, factor = 0.9 * 420 * MPA, 210 * MPA, 0.6
    line = lowered_line(SNCurve(np.array([1e3, 1e6]), np.array([high, data]), data), factor)
    endurance = factor * data
    a, b = high**2 / endurance, -np.log10(high / endurance) / 3.0
    assert line.endurance == pytest.approx(endurance, rel=1e-12)
    for stress in (0.95 * high, 0.6 * high, 1.05 * endurance):
        expected = (stress / a) ** (1.0 / b)
        assert line.cycles_to_failure(stress) == pytest.approx(expected, rel=1e-9)
