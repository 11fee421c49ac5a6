"""Runs commands of one source tree in one process, for `compare_trees.py record`.

Started by the Python of that tree, in it. Of the project only the command line is imported,
`addin.cli.main`, a name that is a promise. Each line of the input is a job; each gives one line of
output: exit status of every command, and digest of every file it left. The content of the files
lies in the folder of blobs, workbooks and other archives by their members.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import shutil
import sys
import zipfile
import zlib
from pathlib import Path
from typing import Any

#: Files that are archives: recorded member by member, since an archive holds times.
ARCHIVES = {".xlsx", ".xlsm", ".docx", ".npz"}


def keep(content: bytes, blobs: Path) -> str:
    """Store a content under its digest."""
    digest = hashlib.sha256(content).hexdigest()
    place = blobs / digest[:2] / digest[2:]
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        partial = place.with_name(f"{place.name}.{os.getpid()}")
        partial.write_bytes(zlib.compress(content, 6))
        partial.replace(place)
    return digest


def recorded(path: Path, blobs: Path) -> Any:
    """Digest of a file, or a list of member and digest."""
    if path.suffix in ARCHIVES:
        with zipfile.ZipFile(path) as archive:
            return [[name, keep(archive.read(name), blobs)] for name in archive.namelist()]
    return keep(path.read_bytes(), blobs)


def call(arguments: list[str]) -> tuple[Any, str]:
    """Exit status and words of one command."""
    from addin.cli import main

    sys.argv = ["torsionbook", *arguments]
    words = io.StringIO()
    status: Any = 0
    with contextlib.redirect_stdout(words), contextlib.redirect_stderr(words):
        try:
            main()
        except SystemExit as ended:
            status = ended.code or 0
    return status, words.getvalue()


def job(task: dict[str, Any], work: Path, blobs: Path) -> dict[str, Any]:
    """Run the commands of a job in an empty folder and record what they wrote."""
    folder = work / "job"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, source in task["inputs"].items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, folder / name)
    os.chdir(folder)
    statuses, words = [], []
    for arguments in task["commands"]:
        status, said = call(arguments)
        statuses.append(status)
        words.append(said)
    unwanted = {*task["inputs"], *task.get("leave", ())}
    files = {
        path.relative_to(folder).as_posix(): recorded(path, blobs)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.relative_to(folder).as_posix() not in unwanted
    }
    inputs = {name: recorded(folder / name, blobs) for name in task["inputs"]}
    os.chdir(work)
    return {
        "name": task["name"],
        "commands": task["commands"],
        "statuses": statuses,
        "inputs": inputs,
        "files": files,
        "words": keep("\n".join(words).encode(), blobs),
    }


def serve() -> None:
    """Jobs from the input, answers to the output, until the input ends."""
    work, blobs = Path(sys.argv[1]), Path(sys.argv[2])
    tree = Path.cwd()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever a command writes past sys.stdout is no answer
    import addin

    if not Path(addin.__file__).resolve().is_relative_to(tree.resolve()):
        raise SystemExit(f"the Python of {tree} imports {addin.__file__}")
    for line in sys.stdin:
        answers.write(json.dumps(job(json.loads(line), work, blobs)) + "\n")
        answers.flush()


if __name__ == "__main__":
    serve()
