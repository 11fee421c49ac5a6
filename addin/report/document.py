"""The frozen model of a report: what stands on its pages, and nothing of how it is drawn.

Text is plain text: both writers show it as it is, whatever signs it holds.
"""

from __future__ import annotations

import itertools
import string
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from addin.report.company import Logo
from addin.report.formula import Node
from engine.case.result_words import Judgement

#: Words of verdicts and the tone in which they are set.
_TONES = {
    Judgement.PASS: "good",
    "ok": "good",
    Judgement.WITHIN_ERROR: "fair",
    Judgement.ACCEPTED: "fair",
    Judgement.FAIL: "bad",
    Judgement.UNBOUNDED: "bad",
    Judgement.CHECK_INPUTS: "bad",
    "differs": "bad",
    Judgement.INCOMPLETE: "open",
    Judgement.NOT_JUDGED: "open",
}


def tone_of(word: str) -> str:
    """How a verdict is coloured; the word itself always stands there too.

    Returns
    -------
    str
        ``good``, ``fair``, ``bad``, ``open``, or empty for no verdict. [word]
    """
    return _TONES.get(word.strip(), "")


@dataclass(frozen=True)
class Paragraph:
    """Some sentences."""

    text: str  #: The sentences.
    kind: str = "text"  #: ``text``, ``note`` (small print), ``lead`` (an outcome) or ``alert``.


@dataclass(frozen=True)
class Listing:
    """Sentences one below the other."""

    items: tuple[str, ...]  #: The sentences.
    marker: str = "–"  #: Sign before each.


@dataclass(frozen=True)
class Facts:
    """Names and values in two columns."""

    rows: tuple[tuple[str, str], ...]  #: Name and value.
    width: float = 46.0  #: Width of the names. [mm]


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    header: str  #: What it holds.
    unit: str = ""  #: Its unit as shown; empty where there is none. [unit]
    #: ``text``, ``number``, ``sentence`` (takes the width that is left), ``verdict``, or ``gap``
    #: between halves that stand beside each other.
    kind: str = "text"


@dataclass(frozen=True)
class Table:
    """A table with a caption; its header is repeated on each page."""

    caption: str  #: What it is.
    columns: tuple[Column, ...]  #: Columns.
    rows: tuple[tuple[str, ...], ...]  #: Cells as shown.
    note: str = ""  #: Small print below: what was left out, by which equations.
    number: int = 0  #: Counted through the document; 0 before `numbered`.
    together: bool = False  #: Whether it stays on one page, as a table folded into halves must.


@dataclass(frozen=True)
class Figure:
    """A picture with a caption."""

    caption: str  #: What it shows.
    svg: bytes  #: The same drawing as vectors and as pixels; empty where it was not asked for.
    png: bytes  #: Likewise.
    width: float  #: Size on the page. [mm]
    height: float  #: Likewise. [mm]
    number: int = 0  #: Counted through the document.
    #: The drawing of matplotlib, where neither form was asked for.
    drawing: Any = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Equation:
    """An equation with its name, its signs and its source."""

    name: str  #: What it gives.
    formula: Node  #: The formula.
    where: str  #: What its signs mean, or how it is used.
    source: str  #: Where it comes from.
    number: int = 0  #: Counted through the document.


@dataclass(frozen=True)
class SignatureBox:
    """Cells to be signed by hand."""

    rows: tuple[tuple[str, str], ...]  #: Role, and name where it is known.


Block = Paragraph | Listing | Facts | Table | Figure | Equation | SignatureBox


@dataclass(frozen=True)
class Section:
    """A section and what is in it."""

    title: str  #: Heading.
    blocks: tuple[Block, ...] = ()  #: Content before the subsections.
    parts: tuple[Section, ...] = ()  #: Subsections.
    number: str = ""  #: Such as ``3`` or ``3.2``; of an appendix ``A`` or ``A.2``.

    @property
    def is_appendix(self) -> bool:
        """Whether it is one, not a part of one."""
        return self.number in [*string.ascii_uppercase]

    @property
    def is_first_appendix(self) -> bool:
        """Whether the appendices begin with it, on a page of their own."""
        return self.number == string.ascii_uppercase[0]


def section(title: str, *blocks: Block | None, parts: Iterable[Section] = ()) -> Section:
    """A section of the blocks that there are: None, such as a picture of nothing, is left out."""
    return Section(title, tuple(block for block in blocks if block is not None), tuple(parts))


@dataclass(frozen=True)
class Cover:
    """The first page."""

    kind: str  #: What sort of document it is.
    title: str  #: Title of the calculation; the train.
    subtitle: str  #: Likewise.
    verdict: str  #: Overall verdict.
    sentence: str  #: What it rests on.
    facts: tuple[tuple[str, str], ...]  #: Title block.
    alerts: tuple[str, ...]  #: What must be known before anything is read.
    revisions: Table  #: Revision table; rows to be filled in by hand are blank.
    signatures: SignatureBox  #: Who prepared, checked, approved.


@dataclass(frozen=True)
class Document:
    """A whole report."""

    cover: Cover  #: First page.
    sections: tuple[Section, ...]  #: The chapters, then the appendices, numbered by letters.
    name: str  #: Document number and revision, on every page.
    revision: str  #: Likewise.
    short_title: str  #: Title for the head of each page.
    foot: str  #: Program and digest of the inputs, at the foot of each page.
    paper: str  #: ``a4`` or ``us-letter``.
    date: int  #: Seconds since 1970, UTC; the date written into the file. [s]
    logo: Logo | None = None  #: Of the company, on the cover.

    @property
    def head(self) -> str:
        """Document and revision, at the head of each page."""
        revision = f"rev. {self.revision}" if self.revision else "no revision"
        return f"{self.name or 'no document number'} · {revision}"

    @property
    def author(self) -> str:
        """Who prepared it; empty where nobody is named."""
        return dict(self.cover.signatures.rows).get("Prepared by", "")


def numbered(
    sections: Sequence[Section], appendices: Sequence[Section] = ()
) -> tuple[Section, ...]:
    """Chapters and appendices with their numbers, and their tables, figures and equations counted through."""
    counts = {Table: 0, Figure: 0, Equation: 0}

    def counted(block: Block) -> Block:
        if isinstance(block, (Table, Figure, Equation)):
            counts[type(block)] += 1
            return replace(block, number=counts[type(block)])
        return block

    def with_numbers(sections: Sequence[Section], numbers: Iterable[str]) -> tuple[Section, ...]:
        made = []
        for section, number in zip(sections, numbers, strict=False):
            blocks = tuple(map(counted, section.blocks))
            parts = with_numbers(section.parts, (f"{number}.{k}" for k in itertools.count(1)))
            made.append(replace(section, blocks=blocks, parts=parts, number=number))
        return tuple(made)

    return (
        *with_numbers(sections, map(str, itertools.count(1))),
        *with_numbers(appendices, string.ascii_uppercase),
    )
