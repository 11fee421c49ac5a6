"""Scalars of sheet `Case`: names, keys, units, choices and help texts."""

from __future__ import annotations

from addin.contract.field import Field, choice, integer, number, text
from engine.case.choices import ContactLaw

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
    text("TemplateVersion", "Layout of this workbook; leave it as it is.", group=_DOCUMENT),
    text("Title", "Title of the calculation.", group=_DOCUMENT),
    text("Tag", "Equipment tag of the train.", group=_DOCUMENT),
    text("Client", "For whom the calculation is made.", group=_DOCUMENT),
    text("Document", "Document number.", group=_DOCUMENT),
    text("Revision", "Revision of the document.", group=_DOCUMENT),
    text("PreparedBy", "Who prepared the calculation.", group=_DOCUMENT),
    text("CheckedBy", "Who checked the calculation.", group=_DOCUMENT),
    number(
        "LineFrequency",
        "frequency",
        "Line frequency; two of frequency, speed and poles fix the third.",
        blank="from speed and poles",
        group=_MACHINE,
    ),
    number(
        "SynchronousSpeed",
        "speed",
        "Synchronous speed of the motor.",
        blank="from frequency and poles",
        group=_MACHINE,
    ),
    integer(
        "Poles", "Number of poles (not pairs); blank = from frequency and speed.", group=_MACHINE
    ),
    number(
        "RatedPower",
        "power",
        "Rated power of the motor; power and speed fix the torque.",
        blank="from torque and speed",
        group=_MACHINE,
    ),
    number(
        "RatedTorque",
        "torque",
        "Rated torque, the base of every torque typed in pu or %.",
        blank="from power and speed",
        us="lbf*ft",
        group=_MACHINE,
    ),
    number(
        "MinimumSpeed",
        "running speed",
        "Lowest speed of continuous operation; % means of synchronous speed.",
        blank="synchronous speed",
        group=_RUNNING,
    ),
    number(
        "MaximumSpeed",
        "running speed",
        "Highest speed of continuous operation; % means of synchronous speed.",
        blank="synchronous speed",
        group=_RUNNING,
    ),
    number(
        "DampingRatio",
        "fraction",
        "Damping of all elastic modes as a fraction of critical; table ModeDamping overrides it.",
        group=_RUNNING,
    ),
    choice(
        "MarginBasis",
        ("calculated", "measured"),
        "Calculated frequencies need a margin of 20 %, measured ones 10 %.",
        blank="calculated",
        group=_RUNNING,
    ),
    number(
        "MarginRequired",
        "fraction",
        "Required separation margin, when it differs from 20 % (calculated) or 10 % (measured).",
        blank="20 % calculated, 10 % measured",
        group=_RUNNING,
    ),
    choice(
        "StressBasis",
        ("peak-to-peak", "zero-to-peak"),
        "Which stress is compared with UTS/25; both are shown.",
        blank="peak-to-peak",
        group=_RUNNING,
    ),
    number(
        "EndSpeed",
        "running speed",
        "Speed at which the simulated start ends; % means of synchronous speed.",
        blank="97 % of synchronous speed",
        us="%",
        si="%",
        group=_START,
    ),
    number(
        "MaximumTime",
        "time",
        "Longest simulated time. A start still on its way then has the outcome time out, with its "
        "speed, and its starts are not judged; one that settles or arrives ends by itself before.",
        blank="600 s, or to the end of TorqueTime",
        group=_START,
    ),
    number("StartsRequired", "count", "Starts the train must survive.", group=_START),
    number(
        "StartsFactor",
        "ratio",
        "Allowable starts are divided by it before they are judged.",
        blank="1",
        group=_START,
    ),
    number(
        "PulsationPhase",
        "angle",
        "Phase of the torque pulsation at t = 0.",
        blank="0",
        group=_START,
    ),
    number(
        "Voltage",
        "fraction",
        "Voltage during the start in % of the voltage of the torque curves; torques go with its "
        "square.",
        blank="100 %",
        group=_START,
    ),
    number(
        "TolerancePeak",
        "fraction",
        "Wanted accuracy of peak torques.",
        blank="0.1 %",
        group=_METHOD,
    ),
    number(
        "ToleranceStarts",
        "fraction",
        "Wanted accuracy of allowable starts.",
        blank="2 %",
        group=_METHOD,
    ),
    choice(
        "Method",
        ("exponential", "newmark"),
        "Time integration: exponential, or the paper's average acceleration (Newmark).",
        blank="exponential",
        group=_METHOD,
    ),
    choice(
        "RainflowResidue",
        ("half cycles", "repeated"),
        "What becomes of the unclosed part of the stress history: ASTM half cycles, or repeated.",
        blank="half cycles",
        group=_METHOD,
    ),
    choice(
        "KeepHistory",
        ("no", "parquet", "npz"),
        "Write the full torque history to a file beside the workbook.",
        blank="no",
        group=_METHOD,
    ),
    choice(
        "ContactLaw",
        tuple(ContactLaw),
        "Damping while teeth touch: it never pulls and never exceeds the spring force (limited), or "
        "it only never pulls (no adhesion).",
        blank=ContactLaw.LIMITED,
        group=_EFFECTS,
    ),
    number(
        "ShockAmplitude",
        "torque",
        "Electrical transient at breaker closing: a torque of line frequency that begins with this "
        "amplitude and decays.",
        blank="no transient",
        us="pu",
        si="pu",
        group=_EFFECTS,
    ),
    number(
        "ShockTimeConstant",
        "time",
        "Time in which the transient at breaker closing decays to 37 %.",
        group=_EFFECTS,
    ),
    number(
        "FieldSlip",
        "fraction",
        "Slip at which the field is applied; with PullOutTorque it calls for pull-in.",
        blank="no field, the start ends at EndSpeed",
        group=_EFFECTS,
    ),
    number(
        "FieldTimeConstant",
        "time",
        "Time constant with which the synchronising torque builds up after the field is applied.",
        blank="at once",
        group=_EFFECTS,
    ),
    number(
        "FieldAngle",
        "angle",
        "Load angle at which the field is applied once the slip has fallen to FieldSlip.",
        blank="as soon as the slip is reached",
        group=_EFFECTS,
    ),
    number(
        "PullOutTorque",
        "torque",
        "Synchronising torque at a load angle of 90 degrees with full field.",
        us="pu",
        si="pu",
        group=_EFFECTS,
    ),
    number(
        "PullInDamping",
        "torsional damping",
        "Damper torque over slip speed after the field is applied, instead of the Average curve.",
        blank="the Average curve",
        group=_EFFECTS,
    ),
    number(
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
