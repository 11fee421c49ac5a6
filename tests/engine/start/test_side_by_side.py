"""Starts side by side in the lanes of one loop: each has the bits that it has alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.study_trains import study_train
from engine.case.case import Case
from engine.case.data import CaseData
from engine.errors import InternalError, ModelError
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of
from engine.start.side_by_side import side_by_side, turning_of_start
from engine.start.simulation import (
    Simulation,
    form_of,
    simulate,
    start_with_histories,
    turning_of_starts,
)
from engine.start.start import PreparedStart, prepared_start
from engine.start.trajectory import SingleRun
from engine.stepping.linear_loop import LANES
from tests.sample_case import sample_case


def prepared(case: CaseData) -> PreparedStart:
    train = build_train(case)
    return prepared_start(case, ModalTrain.of(case, train, modes_of(train)))


def stiffer(case: Case, share: float) -> CaseData:
    """The same train with every stiffness and the end of the run a little different."""
    elements = tuple(
        replace(e, stiffness=None if e.stiffness is None else e.stiffness * share)
        for e in case.elements
    )
    return CaseData(**vars(case) | {"elements": elements, "end_speed": 180.0 * share})


def simulation(case: CaseData, step: float | None = None) -> Simulation:
    start = prepared(case)
    own = min(2e-3, start.model.largest_step) if step is None else step
    settings = start.settings
    return Simulation(start.model, own, settings.method, settings.end_speed, start.maximum_time)


def alike(a: SingleRun, b: SingleRun) -> None:
    """Every number that a start leaves is equal to the last bit."""
    assert a.end == b.end
    assert a.trajectory.reached == b.trajectory.reached
    assert np.array_equal(a.trajectory.time, b.trajectory.time)
    assert np.array_equal(a.trajectory.mean_speed, b.trajectory.mean_speed)
    for (when, value), (other_when, other_value) in zip(a.turning, b.turning, strict=True):
        assert np.array_equal(when, other_when)
        assert np.array_equal(value, other_value)


def test_different_starts_side_by_side_have_the_bits_that_each_has_alone() -> None:
    case = sample_case("proposed")
    simulations = [
        simulation(stiffer(case, 1.0 + 0.02 * i), 2e-3 / (1.0 + 0.1 * i))
        for i in range(2 * LANES)  # those of most steps first: they do not run in this order
    ][::-1]
    together = turning_of_starts(simulations)
    ends = {run.end for run in together if isinstance(run, SingleRun)}
    assert len(ends) == 2 * LANES  # different cases, which end at different times
    for one, run in zip(simulations, together, strict=True):
        (alone,) = turning_of_starts([one])
        assert isinstance(run, SingleRun)
        assert isinstance(alone, SingleRun)
        alike(run, alone)


def test_a_lane_without_a_start_changes_nothing() -> None:
    simulations = [simulation(stiffer(sample_case("proposed"), s)) for s in (1.0, 1.07)]
    for one, run in zip(simulations, turning_of_starts(simulations), strict=True):
        (alone,) = turning_of_starts([one])
        assert isinstance(run, SingleRun)
        assert isinstance(alone, SingleRun)
        alike(run, alone)


@pytest.mark.parametrize("number", [0, 2, 4, 6, 8, 10])
def test_turning_points_are_those_of_the_histories(number: int) -> None:
    one = simulation(study_train(number).case)
    whole = simulate(
        one.model, one.step, one.method, one.target_speed, one.maximum_time, keep_all=True
    )
    run = turning_of_start(one)
    samples = replace(whole, turning=None)  # without those that the loop found
    alike(run, SingleRun.until(samples, samples.end_at(one.target_speed)))
    alike(run, start_with_histories(one, keep_all=True))


def test_room_that_has_to_grow_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    simulations = [simulation(stiffer(sample_case("proposed"), s)) for s in (1.0, 1.07)]
    at_once = turning_of_starts(simulations)
    monkeypatch.setattr("engine.start.simulation.TURNING_ROOM", 4)
    for one, other in zip(at_once, turning_of_starts(simulations), strict=True):
        assert isinstance(one, SingleRun)
        assert isinstance(other, SingleRun)
        assert max(len(when) for when, _ in one.turning) > 4
        alike(one, other)


def test_histories_in_several_parts_are_those_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    s = simulation(sample_case("proposed"))
    asked = (s.model, s.step, s.method, s.target_speed, s.maximum_time)
    whole = simulate(*asked, keep_all=True)
    monkeypatch.setattr("engine.start.simulation.KEPT_VALUES", 0)
    monkeypatch.setattr("engine.start.simulation.CHUNK", 100)
    monkeypatch.setattr("engine.start.simulation.TURNING_ROOM", 4)
    parts = simulate(*asked, keep_all=True)
    assert whole.n_steps == len(whole.time) - 1 > 100
    assert parts.n_steps == whole.n_steps
    for name in ("time", "mean_speed", "torque", "torque_rate"):
        assert np.array_equal(getattr(parts, name), getattr(whole, name))
    assert parts.turning is not None
    assert whole.turning is not None
    for (when, value), (other_when, other_value) in zip(parts.turning, whole.turning, strict=True):
        assert len(when) > 4
        assert np.array_equal(when, other_when)
        assert np.array_equal(value, other_value)


def test_a_group_of_calculations_gives_the_answers_of_each_alone() -> None:
    case = sample_case("modified")
    shares = [1.0 + 0.01 * i for i in range(2 * LANES + 1)]

    def calculate(share: float) -> SingleRun:
        start = prepared(stiffer(case, share))
        start, run = start.to_its_end(2e-3, histories=False)
        finer = start.at(1e-3, histories=False)
        assert finer.end == pytest.approx(run.end, rel=1e-3)
        return finer

    for share, together in zip(shares, side_by_side(calculate, shares), strict=True):
        alike(together, calculate(share))


def test_starts_of_other_forms_do_not_share_a_loop() -> None:
    proposed, modified = (simulation(sample_case(d)) for d in ("proposed", "modified"))
    assert form_of(proposed) != form_of(simulation(study_train(0).case))
    assert form_of(proposed) == form_of(simulation(stiffer(sample_case("proposed"), 1.01)))
    runs = side_by_side(turning_of_start, [proposed, simulation(study_train(0).case), modified])
    assert len({len(run.turning) for run in runs}) > 1


def test_an_error_of_one_calculation_is_raised_and_the_others_end() -> None:
    one = simulation(sample_case("proposed"))

    def calculate(i: int) -> SingleRun:
        if i == 2:
            raise ModelError("the third is impossible")
        return turning_of_start(one)

    with pytest.raises(ModelError, match="the third"):
        side_by_side(calculate, range(5))


def test_a_start_that_diverges_is_an_error_of_its_own_lane() -> None:
    sound = simulation(sample_case("proposed"))
    broken = replace(sound, model=replace(sound.model, rate=np.full_like(sound.model.rate, np.nan)))
    run, error = turning_of_starts([sound, broken])
    assert isinstance(run, SingleRun)
    assert isinstance(error, InternalError)
    (alone,) = turning_of_starts([sound])
    assert isinstance(alone, SingleRun)
    alike(run, alone)
