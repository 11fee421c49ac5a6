"""What people mistype, and what they are told."""

from __future__ import annotations

import json
import os

import pytest
from batch_helpers import make_train
from command_line import torsionbook
from typer.testing import CliRunner

from addin.batch.folder import OWN
from addin.batch.inputs import Input, InputsRefused, check_places, find_inputs
from addin.batch.own_files import holds_results, is_result_json, is_summary, is_summary_csv
from addin.batch.summary import write_summary
from addin.cli.app import app

RUN = CliRunner()


def told(*words: object) -> tuple[int, str]:
    """Exit status and everything said, in one line."""
    done = RUN.invoke(app, [str(word) for word in words], env={"COLUMNS": "200"})
    return done.exit_code, " ".join(done.output.replace("│", " ").split())


def test_a_folder_that_is_not_there(tmp_path):
    status, said = told("batch", tmp_path / "nowhere", "--out", tmp_path / "out")
    assert status == 1
    assert said == f"There is no file or folder {tmp_path / 'nowhere'}. Check the path."
    assert not (tmp_path / "out").exists()


def test_results_into_the_folder_of_the_inputs(tmp_path):
    make_train(tmp_path / "in" / "a.xlsx")
    for what in (tmp_path / "in", tmp_path / "in" / "a.xlsx"):
        status, said = told("batch", what, "--out", tmp_path / "in")
        assert status == 1
        assert f"is in {tmp_path / 'in'}, the results folder" in said
        assert "--out" in said


def test_a_file_where_a_folder_is_meant(tmp_path):
    book = make_train(tmp_path / "a.xlsx")
    status, said = told("batch", book, "--out", make_train(tmp_path / "b.xlsx"))
    assert status == 1
    assert said == f"{tmp_path / 'b.xlsx'} is a file; --out must name a folder."
    status, said = told("verify", tmp_path)
    assert status == 1
    assert "is a folder, not a workbook. Name the workbooks in it, such as " in said
    assert "*.xlsx; torsionbook batch " in said


def test_the_summary_of_an_earlier_batch_is_no_input(tmp_path):
    make_train(tmp_path / "in" / "a.xlsx")
    make_train(tmp_path / "in" / "summary.xlsx")  # the engineer's own
    assert len(find_inputs([str(tmp_path / "in")], tmp_path / "out")) == 2
    (tmp_path / "in" / OWN).mkdir()
    found = find_inputs([str(tmp_path / "in")], tmp_path / "out")
    assert [one.name for one in found] == ["a.xlsx"]
    named = find_inputs([str(tmp_path / "in" / "summary.xlsx")], tmp_path / "out")
    assert [one.name for one in named] == ["summary.xlsx"]


@pytest.mark.slow
def test_one_file_is_no_files_and_odd_names_are_kept(tmp_path):
    make_train(tmp_path / "Züge – neu" / "-Zug 1 (Müller).xlsx")
    done = torsionbook("batch", "Züge – neu", "--out", "Ergebnis", "--jobs", 1, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("1 file in ")
    assert (tmp_path / "Ergebnis" / "-Zug 1 (Müller).xlsx").is_file()


@pytest.mark.slow
def test_a_table_that_is_none_and_a_decimal_comma(tmp_path):
    book = make_train(tmp_path / "a.xlsx")
    table = tmp_path / "t.csv"
    words = ("batch", book, "--vary", table, "--out", tmp_path / "out", "--jobs", 1)
    status, said = told(*words)
    assert status == 1
    assert said == f"{table}: it cannot be read: No such file or directory. Check the file."
    table.write_bytes(b"%PDF-1.7\n\xff\xfe\xfa")
    assert "not UTF-8 text. Save the CSV as CSV UTF-8" in told(*words)[1]
    table.write_text('Name,DampingRatio [%]\na,"1,5"\n', encoding="utf-8")
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 1
    assert (
        "found '1,5'; a number in %, or one with its unit such as \"1 %\" is needed. Use a decimal"
        in (done.stderr)
    )


def test_vary_names_the_files_it_found(tmp_path):
    for name in "abcd":
        make_train(tmp_path / "in" / f"{name}.xlsx")
    (tmp_path / "t.csv").write_text("DampingRatio\n0.01\n")
    words = ("batch", tmp_path / "in", "--vary", tmp_path / "t.csv", "--out", tmp_path / "out")
    status, said = told(*words)
    assert status == 2
    assert "4 files are named (a.xlsx, b.xlsx, c.xlsx, ...)" in said


def test_two_verifications_into_one_file_are_refused(tmp_path):
    files = [make_train(tmp_path / name / "train.xlsx") for name in ("rev0", "rev1")]
    status, said = told("verify", *files, "--json", tmp_path / "j")
    assert status == 2
    assert "would both be written to" in said
    assert not (tmp_path / "j").exists()


def test_a_pattern_that_finds_nothing(tmp_path):
    with pytest.raises(InputsRefused, match=r"No file matches .*xslx"):
        find_inputs([str(tmp_path / "*.xslx")], tmp_path / "out")


def test_a_json_on_top_of_what_is_verified_is_refused(tmp_path):
    book = make_train(tmp_path / "a.xlsx")
    before = book.read_bytes()
    status, said = told("verify", book, "--json", book)
    assert status == 2
    assert "is one of the inputs" in said
    assert book.read_bytes() == before


@pytest.mark.slow
def test_a_summary_replaces_a_summary_and_nothing_else(tmp_path):
    mine = make_train(tmp_path / "mine.xlsx")
    before = mine.read_bytes()
    book = make_train(tmp_path / "in" / "a.xlsx")
    words = ("batch", book, "--out", tmp_path / "out", "--jobs", 1)
    status, said = told(*words, "--summary", mine)
    assert status == 2
    assert "is not a batch summary" in said
    assert mine.read_bytes() == before
    for _ in range(2):
        done = torsionbook(*words, "--summary", "all.xlsx", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert " 1 × fail, 2 not judged\n" in done.stdout


def test_errors_of_an_input_as_json_are_no_case(tmp_path):
    (tmp_path / "a.json").write_text('{"format": 1, "poles": 4}', encoding="utf-8")
    told("recalc", tmp_path / "a.json", "--json", tmp_path / "errors.json")
    status, said = told("recalc", tmp_path / "errors.json")
    assert status == 1
    assert "1 error" in said
    assert "this is a result JSON, which contains no inputs" in said


def refused(*words: object) -> str:
    """What is said where nothing is begun: wrong usage, and no folder of results is made."""
    status, said = told("batch", *words)
    assert status == 2, said
    return said


def test_a_json_on_top_of_an_input_is_refused(tmp_path):
    book = make_train(tmp_path / "t" / "a.xlsx")
    case = tmp_path / "t" / "a.results.json"
    case.write_text('{"format": 1}', encoding="utf-8")
    said = refused(book, case, "--out", tmp_path / "o", "--json", tmp_path / "t")
    assert f"would overwrite the input {case}" in said
    assert "with --json" in said
    assert case.read_text(encoding="utf-8") == '{"format": 1}'
    assert not (tmp_path / "o").exists()


FOREIGN = (
    '{"format": 1, "results": [1, 2]}',
    '{"format": 1, "version": 2, "warnings": []}',
    "[1, 2]",
    "my notes",
    "",
)


@pytest.mark.parametrize("text", FOREIGN)
def test_a_json_of_somebody_else_is_not_replaced(tmp_path, text):
    book = make_train(tmp_path / "t" / "a.xlsx")
    (tmp_path / "t" / "c.json").write_text('{"format": 1}', encoding="utf-8")
    for name, words in (
        ("j/a.results.json", (book, "--json", tmp_path / "j")),
        ("o/c.results.json", (tmp_path / "t" / "c.json",)),
    ):
        mine = tmp_path / name
        mine.parent.mkdir()
        mine.write_text(text, encoding="utf-8")
        said = refused(*words, "--out", tmp_path / "o")
        assert f"{mine} exists and was not written by torsionbook" in said
        assert mine.read_text(encoding="utf-8") == text
        mine.unlink()
        mine.parent.rmdir()


def test_results_and_errors_that_torsionbook_wrote_are_told_from_other_json(tmp_path):
    case = tmp_path / "c.json"
    case.write_text('{"format": 1, "poles": 4}', encoding="utf-8")
    told("recalc", case, "--json", tmp_path / "errors.json")
    told("export", make_train(tmp_path / "a.xlsx"), tmp_path / "a.json")
    told("recalc", tmp_path / "a.json", "--json", tmp_path / "results.json")
    for name in ("errors", "results"):
        path = tmp_path / f"{name}.json"
        for _ in range(2):
            assert is_result_json(path)
            assert holds_results(path) == (name == "results")
            # as another program saves it: in another order, on one line
            content = json.loads(path.read_text(encoding="utf-8"))
            path.write_text(json.dumps(dict(sorted(content.items()))), encoding="utf-8")
    assert not is_result_json(case)
    assert not is_result_json(tmp_path / "a.json")


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_results_through_a_link_onto_the_inputs_are_refused(tmp_path):
    book = make_train(tmp_path / "in" / "sub" / "a.xlsx")
    (tmp_path / "o").mkdir()
    (tmp_path / "o" / "sub").symlink_to(tmp_path / "in" / "sub")
    before = book.read_bytes()
    said = refused(tmp_path / "in", "--out", tmp_path / "o", "--jobs", 1)
    assert "would overwrite the input" in said
    assert "with --out" in said
    assert book.read_bytes() == before


def test_capitals_count_only_where_the_disk_tells_them_apart(tmp_path):
    first, other = make_train(tmp_path / "a.xlsx"), tmp_path / "A.results.json"
    other.write_text('{"format": 1}', encoding="utf-8")
    inputs = [Input(first, "a.xlsx"), Input(other, "A.results.json")]
    if (tmp_path / "a.results.json").exists():
        with pytest.raises(InputsRefused, match="would overwrite the input"):
            check_places(inputs, tmp_path / "o", tmp_path)
    else:
        check_places(inputs, tmp_path / "o", tmp_path)
        (tmp_path / "a.results.json").hardlink_to(other)  # as on a disk that does not
        with pytest.raises(InputsRefused, match="would overwrite the input"):
            check_places(inputs, tmp_path / "o", tmp_path)


@pytest.mark.slow
def test_an_input_called_summary_and_the_summary_are_told_apart(tmp_path):
    make_train(tmp_path / "in" / "summary.xlsx")
    out = tmp_path / "o"
    said = refused(tmp_path / "in", "--out", out)
    assert f"would both be written to {out / 'summary.xlsx'}" in said
    assert "Name another place for the summary with --summary." in said
    assert not out.exists()
    words = ("batch", "in", "--out", "o", "--summary", "all.xlsx", "--jobs", 1)
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert is_summary(tmp_path / "all.xlsx")
    assert not is_summary(out / "summary.xlsx")


def test_a_summary_on_any_result_is_refused(tmp_path):
    make_train(tmp_path / "in" / "sub" / "A.xlsx")
    out = tmp_path / "o"
    for place in (out / "sub" / "A.xlsx", out / "sub" / "a.XLSX"):
        said = refused(tmp_path / "in", "--out", out, "--summary", place)
        assert "and the summary of the batch would both be written to" in said
    assert not out.exists()


def test_a_csv_of_somebody_else_is_not_replaced_by_that_of_the_summary(tmp_path):
    book = make_train(tmp_path / "in" / "a.xlsx")
    mine = tmp_path / "mine.csv"
    mine.write_text("Name;DampingRatio\na;0,01\n", encoding="utf-8")
    words = (book, "--out", tmp_path / "o", "--jobs", 1, "--summary", tmp_path / "mine.xlsx")
    assert f"{mine} exists and is not a batch summary." in refused(*words)
    assert mine.read_text(encoding="utf-8") == "Name;DampingRatio\na;0,01\n"
    assert not (tmp_path / "mine.xlsx").exists()
    mine.unlink()
    write_summary(tmp_path / "mine.xlsx", [], "nothing")
    assert is_summary_csv(mine)
    mine.write_bytes(mine.read_bytes().replace(b",", b";"))  # as a spreadsheet program saves it
    assert is_summary_csv(mine)


def test_a_programme_onto_its_own_table_is_refused(tmp_path):
    pytest.importorskip("pyarrow")
    book, table = make_train(tmp_path / "a.xlsx"), tmp_path / "o" / "results.parquet"
    table.parent.mkdir()
    table.write_bytes(b"mine")
    said = refused(book, "--vary", table, "--out", tmp_path / "o")
    assert "Results would overwrite the table" in said
    assert table.read_bytes() == b"mine"
