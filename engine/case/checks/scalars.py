"""Checks of the scalars of the case: each by itself, and those that contradict each other."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import StrEnum

from engine.case.checks.problem import (
    ANY_NUMBER,
    BELOW_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    SCALARS,
    VOLTAGE,
    Allowed,
    Limit,
    possible_poles,
    possible_ratings,
    quote_quantity,
)
from engine.case.choices import (
    ContactLaw,
    HistoryFile,
    InitialState,
    MarginBasis,
    MeanStress,
    Method,
    RainflowResidue,
    Scanned,
    Standard,
    StressBasis,
    TorqueFollows,
)
from engine.case.data import CaseData, value_of
from engine.case.defaults import (
    DEFAULT_END_SPEED,
    LEAST_PEAK_ERROR,
    LEAST_TOLERANCE_PEAK,
    LEAST_TOLERANCE_STARTS,
)
from engine.errors import Problem

#: Line frequency, speed and poles, or power, speed and torque, must agree to this share.
RATING_TOLERANCE = 5e-3

QUANTITIES = (
    Limit("LineFrequency", POSITIVE, "Hz"),
    Limit("SynchronousSpeed", POSITIVE, "rad/s"),
    Limit("RatedPower", POSITIVE, "W"),
    Limit("RatedTorque", POSITIVE, "N m"),
    Limit("MinimumSpeed", POSITIVE, "rad/s"),
    Limit("MaximumSpeed", POSITIVE, "rad/s"),
    Limit("EndSpeed", POSITIVE, "rad/s"),
    Limit("MaximumTime", POSITIVE, "s"),
    Limit("StartsRequired", POSITIVE),
    Limit("StartsFactor", POSITIVE),
    Limit("ShockTimeConstant", POSITIVE, "s"),
    Limit(
        "FieldTimeConstant",
        POSITIVE,
        "s",
        "Leave the cell blank if the field is at full strength at once.",
    ),
    Limit("TripSpeed", POSITIVE, "rad/s"),
    Limit("PullOutTorque", POSITIVE, "N m"),
    Limit("ShockAmplitude", ANY_NUMBER, "N m"),
    Limit("FieldAngle", ANY_NUMBER, "rad"),
    Limit("PulsationPhase", ANY_NUMBER, "rad"),
    Limit("PullInDamping", NOT_NEGATIVE, "N m s/rad"),
)
CHOICES: dict[str, type[StrEnum]] = {
    "Standard": Standard,
    "MarginBasis": MarginBasis,
    "StressBasis": StressBasis,
    "InitialState": InitialState,
    "TorqueFollows": TorqueFollows,
    "Method": Method,
    "KeepHistory": HistoryFile,
    "RainflowResidue": RainflowResidue,
    "MeanStress": MeanStress,
    "ContactLaw": ContactLaw,
}
SHARES = (
    Limit("DampingRatio", BELOW_ONE, "", "1 % to 3 % is usual for a geared train."),
    Limit(
        "DampingRange",
        BELOW_ONE,
        "",
        "It is a share of all damping: 30 % makes a damping ratio of 2 % one of 1.4 %.",
    ),
    Limit("MarginRequired", BELOW_ONE),
    VOLTAGE,
    Limit("FieldSlip", Allowed(lambda v: 0 < v < 1, "between 0 and 1 (100 %)")),
    Limit(
        "TolerancePeak",
        Allowed(
            lambda v: LEAST_TOLERANCE_PEAK <= v <= 0.5,
            f"between {LEAST_TOLERANCE_PEAK:g} and 0.5 (50 %)",
        ),
        "",
        "Correct the cell or leave it blank for 0.1 %. Peak torques are calculated to "
        f"{LEAST_PEAK_ERROR:g} at best; a smaller tolerance cannot be met.",
    ),
    Limit(
        "ToleranceStarts",
        Allowed(
            lambda v: LEAST_TOLERANCE_STARTS <= v <= 0.5,
            f"between {LEAST_TOLERANCE_STARTS:g} and 0.5 (50 %)",
        ),
    ),
)


def check_scalars(case: CaseData) -> Iterator[Problem]:
    """Each scalar by itself, then those that depend on each other."""
    yield from SCALARS.numbers(case, QUANTITIES)
    for name, words in CHOICES.items():
        yield from SCALARS.choice(name, value_of(case, name), words)
    if isinstance(case.pulsation_phase, str):
        yield from SCALARS.choice(
            "PulsationPhase", case.pulsation_phase, Scanned, "a number, or worst"
        )
    yield from SCALARS.numbers(case, SHARES)
    if not possible_poles(case):
        action = "Poles are counted, not pole pairs."
        yield SCALARS.wrong("Poles", case.poles, "an even number, 2 or more", action)
    yield from _ratings(case)
    yield from _speed_range(case)
    yield from _partners(case)
    yield from _own_margin(case)
    yield from _trip(case)


_SLIP = "the slip at which the field is applied"
#: Scalars that mean something only beside another: name, name of the other, what the other is.
PARTNERS = (
    (
        "ShockAmplitude",
        "ShockTimeConstant",
        "the decay time of the transient at breaker closing",
    ),
    ("ShockTimeConstant", "ShockAmplitude", "the amplitude of the transient at breaker closing"),
    ("FieldSlip", "PullOutTorque", "the torque that pulls the motor into step"),
    ("PullOutTorque", "FieldSlip", _SLIP),
    ("FieldTimeConstant", "FieldSlip", _SLIP),
    ("FieldAngle", "FieldSlip", _SLIP),
    ("PullInDamping", "FieldSlip", _SLIP),
)


def _partners(case: CaseData) -> Iterator[Problem]:
    """Numbers of an electrical effect without the one that they need."""
    for name, other, meaning in PARTNERS:
        if value_of(case, name) is not None and value_of(case, other) is None:
            yield SCALARS.problem(
                other,
                None,
                f"given where {name} is",
                f"the cell is blank, but {name} is given; it must be given where {name} is. Type "
                f"{other}, {meaning}, or clear {name}.",
            )


def _own_margin(case: CaseData) -> Iterator[Problem]:
    """A standard of one's own has the margin that is typed."""
    if case.standard == Standard.OWN and case.margin_required is None:
        yield SCALARS.problem(
            "MarginRequired",
            None,
            "a margin, where Standard is own",
            "the cell is blank, but Standard is own; no margin can be judged. Type MarginRequired, for example 15 %, or "
            "choose another Standard.",
        )


def _trip(case: CaseData) -> Iterator[Problem]:
    """A trip speed that no start comes to."""
    synchronous, trip = possible_ratings(case).synchronous_speed, case.trip_speed
    if trip is None or not synchronous or not math.isfinite(trip):
        return
    if trip > synchronous * (1 + 1e-12):
        action = "The start is aborted when the motor reaches this speed."
        yield _above_synchronous("TripSpeed", trip, synchronous, action)
        return
    end = case.end_speed or DEFAULT_END_SPEED * synchronous
    if case.field_slip is None and trip > end * (1 + 1e-12):
        stated = "EndSpeed" if case.end_speed else "EndSpeed (blank = 97 % of synchronous)"
        yield SCALARS.wrong(
            "TripSpeed",
            trip,
            f"at most {stated}, {end:.6g} rad/s",
            "Without field the start ends at EndSpeed and never reaches TripSpeed. Lower TripSpeed, raise "
            "EndSpeed, or give FieldSlip and PullOutTorque.",
            "rad/s",
            quote_quantity(end, "rad/s", (*SCALARS, "EndSpeed")),
        )


def _above_synchronous(name: str, speed: float, synchronous: float, action: str) -> Problem:
    allowed = f"at most synchronous speed ({synchronous:.6g} rad/s)"
    quoted = quote_quantity(synchronous, "rad/s")
    return SCALARS.wrong(name, speed, allowed, action, "rad/s", quoted)


def _ratings(case: CaseData) -> Iterator[Problem]:
    """Contradictions among frequency, speed, poles and among power, speed, torque."""
    speed = possible_ratings(case).synchronous_speed
    if speed is None:
        return  # nothing to compare, or reported already
    if case.line_frequency and case.synchronous_speed:
        pairs = case.poles // 2 if case.poles else None
        natural = 2.0 * math.pi * case.line_frequency / case.synchronous_speed
        wanted = float(pairs) if pairs else float(max(1, round(natural)))
        if abs(natural / wanted - 1.0) > RATING_TOLERANCE:
            rpm = 60.0 * case.line_frequency / wanted
            yield SCALARS.problem(
                "SynchronousSpeed",
                case.synchronous_speed,
                f"{rpm:.6g} rpm with {2 * wanted:.0f} poles at {case.line_frequency:.6g} Hz",
                f"found {case.synchronous_speed * 30 / math.pi:.6g} rpm, but {2 * wanted:.0f} "
                f"poles at {case.line_frequency:.6g} Hz give {rpm:.6g} rpm. Correct "
                "SynchronousSpeed, Poles or LineFrequency, or leave one of them blank.",
            )
    if case.rated_power and case.rated_torque and speed:
        torque = case.rated_power / speed
        if abs(case.rated_torque / torque - 1.0) > RATING_TOLERANCE:
            yield SCALARS.problem(
                "RatedTorque",
                case.rated_torque,
                f"{torque:.6g} N m",
                f"found {case.rated_torque:.6g} N m, but {case.rated_power:.6g} W at "
                f"{speed * 30 / math.pi:.6g} rpm give {torque:.6g} N m. Correct RatedTorque or "
                "RatedPower, or leave one of them blank.",
                quote_quantity(torque, "N m")
                + quote_quantity(case.rated_power, "W", (*SCALARS, "RatedPower")),
            )


def _speed_range(case: CaseData) -> Iterator[Problem]:
    low, high = case.minimum_speed, case.maximum_speed
    synchronous = possible_ratings(case).synchronous_speed
    low = low if low is not None else synchronous
    high = high if high is not None else synchronous
    if low and high and low > high * (1 + 1e-12):
        name, speed, allowed = "MinimumSpeed", case.minimum_speed, "at most MaximumSpeed"
        if speed is None:
            name, speed, allowed = "MaximumSpeed", case.maximum_speed, "at least MinimumSpeed"
        yield SCALARS.wrong(
            name,
            speed,
            allowed,
            f"MinimumSpeed is {low:.6g} rad/s, MaximumSpeed {high:.6g} rad/s; a blank one is the "
            "synchronous speed. Correct one of them.",
            "rad/s",
            quote_quantity(low, "rad/s", (*SCALARS, "MinimumSpeed"))
            + quote_quantity(high, "rad/s", (*SCALARS, "MaximumSpeed")),
        )
    if case.end_speed and synchronous and case.end_speed > synchronous * (1 + 1e-12):
        action = (
            "Without field a motor settles below synchronous speed. Lower EndSpeed; blank = 97 %."
        )
        yield _above_synchronous("EndSpeed", case.end_speed, synchronous, action)
