"""The schematic of sheet Summary against the one that would be drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from addin.charts.schematic import schematic
from addin.contract.problems import shortened
from addin.contract.sheets import EARLIER_SHEETS, SCHEMATIC
from addin.template.front_sheets import SCHEMATIC_HEIGHT, SCHEMATIC_WIDTH
from addin.verify.findings import Finding
from addin.writing.drawn_schematic import schematic_shapes
from addin.xlsx import Workbook
from addin.xlsx.drawn_shapes import Shape
from engine.case.data import CaseData

#: How far a shape may be off, as programs round places when they save. [pixel]
_ROUNDING = 1.0
#: Likewise the height of letters. [pt]
_LETTERS = 0.6


def compare_schematic(workbook: Workbook, case: CaseData, same_version: bool) -> Iterator[Finding]:
    """A schematic that is missing, hidden or another than recalculation would draw.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.
    case : CaseData
        Its case. [SI]
    same_version : bool
        Whether this version drew it; another may draw otherwise. [flag]

    Yields
    ------
    Finding
        ``chart`` or ``hidden``; a note where it was taken out. Its place and size are the engineer's.
    """
    group = workbook.drawn_group(SCHEMATIC)
    if group is None:
        if same_version and not EARLIER_SHEETS & {*workbook.sheet_names}:
            sentence = "no schematic of the train is found: it was removed or renamed"
            yield Finding("chart", "Summary", "", sentence, fails=False)
        return
    if group.hidden != (not case.stations):
        words = "hidden" if group.hidden else "shown, but there is no train"
        yield Finding("hidden", group.sheet, group.cell, f"the schematic is {words}")
        return
    drawing, sentence = schematic(case), ""
    sizes = [(group.width, group.height), (SCHEMATIC_WIDTH, SCHEMATIC_HEIGHT)]
    if not (group.width and group.height):
        sizes, sentence = [], "is not drawn" if case.stations else ""
    # drawn for this room, or for that of the template, and stretched since by a program with other columns
    for size in sizes:
        scale = (group.width / size[0], group.height / size[1])
        expected = [_stretched(one, *scale) for one in schematic_shapes(drawing, *size)]
        difference = _difference(list(group.shapes), expected)
        sentence = sentence or difference
        if not difference:
            sentence = ""
            break
    if not sentence and group.turned:
        sentence = "is turned or mirrored"
    if sentence:
        yield Finding(
            "chart", group.sheet, group.cell, f"the schematic of the train {sentence}",
            fails=same_version,
        )  # fmt: skip


def _difference(found: list[Shape], expected: list[Shape]) -> str:
    """What the first shape is that differs, as the end of a sentence; empty where none does."""
    shown, wanted = ([one.text for one in shapes if one.text] for shapes in (found, expected))
    for words in shown:
        if words not in wanted:
            return f"says '{_line(words)}', which does not follow from the inputs"
    for words in wanted:
        if words not in shown:
            return f"does not say '{_line(words)}'"
    if len(found) != len(expected):
        return f"has {len(found)} shapes instead of {len(expected)}"
    for one, other in zip(found, expected, strict=True):
        if not _alike(one, other):
            what = f"'{_line(other.text)}'" if other.text else "a shape"
            return f"shows {what} otherwise than recalculation draws it"
    return ""


def _stretched(one: Shape, across: float, down: float) -> Shape:
    return replace(
        one, left=one.left * across, top=one.top * down, width=one.width * across, height=one.height * down,
        points=tuple((x * across, y * down) for x, y in one.points),
    )  # fmt: skip


def _line(words: str) -> str:
    return shortened(" ".join(words.split()), 40)


def _alike(one: Shape, other: Shape) -> bool:
    """Whether a shape of the file is the expected one; its corners follow from its room."""
    pairs = [
        (getattr(one, name), getattr(other, name)) for name in ("left", "top", "width", "height")
    ]
    corners = zip(one.points, other.points, strict=False)
    pairs += [pair for found, wanted in corners for pair in zip(found, wanted, strict=True)]
    return (
        one.text == other.text
        and len(one.points) == len(other.points)
        and all(abs(found - wanted) <= _ROUNDING for found, wanted in pairs)
        and (one.fill.upper(), one.line.upper()) == (other.fill.upper(), other.line.upper())
        and (
            not other.text
            or (one.ink.upper() == other.ink.upper() and abs(one.size - other.size) <= _LETTERS)
        )
    )
