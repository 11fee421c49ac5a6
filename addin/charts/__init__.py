"""The numbers behind charts, for every renderer.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`rows`          rows of chart tables: columns side by side, few digits, few points and no lost
                peak
`data`          the numbers behind the charts: blocks of rows for the tables of sheet `ChartData`
`effects`       the numbers behind the charts of the effects: reversal, blow, forces, field and
                trip
`start_cycles`  the cycles behind the allowable starts of the governing shaft, for table
                `StartCycles`
==============  ==================================================================================
"""
