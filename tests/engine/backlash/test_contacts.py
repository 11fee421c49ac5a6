"""Teeth in a run with clearances, from a log of contacts made by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from engine.backlash.contacts import contact_records, force_histories
from engine.backlash.event_start import _over_before, _spread, _together_until
from engine.errors import ModelError
from engine.run import run
from engine.stepping.contact_loop import BACK, BACK_LIMITED, DRIVE, FREE

#: A mesh of base radius 0.2 m whose normal force is 1.25 times the transverse one.
MESH = SimpleNamespace(element=0, base_radius=0.2, normal_factor=1.25)
TRAIN = SimpleNamespace(elements=("Mesh",), stations=(), bodies=(), flanks=(MESH,))


def run_with(log: Any) -> Any:
    trajectory = SimpleNamespace(
        output_element=np.array([0]), time=np.array([0.0, 1.0]), torque=np.array([[80.0, -300.0]])
    )
    return SimpleNamespace(log=np.array(log), trajectory=trajectory, bearing=np.empty((0, 2)))


@pytest.mark.parametrize("back", [BACK, BACK_LIMITED])
def test_a_log_of_contacts_by_hand(back: int) -> None:
    """Teeth apart from 1.0 to 1.2, 1.3 to 1.6 and from 1.9 s to the end; one of two impacts is on the back."""
    log = [
        (1.0, 0, DRIVE, FREE, 0.0),
        (1.2, 0, FREE, back, 0.5),
        (1.3, 0, back, FREE, 0.0),
        (1.6, 0, FREE, DRIVE, 2.0),
        (1.9, 0, DRIVE, FREE, 0.0),
    ]
    basis = SimpleNamespace(train=TRAIN, flanks=(MESH,))
    model: Any = SimpleNamespace(pieces=SimpleNamespace(basis=basis))
    turning = [(np.array([0.0, 1.0]), np.array([80.0, -300.0]))]
    (found,) = contact_records(model, run_with(log), turning, 2.0)
    assert (found.impacts, found.back_impacts) == (2, 1)
    assert found.time_unloaded == pytest.approx(0.2 + 0.3 + 0.1)
    assert found.recontact_speed_angular == 2.0
    assert found.recontact_speed == pytest.approx(2.0 * 0.2 / 1.25)
    assert found.tooth_torque == 300.0
    assert found.tooth_force == pytest.approx(300.0 / 0.2 * 1.25)


def error_of(fastest: list[float], *others: list[float]) -> float:
    """Recontact error of a run with some approach speeds, and of others."""
    logs = [[(1.0, 0, FREE, DRIVE, speed) for speed in speeds] for speeds in (fastest, *others)]
    basis = SimpleNamespace(train=TRAIN, flanks=(MESH,))
    model: Any = SimpleNamespace(pieces=SimpleNamespace(basis=basis))
    turning = [(np.array([0.0, 1.0]), np.array([80.0, -300.0]))]
    runs = [run_with(log) for log in logs]
    return contact_records(model, runs[0], turning, 2.0, runs[1:])[0].recontact_error


def test_the_error_of_recontact_speeds_is_that_of_the_fastest_three() -> None:
    assert error_of([2.0, 1.0, 0.5, 0.1], [2.001, 1.0, 0.5, 0.9]) == pytest.approx(
        2 / 3 * 0.2
    )  # 0.4 / 2
    assert error_of([2.0, 1.0, 0.5], [2.001, 1.0, 0.5]) == pytest.approx(2 / 3 * 5e-4)
    assert error_of([2.0], [2.0]) == 1e-7


def test_where_runs_part_the_error_of_recontact_speeds_is_that_of_an_ensemble() -> None:
    """t(0.999; 2) = 22.327; mean 2, s 0.1, so 2 ± 2.578."""
    assert error_of([2.0], [1.9], [2.1]) == pytest.approx(
        22.3271 * 0.1 * np.sqrt(4 / 3) / 2.0, 1e-4
    )


def test_the_history_of_a_tooth_force_is_normal_to_the_tooth() -> None:
    train: Any = TRAIN
    found = force_histories(train, run_with(np.empty((0, 5))))
    assert found.tooth_force.tolist() == [[pytest.approx(500.0), pytest.approx(-1875.0)]]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_spread_of_two_runs_is_that_of_either_extreme(sign: float) -> None:
    """Only one extreme changes, by 3 of 60."""

    def of(changed: float) -> Any:
        return SimpleNamespace(turning=[(np.zeros(2), sign * np.array([60.0, changed]))])

    assert _spread(of(-30.0), of(-33.0), np.array([0])) == pytest.approx(0.05)


def changes(*rows: tuple[float, int, int, int]) -> Any:
    """A run with these changes: time, clearance, contact before and after."""
    return SimpleNamespace(log=np.array([(*row, 0.0) for row in rows]).reshape(-1, 5))


def test_runs_are_together_while_each_clearance_changes_alike() -> None:
    """Which of two clearances changes first does not matter, nor does the other one's parting."""
    one = changes((1.0, 0, 1, 0), (2.0, 1, 1, 0), (2.01, 0, 0, 1), (4.0, 0, 1, 0))
    swapped = changes((1.0, 0, 1, 0), (1.99, 0, 0, 1), (2.0, 1, 1, 0), (4.0, 0, 1, 0))
    late = changes((1.0, 0, 1, 0), (2.0, 1, 1, 0), (2.01, 0, 0, 1), (4.2, 0, 1, 0))
    more = changes((1.0, 0, 1, 0), (2.0, 1, 1, 0), (2.01, 0, 0, 1), (3.0, 1, 0, 1), (4.0, 0, 1, 0))
    assert _together_until(one, swapped, 0.1) == np.inf
    assert _together_until(one, late, 0.1) == 4.0
    assert _together_until(more, one, 0.1) == 3.0
    assert _together_until(one, changes(), 0.1) == 1.0
    assert _together_until(changes(), changes(), 0.1) == np.inf


@pytest.mark.parametrize(
    ("late", "over"), [(74.0, True), (76.0, False), (-44.0, True), (-46.0, False)]
)
def test_peaks_are_over_where_all_that_follows_is_far_smaller(late: float, over: bool) -> None:
    """Three quarters of 100 and of −60, in the coarse run as in the fine one."""

    def of(last: float) -> Any:
        turning = [(np.array([1.0, 2.0, 4.0]), np.array([100.0, -60.0, last]))]
        return SimpleNamespace(
            turning=turning, trajectory=SimpleNamespace(output_element=np.array([0]))
        )

    judged: Any = SimpleNamespace(
        output_of_element=np.array([0]), peaks=[SimpleNamespace(maximum=100.0, minimum=-60.0)]
    )
    assert _over_before(of(late), of(0.0), judged, 3.0) is over
    assert _over_before(of(0.0), of(late), judged, 3.0) is over


def with_bearing_damping(damping: float) -> Any:
    case = read_workbook(template_path("example_backlash.xlsx")).case()
    return replace(case, meshes=(replace(case.meshes[0], bearing_damping_drive=damping),))


def test_damping_beyond_double_precision_is_named_and_no_traceback() -> None:
    """C12: a bearing damping of 1e25 N s/m makes a divisor zero in the compiled loop."""
    with pytest.raises(ModelError, match=r"cannot be calculated beyond .*Bearing damping in table"):
        run(with_bearing_damping(1e25))


@pytest.mark.long
def test_damping_that_leaves_no_digits_is_said_with_the_result() -> None:
    """1e14 N s/m, 6e7 times critical: the loop comes to an end, and nothing it found is claimed."""
    results = run(with_bearing_damping(1e14))
    assert results.start is not None
    assert not results.start.met_tolerance
    assert results.start.estimated_error > 1.0
    assert any("Bearing damping of 'Bull gear'" in note for note in results.warnings)
