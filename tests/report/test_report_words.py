"""A report speaks to a reader who has neither the program nor the workbook."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from report_files import ROOT

from addin.contract.tables import EVERY_INPUT, RESULT_TABLES, SCALARS
from addin.reading.one_file import read_checked
from addin.report.build import build_document
from addin.report.document import Document, Facts, Listing, Paragraph, Section, Table
from addin.report.plain import plain
from addin.writing.recalculate import recalculate_case

NAMES = [
    spec.name
    for spec in (*SCALARS, *EVERY_INPUT, *RESULT_TABLES)
    if re.search(r"[a-z][A-Z]", spec.name)
]
#: Commands, files, cells, sheets, tables and scalars of the program.
OF_THE_PROGRAM = re.compile(
    r"torsionbook [a-z]|\.xlsx|\bJSON\b|\b[Ww]orkbooks?\b|\bcommands?\b|\bsheets? [A-Z]|\bcells? [A-Z]+\d|"
    rf"\b(?:{'|'.join(NAMES)})\b"
)


def document_of(name: str) -> Document:
    read = read_checked(ROOT / "templates" / f"example_{name}.xlsx")
    calculation, _ = recalculate_case(read, {}, lambda stage: None)
    return build_document(f"example_{name}.xlsx", read, calculation, vectors=False, pixels=False)


def texts(section: Section) -> Iterator[str]:
    yield section.title
    for block in section.blocks:
        if isinstance(block, Paragraph):
            yield block.text
        elif isinstance(block, Listing):
            yield from block.items
        elif isinstance(block, Facts):
            yield from (text for row in block.rows for text in row)
        elif isinstance(block, Table):
            yield from (block.caption, block.note, *(c.header for c in block.columns))
            yield from (cell for row in block.rows for cell in row)
    for part in section.parts:
        yield from texts(part)


@pytest.mark.parametrize(
    "name",
    [
        "proposed",
        *(
            pytest.param(n, marks=pytest.mark.slow)
            for n in ("modified", "backlash", "motor", "studies")
        ),
    ],
)
def test_the_chapters_name_nothing_of_the_program(name):
    document = document_of(name)
    chapters = [section for section in document.sections if section.number.isdigit()]
    said = [text for chapter in chapters for text in texts(chapter)]
    assert len(said) > 500
    assert [text for text in said if OF_THE_PROGRAM.search(text)] == []
    cover = document.cover
    fixed = (cover.sentence, *cover.alerts, *(text for row in cover.facts for text in row))
    assert [text for text in fixed if OF_THE_PROGRAM.search(text)] == []


def test_the_appendices_name_no_table_and_no_scalar():
    """What checks the document may: the command that compares digests, and what software made it."""
    document = document_of("proposed")
    said = [t for section in document.sections if section.number.isalpha() for t in texts(section)]
    assert any("table motor data" in text for text in said)
    named = re.compile(rf"\b(?:{'|'.join(NAMES)})\b|\bsheet [A-Z]")
    assert [text for text in said if named.search(text)] == []


def test_appendices_are_numbered_by_letters_behind_the_chapters():
    numbers = [section.number for section in document_of("proposed").sections]
    chapters = sum(number.isdigit() for number in numbers)
    assert numbers[:chapters] == [str(k) for k in range(1, chapters + 1)]
    assert numbers[chapters:] == list("ABCDE")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("FieldSlip and PullOutTorque are not given", "field slip and pull out torque are not given"),
        ("no row in table MotorData", "no row in table motor data"),
        ("See sheet Effects and accuracy for it (see sheet Effects and accuracy).",
         "See appendix A for it (see appendix A)."),
        ("Type both on sheet Torque and motor.", "Type both."),
        ("Voltage of the line", "Voltage of the line"),
        ("FieldSlips", "FieldSlips"),
    ],
)  # fmt: skip
def test_names_become_words(text, said):
    assert plain(text) == said
