"""Workbooks in the strict dialect of ISO/IEC 29500, made of ordinary ones by the names of its annexes."""

import re
import zipfile
from pathlib import Path

#: Namespaces and relationships: ordinary, and strict.
NAMES = (
    (b"http://schemas.openxmlformats.org/spreadsheetml/2006/", b"http://purl.oclc.org/ooxml/spreadsheetml/"),
    (b"http://schemas.openxmlformats.org/drawingml/2006/", b"http://purl.oclc.org/ooxml/drawingml/"),
    (b"http://schemas.openxmlformats.org/officeDocument/2006/relationships/extended-properties",
     b"http://purl.oclc.org/ooxml/officeDocument/relationships/extendedProperties"),
    (b"http://schemas.openxmlformats.org/officeDocument/2006/relationships/custom-properties",
     b"http://purl.oclc.org/ooxml/officeDocument/relationships/customProperties"),
    (b"http://schemas.openxmlformats.org/officeDocument/2006/extended-properties",
     b"http://purl.oclc.org/ooxml/officeDocument/extendedProperties"),
    (b"http://schemas.openxmlformats.org/officeDocument/2006/custom-properties",
     b"http://purl.oclc.org/ooxml/officeDocument/customProperties"),
    (b"http://schemas.openxmlformats.org/officeDocument/2006/", b"http://purl.oclc.org/ooxml/officeDocument/"),
)  # fmt: skip
#: Percentages of drawings, and of charts.
THOUSANDTHS = re.compile(
    rb'(<a:(?:tint|shade|satMod|lumMod|lumOff|alpha)\s+val="|<a:gs\s+pos=")(\d+)000"'
)
WHOLE = re.compile(rb'(<c:(?:gapWidth|overlap|holeSize)\s+val=")(-?\d+)"')


def saved_strict(
    source: Path, target: Path, cells: dict[str, dict[str, bytes]] | None = None
) -> Path:
    """A workbook in the strict dialect; cells of parts are replaced, by their names."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            data = old.read(entry)
            for cell, content in (cells or {}).get(entry.filename, {}).items():
                pattern = rb'<c r="%s"[^<>]*?(?:/>|>.*?</c>)' % cell.encode()
                data, count = re.subn(pattern, lambda _, made=content: made, data, flags=re.DOTALL)
                assert count == 1, cell
            new.writestr(entry.filename, in_strict_dialect(entry.filename, data))
    return target


def in_strict_dialect(name: str, data: bytes) -> bytes:
    """A part in the strict dialect."""
    if not name.endswith((".xml", ".rels")):
        return data
    for ordinary, strict in NAMES:
        data = data.replace(ordinary, strict)
    data = data.replace(b"<workbookPr", b'<workbookPr dateCompatibility="0"')
    data = re.sub(rb"(<workbook\s)", rb'\1conformance="strict" ', data)
    return WHOLE.sub(rb'\1\2%"', THOUSANDTHS.sub(rb'\1\2%"', data))
