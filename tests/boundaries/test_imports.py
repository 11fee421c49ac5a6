"""The rooms keep to themselves: every import in `engine` and `addin` against layers.toml."""

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
RULES = tomllib.loads((Path(__file__).parent / "layers.toml").read_text(encoding="utf-8"))


def sources(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """Line and full dotted name of each import in a file, wherever in the file it stands."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            base = list(package[: len(package) - node.level + 1]) if node.level else []
            if node.module:
                base += node.module.split(".")
            for alias in node.names:
                yield node.lineno, ".".join([*base, alias.name])


def room(dotted: str) -> str:
    """The module of the engine a dotted name belongs to: engine.stepping.newmark → stepping."""
    parts = dotted.split(".")
    return parts[1] if len(parts) > 1 else ""


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return room(".".join(parts)) if parts[-1] != "__init__" or len(parts) > 2 else ""


LAYER = {
    module: height
    for height, layer in enumerate(RULES["engine"]["layer"])
    for module in layer["modules"]
}
PEERS = {
    module: layer.get("peers", False)
    for layer in RULES["engine"]["layer"]
    for module in layer["modules"]
}


def complaint(path: Path, line: int, sentence: str) -> str:
    return f"{path.relative_to(ROOT).as_posix()}:{line}: {sentence}"


def third_party_complaints() -> Iterator[str]:
    allowed = set(RULES["engine"]["third_party"])
    for path in sources("engine"):
        for line, dotted in imports(path):
            top = dotted.split(".")[0]
            if top != "engine" and top not in sys.stdlib_module_names and top not in allowed:
                yield complaint(path, line, f"the engine does not import {top}")


def direction_complaints() -> Iterator[str]:
    only = RULES["engine"]["only"]
    for path in sources("engine"):
        here = name_of(path)
        if not here:
            continue  # engine/__init__.py is above all layers
        if here not in LAYER:
            yield complaint(path, 1, f"enter {here} in tests/boundaries/layers.toml")
            continue
        for line, dotted in imports(path):
            there = room(dotted)
            if dotted.split(".")[0] != "engine" or there == here:
                continue
            if there not in LAYER:
                if (ROOT / "engine" / f"{there}.py").exists():
                    yield complaint(path, line, f"enter {there} in tests/boundaries/layers.toml")
                else:
                    yield complaint(path, line, f"import {there} from its module, not the package")
            elif here in only and there not in only[here]:
                yield complaint(path, line, f"{here} may not import {there}")
            elif LAYER[there] > LAYER[here]:
                yield complaint(path, line, f"{there} is above {here}")
            elif LAYER[there] == LAYER[here] and not PEERS[here]:
                yield complaint(path, line, f"{there} is on the same layer as {here}")


def test_there_is_an_engine_to_check():
    assert len(sources("engine")) > 5
    assert sum(1 for path in sources("engine") for _ in imports(path)) > 20


def test_engine_imports_only_numerics():
    assert list(third_party_complaints()) == []


def test_engine_layers_point_downwards():
    assert list(direction_complaints()) == []


def test_only_two_modules_know_excel():
    found = [
        complaint(path, line, f"only {places or 'no module'} may import {package}")
        for package, places in RULES["addin"]["only_in"].items()
        for path in sources("addin")
        for line, dotted in imports(path)
        if dotted.split(".")[0] == package and path.stem not in places
    ]
    assert found == []


@pytest.mark.parametrize("text", ["from . import train", "from .train import Train"])
def test_relative_imports_are_seen(tmp_path, monkeypatch, text):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    (tmp_path / "engine").mkdir()
    source = tmp_path / "engine" / "errors.py"
    source.write_text(text)
    assert [room(dotted) for _, dotted in imports(source)] == ["train"]
    assert list(direction_complaints()) == ["engine/errors.py:1: errors may not import train"]


def test_an_upward_and_a_foreign_import_are_complained_of(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    (tmp_path / "engine" / "stepping").mkdir(parents=True)
    (tmp_path / "engine" / "train.py").write_text("import os\n\nfrom engine.run import run\n")
    (tmp_path / "engine" / "stepping" / "newmark.py").write_text("def f():\n    import pandas.io\n")
    assert list(direction_complaints()) == ["engine/train.py:3: run is above train"]
    assert list(third_party_complaints()) == [
        "engine/stepping/newmark.py:2: the engine does not import pandas"
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
