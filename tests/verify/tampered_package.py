"""Edits of a workbook that the product's own writer refuses to make: on the parts of the package."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from pathlib import Path


class Package:
    """Parts of a workbook as text, changed and stored under another name."""

    def __init__(self, source: Path) -> None:
        with zipfile.ZipFile(source) as archive:
            self.parts = {name: archive.read(name) for name in archive.namelist()}

    def part_of_sheet(self, sheet: str) -> str:
        """The part of a worksheet."""
        book = self.parts["xl/workbook.xml"].decode()
        found = re.search(rf'<sheet [^>]*name="{re.escape(sheet)}"[^>]*r:id="([^"]+)"', book)
        rels = self.parts["xl/_rels/workbook.xml.rels"].decode()
        [rel] = [r for r in re.findall(r"<Relationship [^>]*>", rels) if f'"{found[1]}"' in r]
        return "xl/" + re.search(r'Target="([^"]+)"', rel)[1].removeprefix("/xl/")

    def part_of_table(self, table: str) -> str:
        """The part of a table."""
        [part] = [
            name
            for name, data in self.parts.items()
            if name.startswith("xl/tables/") and f'displayName="{table}"'.encode() in data
        ]
        return part

    def change(self, part: str, how: Callable[[str], str]) -> None:
        """Change the text of a part; it must change."""
        before = self.parts[part].decode()
        after = how(before)
        assert after != before, part
        self.parts[part] = after.encode()

    def change_cell(self, sheet: str, cell: str, content: str, kind: str = "") -> None:
        """Put other content into a cell that is there."""
        attribute = f' t="{kind}"' if kind else ""

        def put(text: str) -> str:
            return re.sub(
                rf'<c r="{cell}"((?: s="\d+")?)[^>]*?(?:/>|>.*?</c>)',
                lambda found: f'<c r="{cell}"{found[1]}{attribute}>{content}</c>',
                text,
                count=1,
            )

        self.change(self.part_of_sheet(sheet), put)

    def put_text(self, sheet: str, cell: str, text: str) -> None:
        """A word in a cell."""
        self.change_cell(
            sheet, cell, f'<is><t xml:space="preserve">{text}</t></is>', kind="inlineStr"
        )

    def table_to_range(self, table: str) -> None:
        """What 'Convert to range' leaves of a table: its cells."""
        part = self.part_of_table(table)
        file = part.rsplit("/", 1)[1]
        [rels] = [
            name
            for name, data in self.parts.items()
            if name.startswith("xl/worksheets/_rels/") and f"/{file}".encode() in data
        ]
        rel = re.search(rf'<Relationship [^>]*/{file}"[^>]*/>', self.parts[rels].decode())[0]
        rid = re.search(r'Id="([^"]+)"', rel)[1]
        self.change(rels, lambda text: text.replace(rel, ""))
        sheet = "xl/worksheets/" + rels.rsplit("/", 1)[1].removesuffix(".rels")
        self.change(sheet, lambda text: re.sub(rf'<tablePart r:id="{rid}"/>', "", text))
        self.change(sheet, lambda text: re.sub(r'<tableParts count="\d+"(?:/>|></tableParts>)|(?<=<tableParts) count="\d+"', "", text))  # fmt: skip
        self.change(
            "[Content_Types].xml",
            lambda text: re.sub(rf'<Override PartName="/{part}"[^>]*/>', "", text),
        )
        del self.parts[part]

    def store(self, target: Path) -> Path:
        """Write the package."""
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in self.parts.items():
                archive.writestr(name, data)
        return target
