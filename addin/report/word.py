"""The document as a .docx, by python-docx: the same sections, tables, figures and equations.

Equations are Word's own (OMML), page numbers and contents are fields. Text goes into runs, where it
cannot be markup.
"""

from __future__ import annotations

import datetime as dt
import io
import itertools
import math
import zipfile
from collections.abc import Iterator, Sequence
from typing import Any

from addin.contract.palette import PALETTE
from addin.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Listing,
    Paragraph,
    Section,
    SignatureBox,
    Table,
    tone_of,
)
from addin.report.formula import Node
from addin.report.layout import TEXT_WIDTH, column_widths, least_width, rows_together
from addin.report.pages import Place, nodes, page_ends, pieces, whole_tables, word_heights
from addin.report.pdf import ABOVE, BELOW, block_heights

try:
    from docx import Document as new_document
    from docx.enum.style import WD_STYLE_TYPE
    from docx.enum.table import WD_TABLE_ALIGNMENT
    from docx.enum.text import WD_ALIGN_PARAGRAPH, WD_BREAK, WD_TAB_ALIGNMENT
    from docx.oxml import OxmlElement
    from docx.oxml.ns import qn
    from docx.shared import Emu, Mm, Pt, RGBColor

    #: Width, left and right margin of a page whose template states none.
    _USUAL = (Mm(210), Mm(20), Mm(20))
    #: Height, upper and lower margin likewise.
    _USUAL_UPRIGHT = (Mm(297), Mm(25), Mm(25))
except ImportError:  # `torsionbook report` says so before anything is calculated
    pass

#: Metric-compatible fonts exist on every system.
_TEXT_FONT, _TABLE_FONT, _MATH_FONT = "Times New Roman", "Arial", "Cambria Math"
_PAPERS = {"a4": (210.0, 297.0), "us-letter": (215.9, 279.4)}
_NAVY, _GREY, _RULE, _MIST, _INK = "1F3A5F", "595959", "C3CBD6", "E9EEF4", "303030"
#: Parts of another document, by the last word of their relation: styles for Word 2010, a list of sources, a small picture.
_OF_ANOTHER = ("stylesWithEffects", "customXml", "thumbnail")
#: What stands behind the shade among the settings of a cell.
_AFTER_SHADE = ("w:noWrap", "w:tcMar", "w:textDirection", "w:tcFitText", "w:vAlign")
#: Left and right of the text of a cell. [twentieths of a point]
_CELL_MARGIN = 75
#: Height of the letters of a table. [pt]
_LETTERS = 8.0
#: Twentieths of a point in a millimetre.
_TWENTIETHS = 1440.0 / 25.4
#: Height of an entry of the contents by its level, and of what stands above and below them. [mm]
_ENTRIES, _CONTENTS = (5.9, 4.3), 20.0
#: Share of a page that is filled by estimated heights. [1]
_SURE = 0.965
#: Facts up to so many stay on one page. [count]
_FEW = 6
#: Size of the title by its least length. [characters, point]
_TITLES = ((400, 10.0), (160, 13.0), (70, 17.0), (-1, 22.0))
#: Ink and ground of each tone.
_TONES = {
    "good": (PALETTE["pass_ink"][1:], "DDF2E2"),
    "fair": (PALETTE["accepted_ink"][1:], "FFF3CC"),
    "bad": (PALETTE["fail_ink"][1:], "FBDDE0"),
    "open": (_GREY, "EDEDED"),
}


def docx_of(document: Document, template: bytes | None = None) -> bytes:
    """The .docx of a document.

    Parameters
    ----------
    document : Document
        What it says.
    template : bytes, optional
        A .docx whose styles, page, heads and feet it takes; what its pages say is left out.
    """
    writer = _Writer(document, template)
    writer.cover(document)
    writer.contents(document.sections)
    writer.arrange(document)
    for section in document.sections:
        writer.section(section, 1)
    made = io.BytesIO()
    writer.file.save(made)
    return _undated(made.getvalue())


def _heading(section: Section) -> str:
    """Number and title. [text]"""
    return f"{'Appendix ' if section.is_appendix else ''}{section.number}  {section.title}"


def _undated(packed: bytes) -> bytes:
    """The same package with one fixed time on all its parts, so that equal content is equal bytes."""
    made = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(packed)) as source,
        zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as target,
    ):
        for name in source.namelist():
            target.writestr(zipfile.ZipInfo(name), source.read(name), zipfile.ZIP_DEFLATED)
    return made.getvalue()


class _Writer:
    """One .docx under construction."""

    def __init__(self, document: Document, template: bytes | None) -> None:
        self.file = new_document(None if template is None else io.BytesIO(template))
        self.is_own = template is None
        self.bookmarks = 0
        self.style_ids: dict[str, str] = {}
        self.order: Iterator[tuple[int, Place]] = iter(())
        self.ends: frozenset[int] = frozenset()
        self.whole: frozenset[int] = frozenset()
        if template is not None:
            self._empty()
        else:
            self._leave_out()
        for zoom in self.file.settings.element.iterfind(qn("w:zoom")):
            zoom.set(qn("w:percent"), "100")  # demanded by the schema; Word adds it
        self._properties(document)
        self._styles()
        self._page(document)

    # ---- the whole -----------------------------------------------------------------------------

    def _leave_out(self) -> None:
        """Leave out what the empty document of python-docx has of another one: Word drops or rewrites it."""
        for relations in (self.file.part.rels, self.file.part.package.rels):
            for key, relation in list(relations.items()):
                if relation.reltype.rpartition("/")[2] in _OF_ANOTHER:
                    del relations[key]

    def _empty(self) -> None:
        """Take out what the pages of a template say; its last section stays, and with it page, heads and feet."""
        body = self.file.element.body
        for part in list(body):
            if part is not body.sectPr:
                body.remove(part)

    def _properties(self, document: Document) -> None:
        about = self.file.core_properties
        made = dt.datetime.fromtimestamp(document.date, dt.UTC).replace(tzinfo=None)
        about.title = document.cover.title[:255]
        about.author = about.last_modified_by = (document.author or "torsionbook")[:255]
        about.subject, about.comments, about.keywords = document.cover.kind, document.foot, ""
        about.created = about.modified = made
        about.revision = 1

    def _styles(self) -> None:
        normal = self.file.styles["Normal"]
        if self.is_own:
            _font(normal, _TEXT_FONT, 10.0)
            normal.paragraph_format.space_after = Pt(5)
            normal.paragraph_format.line_spacing = 1.08
        for level, size, before, after in ((1, 15.0, 22.0, 7.0), (2, 12.0, 14.0, 5.0)):
            style = self._style(f"Heading {level}")
            if style is None:
                continue
            _font(style, _TABLE_FONT, size, _NAVY, bold=True)
            shape = style.paragraph_format
            shape.space_before, shape.space_after = Pt(before), Pt(after)
            shape.keep_with_next = True
            if level == 1:
                _border(style.element.get_or_add_pPr(), "bottom", _NAVY, 8)
        for name, font, size, colour, after in (
            ("Report caption", _TEXT_FONT, 9.0, _INK, 4.0),
            ("Report note", _TEXT_FONT, 8.5, _GREY, 10.0),
            ("Report cell", _TABLE_FONT, _LETTERS, _INK, 0.0),
            ("Report fact", _TEXT_FONT, 9.5, _INK, 0.0),
        ):
            style = self._style(name)
            if style is None:
                continue
            style.base_style = normal
            _font(style, font if self.is_own else normal.font.name or font, size, colour)
            style.paragraph_format.space_after = Pt(after)
            style.paragraph_format.line_spacing = 1.0
            if name == "Report caption":
                style.paragraph_format.space_before = Pt(10)

    def _style(self, name: str) -> Any:
        """A style to be set; None where a template has set it."""
        if name in self.file.styles:
            return self.file.styles[name] if self.is_own else None
        return self.file.styles.add_style(name, WD_STYLE_TYPE.PARAGRAPH)

    def _page(self, document: Document) -> None:
        page = self.file.sections[0]
        if self.is_own:
            width, height = _PAPERS[document.paper]
            page.page_width, page.page_height = Mm(width), Mm(height)
            page.left_margin = page.right_margin = Mm((width - TEXT_WIDTH) / 2.0)
            page.top_margin, page.bottom_margin = Mm(ABOVE), Mm(BELOW)
            page.header_distance = page.footer_distance = Mm(11)
            page.different_first_page_header_footer = True
        sides = (page.page_width, page.left_margin, page.right_margin)
        whole, left, right = (side or default for side, default in zip(sides, _USUAL, strict=True))
        self.width = (whole - left - right) / Mm(1)
        upright = (page.page_height, page.top_margin, page.bottom_margin)
        high, top, bottom = (
            side or default for side, default in zip(upright, _USUAL_UPRIGHT, strict=True)
        )
        self.height = (high - abs(top) - abs(bottom)) / Mm(1)
        if not self._says_something(page.header):
            head = page.header.paragraphs[0]
            self._line(head, document.head, document.short_title)
            _border(head._p.get_or_add_pPr(), "bottom", _RULE, 4)
        for footer in (page.footer, page.first_page_footer):
            if self._says_something(footer):
                continue
            foot = footer.paragraphs[0]
            self._line(foot, document.foot, "Page ")
            _field(foot, "PAGE", "1")
            _run(foot, " of ", 8.0, _GREY)
            _field(foot, "NUMPAGES", "1")
            _border(foot._p.get_or_add_pPr(), "top", _RULE, 4)

    def _says_something(self, margin: Any) -> bool:
        """Whether a head or foot of a template holds more than a blank line."""
        if self.is_own or margin.is_linked_to_previous:
            return False
        return bool(
            len(margin._element) > 1 or len(margin._element.xpath(".//w:t|.//w:drawing|.//w:pict"))
        )

    def _line(self, paragraph: Any, left: str, right: str) -> None:
        self._styled(paragraph, "Report cell")
        paragraph.paragraph_format.tab_stops.add_tab_stop(Mm(self.width), WD_TAB_ALIGNMENT.RIGHT)
        _run(paragraph, f"{left}\t{right}", 8.0, _GREY)

    # ---- cover and contents --------------------------------------------------------------------

    def cover(self, document: Document) -> None:
        """The first page."""
        if document.logo is not None:
            paragraph = self.file.add_paragraph()
            paragraph.alignment = WD_ALIGN_PARAGRAPH.RIGHT
            picture = paragraph.add_run().add_picture(io.BytesIO(document.logo.data), height=Mm(14))
            if picture.width > Mm(60):
                picture.height = Emu(round(picture.height * Mm(60) / picture.width))
                picture.width = Mm(60)
        cover = document.cover
        size = next(s for n, s in _TITLES if len(cover.title) > n)
        box = self._box(_NAVY, "", 7.0)
        _run(box, cover.kind.upper(), 10.0, "FFFFFF", font=_TABLE_FONT)
        title = box._parent.add_paragraph()
        _run(title, cover.title, size, "FFFFFF", bold=True, font=_TABLE_FONT)
        if cover.subtitle:
            _run(box._parent.add_paragraph(), cover.subtitle, 12.0, "FFFFFF", font=_TABLE_FONT)
        self._gap(6.0)
        self.facts(cover.facts, 46.0)
        ink, ground = _TONES[tone_of(cover.verdict) or "open"]
        box = self._box(ground, ink, 2.5)
        _run(box, f"Overall verdict: {cover.verdict}", 13.0, ink, bold=True, font=_TABLE_FONT)
        _run(box._parent.add_paragraph(), cover.sentence, 9.5, ink)
        for alert in cover.alerts:
            self._gap(4.0)
            self._alert(alert, 9.5)
        self._gap(48.0)
        _run(self._paragraph("Report cell"), "Revisions", 9.0, _NAVY, bold=True)
        self._cells(cover.revisions)
        self._gap(10.0)
        self.signatures(cover.signatures, 10.5)
        self.file.add_paragraph().add_run().add_break(WD_BREAK.PAGE)

    def contents(self, sections: Sequence[Section]) -> None:
        """Sections with fields for their pages, as links."""
        heading = self.file.add_paragraph()
        _run(heading, "Contents", 15.0, _NAVY, bold=True, font=_TABLE_FONT)
        _border(heading._p.get_or_add_pPr(), "bottom", _NAVY, 8)
        every = [
            (s, level) for one in sections for s, level in ((one, 1), *((p, 2) for p in one.parts))
        ]
        # a list that one page would not take stands closer
        loose = sum(_ENTRIES[level - 1] for _, level in every) < self.height - _CONTENTS
        for section, level in every:
            self._entry(section, level, loose=loose)
        self.file.add_paragraph().add_run().add_break(WD_BREAK.PAGE)

    def _entry(self, section: Section, level: int, *, loose: bool) -> None:
        paragraph = self._paragraph("Report fact")
        shape = paragraph.paragraph_format
        shape.left_indent = Mm(6.0 * (level - 1))
        shape.space_before = Pt((5.0, 1.0)[level - 1] if loose else (2.0, 0.0)[level - 1])
        shape.tab_stops.add_tab_stop(Mm(self.width), WD_TAB_ALIGNMENT.RIGHT, 1)
        link = _element("w:hyperlink", anchor=_anchor(section), history="1")
        paragraph._p.append(link)
        _run(paragraph, f"{_heading(section)}\t", 10.0 if level == 1 else 9.5, _INK,
             bold=level == 1, into=link)  # fmt: skip
        _field(paragraph, f"PAGEREF {_anchor(section)} \\h", "", 9.5, _INK, into=link)

    # ---- sections ------------------------------------------------------------------------------

    def arrange(self, document: Document) -> None:
        """Choose where pages end and which tables stay whole, by heights estimated from those of the PDF."""
        sections = document.sections
        heights = word_heights(sections, block_heights(document), self.width, TEXT_WIDTH)
        self.order = enumerate(nodes(sections))
        placed = pieces(sections, heights, self.height)
        self.ends = page_ends(placed, _SURE * self.height, every=True)
        self.whole = whole_tables(sections, heights, self.height)

    def section(self, section: Section, level: int) -> None:
        """A heading and what stands below it."""
        heading = self.file.add_heading(level=level)
        self.bookmarks += 1
        start = _element("w:bookmarkStart", id=self.bookmarks, name=_anchor(section))
        heading._p.append(start)
        at, _ = next(self.order)
        ends = section.is_first_appendix or at in self.ends
        heading.paragraph_format.page_break_before = ends or None
        heading.add_run(_heading(section))
        heading._p.append(_element("w:bookmarkEnd", id=self.bookmarks))
        for block in section.blocks:
            at, node = next(self.order)
            first = self._block(block, held=node.held, whole=at in self.whole)
            if first is not None and at in self.ends:
                first.paragraph_format.page_break_before = True
        for part in section.parts:
            self.section(part, level + 1)

    def _block(self, block: Block, *, held: bool, whole: bool) -> Any:
        """A block; its first paragraph, None where that stands in a table."""
        if isinstance(block, Paragraph):
            paragraph = self._sentences(block)
            paragraph.paragraph_format.keep_with_next = held or None
            return None if block.kind == "alert" else paragraph
        if isinstance(block, Listing):
            return self._listing(block)
        if isinstance(block, Facts):
            self.facts(block.rows, block.width)
        elif isinstance(block, Table):
            return self._table(block, whole=whole)
        elif isinstance(block, Figure):
            return self._figure(block)
        elif isinstance(block, Equation):
            return self._equation(block)
        elif isinstance(block, SignatureBox):
            self.signatures(block, 12.0)
        return None

    def _listing(self, block: Listing) -> Any:
        first = None
        for item in block.items:
            paragraph = self.file.add_paragraph()
            first = first or paragraph
            shape = paragraph.paragraph_format
            shape.left_indent, shape.first_line_indent = Mm(5), Mm(-5)
            shape.space_after = Pt(3)
            shape.tab_stops.add_tab_stop(Mm(5))
            _run(paragraph, f"{block.marker}\t", 10.0, _NAVY)
            paragraph.add_run(item)
        return first

    def _sentences(self, block: Paragraph) -> Any:
        if block.kind == "alert":
            return self._alert(block.text, 10.0)
        paragraph = self._paragraph("Report note" if block.kind == "note" else "Normal")
        paragraph.add_run(block.text)
        if block.kind == "lead":  # the line beside it stands within the margin
            paragraph.paragraph_format.left_indent = Mm(3)
            _border(paragraph._p.get_or_add_pPr(), "left", _NAVY, 14, 6)
        return paragraph

    def _alert(self, text: str, size: float) -> Any:
        ink, ground = _TONES["bad"]
        paragraph = self._box(ground, ink, 2.0)
        _run(paragraph, text, size, ink)
        return paragraph

    def _caption(self, kind: str, number: int, words: str, *, above: bool) -> Any:
        paragraph = self._paragraph("Report caption")
        shape = paragraph.paragraph_format
        shape.keep_with_next = above
        if not above:
            shape.space_before, shape.space_after = Pt(2), Pt(12)
        _run(paragraph, f"{kind} {number}  ", 9.0, _NAVY, bold=True)
        paragraph.add_run(words)
        return paragraph

    def _table(self, table: Table, *, whole: bool) -> Any:
        caption = self._caption("Table", table.number, table.caption, above=True)
        self._cells(table, whole=whole)
        if not table.note:
            self._gap(8.0)
            return caption
        note = self._paragraph("Report note")
        note.paragraph_format.space_before = Pt(3)
        note.add_run(table.note)
        return caption

    def _cells(self, table: Table, *, whole: bool = True) -> None:
        """The cells of a table, its header repeated on each page; rows that stay together do so by their paragraphs."""
        lengths = [len(table.rows)] if whole else rows_together(table)
        last = {0, *itertools.accumulate(lengths)} if not whole else set()
        if table.note:
            last -= {len(table.rows)}
        else:
            last |= {len(table.rows)}
        last -= {0}  # the head stays with the first rows
        lines = [[column.header for column in table.columns], *table.rows]
        rows = self._rows(len(lines), column_widths(table, self.width), "Report cell")
        # a company's page may be narrower than the table: smaller letters, so that no number breaks
        share = min(1.0, self.width / min(least_width(table), TEXT_WIDTH))
        letters = _LETTERS if share == 1.0 else math.floor(2.0 * share * _LETTERS) / 2.0
        for k, ((row, cells), texts) in enumerate(zip(rows, lines, strict=True)):
            if not k:
                _row_setting(row, "w:tblHeader")
            for cell, column, text in zip(cells, table.columns, texts, strict=True):
                paragraph = cell.paragraphs[0]
                if column.kind == "number":
                    paragraph.alignment = WD_ALIGN_PARAGRAPH.RIGHT
                if k not in last:
                    paragraph.paragraph_format.keep_with_next = True
                if column.kind == "gap":
                    continue
                if not k:
                    _shade(cell, _MIST)
                    _edges(cell, top=(_NAVY, 8), bottom=(_RULE, 4))
                    _run(paragraph, text, letters, _NAVY, bold=True, font=_TABLE_FONT)
                    if column.unit:
                        paragraph.add_run().add_break()
                        _run(paragraph, column.unit, letters, _GREY, font=_TABLE_FONT)
                    continue
                _edges(cell, bottom=(_RULE, 4))
                tone = tone_of(text) if column.kind == "verdict" else ""
                if tone:
                    ink = _TONES[tone][0]
                    _run(paragraph, text, letters, ink, bold=tone != "open", font=_TABLE_FONT)
                elif text:
                    run = paragraph.add_run(text)
                    if letters < _LETTERS:
                        run.font.size = Pt(letters)

    def _grid(self, rows: int, widths: Sequence[float]) -> Any:
        """An empty table of fixed widths without borders."""
        grid = self.file.add_table(rows, len(widths))
        grid.alignment = WD_TABLE_ALIGNMENT.LEFT
        grid.autofit = False
        for column, width in zip(grid.columns, widths, strict=True):
            column.width = Mm(width)
        # lines of the table begin where the text does
        indent = _element("w:tblInd", w=_CELL_MARGIN, type="dxa")
        after = ("w:tblBorders", "w:shd", "w:tblLayout", "w:tblCellMar", "w:tblLook")
        grid._tbl.tblPr.insert_element_before(indent, *after)
        margins = _margins("w:tblCellMar", 35, _CELL_MARGIN)
        grid._tbl.tblPr.insert_element_before(margins, "w:tblLook", "w:tblCaption")
        return grid

    def _rows(
        self, count: int, widths: Sequence[float], style: str
    ) -> Iterator[tuple[Any, list[Any]]]:
        """The rows of a new table, none broken over pages, each with its cells in one style."""
        for row in list(self._grid(count, widths).rows):
            _row_setting(row, "w:cantSplit")
            cells = list(row.cells)
            for cell, width in zip(cells, widths, strict=True):
                cell.width = Mm(width)
                self._styled(cell.paragraphs[0], style)
            yield row, cells

    def facts(self, rows: Sequence[tuple[str, str]], width: float) -> None:
        """Names and values."""
        grid = self._rows(len(rows), (width, self.width - width), "Report fact")
        for k, ((_, cells), texts) in enumerate(zip(grid, rows, strict=True), start=1):
            for cell, text, colour in zip(cells, texts, (_NAVY, _INK), strict=True):
                paragraph = cell.paragraphs[0]
                paragraph.paragraph_format.keep_with_next = k < len(rows) <= _FEW
                _run(paragraph, text, 9.0, colour)
        self._gap(5.0)

    def signatures(self, box: SignatureBox, height: float) -> None:
        """Cells to be signed by hand."""
        lines = [
            ("", "Name", "Signature", "Date"),
            *((role, name, "", "") for role, name in box.rows),
        ]
        share = self.width / TEXT_WIDTH
        rows = self._rows(len(lines), [w * share for w in (26.0, 57.0, 57.0, 30.0)], "Report cell")
        for k, ((row, cells), texts) in enumerate(zip(rows, lines, strict=True)):
            if k:
                row.height = Mm(height)
            for n, (cell, text) in enumerate(zip(cells, texts, strict=True)):
                _edges(cell, **dict.fromkeys(("top", "left", "bottom", "right"), (_RULE, 4)))
                paragraph = cell.paragraphs[0]
                paragraph.paragraph_format.keep_with_next = k < len(box.rows)
                if not k:
                    _shade(cell, _MIST)
                colour = _INK if k and n else _NAVY
                _run(paragraph, text, 8.5, colour, bold=not k, font=_TABLE_FONT)
        self._gap(2.0)

    def _figure(self, figure: Figure) -> Any:
        paragraph = self.file.add_paragraph()
        shape = paragraph.paragraph_format
        shape.keep_with_next = True
        shape.space_before, shape.space_after = Pt(6), Pt(2)
        pixels, width = io.BytesIO(figure.png), Mm(min(figure.width, self.width) - 1.0)
        picture = paragraph.add_run().add_picture(pixels, width=width)
        for side in "TBLR":  # LibreOffice moves a picture by 3.2 mm where none is stated
            picture._inline.set(f"dist{side}", "0")
        picture._inline.docPr.set("descr", figure.caption)
        picture._inline.docPr.set("name", f"Figure {figure.number}")
        self._caption("Figure", figure.number, figure.caption, above=False)
        return paragraph

    def _equation(self, equation: Equation) -> Any:
        name = self._paragraph("Report caption")
        name.paragraph_format.keep_with_next = True
        _run(name, equation.name, 9.5, _NAVY, bold=True)
        line = self.file.add_paragraph()
        line.paragraph_format.keep_with_next = True
        stops = line.paragraph_format.tab_stops
        stops.add_tab_stop(Mm(self.width / 2.0), WD_TAB_ALIGNMENT.CENTER)
        stops.add_tab_stop(Mm(self.width), WD_TAB_ALIGNMENT.RIGHT)
        line.add_run("\t")
        line._p.append(_element("m:oMath", *_omml(equation.formula)))
        line.add_run(f"\t({equation.number})")
        where = self._paragraph("Report fact")
        where.paragraph_format.space_after = Pt(8)
        where.add_run(equation.where)
        _run(where, f" Source: {equation.source}.", 9.5, _GREY)
        return name

    # ---- parts ---------------------------------------------------------------------------------

    def _paragraph(self, style: str) -> Any:
        return self._styled(self.file.add_paragraph(), style)

    def _styled(self, paragraph: Any, style: str) -> Any:
        """A paragraph with a style; styles are looked up once, there are thousands of cells."""
        if style not in self.style_ids:
            self.style_ids[style] = self.file.styles[style].style_id
        paragraph._p.style = self.style_ids[style]
        return paragraph

    def _gap(self, points: float) -> None:
        paragraph = self._paragraph("Report cell")
        paragraph.paragraph_format.line_spacing = Pt(max(points, 1.0))

    def _box(self, ground: str, edge: str, inset: float) -> Any:
        """The first paragraph of a coloured box as wide as the text."""
        grid = self._grid(1, (self.width,))
        cell = grid.rows[0].cells[0]
        cell.width = Mm(self.width)
        _shade(cell, ground)
        sizes = (round(size * _TWENTIETHS) for size in (inset, 5.0))
        cell._tc.get_or_add_tcPr().append(_margins("w:tcMar", *sizes))
        if edge:
            _edges(cell, left=(edge, 24))
        return cell.paragraphs[0]


# --- formulas -------------------------------------------------------------------------------------


def _omml(node: Node) -> Iterator[Any]:
    """A formula as elements of Word's mathematics."""
    kind, *rest = node
    if kind == "row":
        for part in rest:
            yield from _omml(part)
    elif kind == "fraction":
        over, under = rest
        yield _element("m:f", _element("m:num", *_omml(over)), _element("m:den", *_omml(under)))
    elif kind == "root":
        settings = _element("m:radPr", _element("m:degHide", val="1"))
        yield _element("m:rad", settings, _element("m:deg"), _base(rest[0]))
    elif kind == "fence":
        signs = _element("m:begChr", val=rest[0]), _element("m:endChr", val=rest[2])
        yield _element("m:d", _element("m:dPr", *signs), _base(rest[1]))
    elif kind == "accent":
        dots = _element("m:chr", val="\u0307" if rest[1] == 1 else "\u0308")
        yield _element("m:acc", _element("m:accPr", dots), _base(rest[0]))
    elif kind == "script":
        base, sub, sup = rest
        below = [_element("m:sub", *_omml(sub))] if sub else []
        above = [_element("m:sup", *_omml(sup))] if sup else []
        tag = "m:sSubSup" if sub and sup else "m:sSub" if sub else "m:sSup"
        yield _element(tag, _base(base), *below, *above)
    else:
        yield _sign(node)


def _base(node: Node) -> Any:
    return _element("m:e", *_omml(node))


def _sign(node: Node) -> Any:
    """One sign or word in its style."""
    style = node[2] if node[0] == "sign" else "upright"
    if style == "upright" and len(node[1]) > 1:
        setting = _element("m:nor")  # a word, not a product of letters
    else:
        setting = _element("m:sty", val={"italic": "i", "bold": "b"}.get(style, "p"))
    text = _text("m:t", f" {node[1]} " if node[0] == "function" else node[1])
    return _element("m:r", _element("m:rPr", setting), text)


# --- elements, runs, fields, cells ----------------------------------------------------------------


def _element(tag: str, *parts: Any, **values: object) -> Any:
    """An element with its children, and attributes of its own namespace."""
    element = OxmlElement(tag)
    for name, value in values.items():
        element.set(qn(f"{tag.partition(':')[0]}:{name}"), str(value))
    element.extend(parts)
    return element


def _text(tag: str, words: str) -> Any:
    """An element with words whose blanks are kept."""
    element = OxmlElement(tag)
    element.text = words
    element.set(qn("xml:space"), "preserve")
    return element


def _margins(tag: str, above: float, beside: float) -> Any:
    """Margins of cells, above as below and left as right. [twentieths of a point]"""
    sizes = {"top": above, "left": beside, "bottom": above, "right": beside}
    sides = (_element(f"w:{side}", w=size, type="dxa") for side, size in sizes.items())
    return _element(tag, *sides)


def _font(style: Any, font: str, size: float, colour: str = _INK, bold: bool = False) -> None:
    style.font.name, style.font.size, style.font.bold = font, Pt(size), bold
    style.font.italic = False
    style.font.color.rgb = RGBColor.from_string(colour)
    fonts = style.element.get_or_add_rPr().get_or_add_rFonts()
    for name in list(fonts.attrib):
        if name.endswith("Theme"):
            del fonts.attrib[name]
    for script in ("w:ascii", "w:hAnsi", "w:cs", "w:eastAsia"):
        fonts.set(qn(script), font)


def _run(
    paragraph: Any,
    text: str,
    size: float,
    colour: str,
    *,
    bold: bool = False,
    font: str = "",
    into: Any = None,
) -> Any:
    run = paragraph.add_run(text)
    run.font.size, run.font.bold = Pt(size), bold
    run.font.color.rgb = RGBColor.from_string(colour)
    if font:
        run.font.name = font
    if into is not None:
        into.append(run._r)
    return run


def _field(
    paragraph: Any, code: str, shown: str, size: float = 8.0, colour: str = _GREY, into: Any = None
) -> None:
    """A field that the word processor fills in."""
    for kind in ("begin", "code", "separate", "shown", "end"):
        run = _run(paragraph, shown if kind == "shown" else "", size, colour, into=into)
        if kind == "code":
            run._r.append(_text("w:instrText", f" {code} "))
        elif kind != "shown":
            # nobody knows its page yet: to be filled in on opening
            dirty = {"dirty": "true"} if kind == "begin" and not shown else {}
            run._r.append(_element("w:fldChar", fldCharType=kind, **dirty))


def _anchor(section: Section) -> str:
    return f"_Section_{section.number.replace('.', '_')}"


def _border(settings: Any, side: str, colour: str, eighths: int, space: int = 1) -> None:
    """A line at one side of a paragraph."""
    edge = _element(f"w:{side}", val="single", sz=eighths, space=space, color=colour)
    settings.insert_element_before(
        _element("w:pBdr", edge), "w:shd", "w:tabs", "w:suppressAutoHyphens", "w:spacing", "w:ind", "w:jc",
        "w:outlineLvl", "w:rPr", "w:sectPr", "w:pPrChange",
    )  # fmt: skip


def _edges(cell: Any, **lines: tuple[str, int]) -> None:
    """Lines at the sides of a cell, top, left, bottom, right: colour and eighths of a point."""
    edges = (
        _element(f"w:{side}", val="single", sz=size, space=0, color=colour)
        for side, (colour, size) in lines.items()
    )
    cell._tc.get_or_add_tcPr().insert_element_before(
        _element("w:tcBorders", *edges), "w:shd", *_AFTER_SHADE
    )


def _shade(cell: Any, colour: str) -> None:
    shade = _element("w:shd", val="clear", color="auto", fill=colour)
    cell._tc.get_or_add_tcPr().insert_element_before(shade, *_AFTER_SHADE)


def _row_setting(row: Any, tag: str) -> None:
    row._tr.get_or_add_trPr().append(OxmlElement(tag))
