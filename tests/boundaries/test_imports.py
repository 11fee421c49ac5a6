"""The rooms keep to themselves: every import in `engine`, `addin`, `torsionbook` and `benchmarks` against layers.toml."""

import ast
import re
import subprocess
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest
from import_graph import circle, imports_of, modules_of

ROOT = Path(__file__).resolve().parents[2]
RULES = tomllib.loads((Path(__file__).parent / "layers.toml").read_text(encoding="utf-8"))
PACKAGES = ("engine", "addin", "torsionbook")
MOST_PARAMETERS = 8


def room_of(module: str) -> str:
    """The room of a module: engine.stepping.newmark → stepping; the package itself is no room."""
    return ".".join(module.split(".")[1:2])


def within_reach(rooms: dict[str, list[str]]) -> dict[str, set[str]]:
    """Room → the rooms it may import, directly named or through those."""
    reach: dict[str, set[str]] = {}
    for room, named in rooms.items():
        reach[room] = set(named).union(*(reach[below] for below in named))
    return reach


def complaint(path: str, line: int, sentence: str) -> str:
    return f"{path}:{line}: {sentence}"


def direction_complaints(root: Path) -> Iterator[str]:
    reach = {package: within_reach(RULES[package]["rooms"]) for package in PACKAGES}
    for one in imports_of(root, *PACKAGES):
        package, target = one.source.split(".")[0], one.target.split(".")[0]
        here, there = room_of(one.source), room_of(one.target)
        if not here or target not in PACKAGES:
            continue
        if here not in reach[package]:
            yield complaint(one.path, 1, f"enter {here} in tests/boundaries/layers.toml")
        elif package == "engine" and target != "engine":
            yield complaint(one.path, one.line, "the engine knows nothing of the add-in")
        elif package == "addin" and target == "torsionbook":
            yield complaint(one.path, one.line, "nothing imports the Python interface")
        elif package == "torsionbook" and target != package:
            if target == "engine" or there in RULES["torsionbook"]["not_of_the_addin"]:
                name = f"{target}.{there}"
                yield complaint(one.path, one.line, f"the Python interface may not import {name}")
        elif package != target:
            allowed = RULES["addin"]["of_the_engine"].get(here)
            if allowed is not None and there not in allowed:
                yield complaint(one.path, one.line, f"addin.{here} may not import engine.{there}")
        elif there not in reach[package][here] | {here, ""}:
            yield complaint(one.path, one.line, f"{here} may not import {there}")


def circles(root: Path, *packages: str) -> list[str]:
    arrows: dict[str, set[str]] = defaultdict(set)
    for one in imports_of(root, *packages):
        if one.target.split(".")[0] in packages:
            arrows[one.source].add(one.target)
    return circle(arrows)


def third_party_complaints(root: Path) -> Iterator[str]:
    allowed = set(RULES["engine"]["third_party"])
    for one in imports_of(root, "engine"):
        top = one.target.split(".")[0]
        if top not in {*PACKAGES} | allowed | sys.stdlib_module_names:
            yield complaint(one.path, one.line, f"the engine does not import {top}")


def hidden_complaints(root: Path) -> Iterator[str]:
    for one in imports_of(root, *PACKAGES):
        if one.inside_function and one.target.split(".")[0] in PACKAGES:
            if one.source not in RULES["inside_functions"]:
                yield complaint(one.path, one.line, f"import {one.target} at the top of the file")


def table_of(init: Path) -> list[str]:
    """The modules that the table in a room's docstring names, from the bottom up."""
    text = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
    return [
        name
        for row in re.findall(r"^(?:\| )?((?:`\w+`,? ?)+)(?:  | \|)", text, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", row)
    ]


def table_complaints(root: Path) -> Iterator[str]:
    """Each folder's table names every module of it once, and each imports only from those above it."""
    modules = modules_of(root, *PACKAGES)
    arrows = [one for one in imports_of(root, *PACKAGES) if one.target in modules]
    for folder, path in modules.items():
        if path.name != "__init__.py":
            continue
        inside = {
            name[len(folder) + 1 :].split(".")[0]
            for name in modules
            if name.startswith(folder + ".") and not name.endswith("__main__")
        }
        place = path.relative_to(root).as_posix()
        table = table_of(path)
        records = sorted(inside - set(table)) if folder in RULES["discovered"]["folders"] else []
        if sorted([*table, *records]) != sorted(inside):
            differing = sorted(set(table) ^ inside - set(records)) or "a module is named twice"
            yield complaint(place, 1, f"the table 'module, responsibility' differs: {differing}")
            continue
        table += records
        for one in arrows:
            if one.source.startswith(folder + ".") and one.target.startswith(folder + "."):
                here, there = (
                    name[len(folder) + 1 :].split(".")[0] for name in (one.source, one.target)
                )
                if here != there and there in records:
                    yield complaint(one.path, one.line, f"{there} is a record, for {place} alone")
                elif here in table and there in table and table.index(there) > table.index(here):
                    yield complaint(
                        one.path, one.line, f"{there} stands below {here} in the table of {place}"
                    )


def parameter_complaints(root: Path) -> Iterator[str]:
    """Functions with more parameters than a reader can keep apart."""
    for module, path in modules_of(root, *PACKAGES).items():
        if module.startswith("engine.stepping") or module.startswith("addin.cli"):
            continue  # compiled loops; parameters of commands are options of the command line
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                words = node.args
                names = [a.arg for a in words.posonlyargs + words.args + words.kwonlyargs]
                count = len([name for name in names if name not in ("self", "cls")])
                if count > MOST_PARAMETERS:
                    yield complaint(
                        path.relative_to(root).as_posix(),
                        node.lineno,
                        f"{node.name} has {count} parameters; {MOST_PARAMETERS} at the most",
                    )


def test_there_is_something_to_check():
    assert len(modules_of(ROOT, *PACKAGES)) > 200
    assert sum(1 for _ in imports_of(ROOT, *PACKAGES)) > 2000


def test_engine_imports_only_numerics():
    assert list(third_party_complaints(ROOT)) == []


def test_imports_point_downwards():
    assert list(direction_complaints(ROOT)) == []


def test_there_is_no_circle():
    assert circles(ROOT, *PACKAGES) == []


def test_benchmarks_have_no_circle():
    assert circles(ROOT, "benchmarks") == []


def test_no_import_is_hidden_in_a_function():
    assert list(hidden_complaints(ROOT)) == []


def test_each_folder_opens_with_its_table():
    assert list(table_complaints(ROOT)) == []


@pytest.mark.slow
def test_no_function_has_too_many_parameters():
    assert list(parameter_complaints(ROOT)) == []


def test_only_named_modules_know_optional_packages():
    found = [
        complaint(one.path, one.line, f"only {places or 'no module'} may import {package}")
        for package, places in RULES["addin"]["only_in"].items()
        for one in imports_of(ROOT, "addin", "torsionbook")
        if one.target.split(".")[0] == package and Path(one.path).stem not in places
    ]
    assert found == []


def made(root: Path, **files: str) -> Path:
    """A small tree: file names with __ for the slash."""
    for name, text in files.items():
        path = root / (name.replace("__", "/") + ".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


@pytest.mark.parametrize("text", ["from ..model import train", "from ..model.train import Train"])
def test_relative_imports_are_seen(tmp_path, text):
    made(tmp_path, engine__model__train="", engine__case__data=text)
    assert list(direction_complaints(tmp_path)) == [
        "engine/case/data.py:1: case may not import model"
    ]


def test_an_upward_and_a_foreign_import_are_complained_of(tmp_path):
    made(
        tmp_path,
        engine__run="",
        engine__model__train="import os\n\nfrom engine.run import run\n",
        engine__stepping__newmark="def f():\n    import pandas.io\n",
    )
    assert list(direction_complaints(tmp_path)) == [
        "engine/model/train.py:3: model may not import run"
    ]
    assert list(third_party_complaints(tmp_path)) == [
        "engine/stepping/newmark.py:2: the engine does not import pandas"
    ]


def test_the_python_interface_stands_on_top(tmp_path):
    made(
        tmp_path,
        torsionbook__inputs="from engine.run import run\nfrom addin.cli import app\n",
        addin__reading__cells="import torsionbook.inputs\n",
        engine__run="",
        addin__cli__app="",
    )
    assert sorted(direction_complaints(tmp_path)) == [
        "addin/reading/cells.py:1: nothing imports the Python interface",
        "torsionbook/inputs.py:1: the Python interface may not import engine.run",
        "torsionbook/inputs.py:2: the Python interface may not import addin.cli",
    ]


def test_a_circle_and_a_hidden_import_are_complained_of(tmp_path):
    made(
        tmp_path,
        engine__model__train="from engine.model import gears",
        engine__model__gears="def f():\n    from engine.model.train import Train\n",
    )
    assert set(circles(tmp_path, "engine")) == {"engine.model.train", "engine.model.gears"}
    assert list(hidden_complaints(tmp_path)) == [
        "engine/model/gears.py:2: import engine.model.train at the top of the file"
    ]


def test_a_type_only_import_is_an_import(tmp_path):
    text = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from engine.run import run\n"
    made(tmp_path, engine__run="", engine__case__data=text)
    assert list(direction_complaints(tmp_path)) == [
        "engine/case/data.py:3: case may not import run"
    ]


def test_a_table_that_is_out_of_date_is_complained_of(tmp_path):
    table = '"""A room.\n\n=======  ====\n`train`  one\n`gears`  two\n=======  ====\n"""\n'
    files = {"engine__model__train": "from engine.model import gears", "engine__model__gears": ""}
    made(tmp_path, engine____init__='"""`model`  the train"""', **files)
    (tmp_path / "engine" / "model" / "__init__.py").write_text(table)
    assert any("gears stands below train" in one for one in table_complaints(tmp_path))
    made(tmp_path, engine__model__load="")
    assert any("differs: ['load']" in one for one in table_complaints(tmp_path))


def test_nine_parameters_are_complained_of(tmp_path):
    made(tmp_path, addin__a="def f(a, b, c, d, e, f, g, h, *, i): ...\n")
    assert list(parameter_complaints(tmp_path)) == [
        "addin/a.py:1: f has 9 parameters; 8 at the most"
    ]


def test_the_command_line_starts_light():
    """Importing the command line loads nothing heavy; each command imports what it needs."""
    script = "import sys, addin.cli\nprint(' '.join(n for n in sys.argv[1:] if n in sys.modules))\n"
    done = subprocess.run(
        [sys.executable, "-c", script, *RULES["cli"]["not_loaded"]],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


@pytest.mark.parametrize("module", ["addin.server.app", "addin.worksheet.functions", "torsionbook"])
def test_functions_and_servers_start_without_scipy(module):
    """Each process of a server loads them; SciPy would double the time until its first answer."""
    script = f"import sys, {module}\nprint(sorted({{'scipy', 'pandas', 'openpyxl', 'matplotlib'}} & set(sys.modules)))\n"
    words = [sys.executable, "-c", script]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "[]\n"
