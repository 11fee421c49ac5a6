"""Each wrong input is found at its cell, with a sentence an engineer can act on; right ones pass."""

import math
from dataclasses import replace

import pytest
from sample_case import sample_case

from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.data import (
    CaseData,
    EffectChoiceRow,
    ElementRow,
    EventTorqueRow,
    ExcitationRow,
    LoadTorqueRow,
    MaterialRow,
    MeshRow,
    ModeDampingRow,
    MotorTorqueRow,
    SNPointRow,
    StationRow,
    SupplyVoltageRow,
    TorqueTimeRow,
)
from engine.errors import CaseError, TorsionError

NAN, INF = math.nan, math.inf
#: What field application needs.
FIELD = {"field_slip": 0.05, "pull_out_torque": 2e4}


def good(**changes):
    """A small geared train with everything filled in that may be."""
    fields = {
        "line_frequency": 60.0,
        "poles": 4,
        "rated_torque": 1e4,
        "damping_ratio": 0.015,
        "stations": (
            StationRow("motor", None, 100.0, 1.0),
            StationRow("gear", None, 40.0, 1.0),
            StationRow("pinion", None, 2.0, 4.0),
            StationRow("compressor", None, 5.0, 4.0, running_load=2500.0),
        ),
        "elements": (
            ElementRow("LS coupling", "coupling", "motor", "gear", 2e6, damping=50.0),
            ElementRow("mesh", "gear mesh", "gear", "pinion", 5e9),
            ElementRow(
                "HS shaft",
                "shaft",
                "pinion",
                "compressor",
                od=0.1,
                id=0.02,
                length=0.8,
                shear_modulus=8e10,
                density=7850.0,
                stress_diameter=0.1,
                scf=2.0,
                material="steel",
            ),
        ),
        "meshes": (
            MeshRow(
                "mesh",
                "external",
                0.8,
                0.2,
                pressure_angle=math.radians(20),
                helix_angle=math.radians(10),
                backlash=2e-4,
            ),
        ),
        "mode_damping": (ModeDampingRow(1, 0.02),),
        "motor_torque": (
            MotorTorqueRow("motor", 0.0, 8e3, 4e3),
            MotorTorqueRow("motor", 0.5, 9e3, 6e3),
            MotorTorqueRow("motor", 1.0, 5e3, 0.0),
        ),
        "load_torque": (
            LoadTorqueRow("compressor", 0.0, 100.0),
            LoadTorqueRow("compressor", 1.0, 900.0),
        ),
        "materials": (MaterialRow("steel", 760e6, 500e6, 130e6, "torsion", "none"),),
        "sn_points": (SNPointRow("steel", 1e3, 340e6), SNPointRow("steel", 1e6, 130e6)),
        "excitations": (ExcitationRow("1x", 1.0, "motor", None, "compressor", 10.0),),
        "effect_choices": (EffectChoiceRow("backlash", "auto"),),
    }
    return CaseData(**(fields | changes))


def row(table, number, **changes):
    """The good case with one row of one table changed; rows count from 1."""
    rows = list(getattr(good(), table))
    rows[number - 1] = replace(rows[number - 1], **changes)
    return good(**{table: tuple(rows)})


def more(table, *rows):
    return good(**{table: getattr(good(), table) + rows})


def event(**changes):
    """The good case with an event of one row."""
    fields = {
        "event": "fault",
        "station": "motor",
        "amplitude": -5.0,
        "multiple": 1.0,
        "time_constant": 0.1,
    }
    return good(event_torque=(EventTorqueRow(**(fields | changes)),))


def at_slip(*torques: float) -> Case:
    """The good case with a torque at slip frequency in each row of its torque curve."""
    rows = zip(good().motor_torque, torques, strict=True)
    return good(motor_torque=tuple(replace(point, pulsation_1=torque) for point, torque in rows))


def phases(*angles: float) -> Case:
    """The good case with a phase in each row of its torque curve."""
    rows = zip(good().motor_torque, angles, strict=True)
    return good(motor_torque=tuple(replace(point, phase=angle) for point, angle in rows))


def supply(*rows: tuple[str, float, float | None]) -> Case:
    return good(supply_voltage=tuple(SupplyVoltageRow(*row) for row in rows))


def places(problems):
    return [(p.table, p.row, p.column) for p in problems]


# --- right input ----------------------------------------------------------------------------------

RIGHT = {
    "everything filled": good(),
    "single station": CaseData(stations=(StationRow("a", None, 1.0),)),
    "blank ratio, blank scalars": CaseData(
        stations=(StationRow("a", None, 1.0), StationRow("b", None, 1.0)),
        elements=(ElementRow("s", "shaft", "a", "b", 1.0),),
    ),
    "stiffness 0 with damping": row("elements", 1, stiffness=0.0),
    "rigid mesh": good(
        meshes=(), elements=(good().elements[0], replace(good().elements[1], stiffness=None),
                             good().elements[2])
    ),
    "no inertia where the shaft brings its own": row("stations", 4, inertia=None),
    "fixed end without motor": good(
        motor_torque=(),
        elements=(*good().elements, ElementRow("end", "shaft", "compressor", "ground", 1e5)),
    ),
    "damper to ground beside a motor": more(
        "elements", ElementRow("brush", "spring to ground", "motor", None, 0.0, damping=1.0)
    ),
    "spring beside a damper": more(
        "elements", ElementRow("damper", "coupling", "gear", "motor", 0.0, damping=3.0)
    ),
    "geared coupling with clearance": more(
        "meshes", MeshRow("LS coupling", angular_backlash=0.002)
    ),
    "field and trip above EndSpeed": good(
        **FIELD, trip_speed=188.0, field_angle=0.0, effect_choices=(
            EffectChoiceRow("pull-in", "on"), EffectChoiceRow("aborted start", "on"),
            EffectChoiceRow("backlash", "on"), EffectChoiceRow("fast modes", "on"),
        ),
    ),
    "shock, trip and contact law": good(
        shock_amplitude=-1e4, shock_time_constant=0.05, trip_speed=182.8, contact_law="no adhesion",
        effect_choices=(EffectChoiceRow("breaker closing", "on"),),
    ),
    "speed and poles": good(line_frequency=None, synchronous_speed=188.5),
    "power and torque that agree": good(rated_power=1e4 * 60 * math.pi),
    "speed range": good(minimum_speed=150.0, maximum_speed=200.0),
    "constant load": good(load_torque=(LoadTorqueRow("compressor", 1.0, 900.0),)),
    "prescribed torque": more(
        "torque_time", TorqueTimeRow("motor", 0.0, 0.0), TorqueTimeRow("motor", 1.0, -5.0)
    ),
    "voltage against speed": more(
        "supply_voltage", SupplyVoltageRow("motor", 0.0, 0.75), SupplyVoltageRow("motor", 1.0, 1.0)
    ),
    "phase of the pulsation": phases(0.0, 1.0, -1.0),
    "event in operation": more(
        "event_torque", EventTorqueRow("fault", "motor", -5.0, 1.0, 1.0, 0.1),
        EventTorqueRow("fault", "compressor", 0.5),
    ),
    "prescribed torque of a running train": good(
        initial_state="running", torque_time=(TorqueTimeRow("motor", 0.0, 0.0), TorqueTimeRow("motor", 1.0, -5.0)),
    ),
    "two curves row by row in turn": more(
        "motor_torque", MotorTorqueRow("gear", 0.0, 1.0, 0.0), MotorTorqueRow("gear", 1.0, 1.0, 0.0)
    ),
    "repeated bearing data that agree": good(
        stations=(*good().stations, StationRow("idler", None, 1.0, 2.0)),
        elements=(*good().elements, ElementRow("mesh 2", "gear mesh", "gear", "idler", 1e9)),
        meshes=(replace(good().meshes[0], mass_drive=500.0, bearing_stiffness_drive=1e9),
                MeshRow("mesh 2", None, 0.8, 0.4, mass_drive=500.0)),
    ),
    "the sample, proposed": sample_case("proposed"),
    "the sample, modified": sample_case("modified"),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_input_has_no_problem(name):
    assert find_problems(RIGHT[name]) == ()


# --- wrong input: case, cell, words the sentence must contain -------------------------------------

SCALARS = [
    (good(line_frequency=-60.0), "LineFrequency", ["found -60 Hz", "positive"]),
    (good(line_frequency=NAN), "LineFrequency", ["found nan"]),
    (good(synchronous_speed=INF), "SynchronousSpeed", ["found inf"]),
    (good(synchronous_speed=-1.0), "SynchronousSpeed", ["positive"]),
    (
        good(synchronous_speed=125.66),
        "SynchronousSpeed",
        ["1199.96 rpm", "1800 rpm", "4 poles", "60"],
    ),
    (good(poles=5), "Poles", ["even number", "not pole pairs"]),
    (good(poles=0), "Poles", ["even number"]),
    (good(poles=4.5), "Poles", ["even number"]),
    (good(rated_power=3e6), "RatedTorque", ["10000 N m", "15915.5 N m", "1800 rpm"]),
    (good(rated_power=0.0), "RatedPower", ["positive"]),
    (good(rated_torque=-1.0), "RatedTorque", ["positive"]),
    (
        good(minimum_speed=200.0),
        "MinimumSpeed",
        ["at most MaximumSpeed", "MaximumSpeed 188.496 rad/s"],
    ),
    (good(maximum_speed=100.0), "MaximumSpeed", ["at least MinimumSpeed", "synchronous"]),
    (good(minimum_speed=190.0, maximum_speed=180.0), "MinimumSpeed", ["found 190 rad/s"]),
    (good(end_speed=200.0), "EndSpeed", ["at most synchronous speed", "97 %"]),
    (good(end_speed=0.0), "EndSpeed", ["positive"]),
    (good(maximum_time=-1.0), "MaximumTime", ["positive", "found -1 s"]),
    (good(damping_ratio=1.5), "DampingRatio", ["below 1 (100 %)", "1 % to 3 %"]),
    (good(damping_ratio=-0.1), "DampingRatio", ["at least 0"]),
    (good(margin_required=2.0), "MarginRequired", ["below 1"]),
    (good(margin_basis="guessed"), "MarginBasis", ["'guessed'", "calculated, measured"]),
    (good(stress_basis="rms"), "StressBasis", ["peak-to-peak, zero-to-peak"]),
    (good(method="euler"), "Method", ["exponential, newmark"]),
    (good(keep_history="csv"), "KeepHistory", ["parquet"]),
    (good(rainflow_residue="none"), "RainflowResidue", ["half cycles, repeated"]),
    (good(tolerance_peak=0.0), "TolerancePeak", ["between 2e-07 and 0.5"]),
    (
        good(tolerance_peak=1e-7),
        "TolerancePeak",
        ["found 1e-07", "blank for 0.1 %", "cannot be met"],
    ),
    (good(tolerance_starts=1e-6), "ToleranceStarts", ["between 1e-05 and 0.5"]),
    (good(tolerance_starts=0.9), "ToleranceStarts", ["between"]),
    (good(starts_required=0.0), "StartsRequired", ["positive"]),
    (good(starts_factor=-2.0), "StartsFactor", ["positive"]),
    (good(voltage=0.0), "Voltage", ["positive"]),
    (good(pulsation_phase=NAN), "PulsationPhase", ["finite number"]),
    (good(shock_amplitude=INF, shock_time_constant=0.1), "ShockAmplitude", ["finite number"]),
    (good(shock_amplitude=1e3, shock_time_constant=0.0), "ShockTimeConstant", ["positive"]),
    (good(field_slip=1.0, pull_out_torque=2e4), "FieldSlip", ["between 0 and 1"]),
    (good(**FIELD, pull_in_damping=-1.0), "PullInDamping", ["zero or positive"]),
    (good(trip_speed=-1.0), "TripSpeed", ["positive"]),
    (good(trip_speed=189.0), "TripSpeed", ["at most synchronous speed (188.496 rad/s)"]),
    (good(trip_speed=185.0), "TripSpeed", ["blank = 97 %", "182.841", "give FieldSlip"]),
    (good(trip_speed=120.0, end_speed=110.0), "TripSpeed", ["EndSpeed, 110 rad/s"]),
    (good(field_slip=0.0, pull_out_torque=2e4), "FieldSlip", ["between 0 and 1"]),
    (good(field_slip=0.05), "PullOutTorque", ["FieldSlip is given", "clear FieldSlip"]),
    (good(pull_out_torque=2e4), "FieldSlip", ["PullOutTorque is given", "clear PullOutTorque"]),
    (good(pull_in_damping=100.0), "FieldSlip", ["PullInDamping is given"]),
    (good(field_time_constant=0.5), "FieldSlip", ["FieldTimeConstant is given"]),
    (good(**FIELD, field_time_constant=0.0), "FieldTimeConstant", ["blank", "at once"]),
    (good(field_angle=0.5), "FieldSlip", ["FieldAngle is given"]),
    (good(shock_amplitude=1e3), "ShockTimeConstant", ["ShockAmplitude is given", "decay time"]),
    (good(shock_time_constant=0.1), "ShockAmplitude", ["clear ShockTimeConstant"]),
    (good(contact_law="sticky"), "ContactLaw", ["limited, no adhesion"]),
    (good(line_frequency=None, poles=None), "SynchronousSpeed", ["torque curves", "Type two"]),
    (
        good(line_frequency=None, poles=None, synchronous_speed=188.5),
        "LineFrequency",
        ["slip frequency", "Poles"],
    ),
]

S, E, M = "stations", "elements", "meshes"

ROWS = [
    # stations
    (good(stations=(), elements=(), meshes=(), motor_torque=(), load_torque=(), excitations=()),
     ("Stations", None, ""), ["at least one station"]),
    (row(S, 2, station=None), ("Stations", 2, "Station"), ["blank", "Name it"]),
    (more(S, StationRow("gear", None, 1.0)), ("Stations", 5, "Station"), ["'gear'", "row 2", "Rename"]),
    (more(S, StationRow("Ground", None, 1.0)), ("Stations", 5, "Station"), ["fixed end", "Rename"]),
    (row(S, 1, inertia=None), ("Stations", 1, "Inertia"), ["blank", "Density"]),
    (row(S, 1, inertia=0.0), ("Stations", 1, "Inertia"), ["found 0 kg m²", "positive", "massless"]),
    (row(S, 1, inertia=-3.0), ("Stations", 1, "Inertia"), ["found -3 kg m²"]),
    (row(S, 4, inertia=-3.0), ("Stations", 4, "Inertia"), ["zero or positive"]),
    (row(S, 1, inertia=NAN), ("Stations", 1, "Inertia"), ["found nan"]),
    (row(S, 2, speed_ratio=-4.0), ("Stations", 2, "Speed ratio"), ["found -4", "positive"]),
    (row(S, 2, speed_ratio=0.0), ("Stations", 2, "Speed ratio"), ["positive (blank = 1)"]),
    (row(S, 2, damping=-1.0), ("Stations", 2, "Damping"), ["zero or positive"]),
    (row(S, 4, running_load=INF), ("Stations", 4, "Running load"), ["finite"]),
    (more(S, StationRow("lost", None, 1.0)), ("Stations", 5, "Station"), ["'lost'", "Add the missing"]),
    (good(stations=tuple(replace(s, speed_ratio=2 * s.speed_ratio) for s in good().stations)),
     ("Stations", 1, "Speed ratio"), ["found 2", "'motor'", "motor shaft is the reference", "type 1"]),
    # elements
    (row(E, 1, element=None), ("Elements", 1, "Element"), ["blank"]),
    (row(E, 1, element="mesh"), ("Elements", 2, "Element"), ["row 1 has it"]),
    (row(E, 1, kind=None), ("Elements", 1, "Kind"), ["shaft, coupling, gear mesh"]),
    (row(E, 1, kind="belt"), ("Elements", 1, "Kind"), ["'belt'", "Choose from the list"]),
    (row(E, 1, from_=None), ("Elements", 1, "From"), ["blank"]),
    (row(E, 1, to=None), ("Elements", 1, "To"), ["blank"]),
    (row(E, 1, from_="moter"), ("Elements", 1, "From"), ["'moter'", "Did you mean 'motor'?"]),
    (row(E, 1, from_="Ground"), ("Elements", 1, "From"), ["Did you mean 'ground'?"]),
    (row(E, 1, to="zzz"), ("Elements", 1, "To"), ["'zzz'", "Correct the name, or add its row"]),
    (row(E, 1, to="motor"), ("Elements", 1, "To"), ["another station than From"]),
    (row(E, 1, to="pinion"), ("Elements", 1, "To"), ["speed ratio 1", "4", "gear mesh"]),
    (row(E, 2, from_="ground"), ("Elements", 2, "From"), ["A gear mesh joins two gears"]),
    (row(E, 1, kind="spring to ground"), ("Elements", 1, "To"), ["ground at one end"]),
    (row(E, 1, stiffness=-5.0), ("Elements", 1, "Stiffness"), ["found -5 N m/rad"]),
    (row(E, 1, stiffness=0.0, damping=None), ("Elements", 1, "Stiffness"), ["0 only where Damping"]),
    (row(E, 1, stiffness=None), ("Elements", 1, "Stiffness"), ["OD, Length, Shear modulus are blank"]),
    (row(E, 3, od=1e90), ("Elements", 3, "OD"), ["between 1e-6 and 1e6 m"]),
    (row(E, 3, od=None), ("Elements", 3, "Stiffness"), ["OD is blank"]),
    (row(E, 3, od=None, stiffness=1e5), ("Elements", 3, "Density"), ["OD or Length is blank"]),
    (row(E, 3, id=0.1), ("Elements", 3, "ID"), ["below the outer diameter 0.1 m"]),
    (row(E, 3, id=-0.1), ("Elements", 3, "ID"), ["zero or positive"]),
    (row(E, 3, length=0.0), ("Elements", 3, "Length"), ["positive"]),
    (row(E, 3, shear_modulus=-1.0), ("Elements", 3, "Shear modulus"), ["positive"]),
    (row(E, 3, density=-1.0), ("Elements", 3, "Density"), ["positive"]),
    (row(E, 3, stress_bore=0.2), ("Elements", 3, "Stress bore"), ["below the outer"]),
    (row(E, 3, stress_diameter=None), ("Elements", 3, "Stress diameter"), ["material is named"]),
    (row(E, 3, scf=0.5), ("Elements", 3, "SCF"), ["1 or more", "notch"]),
    (row(E, 3, material="stell"), ("Elements", 3, "Material"), ["Did you mean 'steel'?"]),
    (row(E, 1, damping=-1.0), ("Elements", 1, "Damping"), ["zero or positive"]),
    (row(E, 1, loss_factor=-1.0), ("Elements", 1, "Loss factor"), ["zero or positive"]),
    (row(E, 1, rated_torque=0.0), ("Elements", 1, "Rated torque"), ["positive"]),
    (row(E, 1, peak_torque_limit=-1.0), ("Elements", 1, "Peak torque limit"), ["positive"]),
    (row(E, 1, service_factor=0.8), ("Elements", 1, "Service factor"), ["1 or more"]),
    (row(E, 1, vibratory_limit=-1.0), ("Elements", 1, "Vibratory limit"), ["positive"]),
    (row(E, 1, reversal_limit=-1.0), ("Elements", 1, "Reversal limit"), ["zero or positive"]),
    (row(E, 2, od=0.3), ("Elements", 2, "OD"), ["blank for a gear mesh", "inertias"]),
    (row(E, 2, density=7850.0), ("Elements", 2, "Density"), ["blank for a gear mesh"]),
    (more(E, ElementRow("mesh 2", "gear mesh", "gear", "pinion")),
     ("Elements", 4, "Element"), ["'mesh 2' closes a circuit", "not calculated", "Combine"]),
    (more(E, ElementRow("tie", "gear mesh", "motor", "compressor")),
     ("Elements", 4, "Element"), ["'tie'", "'motor'", "'compressor'"]),
    (more(E, ElementRow("end", "shaft", "compressor", "ground", 1e5)),
     ("Elements", 4, "To"), ["'end' holds the train", "cannot start", "Stiffness 0"]),
    (more(E, ElementRow("end", "spring to ground", "compressor", None, 1e5)),
     ("Elements", 4, "To"), ["holds the train"]),
    # meshes
    (row(M, 1, element=None), ("Meshes", 1, "Element"), ["blank"]),
    (row(M, 1, element="mess"), ("Meshes", 1, "Element"), ["Did you mean 'mesh'?"]),
    (more(M, MeshRow("mesh")), ("Meshes", 2, "Element"), ["row 1 has it"]),
    (row(M, 1, element="HS shaft"), ("Meshes", 1, "Element"), ["is a shaft", "row 3"]),
    (row(M, 1, gear_type="worm"), ("Meshes", 1, "Gear type"), ["external or internal"]),
    (row(M, 1, pitch_radius_driven=0.21), ("Meshes", 1, "Pitch radius driven"),
     ["0.21 m", "3.80952", "make 4", "'gear', row 2", "'pinion', row 3", "0.1 %"]),
    (row(M, 1, teeth_drive=143, teeth_driven=29), ("Meshes", 1, "Pitch radius driven"),
     ["pitch radii give a speed ratio of 4, but Teeth drive and Teeth driven give 4.93103", "0.1 %"]),
    (row(M, 1, teeth_drive=143, teeth_driven=29, pitch_radius_driven=None), ("Meshes", 1, "Teeth driven"),
     ["found 29: with 143 teeth", "4.93103", "make 4", "'gear', row 2", "'pinion', row 3", "blank ones follow"]),
    (row(M, 1, speed_ratio=4.1), ("Meshes", 1, "Pitch radius driven"), ["4.1", "0.1 %"]),
    (row(M, 1, speed_ratio=4.1, pitch_radius_driven=None), ("Meshes", 1, "Speed ratio"),
     ["found 4.1", "make 4", "correct the cell"]),
    (row(M, 1, teeth_drive=143), ("Meshes", 1, "Teeth driven"), ["blank", "Teeth drive is given"]),
    (row(M, 1, teeth_drive=143, teeth_driven=0), ("Meshes", 1, "Teeth driven"), ["1 or more"]),
    (row(M, 1, teeth_drive=28.5, teeth_driven=7), ("Meshes", 1, "Teeth drive"), ["whole number"]),
    (row(M, 1, speed_ratio=-4.0), ("Meshes", 1, "Speed ratio"), ["positive"]),
    (more(M, MeshRow("LS coupling", speed_ratio=2.0)), ("Meshes", 2, "Speed ratio"), ["is a coupling"]),
    (row(M, 1, pitch_radius_drive=-0.8), ("Meshes", 1, "Pitch radius drive"), ["positive"]),
    (row(M, 1, pressure_angle=20.0), ("Meshes", 1, "Pressure angle"), ["0 to 90", "deg"]),
    (row(M, 1, helix_angle=NAN), ("Meshes", 1, "Helix angle"), ["finite number"]),
    (row(M, 1, orientation=INF), ("Meshes", 1, "Orientation"), ["finite"]),
    (row(M, 1, backlash=-1e-4), ("Meshes", 1, "Backlash"), ["zero or positive"]),
    (row(M, 1, angular_backlash=1e-3), ("Meshes", 1, "Angular backlash"), ["geared couplings"]),
    (row(M, 1, mesh_stiffness=1e9), ("Meshes", 1, "Mesh stiffness"), ["5e+09", "row 2", "Keep one"]),
    (row(M, 1, mass_drive=0.0), ("Meshes", 1, "Mass drive"), ["positive"]),
    (row(M, 1, bearing_stiffness_driven=-1.0), ("Meshes", 1, "Bearing stiffness driven"), []),
    (row(M, 1, bearing_damping_drive=-1.0), ("Meshes", 1, "Bearing damping drive"), []),
    (row(M, 1, pitch_radius_drive=None), ("Meshes", 1, "Pitch radius drive"), ["Backlash is 0.0002 m"]),
    (row(M, 1, pitch_radius_drive=None, backlash=None, mesh_damping=9.0),
     ("Meshes", 1, "Pitch radius drive"), ["Mesh damping is 9 N s/m", "Type the radius"]),
    (row(E, 2, stiffness=None), ("Meshes", 1, "Backlash"),
     ["rigid", "Stiffness of 'mesh' (table Elements, row 2)", "Mesh stiffness (table Meshes, row 1)"]),
    (more(M, MeshRow("LS coupling", backlash=1e-4)), ("Meshes", 2, "Backlash"), ["Angular backlash"]),
    (more(M, MeshRow("LS coupling", mesh_stiffness=1e9)), ("Meshes", 2, "Mesh stiffness"), []),
    # tables of numbers
    (more("mode_damping", ModeDampingRow(0, 0.1)), ("ModeDamping", 2, "Mode"), ["1 or more"]),
    (more("mode_damping", ModeDampingRow(2.5, 0.1)), ("ModeDamping", 2, "Mode"), ["whole number"]),
    (more("mode_damping", ModeDampingRow(1, 0.1)), ("ModeDamping", 2, "Mode"), ["row 1"]),
    (more("mode_damping", ModeDampingRow(None, 0.1)), ("ModeDamping", 2, "Mode"), ["blank"]),
    (more("mode_damping", ModeDampingRow(2, None)), ("ModeDamping", 2, "Damping ratio"), ["blank"]),
    (more("mode_damping", ModeDampingRow(2, 5.0)), ("ModeDamping", 2, "Damping ratio"), ["100 %"]),
    (row("motor_torque", 2, speed=0.0), ("MotorTorque", 2, "Speed"), ["above 0 of row 1", "rising"]),
    (row("motor_torque", 3, speed=0.5), ("MotorTorque", 3, "Speed"), ["above 0.5 of row 2"]),
    (row("motor_torque", 3, speed=100.0), ("MotorTorque", 3, "Speed"), ["at most 3 (300 %)", "50 %"]),
    (row("motor_torque", 1, speed=-0.1), ("MotorTorque", 1, "Speed"), ["zero or positive"]),
    (row("motor_torque", 1, speed=NAN), ("MotorTorque", 1, "Speed"), ["found nan"]),
    (row("motor_torque", 1, speed=None), ("MotorTorque", 1, "Speed"), ["blank"]),
    (row("motor_torque", 1, average=None), ("MotorTorque", 1, "Average"), ["blank"]),
    (row("motor_torque", 1, average=INF), ("MotorTorque", 1, "Average"), ["finite"]),
    (row("motor_torque", 1, pulsating=-1.0), ("MotorTorque", 1, "Pulsating"), ["zero or positive"]),
    (row("motor_torque", 1, pulsating=None), ("MotorTorque", 1, "Pulsating"), ["0 where there is none"]),
    (row("motor_torque", 2, phase=1.0), ("MotorTorque", 1, "Phase"), ["blank", "every row of 'motor', or in none"]),
    (phases(0.0, 0.5, 90.0), ("MotorTorque", 3, "Phase"), ["found 90 rad", "720 degrees", "typed as radians"]),
    (phases(0.0, 3.0, -3.0), ("MotorTorque", 3, "Phase"), ["within 180 degrees of 3 rad of row 2", "360 degrees"]),
    (phases(0.0, NAN, 0.0), ("MotorTorque", 2, "Phase"), ["found nan"]),
    (row("motor_torque", 2, pulsation_1=100.0), ("MotorTorque", 1, "Pulsation1"), ["blank", "every row of 'motor', or in none"]),
    (at_slip(100.0, -5.0, 0.0), ("MotorTorque", 2, "Pulsation1"), ["found -5 N m", "must be zero or positive"]),
    (more("motor_torque", MotorTorqueRow("gear", 0.0, 1.0, 1.0)),
     ("MotorTorque", 4, "Station"), ["one row only for 'gear'", "two points"]),
    (row("motor_torque", 1, station="moto"), ("MotorTorque", 1, "Station"), ["Did you mean 'motor'?"]),
    (row("motor_torque", 1, station=None), ("MotorTorque", 1, "Station"), ["blank"]),
    (row("load_torque", 2, speed=0.0), ("LoadTorque", 2, "Speed"), ["rising order"]),
    (row("load_torque", 2, speed=4.0), ("LoadTorque", 2, "Speed"), ["300 %"]),
    (row("load_torque", 2, torque=-5.0), ("LoadTorque", 2, "Torque"), ["opposes the motion"]),
    (row("load_torque", 2, torque=None), ("LoadTorque", 2, "Torque"), ["blank"]),
    (more("torque_time", TorqueTimeRow("motor", 0.0, 1.0)), ("TorqueTime", 1, "Station"), ["two points"]),
    (supply(("motor", 0.0, 75.0), ("motor", 1.0, 1.0)),
     ("SupplyVoltage", 1, "Voltage"), ["found 75", "at most 2", "Write 80 %"]),
    (supply(("motor", 0.5, 0.8), ("motor", 0.5, 0.9)), ("SupplyVoltage", 2, "Speed"), ["above 0.5"]),
    (supply(("motor", 0.5, 0.8)), ("SupplyVoltage", 1, "Station"), ["one row only"]),
    (supply(("motor", 0.0, 0.8), ("motor", 1.0, None)), ("SupplyVoltage", 2, "Voltage"), ["blank"]),
    (supply(("gear", 0.0, 0.8), ("gear", 1.0, 1.0)),
     ("SupplyVoltage", 1, "Station"), ["'gear'", "a station with a motor", "MotorData"]),
    (event(station="motr"), ("EventTorque", 1, "Station"), ["'motr'", "Did you mean 'motor'?"]),
    (event(station=None), ("EventTorque", 1, "Station"), ["blank", "a station of table Stations"]),
    (event(event=None), ("EventTorque", 1, "Event"), ["blank", "rows of one name add up"]),
    (event(base="MVA"), ("EventTorque", 1, "Base"), ["one of rated torque, apparent power"]),
    (event(base="apparent power"), ("EventTorque", 1, "Base"), ["row in table MotorData", "smaller than the apparent power"]),
    (event(amplitude=None), ("EventTorque", 1, "Amplitude"), ["blank", "over RatedTorque"]),
    (event(multiple=-1.0), ("EventTorque", 1, "Multiple"), ["found -1", "multiple of the line frequency"]),
    (event(time_constant=-0.1), ("EventTorque", 1, "Time constant"), ["found -0.1 s", "does not decay"]),
    (event(time_constant=0.0), ("EventTorque", 1, "Time constant"), ["positive"]),
    (event(phase=NAN), ("EventTorque", 1, "Phase"), ["found nan"]),
    (event(per_life=-1.0), ("EventTorque", 1, "Per life"), ["found -1", "the number of such events"]),
    (replace(event(), event_torque=2 * event(per_life=1.0).event_torque),
     ("EventTorque", 2, "Per life"), ["row 1 has it already", "Clear one of the two cells"]),
    (replace(event(), rated_torque=None), ("Case", None, "RatedTorque"), ["blank", "Amplitude is a share of it"]),
    (replace(event(), line_frequency=None, poles=None, synchronous_speed=188.5, motor_torque=(), load_torque=()),
     ("Case", None, "LineFrequency"), ["blank", "Multiple is a multiple of it"]),
    (good(initial_state="turning"), ("Case", None, "InitialState"), ["'turning'", "rest, running"]),
    (replace(event(event="TorqueTime"), initial_state="running",
             torque_time=(TorqueTimeRow("motor", 0.0, 0.0), TorqueTimeRow("motor", 1.0, 1.0))),
     ("EventTorque", 1, "Event"), ["Rename the event"]),
    (replace(event(), motor_torque=(), elements=(*good().elements, ElementRow("end", "shaft", "compressor",
                                                                              "ground", 1e5))),
     ("Elements", 4, "To"), ["does not run"]),
    (more("torque_time", TorqueTimeRow("motor", 1.0, 1.0), TorqueTimeRow("motor", 1.0, 2.0)),
     ("TorqueTime", 2, "Time"), ["above 1 of row 1"]),
    (row("materials", 1, uts=-1.0), ("Materials", 1, "UTS"), ["positive"]),
    (row("materials", 1, yield_=900e6), ("Materials", 1, "Yield"), ["at most UTS"]),
    (row("materials", 1, basis="tension"), ("Materials", 1, "Basis"), ["torsion or bending"]),
    (row("materials", 1, below_endurance="?"), ("Materials", 1, "Below endurance"), ["2k-1"]),
    (row("materials", 1, endurance=200e6), ("Materials", 1, "Endurance"), ["lowest S-N stress"]),
    (more("materials", MaterialRow("steel")), ("Materials", 2, "Material"), ["row 1"]),
    (row("sn_points", 2, stress=340e6), ("SNPoints", 2, "Stress"), ["must fall", "'steel'"]),
    (row("sn_points", 2, cycles=1e2), ("SNPoints", 2, "Cycles"), ["few cycles to many"]),
    (row("sn_points", 2, stress=None), ("SNPoints", 2, "Stress"), ["blank"]),
    (row("sn_points", 2, cycles=-1.0), ("SNPoints", 2, "Cycles"), ["positive"]),
    (row("sn_points", 2, material="iron"), ("SNPoints", 2, "Material"), ["table Materials"]),
    (row("sn_points", 2, material=None), ("SNPoints", 2, "Material"), ["blank"]),
    (good(sn_points=good().sn_points[1:]), ("SNPoints", 1, "Material"), ["one S-N point only"]),
    (row("excitations", 1, order=None), ("Excitations", 1, "Order"), ["either an Order"]),
    (row("excitations", 1, frequency=60.0), ("Excitations", 1, "Order"), ["exactly one"]),
    (row("excitations", 1, order=-1.0), ("Excitations", 1, "Order"), ["positive"]),
    (row("excitations", 1, torque=0.0), ("Excitations", 1, "Torque"), ["positive"]),
    (row("excitations", 1, torque_share=0.1), ("Excitations", 1, "Torque"), ["both 10 N m", "Keep one"]),
    (row("excitations", 1, of_station="x"), ("Excitations", 1, "Of station"), ["table Stations"]),
    (row("excitations", 1, station="x"), ("Excitations", 1, "Station"), ["table Stations"]),
    (row("excitations", 1, name=None), ("Excitations", 1, "Name"), ["blank"]),
    (row("effect_choices", 1, choice="maybe"), ("EffectChoices", 1, "Choice"), ["auto, on or off"]),
    (row("effect_choices", 1, effect="pullin"), ("EffectChoices", 1, "Effect"),
     ["resonance sweep", "Did you mean 'pull-in'?"]),
    (row("effect_choices", 1, effect=None), ("EffectChoices", 1, "Effect"), ["Name it"]),
    (more("effect_choices", EffectChoiceRow("backlash", "on")), ("EffectChoices", 2, "Effect"),
     ["row 1 has it already"]),
    *(
        (more("effect_choices", EffectChoiceRow(effect, "on")), ("EffectChoices", 2, "Choice"),
         [cell, "nothing to simulate"])
        for effect, cell in (
            ("pull-in", "FieldSlip"), ("breaker closing", "ShockAmplitude"),
            ("aborted start", "TripSpeed"), ("bearings", "bearing stiffness"),
        )
    ),
    (good(meshes=(), effect_choices=(EffectChoiceRow("backlash", "on"),)),
     ("EffectChoices", 1, "Choice"), ["Backlash", "Angular backlash"]),
]  # fmt: skip

WRONG = [(case, ("Case", None, name), words) for case, name, words in SCALARS] + ROWS


def identity(wrong):
    _, (table, number, column), _ = wrong
    return f"{table}-{number}-{column}"


@pytest.mark.parametrize("wrong", WRONG, ids=identity)
def test_wrong_input_is_found_at_its_cell(wrong):
    case, place, words = wrong
    problems = find_problems(case)
    assert place in places(problems)
    message = problems[places(problems).index(place)].message
    for word in words:
        assert word in message
    assert message.endswith((".", "?"))
    assert "None" not in message


#: Wrong cells that make others wrong too: the others may be reported beside them.
CONSEQUENCES = {
    ("Stations", 2, "Station"),
    ("Stations", 2, "Speed ratio"),
    ("Elements", 3, "Stiffness"),
    ("SNPoints", 2, "Material"),
}


@pytest.mark.parametrize("wrong", WRONG, ids=identity)
def test_one_mistake_is_reported_once(wrong):
    case, place, _ = wrong
    found = places(find_problems(case))
    assert len(found) == len(set(found))
    if place not in CONSEQUENCES:
        assert found == [place]


#: A name misspelt where it is given, where it is used first, and how often it is used beside.
MISSPELT = [
    (row(S, 1, station="moter"), ("Elements", 1, "From"), ["MotorTorque (3), Excitations (1)", "table Stations"]),
    (row(S, 4, station="compresor"), ("Elements", 3, "To"), ["LoadTorque (2), Excitations (1)", "table Stations"]),
    (row("materials", 1, material="stel"), ("Elements", 3, "Material"), ["SNPoints (2)", "table Materials"]),
]  # fmt: skip


@pytest.mark.parametrize(("case", "place", "words"), MISSPELT)
def test_a_missing_name_is_one_problem_however_often_it_is_used(case, place, words):
    [problem] = find_problems(case)
    assert places([problem]) == [place]
    for word in ("Did you mean", *words):
        assert word in problem.message


# --- many at once ---------------------------------------------------------------------------------


def several():
    return replace(
        row(S, 1, inertia=-1.0),
        poles=3,
        damping_ratio=7.0,
        elements=(
            replace(good().elements[0], stiffness=-2.0, scf=0.1),
            *good().elements[1:],
        ),
        sn_points=(SNPointRow("steel", 1e6, 1e8), SNPointRow("steel", 1e3, 3e8)),
        effect_choices=(EffectChoiceRow("backlash", "y"),),
    )


SEVERAL = [
    ("Case", None, "DampingRatio"),
    ("Case", None, "Poles"),
    ("Stations", 1, "Inertia"),
    ("Elements", 1, "Stiffness"),
    ("Elements", 1, "SCF"),
    ("SNPoints", 2, "Cycles"),
    ("EffectChoices", 1, "Choice"),
]


def test_all_mistakes_are_reported_in_the_order_of_the_tables():
    found = places(find_problems(several()))
    assert sorted(map(str, found)) == sorted(map(str, SEVERAL))
    tables = [table for table, _, _ in found]
    order = ["Case", "Stations", "Elements", "SNPoints", "EffectChoices"]
    assert tables == sorted(tables, key=order.index)


def test_a_case_cannot_be_made_of_them():
    with pytest.raises(CaseError) as caught:
        Case(**vars(several()))
    assert isinstance(caught.value, TorsionError)
    assert len(caught.value.problems) == len(SEVERAL)
    for problem in caught.value.problems:
        assert problem.message in str(caught.value)


@pytest.mark.parametrize("cell", SEVERAL)
def test_cells_the_reader_complained_about_are_not_reported_again(cell):
    problems = find_problems(several(), frozenset({cell}))
    assert cell not in places(problems)
    assert len(problems) >= len(SEVERAL) - 1


def test_connections_are_judged_only_when_the_train_could_be_read():
    """A From that could not be read is one problem of the reader, not a lost station."""
    data = row(E, 1, from_=None)
    assert find_problems(data, frozenset({("Elements", 1, "From")})) == ()


def test_a_circuit_and_a_lost_part_are_told_together():
    data = good(
        stations=(*good().stations, StationRow("lost", None, 1.0), StationRow("pump", None, 1.0)),
        elements=(
            *good().elements,
            ElementRow("mesh 2", "gear mesh", "gear", "pinion"),
            ElementRow("apart", "shaft", "lost", "pump", 1e5),
        ),
    )
    problems = find_problems(data)
    assert places(problems) == [("Stations", 5, "Station"), ("Elements", 4, "Element")]
    assert "'lost', 'pump'" in problems[0].message


def test_a_gear_in_several_meshes_is_one_body():
    fields = {
        "stations": (*good().stations, StationRow("bull", None, 9.0, 0.5)),
        "elements": (*good().elements, ElementRow("mesh 2", "gear mesh", "bull", "gear", 1e9)),
    }
    first = replace(good().meshes[0], mass_drive=500.0, bearing_stiffness_drive=1e9)
    mesh = MeshRow("mesh 2", None, 1.6, 0.8, mass_driven=501.0)
    (problem,) = find_problems(good(**fields, meshes=(first, mesh)))
    assert (problem.table, problem.row, problem.column) == ("Meshes", 2, "Mass driven")
    for word in ("501", "500 kg as in row 1, Mass drive", "'gear'", "one body"):
        assert word in problem.message


def test_mesh_damping_needs_a_stiffness():
    elements = (good().elements[0], replace(good().elements[1], stiffness=None), good().elements[2])
    meshes = (MeshRow("mesh", None, 0.8, 0.2, mesh_damping=10.0),)
    (problem,) = find_problems(good(elements=elements, meshes=meshes))
    assert (problem.table, problem.row, problem.column) == ("Meshes", 1, "Mesh damping")
    assert "rigid" in problem.message


def test_pitch_radii_may_differ_from_the_ratio_by_a_thousandth():
    assert find_problems(row(M, 1, pitch_radius_driven=0.2 * 1.0009)) == ()
    assert find_problems(row(M, 1, pitch_radius_driven=0.2 * 1.0012)) != ()


@pytest.mark.parametrize("radii", [(0.4, 0.4), (0.4, 0.4003), (0.4, None)])
def test_an_internal_mesh_of_two_equal_gears_is_refused(radii):
    case = good(meshes=(MeshRow("mesh", "internal", *radii),))
    equal = tuple(replace(s, speed_ratio=1.0) for s in case.stations)
    (problem,) = find_problems(replace(case, stations=equal))
    assert (problem.table, problem.row, problem.column) == ("Meshes", 1, "Gear type")
    assert "ring" in problem.message
    assert "0.4 m" in problem.message
    outside = tuple(replace(m, gear_type="external") for m in case.meshes)
    assert find_problems(replace(case, stations=equal, meshes=outside)) == ()
    # a sense of rotation without sizes, and 4 : 1 with radii that agree
    plain = (MeshRow("mesh", "internal"),)
    assert find_problems(replace(case, stations=equal, meshes=plain)) == ()
    right = MeshRow("mesh", "internal", 0.8, 0.2)
    assert find_problems(replace(case, meshes=(right,))) == ()


def test_backlash_forced_on_with_a_gap_of_zero_is_told_that_it_is_zero():
    choice = (EffectChoiceRow("backlash", "on"),)
    case = replace(good(), effect_choices=choice)
    tight = tuple(replace(m, backlash=0.0) for m in case.meshes)
    (problem,) = find_problems(replace(case, meshes=tight))
    assert "blank or 0" in problem.message


def test_contradicting_ratings_name_what_would_agree():
    (problem,) = find_problems(good(synchronous_speed=120.0))
    assert problem.allowed == "1800 rpm with 4 poles at 60 Hz"
    # Without poles the nearest synchronous speed is named.
    (problem,) = find_problems(good(poles=None, synchronous_speed=120.0))
    assert "1200 rpm" in problem.message


@pytest.mark.parametrize(
    ("poles", "ratio", "pairs"),
    [(4, 2.0, None), (12, 3.0, None), (4, 0.5, None), (4, 1.7, "1.176"), (4, 3.0, "0.6667"),
     (4, 2.0010, None), (4, 2.01, "0.995")],
)  # fmt: skip
def test_a_second_motor_has_whole_pole_pairs_at_its_own_speed(poles, ratio, pairs):
    """C8: 1800 rpm × 1.7 = 3060 rpm at 60 Hz."""
    stations = (StationRow("M", None, 10.0), StationRow("L", None, 10.0, ratio))
    rows = tuple(
        MotorTorqueRow(name, x, 100.0, 10.0) for name in ("M", "L") for x in (0.0, 0.5, 1.0)
    )
    elements = (ElementRow("gears", "gear mesh", "M", "L", 1e6),)
    case = CaseData(
        stations=stations, elements=elements, motor_torque=rows, line_frequency=60.0, poles=poles
    )
    found = [p for p in find_problems(case) if "pole pairs" in p.message]
    assert len(found) == (pairs is not None)
    for problem in found:
        assert (problem.table, problem.row, problem.column) == ("Stations", 2, "Speed ratio")
        assert f"would have {pairs} pole pairs" in problem.message


@pytest.mark.parametrize("value", [NAN, INF, -INF, -1.0, 0.0])
def test_no_number_breaks_the_checks(value):
    """Impossible ratings are reported, never raised."""
    for key in ("line_frequency", "synchronous_speed", "rated_power", "rated_torque"):
        assert find_problems(good(**{key: value})) != ()


def test_an_empty_workbook_has_one_problem():
    (problem,) = find_problems(CaseData())
    assert (problem.table, problem.row, problem.column) == ("Stations", None, "")
