"""The compiled loops: built from these sources, without a compiler a sentence."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from engine.errors import InternalError
from engine.stepping.library import about, check_lengths, struct

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


def test_the_shape_of_every_array_stands_in_the_header(hook):
    header = (ROOT / hook.KERNELS / hook.HEADER).read_text(encoding="utf-8")
    stated, _ = hook.described_arrays(header)
    without = set()
    for body, name in hook.STRUCT.findall(header):
        code = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
        without |= {f"{name}.{a}" for a in re.findall(r"\*(\w+)", code) if a not in stated[name]}
    assert without == {"pieces_t.forced", "pieces_t.solver"}  # tables that the loop itself fills


def modes(n: int = 3, **others: Any) -> dict[str, Any]:
    given = {"stiffness": np.ones(n), "rate": np.ones(n), "reach": np.ones((2, n))}
    return {"n": n, "n_forces": 2, "n_read": 0, "mean_speed": np.ones(n), **given, **others}


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("rate", np.ones(4), r"system_t.rate with the shape \(n, lanes\), here \(3, 1\); .* \(4,\)"),
        ("reach", np.ones((3, 2)), "system_t.reach"),
        ("reach", np.ones(6), "system_t.reach"),
        ("mean_speed", np.ones((3, 4)), "system_t"),  # of four lanes, the others of one
        ("stiffness", np.array([1.0, np.nan, 1.0]), "finite numbers in system_t.stiffness, .* nan"),
        ("reach", np.full((2, 3), np.inf), "finite numbers in system_t.reach, .* inf"),
        ("rate", np.ones(3, dtype=np.int64), "arrays of double"),
        ("rate", np.ones(6)[::2], "contiguous"),
    ],
)  # fmt: skip
def test_a_loop_takes_no_array_of_another_shape_nor_numbers_without_end(field, value, words):
    struct("system_t", **modes())
    with pytest.raises(InternalError, match=words):
        struct("system_t", **modes(**{field: value}))


def test_large_numbers_are_finite():
    struct("system_t", **modes(stiffness=np.full(3, 1e308)))


def test_what_may_be_endless_is():
    """No field is ever applied: at an infinite time."""
    struct("drive_t", n_motors=1, field_time=np.full((1, 1), np.inf), cage=np.full((1, 1), np.nan))


def test_structs_of_other_lengths_do_not_meet_in_a_loop():
    system = struct("system_t", **modes())
    state = {"q": np.zeros(3), "v": np.zeros(3), "phase": np.zeros(0), "force": np.zeros(2)}
    check_lengths(struct("state_t", **state), lanes=1, n=system.n, n_forces=system.n_forces)
    short = struct("state_t", **state | {"q": np.zeros(2), "v": np.zeros(2)})
    with pytest.raises(InternalError, match="takes 3 n in state_t, this one has 2"):
        check_lengths(short, lanes=1, n=system.n)
    with pytest.raises(InternalError, match="takes 4 lanes in system_t, this one has 1"):
        check_lengths(system, lanes=4)
