"""Tables fit their page whatever stands in them, and nothing of them is lost on the way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from report_files import pdf_text

from addin.charts.data import chart_blocks
from addin.contract.shown_units import shown_units, template_units
from addin.contract.tables import RESULT_TABLES
from addin.report.document import (
    Block,
    Column,
    Figure,
    Paragraph,
    Section,
    Table,
    numbered,
)
from addin.report.figures import WIDTH, Charts, Pictures
from addin.report.layout import (
    TEXT_WIDTH,
    column_widths,
    fitted,
    folded,
    held_paragraphs,
    soft,
)
from engine.case.data import CaseData, ElementRow, StationRow

KINDS = st.sampled_from(["text", "number", "sentence", "verdict"])
WORDS = st.text(alphabet="abcxyz_-. 0123456789", max_size=60)


def blocks_of(sections: Sequence[Section]) -> Iterator[Block]:
    """Every block in reading order."""
    for section in sections:
        yield from section.blocks
        yield from blocks_of(section.parts)


@st.composite
def tables(draw, most_columns=12, most_rows=30):
    n = draw(st.integers(1, most_columns))
    columns = tuple(Column(f"Header {k}", draw(st.sampled_from(["", "Hz", "lbf·in/rad"])), draw(KINDS))
                    for k in range(n))  # fmt: skip
    numbers = st.floats(-1e6, 1e6).map(lambda v: f"{v:,.1f}")
    rows = tuple(
        tuple(draw(numbers if c.kind == "number" else WORDS) for c in columns)
        for _ in range(draw(st.integers(0, most_rows)))
    )
    return Table("Caption", columns, rows, "Note")


@given(tables())
def test_columns_never_exceed_the_text(table):
    for part in blocks_of(fitted((Section("S", (table,)),))):
        assert isinstance(part, Table)
        widths = column_widths(part)
        assert len(widths) == len(part.columns)
        assert sum(widths) <= TEXT_WIDTH + 1e-6
        assert min(widths) > 0.0


@given(tables())
def test_a_parted_table_holds_every_cell_once(table):
    parts = [b for b in blocks_of(fitted((Section("S", (table,)),))) if isinstance(b, Table)]
    # one column names the rows, or two; each part has them
    names = min(len(part.columns) for part in parts) if len(parts) > 1 else 1
    names = 2 if names > 2 and all(part.columns[1] is table.columns[1] for part in parts) else 1
    kept = [column for part in parts for column in part.columns[names:]]
    assert kept == list(table.columns[names:])
    for n, row in enumerate(table.rows):
        assert [cell for part in parts for cell in part.rows[n][names:]] == list(row[names:])
        assert {part.rows[n][:names] for part in parts} == {row[:names]}


def test_parts_of_a_table_have_both_names_where_the_first_comes_again():
    heads = ("Event", "Element", *(f"Quantity number {k}" for k in range(12)))
    columns = tuple(Column(head, "", "number" if k > 1 else "text") for k, head in enumerate(heads))
    rows = tuple(("fault", name, *["1,234.5"] * 12) for name in ("Motor shaft", "HS coupling"))
    parts = list(blocks_of(fitted((Section("S", (Table("T", columns, rows),)),))))
    assert len(parts) > 1
    for part in parts:
        assert isinstance(part, Table)
        assert [row[:2] for row in part.rows] == [row[:2] for row in rows]


@given(tables(most_columns=3, most_rows=200))
def test_a_folded_table_holds_every_row_in_order(table):
    found = []
    width = len(table.columns)
    for piece in folded(table):
        beside = (len(piece.columns) + 1) // (width + 1)
        halves = [[row[k * (width + 1) : k * (width + 1) + width] for row in piece.rows]
                  for k in range(beside)]  # fmt: skip
        found += [row for half in halves for row in half]
    blank = ("",) * width
    assert [row for row in found if row != blank] == [row for row in table.rows if row != blank]


@given(st.text(max_size=200), st.integers(4, 40))
def test_places_to_break_change_no_letter(text, longest):
    broken = soft(text, longest)
    assert broken.replace("\u200b", "") == text.replace("\u200b", "")
    assert all(len(piece) <= longest for word in broken.split(" ") for piece in word.split("\u200b")
               if "\u200b" in word)  # fmt: skip


def test_short_names_are_left_alone():
    assert soft("HP compressor shaft", 12) == "HP compressor shaft"


def test_numbers_run_through_the_document():
    table, figure = Table("T", (Column("A"),), ()), Figure("F", b"", b"", 1.0, 1.0)
    made = numbered(
        (Section("One", (table, figure), (Section("Part", (table,)),)), Section("Two", (table,)))
    )
    assert [b.number for b in blocks_of(made) if isinstance(b, Table)] == [1, 2, 3]
    assert [made[0].number, made[0].parts[0].number, made[1].number] == ["1", "1.1", "2"]


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(("stations", "pictures"), [(2, 1), (38, 1), (60, 2), (1000, 2)])
def test_a_train_of_any_length_is_drawn_on_pages(stations, pictures):
    case = CaseData(
        stations=tuple(StationRow(f"S{k}", None, 1.0 + k) for k in range(stations)),
        elements=tuple(
            ElementRow(f"E{k}", "shaft", f"S{k}", f"S{k + 1}", 1e6) for k in range(stations - 1)
        ),
    )
    units, _ = shown_units(template_units("SI", RESULT_TABLES), None)
    charts = Pictures(Charts.of(chart_blocks(case, units)), vectors=False)
    drawn = charts.train()
    assert len(drawn) == pictures
    schematic = charts.schematic(case)
    assert schematic is not None
    drawn.append(schematic)
    assert all(abs(figure.width - WIDTH) < 1e-6 and figure.height < 170.0 for figure in drawn)


@pytest.mark.parametrize("above", range(30, 62, 2))
def test_a_broken_table_leaves_three_rows_and_its_note_is_never_alone(tmp_path, above):
    """However full the page is: caption with rows, rows with rows, the note with the last rows."""
    import json

    import typst

    from addin.report.pdf import TEMPLATE, _table

    rows = tuple((f"row{k:02}", "1.5") for k in range(30))
    block = _table(
        Table("Caption", (Column("Name"), Column("Number", "", "number")), rows, "Note.")
    )
    block |= {"type": "table", "together": False, "number": 1}
    start = TEMPLATE.read_text(encoding="utf-8").split("// --- cover")[0]
    lines = f"#for k in range({above}) {{ par(str(k)) }}\n#show-table(data.table)\n"
    data = {"cover": {"title": "T"}, "made": [2026, 11, 26, 0, 0, 0], "author": "", "paper": "a4", "margin": 20, "above": 25, "below": 22, "head": "", "foot": "",
            "short_title": "", "table": block}  # fmt: skip
    made = typst.compile((start + lines).encode(), sys_inputs={"data": json.dumps(data)})
    (tmp_path / "t.pdf").write_bytes(made)
    pages = pdf_text(tmp_path / "t.pdf").split("\f")
    for page in pages:
        count = page.count("row")
        assert count == 0 or count >= 3
        assert "Caption" not in page or count
        assert "Note." not in page or count
        # what a page continues it says, above the head that is repeated
        assert ("(continued)" in page) == (count > 0 and "row00" not in page)
        assert count == 0 or "Number" in page


def test_a_paragraph_that_leads_to_something_is_held():
    text, table = Paragraph("All margins are kept.", "lead"), Table("T", (Column("A"),), ())
    long = Paragraph("x" * 601)
    for blocks, parts, held in (
        ((text, table), (), 1),
        ((text, Paragraph("See below."), table), (), 2),
        ((text,), (Section("Part", (table,)),), 1),
        ((text,), (), 0),
        ((long, table), (), 0),
        ((table, text, table), (), 0),
    ):
        assert held_paragraphs(Section("S", blocks, parts)) == held


@pytest.mark.parametrize("kind", ["lead", "text", "note"])
@pytest.mark.parametrize("above", range(20, 56, 4))
def test_a_heading_stands_on_the_page_of_its_figure(tmp_path, above, kind):
    """However full the page is: heading, one line and the figure that they lead to."""
    import json

    import typst

    from addin.report.pages import nodes
    from addin.report.pdf import TEMPLATE, _section

    drawing = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 170 90"/>'
    figure = Figure("Interference", drawing, b"", 170.0, 90.0, 1)
    chapter = Section("Margins", (Paragraph("All kept.", kind), figure), number="5")
    section = _section(chapter, enumerate(nodes((chapter,))))
    start = TEMPLATE.read_text(encoding="utf-8").split("// --- cover")[0]
    lines = f"#for k in range({above}) {{ par(str(k)) }}\n#show-section(data.section, 1)\n"
    data = {"cover": {"title": "T"}, "made": [2026, 11, 26, 0, 0, 0], "author": "", "paper": "a4", "margin": 20, "above": 25, "below": 22, "head": "", "foot": "",
            "short_title": "", "section": section}  # fmt: skip
    made = typst.compile((start + lines).encode(), sys_inputs={"data": json.dumps(data)})
    (tmp_path / "t.pdf").write_bytes(made)
    pages = pdf_text(tmp_path / "t.pdf").split("\f")
    assert [p for p in pages if "Margins" in p] == [p for p in pages if "Interference" in p]
