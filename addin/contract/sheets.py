"""What stands where on the shipped workbooks, as data: sheets, title block, key numbers."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.banner import NOTES
from addin.contract.chart_tables import HISTORIES
from addin.contract.result_tables import CROSSING_ROWS
from addin.contract.sheet import (
    ALWAYS,
    NEVER,
    ChartAt,
    KeyNumber,
    Sheet,
    column_letters,
    column_number,
    readable,
    side_by_side,
)
from addin.contract.tables import table
from addin.contract.texts import EFFECT_NOTES

BLANK_TEXT = '=IF({0}="","",{0})'


STRIP = (
    '="Document "&IF(Document="","-",Document)&"   Rev. "&IF(Revision="","-",Revision)'
    '&"   "&Tag&IF(AND(Tag<>"",Title<>""),"   ","")&Title'
)


# --- where everything stands ----------------------------------------------------------------------

#: First row of the cells in which the engineer may name the element of each history chart.
CHOICES_BEGIN = 7
#: First row of the charts of sheet Start, below the rows that are as high as the texts of crossings and reversals need.
_CHARTS = 10 + CROSSING_ROWS
#: Rows between the crossings and reversals and the charts, which close where no table needs them.
SPARE_ROWS = range(CHOICES_BEGIN + HISTORIES, _CHARTS - 1)
#: Height of the charts of the start and of reversals, and the rows that they take. [pixel]
_START_CHART, _START_CHART_ROWS = 236, 14
#: Row of the captions of the tables with a row an element, whose rows are thus the same; nothing stands below them.
OF_ELEMENTS = _CHARTS + _START_CHART_ROWS

#: Rows of the history charts.
_HISTORY_ROWS = (_CHARTS, _CHARTS + 11, _CHARTS + 21)
HISTORY_CHARTS = tuple(
    ChartAt(f"history {k + 1}", f"{'BI'[k % 2]}{_HISTORY_ROWS[k // 2]}", 600, 186)
    for k in range(HISTORIES)
)
_BEARINGS = _HISTORY_ROWS[-1] + 11
#: Rows of the captions below `EventTorque` and below `MotorEvents`.
_MOTOR_EVENTS = 10 + table("EventTorque").rows
_AIR_GAP = _MOTOR_EVENTS + 5 + table("MotorEvents").rows
#: First row below the room of `Effects`.
_BELOW_EFFECTS = 8 + table("Effects").room + 1
EFFECT_NOTES_AT = f"B{_BELOW_EFFECTS}"


def _said(formula: str) -> str:
    """Words that stand only in a calculated workbook."""
    return f'=IF(run_SHA256="","",{formula})'


#: Rows of sheet Summary: the schematic, the captions of key numbers and of verdicts, the foot.
SCHEMATIC_ROW = 11
KEY_NUMBERS_ROW = 13
VERDICTS_ROW = KEY_NUMBERS_ROW + 13
FOOT_ROW = VERDICTS_ROW + 2 + table("Verdicts").room
#: Notes that sheet Summary has room for, beside its key numbers; the rest is on sheet Audit.
SUMMARY_NOTES = 6
#: Each on two rows.
NOTES_BEGIN = KEY_NUMBERS_ROW + 1
NOTES_END = NOTES_BEGIN + 2 * SUMMARY_NOTES
#: The second page: its first row, the two charts, the table of the conditions.
_HISTORY_ROW = FOOT_ROW + 1
_PEAKS_ROW = _HISTORY_ROW + 21
_MATRIX_ROW = _PEAKS_ROW + 17
#: Description of the shapes of the schematic.
SCHEMATIC = "schematic"


#: Height of a row of the key numbers. [pt]
KEY_ROW = 13.9


def _note_line(number: int) -> str:
    """A note of the calculation; the last line says how many more there are."""
    note = f'IFERROR(INDEX(Audit[Value],MATCH("Warning {number}",Audit[Item],0)),"")'
    if number == 1:
        return f'=IF(AND({NOTES}=0,run_SHA256<>""),"None.",{note})'
    if number < SUMMARY_NOTES:
        return f"={note}"
    more = f'"And "&({NOTES}-{SUMMARY_NOTES - 1})&" more notes: see sheet Audit."'
    return f"=IF({NOTES}>{SUMMARY_NOTES},{more},{note})"


#: Lines that show facts of the run: sheet or part, first and last cell, formula, style, height in points.
FACT_LINES: tuple[tuple[str, str, str, str, str, float], ...] = (
    (
        "Start-up",
        "B4",
        "Q4",
        _said(
            'IF(run_Outcome="","No start was calculated: neither motor torque nor torque against '
            'time is given on sheet Torque and motor.",run_Outcome&IF(COUNT(StartupCrossings[Mode])=0,'
            '"   No crossings: no pulsating torque of the motor crosses a mode.",""))'
        ),
        "fact",
        13.5,
    ),
    (
        "Start-up",
        f"B{_CHARTS - 1}",
        f"K{_CHARTS - 1}",
        _said('"Speed against time, and pull-in where a field is applied:"'),
        "note",
        13.5,
    ),
    (
        "Reversals",
        f"B{_CHARTS - 1}",
        f"K{_CHARTS - 1}",
        _said('"Torque around its least value, and the same moment enlarged:"'),
        "note",
        13.5,
    ),
    (
        "Reversals",
        "B4",
        "S4",
        _said(
            'IF(run_Outcome="","No start: no motor torque is given.",'
            'IF(COUNTIF(TorqueReversals[Element],"?*")=0,"The train has no gear mesh and no geared coupling '
            'with backlash, so no torque reversal is judged.",'
            'IF(COUNT(BearingForces[Force])=0,"No bearing forces: no gear moves on its bearings in this '
            'start. Type bearing data on sheet Train; see the plan on sheet Effects and accuracy.","")))'
        ),
        "note",
        13.5,
    ),
    (
        "Events",
        "B4",
        "N4",
        _said(
            'IF(AND(COUNTIF(EventTorque[Event],"?*")=0,COUNTIF(MotorEvents[Event],"?*")=0,'
            'InitialState<>"running"),"No event in operation: tables EventTorque and MotorEvents are blank.","")'
        ),
        "note",
        15.0,
    ),
    (
        "Fatigue",
        "B4",
        "M4",
        _said(
            'IF(run_Outcome="","No start: no motor torque is given.",'
            'IF(COUNTIF(AllowableStarts[Element],"?*")=0,"No shaft is judged: type Stress diameter and '
            'Material on sheet Train, Endurance and S-N points on sheet Fatigue.",""))'
        ),
        "note",
        15.0,
    ),
    *(
        ("Summary", f"F{row}", f"I{row + 1}", _note_line(number), "prose", KEY_ROW)
        for number, row in enumerate(range(NOTES_BEGIN, NOTES_END, 2), 1)
    ),
    ("Margins", "B4", "J4", BLANK_TEXT.format("run_PrintedModes"), "note", 15.0),
    ("Steady state", "B4", "N4", BLANK_TEXT.format("run_PrintedResponse"), "note", 15.0),
    ("Accuracy", "B4", "P4", BLANK_TEXT.format("run_AccuracySentence"), "sentence", 30.0),
    ("Accuracy", "B5", "P5", BLANK_TEXT.format("run_AccuracyReference"), "prose", 26.0),
    ("Accuracy", "B6", "P6", BLANK_TEXT.format("run_AccuracyInputs"), "note", 15.0),
)

#: Sheets, and the parts of those that have several, from left to right.
_SHEETS = (
    Sheet(
        "Summary",
        "summary",
        {"A": 1.5, "B": 33, "C:D": 14, "E": 24, "F": 49, "G": 21.5, "H": 20, "I": 8},
        {"Verdicts": f"B{VERDICTS_ROW}", "CaseMatrix": f"B{_MATRIX_ROW}"},
        (
            ChartAt("governing", f"B{_HISTORY_ROW}", 1322, 344),
            ChartAt("peaks", f"B{_PEAKS_ROW}", 1322, 270),
        ),
        row_breaks=(_HISTORY_ROW,),
        freeze="",
        header_rows=2,
        printed_for=ALWAYS,
        print_to=FOOT_ROW,
        largest=70,
        letters=11.5,
    ),
    Sheet(
        "Case",
        "input",
        {"A": 1.5, "B": 22, "C": 26, "D": 9, "E": 32, "F": 2, "G": 22, "H": 18, "I": 9, "J": 34},
        {"EffectChoices": "B32"},
        intro="Inputs of the case and how it is calculated. Type into the yellow cells (blue "
              "text); the unit is in the cell to the right of the number.",
        printed_for=ALWAYS,
        print_to=45,
    ),
    Sheet(
        "Conditions",
        "input",
        {"A": 1.5, "B": 26, "C": 10, "D:H": 11, "I": 24, "J:K": 10},
        {"StartConditions": "B5"},
        on="Case",
        intro="Optional: the case under other conditions, such as 80 % voltage, hot, unloaded, aborted, a short "
        "circuit, continuous operation. Each is calculated; the worst governs on sheet Summary.",
        printed_for=NEVER,  # sheet Summary prints what each changes
    ),
    Sheet(
        "Case verdicts",
        "result",
        {"A": 1.5, "B": 26, "C": 32, "D:E": 14, "F": 22, "G": 70, "H": 30, "I": 70},
        {"CaseVerdicts": "B5"},
        on="Case",
        intro="The checks under every condition, each judged as if the whole case were typed so; for work at the "
        "screen, sheet Summary prints the worst of them.",
        printed_for=NEVER,
    ),
    Sheet(
        "Train",
        "input",
        {"A": 1.5, "B": 17, "C": 18.2, "D:E": 9.5, "F": 11.5, "G:K": 6.5, "L": 8.2, "M:P": 6.5, "Q": 8.4, "R:V": 6.9},
        {"Stations": "B5", "ModeDamping": "I5", "Elements": "B24", "Meshes": "B43"},
        (ChartAt("train", "L5", 520, 300),),
        intro="The mass-elastic table. Units are above the headers; the prompt of a cell says what "
              "blank means. Insert table rows where a table is full.",
        printed_for=ALWAYS,
        largest=70,
    ),
    Sheet(
        "Excitation",
        "input",
        {"A": 1.5, "B": 30, "C": 14, "D": 22, "E": 13, "F": 22, "G": 14},
        {"Excitations": "B5"},
        on="Train",
        intro="Excitations in continuous operation. Leave the table blank for the defaults: 1× and "
              "2× of every shaft speed, 1× and 2× line frequency.",
    ),
    Sheet(
        "Sections",
        "input",
        {"A": 1.5, "B": 18, "C": 12, "D:G": 8.5, "H": 14, "I": 9, "J": 10.4, "K:L": 9, "M": 1.5, "N": 18, "O": 12, "P:R": 10},
        {"Sections": "B24", "SectionMaterials": "N5", "SectionResults": "N24"},
        (ChartAt("profile", "B5", 860, 280),),
        on="Train",
        intro="Optional: stepped shafts and rotors from their sections, which give Stiffness and inertia of their "
        "element in table Elements.",
    ),
    Sheet(
        "Torque",
        "input",
        {"A": 1.5, "B": 13, "C:D": 8, "E": 8.2, "F": 8, "G": 9.3, "H": 1, "I": 13, "J": 8, "K": 10, "L": 1, "M": 13,
         "N:O": 8, "P": 1, "Q:X": 7},
        {"MotorTorque": "B5", "LoadTorque": "I5", "TorqueTime": "M5"},
        (
            ChartAt("torque", "Q5", 432, 300),
            ChartAt("load-typed", "Q20", 432, 200),
            ChartAt("motor-typed", "Q32", 432, 190),
        ),
        on="Torque and motor",
        intro="Torque against speed of the motor and of each driven machine; every curve begins "
        "with the row of its lowest speed.",
        printed_for=ALWAYS,
    ),
    Sheet(
        "Faults in operation",
        "input",
        {"A": 1.5, "B": 20, "C": 10, "D": 16, "E": 8.9, "F:J": 7.8, "K": 8, "L": 7.8, "M": 8.4, "N": 1, "O:U": 8.2},
        {"EventTorque": "B5", "MotorEvents": f"B{_MOTOR_EVENTS}", "AirGapTorque": f"B{_AIR_GAP}"},
        (ChartAt("air-gap", "O5", 432, 300), ChartAt("clearing", "O26", 432, 300)),
        on="Torque and motor",
        intro="Optional: torques of faults in operation, faults of a motor that has a data sheet, and the largest air-gap "
        "torque of each.",
    ),
    Sheet(
        "Motor",
        "input",
        {"A": 1.5, "B": 14, "C": 11.4, "D:Q": 10.9, "R": 10.9, "S": 15, "T:AH": 9.7, "AI": 1.5, "AJ": 14, "AK:AT": 9.4},
        {"MotorData": "B5", "MotorCircuit": "B15", "Supply": "R15", "SupplyVoltage": "AB15", "MotorTimeConstants": "R31",
         "ElectricalDamping": "X31", "MotorCurves": "AJ5"},
        (ChartAt("motor-curves", "B25", 760, 430),),
        on="Torque and motor",
        printed="AH",
        breaks=("R",),
        printed_for=("MotorData", "MotorCircuit", "Supply", "SupplyVoltage"),
        intro="Optional: the data sheet of a motor, from which its torque curves are calculated. Where part "
        "Torque has no curve of its station, the start uses them. Their numbers, right of it, are drawn and not printed.",
    ),
    Sheet(
        "Events",
        "result",
        {"A": 1.5, "B": 16.2, "C": 19.8, "D:E": 8.5, "F:G": 5.4, "H": 6.5, "I:J": 8.2, "K:L": 7.1, "M": 7.2, "N": 6.2, "O": 4.8,
         "P:Q": 5.1, "R": 7.3, "S": 7.9, "T:U": 5.2, "V": 7.3, "W": 7.9, "X": 5.6},
        {"EventPeaks": "B5"},
        on="Torque and motor",
        intro="Faults in operation: events of tables EventTorque and MotorEvents upon the train that "
        "runs under its running loads, or starts. They count as no starts.",
    ),
    Sheet(
        "Fatigue",
        "input",
        {"A": 1.5, "B": 19, "C:D": 8.8, "E": 9.6, "F": 8.8, "G": 9.6, "H:M": 8.8, "N": 1, "O": 8.8, "P:U": 8},
        {"Materials": "B5", "SNPoints": "I5", "AllowableStarts": "B22", "StartCycles": "O36"},
        (ChartAt("sn", "O5", 427, 300),),
        intro="Strength and S-N lines of the shaft materials (zero-to-peak; nominal stress times SCF or Kf is compared "
        "with them), and the fatigue damage of one start by rainflow count and Miner's rule.",
        printed_for=ALWAYS,
        print_to=35,
        largest=70,
    ),
    Sheet(
        "Strength",
        "input",
        {"A": 1.5, "B": 19, "C:L": 9.6, "M": 64},
        {"FatigueFactors": "B5", "FatigueLimits": "B22"},
        on="Fatigue",
        intro="Optional: stress concentration from geometry and the factors that lower the strength of a shaft. Below, the "
        "endurance limit beside the largest stress amplitude of each judged shaft.",
        printed_for=("FatigueFactors",),
    ),
    Sheet(
        "Frequencies",
        "result",
        {"A": 1.5, "B": 5, "C": 9.6, "D": 9, "E:F": 8, "G": 20, "H": 7, "I:J": 8},
        {"NaturalFrequencies": "B5"},
        on="Results",
        intro="Undamped torsional natural frequencies; rigid-body modes come first with frequency 0.",
    ),
    Sheet(
        "Margins",
        "result",
        {"A": 1.5, "B": 5, "C": 16, "D": 7.6, "E": 9.5, "F:G": 8, "H": 15.8, "I": 16, "J": 7.5},
        {"SeparationMargins": "B5"},
        on="Results",
        joins=True,
        intro="Margin = |f − f_exc| / f_exc, the least over the speeds of continuous operation; "
        "0 where an excitation crosses the mode within this range.",
    ),
    Sheet(
        "Steady state",
        "result",
        {"A": 1.5, "B": 20, "C": 20, "D": 6, "E": 9.6, "F": 16, "G:K": 11, "L": 24, "M:O": 10},
        {"SteadyState": "B23"},
        (ChartAt("shapes", "B5", 596, 336), ChartAt("interference", "H5", 640, 336)),
        on="Results",
        intro="Response to continuous excitation, by default 1 % zero-to-peak of the "
        "transmitted torque. Stresses include SCF and are compared with UTS/25.",
    ),
    Sheet(
        "Mode shapes",
        "result",
        {"A": 1.5, "B": 16, "C:L": 8.5},
        {"ModeShapes": "B5"},
        on="Results",
        intro="Physical twist of every station in the first modes; for work at the screen, the chart beside is printed.",
        printed_for=NEVER,
    ),
    Sheet(
        "Energy shares",
        "result",
        {"A": 1.5, "B": 16, "C": 20, "D:M": 8.5},
        {"EnergyShares": "B5"},
        on="Results",
        intro="Which stiffness or inertia moves a frequency; for work at the screen, not printed.",
        printed_for=NEVER,
    ),
    Sheet(
        "Start-up",
        "result",
        {"A": 1.5, "B": 19, "C:D": 9.6, "E": 7.2, "F": 9.4, "G": 8.2, "H": 8.2, "I:J": 7.2, "K": 14, "L": 8.5,
         "M:N": 9.3, "O:P": 6, "Q": 41.6},
        {"StartupCrossings": "B5", "StartupPeaks": f"B{OF_ELEMENTS}"},
        (
            ChartAt("speed-time", f"B{_CHARTS}", 576, _START_CHART),
            ChartAt("pull-in", f"J{_CHARTS}", 640, _START_CHART),
        ),
        on="Start",
        intro="The start from rest to EndSpeed, or to the end of pull-in or coast-down. Torques "
        "are at each element's own speed; a mesh's on its From side. Stresses here are nominal, without "
        "SCF.",
        largest=70,
    ),
    Sheet(
        "Histories",
        "result",
        {"A": 1.5, "B:G": 14, "H": 2, "I:N": 14},
        {"BearingForces": f"B{_BEARINGS}"},
        (
            *HISTORY_CHARTS,
            ChartAt("forces", f"I{_BEARINGS}", 600, 190),
        ),
        on="Start",
        intro="Torque, stress or tooth load against time from rest to EndSpeed (Szenasi & von "
              "Nimitz 1978, Figures 1, 7 and 8). Each point drawn is calculated; the extremes are "
              "kept. Below: torque and forces of a mesh about its least torque.",
        print_from=_HISTORY_ROWS[0] - 1,
    ),
    Sheet(
        "Reversals",
        "result",
        {"A": 1.5, "B": 19, "C": 9.4, "D:E": 7.2, "F": 5.2, "G:H": 7.2, "I": 5.8, "J:K": 7.2, "L": 8, "M:N": 7.3, "O": 7,
         "P": 6, "Q": 6.2, "R": 9.2, "S": 24, "T": 6.8, "U": 6.6, "V": 6},
        {"TorqueReversals": "B5", "MakerSheet": f"B{OF_ELEMENTS}"},
        (
            ChartAt("reversal", f"B{_CHARTS}", 560, _START_CHART),
            ChartAt("blow", f"K{_CHARTS}", 640, _START_CHART),
        ),
        on="Start",
        intro="Gear teeth that unload or separate during the start. A reversal is one passage of "
              "the torque below zero. Torques are those of the From side, at its own speed. More on sheet Notes. Below: "
              "what the makers of couplings, gears and shafts must know.",
    ),
    Sheet(
        "Effects",
        "result",
        {"A": 1.5, "B": 19, "C": 9, "D": 7, "E:H": 11, "I": 96},
        {"Effects": "B5", "Plans": f"H{_BELOW_EFFECTS}"},
        on="Effects and accuracy",
        intro="Effects that this case requires, each with its deciding number. Force an effect on "
              "or off in table EffectChoices on sheet Case.",
        printed_for=("Effects",),
        print_to=_BELOW_EFFECTS + len(EFFECT_NOTES),
    ),
    Sheet(
        "Standard",
        "result",
        {"A": 1.5, "B": 24, "C": 40, "D": 34, "E": 9, "F": 26, "G": 14, "H": 36},
        {"StandardRequirements": "B5"},
        on="Effects and accuracy",
        intro="What the standard that is named in scalar Standard asks for, and which checks show it.",
    ),
    Sheet(
        "Accuracy",
        "result",
        {"A": 1.5, "B": 21, "C": 40, "D:F": 10, "G": 1.5, "H:P": 8},
        {"AccuracyCost": "B9"},
        # below the rows of `Effects`, which are as high as their texts need
        (ChartAt("accuracy", "H24", 560, 300),),
        on="Effects and accuracy",
        intro="Error against computing time, for this case on this machine.",
        printed_for=("ChartAccuracy",),  # an accuracy study
    ),
    Sheet(
        "Audit", "result", {"A": 1.5, "B": 38, "C": 110}, {"Audit": "B5"}, freeze="A7",
        intro="What was calculated, from which inputs, by which version, method and equations.",
        printed_for=NEVER,
    ),
    Sheet(
        "Notes", "notes",
        {"A": 1.5, "B": 28, "C": 24, "D": 22, "E": 38, "F": 56, "G": 42, "H": 36, "I": 40}, {},
        freeze="A3",
        intro="How to use this workbook, what it calculates, what its colours mean, and below where each result "
        "comes from.",
        printed_for=NEVER,
    ),
)  # fmt: skip
#: Sheets with letters of their own, as are results that are never printed.
_OWN_LETTERS = ("Summary", "Audit", "Notes")
SHEETS: tuple[Sheet, ...] = side_by_side(
    [
        part
        if part.name in _OWN_LETTERS or (part.kind, part.printed_for) == ("result", NEVER)
        else readable(part)
        for part in _SHEETS
    ]
)


#: Sheets of earlier releases that are none now: their tables stand on others.
EARLIER_SHEETS = frozenset({part.name for part in SHEETS if part.on} | {"Starts", "Trace"})


def part_named(name: str) -> Sheet:
    """A sheet, or the part of one, by its name."""
    return next(sheet for sheet in SHEETS if sheet.name == name)


def range_of(name: str) -> str:
    """Where an input table stands in a blank workbook, with its headers and the units above them; as a formula names it."""
    part = next(sheet for sheet in SHEETS if name in sheet.tables)
    spec, place = table(name), part.at(part.tables[name])
    letters = place.rstrip("0123456789")
    caption, columns = int(place[len(letters) :]), spec.workbook_columns
    header = caption + (2 if any(field.has_unit for field in columns) else 1)
    right = column_letters(column_number(letters) + len(columns) - 1)
    sheet = part.worksheet if part.worksheet.isalnum() else f"'{part.worksheet}'"
    return f"{sheet}!{letters}{caption + 1}:{right}{header + spec.rows}"


TAB_COLOURS = {
    "summary": "#1F3A5F", "input": "#C9971C", "live": "#2A7F77", "result": "#44719B",
    "notes": "#8C8C8C",
}  # fmt: skip
KIND_WORDS = {
    "summary": "",
    "input": "Inputs",
    "live": "Live: worksheet functions answer as you type",
    "result": "Results: written by torsionbook; only units may be changed",
    "notes": "",
}

#: Left and right half of sheet `Case`: first column and the groups of scalars below each other.
CASE_HALVES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("B", ("Document", "Motor and line", "Continuous operation")),
    ("G", ("Start-up", "Accuracy and method", "Effects")),
)

#: Title block of the Summary, below the strip with document, revision, tag and title: label cell, first and last value cell, what it shows.
TITLE_BLOCK: tuple[tuple[str, str, str, str, str], ...] = (
    ("B4", "C4", "F4", "Client", "Client"),
    ("B5", "C5", "F5", "Results", "run_Stamp"),
    ("G4", "H4", "I4", "Prepared by", "PreparedBy"),
    ("G5", "H5", "I5", "Checked by", "CheckedBy"),
    (f"B{FOOT_ROW}", f"C{FOOT_ROW}", f"F{FOOT_ROW}", "Inputs SHA-256", "run_SHA256"),
    (f"G{FOOT_ROW}", f"H{FOOT_ROW}", f"I{FOOT_ROW}", "Calculated (UTC)", "run_Date"),
)


def _of_shaft(column: str) -> str:
    """An input of the shaft that table `StartCycles` belongs to."""
    return (
        '=IF(run_GoverningShaft="","",IFERROR('
        f'INDEX(Elements[{column}],MATCH(run_GoverningShaft,Elements[Element],0)),""))'
    )


#: Cell of the caption above the facts of the governing shaft on sheet `Fatigue`.
CYCLE_FACTS_AT = "O24"

#: What leads from the cycles of one start to 1/q.
CYCLE_FACTS = (
    KeyNumber("Governing shaft", BLANK_TEXT.format("run_GoverningShaft"), number_format="@"),
    KeyNumber(
        "Stress diameter", _of_shaft("Stress diameter"), "Elements[Stress diameter]", "0.000"
    ),
    KeyNumber("Stress bore", _of_shaft("Stress bore"), "Elements[Stress bore]", "0.000"),
    KeyNumber(
        "Kf, or SCF",
        '=IF(run_GoverningShaft="","",IFERROR('
        'INDEX(FatigueLimits[Kf],MATCH(run_GoverningShaft,FatigueLimits[Element],0)),""))',
        number_format="0.000",
    ),
    KeyNumber("Material", _of_shaft("Material")),
    KeyNumber(
        "Endurance limit in torsion",
        BLANK_TEXT.format("run_Endurance"),
        "StartCycles[Amplitude]",
        "[>=1000]#,##0;0.000",
    ),
    KeyNumber(
        "S-N exponent k at the limit", BLANK_TEXT.format("run_SNExponent"), number_format="0.000"
    ),
    KeyNumber(
        "Sum of n / N = damage q",
        '=IF(run_GoverningShaft="","",SUM(StartCycles[Damage check]))',
        number_format="0.000000E+00",
    ),
    KeyNumber(
        "1 / sum = allowable starts",
        '=IF(run_GoverningShaft="","",'
        'IF(COUNTIF(AllowableStarts[Allowable starts],"not judged")>0,"not judged",'
        'IF(SUM(StartCycles[Damage check])>0,1/SUM(StartCycles[Damage check]),"unlimited")))',
        number_format=shown.STARTS,
    ),
    KeyNumber(
        "Allowable starts in table AllowableStarts",
        '=IF(run_GoverningShaft="","",IFERROR(INDEX(AllowableStarts[Allowable starts],'
        'MATCH(run_GoverningShaft,AllowableStarts[Element],0)),""))',
        number_format=shown.STARTS,
    ),
)


def _element_at(column: str, extreme: str) -> str:
    """Element of the row where a result column has its extreme."""
    table = column.split("[")[0]
    return f'=IFERROR(INDEX({table}[Element],MATCH({extreme}({column}),{column},0)),"")'


def _extreme(column: str, extreme: str) -> str:
    return f'=IF(COUNT({column})=0,"",{extreme}({column}))'


def _rounded(positive: str, digits: int) -> str:
    """A positive number with so many digits, for words; TEXT would need the format of each language."""
    return f"ROUND({positive},{digits - 1}-INT(LOG10({positive})))"


#: Key numbers of the Summary: first the train at full speed, as `torsionbook check` says it.
KEY_NUMBERS = (
    KeyNumber(
        "Synchronous speed",
        BLANK_TEXT.format("run_SynchronousSpeed"),
        "rpm",
        "#,##0.0",
        BLANK_TEXT.format("run_ShaftSpeeds"),
    ),
    KeyNumber("Total ratio", BLANK_TEXT.format("run_TotalRatio"), "", shown.TELLING_RATIO),
    KeyNumber(
        "Rated power",
        BLANK_TEXT.format("run_RatedPower"),
        "kW",
        shown.TELLING_LARGE,
        f'=IF(run_RatedPower="","",{_rounded("run_RatedPower/0.74569987158227", 5)}&" hp")',
    ),
    KeyNumber(
        "Rated torque",
        BLANK_TEXT.format("run_RatedTorque"),
        "N m",
        shown.TELLING_LARGE,
        f'=IF(run_RatedTorque="","",{_rounded("run_RatedTorque/1.3558179483314", 5)}&" lbf ft")',
    ),
    KeyNumber(
        "Inertia constant H",
        BLANK_TEXT.format("run_InertiaConstant"),
        "s",
        shown.TELLING,
        f'=IF(run_MotorInertiaConstant="","","motor "&{_rounded("run_MotorInertiaConstant", 3)}&" s")',
    ),
    KeyNumber(
        "Running load / rated", BLANK_TEXT.format("run_RunningLoadShare"), "%", shown.TELLING_SHARE
    ),
    KeyNumber(
        "First torsional mode",
        '=IFERROR(INDEX(NaturalFrequencies[Frequency],MATCH(1,NaturalFrequencies[Mode],0)),"")',
        "NaturalFrequencies[Frequency]",
        shown.TELLING_SMALL,
    ),
    KeyNumber(
        "Least separation margin",
        _extreme("SeparationMargins[Margin]", "MIN"),
        "SeparationMargins[Margin]",
        "0.00",
        '=IFERROR("mode "&INDEX(SeparationMargins[Mode],MATCH(MIN(SeparationMargins[Margin]),'
        'SeparationMargins[Margin],0))&", "&INDEX(SeparationMargins[Excitation],'
        'MATCH(MIN(SeparationMargins[Margin]),SeparationMargins[Margin],0)),"")',
    ),
    KeyNumber(
        "Duration of the start",
        BLANK_TEXT.format("run_StartTime"),
        "s",
        shown.TELLING_SMALL,
        BLANK_TEXT.format("run_OutcomeWord"),
    ),
    KeyNumber(
        "Least mesh torque / transmitted",
        _extreme("TorqueReversals[Margin]", "MIN"),
        "TorqueReversals[Margin]",
        "0.0",
        _element_at("TorqueReversals[Margin]", "MIN"),
    ),
    KeyNumber(
        "Largest nominal stress, p-p",
        _extreme("StartupPeaks[Peak-to-peak stress]", "MAX"),
        "StartupPeaks[Peak-to-peak stress]",
        "[>=1000]#,##0;0.000",
        _element_at("StartupPeaks[Peak-to-peak stress]", "MAX"),
    ),
    KeyNumber(
        "Least allowable starts, whole",
        "=IF(COUNT(AllowableStarts[Starts to judge])>0,MIN(AllowableStarts[Starts to judge]),"
        'IF(COUNTIF(AllowableStarts[Allowable starts],"unlimited")>0,"unlimited",'
        'IF(COUNTIF(AllowableStarts[Allowable starts],"?*")>0,"not judged","")))',
        "",
        shown.WHOLE,
        _element_at("AllowableStarts[Starts to judge]", "MIN"),
    ),
)
