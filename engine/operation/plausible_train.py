"""What only the whole train can tell of a slip: stress, twist and limits by the torque transmitted.

Few physical ranges stand for many slips of units, columns and rows. `impossible_train` holds what no
motor train has: it takes the place of the verdict. `unusual_train` holds notes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow, value_of
from engine.case.plausibility import impossible_inputs
from engine.case.usual_range import Implausible, UsualRange, quotient
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
#: Stress is compared in shafts that carry at least this share of the largest torque, referred. [1]
CARRYING = 0.01
#: A limit of torque above this multiple of rated torque judges nothing. [1]
LARGEST_LIMIT = 100.0

_CARRIED = "under the torque that it transmits"
OWN_INERTIA = UsualRange(
    "Stations", "Inertia", 0.1, 2.5, "s", 1.0, "motors: 0.3 to 2 s",
    "Check its unit (J, WR², GD²), the speed and the rated power.", "inertia constant H",
)  # fmt: skip
STRESS = UsualRange(
    "Elements", "Stress diameter", 0.5e6, 150e6, f"MPa {_CARRIED}", 1e6, "10 to 80 MPa",
    "Check its unit, that it is no radius, and the loads.", "nominal stress", (20e3, math.inf),
)  # fmt: skip
SHAFT_STRESS = replace(STRESS, quantity="OD")
TWIST = UsualRange(
    "Elements", "Stiffness", 0.0, math.radians(20.0), f"degrees {_CARRIED}", math.radians(1.0),
    "shafts below 2 degrees, rubber couplings to 15", "Check its unit.", "twist",
    (0.0, math.radians(60.0)),
)  # fmt: skip
COUPLING_TWIST = replace(
    TWIST, low=math.radians(0.002), high=math.inf, usual="couplings: 0.02 to 2 degrees",
    possible=(-math.inf, math.inf),
)  # fmt: skip
#: Loss factor that a viscous damper has at line frequency; tuned dampers end at about 1.
LINK_DAMPING = UsualRange(
    "Elements", "Damping", 0.0, 2.0, "× Stiffness at line frequency", 1.0,
    "to 0.3, of damper couplings to 1", "Check its unit.", possible=(0.0, 20.0),
)  # fmt: skip
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
        ("Reversal limit", 0.0, 20.0, "0 to 1"),
    )
)  # fmt: skip


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
    carried = _carried(case, train)
    sections = _sections(case, carried)
    return (
        *impossible_inputs(case),
        *impossible,
        *(one for usual, stresses in sections for one in usual.impossible(stresses)),
        *TWIST.impossible(_links(_twists(case, carried))),
        *LINK_DAMPING.impossible(_link_damping(case)),
        *_impossible_limits(case),
    )


def _impossible_limits(case: CaseData) -> Iterator[Implausible]:
    """A limit of torque that nothing reaches."""
    rated = case.ratings.rated_torque
    if not rated:
        return
    for e in case.elements:
        for usual in LIMITS:
            limit = value_of(e, usual.quantity)
            if limit and limit * case.element_speed_ratios[e.element] > LARGEST_LIMIT * rated:
                share = limit * case.element_speed_ratios[e.element] / rated
                yield Implausible(
                    f"{usual.quantity} of '{e.element}' {share:.3g} × rated torque",
                    "Check its unit.",
                )
                return


def _carried(case: CaseData, train: Train) -> dict[str, float]:
    """The torque that each element transmits, at its own speed. [N m]"""
    torque = transmitted_torque(case, train).element
    return {str(e.element): abs(t) for e, t in zip(case.elements, torque.tolist(), strict=True)}


def _sections(
    case: CaseData, carried: dict[str, float]
) -> tuple[tuple[UsualRange, list[tuple[str | None, float | None]]], ...]:
    """Nominal stress by the transmitted torque, where there is enough of it to tell. [Pa]"""
    ratios = case.element_speed_ratios
    largest = max((t * ratios[name] for name, t in carried.items()), default=0.0)
    loaded = [
        (e, carried[str(e.element)])
        for e in case.elements
        if carried[str(e.element)] * ratios[e.element] > CARRYING * largest
    ]
    judged = [
        (e.element, _stress(torque, e.stress_diameter, e.stress_bore))
        for e, torque in loaded
        if e.stress_diameter
    ]
    others = [
        (e.element, _stress(torque, e.od, e.id))
        for e, torque in loaded
        if e.od and not e.stress_diameter and e.kind == ElementKind.SHAFT
    ]
    return (STRESS, judged), (SHAFT_STRESS, others)


def _twists(case: CaseData, carried: dict[str, float]) -> list[tuple[ElementRow, float]]:
    """Angles by which the transmitted torque twists what has a typed stiffness. [rad]"""
    return [
        (e, torque / e.stiffness)
        for e in case.elements
        if e.stiffness and (torque := carried[str(e.element)]) > 0.0
    ]


def _links(twists: list[tuple[ElementRow, float]]) -> list[tuple[str | None, float]]:
    kinds = (ElementKind.SHAFT, ElementKind.COUPLING)
    return [(e.element, twist) for e, twist in twists if e.kind in kinds]


def _link_damping(case: CaseData) -> list[tuple[str | None, float | None]]:
    """Damping of links over their stiffness, at line frequency. [1]"""
    omega = 2.0 * math.pi * (case.ratings.line_frequency or 0.0)
    return [
        (e.element, omega * e.damping / e.stiffness)
        for e in case.elements
        if e.damping and e.stiffness
    ]


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
    carried = _carried(case, train)
    return (
        *_inertia(case, facts),
        *_idle(case, carried),
        *(note for usual, stresses in _sections(case, carried) for note in usual.notes(stresses)),
        *_limits(case, carried),
        *_stiffness(case, _twists(case, carried)),
        *LINK_DAMPING.notes(_link_damping(case)),
        *_gears(case),
        *_mode_numbers(case, train),
    )


def _inertia(case: CaseData, facts: FullSpeed) -> Iterator[str]:
    """Of the train, or of the motor alone: one note, as both have mostly one cause."""
    constant, own = facts.inertia_constant, facts.motor_inertia_constant
    if constant is not None and not INERTIA_CONSTANT[0] <= constant <= INERTIA_CONSTANT[1]:
        return  # said by `impossible_train`
    if constant is not None and constant > LARGE_INERTIA:
        alone = "" if own is None else f", of the motor alone {own:.3g} s"
        yield (
            f"The inertia constant H = {constant:.3g} s is unusual (1 to 5 s){alone}. Check the unit of "
            "inertias (J, WR², GD²), the speed ratios and the rated power."
        )
        return
    motors = list(case.motor_stations)
    yield from OWN_INERTIA.notes([(motors[0], own)] if motors else [])


def _idle(case: CaseData, carried: dict[str, float]) -> Iterator[str]:
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


def _limits(case: CaseData, carried: dict[str, float]) -> Iterator[str]:
    """Makers' limits against the transmitted torque; what carries none is left out."""
    if any(_impossible_limits(case)):
        return
    for usual in LIMITS:
        yield from usual.notes(
            (e.element, quotient(limit, carried[str(e.element)]))
            for e in case.elements
            if (limit := value_of(e, usual.quantity))
        )


def _stress(torque: float, diameter: float, bore: float | None) -> float | None:
    """Nominal stress, 16 T / (π D³ (1 − (d/D)⁴)), by products that cannot overflow. [Pa]"""
    hollow = (bore or 0.0) / diameter
    section = math.pi * diameter * diameter * diameter * (1.0 - hollow * hollow * hollow * hollow)
    return quotient(16.0 * torque, section)


def _stiffness(case: CaseData, twists: list[tuple[ElementRow, float]]) -> Iterator[str]:
    """Typed stiffnesses against the transmitted torque."""
    yield from TWIST.notes(_links(twists))
    yield from COUPLING_TWIST.notes(
        (e.element, twist) for e, twist in twists if e.kind == ElementKind.COUPLING
    )
    radius = {m.element: m.pitch_radius_drive for m in case.meshes}
    yield from TOOTH.notes(
        (e.element, twist * r)
        for e, twist in twists
        if e.kind == ElementKind.GEAR_MESH and (r := radius.get(e.element))
    )


def _gears(case: CaseData) -> Iterator[str]:
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
    """Damping of modes that do not exist; a shaft with Density or sections has any number of them."""
    if case.sections or any(e.density for e in case.elements):
        return
    grounded = bool(np.any(np.abs(product(train.incidence, train.dof_ratio)) > 1e-6))
    n_elastic = train.n_dof - (0 if grounded else 1)
    for row in case.mode_damping:
        if row.mode is not None and row.mode > n_elastic:
            yield (
                f"ModeDamping names mode {row.mode}, but the train has {n_elastic} elastic modes. "
                "Correct or clear the row."
            )
