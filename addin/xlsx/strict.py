"""Workbooks saved as 'Strict Open XML Spreadsheet', told in the dialect of ordinary workbooks.

Both dialects are ISO/IEC 29500 and have the same elements. The strict one has other names of namespaces and relationships,
dates as text, and percentages with their sign in drawings. Nothing is parsed here: what could be too much is still text.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import datetime

STRICT_HOST = b"http://purl.oclc.org/ooxml/"
_ORDINARY_HOST = b"http://schemas.openxmlformats.org/"
#: Tags up to the last thing of interest in them; nothing comes after it that could fail, so no text takes long.
_TAG_WITH_NAME = re.compile(rb"<[^<>]*[\"']" + re.escape(STRICT_HOST) + rb"[^<>]*")
_NAME = re.compile(rb"([\"'])" + re.escape(STRICT_HOST) + rb"(\w+)/([\w/-]+)(?=\1)")
#: Last words of names that are spelled otherwise.
_SPELLED = {
    b"extendedProperties": b"extended-properties",
    b"customProperties": b"custom-properties",
}
_THUMBNAIL = b"package/2006/relationships/metadata/thumbnail"
_ONLY_STRICT = re.compile(rb"""\s(?:conformance|dateCompatibility)=(?:"[^"]*"|'[^']*')""")
_WORKBOOK_TAG = re.compile(rb"<(?:\w+:)?workbook(?:Pr)?\b[^<>]*>")
_FROM_1904 = re.compile(rb"""<(?:\w+:)?workbookPr\b[^<>]*\bdate1904=["'](?:1|true)["']""")
#: A cell that holds a date, up to its value. Only the first type of a cell counts, so that no tag is gone through again.
_DATE_CELL = re.compile(
    rb"""(<(?:\w+:)?c\b(?:[^<>\s]++|\s(?!t=["']d["']))*+)\st=["']d["']"""
    rb"""([^<>/]*+>(?:[^<]++|<(?!/?(?:\w+:)?c\b|(?:\w+:)?v\b))*+<(?:\w+:)?v\b[^<>]*+>)([^<]*)(?=<)"""
)
_PERCENT_TAG = re.compile(rb"""<(?:\w+:)?(\w+)\s[^<>]*%["']""")
#: Of more digits than a drawing can mean it stays, and is no number to any program.
_PERCENT = re.compile(rb"""\b(\w+)=(["'])(-?\d{1,9}(?:\.\d{1,20})?)%\2""")
#: Texts of drawings, which are no percentages.
_TEXTS = (b"name", b"descr", b"title", b"typeface", b"formatCode")
#: Of charts, in whole percent; all others in thousandths.
_WHOLE = frozenset(
    b"gapWidth gapDepth overlap depthPercent hPercent bubbleScale holeSize secondPieSize lblOffset".split()
)


def starts_in_1904(workbook_part: bytes) -> bool:
    """Whether dates of a workbook are counted from 1904."""
    return _FROM_1904.search(workbook_part) is not None


def in_ordinary_dialect(data: bytes, *, from_1904: bool) -> bytes:
    """A part in UTF-8 in the dialect of ordinary workbooks."""
    if STRICT_HOST not in data:
        return data
    data = _exchanged(_TAG_WITH_NAME, _with_ordinary_names, data)
    if b"/spreadsheetml/" not in data:
        return _exchanged(_PERCENT_TAG, _without_percent, data)
    data = _exchanged(_WORKBOOK_TAG, lambda tag: _ONLY_STRICT.sub(b"", tag[0]), data)
    return _exchanged(_DATE_CELL, lambda cell: _with_serial(cell, from_1904=from_1904), data)


def _exchanged(
    pattern: re.Pattern[bytes], change: Callable[[re.Match[bytes]], bytes], data: bytes
) -> bytes:
    """As ``pattern.sub``, which would keep millions of pieces in memory at once."""
    made, position = bytearray(), 0
    for found in pattern.finditer(data):
        made += data[position : found.start()]
        made += change(found)
        position = found.end()
    if not position:
        return data
    made += data[position:]
    return bytes(made)


def serial_number(text: str, *, from_1904: bool) -> float | None:
    """Number of a date or time of day as ISO 8601 writes it, None when it is none. [d]"""
    text = text.strip()
    day, mark, time = text.rpartition("T") if "T" in text or ":" in text else (text, "", "")
    first = datetime(1904, 1, 1) if from_1904 else datetime(1899, 12, 30)
    try:
        moment = datetime.fromisoformat(f"{day or first.date()}T{time or '00:00'}")
    except ValueError:
        return None
    passed = moment.replace(tzinfo=None) - first
    return passed.days + (passed.seconds + passed.microseconds / 1e6) / 86400


def _with_ordinary_names(tag: re.Match[bytes]) -> bytes:
    return _exchanged(_NAME, _ordinary_name, tag[0])


def _ordinary_name(found: re.Match[bytes]) -> bytes:
    """A name of the other dialect: with the year, and as its last word is spelled there."""
    quote, family, rest = found.groups()
    if rest.endswith(b"metadata/thumbnail"):
        return quote + _ORDINARY_HOST + _THUMBNAIL
    folder, slash, last = rest.rpartition(b"/")
    name = folder + slash + _SPELLED.get(last, last)
    return quote + _ORDINARY_HOST + family + b"/2006/" + name


def _with_serial(found: re.Match[bytes], *, from_1904: bool) -> bytes:
    """A cell with its date as a number; as text where it is none."""
    before, between, text = found.groups()
    number = serial_number(text.decode("utf-8", "replace"), from_1904=from_1904)
    if number is None:
        return before + b' t="str"' + between + text
    return before + between + repr(number).removesuffix(".0").encode()


def _without_percent(tag: re.Match[bytes]) -> bytes:
    """A tag of a drawing with its percentages as whole numbers."""
    factor = 1 if tag[1] in _WHOLE else 1000

    def number(found: re.Match[bytes]) -> bytes:
        name, quote, text = found.groups()
        if name in _TEXTS:
            return found[0]
        return name + b"=" + quote + str(round(float(text) * factor)).encode() + quote

    return _exchanged(_PERCENT, number, tag[0])
