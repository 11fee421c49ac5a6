"""What the engineer states: train, motor, loads, start, material, wanted accuracy.

Frozen, in SI and radians; a field that is None was left blank. The field names are the JSON keys
of the contract, and one row class stands for one input table. `CaseData` is what was typed,
`Case` is the same after every check of `engine.case.checks.find_problems` has passed.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, fields
from typing import Any

from engine.errors import CaseError

__all__ = [
    "ADMINISTRATIVE",
    "Case",
    "CaseData",
    "EffectChoiceRow",
    "ElementRow",
    "ExcitationRow",
    "GROUND",
    "LoadTorqueRow",
    "MaterialRow",
    "MeshRow",
    "ModeDampingRow",
    "MotorTorqueRow",
    "Ratings",
    "SNPointRow",
    "StationRow",
    "TABLES",
    "TorqueTimeRow",
    "case_digest",
]

#: The word in From or To that means a fixed end or the ground.
GROUND = "ground"


@dataclass(frozen=True)
class StationRow:
    """One row of `Stations`: a lumped inertia of the train.

    Parameters
    ----------
    station : str or None
        Name, unique in the train. [name]
    description : str or None
        Free text. [text]
    inertia : float or None
        Polar inertia at the station's own speed. [kg m²]
    speed_ratio : float or None
        Speed over the speed of the reference (motor) shaft; blank = 1. [1]
    damping : float or None
        Viscous damping to ground, at the station's own speed. [N m s/rad]
    running_load : float or None
        Torque absorbed in continuous operation, at the station's own speed. [N m]
    """

    station: str | None = None
    description: str | None = None
    inertia: float | None = None
    speed_ratio: float | None = None
    damping: float | None = None
    running_load: float | None = None


@dataclass(frozen=True)
class ElementRow:
    """One row of `Elements`: everything that twists, or a gear mesh.

    Parameters
    ----------
    element : str or None
        Name, unique in the train. [name]
    kind : str or None
        ``shaft``, ``coupling``, ``gear mesh`` or ``spring to ground``. [word]
    from_ : str or None
        Station at the drive end, or ``ground``. [name]
    to : str or None
        Station at the driven end, or ``ground``. [name]
    stiffness : float or None
        Torsional stiffness at the shaft's own speed (a mesh: on the From side; blank = rigid). [N m/rad]
    od, id, length : float or None
        Geometry that gives stiffness and, with `density`, inertia. [m]
    shear_modulus : float or None
        Shear modulus. [Pa]
    density : float or None
        Density; given, the shaft's own inertia is distributed along it. [kg/m³]
    damping : float or None
        Viscous damping across the element. [N m s/rad]
    loss_factor : float or None
        Hysteretic loss factor. [1]
    stress_diameter, stress_bore : float or None
        Section where stress is judged. [m]
    scf : float or None
        Stress concentration factor; blank = 1. [1]
    material : str or None
        Row of `Materials`. [name]
    rated_torque, peak_torque_limit, reversal_limit, vibratory_limit : float or None
        The maker's limits; blank = not judged. [N m]
    """

    element: str | None = None
    kind: str | None = None
    from_: str | None = None
    to: str | None = None
    stiffness: float | None = None
    od: float | None = None
    id: float | None = None
    length: float | None = None
    shear_modulus: float | None = None
    density: float | None = None
    damping: float | None = None
    loss_factor: float | None = None
    stress_diameter: float | None = None
    stress_bore: float | None = None
    scf: float | None = None
    material: str | None = None
    rated_torque: float | None = None
    peak_torque_limit: float | None = None
    reversal_limit: float | None = None
    vibratory_limit: float | None = None


@dataclass(frozen=True)
class MeshRow:
    """One row of `Meshes`: gear geometry, clearances and bearings of an element.

    Drive means the element's From station, driven its To station, whichever drives. A gear is one
    body: its mass and bearings may stand in any row it has part in. With mass and bearing stiffness
    it moves sideways; the mesh must then have a stiffness and a pitch radius.

    Parameters
    ----------
    element : str or None
        The gear mesh or geared coupling of `Elements`. [name]
    gear_type : str or None
        ``external`` (default) or ``internal``: the sense of rotation, and the direction in which
        the teeth push the gears sideways. [word]
    pitch_radius_drive, pitch_radius_driven : float or None
        Pitch radii on the From and the To side. [m]
    pressure_angle, helix_angle : float or None
        Normal pressure angle (blank = 20°) and helix angle (blank = 0). [rad]
    orientation : float or None
        Angle of the line of centres from the From to the To gear, counter-clockwise from x; seen
        from the side from which the reference shaft turns counter-clockwise. Blank = 0. [rad]
    mesh_stiffness, mesh_damping : float or None
        Along the line of action. [N/m, N s/m]
    backlash : float or None
        Normal backlash, total. [m]
    angular_backlash : float or None
        Total angular clearance of a geared coupling, or of a spring to ground (a stop). [rad]
    mass_drive, mass_driven : float or None
        Mass of each gear body. [kg]
    bearing_stiffness_drive, bearing_stiffness_driven : float or None
        Isotropic bearing stiffness. [N/m]
    bearing_damping_drive, bearing_damping_driven : float or None
        Isotropic bearing damping. [N s/m]
    """

    element: str | None = None
    gear_type: str | None = None
    pitch_radius_drive: float | None = None
    pitch_radius_driven: float | None = None
    pressure_angle: float | None = None
    helix_angle: float | None = None
    orientation: float | None = None
    mesh_stiffness: float | None = None
    mesh_damping: float | None = None
    backlash: float | None = None
    angular_backlash: float | None = None
    mass_drive: float | None = None
    mass_driven: float | None = None
    bearing_stiffness_drive: float | None = None
    bearing_stiffness_driven: float | None = None
    bearing_damping_drive: float | None = None
    bearing_damping_driven: float | None = None


@dataclass(frozen=True)
class ModeDampingRow:
    """One row of `ModeDamping`: the damping ratio of one elastic mode.

    Parameters
    ----------
    mode : int or None
        Elastic mode, counted from 1. [count]
    damping_ratio : float or None
        Fraction of critical damping. [1]
    """

    mode: int | None = None
    damping_ratio: float | None = None


@dataclass(frozen=True)
class MotorTorqueRow:
    """One row of `MotorTorque`.

    Parameters
    ----------
    station : str or None
        Where the motor acts. [name]
    speed : float or None
        Fraction of that station's synchronous speed. [1]
    average : float or None
        Average torque at rated voltage. [N m]
    pulsating : float or None
        Pulsating torque at twice slip frequency, zero-to-peak. [N m]
    """

    station: str | None = None
    speed: float | None = None
    average: float | None = None
    pulsating: float | None = None


@dataclass(frozen=True)
class LoadTorqueRow:
    """One row of `LoadTorque`.

    Parameters
    ----------
    station : str or None
        Where the load acts. [name]
    speed : float or None
        Fraction of that station's speed at synchronism. [1]
    torque : float or None
        Opposing torque at the station's own speed. [N m]
    """

    station: str | None = None
    speed: float | None = None
    torque: float | None = None


@dataclass(frozen=True)
class TorqueTimeRow:
    """One row of `TorqueTime`: prescribed torque, linear between rows.

    Parameters
    ----------
    station : str or None
        Where it acts. [name]
    time : float or None
        Time. [s]
    torque : float or None
        Torque in the running direction. [N m]
    """

    station: str | None = None
    time: float | None = None
    torque: float | None = None


@dataclass(frozen=True)
class MaterialRow:
    """One row of `Materials`.

    Parameters
    ----------
    material : str or None
        Name. [name]
    uts, yield_, endurance : float or None
        Ultimate and yield strength in tension; endurance limit in the basis below. [Pa]
    basis : str or None
        ``torsion`` (default) or ``bending`` (endurance and S-N stresses are halved). [word]
    below_endurance : str or None
        ``none`` (default), ``same slope`` or ``2k-1``. [word]
    """

    material: str | None = None
    uts: float | None = None
    yield_: float | None = None
    endurance: float | None = None
    basis: str | None = None
    below_endurance: str | None = None


@dataclass(frozen=True)
class SNPointRow:
    """One row of `SNPoints`.

    Parameters
    ----------
    material : str or None
        Row of `Materials`. [name]
    cycles : float or None
        Cycles to failure. [count]
    stress : float or None
        Stress amplitude, zero-to-peak. [Pa]
    """

    material: str | None = None
    cycles: float | None = None
    stress: float | None = None


@dataclass(frozen=True)
class ExcitationRow:
    """One row of `Excitations`: something that shakes the train in continuous operation.

    Parameters
    ----------
    name : str or None
        Name. [name]
    order : float or None
        Multiple of a station's speed. [1]
    of_station : str or None
        Whose speed; blank = the reference shaft. [name]
    frequency : float or None
        Fixed frequency, instead of an order. [Hz]
    station : str or None
        Where it acts; blank = motor, gears and driven machines in turn. [name]
    torque : float or None
        Zero-to-peak torque. [N m]
    torque_share : float or None
        Zero-to-peak torque as a share of the torque transmitted there. [1]
    """

    name: str | None = None
    order: float | None = None
    of_station: str | None = None
    frequency: float | None = None
    station: str | None = None
    torque: float | None = None
    torque_share: float | None = None


@dataclass(frozen=True)
class EffectChoiceRow:
    """One row of `EffectChoices`.

    Parameters
    ----------
    effect : str or None
        Name of the effect. [name]
    choice : str or None
        ``auto``, ``on`` or ``off``. [word]
    """

    effect: str | None = None
    choice: str | None = None


#: Input table of the contract → (field of `CaseData`, row class).
TABLES: dict[str, tuple[str, type]] = {
    "Stations": ("stations", StationRow),
    "Elements": ("elements", ElementRow),
    "Meshes": ("meshes", MeshRow),
    "ModeDamping": ("mode_damping", ModeDampingRow),
    "MotorTorque": ("motor_torque", MotorTorqueRow),
    "LoadTorque": ("load_torque", LoadTorqueRow),
    "TorqueTime": ("torque_time", TorqueTimeRow),
    "Materials": ("materials", MaterialRow),
    "SNPoints": ("sn_points", SNPointRow),
    "Excitations": ("excitations", ExcitationRow),
    "EffectChoices": ("effect_choices", EffectChoiceRow),
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
        "checked_by",
        "description",
        "keep_history",
    }
)


@dataclass(frozen=True)
class Ratings:
    """Line, speed and power after two of them have fixed the third; None where nothing fixes them.

    Parameters
    ----------
    line_frequency : float or None
        Line frequency. [Hz]
    synchronous_speed : float or None
        Synchronous speed of the reference shaft. [rad/s]
    pole_pairs : int or None
        Pole pairs. [count]
    rated_power : float or None
        Rated power. [W]
    rated_torque : float or None
        Rated torque at synchronous speed. [N m]
    """

    line_frequency: float | None
    synchronous_speed: float | None
    pole_pairs: int | None
    rated_power: float | None
    rated_torque: float | None


@dataclass(frozen=True)
class CaseData:
    """Everything typed in a workbook or a case JSON, unchecked. Every field may be None (blank).

    Parameters
    ----------
    template_version, title, tag, client, document, revision, prepared_by, checked_by : str or None
        Title block. [text]
    line_frequency : float or None
        Line frequency. [Hz]
    synchronous_speed : float or None
        Synchronous speed. [rad/s]
    poles : int or None
        Number of poles. [count]
    rated_power : float or None
        Rated power. [W]
    rated_torque : float or None
        Rated torque. [N m]
    minimum_speed, maximum_speed : float or None
        Continuous operation, of the reference shaft; blank = synchronous speed. [rad/s]
    damping_ratio : float or None
        Fraction of critical damping of all elastic modes. [1]
    margin_basis : str or None
        ``calculated`` (20 %) or ``measured`` (10 %). [word]
    margin_required : float or None
        Overrides the basis. [1]
    stress_basis : str or None
        ``peak-to-peak`` (default) or ``zero-to-peak``: what is compared with UTS/25. [word]
    end_speed : float or None
        Speed of the reference shaft where the start ends; blank = 97 % of synchronous. [rad/s]
    maximum_time : float or None
        Longest simulated time; blank = 600 s, or the end of `torque_time`. [s]
    starts_required : float or None
        Starts the shaft must survive. [count]
    starts_factor : float or None
        Allowable starts are divided by it before they are judged; blank = 1. [1]
    tolerance_peak : float or None
        Wanted accuracy of peak torques; blank = 0.001. [1]
    tolerance_starts : float or None
        Wanted accuracy of allowable starts; blank = 0.02. [1]
    method : str or None
        ``exponential`` (default) or ``newmark``. [word]
    keep_history : str or None
        ``no`` (default), ``parquet`` or ``npz``. [word]
    rainflow_residue : str or None
        ``half cycles`` (ASTM, default) or ``repeated``. [word]
    pulsation_phase : float or None
        Phase of the pulsation at t = 0; blank = 0. [rad]
    voltage : float or None
        Voltage over the voltage at which the torque curves are given; blank = 1. [1]
    shock_amplitude, shock_time_constant : float or None
        Transient at breaker closing. [N m, s]
    field_slip, field_time_constant, field_angle, pull_out_torque, pull_in_damping : float or None
        Field application and pull-in. [1, s, rad, N m, N m s/rad]
    trip_speed : float or None
        Speed at which the start is aborted. [rad/s]
    contact_law : str or None
        ``limited`` (default) or ``no adhesion``: damping of teeth in contact. [word]
    stations, elements, meshes, mode_damping, motor_torque, load_torque, torque_time : tuple
        Rows of the tables of the same name. [rows]
    materials, sn_points, excitations, effect_choices : tuple
        Rows of the tables of the same name. [rows]
    """

    template_version: str | None = None
    title: str | None = None
    tag: str | None = None
    client: str | None = None
    document: str | None = None
    revision: str | None = None
    prepared_by: str | None = None
    checked_by: str | None = None
    line_frequency: float | None = None
    synchronous_speed: float | None = None
    poles: int | None = None
    rated_power: float | None = None
    rated_torque: float | None = None
    minimum_speed: float | None = None
    maximum_speed: float | None = None
    damping_ratio: float | None = None
    margin_basis: str | None = None
    margin_required: float | None = None
    stress_basis: str | None = None
    end_speed: float | None = None
    maximum_time: float | None = None
    starts_required: float | None = None
    starts_factor: float | None = None
    tolerance_peak: float | None = None
    tolerance_starts: float | None = None
    method: str | None = None
    keep_history: str | None = None
    rainflow_residue: str | None = None
    pulsation_phase: float | None = None
    voltage: float | None = None
    shock_amplitude: float | None = None
    shock_time_constant: float | None = None
    field_slip: float | None = None
    field_time_constant: float | None = None
    field_angle: float | None = None
    pull_out_torque: float | None = None
    pull_in_damping: float | None = None
    trip_speed: float | None = None
    contact_law: str | None = None
    stations: tuple[StationRow, ...] = ()
    elements: tuple[ElementRow, ...] = ()
    meshes: tuple[MeshRow, ...] = ()
    mode_damping: tuple[ModeDampingRow, ...] = ()
    motor_torque: tuple[MotorTorqueRow, ...] = ()
    load_torque: tuple[LoadTorqueRow, ...] = ()
    torque_time: tuple[TorqueTimeRow, ...] = ()
    materials: tuple[MaterialRow, ...] = ()
    sn_points: tuple[SNPointRow, ...] = ()
    excitations: tuple[ExcitationRow, ...] = ()
    effect_choices: tuple[EffectChoiceRow, ...] = ()

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


@dataclass(frozen=True)
class Case(CaseData):
    """A case that has passed every check; see `CaseData` for the fields and their units.

    Raises
    ------
    CaseError
        With every problem found, not only the first.
    """

    def __post_init__(self) -> None:
        from engine.case.checks.find_problems import (
            find_problems,  # the checks know the data, not the reverse
        )

        problems = find_problems(self)
        if problems:
            raise CaseError(problems)


def _canonical(value: Any) -> Any:
    """A value as it enters the digest: numbers to 12 significant digits, blanks left out."""
    if isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        return float(f"{value:.11e}") + 0.0
    if isinstance(value, tuple):
        return [_canonical(row) for row in value]
    if isinstance(value, str):
        return value
    return {
        f.name: _canonical(getattr(value, f.name))
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
    text = json.dumps(_canonical(case), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()
