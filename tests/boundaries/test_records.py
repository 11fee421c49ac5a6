"""A column, an effect, a study and a function are one record each; what a record lacks is said."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from addin.contract.field import IncompleteRecord, complete, number, sentence, table
from addin.contract.records import find_records
from addin.contract.sheet import ChartAt
from addin.contract.studies.registry import EVERY_CHART, STUDIES
from addin.contract.study_spec import StudySpec
from addin.contract.tables import RESULT_TABLES
from addin.contract.tables import table as table_of
from addin.reference.record_checks import check_chart, check_records, check_sheets, check_traces
from addin.studies.registry import study_of, study_of_command
from addin.studies.run_study import check_tables
from addin.studies.study import StudyResult
from addin.worksheet import registry

ROOT = Path(__file__).resolve().parents[2]
WHERE = "addin/contract/result_tables.py"


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("study", "--no-tests"),
        *(
            pytest.param((p,), marks=pytest.mark.long)
            for p in ("study", "column", "function", "effect")
        ),
    ],
)
def test_a_new_one_is_added_in_one_place(words):
    subprocess.run([sys.executable, ROOT / "scripts" / "prove_records.py", *words], check=True)


def refusal(spec, *, results=True):
    with pytest.raises(IncompleteRecord) as refused:
        complete([spec], WHERE, results=results)
    return str(refused.value)


def test_an_incomplete_table_says_what_is_missing_and_where():
    peaks = table_of("StartupPeaks")
    bare = replace(peaks, columns=(*peaks.columns, number("Mean", "torque", "Mean torque.")))
    assert refusal(bare).startswith(
        f"column Mean of table StartupPeaks has no equation and source: add them in {WHERE}"
    )
    assert refusal(replace(peaks, caption="")) == (
        f"table StartupPeaks has no caption: add one in {WHERE}"
    )
    assert "has no column Middle, which its changes_shown names" in refusal(
        replace(peaks, changes_shown=("Middle",))
    )
    assert "has two columns Element: rename one" in refusal(
        replace(peaks, columns=(*peaks.columns, peaks.columns[0]))
    )
    unfilled = sentence("Why", "Why.", "The reason", "docs/method.md")
    assert "extra column Why of table StartupPeaks has no formula: add one" in refusal(
        replace(peaks, extra_columns=(unfilled,))
    )
    blank = table(
        "New", sheet="Case", caption="New", help="New.", columns=[number("X", "count", "")]
    )
    assert refusal(blank, results=False) == (
        f"column X of table New has no help text: add one in {WHERE}"
    )


def test_a_dimension_that_is_none_is_named():
    with pytest.raises(IncompleteRecord, match="column Mean has the unknown dimension 'torqe'"):
        number("Mean", "torqe", "Mean torque.")


def test_an_incomplete_study_says_what_is_missing_and_where():
    tuning = STUDIES[0]

    def told(**changes):
        with pytest.raises(IncompleteRecord) as refused:
            replace(tuning, **changes).complete("addin/contract/studies/tuning.py")
        return str(refused.value)

    assert told(sheets=tuning.sheets[1:]) == (
        "table Tuning has no cell on sheet Tuning of study tuning: add its cell to the tables of that "
        "sheet in addin/contract/studies/tuning.py"
    )
    assert "study tuning has no sheet Elsewhere: add one" in told(sheet="Elsewhere")
    bare = (replace(tuning.sheets[0], intro=""), *tuning.sheets[1:])
    assert "sheet Tuning of study tuning has no introduction: add one" in told(sheets=bare)


def test_a_file_without_a_record_is_named(tmp_path, monkeypatch):
    package = tmp_path / "some_records"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "empty.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(IncompleteRecord, match="some_records/empty.py defines 0 records StudySpec"):
        find_records("some_records", StudySpec)


def test_rows_of_the_engine_have_the_keys_of_the_columns():
    """What a table's function gives and what its record describes are the same."""
    from engine.results.tables import result_tables
    from engine.run import run
    from tests.sample_case import sample_case

    tables = result_tables(run(sample_case("proposed")))
    for spec in RESULT_TABLES:
        known = {field.key for field in (*spec.columns, *spec.json_only)}
        rows = tables.get(spec.name, ())
        lacking = {field.key for field in spec.columns} - set().union(*rows)
        assert not lacking or not rows, (
            f"rows of {spec.name} in engine/results/tables.py: {lacking}"
        )
        for row in tables.get(spec.name, ()):
            extra = {key for key in row if key not in known}
            if spec.repeated is not None:
                extra = {key for key in extra if not key.startswith(spec.repeated.key)}
            assert not extra, (spec.name, extra)
            if not spec.json_only and spec.repeated is None:
                assert {field.key for field in spec.columns} <= set(row), spec.name


def told_by(check, *arguments):
    with pytest.raises(IncompleteRecord) as refused:
        check(*arguments)
    return str(refused.value)


def test_what_a_record_names_is_there():
    """A trace, a chart, a colour, a cell and an input table that no record describes are named."""
    check_records()
    peaks = table_of("StartupPeaks")
    first = peaks.columns[0]
    lost = replace(first, trace=replace(first.trace, of_row=("StartupPeaks.Middle",)))
    assert told_by(check_traces, [replace(peaks, columns=(lost, *peaks.columns[1:]))]).startswith(
        f"column {first.name} of table StartupPeaks is traced to StartupPeaks.Middle, which is no"
    )
    torque = EVERY_CHART["torque"]
    series = torque.series[0]
    columns = {series.table: {name for s in torque.series for name in (s.x, s.y)}}
    assert f"chart torque draws column Middle of table {series.table}" in told_by(
        check_chart, replace(torque, series=(replace(series, y="Middle"),)), columns
    )
    assert "chart torque has the unknown colour 'navvy': choose one of navy" in told_by(
        check_chart, replace(torque, series=(replace(series, colour="navvy"),)), columns
    )
    sheet = STUDIES[0].sheets[0]
    name = next(iter(sheet.tables))
    assert told_by(check_sheets, [replace(sheet, tables={name: "foo"})]) == (
        f"{name} is placed at 'foo' of sheet {sheet.name}: give a cell such as B12"
    )
    chart = ChartAt("nothing", "B3", 100, 100)
    assert f"sheet {sheet.name} shows the chart nothing" in told_by(
        check_sheets, [replace(sheet, charts=(chart,))]
    )


def test_a_study_without_a_calculation_and_two_functions_of_one_name_are_named():
    spec = replace(STUDIES[0], key="nowhere")
    assert told_by(study_of, spec) == (
        "study nowhere has no calculation: add a Study in addin/studies/nowhere.py"
    )
    assert told_by(study_of_command, "nowhere").startswith("command nowhere has no calculation")
    again = registry.FUNCTIONS["TV_MODE"].answer
    assert told_by(registry.registered("TV_MODE"), again).startswith(
        f"two functions are called TV_MODE, {again.__name__} and {again.__name__}: rename one"
    )


def test_a_study_gives_the_tables_of_its_record():
    study = study_of(STUDIES[0])
    lacking = StudyResult(None, {}, "", "")
    assert told_by(check_tables, study, lacking).startswith(
        f"study {study.spec.key} does not give the table "
    )
    tables = {spec.name: [] for spec in study.spec.results}
    check_tables(study, replace(lacking, tables=tables))
    assert "gives the table Foo, which its record does not describe" in told_by(
        check_tables, study, replace(lacking, tables=tables | {"Foo": []})
    )
