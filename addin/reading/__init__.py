"""Workbook or case JSON to `CaseData`, with every problem and its cell.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`cells`         one cell of a workbook: a number, words, nothing, or a sentence on what is wrong
                with it
`typed_case`    a case as typed to `CaseData`: units resolved, per unit and percent of what they
                refer to
`study_inputs`  what is typed on the study sheets to `StudyInputs`; wrong cells there spoil no
                plain calculation
`case_json`     case JSON to `CaseData`, and back
`workbook`      workbook to `CaseData`, and every problem with the cell where it is corrected
`input_names`   names of single inputs, such as ``Elements[LS coupling].Stiffness``
`one_file`      any input file to `CaseInput`, or why it cannot be opened
==============  ==================================================================================
"""
