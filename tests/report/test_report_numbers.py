"""Numbers and formulas as a reader sees them."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from addin.calculation.audit import EQUATIONS as AUDITED
from addin.report import numbers
from addin.report.equations import EQUATIONS, METHODS, by
from addin.report.formula import Node, formula, frac

UP = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def text_of(node: Node) -> str:
    """A formula in one line of plain text."""
    kind, *rest = node
    if kind == "row":
        return " ".join(text_of(one) for one in rest)
    if kind == "fraction":
        return f"({text_of(rest[0])})/({text_of(rest[1])})"
    if kind == "root":
        return f"√({text_of(rest[0])})"
    if kind == "fence":
        return f"{rest[0]}{text_of(rest[1])}{rest[2]}"
    if kind == "accent":
        return text_of(rest[0]) + "'" * rest[1]
    if kind == "script":
        base, sub, sup = rest
        below = f"_{text_of(sub)}" if sub else ""
        return text_of(base) + below + (f"^{text_of(sup)}" if sup else "")
    return str(rest[0])


def value_of(shown: str) -> float:
    """What a reader understands."""
    plain = shown.replace(",", "").replace("−", "-")
    mantissa, _, power = plain.partition("×10")
    return float(mantissa) * 10.0 ** int(power.translate(UP) or 0)


@given(st.floats(min_value=-1e300, max_value=1e300, allow_subnormal=False))
def test_a_number_is_read_as_what_it_was(value):
    if 0.0 < abs(value) < 1e-300:
        return
    assert value_of(numbers.significant(value, 5)) == pytest.approx(value, rel=6e-5)
    assert value_of(numbers.typed(value)) == pytest.approx(value, rel=1e-9)


@given(st.floats(min_value=1e-9, max_value=1e12))
def test_no_number_is_long(value):
    for shown in (numbers.significant(value, 5), numbers.engineering(value)):
        assert len(re.sub(r"[^0-9]", "", shown.translate(UP))) <= 13


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (52379.03, "52,379"),
        (0.0165, "0.016500"),
        (-7.0, "−7.0000"),
        (0.0, "0"),
        (2.2126864e9, "2.2127×10⁹"),
        (3.2e-8, "32.000×10⁻⁹"),
        (999999.7, "1,000,000"),
    ],
)
def test_five_significant_digits(value, shown):
    assert numbers.significant(value, 5) == shown


def test_an_input_keeps_its_digits():
    assert numbers.typed(2212686448.0) == "2,212,686,448"
    assert numbers.typed(0.0157480315) == "0.0157480315"
    assert numbers.typed(-1.5e-7) == "−1.5×10⁻⁷"


@pytest.mark.parametrize(
    ("starts", "shown"), [(436.99, "436"), (15119.0000000001, "15,119"), (0.97, "0.9700")]
)
def test_starts_are_never_rounded_up(starts, shown):
    assert numbers.of_dimension(starts, "Allowable starts", "count") == shown


def test_a_zero_has_no_sign():
    assert numbers.fixed(-0.0001, 2) == "0.00"


@given(st.text(max_size=40))
def test_clean_text_can_stand_in_xml(text):
    from lxml import etree

    element = etree.Element("t")
    element.text = numbers.clean(text)  # lxml refuses what XML cannot hold
    assert etree.fromstring(etree.tostring(element)).text in (numbers.clean(text), None)


def test_units_as_printed():
    assert numbers.pretty_unit("lbf*in/rad") == "lbf·in/rad"
    assert numbers.pretty_unit("kg*m^2") == "kg·m²"
    assert numbers.pretty_unit("1") == ""


def test_every_audited_equation_is_typeset_or_a_method():
    assert [e.name for e in EQUATIONS] + [name for name, _ in METHODS] == sorted(
        (name for name, _ in AUDITED), key=lambda n: [*(e.name for e in EQUATIONS), *dict(METHODS)].index(n)
    )  # fmt: skip
    assert {e.name for e in EQUATIONS} | dict(METHODS).keys() == {name for name, _ in AUDITED}


def test_references_to_equations_are_their_places():
    place = {e.name: k for k, e in enumerate(EQUATIONS, start=1)}
    assert by("Damage") == f"By equation ({place['Damage']})."
    said = by("Shear stress", "Damage")
    assert said == f"By equations ({place['Shear stress']}) and ({place['Damage']})."


def test_the_notation_of_formulas():
    assert formula("f_exc") == (
        "script", ("sign", "f", "italic"), ("sign", "exc", "upright"), None,
    )  # fmt: skip
    assert text_of(formula("k =", frac("π G", "32 L"))) == "k = (π G)/(32 L)"
    assert formula("*K")[2] == "bold"
    assert formula("q''") == ("accent", ("sign", "q", "italic"), 2)


def test_the_shear_stress_equation_gives_the_stress():
    """The typeset formula, evaluated: 16 T D / (π (D⁴ − d⁴)) of a solid shaft is 16 T / π D³."""
    equation = next(e for e in EQUATIONS if e.name == "Shear stress")
    said = text_of(equation.formula).split(",")[0].split("=")[1]
    expression = (
        said.replace("16 T D", "16*T*D").replace("π (", "pi*(").replace("^", "**").replace("−", "-")
    )
    found = eval(expression, {"T": 1e3, "D": 0.1, "d": 0.0, "pi": math.pi})
    assert found == pytest.approx(16.0 * 1e3 / (math.pi * 0.1**3))
