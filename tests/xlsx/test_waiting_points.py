"""Points that a chart carries stay text, those that the file has as well as renewed ones.

Expected: the same bytes, the same judgement of old values and the same refusals as with points that are parsed.
"""

from __future__ import annotations

import re

import pytest

from addin.xlsx.charts import Area, ChartPart, Shown
from addin.xlsx.errors import WorkbookRefused
from addin.xlsx.references import Rect
from addin.xlsx.values import Constant
from addin.xlsx.xml_part import CHART, parse_part, serialise

NUMBERS: list[Constant] = [k + 0.5 for k in range(20)]
WORDS: list[Constant] = [f"a & <b> {k}" for k in range(20)]
POINTS = "".join(f'<c:pt idx="{k}"><c:v>{k}.5</c:v></c:pt>' for k in range(20))
LABELS = "".join(f'<c:pt idx="{k}"><c:v>a &amp; &lt;b> {k}</c:v></c:pt>' for k in range(20))
CHART_PART = f"""<?xml version="1.0" encoding="UTF-8"?>
<c:chartSpace xmlns:c="{CHART}"><c:chart><c:plotArea><c:ser>
<c:cat><c:strRef><c:f>S!$A$1:$A$20</c:f><c:strCache><c:ptCount val="20"/>{LABELS}</c:strCache></c:strRef></c:cat>
<c:val><c:numRef><c:f>S!$B$1:$B$20</c:f><c:numCache><c:formatCode>0.0</c:formatCode><c:ptCount val="20"/>{POINTS}
</c:numCache></c:numRef></c:val></c:ser></c:plotArea></c:chart></c:chartSpace>""".replace(
    "b> ", "b&gt; "
)

#: What other programs may have made of it: each is stored as a parsed part would be.
OTHERWISE = {
    "as it is": ("", ""),
    "a comment": ('<c:pt idx="7">', '<!-- <c:pt idx="7"> --><c:pt idx="7">'),
    "an instruction": ('<c:pt idx="12">', '<?x y?><c:pt idx="12">'),
    "character data": ("<c:v>3.5</c:v>", "<c:v><![CDATA[3.5]]></c:v>"),
    "a format": ('<c:pt idx="9">', '<c:pt idx="9" formatCode="0.00">'),
    "single quotes": ('<c:pt idx="10">', "<c:pt idx='10'>"),
    "blanks": ('<c:pt idx="5">', '\n  <c:pt idx="5">'),
    "another letter": ("a &amp;", "ä &amp;"),
    "a bracket as it is": ("&lt;b&gt;", "&lt;b>"),
    "a number of a character": ("a &amp;", "&#97; &amp;"),
    "two declarations": ("<c:ser>", f'<c:ser xmlns:c="{CHART}">'),
    "another prefix": ("c:", "k:"),
    "the name of a place": ('<c:pt idx="19">', '<c:pt idx="points-1">'),
}
ENCODINGS = ("UTF-8", "UTF-16", "ISO-8859-1")


def _stored(how: str, encoding: str = "UTF-8") -> bytes:
    text = CHART_PART.replace(*OTHERWISE[how]) if OTHERWISE[how][0] else CHART_PART
    text = text.replace("xmlns:c", "xmlns:k") if how == "another prefix" else text
    return text.replace("UTF-8", encoding).encode(encoding)


def _areas(text: str) -> list[Area]:
    return [("S", Rect(1, 1 if "A" in text else 2, 20, 1 if "A" in text else 2))]


def _shown(numbers: list[Constant]) -> Shown:
    return Shown(lambda sheet, rect: WORDS if rect.left == 1 else numbers, lambda *_: None)


def _refreshed(chart: ChartPart, numbers: list[Constant], *, sure: bool) -> bool:
    chart.refresh(_areas, (lambda *_: sure, lambda *_: True), _shown(numbers), {})
    return chart.changed


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("how", OTHERWISE)
def test_a_chart_is_stored_as_if_it_had_been_parsed(how: str, encoding: str) -> None:
    data = _stored(how, encoding)
    if how != "the name of a place":
        assert ChartPart("c.xml", data).to_bytes() == serialise(parse_part(data, "c.xml"), data)
    chart = ChartPart("c.xml", data)
    assert _refreshed(chart, [2.0, *NUMBERS[1:]], sure=True)
    stored = chart.to_bytes().decode()
    assert re.sub("<!--.*?-->", "", stored).count("idx=") == 40
    assert stored.count(":v>2</") == 1
    assert "points-" not in stored


@pytest.mark.parametrize("how", OTHERWISE)
def test_values_that_a_chart_carries_are_told_from_old_ones(how: str) -> None:
    current = how not in ("another letter", "the name of a place")
    assert _refreshed(ChartPart("c.xml", _stored(how)), NUMBERS, sure=False) is not current
    old = [*NUMBERS[:-1], 7.0]
    assert _refreshed(ChartPart("c.xml", _stored(how)), old, sure=False)


def test_the_points_are_not_parsed() -> None:
    chart = ChartPart("c.xml", _stored("as it is"))
    count = len('<c:ptCount val="20"/>')
    lengths = [count + len(LABELS) + 3 * 20, count + len(POINTS)]
    assert [len(run) for run in chart._points] == lengths
    assert len(list(chart._root.iter())) < 25


@pytest.mark.parametrize(
    ("there", "broken"),
    [
        ("</c:chart>", "</c:char>"),
        ("<c:v>7.5</c:v>", "<c:v>7.5</c:w>"),
        ("<c:v>7.5</c:v>", "<c:v>\x01</c:v>"),
        ("<c:v>7.5</c:v>", "<c:v>&no;</c:v>"),
        (f' xmlns:c="{CHART}"', ""),
    ],
)
def test_what_is_wrong_is_said_of_the_part_as_it_is_stored(there: str, broken: str) -> None:
    data = CHART_PART.replace(there, broken).encode()
    with pytest.raises(WorkbookRefused) as parsed:
        parse_part(data, "c.xml")
    with pytest.raises(WorkbookRefused) as refused:
        ChartPart("c.xml", data)
    assert str(refused.value) == str(parsed.value)
