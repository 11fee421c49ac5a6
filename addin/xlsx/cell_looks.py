"""How cells look: number format, font and ground, with the conditional formats over them; nothing is changed.

Colours are ``RRGGBB``; what the file leaves open is black on white, as programs draw it.
"""

from __future__ import annotations

import colorsys
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from addin.xlsx.references import Rect, cell_name, parse_range
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.state import WorkbookState
from addin.xlsx.xml_part import Element, main

BLACK, WHITE = "000000", "FFFFFF"
#: Number formats that have a number of their own.
BUILT_IN = {
    1: "0", 2: "0.00", 3: "#,##0", 4: "#,##0.00", 9: "0%", 10: "0.00%", 11: "0.00E+00", 12: "# ?/?",
    13: "# ??/??", 14: "m/d/yyyy", 15: "d-mmm-yy", 16: "d-mmm", 17: "mmm-yy", 18: "h:mm AM/PM",
    19: "h:mm:ss AM/PM", 20: "h:mm", 21: "h:mm:ss", 22: "m/d/yyyy h:mm", 37: "#,##0;(#,##0)",
    38: "#,##0;(#,##0)", 39: "#,##0.00;(#,##0.00)", 40: "#,##0.00;(#,##0.00)", 45: "mm:ss",
    46: "[h]:mm:ss", 47: "mm:ss.0", 48: "##0.0E+0", 49: "@",
}  # fmt: skip
#: The first sixteen colours that have a number; from 8 on they are those of ``[Color 1]`` and so on.
_INDEXED = (
    "000000 FFFFFF FF0000 00FF00 0000FF FFFF00 FF00FF 00FFFF 000000 FFFFFF FF0000 00FF00 0000FF FFFF00 FF00FF 00FFFF "
    "800000 008000 000080 808000 800080 008080 C0C0C0 808080 9999FF 993366 FFFFCC CCFFFF 660066 FF8080 0066CC CCCCFF "
    "000080 FF00FF FFFF00 00FFFF 800080 800000 008080 0000FF 00CCFF CCFFFF CCFFCC FFFF99 99CCFF FF99CC CC99FF FFCC99 "
    "3366FF 33CCCC 99CC00 FFCC00 FF9900 FF6600 666699 969696 003366 339966 003300 333300 993300 993366 333399 333333"
).split()
_BEGINS = re.compile(
    r"""=?LEFT\((?P<cell>\$?[A-Z]+\$?\d+),(?:(?P<count>\d+)|LEN\("(?P<counted>[^"]*)"\))\)="(?P<word>[^"]*)\""""
)
_NAMED = {
    "black": BLACK, "blue": "0000FF", "cyan": "00FFFF", "green": "00FF00", "magenta": "FF00FF", "red": "FF0000",
    "white": WHITE, "yellow": "FFFF00",
}  # fmt: skip
#: In the order in which cells count them; the file has dark before light.
_THEME_ORDER = (1, 0, 3, 2, 4, 5, 6, 7, 8, 9, 10, 11)


@dataclass(frozen=True)
class Look:
    """How a cell or a conditional format looks; what a conditional format leaves alone is None."""

    number_format: str | None = None  #: Excel number format.
    ink: str | None = None  #: Colour of the font. [RRGGBB]
    grounds: tuple[str, ...] | None = (
        None  #: Colours behind it; several of a pattern or gradient. [RRGGBB]
    )
    size: float | None = None  #: Of the font. [point]
    font: str | None = None  #: Name of the font.
    repeated: bool = False  #: Whether the text is repeated to fill the cell.
    struck: bool | None = None  #: Whether the text is struck out.


@dataclass(frozen=True)
class Rule:
    """A conditional format."""

    ranges: tuple[Rect, ...]  #: Its cells.
    look: Look  #: What it makes of them.
    hides_value: bool = False  #: Whether bars or icons stand in place of the value.
    #: Comparison with a constant, or ``beginsWith`` it; empty for every other condition.
    test: str = ""
    bounds: tuple[float | str, ...] = ()  #: Its constants.
    priority: int = 0  #: Of rules that give the same property the first one is shown.

    def may_hold(self, value: object) -> bool:
        """Whether it may hold for a value; what is not a comparison with constants always may."""
        if not self.test or isinstance(value, bool) or not isinstance(value, int | float | str):
            return True
        kind = str if isinstance(value, str) else float
        if not all(isinstance(bound, kind) for bound in self.bounds):
            return self.test in ("notEqual", "notBetween") or kind is str
        held = value.casefold() if isinstance(value, str) else float(value)
        if self.test == "beginsWith":
            return isinstance(held, str) and held.startswith(str(self.bounds[0]))
        low, high = self.bounds[0], self.bounds[-1]
        return {
            "equal": held == low,
            "notEqual": held != low,
            "lessThan": held < low,  # type: ignore[operator]
            "lessThanOrEqual": held <= low,  # type: ignore[operator]
            "greaterThan": held > low,  # type: ignore[operator]
            "greaterThanOrEqual": held >= low,  # type: ignore[operator]
            "between": low <= held <= high,  # type: ignore[operator]
            "notBetween": not low <= held <= high,  # type: ignore[operator]
        }.get(self.test, True)


def contrast(one: str, other: str) -> float:
    """Contrast of two colours as the accessibility guidelines define it (WCAG 2.1), 1 to 21.

    Parameters
    ----------
    one, other : str
        Colours. [RRGGBB]

    Returns
    -------
    float
        1 for equal colours, 21 for black on white. [1]
    """
    dark, light = sorted(map(_luminance, (one, other)))
    return (light + 0.05) / (dark + 0.05)


def is_green(colour: str) -> bool:
    """Whether people would call a colour green, pale or dark.

    Parameters
    ----------
    colour : str
        It. [RRGGBB]
    """
    hue, light, saturation = colorsys.rgb_to_hls(
        *(int(colour[k : k + 2], 16) / 255 for k in (0, 2, 4))
    )
    return 0.2 <= hue <= 0.45 and saturation >= 0.15 and 0.1 <= light <= 0.95


def _luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def named_colour(name: str) -> str | None:
    """Colour that a number format names, such as ``white`` or ``color 2``. [RRGGBB]"""
    number = re.fullmatch(r"colou?r ?(\d+)", name)
    if number is None:
        return _NAMED.get(name)
    at = int(number[1]) + 7
    return _INDEXED[at] if at < len(_INDEXED) else None


class CellLooks:
    """The looks of the cells of a workbook.

    Parameters
    ----------
    workbook : WorkbookState
        The open workbook.
    """

    def __init__(self, workbook: WorkbookState) -> None:
        self._workbook = workbook
        part = workbook.structure.related("styles")
        self._root = None if part is None else workbook.container.tree(part)
        self._made: dict[str | None, Look] = {}
        self._rules: dict[str, tuple[Rule, ...]] = {}

    def look(self, part: SheetPart, row: int, column: int) -> Look:
        """How a cell looks without conditional formats."""
        style = part.style(row, column)
        if style not in self._made:
            self._made[style] = self._of_style(int(style or 0) if (style or "0").isdigit() else 0)
        return self._made[style]

    @cached_property
    def number_formats(self) -> list[str]:
        """Number format of each style."""
        return [self._code(entry.get("numFmtId", "0")) for entry in self._styles]

    def rules(self, sheet: str) -> tuple[Rule, ...]:
        """The conditional formats of a sheet, in the order in which they go before each other."""
        if sheet not in self._rules:
            around = self._workbook.sheet_part(sheet).around_cells()
            rules = (rule for entry in around for rule in self._of_sheet(entry))
            self._rules[sheet] = tuple(sorted(rules, key=lambda rule: rule.priority))
        return self._rules[sheet]

    def run_looks(self, cell: Element) -> Iterator[tuple[str, Look]]:
        """Texts with a font of their own inside a cell, and how they look; the rest of a look is None."""
        if cell.get("t") == "s":
            entry = self._workbook.shared_texts.runs(cell.findtext(main("v")) or "")
        else:
            entry = next(iter(_children(cell, "is")), None)
        for run in _children(entry, "r") if entry is not None else ():
            properties = next(iter(_children(run, "rPr")), None)
            text = "".join(one.text or "" for one in _children(run, "t"))
            if properties is not None and text.strip():
                yield text, self._font_look(properties)

    # ---- styles ------------------------------------------------------------------------------------------------

    @cached_property
    def _styles(self) -> list[Element]:
        return self._list("cellXfs")

    @cached_property
    def _fonts(self) -> list[Element]:
        return self._list("fonts")

    @cached_property
    def _fills(self) -> list[Element]:
        return self._list("fills")

    @cached_property
    def _differences(self) -> list[Element]:
        return self._list("dxfs")

    @cached_property
    def _indexed(self) -> list[str]:
        """The colours that have a number: those of the file where it has its own."""
        held = next((one for one in self._list("colors") if _name(one) == "indexedColors"), None)
        own = [] if held is None else [one.get("rgb", "")[-6:].upper() for one in held]
        return [*own, *_INDEXED[len(own) :]]

    @cached_property
    def _codes(self) -> dict[str, str]:
        return {
            entry.get("numFmtId", ""): entry.get("formatCode", "")
            for entry in self._list("numFmts")
        }

    def _list(self, tag: str) -> list[Element]:
        held = next(iter(_children(self._root, tag)), None) if self._root is not None else None
        return [] if held is None else [one for one in held if isinstance(one.tag, str)]

    @cached_property
    def _theme(self) -> list[str]:
        """Colours of the theme, as cells count them."""
        part = self._workbook.structure.related("theme")
        if part is None or self._workbook.container.find(part) is None:
            return []
        root = self._workbook.container.tree(part)
        scheme = next((one for one in root.iter() if _name(one) == "clrScheme"), None)
        colours = []
        for entry in scheme if scheme is not None else ():
            for colour in entry:
                colours.append(colour.get("lastClr") or colour.get("val", ""))
        return [colours[at] for at in _THEME_ORDER if at < len(colours)]

    def _code(self, number: str) -> str:
        known = self._codes.get(number)
        if known is not None:
            return known
        return BUILT_IN.get(int(number), "General") if number.isdigit() else "General"

    def _of_style(self, at: int) -> Look:
        if at >= len(self._styles):
            return Look("General", BLACK, (WHITE,), None, "")
        style = self._styles[at]
        font = _at(self._fonts, style.get("fontId"))
        fill = _at(self._fills, style.get("fillId"))
        of_font = Look() if font is None else self._font_look(font)
        aligned = next(iter(_children(style, "alignment")), None)
        return Look(
            self._code(style.get("numFmtId", "0")),
            of_font.ink or BLACK,
            (None if fill is None else self._grounds(fill)) or (WHITE,),
            of_font.size,
            of_font.font or "",
            aligned is not None and aligned.get("horizontal") == "fill",
            of_font.struck,
        )

    def _font_look(self, font: Element) -> Look:
        held = {_name(one): one for one in font}
        size = held["sz"].get("val", "") if "sz" in held else ""
        name = next((held[tag].get("val", "") for tag in ("name", "rFont") if tag in held), None)
        ink = self._colour(held["color"]) if "color" in held else None
        struck = held["strike"].get("val", "1") in ("1", "true") if "strike" in held else None
        return Look(
            ink=ink, size=float(size) if _is_number(size) else None, font=name, struck=struck
        )

    def _grounds(self, fill: Element, *, of_rule: bool = False) -> tuple[str, ...] | None:
        """Colours of a fill; a rule keeps that of a solid one where cells keep that of the pattern behind."""
        pattern = next(iter(_children(fill, "patternFill")), None)
        if pattern is None:
            stops = [one for one in fill.iter() if _name(one) == "color"]
            return tuple(filter(None, map(self._colour, stops))) or None
        kind = pattern.get("patternType", "solid" if of_rule else "none")
        colours = {_name(one): self._colour(one) for one in pattern}
        front, back = colours.get("fgColor"), colours.get("bgColor")
        if kind == "none":
            return None
        if kind == "solid":
            shown = (back or front) if of_rule else (front or WHITE)
            return (shown,) if shown else None
        return (front or BLACK, back or WHITE)

    def _colour(self, entry: Element) -> str | None:
        """A colour; None where the program chooses it."""
        rgb, theme, indexed = entry.get("rgb"), entry.get("theme"), entry.get("indexed")
        if rgb and re.fullmatch(r"(?:[0-9A-Fa-f]{2})?[0-9A-Fa-f]{6}", rgb):
            colour: str | None = rgb[-6:].upper()
        elif theme is not None and theme.isdigit() and int(theme) < len(self._theme):
            colour = self._theme[int(theme)].upper()
        elif indexed is not None and indexed.isdigit():
            at = int(indexed)
            colour = {64: BLACK, 65: WHITE}.get(at)
            if colour is None and at < len(self._indexed):
                colour = self._indexed[at]
        else:
            return None
        tint = entry.get("tint", "")
        if colour is None or not re.fullmatch("[0-9A-F]{6}", colour):
            return None
        return _tinted(colour, float(tint)) if _is_number(tint) else colour

    # ---- conditional formats -----------------------------------------------------------------------------------

    def _of_sheet(self, entry: Element) -> Iterator[Rule]:
        if _name(entry) == "conditionalFormatting":
            yield from self._of_block(entry, entry.get("sqref", ""))
        elif _name(entry) == "extLst":
            for block in entry.iter():
                if _name(block) == "conditionalFormatting":
                    sqref = next(iter(_children(block, "sqref")), None)
                    yield from self._of_block(block, "" if sqref is None else sqref.text or "")

    def _of_block(self, block: Element, sqref: str) -> Iterator[Rule]:
        ranges = tuple(filter(None, map(_range, sqref.split())))
        for entry in _children(block, "cfRule") if ranges else ():
            own = next(iter(_children(entry, "dxf")), None)
            if own is None:
                own = _at(self._differences, entry.get("dxfId"))
            look = Look() if own is None else self._of_difference(own)
            shown = [
                one for one in entry.iter() if _name(one) in ("dataBar", "iconSet", "colorScale")
            ]
            hides = any(one.get("showValue") in ("0", "false") for one in shown)
            colours = [
                colour
                for one in shown
                for part in one.iter()
                if _name(part) in ("color", "fillColor") and (colour := self._colour(part))
            ]
            formulas = [one.text or "" for one in entry if _name(one) in ("formula", "f")]
            bounds = tuple(filter(lambda bound: bound is not None, map(_constant, formulas)))
            is_test = entry.get("type") == "cellIs" and bounds and len(bounds) == len(formulas)
            test = entry.get("operator", "") if is_test else ""
            begin = _beginning(entry, formulas, ranges[0])
            if begin is not None:
                test, bounds = "beginsWith", (begin,)
            number = entry.get("priority", "")
            priority = int(number) if number.isdigit() and len(number) < 10 else 0
            if not colours:
                yield Rule(ranges, look, hides, test, bounds, priority)  # type: ignore[arg-type]
            for colour in dict.fromkeys(colours):
                yield Rule(ranges, Look(grounds=(colour,)), hides, priority=priority)

    def _of_difference(self, entry: Element) -> Look:
        held = {_name(one): one for one in entry}
        of_font = self._font_look(held["font"]) if "font" in held else Look()
        grounds = self._grounds(held["fill"], of_rule=True) if "fill" in held else None
        code = held["numFmt"].get("formatCode", "") if "numFmt" in held else None
        return Look(code, of_font.ink, grounds, of_font.size, of_font.font, struck=of_font.struck)


def _name(element: Element) -> str:
    """Tag of an element without its namespace."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _children(element: Element, name: str) -> list[Element]:
    return [] if element is None else [one for one in element if _name(one) == name]


def _at(entries: list[Element], text: str | None) -> Element | None:
    return entries[int(text)] if text and text.isdigit() and int(text) < len(entries) else None


def _is_number(text: str) -> bool:
    return re.fullmatch(r"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?", text) is not None


def _constant(formula: str) -> float | str | None:
    """The constant that a condition compares with; None for anything that is calculated."""
    text = formula.strip()
    if _is_number(text):
        return float(text)
    quoted = re.fullmatch(r'"((?:[^"]|"")*)"', text)
    return None if quoted is None else quoted[1].replace('""', '"').casefold()


def _beginning(entry: Element, formulas: list[str], corner: Rect) -> str | None:
    """The word with which a text must begin for a rule to hold, as programs write such rules; None for others."""
    found = _BEGINS.fullmatch(formulas[0].strip()) if len(formulas) == 1 else None
    if found is None or found["cell"].replace("$", "") != cell_name(corner.top, corner.left):
        return None
    word = found["word"].casefold()
    text = entry.get("text") if entry.get("type") == "beginsWith" else None
    counted = int(found["count"]) if found["count"] else len(found["counted"])
    if counted != len(word) or (text is not None and text.casefold() != word):
        return None
    return word


def _range(text: str) -> Rect | None:
    try:
        return parse_range(text)
    except ValueError:
        return None


def _tinted(colour: str, tint: float) -> str:
    """A colour made darker (below 0) or lighter."""
    hue, light, saturation = colorsys.rgb_to_hls(
        *(int(colour[k : k + 2], 16) / 255 for k in (0, 2, 4))
    )
    tint = min(max(tint, -1.0), 1.0)
    light = light * (1 + tint) if tint < 0 else light * (1 - tint) + tint
    parts = colorsys.hls_to_rgb(hue, light, saturation)
    return "".join(f"{round(255 * part):02X}" for part in parts)
