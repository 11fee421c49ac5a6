"""The tables, sheets and captions of each study.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`calibration`       result tables of the calibration, and where each column comes from; part of
                    `addin.contract.studies.fields`
`start_matrix`      result tables of the start matrix and its ledger, and where each column comes
                    from
`starts_sheets`     what stands where on the sheets of start matrix, damage ledger and calibration
`tolerance_sheets`  what stands where on the sheets of tolerances and sensitivities; part of
                    `addin.contract.studies.registry`
`tolerances`        result tables of tolerances and sensitivities, and their traces; part of
                    `addin.contract.studies.fields`
`tuning`            result tables of a tuning study, and where each column comes from; part of
                    `addin.contract.studies.fields`
`traces`            where each result of a study comes from; see `addin.contract.result_tables`
`fields`            tables of the study sheets: what is to be tried, and what became of it
`tuning_sheets`     what stands where on the result sheets of a tuning study; part of
                    `addin.contract.studies.registry`
`registry`          what stands where on the study sheets of a workbook made with ``torsionbook
                    new --studies``
==================  ==============================================================================
"""
