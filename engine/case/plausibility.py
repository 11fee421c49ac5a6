"""Numbers that look like a slip: a unit, a percent sign, a forgotten row.

Nothing here stops a calculation. Each note says what was found, what is usual and what the usual
slip is, because a wrong unit changes a verdict without any error. What cannot be meant takes the
place of the verdict (`impossible_inputs`). What only the whole train can tell, such as the stress
of a shaft by the torque that it transmits, is in `engine.operation.plausible_train`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial

from engine.case.choices import ElementKind, InitialState, SNBasis, TorqueBase
from engine.case.data import (
    CaseData,
    ElementRow,
    MaterialRow,
    MotorDataRow,
    MotorTorqueRow,
    value_of,
)
from engine.case.usual_range import Implausible, UsualRange, quotient

#: Backlash over pitch radius and angular backlash beyond which a unit looks wrong. [1, rad]
LARGEST_BACKLASH, LARGEST_ANGULAR_BACKLASH = 0.01, 0.05
#: Usual voltage of a start over that of its curves, and trip speed over synchronous speed. [1]
LOWEST_VOLTAGE, LOWEST_TRIP = 0.3, 0.05
#: A curve should reach this share of synchronous speed where EndSpeed is blank.
CURVE_REACH = 0.97
#: EndSpeed and MaximumSpeed over synchronous speed; below, a fraction was typed under a percent sign. [1]
LEAST_END_SPEED = 0.1
#: Torque curves of more than one point that end below this share of synchronous speed.
LEAST_REACH = 0.05
#: Largest pulsating torque over the rated one, below which there is none; round rotors have 0.05. [1]
LEAST_PULSATION = 0.02
#: The strongest excitation over the torque transmitted there, below which none is judged. [1]
LEAST_EXCITATION = 5e-4
#: No shaft is of a stronger material; maraging steels end at 2.8 GPa. [Pa]
LARGEST_STRENGTH = 5e9
#: A motor whose average torque stays below this share of the rated one starts nothing. [1]
LEAST_TORQUE = 0.05
#: Average torque at rest over the largest one of the curve; below, nothing starts. [1]
LEAST_AT_REST = 0.02
#: A cell of strength below this share of UTS is in another unit. [1]
LEAST_YIELD = 0.2
#: Speed at which the pulsation is compared with the average torque, over synchronous speed. [1]
BEFORE_PULL_OUT = 0.9
#: An S-N line ends where the endurance limit begins, at 10⁶ to 10⁷ cycles. [1]
LEAST_LIFE = 1e4
#: Endurance limit over UTS by its basis, from ground to notched and rough surfaces. [1]
ENDURANCE_SHARES = {SNBasis.TORSION: (0.08, 0.4), SNBasis.BENDING: (0.2, 0.65)}
#: Stress of the first S-N point over UTS by its basis. [1]
STATIC_SHARES = {SNBasis.TORSION: 0.8, SNBasis.BENDING: 1.05}
#: A typed stiffness over that of the typed geometry: keys, fillets and hubs make less of it. [1]
STIFFNESS_FACTOR = 5.0
#: Rated voltages of motors, line to line (IEC 60038, NEMA MG 1 and older ones), and how near one is the same.
LINE_VOLTAGES = (
    380.0, 400.0, 415.0, 440.0, 460.0, 480.0, 500.0, 525.0, 575.0, 600.0, 660.0, 690.0, 2300.0, 2400.0, 3000.0, 3300.0,
    4000.0, 4160.0, 6000.0, 6300.0, 6600.0, 6900.0, 10000.0, 10500.0, 11000.0, 12000.0, 12470.0, 13200.0, 13800.0,
    15000.0,
)  # fmt: skip
SAME_VOLTAGE = 2e-3
#: Discharge resistors over the field's resistance beyond which ohms were typed. [1]
USUAL_DISCHARGE = (1.0, 50.0)
#: Reactances of round rotors are equal in both axes, within what makers state. [1]
SALIENT = 1.02
#: An amplitude in pu of apparent power is taken for one of rated torque where they differ by so much, and the amplitude is one
#: over Xd'' as makers round it. [1]
UNLIKE_BASES, SAME_AMPLITUDE = 0.03, 0.005

Values = Iterable[tuple[str | None, float | None]]

_PERCENT = ("%", 0.01)
_PER_UNIT = "× RatedTorque"
_SIGN = "Check the percent sign."
_UNIT = "Check its unit."


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
    notes = [note for usual, values in USUAL for note in usual.notes(values(case))]
    return (
        *notes,
        *_geometry(case),
        *_gear_ratios(case),
        *_strengths(case),
        *_notches(case),
        *_damping(case),
        *_curves(case),
        *_clearances(case),
        *_excitations(case),
        *_data_sheets(case),
        *_no_effect(case),
    )


def impossible_inputs(case: CaseData) -> tuple[Implausible, ...]:
    """Inputs that cannot be meant, and with which a check would pass or fail for nothing.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    tuple of Implausible
        Empty where verdicts can be given.
    """
    return (
        *(one for usual, values in USUAL for one in usual.impossible(values(case))),
        *_short_curves(case),
        *_no_pulsation(case),
        *_weak_excitations(case),
        *_impossible_strengths(case),
    )


# --- single cells ---------------------------------------------------------------------------------


def _scalar(name: str, case: CaseData) -> Values:
    return [(None, value_of(case, name))]


def _of_synchronous(name: str, case: CaseData) -> Values:
    speed, synchronous = value_of(case, name), case.ratings.synchronous_speed
    return [(None, speed / synchronous)] if speed and synchronous else []


def _of_rated(name: str, case: CaseData) -> Values:
    torque, rated = value_of(case, name), case.ratings.rated_torque
    return [(None, torque / rated)] if torque and rated else []


def _of_rated_power(case: CaseData) -> Values:
    """Apparent power of a motor that is alone: of several, rated power is shared."""
    rated = case.ratings.rated_power
    if not rated or len(case.motor_stations) > 1 or len(case.motor_data) > 1:
        return []
    return [(m.station, m.apparent_power / rated) for m in case.motor_data if m.apparent_power]


def _column(table: str, column: str, name: str, case: CaseData) -> Values:
    rows = getattr(case, table)
    return [(str(value_of(row, name)), value_of(row, column)) for row in rows]


def _curve_over_rated(column: str, case: CaseData) -> Values:
    """The largest torque of each motor, referred, over the rated one."""
    rated, ratios = case.ratings.rated_torque, case.speed_ratios
    if not rated:
        return []
    largest: dict[str | None, float] = {}
    for p in case.motor_torque:
        size = abs(value_of(p, column) or 0.0) * ratios.get(p.station, 1.0) / rated
        largest[p.station] = max(largest.get(p.station, 0.0), size)
    return list(largest.items())


_TRAIN_DAMPING = "0.5 % to 3 % of critical for a train, more only with elastomer couplings"

#: Usual ranges of single cells, and how the cells are found.
USUAL: tuple[tuple[UsualRange, Callable[[CaseData], Values]], ...] = (
    (
        UsualRange(
            "Case", "DampingRatio", 0.001, 0.06, *_PERCENT, _TRAIN_DAMPING,
            f"{_SIGN} A damper coupling has its damping in table Elements or ModeDamping.",
            possible=(0.0, 0.1),
        ),
        lambda case: [(None, case.damping_ratio or None)],
    ),
    (
        UsualRange(
            "Case", "DampingRange", 0.02, 0.9, *_PERCENT, "20 % to 50 %: damping is hardly known better", _SIGN,
            possible=(0.01, 1.0),
        ),
        lambda case: [(None, case.damping_range or None)],
    ),
    (
        UsualRange(
            "ModeDamping", "Damping ratio", 0.001, 0.1, *_PERCENT, _TRAIN_DAMPING, _SIGN,
            possible=(0.0, 0.3),
        ),
        lambda case: [(f"mode {m.mode}", m.damping_ratio or None) for m in case.mode_damping],
    ),
    (
        UsualRange(
            "Case", "MarginRequired", 0.05, 0.5, *_PERCENT, "20 % calculated, 10 % measured", _SIGN,
            possible=(0.01, 1.0),
        ),
        partial(_scalar, "MarginRequired"),
    ),
    (
        UsualRange(
            "Case", "MinimumSpeed", 0.1, 10.0, "% of synchronous speed", 0.01,
            "30 to 100 %, the slowest speed of continuous operation", _UNIT,
        ),
        partial(_of_synchronous, "MinimumSpeed"),
    ),
    (
        UsualRange(
            "Case", "MaximumSpeed", 0.5, 10.0, "% of synchronous speed", 0.01,
            "100 %, the highest speed of continuous operation", _UNIT,
            possible=(LEAST_END_SPEED, math.inf),
        ),
        partial(_of_synchronous, "MaximumSpeed"),
    ),
    (
        UsualRange(
            "Case", "EndSpeed", 0.5, 1.0, "% of synchronous speed", 0.01,
            "95 to 98 %, where the motor pulls in", "Check its unit and the percent sign.",
            possible=(LEAST_END_SPEED, math.inf),
        ),
        partial(_of_synchronous, "EndSpeed"),
    ),
    (
        UsualRange(
            "Case", "TripSpeed", LOWEST_TRIP, 1.0, "% of synchronous speed", 0.01,
            "below, the motor trips as soon as it turns", _UNIT,
        ),
        partial(_of_synchronous, "TripSpeed"),
    ),
    (
        UsualRange(
            "Case", "StartsRequired", 50.0, 1e6, "", 1.0,
            "1,000 to 10,000", "It is the number of starts of a whole life.",
        ),
        partial(_scalar, "StartsRequired"),
    ),
    (
        UsualRange(
            "Case", "StartsFactor", 1.0, 100.0, "", 1.0,
            "1 to 20: allowable starts are divided by it", "Below 1 it is no safety factor.",
            possible=(1.0, math.inf),
        ),
        partial(_scalar, "StartsFactor"),
    ),
    (
        UsualRange(
            "Case", "FieldSlip", 0.003, 0.2, *_PERCENT, "2 to 5 %", _SIGN, possible=(1e-3, 1.0)
        ),
        partial(_scalar, "FieldSlip"),
    ),
    (
        UsualRange("Case", "ShockTimeConstant", 1e-3, 1.0, "s", 1.0, "0.01 to 0.3 s", _UNIT),
        partial(_scalar, "ShockTimeConstant"),
    ),
    (
        UsualRange("Case", "ShockAmplitude", 0.0, 12.0, _PER_UNIT, 1.0, "0.5 to 8", _UNIT),
        lambda case: [(None, abs(value)) for _, value in _of_rated("ShockAmplitude", case) if value],
    ),
    (
        UsualRange("Case", "PullOutTorque", 0.5, 6.0, _PER_UNIT, 1.0, "1.5 to 3", _UNIT),
        partial(_of_rated, "PullOutTorque"),
    ),
    (
        UsualRange(
            "Elements", "Shear modulus", 20e9, 130e9, "GPa", 1e9,
            "steel: 79 to 83 GPa, 11.5 to 12 Mpsi", "Check its unit, and that it is not E.",
        ),
        partial(_column, "elements", "Shear modulus", "Element"),
    ),
    (
        UsualRange(
            "Elements", "Density", 1000.0, 20000.0, "kg/m³", 1.0,
            "steel: 7850 kg/m³, 0.284 lb/in³", _UNIT,
        ),
        partial(_column, "elements", "Density", "Element"),
    ),
    (
        UsualRange(
            "SectionMaterials", "Shear modulus", 20e9, 130e9, "GPa", 1e9,
            "steel: 79 to 83 GPa, 11.5 to 12 Mpsi", "Check its unit, and that it is not E.",
        ),
        partial(_column, "section_materials", "Shear modulus", "Material"),
    ),
    (
        UsualRange(
            "SectionMaterials", "Density", 1000.0, 20000.0, "kg/m³", 1.0,
            "steel: 7850 kg/m³, 0.284 lb/in³", _UNIT,
        ),
        lambda case: [(row.material, row.density) for row in case.section_materials if row.density],
    ),
    (
        UsualRange("Elements", "SCF", 1.0, 6.0, "", 1.0, "1.5 to 4 in torsion", _SIGN),
        partial(_column, "elements", "SCF", "Element"),
    ),
    (
        UsualRange(
            "Elements", "Loss factor", 0.0, 0.4, "", 1.0,
            "0.005 to 0.02 of steel, to 0.2 of elastomer couplings",
            "Check the percent sign; a relative damping ψ is 2π times the loss factor.",
            possible=(0.0, 2.0),
        ),
        partial(_column, "elements", "Loss factor", "Element"),
    ),
    (
        UsualRange(
            "Meshes", "Pressure angle", math.radians(10.0), math.radians(35.0), "degrees",
            math.radians(1.0), "14.5 to 25 degrees", _UNIT,
        ),
        partial(_column, "meshes", "Pressure angle", "Element"),
    ),
    (
        UsualRange(
            "Materials", "UTS", 100e6, 2500e6, "MPa", 1e6,
            "shaft steels: 500 to 1200 MPa, 70 to 170 ksi", _UNIT, possible=(0.0, LARGEST_STRENGTH),
        ),
        partial(_column, "materials", "UTS", "Material"),
    ),
    (
        UsualRange(
            "MotorTorque", "Average", 0.0, 6.0, _PER_UNIT, 1.0, "at most 0.5 to 3",
            "Check its unit (60 % is 0.6 pu) and RatedTorque.",
        ),
        partial(_curve_over_rated, "Average"),
    ),
    (
        UsualRange(
            "MotorTorque", "Pulsating", 0.0, 3.0, _PER_UNIT, 1.0, "at most 0.2 to 1",
            "Check its unit (20 % is 0.2 pu) and RatedTorque.",
        ),
        partial(_curve_over_rated, "Pulsating"),
    ),
    (
        UsualRange(
            "MotorData", "Apparent power", 0.5, 5.0, "× RatedPower", 1.0, "1 to 1.5",
            "It is in kVA: check that it is not typed in MVA, and RatedPower.",
            possible=(0.05, 50.0),
        ),
        lambda case: _of_rated_power(case),
    ),
    (
        UsualRange(
            "EventTorque", "Amplitude", 0.0, 15.0, _PER_UNIT, 1.0, "at most 1 to 12",
            "Check that it is a share of RatedTorque: not of the apparent power, no torque and no per cent.",
            possible=(0.0, 100.0),
        ),
        lambda case: [(row.event, abs(row.amplitude or 0.0)) for row in case.event_torque],
    ),
    (
        UsualRange("EventTorque", "Multiple", 0.0, 4.0, "× line frequency", 1.0, "0, 1 or 2", "It is no frequency."),
        partial(_column, "event_torque", "Multiple", "Event"),
    ),
    (
        UsualRange(
            "EventTorque", "Time constant", 1e-3, 5.0, "s", 1.0, "0.01 to 2 s",
            "Check its unit (milliseconds).",
        ),
        partial(_column, "event_torque", "Time constant", "Event"),
    ),
    (
        UsualRange(
            "Excitations", "Frequency", 0.5, 2500.0, "Hz", 1.0, "line frequency and its multiples",
            "Check its unit (Hz or cpm); what rises with speed has an Order.",
        ),
        partial(_column, "excitations", "Frequency", "Name"),
    ),
)  # fmt: skip


# --- cells beside each other ----------------------------------------------------------------------

LENGTHS = UsualRange(
    "Elements", "Length", 0.02, 250.0, "× OD", 1.0, "0.1 to 30", "Check the units of Length and OD."
)
SECTION_LENGTHS = UsualRange(
    "Sections",
    "Length",
    0.005,
    100.0,
    "× OD",
    1.0,
    "0.02 to 10",
    "Check the units of Length and OD.",
)
SECTIONS = UsualRange(
    "Elements", "Stress diameter", 0.25, 1.5, "× OD", 1.0,
    "0.5 to 1: stress is judged where the shaft is thin", "Check both units, and that neither is a radius.",
)  # fmt: skip
TYPED_STIFFNESS = UsualRange(
    "Elements", "Stiffness", 1.0 / STIFFNESS_FACTOR, STIFFNESS_FACTOR,
    "× that of its OD, ID, Length and Shear modulus", 1.0, "0.5 to 1.2",
    "The typed one is used: correct it, or clear one of the two.",
)  # fmt: skip


def _geometry(case: CaseData) -> Iterator[str]:
    """Columns that describe one and the same shaft."""
    sized = [e for e in case.elements if e.od]
    yield from LENGTHS.notes((e.element, e.length / e.od) for e in sized if e.length and e.od)
    yield from SECTION_LENGTHS.notes(
        (row.element, row.length / row.od) for row in case.sections if row.length and row.od
    )
    yield from SECTIONS.notes(
        (e.element, e.stress_diameter / e.od) for e in sized if e.stress_diameter and e.od
    )
    yield from TYPED_STIFFNESS.notes(
        (e.element, quotient(e.stiffness * e.length * 32.0, _rigidity(e)))
        for e in sized
        if e.stiffness and e.length and e.shear_modulus
    )


def _rigidity(e: ElementRow) -> float:
    """32 × torsional rigidity of the typed section, by products that cannot overflow. [N m²]"""
    od, bore = e.od or 0.0, (e.id or 0.0) / (e.od or 1.0)
    return (
        math.pi * od * od * od * od * (1.0 - bore * bore * bore * bore) * (e.shear_modulus or 0.0)
    )


def _gear_ratios(case: CaseData) -> Iterator[str]:
    """Gears of equal speed: nothing states the ratio behind them."""
    if not case.motor_stations:
        return
    ratios = case.speed_ratios
    stated = {m.element for m in case.meshes if m.pitch_radius_drive or m.stated_ratios}
    for e in case.elements:
        if e.kind != ElementKind.GEAR_MESH or e.element in stated:
            continue
        if e.from_ in ratios and ratios[e.from_] == ratios.get(e.to):
            yield (
                f"Stations, Speed ratio of '{e.to}': gear mesh '{e.element}' joins it to '{e.from_}' of the "
                "same speed, which is unusual. Type the teeth, the pitch radii or the Speed ratio of the mesh in "
                "table Meshes, or the Speed ratio of a station behind the gear."
            )


def _strengths(case: CaseData) -> Iterator[str]:
    """Strengths and S-N points of one material against its UTS."""
    for m in case.materials:
        if not m.uts or m.uts > LARGEST_STRENGTH:
            continue
        name = f"of '{m.material}'"
        if m.yield_ and m.yield_ < LEAST_YIELD * m.uts:
            yield (
                f"Materials, Yield {name}: {m.yield_ / 1e6:.4g} MPa is {m.yield_ / m.uts:.2g} × UTS, which is "
                f"unusual (0.5 to 0.9). {_UNIT}"
            )
        basis = SNBasis(m.basis) if m.basis in tuple(SNBasis) else SNBasis.TORSION
        yield from _endurance(m, basis)
        points = [p for p in case.sn_points if p.material == m.material and p.cycles and p.stress]
        largest = max((p.stress or 0.0 for p in points), default=0.0)
        if largest > STATIC_SHARES[basis] * m.uts:
            yield (
                f"SNPoints, Stress {name}: {largest / 1e6:.4g} MPa is {largest / m.uts:.2g} × UTS, which is "
                f"unusual in {basis} (at most {STATIC_SHARES[basis]:.2g}). Check its unit, that it is an "
                "amplitude and no range, and the Basis."
            )
    lives: dict[str | None, float] = {}
    for p in case.sn_points:
        lives[p.material] = max(lives.get(p.material, 0.0), p.cycles or 0.0)
    for material, life in lives.items():
        if life < LEAST_LIFE:
            yield (
                f"SNPoints, Cycles of '{material}': the line ends at {life:.4g} cycles, which is unusual "
                "(10⁶ to 10⁷). Cycles are counted, not in thousands or millions."
            )


def _impossible_strengths(case: CaseData) -> Iterator[Implausible]:
    """Strengths of a wrong unit: every stress beside them is small, and every check passes."""
    for name, column, rows in (
        ("Yield", "Yield", case.materials),
        ("Endurance", "Endurance", case.materials),
        ("S-N stress", "Stress", case.sn_points),
    ):
        for row in rows:
            strength = value_of(row, column)
            if strength and strength > LARGEST_STRENGTH:
                yield Implausible(
                    f"{name} of '{row.material}' {strength / 1e6:.3g} MPa (steels: to 2,500)", _UNIT
                )
                return


def _endurance(m: MaterialRow, basis: SNBasis) -> Iterator[str]:
    low, high = ENDURANCE_SHARES[basis]
    if m.endurance and m.uts and not low <= m.endurance / m.uts <= high:
        yield (
            f"Materials, Endurance of '{m.material}': {m.endurance / 1e6:.4g} MPa is "
            f"{m.endurance / m.uts:.2g} × UTS, which is unusual in {basis} ({low:.2g} to {high:.2g}). Check "
            "its unit and the Basis."
        )


def _notches(case: CaseData) -> Iterator[str]:
    """A shaft without any notch is not built."""
    known = {p.material for p in case.sn_points}
    judged = [e for e in case.elements if e.stress_diameter and e.material in known]
    notched = {row.element for row in case.fatigue_factors if row.notch}
    if judged and all(e.scf is None and e.element not in notched for e in judged):
        yield (
            f"Elements, SCF is blank at all {len(judged)} shafts whose starts are counted, so 1 is taken. "
            "Keyways, fillets and fits usually have 1.5 to 4 in torsion: type it."
        )


def _damping(case: CaseData) -> Iterator[str]:
    source = (
        bool(case.mode_damping)
        or any(e.damping or e.loss_factor for e in case.elements)
        or any(s.damping for s in case.stations)
        or any(
            m.mesh_damping or m.bearing_damping_drive or m.bearing_damping_driven
            for m in case.meshes
        )
    )
    if not case.damping_ratio and not source and case.motor_stations:
        yield (
            "No damping is stated: only the sweep rate limits resonances in the start. Geared "
            "trains usually have a DampingRatio of 1 % to 3 %."
        )


def _clearances(case: CaseData) -> Iterator[str]:
    for m in case.meshes:
        radius = m.pitch_radius_drive
        if m.backlash and radius and m.backlash > LARGEST_BACKLASH * radius:
            yield (
                f"Meshes, Backlash of '{m.element}': {1e3 * m.backlash:.4g} mm is unusual for a pitch "
                f"radius of {1e3 * radius:.4g} mm (tenths of a millimetre). Check its unit."
            )
        if m.angular_backlash and m.angular_backlash > LARGEST_ANGULAR_BACKLASH:
            yield (
                f"Meshes, Angular backlash of '{m.element}': {math.degrees(m.angular_backlash):.3g} "
                "degrees is unusual (geared couplings: below 1 degree). Check its unit."
            )


def _data_sheets(case: CaseData) -> Iterator[str]:
    """Rated voltages of one phase, and discharge resistors that are no multiple."""
    for m in case.motor_data:
        typed = m.voltage or 0.0
        usual, phase = (
            [v for v in LINE_VOLTAGES if abs(times * typed - v) <= SAME_VOLTAGE * v]
            for times in (1.0, math.sqrt(3.0))
        )
        if phase and not usual:
            yield (
                f"MotorData, Voltage of '{m.station}': {typed:.6g} V is {phase[0]:g} V divided by √3. "
                "Type the voltage from line to line."
            )
        yield from _salient("MotorData", str(m.station), ("Xd", m.xd), ("Xq", m.xq))
        yield from _of_apparent_power(case, m)
        low, high = USUAL_DISCHARGE
        for column in ("Discharge resistance", "Discharge resistance reverse"):
            value = value_of(m, column)
            diodes = (
                m.is_one_way and isinstance(value, float) and value < low
            )  # they have hardly any
            if value and not isinstance(value, str) and not low <= value <= high and not diodes:
                yield (
                    f"MotorData, {column} of '{m.station}': {value:.3g} times the "
                    "resistance of the field is unusual (5 to 15). It is no number of ohms: divide it by the "
                    "resistance of the field winding."
                )
    for c in case.motor_circuit:
        yield from _salient("MotorCircuit", str(c.station), ("Xmd", c.xmd), ("Xmq", c.xmq))


def _of_apparent_power(case: CaseData, m: MotorDataRow) -> Iterator[str]:
    """Amplitudes in pu of the apparent power that count as shares of the rated torque.

    In makers' formulas the largest one is the voltage over the subtransient reactance, in pu of the apparent power. As a
    share of the rated torque it would be larger by the ratio of the two, which the data sheet gives.
    """
    power, rated = m.base_power(case.ratings.rated_power), case.ratings.rated_power
    if not (power and rated and m.xd_subtransient):
        return
    ratio, own = power / rated, 1.0 / m.xd_subtransient
    if abs(ratio - 1.0) < UNLIKE_BASES:
        return
    for row in case.event_torque:
        typed = row.base if row.station == m.station else TorqueBase.APPARENT_POWER
        amplitude = abs(row.amplitude or 0.0)
        if typed != TorqueBase.APPARENT_POWER and abs(amplitude / own - 1.0) <= SAME_AMPLITUDE:
            yield (
                f"EventTorque, Amplitude of '{row.event}': {amplitude:.4g} is one over Xd subtransient of '{m.station}', which is in pu "
                f"of its apparent power; of RatedTorque it would be {own * ratio:.4g}. Choose Base apparent power, or type that."
            )


def _salient(
    table: str, station: str, of_d: tuple[str, float | None], of_q: tuple[str, float | None]
) -> Iterator[str]:
    """The axis of the poles has the larger reactance, as the gap between the poles is wide."""
    (along, d), (across, q) = of_d, of_q
    if d is not None and q is not None and q > SALIENT * d:
        yield (
            f"{table}, {across} of '{station}': {q:.4g} pu is above {along}, {d:.4g} pu, which motors with poles and a field do not "
            f"have. Are {along} and {across} interchanged?"
        )


def _no_effect(case: CaseData) -> Iterator[str]:
    if case.voltage is not None and case.voltage < LOWEST_VOLTAGE:
        yield (
            f"Case, Voltage: {100 * case.voltage:.3g} % leaves {100 * case.voltage**2:.3g} % of the "
            f"motor torque. {_SIGN}"
        )
    lowest = min((row.voltage for row in case.supply_voltage if row.voltage), default=1.0)
    if lowest < LOWEST_VOLTAGE:
        yield (
            f"SupplyVoltage, Voltage: {100 * lowest:.3g} % leaves {100 * lowest**2:.3g} % of the "
            f"motor torque. {_SIGN}"
        )
    if case.voltage is not None and case.voltage != 1.0 and not case.motor_stations:
        yield "Voltage has no effect without motor curves: prescribed torques are not scaled."
    if case.initial_state == InitialState.RUNNING and not case.torque_time:
        yield (
            "InitialState has no effect while table TorqueTime is empty: a start begins at rest, events of "
            "EventTorque in operation."
        )


# --- excitations ----------------------------------------------------------------------------------

EXCITATION = UsualRange(
    "Excitations", "Torque", 1e-3, 0.5, "% of the transmitted torque", 0.01, "0.5 to 10 %", _SIGN
)


def _excitations(case: CaseData) -> Iterator[str]:
    """Their torques, and those that every train has, where the engineer types a list of his own."""
    if not case.excitations:
        return
    if not any(_weak_excitations(case)):
        yield from EXCITATION.notes((row.name, row.torque_share) for row in case.excitations)
    ratios, synchronous = case.speed_ratios, case.ratings.synchronous_speed
    line = case.ratings.line_frequency
    if not synchronous:
        return
    turn = synchronous / (2.0 * math.pi)
    listed = [
        row.frequency or (row.order or 0.0) * ratios.get(row.of_station, 1.0) * turn
        for row in case.excitations
    ]
    wanted = {
        f"1 × the speed of '{station}'": ratio * turn
        for station, ratio in {
            ratio: (name, ratio) for name, ratio in reversed(ratios.items())
        }.values()
    }
    if line and case.motor_stations:
        wanted["2 × line frequency"] = 2.0 * line
    open_ = [
        f"{name} ({hertz:.4g} Hz)"
        for name, hertz in wanted.items()
        if not any(abs(f / hertz - 1.0) < 0.01 for f in listed)
    ]
    if open_:
        yield (
            f"Excitations has no row for {', '.join(open_)}: only what is typed there is judged. Add it, or "
            "check Order and Frequency (Hz, not cpm) of the rows."
        )


def _weak_excitations(case: CaseData) -> Iterator[Implausible]:
    """Torques of a wrong percent sign: every response is small, and every check passes."""
    shares = [row.torque_share for row in case.excitations if row.torque is None]
    if not shares or len(shares) < len(case.excitations) or None in shares:  # blank = 1 %
        return
    strongest = max(share or 0.0 for share in shares)
    if strongest < LEAST_EXCITATION:
        yield Implausible(
            f"every Torque of Excitations at most {100.0 * strongest:.3g} % of the transmitted torque",
            f"Usual: {EXCITATION.usual}. {_SIGN}",
        )


# --- torque curves --------------------------------------------------------------------------------


def _curves(case: CaseData) -> Iterator[str]:
    yield from _ends_of_curves(case)
    yield from _weak_motors(case)
    yield from _shapes(case)
    driven = {p.station for p in case.load_torque}
    if case.motor_stations and not driven:
        yield "There is no LoadTorque: the start runs without load."
    for s in case.stations:
        if s.running_load and driven and s.station not in driven:
            yield (
                f"'{s.station}' has a Running load but no LoadTorque curve: it starts without load."
            )


def _ranges_of_curves(case: CaseData) -> Iterator[tuple[str, float, float]]:
    """Table and station, lowest and highest speed of each curve of more than one point. [1]"""
    speeds: dict[str, list[float]] = {}
    for table, points in (("MotorTorque", case.motor_torque), ("LoadTorque", case.load_torque)):
        for p in points:
            speeds.setdefault(f"{table} of '{p.station}'", []).append(p.speed or 0.0)
    for curve, typed in speeds.items():
        if len(typed) > 1:
            yield curve, min(typed), max(typed)


def _short_curves(case: CaseData) -> Iterator[Implausible]:
    """Fractions typed as per cent: what holds at full speed is held from standstill on."""
    short = [(curve, end) for curve, _, end in _ranges_of_curves(case) if end < LEAST_REACH]
    if short:
        (curve, end), others = short[0], f" (and {len(short) - 1} more)" if len(short) > 1 else ""
        yield Implausible(
            f"{curve}{others} ends at {100.0 * end:.3g} % of synchronous speed",
            "Check the unit of its speeds and the percent sign.",
        )


def _ends_of_curves(case: CaseData) -> Iterator[str]:
    synchronous = case.ratings.synchronous_speed
    reach = case.end_speed / synchronous if case.end_speed and synchronous else CURVE_REACH
    for curve, begin, end in _ranges_of_curves(case):
        held = []
        if begin > 0.0:
            held.append(f"begins at {100 * begin:.3g} % of synchronous speed")
        if end < reach:
            held.append(f"ends at {100 * end:.3g} % of synchronous speed")
        if held and end >= LEAST_REACH:
            yield (
                f"{curve} {' and '.join(held)}; outside its range the torque is held constant. Check the "
                "unit of its speeds, or add points."
            )


def _no_pulsation(case: CaseData) -> Iterator[Implausible]:
    """A start that nothing excites: every torque of it is the average one, and every check passes.

    With a transient at breaker closing or prescribed torques the motor may be of another kind.
    """
    if (
        not case.motor_torque
        or case.motor_data
        or case.shock_amplitude
        or case.torque_time_from_rest
    ):
        return
    ratios, rated = case.speed_ratios, case.ratings.rated_torque or 0.0
    largest = max(abs(p.pulsating or 0.0) * ratios.get(p.station, 1.0) for p in case.motor_torque)
    if largest and largest >= LEAST_PULSATION * rated:
        return
    share = f"at most {100.0 * largest / rated:.3g} % of rated torque" if largest else "zero"
    yield Implausible(
        f"MotorTorque, Pulsating of '{case.motor_torque[0].station}' is {share} at every speed",
        "Nothing excites the modes in the start. A synchronous motor pulsates at twice the slip frequency until "
        "it is in step, usually with 0.2 to 1 × RatedTorque: type it, and check its unit.",
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
                "unit (0.6 in % is not 0.6 pu), its speed and RatedTorque."
            )


def _shapes(case: CaseData) -> Iterator[str]:
    """Motor curves that no motor has: columns exchanged, or typed against slip."""
    curves: dict[str | None, list[MotorTorqueRow]] = {}
    for p in case.motor_torque:
        curves.setdefault(p.station, []).append(p)
    for station, points in curves.items():
        largest = max(abs(p.average or 0.0) for p in points)
        at_rest = next((p for p in points if p.speed == 0.0), None)
        if (
            at_rest is not None
            and largest
            and abs(at_rest.average or 0.0) < LEAST_AT_REST * largest
        ):
            yield (
                f"MotorTorque, Average of '{station}' is {at_rest.average or 0.0:.4g} N m at rest: nothing "
                "starts. Check that Speed is the speed, from 0 to 100 %, and not the slip."
            )
        if largest and not any(p.pulsating for p in points) and not any(_no_pulsation(case)):
            yield (
                f"MotorTorque, Pulsating of '{station}' is zero at every speed. A synchronous motor pulsates at "
                "twice the slip frequency until it is in step, usually with 0.2 to 1 × RatedTorque."
            )
        if largest * case.speed_ratios.get(station, 1.0) < LEAST_TORQUE * (
            case.ratings.rated_torque or 0.0
        ):
            continue  # said by `_weak_motors`
        running = [p for p in points if (p.speed or 0.0) < BEFORE_PULL_OUT]
        if len(running) > 1 and all((p.pulsating or 0.0) > abs(p.average or 0.0) for p in running):
            yield (
                f"MotorTorque, Pulsating of '{station}' is above Average at every speed below "
                f"{100 * BEFORE_PULL_OUT:.0f} %, which is unusual. Check that the columns are not exchanged."
            )
