"""What only the whole train can tell of a slip: stress, twist and limits by the torque transmitted.

Few physical ranges stand for many slips of units, columns and rows. `impossible_train` holds what no
motor train has: it takes the place of the verdict. `unusual_train` holds notes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, value_of
from engine.case.usual_range import UsualRange, quotient
from engine.model.excitation import transmitted_torque
from engine.model.train import Train
from engine.numerics.same_bits import product
from engine.operation.full_speed import FullSpeed

#: Σ ½ J ω² over rated power; usual are 1 to 5 s. [s]
INERTIA_CONSTANT = (0.2, 40.0)
#: Above this it is unusual. [s]
LARGE_INERTIA = 10.0
#: Load torque at full speed over rated torque; service factors end at 1.15. [1]
LARGEST_LOAD = 1.2
#: Torques below this share of the largest, referred, count as none. [1]
NO_TORQUE = 1e-9
#: No shaft is of a stronger material; maraging steels end at 2.8 GPa. [Pa]
LARGEST_STRENGTH = 5e9
#: Nominal stress of a shaft that carries at least `CARRYING` of the largest torque, referred; usual are
#: 10 to 80 MPa. [Pa, 1]
LEAST_STRESS, CARRYING = 20e3, 0.01
#: A limit of torque above this multiple of rated torque judges nothing. [1]
LARGEST_LIMIT = 100.0

_CARRIED = "under the torque that it transmits"
OWN_INERTIA = UsualRange(
    "Stations", "Inertia", 0.1, 2.5, "s", 1.0, "motors: 0.3 to 2 s",
    "Check its unit (J, WR², GD²), the speed and the rated power.", "inertia constant H",
)  # fmt: skip
STRESS = UsualRange(
    "Elements", "Stress diameter", 0.5e6, 150e6, f"MPa {_CARRIED}", 1e6, "10 to 80 MPa",
    "Check its unit, that it is no radius, and the loads.", "nominal stress",
)  # fmt: skip
SHAFT_STRESS = replace(STRESS, quantity="OD")
TWIST = UsualRange(
    "Elements", "Stiffness", 0.0, math.radians(20.0), f"degrees {_CARRIED}", math.radians(1.0),
    "shafts below 2 degrees, rubber couplings to 15", "Check its unit.", "twist",
)  # fmt: skip
COUPLING_TWIST = replace(
    TWIST, low=math.radians(0.002), high=math.inf, usual="couplings: 0.02 to 2 degrees"
)
TOOTH = UsualRange(
    "Elements", "Stiffness", 1e-8, 5e-4, f"µm {_CARRIED}", 1e-6, "5 to 50 µm",
    "In table Elements it is torsional, on the From side; check its unit.", "deflection of the teeth",
)  # fmt: skip
PITCH_LINE = UsualRange(
    "Meshes", "Pitch radius drive", 0.0, 150.0, "m/s", 1.0, "to 150 m/s",
    "Check that it is no diameter, its unit, and Poles (no pole pairs).", "pitch line velocity",
)  # fmt: skip
GYRATION = UsualRange(
    "Meshes", "Mass", 0.4, 1.5, "× Pitch radius", 1.0, "0.5 to 0.9",
    "Check the units of Mass and Inertia, and that Pitch radius is no diameter.",
    "radius of gyration √(Inertia/Mass)",
)  # fmt: skip
BEARING = UsualRange(
    "Meshes", "Bearing stiffness", 5.0, 20000.0, "Hz", 1.0, "30 to 1000 Hz",
    "Check the units of Bearing stiffness and Mass.", "frequency of the gear on its bearings",
)  # fmt: skip
BEARING_DAMPING = UsualRange(
    "Meshes", "Bearing damping", 0.0, 3.0, "× critical", 1.0, "0.05 to 1", "Check its unit.",
    "damping of the gear on its bearings",
)  # fmt: skip
LIMITS = tuple(
    UsualRange(
        "Elements", column, low, high, "× the torque that it transmits", 1.0, usual,
        "Check its unit, and the loads.",
    )
    for column, low, high, usual in (
        ("Rated torque", 1.0, 100.0, "1 to 5"),
        ("Peak torque limit", 1.0, 100.0, "2 to 15"),
        ("Vibratory limit", 0.01, 20.0, "0.1 to 1.5"),
    )
)  # fmt: skip


@dataclass(frozen=True)
class Implausible:
    """One thing that no train has."""

    finding: str  #: In few words, for the banner.
    advice: str  #: What to check.

    @property
    def sentence(self) -> str:
        """Both, as a note."""
        return f"{self.finding[:1].upper()}{self.finding[1:]}: no verdict is given. {self.advice}"


def impossible_train(case: CaseData, train: Train, facts: FullSpeed) -> tuple[Implausible, ...]:
    """What no motor train has, of what is known before any calculation.

    Parameters
    ----------
    case : CaseData
        A case without errors. [SI]
    train : Train
        Its train. [SI]
    facts : FullSpeed
        It at full speed. [SI]

    Returns
    -------
    tuple of Implausible
        Empty where verdicts can be given.
    """
    impossible = []
    constant, (low, high) = facts.inertia_constant, INERTIA_CONSTANT
    if constant is not None and not low <= constant <= high:
        impossible.append(
            Implausible(
                f"inertia constant H = {constant:.3g} s (usual: 1 to 5 s)",
                "Check the unit of inertias (J, WR², GD²), the speed ratios and the rated power.",
            )
        )
    for table, load in (("LoadTorque", facts.load), ("Running load", facts.running_load)):
        if load is not None and load > LARGEST_LOAD:
            impossible.append(
                Implausible(
                    f"load of {load:.3g} × rated torque at full speed",
                    f"Torques of {table} are those at the machine's own speed: check their speed and unit, "
                    "and RatedTorque or RatedPower.",
                )
            )
    return (*impossible, *_impossible_strengths(case), *_impossible_elements(case, train))


def _impossible_strengths(case: CaseData) -> Iterator[Implausible]:
    """Strengths of a wrong unit: every stress beside them is small, and every check passes."""
    strengths = [
        (column, row.material, value_of(row, column))
        for column, rows in (
            ("UTS", case.materials),
            ("Yield", case.materials),
            ("Endurance", case.materials),
            ("Stress", case.sn_points),
        )
        for row in rows
    ]
    for column, material, strength in strengths:
        if strength is not None and strength > LARGEST_STRENGTH:
            name = "S-N stress" if column == "Stress" else column
            yield Implausible(
                f"{name} of '{material}' {strength / 1e6:.3g} MPa (steels: to 2,500)",
                "Check its unit.",
            )
            return


def _impossible_elements(case: CaseData, train: Train) -> Iterator[Implausible]:
    """Shafts that are stressed by nothing, and limits that nothing reaches."""
    ratios, torque = case.element_speed_ratios, transmitted_torque(case, train).element
    names = [str(e.element) for e in case.elements]
    carried = dict(zip(names, np.abs(torque).tolist(), strict=True))
    largest = max((t * ratios[name] for name, t in carried.items()), default=0.0)
    for e in case.elements:
        name = str(e.element)
        if not e.stress_diameter or carried[name] * ratios[name] < CARRYING * largest:
            continue
        stress = _stress(carried[name], e.stress_diameter, e.stress_bore)
        if stress is not None and 0.0 < stress < LEAST_STRESS:
            yield Implausible(
                f"nominal stress of '{name}' {stress / 1e6:.2g} MPa under the torque that it transmits "
                "(usual: 10 to 80 MPa)",
                "Check the unit of its Stress diameter.",
            )
            break
    rated = case.ratings.rated_torque
    if not rated:
        return
    for e in case.elements:
        for usual in LIMITS:
            limit, referred = value_of(e, usual.quantity), ratios[e.element] / rated
            if limit and limit * referred > LARGEST_LIMIT:
                yield Implausible(
                    f"{usual.quantity} of '{e.element}' {limit * referred:.3g} × rated torque",
                    "Check its unit.",
                )
                return


def unusual_train(case: CaseData, train: Train, facts: FullSpeed) -> tuple[str, ...]:
    """Notes on a train whose parts do not fit the torque that they transmit.

    Parameters
    ----------
    case : CaseData
        A case without errors. [SI]
    train : Train
        Its train. [SI]
    facts : FullSpeed
        It at full speed. [SI]

    Returns
    -------
    tuple of str
        A sentence a slip; empty if everything looks usual.
    """
    torque = transmitted_torque(case, train).element
    carried = {str(e.element): abs(t) for e, t in zip(case.elements, torque.tolist(), strict=True)}
    return (
        *_inertia(case, facts),
        *_idle(case, train, carried),
        *_strength(case, carried),
        *_stiffness(case, carried),
        *_gears(case, carried),
        *_mode_numbers(case, train),
    )


def _inertia(case: CaseData, facts: FullSpeed) -> Iterator[str]:
    constant = facts.inertia_constant
    if constant is not None and LARGE_INERTIA < constant <= INERTIA_CONSTANT[1]:
        yield (
            f"The inertia constant H = {constant:.3g} s is unusual (1 to 5 s). Check the unit of inertias "
            "(J, WR², GD²), the speed ratios and the rated power."
        )
    motors = list(dict.fromkeys(p.station for p in case.motor_torque))
    yield from OWN_INERTIA.notes([(motors[0], facts.motor_inertia_constant)] if motors else [])


def _idle(case: CaseData, train: Train, carried: dict[str, float]) -> Iterator[str]:
    """Elements with limits of torque or stress that carry none: a load is missing, or a wrong station."""
    ratios = case.element_speed_ratios
    largest = max((t * ratios[name] for name, t in carried.items()), default=0.0)
    idle = [
        str(e.element)
        for e in case.elements
        if (e.stress_diameter or e.rated_torque or e.peak_torque_limit)
        and carried[str(e.element)] * ratios[e.element] <= NO_TORQUE * largest
    ]
    if largest and idle:
        others = f" (and {len(idle) - 1} more)" if len(idle) > 1 else ""
        yield (
            f"Elements, '{idle[0]}'{others} transmits no torque: no station beyond it has LoadTorque or Running "
            "load. Check From and To, and the rows of LoadTorque or column Running load."
        )


def _strength(case: CaseData, carried: dict[str, float]) -> Iterator[str]:
    """Nominal stress, and makers' limits, against the transmitted torque; what carries none is left out."""
    loaded = [e for e in case.elements if carried[str(e.element)] > 0.0]
    yield from STRESS.notes(
        (e.element, _stress(carried[str(e.element)], e.stress_diameter, e.stress_bore))
        for e in loaded
        if e.stress_diameter
    )
    yield from SHAFT_STRESS.notes(
        (e.element, _stress(carried[str(e.element)], e.od, e.id))
        for e in loaded
        if e.od and not e.stress_diameter and e.kind == ElementKind.SHAFT
    )
    for usual in LIMITS:
        yield from usual.notes(
            (e.element, limit / carried[str(e.element)])
            for e in loaded
            if (limit := value_of(e, usual.quantity))
        )


def _stress(torque: float, diameter: float, bore: float | None) -> float | None:
    """Nominal stress, 16 T / (π D³ (1 − (d/D)⁴)), by products that cannot overflow. [Pa]"""
    hollow = (bore or 0.0) / diameter
    section = math.pi * diameter * diameter * diameter * (1.0 - hollow * hollow * hollow * hollow)
    return quotient(16.0 * torque, section)


def _stiffness(case: CaseData, carried: dict[str, float]) -> Iterator[str]:
    """Typed stiffnesses against the transmitted torque."""

    def twist(e: ElementRow) -> float:
        return carried[str(e.element)] / (e.stiffness or math.inf)

    loaded = [e for e in case.elements if e.stiffness and carried[str(e.element)] > 0.0]
    links = [e for e in loaded if e.kind in (ElementKind.SHAFT, ElementKind.COUPLING)]
    yield from TWIST.notes((e.element, twist(e)) for e in links)
    yield from COUPLING_TWIST.notes(
        (e.element, twist(e)) for e in links if e.kind == ElementKind.COUPLING
    )
    radius = {m.element: m.pitch_radius_drive for m in case.meshes}
    yield from TOOTH.notes(
        (e.element, twist(e) * r)
        for e in loaded
        if e.kind == ElementKind.GEAR_MESH and (r := radius.get(e.element))
    )


def _gears(case: CaseData, carried: dict[str, float]) -> Iterator[str]:
    """Pitch line velocity, and gears on bearings."""
    synchronous, ratios = case.ratings.synchronous_speed, case.speed_ratios
    ends = {e.element: (e.from_, e.to) for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    if synchronous:
        yield from PITCH_LINE.notes(
            (m.element, m.pitch_radius_drive * synchronous * ratios.get(ends[m.element][0], 1.0))
            for m in case.meshes
            if m.pitch_radius_drive and m.element in ends
        )
    inertia = {s.station: s.inertia for s in case.stations}
    bodies = [
        (station, j, mass, r, k, c)
        for m in case.meshes
        if m.element in ends
        for station, j, mass, r, k, c in (
            (
                ends[m.element][0], inertia.get(ends[m.element][0]), m.mass_drive, m.pitch_radius_drive,
                m.bearing_stiffness_drive, m.bearing_damping_drive,
            ),
            (
                ends[m.element][1], inertia.get(ends[m.element][1]), m.mass_driven, m.pitch_radius_driven,
                m.bearing_stiffness_driven, m.bearing_damping_driven,
            ),
        )
        if mass
    ]  # fmt: skip
    yield from GYRATION.notes(
        (name, quotient(math.sqrt(j / mass), r)) for name, j, mass, r, _, _ in bodies if j and r
    )
    yield from BEARING.notes(
        (name, math.sqrt(k / mass) / (2.0 * math.pi)) for name, _, mass, _, k, _ in bodies if k
    )
    yield from BEARING_DAMPING.notes(
        (name, quotient(c, 2.0 * math.sqrt(k * mass)))
        for name, _, mass, _, k, c in bodies
        if k and c
    )


def _mode_numbers(case: CaseData, train: Train) -> Iterator[str]:
    """Damping of modes that do not exist; a shaft with Density has any number of them."""
    if any(e.density for e in case.elements):
        return
    grounded = bool(np.any(np.abs(product(train.incidence, train.dof_ratio)) > 1e-6))
    n_elastic = train.n_dof - (0 if grounded else 1)
    for row in case.mode_damping:
        if row.mode is not None and row.mode > n_elastic:
            yield (
                f"ModeDamping names mode {row.mode}, but the train has {n_elastic} elastic modes. "
                "Correct or clear the row."
            )
