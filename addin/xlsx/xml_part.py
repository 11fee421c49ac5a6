"""Parsing and writing one XML part without trusting it.

A document type declaration is refused outright: no spreadsheet program writes one, and every entity attack needs one.
"""

from __future__ import annotations

import re
import threading
from typing import Any

from lxml import etree

from addin.xlsx.errors import WorkbookRefused, damaged

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
RELATIONSHIP_IDS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
RELATIONSHIPS = "http://schemas.openxmlformats.org/package/2006/relationships"
CONTENT_TYPES = "http://schemas.openxmlformats.org/package/2006/content-types"
DRAWING = "http://schemas.openxmlformats.org/drawingml/2006/main"
CHART = "http://schemas.openxmlformats.org/drawingml/2006/chart"
EXCEL_2010 = "http://schemas.microsoft.com/office/spreadsheetml/2009/9/main"
EXCEL_2010_FORMULA = "http://schemas.microsoft.com/office/excel/2006/main"

BYTE_ORDER_MARK = b"\xef\xbb\xbf"  #: Of UTF-8.
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_DECLARATION = re.compile(rb"\A(?:\xef\xbb\xbf)?\s*<\?xml[^>]*\?>\s*")
_ENCODING = re.compile(rb"""encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_STANDARD_DECLARATION = b'<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
_DOCTYPE_MARKS = (
    b"<!DOCTYPE",
    "<!DOCTYPE".encode("utf-16-le"),
    "<!DOCTYPE".encode("utf-16-be"),
)

# Elements of lxml have no public type; the alias says what is meant.
Element = Any


def main(tag: str) -> str:
    """Full name of a tag of the spreadsheet namespace."""
    return f"{{{MAIN}}}{tag}"


def chart_tag(tag: str) -> str:
    """Full name of a tag of the chart namespace."""
    return f"{{{CHART}}}{tag}"


def drawing_tag(tag: str) -> str:
    """Full name of a tag of the drawing namespace, which text inside charts uses."""
    return f"{{{DRAWING}}}{tag}"


class _Own(threading.local):
    """A parser for each thread: making one costs as much as parsing a small part."""

    def __init__(self) -> None:
        self.parser = etree.XMLParser(
            resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
        )


_own = _Own()


def parse_part(data: bytes, name: str) -> Element:
    """Root element of a part.

    Raises
    ------
    WorkbookRefused
        ``dtd`` for a document type declaration, ``damaged`` for XML that does not parse.
    """
    # A comment may come before the root, hence the whole text is searched; a cell can hold the mark only escaped.
    if any(mark in data for mark in _DOCTYPE_MARKS):
        raise _dtd(name)
    try:
        root = etree.fromstring(data, _own.parser)
    except etree.XMLSyntaxError as problem:
        raise damaged(
            f"The part {name} of the workbook is not well-formed XML ({in_short(problem)})."
        ) from problem
    if root.getroottree().docinfo.internalDTD is not None:
        raise _dtd(name)
    return root


def in_short(problem: BaseException) -> str:
    """What another program says of a file, which may quote what it found there, fit for a sentence."""
    text = "".join(c if c.isprintable() else "?" for c in str(problem)[:1000])
    text = re.sub(r"\b[A-Z]\w*Error\b", "error", text)
    return text if len(text) <= 200 else text[:197] + "..."


def _dtd(name: str) -> WorkbookRefused:
    return WorkbookRefused(
        "dtd",
        f"The part {name} of the workbook contains a document type declaration, which "
        "spreadsheet programs do not write and which is used in attacks. It is not opened; "
        "check where the file comes from.",
    )


def serialise(root: Element, original: bytes) -> bytes:
    """Bytes of a changed part, with the XML declaration of the original.

    Parameters
    ----------
    root : Element
        The changed tree.
    original : bytes
        The part as it was; only its declaration is used.
    """
    return declaration_of(original) + bytes(
        etree.tostring(root.getroottree(), encoding="UTF-8", xml_declaration=False)
    )


def is_utf8(data: bytes) -> bool:
    """Whether a part states no other encoding than UTF-8, so that its bytes can be searched for tags."""
    if data[:2] in _UTF16_MARKS:
        return False
    found = _DECLARATION.match(data)
    encoding = _ENCODING.search(found.group(0)) if found is not None else None
    return encoding is None or encoding.group(1).upper() in (b"UTF-8", b"US-ASCII")


def in_utf8(data: bytes, name: str) -> bytes:
    """A part of XML in UTF-16, which a few programs write, in UTF-8; any other as it is.

    Raises
    ------
    UnicodeDecodeError
        For what is no UTF-16.
    """
    if data[:2] not in _UTF16_MARKS or not name.lower().endswith((".xml", ".rels", ".vml")):
        return data
    text = data.decode("utf-16").encode()
    return _STANDARD_DECLARATION + text[len(_declaration(text)) :]


def has_misleading_tags(data: bytes) -> bool:
    """Whether a part holds comments, instructions or character data, in which what looks like a tag is none.

    It begins with a declaration. The rarer of the two characters is looked for first, which takes a tenth of the time.
    """
    return (b"!" in data and b"<!" in data) or (
        data.count(b"?", 2) > 1 and data.find(b"<?", 2) >= 0
    )


def declaration_of(original: bytes) -> bytes:
    """The XML declaration of a part; the usual one when the part was not UTF-8."""
    if not is_utf8(original):
        return _STANDARD_DECLARATION
    return _declaration(original)


def _declaration(data: bytes) -> bytes:
    found = _DECLARATION.match(data)
    return b"" if found is None else found.group(0)
