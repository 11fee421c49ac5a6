"""The document as a PDF, set by typst.

The template `report.typ` is fixed; all content reaches it as data, so that nothing a user typed is ever
read as markup. Fonts are those inside typst; a script that they lack is taken from the system.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from addin.report.document import (
    Block,
    Document,
    Facts,
    Figure,
    Listing,
    Paragraph,
    Section,
    SignatureBox,
    Table,
    tone_of,
)
from addin.report.layout import (
    TEXT_WIDTH,
    column_widths,
    held_paragraphs,
    room,
    soft,
    stays_together,
)
from addin.report.numbers import clean

TEMPLATE = Path(__file__).with_name("report.typ")
#: Width of the papers. [mm]
_PAPER = {"a4": 210.0, "us-letter": 215.9}
#: Longest word of a header; those of our own are shorter. [characters]
_HEAD = 16
#: Longest word of a paragraph, a fact and the title. [characters]
_LINE, _FACT, _TITLE = 85, 72, 34


def pdf_of(document: Document) -> bytes:
    """The PDF of a document."""
    import typst

    content = json.dumps(_document(document), ensure_ascii=False)
    compiler = typst.Compiler(TEMPLATE.read_bytes(), sys_inputs={"data": content})
    made = compiler.compile(format="pdf", timestamp=document.date)
    assert isinstance(made, bytes)
    return made


def _document(document: Document) -> dict[str, Any]:
    cover = document.cover
    return {
        "paper": document.paper,
        "margin": (_PAPER[document.paper] - TEXT_WIDTH) / 2.0,
        "author": document.author,
        "head": document.head,
        "short_title": document.short_title,
        "foot": document.foot,
        "cover": {
            "kind": cover.kind,
            "logo": None if document.logo is None else [*document.logo.data],
            "logo_form": "" if document.logo is None else document.logo.form,
            "title": soft(cover.title, _TITLE),
            "subtitle": soft(cover.subtitle, 2 * _TITLE),
            "verdict": cover.verdict,
            "tone": tone_of(cover.verdict) or "open",
            "sentence": soft(cover.sentence, _LINE),
            "facts": _facts(cover.facts),
            "alerts": [soft(alert, _LINE) for alert in cover.alerts],
            "revisions": _table(cover.revisions) | {"caption": ""},
            "signatures": [list(row) for row in cover.signatures.rows],
        },
        "sections": [_section(section) for section in document.sections],
    }


def _section(section: Section) -> dict[str, Any]:
    held = held_paragraphs(section)
    return {
        "number": section.number,
        "title": clean(section.title),
        "opens": section.is_first_appendix,
        "appendix": section.is_appendix,
        "blocks": [{**_block(block), "held": k < held} for k, block in enumerate(section.blocks)],
        "parts": [_section(part) for part in section.parts],
    }


def _block(block: Block) -> dict[str, Any]:
    """A block by its fields, under the name of its class; long words may be broken."""
    data: dict[str, Any] = {"type": type(block).__name__.lower(), **vars(block)}
    if isinstance(block, Paragraph):
        data["text"] = soft(block.text, _LINE)
    elif isinstance(block, Listing):
        data["items"] = [soft(item, _LINE) for item in block.items]
    elif isinstance(block, Facts):
        data["rows"] = _facts(block.rows)
    elif isinstance(block, Table):
        data |= _table(block)
    elif isinstance(block, Figure):
        data |= {"svg": block.svg.decode("utf-8"), "caption": soft(block.caption, _LINE)}
        del data["png"]
    elif isinstance(block, SignatureBox):
        data["rows"] = [[soft(word, 24) for word in row] for row in block.rows]
    return data


def _facts(rows: tuple[tuple[str, str], ...]) -> list[list[str]]:
    return [[soft(name, 28), soft(value, _FACT)] for name, value in rows]


def _table(table: Table) -> dict[str, Any]:
    widths = column_widths(table)
    fits = [room(width) for width in widths]
    return {
        "caption": soft(table.caption, _LINE),
        "number": table.number,
        "note": soft(table.note, _LINE),
        "together": stays_together(table),
        "widths": widths,
        "columns": [
            {"header": soft(column.header, max(n, _HEAD)), "unit": column.unit, "kind": column.kind}
            for column, n in zip(table.columns, fits, strict=True)
        ],
        "rows": [
            [
                {"text": soft(text, n), "tone": tone_of(text) if column.kind == "verdict" else ""}
                for text, column, n in zip(row, table.columns, fits, strict=True)
            ]
            for row in table.rows
        ],
    }
