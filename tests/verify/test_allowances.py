"""How far a number of another version may be off: its reported error, and not ten times that."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from addin.verify.allowances import Allowances
from addin.verify.compare import RecordedValue, agreement
from addin.verify.findings import Agreement


def started(spread: float | None) -> SimpleNamespace:
    """A start with peaks to 0.04 %, and the spread of a sensitive one."""
    repeatability = None if spread is None else SimpleNamespace(spread=spread)
    peaks = (SimpleNamespace(element="Stiff shaft", relative_error=1e-4),)
    return SimpleNamespace(estimated_error=4e-4, repeatability=repeatability, peaks=peaks)


def reported(**fields: Any) -> Allowances:
    """Of a calculation with peaks to 0.04 %, starts of one shaft to 3 %, frequencies to 0.002 %."""
    given = {
        "segments": {"Shaft": 4},
        "frequency_error": 2e-5,
        "starts_error": (("Shaft", 0.03), ("Other", None)),
        "start": started(None),
        "events": (
            SimpleNamespace(
                name="Fault",
                response=SimpleNamespace(
                    estimated_error=2e-4,
                    peaks=(SimpleNamespace(element="Stiff shaft", relative_error=5e-5),),
                ),
                damage_errors=(("Shaft", 0.05),),
            ),
            SimpleNamespace(name="Not calculated", response=None, damage_errors=()),
        ),
    }
    return Allowances(SimpleNamespace(**(given | fields)))  # type: ignore[arg-type]


ROW = {
    "Element": "Shaft", "Maximum torque": 3000.0, "Peak-to-peak torque": 5000.0,
    "Peak-to-peak stress": 80.0, "Minimum torque": -2000.0, "Margin": 0.5, "Tooth force": 7e4,
    "Force": 9e3, "Mesh minimum torque": -100.0, "Error": 0.04, "Amplitude": 40.0,
    "Damage": 1e-3, "Allowable starts": 1000.0, "Frequency": 50.0, "CPM": 3000.0,
    "Recontact speed": 0.2, "Event": "Fault", "Maximum": 900.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("table", "column", "allowed"),
    [
        ("StartupPeaks", "Maximum torque", 4e-4 * 5000.0),  # a share of the range, not of the value
        ("StartupPeaks", "Minimum torque", 4e-4 * 5000.0),
        ("StartupPeaks", "Peak-to-peak stress", 4e-4 * 80.0),
        ("StartupCrossings", "Mesh minimum torque", 4e-4 * 100.0),
        ("TorqueReversals", "Margin", 4e-4 * 0.5),
        ("TorqueReversals", "Tooth force", 4e-4 * 7e4),
        ("TorqueReversals", "Recontact speed", 4e-4 * 0.2),
        ("BearingForces", "Force", 4e-4 * 9e3),
        ("StartCycles", "Amplitude", 4e-4 * 40.0),
        ("StartCycles", "Damage", 0.03 * 1e-3),
        ("AllowableStarts", "Damage", 0.03 * 1e-3),
        ("AllowableStarts", "Allowable starts", 0.03 * 1000.0),
        ("NaturalFrequencies", "Frequency", 2e-5 * 50.0),
        ("NaturalFrequencies", "CPM", 2e-5 * 3000.0),
        ("EventPeaks", "Maximum", 2e-4 * 900.0),
        ("EventPeaks", "Damage", 0.05 * 1e-3),
        ("StartupPeaks", "Error", 0.04),  # an estimate may be estimated otherwise, up to its size
        ("SteadyState", "Maximum torque", None),
        ("SeparationMargins", "Margin", None),
        ("StartupPeaks", "Element", 4e-4),  # a text: the relative error of numbers in it
    ],
)
def test_the_allowance_of_a_number_is_its_reported_error(table, column, allowed):
    found = reported().of_value(table, column, ROW)
    assert found == (None if allowed is None else pytest.approx(allowed, rel=1e-12))


def test_a_row_with_an_error_of_its_own_is_allowed_no_more():
    """StartupPeaks and EventPeaks report one for each element; other tables, that of all peaks."""
    stiff = ROW | {"Element": "Stiff shaft"}
    for table, column, allowed in (
        ("StartupPeaks", "Maximum torque", 1e-4 * 5000.0),
        ("StartupPeaks", "Peak-to-peak stress", 1e-4 * 80.0),
        ("EventPeaks", "Maximum", 5e-5 * 900.0),
        ("StartCycles", "Amplitude", 4e-4 * 40.0),
    ):
        event = {"Event": "Fault" if table == "EventPeaks" else None}
        found = reported().of_value(table, column, stiff | event)
        assert found == pytest.approx(allowed, rel=1e-12)
    wide, stiff = reported(start=started(0.02)), stiff | {"Event": None}
    assert wide.of_value("StartupPeaks", "Maximum torque", stiff) == pytest.approx(0.02 * 5000.0)


def test_a_sensitive_start_has_its_spread_and_uncut_shafts_have_no_error():
    wide = reported(start=started(0.02))
    assert wide.of_value("BearingForces", "Force", ROW) == pytest.approx(0.02 * 9e3)
    assert wide.of_words() == 0.02
    small = reported(start=started(1e-6))
    assert small.of_words() == 4e-4
    exact = reported(segments={}, start=None)
    assert exact.of_value("NaturalFrequencies", "Frequency", ROW) is None
    assert exact.of_value("StartupPeaks", "Maximum torque", ROW) is None
    assert exact.of_words() is None
    assert reported(start=None).of_words() == 2e-5
    other = ROW | {"Element": "Other"}
    assert reported().of_value("AllowableStarts", "Damage", other) is None


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("expected", "code", "allowed", "edge", "inside"),
    [
        (1234.5, "", 0.25, 0.25, Agreement.ERROR),
        (1234.5, "", None, 1234.5e-9, Agreement.DIGITS),  # what other processors make
        (1234.5, "0.0", None, 0.05, Agreement.DIGITS),  # half of the last digit shown
        (0.1234, "0.0%", None, 0.0005, Agreement.DIGITS),
        (1234.5, "0.00E+00", None, 5.0, Agreement.DIGITS),
        (1234.5, "#,##0", None, 0.5, Agreement.DIGITS),
    ],
)
def test_agreement_ends_where_the_error_or_the_last_digit_ends(
    expected, code, allowed, edge, inside, sign
):
    for share, how in ((0.98, inside), (1.02, Agreement.DIFFERENT)):
        found = RecordedValue(expected + sign * share * edge, number_format=code)
        assert agreement(found, expected, allowed) is how


@pytest.mark.parametrize(
    ("found", "how"),
    [("1,001.1", Agreement.ERROR), ("1,001.3", Agreement.DIFFERENT),
     ("998.9", Agreement.ERROR), ("998.7", Agreement.DIFFERENT)],
)  # fmt: skip
def test_numbers_in_sentences_have_the_error_and_one_last_digit(found, how):
    """1,000.0 to 0.1 %: one, and a tenth for the rounding of what was written."""
    text = "reached after {} s"
    assert agreement(RecordedValue(text.format(found)), text.format("1,000.0"), 1e-3) is how
