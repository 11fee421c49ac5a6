"""Workbook or case JSON to `CaseData`, with every problem and its cell.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`cells`         one cell of a workbook → a number, words, nothing, or a sentence on what is wrong
                with it
`study_inputs`  what is typed on the study sheets → `StudyInputs`; wrong cells there spoil no
                plain calculation
`typed_case`    A case as typed → `CaseData`: units resolved, per unit and percent of what they
                refer to
`case_json`     case JSON ↔ `CaseData`
`workbook`      workbook → `CaseData`, and every problem with the cell where it is corrected
==============  ==================================================================================
"""
