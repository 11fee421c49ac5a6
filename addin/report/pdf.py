"""The document as a PDF, set by typst, tagged and of PDF/A-2a where its texts and pictures allow it.

The template `report.typ` is fixed; all content reaches it as data, so that nothing a user typed is ever
read as markup. Fonts are those inside typst; a script that they lack is taken from the system.
"""

from __future__ import annotations

import itertools
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

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
from addin.report.layout import TEXT_WIDTH, column_widths, room, rows_together, soft
from addin.report.numbers import clean
from addin.report.pages import FEW_FACTS, Place, nodes, page_ends, pieces, whole_tables

TEMPLATE = Path(__file__).with_name("report.typ")
#: What the PDF keeps to: PDF/A-2a for archives, PDF/UA-1 for readers that speak it.
STANDARDS: list[Literal["a-2a", "ua-1"]] = ["a-2a", "ua-1"]
#: Width and height of the papers. [mm]
_PAPERS = {"a4": (210.0, 297.0), "us-letter": (215.9, 279.4)}
#: Margins above and below the text. [mm]
ABOVE, BELOW = 25.0, 22.0
#: How far the heights of a page may be off: spaces between blocks are not measured. [mm]
_DOUBT = 1.5
#: The chapters on one endless page, and where everything on it begins.
_GALLEY = """
#set page(height: auto, header: none, footer: none)
#for s in data.sections { show-section(s, 1) }
#mark
#context [#metadata(query(<mark>).map(m => m.location().position().y / 1mm)) <begins>]
"""
#: Longest word of a header; those of our own are shorter. [characters]
_HEAD = 16
#: Longest word of a paragraph, a fact and the title. [characters]
_LINE, _FACT, _TITLE = 85, 72, 34


def pdf_of(document: Document) -> bytes:
    """The PDF of a document."""
    import typst

    heights, page = block_heights(document), text_height(document.paper)
    sections = document.sections
    ends = page_ends(pieces(sections, heights, page), page - _DOUBT, every=True)
    content = _document(document, ends, whole_tables(sections, heights, page))
    words = {"data": json.dumps(content, ensure_ascii=False)}

    def compiled(standards: list[Any]) -> Any:
        compiler = typst.Compiler(TEMPLATE.read_bytes(), sys_inputs=words)
        return compiler.compile(format="pdf", timestamp=document.date, pdf_standards=standards)

    try:
        made = compiled(STANDARDS)
    except typst.TypstError:  # a typed sign that no font shows, or a picture that no archive takes
        made = compiled([])
    assert isinstance(made, bytes)
    return made


def text_height(paper: str) -> float:
    """Height of the text of a page. [mm]"""
    return _PAPERS[paper][1] - ABOVE - BELOW


def block_heights(document: Document) -> list[float]:
    """Heights of headings and blocks, set one below the other on one endless page.

    Parameters
    ----------
    document : Document
        The document.

    Returns
    -------
    list of float
        Of each heading and block in reading order, with the space below it. [mm]
    """
    import typst

    content = _document(_undrawn(document)) | {"galley": True}
    opening = TEMPLATE.read_text(encoding="utf-8").split("// --- cover")[0]
    compiler = typst.Compiler(
        f"{opening}{_GALLEY}".encode(),
        sys_inputs={"data": json.dumps(content, ensure_ascii=False)},
    )
    found: Any = compiler.query("<begins>", field="value", one=True)
    begins = json.loads(found) if isinstance(found, (str, bytes)) else found
    return [float(b) - float(a) for a, b in itertools.pairwise(begins)]


def _undrawn(document: Document) -> Document:
    """The document with blank pictures of the same size."""

    def blank(section: Section) -> Section:
        blocks = tuple(
            replace(
                block,
                svg=b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %f %f"/>'
                % (block.width, block.height),
            )
            if isinstance(block, Figure)
            else block
            for block in section.blocks
        )
        return replace(section, blocks=blocks, parts=tuple(map(blank, section.parts)))

    return replace(document, sections=tuple(map(blank, document.sections)))


def _document(
    document: Document,
    ends: frozenset[int] = frozenset(),
    whole: frozenset[int] = frozenset(),
) -> dict[str, Any]:
    """All that the template shows; pages end before the nodes `ends`, the tables `whole` are not broken."""
    cover = document.cover
    order = enumerate(nodes(document.sections))
    return {
        "paper": document.paper,
        "margin": (_PAPERS[document.paper][0] - TEXT_WIDTH) / 2.0,
        "above": ABOVE,
        "below": BELOW,
        "author": document.author,
        "made": list(time.gmtime(document.date)[:6]),
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
            "revisions": _table(cover.revisions) | {"caption": "", "together": True},
            "signatures": [list(row) for row in cover.signatures.rows],
        },
        "sections": [_section(section, order, ends, whole) for section in document.sections],
    }


def _section(
    section: Section,
    order: Iterator[tuple[int, Place]],
    ends: frozenset[int] = frozenset(),
    whole: frozenset[int] = frozenset(),
) -> dict[str, Any]:
    place, _ = next(order)
    blocks = []
    for block in section.blocks:
        at, node = next(order)
        # a paragraph that leads to something is held on its page
        settings = {"held": node.held, "ends": at in ends}
        if isinstance(block, Table):
            settings["together"] = block.together or at in whole
        blocks.append(_block(block) | settings)
    return {
        "number": section.number,
        "title": clean(section.title),
        "ends": place in ends or section.is_first_appendix,
        "appendix": section.is_appendix,
        "blocks": blocks,
        "parts": [_section(part, order, ends, whole) for part in section.parts],
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
        data["breakable"] = len(block.rows) > FEW_FACTS
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
        "together": table.together,
        "spans": rows_together(table),
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
