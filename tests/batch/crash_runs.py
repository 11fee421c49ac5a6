"""kill -9 at random moments, again and again, and what must hold after each.

A batch is begun and killed at a random moment, resumed and killed again, until it comes to its end;
then a new one is begun, until it has been killed often enough. Killed are in turn the batch alone, all
its processes, and one of the processes that calculate (then the batch goes on by itself).

After every kill: each result that is there is whole and is that of the undisturbed run. At the end
of each batch: every result is there, and no sample was calculated that was recorded before.
"""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import time
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from batch_helpers import make_train, spoil
from command_line import command, environment

from addin.batch.folder import OWN
from addin.batch.journal import read_journal
from addin.contract.sheet import column_letters, column_number
from addin.contract.sheets import SHEETS
from addin.contract.tables import table


def _times(*tables: str) -> tuple[str, re.Pattern[bytes]]:
    """The sheet of tables with a column `Time`, and what its cells look like."""
    parts = [next(part for part in SHEETS if name in part.tables) for name in tables]
    columns = []
    for name, part in zip(tables, parts, strict=True):
        place = part.at(part.tables[name])
        number = [field.name for field in table(name).workbook_columns].index("Time")
        columns.append(column_letters(column_number(place.rstrip("0123456789")) + number))
    cells = rf'<c r="(?:{"|".join(columns)})\d+"[^>]*><v>[^<]*</v>'
    return parts[0].worksheet, re.compile(cells.encode())


#: Sheets with times of the very run in them, and what they look like.
TIMES = dict([_times("Effects", "AccuracyCost"), ("Audit", re.compile(rb"[\d.]+ ms"))])
#: Columns of the summary that may differ: of twins either may come first.
_FREE = ["Time [s]", "Same case as"]


@dataclass
class Record:
    """What happened in all.

    Parameters
    ----------
    kills, batches, checked, at_once : int
        Kills that hit a running batch; batches that came to their end; results compared after
        kills; batches that ended before they could be killed. [count]
    who : dict
        Kills by what was killed. [count]
    places : list of int
        Results in place at each kill. [count]
    """

    kills: int = 0
    batches: int = 0
    checked: int = 0
    at_once: int = 0
    who: dict[str, int] = field(default_factory=dict)
    places: list[int] = field(default_factory=list)


def make_folder(folder: Path, workbooks: int) -> Path:
    """A folder of different trains, a tenth of them twins of others, one in twenty with errors."""
    for number in range(workbooks):
        of = number - 1 if number % 10 == 9 else number
        example = "modified" if of % 2 else "proposed"
        path = make_train(folder / f"{number % 3}" / f"train {number}.xlsx", of, example=example)
        if number % 20 == 17:
            spoil(path)
    return folder


class Crashes:
    """Batches over one folder that are killed.

    Parameters
    ----------
    place : Path
        Where everything is made. [path]
    workbooks : int
        How many. [count]
    seed : int
        Of the random moments.
    tell : callable
        Told after each kill and each batch.
    """

    def __init__(
        self,
        place: Path,
        workbooks: int,
        seed: int,
        tell: Callable[[str], None] = lambda words: None,
    ) -> None:
        self.place = place
        self.tell = tell
        self.source = make_folder(place / "in", workbooks)
        self.random = random.Random(seed)
        self.record = Record()
        began = time.monotonic()
        process = self._begin("undisturbed", resume=False)
        assert process.wait(3600) == 1  # some have errors
        self.took = time.monotonic() - began
        self.expected = {
            path.relative_to(place / "undisturbed"): contents(path)
            for path in results(place / "undisturbed")
        }
        assert len(self.expected) > 0.9 * workbooks

    def run(self, kills: int) -> Record:
        """Kill so often, then let the last batch come to its end."""
        out = "out0"
        while self.record.kills < kills or (self.place / out).exists():
            resume = (self.place / out).exists()
            recorded = self._recorded(out)
            process = self._begin(out, resume=resume)
            if self.record.kills < kills and self._killed(process, out):
                self._check(out)
                continue
            assert process.wait(3600) == 1
            if self.record.kills < kills and not resume:
                self.record.at_once += 1
            self._ended(out, recorded)
            out = f"out{self.record.batches}"
        return self.record

    def _begin(self, out: str, *, resume: bool) -> subprocess.Popen[bytes]:
        words = ["batch", "in", "--out", out, *(["--resume"] if resume else [])]
        return subprocess.Popen(
            command(*words),
            cwd=self.place,
            env=environment() | {"SOURCE_DATE_EPOCH": "1700000000"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def _killed(self, process: subprocess.Popen[bytes], out: str) -> bool:
        """Wait for a random moment and kill; False if the batch came to its end."""
        until = time.monotonic() + self.random.uniform(0.0, self.took)
        while time.monotonic() < until and process.poll() is None:
            time.sleep(0.005)
        who = self.random.choice(["batch", "all", "one of its processes"])
        if who == "one of its processes":
            children = _children(process.pid)
            if process.poll() is None and children:
                os.kill(self.random.choice(children), signal.SIGKILL)
                self._count(who, out)
            # The batch itself goes on.
            assert process.wait(3600) in (1, -signal.SIGKILL)
            return False
        if process.poll() is not None:
            return False
        (os.killpg if who == "all" else os.kill)(process.pid, signal.SIGKILL)
        process.wait()
        self._count(who, out)
        return True

    def _count(self, who: str, out: str) -> None:
        self.record.kills += 1
        self.record.who[who] = self.record.who.get(who, 0) + 1
        self.record.places.append(len(list(results(self.place / out))))
        self.tell(
            f"kill {self.record.kills} ({who}) with {self.record.places[-1]} results in place"
        )

    def _check(self, out: str) -> None:
        """Each result that is there is whole and right."""
        for path in results(self.place / out):
            name = path.relative_to(self.place / out)
            assert contents(path) == self.expected[name], f"{name} differs after a kill"
            self.record.checked += 1

    def _recorded(self, out: str) -> dict[str, int]:
        """When each recorded result was written; those to be put in place yet are left out."""
        done = read_journal(self.place / out / OWN / "journal.jsonl")
        return {
            one.name: (self.place / out / one.outputs[0].name).stat().st_mtime_ns
            for one in done.values()
            if one.done and (self.place / out / one.outputs[0].name).is_file()
        }

    def _ended(self, out: str, recorded: dict[str, int]) -> None:
        folder = self.place / out
        found = {path.relative_to(folder) for path in results(folder)}
        assert found == set(self.expected)
        self._check(out)
        for name, written in recorded.items():
            assert (folder / name).stat().st_mtime_ns == written, f"{name} was written again"
        left = [p for p in folder.rglob("*") if "staging" in p.name or p.name.endswith(".tmp")]
        assert left == []
        pd.testing.assert_frame_equal(
            summary(folder).drop(columns=_FREE),
            summary(self.place / "undisturbed").drop(columns=_FREE),
        )
        self.record.batches += 1
        self.tell(f"batch {self.record.batches} is whole, as undisturbed")
        folder.rename(self.place / f"ended {self.record.batches}")


def results(folder: Path) -> Iterator[Path]:
    """Results in place."""
    for path in sorted(folder.rglob("*.xlsx")):
        if OWN not in path.parts and path.name != "summary.xlsx" and not path.name.startswith("."):
            yield path


def contents(path: Path) -> dict[str, int]:
    """Check sums of the parts of a workbook, times of the run taken out; a torn file raises."""
    found = {}
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        sheets = _sheets(archive.read("xl/workbook.xml"))
        for name in archive.namelist():
            data = archive.read(name)
            if name in sheets:
                data = TIMES[sheets[name]].sub(b"", data)
            found[name] = hash(data)
    return found


def _sheets(workbook: bytes) -> dict[str, str]:
    """Parts of the sheets with times; in our workbooks they are numbered in their order."""
    names = re.findall(rb'<sheet [^>]*?name="([^"]*)"', workbook)
    return {
        f"xl/worksheets/sheet{number}.xml": name.decode()
        for number, name in enumerate(names, start=1)
        if name.decode() in TIMES
    }


def summary(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "summary.csv", encoding="utf-8-sig")


def _children(pid: int) -> list[int]:
    """Processes that a batch has started to calculate."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            line = Path(f"/proc/{child}/cmdline").read_bytes()
            if b"spawn_main" in line:
                found.append(child)
    return found
