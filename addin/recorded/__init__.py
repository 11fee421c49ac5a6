"""Results as a workbook holds them, their provenance and digests.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`match_rows`     which columns name a row, and rows of two tables matched by them
`results`        results recorded in a workbook, in SI: what an earlier calculation or study has
                 written
`provenance`     what a file says of its own making: digest of its inputs, software, settings
`study_digests`  what a study wrote into its result tables, as digests, so that a cell edited
                 since is seen
`studies`        studies recorded in a workbook, in SI, and whether they are those of its inputs
===============  =================================================================================
"""
