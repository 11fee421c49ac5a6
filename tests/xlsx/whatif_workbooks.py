"""Workbooks with What-If data tables and with circular references, as Excel stores them."""

import re
from pathlib import Path

import xlsxwriter
from rich_workbooks import with_parts

OUT = "xl/worksheets/sheet2.xml"
ITERATION = b'<calcPr calcId="191029" iterate="1" iterateCount="200" iterateDelta="1E-9"/>'


def whatif_workbook(path: Path) -> Path:
    """In!A1 = 1. On Out: C1 is varied in three data tables over formulas with C1 and In!A1, and one without In!A1.

    A3:B5 in a column, with the formula in B2; D3:G4 in a row, with the formula in D4; I2:K4 in both directions (C1 and
    C2), with the formula in I2; M3:N5 in a column, on nothing of sheet In. Their sums stand in P1, P2, P3, P4, the
    double of the first in P5, and In!A1 doubled in P6.
    """
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.write_number("A1", 1)
    sheet.write_number("C1", 7)
    sheet.write_number("C2", 2)
    for row, value in enumerate((1, 2, 3), start=3):
        sheet.write_number(f"A{row}", value)
        sheet.write_number(f"B{row}", value)
        sheet.write_number(f"M{row}", value)
        sheet.write_number(f"N{row}", value + 100)
    sheet.write_formula("B2", "=C1*In!A1", None, 7)
    sheet.write_formula("N2", "=C1+100", None, 107)
    sheet.write_row("E3", (1, 2, 3))
    sheet.write_formula("D4", "=C1+In!A1", None, 8)
    sheet.write_row("E4", (2, 3, 4))
    sheet.write_formula("I2", "=C1*C2*In!A1", None, 14)
    sheet.write_row("J2", (1, 2))
    sheet.write_column("I3", (1, 2))
    sheet.write_row("J3", (1, 2))
    sheet.write_row("J4", (2, 4))
    for cell, formula, value in (
        ("P1", "=SUM(B3:B5)", 6), ("P2", "=SUM(E4:G4)", 9), ("P3", "=SUM(J3:K4)", 9),
        ("P4", "=SUM(N3:N5)", 306), ("P5", "=P1*2", 12), ("P6", "=In!A1*2", 2),
    ):  # fmt: skip
        sheet.write_formula(cell, formula, None, value)
    book.close()

    def with_tables(data: bytes) -> bytes:
        for cell, table in (
            (b"B3", b'ref="B3:B5" dt2D="0" dtr="0" r1="C1"'),
            (b"E4", b'ref="E4:G4" dt2D="0" dtr="1" r1="C1"'),
            (b"J3", b'ref="J3:K4" dt2D="1" dtr="1" r1="C1" r2="C2"'),
            (b"N3", b'ref="N3:N5" dt2D="0" dtr="0" r1="C1"'),
        ):
            head = b'<c r="%s">' % cell
            assert head in data
            data = data.replace(head, head + b'<f t="dataTable" %s/>' % table)
        return data

    return with_parts(path, {}, {OUT: with_tables})


#: Cells of the tables on In!A1, with what In!A1 = 5 makes of them; by arithmetic.
VARIED = {
    "B3": 5, "B4": 10, "B5": 15, "E4": 6, "F4": 7, "G4": 8, "J3": 5, "K3": 10, "J4": 10, "K4": 20,
}  # fmt: skip
HANGING = {"P1": 30, "P2": 21, "P3": 45, "P5": 60}
RENEWED = {"B2": 35, "D4": 12, "I2": 70, "P6": 10}
UNTOUCHED = {"N2": 107, "N3": 101, "N4": 102, "N5": 103, "P4": 306, "C1": 7}


def circular_workbook(path: Path, *, iterated: bool = True) -> Path:
    """In!A1 = 3. On Out: A1 and B1 hang on each other (A1 = In!A1 + B1/2, B1 = A1/2), C1 on A1; E1 = E2, E2 = E1/2 + 1
    go in a circle of their own, E3 hangs on them; D1 and D2 hang on In!A1 alone.
    """
    book = xlsxwriter.Workbook(str(path))
    source, sheet = book.add_worksheet("In"), book.add_worksheet("Out")
    source.write_number("A1", 3)
    for cell, formula, value in (
        ("A1", "=In!A1+B1/2", 4), ("B1", "=A1/2", 2), ("C1", "=A1*10", 40), ("D1", "=In!A1*2", 6),
        ("D2", "=D1+1", 7), ("E1", "=E2", 2), ("E2", "=E1/2+1", 2), ("E3", "=E1*3", 6),
        ("D3", "=E3+In!A1", 9),
    ):  # fmt: skip
        sheet.write_formula(cell, formula, None, value)
    book.close()
    if not iterated:
        return path

    def iterating(data: bytes) -> bytes:
        return re.sub(rb"<calcPr[^>]*/>", ITERATION, data)

    return with_parts(path, {}, {"xl/workbook.xml": iterating})
