"""Where results come from: papers and standards cited, equations and inputs that many columns share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from addin.contract.field import Trace


@dataclass(frozen=True)
class Source:
    """A paper or standard, with the words by which it is cited."""

    authors: str  #: Authors, or the number of a standard.
    place: str  #: Year, or journal, volume and year, as it follows the authors.
    full: str  #: As in a list of references.
    page: str = ""  #: First page. [number]

    @property
    def cited(self) -> str:
        """Authors and place."""
        return self.authors + self.place

    @property
    def named(self) -> str:
        """Authors as in running text."""
        return self.authors.replace("&", "and")

    @property
    def paged(self) -> str:
        """Authors, place and page."""
        return f"{self.cited} {self.page}"


#: The paper the product implements; its sections, equations and figures are cited below.
PAPER = Source(
    "Szenasi & von Nimitz",
    " 1978",
    "F. R. Szenasi, W. W. von Nimitz: Transient analyses of synchronous motor trains. Proc. 7th "
    "Turbomachinery Symposium, Texas A&M University, 1978.",
)
CONCORDIA = Source(
    "Concordia",
    ", Synchronous machines (1951)",
    "C. Concordia: Synchronous machines, theory and performance. Wiley, New York, 1951.",
)
CANAY = Source(
    "Canay",
    ", IEE Proc. B 130 (1983) 86",
    "I. M. Canay: Determination of model parameters of synchronous machines. IEE Proceedings B 130, 1983, 86-94.",
)
#: The same as the workbooks name it.
PAPER_TITLE = "F. R. Szenasi and W. W. von Nimitz, Transient Analyses of Synchronous Motor Trains"
MIL_STANDARD = Source(
    "Mil-Std-167",
    "",
    "Mil-Std-167: Mechanical vibrations of shipboard equipment, as cited in [1].",
)
SINGULAR_VALUES = Source(
    "Demmel et al.",
    ", Linear Algebra Appl. 299 (1999)",
    "J. Demmel, M. Gu, S. Eisenstat, I. Slapničar, K. Veselić, Z. Drmač: Computing the singular value "
    "decomposition with high relative accuracy. Linear Algebra and its Applications 299 (1999).",
    "21",
)
INTEGRATORS = Source(
    "Hochbruck & Ostermann",
    ", Acta Numerica 19 (2010)",
    "M. Hochbruck, A. Ostermann: Exponential integrators. Acta Numerica 19 (2010).",
    "209",
)
CURVES = Source(
    "Fritsch & Carlson",
    ", SIAM J. Numer. Anal. 17 (1980)",
    "F. N. Fritsch, R. E. Carlson: Monotone piecewise cubic interpolation. SIAM J. Numerical Analysis "
    "17 (1980).",
    "238",
)
RAINFLOW = Source(
    "ASTM E1049",
    "",
    "ASTM E1049: Standard practices for cycle counting in fatigue analysis.",
)
IMPACT = Source(
    "Hunt & Crossley",
    ", J. Applied Mechanics 42 (1975)",
    "K. H. Hunt, F. R. E. Crossley: Coefficient of restitution interpreted as damping in vibroimpact. "
    "J. Applied Mechanics 42 (1975).",
    "440",
)
#: As a report numbers them, from 1.
REFERENCES = (PAPER, MIL_STANDARD, SINGULAR_VALUES, INTEGRATORS, CURVES, RAINFLOW, IMPACT)

CURVES_FROM_DATA = f"{CONCORDIA.cited}; docs/motor.md"
ONE_WAY = "docs/motor.md, A one-way discharge path"
MEASURED_TIMES = f"{CANAY.cited}; docs/motor.md"
MODAL_ELECTRICAL = f"{CONCORDIA.cited}; docs/motor.md, Electrical damping"
STEADY = f"{PAPER.cited}, Steady state torsional analysis"
TRANSIENT = f"{PAPER.cited}, Transient torsional analyses"
SLIP = f"{TRANSIENT}, equation of the pulsation frequency"
REVERSALS = f"{PAPER.cited}, Torque reversals"
PHILOSOPHY = f"{PAPER.cited}, Philosophy of resonant response location"
CRITERION = f"{PAPER.cited}, Stress criterion"
FIGURE_3 = f"{CRITERION}, Figure 3"
MIL = f"{MIL_STANDARD.cited}, as cited in {STEADY}"
SVD = f"{SINGULAR_VALUES.paged}; docs/method.md, Natural frequencies"
EXPONENTIAL = f"{PAPER.cited}, eq. (1); exact step: {INTEGRATORS.paged}; Newmark: eqs (2) to (4)"
CONTACT = "Modelica Standard Library 4.0, ElastoBacklash"
CLEARANCE = (
    f"{PAPER.cited}, Analysis of torque reversals, Figure 4; contact law: {CONTACT}; {IMPACT.paged}"
)
MAKERS = "docs/method.md, Sheet to the makers"
STEPPED_SHAFTS = "docs/method.md, Shafts from sections"
SHIGLEY = "Shigley's Mechanical Engineering Design, 9th ed. (2011)"
STRENGTH_FACTORS = f"{SHIGLEY}, section 6-9; docs/method.md, Notches and strength factors"
NOTCHES = "Pilkey, Formulas for Stress, Strain, and Structural Matrices (2005), Table 6-1; docs/method.md, Notches and strength factors"
SAFETY = "docs/method.md, Safety factors"
STRENGTH = "Timoshenko, Strength of Materials, torsion of a circular shaft"
ASTM = f"{RAINFLOW.cited}-85, rainflow counting; Miner, J. Applied Mechanics 12 (1945) A-159"
NAME = "Name, as typed"
LABEL = "docs/nomenclature.md"

# --- what they are calculated from ----------------------------------------------------------------

#: What the stiffness of a section depends on, and its inertia.
OF_SECTION = tuple(
    f"Sections.{column}"
    for column in (
        "Length",
        "OD",
        "End OD",
        "ID",
        "Material",
        "Fillet",
        "Penetration",
        "Keyway width",
        "Keyway depth",
    )
)
#: What the speed ratios of stations follow from, beside the pitch radii.
OF_RATIO = ("Meshes.Teeth drive", "Meshes.Teeth driven", "Meshes.Speed ratio")
TRAIN = (
    "Stations.Inertia",
    "Stations.Speed ratio",
    *OF_RATIO,
    "Elements.Kind",
    "Elements.From",
    "Elements.To",
    "Elements.Stiffness",
    "Elements.OD",
    "Elements.ID",
    "Elements.Length",
    "Elements.Shear modulus",
    "Elements.Density",
    *OF_SECTION,
    "SectionMaterials.Shear modulus",
    "SectionMaterials.Density",
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
    "MotorTorque.Phase",
    "MotorTorque.Pulsation1",
    "SupplyVoltage.Speed",
    "SupplyVoltage.Voltage",
    "Supply.Short-circuit power",
    "Supply.X/R",
    "Supply.Starting",
    "Supply.Tap",
    "Supply.Switch-over speed",
    "Supply.Open time",
    "LoadTorque.Speed",
    "LoadTorque.Torque",
    "RatedPower",
    "RatedTorque",
    "Voltage",
)
SUPPLY = tuple(
    f"Supply.{column}"
    for column in (
        "Short-circuit power",
        "X/R",
        "Starting",
        "Tap",
        "Switch-over speed",
        "Open time",
        "Initial voltage",
        "Ramp time",
    )
)
MOTOR_DATA = (
    *(
        f"MotorData.{column}"
        for column in (
            "Kind", "Apparent power", "Power factor", "Xd", "Xq", "Xd transient", "Xd subtransient", "Xq subtransient", "Xl",
            "Td0 transient", "Td0 subtransient", "Tq0 subtransient", "Td transient", "Td subtransient",
            "Tq subtransient", "Time constants", "Ta", "Ra", "Discharge resistance",
            "Discharge resistance reverse", "Field circuit", "Start factor",
            "R1", "X1", "Xm", "R2", "X2", "R3", "X3",
        )
    ),
    *(
        f"MotorCircuit.{column}"
        for column in (
            "Rs", "Xl", "Xmd", "Xmq", "Rf", "Xlf", "Rkd", "Xlkd", "Rkq", "Xlkq", "Rkd2", "Xlkd2", "Rkq2",
            "Xlkq2", "Xc",
        )
    ),
)  # fmt: skip
EVENTS = (
    "TorqueTime.Torque",
    "InitialState",
    "TorqueFollows",
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
START = (*MODAL, *DAMPING, *LINE, *MOTOR, *MOTOR_DATA, *EVENTS, *CLEARANCES, "EffectChoices.Choice")
#: What an event in operation depends on.
EVENT = (
    *MODAL,
    *DAMPING,
    *LINE,
    "EventTorque.Station",
    "EventTorque.Base",
    "EventTorque.Amplitude",
    "EventTorque.Multiple",
    "EventTorque.Phase",
    "EventTorque.Time constant",
    *MOTOR_DATA,
    "MotorData.Power factor",
    "MotorEvents.Station",
    "MotorEvents.Kind",
    "MotorEvents.Phase",
    "MotorEvents.Angle",
    "MotorEvents.Residual voltage",
    "MotorEvents.Clears after",
    "MotorEvents.Earliest clearing",
    "MotorEvents.Latest clearing",
    "MotorEvents.Clearing",
    "MotorEvents.Begins",
    "TorqueTime.Torque",
    "InitialState",
    "Stations.Running load",
    "LoadTorque.Torque",
    "RatedTorque",
    "RatedPower",
    "MaximumTime",
    "TolerancePeak",
    "Meshes.Backlash",
    "Meshes.Angular backlash",
    "EffectChoices.Choice",
)
SPEEDS = ("MinimumSpeed", "MaximumSpeed", "Stations.Speed ratio", *LINE)
EXCITATION = ("Excitations.Order", "Excitations.Of station", "Excitations.Frequency")
SECTION = ("Elements.Stress diameter", "Elements.Stress bore")
NOTCH = (
    "Elements.SCF",
    "FatigueFactors.Notch",
    "FatigueFactors.Notch radius",
    "FatigueFactors.Shoulder diameter",
)
FATIGUE = (
    *SECTION,
    *NOTCH,
    "FatigueFactors.Notch sensitivity",
    "FatigueFactors.Surface",
    "FatigueFactors.Size",
    "FatigueFactors.Reliability",
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
    "motor data": MOTOR_DATA,
    "damping": DAMPING,
    "fatigue data": FATIGUE,
    "operating speeds": SPEEDS,
    "line": LINE,
    "section": SECTION,
}

PEAK = (
    "extreme of the torque, also between samples, from the cubic through the values and "
    "their time derivatives"
)
STRESS = "τ = 16 T D / (π (D⁴ − d⁴))"
EVENT_RESPONSE = "torque in operation + response to Σ A e^(−t/τ) cos(m ω t + φ), exact at the samples: M θ̈ + C θ̇ + K θ = T(t)"
#: Torque of a motor from its fluxes.
AIR_GAP = (
    "ψd iq − ψq id, ψ̇d = ω₀ (ud − Rs id + ω ψq), ψ̇q = ω₀ (uq − Rs iq − ω ψd), ψ̇f = ω₀ (ef − Rf if)"
)
EVENT_METHOD = "docs/method.md, Events in operation"
EQUATION_OF_MOTION = "q̈ + 2ζω q̇ + ω² q = Φᵀ T(t, θ, ω); torque of an element = k · twist"


def named(*of_row: str) -> Trace:
    """A column that only names what the row is about."""
    return Trace(NAME, LABEL, of_row)
