"""Workbooks as LibreOffice's flat XML (.fods): the least that holds values and formulas."""

from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from addin.libreoffice.names import programmatic_name
from addin.worksheet.registry import FUNCTIONS

NAMESPACES = " ".join(
    f'xmlns:{short}="urn:oasis:names:tc:opendocument:xmlns:{name}"'
    for short, name in (
        ("office", "office:1.0"),
        ("table", "table:1.0"),
        ("text", "text:1.0"),
        ("of", "of:1.2"),
    )
)


@dataclass(frozen=True)
class Formula:
    """A formula in LibreOffice's own file syntax; with a size, an array formula."""

    text: str
    rows: int = 0
    columns: int = 0


def calls(text):
    """A formula with the names that files hold."""
    for name in sorted(FUNCTIONS, key=len, reverse=True):
        text = text.replace(f"{name}(", f"{programmatic_name(name)}(")
    return text


def write_sheets(path, sheets):
    """Sheets by name, each {(row, column): value or Formula}, counted from 0."""
    body = "".join(
        f"<table:table table:name={quoteattr(name)}>{_rows(cells)}</table:table>"
        for name, cells in sheets.items()
    )
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>\n<office:document {NAMESPACES} '
        'office:version="1.2" office:mimetype="application/vnd.oasis.opendocument.spreadsheet">'
        f"<office:body><office:spreadsheet>{body}</office:spreadsheet></office:body>"
        "</office:document>",
        encoding="utf-8",
    )
    return path


def _rows(cells):
    last = max(row for row, _ in cells)
    return "".join(
        f"<table:table-row>{_row({c: v for (r, c), v in cells.items() if r == row})}"
        "</table:table-row>\n"
        for row in range(last + 1)
    )


def _row(cells):
    return "".join(_cell(cells.get(column)) for column in range(max(cells, default=-1) + 1))


def _cell(value):
    if value is None:
        return "<table:table-cell/>"
    if isinstance(value, Formula):
        size = (
            f' table:number-matrix-rows-spanned="{value.rows}"'
            f' table:number-matrix-columns-spanned="{value.columns}"'
            if value.rows
            else ""
        )
        return f"<table:table-cell table:formula={quoteattr('of:=' + calls(value.text))}{size}/>"
    if isinstance(value, (int, float)):
        return f'<table:table-cell office:value-type="float" office:value="{float(value)!r}"/>'
    return (
        '<table:table-cell office:value-type="string">'
        f"<text:p>{escape(value)}</text:p></table:table-cell>"
    )
