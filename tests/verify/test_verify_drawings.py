"""Charts that draw other cells or carry other values than they should, and units beside key numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from tampered_package import Package

from addin.contract.sheet import column_letters
from addin.reading.workbook import read_workbook
from addin.verify.chart_sources import compare_copies, compare_drawings
from addin.verify.file import verify_file
from addin.verify.findings import Finding
from addin.verify.key_units import compare_units
from addin.verify.schematic import compare_schematic
from addin.xlsx import Workbook, drawn_charts, open_workbook

_SERIES = re.compile(r"<c:ser>.*?</c:ser>", re.DOTALL)
_VALUES = re.compile(r"(<c:(?:val|yVal)><c:numRef><c:f>)([^<]*)(</c:f>)")
_CATEGORIES = re.compile(r"(<c:(?:cat|xVal)><c:(?:num|str)Ref><c:f>)([^<]*)(</c:f>)")


def found(path: Path) -> list[Finding]:
    """What is said of charts and units."""
    workbook = open_workbook(path, ignore_lock=True)
    return [
        *compare_drawings(workbook, drawn_charts(workbook), same_version=True),
        *compare_copies(workbook, drawn_charts(workbook)),
        *compare_units(workbook, same_version=True),
    ]


def charts(train: Path) -> dict[str, str]:
    """Chart parts of the workbook, and their text."""
    parts = Package(train).parts
    return {n: data.decode() for n, data in parts.items() if n.startswith("xl/charts/chart")}


def edited(train: Path, part: str, how: Callable[[str], str]) -> list[Finding]:
    package = Package(train)
    package.change(part, how)
    return found(package.store(train.with_name("tampered.xlsx")))


def drawn_otherwise(train: Path, how: Callable[[str], str]) -> list[str]:
    """What is said of all charts, each changed in the same way; and how many there are."""
    package = Package(train)
    for part in charts(train):
        package.change(part, how)
    said = [f for f in found(package.store(train.with_name("tampered.xlsx"))) if "draws" in f.sentence]  # fmt: skip
    assert {one.kind for one in said} == {"chart"}
    assert all(one.sheet and one.cell for one in said)
    assert len({(one.sheet, one.cell) for one in said}) == len(charts(train)) > 20
    return [one.sentence for one in said]


def test_what_was_written_is_clean_and_every_chart_is_known(train):
    assert found(train) == []
    # all its values, wherever they stand, from a sheet of words
    drawn_otherwise(train, lambda text: _VALUES.sub(r"\1Notes!$A$5:$A$9\3", text))


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("what", [_VALUES, _CATEGORIES])
@pytest.mark.parametrize("number", [0, -1])
def test_a_series_led_to_other_cells_is_told(train, what, number):
    def other(text):
        one = list(what.finditer(text))[number]
        return f"{text[: one.start(2)]}ChartData!$A$5:$A$9{text[one.end(2) :]}"

    assert all("ChartData!A5:A9" in said for said in drawn_otherwise(train, other))


def test_the_end_of_a_history_cannot_be_cut_off(train):
    workbook = open_workbook(train, ignore_lock=True)
    history = workbook.table("ChartHistory")
    end, cut = f"${history.data.bottom}<", f"${history.data.bottom - 400}<"
    time, torque, _ = columns_of_the_history(train)
    for part, drawn in charts(train).items():
        if f"ChartData!${torque}$5" in drawn:
            said = edited(train, part, lambda text: text.replace(end, cut))
            assert said[0].sheet == "Start"
            rows = f"{torque}5:{torque}{history.data.bottom}"
            assert f"not ChartData!{rows} over ChartData!{time}5" in said[0].sentence


def test_a_series_that_bears_the_name_of_another_is_told(train):
    part = next(
        part
        for part, drawn in charts(train).items()
        if "logBase" in drawn and len(_SERIES.findall(drawn)) == 3
    )

    def swapped(text):
        first, second, third = _SERIES.findall(text)
        names = [re.search("<c:tx>.*?</c:tx>", one)[0] for one in (second, third)]
        other = third.replace(names[1], names[0])
        return text.replace(second, second.replace(names[0], names[1])).replace(third, other)

    [said] = edited(train, part, swapped)
    assert "takes a series name from" in said.sentence


def test_the_whole_verification_tells_chart_and_cell(train, tmp_path):
    package = Package(train)
    _, torque, other = columns_of_the_history(train)
    part = next(p for p, drawn in charts(train).items() if f"ChartData!${torque}$5" in drawn)
    package.change(part, lambda text: text.replace(f"${torque}$", f"${other}$"))
    told = verify_file(package.store(tmp_path / "tampered.xlsx"))
    assert told.outcome == "does not follow"
    draws, carries = (f for f in told.findings if f.fails)
    assert f"draws ChartData!{other}5:{other}" in draws.sentence
    assert " shows " in carries.sentence
    assert {(f.kind, f.sheet, bool(f.cell)) for f in (draws, carries)} == {("chart", "Start", True)}  # fmt: skip


def test_a_copy_of_a_value_inside_a_chart_is_told_with_its_cell(train):
    workbook = open_workbook(train, ignore_lock=True)
    _, torque, _ = columns_of_the_history(train)
    part = next(p for p, drawn in charts(train).items() if f"ChartData!${torque}$5" in drawn)
    point = re.compile(r'(<c:yVal>.*?<c:pt idx="7"><c:v>)([^<]*)(</c:v>)', re.DOTALL)
    [said] = edited(train, part, lambda text: point.sub(r"\g<1>1.5\3", text, count=1))
    assert (said.kind, said.sheet) == ("chart", "Start")
    assert f"shows 1.5 for ChartData!{torque}12" in said.sentence
    assert said.expected == workbook.shown_value("ChartData", f"{torque}12")
    assert said.fails


def test_words_inside_a_chart_are_compared_too(train):
    _, torque, _ = columns_of_the_history(train)
    part = next(p for p, drawn in charts(train).items() if f"ChartData!${torque}$5" in drawn)
    said = edited(
        train, part, lambda text: re.sub(r"(<c:strCache>.*?<c:v>)[^<]*", r"\g<1>Harmless", text)
    )
    assert "shows 'Harmless' for ChartData!B" in said[0].sentence


@pytest.mark.slow
def test_what_an_engineer_does_to_charts_is_his_affair(train, tmp_path):
    text = charts(train)
    part = next(p for p, drawn in text.items() if "Accelerating" in drawn)
    series = _SERIES.findall(text[part])

    def own(text):
        """A measured curve beside ours."""
        mine = re.sub(r"ChartData!\$Y\$\d+:\$Y\$\d+", "'Torque and motor'!$B$7:$B$9", series[0])
        mine = re.sub("<c:numCache>.*?</c:numCache>", "", mine, flags=re.DOTALL)
        return text.replace(series[-1], series[-1] + mine)

    assert edited(train, part, own) == []
    assert edited(train, part, lambda text: text.replace(series[-1], "")) == []
    package = Package(train)  # sheets under other names
    for name, data in package.parts.items():
        if name.startswith("xl/") and name.endswith(".xml"):
            new = data.replace(b"ChartData!", b"Behind!").replace(b'name="ChartData"', b'name="Behind"')  # fmt: skip
            package.parts[name] = new
    assert found(package.store(tmp_path / "renamed.xlsx")) == []
    package = Package(train)  # a chart taken out
    drawing = next(p for p in package.parts if p.startswith("xl/drawings/drawing"))
    package.change(
        drawing,
        lambda text: re.sub(
            r"<xdr:twoCellAnchor.*?</xdr:twoCellAnchor>", "", text, count=1, flags=re.DOTALL
        ),  # fmt: skip
    )
    assert found(package.store(tmp_path / "without.xlsx")) == []


@pytest.mark.slow
def test_charts_stay_clean_and_known_after_another_program(train, soffice, tmp_path):
    saved = soffice.convert(train, "xlsx", tmp_path / "saved")
    assert found(saved) == []
    package = Package(saved)
    _, torque, other = columns_of_the_history(train)
    part = next(p for p, drawn in charts(saved).items() if f"${torque}$5" in drawn)
    package.change(part, lambda text: text.replace(f"${torque}$", f"${other}$"))
    said = found(package.store(tmp_path / "tampered.xlsx"))
    assert [one.sheet for one in said if "draws" in one.sentence] == ["Start"]


# --- units ----------------------------------------------------------------------------------------


def columns_of_the_history(train: Path) -> list[str]:
    """Letters of the first columns behind the histories: time, torques of two elements."""
    left = open_workbook(train, ignore_lock=True).table("ChartHistory").data.left
    return [column_letters(left + k) for k in range(3)]


def unit_cells(workbook: Workbook) -> dict[str, tuple[str, str]]:
    """Cells right of the numbers: by what stands there, sheet and cell."""
    found = {}
    for sheet, label, unit in (("Summary", 2, 4), ("Fatigue", 15, 20)):
        part = workbook.sheet_part(sheet)
        for row in range(1, 60):
            words, shown = part.constant(row, label), part.constant(row, unit)
            if isinstance(words, str) and isinstance(shown, str) and len(shown) < 9:
                found[words] = (sheet, f"{column_letters(unit)}{row}")
    return found


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "label",
    [
        "Largest nominal stress, p-p",
        "Duration of the start",
        "First torsional mode",
        "Endurance limit in torsion",
    ],  # fmt: skip
)
@pytest.mark.parametrize("put", ["N·m", ""])
def test_a_unit_typed_beside_a_key_number_is_told(train, label, put):
    sheet, cell = unit_cells(open_workbook(train, ignore_lock=True))[label]
    package = Package(train)
    package.put_text(sheet, cell, put)
    [one] = found(package.store(train.with_name("tampered.xlsx")))
    assert (one.kind, one.sheet) == ("edited", sheet)
    assert f"{label}: the unit shown is '" in one.sentence
    assert one.fails
    if put:
        assert (one.cell, one.found) == (cell, put)


@pytest.mark.slow
def test_a_unit_given_by_a_formula_that_reads_something_else_is_told(train):
    package = Package(train)
    package.change_cell("Summary", unit_cells(open_workbook(train))["Largest nominal stress, p-p"][1], '<f>"Pa"</f><v>Pa</v>', kind="str")  # fmt: skip
    told = verify_file(package.store(train.with_name("tampered.xlsx")))
    assert any("the unit shown is 'Pa'" in one.sentence and one.fails for one in told.findings)


def test_charts_lie_where_they_are_said_to_lie(train):
    """By the drawings of the package, read by hand: two charts on sheet Torque and motor, at F... and so on."""
    places = {(one.sheet, one.cell) for one in drawn_charts(open_workbook(train, ignore_lock=True))}
    package = Package(train)
    corners = re.compile(r"<xdr:from><xdr:col>(\d+)</xdr:col>.*?<xdr:row>(\d+)</xdr:row>")
    count = sum(
        len(corners.findall(data.decode()))
        - data.count(b"<xdr:grpSp>")  # the schematic is no chart
        for name, data in package.parts.items()
        if name.startswith("xl/drawings/drawing")
    )
    assert len(places) == count == len(charts(train))


def schematic_found(path: Path) -> list[tuple[str, bool, str]]:
    workbook = open_workbook(path, ignore_lock=True)
    case = read_workbook(workbook).data
    said = compare_schematic(workbook, case, same_version=True)
    return [(one.kind, one.fails, one.sentence) for one in said]


MOVED = re.compile(r'(<a:off x=")(\d+)(" y="\d+"/><a:ext cx="\d+" cy="\d+"/></a:xfrm><a:custGeom>)')


@pytest.mark.parametrize(
    ("pattern", "put", "kind", "fails", "sentence"),
    [
        ("<a:t>LP comp</a:t>", "<a:t>Booster</a:t>", "chart", True, "says 'Booster', which does not"),
        (r"(?s)<xdr:sp macro=(?:(?!</xdr:sp>).)*?>HP comp<.*?</xdr:sp>", "", "chart", True, "does not say 'HP comp'"),
        (MOVED, lambda at: f"{at[1]}{int(at[2]) + 95250}{at[3]}", "chart", True, "shows a shape otherwise"),
        ('<a:srgbClr val="1F3A5F"/>', '<a:srgbClr val="FFFFFF"/>', "chart", True, "otherwise than"),
        ('descr="schematic"', 'descr="schematic" hidden="1"', "hidden", True, "is hidden"),
        ("(?s)<xdr:grpSpPr>.*?</xdr:grpSpPr>", "<xdr:grpSpPr/>", "chart", True, "is not drawn"),
        ('name="schematic" descr="schematic"', 'name="mine"', "chart", False, "no schematic of the train"),
    ],
)  # fmt: skip
def test_another_schematic_is_found(train, pattern, put, kind, fails, sentence):
    assert schematic_found(train) == []
    package = Package(train)
    [part] = [n for n, data in package.parts.items() if b'descr="schematic"' in data]
    package.change(part, lambda text: re.sub(pattern, put, text, count=1))
    [(found_kind, found_fails, said)] = schematic_found(package.store(train.with_name("s.xlsx")))
    assert (found_kind, found_fails) == (kind, fails)
    assert sentence in said


def test_a_schematic_that_was_moved_or_stretched_is_the_same(train):
    """Also where LibreOffice dropped its description."""
    package = Package(train)
    [part] = [n for n, data in package.parts.items() if b'descr="schematic"' in data]

    def stretched(text: str) -> str:
        place = r'(<xdr:grpSpPr><a:xfrm>)<a:off x="\d+" y="\d+"/><a:ext cx="\d+" cy="\d+"/>'
        text = text.replace(' descr="schematic"', "")
        return re.sub(place, r'\1<a:off x="7" y="9"/><a:ext cx="8000000" cy="900000"/>', text)

    package.change(part, stretched)
    assert schematic_found(package.store(train.with_name("s.xlsx"))) == []


def retitled(words: str) -> Callable[[str], str]:
    """Fixed words in place of a title."""
    title = (
        "<c:tx><c:rich><a:bodyPr/><a:p><a:r><a:t>" + words + "</a:t></a:r></a:p></c:rich></c:tx>"
    )
    return lambda text: re.sub(
        r"(<c:chart><c:title>)<c:tx>.*?</c:tx>", rf"\g<1>{title}", text, count=1, flags=re.DOTALL
    )


def titled(train: Path, words: str) -> str:
    """The chart part with a title."""
    [part] = [name for name, text in charts(train).items() if words in text.split("</c:title>")[0]]
    return part


def test_a_title_in_our_words_that_says_something_else_is_found(train):
    part = titled(train, "Gear shaft: nominal shear stress")
    [said] = edited(train, part, retitled("Pinion shaft: nominal shear stress"))
    assert (said.kind, said.fails) == ("chart", True)
    assert (
        "'Pinion shaft: nominal shear stress' stands in place of 'Gear shaft: nominal"
        in said.sentence
    )
    [own] = edited(train, part, retitled("Figure 3"))
    assert (own.sheet, own.cell, own.fails) == (said.sheet, said.cell, False)


def test_a_title_from_another_cell_is_found(train):
    def moved(text: str) -> str:
        head, rest = text.split("</c:title>", 1)
        return re.sub(r"<c:f>[^<]*</c:f>", "<c:f>Notes!$B$5</c:f>", head) + "</c:title>" + rest

    found = edited(train, titled(train, "Gear shaft: nominal shear stress"), moved)
    said = [one for one in found if "title of the chart was changed" in one.sentence]
    assert [one.fails for one in said] == [True]
