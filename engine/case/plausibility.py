"""Numbers that are possible but look like a slip: a unit, a percent sign, a forgotten row.

Nothing here stops a calculation. Each note says what was found, what is usual and what the usual
slip is, because a wrong unit changes a verdict without any error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from engine.case.data import CaseData

#: Usual ranges of properties, in SI, with the words for them.
SHEAR_MODULUS = (20e9, 130e9)
DENSITY = (1000.0, 20000.0)
ULTIMATE_STRENGTH = (100e6, 2500e6)
DAMPING_RATIO = (0.001, 0.10)
#: Backlash over pitch radius, angular backlash, voltage and trip speed beyond which a unit looks
#: wrong. [1, rad, 1, 1]
LARGEST_BACKLASH, LARGEST_ANGULAR_BACKLASH, LOWEST_VOLTAGE, LOWEST_TRIP = 0.01, 0.05, 0.3, 0.05
#: A curve should reach this share of synchronous speed where EndSpeed is blank.
CURVE_REACH = 0.97
#: A motor whose average torque stays below this share of the rated one starts nothing. [1]
LEAST_TORQUE = 0.05


def implausible(case: CaseData) -> tuple[str, ...]:
    """Notes on inputs outside usual ranges.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    tuple of str
        A sentence a slip; empty if everything looks usual.
    """
    return (
        *_materials(case),
        *_damping(case),
        *_curves(case),
        *_clearances(case),
        *_switching(case),
    )


def _outside(value: float | None, usual: tuple[float, float]) -> bool:
    return value is not None and not usual[0] <= value <= usual[1]


def _materials(case: CaseData) -> Iterator[str]:
    for e in case.elements:
        if _outside(e.shear_modulus, SHEAR_MODULUS):
            yield (
                f"'{e.element}': a shear modulus of {(e.shear_modulus or 0.0) / 1e9:.4g} GPa is "
                "unusual (steel: 79 to 83 GPa, 11.5 to 12 Mpsi). Check its unit."
            )
        if _outside(e.density, DENSITY):
            yield (
                f"'{e.element}': a density of {e.density:.4g} kg/m³ is unusual "
                "(steel: 7850 kg/m³, 0.284 lb/in³). Check its unit."
            )
    for m in case.materials:
        if _outside(m.uts, ULTIMATE_STRENGTH):
            yield (
                f"'{m.material}': a UTS of {(m.uts or 0.0) / 1e6:.4g} MPa is unusual "
                "(shaft steels: 500 to 1200 MPa, 70 to 170 ksi). Check its unit."
            )


def _damping(case: CaseData) -> Iterator[str]:
    has_motor = bool(case.motor_torque)
    zeta = case.damping_ratio
    source = (
        bool(case.mode_damping)
        or any(e.damping or e.loss_factor for e in case.elements)
        or any(s.damping for s in case.stations)
        or any(
            m.mesh_damping or m.bearing_damping_drive or m.bearing_damping_driven
            for m in case.meshes
        )
    )
    if not zeta and not source and has_motor:
        yield (
            "No damping is stated: only the sweep rate limits resonances in the start. Geared "
            "trains usually have a DampingRatio of 1 % to 3 %."
        )
    if zeta and _outside(zeta, DAMPING_RATIO):
        yield (
            f"DampingRatio of {100 * zeta:.3g} % of critical is unusual (0.5 % to 3 % for a train, "
            "more only with elastomer couplings). Check the percent sign."
        )


def _clearances(case: CaseData) -> Iterator[str]:
    for m in case.meshes:
        radius = m.pitch_radius_drive
        if m.backlash and radius and m.backlash > LARGEST_BACKLASH * radius:
            yield (
                f"'{m.element}': a backlash of {1e3 * m.backlash:.4g} mm is unusual for a pitch "
                f"radius of {1e3 * radius:.4g} mm (tenths of a millimetre). Check its unit."
            )
        if m.angular_backlash and m.angular_backlash > LARGEST_ANGULAR_BACKLASH:
            yield (
                f"'{m.element}': an angular backlash of {math.degrees(m.angular_backlash):.3g} "
                "degrees is unusual (geared couplings: below 1 degree). Check its unit."
            )


def _switching(case: CaseData) -> Iterator[str]:
    if case.voltage is not None and case.voltage < LOWEST_VOLTAGE:
        yield (
            f"A voltage of {100 * case.voltage:.3g} % leaves {100 * case.voltage**2:.3g} % of the "
            "motor torque. Check the percent sign."
        )
    if case.voltage is not None and case.voltage != 1.0 and not case.motor_torque:
        yield "Voltage has no effect without motor curves: prescribed torques are not scaled."
    synchronous = case.ratings.synchronous_speed
    if case.trip_speed and synchronous and case.trip_speed < LOWEST_TRIP * synchronous:
        yield (
            f"TripSpeed is {100 * case.trip_speed / synchronous:.3g} % of synchronous speed: the "
            "motor trips as soon as it turns. Check its unit."
        )


def _curves(case: CaseData) -> Iterator[str]:
    ends: dict[tuple[str, str | None], list[float]] = {}
    for table, points in (("MotorTorque", case.motor_torque), ("LoadTorque", case.load_torque)):
        for p in points:
            ends.setdefault((table, p.station), []).append(p.speed or 0.0)
    synchronous = case.ratings.synchronous_speed
    reach = case.end_speed / synchronous if case.end_speed and synchronous else CURVE_REACH
    for (table, station), speeds in ends.items():
        held = []
        if min(speeds) > 0.0:
            held.append(f"begins at {100 * min(speeds):.3g} % of synchronous speed")
        if max(speeds) < reach:
            held.append(f"ends at {100 * max(speeds):.3g} % of synchronous speed")
        if held and len(speeds) > 1:
            yield (
                f"{table} of '{station}' {' and '.join(held)}; outside its range the torque is "
                "held constant. Check the unit of its speeds, or add points."
            )
    yield from _weak_motors(case)
    driven = {p.station for p in case.load_torque}
    if case.motor_torque and not driven:
        yield "There is no LoadTorque: the start runs without load."
    for s in case.stations:
        if s.running_load and driven and s.station not in driven:
            yield (
                f"'{s.station}' has a Running load but no LoadTorque curve: it starts without load."
            )


def _weak_motors(case: CaseData) -> Iterator[str]:
    """Torques typed in pu below a % are a hundred times too small, and nothing else shows it."""
    rated = case.ratings.rated_torque
    if not rated:
        return
    referred = case.speed_ratios
    for name, torques in (
        ("MotorTorque", [(p.station, p.average) for p in case.motor_torque]),
        ("LoadTorque", [(p.station, p.torque) for p in case.load_torque]),
    ):
        most = max((abs(t or 0.0) * referred.get(s, 1.0) for s, t in torques), default=0.0)
        if 0.0 < most < LEAST_TORQUE * rated:
            yield (
                f"No torque of {name} is above {100 * most / rated:.3g} % of RatedTorque. Check its "
                "unit: 0.6 in % is not 0.6 pu."
            )
