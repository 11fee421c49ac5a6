"""Ranges of a shipped workbook as a spreadsheet program hands them to a function."""

from functools import cache
from pathlib import Path
from typing import Any

import openpyxl
from openpyxl.utils import range_boundaries

from addin.worksheet import answers
from addin.worksheet.functions import model
from addin.worksheet.functions.model import TABLES

TEMPLATES = Path(__file__).resolve().parents[2] / "templates"
#: Function → result table of the workbook with the same cells.
SAME_CELLS = {
    "TV_FREQUENCIES": "NaturalFrequencies",
    "TV_MARGINS": "SeparationMargins",
    "TV_STEADY": "SteadyState",
    "TV_PEAKS": "StartupPeaks",
    "TV_REVERSALS": "TorqueReversals",
    "TV_STARTS": "AllowableStarts",
    "TV_CYCLES": "StartCycles",
}


#: Small studies, as ranges: stiffnesses to try, couplings on offer, what scatters.
TUNING = [["Element", "Quantity", "Unit", "Values"], ["HS coupling", "stiffness", "%", "33; 50"]]
CATALOGUE = [
    [None, None, None, "lbf*in/rad", "lb*ft^2"],
    ["Element", "Name", "Fitted", "Stiffness", "Inertia"],
    ["LS coupling", "as proposed", "yes", 309000000.0, 85.0],
    ["LS coupling", "softer", None, 150000000.0, 130.0],
]
SCATTER = [[None, None, "%"], ["Quantity", "Distribution", "Spread"], ["stiffness", "normal", 5.0]]
#: Data sheet of a motor.
#: Rows of table Sections, as a range: a hub, a step with a fillet, a taper.
SECTIONS = [
    [None, "mm", "mm", "mm", "mm", "%"],
    ["Element", "Length", "OD", "End OD", "Fillet", "Penetration"],
    ["Rotor", 80.0, 100.0, None, None, 100.0 / 3.0],
    ["Rotor", 250.0, 100.0, None, 4.0, None],
    ["Rotor", 400.0, 150.0, 130.0, None, None],
]
MOTOR = [
    [None, "kVA", *["pu"] * 6, *["s"] * 4],
    [
        "Station", "Apparent power", "Xd", "Xq", "Xd transient", "Xd subtransient", "Xq subtransient", "Xl",
        "Td0 transient", "Td0 subtransient", "Tq0 subtransient", "Ta",
    ],
    ["Motor", 1000.0, 1.3, 0.9, 0.35, 0.22, 0.26, 0.12, 3.0, 0.035, 0.12, 0.05],
]  # fmt: skip


@cache
def workbook(name):
    return openpyxl.load_workbook(TEMPLATES / f"{name}.xlsx", data_only=True)


def table(book, name):
    """Units, headers and rows of an Excel table."""
    for sheet in book:
        if name in sheet.tables:
            left, top, right, bottom = range_boundaries(sheet.tables[name].ref)
            return [
                [sheet.cell(row, column).value for column in range(left, right + 1)]
                for row in range(top - 1, bottom + 1)
            ]
    raise KeyError(name)


def model_arguments(name="example_proposed"):
    """What `TV_MODEL` is given: every input table, and sheet Case as one range."""
    book = workbook(name)
    case = [
        [cell.value for cell in row]
        for row in book["Case"].iter_rows(min_row=5, max_row=70, min_col=2, max_col=12)
    ]
    rest = [table(book, one) for one in TABLES[2:]]
    return [table(book, "Stations"), table(book, "Elements"), case, *rest]


def with_event(arguments):
    """The same with a fault of the motor in table EventTorque."""
    at = 1 + TABLES.index("EventTorque")  # sheet Case stands among them
    block = arguments[at]
    filled = [*block[:2], ["Fault", "Motor", None, -0.2, 1.0, 90.0, 0.1], *block[3:]]
    return [*arguments[:at], filled, *arguments[at + 1 :]]


def with_conditions(arguments):
    """The same with two rows in table StartConditions: a start at 80 % voltage, and hot couplings in operation."""
    at = 1 + TABLES.index("StartConditions")
    block = arguments[at]
    rows = (
        {"Condition": "weak supply", "Voltage": 80},
        {"Condition": "hot", "Kind": "steady", "Stiffness factor": 0.8},
    )
    typed = [[row.get(header) for header in block[1]] for row in rows]
    return [*arguments[:at], [*block[:2], *typed], *arguments[at + 1 :]]


def replace_models(monkeypatch: Any, models: Any) -> None:
    """Let the functions keep their cases in another store."""
    for module in (answers, model):
        monkeypatch.setattr(module, "MODELS", models)


def in_order(name, head, rows, headers, written):
    """Rows of the workbook in the order of a function; of steady state the workbook begins with those that it prints."""
    if name != "TV_STEADY":
        return written
    words = ("Element", "Excitation", "Mode", "Applied at")
    titles = [title.split(" [")[0] for title in head]
    here, there = [titles.index(w) for w in words], [headers.index(w) for w in words]
    place = {tuple(row[k] for k in there): row for row in written}
    return [place.pop(tuple(row[k] for k in here)) for row in rows]
