"""What must hold of every motor: symmetry and power, whatever its reactances."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import example_count

from engine.motor.circuit import Circuit, Step, Winding, line_omega, rotor_windings
from engine.motor.curves import operational_reactances, slip_curves

MANY = example_count(200)
SLIPS = np.array([1.0, 0.7, 0.5, 0.31, 0.04, 1e-6])


def numbers(low, high):
    return st.floats(low, high, allow_nan=False)


def windings(most):
    return st.lists(st.builds(Winding, numbers(1e-4, 0.3), numbers(0.0, 0.4)), max_size=most).map(
        tuple
    )


circuits = st.builds(
    Circuit,
    numbers(0.0, 0.05), numbers(0.02, 0.3), numbers(0.2, 4.0), numbers(0.1, 4.0),
    st.none() | st.builds(Winding, numbers(1e-4, 0.1), numbers(0.0, 0.4)), windings(2), windings(2),
    numbers(0.0, 0.2),
)  # fmt: skip


@MANY
@given(circuits)
def test_without_stator_resistance_braking_mirrors_driving(circuit):
    circuit = replace(circuit, stator_resistance=0.0)
    below, above = slip_curves(circuit, SLIPS), slip_curves(circuit, -SLIPS)
    np.testing.assert_allclose(above.average, -below.average, rtol=1e-9, atol=1e-12)
    pulsation = below.pulsating * np.exp(1j * below.phase)
    mirrored = above.pulsating * np.exp(1j * above.phase)
    np.testing.assert_allclose(mirrored, -pulsation.conj(), rtol=1e-9, atol=1e-12)


@MANY
@given(circuits, numbers(1e-3, 0.05))
def test_power_is_balanced(circuit, resistance):
    """What the line gives is what the shaft takes and what every winding heats."""
    circuit = replace(
        circuit, stator_resistance=resistance
    )  # at half speed two equations else are one
    curves = slip_curves(circuit, SLIPS)
    xd, xq = operational_reactances(circuit, SLIPS)
    turn = 1.0 - SLIPS
    own_d, own_q = resistance + 1j * SLIPS * xd, resistance + 1j * SLIPS * xq
    a = np.moveaxis(np.array([[own_d, -turn * xq], [turn * xd, own_q]]), 2, 0)
    current = np.linalg.solve(a, np.array([[1.0], [-1j]]))[..., 0].T
    given_ = (0.5 * (current[0].conj() - 1j * current[1].conj())).real
    heat = resistance * curves.current**2
    field = () if circuit.field is None else (circuit.field,)
    for i, x, rotor, common in (
        (current[0], xd, (*field, *circuit.dampers_d), circuit.common_leakage_d),
        (current[1], xq, circuit.dampers_q, 0.0),
    ):
        # voltage behind what is common to the windings of the axis
        own = 1j * SLIPS * (x - circuit.stator_leakage) * i
        of_gap = circuit.magnetising_d if rotor is not circuit.dampers_q else circuit.magnetising_q
        into_rotor = i - own / (1j * SLIPS * of_gap)
        voltage = own - 1j * SLIPS * common * into_rotor
        for r, x_own in rotor:
            heat += 0.5 * r * abs(voltage / (r + 1j * SLIPS * x_own)) ** 2
    np.testing.assert_allclose(given_, turn * curves.average + heat, rtol=1e-8, atol=1e-10)
    total = np.hypot(abs(current[0]), abs(current[1])) / np.sqrt(2.0)
    np.testing.assert_allclose(curves.current, total, rtol=1e-8)


@st.composite
def data_sheets(draw):
    """Reactances that fall by at least a hundredth from winding to winding, and time constants."""
    reactances = [draw(numbers(0.02, 0.2))]
    for gap in ((0.01, 0.2), (0.01, 0.3), (0.1, 2.0)):
        reactances.append(reactances[-1] + draw(numbers(*gap)))
    leakage, subtransient, transient, synchronous = reactances
    times = draw(numbers(0.5, 10.0)), draw(numbers(0.005, 0.3))
    return leakage, synchronous, (Step(transient, times[0]), Step(subtransient, times[1]))


@MANY
@given(data_sheets())
def test_the_circuit_shows_the_reactances_of_the_data_sheet(sheet):
    """Very fast changes meet Xd'', and Xd' where the damper is left out; slow ones meet Xd."""
    leakage, synchronous, steps = sheet
    found = rotor_windings(synchronous, leakage, steps, line_omega(50.0))
    for count, expected in ((0, synchronous), (1, steps[0].reactance), (2, steps[1].reactance)):
        circuit = Circuit(0.0, leakage, synchronous - leakage, 1.0, None, found[:count], ())
        fast, _ = operational_reactances(circuit, np.array([1e9]))
        assert fast[0].real == pytest.approx(expected, rel=1e-9)
    slow, _ = operational_reactances(circuit, np.array([0.0]))
    assert slow[0] == pytest.approx(synchronous, rel=1e-12)


@MANY
@given(data_sheets())
def test_short_circuit_time_constants_are_the_open_ones_less_what_the_stator_takes(sheet):
    leakage, synchronous, steps = sheet
    before = (synchronous, steps[0].reactance)
    short = [Step(x, t * x / b, True) for (x, t, _), b in zip(steps, before, strict=True)]
    found = [rotor_windings(synchronous, leakage, s, 314.0) for s in (steps, short)]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-12)
