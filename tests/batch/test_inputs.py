"""Which files a batch takes, in which order, under which names."""

from pathlib import Path

import pytest

from addin.batch.inputs import InputsRefused, find_inputs, natural_key, result_name, results_of


def put(folder: Path, *names: str, text: str = "x") -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


def names(folder: Path, *patterns: object, out: str = "out") -> list[str]:
    return [one.name for one in find_inputs([str(p) for p in patterns], folder / out)]


def test_a_folder_in_natural_order_with_its_subfolders(tmp_path):
    put(tmp_path, "t10.xlsx", "t9.xlsx", "T1.xlsm", "a/b/c.xlsx")
    assert names(tmp_path, tmp_path) == ["a/b/c.xlsx", "T1.xlsm", "t9.xlsx", "t10.xlsx"]


def test_what_is_passed_over(tmp_path):
    put(tmp_path, "train.xlsx", "~$train.xlsx", "train.out.xlsx", "train.accuracy.xlsx")
    put(tmp_path, "train.xlsx.bak", ".hidden.xlsx", ".git/x.xlsx", "notes.txt", "out/train.xlsx")
    put(tmp_path, "train.results.json", ".~lock.train.xlsx#")
    put(tmp_path, "package.json", text='{"name": "no case"}')
    put(tmp_path, "result.json", text='{"format": 1, "errors": []}')
    put(tmp_path, "difference.json", text='{"format": 1, "a": {}, "same_inputs": 5}')
    put(tmp_path, "case.json", text='{"format": 1}')
    assert names(tmp_path, tmp_path) == ["case.json", "train.xlsx"]


def test_what_cannot_be_calculated_is_not_passed_over(tmp_path):
    put(tmp_path, "old.xls", "binary.xlsb", "broken.json", text="{")
    assert names(tmp_path, tmp_path) == ["binary.xlsb", "broken.json", "old.xls"]


def test_patterns_keep_what_is_below_their_fixed_part(tmp_path):
    put(tmp_path, "u/1/a.xlsx", "u/2/b.xlsx", "u/2/b.out.xlsx")
    assert names(tmp_path, tmp_path / "u" / "**" / "*.xlsx") == ["1/a.xlsx", "2/b.xlsx"]
    assert names(tmp_path, tmp_path / "u" / "2" / "*.xlsx") == ["b.xlsx"]


def test_a_named_file_is_taken_whatever_its_name_and_each_file_once(tmp_path):
    put(tmp_path, "a.out.xlsx", "b.xlsx")
    asked = (tmp_path / "a.out.xlsx", tmp_path / "b.xlsx", tmp_path / "*.xlsx", tmp_path)
    assert names(tmp_path, *asked) == ["a.out.xlsx", "b.xlsx"]


def test_a_name_with_brackets_that_exists_is_no_pattern(tmp_path):
    put(tmp_path, "train [2].xlsx")
    assert names(tmp_path, tmp_path / "train [2].xlsx") == ["train [2].xlsx"]


def test_a_named_file_that_is_not_there_is_kept_for_its_outcome(tmp_path):
    assert names(tmp_path, tmp_path / "gone.xlsx") == ["gone.xlsx"]


def test_equal_names_of_two_folders_are_told_apart_by_their_folders(tmp_path):
    put(tmp_path, "north/train.xlsx", "south/train.xlsx")
    found = names(tmp_path, tmp_path / "north", tmp_path / "south")
    assert found == ["north/train.xlsx", "south/train.xlsx"]


def test_two_files_with_one_result_are_refused(tmp_path):
    put(tmp_path, "x.json", text='{"format": 1}')
    put(tmp_path, "x.results.JSON", text='{"format": 1}')
    (tmp_path / "x.results.JSON").replace(tmp_path / "X.json")
    if len(list(tmp_path.iterdir())) == 1:
        pytest.skip("this disk does not tell capitals apart")  # then nothing can clash
    with pytest.raises(InputsRefused, match="would both be written to"):
        names(tmp_path, tmp_path)


def test_each_input_has_a_history_of_its_own_and_the_usual_name_where_nobody_else_has_it(tmp_path):
    put(tmp_path, "a.xlsx", "A.xlsm", "b.xlsx", "a.xlsx.xlsx", "sub/a.xlsx", "c.results.xlsx")
    put(tmp_path, "c.json", text='{"format": 1}')
    found = find_inputs([str(tmp_path)], tmp_path / "out")
    parquet = {one.name: results_of(one)[1] for one in found}
    assert parquet == {
        "a.xlsx": "a.xlsx.history.parquet",
        "A.xlsm": "A.xlsm.history.parquet",
        "a.xlsx.xlsx": "a.xlsx.xlsx.history.parquet",
        "b.xlsx": "b.history.parquet",
        "c.json": "c.results.json.history.parquet",
        "c.results.xlsx": "c.results.xlsx.history.parquet",
        "sub/a.xlsx": "sub/a.history.parquet",
    }


@pytest.mark.parametrize("what", ["nothing/*.xlsx", "empty"])
def test_nothing_found_is_said(tmp_path, what):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputsRefused, match=what.split("/")[0]):
        names(tmp_path, tmp_path / what)


def test_results_are_named_like_those_of_recalc():
    assert result_name("a/train.xlsm") == "a/train.xlsm"
    assert result_name("a/case.json") == "a/case.results.json"


def test_numbers_count_in_the_order():
    order = ["a2b10", "a2b9", "a10", "2", "B1"]
    assert sorted(order, key=natural_key) == ["2", "a2b9", "a2b10", "a10", "B1"]
