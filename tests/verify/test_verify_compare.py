"""One value against another: digits shown by a number format, errors, numbers in words."""

import pytest

from addin.verify.compare import RecordedValue, agreement, is_rounding, shown_step
from addin.verify.findings import Agreement
from addin.xlsx import ErrorValue


@pytest.mark.parametrize(
    ("value", "code", "step"),
    [
        (12.3456, "0.00", 0.01),
        (12345.6, "#,##0", 1.0),
        (0.123, "0%", 0.01),
        (0.123, "0.00%", 0.0001),
        (12345.0, "0.000E+00", 10.0),
        (0.5, "[>=0.01]0.00;[>0]0.00000;0.00", 0.01),
        (0.001, "[>=0.01]0.00;[>0]0.00000;0.00", 0.00001),
        (-250.0, "[<1000]#,##0.00;#,##0", 0.01),
        (2500.0, "[<1000]#,##0.00;#,##0", 1.0),
        (-1.5, '0.0;[Red]"minus "0.000', 0.001),
        (1234.5678, "General", 1e-6),
        (1.0, '"text only"', 0.0),
    ],
)
def test_the_last_digit_shown(value, code, step):
    assert shown_step(value, code) == pytest.approx(step)


@pytest.mark.parametrize(
    ("found", "expected", "code", "allowed", "how"),
    [
        (1.0, 1.0, "", None, Agreement.BITS),
        (None, "", "", None, Agreement.BITS),
        (0.0, None, "", None, Agreement.DIFFERENT),
        (None, 0.0, "0.00", 1.0, Agreement.DIFFERENT),
        ("", 0, "", None, Agreement.DIFFERENT),
        (False, None, "", None, Agreement.DIFFERENT),
        (0.0, 0.0, "", None, Agreement.BITS),
        ("pass", "pass", "", None, Agreement.BITS),
        (1.0 + 1e-15, 1.0, "", None, Agreement.DIGITS),
        (1.234, 1.2375, "0.00", None, Agreement.DIGITS),
        (1.234, 1.2375, "0.000", None, Agreement.DIFFERENT),
        (1.234, 1.2375, "0.000", 0.01, Agreement.ERROR),
        (1.2, 1.3, "", 0.01, Agreement.DIFFERENT),
        ("1.0", 1.0, "", 0.1, Agreement.DIFFERENT),
        (ErrorValue("#N/A"), 1.0, "", 0.1, Agreement.DIFFERENT),
        (None, 1.0, "", None, Agreement.DIFFERENT),
        (1.0, None, "", None, Agreement.DIFFERENT),
        (True, 1.0, "", None, Agreement.DIFFERENT),
        ("reached after 8.035 s", "reached after 8.036 s", "", 1e-3, Agreement.ERROR),
        ("reached after 8.035 s", "reached after 8.036 s", "", None, Agreement.DIFFERENT),
        ("reached after 8.035 s", "reached after 9.035 s", "", 1e-3, Agreement.DIFFERENT),
        ("reached after 8.035 s", "stalled after 8.035 s", "", 1e-3, Agreement.DIFFERENT),
        ("7 reversals", "8 reversals", "", 1e-3, Agreement.DIFFERENT),
    ],
)
def test_how_well_two_values_agree(found, expected, code, allowed, how):
    assert agreement(RecordedValue(found, number_format=code), expected, allowed) is how


def test_rounding_is_what_no_hand_does():
    assert is_rounding(3.0000000000001, 3.0)
    assert not is_rounding(3.00001, 3.0)
    assert is_rounding(None, "")
    assert not is_rounding("3", 3.0)


def test_a_blank_is_no_zero_and_no_rounding_of_one():
    assert is_rounding(None, "")
    assert not is_rounding(0.0, None)
    assert not is_rounding(None, 0.0)
    assert not is_rounding("", 0.0)
