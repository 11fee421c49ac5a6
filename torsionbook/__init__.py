"""Torsional start-up analysis of synchronous-motor trains, for scripts and notebooks.

>>> import torsionbook as tb
>>> train = tb.read(tb.template("example_modified"))
>>> round(tb.run(train).rows("NaturalFrequencies")[1]["frequency"], 1)
21.0

The names below are the interface: they stay between versions, and each does what the command of its
name does, with the same numbers to the last bit. `addin` and `engine`, which they call, may change.

=================  ===============================================================================
module             responsibility
=================  ===============================================================================
`extras`           packages that are installed by choice, and what to say where one is missing
`problems`         what is wrong with an input, as records and as an exception
`frames`           rows of a table to and from pandas frames with their units
`inputs`           an input: read, looked at, changed, checked, written
`results`          one calculation: tables, records, verdicts, histories, pictures
`studies`          studies of an input: tuning, tolerances, sensitivities, starts, calibration, accuracy
`recalculation`    a workbook recalculated without Excel, from a file or as openpyxl has it in memory
=================  ===============================================================================

A number is in SI and radians unless a unit is asked for.
"""

from torsionbook.inputs import Check, Input, read, template
from torsionbook.problems import InputError, Problem
from torsionbook.recalculation import Recalculated, recalculate
from torsionbook.results import Results, run
from torsionbook.studies import StudyResults, study

__all__ = [
    "Check",
    "Input",
    "InputError",
    "Problem",
    "Recalculated",
    "Results",
    "StudyResults",
    "read",
    "recalculate",
    "run",
    "study",
    "template",
]
