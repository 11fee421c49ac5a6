"""Pictures: their letters can be read, names stand apart, and histories show their limits."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.text import Annotation, Text
from report_files import ROOT

from addin.contract.chart_tables import CHART_TABLES
from addin.reading.one_file import read_checked
from addin.report.build import build_document
from addin.report.document import Document, Figure, Section
from addin.report.figures import Charts, Pictures
from addin.writing.recalculate import recalculate_case

PSI = 6894.757293168361


def figures_of(sections: Sequence[Section]) -> Iterator[Figure]:
    for section in sections:
        yield from (block for block in section.blocks if isinstance(block, Figure))
        yield from figures_of(section.parts)


def document(source: Path) -> Document:
    """A report whose pictures are not drawn yet."""
    read = read_checked(source)
    calculation, problems = recalculate_case(read, {}, lambda stage: None)
    assert calculation is not None
    assert not problems
    return build_document(source.name, read, calculation, vectors=False, pixels=False)


@pytest.fixture(scope="module")
def pictures() -> list[Figure]:
    """Those of the proposed system of the paper."""
    return [*figures_of(document(ROOT / "templates" / "example_proposed.xlsx").sections)]


def test_no_letter_of_a_picture_is_below_8_pt(pictures: list[Figure]) -> None:
    sizes = [
        (words.get_text(), words.get_fontsize())
        for picture in pictures
        for words in picture.drawing.findobj(Text)
        if words.get_text().strip()
    ]
    assert len(sizes) > 100
    assert [one for one in sizes if one[1] < 8.0] == []


def test_histories_show_their_limits(pictures: list[Figure]) -> None:
    """Endurance 19,000 psi in torsion over SCF 3; the mesh 129,167 and 33,333 lbf·ft at a radius of 16.8 in."""
    found = {}
    for picture in pictures:
        if not picture.caption.startswith("Start against time"):
            continue
        for ax in picture.drawing.axes:
            dashed = sorted(
                line.get_ydata()[0] for line in ax.lines if line.get_linestyle() == "--"
            )
            found[ax.get_title(loc="left")] = (dashed, ax.get_title(loc="right"))
    lines, words = found["HP compressor shaft: nominal shear stress"]
    assert lines == pytest.approx([-19000.0 / 3.0, 19000.0 / 3.0])
    assert words == "Endurance limit / SCF (alternating) ±6,333"
    lines, words = found["Mesh: tangential tooth load"]
    assert words.startswith("Peak torque and reversal limits ")
    torques = [-33_333.3, 129_166.7]
    assert lines == pytest.approx([torque * 12.0 / 16.8 for torque in torques], rel=1e-5)


def speed_picture(times: Sequence[float]) -> Any:
    """The speed of a start of 10 s with named points at some times."""
    columns: dict[str, dict[str, list[Any]]] = {
        table.name: {name: [None] for name in table.columns} for table in CHART_TABLES
    }
    columns["ChartSpeedTime"] = {"Time": [0.0, 10.0], "Speed": [0.0, 1800.0]}
    columns["ChartCrossings"] = {"Time": [*times], "Speed": [180.0 * t for t in times]}
    labels = {f"Crossing {k}": f"Mode {k}: {20.0 * k:.1f} Hz" for k in range(1, len(times) + 1)}
    figure = Pictures(Charts(columns, labels), vectors=False).speed_time()
    assert figure is not None
    return figure.drawing


@settings(max_examples=15)
@given(st.lists(st.floats(0.5, 9.5), min_size=2, max_size=5))
def test_names_of_crossings_do_not_cover_each_other(times: list[float]) -> None:
    drawing = speed_picture(times)
    drawing.draw_without_rendering()
    names = [n for n in drawing.findobj(Annotation) if n.get_text().startswith("Mode")]
    assert len(names) == len(times)
    boxes = [Text.get_window_extent(name) for name in names]
    for one, other in itertools.combinations(boxes, 2):
        assert min(one.x1, other.x1) <= max(one.x0, other.x0) + 1.0 or min(one.y1, other.y1) <= max(one.y0, other.y0) + 1.0  # fmt: skip
