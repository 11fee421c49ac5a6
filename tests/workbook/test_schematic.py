"""The schematic of sheet Summary: what of a train is drawn, where, and with which words."""

import re
import zipfile
from dataclasses import replace

import pytest

from addin.charts.schematic import schematic
from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from addin.writing.drawn_schematic import SchematicPicture, draw_schematic, schematic_picture
from addin.xlsx import open_workbook
from addin.xlsx.drawn_shapes import Shape
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow


def shipped(name: str) -> CaseData:
    return read_workbook(open_workbook(template_path(name), read_only=True)).data


@pytest.fixture(scope="module")
def geared() -> CaseData:
    return shipped("example_motor.xlsx")


def test_the_train_of_the_paper(geared: CaseData) -> None:
    drawing = schematic(geared)
    named = [(one.name, one.words, one.is_motor) for one in drawing.machines]
    assert named == [
        ("Motor", "11,186 kW, 1,800 rpm", True),
        ("LP comp", "10,080 rpm", False),
        ("HP comp", "10,080 rpm", False),
    ]
    assert [one.name for one in drawing.couplings] == [
        "LS coupling", "HS coupling", "Intermediate coupling",
    ]  # fmt: skip
    assert [note.words for note in drawing.notes] == ["5.6 : 1 (112 / 20 teeth)"]


def test_gears_in_mesh_touch_and_the_larger_has_the_slower_shaft(geared: CaseData) -> None:
    bull, pinion = schematic(geared).gears
    assert bull.half + pinion.half == pytest.approx(pinion.axis - bull.axis)
    assert bull.half > 3.0 * pinion.half
    assert (bull.left, bull.width) == (pinion.left, pinion.width)


def test_everything_stands_within_the_picture(geared: CaseData) -> None:
    drawing = schematic(geared)
    for one in (*drawing.machines, *drawing.couplings, *drawing.gears):
        assert -1e-9 <= one.axis - one.half
        assert one.axis + one.half <= 1.0 + 1e-9
    for shaft in drawing.shafts:
        assert 0.0 <= shaft.left < shaft.right <= drawing.width + 1e-9


@pytest.mark.parametrize("letter", [7.4, 9.4])
def test_words_of_a_picture_cover_no_others(geared: CaseData, letter: float) -> None:
    """In the page of the server and in the report, whose letters are wider."""
    picture = schematic_picture(geared, 918.0, letter)
    assert picture is not None
    words = [one for one in picture.shapes if one.text]
    assert {one.text.split("\n")[0] for one in words} >= {"Motor", "HS coupling", "Intermediate"}
    stand_apart(words, picture)


def stand_apart(words: list[Shape], picture: SchematicPicture) -> None:
    """Whether words cover no others and lie within the picture."""
    for k, one in enumerate(words):
        assert one.left >= 0.0
        assert one.left + one.width <= picture.width
        assert one.top + one.height <= picture.height
        for other in words[k + 1 :]:
            beside = one.left + one.width <= other.left or other.left + other.width <= one.left
            assert (
                beside or one.top + one.height <= other.top or other.top + other.height <= one.top
            )


@pytest.mark.parametrize("count", [2, 6, 12, 18, 40, 200])
def test_a_long_train_shows_the_words_that_have_room(count: int) -> None:
    """Every station is a machine here, their shafts as short as any."""
    names = [f"A rather long name {k}" for k in range(count)]
    stations = tuple(StationRow(name, inertia=1.0, speed_ratio=1.0) for name in names)
    elements = tuple(
        ElementRow(f"s{k}", kind="shaft", from_=names[k], to=names[k + 1], stiffness=1.0)
        for k in range(count - 1)
    )
    picture = schematic_picture(replace(CaseData(), stations=stations, elements=elements), 918.0)
    assert picture is not None
    words = [one for one in picture.shapes if one.text]
    stand_apart(words, picture)
    if count == 2:
        assert len(words) == 4  # names and speeds


def test_a_closed_loop_a_branch_and_two_pinions_are_drawn_once_each() -> None:
    names = ("M", "G", "P1", "P2", "L1", "L2", "B")
    stations = tuple(
        StationRow(name, inertia=1.0, speed_ratio=3.0 if name[0] in "PL" else 1.0) for name in names
    )
    rows = (
        ("s", "shaft", "M", "G"), ("m1", "gear mesh", "G", "P1"), ("m2", "gear mesh", "G", "P2"),
        ("a", "shaft", "P1", "L1"), ("b", "shaft", "P2", "L2"), ("side", "shaft", "M", "B"),
        ("loop", "shaft", "M", "G"),
    )  # fmt: skip
    elements = tuple(ElementRow(e, kind=k, from_=f, to=t, stiffness=1.0) for e, k, f, t in rows)
    case = replace(CaseData(), stations=stations, elements=elements, meshes=(MeshRow("m1"),))
    drawing = schematic(case)
    assert len(drawing.gears) == 3
    assert len(drawing.notes) == 2
    assert len(drawing.machines) + len(drawing.gears) == len(names)
    axes = {round(one.axis, 9) for one in drawing.gears}
    assert len(axes) == 3
    assert drawing.not_drawn == ("loop",)


def test_no_station_no_drawing() -> None:
    assert schematic(CaseData()).machines == ()


def test_a_shipped_example_has_the_drawing_and_a_renamed_machine_is_drawn(tmp_path) -> None:
    book = open_workbook(template_path("example_proposed.xlsx"))
    case = read_workbook(book).data
    stations = tuple(
        replace(row, station="Booster") if row.station == "LP comp" else row
        for row in case.stations
    )
    draw_schematic(book, replace(case, stations=stations))
    report = book.save(tmp_path / "out.xlsx")
    assert [part for part in report.parts if "worksheets" in part] == []
    [drawing] = [part for part in report.parts if part.startswith("xl/drawings/")]
    before, after = (
        zipfile.ZipFile(path).read(drawing).decode()
        for path in (template_path("example_proposed.xlsx"), report.path)
    )
    assert ">LP comp<" in before
    assert ">Booster<" in after
    corners = re.compile(r"<xdr:from>.*?</xdr:to>", re.DOTALL)
    assert corners.findall(before) == corners.findall(after)
