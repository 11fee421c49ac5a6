"""Derived files are those of the records."""

import shutil
from pathlib import Path

from script_modules import script_module

ROOT = Path(__file__).resolve().parents[2]


def test_every_derived_file_is_that_of_the_records(derived):
    script = script_module("generated")
    stale = script.stale_files(ROOT, derived)
    assert not stale, f"stale: {', '.join(stale)}; run: {script.COMMAND}"


def test_a_stale_file_is_named(tmp_path, derived):
    script, root = script_module("generated"), tmp_path / "root"
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
    riddles = script_module("list_sentences").riddles
    found = [f"{place}: {text} → {instead}" for place, text, instead in riddles(ROOT)]
    assert not found, "\n".join(found)


def test_a_replaced_word_is_found(tmp_path):
    (tmp_path / "engine").mkdir()
    (tmp_path / "engine" / "a.py").write_text(
        '"""Hangs on nothing."""\nX = "The verdict hangs on it."\n'
    )
    assert [text for _, text, _ in script_module("list_sentences").riddles(tmp_path)] == [
        "The verdict hangs on it."
    ]
