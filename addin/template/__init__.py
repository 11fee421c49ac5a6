"""Builds the shipped workbooks from the records of `addin.contract`.

============  ====================================================================================
module        responsibility
============  ====================================================================================
`examples`    the filled examples: the sample case of Szenasi and von Nimitz (1978), US customary
              units
`filled`      the inputs of a case as they are typed, to be filled into a new workbook
`styles`      how the shipped workbooks look: one palette, one table of cell formats, number
              formats by dimension
`charts`      draws the charts of `addin.contract.charts` with XlsxWriter
`variants`    the variants of the shipped workbooks: how each front's program spells a worksheet
              function
`live_sheet`  sheet `Live`: frequencies, margins and shaft stiffness by worksheet functions, as is
              typed
`build`       builds the shipped workbooks from the one table of fields: ``python -m
              addin.template.build FOLDER``
============  ====================================================================================
"""
