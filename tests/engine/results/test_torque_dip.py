"""A start that hangs just above half speed says why: the dip in the torque of a rotor with unlike axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.case.data import EffectChoiceRow, MotorCircuitRow, MotorDataRow
from engine.model.load import loads_of, opposing_torque
from engine.motor.curves import slip_curves
from engine.motor.from_case import motors_from_data
from engine.results.warnings import warnings_of
from engine.run import run
from tests.trains import geared

#: Field and damper of axis d; the damper of axis q makes the axes alike.
ONE_AXIS = MotorCircuitRow(
    "Motor", rs=0.005, xl=0.1, xmd=1.5, xmq=0.9, rf=0.01, xlf=0.12, rkd=0.03, xlkd=0.1
)
BOTH_AXES = replace(ONE_AXIS, rkq=0.03, xlkq=0.1)
DIP = "hangs in a dip of the average torque"


def started_with(circuit, **fields):
    off = (EffectChoiceRow("motor transient", "off"), EffectChoiceRow("electrical damping", "off"))
    case = geared(
        motor_torque=(), motor_data=(MotorDataRow("Motor", None, 2.2e6),), motor_circuit=(circuit,),
        effect_choices=off, **fields,
    )  # fmt: skip
    return case, run(case)


def test_a_rotor_with_windings_of_one_axis_hangs_at_half_speed():
    case, results = started_with(ONE_AXIS)
    outcome = results.start.outcome
    assert outcome.outcome == "stalled"
    (motor,) = motors_from_data(case)
    share = outcome.end_speed / motor.synchronous_speed
    assert share == pytest.approx(0.5, abs=0.03)
    (note,) = [note for note in warnings_of(results) if DIP in note]
    assert "check the dampers of both axes" in note
    # from where the note says on, and not just below, the motor carries the load
    again = float(note.split(" % speed")[0].split()[-1]) / 100.0
    loads = loads_of(case, results.train)
    for speed, carries in ((share + 0.01, False), (again - 0.003, False), (again + 0.003, True)):
        average = motor.torque_base * slip_curves(motor.starting, np.array([1.0 - speed])).average
        load = opposing_torque(results.train, loads, np.array([speed * motor.synchronous_speed]))
        assert (average[0] > load[0]) == carries


def test_dampers_of_both_axes_start_the_same_train():
    _, results = started_with(BOTH_AXES)
    assert results.start.outcome.outcome != "stalled"
    assert not [note for note in warnings_of(results) if DIP in note]


def test_a_load_that_stalls_the_motor_at_half_speed_is_no_dip():
    """It rises there, and the motor does not carry it further up."""
    case, _ = started_with(BOTH_AXES)
    (motor,) = motors_from_data(case)
    torque = float(motor.torque_base * slip_curves(motor.starting, np.array([0.48])).average[0])
    rows = tuple(
        replace(case.load_torque[0], speed=speed, torque=t)
        for speed, t in (
            (0.0, 0.0),
            (0.45, 0.1 * torque),
            (0.52, torque / 3.0),
            (1.0, 2.0 * torque),
        )
    )
    _, results = started_with(BOTH_AXES, load_torque=rows)
    assert results.start.outcome.outcome == "stalled"
    assert not [note for note in warnings_of(results) if DIP in note]
