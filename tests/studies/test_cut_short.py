"""Ctrl-C in a study: what is calculated by then is told as a part, or nothing is written."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import jsonschema
import openpyxl
import pytest
from typer.testing import CliRunner

from addin.cli import study as studies_commands
from addin.cli.app import app
from addin.reading.case_json import case_to_json
from addin.reference.json_schemas import study_schema
from addin.studies.calibration import CALIBRATION
from addin.studies.run_study import StudyFiles, StudyOutcome, study_one
from addin.studies.sensitivities import SENSITIVITIES
from addin.studies.starts import STARTS
from addin.studies.study import Study
from addin.studies.tolerances import TOLERANCES
from addin.studies.tuning import TUNING
from addin.workers.opened_map import pool_map
from addin.workers.parallel_map import Cancelled, map_until_cancelled, serial_map
from addin.workers.stop import Stop
from tests.batch.batch_helpers import Here
from tests.dask_cluster import ROOT
from tests.opened import rows_of
from tests.sample_case import sample_case
from tests.trains import geared

RUN = CliRunner()
SCATTER = [
    {"quantity": "stiffness", "spread": "5 %", "together": "together"},
    {"quantity": "damping ratio", "distribution": "uniform", "spread": 0.3},
]
SAMPLED: dict[str, Any] = {"samples": 200, "seed": 2, "method": "lhs", "replan": False}


def after(units: int) -> Callable[[], bool]:
    """Ctrl-C before the unit of this number."""
    asked = iter([False] * units)
    return lambda: next(asked, True)


def written(folder: Path, case: Any, **tables: Any) -> Path:
    place = folder / "case.json"
    place.write_text(json.dumps(case_to_json(case) | tables), encoding="utf-8")
    return place


def workbook(folder: Path, case: Any, **tables: Any) -> Path:
    place = folder / "train.xlsx"
    words = ["new", str(place), "--studies", "--from", str(written(folder, case, **tables))]
    assert RUN.invoke(app, words).exit_code == 0
    return place


def studied(
    study: Study, source: Path, units: int, settings: dict[str, Any], *, in_place: bool = False
) -> tuple[StudyOutcome, dict[str, Any]]:
    place = source.with_name("part.json")
    done = study_one(
        study,
        source,
        serial_map(after(units)),
        settings,
        StudyFiles(json_file=place, in_place=in_place),
    )
    assert done.problems == ()
    found = json.loads(place.read_text(encoding="utf-8"))
    jsonschema.validate(found, study_schema(study.spec))
    return done, found


def said_in(path: Path, name: str) -> str:
    book = openpyxl.load_workbook(path)
    ((sheet, cell),) = book.defined_names[name].destinations
    return str(book[sheet][cell.replace("$", "")].value)


# --- tolerances -----------------------------------------------------------------------------------


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("method", ["lhs", "sobol"])
def test_a_part_of_a_sample_is_told_as_a_part(tmp_path: Path, method: str) -> None:
    source = workbook(tmp_path, sample_case("proposed"), scatter=SCATTER)
    settings = SAMPLED | {"method": method}
    done, found = studied(TOLERANCES, source, 3, settings, in_place=True)  # 4 runs, 50, 50
    planned = {"lhs": 200, "sobol": 256}[method]
    assert found["cut_short"] == {"calculated": 100, "planned": planned}
    assert found["tolerances"]["samples_calculated"] == 100
    assert found["tolerances"]["samples_planned"] == planned
    assert all(row["samples"] == 100 for row in found["tolerance_frequencies"])
    start = f"Cut short by Ctrl-C: 100 of {planned} samples"
    assert found["sentence"].startswith(start)
    assert said_in(source, "tolerances_Sentence").startswith(start)
    told = " ".join(done.warnings)
    assert ("An incomplete Latin hypercube is treated as" in told) == (method == "lhs")
    assert "conservative" not in told  # which holds of the whole sample only
    assert len(found["tolerance_tornado"]) == 2  # the runs of one factor at a time come first


@pytest.mark.slow
def test_a_part_holds_the_numbers_of_the_whole(tmp_path: Path) -> None:
    """The extremes of a part lie within those of the whole, whose first samples it is."""
    source = written(tmp_path, sample_case("proposed"), scatter=SCATTER)
    _, part = studied(TOLERANCES, source, 3, SAMPLED)
    _, whole = studied(TOLERANCES, source, 99, SAMPLED)
    assert "cut_short" not in whole
    assert part["tolerance_tornado"] == whole["tolerance_tornado"]
    assert part["study_sha256"] == whole["study_sha256"]
    for few, all_ in zip(
        part["tolerance_frequencies"], whole["tolerance_frequencies"], strict=True
    ):
        assert few["p_10"] == pytest.approx(all_["p_10"], rel=0.02)


def test_too_few_samples_are_no_result(tmp_path: Path) -> None:
    source = written(tmp_path, sample_case("proposed"), scatter=SCATTER)
    with pytest.raises(Cancelled) as ended:
        study_one(TOLERANCES, source, serial_map(after(1)), SAMPLED)
    assert (
        ended.value.why == "0 of 200 samples were calculated; fewer than 30 give no bound for P10."
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.json"]


# --- tune, starts ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_combinations_that_were_not_reached_are_named(tmp_path: Path) -> None:
    row = {"element": "High-speed shaft", "quantity": "stiffness", "unit": "%", "from": 50, "to": 150,
           "steps": 21}  # fmt: skip
    source = workbook(tmp_path, geared(), tuning=[row])
    done, found = studied(TUNING, source, 1, {}, in_place=True)  # eight of 21
    rows = found["tuning_results"]
    assert found["cut_short"] == {"calculated": 8, "planned": 21}
    assert [row.get("rank") for row in rows] == [*range(1, 9), *[None] * 13]
    assert {row["verdict"] for row in rows[8:]} == {"not calculated"}
    assert sum(row["as_is"] for row in rows[:8]) == 1  # calculated before all others
    assert len({row["combination"] for row in rows}) == 21
    start = (
        "Cut short by Ctrl-C: a better combination may be among those not calculated. Stopped: 8"
    )
    assert found["sentence"].startswith(start)
    assert len(found["sentence"]) < 420  # the line on the sheet shows no more
    shown = rows_of(source, "TuningResults")
    assert [row["Rank"] for row in shown] == [*range(1, 9), *[None] * 13]
    assert all("Not calculated" in str(row["Reason"]) for row in shown[8:])
    assert said_in(source, "tuning_Sentence").startswith("Cut short by Ctrl-C")
    assert done.result is not None


def test_kinds_of_start_that_were_not_reached_are_named(tmp_path: Path) -> None:
    kinds = [{"condition": f"kind {k}", "voltage": 1.0 + 0.01 * k, "per_year": 3} for k in range(4)]
    source = workbook(tmp_path, sample_case("proposed"), start_conditions=kinds)
    _, found = studied(STARTS, source, 2, {}, in_place=True)
    assert found["cut_short"] == {"calculated": 2, "planned": 4}
    outcomes = [row["outcome"] for row in found["start_matrix"]]
    assert "not calculated" not in outcomes[:2]
    assert outcomes[2:] == ["not calculated"] * 2
    assert found["verdict"] == "not judged"  # a duty of which a part is known says nothing
    assert found["sentence"].startswith("Cut short by Ctrl-C: 2 of 4 starts were calculated")
    assert [row["Outcome"] for row in rows_of(source, "StartMatrix")][2:] == ["not calculated"] * 2


@pytest.mark.parametrize(
    ("study", "tables"),
    [
        (TUNING, {"tuning": [{"element": "Motor", "quantity": "inertia", "unit": "%", "values": "90"}]}),
        (STARTS, {}),
        (SENSITIVITIES, {}),
        (CALIBRATION, {
            "measured_frequencies": [{"mode": 1, "frequency": 20}],
            "measured_peaks": [{"element": "LS coupling", "maximum_torque": 1e5}],
            "scatter": SCATTER,
        }),
    ],
)  # fmt: skip
def test_of_nothing_nothing_is_written(study: Study, tables: Any, tmp_path: Path) -> None:
    source = written(tmp_path, sample_case("proposed"), **tables)
    with pytest.raises(Cancelled):
        study_one(study, source, serial_map(lambda: True), {})
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.json"]


# --- how far it came ------------------------------------------------------------------------------


def double(number: int) -> int:
    return 2 * number


class OutOfOrder(Here):
    """Workers that answer the second task of each pair first."""

    threads = 4

    def answers(self, stopped: Callable[[], bool]) -> Any:
        waiting = list(self.waiting)
        order = [waiting[i ^ 1] for i in range(len(waiting) // 2 * 2)]
        for task in order:
            if stopped():
                return
            yield task, task.do(task.payload)


@pytest.mark.parametrize(
    ("answered", "told"), [(1, []), (2, [0, 2]), (3, [0, 2]), (4, [0, 2, 4, 6])]
)
def test_only_answers_before_the_first_that_is_missing_count(
    answered: int, told: Sequence[int]
) -> None:
    """Else what is quickly calculated would be told more often than what takes its time."""
    spread = pool_map(OutOfOrder(), after(answered))
    assert map_until_cancelled(spread, double, range(10), lambda n: None) == told


class Watched:
    """A command whose progress is read as on a terminal."""

    def __init__(self, *words: str) -> None:
        ours, theirs = os.openpty()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "addin.cli", *words],
            env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200", "TERM": "xterm"},
            stdout=subprocess.PIPE, stderr=theirs, text=True,
        )  # fmt: skip
        os.close(theirs)
        self._line = ours
        self.told = ""

    def until(self, pattern: str) -> None:
        """Wait for what is told; a study that ends without it fails the test."""
        while not re.search(pattern, self.told):
            more = self._more()
            assert more, self.told[-2000:]

    def _more(self) -> str:
        try:
            more = os.read(self._line, 65536).decode(errors="replace")
        except OSError:  # the other end is closed: so a terminal says it on Linux
            more = ""
        self.told += more
        return more

    def workers(self) -> list[int]:
        pid = self.process.pid
        # a child belongs to the thread that started it
        found = [
            n
            for file in Path(f"/proc/{pid}/task").glob("*/children")
            for n in file.read_text().split()
        ]
        return [int(n) for n in found if b"spawn_main" in Path(f"/proc/{n}/cmdline").read_bytes()]

    def ended(self) -> tuple[int, str]:
        """Its status and what it printed."""
        while self._more():
            pass
        os.close(self._line)
        assert self.process.stdout is not None
        said = self.process.stdout.read()
        return self.process.wait(60.0), said


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_on_the_command_line(times: int, tmp_path: Path) -> None:
    """Once writes the part that is there, twice gives up; both end with 130 and a sentence."""
    source, place = written(tmp_path, sample_case("proposed"), scatter=SCATTER), tmp_path / "t.json"
    study = Watched("tolerances", str(source), "--samples", "200000", "--jobs", "2",
                    "--json", str(place))  # fmt: skip
    study.until(r"[1-9]\d\d of 200,")
    if times == 2:
        workers = study.workers()
        assert len(workers) == 2
        for worker in workers:  # so that what runs does not end meanwhile
            os.kill(worker, signal.SIGSTOP)
    study.process.send_signal(signal.SIGINT)
    if times == 2:
        study.until(r"Stopping after |\(stopping\)")  # two at once are one
        study.process.send_signal(signal.SIGINT)
    status, said = study.ended()
    assert status == 130, said + study.told
    assert "Traceback" not in study.told
    if times == 1:
        assert "Cut short by Ctrl-C" in said
        assert json.loads(place.read_text())["cut_short"]["calculated"] >= 30
    else:
        assert "Nothing was written" in study.told
        assert not place.exists()


@pytest.mark.parametrize("stage", ["nominal run", "34 of 34 runs"])
def test_a_second_ctrl_c_gives_up_whatever_is_done(
    stage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the first unit, and after the last."""
    source = written(tmp_path, sample_case("proposed"), scatter=SCATTER)
    told: list[str] = []
    stop = Stop()

    def tell_and_interrupt(line: str) -> None:
        told.append(line.removeprefix("case.json: "))
        if told[-1] == stage:
            stop.asked = 2

    monkeypatch.setattr(studies_commands, "Stop", lambda: stop)
    monkeypatch.setattr(studies_commands, "progress", lambda: nullcontext(tell_and_interrupt))
    words = ["tolerances", str(source), "--samples", "30", "--jobs", "1", "--json",
             str(tmp_path / "t.json")]  # fmt: skip
    done = RUN.invoke(app, words)
    assert done.exit_code == 130, done.output
    assert stage in told
    assert sorted(p.name for p in tmp_path.iterdir()) == ["case.json"]
