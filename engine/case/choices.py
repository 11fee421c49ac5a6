"""Words that inputs are chosen from.

Each list is a `StrEnum`: a member is written, compared, sorted and pickled as the word itself, so a
row that was read from a file may hold the plain word. Where a cell may be blank the first is meant.
"""

from __future__ import annotations

from enum import StrEnum


class ElementKind(StrEnum):
    """What stands under Kind in `Elements`."""

    SHAFT = "shaft"
    COUPLING = "coupling"
    GEAR_MESH = "gear mesh"
    SPRING_TO_GROUND = "spring to ground"


class EffectChoice(StrEnum):
    """What a user may choose for an effect; blank = auto."""

    AUTO = "auto"
    ON = "on"
    OFF = "off"


class ConditionKind(StrEnum):
    """What a row of `StartConditions` is; blank = start."""

    START = "start"
    STEADY = "steady"


class ContactLaw(StrEnum):
    """Contact damping of teeth.

    `LIMITED` never pulls and never exceeds the spring force, so the force begins at zero (Modelica
    Standard Library 4.0, Rotational.Components.ElastoBacklash; Hunt and Crossley, J. Applied
    Mechanics 42 (1975) 440, for why it should). `NO_ADHESION` never pulls (ElastoBacklash2 of the
    same library).
    """

    LIMITED = "limited"
    NO_ADHESION = "no adhesion"


class Standard(StrEnum):
    """Who says what a train must fulfil."""

    SZENASI = "Szenasi"
    API_617 = "API 617"
    API_541 = "API 541/546"
    OWN = "own"


class MarginBasis(StrEnum):
    """How the natural frequencies are known, which decides the separation margin they need."""

    CALCULATED = "calculated"
    MEASURED = "measured"


class StressBasis(StrEnum):
    """What is compared with UTS/25."""

    PEAK_TO_PEAK = "peak-to-peak"
    ZERO_TO_PEAK = "zero-to-peak"


class Method(StrEnum):
    """How a start is integrated."""

    EXPONENTIAL = "exponential"
    NEWMARK = "newmark"


class InitialState(StrEnum):
    """Where the train is when torques against time begin: untwisted, or twisted by the running loads."""

    REST = "rest"
    RUNNING = "running"


class TorqueFollows(StrEnum):
    """At which speed a motor's curves of torque against speed are read in a start.

    `OWN_SPEED` is that of its station with the vibration, which the slope of the curve then damps or drives;
    `MEAN_SPEED` that of the rigid shaft line on which the motor sits. With `MACHINE` it is the mean speed, too, and each
    mode has the damping that a motor with a data sheet gives it at that speed.
    """

    OWN_SPEED = "own speed"
    MEAN_SPEED = "mean speed"
    MACHINE = "machine"


class HistoryFile(StrEnum):
    """What every sample of a start is kept in."""

    NO = "no"
    PARQUET = "parquet"
    NPZ = "npz"


class RainflowResidue(StrEnum):
    """What is done with the residue of the rainflow count."""

    HALF_CYCLES = "half cycles"
    REPEATED = "repeated"


class MeanStress(StrEnum):
    """How the mean stress of a cycle enters its damage."""

    NONE = "none"
    GOODMAN = "Goodman"


class NotchKind(StrEnum):
    """Notch whose stress concentration follows from geometry."""

    FILLET = "fillet"
    KEYWAY = "keyway"


class NotchSensitivity(StrEnum):
    """Formula of the notch sensitivity of steel."""

    NEUBER = "Neuber"
    PETERSON = "Peterson"


class SurfaceFinish(StrEnum):
    """Finish of a surface, as the table of surface factors names it."""

    GROUND = "ground"
    MACHINED = "machined"
    HOT_ROLLED = "hot-rolled"
    AS_FORGED = "as-forged"


class SizeRule(StrEnum):
    """Rule of a size factor, instead of its number."""

    BY_DIAMETER = "by diameter"


class SNBasis(StrEnum):
    """What S-N data were measured in."""

    TORSION = "torsion"
    BENDING = "bending"


class BelowEndurance(StrEnum):
    """Damage of cycles below the endurance limit."""

    NONE = "none"
    SAME_SLOPE = "same slope"
    HAIBACH = "2k-1"


class GearType(StrEnum):
    """Whether the teeth of a mesh point outwards on both gears."""

    EXTERNAL = "external"
    INTERNAL = "internal"


class MotorKind(StrEnum):
    """What a motor's data sheet is that of."""

    SYNCHRONOUS = "synchronous"
    INDUCTION = "induction"


class FieldCircuit(StrEnum):
    """What the field winding of a motor is connected to while it starts."""

    CLOSED = "closed"
    OPEN = "open"


class DischargePath(StrEnum):
    """What stands in the place of a resistance where the field circuit is open for one sign of its current."""

    OPEN = "open"


class TorqueBase(StrEnum):
    """What a published torque is a share of."""

    RATED_TORQUE = "rated torque"
    APPARENT_POWER = "apparent power"


class TimeConstantKind(StrEnum):
    """What the time constants of a data sheet are."""

    CLASSICAL = "classical"
    MEASURED = "measured"


class Starting(StrEnum):
    """What stands between the line and a motor at first."""

    DIRECT = "direct"
    AUTOTRANSFORMER = "autotransformer"
    REACTOR = "reactor"
    SOFT_START = "soft start"


class MotorEventKind(StrEnum):
    """What happens to a motor in operation."""

    THREE_PHASE_FAULT = "three-phase fault"
    LINE_TO_LINE_FAULT = "line-to-line fault"
    OUT_OF_PHASE_CLOSING = "out-of-phase closing"
    RECLOSING = "reclosing"
    VOLTAGE_DIP = "voltage dip"
    VOLTAGE_UNBALANCE = "voltage unbalance"


class Scanned(StrEnum):
    """What stands in the place of a number that is to be the worst one."""

    WORST = "worst"


class Begins(StrEnum):
    """What stands in the place of a time of the start."""

    RUNNING = "running"


class Clearing(StrEnum):
    """How a fault clears: all phases at once, or each where the motor's current in it passes zero."""

    AT_ONCE = "at once"
    ZEROS = "zeros of current"
