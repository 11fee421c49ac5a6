"""The company's own logo and Word template."""

from __future__ import annotations

import io
import zipfile

import docx
import pytest
from docx.shared import Mm, Pt, RGBColor
from PIL import Image
from report_files import ROOT, docx_text, torsionbook

from addin.report.company import CompanyFileError, read_logo, read_word_template

SOURCE = ROOT / "templates" / "example_proposed.xlsx"
RED = RGBColor(0x99, 0x00, 0x00)
SVG = '<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="40" height="10"><rect width="40" height="10"/></svg>'


def picture(form: str, size: tuple[int, int] = (40, 20)) -> bytes:
    made = io.BytesIO()
    Image.new("RGB", size, (200, 0, 0)).save(made, form)
    return made.getvalue()


@pytest.fixture
def letter(tmp_path):
    """A template with a head of its own, red headings, wide margins and a sample text."""
    file = docx.Document()
    page = file.sections[0]
    page.page_width, page.page_height = Mm(210), Mm(297)
    page.left_margin = page.right_margin = Mm(30)
    page.header.paragraphs[0].text = "ACME Turbo, confidential"
    file.styles["Heading 1"].font.color.rgb = RED
    file.add_paragraph("Sample text of the template")
    file.save(tmp_path / "letter.docx")
    return tmp_path / "letter.docx"


def as_template(path, word="template"):
    """The same file with the content type of a .dotx, or of one with macros."""
    target = path.with_name(f"{word}.dotx")
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(target, "w") as archive:
        for name in source.namelist():
            data = source.read(name)
            if name == "[Content_Types].xml":
                kind = {
                    "template": b"wordprocessingml.template.main",
                    "macros": b"x.macroEnabled.main",
                }
                data = data.replace(b"wordprocessingml.document.main", kind[word])
            archive.writestr(name, data)
    return target


@pytest.mark.parametrize("kind", ["docx", "dotx"])
def test_a_template_gives_styles_page_and_head(letter, tmp_path, undrawn, kind):
    given = letter if kind == "docx" else as_template(letter)
    done = torsionbook(
        "report", SOURCE, "--docx", tmp_path / "out.docx", "--word-template", given, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    made = docx.Document(str(tmp_path / "out.docx"))
    page = made.sections[0]
    assert page.left_margin == pytest.approx(Mm(30), abs=700)
    assert page.header.paragraphs[0].text == "ACME Turbo, confidential"
    assert made.styles["Heading 1"].font.color.rgb == RED
    text = docx_text(tmp_path / "out.docx")
    assert "Sample text of the template" not in text
    assert "Appendix E Audit" in text
    # nothing is wider than the text of the template's page
    widths = [sum(column.width for column in table.columns) for table in made.tables]
    assert max(widths) <= Mm(150.5)
    # of 170 mm: a full table has letters smaller by as much, so that no number breaks; a narrow one has not
    peaks, verdicts = (
        next(
            t
            for t in made.tables
            if t.cell(0, 0).text.startswith(head) and t.cell(0, 1).text.startswith(second)
        )
        for head, second in (("Element", "Maximum"), ("Check", "Coverage"))
    )
    assert peaks.cell(1, 1).paragraphs[0].runs[0].font.size == Pt(7)
    assert verdicts.cell(1, 1).paragraphs[0].runs[0].font.size is None
    assert len(made.inline_shapes) > 0
    assert max(shape.width for shape in made.inline_shapes) <= Mm(150)


@pytest.mark.parametrize("form", ["PNG", "JPEG"])
def test_a_logo_stands_on_the_cover(tmp_path, undrawn, form):
    (tmp_path / "logo").write_bytes(picture(form, (900, 100)))
    outputs = ("--pdf", tmp_path / "out.pdf", "--docx", tmp_path / "out.docx")
    done = torsionbook("report", SOURCE, *outputs, "--logo", tmp_path / "logo", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    first = docx.Document(str(tmp_path / "out.docx")).inline_shapes[0]
    assert first.width == Mm(60)
    assert first.height == pytest.approx(Mm(60) / 9, rel=1e-3)


def test_an_svg_logo_is_for_the_pdf_alone(tmp_path, undrawn):
    (tmp_path / "logo.svg").write_text(SVG)
    done = torsionbook(
        "report",
        SOURCE,
        "--pdf",
        tmp_path / "out.pdf",
        "--logo",
        tmp_path / "logo.svg",
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    done = torsionbook(
        "report",
        SOURCE,
        "--docx",
        tmp_path / "o.docx",
        "--logo",
        tmp_path / "logo.svg",
        cwd=tmp_path,
    )
    assert done.returncode == 1
    assert "is an SVG picture, which Word documents do not take. Name a PNG or JPEG." in done.stderr
    assert not (tmp_path / "o.docx").exists()


def test_files_that_cannot_be_used_are_told(letter, tmp_path):
    (tmp_path / "logo.bmp").write_bytes(picture("BMP"))
    (tmp_path / "large.png").write_bytes(picture("PNG") + bytes(5_000_000))
    for name, said in (
        ("none.png", "cannot be read"),
        ("logo.bmp", "is not a PNG, JPEG or SVG picture"),
        ("large.png", "at most 5 MB are taken"),
    ):
        with pytest.raises(CompanyFileError, match=said):
            read_logo(tmp_path / name, for_word=False)
    for path, said in (
        (tmp_path / "none.docx", "cannot be read"),
        (tmp_path / "logo.bmp", "is not a Word document"),
        (ROOT / "templates" / "blank_si.xlsx", "is not a Word document"),
        (as_template(letter, "macros"), "has macros"),
    ):
        with pytest.raises(CompanyFileError, match=said):
            read_word_template(path)


def test_a_template_without_a_word_document_is_refused(letter, tmp_path):
    done = torsionbook(
        "report", SOURCE, "--pdf", tmp_path / "out.pdf", "--word-template", letter, cwd=tmp_path
    )
    assert done.returncode == 2
    assert "--docx" in done.stderr
