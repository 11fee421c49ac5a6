"""Generated reference: JSON Schemas, the pages of results and of functions; written by ``make generated``.

================  ================================================================================
module            responsibility
================  ================================================================================
`functions_page`  the page docs/functions.md: the worksheet functions, made from their registry
`results_page`    the page docs/results.md: what each result is, and where it comes from
`json_schemas`    JSON Schemas of cases, results, verifications, differences and studies, most
                  made from `addin.contract.tables`
`study_schemas`   JSON Schemas of what the studies write, made from `addin.contract.tables`; see
                  `addin.reference.json_schemas`
================  ================================================================================
"""
