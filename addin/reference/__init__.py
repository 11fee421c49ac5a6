"""Generated reference: JSON Schemas and the page of functions.

================  ================================================================================
module            responsibility
================  ================================================================================
`functions_page`  the function reference docs/functions.md, made from the registry: `python -m
                  addin.reference.functions_page`
`json_schemas`    JSON Schemas of cases, results, verifications, differences and studies, most
                  made from `addin.contract.tables`
`study_schemas`   JSON Schemas of what the studies write, made from `addin.contract.tables`; see
                  `addin.reference.json_schemas`
================  ================================================================================
"""
