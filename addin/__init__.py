"""The Excel side of torsionbook: workbooks, JSON and the command line; no physics.

=====================  ==========================================================================
module                 responsibility
=====================  ==========================================================================
`fields`               the one table of inputs and outputs: name, key, unit, choices, sheet, help
`units`                shown unit ↔ SI; the only home of rpm, mm, lbf*ft and per unit
`nearest`              the nearest of the known words, for "did you mean"
`cells`                one cell → text, number, word or a sentence on what is wrong
`quantities`           numbers with units → SI, per unit and % of synchronous speed resolved
`read_workbook`        workbook → `CaseData` and every problem with its cell
`case_json`            case JSON ↔ `CaseData`
`results_json`         results → JSON
`schemas`              JSON Schemas of both, made from `fields`
`template_files`       where the shipped workbooks are
`template`             builds them from `fields`
`write_workbook`       results → the cells the product owns
=====================  ==========================================================================

Everything shown carries its unit beside it; everything handed to `engine` is in SI.
"""
