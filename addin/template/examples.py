"""The filled examples: the sample case of Szenasi and von Nimitz (1978), US customary units.

The paper publishes the results of this train but not its data. What stands here was constructed
so that the published natural frequencies come out to six digits by changing the three couplings
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

#: SI value of one unit shown by the examples. Exact by definition of inch, pound and g.
_INCH, _POUND, _LBF = 0.0254, 0.45359237, 4.4482216152605
_LB_FT2 = _POUND * (12.0 * _INCH) ** 2
_LBF_IN = _LBF * _INCH
_LBF_FT = 12.0 * _LBF_IN

_RATIO = 5.6
#: Station: description, inertia in kg m² at its own speed, and its speed over that of the motor.
_STATIONS: tuple[tuple[str, str, float, float], ...] = (
    ("Motor", "Motor rotor", 460.76, 1.0),
    ("LS hub M", "LS coupling, motor half", 6.0, 1.0),
    ("LS hub G", "LS coupling, gear half", 6.0, 1.0),
    ("Bull gear", "Bull gear", 167.83, 1.0),
    ("Pinion", "Pinion", 0.6835, _RATIO),
    ("HS hub P", "HS coupling, pinion half", 0.15, _RATIO),
    ("HS hub C", "HS coupling, LP half", 0.15, _RATIO),
    ("LP comp", "LP compressor rotor", 18.631, _RATIO),
    ("IC hub L", "IC coupling, LP half", 0.12, _RATIO),
    ("IC hub H", "IC coupling, HP half", 0.12, _RATIO),
    ("HP comp", "HP compressor rotor", 8.3399, _RATIO),
)
_RATED_TORQUE = 58400.0  # N m

#: Element: kind and stiffness in N m/rad at its own speed; None = one of `_COUPLINGS`.
_ELEMENTS: tuple[tuple[str, str, float | None], ...] = (
    ("Motor shaft", "shaft", 250e6),
    ("LS coupling", "coupling", None),
    ("Gear shaft", "shaft", 300e6),
    ("Mesh", "gear mesh", 6e9),
    ("Pinion shaft", "shaft", 12e6),
    ("HS coupling", "coupling", None),
    ("LP shaft, drive end", "shaft", 9e6),
    ("LP shaft, far end", "shaft", 9e6),
    ("Intermediate coupling", "coupling", None),
    ("HP compressor shaft", "shaft", 7e6),
)
_COUPLINGS = {
    "proposed": {
        "LS coupling": 28946010.0,
        "HS coupling": 906463.4,
        "Intermediate coupling": 715754.3,
    },
    "modified": {
        "LS coupling": 24762330.0,
        "HS coupling": 299360.4,
        "Intermediate coupling": 350550.3,
    },
}

#: Stress diameter of the shafts. [in]
_DIAMETERS = {
    "Motor shaft": 10,
    "Gear shaft": 9.5,
    "Pinion shaft": 5.25,
    "LP shaft, drive end": 5,
    "LP shaft, far end": 3.75,
}
_SCF = 2
#: Rated torque, Peak torque limit, Vibratory limit and Reversal limit. [lbf in]
_LIMITS: Mapping[str, tuple[int, ...]] = {
    "LS coupling": (1050000, 2100000, 220000),
    "Mesh": (650000, 1550000, 130000, 220000),
    "HS coupling": (220000, 440000, 45000),
    "Intermediate coupling": (110000, 220000, 22000),
}

_SPEED = (0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98, 100)  # % of synchronous
_AVERAGE = (0.55, 0.56, 0.57, 0.59, 0.62, 0.66, 0.71, 0.78, 0.88, 0.92, 0.93, 0.8, 0.5, 0.0)
_PULSATING = (
    0.16, 0.16, 0.158, 0.156, 0.153, 0.15, 0.146, 0.139, 0.126, 0.12, 0.115, 0.112, 0.112, 0.12,
)  # fmt: skip
#: Of all machines, referred to motor speed, in pu of the rated torque.
_LOAD = (0.06, 0.02, 0.02, 0.03, 0.05, 0.07, 0.1, 0.13, 0.17, 0.19, 0.21, 0.23, 0.24, 0.25)
_LOAD_SHARE = {"LP comp": 0.6, "HP comp": 0.4}

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
        "Constructed",
        "The paper gives no mass-elastic data, torque curves, diameters or S-N data; those "
        "of this example are constructed: inertias, shaft and coupling stiffnesses so that "
        "changing only the three couplings reproduces Table 1 to six digits; torque curves; "
        "1.5 % modal damping; the 70.0 mm (2.756 in) stress diameter so that the proposed "
        "design gives 30,000 psi peak-to-peak; S-N line and SCF typical of a keyed "
        "alloy-steel shaft; pitch radii and pressure angle of the gear; stress diameters of the "
        "other shafts with SCF 2, yield strength, and limits of couplings and gear as a catalogue "
        "states them. All results of the modified design except its frequencies are therefore "
        "predictions.",
    ),
    (
        "Reference",
        "An independent prototype (linear, from rest to 97 % speed, HP compressor shaft) "
        "gives: proposed 29,990 psi peak-to-peak, modified 19,660 psi (the paper: 19,000); "
        "mesh torque -0.889 to 2.019 x rated with 15 reversals and -0.362 to 1.605 x rated "
        "with 6; allowable starts 448 and 14,830 (the paper: over 2,000); 97 % speed after "
        "8.06 s. Stress, mesh torque and time are accurate to about 1 %, allowable starts to "
        "about 10 % (S-N exponent 7.2). It reads the motor's curves at the rotor's own speed, and so do "
        "the designs of the paper here (TorqueFollows): the stress diameter was chosen that way. At the mean speed, "
        "the default, these shafts have 29,330 psi instead of 30,130, and 19,290 psi instead of 19,570.",
    ),
    (
        "Left blank",
        "Running loads are not given. Backlash, mesh "
        "damping, gear masses, bearings and field are blank in the two designs of the paper, "
        "whose results are for the linear train; the third example includes them. The mesh "
        "stiffness 6e9 N m/rad is torsional, on the bull gear.",
    ),
)

#: What the third example adds.
BACKLASH_PROVENANCE: tuple[tuple[str, str], ...] = (
    (
        "Added here",
        "Constructed, typical of such a train: 0.4 mm (0.0157 in) normal backlash; bearing "
        "stiffness 4e8 N/m (bull gear, 1,600 kg) and 3e8 N/m (pinion, 150 kg) with 10 % of "
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
        "constants times 50/60), rating and voltage constructed to suit the train. Discharge "
        "resistance 9 times that of the field; 0.4 mm (0.0157 in) normal backlash; field at 3 % "
        "slip. The short circuit is that of constant flux at no load, -sin(wt)/Xd'' + "
        "(1/Xd'' - 1/Xq'')/2 sin(2wt) in pu of apparent power, decaying with Ta. The dip to "
        "70 % voltage for 150 ms is calculated from the motor data.",
    ),
    (
        "Sections",
        "The drive end of the LP shaft is typed as on a drawing, constructed so that its stiffness is that of the modified design "
        "within 0.2 %; the inertia of its sections is taken off that of the LP compressor. The gear has 112 and 20 teeth: the "
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


def _shown(value: float, unit: float) -> float:
    """A number in a shown unit: ten digits give back far more than six of the frequencies."""
    return float(f"{value / unit:.10g}")


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
        "RatedTorque": _shown(_RATED_TORQUE, _LBF_FT),
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
        *(
            (name, text, _shown(inertia, _LB_FT2), ratio)
            for name, text, inertia, ratio in _STATIONS
        ),
    )


def _elements(design: str) -> list[dict[str, Value]]:
    names = [station[0] for station in _STATIONS]
    rows = _rows(
        ("Element", "Kind", "From", "To", "Stiffness"),
        *(
            (name, kind, *ends, _shown(stiffness or _COUPLINGS[design][name], _LBF_IN))
            for (name, kind, stiffness), ends in zip(_ELEMENTS, pairwise(names), strict=True)
        ),
    )
    headers = ("Rated torque", "Peak torque limit", "Vibratory limit", "Reversal limit")
    for row in rows:
        name = str(row["Element"])
        if name in _DIAMETERS:
            row |= {"Stress diameter": _DIAMETERS[name], "SCF": _SCF, "Material": _MATERIAL}
        row |= dict(zip(headers, _LIMITS.get(name, ()), strict=False))
    rows[-1] |= {"Stress diameter": _shown(0.07, _INCH), "SCF": 3, "Material": _MATERIAL}
    return rows


def _loads() -> list[dict[str, Value]]:
    return _rows(
        ("Station", "Speed", "Torque"),
        *(
            (station, speed, _shown(load * share * _RATED_TORQUE / _RATIO, _LBF_FT))
            for station, share in _LOAD_SHARE.items()
            for speed, load in zip(_SPEED, _LOAD, strict=True)
        ),
    )


#: Design whose numbers the third example shares, and its additions in SI.
_BACKLASH = "backlash"
_BACKLASH_SCALARS: dict[str, Value] = {
    "ShockAmplitude": 0.5,
    "ShockTimeConstant": 0.06,
    "FieldSlip": 3,
    "FieldTimeConstant": 0.5,
    "PullOutTorque": 2,
}
_BACKLASH_GEAR: dict[str, Value] = {
    "Backlash": _shown(4e-4, _INCH),
    "Mass drive": _shown(1600.0, _POUND),
    "Mass driven": _shown(150.0, _POUND),
    "Bearing stiffness drive": _shown(4e8, _LBF / _INCH),
    "Bearing stiffness driven": _shown(3e8, _LBF / _INCH),
    "Bearing damping drive": _shown(1.6e5, _LBF / _INCH),
    "Bearing damping driven": _shown(4.24e4, _LBF / _INCH),
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
    "Apparent power": 12600,
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
_LP_ROTOR = 433.5


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
            ("Mesh", _shown(0.42, _INCH), _shown(0.075, _INCH), 20),
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
        ("supply sags to 50 %", None, None, 50),
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
        ("HS coupling", "stiffness", "%", "20; 25; 33; 40; 50; 60; 80; 100"),
        ("Intermediate coupling", "stiffness", "%", "35; 49; 70; 100"),
    ),
    "Catalogue": _rows(
        ("Element", "Name", "Fitted", "Stiffness", "Inertia", "Loss factor", "Rated torque"),
        ("LS coupling", "as proposed", "yes", 2.56194e8, 85.0),
        ("LS coupling", "as modified", None, 2.19165e8, 85.0),
        ("LS coupling", "softer, 4 % loss factor", None, 1.5e8, 130.0, 0.04, 6.5e5),
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
    "StartConditions": _duty(78),
    **_measured(((29.4, 1), (54.1, 1), (120, 0.5)), 14900),
}

#: Where an example has others.
_OF_EXAMPLE: Mapping[str, Rows] = {
    "modified": {
        "StartConditions": _duty(85.5),
        **_measured(((20.7, 1), (39.6, 1), (68.1, 1)), 11500),
    }
}


def study_rows(example: str) -> Rows:
    """Rows of the study tables of an example."""
    return {**STUDY_ROWS, **_OF_EXAMPLE.get(example, {})}
