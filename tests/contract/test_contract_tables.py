"""The table of fields against the contract, the engine's case and itself."""

import subprocess
import sys
from dataclasses import fields as attributes
from pathlib import Path

import pytest

from addin.contract.tables import (
    DIMENSIONS,
    INPUT_TABLES,
    RESULT_TABLES,
    SCALARS,
    input_table,
    json_key,
    result_table,
    scalar,
)
from engine.case.data import TABLES, CaseData

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = [column for table in (*INPUT_TABLES, *RESULT_TABLES) for column in table.columns]


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("LineFrequency", "line_frequency"),
        ("Speed ratio", "speed_ratio"),
        ("SNPoints", "sn_points"),
        ("OD", "od"),
        ("SCF", "scf"),
        ("CPM", "cpm"),
        ("RatedPower", "rated_power"),
        ("From", "from"),
        ("Of station", "of_station"),
        ("Peak-to-peak torque", "peak_to_peak_torque"),
        ("Zero-to-peak stress", "zero_to_peak_stress"),
        ("Mode 12", "mode_12"),
        ("NaturalFrequencies", "natural_frequencies"),
        ("AllowableStarts", "allowable_starts"),
    ],
)
def test_keys_follow_the_rule_of_the_contract(name, key):
    assert json_key(name) == key


def test_every_scalar_and_column_has_its_attribute_in_the_case():
    tables = {key for key, _ in TABLES.values()}
    assert {spec.attribute for spec in SCALARS} == {f.name for f in attributes(CaseData)} - tables
    for table in INPUT_TABLES:
        key, row_class = TABLES[table.name]
        assert table.key == key
        known = {f.name for f in attributes(row_class)} - {"torque_share"}
        assert {column.attribute for column in table.columns} == known


def test_keywords_get_an_underscore():
    assert input_table("Elements").column("From").attribute == "from_"
    assert input_table("Materials").column("Yield").attribute == "yield_"
    assert scalar("RatedPower").attribute == "rated_power"


def test_names_and_keys_are_unique():
    tables = (*INPUT_TABLES, *RESULT_TABLES)
    assert (
        len({spec.name for spec in SCALARS}) == len({spec.key for spec in SCALARS}) == len(SCALARS)
    )
    assert len({table.name for table in tables}) == len(tables)
    for table in tables:
        columns = (*table.columns, *table.extra_columns)
        assert len({column.name for column in columns}) == len(columns)


#: Headers that say more than the key, which does not begin with a digit.
KEYS_OF_OTHER_WORDS = {"2 × slip frequency": "slip_frequency"}


@pytest.mark.parametrize("spec", [*SCALARS, *COLUMNS], ids=lambda spec: spec.name)
def test_a_field_is_complete(spec):
    assert spec.key == KEYS_OF_OTHER_WORDS.get(spec.name, json_key(spec.name))
    assert spec.help.endswith(".")
    assert len(spec.help) < 200
    # a number may have words in its place
    assert (spec.kind == "choice") == (bool(spec.choices) and not spec.is_number)
    assert spec.dimension in DIMENSIONS
    assert spec.has_unit == bool(DIMENSIONS[spec.dimension].si)
    if spec.has_unit:
        assert spec.unit_us in spec.units
        assert spec.unit_si in spec.units
    if not spec.is_number:
        assert spec.dimension == "none"


def test_columns_of_the_contract_in_its_order():
    elements = [column.name for column in input_table("Elements").columns]
    assert elements[:6] == ["Element", "Kind", "From", "To", "Stiffness", "OD"]
    assert elements[-1] == "Vibratory limit"
    starts = [column.key for column in result_table("AllowableStarts").columns]
    assert starts == [
        "element", "damage", "allowable_starts", "paper_count", "error", "governing",
        "left_out", "starts_low", "starts_high", "worst_phase",
    ]  # fmt: skip


def test_repeated_columns():
    column = result_table("ModeShapes").repeated_column(3)
    assert (column.name, column.key) == ("Mode 3", "mode_3")
    with pytest.raises(KeyError):
        result_table("Audit").repeated_column(1)


def test_importing_the_readers_loads_nothing_heavy():
    script = (
        "import sys, addin.reading.case_json, addin.reference.json_schemas, addin.writing.results_json, addin.contract.units\n"
        "print([m for m in ('pint', 'openpyxl', 'lxml', 'numpy', 'scipy', 'cffi') "
        "if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
