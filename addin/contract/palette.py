"""Colours of the workbook, the report and the page."""

from __future__ import annotations

from collections.abc import Mapping

PALETTE: Mapping[str, str] = {
    "navy": "#1F3A5F",
    "steel": "#44719B",
    "mist": "#DCE6F0",
    "rust": "#B5541C",
    "teal": "#2A7F77",
    "gold": "#C9971C",
    "plum": "#6B4C86",
    "grey": "#595959",
    "silver": "#BFBFBF",
    "paper": "#F5F6F8",
    "white": "#FFFFFF",
    "input": "#FFFFCC",
    "blue": "#0000FF",
    "pass": "#C6EFCE",
    "pass_ink": "#00612E",
    "accepted": "#FFEB9C",
    "accepted_ink": "#7F6000",
    "fail": "#FFC7CE",
    "fail_ink": "#9C0006",
    "open": "#E7E6E6",
}

#: Colour of the discs and of the shafts between them, by speed of the shaft line.
SPEED_GROUPS: tuple[tuple[str, str], ...] = (
    (PALETTE["navy"], "#A9BCD3"),
    (PALETTE["rust"], "#E9BFA5"),
    (PALETTE["teal"], "#A8D3CE"),
    (PALETTE["plum"], "#CDBBDC"),
)
