"""Chart titles that another spreadsheet program made fixed words of follow the results again."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import openpyxl
import pytest
from made_up_run import SOURCE, STAMP, made_up_run

from addin.writing.workbook import write_results
from addin.xlsx import open_workbook
from tests.opened import opened

_LINKED = re.compile(r"<c:tx><c:strRef><c:f>(ChartData![^<]*)</c:f>.*?</c:tx>(<c:layout/>)?", re.S)
_FORMAT = re.compile(r"<c:txPr>.*?</c:txPr>", re.S)
_TITLE = re.compile(r"<c:title>.*?</c:title>", re.S)


def charts_of(path: Path) -> dict[str, str]:
    with zipfile.ZipFile(path) as archive:
        names = [name for name in archive.namelist() if name.startswith("xl/charts/chart")]
        return {name: archive.read(name).decode() for name in names}


def with_fixed_titles(source: Path, target: Path, words: dict[str, str] | None = None) -> Path:
    """What LibreOffice makes of linked titles: rich text with the words shown, or given ones."""

    def fixed(title: re.Match[str]) -> str:
        found = _LINKED.search(title[0])
        if found is None:
            return title[0]
        shown = re.search(r"<c:v>(.*?)</c:v>", title[0])
        text = (words or {}).get(found[1]) or (shown[1] if shown else "")
        rich = (
            '<c:tx><c:rich><a:bodyPr rot="0"/><a:lstStyle/><a:p><a:pPr><a:defRPr b="1" sz="1000"/>'
            f'</a:pPr><a:r><a:rPr b="1" sz="1000"/><a:t>{text}</a:t></a:r></a:p></c:rich></c:tx>'
        )
        return _FORMAT.sub("", title[0].replace(found[0], rich))

    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            if entry.filename.startswith("xl/charts/chart"):
                data = _TITLE.sub(fixed, data.decode()).encode()
            new.writestr(entry.filename, data)
    return target


def titles_of(chart: str) -> list[str]:
    return _TITLE.findall(chart)


def linked(path: Path) -> dict[str, list[tuple[str, str]]]:
    """Reference and cached text of each linked title, chart by chart."""
    pairs = re.compile(r"<c:f>(ChartData![^<]*)</c:f>.*?<c:v>([^<]*)</c:v>", re.S)
    return {
        name: [found for title in titles_of(chart) for found in pairs.findall(title)]
        for name, chart in charts_of(path).items()
    }


@pytest.mark.slow
def test_titles_that_lost_their_cell_are_linked_again(tmp_path: Path) -> None:
    first = write_results(SOURCE, tmp_path / "first.xlsx", made_up_run(), STAMP).path
    fixed = with_fixed_titles(first, tmp_path / "fixed.xlsx")
    assert not any(linked(fixed).values())
    workbook = open_workbook(fixed)
    workbook.set_name("PlotElement2", "Pinion shaft")
    chosen = tmp_path / "chosen.xlsx"
    workbook.save(chosen)
    again = write_results(chosen, tmp_path / "again.xlsx", made_up_run(), STAMP).path
    found = linked(again)
    assert {k: [f for f, _ in v] for k, v in found.items()} == {
        k: [f for f, _ in v] for k, v in linked(first).items()
    }
    words = [text for pairs in found.values() for _, text in pairs]
    assert "Pinion shaft: nominal shear stress" in words
    assert "S-N line and the cycles of a start: HP compressor shaft" in words
    for chart in charts_of(again).values():
        for title in titles_of(chart):
            assert ("<c:rich>" in title) != ("<c:strRef>" in title)
            assert "<c:strRef>" not in title or 'sz="1000"' in title or 'sz="900"' in title
    openpyxl.load_workbook(again)


def test_titles_in_the_words_of_earlier_versions_are_linked_again(
    written: Path, tmp_path: Path
) -> None:
    shown = {f: text for pairs in linked(written).values() for f, text in pairs}
    earlier = {
        "torque around its minimum in the start": "torque around its least value in the start",
        "teeth separate (torque zero)": "teeth part (torque zero)",
        "forces at minimum torque": "forces at its deepest moment",
    }
    words = {}
    for new, old in earlier.items():
        places = {f: text.replace(new, old) for f, text in shown.items() if new in text}
        assert places, new
        words |= places
    fixed = with_fixed_titles(written, tmp_path / "fixed.xlsx", words)
    again = write_results(fixed, tmp_path / "again.xlsx", made_up_run(), STAMP).path
    assert linked(again) == linked(written)


def test_charts_without_our_titles_stay_as_they_are(written: Path, tmp_path: Path) -> None:
    places = {f for pairs in linked(written).values() for f, _ in pairs}
    own = dict.fromkeys(places, "The words of the engineer")
    fixed = with_fixed_titles(written, tmp_path / "fixed.xlsx", own)
    again = write_results(fixed, tmp_path / "again.xlsx", made_up_run(), STAMP).path
    after = charts_of(again)
    for name, chart in charts_of(fixed).items():
        assert titles_of(after[name]) == titles_of(chart), name


@pytest.mark.slow
def test_a_workbook_saved_by_libreoffice_names_what_it_draws(soffice, tmp_path: Path) -> None:
    first = write_results(SOURCE, tmp_path / "first.xlsx", made_up_run(), STAMP).path
    workbook = open_workbook(soffice.convert(first, "xlsx"))
    workbook.set_name("PlotElement3", "Pinion shaft")
    workbook.save(tmp_path / "chosen.xlsx")
    again = write_results(tmp_path / "chosen.xlsx", tmp_path / "again.xlsx", made_up_run(), STAMP)
    words = [text for pairs in linked(again.path).values() for _, text in pairs]
    assert "Pinion shaft: nominal shear stress" in words
    assert len(words) == sum(len(pairs) for pairs in linked(first).values())
    assert soffice.convert(again.path, "pdf").exists()


def test_the_cell_above_a_history_says_what_is_drawn(written: Path) -> None:
    sheet = opened(written)["Start"]
    words = [str(cell.value) for row in sheet.iter_rows() for cell in row if cell.value]
    assert "Mesh: tangential tooth load [lbf]" in words
    assert "HP compressor shaft: nominal shear stress [psi]" in words
