"""Checks of the scalars of the case: each by itself, and those that contradict each other."""

from __future__ import annotations

import math
from collections.abc import Iterator

from engine.case.checks.problem import (
    ANY_NUMBER,
    BELOW_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    Allowed,
    check_number,
    possible_poles,
    possible_ratings,
    quote_quantity,
    wrong_value,
)
from engine.case.choices import (
    ContactLaw,
    HistoryFile,
    MarginBasis,
    Method,
    RainflowResidue,
    StressBasis,
)
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_END_SPEED, LEAST_PEAK_ERROR, LEAST_TOLERANCE_PEAK
from engine.errors import Problem

#: Line frequency, speed and poles, or power, speed and torque, must agree to this share.
RATING_TOLERANCE = 5e-3
#: Voltage over that of the torque curves; more is a percent sign forgotten.
LARGEST_VOLTAGE = 2.0


CHOICES = {
    "margin_basis": ("MarginBasis", tuple(MarginBasis)),
    "stress_basis": ("StressBasis", tuple(StressBasis)),
    "method": ("Method", tuple(Method)),
    "keep_history": ("KeepHistory", tuple(HistoryFile)),
    "rainflow_residue": ("RainflowResidue", tuple(RainflowResidue)),
    "contact_law": ("ContactLaw", tuple(ContactLaw)),
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


def check_scalars(case: CaseData) -> Iterator[Problem]:
    """Each scalar by itself, then those that depend on each other."""
    for key, (name, unit) in POSITIVE_SCALARS.items():
        action = POSITIVE_ACTIONS.get(key, "Correct the cell.")
        value = getattr(case, key)
        yield from check_number("Case", None, name, value, POSITIVE, unit, action)
    for key, (name, unit) in FINITE_SCALARS.items():
        value = getattr(case, key)
        yield from check_number("Case", None, name, value, ANY_NUMBER, unit)
    yield from check_number(
        "Case",
        None,
        "PullInDamping",
        case.pull_in_damping,
        NOT_NEGATIVE,
        "N m s/rad",
    )
    for key, (name, words) in CHOICES.items():
        value = getattr(case, key)
        if value is not None and value not in words:
            allowed = "one of " + ", ".join(words)
            yield wrong_value("Case", None, name, value, allowed, "Choose from the list.")
    yield from check_number(
        "Case",
        None,
        "DampingRatio",
        case.damping_ratio,
        BELOW_ONE,
        "",
        "1 % to 3 % is usual for a geared train.",
    )
    yield from check_number(
        "Case",
        None,
        "MarginRequired",
        case.margin_required,
        BELOW_ONE,
    )
    yield from check_number(
        "Case",
        None,
        "Voltage",
        case.voltage,
        Allowed(
            lambda v: 0 < v <= LARGEST_VOLTAGE,
            "positive and at most 2 (200 % of the voltage of the curves)",
        ),
        "",
        "Write 80 % or 0.8.",
    )
    yield from check_number(
        "Case",
        None,
        "FieldSlip",
        case.field_slip,
        Allowed(lambda v: 0 < v < 1, "between 0 and 1 (100 %)"),
    )
    yield from check_number(
        "Case",
        None,
        "TolerancePeak",
        case.tolerance_peak,
        Allowed(
            lambda v: LEAST_TOLERANCE_PEAK <= v <= 0.5,
            f"between {LEAST_TOLERANCE_PEAK:g} and 0.5 (50 %)",
        ),
        "",
        "Correct the cell or leave it blank for 0.1 %. No peak torque is calculated to better than "
        f"{LEAST_PEAK_ERROR:g}, so that a smaller tolerance is never met.",
    )
    yield from check_number(
        "Case",
        None,
        "ToleranceStarts",
        case.tolerance_starts,
        Allowed(lambda v: 1e-9 <= v <= 0.5, "between 1e-9 and 0.5 (50 %)"),
    )
    if not possible_poles(case):
        yield wrong_value(
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
    synchronous, trip = possible_ratings(case).synchronous_speed, case.trip_speed
    if trip is None or not synchronous or not math.isfinite(trip):
        return
    if trip > synchronous * (1 + 1e-12):
        yield wrong_value(
            "Case",
            None,
            "TripSpeed",
            trip,
            f"at most synchronous speed ({synchronous:.6g} rad/s)",
            "The start is aborted when the motor comes to this speed.",
            "rad/s",
            quote_quantity(synchronous, "rad/s"),
        )
        return
    end = case.end_speed or DEFAULT_END_SPEED * synchronous
    if case.field_slip is None and trip > end * (1 + 1e-12):
        stated = "EndSpeed" if case.end_speed else "EndSpeed (blank = 97 % of synchronous)"
        yield wrong_value(
            "Case",
            None,
            "TripSpeed",
            trip,
            f"at most {stated}, {end:.6g} rad/s",
            "Without field the start ends there and would never trip. Lower TripSpeed, raise "
            "EndSpeed, or give FieldSlip and PullOutTorque.",
            "rad/s",
            quote_quantity(end, "rad/s", ("Case", None, "EndSpeed")),
        )


def _ratings(case: CaseData) -> Iterator[Problem]:
    """Contradictions among frequency, speed, poles and among power, speed, torque."""
    if possible_ratings(case).synchronous_speed is None:
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
    speed = possible_ratings(case).synchronous_speed
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
                quote_quantity(torque, "N m")
                + quote_quantity(case.rated_power, "W", ("Case", None, "RatedPower")),
            )


def _speed_range(case: CaseData) -> Iterator[Problem]:
    low, high = case.minimum_speed, case.maximum_speed
    synchronous = possible_ratings(case).synchronous_speed
    low = low if low is not None else synchronous
    high = high if high is not None else synchronous
    if low and high and low > high * (1 + 1e-12):
        name, speed = ("MinimumSpeed", case.minimum_speed)
        if speed is None:
            name, speed = ("MaximumSpeed", case.maximum_speed)
        yield wrong_value(
            "Case",
            None,
            name,
            speed,
            "at most MaximumSpeed" if name == "MinimumSpeed" else "at least MinimumSpeed",
            f"The range is {low:.6g} rad/s to {high:.6g} rad/s; where one of them is blank it is "
            "the synchronous speed.",
            "rad/s",
            quote_quantity(low, "rad/s", ("Case", None, "MinimumSpeed"))
            + quote_quantity(high, "rad/s", ("Case", None, "MaximumSpeed")),
        )
    if case.end_speed and synchronous and case.end_speed > synchronous * (1 + 1e-12):
        yield wrong_value(
            "Case",
            None,
            "EndSpeed",
            case.end_speed,
            f"at most synchronous speed ({synchronous:.6g} rad/s)",
            "Without field a motor settles below synchronism; blank = 97 %.",
            "rad/s",
            quote_quantity(synchronous, "rad/s"),
        )
