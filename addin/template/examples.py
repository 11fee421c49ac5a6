"""The filled examples: the sample case of Szenasi and von Nimitz (1978), US customary units.

The paper publishes the results of this train but not its data. What stands here was assumed, in round
numbers, so that the natural frequencies of Table 1 come out as printed by changing the three couplings
alone; `PROVENANCE` says which number is which and is printed in all examples. The third example
is the proposed design with what the paper describes in words: clearance, bearings, pull-in. The
fourth is the modified design with the data sheet of a motor instead of torque curves, a fault, and a stepped shaft.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise, repeat

from addin.contract import tables as fields
from addin.contract.sources import PAPER, PAPER_TITLE
from addin.contract.units import UnitScale, parse_unit
from addin.reading.typed_case import Entry, Findings, Typed, TypedCase, to_case_data
from engine.case.data import CaseData

Value = float | int | str

_RATIO = 5.6
#: Station: description, inertia at its own speed in lb ft², and its speed over that of the motor.
_STATIONS: tuple[tuple[str, str, float, float], ...] = (
    ("Motor", "Motor rotor", 24000, 1),
    ("LS hub M", "LS coupling, motor half", 140, 1),
    ("LS hub G", "LS coupling, gear half", 140, 1),
    ("Bull gear", "Bull gear", 4400, 1),
    ("Pinion", "Pinion", 16, _RATIO),
    ("HS hub P", "HS coupling, pinion half", 3.5, _RATIO),
    ("HS hub C", "HS coupling, LP half", 3.5, _RATIO),
    ("LP comp", "LP compressor rotor", 300, _RATIO),
    ("IC hub L", "IC coupling, LP half", 2.8, _RATIO),
    ("IC hub H", "IC coupling, HP half", 2.8, _RATIO),
    ("HP comp", "HP compressor rotor", 70, _RATIO),
)
_RATED_TORQUE = 43770  # lbf ft; 15,000 hp

#: Element: kind and stiffness in lbf in/rad at its own speed; None = one of `_COUPLINGS`.
_ELEMENTS: tuple[tuple[str, str, float | None], ...] = (
    ("Motor shaft", "shaft", 2.2e9),
    ("LS coupling", "coupling", None),
    ("Gear shaft", "shaft", 2.6e9),
    ("Mesh", "gear mesh", 5e10),
    ("Pinion shaft", "shaft", 1e8),
    ("HS coupling", "coupling", None),
    ("LP shaft, drive end", "shaft", 8e7),
    ("LP shaft, far end", "shaft", 8e7),
    ("Intermediate coupling", "coupling", None),
    ("HP compressor shaft", "shaft", 6e7),
)
_COUPLINGS = {
    "proposed": {"LS coupling": 3.09e8, "HS coupling": 8.29e6, "Intermediate coupling": 2.49e6},
    "modified": {"LS coupling": 2.95e8, "HS coupling": 2.48e6, "Intermediate coupling": 1.27e6},
}

#: Stress diameter of the shafts. [in]
_DIAMETERS = {
    "Motor shaft": 10,
    "Gear shaft": 9.5,
    "Pinion shaft": 5.25,
    "LP shaft, drive end": 5,
    "LP shaft, far end": 3.75,
    "HP compressor shaft": 2.5,
}
#: Stress concentration: of the HP compressor shaft, with its keyway, and of the others.
_SCF_KEYWAY, _SCF = 3, 2
#: Rated torque, Peak torque limit, Vibratory limit and Reversal limit. [lbf in]
_LIMITS: Mapping[str, tuple[int, ...]] = {
    "LS coupling": (1050000, 2100000, 220000),
    "Mesh": (650000, 1550000, 130000, 400000),
    "HS coupling": (220000, 440000, 45000),
    "Intermediate coupling": (110000, 220000, 22000),
}

_SPEED = (0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98, 100)  # % of synchronous
_AVERAGE = (0.7, 0.72, 0.74, 0.78, 0.83, 0.9, 0.98, 1.08, 1.2, 1.24, 1.2, 1, 0.6, 0)
_PULSATING = (
    0.42, 0.42, 0.42, 0.41, 0.4, 0.39, 0.38, 0.36, 0.34, 0.32, 0.31, 0.3, 0.3, 0.32,
)  # fmt: skip
#: Of the LP and of the HP compressor, at their own speed, 60 and 40 % of 25 % of the rated torque at full speed. [lbf ft]
_LOADS = {
    "LP comp": (280, 90, 90, 140, 230, 330, 470, 610, 800, 890, 980, 1080, 1130, 1170),
    "HP comp": (190, 60, 60, 90, 160, 220, 310, 410, 530, 590, 660, 720, 750, 780),
}

_MATERIAL = "Alloy steel"

PROVENANCE: tuple[tuple[str, str], ...] = (
    (
        "Source",
        f"{PAPER_TITLE}, Southwest Research Institute, 1978: sample case, Table 1 and Figures 5 to 8.",
    ),
    (
        "Published",
        "Table 1 (30, 53 and 86 Hz proposed; 21, 39 and 69 Hz modified) with its column of % "
        "speed; in the HP compressor shaft, when the first mode is excited, 30,000 psi "
        "peak-to-peak in the proposed design against 19,000 psi as installed; more than "
        "2,000 allowable starts as installed; only couplings changed; torque reversal at the "
        "gear in the proposed design and a small amount of backlash for a few cycles as "
        "installed.",
    ),
    (
        "Assumed",
        "The paper gives no mass-elastic data, torque curves, diameters or S-N data; those "
        "of this example are assumed: inertias, shaft and coupling stiffnesses in round numbers, so that "
        "changing only the three couplings gives Table 1 as printed (within 0.02 Hz, and its column of % speed); "
        "a rated torque for 15,000 hp; torque curves, with a pulsation of 0.3 to 0.42 pu zero-to-peak (the data sheet of example motor "
        "gives 0.32 to 0.37 up to 75 % speed); 1.5 % modal damping; the 2.5 in stress diameter so that the proposed "
        "design gives 30,000 psi peak-to-peak; S-N line and SCF typical of a keyed "
        "alloy-steel shaft; pitch radii and pressure angle of the gear; stress diameters of the "
        "other shafts with SCF 2, yield strength, and limits of couplings and gear as a catalogue "
        "states them. All results of the modified design except its frequencies are therefore "
        "predictions.",
    ),
    (
        "Reference",
        "An independent integrator (scipy DOP853, linear, from rest to 97 % speed) "
        "gives: HP compressor shaft 30,130 psi peak-to-peak as proposed and 19,700 psi as modified (the paper: 19,000); "
        "mesh torque -1.351 to 2.313 x rated and -0.707 to 1.754 x rated. The paper's designs read the motor's curves at "
        "the rotor's own speed here (TorqueFollows): the stress diameter was chosen that way.",
    ),
    (
        "Left blank",
        "Running loads are not given. Backlash, mesh "
        "damping, gear masses, bearings and field are blank in the two designs of the paper, "
        "whose results are for the linear train; the third example includes them. The mesh "
        "stiffness 5e10 lbf in/rad is torsional, on the bull gear.",
    ),
)

#: What the third example adds.
BACKLASH_PROVENANCE: tuple[tuple[str, str], ...] = (
    (
        "Added here",
        "Assumed, typical of such a train: 0.016 in normal backlash; bearing "
        "stiffness 2.3e6 lbf/in (bull gear, 3,500 lb) and 1.7e6 lbf/in (pinion, 330 lb) with 10 % of "
        "critical damping; field at 3 % slip, field time constant 0.5 s, pull-out torque 2 pu; "
        "transient at breaker closing of 0.5 pu, decaying in 60 ms. Only the gear-tooth behaviour "
        "(Figure 4) is described in the paper, without numbers.",
    ),
)

#: What the fourth example has instead of torque curves.
MOTOR_PROVENANCE: tuple[tuple[str, str], ...] = (
    (
        "Added here",
        "Data sheet of the motor instead of torque curves: reactances and time constants of the "
        "synchronous machine of the Modelica Standard Library (its circuit at 60 Hz: time "
        "constants times 50/60), rating and voltage assumed to suit the train. Discharge "
        "resistance 9 times that of the field; 0.016 in normal backlash; field at 3 % "
        "slip. The short circuit is that of constant flux at no load, -sin(wt)/Xd'' + "
        "(1/Xd'' - 1/Xq'')/2 sin(2wt) in pu of apparent power, decaying with Ta. The dip to "
        "70 % voltage for 150 ms is calculated from the motor data.",
    ),
    (
        "Sections",
        "The drive end of the LP shaft is typed as on a drawing, assumed so that its stiffness is that of the modified design "
        "within 0.3 %; the inertia of its sections is taken off that of the LP compressor. The gear has 112 and 20 teeth: the "
        "speed ratio 5.6 of the stations behind it follows from them.",
    ),
)


@dataclass(frozen=True)
class Example:
    """A filled workbook, in the units it shows."""

    scalars: Mapping[str, Value]  #: By defined name. [shown units]
    units: Mapping[tuple[str, str], str]  #: Units other than those of the blank template. [units]
    #: Rows of the input tables, by header. [shown units]
    tables: Mapping[str, Sequence[Mapping[str, Value]]]
    #: Units of scalars other than those of the blank template. [units]
    scalar_units: Mapping[str, str] = field(default_factory=dict)
    #: Where its numbers come from: term and text.
    provenance: tuple[tuple[str, str], ...] = ()


def _scalars(design: str) -> dict[str, Value]:
    return {
        "Title": f"Torsional start-up analysis, compressor train, {design} system",
        "Tag": f"Sample case, {PAPER.cited}",
        "Client": "Example",
        "Document": f"SAMPLE-{design[:3].upper()}",
        "Revision": "0",
        "PreparedBy": "torsionbook",
        "LineFrequency": 60,
        "SynchronousSpeed": 1800,
        "Poles": 4,
        "RatedTorque": _RATED_TORQUE,
        "DampingRatio": 1.5,
        "MarginBasis": "calculated",
        "StressBasis": "peak-to-peak",
        "EndSpeed": 97,
        "TorqueFollows": "own speed",
        "StartsRequired": 2000,
    }


def _rows(headers: Sequence[str], *rows: Sequence[Value | None]) -> list[dict[str, Value]]:
    """Rows of an input table below its headers; what is blank is left out."""
    return [
        {name: value for name, value in zip(headers, row, strict=False) if value is not None}
        for row in rows
    ]


def _stations() -> list[dict[str, Value]]:
    return _rows(
        ("Station", "Description", "Inertia", "Speed ratio"),
        *_STATIONS,
    )


def _elements(design: str) -> list[dict[str, Value]]:
    names = [station[0] for station in _STATIONS]
    rows = _rows(
        ("Element", "Kind", "From", "To", "Stiffness"),
        *(
            (name, kind, *ends, stiffness or _COUPLINGS[design][name])
            for (name, kind, stiffness), ends in zip(_ELEMENTS, pairwise(names), strict=True)
        ),
    )
    headers = ("Rated torque", "Peak torque limit", "Vibratory limit", "Reversal limit")
    for row in rows:
        name = str(row["Element"])
        if name in _DIAMETERS:
            scf = _SCF_KEYWAY if name == "HP compressor shaft" else _SCF
            row |= {"Stress diameter": _DIAMETERS[name], "SCF": scf, "Material": _MATERIAL}
        row |= dict(zip(headers, _LIMITS.get(name, ()), strict=False))
    return rows


def _loads() -> list[dict[str, Value]]:
    return _rows(
        ("Station", "Speed", "Torque"),
        *(
            (station, speed, load)
            for station, loads in _LOADS.items()
            for speed, load in zip(_SPEED, loads, strict=True)
        ),
    )


#: Design whose numbers the third example shares, and its additions.
_BACKLASH = "backlash"
_BACKLASH_SCALARS: dict[str, Value] = {
    "ShockAmplitude": 0.5,
    "ShockTimeConstant": 0.06,
    "FieldSlip": 3,
    "FieldTimeConstant": 0.5,
    "PullOutTorque": 2,
}
_BACKLASH_GEAR: dict[str, Value] = {
    "Backlash": 0.016,
    "Mass drive": 3500,
    "Mass driven": 330,
    "Bearing stiffness drive": 2.3e6,
    "Bearing stiffness driven": 1.7e6,
    "Bearing damping drive": 910,
    "Bearing damping driven": 240,
}


def _backlash_example() -> Example:
    """The proposed design with clearance, bearings, breaker closing and pull-in."""
    plain = _example("proposed")
    title = {
        "Title": "Torsional start-up analysis, compressor train with backlash",
        "Document": "SAMPLE-GAP",
    }
    gear = {**plain.tables["Meshes"][0], **_BACKLASH_GEAR}
    return replace(
        plain,
        scalars={**plain.scalars, **title, **_BACKLASH_SCALARS},
        tables={**plain.tables, "Meshes": [gear]},
        provenance=(*PROVENANCE, *BACKLASH_PROVENANCE),
    )


_MOTOR = "motor"
_MOTOR_DATA: dict[str, Value] = {
    "Station": "Motor",
    "Apparent power": 12800,
    "Voltage": 6600,
    "Power factor": 0.9,
    "Efficiency": 0.97,
    "Xd": 1.6,
    "Xq": 1.6,
    "Xd transient": 0.1375,
    "Xd subtransient": 0.1214,
    "Xq subtransient": 0.1484,
    "Xl": 0.1,
    "Td0 transient": 0.2176,
    "Td0 subtransient": 0.0058,
    "Tq0 subtransient": 0.1028,
    "Ta": 0.0118,
    "Discharge resistance": 9,
}


#: Drive end of the LP shaft, from the face of the coupling hub: name, length, diameter and fillet to the next. [in]
_LP_SECTIONS = (
    ("coupling end", 1, 5),
    ("journal", 4, 5.25, 0.125),
    ("seal", 4.5, 6, 0.25),
    ("core", 11, 7.5),
)
#: Inertia of the LP compressor without that of these sections. [lb ft²]
_LP_ROTOR = 291.4


def _motor_example() -> Example:
    """The modified design with a motor given by its data sheet, a short circuit, a voltage dip and a stepped shaft."""
    plain = _example("modified")
    stepped = "LP shaft, drive end"
    stations = [
        {
            name: _LP_ROTOR if (row["Station"], name) == ("LP comp", "Inertia") else value
            for name, value in row.items()
            if name != "Speed ratio"
        }
        for row in plain.tables["Stations"]
    ]
    elements = [
        {n: v for n, v in row.items() if (row["Element"], n) != (stepped, "Stiffness")}
        for row in plain.tables["Elements"]
    ]
    sections = _rows(
        ("Element", "Section", "Length", "OD", "Fillet"),
        *((stepped, *row) for row in _LP_SECTIONS),
    )
    scalars: dict[str, Value] = {
        "Title": "Torsional start-up analysis, compressor train, motor from its data sheet",
        "Document": "SAMPLE-MOT",
        "FieldSlip": 3,
        "FieldTimeConstant": 0.5,
        "PullOutTorque": 2,
    }
    gear = {
        **plain.tables["Meshes"][0],
        "Backlash": _BACKLASH_GEAR["Backlash"],
        "Teeth drive": 112,
        "Teeth driven": 20,
    }
    fault = _rows(
        ("Event", "Station", "Amplitude", "Multiple", "Phase", "Time constant"),
        ("three-phase fault", "Motor", -9.43, 1, -90, 0.0118),
        ("three-phase fault", "Motor", 0.857, 2, -90, 0.0059),
    )
    dip = _rows(
        ("Event", "Station", "Kind", "Residual voltage", "Clears after"),
        ("voltage dip", "Motor", "voltage dip", 0.7, 0.15),
    )
    tables = {name: rows for name, rows in plain.tables.items() if name != "MotorTorque"}
    kept = {name: value for name, value in plain.scalars.items() if name != "TorqueFollows"}
    return replace(
        plain,
        scalars={**kept, **scalars},
        tables={
            **tables,
            "Stations": stations,
            "Elements": elements,
            "Sections": sections,
            "Meshes": [gear],
            "MotorData": [_MOTOR_DATA],
            "MotorEvents": dip,
            "EventTorque": fault,
        },
        provenance=(*PROVENANCE, *MOTOR_PROVENANCE),
    )


def _example(design: str) -> Example:
    tables: dict[str, Sequence[Mapping[str, Value]]] = {
        "Stations": _stations(),
        "Elements": _elements(design),
        "Meshes": _rows(
            ("Element", "Pitch radius drive", "Pitch radius driven", "Pressure angle"),
            ("Mesh", 16.8, 3, 20),
        ),
        "MotorTorque": _rows(
            ("Station", "Speed", "Average", "Pulsating"),
            *zip(repeat("Motor"), _SPEED, _AVERAGE, _PULSATING, strict=False),
        ),
        "LoadTorque": _loads(),
        "Materials": _rows(
            ("Material", "UTS", "Yield", "Endurance", "Basis", "Below endurance"),
            (_MATERIAL, 110000, 85000, 19000, "torsion", "none"),
        ),
        "SNPoints": _rows(
            ("Material", "Cycles", "Stress"),
            (_MATERIAL, 1000, 49500),
            (_MATERIAL, 1000000, 19000),
        ),
    }
    units = {("MotorTorque", name): "pu" for name in ("Average", "Pulsating", "Pulsation1")}
    return Example(_scalars(design), units, tables, provenance=PROVENANCE)


#: Examples by name.
EXAMPLES: Mapping[str, Example] = {
    **{design: _example(design) for design in _COUPLINGS},
    _BACKLASH: _backlash_example(),
    _MOTOR: _motor_example(),
}


def example_case(example: Example, system: str) -> CaseData:
    """An example read as the workbook made of it will be, for the drawings that need no calculation.

    Parameters
    ----------
    example : Example
        The example, as typed.
    system : str
        Units of the workbook where the example names none: ``us`` or ``si``. [word]

    Returns
    -------
    CaseData
        What cannot be resolved is blank. [SI]
    """
    typed = TypedCase(
        {
            name: _entry(value, fields.scalar(name), example.scalar_units.get(name), system)
            for name, value in example.scalars.items()
        }
    )
    for spec in fields.INPUT_TABLES:
        typed.tables[spec.name] = [
            {
                field.name: _entry(
                    row[field.name], field, example.units.get((spec.name, field.name)), system
                )
                for field in spec.columns
                if field.name in row
            }
            for row in example.tables.get(spec.name, ())
        ]
    return to_case_data(typed, Findings())


def _entry(value: Value, field: fields.Field, unit: str | None, system: str) -> Entry:
    if isinstance(value, str):
        return value
    if not field.has_unit:
        return Typed(value, UnitScale(1.0), "")
    unit = unit or str(getattr(field, f"unit_{system}"))
    return Typed(value, parse_unit(unit, field.dimension), unit)


# --- studies: what an engineer would ask of the sample case ---------------------------------------

Rows = Mapping[str, Sequence[Mapping[str, Value]]]


def _duty(behind_mode_1: float) -> Sequence[Mapping[str, Value]]:
    """A year of starts, and those so far; speed just past the crossing of mode 1. [%]"""
    return _rows(
        ("Condition", "Per year", "So far", "Voltage", "Load", "Damping ratio", "Trip speed"),
        ("normal start", 24, 60),
        ("weak supply", 6, 12, 80),
        ("strong supply", 6, 12, 105),
        ("by-passed", 12, 20, None, 0),
        ("hot restart", 4, 8, None, None, 1.2),
        ("trip behind mode 1", 0.5, 1, None, None, None, behind_mode_1),
        ("supply sags to 40 %", None, None, 40),
    )


def _measured(frequencies: Sequence[Sequence[Value]], peak: float) -> Rows:
    """Frequencies with their uncertainties, and the largest torque of the HS coupling. [Hz, %, lbf ft]"""
    return {
        "MeasuredFrequencies": _rows(("Frequency", "Uncertainty"), *frequencies),
        "MeasuredPeaks": _rows(
            ("Element", "Maximum torque", "Uncertainty"), ("HS coupling", peak, 5)
        ),
    }


#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Rows = {
    "Tuning": _rows(
        ("Element", "Quantity", "Unit", "Values"),
        ("HS coupling", "stiffness", "%", "20; 25; 30; 40; 50; 60; 80; 100"),
        ("Intermediate coupling", "stiffness", "%", "35; 51; 70; 100"),
    ),
    "Catalogue": _rows(
        ("Element", "Name", "Fitted", "Stiffness", "Inertia", "Loss factor", "Rated torque"),
        ("LS coupling", "as proposed", "yes", 3.09e8, 85.0),
        ("LS coupling", "as modified", None, 2.95e8, 85.0),
        ("LS coupling", "softer, 4 % loss factor", None, 2e8, 130.0, 0.04, 6.5e5),
    ),
    "Scatter": _rows(
        ("Quantity", "Distribution", "Spread", "Together", "From", "To"),
        ("stiffness", "normal", 5.0),
        ("inertia", "normal", 2.0),
        ("damping ratio", "uniform", 30.0),
        ("average torque", "normal", 5.0),
        ("pulsating torque", "triangular", 10.0),
        ("load torque", "normal", 5.0, "together"),
        ("S-N line", "from-to", None, None, 90.0, 110.0),
    ),
    "StartConditions": _duty(79),
    **_measured(((29.4, 1), (54.1, 1), (120, 0.5)), 17200),
}

#: Where an example has others.
_OF_EXAMPLE: Mapping[str, Rows] = {
    "modified": {
        "StartConditions": _duty(85.5),
        **_measured(((20.7, 1), (39.6, 1), (68.1, 1)), 13200),
    }
}


def study_rows(example: str) -> Rows:
    """Rows of the study tables of an example."""
    return {**STUDY_ROWS, **_OF_EXAMPLE.get(example, {})}
