"""Units: the table of usual ones against pint, spelling, relative units, and what is refused."""

import math

import pytest

from addin.contract.tables import DIMENSIONS
from addin.contract.units import (
    RATED_TORQUE,
    STATION_SPEED,
    SYNCHRONOUS_SPEED,
    TRANSMITTED_TORQUE,
    USUAL,
    UnitError,
    UnitScale,
    known_units,
    parse_unit,
)

pint = pytest.importorskip("pint")
REGISTRY = pint.UnitRegistry()

ROTATIONS = {"speed", "running speed", "frequency"}


@pytest.mark.parametrize(
    ("dimension", "unit"),
    [
        (dimension, unit)
        for dimension, units in USUAL.items()
        for unit in units
        if dimension not in ROTATIONS and unit not in ("1", "cpm")
    ],
)
def test_usual_factors_are_those_of_pint(dimension, unit):
    wanted = REGISTRY.Quantity(1.0, unit).to(DIMENSIONS[dimension].si).magnitude
    assert parse_unit(unit, dimension).factor == pytest.approx(wanted, rel=2e-15)


@pytest.mark.parametrize("dimension", [d for d in DIMENSIONS if DIMENSIONS[d].si])
def test_the_drop_down_lists_can_be_read_without_pint(dimension, monkeypatch):
    monkeypatch.setattr("addin.contract.units._registry", None)
    parse_unit.__globals__["_parse"].cache_clear()
    for unit in (*DIMENSIONS[dimension].units, DIMENSIONS[dimension].si):
        if dimension == "speed fraction" and unit in ("rpm", "rad/s"):
            continue
        assert parse_unit(unit, dimension).factor > 0.0


@pytest.mark.parametrize(
    ("text", "dimension", "same_as"),
    [
        ("lb·ft²", "inertia", "lb*ft^2"),
        ("lb-ft2", "inertia", "lb*ft^2"),
        ("lb ft**2", "inertia", "lb*ft^2"),
        ("lbm*ft^2", "inertia", "lb*ft^2"),
        ("kg m²", "inertia", "kg*m^2"),
        ("lbf*in*s^2/rad", "inertia", "lbf*in*s^2"),
        ("in-lbf/rad", "torsional stiffness", "lbf*in/rad"),
        ("lbf-in/rad", "torsional stiffness", "lbf*in/rad"),
        ("N*m", "torsional stiffness", "N*m/rad"),
        ("Nm/rad", "torsional stiffness", "N*m/rad"),
        ("N·m·s", "torsional damping", "N*m*s/rad"),
        ("N m/(rad/s)", "torsional damping", "N*m*s/rad"),
        ("[N·m]", "torque", "N*m"),
        ("kNm", "torque", "kN*m"),
        ("J", "torque", "N*m"),
        ("KSI", "pressure", "ksi"),
        ("lbf/in²", "pressure", "psi"),
        ("µm", "length", "um"),
        ("°", "angle", "deg"),
        ("degrees", "angle", "deg"),
        ("RPM", "speed", "rpm"),
        ("1/min", "speed", "rpm"),
        ("min⁻¹", "speed", "rpm"),
        ("rev/min", "speed", "rpm"),
        ("HP", "power", "hp"),
        ("lbs", "mass", "lb"),
        # written together, with points, in other capitals
        ("kgm2", "inertia", "kg*m^2"),
        ("kgm²", "inertia", "kg*m^2"),
        ("kg.m²", "inertia", "kg*m^2"),
        ("Kg*m^2", "inertia", "kg*m^2"),
        ("KG.M2", "inertia", "kg*m^2"),
        ("lbft2", "inertia", "lb*ft^2"),
        ("LB-FT2", "inertia", "lb*ft^2"),
        ("lbin²", "inertia", "lb*in^2"),
        ("lbf.in.s2", "inertia", "lbf*in*s^2"),
        ("N.m/rad", "torsional stiffness", "N*m/rad"),
        ("NM/Rad", "torsional stiffness", "N*m/rad"),
        ("KNm/rad", "torsional stiffness", "kN*m/rad"),
        ("MN.m/rad", "torsional stiffness", "MN*m/rad"),
        ("kgf.m/rad", "torsional stiffness", "kgf*m/rad"),
        ("lbf.in/rad", "torsional stiffness", "lbf*in/rad"),
        ("Mpa", "pressure", "MPa"),
        ("IN", "length", "in"),
        ("Rad", "angle", "rad"),
        ("min-1", "speed", "rpm"),
        # other measures of an inertia
        ("J kg*m^2", "inertia", "kg*m^2"),
        ("WR² lb*ft^2", "inertia", "lb*ft^2"),
        ("WR2 (lbf-ft2)", "inertia", "lb*ft^2"),
        ("Wk² lb-ft²", "inertia", "lb*ft^2"),
        ("WR2 lbf*in*s^2", "inertia", "lbf*in*s^2"),
        # pounds where only a force fits, and the signs of drawings
        ("ft-lb", "torque", "lbf*ft"),
        ("lb-ft", "torque", "lbf*ft"),
        ("in-lbs", "torque", "lbf*in"),
        ("in-lb/rad", "torsional stiffness", "lbf*in/rad"),
        ("LB-IN/RAD", "torsional stiffness", "lbf*in/rad"),
        ("lb/in^2", "pressure", "psi"),
        ("lb-in-s²", "inertia", "lbf*in*s^2"),
        ("lb/in", "linear stiffness", "lbf/in"),
        ("lb", "force", "lbf"),
        ("lb", "mass", "lb"),
        ("lb-ft²", "inertia", "lb*ft^2"),
        ('"', "length", "in"),
        ("″", "length", "in"),
        ("′", "length", "ft"),
        ("p.u.", "torque", "pu"),
        ("percent", "fraction", "%"),
        ("", "ratio", "1"),
    ],
)
def test_spellings(text, dimension, same_as):
    found, wanted = parse_unit(text, dimension), parse_unit(same_as, dimension)
    assert found.base == wanted.base
    assert found.factor == pytest.approx(wanted.factor, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "dimension", "factor"),
    [
        ("10^6 lbf*in/rad", "torsional stiffness", 112984.82902761668),
        ("1e6 lbf in/rad", "torsional stiffness", 112984.82902761668),
        ("N*m/deg", "torsional stiffness", 180.0 / math.pi),
        ("slug*ft^2", "inertia", 1.3558179483314),
        ("kgf*m", "torque", 9.80665),
        ("t.m²", "inertia", 1e3),
        # the diameter of gyration is twice its radius: G D² = 4 J
        ("GD² kg*m^2", "inertia", 0.25),
        ("GD2 kgf*m^2", "inertia", 0.25),
        ("gd^2 [kgm2]", "inertia", 0.25),
        # milli is no mega
        ("mN*m/rad", "torsional stiffness", 1e-3),
        ("MN*m/rad", "torsional stiffness", 1e6),
        ("mils", "length", 2.54e-5),
        ("PS", "power", 735.49875),
        # a frequency counts cycles, a speed radians
        ("Hz", "frequency", 1.0),
        ("cpm", "frequency", 1.0 / 60.0),
        ("rpm", "frequency", 1.0 / 60.0),
        ("1/s", "frequency", 1.0),
        ("kHz", "frequency", 1000.0),
        ("rad/s", "frequency", 0.5 / math.pi),
        ("rpm", "speed", math.pi / 30.0),
        ("Hz", "speed", 2.0 * math.pi),
        ("rad/s", "speed", 1.0),
        ("deg/s", "running speed", math.pi / 180.0),
        ("rpm/s", "angular acceleration", math.pi / 30.0),
    ],
)
def test_factors(text, dimension, factor):
    assert parse_unit(text, dimension).factor == pytest.approx(factor, rel=1e-13)


@pytest.mark.parametrize(
    ("text", "dimension", "scale"),
    [
        ("pu", "torque", UnitScale(1.0, RATED_TORQUE)),
        ("%", "torque", UnitScale(0.01, RATED_TORQUE)),
        ("pu", "excitation torque", UnitScale(1.0, RATED_TORQUE)),
        ("%", "excitation torque", UnitScale(0.01, TRANSMITTED_TORQUE)),
        ("%", "running speed", UnitScale(0.01, SYNCHRONOUS_SPEED)),
        ("%", "speed fraction", UnitScale(0.01)),
        ("rad/s", "speed fraction", UnitScale(1.0, STATION_SPEED)),
        ("%", "fraction", UnitScale(0.01)),
    ],
)
def test_relative_units(text, dimension, scale):
    assert parse_unit(text, dimension) == scale


@pytest.mark.parametrize(
    ("text", "dimension", "advice"),
    [
        ("mn.m/rad", "torsional stiffness", "did you mean MN*m/rad?"),
        ("mpa", "pressure", "did you mean MPa?"),
        ("GD2 lbf*ft", "inertia", "'lbf*ft' is not a unit of inertia"),
        ("lbm*ft", "torque", "lb is a mass, not a force: write lbf*ft"),
        ("klb*in", "torque", "write klbf*in"),
        ("lbf*ft^2", "inertia", "lbf is a force, not a mass: write lb*ft^2"),
        ("kg*m", "torque", "kg is a mass, not a force: write kgf*m"),
        ("N*m/rad", "torque", "not a unit of torque"),
        ("m", "torque", "not a unit of torque; write a unit such as lbf*in"),
        ("rpm", "torque", "not a unit of torque"),
        ("psig", "pressure", "did you mean psi?"),
        ("foo", "torque", "the unit 'foo' is not known"),
        ("", "torque", "no unit is given"),
        ("1/s", "speed", "does not state revolutions or radians"),
        ("deg", "fraction", "not a unit of a ratio"),
        (
            "mΩ",
            "ratio",
            "divide it by the resistance of which it is a multiple (a discharge resistor: by that of the field",
        ),
        ("V", "ratio", "not a unit of a ratio; write a unit such as 1"),
        ("dB", "fraction", "not a unit of a ratio"),
        ("degC", "length", "not a unit of length"),
        ("%", "length", "not a unit of length"),
        ("pu", "length", "not a unit of length"),
        ("%", "speed", "not a unit of speed"),
        # never handed to pint, which would evaluate it
        ("2**9**9**9", "torque", "is not known"),
        ("m^99999999", "length", "is not known"),
        ("m" * 5000, "length", "is not known"),
        ("__import__('os')", "length", "is not known"),
        ("lbf*in)", "torque", "is not known"),
        ("12 N*m", "torque", "is not known"),
    ],
)
def test_refusals_say_what_to_write(text, dimension, advice):
    with pytest.raises(UnitError) as caught:
        parse_unit(text, dimension)
    assert advice in caught.value.message
    assert caught.value.found == (text if len(text) < 60 else text[:57] + "...")
    assert "such as" in caught.value.allowed


@pytest.mark.parametrize(("percent", "share"), [(7, 0.07), (1.5, 0.015), (55, 0.55), (29, 0.29)])
def test_percent_is_exact_to_the_last_digit(percent, share):
    assert parse_unit("%", "fraction").to_si(percent) == share


@pytest.mark.parametrize("unit", ["psi", "rpm", "lbf*in", "%"])
def test_from_si_undoes_to_si(unit):
    dimension = {"psi": "pressure", "rpm": "speed", "lbf*in": "torque", "%": "fraction"}[unit]
    scale = parse_unit(unit, dimension)
    assert scale.from_si(scale.to_si(12.34)) == pytest.approx(12.34, rel=1e-15)


@pytest.mark.parametrize("dimension", [d for d, known in DIMENSIONS.items() if known.units])
def test_units_known_by_name_are_those_that_are_read_and_all_of_the_drop_down(dimension):
    known = known_units(dimension)
    assert set(DIMENSIONS[dimension].units) <= set(known)
    assert {unit: parse_unit(unit, dimension) for unit in known} == known
