"""The numbers behind charts, for every renderer, in the units shown on the sheets.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`rows`          rows of chart tables: columns side by side, few digits, few points and no lost
                peak
`effects`       the numbers behind the charts of the effects: reversal, blow, forces, field and
                trip
`limits`        peaks over their limits, and the limit of a history: one rule for sheet and report
`schematic`     the train as a line drawing: machines, couplings and gears on their shafts
`data`          the numbers behind the charts: blocks of rows for the tables of sheet `ChartData`
`start_cycles`  the cycles behind the allowable starts of the governing shaft, for table
                `StartCycles`
==============  ==================================================================================
"""
