"""Objects of a drawing hidden, shown or drawn anew: nothing else of the part changes."""

from lxml import etree

from addin.xlsx.drawn_shapes import Shape, ShapeGroup, with_hidden

_XDR = "http://schemas.openxmlformats.org/drawingml/2006/spreadsheetDrawing"
_A = "http://schemas.openxmlformats.org/drawingml/2006/main"
_ANCHOR = (
    "<xdr:twoCellAnchor><xdr:from><xdr:col>1</xdr:col><xdr:colOff>0</xdr:colOff><xdr:row>1</xdr:row>"
    "<xdr:rowOff>0</xdr:rowOff></xdr:from><xdr:to><xdr:col>3</xdr:col><xdr:colOff>0</xdr:colOff>"
    '<xdr:row>4</xdr:row><xdr:rowOff>0</xdr:rowOff></xdr:to><xdr:sp macro="" textlink=""><xdr:nvSpPr>'
    '<xdr:cNvPr id="{0}" name="Box {0}" descr="{1}"/><xdr:cNvSpPr/></xdr:nvSpPr><xdr:spPr><a:xfrm>'
    '<a:off x="9525" y="19050"/><a:ext cx="952500" cy="476250"/></a:xfrm></xdr:spPr></xdr:sp>'
    "<xdr:clientData/></xdr:twoCellAnchor>"
)
DRAWING = (
    f'<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n<xdr:wsDr xmlns:xdr="{_XDR}" xmlns:a="{_A}">'
    + _ANCHOR.format(2, "ours")
    + _ANCHOR.format(3, "the engineer's")
    + "</xdr:wsDr>"
).encode()


def test_an_object_is_hidden_and_shown_again_and_no_other_byte_changes():
    hidden = with_hidden(DRAWING, {"ours": True})
    assert hidden == DRAWING.replace(b'descr="ours"', b'descr="ours" hidden="1"')
    assert with_hidden(hidden, {"ours": True}) == hidden
    assert with_hidden(hidden, {"ours": False}) == DRAWING
    assert with_hidden(DRAWING, {"nothing of this name": True}) == DRAWING


def test_a_group_takes_the_place_of_an_object_and_keeps_its_anchor():
    group = ShapeGroup("drawing1.xml", DRAWING, "ours")
    assert group.frame is not None
    assert (group.frame.width, group.frame.height) == (952500, 476250)
    shapes = [
        Shape(10.0, 5.0, 20.0, 10.0, fill="#112233", text="A < B"),
        Shape(0.0, 0.0, 8.0, 8.0, fill="#112233", points=((0.0, 0.0), (8.0, 0.0), (8.0, 8.0))),
    ]
    root = etree.fromstring(group.drawn(shapes))
    first, second = root
    [made] = first.findall(f"{{{_XDR}}}grpSp")
    assert [one.get("descr") for one in made.iter(f"{{{_XDR}}}cNvPr")][0] == "ours"
    assert "".join(made.itertext()) == "A < B"
    offset = made.findall(f".//{{{_A}}}off")[1]
    assert (offset.get("x"), offset.get("y")) == (str(9525 + 95250), str(19050 + 47625))
    numbers = [one.get("id") for one in root.iter(f"{{{_XDR}}}cNvPr")]
    assert len(set(numbers)) == len(numbers)
    before = etree.fromstring(DRAWING)
    assert etree.tostring(second) == etree.tostring(before[1])
    assert etree.tostring(first[0]) == etree.tostring(before[0][0])  # where it begins


def test_drawing_again_gives_the_same_bytes():
    shapes = [Shape(0.0, 0.0, 9.0, 9.0, fill="#112233", text="x")]
    once = ShapeGroup("drawing1.xml", DRAWING, "ours").drawn(shapes)
    assert ShapeGroup("drawing1.xml", once, "ours").drawn(shapes) == once


def test_a_drawing_without_the_object_has_no_room_for_it():
    assert ShapeGroup("drawing1.xml", DRAWING, "schematic").frame is None
