"""Worksheet functions say what the workbook says, and refuse what is wrong in words.

The reference is the other way to the same numbers: the workbook read as a file, recalculated and
read again with openpyxl. Both must give the same doubles.
"""

import math
import re

import openpyxl
import pytest
from sheet_ranges import (
    SAME_CELLS,
    TEMPLATES,
    in_order,
    model_arguments,
    replace_models,
    table,
    with_conditions,
    with_event,
)

from addin.reading.workbook import read_workbook
from addin.worksheet.functions import units
from addin.worksheet.functions.model import TABLES
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FUNCTIONS, FunctionError, call
from addin.writing.recalculate import recalculate
from engine.case.data import case_digest
from engine.fatigue.sn_curve import sn_curve_for

CONTRACT = (
    "TV_FREQUENCIES TV_MODE TV_ENERGY TV_STIFFNESS TV_MARGINS TV_STEADY TV_MODEL TV_SPEED_TIME "
    "TV_PEAKS TV_HISTORY TV_REVERSALS TV_CYCLES TV_STARTS TV_SN_LIFE TV_CONVERT TV_EFFECTS"
).split()


@pytest.fixture(scope="module")
def handle():
    return call("TV_MODEL", model_arguments())[0][0]


@pytest.fixture(scope="module")
def recalculated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recalculated")
    recalculate(TEMPLATES / "example_proposed.xlsx", destination=folder / "done.xlsx")
    return openpyxl.load_workbook(folder / "done.xlsx", data_only=True)


def test_every_function_of_the_contract_is_there_and_those_of_the_studies():
    beside = ["TV_VERDICTS", "TV_BANDS", "TV_CALIBRATE", "TV_LIFE"]
    beside += ["TV_TUNE", "TV_TOLERANCES", "TV_SENSITIVITIES"]
    assert {*CONTRACT, *beside} <= set(FUNCTIONS)


def test_every_function_is_documented_for_a_wizard():
    for function in FUNCTIONS.values():
        assert 20 <= len(function.help) <= 255, function.name  # what Excel's wizard shows
        assert function.example.startswith("=" + function.name)
        for argument in function.arguments:
            assert 3 < len(argument.help) <= 255, (function.name, argument.name)


def test_the_handle_is_the_digest_of_the_workbook(handle):
    digest = case_digest(read_workbook(TEMPLATES / "example_proposed.xlsx").case())
    assert re.fullmatch(rf"tv:{digest[:16]}\.[0-9a-f]{{16}}-US", handle)
    assert call("TV_MODEL", model_arguments())[0][0] == handle


def test_events_are_those_of_their_table(handle):
    with pytest.raises(FunctionError, match="no event in operation"):
        call("TV_EVENTS", [handle])
    changed = call("TV_MODEL", with_event(model_arguments()))[0][0]
    head, *rows = call("TV_EVENTS", [changed])
    assert head[:2] == ["Event", "Element"]
    assert {row[0] for row in rows} == {"Fault"}
    assert all(row[2] > 0.0 for row in rows)
    assert call("TV_PEAKS", [changed]) == call("TV_PEAKS", [handle])


def test_verdicts_of_conditions_are_those_of_their_table(handle, tmp_path):
    with pytest.raises(FunctionError, match="fill table StartConditions"):
        call("TV_CASE_VERDICTS", [handle])
    changed = call("TV_MODEL", with_conditions(model_arguments()))[0][0]
    head, *rows = call("TV_CASE_VERDICTS", [changed])
    assert head[:5] == ["Condition", "Check", "Result", "Limit", "Verdict"]
    assert {row[0] for row in rows} == {"weak supply", "hot"}
    (hot,) = [row for row in rows if row[:2] == ["hot", "Separation margin"]]
    assert hot[4] == "fail"
    assert not [row for row in rows if row[0] == "hot" and row[1] == "Start"]  # steady: no start
    assert call("TV_PEAKS", [changed]) == call("TV_PEAKS", [handle])


@pytest.mark.parametrize("name", SAME_CELLS)
def test_cells_are_those_of_the_recalculated_workbook(name, handle, recalculated):
    head, *rows = call(name, [handle])
    there = table(recalculated, SAME_CELLS[name])
    columns = {header: j for j, header in enumerate(there[1])}
    written = [row for row in there[2:] if any(cell is not None for cell in row)]
    written = in_order(name, head, rows, there[1], written)
    compared = 0
    assert rows
    for j, header in enumerate(head):
        column = columns[header.split(" [")[0]]
        unit = there[0][column]
        assert header == (f"{there[1][column]} [{unit}]" if unit else there[1][column])
        for mine, its in zip(rows, written, strict=False):
            assert mine[j] == its[column], (header, mine[j], its[column])
            compared += 1
    assert compared >= len(rows[0])


def test_verdicts_are_those_of_the_summary(handle, recalculated):
    head, *rows = call("TV_VERDICTS", [handle])
    there = table(recalculated, "Verdicts")
    assert head == there[1]
    written = [row for row in there[2:] if any(cell is not None for cell in row)]
    assert rows == written
    assert "Start" in [row[0] for row in rows]


@pytest.mark.parametrize(("name", "value"), [("Maximum time", 2.0), ("Trip speed", 40.0)])
def test_starts_that_did_not_come_to_their_end_are_not_judged(name, value):
    """Two seconds of a six-second start meet no resonance: that is no unlimited number."""
    blocks = model_arguments()
    blocks[2] = [list(row) for row in blocks[2]]
    for row in blocks[2]:
        if name in row:
            row[row.index(name) + 1] = value
    handle = call("TV_MODEL", blocks)[0][0]
    head, *rows = call("TV_STARTS", [handle])
    row = next(r for r in rows if r[0] == "HP compressor shaft")
    verdict = next(v for v in call("TV_VERDICTS", [handle]) if v[0] == "Allowable starts")
    assert verdict[3] == "not judged"
    allowed, paper = row[head.index("Allowable starts")], row[head.index("Paper count")]
    if name == "Maximum time":
        assert (allowed, paper) == ("not judged", "not judged")
    else:  # a trip was asked for: so many starts that are tripped, before the first resonance
        assert allowed == "unlimited" or allowed > 1e5


def test_modes_are_those_of_the_sheet(handle, recalculated):
    there = table(recalculated, "ModeShapes")
    shape = call("TV_MODE", [handle, 2.0, False])
    column = there[1].index("Mode 2")
    assert shape == [[row[0], row[column]] for row in there[2 : 2 + len(shape)]]


def test_energy_shares_add_up_and_name_the_largest(handle):
    head, *rows = call("TV_ENERGY", [handle])
    largest = [row[5] for row in call("TV_FREQUENCIES", [handle, None, False])[1:]]
    for mode in range(2, len(head)):
        for kind in ("strain", "kinetic"):
            shares = {row[0]: row[mode] for row in rows if row[1] == kind}
            assert math.fsum(shares.values()) == pytest.approx(1.0, abs=1e-12)
            if kind == "strain":
                assert max(shares, key=shares.get) == largest[mode - 2]


def test_bands_forbid_the_modes_whose_margin_is_not_kept(handle):
    """Columns Mode, Excitation and Margin of TV_MARGINS against the bands, in the same units."""
    bands = call("TV_BANDS", [handle, None, False])
    margins = call("TV_MARGINS", [handle, None, False])
    assert [row[0] for row in bands if row[0] == "1× motor speed"] == ["1× motor speed"]
    for name, low, high, lowest, highest, inside in bands:
        assert low == pytest.approx(0.8 * lowest)
        assert high == pytest.approx(1.2 * highest)
        near = [f"mode {m[0]:.0f}" for m in margins if m[1] == name and m[4] < m[5]]
        assert (inside or "") == ", ".join(near)
    assert any(row[5] for row in bands)


def test_histories_hold_the_peaks_and_the_number_of_rows_asked_for(handle):
    for name, highest, lowest in (row[:3] for row in call("TV_PEAKS", [handle, None, False])):
        rows = call("TV_HISTORY", [handle, str(name).upper(), 101.0, None, False])
        torque = [row[1] for row in rows]
        assert len(rows) <= 101
        assert (max(torque), min(torque)) == (highest, lowest)
    time = [row[0] for row in call("TV_SPEED_TIME", [handle, 50.0, False])]
    assert len(time) <= 50
    assert time == sorted(time)


def test_units_and_headers_are_as_asked(handle):
    us, si = (call("TV_PEAKS", [handle, unit]) for unit in ("us", "SI"))
    assert "lbf*ft" in us[0][1]
    assert "N*m" in si[0][1]
    assert si[1][1] / us[1][1] == pytest.approx(4.4482216152605 * 0.3048, rel=1e-12)
    assert call("TV_PEAKS", [handle, "SI", False]) == si[1:]


def test_stiffness_is_that_of_the_textbook():
    """k = G π (D⁴ − d⁴) / 32 L, by hand."""
    solid = call("TV_STIFFNESS", [200.0, None, 500.0, 79300.0])[0][0]
    assert solid == pytest.approx(79300e6 * math.pi * 0.2**4 / (32 * 0.5), rel=1e-14)
    hollow = call("TV_STIFFNESS", [8.0, "", 20.0, 11.5e6, "US"])[0][0]
    assert hollow == pytest.approx(11.5e6 * math.pi * 8.0**4 / (32 * 20.0), rel=1e-9)


def test_ranges_have_one_stiffness_a_cell() -> None:
    """Rows of a table: a blank bore is a solid shaft, a blank row has none; one modulus for all."""
    outer, bore, length = (
        [[200.0], [150.0], [None]],
        [[None], [50.0], [None]],
        [[500.0], [300.0], [None]],
    )
    found = call("TV_STIFFNESS", [outer, bore, length, 79300.0])
    alone = [
        call("TV_STIFFNESS", [d[0], b[0], x[0], 79300.0])[0]
        for d, b, x in zip(outer[:2], bore, length, strict=False)
    ]
    assert found == [*alone, [None]]
    crossed = call("TV_STIFFNESS", [[[200.0], [150.0]], None, [[500.0, 250.0]], 79300.0])
    assert [len(row) for row in crossed] == [2, 2]
    for row in crossed:
        assert row[1] == pytest.approx(2.0 * row[0])


def test_conversion_of_ranges_keeps_blanks():
    rows = call("TV_CONVERT", [[[1.0, None], ["", -2.0]], "lbf*in", "N*m"])
    assert rows == [
        [pytest.approx(0.112984829027617, rel=1e-9), None],
        [None, pytest.approx(-0.225969658, rel=1e-8)],
    ]
    assert call("TV_CONVERT", [30.0, "Hz", "cpm"]) == [[1800.0]]


def test_life_is_that_of_the_s_n_line(handle):
    case = read_workbook(TEMPLATES / "example_proposed.xlsx").case()
    material = case.materials[0]
    curve = sn_curve_for(material, case.sn_points)
    stress = 1.7 * curve.endurance
    life = call("TV_SN_LIFE", [handle, material.material, [[stress / 6894.757293168361, 1.0]]])
    assert life[0][0] == pytest.approx(float(curve.cycles_to_failure(stress)), rel=1e-9)
    assert life[0][1] == "unlimited"


# --- what is wrong --------------------------------------------------------------------------------


def refused(name, *raw):
    with pytest.raises(FunctionError) as told:
        call(name, list(raw))
    assert "Traceback" not in told.value.message
    return told.value


def test_a_wrong_cell_is_named_with_table_row_and_column():
    arguments = model_arguments()
    stations = [list(row) for row in arguments[0]]
    stations[4][stations[1].index("Inertia")] = -3.0
    told = refused("TV_MODEL", stations, *arguments[1:])
    for word in ("Stations", "row 3", "Inertia", "-3"):
        assert word in told.message


@pytest.mark.parametrize("blank", [None, "", "  ", math.nan, {"type": "Empty", "basicValue": ""}])
def test_a_blank_never_becomes_zero(blank):
    arguments = model_arguments()
    stations = [list(row) for row in arguments[0]]
    at = stations[1].index("Inertia")
    stations[2][at] = blank
    told = refused("TV_MODEL", stations, *arguments[1:])
    assert "Stations, row 1, Inertia" in told.message
    elements = [list(row) for row in arguments[1]]
    stiff = elements[1].index("Stiffness")
    number = next(i for i, row in enumerate(elements[2:]) if isinstance(row[stiff], int | float))
    elements[2 + number][stiff] = blank
    told = refused("TV_MODEL", arguments[0], elements, *arguments[2:])
    assert f"Elements, row {number + 1}" in told.message


@pytest.mark.parametrize("value", ["#DIV/0!", {"type": "Error", "basicValue": "#DIV/0!"}])
def test_an_error_value_is_told_where_it_stands(value):
    arguments = model_arguments()
    stations = [list(row) for row in arguments[0]]
    stations[3][stations[1].index("Inertia")] = value
    told = refused("TV_MODEL", stations, *arguments[1:])
    assert "Stations, row 2, Inertia" in told.message
    assert "#DIV/0!" in told.message


def test_tables_without_units_are_not_guessed_at():
    arguments = model_arguments()
    told = refused("TV_MODEL", arguments[0][1:], *arguments[1:])
    assert "is missing. Include the units" in told.message
    assert "Inertia" in told.message


def test_wrong_tables_and_handles_are_told():
    arguments = model_arguments()
    assert "no headers" in refused("TV_MODEL", [[1.0, 2.0], [3.0, 4.0]], arguments[1]).message
    swapped = refused("TV_MODEL", arguments[1], arguments[0]).message
    assert "Stations: the range contains table Elements" in swapped
    assert "names of sheet Case" in refused("TV_MODEL", arguments[2], arguments[1]).message
    told = refused("TV_MODEL", arguments[0], arguments[1], arguments[3]).message
    assert "Case: the range contains table Meshes" in told
    # two tables that share headers
    told = refused("TV_MODEL", *arguments[:5], arguments[6], arguments[5]).message
    assert "MotorTorque: the range contains table LoadTorque" in told
    forgotten = refused("TV_PEAKS", "tv:0123456789abcdef")
    assert forgotten.code == "#N/A"
    assert "Ctrl+Alt+F9" in forgotten.message
    assert "A program must call TV_MODEL" in forgotten.message  # over HTTP nobody has keys
    assert "TV_MODEL" in refused("TV_PEAKS", "Stations, row 3: wrong").message
    assert refused("TV_PEAKS", "#REF!").code == "#REF!"
    assert refused("TV_NOTHING").code == "#NAME?"
    assert "at most" in refused("TV_CONVERT", 1, "m", "mm", 1, 1).message


def test_a_refused_unit_is_looked_up_once(monkeypatch):
    """A sheet, or an attacker, may send a thousand cells with the same wrong unit."""
    first = refused("TV_CONVERT", 1.0, "parsec", "kg").message
    monkeypatch.setattr(units, "parse_unit", None)
    assert refused("TV_CONVERT", 2.0, " parsec ", "kg").message == first


@pytest.mark.parametrize(
    ("name", "raw", "words"),
    [
        ("TV_STIFFNESS", [200.0, 250.0, 500.0, 79300.0], "below OD"),
        ("TV_STIFFNESS", [200.0, 0.0, None, 79300.0], "Length is blank"),
        ("TV_STIFFNESS", ["wide", 0.0, 500.0, 79300.0], "OD: found 'wide'"),
        ("TV_STIFFNESS", [200.0, 0.0, 500.0, 79300.0, "metric"], "give SI or US"),
        (
            "TV_STIFFNESS",
            [[[200.0, 150.0]], 0.0, [[500.0, 1.0, 2.0]], 79300.0],
            "1 × 2 cells beside one of 1 × 3",
        ),
        (
            "TV_STIFFNESS",
            [[[200.0], [-1.0]], 0.0, 500.0, 79300.0],
            "Row 2, column 1 of the ranges: OD",
        ),
        (
            "TV_STIFFNESS",
            [[[200.0], [150.0]], 0.0, [[500.0], [None]], 79300.0],
            "Row 2, column 1 of the ranges: Length is blank",
        ),
        ("TV_CONVERT", [1.0, "lb*ft^2", "N*m"], "is not"),
        ("TV_CONVERT", [1.0, "florps", "m"], "florps"),
        ("TV_CONVERT", [[["a"]], "m", "mm"], "found 'a'"),
        ("TV_CONVERT", [True, "m", "mm"], "TRUE"),
        (
            "TV_CONVERT",
            [1.0, "ft-lbm", "N*m"],
            "'ft-lbm' is not a known unit; lb is a mass, not a force: write",
        ),
        (
            "TV_CONVERT",
            [1.0, "N*m", "ft-lbm"],
            "'ft-lbm' is not a known unit; lb is a mass, not a force: write",
        ),
        ("TV_CONVERT", [1.0, "psj", "MPa"], "'psj' is not a known unit; did you mean psi?"),
        ("TV_CONVERT", [1.0, "mm" + 250 * " " + "x", "m"], "is not a known unit"),
        ("TV_PEAKS", [None], "Model is blank. Give the cell with =TV_MODEL(...)."),
        (
            "TV_STIFFNESS",
            ["200", 0.0, 500.0, 79300.0],
            "OD: found '200', which looks like a number",
        ),
        ("TV_STIFFNESS", [200.0, 0.0, "0,5", 79300.0], "Length: found '0,5', which has a decimal"),
        ("TV_CONVERT", [[["1"]], "m", "mm"], "Value: found '1', which looks like a number"),
        ("TV_STIFFNESS", [200.0, {"value": 150}, 500.0, 79300.0], 'ID: found the object {"value"'),
        ("TV_CONVERT", [[[1.0, {"x": 1}]], "m", "mm"], "Value: found the object"),
        ("TV_CONVERT", [{"type": "Double"}, "m", "mm"], "Value: found the object"),
    ],
)
def test_wrong_arguments_are_told(name, raw, words):
    assert words in refused(name, *raw).message


def test_a_range_without_units_is_told_in_one_sentence():
    arguments = model_arguments()
    told = refused("TV_MODEL", arguments[0][1:], *arguments[1:]).message
    inertia = told.split(" Stations, Damping")[0]
    assert inertia == (
        "Stations, Inertia: the unit above the header is missing. Include the units in the range; "
        "usual units are lb*ft^2, lb*in^2, lbf*in*s^2, kg*m^2."
    )


@pytest.mark.parametrize(
    ("table_at", "header", "typed", "hint"),
    [
        (0, "Inertia", "Inerta", " Did you mean 'Inertia'?"),
        (0, "Station", "Statoin", " Did you mean 'Station'?"),
        (1, "Stiffness", "Stifness", " Did you mean 'Stiffness'?"),
        (1, "Kind", "xyzzy", ""),
    ],
)
def test_a_mistyped_header_is_told_once_and_not_for_every_row(table_at, header, typed, hint):
    arguments = model_arguments()
    one = [list(row) for row in arguments[table_at]]
    one[1][one[1].index(header)] = typed
    arguments[table_at] = one
    name = ("Stations", "Elements")[table_at]
    told = refused("TV_MODEL", *arguments).message
    assert told == f"{name}, {typed}: the header '{typed}' is unknown.{hint}"


def test_modes_and_elements_that_are_not_there(handle):
    assert "elastic modes" in refused("TV_MODE", handle, 99.0).message
    assert "whole number" in refused("TV_MODE", handle, 1.5).message
    told = refused("TV_HISTORY", handle, "Nowhere").message
    assert "'LP shaft, far end'" in told  # a name with a comma stays one name
    assert "Did you mean" not in told
    assert "Did you mean 'LS coupling'?" in refused("TV_HISTORY", handle, "LS couplng").message
    told = refused("TV_SN_LIFE", handle, "Aloy steel", 1.0).message
    assert told == (
        "Material: found 'Aloy steel'; there are: 'Alloy steel'. Did you mean 'Alloy steel'?"
    )
    assert "give 3 to" in refused("TV_HISTORY", handle, "LS coupling", 1e6).message


def test_a_case_without_a_start_says_so():
    arguments = model_arguments()
    without = [
        None if "Torque" in name else one
        for name, one in zip(TABLES[2:], arguments[3:], strict=True)
    ]
    bare = call("TV_MODEL", [*arguments[:3], *without])[0][0]
    assert len(call("TV_FREQUENCIES", [bare])) > 2
    for name in ("TV_PEAKS", "TV_STARTS", "TV_SPEED_TIME", "TV_REVERSALS", "TV_CYCLES"):
        told = refused(name, bare)
        assert told.code == "#N/A"
        assert told.message.startswith("The case has no start")


def test_a_start_without_judged_shafts_says_what_is_missing():
    arguments = model_arguments()
    elements = [list(row) for row in arguments[1]]
    for header in ("Stress diameter", "Stress bore", "SCF", "Material"):
        for row in elements[2:]:
            row[elements[1].index(header)] = None
    unjudged = call("TV_MODEL", [arguments[0], elements, *arguments[2:]])[0][0]
    for name in ("TV_CYCLES", "TV_STARTS"):
        assert refused(name, unjudged).message.startswith("No shaft is judged for fatigue")
    plain = {
        "stations": [["", "kg*m^2"], ["Station", "Inertia"], ["M", 1.0], ["L", 2.0]],
        "elements": [
            ["", "", "", "", "N*m/rad"],
            ["Element", "Kind", "From", "To", "Stiffness"],
            ["S", "shaft", "M", "L", 1e4],
        ],
        "case": [["Line frequency", 60.0, "Hz"], ["Poles", 4.0], ["Rated torque", 10.0, "N*m"]],
        "motor": [
            ["", "%", "N*m", "N*m"],
            ["Station", "Speed", "Average", "Pulsating"],
            ["M", 0.0, 10.0, 5.0],
            ["M", 100.0, 10.0, 0.0],
        ],
    }
    without_mesh = call(
        "TV_MODEL",
        [plain["stations"], plain["elements"], plain["case"], None, None, plain["motor"]],
    )[0][0]
    told = refused("TV_REVERSALS", without_mesh).message
    assert told == "The train has no gear mesh and no geared coupling."


# --- what the functions promise ---------------------------------------------------------------------


@pytest.mark.parametrize("most", [3.0, 4.0, 5.0, 20.0])
def test_curves_have_no_more_rows_than_asked_for(handle, most):
    for name, given in (("TV_HISTORY", ["LS coupling"]), ("TV_SPEED_TIME", [])):
        rest = [None, False] if given else [False]
        rows = call(name, [handle, *given, most, *rest])
        everything = call(name, [handle, *given, 20_001.0, *rest])
        assert len(rows) <= most
        assert (rows[0], rows[-1]) == (everything[0], everything[-1])


def test_speed_is_thinned_evenly(handle):
    time = [row[0] for row in call("TV_SPEED_TIME", [handle, 41.0, False])]
    steps = [b - a for a, b in zip(time, time[1:], strict=False)]
    assert len(time) == 41
    assert max(steps) < 1.5 * min(steps)


def test_a_turning_point_of_the_speed_is_kept():
    import numpy as np

    from addin.charts.rows import thinned

    time = np.linspace(0.0, 10.0, 1001)
    speed = np.where(time < 6.43, time, 12.86 - time)  # a trip
    kept = thinned(time, speed, 21)
    assert kept.size <= 21
    assert speed.argmax() in kept
    assert {0, 1000} <= set(kept.tolist())
    swinging = np.sin(40.0 * time)
    assert thinned(time, swinging, 21).size <= 21


def test_stresses_beyond_the_s_n_points_are_told(handle):
    """Points of the example: 49,500 psi for 1,000 cycles, 19,000 psi for 1,000,000; UTS 110,000."""
    slope = math.log(1e6 / 1e3) / math.log(49500.0 / 19000.0)
    ask = [handle, "Alloy steel", [[60000.0, 30000.0, 19000.0, None]], "US"]
    (plain,) = call("TV_SN_LIFE", ask)
    assert plain[0] == pytest.approx(1e3 * (49500.0 / 60000.0) ** slope, rel=1e-9)
    assert plain[2:] == ["unlimited", None]
    (told,) = call("TV_SN_LIFE", [*ask, True])
    assert told[:4] == plain
    assert "above the first S-N point" in told[4]
    assert told[5:] == [None, None, None]
    assert call("TV_SN_LIFE", [handle, "Alloy steel", 110000.0])[0][0] > 1.0
    above = refused("TV_SN_LIFE", handle, "Alloy steel", [[1.0, 120000.0]], "US")
    assert above.code == "#NUM!"
    assert above.message.startswith(
        "Stress, row 1, column 2: found 120000 psi, above UTS of 'Alloy steel', 110000 psi"
    )


# --- kept within bounds ---------------------------------------------------------------------------


def test_a_start_is_calculated_once_for_every_cell(handle, monkeypatch):
    call("TV_PEAKS", [handle])
    monkeypatch.setattr("addin.calculation.calculation.calculate", None)  # would raise
    assert len(call("TV_STARTS", [handle])) > 1


def test_results_are_dropped_and_calculated_again_when_memory_is_short(monkeypatch):
    models = MODELS.__class__(most_cases=3, most_memory=1)
    replace_models(monkeypatch, models)
    first = call("TV_MODEL", model_arguments())[0][0]
    second = call("TV_MODEL", model_arguments("example_modified"))[0][0]
    rows = call("TV_FREQUENCIES", [first])
    call("TV_PEAKS", [first])
    held = models.memory
    assert held > 1e4
    call("TV_PEAKS", [second])
    assert models.of(first).kept == {}
    assert models.memory < 2.0 * held
    assert call("TV_FREQUENCIES", [first]) == rows


def test_only_so_many_cases_are_remembered(monkeypatch):
    models = MODELS.__class__(most_cases=2)
    replace_models(monkeypatch, models)
    names = ("example_proposed", "example_modified", "example_backlash")
    handles = [call("TV_MODEL", model_arguments(name))[0][0] for name in names]
    assert refused("TV_FREQUENCIES", handles[0]).code == "#N/A"
    assert len(call("TV_FREQUENCIES", [handles[2]])) > 2


# --- studies --------------------------------------------------------------------------------------


def test_life_of_a_duty_by_hand():
    """0.05 used of 1/2; 0.01 a year: 45 years. One column or several, a blank is none."""
    damage, yearly, so_far = (
        [[2e-4], [5e-4], [1e-3]],
        [[20.0], [10.0], [1.0]],
        [[100.0], [60.0], [None]],
    )
    ((used, a_year, left, years),) = call("TV_LIFE", [damage, yearly, so_far, 2.0])
    assert (used, a_year, left, years) == pytest.approx((0.05, 0.01, 0.45, 45.0))
    assert call("TV_LIFE", [[[0.0]], [[12.0]]])[0][3] == "unlimited"
    without = call("TV_LIFE", [damage, yearly])
    assert (
        without
        == call("TV_LIFE", [damage, yearly, None])
        == call("TV_LIFE", [damage, yearly, [[None]]])
    )
    assert call("TV_LIFE", [[[1e-3]], [[1.0]], [[1500.0]]])[0][2:] == pytest.approx([-0.5, 0.0])
    assert "give the same number" in refused("TV_LIFE", damage, [[1.0]]).message
    assert "give 0 or more" in refused("TV_LIFE", [[-1.0]], [[1.0]]).message
    assert "more than 0" in refused("TV_LIFE", [[1.0]], [[1.0]], None, 0.0).message


def test_life_from_the_damage_of_a_start(handle):
    rows = {row[0]: row for row in call("TV_STARTS", [handle, None, False])}
    _, damage, starts, *_ = rows["HP compressor shaft"]
    ((*_, years),) = call("TV_LIFE", [damage, 10.0])
    assert years == pytest.approx(starts / 10.0)


def test_a_tolerance_that_can_never_be_met_is_refused():
    stations, elements, case, *rest = model_arguments()
    told = refused("TV_MODEL", stations, elements, [*case, ["TolerancePeak", 1e-8, "1"]], *rest)
    assert "TolerancePeak" in told.message
    assert "found 1e-08; it must be between 2e-07 and 0.5" in told.message


def test_calibration_explains_what_was_measured(handle):
    """All frequencies 1 % higher: stiffnesses rise, and none of those that say nothing of it moves."""
    f = [row[1] for row in call("TV_FREQUENCIES", [handle, None, False]) if row[0] > 0][:3]
    head, *rows = call("TV_CALIBRATE", [handle, [[1.01 * x for x in f]], 0.001, 0.1])
    assert head[:3] == ["Name", "Stiffness [lbf*in/rad]", "Calibrated stiffness [lbf*in/rad]"]
    for name, before, after, change, low, high, _ in rows:
        assert after == pytest.approx(before * (1.0 + 0.01 * change)), name
        assert low < change < high
    assert sum(row[6] == "determined" for row in rows) <= 3  # three frequencies, ten stiffnesses
    assert max(row[3] for row in rows) > 1.0
    same = call("TV_CALIBRATE", [handle, [f], None, None, "SI", False])
    assert all(row[3] == pytest.approx(0.0, abs=1e-9) for row in same)
    assert "no mode can have this frequency" in refused("TV_CALIBRATE", handle, 200.0).message
    assert "must be positive" in refused("TV_CALIBRATE", handle, [[30.0, -1.0]]).message
    assert "Uncertainty" in refused("TV_CALIBRATE", handle, 30.0, 5.0).message
