"""Do two source trees give the same results, to the last bit?

    python scripts/compare_trees.py record TREE OUT --count 300 --jobs 2
    python scripts/compare_trees.py compare OLD NEW --report report.txt
    python scripts/compare_trees.py prove OLD

`record` runs the commands of a checkout (with its own .venv) on the shipped examples, the published
cases and random ones of every kind, and keeps every file they write; it goes on where it was when
started again. `compare` holds two records against each other: numbers by their digits (Python writes
the shortest decimal that gives back every bit), strings as they are. What may differ:

* times and the version, at the places listed in `TIMES` and `VERSIONS` below;
* sentences listed old → new in `scripts/compare_sentences.toml` and, one a line with {…} for what is put
  in, in `scripts/compare_sentences.tsv`: what is put in must be the same. Never in the fields of a problem
  other than its message;
* what follows from those sentences: heights of rows; widths of columns and the drawings of a report (look at
  them; the workbook's chart data, which are compared, hold the same numbers); where the prompt of a cell is
  cut to the 255 characters that Excel allows (sheet Notes has the same sentences whole); and the digests that
  a study keeps of its rows, texts included.

Texts that a workbook keeps in its list of shared strings are compared in the cells that show them.

`prove` changes one bit of one number in a record, a file at a time, and shows that `compare` fails.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import random
import re
import shutil
import struct
import subprocess
import sys
import threading
import time
import tomllib
import xml.etree.ElementTree as ET
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SENTENCES, TEMPLATES = HERE / "compare_sentences.toml", HERE / "compare_sentences.tsv"

#: Places that hold a time: keys of JSON files, with * for any number of a list; and
#: columns of workbook tables and CSV files. All other places must be equal.
TIMES_IN_JSON = (
    "effects.*.time",  # what an effect cost, measured
    "accuracy_cost.*.time",
)
TIMES_IN_TABLES = (
    ("Effects", "Time"),
    ("AccuracyCost", "Time"),
    # what the chart of sheet Effects and accuracy draws, in the order of the times; its cached values too
    ("ChartAccuracy", "* time"),
    ("ChartAccuracy", "* peak"),
    ("ChartAccuracy", "* starts"),
)
#: Columns of sheets without tables: file, part, column.
TIMES_IN_CELLS = (("out/summary.xlsx", "xl/worksheets/sheet1.xml", "AB"),)  # Time of a batch
#: Sentences that name a time that was measured, by their beginning; the rest of them is compared.
TIMES_IN_SENTENCES = ("You asked for ", "Wanted accuracy of ")
#: Files of a batch that hold nothing but when and by which process it ran.
NOT_COMPARED = ("out/.torsionbook-batch/*",)
#: Columns of CSV files that hold a time that was measured.
TIMES_IN_CSV = ("Time [s]",)
#: Rows of the audit whose value is a time: by the beginning of their item.
TIMES_IN_AUDIT = ("Time spent: ",)
#: Keys of JSON files that hold the version.
VERSIONS_IN_JSON = ("version", "made_by", "verified_by")
#: The version in any other string.
VERSION = re.compile(r"\btorsionbook \d+\.\d+\.\d+[\w.+]*")
#: A date with its time in any string, and a duration in `TIMES_IN_SENTENCES`.
DATE = re.compile(r"\b\d{4}-\d\d-\d\d[ T]\d\d:\d\d(?::\d\d)?Z?")
DURATION = re.compile(r"[\d.,]+ (?:ms|s|min|h)\b")
#: Digests of the rows of a study, which hold sentences too.
_HEX = re.compile(r"\b[0-9a-f]{12}\b")
DIGESTS = re.compile(r"(?:\w+ [0-9a-f]{12}(?:; |$))+")
#: Fields of a problem that no sentence may change.
PROBLEM_FIELDS = ("sheet", "table", "row", "column", "found", "allowed")

#: Differences that a report lists.
LISTED = 50
#: A longer prompt is cut to this. [characters]
LONGEST_PROMPT = 255


# --- record ---------------------------------------------------------------------------------------


def tasks(out: Path, tree: Path, kinds: Sequence[str], count: int) -> Iterator[dict[str, Any]]:
    """Every job of a record, the quick ones first; case files are written into the record."""
    sys.path.insert(0, str(HERE))
    import compare_cases

    cases = out / "cases"

    def written(name: str, case: Mapping[str, Any]) -> str:
        place = cases / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(json.dumps(case, indent=1) + "\n", encoding="utf-8")
        return str(place.resolve())

    random_kinds = [kind for kind in kinds if kind in compare_cases.KINDS]
    if "published" in kinds:
        published = HERE.parent / "tests" / "validation" / "cases"
        for name, case in compare_cases.published_cases(published):
            place = written(f"published/{name}.json", case)
            yield from _case_jobs(f"published/{name}", place)
    if "examples" in kinds:
        yield from _example_jobs(tree)
    workbooks = []
    for number in range(count):
        for kind in random_kinds:
            name = f"{kind}/{number:04d}"
            place = written(f"{name}.json", compare_cases.random_case(kind, number))
            if kind == "studies":
                yield _study_job(name, place, compare_cases.study_command(number))
            else:
                plain, through_workbook = _case_jobs(name, place)
                yield plain
                workbooks.append(through_workbook)
    yield from workbooks
    if "batch" in kinds and random_kinds:
        yield _batch_job(
            [cases / kind / f"{n:04d}.json" for kind in random_kinds[:5] for n in (0, 1)]
        )


def _case_jobs(name: str, place: str) -> Iterator[dict[str, Any]]:
    """A case through JSON, and through a workbook in units of either system."""
    yield {
        "name": f"{name} json",
        "inputs": {"case.json": place},
        "commands": [["recalc", "case.json", "--json", "results.json"]],
    }
    units = "us" if sum(name.encode()) % 2 else "si"
    yield {
        "name": f"{name} workbook",
        "inputs": {"case.json": place},
        "commands": [
            ["new", "case.xlsx", "--from", "case.json", "--units", units],
            ["recalc", "case.xlsx", "--json", "workbook.results.json"],
        ],
        "leave": ["case.xlsx"],  # its inputs stand in the result too
    }


def _study_job(name: str, place: str, command: str) -> dict[str, Any]:
    extra = ["--samples", "30"] if command == "tolerances" else []
    extra += ["--case", "calibrated.json"] if command == "calibrate" else []
    return {
        "name": f"{name} {command}",
        "inputs": {"case.json": place},
        "commands": [
            ["check", "case.json"],
            [command, "case.json", "--json", f"{command}.json", "--jobs", "1", *extra],
        ],
    }


def _batch_job(places: Sequence[Path]) -> dict[str, Any]:
    names = [f"in/{place.parent.name}-{place.name}" for place in places]
    return {
        "name": "batch",
        "inputs": {n: str(p.resolve()) for n, p in zip(names, places, strict=True)},
        "commands": [["batch", "in", "--out", "out", "--jobs", "1"]],
    }


def _example_jobs(tree: Path) -> Iterator[dict[str, Any]]:
    """Shipped files as they are, then every command on the examples."""
    shipped = sorted((tree / "templates").glob("*.xls*"))
    yield {
        "name": "templates",
        "inputs": {},
        "commands": [],
        "copies": {path.name: str(path) for path in shipped},
    }
    schemas = sorted(
        p for room in ("addin", "engine") for p in (tree / room).rglob("*.schema.json")
    )
    yield {
        "name": "schemas",
        "inputs": {},
        "commands": [],
        "copies": {path.name: str(path) for path in schemas},
    }
    for flavour, ending in (
        ("files", "xlsx"),
        ("excel", "xlsm"),
        ("server", "xlsx"),
        ("calc", "xlsx"),
    ):
        for what in ("us", "si", "proposed", "modified", "backlash"):
            chosen = ["--units", what] if what in ("us", "si") else ["--example", what]
            for studies in ([], ["--studies"]):
                name = f"new {flavour} {what}{' studies' if studies else ''}"
                command = ["new", f"new.{ending}", "--for", flavour, *chosen, *studies]
                yield {"name": name, "inputs": {}, "commands": [command]}
    for path in shipped:
        if not path.name.startswith("example_"):
            continue
        name = path.stem
        source = {"example.xlsx": str(path)}
        yield {
            "name": f"{name} recalc",
            "inputs": source,
            "commands": [
                ["check", "example.xlsx"],
                ["export", "example.xlsx", "case.json"],
                ["recalc", "example.xlsx", "--json", "results.json"],
                ["recalc", "example.out.xlsx", "--out", "again"],
                ["recalc", "case.json", "--json", "case.results.json"],
                ["verify", "example.out.xlsx", "--json", "verify.json", "--within", "bits"],
                ["verify", "results.json", "--case", "case.json", "--json", "verify-json.json"],
                ["diff", "example.xlsx", "example.out.xlsx", "--json", "diff.json"],
            ],
        }
        yield {
            "name": f"{name} newmark",
            "inputs": source,
            "commands": [
                ["recalc", "example.xlsx", "--json", "results.json", "--method", "newmark",
                 "--tolerance", "1%"],
            ],
        }  # fmt: skip
        yield {
            "name": f"{name} report",
            "inputs": source,
            "commands": [["report", "example.xlsx", "--docx", "report.docx"]],
        }
        yield {
            "name": f"{name} accuracy",
            "inputs": source,
            "commands": [["accuracy", "example.xlsx", "--quick", "--json", "accuracy.json"]],
        }
    proposed = next((path for path in shipped if path.stem == "example_proposed"), None)
    modified = next((path for path in shipped if path.stem == "example_modified"), None)
    if proposed and modified:
        yield {
            "name": "example diff",
            "inputs": {"a.xlsx": str(proposed), "b.xlsx": str(modified)},
            "commands": [
                ["diff", "a.xlsx", "b.xlsx", "--json", "diff.json", "--xlsx", "diff.xlsx"]
            ],
        }
    studied = next((path for path in shipped if path.stem == "example_studies"), None)
    for command in ("tune", "tolerances", "sensitivities", "starts", "calibrate"):
        if studied is None:
            break
        yield _example_study(command, studied)


def _example_study(command: str, studied: Path) -> dict[str, Any]:
    arguments = [command, "example.xlsx", "--json", f"{command}.json", "--jobs", "1"]
    if command == "tolerances":
        arguments += ["--samples", "100"]
    if command == "calibrate":
        arguments += ["--case", "calibrated.json"]
    return {
        "name": f"example {command}",
        "inputs": {"example.xlsx": str(studied)},
        "commands": [arguments],
    }


def record(tree: Path, out: Path, kinds: Sequence[str], count: int, jobs: int) -> None:
    """Run every job that the record does not hold yet."""
    tree, out = tree.resolve(), out.resolve()
    (out / "jobs").mkdir(parents=True, exist_ok=True)
    (out / "record.json").write_text(
        json.dumps({"tree": _commit(tree), "kinds": list(kinds), "count": count}) + "\n"
    )
    waiting: queue.Queue[dict[str, Any]] = queue.Queue()
    for task in tasks(out, tree, kinds, count):
        if not _place(out, task["name"]).exists():
            waiting.put(task)
    _warm_up(tree, out)
    total, began = waiting.qsize(), time.monotonic()
    print(f"{total} jobs to do", flush=True)
    workers = [
        threading.Thread(target=_work, args=(tree, out, number, waiting, total, began))
        for number in range(jobs)
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    missing = sum(1 for t in tasks(out, tree, kinds, count) if not _place(out, t["name"]).exists())
    print(f"{missing} jobs gave no answer; {time.monotonic() - began:.0f} s", flush=True)
    if missing:
        raise SystemExit(1)


def _commit(tree: Path) -> str:
    done = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=tree, capture_output=True, text=True
    )
    return done.stdout.strip() or "unknown"


def _place(out: Path, name: str) -> Path:
    return out / "jobs" / f"{name.replace('/', ' ')}.json"


def _started(tree: Path, out: Path, work: Path) -> subprocess.Popen[str]:
    """The driver, run by the Python of a tree."""
    # a fixed date and width, one thread: what else the environment could change
    environment = {
        **{k: v for k, v in os.environ.items() if not k.startswith(("TORSIONBOOK", "PYTHON"))},
        "SOURCE_DATE_EPOCH": "1700000000",
        "COLUMNS": "120",
        "PYTHONHASHSEED": "0",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "MKL_NUM_THREADS": "1",
    }
    python = next(
        p for p in (tree / ".venv/bin/python", tree / ".venv/Scripts/python.exe") if p.exists()
    )
    return subprocess.Popen(
        [str(python), str(HERE / "compare_driver.py"), str(work), str(out / "blobs")],
        cwd=tree,
        env=environment,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )


def _warm_up(tree: Path, out: Path) -> None:
    """Have the loops compiled before anything is recorded: a run that compiles says so in its audit."""
    sys.path.insert(0, str(HERE))
    import compare_cases

    work = out / "work" / f"{os.getpid()}-warm"
    work.mkdir(parents=True, exist_ok=True)
    commands = []
    for kind in ("plain", "clearances", "pull-in"):
        case = json.dumps(compare_cases.random_case(kind, 0))
        (work / f"{kind}.json").write_text(case, encoding="utf-8")
        commands += [["recalc", f"{kind}.json", "--method", m] for m in ("exponential", "newmark")]
    inputs = {path.name: str(path) for path in work.glob("*.json")}
    task = {"name": "warm-up", "inputs": inputs, "commands": commands}
    _started(tree, out, work).communicate(json.dumps(task) + "\n")
    shutil.rmtree(work, ignore_errors=True)


def _work(
    tree: Path,
    out: Path,
    number: int,
    waiting: queue.Queue[dict[str, Any]],
    total: int,
    began: float,
) -> None:
    """One process of the tree, given a job at a time; begun anew where it died."""
    work = out / "work" / f"{os.getpid()}-{number}"
    work.mkdir(parents=True, exist_ok=True)
    driver: subprocess.Popen[str] | None = None
    while True:
        try:
            task = waiting.get_nowait()
        except queue.Empty:
            break
        if "copies" in task:
            answer = json.dumps(_copied(task, out))
        else:
            if driver is None or driver.poll() is not None:
                driver = _started(tree, out, work)
            assert driver.stdin is not None
            assert driver.stdout is not None
            driver.stdin.write(json.dumps(task) + "\n")
            driver.stdin.flush()
            answer = driver.stdout.readline()
            if not answer:
                print(f"no answer: {task['name']}", flush=True)
                continue
        partial = _place(out, task["name"]).with_suffix(".part")
        partial.write_text(answer, encoding="utf-8")
        partial.replace(_place(out, task["name"]))
        done = total - waiting.qsize()
        if done % 50 == 0:
            print(f"{done} of {total}, {time.monotonic() - began:.0f} s", flush=True)
    if driver is not None:
        assert driver.stdin is not None
        driver.stdin.close()
        driver.wait()
    shutil.rmtree(work, ignore_errors=True)


def _copied(task: Mapping[str, Any], out: Path) -> dict[str, Any]:
    """Files of the tree itself, recorded as they are."""
    sys.path.insert(0, str(HERE))
    import compare_driver

    files = {
        name: compare_driver.recorded(Path(path), out / "blobs")
        for name, path in task["copies"].items()
    }
    return {"name": task["name"], "commands": [], "statuses": [], "inputs": {}, "files": files}


# --- what may differ ------------------------------------------------------------------------------


@dataclass
class Entry:
    """One line of the list of sentences, and how often it was used."""

    kind: str
    old: str
    new: str
    optional: bool = False
    used: int = 0


class Template:
    """A sentence with {…} for what is put in, wherever it stands in a longer string."""

    def __init__(self, entry: Entry) -> None:
        fixed = entry.old.split("{…}")
        self.entry = entry
        self._begin = max(fixed, key=len)
        self._old = re.compile("(.+?)".join(re.escape(text) for text in fixed), re.DOTALL)
        self._new = entry.new.split("{…}")

    def apply(self, text: str) -> str:
        """The text with the new sentence, what is put in unchanged."""
        return self._old.sub(self._filled, text) if self._begin in text else text

    def _filled(self, match: re.Match[str]) -> str:
        groups = (*match.groups(), "")
        return "".join(text + group for text, group in zip(self._new, groups, strict=True))


class Sentences:
    """The list old → new."""

    def __init__(
        self, content: Mapping[str, Any], templates: Iterable[tuple[str, str]] = ()
    ) -> None:
        self.entries = [
            Entry(kind, row["old"], row["new"], bool(row.get("optional")))
            for kind in ("string", "pattern", "part")
            for row in content.get(kind, ())
        ]
        self._whole = {(e.old, e.new): e for e in self.entries if e.kind == "string"}
        self._patterns = [
            (re.compile(e.old, re.DOTALL), e) for e in self.entries if e.kind == "pattern"
        ]
        self._parts = [e for e in self.entries if e.kind == "part"]
        # The longest first, so that a part of a sentence does not take the words of the whole.
        made = [Entry("template", old, new, optional=True) for old, new in templates]
        self._templates = [Template(e) for e in sorted(made, key=lambda e: -len(e.old))]
        self.entries += made
        self._allowed: dict[tuple[str, str], list[Entry]] = {}

    def allow(self, old: str, new: str) -> bool:
        """Whether the list explains that `old` became `new`; counted if so."""
        entry = self._whole.get((old, new))
        if entry is not None:
            entry.used += 1
            return True
        for pattern, entry in self._patterns:
            match = pattern.fullmatch(old)
            if match and match.expand(entry.new) == new:
                entry.used += 1
                return True
        replaced, used = old, []
        for entry in self._parts:
            if entry.old in replaced:
                replaced = replaced.replace(entry.old, entry.new)
                used.append(entry)
        if not (used and replaced == new):
            used = self._by_templates(old, new)
        if not used and "\n" in old:
            lines = list(zip(old.split("\n"), new.split("\n"), strict=False))
            same = old.count("\n") == new.count("\n")
            return same and all(a == b or self.allow(a, b) for a, b in lines)
        for entry in used:
            entry.used += 1
        return bool(used)

    def _by_templates(self, old: str, new: str) -> list[Entry]:
        """The templates that make the new string of the old one, none if they do not."""
        if (old, new) not in self._allowed:
            replaced, used = old, []
            for template in self._templates:
                if template.apply(old) == new:
                    self._allowed[old, new] = [template.entry]
                    return self._allowed[old, new]
            for template in self._templates:
                changed = template.apply(replaced)
                if changed != replaced:
                    used.append(template.entry)
                replaced = changed
            for entry in self._parts:
                if entry.old in replaced:
                    replaced = replaced.replace(entry.old, entry.new)
                    used.append(entry)
            self._allowed[old, new] = used if replaced == new else []
        return self._allowed[old, new]

    @property
    def unused(self) -> list[Entry]:
        """Entries that nothing needed."""
        return [e for e in self.entries if not e.used and not e.optional]


# --- compare --------------------------------------------------------------------------------------


@dataclass
class Comparison:
    """Counts and differences of two records."""

    sentences: Sentences
    counts: Counter[str] = field(default_factory=Counter)
    aside: Counter[str] = field(default_factory=Counter)
    differences: list[str] = field(default_factory=list)

    def differs(self, where: str, old: object, new: object) -> None:
        """Note a difference."""
        self.differences.append(f"{where}: {_short(old)} → {_short(new)}")

    def string(self, where: str, old: str, new: str, strict: bool = False) -> None:
        """Compare two strings that are not the same."""
        if VERSION.sub("torsionbook", old) == VERSION.sub("torsionbook", new):
            self.aside["version"] += 1
        elif DATE.sub("date", VERSION.sub("", old)) == DATE.sub("date", VERSION.sub("", new)):
            self.aside["date"] += 1
        elif old.startswith(TIMES_IN_SENTENCES) and self._same_but_durations(old, new, strict):
            self.aside["time"] += 1
        elif strict or not self.sentences.allow(old, new):
            if where.endswith("attribute prompt") and LONGEST_PROMPT in (len(old), len(new)):
                self.aside["cut prompt"] += 1
            elif DIGESTS.fullmatch(old) and _HEX.sub("", old) == _HEX.sub("", new):
                self.aside["digest of the rows of a study"] += 1
            else:
                self.differs(where, old, new)

    def _same_but_durations(self, old: str, new: str, strict: bool) -> bool:
        old, new = DURATION.sub("(time)", old), DURATION.sub("(time)", new)
        return old == new or (not strict and self.sentences.allow(old, new))


def _short(value: object, longest: int = 200) -> str:
    text = repr(value) if not isinstance(value, str) else value
    return text if len(text) <= longest else f"{text[:longest]}… ({len(text)} characters)"


@dataclass(frozen=True)
class Number:
    """A number of a JSON file by its digits."""

    digits: str


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Place and value of everything in a JSON file, in its order."""
    if isinstance(value, dict):
        yield path, "{"
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        yield path, "["
        for i, item in enumerate(value):
            yield from leaves(item, f"{path}.{i}" if path else str(i))
    else:
        yield path, value


def _read_json(content: bytes) -> Any:
    return json.loads(content, parse_float=Number, parse_int=Number, parse_constant=Number)


def _is_time(path: str, siblings: Mapping[str, Any]) -> bool:
    if any(fnmatchcase(path, pattern) for pattern in TIMES_IN_JSON):
        return True
    if not re.fullmatch(r"audit\.\d+\.value", path):
        return False
    item = siblings.get(path.replace(".value", ".item"))
    return isinstance(item, str) and item.startswith(TIMES_IN_AUDIT)


def compare_json(where: str, old: bytes, new: bytes, found: Comparison) -> None:
    """Two JSON files: the same keys in the same order, the same digits, strings by the list."""
    before, after = list(leaves(_read_json(old))), list(leaves(_read_json(new)))
    if [path for path, _ in before] != [path for path, _ in after]:
        first = next(
            (pair for pair in zip(before, after, strict=False) if pair[0][0] != pair[1][0]),
            (before[-1], after[-1]),
        )
        found.differs(f"{where}, keys", first[0][0], first[1][0])
        return
    siblings = dict(before)
    for (path, a), (_, b) in zip(before, after, strict=True):
        found.counts["numbers" if isinstance(a, Number) else "strings"] += 1
        if _is_time(path, siblings):
            found.aside["time"] += 1
            if isinstance(a, Number) != isinstance(b, Number):
                found.differs(f"{where}, {path}", a, b)
        elif a != b or type(a) is not type(b):
            key = path.rpartition(".")[2]
            if path in VERSIONS_IN_JSON:
                found.aside["version"] += 1
            elif isinstance(a, str) and isinstance(b, str):
                problem = re.fullmatch(r"(?:.*\.)?errors\.\d+\.\w+", path) is not None
                found.string(f"{where}, {path}", a, b, strict=problem and key in PROBLEM_FIELDS)
            else:
                shown = [v.digits if isinstance(v, Number) else v for v in (a, b)]
                found.differs(f"{where}, {path}", *shown)


_SHARED = re.compile(r'(<c [^>]*\bt="s"[^>]*>)<v>(\d+)</v>')
_STRINGS = "xl/sharedStrings.xml"
_ITEM = re.compile(r"<si>(.*?)</si>|<si/>", re.DOTALL)


def with_shared_strings(sheet: str, strings: Sequence[str]) -> str:
    """A sheet with the shared strings in its cells in place of their numbers."""
    return _SHARED.sub(lambda m: f"{m[1]}<v>{strings[int(m[2])]}</v>", sheet)


def shared_strings(part: str) -> list[str]:
    """The strings of a workbook, each with its marks of fonts."""
    return _ITEM.findall(part.replace(' xml:space="preserve"', ""))


_TOKEN = re.compile(r"<[^>]*>|[^<]+")
_HEIGHT = re.compile(r' (?:ht|customHeight)="[^"]*"')
_WIDTHS, _WIDTH = ("<w:gridCol ", "<w:tcW "), re.compile(r' w:w="\d+"')
_ATTRIBUTE = re.compile(r"""([\w:.-]+)\s*=\s*("[^"]*"|'[^']*')""")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


def compare_xml(
    where: str, old: str, new: str, times: Mapping[int, str], found: Comparison
) -> None:
    """Two XML parts: the same tags, attributes and texts; `times` are the texts set aside, by position."""
    before, after = _TOKEN.findall(old), _TOKEN.findall(new)
    for at, (a, b) in enumerate(zip(before, after, strict=False)):
        if a.startswith("<") != b.startswith("<"):
            found.differs(
                f"{where}, structure", "".join(before[at : at + 4]), "".join(after[at : at + 4])
            )
            return
        if a.startswith("<"):
            found.counts["tags"] += 1
            if a != b:
                _compare_tags(where, a, b, found)
            continue
        is_number = _NUMBER.fullmatch(a) is not None
        found.counts["numbers" if is_number else "strings"] += 1
        if at in times:
            found.aside["time"] += 1
        elif a != b:
            place = _cell_before(before, at)
            if is_number or _NUMBER.fullmatch(b):
                found.differs(f"{where}{place}", a, b)
            else:
                found.string(f"{where}{place}", _unescaped(a), _unescaped(b))
    if len(before) != len(after):
        found.differs(f"{where}, number of tokens", len(before), len(after))


def _compare_tags(where: str, old: str, new: str, found: Comparison) -> None:
    """Two tags that are not the same: the same name and attributes, strings in them by the list."""
    if old.startswith("<row ") and _HEIGHT.sub("", old) == _HEIGHT.sub("", new):
        found.aside["height of a row"] += 1
        return
    if old.startswith(_WIDTHS) and _WIDTH.sub("", old) == _WIDTH.sub("", new):
        found.aside["width of a column of a report"] += 1
        return
    rest = [_ATTRIBUTE.sub(lambda m: m[1], tag) for tag in (old, new)]
    if rest[0] != rest[1]:
        found.differs(f"{where}, tag", old, new)
        return
    pairs = zip(_ATTRIBUTE.findall(old), _ATTRIBUTE.findall(new), strict=True)
    for (name, a), (_, b) in pairs:
        if a == b:
            continue
        if _NUMBER.fullmatch(a[1:-1]) or _NUMBER.fullmatch(b[1:-1]):
            found.differs(f"{where}, attribute {name} of {_short(old, 60)}", a, b)
        else:
            found.string(f"{where}, attribute {name}", _unescaped(a[1:-1]), _unescaped(b[1:-1]))


def _unescaped(text: str) -> str:
    for code, sign in (("&lt;", "<"), ("&gt;", ">"), ("&quot;", '"'), ("&apos;", "'")):
        text = text.replace(code, sign)
    return text.replace("&#10;", "\n").replace("&#xA;", "\n").replace("&amp;", "&")


def _cell_before(tokens: Sequence[str], at: int) -> str:
    for token in reversed(tokens[max(0, at - 12) : at]):
        match = re.match(r'<c r="([A-Z]+\d+)"', token)
        if match:
            return f" {match[1]}"
    return ""


# --- times in workbooks -----------------------------------------------------------------------------

_MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
_RELATION = "{http://schemas.openxmlformats.org/package/2006/relationships}"


def _cells_of_times(parts: Mapping[str, str]) -> dict[str, set[str]]:
    """Cells of each sheet part that hold a time, by the tables of the workbook."""
    cells: dict[str, set[str]] = {}
    for sheet in [name for name in parts if re.fullmatch(r"xl/worksheets/[^/]+\.xml", name)]:
        relations = sheet.replace("worksheets/", "worksheets/_rels/") + ".rels"
        if relations not in parts:
            continue
        for relation in ET.fromstring(parts[relations].encode()).iter(f"{_RELATION}Relationship"):
            target = relation.get("Target", "")
            part = "xl" + target[2:] if target.startswith("../") else target.lstrip("/")
            if "/tables/" in part and part in parts:
                cells.setdefault(sheet, set()).update(_times_of_table(parts[part], parts[sheet]))
    return cells


def _times_of_table(table: str, sheet: str) -> Iterator[str]:
    root = ET.fromstring(table.encode())
    name = root.get("name") or ""
    match = re.fullmatch(r"([A-Z]+)(\d+):([A-Z]+)(\d+)", root.get("ref") or "")
    if match is None:
        return
    first, top, bottom = _column(match[1]), int(match[2]), int(match[4])
    columns = [c.get("name") or "" for c in root.iter(f"{_MAIN}tableColumn")]
    for at, column in enumerate(columns):
        if any(name == table_ and fnmatchcase(column, like) for table_, like in TIMES_IN_TABLES):
            yield from (f"{_letters(first + at)}{row}" for row in range(top + 1, bottom + 1))
    if name == "Audit":
        items = dict(_inline_texts(sheet))
        for row in range(top + 1, bottom + 1):
            if items.get(f"{_letters(first)}{row}", "").startswith(TIMES_IN_AUDIT):
                yield f"{_letters(first + 1)}{row}"


def _inline_texts(sheet: str) -> Iterator[tuple[str, str]]:
    for match in re.finditer(
        r'<c r="([A-Z]+\d+)"[^>]*t="inlineStr"[^>]*><is><t[^>]*>([^<]*)', sheet
    ):
        yield match[1], match[2]


def _column(letters: str) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - 64
    return number


def _letters(number: int) -> str:
    letters = ""
    while number:
        number, rest = divmod(number - 1, 26)
        letters = chr(65 + rest) + letters
    return letters


def _by_sheet_name(parts: Mapping[str, str], cells: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """All cells that hold a time as charts refer to them, such as ``Sheet!$A$5``, under no name."""
    if "xl/workbook.xml" not in parts or "xl/_rels/workbook.xml.rels" not in parts:
        return {}
    targets = {
        relation.get("Id"): f"xl/{relation.get('Target')}"
        for relation in ET.fromstring(parts["xl/_rels/workbook.xml.rels"].encode())
    }
    found = set()
    for sheet in ET.fromstring(parts["xl/workbook.xml"].encode()).iter(f"{_MAIN}sheet"):
        identifier = next((v for k, v in sheet.attrib.items() if k.endswith("}id")), None)
        for cell in cells.get(targets.get(identifier, ""), ()):
            match = re.fullmatch(r"([A-Z]+)(\d+)", cell)
            assert match is not None
            found.add(f"{sheet.get('name')}!${match[1]}${match[2]}")
    return {"": found}


def _positions_in_chart(chart: str, cells: Iterable[str]) -> dict[int, str]:
    """Positions among the tokens of a chart of the values it keeps of some cells."""
    wanted, after_formula, inside, positions = set(cells), False, False, {}
    for at, token in enumerate(_TOKEN.findall(chart)):
        if token == "<c:f>":
            after_formula = True
        elif after_formula:
            inside, after_formula = token.partition(":")[0] in wanted, False
        elif token in ("</c:numRef>", "</c:strRef>"):
            inside = False
        elif inside and not token.startswith("<"):
            positions[at] = token
    return positions


def _positions(sheet: str, cells: Iterable[str]) -> dict[int, str]:
    """Positions among the tokens of a sheet of the texts of some cells."""
    wanted, here, positions = set(cells), "", {}
    for at, token in enumerate(_TOKEN.findall(sheet)):
        match = re.match(r'<c r="([A-Z]+\d+)"', token)
        if match:
            here = match[1]
        elif token == "</c>":
            here = ""
        elif not token.startswith("<") and here in wanted:
            positions[at] = here
    return positions


# --- files and jobs ---------------------------------------------------------------------------------


class Record:
    """A record on the disk."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.jobs = {
            job["name"]: job
            for job in (json.loads(p.read_text("utf-8")) for p in (folder / "jobs").glob("*.json"))
        }

    def content(self, digest: str) -> bytes:
        """What lies under a digest."""
        return zlib.decompress((self.folder / "blobs" / digest[:2] / digest[2:]).read_bytes())


def compare(old: Record, new: Record, sentences: Sentences) -> Comparison:
    """Two records; jobs that only one of them holds are a difference."""
    found = Comparison(sentences)
    for name in sorted(old.jobs.keys() ^ new.jobs.keys()):
        found.differs(f"job {name}", name in old.jobs, name in new.jobs)
    counted: dict[str, Counter[str]] = {}
    for name in sorted(old.jobs.keys() & new.jobs.keys()):
        a, b = old.jobs[name], new.jobs[name]
        found.counts["jobs"] += 1
        for what in ("commands", "statuses"):
            if a[what] != b[what]:
                found.differs(f"{name}, {what}", a[what], b[what])
        if name not in ("templates", "schemas"):
            for file in sorted(a["inputs"].keys() | b["inputs"].keys()):
                if file.endswith(".json") and a["inputs"].get(file) != b["inputs"].get(file):
                    found.differs(f"{name}, input {file}", a["inputs"], b["inputs"])
        for file in sorted(a["files"].keys() | b["files"].keys()):
            if any(fnmatchcase(file, pattern) for pattern in NOT_COMPARED):
                continue
            if file not in a["files"] or file not in b["files"]:
                found.differs(f"{name}, file {file}", file in a["files"], file in b["files"])
                continue
            found.counts["files"] += 1
            _compare_files(
                f"{name}, {file}", a["files"][file], b["files"][file], old, new, found, counted
            )
    return found


def _compare_files(
    where: str,
    a: Any,
    b: Any,
    old: Record,
    new: Record,
    found: Comparison,
    counted: dict[str, Counter[str]],
) -> None:
    """One file, or the members of an archive."""
    if isinstance(a, str):
        _compare_content(where, a, b, old, new, found, counted, set())
        return
    before, after = dict(a), dict(b)
    if [part for part, _ in a] != [part for part, _ in b]:
        found.differs(
            f"{where}, parts",
            sorted(before.keys() - after.keys()),
            sorted(after.keys() - before.keys()),
        )
    strings = [
        shared_strings(record_.content(parts[_STRINGS]).decode()) if _STRINGS in parts else []
        for record_, parts in ((old, before), (new, after))
    ]
    before.pop(_STRINGS, None)
    after.pop(_STRINGS, None)
    changed = [part for part in before.keys() & after.keys() if before[part] != after[part]]
    needed = r"xl/(worksheets|tables|_rels)/.*|xl/workbook\.xml"
    cells: list[dict[str, set[str]]] = [{}, {}]
    if any(part.startswith(("xl/worksheets/", "xl/charts/")) for part in changed):
        for which, (record_, parts) in enumerate(((old, before), (new, after))):
            texts = {
                part: record_.content(digest).decode("utf-8", "replace")
                for part, digest in parts.items()
                if re.match(needed, part)
            }
            cells[which] = _cells_of_times(texts)
            for file, part, column in TIMES_IN_CELLS:
                if where.endswith(f", {file}") and part in texts:
                    cells[which][part] = set(re.findall(rf'<c r="({column}\d+)"', texts[part]))
            cells[which] |= _by_sheet_name(texts, cells[which])
    for part in sorted(before.keys() & after.keys()):
        found.counts["parts"] += 1
        same = cells[0].get(part, set()) & cells[1].get(part, set())
        if part.startswith("xl/charts/"):  # their cells by the name of the sheet
            same = {cell for cell in cells[0].get("", set()) if cell in cells[1].get("", set())}
        _compare_content(
            f"{where}!{part}", before[part], after[part], old, new, found, counted, same, strings
        )


def _compare_content(
    where: str,
    a: str,
    b: str,
    old: Record,
    new: Record,
    found: Comparison,
    counted: dict[str, Counter[str]],
    times: set[str],
    strings: Sequence[Sequence[str]] = ((), ()),
) -> None:
    """Two contents by their digests; `times` are the cells of a sheet that hold a time."""
    name = where.rpartition("!")[2].rpartition(", ")[2]
    sheet = name.startswith("xl/worksheets/")
    if a == b and (not sheet or strings[0] == strings[1]):
        if a not in counted:
            counted[a] = _counts_of(name, old.content(a))
        found.counts += counted[a]
        return
    before, after = old.content(a), new.content(b)
    found.counts["files or parts with differences"] += 1
    ending = name.rpartition(".")[2]
    if ending == "json":
        compare_json(where, before, after, found)
    elif ending in ("xml", "rels", "vml"):
        texts = [content.decode("utf-8", "replace") for content in (before, after)]
        if sheet:
            texts = [with_shared_strings(*pair) for pair in zip(texts, strings, strict=True)]
        positions = _positions_in_chart if "!xl/charts/" in where else _positions
        compare_xml(where, texts[0], texts[1], positions(texts[0], times), found)
    elif ending == "csv":
        compare_csv(where, before.decode("utf-8-sig"), after.decode("utf-8-sig"), found)
    elif "!word/media/" in where:
        found.aside["drawing of a report"] += 1
    else:
        found.differs(where, f"{len(before)} bytes", f"{len(after)} other bytes")


def compare_csv(where: str, old: str, new: str, found: Comparison) -> None:
    """Two tables of text, cell by cell; columns that hold a time are set aside."""
    import csv

    before, after = list(csv.reader(old.splitlines())), list(csv.reader(new.splitlines()))
    if len(before) != len(after):
        found.differs(f"{where}, rows", len(before), len(after))
        return
    for number, (a, b) in enumerate(zip(before, after, strict=True), start=1):
        if len(a) != len(b):
            found.differs(f"{where}, row {number}", a, b)
            continue
        for header, x, y in zip(before[0], a, b, strict=True):
            is_number = _NUMBER.fullmatch(x) is not None
            found.counts["numbers" if is_number else "strings"] += 1
            if header in TIMES_IN_CSV:
                found.aside["time"] += 1
            elif x != y and (is_number or _NUMBER.fullmatch(y)):
                found.differs(f"{where}, row {number}, {header}", x, y)
            elif x != y:
                found.string(f"{where}, row {number}, {header}", x, y)


def _counts_of(name: str, content: bytes) -> Counter[str]:
    """Numbers and strings of a content that is equal in both records."""
    ending = name.rpartition(".")[2]
    counts: Counter[str] = Counter()
    if ending == "json":
        for _, value in leaves(_read_json(content)):
            counts["numbers" if isinstance(value, Number) else "strings"] += 1
    elif ending in ("xml", "rels", "vml"):
        for token in _TOKEN.findall(content.decode("utf-8", "replace")):
            if token.startswith("<"):
                counts["tags"] += 1
            else:
                counts["numbers" if _NUMBER.fullmatch(token) else "strings"] += 1
    elif ending == "npy":
        counts["numbers"] += max(len(content) - 128, 0) // 8
    return counts


def report(found: Comparison) -> str:
    """What was compared, what was set aside, and the first differences."""
    lines = [
        "compared: " + ", ".join(f"{n:,} {what}" for what, n in sorted(found.counts.items())),
        "set aside: "
        + (", ".join(f"{n:,} × {what}" for what, n in sorted(found.aside.items())) or "nothing"),
    ]
    used = [e for e in found.sentences.entries if e.used]
    lines.append(f"sentences of the list: {len(used)} used {sum(e.used for e in used):,} times")
    lines += [f"  {e.used:6,} × {_short(e.old, 90)} → {_short(e.new, 90)}" for e in used]
    lines += [f"  never used: {_short(e.old, 120)}" for e in found.sentences.unused]
    lines.append(f"differences: {len(found.differences):,}")
    lines += [f"  {one}" for one in found.differences[:LISTED]]
    if len(found.differences) > LISTED:
        lines.append(f"  and {len(found.differences) - LISTED:,} more")
    return "\n".join(lines) + "\n"


def passes(found: Comparison) -> bool:
    """Nothing differs, and the list has no entry that nothing needs."""
    return not found.differences and not found.sentences.unused


# --- proof that a difference is noticed -------------------------------------------------------------


class Changed(Record):
    """A record in which one number of one file has one bit changed."""

    def __init__(self, record_: Record, digest: str, content: bytes) -> None:
        self.folder, self.jobs = record_.folder, json.loads(json.dumps(record_.jobs))
        self._digest, self._content = digest, content

    def content(self, digest: str) -> bytes:
        """As recorded, but for the one content that was changed."""
        return self._content if digest == "changed" else super().content(digest)


def flipped(digits: str, bit: int = 0) -> str:
    """The decimal of a number after one bit of its double is changed."""
    (bits,) = struct.unpack("<Q", struct.pack("<d", float(digits)))
    (value,) = struct.unpack("<d", struct.pack("<Q", bits ^ (1 << bit)))
    return repr(value)


def prove(old: Record, trials: int = 12) -> list[str]:
    """Change the last bit of one number in a JSON file and in a workbook part, many times over.

    Returns what was changed and whether the comparison noticed; a number that is a time is not
    taken.
    """
    rng, done = random.Random(0), []
    places = [
        (name, file, None, what)
        for name, job in sorted(old.jobs.items())
        for file, what in job["files"].items()
        if isinstance(what, str) and file.endswith("results.json")
    ]
    places += [
        (name, file, part, digest)
        for name, job in sorted(old.jobs.items())
        for file, what in job["files"].items()
        if not isinstance(what, str)
        for part, digest in what
        if re.fullmatch(r"xl/worksheets/sheet\d+\.xml", part)
    ]
    json_places = [p for p in places if p[2] is None]
    part_places = [p for p in places if p[2] is not None]
    for number in range(trials):
        candidates = part_places if number % 2 and part_places else json_places
        if not candidates:
            continue
        for _ in range(100):
            name, file, part, digest = rng.choice(candidates)
            text = old.content(digest).decode("utf-8")
            pattern = (
                r"(?<=: )\d+\.\d{6,}(?=,?\n)" if part is None else r"(?<=<v>)\d+\.\d{6,}(?=</v>)"
            )
            numbers = [
                m
                for m in re.finditer(pattern, text)
                if '"time"' not in text[m.start() - 9 : m.start()]
            ]
            if numbers:
                break
        else:
            continue
        match = rng.choice(numbers)
        digits = flipped(match[0])
        changed = text[: match.start()] + digits + text[match.end() :]
        new = Changed(old, digest, changed.encode())
        new.jobs = {name: new.jobs[name]}
        kept = new.jobs[name]["files"]
        if part is None:
            kept[file] = "changed"
        else:
            kept[file] = [[p, "changed" if p == part else d] for p, d in kept[file]]
        plain = Changed(old, "", b"")
        plain.jobs = {name: old.jobs[name]}
        found = compare(plain, new, Sentences({}))
        noticed = len(found.differences) == 1
        in_times = not noticed and found.aside["time"] > 0 and not found.differences
        if part is not None and in_times:
            continue  # the cell holds a time: set aside, as it should be
        done.append(
            f"{'noticed' if noticed else 'NOT NOTICED'}: {name}, {file}"
            f"{'' if part is None else '!' + part}: {match[0]} → {digits}"
        )
    return done


# --- command line -----------------------------------------------------------------------------------

ALL_KINDS = (
    "examples", "published", "plain", "meshes", "clearances", "bearings", "pull-in", "studies", "batch",
)  # fmt: skip


def main() -> int:
    """Run one of the three commands."""
    parser = argparse.ArgumentParser(description="Do two source trees give the same results?")
    commands = parser.add_subparsers(dest="command", required=True)
    recording = commands.add_parser("record", help="run a tree and keep all results")
    recording.add_argument("tree", type=Path)
    recording.add_argument("out", type=Path)
    recording.add_argument("--kinds", nargs="+", choices=ALL_KINDS, default=ALL_KINDS)
    recording.add_argument("--count", type=int, default=300, help="random cases of each kind")
    recording.add_argument("--jobs", type=int, default=2, help="processes")
    comparing = commands.add_parser("compare", help="compare two records")
    comparing.add_argument("old", type=Path)
    comparing.add_argument("new", type=Path)
    comparing.add_argument("--sentences", type=Path, default=SENTENCES)
    comparing.add_argument("--report", type=Path)
    comparing.add_argument("--common", action="store_true", help="only jobs that both have")
    proving = commands.add_parser("prove", help="change one bit, and see that it is noticed")
    proving.add_argument("record", type=Path)
    options = parser.parse_args()
    if options.command == "record":
        record(options.tree, options.out, options.kinds, options.count, options.jobs)
        return 0
    if options.command == "prove":
        done = prove(Record(options.record))
        print("\n".join(done))
        return 0 if done and all(one.startswith("noticed") for one in done) else 1
    lines = TEMPLATES.read_text(encoding="utf-8").splitlines()
    templates = [(old, new) for old, _, new in (line.partition("\t") for line in lines)]
    content = tomllib.loads(options.sentences.read_text(encoding="utf-8"))
    sentences = Sentences(content, templates)
    old, new = Record(options.old), Record(options.new)
    if options.common:
        common = old.jobs.keys() & new.jobs.keys()
        for one in (old, new):
            one.jobs = {name: job for name, job in one.jobs.items() if name in common}
    found = compare(old, new, sentences)
    text = report(found)
    print(text, end="")
    if options.report:
        options.report.write_text(text, encoding="utf-8")
    return 0 if passes(found) else 1


if __name__ == "__main__":
    sys.exit(main())
