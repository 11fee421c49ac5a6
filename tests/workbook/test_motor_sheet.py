"""Sheet Torque and motor: data sheets are read, curves are written, and the start uses them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from made_up_run import STAMP

from addin.calculation.calculation import calculate
from addin.contract.input_copy import copy_name
from addin.reading.workbook import read_workbook
from addin.template import build as template
from addin.template.examples import EXAMPLES
from addin.verify.file import verify_file
from addin.writing.recalculate import recalculate
from addin.writing.workbook import write_results
from addin.xlsx import open_workbook
from engine.case.data import EffectChoiceRow, case_digest
from engine.case.plausibility import implausible
from engine.motor.curves import slip_curves
from engine.motor.from_case import motors_from_data
from tests.opened import rows_of
from tests.typed_cells import typed as typed_into

MOTOR = {
    "Station": "Motor", "Apparent power": 12000.0, "Voltage": 13200.0, "Xd": 1.3, "Xq": 0.9,
    "Xd transient": 0.35, "Xd subtransient": 0.22, "Xq subtransient": 0.26, "Xl": 0.12, "Td0 transient": 3.0,
    "Td0 subtransient": 35.0, "Tq0 subtransient": 0.12, "Ta": 0.05, "Discharge resistance": 9.0,
}  # fmt: skip
IN_MS = {("MotorData", "Td0 subtransient"): "ms"}


def built(path: Path, motor=MOTOR, units=IN_MS, typed: bool = True) -> Path:
    """The proposed example with the data sheet of its motor, and its typed curve or none."""
    example = EXAMPLES["proposed"]
    tables = {**example.tables, "MotorData": [motor]}
    if not typed:
        tables["MotorTorque"] = []
    example = replace(example, tables=tables, units={**example.units, **units})
    return template.build_template(path, "us", example)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("motor")


@pytest.fixture(scope="module")
def example(folder: Path) -> Path:
    return template.build_template(folder / "example.xlsx", "us", "motor")


@pytest.fixture(scope="module")
def written(folder: Path) -> Path:
    source = built(folder / "data.xlsx", typed=False)
    recalculate(source, destination=folder / "out.xlsx")
    return folder / "out.xlsx"


def test_the_table_holds_the_curves(written: Path) -> None:
    rows = rows_of(written, "MotorCurves")
    motor = next(motors_from_data(read_workbook(written).case()))
    curves = slip_curves(motor.starting, np.linspace(1.0, 0.0, 101))
    lbf_ft = 1.3558179483314004
    assert len(rows) == 101
    for column, values in (
        ("Average", motor.torque_base * curves.average / lbf_ft),
        ("Pulsating", motor.torque_base * curves.pulsating / lbf_ft),
        ("Phase", np.degrees(curves.phase)),
        ("Current", curves.current),
        ("Power factor", curves.power_factor),
        ("Speed", (1.0 - curves.slip) * 1800.0),
    ):
        found = [row[column] for row in rows]
        assert found == pytest.approx(values.tolist(), rel=1e-9, abs=1e-9), column
    assert motor.torque_base == pytest.approx(12e6 / (60.0 * np.pi), rel=1e-12)


def test_what_the_motor_damps_stands_beside_the_frequencies(written: Path) -> None:
    """A row a mode at its crossing; without a power factor none in operation. The start has it."""
    rows = rows_of(written, "ElectricalDamping")
    crossed = [row for row in rows_of(written, "NaturalFrequencies") if row["Percent speed"]]
    assert [row["Mode"] for row in rows] == [row["Mode"] for row in crossed]
    for row, mode in zip(rows, crossed, strict=True):
        assert row["Percent speed"] == pytest.approx(mode["Percent speed"], rel=1e-9)
        assert row["Damping ratio"] == mode["Damping ratio"]
        whole = row["Damping ratio"] + row["Share of damping ratio"]
        assert row["With motors"] == pytest.approx(whole, rel=1e-9)
        # both are half the torque over speed, times the same share of the mode
        assert row["Share of the slope"] * row["Re K"] == pytest.approx(
            row["Share of damping ratio"] * row["Slope of the curve"], rel=1e-9
        )
    effects = {row["Effect"]: row for row in rows_of(written, "Effects")}
    assert effects["electrical damping"]["On"] in ("yes", True, "on")


def test_the_start_uses_them(written: Path) -> None:
    """The average torque at a crossing is that of the curve there."""
    motor = next(motors_from_data(read_workbook(written).case()))
    first = rows_of(written, "StartupCrossings")[0]
    at = slip_curves(motor.starting, np.array([1.0 - first["Percent speed"] / 100.0]))
    average = motor.torque_base * at.average[0] / 1.3558179483314004
    assert first["Average torque"] == pytest.approx(
        average, rel=1e-3
    )  # read off the grid of the run-up
    torques = [row for row in rows_of(written, "ChartTorque") if row["Speed"] is not None]
    assert len(torques) > 101
    drawn = [row for row in rows_of(written, "ChartMotor") if row["Speed"] is not None]
    assert len(drawn) == 101
    assert all(row["Typed average"] is None for row in drawn)


def test_the_results_follow_from_the_inputs(written: Path) -> None:
    assert not [finding for finding in verify_file(written).findings if finding.fails]


def test_typed_curves_win_with_a_note(folder: Path) -> None:
    source = built(folder / "both.xlsx")
    off = (EffectChoiceRow("electrical damping", "off"),)  # that is of the data sheet
    run = calculate(replace(read_workbook(source).case(), effect_choices=off))
    plain = calculate(
        read_workbook(template.build_template(folder / "plain.xlsx", "us", "proposed")).case()
    )
    for ours, typed in zip(run.results.start.peaks, plain.results.start.peaks, strict=True):
        assert (ours.maximum, ours.minimum) == (typed.maximum, typed.minimum)
    notes = [
        note
        for note in run.results.warnings
        if note.startswith("'Motor' has a torque curve and a data sheet")
    ]
    assert len(notes) == 1
    assert not [note for note in plain.results.warnings if "data sheet" in note]


NAME_PLATE = {"Station": "Motor", "Apparent power": 12000.0, "Voltage": 13200.0}
IN_PER_UNIT = {
    "data sheet": {
        "MotorData": {name: MOTOR[name] for name in MOTOR if name.startswith("X")} | {"Ra": 0.0123},
    },
    "induction": {
        "MotorData": {"R1": 0.011, "X1": 0.09, "Xm": 3.7, "R2": 0.013, "X2": 0.11, "R3": 0.07, "X3": 0.05},
    },
    "circuit": {
        "MotorCircuit": {
            "Rs": 0.011, "Xl": 0.12, "Xmd": 1.13, "Xmq": 0.67, "Rf": 0.0023, "Xlf": 0.17, "Rkd": 0.035, "Xlkd": 0.11,
            "Rkq": 0.045, "Xlkq": 0.13, "Rkd2": 0.12, "Xlkd2": 0.19, "Rkq2": 0.17, "Xlkq2": 0.21, "Xc": 0.031,
        },
    },
}  # fmt: skip
BESIDE = {
    "data sheet": {name: MOTOR[name] for name in MOTOR if name[:2] in ("Td", "Tq")},
    "induction": {"Kind": "induction"},
    "circuit": {},
}


@pytest.mark.parametrize("motor", IN_PER_UNIT)
def test_per_unit_per_cent_and_ohm_are_one_motor(folder: Path, motor: str) -> None:
    """One digest and one start, whichever unit stands above the columns."""
    cases = []
    for unit, size in (("pu", 1.0), ("%", 100.0), ("ohm", 13200.0**2 / 12e6)):
        tables: dict[str, dict[str, object]] = {"MotorData": NAME_PLATE | BESIDE[motor]}
        units = dict(IN_MS)
        for table, row in IN_PER_UNIT[motor].items():
            tables[table] = {"Station": "Motor"} | tables.get(table, {})
            tables[table] |= {name: value * size for name, value in row.items()}
            units |= {(table, name): unit for name in row}
        example = EXAMPLES["proposed"]
        rows = {name: [row] for name, row in tables.items()}
        example = replace(
            example, tables=example.tables | rows | {"MotorTorque": []}, units=example.units | units
        )
        path = template.build_template(folder / f"{motor} {size:g}.xlsx", "us", example)
        cases.append(read_workbook(path).case())
    assert len({case_digest(case) for case in cases}) == 1
    results = [calculate(case).results for case in cases]
    for other in results[1:]:
        for ours, theirs in zip(results[0].start.peaks, other.start.peaks, strict=True):
            assert (ours.maximum, ours.minimum) == pytest.approx(
                (theirs.maximum, theirs.minimum), rel=1e-10
            )
    changed = replace(
        cases[0], motor_data=(replace(cases[0].motor_data[0], apparent_power=12.1e6),)
    )
    assert case_digest(changed) != case_digest(cases[0])


def test_problems_name_the_cell(folder: Path) -> None:
    wrong = MOTOR | {"Xl": 0.23}
    (problem,) = read_workbook(built(folder / "wrong.xlsx", wrong)).problems
    assert (problem.sheet, problem.table, problem.row, problem.column) == (
        "Torque and motor",
        "MotorData",
        1,
        "Xl",
    )
    assert problem.message.endswith("in the right columns.")
    in_ohm = {name: value for name, value in MOTOR.items() if name != "Voltage"}
    units = IN_MS | {("MotorData", "Xd"): "ohm"}
    (problem,) = read_workbook(built(folder / "ohm.xlsx", in_ohm, units)).problems
    assert (
        "it is in ohm, but the rated voltage or apparent power of the motor is unknown"
        in problem.message
    )


@pytest.mark.parametrize(
    ("typed_in", "cell", "words"),
    [
        ({"MotorData/1/Discharge resistance": "0.5 ohm"}, "Discharge resistance", "by that of the field winding"),
        ({"Poles": 5}, "Poles", "an even number, 2 or more. Poles are counted, not pole pairs"),
        ({"MotorEvents/1/Station": "Motr"}, "Station", "Did you mean 'Motor'?"),
        ({"MotorEvents/1/Station": "Bull gear"}, "Station", "type its row in table MotorData"),
        ({"EventTorque/1/Base": "MVA"}, "Base", "one of rated torque, apparent power"),
        ({"MotorEvents/1/Clears after": -0.1}, "Clears after", "nothing clears before it begins"),
        ({"MotorEvents/1/Begins": -1.0}, "Begins", "It counts from the closing of the breaker"),
    ],
)  # fmt: skip
def test_a_slip_of_typing_has_its_cell_and_its_remedy(
    folder: Path, example: Path, typed_in: dict[str, object], cell: str, words: str
) -> None:
    (problem,) = read_workbook(typed_into(example, folder / "slip.xlsx", typed_in)).problems
    assert problem.column == cell
    assert problem.cell is not None
    assert words in problem.message


@pytest.mark.parametrize(
    ("typed_in", "words"),
    [
        ({"MotorData/1/Discharge resistance": 0.5}, "MotorData, Discharge resistance of 'Motor': 0.5 times"),
        ({"MotorData/1/Voltage": 3810.0}, "3810 V is 6600 V divided by √3. Type the voltage from line to line"),
        ({"EventTorque/1/Amplitude": -30.0}, "Check that it is a share of RatedTorque: not of the apparent power"),
    ],
)  # fmt: skip
def test_a_doubtful_number_has_a_note(
    folder: Path, example: Path, typed_in: dict[str, object], words: str
) -> None:
    """It may be meant: it is read, and what makes it doubtful and what to do stand beside the results."""
    plain, doubtful = (
        [*implausible(read_workbook(path).case())]
        for path in (example, typed_into(example, folder / "doubtful.xlsx", typed_in))
    )
    assert [note for note in doubtful if words in note]
    assert not [note for note in plain if words in note]


def test_a_workbook_of_an_earlier_version_lacks_the_sheet(folder: Path) -> None:
    """It is read and written as before, its copy of the inputs too."""
    book = openpyxl.load_workbook(template.build_template(folder / "new.xlsx", "us", "proposed"))
    lacks = [n for s in book for n in s.tables if "Motor" in n and "MotorTorque" not in n]
    for sheet in book:
        for name in set(sheet.tables) & set(lacks):
            del sheet.tables[name]
        for cell in (cell for row in sheet.iter_rows() for cell in row):
            if cell.data_type == "f" and any(f"{name}[" in str(cell.value) for name in lacks):
                cell.value = None  # what newer versions say of those tables
    book.save(folder / "old.xlsx")
    read = read_workbook(folder / "old.xlsx")
    assert read.problems == ()
    assert read.data.motor_data == ()
    report = write_results(
        folder / "old.xlsx", folder / "done.xlsx", calculate(read.case()).view, STAMP
    )
    assert not report.notes
    tables = open_workbook(folder / "done.xlsx").tables
    assert not [
        name for name in tables if name in ("MotorCurves", "ChartMotor", copy_name("MotorData"))
    ]
    assert tables[copy_name("Stations")].data.height > 10


def test_a_one_way_path_makes_torque_at_slip_frequency(folder: Path) -> None:
    """Written, read, calculated in time, drawn, and refused by a word that it does not know."""
    one_way = MOTOR | {"Discharge resistance reverse": "open"}
    source = built(folder / "one_way.xlsx", one_way, typed=False)
    recalculate(source, destination=folder / "one_way_out.xlsx")
    written = folder / "one_way_out.xlsx"
    case = read_workbook(written).case()
    (motor,) = motors_from_data(case)
    rows = rows_of(written, "MotorCurves")
    curves = slip_curves(motor.starting, np.array([0.5]))
    half = next(row for row in rows if row["Slip"] == pytest.approx(0.5))
    share = half["Pulsation1"] / half["Average"]
    assert share == pytest.approx(float(curves.pulsation_1[0] / curves.average[0]), rel=1e-12)
    effects = {row["Effect"]: row for row in rows_of(written, "Effects")}
    assert "one-way discharge path" in effects["motor transient"]["Why"]
    assert "one-way discharge path" in effects["electrical damping"]["Why"]
    assert any(row["Multiple of slip"] == 1 for row in rows_of(written, "StartupCrossings"))
    drawn = rows_of(written, "ChartMotor")
    assert drawn[0]["Pulsation1"] == pytest.approx(rows[0]["Pulsation1"], rel=1e-5)
    wrong = built(
        folder / "shut.xlsx", MOTOR | {"Discharge resistance reverse": "shut"}, typed=False
    )
    (problem,) = read_workbook(wrong).problems
    assert "open" in problem.message
    assert problem.cell is not None


def test_a_soft_starter_of_a_typed_curve(folder: Path) -> None:
    example = EXAMPLES["proposed"]
    row = {"Station": "Motor", "Starting": "soft start", "Initial voltage": 60.0, "Ramp time": 4.0}
    example = replace(example, tables={**example.tables, "Supply": [row]})
    source = template.build_template(folder / "soft.xlsx", "us", example)
    outcome = recalculate(source, destination=folder / "soft_out.xlsx")
    assert any(
        "Soft starter of 'Motor'" in w and "voltage is full from" in w for w in outcome.warnings
    )
    assert read_workbook(folder / "soft_out.xlsx").case().supply[
        0
    ].initial_voltage == pytest.approx(0.6)
