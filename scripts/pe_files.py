"""Names that Windows libraries and programs take from others and give: just enough of the PE format."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

AMD64 = 0x8664
#: Of the data directories.
EXPORTS, IMPORTS, DELAYED = 0, 1, 13


@dataclass(frozen=True)
class PeFile:
    """A library or program for 64-bit Windows."""

    data: bytes

    @classmethod
    def read(cls, path: Path) -> PeFile:
        """Raises `ValueError` where the file is none for x86-64."""
        data = path.read_bytes()
        if data[:2] != b"MZ":
            raise ValueError(f"{path.name} is no program or library of Windows")
        at = struct.unpack_from("<I", data, 60)[0]
        if data[at : at + 4] != b"PE\0\0" or struct.unpack_from("<H", data, at + 4)[0] != AMD64:
            raise ValueError(f"{path.name} is not for Windows on x86-64")
        return cls(data)

    def imports(self) -> dict[str, list[str]]:
        """Functions by library (lower case), those loaded late included; functions without a name are left out."""
        found: dict[str, list[str]] = {}
        for directory, size, name_at, names_at in ((IMPORTS, 20, 12, 0), (DELAYED, 32, 4, 16)):
            start, _ = self._directory(directory)
            while start and (name := self._word(start + name_at)):
                functions = found.setdefault(self._text(name).lower(), [])
                names = self._word(start + names_at) or self._word(start + 16)
                functions += self._functions(names)
                start += size
        return found

    def exports(self) -> list[str]:
        """Functions and data that it gives, by name."""
        start, _ = self._directory(EXPORTS)
        if not start:
            return []
        count, names = self._word(start + 24), self._word(start + 32)
        return [self._text(self._word(names + 4 * i)) for i in range(count)]

    def _functions(self, table: int) -> Iterator[str]:
        while table and (entry := struct.unpack_from("<Q", self.data, self._offset(table))[0]):
            if not entry >> 63:  # else a number, not a name
                yield self._text((entry & 0x7FFFFFFF) + 2)
            table += 8

    def _headers(self) -> tuple[int, int, int]:
        """Where the optional header begins, where the sections are described, and how many there are."""
        at = struct.unpack_from("<I", self.data, 60)[0]
        sections, size = struct.unpack_from("<H12xH", self.data, at + 6)
        return at + 24, at + 24 + size, sections

    def _directory(self, number: int) -> tuple[int, int]:
        optional, _, _ = self._headers()
        if number >= struct.unpack_from("<I", self.data, optional + 108)[0]:
            return 0, 0
        start, size = struct.unpack_from("<II", self.data, optional + 112 + 8 * number)
        return start, size

    def _offset(self, address: int) -> int:
        _, first, count = self._headers()
        for i in range(count):
            size, start, stored, at = struct.unpack_from("<IIII", self.data, first + 40 * i + 8)
            if start <= address < start + max(size, stored):
                return address - start + at
        raise ValueError(f"no section holds the address {address:#x}")

    def _word(self, address: int) -> int:
        return int(struct.unpack_from("<I", self.data, self._offset(address))[0])

    def _text(self, address: int) -> str:
        at = self._offset(address)
        return self.data[at : self.data.index(b"\0", at)].decode("ascii")
