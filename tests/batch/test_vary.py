"""A programme of cases from a table: names, units, wrong rows, resume."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest
from batch_helpers import Here, make_train
from command_line import command, environment, torsionbook

from addin.batch import vary, vary_rows
from addin.batch.folder import OWN, OutFolder
from addin.batch.own_files import is_result, is_result_csv
from addin.batch.scheduler import Listener
from addin.batch.vary import Programme, ProgrammeSettings, run_programme
from addin.batch.vary_columns import TableRefused
from addin.cli import batch as commands
from addin.reading.workbook import read_workbook
from addin.workers.pool import Crashed
from addin.workers.stop import Stop
from addin.writing.recalculate import recalculate

#: Two discs and a shaft: f = √(k (1/J1 + 1/J2)) / 2π.
TWO_DISCS = {
    "format": 1,
    "line_frequency": 60,
    "poles": 4,
    "rated_power": 1e6,
    "damping_ratio": 0.02,
    "stations": [
        {"station": "Motor", "inertia": 10.0},
        {"station": "Fan", "inertia": 40.0, "running_load": 1000.0},
    ],
    "elements": [
        {"element": "Shaft", "kind": "shaft", "from": "Motor", "to": "Fan", "stiffness": 1e6}
    ],
}


def frequency(stiffness: float, first: float = 10.0, second: float = 40.0) -> float:
    return math.sqrt(stiffness * (1 / first + 1 / second)) / (2 * math.pi)


@pytest.fixture
def base(tmp_path) -> Path:
    (tmp_path / "base.json").write_text(json.dumps(TWO_DISCS), encoding="utf-8")
    return tmp_path / "base.json"


def run(
    base: Path, table: Path, out: Path, *, workers=None, resume: bool = False
) -> tuple[Programme, pd.DataFrame]:
    with OutFolder(out) as folder:
        done = run_programme(
            base,
            table,
            folder,
            workers or Here(),
            ProgrammeSettings(resume),
            stop=Stop(),
            listener=Listener(),
        )
    return done, pd.read_parquet(done.result)


def csv(place: Path, *lines: str, **more) -> Path:
    path = place / "table.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", **more)
    return path


# --- names and units ------------------------------------------------------------------------------


def test_each_row_is_a_case_and_a_blank_leaves_the_base(base, tmp_path):
    table = csv(
        tmp_path,
        "Name,Elements[Shaft].Stiffness,Stations[Fan].Inertia",
        "soft,250000,",
        "heavy,,160",
        "both,4e6,160",
    )
    done, rows = run(base, table, tmp_path / "out")
    assert done.outcomes == {"done": 3}
    assert list(rows["name"]) == ["soft", "heavy", "both"]
    assert list(rows["row"]) == [1, 2, 3]
    exact = [frequency(2.5e5), frequency(1e6, second=160), frequency(4e6, second=160)]
    assert list(rows["mode_1_Hz"]) == pytest.approx(exact, rel=1e-12)
    assert rows["Stations[Fan].Inertia"].isna().tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("header", "value"),
    [
        ("Elements[Shaft].Stiffness", "2e6"),
        ("Elements[1].Stiffness", "2e6"),
        ("elements[Shaft].stiffness", "2e6"),
        ("Elements[Shaft].Stiffness [kN*m/rad]", "2000"),
        ("Elements[Shaft].Stiffness", "2000 kN*m/rad"),
        ("Elements[Shaft].Stiffness [lbf*in/rad]", "2 MN*m/rad"),
    ],
)
def test_units_stand_in_the_header_or_in_the_cell_else_they_are_si(base, tmp_path, header, value):
    _, rows = run(base, csv(tmp_path, header, value), tmp_path / "out")
    assert rows["mode_1_Hz"][0] == pytest.approx(frequency(2e6), rel=1e-12)


def test_the_result_holds_the_values_in_the_unit_of_their_column(base, tmp_path):
    table = csv(tmp_path, "Elements[Shaft].Stiffness [kN*m/rad]", "2000", "3 MN*m/rad")
    _, rows = run(base, table, tmp_path / "out")
    assert list(rows["Elements[Shaft].Stiffness [kN*m/rad]"]) == pytest.approx([2000.0, 3000.0])


def test_numbers_are_those_of_the_workbook_with_the_value_typed_in(tmp_path):
    """Bit for bit, torques in per unit of the rated torque follow it."""
    base = make_train(tmp_path / "base.xlsx", 0)
    typed = make_train(tmp_path / "typed.xlsx", 0, DampingRatio=2.25, RatedTorque=45000.0)
    alone = recalculate(typed, destination=tmp_path / "typed.out.xlsx")
    assert alone.calculation is not None
    table = csv(tmp_path, "DampingRatio [%],RatedTorque [lbf*ft]", "2.25,45000")
    _, rows = run(base, table, tmp_path / "out")
    results = alone.calculation.results
    assert rows["mode_1_Hz"][0] == results.modes.elastic_frequency[0]
    assert rows["allowable_starts"][0] == results.starts.judged_starts
    peaks = {p.element: max(abs(p.maximum), abs(p.minimum)) for p in results.start.peaks}
    assert rows["peak_torque_N_m"][0] == peaks[rows["peak_torque_at"][0]]
    assert rows["case_sha256"][0] == alone.calculation.case_sha256


def test_a_share_of_rated_torque_is_told_in_the_unit_of_its_column(tmp_path):
    """What was calculated stands in the result, also where the case alone knows how much that is."""
    base = Path(__file__).resolve().parents[2] / "templates" / "example_proposed.xlsx"
    column = "MotorTorque[3].Pulsating"
    rated = read_workbook(base).data.rated_torque
    table = csv(tmp_path, f"{column},MotorTorque[4].Pulsating [kN*m]", "12 %,20 %", "9000,", ",8.5")
    _, rows = run(base, table, tmp_path / "out")
    assert list(rows[column][:2]) == pytest.approx([0.12 * rated, 9000.0], rel=1e-12)
    assert math.isnan(rows[column][2])
    other = rows["MotorTorque[4].Pulsating [kN*m]"]
    assert [other[0], other[2]] == pytest.approx([0.2 * rated / 1e3, 8.5], rel=1e-12)


def test_parquet_and_csv_with_semicolons_give_the_same(base, tmp_path):
    header = "Elements[Shaft].Stiffness"
    _, plain = run(
        base, csv(tmp_path, f"{header},DampingRatio", "1e6,0.01", "2e6,"), tmp_path / "a"
    )
    semicolons = csv(tmp_path, f"\ufeff{header};DampingRatio", "1e6;0.01", "2e6;")
    _, second = run(base, semicolons, tmp_path / "b")
    columns = pd.DataFrame({header: [1e6, 2e6], "DampingRatio": [0.01, None]})
    columns.to_parquet(tmp_path / "table.parquet")
    _, third = run(base, tmp_path / "table.parquet", tmp_path / "c")
    for other in (second, third):
        pd.testing.assert_frame_equal(plain.drop(columns="seconds"), other.drop(columns="seconds"))


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("DampingRato", "column 1, 'DampingRato': scalar 'DampingRato' does not exist. Did you mean 'DampingRatio'"),
        ("Elements[Shaft].Stifness", "column of Elements 'Stifness' does not exist. Did you mean 'Stiffness'"),
        ("Elements[Shft].Stiffness", "no row 'Shft'. Did you mean 'Shaft'"),
        ("Elements[7].Stiffness", "1 to 1"),
        ("Materials[1].UTS", "the base case has no row in table Materials"),
        ("Element[Shaft].Stiffness", "input table 'Element' does not exist. Did you mean 'Elements'"),
        ("Elements[Shaft].Stiffness [kg]", "'kg' is not a unit of torsional stiffness"),
        ("Poles [rpm]", "Poles has no unit"),
        ("Elements.Stiffness", "it must name a scalar"),
        ("DampingRatio,dampingratio", "column 2, 'dampingratio': column 'DampingRatio' names the same"),
        ("Name", "no column of the table names an input"),
    ],
)  # fmt: skip
def test_a_wrong_column_is_named_before_anything_is_calculated(base, tmp_path, header, said):
    with pytest.raises(TableRefused) as wrong:
        run(base, csv(tmp_path, header, "1"), tmp_path / "out")
    assert said in str(wrong.value)
    assert not (tmp_path / "out" / "results.parquet").exists()


def test_wrong_rows_are_rows_with_the_reason(base, tmp_path):
    table = csv(
        tmp_path,
        "Elements[Shaft].Stiffness [kN*m/rad],DampingRatio",
        "1000,0.02",
        "-5,0.02",
        "soft,0.02",
        '"1,5",0.02',
        "1000",
        "1000,0.02,3",
        "1000,70 kg",
        "2000,0.02",
    )
    done, rows = run(base, table, tmp_path / "out")
    assert done.outcomes == {"done": 2, "wrong input": 6}
    assert list(rows["outcome"] == "done") == [True, *[False] * 6, True]
    reasons = list(rows["reason"])
    assert reasons[1].startswith("Elements[Shaft].Stiffness [kN*m/rad]: found -5 kN*m/rad")
    assert "found 'soft'" in reasons[2]
    assert "decimal point" in reasons[3]
    assert "1 values, the table 2 columns" in reasons[4]
    assert "3 values" in reasons[5]
    assert reasons[6].startswith("DampingRatio: ")
    assert done.reasons[0].startswith("row 2: Elements[Shaft].Stiffness")
    assert rows["mode_1_Hz"][7] == pytest.approx(frequency(2e6), rel=1e-12)


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"DampingRatio\n"])
def test_odd_tables(base, tmp_path, content):
    (tmp_path / "table.csv").write_bytes(content)
    if content.startswith(b"Damping"):
        done, rows = run(base, tmp_path / "table.csv", tmp_path / "out")
        assert (done.rows, len(rows)) == (0, 0)
        return
    with pytest.raises(TableRefused):
        run(base, tmp_path / "table.csv", tmp_path / "out")


def test_a_table_of_headings_alone_is_told(tmp_path, base):
    """It said "0 rows in 0.3 s: ."."""
    table = csv(tmp_path, "DampingRatio")
    done = torsionbook("batch", base, "--vary", table, "--out", "out", "--jobs", 1, cwd=tmp_path)
    assert done.returncode == 0
    assert "the table has none below its headings." in " ".join(done.stdout.split())


def test_a_base_case_with_errors_is_told(tmp_path, base):
    base.write_text('{"format": 1, "poles": 3}', encoding="utf-8")
    with pytest.raises(TableRefused, match="base case"):
        run(base, csv(tmp_path, "DampingRatio", "0.02"), tmp_path / "out")


@pytest.mark.slow
@pytest.mark.parametrize("bad", ['{"format": 1, "poles": 3}', "no case"])
def test_results_of_a_base_case_that_turned_bad_are_set_aside(base, tmp_path, bad):
    table, out = csv(tmp_path, "DampingRatio;Name", "0,02;a"), tmp_path / "out"
    words = ("batch", base, "--vary", table, "--out", out, "--csv", "--jobs", 1)
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    first = {name: (out / name).read_bytes() for name in ("results.parquet", "results.csv")}
    good = base.read_bytes()
    base.rename(tmp_path / "away.json")  # that passes by itself
    assert torsionbook(*words, cwd=tmp_path).returncode == 1
    assert {name: (out / name).read_bytes() for name in first} == first
    base.write_text(bad, encoding="utf-8")
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 1
    for name, content in first.items():
        said = f"{name} is the result of an earlier calculation; it was renamed to {name}.old."
        assert said in done.stderr
        assert not (out / name).exists()
        assert (out / f"{name}.old").read_bytes() == content
    base.write_bytes(good)
    (out / OWN / "vary" / "programme.json").write_text(
        "{", encoding="utf-8"
    )  # torn, as versions before 0.2 could
    assert torsionbook(*words, "--resume", cwd=tmp_path).returncode == 0
    assert pd.read_parquet(out / "results.parquet")["outcome"].tolist() == ["done"]


def test_a_file_of_somebody_else_is_not_set_aside(base, tmp_path):
    (tmp_path / "out").mkdir()
    mine = tmp_path / "out" / "results.parquet"
    pd.DataFrame({"row": [1]}).to_parquet(mine)
    (tmp_path / "out" / "results.csv").write_text("row,name,mine\n", encoding="utf-8")
    base.write_text("no case", encoding="utf-8")
    with pytest.raises(TableRefused) as told:
        run(base, csv(tmp_path, "DampingRatio", "0.02"), tmp_path / "out")
    assert "earlier" not in str(told.value)
    assert sorted(p.name for p in mine.parent.glob("r*")) == ["results.csv", "results.parquet"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["results.parquet", "results.csv"])
def test_a_file_of_somebody_else_is_not_replaced(base, tmp_path, name):
    table, out = csv(tmp_path, "DampingRatio", "0.02"), tmp_path / "out"
    words = ("batch", base, "--vary", table, "--out", out, "--csv", "--jobs", 1)
    out.mkdir()
    mine = out / name
    if name.endswith("csv"):
        mine.write_text("row,name,outcome,mine\n", encoding="utf-8")
    else:
        pd.DataFrame({"row": [1], "name": ["a"], "outcome": ["mine"]}).to_parquet(mine)
    before = mine.read_bytes()
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 2
    said = " ".join(done.stderr.replace("│", " ").split())
    assert f"{name} exists and was not written by torsionbook" in said
    assert mine.read_bytes() == before
    assert [one.name for one in out.iterdir()] == [name]
    mine.rename(out / "mine")
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    assert torsionbook(*words, cwd=tmp_path).returncode == 0  # its own it replaces
    assert is_result(out / "results.parquet")
    assert is_result_csv(out / "results.csv")
    # a column of somebody's own beside ours makes it his
    if name.endswith("csv"):
        mine.write_text(
            mine.read_text("utf-8-sig").replace("seconds", "seconds,my note", 1), encoding="utf-8"
        )
    else:
        read = pq.read_table(mine)
        pq.write_table(read.append_column("my note", read["reason"]), mine)
    assert torsionbook(*words, cwd=tmp_path).returncode == 2


def test_results_are_known_by_their_columns(base, tmp_path):
    done, _ = run(base, csv(tmp_path, "DampingRatio", "0.02"), tmp_path / "out")
    read = pq.read_table(done.result)
    for table, ours in (
        (read, True),
        (read.replace_schema_metadata(None), True),  # as files were before they stated them
        (read.drop_columns(["seconds"]), False),
        (read.drop_columns(["seconds"]).replace_schema_metadata(None), False),
        (read.slice(0, 0), True),
    ):
        pq.write_table(table, tmp_path / "one.parquet")
        assert is_result(tmp_path / "one.parquet") is ours
    (tmp_path / "one.parquet").write_bytes(b"PAR1 not at all PAR1")
    assert not is_result(tmp_path / "one.parquet")
    assert not is_result(tmp_path)


def test_a_row_whose_process_dies_does_not_take_its_chunk_along(base, tmp_path):
    class Crashing(Here):
        def answers(self, stopped):
            for task, answer in super().answers(stopped):
                dies = any(number == 3 for number, *_ in task.payload.rows)
                yield task, Crashed("ended by SIGKILL") if dies else answer

    table = csv(tmp_path, "DampingRatio", *[f"0.0{n}" for n in range(1, 8)])
    done, rows = run(base, table, tmp_path / "out", workers=Crashing())
    assert done.outcomes == {"done": 6, "crashed": 1}
    assert list(rows["row"]) == list(range(1, 8))
    assert rows["reason"][2] == "ended by SIGKILL"


# --- chunks and resume ----------------------------------------------------------------------------


def many(place: Path, count: int = 230) -> Path:
    stiffness = [1e6 + 1e3 * n for n in range(count)]
    return csv(place, "Elements[Shaft].Stiffness", *map(str, stiffness))


def test_rows_keep_their_order_over_chunks(base, tmp_path):
    _, rows = run(base, many(tmp_path), tmp_path / "out")
    assert list(rows["row"]) == list(range(1, 231))
    exact = [frequency(1e6 + 1e3 * n) for n in range(230)]
    assert list(rows["mode_1_Hz"]) == pytest.approx(exact, rel=1e-12)


def test_resume_calculates_only_chunks_that_are_missing(base, tmp_path, monkeypatch):
    table, out = many(tmp_path), tmp_path / "out"
    _, first = run(base, table, out)
    (out / OWN / "vary" / "0000002.json").unlink()
    calls = []
    real = vary_rows._answers
    monkeypatch.setattr(vary_rows, "_answers", lambda *given: calls.append(1) or real(*given))
    done, second = run(base, table, out, resume=True)
    assert len(calls) == vary.ROWS
    assert done.kept == 230 - vary.ROWS
    pd.testing.assert_frame_equal(first.drop(columns="seconds"), second.drop(columns="seconds"))


@pytest.mark.slow
@pytest.mark.parametrize("changed", ["table", "base"])
def test_resume_refuses_another_programme(base, tmp_path, changed):
    table = many(tmp_path)
    run(base, table, tmp_path / "out")
    (table if changed == "table" else base).write_text(
        "DampingRatio\n0.1\n" if changed == "table" else json.dumps(TWO_DISCS | {"poles": 6})
    )
    with pytest.raises(TableRefused, match="has changed"):
        run(base, table, tmp_path / "out", resume=True)
    _, rows = run(base, table, tmp_path / "out")
    assert len(rows) == (1 if changed == "table" else 230)


def test_equal_rows_of_a_chunk_are_calculated_once(base, tmp_path, monkeypatch):
    calls = []
    real = vary_rows._answers
    monkeypatch.setattr(vary_rows, "_answers", lambda *given: calls.append(1) or real(*given))
    table = csv(tmp_path, "DampingRatio", "0.01", "0.02", "0.01", "1 %")
    _, rows = run(base, table, tmp_path / "out")
    assert len(calls) == 2
    assert rows["mode_1_Hz"].nunique() == 1


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="kills a group of processes")
@pytest.mark.parametrize("how", ["SIGKILL", "SIGINT"])
def test_ended_in_the_middle_it_goes_on(base, tmp_path, how):
    table = many(tmp_path, 1500)
    words = ("batch", base, "--vary", table, "--out", "out")
    process = subprocess.Popen(
        command(*words, "--jobs", 2),
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    parts = tmp_path / "out" / OWN / "vary"
    until = time.monotonic() + 120
    while len(list(parts.glob("0*.json"))) < 3 and process.poll() is None:
        assert time.monotonic() < until
        time.sleep(0.01)
    os.killpg(process.pid, signal.Signals[how])
    said, _ = process.communicate(timeout=60)
    if how == "SIGINT":
        assert process.returncode == 130
        assert "not begun" in said
        reached = pq.ParquetFile(tmp_path / "out" / "results.parquet").metadata.num_rows
        assert vary.ROWS * 3 <= reached < 1500
    again = torsionbook(*words, "--resume", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "1,500 done" in again.stdout
    assert "in an earlier run" in again.stdout
    shutil.rmtree(parts)
    rows = pd.read_parquet(tmp_path / "out" / "results.parquet")
    exact = [frequency(1e6 + 1e3 * n) for n in range(1500)]
    assert list(rows["mode_1_Hz"]) == pytest.approx(exact, rel=1e-12)


@pytest.mark.slow
def test_words_of_the_command_line(base, tmp_path):
    shutil.copy(base, tmp_path / "second.json")
    csv(tmp_path, "DampingRatio", "0.02", "-1")
    two = torsionbook("batch", "base.json", "second.json", "--vary", "table.csv", "--out", "o", cwd=tmp_path)  # fmt: skip
    assert two.returncode == 2
    assert "one base case" in two.stderr
    gone = torsionbook("batch", "base.json", "--vary", "no.csv", "--out", "o", cwd=tmp_path)
    assert gone.returncode == 1
    assert "no.csv: it cannot be read: No such file" in gone.stderr
    some = torsionbook("batch", "base.json", "--vary", "table.csv", "--out", "o", cwd=tmp_path)
    assert some.returncode == 1
    assert "2 rows in" in some.stdout
    assert "row 2: DampingRatio: found -1" in some.stderr


# --- tables of Excel ------------------------------------------------------------------------------

STIFFNESS = "Elements[Shaft].Stiffness [kN*m/rad]"


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (f"Name;{STIFFNESS};DampingRatio\r\nä;2000,5;0,03\r\nb;1,5E+03;\r\n", "utf-8-sig"),
        (f"sep=;\r\nName;{STIFFNESS}\r\nä;2000,5\r\nb;1500\r\n", "utf-8"),
        (f'"sep=\t"\r\nName\t{STIFFNESS}\r\nä\t2000,5\r\nb\t1500,0\r\n', "utf-16"),
        (f"Name\t{STIFFNESS}\r\nä\t2000,5\r\nb\t1500\r\n", "utf-16"),
        (f"Name\t{STIFFNESS}\r\nä\t2000.5\r\nb\t1500\r\n", "utf-16"),
        (f"sep=,\r\nName,{STIFFNESS}\r\nä,2000.5\r\nb,1500\r\n", "utf-8"),
        (f"Name;{STIFFNESS}\r\nä;2,0005 MN*m/rad\r\nb;1500\r\n", "utf-8"),
    ],
)
def test_what_excel_writes_is_read(base, tmp_path, text, encoding):
    (tmp_path / "table.csv").write_bytes(text.encode(encoding))
    done, rows = run(base, tmp_path / "table.csv", tmp_path / "out")
    assert done.outcomes == {"done": 2}, done.reasons
    assert list(rows["name"]) == ["ä", "b"]
    exact = [frequency(2.0005e6), frequency(1.5e6)]
    assert list(rows["mode_1_Hz"]) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("number", ["1.234,5", "1.234", "1.234.000", "1.234,5 kN*m/rad"])
def test_a_table_with_decimal_commas_has_no_points(base, tmp_path, number):
    table = csv(tmp_path, f"{STIFFNESS};DampingRatio", "1000,5;", f"{number};", "1000;")
    done, rows = run(base, table, tmp_path / "out")
    assert list(rows["outcome"]) == ["done", "wrong input", "done"]
    assert f"found '{number}'; this table uses decimal commas" in rows["reason"][1]


def test_a_comma_that_may_stand_between_thousands_is_refused(base, tmp_path):
    """Tabs say nothing of the decimal sign: 1,234 is 1234 to one Excel and 1.234 to another."""
    table = csv(tmp_path, f"{STIFFNESS}\tDampingRatio", "1,234\t", "1500.5\t0.02")
    _, rows = run(base, table, tmp_path / "out")
    assert list(rows["outcome"]) == ["wrong input", "done"]
    assert "decimal point" in rows["reason"][0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lines", "separator", "decimal"),
    [
        (("Name;DampingRatio;Tag", "=x;0,025;a", "b;0,03;"), ";", ","),
        (("Name,DampingRatio,Tag", "=x,0.025,a", "b,0.03,"), ",", "."),
    ],
)
def test_results_for_excel_have_the_form_of_the_table(base, tmp_path, lines, separator, decimal):
    csv(tmp_path, *lines)
    words = ("batch", "base.json", "--vary", "table.csv", "--csv", "--out", "out", "--jobs", "1")
    said = torsionbook(*words, cwd=tmp_path)
    assert said.returncode == 0, said.stderr
    assert "results.csv" in said.stdout
    written = (tmp_path / "out" / "results.csv").read_bytes()
    assert written.startswith(b"\xef\xbb\xbf")
    shown = pd.read_csv(
        tmp_path / "out" / "results.csv", sep=separator, decimal=decimal, encoding="utf-8-sig"
    )
    whole = pd.read_parquet(tmp_path / "out" / "results.parquet")
    assert list(shown) == list(whole)
    assert list(shown["name"]) == ["'=x", "b"]
    for column in ("DampingRatio", "mode_1_Hz", "seconds"):
        assert list(shown[column]) == list(whole[column])


@pytest.fixture
def without_pyarrow():
    """Programmes run where pyarrow cannot be imported; their exit status."""

    def run_without(base, table, out, settings):
        with pytest.MonkeyPatch.context() as patch:
            for name in ("pyarrow", "pyarrow.parquet"):
                patch.setitem(sys.modules, name, None)  # importing it is an ImportError
            return commands._varied(base, table, out, Here(), settings, Stop())

    return run_without


def test_without_pyarrow_results_are_csv(base, tmp_path, without_pyarrow, capsys):
    count = vary.ROWS + 3
    table, out = many(tmp_path, count), tmp_path / "out"
    assert without_pyarrow(base, table, out, ProgrammeSettings(as_csv=True)) == 0
    said = capsys.readouterr()
    assert f"{count} rows in" in said.out
    assert "results.parquet needs pyarrow" in said.err
    assert not (out / "results.parquet").exists()
    first = pd.read_csv(out / "results.csv", encoding="utf-8-sig")
    exact = [frequency(1e6 + 1e3 * n) for n in range(count)]
    assert list(first["mode_1_Hz"]) == pytest.approx(exact, rel=1e-12)
    (out / OWN / "vary" / "0000001.json").unlink()
    assert without_pyarrow(base, table, out, ProgrammeSettings(resume=True, as_csv=True)) == 0
    assert f"({vary.ROWS} of them in an earlier run)" in capsys.readouterr().out
    second = pd.read_csv(out / "results.csv", encoding="utf-8-sig")
    pd.testing.assert_frame_equal(first.drop(columns="seconds"), second.drop(columns="seconds"))


def test_without_pyarrow_parquet_is_refused(base, tmp_path, without_pyarrow, capsys):
    table, out = csv(tmp_path, "DampingRatio", "0.02"), tmp_path / "out"
    with pytest.raises(commands.typer.Exit):
        without_pyarrow(base, table, out, ProgrammeSettings())
    assert "Add --csv" in capsys.readouterr().err
    assert not out.exists()
    pd.DataFrame({"DampingRatio": [0.02]}).to_parquet(tmp_path / "table.parquet")
    wrong = without_pyarrow(base, tmp_path / "table.parquet", out, ProgrammeSettings(as_csv=True))
    assert wrong == 1
    assert "pyarrow is not installed. Give a CSV" in capsys.readouterr().err


@pytest.mark.slow
def test_a_process_without_pyarrow_writes_csv(base, tmp_path):
    csv(tmp_path, "DampingRatio", "0.02", "0.03")
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['pyarrow'] = None\n")
    words = ("batch", "base.json", "--vary", "table.csv", "--csv", "--out", "out", "--jobs", "1")
    variables = environment()
    paths = [str(tmp_path), variables.get("PYTHONPATH", "")]
    variables["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    done = subprocess.run(
        command(*words), cwd=tmp_path, env=variables, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "results.parquet needs pyarrow" in done.stderr
    assert len(pd.read_csv(tmp_path / "out" / "results.csv")) == 2


def test_ctrl_c_after_the_last_row_interrupts_nothing(base, tmp_path, monkeypatch, capsys):
    table, stop = csv(tmp_path, "DampingRatio", "0.01", "0.02"), Stop()

    class Last(Here):
        def answers(self, stopped):
            for one in super().answers(stopped):
                stop.asked = 1
                yield one

    status = commands._varied(base, table, tmp_path / "out", Last(), ProgrammeSettings(), stop)
    assert status == 0
    assert "Interrupted" not in capsys.readouterr().err
