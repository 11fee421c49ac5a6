"""Where each result comes from: equation, source, and the inputs it was calculated from.

`addin.contract.tables` attaches these to the columns of its result tables, so that workbook, documentation and
``torsionbook verify --trace`` tell the same. An input is named as it is in the workbook: a scalar
(``LineFrequency``), a column (``Elements.Stiffness``), or another result (``NaturalFrequencies.Frequency``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["GROUPS", "PAPER", "SHARE_MODES", "TRACES", "Trace"]

#: Modes whose energy shares sheet `Frequencies` shows; sheet `Frequency sensitivities` has more.
SHARE_MODES = 5


@dataclass(frozen=True)
class Trace:
    """How one result column is obtained."""

    equation: str  #: Formula or rule, in the symbols of the nomenclature.
    #: Paper, standard or textbook with section, equation or page; our own rules name the part of
    #: docs/method.md that states them. [citation]
    source: str
    #: Inputs and results of the very row: of its element, station, mode, excitation or material.
    of_row: tuple[str, ...] = ()
    of_case: tuple[str, ...] = ()  #: Inputs and results of the whole case.

    @property
    def inputs(self) -> tuple[str, ...]:
        """All of them, those of the row first. [names]"""
        return tuple(dict.fromkeys((*self.of_row, *self.of_case)))


#: The paper the product implements; its sections, equations and figures are cited below.
PAPER = (
    "Szenasi & von Nimitz, Transient analyses of synchronous motor trains, 7th Turbomachinery "
    "Symposium (1978)"
)

_STEADY = "Szenasi & von Nimitz 1978, Steady state torsional analysis"
_TRANSIENT = "Szenasi & von Nimitz 1978, Transient torsional analyses"
_SLIP = f"{_TRANSIENT}, equation of the pulsation frequency"
_REVERSALS = "Szenasi & von Nimitz 1978, Torque reversals"
_PHILOSOPHY = "Szenasi & von Nimitz 1978, Philosophy of resonant response location"
_CRITERION = "Szenasi & von Nimitz 1978, Stress criterion"
_FIGURE_3 = f"{_CRITERION}, Figure 3"
_MIL = "Mil-Std-167, as cited in Szenasi & von Nimitz 1978, Steady state torsional analysis"
_SVD = "Demmel et al., Linear Algebra Appl. 299 (1999) 21; docs/method.md, Natural frequencies"
_EXPONENTIAL = (
    "Szenasi & von Nimitz 1978, eq. (1); exact step: Hochbruck & Ostermann, Acta Numerica 19 (2010) "
    "209; Newmark: eqs (2) to (4)"
)
_CLEARANCE = (
    "Szenasi & von Nimitz 1978, Analysis of torque reversals, Figure 4; contact law: Modelica "
    "Standard Library 4.0, ElastoBacklash; Hunt & Crossley, J. Applied Mechanics 42 (1975) 440"
)
_STRENGTH = "Timoshenko, Strength of Materials, torsion of a circular shaft"
_ASTM = "ASTM E1049-85, rainflow counting; Miner, J. Applied Mechanics 12 (1945) A-159"
_NAME = "Name, as typed"
_LABEL = "docs/nomenclature.md"

# --- what they are calculated from ----------------------------------------------------------------

_TRAIN = (
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
_LATERAL = (
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
_DAMPING = (
    "DampingRatio",
    "ModeDamping.Damping ratio",
    "Stations.Damping",
    "Elements.Damping",
    "Elements.Loss factor",
    "Meshes.Mesh damping",
    "Meshes.Bearing damping drive",
    "Meshes.Bearing damping driven",
)
_LINE = ("LineFrequency", "SynchronousSpeed", "Poles")
_MOTOR = (
    "MotorTorque.Speed",
    "MotorTorque.Average",
    "MotorTorque.Pulsating",
    "LoadTorque.Speed",
    "LoadTorque.Torque",
    "RatedPower",
    "RatedTorque",
    "Voltage",
)
_EVENTS = (
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
_CLEARANCES = ("Meshes.Backlash", "Meshes.Angular backlash", "ContactLaw")
_MODAL = (*_TRAIN, *_LATERAL)
_START = (*_MODAL, *_DAMPING, *_LINE, *_MOTOR, *_EVENTS, *_CLEARANCES, "EffectChoices.Choice")
_SPEEDS = ("MinimumSpeed", "MaximumSpeed", "Stations.Speed ratio", *_LINE)
_EXCITATION = ("Excitations.Order", "Excitations.Of station", "Excitations.Frequency")
_SECTION = ("Elements.Stress diameter", "Elements.Stress bore")
_FATIGUE = (
    *_SECTION,
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
    "the start": _START,
    "train": _MODAL,
    "damping": _DAMPING,
    "fatigue data": _FATIGUE,
    "operating speeds": _SPEEDS,
    "line": _LINE,
    "section": _SECTION,
}

_PEAK = "the extreme of the torque between samples: of the cubic through values and rates"
_STRESS = "τ = 16 T D / (π (D⁴ − d⁴))"
_EQUATION_OF_MOTION = "q̈ + 2ζω q̇ + ω² q = Φᵀ T(t, θ, ω); torque of an element = k · twist"


def _named(*of_row: str) -> Trace:
    """A column that only names what the row is about."""
    return Trace(_NAME, _LABEL, of_row)


#: By result table and column.
TRACES: Mapping[tuple[str, str], Trace] = {
    # -- Verdicts ----------------------------------------------------------------------------------
    ("Verdicts", "Check"): Trace("Name of the check", "docs/method.md"),
    ("Verdicts", "Result"): Trace(
        "The governing number: least margin, largest stress over its allowable, least torque over its "
        "limit, fewest starts (rounded down to whole starts)",
        "docs/method.md; the source of the table it is taken from",
        of_case=(
            "SeparationMargins.Margin",
            "SteadyState.Peak-to-peak stress",
            "SteadyState.Zero-to-peak stress",
            "StartupPeaks.Maximum torque",
            "TorqueReversals.Minimum torque",
            "AllowableStarts.Allowable starts",
            "StartsFactor",
        ),
    ),
    ("Verdicts", "Limit"): Trace(
        "Required margin; UTS/25; limits of the maker; StartsRequired",
        f"{_STEADY}; {_MIL}; table Elements",
        of_case=(
            "SeparationMargins.Required",
            "SteadyState.Allowable",
            "Elements.Peak torque limit",
            "Elements.Reversal limit",
            "Materials.Yield",
            "StartsRequired",
        ),
    ),
    ("Verdicts", "Verdict"): Trace(
        "pass where the result keeps the limit; accepted by forced response where a margin is not "
        "kept and every judged stress is within UTS/25; fail; not judged without a limit. Overall = the worst",
        f"{_STEADY} (a forced vibration analysis where the margin cannot be attained)",
        of_row=("Verdicts.Result", "Verdicts.Limit"),
    ),
    ("Verdicts", "Where"): Trace(
        "Mode, element or speed of the governing number",
        "docs/method.md",
        of_row=("Verdicts.Result",),
    ),
    # -- NaturalFrequencies ------------------------------------------------------------------------
    ("NaturalFrequencies", "Mode"): Trace(
        "Counted by rising frequency; rigid-body modes, counted from the topology, are 0", _SVD,
        of_case=_MODAL,
    ),
    ("NaturalFrequencies", "Frequency"): Trace(
        "f = ω/2π, ω the singular values of √k · B / √J; B the incidence matrix with speed ratios, "
        "k = G π (D⁴ − d⁴) / 32 L where it is blank",
        f"{_STEADY} (eigenvalue solution); {_SVD}; {_STRENGTH}",
        of_case=_MODAL,
    ),
    ("NaturalFrequencies", "CPM"): Trace(
        "60 f", _LABEL, of_row=("NaturalFrequencies.Frequency",)
    ),
    ("NaturalFrequencies", "Percent speed"): Trace(
        "100 (1 − f / 2 f_line)", f"{_SLIP}; Table 1",
        of_row=("NaturalFrequencies.Frequency",), of_case=_LINE,
    ),
    ("NaturalFrequencies", "Damping ratio"): Trace(
        "ζ = DampingRatio or ModeDamping + ½ Σ loss factor × strain-energy share + ½ φᵀCφ/ω at unit "
        "modal mass",
        "docs/method.md, Damping",
        of_row=("ModeDamping.Damping ratio",), of_case=(*_DAMPING, *_MODAL),
    ),
    ("NaturalFrequencies", "Largest strain energy"): Trace(
        "The element with the largest k (Bφ)² of the mode", "docs/nomenclature.md, strain-energy share",
        of_case=_MODAL,
    ),
    ("NaturalFrequencies", "Share"): Trace(
        "k (Bφ)² of that element over the sum of all", "docs/nomenclature.md, strain-energy share",
        of_case=_MODAL,
    ),
    # -- ModeShapes --------------------------------------------------------------------------------
    ("ModeShapes", "Station"): _named("Stations.Station"),
    ("ModeShapes", "Mode"): Trace(
        "φ of the station in its running direction, over the largest of the mode", _SVD,
        of_case=_MODAL,
    ),
    # -- SeparationMargins -------------------------------------------------------------------------
    ("SeparationMargins", "Mode"): Trace(
        "As in NaturalFrequencies", _SVD, of_row=("NaturalFrequencies.Mode",)
    ),
    ("SeparationMargins", "Excitation"): Trace(
        "Rows of Excitations; blank = 1× and 2× of every shaft speed, 1× and 2× line frequency",
        f"{_STEADY} (operating speeds, line frequency and their multiples)",
        of_row=("Excitations.Name",), of_case=("Stations.Speed ratio", *_LINE),
    ),
    ("SeparationMargins", "Speed"): Trace(
        "The motor speed between MinimumSpeed and MaximumSpeed at which the margin is least", _STEADY,
        of_row=_EXCITATION, of_case=_SPEEDS,
    ),
    ("SeparationMargins", "Excitation frequency"): Trace(
        "order × speed of its station / 2π, or the frequency stated", _STEADY,
        of_row=(*_EXCITATION, "SeparationMargins.Speed"), of_case=("Stations.Speed ratio",),
    ),
    ("SeparationMargins", "Margin"): Trace(
        "|f − f_exc| / f_exc, the least over the operating speeds; 0 where a line crosses the mode",
        f"{_STEADY} (20 percent margin)",
        of_row=("NaturalFrequencies.Frequency", "SeparationMargins.Excitation frequency"),
        of_case=_SPEEDS,
    ),
    ("SeparationMargins", "Required"): Trace(
        "20 % for calculated, 10 % for measured frequencies, or MarginRequired", _STEADY,
        of_case=("MarginBasis", "MarginRequired"),
    ),
    ("SeparationMargins", "Verdict"): Trace(
        "pass where margin ≥ required; else accepted by forced response where every judged stress at "
        "that resonance is within UTS/25; else fail",
        f"{_STEADY}; {_MIL}",
        of_row=("SeparationMargins.Margin", "SeparationMargins.Required", "SteadyState.Verdict"),
    ),
    # -- SteadyState -------------------------------------------------------------------------------
    ("SteadyState", "Element"): _named("Elements.Element"),
    ("SteadyState", "Excitation"): Trace(
        "As in SeparationMargins", _STEADY, of_row=("SeparationMargins.Excitation",)
    ),
    ("SteadyState", "Mode"): Trace(
        "The mode at resonance, where its margin is not kept; blank at an operating speed", _STEADY,
        of_row=("SeparationMargins.Verdict",),
    ),
    ("SteadyState", "Frequency"): Trace(
        "The natural frequency where a margin is not kept (forcing at the resonance), else the "
        "frequency of the largest response over the operating speeds",
        f"{_STEADY} (a conservative forcing function at the resonant frequency)",
        of_row=("NaturalFrequencies.Frequency", *_EXCITATION), of_case=_SPEEDS,
    ),
    ("SteadyState", "Applied at"): Trace(
        "Motor, gears and driven machines in turn; the place with the largest response", _STEADY,
        of_row=("Excitations.Station",), of_case=("Stations.Running load", "Elements.Kind"),
    ),
    ("SteadyState", "Applied torque"): Trace(
        "1 % zero-to-peak: of RatedTorque at the motor, of the transmitted torque at a gear, of its Running "
        "load at a driven machine; or the Torque stated",
        f"{_STEADY} (approximately 1 percent zero-peak of the transmitted torque)",
        of_row=("Excitations.Torque",),
        of_case=("RatedTorque", "RatedPower", "SynchronousSpeed", "Stations.Running load"),
    ),
    ("SteadyState", "Torque"): Trace(
        "(K(1 + iη) + iωC − ω²J) θ = T solved directly, all modes; magnitude of the element's torque "
        "k(1 + iη)·twist + iωc·twist",
        f"{_STEADY} (matrix method); docs/method.md, Separation margins and forced response",
        of_row=("SteadyState.Frequency", "SteadyState.Applied torque"),
        of_case=(*_MODAL, *_DAMPING),
    ),
    ("SteadyState", "Zero-to-peak stress"): Trace(
        f"SCF · {_STRESS}, T zero-to-peak", f"{_STEADY}; {_STRENGTH}",
        of_row=("SteadyState.Torque", *_SECTION, "Elements.SCF"),
    ),
    ("SteadyState", "Peak-to-peak stress"): Trace(
        "2 × zero-to-peak stress", f"{_STEADY} (the peak-to-peak stresses are calculated)",
        of_row=("SteadyState.Zero-to-peak stress",),
    ),
    ("SteadyState", "Allowable"): Trace(
        "UTS / 25", _MIL, of_row=("Elements.Material", "Materials.UTS")
    ),
    ("SteadyState", "Verdict"): Trace(
        "pass where the stress of StressBasis is at most UTS/25, and the torque of a coupling or mesh "
        "at most its Vibratory limit; unbounded where an undamped mode is at resonance",
        _MIL,
        of_row=(
            "SteadyState.Peak-to-peak stress", "SteadyState.Zero-to-peak stress",
            "SteadyState.Allowable", "Elements.Vibratory limit",
        ),
        of_case=("StressBasis",),
    ),
    # -- StartupPeaks ------------------------------------------------------------------------------
    ("StartupPeaks", "Element"): _named("Elements.Element"),
    ("StartupPeaks", "Maximum torque"): Trace(
        f"{_EQUATION_OF_MOTION}; {_PEAK}", _EXPONENTIAL, of_case=_START
    ),
    ("StartupPeaks", "Minimum torque"): Trace(
        f"{_EQUATION_OF_MOTION}; {_PEAK}", _EXPONENTIAL, of_case=_START
    ),
    ("StartupPeaks", "Peak-to-peak torque"): Trace(
        "maximum − minimum, from rest to the end of the run", _LABEL,
        of_row=("StartupPeaks.Maximum torque", "StartupPeaks.Minimum torque"),
    ),
    ("StartupPeaks", "Peak-to-peak stress"): Trace(
        f"{_STRESS} of the peak-to-peak torque; nominal, without SCF",
        f"{_TRANSIENT}; {_STRENGTH}",
        of_row=("StartupPeaks.Peak-to-peak torque", *_SECTION),
    ),
    ("StartupPeaks", "Time"): Trace(
        "Instant of the maximum torque", _EXPONENTIAL, of_row=("StartupPeaks.Maximum torque",),
        of_case=_START,
    ),
    ("StartupPeaks", "Percent speed"): Trace(
        "100 × mean speed / synchronous speed at that instant", _LABEL,
        of_row=("StartupPeaks.Time",), of_case=(*_START,),
    ),
    ("StartupPeaks", "Error"): Trace(
        "Change of the extremes from step h to h/2, with a bound on the modes left out, over the "
        "larger extreme",
        "docs/method.md, The start", of_case=("TolerancePeak", "Method"),
    ),
    # -- StartupCrossings --------------------------------------------------------------------------
    ("StartupCrossings", "Mode"): Trace(
        "Every mode below 2 × line frequency", _SLIP, of_row=("NaturalFrequencies.Mode",),
        of_case=_LINE,
    ),
    ("StartupCrossings", "Frequency"): Trace(
        "As in NaturalFrequencies", _SVD, of_row=("NaturalFrequencies.Frequency",)
    ),
    ("StartupCrossings", "Percent speed"): Trace(
        "100 (1 − f / 2 f_line)", f"{_SLIP}; Table 1",
        of_row=("StartupCrossings.Frequency",), of_case=_LINE,
    ),
    ("StartupCrossings", "Time"): Trace(
        "When the mean speed passes that speed", f"{_TRANSIENT}, Figure 6",
        of_row=("StartupCrossings.Percent speed",), of_case=_START,
    ),
    ("StartupCrossings", "Average torque"): Trace(
        "Monotone cubic through Average at that speed, × Voltage²",
        f"{_PHILOSOPHY}; curves: Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238",
        of_row=("StartupCrossings.Percent speed",),
        of_case=("MotorTorque.Speed", "MotorTorque.Average", "Voltage"),
    ),
    ("StartupCrossings", "Pulsating torque"): Trace(
        "Monotone cubic through Pulsating at that speed, × Voltage²",
        f"{_PHILOSOPHY}; curves: Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238",
        of_row=("StartupCrossings.Percent speed",),
        of_case=("MotorTorque.Speed", "MotorTorque.Pulsating", "Voltage"),
    ),
    ("StartupCrossings", "Load torque"): Trace(
        "Σ load torque at that speed × speed ratio: referred to the motor",
        f"{_TRANSIENT}; docs/nomenclature.md",
        of_row=("StartupCrossings.Percent speed",),
        of_case=("LoadTorque.Speed", "LoadTorque.Torque", "Stations.Speed ratio"),
    ),
    ("StartupCrossings", "Acceleration"): Trace(
        "(average − load torque) / Σ J r², the rigid train", f"{_PHILOSOPHY}, Figure 6",
        of_row=("StartupCrossings.Average torque", "StartupCrossings.Load torque"),
        of_case=("Stations.Inertia", "Stations.Speed ratio"),
    ),
    ("StartupCrossings", "Sweep rate"): Trace(
        "2 f_line × acceleration / synchronous speed", _SLIP,
        of_row=("StartupCrossings.Acceleration",), of_case=_LINE,
    ),
    ("StartupCrossings", "Governing element"): Trace(
        "The element with the largest nominal stress range in the window of the crossing; without "
        "stress diameters the largest torque range",
        "docs/method.md, Crossings", of_case=(*_START, *_SECTION),
    ),
    ("StartupCrossings", "Peak-to-peak torque"): Trace(
        "Its torque range while the pulsation passes from 1.1 f (or half-way to the next higher mode) "
        "to half-way to the next lower one",
        f"docs/method.md, Crossings; {_EXPONENTIAL}", of_case=_START,
    ),
    ("StartupCrossings", "Peak-to-peak stress"): Trace(
        f"{_STRESS} of that range; nominal, without SCF",
        "Szenasi & von Nimitz 1978, Sample case (stress when the first mode is excited)",
        of_row=("StartupCrossings.Peak-to-peak torque",), of_case=_SECTION,
    ),
    ("StartupCrossings", "Mesh minimum torque"): Trace(
        "Least torque of a gear mesh in the same window", f"{_REVERSALS}, Figure 7", of_case=_START
    ),
    ("StartupCrossings", "Note"): Trace(
        "Sweep or damping, whichever limits the build-up: 3.68 √(f²/ḟ) (undamped sweep) against 1/2ζ; "
        "pulsating over average torque; reversal",
        f"{_PHILOSOPHY}; Lewis, Trans. ASME 54 (1932) 253",
        of_row=(
            "StartupCrossings.Sweep rate", "NaturalFrequencies.Damping ratio",
            "StartupCrossings.Average torque", "StartupCrossings.Pulsating torque",
        ),
    ),
    # -- AllowableStarts ---------------------------------------------------------------------------
    ("AllowableStarts", "Element"): _named("Elements.Element"),
    ("AllowableStarts", "Damage"): Trace(
        f"q = Σ nᵢ/Nᵢ over the rainflow cycles of SCF · {_STRESS}; amplitude = half range, mean ignored; "
        "N on the log-log S-N line; bending data halved for torsion",
        f"{_FIGURE_3}; {_ASTM}",
        of_row=_FATIGUE, of_case=(*_START, "RainflowResidue"),
    ),
    ("AllowableStarts", "Allowable starts"): Trace(
        "1/q; unlimited where q = 0", _FIGURE_3, of_row=("AllowableStarts.Damage",)
    ),
    ("AllowableStarts", "Paper count"): Trace(
        "1/Σ nᵢ/Nᵢ, every range from one turning point of the stress to the next counted as half a cycle", _FIGURE_3,
        of_row=_FATIGUE, of_case=_START,
    ),
    ("AllowableStarts", "Error"): Trace(
        "Change of 1/q from step h to h/2", "docs/method.md, Allowable starts",
        of_case=("ToleranceStarts", "TolerancePeak"),
    ),
    ("AllowableStarts", "Governing"): Trace(
        "yes for the element that allows the fewest starts", _FIGURE_3,
        of_row=("AllowableStarts.Damage",),
    ),
    # -- TorqueReversals ---------------------------------------------------------------------------
    ("TorqueReversals", "Element"): _named("Elements.Element"),
    ("TorqueReversals", "Minimum torque"): Trace(
        f"{_EQUATION_OF_MOTION}; {_PEAK}", f"{_REVERSALS}; {_EXPONENTIAL}",
        of_row=("StartupPeaks.Minimum torque",), of_case=_START,
    ),
    ("TorqueReversals", "Reversals"): Trace(
        "Passages of the torque below zero that are deeper than 0.1 % of the element's largest torque",
        f"{_REVERSALS}; docs/method.md, Torque reversals", of_case=_START,
    ),
    ("TorqueReversals", "Time unloaded"): Trace(
        "Sum of the times below zero of these passages; with a clearance the time without contact",
        f"{_REVERSALS}; docs/method.md, Torque reversals", of_case=_START,
    ),
    ("TorqueReversals", "Impacts"): Trace(
        "Recontacts of either flank after free flight", _CLEARANCE,
        of_row=("Meshes.Backlash", "Meshes.Angular backlash"), of_case=_START,
    ),
    ("TorqueReversals", "Recontact speed"): Trace(
        "v = δ̇_c r_b cos β_b, the largest at a recontact, normal to the flank", _CLEARANCE,
        of_row=("Meshes.Pitch radius drive", "Meshes.Pressure angle", "Meshes.Helix angle"),
        of_case=_START,
    ),
    ("TorqueReversals", "Tooth force"): Trace(
        "F = T / (r_b cos β_b), the largest; r_b = pitch radius × cos α_t, tan α_t = tan α_n / cos β",
        f"{_CLEARANCE}; ISO 21771, base circle",
        of_row=("Meshes.Pitch radius drive", "Meshes.Pressure angle", "Meshes.Helix angle"),
        of_case=_START,
    ),
    ("TorqueReversals", "Longest reversal"): Trace(
        "The longest of the passages counted", "docs/method.md, Torque reversals", of_case=_START
    ),
    ("TorqueReversals", "First time"): Trace(
        "When the first of them begins: the torque last crossed zero", "docs/method.md, Torque reversals",
        of_case=_START,
    ),
    ("TorqueReversals", "2 × slip frequency"): Trace(
        "2 f_line (1 − n/n_s) at the instant of the least torque", _SLIP, of_case=(*_LINE, *_START)
    ),
    ("TorqueReversals", "Transmitted torque"): Trace(
        "Sum of the running loads beyond the element, at its own speed", "docs/nomenclature.md",
        of_case=("Stations.Running load", "Stations.Speed ratio", "Elements.From", "Elements.To"),
    ),
    ("TorqueReversals", "Margin"): Trace(
        "least torque / transmitted torque", "docs/nomenclature.md, reversal margin",
        of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Transmitted torque"),
    ),
    ("TorqueReversals", "Limit"): Trace(
        "The maker's Reversal limit", f"{_REVERSALS} (gear makers set limits)",
        of_row=("Elements.Reversal limit",),
    ),
    ("TorqueReversals", "Verdict"): Trace(
        "fail where −minimum torque > limit; not judged without a limit", _REVERSALS,
        of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Limit"),
    ),
    ("TorqueReversals", "Recontact speed angular"): Trace(
        "The recontact speed over r_b cos β_b, at the From side", _CLEARANCE,
        of_row=("TorqueReversals.Recontact speed",), of_case=_START,
    ),
    ("TorqueReversals", "Model"): Trace(
        "clearance where the plan models it, else linear", "docs/method.md, The plan",
        of_row=("Effects.On",), of_case=("EffectChoices.Choice", *_CLEARANCES),
    ),
    ("TorqueReversals", "Note"): Trace(
        "The row in words", _REVERSALS,
        of_row=("TorqueReversals.Reversals", "TorqueReversals.Limit"),
    ),
    # -- Effects -----------------------------------------------------------------------------------
    ("Effects", "Effect"): Trace("One of the ten effects", "docs/effects.md"),
    ("Effects", "Choice"): Trace(
        "As chosen; blank = auto", "docs/effects.md", of_row=("EffectChoices.Choice",)
    ),
    ("Effects", "On"): Trace(
        "Forced by the choice, else on where the deciding number is beyond the limit",
        "docs/effects.md; docs/method.md, The plan",
        of_row=("Effects.Deciding number", "Effects.Limit", "Effects.Choice"),
    ),
    ("Effects", "Deciding number"): Trace(
        "Of each effect its own cheap number, from modes, damping, rigid run-up and the linear start",
        "docs/effects.md, The ten effects", of_case=_START,
    ),
    ("Effects", "Limit"): Trace(
        "Tolerance over the gain of the effect (50, 50, 5), or as docs/effects.md states",
        "docs/method.md, The plan", of_case=("TolerancePeak", "ToleranceStarts"),
    ),
    ("Effects", "Bound"): Trace(
        "Deciding number × gain; 0 where leaving it out is exact", "docs/method.md, The plan",
        of_row=("Effects.Deciding number",),
    ),
    ("Effects", "Time"): Trace(
        "Wall time, measured where the effect has a run of its own, else estimated from the linear start",
        "docs/effects.md",
    ),
    ("Effects", "Why"): Trace(
        "The decision in words", "docs/effects.md", of_row=("Effects.Deciding number", "Effects.Limit")
    ),
    # -- AccuracyCost ------------------------------------------------------------------------------
    ("AccuracyCost", "Method"): Trace(
        "Method of the time integration, or the analysis", "docs/method.md, What accuracy costs",
        of_case=("Method",),
    ),
    ("AccuracyCost", "Setting"): Trace(
        "Step or wanted tolerance", "docs/method.md, What accuracy costs", of_case=("TolerancePeak",)
    ),
    ("AccuracyCost", "Error peak"): Trace(
        "Largest error of a peak over the larger extreme of its element: estimated from h and h/2, in a "
        "study against a reference 256 times finer",
        "docs/method.md, What accuracy costs", of_case=_START,
    ),
    ("AccuracyCost", "Error starts"): Trace(
        "The same of the allowable starts", "docs/method.md, What accuracy costs",
        of_case=(*_START, *_FATIGUE),
    ),
    ("AccuracyCost", "Time"): Trace(
        "Wall time, in a study the median of repeats", "docs/method.md, What accuracy costs"
    ),
    # -- Audit -------------------------------------------------------------------------------------
    ("Audit", "Item"): Trace("Name of what is stated", "docs/audit.md"),
    ("Audit", "Value"): Trace(
        "As stated. The digest is SHA-256 of the SI values of all inputs but title block and "
        "descriptions, rounded to 12 significant digits",
        "docs/audit.md; FIPS 180-4",
    ),
    # -- StartCycles -------------------------------------------------------------------------------
    ("StartCycles", "Amplitude"): Trace(
        f"Half range of a rainflow cycle of SCF · {_STRESS}", _ASTM,
        of_case=("AllowableStarts.Governing", *_FATIGUE, *_START),
    ),
    ("StartCycles", "Cycles"): Trace(
        "n: 1 for a closed cycle, 0.5 for a half cycle of the residue", _ASTM,
        of_case=("RainflowResidue", *_START),
    ),
    ("StartCycles", "Cycles to failure"): Trace(
        "N on the log-log S-N line at this amplitude; unlimited below endurance unless Below endurance "
        "says otherwise",
        _FIGURE_3,
        of_row=("StartCycles.Amplitude",),
        of_case=(
            "SNPoints.Cycles", "SNPoints.Stress", "Materials.Endurance", "Materials.Basis",
            "Materials.Below endurance",
        ),
    ),
    ("StartCycles", "Damage"): Trace(
        "n / N", _FIGURE_3, of_row=("StartCycles.Cycles", "StartCycles.Cycles to failure")
    ),
    # -- BearingForces -----------------------------------------------------------------------------
    ("BearingForces", "Station"): _named("Stations.Station"),
    ("BearingForces", "Force"): Trace(
        "The largest |k_b u + c_b u̇| over x and y, transmitted force included, without weight",
        "Szenasi & von Nimitz 1978, Figure 4c; docs/method.md, Clearances",
        of_row=(
            "Meshes.Bearing stiffness drive", "Meshes.Bearing stiffness driven",
            "Meshes.Bearing damping drive", "Meshes.Bearing damping driven",
        ),
        of_case=_START,
    ),
    ("BearingForces", "Time"): Trace(
        "When", "docs/method.md, Clearances", of_row=("BearingForces.Force",), of_case=_START
    ),
    # -- EnergyShares ------------------------------------------------------------------------------
    ("EnergyShares", "Quantity"): Trace("Stiffness or inertia", _SVD, of_case=_MODAL),
    ("EnergyShares", "Of"): Trace("Element or station, as typed", _SVD, of_case=_MODAL),
    **{
        ("EnergyShares", f"Share {mode}"): Trace(
            "k (Bφ)² of the element, J φ² of the station, over the sum of all; modes as good as equal "
            "together",
            "docs/nomenclature.md, strain-energy share; Lancaster, Numer. Math. 6 (1964) 377",
            of_case=_MODAL,
        )
        for mode in range(1, SHARE_MODES + 1)
    },
    **{
        ("EnergyShares", f"Shift {mode}"): Trace(
            "± ½ × share × change × f, + of stiffnesses, − of inertias, calculated by the spreadsheet",
            "Rayleigh, Theory of Sound I, § 88; docs/tolerances.md",
            of_row=(f"EnergyShares.Share {mode}", "NaturalFrequencies.Frequency"),
        )
        for mode in range(1, SHARE_MODES + 1)
    },
    # -- Plans -------------------------------------------------------------------------------------
    ("Plans", "Plan"): Trace("Counted from 1; the last one is reported", "docs/method.md, The plan"),
    ("Plans", "Reason"): Trace("Why it was made", "docs/method.md, The plan"),
    # -- live formulas -----------------------------------------------------------------------------
    ("NaturalFrequencies", "Percent speed check"): Trace(
        "100 (1 − f / 2 f_line), calculated by the spreadsheet", f"{_SLIP}; Table 1",
        of_row=("NaturalFrequencies.Frequency",), of_case=_LINE,
    ),
    ("SeparationMargins", "Margin check"): Trace(
        "100 |f − f_exc| / f_exc, calculated by the spreadsheet", _STEADY,
        of_row=("NaturalFrequencies.Frequency", "SeparationMargins.Excitation frequency"),
    ),
    ("SteadyState", "UTS/25 check"): Trace(
        "UTS / 25, calculated by the spreadsheet", _MIL,
        of_row=("Elements.Material", "Materials.UTS"),
    ),
    ("AllowableStarts", "Starts check"): Trace(
        "1 / damage, calculated by the spreadsheet", _FIGURE_3, of_row=("AllowableStarts.Damage",)
    ),
    ("AllowableStarts", "Starts to judge"): Trace(
        "1 / damage / StartsFactor, rounded down, calculated by the spreadsheet", _FIGURE_3,
        of_row=("AllowableStarts.Damage",), of_case=("StartsFactor",),
    ),
    ("TorqueReversals", "Margin check"): Trace(
        "100 × minimum / transmitted torque, calculated by the spreadsheet",
        "docs/nomenclature.md, reversal margin",
        of_row=("TorqueReversals.Minimum torque", "TorqueReversals.Transmitted torque"),
    ),
    ("StartCycles", "Damage check"): Trace(
        "n / N, calculated by the spreadsheet", _FIGURE_3,
        of_row=("StartCycles.Cycles", "StartCycles.Cycles to failure"),
    ),
}  # fmt: skip
