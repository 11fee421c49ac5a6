"""Derived files are those of the records."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def generated_script():
    """scripts/generated.py as a module."""
    place = importlib.util.spec_from_file_location("generated", ROOT / "scripts" / "generated.py")
    module = importlib.util.module_from_spec(place)
    place.loader.exec_module(module)
    return module


def test_every_derived_file_is_that_of_the_records(tmp_path):
    script = generated_script()
    stale = script.stale_files(ROOT, tmp_path)
    assert not stale, f"stale: {', '.join(stale)}; run: {script.COMMAND}"


def test_a_stale_file_is_named(tmp_path):
    script = generated_script()
    root, fresh = tmp_path / "root", tmp_path / "fresh"
    for folder in (root, fresh):
        folder.mkdir()
    script.write_generated(root)
    (root / "docs" / "results.md").write_text("old", encoding="utf-8")
    (root / "addin/reference/schemas" / "gone.schema.json").write_text("{}", encoding="utf-8")
    assert script.stale_files(root, fresh) == [
        "docs/results.md",
        "addin/reference/schemas/gone.schema.json (of no record)",
    ]
