"""A template as engineers return it: moved, renamed, reordered, protected, full of things of their own.

Built by the product's own template builder from other places, and by XlsxWriter; what XlsxWriter does not
know (threaded comments, printer settings, external links, x14 validations, custom XML, and what is in
office_objects.py) is put into the package as Excel stores it.
"""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import xlsxwriter
from office_objects import pivot_sheet, pivot_tables, rich_cells, rich_values, slicers
from office_package import added, edited, part_of_sheet, related

from addin.contract.sheets import CASE_HALVES, OF_ELEMENTS, SHEETS, part_named
from addin.template import build as template
from addin.template import front_sheets
from addin.template.examples import EXAMPLES

VBA = bytes.fromhex("D0CF11E0A1B11AE1") + bytes(range(256)) * 16
#: Sheets as they are shipped → as this engineer calls them.
RENAMED = {
    "Results": "Forced response (2026)",
    "Train": "Mass-elastic",
    "Start": "Owner's start",
}
#: Tables that stand elsewhere: rows and columns were inserted before them.
MOVED = {
    "Verdicts": "K14",
    "Stations": "C9", "ModeDamping": "K9", "Elements": "C33", "Meshes": "C57",
    "MotorTorque": "B8", "LoadTorque": "H8", "TorqueTime": "L9",
    "Materials": "B7", "SNPoints": "I7",
    "Excitations": "C8", "EventTorque": "C27", "MotorEvents": "C52", "AirGapTorque": "C70",
    "NaturalFrequencies": "B29", "ModeShapes": "L31",
    "SeparationMargins": "B28",
    "SteadyState": "C11",
    "EffectChoices": "C44", "StartConditions": "F9", "CaseVerdicts": "F9",
    "Audit": "B9",
}  # fmt: skip
#: On sheet `Results`, where `MOVED` has `SteadyState`: its column `Torque` and the row of its first results.
TORQUE_COLUMN, FIRST_RESULT = part_named("Steady state").at("I"), 14
#: First row of `StartupPeaks`, below its caption, units and header.
FIRST_PEAK = OF_ELEMENTS + 3
_REL = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_MS = "http://schemas.microsoft.com/office"


def sheet_name(shipped: str) -> str:
    """What a sheet is called in the engineer's workbook."""
    return RENAMED.get(shipped, shipped)


def engineers_workbook(
    path: Path, *, macros: bool = False, edit_example: Callable[[Any], Any] | None = None
) -> Path:
    """The proposed example after a year in an office; .xlsm with macros."""
    example = replace(EXAMPLES["proposed"], provenance=())
    if edit_example is not None:
        example = edit_example(example)
    sheets = tuple(
        replace(s, tables={name: MOVED.get(name, at) for name, at in s.tables.items()})
        for s in SHEETS
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(template, "SHEETS", sheets)
        halves = (("D", CASE_HALVES[0][1]), ("J", CASE_HALVES[1][1]))
        patch.setattr(front_sheets, "CASE_HALVES", halves)
        blocks = template._chart_rows(example, "us")
        options = {"default_format_properties": {"font_name": "Arial", "font_size": 10}}
        with xlsxwriter.Workbook(path, options) as book:
            builder = template._Builder(book, "us", example, blocks, variant=template.PLAIN)
            builder.build()
            own = _own_sheet(book)
            _ornaments(book, builder.sheets, own)
            pivot_sheet(book)
            rich_cells(own, {"image_data": io.BytesIO(_png())})
            if macros:
                book.add_vba_project(io.BytesIO(VBA), True)
    return with_office_parts(reordered(renamed(path)))


def _own_sheet(book: Any) -> Any:
    """Formulas of the engineer on our results: by name, by cell, on each other, on nothing of ours."""
    own = book.add_worksheet("Our summary")
    own.write_column(
        "A1",
        ["largest", "times rated", "third torque", "by cell", "fails", "words", "today", "of its own",
         "on each other", "sorted", "unknown"],
    )  # fmt: skip
    own.write_formula("B1", "=MAX(StartupPeaks[Maximum torque])", None, 1.0)
    own.write_formula("B2", "=B1/RatedTorque", None, 1.0)
    own.write_formula("B3", "=INDEX(SteadyState[Torque],3)", None, 1.0)
    own.write_formula("B4", f"=Results!${TORQUE_COLUMN}${FIRST_RESULT}*2", None, 1.0)
    own.write_formula("B5", '=COUNTIF(SeparationMargins[Verdict],"fail*")', None, 99)
    own.write_formula("B6", '="Verdict: "&OverallVerdict', None, "Verdict: old")
    own.write_formula("B7", "=TODAY()", None, 40000)
    own.write_formula("B8", "=2*3", None, 6)
    own.write_formula("B9", "=B1+B3", None, 2.0)
    own.write_dynamic_array_formula("B10:B10", "=_xlfn._xlws.SORT(B1:B1)", None, 1.0)
    own.write_formula("B11", "=MY_MACRO(StartupPeaks[Maximum torque])", None, 12.5)
    own.write_array_formula("D1:D2", "{=Results!C32:C33*2}", None, 1.0)
    own.write_number("D2", 1.0)
    own.add_table(
        "F1:G4",
        {"name": "OurLimits", "data": [["A", 1], ["B", 2], ["C", 3]],
         "columns": [{"header": "Item"}, {"header": "Limit"}]},
    )  # fmt: skip
    own.write_formula("I1", "=[1]Limits!$A$1", None, 7.5)
    return own


def _ornaments(book: Any, sheets: Mapping[str, Any], own: Any) -> None:
    """Everything XlsxWriter knows of what people put into workbooks."""
    steady, peaks, summary = sheets["Results"], sheets["Start"], sheets["Summary"]
    torques = f"${TORQUE_COLUMN}${FIRST_RESULT}:${TORQUE_COLUMN}${FIRST_RESULT}"
    chart = book.add_chart({"type": "column"})
    chart.add_series({"name": "torque", "values": f"=Results!{torques}"})
    chart.add_series({"values": f"=Start!$C${FIRST_PEAK}:$C${FIRST_PEAK}", "y2_axis": True})
    chart.set_title({"name": "Our own chart"})
    own.insert_chart("K2", chart)
    scatter = book.add_chart({"type": "scatter", "subtype": "smooth"})
    scatter.add_series(
        {"categories": "=Results!$C$32:$C$32", "values": "=Results!$D$32:$D$32",
         "trendline": {"type": "linear"}, "y_error_bars": {"type": "percentage", "value": 5}}
    )  # fmt: skip
    own.insert_chart("K20", scatter)
    own.add_sparkline("H1", {"range": f"Results!{torques.replace('$', '')}"})
    own.add_sparkline("H2", {"range": "'Our summary'!B1:B3"})
    own.conditional_format(
        "B1:B5", {"type": "data_bar", "data_bar_2010": True, "bar_no_border": True}
    )
    own.insert_textbox("K40", "Ask the vendor", {"textlink": "='Our summary'!$A$1"})
    own.insert_checkbox("J1", True)
    own.write_url("A14", "https://example.org/procedure", string="our procedure")
    own.write_rich_string("A15", "2 × ", book.add_format({"bold": True}), "slip")
    own.set_background(io.BytesIO(_png()))
    response = part_named("Steady state")
    steady.write_comment(
        response.at("C12"), "as agreed with the vendor", {"x_scale": 2, "visible": True}
    )
    peaks.set_header("&L&G", {"image_left": "logo.png", "image_data_left": io.BytesIO(_png())})
    summary.insert_image(
        "M1", "logo.png", {"image_data": io.BytesIO(_png()), "description": "logo"}
    )
    steady.set_column(response.at("E:E"), None, None, {"hidden": True})
    sheets["Audit"].set_column("B:B", None, None, {"level": 1})
    sheets["Train"].set_column("E:E", None, None, {"hidden": True})
    sheets["Train"].protect("secret", {"format_cells": True})
    steady.protect("secret")
    sheets["Notes"].hide()
    book.set_custom_property("Project", "K-101")
    book.define_name("OurLargest", "='Our summary'!$B$1")
    book.define_name("OurTorques", "=SteadyState[Torque]")


def _png() -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", 2, 2, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"\0\xff\0\0\0\xff\0" * 2)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    )


# --- what Excel does to the package ---------------------------------------------------------------


def parts_of(path: Path) -> dict[str, bytes]:
    """All parts of a workbook."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _store(path: Path, parts: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(
                zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED
            )
    return path


def renamed(path: Path) -> Path:
    """Sheets under other names, everywhere they are named."""
    parts = parts_of(path)
    for name, data in parts.items():
        if not name.endswith(".xml"):
            continue
        text = data.decode("utf-8")
        for old, new in RENAMED.items():
            quoted = "'" + new.replace("'", "''") + "'!"
            text = text.replace(f"'{old}'!", quoted)
            text = re.sub(rf"(?<![\w'’]){re.escape(old)}!", lambda _, q=quoted: q, text)
            if name == "xl/workbook.xml":
                text = text.replace(f'<sheet name="{old}"', f'<sheet name="{new}"')
            if name == "docProps/app.xml":
                text = text.replace(f">{old}<", f">{new}<")
        parts[name] = text.encode("utf-8")
    return _store(path, parts)


def reordered(path: Path) -> Path:
    """Results before notes and inputs, the own sheet last; local names follow their sheets.

    LibreOffice 7.4 reads formulas on tables of later sheets as errors, hence not the own sheet first.
    """
    parts = parts_of(path)
    text = parts["xl/workbook.xml"].decode("utf-8")
    sheets = re.findall(r"<sheet [^>]*/>", text)
    kinds = {sheet_name(s.name): s.kind for s in SHEETS}
    ranks = {None: 4, "result": 1, "notes": 2, "summary": 3, "input": 3}
    names = [re.search('name="([^"]*)"', s).group(1) for s in sheets]
    order = sorted(range(len(sheets)), key=lambda k: ranks[kinds.get(names[k])])
    block = "".join(sheets[k] for k in order)
    text = re.sub(r"<sheets>.*?</sheets>", lambda _: f"<sheets>{block}</sheets>", text)
    at = {old: new for new, old in enumerate(order)}
    text = re.sub(r'localSheetId="(\d+)"', lambda m: f'localSheetId="{at[int(m.group(1))]}"', text)
    text = re.sub(r'activeTab="(\d+)"', lambda m: f'activeTab="{at[int(m.group(1))]}"', text)
    parts["xl/workbook.xml"] = text.encode("utf-8")
    return _store(path, parts)


def with_office_parts(path: Path) -> Path:
    """Threaded comments, printer settings, an external link, x14 validations, custom XML, and what is in office_objects."""
    parts = parts_of(path)
    own = part_of_sheet(parts, "Our summary")
    steady = part_of_sheet(parts, sheet_name("Results"))
    new: dict[str, tuple[bytes, str]] = {
        "xl/threadedComments/threadedComment1.xml": (
            f'<ThreadedComments xmlns="{_MS}/spreadsheetml/2018/threadedcomments"><threadedComment '
            'ref="D12" dT="2026-01-02T03:04:05.00" personId="{A}" id="{B}"><text>agreed?</text>'
            "</threadedComment></ThreadedComments>".encode(),
            "application/vnd.ms-excel.threadedcomments+xml",
        ),
        "xl/persons/person.xml": (
            f'<personList xmlns="{_MS}/spreadsheetml/2018/threadedcomments"><person displayName="A. '
            'Engineer" id="{A}" userId="x" providerId="None"/></personList>'.encode(),
            "application/vnd.ms-excel.person+xml",
        ),
        "xl/printerSettings/printerSettings1.bin": (
            bytes(range(256)) * 4,
            "application/vnd.openxmlformats-officedocument.spreadsheetml.printerSettings",
        ),
        "xl/externalLinks/externalLink1.xml": (
            '<externalLink xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><externalBook '
            f'xmlns:r="{_REL}" r:id="rId1"><sheetNames><sheetName val="Limits"/></sheetNames>'
            '<sheetDataSet><sheetData sheetId="0"><row r="1"><cell r="A1"><v>7.5</v></cell></row>'
            "</sheetData></sheetDataSet></externalBook></externalLink>".encode(),
            "application/vnd.openxmlformats-officedocument.spreadsheetml.externalLink+xml",
        ),
        "xl/externalLinks/_rels/externalLink1.xml.rels": (
            '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
            f'<Relationship Id="rId1" Type="{_REL}/externalLinkPath" Target="file:///other.xlsx" '
            'TargetMode="External"/></Relationships>'.encode(),
            "",
        ),
        "customXml/item1.xml": (b"<mine><x a='1'/></mine>", "application/xml"),
    }
    for name, (data, kind) in new.items():
        added(parts, name, kind, data.decode() if name.endswith("l") else data)
    related(parts, steady, f"{_MS[:-7]}/office/2017/10/relationships/threadedComment",
            "../threadedComments/threadedComment1.xml")  # fmt: skip
    printer = related(
        parts, steady, f"{_REL}/printerSettings", "../printerSettings/printerSettings1.bin"
    )
    edited(parts, steady, "<pageSetup ", f'<pageSetup r:id="{printer}" ')
    related(
        parts,
        "xl/workbook.xml",
        f"{_MS[:-7]}/office/2017/10/relationships/person",
        "persons/person.xml",
    )
    link = related(
        parts, "xl/workbook.xml", f"{_REL}/externalLink", "externalLinks/externalLink1.xml"
    )
    edited(
        parts, "xl/workbook.xml", "<definedNames>",
        f'<externalReferences><externalReference r:id="{link}"/></externalReferences><definedNames>',
    )  # fmt: skip
    edited(parts, "xl/workbook.xml", "<bookViews>",
          '<workbookProtection workbookPassword="CC1A" lockStructure="1"/><bookViews>')  # fmt: skip
    rule = (
        '<ext xmlns:x14="http://schemas.microsoft.com/office/spreadsheetml/2009/9/main" '
        'uri="{CCE6A557-97BC-4b89-ADB6-D9C93CAAB3DF}"><x14:dataValidations '
        'xmlns:xm="http://schemas.microsoft.com/office/excel/2006/main" count="1">'
        '<x14:dataValidation type="list" allowBlank="1"><x14:formula1><xm:f>Lists!$A$2:$A$9</xm:f>'
        "</x14:formula1><xm:sqref>C1</xm:sqref></x14:dataValidation></x14:dataValidations></ext>"
    )
    edited(parts, own, "<extLst>", f"<extLst>{rule}")
    pivot_tables(parts)
    slicers(parts)
    rich_values(parts)
    return _store(path, parts)
