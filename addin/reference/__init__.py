"""Generated reference: JSON Schemas, the pages of results and of functions; written by ``make generated``.

================  ================================================================================
module            responsibility
================  ================================================================================
`effects_page`    the table of effects in docs/effects.md, from their records
`functions_page`  the page docs/functions.md: the worksheet functions, made from their registry
`json_schemas`    JSON Schemas of cases, results, verifications, differences and studies, most
                  made from `addin.contract.tables`
`json_page`       the page docs/json.md: the keys of each file, from those schemas
`record_checks`   what records say of each other: names that they refer to are there
`results_page`    the pages docs/results*.md: what each result is, and where it comes from
`study_commands`  the commands of the studies as a small table, so that --help needs none of their
                  modules
================  ================================================================================
"""
