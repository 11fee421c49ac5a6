"""What a forced response can make of a margin that is not kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import ElementRow, ExcitationRow, MaterialRow, MeshRow, StationRow
from engine.case.result_words import Judgement
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.operation.acceptance import ModeParts, judge, mode_parts
from engine.operation.margins import MarginRow, SeparationMargins
from engine.run import at_speed
from tests.sample_case import sample_case


@dataclass(frozen=True)
class Judged:
    """What `judge` reads of a row of the forced response."""

    element: str
    verdict: str
    mode: int | None = 1
    excitation: str = "x"


NAMES = ("A", "B", "C")


def parts(energy, torque) -> ModeParts:
    return ModeParts(NAMES, np.array([energy]).T, np.array([torque]).T)


def margin(value: float) -> SeparationMargins:
    row = MarginRow(1, 50.0 * (1.0 + value), "x", None, 50.0, value, 0.2, Judgement.PASS)
    return SeparationMargins((row,), 0.2, None, ())


def judged(
    responses, energy=(1.0, 0.0, 0.0), torque=(1.0, 0.0, 0.0), value=0.1, error=0.0, unsure=()
):
    keys = frozenset((name, "x", 1) for name in unsure)
    (row,) = judge(margin(value), responses, parts(energy, torque), error, keys).rows
    return row


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        ((), Judgement.FAIL),
        (("pass",), Judgement.ACCEPTED),
        (("pass", "not judged"), Judgement.ACCEPTED),
        (("not judged",), Judgement.FAIL),
        (("not judged", "pass"), Judgement.NOT_JUDGED),
        (("pass", "fail"), Judgement.FAIL),
        (("pass", "unbounded"), Judgement.FAIL),
    ],
)
def test_only_rows_of_this_resonance_count(verdicts, expected):
    response = [Judged(name, verdict) for name, verdict in zip(NAMES, verdicts, strict=False)]
    others = [Judged("A", "fail", mode=None), Judged("A", "fail", mode=2)]
    assert judged([*response, *others, Judged("A", "fail", excitation="y")]).verdict == expected


def test_a_kept_margin_passes_whatever_the_response():
    row = judged([Judged("A", "fail")], value=0.21)
    assert (row.verdict, row.not_judged) == (Judgement.PASS, None)


@pytest.mark.parametrize(
    ("error", "expected"), [(0.0082, Judgement.PASS), (0.0084, Judgement.WITHIN_ERROR)]
)
def test_a_margin_within_the_error_of_its_frequency_says_so(error, expected):
    """Margin 21 %, required 20 %: an error e of the frequency shifts the margin by 1.21 e."""
    assert judged([], value=0.21, error=error).verdict == expected


def test_a_margin_that_is_not_kept_is_not_saved_by_its_error():
    assert judged([], value=0.1999, error=0.1).verdict == Judgement.FAIL


PASSING = [Judged("A", "pass"), Judged("B", "not judged"), Judged("C", "not judged")]


@pytest.mark.parametrize(
    ("energy", "torque", "missing"),
    [
        ((0.90, 0.10, 0.00), (1.0, 0.49, 0.0), ()),
        ((0.89, 0.08, 0.03), (1.0, 0.0, 0.0), ("B (8%",)),
        ((0.40, 0.35, 0.25), (1.0, 0.0, 0.0), ("B (35%", "C (25%")),
        ((0.24, 0.76, 0.00), (1.0, 0.0, 0.0), ("B (76%",)),
        ((1.00, 0.00, 0.00), (1.0, 0.5, 0.0), ("B (0% of the strain energy, modal torque 50%",)),
    ],
)
def test_elements_with_energy_and_elements_with_torque_must_be_judged(energy, torque, missing):
    """90 % of the energy, the largest holder, and half of the largest torque over rated torque."""
    row = judged(PASSING, energy, torque)
    assert row.verdict == (Judgement.NOT_JUDGED if missing else Judgement.ACCEPTED)
    named = (row.not_judged or "").split("; ") if row.not_judged else []
    assert len(named) == len(missing)
    assert all(found.startswith(wanted) for found, wanted in zip(named, missing, strict=True))


def test_the_largest_holder_must_be_judged_even_beyond_ninety_per_cent():
    """It cannot be missing where 90 % is held, unless energies are shared out evenly."""
    names = tuple(f"E{i}" for i in range(20))
    energy = np.full((20, 1), 0.94 / 19)
    energy[7] = 0.06
    many = ModeParts(names, energy, np.zeros((20, 1)))
    response = [Judged(name, "not judged" if name == "E7" else "pass") for name in names]
    (row,) = judge(margin(0.1), response, many).rows
    assert row.verdict == Judgement.NOT_JUDGED
    assert (row.not_judged or "").startswith("E7 (6%")


# --- whole trains ---------------------------------------------------------------------------------


def train(**limits) -> Case:
    """A soft coupling, a stiff key beside it with little energy, and a shaft; 8 Hz beside 9 Hz."""
    elements = (
        ElementRow("Shaft", "shaft", "M", "H", 4e6, stress_diameter=0.2, material="steel"),
        ElementRow("Key", "coupling", "H", "C", 4e9, vibratory_limit=limits.get("key")),
        ElementRow("Coupling", "coupling", "C", "P", 1e5, vibratory_limit=limits.get("coupling")),
    )
    return Case(
        stations=(
            StationRow("M", None, 60.0),
            StationRow("H", None, 1.0),
            StationRow("C", None, 1.0),
            StationRow("P", None, 80.0, running_load=5000.0),
        ),
        elements=elements,
        materials=(MaterialRow("steel", 700e6),),
        excitations=(ExcitationRow("x", frequency=9.0, torque=10.0, station="M"),),
        damping_ratio=0.02,
        rated_torque=5000.0,
    )


@pytest.mark.parametrize(
    ("limits", "verdict", "missing"),
    [
        ({"key": 1e4, "coupling": 1e4}, Judgement.ACCEPTED, ""),
        ({"key": 1e4}, Judgement.NOT_JUDGED, "Coupling"),
        ({"coupling": 1e4}, Judgement.NOT_JUDGED, "Key"),
        ({"key": 1e4, "coupling": 1.0}, Judgement.FAIL, ""),
    ],
)
def test_a_stiff_key_carries_the_torque_of_the_soft_coupling(limits, verdict, missing):
    rows = at_speed(train(**limits)).margins.rows
    row = next(r for r in rows if r.mode == 1)
    assert row.verdict == verdict
    assert (row.not_judged or "").startswith(missing)
    assert bool(row.not_judged) == bool(missing)


def test_modal_torques_are_those_of_the_mode_by_hand():
    """k (φ_left − φ_right) at the element's own speed, over what it transmits."""
    case = train()
    built = build_train(case)
    modes = modes_of(built)
    found = mode_parts(case, built, modes)
    angle = modes.shape[:, modes.n_rigid]
    by_hand = np.abs(np.array([4e6, 4e9, 1e5]) * -np.diff(angle)) / 5000.0
    assert found.torque[:, 0] == pytest.approx(by_hand / by_hand.max(), rel=1e-9)
    assert found.energy[:, 0].sum() == pytest.approx(1.0, rel=1e-12)


def test_a_rigid_mesh_is_as_one_of_very_high_stiffness():
    """No strain energy, all of the torque: a rigid mesh has no row, its torque is from equilibrium."""
    stations = (
        StationRow("M", None, 50.0),
        StationRow("G", None, 5.0),
        StationRow("P", None, 0.5, speed_ratio=3.0),
        StationRow("C", None, 4.0, speed_ratio=3.0, running_load=1000.0),
    )
    elements = (
        ElementRow("LS", "shaft", "M", "G", 1e6),
        ElementRow("Mesh", "gear mesh", "G", "P", None),
        ElementRow("HS", "shaft", "P", "C", 2e5),
    )
    rigid = Case(stations=stations, elements=elements, rated_torque=3000.0)
    stiff = replace(
        rigid, elements=(elements[0], replace(elements[1], stiffness=1e13), elements[2])
    )
    found = []
    for case in (rigid, stiff):
        built = build_train(case)
        found.append(mode_parts(case, built, modes_of(built)))
    assert found[0].energy[1] == pytest.approx(0.0, abs=1e-12)
    assert found[0].torque[:, :2] == pytest.approx(found[1].torque[:, :2], rel=1e-5)
    assert found[0].torque[1, 0] > 0.5


def test_energy_in_the_bearings_of_a_gear_is_no_elements():
    """12 % of the energy is in a bearing, which has no limit: 90 % cannot be judged."""
    names = ("A", "B", "bearing of G")
    of_mode = ModeParts(names, np.array([[0.80], [0.08], [0.12]]), np.array([[1.0], [0.6], [0.0]]))
    response = [Judged("A", "pass"), Judged("B", "pass")]
    (row,) = judge(margin(0.1), response, of_mode).rows
    assert row.verdict == Judgement.NOT_JUDGED
    assert (row.not_judged or "").startswith("bearing of G (12%")


def test_bearings_follow_the_elements():
    """The sample on bearings: energy shares of elements and bearings are one together."""
    mesh = MeshRow(
        "Mesh", None, 0.42, 0.075, math.radians(20.0), mass_drive=1600.0, mass_driven=150.0,
        bearing_stiffness_drive=4e8, bearing_stiffness_driven=3e8,
    )  # fmt: skip
    results = at_speed(sample_case("modified", meshes=(mesh,)))
    found = mode_parts(results.case, results.train, results.modes)
    assert found.names[-2:] == ("bearing of Bull gear", "bearing of Pinion")
    assert found.energy.sum(axis=0) == pytest.approx(np.ones(found.energy.shape[1]), rel=1e-9)
    assert found.energy[-2:].max() > 0.1
    assert np.all(found.torque[-2:] == 0.0)


def test_an_element_that_passes_only_at_the_favourable_end_of_its_error_accepts_nothing() -> None:
    passing = [Judged("A", Judgement.PASS), Judged("B", Judgement.PASS)]
    row = judged(passing, unsure="A")
    assert row.verdict == Judgement.NOT_JUDGED
    assert row.not_judged == (
        "A (beyond its limit at the unfavourable end: error of its torque, and DampingRange)"
    )
    assert judged(passing, unsure="B").verdict == Judgement.NOT_JUDGED
    assert judged([Judged("A", Judgement.FAIL), passing[1]], unsure="B").verdict == Judgement.FAIL


def resonant(limit: float, damping_range: float | None, how: str = "ratio") -> Case:
    """Two discs that 10 N m at 25 Hz shakes near their mode of 26 Hz: 10 × 0.5 / 2ζ = 125 N m at 2 %."""
    omega = 2.0 * math.pi * 26.0
    k = 0.5 * omega**2
    loss = 0.04 if how == "loss factor" else None
    damping = 0.04 * k / omega if how == "damper" else None
    ratio = 0.02 if how == "ratio" else None
    return Case(
        line_frequency=50.0, poles=4, damping_ratio=ratio, damping_range=damping_range,
        stations=(StationRow("A", None, 1.0), StationRow("B", None, 1.0)),
        elements=(ElementRow(
            "S", "coupling", "A", "B", k, damping=damping, loss_factor=loss, vibratory_limit=limit
        ),),
        excitations=(ExcitationRow("x", frequency=25.0, station="A", torque=10.0),),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("limit", "damping_range", "verdict"),
    [
        (150.0, None, Judgement.ACCEPTED),
        (150.0, 0.1, Judgement.ACCEPTED),  # 139 N m
        (150.0, 0.3, Judgement.NOT_JUDGED),  # 179 N m
        (120.0, 0.3, Judgement.FAIL),
    ],
)
def test_a_margin_is_accepted_over_the_whole_range_of_damping(
    limit, damping_range, verdict
) -> None:
    found = at_speed(resonant(limit, damping_range))
    margin_of_x = next(r for r in found.margins.rows if r.excitation == "x")
    row = next(r for r in found.steady.rows if r.mode == 1)
    assert row.torque == pytest.approx(125.0, rel=1e-3)
    rise = 1.0 / (1.0 - (damping_range or 0.0)) - 1.0
    assert row.error == pytest.approx(rise, rel=2e-3, abs=1e-12)
    assert margin_of_x.verdict == verdict


@pytest.mark.parametrize("how", ["ratio", "loss factor", "damper"])
def test_the_range_is_one_of_all_damping(how: str) -> None:
    """Half of it makes twice the torque, whatever it comes from."""
    row = next(r for r in at_speed(resonant(150.0, 0.5, how)).steady.rows if r.mode == 1)
    assert row.torque == pytest.approx(125.0, rel=2e-3)
    assert row.error == pytest.approx(1.0, rel=5e-3)
