"""The Excel side of torsionbook: workbooks, JSON and the command line; no physics.

===================  ============================================================================
module               responsibility
===================  ============================================================================
`fields`             the one table of inputs and outputs: name, key, unit, choices, sheet, help
`units`              shown unit ↔ SI; the only home of rpm, mm, lbf*ft and per unit
`problems`           a problem with its sheet and cell; the nearest of known words
`cells`              one cell → a number, words, or a sentence on what is wrong with it
`typed_case`         everything typed → `CaseData`; per unit and % of synchronous speed resolved
`read_workbook`      workbook → `CaseData` and every problem with its cell
`case_json`          case JSON ↔ `CaseData`
`results_json`       results → JSON
`json_schemas`       JSON Schemas of both, and of `verify` and `diff`, into `schemas/`
`calculation`        a checked case → everything shown of it
`run_view`           what the workbook shows of a run
`audit`              the audit trail
`write_workbook`     results → the cells the product owns
`shown_units`        units above the columns → their worth in SI
`standing_results`   results as they stand in a workbook, in SI
`processes`          processes of our own with a line to each
`layout`             what template and writer agree on beside the fields
`chart_data`         numbers behind the charts
`charts`             which series goes on which chart
`history_file`       full torque histories beside the workbook
`template`           builds the shipped workbooks; `template_sheets`, `_styles`, `_text` are its data
`template_files`     where the shipped workbooks are
`examples`           the two filled examples
`recalc`             one input file in, its results out
`worksheet`          the worksheet functions, one registry for every front
`server`             the functions and the recalculation over HTTP; `client` asks it from Python
`cli`                the command line
`version`            the version as installed
`package`            writing into somebody's workbook without damaging it
===================  ============================================================================

Everything shown carries its unit beside it; everything handed to `engine` is in SI.
"""
