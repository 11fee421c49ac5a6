"""Where results come from: papers and standards cited, equations and inputs that many columns share."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.field import Trace

#: The paper the product implements; its sections, equations and figures are cited below.
PAPER = (
    "Szenasi & von Nimitz, Transient analyses of synchronous motor trains, 7th Turbomachinery "
    "Symposium (1978)"
)

STEADY = "Szenasi & von Nimitz 1978, Steady state torsional analysis"
TRANSIENT = "Szenasi & von Nimitz 1978, Transient torsional analyses"
SLIP = f"{TRANSIENT}, equation of the pulsation frequency"
REVERSALS = "Szenasi & von Nimitz 1978, Torque reversals"
PHILOSOPHY = "Szenasi & von Nimitz 1978, Philosophy of resonant response location"
CRITERION = "Szenasi & von Nimitz 1978, Stress criterion"
FIGURE_3 = f"{CRITERION}, Figure 3"
MIL = "Mil-Std-167, as cited in Szenasi & von Nimitz 1978, Steady state torsional analysis"
SVD = "Demmel et al., Linear Algebra Appl. 299 (1999) 21; docs/method.md, Natural frequencies"
EXPONENTIAL = (
    "Szenasi & von Nimitz 1978, eq. (1); exact step: Hochbruck & Ostermann, Acta Numerica 19 (2010) "
    "209; Newmark: eqs (2) to (4)"
)
CLEARANCE = (
    "Szenasi & von Nimitz 1978, Analysis of torque reversals, Figure 4; contact law: Modelica "
    "Standard Library 4.0, ElastoBacklash; Hunt & Crossley, J. Applied Mechanics 42 (1975) 440"
)
STRENGTH = "Timoshenko, Strength of Materials, torsion of a circular shaft"
ASTM = "ASTM E1049-85, rainflow counting; Miner, J. Applied Mechanics 12 (1945) A-159"
NAME = "Name, as typed"
LABEL = "docs/nomenclature.md"

# --- what they are calculated from ----------------------------------------------------------------

TRAIN = (
    "Stations.Inertia",
    "Stations.Speed ratio",
    "Elements.Kind",
    "Elements.From",
    "Elements.To",
    "Elements.Stiffness",
    "Elements.OD",
    "Elements.ID",
    "Elements.Length",
    "Elements.Shear modulus",
    "Elements.Density",
)
LATERAL = (
    "Meshes.Pitch radius drive",
    "Meshes.Pitch radius driven",
    "Meshes.Pressure angle",
    "Meshes.Helix angle",
    "Meshes.Orientation",
    "Meshes.Mesh stiffness",
    "Meshes.Mass drive",
    "Meshes.Mass driven",
    "Meshes.Bearing stiffness drive",
    "Meshes.Bearing stiffness driven",
)
DAMPING = (
    "DampingRatio",
    "ModeDamping.Damping ratio",
    "Stations.Damping",
    "Elements.Damping",
    "Elements.Loss factor",
    "Meshes.Mesh damping",
    "Meshes.Bearing damping drive",
    "Meshes.Bearing damping driven",
)
LINE = ("LineFrequency", "SynchronousSpeed", "Poles")
MOTOR = (
    "MotorTorque.Speed",
    "MotorTorque.Average",
    "MotorTorque.Pulsating",
    "LoadTorque.Speed",
    "LoadTorque.Torque",
    "RatedPower",
    "RatedTorque",
    "Voltage",
)
EVENTS = (
    "TorqueTime.Torque",
    "PulsationPhase",
    "ShockAmplitude",
    "ShockTimeConstant",
    "FieldSlip",
    "FieldTimeConstant",
    "FieldAngle",
    "PullOutTorque",
    "PullInDamping",
    "TripSpeed",
    "EndSpeed",
    "MaximumTime",
    "Method",
    "TolerancePeak",
)
CLEARANCES = ("Meshes.Backlash", "Meshes.Angular backlash", "ContactLaw")
MODAL = (*TRAIN, *LATERAL)
START = (*MODAL, *DAMPING, *LINE, *MOTOR, *EVENTS, *CLEARANCES, "EffectChoices.Choice")
SPEEDS = ("MinimumSpeed", "MaximumSpeed", "Stations.Speed ratio", *LINE)
EXCITATION = ("Excitations.Order", "Excitations.Of station", "Excitations.Frequency")
SECTION = ("Elements.Stress diameter", "Elements.Stress bore")
FATIGUE = (
    *SECTION,
    "Elements.SCF",
    "Elements.Material",
    "Materials.Endurance",
    "Materials.Basis",
    "Materials.Below endurance",
    "SNPoints.Cycles",
    "SNPoints.Stress",
)

#: Groups of inputs that go together, by a name; the larger ones first.
GROUPS: Mapping[str, tuple[str, ...]] = {
    "the start": START,
    "train": MODAL,
    "damping": DAMPING,
    "fatigue data": FATIGUE,
    "operating speeds": SPEEDS,
    "line": LINE,
    "section": SECTION,
}

PEAK = "the extreme of the torque between samples: of the cubic through values and rates"
STRESS = "τ = 16 T D / (π (D⁴ − d⁴))"
EQUATION_OF_MOTION = "q̈ + 2ζω q̇ + ω² q = Φᵀ T(t, θ, ω); torque of an element = k · twist"


def named(*of_row: str) -> Trace:
    """A column that only names what the row is about."""
    return Trace(NAME, LABEL, of_row)
