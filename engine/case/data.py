"""What the engineer states: train, motor, loads, start, material, wanted accuracy.

Frozen, in SI and radians; a field that is None was left blank. The field names are the JSON keys
of the contract, and one row class stands for one input table. `CaseData` is what was typed,
`engine.case.case.Case` is the same after every check has passed.
"""

from __future__ import annotations

import hashlib
import json
import keyword
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

from engine.case.choices import (
    ElementKind,
    InitialState,
    MotorEventKind,
    Scanned,
    Starting,
    TorqueFollows,
)
from engine.case.gear_ratios import Joint, station_ratios
from engine.case.steels import Steel, steel_named

#: Name of the event in operation that table `TorqueTime` is where `InitialState` is ``running``.
TABLED_EVENT = "TorqueTime"
#: The word in From or To that means a fixed end or the ground.
GROUND = "ground"

_WORDS = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


@cache
def json_key(name: str) -> str:
    """The JSON key of a contract name: words and capital runs, joined by `_`, lower case."""
    return "_".join(_WORDS.findall(name)).lower()


def value_of(row: object, header: str) -> Any:
    """What stands in a row, or in the case, under a column header or the name of a scalar. [SI]"""
    key = json_key(header)
    return getattr(row, f"{key}_" if keyword.iskeyword(key) else key)


@dataclass(frozen=True)
class StationRow:
    """One row of `Stations`: a lumped inertia of the train."""

    station: str | None = None  #: Name, unique in the train.
    description: str | None = None  #: Free text.
    inertia: float | None = None  #: Polar inertia at the station's own speed. [kg m²]
    #: Speed over the speed of the reference (motor) shaft; blank = 1. [1]
    speed_ratio: float | None = None
    #: Viscous damping to ground, at the station's own speed. [N m s/rad]
    damping: float | None = None
    #: Torque absorbed in continuous operation, at the station's own speed. [N m]
    running_load: float | None = None


@dataclass(frozen=True)
class ElementRow:
    """One row of `Elements`: everything that twists, or a gear mesh."""

    element: str | None = None  #: Name, unique in the train.
    kind: str | None = None  #: ``shaft``, ``coupling``, ``gear mesh`` or ``spring to ground``.
    from_: str | None = None  #: Station at the drive end, or ``ground``.
    to: str | None = None  #: Station at the driven end, or ``ground``.
    #: Torsional stiffness at the shaft's own speed (a mesh: on the From side; blank = rigid). [N
    #: m/rad]
    stiffness: float | None = None
    od: float | None = None  #: Geometry that gives stiffness and, with `density`, inertia. [m]
    id: float | None = None  #: Likewise. [m]
    length: float | None = None  #: Likewise. [m]
    shear_modulus: float | None = None  #: Shear modulus. [Pa]
    #: Density; given, the shaft's own inertia is distributed along it. [kg/m³]
    density: float | None = None
    damping: float | None = None  #: Viscous damping across the element. [N m s/rad]
    loss_factor: float | None = None  #: Hysteretic loss factor. [1]
    stress_diameter: float | None = None  #: Section where stress is judged. [m]
    stress_bore: float | None = None  #: Likewise. [m]
    scf: float | None = None  #: Stress concentration factor; blank = 1. [1]
    material: str | None = None  #: Row of `Materials`.
    rated_torque: float | None = None  #: The maker's limits; blank = not judged. [N m]
    peak_torque_limit: float | None = None  #: Likewise. [N m]
    reversal_limit: float | None = None  #: Likewise. [N m]
    vibratory_limit: float | None = None  #: Likewise. [N m]
    #: Required rating over the torque of continuous operation; blank = 1. [1]
    service_factor: float | None = None


@dataclass(frozen=True)
class SectionRow:
    """One row of `Sections`: a length of constant section of an element, from From to To."""

    element: str | None = None  #: The shaft or coupling of `Elements`.
    section: str | None = None  #: Its name; blank = its number.
    length: float | None = None  #: Length. [m]
    od: float | None = None  #: Outer diameter. [m]
    end_od: float | None = None  #: Outer diameter at the To end of a taper; blank = OD. [m]
    id: float | None = None  #: Bore; blank = 0. [m]
    material: str | None = None  #: Row of `SectionMaterials`; blank = carbon steel.
    fillet: float | None = None  #: Fillet radius at the step to the next row; blank = sharp. [m]
    #: Share of its length that twists, of a section inside a hub; blank = all of it. [1]
    penetration: float | None = None
    keyway_width: float | None = None  #: One keyway along the section; blank = none. [m]
    keyway_depth: float | None = None  #: From the crown of the shaft. [m]

    @property
    def last_od(self) -> float | None:
        """Outer diameter at the To end. [m]"""
        return self.od if self.end_od is None else self.end_od


@dataclass(frozen=True)
class SectionMaterialRow:
    """One row of `SectionMaterials`: what sections may be made of beside carbon steel."""

    material: str | None = None  #: Name.
    shear_modulus: float | None = None  #: Shear modulus. [Pa]
    density: float | None = None  #: Density; 0 = sections without inertia. [kg/m³]
    source: str | None = None  #: Where the two numbers come from.


@dataclass(frozen=True)
class MeshRow:
    """One row of `Meshes`: gear geometry, clearances and bearings of an element.

    Drive means the element's From station, driven its To station, whichever drives. A gear is one
    body: its mass and bearings may stand in any row it has part in. With mass and bearing stiffness
    it moves laterally; the mesh must then have a stiffness and a pitch radius.
    """

    element: str | None = None  #: The gear mesh or geared coupling of `Elements`.
    #: ``external`` (default) or ``internal``: the sense of rotation, and the direction in which
    #: the teeth push the gears laterally.
    gear_type: str | None = None
    pitch_radius_drive: float | None = None  #: Pitch radii on the From and the To side. [m]
    pitch_radius_driven: float | None = None  #: Likewise. [m]
    #: Normal pressure angle (blank = 20°) and helix angle (blank = 0). [rad]
    pressure_angle: float | None = None
    helix_angle: float | None = None  #: Likewise. [rad]
    #: Angle of the line of centres from the From to the To gear, counter-clockwise from x; seen
    #: from the side from which the reference shaft turns counter-clockwise. Blank = 0. [rad]
    orientation: float | None = None
    mesh_stiffness: float | None = None  #: Along the line of action. [N/m, N s/m]
    mesh_damping: float | None = None  #: Likewise. [N/m, N s/m]
    backlash: float | None = None  #: Normal backlash, total. [m]
    #: Total angular clearance of a geared coupling, or of a spring to ground (a stop). [rad]
    angular_backlash: float | None = None
    mass_drive: float | None = None  #: Mass of each gear body. [kg]
    mass_driven: float | None = None  #: Likewise. [kg]
    bearing_stiffness_drive: float | None = None  #: Isotropic bearing stiffness. [N/m]
    bearing_stiffness_driven: float | None = None  #: Likewise. [N/m]
    bearing_damping_drive: float | None = None  #: Isotropic bearing damping. [N s/m]
    bearing_damping_driven: float | None = None  #: Likewise. [N s/m]
    teeth_drive: int | None = None  #: Number of teeth of each gear. [count]
    teeth_driven: int | None = None  #: Likewise. [count]
    #: Speed of the To side over that of the From side, where neither teeth nor radii say it. [1]
    speed_ratio: float | None = None

    @property
    def stated_ratios(self) -> dict[str, float]:
        """Speed of the To side over that of the From side, by what states it, the most exact first. [1]

        Keyed by the column in which a contradiction is corrected.
        """
        return {
            column: drive / driven
            for column, drive, driven in (
                ("Teeth driven", self.teeth_drive, self.teeth_driven),
                ("Speed ratio", self.speed_ratio, 1.0),
                ("Pitch radius driven", self.pitch_radius_drive, self.pitch_radius_driven),
            )
            if drive is not None and driven is not None and drive > 0 and driven > 0
        }


@dataclass(frozen=True)
class ModeDampingRow:
    """One row of `ModeDamping`: the damping ratio of one elastic mode."""

    mode: int | None = None  #: Elastic mode, counted from 1.
    damping_ratio: float | None = None  #: Fraction of critical damping. [1]


@dataclass(frozen=True)
class MotorTorqueRow:
    """One row of `MotorTorque`."""

    station: str | None = None  #: Where the motor acts.
    speed: float | None = None  #: Fraction of that station's synchronous speed. [1]
    average: float | None = None  #: Average torque at rated voltage. [N m]
    pulsating: float | None = None  #: Pulsating torque at twice slip frequency, zero-to-peak. [N m]
    phase: float | None = None  #: Of the pulsation, beside `pulsation_phase`; blank = 0. [rad]
    #: Pulsating torque at the slip frequency itself, zero-to-peak, of a one-way discharge path; blank = none. [N m]
    pulsation_1: float | None = None


@dataclass(frozen=True)
class SupplyVoltageRow:
    """One row of `SupplyVoltage`: what the line leaves a motor while it draws its starting current."""

    station: str | None = None  #: Where the motor acts.
    speed: float | None = None  #: Fraction of that station's synchronous speed. [1]
    voltage: float | None = None  #: Voltage over that of the torque curves. [1]


@dataclass(frozen=True)
class SupplyRow:
    """One row of `Supply`: the line of a motor with a data sheet, and how it is switched on."""

    station: str | None = None  #: Where the motor acts.
    #: Short-circuit power of the line at the motor's terminals; blank = it does not give way. [V A]
    short_circuit_power: float | None = None
    x_r: float | None = None  #: Reactance over resistance of the line; blank = no resistance. [1]
    starting: str | None = None  #: One of `Starting`; blank = ``direct``.
    #: Of an autotransformer its ratio; of a reactor what it leaves the motor at rest on a stiff line. [1]
    tap: float | None = None
    #: Fraction of synchronous speed at which the motor is put on the line. [1]
    switch_over_speed: float | None = None
    open_time: float | None = None  #: How long it is off the line then; blank = not at all. [s]
    initial_voltage: float | None = None  #: Of a soft starter: voltage at closing. [1]
    ramp_time: float | None = None  #: How long that voltage rises, in proportion to time. [s]


@dataclass(frozen=True)
class MotorDataRow:
    """One row of `MotorData`: the data sheet of a motor, from which its torque curves follow.

    Reactances and resistances are per unit of the motor's own apparent power and voltage.
    """

    station: str | None = None  #: Where the motor acts.
    kind: str | None = None  #: ``synchronous`` (default) or ``induction``.
    #: Rated apparent power, the base of all that is per unit; blank = from `RatedPower`. [V A]
    apparent_power: float | None = None
    voltage: float | None = None  #: Rated voltage, line to line: the base of what is in ohm. [V]
    #: At rated power; below 0: the current of a synchronous motor lags in operation, else it leads. [1]
    power_factor: float | None = None
    efficiency: float | None = None  #: At rated power. [1]
    xd: float | None = None  #: Synchronous reactances of the two axes. [1]
    xq: float | None = None  #: Likewise. [1]
    xd_transient: float | None = None  #: Xd'; blank = no field winding. [1]
    xd_subtransient: float | None = None  #: Xd''. [1]
    xq_subtransient: float | None = None  #: Xq''. [1]
    xl: float | None = None  #: Leakage reactance of the stator. [1]
    td_0_transient: float | None = None  #: Time constants with the stator open. [s]
    td_0_subtransient: float | None = None  #: Likewise. [s]
    tq_0_subtransient: float | None = None  #: Likewise. [s]
    td_transient: float | None = None  #: Instead of these, with the stator short-circuited. [s]
    td_subtransient: float | None = None  #: Likewise. [s]
    tq_subtransient: float | None = None  #: Likewise. [s]
    #: ``classical`` (default): of one winding after the other; ``measured``: roots of the whole circuit.
    time_constants: str | None = None
    ta: float | None = None  #: Time constant of the direct current in the stator. [s]
    ra: float | None = None  #: Instead of it, resistance of the stator. [1]
    #: Resistance across the field in the start, over that of the field; blank = short-circuited. [1]
    discharge_resistance: float | None = None
    #: That for currents against those of operation, or ``open``; blank = the same both ways. [1]
    discharge_resistance_reverse: float | str | None = None
    field_circuit: str | None = None  #: ``closed`` (default) or ``open`` in the start.
    start_factor: float | None = None  #: On leakages of stator and dampers in the start. [1]
    #: Of an induction motor: resistance and leakage of the stator, magnetising reactance, resistance and
    #: leakage of the cage, both as seen from the stator. [1]
    r_1: float | None = None
    x_1: float | None = None  #: Likewise. [1]
    xm: float | None = None  #: Likewise. [1]
    r_2: float | None = None  #: Likewise. [1]
    x_2: float | None = None  #: Likewise. [1]
    r_3: float | None = None  #: A second cage; blank = none. [1]
    x_3: float | None = None  #: Likewise. [1]

    @property
    def reverse_discharge(self) -> float | None:
        """Resistance across the field for currents against those of operation, infinite where it is open; None: the same. [1]"""
        typed = self.discharge_resistance_reverse
        return math.inf if isinstance(typed, str) else typed

    @property
    def is_one_way(self) -> bool:
        """Whether the resistance across the field changes with the sign of its current. [flag]"""
        return self.reverse_discharge not in (None, self.discharge_resistance or 0.0)

    def base_power(self, rated_power: float | None) -> float | None:
        """Apparent power that is 1 per unit. [V A]

        Parameters
        ----------
        rated_power : float or None
            Rated power of the case. [W]
        """
        if self.apparent_power is not None:
            return self.apparent_power
        if rated_power and self.power_factor and self.efficiency:
            return rated_power / (abs(self.power_factor) * self.efficiency)
        return None

    def base_impedance(self, rated_power: float | None) -> float | None:
        """Impedance that is 1 per unit. [ohm]

        Parameters
        ----------
        rated_power : float or None
            Rated power of the case. [W]
        """
        power = self.base_power(rated_power)
        return self.voltage * self.voltage / power if self.voltage and power else None


@dataclass(frozen=True)
class MotorCircuitRow:
    """One row of `MotorCircuit`: the circuit of a motor, instead of its reactances.

    Everything is per unit of the apparent power and voltage of its row of `MotorData`.
    """

    station: str | None = None  #: Where the motor acts.
    rs: float | None = None  #: Resistance of the stator. [1]
    xl: float | None = None  #: Leakage reactance of the stator. [1]
    xmd: float | None = None  #: Magnetising reactances of the two axes. [1]
    xmq: float | None = None  #: Likewise. [1]
    rf: float | None = None  #: Field winding, resistance and leakage; blank = none. [1]
    xlf: float | None = None  #: Likewise. [1]
    rkd: float | None = None  #: Damper of the axis of the poles; blank = none. [1]
    xlkd: float | None = None  #: Likewise. [1]
    rkq: float | None = None  #: Damper of the axis between the poles; blank = none. [1]
    xlkq: float | None = None  #: Likewise. [1]
    rkd_2: float | None = None  #: Second damper (cage) of each axis; blank = none. [1]
    xlkd_2: float | None = None  #: Likewise. [1]
    rkq_2: float | None = None  #: Likewise. [1]
    xlkq_2: float | None = None  #: Likewise. [1]
    xc: float | None = None  #: Leakage that field and dampers have in common; blank = 0. [1]


@dataclass(frozen=True)
class LoadTorqueRow:
    """One row of `LoadTorque`."""

    station: str | None = None  #: Where the load acts.
    speed: float | None = None  #: Fraction of that station's speed at synchronism. [1]
    torque: float | None = None  #: Opposing torque at the station's own speed. [N m]


@dataclass(frozen=True)
class TorqueTimeRow:
    """One row of `TorqueTime`: prescribed torque, linear between rows."""

    station: str | None = None  #: Where it acts.
    time: float | None = None  #: Time. [s]
    torque: float | None = None  #: Torque in the running direction. [N m]


@dataclass(frozen=True)
class EventTorqueRow:
    """One row of `EventTorque`: a term A e^(−t/τ) cos(m ω t + φ) of an event in operation."""

    event: str | None = None  #: Event; its rows add up.
    station: str | None = None  #: Where it acts.
    #: A over the rated torque at the speed of that station, or over the apparent power of its motor at that
    #: speed, in the running direction. [1]
    amplitude: float | None = None
    multiple: float | None = None  #: m, multiple of the line frequency; blank or 0 = constant. [1]
    phase: float | None = None  #: φ; blank = 0. [rad]
    time_constant: float | None = None  #: τ; blank = it does not decay. [s]
    #: Such events in the life of the train, in one row of each; blank = 0. [1]
    per_life: float | None = None
    #: What the amplitude is a share of, one of `TorqueBase`; blank = the rated torque.
    base: str | None = None


@dataclass(frozen=True)
class MotorEventRow:
    """One row of `MotorEvents`: what happens to a motor of `MotorData` in operation."""

    event: str | None = None  #: Its name.
    station: str | None = None  #: Where the motor acts.
    kind: str | None = None  #: One of `MotorEventKind`.
    #: Voltage of the healthy phase, or of the one that changes, at the event; blank = 0; or ``worst``. [rad]
    phase: float | str | None = None
    #: Of the motor's voltage ahead of the line's at closing; or ``worst``. [rad]
    angle: float | str | None = None
    #: At the motor's terminals just before it closes, or is shorted off the line; or what a dip leaves. [1]
    residual_voltage: float | None = None
    #: How long the line is faulted, changed or off; blank = for good, reclosing at once; or ``worst``. [s]
    clears_after: float | str | None = None
    #: Until then a worst `clears_after` is looked for; blank = 0.5 s. [s]
    latest_clearing: float | None = None
    per_life: float | None = None  #: Such events in the life of the train; blank = 0. [1]
    clearing: str | None = None  #: ``at once`` (default) or ``zeros of current``.
    #: From then on a worst `clears_after` is looked for: no breaker opens sooner; blank = 0. [s]
    earliest_clearing: float | None = None
    #: When, from breaker closing on, while the motor still starts; blank or ``running`` = in operation. [s]
    begins: float | str | None = None

    @property
    def in_start(self) -> float | None:
        """When it begins in the start; None: it comes upon the running train. [s]"""
        return None if isinstance(self.begins, str) else self.begins

    @property
    def is_off_the_line(self) -> bool:
        """Whether the motor has no current before it: it is closed out of phase, or shorted with a voltage of its own."""
        shorted = self.kind in (MotorEventKind.THREE_PHASE_FAULT, MotorEventKind.LINE_TO_LINE_FAULT)
        return self.kind == MotorEventKind.OUT_OF_PHASE_CLOSING or (
            shorted and self.residual_voltage is not None
        )

    @property
    def scanned(self) -> tuple[str, ...]:
        """Attributes of which the worst value is looked for."""
        looked_for = ("phase", "angle", "clears_after")
        return tuple(name for name in looked_for if getattr(self, name) == Scanned.WORST)


@dataclass(frozen=True)
class MaterialRow:
    """One row of `Materials`; where it only names a steel of the library, its strengths are those of the library."""

    material: str | None = None  #: Name.
    #: Ultimate and yield strength in tension; endurance limit in the basis below. [Pa]
    uts: float | None = None
    yield_: float | None = None  #: Likewise. [Pa]
    endurance: float | None = None  #: Likewise. [Pa]
    #: ``torsion`` (default) or ``bending`` (endurance and S-N stresses are halved).
    basis: str | None = None
    below_endurance: str | None = None  #: ``none`` (default), ``same slope`` or ``2k-1``.

    def __post_init__(self) -> None:
        steel = steel_named(self.material)
        if steel is not None and self.uts is None and self.yield_ is None:
            object.__setattr__(self, "uts", steel.uts)
            object.__setattr__(self, "yield_", steel.yield_)

    @property
    def library_steel(self) -> Steel | None:
        """The steel of the library whose strengths the row has."""
        steel = steel_named(self.material)
        own = (self.uts, self.yield_)
        return steel if steel is not None and own == (steel.uts, steel.yield_) else None


@dataclass(frozen=True)
class SNPointRow:
    """One row of `SNPoints`."""

    material: str | None = None  #: Row of `Materials`.
    cycles: float | None = None  #: Cycles to failure. [1]
    stress: float | None = None  #: Stress amplitude, zero-to-peak. [Pa]


@dataclass(frozen=True)
class FatigueFactorRow:
    """One row of `FatigueFactors`: notch and reductions of the strength of a judged shaft; blank = as without it."""

    element: str | None = None  #: Row of `Elements`, with Stress diameter and Material.
    #: Notch at the stress diameter, ``fillet`` or ``keyway``; blank = SCF of `Elements`.
    notch: str | None = None
    notch_radius: float | None = None  #: Radius at its bottom; blank = Fillet of `Sections`. [m]
    #: Larger diameter behind a fillet; blank = from `Sections`. [m]
    shoulder_diameter: float | None = None
    #: Its value, ``Neuber`` or ``Peterson``; blank = 1. [1]
    notch_sensitivity: float | str | None = None
    surface: float | str | None = None  #: Surface factor, or a finish; blank = 1. [1]
    size: float | str | None = None  #: Size factor, or ``by diameter``; blank = 1. [1]
    reliability: float | None = None  #: Share of parts that endure; blank = as the data. [1]


@dataclass(frozen=True)
class ExcitationRow:
    """One row of `Excitations`: something that shakes the train in continuous operation."""

    name: str | None = None  #: Name.
    order: float | None = None  #: Multiple of a station's speed. [1]
    of_station: str | None = None  #: Whose speed; blank = the reference shaft.
    frequency: float | None = None  #: Fixed frequency, instead of an order. [Hz]
    station: str | None = None  #: Where it acts; blank = motor, gears and driven machines in turn.
    torque: float | None = None  #: Zero-to-peak torque. [N m]
    #: Zero-to-peak torque as a share of the torque transmitted there. [1]
    torque_share: float | None = None


@dataclass(frozen=True)
class StartConditionRow:
    """One row of `StartConditions`: the case under another condition, and how often it happens."""

    condition: str | None = None  #: Name of the condition, unique.
    #: ``start`` (blank), or ``steady``: continuous operation alone.
    kind: str | None = None
    #: Over the voltage of the torque curves; blank = as in the case. [1]
    voltage: float | None = None
    #: Of all elastic modes, hot or cold; blank = as in the case. [1]
    damping_ratio: float | None = None
    #: On the stiffness of every coupling, hot or cold; blank = 1. [1]
    stiffness_factor: float | None = None
    load: float | None = None  #: Share of LoadTorque that acts: 1 loaded (blank), 0 unloaded. [1]
    #: Of the reference shaft, where the start is aborted; blank = as in the case. [rad/s]
    trip_speed: float | None = None
    per_year: float | None = None  #: Such starts a year; blank = 0. [1/year]
    so_far: float | None = None  #: Such starts the train has seen; blank = 0. [1]
    #: Event of `EventTorque` or `MotorEvents` that happens in the place of a start; blank = a start.
    event: str | None = None


@dataclass(frozen=True)
class EffectChoiceRow:
    """One row of `EffectChoices`."""

    effect: str | None = None  #: Name of the effect.
    choice: str | None = None  #: ``auto``, ``on`` or ``off``.


#: Input table of the contract → (field of `CaseData`, row class).
TABLES: dict[str, tuple[str, type]] = {
    "Stations": ("stations", StationRow),
    "Elements": ("elements", ElementRow),
    "Sections": ("sections", SectionRow),
    "SectionMaterials": ("section_materials", SectionMaterialRow),
    "Meshes": ("meshes", MeshRow),
    "ModeDamping": ("mode_damping", ModeDampingRow),
    "MotorTorque": ("motor_torque", MotorTorqueRow),
    "MotorData": ("motor_data", MotorDataRow),
    "MotorCircuit": ("motor_circuit", MotorCircuitRow),
    "SupplyVoltage": ("supply_voltage", SupplyVoltageRow),
    "Supply": ("supply", SupplyRow),
    "LoadTorque": ("load_torque", LoadTorqueRow),
    "TorqueTime": ("torque_time", TorqueTimeRow),
    "EventTorque": ("event_torque", EventTorqueRow),
    "MotorEvents": ("motor_events", MotorEventRow),
    "Materials": ("materials", MaterialRow),
    "SNPoints": ("sn_points", SNPointRow),
    "FatigueFactors": ("fatigue_factors", FatigueFactorRow),
    "Excitations": ("excitations", ExcitationRow),
    "EffectChoices": ("effect_choices", EffectChoiceRow),
    "StartConditions": ("start_conditions", StartConditionRow),
}

#: Fields that say who and for whom, not what: they do not enter the digest.
ADMINISTRATIVE = frozenset(
    {
        "template_version",
        "title",
        "tag",
        "client",
        "document",
        "revision",
        "prepared_by",
        "source",
        "checked_by",
        "description",
        "keep_history",
    }
)


@dataclass(frozen=True)
class Ratings:
    """Line, speed and power after two of them have fixed the third; None where nothing fixes them."""

    line_frequency: float | None  #: Line frequency. [Hz]
    synchronous_speed: float | None  #: Synchronous speed of the reference shaft. [rad/s]
    pole_pairs: int | None  #: Pole pairs.
    rated_power: float | None  #: Rated power. [W]
    rated_torque: float | None  #: Rated torque at synchronous speed. [N m]


@dataclass(frozen=True)
class CaseData:
    """Everything typed in a workbook or a case JSON, unchecked. Every field may be None (blank)."""

    template_version: str | None = None  #: Title block.
    title: str | None = None  #: Likewise.
    tag: str | None = None  #: Likewise.
    client: str | None = None  #: Likewise.
    document: str | None = None  #: Likewise.
    revision: str | None = None  #: Likewise.
    prepared_by: str | None = None  #: Likewise.
    checked_by: str | None = None  #: Likewise.
    line_frequency: float | None = None  #: Line frequency. [Hz]
    synchronous_speed: float | None = None  #: Synchronous speed. [rad/s]
    poles: int | None = None  #: Number of poles.
    rated_power: float | None = None  #: Rated power. [W]
    rated_torque: float | None = None  #: Rated torque. [N m]
    #: Continuous operation, of the reference shaft; blank = synchronous speed. [rad/s]
    minimum_speed: float | None = None
    maximum_speed: float | None = None  #: Likewise. [rad/s]
    damping_ratio: float | None = None  #: Fraction of critical damping of all elastic modes. [1]
    damping_range: float | None = None  #: All damping may be smaller by this share; blank = 0. [1]
    #: Who says which margins and analyses are needed: one of `Standard`; blank = ``Szenasi``, without a check of its own.
    standard: str | None = None
    margin_basis: str | None = None  #: How frequencies are known: ``calculated`` or ``measured``.
    margin_required: float | None = None  #: Overrides standard and basis. [1]
    #: ``peak-to-peak`` (default) or ``zero-to-peak``: what is compared with UTS/25.
    stress_basis: str | None = None
    #: Speed of the reference shaft where the start ends; blank = 97 % of synchronous. [rad/s]
    end_speed: float | None = None
    #: Longest simulated time; blank = 600 s, or the end of `torque_time`. [s]
    maximum_time: float | None = None
    #: Where the torques of `torque_time` begin: ``rest`` (default), or ``running``, an event in operation.
    initial_state: str | None = None
    #: At which speed torque curves of motors are read: ``mean speed`` (default), ``own speed`` or ``machine``.
    torque_follows: str | None = None
    starts_required: float | None = None  #: Starts the shaft must survive. [1]
    #: Allowable starts are divided by it before they are judged; blank = 1. [1]
    starts_factor: float | None = None
    #: Wanted accuracy of peak torques, at least `LEAST_TOLERANCE_PEAK`; blank = 0.001. [1]
    tolerance_peak: float | None = None
    tolerance_starts: float | None = None  #: Wanted accuracy of allowable starts; blank = 0.02. [1]
    method: str | None = None  #: ``exponential`` (default) or ``newmark``.
    keep_history: str | None = None  #: ``no`` (default), ``parquet`` or ``npz``.
    rainflow_residue: str | None = None  #: ``half cycles`` (ASTM, default) or ``repeated``.
    mean_stress: str | None = None  #: ``none`` (default) or ``Goodman``.
    #: Phase of the pulsation at t = 0; blank = 0; or ``worst``. [rad]
    pulsation_phase: float | str | None = None
    #: Voltage over the voltage at which the torque curves are given; blank = 1. [1]
    voltage: float | None = None
    shock_amplitude: float | None = None  #: Transient at breaker closing. [N m, s]
    shock_time_constant: float | None = None  #: Likewise. [N m, s]
    field_slip: float | None = None  #: Field application and pull-in. [1, s, rad, N m, N m s/rad]
    field_time_constant: float | None = None  #: Likewise. [1, s, rad, N m, N m s/rad]
    field_angle: float | None = None  #: Likewise. [1, s, rad, N m, N m s/rad]
    pull_out_torque: float | None = None  #: Likewise. [1, s, rad, N m, N m s/rad]
    pull_in_damping: float | None = None  #: Likewise. [1, s, rad, N m, N m s/rad]
    trip_speed: float | None = None  #: Speed at which the start is aborted. [rad/s]
    #: ``limited`` (default) or ``no adhesion``: damping of teeth in contact.
    contact_law: str | None = None
    stations: tuple[StationRow, ...] = ()  #: Rows of the tables of the same name. [rows]
    elements: tuple[ElementRow, ...] = ()  #: Likewise. [rows]
    sections: tuple[SectionRow, ...] = ()  #: Likewise. [rows]
    section_materials: tuple[SectionMaterialRow, ...] = ()  #: Likewise. [rows]
    meshes: tuple[MeshRow, ...] = ()  #: Likewise. [rows]
    mode_damping: tuple[ModeDampingRow, ...] = ()  #: Likewise. [rows]
    motor_torque: tuple[MotorTorqueRow, ...] = ()  #: Likewise. [rows]
    motor_data: tuple[MotorDataRow, ...] = ()  #: Likewise. [rows]
    motor_circuit: tuple[MotorCircuitRow, ...] = ()  #: Likewise. [rows]
    supply_voltage: tuple[SupplyVoltageRow, ...] = ()  #: Likewise. [rows]
    supply: tuple[SupplyRow, ...] = ()  #: Likewise. [rows]
    load_torque: tuple[LoadTorqueRow, ...] = ()  #: Likewise. [rows]
    torque_time: tuple[TorqueTimeRow, ...] = ()  #: Likewise. [rows]
    event_torque: tuple[EventTorqueRow, ...] = ()  #: Likewise. [rows]
    motor_events: tuple[MotorEventRow, ...] = ()  #: Likewise. [rows]
    materials: tuple[MaterialRow, ...] = ()  #: Rows of the tables of the same name. [rows]
    sn_points: tuple[SNPointRow, ...] = ()  #: Likewise. [rows]
    fatigue_factors: tuple[FatigueFactorRow, ...] = ()  #: Likewise. [rows]
    excitations: tuple[ExcitationRow, ...] = ()  #: Likewise. [rows]
    effect_choices: tuple[EffectChoiceRow, ...] = ()  #: Likewise. [rows]
    start_conditions: tuple[StartConditionRow, ...] = ()  #: Likewise. [rows]

    @property
    def ratings(self) -> Ratings:
        """Line frequency, speed, poles, power and torque, each from the others where blank."""
        frequency, speed, poles = self.line_frequency, self.synchronous_speed, self.poles
        pairs = poles // 2 if poles else None
        if pairs is None and frequency and speed:
            pairs = max(1, round(2.0 * math.pi * frequency / speed))
        if speed is None and frequency and pairs:
            speed = 2.0 * math.pi * frequency / pairs
        if frequency is None and speed and pairs:
            frequency = speed * pairs / (2.0 * math.pi)
        power, torque = self.rated_power, self.rated_torque
        if torque is None and power and speed:
            torque = power / speed
        if power is None and torque and speed:
            power = torque * speed
        return Ratings(frequency, speed, pairs, power, torque)

    @property
    def torque_time_from_rest(self) -> tuple[TorqueTimeRow, ...]:
        """Rows of `torque_time` that act in a start, or make one; none where they are an event in operation."""
        return () if self.initial_state == InitialState.RUNNING else self.torque_time

    @property
    def reads_own_speed(self) -> bool:
        """Whether curves of motors are read at the speed of their stations, vibration included. [flag]"""
        return self.torque_follows == TorqueFollows.OWN_SPEED

    @property
    def switch_over_speeds(self) -> tuple[float, ...]:
        """Speeds of the reference shaft at which motors are put on the line, rising, each once. [rad/s]"""
        synchronous = self.ratings.synchronous_speed or 0.0
        return tuple(share * synchronous for share in self._switch_over_shares)

    @property
    def _switch_over_shares(self) -> list[float]:
        """The same as fractions of synchronous speed. [1]"""
        return sorted({row.switch_over_speed for row in self.supply if row.switch_over_speed})

    @property
    def soft_starts(self) -> dict[str, SupplyRow]:
        """Rows of soft starters by station. [rows]"""
        return {str(row.station): row for row in self.supply if row.starting == Starting.SOFT_START}

    @property
    def open_times(self) -> tuple[dict[str, float], ...]:
        """At each of these speeds the stations whose motor is off the line first, and how long. [s]"""
        return tuple(
            {
                str(row.station): row.open_time
                for row in self.supply
                if row.open_time and row.switch_over_speed == share
            }
            for share in self._switch_over_shares
        )

    @property
    def pulsates_at_slip(self) -> bool:
        """Whether a motor has torque at the slip frequency itself, of a one-way discharge path. [flag]"""
        typed = {point.station for point in self.motor_torque}
        return any(point.pulsation_1 for point in self.motor_torque) or any(
            row.is_one_way for row in self.motor_data if row.station not in typed
        )

    @property
    def turns_of_phase(self) -> int:
        """After how many turns of the phase of the pulsation a start is the same: a field, and a torque at the slip frequency
        itself, follow half the phase. [count]"""
        has_field = self.field_slip is not None and self.pull_out_torque is not None
        return 2 if self.pulsates_at_slip or has_field else 1

    @property
    def looks_for_worst_phase(self) -> bool:
        """Whether starts at many phases of the pulsation are asked for. [flag]"""
        return self.pulsation_phase == Scanned.WORST

    @property
    def one_phase(self) -> float:
        """Phase of the pulsation at t = 0; where the worst is looked for, 0 as the first of them. [rad]"""
        phase = self.pulsation_phase
        return 0.0 if phase is None or isinstance(phase, str) else phase

    @property
    def event_names(self) -> tuple[str, ...]:
        """Events in operation, in the order of their tables."""
        tabled = self.torque_time and not self.torque_time_from_rest
        names = dict.fromkeys(str(row.event) for row in self.event_torque)
        names |= dict.fromkeys(str(row.event) for row in self.motor_events)
        return (*names, TABLED_EVENT) if tabled else tuple(names)

    @property
    def events_per_life(self) -> dict[str, float]:
        """How often each event in operation happens in the life of the train; those that do not are left out. [1]"""
        counts = {str(row.event): row.per_life for row in self.event_torque if row.per_life}
        return counts | {str(row.event): row.per_life for row in self.motor_events if row.per_life}

    @property
    def motor_stations(self) -> tuple[str | None, ...]:
        """Stations with a motor: those with a typed curve, then those with a data sheet alone."""
        typed = (point.station for point in self.motor_torque)
        return tuple(dict.fromkeys((*typed, *(row.station for row in self.motor_data))))

    @property
    def speed_ratios(self) -> dict[str | None, float]:
        """Speed of each station over that of the reference shaft, typed or filled through gears. [1]"""
        typed = {row.station: row.speed_ratio for row in self.stations}
        if all(typed.values()):
            return {station: ratio or 1.0 for station, ratio in typed.items()}
        motors = (name for name in self.motor_stations if typed.get(name, 0.0) in (None, 1.0))
        return station_ratios(typed, self._joints, next(motors, next(iter(typed))))

    @property
    def _joints(self) -> Iterator[Joint]:
        """Pairs of stations whose speeds have a known ratio."""
        stated = {m.element: next(iter(m.stated_ratios.values()), None) for m in self.meshes}
        for e in self.elements:
            geared = e.kind == ElementKind.GEAR_MESH
            ratio = stated.get(e.element) if geared else 1.0
            if e.from_ is not None and e.to is not None and ratio is not None:
                yield Joint(e.from_, e.to, ratio, geared)

    @property
    def element_speed_ratios(self) -> dict[str | None, float]:
        """Speed ratio of the shaft at which each element's torque is stated: its From side. [1]"""
        ratios = self.speed_ratios
        return {e.element: ratios.get(e.from_) or ratios.get(e.to) or 1.0 for e in self.elements}


def canonical(value: Any) -> Any:
    """A value as it enters a digest: numbers to 12 significant digits, blanks left out."""
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, (int, float)):
        return float(f"{value:.11e}") + 0.0
    if isinstance(value, tuple):
        return [canonical(row) for row in value]
    return {
        f.name: canonical(getattr(value, f.name))
        for f in fields(value)
        if f.name not in ADMINISTRATIVE and getattr(value, f.name) not in (None, ())
    }


def case_digest(case: CaseData) -> str:
    """SHA-256 of the inputs that can change a result.

    Taken of the SI values rounded to 12 significant digits, so that retyping a quantity in
    another unit does not change it; the title block and descriptions are left out.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    text = json.dumps(canonical(case), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()
