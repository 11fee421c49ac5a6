"""Writing the file: whole or not at all.

Order of events: build the new package in memory; write it beside the destination; flush it to the disk; read it back and
compare; check that nobody changed the original meanwhile; keep a copy of the original if it is to be replaced; replace in
one step; flush the folder. Whatever goes wrong before the last but one step leaves the original as it was; what goes wrong
in the last is a note, as the file is there.
"""

from __future__ import annotations

import io
import os
import stat
import zipfile
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from addin.xlsx.container import Container, stored_bytes
from addin.xlsx.errors import SaveRefused, SourceChanged
from addin.xlsx.formulas import CacheReport
from addin.xlsx.locks import check_not_open
from addin.xlsx.places import (
    real_path,
    refuse_open_elsewhere,
    refuse_strange_name,
    replace_file,
    take_rights,
)
from addin.xlsx.temporary import temporary_file
from addin.xlsx.whole_files import flush_folder

_PIECE = 2**20

Check = Callable[[Mapping[str, bytes]], list[str]]


@dataclass(frozen=True)
class SaveReport:
    """What was written."""

    path: Path  #: The file.
    backup: Path | None  #: Copy of the original, when it was replaced.
    #: Parts that are new or differ from the original; all others are byte-identical.
    parts: tuple[str, ...]
    #: Parts left out (the calculation chain, which spreadsheet programs make anew).
    dropped: tuple[str, ...]
    caches: CacheReport  #: What was done about the cached values of formulas.
    notes: tuple[str, ...] = ()  #: What the user should know, in sentences.


@dataclass(frozen=True)
class PackageChange:
    """How the parts of the new file differ from those of the original."""

    replaced: Mapping[str, bytes]  #: Parts with other content.
    dropped: Collection[str] = ()  #: Parts left out.
    added: Mapping[str, bytes] = field(default_factory=dict)  #: New parts.


@dataclass(frozen=True)
class Destination:
    """Where the new file goes, and what keeps it from being written."""

    path: Path | None  #: The file; None with ``in_place``.
    in_place: bool  #: Replace the original, of which a copy stays.
    read_only: bool = False  #: Whether the original was opened for reading only.
    ignore_lock: bool = False  #: Write although a lock file says that somebody has it open.
    suffix: str = ""  #: Ending that the file must have; empty = that of the original.
    keep_backups: bool = False  #: Keep earlier copies of the original, too.
    #: Keep a copy of another file that is replaced there, too.
    keep_replaced: bool = False


class Delivered(NamedTuple):
    """A file that is in its place."""

    backup: Path | None  #: Copy of what stood there; None where nothing did.
    notes: tuple[str, ...]  #: What the user should know, in sentences.


def save_package(
    container: Container,
    change: PackageChange,
    destination: Destination,
    *,
    check: Check,
    caches: CacheReport,
    notes: tuple[str, ...] = (),
) -> SaveReport:
    """Write a changed package.

    Raises
    ------
    SaveRefused
        When nothing was written, with the reason.
    """
    target = _free_target(container, destination)
    payload = io.BytesIO()
    container.write(payload, change.replaced, change.dropped, added=change.added)
    package = payload.getvalue()
    _verify(container, package, change, check)
    delivered = _deliver(container, package, target, destination)
    return SaveReport(
        target,
        delivered.backup,
        tuple(sorted([*change.replaced, *change.added])),
        tuple(sorted(change.dropped)),
        caches,
        (*notes, *delivered.notes),
    )


def put_in_place(container: Container, made: Path, destination: Destination) -> Delivered:
    """Put a workbook that was made of another one, step by step, where it belongs.

    Parameters
    ----------
    container : Container
        The workbook that it was made of, as it was opened.
    made : Path
        The finished file. [path]
    destination : Destination
        Where it goes, as in `save_package`.

    Returns
    -------
    Delivered
        Copy of what stood there, and notes.

    Raises
    ------
    SaveRefused
        When nothing was written, with the reason.
    """
    target = _free_target(container, destination)
    return _deliver(container, made.read_bytes(), target, destination)


def _free_target(container: Container, destination: Destination) -> Path:
    """Where the new file goes, if it may; the original must still be what was opened."""
    target = _target(container.path, destination)
    if not destination.ignore_lock:
        check_not_open(target)
    _check_source(container)
    return target


def _deliver(
    container: Container, package: bytes, target: Path, destination: Destination
) -> Delivered:
    """Write a package in one step; keep a copy of what stood there."""
    with _beside(target, package, _mode(target, container.path), target) as temporary:
        if not _holds(temporary, package):
            raise SaveRefused(
                f"{target.name} was not written: the disk returned wrong data when read back. Check "
                "the disk."
            )
        _check_source(container)
        backup = None
        if destination.in_place or (destination.keep_replaced and target.exists()):
            with _putting(target):  # before the copy, which replaces an earlier one
                refuse_open_elsewhere(target)
            kept = container.file if destination.in_place else target.read_bytes()
            backup = _keep(kept, target, destination.keep_backups)
        notes = _put(temporary, target)
    return Delivered(backup, notes)


def _target(source: Path, destination: Destination) -> Path:
    path, in_place = destination.path, destination.in_place
    suffix = destination.suffix or source.suffix
    if destination.read_only:
        raise SaveRefused(f"{source.name} was opened read-only.")
    if path is None and not in_place:
        raise SaveRefused("No file to write was named.")
    # The link of a workbook in place is followed, so that the file behind it is replaced and the link stays. Where a
    # result goes, a link may lead to what nobody meant.
    if path is not None and not in_place and Path(path).is_symlink():
        raise SaveRefused(
            f"{path} is a link to another file, which is not replaced. Remove the link, or name another file."
        )
    if path is not None:
        _refuse_strange_name(Path(path))  # as typed: where a device leads is no name
    original = real_path(source)
    target = original if path is None else real_path(Path(path))
    if target == original and not in_place:
        raise SaveRefused(
            f"{source.name} is the file that was opened; use --in-place to replace it."
        )
    if target != original and in_place:
        raise SaveRefused(f"{source.name} is to be replaced, but the file named is {target.name}.")
    if target.suffix.lower() != suffix.lower():
        what = (
            "the file type of the workbook does not change"
            if suffix == source.suffix
            else "it has that file type"
        )
        raise SaveRefused(
            f"{target.name} must end in {suffix}: {what}, and Excel does not open a file with a "
            "wrong extension."
        )
    if target.exists() and not target.is_file():
        raise SaveRefused(f"{target.name} is a folder, a device or a pipe. Name another file.")
    if target.exists() and not os.access(target, os.W_OK):
        raise SaveRefused(
            f"{target.name} is write-protected. Remove the protection or name another file."
        )
    return target


def _refuse_strange_name(path: Path) -> None:
    try:
        refuse_strange_name(path)
    except OSError as problem:
        raise SaveRefused(f"{path.name} {problem.strerror}. Name another file.") from problem


def _verify(container: Container, package: bytes, change: PackageChange, check: Check) -> None:
    """Compare the new package with the old one, part by part, and read the written cells again."""
    archive = zipfile.ZipFile(io.BytesIO(package))
    entries = {entry.orig_filename.replace("\\", "/"): entry for entry in archive.infolist()}
    expected = [name for name in container.names if name not in change.dropped]
    if list(entries) != [*expected, *change.added]:
        raise SaveRefused(
            "Nothing was written: parts of the original would be missing in the new workbook. "
            "Please report it."
        )
    parts: dict[str, bytes] = {}
    for entry in container.entries:
        name = entry.filename
        if name in change.replaced:
            parts[name] = archive.read(entries[name])
        # Equal stored bytes, sizes and check sum: the part inflates to the same bytes as before.
        elif name not in change.dropped and not _identical(
            container, entry, package, entries[name]
        ):
            raise SaveRefused(
                f"Nothing was written: the part {name} would have changed. Please report it."
            )
    parts |= {name: archive.read(entries[name]) for name in change.added}
    wrong = [
        name
        for name, data in (*change.replaced.items(), *change.added.items())
        if parts.get(name) != data
    ]
    wrong += check(parts)
    if wrong:
        raise SaveRefused(
            f"Nothing was written: {', '.join(wrong[:10])} differs when read back. Please report "
            "it."
        )


def _identical(
    container: Container, old: zipfile.ZipInfo, package: bytes, new: zipfile.ZipInfo
) -> bool:
    return (old.CRC, old.file_size, old.compress_type) == (
        new.CRC,
        new.file_size,
        new.compress_type,
    ) and _are_same(stored_bytes(container.data, old), stored_bytes(package, new))


def _are_same(one: memoryview, other: memoryview) -> bool:
    """Whether two parts have the same bytes; piece by piece, as they may be large."""
    return len(one) == len(other) and all(
        bytes(one[at : at + _PIECE]) == bytes(other[at : at + _PIECE])
        for at in range(0, len(one), _PIECE)
    )


def _holds(path: Path, data: bytes) -> bool:
    """Whether a file has these bytes and no more."""
    with path.open("rb") as file:
        return all(
            file.read(_PIECE) == data[at : at + _PIECE] for at in range(0, len(data) + 1, _PIECE)
        )


def _check_source(container: Container) -> None:
    try:
        same = _holds(container.path, container.file)
    except OSError as problem:
        raise SourceChanged(
            f"Nothing was written: {container.path.name} can no longer be read ({problem.strerror}). Check "
            "the file and run again."
        ) from problem
    if not same:
        raise SourceChanged(
            f"{container.path.name} was changed by another program since it was opened; nothing "
            "was written. Run again."
        )


def _mode(target: Path, source: Path) -> int:
    like = target if target.exists() else source
    return stat.S_IMODE(like.stat().st_mode)


def _keep(data: bytes, target: Path, keep_backups: bool) -> Path:
    backup, number = target.with_name(f"{target.name}.bak"), 1
    while keep_backups and backup.exists():
        number += 1
        backup = target.with_name(f"{target.name}.bak{number}")
    with _beside(backup, data, _mode(target, target), target) as temporary:
        _put(temporary, backup)
    return backup


@contextmanager
def _beside(target: Path, data: bytes, mode: int, owned: Path) -> Iterator[Path]:
    """A file beside the target, flushed to the disk, owned as another; it takes its place or disappears."""
    try:
        handle, made = temporary_file(target.parent, ".tmp")
    except OSError as problem:
        raise SaveRefused(
            f"Nothing can be written in the folder {target.parent} ({problem.strerror}). Name another "
            "folder."
        ) from problem
    try:
        try:
            with open(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            take_rights(made, owned)  # which takes bits of the mode
            os.chmod(made, mode)
        except OSError as problem:
            raise SaveRefused(
                f"{target.name} could not be written ({problem.strerror}). Check the folder and free "
                "disk space."
            ) from problem
        yield made
    finally:
        made.unlink(missing_ok=True)


def _put(temporary: Path, target: Path) -> tuple[str, ...]:
    """Put a file in its place; what the user should know of it then."""
    with _putting(target):
        replace_file(temporary, target)
    doubt = flush_folder(target.parent)
    if not doubt:
        return ()
    return (
        f"{target.name} is written, but the disk did not confirm it ({doubt}): should the power fail now, the file "
        "before it may be back. Check the disk.",
    )


@contextmanager
def _putting(target: Path) -> Iterator[None]:
    try:
        yield
    except PermissionError as problem:
        raise SaveRefused(
            f"{target.name} could not be replaced; it is probably open in Excel. Close it there and run again."
        ) from problem
    except OSError as problem:
        raise SaveRefused(
            f"{target.name} could not be replaced ({problem.strerror}). Name another file."
        ) from problem
