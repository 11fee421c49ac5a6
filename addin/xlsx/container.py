"""The zip file of a workbook: pre-flight guards, reading within limits, and writing with untouched entries copied raw.

Nothing is inflated before the directory of the archive has passed the guards, and nothing is inflated beyond the size
that the directory states (the limits of `Limits` therefore hold even when a header lies).
"""

from __future__ import annotations

import hashlib
import io
import re
import stat
import struct
import sys
import zipfile
import zlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from addin.xlsx.errors import WorkbookRefused, damaged
from addin.xlsx.strict import in_ordinary_dialect, starts_in_1904
from addin.xlsx.xml_part import Element, has_misleading_tags, in_utf8, is_utf8, parse_part

_OLE_MAGIC = bytes.fromhex("D0CF11E0A1B11AE1")
_ZIP_MAGIC = b"PK\x03\x04"
_UTF8_FLAG = 0x800
_ENCRYPTED_FLAG = 0x1
_LONG_PART = 32 * 2**10
_FIXED_DATE = (1980, 1, 1, 0, 0, 0)

# What reading an archive raises when its bytes are not what its headers say.
_UNPACKING = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    ValueError,
    OverflowError,
    NotImplementedError,
    RuntimeError,
)

#: What a mark takes, and how much text comes with it in cells of numbers; each byte of text beyond takes six. [byte]
_MARK_SIZE, _TEXT_OF_MARK, _SIZE_OF_TEXT = 150, 8, 6

_CELLS_BEGIN = re.compile(rb"<(\w+:)?sheetData>")

_LOCAL_HEADER = struct.Struct("<4s5H3L2H")
_CENTRAL_HEADER = struct.Struct("<4s4B4H3L5H2L")
_END_RECORD = struct.Struct("<4s4H2LH")


@dataclass(frozen=True)
class Limits:
    """What is still taken for a workbook and not for an attack."""

    #: Largest file, sum of all inflated parts and single inflated part. [byte]
    file_size: int = 100 * 2**20
    total_size: int = 500 * 2**20  #: Likewise. [byte]
    part_size: int = 100 * 2**20  #: Likewise. [byte]
    #: Sum of the parts that are inflated here; pictures and the like stay packed. [byte]
    inflated: int = 150 * 2**20
    #: Sum of brackets and twice the equal signs of the parts that are parsed, each of which costs some 150 bytes of memory,
    #: and five for each row; 300,000 cells have about as many. What else takes memory counts as so many of them: the file,
    #: which is there as it was and as it is written, the parts that are read, and long texts. In the strict dialect, all
    #: parts have no more together.
    marks: int = 2_500_000
    #: Likewise of what is no cell: the workbook part, and what sheets hold beside their cells. Its elements take several
    #: times the memory of a cell; 100,000 names or merged ranges have about as many.
    other_marks: int = 400_000
    texts: int = 32 * 2**20  #: Largest part of shared texts. [byte]
    #: Sum of the XML parts of a workbook in the strict dialect, all of which are read. [byte]
    strict: int = 32 * 2**20
    entries: int = 5_000  #: Largest number of parts.
    #: Largest inflated/stored ratio of a part above ``ratio_from``; ordinary sheets reach 10 to
    #: 20.
    ratio: int = 200
    ratio_from: int = 2**20  #: Parts below this inflated size may have any ratio. [byte]


DEFAULT_LIMITS = Limits()


class Container:
    """One workbook file, read whole into memory, with its parts.

    Parameters
    ----------
    path : Path
        The file.
    limits : Limits, optional
        Guards against archives that are not workbooks.

    Raises
    ------
    WorkbookRefused
        Each guard with its own reason.
    """

    def __init__(self, path: Path, limits: Limits = DEFAULT_LIMITS) -> None:
        self.path = path
        #: The file as it was read.
        self.file = read_file(path, limits.file_size)
        self.sha256 = hashlib.sha256(self.file).hexdigest()
        self.limits = limits
        #: Whether it was saved as 'Strict Open XML Spreadsheet'.
        self.was_strict = False
        _check_magic(self.file, path)
        try:
            self._take(self.file)
        except _UNPACKING as problem:
            raise _damaged(
                path, "it is truncated, or its table of contents is damaged"
            ) from problem
        _check_directory(self.entries, path, limits)
        _check_places(self.entries, self.data, self._zip.start_dir, path)
        self._inflated_size = 0
        #: What counts against the limits of these names, so far.
        self.marks = 2 * len(self.file) // _MARK_SIZE
        self.other_marks = 0

    def _take(self, data: bytes) -> None:
        """An archive in memory."""
        #: The archive: the file, or what it is in the ordinary dialect.
        self.data = data
        self._zip = zipfile.ZipFile(io.BytesIO(data))
        self.entries = self._zip.infolist()
        for entry in self.entries:
            # Some programs write names with backslashes; the name in the file stays `orig_filename`.
            entry.filename = entry.orig_filename.replace("\\", "/")
        self._by_name = {entry.filename: entry for entry in self.entries}
        self._by_lower = {name.lower(): name for name in self._by_name}
        self._inflated: dict[str, bytes] = {}

    def take_ordinary_dialect(self, workbook_part: str) -> None:
        """From now on, the parts of a workbook in the strict dialect are those of an ordinary one.

        Raises
        ------
        WorkbookRefused
            ``strict`` for a part that is not in UTF-8, or more than the limit of them all.
        """
        from_1904 = starts_in_1904(self.read(workbook_part))
        replaced: dict[str, bytes] = {}
        marks = 0
        names = [name for name in self.names if name.lower().endswith((".xml", ".rels"))]
        if sum(self._by_name[name].file_size for name in names) > self.limits.strict:
            raise self._refused_strict(f"and has more than {self.limits.strict // 2**20} MB of it")
        for name in names:
            data = self.read(name)
            if not is_utf8(data):
                raise self._refused_strict(
                    f"with the part {shown_name(name)} in another encoding than UTF-8"
                )
            # A percentage or a date takes as long as five more marks.
            marks += _marks(data) + 5 * (data.count(b"%") + data.count(b'"d"') + data.count(b"'d'"))
            if marks > self.limits.marks:
                raise self._refused_strict("and has more than about 300,000 cells of it")
            replaced[name] = in_ordinary_dialect(data, from_1904=from_1904)
            del self._inflated[name]
        made = io.BytesIO()
        self.write(made, replaced)
        self._take(made.getvalue())
        self._inflated_size = 0
        self.marks += len(self.data) // _MARK_SIZE
        self.was_strict = True

    def _refused_strict(self, what: str) -> WorkbookRefused:
        return WorkbookRefused(
            "strict",
            f"{self.path.name} is saved as 'Strict Open XML Spreadsheet', {what}. Save it as the ordinary 'Excel workbook "
            "(.xlsx)' and run again.",
        )

    @property
    def names(self) -> list[str]:
        """Names of all parts in the order of the file."""
        return list(self._by_name)

    def find(self, name: str) -> str | None:
        """Stored name of a part (part names ignore case), None when absent."""
        return name if name in self._by_name else self._by_lower.get(name.lower())

    def read(self, name: str) -> bytes:
        """A part, inflated and checked against its CRC; one of XML in UTF-16 as it is in UTF-8.

        Raises
        ------
        WorkbookRefused
            ``damaged`` when it is not there or does not inflate, ``bomb`` when too much would have been inflated.
        """
        if name not in self._inflated:
            entry = self._by_name.get(name)
            if entry is None or entry.is_dir():
                raise _damaged(self.path, f"it lacks the part {shown_name(name)}")
            self._inflated_size += entry.file_size
            if self._inflated_size > self.limits.inflated:
                raise WorkbookRefused(
                    "bomb",
                    f"{self.path.name} would unpack to more than {self.limits.inflated // 2**20} MB of "
                    "cells and charts, the limit for a workbook. Move bulk data to another workbook.",
                )
            self._charge(name, entry.file_size // _MARK_SIZE)
            try:
                self._inflated[name] = in_utf8(inflated(self.data, entry), name)
            except _UNPACKING as problem:
                raise _damaged(
                    self.path, f"the part {shown_name(name)} cannot be unpacked"
                ) from problem
        return self._inflated[name]

    def tree(self, name: str) -> Element:
        """Root element of a part."""
        return parse_part(self.charged(name), name)

    def charged(self, name: str) -> bytes:
        """A part that is about to be parsed; refused when all parsed parts together would take too much memory."""
        data = self.read(name)
        self._charge(name, _with_texts(data, _marks(data)))
        return data

    def charged_beside_cells(self, name: str) -> bytes:
        """The same of the workbook part or a sheet, in which names, merged ranges and formats are counted by themselves."""
        data = self.read(name)
        marks, inside = _marks(data), _marks(data, *_cells_of(data))
        self.other_marks += marks - inside
        if self.other_marks > self.limits.other_marks:
            raise WorkbookRefused(
                "too large",
                f"With the part {shown_name(name)} of {self.path.name}, the workbook exceeds about 100,000 defined "
                "names, merged ranges, formats and the like, the limit of torsionbook. Remove those that nothing uses, "
                "or start from a new template.",
            )
        # A row takes as much memory as five more marks.
        rows = data.count(b"<row") + data.count(b":row ")
        self._charge(name, _with_texts(data, marks) + 5 * rows)
        return data

    def _charge(self, name: str, marks: int) -> None:
        self.marks += marks
        if self.marks > self.limits.marks:
            raise WorkbookRefused(
                "too large",
                f"With the part {shown_name(name)} of {self.path.name}, the workbook exceeds about "
                "300,000 cells on sheets with inputs, results or formulas, or what takes as much memory in long texts, "
                "pictures and other sheets, the limit of torsionbook. Move bulk data to another workbook.",
            )

    def write(
        self,
        stream: BinaryIO,
        replaced: Mapping[str, bytes],
        dropped: Collection[str] = (),
        *,
        added: Mapping[str, bytes] | None = None,
        compress: bool = True,
        slashes: bool = False,
    ) -> None:
        """Write the workbook with some parts replaced, some left out and some added.

        Every other entry is copied as it is stored. Dates, attributes and order are copied too, hence equal input gives
        equal bytes.

        Parameters
        ----------
        stream : binary file
            Where to write; only written forward.
        replaced : mapping of str to bytes
            New content of parts, by stored name.
        dropped : collection of str
            Parts to leave out.
        added : mapping of str to bytes, optional
            New parts, which come last.
        compress : bool
            Whether replaced parts are compressed or merely stored.
        slashes : bool
            Whether names with backslashes get slashes, which most readers of workbooks demand.
        """
        directory: list[bytes] = []
        position = 0
        new_content = {**replaced, **(added or {})}
        for entry in (*self.entries, *map(_new_entry, added or ())):
            if entry.filename in dropped:
                continue
            name = entry.filename if slashes else entry.orig_filename
            payload: bytes | memoryview
            if entry.filename in new_content:
                local, central, payload = _packed_entry(
                    entry, name, new_content[entry.filename], compress, position
                )
            else:
                payload = stored_bytes(self.data, entry)
                sizes = (entry.CRC, len(payload), entry.file_size)
                local, central = _headers(entry, name, entry.compress_type, sizes, position)
            stream.write(local)
            stream.write(payload)
            directory.append(central)
            position += len(local) + len(payload)
        _write_directory(stream, directory, position, self._zip.comment)


def read_file(path: Path, limit: int = DEFAULT_LIMITS.file_size) -> bytes:
    """All bytes of a file, refusing what is too large or not readable.

    Raises
    ------
    WorkbookRefused
        ``missing``, ``unreadable`` or ``too large``.
    """
    try:
        about = path.stat()
        if not (stat.S_ISREG(about.st_mode) or stat.S_ISDIR(about.st_mode)):
            # A device or a pipe may never end.
            raise WorkbookRefused(
                "unreadable", f"{path} is a device or a pipe, not a workbook. Name a workbook."
            )
        if stat.S_ISDIR(about.st_mode):  # Windows would say that it may not be read
            raise IsADirectoryError(path)
        if about.st_size > limit:
            raise WorkbookRefused(
                "too large",
                f"{path.name} is larger than {limit // 2**20} MB, the limit for a workbook. Move "
                "bulk data to another workbook.",
            )
        return path.read_bytes()
    except ValueError as problem:
        raise WorkbookRefused(
            "missing", f"{str(path)!r} is not a valid file name. Name the workbook."
        ) from problem
    except FileNotFoundError as problem:
        raise WorkbookRefused("missing", f"{path} does not exist. Check the path.") from problem
    except IsADirectoryError as problem:
        raise WorkbookRefused(
            "unreadable",
            f"{path} is a folder, not a workbook. Name the workbooks in it, such as {path / '*.xlsx'}; "
            f"torsionbook batch {path} --out results calculates them all.",
        ) from problem
    except PermissionError as problem:
        raise WorkbookRefused(
            "unreadable",
            f"{path} cannot be read. Close it in the spreadsheet program, or ask for read "
            "permission.",
        ) from problem


def stored_bytes(archive: bytes, entry: zipfile.ZipInfo) -> memoryview:
    """Compressed bytes of an entry inside an archive held in memory."""
    start = entry.header_offset
    name_length, extra_length = struct.unpack_from("<HH", archive, start + 26)
    begin = start + _LOCAL_HEADER.size + name_length + extra_length
    return memoryview(archive)[begin : begin + entry.compress_size]


def inflated(archive: bytes, entry: zipfile.ZipInfo) -> bytes:
    """An entry of an archive held in memory, checked against the size and the check sum that its directory states."""
    stored = stored_bytes(archive, entry)
    if entry.compress_type == zipfile.ZIP_DEFLATED:
        # Not a byte beyond the size, which may be a lie; 0 would mean any.
        packed = zlib.decompressobj(-15)
        data = packed.decompress(stored, entry.file_size) if entry.file_size else b""
    else:
        data = bytes(stored)
    if len(data) != entry.file_size or zlib.crc32(data) != entry.CRC:
        raise zipfile.BadZipFile("size or check sum are not those that its directory states")
    return data


def _check_magic(data: bytes, path: Path) -> None:
    if data.startswith(_OLE_MAGIC):
        # An encrypted workbook is an OLE file with a stream of this name (UTF-16); anything else OLE is the old format.
        if "EncryptedPackage".encode("utf-16-le") in data:
            raise WorkbookRefused(
                "encrypted",
                f"{path.name} is encrypted with a password. Save a copy without the password and run again.",
            )
        raise WorkbookRefused(
            "xls",
            f"{path.name} is in the old .xls format. Save it as Excel workbook (.xlsx) and run again.",
        )
    if not data:
        raise WorkbookRefused("empty", f"{path.name} is empty.")
    if not data.startswith(_ZIP_MAGIC):
        raise WorkbookRefused(
            "not a workbook",
            f"{path.name} is not an Excel workbook (.xlsx or .xlsm). Name a workbook.",
        )


def _check_directory(entries: list[zipfile.ZipInfo], path: Path, limits: Limits) -> None:
    if len(entries) > limits.entries:
        raise WorkbookRefused(
            "too many parts",
            f"{path.name} contains {len(entries)} parts; a workbook has fewer than {limits.entries}.",
        )
    seen: set[str] = set()
    total = 0
    for entry in entries:
        _check_name(entry, seen, path)
        _check_size(entry, path, limits)
        total += entry.file_size
    if total > limits.total_size:
        raise WorkbookRefused(
            "bomb",
            f"{path.name} would unpack to {total // 2**20} MB; the limit is "
            f"{limits.total_size // 2**20} MB.",
        )


def _check_places(entries: list[zipfile.ZipInfo], data: bytes, directory: int, path: Path) -> None:
    """Each entry must stand in the file under its own name, before the directory, and none within another.

    Entries that share bytes are how a small file unpacks to an enormous one.
    """
    end = 0
    for entry in sorted(entries, key=lambda one: one.header_offset):
        start = entry.header_offset
        if (
            start < 0
            or start + _LOCAL_HEADER.size > len(data)
            or data[start : start + 4] != _ZIP_MAGIC
        ):
            raise _damaged(
                path, f"the part {shown_name(entry.filename)} is at a wrong position in the file"
            )
        if start < end:
            raise WorkbookRefused(
                "overlap",
                f"{path.name} contains the part {shown_name(entry.filename)} inside another one, "
                "unlike any normal workbook, and is not opened. Save it again in the spreadsheet "
                "program.",
            )
        name_length, extra_length = struct.unpack_from("<HH", data, start + 26)
        begin = start + _LOCAL_HEADER.size
        end = begin + name_length + extra_length + entry.compress_size
        if end > directory:
            raise _damaged(path, f"the part {shown_name(entry.filename)} is cut off")
        encoding = "utf-8" if entry.flag_bits & _UTF8_FLAG else "cp437"
        if data[begin : begin + name_length] != entry.orig_filename.encode(encoding):
            raise _damaged(path, f"the part {shown_name(entry.filename)} has two different names")


def _cells_of(data: bytes) -> tuple[int, int]:
    """Where the cells of a sheet begin and end; nowhere in a part that has none.

    Where comments or another encoding than UTF-8 hide its tags, all of a sheet counts as beside its cells.
    """
    begin = None if has_misleading_tags(data) else _CELLS_BEGIN.search(data)
    if begin is None:
        return 0, 0
    closing = b"</%ssheetData>" % (begin[1] or b"")
    end = data.find(closing, begin.end())
    return (0, 0) if end < 0 else (begin.start(), end + len(closing))


def _marks(data: bytes, begin: int = 0, end: int = sys.maxsize) -> int:
    return data.count(b"<", begin, end) + 2 * data.count(b"=", begin, end)


def _with_texts(data: bytes, marks: int) -> int:
    """Marks of a part, and what its texts take beyond that of numbers."""
    return marks + max(0, len(data) - _TEXT_OF_MARK * marks) * _SIZE_OF_TEXT // _MARK_SIZE


def shown_name(name: str) -> str:
    """A name out of the file as it may stand in a sentence."""
    return repr(name if len(name) <= 80 else name[:77] + "...")


def _check_name(entry: zipfile.ZipInfo, seen: set[str], path: Path) -> None:
    name = entry.filename
    if name.startswith("/") or ":" in name or "\0" in name or ".." in name.split("/"):
        raise WorkbookRefused(
            "path",
            f"{path.name} contains a part named {shown_name(name)}, which points outside the "
            "workbook, and is not opened. Check where the file comes from.",
        )
    if name.lower() in seen:
        raise WorkbookRefused(
            "duplicate part",
            f"{path.name} contains the part {shown_name(name)} twice, so programs may read different content from it. "
            "Open it in the spreadsheet program and save it again.",
        )
    seen.add(name.lower())
    if entry.flag_bits & _ENCRYPTED_FLAG:
        raise WorkbookRefused(
            "encrypted", f"{path.name} is an encrypted archive. Save a copy without encryption."
        )
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise WorkbookRefused(
            "compression",
            f"{path.name} uses a compression that workbooks do not use. Save it again in the "
            "spreadsheet program.",
        )


def _check_size(entry: zipfile.ZipInfo, path: Path, limits: Limits) -> None:
    too_big = entry.file_size > limits.part_size
    packed_too_well = entry.file_size > limits.ratio_from and entry.file_size > limits.ratio * max(
        entry.compress_size, 1
    )
    if too_big or packed_too_well:
        raise WorkbookRefused(
            "bomb",
            f"The part {shown_name(entry.filename)} of {path.name} would unpack from "
            f"{entry.compress_size} to {entry.file_size} bytes, as in an attack file, and is not "
            "opened. Check where the file comes from.",
        )


def _damaged(path: Path, detail: str) -> WorkbookRefused:
    return damaged(f"{path.name} is damaged ({detail}).")


def _new_entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _FIXED_DATE)
    entry.create_system = 0  # the same bytes on every system
    return entry


def _packed_entry(
    entry: zipfile.ZipInfo, name: str, data: bytes, compress: bool, position: int
) -> tuple[bytes, bytes, bytes]:
    if compress:
        # Long number blocks shrink by a further seventh at four times the time; that is not worth it.
        level = 6 if len(data) <= _LONG_PART else 1
        packer = zlib.compressobj(level, zlib.DEFLATED, -15)
        method, payload = zipfile.ZIP_DEFLATED, packer.compress(data) + packer.flush()
    else:
        method, payload = zipfile.ZIP_STORED, data
    sizes = (zlib.crc32(data), len(payload), len(data))
    local, central = _headers(entry, name, method, sizes, position)
    return local, central, payload


def _headers(
    entry: zipfile.ZipInfo, name: str, method: int, sizes: tuple[int, int, int], position: int
) -> tuple[bytes, bytes]:
    """Local and central header of an entry; sizes are (CRC, stored, inflated)."""
    utf8 = bool(entry.flag_bits & _UTF8_FLAG)
    # Directory names come decoded from one of these two encodings.
    encoded = name.encode("utf-8" if utf8 else "cp437")
    flags = _UTF8_FLAG if utf8 else 0
    year, month, day, hour, minute, second = (
        entry.date_time if entry.date_time[0] >= 1980 else _FIXED_DATE
    )
    date = (year - 1980) << 9 | month << 5 | day
    time = hour << 11 | minute << 5 | second // 2
    common = (flags, method, time, date, *sizes, len(encoded), 0)
    local = _LOCAL_HEADER.pack(_ZIP_MAGIC, 20, *common) + encoded
    central = _CENTRAL_HEADER.pack(
        b"PK\x01\x02", entry.create_version, entry.create_system, 20, 0, *common,
        len(entry.comment), 0, entry.internal_attr, entry.external_attr, position,
    )  # fmt: skip
    return local, central + encoded + entry.comment


def _write_directory(
    stream: BinaryIO, directory: list[bytes], position: int, comment: bytes
) -> None:
    for central in directory:
        stream.write(central)
    size = sum(map(len, directory))
    count = len(directory)
    stream.write(
        _END_RECORD.pack(b"PK\x05\x06", 0, 0, count, count, size, position, len(comment)) + comment
    )
