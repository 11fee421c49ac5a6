"""Input tables of a case: names, keys, units, choices, sheets and help texts."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.field import Field, TableSpec, choice, integer, number, sentence, table, text
from engine.case.choices import (
    Begins,
    BelowEndurance,
    Clearing,
    ConditionKind,
    DischargePath,
    EffectChoice,
    ElementKind,
    FieldCircuit,
    GearType,
    MotorEventKind,
    MotorKind,
    NotchKind,
    NotchSensitivity,
    Scanned,
    SizeRule,
    SNBasis,
    Starting,
    SurfaceFinish,
    TimeConstantKind,
    TorqueBase,
)
from engine.case.effects import EFFECTS
from engine.case.steels import STEELS

_LIBRARY = f"{', '.join(s.name for s in STEELS[:-1])} or {STEELS[-1].name}"
_OF_CASE = "as in the case"
_CURVE_SPEED = "Speed in % of the station's synchronous speed, in rising order for each station."


def _of_both_gears(name: str, dimension: str, help: str, blank: str) -> tuple[Field, ...]:
    """A quantity of the gears on the From and on the To side of a mesh, in a column each."""
    return tuple(
        number(f"{name} {gear}", dimension, help.format(side), blank=blank)
        for gear, side in (("drive", "From"), ("driven", "To"))
    )


#: Input tables, in the order in which problems are reported.
INPUT_TABLES: tuple[TableSpec, ...] = (
    table(
        "Stations", sheet="Train", caption="Stations",
        help="Lumped inertias, each at its own speed.",
        rows=15, row_name=("Station",),
        columns=(
            text("Station", "Name of the station, unique in the train."),
            sentence("Description", "Free text."),
            number("Inertia", "inertia", "Polar inertia (WR²) at the station's own speed."),
            number(
                "Speed ratio", "ratio", "Speed of the station divided by the speed of the motor shaft.",
                blank="that of its shaft, of the gears of table Meshes, else 1",
            ),
            number(
                "Damping", "torsional damping",
                "Viscous damping to ground at the station's own speed.", blank="0",
            ),
            number(
                "Running load", "torque",
                "Torque absorbed in continuous operation, at the station's own speed.",
                blank="RatedTorque shared in proportion to LoadTorque, when all are blank",
                us="lbf*ft",
            ),
        ),
    ),
    table(
        "Elements", sheet="Train", caption="Elements",
        help="Shafts, couplings, gear meshes and springs, each at its own shaft's speed.",
        rows=15, row_name=("Element",),
        columns=(
            text("Element", "Name of the element, unique in the train."),
            choice("Kind", tuple(ElementKind), "Kind of element."),
            text("From", "Station at the drive end, or ground.", kind="station"),
            text("To", "Station at the driven end, or ground.", kind="station"),
            number(
                "Stiffness", "torsional stiffness",
                "Torsional stiffness at the shaft's own speed; for a gear mesh, referred to the From "
                "side.",
                blank="from OD, ID and Length; a gear mesh is rigid",
            ),
            number("OD", "length", "Outer diameter, for stiffness from geometry."),
            number("ID", "length", "Bore, for stiffness from geometry.", blank="0"),
            number("Length", "length", "Length, for stiffness from geometry."),
            number(
                "Shear modulus", "pressure", "Shear modulus, for stiffness from geometry.",
                si="GPa",
            ),
            number(
                "Density", "density",
                "Density; when given, the shaft's own inertia is distributed along it.",
                blank="massless shaft",
            ),
            number(
                "Damping", "torsional damping", "Viscous damping across the element.", blank="0",
            ),
            number("Loss factor", "ratio", "Hysteretic loss factor of the element.", blank="0"),
            number(
                "Stress diameter", "length", "Diameter of the section where stress is judged.",
                blank="torque only, no stress",
            ),
            number(
                "Stress bore", "length", "Bore of the section where stress is judged.", blank="0",
            ),
            number("SCF", "ratio", "Stress concentration factor in torsion.", blank="1, or of Notch in FatigueFactors"),
            text("Material", "Name of the material, from table Materials.", kind="material"),
            number(
                "Service factor", "ratio",
                "Rating that is asked of the maker, over the torque in continuous operation.", blank="1",
            ),
            number("Rated torque", "torque", "The maker's rated torque.", blank="not judged"),
            number("Peak torque limit", "torque", "The maker's peak torque.", blank="not judged"),
            number("Reversal limit", "torque", "Allowed reversing torque.", blank="not judged"),
            number("Vibratory limit", "torque", "Allowed vibratory torque.", blank="not judged"),
        ),
    ),
    table(
        "Sections", sheet="Train", caption="Sections",
        help="Optional: lengths of constant section of an element, from From to To; they give its stiffness and its own "
        "inertia.",
        rows=30, row_name=("Element", "Section"), later=True,
        columns=(
            text("Element", "The shaft or coupling of table Elements; a row for each of its sections.", kind="element"),
            text("Section", "Name or number of the section.", blank="its number"),
            number("Length", "length", "Length of the section."),
            number("OD", "length", "Outer diameter."),
            number("End OD", "length", "Outer diameter at the To end, of a tapered section.", blank="OD"),
            number("ID", "length", "Bore.", blank="0"),
            text("Material", "Name of the material, from table SectionMaterials; a steel of table Materials' library is steel.", blank="steel: 79.3 GPa, 7850 kg/m³"),
            number("Fillet", "length", "Fillet radius at the step to the next section.", blank="sharp"),
            number(
                "Penetration", "fraction",
                "Share of the length that twists, of a section inside a hub or a shrink fit: one third by the usual rule.",
                blank="all of it",
            ),
            number("Keyway width", "length", "Width of a keyway along the section.", blank="no keyway"),
            number("Keyway depth", "length", "Depth of the keyway from the crown of the shaft.", blank="no keyway"),
        ),
    ),
    table(
        "SectionMaterials", sheet="Train", caption="Materials of sections",
        help="Where it is not steel of 79.3 GPa and 7850 kg/m³.",
        rows=4, row_name=("Material",), later=True,
        columns=(
            text("Material", "Name of the material."),
            number("Shear modulus", "pressure", "Shear modulus.", si="GPa"),
            number("Density", "density", "Density; 0 for sections that have no inertia of their own."),
            sentence("Source", "Where the two numbers come from."),
        ),
    ),
    table(
        "Meshes", sheet="Train", caption="Meshes",
        help="Gear geometry, clearances and bearings of gear meshes and geared couplings.",
        rows=2, row_name=("Element",),
        columns=(
            text("Element", "The gear mesh or geared coupling of table Elements.", kind="element"),
            number("Pitch radius drive", "length", "Pitch radius on the From side."),
            number("Pitch radius driven", "length", "Pitch radius on the To side."),
            number("Pressure angle", "angle", "Normal pressure angle."),
            number("Helix angle", "angle", "Helix angle.", blank="0"),
            number(
                "Orientation", "angle",
                "Angle of the line of centres From to To, counter-clockwise from axis x.", blank="0",
            ),
            number(
                "Mesh stiffness", "linear stiffness", "Mesh stiffness along the line of action.",
                blank="Stiffness of table Elements",
            ),
            number(
                "Mesh damping", "linear damping", "Mesh damping along the line of action.",
                blank="Damping of table Elements",
            ),
            number(
                "Backlash", "length",
                "Normal backlash: total gap of both flanks, normal to the flanks; needs a finite "
                "mesh stiffness.",
                blank="teeth always touch",
            ),
            number(
                "Angular backlash", "angle",
                "Total angular clearance of a geared coupling, or of a spring to ground used as a "
                "stop.",
                blank="none",
            ),
            *_of_both_gears(
                "Mass", "mass", "Mass of the gear on the {} side, for gears on elastic bearings.",
                "gear does not move laterally",
            ),
            *_of_both_gears(
                "Bearing stiffness", "linear stiffness",
                "Total stiffness of the {} gear's bearings, the same in all radial directions.",
                "rigid",
            ),
            *_of_both_gears(
                "Bearing damping", "linear damping", "Total damping of the {} gear's bearings.", "0",
            ),
            choice(
                "Gear type", tuple(GearType), "Internal gears keep the sense of rotation.",
                blank="external",
            ),
            integer("Teeth drive", "Teeth of the gear on the From side.", blank="not used"),
            integer("Teeth driven", "Teeth of the gear on the To side.", blank="not used"),
            number(
                "Speed ratio", "ratio",
                "Speed of the To side divided by that of the From side; stations behind the gear may then stay blank.",
                blank="from teeth, else pitch radii, else table Stations",
            ),
        ),
    ),
    table(
        "ModeDamping", sheet="Train", caption="Mode damping",
        help="Damping of individual elastic modes; overrides DampingRatio.",
        rows=10, row_name=("Mode",), short_caption=True,
        columns=(
            integer("Mode", "Elastic mode, counted from 1."),
            number("Damping ratio", "fraction", "Damping of the mode as a fraction of critical."),
        ),
    ),
    table(
        "MotorTorque", sheet="Torque and motor", caption="Motor torque",
        help="Motor torque against speed at rated voltage, as on the maker's curve.",
        rows=30, row_name=("Station", "Speed"), short_caption=True,
        columns=(
            text("Station", "Where the motor acts.", kind="station"),
            number("Speed", "speed fraction", _CURVE_SPEED),
            number("Average", "torque", "Average torque.", us="%", si="%"),
            number(
                "Pulsating", "torque", "Pulsating torque at twice slip frequency, zero-to-peak.",
                us="%", si="%",
            ),
            number(
                "Phase", "angle",
                "Phase of the pulsating torque at this speed, beside PulsationPhase: φ of T sin(2 (line − rotor angle) + φ).",
                blank="0 at every speed",
            ),
            number(
                "Pulsation1", "torque",
                "Pulsating torque at slip frequency itself, zero-to-peak, of a one-way discharge path: T of T sin((line − rotor angle) + PulsationPhase / 2).",
                us="%", si="%", blank="none",
            ),
        ),
    ),
    table(
        "MotorData", sheet="Torque and motor", caption="Motor data",
        help="Data sheet of a motor, per unit of its own apparent power and voltage; its torque curves "
        "follow where MotorTorque has no rows of its station.",
        rows=4, row_name=("Station",), later=True,
        columns=(
            text("Station", "Where the motor acts.", kind="station"),
            choice(
                "Kind", tuple(MotorKind), "What the data are of; an induction motor has R1 to X3.",
                blank="synchronous",
            ),
            number(
                "Apparent power", "apparent power", "Rated apparent power: what is per unit refers to it.",
                blank="RatedPower / (Power factor × Efficiency)",
            ),
            number("Voltage", "voltage", "Rated voltage, line to line; needed for data in ohm."),
            number(
                "Power factor", "ratio",
                "At rated power; a synchronous motor's current leads in operation, below 0 it lags. Needed without "
                "Apparent power.",
                signed=True,
            ),
            number("Efficiency", "ratio", "Efficiency at rated power; needed without Apparent power."),
            number("Xd", "per unit", "Synchronous reactance Xd, axis of the poles."),
            number("Xq", "per unit", "Synchronous reactance Xq, between the poles."),
            number("Xd transient", "per unit", "Transient reactance Xd'.", blank="no field winding"),
            number("Xd subtransient", "per unit", "Subtransient reactance Xd''."),
            number("Xq subtransient", "per unit", "Subtransient reactance Xq''."),
            number("Xl", "per unit", "Leakage reactance of the stator."),
            number("Td0 transient", "time", "Time constant Td0' with the stator open."),
            number("Td0 subtransient", "time", "Time constant Td0'' with the stator open."),
            number("Tq0 subtransient", "time", "Time constant Tq0'' with the stator open."),
            number("Td transient", "time", "Td' with the stator short-circuited, instead of Td0'."),
            number("Td subtransient", "time", "Td'' with the stator short-circuited, instead of Td0''."),
            number("Tq subtransient", "time", "Tq'' with the stator short-circuited, instead of Tq0''."),
            choice(
                "Time constants", tuple(TimeConstantKind),
                "classical: by the relations of one winding after the other; measured: as tests show them, roots of the whole circuit.",
                blank="classical",
            ),
            number("Ta", "time", "Time constant of the direct current in the stator."),
            number("Ra", "per unit", "Resistance of the stator, instead of Ta."),
            number(
                "Discharge resistance", "ratio",
                "Resistor across the field in the start, as a multiple of the field's own resistance.",
                blank="field short-circuited",
            ),
            number(
                "Discharge resistance reverse", "ratio",
                "The same for currents against those of the field in operation, where diodes or a thyristor make the path one-way; "
                "or open.",
                blank="the same both ways", choices=tuple(DischargePath),
            ),
            choice(
                "Field circuit", tuple(FieldCircuit), "Whether the field circuit is closed in the start.",
                blank="closed",
            ),
            number(
                "Start factor", "ratio",
                "Factor on the leakages of stator and dampers in the start (saturation).", blank="1",
            ),
            number("R1", "per unit", "Induction motor: resistance of the stator."),
            number("X1", "per unit", "Induction motor: leakage reactance of the stator."),
            number("Xm", "per unit", "Induction motor: magnetising reactance."),
            number("R2", "per unit", "Induction motor: resistance of the cage, seen from the stator."),
            number("X2", "per unit", "Induction motor: leakage reactance of the cage."),
            number("R3", "per unit", "Resistance of a second cage.", blank="no second cage"),
            number("X3", "per unit", "Leakage reactance of a second cage.", blank="no second cage"),
        ),
    ),
    table(
        "MotorCircuit", sheet="Torque and motor", caption="Motor circuit",
        help="Circuit of a motor of table MotorData, instead of its reactances and time constants.",
        rows=4, row_name=("Station",), later=True,
        columns=(
            text("Station", "Station of a row of table MotorData.", kind="station"),
            number("Rs", "per unit", "Resistance of the stator."),
            number("Xl", "per unit", "Leakage reactance of the stator."),
            number("Xmd", "per unit", "Magnetising reactance, axis of the poles."),
            number("Xmq", "per unit", "Magnetising reactance, between the poles."),
            *(
                number(f"{letter}{winding}", "per unit", f"{word} of {which}.", blank="no such winding")
                for winding, which in (
                    ("f", "the field winding"),
                    ("kd", "the damper in the axis of the poles"),
                    ("kq", "the damper between the poles"),
                    ("kd2", "a second damper in the axis of the poles"),
                    ("kq2", "a second damper between the poles"),
                )
                for letter, word in (("R", "Resistance"), ("Xl", "Leakage reactance"))
            ),
            number("Xc", "per unit", "Leakage common to field and dampers (Canay).", blank="0"),
        ),
    ),
    table(
        "SupplyVoltage", sheet="Torque and motor", caption="Voltage against speed",
        help="What the line leaves each motor in the start, over the voltage of its torque curves; torques go with its "
        "square. Scalar Voltage multiplies it.",
        rows=10, row_name=("Station", "Speed"), short_caption=True, later=True,
        columns=(
            text("Station", "Where the motor acts.", kind="station"),
            number("Speed", "speed fraction", _CURVE_SPEED),
            number("Voltage", "fraction", "Voltage at this speed."),
        ),
    ),
    table(
        "Supply", sheet="Torque and motor", caption="Line and starter",
        help="The line of a motor of table MotorData in the start, and what stands between: the voltage at its terminals follows "
        "from its current. A soft starter without Short-circuit power needs no MotorData. Instead of SupplyVoltage.",
        rows=4, row_name=("Station",), short_caption=True, later=True,
        columns=(
            text("Station", "Station of a row of table MotorData; of a soft starter alone, of a motor.", kind="station"),
            number(
                "Short-circuit power", "apparent power", "Three-phase short-circuit power at the motor's terminals.",
                blank="the line does not give way",
            ),
            number("X/R", "ratio", "Reactance over resistance of the line.", blank="no resistance"),
            choice(
                "Starting", tuple(Starting), "What is between the line and the motor up to Switch-over speed.",
                blank="direct",
            ),
            number(
                "Tap", "fraction",
                "Autotransformer: its voltage. Reactor: what it leaves the motor at rest on a line that does not give way.",
            ),
            number(
                "Switch-over speed", "speed fraction",
                "Speed at which the motor is put on the line.",
            ),
            number(
                "Open time", "time", "How long the motor is off the line at the switch-over (open transition).",
                blank="no interruption",
            ),
            number("Initial voltage", "fraction", "Soft start: voltage at closing."),
            number("Ramp time", "time", "Soft start: how long the voltage rises to the full one, in proportion to time."),
        ),
    ),
    table(
        "LoadTorque", sheet="Torque and motor", caption="Load torque",
        help="Torque of the driven machines against speed.",
        rows=36, row_name=("Station", "Speed"), short_caption=True,
        columns=(
            text("Station", "Where the load acts.", kind="station"),
            number("Speed", "speed fraction", _CURVE_SPEED),
            number("Torque", "torque", "Opposing torque at that station's own speed.", us="lbf*ft"),
        ),
    ),
    table(
        "TorqueTime", sheet="Torque and motor", caption="Torque against time (optional)",
        help="Optional: prescribed torque against time, linear between rows.",
        rows=20, row_name=("Station", "Time"), short_caption=True,
        columns=(
            text("Station", "Where the torque acts.", kind="station"),
            number("Time", "time", "Time, rising within a station."),
            number("Torque", "torque", "Torque in the running direction.", us="lbf*ft"),
        ),
    ),
    table(
        "EventTorque", sheet="Torque and motor", caption="Events in operation (optional)",
        help="Air-gap torque of a fault as makers publish it: sums of A e^(−t/τ) cos(m ω t + φ) from the event on, "
        "added to the torque in operation.",
        rows=15, row_name=("Event", "Station", "Multiple"), later=True,
        columns=(
            text("Event", "Name of the event; the rows of one name add up."),
            text("Station", "Where the torque acts: the motor.", kind="station"),
            choice(
                "Base", tuple(TorqueBase),
                "What Amplitude is a share of: RatedTorque, or Apparent power of the motor (MotorData) over its speed.",
                blank="rated torque",
            ),
            number(
                "Amplitude", "fraction",
                "A: torque over Base at the speed of that station, signed, positive in the running direction.",
                us="pu", si="pu", units=("pu", "%"), signed=True,
            ),
            number("Multiple", "ratio", "m: multiple of the line frequency, 0 = no oscillation.", blank="0"),
            number("Phase", "angle", "φ: phase of the cosine at the event.", blank="0"),
            number("Time constant", "time", "τ: time constant of the decay.", blank="it does not decay"),
            number(
                "Per life", "count", "Such events in the life of the train, in one row of the event.", blank="0",
            ),
        ),
    ),
    table(
        "MotorEvents", sheet="Torque and motor", caption="Events of a motor (optional)",
        help="Faults and switching of a motor of table MotorData in operation, or while it starts; its torque follows from "
        "its fluxes and its motion.",
        rows=10, row_name=("Event",), later=True,
        columns=(
            text("Event", "Name of the event."),
            text("Station", "Station of a row of table MotorData.", kind="station"),
            choice("Kind", tuple(MotorEventKind), "What happens."),
            number(
                "Phase", "angle",
                "Of the voltage of the healthy phase (line-to-line fault), or of the phase that changes (unbalance), at "
                "the event; or worst.",
                blank="0", choices=tuple(Scanned),
            ),
            number(
                "Angle", "angle",
                "Of the motor's voltage ahead of the line's at closing: rotor ahead, torque brakes; or worst.",
                blank="as the rotor is then (reclosing)", choices=tuple(Scanned),
            ),
            number(
                "Residual voltage", "fraction",
                "At the motor's terminals before closing, or before a fault off the line; or what a dip, or an unbalanced "
                "phase, keeps.",
                us="pu", si="pu", units=("pu", "%"), blank="1 (closing), what is left (reclosing), on the line (fault)",
            ),
            number(
                "Clears after", "time", "How long the line is faulted, changed or off; or worst.",
                blank="for good; reclosing at once", choices=tuple(Scanned),
            ),
            number(
                "Latest clearing", "time", "Until then the worst Clears after is looked for.", blank="0.5 s",
            ),
            number("Per life", "count", "Such events in the life of the train.", blank="0"),
            choice(
                "Clearing", tuple(Clearing),
                "Whether a fault clears in all phases at once, or in each where the motor's current next passes zero.",
                blank="at once",
            ),
            number(
                "Earliest clearing", "time",
                "From then on the worst Clears after is looked for: relay and breaker take their time.", blank="0",
            ),
            number(
                "Begins", "time",
                "When, from the closing of the breaker, while the motor still starts; or running: in operation.",
                blank="running", choices=tuple(Begins),
            ),
        ),
    ),
    table(
        "Materials", sheet="Fatigue", caption="Materials",
        help="Strength of the shaft materials.",
        rows=5, row_name=("Material",), short_caption=True,
        columns=(
            text("Material", f"Name of the material. {_LIBRARY} may stand without UTS and Yield."),
            number("UTS", "pressure", "Ultimate tensile strength.", blank="of a steel of the library, with Yield blank: its own"),
            number(
                "Yield", "pressure",
                "Yield strength in tension; shear stress is compared with half of it.",
                blank="of a steel of the library, with UTS blank: its own",
            ),
            number(
                "Endurance", "pressure", "Endurance limit (amplitude) in the basis given.",
                blank="stress of the last S-N point",
            ),
            choice(
                "Basis", tuple(SNBasis), "Bending data are halved for torsion.",
                blank="torsion",
            ),
            choice(
                "Below endurance", tuple(BelowEndurance), "Damage below the endurance limit.",
                blank="none",
            ),
        ),
    ),
    table(
        "SNPoints", sheet="Fatigue", caption="S-N points (zero-to-peak)",
        help="S-N line of each material, log-log between the points.",
        rows=12, row_name=("Material", "Cycles"), short_caption=True,
        columns=(
            text("Material", "Name of the material, from table Materials.", kind="material"),
            number(
                "Cycles", "count", "Cycles to failure, rising within a material.",
            ),
            number("Stress", "pressure", "Stress amplitude, zero-to-peak."),
        ),
    ),
    table(
        "FatigueFactors", sheet="Fatigue", caption="Notches and strength factors (optional)",
        help="Stress concentration from geometry, notch sensitivity, and what lowers the strength of a shaft. Blank = SCF of "
        "table Elements and the S-N data as they are.",
        rows=8, row_name=("Element",), later=True,
        columns=(
            text("Element", "Element of table Elements with Stress diameter and Material.", kind="element"),
            choice(
                "Notch", tuple(NotchKind), "Notch at the Stress diameter, whose stress concentration in torsion follows.",
                blank="SCF of table Elements",
            ),
            number(
                "Notch radius", "length", "Fillet radius, or radius at the bottom of the keyway.",
                blank="Fillet of table Sections at the Stress diameter",
            ),
            number(
                "Shoulder diameter", "length", "Larger diameter behind the fillet.",
                blank="OD beside the Stress diameter in table Sections",
            ),
            number(
                "Notch sensitivity", "ratio", "q of Kf = 1 + q (Kt − 1): a number, or the formula for steel.", blank="1",
                choices=tuple(NotchSensitivity),
            ),
            number(
                "Surface", "ratio", "Surface factor: a number, or a finish.", blank="1", choices=tuple(SurfaceFinish),
            ),
            number(
                "Size", "ratio", "Size factor: a number, or by diameter.", blank="1", choices=tuple(SizeRule),
            ),
            number(
                "Reliability", "fraction", "Share of the parts that endure: 50, 90, 95, 99, 99.9, 99.99, 99.999 or 99.9999 %.",
                blank="that of the S-N data",
            ),
        ),
    ),
    table(
        "Excitations", sheet="Train", caption="Excitations",
        help="Excitations in continuous operation; blank = 1× and 2× of every shaft speed, 1× and "
        "2× line frequency.",
        rows=14, row_name=("Name",),
        columns=(
            text("Name", "Name of the excitation."),
            number("Order", "ratio", "Multiple of a station's speed."),
            text("Of station", "Station to whose speed the order refers.", kind="station", blank="the motor shaft"),
            number(
                "Frequency", "frequency", "Fixed frequency, instead of an order.",
            ),
            text(
                "Station", "Where it acts.", kind="station",
                blank="motor, gears and driven machines in turn",
            ),
            number(
                "Torque", "excitation torque",
                "Zero-to-peak torque; 100 % = the torque transmitted there, 1 pu = RatedTorque.",
                blank="1 % of the torque transmitted there",
            ),
        ),
    ),
    table(
        "EffectChoices", sheet="Case", caption="Effect choices",
        help="Effects forced on or off; where blank, the plan decides.",
        rows=len(EFFECTS), row_name=("Effect",), states="Choice",
        columns=(
            choice("Effect", tuple(EFFECTS), "Name of the effect."),
            choice(
                "Choice", tuple(EffectChoice), "on and off force the effect; auto lets the plan decide.",
                blank="auto: the plan decides",
            ),
        ),
    ),
    table(
        "StartConditions", sheet="Case", caption="Start conditions (optional)",
        help="The case under other conditions, each calculated with its own verdicts; and how often each start occurs. "
        "Blank = the case alone.",
        rows=20, row_name=("Condition",), later=True,
        columns=(
            text("Condition", "Name of the condition."),
            choice(
                "Kind", tuple(ConditionKind), "Start, or continuous operation alone.", blank="start",
            ),
            number(
                "Voltage", "fraction", "Voltage as a share of that of the torque curves.",
                blank=_OF_CASE,
            ),
            number(
                "Damping ratio", "fraction",
                "Damping ratio of all elastic modes under this condition, hot or cold.",
                blank=_OF_CASE,
            ),
            number(
                "Stiffness factor", "ratio", "On the stiffness of every coupling, hot or cold.", blank="1",
            ),
            number(
                "Load", "fraction", "Share of LoadTorque that acts; 0 = unloaded.", blank="100 %",
            ),
            number(
                "Trip speed", "running speed",
                "Speed at which it is aborted; 100 % = synchronous speed.", blank=_OF_CASE,
                us="%", si="%",
            ),
            text(
                "Event", "Event of table EventTorque or MotorEvents, in the place of a start.", blank="a start",
            ),
            number(
                "Per year", "count", "Starts per year under this condition.", blank="0",
                format=shown.AS_TYPED,
            ),
            number(
                "So far", "count", "Starts so far under this condition.", blank="0",
            ),
        ),
    ),
)  # fmt: skip
