"""Which rows of long result tables are printed, and in which workbooks they stand first."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import openpyxl

from addin.contract.shipped import template_path
from addin.writing.printed_rows import printed_rows
from addin.writing.recalculate import recalculate
from engine.case.result_words import Judgement

OLD = Path(__file__).parents[1] / "verify" / "release_0_1_0" / "train.xlsx"
PASS, FAIL = Judgement.PASS, Judgement.FAIL


def mode(number: int, frequency: float, percent_speed: float | None = None) -> dict:
    return {"mode": number, "frequency": frequency, "percent_speed": percent_speed}


def margin(number: int, verdict: Judgement = PASS) -> dict:
    return {"mode": number, "excitation_frequency": 120.0, "verdict": verdict}


def response(element: str, torque: float, verdict: Judgement = PASS) -> dict:
    return {"element": element, "torque": torque, "verdict": verdict}


def counts(modes: list[dict], margins: list[dict]) -> tuple[int, int, str]:
    printed = printed_rows({"NaturalFrequencies": modes, "SeparationMargins": margins})
    return (
        printed.counts["NaturalFrequencies"],
        printed.counts["SeparationMargins"],
        printed.on_modes,
    )


def test_modes_up_to_twice_the_highest_excitation() -> None:
    modes = [mode(0, 0.0), mode(1, 50.0), mode(2, 240.0), mode(3, 240.1), mode(4, 900.0)]
    margins = [margin(k) for k in (1, 2, 3, 4)]
    few_modes, few_margins, words = counts(modes, margins)
    assert (few_modes, few_margins) == (3, 2)
    assert "2 higher modes with 2 margins" in words


def test_a_mode_with_a_margin_that_fails_or_that_the_start_crosses_is_printed() -> None:
    modes = [mode(1, 50.0), mode(2, 500.0), mode(3, 900.0)]
    failed = [margin(1), margin(2, FAIL), margin(3)]
    assert counts(modes, failed)[:2] == (2, 2)
    modes[2] = mode(3, 900.0, 12.0)
    assert counts(modes, failed) == (3, 3, "")


def test_without_excitations_every_mode_is_printed() -> None:
    assert counts([mode(1, 50.0), mode(2, 5000.0)], []) == (2, 0, "")


def test_the_largest_response_of_each_element_and_those_over_their_limit() -> None:
    rows = [
        response("A", 1.0), response("A", 3.0), response("A", 2.0, FAIL),
        response("B", 5.0, Judgement.NOT_JUDGED), response("B", 4.0, Judgement.NOT_JUDGED),
    ]  # fmt: skip
    printed = printed_rows({"SteadyState": rows})
    assert printed.counts["SteadyState"] == 3
    assert [row["torque"] for row in printed.response] == [3.0, 2.0, 5.0, 1.0, 4.0]
    assert "2 others stand below" in printed.on_response


def responses(source: Path, folder: Path) -> tuple[list, list]:
    """Element, excitation and mode of each response in workbook and JSON."""
    path = shutil.copyfile(source, folder / "train.xlsx")
    recalculate(path, destination=folder / "out.xlsx", json_file=folder / "out.json")
    rows = json.loads((folder / "out.json").read_text(encoding="utf-8"))["steady_state"]
    book = openpyxl.load_workbook(folder / "out.xlsx", data_only=True)
    sheet = next(one for one in book.worksheets if "SteadyState" in one.tables)
    cells = [[cell.value for cell in row[:3]] for row in sheet[sheet.tables["SteadyState"].ref][1:]]
    return cells, [[row["element"], row["excitation"], row.get("mode")] for row in rows]


def test_they_stand_first_in_a_workbook_of_this_version(tmp_path: Path) -> None:
    shown, every = responses(template_path("example_proposed.xlsx"), tmp_path)
    assert shown != every
    assert sorted(map(str, shown)) == sorted(map(str, every))


def test_a_workbook_of_the_first_release_has_them_in_the_order_of_the_json(tmp_path: Path) -> None:
    shown, every = responses(OLD, tmp_path)
    assert shown == every
