"""A UNO type library with one interface, in the binary form that LibreOffice reads (.rdb).

LibreOffice makes such files with a program of its development kit, which users do not have. The
form is small: eight bytes that name it, where the outermost map stands and how many entries it has,
then the maps. All numbers are little-endian, 32 bits unless said.

==========  ===================================================================================
map         entries of two offsets, to a name (ASCII, ended by 0) and to what it names;
            sorted by name
module      byte 0, number of entries, the map itself
interface   byte 5; bases: number, names; optional bases; attributes; methods
method      name, type of the answer; parameters: number, each byte 0 (in), name, type;
            exceptions: number, names
text        length, bytes
==========  ===================================================================================

``any`` is a type, ``[][]any`` a sequence of sequences of it. Unlike the older form, which
LibreOffice reads as well, it has no blocks and no checksums.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

MAGIC = b"UNOIDL\xff\x00"
MODULE, INTERFACE, IN = b"\x00", b"\x05", b"\x00"
BASE = "com.sun.star.uno.XInterface"


@dataclass(frozen=True)
class Method:
    """A method of the interface."""

    name: str  #: Its name.
    answer: str  #: Type of what it returns. [type]
    #: Name and type of each; all go in only. [names, types]
    parameters: tuple[tuple[str, str], ...]


def type_library(modules: Sequence[str], interface: str, methods: Sequence[Method]) -> bytes:
    """A type library with one interface."""
    written = bytearray(MAGIC + _number(0) + _number(0))
    entity = _append(written, _interface(methods))
    entry = _entry(written, interface, entity)
    for module in reversed(modules):
        entry = _entry(written, module, _append(written, MODULE + _number(1) + entry))
    top = _append(written, entry)
    written[len(MAGIC) : len(MAGIC) + 8] = _number(top) + _number(1)
    return bytes(written)


def _append(written: bytearray, more: bytes) -> int:
    """Where something stands that is added at the end."""
    at = len(written)
    written += more
    return at


def _entry(written: bytearray, name: str, entity: int) -> bytes:
    """An entry of a map; the name is written before it."""
    return _number(_append(written, name.encode("ascii") + b"\x00")) + _number(entity)


def _interface(methods: Sequence[Method]) -> bytes:
    none = _number(0)
    return (INTERFACE + _number(1) + _text(BASE) + none + none + _number(len(methods))) + b"".join(
        _method(method) for method in methods
    )


def _method(method: Method) -> bytes:
    parameters = b"".join(IN + _text(name) + _text(kind) for name, kind in method.parameters)
    head = _text(method.name) + _text(method.answer) + _number(len(method.parameters))
    return head + parameters + _number(0)


def _number(value: int) -> bytes:
    return struct.pack("<I", value)


def _text(text: str) -> bytes:
    content = text.encode("ascii")
    return _number(len(content)) + content
