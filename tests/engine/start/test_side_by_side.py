"""Starts side by side in the lanes of one loop: each has the bits that it has alone."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from benchmarks.study_trains import study_train
from engine.case.case import Case
from engine.case.data import CaseData
from engine.errors import InternalError, ModelError
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of
from engine.results.tables import result_tables
from engine.run import run as whole_run
from engine.start.by_turns import AT_ONCE, by_turns, simulated
from engine.start.simulation import Simulation, form_of, runs_of, simulate
from engine.start.start import PreparedStart, prepared_start, starts_to_their_ends
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


def alike(a: object, b: object) -> None:
    """Every number that a start leaves is equal to the last bit."""
    assert isinstance(a, SingleRun)
    assert isinstance(b, SingleRun)
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
    together = runs_of(simulations)
    ends = {run.end for run in together}
    assert len(ends) == 2 * LANES  # different cases, which end at different times
    for one, run in zip(simulations, together, strict=True):
        (alone,) = runs_of([one])
        alike(run, alone)


def test_a_lane_without_a_start_changes_nothing() -> None:
    simulations = [simulation(stiffer(sample_case("proposed"), s)) for s in (1.0, 1.07)]
    for one, run in zip(simulations, runs_of(simulations), strict=True):
        (alone,) = runs_of([one])
        alike(run, alone)


@pytest.mark.parametrize("number", [0, 2, 4, 6, 8, 10])
def test_turning_points_are_those_of_the_histories(number: int) -> None:
    one = simulation(study_train(number).case)
    whole = simulate(
        one.model, one.step, one.method, one.target_speed, one.maximum_time, keep_all=True
    )
    (run,) = runs_of([one])
    samples = replace(whole, turning=None)  # without those that the loop found
    alike(run, SingleRun.until(samples, samples.end_at(one.target_speed)))
    (kept,) = runs_of([replace(one, kept_values=math.inf)])
    alike(run, kept)


def test_room_that_has_to_grow_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    simulations = [simulation(stiffer(sample_case("proposed"), s)) for s in (1.0, 1.07)]
    at_once = runs_of(simulations)
    monkeypatch.setattr("engine.start.simulation.TURNING_ROOM", 4)
    for one, other in zip(at_once, runs_of(simulations), strict=True):
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


def test_starts_that_are_prolonged_together_are_those_of_each_alone() -> None:
    """Of different lengths at first, so that some of them are prolonged more often than others."""
    case = sample_case("modified")
    starts = [
        (
            replace(prepared(stiffer(case, 1.0 + 0.01 * i)), maximum_time=2.0 + 3.0 * i),
            2e-3,
        )
        for i in range(2 * LANES + 1)
    ]
    together = starts_to_their_ends(starts)
    assert (
        len(
            {
                start.maximum_time / first.maximum_time
                for (start, _), (first, _) in zip(together, starts, strict=True)
            }
        )
        > 2
    )
    for (start, run), (first, step) in zip(together, starts, strict=True):
        own, alone = first.to_its_end(step, histories=False)
        assert start.maximum_time == own.maximum_time
        alike(run, alone)
        _, whole = first.to_its_end(step)
        alike(run, whole)


def test_starts_of_other_forms_do_not_share_a_loop() -> None:
    proposed, modified = (simulation(sample_case(d)) for d in ("proposed", "modified"))
    other = simulation(study_train(0).case)
    assert form_of(proposed) != form_of(other)
    assert form_of(proposed) == form_of(simulation(stiffer(sample_case("proposed"), 1.01)))
    simulations = [proposed, other, modified]
    for one, run in zip(simulations, runs_of(simulations), strict=True):
        (alone,) = runs_of([one])
        alike(run, alone)


@pytest.mark.parametrize(
    ("stiffness", "words"),
    [(-1e14, "diverged"), (math.nan, "finite numbers in system_t.stiffness")],
)
def test_a_start_that_has_no_end_is_an_error_and_hinders_no_other(
    stiffness: float, words: str
) -> None:
    sound = simulation(sample_case("proposed"))
    unstable = np.full_like(sound.model.stiffness, stiffness)
    broken = replace(sound, model=replace(sound.model, stiffness=unstable))
    run, error = runs_of([sound, broken])
    alike(run, runs_of([sound])[0])
    assert isinstance(error, InternalError)
    assert words in str(error)
    with pytest.raises(InternalError, match=words):
        simulated([sound, broken])


# --- whole runs by turns --------------------------------------------------------------------------


def test_histories_side_by_side_are_those_that_each_has_alone() -> None:
    simulations = [
        replace(simulation(stiffer(sample_case("proposed"), s)), kept_values=math.inf)
        for s in (1.0, 1.03, 1.07)
    ]
    for one, found in zip(simulations, runs_of(simulations), strict=True):
        (alone,) = runs_of([one])
        assert isinstance(found, SingleRun)
        assert isinstance(alone, SingleRun)
        alike(found, alone)
        assert np.array_equal(found.trajectory.torque, alone.trajectory.torque)
        assert np.array_equal(found.trajectory.torque_rate, alone.trajectory.torque_rate)


def numbers_of(case: CaseData) -> str:
    """Every number of a run but the times it took."""
    tables = result_tables(whole_run(Case(**vars(case))))
    timed = ("AccuracyCost", "Effects")  # wall times stand in them
    return repr(
        [
            {key: value for key, value in row.items() if name not in timed or key != "time"}
            for name, rows in tables.items()
            for row in rows
        ]
    )


def test_whole_runs_by_turns_have_the_bits_that_each_has_alone() -> None:
    """Linear starts and starts with clearances of different forms, more of them than wait for each other."""
    cases = [study_train(number).case for number in (0, 1, 2, 4, 6)]
    cases += [stiffer(sample_case("proposed"), 1.0 - 0.02 * i) for i in range(AT_ONCE)]
    alone = [numbers_of(case) for case in cases]
    assert len(set(alone)) == len(cases)
    assert by_turns([partial(numbers_of, case) for case in cases]) == alone


def test_an_error_of_one_calculation_is_raised_and_ends_the_others() -> None:
    before, went_on = threading.active_count(), []

    def failing() -> None:
        simulated([simulation(sample_case("proposed"))])
        raise ModelError("no such train")

    def other() -> None:
        for _ in range(3):
            simulated([simulation(sample_case("proposed"))])
            went_on.append(1)

    with pytest.raises(ModelError, match="no such train"):
        by_turns([other, failing, other])
    assert len(went_on) == 6  # their own results do not depend on it
    assert threading.active_count() == before


def test_calculations_that_are_interrupted_leave_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    before = threading.active_count()

    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("engine.start.by_turns.runs_of", interrupted)
    wanted: Callable[[], object] = partial(simulated, [simulation(sample_case("proposed"))])
    with pytest.raises(KeyboardInterrupt):
        by_turns([wanted, wanted])
    assert threading.active_count() == before
