"""Digests of 200 results, to compare two machines: `python scripts/results_digest.py [--keep FILE]`.

Each result is the JSON file that a command writes: published cases, random trains of every kind, long ones, and
small studies. One line a result, then a total of each class; `linear` are trains without clearances. `--of linear`
calculates one class, `--every 5` every fifth result. With

    python scripts/results_digest.py --compare A B

two kept runs are compared result by result: the first number that differs is named, and how far the
numbers of each table lie apart. Exit status 1 where a linear train differs. Times are left out.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import sys
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT))  # behind PYTHONPATH: another engine may be asked for

import compare_cases  # noqa: E402

#: Random trains of each kind, numbered from 0.
RANDOM = {"plain": 50, "meshes": 35, "pull-in": 10, "bearings": 12, "clearances": 12, "studies": 20}
#: Stations of long trains, which are random too.
LONG = (16, 24, 40, 64)
#: Classes: what has to be equal on every machine, and what need not.
LINEAR, CLEARANCES, STUDIES = "linear", "clearances", "studies"
#: What says when, where, by which version and how long, by table.
OF_THE_MACHINE = {("effects", "time"), ("accuracy_cost", "time"), ("", "version")}
AUDIT_OF_THE_MACHINE = ("Software", "Date", "Python", "Libraries", "Time spent")
#: Sentences that say how long.
DURATION = re.compile(r"[\d.,]+ (?:ms|s|min|h)\b")


def cases() -> Iterator[tuple[str, str, dict[str, Any], list[str]]]:
    """Name, class, inputs and command of each result."""
    recalc = ["recalc"]
    for name, case in compare_cases.published_cases(ROOT / "tests" / "validation" / "cases"):
        yield name, _class_of(case), case, recalc
    for stations in LONG:
        yield f"long {stations}", LINEAR, _long(stations), recalc
    for kind, count in RANDOM.items():
        for number in range(count):
            case = compare_cases.random_case(kind, number)
            if kind != "studies":
                yield f"{kind} {number}", _class_of(case), case, recalc
                continue
            study = compare_cases.study_command(number)
            more = ["--samples", "20"] if study == "tolerances" else []
            yield f"{study} {number}", STUDIES, case, [study, "--jobs", "1", *more]


def _class_of(case: dict[str, Any]) -> str:
    """Whether a train has clearances."""
    gaps = ("backlash", "angular_backlash")
    return (
        CLEARANCES
        if any(row.get(gap) for row in case.get("meshes", ()) for gap in gaps)
        else LINEAR
    )


def _long(stations: int) -> dict[str, Any]:
    """A chain with a start, a damper and an excitation; every number is one that JSON writes exactly."""
    names = [f"S{i}" for i in range(stations)]
    inertia = [1.0 + (7 * i % 11) * 0.75 for i in range(stations)]
    stiffness = [2.0e6 + (5 * i % 13) * 3.0e5 for i in range(stations - 1)]
    speeds = compare_cases.SPEEDS
    return {
        "format": 1, "line_frequency": 60.0, "poles": 4, "damping_ratio": 0.01, "rated_torque": 2000.0,
        "stations": [{"station": n, "inertia": j} for n, j in zip(names, inertia, strict=True)],
        "elements": [
            {"element": f"K{i}", "kind": "coupling", "from": names[i], "to": names[i + 1],
             "stiffness": k, **({"damping": 40.0} if i % 5 == 2 else {})}
            for i, k in enumerate(stiffness)
        ],
        "motor_torque": [
            {"station": "S0", "speed": x, "average": 30000.0 * (1.0 - 0.5 * x) if x < 1 else 0.0,
             "pulsating": 9000.0 - 3000.0 * x}
            for x in speeds
        ],
        "load_torque": [{"station": names[-1], "speed": x, "torque": 1500.0 * x * x} for x in speeds],
        "excitations": [{"name": "line", "frequency": 120.0, "station": "S0", "torque": 20.0}],
    }  # fmt: skip


def numbers(content: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Every number and word of a JSON file that does not belong to the machine, by its place."""
    if isinstance(content, dict):
        if str(content.get("item", "")).startswith(AUDIT_OF_THE_MACHINE):
            return
        for key, value in content.items():
            table = where.partition("[")[0].strip(".")
            if (table, key) not in OF_THE_MACHINE:
                yield from numbers(value, f"{where}.{key}")
    elif isinstance(content, list):
        for i, value in enumerate(content):
            yield from numbers(value, f"{where}[{i}]")
    else:
        yield where, DURATION.sub("#", content) if isinstance(content, str) else content


def calculated(case: dict[str, Any], command: list[str]) -> dict[str, Any]:
    """What a command writes for a case, by place."""
    from addin.cli.app import app

    with tempfile.TemporaryDirectory() as folder:
        inputs, results = Path(folder, "case.json"), Path(folder, "results.json")
        inputs.write_text(json.dumps(case), encoding="utf-8")
        first, *more = command
        with open(os.devnull, "w") as nowhere:
            with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
                with contextlib.suppress(SystemExit):
                    app([first, str(inputs), "--json", str(results), *more])
        if not results.exists():
            return {"no results": True}
        return dict(numbers(json.loads(results.read_text(encoding="utf-8"))))


def digest(found: Any) -> str:
    """Of the shortest decimals that give back every bit."""
    return hashlib.sha256(json.dumps(found, sort_keys=True).encode()).hexdigest()[:12]


def run(keep: Path | None, of: str, every: int) -> None:
    """Calculate, print, keep."""
    kept, totals = {}, {}
    wanted = [case for case in cases() if case[1] in of.split(",")]
    for name, kind, case, command in wanted[::every]:
        found = calculated(case, command)
        print(f"{digest(found)}  {kind:10} {len(found):6} values  {name}", flush=True)
        kept[name] = {"class": kind, "values": found}
        totals.setdefault(kind, []).append(digest(found))
    for kind, digests in totals.items():
        print(f"{digest(digests)}  {kind}: all {len(digests)}")
    print(f"{digest(totals)}  total")
    if keep:
        keep.write_bytes(zlib.compress(json.dumps(kept).encode()))


def compare(one: Path, other: Path) -> int:
    """The first number that differs of each result; 1 where a linear train differs."""
    a, b = (json.loads(zlib.decompress(path.read_bytes())) for path in (one, other))
    furthest: dict[tuple[str, str], tuple[float, int]] = {}
    differ: dict[str, int] = {}
    for name in a.keys() & b.keys():
        kind, old, new = a[name]["class"], a[name]["values"], b[name]["values"]
        places = [p for p in (old | new) if old.get(p) != new.get(p)]
        if not places:
            continue
        differ[kind] = differ.get(kind, 0) + 1
        print(f"{name}: {len(places)} of {len(old)} differ, first {places[0]}: "
              f"{old.get(places[0])!r} and {new.get(places[0])!r}")  # fmt: skip
        for place in places:
            key = kind, re.sub(r"\[\d+\]", "", place)
            far, count = furthest.get(key, (0.0, 0))
            furthest[key] = max(far, _apart(old.get(place), new.get(place))), count + 1
    for (kind, key), (far, count) in sorted(furthest.items(), key=lambda x: -x[1][0]):
        print(f"{kind:10} {far:8.1e} {count:6}  {key}")
    print(f"results that differ: {differ or 'none'}")
    return 1 if differ.get(LINEAR) else 0


def _apart(a: Any, b: Any) -> float:
    """Relative difference of two numbers, infinite where one is a word or missing."""
    if isinstance(a, bool) or not (isinstance(a, int | float) and isinstance(b, int | float)):
        return float("inf")
    return abs(a - b) / max(abs(a), abs(b))


def main(words: list[str]) -> int:
    """As the words say."""
    if words[:1] == ["--compare"]:
        return compare(Path(words[1]), Path(words[2]))
    given = dict(zip(words[::2], words[1::2], strict=True))
    keep, of = given.get("--keep"), given.get("--of", f"{LINEAR},{CLEARANCES},{STUDIES}")
    run(Path(keep) if keep else None, of, int(given.get("--every", 1)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
