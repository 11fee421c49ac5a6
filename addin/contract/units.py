"""Shown unit ↔ SI: the only home of rpm, psi, lbf*in, degrees, percent and per unit.

The usual units stand in a table of factors, so that an ordinary workbook is read without loading
pint (0.3 s); every other unit goes through pint, and a test holds the table against it.

A revolution and a radian are both pure numbers, so dimensions alone cannot tell a speed from a
frequency. Here an angle in the unit (rpm, rad/s, deg/s) makes it a rotation, no angle (Hz, 1/min)
makes it cycles; speeds become rad/s and frequencies Hz whichever of the two was typed.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from addin.contract.problems import as_seen, nearest, shortened
from addin.contract.tables import DIMENSIONS

#: What a relative unit is a share of.
RATED_TORQUE = "rated torque"
SYNCHRONOUS_SPEED = "synchronous speed"
STATION_SPEED = "speed of the station at synchronism"
TRANSMITTED_TORQUE = "torque transmitted at that station"
#: What a resistance or reactance in ohm is divided by.
BASE_IMPEDANCE = "Voltage² / Apparent power of the motor"


@dataclass(frozen=True)
class UnitScale:
    """What one shown unit is worth."""

    factor: float  #: SI value of one shown unit. [SI unit per shown unit]
    #: Empty, or what the number has to be multiplied by (`RATED_TORQUE`, `SYNCHRONOUS_SPEED`) or
    #: divided by (`STATION_SPEED`, `BASE_IMPEDANCE`), or is a share of and stays so (`TRANSMITTED_TORQUE`).
    base: str = ""

    def to_si(self, number: float) -> float:
        """A shown number in SI (or as a share of `base`).

        Parameters
        ----------
        number : float
            In the shown unit. [shown unit]

        Returns
        -------
        float
            In SI. [SI unit]
        """
        inverse = 1.0 / self.factor
        if inverse > 1.0 and inverse == round(inverse):
            return number / inverse  # 7 % is 0.07 and 70 mm 0.07 m to the last digit
        return number * self.factor

    def from_si(self, number: float) -> float:
        """An SI number (or share of `base`) in the shown unit.

        Parameters
        ----------
        number : float
            In SI. [SI unit]

        Returns
        -------
        float
            In the shown unit. [shown unit]
        """
        return number / self.factor


class UnitError(ValueError):
    """A unit that cannot be read or does not fit.

    Parameters
    ----------
    found : str
        The unit as typed. [unit]
    allowed : str
        Units that would do. [words]
    message : str
        What is wrong and what to write instead. [sentence]
    hint : str
        What may have been meant; empty where nothing is alike. [words]
    """

    def __init__(self, found: str, allowed: str, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.found = found
        self.allowed = allowed
        self.message = message
        self.hint = hint


def parse_unit(text: str, dimension: str) -> UnitScale:
    """The scale of a unit as typed, for a quantity of a given dimension.

    Parameters
    ----------
    text : str
        Any unit of the right dimension that pint reads: ``lb*ft^2``, ``lb·ft²``, ``lbf-in/rad``,
        ``kN*m``, ``10^6 lbf*in/rad``, ``rpm``, ``%``, ``pu``. [unit]
    dimension : str
        Key of `addin.contract.tables.DIMENSIONS`. [word]

    Returns
    -------
    UnitScale
        Factor to SI and what a relative unit is a share of.

    Raises
    ------
    UnitError
        Unknown unit, or a unit of another dimension.
    """
    text = text.strip()
    if len(text) > _LONGEST:
        raise _refused(shortened(text), dimension, f"the unit '{shortened(text)}' is not known")
    return _parse(text, dimension)


# --- the usual units ----------------------------------------------------------------------------

_IN = 0.0254
_FT = 12.0 * _IN
_LB = 0.45359237
_LBF = _LB * 9.80665
_RPM = 2.0 * math.pi / 60.0
_PSI = _LBF / (_IN * _IN)

_TORQUE = {
    "lbf*in": _LBF * _IN,
    "lbf*ft": _LBF * _FT,
    "kip*in": 1e3 * _LBF * _IN,
    "N*m": 1.0,
    "kN*m": 1e3,
    "MN*m": 1e6,
}
_PLAIN = {"1": 1.0, "%": 0.01}
_SPEED = {"rpm": _RPM, "rad/s": 1.0, "Hz": 2.0 * math.pi}

#: Dimension → unit → factor to SI.
USUAL: dict[str, dict[str, float]] = {
    "ratio": _PLAIN,
    "fraction": _PLAIN,
    "speed fraction": _PLAIN,
    "inertia": {
        "lb*ft^2": _LB * (_FT * _FT),
        "lb*in^2": _LB * (_IN * _IN),
        "lbf*in*s^2": _LBF * _IN,
        "kg*m^2": 1.0,
    },
    "torsional stiffness": {f"{unit}/rad": factor for unit, factor in _TORQUE.items()},
    "torsional damping": {f"{unit}*s/rad": factor for unit, factor in _TORQUE.items()},
    "torque": _TORQUE,
    "excitation torque": _TORQUE,
    "length": {"in": _IN, "ft": _FT, "mm": 1e-3, "m": 1.0, "um": 1e-6},
    "pressure": {
        "Pa": 1.0,
        "psi": _PSI,
        "ksi": 1e3 * _PSI,
        "Mpsi": 1e6 * _PSI,
        "MPa": 1e6,
        "GPa": 1e9,
        "N/mm^2": 1e6,
    },
    "density": {
        "lb/in^3": _LB / (_IN * _IN * _IN),
        "lb/ft^3": _LB / (_FT * _FT * _FT),
        "kg/m^3": 1.0,
        "g/cm^3": 1e3,
    },
    "angle": {"deg": math.pi / 180.0, "rad": 1.0},
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "calculation time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "frequency": {"Hz": 1.0, "cpm": 1.0 / 60.0},
    "cycles per minute": {"cpm": 1.0},
    "speed": _SPEED,
    "running speed": _SPEED,
    "angular acceleration": {"rpm/s": _RPM, "rad/s^2": 1.0},
    "sweep rate": {"Hz/s": 1.0},
    "power": {"hp": 550.0 * _LBF * _FT, "kW": 1e3, "MW": 1e6, "W": 1.0},
    "per unit": _PLAIN,
    "voltage": {"V": 1.0, "kV": 1e3},
    "apparent power": {"kVA": 1e3, "MVA": 1e6, "VA": 1.0},
    "mass": {"lb": _LB, "kg": 1.0, "t": 1e3},
    "linear stiffness": {
        "lbf/in": _LBF / _IN,
        "kip/in": 1e3 * _LBF / _IN,
        "N/m": 1.0,
        "N/um": 1e6,
        "N/mm": 1e3,
    },
    "linear damping": {"lbf*s/in": _LBF / _IN, "N*s/m": 1.0, "N*s/mm": 1e3},
    "force": {"lbf": _LBF, "kip": 1e3 * _LBF, "N": 1.0, "kN": 1e3},
    "approach speed": {"in/s": _IN, "ft/s": _FT, "mm/s": 1e-3, "m/s": 1.0},
    "angular approach speed": {"rad/s": 1.0, "deg/s": math.pi / 180.0},
}

#: Dimension → relative unit → scale. They come before the units proper: pint's pu is a mass.
RELATIVE: dict[str, dict[str, UnitScale]] = {
    "ratio": {"pu": UnitScale(1.0)},
    "fraction": {"pu": UnitScale(1.0)},
    "speed fraction": {"pu": UnitScale(1.0)},
    "per unit": {"pu": UnitScale(1.0), "ohm": UnitScale(1.0, BASE_IMPEDANCE)},
    "torque": {"pu": UnitScale(1.0, RATED_TORQUE), "%": UnitScale(0.01, RATED_TORQUE)},
    "excitation torque": {
        "pu": UnitScale(1.0, RATED_TORQUE),
        "%": UnitScale(0.01, TRANSMITTED_TORQUE),
    },
    "running speed": {
        "pu": UnitScale(1.0, SYNCHRONOUS_SPEED),
        "%": UnitScale(0.01, SYNCHRONOUS_SPEED),
    },
}


def known_units(dimension: str) -> dict[str, UnitScale]:
    """Every unit that is known by name, without pint.

    Parameters
    ----------
    dimension : str
        Key of `addin.contract.tables.DIMENSIONS`. [word]

    Returns
    -------
    dict of str to UnitScale
        By unit; of a ratio the blank is one too.
    """
    units = {unit: UnitScale(factor) for unit, factor in USUAL[dimension].items()}
    if dimension == "ratio":
        units[""] = UnitScale(1.0)
    if dimension == "speed fraction":
        units |= {unit: UnitScale(factor, STATION_SPEED) for unit, factor in _SPEED.items()}
    return units | RELATIVE.get(dimension, {})


# --- spelling -----------------------------------------------------------------------------------

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_SIGNS = str.maketrans(
    {"·": "*", "⋅": "*", "×": "*", "•": "*", "∙": "*", "−": "-", "–": "-", "‑": "-", "\u00a0": " "}
    | {"µ": "u", "μ": "u", "°": "deg", "\u2126": "ohm", "\u03a9": "ohm"}
)
_NAME = r"[A-Za-z%][A-Za-z_]*"
_FACTOR = rf"\(*{_NAME}(?:\^\(?-?[1-9]\)?)?\)*"
#: Products and quotients of named units with one-digit powers: nothing else is handed to pint.
_SHAPE = re.compile(rf"(?:1/)?{_FACTOR}(?:[*/]{_FACTOR})*")
_POWER_OF_TEN = re.compile(r"(?:1[eE]\+?|10\^)(\d{1,2})\*")
_LONGEST = 60

#: Names that pint lacks or means otherwise → names it reads.
_NAMES = {
    "Nm": "N*m",
    "kNm": "kN*m",
    "MNm": "MN*m",
    "Nmm": "N*mm",
    "Nms": "N*m*s",
    "RPM": "rpm",
    "rev": "turn",
    "cpm": "turn/min",
    "CPM": "turn/min",
    "sec": "s",
    "HP": "hp",
    "lbm": "lb",
    "PS": "metric_horsepower",
    "KW": "kW",
    "KN": "kN",
    "HZ": "Hz",
    "PSI": "psi",
    "KSI": "ksi",
    "mil": "thou",
    "mils": "thou",
    "kgfm": "kgf*m",
    "lbfin": "lbf*in",
    "lbfft": "lbf*ft",
}
#: The same without regard to capitals, but for a first m: milli is no mega.
_CAPITALS = {
    name.casefold(): (name, _NAMES.get(name, name))
    for name in (
        *_NAMES, "kg", "g", "lb", "lbs", "lbf", "kgf", "kip", "ft", "in", "mm", "cm", "m", "um", "rad", "deg", "s", "ms",
        "min", "N", "kN", "MN", "Pa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "Mpsi", "W", "kW", "MW", "V", "kV", "kVA",
        "MVA", "Hz", "rpm", "ohm",
    )
}  # fmt: skip
#: Letters written together: a mass times the square of a length, as in ``kgm²``.
_GLUED_INERTIA = re.compile(
    r"(?<![A-Za-z])([kK]?[gG]|t|lbm?|lbs|LB)(mm|cm|m|ft|in|MM|CM|M|FT|IN)\^2"
)
#: What stands before the unit of an inertia of which it is another measure → inertia over that number.
#: WR² and Wk² have the radius of gyration, GD² its diameter: J = GD² / 4.
_INERTIA_BY = {"J": 1.0, "WR": 1.0, "WK": 1.0, "MR": 1.0, "GD": 0.25}
_INERTIA_MEASURE = re.compile(r"(J|(?:WR|WK|MR|GD)\s*(?:\^?2|²))[\s,:;=(\[]+(.+)", re.IGNORECASE)
_WHOLE = {
    "min-1": "rpm",
    "min^-1": "rpm",
    "p.u.": "pu",
    "pu.": "pu",
    "PU": "pu",
    "percent": "%",
    "U/min": "rpm",
    "r/min": "rpm",
    '"': "in",
    "″": "in",
    "”": "in",
    "′": "ft",
    "’": "ft",
}


def _tidy(text: str) -> str:
    """A unit as typed, in the spelling of this module: ``lb·ft²`` → ``lb*ft^2``."""
    text = re.sub(
        "[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+", lambda m: "^" + m.group().translate(_SUPERSCRIPTS), as_seen(text)
    )
    text = text.translate(_SIGNS).replace("**", "^").strip().strip("[]").strip()
    if text in _WHOLE:
        return _WHOLE[text]
    text = re.sub(r"(?<=[A-Za-z0-9)])\.(?=[A-Za-z(])", "*", text)
    text = re.sub(r"\s*([*/^()])\s*", r"\1", text)
    text = re.sub(r"(?<=[A-Za-z0-9)])(?:\s+|-)(?=[A-Za-z(%])", "*", text)
    text = re.sub(rf"({_NAME})([2-4])(?![0-9A-Za-z_])", r"\1^\2", text)
    text = _GLUED_INERTIA.sub(r"\1*\2^2", text)
    return _WHOLE.get(text, text)


@lru_cache(maxsize=1024)
def _parse(text: str, dimension: str) -> UnitScale:
    relative = RELATIVE.get(dimension, {})
    usual = USUAL[dimension]
    for spelling in (text, _tidy(text)):
        if spelling in relative:
            return relative[spelling]
        if spelling in usual:
            return UnitScale(usual[spelling])
    if not text and dimension == "ratio":
        return UnitScale(1.0)
    measure = _INERTIA_MEASURE.fullmatch(text.strip()) if dimension == "inertia" else None
    if measure:
        try:
            return UnitScale(_measured_inertia(*measure.groups()))
        except UnitError as error:
            raise UnitError(text, error.allowed, error.message) from None
    if dimension == "speed fraction" and text:
        return UnitScale(_with_pint(text, "speed"), STATION_SPEED)
    return UnitScale(_with_pint(text, dimension))


def _measured_inertia(measure: str, unit: str) -> float:
    """Inertia of one unit of J, WR² or GD²; the latter two are weights, in kgf or lbf as well."""
    name, unit = re.sub("[^A-Z]", "", measure.upper()), unit.rstrip(")]")
    if name != "J":
        unit = re.sub(r"(?<![A-Za-z])(kg|lb)f(?=\W*(?:m|cm|mm|ft|in)(?:\^?2|²)$)", r"\1", unit)
    return _INERTIA_BY[name] * _parse(unit, "inertia").factor


# --- every other unit ---------------------------------------------------------------------------

#: Power of the angle a unit of the dimension may contain; 0 where it is not named.
_ANGLE_POWERS = {
    "torsional stiffness": (0, -1),
    "torsional damping": (0, -1),
    "inertia": (0, -1, -2),
    "angle": (1,),
    "speed": (0, 1),
    "running speed": (0, 1),
    "angular acceleration": (1,),
    "angular approach speed": (1,),
    "frequency": (0, 1),
}
#: Pounds of which the unit does not say that they are mass.
_POUND = re.compile(r"(?<![A-Za-z])(?:lbs?|LBS?)\b")
_SLIPS = (
    (r"lb(?:s|m)?\b", "lbf", "lb is a mass, not a force"),
    (r"kg\b", "kgf", "kg is a mass, not a force"),
    (r"lbf\b", "lb", "lbf is a force, not a mass"),
    (r"kgf\b", "kg", "kgf is a force, not a mass"),
)


@lru_cache(maxsize=1)
def _registry() -> Any:
    """The unit registry; built when the first unusual unit is met."""
    import pint

    return pint.UnitRegistry(cache_folder=None)


def _with_pint(text: str, dimension: str) -> float:
    """Factor to SI of a unit that is not in the table."""
    if not text:
        raise _refused(text, dimension, "no unit is given")
    unit, prefactor = _read(text, dimension)
    factor = _factor(unit, dimension)
    if factor is None:  # where only a force fits, lb is one: ft-lb, lb/in, lb-in-s²
        forced = _pint_unit(_POUND.sub("lbf", _POWER_OF_TEN.sub("", _tidy(text))))
        factor = None if forced is None else _factor(forced, dimension)
    if factor is None:
        _refuse_ambiguous(text, unit, dimension)
        raise _refused(
            text,
            dimension,
            f"'{text}' is not a unit of {_wanted(dimension)}",
            _hint(text, dimension),
        )
    return prefactor * factor


def _read(text: str, dimension: str) -> tuple[Any, float]:
    """pint's unit and the power of ten in front of it."""
    tidy = _tidy(text)
    power = _POWER_OF_TEN.match(tidy)
    tidy = tidy[power.end() :] if power else tidy
    unit = _pint_unit(tidy)
    if unit is None:
        raise _refused(
            text, dimension, f"the unit '{text}' is not known", _similar(tidy, dimension)
        )
    return unit, 10.0 ** int(power.group(1)) if power else 1.0


def _pint_unit(tidy: str) -> Any:
    """A unit in pint's hands, or None if it is not one."""
    if not _SHAPE.fullmatch(tidy):
        return None
    for spelling in (lambda m: f"({_NAMES[m[0]]})" if m[0] in _NAMES else m[0], _in_capitals):
        try:
            return _registry().parse_units(re.sub(_NAME, spelling, tidy))
        except Exception:  # pint raises half a dozen unrelated types; each means: not a unit
            continue
    return None


def _in_capitals(match: re.Match[str]) -> str:
    """A name in the capitals in which it is known; as it is where only capitals tell milli from mega."""
    known, meant = _CAPITALS.get(match[0].casefold(), (match[0], match[0]))
    other_prefix = len(known) > 1 and known[0] in "mM" and known[0] != match[0][0]
    return match[0] if other_prefix else f"({meant})"


def _factor(unit: Any, dimension: str) -> float | None:
    """SI value of one `unit`, or None if it is of another dimension."""
    if dimension == "cycles per minute":
        return None  # the column has its unit in its name; pint knows no cycles
    registry = _registry()
    si = registry.parse_units(DIMENSIONS[dimension].si)
    if registry.get_dimensionality(unit) != registry.get_dimensionality(si):
        return None
    try:
        one, two = (registry.Quantity(n, unit).to_root_units().magnitude for n in (1.0, 2.0))
    except Exception:  # logarithmic and offset units have no factor
        return None
    if not math.isclose(two, 2.0 * one):
        return None
    angle = dict(registry.get_root_units(unit)[1]._units).get("radian", 0)
    if angle not in _ANGLE_POWERS.get(dimension, (0,)):
        return None
    factor = one / registry.Quantity(1.0, si).to_root_units().magnitude
    if dimension == "frequency" and angle:
        return factor / (2.0 * math.pi)
    if dimension in ("speed", "running speed") and not angle:
        return None if _is_bare_rate(unit) else factor * 2.0 * math.pi
    return float(factor)


def _is_bare_rate(unit: Any) -> bool:
    """Whether a unit is 1/s, which says neither revolutions nor radians (1/min is revolutions)."""
    return str(unit) in ("1 / second", "1 / millisecond")


def _refuse_ambiguous(text: str, unit: Any, dimension: str) -> None:
    if dimension in ("speed", "running speed") and _is_bare_rate(unit):
        raise _refused(
            text, dimension, f"'{text}' does not state revolutions or radians", "write rpm or rad/s"
        )


# --- sentences ----------------------------------------------------------------------------------


def _wanted(dimension: str) -> str:
    """The dimension in words."""
    words = {
        "ratio": "a ratio",
        "fraction": "a ratio or percentage",
        "speed fraction": "speed",
        "running speed": "speed",
        "per unit": "a reactance or resistance",
        "excitation torque": "torque",
        "pressure": "stress or modulus",
    }
    return words.get(dimension, dimension)


def _refused(text: str, dimension: str, what: str, hint: str = "") -> UnitError:
    allowed = (
        "a unit of " + _wanted(dimension) + " such as " + ", ".join(DIMENSIONS[dimension].units)
    )
    advice = hint or "write a unit such as " + ", ".join(DIMENSIONS[dimension].units)
    return UnitError(text, allowed, f"{what}; {advice}.", hint)


def _hint(text: str, dimension: str) -> str:
    """What the engineer meant when pounds or kilograms were taken for the other kind, or ohm for a multiple."""
    tidy = _tidy(text)
    for pattern, other, why in _SLIPS:
        swapped = re.sub(rf"(?<![A-Za-z])([kM]?){pattern}", rf"\g<1>{other}", tidy)
        unit = _pint_unit(swapped) if swapped != tidy else None
        if unit is not None and _factor(unit, dimension) is not None:
            return f"{why}: write {swapped}"
    unit = _pint_unit(tidy)
    if dimension == "ratio" and unit is not None and unit.is_compatible_with("ohm"):
        return (
            "divide it by the resistance of which it is a multiple (a discharge resistor: by that of the field winding) "
            "and write the unit 1"
        )
    return ""


def _similar(tidy: str, dimension: str) -> str:
    """The usual unit that a mistyped one resembles."""
    units = DIMENSIONS[dimension].units
    close = nearest(tidy, units)
    return f"did you mean {close}? Usual are " + ", ".join(units) if close else ""
