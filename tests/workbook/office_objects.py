"""Pivot tables, slicers and rich values, put into a workbook as Excel stores them.

Shapes after ECMA-376 part 1 (18.10 pivot tables) and [MS-XLSX] (2.6 slicers, rich values). XlsxWriter
makes pictures in cells, which are rich values; the linked data type and the blocked spill stand
beside them.
"""

from __future__ import annotations

import re
from typing import Any

from office_package import Parts, added, edited, named_tables, part_of_sheet, related

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
REL = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
OPEN = "application/vnd.openxmlformats-officedocument.spreadsheetml"
MC = "http://schemas.openxmlformats.org/markup-compatibility/2006"
X14 = "http://schemas.microsoft.com/office/spreadsheetml/2009/9/main"
X15 = "http://schemas.microsoft.com/office/spreadsheetml/2010/11/main"
RICH = "http://schemas.microsoft.com/office/spreadsheetml/2017/richdata"
SLICERS = "http://schemas.microsoft.com/office/2007/relationships"
RICH_LINKS = "http://schemas.microsoft.com/office/2017/06/relationships"
#: The engineer's sheets; the first has a text box, so that it has a drawing.
PIVOTS, OWN = "Our pivots", "Our summary"
#: Numbers that stand for what XlsxWriter cannot write, by the cell that they become.
LINKED, SPILL, CHOSEN = 987654001, 987654002, 987654003


def pivot_sheet(book: Any) -> Any:
    """The cells that Excel shows of two pivot tables, and a formula on one of them."""
    sheet = book.add_worksheet(PIVOTS)
    sheet.write_column("A3", ["Row Labels", "A", "B", "C", "Grand Total"])
    sheet.write_column("B3", ["Sum of Limit", 1, 2, 3, 6])
    sheet.write_column("D3", ["Row Labels", "(blank)", "Grand Total"])
    sheet.write_column("E3", ["Max of Maximum torque"])
    sheet.write_formula("H3", '=GETPIVOTDATA("Limit",$A$3)', None, 6)
    sheet.insert_textbox("H6", "filter here")
    return sheet


def rich_cells(own: Any, picture: dict[str, Any]) -> None:
    """Pictures in cells, and cells that `rich_values` makes a linked data type and a blocked spill of."""
    own.embed_image("M60", "dot.png", picture | {"description": "the motor"})
    own.write_number("A20", LINKED)
    own.write_formula("B20", '=_FV(A20,"Price")', None, 103.5)
    own.write_formula("C20", '=_FV(A20,"Price")*B1', None, 103.5)
    own.write_formula("D20", "=IF(ISERROR(A20),0,B1)", None, 1.0)
    own.write_formula("E20", "=IF(B1>0,A20,M60)", None, CHOSEN)
    own.write_dynamic_array_formula("A21:A21", "=_xlfn.SEQUENCE(3)", None, SPILL)
    own.write_string("A22", "in the way")


# --- pivot tables -------------------------------------------------------------------------------


def pivot_tables(parts: Parts) -> None:
    """One on the engineer's own table, one on a result table of ours, as it was refreshed last."""
    peaks = re.findall(
        r'<tableColumn [^>]*?name="([^"]*)"', parts[named_tables(parts)["StartupPeaks"]].decode()
    )
    number = (
        'containsSemiMixedTypes="0" containsString="0" containsNumber="1" containsInteger="1" '
        'minValue="1" maxValue="3"'
    )
    ours = (
        '<cacheField name="Item" numFmtId="0"><sharedItems count="3"><s v="A"/><s v="B"/><s v="C"/>'
        '</sharedItems></cacheField><cacheField name="Limit" numFmtId="0">'
        f"<sharedItems {number}/></cacheField>"
    )
    blank = '<sharedItems containsNonDate="0" containsString="0" containsBlank="1" count="1"><m/></sharedItems>'
    theirs = "".join(f'<cacheField name="{one}" numFmtId="0">{blank}</cacheField>' for one in peaks)
    records = "".join(f'<r><x v="{k}"/><n v="{k + 1}"/></r>' for k in range(3))
    _pivot(parts, 1, "OurLimits", 2, ours, records, 3, 1, "A3:B7", "Sum of Limit", "")
    _pivot(
        parts, 2, "StartupPeaks", len(peaks), theirs, "<r>" + '<x v="0"/>' * len(peaks) + "</r>", 1,
        peaks.index("Maximum torque"), "D3:E5", "Max of Maximum torque", ' subtotal="max"',
    )  # fmt: skip
    caches = "".join(f'<pivotCache cacheId="{k}" r:id="{_cache_link(parts, k)}"/>' for k in (1, 2))
    edited(
        parts, "xl/workbook.xml", "</workbook>", f"<pivotCaches>{caches}</pivotCaches></workbook>"
    )


def _cache_link(parts: Parts, number: int) -> str:
    target = f"pivotCache/pivotCacheDefinition{number}.xml"
    return related(parts, "xl/workbook.xml", f"{REL}/pivotCacheDefinition", target)


def _pivot(
    parts: Parts, number: int, source: str, width: int, fields: str, records: str, items: int,
    summed: int, place: str, title: str, how: str,
) -> None:  # fmt: skip
    cache = f"xl/pivotCache/pivotCacheDefinition{number}.xml"
    added(
        parts, cache, f"{OPEN}.pivotCacheDefinition+xml",
        f'<pivotCacheDefinition xmlns="{MAIN}" xmlns:r="{REL}" r:id="rId1" refreshedBy="A. Engineer" '
        'refreshedDate="46024.5" createdVersion="6" refreshedVersion="6" minRefreshableVersion="3" '
        f'recordCount="{records.count("<r>")}"><cacheSource type="worksheet"><worksheetSource '
        f'name="{source}"/></cacheSource><cacheFields count="{width}">{fields}</cacheFields><extLst>'
        f'<ext uri="{{725AE2AE-9491-48be-B2B4-4EB974FC3084}}" xmlns:x14="{X14}">'
        f'<x14:pivotCacheDefinition pivotCacheId="{number}"/></ext></extLst></pivotCacheDefinition>',
    )  # fmt: skip
    added(
        parts, f"xl/pivotCache/pivotCacheRecords{number}.xml", f"{OPEN}.pivotCacheRecords+xml",
        f'<pivotCacheRecords xmlns="{MAIN}" xmlns:r="{REL}" count="{records.count("<r>")}">{records}'
        "</pivotCacheRecords>",
    )  # fmt: skip
    related(parts, cache, f"{REL}/pivotCacheRecords", f"pivotCacheRecords{number}.xml", "rId1")
    rows = "".join(f'<item x="{k}"/>' for k in range(items)) + '<item t="default"/>'
    lines = "".join(f'<i><x v="{k}"/></i>' for k in range(items)) + '<i t="grand"><x/></i>'
    columns = "".join(
        f'<pivotField axis="axisRow" showAll="0"><items count="{items + 1}">{rows}</items></pivotField>'
        if k == 0
        else f'<pivotField {"dataField=" + chr(34) + "1" + chr(34) if k == summed else ""} showAll="0"/>'
        for k in range(width)
    )
    table = f"xl/pivotTables/pivotTable{number}.xml"
    added(
        parts, table, f"{OPEN}.pivotTable+xml",
        f'<pivotTableDefinition xmlns="{MAIN}" name="PivotTable{number}" cacheId="{number}" '
        'applyNumberFormats="0" applyBorderFormats="0" applyFontFormats="0" applyPatternFormats="0" '
        'applyAlignmentFormats="0" applyWidthHeightFormats="1" dataCaption="Values" updatedVersion="6" '
        'minRefreshableVersion="3" useAutoFormatting="1" itemPrintTitles="1" createdVersion="6" '
        f'indent="0" outline="1" outlineData="1"><location ref="{place}" firstHeaderRow="1" '
        f'firstDataRow="1" firstDataCol="1"/><pivotFields count="{width}">{columns}</pivotFields>'
        f'<rowFields count="1"><field x="0"/></rowFields><rowItems count="{items + 1}">{lines}'
        '</rowItems><colItems count="1"><i/></colItems><dataFields count="1"><dataField '
        f'name="{title}" fld="{summed}"{how} baseField="0" baseItem="0"/></dataFields>'
        '<pivotTableStyleInfo name="PivotStyleLight16" showRowHeaders="1" showColHeaders="1" '
        'showRowStripes="0" showColStripes="0" showLastColumn="1"/></pivotTableDefinition>',
    )  # fmt: skip
    related(
        parts, table, f"{REL}/pivotCacheDefinition",
        f"../pivotCache/pivotCacheDefinition{number}.xml", "rId1",
    )  # fmt: skip
    sheet = part_of_sheet(parts, PIVOTS)
    related(parts, sheet, f"{REL}/pivotTable", f"../pivotTables/pivotTable{number}.xml")


# --- slicers ------------------------------------------------------------------------------------


def slicers(parts: Parts) -> None:
    """One on a pivot table, one on a table, each with its frame in the drawing of its sheet."""
    book = parts["xl/workbook.xml"].decode()
    found = re.search(rf'<sheet name="{PIVOTS}" sheetId="(\d+)"', book)
    assert found
    of_pivot = (
        f'<pivotTables><pivotTable tabId="{found[1]}" name="PivotTable1"/></pivotTables><data>'
        '<tabular pivotCacheId="1"><items count="3"><i x="0" s="1"/><i x="1" s="1"/><i x="2" s="1"/>'
        "</items></tabular></data>"
    )
    table = parts[named_tables(parts)["OurLimits"]].decode()
    number = re.search(r'<table [^>]*?\bid="(\d+)"', table)
    assert number
    of_table = (
        f'<extLst><x:ext uri="{{2F2917AC-EB37-4324-AD4E-5DD8C200BD13}}" xmlns:x15="{X15}">'
        f'<x15:tableSlicerCache tableId="{number[1]}" column="1"/></x:ext></extLst>'
    )
    first = _slicer(parts, 1, "Slicer_Item", "Item", of_pivot, PIVOTS, "a14")
    second = _slicer(parts, 2, "Slicer_Item1", "Item 1", of_table, OWN, "sle15")
    edited(
        parts, "xl/workbook.xml", "</workbook>",
        f'<extLst><ext uri="{{BBE1A952-AA13-448e-AADC-164F8A28A991}}" xmlns:x14="{X14}">'
        f'<x14:slicerCaches><x14:slicerCache r:id="{first}"/></x14:slicerCaches></ext>'
        f'<ext uri="{{46BE6895-7355-4a93-B00E-2C351335B9C9}}" xmlns:x15="{X15}"><x15:slicerCaches '
        f'xmlns:x14="{X14}"><x14:slicerCache r:id="{second}"/></x15:slicerCaches></ext></extLst>'
        "</workbook>",
    )  # fmt: skip
    edited(
        parts, "xl/workbook.xml", "</definedNames>",
        '<definedName name="Slicer_Item">#N/A</definedName>'
        '<definedName name="Slicer_Item1">#N/A</definedName></definedNames>',
    )  # fmt: skip


def _slicer(
    parts: Parts, number: int, cache: str, name: str, of: str, sheet: str, needs: str
) -> str:
    head = f'xmlns="{X14}" xmlns:mc="{MC}" mc:Ignorable="x" xmlns:x="{MAIN}"'
    added(
        parts, f"xl/slicerCaches/slicerCache{number}.xml", "application/vnd.ms-excel.slicerCache+xml",
        f'<slicerCacheDefinition {head} name="{cache}" sourceName="Item">{of}</slicerCacheDefinition>',
    )  # fmt: skip
    added(
        parts, f"xl/slicers/slicer{number}.xml", "application/vnd.ms-excel.slicer+xml",
        f'<slicers {head}><slicer name="{name}" cache="{cache}" caption="Item" rowHeight="241300"/>'
        "</slicers>",
    )  # fmt: skip
    part = part_of_sheet(parts, sheet)
    link = related(parts, part, f"{SLICERS}/slicer", f"../slicers/slicer{number}.xml")
    prefix, where = (
        ("x14", "{A8765BA9-456A-4dab-B4F3-ACF838C121DE}")
        if needs == "a14"
        else ("x15", "{3A4CF648-6AED-40f4-86FF-DC5316D8AED3}")
    )
    listed = (
        f'<ext uri="{where}" xmlns:{prefix}="{X14 if prefix == "x14" else X15}"><x14:slicerList '
        f'xmlns:x14="{X14}"><x14:slicer r:id="{link}"/></x14:slicerList></ext>'
    )
    if b"<extLst>" in parts[part]:
        edited(parts, part, "</extLst></worksheet>", f"{listed}</extLst></worksheet>")
    else:
        edited(parts, part, "</worksheet>", f"<extLst>{listed}</extLst></worksheet>")
    _frame(parts, part, name, needs)
    target = f"slicerCaches/slicerCache{number}.xml"
    return related(parts, "xl/workbook.xml", f"{SLICERS}/slicerCache", target)


def _frame(parts: Parts, sheet: str, name: str, needs: str) -> None:
    """Where the slicer stands, with a plain shape for programs that know none."""
    links = parts[sheet.replace("worksheets/", "worksheets/_rels/") + ".rels"].decode()
    drawing = re.search(r'Target="\.\./drawings/(drawing\d+\.xml)"', links)
    assert drawing
    spaces = {
        "a14": "http://schemas.microsoft.com/office/drawing/2010/main",
        "sle15": "http://schemas.microsoft.com/office/drawing/2012/slicer",
    }
    slicer = "http://schemas.microsoft.com/office/drawing/2010/slicer"
    corner = "<xdr:{0}><xdr:col>{1}</xdr:col><xdr:colOff>0</xdr:colOff><xdr:row>{2}</xdr:row><xdr:rowOff>0</xdr:rowOff></xdr:{0}>"
    edited(
        parts, f"xl/drawings/{drawing[1]}", "</xdr:wsDr>",
        f'<xdr:twoCellAnchor editAs="oneCell">{corner.format("from", 9, 20)}{corner.format("to", 11, 30)}'
        f'<mc:AlternateContent xmlns:mc="{MC}" xmlns:{needs}="{spaces[needs]}"><mc:Choice '
        f'Requires="{needs}"><xdr:graphicFrame macro=""><xdr:nvGraphicFramePr><xdr:cNvPr id="99" '
        f'name="{name}"/><xdr:cNvGraphicFramePr/></xdr:nvGraphicFramePr><xdr:xfrm><a:off x="0" y="0"/>'
        f'<a:ext cx="0" cy="0"/></xdr:xfrm><a:graphic><a:graphicData uri="{slicer}"><sle:slicer '
        f'xmlns:sle="{slicer}" name="{name}"/></a:graphicData></a:graphic></xdr:graphicFrame></mc:Choice>'
        '<mc:Fallback><xdr:sp macro="" textlink=""><xdr:nvSpPr><xdr:cNvPr id="0" name=""/><xdr:cNvSpPr/>'
        '</xdr:nvSpPr><xdr:spPr><a:xfrm><a:off x="0" y="0"/><a:ext cx="100000" cy="100000"/></a:xfrm>'
        '<a:prstGeom prst="rect"><a:avLst/></a:prstGeom></xdr:spPr></xdr:sp></mc:Fallback>'
        "</mc:AlternateContent><xdr:clientData/></xdr:twoCellAnchor></xdr:wsDr>",
    )  # fmt: skip


# --- rich values --------------------------------------------------------------------------------


def rich_values(parts: Parts) -> None:
    """A linked data type and a blocked spill, after the picture that XlsxWriter put into a cell."""
    own = part_of_sheet(parts, OWN)
    edited(parts, own, f'<c r="A20"><v>{LINKED}</v>', '<c r="A20" t="e" vm="2"><v>#VALUE!</v>')
    edited(parts, own, '<c r="A21" cm="1">', '<c r="A21" t="e" cm="1" vm="3">')
    edited(parts, own, f"<v>{SPILL}</v>", "<v>#VALUE!</v>")
    edited(parts, own, '<c r="E20">', '<c r="E20" t="e" vm="2">')
    edited(parts, own, f"<v>{CHOSEN}</v>", "<v>#VALUE!</v>")
    values = "xl/richData/rdrichvalue.xml"
    edited(parts, values, 'count="1"', 'count="4"')
    edited(
        parts, values, "</rvData>",
        '<rv s="1"><v>en-US</v><v>a1b2c3</v><v>KMTR</v><v>103.5</v><v>0</v></rv>'
        '<rv s="2"><fb t="e">#VALUE!</fb><v>1</v></rv>'
        '<rv s="3"><v>0</v><v>8</v><v>1</v><v>1</v></rv></rvData>',
    )  # fmt: skip
    shapes = "xl/richData/rdrichvaluestructure.xml"
    edited(parts, shapes, 'count="1"', 'count="4"')
    edited(
        parts, shapes, "</rvStructures>",
        '<s t="_linkedentitycore"><k n="%EntityCulture" t="s"/><k n="%EntityId" t="s"/>'
        '<k n="_DisplayString" t="s"/><k n="Price"/><k n="_Format" t="spb"/></s>'
        '<s t="_linkedentity"><k n="%cvi" t="r"/></s>'
        '<s t="_error"><k n="colOffset" t="i"/><k n="errorType" t="i"/><k n="rwOffset" t="i"/>'
        '<k n="subType" t="i"/></s></rvStructures>',
    )  # fmt: skip
    metadata = parts["xl/metadata.xml"].decode()
    block = '<bk><extLst><ext uri="{3e2802c4-a4d2-4d8b-9148-e3be6c30e623}"><xlrd:rvb i="%d"/></ext></extLst></bk>'
    old = '<futureMetadata name="XLRICHVALUE" count="1">' + block % 0
    assert old in metadata
    assert '<valueMetadata count="1"><bk><rc t="2" v="0"/></bk>' in metadata
    metadata = metadata.replace(old, old.replace('"1"', '"3"') + block % 2 + block % 3)
    metadata = metadata.replace(
        '<valueMetadata count="1"><bk><rc t="2" v="0"/></bk>',
        '<valueMetadata count="3"><bk><rc t="2" v="0"/></bk><bk><rc t="2" v="1"/></bk><bk><rc t="2" v="2"/></bk>',
    )
    parts["xl/metadata.xml"] = metadata.encode()
    more = f'xmlns="{RICH}2"'
    for name, kind, link, text in (
        ("rdarray", "rdarray", "rdArray",
         f'<arrayData {more} count="1"><a r="1" c="1"><v t="s">Motors</v></a></arrayData>'),
        ("rdsupportingpropertybag", "rdsupportingpropertybag", "rdSupportingPropertyBag",
         f'<supportingPropertyBags {more}><spbData count="1"><spb s="0"><v>0</v></spb></spbData>'
         "</supportingPropertyBags>"),
        ("rdsupportingpropertybagstructure", "rdsupportingpropertybagstructure",
         "rdSupportingPropertyBagStructure",
         f'<spbStructures {more} count="1"><s><k n="Price" t="i"/></s></spbStructures>'),
        ("richStyles", "richstyles", "richStyles",
         f'<richStyleSheet {more}><richProperties><rPr n="NumberFormat" t="s"/></richProperties>'
         '<richStyles><rSty><rpv i="0">0.00</rpv></rSty></richStyles></richStyleSheet>'),
    ):  # fmt: skip
        added(parts, f"xl/richData/{name}.xml", f"application/vnd.ms-excel.{kind}+xml", text)
        related(parts, "xl/workbook.xml", f"{RICH_LINKS}/{link}", f"richData/{name}.xml")
