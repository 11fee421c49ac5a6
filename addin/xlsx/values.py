"""What may stand in a cell, and its XML.

Text is always written as text (an inline string): nothing that a caller passes as ``str`` can become a formula.
Formulas are a type of their own.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from typing import Any, TypeGuard

from addin.xlsx.xml_part import Element, main

#: Stands in the cells of a row where type and value of a formula go: before the end of the tag, and behind the formula. No
#: XML can hold this character.
FORMULA_CUT = "\0"
_NUMBERS_AND_BLANKS = frozenset([float, type(None)])
MAX_TEXT = 32_767
MAX_FORMULA = 8_192
ERROR_CODES = frozenset(
    [
        "#NULL!",
        "#DIV/0!",
        "#VALUE!",
        "#REF!",
        "#NAME?",
        "#NUM!",
        "#N/A",
        "#GETTING_DATA",
        "#SPILL!",
        "#CALC!",
    ]
)

_ILLEGAL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_ESCAPE = re.compile("_(?=x[0-9A-Fa-f]{4}_)")
_ESCAPED = re.compile("_x([0-9A-Fa-f]{4})_")
_NEEDS_SPACE = re.compile(r"\A\s|\s\Z|[\n\t]|  ")


@dataclass(frozen=True)
class ErrorValue:
    """An error value of a cell, such as ``#N/A``."""

    code: str

    def __post_init__(self) -> None:
        if self.code not in ERROR_CODES:
            raise ValueError(f"{self.code!r} is not an error value of a cell")


@dataclass(frozen=True)
class Formula:
    """A formula, and the value that was read with it; one that is written is calculated when saving."""

    #: The formula in file syntax: English names, commas, ``Table[[#This Row],[Column]]``,
    #: ``_xlfn.`` where Excel wants it. A leading ``=`` is dropped.
    text: str
    #: Its value; None = not known.
    cached: bool | int | float | str | ErrorValue | None = None

    def __post_init__(self) -> None:
        text = self.text.strip().removeprefix("=")
        if not text or len(text) > MAX_FORMULA or _ILLEGAL.search(text):
            raise ValueError(f"not a valid cell formula: {self.text[:80]!r}")
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "cached", clean_constant(self.cached))


Constant = bool | int | float | str | ErrorValue | None
CellValue = Constant | Formula


def clean(value: Any) -> CellValue:
    """The value that a cell will hold.

    Every number becomes a Python float, as a sheet knows no other; control characters in text become U+FFFD; text is cut at 32,767 UTF-16 units, the
    limit of a cell.

    Raises
    ------
    ValueError
        For a number that is not finite: a sheet has no such number, and writing another one would be a lie.
    TypeError
        For anything else that is not a value of a cell.
    """
    return value if isinstance(value, Formula) else clean_constant(value)


def clean_constant(value: Any) -> Constant:
    """As `clean`, for values other than formulas."""
    kind = type(value)
    if kind is float:
        return _finite(value)
    if value is None or kind is bool or kind is ErrorValue:
        return value  # type: ignore[no-any-return]
    if isinstance(value, str):
        return _clean_text(value)
    if isinstance(value, numbers.Real):
        return _finite(_as_double(value))
    if kind.__module__ == "numpy" and kind.__name__ in ("bool", "bool_"):
        return bool(value)
    raise TypeError(f"a cell cannot hold {value!r} ({kind.__name__})")


def _as_double(value: numbers.Real) -> float:
    try:
        return float(value)
    except OverflowError as problem:
        raise ValueError("a cell cannot store a number beyond 1.8e308") from problem


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ValueError(f"{value} is not a valid cell number; write blank or a text instead")
    return value


def _clean_text(text: str) -> str:
    if not text.isascii():
        # UTF-16 units, because that is what the limit of a cell counts; a pair of surrogates is one character here.
        text = text.encode("utf-16-le", "surrogatepass")[: 2 * MAX_TEXT].decode(
            "utf-16-le", "replace"
        )
    return _ILLEGAL.sub("\ufffd", text[:MAX_TEXT].replace("\r\n", "\n").replace("\r", "\n"))


def are_plain_numbers(values: Sequence[Any]) -> TypeGuard[Sequence[float | None]]:
    """Whether values are numbers and blanks that a cell holds as they are."""
    return _NUMBERS_AND_BLANKS.issuperset(map(type, values)) and math.isfinite(
        sum(filter(None, values))
    )


def number_text(value: float) -> str:
    """Shortest text that reads back as the same double; whole numbers without a point."""
    return repr(value).removesuffix(".0")


def rows_xml(
    top: int,
    starts: tuple[str, ...],
    styles: Sequence[tuple[str | None, ...]],
    rows: Sequence[Sequence[CellValue]],
) -> tuple[list[str], list[Sequence[str | None]]]:
    """The ``<c>`` elements of each row in the default namespace; nothing for blank cells without a style.

    Beside them stand the texts of its numbers, as long as all rows so far hold nothing but numbers and blanks; whole ones
    end in ``.0``.

    Parameters
    ----------
    top : int
        Number of the first row.
    starts : tuple of str
        What each cell of a row begins with, up to the letters of its column.
    styles : sequence of tuple of (str or None)
        Styles of the cells, row by row.
    rows : sequence of sequence of CellValue
        Their values.
    """
    texts: list[str] = []
    numbers: list[Sequence[str | None]] = []
    aligned: Sequence[str | None] = ()
    alike = None
    form: list[str] = []
    are_numbers = has_blanks = all_numbers = True
    for number, (style, row) in enumerate(zip(styles, rows, strict=True), top):
        kinds = tuple(map(type, row))
        if alike != (style, kinds):
            alike = style, kinds
            form = _row_form(starts, style, kinds).split("#")
            are_numbers = _NUMBERS_AND_BLANKS.issuperset(kinds)
            has_blanks = type(None) in kinds
            all_numbers = all_numbers and are_numbers
        if not are_numbers:
            shown = tuple(
                [
                    repr(value) if type(value) is float else _rest_of_cell(value)
                    for value in row
                    if value is not None
                ]
            )
        elif has_blanks:
            aligned = [None if value is None else repr(value) for value in row]
            shown = tuple([text for text in aligned if text is not None])
        else:
            aligned = shown = tuple(map(repr, row))
        if all_numbers:
            numbers.append(aligned)
        # Numbers as `number_text` writes them.
        texts.append((str(number).join(form) % shown).replace(".0</v>", "</v>"))
    return texts, numbers


@lru_cache(maxsize=1024)
def _row_form(
    starts: tuple[str, ...], styles: tuple[str | None, ...], kinds: tuple[type, ...]
) -> str:
    """The row with a mark for its number, and places for its values: rows of a table are alike."""
    texts = []
    for start, style, kind in zip(starts, styles, kinds, strict=True):
        named = f'{start}#"{_style_xml(style)}'
        if kind is float:
            texts.append(f"{named}><v>%s</v></c>")
        elif kind is not type(None):
            texts.append(f"{named}%s")
        elif style:
            texts.append(f"{named}/>")
    return "".join(texts)


def _style_xml(style: str | None) -> str:
    # What is no number in the file may break out of the attribute.
    return f' s="{style}"' if style and style.isdigit() else ""


def _rest_of_cell(value: CellValue) -> str:
    if isinstance(value, str):
        return f' t="inlineStr"><is>{_text_xml(value)}</is></c>'
    if isinstance(value, Formula):
        return f"{FORMULA_CUT}><f>{escape(value.text, quote=False)}</f>{FORMULA_CUT}</c>"
    kind, text = constant_text(value)
    named = f' t="{kind}"' if kind else ""
    return f"{named}><v>{text}</v></c>"


def constant_text(value: Constant) -> tuple[str, str | None]:
    """Cell type (empty for a number) and text of ``<v>``; None when there is no value."""
    if value is None:
        return "", None
    if isinstance(value, bool):
        return "b", "1" if value else "0"
    if isinstance(value, float | int):
        return "", number_text(value)
    if isinstance(value, ErrorValue):
        return "e", value.code
    return "str", _ESCAPE.sub("_x005F_", _ILLEGAL.sub("\ufffd", value))


def _text_xml(text: str) -> str:
    if not text:
        return "<t/>"  # as it is stored
    body = escape(_ESCAPE.sub("_x005F_", text), quote=False)
    return f'<t xml:space="preserve">{body}</t>' if _NEEDS_SPACE.search(text) else f"<t>{body}</t>"


# A plain cell: its kind, and its value or its inline text.
_PLAIN = re.compile(
    r'<c r="\w+"(?: s="\d+")?(?: t="(\w+)")?>(?:<v>([^<]*)</v>|<is><t(?:/>|[^<>/]*>)([^<]*)(?:</t>)?</is>)</c>'
)
_F, _V, _IS, _T, _R, _RPH = (main(tag) for tag in ("f", "v", "is", "t", "r", "rPh"))


def read_cell(cell: Element, shared_strings: Any) -> CellValue:
    """Value of a ``<c>`` element."""
    constant = read_constant(cell, shared_strings)
    formula = cell.find(_F)
    return constant if formula is None else formula_or_constant(formula.text or "", constant)


def formula_or_constant(text: str, constant: Constant) -> CellValue:
    """What a cell with the text of a formula holds."""
    try:
        return Formula(text, constant) if text else constant
    except ValueError:  # longer than any program takes, or blank, or a number that is none
        return constant


def read_constant(cell: Element, shared_strings: Any) -> Constant:
    """Value of a ``<c>`` element, of a formula its cached value."""
    kind = cell.get("t", "n")
    if kind == "inlineStr":
        inline = cell.find(_IS)
        return None if inline is None else rich_text(inline)
    # The value is the last child unless there are extensions; asking for it by position is several times faster.
    value = cell[-1] if len(cell) else None
    if value is not None and value.tag != _V:
        value = cell.find(_V)
    return None if value is None else stored_constant(kind, value.text or "", shared_strings)


def read_text(cell: str, shared_strings: Any) -> Constant:
    """As `read_constant`, of a plain ``<c>`` element that is text; see `text_row` for what is plain."""
    found = _PLAIN.match(cell)
    if found is None:
        return None
    kind, value, inline = found.groups()
    text = inline if kind == "inlineStr" else value
    if text is None:
        return None
    text = unescaped(text)
    return unescape(text) if kind == "inlineStr" else stored_constant(kind, text, shared_strings)


def unescaped(text: str) -> str:
    """Text of a plain element."""
    if "&" not in text:
        return text
    text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&#13;", "\r")
    return text.replace("&amp;", "&")


def stored_constant(kind: str, text: str, shared_strings: Any) -> Constant:
    """The value that a cell of a type states as text; without a type it is a number."""
    if kind == "s":
        return shared_strings(text)  # type: ignore[no-any-return]
    if kind in ("str", "d"):
        return unescape(text)
    if kind == "b":
        return text.strip() in ("1", "true")
    if kind == "e":
        return ErrorValue(text) if text in ERROR_CODES else text
    return _as_number(text)


def _as_number(text: str) -> Constant:
    """Number of a cell; what is none, in damaged files, is given as text for whoever reads it to judge."""
    if not text.strip():
        return None
    try:
        number = float(text)
    except ValueError:
        return text
    # Python reads more than XML may hold: 1_000, digits of other scripts, NaN.
    return number if text.isascii() and "_" not in text and number == number else text


def rich_text(holder: Element) -> str:
    """Plain text of ``<is>`` or ``<si>``, phonetic runs left out."""
    return unescape("".join(t.text or "" for t in holder.iter(_T) if t.getparent().tag != _RPH))


def unescape(text: str) -> str:
    """Undo the ``_x000A_`` notation of the file format; what no text may hold becomes U+FFFD."""
    if "_x" not in text:
        return text
    plain = _ESCAPED.sub(lambda found: chr(int(found.group(1), 16)), text)
    return _ILLEGAL.sub(
        "\ufffd", plain.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")
    )
