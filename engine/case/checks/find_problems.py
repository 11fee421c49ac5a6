"""Every check a case must pass, all of them at once.

`find_problems` never stops at the first: an engineer corrects a workbook once, not once an error.
Cells the reader has already complained about are passed in, so that a number that could not be
read is not reported a second time as missing.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from engine.case.data import (
    GROUND,
    LEAST_PEAK_ERROR,
    LEAST_TOLERANCE_PEAK,
    TABLES,
    CaseData,
    ElementRow,
    MeshRow,
    Ratings,
)
from engine.case.effects import CHOICES as EFFECT_CHOICES
from engine.case.effects import CONTACT_LAWS, EFFECTS
from engine.errors import Problem, Quoted

__all__ = ["DEFAULT_END_SPEED", "GEAR_MESH", "KINDS", "SPRING_TO_GROUND", "find_problems"]

GEAR_MESH = "gear mesh"
SPRING_TO_GROUND = "spring to ground"
KINDS = ("shaft", "coupling", GEAR_MESH, SPRING_TO_GROUND)

#: Pitch radii must agree with the speed ratios to this share (contract).
RADIUS_TOLERANCE = 1e-3
#: Line frequency, speed and poles, or power, speed and torque, must agree to this share.
RATING_TOLERANCE = 5e-3
#: A torque curve reaches at most this multiple of synchronous speed.
TOP_SPEED = 3.0
#: Voltage over that of the torque curves; more is a percent sign forgotten.
LARGEST_VOLTAGE = 2.0
#: End of a start without field, over synchronous speed (contract).
DEFAULT_END_SPEED = 0.97

CHOICES = {
    "margin_basis": ("MarginBasis", ("calculated", "measured")),
    "stress_basis": ("StressBasis", ("peak-to-peak", "zero-to-peak")),
    "method": ("Method", ("exponential", "newmark")),
    "keep_history": ("KeepHistory", ("no", "parquet", "npz")),
    "rainflow_residue": ("RainflowResidue", ("half cycles", "repeated")),
    "contact_law": ("ContactLaw", CONTACT_LAWS),
}
POSITIVE_SCALARS = {
    "line_frequency": ("LineFrequency", "Hz"),
    "synchronous_speed": ("SynchronousSpeed", "rad/s"),
    "rated_power": ("RatedPower", "W"),
    "rated_torque": ("RatedTorque", "N m"),
    "minimum_speed": ("MinimumSpeed", "rad/s"),
    "maximum_speed": ("MaximumSpeed", "rad/s"),
    "end_speed": ("EndSpeed", "rad/s"),
    "maximum_time": ("MaximumTime", "s"),
    "starts_required": ("StartsRequired", ""),
    "starts_factor": ("StartsFactor", ""),
    "shock_time_constant": ("ShockTimeConstant", "s"),
    "field_time_constant": ("FieldTimeConstant", "s"),
    "trip_speed": ("TripSpeed", "rad/s"),
    "pull_out_torque": ("PullOutTorque", "N m"),
}
#: What to do where a blank means what a zero was meant to say.
POSITIVE_ACTIONS = {
    "field_time_constant": "Leave the cell blank if the field is at full strength at once.",
}
#: Numbers of any sign, that only have to be numbers.
FINITE_SCALARS = {
    "shock_amplitude": ("ShockAmplitude", "N m"),
    "field_angle": ("FieldAngle", "rad"),
    "pulsation_phase": ("PulsationPhase", "rad"),
}


def _number(value: object, unit: str = "") -> str:
    """A value as it stands in a sentence."""
    shown = f"{value:.6g}" if isinstance(value, (int, float)) else f"'{value}'"
    return f"{shown} {unit}".rstrip()


def _wrong(
    table: str,
    row: int | None,
    column: str,
    found: object,
    allowed: str,
    action: str,
    unit: str = "",
    quoted: tuple[Quoted, ...] = (),
) -> Problem:
    """A problem whose sentence is: found …; it must be …. What to do."""
    return Problem(
        table,
        row,
        column,
        found,
        allowed,
        f"found {_number(found, unit)}; it must be {allowed}. {action}",
        quoted,
    )


def _quote(
    value: float, unit: str, place: tuple[str, int | None, str] | None = None
) -> tuple[Quoted, ...]:
    """A quantity named in a sentence as `_number` writes it."""
    return (Quoted(_number(value, unit), value, place),)


def _missing(table: str, row: int | None, column: str, allowed: str, action: str) -> Problem:
    """A problem for a blank that may not be blank."""
    return Problem(
        table, row, column, None, allowed, f"the cell is blank; it must be {allowed}. {action}"
    )


def _check(
    table: str,
    row: int | None,
    column: str,
    value: float | None,
    holds: Callable[[float], bool],
    allowed: str,
    unit: str = "",
    action: str = "Correct the cell.",
) -> Iterator[Problem]:
    """A problem if a number is given and is not finite or does not hold."""
    if value is not None and not math.isfinite(value):
        yield _wrong(table, row, column, value, "a finite number", "Correct the cell.", unit)
    elif value is not None and not holds(value):
        yield _wrong(table, row, column, value, allowed, action, unit)


def _positive(value: float) -> bool:
    return value > 0.0


def _not_negative(value: float) -> bool:
    return value >= 0.0


def _any_number(value: float) -> bool:
    return True


def _is_fine(value: float | None) -> bool:
    """Blank, or a finite positive number."""
    return value is None or (math.isfinite(value) and value > 0.0)


def _ratings_of(case: CaseData) -> Ratings:
    """The ratings, all blank while one of the numbers they come from is impossible."""
    typed = (case.line_frequency, case.synchronous_speed, case.rated_power, case.rated_torque)
    if all(_is_fine(value) for value in typed) and _whole_poles(case):
        return case.ratings
    return Ratings(None, None, None, None, None)


def _whole_poles(case: CaseData) -> bool:
    return case.poles is None or (case.poles >= 2 and case.poles % 2 == 0)


# --- scalars ------------------------------------------------------------------------------------


def _scalars(case: CaseData) -> Iterator[Problem]:
    for key, (name, unit) in POSITIVE_SCALARS.items():
        action = POSITIVE_ACTIONS.get(key, "Correct the cell.")
        value = getattr(case, key)
        yield from _check("Case", None, name, value, _positive, "positive", unit, action)
    for key, (name, unit) in FINITE_SCALARS.items():
        value = getattr(case, key)
        yield from _check("Case", None, name, value, _any_number, "a finite number", unit)
    yield from _check(
        "Case",
        None,
        "PullInDamping",
        case.pull_in_damping,
        _not_negative,
        "zero or positive",
        "N m s/rad",
    )
    for key, (name, words) in CHOICES.items():
        value = getattr(case, key)
        if value is not None and value not in words:
            allowed = "one of " + ", ".join(words)
            yield _wrong("Case", None, name, value, allowed, "Choose from the list.")
    yield from _check(
        "Case",
        None,
        "DampingRatio",
        case.damping_ratio,
        lambda v: 0 <= v < 1,
        "at least 0 and below 1 (100 %)",
        "",
        "1 % to 3 % is usual for a geared train.",
    )
    yield from _check(
        "Case",
        None,
        "MarginRequired",
        case.margin_required,
        lambda v: 0 <= v < 1,
        "at least 0 and below 1 (100 %)",
    )
    yield from _check(
        "Case",
        None,
        "Voltage",
        case.voltage,
        lambda v: 0 < v <= LARGEST_VOLTAGE,
        "positive and at most 2 (200 % of the voltage of the curves)",
        "",
        "Write 80 % or 0.8.",
    )
    yield from _check(
        "Case", None, "FieldSlip", case.field_slip, lambda v: 0 < v < 1, "between 0 and 1 (100 %)"
    )
    yield from _check(
        "Case",
        None,
        "TolerancePeak",
        case.tolerance_peak,
        lambda v: LEAST_TOLERANCE_PEAK <= v <= 0.5,
        f"between {LEAST_TOLERANCE_PEAK:g} and 0.5 (50 %)",
        "",
        "Correct the cell or leave it blank for 0.1 %. No peak torque is calculated to better than "
        f"{LEAST_PEAK_ERROR:g}, so that a smaller tolerance is never met.",
    )
    yield from _check(
        "Case",
        None,
        "ToleranceStarts",
        case.tolerance_starts,
        lambda v: 1e-9 <= v <= 0.5,
        "between 1e-9 and 0.5 (50 %)",
    )
    if not _whole_poles(case):
        yield _wrong(
            "Case",
            None,
            "Poles",
            case.poles,
            "an even number, 2 or more",
            "Poles are counted, not pole pairs.",
        )
    yield from _ratings(case)
    yield from _speed_range(case)
    yield from _partners(case)
    yield from _trip(case)


#: Scalars that mean something only beside another: field, name, field and name of the other, what
#: the other is.
PARTNERS = (
    ("shock_amplitude", "ShockAmplitude", "shock_time_constant", "ShockTimeConstant",
     "how fast the transient at breaker closing dies out"),
    ("shock_time_constant", "ShockTimeConstant", "shock_amplitude", "ShockAmplitude",
     "the torque of the transient at breaker closing"),
    ("field_slip", "FieldSlip", "pull_out_torque", "PullOutTorque",
     "the torque that pulls the motor into step"),
    ("pull_out_torque", "PullOutTorque", "field_slip", "FieldSlip",
     "the slip at which the field is applied"),
    ("field_time_constant", "FieldTimeConstant", "field_slip", "FieldSlip",
     "the slip at which the field is applied"),
    ("field_angle", "FieldAngle", "field_slip", "FieldSlip",
     "the slip at which the field is applied"),
    ("pull_in_damping", "PullInDamping", "field_slip", "FieldSlip",
     "the slip at which the field is applied"),
)  # fmt: skip


def _partners(case: CaseData) -> Iterator[Problem]:
    """Numbers of an electrical effect without the one that they need."""
    for key, name, other_key, other, meaning in PARTNERS:
        if getattr(case, key) is not None and getattr(case, other_key) is None:
            yield Problem(
                "Case",
                None,
                other,
                None,
                f"given where {name} is",
                f"the cell is blank, but {name} is given; it must be given where {name} is. Type "
                f"{other}, {meaning}, or clear {name}.",
            )


def _trip(case: CaseData) -> Iterator[Problem]:
    """A trip speed that no start comes to."""
    synchronous, trip = _ratings_of(case).synchronous_speed, case.trip_speed
    if trip is None or not synchronous or not math.isfinite(trip):
        return
    if trip > synchronous * (1 + 1e-12):
        yield _wrong(
            "Case",
            None,
            "TripSpeed",
            trip,
            f"at most synchronous speed ({synchronous:.6g} rad/s)",
            "The start is aborted when the motor comes to this speed.",
            "rad/s",
            _quote(synchronous, "rad/s"),
        )
        return
    end = case.end_speed or DEFAULT_END_SPEED * synchronous
    if case.field_slip is None and trip > end * (1 + 1e-12):
        stated = "EndSpeed" if case.end_speed else "EndSpeed (blank = 97 % of synchronous)"
        yield _wrong(
            "Case",
            None,
            "TripSpeed",
            trip,
            f"at most {stated}, {end:.6g} rad/s",
            "Without field the start ends there and would never trip. Lower TripSpeed, raise "
            "EndSpeed, or give FieldSlip and PullOutTorque.",
            "rad/s",
            _quote(end, "rad/s", ("Case", None, "EndSpeed")),
        )


def _ratings(case: CaseData) -> Iterator[Problem]:
    """Contradictions among frequency, speed, poles and among power, speed, torque."""
    if _ratings_of(case).synchronous_speed is None:
        return  # nothing to compare, or reported already
    if case.line_frequency and case.synchronous_speed:
        pairs = case.poles // 2 if case.poles else None
        natural = 2.0 * math.pi * case.line_frequency / case.synchronous_speed
        wanted = float(pairs) if pairs else float(max(1, round(natural)))
        if abs(natural / wanted - 1.0) > RATING_TOLERANCE:
            rpm = 60.0 * case.line_frequency / wanted
            yield Problem(
                "Case",
                None,
                "SynchronousSpeed",
                case.synchronous_speed,
                f"{rpm:.6g} rpm with {2 * wanted:.0f} poles at {case.line_frequency:.6g} Hz",
                f"found {case.synchronous_speed * 30 / math.pi:.6g} rpm, but {2 * wanted:.0f} "
                f"poles at {case.line_frequency:.6g} Hz turn at {rpm:.6g} rpm. Correct "
                "SynchronousSpeed, Poles or LineFrequency, or leave one of them blank.",
            )
    speed = _ratings_of(case).synchronous_speed
    if case.rated_power and case.rated_torque and speed:
        torque = case.rated_power / speed
        if abs(case.rated_torque / torque - 1.0) > RATING_TOLERANCE:
            yield Problem(
                "Case",
                None,
                "RatedTorque",
                case.rated_torque,
                f"{torque:.6g} N m",
                f"found {case.rated_torque:.6g} N m, but {case.rated_power:.6g} W at "
                f"{speed * 30 / math.pi:.6g} rpm make {torque:.6g} N m. Correct RatedTorque or "
                "RatedPower, or leave one of them blank.",
                _quote(torque, "N m") + _quote(case.rated_power, "W", ("Case", None, "RatedPower")),
            )


def _speed_range(case: CaseData) -> Iterator[Problem]:
    low, high = case.minimum_speed, case.maximum_speed
    synchronous = _ratings_of(case).synchronous_speed
    low = low if low is not None else synchronous
    high = high if high is not None else synchronous
    if low and high and low > high * (1 + 1e-12):
        name, found = ("MinimumSpeed", case.minimum_speed)
        if found is None:
            name, found = ("MaximumSpeed", case.maximum_speed)
        yield _wrong(
            "Case",
            None,
            name,
            found,
            "at most MaximumSpeed" if name == "MinimumSpeed" else "at least MinimumSpeed",
            f"The range is {low:.6g} rad/s to {high:.6g} rad/s; where one of them is blank it is "
            "the synchronous speed.",
            "rad/s",
            _quote(low, "rad/s", ("Case", None, "MinimumSpeed"))
            + _quote(high, "rad/s", ("Case", None, "MaximumSpeed")),
        )
    if case.end_speed and synchronous and case.end_speed > synchronous * (1 + 1e-12):
        yield _wrong(
            "Case",
            None,
            "EndSpeed",
            case.end_speed,
            f"at most synchronous speed ({synchronous:.6g} rad/s)",
            "Without field a motor settles below synchronism; blank = 97 %.",
            "rad/s",
            _quote(synchronous, "rad/s"),
        )


# --- train --------------------------------------------------------------------------------------


def _names(table: str, column: str, names: Sequence[str | None], what: str) -> Iterator[Problem]:
    """Blank and repeated names."""
    counts = Counter(name for name in names if name)
    first: dict[str, int] = {}
    for row, name in enumerate(names, start=1):
        if not name:
            yield _missing(table, row, column, f"the name of {what}", "Name it.")
        elif counts[name] > 1 and name in first:
            yield _wrong(
                table,
                row,
                column,
                name,
                f"a name used once (row {first[name]} has it already)",
                "Rename one of the two."
                if table in ("Stations", "Elements", "Materials", "Excitations")
                else "Clear one of the two rows.",
            )
        else:
            first[name] = row


def _stations(case: CaseData) -> Iterator[Problem]:
    table = "Stations"
    if not case.stations:
        yield Problem(
            table,
            None,
            "",
            None,
            "at least one station",
            "the table is empty; a train needs at least one station with its inertia.",
        )
    yield from _names(table, "Station", [s.station for s in case.stations], "a station")
    shafted = {name for e in case.elements if e.density for name in (e.from_, e.to)}
    for row, s in enumerate(case.stations, start=1):
        if s.station and s.station.lower() == GROUND:
            yield _wrong(
                table,
                row,
                "Station",
                s.station,
                "another word: 'ground' means a fixed end",
                "Rename the station.",
            )
        if s.inertia is None and s.station not in shafted:
            yield _missing(
                table,
                row,
                "Inertia",
                "positive",
                "Type it, or give a shaft at this station a Density so that its own inertia "
                "counts.",
            )
        zero_allowed = s.station in shafted
        yield from _check(
            table,
            row,
            "Inertia",
            s.inertia,
            _not_negative if zero_allowed else _positive,
            "positive" if not zero_allowed else "zero or positive",
            "kg m²",
            "Every station needs inertia; join two shafts of a massless point into one stiffness.",
        )
        yield from _check(
            table, row, "Running load", s.running_load, _any_number, "a finite number", "N m"
        )
        yield from _check(
            table, row, "Speed ratio", s.speed_ratio, _positive, "positive (blank = 1)"
        )
        yield from _check(
            table, row, "Damping", s.damping, _not_negative, "zero or positive", "N m s/rad"
        )


def _ends(case: CaseData, row: int, e: ElementRow) -> Iterator[Problem]:
    """From and To: present, known, different, at most one of them ground."""
    known = {s.station for s in case.stations if s.station}
    for column, name in (("From", e.from_), ("To", e.to)):
        if name is None:
            if column == "To" and e.kind == SPRING_TO_GROUND:
                continue
            yield _missing("Elements", row, column, "a station of table Stations", "Choose it.")
        elif name != GROUND and name not in known:
            yield _wrong(
                "Elements",
                row,
                column,
                name,
                "a station of table Stations or the word ground",
                _suggest(name, known | {GROUND}),
            )
    if e.from_ is not None and e.from_ == e.to:
        yield _wrong(
            "Elements",
            row,
            "To",
            e.to,
            "another station than From",
            "An element joins two stations.",
        )
    if e.kind == SPRING_TO_GROUND and GROUND not in (e.from_, e.to) and e.to is not None:
        yield _wrong(
            "Elements", row, "To", e.to, "ground", "A spring to ground has ground at one end."
        )
    for column, name in (("From", e.from_), ("To", e.to)):
        if e.kind == GEAR_MESH and name == GROUND:
            yield _wrong(
                "Elements", row, column, GROUND, "a station", "A gear mesh joins two gears."
            )


def _suggest(name: str, known: set[str]) -> str:
    """The known name most like a mistyped one."""
    import difflib

    if len(known) > 200:  # comparing each of thousands of wrong names with thousands would not end
        return "Correct the name, or add its row."
    folded = {k.casefold(): k for k in sorted(known)}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=1)
    return f"Did you mean '{folded[close[0]]}'?" if close else "Correct the name, or add its row."


def _geometry(row: int, e: ElementRow) -> Iterator[Problem]:
    """Stiffness, or everything it is computed from."""
    table = "Elements"
    for column, value, unit in (
        ("OD", e.od, "m"),
        ("Length", e.length, "m"),
        ("Shear modulus", e.shear_modulus, "Pa"),
        ("Density", e.density, "kg/m³"),
        ("Stress diameter", e.stress_diameter, "m"),
        ("SCF", e.scf, ""),
        ("Rated torque", e.rated_torque, "N m"),
        ("Peak torque limit", e.peak_torque_limit, "N m"),
        ("Vibratory limit", e.vibratory_limit, "N m"),
    ):
        yield from _check(table, row, column, value, _positive, "positive", unit)
    for column, value, unit in (
        ("ID", e.id, "m"),
        ("Stress bore", e.stress_bore, "m"),
        ("Damping", e.damping, "N m s/rad"),
        ("Loss factor", e.loss_factor, ""),
        ("Reversal limit", e.reversal_limit, "N m"),
    ):
        yield from _check(table, row, column, value, _not_negative, "zero or positive", unit)
    if e.scf is not None and 0 < e.scf < 1:
        yield _wrong(table, row, "SCF", e.scf, "1 or more", "A notch never lowers the stress.")
    for outer, inner, column, outside in (
        (e.od, e.id, "ID", "OD"),
        (e.stress_diameter, e.stress_bore, "Stress bore", "Stress diameter"),
    ):
        if outer and inner and inner >= outer:
            yield _wrong(
                table,
                row,
                column,
                inner,
                f"below the outer diameter {outer:.6g} m",
                "Correct one of them.",
                "m",
                _quote(outer, "m", (table, row, outside)),
            )
    yield from _stiffness(row, e)


def _stiffness(row: int, e: ElementRow) -> Iterator[Problem]:
    table = "Elements"
    if e.stiffness is not None:
        damped = bool(e.damping)
        yield from _check(
            table,
            row,
            "Stiffness",
            e.stiffness,
            _not_negative if damped else _positive,
            "positive (0 only where Damping is given)",
            "N m/rad",
            "Correct it, or leave it blank: a shaft is computed from OD, ID and Length, a gear "
            "mesh is rigid.",
        )
    elif e.kind in ("shaft", "coupling", SPRING_TO_GROUND):
        absent = [
            name
            for name, value in (
                ("OD", e.od),
                ("Length", e.length),
                ("Shear modulus", e.shear_modulus),
            )
            if value is None
        ]
        if absent:
            yield Problem(
                table,
                row,
                "Stiffness",
                None,
                "a stiffness, or OD, Length and Shear modulus",
                "the stiffness is blank and cannot be computed: "
                + ", ".join(absent)
                + (" are" if len(absent) > 1 else " is")
                + " blank too. Type a stiffness or the geometry.",
            )
    shaft = e.kind != GEAR_MESH
    if shaft and e.density is not None and (e.od is None or e.length is None):
        yield Problem(
            table,
            row,
            "Density",
            e.density,
            "used with OD and Length",
            "a density is given but OD or Length is blank: the shaft's own inertia cannot be "
            "computed. Type the geometry or clear the density.",
        )


def _elements(case: CaseData) -> Iterator[Problem]:
    table = "Elements"
    yield from _names(table, "Element", [e.element for e in case.elements], "an element")
    ratios = {s.station: (1.0 if s.speed_ratio is None else s.speed_ratio) for s in case.stations}
    materials = {m.material for m in case.materials if m.material}
    for row, e in enumerate(case.elements, start=1):
        if e.kind is None:
            yield _missing(
                table, row, "Kind", "one of " + ", ".join(KINDS), "Choose from the list."
            )
        elif e.kind not in KINDS:
            yield _wrong(
                table, row, "Kind", e.kind, "one of " + ", ".join(KINDS), "Choose from the list."
            )
        yield from _ends(case, row, e)
        yield from _geometry(row, e)
        a, b = ratios.get(e.from_), ratios.get(e.to)
        if e.kind in ("shaft", "coupling") and a and b and abs(a / b - 1.0) > 1e-9:
            yield Problem(
                table,
                row,
                "To",
                e.to,
                "a station of the same speed ratio as From",
                f"'{e.from_}' has speed ratio {a:.9g} and '{e.to}' {b:.9g}, but a {e.kind} joins "
                "stations of equal speed. Correct the speed ratios in table Stations, or make it "
                "a gear mesh.",
            )
        yield from _rigid_or_shaft(row, e)
        if e.material and e.material not in materials:
            yield _wrong(
                table,
                row,
                "Material",
                e.material,
                "a material of table Materials",
                _suggest(e.material, materials),
            )
        if e.material and e.stress_diameter is None:
            yield Problem(
                table,
                row,
                "Stress diameter",
                None,
                "positive where a material is named",
                "a material is named but the stress diameter is blank: no stress can be judged. "
                "Type the diameter or clear the material.",
            )


def _rigid_or_shaft(row: int, e: ElementRow) -> Iterator[Problem]:
    """What a gear mesh cannot have."""
    if e.kind != GEAR_MESH:
        return
    for column, value, unit in (
        ("OD", e.od, "m"),
        ("ID", e.id, "m"),
        ("Length", e.length, "m"),
        ("Shear modulus", e.shear_modulus, "Pa"),
        ("Density", e.density, "kg/m³"),
    ):
        if value is not None:
            yield _wrong(
                "Elements",
                row,
                column,
                value,
                "blank for a gear mesh",
                "A mesh has no shaft geometry: a blank Stiffness means rigid, and the gears' "
                "inertias belong to their stations.",
                unit,
            )


def _connected(case: CaseData) -> Iterator[Problem]:
    """One train, no closed circuit."""
    names = [s.station for s in case.stations if s.station]
    root = {name: name for name in names}

    def find(name: str) -> str:
        while root[name] != name:
            root[name] = root[root[name]]
            name = root[name]
        return name

    joined: dict[frozenset[str], tuple[int, str | None]] = {}
    for row, e in enumerate(case.elements, start=1):
        if e.from_ not in root or e.to not in root or e.from_ is None or e.to is None:
            continue
        pair = frozenset((e.from_, e.to))
        a, b = find(e.from_), find(e.to)
        if a != b:
            root[a] = b
            joined.setdefault(pair, (row, e.kind))
        elif pair in joined and GEAR_MESH not in (e.kind, joined[pair][1]):
            continue  # side by side between the same two stations, a spring beside a damper
        else:
            yield Problem(
                "Elements",
                row,
                "Element",
                e.element,
                "part of an open train",
                f"'{e.element}' closes a circuit between '{e.from_}' and '{e.to}'. Closed gear "
                "circuits (split torque, double helix as two meshes) are not calculated: how "
                "they share torque depends on assembly. Join the parallel paths into one "
                "equivalent path.",
            )
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(find(name), []).append(name)
    if len(groups) > 1:
        main = max(groups.values(), key=len)
        for group in groups.values():
            if group is main:
                continue
            row = names.index(group[0]) + 1
            yield Problem(
                "Stations",
                row,
                "Station",
                group[0],
                "joined to the rest of the train",
                f"no element joins {', '.join(repr(n) for n in group)} to the rest of the train "
                f"({main[0]!r}, …). Add the missing shaft, coupling or mesh.",
            )


MESH_LENGTHS = (
    ("Pitch radius drive", "pitch_radius_drive", _positive, "positive", "m"),
    ("Pitch radius driven", "pitch_radius_driven", _positive, "positive", "m"),
    ("Mesh stiffness", "mesh_stiffness", _positive, "positive", "N/m"),
    ("Mesh damping", "mesh_damping", _not_negative, "zero or positive", "N s/m"),
    ("Backlash", "backlash", _not_negative, "zero or positive", "m"),
    ("Angular backlash", "angular_backlash", _not_negative, "zero or positive", "rad"),
    ("Mass drive", "mass_drive", _positive, "positive", "kg"),
    ("Mass driven", "mass_driven", _positive, "positive", "kg"),
    ("Bearing stiffness drive", "bearing_stiffness_drive", _positive, "positive", "N/m"),
    ("Bearing stiffness driven", "bearing_stiffness_driven", _positive, "positive", "N/m"),
    ("Bearing damping drive", "bearing_damping_drive", _not_negative, "zero or positive", "N s/m"),
    (
        "Bearing damping driven",
        "bearing_damping_driven",
        _not_negative,
        "zero or positive",
        "N s/m",
    ),
)


def _meshes(case: CaseData) -> Iterator[Problem]:
    table = "Meshes"
    elements = {e.element: (row, e) for row, e in enumerate(case.elements, start=1) if e.element}
    yield from _names(table, "Element", [m.element for m in case.meshes], "a mesh")
    for row, m in enumerate(case.meshes, start=1):
        yield from _mesh_numbers(row, m)
        if m.element is None:
            continue
        if m.element not in elements:
            yield _wrong(
                table,
                row,
                "Element",
                m.element,
                "an element of table Elements",
                _suggest(m.element, set(elements)),
            )
            continue
        element_row, e = elements[m.element]
        if e.kind == GEAR_MESH:
            yield from _mesh_ratio(case, row, m, e)
            yield from _mesh_line_of_action(row, m, element_row, e)
        elif e.kind in ("coupling", SPRING_TO_GROUND):
            yield from _angular_clearance(row, m, element_row, e)
        elif e.kind in KINDS:
            yield _wrong(
                table,
                row,
                "Element",
                m.element,
                "a gear mesh or a geared coupling",
                f"It is a {e.kind} in table Elements, row {element_row}; correct one of the two.",
            )
    yield from _one_body(case)
    yield from _bodies(case)


def _mesh_numbers(row: int, m: MeshRow) -> Iterator[Problem]:
    """Each number of a mesh by itself."""
    table = "Meshes"
    for column, key, holds, allowed, unit in MESH_LENGTHS:
        yield from _check(table, row, column, getattr(m, key), holds, allowed, unit)
    for column, value, holds, allowed in (
        (
            "Pressure angle",
            m.pressure_angle,
            lambda v: 0 <= v < math.pi / 2,
            "from 0 to 90 degrees",
        ),
        (
            "Helix angle",
            m.helix_angle,
            lambda v: abs(v) < math.pi / 2,
            "between -90 and 90 degrees",
        ),
    ):
        action = "Write degrees with the unit deg above the column."
        yield from _check(table, row, column, value, holds, allowed, "rad", action)
    yield from _check(
        table, row, "Orientation", m.orientation, _any_number, "a finite number", "rad"
    )
    if m.gear_type not in (None, "external", "internal"):
        yield _wrong(
            table, row, "Gear type", m.gear_type, "external or internal", "Choose from the list."
        )


def _mesh_ratio(case: CaseData, row: int, m: MeshRow, e: ElementRow) -> Iterator[Problem]:
    """Pitch radii against speed ratios; a ring gear against its pinion."""
    stations = {s.station: (i, s.speed_ratio) for i, s in enumerate(case.stations, start=1)}
    drive, driven = m.pitch_radius_drive, m.pitch_radius_driven
    if not (_is_fine(drive) and _is_fine(driven)):
        return
    if e.from_ not in stations or e.to not in stations:
        return
    ratios = [1.0 if stations[n][1] is None else stations[n][1] for n in (e.from_, e.to)]
    if not all(_is_fine(r) for r in ratios):
        return
    by_speed = float(ratios[1] or 0.0) / float(ratios[0] or 1.0)
    if drive is None and driven is None:
        return  # a ratio and a sense of rotation alone, without size
    by_radii = drive / driven if drive is not None and driven is not None else by_speed
    if m.gear_type == "internal" and abs(by_radii - 1.0) <= RADIUS_TOLERANCE:
        equal = f"its pitch radius is {drive or driven:.6g} m and both stations turn equally fast"
        if drive is not None and driven is not None:
            equal = f"its pitch radii are {drive:.6g} m and {driven:.6g} m"
        yield Problem(
            "Meshes",
            row,
            "Gear type",
            m.gear_type,
            "external for two gears of the same size",
            f"found internal, but {equal}: the pinion of an internal mesh turns inside its ring, "
            "which must be larger. Choose external, or correct the pitch radii and Speed ratios; "
            "a geared coupling is an element of kind coupling.",
            tuple(
                Quoted(_number(radius, "m"), radius, ("Meshes", row, f"Pitch radius {side}"))
                for side, radius in (("drive", drive), ("driven", driven))
                if radius is not None
            ),
        )
    if drive is None or driven is None:
        return
    if abs(drive / driven / by_speed - 1.0) > RADIUS_TOLERANCE:
        yield Problem(
            "Meshes",
            row,
            "Pitch radius driven",
            driven,
            f"{drive / by_speed:.6g} m",
            f"found {driven:.6g} m: with {drive:.6g} m on the drive side the radii make a speed "
            f"ratio of {drive / driven:.6g}, but the Speed ratios in table Stations ('{e.from_}', "
            f"row {stations[e.from_][0]}, and '{e.to}', row {stations[e.to][0]}) make "
            f"{by_speed:.6g}. They must agree to 0.1 %: correct a pitch radius, or the Speed "
            f"ratio of '{e.to}' and of everything beyond it.",
            _quote(drive, "m", ("Meshes", row, "Pitch radius drive"))
            + _quote(drive / by_speed, "m"),
        )


def _mesh_line_of_action(
    row: int, m: MeshRow, element_row: int, e: ElementRow
) -> Iterator[Problem]:
    """What acts along the line of action needs a radius; what parts or damps needs a stiffness."""
    table = "Meshes"
    if m.angular_backlash is not None:
        yield _wrong(
            table,
            row,
            "Angular backlash",
            m.angular_backlash,
            "blank for a gear mesh",
            "It belongs to geared couplings; type the normal Backlash of the teeth, a length.",
            "rad",
        )
    for column, value, unit in (
        ("Mesh stiffness", m.mesh_stiffness, "N/m"),
        ("Mesh damping", m.mesh_damping, "N s/m"),
        ("Backlash", m.backlash, "m"),
    ):
        if value and m.pitch_radius_drive is None:
            yield Problem(
                table,
                row,
                "Pitch radius drive",
                None,
                f"positive where {column} is given",
                f"the cell is blank, but {column} is {_number(value, unit)}, along the line of "
                "action: without a radius it says nothing about the torque. Type the radius.",
                _quote(value, unit, (table, row, column)),
            )
            break
    if e.stiffness is not None and m.mesh_stiffness is not None:
        yield Problem(
            table,
            row,
            "Mesh stiffness",
            m.mesh_stiffness,
            "blank where Stiffness is given",
            f"found {_number(m.mesh_stiffness, 'N/m')}, but table Elements, row {element_row}, "
            f"gives '{e.element}' a Stiffness of {_number(e.stiffness, 'N m/rad')} as well. Keep "
            "one of the two.",
            _quote(e.stiffness, "N m/rad", ("Elements", element_row, "Stiffness")),
        )
    rigid = e.stiffness is None and m.mesh_stiffness is None
    blank = (
        f"Stiffness of '{e.element}' (table Elements, row {element_row}) is blank and so is Mesh "
        "stiffness (table Meshes"
    )
    if rigid and m.backlash:
        yield Problem(
            table,
            row,
            "Backlash",
            m.backlash,
            "used with a finite mesh stiffness",
            f"found {_number(m.backlash, 'm')}, but the mesh is rigid: {blank}, row {row}). Teeth "
            "that part need a stiffness to meet again: type one of the two, or clear the backlash.",
        )
    if e.stiffness == 0 and m.backlash:
        yield _clearance_without_stiffness(
            (row, "Backlash"), (m.backlash, "m"), element_row, e, "Teeth"
        )
    if rigid and m.mesh_damping:
        yield Problem(
            table,
            row,
            "Mesh damping",
            m.mesh_damping,
            "used with a finite mesh stiffness",
            f"found {_number(m.mesh_damping, 'N s/m')}, but the mesh is rigid: {blank}, row "
            f"{row}). Nothing moves in a rigid mesh: type a stiffness, or clear the damping.",
        )


def _angular_clearance(row: int, m: MeshRow, element_row: int, e: ElementRow) -> Iterator[Problem]:
    """A geared coupling or a stop has an angular clearance and nothing else of table Meshes."""
    for column, key, _, _, unit in MESH_LENGTHS:
        value = getattr(m, key)
        if value is not None and column != "Angular backlash":
            yield _wrong(
                "Meshes",
                row,
                column,
                value,
                f"blank: '{m.element}' is a {e.kind}",
                "A geared coupling, or a spring to ground with free play, has an Angular "
                "backlash; everything else here is for gear meshes.",
                unit,
            )
    if e.stiffness == 0 and m.angular_backlash:
        found = (m.angular_backlash, "rad")
        yield _clearance_without_stiffness((row, "Angular backlash"), found, element_row, e, "Ends")


def _clearance_without_stiffness(
    cell: tuple[int, str], found: tuple[float, str], element_row: int, e: ElementRow, what: str
) -> Problem:
    """A clearance in an element that has nothing to meet again with."""
    return Problem(
        "Meshes",
        cell[0],
        cell[1],
        found[0],
        "used with a positive stiffness",
        f"found {_number(*found)}, but Stiffness of '{e.element}' (table Elements, row {element_row}) is 0. "
        f"{what} that part need a stiffness to meet again: type it, or clear the "
        f"{cell[1].lower()}.",
    )


#: Data of one gear body, by side of the mesh.
BODY = (
    ("Mass", "mass"),
    ("Bearing stiffness", "bearing_stiffness"),
    ("Bearing damping", "bearing_damping"),
)
BODY_UNITS = {"mass": "kg", "bearing_stiffness": "N/m", "bearing_damping": "N s/m"}


def _one_body(case: CaseData) -> Iterator[Problem]:
    """A gear in several meshes is one body: what is repeated must agree."""
    ends = {e.element: (e.from_, e.to) for e in case.elements}
    first: dict[tuple[str, str], tuple[int, str, float]] = {}
    for row, m in enumerate(case.meshes, start=1):
        for side, station in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for header, key in BODY:
                unit = BODY_UNITS[key]
                value = getattr(m, f"{key}_{side}")
                if value is None or station is None:
                    continue
                column = f"{header} {side}"
                seen = first.setdefault((station, key), (row, column, value))
                if abs(value - seen[2]) > 1e-9 * abs(seen[2]):
                    yield _wrong(
                        "Meshes",
                        row,
                        column,
                        value,
                        f"{_number(seen[2], unit)} as in row {seen[0]}, {seen[1]}",
                        f"Both are of the gear '{station}', which is one body; leave one of them "
                        "blank or make them equal.",
                        unit,
                        _quote(seen[2], unit, ("Meshes", seen[0], seen[1])),
                    )


def _bodies(case: CaseData) -> Iterator[Problem]:
    """A gear on bearings has mass and stiffness, in whatever row, and meshes that can push it."""
    ends = {e.element: (e.from_, e.to) for e in case.elements if e.kind == GEAR_MESH}
    gears: dict[str, dict[str, tuple[int, str, float]]] = {}
    for row, m in enumerate(case.meshes, start=1):
        for side, station in zip(("drive", "driven"), ends.get(m.element, ()), strict=False):
            for header, key in BODY:
                value = getattr(m, f"{key}_{side}")
                undamped = key == "bearing_damping" and value == 0.0
                if value is not None and station is not None and not undamped:
                    gear = gears.setdefault(station, {})
                    gear.setdefault(key, (row, f"{header} {side}", value))
    for station, gear in gears.items():
        if all(_is_fine(value) for _, _, value in gear.values()):  # else told already
            yield from _whole_body(station, gear)
    meshes: dict[str | None, tuple[int, MeshRow]] = {}
    for row, m in enumerate(case.meshes, start=1):
        meshes.setdefault(m.element, (row, m))
    for element_row, e in enumerate(case.elements, start=1):
        given = [gears[name] for name in (e.from_, e.to) if name in gears]
        if e.kind == GEAR_MESH and given and e.element is not None:
            row, column, _ = next(iter(given[0].values()))
            data = f"{column} of table Meshes, row {row}, puts one of its gears on bearings"
            yield from _pushed_body(element_row, e, meshes.get(e.element), data)


def _whole_body(station: str, gear: dict[str, tuple[int, str, float]]) -> Iterator[Problem]:
    """Mass, bearing stiffness and bearing damping of one gear: which of them need which."""
    for needed, header, action in (
        (
            "bearing_stiffness",
            "Bearing stiffness",
            "A gear moves sideways only on bearings that give: type their stiffness here or in "
            "another row of this gear",
        ),
        (
            "mass",
            "Mass",
            "A bearing without mass has no motion of its own: type the mass of the gear with its "
            "share of the shaft here or in another row of this gear",
        ),
    ):
        if needed in gear:
            continue
        key, (row, column, value) = next(iter(gear.items()))
        yield Problem(
            "Meshes",
            row,
            f"{header} {column.split()[-1]}",
            None,
            f"positive where {column} is given",
            f"the cell is blank, but {column} of the gear '{station}' is "
            f"{_number(value, BODY_UNITS[key])}. {action}, or clear the {column}.",
            _quote(value, BODY_UNITS[key], ("Meshes", row, column)),
        )


def _pushed_body(
    element_row: int, e: ElementRow, found: tuple[int, MeshRow] | None, data: str
) -> Iterator[Problem]:
    """The mesh of a gear on bearings: it needs a line of action and a finite stiffness."""
    if found is None:
        yield Problem(
            "Meshes",
            None,
            "Element",
            None,
            "with a row for every mesh of a gear on bearings",
            f"'{e.element}' (table Elements, row {element_row}) has no row here, but {data}. Add "
            "its row with the Pitch radius drive and the Orientation, or clear the bearing data.",
        )
        return
    row, m = found
    if m.pitch_radius_drive is None:
        yield Problem(
            "Meshes",
            row,
            "Pitch radius drive",
            None,
            "positive where a gear has bearings",
            f"the cell is blank, but {data}: without a radius a torque says nothing about the "
            "force. Type the radius, or clear the bearing data.",
        )
    if not e.stiffness and not m.mesh_stiffness:
        rigid = e.stiffness is None
        yield Problem(
            "Meshes",
            row,
            "Mesh stiffness",
            None,
            "positive, or a positive Stiffness, where a gear has bearings",
            f"{data}, but the mesh {'is rigid' if rigid else 'has none'}: Stiffness of "
            f"'{e.element}' (table Elements, row {element_row}) is {'blank' if rigid else '0'} "
            f"and Mesh stiffness (table Meshes, row {row}) is blank. Type one of the two, or "
            "clear the bearing data.",
        )


# --- torques ------------------------------------------------------------------------------------


def _known_station(
    case: CaseData, table: str, row: int, station: str | None, column: str = "Station"
) -> Iterator[Problem]:
    known = {s.station for s in case.stations if s.station}
    if station is None:
        yield _missing(table, row, column, "a station of table Stations", "Choose it.")
    elif station not in known:
        yield _wrong(
            table, row, column, station, "a station of table Stations", _suggest(station, known)
        )


def _curve(
    case: CaseData,
    table: str,
    rows: Sequence[Any],
    abscissa: str,
    header: str,
    values: Sequence[tuple[str, str]],
) -> Iterator[Problem]:
    """One curve a station: known stations, no blanks, abscissa strictly rising."""
    last: dict[str, tuple[int, float]] = {}
    for row, point in enumerate(rows, start=1):
        yield from _known_station(case, table, row, point.station)
        x = getattr(point, abscissa)
        if x is None:
            yield _missing(table, row, header, "a number", "Fill it or clear the whole row.")
        elif not math.isfinite(x) or x < 0:
            yield _wrong(table, row, header, x, "zero or positive", "Correct the cell.")
        elif point.station in last and x <= last[point.station][1]:
            before, previous = last[point.station]
            yield _wrong(
                table,
                row,
                header,
                x,
                f"above {previous:.6g} of row {before}",
                f"The rows of '{point.station}' must be in rising order, no value twice"
                + (" (for a step, two rows a microsecond apart)." if header == "Time" else "."),
            )
        elif point.station is not None:
            last[point.station] = (row, x)
        for column, key in values:
            value = getattr(point, key)
            if value is None:
                yield _missing(table, row, column, "a number", "Fill it (0 where there is none).")
            elif not math.isfinite(value):
                yield _wrong(table, row, column, value, "a finite number", "Correct the cell.")


def _single_points(table: str, rows: Sequence[Any], header: str) -> Iterator[Problem]:
    """Stations with one row only, where one point makes no curve."""
    stations = [point.station for point in rows]
    for row, station in enumerate(stations, start=1):
        if station is not None and stations.count(station) == 1:
            yield Problem(
                table,
                row,
                "Station",
                station,
                "on two or more rows",
                f"found one row only for '{station}': a curve needs two points or more. "
                f"Add rows of other {header.lower()}s.",
            )


def _torques(case: CaseData) -> Iterator[Problem]:
    yield from _curve(
        case,
        "MotorTorque",
        case.motor_torque,
        "speed",
        "Speed",
        (("Average", "average"), ("Pulsating", "pulsating")),
    )
    yield from _curve(
        case, "LoadTorque", case.load_torque, "speed", "Speed", (("Torque", "torque"),)
    )
    yield from _curve(case, "TorqueTime", case.torque_time, "time", "Time", (("Torque", "torque"),))
    yield from _single_points("MotorTorque", case.motor_torque, "Speed")
    yield from _single_points("TorqueTime", case.torque_time, "Time")
    speeds = [("MotorTorque", row, p.speed) for row, p in enumerate(case.motor_torque, start=1)]
    speeds += [("LoadTorque", row, p.speed) for row, p in enumerate(case.load_torque, start=1)]
    for table, row, speed in speeds:
        if speed is not None:
            yield from _check(
                table,
                row,
                "Speed",
                speed,
                lambda v: v <= TOP_SPEED,
                f"at most {TOP_SPEED:g} ({100 * TOP_SPEED:g} %) of synchronous speed",
                "",
                "Write 50 % or 900 rpm; a plain number in JSON is a fraction of synchronous speed.",
            )
    for row, motor in enumerate(case.motor_torque, start=1):
        yield from _check(
            "MotorTorque",
            row,
            "Pulsating",
            motor.pulsating,
            _not_negative,
            "zero or positive",
            "N m",
        )
    for row, load in enumerate(case.load_torque, start=1):
        yield from _check(
            "LoadTorque",
            row,
            "Torque",
            load.torque,
            _not_negative,
            "zero or positive",
            "N m",
            "A load opposes the motion: type its size.",
        )
    yield from _motor_place(case)
    if not (_is_fine(case.line_frequency) and _is_fine(case.synchronous_speed)):
        return  # reported already
    if not _whole_poles(case):
        return
    ratings = case.ratings
    if case.motor_torque and ratings.synchronous_speed is None:
        yield Problem(
            "Case",
            None,
            "SynchronousSpeed",
            None,
            "given where MotorTorque is",
            "torque curves are given, but neither SynchronousSpeed nor LineFrequency with Poles: "
            "the curves have no speed. Type two of LineFrequency, SynchronousSpeed and Poles.",
        )
    elif case.motor_torque and ratings.line_frequency is None:
        yield Problem(
            "Case",
            None,
            "LineFrequency",
            None,
            "given where MotorTorque is",
            "a motor is given, but no LineFrequency (or Poles): the slip frequency is unknown. "
            "Type it.",
        )


def _motor_place(case: CaseData) -> Iterator[Problem]:
    """A motor on the reference shaft, and a train it can turn."""
    motors = {p.station for p in case.motor_torque}
    placed = [(row, s) for row, s in enumerate(case.stations, start=1) if s.station in motors]
    if placed and all(s.speed_ratio not in (None, 1.0) for _, s in placed):
        row, s = placed[0]
        yield Problem(
            "Stations",
            row,
            "Speed ratio",
            s.speed_ratio,
            "1 (or blank) at a motor",
            f"found {_number(s.speed_ratio)} at '{s.station}', where the motor acts: its shaft is "
            "the reference shaft, to which SynchronousSpeed and all speed ratios refer. Type 1 "
            "there and the other ratios to it.",
        )
    for row, e in enumerate(case.elements, start=1):
        grounded = e.kind == SPRING_TO_GROUND or GROUND in (e.from_, e.to)
        if placed and grounded and (e.stiffness is None or e.stiffness > 0):
            yield Problem(
                "Elements",
                row,
                "From" if e.from_ == GROUND else "To",
                GROUND,
                "a station, where a motor is to start the train",
                f"found ground: '{e.element}' holds the train, so that its motor (table "
                "MotorTorque) cannot start it. Clear the element or the motor's rows; a damper "
                "to ground has Stiffness 0.",
            )


# --- fatigue ------------------------------------------------------------------------------------


def _materials(case: CaseData) -> Iterator[Problem]:
    table = "Materials"
    yield from _names(table, "Material", [m.material for m in case.materials], "a material")
    for row, m in enumerate(case.materials, start=1):
        for column, value in (("UTS", m.uts), ("Yield", m.yield_), ("Endurance", m.endurance)):
            yield from _check(table, row, column, value, _positive, "positive", "Pa")
        if m.uts and m.yield_ and m.yield_ > m.uts > 0:
            yield _wrong(table, row, "Yield", m.yield_, "at most UTS", "Correct one of them.", "Pa")
        if m.basis not in (None, "torsion", "bending"):
            yield _wrong(
                table, row, "Basis", m.basis, "torsion or bending", "Choose from the list."
            )
        if m.below_endurance not in (None, "none", "same slope", "2k-1"):
            yield _wrong(
                table,
                row,
                "Below endurance",
                m.below_endurance,
                "none, same slope or 2k-1",
                "Choose from the list.",
            )


def _sn_points(case: CaseData) -> Iterator[Problem]:
    table = "SNPoints"
    known = {m.material for m in case.materials if m.material}
    curves: dict[str, list[tuple[int, float, float]]] = {}
    for row, p in enumerate(case.sn_points, start=1):
        if p.material is None:
            yield _missing(table, row, "Material", "a material of table Materials", "Choose it.")
        elif p.material not in known:
            yield _wrong(
                table,
                row,
                "Material",
                p.material,
                "a material of table Materials",
                _suggest(p.material, known),
            )
        for column, value, unit in (("Cycles", p.cycles, ""), ("Stress", p.stress, "Pa")):
            if value is None:
                yield _missing(table, row, column, "positive", "Fill it or clear the whole row.")
            yield from _check(table, row, column, value, _positive, "positive", unit)
        if p.material and p.cycles and p.stress and p.cycles > 0 and p.stress > 0:
            curves.setdefault(p.material, []).append((row, p.cycles, p.stress))
    for material, points in curves.items():
        for (_, n0, s0), (row, n1, s1) in pairwise(points):
            if n1 <= n0 or s1 >= s0:
                column = "Cycles" if n1 <= n0 else "Stress"
                yield _wrong(
                    table,
                    row,
                    column,
                    n1 if n1 <= n0 else s1,
                    "such that cycles rise and stress falls from row to row",
                    f"The S-N line of '{material}' must fall; order its rows from few cycles to "
                    "many.",
                )
        if len(points) == 1 and sum(p.material == material for p in case.sn_points) == 1:
            yield Problem(
                table,
                points[0][0],
                "Material",
                material,
                "two or more points",
                f"'{material}' has one S-N point only; a line needs two. Add a point or clear the "
                "row.",
            )
        endurance = next((m.endurance for m in case.materials if m.material == material), None)
        row = next((i for i, m in enumerate(case.materials, start=1) if m.material == material), 1)
        if endurance and endurance > points[-1][2] * (1 + 1e-9) and len(points) > 1:
            yield _wrong(
                "Materials",
                row,
                "Endurance",
                endurance,
                f"at most the lowest S-N stress of '{material}' ({points[-1][2]:.6g} Pa)",
                "Correct it, or drop the S-N points below the endurance limit.",
                "Pa",
            )


# --- the rest -----------------------------------------------------------------------------------


def _mode_damping(case: CaseData) -> Iterator[Problem]:
    seen: dict[int, int] = {}
    for row, m in enumerate(case.mode_damping, start=1):
        if m.mode is None:
            yield _missing(
                "ModeDamping", row, "Mode", "the number of an elastic mode", "Count from 1."
            )
        elif m.mode < 1 or m.mode != int(m.mode):
            yield _wrong(
                "ModeDamping",
                row,
                "Mode",
                m.mode,
                "a whole number, 1 or more",
                "The lowest elastic mode is 1.",
            )
        elif m.mode in seen:
            yield _wrong(
                "ModeDamping",
                row,
                "Mode",
                m.mode,
                f"given once (row {seen[m.mode]})",
                "Clear one row.",
            )
        else:
            seen[m.mode] = row
        if m.damping_ratio is None:
            yield _missing(
                "ModeDamping", row, "Damping ratio", "at least 0 and below 1", "Type it."
            )
        yield from _check(
            "ModeDamping",
            row,
            "Damping ratio",
            m.damping_ratio,
            lambda v: 0 <= v < 1,
            "at least 0 and below 1 (100 %)",
        )


def _excitations(case: CaseData) -> Iterator[Problem]:
    table = "Excitations"
    yield from _names(table, "Name", [x.name for x in case.excitations], "an excitation")
    for row, x in enumerate(case.excitations, start=1):
        if (x.order is None) == (x.frequency is None):
            found = "both" if x.order is not None else None
            yield Problem(
                table,
                row,
                "Order",
                found,
                "either an Order or a Frequency",
                "an excitation needs either an Order (multiple of a shaft speed) or a Frequency, "
                "not both and not "
                "neither. Fill one of the two.",
            )
        yield from _check(table, row, "Order", x.order, _positive, "positive")
        yield from _check(table, row, "Frequency", x.frequency, _positive, "positive", "Hz")
        yield from _check(table, row, "Torque", x.torque, _positive, "positive", "N m")
        yield from _check(table, row, "Torque", x.torque_share, _positive, "positive")
        if x.torque is not None and x.torque_share is not None:
            yield Problem(
                table,
                row,
                "Torque",
                x.torque,
                "a torque or a share of the torque there",
                f"found both {_number(x.torque, 'N m')} and a share of {_number(x.torque_share)} "
                "of the transmitted torque. Keep one of the two.",
            )
        for column, name in (("Of station", x.of_station), ("Station", x.station)):
            if name is not None:
                yield from _known_station(case, table, row, name, column)


#: Effects that need data before they can be forced on: effect, whether the data are there, the
#: cells to fill.
EFFECT_DATA: tuple[tuple[str, Callable[[CaseData], bool], str], ...] = (
    ("pull-in", lambda case: case.field_slip is not None, "FieldSlip and PullOutTorque"),
    (
        "breaker closing",
        lambda case: case.shock_amplitude is not None,
        "ShockAmplitude and ShockTimeConstant",
    ),
    ("aborted start", lambda case: case.trip_speed is not None, "TripSpeed"),
    (
        "backlash",
        lambda case: any(m.backlash or m.angular_backlash for m in case.meshes),
        "Backlash or Angular backlash in table Meshes",
    ),
    (
        "bearings",
        lambda case: any(
            m.bearing_stiffness_drive or m.bearing_stiffness_driven for m in case.meshes
        ),
        "a bearing stiffness and the mass of its gear in table Meshes",
    ),
)


def _effect_choices(case: CaseData) -> Iterator[Problem]:
    table = "EffectChoices"
    yield from _names(table, "Effect", [e.effect for e in case.effect_choices], "an effect")
    for row, e in enumerate(case.effect_choices, start=1):
        if e.effect and e.effect not in EFFECTS:
            allowed = "one of " + ", ".join(EFFECTS)
            yield _wrong(table, row, "Effect", e.effect, allowed, _suggest(e.effect, set(EFFECTS)))
        if e.choice not in (None, *EFFECT_CHOICES):
            yield _wrong(table, row, "Choice", e.choice, "auto, on or off", "Choose from the list.")
        for effect, is_given, cells in EFFECT_DATA:
            if e.choice == "on" and e.effect == effect and not is_given(case):
                yield _wrong(
                    table,
                    row,
                    "Choice",
                    e.choice,
                    f"auto or off while {cells} {'are' if ' and ' in cells else 'is'} "
                    + ("blank or 0" if effect == "backlash" else "blank"),
                    f"There is nothing to simulate: fill {cells}, or choose auto.",
                )


CHECKS: tuple[Callable[[CaseData], Iterator[Problem]], ...] = (
    _scalars,
    _stations,
    _elements,
    _meshes,
    _mode_damping,
    _torques,
    _materials,
    _sn_points,
    _excitations,
    _effect_choices,
)


def find_problems(
    case: CaseData, bad_cells: frozenset[tuple[str, int | None, str]] = frozenset()
) -> tuple[Problem, ...]:
    """Everything wrong with a case.

    Parameters
    ----------
    case : CaseData
        What was typed. [SI]
    bad_cells : frozenset of (table, row, column)
        Cells the reader has already reported; nothing is said of them again. [names]

    Returns
    -------
    tuple of Problem
        Empty if the case may be calculated; one problem a cell, the first found. [count]
    """
    found: list[Problem] = []
    told = set(bad_cells)
    for p in (p for check in CHECKS for p in check(case)):
        place = (p.table, p.row, p.column)
        if place not in told:
            found.append(p)
            told.add(place)
    spoilt = {"Stations", "Elements"} & ({p.table for p in found} | {b[0] for b in bad_cells})
    if not spoilt:
        found.extend(_connected(case))
    order = {name: i for i, name in enumerate(("Case", *TABLES))}
    return tuple(sorted(found, key=lambda p: (order.get(p.table, 99), p.row or 0)))
