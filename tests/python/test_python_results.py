"""Results and studies: the numbers of the command line to the last bit, as frames and as records."""

import dataclasses
import io
import json
import subprocess
import sys

import pytest
from command_line import torsionbook

import torsionbook as tb
from addin.contract.tables import RESULT_TABLES
from addin.report.build import build_document
from addin.report.document import Figure
from addin.report.figures import _style

EXAMPLES = (
    "example_modified",
    "example_backlash",
    pytest.param("example_motor", marks=pytest.mark.slow),
    pytest.param("example_proposed", marks=pytest.mark.slow),
)
#: Columns of which no calculation gives a number twice.
WALL_TIMES = [
    (spec.key, field.key) for spec in RESULT_TABLES for field in spec.columns if field.wall_time
]


@pytest.fixture(scope="module")
def done():
    return tb.run(tb.template("example_modified"))


def by_command(path, folder):
    """The results JSON that the command writes."""
    said = torsionbook(
        "recalc", path, "--out", folder, "--json", folder / "results.json", cwd=folder
    )
    assert said.returncode == 0, said.stderr
    return json.loads((folder / "results.json").read_text())


def without_times(content):
    """Results without dates and wall times."""
    content = json.loads(json.dumps(content))
    for table, column in WALL_TIMES:
        for row in content.get(table, ()):
            row.pop(column, None)
    content["audit"] = [
        row for row in content["audit"] if not row["item"].startswith(("Date", "Time spent"))
    ]
    return content


@pytest.mark.parametrize("example", EXAMPLES)
def test_numbers_are_those_of_the_command_line(tmp_path, example):
    by_script = tb.run(tb.template(example))
    expected = by_command(tb.template(example), tmp_path)
    assert without_times(by_script.to_json()) == without_times(expected)
    # frames hold the same bits
    for name in by_script.tables:
        frame = by_script.table(name)
        for number, row in enumerate(by_script.rows(name)):
            for key, value in row.items():
                if value is not None:
                    assert frame[key][number] == value, (name, key)


def test_the_verdicts_are_records(done):
    first = done.verdicts[0]
    assert done.overall == first["verdict"]
    assert done.headline
    with pytest.raises(TypeError):
        first["verdict"] = "pass"
    assert repr(done).startswith("<Results of '")


def test_frames_carry_units(done):
    base, us = done.table("StartupPeaks"), done.table("StartupPeaks", "us")
    assert base.attrs["units"]["maximum_torque"] == "N*m"
    assert us.attrs["units"]["maximum_torque"] == "lbf*ft"
    ratio = base["maximum_torque"] / us["maximum_torque"]
    assert ratio.to_numpy() == pytest.approx(0.45359237 * 9.80665 * 0.3048, rel=1e-12)
    margins = done.table("SeparationMargins", "us")
    assert margins.attrs["units"]["speed"] == "rpm"


def test_mode_shapes_have_a_column_a_mode(done):
    frame = done.table("ModeShapes")
    assert {"station", "mode_1", "mode_2", "mode_3"} <= set(frame.columns)
    assert frame["mode_2"].abs().max() == 1.0


def test_the_largest_torque_of_a_history_is_the_peak(done):
    for row in done.rows("StartupPeaks"):
        if row["element"] in done.histories:
            torque = done.history(row["element"])["torque"]
            assert torque.max() == pytest.approx(row["maximum_torque"], rel=1e-9)
    speed = done.speed()
    assert speed.attrs["units"] == {"time": "s", "speed": "rad/s"}
    assert speed["speed"].iloc[0] == 0.0
    with pytest.raises(LookupError, match="element 'nonsense' has no history. There are "):
        done.history("nonsense")


def test_progress_names_the_stages():
    stages = []
    tb.run(tb.template("example_modified"), progress=stages.append)
    assert len(stages) > 2
    assert all(isinstance(stage, str) for stage in stages)


def test_a_change_changes_the_answer(done):
    """A free train of which every stiffness is four times as large has twice the frequencies."""
    frame = done.input.table("Elements")
    frame["stiffness"] *= 4.0
    changed = tb.run(done.input.change({"Elements": frame}))
    for old, new in zip(
        done.rows("NaturalFrequencies"), changed.rows("NaturalFrequencies"), strict=True
    ):
        assert new["frequency"] == pytest.approx(2.0 * old["frequency"], rel=1e-9, abs=1e-6)


# --- studies --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "settings"),
    [("tune", {}), ("tolerances", {"samples": 30}), ("starts", {}), ("sensitivities", {})],
)
@pytest.mark.slow
def test_studies_are_those_of_the_command_line(tmp_path, name, settings):
    words = [word for key, value in settings.items() for word in (f"--{key}", str(value))]
    train = tb.read(tb.template("example_studies"))
    path = train.write(tmp_path / "train.json")
    said = torsionbook(
        name, path, "--json", tmp_path / "out.json", "--jobs", 1, *words, cwd=tmp_path
    )
    assert said.returncode == 0, said.stderr
    expected = json.loads((tmp_path / "out.json").read_text())
    by_script = tb.study(path, name, **settings)
    assert json.loads(json.dumps(by_script.to_json())) == expected
    assert by_script.sentence == expected["sentence"] or name == "tune"  # its JSON says it in SI
    for table in by_script.tables:
        assert len(by_script.table(table)) == len(by_script.rows(table)) > 0


SCRIPT = """\
import torsionbook as tb
rows = [{"Element": "LS coupling", "Quantity": "stiffness", "From": 0.5, "To": 1.2, "Steps": 12, "Unit": "1"}]
train = tb.read(tb.template("example_modified")).change({"Tuning": rows})
both = [tb.study(train, "tune", jobs=jobs).to_json() for jobs in (2, 1)]
print(both[0] == both[1], len(both[0]["tuning_results"]))
"""


def test_a_plain_script_may_use_several_processes(tmp_path):
    """Without ``if __name__ == "__main__"``: the processes do not run the script once more."""
    (script := tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)
    assert done.stdout == "True 13\n", done.stderr


def test_wrong_studies_and_settings_are_named():
    train = tb.read(tb.template("example_modified"))
    with pytest.raises(LookupError, match="There is no study 'nonsense'. There are .*tune"):
        tb.study(train, "nonsense")
    with pytest.raises(ValueError, match="tolerances has no setting 'sample'. Available: samples"):
        tb.study(train, "tolerances", sample=3)
    with pytest.raises(tb.InputError) as raised:
        tb.study(train, "tune")
    assert raised.value.problems[0].table == "Tuning"


def test_the_best_case_of_a_tuning_is_read_back(tmp_path):
    train = tb.read(tb.template("example_modified")).change(
        {
            "Tuning": [
                {"Element": "LS coupling", "Quantity": "stiffness", "Values": "0.5; 2", "Unit": "1"}
            ]
        }
    )
    tuned = tb.study(train, "tune")
    assert len(tuned.rows("TuningResults")) == 3
    (path,) = tuned.save("train", cases=tmp_path / "best", top=1)
    best = tb.read(path)
    rank_1 = next(one for one in tuned.to_json()["choices"] if one["rank"] == 1)
    assert rank_1["values"] == [best.value("Elements[LS coupling].Stiffness")]
    with pytest.raises(LookupError, match="tune has no option 'nonsense'. Available: top, cases"):
        tuned.save(nonsense=1)


# --- pictures -------------------------------------------------------------------------------------


def test_pictures_are_those_of_the_report(done):
    """Every one and no other: the same pixels, where they are saved as the report saves them."""
    calculation = done._calculation
    document = build_document("train.xlsx", done._read, calculation, vectors=False, pixels=True)
    printed = {
        block.png
        for section in document.sections
        for block in every_block(section)
        if isinstance(block, Figure)
    }
    drawn = {}
    for name in done.plots:
        target = io.BytesIO()
        with _style():
            done.plot(name).savefig(target, format="png", dpi=200, metadata={"Software": None})
        drawn[name] = target.getvalue()
        assert drawn[name] in printed, name
    assert set(drawn.values()) == printed
    assert {"schematic", "train", "shapes", "interference", "histories 3", "reversal"} <= {*drawn}


def every_block(thing):
    """Everything that stands in a part of a document."""
    for field in dataclasses.fields(thing):
        value = getattr(thing, field.name)
        for one in value if isinstance(value, tuple) else (value,):
            if dataclasses.is_dataclass(one):
                yield one
                yield from every_block(one)


def test_a_picture_that_is_none_is_named(done):
    with pytest.raises(
        LookupError, match="There is no picture 'nonsense'. There are schematic, train, shapes"
    ):
        done.plot("nonsense")


@pytest.mark.slow
def test_pictures_of_a_study_are_those_of_the_report(studied):
    """A workbook with recorded studies: its report, and the studies made anew by a script."""
    run = tb.run(studied)
    document = build_document("train.xlsx", run._read, run._calculation, vectors=False, pixels=True)
    printed = {b.png for s in document.sections for b in every_block(s) if isinstance(b, Figure)}
    made = {name: tb.study(studied, name) for name in ("tune", "starts", "sensitivities")}
    assert len(made["tune"].plots) == 1
    for study in made.values():
        for name in study.plots:
            target = io.BytesIO()
            with _style():
                study.plot(name).savefig(target, format="png", dpi=200, metadata={"Software": None})
            assert target.getvalue() in printed, name
    with pytest.raises(LookupError, match="There is no picture 'nonsense'"):
        made["tune"].plot("nonsense")
