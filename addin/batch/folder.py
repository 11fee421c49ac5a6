"""The folder of results: one batch at a time, results put in place in one step.

A result is made in a staging folder of the batch, recorded in the journal, and only then put in place.
Whenever the program is ended, a result is either recorded and complete, in its place or beside it,
or it is not recorded and its parts are thrown away by the next batch.
"""

from __future__ import annotations

import contextlib
import datetime as dt
import errno
import hashlib
import os
import platform
import shutil
import uuid
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from addin.batch.inputs import OWN
from addin.batch.journal import read_journal
from addin.batch.records import Output, Record, Stamp
from addin.xlsx.places import real_path, refuse_no_end, replace_file
from addin.xlsx.whole_files import flush_folder, write_whole


class FolderRefused(Exception):
    """The folder of results cannot be used; the sentence says why."""


def digest_of(path: Path) -> str:
    """SHA-256 of a file.

    Raises
    ------
    OSError
        If it cannot be read, or is a device or a pipe, which may never end.
    """
    refuse_no_end(path)
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def stamp_of(path: Path) -> Stamp:
    """Which state a file is in; without digest, which `digest_of` gives.

    Raises
    ------
    OSError
        If it is not there.
    """
    status = path.stat()
    return Stamp(status.st_size, status.st_mtime_ns, "")


def digested(path: Path) -> Stamp:
    """Which state a file is in, its digest included."""
    return replace(stamp_of(path), sha256=digest_of(path))


class OutFolder:
    """The folder of results, held by one batch.

    Parameters
    ----------
    path : Path
        The folder; it is made if need be. [path]
    json : Path, optional
        Another folder in which results may be put in place, too. [path]

    Raises
    ------
    FolderRefused
        If it cannot be written, or another batch holds it.
    """

    def __init__(self, path: Path, json: Path | None = None) -> None:
        if path.is_file():
            raise FolderRefused(f"{path} is a file; --out must name a folder.")
        self.path = path.absolute()  # as processes with another working folder see it too
        #: Recorded results in other folders than those of this batch, by the file's name in its batch.
        self.elsewhere: dict[str, tuple[Output, ...]] = {}
        self._own = self.path / OWN
        try:
            self._own.mkdir(parents=True, exist_ok=True)
            self._lock = _Lock(self._own / "lock", path)
            self._clear(json)
            self.staging = self._own / f"staging-{uuid.uuid4().hex[:8]}"
            self.staging.mkdir(mode=0o700)
        except OSError as wrong:
            raise FolderRefused(
                f"Results cannot be written to {path} ({wrong.strerror or wrong}). Name another "
                "folder with --out, or make this one writable."
            ) from wrong

    @property
    def journal(self) -> Path:
        """The journal of this folder. [path]"""
        return self._own / "journal.jsonl"

    def __enter__(self) -> OutFolder:
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self.staging, ignore_errors=True)
        self._lock.release()

    def records(self, json: Path | None = None) -> tuple[dict[str, Record], tuple[str, ...]]:
        """What the journal says, as far as it may be believed.

        A journal that somebody made up shall not move a file of his choice to a place of his choice: staged
        results lie in a staging folder, and belong in this folder or in that of the JSON.

        Returns
        -------
        records : dict of str to Record
            By the file's name in its batch. Outputs in folders that are not asked for now are left out.
        refused : tuple of str
            A sentence for each record that is not believed.
        """
        believed, refused = {}, []
        for name, record in read_journal(self.journal).items():
            outputs = record.outputs
            if all(
                self._is_staged(output.staged) and self._is_place(output.name) for output in outputs
            ):
                kept = tuple(output for output in outputs if self._is_asked_for(output.name, json))
                self.elsewhere[name] = tuple(output for output in outputs if output not in kept)
                believed[name] = replace(record, outputs=kept)
            else:
                refused.append(
                    f"The record of {name} in {self.journal} names files outside the folders of the "
                    "batch; it is ignored and the results are recalculated. torsionbook does not write "
                    "such a record: check who changed it."
                )
        return believed, tuple(refused)

    def _is_staged(self, staged: object) -> bool:
        """Whether something lies in a staging folder, not somewhere else by ``..`` or a link."""
        if not isinstance(staged, str) or "\0" in staged:
            return False
        if not staged:
            return True
        try:
            own, place = real_path(self._own), real_path(self.path / staged)
        except OSError:
            return False
        inside = place.relative_to(own).parts if place.is_relative_to(own) else ()
        return len(inside) > 1 and inside[0].startswith("staging-")

    def _is_place(self, name: object) -> bool:
        """Whether a result may be called so: below this folder, or a full path."""
        if not isinstance(name, str) or "\0" in name:
            return False
        place = self.path / name
        is_inside = _is_below(place, self.path) and not place.is_relative_to(self._own)
        return is_inside or Path(name).is_absolute()

    def _is_asked_for(self, name: str, json: Path | None) -> bool:
        """Whether a result belongs in this folder or in that of the JSON."""
        is_own = not Path(name).is_absolute()
        return is_own or (json is not None and _is_below(Path(name), json.absolute()))

    def _clear(self, json: Path | None) -> None:
        """Keep recorded results of an ended batch that are still to be put in place; drop the rest."""
        left = list(self._own.glob("staging-*"))
        if left:
            for record in self.records(json)[0].values():
                with contextlib.suppress(OSError):  # not in place: it will be made again
                    self.put(record.outputs)
        for folder in left:
            shutil.rmtree(folder, ignore_errors=True)

    def place(self, name: str) -> Path:
        """Where a result belongs."""
        return self.path / name

    def put(self, outputs: Iterable[Output]) -> None:
        """Put staged results in place; one that is there already stays.

        Raises
        ------
        OSError
            If one cannot be put in place.
        """
        folders = set()
        for output in outputs:
            staged = self.path / output.staged
            if output.staged and staged.is_file():
                target = self.place(output.name)
                target.parent.mkdir(parents=True, exist_ok=True)
                _move(staged, target)
                folders.add(target.parent)
        for folder in folders:
            flush_folder(folder)

    def set_aside(self, name: str) -> Path:
        """Give a result that is no longer true a name under which nobody takes it for one.

        Raises
        ------
        OSError
            If it cannot be renamed.
        """
        place = self.place(name)
        aside, number = place.with_name(f"{place.name}.old"), 1
        while os.path.lexists(aside):
            number += 1
            aside = place.with_name(f"{place.name}.old{number}")
        os.rename(place, aside)
        flush_folder(place.parent)
        return aside

    def holds(self, outputs: Iterable[Output]) -> bool:
        """Whether recorded results are in place and are those that were written."""
        try:
            return all(
                self.place(output.name).is_file()  # not a device, which has no end
                and self.place(output.name).stat().st_size == output.size
                and digest_of(self.place(output.name)) == output.sha256
                for output in outputs
            )
        except OSError:
            return False


def _is_below(place: Path, folder: Path) -> bool:
    """Whether a path lies in a folder by its words; links on the way are the owner's affair."""
    inside = place.relative_to(folder).parts if place.is_relative_to(folder) else ()
    return bool(inside) and ".." not in inside


def _move(staged: Path, target: Path) -> None:
    """Put a file in its place in one step, also on another disk."""
    try:
        replace_file(staged, target)
    except OSError as wrong:
        if wrong.errno != errno.EXDEV:
            raise
        write_whole(target, lambda made: shutil.copyfile(staged, made))
        staged.unlink()


class _Lock:
    """A lock that the system takes away when its holder ends, however it ends."""

    def __init__(self, path: Path, folder: Path) -> None:
        self._file = open(path, "a+", encoding="utf-8")
        if not _held(self._file.fileno()):
            holder = _holder(path.with_suffix(".txt"))
            self._file.close()
            raise FolderRefused(
                f"Another batch{holder} is writing to {folder}. Wait until it has ended, or name "
                "another folder with --out."
            )
        with contextlib.suppress(OSError):
            path.with_suffix(".txt").write_text(
                f"process {os.getpid()} on {platform.node()}, started "
                f"{dt.datetime.now():%Y-%m-%d %H:%M}",
                encoding="utf-8",
            )

    def release(self) -> None:
        """Let others have it."""
        self._file.close()


def _holder(path: Path) -> str:
    try:
        return f" ({path.read_text(encoding='utf-8')[:200]})"
    except OSError:
        return ""


def _held(file: int) -> bool:
    """Lock an open file for this process; False if another has it."""
    if os.name == "nt":
        import msvcrt

        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
