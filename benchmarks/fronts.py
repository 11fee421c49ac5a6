"""Worksheet functions through their fronts, bits and times: `python -m benchmarks.fronts`.

Bits are those that tests/libreoffice/test_every_front.py compares; it is run. `--windows` asks the registry in a CPython for Windows
under Wine instead and compares with the registry here (`--check`: with the record, too, and writes nothing); both are kept in benchmarks/records/fronts.json with date and commit. Times are medians of repeated calls in one run. The model is at hand and its start calculated: what is measured
is the way of the cells to the function and back.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.peers import single_threaded

os.environ.update(single_threaded())

ROOT = Path(__file__).resolve().parents[1]
TESTS = ROOT / "tests"
sys.path[:0] = [str(TESTS / one) for one in ("excel", "server", "worksheet", "libreoffice")]

from benchmarks import report  # noqa: E402
from benchmarks.report import Section, Table  # noqa: E402

__all__ = ["PAGE", "measured"]

PAGE, RECORD = ROOT / "docs" / "fronts.md", ROOT / "benchmarks" / "records" / "fronts.json"
#: Repeats of a call, cells of one batch, and cells of the sheet that Calc calculates. [count]
REPEATS, BATCH, SHEET = 50, 100, 2000

Call = Callable[[str, list[Any]], Any]


def _median(call: Callable[[], Any], repeats: int = REPEATS) -> float:
    call()
    laps = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        laps.append(time.perf_counter() - began)
    return statistics.median(laps)


@contextmanager
def _classic() -> Iterator[Call]:
    from windows_layer import machinery

    with machinery() as excel:
        yield lambda name, raw: excel.call(name, *raw)


@contextmanager
def _posts() -> Iterator[tuple[Call, Call]]:
    """One call a POST, and `BATCH` of the same call in one POST."""
    import httpx2
    from servers import outside

    with outside() as address, httpx2.Client(base_url=address, timeout=60.0) as client:

        def post(name: str, raw: list[Any], times: int) -> Any:
            calls = [{"name": name, "arguments": raw}] * times
            answer = client.post("/api/v1/batch", json={"calls": calls})
            assert "value" in answer.json()["results"][0]
            return answer

        yield (
            lambda name, raw: post(name, raw, 1),
            lambda name, raw: post(name, raw, BATCH),
        )


@contextmanager
def _browser() -> Iterator[Call]:
    from office_page import cell, launched, load_in_office
    from playwright import sync_api
    from servers import outside

    with outside() as address, sync_api.sync_playwright() as playwright:
        program = launched(playwright)
        page = program.new_page(base_url=address)
        load_in_office(page)
        yield lambda name, raw: cell(page, name, raw)
        program.close()


def _calls() -> dict[str, list[Any]]:
    """The calls that are measured, by the words of a row."""
    from sheet_ranges import model_arguments

    from addin.worksheet.registry import call

    handle = call("TV_MODEL", model_arguments())[0][0]
    return {
        "TV_STIFFNESS": [200.0, 0.0, 500.0, 79300.0],
        "TV_FREQUENCIES": [handle],
        "TV_PEAKS": [handle],
        "TV_HISTORY": [handle, "LS coupling", 500.0],
        "TV_MODEL": model_arguments(),
    }


def _in_calc() -> float | None:
    """Time of a cell with TV_STIFFNESS beyond that of a plain formula; None without LibreOffice."""
    import shutil

    from flat_sheets import Formula, write_sheets

    from addin.libreoffice.oxt import extension, worker_command

    program = shutil.which("soffice")
    if program is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        made = place / "torsionbook.oxt"
        made.write_bytes(extension(worker_command()))
        places = {
            "UserInstallation": place / "profile",
            "UNO_SHARED_PACKAGES_CACHE": place / "shared",
            "SHARED_EXTENSIONS_USER": place / "registered",
        }
        words = [f"-env:{name}={where.as_uri()}" for name, where in places.items()]
        unopkg = Path(program).resolve().with_name("unopkg")
        quiet: dict[str, Any] = {"stdin": subprocess.DEVNULL, "capture_output": True}
        add = [str(unopkg), "add", *(["--shared"] if os.geteuid() == 0 else []), str(made), *words]
        subprocess.run(add, check=True, timeout=120, **quiet)
        times = {}
        for kind, formula in (("ours", "TV_STIFFNESS({};0;500;79300)"), ("plain", "SQRT({})")):
            sheet = {(i, 0): Formula(formula.format(200 + i)) for i in range(SHEET)}
            path = write_sheets(place / f"{kind}.fods", {"S": sheet})
            convert = [program, "--headless", "--convert-to", "csv", "--outdir", folder, str(path)]
            laps = []
            for _ in range(4):
                began = time.perf_counter()
                subprocess.run([*convert, *words], check=True, timeout=120, **quiet)
                laps.append(time.perf_counter() - began)
            times[kind] = statistics.median(laps[1:])
            text = (place / f"{kind}.csv").read_text(encoding="utf-8").splitlines()
            assert len(text) == SHEET, "LibreOffice did not calculate the sheet"
            assert not text[0].startswith(("#", "Err")), text[0]
    return (times["ours"] - times["plain"]) / SHEET


def measured() -> list[Section]:
    """Everything, as tables."""
    from addin.worksheet.registry import call

    calls = _calls()
    fronts: dict[str, dict[str, float]] = {}
    fronts["plain Python"] = {n: _median(lambda n=n, r=r: call(n, r)) for n, r in calls.items()}
    with _classic() as classic:
        fronts["classic xlwings, Python side"] = {
            n: _median(lambda n=n, r=r: classic(n, r)) for n, r in calls.items()
        }
    with _posts() as (single, many):
        single("TV_MODEL", calls["TV_MODEL"])
        fronts["HTTP, one POST"] = {
            n: _median(lambda n=n, r=r: single(n, r)) for n, r in calls.items()
        }
        fronts[f"HTTP, one of {BATCH} in a POST"] = {
            n: _median(lambda n=n, r=r: many(n, r), 7) / BATCH for n, r in calls.items()
        }
    with _browser() as browser:
        browser("TV_MODEL", calls["TV_MODEL"])
        fronts["browser, one cell alone"] = {
            n: _median(lambda n=n, r=r: browser(n, r), 15) for n, r in calls.items()
        }
    names = list(calls)
    rows = [
        (front, *(f"{1e3 * times[name]:.3g}" for name in names)) for front, times in fronts.items()
    ]
    in_calc = _in_calc()
    if in_calc is not None:
        rows.append(("LibreOffice Calc", f"{1e3 * in_calc:.3g}", *["–"] * (len(names) - 1)))
    return [
        Section(
            "Time of one call",
            "Made by `python -m benchmarks.fronts --write-docs`. Milliseconds, medians of one run on "
            "2 cores; the model is at hand and its start calculated. TV_STIFFNESS is one number, "
            "TV_FREQUENCIES a table, TV_HISTORY 500 rows, TV_MODEL takes every table of the example. "
            "Classic xlwings is without COM, which Windows adds. A cell alone in the browser waits a "
            "moment for others to share its POST. Of Calc the time of a cell beyond that of a plain "
            f"formula, over {SHEET:,} cells.",
            (Table("Milliseconds a call", ("Front", *names), tuple(rows)),),
        )
    ]


#: Fronts by what the test calls them, and how their column is headed.
_FRONTS = {
    "xlwings": "Excel (xlwings)",
    "Office": "Office add-in",
    "HTTP": "HTTP",
    "Calc": "Calc",
    "MCP": "MCP",
    "batch": "batch",
    "Python": "Python",
}
#: Largest relative difference that those two may have, which processors and their kernels of LAPACK move. [1]
_ROUNDING = 1e-12
#: Why two functions differ under Wine: every call of numpy and SciPy that they make (6,993 of them, 1,944,410 numbers),
#: recorded on Linux and repeated there with the same arguments.
_CAUSE = (
    "the cause: of 6,993 calls of numpy and SciPy that the two make, repeated there with the same arguments, `exp` and `log` of "
    "numpy give another last bit, `ndtr` and `ndtri` differ by 2 units in the last place, `truncnorm.ppf` by 41 (5.5e-15), and "
    "LAPACK's `inv`, `lstsq` and `pinv` by 1.2e-14 of the largest number of an answer; `svd`, `qr`, `solve`, products, powers, "
    "sums and binomial quantiles are the same"
)
#: Heading of that section.
_BITS = "Equal bits"
#: Why a function has no equal in batch and Python, by a letter; the first that has its name.
_REASONS = {
    "a": (
        ("TV_MODEL", "TV_STIFFNESS", "TV_SECTIONS", "TV_MOTOR_CIRCUIT", "TV_MOTOR_CURVES", "TV_FAULT_TORQUE", "TV_SN_LIFE", "TV_LIFE", "TV_CONVERT"),
        "takes values or ranges, makes no table of a result",
    ),
    "b": (("TV_TUNE", "TV_TOLERANCES", "TV_SENSITIVITIES", "TV_CALIBRATE"), "a study, which has its own command and `tb.study`"),
    "c": ((), "in another form there (chart data, a column more, words instead of flags), or without rows in this train: not compared"),
}  # fmt: skip


def compare_fronts() -> None:
    """Run the test, and keep through which fronts each function was equal."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "fronts.json")
        test = "tests/libreoffice/test_every_front.py"
        more = {"TORSIONBOOK_FRONTS": str(place), "TORSIONBOOK_RUN_SLOW": "1"}
        words = [sys.executable, "-m", "pytest", "-q", "-p", "no:xdist", test]
        subprocess.run(words, cwd=ROOT, env={**os.environ, **more}, check=True)
        _keep("here", json.loads(place.read_text(encoding="utf-8")))


def compare_windows() -> tuple[list[str], dict[str, float]]:
    """Ask the registry here and in a Python for Windows; `differences` of the two."""
    script = "scripts/front_answers.py"
    with tempfile.TemporaryDirectory() as folder:
        here, there = Path(folder, "here.json"), Path(folder, "there.json")
        subprocess.run([sys.executable, script, str(here)], cwd=ROOT, check=True)
        under_wine = ["scripts/windows.py", "--python", script, f"Z:{there}".replace("/", "\\")]
        subprocess.run([sys.executable, *under_wine], cwd=ROOT, check=True)
        both = [json.loads(path.read_text(encoding="utf-8")) for path in (here, there)]
    return differences(*both)


def check_windows(differs: dict[str, float]) -> None:
    """Ends with a sentence where a function answers other bits that did not in the record, or is further away than rounding."""
    known = json.loads(RECORD.read_text(encoding="utf-8"))["windows"]["differs"]
    new = [n for n, much in differs.items() if n not in known or much > _ROUNDING]
    if new:
        much = ", ".join(f"{name} by {differs[name]:.2g}" for name in new)
        raise SystemExit(f"Under Wine these answer otherwise than here: {much} (relative).")


def differences(here: list[Any], there: list[Any]) -> tuple[list[str], dict[str, float]]:
    """Functions of which every answer is the same; of the others the largest difference of two doubles, relative. [1]"""
    assert [name for name, _ in here] == [name for name, _ in there]
    differs: dict[str, float] = {}
    for (name, ours), (_, theirs) in zip(here, there, strict=True):
        if ours == theirs:
            continue
        pairs = [
            (float.fromhex(a), float.fromhex(b))
            for row, other in zip(ours, theirs, strict=True)
            for a, b in zip(row, other, strict=True)
            if a != b
        ]
        largest = max(abs(a - b) / max(abs(a), abs(b)) for a, b in pairs)
        differs[name] = max(largest, differs.get(name, 0.0))
    return sorted({name for name, _ in here} - set(differs)), differs


def _keep(what: str, equal: Any, differs: dict[str, float] | None = None) -> None:
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    git = ["git", "rev-parse", "--short=8", "HEAD"]
    commit = subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    when = {"date": time.strftime("%Y-%m-%d"), "commit": commit.strip()}
    record[what] = {"equal": equal, **when} | ({} if differs is None else {"differs": differs})
    RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def bits() -> Section:
    """A row for each function, a column for each front, from the record."""
    from addin.worksheet.registry import FUNCTIONS

    record = json.loads(RECORD.read_text(encoding="utf-8"))
    equal, windows = record["here"]["equal"], record["windows"]
    assert set(equal) == set(FUNCTIONS)
    assert {name for names, _ in _REASONS.values() for name in names} <= set(FUNCTIONS)
    rows = [
        (
            f"`{name}`",
            *("=" if front in fronts else _reason(name) for front in _FRONTS),
            "=" if name in windows["equal"] else "≠",
        )
        for name, fronts in equal.items()
    ]
    notes = "; ".join(f"{letter}: {words}" for letter, (_, words) in _REASONS.items())
    others = [f"`{name}` {much:.2g}" for name, much in windows["differs"].items()]
    if others:
        notes += f"; ≠: differs; largest relative difference of two numbers: {', '.join(others)}; {_CAUSE}"
    return Section(
        _BITS,
        f"All {len(rows)} functions, with every argument that the test has, on one train with a fault and two conditions "
        "(batch and Python: the proposed train as shipped). Each front makes the model for itself from the ranges of the "
        "workbook. `=`: every double has the same 64 bits as in the registry, every text is the same; of `TV_EFFECTS` "
        "the measured time is left out, in Python numbers alone are compared. Excel is xlwings' own machinery without "
        "COM; the Office add-in runs in Chromium with a stand-in for its host; Calc is LibreOffice; MCP is asked by the "
        "client of its SDK. Windows is the registry itself in a CPython 3.13 for Windows under Wine 8, asked on "
        f"{windows['date']} at commit {windows['commit']} (`make front-windows`); the other columns on {record['here']['date']} at "
        f"{record['here']['commit']}. Neither a real Excel nor Windows nor a Mac was at hand.",
        (
            Table(
                "Function by front",
                ("Function", *_FRONTS.values(), "Windows (Wine)"),
                tuple(rows),
                notes + ".",
            ),
        ),
    )


def _reason(name: str) -> str:
    return next((letter for letter, (names, _) in _REASONS.items() if name in names), "c")


def main() -> None:
    """Measure, print, and on request write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fronts")
    parser.add_argument("--write-docs", action="store_true", help=f"write {PAGE.name}")
    parser.add_argument("--bits", action="store_true", help="the bits alone; times stay")
    parser.add_argument("--windows", action="store_true", help="the bits under Wine alone")
    parser.add_argument("--check", action="store_true", help="with --windows: write nothing, fail where more differs than in the record")  # fmt: skip
    args = parser.parse_args()
    if args.check:
        equal, differs = compare_windows()
        check_windows(differs)
        print(f"{len(equal)} functions to the bit as here, {len(differs)} within {_ROUNDING:g}")
        return
    if args.windows:
        _keep("windows", *compare_windows())
        args.bits = True
    else:
        compare_fronts()
    sections = [bits()] if args.bits else [*measured(), bits()]
    report.show(sections)
    if args.write_docs:
        times = PAGE.read_text(encoding="utf-8").partition(f"\n## {_BITS}\n")[0]
        report.write_markdown(PAGE, "Worksheet functions through their fronts", sections)
        if args.bits:
            made = PAGE.read_text(encoding="utf-8").partition("\n## ")
            PAGE.write_text(f"{times.rstrip()}\n\n## {made[2]}", encoding="utf-8")


if __name__ == "__main__":
    main()
