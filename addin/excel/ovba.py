"""Compression of VBA sources, after [MS-OVBA] 2.4.1.

A compressed container is the byte 1 and chunks, each of 4096 bytes of data but the last. In a chunk,
a byte of flags says of the eight tokens that follow which are bytes and which are copies of what
stands before in the same chunk: two bytes that hold offset and length, in a number of bits that
depends on how much stands before.
"""

from __future__ import annotations

import struct

from addin.excel.errors import VbaCompressionError

_SIGNATURE = 1
_CHUNK = 4096
#: Header of a chunk: its length less 3, the signature 0b011, whether it is compressed.
_COMPRESSED, _RAW = 0xB000, 0x3000
_LEAST_COPY = 3
#: Places looked at for the longest copy; more makes files hardly smaller.
_MOST_CANDIDATES = 64


def compress(data: bytes) -> bytes:
    """Compress.

    Raises
    ------
    VbaCompressionError
        If the last, unfilled chunk cannot be compressed at all: the format has no way to store it.
        Text never is of that kind.
    """
    container = bytearray([_SIGNATURE])
    for start in range(0, len(data), _CHUNK):
        chunk = data[start : start + _CHUNK]
        packed = _packed(chunk)
        if len(packed) <= _CHUNK:
            container += struct.pack("<H", _COMPRESSED | (len(packed) - 1)) + packed
        elif len(chunk) == _CHUNK:
            container += struct.pack("<H", _RAW | (_CHUNK - 1)) + chunk
        else:
            raise VbaCompressionError(
                f"The last {len(chunk)} bytes cannot be compressed, so they cannot be stored in a VBA "
                "project."
            )
    return bytes(container)


def _packed(chunk: bytes) -> bytes:
    """Tokens of one chunk."""
    out = bytearray()
    seen: dict[bytes, list[int]] = {}
    at = 0
    while at < len(chunk):
        flags_at = len(out)
        out.append(0)
        for bit in range(8):
            if at >= len(chunk):
                break
            length, offset = _longest_copy(chunk, at, seen)
            if length >= _LEAST_COPY:
                out[flags_at] |= 1 << bit
                out += struct.pack("<H", (offset - 1) << (16 - _bits(at)) | (length - _LEAST_COPY))
            else:
                length = 1
                out.append(chunk[at])
            for place in range(at, at + length):
                seen.setdefault(chunk[place : place + _LEAST_COPY], []).append(place)
            at += length
    return bytes(out)


def _bits(at: int) -> int:
    """Bits of the offset in a copy, where so many bytes of the chunk stand before."""
    return max(4, (at - 1).bit_length())


def _longest_copy(chunk: bytes, at: int, seen: dict[bytes, list[int]]) -> tuple[int, int]:
    """Length and offset of the longest copy of what comes next; 0 if there is none."""
    most = min((0xFFFF >> _bits(at)) + _LEAST_COPY, len(chunk) - at)
    best = (0, 0)
    for place in reversed(seen.get(chunk[at : at + _LEAST_COPY], [])[-_MOST_CANDIDATES:]):
        length = 0
        while length < most and chunk[place + length] == chunk[at + length]:
            length += 1
        if length > best[0]:
            best = (length, at - place)
    return best


def decompress(container: bytes) -> bytes:
    """Decompress.

    Raises
    ------
    VbaCompressionError
        If it is damaged.
    """
    if not container or container[0] != _SIGNATURE:
        raise VbaCompressionError("A VBA source has a wrong header.")
    out = bytearray()
    at = 1
    while at < len(container):
        if at + 2 > len(container):
            raise _cut_off()
        (header,) = struct.unpack_from("<H", container, at)
        if header & 0x7000 != _RAW:
            raise VbaCompressionError(f"A VBA source is damaged at byte {at}.")
        end = at + (header & 0x0FFF) + 3
        if end > len(container):
            raise _cut_off()
        body = container[at + 2 : end]
        out += _unpacked(body) if header & 0x8000 else body
        at = end
    return bytes(out)


def _unpacked(body: bytes) -> bytes:
    """Data of one compressed chunk."""
    out = bytearray()
    at = 0
    while at < len(body):
        flags = body[at]
        at += 1
        for bit in range(8):
            if at >= len(body):
                break
            if not flags >> bit & 1:
                out.append(body[at])
                at += 1
                continue
            if at + 2 > len(body):
                raise _cut_off()
            (token,) = struct.unpack_from("<H", body, at)
            at += 2
            low = 16 - _bits(len(out))
            offset = (token >> low) + 1
            length = (token & (1 << low) - 1) + _LEAST_COPY
            if offset > len(out) or len(out) + length > _CHUNK:
                raise VbaCompressionError("A VBA source is damaged (invalid copy).")
            for _ in range(length):  # a copy may reach into itself
                out.append(out[-offset])
    return bytes(out)


def _cut_off() -> VbaCompressionError:
    return VbaCompressionError("A VBA source is truncated.")
