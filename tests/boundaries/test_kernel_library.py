"""The compiled loops: built from these sources, without a compiler a sentence."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from engine.stepping.library import about

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def hook() -> ModuleType:
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def checkout(tmp_path: Path, hook: ModuleType) -> Path:
    """The sources alone, nothing built."""
    shutil.copytree(
        ROOT / hook.KERNELS,
        tmp_path / hook.KERNELS,
        ignore=shutil.ignore_patterns("_*", "__pycache__"),
    )
    return tmp_path


def test_the_library_is_made_from_the_sources_that_are_here(hook):
    assert about().endswith(f"sources {hook.sources_digest(ROOT / hook.KERNELS)}"), "run: make demo"


@pytest.mark.slow
def test_it_is_built_where_it_is_not_and_again_where_sources_have_changed(hook, checkout):
    made = hook.build(checkout)
    assert [p.name for p in made] == [Path(made[0]).name, "_declarations.py"]
    assert all(p.stat().st_size > 1000 for p in made)
    before = made[0].stat().st_mtime_ns
    assert hook.build(checkout)[0].stat().st_mtime_ns == before  # from the same sources: not again
    library = made[0].read_bytes()
    source = checkout / hook.KERNELS / "about.c"
    source.write_text(source.read_text(encoding="utf-8") + "\n/* changed */\n", encoding="utf-8")
    assert hook.build(checkout)[0].read_bytes() != library


def test_without_a_compiler_a_sentence_says_what_to_do(hook, checkout, monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(hook.shutil, "which", lambda name: None)
    monkeypatch.setattr(hook.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(SystemExit, match="found no C compiler. Install one"):
        hook.build(checkout)


def test_a_compiler_that_is_not_there_is_named(hook, checkout, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler -m64")
    with pytest.raises(SystemExit, match="no-such-compiler cannot be run"):
        hook.build(checkout)


@pytest.mark.slow
def test_a_compiler_that_fails_tells_why(hook, checkout):
    (checkout / hook.KERNELS / "about.c").write_text("this is no C", encoding="utf-8")
    with pytest.raises(SystemExit, match="The C compiler failed(.|\n)*about.c"):
        hook.build(checkout)


def test_no_compiler_of_the_index_is_asked_for_where_there_is_one(hook, monkeypatch):
    hook_of = hook.KernelHook.__new__(hook.KernelHook)
    monkeypatch.setattr(hook, "compiler", lambda: None)
    assert hook_of.dependencies() == ["ziglang"]
    monkeypatch.setattr(hook, "compiler", lambda: ("cc",))
    assert hook_of.dependencies() == []


def test_the_loops_need_no_compiler_at_run_time():
    code = "import engine.run, sys; print([m for m in sys.modules if m.split('.')[0] in ('numba', 'llvmlite', 'pycparser')])"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
