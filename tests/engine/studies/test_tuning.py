"""Tuning as a whole: each combination is a full run of its case, and the tables say so."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from engine.case.case import Case
from engine.case.data import MaterialRow, MeshRow, SNPointRow
from engine.case.study_inputs import CatalogueRow, StudyInputs, TuningRow
from engine.results.tables import result_tables
from engine.run import run
from engine.studies.tuning.combinations import plan_tuning
from engine.studies.tuning.evaluate import answers_of, calculate_combinations
from engine.studies.tuning.tuning import (
    TuningResult,
    band_rows,
    best_cases,
    crossing_rows,
    map_rows,
    rank_combinations,
    ranked_rows,
)
from tests.trains import geared
from tests.whole_studies import tune

LOW, HIGH = "Low-speed shaft", "High-speed shaft"


def judged(**fields: Any) -> Case:
    """The small geared train with shafts whose starts are counted."""
    base = geared()
    elements = tuple(
        e if e.element == "Mesh" else replace(e, stress_diameter=d, scf=2.0, material="steel")
        for e, d in zip(base.elements, (0.1, 0.0, 0.065), strict=True)
    )
    given: dict[str, Any] = {
        "elements": elements,
        "starts_required": 2000.0,
        "materials": (MaterialRow("steel", 7.6e8, 5.5e8, 1.2e8, "torsion"),),
        "sn_points": (SNPointRow("steel", 1e3, 4e8), SNPointRow("steel", 1e6, 1.2e8)),
    }
    return geared(**(given | fields))


CASE = judged()
STUDIES = StudyInputs(
    (
        TuningRow(HIGH, "stiffness", values=(0.5, 0.8, 1.0)),
        TuningRow("Motor", "inertia", values=(1.0, 1.2)),
    )
)


@pytest.fixture(scope="module")
def found() -> TuningResult:
    return tune(CASE, STUDIES)


def test_every_combination_has_its_rank_and_one_is_the_case_itself(found: TuningResult) -> None:
    assert [r.rank for r in found.rows] == [1, 2, 3, 4, 5, 6]
    assert len(found.rows) == found.planned
    assert [r.tried.combination.as_is for r in found.rows].count(True) == 1
    assert found.as_is is not None
    assert [r.better for r in found.rows] == [r.rank < found.as_is.rank for r in found.rows]


def test_a_row_says_what_the_plain_run_of_its_case_says(found: TuningResult) -> None:
    """Read out of the tables of the run, by another way than `answers_of` takes."""
    for told, (row, data) in zip(
        [r for r in ranked_rows(found) if not r["as_is"]], best_cases(CASE, found, 10), strict=True
    ):
        results = run(Case(**vars(data)))
        tables = result_tables(results)
        assert told["rank"] == row.rank
        elastic = [r["frequency"] for r in tables["NaturalFrequencies"] if r["mode"]]
        assert [told["mode_1"], told["mode_2"]] == elastic[:2]
        assert told["worst_margin"] == min(r["margin"] for r in tables["SeparationMargins"])
        governing = next(r for r in tables["AllowableStarts"] if r["governing"])
        assert (told["allowable_starts"], told["governing_shaft"]) == (
            governing["allowable_starts"],
            governing["element"],
        )
        assert told["error"] == governing["error"]
        fails = [v["check"] for v in tables["Verdicts"][1:] if v["verdict"] == "fail"]
        assert (told["limits_broken"], told["broken"]) == (len(fails), ", ".join(fails))
        assert told["peak_to_peak_stress"] in [
            r["peak_to_peak_stress"] for r in tables["StartupPeaks"]
        ]
        assert told["stress_with_scf"] == pytest.approx(2.0 * told["peak_to_peak_stress"])
        mesh = next(r for r in tables["StartupPeaks"] if r["element"] == "Mesh")
        assert told["mesh_minimum_torque"] == pytest.approx(mesh["minimum_torque"])
        rated = CASE.ratings.rated_torque or 0.0
        speed = {LOW: 1.0, "Mesh": 1.0, HIGH: 3.0}
        largest = max(
            max(abs(r["maximum_torque"]), abs(r["minimum_torque"])) * speed[r["element"]]
            for r in tables["StartupPeaks"]
        )
        assert told["peak_torque_over_rated"] == pytest.approx(largest / rated)


def test_crossings_are_those_of_the_run(found: TuningResult) -> None:
    rows = crossing_rows(found)
    (row, data), *_ = best_cases(CASE, found, 1)
    expected = result_tables(run(Case(**vars(data))))["StartupCrossings"]
    mine = [r for r in rows if r["rank"] == row.rank]
    assert [{k: r[k] for k in e} for r, e in zip(mine, expected, strict=True)] == expected
    best = {r["rank"] for r in crossing_rows(found, 2)}
    assert found.as_is is not None
    assert best == {1, 2, found.as_is.rank}


def test_tables_hold_plain_values_without_nan(found: TuningResult) -> None:
    for rows in (ranked_rows(found), crossing_rows(found), band_rows(found), map_rows(found)):
        assert rows
        json.dumps(rows, allow_nan=False)


def test_bands_count_the_combinations_that_keep_clear(found: TuningResult) -> None:
    rows = {r["excitation"]: r for r in band_rows(found)}
    for name, row in rows.items():
        clear = 0
        for ranked in found.rows:
            assert ranked.tried.answers is not None
            modes = ranked.tried.answers.modes
            clear += not any(row["from"] < f < row["to"] for f in modes)
        assert (name, row["combinations_clear"]) == (name, clear)
    assert sum(row["combinations_clear"] for row in rows.values()) < 6 * len(rows)


def test_the_map_has_one_cell_a_pair(found: TuningResult) -> None:
    rows = map_rows(found)
    assert len(rows) == 6
    by_rank = {r.rank: r for r in found.rows}
    for row in rows:
        options = by_rank[row["rank"]].tried.combination.options
        assert [o.value for o in options] == [row["across_value"], row["up_value"]]
    assert found.map.best_over == ()


def test_of_three_variables_a_cell_shows_the_best_over_the_third() -> None:
    studies = StudyInputs((*STUDIES.tuning[:1], TuningRow(LOW, "stiffness", values=(0.7, 1.0)), TuningRow("Load", "inertia", values=(0.8, 1.0))))  # fmt: skip
    found = tune(CASE, studies)
    assert found.map.best_over == ("Load inertia",)
    for j, line in enumerate(found.map.cells):
        for i, cell in enumerate(line):
            assert cell is not None
            same = [r for r in found.rows if r.tried.combination.picked[:2] == (i, j)]
            assert len(same) == 2
            assert same[0].tried is cell


def test_one_variable_makes_curves(found: TuningResult) -> None:
    one = tune(CASE, StudyInputs(STUDIES.tuning[:1]))
    assert one.map.up is None
    rows = map_rows(one)
    assert [r["across_value"] for r in rows] == [5e4, 8e4, 1e5]
    assert [r["mode_1"] for r in rows] == sorted(r["mode_1"] for r in rows)
    assert one.map.best_over == ()


def test_an_impossible_combination_is_a_row_with_its_sentence() -> None:
    """A diameter below its bore."""
    base = geared()
    shaft = replace(
        base.elements[0], stiffness=None, od=0.2, id=0.1, length=0.4, shear_modulus=8e10
    )
    case = replace(base, elements=(shaft, *base.elements[1:]))
    found = tune(case, StudyInputs((TuningRow(LOW, "diameter", values=(0.4, 1.1)),)))
    last = found.rows[-1]
    assert last.tried.answers is None
    assert "Elements, row 1" in last.tried.problem
    assert ranked_rows(found)[-1]["outcome"] == "impossible"
    assert "1 of them cannot be" in found.sentence
    assert [r["rank"] for r in map_rows(found)] == [3, found.rows[0].rank if not found.rows[0].tried.combination.as_is else 2]  # fmt: skip
    assert len(best_cases(case, found, 9)) == 1


def test_a_start_that_does_not_end_ranks_below_those_that_do() -> None:
    case = judged(maximum_time=3.0)
    found = tune(case, StudyInputs((TuningRow("Motor", "inertia", values=(0.9, 4.0)),)))
    worst = found.rows[-1]
    assert worst.tried.answers is not None
    assert worst.tried.answers.outcome == "time out"
    assert worst.tried.answers.starts is None
    assert worst.reason.startswith("Time out")
    assert ranked_rows(found)[-1]["allowable_starts"] is None


def test_allowable_starts_are_those_of_table_allowable_starts_whatever_the_factor() -> None:
    """StartsFactor divides what is judged, here as in the unchanged case."""
    studies = StudyInputs((TuningRow(HIGH, "stiffness", values=(1.0, 1.2)),))
    (one, two) = (tune(judged(starts_factor=f), studies) for f in (1.0, 50.0))
    plain = run(judged(starts_factor=50.0)).starts
    assert plain is not None
    assert plain.starts is not None
    broken = []
    for found in (one, two):
        assert found.as_is is not None
        assert found.as_is.tried.answers is not None
        assert found.as_is.tried.answers.starts == pytest.approx(plain.starts, rel=1e-12)
        broken.append(found.as_is.tried.answers.broken)
    assert broken[0] != broken[1]


def test_the_rated_torque_of_a_coupling_on_offer_is_judged() -> None:
    """It transmits 10 kN m, the rated torque of the train."""
    offers = (
        CatalogueRow(LOW, "weak", stiffness=3e6, rated_torque=9_999.0),
        CatalogueRow(LOW, "strong", stiffness=3e6, rated_torque=10_001.0),
    )
    found = tune(CASE, StudyInputs(catalogue=offers))
    broken = {r.combination: r.tried.answers.broken for r in found.rows if r.tried.answers}
    assert "Rated torque" in broken[f"{LOW}: weak"]
    assert "Rated torque" not in broken[f"{LOW}: strong"]


def test_each_rated_torque_that_is_exceeded_is_a_broken_limit() -> None:
    """Two couplings that are too weak stand below one, and above the worst of the two nothing hides."""
    offers = (
        CatalogueRow(LOW, "weak", stiffness=3e6, rated_torque=9_999.0),
        CatalogueRow(LOW, "strong", stiffness=3e6, rated_torque=10_001.0),
        CatalogueRow(HIGH, "frail", stiffness=1e6, rated_torque=1.0),
        CatalogueRow(HIGH, "firm", stiffness=1e6, rated_torque=1e6),
    )
    found = tune(CASE, StudyInputs(catalogue=offers))
    broken = {r.combination: r.tried.answers.broken for r in found.rows if r.tried.answers}
    count = {
        name: sum(one == "Rated torque" for one in broken[name])
        for name in (f"{LOW}: {low}; {HIGH}: {high}" for low in ("weak", "strong")
                     for high in ("frail", "firm"))
    }  # fmt: skip
    assert list(count.values()) == [2, 1, 1, 0]


def test_a_peak_limit_of_the_catalogue_is_judged_by_the_run() -> None:
    offers = (CatalogueRow(LOW, "limited", stiffness=3e6, peak_torque_limit=1.0),)
    found = tune(CASE, StudyInputs(catalogue=offers))
    row = next(r for r in found.rows if not r.tried.combination.as_is)
    assert row.tried.answers is not None
    assert "Peak torque" in row.tried.answers.broken


def test_impacts_of_teeth_are_counted_where_a_clearance_is_modelled() -> None:
    base = geared()
    mesh = replace(base.elements[1], stiffness=5e8)
    case = replace(
        base,
        elements=(base.elements[0], mesh, base.elements[2]),
        meshes=(MeshRow("Mesh", None, 0.3, 0.1, backlash=2e-4),),
        motor_torque=tuple(replace(p, pulsating=1.5 * (p.pulsating or 0.0)) for p in base.motor_torque),
    )  # fmt: skip
    found = tune(case, StudyInputs((TuningRow("Mesh", "backlash", values=(1.0,)),)))
    results = run(case)
    impacts = next(r.impacts for r in results.reversals if r.element == "Mesh")
    assert impacts
    assert ranked_rows(found)[0]["impacts"] == impacts


def test_a_stopped_study_says_so_and_keeps_what_it_has() -> None:
    found = tune(CASE, STUDIES, first=2)
    assert (len(found.rows), found.planned) == (2, 6)
    assert found.sentence.startswith("Stopped: 2 of 6 combinations were tried")
    assert sum(row["rank"] is None for row in map_rows(found)) == 4
    nothing = tune(CASE, STUDIES, first=0)
    assert nothing.rows == ()
    assert nothing.as_is is None
    assert "Stopped before the first" in nothing.sentence
    assert ranked_rows(nothing) == []
    assert len(band_rows(nothing)) == len(nothing.bands) > 0


def test_the_result_does_not_depend_on_who_calculated_what_when(found: TuningResult) -> None:
    plan = plan_tuning(CASE, STUDIES)

    def backwards() -> Iterator[Any]:
        for combination in reversed(plan.combinations):
            yield from calculate_combinations(CASE, [combination])

    again = rank_combinations(CASE, plan, backwards())
    assert ranked_rows(again) == ranked_rows(found)
    assert map_rows(again) == map_rows(found)
    assert again.sentence == found.sentence


def test_a_case_without_a_start_is_tuned_by_its_margins() -> None:
    case = geared(motor_torque=(), load_torque=())
    found = tune(case, StudyInputs((TuningRow(HIGH, "stiffness", values=(0.6, 0.8, 1.4)),)))
    margins = [r["worst_margin"] for r in ranked_rows(found) if not r["limits_broken"]]
    assert margins == sorted(margins, reverse=True)
    assert {r["outcome"] for r in ranked_rows(found)} == {"calculated"}


def test_answers_survive_the_way_to_another_process(found: TuningResult) -> None:
    import pickle

    tried = [r.tried for r in found.rows]
    assert pickle.loads(pickle.dumps(tried)) == tried
    assert answers_of(run(CASE)) == found.as_is.tried.answers if found.as_is else False
