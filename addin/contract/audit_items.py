"""Items of table `Audit` that are read again from a workbook or a result JSON."""

DIGEST_ITEM = "Inputs, SHA-256 of the canonical case"
SOFTWARE_ITEM = "Software"
#: Begins the item of a field of the case that the command line has set.
SETTING_ITEM = "Setting of the command line: "
