"""Write every file that is derived from the records: `make generated`.

Schemas, the pages of results, functions, published cases, hostile files and Windows, the table of effects, the commands of the studies, the list of sentences, and the
workbooks in templates/. Nothing of them is edited by hand; a test builds them all and names those that are
stale.

    python scripts/generated.py [ROOT]
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from list_sentences import listing  # noqa: E402  (beside this file)
from validation_page import validation_page  # noqa: E402  (likewise)

ROOT = Path(__file__).resolve().parents[1]
#: What the test says to run.
COMMAND = "make generated"
#: Folders that hold derived files alone.
FOLDERS = ("addin/reference/schemas", "templates")


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")


def write_generated(root: Path) -> list[Path]:
    """Write the derived files below a folder.

    Parameters
    ----------
    root : Path
        The checkout, or an empty folder for a comparison. [path]

    Returns
    -------
    list of Path
        Files written, relative to it.
    """
    from commands_page import commands_page
    from function_answers import function_answers
    from windows import page as windows_page

    from addin.reference.effects_page import effects_page
    from addin.reference.functions_page import functions_page
    from addin.reference.json_page import json_page
    from addin.reference.json_schemas import write_schemas
    from addin.reference.record_checks import check_records
    from addin.reference.results_page import results_pages
    from addin.reference.study_commands import study_commands
    from addin.template.build import build_all
    from benchmarks.safety_page import page as safety_page

    check_records()
    pages = {
        **{f"docs/{name}": text for name, text in results_pages().items()},
        "docs/functions.md": functions_page(function_answers()),
        "docs/validation.md": validation_page(),
        "docs/commands.md": commands_page(),
        "docs/json.md": json_page(),
        "docs/safety.md": safety_page(),
        "docs/windows.md": windows_page(),
        "docs/effects.md": effects_page((ROOT / "docs/effects.md").read_text(encoding="utf-8")),
        "addin/cli/study_commands.py": study_commands(),
    }
    for name, text in pages.items():
        _write(root / name, text)
    # last: derived modules have sentences, too
    _write(root / "scripts/sentences.txt", listing(ROOT))
    written = [root / name for name in (*pages, "scripts/sentences.txt")]
    written += write_schemas(root / "addin/reference/schemas")
    written += build_all(root / "templates")
    return [path.relative_to(root) for path in written]


def _content(path: Path) -> object:
    """What a file holds; of a workbook its parts, since how they are packed depends on the machine."""
    if path.suffix != ".xlsx":
        return path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def stale_files(root: Path, fresh: Path) -> list[str]:
    """What of a checkout differs from the files just written to another folder. [names]"""
    written = sorted(path.relative_to(fresh) for path in fresh.rglob("*") if path.is_file())
    stale = []
    for name in written:
        path = root / name
        if not path.is_file() or _content(path) != _content(fresh / name):
            stale.append(name.as_posix())
    for folder in FOLDERS:
        there = {path.relative_to(root) for path in (root / folder).iterdir() if path.is_file()}
        stale += [f"{name.as_posix()} (of no record)" for name in sorted(there - set(written))]
    return stale


if __name__ == "__main__":
    # The checkout whose records are used is the one that holds this file.
    sys.path.insert(0, str(ROOT))
    for name in write_generated(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT):
        print(name.as_posix())
