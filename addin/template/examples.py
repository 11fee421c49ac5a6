"""The filled examples: the sample case of Szenasi and von Nimitz (1978), US customary units.

The paper publishes the results of this train but not its data. What stands here was constructed
so that the published natural frequencies come out to six digits by changing the three couplings
alone; `PROVENANCE` says which number is which and is printed in all examples. The third example
is the proposed design with what the paper describes in words: clearance, bearings, pull-in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from addin.contract import tables as fields
from addin.contract.shown_units import ShownUnits
from addin.contract.sources import PAPER, PAPER_TITLE
from addin.contract.units import parse_unit
from engine.case.data import TABLES, CaseData

Value = float | int | str

#: SI value of one unit shown by the examples. Exact by definition of inch, pound and g.
_INCH, _POUND, _LBF = 0.0254, 0.45359237, 4.4482216152605
_LB_FT2 = _POUND * (12.0 * _INCH) ** 2
_LBF_IN = _LBF * _INCH
_LBF_FT = 12.0 * _LBF_IN

#: Station: inertia in kg m², at its own speed.
_MOTOR_SPEED = {"Motor": 460.76, "LS hub M": 6.0, "LS hub G": 6.0, "Bull gear": 167.83}
_PINION_SPEED = {
    "Pinion": 0.6835,
    "HS hub P": 0.15,
    "HS hub C": 0.15,
    "LP comp": 18.631,
    "IC hub L": 0.12,
    "IC hub H": 0.12,
    "HP comp": 8.3399,
}
_DESCRIPTIONS = {
    "Motor": "Motor rotor",
    "LS hub M": "LS coupling, motor half",
    "LS hub G": "LS coupling, gear half",
    "Bull gear": "Bull gear",
    "Pinion": "Pinion",
    "HS hub P": "HS coupling, pinion half",
    "HS hub C": "HS coupling, LP half",
    "LP comp": "LP compressor rotor",
    "IC hub L": "IC coupling, LP half",
    "IC hub H": "IC coupling, HP half",
    "HP comp": "HP compressor rotor",
}
_RATIO = 5.6
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
        f"{PAPER_TITLE}, Southwest Research Institute, 1978: the sample case, Table 1 and Figures 5 to 8.",
    ),
    (
        "Published",
        "Table 1 (30, 53 and 86 Hz proposed; 21, 39 and 69 Hz modified) with its column of % "
        "speed; 30,000 psi peak-to-peak proposed against 19,000 psi installed in the HP compressor "
        "shaft when the first mode is excited; more than 2,000 allowable starts installed; only "
        "couplings changed; torque reversal at the gear in the proposed design and a small amount "
        "of backlash for a few cycles as installed.",
    ),
    (
        "Constructed",
        "The paper prints no mass-elastic data, torque curves, diameters or S-N data. Those of "
        "this example are constructed: inertias, shaft and coupling stiffnesses so that Table 1 "
        "is reproduced to six digits by changing the three couplings alone; torque curves; 1.5 % "
        "modal damping; the 70.0 mm (2.756 in) stress diameter so that the proposed design gives "
        "30,000 psi peak-to-peak; S-N line and SCF typical of a keyed alloy-steel shaft; pitch "
        "radii and pressure angle of the gear. Everything about the modified design is then a "
        "prediction.",
    ),
    (
        "Reference",
        "An independent prototype (linear, from rest to 97 % speed, HP compressor shaft) gives: "
        "proposed 29,990 psi peak-to-peak, modified 19,660 psi (the paper: 19,000); mesh torque "
        "-0.889 to 2.019 x rated with 15 reversals and -0.362 to 1.605 x rated with 6; allowable "
        "starts 448 and 14,830 (the paper: over 2,000); 97 % speed after 8.06 s. Stress, mesh "
        "torque and time are 1 %-class figures, starts 10 %-class (the S-N exponent is 7.2).",
    ),
    (
        "Left blank",
        "Yield strength, running loads and the makers' limits are not given. Backlash, mesh "
        "damping, gear masses, bearings and the field are left blank in the two designs of the "
        "paper, whose figures are of the linear train; the third example has them. The mesh "
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


@dataclass(frozen=True)
class Example:
    """A filled workbook, in the units it shows."""

    scalars: Mapping[str, Value]  #: By defined name. [shown units]
    units: Mapping[tuple[str, str], str]  #: Units other than those of the blank template. [units]
    #: Rows of the input tables, by header. [shown units]
    tables: Mapping[str, Sequence[Mapping[str, Value]]]
    #: Units of scalars other than those of the blank template. [units]
    scalar_units: Mapping[str, str] = field(default_factory=dict)


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
        "StartsRequired": 2000,
    }


def _stations() -> list[dict[str, Value]]:
    speeds = [(name, inertia, 1.0) for name, inertia in _MOTOR_SPEED.items()]
    speeds += [(name, inertia, _RATIO) for name, inertia in _PINION_SPEED.items()]
    return [
        {
            "Station": name,
            "Description": _DESCRIPTIONS[name],
            "Inertia": _shown(inertia, _LB_FT2),
            "Speed ratio": ratio,
        }
        for name, inertia, ratio in speeds
    ]


def _elements(design: str) -> list[dict[str, Value]]:
    stations = [*_MOTOR_SPEED, *_PINION_SPEED]
    rows: list[dict[str, Value]] = []
    for (name, kind, stiffness), ends in zip(
        _ELEMENTS, zip(stations, stations[1:], strict=False), strict=True
    ):
        value = _COUPLINGS[design][name] if stiffness is None else stiffness
        rows.append(
            {
                "Element": name,
                "Kind": kind,
                "From": ends[0],
                "To": ends[1],
                "Stiffness": _shown(value, _LBF_IN),
            }
        )
    rows[-1] |= {"Stress diameter": _shown(0.07, _INCH), "SCF": 3, "Material": _MATERIAL}
    return rows


def _loads() -> list[dict[str, Value]]:
    return [
        {
            "Station": station,
            "Speed": speed,
            "Torque": _shown(load * share * _RATED_TORQUE / _RATIO, _LBF_FT),
        }
        for station, share in _LOAD_SHARE.items()
        for speed, load in zip(_SPEED, _LOAD, strict=True)
    ]


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
    )


def _example(design: str) -> Example:
    motor = zip(_SPEED, _AVERAGE, _PULSATING, strict=True)
    tables: dict[str, Sequence[Mapping[str, Value]]] = {
        "Stations": _stations(),
        "Elements": _elements(design),
        "Meshes": [
            {
                "Element": "Mesh",
                "Pitch radius drive": _shown(0.42, _INCH),
                "Pitch radius driven": _shown(0.075, _INCH),
                "Pressure angle": 20,
            }
        ],
        "MotorTorque": [
            {"Station": "Motor", "Speed": speed, "Average": average, "Pulsating": pulsating}
            for speed, average, pulsating in motor
        ],
        "LoadTorque": _loads(),
        "Materials": [
            {"Material": _MATERIAL, "UTS": 110000, "Endurance": 19000, "Basis": "torsion",
             "Below endurance": "none"}
        ],
        "SNPoints": [
            {"Material": _MATERIAL, "Cycles": cycles, "Stress": stress}
            for cycles, stress in ((1000, 49500), (1000000, 19000))
        ],
    }  # fmt: skip
    units = {("MotorTorque", "Average"): "pu", ("MotorTorque", "Pulsating"): "pu"}
    return Example(_scalars(design), units, tables)


#: Examples by name.
EXAMPLES: Mapping[str, Example] = {
    **{design: _example(design) for design in _COUPLINGS},
    _BACKLASH: _backlash_example(),
}


def provenance_of(name: str) -> tuple[tuple[str, str], ...]:
    """Where the numbers of an example come from: term and text."""
    return (*PROVENANCE, *(BACKLASH_PROVENANCE if name == _BACKLASH else ()))


def example_torque(example: Example) -> float | None:
    """Rated torque of an example. [N m]"""
    return _scalar_si(example, fields.scalar("RatedTorque"))


def _scalar_si(example: Example, field: fields.Field) -> float | None:
    value = example.scalars.get(field.name)
    if value is None or not field.is_number:
        return None
    if not field.has_unit:
        return float(value)
    unit = example.scalar_units.get(field.name, field.unit_us)
    return parse_unit(unit, field.dimension).to_si(float(value))


def example_case(example: Example, units: ShownUnits) -> CaseData:
    """An example as the engine sees it, for the drawings that need no calculation.

    Parameters
    ----------
    example : Example
        The example, in shown units.
    units : ShownUnits
        Units above its columns.

    Returns
    -------
    CaseData
        Tables, ratings and speeds. [SI]
    """
    ratings = ("LineFrequency", "SynchronousSpeed", "RatedTorque", "StartsRequired")
    values: dict[str, object] = {
        fields.scalar(name).attribute: _scalar_si(example, fields.scalar(name)) for name in ratings
    }
    for spec in fields.INPUT_TABLES:
        attribute, row_class = TABLES[spec.name]
        values[attribute] = tuple(
            row_class(
                **{
                    field.attribute: _cell_si(row[field.name], spec.name, field, units)
                    for field in spec.columns
                    if field.name in row
                }
            )
            for row in example.tables.get(spec.name, ())
        )
    return CaseData(**values)  # type: ignore[arg-type]


def _cell_si(value: Value, table: str, field: fields.Field, units: ShownUnits) -> Value:
    if isinstance(value, str):
        return value
    return value * units.factor(table, field.name)


# --- studies: what an engineer would ask of the sample case ---------------------------------------

Rows = Mapping[str, Sequence[Mapping[str, Value]]]


def _duty(behind_mode_1: float) -> Sequence[Mapping[str, Value]]:
    """A year of starts, and those so far; speed just past the crossing of mode 1. [%]"""
    return (
        {"Condition": "normal start", "Per year": 24, "So far": 60},
        {"Condition": "weak supply", "Voltage": 80, "Per year": 6, "So far": 12},
        {"Condition": "strong supply", "Voltage": 105, "Per year": 6, "So far": 12},
        {"Condition": "by-passed", "Load": 0, "Per year": 12, "So far": 20},
        {"Condition": "hot restart", "Damping ratio": 1.2, "Per year": 4, "So far": 8},
        {
            "Condition": "trip behind mode 1",
            "Trip speed": behind_mode_1,
            "Per year": 0.5,
            "So far": 1,
        },
        {"Condition": "supply sags to 50 %", "Voltage": 50},
    )


#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Rows = {
    "Tuning": (
        {
            "Element": "HS coupling",
            "Quantity": "stiffness",
            "Unit": "%",
            "Values": "20; 25; 33; 40; 50; 60; 80; 100",
        },
        {
            "Element": "Intermediate coupling",
            "Quantity": "stiffness",
            "Unit": "%",
            "Values": "35; 49; 70; 100",
        },
    ),
    "Catalogue": (
        {
            "Element": "LS coupling",
            "Name": "as proposed",
            "Fitted": "yes",
            "Stiffness": 2.56194e8,
            "Inertia": 85.0,
        },
        {"Element": "LS coupling", "Name": "as modified", "Stiffness": 2.19165e8, "Inertia": 85.0},
        {
            "Element": "LS coupling",
            "Name": "softer, 4 % loss factor",
            "Stiffness": 1.5e8,
            "Inertia": 130.0,
            "Loss factor": 0.04,
            "Rated torque": 6.5e5,
        },
    ),
    "Scatter": (
        {"Quantity": "stiffness", "Distribution": "normal", "Spread": 5.0},
        {"Quantity": "inertia", "Distribution": "normal", "Spread": 2.0},
        {"Quantity": "damping ratio", "Distribution": "uniform", "Spread": 30.0},
        {"Quantity": "average torque", "Distribution": "normal", "Spread": 5.0},
        {"Quantity": "pulsating torque", "Distribution": "triangular", "Spread": 10.0},
        {
            "Quantity": "load torque",
            "Distribution": "normal",
            "Spread": 5.0,
            "Together": "together",
        },
        {"Quantity": "S-N line", "Distribution": "from-to", "From": 90.0, "To": 110.0},
    ),
    "StartConditions": _duty(78),
    "MeasuredFrequencies": (
        {"Frequency": 29.4, "Uncertainty": 1},
        {"Frequency": 54.1, "Uncertainty": 1},
        {"Frequency": 120, "Uncertainty": 0.5},
    ),
    "MeasuredPeaks": ({"Element": "HS coupling", "Maximum torque": 14900, "Uncertainty": 5},),
}

#: Where an example has others.
_OF_EXAMPLE: Mapping[str, Rows] = {
    "modified": {
        "StartConditions": _duty(85.5),
        "MeasuredFrequencies": (
            {"Frequency": 20.7, "Uncertainty": 1},
            {"Frequency": 39.6, "Uncertainty": 1},
            {"Frequency": 68.1, "Uncertainty": 1},
        ),
        "MeasuredPeaks": ({"Element": "HS coupling", "Maximum torque": 11500, "Uncertainty": 5},),
    }
}


def study_rows(example: str) -> Rows:
    """Rows of the study tables of an example."""
    return {**STUDY_ROWS, **_OF_EXAMPLE.get(example, {})}
