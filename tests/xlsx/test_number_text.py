"""What number formats show, against LibreOffice, and what a reader takes from it."""

from __future__ import annotations

import html
import math
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import xlsxwriter

from addin.xlsx.number_text import read_number, section_of, shown_number, shown_text

VALUES = (
    0.0,
    0.004,
    0.5,
    1.0,
    12.345,
    999.96,
    1234.567,
    9999999.9,
    -0.4,
    -12.345,
    -1234.567,
    1.5e-7,
)
FORMATS = (
    "0", "0.0", "0.00", "#,##0", "#,##0.00", "000.0", "0.00E+00", "##0.0E+0", "0.0,", "#,##0.00,,",
    "0%", "0.00%", '"9"#,##0', '#,##0" rpm"', '0"."00', "0-0", "\\x0.0", "0.00;(0.00)", "+0.0;-0.0;0.0",
    "[>=1000]#,##0;0.000", "[<1000]0.00;[>=1000]0.0", "[Red]0.0", "0.0;;", '0;-0;"nil"',
)  # fmt: skip


@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_texts_are_those_of_another_program(tmp_path: Path):
    """LibreOffice drops the sign of negative numbers in other sections than the first: these are left out."""
    with xlsxwriter.Workbook(tmp_path / "shown.xlsx") as book:
        sheet = book.add_worksheet()
        for row, code in enumerate(FORMATS):
            look = book.add_format({"num_format": code})
            for column, value in enumerate(VALUES):
                sheet.write_number(row, column, value, look)
        sheet.set_column(0, len(VALUES), 40)
    profile = f"-env:UserInstallation=file://{tmp_path}/profile"
    command = ["soffice", profile, "--headless", "--convert-to", "html", "shown.xlsx"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=120)
    page = (tmp_path / "shown.html").read_text(encoding="utf-8")
    shown = [
        [
            html.unescape(re.sub("<[^>]*>", "", cell))
            for cell in re.findall("<td[^>]*>(.*?)</td>", row, re.DOTALL)
        ]
        for row in re.findall("<tr[^>]*>(.*?)</tr>", page, re.DOTALL)
    ]
    assert len(shown) == len(FORMATS)
    for code, texts in zip(FORMATS, shown, strict=True):
        for value, text in zip(VALUES, texts, strict=True):
            if value >= 0 or "[>" not in code:
                assert (code, value, shown_number(value, code).text.strip()) == (
                    code,
                    value,
                    text.strip(),
                )


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("1,234.5", "", 1234.5), ("1 234.5", "", 1234.5), ("(12)", "", -12.0), ("\u22123.0", "", -3.0), (".5", "", 0.5),
        ("1.2E-03", "", 0.0012), ("12.5%", "", 0.125), ("30.1 Hz", "Hz", 30.1), ("5 %", "%", 5.0),
    ],
)  # fmt: skip
def test_a_text_is_read_as_people_read_it(text, unit, number):
    read = read_number(text, unit)
    assert read is not None
    assert math.isclose(read[0], number, rel_tol=1e-12)


@pytest.mark.parametrize(
    "text", ["", "OK", "1-2", "12 kHz", "9:30", "(5", "1.2.3", "~5", "--5", "5 or 6", "-"]
)
def test_other_texts_are_no_number(text):
    assert read_number(text, "Hz") is None


def test_dates_and_fractions_are_not_shown():
    assert not shown_number(12.0, "yyyy-mm-dd").is_plain
    assert not shown_number(12.5, "# ?/?").is_plain
    assert not shown_number(12.5, "[h]:mm").is_plain


def test_texts_have_a_section_of_their_own():
    assert shown_text("fail", "0.00").text == "fail"
    assert shown_text("fail", ";;;").text == ""
    assert shown_text("fail", '0;0;0;"pass"').text == "pass"
    assert shown_text("fail", '"not "@').text == "not fail"


def test_a_semicolon_in_quotes_separates_no_sections():
    assert section_of(-1.0, '"a;b"0;-0') == "-0"
    assert shown_number(5.0, '0";"').text == "5;"
