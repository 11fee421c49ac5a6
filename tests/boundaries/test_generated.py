"""Derived files are those of the records."""

import importlib.util
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def generated_script(name="generated"):
    """A module of scripts/."""
    place = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    module = importlib.util.module_from_spec(place)
    place.loader.exec_module(module)
    return module


def test_every_derived_file_is_that_of_the_records(derived):
    script = generated_script()
    stale = script.stale_files(ROOT, derived)
    assert not stale, f"stale: {', '.join(stale)}; run: {script.COMMAND}"


def test_a_stale_file_is_named(tmp_path, derived):
    script, root = generated_script(), tmp_path / "root"
    shutil.copytree(derived, root)
    assert script.stale_files(root, derived) == []
    (root / "docs" / "results.md").write_text("old", encoding="utf-8")
    (root / "addin/reference/schemas" / "gone.schema.json").write_text("{}", encoding="utf-8")
    assert script.stale_files(root, derived) == [
        "docs/results.md",
        "addin/reference/schemas/gone.schema.json (of no record)",
    ]


def test_no_sentence_has_words_that_were_replaced():
    """The words of design that a reader had to decode; see scripts/list_sentences.py."""
    riddles = generated_script("list_sentences").riddles
    found = [f"{place}: {text} → {instead}" for place, text, instead in riddles(ROOT)]
    assert not found, "\n".join(found)


def test_a_replaced_word_is_found(tmp_path):
    (tmp_path / "engine").mkdir()
    (tmp_path / "engine" / "a.py").write_text(
        '"""Hangs on nothing."""\nX = "The verdict hangs on it."\n'
    )
    assert [text for _, text, _ in generated_script("list_sentences").riddles(tmp_path)] == [
        "The verdict hangs on it."
    ]
