"""Words for a reader who has the document alone: no table, scalar or sheet of a workbook by its name."""

from __future__ import annotations

import re
from dataclasses import replace

from addin.contract.tables import EVERY_INPUT, RESULT_TABLES, SCALARS
from addin.report.document import Block, Facts, Listing, Paragraph, Section, Table


def _lower(words: str) -> str:
    return words[0].lower() + words[1:]


#: Names of one word, such as Voltage, are words of a reader already.
_WORDS = {
    spec.name: _lower(spec.name_in_words) for spec in SCALARS if " " in spec.name_in_words
} | {
    spec.name: _lower(spec.caption.removesuffix(" (optional)"))
    for spec in (*RESULT_TABLES, *EVERY_INPUT)
    if any(letter.isupper() for letter in spec.name[1:]) and spec.caption[1].islower()
}
_NAMES = re.compile(rf"\b({'|'.join(_WORDS)})\b")
#: What engineers are told to look at is in the appendix of a report.
_EFFECTS = re.compile(r"\b([Ss])ee sheet Effects and accuracy\b")
_COLUMN = re.compile(r"\bcolumn (?=[A-Z])")
_SHEET = re.compile(r" on sheet (?:Torque and motor|[A-Z]\w+)\b")


def plain(text: str) -> str:
    """A sentence of a result with the program's names in words.

    Parameters
    ----------
    text : str
        A sentence.

    Returns
    -------
    str
        ``table motor data`` for ``table MotorData``, ``field slip`` for ``FieldSlip``. [text]

    Examples
    --------
    >>> plain("Not every motor has a row in table MotorData. Type FieldSlip on sheet Case.")
    'Not every motor has a row in table motor data. Type field slip.'
    """
    text = _EFFECTS.sub(r"\1ee appendix A", text)
    text = _COLUMN.sub("", _SHEET.sub("", text))
    return _NAMES.sub(lambda found: _WORDS[found[1]], text)


def for_readers(section: Section) -> Section:
    """A section whose sentences are plain; names in the columns of its tables stay as typed."""
    return replace(
        section,
        blocks=tuple(map(_block, section.blocks)),
        parts=tuple(map(for_readers, section.parts)),
    )


def _block(block: Block) -> Block:
    if isinstance(block, Paragraph):
        return replace(block, text=plain(block.text))
    if isinstance(block, Listing):
        return replace(block, items=tuple(map(plain, block.items)))
    if isinstance(block, Facts):
        return replace(block, rows=tuple((name, plain(value)) for name, value in block.rows))
    if isinstance(block, Table):
        wordy = [column.kind == "sentence" for column in block.columns]
        rows = tuple(
            tuple(
                plain(cell) if is_sentence else cell
                for cell, is_sentence in zip(row, wordy, strict=True)
            )
            for row in block.rows
        )
        return replace(block, rows=rows, note=plain(block.note))
    return block
