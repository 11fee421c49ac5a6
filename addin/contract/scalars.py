"""Scalars of sheet `Case`: names, keys, units, choices and help texts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from addin.contract.field import Field, choice, integer, number, text
from engine.case import choices

#: Version of the workbook layout, written into `TemplateVersion` of every shipped workbook.
TEMPLATE_VERSION = "1"

#: Sheet of the scalars, and the table name problems of scalars carry.
SCALAR_SHEET = "Case"
SCALAR_TABLE = "Case"

#: Scalars of sheet `Case` by their block on it, in the order in which they stand there.
_BY_GROUP: Mapping[str, tuple[Field, ...]] = {
    "Document": (
        text("TemplateVersion", "Version of the workbook layout; do not change it."),
        text("Title", "Title of the calculation."),
        text("Tag", "Equipment tag of the train."),
        text("Client", "For whom the calculation is made."),
        text("Document", "Document number."),
        text("Revision", "Revision of the document."),
        text("PreparedBy", "Who prepared the calculation."),
        text("CheckedBy", "Who checked the calculation."),
    ),
    "Motor and line": (
        number(
            "LineFrequency",
            "frequency",
            "Line frequency; two of LineFrequency, SynchronousSpeed and Poles give the third.",
            blank="from speed and poles",
        ),
        number(
            "SynchronousSpeed",
            "speed",
            "Synchronous speed of the motor.",
            blank="from frequency and poles",
        ),
        integer("Poles", "Number of poles (not pairs); blank = from frequency and speed."),
        number(
            "RatedPower",
            "power",
            "Rated power of the motor, of several motors together; with the speed it gives the rated torque.",
            blank="from torque and speed",
        ),
        number(
            "RatedTorque",
            "torque",
            "Rated torque, of several motors together; base of torques in pu or % (in table Excitations 100 % = "
            "the torque transmitted there).",
            blank="from power and speed",
            us="lbf*ft",
        ),
    ),
    "Continuous operation": (
        number(
            "MinimumSpeed",
            "running speed",
            "Lowest speed of continuous operation; 100 % = synchronous speed.",
            blank="synchronous speed",
        ),
        number(
            "MaximumSpeed",
            "running speed",
            "Highest speed of continuous operation; 100 % = synchronous speed.",
            blank="synchronous speed",
        ),
        number(
            "DampingRatio",
            "fraction",
            "Damping of all elastic modes as a fraction of critical; table ModeDamping overrides it.",
        ),
        number(
            "DampingRange",
            "fraction",
            "Share by which all damping may be smaller; forced response is judged down to there.",
            blank="0 %",
        ),
        choice(
            "Standard",
            tuple(choices.Standard),
            "Who says which margins and analyses are needed. Szenasi: 20 % for calculated, 10 % for measured "
            "frequencies. API 617 and API 541/546: 10 %. own: MarginRequired. Blank: no analysis is asked for.",
            blank="margins as Szenasi",
        ),
        choice(
            "MarginBasis",
            tuple(choices.MarginBasis),
            "Whether frequencies are calculated or measured; measured ones need less margin where the standard says so.",
            blank="calculated",
        ),
        number(
            "MarginRequired",
            "fraction",
            "Required separation margin, when it differs from that of the standard.",
            blank="by Standard and MarginBasis",
        ),
        choice(
            "StressBasis",
            tuple(choices.StressBasis),
            "Which stress is compared with UTS/25; both are shown.",
            blank="peak-to-peak",
        ),
    ),
    "Start-up": (
        number(
            "EndSpeed",
            "running speed",
            "Speed at which the simulated start ends; 100 % = synchronous speed.",
            blank="97 % of synchronous speed",
            us="%",
            si="%",
        ),
        number(
            "MaximumTime",
            "time",
            "Longest simulated time. A start that is not completed by then has the outcome time "
            "out, and its allowable starts are not judged; one that reaches its end speed or "
            "settles ends earlier.",
            blank="600 s, or to the end of TorqueTime",
        ),
        choice(
            "InitialState",
            tuple(choices.InitialState),
            "Where torques of table TorqueTime begin: rest, with the start; running, as an event in operation "
            "(sheet Torque and motor), added to the torques of the train at synchronous speed.",
            blank="rest",
        ),
        choice(
            "TorqueFollows",
            tuple(choices.TorqueFollows),
            "Speed at which motor curves are read: mean speed, of the rigid shaft line; own speed, with the vibration; "
            "machine: mean speed, each mode damped as the motor's data say.",
            blank="mean speed",
        ),
        number("StartsRequired", "count", "Starts the train must survive."),
        number(
            "StartsFactor",
            "ratio",
            "Safety factor: allowable starts are divided by it before comparison with "
            "StartsRequired.",
            blank="1",
        ),
        number(
            "PulsationPhase",
            "angle",
            "Phase of the torque pulsation at t = 0; worst: of 36 phases in a turn.",
            blank="0",
            choices=tuple(choices.Scanned),
        ),
        number(
            "Voltage",
            "fraction",
            "Voltage during the start in % of the voltage of the torque curves; torques are "
            "proportional to its square.",
            blank="100 %",
        ),
    ),
    "Accuracy and method": (
        number(
            "TolerancePeak",
            "fraction",
            "Wanted accuracy of peak torques.",
            blank="0.1 %",
        ),
        number(
            "ToleranceStarts",
            "fraction",
            "Wanted accuracy of allowable starts.",
            blank="2 %",
        ),
        choice(
            "Method",
            tuple(choices.Method),
            "Time integration: exponential, or newmark (average acceleration, Szenasi & von "
            "Nimitz).",
            blank="exponential",
        ),
        choice(
            "RainflowResidue",
            tuple(choices.RainflowResidue),
            "Rainflow residue: counted as half cycles (ASTM), or the history repeated.",
            blank="half cycles",
        ),
        choice(
            "MeanStress",
            tuple(choices.MeanStress),
            "Mean stress of a cycle in fatigue: none = ignored; Goodman = with the ultimate strength in torsion, "
            "0.67 UTS.",
            blank="none",
        ),
        choice(
            "KeepHistory",
            tuple(choices.HistoryFile),
            "Write the full torque history to a file beside the workbook.",
            blank="no",
        ),
    ),
    "Effects": (
        choice(
            "ContactLaw",
            tuple(choices.ContactLaw),
            "Damping of teeth in contact: limited = the contact force never pulls and damping "
            "never exceeds the spring force; no adhesion = the contact force never pulls.",
            blank=choices.ContactLaw.LIMITED,
        ),
        number(
            "ShockAmplitude",
            "torque",
            "Amplitude of the electrical transient at breaker closing, a decaying torque at line "
            "frequency.",
            blank="no transient",
            us="pu",
            si="pu",
        ),
        number(
            "ShockTimeConstant",
            "time",
            "Time in which the transient at breaker closing decays to 37 %.",
        ),
        number(
            "FieldSlip",
            "fraction",
            "Slip at which the field is applied; with PullOutTorque, pull-in is simulated.",
            blank="no field, the start ends at EndSpeed",
        ),
        number(
            "FieldTimeConstant",
            "time",
            "Time constant with which the synchronising torque builds up after the field is applied.",
            blank="at once",
        ),
        number(
            "FieldAngle",
            "angle",
            "Load angle at which the field is applied after the slip has reached FieldSlip.",
            blank="as soon as the slip is reached",
        ),
        number(
            "PullOutTorque",
            "torque",
            "Synchronising torque at a load angle of 90 degrees with full field.",
            us="pu",
            si="pu",
        ),
        number(
            "PullInDamping",
            "torsional damping",
            "Damper-winding torque per unit of slip speed after the field is applied, instead of "
            "the Average curve.",
            blank="the Average curve",
        ),
        number(
            "TripSpeed",
            "running speed",
            "Speed at which the motor is tripped and the train coasts down; 100 % = synchronous "
            "speed.",
            blank="no trip",
            us="%",
            si="%",
        ),
    ),
}

#: All of them.
SCALARS: tuple[Field, ...] = tuple(
    replace(field, group=group) for group, members in _BY_GROUP.items() for field in members
)
