"""No file of the product names a folder of somebody's machine or a package index."""

import re
import shutil
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOT_OURS = {"build", "dist", "__pycache__"}
OURS = {".ci", ".gitignore", ".gitattributes"}  # of the names with a dot in front

# In pieces, so that this file passes its own test.
MACHINE_FOLDERS = ["/wo" + "rk/", "/ro" + "ot/", "/ho" + "me/", "/Us" + "ers/", "/opt/" + "wheels"]
INDEX_HOSTS = [
    "pypi" + ".org",
    "python" + "hosted",
    "devpi" + "/",
    "/simple" + "/",
    "index" + "-url",
]
FORBIDDEN = re.compile(
    "|".join(rf"(?<![\w.\-<>]){re.escape(folder)}" for folder in MACHINE_FOLDERS)
    + "|"
    + "|".join(re.escape(host) for host in INDEX_HOSTS)
    + r"|[A-Z]:\\{1,2}Us"
    + r"ers\\"
)

#: What is in every text that the pattern finds.
WORDS = (*MACHINE_FOLDERS, *INDEX_HOSTS, ":\\Us" + "ers\\", ":\\\\Us" + "ers\\")


def product_files() -> list[Path]:
    """What git tracks or would, or else every file that is not made here."""
    if shutil.which("git") and (ROOT / ".git").exists():
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT,
            capture_output=True,
            check=True,
        ).stdout.decode("utf-8")
        paths = [ROOT / name for name in listed.split("\0") if name]
    else:
        paths = [
            path
            for path in ROOT.rglob("*")
            if not any(
                part in NOT_OURS or (part.startswith(".") and part not in OURS)
                for part in path.relative_to(ROOT).parts
            )
        ]
    return sorted(path for path in paths if path.is_file())


def texts(path: Path) -> Iterator[tuple[str, str]]:
    """The name and text of a file, or of each part of a workbook."""
    name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name
    if path.suffix in {".xlsx", ".xlsm"}:
        with zipfile.ZipFile(path) as book:
            for part in book.namelist():
                yield f"{name}!{part}", book.read(part).decode("utf-8", "replace")
    else:
        yield name, path.read_bytes().decode("utf-8", "replace")


def complaints(path: Path) -> Iterator[str]:
    here = str(ROOT) if len(ROOT.parts) > 2 else None
    for name, text in texts(path):
        if not any(word in text for word in (*WORDS, *([here] if here else ()))):
            continue  # a search for words is quick where one for the pattern is not
        for number, line in enumerate(text.splitlines(), 1):
            found = FORBIDDEN.search(line)
            if found:
                yield f"{name}:{number}: {found[0]}"
            elif here and here in line:
                yield f"{name}:{number}: the path of this checkout"


def test_no_machine_path_and_no_index_host():
    files = product_files()
    assert ROOT / "pyproject.toml" in files
    assert [sentence for path in files for sentence in complaints(path)] == []


@pytest.mark.parametrize("text", [*MACHINE_FOLDERS, *INDEX_HOSTS, "C:\\Us" + "ers\\me"])
def test_the_search_finds(tmp_path, text):
    for name in ("a.txt", "b.xlsx"):
        path = tmp_path / name
        if path.suffix == ".xlsx":
            with zipfile.ZipFile(path, "w") as book:
                book.writestr("xl/part.xml", f"<v>{text}me</v>".replace("<v>", "<v> "))
        else:
            path.write_text(f'see "{text}"')
        assert len(list(complaints(path))) == 1
