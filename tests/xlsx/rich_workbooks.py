"""Workbooks for these tests: full of what people put into theirs, each built anew by XlsxWriter."""

import io
import struct
import zipfile
import zlib
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import xlsxwriter

CALC_CHAIN_TYPE = "application/vnd.openxmlformats-officedocument.spreadsheetml.calcChain+xml"
FAKE_VBA = bytes.fromhex("D0CF11E0A1B11AE1") + bytes(range(256)) * 20
MODES = [[1, 12.5, 750.0], [2, 31.25, 1875.0], [3, 77.0, 4620.0]]


def tiny_png() -> io.BytesIO:
    """A 2 x 2 picture."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", 2, 2, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"\0\xff\0\0\0\xff\0" * 2)
    return io.BytesIO(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    )


def rich_workbook(path: Path, *, macros: bool = False) -> Path:
    """A workbook with inputs, a result table with a user's notes around it, summary formulas, charts and ornaments.

    ``Frequencies``: table ``Modes`` in B5:E8 (header in row 5, three modes), formulas in column E, notes beside (G6)
    and far below (B40). ``Summary``: formulas on the table, on inputs, on each other, and some that hang on neither.
    """
    book = xlsxwriter.Workbook(str(path))
    book.set_properties({"title": "Train", "created": datetime(2024, 1, 2)})
    book.set_calc_mode("auto")
    bold = book.add_format({"bold": True, "bg_color": "#FFFFCC"})
    number = book.add_format({"num_format": "0.000", "font_color": "blue"})
    case, modes, summary, history, own = (
        book.add_worksheet(name)
        for name in ("Case", "Frequencies", "Summary", "Start-up", "Owner's notes")
    )
    if macros:
        book.add_vba_project(io.BytesIO(FAKE_VBA), True)
    _case_sheet(book, case, bold)
    _modes_sheet(book, modes, number)
    _summary_sheet(summary)
    _history_sheet(book, history)
    own.write("A1", "Ask the vendor about the coupling")
    own.write_formula("A2", "=SIN(1)", value=0.8414709848078965)
    own.write_formula("A3", "=TODAY()", value=45000)
    own.insert_textbox("C3", "A text box of the user")
    own.insert_image("C10", "dot.png", {"image_data": tiny_png(), "description": "dot"})
    own.set_header("&L&G&CTrain", {"image_left": "dot.png", "image_data_left": tiny_png()})
    own.protect("", {"format_cells": True})
    book.close()
    return path


def _case_sheet(
    book: xlsxwriter.Workbook, sheet: xlsxwriter.worksheet.Worksheet, bold: object
) -> None:
    sheet.write_row("A1", ["Quantity", "Value", "Unit"], bold)
    sheet.write_row("A2", ["Rated power", 4500.0, "hp"])
    sheet.write_row("A3", ["Title", "old title", ""])
    sheet.write_formula("B4", "=B2*0.7457", value=4500.0 * 0.7457)
    sheet.merge_range("A8:C8", "merged words", bold)
    sheet.write_comment("B2", "as on the name plate")
    sheet.data_validation("C2:C3", {"validate": "list", "source": ["hp", "kW"]})
    book.define_name("RatedPower", "=Case!$B$2")
    book.define_name("Title", "=Case!$B$3")
    book.define_name("Case!Local", "=Case!$C$2")
    book.define_name("Twice", "=Case!$B$2*2")


def _modes_sheet(
    book: xlsxwriter.Workbook, sheet: xlsxwriter.worksheet.Worksheet, number: object
) -> None:
    sheet.write("B2", "Natural frequencies")
    sheet.add_table(
        "B5:E8",
        {
            "name": "Modes",
            "columns": [
                {"header": "Mode"},
                {"header": "Frequency", "format": number},
                {"header": "CPM"},
                {"header": "Ratio", "formula": "=[Frequency]/60"},
            ],
            "data": MODES,
        },
    )
    for row, mode in enumerate(MODES, 6):
        sheet.write_formula(f"E{row}", "=Modes[[#This Row],[Frequency]]/60", None, mode[1] / 60)
    sheet.write("G6", "a note beside the table")
    sheet.write("B40", "a note far below")
    sheet.conditional_format(
        "C6:C8", {"type": "cell", "criteria": ">", "value": 50, "format": number}
    )
    sheet.conditional_format("C6:C7", {"type": "data_bar", "data_bar_2010": True})
    sheet.conditional_format("D6:D8", {"type": "data_bar", "data_bar_2010": True})
    sheet.data_validation("B6:B8", {"validate": "integer", "criteria": ">", "value": 0})
    sheet.add_sparkline("G7", {"range": "Frequencies!C6:C8"})
    sheet.freeze_panes(5, 1)
    chart = book.add_chart({"type": "column"})
    chart.add_series(
        {
            "name": "=Frequencies!$C$5",
            "categories": "=Frequencies!$B$6:$B$8",
            "values": "=Frequencies!$C$6:$C$8",
        }
    )
    sheet.insert_chart("I2", chart)
    other = book.add_chart({"type": "line"})
    other.add_series({"values": "=Case!$B$2:$B$2"})
    sheet.insert_chart("I20", other)


def _summary_sheet(sheet: xlsxwriter.worksheet.Worksheet) -> None:
    freqs = [mode[1] for mode in MODES]
    sheet.write_formula("B1", "=MAX(Modes[Frequency])", value=max(freqs))
    sheet.write_formula("B2", "=COUNT(Modes[Mode])", value=3)
    sheet.write_formula("B3", "=B1*2", value=2 * max(freqs))
    sheet.write_formula("B4", '=IF(B1>50,"high","low")', value="high")
    sheet.write_formula("B5", "=RatedPower/2", value=2250)
    sheet.write_formula("B6", "=Twice", value=9000)
    sheet.write_formula("B7", "=1+1", value=2)
    sheet.write_formula("B8", "=B1>50", value=True)
    sheet.write_formula("B9", '=Title&"!"', value="old title!")
    sheet.write_array_formula("D1:D3", "{=Frequencies!C6:C8*2}", value=25.0)
    sheet.write_number("D2", 62.5)
    sheet.write_number("D3", 154.0)


def _history_sheet(book: xlsxwriter.Workbook, sheet: xlsxwriter.worksheet.Worksheet) -> None:
    sheet.write_row("A4", ["Time", "Speed"])
    for row in range(5, 15):
        sheet.write_row(f"A{row}", [row - 5, 100.0 * row])
    chart = book.add_chart({"type": "scatter"})
    chart.add_series({"categories": "='Start-up'!$A$5:$A$14", "values": "='Start-up'!$B$5:$B$14"})
    sheet.insert_chart("E2", chart)


def with_parts(
    path: Path, added: dict[str, bytes], edit: dict[str, Callable[[bytes], bytes]] | None = None
) -> Path:
    """The workbook with parts added and others edited; dates stay fixed."""
    with zipfile.ZipFile(path) as archive:
        parts = {entry.filename: archive.read(entry) for entry in archive.infolist()}
    for name, change in (edit or {}).items():
        changed = change(parts[name])
        assert changed != parts[name], f"nothing edited in {name}"
        parts[name] = changed
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in (parts | added).items():
            archive.writestr(
                zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED
            )
    return path


def with_calc_chain(path: Path) -> Path:
    """The workbook with a calculation chain and a custom XML part."""
    chain = (
        '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
        '<calcChain xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">'
        '<c r="B4" i="1"/><c r="B1" i="3"/></calcChain>'
    )
    return with_parts(
        path,
        {"xl/calcChain.xml": chain.encode(), "customXml/item1.xml": b"<mine><x a='1'/></mine>"},
        {
            "[Content_Types].xml": lambda data: data.replace(
                b"</Types>",
                f'<Override PartName="/xl/calcChain.xml" ContentType="{CALC_CHAIN_TYPE}"/></Types>'.encode(),
            ),
            "xl/_rels/workbook.xml.rels": lambda data: data.replace(
                b"</Relationships>",
                b'<Relationship Id="rId99" Type="http://schemas.openxmlformats.org/officeDocument/2006/'
                b'relationships/calcChain" Target="calcChain.xml"/></Relationships>',
            ),
        },
    )


def parts_of(path: Path) -> dict[str, bytes]:
    """All parts of a workbook, by the names in the file, which Windows shows with slashes."""
    with zipfile.ZipFile(path) as archive:
        return {entry.orig_filename: archive.read(entry) for entry in archive.infolist()}


def changed_parts(before: Path, after: Path) -> set[str]:
    """Names of parts that differ, are new or are gone."""
    old, new = parts_of(before), parts_of(after)
    return {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}
