"""How the shipped workbooks look: one palette, one table of cell formats, number formats by dimension.

Blue on light yellow is typed by the engineer, black on white is calculated, grey is words.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from addin.contract.palette import PALETTE
from addin.contract.sheet import Sheet

#: Metric-compatible fonts exist on every system, so that nothing is clipped on another computer.
FONT, NARROW_FONT = "Arial", "Arial Narrow"

#: Usual height of letters. [pt]
USUAL = 9.0
#: Pale ground of live formulas.
_LIVE = "#F1F8F7"


def _format(ink: str = "", paper: str = "", **more: Any) -> dict[str, Any]:
    """A format in the middle of the row's height; colours are words of the palette or ``#RRGGBB``."""
    colours = {"font_color": ink, "bg_color": paper}
    return {
        **{name: PALETTE.get(word, word) for name, word in colours.items() if word},
        "valign": "vcenter",
        **more,
    }


def _boxed(ink: str = "", paper: str = "", **more: Any) -> dict[str, Any]:
    """The same with a thin frame."""
    return _format(ink, paper, border=1, border_color=PALETTE["silver"], **more)


def _header(paper: str, **more: Any) -> dict[str, Any]:
    """Header of a column."""
    frame = {"border": 1, "border_color": PALETTE["white"]}
    return _format("white", paper, bold=True, text_wrap=True, align="center", **frame, **more)


def _verdict(word: str) -> dict[str, Any]:
    """Colours of a verdict, over those of its cell."""
    return {"bg_color": PALETTE[word], "font_color": PALETTE.get(f"{word}_ink", PALETTE["grey"])}


#: Frame of a cell that runs on into its neighbours.
_SIDELESS: Mapping[str, Any] = {
    "top": 1,
    "bottom": 1,
    "top_color": PALETTE["silver"],
    "bottom_color": PALETTE["silver"],
}
_LEFT: Mapping[str, Any] = {"align": "left", "indent": 1}
_UNIT: Mapping[str, Any] = {"align": "center", "font_size": 8}

#: Cell formats by name; each starts from Arial 9.
_FORMATS: Mapping[str, Mapping[str, Any]] = {
    "plain": {},
    "banner": _format("white", "navy", bold=True, font_size=16, indent=1),
    "banner_right": _format("white", "navy", align="right", indent=1),
    "strip": _format("navy", "mist", **_LEFT),
    "strip_verdict": _format("navy", "mist", bold=True, **_LEFT),
    "note": {"italic": True, "font_color": PALETTE["grey"]},
    "note_wrap": {"italic": True, "font_color": PALETTE["grey"], "text_wrap": True},
    "note_beside": {"italic": True, "font_color": PALETTE["grey"], "indent": 1},
    "fact": _format("navy", bold=True, align="left"),
    "sentence": _boxed("navy", "paper", bold=True, font_size=11, text_wrap=True, **_LEFT),
    "caption": {"bold": True, "font_size": 11, "font_color": PALETTE["navy"]},
    "drawn": _format("navy", bold=True, shrink=True, **_LEFT),
    "group": _format("white", "steel", bold=True, indent=1),
    "label": _boxed(paper="paper", indent=1),
    "hint": _boxed("grey", italic=True, font_size=8, indent=1),
    "input": _boxed("blue", "input"),
    "input_text": _boxed("blue", "input", num_format="@", **_LEFT),
    "input_wide": _format("blue", "input", num_format="@", **_LEFT, **_SIDELESS),
    "input_more": {"bg_color": PALETTE["input"], **_SIDELESS},
    "input_unit": _boxed("blue", "input", italic=True, **_UNIT),
    "no_unit": _boxed("grey", "paper", **_UNIT),
    "fixed_unit": _boxed("grey", "paper", italic=True, **_UNIT),
    "header_input": _header("navy"),
    "header_result": _header("grey"),
    "header_check": _header("teal"),
    # a word that is wider than its column
    "header_input_upright": _header("navy", rotation=90),
    "header_result_upright": _header("grey", rotation=90),
    "header_check_upright": _header("teal", rotation=90),
    "result": _boxed(align="right"),
    "result_text": _boxed(shrink=True, **_LEFT),
    "result_wrap": _boxed(text_wrap=True, **_LEFT),
    "result_mixed": _boxed(
        align="right", shrink=True, num_format="[<1000000000]#,##0.####;0.00E+00"
    ),
    "result_center": _boxed(align="center"),
    "verdict": _boxed(align="center", bold=True, font_size=8, shrink=True),
    "check": _boxed("teal", _LIVE),
    "check_value": _boxed("teal", _LIVE, align="right"),
    "title_label": _boxed("grey", "paper", font_size=8, indent=1),
    "title_value": _boxed("navy", bold=True, shrink=True, **_LEFT),
    "verdict_banner": _boxed("grey", "open", bold=True, font_size=12, align="center"),
    "key_label": _boxed(paper="paper", indent=1),
    "key_value": _boxed(bold=True, align="right"),
    "key_where": _format("grey", indent=1),
    "key_unit": _boxed("grey", indent=1),
    "prose": {"text_wrap": True, "valign": "top"},
    "prose_beside": _format(text_wrap=True, indent=1),
    "prose_bold": {"text_wrap": True, "valign": "top", "bold": True},
    "cf_pass": _verdict("pass"),
    "cf_accepted": _verdict("accepted"),
    "cf_fail": _verdict("fail"),
    "cf_open": _verdict("open"),
    "cf_whole": {},
}


class Styles:
    """The cell formats of one workbook, made when first asked for.

    Parameters
    ----------
    workbook : xlsxwriter.Workbook
        The workbook under construction.
    """

    def __init__(self, workbook: Any) -> None:
        self._workbook = workbook
        self._made: dict[tuple[str, str, float, bool], Any] = {}
        self.letters = USUAL  #: Height of the letters of what is made next. [pt]
        self.narrow = False  #: Whether they are narrow.

    def of(self, part: Sheet) -> None:
        """What is made next has the letters of a part of a sheet."""
        self.letters, self.narrow = part.letters, part.narrow

    def usual(self) -> None:
        """What is made next has the usual letters."""
        self.letters, self.narrow = USUAL, False

    def __call__(self, name: str, number: str = "") -> Any:
        """A format of the table above."""
        key = (name, number, self.letters, self.narrow)
        if key not in self._made:
            properties = dict(_FORMATS[name])
            if not name.startswith("cf_"):
                size = max(properties.get("font_size", USUAL), self.letters)
                properties |= {"font_name": NARROW_FONT if self.narrow else FONT, "font_size": size}
                if self.letters > USUAL and properties.pop("shrink", False):
                    properties["text_wrap"] = name in (
                        "verdict",
                        "result_text",
                    )  # letters stay as high as they are
            if number:
                properties["num_format"] = number
            self._made[key] = self._workbook.add_format(properties)
        return self._made[key]
