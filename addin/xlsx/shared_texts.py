"""The shared texts of a workbook, to which cells refer by number.

They are apart from the workbook, because each sheet has them at hand: a sheet that held the workbook, which holds the
sheet, would stay in memory until Python looks for such circles.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

from addin.xlsx.container import Container, shown_name
from addin.xlsx.errors import WorkbookRefused, damaged
from addin.xlsx.references import whole_number
from addin.xlsx.values import rich_text
from addin.xlsx.workbook_part import WorkbookPart
from addin.xlsx.xml_part import Element, main, parse_part

# Shared texts are the same in all workbooks of one template: those of the last parts are kept, none of more bytes.
_MOST_KEPT = 2**20


def _shared_texts(data: bytes, part: str) -> tuple[str, ...]:
    """The shared texts of a workbook."""
    return tuple(rich_text(entry) for entry in parse_part(data, part).iterchildren(main("si")))


_kept_texts = lru_cache(maxsize=8)(_shared_texts)


class SharedTexts:
    """The shared texts of a workbook, parsed when first asked for."""

    def __init__(self, container: Container, structure: WorkbookPart) -> None:
        self._container = container
        self._structure = structure

    def text(self, index: str) -> str:
        """The shared text of an index, given as text."""
        number = whole_number(index.strip(), len(self._texts) - 1)
        if number is None:
            raise damaged(
                f"A cell of {self._container.path.name} refers to shared text {shown_name(index)}, but the workbook has "
                f"{len(self._texts)} texts."
            )
        return self._texts[number]

    def runs(self, index: str) -> Element | None:
        """The shared text of an index, if parts of it have a font of their own."""
        self.text(index)
        return self._with_runs.get(int(index))

    @cached_property
    def _texts(self) -> Sequence[str]:
        part = self._structure.related("sharedStrings")
        if part is None:
            return []
        data = self._container.charged(part)
        most = self._container.limits.texts
        if len(data) > most:
            raise WorkbookRefused(
                "too large",
                f"{self._container.path.name} has more than {most // 2**20} MB of texts, the limit of torsionbook. Move "
                "bulk data to another workbook.",
            )
        return _kept_texts(data, part) if len(data) <= _MOST_KEPT else _shared_texts(data, part)

    @cached_property
    def _with_runs(self) -> dict[int, Element]:
        part = self._structure.related("sharedStrings")
        root = None if part is None else parse_part(self._container.read(part), part)
        entries = enumerate(() if root is None else root.iterchildren(main("si")))
        return {k: one for k, one in entries if one.find(main("r")) is not None}
