"""Widths of columns, so that every table fits its page in either writer.

Widths are estimated from the number of characters, generously: numbers are never broken, words only
where they are wider than their column may be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, takewhile

from addin.report.document import Block, Column, Paragraph, Section, Table

#: Width of the text on either paper. [mm]
TEXT_WIDTH = 170.0
#: Width of a character of a table, of the wider of both writers, and the margins of a cell. [mm]
_CHARACTER, _MARGINS = 1.48, 3.0
#: Capitals and other wide letters of short words. [mm]
_SLACK = 1.4
#: Longest words that are not broken, as much room as there is. [characters]
_WORDS = (18, 12)
#: A sentence is not asked to have less than this. [characters]
_SENTENCE = 26
#: Estimated widths are generous: so much more still fits. [1]
_TIGHT = 1.06
#: Between halves of a folded table. [mm]
_GAP = 8.0
#: A table with more rows than the first is folded, into pieces of at most the second. [count]
_TALL, _PIECE = 12, 40


def column_widths(table: Table, total: float = TEXT_WIDTH) -> list[float]:
    """Widths of the columns of a table.

    Parameters
    ----------
    table : Table
        The table.
    total : float
        Width of the text. [mm]

    Returns
    -------
    list of float
        One a column, together at most `total`. [mm]
    """
    least = _leasts(table)
    natural = [max(_natural(table, k), least[k]) for k in range(len(table.columns))]
    if sum(natural) <= total:
        wide = [k for k, column in enumerate(table.columns) if column.kind == "sentence"]
        for k in wide[-1:]:
            natural[k] += total - sum(natural)
        return natural
    spare = total - sum(least)
    if spare <= 0.0:
        return [width * total / sum(least) for width in least]
    # long texts get more, but not in proportion: a sentence ten times longer may take ten lines
    wish = [math.sqrt(max(n - m, 0.0)) for n, m in zip(natural, least, strict=True)]
    shares = zip(least, wish, natural, strict=True)
    given = [min(m + spare * w / sum(wish), n) for m, w, n in shares]
    rest = total - sum(given)
    longest = max(range(len(given)), key=lambda k: natural[k] - given[k])
    given[longest] += max(rest, 0.0)
    return given


def _natural(table: Table, k: int) -> float:
    """Width at which nothing of a column wraps, its header in at most two lines."""
    if table.columns[k].kind == "gap":
        return _GAP
    cells = [len(row[k]) for row in table.rows]
    return _mm(max([*cells, _header(table.columns[k])], default=0))


def least_width(table: Table) -> float:
    """Width below which numbers or ordinary words of a table would break. [mm]

    Parameters
    ----------
    table : Table
        The table.

    Returns
    -------
    float
        That of all columns together. [mm]
    """
    return sum(_leasts(table))


def _leasts(table: Table) -> list[float]:
    """Least widths; long words are broken sooner where the table would not fit otherwise."""
    least: list[float] = []
    for word in _WORDS:
        least = [_least(table, k, word) for k in range(len(table.columns))]
        if sum(least) <= TEXT_WIDTH:
            break
    return least


def _least(table: Table, k: int, word: int) -> float:
    """Width below which numbers or ordinary words would break."""
    column = table.columns[k]
    if column.kind == "gap":
        return _GAP
    words = [min(len(w), _WORDS[0]) + 1 for w in column.header.split()]  # bold is wider
    if column.unit:
        words.append(len(column.unit))
    if column.kind == "number" and len(table.rows) and not _has_words(table, k):
        words += [len(row[k]) for row in table.rows]
    else:
        words += [min(len(w), word) for row in table.rows for w in row[k].split()]
    longest = max(words, default=1)
    if column.kind == "sentence":
        cells = max((len(row[k]) for row in table.rows), default=0)
        longest = max(longest, min(_SENTENCE, cells))
    return _mm(longest)


def _has_words(table: Table, k: int) -> bool:
    """Whether a column of numbers holds sentences too, as a turned table may."""
    return any(" " in row[k] and len(row[k]) > _WORDS[0] for row in table.rows)


def _header(column: Column) -> int:
    words = column.header.split()
    half = math.ceil(len(column.header) / 2)
    return max(half if len(words) > 1 else len(column.header), *map(len, words), 0)


def _mm(characters: int) -> float:
    return max(characters, 3) * _CHARACTER + _MARGINS + _SLACK


def room(width: float) -> int:
    """How many characters a column takes.

    Parameters
    ----------
    width : float
        Its width. [mm]

    Returns
    -------
    int
        Characters of its longest word. [count]
    """
    return max(int((width - _MARGINS) / _CHARACTER), 4)


#: Rows that a broken table leaves on a page at least, and a group that is not broken at most. [count]
_ROWS, _GROUP = 3, 8
#: A row with a longer cell may fill a page. [characters]
_LOW = 240


def rows_together(table: Table) -> list[int]:
    """How a table longer than a page may be broken.

    Parameters
    ----------
    table : Table
        The table.

    Returns
    -------
    list of int
        Rows that stay together, one number a group: rows of the same name, the first three, the last three. [count]
    """
    count = len(table.rows)
    if any(len(cell) > _LOW for row in table.rows for cell in row):
        return [1] * count
    groups: list[int] = []
    for k, row in enumerate(table.rows):
        if k and groups[-1] < _GROUP and row[0] in ("", table.rows[k - 1][0]):
            groups[-1] += 1
        else:
            groups.append(1)
    for end, both in ((0, slice(0, 2)), (-1, slice(-2, None))):
        while len(groups) > 1 and groups[end] < _ROWS:
            groups[both] = [sum(groups[both])]
    return groups


#: Paragraphs that open a section stay with what follows where they are together no longer. [characters]
_OPENING = 600


def held_paragraphs(section: Section) -> int:
    """How many paragraphs below a heading stay on the page of what they lead to, as the heading does."""
    opening = [*takewhile(lambda block: isinstance(block, Paragraph), section.blocks)]
    if len(opening) == len(section.blocks) and not section.parts:
        return 0
    length = sum(len(block.text) for block in opening if isinstance(block, Paragraph))
    return len(opening) if length <= _OPENING else 0


def fitted(sections: Sequence[Section]) -> tuple[Section, ...]:
    """Sections whose tables all fit: one that is too wide is split, with the names of its rows in each part."""

    made = []
    for section in sections:
        blocks: list[Block] = []
        for block in section.blocks:
            blocks += _parted(block) if isinstance(block, Table) else [block]
        made.append(replace(section, blocks=tuple(blocks), parts=fitted(section.parts)))
    return tuple(made)


def folded(table: Table, total: float = TEXT_WIDTH) -> list[Table]:
    """A narrow, tall table in halves or thirds beside each other.

    Parameters
    ----------
    table : Table
        A table.
    total : float
        Width of the text. [mm]

    Returns
    -------
    list of Table
        The table itself where it is wide or short; of a very tall one several, each on one page.
    """
    least = _leasts(table)
    width = sum(max(_natural(table, k), least[k]) for k in range(len(table.columns)))
    beside = min(int((total + _GAP) / (width + _GAP)), 3, math.ceil(len(table.rows) / 6))
    if len(table.rows) <= _TALL or beside < 2:
        return [table]
    size = beside * _PIECE
    pieces = [table.rows[k : k + size] for k in range(0, len(table.rows), size)]
    tables = []
    for n, rows in enumerate(pieces, start=1):
        height = math.ceil(len(rows) / beside)
        blank = ("",) * len(table.columns)
        padded = [("", *row) for row in (*rows, *[blank] * (height * beside - len(rows)))]
        lines = [tuple(chain(*padded[line::height]))[1:] for line in range(height)]
        columns = ([Column("", "", "gap"), *table.columns] * beside)[1:]
        caption = table.caption if len(pieces) == 1 else f"{table.caption} ({n} of {len(pieces)})"
        note = table.note if n == len(pieces) else ""
        tables.append(Table(caption, tuple(columns), tuple(lines), note, together=True))
    return tables


def _parted(table: Table) -> list[Table]:
    least = _leasts(table)
    if sum(least) <= _TIGHT * TEXT_WIDTH or len(table.columns) < 3:
        return [table]
    names = [*range(_names(table, least))]
    parts: list[list[int]] = [[*names]]
    for k in range(len(names), len(least)):
        wide = sum(least[i] for i in parts[-1]) + least[k] > _TIGHT * TEXT_WIDTH
        if wide and len(parts[-1]) > len(names):
            parts.append([*names])
        parts[-1].append(k)
    return [
        replace(
            table,
            caption=f"{table.caption} ({n} of {len(parts)})",
            columns=tuple(table.columns[k] for k in part),
            rows=tuple(tuple(row[k] for k in part) for row in table.rows),
            note=table.note if n == len(parts) else "",
        )
        for n, part in enumerate(parts, start=1)
    ]


def _names(table: Table, least: Sequence[float]) -> int:
    """How many columns name a row, in each part: two where names of the first come again."""
    firsts = [row[0] for row in table.rows]
    twice = len(set(firsts)) < len(firsts) and table.columns[1].kind == "text"
    return 2 if twice and len(least) > 3 and sum(least[:2]) < 0.5 * TEXT_WIDTH else 1


def soft(text: str, longest: int) -> str:
    """A text in which words that are too long may be broken."""
    longest = max(longest, 4)
    if not any(len(word) > longest for word in text.split()):
        return text
    return " ".join(
        _breakable(word, longest) if len(word) > longest else word for word in text.split(" ")
    )


def _breakable(word: str, longest: int) -> str:
    """Breaks after signs that part words, and wherever a piece is still too long."""
    pieces = [""]
    for sign in word:
        if len(pieces[-1]) >= longest:
            pieces.append("")
        pieces[-1] += sign
        if sign in "_-/.,:;+" and len(pieces[-1]) > 1:
            pieces.append("")
    return "\u200b".join(piece for piece in pieces if piece)
