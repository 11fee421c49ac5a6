"""The frozen model of a report: what stands on its pages, and nothing of how it is drawn.

Text is plain text: both writers show it as it is, whatever signs it holds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from addin.report.formula import Node

__all__ = [
    "Block",
    "Column",
    "Cover",
    "Document",
    "Equation",
    "Facts",
    "Figure",
    "Listing",
    "Paragraph",
    "Section",
    "SignatureBox",
    "Table",
    "numbered",
    "tone_of",
]

#: Words of verdicts and the tone in which they are set.
_TONES = {
    "pass": "good",
    "ok": "good",
    "accepted by forced response": "fair",
    "fail": "bad",
    "unbounded": "bad",
    "differs": "bad",
    "not judged": "open",
}


def tone_of(word: str) -> str:
    """How a verdict is coloured; the word itself always stands there too.

    Parameters
    ----------
    word : str
        A verdict. [word]

    Returns
    -------
    str
        ``good``, ``fair``, ``bad``, ``open``, or empty for no verdict. [word]
    """
    return _TONES.get(word.strip(), "")


@dataclass(frozen=True)
class Paragraph:
    """Some sentences.

    Parameters
    ----------
    text : str
        The sentences. [text]
    kind : str
        ``text``, ``note`` (small print), ``lead`` (an outcome) or ``alert``. [word]
    """

    text: str
    kind: str = "text"


@dataclass(frozen=True)
class Listing:
    """Sentences one below the other.

    Parameters
    ----------
    items : tuple of str
        The sentences. [text]
    marker : str
        Sign before each. [text]
    """

    items: tuple[str, ...]
    marker: str = "–"


@dataclass(frozen=True)
class Facts:
    """Names and values in two columns.

    Parameters
    ----------
    rows : tuple of (str, str)
        Name and value. [text]
    width : float
        Width of the names. [mm]
    """

    rows: tuple[tuple[str, str], ...]
    width: float = 46.0


@dataclass(frozen=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    header : str
        What it holds. [name]
    unit : str
        Its unit as shown; empty where there is none. [unit]
    kind : str
        ``text``, ``number``, ``sentence`` (takes the width that is left), ``verdict``, or ``gap``
        between halves that stand beside each other. [word]
    """

    header: str
    unit: str = ""
    kind: str = "text"


@dataclass(frozen=True)
class Table:
    """A table with a caption; its header is repeated on each page.

    Parameters
    ----------
    caption : str
        What it is. [text]
    columns : tuple of Column
        Columns.
    rows : tuple of tuple of str
        Cells as shown. [text]
    note : str
        Small print below: what was left out, by which equations. [text]
    number : int
        Counted through the document; 0 before `numbered`. [count]
    together : bool
        Whether it stays on one page, as a table folded into halves must. [flag]
    """

    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    number: int = 0
    together: bool = False


@dataclass(frozen=True)
class Figure:
    """A picture with a caption.

    Parameters
    ----------
    caption : str
        What it shows. [text]
    svg, png : bytes
        The same drawing as vectors and as pixels; empty where it was not asked for. [file]
    width, height : float
        Size on the page. [mm]
    number : int
        Counted through the document. [count]
    """

    caption: str
    svg: bytes
    png: bytes
    width: float
    height: float
    number: int = 0


@dataclass(frozen=True)
class Equation:
    """An equation with its name, its signs and its source.

    Parameters
    ----------
    name : str
        What it gives. [name]
    formula : Node
        The formula.
    where : str
        What its signs mean, or how it is used. [text]
    source : str
        Where it comes from. [text]
    number : int
        Counted through the document. [count]
    """

    name: str
    formula: Node
    where: str
    source: str
    number: int = 0


@dataclass(frozen=True)
class SignatureBox:
    """Cells to be signed by hand.

    Parameters
    ----------
    rows : tuple of (str, str)
        Role, and name where it is known. [text]
    """

    rows: tuple[tuple[str, str], ...]


Block = Paragraph | Listing | Facts | Table | Figure | Equation | SignatureBox


@dataclass(frozen=True)
class Section:
    """A section and what is in it.

    Parameters
    ----------
    title : str
        Heading. [text]
    blocks : tuple of Block
        Content before the subsections.
    parts : tuple of Section
        Subsections.
    number : str
        Such as ``3`` or ``3.2``. [text]
    """

    title: str
    blocks: tuple[Block, ...] = ()
    parts: tuple[Section, ...] = ()
    number: str = ""


@dataclass(frozen=True)
class Cover:
    """The first page.

    Parameters
    ----------
    kind : str
        What sort of document it is. [text]
    title, subtitle : str
        Title of the calculation; the train. [text]
    verdict : str
        Overall verdict. [word]
    sentence : str
        What it rests on. [sentence]
    facts : tuple of (str, str)
        Title block. [text]
    alerts : tuple of str
        What must be known before anything is read. [sentences]
    revisions : Table
        Revision table; rows to be filled in by hand are blank.
    signatures : SignatureBox
        Who prepared, checked, approved.
    """

    kind: str
    title: str
    subtitle: str
    verdict: str
    sentence: str
    facts: tuple[tuple[str, str], ...]
    alerts: tuple[str, ...]
    revisions: Table
    signatures: SignatureBox


@dataclass(frozen=True)
class Document:
    """A whole report.

    Parameters
    ----------
    cover : Cover
        First page.
    sections : tuple of Section
        The others.
    name, revision : str
        Document number and revision, on every page. [text]
    short_title : str
        Title for the head of each page. [text]
    foot : str
        Program and digest of the inputs, at the foot of each page. [text]
    paper : str
        ``a4`` or ``us-letter``. [word]
    date : int
        Seconds since 1970, UTC; the date written into the file. [s]
    """

    cover: Cover
    sections: tuple[Section, ...]
    name: str
    revision: str
    short_title: str
    foot: str
    paper: str
    date: int


def numbered(sections: Sequence[Section]) -> tuple[Section, ...]:
    """Sections with their numbers, and their tables, figures and equations counted through.

    Parameters
    ----------
    sections : sequence of Section
        In order.

    Returns
    -------
    tuple of Section
        The same with numbers.
    """
    counts = {Table: 0, Figure: 0, Equation: 0}

    def block(one: Block) -> Block:
        if isinstance(one, (Table, Figure, Equation)):
            counts[type(one)] += 1
            return replace(one, number=counts[type(one)])
        return one

    def section(one: Section, number: str) -> Section:
        blocks = tuple(block(b) for b in one.blocks)
        parts = tuple(section(part, f"{number}.{k}") for k, part in enumerate(one.parts, start=1))
        return replace(one, blocks=blocks, parts=parts, number=number)

    return tuple(section(one, str(k)) for k, one in enumerate(sections, start=1))


def blocks_of(sections: Sequence[Section]) -> Iterator[Block]:
    """Every block in reading order.

    Parameters
    ----------
    sections : sequence of Section
        Sections.

    Yields
    ------
    Block
        One after the other.
    """
    for section in sections:
        yield from section.blocks
        yield from blocks_of(section.parts)
