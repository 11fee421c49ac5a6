"""A share of the fuzzing of benchmarks/workbook_fuzz.py: a small one always, a larger one in CI."""

from pathlib import Path

import openpyxl
import pytest

from addin.reading.workbook import read_workbook
from benchmarks import workbook_fuzz
from benchmarks.workbook_fuzz import (
    LEVELS,
    ROOT,
    fuzz,
    mutated,
    seeds,
    sentence_fault,
    verdict_on,
)

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")


def test_the_workbooks_calculate_before_they_are_spoiled(tmp_path: Path) -> None:
    for seed in seeds():
        assert verdict_on(seed.data, seed.suffix, tmp_path).kind == "written", seed.name


def test_a_number_always_makes_the_same_file() -> None:
    seeds.cache_clear()
    first = [mutated(number)[2] for number in range(6)]
    seeds.cache_clear()
    assert [mutated(number)[2] for number in range(6)] == first
    assert mutated(0, run=2)[2] != first[0]


def test_most_files_are_spoiled() -> None:
    """Otherwise nothing would be tried; a cut of nothing or the same text again may happen."""
    files = [mutated(number) for number in range(60)]
    assert sum(data != seed.data for seed, _, data in files) > 55
    assert {level for _, level, _ in files} == {level for level, _ in LEVELS}


@pytest.mark.slow
def test_the_judge_sees_faults(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each demand, broken on purpose, is noticed."""
    import time

    from addin.writing import recalculate as recalc
    from addin.xlsx import save

    data = seeds()[0].data
    real = recalc._write_workbook

    def crash(*_: object) -> None:
        raise KeyError("xl/none.xml")

    def hang(*_: object) -> None:
        time.sleep(60)

    def half_written(source, destination, *rest):  # type: ignore[no-untyped-def]
        destination.with_name(".~half.tmp").write_bytes(b"PK")
        return real(source, destination, *rest)

    def torn(source, destination, *rest):  # type: ignore[no-untyped-def]
        notes = real(source, destination, *rest)
        destination.write_bytes(destination.read_bytes()[:-500])
        return notes

    def mumbling(*_: object) -> tuple[str, ...]:
        raise save.SaveRefused("KeyError('xl/none.xml')")

    for spoil, kind, words in (
        (crash, "crash", "KeyError"),
        (hang, "hang", "longer than"),
        (half_written, "fault", "half.tmp"),
        (torn, "fault", "does not open"),
        (mumbling, "fault", "message"),
    ):
        monkeypatch.setattr(recalc, "_write_workbook", spoil)
        found = verdict_on(data, ".xlsx", tmp_path, patience=5.0 if kind == "hang" else 60.0)
        assert found.kind == kind
        assert words in found.fault
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_what_openpyxl_cannot_open_it_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It makes an object of each of the 17 thousand million cells of a merged range."""
    monkeypatch.setattr(workbook_fuzz, "OPENPYXL_MEMORY", 50 * 2**20)
    parts = dict(seeds()[0].parts)
    sheet = parts["xl/worksheets/sheet4.xml"]
    whole = sheet.replace(b'ref="A6:C6"', b'ref="A1:XFD1048576"')
    assert whole != sheet
    path = tmp_path / "merged.xlsx"
    path.write_bytes(
        workbook_fuzz._packed([*(parts | {"xl/worksheets/sheet4.xml": whole}).items()])
    )
    assert workbook_fuzz._openpyxl_says(path).startswith("MemoryError")
    folder = tmp_path / "judged"
    folder.mkdir()
    assert verdict_on(path.read_bytes(), ".xlsx", folder).kind == "written"
    path.write_bytes(seeds()[0].data)
    assert workbook_fuzz._openpyxl_says(path) == ""


@pytest.mark.parametrize(
    "text",
    [
        "",
        "KeyError: 'a'.",
        "a",
        "something\x1b[2J.",
        "no full stop",
        "x " * 2000 + ".",
        "b'PK' is not one.",
    ],
)
def test_what_is_no_sentence(text: str) -> None:
    assert sentence_fault(text)


def told(numbers: range) -> None:
    block = fuzz(numbers.start, len(numbers))
    assert block.faults == []
    kinds = {key.partition(": ")[2] for key in block.tally}
    assert kinds == {"refused", "wrong input", "written"}


@pytest.mark.slow
def test_some_files() -> None:
    told(range(700, 760))


@pytest.mark.slow
@pytest.mark.parametrize(
    "start",
    [20_000, *(pytest.param(n, marks=pytest.mark.long) for n in range(20_300, 21_500, 300))],
)
def test_more_files(start: int) -> None:
    """Beyond the kept record, which ends with number 19,999: files that no repair was made after but two."""
    told(range(start, start + 300))


def test_the_summary_is_fitted_without_a_column_of_the_audit(tmp_path: Path) -> None:
    """Found by number 10580 of run 2: the column was renamed, and with it went the texts of the notes."""
    template = seeds()[2]
    (table,) = (n for n, part in template.parts.items() if b'displayName="Audit"' in part)
    renamed = template.parts[table].replace(b'name="Value"', b'name="Worth"')
    assert renamed != template.parts[table]
    data = workbook_fuzz._packed([*(template.parts | {table: renamed}).items()])
    assert verdict_on(data, template.suffix, tmp_path).kind == "written"


def test_a_long_template_version_is_told_in_a_short_sentence(tmp_path: Path) -> None:
    """Found by number 28362 of run 2."""
    book = openpyxl.load_workbook(ROOT / "templates" / "blank_si.xlsx")
    ((sheet, cell),) = book.defined_names["TemplateVersion"].destinations
    book[sheet][cell.replace("$", "")].value = "x" * 30_000
    book.save(tmp_path / "train.xlsx")
    (told,) = (w for w in read_workbook(tmp_path / "train.xlsx").warnings if "version" in w)
    assert sentence_fault(told) == ""
    assert len(told) < 300
