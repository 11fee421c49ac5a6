"""The container of a VBA project, after [MS-CFB]: a file system in a file.

Read whole and written anew, in version 3 with sectors of 512 bytes: small streams in the mini stream,
the others in sectors of their own, entries of each storage in a balanced tree.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from addin.excel.errors import CompoundFileError

_MAGIC = bytes.fromhex("D0CF11E0A1B11AE1")
_FREE, _END, _FAT, _NO_STREAM = 0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFFD, 0xFFFFFFFF
_LARGEST_SECTOR = 0xFFFFFFFA
_STORAGE, _STREAM, _ROOT = 1, 2, 5
_RED, _BLACK = 0, 1
_SECTOR, _MINI, _CUTOFF, _ENTRY = 512, 64, 4096, 128
#: Sectors of the allocation table that the header names itself; more would be 7 MB of streams.
_IN_HEADER = 109
_MOST_DEPTH = 8


@dataclass
class Storage:
    """A folder of a compound file."""

    #: Streams and storages by name.
    entries: dict[str, bytes | Storage] = field(default_factory=dict)
    class_id: bytes = bytes(16)  #: Class of the object it holds; zeros for none.
    state: int = 0  #: Its user-defined flags.

    def stream(self, *path: str) -> bytes:
        """A stream by its path.

        Raises
        ------
        CompoundFileError
            If there is none.
        """
        entry: bytes | Storage = self
        for name in path:
            entries = entry.entries if isinstance(entry, Storage) else {}
            folded = {known.casefold(): entry for known, entry in entries.items()}
            if name.casefold() not in folded:
                raise CompoundFileError(f"The VBA project has no stream {'/'.join(path)}.")
            entry = folded[name.casefold()]
        if isinstance(entry, Storage):
            raise CompoundFileError(f"{'/'.join(path)} of the VBA project is not a stream.")
        return entry


# --- reading --------------------------------------------------------------------------------------


def read_compound_file(data: bytes) -> Storage:
    """Read a compound file.

    Raises
    ------
    CompoundFileError
        If it is none, or damaged.
    """
    try:
        return _Reader(data).storage(0, 0)
    except (struct.error, IndexError, UnicodeDecodeError) as problem:
        raise CompoundFileError(f"The VBA project is damaged ({problem}).") from problem


class _Reader:
    """Tables of a compound file while it is read."""

    def __init__(self, data: bytes) -> None:
        if data[:8] != _MAGIC:
            raise CompoundFileError("The VBA project is not a compound file.")
        self._data = data
        version, _, shift, mini_shift = struct.unpack_from("<4H", data, 26)
        if (version, shift) not in ((3, 9), (4, 12)) or mini_shift != 6:
            raise CompoundFileError("The VBA project is a compound file of an unknown version.")
        self._size = 1 << shift
        self._long = version == 4
        (_, directory, _, cutoff, mini_table, _, more, _) = struct.unpack_from("<8I", data, 44)
        self._cutoff = cutoff
        self._table = self._allocation(more)
        self._mini_table = self._numbers(self._chain(mini_table))
        self._directory = self._chain(directory)
        first, size = self._place(0)
        self._mini = self._chain(first)[:size]

    def _sector(self, number: int) -> bytes:
        start = (number + 1) * self._size
        content = self._data[start : start + self._size]
        if number > _LARGEST_SECTOR or not content:
            raise CompoundFileError("The VBA project is damaged (a sector is missing).")
        return content.ljust(self._size, b"\0")

    def _numbers(self, data: bytes) -> tuple[int, ...]:
        return struct.unpack(f"<{len(data) // 4}I", data[: len(data) // 4 * 4])

    def _allocation(self, more: int) -> tuple[int, ...]:
        sectors = [*struct.unpack_from(f"<{_IN_HEADER}I", self._data, 76)]
        seen = set()
        while more <= _LARGEST_SECTOR:
            if more in seen:
                raise CompoundFileError("The VBA project is damaged (circular table).")
            seen.add(more)
            *some, more = self._numbers(self._sector(more))
            sectors += some
        return self._numbers(b"".join(self._sector(s) for s in sectors if s <= _LARGEST_SECTOR))

    @staticmethod
    def _links(first: int, table: tuple[int, ...]) -> Iterator[int]:
        for _ in range(len(table) + 1):
            if first == _END:
                return
            yield first
            first = table[first]
        raise CompoundFileError("The VBA project is damaged (circular stream).")

    def _chain(self, first: int) -> bytes:
        if first == _FREE:
            return b""
        return b"".join(self._sector(s) for s in self._links(first, self._table))

    def _place(self, entry: int) -> tuple[int, int]:
        first, size = struct.unpack_from("<IQ", self._directory, entry * _ENTRY + 116)
        return first, size if self._long else size & 0xFFFFFFFF

    def _content(self, entry: int) -> bytes:
        first, size = self._place(entry)
        if size >= self._cutoff:
            data = self._chain(first)
        elif size == 0:
            return b""
        else:
            places = (m * _MINI for m in self._links(first, self._mini_table))
            data = b"".join(self._mini[p : p + _MINI] for p in places)
        if len(data) < size:
            raise CompoundFileError("The VBA project is damaged (a stream is too short).")
        return data[:size]

    def storage(self, entry: int, depth: int) -> Storage:
        """A storage with all that it holds; entry 0 is the root."""
        if depth > _MOST_DEPTH:
            raise CompoundFileError("The VBA project is damaged (storages nested too deeply).")
        at = entry * _ENTRY
        class_id = self._directory[at + 80 : at + 96]
        (child,) = struct.unpack_from("<I", self._directory, at + 76)
        (state,) = struct.unpack_from("<I", self._directory, at + 96)
        storage = Storage({}, class_id, state)
        for number in self._siblings(child):
            at = number * _ENTRY
            (length,) = struct.unpack_from("<H", self._directory, at + 64)
            name = self._directory[at : at + max(length - 2, 0)].decode("utf-16-le")
            kind = self._directory[at + 66]
            if kind == _STORAGE:
                storage.entries[name] = self.storage(number, depth + 1)
            elif kind == _STREAM:
                storage.entries[name] = self._content(number)
        return storage

    def _siblings(self, first: int) -> Iterator[int]:
        waiting, seen = [first], set()
        while waiting:
            entry = waiting.pop()
            if entry == _NO_STREAM:
                continue
            if entry in seen:
                raise CompoundFileError("The VBA project is damaged (circular directory).")
            seen.add(entry)
            waiting += struct.unpack_from("<II", self._directory, entry * _ENTRY + 68)
            yield entry


# --- writing --------------------------------------------------------------------------------------


@dataclass
class _Entry:
    """A line of the directory."""

    name: str
    kind: int
    data: bytes = b""
    class_id: bytes = bytes(16)
    state: int = 0
    colour: int = _BLACK
    left: int = _NO_STREAM
    right: int = _NO_STREAM
    child: int = _NO_STREAM
    start: int = 0
    size: int = 0

    def packed(self) -> bytes:
        name = self.name.encode("utf-16-le") + b"\0\0"
        if len(name) > 64:
            raise CompoundFileError(
                f"The name {self.name} is too long for a part of a VBA project."
            )
        return (
            name.ljust(64, b"\0")
            + struct.pack("<HBB", len(name), self.kind, self.colour)
            + struct.pack("<III", self.left, self.right, self.child)
            + self.class_id
            + struct.pack("<IQQIQ", self.state, 0, 0, self.start, self.size)
        )


_UNUSED = bytes(68) + struct.pack("<III", _NO_STREAM, _NO_STREAM, _NO_STREAM) + bytes(_ENTRY - 80)


def write_compound_file(root: Storage) -> bytes:
    """Write a compound file.

    Raises
    ------
    CompoundFileError
        If a name is too long, or all is larger than a VBA project ever is.
    """
    entries = [_Entry("Root Entry", _ROOT, class_id=root.class_id, state=root.state)]
    entries[0].child = _add(entries, root)
    sectors: list[bytes] = []
    table: list[int] = []

    def put(data: bytes) -> int:
        if not data:
            return _END
        start = len(sectors)
        count = -(-len(data) // _SECTOR)
        sectors.extend(
            data[i * _SECTOR : (i + 1) * _SECTOR].ljust(_SECTOR, b"\0") for i in range(count)
        )
        table.extend([*range(start + 1, start + count), _END])
        return start

    mini, mini_table = bytearray(), list[int]()
    for entry in entries:
        if entry.kind != _STREAM:
            continue
        entry.size = len(entry.data)
        if entry.size >= _CUTOFF:
            entry.start = put(entry.data)
        elif not entry.data:
            entry.start = _END
        else:
            entry.start = len(mini_table)
            count = -(-entry.size // _MINI)
            mini_table += [*range(entry.start + 1, entry.start + count), _END]
            mini += entry.data.ljust(count * _MINI, b"\0")
    entries[0].size, entries[0].start = len(mini), put(bytes(mini))
    links = _numbers(mini_table)
    mini_start = put(links)
    directory = b"".join(entry.packed() for entry in entries)
    directory += _UNUSED * (-len(entries) % (_SECTOR // _ENTRY))
    directory_start = put(directory)
    return _assembled(sectors, table, directory_start, mini_start, len(links) // _SECTOR)


def _assembled(
    sectors: list[bytes], table: list[int], directory: int, mini: int, mini_sectors: int
) -> bytes:
    """Header, sectors and the allocation table at the end."""
    per_sector = _SECTOR // 4
    count = 1
    while count * per_sector < len(sectors) + count:
        count += 1
    if count > _IN_HEADER:
        raise CompoundFileError("The VBA project is too large (above 7 MB).")
    first = len(sectors)
    links = _numbers([*table, *[_FAT] * count])
    header = _MAGIC + bytes(16) + struct.pack("<5H", 0x3E, 3, 0xFFFE, 9, 6) + bytes(6)
    header += struct.pack("<9I", 0, count, directory, 0, _CUTOFF, mini, mini_sectors, _END, 0)
    named = [first + i if i < count else _FREE for i in range(_IN_HEADER)]
    return header + struct.pack(f"<{_IN_HEADER}I", *named) + b"".join(sectors) + links


def _numbers(values: list[int]) -> bytes:
    """Numbers in whole sectors, unused ones marked free."""
    per_sector = _SECTOR // 4
    padded = values + [_FREE] * (-len(values) % per_sector)
    return struct.pack(f"<{len(padded)}I", *padded)


def _order(name: str) -> tuple[int, bytes]:
    """Short names first, equally long ones by their capitals: a program searches by this order."""
    capitals = "".join(c.upper() if len(c.upper()) == 1 else c for c in name)
    return len(name.encode("utf-16-le")), capitals.encode("utf-16-be")


def _add(entries: list[_Entry], storage: Storage) -> int:
    """Enter what a storage holds; the root of its tree."""
    numbers = []
    for name in sorted(storage.entries, key=_order):
        held = storage.entries[name]
        numbers.append(len(entries))
        if isinstance(held, bytes):
            entries.append(_Entry(name, _STREAM, held))
            continue
        entries.append(_Entry(name, _STORAGE, class_id=held.class_id, state=held.state))
        entry = entries[-1]
        entry.child = _add(entries, held)
    last = len(numbers).bit_length() - 1

    def tree(some: list[int], level: int) -> int:
        """A tree of halves: all levels full but the last, whose entries are red."""
        if not some:
            return _NO_STREAM
        middle = len(some) // 2
        top = entries[some[middle]]
        top.colour = _RED if level == last and level > 0 else _BLACK
        top.left = tree(some[:middle], level + 1)
        top.right = tree(some[middle + 1 :], level + 1)
        return some[middle]

    return tree(numbers, 0)
