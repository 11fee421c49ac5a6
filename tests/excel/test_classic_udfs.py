"""Cells through xlwings' own machinery (`XLPython.CallUDF`) against the registry, bit for bit."""

import datetime as dt
import inspect
import struct
import subprocess
import sys
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sheet_ranges import model_arguments
from strategies import example_count
from windows_layer import ERRORS, MISSING

from addin.excel.signatures import MOST_HELP, RESERVED, excel_functions
from addin.excel.vba import XLWINGS_VERSION
from addin.worksheet.registry import CATEGORY, FUNCTIONS, call


def bits(value):
    """A cell with its double as eight bytes: -0.0 and the last bit count."""
    return struct.pack("<d", value) if isinstance(value, float) else value


def as_excel_gets(rows):
    """Rows of the registry as `CallUDF` hands them on: blank = "", a row or a cell of its own."""
    shown = [["" if v is None else bits(v) for v in row] for row in rows]
    if len(shown) == 1:
        return shown[0][0] if len(shown[0]) == 1 else shown[0]
    return shown


def in_bits(answer):
    if not isinstance(answer, list):
        return bits(answer)
    return [[bits(v) for v in r] if isinstance(r, list) else bits(r) for r in answer]


@pytest.fixture(scope="module")
def handle(excel):
    return excel.call("TV_MODEL", *model_arguments())


# --- what is exported -----------------------------------------------------------------------------


def test_every_function_of_the_registry_is_exported_and_no_other(excel):
    exported = {n for n, v in vars(excel.module).items() if hasattr(v, "__xlfunc__")}
    assert exported == set(FUNCTIONS)
    assert len(exported) == 30


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_shape_errors_help_and_category_are_given_to_xlwings(excel, name):
    told = getattr(excel.module, name).__xlfunc__
    registered = FUNCTIONS[name]
    assert told["category"] == CATEGORY
    assert told["call_in_wizard"] is True
    assert told["volatile"] is False
    assert told["async_mode"] is None
    assert told["ret"] == {"doc": registered.help, "options": {}}
    for ours, theirs in zip(registered.arguments, told["args"], strict=True):
        assert theirs["options"] == {"ndim": 2, "err_to_str": True}
        assert theirs["doc"] == ours.help
        assert ("optional" in theirs) == ours.optional
        assert theirs["vararg"] is False


def test_signatures_have_the_names_of_the_arguments(excel):
    signature = inspect.signature(excel.module.TV_STIFFNESS)
    assert str(signature) == "(od, id, length, shear_modulus, units=None)"


def test_no_name_is_a_word_of_vba():
    for one in excel_functions():
        names = [a.name for a in one.arguments]
        assert len(set(names)) == len(names)
        assert not RESERVED & {*names, one.name.lower()}
        assert len(one.help) <= MOST_HELP
        assert all(len(a.help) <= MOST_HELP for a in one.arguments)


def test_xlwings_is_pinned_to_the_version_the_vba_is_of(checkout):
    project = tomllib.loads((checkout / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["optional-dependencies"]["excel"] == [f"xlwings=={XLWINGS_VERSION}"]


@pytest.mark.slow
def test_the_module_imports_where_there_is_no_com():
    """A process of its own, since here xlwings believes to be on Windows."""
    script = (
        "import addin.excel.udfs as u, sys\n"
        "assert sys.platform == 'win32' or not hasattr(u.TV_MODEL, '__xlfunc__')\n"
        "print(u.TV_CONVERT([[2.5]], [['m']], [['mm']]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.strip() == "[[2500.0]]"


# --- calls ----------------------------------------------------------------------------------------

CALLS = [
    ("TV_FREQUENCIES", ()), ("TV_FREQUENCIES", ("US", False)), ("TV_MODE", (2.0,)),
    ("TV_ENERGY", ()), ("TV_MARGINS", ("SI",)), ("TV_BANDS", ()), ("TV_STEADY", ()), ("TV_SPEED_TIME", (50.0,)),
    ("TV_PEAKS", ()), ("TV_HISTORY", ("LS coupling", 100.0)), ("TV_REVERSALS", ()),
    ("TV_CYCLES", ()), ("TV_STARTS", ()), ("TV_EFFECTS", ()), ("TV_VERDICTS", ()),
    ("TV_SENSITIVITIES", ()),
]  # fmt: skip


@pytest.mark.parametrize(("name", "more"), CALLS, ids=lambda v: str(v))
def test_answers_about_a_model_are_those_of_the_registry_bit_for_bit(excel, handle, name, more):
    left_out = len(FUNCTIONS[name].arguments) - 1 - len(more)
    given_cells = [[[handle]], *([[v]] for v in more), *[MISSING] * left_out]
    answer = excel.call(name, *given_cells)
    assert isinstance(answer, list), answer
    assert in_bits(answer) == as_excel_gets(call(name, [handle, *more]))


def test_the_model_has_the_handle_of_every_front(excel, handle):
    assert handle == call("TV_MODEL", model_arguments())[0][0]


def test_stresses_in_a_range_keep_their_shape(excel, handle):
    material = excel.call("TV_SN_LIFE", handle, "nonsense", 1.0, MISSING)
    name = material.partition("there are: ")[2].split(",")[0].rstrip(".").strip("'")
    stresses = [[100.0, None, 300.0], [400.0, 0.0, 9e4]]
    answer = excel.call("TV_SN_LIFE", [[handle]], [[name]], stresses, MISSING)
    assert in_bits(answer) == as_excel_gets(call("TV_SN_LIFE", [handle, name, stresses]))
    assert answer[0][1] == ""
    assert len(answer) == 2


@example_count(60)
@given(
    st.lists(
        st.lists(st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False)), min_size=3, max_size=3),
        min_size=1,
        max_size=4,
    ).filter(lambda rows: all(v is None or abs(v) < 1e300 for row in rows for v in row))
)  # fmt: skip
def test_any_doubles_come_through_bit_for_bit(excel, values):
    answer = excel.call("TV_CONVERT", values, [["kg*m^2"]], [["lb*ft^2"]])
    assert in_bits(answer) == as_excel_gets(call("TV_CONVERT", [values, "kg*m^2", "lb*ft^2"]))


def test_typed_arguments_and_ranges_of_one_cell_are_the_same(excel):
    ranged = excel.call("TV_STIFFNESS", [[200.0]], [[50.0]], [[500.0]], [[79300.0]], [["SI"]])
    assert ranged == excel.call("TV_STIFFNESS", 200.0, 50.0, 500.0, 79300.0, "SI")
    assert bits(ranged) == bits(call("TV_STIFFNESS", [200.0, 50.0, 500.0, 79300.0])[0][0])


@pytest.mark.parametrize("bore", [MISSING, None, [[None]], [[""]]])
def test_a_bore_left_out_or_blank_is_a_solid_shaft(excel, bore):
    answer = excel.call("TV_STIFFNESS", [[200.0]], bore, [[500.0]], [[79300.0]], MISSING)
    assert bits(answer) == bits(call("TV_STIFFNESS", [200.0, None, 500.0, 79300.0])[0][0])


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize("code", sorted(ERRORS))
def test_an_error_cell_is_named_and_never_a_blank(excel, code):
    bore = [[ERRORS[code]]]
    answer = excel.call("TV_STIFFNESS", [[200.0]], bore, [[500.0]], [[79300.0]], MISSING)
    assert answer == f"ID: the cell shows {code}. Correct it."


def test_an_error_cell_in_a_range_is_named_with_row_and_column(excel):
    values = [[1.0, 2.0], [3.0, ERRORS["#N/A"]]]
    answer = excel.call("TV_CONVERT", values, "m", "mm")
    assert answer == "Value, row 2, column 2: the cell shows #N/A. Correct it."


def test_an_error_cell_in_a_table_stops_the_model(excel):
    arguments = model_arguments()
    stations = [list(row) for row in arguments[0]]
    inertia = stations[1].index("Inertia")
    stations[2][inertia] = ERRORS["#DIV/0!"]
    answer = excel.call("TV_MODEL", stations, *arguments[1:])
    assert "#DIV/0!" in answer
    assert "Stations, row 1, Inertia" in answer


def test_a_date_is_no_number(excel):
    answer = excel.call("TV_CONVERT", [[dt.datetime(2026, 3, 4)]], "m", "mm")
    assert answer.startswith("Value: found 'date 2026-03-04T00:00:00")


def test_a_blank_never_becomes_zero(excel):
    answer = excel.call("TV_STIFFNESS", [[None]], MISSING, [[500.0]], [[79300.0]], MISSING)
    assert answer == "OD is blank. Give the outer diameter [mm or in]."
    assert excel.call("TV_CONVERT", [[None, 1.0]], "m", "mm") == ["", 1000.0]


def test_a_sentence_is_text_since_classic_functions_return_no_error_values(excel):
    answer = excel.call("TV_FREQUENCIES", [["tv:0000000000000000-SI"]], MISSING, MISSING)
    assert isinstance(answer, str)
    assert answer


def test_a_fault_of_ours_is_a_sentence_and_not_a_traceback(excel, monkeypatch):
    def fails(*_):
        raise ZeroDivisionError("made up")

    monkeypatch.setattr(excel.module, "call", fails)
    answer = excel.call("TV_CONVERT", 1.0, "m", "mm")
    assert answer.startswith("TV_CONVERT failed inside torsionbook (ZeroDivisionError: made up).")
    assert "\n" not in answer
