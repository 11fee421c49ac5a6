"""What Audit says of pieces of shafts where no number is known."""

from __future__ import annotations

from dataclasses import replace

from addin.calculation.calculation import calculate
from tests.distributed_trains import train


def test_an_unknown_frequency_error_is_said_to_be_unknown() -> None:
    """A line of 60 GHz: the band of the margins holds modes that half as many pieces do not have."""
    case = replace(train(3, most=1), line_frequency=6e10, motor_torque=(), load_torque=())
    audit = {row["item"]: row["value"] for row in calculate(case).tables["Audit"]}
    assert audit["Shaft segments"].endswith("; estimated frequency error unknown")
