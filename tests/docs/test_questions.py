"""Recipes of docs/questions.md against models that do not use them."""

import numpy as np
import pytest
from scipy.linalg import eigh
from trains import motor as motor_curve

from engine.case.case import Case
from engine.case.data import ElementRow, StationRow
from engine.model.subdivision import natural_modes

SUN, PLANET, RING, PLANETS = 20, 31, 82, 3
MODULE = 0.006


def epicyclic_frequencies(inertia, stiffness):
    """Sun, carrier, planets that spin, ring held; machines on both shafts. In Hz."""
    motor, sun, carrier, planet, load, mass = inertia
    shaft_in, shaft_out, k_sp, k_pr = stiffness
    r_s, r_p, r_r = (0.5 * MODULE * z for z in (SUN, PLANET, RING))
    r_bs, r_bp, r_br = (r * np.cos(np.radians(20.0)) for r in (r_s, r_p, r_r))
    m = np.diag(
        [motor, sun, carrier + PLANETS * mass * (r_s + r_p) ** 2, load, PLANETS * planet]
    )  # motor, sun, carrier, load, planets (all turn alike)
    k = np.zeros((5, 5))
    for strength, shape in (
        (shaft_in, [1.0, -1.0, 0.0, 0.0, 0.0]),
        (shaft_out, [0.0, 0.0, 1.0, -1.0, 0.0]),
        (PLANETS * k_sp, [0.0, r_bs, -r_bs - r_bp, 0.0, r_bp]),
        (PLANETS * k_pr, [0.0, 0.0, r_br - r_bp, 0.0, r_bp]),
    ):
        k += strength * np.outer(shape, shape)
    squares = eigh(k, m, eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)


def test_the_equivalent_pair_of_an_epicyclic_gear_has_its_modes():
    motor, sun, carrier, planet, load, mass = inertia = (80.0, 0.4, 6.0, 0.08, 900.0, 14.0)
    shaft_in, shaft_out, k_sp, k_pr = stiffness = (4e6, 3e7, 1.2e9, 1.5e9)
    ratio = 1.0 / (1.0 + RING / SUN)
    r_bs = 0.5 * MODULE * SUN * np.cos(np.radians(20.0))
    a = 0.5 * MODULE * (SUN + PLANET)
    case = Case(
        line_frequency=60.0,
        poles=4,
        damping_ratio=0.01,
        motor_torque=motor_curve("Motor"),
        stations=(
            StationRow("Motor", None, motor, 1.0),
            StationRow("Sun", None, sun, 1.0),
            StationRow(
                "Carrier",
                None,
                carrier + PLANETS * (mass * a**2 + planet * (RING / PLANET - 1) ** 2),
                ratio,
            ),
            StationRow("Load", None, load, ratio),
        ),
        elements=(
            ElementRow("In", "shaft", "Motor", "Sun", shaft_in),
            ElementRow(
                "Gear", "gear mesh", "Sun", "Carrier", PLANETS * r_bs**2 / (1 / k_sp + 1 / k_pr)
            ),
            ElementRow("Out", "shaft", "Carrier", "Load", shaft_out),
        ),
    )
    exact = epicyclic_frequencies(inertia, stiffness)
    found = natural_modes(case).modes.frequency
    assert exact[0] == pytest.approx(0.0, abs=1e-3)
    assert found[0] == pytest.approx(0.0, abs=1e-3)
    assert found[1:3] == pytest.approx(exact[1:3], rel=1e-2)
