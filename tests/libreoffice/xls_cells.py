"""Numbers of a workbook in the old binary form (.xls, BIFF8), where they stand as doubles.

LibreOffice writes numbers into .ods and .xlsx with 15 digits; here all 64 bits are kept. The texts
of array formulas are left out by it, so they are read from an .xlsx, and so is what each cell is.
"""

import struct

import olefile
import openpyxl

BOUNDSHEET, BOF, FORMULA, NUMBER, RK, MULRK = 0x85, 0x809, 0x6, 0x203, 0x27E, 0xBD


def read_cells(xls, xlsx):
    """Sheet → {(row, column): double, text, or None for an empty text}, counted from 0."""
    doubles = read_doubles(xls)
    return {
        sheet.title: {
            (at := (cell.row - 1, cell.column - 1)): (cell.value or None)
            if isinstance(cell.value, str) or cell.value is None
            else doubles[sheet.title][at]
            for row in sheet.iter_rows()
            for cell in row
        }
        for sheet in openpyxl.load_workbook(xlsx, data_only=True)
    }


def read_doubles(path):
    """Sheet → {(row, column): double}; cells of other kinds stand as something that is none."""
    with olefile.OleFileIO(path) as file:
        records = list(_records(file.openstream("Workbook").read()))
    starts = {
        struct.unpack_from("<I", content)[0]: content[8 : 8 + content[6]].decode("latin-1")
        for _, kind, content in records
        if kind == BOUNDSHEET
    }
    sheets, cells = {}, {}
    for place, kind, content in records:
        if kind == BOF and place in starts:
            cells = sheets[starts[place]] = {}
        elif kind in (NUMBER, FORMULA):
            cells[_place(content)] = struct.unpack_from("<d", content, 6)[0]
        elif kind == RK:
            cells[_place(content)] = _short(content[6:10])
        elif kind == MULRK:
            row, column = _place(content)
            for i in range((len(content) - 6) // 6):
                cells[row, column + i] = _short(content[6 + 6 * i : 10 + 6 * i])
    return sheets


def _records(data):
    """Place, kind and content of each record."""
    at = 0
    while at + 4 <= len(data):
        kind, length = struct.unpack_from("<HH", data, at)
        yield at, kind, data[at + 4 : at + 4 + length]
        at += 4 + length


def _place(content):
    return struct.unpack_from("<HH", content)


def _short(content):
    """A number of 30 bits: the first of a double, or a whole one; perhaps of hundreds."""
    (bits,) = struct.unpack("<i", content)
    if bits & 2:
        value = float(bits >> 2)
    else:
        (value,) = struct.unpack("<d", bytes(4) + struct.pack("<i", bits & ~3))
    return value / 100.0 if bits & 1 else value
