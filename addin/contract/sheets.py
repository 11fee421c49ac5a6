"""What stands where on the shipped workbooks, as data: sheets, title block, key numbers."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.banner import NOTES
from addin.contract.chart_tables import HISTORIES
from addin.contract.result_tables import CROSSING_ROWS
from addin.contract.sheet import ChartAt, KeyNumber, Sheet
from addin.contract.tables import table

BLANK_TEXT = '=IF({0}="","",{0})'


STRIP = (
    '="Document "&IF(Document="","-",Document)&"   Rev. "&IF(Revision="","-",Revision)'
    '&"   "&Tag&IF(AND(Tag<>"",Title<>""),"   ","")&Title'
)


# --- where everything stands ----------------------------------------------------------------------

#: Row of the cell above each history chart; the chart begins one row below.
_HISTORY_ROWS = (5, 20, 35)

HISTORY_CHARTS = tuple(
    ChartAt(f"history {k + 1}", f"{'BI'[k % 2]}{_HISTORY_ROWS[k // 2] + 1}", 624, 268)
    for k in range(HISTORIES)
)

#: Rows below the room of `TorqueReversals`: the chart with the bearing forces beside it.
_BELOW_REVERSALS = 8 + table("TorqueReversals").room + 1
#: First row of the notes of sheet `Reversals`, below chart and bearing forces.
REVERSAL_NOTES_AT = f"B{_BELOW_REVERSALS + table('BearingForces').room + 5}"
#: First row below the room of `Effects`.
_BELOW_EFFECTS = 8 + table("Effects").room + 1
EFFECT_NOTES_AT = f"B{_BELOW_EFFECTS}"


def _said(formula: str) -> str:
    """Words that stand only in a calculated workbook."""
    return f'=IF(run_SHA256="","",{formula})'


#: Notes that sheet Summary has room for, below its verdicts; the rest is on sheet Audit.
SUMMARY_NOTES = 8
NOTES_BEGIN = 28


def _note_line(number: int) -> str:
    """A note of the calculation; the last line says how many more there are."""
    note = f'IFERROR(INDEX(Audit[Value],MATCH("Warning {number}",Audit[Item],0)),"")'
    if number == 1:
        return f'=IF(AND({NOTES}=0,run_SHA256<>""),"None.",{note})'
    if number < SUMMARY_NOTES:
        return f"={note}"
    more = f'"And "&({NOTES}-{SUMMARY_NOTES - 1})&" more notes: see sheet Audit."'
    return f"=IF({NOTES}>{SUMMARY_NOTES},{more},{note})"


#: Lines that show facts of the run: sheet, first and last cell, formula, style, height in points.
FACT_LINES: tuple[tuple[str, str, str, str, str, float], ...] = (
    (
        "Start-up",
        "B4",
        "Q4",
        _said(
            'IF(run_Outcome="","No start was calculated: neither motor torque nor torque against '
            'time is given on sheet Torque.",run_Outcome&IF(COUNT(StartupCrossings[Mode])=0,'
            '"   No crossings: no pulsating torque of the motor crosses a mode.",""))'
        ),
        "fact",
        18.0,
    ),
    (
        "Reversals",
        "B4",
        "Q4",
        _said(
            'IF(run_Outcome="","No start: no motor torque is given.",'
            'IF(COUNTIF(TorqueReversals[Element],"?*")=0,"The train has no gear mesh and no geared coupling '
            'with backlash, so no torque reversal is judged.",'
            'IF(COUNT(BearingForces[Force])=0,"No bearing forces: no gear moves on its bearings in this '
            'start. Type bearing data on sheet Train; see the plan on sheet Effects.","")))'
        ),
        "note",
        15.0,
    ),
    (
        "Events",
        "B4",
        "N4",
        _said(
            'IF(AND(COUNTIF(EventTorque[Event],"?*")=0,COUNTIF(MotorEvents[Event],"?*")=0,'
            'InitialState<>"running"),"No event in operation: tables EventTorque and MotorEvents on sheet '
            'Excitation are blank.","")'
        ),
        "note",
        15.0,
    ),
    (
        "Starts",
        "B4",
        "I4",
        _said(
            'IF(run_Outcome="","No start: no motor torque is given.",'
            'IF(COUNTIF(AllowableStarts[Element],"?*")=0,"No shaft is judged: type Stress diameter and '
            'Material on sheet Train, Endurance and S-N points on sheet Fatigue.",""))'
        ),
        "note",
        15.0,
    ),
    *(
        ("Summary", f"H{row}", f"N{row}", _note_line(number), "prose", 26.0)
        for number, row in enumerate(range(NOTES_BEGIN, NOTES_BEGIN + SUMMARY_NOTES), 1)
    ),
    ("Accuracy", "B5", "P5", BLANK_TEXT.format("run_AccuracySentence"), "sentence", 42.0),
    ("Accuracy", "B6", "P6", BLANK_TEXT.format("run_AccuracyReference"), "prose", 26.0),
    ("Accuracy", "B7", "P7", BLANK_TEXT.format("run_AccuracyInputs"), "note", 15.0),
)

SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Summary",
        "summary",
        {"A": 1.5, "B": 26, "C": 14, "D": 9, "E:F": 18, "G": 2, "H": 28, "I:J": 11, "K": 21,
         "L": 40, "M": 22, "N": 44},
        {"Verdicts": "H11"},
        (ChartAt("train", "B12", 612, 270), ChartAt("speed-time", "B43", 612, 290)),
        freeze="",
        header_rows=2,
        one_page=True,
    ),
    Sheet(
        "Case",
        "input",
        {"A": 1.5, "B": 22, "C": 26, "D": 9, "E": 32, "F": 2, "G": 22, "H": 18, "I": 9, "J": 34},
        {"EffectChoices": "B32"},
        intro="Inputs of the case and how it is calculated. Type into the yellow cells (blue "
              "text); the unit is in the cell to the right of the number.",
    ),
    Sheet(
        "Train",
        "input",
        {"A": 1.5, "B": 21, "C": 22, "D:E": 13, "F": 13, "G:U": 9.5},
        {"Stations": "B5", "ModeDamping": "I5", "Elements": "B25", "Meshes": "B45"},
        intro="The mass-elastic table. Units are above the headers; the prompt of a cell says what "
              "blank means. Insert table rows where a table is full.",
    ),
    Sheet(
        "Sections",
        "input",
        {"A": 1.5, "B": 20, "C": 12, "D:G": 10, "H": 16, "I:L": 10, "M": 2, "N": 20, "O:R": 12},
        {"Sections": "B20", "SectionMaterials": "B55", "SectionResults": "N20"},
        (ChartAt("profile", "B5", 1180, 280),),
        freeze="A4",
        intro="Optional: stepped shafts and rotors from their sections, which give Stiffness and inertia of their "
        "element in table Elements.",
    ),
    Sheet(
        "Torque",
        "input",
        {"A": 1.5, "B": 14, "C:G": 10, "H": 2, "I": 14, "J": 10, "K": 13, "L": 2, "M": 14,
         "N:O": 10, "P": 2, "Q:X": 9},
        {"MotorTorque": "B5", "LoadTorque": "I5", "TorqueTime": "M5"},
        (
            ChartAt("torque", "Q5", 544, 334),
            ChartAt("motor-typed", "Q21", 544, 274),
            ChartAt("load-typed", "Q36", 544, 274),
        ),
        freeze="A8",
        intro="Torque against speed of the motor and of each driven machine; every curve begins "
        "with the row of its lowest speed.",
    ),
    Sheet(
        "Motor",
        "input",
        {"A": 1.5, "B": 18, "C": 12, "D:Z": 11, "AA:AG": 8},
        {"MotorData": "B5", "MotorCircuit": "B15", "MotorCurves": "B25", "SupplyVoltage": "N46",
         "Supply": "R46", "MotorTimeConstants": "AB46"},
        (ChartAt("motor-curves", "N26", 640, 334),),
        freeze="A4",
        intro="Optional: the data sheet of a motor, from which its torque curves are calculated. Where sheet "
        "Torque has no curve of its station, the start uses them.",
    ),
    Sheet(
        "Fatigue",
        "input",
        {"A": 1.5, "B": 18, "C:E": 11, "F": 10, "G": 15, "H": 2, "I": 18, "J:K": 11, "L": 2,
         "M:T": 9},
        {"Materials": "B5", "SNPoints": "I5"},
        (ChartAt("sn", "M5", 544, 400),),
        freeze="A8",
        intro="Strength and S-N lines of the shaft materials. Amplitudes are zero-to-peak; "
        "nominal stress times SCF is compared with them.",
    ),
    Sheet(
        "Excitation",
        "input",
        {"A": 1.5, "B": 30, "C": 14, "D": 22, "E": 13, "F": 22, "G": 14, "H:K": 18, "L:M": 12},
        {"Excitations": "B5", "EventTorque": "B24", "MotorEvents": "B49"},
        intro="Excitations in continuous operation. Leave the table blank for the defaults: 1× and "
              "2× of every shaft speed, 1× and 2× line frequency. Below: torques of faults in operation.",
    ),
    Sheet(
        "Frequencies",
        "result",
        {"A": 1.5, "B": 7, "C:D": 11, "E:F": 10, "G": 24, "H:I": 9, "J": 11, "K": 2, "L": 18,
         "M:V": 8.5, "W": 2, "X": 18, "Y": 24, "Z:AI": 8.5, "AJ": 2, "AK": 18, "AL": 7, "AM:AU": 11},
        {"NaturalFrequencies": "B5", "ModeShapes": "L24", "EnergyShares": "X5", "ElectricalDamping": "AK5"},
        (ChartAt("shapes", "L5", 768, 362),),
        breaks=("L", "X", "AK"),
        largest=80,
        intro="Undamped torsional natural frequencies and mode shapes; rigid-body modes come "
        "first with frequency 0.",
    ),
    Sheet(
        "Margins",
        "result",
        {"A": 1.5, "B": 7, "C": 26, "D": 10, "E": 12, "F:G": 10, "H": 24, "I": 40, "J": 10, "K": 2,
         "L:S": 9.5, "T": 2, "U": 24, "V": 40, "W": 34, "X": 9, "Y": 26, "Z": 14, "AA": 36},
        {"SeparationMargins": "B5", "StandardRequirements": "U5"},
        (ChartAt("interference", "L8", 570, 520),),
        freeze="A8",
        header_rows=7,
        intro="Margin = |f − f_exc| / f_exc, the least over the speeds of continuous operation; "
        "0 where an excitation crosses the mode within this range.",
    ),
    Sheet(
        "Steady state",
        "result",
        {"A": 1.5, "B": 22, "C": 26, "D": 7, "E": 11, "F": 16, "G:K": 12, "L": 24, "M:N": 12},
        {"SteadyState": "B5"},
        freeze="A8",
        header_rows=7,
        intro="Response to continuous excitation, by default 1 % zero-to-peak of the "
        "transmitted torque. Stresses include SCF and are compared with UTS/25.",
    ),
    Sheet(
        "Start-up",
        "result",
        {"A": 1.5, "B": 20, "C:J": 10.4, "K": 20, "L:P": 10.4, "Q": 74},
        {"StartupCrossings": "B5", "StartupPeaks": f"B{9 + CROSSING_ROWS}"},
        (
            ChartAt("speed-time", f"Q{9 + CROSSING_ROWS}", 520, 304),
            ChartAt("blow", f"Q{25 + CROSSING_ROWS}", 520, 284),
            ChartAt("pull-in", f"Q{40 + CROSSING_ROWS}", 520, 284),
        ),
        one_page=True,
        intro="The start from rest to EndSpeed, or to the end of pull-in or coast-down. Torques "
        "are at each element's own speed; a mesh's on its From side. Stresses here are nominal, without "
        "SCF.",
    ),
    Sheet(
        "Histories",
        "result",
        {"A": 1.5, "B": 14, "C:D": 14, "E:G": 14, "H": 2, "I:N": 14},
        {},
        HISTORY_CHARTS,
        one_page=True,
        intro="Torque, stress or tooth load against time from rest to EndSpeed (Szenasi & von "
              "Nimitz 1978, Figures 1, 7 and 8). Each point drawn is calculated; the extremes are "
              "kept.",
    ),
    Sheet(
        "Reversals",
        "result",
        {"A": 1.5, "B": 22, "C": 10.4, "D:N": 9.2, "O": 11, "P": 10, "Q:R": 9.5, "S": 48, "T": 9},
        {"TorqueReversals": "B5", "BearingForces": f"K{_BELOW_REVERSALS}"},
        (
            ChartAt("reversal", f"B{_BELOW_REVERSALS}", 660, 330),
            ChartAt("forces", f"O{_BELOW_REVERSALS + 1}", 620, 310),
        ),
        intro="Gear teeth that unload or separate during the start. A reversal is one passage of "
              "the torque below zero. Torques are those of the From side, at its own speed.",
    ),
    Sheet(
        "Starts",
        "result",
        {"A": 1.5, "B": 24, "C:F": 13, "G:H": 11, "I:L": 12, "M": 2, "N:U": 9.5},
        {"AllowableStarts": "B5", "StartCycles": "N44"},
        (ChartAt("sn", "N8", 570, 420),),
        freeze="A8",
        header_rows=7,
        intro="Fatigue damage of one start by rainflow count and Miner's rule; allowable starts "
        "are 1 / damage. Amplitude = half range times SCF; mean stress is ignored.",
    ),
    Sheet(
        "Events",
        "result",
        {"A": 1.5, "B": 24, "C": 22, "D:E": 12, "F:H": 10, "I:K": 11, "L": 12, "M": 20, "N:U": 10,
         "V": 2, "W": 24, "X:AF": 12},
        {"EventPeaks": "B5", "AirGapTorque": "W5"},
        (ChartAt("air-gap", "W22", 640, 334), ChartAt("clearing", "W40", 640, 334)),
        breaks=("V",),
        freeze="A8",
        header_rows=7,
        intro="Faults in operation: events of tables EventTorque and MotorEvents (sheet Excitation) upon the train that "
        "runs under its running loads, or starts. They count as no starts.",
    ),
    Sheet(
        "Effects",
        "result",
        {"A": 1.5, "B": 19, "C": 9, "D": 7, "E:H": 11, "I": 96},
        {"Effects": "B5", "Plans": f"H{_BELOW_EFFECTS}"},
        intro="Effects that this case requires, each with its deciding number. Force an effect on "
              "or off in table EffectChoices on sheet Case.",
    ),
    Sheet(
        "Accuracy",
        "result",
        {"A": 1.5, "B": 23, "C": 40, "D:F": 11, "G": 2, "H:P": 9.5},
        {"AccuracyCost": "B9"},
        (ChartAt("accuracy", "H9", 640, 420),),
        intro="Error against computing time, for this case on this machine.",
    ),
    Sheet(
        "Audit", "result", {"A": 1.5, "B": 38, "C": 110}, {"Audit": "B5"}, freeze="A7",
        intro="What was calculated, from which inputs, by which version, method and equations.",
    ),
    Sheet(
        "Notes", "notes", {"A": 1.5, "B": 28, "C": 122}, {}, freeze="A3",
        intro="How to use this workbook, what it calculates and what its colours mean.",
    ),
    Sheet(
        "Trace",
        "notes",
        {"A": 1.5, "B": 13, "C": 24, "D": 22, "E": 38, "F": 56, "G": 42, "H": 36, "I": 40},
        {},
        freeze="A6",
        header_rows=5,
        intro="Meaning, equation, source and inputs of each number on the result sheets. For one "
              "cell, with the cells and values it comes from: torsionbook verify FILE --trace "
              "'Sheet!H9'",
    ),
)  # fmt: skip

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

#: Title block of the Summary: label cell, first and last value cell, what it shows.
TITLE_BLOCK: tuple[tuple[str, str, str, str, str], ...] = (
    ("B4", "C4", "F4", "Title", "Title"),
    ("B5", "C5", "F5", "Equipment tag", "Tag"),
    ("B6", "C6", "F6", "Client", "Client"),
    ("B7", "C7", "F7", "Inputs SHA-256", "run_SHA256"),
    ("H4", "I4", "J4", "Document no.", "Document"),
    ("K4", "L4", "N4", "Revision", "Revision"),
    ("H5", "I5", "J5", "Prepared by", "PreparedBy"),
    ("K5", "L5", "N5", "Checked by", "CheckedBy"),
    ("H6", "I6", "J6", "Software", "run_Software"),
    ("K6", "L6", "N6", "Calculated (UTC)", "run_Date"),
    ("H7", "I7", "N7", "Results", "run_Stamp"),
)


def _of_shaft(column: str) -> str:
    """An input of the shaft that table `StartCycles` belongs to."""
    return (
        '=IF(run_GoverningShaft="","",IFERROR('
        f'INDEX(Elements[{column}],MATCH(run_GoverningShaft,Elements[Element],0)),""))'
    )


#: Cell of the caption above the facts of the governing shaft on sheet `Starts`.
CYCLE_FACTS_AT = "N31"

#: What leads from the cycles of one start to 1/q.
CYCLE_FACTS = (
    KeyNumber("Governing shaft", BLANK_TEXT.format("run_GoverningShaft"), number_format="@"),
    KeyNumber(
        "Stress diameter", _of_shaft("Stress diameter"), "Elements[Stress diameter]", "0.000"
    ),
    KeyNumber("Stress bore", _of_shaft("Stress bore"), "Elements[Stress bore]", "0.000"),
    KeyNumber("SCF", _of_shaft("SCF")),
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
        "Poles",
        BLANK_TEXT.format("run_Poles"),
        number_format="0",
        where='=IF(OR(run_Poles="",run_LineFrequency=""),"","at "&run_LineFrequency&" Hz")',
    ),
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
        "Load at full speed / rated", BLANK_TEXT.format("run_LoadShare"), "%", shown.TELLING_SHARE
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
        "Modes below 2 × line frequency",
        '=IF(COUNT(NaturalFrequencies[Percent speed])=0,"",COUNT(NaturalFrequencies[Percent speed]))',
        number_format="0",
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
