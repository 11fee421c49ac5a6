"""Slips that are possible numbers are told; usual numbers are not."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_case import sample_case, with_limits

from engine.case.data import CaseData, EventTorqueRow, MeshRow, MotorCircuitRow, MotorDataRow
from engine.case.plausibility import implausible, impossible_inputs
from engine.run import run


def said_of(case: CaseData) -> str:
    """Everything that looks like a slip, or cannot be meant."""
    return "\n".join((*(one.sentence for one in impossible_inputs(case)), *implausible(case)))


def test_the_examples_are_plausible():
    assert said_of(sample_case("proposed")) == ""
    assert said_of(sample_case("modified")) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"damping_ratio": 0.20},
            "DampingRatio 20 %: no verdict is given. Usual: 0.5 % to 3 % of critical",
        ),
        ({"damping_ratio": 0.0002}, "DampingRatio: 0.02 %"),
        ({"damping_ratio": 0.08}, "DampingRatio: 8 % is unusual"),
        ({"damping_range": 0.003}, "DampingRange 0.3 %: no verdict is given. Usual: 20 % to 50 %"),
        ({"margin_required": 0.03}, "MarginRequired: 3 % is unusual"),
        ({"starts_required": 5.0}, "StartsRequired: 5 is unusual"),
        ({"damping_ratio": None}, "No damping is stated"),
        ({"load_torque": ()}, "the start runs without load"),
    ],
)
def test_a_slip_of_the_case_is_told(change, said):
    assert said in said_of(sample_case("proposed", **change))


def test_slips_of_units_are_told():
    case = sample_case("proposed")
    shaft = replace(case.elements[0], stiffness=None, od=0.3, length=1.0, shear_modulus=80e6)
    heavy = replace(case.elements[2], density=7.85)
    steel = replace(case.materials[0], uts=1000.0 * (case.materials[0].uts or 0.0))
    curve = tuple(replace(p, speed=0.01 * (p.speed or 0.0)) for p in case.motor_torque)
    wrong = replace(
        case,
        elements=(shaft, case.elements[1], replace(heavy, od=0.3, length=1.0), *case.elements[3:]),
        materials=(steel,),
        motor_torque=curve,
    )
    notes = said_of(wrong)
    for said in ("0.08 GPa", "7.85 kg/m³", "UTS of", "ends at 1 % of synchronous"):
        assert said in notes


def test_a_margin_is_not_accepted_where_no_load_is_known():
    case = with_limits(sample_case("modified"))
    assert {r.verdict for r in run(case).margins.rows} == {"pass", "accepted by forced response"}
    unloaded = run(replace(case, load_torque=()))
    assert "accepted by forced response" not in {r.verdict for r in unloaded.margins.rows}
    assert next(v.verdict for v in unloaded.verdicts) == "fail"
    assert any("no separation margin can be accepted by it" in w for w in unloaded.warnings)


def test_a_start_that_does_not_end_has_no_verdict_on_starts():
    case = sample_case("modified", starts_required=10.0)
    stuck = replace(
        case, load_torque=tuple(replace(p, torque=9.0 * p.torque) for p in case.load_torque)
    )
    results = run(stuck)
    assert results.outcome in ("stalled", "no breakaway")
    starts = next(v for v in results.verdicts if v.check == "Allowable starts")
    assert starts.verdict == "not judged"
    assert results.outcome in starts.where
    for crossing in results.crossings:
        if crossing.time is None:
            assert crossing.acceleration is None
            assert crossing.load_torque is None


def test_round_off_is_not_a_reversal():
    case = sample_case("modified")
    smooth = replace(case, motor_torque=tuple(replace(p, pulsating=0.0) for p in case.motor_torque))
    results = run(smooth)
    lowest = next(p.minimum for p in results.start.peaks if p.element == "Mesh")
    assert -1.0 < lowest < 0.0  # N m, of 37 kN m: the load's breath at breaker closing
    verdict = next(v for v in results.verdicts if v.check == "Torque reversal")
    assert verdict.verdict == "pass"
    assert (
        verdict.where
        == "Mesh: torque does not reverse (below zero by less than 0.1% of its largest)"
    )
    reversing = next(v for v in run(case).verdicts if v.check == "Torque reversal")
    assert "torque reverses (" in reversing.where
    assert reversing.where.endswith("; Reversal limit is blank")


def test_clearance_voltage_and_trip_in_a_wrong_unit_are_noted():
    mesh = MeshRow("Mesh", pitch_radius_drive=0.2, backlash=0.0076, angular_backlash=0.3)
    case = CaseData(line_frequency=60.0, poles=4, meshes=(mesh,), voltage=0.008, trip_speed=0.9)
    notes = " ".join(implausible(case))
    assert "Backlash of 'Mesh': 7.6 mm is unusual for a pitch radius of 200 mm" in notes
    assert "Angular backlash of 'Mesh': 17.2 degrees" in notes
    assert "Voltage: 0.8 % leaves 0.0064 %" in notes
    assert "TripSpeed: 0.4775 % of synchronous speed" in notes
    usual = MeshRow("Mesh", pitch_radius_drive=0.2, backlash=4e-4)
    case = CaseData(line_frequency=60.0, poles=4, meshes=(usual,), voltage=0.8, trip_speed=90.0)
    assert not [n for n in implausible(case) if "unusual" in n or "Trip" in n or "voltage" in n]


@pytest.mark.parametrize(
    ("table", "column"), [("motor_torque", "average"), ("load_torque", "torque")]
)
def test_torques_a_hundred_times_too_small_are_told(table, column):
    case = CaseData(**vars(sample_case("proposed")))
    points = tuple(
        replace(p, **{column: 0.01 * (getattr(p, column) or 0.0)}) for p in getattr(case, table)
    )
    said = [n for n in implausible(replace(case, **{table: points})) if "is not 0.6 pu" in n]
    assert len(said) == 1
    assert f"{table.title().replace('_', '')} is above" in said[0]


@pytest.mark.parametrize(
    ("share", "said"),
    [(1.1, ""), (4.0, ""), (0.4, "0.4 × RatedPower is unusual"), (1e-3, "no verdict")],
)
def test_apparent_power_is_near_the_rated_power(share, said):
    case = CaseData(**vars(sample_case("modified")))
    motor = MotorDataRow(case.motor_stations[0], apparent_power=share * case.ratings.rated_power)
    case = replace(case, motor_data=(motor,))
    notes = said_of(case)
    assert said in notes
    assert bool(said) == bool(notes)
    impossible = [one.finding for one in impossible_inputs(case)]
    assert impossible == (["Apparent power of 'Motor' 0.001 × RatedPower"] if share < 0.05 else [])


@pytest.mark.parametrize(
    ("voltage", "discharge", "said"),
    [
        (3810.0, 9.0, "3810 V is 6600 V divided by √3"),
        (6600.0, 0.4, "0.4 times the resistance of the field is unusual"),
        (2400.0, 9.0, ""),  # 4160 V divided by √3, but a voltage of its own
        (6600.0, 9.0, ""),
        (None, None, ""),
    ],
)
def test_slips_of_a_data_sheet_are_told(voltage, discharge, said):
    motor = MotorDataRow("Motor", voltage=voltage, discharge_resistance=discharge)
    notes = said_of(replace(CaseData(**vars(sample_case("modified"))), motor_data=(motor,)))
    assert said in notes
    assert bool(said) == bool(notes)


@pytest.mark.parametrize(
    ("fields", "circuit", "said"),
    [
        ({"xd": 0.9, "xq": 1.3}, {}, "Are Xd and Xq interchanged?"),
        ({"xd": 1.3, "xq": 1.3}, {}, ""),
        ({}, {"xmd": 0.6, "xmq": 1.1}, "Are Xmd and Xmq interchanged?"),
        ({"discharge_resistance": 0.1, "discharge_resistance_reverse": 9.0}, {}, ""),
        (
            {"discharge_resistance": 9.0, "discharge_resistance_reverse": 90.0},
            {},
            "90 times the resistance",
        ),
        ({"discharge_resistance": 9.0, "discharge_resistance_reverse": "open"}, {}, ""),
    ],
)
def test_axes_and_discharge_paths_that_no_motor_has_are_told(fields, circuit, said):
    motor = MotorDataRow("Motor", **fields)
    rows = (MotorCircuitRow("Motor", **circuit),) if circuit else ()
    case = replace(
        CaseData(**vars(sample_case("modified"))), motor_data=(motor,), motor_circuit=rows
    )
    notes = said_of(case)
    assert said in notes
    assert bool(said) == bool(notes)


@pytest.mark.parametrize(
    ("amplitude", "base", "power", "said"),
    [
        (5.0, None, 1.25, "of RatedTorque it would be 6.25. Choose Base apparent power"),
        (-5.0, "rated torque", 1.25, "Choose Base apparent power"),
        (5.0, "apparent power", 1.25, ""),
        (6.25, None, 1.25, ""),
        (5.0, None, 1.01, ""),  # the bases are alike
    ],
)
def test_an_amplitude_in_pu_of_the_apparent_power(amplitude, base, power, said):
    """One over Xd'' is what the largest term of a short circuit has in pu of the motor's own base."""
    case = sample_case("proposed")
    station = case.motor_stations[0]
    motor = MotorDataRow(
        station, apparent_power=power * case.ratings.rated_power, xd_subtransient=0.2
    )
    term = EventTorqueRow("fault", station, amplitude, 1.0, base=base)
    given = vars(case) | {"motor_data": (motor,), "event_torque": (term,)}
    notes = said_of(CaseData(**given))
    assert ("EventTorque, Amplitude" in notes) == bool(said)
    assert said in notes
