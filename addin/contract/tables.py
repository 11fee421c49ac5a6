"""The one table of inputs and outputs: names, keys, units, choices, sheets and help texts.

Workbook templates, the reader, the writer, both JSON forms and their schemas are made from it.
The names are those of the contract; a `key` is the JSON key, an `attribute` the name of the same
quantity in `engine.case.data`. Nothing here converts or checks a number: see `addin.contract.units`.
"""

from __future__ import annotations

from dataclasses import replace

from addin.contract.field import (
    DIMENSIONS,
    Dimension,
    Field,
    TableSpec,
    json_key,
    traced,
)
from addin.contract.field import choice as _choice
from addin.contract.field import integer as _integer
from addin.contract.field import mixed as _mixed
from addin.contract.field import number as _number
from addin.contract.field import table as _table
from addin.contract.field import text as _text
from addin.contract.result_tables import SHARE_MODES, TRACES
from addin.contract.studies.fields import STUDY_INPUT_TABLES, STUDY_RESULT_TABLES
from engine.case.choices import ContactLaw, EffectChoice
from engine.case.effects import EFFECTS

__all__ = [
    "DIMENSIONS",
    "Dimension",
    "EVERY_INPUT",
    "EVERY_TABLE",
    "Field",
    "INPUT_TABLES",
    "RESULT_TABLES",
    "SCALARS",
    "SCALAR_SHEET",
    "SCALAR_TABLE",
    "SHARE_MODES",
    "STUDY_INPUT_TABLES",
    "STUDY_RESULT_TABLES",
    "TEMPLATE_VERSION",
    "TableSpec",
    "WORKBOOK_TABLES",
    "input_table",
    "json_key",
    "result_table",
    "scalar",
]

#: Version of the workbook layout, written into `TemplateVersion` of every shipped workbook.
TEMPLATE_VERSION = "1"

#: Sheet of the scalars, and the table name problems of scalars carry.
SCALAR_SHEET = "Case"
SCALAR_TABLE = "Case"

_DOCUMENT = "Document"
_MACHINE = "Motor and line"
_RUNNING = "Continuous operation"
_START = "Start-up"
_METHOD = "Accuracy and method"
_EFFECTS = "Effects"

#: Scalars of sheet `Case`, in the order in which they stand there.
SCALARS: tuple[Field, ...] = (
    _text("TemplateVersion", "Layout of this workbook; leave it as it is.", group=_DOCUMENT),
    _text("Title", "Title of the calculation.", group=_DOCUMENT),
    _text("Tag", "Equipment tag of the train.", group=_DOCUMENT),
    _text("Client", "For whom the calculation is made.", group=_DOCUMENT),
    _text("Document", "Document number.", group=_DOCUMENT),
    _text("Revision", "Revision of the document.", group=_DOCUMENT),
    _text("PreparedBy", "Who prepared the calculation.", group=_DOCUMENT),
    _text("CheckedBy", "Who checked the calculation.", group=_DOCUMENT),
    _number(
        "LineFrequency",
        "frequency",
        "Line frequency; two of frequency, speed and poles fix the third.",
        blank="from speed and poles",
        group=_MACHINE,
    ),
    _number(
        "SynchronousSpeed",
        "speed",
        "Synchronous speed of the motor.",
        blank="from frequency and poles",
        group=_MACHINE,
    ),
    _integer(
        "Poles", "Number of poles (not pairs); blank = from frequency and speed.", group=_MACHINE
    ),
    _number(
        "RatedPower",
        "power",
        "Rated power of the motor; power and speed fix the torque.",
        blank="from torque and speed",
        group=_MACHINE,
    ),
    _number(
        "RatedTorque",
        "torque",
        "Rated torque, the base of every torque typed in pu or %.",
        blank="from power and speed",
        us="lbf*ft",
        group=_MACHINE,
    ),
    _number(
        "MinimumSpeed",
        "running speed",
        "Lowest speed of continuous operation; % means of synchronous speed.",
        blank="synchronous speed",
        group=_RUNNING,
    ),
    _number(
        "MaximumSpeed",
        "running speed",
        "Highest speed of continuous operation; % means of synchronous speed.",
        blank="synchronous speed",
        group=_RUNNING,
    ),
    _number(
        "DampingRatio",
        "fraction",
        "Damping of all elastic modes as a fraction of critical; table ModeDamping overrides it.",
        group=_RUNNING,
    ),
    _choice(
        "MarginBasis",
        ("calculated", "measured"),
        "Calculated frequencies need a margin of 20 %, measured ones 10 %.",
        blank="calculated",
        group=_RUNNING,
    ),
    _number(
        "MarginRequired",
        "fraction",
        "Required separation margin, when it differs from 20 % (calculated) or 10 % (measured).",
        blank="20 % calculated, 10 % measured",
        group=_RUNNING,
    ),
    _choice(
        "StressBasis",
        ("peak-to-peak", "zero-to-peak"),
        "Which stress is compared with UTS/25; both are shown.",
        blank="peak-to-peak",
        group=_RUNNING,
    ),
    _number(
        "EndSpeed",
        "running speed",
        "Speed at which the simulated start ends; % means of synchronous speed.",
        blank="97 % of synchronous speed",
        us="%",
        si="%",
        group=_START,
    ),
    _number(
        "MaximumTime",
        "time",
        "Longest simulated time. A start still on its way then has the outcome time out, with its "
        "speed, and its starts are not judged; one that settles or arrives ends by itself before.",
        blank="600 s, or to the end of TorqueTime",
        group=_START,
    ),
    _number("StartsRequired", "count", "Starts the train must survive.", group=_START),
    _number(
        "StartsFactor",
        "ratio",
        "Allowable starts are divided by it before they are judged.",
        blank="1",
        group=_START,
    ),
    _number(
        "PulsationPhase",
        "angle",
        "Phase of the torque pulsation at t = 0.",
        blank="0",
        group=_START,
    ),
    _number(
        "Voltage",
        "fraction",
        "Voltage during the start in % of the voltage of the torque curves; torques go with its "
        "square.",
        blank="100 %",
        group=_START,
    ),
    _number(
        "TolerancePeak",
        "fraction",
        "Wanted accuracy of peak torques.",
        blank="0.1 %",
        group=_METHOD,
    ),
    _number(
        "ToleranceStarts",
        "fraction",
        "Wanted accuracy of allowable starts.",
        blank="2 %",
        group=_METHOD,
    ),
    _choice(
        "Method",
        ("exponential", "newmark"),
        "Time integration: exponential, or the paper's average acceleration (Newmark).",
        blank="exponential",
        group=_METHOD,
    ),
    _choice(
        "RainflowResidue",
        ("half cycles", "repeated"),
        "What becomes of the unclosed part of the stress history: ASTM half cycles, or repeated.",
        blank="half cycles",
        group=_METHOD,
    ),
    _choice(
        "KeepHistory",
        ("no", "parquet", "npz"),
        "Write the full torque history to a file beside the workbook.",
        blank="no",
        group=_METHOD,
    ),
    _choice(
        "ContactLaw",
        tuple(ContactLaw),
        "Damping while teeth touch: it never pulls and never exceeds the spring force (limited), or "
        "it only never pulls (no adhesion).",
        blank=ContactLaw.LIMITED,
        group=_EFFECTS,
    ),
    _number(
        "ShockAmplitude",
        "torque",
        "Electrical transient at breaker closing: a torque of line frequency that begins with this "
        "amplitude and decays.",
        blank="no transient",
        us="pu",
        si="pu",
        group=_EFFECTS,
    ),
    _number(
        "ShockTimeConstant",
        "time",
        "Time in which the transient at breaker closing decays to 37 %.",
        group=_EFFECTS,
    ),
    _number(
        "FieldSlip",
        "fraction",
        "Slip at which the field is applied; with PullOutTorque it calls for pull-in.",
        blank="no field, the start ends at EndSpeed",
        group=_EFFECTS,
    ),
    _number(
        "FieldTimeConstant",
        "time",
        "Time constant with which the synchronising torque builds up after the field is applied.",
        blank="at once",
        group=_EFFECTS,
    ),
    _number(
        "FieldAngle",
        "angle",
        "Load angle at which the field is applied once the slip has fallen to FieldSlip.",
        blank="as soon as the slip is reached",
        group=_EFFECTS,
    ),
    _number(
        "PullOutTorque",
        "torque",
        "Synchronising torque at a load angle of 90 degrees with full field.",
        us="pu",
        si="pu",
        group=_EFFECTS,
    ),
    _number(
        "PullInDamping",
        "torsional damping",
        "Damper torque over slip speed after the field is applied, instead of the Average curve.",
        blank="the Average curve",
        group=_EFFECTS,
    ),
    _number(
        "TripSpeed",
        "running speed",
        "Speed at which the motor is tripped and the train coasts down; % means of synchronous "
        "speed.",
        blank="no trip",
        us="%",
        si="%",
        group=_EFFECTS,
    ),
)

_CURVE_SPEED = "Speed in % of that station's speed at synchronism, rising within a station."

#: Input tables, in the order in which problems are reported.
INPUT_TABLES: tuple[TableSpec, ...] = (
    _table(
        "Stations",
        "Train",
        15,
        "Lumped inertias, each at its own speed.",
        _text("Station", "Name of the station, unique in the train."),
        _text("Description", "Free text."),
        _number("Inertia", "inertia", "Polar inertia (WR²) at the station's own speed."),
        _number(
            "Speed ratio",
            "ratio",
            "Speed of the station over the speed of the motor shaft.",
            blank="1",
        ),
        _number(
            "Damping",
            "torsional damping",
            "Viscous damping to ground at the station's own speed.",
            blank="0",
        ),
        _number(
            "Running load",
            "torque",
            "Torque absorbed in continuous operation, at the station's own speed.",
            blank="RatedTorque shared in proportion to LoadTorque, when all are blank",
            us="lbf*ft",
        ),
    ),
    _table(
        "Elements",
        "Train",
        15,
        "Shafts, couplings, gear meshes and springs, each at its own shaft's speed.",
        _text("Element", "Name of the element, unique in the train."),
        _choice(
            "Kind",
            ("shaft", "coupling", "gear mesh", "spring to ground"),
            "What the element is.",
        ),
        _text("From", "Station at the drive end, or ground.", kind="station"),
        _text("To", "Station at the driven end, or ground.", kind="station"),
        _number(
            "Stiffness",
            "torsional stiffness",
            "Torsional stiffness at the shaft's own speed; of a mesh on the From side.",
            blank="from OD, ID and Length; a gear mesh is rigid",
        ),
        _number("OD", "length", "Outer diameter, for stiffness from geometry."),
        _number("ID", "length", "Bore, for stiffness from geometry.", blank="0"),
        _number("Length", "length", "Length, for stiffness from geometry."),
        _number(
            "Shear modulus",
            "pressure",
            "Shear modulus, for stiffness from geometry.",
            si="GPa",
        ),
        _number(
            "Density",
            "density",
            "Density; when given, the shaft's own inertia is distributed along it.",
            blank="shaft without inertia of its own",
        ),
        _number(
            "Damping",
            "torsional damping",
            "Viscous damping across the element.",
            blank="0",
        ),
        _number("Loss factor", "ratio", "Hysteretic loss factor of the element.", blank="0"),
        _number(
            "Stress diameter",
            "length",
            "Diameter of the section where stress is judged.",
            blank="torque only, no stress",
        ),
        _number("Stress bore", "length", "Bore of the section where stress is judged.", blank="0"),
        _number("SCF", "ratio", "Stress concentration factor in torsion.", blank="1"),
        _text("Material", "Row of table Materials.", kind="material"),
        _number("Rated torque", "torque", "The maker's rated torque.", blank="not judged"),
        _number("Peak torque limit", "torque", "The maker's peak torque.", blank="not judged"),
        _number("Reversal limit", "torque", "Allowed reversing torque.", blank="not judged"),
        _number("Vibratory limit", "torque", "Allowed vibratory torque.", blank="not judged"),
    ),
    _table(
        "Meshes",
        "Train",
        4,
        "Gear geometry, clearances and bearings of gear meshes and geared couplings.",
        _text("Element", "The gear mesh or geared coupling of table Elements.", kind="element"),
        _number("Pitch radius drive", "length", "Pitch radius on the From side."),
        _number("Pitch radius driven", "length", "Pitch radius on the To side."),
        _number("Pressure angle", "angle", "Normal pressure angle."),
        _number("Helix angle", "angle", "Helix angle.", blank="0"),
        _number("Orientation", "angle", "Angle of the line of centres.", blank="0"),
        _number(
            "Mesh stiffness",
            "linear stiffness",
            "Mesh stiffness along the line of action.",
            blank="Stiffness of table Elements",
        ),
        _number(
            "Mesh damping",
            "linear damping",
            "Mesh damping along the line of action.",
            blank="Damping of table Elements",
        ),
        _number(
            "Backlash",
            "length",
            "Normal backlash: the total gap between both flanks, square to them; needs a finite mesh "
            "stiffness.",
            blank="teeth always touch",
        ),
        _number(
            "Angular backlash",
            "angle",
            "Total angular clearance of a geared coupling, or of a spring to ground that is a stop.",
            blank="none",
        ),
        _number(
            "Mass drive",
            "mass",
            "Mass of the gear on the From side, where it moves on its bearings.",
            blank="gear does not move sideways",
        ),
        _number(
            "Mass driven",
            "mass",
            "Mass of the gear on the To side, where it moves on its bearings.",
            blank="gear does not move sideways",
        ),
        _number(
            "Bearing stiffness drive",
            "linear stiffness",
            "Stiffness of the From gear's bearings together, the same in all radial directions.",
            blank="rigid",
        ),
        _number(
            "Bearing stiffness driven",
            "linear stiffness",
            "Stiffness of the To gear's bearings together, the same in all radial directions.",
            blank="rigid",
        ),
        _number(
            "Bearing damping drive",
            "linear damping",
            "Damping of the From gear's bearings together.",
            blank="0",
        ),
        _number(
            "Bearing damping driven",
            "linear damping",
            "Damping of the To gear's bearings together.",
            blank="0",
        ),
        _choice(
            "Gear type",
            ("external", "internal"),
            "Internal gears keep the sense of rotation.",
            blank="external",
        ),
    ),
    _table(
        "ModeDamping",
        "Train",
        10,
        "Damping of single elastic modes, instead of DampingRatio.",
        _integer("Mode", "Elastic mode, counted from 1."),
        _number("Damping ratio", "fraction", "Damping of the mode as a fraction of critical."),
    ),
    _table(
        "MotorTorque",
        "Torque",
        30,
        "Motor torque against speed at rated voltage, the same curve the maker gives.",
        _text("Station", "Where the motor acts.", kind="station"),
        _number("Speed", "speed fraction", _CURVE_SPEED),
        _number("Average", "torque", "Average torque.", us="%", si="%"),
        _number(
            "Pulsating",
            "torque",
            "Pulsating torque at twice slip frequency, zero-to-peak.",
            us="%",
            si="%",
        ),
    ),
    _table(
        "LoadTorque",
        "Torque",
        40,
        "Torque of the driven machines against speed.",
        _text("Station", "Where the load acts.", kind="station"),
        _number("Speed", "speed fraction", _CURVE_SPEED),
        _number(
            "Torque",
            "torque",
            "Opposing torque at that station's own speed.",
            us="lbf*ft",
        ),
    ),
    _table(
        "TorqueTime",
        "Torque",
        20,
        "Optional: prescribed torque against time, linear between rows.",
        _text("Station", "Where the torque acts.", kind="station"),
        _number("Time", "time", "Time, rising within a station."),
        _number("Torque", "torque", "Torque in the running direction.", us="lbf*ft"),
    ),
    _table(
        "Materials",
        "Fatigue",
        5,
        "Strength of the shaft materials.",
        _text("Material", "Name of the material."),
        _number("UTS", "pressure", "Ultimate tensile strength."),
        _number("Yield", "pressure", "Yield strength in tension; half of it in shear is judged."),
        _number(
            "Endurance",
            "pressure",
            "Endurance limit (amplitude) in the basis given.",
            blank="none",
        ),
        _choice(
            "Basis",
            ("torsion", "bending"),
            "Bending data are halved for torsion.",
            blank="torsion",
        ),
        _choice(
            "Below endurance",
            ("none", "same slope", "2k-1"),
            "Damage below the endurance limit.",
            blank="none",
        ),
    ),
    _table(
        "SNPoints",
        "Fatigue",
        12,
        "S-N line of each material, log-log between the points.",
        _text("Material", "Row of table Materials.", kind="material"),
        _number("Cycles", "count", "Cycles to failure, rising within a material."),
        _number("Stress", "pressure", "Stress amplitude, zero-to-peak."),
    ),
    _table(
        "Excitations",
        "Excitation",
        14,
        "What shakes the train in continuous operation; blank = 1× and 2× of every shaft speed, "
        "1× and 2× line frequency.",
        _text("Name", "Name of the excitation."),
        _number("Order", "ratio", "Multiple of a station's speed."),
        _text("Of station", "Whose speed.", kind="station", blank="the motor shaft"),
        _number("Frequency", "frequency", "Fixed frequency, instead of an order."),
        _text(
            "Station",
            "Where it acts.",
            kind="station",
            blank="motor, gears and driven machines in turn",
        ),
        _number(
            "Torque",
            "excitation torque",
            "Zero-to-peak torque; % means of the torque transmitted there, pu of RatedTorque.",
            blank="1 % of the torque transmitted there",
        ),
    ),
    _table(
        "EffectChoices",
        "Case",
        len(EFFECTS),
        "Effects forced on or off; a blank choice leaves it to the plan.",
        _choice("Effect", tuple(EFFECTS), "Name of the effect."),
        _choice(
            "Choice",
            tuple(EffectChoice),
            "on and off force the effect; auto lets the plan decide.",
            blank="auto: the row states nothing",
        ),
        states="Choice",
    ),
)


#: Result tables of this version.
RESULT_TABLES: tuple[TableSpec, ...] = traced(
    (
        _table(
            "Verdicts",
            "Summary",
            1,
            "Each check with its limit and verdict.",
            _text("Check", "What is judged."),
            _mixed("Result", "The number found."),
            _mixed("Limit", "The number allowed."),
            _text("Verdict", "pass, accepted by forced response, or fail."),
            _text("Where", "Mode, element or speed that governs."),
            json_only=("dimension",),
        ),
        _table(
            "NaturalFrequencies",
            "Frequencies",
            1,
            "Undamped natural frequencies; rigid-body modes first, with frequency 0.",
            _integer("Mode", "Elastic modes count from 1; rigid-body modes have 0."),
            _number("Frequency", "frequency", "Natural frequency."),
            _number("CPM", "cycles per minute", "Natural frequency in cycles per minute."),
            _number("Percent speed", "fraction", "Speed of the start-up crossing, of synchronous."),
            _number("Damping ratio", "fraction", "Fraction of critical damping in the start."),
            _text("Largest strain energy", "Element with the largest share.", kind="element"),
            _number("Share", "fraction", "Its share of the strain energy."),
            extra_columns=(
                _number("Percent speed check", "fraction", "Live formula: 1 - f / (2 f_line)."),
            ),
        ),
        _table(
            "ModeShapes",
            "Frequencies",
            1,
            "Twist of each station, largest = 1; no twist where a gear only moves sideways.",
            _text("Station", "Station.", kind="station"),
            repeated=_number("Mode", "ratio", "Twist of the station in this mode."),
        ),
        _table(
            "SeparationMargins",
            "Margins",
            1,
            "Every mode against every continuous excitation.",
            _integer("Mode", "Elastic mode."),
            _text("Excitation", "Name of the excitation."),
            _number("Speed", "speed", "Motor speed at which the margin is least."),
            _number("Excitation frequency", "frequency", "Its frequency there."),
            _number("Margin", "fraction", "|f - f_exc| / f_exc."),
            _number("Required", "fraction", "Required margin."),
            _text("Verdict", "pass, accepted by forced response, or fail."),
            json_only=("frequency",),
            extra_columns=(
                _number("Margin check", "fraction", "Live formula: |f - f_exc| / f_exc."),
            ),
        ),
        _table(
            "SteadyState",
            "Steady state",
            1,
            "Forced response; stresses include SCF.",
            _text("Element", "Element.", kind="element"),
            _text("Excitation", "Name of the excitation."),
            _integer("Mode", "Mode excited."),
            _number("Frequency", "frequency", "Frequency of the worst response."),
            _text("Applied at", "Station of the applied torque.", kind="station"),
            _number("Applied torque", "torque", "Applied torque, zero-to-peak.", us="lbf*ft"),
            _number(
                "Torque", "torque", "Response torque, zero-to-peak, at own speed.", us="lbf*ft"
            ),
            _number("Zero-to-peak stress", "pressure", "Shear stress amplitude with SCF."),
            _number("Peak-to-peak stress", "pressure", "Shear stress range with SCF."),
            _number("Allowable", "pressure", "UTS/25."),
            _text("Verdict", "pass, fail, unbounded or not judged."),
            json_only=("torque_limit",),
            extra_columns=(_number("UTS/25 check", "pressure", "Live formula: UTS / 25."),),
        ),
        _table(
            "StartupPeaks",
            "Start-up",
            1,
            "Extremes from rest to the end of the run, torques at own speed, stress nominal without SCF.",
            _text("Element", "Element.", kind="element"),
            _number("Maximum torque", "torque", "Largest torque.", us="lbf*ft"),
            _number("Minimum torque", "torque", "Smallest torque.", us="lbf*ft"),
            _number("Peak-to-peak torque", "torque", "Maximum minus minimum.", us="lbf*ft"),
            _number("Peak-to-peak stress", "pressure", "Nominal shear stress range, without SCF."),
            _number("Time", "time", "Time of the largest torque."),
            _number("Percent speed", "fraction", "Speed at that time, of synchronous."),
            _number("Error", "fraction", "Estimated relative error of the peak."),
        ),
        _table(
            "StartupCrossings",
            "Start-up",
            1,
            "Where 2 × slip frequency crosses each mode.",
            _integer("Mode", "Elastic mode."),
            _number("Frequency", "frequency", "Natural frequency."),
            _number("Percent speed", "fraction", "Speed of the crossing, of synchronous."),
            _number("Time", "time", "Time of the crossing."),
            _number("Average torque", "torque", "Average motor torque there.", us="lbf*ft"),
            _number(
                "Pulsating torque", "torque", "Pulsating torque there, zero-to-peak.", us="lbf*ft"
            ),
            _number(
                "Load torque", "torque", "Load torque there, referred to motor speed.", us="lbf*ft"
            ),
            _number("Acceleration", "angular acceleration", "Acceleration of the motor there."),
            _number("Sweep rate", "sweep rate", "How fast 2 × slip frequency falls."),
            _text(
                "Governing element", "Element with the largest stress or torque.", kind="element"
            ),
            _number(
                "Peak-to-peak torque", "torque", "Its torque range at the crossing.", us="lbf*ft"
            ),
            _number("Peak-to-peak stress", "pressure", "Its nominal stress range at the crossing."),
            _number(
                "Mesh minimum torque", "torque", "Least mesh torque at the crossing.", us="lbf*ft"
            ),
            _text("Note", "What the numbers say, in words."),
        ),
        _table(
            "AllowableStarts",
            "Starts",
            1,
            "Fatigue damage of one start and how many are allowed.",
            _text("Element", "Element.", kind="element"),
            _number("Damage", "count", "Miner sum of one start."),
            _number(
                "Allowable starts",
                "count",
                "1 / damage; unlimited when there is no damage, not judged when the start "
                "did not come to its end.",
            ),
            _number(
                "Paper count", "count", "Allowable starts by the paper's cycle-by-cycle count."
            ),
            _number("Error", "fraction", "Estimated relative error of the allowable starts."),
            _text("Governing", "yes for the element that allows the fewest starts.", kind="flag"),
            extra_columns=(
                _number("Starts check", "count", "Live formula: 1 / damage."),
                _number(
                    "Starts to judge",
                    "count",
                    "Live formula: 1 / damage / StartsFactor, rounded down to whole starts.",
                ),
            ),
            json_only=("unlimited", "starts_low", "starts_high"),
        ),
        _table(
            "TorqueReversals",
            "Reversals",
            1,
            "Each gear mesh and geared coupling in the start, at its From side.",
            _text("Element", "Gear mesh or geared coupling.", kind="element"),
            _number("Minimum torque", "torque", "Least torque in the start.", us="lbf*ft"),
            _integer(
                "Reversals", "How often the torque falls below zero, by the hysteresis below."
            ),
            _number("Time unloaded", "time", "Total time of reversed torque, or without contact."),
            _integer(
                "Impacts", "How often teeth meet again; blank where no clearance is modelled."
            ),
            _number("Recontact speed", "approach speed", "Largest approach speed of the flanks."),
            _number("Tooth force", "force", "Largest normal tooth force."),
            _number("Longest reversal", "time", "Longest single reversal."),
            _number("First time", "time", "When the torque first falls below zero."),
            replace(
                _number(
                    "2 × slip frequency",
                    "frequency",
                    "Frequency of the pulsation, twice the slip frequency, at the least torque; to "
                    "compare with the modes.",
                ),
                key="slip_frequency",  # as it is in the JSON
            ),
            _number("Transmitted torque", "torque", "Torque in continuous operation.", us="lbf*ft"),
            _number(
                "Margin", "fraction", "Least torque over the transmitted torque; < 0 reverses."
            ),
            _number(
                "Limit", "torque", "The maker's Reversal limit of table Elements.", us="lbf*ft"
            ),
            _text("Verdict", "pass, fail or not judged."),
            _number(
                "Recontact speed angular",
                "angular approach speed",
                "The recontact speed as relative angular speed of the From side.",
            ),
            _text("Model", "linear, or clearance where the teeth may part."),
            _text("Note", "What was found, in words."),
            extra_columns=(
                _number("Margin check", "fraction", "Live formula: minimum / transmitted torque."),
            ),
        ),
        _table(
            "Effects",
            "Effects",
            len(EFFECTS),
            "What was simulated and what was left out, each with the number that decided it.",
            _text("Effect", "What may be simulated."),
            _text("Choice", "What was chosen in EffectChoices: auto, on or off."),
            _text("On", "Whether it was simulated.", kind="flag"),
            _number("Deciding number", "deciding number", "The number that decided."),
            _number("Limit", "deciding number", "What it was compared with."),
            _number("Bound", "fraction", "Most that leaving it out changes an answer; 0 = exact."),
            _number(
                "Time",
                "calculation time",
                "What it cost, or would cost when on: measured where it has a run of its own (backlash, "
                "pull-in and aborted start share one), else estimated from the linear start.",
            ),
            _text("Why", "The decision in words."),
        ),
        _table(
            "AccuracyCost",
            "Accuracy",
            1,
            "Error against wall time of this case on this machine.",
            _text("Method", "Method of the time integration, or the analysis."),
            _text("Setting", "Wanted tolerance or step."),
            _number("Error peak", "fraction", "Error of the peak torques."),
            _number("Error starts", "fraction", "Error of the allowable starts."),
            _number("Time", "calculation time", "Wall time, in a study the median of repeats."),
        ),
        _table(
            "Audit",
            "Audit",
            1,
            "What was calculated, from which inputs, by which version and method.",
            _text("Item", "What is stated."),
            _mixed("Value", "Its value."),
        ),
    ),
    TRACES,
)

#: Tables of the workbook alone, beside the results of the contract; the JSON has none of them.
WORKBOOK_TABLES: tuple[TableSpec, ...] = traced(
    (
        _table(
            "StartCycles",
            "Starts",
            1,
            "Largest damage first; a row without amplitude holds all other cycles.",
            _number("Amplitude", "pressure", "Stress amplitude of a cycle, with SCF."),
            _number("Cycles", "count", "n: how often in one start; 0.5 is a half cycle."),
            _number("Cycles to failure", "count", "N at this amplitude on the S-N line."),
            _number("Damage", "count", "n / N as calculated."),
            extra_columns=(_number("Damage check", "count", "Live formula: n / N."),),
        ),
        _table(
            "BearingForces",
            "Reversals",
            1,
            "Largest radial force of each gear that moves on its bearings, without weight.",
            _text("Station", "The gear.", kind="station"),
            _number("Force", "force", "Largest vibratory and transmitted force together."),
            _number("Time", "time", "When."),
        ),
        _table(
            "EnergyShares",
            "Frequencies",
            1,
            "What the change above does: ± ½ × share × change × f, + of stiffnesses, − of inertias.",
            _text("Quantity", "stiffness or inertia; bearing stiffness, sideways mass of gears."),
            _text("Of", "Element or station."),
            *(
                _number(
                    f"Share {mode}",
                    "count",
                    f"Its share of the strain or kinetic energy of mode {mode}.",
                )
                for mode in range(1, SHARE_MODES + 1)
            ),
            extra_columns=tuple(
                _number(
                    f"Shift {mode}",
                    "frequency",
                    f"Live formula: ± 1/2 × Share {mode} × change × frequency of mode {mode}, in Hz.",
                )
                for mode in range(1, SHARE_MODES + 1)
            ),
        ),
        _table(
            "Plans",
            "Effects",
            1,
            "The last plan is the one whose results are shown; a run that proves a plan wrong makes a "
            "new one.",
            _integer("Plan", "Counted from 1."),
            _text("Reason", "Why it was made."),
        ),
    ),
    TRACES,
)


def scalar(name: str) -> Field:
    """The scalar of a defined name."""
    return _SCALARS[name]


def input_table(name: str) -> TableSpec:
    """The input table of a name."""
    return _INPUTS[name]


def result_table(name: str) -> TableSpec:
    """The result table of a name."""
    return _RESULTS[name]


#: Every table that a workbook may have.
EVERY_TABLE: tuple[TableSpec, ...] = (
    *INPUT_TABLES,
    *RESULT_TABLES,
    *WORKBOOK_TABLES,
    *STUDY_INPUT_TABLES,
    *STUDY_RESULT_TABLES,
)
#: Those that the engineer fills in.
EVERY_INPUT: tuple[TableSpec, ...] = (*INPUT_TABLES, *STUDY_INPUT_TABLES)

_SCALARS = {field.name: field for field in SCALARS}
_INPUTS = {table.name: table for table in EVERY_INPUT}
_RESULTS = {table.name: table for table in (*RESULT_TABLES, *STUDY_RESULT_TABLES)}
