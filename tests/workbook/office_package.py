"""Parts of a workbook as they are put in by hand: content, content type, relationship."""

from __future__ import annotations

import re
from collections.abc import Mapping

Parts = dict[str, bytes]
_EMPTY = (
    b'<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n<Relationships '
    b'xmlns="http://schemas.openxmlformats.org/package/2006/relationships"></Relationships>'
)


def part_of_sheet(parts: Mapping[str, bytes], sheet: str) -> str:
    """Part that holds a sheet."""
    book = parts["xl/workbook.xml"].decode("utf-8")
    links = parts["xl/_rels/workbook.xml.rels"].decode("utf-8")
    rel = re.search(rf'<sheet name="{re.escape(sheet)}"[^>]*r:id="(\w+)"', book).group(1)
    entry = next(e for e in re.findall(r"<Relationship [^>]*/>", links) if f'Id="{rel}"' in e)
    return "xl/" + re.search(r'Target="([^"]*)"', entry).group(1)


def named_tables(parts: Mapping[str, bytes]) -> dict[str, str]:
    """Part of each table, by its name."""
    return {
        re.search(rb'displayName="([^"]*)"', data).group(1).decode(): name
        for name, data in parts.items()
        if name.startswith("xl/tables/table")
    }


def edited(parts: Parts, name: str, old: str, new: str) -> None:
    """Another text in the place of the first such one."""
    text = parts[name].decode("utf-8")
    assert old in text, (name, old)
    parts[name] = text.replace(old, new, 1).encode("utf-8")


def added(parts: Parts, name: str, kind: str, text: str | bytes) -> None:
    """A new part with its content type; XML gets its declaration."""
    assert name not in parts, name
    head = b'<?xml version="1.0" encoding="UTF-8"?>\n'
    parts[name] = head + text.encode("utf-8") if isinstance(text, str) else text
    if kind:
        entry = f'<Override PartName="/{name}" ContentType="{kind}"/></Types>'
        edited(parts, "[Content_Types].xml", "</Types>", entry)


def related(parts: Parts, part: str, kind: str, target: str, name: str = "") -> str:
    """A relationship from a part to another; its identifier."""
    folder, _, file = part.rpartition("/")
    rels = f"{folder}/_rels/{file}.rels"
    parts.setdefault(rels, _EMPTY)
    new = name or f"rId{9000 + len(parts[rels])}"
    entry = f'<Relationship Id="{new}" Type="{kind}" Target="{target}"/></Relationships>'
    edited(parts, rels, "</Relationships>", entry)
    return new
