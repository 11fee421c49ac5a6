"""Mistakes of engineers: what `check` or a calculation says of each, and that sensible trains raise no alarm."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from addin.contract.shipped import template_path
from addin.contract.tables import INPUT_TABLES, scalar
from addin.contract.units import RATED_TORQUE, SYNCHRONOUS_SPEED, parse_unit
from addin.recorded.results import recorded_fact
from addin.template.examples import EXAMPLES, example_case
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name
from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.data import TABLES, CaseData, value_of
from engine.case.plausibility import implausible
from engine.case.result_words import Judgement
from engine.model.build_train import build_train
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import impossible_train, unusual_train
from engine.run import run
from tests.cli.sensible_trains import AFTERWARDS, SENSIBLE, Mistake, mistakes
from tests.command_line import torsionbook
from tests.plausible_trains import plausible_train
from tests.random_starts import random_start
from tests.sample_case import sample_case, with_limits
from tests.typed_cells import typed
from tests.validation.cases import FOLDER, load_case
from tests.validation.models import case_of

#: Mistakes of which nothing tells: the train that they make is as sensible as the one that was meant.
SILENT = {
    "lbf in/rad under N m/rad",  # couplings 8.9 times as stiff: some are
    "stiffness referred to motor speed",  # a coupling 31 times as stiff: some are
    "lb in2 under lb ft2, LS hub M; LS hub G",  # a flywheel at the coupling
    "peak-to-peak for zero-to-peak",  # a pulsation of 0.3 pu: some motors have it
    "hp under kW",  # a motor of 8 MW that runs at 72 % load
}


def silent_name(mistake: Mistake) -> str:
    """The mistake; with its rows where the same words stand in the list twice."""
    twice = sum(m.mistake == mistake.mistake for m in mistakes()) > 1
    return f"{mistake.mistake}, {mistake.row}" if twice else mistake.mistake


def notes_of_check(data: CaseData) -> list[str]:
    """Notes on a case without errors, before any calculation."""
    case = Case(**vars(data))
    train = build_train(case)
    facts = full_speed(case, train)
    impossible = [one.sentence for one in impossible_train(case, train, facts)]
    return [*impossible, *implausible(case), *unusual_train(case, train, facts)]


def sentences_of_check(data: CaseData) -> list[str]:
    """Errors, or where there are none notes."""
    problems = find_problems(data)
    if problems:
        return [f"{p.table}, {p.column}: {p.message}" for p in problems]
    return notes_of_check(data)


@cache
def sensible(name: str) -> CaseData:
    """A train without any mistake."""
    return example_case(*SENSIBLE[name])


def names_the_cause(mistake: Mistake, sentences: list[str]) -> bool:
    return any(word.lower() in s.lower() for word in mistake.says for s in sentences)


@pytest.mark.parametrize(
    "mistake", list(mistakes()), ids=lambda m: f"{m.table}-{m.column}-{m.mistake}"
)
def test_a_mistake_is_named_before_anything_is_calculated(mistake: Mistake) -> None:
    """Each says its cell or its cause; those in `SILENT` are caught nowhere, which is tested too."""
    data = mistake.typed()
    if silent_name(mistake) not in SILENT:
        assert names_the_cause(mistake, sentences_of_check(data))
        return
    assert sentences_of_check(data) == []
    results, plain = run(Case(**vars(data))), run(Case(**vars(sensible(mistake.case))))
    assert results.verdicts[0].verdict != Judgement.CHECK_INPUTS
    assert not names_the_cause(mistake, list(set(results.warnings) - set(plain.warnings)))


def test_at_least_55_of_the_60_are_caught() -> None:
    listed = list(mistakes())
    assert len(listed) == 60
    assert sum(silent_name(m) not in SILENT for m in listed) >= 55


#: Of the list made after the rules: mistakes that no note names.
SILENT_AFTERWARDS = {
    "divided by 4",
    "cm under mm",
    "kg under lb",
    "order of motor",  # at the frequency of another row
    "N m/rad under lbf in/rad",
    "lbf in under lbf ft",
    "divided by ratio squared",
    "wrong frequency",
}


@pytest.mark.parametrize("mistake", list(mistakes(AFTERWARDS)), ids=lambda m: m.mistake)
def test_mistakes_that_were_listed_after_the_rules(mistake: Mistake) -> None:
    """22 of 30: what the rules find of mistakes that they were not made for."""
    found = names_the_cause(mistake, sentences_of_check(mistake.typed()))
    assert found == (mistake.mistake not in SILENT_AFTERWARDS)


# --- no false alarm -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SENSIBLE)
def test_the_trains_without_a_mistake_raise_no_alarm(name: str) -> None:
    assert sentences_of_check(sensible(name)) == []
    assert run(Case(**vars(sensible(name)))).verdicts[0].verdict != Judgement.CHECK_INPUTS


def published() -> list[str]:
    """Published cases with a train whose every station has inertia."""
    models = {path.stem: load_case(path.stem).get("model", {}) for path in FOLDER.glob("*.json")}
    return sorted(
        name
        for name, model in models.items()
        if "shafts" in model and all(node["J"] > 0.0 for node in model["nodes"])
    )


@pytest.mark.parametrize("name", published())
def test_published_cases_raise_no_alarm(name: str) -> None:
    assert notes_of_check(case_of(load_case(name)["model"])) == []


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_examples_raise_no_alarm(name: str) -> None:
    assert notes_of_check(example_case(EXAMPLES[name], "us")) == []


@pytest.mark.parametrize("design", ["proposed", "modified"])
def test_the_sample_case_raises_no_alarm(design: str) -> None:
    assert notes_of_check(sample_case(design)) == []
    assert notes_of_check(with_limits(sample_case(design))) == []


def test_four_hundred_sensible_trains_raise_no_alarm() -> None:
    alarms = {
        seed: notes for seed in range(400) if (notes := notes_of_check(plausible_train(seed)))
    }
    assert alarms == {}


@pytest.mark.parametrize("seed", range(12))
def test_sensible_trains_keep_their_verdict(seed: int) -> None:
    assert run(plausible_train(seed)).verdicts[0].verdict != Judgement.CHECK_INPUTS


def test_random_starts_raise_no_alarm_but_that_of_missing_damping() -> None:
    for seed in range(100):
        notes = [n for n in notes_of_check(random_start(seed)) if not n.startswith("No damping")]
        assert notes == [], seed


# --- typed into the blank templates ---------------------------------------------------------------


def cells_of(data: CaseData, system: str) -> dict[str, Any]:
    """A case as it is typed into a blank template, in the units of the template."""
    bases = {
        RATED_TORQUE: data.ratings.rated_torque,
        SYNCHRONOUS_SPEED: data.ratings.synchronous_speed,
    }

    def shown(value: Any, field: Any) -> Any:
        if not field.has_unit or not isinstance(value, float | int):
            return value
        unit = parse_unit(str(getattr(field, f"unit_{system}")), field.dimension)
        return value / unit.factor / (bases.get(unit.base) or 1.0)

    typed_scalars = (
        "LineFrequency",
        "Poles",
        "RatedTorque",
        "DampingRatio",
        "StartsRequired",
        "EndSpeed",
    )
    cells = {n: shown(value_of(data, n), scalar(n)) for n in typed_scalars}
    for spec in INPUT_TABLES:
        for number, row in enumerate(getattr(data, TABLES[spec.name][0]), 1):
            for column in spec.columns:
                value = getattr(row, column.attribute, None)
                if value is not None:
                    cells[f"{spec.name}/{number}/{column.name}"] = shown(value, column)
    return cells


def times(cells: Mapping[str, Any], table: str, column: str, factor: float) -> dict[str, Any]:
    """A column multiplied."""
    return {
        place: value * factor
        for place, value in cells.items()
        if place.startswith(f"{table}/") and place.endswith(f"/{column}")
    }


def without(cells: Mapping[str, Any], table: str, column: str) -> dict[str, Any]:
    """A column left blank."""
    return dict.fromkeys(times(cells, table, column, 1.0))


def forgotten_ratio(cells: Mapping[str, Any]) -> dict[str, Any]:
    return without(cells, "Stations", "Speed ratio")


def other_ratio(cells: Mapping[str, Any]) -> dict[str, Any]:
    """The ratio of another gear at all stations behind the gear."""
    typed = times(cells, "Stations", "Speed ratio", 1.2)
    return {place: value for place, value in typed.items() if value > 2.0}


def forgotten_ratio_without_radii(cells: Mapping[str, Any]) -> dict[str, Any]:
    radii = [place for place in cells if place.startswith("Meshes/")]
    return forgotten_ratio(cells) | dict.fromkeys(radii)


def percent_under_pu(cells: Mapping[str, Any]) -> dict[str, Any]:
    return {"MotorTorque/-1/Average": "pu", "MotorTorque/-1/Pulsating": "pu"}


def megawatts(cells: Mapping[str, Any]) -> dict[str, Any]:
    return {"RatedTorque": None, "RatedPower": 11.008}


def load_at_motor_speed(cells: Mapping[str, Any]) -> dict[str, Any]:
    return times(cells, "LoadTorque", "Torque", 5.6)


def gd2(cells: Mapping[str, Any]) -> dict[str, Any]:
    return times(cells, "Stations", "Inertia", 4.0)


def other_system(cells: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers in lb ft² under kg m²; in the US template in kg m² under lb ft²."""
    us = isinstance(cells["RatedTorque"], float) and cells["RatedTorque"] < 50e3
    return times(cells, "Stations", "Inertia", 0.04214011 if us else 23.730360)


def pole_pairs(cells: Mapping[str, Any]) -> dict[str, Any]:
    return {"Poles": 2}


def metres(cells: Mapping[str, Any]) -> dict[str, Any]:
    us = cells["RatedTorque"] < 50e3
    return times(cells, "Elements", "Stress diameter", 0.0254 if us else 0.001)


def no_pulsation(cells: Mapping[str, Any]) -> dict[str, Any]:
    return times(cells, "MotorTorque", "Pulsating", 0.0)


def newtons_under_meganewtons(cells: Mapping[str, Any]) -> dict[str, Any]:
    return times(cells, "Elements", "Peak torque limit", 1e6)


def millimetres(cells: Mapping[str, Any]) -> dict[str, Any]:
    return times(cells, "Elements", "Stress diameter", 25.4)


def no_scf(cells: Mapping[str, Any]) -> dict[str, Any]:
    return without(cells, "Elements", "SCF")


V6 = [
    (other_ratio, "they must agree to 0.1 %"),
    (forgotten_ratio_without_radii, "Stations, Speed ratio of 'Pinion': gear mesh 'Mesh'"),
    (percent_under_pu, "MotorTorque, Average of 'Motor': 124 × RatedTorque is unusual"),
    (megawatts, "inertia constant H = "),
    (load_at_motor_speed, "load of 1.4 × rated torque at full speed"),
    (gd2, "the inertia constant H = 11 s is unusual"),
    (other_system, "inertia constant H"),
    (pole_pairs, "Meshes, Pitch radius drive of 'Mesh': pitch line velocity of 160.9 m/s"),
    (metres, "Elements, Stress diameter of 'Motor shaft' (and 5 more)"),
    (no_scf, "Elements, SCF is blank at all 6 shafts"),
    (no_pulsation, "MotorTorque, Pulsating of 'Motor' is zero at every speed"),
    (newtons_under_meganewtons, "× rated torque: no verdict is given. Check its unit."),
    (millimetres, "nominal stress of 'Motor shaft' (and 5 more) 0.00"),
]


@pytest.mark.parametrize("system", ["us", "si"])
def test_a_forgotten_ratio_follows_from_the_pitch_radii(tmp_path: Path, system: str) -> None:
    cells = cells_of(example_case(EXAMPLES["modified"], "us"), system)
    blank = template_path(f"blank_{system}.xlsx")
    for name, changes in (("typed", {}), ("filled", forgotten_ratio(cells))):
        typed(blank, tmp_path / f"{name}.xlsx", {**cells, **changes})
    told = [
        torsionbook("check", tmp_path / f"{name}.xlsx", cwd=tmp_path).stdout.replace(name, "")
        for name in ("typed", "filled")
    ]
    assert "5.6" in told[0]  # the check shows the speeds of the shafts
    assert told[0] == told[1]


@pytest.mark.parametrize("system", ["us", "si"])
@pytest.mark.parametrize(("mistake", "words"), V6, ids=[m.__name__ for m, _ in V6])
def test_a_mistake_typed_into_a_blank_template_is_named(
    tmp_path: Path, system: str, mistake: Any, words: str
) -> None:
    cells = cells_of(example_case(EXAMPLES["modified"], "us"), system)
    blank = template_path(f"blank_{system}.xlsx")
    plain = torsionbook("check", typed(blank, tmp_path / "plain.xlsx", cells), cwd=tmp_path)
    assert "note:" not in plain.stdout
    assert "4 poles at 60 Hz; Motor 1,800 rpm, Pinion 10,080 rpm; total ratio 5.6; " in plain.stdout
    assert (
        "LoadTorque 24.9 % of rated; Running load 100 % of rated; " in plain.stdout
    )  # taken: it is blank
    assert "inertia constant H 2.76 s (motor 1.61 s)." in plain.stdout
    done = torsionbook(
        "check", typed(blank, tmp_path / "wrong.xlsx", cells | mistake(cells)), cwd=tmp_path
    )
    assert words.lower() in " ".join((done.stdout + done.stderr).split()).lower()


def test_a_calculation_repeats_the_train_at_full_speed(tmp_path: Path) -> None:
    """Modified design: 1,800 and 10,080 rpm, loads and H by hand."""
    cells = cells_of(example_case(EXAMPLES["modified"], "us"), "si")
    file = typed(template_path("blank_si.xlsx"), tmp_path / "train.xlsx", cells)
    done = torsionbook("recalc", file, "--in-place", "--json", "out.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    facts = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))["full_speed"]
    assert facts["poles"] == 4
    assert [row["station"] for row in facts["shafts"]] == ["Motor", "Pinion"]
    assert facts["shafts"][1]["speed"] == pytest.approx(10080.0 * math.pi / 30.0)
    load = (1170 + 780) * 5.6 / 43770
    assert facts["load"] == pytest.approx(load, rel=1e-9)
    assert facts["inertia_constant"] == pytest.approx(2.756, abs=0.001)
    assert facts["motor_inertia_constant"] == pytest.approx(1.606, abs=0.001)
    assert facts["running_load"] == pytest.approx(1.0, rel=1e-9)  # taken: the column is blank
    book = open_workbook(file, read_only=True, ignore_lock=True)
    assert recorded_fact(book, "run_ShaftSpeeds") == "Pinion 10,080 rpm"
    at = book.name("run_LoadShare")
    assert at.sheet is not None
    assert at.rect is not None
    assert book.shown_value(at.sheet, cell_name(at.rect.top, at.rect.left)) == pytest.approx(
        100.0 * load
    )
    rated = 43770 * 0.3048 * 4.4482216152605
    numbers = {"run_RatedPower": 1e-3 * rated * 60.0 * math.pi, "run_RatedTorque": rated}
    for name, expected in numbers.items():
        at = book.name(name)
        shown = book.shown_value(at.sheet, cell_name(at.rect.top, at.rect.left))
        assert shown == pytest.approx(expected, rel=1e-9)
