"""Events in operation: responses to A e^(−t/τ) cos(m ω t + φ) in closed form, and by another integrator.

Two discs of one mode have a closed form, also where the torque meets the mode: in frequency without damping,
in frequency and decay with it. A geared train whose dampers couple the modes is integrated by scipy's DOP853
in angles and speeds, without modes.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.backlash.operating_events import operating_events
from engine.case.case import Case
from engine.case.data import (
    EffectChoiceRow,
    ElementRow,
    EventTorqueRow,
    MeshRow,
    ModeDampingRow,
    StationRow,
    TorqueTimeRow,
)
from engine.model.modal_analysis import analyse
from engine.start.decaying_harmonics import DecayingHarmonic, Tones, decaying_response
from engine.start.pieces import analysis_for_start
from engine.start.start import Start
from tests.trains import prepared

J1, J2, K = 40.0, 25.0, 2.0e6
OMEGA = math.sqrt(K * (1.0 / J1 + 1.0 / J2))
RATED = 10_000.0


def two_discs(ratio: float = 0.0, **fields: Any) -> Case:
    """One mode of 57.4 Hz with this damping ratio."""
    given: dict[str, Any] = {
        "line_frequency": 60.0,
        "poles": 4,
        "rated_torque": RATED,
        "damping_ratio": ratio,
        "stations": (
            StationRow("Motor", None, J1),
            StationRow("Load", None, J2, running_load=0.8 * RATED),
        ),
        "elements": (ElementRow("Shaft", "shaft", "Motor", "Load", K),),
    }
    return Case(**(given | fields))


def closed_form(term: DecayingHarmonic, ratio: float, t: np.ndarray) -> np.ndarray:
    """Torque of the shaft between two discs from rest; `term` acts on the first.

    x'' + 2 ζ ω x' + ω² x = Re(a e^(st)) has the particular solution c e^(st), where s is an eigenvalue c t e^(st).
    """
    s = complex(-term.decay, term.omega)
    a = term.amplitude / J1 * cmath.exp(1j * term.phase)
    eigen = complex(-ratio * OMEGA, OMEGA * math.sqrt(1.0 - ratio * ratio))
    distance = s * s + 2.0 * ratio * OMEGA * s + OMEGA * OMEGA
    if abs(distance) < 1e-9 * OMEGA * OMEGA:
        c = a / (2.0 * s + 2.0 * ratio * OMEGA)
        particular, x0, v0 = c * t * np.exp(s * t), 0.0, c.real
    else:
        c = a / distance
        particular, x0, v0 = c * np.exp(s * t), c.real, (c * s).real
    # free motion that takes position and speed at t = 0 away: x = Re(b e^(λt))
    b = complex(-x0, (v0 - eigen.real * x0) / eigen.imag)
    return np.asarray(K * (particular + b * np.exp(eigen * t)).real)


DAMPED = 0.02
CASES = {
    "step": (0.0, DecayingHarmonic(0, RATED)),
    "decaying step, damped": (DAMPED, DecayingHarmonic(0, -3.0 * RATED, decay=12.0)),
    "line frequency": (0.0, DecayingHarmonic(0, 5.0 * RATED, 0.7, 2.0 * math.pi * 60.0, 8.0)),
    "resonance without damping": (0.0, DecayingHarmonic(0, RATED, -math.pi / 2.0, OMEGA)),
    "resonance with damping": (DAMPED, DecayingHarmonic(0, RATED, 0.3, OMEGA)),
    "at an eigenvalue of the damped train": (
        DAMPED,
        DecayingHarmonic(0, RATED, 0.3, OMEGA * math.sqrt(1.0 - DAMPED**2), DAMPED * OMEGA),
    ),
    "near an eigenvalue": (
        DAMPED,
        DecayingHarmonic(0, RATED, 0.3, (1.0 + 1e-4) * OMEGA, DAMPED * OMEGA),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_two_discs_against_the_closed_form(name: str) -> None:
    ratio, term = CASES[name]
    train, modes, damping = prepared(two_discs(ratio))
    r = decaying_response(
        train, modes, Tones.of([term]), 2.0, 4001, damping_ratio=damping.structural
    )
    exact = closed_form(term, ratio, r.time)
    np.testing.assert_allclose(r.torque[0], exact, rtol=0.0, atol=1e-9 * np.max(np.abs(exact)))


def test_the_step_does_not_matter() -> None:
    """A hundred times fewer samples are the same samples."""
    ratio, term = CASES["line frequency"]
    train, modes, damping = prepared(two_discs(ratio))
    fine, coarse = (
        decaying_response(train, modes, Tones.of([term]), 1.0, n, damping_ratio=damping.structural)
        for n in (5000, 50)
    )
    scale = np.max(np.abs(fine.torque))
    np.testing.assert_allclose(fine.torque[:, ::100], coarse.torque, rtol=0.0, atol=1e-11 * scale)


# --- a geared train ------------------------------------------------------------------------------

RATIO = 3.0


def geared(**fields: Any) -> Case:
    """Two shafts and a rigid mesh; dampers that couple the modes, one of them to ground."""
    given: dict[str, Any] = {
        "line_frequency": 60.0,
        "poles": 4,
        "rated_torque": RATED,
        "stations": (
            StationRow("Motor", None, 50.0),
            StationRow("Bull gear", None, 20.0),
            StationRow("Pinion", None, 1.0, RATIO),
            StationRow("Load", None, 4.0, RATIO, damping=2.0, running_load=0.9 * RATED / RATIO),
        ),
        "elements": (
            ElementRow("Low-speed shaft", "shaft", "Motor", "Bull gear", 3.0e6, damping=400.0),
            ElementRow("Mesh", "gear mesh", "Bull gear", "Pinion"),
            ElementRow("High-speed shaft", "shaft", "Pinion", "Load", 1.0e5, damping=30.0),
        ),
    }
    return Case(**(given | fields))


TERMS = (
    EventTorqueRow("Fault", "Motor", -5.0, 1.0, math.radians(90.0), 0.15),
    EventTorqueRow("Fault", "Motor", 2.5, 2.0, math.radians(-30.0), 0.04),
    EventTorqueRow("Fault", "Motor", -0.6, None, None, 0.3),
    EventTorqueRow("Fault", "Load", 0.2, 0.4, None, 0.2),
)


def reference(case: Case, times: np.ndarray) -> dict[str, np.ndarray]:
    """Torques of the geared train in operation with the event, from angles and speeds. [N m]"""
    line = 2.0 * math.pi * 60.0
    low_j, high_j = 50.0, 4.0
    middle = 20.0 + RATIO**2 * 1.0  # bull gear and pinion as one body
    low_k, high_k, low_c, high_c, ground_c = 3.0e6, 1.0e5, 400.0, 30.0, 2.0
    base = {"Motor": RATED, "Load": RATED / RATIO}

    def applied(station: str, t: float) -> float:
        return sum(
            base[station]
            * float(r.amplitude or 0.0)
            * math.exp(-t / float(r.time_constant or math.inf))
            * math.cos((r.multiple or 0.0) * line * t + (r.phase or 0.0))
            for r in case.event_torque
            if r.station == station
        )

    def rates(t: float, y: np.ndarray) -> list[float]:
        a, b, c, va, vb, vc = y
        low, high = low_k * (a - b), high_k * (RATIO * b - c)
        low_d, high_d = low_c * (va - vb), high_c * (RATIO * vb - vc)
        return [
            va,
            vb,
            vc,
            (applied("Motor", t) - low - low_d) / low_j,
            (low + low_d - RATIO * (high + high_d)) / middle,
            (high + high_d + applied("Load", t) - ground_c * vc) / high_j,
        ]

    found = solve_ivp(rates, (0.0, times[-1]), np.zeros(6), "DOP853", times, rtol=3e-14, atol=1e-15)
    a, b, c, _, vb, vc = found.y
    low, high = low_k * (a - b), high_k * (RATIO * b - c)
    running = 0.9 * RATED
    pinion = np.array([rates(t, y)[4] for t, y in zip(times, found.y.T, strict=True)]) * RATIO
    mesh = RATIO * (1.0 * pinion + high + high_c * (RATIO * vb - vc))
    return {
        "Low-speed shaft": running + low,
        "High-speed shaft": running / RATIO + high,
        "Mesh": running + mesh,
    }


def response(case: Case) -> Start:
    (event,) = operating_events(case, analysis_for_start(case))
    assert event.response is not None, event.note
    return event.response


def test_geared_train_against_another_integrator() -> None:
    case = geared(event_torque=TERMS, tolerance_peak=1e-6, maximum_time=0.6)
    start = response(case)
    t = start.trajectory.time
    assert start.trajectory.torque[0, 0] == pytest.approx(0.9 * RATED, rel=1e-12)
    every = max(len(t) // 3000, 1)
    exact = reference(case, t[::every])
    for i, e in enumerate(start.trajectory.output_element.tolist()):
        name = str(case.elements[e].element)
        found = start.trajectory.torque[i, ::every]
        size = float(np.max(np.abs(exact[name])))
        np.testing.assert_allclose(found, exact[name], rtol=0.0, atol=1e-8 * size, err_msg=name)


# --- properties ------------------------------------------------------------------------------------


def peaks(case: Case) -> np.ndarray:
    """Maximum and minimum of every element. [N m]"""
    return np.array([(p.maximum, p.minimum) for p in response(case).peaks])


def test_no_torque_keeps_the_running_torques() -> None:
    """The twist of the running loads is an equilibrium."""
    nothing = (EventTorqueRow("Nothing", "Motor", 0.0, 1.0, None, 0.1),)
    start = response(geared(event_torque=nothing))
    running = np.array([0.9 * RATED, 0.9 * RATED / RATIO, 0.9 * RATED])
    wanted = np.broadcast_to(running[:, None], start.trajectory.torque.shape)
    np.testing.assert_allclose(start.trajectory.torque, wanted, rtol=1e-12)


def test_response_is_linear_in_the_amplitudes() -> None:
    terms = [EventTorqueRow("Fault", "Motor", a, m, 0.4, 0.1) for a, m in ((3.0, 1.0), (-1.0, 2.0))]
    case = geared(maximum_time=0.5)
    running = np.array([0.9 * RATED, 0.9 * RATED / RATIO, 0.9 * RATED])[:, None]

    def added(*rows: EventTorqueRow) -> np.ndarray:
        start = response(replace(case, event_torque=rows))
        return np.asarray(start.trajectory.torque[:, -1] - running[:, 0])

    both, first, second = added(*terms), added(terms[0]), added(terms[1])
    scale = float(np.max(np.abs(both)))
    np.testing.assert_allclose(first + second, both, rtol=0.0, atol=1e-9 * scale)
    twice = added(*(replace(r, amplitude=2.0 * (r.amplitude or 0.0)) for r in terms))
    np.testing.assert_allclose(twice, 2.0 * both, rtol=0.0, atol=1e-9 * scale)


def test_running_torque_time_is_the_same_event() -> None:
    """A step from a table and a term that does not decay, both from the running state."""
    step = 0.7 * RATED
    tabled = two_discs(
        DAMPED,
        initial_state="running",
        torque_time=(TorqueTimeRow("Motor", 0.0, step), TorqueTimeRow("Motor", 0.1, step)),
        tolerance_peak=1e-6,
    )
    term = two_discs(
        DAMPED, event_torque=(EventTorqueRow("Step", "Motor", 0.7),), tolerance_peak=1e-6
    )
    np.testing.assert_allclose(peaks(tabled), peaks(term), rtol=2e-6)


def test_largest_torque_of_a_step_in_closed_form() -> None:
    """Running torque + T J2/(J1+J2) (1 + e^(−πζ/√(1−ζ²))): found to the tolerance, its error said."""
    case = two_discs(DAMPED, event_torque=(EventTorqueRow("Step", "Motor", 1.0),))
    peak = response(case).peaks[0]
    share = J2 / (J1 + J2)
    over = math.exp(-math.pi * DAMPED / math.sqrt(1.0 - DAMPED**2))
    exact = 0.8 * RATED + RATED * share * (1.0 + over)
    assert abs(peak.maximum - exact) <= peak.error <= 1e-3 * peak.size
    assert peak.minimum == pytest.approx(0.8 * RATED, rel=1e-9)


def test_event_without_any_damping_needs_a_length() -> None:
    case = two_discs(0.0, event_torque=(EventTorqueRow("Fault", "Motor", 5.0, 1.0, None, 0.1),))
    (event,) = operating_events(case, analysis_for_start(case))
    assert event.response is None
    assert "mode 1 (57.38 Hz) has no damping" in event.note
    assert "MaximumTime" in event.note
    (event,) = operating_events(replace(case, maximum_time=1.0), analysis_for_start(case))
    assert event.response is not None
    assert event.response.left_out is None  # it goes on, so no bound is known
    assert "followed to MaximumTime" in event.note
    damped = replace(case, mode_damping=(ModeDampingRow(1, 0.01),))
    (event,) = operating_events(damped, analysis_for_start(damped))
    assert event.response is not None
    assert event.note == ""


# --- clearances -----------------------------------------------------------------------------------

GAP = 0.004
#: Reverses the torque of the coupling several times.
HEAVY = (
    EventTorqueRow("Fault", "Motor", -4.0, 1.0, math.radians(90.0), 0.1),
    EventTorqueRow("Fault", "Motor", 2.0, 2.0, math.radians(-90.0), 0.03),
    EventTorqueRow("Fault", "Motor", -1.0, None, None, 0.1),
)


def coupled(**fields: Any) -> Case:
    """Two discs and a coupling with a clearance, without any damping, for 0.25 s."""
    given: dict[str, Any] = {
        "elements": (ElementRow("Coupling", "coupling", "Motor", "Load", K),),
        "meshes": (MeshRow("Coupling", angular_backlash=GAP),),
        "event_torque": HEAVY,
        "maximum_time": 0.25,
        "tolerance_peak": 1e-6,
    }
    return two_discs(0.0, **(given | fields))


def extremes_with_a_gap(case: Case, end: float) -> tuple[float, float]:
    """Highest and lowest torque of the coupling from the equation of its twist x alone. [N m]

    x'' = (T + T0) / J1 + T0 / J2 − F(x) (1 / J1 + 1 / J2), F zero in the gap.
    """
    running, line = 0.8 * RATED, 2.0 * math.pi * 60.0

    def force(x: float) -> float:
        return K * x if x > 0.0 else K * (x + GAP) if x < -GAP else 0.0

    def rates(t: float, y: np.ndarray) -> list[float]:
        torque = sum(
            RATED
            * float(r.amplitude or 0.0)
            * math.exp(-t / float(r.time_constant or math.inf))
            * math.cos((r.multiple or 0.0) * line * t + (r.phase or 0.0))
            for r in case.event_torque
        )
        x, v = y
        return [v, (torque + running) / J1 + running / J2 - force(x) * (1.0 / J1 + 1.0 / J2)]

    found = solve_ivp(
        rates, (0.0, end), [running / K, 0.0], "DOP853", dense_output=True, rtol=1e-12, atol=1e-16,
        max_step=1e-4,
    )  # fmt: skip

    def extreme(sign: float) -> float:
        """Between the steps beside the largest sample."""
        at = int(np.argmax([sign * force(x) for x in found.y[0]]))
        times = np.linspace(found.t[at - 1], found.t[at + 1], 20_001)
        return sign * max(sign * force(x) for x in found.sol(times)[0])

    return extreme(1.0), extreme(-1.0)


def test_separating_teeth_against_another_integrator() -> None:
    case = coupled()
    (event,) = operating_events(case, analysis_for_start(case))
    assert event.response is not None, event.note
    (contact,) = event.response.contacts
    assert contact.impacts >= 3
    peak = event.response.peaks[0]
    high, low = extremes_with_a_gap(case, 0.25)
    assert low < -RATED  # the back flank is struck
    assert peak.maximum == pytest.approx(high, rel=1e-6)
    assert peak.minimum == pytest.approx(low, rel=1e-6)
    assert max(abs(peak.maximum - high), abs(peak.minimum - low)) <= peak.error
    linear = response(coupled(effect_choices=(EffectChoiceRow("backlash", "off"),))).peaks[0]
    assert abs(linear.maximum - high) > 0.02 * high  # the gap is no detail


def test_teeth_that_stay_together_are_linear() -> None:
    small = tuple(replace(r, amplitude=0.01 * (r.amplitude or 0.0)) for r in HEAVY)
    with_gap, without = (
        response(coupled(event_torque=small, meshes=meshes)) for meshes in (coupled().meshes, ())
    )
    assert with_gap.contacts == ()
    assert with_gap.peaks == without.peaks


def test_running_state_with_a_clearance_is_an_equilibrium() -> None:
    """Forced through the contact loop by an event that begins long after the train has come to rest in it."""
    late = tuple(TorqueTimeRow("Motor", t, x) for t, x in ((0.1, 0.0), (0.12, -4e4), (0.2, 0.0)))
    start = response(coupled(event_torque=(), torque_time=late, initial_state="running"))
    assert start.contacts[0].impacts >= 1
    time, torque = start.trajectory.time, start.trajectory.torque[0]
    np.testing.assert_allclose(torque[time < 0.1], 0.8 * RATED, rtol=1e-9)


# --- distributed shafts ---------------------------------------------------------------------------


def test_error_covers_the_pieces_of_a_distributed_shaft() -> None:
    """Beside the same shaft in three times as many pieces, followed as long."""
    shaft = ElementRow(
        "Shaft", "shaft", "Motor", "Load", od=0.15, length=4.0, shear_modulus=8e10, density=7850.0
    )
    case = two_discs(0.05, elements=(shaft,), event_torque=HEAVY, maximum_time=0.1)
    found, wanted = response(case).peaks[0], 1e-3
    assert found.error <= wanted * found.size
    pieces = dict(analysis_for_start(case).subdivided.segments)["Shaft"]
    many = replace(analyse(case, least_pieces=3 * pieces), rough_reported=None)
    (event,) = operating_events(case, many)
    assert event.response is not None
    finer = event.response.peaks[0]
    change = max(abs(found.maximum - finer.maximum), abs(found.minimum - finer.minimum))
    assert 0.0 < change <= found.error
