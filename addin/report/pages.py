"""Where pages end, so that tables stay whole and no page is left half empty.

A page ends by itself where the next piece (headings with what they lead to, a table, a figure) does not fit. Where
that would leave a page half empty, an earlier page ends sooner instead: each end is chosen with all others, as a
paragraph is broken into lines. The last page of a chapter may be short.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from addin.report.document import Block, Facts, Figure, Listing, Paragraph, Section, Table
from addin.report.layout import held_paragraphs

#: A page is filled to this share at least, and what is short of it weighs so much. [1]
_FILLED, _SHORT_PAGE = 0.56, 100.0
#: What ending a page before it is full weighs, by kind: sooner than needed, and at a chapter. [1]
_SOONER, _CHAPTER = 0.2, 1.0
#: What a last page with less than a share weighs. [1]
_ORPHAN, _FEW_LINES = 6.0, 0.2
#: Least room that something breakable begins in. [mm]
_BEGINNING = 25.0
#: Facts from so many rows may be broken over pages. [count]
FEW_FACTS = 14
#: Text and tables of the word processor over those of the PDF: more than most, lest a page overflow. [1]
_WORDIER = 1.05
#: Longest remark on a table or figure. [characters]
_REMARK = 300
#: Heights are counted in steps of this. [mm]
_STEP = 0.5


@dataclass(frozen=True)
class Place:
    """A heading, or a block below it, in reading order."""

    section: Section  #: Its section.
    block: Block | None  #: None for the heading.
    held: bool  #: Whether it stays on the page of what follows.
    level: int = 0  #: Of a heading, 1 for a chapter; 0 for a block.


@dataclass(frozen=True)
class Piece:
    """Nodes that stay on one page, or text that may be broken."""

    first: int  #: Its first node, counted in reading order.
    height: float  #: Without the space below it. [mm]
    below: float  #: Space below it, unless a page ends there. [mm]
    breaks: bool  #: Whether it may be broken over pages.
    opens: bool  #: Whether a chapter begins with it.
    forced: bool = False  #: Whether it begins a page whatever is above it.


def nodes(sections: Sequence[Section], level: int = 1) -> Iterator[Place]:
    """Headings and blocks in reading order."""
    for section in sections:
        yield Place(section, None, True, level)
        held = held_paragraphs(section)
        for k, block in enumerate(section.blocks):
            yield Place(section, block, k < held)
        yield from nodes(section.parts, level + 1)


def pieces(sections: Sequence[Section], heights: Sequence[float], page: float) -> list[Piece]:
    """What is placed on pages one after the other.

    Parameters
    ----------
    sections : sequence of Section
        The chapters.
    heights : sequence of float
        Of each node, with the space below it. [mm]
    page : float
        Height of the text of a page. [mm]

    Returns
    -------
    list of Piece
        In reading order.
    """
    made: list[Piece] = []
    first, height, opens, forced = None, 0.0, False, False
    everything = [*nodes(sections)]
    for k, (node, own) in enumerate(zip(everything, heights, strict=True)):
        if first is None:
            first, height, opens, forced = k, 0.0, False, False
        height += own
        opens = opens or node.level == 1
        forced = forced or (node.block is None and node.section.is_first_appendix)
        last = k + 1 == len(everything) or everything[k + 1].block is None
        if node.held and k + 1 < len(everything):
            continue
        if not last and _remark(everything[k + 1]) and not _breakable(node.block):
            continue
        below = 0.0 if k + 1 == len(everything) else _space(node, everything[k + 1])
        breaks = _breakable(node.block) and not _joined(everything[first : k + 1])
        breaks = breaks or height - below > page
        made.append(Piece(first, height - below, below, breaks, opens, forced))
        first = None
    return made


def _remark(place: Place) -> bool:
    """Whether something is a short remark on the table or figure above it, on whose page it stays."""
    block = place.block
    return isinstance(block, Paragraph) and len(block.text) <= _REMARK


def _joined(places: Sequence[Place]) -> bool:
    """Whether a table or figure is among them."""
    return any(not _breakable(place.block) for place in places)


def _space(above: Place, below: Place) -> float:
    """Between two nodes, as report.typ sets them. [mm]"""
    spaces = (10.8, 7.1) if below.level else (4.9, 4.9)
    if not below.level and not isinstance(above.block, (Table, Figure)):
        return 3.0
    return spaces[min(max(below.level, 1), 2) - 1]


def _breakable(block: Block | None) -> bool:
    """Whether something may be broken wherever it is."""
    if isinstance(block, Facts):
        return len(block.rows) > FEW_FACTS
    return block is None or isinstance(block, (Paragraph, Listing))


def page_ends(placed: Sequence[Piece], page: float, *, every: bool = False) -> frozenset[int]:
    """Nodes before which a page ends although they would fit on it.

    Parameters
    ----------
    placed : sequence of Piece
        In reading order.
    page : float
        Height of the text of a page. [mm]
    every : bool
        Whether to name those as well that do not fit: where heights are estimates. [flag]

    Returns
    -------
    frozenset of int
        Their places in reading order. [count]
    """
    # by how far down the page is filled: the least weight so far, and where pages were ended
    reached: dict[float, tuple[float, tuple[int, ...]]] = {0.0: (0.0, ())}
    for piece in placed:
        following: dict[float, tuple[float, tuple[int, ...]]] = {}

        def arrive(at: float, weight: float, ends: tuple[int, ...]) -> None:
            at = _STEP * math.ceil(at / _STEP)
            if at not in following or weight < following[at][0]:  # noqa: B023
                following[at] = (weight, ends)  # noqa: B023

        for at, (weight, ends) in reached.items():
            room = page - at
            fits = piece.height <= room or (piece.breaks and room >= _BEGINNING)
            if at == 0.0 or (fits and not piece.forced):
                arrive(_down(at + piece.height, page) + piece.below, weight, ends)
            if at > 0.0:
                left = weight + _weight(at / page, piece.opens)
                sooner = fits and not piece.forced
                arrive(
                    _down(piece.height, page) + piece.below,
                    left + (_SOONER if sooner else 0.0),
                    (*ends, piece.first) if sooner or every else ends,
                )
        reached = following
    last = (
        (weight + _weight((at or page) / page, at_chapter=True), ends)
        for at, (weight, ends) in reached.items()
    )
    return frozenset(min(last)[1])


def _down(height: float, page: float) -> float:
    """How far down its last page something ends. [mm]"""
    return height - page * max(math.ceil(height / page - 1e-9) - 1, 0)


def _weight(share: float, at_chapter: bool) -> float:
    """How unwelcome the end of a page filled to a share is."""
    if at_chapter:
        return _CHAPTER + 2.0 * (1.0 - share) + _ORPHAN * (share < _FEW_LINES)
    if share < _FILLED:
        return _SHORT_PAGE * (1.0 + _FILLED - share)
    return 4.0 * (1.0 - share) ** 2


def whole_tables(
    sections: Sequence[Section], heights: Sequence[float], page: float
) -> frozenset[int]:
    """Nodes that are tables which fit a page, and therefore stay whole.

    Parameters
    ----------
    sections : sequence of Section
        The chapters.
    heights : sequence of float
        Of each node. [mm]
    page : float
        Height of the text of a page. [mm]

    Returns
    -------
    frozenset of int
        Their places in reading order. [count]
    """
    everything = zip(nodes(sections), heights, strict=True)
    return frozenset(
        k
        for k, (node, height) in enumerate(everything)
        if isinstance(node.block, Table) and height <= page
    )


def word_heights(
    sections: Sequence[Section], heights: Sequence[float], width: float, whole: float
) -> list[float]:
    """Heights in a word processor, from those of the PDF.

    Parameters
    ----------
    sections : sequence of Section
        The chapters.
    heights : sequence of float
        Of each node in the PDF. [mm]
    width, whole : float
        Of the text there, and in the PDF. [mm]

    Returns
    -------
    list of float
        An estimate. [mm]
    """
    share = width / whole
    return [
        height * (share if isinstance(node.block, Figure) else _WORDIER / share)
        for node, height in zip(nodes(sections), heights, strict=True)
    ]
