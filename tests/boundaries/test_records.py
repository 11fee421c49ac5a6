"""A column, an effect, a study and a function are one record each; what a record lacks is said."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from addin.contract.field import IncompleteRecord, complete, number, sentence, table
from addin.contract.records import find_records
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import StudySpec
from addin.contract.tables import RESULT_TABLES
from addin.contract.tables import table as table_of

ROOT = Path(__file__).resolve().parents[2]
WHERE = "addin/contract/result_tables.py"


@pytest.mark.slow
@pytest.mark.parametrize("patch", ["column", "function", "effect", "study"])
def test_a_new_one_is_added_in_one_place(patch):
    subprocess.run([sys.executable, ROOT / "scripts" / "prove_records.py", patch], check=True)


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
        for row in tables.get(spec.name, ()):
            extra = {key for key in row if key not in known}
            if spec.repeated is not None:
                extra = {key for key in extra if not key.startswith(spec.repeated.key)}
            assert not extra, (spec.name, extra)
            if not spec.json_only and spec.repeated is None:
                assert {field.key for field in spec.columns} <= set(row), spec.name
