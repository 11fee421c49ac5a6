"""How the shipped workbooks look: one palette, one table of cell formats, number formats by dimension.

Blue on light yellow is typed by the engineer, black on white is calculated, grey is words.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from addin.contract.palette import PALETTE

#: Metric-compatible fonts exist on every system, so that nothing is clipped on another computer.
FONT = "Arial"

_THIN = {"border": 1, "border_color": PALETTE["silver"]}
_SIDELESS = {
    "top": 1,
    "bottom": 1,
    "top_color": PALETTE["silver"],
    "bottom_color": PALETTE["silver"],
}
_INPUT = {"bg_color": PALETTE["input"], "font_color": PALETTE["blue"], **_THIN}
_HEADER = {
    "bold": True,
    "font_color": PALETTE["white"],
    "text_wrap": True,
    "align": "center",
    "valign": "vcenter",
    "border": 1,
    "border_color": PALETTE["white"],
}

#: Cell formats by name; each starts from Arial 9.
_FORMATS: Mapping[str, Mapping[str, Any]] = {
    "plain": {},
    "banner": {
        "bold": True,
        "font_size": 16,
        "font_color": PALETTE["white"],
        "valign": "vcenter",
        "bg_color": PALETTE["navy"],
        "indent": 1,
    },
    "banner_right": {
        "font_size": 9,
        "font_color": PALETTE["white"],
        "valign": "vcenter",
        "align": "right",
        "bg_color": PALETTE["navy"],
        "indent": 1,
    },
    "strip": {
        "font_color": PALETTE["navy"],
        "bg_color": PALETTE["mist"],
        "valign": "vcenter",
        "indent": 1,
    },
    "strip_right": {
        "font_color": PALETTE["navy"],
        "bg_color": PALETTE["mist"],
        "valign": "vcenter",
        "align": "center",
        "bold": True,
        "shrink": True,
    },
    "note": {"italic": True, "font_color": PALETTE["grey"]},
    "note_beside": {"italic": True, "font_color": PALETTE["grey"], "indent": 1},
    "fact": {"bold": True, "font_color": PALETTE["navy"], "valign": "vcenter", "align": "left"},
    "sentence": {
        "bold": True,
        "font_size": 11,
        "font_color": PALETTE["navy"],
        "bg_color": PALETTE["paper"],
        "text_wrap": True,
        "align": "left",
        "valign": "vcenter",
        "indent": 1,
        **_THIN,
    },
    "caption": {"bold": True, "font_size": 11, "font_color": PALETTE["navy"]},
    "drawn": {
        "bold": True,
        "font_color": PALETTE["navy"],
        "valign": "vcenter",
        "align": "left",
        "indent": 1,
        "shrink": True,
    },
    "group": {
        "bold": True,
        "font_color": PALETTE["white"],
        "bg_color": PALETTE["steel"],
        "valign": "vcenter",
        "indent": 1,
    },
    "label": {"bg_color": PALETTE["paper"], "valign": "vcenter", "indent": 1, **_THIN},
    "hint": {
        "italic": True,
        "font_size": 8,
        "font_color": PALETTE["grey"],
        "valign": "vcenter",
        "indent": 1,
        **_THIN,
    },
    "input": {**_INPUT, "valign": "vcenter"},
    "input_text": {
        **_INPUT,
        "valign": "vcenter",
        "align": "left",
        "indent": 1,
        "num_format": "@",
    },
    "input_wide": {
        "bg_color": PALETTE["input"],
        "font_color": PALETTE["blue"],
        "valign": "vcenter",
        "align": "left",
        "indent": 1,
        "num_format": "@",
        **_SIDELESS,
    },
    "input_more": {"bg_color": PALETTE["input"], **_SIDELESS},
    "input_unit": {
        **_INPUT,
        "italic": True,
        "align": "center",
        "valign": "vcenter",
        "font_size": 8,
    },
    "no_unit": {
        "align": "center",
        "valign": "vcenter",
        "font_size": 8,
        "bg_color": PALETTE["paper"],
        "font_color": PALETTE["grey"],
        **_THIN,
    },
    "fixed_unit": {
        "align": "center",
        "valign": "vcenter",
        "font_size": 8,
        "italic": True,
        "bg_color": PALETTE["paper"],
        "font_color": PALETTE["grey"],
        **_THIN,
    },
    "header_input": {**_HEADER, "bg_color": PALETTE["navy"]},
    "header_result": {**_HEADER, "bg_color": PALETTE["grey"]},
    "header_check": {**_HEADER, "bg_color": PALETTE["teal"]},
    "result": {**_THIN, "valign": "vcenter", "align": "right"},
    "result_text": {**_THIN, "valign": "vcenter", "align": "left", "indent": 1, "shrink": True},
    "result_wrap": {
        **_THIN,
        "valign": "vcenter",
        "align": "left",
        "indent": 1,
        "text_wrap": True,
    },
    "result_mixed": {
        **_THIN,
        "valign": "vcenter",
        "align": "right",
        "shrink": True,
        "num_format": "#,##0.####",
    },
    "result_center": {**_THIN, "valign": "vcenter", "align": "center"},
    "verdict": {
        **_THIN,
        "valign": "vcenter",
        "align": "center",
        "bold": True,
        "font_size": 8,
        "shrink": True,
    },
    "check": {**_THIN, "valign": "vcenter", "font_color": PALETTE["teal"], "bg_color": "#F1F8F7"},
    "check_value": {
        **_THIN,
        "valign": "vcenter",
        "align": "right",
        "font_color": PALETTE["teal"],
        "bg_color": "#F1F8F7",
    },
    "title_label": {
        "font_size": 8,
        "font_color": PALETTE["grey"],
        "bg_color": PALETTE["paper"],
        "indent": 1,
        "valign": "vcenter",
        **_THIN,
    },
    "title_value": {
        "bold": True,
        "font_color": PALETTE["navy"],
        "indent": 1,
        "valign": "vcenter",
        "align": "left",
        **_THIN,
    },
    "verdict_banner": {
        "bold": True,
        "font_size": 12,
        "align": "center",
        "valign": "vcenter",
        "bg_color": PALETTE["open"],
        "font_color": PALETTE["grey"],
        **_THIN,
    },
    "key_label": {"bg_color": PALETTE["paper"], "indent": 1, "valign": "vcenter", **_THIN},
    "key_value": {"bold": True, "align": "right", "valign": "vcenter", **_THIN},
    "key_unit": {"font_color": PALETTE["grey"], "indent": 1, "valign": "vcenter", **_THIN},
    "prose": {"text_wrap": True, "valign": "top"},
    "prose_beside": {"text_wrap": True, "valign": "vcenter", "indent": 1},
    "prose_bold": {"text_wrap": True, "valign": "top", "bold": True},
    "cf_pass": {"bg_color": PALETTE["pass"], "font_color": PALETTE["pass_ink"]},
    "cf_accepted": {"bg_color": PALETTE["accepted"], "font_color": PALETTE["accepted_ink"]},
    "cf_fail": {"bg_color": PALETTE["fail"], "font_color": PALETTE["fail_ink"]},
    "cf_open": {"bg_color": PALETTE["open"], "font_color": PALETTE["grey"]},
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
        self._made: dict[tuple[str, str], Any] = {}

    def __call__(self, name: str, number: str = "") -> Any:
        """A format of the table above."""
        key = (name, number)
        if key not in self._made:
            properties = dict(_FORMATS[name])
            if not name.startswith("cf_"):
                properties = {"font_name": FONT, "font_size": 9, **properties}
            if number:
                properties["num_format"] = number
            self._made[key] = self._workbook.add_format(properties)
        return self._made[key]
