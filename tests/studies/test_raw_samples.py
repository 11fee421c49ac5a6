"""Raw samples of a tolerance study: written with all digits, and one of them again to the same bits."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.reading.case_json import case_to_json
from engine.case.study_inputs import ScatterRow
from engine.studies.tolerances.raw_samples import raw_samples, sample_again
from engine.studies.tolerances.sample import ToleranceSettings
from tests.trains import geared
from tests.whole_studies import tolerances

RUN = CliRunner()
SCATTER = (
    ScatterRow(None, "stiffness", "normal", 0.05),
    ScatterRow(None, "inertia", "uniform", 0.02),
)


@pytest.fixture
def case(tmp_path: Path) -> Path:
    place = tmp_path / "case.json"
    rows = [
        {"quantity": r.quantity, "distribution": r.distribution, "spread": r.spread}
        for r in SCATTER
    ]
    place.write_text(json.dumps(case_to_json(geared()) | {"scatter": rows}), encoding="utf-8")
    return place


def said(*words: object, code: int = 0) -> str:
    done = RUN.invoke(app, [str(word) for word in words], env={"COLUMNS": "400"})
    assert done.exit_code == code, done.output
    return " ".join(done.output.replace("│", " ").split())


def read(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_one_sample_again_is_its_row_of_the_study_to_the_bit() -> None:
    settings = ToleranceSettings(samples=30, seed=7)
    study = tolerances(geared(), SCATTER, settings)
    whole = raw_samples(study.plan, study.answers)
    assert len(whole.rows) == 30
    for number in (1, 18, 30):
        again, _ = sample_again(geared(), SCATTER, settings, number)
        assert again.columns == whole.columns
        assert again.rows == (whole.rows[number - 1],)


def test_samples_of_the_command_and_one_of_them_again(case: Path, tmp_path: Path) -> None:
    every, one, same = (tmp_path / name for name in ("raw.csv", "one.csv", "one.parquet"))
    size = ("--samples", 40, "--seed", 3)
    assert "raw.csv" in said("tolerances", case, *size, "--samples", every, "--jobs", 1)
    rows = read(every)
    assert [int(row["sample"]) for row in rows] == list(range(1, 41))
    assert {(row["seed"], row["method"], row["samples"]) for row in rows} == {("3", "lhs", "40")}
    drawn = tmp_path / "drawn.json"
    told = said("tolerances", case, *size, "--only", 12, "--samples", one, "--case", drawn)
    assert "Sample 12 of 40, calculated alone" in told
    assert read(one) == [rows[11]]  # every digit
    said("tolerances", case, *size, "--only", 12, "--samples", same)
    (kept,) = pq.read_table(same).to_pylist()
    for name, text in rows[11].items():
        value = kept[name]
        if isinstance(value, float):
            assert float(text) == value, name
        else:
            assert text == ("" if value is None else str(value)), name
    # the case of the sample, calculated by itself, has the same frequencies to the bit
    found = tmp_path / "found.json"
    said("recalc", drawn, "--json", found)
    modes = json.loads(found.read_text(encoding="utf-8"))["natural_frequencies"]
    elastic = [mode["frequency"] for mode in modes if mode["frequency"] > 0.0]
    own = [float(v) for name, v in rows[11].items() if name.startswith("frequency of mode")]
    assert own
    assert elastic[: len(own)] == own


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--samples", "raw.txt"), "end it in .csv or .parquet"),
        (("--samples", "raw.xlsx"), "is the name of a workbook; end it in .csv or .parquet"),
        (("--samples", "a.csv", "--samples", "b.csv"), "is given two files"),
        (("--samples", "40", "--samples", "50"), "is given two numbers"),
        (("--samples", "5"), "must be a whole number from 30"),
        (("--samples", "40", "--only", "41"), "Give a number from 1 to 40"),
        (("--case", "one.json"), "say which with --only"),
        (("--only", "3", "--json", "one.json"), "not the study that --json would write"),
        (("--only", "3", "--in-place"), "not the study that --in-place would write"),
        (("--only", "3", "--samples", "one.csv", "--case", "one.csv"), "would both be written to"),
        (("--samples", "case.json/a.csv"), "is a file"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_study(
    case: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], sentence: str
) -> None:
    monkeypatch.chdir(case.parent)
    assert sentence in said("tolerances", case, *words, code=2)
    assert [p.name for p in case.parent.iterdir()] == ["case.json"]


def test_samples_never_replace_the_input_or_a_workbook(case: Path, tmp_path: Path) -> None:
    assert "would overwrite the input" in said("tolerances", case, "--samples", case, code=2)
    same = ("--samples", tmp_path / "same.csv", "--json", tmp_path / "same.csv")
    assert "name the same file; give two" in said("tolerances", case, *same, code=2)
    assert not (tmp_path / "same.csv").exists()
    taken = tmp_path / "taken.csv"
    taken.write_bytes(b"PK\3\4 mine")
    assert "is a workbook or a document" in said("tolerances", case, "--samples", taken, code=2)
    assert taken.read_bytes() == b"PK\3\4 mine"
